//! Phases of a run: what they share with a run without phases, the factors they make, closed forms of a quasistatic
//! phase before a dynamic one, energy, and runs that go on.

use amontons::case::{self, ReferenceRequest, Source, StudyRequest};
use amontons::convergence::{StudyLevel, StudySettings, Vary};
use amontons::equation::ACCEPTED;
use amontons::output::Memory;
use amontons::problem::Problem;
use amontons::run::{self, Settings};
use amontons::state::State;
use amontons::step::{Kept, March, Scheme};
use amontons::time::{Analysis, TimePhase, TimeScheme, Timeline};

use crate::common::{changed, paper};

/// A bar of length 1 and one cell: m ü + κ u = F at its right end, m = ρ/3.
const BAR: &str = r#"
name = "bar"
units = "dimensionless"
[mesh]
kind = "interval"
size = 1.0
n = 1
[time]
[material]
density = 3.0
elasticity = { law = "isotropic", young = 4.0, poisson = 0.0 }
[[boundary]]
on = "left"
displacement = [0]
[[boundary]]
on = "right"
traction = ["if(t > 1, 0, t)"]
[[phase]]
name = "pull"
end = 1.0
steps = 4
analysis = "quasistatic"
[[phase]]
name = "free"
end = 3.0
steps = 100
"#;

fn bar(overrides: &[String]) -> Problem {
    let read = case::parse(&Source::new("bar.toml", BAR), overrides);
    read.unwrap_or_else(|error| panic!("{error}")).problem
}

/// A run without a certificate, with all states.
fn run(problem: &Problem) -> Memory {
    let mut memory = Memory::new().states_every(1).reports();
    run::run(problem, &Settings { certificate: false, ..Settings::default() }, &mut [&mut memory]).expect("a run");
    memory
}

/// The paper's square with a foundation that heats it, in three phases with two step lengths.
fn three() -> Problem {
    let coarse = paper(&["mesh.n=6", "contact.heat.foundation_temperature=10"]).problem;
    changed(&coarse, |data| {
        data.timeline = Timeline::in_phases(vec![
            TimePhase::quasistatic("press", 0.25, 3),
            TimePhase::dynamic("slide", 0.5, 6),
            TimePhase::dynamic("hold", 1.0, 3),
            TimePhase::dynamic("slide-again", 1.25, 6),
        ]);
    })
}

#[test]
fn phases_with_one_step_length_change_no_bit() {
    for scheme in [TimeScheme::BackwardEuler, TimeScheme::theta(0.5), TimeScheme::Bdf2, TimeScheme::ContactStabilised] {
        let whole = changed(&paper(&["mesh.n=6", "time.steps=8"]).problem, |data| data.scheme = scheme);
        let parted = changed(&whole, |data| {
            data.timeline =
                Timeline::in_phases(vec![TimePhase::dynamic("first", 0.375, 3), TimePhase::dynamic("second", 1.0, 5)]);
        });
        let (whole, parted) = (run(&whole), run(&parted));
        assert_eq!(whole.states.len(), 9);
        assert!(whole.states == parted.states);
    }
}

/// Two matrices per step length and analysis: K_u and K_θ.
#[test]
fn a_factor_is_made_once_per_step_length_and_analysis() {
    let made = |problem: &Problem| {
        let mut scheme = March::new(problem).expect("a regular system");
        let mut state = scheme.initial().expect("finite initial data");
        let mut made = Vec::new();
        for _ in 0..problem.timeline.steps() {
            state = scheme.step(&state).expect("a step").0;
            made.push((scheme.solvers().factorizations[0], scheme.kept().rules.len()));
        }
        assert_eq!(state.counts.halved_steps, 0);
        made
    };
    let three = three();
    let expected = [[(2, 1); 3].as_slice(), &[(4, 1); 6], &[(6, 2); 3], &[(6, 1); 6]].concat();
    // Systems of a phase that is over are dropped unless a later phase has its step length.
    assert_eq!(made(&three), expected);
    assert_eq!(three.timeline.lengths(), 3);
    let equal = changed(&three, |data| data.timeline = Timeline::equal(1.0, 8));
    assert_eq!(made(&equal), [(2, 1); 8]);
    // The step length 1/12 with and without inertia has two matrices K_u, and as many K_θ.
    let same = changed(&three, |data| {
        data.timeline = Timeline::in_phases(vec![TimePhase::quasistatic("a", 0.5, 2), TimePhase::dynamic("b", 1.0, 2)]);
    });
    assert_eq!(made(&same), [(2, 1), (2, 1), (4, 1), (4, 1)]);
}

/// u = F/κ at the end of each step of the quasistatic phase, and then u = cos(ωt)/κ with ω² = κ/m = 4.
#[test]
fn a_bar_that_is_let_go_oscillates_with_its_static_stretch() {
    let error = |scheme: &str, steps: usize| {
        let overrides = [format!("time.scheme=\"{scheme}\""), format!("phase.free.steps={steps}")];
        let problem = bar(&overrides);
        let states = run(&problem).states;
        assert_eq!(states.len(), 5 + steps);
        for state in &states[1..=4] {
            assert!((state.u[1] - 0.25 * state.t).abs() < 1e-14, "{} at {}", state.u[1], state.t);
            assert!(state.ledger.kinetic.to_bits() == 0 && state.ledger.relative_closing_error().abs() < 1e-13);
        }
        for state in &states[5..] {
            let energy = state.ledger.kinetic + state.ledger.elastic;
            let kept = if scheme == "theta" { energy } else { energy + state.ledger.scheme_dissipation };
            // Half of F²/κ, without what backward Euler took in the phase before.
            let start = if scheme == "theta" { 0.125 } else { 0.125 + states[4].ledger.scheme_dissipation };
            assert!((kept - start).abs() < 1e-13, "{kept} at {}", state.t);
            assert!(state.ledger.relative_closing_error().abs() < 1e-13);
        }
        let exact = |t: f64| 0.25 * (2.0 * (t - 1.0)).cos();
        states[4..].iter().map(|state| (state.u[1] - exact(state.t)).abs()).fold(0.0, f64::max)
    };
    for (scheme, order) in [("euler", 1.0), ("theta", 2.0)] {
        let errors = [100, 200, 400].map(|steps| error(scheme, steps));
        let orders = [0, 1].map(|i| (errors[i] / errors[i + 1]).log2());
        assert!(orders.iter().all(|found| (found - order).abs() < 0.1), "{scheme}: {errors:?}, {orders:?}");
    }
}

/// Without the rest at its start the dynamic phase would begin with the velocity of the pull, 1/κ.
#[test]
fn a_dynamic_phase_behind_a_quasistatic_one_starts_at_rest() {
    let problem = bar(&["phase.free.steps=20000".to_owned()]);
    let mut scheme = March::new(&problem).expect("a regular system");
    let mut state = scheme.initial().expect("finite initial data");
    for _ in 0..4 {
        state = scheme.step(&state).expect("a step").0;
    }
    assert!((state.w[1] - 0.25).abs() < 1e-13, "{}", state.w[1]);
    let next = scheme.step(&state).expect("a step").0;
    assert!(next.w[1] < 0.0 && next.w[1] > -2e-4, "{}", next.w[1]);
}

/// The kinetic energy with which a quasistatic phase begins is counted as taken by the scheme.
#[test]
fn energy_closes_where_inertia_ends_and_begins() {
    for scheme in [TimeScheme::BackwardEuler, TimeScheme::theta(0.5), TimeScheme::Bdf2, TimeScheme::ContactStabilised] {
        let problem = changed(&three(), |data| {
            data.scheme = scheme;
            data.timeline = Timeline::in_phases(vec![
                TimePhase::dynamic("slide", 0.5, 8),
                TimePhase::quasistatic("press", 0.75, 3),
                TimePhase::dynamic("slide-again", 1.25, 6),
            ]);
        });
        let states = run(&problem).states;
        let kinetic = states[8].ledger.kinetic;
        assert!(kinetic > 1e-6 && states[12].ledger.kinetic > 0.0, "{kinetic:e}");
        let taken = states[9].ledger.scheme_dissipation - states[8].ledger.scheme_dissipation;
        assert!(taken >= kinetic, "{taken:e} of {kinetic:e}");
        for (n, state) in states.iter().enumerate() {
            let analysis = problem.timeline.instant(n).analysis;
            assert!(analysis == Analysis::Dynamic || state.ledger.kinetic.to_bits() == 0);
            let [energy, heat] =
                [state.ledger.relative_closing_error(), state.ledger.relative_heat_closing_error()].map(f64::abs);
            assert!(energy < ACCEPTED && heat < ACCEPTED, "step {n}: {energy:e} {heat:e}");
        }
    }
}

/// In a quasistatic phase the states are those of a body without density.
#[test]
fn a_quasistatic_phase_is_a_body_without_density() {
    let problem = three();
    let all = |problem: &Problem, phase: TimePhase, density: f64| {
        run(&changed(problem, |data| {
            data.timeline = Timeline::in_phases(vec![phase]);
            data.materials.iter_mut().for_each(|material| material.density = density.into());
        }))
    };
    let phased = all(&problem, TimePhase::quasistatic("press", 1.0, 8), 1.0);
    let light = all(&problem, TimePhase::dynamic("press", 1.0, 8), 0.0);
    let heavy = all(&problem, TimePhase::dynamic("press", 1.0, 8), 1.0);
    let values = |memory: &Memory| memory.states.iter().map(|s| (s.u.clone(), s.theta.clone())).collect::<Vec<_>>();
    assert!(values(&phased) == values(&light) && values(&phased) != values(&heavy));
}

/// From every step on, inside and at the ends of phases, with the same bits and the same systems.
#[test]
fn a_run_that_goes_on_has_the_same_bits() {
    for scheme in [TimeScheme::BackwardEuler, TimeScheme::theta(0.5), TimeScheme::Bdf2, TimeScheme::ContactStabilised] {
        let problem = changed(&three(), |data| data.scheme = scheme);
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
            let made = again.solvers().factorizations[0];
            let found = again.step(from).expect("a step").0;
            assert!(found == *next && again.kept() == *then, "step {}", next.step);
            let more = 2 * then.rules.iter().filter(|rule| !kept.rules.contains(rule)).count();
            assert_eq!(again.solvers().factorizations[0], made + more, "step {}", next.step);
        }
    }
}

/// Errors against 1664 steps fall as 1/104 − 1/1664 and 1/208 − 1/1664 of a scheme of first order: by 2^1.1. Each phase
/// has its own share of the steps, and the reference has all times of the levels.
#[test]
fn a_study_refines_each_phase_by_the_same_factor() {
    let source = Source::new("bar.toml", BAR);
    let reference = ReferenceRequest::Level(1664);
    let request = StudyRequest { vary: Vary::Time, levels: vec![104, 208], reference, power: 1 };
    let study = case::study(&source, &[], &request).unwrap_or_else(|error| panic!("{error}"));
    let steps =
        |level: &StudyLevel| level.problem.timeline.phases().map(|phase| phase.steps.nominal()).collect::<Vec<_>>();
    assert_eq!(study.levels.iter().map(steps).collect::<Vec<_>>(), [[4, 100], [8, 200]]);
    let table = study.run(&StudySettings::default()).unwrap_or_else(|error| panic!("{error}"));
    let order = table.rows[1].order.expect("an order");
    assert!((order - 1.1).abs() < 0.2, "{order}");
    let odd = StudyRequest { levels: vec![27], ..request };
    let told = case::study(&source, &[], &odd).map(|_| ()).expect_err("27 steps of two phases").to_string();
    let expected =
        "level 27 of phases of which one has 4 of 104 steps, expected 4 · (level / 104) to be a whole number of steps";
    assert_eq!(told, expected);
}
