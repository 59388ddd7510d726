//! `verify DIR` finds every single change of the results of a run.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::{amontons, assert_code, files, output, read, run_paper, stderr, stdout};
use amontons::verify::recompute;
use tempfile::tempdir;

/// A block of two regions of cells on a foundation, in space.
const SPACE: &str = r#"
name = "space"
[mesh]
kind = "box"
size = [1.0, 1.0, 1.0]
n = [3, 2, 3]
[time]
end = 1.0
steps = 6
[material]
density = 1
heat_capacity = 1
expansion = 0.1
coupling = 0.1
conductivity = 1
elasticity = { law = "isotropic", young = 10.0, poisson = 0.25 }
viscosity = { law = "lame", first = 1, second = 1 }
[load]
body_force = [0.5, -1, 0.2]
heat_source = 1
[[boundary]]
on = "top"
displacement = [0, 0, 0]
temperature = 0
[contact]
on = "bottom"
normal = { law = "compliance", stiffness = 100.0 }
friction = { law = "coulomb", coefficient = 0.2 }
heat = { law = "ramp", conductance = 1.0, width = 1e-3, foundation_temperature = 0.0 }
[output]
every = 2
fields = ["stress", "strain", "heat-flux"]
[expected]
values."final.temperature_min" = 0.0
"#;

fn copy(from: &Path, to: &Path) {
    for file in files(from) {
        let target = to.join(file.strip_prefix(from).expect("inside"));
        fs::create_dir_all(target.parent().expect("a folder")).expect("a folder");
        fs::copy(&file, &target).expect("a file");
    }
}

/// A change of one file of a folder, and whether figures tell it, too, besides the hash of the file.
struct Change {
    what: String,
    figures: bool,
    make: Box<dyn Fn(&Path)>,
}

fn change(what: &str, figures: bool, make: impl Fn(&Path) + 'static) -> Change {
    Change { what: what.to_owned(), figures, make: Box::new(make) }
}

/// A number in a JSON file gets another value.
fn figure(file: &'static str, place: &'static str, value: f64) -> Change {
    change(&format!("{file} {place}"), true, move |folder| {
        let path = folder.join(file);
        let mut all: serde_json::Value = serde_json::from_str(&read(&path)).expect("JSON");
        let found = all.pointer_mut(place).unwrap_or_else(|| panic!("{place}"));
        assert_ne!(found.as_f64(), Some(value), "{place}");
        *found = value.into();
        fs::write(&path, serde_json::to_string_pretty(&all).expect("JSON")).expect("a file");
    })
}

/// A cell of a table gets another value.
fn cell(file: &'static str, row: usize, column: &'static str, value: &'static str) -> Change {
    change(&format!("{file} row {row} {column}"), true, move |folder| {
        let path = folder.join(file);
        let mut lines: Vec<String> = read(&path).lines().map(str::to_owned).collect();
        let at = lines[0].split(',').position(|name| name == column).unwrap_or_else(|| panic!("{column}"));
        let mut cells: Vec<&str> = lines[row].split(',').collect();
        assert_ne!(cells[at], value);
        cells[at] = value;
        lines[row] = cells.join(",");
        fs::write(&path, lines.join("\n") + "\n").expect("a file");
    })
}

/// A row of a table goes.
fn without_row(file: &'static str, row: usize) -> Change {
    change(&format!("{file} without row {row}"), true, move |folder| {
        let path = folder.join(file);
        let mut lines: Vec<String> = read(&path).lines().map(str::to_owned).collect();
        lines.remove(row);
        fs::write(&path, lines.join("\n") + "\n").expect("a file");
    })
}

/// A byte is flipped at a part of the length of a file.
fn byte(file: &'static str, part: f64) -> Change {
    change(&format!("{file} at {part}"), false, move |folder| {
        let path = folder.join(file);
        let mut bytes = fs::read(&path).expect("a file");
        let at = (bytes.len() as f64 * part) as usize;
        bytes[at] ^= 1;
        fs::write(&path, bytes).expect("a file");
    })
}

fn gone(file: &'static str) -> Change {
    change(&format!("{file} gone"), false, move |folder| fs::remove_file(folder.join(file)).expect("a file"))
}

/// The changes; `middle` and `last` are snapshots of the run.
fn changes(middle: [&'static str; 2], last: &'static str) -> Vec<Change> {
    let [fields, contact] = middle;
    let mut all = vec![
        figure("summary.json", "/final/temperature_max", 1e9),
        figure("summary.json", "/final/von_mises_max", 1.0),
        figure("summary.json", "/final/displacement_max/0", 0.5),
        figure("summary.json", "/final/norms/velocity_l2", 0.0),
        figure("summary.json", "/final/contact/force/1", 7.0),
        figure("summary.json", "/final/contact/stick", 77.0),
        figure("summary.json", "/final/strain_max", 0.0),
        figure("summary.json", "/energy/load_work", 1.0),
        figure("summary.json", "/energy/closing_error", 1e-3),
        figure("summary.json", "/solver/sweeps", 1.0),
        figure("summary.json", "/steps", 3.0),
        figure("summary.json", "/time", 0.5),
        cell("history.csv", 1, "kinetic", "0.5"),
        cell("history.csv", 2, "load_work", "9"),
        cell("history.csv", 3, "t", "0.123"),
        cell("history.csv", 6, "contact_force_y", "9"),
        cell("history.csv", 6, "heat_content", "9"),
        without_row("history.csv", 2),
        without_row("history.csv", 6),
        cell("contact.csv", 1, "pressure", "9.5"),
        cell("contact.csv", 2, "status", "lost"),
        without_row("contact.csv", 1),
        cell(contact, 1, "status", "lost"),
        cell(contact, 1, "penetration", "5.5"),
    ];
    for file in ["summary.json", "history.csv", "contact.csv", "case.toml", "manifest.json", "fields.pvd"] {
        all.push(byte(file, 0.6));
    }
    for file in ["certificate.json", "checkpoint/state.bin", "checkpoint/previous.bin", fields, last, contact] {
        all.push(byte(file, 0.4));
    }
    all.push(byte(last, 0.9));
    all.push(byte("manifest.json", 0.1));
    all.extend([gone(fields), gone(contact), gone("contact.csv"), gone("summary.json"), gone("checkpoint/state.bin")]);
    all.push(change("a snapshot of another run", false, |folder| {
        fs::write(folder.join("fields/step_0000099.vtu"), "x").expect("a file");
    }));
    all
}

fn every_change_is_found(whole: &Path, changes: Vec<Change>) {
    let found = recompute(whole).expect("a run");
    assert!(found.holds(), "{found:?}");
    assert!(changes.len() >= 40, "{}", changes.len());
    for (i, Change { what, figures, make }) in changes.into_iter().enumerate() {
        let folder: PathBuf = whole.with_file_name(format!("changed-{i}"));
        copy(whole, &folder);
        make(&folder);
        match recompute(&folder) {
            Ok(found) => {
                assert!(!found.faults.is_empty(), "{what}: the hash does not tell it");
                // Not only the hash of the file, which is the first verdict.
                let told = found.verdicts.iter().skip(1).any(|verdict| !verdict.holds) || found.faults.len() > 1;
                assert!(told || !figures, "{what}: the figures do not tell it");
            }
            // Without a manifest that can be read there is no run.
            Err(error) => assert!(what.starts_with("manifest.json"), "{what}: {error}"),
        }
        let verified = output(&mut amontons(&["verify", &folder.display().to_string(), "--quiet"]));
        assert!([Some(1), Some(4)].contains(&verified.status.code()), "{what}: {}", stderr(&verified));
    }
}

#[test]
fn forty_changes_of_a_plane_run_are_found() {
    let folder = tempdir().expect("a folder");
    let whole = folder.path().join("whole");
    assert_code(&run_paper(&whole, 6, &[]), 0);
    let middle = ["fields/step_0000003.vtu", "contact/step_0000003.csv"];
    every_change_is_found(&whole, changes(middle, "fields/step_0000006.vtu"));
}

#[test]
fn forty_changes_of_a_run_in_space_are_found() {
    let folder = tempdir().expect("a folder");
    let (case, whole) = (folder.path().join("space.toml"), folder.path().join("whole"));
    fs::write(&case, SPACE).expect("a file");
    let [case, out] = [&case, &whole].map(|path| path.display().to_string());
    assert_code(&output(&mut amontons(&["run", &case, "--out", &out])), 0);
    // What the case expects is compared, and what is not checked is said.
    let verified = stdout(&output(&mut amontons(&["verify", &out])));
    assert!(verified.contains("final.temperature_min") && verified.contains("not checked: "), "{verified}");
    let middle = ["fields/step_0000004.vtu", "contact/step_0000004.csv"];
    every_change_is_found(&whole, changes(middle, "fields/step_0000006.vtu"));
}

/// Phases without inertia have no kinetic energy, whatever their velocities are, and chosen steps have no number that
/// is known before.
#[test]
fn a_run_of_all_analyses_with_chosen_steps_holds() {
    let phases = r#"
[[phase]]
name = "press"
end = 0.5
steps = 2
analysis = "quasistatic"
[[phase]]
name = "slide"
end = 1.0
steps = "auto"
accuracy = 0.05
[[phase]]
name = "served"
end = 2.0
analysis = "steady"
[[phase]]
name = "on"
end = 2.5
steps = 3
"#;
    let folder = tempdir().expect("a folder");
    let (case, whole) = (folder.path().join("phases.toml"), folder.path().join("whole"));
    let (start, rest) = SPACE.split_once("[time]\nend = 1.0\nsteps = 6\n").expect("a time");
    let (rest, _) = rest.split_once("[expected]").expect("expectations");
    fs::write(&case, format!("{start}{rest}{phases}").replace("every = 2", "every = 1")).expect("a file");
    let [case, out] = [&case, &whole].map(|path| path.display().to_string());
    assert_code(&output(&mut amontons(&["run", &case, "--out", &out])), 0);
    let found = recompute(&whole).expect("a run");
    assert!(found.holds(), "{found:?}");
}
