//! λ_min(S, W) of `step-unique` against formulas: a rod with its inertia, and a block on springs.

use amontons::case::{self, Source};

use crate::common::paper;
use crate::step_solutions::find;

/// A rod of 1000 cells that is held at one end and touches at the other: S is one number, found here by eliminating the
/// nodes one by one. In a body without inertia it is (E + b/k) k/L; what is taken off the diagonal of K_u to prove that
/// it is positive definite would change this by 6e-7, and must not be seen.
#[test]
fn the_eigenvalue_of_a_rod_is_its_stiffness() {
    let (n, length, k, young) = (1000, 2.0, 0.25, 3.0);
    for (density, viscosity) in [(0.0, 0.0), (0.0, 0.2), (0.7, 0.2)] {
        let text = format!(
            "name = 'rod'
            mesh = {{ kind = 'interval', size = {length:?}, n = {n} }}
            time = {{ end = 1.0, steps = 4 }}
            contact = {{ on = 'right', gap = 0.1, normal = {{ law = 'compliance', stiffness = 10 }} }}
            boundary = [{{ on = 'left', displacement = [0] }}]
            [material]
            density = {density:?}
            elasticity = {{ law = 'isotropic', young = {young:?}, poisson = 0.0 }}
            viscosity = {{ law = 'lame', first = 0.0, second = {viscosity:?} }}"
        );
        let problem =
            case::parse(&Source::new("rod.toml", text), &[]).unwrap_or_else(|error| panic!("{error}")).problem;
        let h = length / f64::from(n);
        let (spring, mass) = ((viscosity + k * young) / h, density * h / k);
        let (diagonal, beside) = (2.0 * (spring + mass / 3.0), -spring + mass / 6.0);
        let inner = (1..n - 1).fold(diagonal, |pivot, _| diagonal - beside * beside / pivot);
        let expected = 0.5 * diagonal - beside * beside / inner;
        let found = find(&problem, "step-unique").value.expect("a value");
        assert!((found - expected).abs() < 1e-8 * expected, "density {density}: {found:e}, expected {expected:e}");
        if density == 0.0 {
            assert!((found - (viscosity + k * young) / length).abs() < 1e-11 * found, "{found:e}");
        }
    }
}

/// Springs of 1e-3 hold a block of 1e6: a translation bounds λ_min by k times the spring, whatever the number of steps.
#[test]
fn weak_springs_make_no_step_unique() {
    for (spring, steps, friction) in
        [(1e-3, 16, 0.2), (1e-3, 32, 0.2), (1e-3, 33, 0.2), (1e-3, 128, 0.2), (1e-3, 256, 0.2), (1e6, 16, 0.2)]
    {
        let problem = paper(&[
            "mesh.n=8",
            &format!("time.steps={steps}"),
            "material.density=0",
            "material.expansion=0",
            "material.coupling=0",
            "material.elasticity.young=1e6",
            "material.viscosity={law='lame', first=0, second=1e-3}",
            "contact.normal.stiffness=1e3",
            &format!("contact.friction.coefficient={friction}"),
            &format!("boundary=[{{on='top', spring=[{spring:?}, {spring:?}], temperature=0}}]"),
        ])
        .problem;
        let unique = find(&problem, "step-unique");
        if spring < 1.0 {
            assert!(
                !unique.holds() && unique.value.is_none_or(|v| v <= 1.000_001 * spring * problem.timeline.longest()),
                "{steps} steps: {unique:?}"
            );
        } else {
            // λ_min(S, W) = 2995 by an independent program of P1 elements.
            assert!(unique.holds() && (unique.value.expect("a value") / 2995.0 - 1.0).abs() < 1e-3, "{unique:?}");
        }
    }
}
