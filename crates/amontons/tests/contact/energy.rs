//! The terms of the energy audit against their closed forms for linear compliance.

use crate::common::paper;
use amontons::linalg::dot;
use amontons::step::{March, Scheme};

/// Ψ = ½ c_ν Σ ω r₊² and ψₙ = c_ν Σ ω (½(r₊ⁿ − r₊ⁿ⁻¹)² + r₊ⁿ r₋ⁿ⁻¹), the part of the contact that the scheme
/// dissipates.
#[test]
fn compliance_energy_and_scheme_dissipation_have_their_closed_forms() {
    let c_nu = 1e4;
    for foundation in ["0", "10"] {
        let problem =
            paper(&["mesh.n=16", "time.steps=32", &format!("contact.heat.foundation_temperature={foundation}")])
                .problem;
        let mut scheme = March::new(&problem).expect("a regular system");
        let mut state = scheme.initial().expect("finite initial data");
        let weights: Vec<f64> = scheme.discretization().boundary.points.iter().map(|p| p.weight).collect();
        let mut before = vec![0.0f64; weights.len()];
        let (mut opened, mut largest) = (0, 0.0f64);
        for _ in 0..problem.timeline.steps() {
            let (next, report) = scheme.step(&state).expect("a step");
            let r: Vec<f64> = report.contact.states.iter().map(|s| s.penetration).collect();
            let (mut potential, mut psi) = (0.0, 0.0);
            for ((w, now), old) in weights.iter().zip(&r).zip(&before) {
                let (p, q, gap) = (now.max(0.0), old.max(0.0), (-old).max(0.0));
                potential += 0.5 * c_nu * w * p * p;
                psi += c_nu * w * (0.5 * (p - q).powi(2) + p * gap);
                opened += usize::from(*now <= 0.0 && *old > 0.0);
            }
            let difference = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a - b).collect() };
            let (dw, du) = (difference(&next.w, &state.w), difference(&next.u, &state.u));
            let discrete = scheme.discretization();
            let expected = 0.5 * dot(&dw, &discrete.mass.apply(&dw)) + 0.5 * dot(&du, &discrete.a.apply(&du)) + psi;
            let found = next.ledger.scheme_dissipation - state.ledger.scheme_dissipation;
            assert!(
                (found - expected).abs() <= 1e-12 * next.ledger.turned_over,
                "step {}: {found:e}, expected {expected:e}",
                next.step
            );
            assert!((next.ledger.contact_energy - potential).abs() <= 1e-13 * next.ledger.turned_over);
            largest = largest.max(psi / expected);
            (before, state) = (r, next);
        }
        // The test would see a ψ that is left out: points open and close, and ψ is no small part of some step.
        assert!(opened > 0 && largest > 1e-3, "{opened} {largest:e}");
    }
}

/// Wear under a damped layer is counted once: what the scheme dissipates is not negative and vanishes with the step.
#[test]
fn wear_under_a_damped_layer_is_counted_once() {
    let mut last = f64::INFINITY;
    for steps in [16, 64, 256] {
        let problem = paper(&[
            "mesh.n=4",
            &format!("time.steps={steps}"),
            "material.expansion=0",
            "material.coupling=0",
            "material.viscosity={law='lame', first=1, second=1}",
            "load.body_force=[0, '-20*t']",
            "load.heat_source=0",
            "boundary=[{on='top', displacement=[0, 0], temperature=0}, {on='left', temperature=0}, {on='right', temperature=0}]",
            "contact={on='bottom', gap=0, normal={law='damped', stiffness=10, damping=50}, friction={law='coulomb', coefficient=0.2}, foundation_velocity=[5, 0], wear={law='archard', coefficient=0.02}, heat={law='none'}}",
        ])
        .problem;
        let mut scheme = March::new(&problem).expect("a regular system");
        let mut state = scheme.initial().expect("finite initial data");
        for _ in 0..steps {
            let next = scheme.step(&state).expect("a step").0;
            assert!(next.ledger.scheme_dissipation >= state.ledger.scheme_dissipation - 1e-14, "step {}", next.step);
            state = next;
        }
        let found = state.ledger.scheme_dissipation;
        // First order in the step: four times as many steps leave a fourth.
        assert!(last.is_infinite() || (last / found - 4.0).abs() < 0.3, "{steps} steps: {found} after {last}");
        assert!(state.ledger.relative_closing_error().abs() < 1e-12);
        last = found;
    }
}
