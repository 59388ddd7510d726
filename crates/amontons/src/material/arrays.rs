//! A constitutive law that is evaluated for many points at once.

use std::sync::Arc;

use super::{Material, OperatorConstants, TensorLaw};
use crate::arrays::{Arrays, Inputs, OnArrays};
use crate::field::Law;
use crate::tensor::{Point, Sym, SymMap};

/// A law on arrays. Its arguments are the position in m and the Mandel components of ξ, in their order.
#[derive(Debug)]
pub struct ArrayTensor {
    /// The Mandel components of the value.
    pub value: Arrays,
    /// The rows of the derivative in Mandel components.
    pub tangent: Arrays,
    /// The potential in J/m³; `None` if the law has none.
    pub potential: Option<Arrays>,
    /// m and M of (H1), (H2).
    pub constants: OperatorConstants,
}

fn inputs(x: &Point, xi: &Sym) -> Inputs {
    let (x, xi) = (x, &xi.0);
    [x[0], x[1], x[2], xi[0], xi[1], xi[2], xi[3], xi[4], xi[5], 0.0]
}

impl From<ArrayTensor> for Law<dyn TensorLaw> {
    fn from(law: ArrayTensor) -> Self {
        let arrays = [&law.value, &law.tangent].into_iter().chain(&law.potential).cloned().collect();
        Law::on_arrays(Arc::new(OnArrays(law)), arrays)
    }
}

impl TensorLaw for OnArrays<ArrayTensor> {
    fn value(&self, x: &Point, xi: &Sym) -> Sym {
        Sym(self.0.value.at(&inputs(x, xi)))
    }
    fn tangent(&self, x: &Point, xi: &Sym) -> SymMap {
        let entries: [f64; 36] = self.0.tangent.at(&inputs(x, xi));
        SymMap(std::array::from_fn(|i| std::array::from_fn(|j| entries[6 * i + j])))
    }
    fn constants(&self) -> OperatorConstants {
        self.0.constants
    }
    fn potential(&self, x: &Point, xi: &Sym) -> Option<f64> {
        self.0.potential.as_ref().map(|potential| potential.at::<1>(&inputs(x, xi))[0])
    }
}

/// The array functions of laws.
pub(crate) fn arrays<'a>(laws: &[&'a Law<dyn TensorLaw>]) -> Vec<&'a Arrays> {
    laws.iter().flat_map(|law| law.arrays()).collect()
}

/// The array functions of the laws of materials.
pub(crate) fn material_arrays(materials: &[Material]) -> Vec<&Arrays> {
    materials.iter().flat_map(|material| arrays(&[&material.elasticity, &material.viscosity])).collect()
}
