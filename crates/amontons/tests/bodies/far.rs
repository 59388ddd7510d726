//! Bodies that move far: a small stiff body that slides over many times its length is right at every size.

use amontons::case::{self, Source};
use amontons::output::{Memory, Summary};
use amontons::run::{self, Settings};

const G: f64 = 9.81;
const MU: f64 = 0.3;

fn run(text: &str, steps: usize) -> (Memory, Summary) {
    let case = case::parse(&Source::new("far.toml", text), &[]).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let mut memory = Memory::new().states_every(steps).reports();
    let settings = Settings { certificate: false, ..Settings::default() };
    let summary = run::run(&case.problem, &settings, &mut [&mut memory]);
    (memory, summary.unwrap_or_else(|error| panic!("{error}\n{text}")))
}

/// A steel block of this length on a slope of 30 degrees, on the side `below`, 1 s; the axes are those of the slope,
/// in the plane turned by quarters of a turn.
fn slider(length: f64, way: &str, steps: usize) -> (String, [f64; 3]) {
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
         [time]\nend = 1.0\nsteps = {steps}\n[material]\ndensity = 7850\n\
         elasticity = {{ law = \"isotropic\", young = 210e9, poisson = 0.3{state} }}\n\
         [load]\nbody_force = {force:?}\n[contact]\non = \"{below}\"\nnormal = {{ law = \"signorini\" }}\n\
         friction = {{ law = \"coulomb\", coefficient = {MU} }}\n"
    );
    (text, unit)
}

/// a k² N (N + 1)/2, the way of the scheme at the acceleration a = g (sin 30° − μ cos 30°).
fn way_of_the_scheme(steps: usize) -> f64 {
    let (a, n) = (G * (0.5 - MU * 0.75f64.sqrt()), steps as f64);
    a * (n + 1.0) / (2.0 * n)
}

/// The way does not depend on the size, in the plane along either axis and back, and in space. A first step in halves
/// is shorter by a k²/4. Until the round-off of the displacement exceeds 1e-4 of the load it is accepted in a step,
/// and the way has a share of it. At 10 µm the mass of a cell is 1e-15 of its stiffness in a step of 5 ms.
#[test]
fn a_small_slider_slides_as_a_large_one() {
    let ways = ["along", "on a side", "back", "space"];
    let all = ways.into_iter().flat_map(|way| [0.14, 1.4e-3, 1.4e-4].map(|length| (way, length, 50)));
    for (way, length, steps) in all.chain([("along", 1e-5, 200)]) {
        let (text, unit) = slider(length, way, steps);
        let (memory, summary) = run(&text, steps);
        let state = memory.states.last().expect("a state");
        let dim = if way == "space" { 3 } else { 2 };
        let n = (state.u.len() / dim) as f64;
        let along = |u: &[f64]| (0..dim).map(|c| u[c] * unit[c]).sum::<f64>();
        let moved: f64 = state.u.chunks_exact(dim).map(along).sum::<f64>() / n;
        let k = 1.0 / steps as f64;
        let halved = 0.25 * k * k * 2.0 * way_of_the_scheme(steps) * summary.solver.halved_steps as f64;
        let expected = way_of_the_scheme(steps) - halved;
        assert!((moved / expected - 1.0).abs() < 1e-5, "{way}, {length}: {moved} for {expected}");
        assert!(length < 1e-4 || summary.solver.halved_steps == 0, "{way}, {length}");
        let closing = state.ledger.relative_closing_error();
        assert!(closing.abs() < 1e-9, "{way}, {length}: {closing:e}");
    }
}
