//! Boundary facets of cells that lie on other facets without being the same: nonconforming places of a mesh.

use super::{Defect, DefectList, centre, extent, labels};
use crate::element::{Element, MAX_NODES};
use crate::mesh::Mesh;
use crate::mesh::topology::Owner;
use crate::quadrature::Shape;
use crate::tensor::{Point, dot, length};

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
    let mut tree: Vec<u32> = at_node.iter().map(|pair| pair.0).collect();
    tree.dedup();
    build(mesh, &mut tree, 0);
    let labels = labels(mesh);
    let mut hanging: Vec<(u32, usize)> = Vec::new();
    let mut near = Vec::new();
    for (f, facet) in facets.iter().enumerate() {
        let (low, high) = bounds(mesh, facet);
        near.clear();
        query(mesh, &tree, 0, &low, &high, &mut near);
        for &node in &near {
            let at = &mesh.points[node as usize];
            let apart = facet.nodes.iter().all(|&n| distance(&mesh.points[n as usize], at) > NEAR * facet.size);
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
    let near = |m: u32, n: u32| distance(&mesh.points[m as usize], &mesh.points[n as usize]) < NEAR * a.size;
    a.nodes.len() == b.nodes.len() && a.nodes.iter().all(|&m| b.nodes.iter().any(|&n| near(m, n)))
}

fn distance(a: &Point, b: &Point) -> f64 {
    length(&std::array::from_fn(|d| a[d] - b[d]))
}

/// True if a point lies on a facet: the nearest point of the facet, by Gauss-Newton iteration, is within [`NEAR`].
fn on(mesh: &Mesh, facet: &FacetOf, at: &Point) -> bool {
    let (mut values, mut gradients) = ([0.0; MAX_NODES], [[0.0; 3]; MAX_NODES]);
    let n = facet.nodes.len();
    let mut xi = facet.element.centre();
    for _ in 0..20 {
        (facet.element.shape_functions)(&xi, &mut values[..n]);
        (facet.element.gradients)(&xi, &mut gradients[..n]);
        let (mut rest, mut a, mut b) = (*at, [0.0; 3], [0.0; 3]);
        for (i, &node) in facet.nodes.iter().enumerate() {
            for d in 0..3 {
                let x = mesh.points[node as usize][d];
                rest[d] -= values[i] * x;
                a[d] += gradients[i][0] * x;
                b[d] += gradients[i][1] * x;
            }
        }
        let (aa, ab, bb, ra, rb) = (dot(&a, &a), dot(&a, &b), dot(&b, &b), dot(&rest, &a), dot(&rest, &b));
        let step = if mesh.dim == 2 {
            [ra / aa, 0.0]
        } else {
            let determinant = aa * bb - ab * ab;
            [(bb * ra - ab * rb) / determinant, (aa * rb - ab * ra) / determinant]
        };
        if !(step[0].is_finite() && step[1].is_finite()) || xi.iter().any(|x| x.abs() > 10.0) {
            return false;
        }
        xi[0] += step[0];
        xi[1] += step[1];
        if step[0].abs().max(step[1].abs()) < NEAR {
            let inside = match facet.element.shape {
                Shape::Triangle => xi[0] > -NEAR && xi[1] > -NEAR && xi[0] + xi[1] < 1.0 + NEAR,
                _ => xi.iter().all(|x| (-NEAR..=1.0 + NEAR).contains(x)),
            };
            return inside && length(&rest) < 2.0 * NEAR * facet.size;
        }
    }
    false
}

/// Largest number of nodes in a leaf.
const LEAF: usize = 8;

/// Sorts nodes into a k-d tree: the median splits the others by the coordinate of its depth.
fn build(mesh: &Mesh, nodes: &mut [u32], depth: usize) {
    if nodes.len() <= LEAF {
        return;
    }
    let axis = depth % mesh.dim;
    let middle = nodes.len() / 2;
    let x = |node: u32| mesh.points[node as usize][axis];
    let (low, _, high) = nodes.select_nth_unstable_by(middle, |&a, &b| x(a).total_cmp(&x(b)).then(a.cmp(&b)));
    build(mesh, low, depth + 1);
    build(mesh, high, depth + 1);
}

/// Adds the nodes of a tree that lie in a box.
fn query(mesh: &Mesh, nodes: &[u32], depth: usize, low: &Point, high: &Point, found: &mut Vec<u32>) {
    let inside = |node: u32| (0..mesh.dim).all(|d| (low[d]..=high[d]).contains(&mesh.points[node as usize][d]));
    if nodes.len() <= LEAF {
        found.extend(nodes.iter().copied().filter(|&n| inside(n)));
        return;
    }
    let (axis, middle) = (depth % mesh.dim, nodes.len() / 2);
    let split = mesh.points[nodes[middle] as usize][axis];
    if low[axis] <= split {
        query(mesh, &nodes[..middle], depth + 1, low, high, found);
    }
    if inside(nodes[middle]) {
        found.push(nodes[middle]);
    }
    if high[axis] >= split {
        query(mesh, &nodes[middle + 1..], depth + 1, low, high, found);
    }
}
