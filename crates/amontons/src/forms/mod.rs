//! The forms of Problem 4.1, one function a letter of the paper, assembled on the nodes of a mesh.
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
//! j and χ, the terms on Γ_C, are evaluated at contact points in [`crate::linalg`].

mod boundary;
mod load;

use std::sync::Arc;

pub use boundary::{convection, dashpots, springs};
pub(crate) use load::data_degree;
pub use load::{Load, f, q};

use crate::element::Element;
use crate::linalg::{BlockMatrix, Graph};
use crate::material::TensorLaw;
use crate::mesh::{CellMap, Mesh};
use crate::quadrature::rule;
use crate::tensor::{MANDEL, Point, Sym, mandel_len, mandel_weight};

/// Sums `form(map, matrix of the cell, weight)` over the quadrature points of all cells.
fn assemble(
    mesh: &Mesh,
    graph: &Arc<Graph>,
    shape: (usize, usize),
    degree: impl Fn(&Element) -> usize,
    form: impl Fn(&CellMap, f64, usize, &mut [f64]),
) -> BlockMatrix {
    let mut matrix = BlockMatrix::zero(graph, shape.0, shape.1);
    for block in &mesh.blocks {
        let n = block.element.nodes.len();
        let rule = rule(block.element.shape, degree(block.element));
        let mut cell_matrix = vec![0.0; n * n * shape.0 * shape.1];
        for cell in block.cells() {
            cell_matrix.fill(0.0);
            for (at, weight) in rule.iter() {
                let map = CellMap::new(mesh, block.element, cell, at);
                form(&map, weight * map.determinant, n, &mut cell_matrix);
            }
            matrix.add(cell, &cell_matrix);
        }
    }
    matrix
}

/// Mandel components of ε(v) for the vector field v = N e_c with gradient `g` of N.
fn strain_of(dim: usize, g: &Point, c: usize) -> Sym {
    let mut strain = Sym::ZERO;
    for (s, &(i, j)) in MANDEL.iter().enumerate().take(mandel_len(dim)) {
        // ε_ij = (∂_j v_i + ∂_i v_j)/2, times the Mandel weight.
        let e = 0.5 * ((if i == c { g[j] } else { 0.0 }) + (if j == c { g[i] } else { 0.0 }));
        strain.0[s] = mandel_weight(i, j) * e;
    }
    strain
}

/// (θ, η)_{L²(Ω)}, and by components (w, v)_H.
#[must_use]
pub fn inner_h(mesh: &Mesh, graph: &Arc<Graph>) -> BlockMatrix {
    assemble(
        mesh,
        graph,
        (1, 1),
        |e| 2 * e.degree,
        |map, weight, n, out| {
            for i in 0..n {
                for j in 0..n {
                    out[i * n + j] += weight * map.values[i] * map.values[j];
                }
            }
        },
    )
}

/// a(u, v) = ∫ 𝓔ε(u):ε(v) of a linear law.
#[must_use]
pub fn a(mesh: &Mesh, graph: &Arc<Graph>, elasticity: &dyn TensorLaw) -> BlockMatrix {
    tensor_form(mesh, graph, elasticity)
}

/// b(w, v) = ∫ 𝓥ε(w):ε(v) of a linear law.
#[must_use]
pub fn b(mesh: &Mesh, graph: &Arc<Graph>, viscosity: &dyn TensorLaw) -> BlockMatrix {
    tensor_form(mesh, graph, viscosity)
}

fn tensor_form(mesh: &Mesh, graph: &Arc<Graph>, law: &dyn TensorLaw) -> BlockMatrix {
    let dim = mesh.dim;
    assemble(
        mesh,
        graph,
        (dim, dim),
        |e| 2 * (e.degree - 1),
        |map, weight, n, out| {
            let tangent = law.tangent(&map.position, &Sym::ZERO);
            let width = n * dim;
            for j in 0..n {
                for c in 0..dim {
                    let stress = weight * tangent.apply(&strain_of(dim, &map.gradients[j], c));
                    for i in 0..n {
                        for r in 0..dim {
                            // Components 33 of a plane law do no work: the strain has none.
                            out[(i * dim + r) * width + j * dim + c] += stress.dot(&strain_of(dim, &map.gradients[i], r));
                        }
                    }
                }
            }
        },
    )
    .of_differences()
}

/// d(θ, η) = ∫ 𝓚∇θ·∇η.
#[must_use]
pub fn d(mesh: &Mesh, graph: &Arc<Graph>, conductivity: &Sym) -> BlockMatrix {
    assemble(
        mesh,
        graph,
        (1, 1),
        |e| 2 * (e.degree - 1),
        |map, weight, n, out| {
            for j in 0..n {
                let flux = conductivity.apply(&map.gradients[j]);
                for i in 0..n {
                    out[i * n + j] += weight * crate::tensor::dot(&flux, &map.gradients[i]);
                }
            }
        },
    )
    .of_differences()
}

/// m(θ, v) = ∫ θ 𝓜:ε(v), rows v, columns θ.
#[must_use]
pub fn m(mesh: &Mesh, graph: &Arc<Graph>, expansion: &Sym) -> BlockMatrix {
    let dim = mesh.dim;
    assemble(
        mesh,
        graph,
        (dim, 1),
        |e| 2 * e.degree - 1,
        |map, weight, n, out| {
            for i in 0..n {
                for r in 0..dim {
                    let work = weight * expansion.dot(&strain_of(dim, &map.gradients[i], r));
                    for j in 0..n {
                        out[(i * dim + r) * n + j] += work * map.values[j];
                    }
                }
            }
        },
    )
}

/// e(u, η) = ∫ 𝓡:ε(u) η, rows η, columns u.
#[must_use]
pub fn e(mesh: &Mesh, graph: &Arc<Graph>, coupling: &Sym) -> BlockMatrix {
    let dim = mesh.dim;
    assemble(
        mesh,
        graph,
        (1, dim),
        |e| 2 * e.degree - 1,
        |map, weight, n, out| {
            for j in 0..n {
                for c in 0..dim {
                    let heat = weight * coupling.dot(&strain_of(dim, &map.gradients[j], c));
                    for i in 0..n {
                        out[i * n * dim + j * dim + c] += heat * map.values[i];
                    }
                }
            }
        },
    )
    .of_differences()
}
