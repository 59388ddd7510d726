//! Problem 4.1 on a mesh: spaces, matrices, loads and the contact boundary.

use std::sync::Arc;

use crate::contact::ContactBoundary;
use crate::field::Field;
use crate::forms;
use crate::linalg::{BlockMatrix, Graph, mechanical_products};
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
    /// Springs at the boundary, which act beside a.
    pub springs: Option<BlockMatrix>,
    /// Dashpots at the boundary, which act beside b.
    pub dashpots: Option<BlockMatrix>,
    /// Convection at the boundary, which acts beside d.
    pub convection: Option<BlockMatrix>,
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
        let (v, q) = (problem.displacement_space(), problem.temperature_space());
        let material = &problem.material;
        let boundary = problem
            .contact
            .as_ref()
            .and_then(|contact| Some(ContactBoundary::new(&mesh, mesh.facets.get(&contact.on)?, contact.quadrature)))
            .unwrap_or(ContactBoundary { nodes: Vec::new(), points: Vec::new() });
        Discretization {
            mass: forms::inner_h(&mesh, &graph),
            a: forms::a(&mesh, &graph, &[material.elasticity.as_ref()]),
            b: forms::b(&mesh, &graph, &[material.viscosity.as_ref()]),
            d: forms::d(&mesh, &graph, &[&material.conductivity]),
            m: forms::m(&mesh, &graph, &[&material.expansion]),
            e: forms::e(&mesh, &graph, &[&material.coupling]),
            springs: forms::springs(&mesh, &graph, &problem.boundary),
            dashpots: forms::dashpots(&mesh, &graph, &problem.boundary),
            convection: forms::convection(&mesh, &graph, &problem.boundary),
            f: forms::f(&mesh, &problem.body_force, &problem.boundary),
            q_h: forms::q(&mesh, &problem.heat_source, &problem.boundary),
            boundary,
            v,
            q,
            mesh,
        }
    }

    /// K_u = ρM/k + B + kA, B with the dashpots and A with the springs.
    #[must_use]
    pub fn mechanical_matrix(&self, density: f64, k: f64) -> BlockMatrix {
        let mut matrix = self.b.clone();
        for (factor, form) in [(k, Some(&self.a)), (k, self.springs.as_ref()), (1.0, self.dashpots.as_ref()), (density / k, Some(&self.mass))] {
            if let Some(form) = form {
                matrix.add_scaled(factor, form);
            }
        }
        matrix
    }

    /// K_θ = C/k + D, C the mass matrix times the heat capacity and D with the convection.
    #[must_use]
    pub fn thermal_matrix(&self, heat_capacity: f64, k: f64) -> BlockMatrix {
        let mut matrix = self.d.clone();
        if let Some(convection) = &self.convection {
            matrix.add_scaled(1.0, convection);
        }
        matrix.add_scaled(heat_capacity / k, &self.mass);
        matrix
    }

    /// a(u, ·) with the springs.
    #[must_use]
    pub fn apply_a(&self, u: &[f64]) -> Vec<f64> {
        with(self.a.apply(u), self.springs.as_ref(), u)
    }

    /// b(w, ·) with the dashpots.
    #[must_use]
    pub fn apply_b(&self, w: &[f64]) -> Vec<f64> {
        with(self.b.apply(w), self.dashpots.as_ref(), w)
    }

    /// d(θ, ·) with the convection.
    #[must_use]
    pub fn apply_d(&self, theta: &[f64]) -> Vec<f64> {
        with(self.d.apply(theta), self.convection.as_ref(), theta)
    }

    /// M w, a(u, ·), a(w, ·) and b(w, ·), the latter three with springs and dashpots.
    #[must_use]
    pub fn mechanical_products(&self, u: &[f64], w: &[f64]) -> [Vec<f64>; 4] {
        let [mass_w, a_u, a_w, b_w] = mechanical_products(&self.mass, &self.a, &self.b, u, w);
        let springs = self.springs.as_ref();
        [mass_w, with(a_u, springs, u), with(a_w, springs, w), with(b_w, self.dashpots.as_ref(), w)]
    }

    /// Heat that leaves through convection beyond what the surroundings send in: ∫ h θ.
    #[must_use]
    pub fn convected(&self, theta: &[f64]) -> f64 {
        self.convection.as_ref().map_or(0.0, |convection| convection.apply(theta).iter().sum())
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

/// The sum of a product with that of a form at the boundary.
fn with(mut product: Vec<f64>, form: Option<&BlockMatrix>, x: &[f64]) -> Vec<f64> {
    if let Some(form) = form {
        for (sum, term) in product.iter_mut().zip(form.apply(x)) {
            *sum += term;
        }
    }
    product
}
