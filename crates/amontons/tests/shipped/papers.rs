//! What documents and messages name exists: paths, links, chapters and keys; every key is described; "per" is written
//! for "each".

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::file;
use amontons::case::{self, Source};
use serde_json::Value;

/// Files below a folder of the repository that end with one of these.
pub fn files(folder: &str, endings: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![file(folder)];
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(&folder).expect("a folder").flatten() {
            let (path, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
            if path.is_symlink() || name.starts_with('.') && name != ".ci" || name == "target" || name == "results" {
                continue;
            }
            if path.is_dir() {
                open.push(path);
            } else if endings.iter().any(|ending| name.ends_with(ending)) {
                found.push(path);
            }
        }
    }
    found.sort();
    assert!(!found.is_empty());
    found
}

/// What a file holds.
pub fn text(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn documents() -> Vec<PathBuf> {
    files(".", &[".md"])
}

/// The parts of a line between pairs of a mark: code in a document, strings in a program.
pub fn between(line: &str, mark: char) -> Vec<&str> {
    line.split(mark).skip(1).step_by(2).collect()
}

/// Files of a results folder, which are not in the repository, and files that the text tells to write.
const RESULTS: [&str; 32] = [
    "plots/",
    "fields/",
    "checkpoint/",
    "levels/",
    "inputs/",
    "results/",
    "case.toml",
    "summary.json",
    "manifest.json",
    "certificate.json",
    "history.csv",
    "probes.csv",
    "error.csv",
    "bars.csv",
    "contact.csv",
    "accuracy.csv",
    "refined-cells.txt",
    "convergence.csv",
    "convergence-values.csv",
    "convergence.json",
    "gradient.csv",
    "gradient.json",
    "fit.csv",
    "fit.json",
    "fit.svg",
    "residuals.csv",
    "descent.json",
    "modes.csv",
    "modes.json",
    "report.md",
    "fields.pvd",
    "fields.vtkhdf",
];
/// Names in examples: files of the reader.
const EXAMPLES: [&str; 9] = [
    "my-case.toml",
    "block.toml",
    "punch.toml",
    "seal.toml",
    "pad.toml",
    "pad.msh",
    "pad.geo",
    "brake.csv",
    "load.csv",
];

/// Whether a piece of code in a document is a path of a file or folder.
fn is_path(code: &str) -> bool {
    let named = [".rs", ".md", ".toml", ".geo", ".py", ".json", ".png"].iter().any(|ending| code.ends_with(ending));
    let plain = code.chars().all(|c| c.is_ascii_alphanumeric() || "/._-".contains(c)) && !code.starts_with('.');
    plain
        && (named
            || code.contains('/') && code.ends_with('/')
            || code.starts_with("crates/")
            || code.starts_with("cases/")
            || code.starts_with("docs/"))
}

#[test]
fn every_path_and_link_of_a_document_exists() {
    let roots = ["", "crates/amontons", "crates/amontons/src", "crates/amontons-cli", "crates/amontons-cli/src"];
    let (mut missing, mut seen) = (Vec::new(), 0);
    for document in documents() {
        let beside = document.parent().expect("a folder").to_owned();
        for (number, line) in text(&document).lines().enumerate() {
            let mut miss = |what: &str| missing.push(format!("{}:{}: {what}", document.display(), number + 1));
            for link in line
                .split("](")
                .skip(1)
                .filter_map(|rest| rest.split(')').next())
                .filter(|link| !link.contains("://") && !link.starts_with('#'))
            {
                seen += 1;
                let target = link.split('#').next().unwrap_or(link);
                if !beside.join(target).exists() {
                    miss(link);
                }
            }
            for code in between(line, '`').into_iter().filter(|code| is_path(code)) {
                if RESULTS.contains(&code) || EXAMPLES.contains(&code) || code.starts_with("results/") {
                    continue;
                }
                seen += 1;
                if !beside.join(code).exists() && !roots.iter().any(|root| file(root).join(code).exists()) {
                    miss(code);
                }
            }
        }
    }
    assert!(missing.is_empty(), "{}", missing.join("\n"));
    assert!(seen > 80, "{seen} paths seen");
}

/// Whether a dotted path names a key of the case file; a tag selects none, so that all laws of a table count.
fn is_key(schema: &Value, path: &[&str]) -> bool {
    fn search(root: &Value, node: &Value, path: &[&str]) -> bool {
        let node = node
            .get("$ref")
            .and_then(Value::as_str)
            .map_or(node, |target| root.pointer(target.trim_start_matches('#')).expect("a definition"));
        let inner = ["oneOf", "anyOf"].iter().filter_map(|key| node.get(key)?.as_array()).flatten();
        if inner.chain(node.get("items")).any(|inner| search(root, inner, path)) {
            return true;
        }
        let Some((first, rest)) = path.split_first() else { return true };
        let named = node.get("properties").and_then(|properties| properties.get(first));
        // A table whose keys are names that the case gives, such as [constants].
        let own = node.get("additionalProperties").filter(|of| of.is_object());
        named.or(own).is_some_and(|next| search(root, next, rest))
    }
    search(schema, schema, path)
}

/// Dotted paths in a text that begin with a table of the case file.
fn keys<'t>(schema: &Value, text: &'t str) -> Vec<&'t str> {
    // `name` is no table.
    let tables: Vec<&str> = schema["properties"]
        .as_object()
        .expect("tables")
        .keys()
        .map(String::as_str)
        // `solver` is a table of results, too.
        .filter(|key| !["name", "solver"].contains(key))
        .collect();
    let words = text.split(|c: char| !(c.is_ascii_alphanumeric() || "._".contains(c)));
    let is_path = |word: &&str| {
        let parts: Vec<&str> = word.split('.').collect();
        let is_file = ["csv", "toml", "json", "py", "pvd", "vtu", "msh", "md", "rs", "png", "svg", "bin", "sha256"]
            .contains(parts.last().unwrap_or(&""));
        parts.len() > 1
            && tables.contains(&parts[0])
            && !is_file
            && parts.iter().all(|part| part.starts_with(|c: char| c.is_ascii_lowercase()))
    };
    words.map(|word| word.trim_matches('.')).filter(is_path).collect()
}

#[test]
fn every_key_that_a_document_or_a_message_names_exists() {
    let schema = case::schema();
    let (mut missing, mut seen) = (Vec::new(), 0);
    let mut look = |path: &Path, number: usize, text: &str| {
        for key in keys(&schema, text) {
            seen += 1;
            if !is_key(&schema, &key.split('.').collect::<Vec<_>>()) {
                missing.push(format!("{}:{}: {key}", path.display(), number + 1));
            }
        }
    };
    for path in documents() {
        let text = text(&path);
        for (number, line) in text.lines().enumerate() {
            for code in between(line, '`') {
                look(&path, number, code);
            }
        }
    }
    for path in files("crates/amontons/src", &[".rs"]).into_iter().chain(files("crates/amontons-cli/src", &[".rs"])) {
        let text = text(&path);
        // Tests name keys that do not exist on purpose.
        let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
        for (number, line) in code.lines().enumerate().filter(|(_, line)| !line.trim_start().starts_with("//")) {
            for string in between(line, '"') {
                look(&path, number, string);
            }
        }
    }
    assert!(missing.is_empty(), "{}", missing.join("\n"));
    assert!(seen > 60, "{seen} keys seen");
}

/// Chapters have no numbers: a name of a page does not change when one is added. Decisions are found in `docs/adr`.
#[test]
fn no_reference_goes_by_a_number_that_changes() {
    for path in
        files("crates", &[".rs"]).into_iter().chain(documents()).filter(|path| !path.ends_with("shipped/papers.rs"))
    {
        for (number, line) in text(&path).lines().enumerate() {
            for wrong in ["book, chapter", "design, D", "design decision D"] {
                assert!(!line.contains(wrong), "{}:{}: {wrong}", path.display(), number + 1);
            }
        }
    }
}

/// "one row a step" is "one row per step".
fn a_for_per(text: &str) -> Option<String> {
    let heads = ["one", "a", "an", "two", "three"];
    let things = "entry entries field datum row rows value values number numbers iteration iterations function law shape point points integer line kB MB column checkpoint factorization pass";
    let units = "component coordinate region side probe step row node cell minute segment direction time letter file contact facet line level edge matrix quantity unit";
    let words: Vec<&str> = text.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
    let is = |list: &str, word: &str| list.split(' ').any(|known| known == word);
    let counted = |word: &str| heads.contains(&word) || word.chars().all(|c| c.is_ascii_digit());
    let four = words
        .windows(4)
        .find(|w| counted(w[0]) && is(things, w[1]) && w[2] == "a" && is(units, w[3]))
        .map(|w| w.join(" "));
    // Without the thing: "one a column", "half a micrometre a stop".
    let alone = "one once twice row numbers entries metre millimetre micrometre newton kelvin m³ mm³";
    let more = "column element mesh newton second stop turn";
    let three = words
        .windows(3)
        .find(|w| is(alone, &w[0].to_lowercase()) && w[1] == "a" && (is(units, w[2]) || is(more, w[2])));
    four.or_else(|| three.map(|w| w.join(" ")))
}

#[test]
fn per_is_written_for_each() {
    assert_eq!(a_for_per("contact.csv has a row a contact point").as_deref(), Some("a row a contact"));
    assert_eq!(a_for_per("One entry a component; empty for zero").as_deref(), None);
    assert_eq!(a_for_per("Displacement, one entry a component.").as_deref(), Some("one entry a component"));
    assert_eq!(a_for_per("one row per step"), None);
    assert_eq!(a_for_per("The values at a time, one a column.").as_deref(), Some("one a column"));
    assert_eq!(
        a_for_per("half a micrometre a stop, 10⁻⁵ mm³ a newton and metre").as_deref(),
        Some("micrometre a stop")
    );
    let schema = case::schema().to_string();
    assert_eq!(a_for_per(&schema), None);
    for path in files("crates", &[".rs", ".toml"])
        .into_iter()
        .chain(documents())
        .filter(|path| !path.ends_with("shipped/papers.rs"))
    {
        for (number, line) in text(&path).lines().enumerate() {
            if let Some(found) = a_for_per(line) {
                panic!("{}:{}: {found}", path.display(), number + 1);
            }
        }
    }
}

/// Phrases that readers stumbled over, which CONTRIBUTING shows as examples.
#[test]
fn descriptions_and_messages_avoid_the_worst_phrases() {
    let phrases = [
        "is that of",
        "none where it does not",
        "of which the tangential part counts",
        "where left out",
        "one that there is not",
        "that is not told",
        "is told by",
    ];
    let schema = case::schema().to_string();
    for phrase in phrases {
        assert!(!schema.contains(phrase), "the schema says \"{phrase}\"");
    }
}

#[test]
fn every_key_of_the_schema_is_described() {
    fn walk(node: &Value, keys: &mut usize) {
        for (key, property) in node.get("properties").and_then(Value::as_object).into_iter().flatten() {
            *keys += 1;
            assert!(
                property["description"].as_str().is_some_and(|text| text.len() > 5),
                "{key} has no description: {property}"
            );
        }
        match node {
            Value::Object(entries) => entries.values().for_each(|value| walk(value, keys)),
            Value::Array(entries) => entries.iter().for_each(|value| walk(value, keys)),
            _ => {}
        }
    }
    let mut keys = 0;
    walk(&case::schema(), &mut keys);
    assert!(keys > 300, "{keys} keys");
}

/// The numbers before a word in a text, in digits; of notebooks in words, too. "Two materials" are those of a case.
fn counts(text: &str, thing: &str) -> Vec<String> {
    let words: Vec<&str> = text.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
    let small = if thing == "notebooks" { "two three four five six seven eight nine ten" } else { "" };
    let is_number = |word: &str| {
        word.chars().all(|c| c.is_ascii_digit()) || small.split(' ').any(|number| number == word.to_lowercase())
    };
    words.windows(2).filter(|pair| pair[1] == thing && is_number(pair[0])).map(|pair| pair[0].to_lowercase()).collect()
}

/// README, guide and the other documents count what there is; the change log and the records count what there was.
#[test]
fn documents_count_what_there_is() {
    assert_eq!(counts("the **176 benchmarks**, of which ten benchmarks", "benchmarks"), ["176"]);
    let named = |folder: &str, ending: &str| files(folder, &[ending]).len();
    let things = [
        ("benchmarks", amontons::verify::BENCHMARKS.len()),
        ("materials", case::materials().len()),
        ("notebooks", named("crates/amontons-py/notebooks", ".ipynb")),
    ];
    let words = ["zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"];
    let (mut wrong, mut seen) = (Vec::new(), std::collections::BTreeSet::new());
    let is_history = |path: &Path| path.ends_with("CHANGELOG.md") || path.to_string_lossy().contains("docs/adr");
    for path in documents().into_iter().filter(|path| !is_history(path)) {
        for (thing, number) in things {
            for told in counts(&text(&path), thing) {
                seen.insert(thing);
                if told != number.to_string() && words.get(number).is_none_or(|word| *word != told) {
                    wrong.push(format!("{}: {told} {thing}, but there are {number}", path.display()));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert_eq!(seen.into_iter().collect::<Vec<_>>(), ["benchmarks", "materials", "notebooks"]);
}

/// The anchor that mdBook and others make of a heading.
fn anchor(heading: &str) -> String {
    let plain = heading.trim_start_matches('#').trim().to_lowercase();
    plain.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c)).collect::<String>().replace(' ', "-")
}

#[test]
fn every_anchor_of_a_link_exists() {
    assert_eq!(anchor("## Pressure: `normal`"), "pressure-normal");
    let (mut missing, mut seen) = (Vec::new(), 0);
    for document in documents() {
        // What a document links to lies beside it, or beside the file that it is a link to.
        let document = document.canonicalize().expect("a document");
        let beside = document.parent().expect("a folder").to_owned();
        for link in text(&document).split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let Some((target, name)) = link.split_once('#').filter(|_| !link.contains("://")) else { continue };
            let target = if target.is_empty() { document.clone() } else { beside.join(target) };
            let known = text(&target);
            seen += 1;
            if !known.lines().filter(|line| line.starts_with('#')).any(|heading| anchor(heading) == name) {
                missing.push(format!("{}: {link}", document.display()));
            }
        }
    }
    assert!(missing.is_empty(), "{}", missing.join("\n"));
    assert!(seen > 50, "{seen} anchors seen");
}

/// The table of contents names every page once.
#[test]
fn the_table_of_contents_is_complete() {
    let contents = text(&file("book/src/SUMMARY.md"));
    for page in files("book/src", &[".md"]) {
        let name = page.file_name().expect("a name").to_string_lossy().into_owned();
        let times = contents.matches(&format!("]({name})")).count();
        assert_eq!(times, usize::from(name != "SUMMARY.md"), "{name} in the table of contents");
    }
}

/// The first case of the README is a case; its commands are run by the tests of the program.
#[test]
fn the_first_case_of_the_readme_is_valid() {
    let readme = text(&file("README.md"));
    let block = readme.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).expect("a case");
    let case = case::parse(&Source::new("block.toml", block), &[]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(case.problem.physics, amontons::problem::Physics::Mechanics);
}
