//! Case files that cannot be read: the message is exact; and the files that those of a case include.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use amontons::case::{self, CaseError, Files, Source};

const PAPER: &str = include_str!("../../../../cases/paper.toml");

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// What reading a file says behind its path.
fn unreadable(path: &Path) -> String {
    let error = case::read(path, &[]).unwrap_err();
    assert!(matches!(error, CaseError::Read { .. }), "{error}");
    let message = error.to_string();
    message.strip_prefix(&format!("{}: ", path.display())).map(str::to_owned).unwrap_or(message)
}

#[test]
fn a_missing_file_is_named_with_one_that_is_there() {
    let folder = folder("missing");
    let near = folder.join("paper.toml");
    std::fs::write(&near, PAPER).unwrap();
    for name in ["papre.toml", "paper"] {
        let expected = format!("found no such file, expected a case file; did you mean {}?", near.display());
        assert_eq!(unreadable(&folder.join(name)), expected);
    }
    assert_eq!(unreadable(&folder.join("other.toml")), "found no such file, expected a case file");
    assert!(case::read(&near, &["mesh.n=4".to_owned()]).is_ok());
}

#[test]
fn a_folder_is_no_case() {
    assert_eq!(unreadable(&folder("folder")), "found a folder, expected a case file");
}

#[test]
fn a_file_that_is_not_utf8_is_refused_with_the_line() {
    let path = folder("latin").join("case.toml");
    std::fs::write(&path, b"name = 'x'\n# \xb5 = 0.2\n").unwrap();
    assert_eq!(unreadable(&path), "found the byte 0xb5 in line 2, expected UTF-8 text; save the file as UTF-8");
}

#[test]
fn an_endless_file_is_refused() {
    let path = folder("long").join("case.toml");
    std::fs::write(&path, vec![b'#'; (16 << 20) + 1]).unwrap();
    assert_eq!(unreadable(&path), "found more than 16777216 bytes, expected a case file");
}

const NODES: &str = "*NODE\n1,0,0\n2,3,0\n3,3,2\n4,0,2\n";
const DECK: &str =
    "*INCLUDE, INPUT=parts/nodes.nam\n*ELEMENT, TYPE=CPS4, ELSET=E\n1,1,2,3,4\n*SURFACE, NAME=LOW\n1,S1\n*STEP\n";
const HEAT: &str = "name = \"plate\"\n[mesh]\nfile = \"decks/main.inp\"\n[time]\nend = 1\nsteps = 2\n[material]\nheat_capacity = 1\n\
    conductivity = 1\n[[boundary]]\non = \"LOW\"\ntemperature = 1\n";

/// The case with these files in memory.
fn with(text: &str, files: &[(&str, &str)]) -> Result<case::Case, CaseError> {
    let files = files.iter().map(|(name, text)| ((*name).to_owned(), Arc::from(text.as_bytes()))).collect();
    case::parse(&Source { files: Files::Memory(files), ..Source::new("plate.toml", text) }, &[])
}

/// The files that a mesh file includes belong to the case: the copy that is kept holds them, and a change of one is a
/// change of the case.
#[test]
fn included_files_are_inputs_of_the_case() {
    let files = |nodes| [("decks/main.inp", DECK), ("decks/parts/nodes.nam", nodes)];
    let first = with(HEAT, &files(NODES)).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(first.inputs.iter().map(|input| input.path.as_str()).collect::<Vec<_>>(), ["inputs/main.inp"]);
    let told: Vec<&str> = first.skipped.iter().map(|skipped| skipped.what.as_str()).collect();
    assert_eq!(told, ["*STEP"]);
    // The copy needs no other file, and is the same case.
    let copy = String::from_utf8_lossy(&first.inputs[0].bytes).into_owned();
    let again = with(&first.text, &[("inputs/main.inp", &copy)]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((again.fingerprint(), again.identity()), (first.fingerprint(), first.identity()));
    assert_eq!(again.problem.mesh.points, first.problem.mesh.points);
    let other = with(HEAT, &files(&NODES.replace("3,3,2", "3,3,2.5"))).unwrap_or_else(|error| panic!("{error}"));
    assert_ne!(other.fingerprint(), first.fingerprint());
    assert_ne!(other.identity(), first.identity());
    assert!((other.problem.mesh.points[2][1] - 2.5).abs() < 1e-15);
}

#[test]
fn faults_of_included_files_are_told_once() {
    let told = |files: &[(&str, &str)]| with(HEAT, files).expect_err("a fault").to_string();
    let missing = told(&[("decks/main.inp", DECK), ("decks/parts/node.nam", NODES)]);
    assert_eq!(
        missing,
        "plate.toml:3:8: mesh.file: found decks/main.inp: line 1: *INCLUDE of \"parts/nodes.nam\", which is not there (did you mean \"decks/parts/node.nam\"?), expected a file beside the one that includes it"
    );
    let spoiled = told(&[("decks/main.inp", DECK), ("decks/parts/nodes.nam", &NODES.replace("3,3,2", "3,3,two"))]);
    assert_eq!(
        spoiled,
        "plate.toml:3:8: mesh.file: found decks/main.inp: decks/parts/nodes.nam: line 4: \"two\", expected a coordinate"
    );
    let folder = folder("confined");
    std::fs::create_dir_all(folder.join("decks")).unwrap();
    std::fs::write(folder.join("decks/main.inp"), DECK.replace("parts/nodes.nam", "../../nodes.nam")).unwrap();
    std::fs::write(folder.join("../nodes.nam"), NODES).unwrap();
    let source = |files| Source { files, ..Source::new("plate.toml", HEAT) };
    assert!(case::parse(&source(Files::Folder(folder.clone())), &[]).is_ok());
    let refused = case::parse(&source(Files::Confined(folder)), &[]).unwrap_err().to_string();
    assert!(refused.contains("*INCLUDE of \"../../nodes.nam\", which is not in the folder of the case"), "{refused}");
}
