//! Bodies that are near each other: which of their facets face those of another body within a distance.

use std::collections::{BTreeMap, BTreeSet};

use super::cut;
use super::part::{Facets, Part};
use crate::element::Element;
use crate::mesh::defects::components;
use crate::mesh::{FacetSet, Mesh};
use crate::tensor::{Point, dot, length};

/// Relative round-off of a distance that is that of the bodies.
const ROUND_OFF: f64 = 1e-9;

/// Two bodies with the facets of each that face the other.
#[derive(Clone, Debug)]
pub struct Facing {
    /// The bodies by their numbers among the connected parts of the mesh, the lower one first.
    pub bodies: [usize; 2],
    /// Their facets.
    pub sides: [FacetSet; 2],
}

/// The pairs of bodies whose facets face each other, along their normals and without a third body between them, with at
/// most the distance d in m between them, or overlap by as much at most. Facets that are not free are left out. A mesh
/// whose cells have nodes that do not exist has no pairs.
#[must_use]
pub fn facing(mesh: &Mesh, distance: f64, is_free: &dyn Fn(&'static Element, &[u32]) -> bool) -> Vec<Facing> {
    if mesh.check_nodes().is_err() {
        return Vec::new();
    }
    let mut body_of = vec![0; mesh.points.len()];
    let bodies = components(mesh);
    for (body, component) in bodies.iter().enumerate() {
        component.nodes.iter().for_each(|&node| body_of[node as usize] = body);
    }
    let mut surfaces = vec![FacetSet::default(); bodies.len()];
    for (element, nodes) in mesh.boundary().facets().filter(|(element, nodes)| is_free(element, nodes)) {
        surfaces[body_of[nodes[0] as usize]].push(element, nodes.iter().copied());
    }
    // Of each pair the facets of both bodies that face each other.
    let mut found: BTreeMap<[usize; 2], [BTreeSet<usize>; 2]> = BTreeMap::new();
    for (own, surface) in surfaces.iter().enumerate() {
        let (mut others, mut owner) = (FacetSet::default(), Vec::new());
        for (body, surface) in surfaces.iter().enumerate().filter(|(body, _)| *body != own) {
            others.blocks.extend(surface.blocks.iter().cloned());
            owner.extend((0..surface.len()).map(|facet| (body, facet)));
        }
        for (facet, other) in near(mesh, [surface, &others], distance) {
            let Some(&(body, of_body)) = owner.get(other) else { continue };
            let [first, second] = found.entry([own.min(body), own.max(body)]).or_default();
            let (mine, others) = if own < body { (first, second) } else { (second, first) };
            mine.insert(facet);
            others.insert(of_body);
        }
    }
    let chosen = |body: usize, facets: &BTreeSet<usize>| {
        let mut set = FacetSet::default();
        for (_, (element, nodes)) in surfaces[body].facets().enumerate().filter(|(i, _)| facets.contains(i)) {
            set.push(element, nodes.iter().copied());
        }
        set
    };
    found
        .into_iter()
        .map(|([a, b], [of_a, of_b])| Facing { bodies: [a, b], sides: [chosen(a, &of_a), chosen(b, &of_b)] })
        .collect()
}

/// The facets of the first surface with those of the second that they face within the distance.
fn near(mesh: &Mesh, surfaces: [&FacetSet; 2], distance: f64) -> Vec<(usize, usize)> {
    let [own, other] = surfaces.map(|set| Facets::new(mesh, &mesh.points, set));
    let near = Near::new(other.parts(), distance);
    let mut all = Vec::new();
    for facet in 0..own.len() {
        for sample in cut::samples_among(&own, &other, facet, &|part| near.to(part)) {
            let (from, to) = (own.position(facet, &sample.own), other.position(sample.other.0, &sample.other.1));
            if length(&std::array::from_fn(|c| to[c] - from[c])) <= distance * (1.0 + ROUND_OFF) {
                all.push((facet, sample.other.0));
            }
        }
    }
    all.dedup();
    all
}

/// Parts in the order of a coordinate, to find those near a point.
struct Near<'p> {
    parts: Vec<&'p Part>,
    axis: usize,
    reach: f64,
}

impl<'p> Near<'p> {
    /// Along the axis in which the parts are spread the widest.
    fn new(parts: &'p [Part], distance: f64) -> Near<'p> {
        let spread = |c: usize| {
            let along = || parts.iter().map(|part| part.centre[c]);
            along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
        };
        let axis = (0..3).max_by(|&a, &b| spread(a).total_cmp(&spread(b))).unwrap_or(0);
        let reach = distance + parts.iter().map(|part| part.radius).fold(0.0, f64::max);
        let mut parts: Vec<&Part> = parts.iter().collect();
        parts.sort_by(|a, b| a.centre[axis].total_cmp(&b.centre[axis]));
        Near { parts, axis, reach }
    }

    /// The parts that may be within the distance of one.
    fn to(&self, part: &Part) -> Vec<&'p Part> {
        let (centre, reach) = (part.centre[self.axis], part.radius + self.reach);
        let from = self.parts.partition_point(|other| other.centre[self.axis] < centre - reach);
        let near = self.parts[from..].iter().take_while(|other| other.centre[self.axis] <= centre + reach);
        near.filter(|other| {
            let apart: Point = std::array::from_fn(|c| other.centre[c] - part.centre[c]);
            dot(&apart, &apart) <= reach * reach
        })
        .copied()
        .collect()
    }
}
