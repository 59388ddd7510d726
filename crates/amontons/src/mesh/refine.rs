//! Uniform refinement: every edge is halved.

use std::collections::{BTreeMap, HashMap};

use super::{Block, FacetSet, Mesh, MeshError};
use crate::element::{Element, MAX_NODES};
use crate::quadrature::Shape;
use crate::tensor::Point;

/// The nodes from which a new node is interpolated, with weights in billionths: equal for all cells and facets that
/// have it, since shape functions agree on common facets.
type Weights = Vec<(u32, i64)>;

/// Weights below this are round-off.
const UNIT: f64 = 1e9;

impl Mesh {
    /// The mesh with every edge halved: a cell becomes 2^d cells, a pyramid six pyramids and four tetrahedra. New nodes
    /// lie on the cell, so that curved cells keep their shape and regions and sides their measure. Existing nodes keep
    /// their numbers.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if there are too many nodes.
    pub fn refined(&self) -> Result<Mesh, MeshError> {
        self.refined_with_origins().map(|(mesh, _)| mesh)
    }

    /// [`Mesh::refined`], and for each new node, from the last existing one on, those between which it lies.
    pub(super) fn refined_with_origins(&self) -> Result<(Mesh, Vec<Vec<u32>>), MeshError> {
        let mut nodes = RefinedNodes::new(self);
        let mut blocks: Vec<Block> = Vec::new();
        for block in &self.blocks {
            for cell in block.cells() {
                for (shape, corners) in (block.element.children)(&nodes.positions(block.element, cell)) {
                    let element = element_of(block.element, shape);
                    let new = nodes.of(block.element, cell, element, &corners);
                    push(&mut blocks, element, block.region, new);
                }
            }
        }
        let mut finer = |sets: &BTreeMap<String, FacetSet>| {
            let mut all = BTreeMap::new();
            for (name, set) in sets {
                let mut finer = FacetSet::default();
                for (element, facet) in set.facets() {
                    for (_, corners) in (element.children)(&nodes.positions(element, facet)) {
                        let new = nodes.of(element, facet, element, &corners);
                        finer.push(element, new);
                    }
                }
                all.insert(name.clone(), finer);
            }
            all
        };
        let (facets, edges) = (finer(&self.facets), finer(&self.edges));
        blocks.sort_by_key(|block| block.region);
        if nodes.points.len() > u32::MAX as usize {
            return Err(MeshError::TooLarge { found: nodes.points.len() as f64 });
        }
        let mut origins = vec![Vec::new(); nodes.points.len() - self.points.len()];
        for (weights, node) in nodes.known {
            if let Some(origin) = (node as usize).checked_sub(self.points.len()).and_then(|new| origins.get_mut(new)) {
                *origin = weights.into_iter().map(|(node, _)| node).collect();
            }
        }
        let mesh = Mesh { points: nodes.points, blocks, facets, edges, regions: self.regions.clone(), ..*self };
        Ok((mesh, origins))
    }
}

/// Adds a cell to the block of its element and region.
fn push(blocks: &mut Vec<Block>, element: &'static Element, region: usize, nodes: Vec<u32>) {
    match blocks.iter_mut().find(|block| block.region == region && std::ptr::eq(block.element, element)) {
        Some(block) => block.nodes.extend(nodes),
        None => blocks.push(Block { element, region, nodes }),
    }
}

/// The element of a part with this shape: that of the whole, or of the same degree.
fn element_of(parent: &'static Element, shape: Shape) -> &'static Element {
    let other = (shape != parent.shape).then(|| Element::find(shape, parent.degree)).flatten();
    other.unwrap_or(parent)
}

/// The nodes of the finer mesh.
struct RefinedNodes {
    points: Vec<Point>,
    known: HashMap<Weights, u32>,
}

impl RefinedNodes {
    fn new(mesh: &Mesh) -> RefinedNodes {
        let known = (0..mesh.points.len() as u32).map(|node| (vec![(node, UNIT as i64)], node)).collect();
        RefinedNodes { points: mesh.points.clone(), known }
    }

    /// Positions of the vertices of a cell.
    fn positions(&self, element: &Element, cell: &[u32]) -> Vec<Point> {
        cell.iter().take(element.shape.vertices()).map(|&node| self.points[node as usize]).collect()
    }

    /// The nodes of a part of a cell, an element with these vertices in the reference cell.
    fn of(&mut self, parent: &Element, cell: &[u32], element: &Element, corners: &[Point]) -> Vec<u32> {
        let vertices = element.shape.vertices();
        element.nodes.iter().map(|at| self.node(parent, cell, &placed(element.shape, vertices, corners, at))).collect()
    }

    /// The node at a point of the reference cell.
    fn node(&mut self, parent: &Element, cell: &[u32], at: &Point) -> u32 {
        let near = |node: &&Point| (0..3).all(|d| (node[d] - at[d]).abs() < 1e-9);
        if let Some(own) = parent.nodes.iter().position(|node| near(&node)) {
            return cell[own];
        }
        let mut values = [0.0; MAX_NODES];
        (parent.shape_functions)(at, &mut values[..parent.nodes.len()]);
        let shares = cell.iter().zip(values);
        let mut weights: Weights = shares
            .clone()
            .map(|(&node, value)| (node, (UNIT * value).round() as i64))
            .filter(|(_, weight)| *weight != 0)
            .collect();
        weights.sort_unstable();
        let points = &mut self.points;
        *self.known.entry(weights).or_insert_with(|| {
            let mut point = [0.0; 3];
            // Ordered by node number, so that all cells give the same bits.
            let mut shares: Vec<(u32, f64)> = shares.map(|(&node, value)| (node, value)).collect();
            shares.sort_by_key(|(node, _)| *node);
            for (node, value) in shares {
                let x = points[node as usize];
                (0..3).for_each(|d| point[d] += value * x[d]);
            }
            points.push(point);
            points.len() as u32 - 1
        })
    }
}

/// Coordinates in the reference cell of the whole of a point in that of a part.
fn placed(shape: Shape, vertices: usize, corners: &[Point], at: &Point) -> Point {
    let linear = Element::find(shape, usize::from(shape.dim() > 0));
    let mut values = [0.0; MAX_NODES];
    let Some(linear) = linear else { return *at };
    // Vertices are handled first: the functions of a pyramid are not defined at its apex.
    let near = |node: &Point| (0..3).all(|d| (node[d] - at[d]).abs() < 1e-9);
    if let Some(own) = linear.nodes.iter().position(near) {
        return corners[own];
    }
    (linear.shape_functions)(at, &mut values[..vertices]);
    std::array::from_fn(|d| corners.iter().zip(values).map(|(corner, value)| value * corner[d]).sum())
}
