//! The reference has every word with its meaning, and the guide has the reference.

use std::collections::BTreeSet;

use crate::common;
use amontons::case::{Word, explain, reference, reference_markdown, schema};
use serde_json::Value;

/// Names of all properties of a schema.
fn properties(schema: &Value, all: &mut BTreeSet<String>) {
    match schema {
        Value::Object(node) => {
            if let Some(Value::Object(own)) = node.get("properties") {
                all.extend(own.keys().cloned());
            }
            node.values().for_each(|inner| properties(inner, all));
        }
        Value::Array(entries) => entries.iter().for_each(|inner| properties(inner, all)),
        _ => {}
    }
}

#[test]
fn every_word_has_a_meaning() {
    let all = reference();
    for entry in &all {
        assert!(!entry.meaning.trim().is_empty(), "{} of {}", entry.name, entry.place);
        assert!(entry.word != Word::Key || !entry.expected.is_empty(), "{} of {}", entry.name, entry.place);
    }
    let mut keys = BTreeSet::new();
    properties(&schema(), &mut keys);
    let told: BTreeSet<String> =
        all.iter().filter(|entry| entry.word == Word::Key).map(|entry| entry.name.clone()).collect();
    let missing: Vec<&String> = keys.difference(&told).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn words_are_explained() {
    let one = |word: &str| {
        let found = explain(word);
        assert_eq!(found.len(), 1, "{word}: {found:?}");
        found[0].clone()
    };
    let steps = one("time.steps");
    assert!(steps.is_required && steps.place == "[time]" && steps.expected.contains("integer"), "{steps:?}");
    assert_eq!(one("few-points").word, Word::Finding);
    assert_eq!(one("contact_force_x").expected, "N");
    // A key of the summary by its path and by its end; what lives elsewhere has another name.
    assert_eq!(one("von_mises_max"), one("final.von_mises_max"));
    assert!(one("von_mises_max").meaning.contains("at the centre of a cell"));
    assert_eq!(explain("von_mises").len(), 2, "the quantity of a probe and the array");
    // A name that several tables have is told for each.
    assert!(explain("poisson").len() > 1 && explain("material.elasticity.poisson").len() > 1);
    assert!(explain("youngs_modulus").is_empty());
    assert_eq!(amontons::case::similar("materials.elasticity.yuong").as_deref(), Some("young"));
}

#[test]
fn the_guide_has_the_reference() {
    let chapter = std::fs::read_to_string(common::file("book/src/reference.md")).expect("the chapter");
    assert!(chapter == reference_markdown(), "write it anew: amontons explain > book/src/reference.md");
}
