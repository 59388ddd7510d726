//! Impact on a rigid support: what backward Euler makes of a sum over time, which no check of a benchmark takes.

use std::f64::consts::PI;

use amontons::case::{self, Source};
use amontons::step::{March, Scheme};
use amontons::verify::BENCHMARKS;

/// The mean pressure over the contact, 1 < t < 2, of `bouncing-bar-signorini` is 1/2 − √(k/π): the front that ends the
/// contact comes smoothed, p = erf(s/√2σ)/2 with s = 2 − t and σ² = 2k, and ∫ (1/2 − p) ds = σ/√(2π). What is left out
/// is k/2 by the rectangle rule and h/2 by the node that lands, each times 1/2.
#[test]
fn the_mean_pressure_of_a_bounce_lacks_the_root_of_the_step() {
    let (name, text) = BENCHMARKS.iter().find(|(name, _)| *name == "bouncing-bar-signorini").unwrap();
    for steps in [384, 768, 1536] {
        let problem = case::parse(
            &Source::new(format!("{name}.toml"), *text),
            &[format!("time.steps={steps}"), "mesh.n=256".to_owned()],
        )
        .unwrap_or_else(|error| panic!("{error}"))
        .problem;
        let (k, h) = (problem.timeline.longest(), 1.0 / 256.0);
        let mut scheme = March::new(&problem).unwrap();
        let mut state = scheme.initial().unwrap();
        let mut impulse = 0.0;
        for _ in 0..problem.timeline.steps() {
            let (next, report) = scheme.step(&state).unwrap_or_else(|error| panic!("{error}"));
            impulse += k * report.contact.states[0].pressure;
            state = next;
        }
        let (lacks, expected) = (0.5 - impulse, (k / PI).sqrt());
        println!("k = {k:.3e}: mean pressure {impulse:.8}, lacks {lacks:.5e}, √(k/π) = {expected:.5e}");
        assert!((lacks - expected).abs() <= 0.25 * (k + h), "k = {k}: {lacks} against {expected}");
    }
}
