//! Steps that follow from an accuracy: what they promise against runs in very short equal steps.

use amontons::case::{self, Source};
use amontons::discretization::Discretization;
use amontons::output::Memory;
use amontons::problem::Problem;
use amontons::run::{self, Settings, Stepping};
use amontons::state::State;
use amontons::time::{MadeSteps, TimePhase, Timeline};

use crate::common::{changed, paper};

/// A run without a certificate, with all states.
fn run(problem: &Problem) -> Memory {
    let mut memory = Memory::new().states_every(1);
    run::run(problem, &Settings { certificate: false, ..Settings::default() }, &mut [&mut memory]).expect("a run");
    memory
}

fn read(text: &str) -> Problem {
    case::parse(&Source::new("case.toml", text), &[]).unwrap_or_else(|error| panic!("{error}")).problem
}

/// Norms of the root of twice the energy, of u and of θ.
fn norms(d: &Discretization, u: &[f64], w: &[f64], theta: &[f64]) -> [f64; 3] {
    let (rho, inertia) = d.inertia();
    let energy = (rho.sqrt() * d.norm(inertia, w)).hypot(d.norm(&d.elastic_form(), u));
    [energy, d.norm(&d.mass, u), d.norm(&d.mass, theta)]
}

/// The largest errors of states against a run in equal steps, relative to the largest norms of that run. Between its
/// times the run is linear.
fn errors(problem: &Problem, states: &[State], fine: &[State]) -> [f64; 3] {
    let d = Discretization::new(problem);
    let minus = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f64>>();
    let size = fine
        .iter()
        .map(|s| norms(&d, &s.u, &s.w, &s.theta))
        .fold([0.0f64; 3], |a, b| std::array::from_fn(|i| a[i].max(b[i])));
    let mut worst = [0.0f64; 3];
    for state in states {
        let high = fine.partition_point(|s| s.t < state.t).min(fine.len() - 1);
        let (a, b) = (&fine[high.saturating_sub(1)], &fine[high]);
        let share = if b.t > a.t { (state.t - a.t) / (b.t - a.t) } else { 1.0 };
        let mix = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + share * (b - a)).collect::<Vec<f64>>();
        let of = norms(
            &d,
            &minus(&state.u, &mix(&a.u, &b.u)),
            &minus(&state.w, &mix(&a.w, &b.w)),
            &minus(&state.theta, &mix(&a.theta, &b.theta)),
        );
        worst = std::array::from_fn(|i| worst[i].max(if size[i] > 0.0 { of[i] / size[i] } else { 0.0 }));
    }
    worst
}

fn worst(errors: [f64; 3]) -> f64 {
    errors.into_iter().fold(0.0, f64::max)
}

fn with(problem: &Problem, timeline: Timeline) -> Problem {
    changed(problem, |data| data.timeline = timeline)
}

/// The errors of automatic steps over their accuracy, with the number of steps.
fn kept(problem: &Problem, accuracy: f64, fine: &[State]) -> (f64, usize) {
    let end = problem.timeline.end();
    let made = run(&with(problem, Timeline::automatic(end, accuracy)));
    let last = made.states.last().expect("a state");
    assert_eq!(last.t.to_bits(), end.to_bits());
    assert!(last.pace.chosen.error <= 1.5 * accuracy, "the budget is kept: {}", last.pace.chosen.error / accuracy);
    assert_eq!(last.pace.chosen.made, last.step);
    (worst(errors(problem, &made.states, fine)) / accuracy, last.step)
}

/// Equal steps on each of many phases, each twice as long as the one before: for what is fast at first.
fn graded(problem: &Problem, steps: usize) -> Memory {
    let ends = (0..20).map(|j| problem.timeline.end() / f64::from(1 << (19 - j)));
    run(&with(problem, Timeline::in_phases(ends.map(|t| TimePhase::dynamic("p", t, steps)).collect())))
}

/// The true error over the accuracy, between its half of a half and twice: equal lengths are only halved, so that an
/// error of first order may be half of what it could be, and one of second order a quarter.
#[test]
fn errors_are_as_large_as_asked_for() {
    for (name, problem) in problems() {
        let fine = match name {
            "heat" => graded(&problem, 200),
            _ => run(&with(&problem, Timeline::equal(problem.timeline.end(), 1 << 12))),
        };
        for accuracy in [1e-1, 1e-2] {
            let (error, steps) = kept(&problem, accuracy, &fine.states);
            println!("{name}: {error:.3} of {accuracy} in {steps} steps");
            assert!(error < 2.0 && error > 0.1, "{name}: {error} of {accuracy} in {steps} steps");
        }
    }
}

/// Points that stop and go, and what meets the foundation, err in proportion to the step: neither may drive it to zero.
/// The same for a side whose velocity jumps at t = 0, which changes its sign in each step of the midpoint rule.
#[test]
fn transitions_do_not_drive_the_step_to_zero() {
    for problem in [read(SLIP), read(PUSHED)] {
        let made = run(&with(&problem, Timeline::automatic(problem.timeline.end(), 1e-2)));
        let last = made.states.last().expect("a state");
        assert!(last.step < 400, "{}: {} steps", problem.name, last.step);
        assert!(last.pace.chosen.shortest > 1e-6 * problem.timeline.end(), "{:?}", last.pace.chosen);
    }
}

/// At the same error, for all schemes: a rod heated by a jump, a press before a long cooling, a rod that meets a layer,
/// a block that sticks and slips, and the square of the paper, which is warmed by a jump.
#[test]
fn equal_steps_with_that_error_are_thrice_as_many() {
    let square =
        |keys: &[&str]| paper(&[&["mesh.n=4", "contact.heat.foundation_temperature=10"], keys].concat()).problem;
    let all = [
        ("heat", read(HEAT), 1e-2),
        ("press", read(PRESS), 1e-1),
        ("impact", read(IMPACT), 1e-2),
        ("slip", read(SLIP), 1e-2),
        ("backward Euler", square(&[]), 1e-2),
        ("BDF2", square(&["time.scheme=bdf2"]), 1e-2),
        ("ϑ = ½", square(&["time.scheme=theta", "scheme.coupling=extrapolated"]), 1e-2),
    ];
    for (name, problem, accuracy) in all {
        let fine = match name {
            "heat" | "press" => graded(&problem, 200),
            _ => run(&with(&problem, Timeline::equal(problem.timeline.end(), 1 << 13))),
        };
        let (error, steps) = kept(&problem, accuracy, &fine.states);
        let equal = run(&with(&problem, Timeline::equal(problem.timeline.end(), 3 * steps)));
        let of_equal = worst(errors(&problem, &equal.states, &fine.states)) / accuracy;
        println!("{name}: {error:.3} in {steps} steps, {of_equal:.3} in {} equal steps", 3 * steps);
        assert!(error < 2.0 && of_equal > error, "{name}: {error} in {steps} steps, {of_equal} in thrice as many");
    }
}

/// A chosen step depends on its state alone, whatever was tried before it and on however many threads.
#[test]
fn chosen_steps_have_the_same_bits_after_a_resume_and_on_two_threads() {
    let (_, rod) = problems().remove(0);
    let square = paper(&["mesh.n=4", "contact.heat.foundation_temperature=10"]).problem;
    let all = vec![
        TimePhase::quasistatic("press", 0.25, 1).automatic(0.05),
        TimePhase::dynamic("slide", 0.5, 6),
        TimePhase::dynamic("hold", 1.0, 1).automatic(0.1),
    ];
    let sprung = read(&format!("{}{SPRING}", IMPACT.replace("end = 1.0\nsteps = 10\n", "")));
    for problem in [with(&rod, Timeline::automatic(1.0, 0.02)), with(&square, Timeline::in_phases(all)), sprung] {
        let settings = |threads| Settings { threads: Some(threads), certificate: false, ..Settings::default() };
        let mut run = Stepping::new(&problem, &settings(1)).expect("a run");
        let mut saved = Vec::new();
        while !run.is_done() {
            saved.push(run.save());
            run.step().expect("a step");
        }
        let last = run.state().clone();
        let ends: Vec<usize> = last.pace.ends.clone();
        assert_eq!(ends.len(), problem.timeline.phases().len());
        assert!(last.pace.chosen.rejected > 0);
        for from in [1, saved.len() / 3, saved.len() / 2, saved.len() - 2].into_iter().chain(ends) {
            let Some(from) = saved.get(from) else { continue };
            let mut again = Stepping::resume(&problem, from.clone(), &settings(2)).expect("a run");
            while !again.is_done() {
                again.step().expect("a step");
            }
            assert!(*again.state() == last, "{}: taken up after {}", problem.name, from.state.step);
        }
    }
}

/// The steps of a run are an ordinary timeline, with the ends of its steps to the bit.
#[test]
fn steps_that_were_chosen_give_the_same_states_when_they_are_made_again() {
    let square = paper(&["mesh.n=4", "contact.heat.foundation_temperature=10", "time.scheme=bdf2"]).problem;
    let all = vec![
        TimePhase::quasistatic("press", 0.25, 1).automatic(0.05),
        TimePhase::dynamic("slide", 0.5, 6),
        TimePhase::dynamic("hold", 1.0, 1).automatic(0.1),
    ];
    for problem in [with(&read(SLIP), Timeline::automatic(1.0, 0.02)), with(&square, Timeline::in_phases(all))] {
        let chosen = run(&problem).states;
        let mut steps = MadeSteps::default();
        chosen.windows(2).for_each(|pair| steps.note(&pair[0].pace, &pair[1].pace));
        let again = run(&with(&problem, problem.timeline.with_made(&steps))).states;
        let mut apart = 0.0_f64;
        for state in &chosen {
            let same = again.iter().find(|other| other.t.to_bits() == state.t.to_bits()).expect("the same time");
            let [mine, others] = [state, same].map(|state| [&state.u, &state.w, &state.theta]);
            for (mine, others) in mine.into_iter().zip(others) {
                let size = mine.iter().fold(f64::MIN_POSITIVE, |most: f64, value| most.max(value.abs()));
                let most = mine.iter().zip(others).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
                apart = apart.max(most / size);
            }
        }
        println!("{} steps, made again in {}: {apart:e}", chosen.len() - 1, again.len() - 1);
        assert!(again.len() > chosen.len() && apart <= 1e-9, "{apart:e}");
    }
}

fn problems() -> Vec<(&'static str, Problem)> {
    let paper = paper(&["mesh.n=4", "contact.heat.foundation_temperature=10"]).problem;
    vec![("heat", read(HEAT)), ("block", read(BLOCK)), ("paper", paper), ("impact", read(IMPACT))]
}

/// A rod whose end is heated by a jump.
const HEAT: &str = r#"
name = "rod"
units = "dimensionless"
[mesh]
kind = "interval"
size = 1.0
n = 32
[time]
end = 1.0
steps = 10
[material]
heat_capacity = 1.0
conductivity = 1.0
[[boundary]]
on = "left"
temperature = 1.0
[[boundary]]
on = "right"
temperature = 0.0
"#;

/// A block that swings.
const BLOCK: &str = r#"
name = "block"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [1.0, 1.0]
n = [4, 4]
[time]
end = 4.0
steps = 10
scheme = "theta"
[material]
density = 1.0
elasticity = { law = "isotropic", young = 10.0, poisson = 0.3, stress_state = "plane-strain" }
[initial]
velocity = ["y", 0]
[[boundary]]
on = "bottom"
displacement = [0, 0]
"#;

/// A rod that meets a layer.
const IMPACT: &str = r#"
name = "impact"
units = "dimensionless"
[mesh]
kind = "interval"
size = 1.0
n = 16
[time]
end = 1.0
steps = 10
scheme = "theta"
[material]
density = 1.0
elasticity = { law = "isotropic", young = 100.0, poisson = 0.0 }
viscosity = { law = "lame", first = 0.0, second = 0.2 }
[initial]
velocity = ["1"]
[contact]
on = "right"
gap = 0.3
normal = { law = "compliance", stiffness = 1000.0 }
"#;

/// A spring that acts from the second phase on.
const SPRING: &str = r#"
[[boundary]]
on = "left"
spring = [50.0]
phases = ["held"]
[[phase]]
name = "free"
end = 0.5
steps = "auto"
accuracy = 0.05
[[phase]]
name = "held"
end = 1.0
steps = "auto"
accuracy = 0.02
"#;

/// A pressed block is shaken: it sticks and slips, both ways.
const SLIP: &str = r#"
name = "slip"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [2.0, 1.0]
n = [4, 2]
diagonal = "right"
[time]
end = 6.0
steps = 10
scheme = "theta"
[material]
density = 1.0
elasticity = { law = "isotropic", young = 50.0, poisson = 0.3, stress_state = "plane-strain" }
viscosity = { law = "lame", first = 0.5, second = 1.0 }
[load]
body_force = [0.0, -0.5]
[[boundary]]
on = "top"
traction = ["0.5*sin(2*t)", -1.0]
[contact]
on = "bottom"
gap = 0.0
normal = { law = "signorini" }
friction = { law = "coulomb", coefficient = 0.4 }
"#;

/// A block whose upper side begins to move at t = 0 with a velocity that it had not.
const PUSHED: &str = r#"
name = "pushed"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [1.0, 1.0]
n = [4, 4]
[time]
end = 4.0
steps = 10
scheme = "theta"
[material]
density = 1.0
elasticity = { law = "isotropic", young = 10.0, poisson = 0.3, stress_state = "plane-strain" }
[[boundary]]
on = "bottom"
displacement = [0, 0]
[[boundary]]
on = "top"
displacement = ["0.1*t", 0]
"#;

/// A rod that is pressed in a thousandth of a second, and then takes ten to cool.
const PRESS: &str = r#"
name = "press"
units = "dimensionless"
[mesh]
kind = "interval"
size = 1.0
n = 8
[time]
end = 10.0
steps = 10
inertia = false
[material]
heat_capacity = 1.0
conductivity = 0.2
elasticity = { law = "isotropic", young = 1.0, poisson = 0.0 }
viscosity = { law = "lame", first = 0.0, second = 0.0001 }
expansion = 0.1
[initial]
temperature = 1.0
[[boundary]]
on = "left"
displacement = [0]
temperature = 0.0
[[boundary]]
on = "right"
traction = ["-if(t > 0.001, 1, 1000*t)"]
"#;
