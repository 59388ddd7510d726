//! Bolts that are tightened to a force and then kept: the joint diagram, in the plane and in space, turned, by a factor
//! and by an iteration.

use std::fmt::Write;
use std::sync::Arc;

use amontons::case::{self, Source};
use amontons::expression::Expression;
use amontons::linalg::{Backend, Multigrid, Supernodal};
use amontons::output::Memory;
use amontons::problem::Problem;
use amontons::run::{self, Settings};
use amontons::step::{March, Scheme};
use amontons::tensor::{Point, Rotation};

use crate::common::{Random, changed, solve, spoil, told};

fn problem(text: &str) -> Problem {
    case::parse(&Source::new("joint.toml", text), &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).problem
}

/// The section of a bolt: its lower half on its upper one, or the other way round.
fn section(name: &str, force: &str, is_swapped: bool, more: &str) -> String {
    let (mut on, mut with) = (format!("{name}_upper_bottom"), format!("{name}_lower_top"));
    if is_swapped {
        (on, with) = (with, on);
    }
    format!(
        "[[contact]]\nname = \"{name}\"\non = \"{on}\"\nwith = \"{with}\"\nnormal = {{ law = \"bilateral\" }}\n\
         friction = {{ law = \"stick\" }}\npreload = {{ force = {force}, until = 1 }}\n{more}"
    )
}

/// A clamp of E = 2000 on rigid ground between two bolts of E = 1000, all 1 high, their tops tied to a rigid yoke. k_c
/// = 4000, and k_b = 1000 for both bolts together. The yoke is drawn up by F_A = 8, 12 and 15 after the bolts were
/// tightened.
fn joint(dim: usize, bolts: &str, yoke: &str) -> String {
    let size = |w: f64, h: f64| if dim == 3 { format!("[{w:?}, {h:?}, 1.0]") } else { format!("[{w:?}, {h:?}]") };
    let at = |x: f64, y: f64| if dim == 3 { format!("[{x:?}, {y:?}, 0]") } else { format!("[{x:?}, {y:?}]") };
    let n = |a: usize, b: usize| if dim == 3 { format!("[{a}, {b}, 2]") } else { format!("[{a}, {b}]") };
    let mut blocks = String::new();
    for (name, w, h, x, y, cells) in [("clamp", 2.0, 1.0, 1.0, 0.0, [5, 3]), ("yoke", 4.0, 0.2, 0.0, 1.0, [7, 1])] {
        let (size, at, n) = (size(w, h), at(x, y), n(cells[0], cells[1]));
        writeln!(blocks, "  {{ name = \"{name}\", size = {size}, origin = {at}, n = {n} }},").expect("text");
    }
    for (name, x) in [("left", 0.0), ("right", 3.5)] {
        for (half, y, h, cells) in [("lower", 0.0, 0.4, 3), ("upper", 0.4, 0.6, 2)] {
            let (size, at, n) = (size(0.5, h), at(x, y), n(cells, 2));
            writeln!(blocks, "  {{ name = \"{name}_{half}\", size = {size}, origin = {at}, n = {n} }},").expect("text");
        }
    }
    let tie = |part: &str| {
        let tied = "normal = { law = \"bilateral\" }\nfriction = { law = \"stick\" }";
        format!("[[contact]]\non = \"{part}_top\"\nwith = \"yoke_bottom\"\n{tied}\n")
    };
    let ties: String = ["clamp", "left_upper", "right_upper"].map(tie).concat();
    let (flat, zero) = if dim == 3 { ("", "[0, 0, 0]") } else { (", stress_state = \"plane-stress\"", "[0, 0]") };
    let elasticity =
        |young: f64| format!("elasticity = {{ law = \"isotropic\", young = {young:?}, poisson = 0{flat} }}");
    format!(
        r#"name = "joint"
units = "dimensionless"
[mesh]
kind = "blocks"
blocks = [
{blocks}]
[time]
end = 4.0
steps = 4
[material]
density = 0
{}
[[region]]
on = "clamp"
material = {{ density = 0, {} }}
[[side]]
name = "feet"
of = ["left_lower_bottom", "right_lower_bottom"]
[[boundary]]
on = "feet"
displacement = {zero}
[[rigid]]
on = "yoke"
{yoke}
[[contact]]
on = "clamp_bottom"
normal = {{ law = "signorini" }}
{bolts}{ties}"#,
        elasticity(1000.0),
        elasticity(2000.0)
    )
}

/// F_A in the four steps.
const PULL: &str = "if(t < 1.5, 0, if(t < 2.5, 8, if(t < 3.5, 12, 15)))";

/// The yoke that is drawn up after the bolts were tightened.
fn drawn_up(dim: usize) -> String {
    format!("force = [0, \"{PULL}\"{}]\nguided = true", if dim == 3 { ", 0" } else { "" })
}

/// Σ ω p of each contact at each step.
fn forces(memory: &Memory, problem: &Problem) -> Vec<Vec<f64>> {
    let boundary = problem.contact_boundary();
    let of_state = |p: &[f64]| {
        let mut sums = vec![0.0; problem.contacts.len()];
        boundary.points.iter().zip(p).for_each(|(point, p)| sums[point.contact] += point.weight * p);
        sums
    };
    memory.states.iter().map(|state| of_state(&state.multipliers.p)).collect()
}

/// The problem turned and moved, with the force on the yoke.
fn elsewhere(problem: &Problem, random: &mut Random, backend: Arc<dyn Backend>) -> Problem {
    let dim = problem.mesh.dim;
    let axis = if dim == 3 { [random.number(), random.number(), 1.0] } else { [0.0, 0.0, 1.0] };
    let rotation = Rotation::about(&axis, 3.0 * random.number());
    let shift: Point = std::array::from_fn(|c| if c < dim { 5.0 * random.number() } else { 0.0 });
    changed(problem, |data| {
        for x in &mut Arc::make_mut(&mut data.mesh).points {
            let turned = rotation.vector(x);
            *x = std::array::from_fn(|c| turned[c] + shift[c]);
        }
        let up = rotation.vector(&[0.0, 1.0, 0.0]);
        for part in &mut data.rigid {
            let pull = |c: usize| Expression::parse(&format!("{:?}*{PULL}", up[c])).expect("an expression");
            part.force = (0..dim).map(|c| pull(c).into()).collect();
        }
        data.backend = backend;
    })
}

/// The joint diagram: preload 10, k_b = 1000, k_c = 4000. Both bolts bear 10 + F_A k_b/(k_b + k_c) and the clamp the
/// rest, until it opens at F_A = 12.5; then the bolts bear all.
#[test]
fn bolts_and_clamp_share_as_in_the_joint_diagram() {
    let mut random = Random(3);
    for dim in [2, 3] {
        for is_swapped in [false, true] {
            let bolts = section("left", "5", is_swapped, "") + &section("right", "5", is_swapped, "");
            let problem = problem(&joint(dim, &bolts, &drawn_up(dim)));
            let backends: [Arc<dyn Backend>; 2] = [Arc::new(Supernodal), Arc::new(Multigrid::default())];
            for (backend, accurate) in backends.into_iter().zip([1e-10, 1e-8]) {
                let turned = elsewhere(&problem, &mut random, backend);
                let memory = solve(&turned);
                let found = forces(&memory, &turned);
                for (step, (bolt, clamp)) in [(1, (10.0, 10.0)), (2, (11.6, 3.6)), (3, (12.4, 0.4)), (4, (15.0, 0.0))] {
                    let [on_clamp, left, right, ..] = found[step][..] else { panic!("three contacts") };
                    let off = [on_clamp - clamp, left + bolt / 2.0, right + bolt / 2.0];
                    assert!(off.iter().all(|off| off.abs() < accurate * 10.0), "{dim} {is_swapped} {step}: {off:?}");
                }
                for report in &memory.reports {
                    assert!(report.residual < 1e-9);
                }
                let ledger = &memory.states[4].ledger;
                assert!(ledger.relative_closing_error() < 1e-10, "{:e}", ledger.relative_closing_error());
            }
        }
    }
}

/// A clamp that hangs above the ground is drawn onto it first: the bolts bear nothing while the gap closes, and then as
/// in the joint diagram, whether they are tightened at once or in five steps.
#[test]
fn a_gap_closes_before_the_bolts_bear() {
    let bolts = section("left", "\"5*min(t, 1)\"", false, "") + &section("right", "\"5*min(t, 1)\"", false, "");
    let text = joint(2, &bolts, &drawn_up(2))
        .replace("normal = { law = \"signorini\" }", "gap = 0.01\nnormal = { law = \"signorini\" }");
    let joints = [text.clone(), text.replace("steps = 4", "steps = 20")];
    let drawn = joints.map(|text| {
        let problem = problem(&text);
        let memory = solve(&problem);
        let found = forces(&memory, &problem);
        for (part, (bolt, clamp)) in [(1, (10.0, 10.0)), (2, (11.6, 3.6)), (3, (12.4, 0.4)), (4, (15.0, 0.0))] {
            let [on_clamp, left, right, ..] = found[part * problem.timeline.steps() / 4][..] else {
                panic!("three contacts")
            };
            let off = [on_clamp - clamp, left + bolt / 2.0, right + bolt / 2.0];
            assert!(off.iter().all(|off| off.abs() < 1e-9), "{part}: {off:?}");
        }
        let last = memory.states.last().expect("a state");
        assert!(last.ledger.relative_closing_error() < 1e-10);
        last.surface.advance.clone()
    });
    // The gap, 10/4000 of the clamp and 10/1000 of the bolts.
    for contact in [1, 2] {
        assert!((drawn[0][contact] - 0.0225).abs() < 1e-11, "{:?}", drawn[0]);
        assert!((drawn[1][contact] - 0.0225).abs() < 1e-11, "{:?}", drawn[1]);
    }
}

/// Bolts with forces of their own on a yoke that turns, Coulomb friction on the ground: each bears its force while it
/// is tightened, and what follows is what a tie does whose gap is drawn together by the same lengths.
#[test]
fn a_kept_section_is_a_tie_with_a_gap() {
    let sides = |more: [&str; 2]| {
        let bolts = section("left", "7", false, more[0]) + &section("right", "4", true, more[1]);
        let text = joint(2, &bolts, "force = [2, 3]\nmoment = [1]");
        text.replace(
            "{ law = \"signorini\" }",
            "{ law = \"compliance\", stiffness = 2e4 }\nfriction = { law = \"coulomb\", coefficient = 0.3 }",
        )
    };
    let text = sides(["", ""]);
    let problem = problem(&text);
    let memory = solve(&problem);
    let found = forces(&memory, &problem);
    assert!((found[1][1] + 7.0).abs() < 1e-10 && (found[1][2] + 4.0).abs() < 1e-10, "{:?}", found[1]);
    let drawn = &memory.states[4].surface.advance;
    let tied = changed(&problem, |data| {
        for contact in [1, 2] {
            data.contacts[contact].preload = None;
            data.contacts[contact].gap = drawn[contact].into();
        }
    });
    let tie = solve(&tied);
    let most = memory.states[4].u.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
    for (state, other) in memory.states.iter().zip(&tie.states).skip(1) {
        let off = state.u.iter().zip(other.u.iter()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-10 * most, "{off:e}");
    }
}

/// Bolts that warm up after they were tightened lose α ΔT L k_b k_c/(k_b + k_c) of their tension: 5e-3 · 800 = 4 of 10.
#[test]
fn bolts_that_warm_up_lose_tension() {
    let bolts = section("left", "5", false, "") + &section("right", "5", true, "");
    let text =
        joint(2, &bolts, "guided = true").replacen("density = 0\n", "density = 0\nexpansion_coefficient = 1e-4\n", 1)
            + "[load]\ntemperature = \"if(t < 1.5, 0, 50)\"\n";
    let problem = problem(&text);
    let memory = solve(&problem);
    let found = forces(&memory, &problem);
    for (step, bolt) in [(1, 10.0), (2, 6.0), (4, 6.0)] {
        let [clamp, left, right, ..] = found[step][..] else { panic!("three contacts") };
        let off = [clamp - bolt, left + bolt / 2.0, right + bolt / 2.0];
        assert!(off.iter().all(|off| off.abs() < 1e-9), "{step}: {off:?}");
    }
    assert!(memory.states[4].ledger.relative_closing_error() < 1e-10);
}

/// A run that goes on from a state while a bolt is tightened, and after that, has the same bits.
#[test]
fn a_resumed_run_is_the_same() {
    let force = "\"5*sin(1.5*t)\"";
    let bolts = section("left", force, false, "") + &section("right", "3", false, "");
    let text = joint(2, &bolts, &drawn_up(2)).replace("steps = 4", "steps = 12").replace("density = 0", "density = 1");
    let problem = problem(&text);
    for stop in [2, 5] {
        let mut scheme = March::new(&problem).expect("a scheme");
        let mut state = scheme.initial().expect("a state");
        for _ in 0..stop {
            state = scheme.step(&state).expect("a step").0;
        }
        let mut other = March::new(&problem).expect("a scheme");
        other.recall(&scheme.kept()).expect("what is kept");
        let mut again = state.clone();
        for _ in stop..9 {
            state = scheme.step(&state).expect("a step").0;
            again = other.step(&again).expect("a step").0;
            assert!(state.u.iter().zip(again.u.iter()).all(|(a, b)| a.to_bits() == b.to_bits()));
            assert_eq!(state.surface.advance, again.surface.advance);
            let boundary = problem.contact_boundary();
            let tension = |contact: usize| -> f64 {
                let own =
                    boundary.points.iter().zip(&state.multipliers.p).filter(|(point, _)| point.contact == contact);
                own.map(|(point, p)| 0.0 - point.weight * p).sum()
            };
            // One force changes from step to step, the other one stays.
            if state.t < 1.0 + 1e-9 {
                let off = [tension(1) - 5.0 * (1.5 * state.t).sin(), tension(2) - 3.0];
                assert!(off.iter().all(|off| off.abs() < 1e-9), "t = {}: {off:?}", state.t);
            }
        }
    }
}

/// A bolt that bears on nothing has no tension, and that is said.
#[test]
fn a_bolt_that_bears_on_nothing_is_told_of() {
    let text = joint(2, &section("left", "5", false, ""), &drawn_up(2));
    let tie = "[[contact]]\non = \"left_upper_top\"\nwith = \"yoke_bottom\"\nnormal = { law = \"bilateral\" }\n\
               friction = { law = \"stick\" }\n";
    let problem = problem(&spoil(&text, tie, ""));
    let error = run::run(&problem, &Settings { certificate: false, ..Settings::default() }, &mut []);
    let said = error.err().map(|error| error.to_string()).unwrap_or_default();
    assert!(said.contains("contact[1].preload: the section bears"), "{said}");
}

/// One message for each fault.
#[test]
fn faults_are_named() {
    let text = joint(2, &section("left", "5", false, ""), &drawn_up(2));
    let said = |old: &str, new: &str| told(&Source::new("joint.toml", spoil(&text, old, new)), &[]);
    let tie = "normal = { law = \"bilateral\" }\nfriction = { law = \"stick\" }\npreload";
    for (old, new, expected) in [
        ("until = 1", "until = 0", "contact[1].preload.until: found 0, expected a number > 0 (time in s up to which"),
        ("until = 1", "", "contact[1].preload.until: found no such key, expected"),
        ("force = 5", "force = \"5*x\"", "contact[1].preload.force: found an expression in space, expected a number"),
        ("force = 5", "tension = 5", "contact[1].preload.tension: found an unknown key, expected one of force, until"),
        (
            tie,
            "normal = { law = \"signorini\" }\npreload",
            "contact[1].preload: found a preload of sides that may part or slip, expected that of a tie",
        ),
        (
            tie,
            "normal = { law = \"bilateral\" }\npreload",
            "contact[1].preload: found a preload of sides that may part or slip, expected that of a tie",
        ),
        (tie, &format!("geometry = \"updated\"\n{tie}"), "contact[1].preload: found the preload of a pair with"),
    ] {
        let text = said(old, new);
        assert!(text.contains(expected), "{text}");
    }
}
