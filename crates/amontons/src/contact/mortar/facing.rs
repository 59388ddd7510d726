//! Detection of neighbouring bodies: facets that face those of another body within a distance.

use std::collections::{BTreeMap, BTreeSet};

use super::cut::{self, MortarPoint, Opposite};
use super::image::SectorImage;
use super::part::SideFacets;
use super::tree::SphereTree;
use crate::element::Element;
use crate::mesh::defects::components;
use crate::mesh::{FacetSet, Mesh};
use crate::tensor::length;

/// Relative round-off allowed in a distance between the bodies.
const ROUND_OFF: f64 = 1e-9;

/// Two bodies with the facets of each that face the other.
#[derive(Clone, Debug)]
pub struct Facing {
    /// The bodies by their numbers among the connected parts of the mesh, the lower one first.
    pub bodies: [usize; 2],
    /// Their facets.
    pub sides: [FacetSet; 2],
}

/// The pairs of bodies whose facets face each other along their normals, with no third body between them, at a distance
/// of at most d in m or with an overlap of at most d. Facets that are not free are left out. A mesh with cells that
/// refer to missing nodes has no pairs.
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
    // Facets of both bodies of each pair that face each other.
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

/// The facets of the first surface, each paired with a facet of the second that it faces within the distance.
fn near(mesh: &Mesh, surfaces: [&FacetSet; 2], distance: f64) -> Vec<(usize, usize)> {
    let itself = [SectorImage::SELF];
    let [own, other] = surfaces.map(|set| SideFacets::new(mesh, &mesh.points, set, &itself));
    let tree = SphereTree::new(other.parts());
    let opposite = Opposite { facets: &other, tree: &tree, sight: None, distance: Some(distance) };
    let mut all = Vec::new();
    for part in own.parts() {
        for MortarPoint { own: own_at, other: (number, _, other_at), .. } in cut::covered(&own, &opposite, part).samples
        {
            let facet = other.parts()[number].facet;
            let (from, to) = (own.position(part.facet, &own_at), other.position(facet, &other_at));
            if length(&std::array::from_fn(|c| to[c] - from[c])) <= distance * (1.0 + ROUND_OFF) {
                all.push((part.facet, facet));
            }
        }
    }
    all.dedup();
    all
}
