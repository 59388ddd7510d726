//! The README's first case, typed as it stands.

use std::fs;
use std::path::Path;

use crate::common::{amontons, assert_code, output, read, summary};

#[test]
fn the_first_case_of_the_readme_runs_as_it_stands() {
    let readme = read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../README.md"));
    let section = readme
        .split("## A first case of your own")
        .nth(1)
        .and_then(|rest| rest.split("\n## ").next())
        .expect("a section");
    let block = |language: &str| {
        section
            .split(&format!("```{language}\n"))
            .nth(1)
            .and_then(|rest| rest.split("```").next())
            .expect("a block")
            .to_owned()
    };
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("block.toml"), block("toml")).expect("a file");
    let commands = block("sh");
    let mut count = 0;
    for line in commands.lines() {
        let arguments: Vec<&str> = line.split_whitespace().collect();
        assert_eq!(arguments[0], "amontons", "{line}");
        assert_code(&output(amontons(&arguments[1..]).current_dir(&folder)), 0);
        count += 1;
    }
    assert_eq!(count, 3);
    for name in ["results/block", "results/slippery"] {
        assert_eq!(summary(&folder.path().join(name))["outcome"], "done");
    }
    assert!(folder.path().join("results/block/plots/deformed.svg").is_file());
    // Friction holds more of the shear force than a slippery plane does.
    let shear = |name: &str| {
        summary(&folder.path().join(name))["final"]["contact"]["force"][0].as_f64().expect("a force").abs()
    };
    assert!(shear("results/block") > shear("results/slippery"));
}
