//! The certificate of the paper's finest case, n = 256 with 256 steps, and what its parts cost.
//!
//! `cargo bench -p amontons-core --bench check` prints seconds. Arguments after `--`: n, steps.
#![allow(clippy::expect_used, clippy::print_stdout, reason = "a program for developers")]

use std::path::Path;
use std::time::Instant;

use amontons::{case, hypotheses};

/// Computes, prints how long it took, and returns the result.
fn timed<T>(name: &str, compute: impl FnOnce() -> T) -> T {
    let begin = Instant::now();
    let result = compute();
    println!("  {name:<42}{:.3} s", begin.elapsed().as_secs_f64());
    result
}

fn main() {
    let mut numbers = std::env::args().skip(1).filter(|a| !a.starts_with('-'));
    let n = numbers.next().unwrap_or_else(|| "256".to_owned());
    let steps = numbers.next().unwrap_or_else(|| n.clone());
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/paper.toml");
    println!("paper, n = {n}, {steps} steps");
    let problem = timed("the case", || {
        case::read(&path, &[format!("mesh.n={n}"), format!("time.steps={steps}")]).expect("the paper's case").problem
    });
    timed("findings without eigenvalues", || hypotheses::findings(&problem));
    timed("constants of the domain", || hypotheses::domain_constants(&problem).expect("constants"));
    let certificate =
        timed("the certificate, the two above included", || hypotheses::certificate(&problem).expect("a certificate"));
    let advice = timed("advice: search for a number of steps", || hypotheses::advice(&problem, &certificate));
    for finding in certificate.findings.iter().chain(&advice) {
        println!("  ({}) {}", finding.id, finding.status);
    }
}
