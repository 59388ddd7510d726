//! Bodies whose laws are not linear, and bodies whose stress relaxes.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;

use std::sync::Arc;

use amontons::material::{
    Carreau, Hencky, Isotropic, Prony, ShearLaw, StressState, TensorLaw, VonMisesProjection, reduced,
};
use amontons::output::Memory;
use amontons::problem::{BoundaryCondition, Problem, ProblemData};
use amontons::run::{self, Settings};
use amontons::scheme::State;
use common::{case, changed, checked, largest, paper};

fn solve(problem: &Problem) -> Memory {
    let mut memory = Memory::new().states_every(1).reports();
    let settings = Settings { certificate: false, ..Settings::default() };
    run::run(problem, &settings, &mut [&mut memory]).unwrap_or_else(|error| panic!("{error}"));
    memory
}

/// A rod of length 1 and height 1/4 in plane stress, on rollers at its left and lower side, pulled at its right end by
/// the traction `pull`; without inertia and contact.
fn rod(steps: usize, pull: f64) -> ProblemData {
    let overrides = [format!("time.steps={steps}"), "time.end=1".to_owned()];
    let mut problem = case("crates/amontons/benchmarks/kelvin-voigt-rod.toml", &overrides).problem.into_data();
    let roller = |on: &str, free: usize| {
        let displacement = Some((0..2).map(|c| if c == free { None } else { Some(0.0.into()) }).collect());
        BoundaryCondition { displacement, ..BoundaryCondition::on(on) }
    };
    let pulled = BoundaryCondition::on("right").traction([pull, 0.0]);
    problem.boundary = vec![roller("left", 1), roller("bottom", 0), pulled];
    problem.contacts.clear();
    problem
}

fn hencky(bulk: f64, shear: impl ShearLaw + 'static, state: StressState) -> Arc<dyn TensorLaw> {
    reduced(Hencky::new(bulk, shear).expect("constants"), 2, state)
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
        problem.materials[0].viscosity = Arc::new(Isotropic::lame(2, 0.0, 0.0, StressState::PlaneStress));
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
    problem.materials[0].elasticity = Arc::new(Isotropic::lame(2, 0.0, 0.0, StressState::PlaneStress));
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

/// A rod with Maxwell branches held at a strain ε from t = 0⁺: the branch strains are ε (1 + k/τ)^(−n), so the reaction
/// is known to round-off; as the steps are refined it comes to E ε (1 + Σ g exp(−t/τ)) at first order.
#[test]
fn stress_relaxes_by_the_prony_series() {
    let pairs = [(0.5, 0.2), (2.0, 1.5)];
    let (young, strain) = (2.0, 0.01);
    let end = |steps: usize| {
        let mut problem = rod(steps, 0.0);
        problem.boundary[2].traction = None;
        problem.boundary[2].displacement = Some(vec![Some(strain.into()), None]);
        problem.materials[0].viscosity = Arc::new(Isotropic::lame(2, 0.0, 0.0, StressState::PlaneStress));
        problem.materials[0].prony =
            Some(Prony::ratios(problem.materials[0].elasticity.as_ref(), &pairs).expect("branches"));
        let problem = checked(problem);
        let memory = solve(&problem);
        let k = problem.k();
        for states in memory.states.windows(2) {
            let [old, new] = [&states[0], &states[1]];
            // The springs of all branches have the strain ε(z), z = u (1 + k/τ)^(−n).
            for (z, (_, time)) in new.branches.iter().zip(pairs) {
                let left = (1.0 + k / time).powi(-(new.step as i32));
                assert!(z.iter().zip(&new.u).all(|(z, u)| (z - left * u).abs() < 1e-12 * strain));
            }
            let stored: f64 = pairs.iter().map(|(g, time)| g * (1.0 + k / time).powi(-2 * new.step as i32)).sum();
            let energy = 0.25 * 0.5 * young * strain * strain * (1.0 + stored);
            assert!((new.ledger.elastic / energy - 1.0).abs() < 1e-9, "{:e}, expected {energy:e}", new.ledger.elastic);
            assert!(new.ledger.viscous_dissipation >= old.ledger.viscous_dissipation);
            assert!(new.ledger.relative_closing_error().abs() < 1e-12);
        }
        let last = memory.states.last().expect("a state");
        // The dissipated energy of the limit: Σ g E ε²/2 (1 − exp(−2t/τ)) of the volume, without that of the sudden
        // load.
        last.ledger.viscous_dissipation
    };
    let exact: f64 =
        pairs.iter().map(|(g, time)| 0.25 * 0.5 * g * young * strain * strain * (1.0 - f64::exp(-2.0 / time))).sum();
    let errors = [64, 128, 256].map(|steps| (end(steps) - exact).abs());
    for pair in errors.windows(2) {
        assert!(((pair[0] / pair[1]).log2() - 1.0).abs() < 0.1, "{errors:?}");
    }
}

/// The branches couple with contact: the paper's problem with a branch as stiff as the body keeps both identities.
#[test]
fn branches_and_contact_keep_the_identities() {
    let mut problem = paper(&["mesh.n=8", "time.steps=32"]).problem.into_data();
    problem.materials[0].prony =
        Some(Prony::ratios(problem.materials[0].elasticity.as_ref(), &[(3.0, 0.1), (1.0, 10.0)]).expect("branches"));
    let memory = solve(&checked(problem));
    for state in &memory.states {
        assert!(
            state.ledger.relative_closing_error().abs() < 1e-12
                && state.ledger.relative_heat_closing_error().abs() < 1e-12
        );
    }
    assert!(memory.reports.iter().all(|report| report.residual < 1e-10));
}
