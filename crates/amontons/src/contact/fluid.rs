//! Fluid that enters a contact where it is open, as at the pressure side of a seal.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use super::{Contact, ContactBoundary, PointOnBoundary};
use crate::field::Field;
use crate::mesh::{FacetSet, Mesh};

/// A fluid beside a contact.
///
/// It wets the contact points that it reaches from a place through points that are open, and presses both sides apart
/// there:
///
/// ```text
///     σν = −(p + p_f) ν + …  where it is wet,      σν = −p ν + …  elsewhere
/// ```
///
/// p is the pressure of the bodies on each other, which the laws of contact see. A point is open where its sides are
/// apart, or press by no more than a limit: that of faces that are rough.
///
/// Source: pressure penetration of finite element programs; B. N. J. Persson, C. Yang, J. Phys.: Condens. Matter 20
/// (2008) 315011, for the limit.
#[derive(Clone, Debug)]
pub struct Fluid {
    /// p_f in Pa, at a place and time.
    pub pressure: Field,
    /// Name of the side, edge or points at which it stands before the contact.
    pub from: String,
    /// Name of the side, edge or points that it should not reach; empty for none.
    pub to: String,
    /// Pressure p in Pa above which a point keeps it out; with 0 every point that is pressed does.
    pub sealed_above: f64,
}

impl Fluid {
    /// Whether it passes a point in this state: one that faces nothing, or is not pressed enough. Sides that hold
    /// together are closed.
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

/// What is wet, and where the fluid has got through.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Wet {
    /// Whether the fluid is at each contact point; empty without a fluid.
    pub points: Vec<bool>,
    /// The first passage through each contact, as far as there was one; empty without a fluid.
    pub leaks: Vec<Option<Leak>>,
}

/// A passage of fluid through a contact.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Leak {
    /// When it was there first, the end of a step, s.
    pub t: f64,
    /// Its narrowest point, the number of a contact point, and the gap there, m; negative where it is pressed
    /// together.
    pub narrowest: usize,
    /// That gap.
    pub gap: f64,
}

/// The ways of fluids along contact points.
#[derive(Clone, Debug, Default)]
pub struct Ways {
    /// The points next to each point of a contact with a fluid.
    next: Vec<Vec<usize>>,
    /// Points at which a fluid stands, and those that it should not reach.
    from: Vec<usize>,
    to: BTreeSet<usize>,
}

impl Ways {
    /// Along the facets of the sides that bear contact points.
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

    /// Whether there is no fluid.
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

    /// The points that fluids reach through open ones, each with the one that it was reached from, itself where the
    /// fluid stands before the contact; none where it does not come.
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

    /// The first ways that fluids have found to points that they should not reach, each from its end on.
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

/// The points of a contact by the nodes of their own side that they stand for.
fn own_points(boundary: &ContactBoundary, contact: usize) -> BTreeMap<u32, Vec<usize>> {
    let mut of_node: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (i, point) in boundary.points.iter().enumerate().filter(|(_, point)| point.contact == contact) {
        for node in own_nodes(point) {
            of_node.entry(boundary.nodes[node]).or_default().push(i);
        }
    }
    of_node
}

/// The contact node of its own side that a point stands for; at a point of a quadrature within a facet all of them.
fn own_nodes(point: &PointOnBoundary) -> Vec<usize> {
    let own = point.nodes.get(..point.own).unwrap_or(&point.nodes);
    let most = own.iter().fold(0.0, |most: f64, (_, value)| most.max(*value));
    own.iter().filter(|(_, value)| *value > 0.9 * most).map(|(node, _)| *node).collect()
}

/// The points of a contact at the nodes of a side, an edge or points: of the side that bears them, else those nearest
/// to nodes of the other one.
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
