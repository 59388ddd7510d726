//! Cells and facets that are bisected, and how they are cut.

use super::nodes::BisectionNodes;
use super::order::{Edge, EdgeOrder, edge, edges_of};
use crate::element::{Element, Facet};
use crate::mesh::convert::quadratic_of;
use crate::quadrature::Shape;
use crate::tensor::Point;

/// The vertices of a cell or a facet, with what says where it is cut next.
#[derive(Clone, Debug)]
pub(super) enum Cuttable {
    Segment([u32; 2]),
    /// A triangle with the edge that is cut next.
    Triangle([u32; 3], Edge),
    Tetrahedron(MarkedTetrahedron),
    /// A quadrilateral, hexahedron, prism or pyramid that is whole so far, or a point: all its nodes.
    Whole(Vec<u32>),
}

/// A tetrahedron with the edge that is cut next on each face (Arnold, Mukherjee and Pouly, 2000).
#[derive(Clone, Copy, Debug)]
pub(super) struct MarkedTetrahedron {
    pub vertices: [u32; 4],
    /// The marked edge of the face opposite each vertex. Both faces beside `next` have it.
    marks: [Edge; 4],
    /// The edge that is cut next.
    next: Edge,
    /// True if it is planar and comes from a planar one.
    flag: bool,
}

/// A cell or a facet with its element.
#[derive(Clone, Debug)]
pub(super) struct CutCell {
    pub what: Cuttable,
    pub element: &'static Element,
    /// Block of the mesh from which it comes.
    pub block: usize,
}

/// Nodes and order of edges of a mesh that is bisected.
pub(super) struct Cutter {
    pub nodes: BisectionNodes,
    pub order: EdgeOrder,
}

impl Cutter {
    /// A cell or a facet of the mesh at the start.
    pub(super) fn cell(&self, element: &'static Element, nodes: &[u32], block: usize) -> CutCell {
        let what = match (element.shape, nodes) {
            (Shape::Segment, &[a, b, ..]) => Cuttable::Segment([a, b]),
            (Shape::Triangle, &[a, b, c, ..]) => self.triangle([a, b, c]),
            (Shape::Tetrahedron, &[a, b, c, d, ..]) => self.tetrahedron([a, b, c, d]),
            _ => Cuttable::Whole(nodes.to_vec()),
        };
        CutCell { what, element, block }
    }

    fn triangle(&self, vertices: [u32; 3]) -> Cuttable {
        Cuttable::Triangle(vertices, self.longest(vertices))
    }

    /// The edge of a triangle that is cut first.
    fn longest(&self, [a, b, c]: [u32; 3]) -> Edge {
        self.order.largest([edge(a, b), edge(b, c), edge(c, a)], &self.nodes.face_centres)
    }

    fn tetrahedron(&self, vertices: [u32; 4]) -> Cuttable {
        let [a, b, c, d] = vertices;
        let marks = [[b, c, d], [a, c, d], [a, b, d], [a, b, c]].map(|face| self.longest(face));
        let next = self.order.largest(marks, &self.nodes.face_centres);
        Cuttable::Tetrahedron(MarkedTetrahedron { vertices, marks, next, flag: false })
    }

    /// The edges of a cell.
    pub(super) fn edges(cell: &CutCell) -> Vec<Edge> {
        match &cell.what {
            Cuttable::Segment([a, b]) => vec![edge(*a, *b)],
            Cuttable::Triangle([a, b, c], _) => vec![edge(*a, *b), edge(*b, *c), edge(*c, *a)],
            Cuttable::Tetrahedron(MarkedTetrahedron { vertices, .. }) => {
                let pairs = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
                pairs.into_iter().map(|[i, j]: [usize; 2]| edge(vertices[i], vertices[j])).collect()
            }
            Cuttable::Whole(nodes) => {
                edges_of(cell.element).into_iter().map(|[a, b]| edge(nodes[a], nodes[b])).collect()
            }
        }
    }

    /// True if an edge of the cell is cut.
    fn is_cut(&self, cell: &CutCell) -> bool {
        let cut = |a: u32, b: u32| self.nodes.is_cut(a, b);
        match &cell.what {
            &Cuttable::Segment([a, b]) => cut(a, b),
            &Cuttable::Triangle([a, b, c], _) => cut(a, b) || cut(b, c) || cut(c, a),
            Cuttable::Tetrahedron(MarkedTetrahedron { vertices: [a, b, c, d], .. }) => {
                [(a, b), (a, c), (a, d), (b, c), (b, d), (c, d)].into_iter().any(|(a, b)| cut(*a, *b))
            }
            Cuttable::Whole(nodes) => {
                let element = cell.element;
                let own = matches!((element.shape, nodes.as_slice()), (Shape::Quadrilateral, &[a, b, c, d, ..])
                    if self.nodes.is_split([a, b, c, d]));
                let on_face = |facet: &Facet| four(facet, nodes).is_some_and(|face| self.nodes.is_split(face));
                own || Cutter::edges(cell).into_iter().any(|[a, b]| cut(a, b)) || element.facets.iter().any(on_face)
            }
        }
    }

    /// Cuts a cell until none of its edges is cut, and adds what results.
    pub(super) fn cut(&mut self, cell: CutCell, out: &mut Vec<CutCell>) {
        if !self.is_cut(&cell) {
            out.push(cell);
            return;
        }
        let CutCell { element, block, .. } = cell;
        let children = match cell.what {
            Cuttable::Segment([a, b]) => {
                let m = self.nodes.cut(edge(a, b));
                [[a, m], [m, b]].map(|ends| CutCell { what: Cuttable::Segment(ends), ..cell }).to_vec()
            }
            Cuttable::Triangle(vertices, mark) => self.halves_of_triangle(&cell, vertices, mark),
            Cuttable::Tetrahedron(marked) => self.halves_of_tetrahedron(&cell, &marked),
            Cuttable::Whole(nodes) => match element.shape {
                Shape::Quadrilateral => self.quarters(element, &nodes, block),
                _ => self.about_centre(element, &nodes, block),
            },
        };
        for child in children {
            self.cut(child, out);
        }
    }

    /// Cuts an edge and gives the cell its new middle nodes if it is quadratic.
    fn cut_edge(&mut self, element: &Element, vertices: &[u32], [p, q]: Edge) -> u32 {
        let m = self.nodes.cut([p, q]);
        if element.degree > 1 {
            for &opposite in vertices.iter().filter(|&&v| v != p && v != q) {
                self.nodes.median([p, q], m, opposite);
            }
        }
        m
    }

    /// Newest-vertex bisection: the halves are cut next at their edges opposite the new vertex.
    fn halves_of_triangle(&mut self, cell: &CutCell, vertices: [u32; 3], [p, q]: Edge) -> Vec<CutCell> {
        let m = self.cut_edge(cell.element, &vertices, [p, q]);
        let opposite = vertices.into_iter().find(|&v| v != p && v != q).unwrap_or(p);
        let half = |kept: u32, lost: u32| {
            let vertices = vertices.map(|v| if v == lost { m } else { v });
            CutCell { what: Cuttable::Triangle(vertices, edge(kept, opposite)), ..*cell }
        };
        vec![half(p, q), half(q, p)]
    }

    /// The halves of a tetrahedron with the marks of Arnold, Mukherjee and Pouly: a face that is kept keeps its mark,
    /// which the half is cut at next; a face that is cut is marked opposite the new vertex; the new face is, too, but
    /// between the new vertex and `next` of both halves if the tetrahedron is planar and flagged.
    fn halves_of_tetrahedron(&mut self, cell: &CutCell, parent: &MarkedTetrahedron) -> Vec<CutCell> {
        let MarkedTetrahedron { vertices, marks, next: [p, q], flag } = *parent;
        let m = self.cut_edge(cell.element, &vertices, [p, q]);
        let place = |vertex: u32| vertices.iter().position(|&v| v == vertex).unwrap_or(0);
        let (at_p, at_q) = (place(p), place(q));
        let mut others = vertices.into_iter().filter(|&v| v != p && v != q);
        let (a, b) = (others.next().unwrap_or(p), others.next().unwrap_or(p));
        // Planar: the marks of the kept faces meet in a vertex besides `next`, the three in one face.
        let meets = [a, b].into_iter().find(|&x| marks[at_q] == edge(p, x) && marks[at_p] == edge(q, x));
        let new_face = meets.filter(|_| flag).map_or(edge(a, b), |x| edge(m, x));
        let half = |kept: usize, lost: usize| {
            let (mut v, mut of_half) = (vertices, [new_face; 4]);
            v[lost] = m;
            of_half[lost] = marks[lost];
            for (face, other) in [(a, b), (b, a)] {
                of_half[place(face)] = edge(vertices[kept], other);
            }
            let flag = meets.is_some() && !flag;
            let marked = MarkedTetrahedron { vertices: v, marks: of_half, next: marks[lost], flag };
            CutCell { what: Cuttable::Tetrahedron(marked), ..*cell }
        };
        vec![half(at_p, at_q), half(at_q, at_p)]
    }

    /// The four triangles of a quadrilateral about its centre, which are cut next at its edges.
    fn quarters(&mut self, element: &'static Element, nodes: &[u32], block: usize) -> Vec<CutCell> {
        let centre = self.split_face(element, nodes);
        let Some(part) = Element::find(Shape::Triangle, element.degree) else { return Vec::new() };
        let triangle = |i: usize| self.cell(part, &[nodes[i], nodes[(i + 1) % 4], centre], block);
        (0..4).map(triangle).collect()
    }

    /// The node in the centre of a quadrilateral that is cut into triangles, with middle nodes if it is quadratic.
    fn split_face(&mut self, element: &'static Element, nodes: &[u32]) -> u32 {
        let centre = self.nodes.split_face(element, nodes);
        if element.degree > 1 {
            for (&vertex, at) in nodes.iter().zip(element.nodes).take(4) {
                self.nodes.set_middle([vertex, centre], (element, nodes), &between(at, &element.centre()));
            }
        }
        centre
    }

    /// The pyramids of a cell over its faces about its centre. Over a face that is cut there are four tetrahedra about
    /// the centre of the face instead; a pyramid becomes such four.
    fn about_centre(&mut self, element: &'static Element, nodes: &[u32], block: usize) -> Vec<CutCell> {
        let is_pyramid = element.shape == Shape::Pyramid;
        let top = if is_pyramid { nodes[4] } else { self.nodes.cell_centre(element, nodes) };
        let at_top = if is_pyramid { element.nodes[4] } else { element.centre() };
        if !is_pyramid && element.degree > 1 {
            for (&vertex, at) in nodes.iter().zip(element.nodes).take(element.shape.vertices()) {
                self.nodes.set_middle([vertex, top], (element, nodes), &between(at, &at_top));
            }
        }
        let [tetrahedron, pyramid] = [Shape::Tetrahedron, Shape::Pyramid].map(|s| Element::find(s, element.degree));
        let (Some(tetrahedron), Some(pyramid)) = (tetrahedron, pyramid) else { return Vec::new() };
        let mut cells = Vec::new();
        for facet in element.facets {
            let on_face: Vec<u32> = facet.nodes.iter().map(|&local| nodes[local]).collect();
            let is_split = four(facet, nodes).is_some_and(|face| is_pyramid || self.nodes.is_split(face));
            if facet.element.shape == Shape::Triangle {
                // The faces at the apex of a pyramid remain.
                if !is_pyramid {
                    cells.push(self.cell(tetrahedron, &[on_face[0], on_face[2], on_face[1], top], block));
                }
            } else if is_split {
                let centre = self.split_face(facet.element, &on_face);
                if element.degree > 1 {
                    let on_cell = facet.nodes.iter().take(4).map(|&local| element.nodes[local]);
                    let at_centre =
                        on_cell.fold([0.0; 3], |sum: Point, x| std::array::from_fn(|d| sum[d] + 0.25 * x[d]));
                    self.nodes.set_middle([centre, top], (element, nodes), &between(&at_centre, &at_top));
                }
                for i in 0..4 {
                    cells.push(self.cell(tetrahedron, &[on_face[i], centre, on_face[(i + 1) % 4], top], block));
                }
            } else {
                if element.degree > 1 {
                    self.nodes.face_centre(facet.element, &on_face);
                }
                let base = [on_face[0], on_face[3], on_face[2], on_face[1], top];
                cells.push(CutCell { what: Cuttable::Whole(self.all_nodes(pyramid, &base)), element: pyramid, block });
            }
        }
        cells
    }

    /// All nodes of a cell with these vertices.
    fn all_nodes(&mut self, element: &'static Element, vertices: &[u32]) -> Vec<u32> {
        let middles = middles_of(element);
        self.with_middles(vertices, &middles)
    }

    /// Vertices, followed by the middle nodes between those that are listed.
    pub(super) fn with_middles(&mut self, vertices: &[u32], middles: &[Vec<usize>]) -> Vec<u32> {
        let mut nodes = vertices.to_vec();
        for of in middles {
            match *of.as_slice() {
                [a, b] => nodes.push(self.nodes.middle_of(vertices[a], vertices[b])),
                [a, b, c, d] => {
                    let face = [a, b, c, d].map(|local| vertices[local]);
                    nodes.push(self.nodes.face_centre(&crate::element::Q1_QUADRILATERAL, &face));
                }
                _ => {}
            }
        }
        nodes
    }
}

/// The vertices of a facet with four of them.
fn four(facet: &Facet, nodes: &[u32]) -> Option<[u32; 4]> {
    let is_one = facet.element.shape == Shape::Quadrilateral;
    is_one.then(|| std::array::from_fn(|v| nodes[facet.nodes[v]]))
}

/// The vertices between which each middle node of an element lies; none of a linear element.
pub(super) fn middles_of(element: &'static Element) -> Vec<Vec<usize>> {
    let linear = if element.degree > 1 { Element::find(element.shape, 1) } else { None };
    linear.and_then(|linear| quadratic_of(linear).ok()).map_or_else(Vec::new, |(_, middles)| middles)
}

/// The point half-way between two.
fn between(a: &Point, b: &Point) -> Point {
    std::array::from_fn(|d| 0.5 * (a[d] + b[d]))
}
