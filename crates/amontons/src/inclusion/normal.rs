//! (2.8) at one contact point: the pressure p as multiplier of the penetration, linearised.

use crate::contact::{NormalLaw, Pressure, Yield, resolvent};
use crate::tensor::Point;

/// Computation of the pressure of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Response {
    /// p is a multiplier, equal to J(r + λ p) at a solution, with J(z) the p of p ∈ G(z − λ p, ż − λ p/k), ż = ṙ + λ
    /// p/k: laws that do not fall, of any stiffness and damping.
    Multiplier {
        /// λ in m/Pa.
        lambda: f64,
    },
    /// p = G(r, ṙ): softening laws, which have no resolvent.
    Function,
    /// The multiplier is the pressure, and the law is not asked.
    Given,
}

/// Input of a normal law in a step.
pub(super) struct Approach<'a> {
    pub law: &'a dyn NormalLaw,
    pub x: &'a Point,
    /// Length k of the step, s.
    pub length: f64,
    pub response: Response,
    /// r but for what wears off in the step, m, and its rate where the law presses, min(ṙ, r/k) in m/s.
    pub penetration: f64,
    pub rate: f64,
    /// λ_w in m/Pa: λ_w p₊ is the depth by which the gap opens by wear.
    pub by_wear: f64,
    /// Stiffness of a point on a rigid foundation over ρ.
    pub stiff: f64,
}

/// The pressure at an iterate: p the multiplier and J(r + λ p), what the law makes of it, with slopes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Normal {
    /// p in Pa: the multiplier, or G of a function.
    pub pressure: f64,
    /// J in Pa, which is p at a solution.
    pub pressed: f64,
    /// ∂J/∂w_ν at fixed p, Pa s/m.
    pub slope: f64,
    /// ∂J/∂z + (1/k) ∂J/∂ż, Pa/m: the slope in a depth that the gap opens by within the step.
    pub by_depth: f64,
    /// 1 − λ ∂J/∂z − λ/k ∂J/∂ż, but not zero; 1 for a function.
    pub yielding: f64,
}

impl Normal {
    /// Evaluates the law at the multiplier `p`.
    pub fn new(at: &Approach, p: f64) -> Normal {
        let lambda = match at.response {
            Response::Given => {
                return Normal { pressure: p, pressed: p, slope: 0.0, by_depth: 0.0, yielding: 1.0 };
            }
            Response::Function => 0.0,
            Response::Multiplier { lambda } => lambda,
        };
        let (lambda_rate, by_wear_rate) = (lambda / at.length, at.by_wear / at.length);
        let by = Yield { lambda, lambda_rate, by_wear: at.by_wear, by_wear_rate };
        let (z, rate) = (at.penetration + lambda * p, at.rate + by.lambda_rate * p);
        let Pressure { value, slope, by_rate } = resolvent(at.law, at.x, z, rate, &by);
        Normal {
            pressure: if at.response == Response::Function { value } else { p },
            pressed: value,
            slope: at.length * slope + by_rate,
            by_depth: slope + by_rate / at.length,
            yielding: (1.0 - slope * lambda - by_rate * by.lambda_rate).max(at.stiff.recip()),
        }
    }

    /// Pressure of the linearised law at an unchanged velocity, δp = (∂J/∂w_ν δw_ν + J − p)/yielding.
    pub fn linear(&self) -> f64 {
        self.pressure + (self.pressed - self.pressure) / self.yielding
    }

    /// Slope of the pressure of the linearised law in w_ν, Pa s/m.
    pub fn stiffness(&self) -> f64 {
        self.slope / self.yielding
    }
}
