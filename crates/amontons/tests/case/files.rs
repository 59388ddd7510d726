//! Case files that cannot be read: the message is exact.

use std::path::{Path, PathBuf};

use amontons::case::{self, CaseError};

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
