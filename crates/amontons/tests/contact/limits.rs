//! Rigid foundations and perfect thermal contact are the limits of stiff and of conducting ones, up to any number.

use crate::common::{largest, paper};
use amontons::state::State;
use amontons::step::{March, Scheme};

/// The last state of the paper's example on a coarse mesh, with identities that close.
fn end(overrides: &[&str]) -> State {
    let problem = paper(&[&["mesh.n=8", "time.steps=8"], overrides].concat()).problem;
    let mut scheme = March::new(&problem).expect("a regular system");
    let mut state = scheme.initial().expect("finite initial data");
    for _ in 0..problem.timeline.steps() {
        state = scheme.step(&state).unwrap_or_else(|error| panic!("{overrides:?}: {error}")).0;
    }
    for error in [state.ledger.relative_closing_error(), state.ledger.relative_heat_closing_error()] {
        assert!(error.abs() < 1e-12, "{overrides:?}: {error:e}");
    }
    state
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    largest(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>())
}

/// Errors of the order of 1/c in c of 1e6, 1e7, 1e8, and from 1e14 on none beyond that of steps that are accepted at
/// 1e-12 of their largest term.
fn assert_limit(error: impl Fn(f64) -> f64, scale: f64) {
    let errors = [1e6, 1e7, 1e8].map(&error);
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log10();
        assert!((order - 1.0).abs() < 0.02, "order {order}, errors {errors:?}");
    }
    for c in [1e14, 1e16, 1e18] {
        assert!(error(c) < 1e-10 * scale, "c = {c:e}: {:e} of {scale:e}", error(c));
    }
}

/// ‖u_c − u‖ is of first order in 1/c_ν.
#[test]
fn signorini_is_the_limit_of_compliance() {
    let limit = end(&["contact.normal={law='signorini'}"]);
    let at = |c: f64| end(&[&format!("contact.normal={{law='compliance', stiffness={c:?}}}")]);
    assert_limit(|c| distance(&at(c).u, &limit.u), largest(&limit.u));
}

/// ‖θ_k − θ‖ is of first order in 1/k̄, θ that of a body whose closed points have the temperature of the foundation; it
/// is taken from k̄ = 1e15.
#[test]
fn equal_temperatures_are_the_limit_of_conductances() {
    let heat =
        |k: f64| format!("contact.heat={{law='ramp', conductance={k:?}, width=1e-9, foundation_temperature=10}}");
    let at = |k: f64| end(&[&heat(k)]);
    let limit = at(1e15);
    assert_limit(|k| distance(&at(k).theta, &limit.theta), largest(&limit.theta));
    // Closed points have the temperature of the foundation, to what the flux needs.
    let open = end(&[&heat(0.0)]);
    assert!(distance(&open.theta, &limit.theta) > 1.0, "heat has come in");
}
