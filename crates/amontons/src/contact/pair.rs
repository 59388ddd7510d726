//! The second body of a contact.

use std::sync::Arc;

use super::mortar::{Mortar, Sides};
use super::{Contact, ContactBoundary, PointOnBoundary, Side};

use crate::list::List;
use crate::mesh::{FacetSet, Link, Mesh, cross};
use crate::tensor::Point;

/// When the points of a pair that face each other are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Geometry {
    /// From the bodies at rest, once.
    #[default]
    Reference,
    /// In each step, from the displaced bodies at its start.
    Updated,
}

/// The other side of a pair, on a deformable body.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    /// Name of the facet set that the side `on` faces.
    pub with: String,
    /// Whether `on` is the mortar side: the points are then on `with`.
    pub on_is_mortar: bool,
    /// When the pairing is made.
    pub geometry: Geometry,
    /// Whether the gap is the datum alone, and not that of the geometry.
    pub gap_is_given: bool,
    /// Whether bodies that overlap at rest are taken to touch there.
    pub closes: bool,
}

impl Pair {
    /// The side `with` as mortar side of a pair that keeps the pairing of the bodies at rest, with the gap of the
    /// geometry.
    #[must_use]
    pub fn new(with: impl Into<String>) -> Pair {
        Pair {
            with: with.into(),
            on_is_mortar: false,
            geometry: Geometry::Reference,
            gap_is_given: false,
            closes: false,
        }
    }

    /// Whether the pairing is made anew in each step.
    #[must_use]
    pub fn is_updated(&self) -> bool {
        self.geometry == Geometry::Updated
    }
}

/// What is known of the motion of the nodes of a body.
#[derive(Clone, Copy)]
pub struct Supports<'a> {
    /// The directions in which the displacement of a node is prescribed, filled up with zeros.
    pub held: &'a dyn Fn(u32) -> [Point; 3],
    /// Nodes that follow others.
    pub links: &'a [Link],
}

impl Supports<'_> {
    /// Nothing holds a node, and none follows another one.
    pub const NONE: Supports<'static> = Supports { held: &|_| [[0.0; 3]; 3], links: &[] };
}

impl Contact {
    /// The rows of a pair on a mesh with the nodes at `x`; none where the foundation is rigid. Of a pairing
    /// that is updated all vertices have a row.
    #[must_use]
    pub fn mortar(&self, mesh: &Mesh, x: &[Point], supports: Supports) -> Option<Mortar> {
        static NONE: FacetSet = FacetSet { blocks: Vec::new() };
        let [nonmortar, mortar] = [self.bearing(), self.facing()?].map(|side| mesh.facets.get(side).unwrap_or(&NONE));
        let is_updated = self.pair.as_ref().is_some_and(Pair::is_updated);
        Some(Mortar::new(&Sides { mesh, x, nonmortar, mortar, supports }, is_updated))
    }

    /// The side of the contact with its points on the bodies at rest.
    #[must_use]
    pub fn side<'a>(&self, mesh: &'a Mesh, supports: Supports<'a>) -> Side<'a> {
        static NONE: FacetSet = FacetSet { blocks: Vec::new() };
        let set = |side: &str| mesh.facets.get(side).unwrap_or(&NONE);
        let Some(mut mortar) = self.mortar(mesh, &mesh.points, supports) else {
            return Side::Foundation(set(&self.on), self.quadrature, supports.links);
        };
        if self.pair.as_ref().is_some_and(|pair| pair.closes) {
            mortar.rows.iter_mut().for_each(|row| row.gap = row.gap.max(0.0));
        }
        let is_updated = self.pair.as_ref().is_some_and(Pair::is_updated);
        let all = || self.sides().flat_map(|side| set(side).node_list()).collect();
        Side::Pair(mortar, if is_updated { all() } else { Vec::new() })
    }
}

impl ContactBoundary {
    /// The boundary with the pairs that are updated made anew on bodies with the displacement `u`; none without such a
    /// pair.
    #[must_use]
    pub fn updated(
        &self,
        contacts: &[Contact],
        mesh: &Mesh,
        u: &[f64],
        supports: Supports,
    ) -> Option<Arc<ContactBoundary>> {
        let is_updated = |contact: &Contact| contact.pair.as_ref().is_some_and(Pair::is_updated);
        if !contacts.iter().any(is_updated) {
            return None;
        }
        let mut x = mesh.points.clone();
        for (x, u) in x.iter_mut().zip(u.chunks_exact(mesh.dim)) {
            x.iter_mut().zip(u).for_each(|(x, u)| *x += u);
        }
        let pairs = contacts.iter().enumerate().filter(|(_, contact)| is_updated(contact));
        let made: Vec<_> = pairs.filter_map(|(i, contact)| Some((i, contact.mortar(mesh, &x, supports)?))).collect();
        let mut boundary = self.with(mesh, &made);
        // r = ν·B u − g with u from the bodies at rest: g = −ν·(B X), and by how much an overlap was closed.
        let of_pairs = boundary.points.iter_mut().zip(&self.points);
        for (point, at_rest) in of_pairs.filter(|(point, _)| made.iter().any(|(i, _)| *i == point.contact)) {
            let closed = at_rest.gap - boundary_gap(&self.nodes, mesh, at_rest);
            point.gap = boundary_gap(&self.nodes, mesh, point) + closed;
        }
        Some(Arc::new(boundary))
    }
}

impl ContactBoundary {
    /// The moment of the forces on both bodies of each of so many contacts, N m, with tractions λ on what the bearing
    /// sides face: −Σ ω (B X) × λ, zero where λ is along the distance B X. Pairs that are updated are where they are
    /// with the displacement `u`. Zero at foundations.
    pub(crate) fn moments(
        &self,
        contacts: &[Contact],
        mesh: &Mesh,
        u: &[f64],
        lambda: impl Iterator<Item = Point>,
    ) -> List<Point> {
        let mut all = List::filled([0.0; 3], contacts.len());
        for (point, lambda) in self.points.iter().zip(lambda) {
            let Some(pair) = contacts.get(point.contact).and_then(|contact| contact.pair.as_ref()) else { continue };
            let at_rest = self.jump_of(point, mesh);
            let moved = if pair.is_updated() { self.vector_at(point, mesh.dim, u) } else { [0.0; 3] };
            let x: Point = std::array::from_fn(|c| at_rest[c] + moved[c]);
            let moment = cross(&x, &lambda);
            if let Some(sum) = all.get_mut(point.contact) {
                sum.iter_mut().zip(moment).for_each(|(sum, moment)| *sum -= point.weight * moment);
            }
        }
        all
    }

    /// B X of the bodies at rest.
    fn jump_of(&self, point: &PointOnBoundary, mesh: &Mesh) -> Point {
        point.nodes.iter().fold([0.0; 3], |sum, &(node, value)| {
            let x = mesh.points[self.nodes[node] as usize];
            std::array::from_fn(|c| sum[c] + value * x[c])
        })
    }
}

/// −ν·(B X) of the bodies at rest.
fn boundary_gap(nodes: &[u32], mesh: &Mesh, point: &PointOnBoundary) -> f64 {
    if point.own == point.nodes.len() {
        return point.gap;
    }
    let along =
        |(node, value): &(usize, f64)| value * crate::tensor::dot(&mesh.points[nodes[*node] as usize], &point.normal);
    0.0 - point.nodes.iter().map(along).sum::<f64>()
}
