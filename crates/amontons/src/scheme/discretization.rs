//! Problem 4.1 on a mesh: spaces, matrices, loads and the contact boundary.

use std::sync::Arc;

use crate::contact::ContactBoundary;
use crate::field::Field;
use crate::forms;
use crate::linalg::{BlockMatrix, Graph};
use crate::mesh::Mesh;
use crate::problem::Problem;
use crate::space::Space;

/// Everything about the discrete problem that does not change with time.
#[derive(Debug)]
pub struct Discretization {
    /// The mesh.
    pub mesh: Arc<Mesh>,
    /// V^h.
    pub v: Space,
    /// Q^h.
    pub q: Space,
    /// (·, ·)_{L²}, on scalars and by components on vectors.
    pub mass: BlockMatrix,
    /// a.
    pub a: BlockMatrix,
    /// b.
    pub b: BlockMatrix,
    /// d.
    pub d: BlockMatrix,
    /// m, from temperatures to forces.
    pub m: BlockMatrix,
    /// e, from displacements to heat.
    pub e: BlockMatrix,
    /// f(t).
    pub f: forms::Load,
    /// q_h(t).
    pub q_h: forms::Load,
    /// Γ_C; without nodes where there is no contact.
    pub boundary: ContactBoundary,
}

impl Discretization {
    /// Assembles the forms of a problem.
    #[must_use]
    pub fn new(problem: &Problem) -> Discretization {
        let mesh = Arc::clone(&problem.mesh);
        let graph = Arc::new(Graph::of_mesh(&mesh));
        let v = Space::new(&mesh, mesh.dim, problem.boundary.iter().filter_map(|b| Some((b.on.as_str(), b.displacement.as_deref()?))));
        let q = Space::new(&mesh, 1, problem.boundary.iter().filter_map(|b| Some((b.on.as_str(), std::slice::from_ref(b.temperature.as_ref()?)))));
        let material = &problem.material;
        let boundary = problem
            .contact
            .as_ref()
            .and_then(|contact| Some(ContactBoundary::new(&mesh, mesh.facets.get(&contact.on)?, contact.quadrature)))
            .unwrap_or(ContactBoundary { nodes: Vec::new(), points: Vec::new() });
        Discretization {
            mass: forms::inner_h(&mesh, &graph),
            a: forms::a(&mesh, &graph, material.elasticity.as_ref()),
            b: forms::b(&mesh, &graph, material.viscosity.as_ref()),
            d: forms::d(&mesh, &graph, &material.conductivity),
            m: forms::m(&mesh, &graph, &material.expansion),
            e: forms::e(&mesh, &graph, &material.coupling),
            f: forms::f(&mesh, &problem.body_force, &problem.boundary),
            q_h: forms::q(&mesh, &problem.heat_source, &problem.boundary),
            boundary,
            v,
            q,
            mesh,
        }
    }

    /// K_u = ρM/k + B + kA.
    #[must_use]
    pub fn mechanical_matrix(&self, density: f64, k: f64) -> BlockMatrix {
        let mut matrix = self.b.clone();
        matrix.add_scaled(k, &self.a);
        matrix.add_scaled(density / k, &self.mass);
        matrix
    }

    /// K_θ = C/k + D, C the mass matrix times the heat capacity.
    #[must_use]
    pub fn thermal_matrix(&self, heat_capacity: f64, k: f64) -> BlockMatrix {
        let mut matrix = self.d.clone();
        matrix.add_scaled(heat_capacity / k, &self.mass);
        matrix
    }

    /// Values of a field at the contact points.
    #[must_use]
    pub fn at_contact(&self, field: &Field, t: f64) -> Vec<f64> {
        let points: Vec<_> = self.boundary.points.iter().map(|p| p.x).collect();
        field.values(&points, t)
    }

    /// ‖v‖ in H or L², and ‖ε(v)‖ where `strain` holds the form (ε(·), ε(·)).
    #[must_use]
    pub fn norm(&self, matrix: &BlockMatrix, v: &[f64]) -> f64 {
        crate::linalg::dot(v, &matrix.apply(v)).max(0.0).sqrt()
    }
}
