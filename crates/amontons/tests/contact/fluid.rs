//! Fluid that enters where a contact is open: closed forms of a seal that is pressed onto a wedge of gap, in the plane,
//! of revolution and in space, turned, between bodies and on a foundation, by a factor and by an iteration.

use std::sync::Arc;

use amontons::case::{self, Source};
use amontons::linalg::{Backend, Multigrid, Supernodal};
use amontons::output::Memory;
use amontons::problem::Problem;
use amontons::run::{self, Settings};
use amontons::step::{March, Scheme};
use amontons::tensor::{Point, Rotation};

use crate::common::{Random, changed, solve, spoil, told};

fn problem(text: &str) -> Problem {
    case::parse(&Source::new("seal.toml", text), &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).problem
}

const STIFFNESS: f64 = 100.0;

/// A rigid seal of length 1 (and depth 1), guided, pressed by a force onto a layer with the gap 0.02 x: it is closed
/// from its left end on.
fn seal(dim: usize, n: usize, force: f64, fluid: &str) -> String {
    let (mesh, flat, zero) = if dim == 3 {
        (format!("kind = \"box\"\nsize = [1.0, 0.3, 1.0]\nn = [{n}, 1, 2]"), "", "[0, FORCE, 0]")
    } else {
        (
            format!("kind = \"rectangle\"\nsize = [1.0, 0.3]\nn = [{n}, 1]"),
            ", stress_state = \"plane-strain\"",
            "[0, FORCE]",
        )
    };
    let force = zero.replace("FORCE", &format!("\"{:?}*min(1, t)\"", -force));
    format!(
        r#"name = "seal"
units = "dimensionless"
[mesh]
{mesh}
elements = "Q1"
[time]
end = 2.0
steps = 4
[material]
density = 0
elasticity = {{ law = "isotropic", young = 1000.0, poisson = 0.3{flat} }}
[[rigid]]
on = "body"
guided = true
force = {force}
[contact]
on = "bottom"
gap = "0.02*x"
normal = {{ law = "compliance", stiffness = {STIFFNESS:?} }}
{fluid}
"#
    )
}

/// How far a seal that bears the force F is pressed in: c δ²/(2a) + p_f (1 − δ/a) = F, a = 0.02.
fn depth(force: f64, pressure: f64) -> f64 {
    // (c/2a) δ² − (p_f/a) δ + p_f − F = 0.
    let (a, b) = (STIFFNESS / 0.04, pressure / 0.02);
    (b + (b * b + 4.0 * a * (force - pressure)).sqrt()) / (2.0 * a)
}

fn turned(problem: &Problem, random: &mut Random, backend: Arc<dyn Backend>) -> (Problem, Rotation) {
    let dim = problem.mesh.dim;
    let axis = if dim == 3 { [random.number(), random.number(), 1.0] } else { [0.0, 0.0, 1.0] };
    let rotation = Rotation::about(&axis, 3.0 * random.number());
    let down = rotation.vector(&[0.0, -1.0, 0.0]);
    let along = rotation.vector(&[1.0, 0.0, 0.0]);
    let changed = changed(problem, |data| {
        for x in &mut Arc::make_mut(&mut data.mesh).points {
            *x = rotation.vector(x);
        }
        let field = |text: String| amontons::expression::Expression::parse(&text).expect("an expression").into();
        let size = data.rigid[0].force[1].value(&[0.0; 3], 1.0).abs();
        data.rigid[0].force = (0..dim).map(|c| field(format!("{:?}*min(1, t)", size * down[c]))).collect();
        for contact in &mut data.contacts {
            contact.gap = field(format!("0.02*({:?}*x + {:?}*y + {:?}*z)", along[0], along[1], along[2]));
        }
        data.backend = backend;
    });
    (changed, rotation)
}

/// By how much the seal has moved down.
fn moved(memory: &Memory, problem: &Problem, rotation: &Rotation) -> f64 {
    let (state, dim) = (memory.states.last().expect("a state"), problem.mesh.dim);
    let u: Point = std::array::from_fn(|c| if c < dim { state.u[c] } else { 0.0 });
    let down = rotation.vector(&[0.0, -1.0, 0.0]);
    (0..3).map(|c| u[c] * down[c]).sum()
}

/// The fluid stands at the end of the seal that is open: the closed form of first order in the mesh, since it wets the
/// points that are open, wherever the body lies.
#[test]
fn a_seal_is_lifted_by_what_wets_it() {
    let mut random = Random(17);
    let (force, pressure) = (0.6, 0.25);
    let exact = depth(force, pressure);
    let backends: [Arc<dyn Backend>; 2] = [Arc::new(Supernodal), Arc::new(Multigrid::default())];
    for dim in [2, 3] {
        for backend in &backends {
            let errors = [20, 40, 80].map(|n| {
                let text = seal(dim, n, force, &format!("fluid = {{ pressure = {pressure}, from = \"right\" }}"));
                let (problem, rotation) = turned(&problem(&text), &mut random, Arc::clone(backend));
                let memory = solve(&problem);
                let state = memory.states.last().expect("a state");
                assert!(state.ledger.relative_closing_error() < 1e-10, "{:e}", state.ledger.relative_closing_error());
                let found = moved(&memory, &problem, &rotation);
                // What bears the force in the numbers of the mesh: each point is wet or pressed.
                let boundary = problem.contact_boundary();
                let along = rotation.vector(&[1.0, 0.0, 0.0]);
                let at = |x: &Point| (0..3).map(|c| along[c] * x[c]).sum::<f64>();
                let borne = boundary.points.iter().map(|point| {
                    let r = found - 0.02 * at(&point.x);
                    point.weight * if r > 0.0 { STIFFNESS * r } else { pressure }
                });
                let borne: f64 = borne.sum();
                assert!((borne - force).abs() < 1e-8, "{dim} {n}: {borne}");
                (found - exact).abs()
            });
            assert!(errors[2] < 0.4 * errors[0] && errors[2] < 0.01 * exact, "{dim}: {errors:?}, {exact}");
        }
    }
}

/// A fluid that stands at the closed end does not enter, and one that rough faces let pass wets all that is pressed by
/// less than their limit.
#[test]
fn closed_points_keep_the_fluid_out() {
    let down = |fluid: &str| {
        let problem = problem(&seal(2, 40, 0.6, fluid));
        let (problem, rotation) = turned(&problem, &mut Random(5), Arc::new(Supernodal));
        moved(&solve(&problem), &problem, &rotation)
    };
    let dry = down("");
    assert!((dry - depth(0.6, 0.0)).abs() < 1e-3 * dry, "{dry}");
    let closed = down("fluid = { pressure = 0.25, from = \"left\" }");
    assert!((closed - dry).abs() < 1e-12, "{closed}, {dry}");
    // Pressed by 3 at the most: the fluid is everywhere, and lifts by p_f.
    let all = down("fluid = { pressure = 0.25, from = \"left\", sealed_above = 3 }");
    let lifted = depth(0.35, 0.0);
    assert!((all - lifted).abs() < 1e-3 * lifted, "{all}, {lifted}");
}

/// Between two bodies the fluid presses both: the lower one, in a bed of springs, is pressed down by the force as a
/// whole, whichever side bears the points.
#[test]
fn a_fluid_between_bodies_presses_both() {
    let (force, pressure) = (0.6, 0.25);
    let ways = ["", "geometry = \"updated\"\n", "friction = { law = \"coulomb\", coefficient = 0.3 }\n"];
    for (bears, more) in ["seal_bottom", "base_top"].into_iter().flat_map(|side| ways.map(|more| (side, more))) {
        for n in [[40, 40], [48, 31]] {
            let text = seal(2, 1, force, "")
                .replace(
                    "kind = \"rectangle\"\nsize = [1.0, 0.3]\nn = [1, 1]",
                    &format!(
                        "kind = \"blocks\"\nblocks = [{{ name = \"seal\", size = [1.0, 0.3], origin = [0, 0.2], n = [{}, 1] }}, {{ name = \"base\", size = [1.0, 0.2], n = [{}, 1] }}]",
                        n[0], n[1]
                    ),
                )
                .replace("elements = \"Q1\"\n", "")
                .replace("on = \"body\"", "on = \"seal\"")
                .replace(
                    "on = \"bottom\"",
                    &format!("on = \"seal_bottom\"\nwith = \"base_top\"\nnonmortar = \"{bears}\"\n{more}fluid = {{ pressure = {pressure}, from = \"seal_right\" }}"),
                );
            let text = text
                + "[[rigid]]\non = \"base\"\nguided = true\n[[boundary]]\non = \"base_bottom\"\nspring = [50, 50]\n";
            let problem = problem(&text);
            let memory = solve(&problem);
            let state = memory.states.last().expect("a state");
            let at = |side: &str| state.u[2 * problem.mesh.facets[side].node_list()[0] as usize + 1];
            assert!((at("base_bottom") + force / 50.0).abs() < 1e-9, "{}", at("base_bottom"));
            let depth = depth(force, pressure);
            let found = at("base_top") - at("seal_bottom");
            assert!((found - depth).abs() < 0.02 * depth, "{bears} {more} {n:?}: {found}, {depth}");
            assert!(state.ledger.relative_closing_error() < 1e-10);
        }
    }
}

/// As the pressure rises the fluid comes through: when, and past which gap.
#[test]
fn a_leak_is_told_of() {
    let text = seal(2, 40, 0.0, "fluid = { pressure = \"0.5*t\", from = \"right\", to = \"left\" }")
        .replace("guided = true\nforce", "guided = true\n#")
        .replace("steps = 4", "steps = 40")
        + "[[boundary]]\non = \"top\"\nspring = [10, 10]\n[initial]\ndisplacement = [0, 0]\n[load]\nbody_force = [0, -1]\n";
    let problem = problem(&text);
    let memory = solve(&problem);
    // Pressed by its weight of 0.3 on a spring of 10: c δ²/(2a) + p_f (1 − δ/a) + 10 δ = 0.3 has a solution up to the
    // double root of p_f = 0.3026. The step before has p_f = 0.3.
    let first = memory.states.iter().find(|state| state.surface.wet.leaks[0].is_some()).expect("a leak");
    let leak = first.surface.wet.leaks[0].expect("a leak");
    assert!((leak.t - first.t).abs() < 1e-15 && (leak.t - 0.65).abs() < 1e-12, "{leak:?}");
    assert!(leak.gap >= 0.0 && problem.contact_boundary().points[leak.narrowest].x[0] < 1e-12, "{leak:?}");
    let summary = run::run(&problem, &Settings::default(), &mut []).expect("a run");
    let told = summary.warnings.iter().find(|finding| finding.id.to_string() == "leak").expect("a warning");
    assert!(told.message.contains("\"left\"") && told.message.contains("t = "), "{}", told.message);
}

/// A run that goes on from a state has the same bits.
#[test]
fn a_resumed_run_is_the_same() {
    let text =
        seal(2, 40, 0.6, "fluid = { pressure = \"0.3*t\", from = \"right\" }").replace("steps = 4", "steps = 16");
    let problem = problem(&text);
    let mut scheme = March::new(&problem).expect("a scheme");
    let mut state = scheme.initial().expect("a state");
    for _ in 0..9 {
        state = scheme.step(&state).expect("a step").0;
    }
    let mut other = March::new(&problem).expect("a scheme");
    other.recall(&scheme.kept()).expect("what is kept");
    let mut again = state.clone();
    for _ in 0..6 {
        state = scheme.step(&state).expect("a step").0;
        again = other.step(&again).expect("a step").0;
        assert!(state.u.iter().zip(again.u.iter()).all(|(a, b)| a.to_bits() == b.to_bits()));
        assert_eq!(state.surface.wet, again.surface.wet);
    }
}

/// One message for each fault.
#[test]
fn faults_are_named() {
    let text = seal(2, 4, 0.6, "fluid = { pressure = 0.25, from = \"right\" }");
    for (old, new, expected) in [
        (
            "from = \"right\"",
            "from = \"rigt\"",
            "contact.fluid.from: found \"rigt\", expected one of the sides, edges and points",
        ),
        (
            "from = \"right\"",
            "from = \"top\"",
            "contact.fluid.from: found \"top\", which has no node of the contact, expected a side, an edge or points that meet the contact",
        ),
        (
            "from = \"right\"",
            "from = \"bottom\"",
            "contact.fluid.from: found \"bottom\", which is a side of the contact itself, expected",
        ),
        ("pressure = 0.25, ", "", "contact.fluid.pressure: found no such key, expected"),
        ("from = \"right\"", "from = \"right\", sealed_above = -1", "contact.fluid.sealed_above: found -1"),
        (
            "from = \"right\"",
            "from = \"right\", leaks = true",
            "contact.fluid.leaks: found an unknown key, expected one of",
        ),
    ] {
        let said = told(&Source::new("seal.toml", spoil(&text, old, new)), &[]);
        assert!(said.contains(expected) && said.lines().count() == 1, "{said}");
    }
}
