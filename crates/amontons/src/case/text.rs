//! Reads the file of a case.

use std::fs;
use std::io;
use std::path::Path;

use super::nearest::nearest;
use crate::machine;

/// Longest case file in bytes: far above real ones, far below the memory.
const LONGEST: u64 = 16 << 20;

/// Reads a case file.
///
/// # Errors
/// The file is missing, not a file, too long or not UTF-8. The message contains a hint.
pub(super) fn text(path: &Path) -> io::Result<String> {
    let bytes = machine::read(path, LONGEST).map_err(|error| explain(path, error))?;
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let line = error.as_bytes().iter().take(valid).filter(|b| **b == b'\n').count() + 1;
        let byte = error.as_bytes().get(valid).copied().unwrap_or_default();
        let found = format!("found the byte 0x{byte:02x} in line {line}, expected UTF-8 text; save the file as UTF-8");
        io::Error::new(io::ErrorKind::InvalidData, found)
    })
}

/// The error with the expected file, and for a missing file a similar name.
fn explain(path: &Path, error: io::Error) -> io::Error {
    match error.kind() {
        io::ErrorKind::NotFound => {
            let hint = similar(path).map_or_else(String::new, |near| format!("; did you mean {near}?"));
            io::Error::new(error.kind(), format!("found no such file, expected a case file{hint}"))
        }
        io::ErrorKind::PermissionDenied => {
            io::Error::new(error.kind(), "found a file that may not be read, expected a case file")
        }
        io::ErrorKind::InvalidInput | io::ErrorKind::FileTooLarge => {
            let what = error.to_string();
            let found = what.split(", expected ").next().unwrap_or(&what);
            io::Error::new(error.kind(), format!("{found}, expected a case file"))
        }
        _ => error,
    }
}

/// A file in the folder with a similar name, written as in the argument.
fn similar(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?;
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
    let entries = fs::read_dir(folder.unwrap_or(Path::new("."))).ok()?;
    let mut names: Vec<String> = entries.filter_map(|e| e.ok()?.file_name().into_string().ok()).collect();
    names.sort();
    let names: Vec<&str> =
        names.iter().map(String::as_str).filter(|n| Path::new(n).extension().is_some_and(|e| e == "toml")).collect();
    // Only stems are compared, because the ending is the same by custom.
    let stem = |name: &str| Path::new(name).file_stem().and_then(|s| s.to_str()).unwrap_or_default().to_owned();
    let stems: Vec<String> = names.iter().map(|n| stem(n)).collect();
    let stems: Vec<&str> = stems.iter().map(String::as_str).collect();
    let near = nearest(&stem(name), &stems)?;
    let near = names.iter().find(|n| stem(n) == near)?;
    Some(path.with_file_name(near).display().to_string())
}
