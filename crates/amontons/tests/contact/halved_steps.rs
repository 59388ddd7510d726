//! Steps that have no solution as a whole are made in halves: what is found, what is said where halves fail too, and
//! the same bits however the run is made.

use super::softening::{near, rod, run, scheme};
use crate::common::{changed, interrupts, paper};
use amontons::contact::{NormalLaw, Pressure};
use amontons::equation::StepError;
use amontons::output::Memory;
use amontons::problem::Problem;
use amontons::run::{self as driver, Settings};
use amontons::step::Scheme;
use amontons::tensor::Point;

/// p = 0 up to r = a and P beyond it, without the values between: a step that would end in them has no solution.
#[derive(Debug)]
struct Stair {
    at: f64,
    height: f64,
}
impl NormalLaw for Stair {
    fn pressure(&self, _x: &Point, z: f64, _rate: f64, _lambda: f64) -> Pressure {
        Pressure { value: if z > self.at { self.height } else { 0.0 }, ..Pressure::default() }
    }
    fn potential(&self, _x: &Point, r: f64) -> f64 {
        self.height * (r - self.at).max(0.0)
    }
    fn lipschitz(&self) -> Option<f64> {
        None
    }
}

/// The same stair as a law that falls, if only by nothing: its pressure is taken as the function that it is, which has
/// no value on the riser.
#[derive(Debug)]
struct Broken(Stair);

impl NormalLaw for Broken {
    fn pressure(&self, x: &Point, z: f64, rate: f64, lambda: f64) -> Pressure {
        self.0.pressure(x, z, rate, lambda)
    }
    fn potential(&self, x: &Point, r: f64) -> f64 {
        self.0.potential(x, r)
    }
    fn lipschitz(&self) -> Option<f64> {
        None
    }
    fn least_slope(&self, _x: &Point, _from: f64, _to: f64) -> f64 {
        -f64::MIN_POSITIVE
    }
}

pub fn stair(overrides: &[&str], at: f64, height: f64) -> Problem {
    let problem = rod(&[&["boundary[0].displacement=[0]"], overrides].concat());
    changed(&problem, |data| data.contacts[0].normal = Broken(Stair { at, height }).into())
}

/// With k = 1, E = 1, η = 1 and the force 1: (η + kE) w = 1 − p − E u′. In one step r = 0.5 without the pressure and
/// 0.4 with it, beyond and before the stair at 0.45: no solution. In two halves r = 1/3, and then
/// (1/3 + (1 − 0.2)/2)·2/3 = 22/45 = 0.489 with the pressure.
#[test]
fn a_step_without_a_solution_is_made_in_halves() {
    let problem = stair(&["time.steps=1", "material.viscosity.second=1", "load.body_force=[2]"], 0.45, 0.2);
    let (states, reports) = run(&problem);
    assert_eq!(reports[0].parts, 2);
    assert_eq!(states[1].counts.halved_steps, 1);
    // r₂ (η + kE/2) = η r₁ + (k/2)(1 − p).
    near(reports[0].contact.states[0].penetration, (1.0 / 3.0 + 0.5 * 0.8) / 1.5, 1e-12, "r");
    assert!(states[1].ledger.relative_closing_error().abs() < 1e-12);
}

/// E r = t − p with a stair that rises: for 0.43 < t ≤ 0.63 the solution is on the riser, r = 0.43 and p = t − 0.43.
#[test]
fn a_law_that_rises_in_a_stair_has_a_solution_on_its_riser() {
    let broken = stair(&["time.steps=10", "load.body_force=['2*t']"], 0.43, 0.2);
    let problem = changed(&broken, |data| data.contacts[0].normal = Stair { at: 0.43, height: 0.2 }.into());
    let (states, reports) = run(&problem);
    for (n, report) in (1..).zip(&reports) {
        let t = 0.1 * f64::from(n);
        let [r, p] = if t < 0.43 {
            [t, 0.0]
        } else if t <= 0.63 {
            [0.43, t - 0.43]
        } else {
            [t - 0.2, 0.2]
        };
        near(report.contact.states[0].penetration, r, 1e-12, "r");
        near(report.contact.states[0].pressure, p, 1e-12, "p");
    }
    assert_eq!(states.last().unwrap().counts.halved_steps, 0);
}

/// E r = t − p has no solution for 0.43 < t ≤ 0.63: step 5 of 0.1 fails, first in its tenth part of 0.1/32.
#[test]
fn a_step_that_fails_in_halves_too_names_its_first_failure() {
    let problem = stair(&["time.steps=10", "load.body_force=['2*t']"], 0.43, 0.2);
    let (mut scheme, mut state) = scheme(&problem);
    for _ in 0..4 {
        state = scheme.step(&state).unwrap().0;
    }
    let error = scheme.step(&state).unwrap_err();
    let StepError::NotConverged { step: 5, t, part: "mechanics", .. } = error else { panic!("{error}") };
    near(t, 0.4 + 10.0 * 0.1 / 32.0, 1e-12, "the time of the first failure");
    assert!(error.to_string().contains("step 5 (t = 4.3125"), "{error}");
    assert!(error.to_string().contains("not even in a part of 1/32 of the step"), "{error}");
    // The point at the end of the rod is the only one.
    let told = error.to_string();
    let named = "; 1 contact point does not settle: (1, 0, 0) on \"right\" (Broken, Frictionless): ";
    assert!(told.contains(named) && told.ends_with("open"), "{told}");
}

/// What a run with halved steps finds does not depend on where it was taken up again, nor on the number of threads.
#[test]
fn halved_steps_have_the_same_bits_after_a_resume_and_on_two_threads() {
    let rod = rod(&["time.end=2"]);
    let body = paper(&[
        "mesh.n=8",
        "time.steps=16",
        "contact.normal={law='softening', stiffness=1e4, peak=1, softening=5e3, residual=0.5}",
    ])
    .problem;
    for problem in [rod, body] {
        let (states, reports) = run(&problem);
        let halved = reports.iter().position(|r| r.parts > 1).expect("a halved step");
        println!(
            "{}: {} of {} steps halved, {} ambiguous",
            problem.name,
            states.last().unwrap().counts.halved_steps,
            problem.timeline.steps(),
            states.last().unwrap().counts.ambiguous_steps
        );
        for from in [halved.saturating_sub(1), halved, halved + 1] {
            let (mut scheme, _) = scheme(&problem);
            let mut state = states[from].clone();
            for expected in &states[from + 1..] {
                state = scheme.step(&state).expect("a step").0;
                assert!(state == *expected, "{}: taken up after {from}, step {} is another", problem.name, state.step);
            }
        }
        for threads in [1, 2] {
            let mut memory = Memory::new().states_every(1);
            driver::run(&problem, &Settings { threads: Some(threads), ..Settings::default() }, &mut [&mut memory])
                .unwrap_or_else(|error| panic!("{error}"));
            assert!(memory.states.last() == states.last(), "{}: another result on {threads} threads", problem.name);
        }
    }
}

/// A step that is interrupted while it is made in halves is not made: as it was first tried it would be another.
#[test]
fn a_step_that_is_interrupted_in_halves_is_not_made() {
    let law = "contact.normal={law='softening', stiffness=1e4, peak=1, softening=5e3, residual=0.5}";
    let problem = paper(&["mesh.n=8", "time.steps=16", law]).problem;
    let (states, reports) = run(&problem);
    let halved = reports.iter().position(|report| report.parts > 1).expect("a halved step");
    let made_with = |left: usize| scheme(&interrupts::interrupted(&problem, left)).0.step(&states[halved]);
    let mut interrupted = 0;
    // As many evaluations as the whole step takes, and more.
    for left in (1..).step_by(37) {
        match made_with(left) {
            Err(error) => {
                assert!(error.is_interruption(), "{error}");
                interrupted += 1;
            }
            Ok((state, _)) => assert!(state == states[halved + 1], "interrupted at evaluation {left}: another state"),
        }
        if left > 8_000 {
            break;
        }
    }
    assert!(interrupted > 10, "{interrupted} interruptions");
}
