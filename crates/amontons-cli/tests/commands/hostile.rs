//! What others put into files, and how it is shown: no control characters, no message without an end, no formulas.

use std::fs;
use std::path::Path;

use amontons::output::FolderLock;
use tempfile::{TempDir, tempdir};

use crate::common::{self, assert_code, output, stderr, stdout};

/// A square of Gmsh, of whose sides one would be a formula and one would change a terminal.
const SQUARE: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"=cmd()\"\n1 2 \"top\u{1b}]0;owned\u{7}\u{202e}\"\n2 3 \"body\"\n\
    $EndPhysicalNames\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n\
    $Elements\n3\n1 1 2 1 1 1 2\n2 1 2 2 2 3 4\n3 3 2 3 3 1 2 3 4\n$EndElements\n";

fn case_of(mesh: &str) -> String {
    format!(
        "name = \"square\"\n[mesh]\nkind = \"file\"\nfile = \"{mesh}\"\n[time]\nend = 1\nsteps = 1\n[material]\ndensity = 0\n\
         elasticity = {{ law = \"isotropic\", young = 1e9, poisson = 0.3, stress_state = \"plane-strain\" }}\n\
         [[boundary]]\non = \"top\\u001b]0;owned\\u0007\\u202e\"\ndisplacement = [0, -1e-4]\n\
         [contact]\non = \"=cmd()\"\nnormal = {{ law = \"signorini\" }}\n"
    )
}

fn square() -> TempDir {
    let folder = tempdir().expect("a folder");
    fs::write(folder.path().join("square.msh"), SQUARE).expect("a file");
    fs::write(folder.path().join("square.toml"), case_of("square.msh")).expect("a file");
    folder
}

fn path(folder: &Path, name: &str) -> String {
    folder.join(name).display().to_string()
}

#[test]
fn names_of_others_do_nothing_to_a_terminal_or_a_spreadsheet() {
    let folder = square();
    let (mesh, case, out) =
        (path(folder.path(), "square.msh"), path(folder.path(), "square.toml"), path(folder.path(), "out"));
    for arguments in [
        vec!["mesh", &mesh],
        vec!["mesh", &mesh, "--format", "json"],
        vec!["check", &case],
        vec!["check", &case, "--format", "json"],
        vec!["run", &case, "--out", &out],
        vec!["check", &case, "--set", "boundary.0.on=\"\\u001b[31m\""],
    ] {
        let printed = output(&mut common::amontons(&arguments));
        let text = stdout(&printed) + &stderr(&printed);
        let hidden = text.chars().find(|c| c.is_control() && *c != '\n' || *c == '\u{202e}');
        assert_eq!(hidden, None, "{arguments:?}: {text:?}");
        if arguments.contains(&"json") {
            let value: serde_json::Value = serde_json::from_str(&stdout(&printed)).expect("JSON");
            assert!(value.to_string().contains("]0;owned"), "{value}");
        } else if arguments[0] != "run" {
            assert!(text.contains("\\u{1b}"), "{arguments:?}: {text}");
        }
    }
    let table = fs::read_to_string(folder.path().join("out/contact.csv")).expect("a table");
    assert!(table.contains(",'=cmd()") && !table.contains(",=cmd()"), "{table}");
}

#[test]
fn a_message_about_a_long_line_is_short() {
    let folder = square();
    let long = format!("name = \"a\"\nunits = \"{}\"\n", "x".repeat(3_000_000));
    fs::write(folder.path().join("long.toml"), long).expect("a file");
    let printed = output(&mut common::amontons(&["check", &path(folder.path(), "long.toml")]));
    assert_code(&printed, 2);
    let told = stderr(&printed);
    assert!(told.len() < 20_000 && told.contains("long.toml, line 2, column 9"), "{} bytes", told.len());
}

#[cfg(unix)]
#[test]
fn a_link_out_of_the_folder_is_refused_where_that_is_asked() {
    let folder = square();
    fs::create_dir(folder.path().join("inner")).expect("a folder");
    std::os::unix::fs::symlink("../square.msh", folder.path().join("inner/link.msh")).expect("a link");
    let link = path(folder.path(), "inner/link.msh");
    assert_code(&output(&mut common::amontons(&["mesh", &link])), 0);
    assert_code(&output(&mut common::amontons(&["mesh", &path(folder.path(), "square.msh"), "--confine"])), 0);
    let refused = output(&mut common::amontons(&["mesh", &link, "--confine"]));
    assert_code(&refused, 2);
    assert!(stderr(&refused).contains("--confine refuses"), "{}", stderr(&refused));
}

/// A pipe in the place of a result is told, and nobody waits for its writer.
#[cfg(unix)]
#[test]
fn verify_waits_for_no_pipe() {
    let folder = square();
    let (case, out) = (path(folder.path(), "square.toml"), path(folder.path(), "out"));
    assert_code(&output(&mut common::amontons(&["run", &case, "--out", &out, "--quiet"])), 0);
    for name in ["history.csv", "fields.pvd", "summary.json", "contact.csv"] {
        let (result, kept) = (folder.path().join("out").join(name), folder.path().join("kept"));
        fs::rename(&result, &kept).expect("a move");
        let made = std::process::Command::new("mkfifo").arg(&result).status();
        assert!(made.is_ok_and(|status| status.success()), "mkfifo");
        let printed = output(&mut common::amontons(&["verify", &out]));
        assert!(!printed.status.success(), "{name}: {}", stdout(&printed));
        let text = stdout(&printed) + &stderr(&printed);
        assert!(text.contains(name), "{name}: {text}");
        fs::rename(&kept, &result).expect("a move");
    }
    assert_code(&output(&mut common::amontons(&["verify", &out])), 0);
}

/// Rows that were changed after the end of a run are not taken over under a new hash.
#[test]
fn resume_does_not_make_a_changed_table_sound() {
    let folder = square();
    let (case, out) = (path(folder.path(), "square.toml"), path(folder.path(), "out"));
    assert_code(&output(&mut common::amontons(&["run", &case, "--out", &out, "--quiet"])), 0);
    let history = folder.path().join("out/history.csv");
    let sound = fs::read_to_string(&history).expect("a table");
    fs::write(&history, sound.replacen("1,1,", "1,1.5,", 1)).expect("a file");
    for further in [&[][..], &["--set", "time.steps=2", "--set", "time.end=2"]] {
        let resumed = output(common::amontons(&["resume", &out]).args(further));
        assert_code(&resumed, 4);
        assert!(stderr(&resumed).contains("history.csv"), "{}", stderr(&resumed));
        assert!(!output(&mut common::amontons(&["verify", &out])).status.success());
    }
    fs::write(&history, sound).expect("a file");
    assert_code(&output(&mut common::amontons(&["resume", &out, "--quiet"])), 0);
    assert_code(&output(&mut common::amontons(&["verify", &out])), 0);
}

/// The second sweep in a folder is refused as a whole: it does not call the runs of the first one failed.
#[test]
fn one_sweep_at_a_time() {
    let folder = square();
    let (case, out) = (path(folder.path(), "square.toml"), folder.path().join("sweep"));
    fs::create_dir(&out).expect("a folder");
    let lock = FolderLock::take(&out).expect("the right to write");
    let name = out.display().to_string();
    let sweep = || {
        output(&mut common::amontons(&["run", &case, "--out", &name, "--each", "material.elasticity.young=1e9,2e9"]))
    };
    let refused = sweep();
    assert_code(&refused, 4);
    assert!(stderr(&refused).contains("is in use by"), "{}", stderr(&refused));
    assert!(!out.join("sweep.csv").exists());
    drop(lock);
    assert_code(&sweep(), 0);
}
