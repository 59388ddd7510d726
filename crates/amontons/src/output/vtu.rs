//! `fields/*.vtu` and `fields.pvd` for ParaView.

use std::io::Write;
use std::path::Path;

use vtkio::model::{
    Attribute, Attributes, ByteOrder, CellType, Cells, DataSet, UnstructuredGridPiece, Version, VertexNumbers, Vtk,
};

use super::files::{Written, write_atomically};
use super::{OutputError, PointValues, Snapshot, StressRecovery, cell_values};
use crate::material::VTK_COMPONENTS;
use crate::problem::Physics;
use crate::tensor::Sym;

/// A field that is written beside those that every file has: displacement, velocity and recovered von Mises stress at
/// the nodes and von Mises stress of the cells if the problem has mechanics, temperature at the nodes if it has heat,
/// and region of the cells. Values of cells are those at their centres; tensors have the components xx yy zz xy yz zx.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputField {
    /// Cell data `stress`: σ of (2.1) in Pa.
    Stress,
    /// Cell data `strain`: ε(u).
    Strain,
    /// Cell data `principal`, the three principal stresses in Pa, the largest first, and `principal_direction_1`, `_2`,
    /// `_3`.
    Principal,
    /// Cell data `heat_flux`: q = −𝓚∇θ in W/m².
    HeatFlux,
    /// Point data `nodal_stress`: the recovered stress ([`super::nodal_stress`]) in Pa, where regions meet the mean of
    /// their values.
    NodalStress,
}

impl OutputField {
    /// What a file has unless it is said otherwise.
    pub const DEFAULT: [OutputField; 1] = [OutputField::Stress];

    /// Whether a problem with these equations has the field; one that it does not have is not written.
    pub(super) fn is_of(self, physics: Physics) -> bool {
        if self == OutputField::HeatFlux { physics.has_heat() } else { physics.has_mechanics() }
    }
}

/// Writes the fields of a state as an unstructured grid, binary, without compression. Stresses at nodes are written
/// with a recovery on the mesh.
pub(super) fn write_fields(
    path: &Path,
    now: &Snapshot,
    fields: &[OutputField],
    recovery: Option<&StressRecovery>,
) -> Result<Written, OutputError> {
    let grid = grid(now, fields, recovery);
    let mut bytes = Vec::new();
    grid.write_xml(&mut bytes)
        .map_err(|error| OutputError::Encode { path: path.to_owned(), message: error.to_string() })?;
    write_atomically(path, |out| out.write_all(&bytes))
}

fn grid(now: &Snapshot, fields: &[OutputField], recovery: Option<&StressRecovery>) -> Vtk {
    let (mesh, state) = (&now.problem.mesh, now.state);
    let in_space = |values: &[f64]| -> Vec<f64> {
        values.chunks_exact(mesh.dim).flat_map(|v| (0..3).map(|c| v.get(c).copied().unwrap_or(0.0))).collect()
    };
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
    let values = cell_values(now.problem, state);
    let physics = now.problem.physics;
    let (mut point, mut cell) = (Vec::new(), Vec::new());
    if physics.has_mechanics() {
        point.push(Attribute::generic("displacement", 3).with_data(in_space(&state.u)));
        point.push(Attribute::generic("velocity", 3).with_data(in_space(&state.w)));
    }
    if physics.has_heat() {
        point.push(Attribute::generic("temperature", 1).with_data(state.theta.clone()));
    }
    let fields: Vec<OutputField> = fields.iter().copied().filter(|field| field.is_of(physics)).collect();
    if let Some(recovery) = recovery {
        let stresses = recovery.stress(now.problem, state).means(mesh.points.len());
        if fields.contains(&OutputField::NodalStress) {
            point.push(tensors("nodal_stress", stresses.iter()));
        }
        point.push(
            Attribute::generic("nodal_von_mises", 1)
                .with_data(stresses.iter().map(Sym::von_mises).collect::<Vec<f64>>()),
        );
    }
    if fields.contains(&OutputField::Stress) {
        cell.push(tensors("stress", values.iter().map(|v| &v.stress)));
    }
    if physics.has_mechanics() {
        cell.push(
            Attribute::generic("von_mises", 1)
                .with_data(values.iter().map(|v| v.stress.von_mises()).collect::<Vec<f64>>()),
        );
    }
    let regions = mesh.blocks.iter().flat_map(|block| std::iter::repeat_n(block.region as u32, block.len()));
    cell.push(Attribute::generic("region", 1).with_data(regions.collect::<Vec<u32>>()));
    cell.extend(more(&values, &fields));
    let piece = UnstructuredGridPiece {
        points: mesh.points.iter().flatten().copied().collect::<Vec<f64>>().into(),
        cells,
        data: Attributes { point, cell },
    };
    Vtk {
        version: Version::XML { major: 1, minor: 0 },
        title: now.problem.name.clone(),
        byte_order: ByteOrder::LittleEndian,
        data: DataSet::inline(piece),
        file_path: None,
    }
}

/// Cell data that are written where they are asked for.
fn more(values: &[PointValues], fields: &[OutputField]) -> Vec<Attribute> {
    let mut cell = Vec::new();
    if fields.contains(&OutputField::Strain) {
        cell.push(tensors("strain", values.iter().map(|v| &v.strain)));
    }
    if fields.contains(&OutputField::Principal) {
        let axes: Vec<_> = values.iter().map(|v| v.stress.principal_axes()).collect();
        let principal = axes.iter().flat_map(|axes| axes.map(|(value, _)| value)).collect::<Vec<f64>>();
        cell.push(Attribute::generic("principal", 3).with_data(principal));
        for c in 0..3 {
            let directions = axes.iter().flat_map(|axes| axes[c].1).collect::<Vec<f64>>();
            cell.push(Attribute::generic(format!("principal_direction_{}", c + 1), 3).with_data(directions));
        }
    }
    if fields.contains(&OutputField::HeatFlux) {
        cell.push(
            Attribute::generic("heat_flux", 3).with_data(values.iter().flat_map(|v| v.heat_flux).collect::<Vec<f64>>()),
        );
    }
    cell
}

/// An array of the six components of tensors.
fn tensors<'a>(name: &str, all: impl Iterator<Item = &'a Sym>) -> Attribute {
    Attribute::generic(name, 6)
        .with_data(all.flat_map(|tensor| VTK_COMPONENTS.map(|(i, j)| tensor.get(i, j))).collect::<Vec<f64>>())
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
pub(super) fn write_collection(path: &Path, snapshots: &[(f64, String)]) -> Result<Written, OutputError> {
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
