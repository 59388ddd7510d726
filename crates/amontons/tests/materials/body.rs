//! Bodies whose laws are not linear, and bodies whose stress relaxes.

use crate::common::{changed, checked, largest, paper, rod, solve};
use amontons::field::Law;
use amontons::material::{Carreau, Hencky, Isotropic, ShearLaw, StressState, TensorLaw, VonMisesProjection, reduced};
use amontons::state::State;

fn hencky(bulk: f64, shear: impl ShearLaw + 'static, state: StressState) -> Law<dyn TensorLaw> {
    reduced(Hencky::new(bulk, shear).expect("constants"), 2, state).into()
}

fn distance(a: &State, b: &State) -> f64 {
    let relative =
        |a: &[f64], b: &[f64]| largest(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>()) / largest(b);
    relative(&a.u, &b.u).max(relative(&a.w, &b.w)).max(relative(&a.theta, &b.theta))
}

/// A law of the nonlinear kind that happens to be linear gives what the linear law gives, contact, friction and heat
/// included.
#[test]
fn newton_over_the_body_agrees_with_the_linear_path() {
    let linear = paper(&["mesh.n=8", "time.steps=16", "contact.heat.foundation_temperature=10"]).problem;
    // 𝓔 of E = 2, ν = 0.1 in plane stress; 𝓥τ = 10 tr(τ) I + 10 τ in the plane is the plane strain of κ = 10 + 10/3,
    // 2η = 10.
    let (young, nu) = (2.0, 0.1);
    let (bulk, shear) = (young / (3.0 * (1.0 - 2.0 * nu)), young / (2.0 * (1.0 + nu)));
    let newtonian = |c: f64| Carreau::new(c, c, 1.0, 1.0).expect("constants");
    let nonlinear = changed(&linear, |data| {
        data.materials[0].elasticity = hencky(bulk, newtonian(shear), StressState::PlaneStress);
        data.materials[0].viscosity = hencky(10.0 + 10.0 / 3.0, newtonian(5.0), StressState::PlaneStrain);
    });
    assert!(!nonlinear.materials[0].elasticity.is_linear() && !nonlinear.materials[0].viscosity.is_linear());
    let (a, b) = (solve(&linear), solve(&nonlinear));
    for (a, b) in a.states.iter().zip(&b.states).skip(1) {
        assert!(distance(b, a) < 1e-9, "step {}: {:e}", a.step, distance(b, a));
        assert!(
            (a.ledger.elastic / b.ledger.elastic - 1.0).abs() < 1e-8 && b.ledger.relative_closing_error().abs() < 1e-11
        );
    }
}

/// A rod of the elastic law with a projection on the von Mises convex set, pulled beyond it: uniaxial tension by its
/// scalar equation, with s the norm of the deviator, σ = √(3/2) τ(s), ξ₁₁ = σ/(9κ) + √(2/3) s. One step without
/// viscosity finds it.
#[test]
fn a_rod_beyond_the_von_mises_convex_obeys_the_scalar_equation() {
    for excess in [3.0, -0.9] {
        let (bulk, law) = (1.7, VonMisesProjection::new(0.5, excess, 0.02).expect("constants"));
        let s = 0.05;
        let sigma = 1.5f64.sqrt() * law.secant(s) * s;
        let strain = sigma / (9.0 * bulk) + (2.0f64 / 3.0).sqrt() * s;
        let mut problem = rod(1, sigma);
        problem.materials[0].elasticity = hencky(bulk, law, StressState::PlaneStress);
        problem.materials[0].viscosity = Isotropic::lame(2, 0.0, 0.0, StressState::PlaneStress).into();
        let problem = checked(problem);
        let memory = solve(&problem);
        let last = memory.states.last().expect("a state");
        let end = problem
            .mesh
            .points
            .iter()
            .zip(last.u.chunks_exact(2))
            .filter(|(x, _)| x[0] > 1.0 - 1e-12)
            .map(|(_, u)| u[0]);
        for u in end {
            assert!((u / strain - 1.0).abs() < 1e-10, "β = {excess}: {u:e}, expected {strain:e}");
        }
        // ∫ σ dξ: the work of the load that is on at once is σ ξ₁₁, of which W is stored and the rest the scheme's.
        let ledger = &last.ledger;
        assert!((ledger.load_work / (0.25 * sigma * strain) - 1.0).abs() < 1e-10);
        let energy = 0.25 * (0.5 * bulk * (sigma / (3.0 * bulk)).powi(2) + law.potential(s));
        assert!((ledger.elastic / energy - 1.0).abs() < 1e-10, "{:e}, expected {energy:e}", ledger.elastic);
        assert!(ledger.scheme_dissipation > 0.0 && ledger.relative_closing_error().abs() < 1e-12);
    }
}

/// A rod of Carreau viscosity without elasticity creeps under a constant pull at the constant rate of the scalar
/// equation.
#[test]
fn a_rod_of_carreau_viscosity_creeps_at_its_rate() {
    let (bulk, law) = (2.3, Carreau::new(4.0, 0.3, 8.0, 0.4).expect("constants"));
    let s = 0.2;
    let sigma = 1.5f64.sqrt() * law.secant(s) * s;
    let rate = sigma / (9.0 * bulk) + (2.0f64 / 3.0).sqrt() * s;
    let mut problem = rod(4, sigma);
    problem.materials[0].elasticity = Isotropic::lame(2, 0.0, 0.0, StressState::PlaneStress).into();
    problem.materials[0].viscosity = hencky(bulk, law, StressState::PlaneStress);
    let problem = checked(problem);
    for state in &solve(&problem).states[1..] {
        for (x, w) in problem.mesh.points.iter().zip(state.w.chunks_exact(2)) {
            assert!((w[0] - rate * x[0]).abs() < 1e-10 * rate, "step {}: {:e} at x = {}", state.step, w[0], x[0]);
        }
    }
}

/// Both nonlinear laws at once in the paper's problem: every step converges with contact inside, the energy identity
/// closes, and what the scheme dissipates is not negative.
#[test]
fn contact_is_solved_inside_newton_over_the_body() {
    let mut problem =
        paper(&["mesh.n=8", "time.steps=32", "contact.heat.foundation_temperature=10"]).problem.into_data();
    problem.materials[0].elasticity =
        hencky(0.9, VonMisesProjection::new(0.9, 6.0, 0.01).expect("constants"), StressState::PlaneStress);
    problem.materials[0].viscosity =
        hencky(12.0, Carreau::new(5.0, 1.0, 20.0, 0.3).expect("constants"), StressState::PlaneStrain);
    let memory = solve(&checked(problem));
    let linear = solve(&paper(&["mesh.n=8", "time.steps=32", "contact.heat.foundation_temperature=10"]).problem);
    assert!(distance(memory.states.last().unwrap(), linear.states.last().unwrap()) > 1e-2, "the laws are active");
    for (report, states) in memory.reports.iter().zip(memory.states.windows(2)) {
        assert!(report.residual <= 1e-10, "{:e}", report.residual);
        let [old, new] = [&states[0].ledger, &states[1].ledger];
        assert!(new.relative_closing_error().abs() < 1e-10);
        assert!(new.scheme_dissipation - old.scheme_dissipation > -1e-12 * new.turned_over);
        for point in &report.contact.states {
            assert!((point.pressure - 1e4 * point.penetration.max(0.0)).abs() <= 1e-9 * (1.0 + point.pressure));
            assert!(amontons::tensor::length(&point.q) <= point.bound * (1.0 + 1e-9) + 1e-12);
        }
    }
}
