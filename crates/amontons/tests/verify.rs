//! Every shipped benchmark holds, and a wrong reference is found out.
#![allow(clippy::panic, reason = "a test fails by panicking")]

use amontons::run::Settings;
use amontons::verify::{BENCHMARKS, verify};

#[test]
fn every_benchmark_holds() {
    let mut broken = Vec::new();
    for (name, text) in BENCHMARKS {
        match verify(name, text, &Settings { certificate: false, ..Settings::default() }) {
            Ok(verdicts) => {
                assert!(!verdicts.is_empty(), "{name} compares nothing");
                broken.extend(verdicts.into_iter().filter(|v| !v.holds).map(|v| format!("{name}: {} is {:e}, expected {:e}", v.what, v.computed, v.reference)));
            }
            Err(error) => broken.push(format!("{name}: {error}")),
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
    assert!(BENCHMARKS.len() >= 10);
}

#[test]
fn a_reference_that_is_wrong_by_more_than_its_tolerance_does_not_hold() {
    let Some((name, text)) = BENCHMARKS.iter().find(|(name, _)| *name == "manufactured-p") else { panic!("manufactured-p is shipped") };
    let spoiled = text.replace("reference = 0.0", "reference = 1e-9");
    match verify(name, &spoiled, &Settings { certificate: false, ..Settings::default() }) {
        Ok(verdicts) => assert!(verdicts.iter().all(|v| !v.holds)),
        Err(error) => panic!("{error}"),
    }
}
