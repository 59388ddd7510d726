//! The norm that a test of Elmer prints, of a run on the mesh of that test.

use amontons::case;
use amontons::output::Memory;
use amontons::run::{Settings, run};
use amontons::verify::{BENCHMARKS, benchmark};

/// Elmer, fem/tests/LimitDisplacement: `Reference Norm`, the root mean square of the displacements of all nodes.
const NORM: f64 = 0.428_346_960_939_933_85;

#[test]
fn the_beam_above_a_parabola_has_the_norm_that_elmer_prints() {
    let (name, text) = BENCHMARKS.iter().find(|(name, _)| *name == "beam-above-parabola").expect("the benchmark");
    let problem = case::parse(&benchmark(name, text), &[]).expect("a case").problem;
    let mut memory = Memory::new().states_every(1);
    run(&problem, &Settings { certificate: false, ..Settings::default() }, &mut [&mut memory]).expect("a run");
    let u = &memory.states.last().expect("a state").u;
    assert_eq!(u.len(), 2 * 90 * 46);
    let norm = (u.iter().map(|u| u * u).sum::<f64>() / u.len() as f64).sqrt();
    assert!((norm / NORM - 1.0).abs() < 1e-9, "{norm}");
}
