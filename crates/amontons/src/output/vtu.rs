//! `fields/*.vtu` and `fields.pvd` for ParaView.

use std::io::Write;
use std::path::Path;

use rayon::prelude::*;

use super::cells::PointValues;
use super::files::{WrittenFile, write_atomically};
use super::shown::{Lives, ResultTable, Shown};
use super::{OutputError, Snapshot, StressRecovery, cell_values};
use crate::majorant::DiscretizationError;
use crate::material::VTK_COMPONENTS;
use crate::problem::{Physics, Problem};
use crate::tensor::{Point, Sym};
use crate::units::Measure;
use crate::vtu::Grid;
use crate::vtu::write::{Cells, WrittenArray as Array, write};

/// An optional field of the files. Standard fields are displacement, velocity and recovered von Mises stress at the
/// nodes and von Mises stress of the cells if the problem has mechanics, temperature at the nodes if it has heat, and
/// region of the cells. Cell values are taken at the centres; tensors have the components xx yy zz xy yz zx.
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
    /// Point data `nodal_stress`: the recovered stress ([`super::nodal_stress`]) in Pa, averaged where regions meet.
    NodalStress,
}

impl OutputField {
    /// The optional fields by default.
    pub const DEFAULT: [OutputField; 1] = [OutputField::Stress];

    /// True if a problem with these equations has the field. A field that it does not have is not written.
    pub(super) fn is_of(self, physics: Physics) -> bool {
        if self == OutputField::HeatFlux { physics.has_heat() } else { physics.has_mechanics() }
    }
}

/// An array of the files, without its values.
struct VtuArray {
    name: &'static str,
    measure: Measure,
    lives: Lives,
}

const fn field(name: &'static str, measure: Measure, lives: Lives) -> VtuArray {
    VtuArray { name, measure, lives }
}

/// The arrays in the order in which they are written.
static FIELDS: [VtuArray; 15] = [
    field("displacement", Measure::Length, Lives::Node),
    field("velocity", Measure::Velocity, Lives::Node),
    field("temperature", Measure::Temperature, Lives::Node),
    field("nodal_stress", Measure::Stress, Lives::Recovered),
    field("nodal_von_mises", Measure::Stress, Lives::Recovered),
    field("stress", Measure::Stress, Lives::Cell),
    field("von_mises", Measure::Stress, Lives::Cell),
    field("region", Measure::Number, Lives::Cell),
    field("strain", Measure::Number, Lives::Cell),
    field("principal", Measure::Stress, Lives::Cell),
    field("principal_direction_1", Measure::Number, Lives::Cell),
    field("principal_direction_2", Measure::Number, Lives::Cell),
    field("principal_direction_3", Measure::Number, Lives::Cell),
    field("heat_flux", Measure::HeatFlux, Lives::Cell),
    field("error", Measure::Energy, Lives::Cell),
];

/// Every array that the files can have.
pub(super) fn shown() -> impl Iterator<Item = Shown> {
    FIELDS.iter().map(|field| Shown::new(ResultTable::Fields, field.name, Some(field.measure), field.lives))
}

/// The quantities measured by the arrays of the files.
pub(super) fn measures() -> Vec<(String, Measure)> {
    FIELDS.iter().map(|field| (field.name.to_owned(), field.measure)).collect()
}

/// Writes the fields of a state as an unstructured grid, compressed by zlib. Nodal stresses are written if a recovery
/// is given, and the energy of the discretization error per cell if there is a bound.
pub(super) fn write_fields(
    path: &Path,
    now: &Snapshot,
    fields: &[OutputField],
    recovery: Option<&StressRecovery>,
    error: Option<&DiscretizationError>,
) -> Result<WrittenFile, OutputError> {
    let fields: Vec<OutputField> = fields.iter().copied().filter(|field| field.is_of(now.problem.physics)).collect();
    let values = cell_values(now.problem, now.state);
    let recovered = recovery.map(|recovery| recovery.means(now.problem, now.state, &values));
    let has_axes = fields.contains(&OutputField::Principal);
    let axes = has_axes.then(|| values.par_iter().map(|v| v.stress.principal_axes()).collect::<Vec<_>>());
    let points = at_points(now, &fields, recovered.as_deref());
    let mut cells = at_cells(now, &fields, &values, axes.as_deref());
    cells.extend(error.map(|error| Array::reals("error", 1, &error.cells[..])));
    write_atomically(path, |out| write(out, &now.problem.mesh.points, connectivity(now.problem), &points, &cells))
}

/// Writes a grid that was read, with the same bytes as [`write_fields`] wrote.
pub(super) fn write_grid(path: &Path, grid: &Grid) -> Result<WrittenFile, OutputError> {
    let arrays = |data: &'_ std::collections::BTreeMap<String, crate::vtu::Array>| {
        let place = |name: &str| FIELDS.iter().position(|field| field.name == name).unwrap_or(FIELDS.len());
        let mut names: Vec<&String> = data.keys().collect();
        names.sort_by_key(|name| place(name));
        let array = |name: &String| {
            let (array, name) = (&data[name], name.clone());
            if name == "region" {
                Array::counts(name, array.values.iter().map(|&number| number as i64).collect())
            } else {
                Array::reals(name, array.components, array.values.clone())
            }
        };
        names.into_iter().map(array).collect::<Vec<_>>()
    };
    let cells = Cells {
        connectivity: grid.connectivity.iter().map(|&node| i64::from(node)).collect(),
        ends: grid.ends.iter().map(|&end| end as i64).collect(),
        types: grid.types.clone(),
    };
    write_atomically(path, |out| write(out, &grid.points, cells, &arrays(&grid.point_data), &arrays(&grid.cell_data)))
}

pub(super) fn connectivity(problem: &Problem) -> Cells {
    let mut cells = Cells { connectivity: Vec::new(), ends: Vec::new(), types: Vec::new() };
    for block in &problem.mesh.blocks {
        for cell in block.vtk_cells() {
            cells.connectivity.extend(cell.iter().map(|&node| i64::from(node)));
            cells.ends.push(cells.connectivity.len() as i64);
        }
        cells.types.extend(std::iter::repeat_n(block.element.vtk(), block.len()));
    }
    cells
}

/// Data at the nodes, with the recovered stresses if there are any.
fn at_points<'a>(now: &Snapshot<'a>, fields: &[OutputField], recovered: Option<&'a [Sym]>) -> Vec<Array<'a>> {
    let (dim, state, physics) = (now.problem.mesh.dim, now.state, now.problem.physics);
    let in_space = |name: &'static str, values: &'a [f64]| {
        let of_node = |v: &'a [f64]| (0..3).map(|c| v.get(c).copied().unwrap_or(0.0));
        Array::made(name, 3, move || values.chunks_exact(dim).flat_map(of_node).collect())
    };
    let mut point = Vec::new();
    if physics.has_mechanics() {
        point.push(in_space("displacement", &state.u));
        point.push(in_space("velocity", &state.w));
    }
    if physics.has_temperature() {
        point.push(Array::reals("temperature", 1, &*state.theta));
    }
    if let Some(stresses) = recovered {
        if fields.contains(&OutputField::NodalStress) {
            point.push(tensors("nodal_stress", stresses, |stress| stress));
        }
        point.push(Array::made("nodal_von_mises", 1, || stresses.iter().map(Sym::von_mises).collect()));
    }
    point
}

/// Data of the cells, with the principal axes of their stresses if they are wanted.
fn at_cells<'a>(
    now: &Snapshot,
    fields: &[OutputField],
    values: &'a [PointValues],
    axes: Option<&'a [[(f64, Point); 3]]>,
) -> Vec<Array<'a>> {
    let mesh = &now.problem.mesh;
    let mut cell = Vec::new();
    if fields.contains(&OutputField::Stress) {
        cell.push(tensors("stress", values, |v| &v.stress));
    }
    if now.problem.physics.has_mechanics() {
        cell.push(Array::made("von_mises", 1, || values.iter().map(|v| v.stress.von_mises()).collect()));
    }
    let regions = mesh.blocks.iter().flat_map(|block| std::iter::repeat_n(block.region as i64, block.len()));
    cell.push(Array::counts("region", regions.collect()));
    if fields.contains(&OutputField::Strain) {
        cell.push(tensors("strain", values, |v| &v.strain));
    }
    if let Some(axes) = axes {
        let principal = |of: &[(f64, Point); 3]| of.map(|(value, _)| value);
        cell.push(Array::made("principal", 3, move || axes.iter().flat_map(principal).collect()));
        for c in 0..3 {
            let name = format!("principal_direction_{}", c + 1);
            cell.push(Array::made(name, 3, move || axes.iter().flat_map(|of| of[c].1).collect()));
        }
    }
    if fields.contains(&OutputField::HeatFlux) {
        cell.push(Array::made("heat_flux", 3, || values.iter().flat_map(|v| v.heat_flux).collect()));
    }
    cell
}

/// An array of the six components of tensors.
fn tensors<'a, T>(name: &'static str, all: &'a [T], tensor: fn(&T) -> &Sym) -> Array<'a> {
    let components = move |of: &'a T| VTK_COMPONENTS.map(|(i, j)| tensor(of).get(i, j));
    Array::made(name, 6, move || all.iter().flat_map(components).collect())
}

/// Writes the list of snapshots, pairs of a time and a file.
pub(super) fn write_collection(path: &Path, snapshots: &[(f64, String)]) -> Result<WrittenFile, OutputError> {
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
