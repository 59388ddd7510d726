//! Differences of functions on two meshes: exact by interpolation if the meshes are nested, otherwise exact on the
//! intersections of the cells.
//!
//! A rounded body differs from mesh to mesh: the cells of the finer mesh extend beyond those of the coarser one by the
//! distance of chord and arc. There the coarse function is extended beyond its cell.

use crate::convergence::norms::{Errors, InnerProducts, of_difference};
use crate::discretization::Discretization;
use crate::element::{Element, MAX_NODES, P1_TRIANGLE, ShapeTable};
use crate::linalg::BlockMatrix;
use crate::mesh::{CellMap, Mesh};
use crate::mesh::{CellPlace, Locator, OUTSIDE, reference_point};
use crate::quadrature::{Shape, rule};
use crate::state::State;
use crate::tensor::{Point, Sym};

/// Reason why two meshes cannot be compared.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TransferError {
    /// A point of one mesh lies outside the other.
    #[error(
        "the point ({:.6e}, {:.6e}, {:.6e}) of the reference mesh lies outside the mesh of the level: the bodies differ. For a rounded body the level must divide the level of the reference; if it does, take finer levels",
        .0[0], .0[1], .0[2]
    )]
    Outside(Point),
    /// The meshes have cells that cannot be intersected.
    #[error("meshes of {0} cells are compared only where they are nested: straight cells, each halved")]
    Cells(&'static str),
}

/// Shape functions of a triangle at a physical point.
fn barycentric(mesh: &Mesh, cell: &[u32], p: &Point) -> [f64; 3] {
    let [a, b, c] = [0, 1, 2].map(|i| &mesh.points[cell[i] as usize]);
    let cross = |o: &Point, u: &Point, v: &Point| (u[0] - o[0]) * (v[1] - o[1]) - (u[1] - o[1]) * (v[0] - o[0]);
    let area = cross(a, b, c);
    [cross(p, b, c) / area, cross(a, p, c) / area, cross(a, b, p) / area]
}

/// Comparison of coarse solutions with the reference.
pub struct Transfer<'a> {
    reference: &'a Discretization,
    coarse: &'a Mesh,
    strain: &'a BlockMatrix,
    way: Way,
}

enum Way {
    /// Nested: the coarse function is interpolated at the nodes of the reference, exactly if edges are straight.
    Interpolate(Vec<Vec<(u32, f64)>>),
    /// Not nested: squares are integrated over the intersections of the cells.
    Intersect(Vec<CommonTriangle>),
}

/// A triangle inside one cell of each mesh.
struct CommonTriangle {
    fine: CellPlace,
    coarse: CellPlace,
    corners: [Point; 3],
}

impl<'a> Transfer<'a> {
    /// Prepares the comparison of functions on `coarse` with those on the mesh of `reference`;
    /// `strain` is the form (ε(·), ε(·)) of the reference.
    ///
    /// # Errors
    /// Fails if the meshes cover different bodies.
    pub fn new(
        reference: &'a Discretization,
        strain: &'a BlockMatrix,
        coarse: &'a Mesh,
    ) -> Result<Transfer<'a>, TransferError> {
        let fine = &reference.mesh;
        let locator = Locator::new(coarse);
        let outside = || fine.points.iter().find(|p| locator.find(p).is_none());
        let located = nested(fine, &locator).or_else(|| outside().and_then(|_| rounded(fine, &locator)));
        let way = if let Some(located) = located {
            let mut values = [0.0; MAX_NODES];
            let mut entry = |&(at, x): &(CellPlace, Point)| -> Vec<(u32, f64)> {
                let (element, nodes) = locator.cell(at);
                (element.shape_functions)(&x, &mut values[..nodes.len()]);
                nodes.iter().copied().zip(values).collect()
            };
            Way::Interpolate(located.iter().map(&mut entry).collect())
        } else {
            if let Some(outside) = outside() {
                return Err(TransferError::Outside(*outside));
            }
            for mesh in [&**fine, coarse] {
                let is_linear = |element: &Element| (element.shape, element.degree) == (Shape::Triangle, 1);
                if let Some(block) = mesh.blocks.iter().find(|b| !is_linear(b.element) || mesh.axisymmetric) {
                    return Err(TransferError::Cells(block.element.name));
                }
            }
            Way::Intersect(intersections(fine, &locator))
        };
        Ok(Transfer { reference, coarse, strain, way })
    }

    /// True if the meshes are nested.
    #[must_use]
    pub fn is_nested(&self) -> bool {
        matches!(self.way, Way::Interpolate(_))
    }

    /// Errors of a coarse state against the reference state.
    #[must_use]
    pub fn errors(&self, coarse: &State, reference: &State) -> Errors {
        match &self.way {
            Way::Interpolate(entries) => {
                let dim = self.coarse.dim;
                let difference = |components: usize, coarse: &[f64], fine: &[f64]| -> Vec<f64> {
                    let mut out = fine.to_vec();
                    for (node, entries) in entries.iter().enumerate() {
                        for &(n, value) in entries {
                            for c in 0..components {
                                out[node * components + c] -= value * coarse[n as usize * components + c];
                            }
                        }
                    }
                    out
                };
                let products = InnerProducts { mass: &self.reference.mass, strain: self.strain };
                of_difference(
                    &products,
                    &difference(dim, &coarse.u, &reference.u),
                    &difference(dim, &coarse.w, &reference.w),
                    &difference(1, &coarse.theta, &reference.theta),
                )
            }
            Way::Intersect(pieces) => self.over_pieces(pieces, coarse, reference),
        }
    }

    fn over_pieces(&self, pieces: &[CommonTriangle], coarse: &State, reference: &State) -> Errors {
        let fine = &*self.reference.mesh;
        let dim = fine.dim;
        // The squared difference of two linear functions is quadratic.
        let quadrature = rule(Shape::Triangle, 2);
        let table = ShapeTable::new(&P1_TRIANGLE, 0);
        let nodes_of = |mesh: &'a Mesh, at: CellPlace| -> &'a [u32] {
            let block = &mesh.blocks[at.0 as usize];
            let n = block.element.nodes.len();
            &block.nodes[at.1 as usize * n..(at.1 as usize + 1) * n]
        };
        let (mut w2, mut u2, mut strain2, mut theta2) = (0.0, 0.0, 0.0, 0.0);
        for piece in pieces {
            let (f, c) = (nodes_of(fine, piece.fine), nodes_of(self.coarse, piece.coarse));
            let [a, b, d] = &piece.corners;
            let area2 = (b[0] - a[0]) * (d[1] - a[1]) - (b[1] - a[1]) * (d[0] - a[0]);
            let gradients = |mesh: &Mesh, nodes: &[u32], u: &[f64]| {
                let mut map = CellMap::new(mesh, &table);
                map.at(nodes, 0);
                let gradient = |i: usize, j: usize| {
                    nodes
                        .iter()
                        .enumerate()
                        .map(|(n, &node)| u[node as usize * dim + i] * map.gradients[n][j])
                        .sum::<f64>()
                };
                Sym::from_fn(dim, |i, j| 0.5 * (gradient(i, j) + gradient(j, i)))
            };
            let strain = gradients(fine, f, &reference.u) - gradients(self.coarse, c, &coarse.u);
            strain2 += 0.5 * area2 * strain.dot(&strain);
            for (at, weight) in quadrature.iter() {
                let p: Point = std::array::from_fn(|k| a[k] + at[0] * (b[k] - a[k]) + at[1] * (d[k] - a[k]));
                let (nf, nc) = (barycentric(fine, f, &p), barycentric(self.coarse, c, &p));
                let at = |values: &[f64], nodes: &[u32], shape: &[f64], components: usize, k: usize| -> f64 {
                    nodes.iter().zip(shape).map(|(&n, s)| s * values[n as usize * components + k]).sum()
                };
                let weight = weight * area2;
                for k in 0..dim {
                    u2 += weight * (at(&reference.u, f, &nf, dim, k) - at(&coarse.u, c, &nc, dim, k)).powi(2);
                    w2 += weight * (at(&reference.w, f, &nf, dim, k) - at(&coarse.w, c, &nc, dim, k)).powi(2);
                }
                theta2 += weight * (at(&reference.theta, f, &nf, 1, 0) - at(&coarse.theta, c, &nc, 1, 0)).powi(2);
            }
        }
        Errors { w: w2.sqrt(), u: strain2.sqrt(), theta: theta2.sqrt(), u_h: u2.sqrt() }
    }
}

/// Positions of the nodes of the fine mesh in the coarse one; `None` unless every cell of the fine mesh lies in a
/// coarse cell whose functions its own ones contain. A node on the faces of two bodies is located in the coarse cell of
/// its own cell.
fn nested(fine: &Mesh, coarse: &Locator) -> Option<Vec<(CellPlace, Point)>> {
    let mut located = vec![None; fine.points.len()];
    for block in &fine.blocks {
        for cell in block.cells() {
            let corners = || cell.iter().map(|&n| &fine.points[n as usize]);
            let centre: Point = std::array::from_fn(|d| corners().map(|p| p[d]).sum::<f64>() / cell.len() as f64);
            let (at, _) = coarse.find(&centre)?;
            let (element, nodes) = coarse.cell(at);
            let is_coarser = (element.shape == block.element.shape || element.is_simplex())
                && element.degree <= block.element.degree;
            if !is_coarser {
                return None;
            }
            for &node in cell {
                let x = reference_point(coarse.mesh(), element, nodes, &fine.points[node as usize])
                    .filter(|x| element.shape.depth(x) > OUTSIDE)?;
                located[node as usize].get_or_insert((at, x));
            }
        }
    }
    located.into_iter().collect()
}

/// Positions of the nodes of the fine mesh of a rounded body in the coarse one; `None` unless the numbers of cells
/// imply that it divides coarse edges into equal parts. Each node is in a cell of its region that contains it or is
/// next to it. The corners of coarse cells lie on the arcs, so functions extended from neighbouring cells to an arc
/// differ little.
fn rounded(fine: &Mesh, coarse: &Locator) -> Option<Vec<(CellPlace, Point)>> {
    let parts = (fine.cell_count() as f64 / coarse.mesh().cell_count() as f64).powf(1.0 / fine.dim as f64);
    if (parts - parts.round()).abs() > 1e-6 {
        return None;
    }
    let mut located = vec![None; fine.points.len()];
    for block in &fine.blocks {
        for &node in &block.nodes {
            let (place, p) = (&mut located[node as usize], &fine.points[node as usize]);
            if place.is_none() {
                *place = Some(coarse.find_near(p, block.region)?);
            }
        }
    }
    located.into_iter().collect()
}

/// Triangles that make up the intersections of the cells of two meshes.
fn intersections(fine: &Mesh, coarse: &Locator) -> Vec<CommonTriangle> {
    let mut pieces = Vec::new();
    for (b, block) in fine.blocks.iter().enumerate() {
        for (c, cell) in block.cells().enumerate() {
            let corners: Vec<&Point> = cell.iter().map(|&n| &fine.points[n as usize]).collect();
            let mut candidates: Vec<CellPlace> = coarse
                .range(corners.iter().copied(), 0.0)
                .into_iter()
                .flat_map(|i| coarse.bucket(i).iter().copied())
                .collect();
            candidates.sort_unstable();
            candidates.dedup();
            for at in candidates {
                let mut polygon: Vec<Point> = corners.iter().map(|&&p| p).collect();
                let (points, (_, nodes)) = (&coarse.mesh().points, coarse.cell(at));
                for k in 0..3 {
                    polygon = clip(&polygon, &points[nodes[k] as usize], &points[nodes[(k + 1) % 3] as usize]);
                }
                for k in 1..polygon.len().saturating_sub(1) {
                    pieces.push(CommonTriangle {
                        fine: (b as u32, c as u32),
                        coarse: at,
                        corners: [polygon[0], polygon[k], polygon[k + 1]],
                    });
                }
            }
        }
    }
    pieces
}

/// The part of a convex polygon to the left of the line from `a` to `b` (Sutherland and Hodgman, 1974).
fn clip(polygon: &[Point], a: &Point, b: &Point) -> Vec<Point> {
    let side = |p: &Point| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    let mut out = Vec::with_capacity(polygon.len() + 1);
    for (i, p) in polygon.iter().enumerate() {
        let q = &polygon[(i + 1) % polygon.len()];
        let (sp, sq) = (side(p), side(q));
        if sp >= 0.0 {
            out.push(*p);
        }
        if (sp > 0.0 && sq < 0.0) || (sp < 0.0 && sq > 0.0) {
            let s = sp / (sp - sq);
            out.push(std::array::from_fn(|d| p[d] + s * (q[d] - p[d])));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Diagonal, MeshError};

    /// The pieces cover the body once: their areas and a second moment are those of the rectangle.
    #[test]
    fn intersections_cover_the_body_once() -> Result<(), MeshError> {
        let fine = Mesh::rectangle([1.0, 1.0], [7, 5], Diagonal::Left)?;
        let coarse = Mesh::rectangle([1.0, 1.0], [3, 4], Diagonal::Crossed)?;
        let pieces = intersections(&fine, &Locator::new(&coarse));
        let (mut area, mut moment) = (0.0, 0.0);
        for piece in &pieces {
            let [a, b, c] = &piece.corners;
            let twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            for (at, weight) in rule(Shape::Triangle, 2).iter() {
                let x = a[0] + at[0] * (b[0] - a[0]) + at[1] * (c[0] - a[0]);
                let y = a[1] + at[0] * (b[1] - a[1]) + at[1] * (c[1] - a[1]);
                area += weight * twice;
                moment += weight * twice * x * y;
            }
        }
        assert!((area - 1.0).abs() < 1e-13 && (moment - 0.25).abs() < 1e-13, "{area} {moment}");
        Ok(())
    }

    #[test]
    fn halving_is_nested_and_thirds_are_not() -> Result<(), MeshError> {
        let coarse = Mesh::rectangle([1.0, 1.0], [4, 4], Diagonal::Right)?;
        let locator = Locator::new(&coarse);
        assert!(nested(&Mesh::rectangle([1.0, 1.0], [8, 8], Diagonal::Right)?, &locator).is_some());
        assert!(nested(&Mesh::rectangle([1.0, 1.0], [12, 8], Diagonal::Right)?, &locator).is_none());
        assert!(nested(&Mesh::rectangle([1.0, 1.0], [6, 6], Diagonal::Right)?, &locator).is_none());
        assert!(nested(&Mesh::rectangle([1.0, 1.0], [8, 8], Diagonal::Left)?, &locator).is_none());
        Ok(())
    }
}
