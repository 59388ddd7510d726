//! Steady phases: closed forms of hot sliding, the limit of runs in time, other phases beside them, friction at rest,
//! and what has no steady state.

use amontons::case::{self, Source};
use amontons::equation::StepError;
use amontons::output::Memory;
use amontons::problem::{Problem, StartState};
use amontons::run::{self, RunError, Settings};
use amontons::state::State;
use amontons::step::{Kept, March, Scheme};
use amontons::time::{Analysis, TimePhase, TimeScheme, Timeline};

use crate::common::{changed, largest, spoil};

fn parsed(text: &str) -> Problem {
    case::parse(&Source::new("steady.toml", text), &[]).unwrap_or_else(|error| panic!("{error}")).problem
}

/// A run without a certificate, with all states.
fn run(problem: &Problem) -> Memory {
    made(problem).unwrap_or_else(|error| panic!("{error}"))
}

fn made(problem: &Problem) -> Result<Memory, RunError> {
    let mut memory = Memory::new().states_every(1).reports();
    run::run(problem, &Settings { certificate: false, ..Settings::default() }, &mut [&mut memory]).map(|_| memory)
}

/// Closing errors of energy and heat, relative.
fn closing(state: &State) -> [f64; 2] {
    [state.ledger.relative_closing_error(), state.ledger.relative_heat_closing_error()].map(f64::abs)
}

/// Steel between a wall at 0 K and a belt out of the plane that leaves it all heat of friction, 1 µm too long for its
/// 20 mm: V_c = 2k/(fαEL).
const CRITICAL: f64 = 2.0 * 50.0 / (0.3 * 1e-5 * 2e11 * 0.02);
const UNHEATED: f64 = 2e11 * 1e-6 / 0.02;

/// The rod along an axis, on a line or as a strip, the belt at its end or at its start.
fn rod(dim: usize, axis: usize, reversed: bool, speed: f64) -> Problem {
    let sides = if axis == 0 { ["left", "right"] } else { ["bottom", "top"] };
    let others = if axis == 0 { ["bottom", "top"] } else { ["left", "right"] };
    let [wall, belt] = if reversed { [sides[1], sides[0]] } else { sides };
    let (mesh, held, slides) = if dim == 1 {
        ("kind = \"interval\"\nsize = 0.02\nn = 4".to_owned(), "[0]", format!("[0, 0, {speed:?}]"))
    } else {
        let size = if axis == 0 { "[0.02, 0.005]\nn = [4, 1]" } else { "[0.005, 0.02]\nn = [1, 4]" };
        (format!("kind = \"rectangle\"\nelements = \"Q1\"\nsize = {size}"), "[0, 0]", format!("[0, 0, {speed:?}]"))
    };
    let free = if axis == 0 { "[\"free\", 0]" } else { "[0, \"free\"]" };
    let guide = |side: &str| format!("[[boundary]]\non = \"{side}\"\ndisplacement = {free}\n");
    let guides = if dim == 1 { String::new() } else { others.map(guide).concat() };
    let state = if dim == 1 { "" } else { ", stress_state = \"plane-stress\"" };
    parsed(&format!(
        r#"
name = "rod"
[mesh]
{mesh}
[time]
end = 2.0
analysis = "steady"
[material]
elasticity = {{ law = "isotropic", young = 2e11, poisson = 0.0{state} }}
expansion_coefficient = 1e-5
conductivity = 50
[[boundary]]
on = "{wall}"
displacement = {held}
temperature = 0
{guides}
[contact]
on = "{belt}"
gap = -1e-6
foundation_velocity = {slides}
normal = {{ law = "signorini" }}
friction = {{ law = "coulomb", coefficient = 0.3 }}
frictional_heat = 1
"#
    ))
}

/// p = p₀/(1 − V/V_c), and θ = 10 K at V_c/2, in few passes however near V is to V_c.
#[test]
fn hot_sliding_has_the_pressure_of_its_closed_form() {
    for (dim, axis, reversed) in [(1, 0, false), (1, 0, true), (2, 0, false), (2, 0, true), (2, 1, false), (2, 1, true)]
    {
        for share in [0.25, 0.5, 0.75, 0.9, -0.9, 0.99] {
            let problem = rod(dim, axis, reversed, share * CRITICAL);
            let memory = run(&problem);
            let state = memory.states.last().expect("a state");
            let report = memory.reports.last().expect("a report");
            let pressure = UNHEATED / (1.0 - share.abs());
            for point in &report.contact.states {
                let error = (point.pressure / pressure - 1.0).abs();
                assert!(error < 1e-9, "{dim}, {axis}, {reversed}, {share}: {} is off by {error:e}", point.pressure);
            }
            let warmest = 0.3 * pressure * share.abs() * CRITICAL * 0.02 / 50.0;
            assert!((largest(&state.theta) / warmest - 1.0).abs() < 1e-9, "{} K", largest(&state.theta));
            assert!(closing(state).iter().all(|error| *error < 1e-12), "{:?}", closing(state));
            assert!(report.coupling.passes <= 4, "{} passes at {share}", report.coupling.passes);
            // The belt rubs for 2 s, and what it rubs leaves through the wall.
            let area = if dim == 1 { 1.0 } else { 0.005 };
            let rubbed = 2.0 * area * 0.3 * pressure * share.abs() * CRITICAL;
            for found in [state.ledger.friction_dissipation, state.ledger.heat_friction, state.ledger.heat_prescribed] {
                assert!((found.abs() / rubbed - 1.0).abs() < 1e-9, "{found} J of {rubbed}");
            }
            assert_eq!(largest(&state.w).to_bits(), 0);
        }
    }
    let warmest = run(&rod(1, 0, false, 0.5 * CRITICAL)).states.last().map_or(0.0, |state| largest(&state.theta));
    assert!((warmest - 10.0).abs() < 1e-8, "{warmest} K");
}

#[test]
fn beyond_the_critical_speed_there_is_no_steady_state() {
    for (share, dim, reversed) in [(1.001, 1, false), (1.5, 2, true), (4.0, 1, true)] {
        let problem = rod(dim, 0, reversed, share * CRITICAL);
        let told = made(&problem).map(|_| ()).expect_err("a rod that presses on without end");
        let RunError::Step { source, .. } = &told else { panic!("{told}") };
        assert!(matches!(source, StepError::NotSteady { step: 1, .. }), "{source}");
        let text = source.to_string();
        assert!(text.contains("there may be none, as above the critical speed of sliding"), "{text}");
    }
}

/// A block of steel that is pressed on a belt in its plane, with heat through the layer, by radiation and from a
/// conductivity and an expansion that depend on the temperature.
const BLOCK: &str = r#"
name = "block"
[mesh]
kind = "rectangle"
size = [0.02, 0.01]
n = [8, 4]
[time]
end = 1.0
analysis = "steady"
[material]
density = 7800
heat_capacity = 4e6
elasticity = { law = "isotropic", young = 2e11, poisson = 0.3, stress_state = "plane-strain" }
viscosity = { law = "lame", first = 1e6, second = 1e6 }
expansion_coefficient = 1e-5
conductivity = { temperature = [0, 1000], value = [50, 30] }
[[boundary]]
on = "top"
displacement = [0, -2e-6]
temperature = 0
[contact]
on = "bottom"
foundation_velocity = [0.008, 0]
normal = { law = "compliance", stiffness = 1e13 }
friction = { law = "coulomb", coefficient = 0.3 }
frictional_heat = 1
[contact.heat]
law = "sum"
foundation_temperature = 20
laws = [
  { law = "constant", conductance = 1000 },
  { law = "radiation", emissivity = 0.8, absolute_zero = -293 },
]
"#;

/// The state at the end of a long run in time is the steady one.
#[test]
fn a_long_run_in_time_ends_in_the_steady_state() {
    let steady = parsed(BLOCK);
    // The time of heat across the block is 1e-4 m²/(1.25e-5 m²/s) = 8 s over π².
    let long =
        changed(&steady, |data| data.timeline = Timeline::equal(400.0, 100).with_analysis(Analysis::Quasistatic));
    let (steady, long) =
        (run(&steady), run(&changed(&long, |data| data.coupling = amontons::problem::Coupling::Monolithic)));
    let [found, limit] = [&steady, &long].map(|memory| memory.states.last().expect("a state"));
    for (name, found, limit) in [("u", &found.u, &limit.u), ("θ", &found.theta, &limit.theta)] {
        let apart: Vec<f64> = found.iter().zip(limit).map(|(a, b)| a - b).collect();
        assert!(largest(&apart) < 1e-8 * largest(limit), "{name}: {:e} of {:e}", largest(&apart), largest(limit));
    }
    assert!(largest(&found.theta) > 5.0, "{} K", largest(&found.theta));
    assert!(closing(found).iter().all(|error| *error < 1e-12), "{:?}", closing(found));
    for [a, b] in steady
        .reports
        .last()
        .iter()
        .zip(long.reports.last())
        .flat_map(|(a, b)| a.contact.states.iter().zip(&b.contact.states).map(|(a, b)| [a, b]))
    {
        assert!((a.pressure - b.pressure).abs() < 1e-8 * b.pressure.max(1e6) && a.status == b.status);
    }
}

/// The block in phases: pressed at rest, steady on its belt, and then in time.
fn in_phases(scheme: TimeScheme) -> Problem {
    let moving = spoil(BLOCK, "[0.008, 0]", "[\"if(t > 1, 0.008, 0)\", 0]");
    let linear = spoil(&moving, "{ temperature = [0, 1000], value = [50, 30] }", "45");
    let phases = "[time]\n[[phase]]\nname = \"press\"\nend = 1\nsteps = 3\nanalysis = \"quasistatic\"\n\
                  [[phase]]\nname = \"run-in\"\nend = 11\nanalysis = \"steady\"\nsteps = 2\n\
                  [[phase]]\nname = \"spin\"\nend = 11.001\nsteps = 8\n";
    let problem = parsed(&spoil(&linear, "[time]\nend = 1.0\nanalysis = \"steady\"\n", phases));
    changed(&problem, |data| data.scheme = scheme)
}

/// In a dynamic phase behind a steady one with the same data nothing moves and nothing warms up.
#[test]
fn nothing_moves_after_a_steady_phase() {
    for scheme in [TimeScheme::BackwardEuler, TimeScheme::theta(0.5), TimeScheme::Bdf2] {
        let memory = run(&in_phases(scheme));
        let steady = &memory.states[5];
        assert!(largest(&steady.theta) > 5.0 && largest(&steady.u) > 1e-6);
        for state in &memory.states[6..] {
            let apart = |a: &[f64], b: &[f64]| largest(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f64>>());
            let (moved, warmed) = (apart(&state.u, &steady.u), apart(&state.theta, &steady.theta));
            assert!(moved < 1e-11 * largest(&steady.u), "{scheme:?}: {moved:e} at {}", state.t);
            assert!(warmed < 1e-11 * largest(&steady.theta), "{scheme:?}: {warmed:e} K at {}", state.t);
            // Over a step of 1e-4 s, and the sound that crosses the block in 2e-6 s.
            assert!(largest(&state.w) < 1e-12 * 5e3, "{scheme:?}: {:e} m/s", largest(&state.w));
        }
        for state in &memory.states {
            assert!(closing(state).iter().all(|error| *error < 1e-12), "{scheme:?}, {}: {:?}", state.t, closing(state));
        }
        // The second steady step finds what the first one did.
        let again: Vec<f64> = memory.states[4].u.iter().zip(&steady.u).map(|(a, b)| a - b).collect();
        assert!(largest(&again) < 1e-12 * largest(&steady.u), "{:e}", largest(&again));
    }
}

/// From every step on, with the same bits.
#[test]
fn a_run_with_a_steady_phase_goes_on_with_the_same_bits() {
    for scheme in [TimeScheme::BackwardEuler, TimeScheme::Bdf2] {
        let problem = in_phases(scheme);
        let mut whole = March::new(&problem).expect("a regular system");
        let mut states: Vec<(State, Kept)> = vec![(whole.initial().expect("finite initial data"), whole.kept())];
        while states.len() <= problem.timeline.steps() {
            let next = whole.step(&states[states.len() - 1].0).expect("a step").0;
            states.push((next, whole.kept()));
        }
        for pair in states.windows(2) {
            let [(from, kept), (next, then)] = pair else { unreachable!("windows of two") };
            let mut again = March::new(&problem).expect("a regular system");
            again.recall(kept).expect("a regular system");
            let found = again.step(from).expect("a step").0;
            assert!(found == *next && again.kept() == *then, "step {}", next.step);
        }
    }
}

/// On a foundation at rest a steady step of mechanics is a start in equilibrium: friction acts as in one static step.
#[test]
fn a_steady_step_at_rest_is_an_equilibrium() {
    let (block, _) = BLOCK.split_once("[contact.heat]").expect("a heat law");
    let kept =
        |line: &&str| !["heat", "expansion", "conduct", "friction", "temp"].iter().any(|key| line.starts_with(key));
    let text: String = block.lines().filter(kept).map(|line| format!("{line}\n")).collect();
    let text = spoil(&text, "foundation_velocity = [0.008, 0]", "friction = { law = \"coulomb\", coefficient = 0.3 }");
    let text = spoil(&text, "[0, -2e-6]", "[1e-7, -2e-6]");
    let steady = parsed(&text);
    let equilibrium = changed(&steady, |data| {
        data.timeline = Timeline::equal(1.0, 1);
        data.initial.state = StartState::Equilibrium;
    });
    let memory = run(&steady);
    let (found, report) = (&memory.states[1], memory.reports.last().expect("a report"));
    let start = &run(&equilibrium).states[0];
    let apart: Vec<f64> = found.u.iter().zip(&start.u).map(|(a, b)| a - b).collect();
    assert!(largest(&apart) < 1e-12 * largest(&start.u), "{:e}", largest(&apart));
    let sticking =
        report.contact.states.iter().filter(|point| point.status == amontons::contact::Status::Stick).count();
    assert!(sticking > 0 && sticking < report.contact.states.len(), "{sticking} points stick");
    assert!(closing(found)[0] < 1e-12 && found.ledger.friction_dissipation > 0.0, "{:?}", closing(found));
}

/// A block that slides on one side and rests on another: velocities of v_F and of round-off in one step.
#[test]
fn a_body_may_slide_on_one_side_and_stick_to_another() {
    let both = spoil(BLOCK, "[contact]", "[[contact]]")
        + "[[contact]]\non = \"right\"\ngap = -1e-7\nnormal = { law = \"compliance\", stiffness = 1e13 }\n\
           friction = { law = \"coulomb\", coefficient = 0.2 }\n";
    let steady = parsed(&both);
    let limit = changed(&steady, |data| {
        data.timeline =
            Timeline::in_phases(vec![TimePhase::steady("one", 1.0, 1), TimePhase::quasistatic("two", 2.0, 4)]);
    });
    let memory = run(&limit);
    let [now, after] = [1, 5].map(|n| &memory.states[n]);
    let apart: Vec<f64> = now.u.iter().zip(&after.u).map(|(a, b)| a - b).collect();
    assert!(largest(&apart) < 1e-9 * largest(&now.u), "{:e} of {:e}", largest(&apart), largest(&now.u));
    let resting = memory.reports.last().expect("a report").contact.states.iter().filter(|point| point.normal[0] > 0.5);
    let bearing: Vec<_> = resting.filter(|point| point.pressure > 0.0).collect();
    assert!(bearing.iter().any(|point| point.q[1].abs() > 1.0), "{bearing:?}");
    for state in &memory.states {
        assert!(closing(state).iter().all(|error| *error < 1e-12), "{:?}", closing(state));
    }
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let problem = in_phases(TimeScheme::Bdf2);
    let states = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| run(&problem)).states
    };
    assert!(states(1) == states(4));
}

/// A block under bilateral contact, which cannot leave its foundation: with strong friction it jams, and no steady
/// state exists. `turned` has x and z exchanged, and `scale` is the unit of length.
fn jamming(coefficient: f64, turned: bool, scale: f64, rest: &str) -> Problem {
    let vector = |v: [f64; 3]| {
        let [x, y, z] = v.map(|c| c * scale);
        format!("{:?}", if turned { [z, y, x] } else { [x, y, z] })
    };
    let n = if turned { "[1, 2, 3]" } else { "[3, 2, 1]" };
    let (size, down, velocity) = (vector([1.17, 1.87, 0.70]), vector([0.0, -0.02, 0.0]), vector([0.492, 0.0, -0.4805]));
    parsed(&format!(
        r#"
name = "block"
[mesh]
kind = "box"
size = {size}
n = {n}
elements = "Q1"
[time]
{rest}
[material]
elasticity = {{ law = "isotropic", young = 1.0, poisson = 0.037 }}
viscosity = {{ law = "lame", first = 0.0, second = 0.00963 }}
[[boundary]]
on = "top"
displacement = {down}
[contact]
on = "bottom"
normal = {{ law = "bilateral" }}
friction = {{ law = "coulomb", coefficient = {coefficient:?} }}
foundation_velocity = {velocity}
"#
    ))
}

#[test]
fn what_friction_jams_has_no_steady_state() {
    const STEADY: &str = "end = 1.0\nanalysis = \"steady\"";
    const LONG: &str = "end = 40.0\nsteps = 100\nanalysis = \"quasistatic\"";
    for (turned, scale) in [(false, 1.0), (true, 1.0), (false, 1e-3), (true, 1e3)] {
        let last = |memory: Memory| memory.states.last().expect("a state").u.clone();
        for coefficient in [0.2, 0.44] {
            let [steady, long] = [STEADY, LONG].map(|rest| last(run(&jamming(coefficient, turned, scale, rest))));
            let apart: Vec<f64> = steady.iter().zip(&long).map(|(a, b)| a - b).collect();
            assert!(largest(&apart) < 1e-9 * largest(&long), "{:e} of {:e}", largest(&apart), largest(&long));
        }
        let told = made(&jamming(0.475, turned, scale, STEADY)).map(|_| ()).expect_err("a block that jams");
        let RunError::Step { source: StepError::DrawnAlong { share, .. }, .. } = &told else { panic!("{told}") };
        assert!((0.1..10.0).contains(share), "{share}");
        // In time it is drawn along at the velocity of its foundation.
        let drawn = last(run(&jamming(0.475, turned, scale, LONG)));
        assert!(largest(&drawn) > 0.9 * 0.492 * 40.0 * scale, "{:e}", largest(&drawn));
    }
}
