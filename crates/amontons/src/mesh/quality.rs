//! Measures of the shape of cells.

use super::{CellMap, Mesh};
use crate::element::{Element, ShapeTable};
use crate::tensor::{Point, Sym};

impl Mesh {
    /// The worst quality over all cells, 1 for a regular cell and 0 for a flat one.
    ///
    /// Mean ratio (Liu and Joe, 1994): d (det T)^{1/d} / tr T with T = J R Jᵀ, J the map from the reference cell and R
    /// the second moment of its nodes. R replaces the map to the regular cell, whose moment is a multiple of the
    /// identity, so the measure applies to every element.
    ///
    /// Returned with the centre of the worst cell; infinite without cells.
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

    /// The slenderness that 90 % of the cells do not exceed: ratio of the longest to the shortest semi-axis of the
    /// ellipsoid of inertia of the nodes, 1 for a regular cell. 1 without cells.
    #[must_use]
    pub fn slenderness(&self) -> f64 {
        let mut all = Vec::new();
        for block in &self.blocks {
            let element = block.element;
            let moment = moment(element, self.dim);
            let table = ShapeTable::new(element, 1);
            all.extend(block.cells().map(|cell| {
                let inertia = inertia(self, table.gradients(0), cell, &moment);
                let axes = Sym::from_fn(3, |r, c| inertia[r][c]).eigenvalues(self.dim);
                let [least, most] = axes.into_iter().fold([f64::INFINITY, 0.0], |[l, m], e| [e.min(l), e.max(m)]);
                (most / least.max(f64::MIN_POSITIVE)).sqrt()
            }));
        }
        all.sort_by(f64::total_cmp);
        all.get(all.len() - all.len().div_ceil(10)).copied().unwrap_or(1.0)
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
    let inertia = inertia(mesh, gradients, cell, moment);
    let trace: f64 = (0..dim).map(|r| inertia[r][r]).sum();
    let [m0, m1, m2] = moment;
    let cross: Point = [m1[1] * m2[2] - m1[2] * m2[1], m1[2] * m2[0] - m1[0] * m2[2], m1[0] * m2[1] - m1[1] * m2[0]];
    let determinant = jacobian * jacobian * crate::tensor::dot(m0, &cross);
    dim as f64 * determinant.powf(1.0 / dim as f64) / trace
}

/// T = J R Jᵀ.
fn inertia(mesh: &Mesh, gradients: &[Point], cell: &[u32], moment: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
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
    let entry = |r: usize, s: usize| {
        (0..dim).flat_map(|a| (0..dim).map(move |b| (a, b))).map(|(a, b)| j[r][a] * moment[a][b] * j[s][b]).sum::<f64>()
    };
    std::array::from_fn(|r| std::array::from_fn(|s| entry(r, s)))
}

fn centre(mesh: &Mesh, cell: &[u32]) -> Point {
    std::array::from_fn(|d| cell.iter().map(|&n| mesh.points[n as usize][d]).sum::<f64>() / cell.len() as f64)
}
