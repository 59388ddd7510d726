//! What is computed cell by cell from a state: stresses, and the norm of V.

use crate::element::{Element, MAX_NODES};
use crate::mesh::{CellMap, Mesh};
use crate::problem::Problem;
use crate::quadrature::rule;
use crate::scheme::State;
use crate::tensor::{Point, Sym};

/// The stress of one cell, at its centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellStress {
    /// Total stress σ of (2.1), Pa.
    pub stress: Sym,
    /// Von Mises stress in Pa.
    pub von_mises: f64,
    /// Region of the cell, an index into the regions of the mesh.
    pub region: usize,
}

/// The total stress σ = 𝓔ε(u) + 𝓥ε(w) − θ𝓜 at the centre of every cell, block by block.
#[must_use]
pub fn cell_stresses(problem: &Problem, state: &State) -> Vec<CellStress> {
    let mesh = &problem.mesh;
    let mut stresses = Vec::with_capacity(mesh.cell_count());
    for block in &mesh.blocks {
        let centre = centre(block.element);
        for cell in block.cells() {
            let map = CellMap::new(mesh, block.element, cell, &centre);
            let theta = cell.iter().zip(&map.values).map(|(&node, value)| value * state.theta[node as usize]).sum();
            let stress = problem.material.stress(&map.position, &strain(mesh.dim, &map, cell, &state.u), &strain(mesh.dim, &map, cell, &state.w), theta);
            stresses.push(CellStress { stress, von_mises: stress.von_mises(), region: block.region });
        }
    }
    stresses
}

/// ‖ε(v)‖_{L²} of a vector field, node-major: the norm of V.
#[must_use]
pub fn strain_norm(mesh: &Mesh, v: &[f64]) -> f64 {
    let mut sum = 0.0;
    for block in &mesh.blocks {
        let rule = rule(block.element.shape, 2 * block.element.degree.saturating_sub(1));
        for cell in block.cells() {
            for (at, weight) in rule.iter() {
                let map = CellMap::new(mesh, block.element, cell, at);
                let strain = strain(mesh.dim, &map, cell, v);
                sum += weight * map.determinant * strain.dot(&strain);
            }
        }
    }
    sum.sqrt()
}

/// ε(v) = ½(∇v + ∇vᵀ) at the point of a map.
fn strain(dim: usize, map: &CellMap, cell: &[u32], v: &[f64]) -> Sym {
    let mut gradient = [[0.0; 3]; 3];
    for (&node, g) in cell.iter().zip(&map.gradients).take(MAX_NODES) {
        for i in 0..dim {
            for j in 0..dim {
                gradient[i][j] += v[node as usize * dim + i] * g[j];
            }
        }
    }
    Sym::from_fn(dim, |i, j| 0.5 * (gradient[i][j] + gradient[j][i]))
}

/// The mean of the nodes of a reference cell.
fn centre(element: &Element) -> Point {
    let n = element.nodes.len() as f64;
    std::array::from_fn(|d| element.nodes.iter().map(|p| p[d]).sum::<f64>() / n)
}
