//! Readable values on Γ_C: means about the vertices of quadratic facets.
//!
//! A node of a stuck contact keeps the traction that it had when the edge of contact passed it, and quadratic facets
//! resolve that edge differently at vertices and at middle nodes. Tractions there alternate from node to node, while
//! their resultants are right. The readable value is the mean about each vertex,
//!
//! ```text
//!     v̄ = Σ ω_i φ(x_i) v_i / Σ ω_i φ(x_i),
//! ```
//!
//! with φ the linear function of the vertex. Inside a side it is the value at the vertex, up to second order. At the
//! end of a side all points lie to one side of the vertex; there it is the value of the linear function closest to the
//! v_i of the facet in the mean square.

use std::collections::{BTreeMap, BTreeSet};

use faer::Mat;
use faer::prelude::Solve;

use super::boundary::{ContactBoundary, Lumping};
use crate::element::Element;
use crate::mesh::{FacetMap, FacetSet, Mesh};
use crate::tensor::{Point, length};

/// Contact points with their weights in a value.
pub type Shares = Vec<(usize, f64)>;

/// The weighted sum of a number at contact points, limited to the range of these values, which the linear function at
/// the end of a side may leave if the contact ends in the facet.
#[must_use]
pub fn read(shares: &[(usize, f64)], value: impl Fn(usize) -> f64) -> f64 {
    let values = || shares.iter().map(|&(i, _)| value(i));
    let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
    let sum: f64 = shares.iter().map(|&(i, share)| share * value(i)).sum();
    if low <= high { sum.clamp(low, high) } else { sum }
}

/// The weighted sum of a vector, limited to the length of the longest one.
#[must_use]
pub fn read_vector(shares: &[(usize, f64)], value: impl Fn(usize) -> Point) -> Point {
    let longest = shares.iter().map(|&(i, _)| length(&value(i))).fold(0.0, f64::max);
    let sum = shares.iter().fold([0.0; 3], |sum, &(i, share)| {
        let value = value(i);
        std::array::from_fn(|c| sum[c] + share * value[c])
    });
    let found = length(&sum);
    if found > longest { sum.map(|c| c * (longest / found)) } else { sum }
}

/// Weighted sums of shares by contact point, and the sum of the weights.
#[derive(Default)]
struct WeightedSum {
    shares: BTreeMap<usize, f64>,
    weight: f64,
}

impl WeightedSum {
    fn add(&mut self, shares: impl Iterator<Item = (usize, f64)>, weight: f64) {
        for (point, share) in shares {
            *self.shares.entry(point).or_default() += weight * share;
        }
        self.weight += weight;
    }

    fn mean(self) -> Shares {
        self.shares
            .into_iter()
            .map(|(point, share)| (point, share / self.weight))
            .filter(|(_, share)| *share != 0.0)
            .collect()
    }
}

impl ContactBoundary {
    /// Contact points of a side with their shares in the value at each of its vertices, as described at the top of this
    /// file. For linear facets these are the nodal values; with Gauss points each point stands alone.
    #[must_use]
    pub fn vertex_means(&self, mesh: &Mesh, side: usize, set: &FacetSet) -> Vec<Shares> {
        match self.points_of_nodes(side) {
            Some(own) => means(mesh, set, &own).into_values().collect(),
            None => self
                .points
                .iter()
                .enumerate()
                .filter(|(_, point)| point.contact == side)
                .map(|(i, _)| vec![(i, 1.0)])
                .collect(),
        }
    }

    /// The readable value at each contact point of a side: the mean about the vertex, or the interpolated means at a
    /// middle node. If vertices bear no contact points (triangles of six nodes), with linear facets and with Gauss
    /// points it is the value itself.
    #[must_use]
    pub fn readable(&self, mesh: &Mesh, side: usize, set: &FacetSet) -> Vec<(usize, Shares)> {
        let on_side = self.points.iter().enumerate().filter(|(_, point)| point.contact == side);
        let alone = || on_side.clone().map(|(i, _)| (i, vec![(i, 1.0)])).collect();
        let Some(own) = self.points_of_nodes(side) else { return alone() };
        let means = means(mesh, set, &own);
        if means.keys().any(|vertex| !own.contains_key(vertex)) {
            return alone();
        }
        let mut readable: BTreeMap<usize, Shares> = BTreeMap::new();
        for block in &set.blocks {
            let (linear, vertices) = (linear(block.element), block.element.shape.vertices());
            let mut values = vec![0.0; linear.nodes.len()];
            for facet in block.nodes.chunks_exact(block.element.nodes.len()) {
                for (at, point) in
                    block.element.nodes.iter().zip(facet).filter_map(|(at, node)| Some((at, *own.get(node)?)))
                {
                    (linear.shape_functions)(at, &mut values);
                    let mut sum = WeightedSum::default();
                    for (vertex, &value) in facet.iter().zip(&values).take(vertices).filter(|(_, value)| **value > 0.0)
                    {
                        sum.add(means.get(vertex).into_iter().flatten().copied(), value);
                    }
                    readable.insert(point, sum.mean());
                }
            }
        }
        readable.into_iter().collect()
    }

    /// The contact point of each node of a side; `None` with Gauss points, which depend on several nodes.
    fn points_of_nodes(&self, side: usize) -> Option<BTreeMap<u32, usize>> {
        let on_side = self.points.iter().enumerate().filter(|(_, point)| point.contact == side);
        on_side
            .map(|(i, point)| match point.nodes[..] {
                [(node, _)] => Some((*self.nodes.get(node)?, i)),
                _ => None,
            })
            .collect()
    }
}

/// The shares of contact points in the value at each vertex of a side.
fn means(mesh: &Mesh, set: &FacetSet, own: &BTreeMap<u32, usize>) -> BTreeMap<u32, Shares> {
    let ends = ends(set);
    let mut sums: BTreeMap<u32, WeightedSum> = BTreeMap::new();
    for block in &set.blocks {
        let (n, vertices) = (block.element.nodes.len(), block.element.shape.vertices());
        let phi = at_nodes(block.element);
        let lumping = Lumping::new(mesh, block.element);
        let mut map = FacetMap::new(mesh, &lumping.table);
        for facet in block.nodes.chunks_exact(n) {
            let weights = lumping.weights(&mut map, facet);
            // Σ ω φ_v φ_w: its row sums are Σ ω φ_v.
            let gram = Mat::from_fn(vertices, vertices, |v, w| {
                (0..n).map(|i| weights[i] * phi[i][v] * phi[i][w]).sum::<f64>()
            });
            let fit = gram.partial_piv_lu().solve(Mat::from_fn(vertices, n, |v, i| weights[i] * phi[i][v]));
            for (v, vertex) in facet.iter().take(vertices).enumerate() {
                let weight: f64 = (0..n).map(|i| weights[i] * phi[i][v]).sum();
                let share =
                    |i: usize| if ends.contains(vertex) { fit[(v, i)] } else { weights[i] * phi[i][v] / weight };
                let shares = facet.iter().enumerate().filter_map(|(i, node)| Some((*own.get(node)?, share(i))));
                sums.entry(*vertex).or_default().add(shares, weight);
            }
        }
    }
    sums.into_iter().map(|(vertex, sum)| (vertex, sum.mean())).collect()
}

/// The linear element of the same shape.
fn linear(element: &'static Element) -> &'static Element {
    Element::find(element.shape, 1).unwrap_or(element)
}

/// The linear functions of the vertices at the nodes of an element.
fn at_nodes(element: &'static Element) -> Vec<Vec<f64>> {
    let linear = linear(element);
    let of = |at| {
        let mut values = vec![0.0; linear.nodes.len()];
        (linear.shape_functions)(at, &mut values);
        values
    };
    element.nodes.iter().map(of).collect()
}

/// Vertices at the ends of a side: of a curve the vertices of a single facet, of a surface those of edges with a single
/// facet.
fn ends(set: &FacetSet) -> BTreeSet<u32> {
    let mut seen: BTreeMap<Vec<u32>, usize> = BTreeMap::new();
    for block in &set.blocks {
        let vertices = block.element.shape.vertices();
        for facet in block.nodes.chunks_exact(block.element.nodes.len()) {
            for v in 0..vertices {
                let mut edge = if vertices > 2 { vec![facet[v], facet[(v + 1) % vertices]] } else { vec![facet[v]] };
                edge.sort_unstable();
                *seen.entry(edge).or_default() += 1;
            }
        }
    }
    seen.into_iter().filter(|(_, count)| *count == 1).flat_map(|(edge, _)| edge).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Quadrature;
    use crate::mesh::{Diagonal, Elements, MeshError};

    /// A linear function is reproduced at every vertex and, by the vertices, at every point, on uneven meshes of every
    /// flat cell; values that alternate between vertices and middle nodes with zero resultant on each facet average to
    /// zero.
    #[test]
    fn linear_functions_are_read_exactly_at_the_ends_and_alternations_vanish() -> Result<(), MeshError> {
        for elements in [Elements::P1, Elements::P2, Elements::Q1, Elements::Q2] {
            let plane = Mesh::rectangle_of(elements, [2.0, 1.0], [4, 2], Diagonal::Left)?;
            let body = Mesh::box_([2.0, 1.0, 3.0], [4, 1, 3], elements)?;
            for mesh in [plane, body] {
                let set = &mesh.facets["bottom"];
                let boundary = ContactBoundary::new(&mesh, set, Quadrature::Nodal);
                let linear = |i: usize| 3.0 + 0.7 * boundary.points[i].x[0] - 0.4 * boundary.points[i].x[2];
                let read = |shares: &Shares, value: &dyn Fn(usize) -> f64| {
                    shares.iter().map(|&(i, share)| share * value(i)).sum::<f64>()
                };
                let readable = boundary.readable(&mesh, 0, set);
                assert_eq!(readable.len(), boundary.points.len());
                for (i, shares) in &readable {
                    assert!(
                        (read(shares, &linear) - linear(*i)).abs() < 1e-13,
                        "{elements:?} d = {} at {:?}",
                        mesh.dim,
                        boundary.points[*i].x
                    );
                }
                // In the plane: 2 at vertices and −1 at middle nodes, with Simpson's weights 1, 4, 1 over a facet
                // 2 − 4 + 2 = 0.
                if mesh.dim == 2 && elements != Elements::P1 && elements != Elements::Q1 {
                    let alternating =
                        |i: usize| if (2.0 * boundary.points[i].x[0]).fract() == 0.0 { 2.0 } else { -1.0 };
                    assert!(
                        boundary
                            .vertex_means(&mesh, 0, set)
                            .iter()
                            .all(|shares| read(shares, &alternating).abs() < 1e-14)
                    );
                }
            }
        }
        Ok(())
    }

    /// A contact that ends within the last facet of a side: the linear function nearest to 0, 0, 3 at its nodes is
    /// negative at the open end, where 0 is read; the other end stays within the range, too. A traction is no longer
    /// than the longest one it is made of, whatever its direction.
    #[test]
    fn what_is_read_stays_within_the_range_of_the_values() -> Result<(), MeshError> {
        let mesh = Mesh::rectangle_of(Elements::Q2, [1.0, 1.0], [1, 1], Diagonal::Left)?;
        let set = &mesh.facets["bottom"];
        let boundary = ContactBoundary::new(&mesh, set, Quadrature::Nodal);
        let pressure = |i: usize| if boundary.points[i].x[0] > 0.9 { 3.0 } else { 0.0 };
        let mut least = f64::INFINITY;
        for shares in boundary.vertex_means(&mesh, 0, set) {
            least = least.min(shares.iter().map(|&(i, share)| share * pressure(i)).sum());
            assert!((0.0..=3.0).contains(&read(&shares, pressure)));
            for angle in [0.0f64, 0.7, 2.0, 4.0] {
                let traction = |i: usize| -> Point { [angle.cos() * pressure(i), angle.sin() * pressure(i), 0.0] };
                assert!(length(&read_vector(&shares, traction)) <= 3.0 * (1.0 + 1e-15));
            }
        }
        // Simpson's weights 1, 4, 1: the fit at the open end is 2 (p₀ + 2 p_m)/3 − (p₁ + 2 p_m)/3 = −1.
        assert!((least + 1.0).abs() < 1e-14, "{least}");
        Ok(())
    }
}
