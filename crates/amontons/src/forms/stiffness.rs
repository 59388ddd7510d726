//! The forms ∫ 𝓒ε(u):ε(v) of laws, with a map 𝓒 per point.

use std::sync::Arc;

use super::assembly::{CellPoint, assemble as sum, of_region, strain_components};
use crate::field::Law;
use crate::linalg::{BlockMatrix, Graph};
use crate::material::{Dilatation, TensorLaw};
use crate::mesh::Mesh;
use crate::tensor::{Point, Sym, SymMap, mandel_index, mandel_weight};

/// A map on 𝕊^d with its components `full[q][s][r][c]` = 𝓒_rscq, ordered for the sums over q and s.
struct Stiffness {
    map: SymMap,
    full: [[[[f64; 3]; 3]; 3]; 3],
}

impl Stiffness {
    /// The components in the first `dim` directions.
    fn new(map: &SymMap, dim: usize) -> Stiffness {
        let mut full = [[[[0.0; 3]; 3]; 3]; 3];
        for (q, s) in (0..dim).flat_map(|q| (0..dim).map(move |s| (q, s))) {
            for (r, c) in (0..dim).flat_map(|r| (0..dim).map(move |c| (r, c))) {
                full[q][s][r][c] =
                    map.0[mandel_index(r, s)][mandel_index(c, q)] / (mandel_weight(r, s) * mandel_weight(c, q));
            }
        }
        Stiffness { map: *map, full }
    }

    fn is_symmetric(&self) -> bool {
        (0..6).all(|i| (0..i).all(|j| self.map.0[i][j].to_bits() == self.map.0[j][i].to_bits()))
    }
}

/// The matrix of laws with `tangent` at each point, times a factor per point if there are factors. Laws that are linear
/// and constant are evaluated once.
pub(super) fn assemble(
    mesh: &Mesh,
    graph: &Arc<Graph>,
    dilatation: &[Dilatation],
    laws: &[&Law<dyn TensorLaw>],
    factor: &[f64],
    tangent: impl Fn(&Law<dyn TensorLaw>, &CellPoint) -> SymMap + Sync,
) -> BlockMatrix {
    let known: Vec<Option<Stiffness>> = laws
        .iter()
        .map(|law| {
            let uniform = law.is_linear() && law.graded().is_none();
            uniform.then(|| Stiffness::new(&law.tangent(&[0.0; 3], &Sym::ZERO), mesh.dim))
        })
        .collect();
    // For a symmetric matrix half is enough; a nonlinear law may have any tangent.
    let is_linear = laws.iter().all(|law| law.is_linear());
    let is_symmetric = is_linear && known.iter().flatten().all(Stiffness::is_symmetric);
    // Without mean dilatation and hoop strain the strain of N e_c follows from the gradient alone, but a
    // strain-dependent tangent still needs strains.
    let by_gradients = !dilatation.contains(&Dilatation::Mean) && !mesh.axisymmetric;
    let strains = if by_gradients && is_linear { None } else { Some(dilatation) };
    let matrix = sum(
        mesh,
        graph,
        (mesh.dim, mesh.dim),
        |e| mesh.gradient_products(e),
        strains,
        |cell, out| {
            let Some(law) = of_region(laws, cell.region) else { return };
            let known = known.get(cell.region).or(known.last()).and_then(Option::as_ref);
            cell.integrate(|cell, weight| {
                let here = if known.is_none() { Some(Stiffness::new(&tangent(law, cell), mesh.dim)) } else { None };
                let Some(map) = known.or(here.as_ref()) else { return };
                let weight = factor.get(cell.point).map_or(weight, |factor| weight * factor);
                match (by_gradients, mesh.dim) {
                    (true, 1) => by_pairs::<1>(&cell.map.gradients, weight, map, is_symmetric, out),
                    (true, 2) => by_pairs::<2>(&cell.map.gradients, weight, map, is_symmetric, out),
                    (true, _) => by_pairs::<3>(&cell.map.gradients, weight, map, is_symmetric, out),
                    (false, _) => by_strains(cell, weight, &map.map, is_symmetric, out),
                }
            });
            if is_symmetric {
                mirror(cell.nodes.len(), mesh.dim, out);
            }
        },
    );
    if mesh.axisymmetric { matrix } else { matrix.of_differences() }
}

/// Adds the blocks `K_ij[r][c]` = Σ 𝓒_rscq ∂_s N_i ∂_q N_j of pairs of nodes, only for i ≤ j if symmetric.
fn by_pairs<const D: usize>(gradients: &[Point], weight: f64, map: &Stiffness, is_symmetric: bool, out: &mut [f64]) {
    let n = gradients.len();
    for (j, g) in gradients.iter().enumerate() {
        // Stress of N_j e_c: rows s, then r and c.
        let mut stress = [[[0.0; D]; D]; D];
        for q in 0..D {
            let g = weight * g[q];
            for s in 0..D {
                for r in 0..D {
                    for c in 0..D {
                        stress[s][r][c] += g * map.full[q][s][r][c];
                    }
                }
            }
        }
        let rows = if is_symmetric { j + 1 } else { n };
        for (i, g) in gradients.iter().enumerate().take(rows) {
            let block = out[(i * n + j) * D * D..][..D * D].as_chunks_mut::<D>().0;
            for (r, row) in block.iter_mut().enumerate() {
                for (c, entry) in row.iter_mut().enumerate() {
                    *entry += (0..D).map(|s| g[s] * stress[s][r][c]).sum::<f64>();
                }
            }
        }
    }
}

/// Adds ε(φ_i)·𝓒ε(φ_j) for all basis fields of a cell from the rows of their strains.
fn by_strains(cell: &CellPoint, weight: f64, map: &SymMap, is_symmetric: bool, out: &mut [f64]) {
    match strain_components(cell.mesh) {
        1 => strain_products::<1>(cell, weight, map, is_symmetric, out),
        3 => strain_products::<3>(cell, weight, map, is_symmetric, out),
        4 => strain_products::<4>(cell, weight, map, is_symmetric, out),
        _ => strain_products::<6>(cell, weight, map, is_symmetric, out),
    }
}

/// Uses the M leading components of strains, which alone are nonzero: component 33 of a plane law does no work.
fn strain_products<const M: usize>(cell: &CellPoint, weight: f64, map: &SymMap, is_symmetric: bool, out: &mut [f64]) {
    let (n, d) = (cell.nodes.len(), cell.mesh.dim);
    let rows: [&[f64]; M] = std::array::from_fn(|m| cell.strain_row(m));
    for j in 0..n {
        for c in 0..d {
            let stress: [f64; M] =
                std::array::from_fn(|k| weight * (0..M).map(|m| map.0[k][m] * rows[m][j * d + c]).sum::<f64>());
            for i in 0..if is_symmetric { j + 1 } else { n } {
                for r in 0..d {
                    out[((i * n + j) * d + r) * d + c] += (0..M).map(|m| stress[m] * rows[m][i * d + r]).sum::<f64>();
                }
            }
        }
    }
}

/// K_ji = K_ijᵀ from the blocks i ≤ j.
fn mirror(n: usize, d: usize, out: &mut [f64]) {
    for j in 0..n {
        for i in 0..j {
            for r in 0..d {
                for c in 0..d {
                    out[((j * n + i) * d + c) * d + r] = out[((i * n + j) * d + r) * d + c];
                }
            }
        }
    }
}
