//! Defects of a mesh, each with its position.
//!
//! Cells are numbered from 0 in the order of the blocks, as in the result files; nodes from 0 as in [`Mesh::points`].

mod coincident;
mod hanging;

use std::collections::{BTreeMap, HashMap};

pub use coincident::coincident;

use super::topology::{self, Owner, SortedFacet, key};
use super::{Block, Mesh};
use crate::element::{Element, ShapeTable};
use crate::tensor::{Point, dot, length};

/// Number of defects of a kind that are listed; further ones are counted.
pub const LISTED: usize = 5;

/// A defect of a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Defect {
    /// A cell or facet refers to a node that does not exist.
    #[error("{of} has node {node}, expected one below {nodes}, the number of nodes")]
    UnknownNode {
        /// The cell or facet, as named in messages.
        of: String,
        /// The node.
        node: u32,
        /// Number of nodes of the mesh.
        nodes: usize,
    },
    /// A coordinate of a node is not finite.
    #[error("node {node} is at {at:?}, expected finite coordinates")]
    Coordinate {
        /// The node.
        node: u32,
        /// Its coordinates.
        at: Point,
    },
    /// The map of a cell inverts the reference cell, somewhere or everywhere.
    #[error(
        "cell {cell} with nodes {nodes:?} at {centre:?} is inverted: the smallest Jacobian is {jacobian:e}, expected a positive one"
    )]
    Inverted {
        /// The cell.
        cell: usize,
        /// Its nodes.
        nodes: Vec<u32>,
        /// The mean of its nodes in m.
        centre: Point,
        /// Smallest determinant of the map at the quadrature points.
        jacobian: f64,
    },
    /// A cell whose measure is zero up to rounding, somewhere or everywhere.
    #[error(
        "cell {cell} with nodes {nodes:?} at {centre:?} is degenerate: the smallest Jacobian is {jacobian:e}, zero to rounding"
    )]
    Degenerate {
        /// The cell.
        cell: usize,
        /// Its nodes.
        nodes: Vec<u32>,
        /// The mean of its nodes in m.
        centre: Point,
        /// Smallest determinant of the map at the quadrature points.
        jacobian: f64,
    },
    /// Two cells with the same nodes.
    #[error("cell {cell} at {centre:?} has the same nodes as cell {other}: {nodes:?}")]
    Duplicate {
        /// The cell.
        cell: usize,
        /// The first cell with these nodes.
        other: usize,
        /// Their nodes.
        nodes: Vec<u32>,
        /// The mean of the nodes in m.
        centre: Point,
    },
    /// A facet that more than two cells share: some of them overlap.
    #[error("the facet with nodes {nodes:?} at {centre:?} belongs to the cells {cells:?}, expected two at most")]
    Overlap {
        /// Nodes of the facet.
        nodes: Vec<u32>,
        /// The mean of the nodes in m.
        centre: Point,
        /// The cells.
        cells: Vec<usize>,
    },
    /// A node lies on a facet without being one of its nodes.
    #[error(
        "node {node} at {at:?} lies on a facet of cell {cell}, which has the nodes {facet:?} only: the mesh is not conforming there"
    )]
    Hanging {
        /// The node.
        node: u32,
        /// Its coordinates in m.
        at: Point,
        /// The cell.
        cell: usize,
        /// Nodes of the facet.
        facet: Vec<u32>,
    },
    /// Two different facets overlap: a quadrilateral and a triangle, or two halves of it by different diagonals.
    #[error(
        "the facet with nodes {facet:?} of cell {cell} at {centre:?} overlaps that with nodes {other_facet:?} of cell {other}: the mesh is not conforming there"
    )]
    Mismatch {
        /// A cell.
        cell: usize,
        /// Nodes of its facet.
        facet: Vec<u32>,
        /// The mean of these nodes in m.
        centre: Point,
        /// The cell on the other side.
        other: usize,
        /// Nodes of its facet.
        other_facet: Vec<u32>,
    },
    /// A facet of a side lies between two cells.
    #[error("the facet with nodes {nodes:?} at {centre:?} of side {side:?} lies inside the body, between the cells {} and {}", cells[0], cells[1])]
    Inside {
        /// Name of the side.
        side: String,
        /// Nodes of the facet.
        nodes: Vec<u32>,
        /// The mean of the nodes in m.
        centre: Point,
        /// The two cells.
        cells: [usize; 2],
    },
    /// A facet of a side is a facet of no cell.
    #[error("the facet with nodes {nodes:?} at {centre:?} of side {side:?} belongs to no cell")]
    Stray {
        /// Name of the side.
        side: String,
        /// Nodes of the facet.
        nodes: Vec<u32>,
        /// The mean of the nodes in m.
        centre: Point,
    },
    /// A side lists a facet more than once, which would count it repeatedly in integrals.
    #[error("the facet with nodes {nodes:?} at {centre:?} is {times} times in side {side:?}, expected once")]
    Repeated {
        /// Name of the side.
        side: String,
        /// Nodes of the facet.
        nodes: Vec<u32>,
        /// The mean of the nodes in m.
        centre: Point,
        /// Number of times.
        times: usize,
    },
    /// A node without a cell: its equations would be empty.
    #[error("node {node} at {at:?} belongs to no cell")]
    Unused {
        /// The node.
        node: u32,
        /// Its coordinates in m.
        at: Point,
    },
}

impl Defect {
    /// The side with the defect, if it concerns one. A side without data may lie inside the body.
    #[must_use]
    pub fn side(&self) -> Option<&str> {
        match self {
            Defect::Inside { side, .. } | Defect::Stray { side, .. } | Defect::Repeated { side, .. } => Some(side),
            _ => None,
        }
    }
}

/// The defects of one kind: the first [`LISTED`] of them and their number, grouped by side.
#[derive(Clone, Debug, PartialEq)]
pub struct Defects {
    /// Number of defects.
    pub total: usize,
    /// The first of them.
    pub first: Vec<Defect>,
}

impl std::fmt::Display for Defects {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (i, defect) in self.first.iter().enumerate() {
            write!(f, "{}{defect}", if i == 0 { "" } else { "\n" })?;
        }
        match self.total.saturating_sub(self.first.len()) {
            0 => Ok(()),
            more => write!(f, "\nand {more} more of this kind"),
        }
    }
}

/// Collects defects by kind, in the order of first occurrence of the kinds.
#[derive(Default)]
struct DefectList(Vec<(std::mem::Discriminant<Defect>, Option<String>, Defects)>);

impl DefectList {
    fn add(&mut self, defect: Defect) {
        let kind = std::mem::discriminant(&defect);
        let side = defect.side();
        let own = match self.0.iter().position(|(k, s, _)| *k == kind && s.as_deref() == side) {
            Some(at) => &mut self.0[at].2,
            None => &mut self.0.push_mut((kind, side.map(str::to_owned), Defects { total: 0, first: Vec::new() })).2,
        };
        own.total += 1;
        if own.first.len() < LISTED {
            own.first.push(defect);
        }
    }

    fn finish(self) -> Vec<Defects> {
        self.0.into_iter().map(|(_, _, defects)| defects).collect()
    }
}

/// All defects of a mesh by kind; empty if it is sound. The work is nearly linear in the number of cells.
///
/// A node or facet counts as lying on another facet if its distance is within 1e-6 of the facet's size. Faces of a
/// crack or of parts that touch without a common node are no defects: see [`coincident()`].
#[must_use]
pub fn defects(mesh: &Mesh) -> Vec<Defects> {
    let mut list = DefectList::default();
    indices(mesh, &mut list);
    if !list.0.is_empty() {
        // Further checks are not possible.
        return list.finish();
    }
    jacobians(mesh, &mut list);
    duplicates(mesh, &mut list);
    let boundary = facets(mesh, &mut list);
    hanging::find(mesh, &boundary, &mut list);
    unused(mesh, &mut list);
    list.finish()
}

fn centre(mesh: &Mesh, nodes: &[u32]) -> Point {
    std::array::from_fn(|d| nodes.iter().map(|&n| mesh.points[n as usize][d]).sum::<f64>() / nodes.len() as f64)
}

/// Largest distance of some nodes from the first of them.
fn extent(mesh: &Mesh, nodes: &[u32]) -> f64 {
    let origin = nodes.first().map_or([0.0; 3], |&n| mesh.points[n as usize]);
    nodes.iter().map(|&n| length(&std::array::from_fn(|d| mesh.points[n as usize][d] - origin[d]))).fold(0.0, f64::max)
}

fn indices(mesh: &Mesh, list: &mut DefectList) {
    let nodes = mesh.points.len();
    let known = |node: u32| (node as usize) < nodes;
    for (number, cell) in mesh.blocks.iter().flat_map(Block::cells).enumerate() {
        if let Some(&node) = cell.iter().find(|&&n| !known(n)) {
            list.add(Defect::UnknownNode { of: format!("cell {number}"), node, nodes });
        }
    }
    for (name, set) in &mesh.facets {
        for (f, (_, facet)) in set.facets().enumerate() {
            if let Some(&node) = facet.iter().find(|&&n| !known(n)) {
                list.add(Defect::UnknownNode { of: format!("facet {f} of side {name:?}"), node, nodes });
            }
        }
    }
    for (node, at) in mesh.points.iter().enumerate() {
        if !at.iter().all(|x| x.is_finite()) {
            list.add(Defect::Coordinate { node: node as u32, at: *at });
        }
    }
}

/// Determinant of the map of a cell at a point with these gradients of the shape functions.
fn determinant(mesh: &Mesh, cell: &[u32], gradients: &[Point]) -> f64 {
    let mut j = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for row in 0..mesh.dim {
        j[row] = [0.0; 3];
        for (&node, gradient) in cell.iter().zip(gradients) {
            let x = mesh.points[node as usize][row];
            for col in 0..mesh.dim {
                j[row][col] += x * gradient[col];
            }
        }
    }
    let [u, v, w] = j;
    dot(&u, &[v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0]])
}

/// The table of an element at the points where its cells must have a positive Jacobian; one point if it is constant.
fn points_of(element: &'static Element) -> ShapeTable {
    if element.gradient_degree == 0 {
        ShapeTable::at(element, &[element.centre()])
    } else {
        ShapeTable::new(element, 2 * element.degree)
    }
}

fn jacobians(mesh: &Mesh, list: &mut DefectList) {
    let mut cell = 0;
    for block in &mesh.blocks {
        let table = points_of(block.element);
        for nodes in block.cells() {
            let mut jacobian = f64::INFINITY;
            for q in 0..table.len() {
                jacobian = jacobian.min(determinant(mesh, nodes, table.gradients(q)));
            }
            // The determinant is a sum of products of d differences of coordinates, each rounded.
            let rounding = 64.0 * f64::EPSILON * extent(mesh, nodes).powi(mesh.dim as i32);
            if jacobian < -rounding {
                list.add(Defect::Inverted { cell, nodes: nodes.to_vec(), centre: centre(mesh, nodes), jacobian });
            } else if jacobian <= rounding {
                list.add(Defect::Degenerate { cell, nodes: nodes.to_vec(), centre: centre(mesh, nodes), jacobian });
            }
            cell += 1;
        }
    }
}

fn duplicates(mesh: &Mesh, list: &mut DefectList) {
    // Cells with the same lowest node and the same sum of squares are compared node by node.
    let mut marks: Vec<(u32, u64, u32)> = Vec::with_capacity(mesh.cell_count());
    for cell in mesh.blocks.iter().flat_map(Block::cells) {
        let lowest = cell.iter().copied().min().unwrap_or(0);
        marks.push((
            lowest,
            cell.iter().map(|&n| u64::from(n) * u64::from(n)).fold(0, u64::wrapping_add),
            marks.len() as u32,
        ));
    }
    marks.sort_unstable();
    let candidates: Vec<&[(u32, u64, u32)]> =
        marks.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).filter(|group| group.len() > 1).collect();
    if candidates.is_empty() {
        return;
    }
    let mut starts = vec![0];
    for block in &mesh.blocks {
        starts.push(starts[starts.len() - 1] + block.len());
    }
    let nodes_of = |cell: usize| {
        let block = starts.partition_point(|&start| start <= cell) - 1;
        let n = mesh.blocks[block].element.nodes.len();
        let at = (cell - starts[block]) * n;
        &mesh.blocks[block].nodes[at..at + n]
    };
    let mut pairs = Vec::new();
    for group in candidates {
        let mut first: BTreeMap<Vec<u32>, usize> = BTreeMap::new();
        for &(_, _, cell) in group {
            let mut sorted = nodes_of(cell as usize).to_vec();
            sorted.sort_unstable();
            let other = *first.entry(sorted).or_insert(cell as usize);
            if other != cell as usize {
                pairs.push((cell as usize, other));
            }
        }
    }
    pairs.sort_unstable();
    for (cell, other) in pairs {
        let nodes = nodes_of(cell).to_vec();
        list.add(Defect::Duplicate { cell, other, centre: centre(mesh, &nodes), nodes });
    }
}

/// Checks the facets of cells and of sides; returns the facets with a single cell.
fn facets(mesh: &Mesh, list: &mut DefectList) -> Vec<Owner> {
    // The facets of sides with the number of times they are listed.
    let mut sides: Vec<HashMap<SortedFacet, usize>> = Vec::new();
    let mut on_side = vec![false; mesh.points.len()];
    for set in mesh.facets.values() {
        let mut keys = HashMap::new();
        for (_, nodes) in set.facets() {
            *keys.entry(key(nodes.iter().copied())).or_insert(0) += 1;
            for &n in nodes {
                on_side[n as usize] = true;
            }
        }
        sides.push(keys);
    }
    let mut boundary = Vec::new();
    let mut found: Vec<HashMap<SortedFacet, Option<[usize; 2]>>> = vec![HashMap::new(); sides.len()];
    topology::by_facet(mesh, |key, owners| {
        if let [owner] = owners {
            boundary.push(*owner);
        } else if owners.len() > 2 {
            let nodes: Vec<u32> = owners[0].facet(mesh).1.collect();
            list.add(Defect::Overlap {
                centre: centre(mesh, &nodes),
                nodes,
                cells: owners.iter().map(|o| o.number(mesh)).collect(),
            });
        }
        if on_side[key[0] as usize] {
            for (side, found) in sides.iter().zip(&mut found) {
                if side.contains_key(key) {
                    found.insert(
                        *key,
                        if let [a, b, ..] = owners { Some([a.number(mesh), b.number(mesh)]) } else { None },
                    );
                }
            }
        }
    });
    for ((name, set), (counts, found)) in mesh.facets.iter().zip(sides.iter_mut().zip(&found)) {
        for (_, nodes) in set.facets() {
            let key = key(nodes.iter().copied());
            // Removed, so that a facet listed twice is checked once.
            let Some(times) = counts.remove(&key) else { continue };
            let (side, nodes, centre) = (name.clone(), nodes.to_vec(), centre(mesh, nodes));
            match found.get(&key) {
                None => list.add(Defect::Stray { side, nodes, centre }),
                Some(Some(cells)) => list.add(Defect::Inside { side, nodes, centre, cells: *cells }),
                Some(None) if times > 1 => list.add(Defect::Repeated { side, nodes, centre, times }),
                Some(None) => {}
            }
        }
    }
    boundary
}

fn unused(mesh: &Mesh, list: &mut DefectList) {
    let mut used = vec![false; mesh.points.len()];
    for &n in mesh.blocks.iter().flat_map(|block| &block.nodes) {
        used[n as usize] = true;
    }
    for (node, at) in mesh.points.iter().enumerate().filter(|(node, _)| !used[*node]) {
        list.add(Defect::Unused { node: node as u32, at: *at });
    }
}

/// A part of the body: cells connected by common nodes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Component {
    /// Its nodes, ascending.
    pub nodes: Vec<u32>,
    /// Number of its cells.
    pub cells: usize,
}

impl Component {
    /// Lowest and highest coordinates of its nodes.
    #[must_use]
    pub fn bounds(&self, mesh: &Mesh) -> [Point; 2] {
        let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for point in self.nodes.iter().filter_map(|&n| mesh.points.get(n as usize)) {
            for d in 0..3 {
                bounds[0][d] = bounds[0][d].min(point[d]);
                bounds[1][d] = bounds[1][d].max(point[d]);
            }
        }
        bounds
    }
}

/// The lowest node of the part to which a node is known to belong; paths to it are halved on the way.
fn root(parent: &mut [u32], mut node: u32) -> u32 {
    while parent[node as usize] != node {
        let above = parent[parent[node as usize] as usize];
        parent[node as usize] = above;
        node = above;
    }
    node
}

/// Label of the part of the body per node: the lowest node of the part.
fn labels(mesh: &Mesh) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..mesh.points.len() as u32).collect();
    for cell in mesh.blocks.iter().flat_map(Block::cells) {
        let mut lowest = root(&mut parent, cell[0]);
        for &node in &cell[1..] {
            let other = root(&mut parent, node);
            let (low, high) = (lowest.min(other), lowest.max(other));
            parent[high as usize] = low;
            lowest = low;
        }
    }
    (0..parent.len() as u32).map(|node| root(&mut parent, node)).collect()
}

/// The parts of the body, in the order of their lowest node. Without density, a part that can move rigidly makes the
/// problem singular.
///
/// Nodes must be below the number of nodes, see [`defects`]; nodes without a cell belong to no part.
#[must_use]
pub fn components(mesh: &Mesh) -> Vec<Component> {
    let labels = labels(mesh);
    let mut parts: BTreeMap<u32, Component> = BTreeMap::new();
    for cell in mesh.blocks.iter().flat_map(Block::cells) {
        parts.entry(labels[cell[0] as usize]).or_insert_with(|| Component { nodes: Vec::new(), cells: 0 }).cells += 1;
    }
    for (node, label) in labels.iter().enumerate() {
        if let Some(part) = parts.get_mut(label) {
            part.nodes.push(node as u32);
        }
    }
    parts.into_values().collect()
}
