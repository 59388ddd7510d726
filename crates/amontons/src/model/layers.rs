//! Cells on Γ_C and the depth that heat reaches in them.

use serde::Serialize;

use super::height;
use crate::contact::{Contact, ContactPoint};
use crate::element::ShapeTable;
use crate::mesh::{FacetMap, FacetSet, Mesh};
use crate::problem::Problem;
use crate::tensor::{Point, dot};

/// The layer warmed by heat from a contact side.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ThermalLayer {
    /// Name of the side.
    pub side: String,
    /// Position of the thinnest layer relative to the cell, m.
    pub x: Point,
    /// Height of the cell there along the normal, m; half of it for quadratic elements.
    pub cell: f64,
    /// √(k K/c), the depth after a step k, m.
    pub step: f64,
    /// √(T K/c), the depth after the whole run, m.
    pub end: f64,
}

/// A cell at a facet: position, outward normal, height, and region.
#[derive(Clone, Copy, Debug)]
pub struct CellAtFacet {
    /// Middle of the facet, m.
    pub x: Point,
    /// Unit outward normal there.
    pub normal: Point,
    /// Largest distance of a node from the plane of the facet over the degree of the element, m.
    pub height: f64,
    /// Index into [`Mesh::regions`].
    pub region: usize,
}

/// The cells bounded by the facets of a side.
#[must_use]
pub fn cell_heights(mesh: &Mesh, set: &FacetSet) -> Vec<CellAtFacet> {
    let cells = mesh.cells_of(set);
    let mut all = Vec::with_capacity(cells.len());
    let mut number = 0;
    for block in &set.blocks {
        let table = ShapeTable::at(block.element, &[block.element.centre()]);
        let mut map = FacetMap::new(mesh, &table);
        for facet in block.nodes.chunks_exact(block.element.nodes.len()) {
            map.at(facet, 0);
            if let Some((b, c)) = cells.get(number).copied().flatten() {
                let element = mesh.blocks[b].element;
                let cell = &mesh.blocks[b].nodes[c * element.nodes.len()..(c + 1) * element.nodes.len()];
                let height = height(mesh, cell, &map.position, &map.normal) / element.degree.max(1) as f64;
                all.push(CellAtFacet { x: map.position, normal: map.normal, height, region: mesh.blocks[b].region });
            }
            number += 1;
        }
    }
    all
}

/// True if heat can enter the body through a contact: by exchange or by friction.
fn conducts(contact: &Contact) -> bool {
    let rubbing = ContactPoint { friction_power: 1.0, ..ContactPoint::default() };
    contact.heat.conductance_bound() > 0.0 || contact.heat.flux(&rubbing).value != 0.0
}

/// The layers of all contacts through which heat can enter; empty if heat is steady or the body does not conduct.
#[must_use]
pub fn thermal_layers(problem: &Problem) -> Vec<ThermalLayer> {
    let mesh = &*problem.mesh;
    let of_side = |contact: &Contact| {
        let cells = cell_heights(mesh, mesh.facets.get(&contact.on)?);
        let depth = |cell: &CellAtFacet| {
            let m = problem.material_of(cell.region)?;
            let (conductivity, capacity) = (m.conductivity.at(&cell.x), m.heat_capacity.at(&cell.x));
            let conductivity = dot(&cell.normal, &conductivity.apply(&cell.normal));
            (capacity > 0.0 && conductivity > 0.0).then(|| (conductivity / capacity).sqrt())
        };
        let worst = cells
            .iter()
            .filter_map(|cell| Some((cell, depth(cell)?)))
            .max_by(|a, b| (a.0.height / a.1).total_cmp(&(b.0.height / b.1)));
        let (cell, depth) = worst?;
        let [step, end] = [problem.timeline.longest(), problem.timeline.end()].map(|t| t.sqrt() * depth);
        Some(ThermalLayer { side: contact.on.clone(), x: cell.x, cell: cell.height, step, end })
    };
    problem.contacts.iter().filter(|contact| conducts(contact)).filter_map(of_side).collect()
}
