//! The examples run, and their numbers are those of closed forms.
#![allow(dead_code, reason = "an example is a program of its own")]

#[path = "../../examples/body.rs"]
mod body;
#[path = "../../examples/contact_law.rs"]
mod contact_law;
#[path = "../../examples/coupled.rs"]
mod coupled;
#[path = "../../examples/scheme.rs"]
mod scheme;
#[path = "../../examples/sink.rs"]
mod sink;

fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance * expected.abs(), "{found:e}, expected {expected:e}");
}

#[test]
fn the_examples_run() {
    let examples = [
        ("body", body::main as fn() -> _),
        ("contact_law", contact_law::main),
        ("coupled", coupled::main),
        ("scheme", scheme::main),
        ("sink", sink::main),
    ];
    for (name, main) in examples {
        let done: Result<(), Box<dyn std::error::Error>> = main();
        done.unwrap_or_else(|error| panic!("{name}: {error}"));
    }
}

/// All of the side slips: τ_max tanh(μp/τ_max) times its length, for p = 1e10 Pa/m · 1e-4 m.
#[test]
fn a_law_of_one_s_own_bounds_friction() {
    for [coefficient, strength] in [[0.5, 3e5], [0.2, 1e5], [0.1, 1e9]] {
        let force = contact_law::friction_force(contact_law::Saturating { coefficient, strength }).expect("a run");
        let bound = strength * (coefficient * 1e6 / strength).tanh();
        near(force.abs(), 0.2 * bound, 1e-10);
    }
}

/// In series: a rod E/L and a layer c, for the displacement 1e-4; a rod K/L and a conductance h, for 100 K.
#[test]
fn a_body_from_rust_has_the_forces_and_fluxes_in_series() {
    let [pressure, flux] = body::pressed_rod().expect("a run");
    near(pressure, 1e-4 / (0.1 / 7e10 + 1e-12), 1e-8);
    near(flux, 100.0 / (0.1 / 150.0 + 1.0 / 5e3), 1e-10);
}

/// In series: a rod of 1e6 Pa/m and a layer of 4e6 Pa/m, for 1 mm per second.
#[test]
fn a_sink_of_one_s_own_sees_every_step() {
    let forces = sink::forces().expect("a run").0;
    assert_eq!(forces.len(), 5);
    for ([t, force], n) in forces.into_iter().zip(1..) {
        near(t, f64::from(n) / 5.0, 1e-14);
        near(force, 1e-3 * t / (1e-6 + 0.25e-6), 1e-10);
    }
}

/// Four short steps per step: every fourth state of backward Euler with all of them, to the last bit. The rod meets the
/// foundation at once and is thrown back.
#[test]
fn a_scheme_of_one_s_own_makes_the_steps_of_a_run() {
    let coarse = scheme::states(10, scheme::Substeps::make).expect("a run");
    let fine = scheme::states(40, amontons::step::March::make).expect("a run");
    assert_eq!((coarse.len(), fine.len()), (11, 41));
    for (coarse, fine) in coarse.iter().zip(fine.iter().step_by(4)) {
        assert_eq!((&coarse.w, &coarse.u), (&fine.w, &fine.u), "t = {}", fine.t);
    }
    let thrown = |states: &[amontons::state::State]| states.last().and_then(|s| s.w.last().copied()).expect("a state");
    assert!(thrown(&coarse) < 0.0, "{}", thrown(&coarse));
}

/// Two bars that exchange force and displacement move as the bar made of both, whose interface is node 8.
#[test]
fn two_coupled_runs_are_the_run_of_the_whole() {
    let (halves, whole) = (coupled::halves().expect("a run"), coupled::whole().expect("a run"));
    assert_eq!((halves.len(), whole.len()), (20, 20));
    for ([left, right], whole) in halves.iter().zip(&whole) {
        let size = whole.iter().fold(0.0f64, |most, u| most.max(u.abs()));
        assert!(size > 1e-6, "nothing moves");
        for (found, expected) in left.iter().chain(&right[1..]).zip(whole) {
            assert!((found - expected).abs() <= 1e-9 * size, "{found:e}, expected {expected:e}");
        }
    }
}
