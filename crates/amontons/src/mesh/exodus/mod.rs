//! Meshes of Cubit, MOOSE and SIERRA: Exodus II, which is netCDF (`.e`, `.exo`, `.g`), as described in "EXODUS II: A
//! Finite Element Data Model" (Schoof and Yarberry, Sandia report SAND92-2137).
//!
//! Blocks of the highest dimension become regions; blocks of faces (in the plane, of edges) and side sets become sides;
//! blocks of lower dimension become named edges and points. Shells in a mesh with solids, and sides of cells outside
//! the body, are skipped. Node sets that contain facets of the boundary are sides, the others edges or points. Unnamed
//! items are called by their number, node sets by `nodeset_` and their number.

mod netcdf;
mod types;

use std::collections::BTreeSet;

use self::netcdf::{NetcdfNumbers, Variables};
use self::types::ExodusType;
use super::Mesh;
use super::read::{FacetOf, FilePosition, Loose, LooseBlock, MeshFile, MeshFileError, NodeSet, Skipped};
use crate::tensor::Point;

fn refuse(message: impl Into<String>) -> MeshFileError {
    MeshFileError::Grid { message: message.into() }
}

/// Reads a mesh from the bytes of an Exodus file.
///
/// # Errors
/// Fails if the bytes are no mesh of one body; the error names the variable of the file.
pub fn parse(bytes: &[u8]) -> Result<Mesh, MeshFileError> {
    read(bytes).map(|read| read.mesh)
}

/// Reads the mesh and the list of skipped contents.
pub(super) fn read(bytes: &[u8]) -> Result<MeshFile, MeshFileError> {
    let file = Variables::of(bytes)?;
    let (points, dim) = points(&file)?;
    let loose = Loose { points, ..Loose::default() };
    let mut reading = ExodusReader { file, dim, loose, cells: Vec::new() };
    reading.blocks()?;
    reading.leave_out_shells();
    reading.side_sets()?;
    reading.node_sets()?;
    reading.loose.into_read(FilePosition::Cell)
}

/// The coordinates, and their number per node.
fn points(file: &Variables) -> Result<(Vec<Point>, usize), MeshFileError> {
    let mut axes: Vec<Vec<f64>> = Vec::new();
    if let Some(NetcdfNumbers { shape, values }) = file.numbers("coord")? {
        let count = shape.get(1).copied().unwrap_or(0).max(1);
        axes.extend(values.chunks(count).map(<[f64]>::to_vec));
    } else {
        for name in ["coordx", "coordy", "coordz"] {
            axes.extend(file.numbers(name)?.map(|numbers| numbers.values));
        }
    }
    let count = axes.first().map_or(0, Vec::len);
    if axes.is_empty() || axes.len() > 3 || axes.iter().any(|axis| axis.len() != count) || count > u32::MAX as usize {
        return Err(refuse(
            "netCDF without the coordinates of nodes (coordx, coordy, coordz), expected an Exodus file",
        ));
    }
    let of = |node: usize| -> Point { std::array::from_fn(|d| axes.get(d).map_or(0.0, |axis| axis[node])) };
    let points: Vec<Point> = (0..count).map(of).collect();
    match points.iter().position(|point| point.iter().any(|x| !x.is_finite())) {
        Some(node) => {
            Err(refuse(format!("the coordinates {:?} of node {}, expected finite numbers", points[node], node + 1)))
        }
        None => Ok((points, axes.len())),
    }
}

/// Index into a list of `count` for a number that the file counts from 1.
fn place(number: f64, count: usize) -> Option<usize> {
    (number.fract() == 0.0 && number >= 1.0 && number <= count as f64).then(|| number as usize - 1)
}

/// The cells of one block, in the order of the file.
struct BlockCells {
    kind: ExodusType,
    /// Its first cell among all.
    first: usize,
    count: usize,
    /// Number of its block among those read.
    block: usize,
    /// Name of the block.
    name: String,
}

/// Name of a block or set: its number if it has none.
fn called((number, name): (i64, String)) -> String {
    if name.is_empty() { number.to_string() } else { name }
}

struct ExodusReader {
    file: Variables,
    /// Number of coordinates per node.
    dim: usize,
    loose: Loose,
    cells: Vec<BlockCells>,
}

impl ExodusReader {
    /// Numbers and names of the blocks or sets; the name is empty if there is none.
    fn named(&self, short: &str) -> Result<Vec<(i64, String)>, MeshFileError> {
        let list = format!("{short}_prop1");
        let numbers = self.file.list(&list)?;
        if numbers.len() > self.file.most_things() {
            return Err(refuse(format!(
                "{list} announces {} blocks or sets, more than the file can hold",
                numbers.len()
            )));
        }
        let names = self.file.lines(&format!("{short}_names"))?;
        let name = |at: usize| names.get(at).cloned().unwrap_or_default();
        Ok(numbers.iter().enumerate().map(|(at, number)| (*number as i64, name(at))).collect())
    }

    /// The group of a dimension for a block or a side set.
    fn group(&mut self, dim: usize, name: String) -> BTreeSet<i64> {
        let known = self.loose.names.iter().find(|((of, _), other)| *of == dim && **other == name);
        match known.map(|((_, tag), _)| *tag) {
            Some(tag) => BTreeSet::from([tag]),
            None => self.loose.group(dim, name),
        }
    }

    fn blocks(&mut self) -> Result<(), MeshFileError> {
        let mut first = 0;
        for (at, named) in self.named("eb")?.into_iter().enumerate() {
            let variable = format!("connect{}", at + 1);
            let Some(NetcdfNumbers { shape, values }) = self.file.numbers(&variable)? else { continue };
            let &[count, nodes] = shape.as_slice() else {
                return Err(refuse(format!(
                    "{variable} has {} dimensions, expected cells and their nodes",
                    shape.len()
                )));
            };
            let written = self.file.attribute(&variable, "elem_type").unwrap_or_default();
            let kind = ExodusType::of(&written, nodes).ok_or_else(|| {
                refuse(format!("elements of type {written:?} with {nodes} nodes, {}", types::known()))
            })?;
            if count.checked_mul(nodes) != Some(values.len()) {
                return Err(refuse(format!(
                    "{variable} has {} nodes of {count} cells with {nodes} each",
                    values.len()
                )));
            }
            let name = called(named);
            let groups = self.group(kind.kind.dim, name.clone());
            let mut block = LooseBlock { kind: kind.kind, groups, at: first, nodes: Vec::new(), numbers: Vec::new() };
            for (cell, listed) in values.chunks_exact(nodes).enumerate() {
                for &local in &kind.order {
                    let node = place(listed[local], self.loose.points.len()).ok_or_else(|| {
                        let expected = format!("one of the nodes 1 to {}", self.loose.points.len());
                        refuse(format!(
                            "node {} of cell {} of {variable}, expected {expected}",
                            listed[local],
                            cell + 1
                        ))
                    })?;
                    block.nodes.push(node as u32);
                }
            }
            self.cells.push(BlockCells { kind, first, count, block: self.loose.blocks.len(), name });
            self.loose.blocks.push(block);
            first += count;
        }
        Ok(())
    }

    /// Removes the blocks of shells in a mesh with solids.
    fn leave_out_shells(&mut self) {
        if self.loose.dim() < 3 {
            return;
        }
        for BlockCells { kind, count, block, name, .. } in self.cells.iter().filter(|cells| cells.kind.is_shell) {
            let what = format!("shells of the block {name:?} ({})", kind.kind.name);
            self.loose.skipped.push(Skipped { what, file: None, line: None, count: *count });
            self.loose.blocks[*block].nodes.clear();
        }
    }

    /// Side sets, given by cell and side numbers; sides of cells outside the body are left out.
    fn side_sets(&mut self) -> Result<(), MeshFileError> {
        let all: usize = self.cells.iter().map(|cells| cells.count).sum();
        let dim = self.loose.dim();
        for (at, named) in self.named("ss")?.into_iter().enumerate() {
            let (of, numbers) = (format!("elem_ss{}", at + 1), format!("side_ss{}", at + 1));
            let (elements, sides) = (self.file.list(&of)?, self.file.list(&numbers)?);
            if elements.len() != sides.len() {
                return Err(refuse(format!(
                    "{} cells (`{of}`) of {} sides (`{numbers}`)",
                    elements.len(),
                    sides.len()
                )));
            }
            let name = called(named);
            let (mut facets, mut left_out) = (Vec::new(), 0);
            for (&element, &number) in elements.iter().zip(&sides) {
                let cell = place(element, all)
                    .ok_or_else(|| refuse(format!("cell {element} of {of}, expected one of the cells 1 to {all}")))?;
                match self.facet(cell, number, dim)? {
                    Some(facet) => facets.push(facet),
                    None => left_out += 1,
                }
            }
            if left_out > 0 {
                let what = format!("sides in the side set {name:?} that are not those of cells of the body");
                self.loose.skipped.push(Skipped { what, file: None, line: None, count: left_out });
            }
            if !facets.is_empty() {
                let groups = self.group(dim.saturating_sub(1), name);
                self.loose.facets(&groups, &facets);
            }
        }
        Ok(())
    }

    /// A side of a cell; `None` if the cell does not belong to the body.
    fn facet(&self, cell: usize, number: f64, dim: usize) -> Result<Option<FacetOf>, MeshFileError> {
        let at = self.cells.partition_point(|cells| cells.first <= cell).saturating_sub(1);
        let BlockCells { kind, first, block, .. } = &self.cells[at];
        let name = kind.kind.name;
        if kind.kind.dim != dim {
            return Ok(None);
        }
        if self.dim != dim {
            let message = "a set of sides of cells that do not fill the space of their nodes";
            let hint = "sides of solids, or of a plane body with two coordinates; sets of nodes serve for others";
            return Err(refuse(format!("{message}: side {number} of the {name} {}, expected {hint}", cell + 1)));
        }
        let found = kind.kind.element.and_then(|element| {
            let at = place(number, element.facets.len())?;
            element.facets.get(element.orders.exodus_sides.local(at))
        });
        let found = found.ok_or_else(|| refuse(format!("side {number} of the {name} {}, which has none", cell + 1)))?;
        let nodes = &self.loose.blocks[*block].nodes[(cell - first) * kind.kind.nodes..][..kind.kind.nodes];
        Ok(Some(FacetOf::new(found, nodes)))
    }

    fn node_sets(&mut self) -> Result<(), MeshFileError> {
        let count = self.loose.points.len();
        for (at, (number, name)) in self.named("ns")?.into_iter().enumerate() {
            let variable = format!("node_ns{}", at + 1);
            let mut nodes = BTreeSet::new();
            for node in self.file.list(&variable)? {
                let found = place(node, count).ok_or_else(|| {
                    refuse(format!("node {node} of {variable}, expected one of the nodes 1 to {count}"))
                })?;
                nodes.insert(found as u32);
            }
            let name = if name.is_empty() { format!("nodeset_{number}") } else { name };
            self.loose.node_sets.push(NodeSet { name, nodes });
        }
        Ok(())
    }
}
