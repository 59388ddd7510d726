//! The study of (5.2) against an independent program: `reference/convergence.csv`.
#![allow(clippy::float_cmp, reason = "counts are exact")]

use crate::common::{case, reading};
use amontons::convergence::{Reference, Study, StudyLevel, StudySettings, Vary};

fn level(name: &str, foundation: &str, n: usize) -> StudyLevel {
    let mut overrides = reading(name);
    overrides.extend([
        format!("mesh.n={n}"),
        format!("time.steps={n}"),
        format!("contact.heat.foundation_temperature={foundation}"),
    ]);
    let case = case("cases/paper.toml", &overrides);
    StudyLevel { level: n, problem: case.problem, text: case.text, measured: None }
}

/// Tolerance of the reference: 1e-6 relative.
fn assert_table(name: &str, foundation: &str) {
    let study = Study {
        vary: Vary::Both,
        levels: [16, 32, 64, 128].map(|n| level(name, foundation, n)).to_vec(),
        reference: Reference::Level(Box::new(level(name, foundation, 256))),
    };
    let table = study.run(&StudySettings::default()).unwrap_or_else(|e| panic!("{e}"));
    assert!(table.nested);
    let text = include_str!("../reference/convergence.csv");
    let theta_f: f64 = foundation.parse().expect("a number");
    let mut compared = 0;
    for line in text.lines().skip(1) {
        let columns: Vec<&str> = line.split(',').collect();
        let number = |i: usize| columns[i].parse::<f64>().expect("a number");
        if columns[0] != name || number(1) != theta_f {
            continue;
        }
        let row = table.rows.iter().find(|r| r.level == number(2) as usize).expect("the level");
        assert!((row.h - number(3)).abs() < 1e-12 && (row.k - number(4)).abs() < 1e-12);
        for (what, found, expected) in [
            ("w", row.error_w, number(5)),
            ("u", row.error_u, number(6)),
            ("θ", row.error_theta, number(7)),
            ("E", row.error, number(8)),
        ] {
            assert!(
                (found - expected).abs() <= 1e-6 * expected,
                "{name}, θ_F = {foundation}, level {}: {what} = {found:.10e}, expected {expected:.10e}",
                row.level
            );
        }
        compared += 1;
    }
    assert_eq!(compared, 4);
}

#[test]
fn the_paper_s_study_at_both_temperatures() {
    assert_table("MR", "0");
    assert_table("MR", "10");
}

#[test]
fn the_study_of_the_identity_reading() {
    assert_table("identity", "0");
    assert_table("identity", "10");
}
