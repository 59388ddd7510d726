//! The second body of a contact.

use std::collections::BTreeSet;
use std::sync::{Arc, OnceLock};

use super::mortar::{FacingSides, Mortar};
use super::{Contact, ContactBoundary, PointOnBoundary, Side};

use crate::mesh::{FacetSet, Link, Mesh, cross};
use crate::tensor::Point;

/// Configuration in which the facing points of a pair are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Geometry {
    /// From the bodies at rest, once.
    #[default]
    Reference,
    /// In each step, from the displaced bodies at its start.
    Updated,
}

/// The opposite side of a pair, on a deformable body.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    /// Name of the facet set that the side `on` faces.
    pub with: String,
    /// True if `on` is the mortar side: the points are then on `with`.
    pub on_is_mortar: bool,
    /// Configuration in which the pairing is made.
    pub geometry: Geometry,
    /// True if the gap is the given one alone, without the geometric gap.
    pub gap_is_given: bool,
    /// True if bodies that overlap at rest are treated as just touching there. The sides of a tie always are.
    pub closes: bool,
}

impl Pair {
    /// The side `with` as mortar side of a pair that keeps the pairing of the bodies at rest and the geometric gap.
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

    /// True if the pairing is recomputed in each step.
    #[must_use]
    pub fn is_updated(&self) -> bool {
        self.geometry == Geometry::Updated
    }
}

/// Known motion of the nodes of a body.
#[derive(Clone, Copy)]
pub struct Supports<'a> {
    /// The directions in which the displacement of a node is prescribed, filled up with zeros.
    pub held: &'a (dyn Fn(u32) -> [Point; 3] + Sync),
    /// True if the displacement of two nodes is prescribed alike in a direction.
    pub alike: &'a (dyn Fn(u32, u32, &Point) -> bool + Sync),
    /// Nodes that follow others.
    pub links: &'a [Link],
    /// The facets that bound the bodies, reused by later pairings; computed if `None`.
    pub boundary: Option<&'a OnceLock<FacetSet>>,
}

impl Supports<'_> {
    /// No node is held, and none follows another.
    pub const NONE: Supports<'static> =
        Supports { held: &|_| [[0.0; 3]; 3], alike: &|_, _, _| false, links: &[], boundary: None };
}

impl Contact {
    /// The sides of a pair on a mesh with the nodes at `x`; `None` if the foundation is rigid.
    #[must_use]
    pub fn pairing<'a>(&self, mesh: &'a Mesh, x: &'a [Point], supports: Supports<'a>) -> Option<FacingSides<'a>> {
        static NONE: FacetSet = FacetSet { blocks: Vec::new() };
        let [nonmortar, mortar] = [self.bearing(), self.facing()?].map(|side| mesh.facets.get(side).unwrap_or(&NONE));
        let keeps_all = self.pair.as_ref().is_some_and(Pair::is_updated);
        Some(FacingSides { mesh, x, nonmortar, mortar, supports, keeps_all })
    }
}

/// Mortar rows of the pairs among some contacts, by the number of the contact; `place` gives the nodal positions per
/// contact, `None` to leave the pair out. In an updated pairing all nodes have a row.
fn mortars<'a>(
    contacts: &[Contact],
    mesh: &'a Mesh,
    supports: Supports<'a>,
    place: impl Fn(&Contact) -> Option<&'a [Point]>,
) -> Vec<(usize, Mortar)> {
    let of_each = contacts.iter().enumerate();
    let (numbers, sides): (Vec<usize>, Vec<FacingSides>) =
        of_each.filter_map(|(i, contact)| Some((i, contact.pairing(mesh, place(contact)?, supports)?))).unzip();
    numbers.into_iter().zip(Mortar::all(&sides)).collect()
}

impl ContactBoundary {
    /// Γ_C of contacts on the bodies at rest; sides missing in the mesh are left out.
    #[must_use]
    pub fn of_contacts(contacts: &[Contact], mesh: &Mesh, supports: Supports) -> ContactBoundary {
        static NONE: FacetSet = FacetSet { blocks: Vec::new() };
        let set = |side: &str| mesh.facets.get(side).unwrap_or(&NONE);
        let foundation = |contact: &Contact| Side::Foundation(set(&contact.on), contact.quadrature, supports.links);
        let mut sides: Vec<Side> = contacts.iter().map(foundation).collect();
        for (number, mortar) in mortars(contacts, mesh, supports, |_| Some(&mesh.points)) {
            let contact = &contacts[number];
            let is_updated = contact.pair.as_ref().is_some_and(Pair::is_updated);
            let all = || contact.sides().flat_map(|side| set(side).node_list()).collect();
            sides[number] = Side::Pair(mortar, if is_updated { all() } else { Vec::new() });
        }
        let mut boundary = ContactBoundary::of(mesh, &sides);
        for point in &mut boundary.points {
            let contact = &contacts[point.contact];
            if contact.is_tie() && point.own < point.nodes.len() {
                (point.closed, point.gap) = (0.0 - point.gap, 0.0);
            } else if contact.pair.as_ref().is_some_and(|pair| pair.closes) {
                point.closed = (0.0 - point.gap).max(0.0);
                point.gap += point.closed;
            }
        }
        boundary
    }

    /// The boundary with updated pairs recomputed on bodies with the displacement `u`; `None` if no pair is updated.
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
        let bearing = |contact: &Contact| mesh.facets.get(contact.bearing()).map_or_else(Vec::new, FacetSet::node_list);
        let moving: BTreeSet<u32> = contacts.iter().filter(|contact| is_updated(contact)).flat_map(&bearing).collect();
        // The laws of a pair that is not updated may meet those of the others at a node.
        let meets = |contact: &Contact| bearing(contact).iter().any(|node| moving.contains(node));
        let place = |contact: &Contact| {
            let at_rest = || meets(contact).then_some(mesh.points.as_slice());
            if is_updated(contact) { Some(x.as_slice()) } else { at_rest() }
        };
        let mut made = mortars(contacts, mesh, supports, place);
        made.retain(|(i, _)| is_updated(&contacts[*i]));
        let mut boundary = self.with(mesh, &made);
        // r = ν·B u − g with u from the bodies at rest: g = −ν·(B X), plus the amounts by which the gap was brought
        // into its range and an overlap closed.
        let of_pairs = boundary.points.iter_mut().zip(&self.points);
        for (point, at_rest) in of_pairs.filter(|(point, _)| is_updated(&contacts[point.contact])) {
            point.closed = at_rest.closed;
            if point.own < point.nodes.len() {
                point.gap = boundary_gap(&self.nodes, mesh, point) + point.clamped + point.closed;
            }
        }
        Some(Arc::new(boundary))
    }
}

impl ContactBoundary {
    /// Moment of the forces on both bodies of each contact, N m, for tractions λ on the side opposite to the bearing
    /// one: −Σ ω (B X) × λ, zero if λ is along the distance B X. Updated pairs are placed by the displacement `u`. Zero
    /// at foundations.
    pub(crate) fn moments(
        &self,
        contacts: &[Contact],
        mesh: &Mesh,
        u: &[f64],
        lambda: impl Iterator<Item = Point>,
    ) -> Vec<Point> {
        let mut all = vec![[0.0; 3]; contacts.len()];
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
        place_of(&self.nodes, mesh, point)
    }
}

/// Σ B_i X_i of the bodies at rest.
fn place_of(nodes: &[u32], mesh: &Mesh, point: &PointOnBoundary) -> Point {
    point.entries().fold([0.0; 3], |sum, (node, value, turn)| {
        let x = mesh.points[nodes[node] as usize];
        let x = turn.map_or(x, |turn| turn.position(&x));
        std::array::from_fn(|c| sum[c] + value * x[c])
    })
}

/// −ν·(B X) of the bodies at rest.
fn boundary_gap(nodes: &[u32], mesh: &Mesh, point: &PointOnBoundary) -> f64 {
    0.0 - crate::tensor::dot(&place_of(nodes, mesh, point), &point.normal)
}
