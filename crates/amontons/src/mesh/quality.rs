//! The shape of cells.

use super::{CellMap, Mesh};
use crate::element::{Element, ShapeTable};
use crate::tensor::Point;

impl Mesh {
    /// The worst quality over all cells, where 1 is a regular cell and 0 a flat one.
    ///
    /// Mean ratio (Liu and Joe, 1994): d (det T)^{1/d} / tr T with T = J R Jᵀ, J the map from the reference cell and R
    /// the second moment of its nodes. R takes the place of the map to the regular cell, whose moment is a multiple of
    /// the identity, so the measure serves every element.
    ///
    /// Given with the centre of the worst cell; infinite without cells.
    #[must_use]
    pub fn worst_quality(&self) -> (f64, Point) {
        let mesh = self;
        let mut worst = (f64::INFINITY, [0.0; 3]);
        for block in &mesh.blocks {
            let element = block.element;
            let moment = moment(element, mesh.dim);
            // The map of a linear simplex is the same at every node.
            let simplex = element.degree == 1 && element.nodes.len() == mesh.dim + 1;
            let table = ShapeTable::at(element, if simplex { &element.nodes[..1] } else { element.nodes });
            let mut map = CellMap::new(mesh, &table);
            for cell in block.cells() {
                for q in 0..table.len() {
                    map.at(cell, q);
                    let quality = quality(mesh, map.jacobian, table.gradients(q), cell, &moment);
                    if quality < worst.0 {
                        worst = (quality, centre(mesh, cell));
                    }
                }
            }
        }
        worst
    }
}

/// Second moment of the nodes of the reference cell about their centre.
fn moment(element: &Element, dim: usize) -> [[f64; 3]; 3] {
    let count = element.nodes.len() as f64;
    let centre: Point = std::array::from_fn(|d| element.nodes.iter().map(|n| n[d]).sum::<f64>() / count);
    std::array::from_fn(|r| {
        std::array::from_fn(|c| {
            if r < dim && c < dim {
                element.nodes.iter().map(|n| (n[r] - centre[r]) * (n[c] - centre[c])).sum()
            } else {
                f64::from(u8::from(r == c))
            }
        })
    })
}

fn quality(mesh: &Mesh, jacobian: f64, gradients: &[Point], cell: &[u32], moment: &[[f64; 3]; 3]) -> f64 {
    let dim = mesh.dim;
    let mut j = [[0.0; 3]; 3];
    for (&node, gradient) in cell.iter().zip(gradients) {
        let p = &mesh.points[node as usize];
        for r in 0..dim {
            for c in 0..dim {
                j[r][c] += p[r] * gradient[c];
            }
        }
    }
    let trace: f64 = (0..dim)
        .map(|r| {
            (0..dim)
                .flat_map(|a| (0..dim).map(move |b| (a, b)))
                .map(|(a, b)| j[r][a] * moment[a][b] * j[r][b])
                .sum::<f64>()
        })
        .sum();
    let [m0, m1, m2] = moment;
    let cross: Point = [m1[1] * m2[2] - m1[2] * m2[1], m1[2] * m2[0] - m1[0] * m2[2], m1[0] * m2[1] - m1[1] * m2[0]];
    let determinant = jacobian * jacobian * crate::tensor::dot(m0, &cross);
    dim as f64 * determinant.powf(1.0 / dim as f64) / trace
}

fn centre(mesh: &Mesh, cell: &[u32]) -> Point {
    std::array::from_fn(|d| cell.iter().map(|&n| mesh.points[n as usize][d]).sum::<f64>() / cell.len() as f64)
}
