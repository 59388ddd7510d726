//! BDF2: the states of a case by an independent program, orders, identities, and restarts.

use amontons::case;
use amontons::output::Memory;
use amontons::state::State;

use crate::common::{self, solve};
use crate::theta::run_as_expected;

/// Asserts that both identities close to round-off at the end of each step.
fn closes(name: &str, memory: &Memory) {
    for State { step, ledger, .. } in &memory.states {
        let [energy, heat] = [ledger.closing_error.abs(), ledger.heat_closing_error.abs()];
        assert!(energy <= 1e-12 * ledger.turned_over, "{name}, step {step}: energy closes to {energy:e}");
        assert!(heat <= 1e-12 * ledger.heat_turned_over.max(1.0), "{name}, step {step}: heat closes to {heat:e}");
    }
}

fn run(file: &str, overrides: &[String]) -> Memory {
    let problem = case::read(&common::file(file), overrides).unwrap_or_else(|error| panic!("{error}")).problem;
    solve(&problem)
}

fn words(all: &[&str]) -> Vec<String> {
    all.iter().map(|word| (*word).to_owned()).collect()
}

#[test]
fn states_agree_with_an_independent_program() {
    let (memory, expected) = run_as_expected("bdf2-closed", 1e-9);
    closes("bdf2-closed", &memory);
    let state = memory.states.last().expect("a state");
    for (key, found) in [
        ("kinetic", state.ledger.kinetic),
        ("elastic", state.ledger.elastic),
        ("contact_energy", state.ledger.contact_energy),
    ] {
        let expected = expected["energy"][key].as_f64().expect("a number");
        assert!((found - expected).abs() <= 1e-9 * state.ledger.turned_over, "{key}: {found:e}, expected {expected:e}");
    }
}

/// The largest differences of u and θ at the end.
fn apart(a: &State, b: &State) -> [f64; 2] {
    let of = |a: &[f64], b: &[f64]| a.iter().zip(b).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
    [of(&a.u, &b.u), of(&a.theta, &b.theta)]
}

/// A block pressed on a belt that rubs and warms it, with a branch that relaxes: order 2 with all couplings but the
/// staggered one, and the sum of what the scheme took falls with the square of the step.
#[test]
fn orders_of_the_couplings() {
    let file = "crates/amontons/tests/reference/time/bdf2-closed.toml";
    let end = |steps: usize, coupling: &str| {
        let keys = words(&[
            "contact.gap=0",
            "contact.normal.stiffness=200",
            "contact.foundation_velocity=[0.5, 0]",
            "contact.heat.exponent=1",
            "contact.heat.foundation_temperature=\"t^2\"",
            "initial.temperature=0",
            "boundary[0].temperature=0",
            "boundary[0].displacement=[0, \"-0.02*t^2\"]",
            "material.elasticity={ law = \"isotropic\", young = 60.0, poisson = 0.3, stress_state = \"plane-strain\" }",
            "material.prony=[{ ratio = 0.4, time = 0.3 }]",
        ]);
        let own = words(&[&format!("time.steps={steps}"), &format!("scheme.coupling={coupling}")]);
        let mut memory = run(file, &[keys, own].concat());
        closes(coupling, &memory);
        memory.states.pop().expect("a state")
    };
    let exact = end(2560, "monolithic");
    for (coupling, order) in [("monolithic", 2.0), ("extrapolated", 2.0), ("staggered", 1.0)] {
        let states = [80, 320].map(|steps| end(steps, coupling));
        let errors = [0, 1].map(|i| apart(&states[i], &exact));
        for i in [0, 1] {
            let found = (errors[0][i] / errors[1][i]).log2() / 2.0;
            assert!((found - order).abs() < 0.2, "{coupling}: order {found} of {}", ["u", "θ"][i]);
        }
        let taken = states.map(|state| (state.ledger.scheme_dissipation / state.ledger.turned_over).abs());
        assert!(taken[0] < 1e-3 && taken[1] < 0.1 * taken[0], "{coupling}: the scheme took {taken:?}");
    }
}
