//! The monolithic step where friction and wear follow the temperature that friction makes, against the two scalar
//! equations of a column.

use crate::column::column;
use amontons::contact::{Bound, ContactPoint, FrictionLaw};
use amontons::problem::{Coupling, Problem};
use amontons::state::{State, StepReport};
use amontons::step::{March, Scheme};

/// s = μ₀ e^{θ/θ₀} p; with its slope in θ, or with none.
#[derive(Debug)]
struct Exponential {
    slope: bool,
}
const MU_0: f64 = 0.233;
const THETA_0: f64 = 0.17;
impl FrictionLaw for Exponential {
    fn bound(&self, at: &ContactPoint) -> Bound {
        let mu = MU_0 * (at.temperature / THETA_0).exp();
        let by_temperature = if self.slope { mu * at.pressure / THETA_0 } else { 0.0 };
        Bound { value: mu * at.pressure, by_pressure: mu, by_temperature, ..Bound::default() }
    }
    fn lipschitz(&self, _l_nu: Option<f64>) -> Option<f64> {
        None
    }
}

const K: f64 = 0.5;
/// ρ/(3k) + b + kG and c/(3k) + κ.
const S: f64 = 1.0 / K + 1.0 + K;
const H: f64 = 1.0 / K + 1.0;

fn step(problem: &Problem, coupling: Coupling) -> (State, StepReport) {
    let problem = problem.with(|data| data.coupling = coupling).expect("valid data");
    let mut scheme = March::new(&problem).expect("a regular system");
    let start = scheme.initial().expect("finite initial data");
    scheme.step(&start).unwrap_or_else(|error| panic!("{error}"))
}

fn hot(slope: bool, coupling: Coupling) -> (State, StepReport) {
    // Narrow: in a wide column a difference between both contact points grows from pass to pass, by 7/6.
    let problem = column(&["contact.foundation_velocity=[1, 0]", "mesh.size=[0.5, 1]"]);
    step(&problem.with(|data| data.contacts[0].friction = Exponential { slope }.into()).expect("valid data"), coupling)
}

/// The root of a function that changes its sign between two numbers.
fn root(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let sign = f(low) > 0.0;
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if (f(middle) > 0.0) == sign { low = middle } else { high = middle }
    }
    low
}

/// Temperature and velocity of the node at the origin.
fn ends(state: &State) -> [f64; 2] {
    [state.theta[0], state.w[0]]
}

/// S w = s(θ), H θ = s(θ) (1 − w): Newton's method for θ ↦ s(1 − s/S)/H, of slope 0.8 at its root, has the passes of
/// the scalar one; without ∂s/∂θ it has those of the fixed point.
#[test]
fn newton_sees_the_slope_of_friction_in_the_temperature() {
    let s = |theta: f64| MU_0 * (theta / THETA_0).exp();
    let map = |theta: f64| s(theta) * (1.0 - s(theta) / S) / H;
    let slope = |theta: f64| s(theta) / THETA_0 * (1.0 - 2.0 * s(theta) / S) / H;
    let theta = root(|theta| map(theta) - theta, 0.0, 0.25);
    let expected = [theta, s(theta) / S];
    println!("θ = {theta}, w = {}, slope of the map {:.3}", expected[1], slope(theta));
    assert!(slope(theta) > 0.7, "the feedback is weak: {}", slope(theta));

    // The scalar iteration, one pass each, down to the same defect of the force: |s(Φ) − s(θ)| over the largest term.
    let (mut at, mut passes, mut defects) = (0.0, 0, Vec::new());
    loop {
        passes += 1;
        defects.push((s(map(at)) - s(at)).abs() / s(at));
        if defects[passes - 1] <= 1e-12 {
            break;
        }
        at += (map(at) - at) / (1.0 - slope(at));
    }
    println!("by hand: {passes} passes, defects {defects:?}");
    let mut found = Vec::new();
    for (slope, coupling) in [(true, Coupling::Monolithic), (false, Coupling::Monolithic), (true, Coupling::FixedPoint)]
    {
        let (state, report) = hot(slope, coupling);
        // A defect of 1e-10 of s, the largest that is accepted, is one of θ₀ 1e-10 in θ, and an error of 1/(1 − 0.82)
        // times that: 5e-10 θ.
        for (found, expected) in ends(&state).iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-9, "{coupling:?}: {found}, expected {expected}");
        }
        println!("{coupling:?}, slope {slope}: {:?}", report.coupling);
        found.push(report.coupling.passes);
    }
    assert!(found[0].abs_diff(passes) <= 1, "{} passes, {passes} by hand", found[0]);
    assert!(found[1] > 3 * found[0] && found[2] > 3 * found[0], "{found:?}");
}

/// Wear by the temperature: p = p₀/(1 + c_ν k κ(θ) (1 − w)), S w = μ p, H θ = μ p (1 − w), κ(θ) = κ₀ + κ₁ θ on its
/// table.
#[test]
fn newton_sees_the_slope_of_wear_in_the_temperature() {
    let [kappa, more] = [1e-4, 5e-3];
    let run = |coupling| {
        let problem = column(&[
            "contact.foundation_velocity=[1, 0]",
            "contact.friction.coefficient=0.8",
            &format!(
                "contact.wear={{law='archard-temperature', temperature=[0, 1], coefficient=[{kappa:?}, {:?}]}}",
                kappa + more
            ),
        ]);
        step(&problem, coupling)
    };
    let p = |theta: f64, w: f64| 1.0 / (1.0 + 1e3 * K * (kappa + more * theta) * (1.0 - w));
    let w = |theta: f64| root(|w| S * w - 0.8 * p(theta, w), 0.0, 1.0);
    let map = |theta: f64| 0.8 * p(theta, w(theta)) * (1.0 - w(theta)) / H;
    let theta = root(|theta| map(theta) - theta, 0.0, 1.0);
    println!("θ = {theta}, w = {}, slope of the map {:.3}", w(theta), (map(theta + 1e-5) - map(theta - 1e-5)) / 2e-5);
    let [newton, fixed] = [Coupling::Monolithic, Coupling::FixedPoint].map(|coupling| {
        let (state, report) = run(coupling);
        for (found, expected) in ends(&state).iter().zip([theta, w(theta)]) {
            assert!((found / expected - 1.0).abs() < 1e-10, "{coupling:?}: {found}, expected {expected}");
        }
        println!("{coupling:?}: {:?}", report.coupling);
        report.coupling.passes
    });
    // Down to 1e-12 quadratically: 1e-1, 1e-2, 1e-4, 1e-8, 1e-16.
    assert!(newton <= 6 && fixed > newton + 3, "{newton} and {fixed} passes");
}
