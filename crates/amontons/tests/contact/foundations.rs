//! Foundations that move, warm up and wear, and several contact sides: what holds exactly in a step, and orders in the
//! step.
#![allow(clippy::too_many_lines, clippy::too_many_arguments, reason = "a test is one list of cases")]

use std::sync::Arc;

use crate::common::{checked, largest, solve};
use amontons::case::{self, Source};
use amontons::equation::StepError;
use amontons::linalg::dot;
use amontons::mesh::{FacetBlock, FacetSet};
use amontons::output::Memory;
use amontons::problem::Problem;
use amontons::run::with_threads;
use amontons::state::{State, StepReport};
use amontons::step::{March, Scheme};
use amontons::tensor::{self, Point};
use amontons::verify::BENCHMARKS;

/// Units of length, time, mass and temperature in which a case is written.
type Units = [f64; 4];
const SI: Units = [1.0; 4];

/// A body that slides into a corner: below, Signorini's conditions on a ball that moves, with friction, wear by a
/// constant, and a foundation that friction heats; on the right, compliance on a plane that leans and moves, with
/// another friction, wear by the temperature, and another foundation. Nothing else holds it. The laws hold at the nodes
/// below and at Gauss points on the right.
fn everything(dim: usize, [l, s, m, kelvin]: Units, steps: usize) -> String {
    let vector = |components: [String; 3]| format!("[{}]", components[..dim].join(", "));
    let number = |unit: f64, values: [f64; 3]| vector(values.map(|v| format!("{:e}", v * unit)));
    let stress = m / (l * s * s);
    let (mesh, thickness) = match dim {
        2 => (format!("kind = \"rectangle\"\nsize = {}\nn = [5, 4]", number(l, [1.0, 0.8, 0.0])), 1.0),
        _ => (format!("kind = \"box\"\nsize = {}\nn = [3, 3, 2]\nelements = \"Q1\"", number(l, [1.0, 0.8, 0.6])), l),
    };
    let moving = |unit: f64, start: [f64; 3], rate: [f64; 3]| {
        vector([0, 1, 2].map(|c| format!("\"{:e} + {:e}*t\"", start[c] * unit, rate[c] * unit / s)))
    };
    let capacity = stress * l * l * thickness / kelvin;
    format!(
        r#"
name = "everything"
[mesh]
{mesh}
[time]
end = {s:e}
steps = {steps}
[material]
density = {density:e}
heat_capacity = {heat:e}
expansion = {expansion:e}
coupling = {coupling:e}
conductivity = {conductivity:e}
elasticity = {{ law = "isotropic", young = {young:e}, poisson = 0.2{state} }}
viscosity = {{ law = "lame", first = {viscosity:e}, second = {viscosity:e} }}
[load]
body_force = {force}
[[contact]]
on = "bottom"
obstacle = {{ shape = "sphere", center = {center}, radius = {radius:e}, geometry = "updated" }}
normal = {{ law = "signorini" }}
friction = {{ law = "coulomb", coefficient = 0.3 }}
wear = {{ law = "archard", coefficient = {wear:e} }}
heat = {{ law = "pressure", coefficient = {by_pressure:e}, foundation_temperature = {warm:e} }}
frictional_heat = 0.4
foundation = {{ heat_capacity = {c1:e}, exchange = {h1:e}, surroundings = "{surroundings:e}*t" }}
[[contact]]
on = "right"
quadrature = "gauss"
gap = {gap:e}
obstacle = {{ shape = "plane", point = {point}, normal = {normal} }}
normal = {{ law = "compliance", stiffness = {stiffness:e} }}
friction = {{ law = "coulomb", coefficient = 0.1 }}
wear = {{ law = "archard-temperature", temperature = [0, {hot:e}], coefficient = [{wear:e}, {worse:e}] }}
heat = {{ law = "ramp", conductance = {conductance:e}, width = {width:e}, foundation_temperature = {cold:e} }}
frictional_heat = 0.7
foundation = {{ heat_capacity = {c2:e} }}
"#,
        state = if dim == 2 { ", stress_state = \"plane-stress\"" } else { "" },
        density = m / l.powi(3),
        heat = stress / kelvin,
        expansion = 0.1 * stress / kelvin,
        coupling = 0.1 * stress / s,
        conductivity = 0.5 * m * l / (s.powi(3) * kelvin),
        young = 20.0 * stress,
        viscosity = stress * s,
        force = number(stress / l, [4.0, -6.0, 1.0]),
        center = moving(l, [0.5, -4.0, 0.3], [-0.5, 0.05, 0.2]),
        radius = 4.0 * l,
        wear = 0.02 / stress,
        worse = 0.06 / stress,
        by_pressure = 0.1 * l / (s * kelvin),
        warm = 5.0 * kelvin,
        cold = -kelvin,
        hot = 2.0 * kelvin,
        c1 = 0.3 * capacity,
        h1 = 0.2 * capacity / s,
        surroundings = 3.0 * kelvin / s,
        gap = -0.01 * l,
        point = moving(l, [1.05, 0.0, 0.0], [-0.02, 0.4, 0.0]),
        normal = vector(["-1".to_owned(), "0.05".to_owned(), "0".to_owned()]),
        stiffness = 500.0 * stress / l,
        conductance = 0.8 * m / (s.powi(3) * kelvin),
        width = 1e-2 * l,
        c2 = 0.5 * capacity,
    )
}

fn problem(text: &str, overrides: &[String]) -> Problem {
    case::parse(&Source::new("case.toml", text), overrides).unwrap_or_else(|error| panic!("{error}")).problem
}

fn benchmark(name: &str, overrides: &[String]) -> Problem {
    let (_, text) = BENCHMARKS.iter().find(|(known, _)| *known == name).expect("a benchmark");
    problem(text, overrides)
}

/// Steps with what was before and after, and the report.
fn steps(memory: &Memory) -> impl Iterator<Item = (&State, &State, &StepReport)> {
    memory.states.iter().zip(&memory.states[1..]).zip(&memory.reports).map(|((old, new), report)| (old, new, report))
}

fn end(memory: &Memory) -> &State {
    memory.states.last().expect("a state")
}

/// In each step of everything at once: the energy and the heat, the forces and their moments, the laws at each contact
/// point, and the balance of each foundation, written down here anew from the states and the reports.
#[test]
fn what_a_step_satisfies_with_everything_at_once() {
    for (dim, coupling) in
        [(2, "staggered"), (2, "fixed-point"), (2, "monolithic"), (3, "staggered"), (3, "monolithic")]
    {
        let problem = problem(&everything(dim, SI, 24), &[format!("scheme.coupling=\"{coupling}\"")]);
        let scheme = March::new(&problem).expect("a regular system");
        let discrete = scheme.discretization();
        let memory = solve(&problem);
        let (mut pressed, mut slipped, mut worst) = ([0; 2], [0; 2], [0.0f64; 6]);
        for (old, new, report) in steps(&memory) {
            assert_eq!(report.parts, 1, "the step was made as a whole");
            let k = new.t - old.t;
            let contact = &report.contact;
            worst[0] = worst[0]
                .max(new.ledger.relative_closing_error().abs())
                .max(new.ledger.relative_heat_closing_error().abs());
            // A motion that strains nothing is resisted by inertia, the weight and the contact alone.
            let change: Vec<f64> = new.w.iter().zip(&old.w).map(|(new, old)| (new - old) / k).collect();
            let inertia = discrete.mass.apply(&change);
            let force: Vec<f64> = (0..new.u.len()).map(|i| [4.0, -6.0, 1.0][i % dim]).collect();
            let load = discrete.mass.apply(&force);
            for motion in rigid(dim) {
                let field: Vec<f64> = discrete.mesh.points.iter().flat_map(|x| motion(x)[..dim].to_vec()).collect();
                let bears: f64 = discrete
                    .boundary
                    .points
                    .iter()
                    .zip(&contact.states)
                    .map(|(point, state)| {
                        let traction: Point = std::array::from_fn(|c| state.pressure * state.normal[c] + state.q[c]);
                        point.weight * tensor::dot(&traction, &motion(&point.x))
                    })
                    .sum();
                worst[1] = worst[1].max((dot(&inertia, &field) - dot(&load, &field) + bears).abs() / 6.0);
            }
            let mut received = [0.0; 2];
            for (i, (point, state)) in discrete.boundary.points.iter().zip(&contact.states).enumerate() {
                let side = point.contact;
                let law = &problem.contacts[side];
                let at = |values: &[f64]| -> Point {
                    std::array::from_fn(|c| {
                        let of = |node: usize| {
                            if c < dim { values[discrete.boundary.nodes[node] as usize * dim + c] } else { 0.0 }
                        };
                        point.nodes.iter().map(|&(node, share)| share * of(node)).sum()
                    })
                };
                let obstacle = law.obstacle.as_ref().expect("an obstacle");
                let (u, w) = (at(&new.u), at(&new.w));
                let seen: Point = if obstacle.updated { at(&old.u) } else { [0.0; 3] };
                let nearest = obstacle.nearest(&std::array::from_fn(|c| point.x[c] + seen[c]), new.t);
                let [from, to] = [old.t, new.t].map(|t| obstacle.place(t));
                let moves: Point = std::array::from_fn(|c| w[c] - (to[c] - from[c]) / k);
                let across = tensor::dot(&moves, &nearest.normal);
                let slip: Point = std::array::from_fn(|c| moves[c] - across * nearest.normal[c]);
                let further: Point = std::array::from_fn(|c| u[c] - seen[c]);
                let gap = law.gap.value(&point.x, new.t)
                    + new.surface.wear[i]
                    + nearest.distance
                    + tensor::dot(&further, &nearest.normal);
                worst[2] = worst[2]
                    .max((state.penetration + gap).abs())
                    .max((0..3).map(|c| (state.slip[c] - slip[c]).abs()).fold(0.0, f64::max));
                // Archard, with the pressure and the slip of the step itself, and the temperature that the half-step
                // knew.
                let speed = tensor::length(&state.slip);
                let kappa = match side {
                    0 => 0.02,
                    _ => 0.02 + 0.04 * (temperature(&old.theta, discrete, point) / 2.0).clamp(0.0, 1.0),
                };
                let depth = new.surface.wear[i] - old.surface.wear[i];
                if side == 0 || coupling == "staggered" {
                    worst[3] = worst[3].max((depth - k * kappa * state.pressure * speed).abs());
                }
                assert!(depth >= 0.0 && state.pressure >= 0.0);
                // The normal laws, and Coulomb's.
                let (p, r) = (state.pressure, state.penetration);
                let law_error = if side == 0 {
                    if p > 0.0 { r.abs() } else { r.max(0.0) }
                } else {
                    (p - 500.0 * r.max(0.0)).abs() / 500.0
                };
                worst[4] = worst[4].max(law_error);
                let bound = [0.3, 0.1][side] * p;
                assert!(tensor::length(&state.q) <= bound * (1.0 + 1e-9) + 1e-12);
                let power = tensor::dot(&state.q, &state.slip);
                worst[4] = worst[4].max((power - bound * speed).abs());
                pressed[side] += usize::from(p > 0.0);
                slipped[side] += usize::from(p > 0.0 && speed > 1e-6);
                received[side] += point.weight * (contact.flux[i].value + power);
            }
            for side in 0..2 {
                let [now, before] = [new, old].map(|state| state.surface.foundation[side].expect("a temperature"));
                let (stores, gives) = if side == 0 {
                    (0.3 * (now - before) / k, 0.2 * (now - 3.0 * new.t))
                } else {
                    (0.5 * (now - before) / k, 0.0)
                };
                worst[5] = worst[5].max((stores + gives - received[side]).abs());
            }
        }
        println!("{dim}-d, {coupling}: pressed {pressed:?}, slipped {slipped:?}, worst {worst:?}");
        assert!(pressed.iter().chain(&slipped).all(|&n| n > 20), "all laws act: {pressed:?} {slipped:?}");
        // Residuals below 1e-11 are not refined, and do as much work.
        assert!(worst[0] < 1e-12, "energy and heat: {:e}", worst[0]);
        // A step is accepted with a residual of 1e-10 of its largest term, some tens here.
        assert!(worst[1] < 1e-10, "forces and moments: {:e}", worst[1]);
        assert!(worst[2] < 1e-13, "kinematics: {:e}", worst[2]);
        assert!(worst[3] < 1e-15, "wear: {:e}", worst[3]);
        assert!(worst[4] < 1e-10, "laws of contact: {:e}", worst[4]);
        assert!(worst[5] < 1e-11, "foundations: {:e}", worst[5]);
    }
}

/// Translations and rotations.
fn rigid(dim: usize) -> Vec<Box<dyn Fn(&Point) -> Point>> {
    let mut all: Vec<Box<dyn Fn(&Point) -> Point>> =
        (0..dim).map(|e| -> Box<dyn Fn(&Point) -> Point> { Box::new(move |_| unit(e)) }).collect();
    for (a, b) in [(0, 1), (1, 2), (2, 0)] {
        if a.max(b) < dim {
            all.push(Box::new(move |x| std::array::from_fn(|c| x[a] * unit(b)[c] - x[b] * unit(a)[c])));
        }
    }
    all
}

fn unit(e: usize) -> Point {
    std::array::from_fn(|c| f64::from(u8::from(c == e)))
}

fn temperature(
    theta: &[f64],
    discrete: &amontons::discretization::Discretization,
    point: &amontons::contact::PointOnBoundary,
) -> f64 {
    point.nodes.iter().map(|&(node, share)| share * theta[discrete.boundary.nodes[node] as usize]).sum()
}

/// A closed form is met to the first order in the step.
#[test]
fn first_order_in_the_step() {
    // h = δ (1 − exp(−t/τ)) of the rod on a compliance; θ_F of two capacities; a slide down a bowl, where the place of
    // the step before gives the normal.
    let rod = 0.1 * (1.0 - (-0.9f64).exp());
    let capacities = 2.0 / 3.0 * (1.0 - (-1.5f64).exp());
    let slide = (2.0 * ((0.5f64).tan() * (-2.0f64).exp()).atan()).sin() - 1f64.sin();
    let wear = |state: &State| largest(&state.surface.wear);
    let foundation = |state: &State| state.surface.foundation[0].expect("a temperature");
    let place = |state: &State| 0.5 * (state.u[0] + state.u[2]);
    let all: [(&str, f64, &dyn Fn(&State) -> f64); 3] = [
        ("wear-relaxation-compliance", rod, &wear),
        ("foundation-two-capacities", capacities, &foundation),
        ("bowl-overdamped", slide, &place),
    ];
    for (name, exact, of) in all {
        let errors: Vec<f64> = [50, 100, 200]
            .iter()
            .map(|n| (of(end(&solve(&benchmark(name, &[format!("time.steps={n}")])))) - exact).abs())
            .collect();
        let orders: Vec<f64> = errors.windows(2).map(|e| (e[0] / e[1]).log2()).collect();
        println!("{name}: errors {errors:?}, orders {orders:?}");
        assert!(orders.iter().all(|order| (order - 1.0).abs() < 0.1), "{name}: {orders:?}");
    }
}

#[test]
fn the_same_bits_on_one_thread_and_on_two() {
    for dim in [2, 3] {
        let problem = problem(&everything(dim, SI, 12), &[]);
        let [one, two] = [1, 2].map(|threads| with_threads(Some(threads), || solve(&problem)).expect("threads"));
        assert_eq!(one.states.len(), 13);
        assert_eq!(one.states, two.states);
    }
}

/// Of large contact boundaries, too: with a factor on Γ_C, and above 2000 unknowns without.
#[test]
fn the_same_bits_on_a_large_boundary() {
    for n in [19, 26] {
        let text = LARGE.replace("SIDE", &n.to_string());
        let problem = problem(&text, &[]);
        let [one, two] = [1, 2].map(|threads| with_threads(Some(threads), || solve(&problem)).expect("threads"));
        assert!(one.reports[0].contact.states.iter().filter(|s| s.pressure > 0.0).count() > 100);
        assert_eq!(one.states, two.states, "{n} × {n} facets");
    }
}

const LARGE: &str = body!(
    r#"kind = "box", size = [1.0, 0.2, 1.0], n = [SIDE, 2, SIDE], elements = "Q1""#,
    "end = 0.5, steps = 1",
    1,
    "young = 2.0, poisson = 0.3",
    r#"
viscosity = { law = "lame", first = 0.1, second = 0.1 }
heat_capacity = 1
conductivity = 1
[load]
body_force = ["0.5*sin(3*z)", -1, "0.3*cos(2*x)"]
[[boundary]]
on = "top"
displacement = [0, "-0.02*t", 0]
[contact]
on = "bottom"
gap = "0.003*sin(5*x)*cos(4*z) + 0.003"
normal = { law = "compliance", stiffness = 1e4 }
friction = { law = "coulomb", coefficient = 0.3 }
"#
);

/// What is measured in other units is the same.
#[test]
fn results_do_not_depend_on_the_units() {
    for dim in [2, 3] {
        let in_si = solve(&problem(&everything(dim, SI, 16), &[]));
        let [l, s, m, kelvin] = [1e-3, 60.0, 7e2, 300.0];
        let other = solve(&problem(&everything(dim, [l, s, m, kelvin], 16), &[]));
        let differs = |a: &[f64], b: &[f64], unit: f64| {
            let rest: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b / unit).collect();
            assert_eq!(a.len(), b.len());
            largest(&rest) / largest(a)
        };
        for (a, b) in in_si.states.iter().zip(&other.states).skip(1) {
            let heat = |state: &State| state.surface.foundation.iter().flatten().copied().collect::<Vec<f64>>();
            let found = [
                differs(&a.u, &b.u, l),
                differs(&a.w, &b.w, l / s),
                differs(&a.theta, &b.theta, kelvin),
                differs(&a.surface.wear, &b.surface.wear, l),
                differs(&heat(a), &heat(b), kelvin),
            ];
            assert!(largest(&found) < 1e-9, "{dim}-d, step {}: {found:?}", a.step);
        }
    }
}

const PRESSED: &str = body!(
    r#"kind = "rectangle", size = [1.0, 1.0], n = [8, 8]"#,
    "end = 1.0, steps = 10",
    0,
    r#"young = 2.0, poisson = 0.3, stress_state = "plane-stress""#,
    r#"
viscosity = { law = "lame", first = 0.1, second = 0.2 }
heat_capacity = 1
conductivity = 1
[[boundary]]
on = "top"
displacement = TOP
[contact]
on = "bottom"
WHERE
normal = { law = "signorini" }
friction = { law = "coulomb", coefficient = 0.3 }
wear = { law = "archard", coefficient = 1e-2 }
heat = { law = "pressure", coefficient = 1, foundation_temperature = 1 }
frictional_heat = 0.5
"#
);

fn pressed(top: &str, position: &str) -> Memory {
    solve(&problem(&PRESSED.replace("TOP", top).replace("WHERE", position), &[]))
}

/// Largest difference of displacements, but for a motion, and of what the surface keeps, over the largest displacement.
fn difference(a: &Memory, b: &Memory, motion: impl Fn(f64) -> [f64; 2]) -> f64 {
    assert_eq!(a.states.len(), b.states.len());
    let (mut most, mut size) = (0.0f64, 0.0f64);
    for (a, b) in a.states.iter().zip(&b.states) {
        let moved = motion(a.t);
        for (i, (a, b)) in a.u.iter().zip(&b.u).enumerate() {
            (most, size) = (most.max((a - b - moved[i % 2]).abs()), size.max(a.abs()));
        }
        let worn = a
            .surface
            .wear
            .iter()
            .zip(&b.surface.wear)
            .chain(a.surface.friction_work.iter().zip(&b.surface.friction_work));
        most = worn.fold(most, |most, (a, b)| most.max((a - b).abs()));
    }
    most / size
}

/// A flat obstacle is a gap along the normal, and its motion along itself a velocity of the foundation, in either
/// geometry.
#[test]
fn a_plane_is_a_gap() {
    let by_gap = pressed("[0, 0]", "gap = \"0.01 - 0.05*t\"\nfoundation_velocity = [0.5, 0]");
    assert!(largest(&end(&by_gap).surface.wear) > 1e-5);
    for geometry in ["reference", "updated"] {
        let shape = format!(
            "obstacle = {{ shape = \"plane\", point = [\"0.5*t\", \"-0.01 + 0.05*t\"], normal = [0, 1], geometry = \"{geometry}\" }}"
        );
        let found = difference(&by_gap, &pressed("[0, 0]", &shape), |_| [0.0; 2]);
        assert!(found < 1e-12, "{geometry}: {found:e}");
    }
}

/// A body pressed on an obstacle, and the obstacle pressed on the body. On a round one distances are linear in what the
/// body moves, and not in what the obstacle does: by δ = 0.05 on the radius 2, where the contact is half as wide, that
/// is (δ/R) (x/R)² of δ at most.
#[test]
fn the_obstacle_comes_or_the_body() {
    let plane =
        |y: &str| format!("obstacle = {{ shape = \"plane\", point = [\"0.5*t\", \"-0.01 + {y}\"], normal = [0, 1] }}");
    let (comes, goes) = (pressed("[0, 0]", &plane("0.05*t")), pressed("[0, \"-0.05*t\"]", &plane("0*t")));
    let found = difference(&comes, &goes, |t| [0.0, 0.05 * t]);
    assert!(found < 1e-12, "{found:e}");
    let ball = |y: &str| format!("obstacle = {{ shape = \"cylinder\", center = [\"0.5\", \"-2 + {y}\"], radius = 2 }}");
    let (comes, goes) = (pressed("[0, 0]", &ball("0.05*t")), pressed("[0, \"-0.05*t\"]", &ball("0*t")));
    let found = difference(&comes, &goes, |t| [0.0, 0.05 * t]);
    println!("round: {found:e}");
    assert!(found < 0.025 * 0.0625 && found > 1e-9, "{found:e}");
}

/// A side in two pieces with one law bears the contact of the whole side: the node between has a point on each, with a
/// share of its weight.
#[test]
fn a_side_in_two_pieces_is_one_side() {
    for law in ["signorini\"", "compliance\", stiffness = 1e3"] {
        let text = PRESSED
            .replace("TOP", "[0, \"-0.05*t\"]")
            .replace("WHERE", "gap = \"0.02*x\"\nfoundation_velocity = [0.5, 0]")
            .replace("signorini\"", law);
        let whole = problem(&text, &[]);
        let mut pieces = whole.clone().into_data();
        let mut mesh = (*whole.mesh).clone();
        let bottom = mesh.facets["bottom"].clone();
        let part = |first: bool| FacetSet {
            blocks: bottom
                .blocks
                .iter()
                .map(|block| {
                    let at = block.nodes.len() / block.element.nodes.len() / 2 * block.element.nodes.len();
                    let nodes = if first { block.nodes[..at].to_vec() } else { block.nodes[at..].to_vec() };
                    FacetBlock { nodes, ..block.clone() }
                })
                .collect(),
        };
        for (name, first) in [("one", true), ("two", false)] {
            mesh.facets.insert(name.to_owned(), part(first));
        }
        pieces.mesh = Arc::new(mesh);
        pieces.contacts = ["one", "two"].map(|_| whole.contacts[0].clone()).to_vec();
        (pieces.contacts[0].on, pieces.contacts[1].on) = ("one".to_owned(), "two".to_owned());
        let pieces = checked(pieces);
        let (a, b) = (solve(&whole), solve(&pieces));
        assert_eq!(end(&b).surface.wear.len(), end(&a).surface.wear.len() + 1);
        for (a, b) in a.states.iter().zip(&b.states).skip(1) {
            for (name, a, b) in [("u", &a.u, &b.u), ("w", &a.w, &b.w), ("theta", &a.theta, &b.theta)] {
                let rest: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
                assert!(largest(&rest) <= 1e-11 * largest(a), "{law} step {} {name}: {:e}", b.len(), largest(&rest));
            }
        }
        for ((_, _, a), (_, _, b)) in steps(&a).zip(steps(&b)) {
            for c in 0..2 {
                assert!((a.contact.force[c] - b.contact.force[c]).abs() <= 1e-10 * largest(&a.contact.force));
            }
        }
    }
}

/// However fast it wears, the depth is what the body comes closer, and no pressure is left.
#[test]
fn wear_without_bounds_takes_the_pressure_away() {
    for (law, stiffness) in [
        ("signorini\"", f64::INFINITY),
        ("compliance\", stiffness = 1e3", 1e3),
        ("power\", stiffness = 1e3, exponent = 1.5", 1e3),
    ] {
        let text = PRESSED
            .replace("TOP", "[0, \"-0.05*t\"]")
            .replace("WHERE", "foundation_velocity = [0.5, 0]")
            .replace("coefficient = 1e-2 }", "coefficient = 1e6 }")
            .replace("signorini\"", law);
        let memory = solve(&problem(&text, &[]));
        for (_, new, report) in steps(&memory) {
            // The energy of the body pressed without wear would be E δ² = 5e-3.
            assert!(new.ledger.closing_error.abs() < 5e-3 * 1e-12);
            // κ p V k = Δh with Δh = 0.005 per step and V k = 0.05.
            let expected = 0.005 / (1e6 * 0.05);
            for (state, depth) in report.contact.states.iter().zip(&new.surface.wear) {
                assert!(
                    (state.pressure / expected - 1.0).abs() < 1e-3,
                    "{law} {stiffness}: {:e}, expected {expected:e}",
                    state.pressure
                );
                assert!((depth / (0.05 * new.t) - 1.0).abs() < 1e-3);
            }
        }
    }
}

/// An obstacle that is nowhere from some time on ends the run with an error that says so.
#[test]
fn an_obstacle_that_is_not_defined_is_told() {
    let text = PRESSED
        .replace("TOP", "[0, 0]")
        .replace("WHERE", "obstacle = { shape = \"surface\", level = \"y + 0.1*sqrt(0.5 - t)\" }");
    let problem = problem(&text, &[]);
    let mut scheme = March::new(&problem).unwrap();
    let mut state = scheme.initial().unwrap();
    let error = loop {
        match scheme.step(&state) {
            Ok((next, _)) => state = next,
            Err(error) => break error,
        }
    };
    assert_eq!(state.step, 5);
    assert!(
        matches!(&error, StepError::Data { step: 6, key, value, .. } if key == "contact.obstacle" && value.is_nan()),
        "{error}"
    );
}
