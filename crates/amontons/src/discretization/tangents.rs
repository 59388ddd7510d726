//! The derivatives of the forms at a state.

use super::{Discretization, Warmed, borrowed};
use crate::forms;
use crate::linalg::BlockMatrix;
use crate::time::Rule;

impl Discretization {
    /// [`Discretization::mechanical_matrix`] with the tangents at u and w of laws that are not linear, and with the
    /// laws of the temperature at θ.
    #[must_use]
    pub fn mechanical_tangent(&self, rule: Rule, u: &[f64], w: &[f64], warmed: &Warmed) -> BlockMatrix {
        let mut matrix = self.mechanical_matrix(rule);
        if let Some([a, b]) = &warmed.forms {
            matrix.add_scaled(rule.gamma, a);
            if !rule.is_steady() {
                matrix.add_scaled(1.0, b);
            }
            return matrix;
        }
        let viscosity = Some((&self.viscosity, 1.0, w)).filter(|_| !rule.is_steady());
        for (laws, factor, at) in [(&self.elasticity, rule.gamma, u)].into_iter().chain(viscosity) {
            if !laws.is_empty() {
                matrix.add_scaled(factor, &self.tangent(laws, at, warmed.theta));
            }
        }
        matrix
    }

    /// The derivative of a(u, ·) with the springs in u, or `None` if a is linear and does not change.
    #[must_use]
    pub fn elastic_tangent(&self, u: &[f64], warmed: &Warmed) -> Option<BlockMatrix> {
        if self.elasticity.is_empty() {
            return None;
        }
        let mut matrix = self.a.clone();
        self.springs.iter().for_each(|springs| matrix.add_scaled(1.0, springs));
        match &warmed.forms {
            Some([a, _]) => matrix.add_scaled(1.0, a),
            None => matrix.add_scaled(1.0, &self.tangent(&self.elasticity, u, warmed.theta)),
        }
        Some(matrix)
    }

    /// [`Discretization::thermal_matrix`] with 𝓚 and the heat capacity at θ: the symmetric part of the tangent.
    #[must_use]
    pub fn thermal_tangent(&self, rule: Rule, theta: &[f64]) -> BlockMatrix {
        self.thermal_tangent_with(rule, [theta; 2])
    }

    /// The same with 𝓚 and the heat capacity at a temperature each.
    #[must_use]
    pub fn thermal_tangent_with(&self, rule: Rule, [of_conduction, of_storage]: [&[f64]; 2]) -> BlockMatrix {
        let conductivity = &self.warm.conductivity;
        let d = if conductivity.is_empty() {
            self.d.clone()
        } else {
            forms::d_at(&self.mesh, self.mass.graph(), &conductivity.iter().collect::<Vec<_>>(), of_conduction)
        };
        match self.capacity_form(of_storage) {
            None => self.sum_of_heat(rule, d, self.storage()),
            Some(storage) => self.sum_of_heat(rule, d, (1.0, &storage)),
        }
    }

    /// The derivative of the stored heat in the temperature at θ, or `None` if it is that of
    /// [`Discretization::storage`].
    #[must_use]
    pub fn capacity_form(&self, theta: &[f64]) -> Option<BlockMatrix> {
        let capacity = &self.warm.capacity;
        (!capacity.is_empty()).then(|| forms::weighted_at(&self.mesh, self.mass.graph(), capacity, theta))
    }

    /// Part of the tangent of (4.2) that [`Discretization::thermal_tangent`] leaves out, from the slope of 𝓚, or `None`
    /// if 𝓚 does not depend on temperature.
    #[must_use]
    pub fn thermal_slope(&self, theta: &[f64]) -> Option<BlockMatrix> {
        let conductivity = &self.warm.conductivity;
        let slope = || forms::conduction_slope(&self.mesh, self.mass.graph(), conductivity, theta);
        (!conductivity.is_empty()).then(slope)
    }

    /// Derivative of the right-hand side of (4.1) by temperature at u, w and θ: that of m less those of a and b, or
    /// `None` if expansion and laws do not depend on temperature, so that m is the derivative.
    #[must_use]
    pub fn mechanical_slope(&self, u: &[f64], w: &[f64], theta: &[f64]) -> Option<BlockMatrix> {
        let warm = !self.warm.expansion.is_empty();
        if !warm && !self.softens() {
            return None;
        }
        let (mesh, graph) = (&self.mesh, self.mass.graph());
        let mut matrix = if warm {
            forms::expansion_slope(mesh, graph, &self.warm.expansion, &self.dilatation, theta)
        } else {
            self.m.clone()
        };
        for (laws, at) in [(&self.elasticity, u), (&self.viscosity, w)] {
            if laws.iter().any(|law| !law.temperatures().is_empty()) {
                let slope = forms::law_slope(mesh, graph, &borrowed(laws), &self.dilatation, [at, theta]);
                matrix.add_scaled(-1.0, &slope);
            }
        }
        Some(matrix)
    }
}
