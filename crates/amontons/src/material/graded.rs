//! Elasticity and viscosity whose coefficients vary over the body or with the temperature.

use std::sync::Arc;

use super::{OperatorConstants, TensorLaw};
use crate::field::Graded;
use crate::tensor::{Point, Sym, SymMap};

impl Graded<dyn TensorLaw> {
    /// An elasticity or viscosity given by the law `at` per point; m and M are the extremes over the points.
    #[must_use]
    pub fn elastic(
        points: &[Point],
        at: impl Fn(&Point) -> Arc<dyn TensorLaw> + Send + Sync + 'static,
    ) -> Graded<dyn TensorLaw> {
        Graded::elastic_of_temperature(points, &[], move |x, _| at(x))
    }

    /// An elasticity or viscosity that also depends on the temperature, from the first to the last of the ascending
    /// `temperatures` in K; m and M are the extremes over points and temperatures.
    #[must_use]
    pub fn elastic_of_temperature(
        points: &[Point],
        temperatures: &[f64],
        at: impl Fn(&Point, f64) -> Arc<dyn TensorLaw> + Send + Sync + 'static,
    ) -> Graded<dyn TensorLaw> {
        Graded::over_all(
            points,
            &[0.0],
            temperatures,
            move |x, _, theta| at(x, theta),
            |law| {
                let OperatorConstants { monotonicity, lipschitz } = law.constants();
                ([monotonicity, lipschitz], !law.is_linear())
            },
        )
    }
}

impl TensorLaw for Graded<dyn TensorLaw> {
    fn value(&self, x: &Point, xi: &Sym) -> Sym {
        self.at(x).value(x, xi)
    }
    fn tangent(&self, x: &Point, xi: &Sym) -> SymMap {
        self.at(x).tangent(x, xi)
    }
    fn is_linear(&self) -> bool {
        !self.is_special()
    }
    fn graded(&self) -> Option<&Graded<dyn TensorLaw>> {
        Some(self)
    }
    fn constants(&self) -> OperatorConstants {
        let [least, most] = self.extremes().map(|instance| instance.law.constants());
        OperatorConstants { monotonicity: least.monotonicity, lipschitz: most.lipschitz }
    }
    fn potential(&self, x: &Point, xi: &Sym) -> Option<f64> {
        self.at(x).potential(x, xi)
    }
}
