//! Contents of a mesh without a case: cells, regions, sides, and defects.

use std::collections::{BTreeMap, HashSet};

use serde::Serialize;

use super::integral;
use crate::element::Element;
use crate::mesh::defects::{components, defects};
use crate::mesh::{FacetKey, FacetSet, Mesh, facet_key};
use crate::tensor::Point;

/// The contents of a mesh. Lengths are in the unit of its coordinates; in two dimensions volumes and areas are per unit
/// of thickness, for a body of revolution those of the whole body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeshModel {
    /// Dimension d.
    pub dimension: usize,
    /// True if it is the half section of a body of revolution.
    pub axisymmetric: bool,
    /// Number of nodes.
    pub nodes: usize,
    /// Number of cells of each element type.
    pub cells: BTreeMap<&'static str, usize>,
    /// Least and largest coordinates.
    #[serde(rename = "box")]
    pub bounds: [Vec<f64>; 2],
    /// Number of parts connected by common nodes.
    pub parts: usize,
    /// Cells and volume of each region, in the order of the mesh.
    pub regions: Vec<Size>,
    /// Facets and area of each side, by name.
    pub sides: Vec<Size>,
    /// Elements and length of each named edge of a body in space.
    pub edges: Vec<Size>,
    /// Number of points in each named set, which is also its measure.
    pub points: Vec<Size>,
    /// Facets of the boundary in no side.
    pub unnamed_facets: usize,
    /// The worst quality of a cell, from 0 (flat) to 1 (regular), and the centre of this cell.
    pub quality: (f64, Point),
    /// Faults of cells and sides in words; a run refuses those of cells, and those of the sides that it uses.
    pub defects: Vec<String>,
}

/// The size of a region, a side, an edge or of points.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Size {
    /// Its name.
    pub name: String,
    /// Number of its cells or facets.
    pub count: usize,
    /// Its volume, area or length, or the number of points.
    pub measure: f64,
    /// True if it is a side that is the whole boundary, as a set of all nodes is.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub is_whole_boundary: bool,
}

impl MeshModel {
    /// Measures a mesh.
    #[must_use]
    pub fn new(mesh: &Mesh) -> MeshModel {
        let bound = |fold: fn(f64, f64) -> f64, start: f64| {
            (0..mesh.dim).map(|d| mesh.points.iter().map(|p| p[d]).fold(start, fold)).collect()
        };
        let mut cells = BTreeMap::new();
        for block in &mesh.blocks {
            *cells.entry(block.element.name).or_insert(0) += block.len();
        }
        let region = |(number, name): (usize, &String)| {
            let blocks = mesh.blocks.iter().filter(|block| block.region == number);
            let (count, measure) = blocks.fold((0, 0.0), |(count, measure), block| {
                (count + block.len(), measure + integral(mesh, block, |_| 1.0))
            });
            Size { name: name.clone(), count, measure, is_whole_boundary: false }
        };
        MeshModel {
            dimension: mesh.dim,
            axisymmetric: mesh.axisymmetric,
            nodes: mesh.points.len(),
            cells,
            bounds: [bound(f64::min, f64::INFINITY), bound(f64::max, f64::NEG_INFINITY)],
            parts: components(mesh).len(),
            regions: mesh.regions.iter().enumerate().map(region).collect(),
            sides: sides(mesh),
            edges: named(mesh, &mesh.edges, |dim| dim == 1),
            points: named(mesh, &mesh.edges, |dim| dim == 0),
            unnamed_facets: mesh.unnamed_boundary_facets(),
            quality: mesh.worst_quality(),
            defects: defects(mesh).iter().map(ToString::to_string).collect(),
        }
    }
}

/// The sizes of the sides; marks those that are the whole boundary.
fn sides(mesh: &Mesh) -> Vec<Size> {
    let vertices = |(element, nodes): (&'static Element, &[u32])| facet_key(element, nodes.iter().copied());
    let boundary: HashSet<FacetKey> = mesh.boundary().facets().map(vertices).collect();
    let mut sides = named(mesh, &mesh.facets, |_| true);
    for side in &mut sides {
        let own = mesh.facets.get(&side.name).filter(|set| set.len() == boundary.len());
        side.is_whole_boundary = own.is_some_and(|set| set.facets().all(|facet| boundary.contains(&vertices(facet))));
    }
    sides
}

/// The sizes of the sets whose elements have an accepted dimension.
fn named(mesh: &Mesh, sets: &BTreeMap<String, FacetSet>, is_of: impl Fn(usize) -> bool) -> Vec<Size> {
    let dimension = |set: &FacetSet| set.blocks.iter().map(|block| block.element.dim()).max().unwrap_or(0);
    let size = |(name, set): (&String, &FacetSet)| Size {
        name: name.clone(),
        count: set.len(),
        measure: mesh.measure(set),
        is_whole_boundary: false,
    };
    sets.iter().filter(|(_, set)| is_of(dimension(set))).map(size).collect()
}
