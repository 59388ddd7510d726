//! Cells, facets and vertices of a mesh, and who shares them.

use std::collections::HashMap;

use super::Refused;
use super::modes::FacetModes;
use crate::element::{Element, ShapeTable};
use crate::forms::data_degree;
use crate::mesh::{FacetKey, Mesh, facet_key};
use crate::quadrature::{Shape, rule};
use crate::tensor::{Point, length};

/// Distance of a middle node from the middle, relative to the size of the cell, that is round-off of a file.
const STRAIGHT: f64 = 1e-9;

/// A cell: its block, its number in the block, and its facets.
#[derive(Clone, Debug)]
pub(super) struct SkeletonCell {
    pub block: usize,
    pub number: usize,
    pub facets: Vec<usize>,
}

/// A facet: its vertices, around it from the least one to the lesser of its neighbours, and its cells with the number
/// of the facet there.
#[derive(Clone, Debug)]
pub(super) struct SkeletonFacet {
    pub vertices: Vec<u32>,
    pub cells: Vec<(usize, usize)>,
}

impl SkeletonFacet {
    /// +1 for the first cell, from which normals point, and −1 for the other one.
    pub fn sign(&self, cell: usize) -> f64 {
        if self.cells.first().is_some_and(|first| first.0 == cell) { 1.0 } else { -1.0 }
    }

    /// The place of a vertex.
    pub fn place(&self, vertex: u32) -> Option<usize> {
        self.vertices.iter().position(|own| *own == vertex)
    }
}

/// A facet of the reference cell: points with weights, and the linear functions of its vertices there.
#[derive(Debug)]
pub(super) struct FacetPoints {
    /// The functions of the cell at the points.
    pub table: ShapeTable,
    /// Points of the reference facet.
    pub own: ShapeTable,
    /// Values of the linear functions of the facet, per point and vertex.
    pub hats: Vec<Vec<f64>>,
}

/// What cells of one element need.
#[derive(Debug)]
pub(super) struct ElementTables {
    pub element: &'static Element,
    /// The points at which the forms of the body are integrated, and those of loads.
    pub body: ShapeTable,
    pub load: ShapeTable,
    /// The vertices as points.
    pub vertices: ShapeTable,
    /// Value of the linear function of each vertex at each node: `hats[vertex][node]`.
    pub hats: Vec<Vec<f64>>,
    pub facets: Vec<FacetPoints>,
}

/// The values of the linear functions of a shape at a point, one per vertex.
pub(super) fn linear_functions(shape: Shape, element: &Element, x: &Point) -> Vec<f64> {
    let linear = Element::find(shape, 1).filter(|linear| linear.nodes.len() == shape.vertices());
    let linear = linear.unwrap_or(element);
    let mut values = vec![1.0; linear.nodes.len()];
    if shape != Shape::Point {
        (linear.shape_functions)(x, &mut values);
    }
    values
}

impl ElementTables {
    fn new(mesh: &Mesh, element: &'static Element) -> ElementTables {
        let n = element.shape.vertices();
        let at_nodes: Vec<Vec<f64>> =
            element.nodes.iter().map(|x| linear_functions(element.shape, element, x)).collect();
        let facets = element.facets.iter().map(|facet| {
            let own = facet.element;
            let points = rule(own.shape, 2 * element.degree.max(element.gradient_degree) + 2).points;
            let hats: Vec<Vec<f64>> = points.iter().map(|x| linear_functions(own.shape, own, x)).collect();
            let in_cell = |hats: &Vec<f64>| -> Point {
                let vertices = || facet.nodes.iter().take(own.shape.vertices()).map(|&node| element.nodes[node]);
                std::array::from_fn(|c| vertices().zip(hats).map(|(x, value)| value * x[c]).sum())
            };
            let inside: Vec<Point> = hats.iter().map(in_cell).collect();
            FacetPoints {
                table: ShapeTable::at(element, &inside),
                own: ShapeTable::new(own, 2 * element.degree.max(element.gradient_degree) + 2),
                hats,
            }
        });
        ElementTables {
            element,
            body: ShapeTable::new(element, mesh.gradient_products(element)),
            load: ShapeTable::new(element, data_degree(element)),
            vertices: ShapeTable::at(element, &element.nodes[..n]),
            hats: (0..n).map(|vertex| at_nodes.iter().map(|values| values[vertex]).collect()).collect(),
            facets: facets.collect(),
        }
    }
}

/// The skeleton of a mesh.
#[derive(Debug)]
pub(super) struct Skeleton {
    pub cells: Vec<SkeletonCell>,
    pub facets: Vec<SkeletonFacet>,
    /// The frame of each facet.
    pub modes: Vec<FacetModes>,
    /// The largest number of components of a traction on a facet.
    pub stride: usize,
    /// The cells of each node that is a vertex, with its number there.
    pub stars: Vec<Vec<(usize, usize)>>,
    /// Per block.
    pub tables: Vec<ElementTables>,
    by_key: HashMap<FacetKey, usize>,
}

impl Skeleton {
    /// The skeleton of a mesh of straight segments, triangles, quadrilaterals, tetrahedra or parallelepipeds.
    ///
    /// # Errors
    /// If a cell has another shape or is curved, or three cells share a facet.
    pub fn new(mesh: &Mesh) -> Result<Skeleton, Refused> {
        let (mut cells, mut facets) = (Vec::new(), Vec::<SkeletonFacet>::new());
        let mut by_key: HashMap<FacetKey, usize> = HashMap::new();
        let mut stars = vec![Vec::new(); mesh.points.len()];
        for (b, block) in mesh.blocks.iter().enumerate() {
            check_shape(mesh, block.element)?;
            for (number, nodes) in block.cells().enumerate() {
                check_straight(mesh, block.element, nodes)?;
                let cell = cells.len();
                for (vertex, &node) in nodes.iter().take(block.element.shape.vertices()).enumerate() {
                    stars[node as usize].push((cell, vertex));
                }
                let mut own = Vec::new();
                for (local, facet) in block.element.facets.iter().enumerate() {
                    let key = facet_key(facet.element, facet.nodes.iter().map(|&node| nodes[node]));
                    let at = *by_key.entry(key).or_insert_with(|| {
                        let corners = facet.nodes.iter().take(facet.element.shape.vertices());
                        let vertices = around(corners.map(|&node| nodes[node]).collect());
                        facets.push(SkeletonFacet { vertices, cells: Vec::new() });
                        facets.len() - 1
                    });
                    facets[at].cells.push((cell, local));
                    own.push(at);
                }
                cells.push(SkeletonCell { block: b, number, facets: own });
            }
        }
        if facets.iter().any(|facet| facet.cells.len() > 2) {
            return Err(Refused::new("more than two cells share a facet"));
        }
        let tables = mesh.blocks.iter().map(|block| ElementTables::new(mesh, block.element)).collect();
        let at = |facet: &SkeletonFacet| {
            let vertices: Vec<Point> = facet.vertices.iter().map(|&node| mesh.points[node as usize]).collect();
            FacetModes::new(mesh.dim, &vertices)
        };
        let modes: Vec<FacetModes> = facets.iter().map(at).collect();
        let stride = modes.iter().map(FacetModes::components).max().unwrap_or(0);
        Ok(Skeleton { cells, facets, modes, stride, stars, tables, by_key })
    }

    /// The vertex of a simplex opposite to its facet with a number.
    pub fn opposite(&self, cell: usize, local: usize) -> usize {
        let element = self.tables(cell).element;
        let n = element.shape.vertices();
        (0..n).find(|vertex| !element.facets[local].nodes[..n - 1].contains(vertex)).unwrap_or(0)
    }

    /// The number in a cell of a vertex of a facet.
    pub fn corner(&self, mesh: &Mesh, (cell, facet): (usize, usize), slot: usize) -> usize {
        let node = self.facets[facet].vertices.get(slot);
        self.nodes(mesh, cell).iter().position(|own| Some(own) == node).unwrap_or(0)
    }

    /// The nodes of a cell.
    pub fn nodes<'m>(&self, mesh: &'m Mesh, cell: usize) -> &'m [u32] {
        let SkeletonCell { block, number, .. } = &self.cells[cell];
        let block = &mesh.blocks[*block];
        let n = block.element.nodes.len();
        &block.nodes[number * n..(number + 1) * n]
    }

    /// The tables of a cell.
    pub fn tables(&self, cell: usize) -> &ElementTables {
        &self.tables[self.cells[cell].block]
    }

    /// The number of a facet.
    pub fn find(&self, element: &Element, nodes: &[u32]) -> Option<usize> {
        self.by_key.get(&facet_key(element, nodes.iter().copied())).copied()
    }
}

/// Vertices around a facet from the least one to the lesser of its neighbours.
fn around(mut vertices: Vec<u32>) -> Vec<u32> {
    let n = vertices.len();
    let least = (0..n).min_by_key(|&i| vertices[i]).unwrap_or(0);
    vertices.rotate_left(least);
    if n > 2 && vertices[n - 1] < vertices[1] {
        vertices[1..].reverse();
    }
    vertices
}

fn check_shape(mesh: &Mesh, element: &Element) -> Result<(), Refused> {
    let known = [Shape::Segment, Shape::Triangle, Shape::Quadrilateral, Shape::Tetrahedron, Shape::Hexahedron];
    if element.dim() != mesh.dim || !known.contains(&element.shape) {
        return Err(Refused::new(&format!("cells of the element {}", element.name)));
    }
    Ok(())
}

/// Checks that the nodes that are no vertices lie where the linear functions of the vertices put them.
fn check_straight(mesh: &Mesh, element: &Element, nodes: &[u32]) -> Result<(), Refused> {
    let n = element.shape.vertices();
    if nodes.len() == n && element.shape != Shape::Hexahedron {
        return Ok(());
    }
    let at = |node: u32| mesh.points[node as usize];
    let size = nodes.iter().map(|&node| length(&std::array::from_fn(|c| at(node)[c] - at(nodes[0])[c])));
    let size = size.fold(0.0, f64::max);
    if element.shape == Shape::Hexahedron {
        // Edges 0–1, 0–3 and 0–4 span the cell.
        let is_off = |vertex: usize| {
            let span = |c: usize| [1, 3, 4].map(|end| at(nodes[end])[c] - at(nodes[0])[c]);
            let of = |c: usize| {
                at(nodes[0])[c] + span(c).iter().zip(&element.nodes[vertex]).map(|(a, x)| a * x).sum::<f64>()
            };
            length(&std::array::from_fn(|c| at(nodes[vertex])[c] - of(c))) > STRAIGHT * size
        };
        if (0..n).any(is_off) {
            return Err(Refused::new("hexahedra whose facets are no parallelograms"));
        }
    }
    for (&node, x) in nodes.iter().zip(element.nodes).skip(n) {
        let hats = linear_functions(element.shape, element, x);
        let off = std::array::from_fn(|c| {
            at(node)[c] - hats.iter().zip(nodes).map(|(value, &vertex)| value * at(vertex)[c]).sum::<f64>()
        });
        if length(&off) > STRAIGHT * size {
            return Err(Refused::new("cells with curved sides"));
        }
    }
    Ok(())
}
