//! Every shipped benchmark holds, and a wrong reference is found out.

use amontons::run::Settings;
use amontons::verify::{BENCHMARKS, verify};

/// What does not hold of every `of`-th benchmark, from `first` on.
fn broken(first: usize, of: usize) -> Vec<String> {
    let mut broken = Vec::new();
    for (name, text) in BENCHMARKS.iter().skip(first).step_by(of) {
        match verify(name, text, &Settings { certificate: false, ..Settings::default() }) {
            Ok(verdicts) if verdicts.is_empty() => broken.push(format!("{name} compares nothing")),
            Ok(verdicts) => {
                broken.extend(
                    verdicts
                        .into_iter()
                        .filter(|v| !v.holds)
                        .map(|v| format!("{name}: {} is {:e}, expected {:e}", v.what, v.computed, v.reference)),
                );
            }
            Err(error) => broken.push(format!("{name}: {error}")),
        }
    }
    broken
}

/// Most benchmarks are too small for two threads: two of them run at once.
#[test]
fn every_benchmark_holds() {
    let broken: Vec<String> = std::thread::scope(|scope| {
        let halves = [0, 1].map(|first| scope.spawn(move || broken(first, 2)));
        halves
            .into_iter()
            .flat_map(|half| half.join().unwrap_or_else(|_| vec!["a benchmark panicked".to_owned()]))
            .collect()
    });
    assert!(broken.is_empty(), "{}", broken.join("\n"));
    assert!(BENCHMARKS.len() >= 100);
}

#[test]
fn a_reference_that_is_wrong_by_more_than_its_tolerance_does_not_hold() {
    let Some((name, text)) = BENCHMARKS.iter().find(|(name, _)| *name == "manufactured-p") else {
        panic!("manufactured-p is shipped")
    };
    let spoiled = text.replace("reference = 0.0", "reference = 1e-9");
    match verify(name, &spoiled, &Settings { certificate: false, ..Settings::default() }) {
        Ok(verdicts) => assert!(verdicts.iter().all(|v| !v.holds)),
        Err(error) => panic!("{error}"),
    }
}
