//! One word, one meaning: a type of the library or of the program has a name of its own.

use std::collections::BTreeMap;

use super::papers::{files, text};

/// Folders with the sources of library and program.
const SOURCES: [&str; 2] = ["crates/amontons/src", "crates/amontons-cli/src"];
/// Largest number of names that several types share.
const SHARED: usize = 14;
/// The keys of the case file: their types are called as what they become.
const MIRROR: &str = "case/raw";

/// The name that a line defines as a type or a trait; definitions in functions and modules of a file do not count.
fn defined(line: &str) -> Option<&str> {
    let rest = match line.strip_prefix("pub") {
        Some(rest) if rest.starts_with('(') => rest.split_once(") ")?.1,
        Some(rest) => rest.strip_prefix(' ')?,
        None => line,
    };
    let (kind, rest) = rest.split_once(' ')?;
    let name = rest.split(|c: char| !c.is_alphanumeric() && c != '_').next()?;
    (["struct", "enum", "trait", "type"].contains(&kind) && !name.is_empty()).then_some(name)
}

#[test]
fn few_names_of_types_are_shared() {
    let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let all = SOURCES.iter().flat_map(|folder| files(folder, &[".rs"]));
    for path in all.filter(|path| !path.to_string_lossy().contains(MIRROR)) {
        for (number, line) in text(&path).lines().enumerate() {
            if let Some(name) = defined(line) {
                places.entry(name.to_owned()).or_default().push(format!("{}:{}", path.display(), number + 1));
            }
        }
    }
    assert!(places.len() > 500, "{} names: the definitions are not read", places.len());
    places.retain(|_, places| places.len() > 1);
    let shared: Vec<String> = places.iter().map(|(name, places)| format!("{name}: {}", places.join(", "))).collect();
    assert!(
        shared.len() <= SHARED,
        "{} names of types are shared, at most {SHARED} may be; give the new types other names:\n{}",
        shared.len(),
        shared.join("\n")
    );
}

#[test]
fn a_definition_is_recognized() {
    assert_eq!(defined("pub(super) struct Panel<'a> {"), Some("Panel"));
    assert_eq!(defined("pub trait Shape: Send {"), Some("Shape"));
    assert_eq!(defined("type Row = (String, String);"), Some("Row"));
    assert_eq!(defined("    struct Inside;"), None);
    assert_eq!(defined("pub fn type_of() {"), None);
}
