//! The forms of the body at a state, apart from each other.

use super::Discretization;
use crate::forms;
use crate::linalg::BlockMatrix;

impl Discretization {
    /// The matrices of b and a at u, w and θ: B with the dashpots, A with the springs, laws that are not linear by
    /// their tangents. Branches are left out.
    #[must_use]
    pub fn mechanical_forms(&self, u: &[f64], w: &[f64], theta: &[f64]) -> [BlockMatrix; 2] {
        let of = |form: &BlockMatrix, boundary: Option<&BlockMatrix>, laws: &[_], at: &[f64]| {
            let mut matrix = form.clone();
            if let Some(boundary) = boundary {
                matrix.add_scaled(1.0, boundary);
            }
            if !laws.is_empty() {
                matrix.add_scaled(1.0, &self.tangent(laws, at, theta));
            }
            matrix
        };
        [
            of(&self.b, self.dashpots.as_ref(), &self.viscosity, w),
            of(&self.a, self.springs.as_ref(), &self.elasticity, u),
        ]
    }

    /// C and D at θ, D with the convection and without [`Discretization::thermal_slope`].
    #[must_use]
    pub fn thermal_forms(&self, theta: &[f64]) -> [BlockMatrix; 2] {
        let graph = self.mass.graph();
        let zero = || BlockMatrix::zero(graph, 1, 1);
        let (mut storage, mut conduction) = (zero(), zero());
        if self.stores_linearly() {
            let (c, form) = self.storage();
            storage.add_scaled(c, form);
        } else {
            storage.add_scaled(1.0, &forms::weighted_at(&self.mesh, graph, &self.warm.capacity, theta));
        }
        if self.warm.conductivity.is_empty() {
            conduction.add_scaled(1.0, &self.d);
        } else {
            let all: Vec<_> = self.warm.conductivity.iter().collect();
            conduction.add_scaled(1.0, &forms::d_at(&self.mesh, graph, &all, theta));
        }
        if let Some(convection) = &self.convection {
            conduction.add_scaled(1.0, convection);
        }
        [storage, conduction]
    }
}
