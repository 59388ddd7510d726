//! The manufactured solution of two bodies that slide on each other, or stick: orders of the errors, the reference in
//! closed form and on a finer mesh.

use std::f64::consts::PI;

use crate::common;
use amontons::case::{self, ReferenceRequest, Source, StudyRequest};
use amontons::convergence::{StudySettings, Vary};

fn text() -> String {
    let path = common::file("crates/amontons/benchmarks/pair-manufactured.toml");
    std::fs::read_to_string(path).expect("the benchmark")
}

/// The case with bodies that stick: the upper one does not move along the lower one, and friction is never exceeded.
fn stuck() -> String {
    let text = text().replace("if(y < 1.5, 0, 0.1)", "0").replace(" + 0.1)\", \"t*(-0.02", ")\", \"t*(-0.02");
    let heat = text.replace("heat_inflow = \"-0.06*", "heat_inflow = \"-0*").replace("\"-0.04*", "\"-0*");
    let (before, rest) = heat.split_at(heat.find("friction = ").expect("a law"));
    let rest = &rest[rest.find('\n').expect("a line")..];
    format!("{before}friction = {{ law = \"coulomb\", coefficient = 2 }}{rest}")
}

/// √(Σ ω (p − p̂)²) at the end, and that of the traction along the sides.
fn on_contact(text: &str, level: usize) -> [f64; 2] {
    let cells = |n: usize| format!("mesh.blocks[{}].n=[{n}, {n}]", usize::from(n != level));
    let overrides = [cells(level), cells(level * 3 / 2)];
    let problem = case::parse(&Source::new("orders", text), &overrides).unwrap_or_else(|e| panic!("{e}")).problem;
    let run = common::solve(&problem);
    let states = &run.reports.last().expect("a step").contact.states;
    let factor = problem.timeline.end() + 0.1;
    let mut sums = [0.0; 2];
    for (point, state) in problem.contact_boundary().points.iter().zip(states) {
        let (s, c) = (PI * point.x[0]).sin_cos();
        let exact = [0.06 + (0.018 - 0.01 * PI) * c, 0.05 + (0.01 + 0.006 * PI) * s].map(|f| factor * f);
        // σν = −p ν − q, and ν = −e_y on the upper side: σ_xy = q_x.
        for (sum, off) in sums.iter_mut().zip([state.pressure - exact[0], state.q[0] - exact[1]]) {
            *sum += point.weight * off * off;
        }
    }
    sums.map(f64::sqrt)
}

/// In L² 1.5 or better for pressures and tractions that follow the jump or the pressure. What holds bodies that stick
/// is a multiplier alone: dual functions reproduce constants, not linear functions, which is order 1.
#[test]
fn pressure_and_traction_have_their_order() {
    for (what, text) in [("slip", text()), ("stick", stuck())] {
        let errors = [8, 16, 32].map(|level| on_contact(&text, level));
        for (c, name) in ["pressure", "traction"].into_iter().enumerate() {
            let orders: Vec<f64> = errors.windows(2).map(|pair| (pair[0][c] / pair[1][c]).log2()).collect();
            println!("{what}, {name}: {:?}, orders {orders:.3?}", errors.map(|e| e[c]));
            let least = if what == "stick" && name == "traction" { 0.95 } else { 1.35 };
            assert!(orders[1] > least, "{what}, {name}: orders {orders:?}");
        }
    }
}

/// Where bodies touch, the levels are compared in the body that they belong to: against a finer mesh the errors are
/// those against the solution, up to the error of that mesh.
#[test]
fn a_finer_mesh_is_as_good_a_reference_as_the_solution() {
    let source = Source::new("orders", text());
    let study = |levels: &[usize], reference| {
        let request = StudyRequest { levels: levels.to_vec(), vary: Vary::Space, power: 1, reference };
        let study = case::study(&source, &["time.steps=1".to_owned()], &request).unwrap_or_else(|e| panic!("{e}"));
        study.run(&StudySettings::default()).unwrap_or_else(|e| panic!("{e}"))
    };
    let (exact, finer) = (study(&[4, 8], ReferenceRequest::Exact), study(&[4, 8], ReferenceRequest::Level(32)));
    assert!(finer.nested);
    let odd = StudyRequest { levels: vec![5], vary: Vary::Space, power: 1, reference: ReferenceRequest::Exact };
    let told = case::study(&source, &[], &odd).err().map(|error| error.to_string()).unwrap_or_default();
    let expected = "expected 6 · (level / 4) to be a whole number of cells across";
    assert_eq!(told, format!("level 5 of a case with 4 cells and 6 cells across, {expected}"));
    // The mesh of the reference has 1/4 of the error of the finer level, squares add up: 1 − √(1 − 1/16) = 3 %.
    for (exact, finer) in exact.rows.iter().zip(&finer.rows) {
        assert!((finer.error_u / exact.error_u - 1.0).abs() < 0.035, "u: {finer:?}, {exact:?}");
        assert!((finer.error_w / exact.error_w - 1.0).abs() < 0.1, "w: {finer:?}, {exact:?}");
    }
}
