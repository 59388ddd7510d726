//! The table "Adding …" of CONTRIBUTING is true: an addition that is there touches the files that its row names, and no
//! others.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::papers::{between, files, text};
use crate::common::file;

/// Folders with the sources of library and program: a file of these that has a name of an example stands in its row.
const SOURCES: [&str; 2] = ["crates/amontons/src", "crates/amontons-cli/src"];
/// Folders that paths of the table are below.
const ROOTS: [&str; 5] =
    ["crates/amontons/src", "crates/amontons-cli/src", "crates/amontons", "crates/amontons-cli", ""];
/// Names of examples in files that an addition need not touch: words of messages, and types in use.
const BESIDE: [(&str, &str); 7] = [
    ("TimeScheme", "crates/amontons/src/time/mod.rs"),
    ("TimeScheme", "crates/amontons/src/problem/mod.rs"),
    ("TimeScheme", "crates/amontons/src/contract/scheme.rs"),
    ("radiation", "crates/amontons/src/problem/range.rs"),
    ("radiation", "crates/amontons-cli/src/import/notes.rs"),
    ("reaction_heat", "crates/amontons-cli/src/import/write.rs"),
    ("VISCOELASTIC", "crates/amontons-cli/src/import/write.rs"),
];

/// A row of the table: what is added, the files that it names, and the names of an example.
struct Row<'t> {
    addition: &'t str,
    named: BTreeSet<PathBuf>,
    names: Vec<&'t str>,
}

/// A source file and what it holds.
type Source = (PathBuf, String);

fn whole(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The file that the table means by a path.
fn meant(path: &str) -> PathBuf {
    let found = ROOTS.iter().map(|root| file(root).join(path)).find(|path| path.is_file());
    whole(&found.unwrap_or_else(|| panic!("{path} is no file")))
}

/// A row with an example.
fn row(line: &str) -> Option<Row<'_>> {
    let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
    let &[addition, touched, example] = cells.as_slice() else { return None };
    let is_file = |code: &&str| [".rs", ".md", ".toml"].iter().any(|ending| code.ends_with(ending));
    let named = between(touched, '`').into_iter().filter(is_file).map(meant).collect();
    let names = between(example, '`');
    (!names.is_empty()).then_some(Row { addition, named, names })
}

fn sources() -> Vec<Source> {
    let all = SOURCES.iter().flat_map(|folder| files(folder, &[".rs"]));
    // Tests may name anything.
    all.filter(|path| !path.ends_with("tests.rs")).map(|path| (whole(&path), text(&path))).collect()
}

/// Whether a text has a name as a word of its own.
fn has(text: &str, name: &str) -> bool {
    let goes_on = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
    text.match_indices(name).any(|(start, _)| {
        let (before, after) = (&text[..start], &text[start + name.len()..]);
        !before.ends_with(goes_on) && !after.starts_with(goes_on)
    })
}

/// The code of a source file, without comments and tests.
fn code(text: &str) -> String {
    let code = text.split("\nmod tests").next().unwrap_or_default();
    code.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n")
}

/// Whether a file is called by a name.
fn is_called(path: &Path, name: &str) -> bool {
    path.file_stem().is_some_and(|stem| stem == name)
}

/// Files that a row names without need, and those that it forgets.
fn faults(row: &Row, sources: &[Source]) -> Vec<String> {
    let beside: BTreeSet<PathBuf> =
        BESIDE.iter().filter(|(name, _)| row.names.contains(name)).map(|(_, path)| whole(&file(path))).collect();
    let touches = |path: &Path, text: &str| row.names.iter().any(|name| has(text, name) || is_called(path, name));
    let mut faults = Vec::new();
    for (path, text) in sources.iter().filter(|(path, _)| !row.named.contains(path) && !beside.contains(path)) {
        if touches(path, &code(text)) {
            faults.push(format!("{}: {} has {:?} and is not named", row.addition, path.display(), row.names));
        }
    }
    for path in &row.named {
        if !touches(path, &text(path)) {
            faults.push(format!("{}: {} has none of {:?}", row.addition, path.display(), row.names));
        }
    }
    faults
}

#[test]
fn additions_touch_the_files_that_the_table_names() {
    let document = text(&file("CONTRIBUTING.md"));
    let table = document.split("\n## Adding").nth(1).and_then(|rest| rest.split("\n## ").next()).expect("the table");
    let rows: Vec<Row> = table.lines().filter_map(row).collect();
    let sources = sources();
    let wrong: Vec<String> = rows.iter().flat_map(|row| faults(row, &sources)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(rows.len() > 14, "{} rows", rows.len());
    let element = rows.iter().find(|row| row.addition == "element of a shape that is there").expect("its row");
    assert_eq!(element.named.len(), 2, "files of a new element: {:?}", element.named);
    for (name, path) in BESIDE {
        assert!(rows.iter().any(|row| row.names.contains(&name)), "{name} is no example");
        assert!(has(&code(&text(&file(path))), name), "{path} has no {name}");
    }
}

#[test]
fn a_wrong_row_is_found() {
    assert!(has("a: Wave,", "Wave") && !has("Waves Short-Wave wave", "Wave"));
    let sources = sources();
    let short = row("| law | `contact/friction/static_kinetic.rs` | `StaticKinetic` |").expect("a row");
    assert!(faults(&short, &sources).iter().any(|fault| fault.contains("laws.rs")), "{:?}", faults(&short, &sources));
    let far =
        row("| column | `output/columns.rs`, `output/shown.rs`, `linalg/mod.rs` | `contact_area` |").expect("a row");
    assert_eq!(faults(&far, &sources).len(), 1);
    assert!(row("|---|---|---|").is_none() && row("| a … | touch | for example |").is_none());
}
