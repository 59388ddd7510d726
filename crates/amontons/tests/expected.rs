//! Every shipped case gives the values of its `[expected]` block.
#![allow(clippy::panic, clippy::expect_used, reason = "a test fails by panicking")]

mod common;

use amontons::case;
use amontons::run::Settings;
use amontons::verify::verify_case;
use common::file;

#[test]
fn shipped_cases_give_their_expected_values() {
    let mut compared = 0;
    for entry in std::fs::read_dir(file("cases")).expect("the folder of the cases").flatten() {
        let path = entry.path();
        if path.extension().is_none_or(|e| e != "toml") {
            continue;
        }
        let source = case::source(&path).expect("a readable case");
        let settings = Settings { certificate: false, ..Settings::default() };
        let verdicts = verify_case(&source, &[], &settings).unwrap_or_else(|error| panic!("{}: {error}", source.name));
        for verdict in &verdicts {
            assert!(
                verdict.holds,
                "{}: {} is {:e}, expected {:e}",
                verdict.benchmark, verdict.what, verdict.computed, verdict.reference
            );
        }
        compared += verdicts.len();
    }
    assert!(compared > 0);
}
