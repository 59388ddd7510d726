//! The mesh of a case.

use std::collections::BTreeMap;

use super::build::Build;
use super::memory::{self, MeshDemand, MeshSize};
use super::path::Path;
use super::place::At;
use super::raw;
use super::side_names::SideNames;
use crate::element::Element;
use crate::machine::FreeMemory;
use crate::mesh::defects::{Defects, defects};
use crate::mesh::{self, Block, Diagonal, Elements, Mesh, MeshError, PlaneState};
use crate::quadrature::Shape;

/// The key of a mesh file.
const FILE: &str = "mesh.file";

/// A reference from a case to a mesh file.
pub(super) struct FileOf<'c> {
    pub name: &'c str,
    pub scale: f64,
    /// True if the case declares it the half section of a body of revolution.
    pub axisymmetric: bool,
}

/// A mesh from a file, with the stress state that its elements say, if any.
pub(super) struct MeshFromFile {
    pub mesh: Mesh,
    pub plane: Option<PlaneState>,
}

/// Cells per direction of a generated mesh, empty for several blocks; for a mesh file the parts of each edge.
pub(super) fn cells(raw: &raw::Mesh) -> Vec<usize> {
    match *raw {
        raw::Mesh::Interval { n, .. } => vec![n],
        raw::Mesh::Rectangle { n, .. } | raw::Mesh::Disc { n, .. } | raw::Mesh::Ring { n, .. } => n.each().to_vec(),
        raw::Mesh::Box { n, .. } | raw::Mesh::Cylinder { n, .. } => n.each().to_vec(),
        raw::Mesh::File { refine, .. } => vec![1 << refine],
        raw::Mesh::Blocks { .. } => Vec::new(),
    }
}

/// Cells per direction of each of several blocks.
pub(super) fn blocks(raw: &raw::Mesh) -> Vec<Vec<usize>> {
    match raw {
        raw::Mesh::Blocks { blocks, .. } => blocks.iter().map(|block| block.n.clone()).collect(),
        _ => Vec::new(),
    }
}

fn elements(raw: raw::Elements) -> Elements {
    match raw {
        raw::Elements::P1 => Elements::P1,
        raw::Elements::P2 => Elements::P2,
        raw::Elements::Q1 => Elements::Q1,
        raw::Elements::Q2 => Elements::Q2,
    }
}

fn diagonal(raw: Option<raw::Diagonal>) -> Diagonal {
    match raw.unwrap_or_default() {
        raw::Diagonal::Right => Diagonal::Right,
        raw::Diagonal::Left => Diagonal::Left,
        raw::Diagonal::Crossed => Diagonal::Crossed,
    }
}

/// A body without cells.
fn empty() -> Mesh {
    Mesh {
        dim: 2,
        axisymmetric: false,
        thickness: None,
        points: Vec::new(),
        blocks: Vec::new(),
        regions: Vec::new(),
        facets: BTreeMap::new(),
        edges: BTreeMap::new(),
    }
}

/// The generated mesh with these cells per direction.
pub(super) fn generate(raw: &raw::Mesh, cells: &[usize]) -> Result<Mesh, MeshError> {
    match (raw, cells) {
        (raw::Mesh::Interval { size, elements: e, .. }, &[n]) => Mesh::interval(*size, n, elements(*e)),
        (raw::Mesh::Rectangle { size, elements: e, diagonal: cut, origin, axisymmetric, .. }, &[nx, ny]) => {
            let mut mesh = Mesh::rectangle_of(elements(*e), *size, [nx, ny], diagonal(*cut))?;
            mesh.axisymmetric = *axisymmetric;
            for point in &mut mesh.points {
                *point = [point[0] + origin[0], point[1] + origin[1], 0.0];
            }
            Ok(mesh.onto_axis())
        }
        (raw::Mesh::Box { size, elements: e, .. }, &[nx, ny, nz]) => Mesh::box_(*size, [nx, ny, nz], elements(*e)),
        (raw::Mesh::Disc { radius, elements: e, .. }, &[radial, around]) => {
            Mesh::disc(*radius, [radial, around], elements(*e))
        }
        (raw::Mesh::Ring { radii, angle, elements: e, .. }, &[radial, around]) => {
            Mesh::ring(*radii, *angle, [radial, around], elements(*e))
        }
        (raw::Mesh::Cylinder { radii, angle, height, elements: e, .. }, &[radial, around, axial]) => {
            Mesh::cylinder(*radii, *angle, *height, [radial, around, axial], elements(*e))
        }
        _ => Ok(empty()),
    }
}

impl Build<'_> {
    /// The mesh, or a placeholder with few cells if it has a fault.
    pub fn mesh(&mut self, raw: &raw::Mesh, sides: &SideNames, available: Option<FreeMemory>) -> Mesh {
        let made = match raw {
            raw::Mesh::File { file, scale, axisymmetric, refine, .. } => {
                let of = FileOf { name: file, scale: *scale, axisymmetric: *axisymmetric };
                let read =
                    self.file(FILE, &of, &|side| sides.used.contains(&side)).map(|MeshFromFile { mesh, plane }| {
                        self.of_file.plane = plane;
                        self.with_named_sides(mesh, sides.named)
                    });
                let read = read.filter(|mesh| {
                    let size = measured(mesh, &sides.contact, *refine);
                    // Each refinement doubles the cells along every direction.
                    let cells = mesh.cell_count() as f64 * f64::from(1 << refine).powi(mesh.dim as i32);
                    let demand = MeshDemand::of(&size, self.solver);
                    self.affordable(FILE, &format!("{cells} cells"), "take a coarser mesh", &demand, available)
                });
                let read = read.and_then(|mesh| self.refined_where(raw, mesh, sides, available));
                read.and_then(|mesh| self.refined(mesh, *refine))
            }
            raw::Mesh::Blocks { blocks, axisymmetric, .. } => {
                let made = self.blocks(blocks, *axisymmetric, sides, available);
                let made = made.map(|mesh| self.with_named_sides(mesh, sides.named));
                made.and_then(|mesh| self.refined_where(raw, mesh, sides, available))
            }
            _ => {
                let made = self.generated(raw, &sides.contact, available);
                let made = made.map(|mesh| self.with_named_sides(mesh, sides.named));
                made.and_then(|mesh| self.refined_where(raw, mesh, sides, available))
            }
        };
        let made = made.and_then(|mesh| self.with_refined_cells(raw, mesh, sides, available));
        self.no_mesh = made.is_none();
        made.unwrap_or_else(empty)
    }

    /// Adds the sides defined in the case to the mesh.
    fn with_named_sides(&mut self, mut mesh: Mesh, named: &[raw::Side]) -> Mesh {
        self.dim = mesh.dim;
        self.name_sides(named, &mut mesh);
        mesh
    }

    /// The generated mesh, or `None` if it does not exist in this size.
    fn generated(&mut self, raw: &raw::Mesh, contact_on: &[&str], available: Option<FreeMemory>) -> Option<Mesh> {
        let cells = cells(raw);
        if let raw::Mesh::Rectangle { elements: raw::Elements::Q1 | raw::Elements::Q2, diagonal: Some(_), .. } = raw {
            self.note(
                "mesh.diagonal",
                At::Value,
                "a diagonal besides quadrilaterals",
                "a diagonal with triangles only, P1 or P2",
                Some("remove one of them"),
            );
        }
        let demand = MeshDemand::of(&size(raw, &cells, contact_on), self.solver);
        let crosses = cells.iter().map(ToString::to_string).collect::<Vec<_>>().join(" × ");
        let fits = self.affordable("mesh.n", &format!("{crosses} cells"), "take fewer cells", &demand, available);
        // A case with faults is not run: a few cells are enough to find its sides.
        let built = if fits && self.is_sound { generate(raw, &cells) } else { generate(raw, &few(raw, &cells)) };
        let built = built.map_err(|error| {
            let expected = error.expected().unwrap_or_else(|| "a mesh that can be built".to_owned());
            self.note("mesh", At::Value, error.found(), expected, None);
        });
        built.ok()
    }

    /// The mesh of a file, if it is sound; `is_used` selects the sides in use, `key` names the file.
    pub(super) fn file(&mut self, key: &str, of: &FileOf, is_used: &dyn Fn(&str) -> bool) -> Option<MeshFromFile> {
        let name = of.name;
        let bytes = match self.loader.get(&Path::parse(key).unwrap_or_default(), name) {
            Ok(bytes) => bytes,
            Err(missing) => {
                self.note(key, At::Value, missing.found, missing.expected, missing.hint.as_deref());
                return None;
            }
        };
        let read = mesh::parse_file(name, &bytes, Some(&mut |other: &str| self.loader.include(other)));
        let mut read = match read {
            Ok(read) => {
                self.of_file.skipped.extend(read.skipped);
                if let Some(whole) = read.whole {
                    self.loader.complete(name, whole);
                }
                MeshFromFile { mesh: read.mesh.scaled(of.scale), plane: read.plane }
            }
            Err(error) => {
                let place = error.place();
                let expected = error.expected().unwrap_or_else(|| "a mesh of one body".to_owned());
                self.note(key, At::Value, format!("{name}: {place}{}", error.found()), expected, None);
                return None;
            }
        };
        read.mesh = self.of_revolution(read.mesh, of.axisymmetric);
        let harmful = |defects: &&Defects| defects.first.iter().all(|defect| defect.side().is_none_or(is_used));
        let defects: Vec<String> =
            defects(&read.mesh).iter().filter(harmful).map(|defects| format!("{name}: {defects}")).collect();
        for defect in &defects {
            self.note(key, At::Value, defect.replace('\n', "; "), "a sound mesh", None);
        }
        defects.is_empty().then_some(read)
    }

    /// Marks the mesh of a file as the half section of a body of revolution, if the case says so.
    fn of_revolution(&mut self, mut mesh: Mesh, axisymmetric: bool) -> Mesh {
        if axisymmetric && mesh.dim != 2 {
            let found = format!("a mesh of {} dimensions", mesh.dim);
            self.note("mesh.axisymmetric", At::Value, found, "a plane mesh, the half section", None);
        }
        mesh.axisymmetric = (axisymmetric || mesh.axisymmetric) && mesh.dim == 2;
        mesh.onto_axis()
    }

    /// Refines the mesh `times` times; not for a case with faults, which is not run.
    fn refined(&mut self, mesh: Mesh, times: u32) -> Option<Mesh> {
        let times = if self.is_sound { times } else { 0 };
        match (0..times).try_fold(mesh, |mesh, _| mesh.refined()) {
            Ok(mesh) => Some(mesh),
            Err(error) => {
                let expected = error.expected().unwrap_or_else(|| "a mesh that can be built".to_owned());
                self.note("mesh.refine", At::Value, error.found(), expected, None);
                None
            }
        }
    }

    /// True if a run on the mesh fits into memory and its nodes can be numbered.
    pub(super) fn affordable(
        &mut self,
        path: &str,
        what: &str,
        hint: &str,
        demand: &MeshDemand,
        available: Option<FreeMemory>,
    ) -> bool {
        let count =
            if demand.unknowns < 1e15 { format!("{}", demand.unknowns) } else { format!("{:.3e}", demand.unknowns) };
        let found = format!("{what}: {count} unknowns");
        if let Some(FreeMemory { bytes, limit }) = available.filter(|available| demand.bytes > available.bytes) {
            let found = format!("{found}, which need about {}", memory::bytes(demand.bytes));
            let by = limit.map_or_else(String::new, |limit| format!(" below {limit}"));
            let expected = format!("a mesh for the {} of memory that are free{by}", memory::bytes(bytes));
            self.note(path, At::Value, found, expected, Some(hint));
            return false;
        }
        if demand.nodes > f64::from(u32::MAX) {
            self.note(path, At::Value, found, format!("at most {} nodes", u32::MAX), Some(hint));
            return false;
        }
        true
    }
}

/// Refinements after which no mesh fits anywhere.
const MOST_REFINED: u32 = 64;

/// The size of a mesh file after `refine` refinements.
pub(super) fn measured(mesh: &Mesh, contact_on: &[&str], refine: u32) -> MeshSize {
    let contact_nodes: usize =
        contact_on.iter().filter_map(|on| mesh.facets.get(*on)).map(|set| set.node_list().len()).sum();
    // Each refinement doubles the nodes along every direction.
    let times = |dim: usize| 2f64.powi(dim as i32 * refine.min(MOST_REFINED) as i32);
    let of_block = |block: &Block| block.element.neighbours;
    MeshSize {
        dim: mesh.dim,
        nodes: mesh.points.len() as f64 * times(mesh.dim),
        contact_nodes: contact_nodes as f64 * times(mesh.dim.saturating_sub(1)),
        neighbours: mesh.blocks.iter().map(of_block).fold(0.0, f64::max),
    }
}

/// The smallest number of cells of each kind of mesh; around a round one as many as keep its shape.
fn few(raw: &raw::Mesh, cells: &[usize]) -> Vec<usize> {
    let is_round = matches!(raw, raw::Mesh::Disc { .. } | raw::Mesh::Ring { .. } | raw::Mesh::Cylinder { .. });
    cells.iter().enumerate().map(|(i, n)| (*n).min(if is_round && i == 1 { 64 } else { 4 })).collect()
}

/// The size of a generated mesh.
pub(super) fn size(raw: &raw::Mesh, cells: &[usize], contact_on: &[&str]) -> MeshSize {
    let sum = |of: &dyn Fn(&str) -> f64| contact_on.iter().map(|side| of(side)).sum::<f64>();
    let degree = |e: raw::Elements| elements(e).degree() as f64;
    let along = |degree: f64, n: usize| degree * n as f64 + 1.0;
    let (dim, nodes, contact_nodes) = match (raw, cells) {
        (raw::Mesh::Interval { elements: e, .. }, &[n]) => (1, along(degree(*e), n), sum(&|_| 1.0)),
        (raw::Mesh::Rectangle { elements: e, diagonal: cut, .. }, &[nx, ny]) => {
            // Each crossed square has a node in the middle, and with degree 2 four more around it.
            let in_squares = match (cut, e) {
                (Some(raw::Diagonal::Crossed), raw::Elements::P1) => 1.0,
                (Some(raw::Diagonal::Crossed), raw::Elements::P2) => 4.0,
                _ => 0.0,
            };
            let degree = degree(*e);
            let on_contact = sum(&|side| along(degree, if matches!(side, "left" | "right") { ny } else { nx }));
            (2, along(degree, nx) * along(degree, ny) + in_squares * nx as f64 * ny as f64, on_contact)
        }
        (raw::Mesh::Box { elements: e, .. }, &[nx, ny, nz]) => {
            let [x, y, z] = [nx, ny, nz].map(|n| along(degree(*e), n));
            let on_contact = sum(&|side| match side {
                "left" | "right" => y * z,
                "back" | "front" => x * y,
                _ => x * z,
            });
            (3, x * y * z, on_contact)
        }
        (raw::Mesh::Disc { elements: e, .. } | raw::Mesh::Ring { elements: e, .. }, &[radial, around]) => {
            let [radial, around] = [radial, around].map(|n| along(degree(*e), n));
            (2, radial * around + (0.25 * around).powi(2), sum(&|_| radial.max(around)))
        }
        (raw::Mesh::Cylinder { elements: e, .. }, &[radial, around, axial]) => {
            let [radial, around, axial] = [radial, around, axial].map(|n| along(degree(*e), n));
            let section = radial * around + (0.25 * around).powi(2);
            let on_contact = sum(&|side| if matches!(side, "bottom" | "top") { section } else { around * axial });
            (3, section * axial, on_contact)
        }
        _ => (2, 0.0, 0.0),
    };
    MeshSize {
        dim,
        nodes,
        contact_nodes,
        neighbours: kind(raw)
            .and_then(|kind| Element::find(cell(kind, dim), kind.degree()))
            .map_or(0.0, |element| element.neighbours),
    }
}

/// Element type of a generated mesh, or `None` for others.
fn kind(raw: &raw::Mesh) -> Option<Elements> {
    match raw {
        raw::Mesh::Interval { elements: e, .. }
        | raw::Mesh::Rectangle { elements: e, .. }
        | raw::Mesh::Box { elements: e, .. }
        | raw::Mesh::Disc { elements: e, .. }
        | raw::Mesh::Ring { elements: e, .. }
        | raw::Mesh::Cylinder { elements: e, .. } => Some(elements(*e)),
        raw::Mesh::File { .. } | raw::Mesh::Blocks { .. } => None,
    }
}

/// The shape of its cells.
fn cell(kind: Elements, dim: usize) -> Shape {
    match (dim, kind.are_simplices()) {
        (1, _) => Shape::Segment,
        (2, true) => Shape::Triangle,
        (2, false) => Shape::Quadrilateral,
        (_, true) => Shape::Tetrahedron,
        (_, false) => Shape::Hexahedron,
    }
}
