//! Forms of nonlinear or temperature-dependent laws, at a given displacement and temperature.

use std::sync::Arc;

use super::assembly::{CellPoint, by_cells, of_region, strain_components};
use super::stiffness;
use crate::arrays::{all_at_once_in_parallel, taking_part};
use crate::element::Element;
use crate::field::Law;
use crate::linalg::{BlockMatrix, Graph};
use crate::material::{Dilatation, TensorLaw, arrays};
use crate::mesh::Mesh;
use crate::tensor::Sym;

/// The strain of the field `u`, node-major, at the point of a cell.
pub(super) fn strain(cell: &CellPoint, u: &[f64]) -> Sym {
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

/// Applies `with` to a law at the point of a cell, at the nodal temperature `theta` if given.
fn local<R>(law: &Law<dyn TensorLaw>, cell: &CellPoint, theta: &[f64], with: impl FnOnce(&dyn TensorLaw) -> R) -> R {
    let warm = if theta.is_empty() { None } else { law.at_temperature(&cell.map.position, cell.scalar(theta)) };
    taking_part(|| with(warm.as_deref().unwrap_or(law.as_ref())))
}

/// The vector of ∫ 𝓔(ε(u)):ε(v), one entry per degree of freedom.
///
/// `laws` is a list by region; `u` has d components per node, and `theta` the temperature per node, or is empty.
#[must_use]
pub fn residual(
    mesh: &Mesh,
    laws: &[&Law<dyn TensorLaw>],
    dilatation: &[Dilatation],
    u: &[f64],
    theta: &[f64],
) -> Vec<f64> {
    let value = |cell: &CellPoint| {
        let law = of_region(laws, cell.region)?;
        let strain = strain(cell, u);
        Some(local(law, cell, theta, |law| law.value(&cell.map.position, &strain)))
    };
    all_at_once_in_parallel(&arrays(laws), || vector(mesh, dilatation, |e| mesh.gradient_products(e), value))
}

/// The vector of ∫ 𝓣:ε(v) with a tensor at each point; `None` if there is no tensor.
pub(super) fn vector(
    mesh: &Mesh,
    dilatation: &[Dilatation],
    degree: impl Fn(&Element) -> usize,
    tensor: impl Fn(&CellPoint) -> Option<Sym> + Sync,
) -> Vec<f64> {
    let dim = mesh.dim;
    let mut out = vec![0.0; mesh.points.len() * dim];
    by_cells(
        mesh,
        degree,
        Some(dilatation),
        |e| e.nodes.len() * dim,
        |cell, force| {
            cell.integrate(|cell, weight| {
                let Some(stress) = tensor(cell) else { return };
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

/// ∫ W(ε(u)) of the potentials of the laws, J; `None` if one of the laws has none.
#[must_use]
pub fn energy(
    mesh: &Mesh,
    laws: &[&Law<dyn TensorLaw>],
    dilatation: &[Dilatation],
    u: &[f64],
    theta: &[f64],
) -> Option<f64> {
    let of_cell = |cell: &mut CellPoint, energy: &mut [f64]| {
        let Some(law) = of_region(laws, cell.region) else { return };
        cell.integrate(|cell, weight| {
            let strain = strain(cell, u);
            let potential = local(law, cell, theta, |law| law.potential(&cell.map.position, &strain));
            energy[0] += weight * potential.unwrap_or(f64::NAN);
        });
    };
    all_at_once_in_parallel(&arrays(laws), || {
        let mut sum = Some(0.0);
        let add = |_: &[u32], _: usize, energies: &[f64]| {
            let part: f64 = energies.iter().sum();
            sum = sum.filter(|_| !part.is_nan()).map(|sum| sum + part);
        };
        by_cells(mesh, |e| mesh.gradient_products(e), Some(dilatation), |_| 1, of_cell, add);
        sum
    })
}

/// The derivative of [`residual`]: the form ∫ D𝓔(ε(u)) ε(w):ε(v), rows v and columns w.
#[must_use]
pub fn tangent(
    mesh: &Mesh,
    graph: &Arc<Graph>,
    laws: &[&Law<dyn TensorLaw>],
    dilatation: &[Dilatation],
    u: &[f64],
    theta: &[f64],
) -> BlockMatrix {
    let tangent = |law: &Law<dyn TensorLaw>, cell: &CellPoint| {
        // If all laws are linear, strains are neither needed nor available.
        let at = if law.is_linear() { Sym::ZERO } else { strain(cell, u) };
        local(law, cell, theta, |law| law.tangent(&cell.map.position, &at))
    };
    all_at_once_in_parallel(&arrays(laws), || stiffness::assemble(mesh, graph, dilatation, laws, &[], tangent))
}
