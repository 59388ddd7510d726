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
//! Laws and tensors are lists by region of the mesh; the last entry serves the regions beyond the list. In a body of
//! revolution strains have the component 33, u_r/r, and laws and tensors act in three dimensions.
//!
//! Laws that are not linear enter by [`residual`] and [`tangent`] at a given displacement.
//!
//! j and χ, the terms on Γ_C, are evaluated at contact points in [`crate::linalg`].

mod assembly;
mod boundary;
mod load;
mod state;

use std::sync::Arc;

pub use crate::material::Dilatation;
pub use boundary::{convection, dashpots, springs};
pub(crate) use load::data_degree;
pub use load::{Load, f, q};
pub use state::{energy, residual, tangent};

use crate::element::Element;
use crate::linalg::{BlockMatrix, Graph};
use crate::material::TensorLaw;
use crate::mesh::Mesh;
use crate::tensor::{Sym, SymMap, dot};
use assembly::{Cell, assemble, of_region, strain_components};

/// Degree of the rule for products of gradients; of values too where a hoop strain enters.
fn gradient_products(mesh: &Mesh, element: &Element) -> usize {
    2 * if mesh.axisymmetric { element.gradient_degree.max(element.degree) } else { element.gradient_degree }
}

/// Degree of the rule for products of values, and of values with gradients.
fn value_products(mesh: &Mesh, element: &Element, gradients: bool) -> usize {
    element.degree + if gradients { element.gradient_degree } else { element.degree } + usize::from(mesh.axisymmetric)
}

/// (θ, η)_{L²(Ω)}, and by components (w, v)_H.
#[must_use]
pub fn inner_h(mesh: &Mesh, graph: &Arc<Graph>) -> BlockMatrix {
    weighted_inner_h(mesh, graph, &[])
}

/// ∫ c θ η with a factor c by region, such as the density or the heat capacity; [`inner_h`] where the list is empty.
#[must_use]
pub fn weighted_inner_h(mesh: &Mesh, graph: &Arc<Graph>, factors: &[f64]) -> BlockMatrix {
    let factor = |region: usize| factors.get(region).or(factors.last()).copied().unwrap_or(1.0);
    assemble(
        mesh,
        graph,
        (1, 1),
        |e| value_products(mesh, e, false),
        None,
        |cell, out| {
            cell.integrate(|cell, weight| {
                let (values, weight) = (cell.map.values(), weight * factor(cell.region));
                for (row, vi) in out.chunks_exact_mut(values.len()).zip(values) {
                    for (out, vj) in row.iter_mut().zip(values) {
                        *out += weight * vi * vj;
                    }
                }
            });
        },
    )
}

/// a(u, v) = ∫ 𝓔ε(u):ε(v) of linear laws.
#[must_use]
pub fn a(mesh: &Mesh, graph: &Arc<Graph>, elasticity: &[&dyn TensorLaw]) -> BlockMatrix {
    tensor_form(mesh, graph, elasticity, Dilatation::Full)
}

/// b(w, v) = ∫ 𝓥ε(w):ε(v) of linear laws.
#[must_use]
pub fn b(mesh: &Mesh, graph: &Arc<Graph>, viscosity: &[&dyn TensorLaw]) -> BlockMatrix {
    tensor_form(mesh, graph, viscosity, Dilatation::Full)
}

/// [`a`] or [`b`] with a choice of the strain.
#[must_use]
pub fn tensor_form(mesh: &Mesh, graph: &Arc<Graph>, laws: &[&dyn TensorLaw], dilatation: Dilatation) -> BlockMatrix {
    // A linear law is the same at every point: its map is asked for once.
    let zero = [0.0; 3];
    let maps: Vec<Option<SymMap>> = laws.iter().map(|law| law.is_linear().then(|| law.tangent(&zero, &Sym::ZERO))).collect();
    let is_symmetric = maps.iter().all(|map| map.is_some_and(|map| (0..6).all(|i| (0..i).all(|j| map.0[i][j].to_bits() == map.0[j][i].to_bits()))));
    with_map(mesh, graph, dilatation, is_symmetric, |cell| match maps.get(cell.region).or(maps.last()) {
        Some(Some(map)) => *map,
        _ => of_region(laws, cell.region).map_or(SymMap::default(), |law| law.tangent(&cell.map.position, &Sym::ZERO)),
    })
}

/// ∫ 𝓒ε(u):ε(v) with a map 𝓒 a point; half of the work is saved where every map is known to be symmetric.
fn with_map(mesh: &Mesh, graph: &Arc<Graph>, dilatation: Dilatation, is_symmetric: bool, map: impl Fn(&Cell) -> SymMap + Sync) -> BlockMatrix {
    let matrix = assemble(
        mesh,
        graph,
        (mesh.dim, mesh.dim),
        |e| gradient_products(mesh, e),
        Some(dilatation),
        |cell, out| {
            cell.integrate(|cell, weight| {
                let map = map(cell);
                match strain_components(mesh) {
                    1 => add_map::<1>(cell, weight, &map, is_symmetric, out),
                    3 => add_map::<3>(cell, weight, &map, is_symmetric, out),
                    4 => add_map::<4>(cell, weight, &map, is_symmetric, out),
                    _ => add_map::<6>(cell, weight, &map, is_symmetric, out),
                }
            });
            for i in 0..if is_symmetric { cell.fields } else { 0 } {
                for j in 0..i {
                    out[i * cell.fields + j] = out[j * cell.fields + i];
                }
            }
        },
    );
    if mesh.axisymmetric { matrix } else { matrix.of_differences() }
}

/// Adds weight ε(φ_b)·𝓒ε(φ_a) in row b and column a, from the diagonal on where half is enough. Only the leading M
/// components of a strain are not zero: component 33 of the value of a plane law does no work.
fn add_map<const M: usize>(cell: &Cell, weight: f64, map: &SymMap, is_symmetric: bool, out: &mut [f64]) {
    let fields = cell.fields;
    let rows: [&[f64]; M] = std::array::from_fn(|m| cell.strain_row(m));
    for b in 0..fields {
        let stress: [f64; M] = std::array::from_fn(|k| weight * (0..M).map(|m| map.0[m][k] * rows[m][b]).sum::<f64>());
        let from = if is_symmetric { b } else { 0 };
        let columns: [&[f64]; M] = std::array::from_fn(|m| &rows[m][from..fields]);
        for (a, out) in out[b * fields + from..(b + 1) * fields].iter_mut().enumerate() {
            *out += (0..M).map(|m| stress[m] * columns[m][a]).sum::<f64>();
        }
    }
}

/// d(θ, η) = ∫ 𝓚∇θ·∇η.
#[must_use]
pub fn d(mesh: &Mesh, graph: &Arc<Graph>, conductivity: &[&Sym]) -> BlockMatrix {
    assemble(
        mesh,
        graph,
        (1, 1),
        |e| 2 * e.gradient_degree + usize::from(mesh.axisymmetric),
        None,
        |cell, out| {
            let (Some(conductivity), n) = (of_region(conductivity, cell.region), cell.nodes.len()) else { return };
            let k: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| conductivity.get(i, j)));
            cell.integrate(|cell, weight| {
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

/// m(θ, v) = ∫ θ 𝓜:ε(v), rows v, columns θ.
#[must_use]
pub fn m(mesh: &Mesh, graph: &Arc<Graph>, expansion: &[&Sym]) -> BlockMatrix {
    assemble(
        mesh,
        graph,
        (mesh.dim, 1),
        |e| value_products(mesh, e, true),
        Some(Dilatation::Full),
        |cell, out| {
            let Some(expansion) = of_region(expansion, cell.region) else { return };
            cell.integrate(|cell, weight| {
                let values = cell.map.values();
                for (row, work) in out.chunks_exact_mut(values.len()).zip(cell.work(expansion)) {
                    for (out, value) in row.iter_mut().zip(values) {
                        *out += weight * work * value;
                    }
                }
            });
        },
    )
}

/// e(u, η) = ∫ 𝓡:ε(u) η, rows η, columns u.
#[must_use]
pub fn e(mesh: &Mesh, graph: &Arc<Graph>, coupling: &[&Sym]) -> BlockMatrix {
    let matrix = assemble(
        mesh,
        graph,
        (1, mesh.dim),
        |e| value_products(mesh, e, true),
        Some(Dilatation::Full),
        |cell, out| {
            let Some(coupling) = of_region(coupling, cell.region) else { return };
            cell.integrate(|cell, weight| {
                let (fields, values) = (cell.fields, cell.map.values());
                let work = cell.work(coupling);
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
