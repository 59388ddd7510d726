//! The multipliers of the contact points: pressure and friction.

use crate::tensor::Point;

/// State of the contact points that a step starts from and ends with.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Multipliers {
    /// Pressure p at each contact point in Pa; zero where the normal law falls and the pressure is taken as a function
    /// of the penetration.
    pub p: Vec<f64>,
    /// q = −σ_τ at each contact point, Pa.
    pub q: Vec<Point>,
    /// True if the point sticks. A bound that drops when slip starts is then the static one.
    pub sticks: Vec<bool>,
}

impl Multipliers {
    /// Without forces; `sticks` says which points are at rest against the foundation.
    #[must_use]
    pub fn free(sticks: Vec<bool>) -> Multipliers {
        Multipliers { p: vec![0.0; sticks.len()], q: vec![[0.0; 3]; sticks.len()], sticks }
    }

    /// The multipliers a part α of the way to others, on the branches of those.
    #[must_use]
    pub fn towards(&self, other: &Multipliers, alpha: f64) -> Multipliers {
        let part = |a: f64, b: f64| a + alpha * (b - a);
        Multipliers {
            p: self.p.iter().zip(&other.p).map(|(a, b)| part(*a, *b)).collect(),
            q: self.q.iter().zip(&other.q).map(|(a, b)| std::array::from_fn(|c| part(a[c], b[c]))).collect(),
            sticks: other.sticks.clone(),
        }
    }
}
