//! Every pair of features together: what holds for one holds beside any other. The energy closes, a step that is taken
//! up again or was interrupted has the same bits, as on two threads, an iteration has the results of a factor, a turned
//! body moves as the body, and a finer mesh changes little.
//!
//! | feature | what it is |
//! |---|---|
//! | mean | nearly incompressible, with the mean dilatation |
//! | expansion | heat expands the body, which strain warms |
//! | monolithic | both half-steps coupled within a step |
//! | prony | branches that relax |
//! | warm | elasticity and conductivity by the temperature |
//! | sector | one of twelve sectors of a ring |
//! | pair | two bodies instead of one on a foundation |
//! | wear | Archard's law |
//! | falling | friction that falls with the speed: steps in halves |
//!
//! Sides on rollers are oblique in every case that is turned; resume, interrupt, threads and iteration are tried with
//! each pair.

use std::sync::Arc;

use crate::common::{self, changed, interrupts};
use amontons::case::{self, Source};
use amontons::equation::StepError;
use amontons::linalg::Multigrid;
use amontons::problem::Problem;
use amontons::run::{self, Settings};
use amontons::state::{State, StepReport};
use amontons::step::{Kept, March, Scheme};

const FEATURES: [&str; 9] = ["mean", "expansion", "monolithic", "prony", "warm", "sector", "pair", "wear", "falling"];
const STEPS: usize = 6;

/// Blocks, the sides that meet, the side that is pressed and the one that is held, and what else holds the bodies.
struct Bodies {
    blocks: String,
    sides: [&'static str; 2],
    pressed: &'static str,
    held: &'static str,
    more: &'static str,
}

impl Bodies {
    fn new(is_sector: bool, is_pair: bool, finer: usize) -> Bodies {
        let n = |n: [usize; 2]| format!("[{}, {}]", n[0] * finer, n[1] * finer);
        let block = |name: &str, from: &str, size: &str, cells: [usize; 2]| {
            format!("{{ name = \"{name}\", size = {size}, origin = {from}, n = {} }}", n(cells))
        };
        let ring = |name: &str, radii: &str| {
            format!("{{ name = \"{name}\", radii = {radii}, angle = 0.5235987755982988, n = {} }}", n([3, 4]))
        };
        match (is_sector, is_pair) {
            (false, false) => Bodies {
                blocks: block("a", "[0, 0]", "[1.0, 0.5]", [6, 3]),
                sides: ["a_bottom", ""],
                pressed: "a_top",
                held: "",
                more: "[[boundary]]\non = \"a_left\"\nnormal_displacement = 0\n",
            },
            (false, true) => Bodies {
                blocks: block("a", "[0, 0]", "[1.0, 0.5]", [5, 3])
                    + ", "
                    + &block("b", "[-0.2, -0.5]", "[1.4, 0.5]", [8, 3]),
                sides: ["a_bottom", "b_top"],
                pressed: "a_top",
                held: "b_bottom",
                more: "[[boundary]]\non = \"a_left\"\nnormal_displacement = 0\n\
                       [[boundary]]\non = \"b_left\"\nnormal_displacement = 0\n",
            },
            (true, false) => Bodies {
                blocks: ring("a", "[1.0, 1.5]"),
                sides: ["a_outer", ""],
                pressed: "a_inner",
                held: "",
                more: "[[cyclic]]\nsides = [\"a_start\", \"a_end\"]\n",
            },
            (true, true) => Bodies {
                blocks: ring("a", "[1.0, 1.5]") + ", " + &ring("b", "[1.5, 2.0]"),
                sides: ["a_outer", "b_inner"],
                pressed: "a_inner",
                held: "b_outer",
                more: "[[cyclic]]\nsides = [\"a_start\", \"a_end\"]\n[[cyclic]]\nsides = [\"b_start\", \"b_end\"]\n",
            },
        }
    }

    fn boundary(&self, is_sector: bool) -> String {
        let [pressed, held] = if is_sector {
            let along = |c: &str| format!("\"0.02*t*{c}/(x^2 + y^2)^0.5\"");
            [format!("displacement = [{}, {}]", along("x"), along("y")), "displacement = [0, 0]".to_owned()]
        } else {
            ["normal_displacement = \"-0.02*t\"".to_owned(), "normal_displacement = 0".to_owned()]
        };
        let mut text = format!("[[boundary]]\non = \"{}\"\n{pressed}\ntemperature = \"30*t\"\n", self.pressed);
        if !self.held.is_empty() {
            text += &format!("[[boundary]]\non = \"{}\"\n{held}\ntemperature = 0\n", self.held);
        }
        text
    }
}

fn material(has: &dyn Fn(&str) -> bool) -> String {
    // Branches are multiples of an elasticity that does not depend on the temperature.
    let young = if has("warm") && !has("prony") { "{ temperature = [-50, 50], value = [120, 80] }" } else { "100" };
    let conductivity = if has("warm") { "{ temperature = [-50, 50], value = [0.4, 0.2] }" } else { "0.3" };
    let poisson = if has("mean") { 0.4999 } else { 0.3 };
    let mut text = format!(
        "[material]\ndensity = 0.1\nelasticity = {{ law = \"isotropic\", young = {young}, poisson = {poisson}, \
         stress_state = \"plane-strain\" }}\nviscosity = {{ law = \"lame\", first = 0.02, second = 0.05 }}\n\
         heat_capacity = 1\nconductivity = {conductivity}\n"
    );
    for (is, keys) in [
        (has("mean"), "dilatation = \"mean\"\n"),
        (has("expansion") || has("monolithic"), "expansion_coefficient = 2e-4\n"),
        (has("prony"), "prony = [{ ratio = 0.4, time = 0.1 }, { ratio = 0.2, time = 0.5 }]\n"),
    ] {
        text += if is { keys } else { "" };
    }
    text
}

fn contact(has: &dyn Fn(&str) -> bool, sides: [&str; 2], angle: f64) -> String {
    let (s, c) = angle.sin_cos();
    let belt = if has("sector") {
        "[\"-0.1*y\", \"0.1*x\"]".to_owned()
    } else {
        format!("[\"{:?}\", \"{:?}\"]", 0.1 * c, 0.1 * s)
    };
    let friction = if has("falling") {
        "{ law = \"static-kinetic\", static = 0.4, kinetic = 0.1, decay_speed = 0.02 }"
    } else {
        "{ law = \"coulomb\", coefficient = 0.3 }"
    };
    format!(
        "[contact]\non = \"{}\"\n{}normal = {{ law = \"compliance\", stiffness = 1e3 }}\nfriction = {friction}\n\
         foundation_velocity = {belt}\nheat = {{ law = \"pressure\", coefficient = 1.0, exponent = 0.95{} }}\n\
         frictional_heat = 0.5\n{}",
        sides[0],
        if has("pair") { format!("with = \"{}\"\n", sides[1]) } else { String::new() },
        if has("pair") { "" } else { ", foundation_temperature = 0" },
        if has("wear") { "wear = { law = \"archard\", coefficient = 1e-3 }\n" } else { "" }
    )
}

/// A case with some features, its cells divided by `finer` and everything turned by an angle.
fn problem(features: &[&str], finer: usize, angle: f64) -> Problem {
    let has = |feature: &str| features.contains(&feature);
    let bodies = Bodies::new(has("sector"), has("pair"), finer);
    let text = format!(
        "name = \"features\"\nunits = \"dimensionless\"\n[mesh]\nkind = \"blocks\"\nblocks = [{}]\n[time]\nend = 0.6\n\
         steps = {STEPS}\n[scheme]\ncoupling = \"{}\"\n{}{}{}{}",
        bodies.blocks,
        if has("monolithic") { "monolithic" } else { "staggered" },
        material(&has),
        bodies.more,
        bodies.boundary(has("sector")),
        contact(&has, bodies.sides, angle)
    );
    let read = case::parse(&Source::new("features.toml", &text), &[]).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let (s, c) = angle.sin_cos();
    changed(&read.problem, |data| {
        let mut mesh = (*data.mesh).clone();
        mesh.points.iter_mut().for_each(|x| *x = [c * x[0] - s * x[1], s * x[0] + c * x[1], 0.0]);
        data.mesh = Arc::new(mesh);
    })
}

/// All states of a run with what is kept beside each, and its reports.
fn states(problem: &Problem) -> (Vec<(State, Kept)>, Vec<StepReport>) {
    let mut scheme = March::new(problem).expect("a regular system");
    let initial = scheme.initial().expect("finite initial data");
    let (mut states, mut reports) = (vec![(initial, scheme.kept())], Vec::new());
    while reports.len() < problem.timeline.steps() {
        let (last, _) = states.last().expect("a state");
        let (state, report) = scheme.step(last).unwrap_or_else(|error| panic!("{error}"));
        states.push((state, scheme.kept()));
        reports.push(report);
    }
    (states, reports)
}

/// The next step of a run that goes on.
fn taken_up(problem: &Problem, (from, kept): &(State, Kept)) -> Result<State, StepError> {
    let mut scheme = March::new(problem).expect("a regular system");
    scheme.recall(kept).expect("a regular system");
    scheme.step(from).map(|(state, _)| state)
}

fn force(report: &StepReport) -> f64 {
    report.contact.force.iter().map(|f| f * f).sum::<f64>().sqrt()
}

/// What must hold of any case.
fn holds(features: &[&str]) {
    let case = problem(features, 1, 0.0);
    let (made, reports) = states(&case);
    let ((last, _), report) = (&made[STEPS], &reports[STEPS - 1]);
    let closing = last.ledger.relative_closing_error().abs();
    assert!(closing < 1e-10, "{features:?}: the energy closes to {closing:e}");
    assert!(force(report) > 1e-3, "{features:?}: nothing presses");
    let middle = reports.iter().position(|report| report.parts > 1).unwrap_or(STEPS / 2);

    let (next, _) = &made[middle + 1];
    let again = taken_up(&case, &made[middle]).expect("a step");
    assert!(again == *next, "{features:?}: a step that is taken up again is another");
    // The first evaluation is before the first system is solved: that step cannot be made.
    for left in [1, 20, 90, 300] {
        match taken_up(&interrupts::interrupted(&case, left), &made[middle]) {
            Ok(state) => assert!(left > 1 && state == *next, "{features:?}: an interrupted step is another"),
            Err(error) => assert!(error.is_interruption(), "{features:?}: {error}"),
        }
    }
    for threads in [1, 2] {
        let mut memory = amontons::output::Memory::new().states_every(1);
        let settings = Settings { threads: Some(threads), certificate: false, ..Settings::default() };
        run::run(&case, &settings, &mut [&mut memory]).unwrap_or_else(|error| panic!("{features:?}: {error}"));
        assert!(memory.states.last() == Some(last), "{features:?}: another result on {threads} threads");
    }

    let near = |other: &Problem, what: &str, tolerance: f64| {
        let (others, reports) = states(other);
        let (moved, expected) = (common::largest(&others[STEPS].0.u), common::largest(&last.u));
        let (found, force) = (force(&reports[STEPS - 1]), force(report));
        let (warm, warm_expected) = (common::largest(&others[STEPS].0.theta), common::largest(&last.theta));
        assert!((found / force - 1.0).abs() < tolerance, "{features:?}, {what}: force {found}, expected {force}");
        assert!(
            (warm / warm_expected - 1.0).abs() < tolerance,
            "{features:?}, {what}: {warm}, expected {warm_expected}"
        );
        (moved, expected)
    };
    let iterative = changed(&case, |data| data.backend = Arc::new(Multigrid::default()));
    let (moved, expected) = near(&iterative, "by an iteration", 1e-7);
    assert!((moved / expected - 1.0).abs() < 1e-7, "{features:?}, by an iteration: {moved}, expected {expected}");
    near(&problem(features, 1, 0.7), "turned", 1e-8);
    near(&problem(features, 2, 0.0), "finer", 0.15);
}

#[test]
fn every_pair_of_features_holds_together() {
    holds(&[]);
    for (i, first) in FEATURES.iter().enumerate() {
        holds(&[first]);
        FEATURES[i + 1..].iter().for_each(|second| holds(&[first, second]));
    }
    holds(&["mean", "expansion", "prony", "sector", "pair", "falling"]);
}
