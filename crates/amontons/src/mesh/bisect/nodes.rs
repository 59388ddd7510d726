//! The nodes of a mesh while its edges are bisected.

use std::collections::{HashMap, HashSet};

use super::order::{Edge, edge};
use crate::element::{Element, MAX_NODES};
use crate::mesh::Mesh;
use crate::tensor::{Point, dot, length, minus};

/// A side on a circle or a circular cylinder, onto which its new nodes are put.
#[derive(Clone, Copy, Debug)]
pub struct RoundSide {
    /// A point of the axis, m.
    pub through: Point,
    /// Direction of the axis, of length 1; in the plane z.
    pub axis: Point,
    /// Radius in m.
    pub radius: f64,
}

impl RoundSide {
    /// The nearest point of the cylinder; the point itself if it is on the axis.
    fn onto(&self, x: &Point) -> Point {
        let from = minus(x, &self.through);
        let along = dot(&from, &self.axis);
        let across: Point = std::array::from_fn(|d| from[d] - along * self.axis[d]);
        let distance = length(&across);
        if distance > 0.0 {
            let stretch = self.radius / distance - 1.0;
            std::array::from_fn(|d| x[d] + stretch * across[d])
        } else {
            *x
        }
    }
}

/// The nodes of the mesh, and those in the middle of edges and faces.
pub(super) struct BisectionNodes {
    /// Coordinates in m.
    pub points: Vec<Point>,
    /// The vertex in the middle of each edge that is cut in this round.
    cut: HashMap<Edge, u32>,
    /// True for the ends of edges that are cut in this round.
    is_touched: Vec<bool>,
    /// The middle node of each edge of a quadratic cell.
    middle: HashMap<Edge, u32>,
    /// The node in the centre of a quadrilateral with these vertices, ascending.
    centre: HashMap<[u32; 4], u32>,
    /// The faces that are cut into triangles in this round, by their vertices, ascending.
    split: HashSet<[u32; 4]>,
    /// All nodes in centres of faces.
    pub face_centres: HashSet<u32>,
    rounds: Vec<RoundSide>,
    /// The round side on which a node lies.
    round: HashMap<u32, usize>,
}

impl BisectionNodes {
    pub(super) fn new(mesh: &Mesh) -> BisectionNodes {
        BisectionNodes {
            points: mesh.points.clone(),
            cut: HashMap::new(),
            is_touched: Vec::new(),
            middle: HashMap::new(),
            centre: HashMap::new(),
            split: HashSet::new(),
            face_centres: HashSet::new(),
            rounds: Vec::new(),
            round: HashMap::new(),
        }
    }

    /// Puts all new nodes between these onto a round side.
    pub(super) fn add_round(&mut self, round: RoundSide, nodes: &[u32]) {
        self.round.extend(nodes.iter().map(|&node| (node, self.rounds.len())));
        self.rounds.push(round);
    }

    /// Puts the new nodes of a mesh whose every edge was halved onto the round sides, given the nodes between which
    /// each lies. Returns the nodes of the round sides with these.
    pub(super) fn halved(&self, mesh: &mut Mesh, origins: &[Vec<u32>]) -> Vec<(Vec<u32>, RoundSide)> {
        let mut sides: Vec<(Vec<u32>, RoundSide)> = self.rounds.iter().map(|round| (Vec::new(), *round)).collect();
        for (&node, &round) in &self.round {
            sides.iter_mut().skip(round).take(1).for_each(|(nodes, _)| nodes.push(node));
        }
        for (new, origin) in origins.iter().enumerate() {
            let Some(round) = origin.first().and_then(|first| self.round.get(first)) else { continue };
            let Some((nodes, side)) = sides.get_mut(*round) else { continue };
            if origin.iter().all(|node| self.round.get(node) == Some(round)) {
                let node = mesh.points.len() - origins.len() + new;
                mesh.points[node] = side.onto(&mesh.points[node]);
                nodes.push(node as u32);
            }
        }
        sides
    }

    /// Forgets the edges and faces that earlier rounds have cut: no cell has them any more.
    pub(super) fn start_round(&mut self) {
        self.cut.clear();
        self.split.clear();
        self.is_touched.clear();
        self.is_touched.resize(self.points.len(), false);
    }

    /// Number of edges and faces that are cut in this round.
    pub(super) fn cuts(&self) -> usize {
        self.cut.len() + self.split.len()
    }

    /// True if a face with four vertices is cut into triangles, or has to be because one of its edges is cut.
    pub(super) fn is_split(&self, vertices: [u32; 4]) -> bool {
        let [a, b, c, d] = vertices;
        self.split.contains(&sorted(vertices))
            || [(a, b), (b, c), (c, d), (d, a)].into_iter().any(|(a, b)| self.is_cut(a, b))
    }

    /// True if the edge between two vertices is cut.
    pub(super) fn is_cut(&self, a: u32, b: u32) -> bool {
        let touched = |node: u32| self.is_touched.get(node as usize).copied().unwrap_or(false);
        touched(a) && touched(b) && self.cut.contains_key(&edge(a, b))
    }

    /// The middle nodes of a quadratic cell or facet, given the vertices between which each lies.
    pub(super) fn know(&mut self, element: &Element, nodes: &[u32], middles: &[Vec<usize>]) {
        for (&node, of) in nodes.iter().skip(element.shape.vertices()).zip(middles) {
            match *of.as_slice() {
                [a, b] => {
                    self.middle.insert(edge(nodes[a], nodes[b]), node);
                }
                [a, b, c, d] => {
                    self.centre.insert(sorted([nodes[a], nodes[b], nodes[c], nodes[d]]), node);
                }
                _ => {}
            }
        }
    }

    /// Adds a node at a position between others; on a round side if they all are.
    fn add(&mut self, at: Point, between: &[u32]) -> u32 {
        let node = self.points.len() as u32;
        let round = between.first().and_then(|first| self.round.get(first).copied());
        let round = round.filter(|round| between.iter().all(|node| self.round.get(node) == Some(round)));
        let Some(round) = round else {
            self.points.push(at);
            return node;
        };
        self.round.insert(node, round);
        self.points.push(self.rounds[round].onto(&at));
        node
    }

    /// A sum of positions with weights.
    fn sum<const N: usize>(&self, terms: [(f64, u32); N]) -> Point {
        std::array::from_fn(|d| terms.iter().map(|&(weight, node)| weight * self.points[node as usize][d]).sum())
    }

    /// The vertex in the middle of an edge, which is cut from now on. A quadratic edge is cut at its middle node; its
    /// halves keep its curve.
    pub(super) fn cut(&mut self, [a, b]: Edge) -> u32 {
        if let Some(&vertex) = self.cut.get(&[a, b]) {
            return vertex;
        }
        let quadratic = self.middle.get(&[a, b]).copied();
        let vertex = quadratic.unwrap_or_else(|| self.add(self.sum([(0.5, a), (0.5, b)]), &[a, b]));
        if let Some(m) = quadratic {
            for (end, other) in [(a, b), (b, a)] {
                let at = self.sum([(0.375, end), (0.75, m), (-0.125, other)]);
                let node = self.add(at, &[end, m]);
                self.middle.insert(edge(end, m), node);
            }
        }
        self.is_touched.resize(self.points.len(), false);
        self.is_touched[a as usize] = true;
        self.is_touched[b as usize] = true;
        self.cut.insert([a, b], vertex);
        vertex
    }

    /// The middle node between the vertex `m` that cuts an edge and a vertex opposite, on the quadratic face of both.
    pub(super) fn median(&mut self, [a, b]: Edge, m: u32, opposite: u32) {
        if self.middle.contains_key(&edge(m, opposite)) {
            return;
        }
        let [p, q] = [a, b].map(|end| self.middle_of(end, opposite));
        let at = self.sum([(-0.125, a), (-0.125, b), (0.25, m), (0.5, p.min(q)), (0.5, p.max(q))]);
        let node = self.add(at, &[m, opposite]);
        self.middle.insert(edge(m, opposite), node);
    }

    /// The middle node of an edge; half-way between its ends if no cell has given it.
    pub(super) fn middle_of(&mut self, a: u32, b: u32) -> u32 {
        let key = edge(a, b);
        if let Some(&node) = self.middle.get(&key) {
            return node;
        }
        let node = self.add(self.sum([(0.5, key[0]), (0.5, key[1])]), &key);
        self.middle.insert(key, node);
        node
    }

    /// Sets the middle node of a new edge to a position in a cell or a face, unless a neighbour has set it.
    pub(super) fn set_middle(&mut self, [a, b]: Edge, cell: (&Element, &[u32]), at: &Point) {
        let key = edge(a, b);
        if !self.middle.contains_key(&key) {
            let node = self.add(self.place(cell, at), &key);
            self.middle.insert(key, node);
        }
    }

    /// The node in the centre of a quadrilateral.
    pub(super) fn face_centre(&mut self, element: &Element, nodes: &[u32]) -> u32 {
        let vertices: [u32; 4] = std::array::from_fn(|v| nodes.get(v).copied().unwrap_or_default());
        let key = sorted(vertices);
        let node = self.centre.get(&key).copied();
        let node = node.unwrap_or_else(|| self.add(self.place((element, nodes), &element.centre()), &key));
        self.centre.insert(key, node);
        self.face_centres.insert(node);
        node
    }

    /// Cuts a face into triangles about its centre: the cells on both of its sides are cut.
    pub(super) fn split_face(&mut self, element: &Element, nodes: &[u32]) -> u32 {
        self.split.insert(sorted(std::array::from_fn(|v| nodes.get(v).copied().unwrap_or_default())));
        self.face_centre(element, nodes)
    }

    /// The node in the centre of a cell: its own, or a new one.
    pub(super) fn cell_centre(&mut self, element: &Element, nodes: &[u32]) -> u32 {
        let centre = element.centre();
        let own = element.nodes.iter().position(|x| (0..3).all(|d| (x[d] - centre[d]).abs() < 1e-9));
        let own = own.and_then(|local| nodes.get(local).copied());
        own.unwrap_or_else(|| self.add(self.place((element, nodes), &centre), &[]))
    }

    /// The position of a reference point of a cell or a face, summed in the order of the nodes, so that all cells that
    /// share it give the same bits.
    fn place(&self, (element, nodes): (&Element, &[u32]), at: &Point) -> Point {
        let mut values = [0.0; MAX_NODES];
        (element.shape_functions)(at, &mut values[..element.nodes.len()]);
        let mut shares: Vec<(u32, f64)> = nodes.iter().copied().zip(values).collect();
        shares.sort_by_key(|(node, _)| *node);
        std::array::from_fn(|d| shares.iter().map(|&(node, share)| share * self.points[node as usize][d]).sum())
    }
}

fn sorted(mut nodes: [u32; 4]) -> [u32; 4] {
    nodes.sort_unstable();
    nodes
}
