//! Forms of laws that are not linear, at a given displacement.

use std::sync::Arc;

use super::assembly::{Cell, by_cells, of_region, strain_components};
use super::stiffness;
use crate::linalg::{BlockMatrix, Graph};
use crate::material::{Dilatation, TensorLaw};
use crate::mesh::Mesh;
use crate::tensor::Sym;

/// The strain of the field `u`, node-major, at the point of a cell.
fn strain(cell: &Cell, u: &[f64]) -> Sym {
    let (dim, mut strain) = (cell.mesh.dim, Sym::ZERO);
    for m in 0..strain_components(cell.mesh) {
        for (entries, &node) in cell.strain_row(m).chunks_exact(dim).zip(cell.nodes) {
            for (entry, u) in entries.iter().zip(&u[node as usize * dim..]) {
                strain.0[m] += entry * u;
            }
        }
    }
    strain
}

/// The vector of ∫ 𝓔(ε(u)):ε(v), one entry a degree of freedom.
///
/// `laws` is a list by region; `u` has d components a node.
#[must_use]
pub fn residual(mesh: &Mesh, laws: &[&dyn TensorLaw], dilatation: Dilatation, u: &[f64]) -> Vec<f64> {
    let dim = mesh.dim;
    let mut out = vec![0.0; mesh.points.len() * dim];
    by_cells(
        mesh,
        |e| mesh.gradient_products(e),
        Some(dilatation),
        |e| e.nodes.len() * dim,
        |cell, force| {
            let Some(law) = of_region(laws, cell.region) else { return };
            cell.integrate(|cell, weight| {
                let stress = law.value(&cell.map.position, &strain(cell, u));
                for (force, work) in force.iter_mut().zip(cell.work(&stress)) {
                    *force += weight * work;
                }
            });
        },
        |nodes, _, forces| {
            for (&node, force) in nodes.iter().zip(forces.chunks_exact(dim)) {
                for (out, force) in out[node as usize * dim..].iter_mut().zip(force) {
                    *out += force;
                }
            }
        },
    );
    out
}

/// ∫ W(ε(u)) of the potentials of the laws, J; none if one of the laws has none.
#[must_use]
pub fn energy(mesh: &Mesh, laws: &[&dyn TensorLaw], dilatation: Dilatation, u: &[f64]) -> Option<f64> {
    let mut sum = Some(0.0);
    by_cells(
        mesh,
        |e| mesh.gradient_products(e),
        Some(dilatation),
        |_| 1,
        |cell, energy| {
            let Some(law) = of_region(laws, cell.region) else { return };
            cell.integrate(|cell, weight| {
                energy[0] += weight * law.potential(&cell.map.position, &strain(cell, u)).unwrap_or(f64::NAN);
            });
        },
        |_, _, energies| {
            let part: f64 = energies.iter().sum();
            sum = sum.filter(|_| !part.is_nan()).map(|sum| sum + part);
        },
    );
    sum
}

/// The derivative of [`residual`]: the form ∫ D𝓔(ε(u)) ε(w):ε(v), rows v and columns w.
#[must_use]
pub fn tangent(
    mesh: &Mesh,
    graph: &Arc<Graph>,
    laws: &[&dyn TensorLaw],
    dilatation: Dilatation,
    u: &[f64],
) -> BlockMatrix {
    stiffness::assemble(mesh, graph, dilatation, laws, |law, cell| {
        // Where all laws are linear, strains are not needed, and not there.
        let at = if law.is_linear() { Sym::ZERO } else { strain(cell, u) };
        law.tangent(&cell.map.position, &at)
    })
}
