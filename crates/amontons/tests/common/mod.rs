//! What several tests need: the paper's case with overrides, and relative differences.
#![allow(dead_code, reason = "each test uses its part")]

use std::path::{Path, PathBuf};

use amontons::case::{self, Case, Source};

/// A file of the repository.
pub fn file(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

/// A shipped case with overrides.
pub fn case(path: &str, overrides: &[String]) -> Case {
    case::read(&file(path), overrides).unwrap_or_else(|error| panic!("{error}"))
}

/// The paper's example with overrides.
pub fn paper(overrides: &[&str]) -> Case {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    case("cases/paper.toml", &overrides)
}

/// Overrides that turn the default reading of the paper's tensors into another.
pub fn reading(name: &str) -> Vec<String> {
    let overrides: &[&str] = match name {
        "MR" => &[],
        "identity" => &["material.expansion=1", "material.coupling=1", "material.conductivity=1"],
        "literal" => &["material.conductivity=[[1, 1], [1, 1]]"],
        _ => panic!("no reading {name}"),
    };
    overrides.iter().map(|&o| o.to_owned()).collect()
}

/// Largest absolute value.
pub fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, v| m.max(v.abs()))
}

/// Numbers in [−1, 1) that are the same in every run (xorshift; Marsaglia, 2003).
pub struct Random(pub u64);

impl Random {
    pub fn number(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// A text with a piece of it, which must occur once, replaced.
pub fn spoil(text: &str, old: &str, new: &str) -> String {
    assert!(old.is_empty() || text.matches(old).count() == 1, "`{old}` does not occur once");
    if old.is_empty() { text.to_owned() } else { text.replace(old, new) }
}

/// What is said about a case that has faults.
pub fn told(source: &Source, overrides: &[&str]) -> String {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    case::parse(source, &overrides).map_or_else(|error| error.to_string(), |_| "no fault".to_owned())
}
