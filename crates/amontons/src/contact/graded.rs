//! Contact laws whose coefficients vary over the side and in time.

use std::sync::Arc;

use super::{Bound, Cone, ContactPoint, Flux, FrictionLaw, GraphKind, HeatLaw, NormalLaw, Pressure, WearLaw};
use crate::field::Graded;
use crate::tensor::Point;

/// Replaces a constant that a law does not have.
const NONE: f64 = f64::INFINITY;

impl Graded<dyn NormalLaw> {
    /// A pressure by the law `at` per point of a side; L_ν is the largest over the points.
    #[must_use]
    pub fn normal(
        points: &[Point],
        at: impl Fn(&Point) -> Arc<dyn NormalLaw> + Send + Sync + 'static,
    ) -> Graded<dyn NormalLaw> {
        Graded::normal_in_time(points, &[0.0], move |x, _| at(x))
    }

    /// A pressure by the law `at` per point and time, with L_ν the largest over points and times. With fewer than two
    /// times the law does not change.
    #[must_use]
    pub fn normal_in_time(
        points: &[Point],
        times: &[f64],
        at: impl Fn(&Point, f64) -> Arc<dyn NormalLaw> + Send + Sync + 'static,
    ) -> Graded<dyn NormalLaw> {
        Graded::over(points, times, at, |law| ([law.lipschitz().unwrap_or(NONE); 2], false))
    }
}

impl NormalLaw for Graded<dyn NormalLaw> {
    fn pressure(&self, x: &Point, z: f64, rate: f64, lambda: f64) -> Pressure {
        self.at(x).pressure(x, z, rate, lambda)
    }
    fn potential(&self, x: &Point, r: f64) -> f64 {
        self.at(x).potential(x, r)
    }
    fn lipschitz(&self) -> Option<f64> {
        self.extremes()[1].law.lipschitz()
    }
    fn least_slope(&self, x: &Point, from: f64, to: f64) -> f64 {
        self.at(x).least_slope(x, from, to)
    }
    fn graph(&self) -> GraphKind {
        self.extremes()[1].law.graph()
    }
    fn graded(&self) -> Option<&Graded<dyn NormalLaw>> {
        Some(self)
    }
    fn at_time(&self, t: f64) -> Option<Arc<dyn NormalLaw>> {
        Some(Arc::new(Graded::at_time(self, t)?))
    }
}

impl Graded<dyn FrictionLaw> {
    /// A friction bound by the law `at` per point of a side and time; L_τ is the largest over points and times. With
    /// fewer than two times the law does not change.
    #[must_use]
    pub fn friction(
        points: &[Point],
        times: &[f64],
        at: impl Fn(&Point, f64) -> Arc<dyn FrictionLaw> + Send + Sync + 'static,
    ) -> Graded<dyn FrictionLaw> {
        Graded::over(points, times, at, |law| {
            let tau = law.lipschitz(Some(1.0)).unwrap_or(NONE);
            // A law with friction ranks before a frictionless one, whatever its constant.
            ([tau, if law.is_frictionless() { -1.0 } else { tau }], law.drops_from_rest())
        })
    }
}

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
    fn graded(&self) -> Option<&Graded<dyn FrictionLaw>> {
        Some(self)
    }
    fn at_time(&self, t: f64) -> Option<Arc<dyn FrictionLaw>> {
        Some(Arc::new(Graded::at_time(self, t)?))
    }
}

impl Graded<dyn HeatLaw> {
    /// A heat flux by the law `at` per point of a side and time; M_kc is the largest over points and times. With fewer
    /// than two times the law does not change.
    #[must_use]
    pub fn heat(
        points: &[Point],
        times: &[f64],
        at: impl Fn(&Point, f64) -> Arc<dyn HeatLaw> + Send + Sync + 'static,
    ) -> Graded<dyn HeatLaw> {
        Graded::over(points, times, at, |law| {
            // The first key selects the law with the largest L_kc, the second that with the largest M_kc.
            ([-law.conductance_lipschitz().unwrap_or(NONE), law.conductance_bound()], false)
        })
    }
}

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
    fn graded(&self) -> Option<&Graded<dyn HeatLaw>> {
        Some(self)
    }
    fn at_time(&self, t: f64) -> Option<Arc<dyn HeatLaw>> {
        Some(Arc::new(Graded::at_time(self, t)?))
    }
}

impl Graded<dyn WearLaw> {
    /// A wear law `at` per point of a side and time. With fewer than two times the law does not change.
    #[must_use]
    pub fn wear(
        points: &[Point],
        times: &[f64],
        at: impl Fn(&Point, f64) -> Arc<dyn WearLaw> + Send + Sync + 'static,
    ) -> Graded<dyn WearLaw> {
        Graded::over(points, times, at, |_| ([0.0; 2], false))
    }
}

impl WearLaw for Graded<dyn WearLaw> {
    fn coefficient(&self, at: &ContactPoint) -> f64 {
        self.at(&at.x).coefficient(at)
    }
    fn by_temperature(&self, at: &ContactPoint) -> f64 {
        self.at(&at.x).by_temperature(at)
    }
    fn at_time(&self, t: f64) -> Option<Arc<dyn WearLaw>> {
        Some(Arc::new(Graded::at_time(self, t)?))
    }
}
