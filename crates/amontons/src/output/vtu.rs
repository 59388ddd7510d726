//! `fields/*.vtu` and `fields.pvd` for ParaView.

use std::io::Write;
use std::path::Path;

use vtkio::model::{Attribute, Attributes, ByteOrder, CellType, Cells, DataSet, UnstructuredGridPiece, Version, VertexNumbers, Vtk};

use super::files::write_atomically;
use super::{OutputError, Snapshot, cell_stresses};
use crate::material::VTK_COMPONENTS;

/// Writes the fields of a state as an unstructured grid, binary, without compression.
pub(super) fn write_fields(path: &Path, now: &Snapshot) -> Result<(), OutputError> {
    let grid = grid(now);
    let mut bytes = Vec::new();
    grid.write_xml(&mut bytes).map_err(|error| OutputError::Encode { path: path.to_owned(), message: error.to_string() })?;
    write_atomically(path, |out| out.write_all(&bytes))
}

fn grid(now: &Snapshot) -> Vtk {
    let (mesh, state) = (&now.problem.mesh, now.state);
    let in_space = |values: &[f64]| -> Vec<f64> { values.chunks_exact(mesh.dim).flat_map(|v| (0..3).map(|c| v.get(c).copied().unwrap_or(0.0))).collect() };
    let mut cells = Cells::default();
    let (mut connectivity, mut offsets) = (Vec::new(), Vec::new());
    for block in &mesh.blocks {
        for cell in block.cells() {
            connectivity.extend(cell.iter().map(|&node| u64::from(node)));
            offsets.push(connectivity.len() as u64);
        }
        cells.types.extend(std::iter::repeat_n(cell_type(block.element.vtk), block.len()));
    }
    cells.cell_verts = VertexNumbers::XML { connectivity, offsets };
    let stresses = cell_stresses(now.problem, state);
    let point = vec![
        Attribute::generic("displacement", 3).with_data(in_space(&state.u)),
        Attribute::generic("velocity", 3).with_data(in_space(&state.w)),
        Attribute::generic("temperature", 1).with_data(state.theta.clone()),
    ];
    let cell = vec![
        Attribute::generic("stress", 6).with_data(stresses.iter().flat_map(|cell| VTK_COMPONENTS.map(|(i, j)| cell.stress.get(i, j))).collect::<Vec<f64>>()),
        Attribute::generic("von_mises", 1).with_data(stresses.iter().map(|cell| cell.von_mises).collect::<Vec<f64>>()),
        Attribute::generic("region", 1).with_data(stresses.iter().map(|cell| cell.region as u32).collect::<Vec<u32>>()),
    ];
    let piece = UnstructuredGridPiece { points: mesh.points.iter().flatten().copied().collect::<Vec<f64>>().into(), cells, data: Attributes { point, cell } };
    Vtk {
        version: Version::XML { major: 1, minor: 0 },
        title: now.problem.name.clone(),
        byte_order: ByteOrder::LittleEndian,
        data: DataSet::inline(piece),
        file_path: None,
    }
}

/// The cell type of a VTK code of [`crate::element`].
fn cell_type(code: u8) -> CellType {
    match code {
        1 => CellType::Vertex,
        3 => CellType::Line,
        9 => CellType::Quad,
        10 => CellType::Tetra,
        12 => CellType::Hexahedron,
        13 => CellType::Wedge,
        14 => CellType::Pyramid,
        21 => CellType::QuadraticEdge,
        22 => CellType::QuadraticTriangle,
        24 => CellType::QuadraticTetra,
        28 => CellType::BiquadraticQuad,
        29 => CellType::TriquadraticHexahedron,
        32 => CellType::BiquadraticQuadraticWedge,
        _ => CellType::Triangle,
    }
}

/// Writes the list of snapshots, pairs of a time and a file.
pub(super) fn write_collection(path: &Path, snapshots: &[(f64, String)]) -> Result<(), OutputError> {
    write_atomically(path, |out| {
        writeln!(out, "<?xml version=\"1.0\"?>")?;
        writeln!(out, "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">")?;
        writeln!(out, "  <Collection>")?;
        for (t, file) in snapshots {
            writeln!(out, "    <DataSet timestep=\"{t:?}\" group=\"\" part=\"0\" file=\"{file}\"/>")?;
        }
        writeln!(out, "  </Collection>")?;
        writeln!(out, "</VTKFile>")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_element_has_its_cell_type() {
        for element in crate::element::ALL {
            assert_eq!(cell_type(element.vtk) as u8, element.vtk, "{}", element.name);
        }
    }
}
