//! What is computed cell by cell from a state: stresses, and the norm of V.

use crate::element::Table;
use crate::mesh::{CellMap, Mesh};
use crate::problem::Problem;
use crate::scheme::State;
use crate::tensor::Sym;

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
        let Some(material) = problem.material_of(block.region) else { continue };
        let table = Table::at(block.element, &[block.element.centre()]);
        let mut map = CellMap::new(mesh, &table);
        for cell in block.cells() {
            map.at(cell, 0);
            let theta = cell.iter().zip(map.values()).map(|(&node, value)| value * state.theta[node as usize]).sum();
            let stress = material.stress(&map.position, &strain(mesh, &map, cell, &state.u), &strain(mesh, &map, cell, &state.w), theta);
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
        let degree = if mesh.axisymmetric { block.element.gradient_degree.max(block.element.degree) } else { block.element.gradient_degree };
        let table = Table::new(block.element, 2 * degree);
        let mut map = CellMap::new(mesh, &table);
        for cell in block.cells() {
            for (q, weight) in table.weights.iter().enumerate() {
                map.at(cell, q);
                let strain = strain(mesh, &map, cell, v);
                sum += weight * map.measure * strain.dot(&strain);
            }
        }
    }
    sum.sqrt()
}

/// ε(v) = ½(∇v + ∇vᵀ) at the point of a map.
fn strain(mesh: &Mesh, map: &CellMap, cell: &[u32], v: &[f64]) -> Sym {
    let (dim, mut gradient, mut radial) = (mesh.dim, [[0.0; 3]; 3], 0.0);
    for ((&node, g), value) in cell.iter().zip(&map.gradients).zip(map.values()) {
        for i in 0..dim {
            for j in 0..dim {
                gradient[i][j] += v[node as usize * dim + i] * g[j];
            }
        }
        radial += value * v[node as usize * dim];
    }
    mesh.strain(&gradient, radial / map.position[0])
}
