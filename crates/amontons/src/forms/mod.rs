//! The forms of Problem 4.1, one function per letter of the paper, assembled on the nodes of a mesh.
//!
//! | function | form | blocks |
//! |---|---|---|
//! | [`inner_h`] | (w, v)_H, (θ, η)_{L²} = ∫ θ η | 1 × 1 |
//! | [`a`], [`b`] | ∫ 𝓔ε(u):ε(v), ∫ 𝓥ε(w):ε(v) | d × d |
//! | [`d`] | ∫ 𝓚∇θ·∇η | 1 × 1 |
//! | [`m`] | ∫ θ 𝓜:ε(v) | d × 1 |
//! | [`e`] | ∫ 𝓡:ε(u) η | 1 × d |
//! | [`springs`], [`dashpots`] | ∫ (k u)·v, ∫ (c w)·v over sides | d × d |
//! | [`convection`] | ∫ h θ η over sides | 1 × 1 |
//! | [`f`], [`q`] | ∫ f₀·v + ∫_{Γ_N} f₁·v, ∫ q₀ η + heat inflow | load vectors |
//!
//! Laws and tensors are lists by region of the mesh; the last entry also serves regions beyond the list. In a body of
//! revolution strains have the component 33, u_r/r, and laws and tensors act in three dimensions.
//!
//! Coefficients may vary within a cell. The rules are those for constant coefficients: exact for products of shape
//! functions and gradients, which keeps the order of the method for smooth coefficients (Ciarlet 1978, *The Finite
//! Element Method for Elliptic Problems*, section 4.1), and gives the same result as regions if coefficients jump
//! between cells only.
//!
//! Nonlinear laws enter by [`residual`] and [`tangent`] at a given displacement, and laws that depend on the
//! temperature also at the nodal temperature. Conduction, stored heat and thermal stress are vectors of the temperature
//! if their coefficients depend on it.
//!
//! j and χ, the terms on Γ_C, are evaluated at contact points in [`crate::linalg`].

mod assembly;
mod boundary;
mod load;
mod points;
mod state;
mod stiffness;
mod thermal;

use std::sync::Arc;

pub use crate::material::Dilatation;
pub(crate) use assembly::is_mean;
pub(crate) use boundary::supports_on;
pub use boundary::{convection, dashpots, springs};
pub use load::{Load, f, mechanical_load, q, thermal_load};
pub(crate) use load::{data_degree, load_on};
pub(crate) use points::StrainPoints;
pub use state::{energy, residual, tangent};
pub(crate) use thermal::{conduction, conduction_slope, expanded, expansion_slope, law_slope, stored_heat};

use crate::arrays::{all_at_once_in_parallel, taking_part};
use crate::element::Element;
use crate::field::{InSpace, Law};
use crate::linalg::{BlockMatrix, Graph};
use crate::material::{TensorLaw, arrays};
use crate::mesh::Mesh;
use crate::tensor::{Sym, dot};
use assembly::{CellPoint, assemble, of_region};

/// (θ, η)_{L²(Ω)}, and (w, v)_H per component.
#[must_use]
pub fn inner_h(mesh: &Mesh, graph: &Arc<Graph>) -> BlockMatrix {
    weighted_inner_h(mesh, graph, &[] as &[f64])
}

/// ∫ c θ η with a factor c by region, such as the density or the heat capacity; [`inner_h`] if the list is empty.
#[must_use]
pub fn weighted_inner_h(mesh: &Mesh, graph: &Arc<Graph>, factors: &[impl InSpace<f64>]) -> BlockMatrix {
    weighted_at(mesh, graph, factors, &[])
}

/// [`weighted_inner_h`] with factors at the nodal temperature `theta`; empty for none.
pub(crate) fn weighted_at(
    mesh: &Mesh,
    graph: &Arc<Graph>,
    factors: &[impl InSpace<f64>],
    theta: &[f64],
) -> BlockMatrix {
    let factor =
        |cell: &CellPoint| factors.get(cell.region).or(factors.last()).map_or(1.0, |factor| cell.local(factor, theta));
    assemble(
        mesh,
        graph,
        (1, 1),
        |e| mesh.value_products(e, false),
        None,
        |cell, out| {
            cell.integrate(|cell, weight| {
                let (values, weight) = (cell.map.values(), weight * factor(cell));
                for (row, vi) in out.chunks_exact_mut(values.len()).zip(values) {
                    for (out, vj) in row.iter_mut().zip(values) {
                        *out += weight * vi * vj;
                    }
                }
            });
        },
    )
}

/// a(u, v) = ∫ 𝓔ε(u):ε(v) for linear laws.
#[must_use]
pub fn a(mesh: &Mesh, graph: &Arc<Graph>, elasticity: &[&Law<dyn TensorLaw>]) -> BlockMatrix {
    tensor_form(mesh, graph, elasticity, &[Dilatation::Full])
}

/// b(w, v) = ∫ 𝓥ε(w):ε(v) for linear laws.
#[must_use]
pub fn b(mesh: &Mesh, graph: &Arc<Graph>, viscosity: &[&Law<dyn TensorLaw>]) -> BlockMatrix {
    tensor_form(mesh, graph, viscosity, &[Dilatation::Full])
}

/// [`a`] or [`b`] with full or mean dilatation.
#[must_use]
pub fn tensor_form(
    mesh: &Mesh,
    graph: &Arc<Graph>,
    laws: &[&Law<dyn TensorLaw>],
    dilatation: &[Dilatation],
) -> BlockMatrix {
    let at_rest =
        |law: &Law<dyn TensorLaw>, cell: &CellPoint| taking_part(|| law.tangent(&cell.map.position, &Sym::ZERO));
    all_at_once_in_parallel(&arrays(laws), || stiffness::assemble(mesh, graph, dilatation, laws, &[], at_rest))
}

/// d(θ, η) = ∫ 𝓚∇θ·∇η.
#[must_use]
pub fn d<K: InSpace<Sym>>(mesh: &Mesh, graph: &Arc<Graph>, conductivity: &[&K]) -> BlockMatrix {
    d_at(mesh, graph, conductivity, &[])
}

/// [`d`] with 𝓚 at the nodal temperature `theta`; empty for none.
pub(crate) fn d_at<K: InSpace<Sym>>(
    mesh: &Mesh,
    graph: &Arc<Graph>,
    conductivity: &[&K],
    theta: &[f64],
) -> BlockMatrix {
    assemble(
        mesh,
        graph,
        (1, 1),
        |e| mesh.flux_products(e),
        None,
        |cell, out| {
            let (Some(conductivity), n) = (of_region(conductivity, cell.region), cell.nodes.len()) else { return };
            let entries = |k: Sym| -> [[f64; 3]; 3] { std::array::from_fn(|i| std::array::from_fn(|j| k.get(i, j))) };
            let known = conductivity.constant().map(entries);
            cell.integrate(|cell, weight| {
                let k = known.unwrap_or_else(|| entries(cell.local(conductivity, theta)));
                for (j, g) in cell.map.gradients.iter().enumerate() {
                    let flux = k.map(|row| dot(&row, g));
                    for (i, g) in cell.map.gradients.iter().enumerate() {
                        out[i * n + j] += weight * dot(&flux, g);
                    }
                }
            });
        },
    )
    .of_differences()
}

/// m(θ, v) = ∫ θ 𝓜:ε(v), rows v, columns θ, with the same strain as a and b: with another strain, thermal stress in
/// nearly incompressible bodies would still lock.
#[must_use]
pub fn m(mesh: &Mesh, graph: &Arc<Graph>, expansion: &[&impl InSpace<Sym>], dilatation: &[Dilatation]) -> BlockMatrix {
    let tensor = |cell: &CellPoint| of_region(expansion, cell.region).map(|m| m.at(&cell.map.position));
    works(mesh, graph, dilatation, |e| mesh.value_products(e, true), tensor)
}

/// ∫ θ 𝓣:ε(v) with a tensor at each point, rows v, columns θ; `None` if there is no tensor.
fn works(
    mesh: &Mesh,
    graph: &Arc<Graph>,
    dilatation: &[Dilatation],
    degree: impl Fn(&Element) -> usize,
    tensor: impl Fn(&CellPoint) -> Option<Sym> + Sync,
) -> BlockMatrix {
    assemble(mesh, graph, (mesh.dim, 1), degree, Some(dilatation), |cell, out| {
        cell.integrate(|cell, weight| {
            let Some(tensor) = tensor(cell) else { return };
            let values = cell.map.values();
            for (row, work) in
                out.chunks_exact_mut(values.len() * mesh.dim).zip(cell.work(&tensor).chunks_exact(mesh.dim))
            {
                for (block, value) in row.chunks_exact_mut(mesh.dim).zip(values) {
                    for (out, work) in block.iter_mut().zip(work) {
                        *out += weight * work * value;
                    }
                }
            }
        });
    })
}

/// e(u, η) = ∫ 𝓡:ε(u) η, rows η, columns u, with the strain of [`m`].
#[must_use]
pub fn e(mesh: &Mesh, graph: &Arc<Graph>, coupling: &[&impl InSpace<Sym>], dilatation: &[Dilatation]) -> BlockMatrix {
    let matrix = assemble(
        mesh,
        graph,
        (1, mesh.dim),
        |e| mesh.value_products(e, true),
        Some(dilatation),
        |cell, out| {
            let Some(coupling) = of_region(coupling, cell.region) else { return };
            cell.integrate(|cell, weight| {
                let (fields, values) = (cell.fields, cell.map.values());
                let coupling = coupling.at(&cell.map.position);
                let work = cell.work(&coupling);
                for (row, value) in out.chunks_exact_mut(fields).zip(values) {
                    for (out, work) in row.iter_mut().zip(work) {
                        *out += weight * work * value;
                    }
                }
            });
        },
    );
    if mesh.axisymmetric { matrix } else { matrix.of_differences() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Isotropic, StressState};
    use crate::mesh::{Elements, MeshError};

    /// Every entry is summed in the order of the cells, regardless of the number of threads.
    #[test]
    fn the_number_of_threads_changes_no_bit() -> Result<(), Box<dyn std::error::Error>> {
        let matrices = |threads: usize| -> Result<Vec<f64>, Box<dyn std::error::Error>> {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
            pool.install(|| -> Result<Vec<f64>, MeshError> {
                let mesh = Mesh::box_([1.0, 0.7, 1.3], [9, 10, 11], Elements::P1)?;
                let graph = Arc::new(Graph::of_mesh(&mesh));
                let law = Isotropic::elastic(3, 2.0, 0.3, StressState::PlaneStrain).into();
                let [a, h] = [a(&mesh, &graph, &[&law]), inner_h(&mesh, &graph)];
                let blocks = |m: &BlockMatrix| {
                    (0..graph.len())
                        .flat_map(|i| m.row(i).flat_map(|(_, b)| b.to_vec()).collect::<Vec<_>>())
                        .collect::<Vec<f64>>()
                };
                let u: Vec<f64> = (0..3 * graph.len()).map(|i| (i as f64).sin()).collect();
                Ok([blocks(&a), blocks(&h), residual(&mesh, &[&law], &[Dilatation::Full], &u, &[])].concat())
            })
            .map_err(Into::into)
        };
        let one = matrices(1)?;
        for threads in [2, 3, 7] {
            assert!(matrices(threads)?.iter().zip(&one).all(|(a, b)| a.to_bits() == b.to_bits()), "{threads} threads");
        }
        Ok(())
    }
}
