//! Every shipped case gives the values of its `[expected]` block.
#![allow(clippy::panic, clippy::expect_used, reason = "a test fails by panicking")]

mod common;

use amontons::output::Memory;
use amontons::run::{Settings, run};
use common::{case, file};

#[test]
fn shipped_cases_give_their_expected_values() {
    let mut compared = 0;
    for entry in std::fs::read_dir(file("cases")).expect("the folder of the cases").flatten() {
        let path = entry.path();
        if path.extension().is_none_or(|e| e != "toml") {
            continue;
        }
        let name = path.file_name().expect("a file name").to_string_lossy().into_owned();
        let case = case(&format!("cases/{name}"), &[]);
        let expected = case.expected.unwrap_or_else(|| panic!("{name} has no [expected] block"));
        let summary = run(&case.problem, &Settings { certificate: false, ..Settings::default() }, &mut [&mut Memory::default()])
            .unwrap_or_else(|e| panic!("{name}: {e}"));
        let summary = serde_json::to_value(&summary).expect("a summary");
        for (key, values) in &expected.values {
            let found = summary.pointer(&format!("/{}", key.replace('.', "/"))).unwrap_or_else(|| panic!("{name}: the summary has no {key}"));
            let found: Vec<f64> = found
                .as_array()
                .map_or_else(|| vec![found.as_f64()], |all| all.iter().map(serde_json::Value::as_f64).collect())
                .into_iter()
                .flatten()
                .collect();
            assert_eq!(found.len(), values.len(), "{name}: {key}");
            let scale = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            for (found, value) in found.iter().zip(values) {
                assert!((found - value).abs() <= expected.tolerance * scale, "{name}: {key} is {found:e}, expected {value:e}");
                compared += 1;
            }
        }
    }
    assert!(compared > 0);
}
