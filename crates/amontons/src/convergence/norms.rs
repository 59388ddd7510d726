//! Norms of the errors of (5.2): ‖w − w^{hk}‖_H, ‖ε(u − u^{hk})‖, ‖θ − θ^{hk}‖_{L²}.

use rayon::prelude::*;

use crate::element::ShapeTable;
use crate::expression::Derivatives;
use crate::field::Field;
use crate::linalg::{BlockMatrix, dot};
use crate::mesh::{CellMap, Mesh};
use crate::state::State;

/// The three errors of (5.2) at one time, and the error of the displacement in H.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Errors {
    /// ‖w − w^{hk}‖_H, m/s times a length to the power d/2.
    pub w: f64,
    /// ‖ε(u − u^{hk})‖_{L²}.
    pub u: f64,
    /// ‖θ − θ^{hk}‖_{L²}.
    pub theta: f64,
    /// ‖u − u^{hk}‖_H, which is not part of (5.2).
    pub u_h: f64,
}

impl Errors {
    /// Sum of the three errors of (5.2); its maximum over time is E^{hk}.
    #[must_use]
    pub fn sum(&self) -> f64 {
        self.w + self.u + self.theta
    }

    /// The larger value of each error.
    #[must_use]
    pub fn max(&self, other: &Errors) -> Errors {
        Errors {
            w: self.w.max(other.w),
            u: self.u.max(other.u),
            theta: self.theta.max(other.theta),
            u_h: self.u_h.max(other.u_h),
        }
    }
}

/// A solution in closed form. The velocity is the time derivative of the displacement.
#[derive(Clone, Debug, PartialEq)]
pub struct Exact {
    /// u, one field per component, m.
    pub displacement: Vec<Field>,
    /// θ in K.
    pub temperature: Field,
}

/// Degree of the rule for squared errors: its quadrature error is of higher order in h.
const DEGREE: usize = 6;
/// Number of cells summed together.
const CELLS: usize = 64;

/// Errors of a state against a closed form, integrated cell by cell.
#[must_use]
pub fn against_exact(mesh: &Mesh, state: &State, exact: &Exact) -> Errors {
    let mut sums = [0.0; 4];
    for block in &mesh.blocks {
        let table = ShapeTable::new(block.element, DEGREE.max(2 * block.element.degree + 2));
        // Chunks of a fixed size are summed in order: the same bits on any number of threads.
        let chunks: Vec<[f64; 4]> = block
            .nodes
            .par_chunks(block.element.nodes.len() * CELLS)
            .map(|nodes| {
                let (mut sums, mut map) = ([0.0; 4], CellMap::new(mesh, &table));
                for cell in nodes.chunks_exact(block.element.nodes.len()) {
                    for (q, weight) in table.weights.iter().enumerate() {
                        map.at(cell, q);
                        add_squares(&map, weight * map.measure, cell, &Compared { mesh, state, exact }, &mut sums);
                    }
                }
                sums
            })
            .collect();
        for chunk in chunks {
            for (sum, part) in sums.iter_mut().zip(chunk) {
                *sum += part;
            }
        }
    }
    let [w, u, theta, u_h] = sums.map(f64::sqrt);
    Errors { w, u, theta, u_h }
}

/// A state and the exact solution with which it is compared.
struct Compared<'a> {
    mesh: &'a Mesh,
    state: &'a State,
    exact: &'a Exact,
}

/// Adds the squared errors at one quadrature point: w, ε(u), θ, u.
fn add_squares(map: &CellMap, weight: f64, cell: &[u32], compared: &Compared, sums: &mut [f64; 4]) {
    let Compared { mesh, state, exact } = *compared;
    let (dim, values) = (mesh.dim, map.values());
    let (mut gradient, mut radial) = ([[0.0; 3]; 3], 0.0);
    for (c, row) in gradient.iter_mut().enumerate().take(dim) {
        let exact: Derivatives =
            exact.displacement.get(c).map_or(Derivatives::default(), |f| f.derivatives(&map.position, state.t));
        let (mut u, mut w) = (exact.value, exact.by_t);
        *row = exact.by_x;
        for (n, &node) in cell.iter().enumerate() {
            let dof = node as usize * dim + c;
            u -= values[n] * state.u[dof];
            w -= values[n] * state.w[dof];
            for d in 0..dim {
                row[d] -= map.gradients[n][d] * state.u[dof];
            }
        }
        sums[0] += weight * w * w;
        sums[3] += weight * u * u;
        if c == 0 {
            radial = u / map.position[0];
        }
    }
    let strain = mesh.strain(&gradient, radial);
    sums[1] += weight * strain.dot(&strain);
    let mut theta = exact.temperature.value(&map.position, state.t);
    for (n, &node) in cell.iter().enumerate() {
        theta -= values[n] * state.theta[node as usize];
    }
    sums[2] += weight * theta * theta;
}

/// The inner products required for norms on one mesh: (·, ·) and (ε(·), ε(·)).
pub struct InnerProducts<'a> {
    /// (·, ·)_{L²}.
    pub mass: &'a BlockMatrix,
    /// (ε(·), ε(·)).
    pub strain: &'a BlockMatrix,
}

/// Norms of a difference of two states on the same mesh.
#[must_use]
pub fn of_difference(products: &InnerProducts, u: &[f64], w: &[f64], theta: &[f64]) -> Errors {
    let norm = |matrix: &BlockMatrix, v: &[f64]| dot(v, &matrix.apply(v)).max(0.0).sqrt();
    Errors {
        w: norm(products.mass, w),
        u: norm(products.strain, u),
        theta: norm(products.mass, theta),
        u_h: norm(products.mass, u),
    }
}
