//! Boundary facets of cells that lie on other facets without being the same: nonconforming places of a mesh.

use super::{Defect, DefectList, centre, extent, labels};
use crate::element::Element;
use crate::mesh::surface::project;
use crate::mesh::topology::Owner;
use crate::mesh::{Mesh, Spheres};
use crate::tensor::{Point, length, minus};

/// Distance of a node from a facet, relative to the size of the facet, within which it lies on it: files often have
/// seven digits.
const NEAR: f64 = 1e-6;

struct FacetOf {
    owner: Owner,
    element: &'static Element,
    nodes: Vec<u32>,
    size: f64,
}

/// Adds hanging nodes and, if there are none, overlapping facets.
pub(super) fn find(mesh: &Mesh, boundary: &[Owner], list: &mut DefectList) {
    if mesh.dim < 2 {
        return;
    }
    let of_owner = |&owner: &Owner| {
        let (element, nodes) = owner.facet(mesh);
        let nodes: Vec<u32> = nodes.collect();
        FacetOf { owner, element, size: extent(mesh, &nodes), nodes }
    };
    let facets: Vec<FacetOf> = boundary.iter().map(of_owner).collect();
    // Facets of each node, as sorted pairs.
    let mut at_node: Vec<(u32, u32)> =
        facets.iter().enumerate().flat_map(|(f, facet)| facet.nodes.iter().map(move |&n| (n, f as u32))).collect();
    at_node.sort_unstable();
    let of_node = |node: u32| {
        let start = at_node.partition_point(|pair| pair.0 < node);
        at_node[start..].iter().take_while(move |pair| pair.0 == node).map(|pair| pair.1 as usize)
    };
    let mut nodes: Vec<u32> = at_node.iter().map(|pair| pair.0).collect();
    nodes.dedup();
    let tree = Spheres::new(nodes.len(), &|place| (mesh.points[nodes[place] as usize], 0.0));
    let labels = labels(mesh);
    let mut hanging: Vec<(u32, usize)> = Vec::new();
    for (f, facet) in facets.iter().enumerate() {
        let (low, high) = bounds(mesh, facet);
        let beyond =
            |x: &Point| (0..mesh.dim).map(|d| (low[d] - x[d]).max(x[d] - high[d]).max(0.0).powi(2)).sum::<f64>();
        let is_inside = |place: usize| beyond(&mesh.points[nodes[place] as usize]) <= 0.0;
        let near = tree.met(&|centre, radius| beyond(centre) <= radius * radius, &is_inside);
        for node in near.into_iter().map(|place| nodes[place]) {
            let at = &mesh.points[node as usize];
            let apart = facet.nodes.iter().all(|&n| length(&minus(&mesh.points[n as usize], at)) > NEAR * facet.size);
            // Faces of a crack or of bodies that touch share no node there.
            let joined = || of_node(node).any(|other| facets[other].nodes.iter().any(|n| facet.nodes.contains(n)));
            if apart && labels[node as usize] == labels[facet.nodes[0] as usize] && joined() && on(mesh, facet, at) {
                hanging.push((node, f));
            }
        }
    }
    hanging.sort_unstable();
    // The facets next to an edge may share a hanging node: one of them is enough.
    hanging.dedup_by_key(|pair| pair.0);
    for &(node, f) in &hanging {
        let facet = &facets[f];
        list.add(Defect::Hanging {
            node,
            at: mesh.points[node as usize],
            cell: facet.owner.number(mesh),
            facet: facet.nodes.clone(),
        });
    }
    if hanging.is_empty() && mesh.dim == 3 {
        overlaps(mesh, &facets, of_node, list);
    }
}

/// A box around a facet.
fn bounds(mesh: &Mesh, facet: &FacetOf) -> (Point, Point) {
    // The nodes of a curved facet do not bound it; a margin of half its size is ample.
    let margin = if facet.element.gradient_degree == 0 { NEAR * facet.size } else { 0.5 * facet.size };
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for &n in &facet.nodes {
        for d in 0..3 {
            low[d] = low[d].min(mesh.points[n as usize][d] - margin);
            high[d] = high[d].max(mesh.points[n as usize][d] + margin);
        }
    }
    (low, high)
}

/// Adds pairs of facets with a common edge where one has its centre on the other.
fn overlaps<I: Iterator<Item = usize>>(
    mesh: &Mesh,
    facets: &[FacetOf],
    of_node: impl Fn(u32) -> I,
    list: &mut DefectList,
) {
    let mut pairs: Vec<(usize, usize)> = Vec::new();
    for (f, facet) in facets.iter().enumerate() {
        let middle = centre(mesh, &facet.nodes);
        let mut others: Vec<usize> = facet.nodes.iter().flat_map(|&n| of_node(n)).filter(|&other| other != f).collect();
        others.sort_unstable();
        for other in others.chunk_by(|a, b| a == b).filter(|group| group.len() >= 2).map(|group| group[0]) {
            if !coincide(mesh, facet, &facets[other]) && on(mesh, &facets[other], &middle) {
                pairs.push((f.min(other), f.max(other)));
            }
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    for (f, other) in pairs {
        let (facet, other) = (&facets[f], &facets[other]);
        list.add(Defect::Mismatch {
            cell: facet.owner.number(mesh),
            facet: facet.nodes.clone(),
            centre: centre(mesh, &facet.nodes),
            other: other.owner.number(mesh),
            other_facet: other.nodes.clone(),
        });
    }
}

/// True if two facets coincide node by node, as the faces of a crack do next to its front.
fn coincide(mesh: &Mesh, a: &FacetOf, b: &FacetOf) -> bool {
    let near = |m: u32, n: u32| length(&minus(&mesh.points[m as usize], &mesh.points[n as usize])) < NEAR * a.size;
    a.nodes.len() == b.nodes.len() && a.nodes.iter().all(|&m| b.nodes.iter().any(|&n| near(m, n)))
}

/// True if a point lies on a facet: the nearest point of the facet is within [`NEAR`].
fn on(mesh: &Mesh, facet: &FacetOf, at: &Point) -> bool {
    project(mesh, facet.element, &facet.nodes, at, NEAR)
        .is_some_and(|(xi, distance)| facet.element.shape.depth(&xi) > -NEAR && distance < 2.0 * NEAR * facet.size)
}
