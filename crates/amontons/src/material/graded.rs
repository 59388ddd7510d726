//! Elasticity and viscosity whose coefficients vary over the body or with the temperature.

use super::{OperatorConstants, TensorLaw};
use crate::field::{Graded, law_kind};
use crate::tensor::{Point, Sym, SymMap};

law_kind!(TensorLaw, |law| {
    let OperatorConstants { monotonicity, lipschitz } = law.constants();
    ([monotonicity, lipschitz], !law.is_linear())
});

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
    fn constants(&self) -> OperatorConstants {
        let [least, most] = self.extremes().map(|instance| instance.law.constants());
        OperatorConstants { monotonicity: least.monotonicity, lipschitz: most.lipschitz }
    }
    fn potential(&self, x: &Point, xi: &Sym) -> Option<f64> {
        self.at(x).potential(x, xi)
    }
}
