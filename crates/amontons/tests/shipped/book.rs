//! The blocks of the guide: each is a case or a part of one, and is read as such.

use crate::common::file;
use std::path::Path;

use amontons::case::{self, Files, Source};
use amontons::output::{ResultTable, Shown, shown};
use amontons::units::{Measure, Units};

/// What a part of a case leaves out.
const REST: &str = r#"
name = "part"
[mesh]
kind = "rectangle"
size = [1.0, 1.0]
n = 4
[time]
end = 1.0
steps = 4
[material]
density = 1000.0
heat_capacity = 1e6
expansion = 0.0
coupling = 0.0
conductivity = 1.0
elasticity = { law = "isotropic", young = 1e6, poisson = 0.3, stress_state = "plane-stress" }
viscosity = { law = "lame", first = 0.0, second = 1e3 }
"#;

/// The blocks of TOML in a text, without those that include a file.
fn blocks(text: &str) -> Vec<String> {
    let mut blocks = Vec::new();
    let mut rest = text;
    while let Some((_, after)) = rest.split_once("```toml\n") {
        let (block, behind) = after.split_once("```").expect("the end of a block");
        blocks.push(block.to_owned());
        rest = behind;
    }
    blocks
}

/// Reads every block of a chapter; the numbers of those that include a case and of parts of cases.
fn read(chapter: &str) -> (usize, usize) {
    let path = file(&format!("book/src/{chapter}"));
    let text = std::fs::read_to_string(&path).expect("the chapter");
    let (mut included, mut parts) = (0, 0);
    for block in blocks(&text) {
        if let Some(name) = block.trim().strip_prefix("{{#include ").and_then(|rest| rest.strip_suffix("}}")) {
            let whole = path.parent().expect("a folder").join(name);
            case::read(&whole, &[]).unwrap_or_else(|error| panic!("{name}:\n{error}"));
            included += 1;
            continue;
        }
        let mut whole: toml::Table = REST.parse().expect("the rest");
        let part = block.parse::<toml::Table>().unwrap_or_else(|error| panic!("{block}\n{error}"));
        let mesh = part.get("mesh").map(ToString::to_string).unwrap_or_default();
        if ["box", "cylinder", "axisymmetric"].iter().any(|word| mesh.contains(word)) {
            // The rest is a plane body.
            let elasticity = whole["material"]["elasticity"].as_table_mut().expect("a law");
            elasticity.remove("stress_state");
        }
        whole.extend(part);
        // Mesh files of parts are those of the shipped cases.
        let source = Source { files: Files::Folder(file("cases")), ..Source::new("part.toml", whole.to_string()) };
        if let Err(error) = case::parse(&source, &[]) {
            panic!("{block}\n{error}");
        }
        parts += 1;
    }
    (included, parts)
}

#[test]
fn every_block_of_the_guides_is_a_case() {
    let expected = [
        ("accuracy.md", (0, 2)),
        ("case.md", (1, 2)),
        ("coming-from.md", (0, 1)),
        ("contact.md", (1, 16)),
        ("large.md", (0, 1)),
        ("loads.md", (0, 7)),
        ("materials.md", (0, 6)),
        ("meshes.md", (0, 7)),
        ("results.md", (0, 3)),
        ("runs.md", (0, 1)),
        ("squeal.md", (0, 1)),
        ("time.md", (0, 9)),
        ("two-bodies.md", (0, 5)),
    ];
    let pages = std::fs::read_dir(file("book/src")).expect("the guide").flatten();
    let mut found: Vec<(String, (usize, usize))> = pages
        .map(|page| page.file_name().into_string().expect("a name"))
        // The tutorial has a test of its own, with the mesh of its case.
        .filter(|name| Path::new(name).extension().is_some_and(|end| end == "md") && name != "tutorial.md")
        .map(|name| (name.clone(), read(&name)))
        .filter(|(_, blocks)| *blocks != (0, 0))
        .collect();
    found.sort();
    let found: Vec<(&str, (usize, usize))> = found.iter().map(|(name, blocks)| (name.as_str(), *blocks)).collect();
    assert_eq!(found, expected, "blocks that include a case, and parts of cases");
}

/// The chapter on extending shows every example, and each in its own file: the tests of the examples compile and run
/// those.
#[test]
fn the_examples_are_in_the_guide() {
    let text = std::fs::read_to_string(file("book/src/extending.md")).expect("the chapter");
    let examples = std::fs::read_dir(file("crates/amontons/examples")).expect("the examples").flatten();
    let mut shown = 0;
    for example in examples.map(|entry| entry.file_name().into_string().expect("a name")) {
        assert!(
            text.contains(&format!("{{{{#include ../../crates/amontons/examples/{example}}}}}")),
            "{example} is not shown"
        );
        shown += 1;
    }
    assert_eq!(text.matches("{{#include ").count(), shown);
}

/// The chapter on results gives every column of the tables its unit, in the plane and in space.
#[test]
fn the_table_of_columns_has_their_units() {
    let text = std::fs::read_to_string(file("book/src/results.md")).expect("the chapter");
    let section = text.split("## Tables").nth(1).and_then(|rest| rest.split("\n## ").next()).expect("a section");
    let is_table = |value: &Shown| [ResultTable::History, ResultTable::Contact].contains(&value.table);
    let all: Vec<_> = shown().into_iter().filter(is_table).map(|value| (value.name, value.measure)).collect();
    let mut told = Vec::new();
    for line in section.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        for name in cells[0].split(", ").map(|name| name.trim_matches('`')) {
            let known = all.iter().find(|(column, _)| column == name).unwrap_or_else(|| panic!("{name} is no column"));
            let measure = known.1.unwrap_or_else(|| panic!("{name} has no unit"));
            assert_eq!([Units::PLANE.of(measure), Units::SPACE.of(measure)], [cells[2], cells[3]], "{name}");
            told.push(name.to_owned());
        }
    }
    for (column, measure) in &all {
        let has_unit =
            measure.is_some_and(|measure| measure != Measure::Number) && !["x", "y", "z"].contains(&column.as_str());
        assert!(!has_unit || told.contains(column), "the chapter says nothing of {column}");
    }
}

/// The tables of the chapter on contact name every law of the case file's schema, and no other.
#[test]
fn the_tables_of_contact_name_every_law() {
    let text = std::fs::read_to_string(file("book/src/contact.md")).expect("the chapter");
    let schema = case::schema();
    for (heading, definition) in [("## Pressure", "Normal"), ("## Friction", "Friction"), ("## Heat", "Heat")] {
        let section = text.split(heading).nth(1).and_then(|rest| rest.split("\n## ").next()).expect("a section");
        let mut told: Vec<&str> = section
            .lines()
            .filter_map(|line| line.strip_prefix("| `")?.split('`').next())
            .filter(|name| *name != "law")
            .collect();
        let variants = schema["$defs"][definition]["oneOf"].as_array().expect("the laws");
        let mut laws: Vec<&str> =
            variants.iter().filter_map(|variant| variant["properties"]["law"]["const"].as_str()).collect();
        told.sort_unstable();
        laws.sort_unstable();
        assert_eq!(told, laws, "{heading}");
    }
}
