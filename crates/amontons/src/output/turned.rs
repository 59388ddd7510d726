//! The rotation of a side or a region: the rotation of the rigid motion nearest to its displacements.
//!
//! s and ω minimize ∫ |u − s − ω × (x − c)|². About the centre c they decouple, and J ω = ∫ (x − c) × u with the
//! inertia J = ∫ |r|² 1 − r ⊗ r, r = x − c.

use super::Snapshot;
use crate::element::{Element, ShapeTable};
use crate::mesh::{CellMap, FacetMap, FacetSet, Mesh, cross};
use crate::tensor::{Point, Sym, dot, length};

/// Fraction of the largest inertia that counts as zero: points on a line have none about the line.
const NOTHING: f64 = 1e-12;

/// Contributions of nodal displacements to the rotation.
#[derive(Debug)]
pub(super) struct Turned {
    /// Nodes with ∫ N (x − c), m^d.
    nodes: Vec<(u32, Point)>,
    /// The principal axes with nonzero inertia, with their inertia.
    axes: Vec<(f64, Point)>,
}

/// Points of a rule: nodes with the values of their shape functions, weight, and position.
type Points = Vec<(Vec<(u32, f64)>, f64, Point)>;

/// The rule that is exact for products of two displacements.
fn table(element: &'static Element) -> ShapeTable {
    ShapeTable::new(element, 2 * element.degree + 1)
}

impl Turned {
    /// The rotation of a side, an edge or points, or `None` for a single point.
    pub(super) fn of_set(mesh: &Mesh, set: &FacetSet) -> Option<Turned> {
        let mut points = Points::new();
        for block in &set.blocks {
            let table = table(block.element);
            let mut map = FacetMap::new(mesh, &table);
            for facet in block.nodes.chunks_exact(block.element.nodes.len()) {
                for (q, weight) in table.weights.iter().enumerate() {
                    map.at(facet, q);
                    let nodes = facet.iter().copied().zip(map.values().iter().copied()).collect();
                    points.push((nodes, weight * map.area, map.position));
                }
            }
        }
        Turned::new(mesh, &points)
    }

    /// The rotation of a region, by its number.
    pub(super) fn of_region(mesh: &Mesh, region: usize) -> Option<Turned> {
        let mut points = Points::new();
        for block in mesh.blocks.iter().filter(|block| block.region == region) {
            let table = table(block.element);
            let mut map = CellMap::new(mesh, &table);
            for cell in block.cells() {
                for (q, weight) in table.weights.iter().enumerate() {
                    map.at(cell, q);
                    let nodes = cell.iter().copied().zip(map.values().iter().copied()).collect();
                    points.push((nodes, weight * map.measure, map.position));
                }
            }
        }
        Turned::new(mesh, &points)
    }

    fn new(mesh: &Mesh, points: &Points) -> Option<Turned> {
        let measure: f64 = points.iter().map(|(_, weight, _)| weight).sum();
        let centre: Point = std::array::from_fn(|c| points.iter().map(|(_, w, x)| w * x[c]).sum::<f64>() / measure);
        let mut arms = vec![[0.0; 3]; mesh.points.len()];
        let mut inertia = Sym::ZERO;
        for (nodes, weight, x) in points {
            let r: Point = std::array::from_fn(|c| x[c] - centre[c]);
            for (node, value) in nodes {
                for (sum, r) in arms.get_mut(*node as usize)?.iter_mut().zip(r) {
                    *sum += weight * value * r;
                }
            }
            let square = dot(&r, &r);
            let of_point = |i: usize, j: usize| if i == j { square - r[i] * r[j] } else { -r[i] * r[j] };
            inertia += *weight * Sym::from_fn(3, of_point);
        }
        // In the plane the only axis is the normal.
        let all = if mesh.dim == 3 { inertia.principal_axes() } else { [(inertia.get(2, 2), [0.0, 0.0, 1.0]); 3] };
        let largest = all.iter().fold(0.0, |most: f64, (value, _)| most.max(*value));
        let count = if mesh.dim == 3 { 3 } else { 1 };
        let axes: Vec<_> = all.into_iter().take(count).filter(|(value, _)| *value > NOTHING * largest).collect();
        let nodes = (0u32..).zip(arms).filter(|(_, arm)| length(arm) > 0.0).collect();
        (!axes.is_empty()).then_some(Turned { nodes, axes })
    }

    /// The rotation ω, rad.
    pub(super) fn value(&self, now: &Snapshot) -> Point {
        let (n, u) = (now.problem.mesh.dim, &now.state.u);
        let at = |node: u32| -> Point {
            std::array::from_fn(|c| if c < n { u.get(node as usize * n + c).copied().unwrap_or(f64::NAN) } else { 0.0 })
        };
        // The displacement of one node is subtracted: it causes no rotation, but may be much larger.
        let first = self.nodes.first().map_or([0.0; 3], |(node, _)| at(*node));
        let mut moment = [0.0; 3];
        for (node, arm) in &self.nodes {
            let u = at(*node);
            let more = cross(arm, &std::array::from_fn(|c| u[c] - first[c]));
            moment = std::array::from_fn(|c| moment[c] + more[c]);
        }
        let about = |c: usize| self.axes.iter().map(|(inertia, axis)| dot(&moment, axis) / inertia * axis[c]).sum();
        std::array::from_fn(about)
    }
}
