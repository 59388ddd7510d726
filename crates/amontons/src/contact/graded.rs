//! Contact laws whose coefficients vary over the side and in time, evaluated by the law of each point.

use std::sync::Arc;

use super::{Bound, Cone, ContactPoint, Flux, FrictionLaw, GraphKind, HeatLaw, NormalLaw, Pressure, Sum, WearLaw};
use crate::field::{Graded, Law, law_kind};
use crate::tensor::Point;

/// Replaces a constant that a law does not have.
const NONE: f64 = f64::INFINITY;

// The first number selects the law with the largest L_ν, the second that with the largest constant in the rate.
law_kind!(NormalLaw, |law| { ([-law.lipschitz().unwrap_or(NONE), law.lipschitz_in_rate().unwrap_or(NONE)], false) });

impl NormalLaw for Graded<dyn NormalLaw> {
    fn pressure(&self, x: &Point, z: f64, rate: f64, lambda: f64) -> Pressure {
        self.at(x).pressure(x, z, rate, lambda)
    }
    fn potential(&self, x: &Point, r: f64) -> f64 {
        self.at(x).potential(x, r)
    }
    fn lipschitz(&self) -> Option<f64> {
        self.extremes()[0].law.lipschitz()
    }
    fn lipschitz_in_rate(&self) -> Option<f64> {
        self.extremes()[1].law.lipschitz_in_rate()
    }
    fn least_slope(&self, x: &Point, from: f64, to: f64) -> f64 {
        self.at(x).least_slope(x, from, to)
    }
    fn graph(&self) -> GraphKind {
        self.extremes()[0].law.graph()
    }
    fn is_rigid(&self) -> bool {
        self.extremes()[0].law.is_rigid()
    }
}

// By L_τ at L_ν = 1. A law with friction ranks before a frictionless one, whatever its constant.
law_kind!(FrictionLaw, |law| {
    let tau = law.lipschitz(Some(1.0)).unwrap_or(NONE);
    ([tau, if law.is_frictionless() { -1.0 } else { tau }], law.drops_from_rest())
});

impl FrictionLaw for Graded<dyn FrictionLaw> {
    fn bound(&self, at: &ContactPoint) -> Bound {
        self.at(&at.x).bound(at)
    }
    fn lipschitz(&self, l_nu: Option<f64>) -> Option<f64> {
        self.extremes()[1].law.lipschitz(l_nu)
    }
    fn least_slope(&self, at: &ContactPoint, from: f64, to: f64) -> f64 {
        self.at(&at.x).least_slope(at, from, to)
    }
    fn drops_from_rest(&self) -> bool {
        self.is_special()
    }
    fn is_frictionless(&self) -> bool {
        self.extremes().iter().all(|instance| instance.law.is_frictionless())
    }
    fn cone(&self, x: &Point, nu: &Point) -> Option<Cone> {
        self.at(x).cone(x, nu)
    }
}

impl Law<dyn HeatLaw> {
    /// The law whose flux is the sum of those of several laws.
    #[must_use]
    pub fn sum(laws: Vec<Law<dyn HeatLaw>>) -> Law<dyn HeatLaw> {
        let arrays = laws.iter().flat_map(Law::arrays).cloned().collect();
        let sum: Law<dyn HeatLaw> =
            Law::on_arrays(Arc::new(Sum { laws: laws.iter().map(Law::shared).collect() }), arrays);
        if laws.iter().all(|law| law.at_time(0.0).is_none()) {
            return sum;
        }
        sum.changing(move |t| Law::sum(laws.iter().map(|law| law.at_time(t).unwrap_or_else(|| law.clone())).collect()))
    }
}

// The first number selects the law with the largest L_kc, the second that with the largest M_kc.
law_kind!(HeatLaw, |law| { ([-law.conductance_lipschitz().unwrap_or(NONE), law.conductance_bound()], false) });

impl HeatLaw for Graded<dyn HeatLaw> {
    fn flux(&self, at: &ContactPoint) -> Flux {
        self.at(&at.x).flux(at)
    }
    fn mechanism(&self) -> Option<&'static str> {
        self.extremes()[0].law.mechanism()
    }
    fn conductance_bound(&self) -> f64 {
        self.extremes()[1].law.conductance_bound()
    }
    fn conductance_lipschitz(&self) -> Option<f64> {
        self.extremes()[0].law.conductance_lipschitz()
    }
    fn truncation(&self) -> Option<f64> {
        let [first, second] = self.extremes().map(|instance| instance.law.truncation());
        Some(first?.max(second?))
    }
    fn absolute_zero(&self) -> Option<f64> {
        self.extremes()[1].law.absolute_zero()
    }
}

law_kind!(WearLaw, |_| ([0.0; 2], false));

impl WearLaw for Graded<dyn WearLaw> {
    fn coefficient(&self, at: &ContactPoint) -> f64 {
        self.at(&at.x).coefficient(at)
    }
    fn by_temperature(&self, at: &ContactPoint) -> f64 {
        self.at(&at.x).by_temperature(at)
    }
}
