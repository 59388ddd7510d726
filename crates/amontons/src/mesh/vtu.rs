//! Meshes of VTK: unstructured grids in XML (`.vtu`), as ParaView, meshio and this program write them.
//!
//! Integers of the cell data `region` become regions, named by their digits; without them the body is one region. Cells
//! of dimension d − 1 with the cell data `facet` or `boundary` become sides, named likewise; without these data they
//! form the side `boundary`. The name `gmsh:physical`, which meshio gives to the groups of Gmsh, is accepted for both.

use std::collections::{BTreeMap, BTreeSet};

use super::read::{FilePosition, Kind, Loose, LooseBlock, MeshFile, MeshFileError, Values, complete_data};
use super::{Block, Mesh};
use crate::element::{self, CellType};
use crate::tensor::Point;
use crate::vtu::{self, Array, Grid};

/// Names of the cell data with the region of a cell; the first one present counts.
const REGION: [&str; 2] = ["region", "gmsh:physical"];
/// Names of the cell data with the side of a facet; the first one present counts.
const SIDE: [&str; 3] = ["facet", "boundary", "gmsh:physical"];
/// Cell types of VTK for points: vertex, vertices.
const POINTS: [u8; 2] = [1, 2];

/// Reads a mesh from the bytes of a VTU file: cells → blocks in the order of the file.
///
/// # Errors
/// Fails if the bytes are no mesh of one body; the error names the array or the cell.
pub fn parse(bytes: &[u8]) -> Result<Mesh, MeshFileError> {
    read(bytes).map(|read| read.mesh)
}

/// Reads the mesh and the list of skipped contents.
pub(super) fn read(bytes: &[u8]) -> Result<MeshFile, MeshFileError> {
    let wanted = |name: &str| REGION.contains(&name) || SIDE.contains(&name);
    let grid = vtu::parse(bytes, wanted).map_err(|message| MeshFileError::Grid { message })?;
    loose(grid)?.into_read(FilePosition::Cell)
}

/// The points of a grid, its cells of the highest dimension by element, and the data `name` of these cells or of the
/// points.
pub(super) fn data(bytes: &[u8], name: &str) -> Result<(Vec<Point>, Vec<Block>, Values), MeshFileError> {
    let refuse = |message: String| MeshFileError::Grid { message };
    let mut grid = vtu::parse(bytes, |other| other == name).map_err(refuse)?;
    let kinds =
        grid.types.iter().enumerate().map(|(cell, &code)| kind(cell, code)).collect::<Result<Vec<Kind>, _>>()?;
    let dim = kinds.iter().map(|kind| kind.dim).max().unwrap_or(0);
    let (of_cells, of_nodes) = (grid.cell_data.remove(name), grid.point_data.remove(name));
    let is_of_cells = of_cells.is_some();
    let Some(Array { components, values }) = of_cells.or(of_nodes) else {
        return Err(refuse(format!("no data \"{name}\", expected data of the cells or the points with this name")));
    };
    let (what, expected) = if is_of_cells { ("cells", grid.types.len()) } else { ("points", grid.points.len()) };
    if components != 1 || values.len() != expected {
        let found = format!("the data \"{name}\" have {components} components and {} numbers", values.len());
        return Err(refuse(format!("{found}, expected one number for each of the {expected} {what}")));
    }
    let mut blocks: Vec<LooseBlock> = Vec::new();
    let mut by_cell: Vec<Vec<f64>> = Vec::new();
    for (cell, nodes) in grid.cells().enumerate().filter(|&(cell, _)| kinds[cell].dim == dim && dim > 0) {
        let kind = kinds[cell];
        if nodes.len() != kind.nodes {
            return Err(refuse(format!("cell {cell} has {} nodes, expected those of its type", nodes.len())));
        }
        let same = |block: &LooseBlock| (block.kind.name, block.kind.nodes) == (kind.name, kind.nodes);
        let block = blocks.iter().position(same).unwrap_or_else(|| {
            let groups = BTreeSet::new();
            blocks.push(LooseBlock { kind, groups, at: cell, nodes: Vec::new(), numbers: Vec::new() });
            by_cell.push(Vec::new());
            blocks.len() - 1
        });
        blocks[block].nodes.extend_from_slice(nodes);
        by_cell[block].push(if is_of_cells { values[cell] } else { 0.0 });
    }
    let (mut points, mut of_nodes) = (grid.points, if is_of_cells { Vec::new() } else { values });
    let blocks = complete_data(&mut points, &mut of_nodes, blocks);
    let values = if is_of_cells { Values::Cells(by_cell) } else { Values::Nodes(of_nodes) };
    Ok((points, blocks, values))
}

fn loose(grid: Grid) -> Result<Loose, MeshFileError> {
    let kinds =
        grid.types.iter().enumerate().map(|(cell, &code)| kind(cell, code)).collect::<Result<Vec<Kind>, _>>()?;
    let dim = kinds.iter().map(|kind| kind.dim).max().unwrap_or(0);
    let (regions, sides) = (ids(&grid, &REGION)?, ids(&grid, &SIDE)?);
    let mut names = BTreeMap::new();
    if dim > 0 && sides.is_none() {
        names.insert((dim - 1, 0), "boundary".to_owned());
    }
    let mut blocks: Vec<LooseBlock> = Vec::new();
    let mut index: BTreeMap<(u8, Option<i64>), usize> = BTreeMap::new();
    for (cell, nodes) in grid.cells().enumerate() {
        let kind = kinds[cell];
        let group = match dim - kind.dim {
            0 => regions.as_ref().map(|ids| ids[cell]),
            1 => Some(sides.as_ref().map_or(0, |ids| ids[cell])),
            _ => continue,
        };
        if nodes.len() != kind.nodes {
            let message = format!("cell {cell} has {} nodes, not the {} of a {}", nodes.len(), kind.nodes, kind.name);
            return Err(MeshFileError::Grid { message });
        }
        let block = *index.entry((grid.types[cell], group)).or_insert_with(|| {
            blocks.push(LooseBlock {
                kind,
                groups: BTreeSet::from_iter(group),
                at: cell,
                nodes: Vec::new(),
                numbers: Vec::new(),
            });
            blocks.len() - 1
        });
        blocks[block].nodes.extend_from_slice(nodes);
    }
    Ok(Loose { points: grid.points, blocks, names, ..Loose::default() })
}

/// The element of a cell; the library numbers nodes as VTK does.
fn kind(cell: usize, code: u8) -> Result<Kind, MeshFileError> {
    if POINTS.contains(&code) {
        return Ok(Kind { name: "vertex", dim: 0, nodes: 1, element: Some(&element::POINT_LEFT) });
    }
    let (element, cell) = CellType::find(|_, known| known.vtk == Some(code)).ok_or_else(|| {
        let known: Vec<String> = element::ALL.iter().map(|e| format!("{} ({})", e.vtk(), e.name)).collect();
        MeshFileError::Element { at: FilePosition::Cell(cell), found: format!("VTK {code}"), known: known.join(", ") }
    })?;
    Ok(Kind::of(element, cell.nodes))
}

/// The first cell data present among some names, as integers.
fn ids(grid: &Grid, names: &[&str]) -> Result<Option<Vec<i64>>, MeshFileError> {
    let Some((name, Array { components, values })) = names.iter().find_map(|name| grid.cell_data.get_key_value(*name))
    else {
        return Ok(None);
    };
    let integer = |v: &f64| (v.fract() == 0.0 && v.abs() < 1e15).then_some(*v as i64);
    let ids: Option<Vec<i64>> = values.iter().map(integer).collect();
    match ids {
        Some(ids) if *components == 1 => Ok(Some(ids)),
        _ => Err(MeshFileError::Grid {
            message: format!("the array {name} has {components} components or fractions, not one integer per cell"),
        }),
    }
}
