//! Obstacles that a force presses against the body: closed forms, the same motion prescribed, a mass, in the plane, of
//! revolution and in space, turned, by a factor and by an iteration.

use std::sync::Arc;

use amontons::case::{self, Source};
use amontons::contact::Contact;
use amontons::contact::obstacle::{Obstacle, ObstacleLoad, Plane, Sphere};
use amontons::expression::Expression;
use amontons::field::{Field, TimeTable};
use amontons::linalg::{Backend, Multigrid, Supernodal};
use amontons::output::Memory;
use amontons::problem::Problem;
use amontons::run::{self, Settings};
use amontons::step::{March, Scheme};
use amontons::tensor::{Point, Rotation, dot};

use crate::common::{Random, changed, solve, spoil, told};

fn problem(text: &str) -> Problem {
    case::parse(&Source::new("punch.toml", text), &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).problem
}

fn at(t: &str) -> Field {
    Expression::parse(t).expect("an expression").into()
}

/// A block of height 0.5 and width 1 (and depth 1) with E = 1000 and ν = 0 that slides on its bottom, under a flat
/// obstacle 0.3 above it.
fn block(dim: usize, force: &str, more: &str) -> String {
    let (mesh, flat, up) = if dim == 3 {
        ("kind = \"box\"\nsize = [1.0, 0.5, 1.0]\nn = [3, 2, 2]", "", "[0, 1, 0]")
    } else {
        (
            "kind = \"rectangle\"\nsize = [1.0, 0.5]\nn = [4, 3]",
            if dim == 2 { ", stress_state = \"plane-stress\"" } else { "" },
            "[0, 1]",
        )
    };
    let point = up.replace('1', "0.8");
    let down = up.replace('1', "-2");
    format!(
        r#"name = "punch"
units = "dimensionless"
[mesh]
{mesh}
[time]
end = 2.0
steps = 4
[material]
density = 0
elasticity = {{ law = "isotropic", young = 1000.0, poisson = 0{flat} }}
[[boundary]]
on = "bottom"
normal_displacement = 0
[[boundary]]
on = "left"
normal_displacement = 0
{}[contact]
on = "top"
normal = {{ law = "signorini" }}
[contact.obstacle]
shape = "plane"
point = {point}
normal = {down}
load = {{ force = {force}, direction = {down}{more} }}
"#,
        if dim == 3 { "[[boundary]]\non = \"back\"\nnormal_displacement = 0\n" } else { "" }
    )
}

/// The problem turned, with its obstacle.
fn turned(problem: &Problem, random: &mut Random, backend: Arc<dyn Backend>) -> Problem {
    let dim = problem.mesh.dim;
    let axis = if dim == 3 { [random.number(), random.number(), 1.0] } else { [0.0, 0.0, 1.0] };
    let rotation = Rotation::about(&axis, 3.0 * random.number());
    changed(problem, |data| {
        for x in &mut Arc::make_mut(&mut data.mesh).points {
            *x = rotation.vector(x);
        }
        for contact in &mut data.contacts {
            let obstacle = contact.obstacle.as_mut().expect("an obstacle");
            let place = rotation.vector(&obstacle.shape.place(0.0));
            let load = obstacle.load.as_mut().expect("a load");
            load.direction = rotation.vector(&load.direction);
            let normal = load.direction;
            obstacle.shape = Arc::new(Plane::new(place.map(Field::from), normal).expect("a plane"));
        }
        data.backend = backend;
    })
}

/// δ of a contact at each step.
fn moved(memory: &Memory, contact: usize) -> Vec<f64> {
    memory.states.iter().map(|state| state.surface.advance[contact]).collect()
}

/// What the body bears along the load of a contact at each step.
fn borne(memory: &Memory, problem: &Problem, contact: usize) -> Vec<f64> {
    let load = problem.contacts[contact].obstacle.as_ref().and_then(|of| of.load.clone()).expect("a load");
    let points = &problem.contact_boundary().points;
    let of_step = |report: &amontons::state::StepReport| -> f64 {
        let own = points.iter().zip(&report.contact.states).filter(|(point, _)| point.contact == contact);
        own.map(|(point, state)| {
            let force: Point = std::array::from_fn(|c| state.pressure * state.normal[c] + state.q[c]);
            0.0 - point.weight * dot(&force, &load.direction)
        })
        .sum()
    };
    memory.reports.iter().map(of_step).collect()
}

/// A gap of 0.3 closes, then the block is shortened by F h/(E A), h/(E A) = 5e-4: in one step and as the force changes,
/// and it is left alone where the force is none.
#[test]
fn a_flat_punch_closes_its_gap_and_shortens_the_block() {
    let mut random = Random(3);
    let backends: [(Arc<dyn Backend>, f64); 2] =
        [(Arc::new(Supernodal), 1e-10), (Arc::new(Multigrid::default()), 1e-7)];
    for dim in [2, 3] {
        for (backend, accuracy) in &backends {
            let text = block(dim, "{ times = [0, 0.5, 1, 1.5, 2], values = [0, 20, 80, 40, 0] }", "");
            let problem = turned(&problem(&text), &mut random, Arc::clone(backend));
            let memory = solve(&problem);
            let (moved, borne) = (moved(&memory, 0), borne(&memory, &problem, 0));
            for (step, force) in [(1, 20.0), (2, 80.0), (3, 40.0)] {
                let off = moved[step] - 0.3 - 5e-4 * force;
                assert!(off.abs() < accuracy * 0.3, "{dim}: {off:e}");
                assert!((borne[step - 1] - force).abs() < 1e-8 * force, "{dim}: {borne:?}");
            }
            // Nothing presses: it is where it let go.
            assert!(borne[3].abs() < 1e-9 && moved[4] <= 0.3 + 1e-9, "{dim}: {borne:?} {moved:?}");
            let state = memory.states.last().expect("a state");
            assert!(state.ledger.relative_closing_error() < 1e-10, "{:e}", state.ledger.relative_closing_error());
        }
    }
}

/// A motion that a force has found is that which is prescribed: two balls with friction, updated in each step, oblique
/// and turned, with gaps that close in the first steps.
#[test]
fn a_motion_that_is_found_is_that_which_is_prescribed() {
    let mut random = Random(11);
    for (dim, friction) in [(2, "none"), (2, "coulomb"), (3, "none"), (3, "coulomb")] {
        for updated in [false, true] {
            let law = if friction == "none" {
                "friction = { law = \"none\" }".to_owned()
            } else {
                format!("friction = {{ law = \"coulomb\", coefficient = {:?} }}", 0.3 + 0.2 * random.number())
            };
            let held = if dim == 3 { "displacement = [0, 0, 0]" } else { "displacement = [0, 0]" };
            let text = block(dim, "1", "")
                .replacen("normal_displacement = 0", held, 1)
                .replace("n = [4, 3]", "n = [12, 7]")
                .replace("n = [3, 2, 2]", "n = [6, 3, 4]")
                .replace("poisson = 0", "poisson = 0.3")
                .replace("[contact.obstacle]", &format!("{law}\n[contact.obstacle]"));
            let base = problem(&text);
            let pressed = changed(&base, |data| {
                let first = data.contacts[0].clone();
                data.contacts = vec![
                    with_ball(&first, [0.3, 0.72, 0.4], [0.3, -1.0, 0.1], 6.0, updated, dim),
                    with_ball(&first, [0.8, 0.75, 0.6], [-0.2, -1.0, 0.0], 2.5, updated, dim),
                ];
                data.contacts[1].name = "second".to_owned();
            });
            let memory = solve(&pressed);
            for contact in [0, 1] {
                let borne = borne(&memory, &pressed, contact);
                let force = [6.0, 2.5][contact];
                for (borne, state) in borne.iter().zip(memory.states.iter().skip(1)) {
                    assert!((borne - force * state.t).abs() < 1e-8 * force, "{dim}: {borne}");
                }
            }
            let times: Vec<f64> = memory.states.iter().map(|state| state.t).collect();
            let prescribed = changed(&pressed, |data| {
                for (number, contact) in data.contacts.iter_mut().enumerate() {
                    let obstacle = contact.obstacle.as_mut().expect("an obstacle");
                    let load = obstacle.load.take().expect("a load");
                    let place = obstacle.shape.place(0.0);
                    let center = [0, 1, 2].map(|c| {
                        let values = moved(&memory, number).into_iter().map(|by| place[c] + by * load.direction[c]);
                        Field::Table(TimeTable::new(times.clone(), values.collect()).expect("a table"))
                    });
                    obstacle.shape = Arc::new(Sphere::new(center, 0.2, false).expect("a ball"));
                }
            });
            let other = solve(&prescribed);
            let most = memory.states[4].u.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
            for (state, other) in memory.states.iter().zip(&other.states).skip(1) {
                let off = state.u.iter().zip(other.u.iter()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(off < 1e-9 * most, "{dim} {friction} {updated}: {off:e} of {most:e}");
                let [work, by] = [state, other].map(|state| state.ledger.load_work);
                assert!((work - by).abs() < 1e-9 * work.abs(), "{work} {by}");
            }
        }
    }
}

/// A contact of the side with a ball of radius 0.2 that a force presses on along a direction.
fn with_ball(first: &Contact, center: Point, direction: Point, force: f64, updated: bool, dim: usize) -> Contact {
    let flat = |x: Point| if dim == 3 { x } else { [x[0], x[1], 0.0] };
    let shape = Arc::new(Sphere::new(flat(center).map(Field::from), 0.2, false).expect("a ball"));
    let load = ObstacleLoad::new(at(&format!("{force:?}*t")), flat(direction), 0.0).expect("a load");
    let mut contact = first.clone();
    contact.obstacle = Some(Obstacle { shape, updated, turning: None, load: Some(load) });
    contact
}

/// A ball with friction is pressed alike wherever the body lies, however large it is, and moved by a hair.
#[test]
fn a_ball_is_pressed_alike_in_every_place() {
    let mut random = Random(71);
    for dim in [2, 3] {
        let held = if dim == 3 { "displacement = [0, 0, 0]" } else { "displacement = [0, 0]" };
        let text = block(dim, "1", "")
            .replacen("normal_displacement = 0", held, 1)
            .replace("[[boundary]]\non = \"left\"\nnormal_displacement = 0\n", "")
            .replace("[[boundary]]\non = \"back\"\nnormal_displacement = 0\n", "")
            .replace("n = [4, 3]", "n = [12, 7]")
            .replace("n = [3, 2, 2]", "n = [6, 3, 4]")
            .replace("[contact.obstacle]", "friction = { law = \"coulomb\", coefficient = 0.4 }\n[contact.obstacle]");
        let base = problem(&text);
        let (center, direction) = ([0.3, 0.74, 0.4], [0.3, -1.0, if dim == 3 { 0.1 } else { 0.0 }]);
        let mut first = None::<f64>;
        for (scale, hair) in [(1.0, 0.0), (1e-3, 0.0), (40.0, 0.0), (1.0, 1e-9)] {
            let axis = if dim == 3 { [random.number(), random.number(), 1.0] } else { [0.0, 0.0, 1.0] };
            let rotation = Rotation::about(&axis, 3.0 * random.number());
            let shift: Point = std::array::from_fn(|c| if c < dim { 5.0 * random.number() } else { 0.0 });
            let put = |x: &Point| -> Point {
                let turned = rotation.vector(x);
                std::array::from_fn(|c| scale * (turned[c] + shift[c]))
            };
            let placed = changed(&base, |data| {
                Arc::make_mut(&mut data.mesh).points.iter_mut().for_each(|x| *x = put(x));
                let center = put(&[center[0] + hair, center[1], if dim == 3 { center[2] } else { 0.0 }]);
                let shape = Arc::new(Sphere::new(center.map(Field::from), 0.2 * scale, false).expect("a ball"));
                // Stresses stay as they are.
                let force = at(&format!("{:?}*t", 6.0 * scale.powi(dim as i32 - 1)));
                let load = ObstacleLoad::new(force, rotation.vector(&direction), 0.0).expect("a load");
                data.contacts[0].obstacle = Some(Obstacle { shape, updated: true, turning: None, load: Some(load) });
            });
            let found = moved(&solve(&placed), 0)[4] / scale;
            let first = *first.get_or_insert(found);
            assert!((found - first).abs() < 1e-8 + 10.0 * hair, "{dim} {scale} {hair}: {found} {first}");
        }
    }
}

/// A ball that is far from the body, and smaller than its gap, does not pass it by.
#[test]
fn a_small_ball_far_away_finds_the_body() {
    for (far, radius) in [(0.4, 0.2), (3.0, 0.02), (500.0, 0.3)] {
        let ball = format!("shape = \"sphere\"\ncenter = [0.4, {:?}]\nradius = {radius:?}\n", 0.5 + far + radius);
        let text = spoil(&block(2, "0.4", ""), "shape = \"plane\"\npoint = [0, 0.8]\nnormal = [0, -2]\n", &ball);
        let problem = problem(&text.replace("n = [4, 3]", "n = [20, 10]"));
        let memory = solve(&problem);
        let (moved, borne) = (moved(&memory, 0)[4], borne(&memory, &problem, 0)[3]);
        assert!((borne - 0.4).abs() < 1e-9 && (moved - far).abs() < 0.02, "{far}: {borne} {moved}");
    }
}

/// A mass m flies through the gap, meets the block, which is a spring of the stiffness E A/h, and leaves it again: each
/// step is that of backward Euler, m (δ_n − 2 δ_{n−1} + δ_{n−2})/k² + c (δ_n − g)₊ = F.
#[test]
fn a_mass_flies_presses_and_rebounds() {
    let mut random = Random(29);
    let (mass, force, gap, c) = (3.0, 50.0, 0.3, 2000.0);
    for (dim, steps) in [(2, 30), (2, 300), (3, 60)] {
        let text = block(dim, &format!("{force:?}"), &format!(", mass = {mass:?}"))
            .replace("steps = 4", &format!("steps = {steps}"))
            .replace("end = 2.0", "end = 0.6");
        let problem = turned(&problem(&text), &mut random, Arc::new(Supernodal));
        let memory = solve(&problem);
        // A body that nothing touches any more is solved at once.
        assert!(memory.reports.iter().all(|report| report.parts == 1));
        let k = 0.6 / f64::from(steps);
        let (mut before, mut last) = (0.0, 0.0);
        let mut parted = 0;
        for found in moved(&memory, 0).into_iter().skip(1) {
            let inertia = mass / (k * k);
            // Without contact, and with it where that would press it in.
            let free = (force + inertia * (2.0 * last - before)) / inertia;
            let pressed = (force + inertia * (2.0 * last - before) + c * gap) / (inertia + c);
            let next = if free > gap { pressed } else { free };
            parted += usize::from(last > gap && next <= gap);
            assert!((found - next).abs() < 1e-9, "{dim}: {found} {next}");
            (before, last) = (last, next);
        }
        assert!(steps < 300 || parted > 0, "it has not left the block");
    }
}

/// A run that goes on from a state has the same bits.
#[test]
fn a_resumed_run_is_the_same() {
    let text = block(2, "\"60*sin(2*t)^2 + 1\"", ", mass = 0.01").replace("steps = 4", "steps = 12");
    let problem = problem(&text);
    let mut scheme = March::new(&problem).expect("a scheme");
    let mut state = scheme.initial().expect("a state");
    for _ in 0..5 {
        state = scheme.step(&state).expect("a step").0;
    }
    let mut other = March::new(&problem).expect("a scheme");
    other.recall(&scheme.kept()).expect("what is kept");
    let mut again = state.clone();
    for _ in 5..12 {
        state = scheme.step(&state).expect("a step").0;
        again = other.step(&again).expect("a step").0;
        assert!(state.u.iter().zip(again.u.iter()).all(|(a, b)| a.to_bits() == b.to_bits()));
        assert_eq!(state.surface, again.surface);
    }
}

/// A ball that heats the block it is pressed into: each coupling finds its force, and the two that solve the same
/// equations agree.
#[test]
fn each_coupling_of_heat_finds_the_force() {
    let heated = "heat = { law = \"pressure\", coefficient = 2, foundation_temperature = 40 }\n[contact.obstacle]\n";
    let ball = "shape = \"sphere\"\ncenter = [0.4, 0.75]\nradius = 0.2\n";
    let plane = "shape = \"plane\"\npoint = [0, 0.8]\nnormal = [0, -2]\n";
    let text = block(2, "\"4*t\"", "").replace("[contact.obstacle]\n", heated).replace("n = [4, 3]", "n = [12, 7]");
    let text = spoil(&text, plane, ball).replacen(
        "density = 0\n",
        "density = 0\nheat_capacity = 1\nconductivity = 1\nexpansion_coefficient = 1e-3\n",
        1,
    );
    let of = |coupling: &str| {
        let problem = problem(&format!("{text}\n[scheme]\ncoupling = \"{coupling}\"\n"));
        let memory = solve(&problem);
        for (borne, state) in borne(&memory, &problem, 0).iter().zip(memory.states.iter().skip(1)) {
            assert!((borne - 4.0 * state.t).abs() < 1e-8, "{coupling}: {borne}");
        }
        moved(&memory, 0)
    };
    let [staggered, fixed, whole] = ["staggered", "fixed-point", "monolithic"].map(of);
    for step in 1..=4 {
        assert!((fixed[step] - whole[step]).abs() < 1e-8, "{fixed:?} {whole:?}");
    }
    // The heat of the last step moves the ball.
    assert!((staggered[4] - whole[4]).abs() > 1e-6, "{staggered:?} {whole:?}");
}

/// The force on a stamp of revolution is that on the whole ring: σ = F/(π R²).
#[test]
fn the_force_on_a_stamp_of_revolution_is_that_on_its_ring() {
    let text = block(1, "100", "")
        .replace("[[boundary]]\non = \"left\"\nnormal_displacement = 0\n", "")
        .replace("kind = \"rectangle\"\n", "kind = \"rectangle\"\naxisymmetric = true\n");
    let memory = solve(&problem(&text));
    let expected = 0.3 + 100.0 * 0.5 / (1000.0 * std::f64::consts::PI);
    let found = moved(&memory, 0)[4];
    assert!((found - expected).abs() < 1e-10, "{found} {expected}");
}

/// What nothing resists is told of: a pull, and a ball that passes by the body.
#[test]
fn a_force_that_nothing_bears_is_told_of() {
    let passes = "shape = \"sphere\"\ncenter = [3, 0.8]\nradius = 0.2\n";
    let plane = "shape = \"plane\"\npoint = [0, 0.8]\nnormal = [0, -2]\n";
    for text in [block(2, "-5", ""), spoil(&block(2, "5", ""), plane, passes)] {
        let error = run::run(&problem(&text), &Settings { certificate: false, ..Settings::default() }, &mut []);
        let said = error.err().map(|error| error.to_string()).unwrap_or_default();
        assert!(said.contains("contact.obstacle.load: the body bears 0.000000e0 N, expected"), "{said}");
    }
}

/// One message for each fault.
#[test]
fn faults_are_named() {
    let text = block(2, "5", "");
    let said = |old: &str, new: &str| told(&Source::new("punch.toml", spoil(&text, old, new)), &[]);
    for (old, new, expected) in [
        ("direction = [0, -2]", "direction = [0, 0]", "contact.obstacle.load.direction: found zero, expected"),
        ("direction = [0, -2]", "direction = [0, -2, 0]", "contact.obstacle.load.direction: found 3 components"),
        (
            "force = 5",
            "force = \"5*x\"",
            "contact.obstacle.load.force: found an expression in space, expected a number",
        ),
        ("force = 5", "weight = 5", "contact.obstacle.load.weight: found an unknown key, expected one of direction"),
        ("force = 5", "force = 5, mass = -1", "contact.obstacle.load.mass: found -1, expected a number ≥ 0"),
        (
            "point = [0, 0.8]",
            "point = [0, \"0.8 - t\"]",
            "contact.obstacle.load: found an obstacle that is given a motion along the direction of its load",
        ),
    ] {
        let text = said(old, new);
        assert!(text.contains(expected), "{text}");
    }
    let ring = spoil(&text, "kind = \"rectangle\"\n", "kind = \"rectangle\"\naxisymmetric = true\n")
        .replace(", stress_state = \"plane-stress\"", "");
    let said = told(&Source::new("punch.toml", spoil(&ring, "direction = [0, -2]", "direction = [1, -2]")), &[]);
    assert!(said.contains("contact.obstacle.load.direction: found a direction"), "{said}");
}
