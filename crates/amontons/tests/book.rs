//! The blocks of the guide: each is a case or a part of one, and is read as such.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;

use amontons::case::{self, Source};
use common::file;

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
elasticity = { law = "isotropic", young = 1e6, poisson = 0.3 }
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

#[test]
fn every_block_of_the_guide_to_bodies_is_a_case() {
    let path = file("book/src/meshes.md");
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
        whole.extend(block.parse::<toml::Table>().unwrap_or_else(|error| panic!("{block}\n{error}")));
        if let Err(error) = case::parse(&Source::new("part.toml", whole.to_string()), &[]) {
            panic!("{block}\n{error}");
        }
        parts += 1;
    }
    assert_eq!((included, parts), (1, 7), "blocks that include a case, and parts of cases");
}
