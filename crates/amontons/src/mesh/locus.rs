//! Facets selected by position: on a plane, on a cylinder, within a box.

use super::{FacetMap, FacetSet, Mesh};
use crate::element::{Element, ShapeTable};
use crate::tensor::{Point, dot, length, minus};

/// Distance of a vertex from a surface, in edges of its facet, up to which it lies on the surface: more than the
/// rounding of coordinates in a file, and far less than the distance to the next vertex.
const ON: f64 = 1e-3;
/// Such a distance relative to the size of the mesh, for facets without edges and for rounded file coordinates.
const ROUNDING: f64 = 1e-9;

/// A set of points, or of directions, in which facets lie. A facet lies in a set of points if all its vertices do.
#[derive(Clone, Debug, PartialEq)]
pub enum Locus {
    /// A plane; in two dimensions a line, in one a point.
    Plane {
        /// A point of the plane, m.
        point: Point,
        /// The normal, of either sign.
        normal: Point,
    },
    /// The region between two corners.
    Box {
        /// Least coordinates, m.
        from: Point,
        /// Largest coordinates, m.
        to: Point,
    },
    /// The surface of a circular cylinder; in two dimensions a circle.
    Cylinder {
        /// A point of the axis, m.
        point: Point,
        /// Direction of the axis; in two dimensions z.
        axis: Point,
        /// Radius in m.
        radius: f64,
    },
    /// The surface of a ball.
    Sphere {
        /// Its centre, m.
        point: Point,
        /// Its radius in m.
        radius: f64,
    },
    /// The region within a distance of a point.
    Near {
        /// The point, m.
        point: Point,
        /// The distance in m.
        distance: f64,
    },
    /// The outward normal at the centre of the facet makes at most this angle with a direction.
    Normal {
        /// The direction.
        direction: Point,
        /// The angle in rad.
        angle: f64,
    },
}

/// The component of a vector along a direction, and the length of the remainder.
fn parts(v: &Point, direction: &Point) -> (f64, f64) {
    let size = length(direction);
    let unit = direction.map(|c| c / size);
    let along = dot(v, &unit);
    (along, length(&std::array::from_fn(|c| v[c] - along * unit[c])))
}

impl Locus {
    /// True if a point lies in it within a tolerance in m; always true for a locus of directions.
    fn has(&self, x: &Point, within: f64) -> bool {
        match self {
            Locus::Plane { point, normal } => parts(&minus(x, point), normal).0.abs() <= within,
            Locus::Box { from, to } => (0..3).all(|c| x[c] >= from[c] - within && x[c] <= to[c] + within),
            Locus::Cylinder { point, axis, radius } => (parts(&minus(x, point), axis).1 - radius).abs() <= within,
            Locus::Sphere { point, radius } => (length(&minus(x, point)) - radius).abs() <= within,
            Locus::Near { point, distance } => length(&minus(x, point)) <= distance + within,
            Locus::Normal { .. } => true,
        }
    }

    /// True if a normal is one of its directions; always true for a locus of points.
    fn faces(&self, normal: &Point) -> bool {
        let Locus::Normal { direction, angle } = self else { return true };
        let (along, across) = parts(normal, direction);
        // Directions of files and facets are rounded, too.
        across.atan2(along) <= angle + ROUNDING
    }
}

impl Mesh {
    /// The facets of a set that lie in all these loci.
    #[must_use]
    pub fn facets_in(&self, set: &FacetSet, loci: &[Locus]) -> FacetSet {
        let rounding = ROUNDING * self.extent();
        let mut found = FacetSet::default();
        for block in &set.blocks {
            let table = ShapeTable::new(block.element, 0);
            let mut map = FacetMap::new(self, &table);
            for nodes in block.nodes.chunks_exact(block.element.nodes.len()) {
                let corners = nodes.get(..block.element.shape.vertices()).unwrap_or(nodes);
                let within = rounding.max(ON * self.longest_edge(block.element, nodes));
                map.at(nodes, 0);
                let lies = |locus: &Locus| {
                    let mut points = corners.iter().filter_map(|&node| self.points.get(node as usize));
                    locus.faces(&map.normal) && points.all(|x| locus.has(x, within))
                };
                if loci.iter().all(lies) {
                    found.push(block.element, nodes.iter().copied());
                }
            }
        }
        found
    }

    /// Longest distance of two vertices of a facet; zero for a point.
    fn longest_edge(&self, element: &Element, nodes: &[u32]) -> f64 {
        if element.dim() == 0 { 0.0 } else { self.edges(element, nodes).1 }
    }

    /// Largest difference of the coordinates of two nodes.
    fn extent(&self) -> f64 {
        let spread = |d: usize| {
            let along = || self.points.iter().map(|x| x[d]);
            along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
        };
        (0..self.dim).map(spread).fold(0.0, f64::max)
    }

    /// The union of several facet sets without repetition, in the order of the sets.
    #[must_use]
    pub fn union(sets: &[&FacetSet]) -> FacetSet {
        let (mut all, mut seen) = (FacetSet::default(), std::collections::HashSet::new());
        for (element, nodes) in sets.iter().flat_map(|set| set.facets()) {
            if seen.insert(super::facets::facet_key(element, nodes.iter().copied())) {
                all.push(element, nodes.iter().copied());
            }
        }
        all
    }
}
