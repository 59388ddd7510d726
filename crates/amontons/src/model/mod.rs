//! The size of a model before it is run: lengths, areas, masses, times, and the cost of a step.

mod cost;
mod layers;
mod mesh;
mod supports;
mod times;

use std::collections::BTreeMap;

use serde::Serialize;

pub use cost::Cost;
pub use layers::{ThermalLayer, cell_heights, thermal_layers};
pub use mesh::{MeshModel, Size};
pub use supports::rigid_motions;
pub use times::Times;

use crate::element::ShapeTable;
use crate::mesh::defects::components;
use crate::mesh::{Block, CellMap, Mesh};
use crate::problem::Problem;
use crate::tensor::Point;

/// The size of a model. In two dimensions volume, mass and areas are per metre of thickness; for a body of revolution
/// those of the whole body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Model {
    /// Least and largest coordinates, m.
    #[serde(rename = "box")]
    pub bounds: [Vec<f64>; 2],
    /// Volume, m³.
    pub volume: f64,
    /// Mass, kg.
    pub mass: f64,
    /// Number of parts connected by common nodes.
    pub parts: usize,
    /// Number of sectors of the whole, if the body is cyclic. Volume, mass and areas are those of one sector.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sectors: Option<usize>,
    /// Area of each named side, m².
    pub sides: BTreeMap<String, f64>,
    /// Contact points per bearing side, summed over its contacts.
    pub contact_points: BTreeMap<String, usize>,
    /// Time scales.
    pub times: Times,
    /// Depth that heat reaches from the contact sides.
    pub thermal_layers: Vec<ThermalLayer>,
    /// Work and memory of a step.
    pub cost: Cost,
}

impl Model {
    /// Measures a problem. Two factorizations give the time scales; the cost is counted without any.
    #[must_use]
    pub fn new(problem: &Problem) -> Model {
        let mesh = &*problem.mesh;
        let bound = |fold: fn(f64, f64) -> f64, start: f64| {
            (0..mesh.dim).map(|d| mesh.points.iter().map(|p| p[d]).fold(start, fold)).collect()
        };
        let volumes = volumes(mesh);
        let mass = |(block, volume): (&Block, &f64)| {
            let density = problem.material_of(block.region).map(|m| &m.density)?;
            Some(match density.constant() {
                Some(density) => density * volume,
                None => integral(mesh, block, |x| density.at(x)),
            })
        };
        let boundary = problem.contact_boundary();
        let mut contact_points: BTreeMap<String, usize> = BTreeMap::new();
        for (side, contact) in problem.contacts.iter().enumerate() {
            let of_contact = boundary.points.iter().filter(|point| point.contact == side).count();
            *contact_points.entry(contact.bearing().to_owned()).or_default() += of_contact;
        }
        Model {
            bounds: [bound(f64::min, f64::INFINITY), bound(f64::max, f64::NEG_INFINITY)],
            volume: volumes.iter().sum(),
            mass: mesh.blocks.iter().zip(&volumes).filter_map(mass).sum(),
            parts: components(mesh).len(),
            sectors: problem.cyclic.first().and_then(|cyclic| Some(cyclic.links(mesh).ok()?.1)),
            sides: mesh.facets.iter().map(|(name, set)| (name.clone(), mesh.measure(set))).collect(),
            contact_points,
            times: Times::new(problem),
            thermal_layers: thermal_layers(problem),
            cost: Cost::new(problem),
        }
    }
}

/// Volume of each block of cells, m³.
fn volumes(mesh: &Mesh) -> Vec<f64> {
    mesh.blocks.iter().map(|block| integral(mesh, block, |_| 1.0)).collect()
}

/// The integral of a function over the cells of a block.
fn integral(mesh: &Mesh, block: &Block, value: impl Fn(&Point) -> f64) -> f64 {
    let table = ShapeTable::new(block.element, mesh.dim * block.element.degree + usize::from(mesh.axisymmetric));
    let mut map = CellMap::new(mesh, &table);
    let mut sum = 0.0;
    for cell in block.cells() {
        for (q, weight) in table.weights.iter().enumerate() {
            map.at(cell, q);
            sum += weight * map.measure * value(&map.position);
        }
    }
    sum
}

/// Largest distance of a node of a cell from the plane through `x` across `normal`, m.
fn height(mesh: &Mesh, cell: &[u32], x: &Point, normal: &Point) -> f64 {
    let distance = |&node: &u32| {
        let p = &mesh.points[node as usize];
        (0..3).map(|d| (p[d] - x[d]) * normal[d]).sum::<f64>().abs()
    };
    cell.iter().map(distance).fold(0.0, f64::max)
}
