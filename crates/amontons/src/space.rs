//! Degrees of freedom: node-major components, some of them prescribed.

use crate::field::Field;
use crate::mesh::Mesh;
use crate::tensor::Point;

/// A space of P1 functions with d or 1 components, prescribed on parts of the boundary: V^h or Q^h.
#[derive(Clone, Debug)]
pub struct Space {
    /// Components a node.
    pub components: usize,
    /// Which degrees of freedom are unknown.
    pub free: Vec<bool>,
    prescribed: Vec<Prescribed>,
}

/// One component that is prescribed on a facet set.
#[derive(Clone, Copy, Debug)]
pub struct Prescription<'a> {
    /// Name of the side, the edge or the points.
    pub on: &'a str,
    /// The component.
    pub component: usize,
    /// Its value, up to the factor.
    pub field: &'a Field,
    /// Factor of the field: −1 where the field is given along the outward normal and the axis points inward.
    pub factor: f64,
}

#[derive(Clone, Debug)]
struct Prescribed {
    field: Field,
    factor: f64,
    points: Vec<Point>,
    dofs: Vec<u32>,
}

impl Space {
    /// The space in which some components are prescribed on parts of the boundary.
    /// At a node of two facet sets the prescription of a component that comes first holds.
    pub fn new<'a>(mesh: &Mesh, components: usize, prescriptions: impl IntoIterator<Item = Prescription<'a>>) -> Space {
        let mut free = vec![true; mesh.points.len() * components];
        let mut prescribed = Vec::new();
        for Prescription { on, component, field, factor } in prescriptions {
            let Some(set) = mesh.named(on).filter(|_| component < components) else { continue };
            let mut part = Prescribed { field: field.clone(), factor, points: Vec::new(), dofs: Vec::new() };
            for node in set.node_list() {
                let dof = node as usize * components + component;
                if free[dof] {
                    free[dof] = false;
                    part.dofs.push(dof as u32);
                    part.points.push(mesh.points[node as usize]);
                }
            }
            prescribed.push(part);
        }
        Space { components, free, prescribed }
    }

    /// Which components of a node are prescribed.
    #[must_use]
    pub fn held(&self, node: u32) -> [bool; 3] {
        let free = |c: usize| self.free.get(node as usize * self.components + c).copied().unwrap_or(true);
        std::array::from_fn(|c| c < self.components && !free(c))
    }

    /// Number of unknowns.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.free.iter().filter(|&&f| f).count()
    }

    /// Whether every prescribed value is the number zero.
    #[must_use]
    pub fn is_homogeneous(&self) -> bool {
        self.prescribed.iter().all(|p| p.field.is_zero())
    }

    /// Writes the prescribed values at time t into a vector over all degrees of freedom.
    pub fn prescribe(&self, t: f64, values: &mut [f64]) {
        for part in &self.prescribed {
            for (&dof, value) in part.dofs.iter().zip(part.field.values(&part.points, t)) {
                values[dof as usize] = part.factor * value;
            }
        }
    }

    /// Largest magnitude of the entries that are free: those of an equation that is solved.
    #[must_use]
    pub fn largest(&self, values: &[f64]) -> f64 {
        let free = values.iter().zip(&self.free).filter(|(_, free)| **free);
        free.fold(0.0, |most, (value, _)| most.max(value.abs()))
    }

    /// The entries of prescribed degrees of freedom, in their order.
    #[must_use]
    pub fn prescribed_of(&self, values: &[f64]) -> Vec<f64> {
        values.iter().zip(&self.free).filter(|(_, free)| !**free).map(|(value, _)| *value).collect()
    }

    /// Sets the entries of prescribed degrees of freedom to zero.
    pub fn mask(&self, values: &mut [f64]) {
        for (value, &free) in values.iter_mut().zip(&self.free) {
            if !free {
                *value = 0.0;
            }
        }
    }

    /// The interpolant of fields, one per component (zero where there are none).
    #[must_use]
    pub fn interpolate(&self, mesh: &Mesh, fields: &[Field], t: f64) -> Vec<f64> {
        let mut values = vec![0.0; mesh.points.len() * self.components];
        for (c, field) in fields.iter().enumerate().take(self.components) {
            for (node, value) in field.values(&mesh.points, t).into_iter().enumerate() {
                values[node * self.components + c] = value;
            }
        }
        values
    }
}
