//! Fluid that enters a contact where it is open, as at the pressure side of a seal.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use super::{Contact, ContactBoundary, PointOnBoundary};
use crate::field::Field;
use crate::mesh::{FacetSet, Mesh};

/// A fluid that can enter a contact.
///
/// It wets the contact points that it reaches from `from` through open points, and pushes both sides apart there:
///
/// ```text
///     σν = −(p + p_f) ν + …  where it is wet,      σν = −p ν + …  elsewhere
/// ```
///
/// p is the contact pressure, which the contact laws see. A point is open if its sides are apart, or if p does not
/// exceed the limit `sealed_above`, as on rough faces.
///
/// Source: pressure penetration of finite element programs; B. N. J. Persson, C. Yang, J. Phys.: Condens. Matter 20
/// (2008) 315011, for the limit.
#[derive(Clone, Debug)]
pub struct Fluid {
    /// p_f in Pa, at a place and time.
    pub pressure: Field,
    /// Name of the side, edge or points at which the fluid stands before the contact.
    pub from: String,
    /// Name of the side, edge or points that it should not reach; empty for none.
    pub to: String,
    /// Contact pressure p in Pa above which a point keeps the fluid out; with 0 every point under pressure does.
    pub sealed_above: f64,
}

impl Fluid {
    /// True if the fluid passes a point in this state: the point faces nothing, or its pressure is too low. Sides that
    /// adhere are closed.
    #[must_use]
    pub fn passes(&self, point: &PointOnBoundary, penetration: f64, pressure: f64) -> bool {
        if point.weight == 0.0 {
            return true;
        }
        if pressure == 0.0 {
            return penetration < 0.0 || self.sealed_above > 0.0;
        }
        pressure > 0.0 && pressure <= self.sealed_above
    }
}

/// The wet contact points, and the places where the fluid has passed through.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Wet {
    /// True for each contact point that the fluid has reached; empty without a fluid.
    pub points: Vec<bool>,
    /// The first passage through each contact, if any; empty without a fluid.
    pub leaks: Vec<Option<Leak>>,
}

/// A passage of fluid through a contact.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Leak {
    /// Time at which the passage was first found, the end of a step, s.
    pub t: f64,
    /// Number of the contact point with the narrowest gap along the passage.
    pub narrowest: usize,
    /// The gap there, m; negative where the sides are pressed together.
    pub gap: f64,
}

/// The possible paths of fluids along contact points.
#[derive(Clone, Debug, Default)]
pub struct Ways {
    /// The neighbours of each contact point of a contact with a fluid.
    next: Vec<Vec<usize>>,
    /// Points at which a fluid stands, and points that it should not reach.
    from: Vec<usize>,
    to: BTreeSet<usize>,
}

impl Ways {
    /// The paths along the facets of the sides that bear contact points.
    #[must_use]
    pub fn new(mesh: &Mesh, contacts: &[Contact], boundary: &ContactBoundary) -> Ways {
        let mut ways = Ways::default();
        if contacts.iter().all(|contact| contact.fluid.is_none()) {
            return ways;
        }
        ways.next = vec![Vec::new(); boundary.points.len()];
        for (number, contact) in contacts.iter().enumerate() {
            let Some(fluid) = &contact.fluid else { continue };
            let of_node = own_points(boundary, number);
            if let Some(side) = mesh.facets.get(contact.bearing()) {
                ways.join(side, &of_node);
            }
            ways.from.extend(beside(mesh, contact, &fluid.from, &of_node, boundary));
            ways.to.extend(beside(mesh, contact, &fluid.to, &of_node, boundary));
        }
        ways
    }

    /// True if there is no fluid.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.next.is_empty()
    }

    fn join(&mut self, side: &FacetSet, of_node: &BTreeMap<u32, Vec<usize>>) {
        for (_, facet) in side.facets() {
            let points: Vec<usize> = facet.iter().filter_map(|node| of_node.get(node)).flatten().copied().collect();
            for &i in &points {
                for &j in points.iter().filter(|j| **j != i) {
                    self.next[i].push(j);
                }
            }
        }
        for next in &mut self.next {
            next.sort_unstable();
            next.dedup();
        }
    }

    /// The points that fluids reach through open ones, each with its predecessor on the path (itself where the fluid
    /// stands before the contact); `None` if the fluid does not reach the point.
    #[must_use]
    pub fn reached(&self, is_open: impl Fn(usize) -> bool) -> Vec<Option<usize>> {
        let mut reached = vec![None; self.next.len()];
        let mut queue = VecDeque::new();
        for &i in self.from.iter().filter(|i| is_open(**i)) {
            reached[i] = Some(i);
            queue.push_back(i);
        }
        while let Some(i) = queue.pop_front() {
            for &j in self.next[i].iter().filter(|j| is_open(**j)) {
                if reached[j].is_none() {
                    reached[j] = Some(i);
                    queue.push_back(j);
                }
            }
        }
        reached
    }

    /// The paths by which fluids first reached points that they should not reach, each from its end backwards.
    pub fn through<'a>(&'a self, reached: &'a [Option<usize>]) -> impl Iterator<Item = Vec<usize>> + 'a {
        let ends = self.to.iter().filter(|i| reached.get(**i).is_some_and(Option::is_some));
        ends.map(|&end| {
            let mut way = vec![end];
            while let Some(&last) = way.last()
                && let Some(Some(before)) = reached.get(last)
                && *before != last
            {
                way.push(*before);
            }
            way
        })
    }
}

/// The points of a contact by the node of their own side that they represent.
fn own_points(boundary: &ContactBoundary, contact: usize) -> BTreeMap<u32, Vec<usize>> {
    let mut of_node: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (i, point) in boundary.points.iter().enumerate().filter(|(_, point)| point.contact == contact) {
        for node in own_nodes(point) {
            of_node.entry(boundary.nodes[node]).or_default().push(i);
        }
    }
    of_node
}

/// The contact nodes of its own side that a point represents; for a quadrature point within a facet, all of them.
fn own_nodes(point: &PointOnBoundary) -> Vec<usize> {
    let own = point.nodes.get(..point.own).unwrap_or(&point.nodes);
    let most = own.iter().fold(0.0, |most: f64, (_, value)| most.max(*value));
    own.iter().filter(|(_, value)| *value > 0.9 * most).map(|(node, _)| *node).collect()
}

/// The points of a contact at the nodes of a side, an edge or points: those on the bearing side, or else those nearest
/// to nodes of the other side.
fn beside(
    mesh: &Mesh,
    contact: &Contact,
    name: &str,
    of_node: &BTreeMap<u32, Vec<usize>>,
    boundary: &ContactBoundary,
) -> Vec<usize> {
    let nodes = mesh.named(name).map(FacetSet::node_list).unwrap_or_default();
    let at: Vec<usize> = nodes.iter().filter_map(|node| of_node.get(node)).flatten().copied().collect();
    if !at.is_empty() {
        return at;
    }
    let facing = contact.facing().and_then(|side| mesh.facets.get(side)).map(FacetSet::node_list).unwrap_or_default();
    let shared = nodes.into_iter().filter(|node| facing.binary_search(node).is_ok());
    let nearest = |node: u32| {
        let x = mesh.points.get(node as usize)?;
        let distance = |i: &usize| -> f64 {
            let y = &boundary.points[*i].x;
            (0..3).map(|c| (x[c] - y[c]).powi(2)).sum()
        };
        of_node.values().flatten().copied().min_by(|i, j| distance(i).total_cmp(&distance(j)))
    };
    let found: BTreeSet<usize> = shared.filter_map(nearest).collect();
    found.into_iter().collect()
}
