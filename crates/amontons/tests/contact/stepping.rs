//! Runs that are made step by step: the bits of a run, inputs against the same data in the case and against formulas,
//! ways back, and errors.

use std::sync::Arc;

use amontons::case::{self, Source};
use amontons::discretization::Discretization;
use amontons::equation::{Along, SetupError, Solvers, StepError, StepInputs};
use amontons::linalg::Backend;
use amontons::output::{Checkpoint, Identity, ProbeSet};
use amontons::problem::{Physics, Problem};
use amontons::run::{Settings, Stepping, SteppingError};
use amontons::state::{State, StepReport};
use amontons::step::{March, Scheme};
use amontons::time::{TimePhase, Timeline};

use super::halved_steps::stair;
use super::softening::rod;
use crate::common::{SMALL, changed, solve};

/// Loads and prescribed values on each side of [`SMALL`].
const LOADED: &str = r#"
[[boundary]]
on = "left"
force = ["3*t", "-20*t"]
heat_inflow = "2*t"
[[boundary]]
on = "right"
temperature = 0.25
"#;

fn read(text: &str, overrides: &[&str]) -> case::Case {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    case::parse(&Source::new("small.toml", text), &overrides).unwrap_or_else(|error| panic!("{error}"))
}

fn loaded(overrides: &[&str]) -> Problem {
    read(&format!("{SMALL}{LOADED}"), overrides).problem
}

/// The case without what the inputs replace.
fn bare(overrides: &[&str]) -> Problem {
    let zero = ["boundary[1].force=[0, 0]", "boundary[1].heat_inflow=0", "boundary[2].temperature=0"];
    loaded(&[&zero[..], overrides].concat())
}

fn stepping(problem: &Problem) -> Stepping {
    Stepping::new(problem, &Settings::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// All states of a run.
fn states(problem: &Problem) -> Vec<State> {
    solve(problem).states
}

/// All states, with inputs set before each step from its end t_n.
fn stepped(run: &mut Stepping, mut set: impl FnMut(&mut Stepping, f64) -> Result<(), SteppingError>) -> Vec<State> {
    let mut states = vec![run.state().clone()];
    while !run.is_done() {
        let t = run.problem().timeline.time(run.state().step + 1);
        set(run, t).unwrap_or_else(|error| panic!("{error}"));
        states.push(run.step().unwrap_or_else(|error| panic!("{error}")).clone());
    }
    states
}

fn bits(state: &State) -> Vec<u64> {
    let fields = [&state.u, &state.w, &state.theta, &state.multipliers.p];
    fields.into_iter().flatten().map(|value| value.to_bits()).collect()
}

fn same_bits(found: &[State], expected: &[State]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert!(bits(found) == bits(expected) && found == expected, "step {}", expected.step);
    }
    assert!(expected.last().is_some_and(|last| last.w.iter().any(|w| w.abs() > 1e-6)), "nothing moves");
}

/// Asserts that states agree to a fraction of the largest value of each field, and that both identities close.
fn agree(found: &[State], expected: &[State], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        let pairs = [(&found.u, &expected.u), (&found.w, &expected.w), (&found.theta, &expected.theta)];
        for (found, expected) in pairs {
            let size = expected.iter().fold(0.0f64, |most, x| most.max(x.abs()));
            let error = found.iter().zip(expected).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
            assert!(error <= tolerance * size, "{error:e} of {size:e}");
        }
        let (a, b) = (&found.ledger, &expected.ledger);
        let works = [[a.load_work, b.load_work, b.turned_over], [a.heat_supplied, b.heat_supplied, b.heat_turned_over]];
        for [found, expected, size] in works {
            assert!((found - expected).abs() <= tolerance * size, "{found:e}, expected {expected:e}");
        }
        assert!(a.closing_error.abs() <= 1e-12 * a.turned_over, "{:e} of {:e}", a.closing_error, a.turned_over);
        assert!(a.heat_closing_error.abs() <= 1e-12 * a.heat_turned_over, "{:e}", a.heat_closing_error);
    }
    let last = &expected.last().expect("a state").ledger;
    assert!(last.load_work.abs() > 1e-3 && last.heat_turned_over > 1e-3, "nothing is turned over");
}

#[test]
fn without_inputs_the_states_have_the_bits_of_a_run() {
    for overrides in [&[][..], &["time.scheme='theta'", "time.theta=0.75"], &["contact.normal={law='signorini'}"]] {
        let problem = loaded(overrides);
        same_bits(&stepped(&mut stepping(&problem), |_, _| Ok(())), &states(&problem));
    }
}

/// A force that is spread, and the same force at three nodes: a quarter, a half and a quarter on two edges. The heat
/// likewise. In the ϑ-scheme loads are those at t_ϑ.
#[test]
fn a_load_that_is_set_acts_as_one_of_the_case() {
    for (scheme, theta) in [(&[][..], 1.0), (&["time.scheme='theta'", "time.theta=0.75"], 0.75)] {
        let expected = states(&loaded(&[scheme, &["boundary[2].temperature=0"]].concat()));
        let at = |t: f64| t - (1.0 - theta) * 0.25;
        let spread = |run: &mut Stepping, t: f64| {
            run.set_force("left", &[3.0 * at(t), -20.0 * at(t)])?;
            run.set_heat("left", &[2.0 * at(t)])
        };
        agree(&stepped(&mut stepping(&bare(scheme)), spread), &expected, 1e-13);
        let at_nodes = |run: &mut Stepping, t: f64| {
            let shares = || [0.25, 0.5, 0.25].map(|share| share * at(t)).into_iter();
            // The nodes of the side ascend in y.
            run.set_force("left", &shares().flat_map(|s| [3.0 * s, -20.0 * s]).collect::<Vec<_>>())?;
            run.set_heat("left", &shares().map(|s| 2.0 * s).collect::<Vec<_>>())
        };
        agree(&stepped(&mut stepping(&bare(scheme)), at_nodes), &expected, 1e-13);
        let at_all = |run: &mut Stepping, t: f64| {
            let (mut forces, mut heat) = (vec![0.0; 18], vec![0.0; 9]);
            for (node, share) in [(0, 0.25), (3, 0.5), (6, 0.25)] {
                forces[2 * node] = 3.0 * share * at(t);
                forces[2 * node + 1] = -20.0 * share * at(t);
                heat[node] = 2.0 * share * at(t);
            }
            run.set_forces(&forces)?;
            run.set_heats(&heat)
        };
        agree(&stepped(&mut stepping(&bare(scheme)), at_all), &expected, 1e-13);
    }
}

/// Prescribed values that are constant on a side, and those of each node.
#[test]
fn a_prescribed_value_that_is_set_is_that_of_the_case() {
    let moved = "boundary[0].displacement=['0.25*t*x', '-0.125*t']";
    let foundation = "contact.heat.foundation_temperature='8*t'";
    let overrides = [moved, "boundary[0].temperature='16*t*(1 + x)'", "boundary[2].temperature='4*t'", foundation];
    for scheme in [&[][..], &["time.scheme='theta'"]] {
        let expected = states(&loaded(&[scheme, &overrides].concat()));
        let mut run = stepping(&loaded(scheme));
        let found = stepped(&mut run, |run, t| {
            let x = [0.0, 0.5, 1.0];
            run.set_displacement("top", Along::Axis(0), &x.map(|x| 0.25 * t * x))?;
            run.set_displacement("top", Along::Axis(1), &[-0.125 * t])?;
            run.set_temperature("top", &x.map(|x| 16.0 * t * (1.0 + x)))?;
            run.set_temperature("right", &[4.0 * t])?;
            let level = if scheme.is_empty() { t } else { t - 0.125 };
            run.set_foundation_temperature("bottom", 8.0 * level)
        });
        agree(&found, &expected, 1e-13);
    }
}

/// A body turned by 30°, whose side moves along its normal, which no axis is.
#[test]
fn a_normal_displacement_can_be_set() {
    let turned = |value: &str| {
        let top = format!("boundary[0]={{ on='top', normal_displacement={value}, temperature=0 }}");
        changed(&loaded(&[&top]), |data| {
            let mesh = Arc::make_mut(&mut data.mesh);
            let (sin, cos) = (0.5f64, 0.75f64.sqrt());
            mesh.points.iter_mut().for_each(|x| *x = [cos * x[0] - sin * x[1], sin * x[0] + cos * x[1], 0.0]);
        })
    };
    let expected = states(&turned("'-0.1*t*(1 + x)'"));
    let mut run = stepping(&turned("0"));
    let top = run.problem().mesh.named("top").expect("the side").node_list();
    let x: Vec<f64> = top.iter().map(|&node| run.problem().mesh.points[node as usize][0]).collect();
    let found = stepped(&mut run, |run, t| {
        let values: Vec<f64> = x.iter().map(|x| -0.1 * t * (1.0 + x)).collect();
        run.set_displacement("top", Along::Normal, &values)
    });
    agree(&found, &expected, 1e-13);
}

/// A rod of E = 1 whose layer softens: its steps are made in parts, in which a set displacement grows with time as the
/// expression does.
#[test]
fn a_set_displacement_is_reached_in_the_parts_of_a_halved_step() {
    // The viscosity tells a motion that goes through the parts from one that ends in the first.
    let viscous = ["time.end=2", "material.viscosity.second=0.01"];
    let expected = states(&rod(&viscous));
    assert!(expected.last().is_some_and(|last| last.counts.halved_steps > 0));
    let mut run = stepping(&rod(&[&viscous[..], &["boundary[0].displacement=[0]"]].concat()));
    let found = stepped(&mut run, |run, t| run.set_displacement("left", Along::Axis(0), &[t]));
    for (found, expected) in found.iter().zip(&expected) {
        assert_eq!(found.counts.halved_steps, expected.counts.halved_steps, "step {}", expected.step);
        for (a, b) in found.u.iter().zip(&expected.u) {
            assert!((a - b).abs() <= 1e-12, "step {}: {a:e}, expected {b:e}", expected.step);
        }
        let [found, expected] = [&found.ledger, &expected.ledger];
        let lost = found.viscous_dissipation;
        assert!((lost - expected.viscous_dissipation).abs() <= 1e-12 * expected.turned_over, "{lost:e}");
        assert!(found.relative_closing_error().abs() < 1e-12);
    }
}

const BAR: &str = r#"
name = "bar"
[mesh]
kind = "interval"
size = 2.0
n = 4
[time]
end = 1.0
steps = 2
[material]
density = 0
elasticity = { law = "isotropic", young = 50.0, poisson = 0.0 }
heat_capacity = 0
conductivity = 3.0
[[boundary]]
on = "left"
displacement = [0]
temperature = 1
[[probe]]
name = "held"
quantity = "reaction"
on = "left"
take = "integral"
[[probe]]
name = "borne"
quantity = "total_force"
on = "right"
take = "integral"
"#;

/// u = F L/E and −F at the support; θ = θ₀ + Q L/𝓚 and −Q there.
#[test]
fn a_bar_has_the_length_the_temperature_and_the_reactions_of_the_formulas() {
    let case = read(BAR, &[]);
    let mut run = stepping(&case.problem);
    let probes = ProbeSet::new(&case.problem, &case.probes).unwrap_or_else(|(_, error)| panic!("{error}"));
    for (force, heat) in [(5.0, 6.0), (-2.5, -3.0)] {
        run.set_force("right", &[force]).expect("a force");
        run.set_heat("right", &[heat]).expect("heat");
        let state = run.step().expect("a step").clone();
        let near =
            |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found}, expected {expected}");
        near(state.u[4], force * 2.0 / 50.0);
        near(state.theta[4], 1.0 + heat * 2.0 / 3.0);
        let reactions = &run.report().expect("a report").reactions;
        near(reactions.force[0], -force);
        near(reactions.heat[0], -heat);
        assert_eq!(run.reactions("left").expect("the side"), reactions.force);
        assert_eq!(run.heat_reactions("left").expect("the side"), reactions.heat);
        let read = probes.values(&run.snapshot());
        near(read[0], -force);
        near(read[1], force);
    }
    let ledger = &run.state().ledger;
    // 5 N over 0.2 m, and −2.5 N over −0.3 m.
    assert!((ledger.load_work - (5.0 * 0.2 + 2.5 * 0.3)).abs() < 1e-12, "{}", ledger.load_work);
}

/// Laws that depend on the temperature, whose matrices are factorized anew on the way.
const WARM: [&str; 4] = [
    "material.elasticity.young={ temperature=[-10, 90], value=[12, 2] }",
    "material.conductivity={ temperature=[-10, 90], value=[0.2, 5] }",
    "boundary[0].temperature='80*t'",
    "time.steps=8",
];

#[test]
fn steps_from_a_restored_state_have_the_same_bits() {
    for overrides in [&[][..], &WARM] {
        let problem = bare(overrides);
        let set = |run: &mut Stepping, t: f64| run.set_force("left", &[9.0 * t, -60.0 * t]);
        let expected = stepped(&mut stepping(&problem), set);
        let mut run = stepping(&problem);
        let mut saved = vec![run.save()];
        let steps = problem.timeline.steps();
        for n in 1..=steps {
            set(&mut run, problem.timeline.time(n)).expect("a force");
            run.step().expect("a step");
            saved.push(run.save());
            // Other forces from here on do not matter after the way back.
            run.set_force("left", &[1e3, 1e3]).expect("a force");
            if !run.is_done() {
                run.step().expect("a step");
            }
            run.restore(&saved[n]).expect("the state of this run");
        }
        for from in [0, steps - 1, 2, 1] {
            run.restore(&saved[from]).expect("the state of this run");
            assert_eq!(run.report().is_some(), from > 0);
            let again = stepped(&mut run, set);
            same_bits(&again, &expected[from..]);
        }
    }
}

/// Over the ends of phases, too, whose systems are dropped on the way: those that are missing are made again.
#[test]
fn a_run_of_phases_goes_back_over_their_ends() {
    let mut data = (*loaded(&[])).clone();
    data.timeline = Timeline::in_phases(vec![
        TimePhase::quasistatic("press", 0.05, 2),
        TimePhase::dynamic("slide", 0.1, 5),
        TimePhase::dynamic("rest", 0.2, 2),
    ]);
    let problem = data.check().unwrap_or_else(|faults| panic!("{faults}"));
    let expected = stepped(&mut stepping(&problem), |_, _| Ok(()));
    same_bits(&expected, &states(&problem));
    let mut run = stepping(&problem);
    let mut saved = vec![run.save()];
    while !run.is_done() {
        run.step().unwrap_or_else(|error| panic!("{error}"));
        saved.push(run.save());
    }
    for from in [8, 1, 7, 0, 6, 2, 5] {
        run.restore(&saved[from]).expect("the state of this run");
        same_bits(&stepped(&mut run, |_, _| Ok(())), &expected[from..]);
        let mut other = Stepping::resume(&problem, saved[from].clone(), &Settings::default()).expect("a state");
        same_bits(&stepped(&mut other, |_, _| Ok(())), &expected[from..]);
    }
}

/// A saved state goes through a file, and on with another number of threads.
#[test]
fn a_run_goes_on_from_the_file_of_a_saved_state() {
    let problem = bare(&WARM);
    let set = |run: &mut Stepping, t: f64| run.set_force("left", &[9.0 * t, -60.0 * t]);
    let one = Settings { threads: Some(1), ..Settings::default() };
    let mut run = Stepping::new(&problem, &one).expect("a run");
    let path = std::env::temp_dir().join(format!("amontons-stepping-{}.bin", std::process::id()));
    for n in 1..=3 {
        set(&mut run, problem.timeline.time(n)).expect("a force");
        run.step().expect("a step");
    }
    run.save().write(&path, &Identity::default()).expect("a file");
    let expected = stepped(&mut run, set);
    let saved = Checkpoint::read_file(&path, &Identity::default()).expect("the file");
    let other = Identity::of_text("another case", &[]);
    assert!(Checkpoint::read_file(&path, &other).is_err_and(|error| error.to_string().contains("of another case")));
    std::fs::remove_file(&path).expect("the file");
    let two = Settings { threads: Some(2), ..Settings::default() };
    let mut again = Stepping::resume(&problem, saved, &two).expect("a run");
    same_bits(&stepped(&mut again, set), &expected);
}

/// E r = F − p with a stair of 0.2 at r = 0.43 has no solution for 0.43 < F ≤ 0.63. With another force the step is
/// made, with the bits of a run that never failed.
#[test]
fn a_failed_step_leaves_the_state_and_can_be_tried_again() {
    let problem = stair(&["time.steps=10"], 0.43, 0.2);
    let set = |run: &mut Stepping, force: f64| run.set_force("right", &[force]);
    let force = |n: usize| [0.1, 0.2, 0.3, 0.4, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2][n];
    let mut expected = stepping(&problem);
    let mut run = stepping(&problem);
    for n in 0..10 {
        if n == 4 {
            let before = run.state().clone();
            set(&mut run, 0.5).expect("a force");
            let error = run.step().expect_err("no solution");
            assert!(
                matches!(error, SteppingError::Step { source: StepError::NotConverged { step: 5, .. } }),
                "{error}"
            );
            assert!(error.advice().is_some_and(|advice| advice.contains("time.steps")));
            assert_eq!(run.state(), &before);
        }
        for run in [&mut run, &mut expected] {
            set(run, force(n)).expect("a force");
            run.step().unwrap_or_else(|error| panic!("step {}: {error}", n + 1));
        }
        assert!(bits(run.state()) == bits(expected.state()) && run.state() == expected.state(), "step {}", n + 1);
        let end = run.state().u.last().copied().unwrap_or_default();
        let closed = force(n) - if force(n) > 0.63 { 0.2 } else { 0.0 };
        assert!((end - closed).abs() < 1e-12, "{end}, expected {closed}");
    }
    let error = run.step().expect_err("the end");
    assert!(error.to_string().starts_with("step 11: found a run at its end after 10 steps"), "{error}");
}

#[test]
fn an_input_that_does_not_fit_is_refused_with_its_place() {
    let mut run = stepping(&loaded(&[]));
    let mut told = |set: &dyn Fn(&mut Stepping) -> Result<(), SteppingError>, expected: &str| {
        let error = set(&mut run).expect_err(expected).to_string();
        assert!(error.starts_with(expected), "{error}\nexpected: {expected}");
        assert_eq!(run.inputs(), &StepInputs::default());
    };
    let sides = "found no side of this name, expected bottom, left, right, top";
    told(&|run| run.set_force("lid", &[0.0, 1.0]), &format!("force on \"lid\": {sides}"));
    told(&|run| run.set_heat("lid", &[1.0]), &format!("heat on \"lid\": {sides}"));
    told(&|run| run.set_temperature("lid", &[1.0]), &format!("temperature on \"lid\": {sides}"));
    told(&|run| run.set_force("top", &[1.0]), "force on \"top\": found 1 number, expected 2 or 6 numbers");
    told(
        &|run| run.set_force("top", &[f64::NAN, 1.0]),
        "force on \"top\": found NaN in place 0, expected finite numbers",
    );
    told(&|run| run.set_forces(&[1.0; 2]), "forces: found 2 numbers, expected 18 numbers");
    told(&|run| run.set_heat("top", &[]), "heat on \"top\": found 0 numbers, expected 1 or 3 numbers");
    told(&|run| run.set_heats(&[1.0]), "heat: found 1 number, expected 9 numbers");
    told(
        &|run| run.set_displacement("top", Along::Axis(0), &[1.0; 2]),
        "displacement[0] on \"top\": found 2 numbers, expected 1 or 3 numbers",
    );
    told(
        &|run| run.set_displacement("top", Along::Axis(1), &[f64::INFINITY]),
        "displacement[1] on \"top\": found inf in place 0, expected finite numbers",
    );
    let free = "found a value that the case does not prescribe, expected a prescribed value; give the side a ";
    for (along, key) in [(Along::Axis(0), "displacement[0]"), (Along::Normal, "normal_displacement")] {
        told(&|run| run.set_displacement("left", along, &[1.0]), &format!("{key} on \"left\": {free}"));
    }
    told(&|run| run.set_displacement("top", Along::Axis(2), &[1.0]), &format!("displacement[2] on \"top\": {free}"));
    told(&|run| run.set_temperature("left", &[1.0]), &format!("temperature on \"left\": {free}"));
    told(
        &|run| run.set_foundation_temperature("top", 1.0),
        "foundation_temperature of \"top\": found no contact of this name, expected bottom",
    );
    told(
        &|run| run.set_foundation_temperature("bottom", f64::NAN),
        "foundation_temperature of \"bottom\": found NaN in place 0",
    );
    let warming = loaded(&["contact.foundation={ heat_capacity=1, exchange=1, surroundings=0 }"]);
    let error = stepping(&warming).set_foundation_temperature("bottom", 1.0).expect_err("a computed temperature");
    assert!(error.to_string().contains("found a foundation with a heat capacity"), "{error}");
    let mut dry = stepping(&changed(&read(BAR, &[]).problem, |data| data.physics = Physics::Mechanics));
    let error = dry.set_heat("right", &[1.0]).expect_err("no heat");
    assert!(error.to_string().contains("found heat in a problem without heat"), "{error}");
    let error = dry.set_temperature("left", &[1.0]).expect_err("no heat");
    assert!(error.to_string().contains("found a value that the case does not prescribe"), "{error}");
}

/// Backward Euler that hides what it can do with inputs.
#[derive(Debug)]
struct Plain(March);

impl Scheme for Plain {
    fn discretization(&self) -> &Discretization {
        self.0.discretization()
    }
    fn initial(&self) -> Result<State, SetupError> {
        self.0.initial()
    }
    fn step(&mut self, state: &State) -> Result<(State, StepReport), StepError> {
        self.0.step(state)
    }
    fn solvers(&self) -> Solvers {
        self.0.solvers()
    }
}

fn plain(
    problem: &Problem,
    discrete: &Arc<Discretization>,
    backend: &Arc<dyn Backend>,
) -> Result<Box<dyn Scheme>, SetupError> {
    Ok(Box::new(Plain(March::on(problem, discrete, backend)?)))
}

#[test]
fn a_scheme_without_inputs_refuses_them() {
    let settings = Settings { scheme: plain, ..Settings::default() };
    let mut run = Stepping::new(&loaded(&[]), &settings).expect("a run");
    let error = run.set_heat("left", &[1.0]).expect_err("no inputs");
    assert!(error.to_string().starts_with("heat: found a time-stepping scheme without inputs"), "{error}");
    run.step().expect("a step");
}
