//! Bodies that move far: a small stiff body that slides over many times its length is right at every size.

use amontons::case::{self, Source};
use amontons::output::{Memory, Summary};
use amontons::run::{self, Settings};

const G: f64 = 9.81;
const MU: f64 = 0.3;
const STEPS: usize = 50;

fn run(text: &str) -> (Memory, Summary) {
    let case = case::parse(&Source::new("far.toml", text), &[]).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let mut memory = Memory::new().states_every(STEPS).reports();
    let settings = Settings { certificate: false, ..Settings::default() };
    let summary = run::run(&case.problem, &settings, &mut [&mut memory]);
    (memory, summary.unwrap_or_else(|error| panic!("{error}\n{text}")))
}

/// A steel block of this length on a slope of 30 degrees, on the side `below`, 1 s; the axes are those of the slope, in
/// the plane turned by quarters of a turn.
fn slider(length: f64, way: &str, more: &str) -> (String, [f64; 3]) {
    let (down, along) = (7850.0 * G * 30f64.to_radians().cos(), 7850.0 * G * 30f64.to_radians().sin());
    let height = 0.4 * length;
    let (kind, size, n, force, below, unit) = match way {
        "on a side" => ("rectangle", vec![height, length], "[3, 6]", vec![0.0 - down, along], "left", [0.0, 1.0, 0.0]),
        "back" => {
            ("rectangle", vec![length, height], "[6, 3]", vec![0.0 - along, 0.0 - down], "bottom", [-1.0, 0.0, 0.0])
        }
        "space" => {
            let (x, z) = (0.6 * along, 0.8 * along);
            ("box", vec![length, height, length], "[3, 2, 3]", vec![x, 0.0 - down, z], "bottom", [0.6, 0.0, 0.8])
        }
        _ => ("rectangle", vec![length, height], "[6, 3]", vec![along, 0.0 - down], "bottom", [1.0, 0.0, 0.0]),
    };
    let state = if kind == "box" { "" } else { ", stress_state = \"plane-strain\"" };
    let text = format!(
        "name = \"slider\"\n[mesh]\nkind = \"{kind}\"\nsize = {size:?}\nn = {n}\nelements = \"Q1\"\n\
         [time]\nend = 1.0\nsteps = {STEPS}\n[material]\ndensity = 7850\n\
         elasticity = {{ law = \"isotropic\", young = 210e9, poisson = 0.3{state} }}\n\
         [load]\nbody_force = {force:?}\n[contact]\non = \"{below}\"\nnormal = {{ law = \"signorini\" }}\n\
         friction = {{ law = \"coulomb\", coefficient = {MU} }}\n{more}"
    );
    (text, unit)
}

/// a k² N (N + 1)/2, the way of the scheme at the acceleration a = g (sin 30° − μ cos 30°).
fn way_of_the_scheme() -> f64 {
    let (a, n) = (G * (0.5 - MU * 0.75f64.sqrt()), STEPS as f64);
    a * (n + 1.0) / (2.0 * n)
}

#[test]
fn a_small_slider_slides_as_a_large_one() {
    let ways = ["along", "on a side", "back", "space"];
    for (way, length) in ways.into_iter().flat_map(|way| [0.14, 1.4e-3, 1.4e-4].map(|length| (way, length))) {
        let (text, unit) = slider(length, way, "");
        let (memory, summary) = run(&text);
        let state = memory.states.last().expect("a state");
        let dim = if way == "space" { 3 } else { 2 };
        let n = (state.u.len() / dim) as f64;
        let moved: f64 =
            state.u.chunks_exact(dim).map(|u| (0..dim).map(|c| u[c] * unit[c]).sum::<f64>()).sum::<f64>() / n;
        let expected = way_of_the_scheme();
        assert!((moved / expected - 1.0).abs() < 1e-6, "{way}, {length}: {moved} for {expected}");
        assert_eq!(summary.solver.halved_steps, 0, "{way}, {length}");
        let closing = state.ledger.relative_closing_error();
        assert!(closing.abs() < 1e-9, "{way}, {length}: {closing:e}");
    }
}
