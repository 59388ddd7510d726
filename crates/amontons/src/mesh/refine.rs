//! Uniform refinement: every edge is halved.

use std::collections::{BTreeMap, HashMap};

use super::{Block, FacetSet, Mesh, MeshError};
use crate::element::{Element, P1_TETRAHEDRON, P2_TETRAHEDRON};
use crate::quadrature::Shape;
use crate::tensor::{Point, dot};

/// The nodes from which a new node is interpolated, with weights in billionths: equal for all cells and facets that
/// have it, since shape functions agree on common facets.
type Weights = Vec<(u32, i64)>;

/// Weights below this are round-off.
const UNIT: f64 = 1e9;

/// A part of a reference cell, given by its vertices.
type Child = (Shape, Vec<Point>);

impl Mesh {
    /// The mesh with every edge halved: a cell becomes 2^d cells, a pyramid six pyramids and four tetrahedra. New nodes
    /// lie on the cell, so that curved cells keep their shape and regions and sides their measure. Existing nodes keep
    /// their numbers.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if there are too many nodes.
    pub fn refined(&self) -> Result<Mesh, MeshError> {
        let mut nodes = RefinedNodes::new(self);
        let mut blocks: Vec<Block> = Vec::new();
        for block in &self.blocks {
            for cell in block.cells() {
                for (shape, corners) in children(block.element, &nodes.positions(block.element, cell)) {
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
                    for (_, corners) in children(element, &nodes.positions(element, facet)) {
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
        Ok(Mesh { points: nodes.points, blocks, facets, edges, regions: self.regions.clone(), ..*self })
    }
}

/// Adds a cell to the block of its element and region.
fn push(blocks: &mut Vec<Block>, element: &'static Element, region: usize, nodes: Vec<u32>) {
    match blocks.iter_mut().find(|block| block.region == region && std::ptr::eq(block.element, element)) {
        Some(block) => block.nodes.extend(nodes),
        None => blocks.push(Block { element, region, nodes }),
    }
}

/// The element of a part with this shape: only the tetrahedra in a pyramid have another shape.
fn element_of(parent: &'static Element, shape: Shape) -> &'static Element {
    if shape == parent.shape {
        parent
    } else if parent.degree == 2 {
        &P2_TETRAHEDRON
    } else {
        &P1_TETRAHEDRON
    }
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
        let mut values = [0.0; crate::element::MAX_NODES];
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
    let linear = crate::element::ALL.into_iter().find(|e| e.shape == shape && e.nodes.len() == vertices);
    let mut values = [0.0; crate::element::MAX_NODES];
    let Some(linear) = linear else { return *at };
    // Vertices are handled first: the functions of a pyramid are not defined at its apex.
    let near = |node: &Point| (0..3).all(|d| (node[d] - at[d]).abs() < 1e-9);
    if let Some(own) = linear.nodes.iter().position(near) {
        return corners[own];
    }
    (linear.shape_functions)(at, &mut values[..vertices]);
    std::array::from_fn(|d| corners.iter().zip(values).map(|(corner, value)| value * corner[d]).sum())
}

fn middle(a: &Point, b: &Point) -> Point {
    std::array::from_fn(|d| 0.5 * (a[d] + b[d]))
}

/// The parts of a reference cell; `x` are the positions of its vertices.
fn children(element: &Element, x: &[Point]) -> Vec<Child> {
    let v = &element.nodes[..element.shape.vertices()];
    let m = |i: usize, j: usize| middle(&v[i], &v[j]);
    let centre = || -> Point { std::array::from_fn(|d| v.iter().map(|p| p[d]).sum::<f64>() / v.len() as f64) };
    match element.shape {
        Shape::Point => vec![(Shape::Point, v.to_vec())],
        Shape::Segment => [[v[0], m(0, 1)], [m(0, 1), v[1]]].map(|part| (Shape::Segment, part.to_vec())).to_vec(),
        Shape::Triangle => triangles([v[0], v[1], v[2]]).map(|part| (Shape::Triangle, part.to_vec())).to_vec(),
        Shape::Quadrilateral => (0..4)
            .map(|i| {
                // The part at a vertex keeps the order of the vertices.
                let part = (0..4).map(|j| if j == i { v[i] } else { m_or_centre(i, j, v, centre()) });
                (Shape::Quadrilateral, part.collect())
            })
            .collect(),
        Shape::Tetrahedron => tetrahedra(v, x),
        Shape::Hexahedron => (0..8)
            .map(|i| {
                let part = (0..8).map(|j| std::array::from_fn(|d| 0.5 * (v[i][d] + v[j][d])));
                (Shape::Hexahedron, part.collect())
            })
            .collect(),
        Shape::Prism => {
            let [low, high] = [[v[0], v[1], v[2]], [v[3], v[4], v[5]]].map(triangles);
            let layers = low.iter().zip(&high).flat_map(|(low, high)| {
                let middle: Vec<Point> = low.iter().zip(high).map(|(a, b)| middle(a, b)).collect();
                [[low.to_vec(), middle.clone()].concat(), [middle, high.to_vec()].concat()]
            });
            layers.map(|part| (Shape::Prism, part)).collect()
        }
        Shape::Pyramid => pyramids(v),
    }
}

/// A vertex of the part of a square at its vertex i: the middle between both vertices, or the centre for the opposite
/// one.
fn m_or_centre(i: usize, j: usize, v: &[Point], centre: Point) -> Point {
    if (i + 2) % 4 == j { centre } else { middle(&v[i], &v[j]) }
}

fn triangles([a, b, c]: [Point; 3]) -> [[Point; 3]; 4] {
    let [ab, bc, ca] = [middle(&a, &b), middle(&b, &c), middle(&c, &a)];
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}

/// Four tetrahedra at the vertices, and four from the octahedron between them about its shortest diagonal.
fn tetrahedra(v: &[Point], x: &[Point]) -> Vec<Child> {
    let m = |i: usize, j: usize| middle(&v[i], &v[j]);
    let mut parts: Vec<Vec<Point>> = (0..4).map(|i| (0..4).map(|j| m(i, j)).collect()).collect();
    let opposite = [[(0, 1), (2, 3)], [(0, 2), (1, 3)], [(0, 3), (1, 2)]];
    let length = |[(a, b), (c, d)]: [(usize, usize); 2]| {
        let between: Point = std::array::from_fn(|k| x[a][k] + x[b][k] - x[c][k] - x[d][k]);
        dot(&between, &between)
    };
    let shortest = (0..3).min_by(|&i, &j| length(opposite[i]).total_cmp(&length(opposite[j]))).unwrap_or(0);
    let at = |(i, j): (usize, usize)| m(i, j);
    let [from, to] = opposite[shortest].map(at);
    let [[p, p_], [q, q_]] = [1, 2].map(|k| opposite[(shortest + k) % 3].map(at));
    let ring = [p, q, p_, q_];
    for k in 0..4 {
        parts.push(outward(vec![from, to, ring[k], ring[(k + 1) % 4]]));
    }
    parts.into_iter().map(|part| (Shape::Tetrahedron, part)).collect()
}

/// Exchanges two vertices of a tetrahedron if its volume is negative.
fn outward(mut part: Vec<Point>) -> Vec<Point> {
    let edge = |i: usize| -> Point { std::array::from_fn(|d| part[i][d] - part[0][d]) };
    let [u, v, w] = [edge(1), edge(2), edge(3)];
    let cross = [v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0]];
    if dot(&u, &cross) < 0.0 {
        part.swap(2, 3);
    }
    part
}

/// Pyramids at the vertices of the base and at the apex, one inverted between them, and tetrahedra next to it.
fn pyramids(v: &[Point]) -> Vec<Child> {
    let m = |i: usize, j: usize| middle(&v[i], &v[j]);
    let centre = middle(&m(0, 1), &m(2, 3));
    let base = [m(0, 1), m(1, 2), m(2, 3), m(3, 0)];
    let up = [m(0, 4), m(1, 4), m(2, 4), m(3, 4)];
    let mut parts: Vec<Child> = (0..4)
        .map(|i| (Shape::Pyramid, vec![v[i], base[i], centre, base[(i + 3) % 4], up[i]]))
        .chain([
            (Shape::Pyramid, vec![up[0], up[1], up[2], up[3], v[4]]),
            (Shape::Pyramid, vec![up[0], up[3], up[2], up[1], centre]),
        ])
        .collect();
    for i in 0..4 {
        parts.push((Shape::Tetrahedron, outward(vec![base[i], centre, up[i], up[(i + 1) % 4]])));
    }
    parts
}
