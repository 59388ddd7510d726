//! Reads a results folder.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use super::body::PlaneMesh;
use super::run::{DrawnRun, HistoryColumns, PlaneSnapshot, Rod, SolidContact, SpaceSnapshot};
use super::surface::Skin;
use super::table::CsvTable;
use super::{PlotError, contact, frames, ground, vtu};
use crate::case::{self, CaseError};
use crate::contact::names_of_points;
use crate::output::columns;
use crate::output::names::{CASE, CONTACT, FIELDS, HISTORY, PACKED, fields_file};
use crate::problem::Problem;
use crate::vtkhdf::Reader;

/// VTK types of plane cells: triangles and quadrilaterals, linear and quadratic.
const PLANE: [u8; 4] = [5, 9, 22, 28];
/// VTK types of lines.
const LINES: [u8; 2] = [3, 21];

impl DrawnRun {
    /// Reads the run in a results folder at its latest time: `case.toml`, `fields.pvd` with its latest snapshot or
    /// `fields.vtkhdf`, `contact.csv` and `history.csv`.
    ///
    /// # Errors
    /// A file is missing or was not written by a run; the error names the file.
    pub fn read(folder: &Path) -> Result<DrawnRun, PlotError> {
        let results = Results::read(folder)?;
        results.run(results.snapshots.len() - 1)
    }

    /// Reads the run at the snapshots nearest to several times, in the order of time. Without times the run is read at
    /// the times of a strip that shows its changes, or at the latest only if the changes are still present there.
    ///
    /// # Errors
    /// As [`DrawnRun::read`]; also [`PlotError::Data`] if a time is beyond the snapshots.
    pub fn frames(folder: &Path, times: &[f64]) -> Result<Vec<DrawnRun>, PlotError> {
        let results = Results::read(folder)?;
        let snapshots: Vec<f64> = results.snapshots.iter().map(|(t, _)| *t).collect();
        let chosen = if times.is_empty() {
            frames::choose(&results.history, &snapshots)
        } else {
            frames::at(times, &snapshots)?
        };
        chosen.into_iter().map(|i| results.run(i)).collect()
    }
}

/// The data common to all times of a run.
pub(super) struct Results<'f> {
    folder: &'f Path,
    pub problem: Arc<Problem>,
    pub history: HistoryColumns,
    /// Times and files of the fields, at least one.
    pub snapshots: Vec<(f64, String)>,
    /// The file of all fields, or `None` if each snapshot has its own.
    packed: Option<Reader>,
}

/// True if a results folder has the fields of a run.
pub(super) fn has_fields(folder: &Path) -> bool {
    [FIELDS, PACKED].iter().any(|name| folder.join(name).exists())
}

/// The problem of the case in a results folder.
pub(super) fn problem(folder: &Path) -> Result<Problem, PlotError> {
    let path = folder.join(CASE);
    let case = case::read(&path, &[]).map_err(|error| match error {
        CaseError::Read { path, source } => PlotError::Read { path, source },
        faults @ CaseError::Faults { .. } => PlotError::Format { path, what: faults.to_string() },
    })?;
    Ok(case.problem)
}

impl Results<'_> {
    pub(super) fn read(folder: &Path) -> Result<Results<'_>, PlotError> {
        let problem = Arc::new(problem(folder)?);
        let (list, path) = (folder.join(FIELDS), folder.join(PACKED));
        let (snapshots, packed) = if list.exists() || !path.exists() {
            (vtu::snapshots(&list)?, None)
        } else {
            let reader = Reader::open(&path).map_err(|what| PlotError::Format { path, what })?;
            // Names that separate files would have: those of the contact points correspond to them.
            (reader.at().iter().map(|&(step, t)| (t, fields_file(step))).collect(), Some(reader))
        };
        let history = history(&CsvTable::read(&folder.join(HISTORY))?)?;
        let problem = ground::found(&problem, &history);
        Ok(Results { folder, problem, history, snapshots, packed })
    }

    /// The run at the time of a snapshot.
    pub(super) fn run(&self, snapshot: usize) -> Result<DrawnRun, PlotError> {
        let (t, file) = &self.snapshots[snapshot];
        let path = self.folder.join(if self.packed.is_some() { PACKED } else { file });
        let format = |what: String| PlotError::Format { path: path.clone(), what };
        let grid = match &self.packed {
            Some(reader) => reader.grid(snapshot).map_err(format)?,
            None => vtu::read(&path)?,
        };
        let all = |kinds: &[u8]| grid.types.iter().all(|kind| kinds.contains(kind));
        let dimension = if all(&PLANE) {
            2
        } else if all(&LINES) {
            1
        } else {
            3
        };
        let sides = names_of_points(&self.problem.contacts);
        let mut run = DrawnRun {
            name: self.problem.name.clone(),
            dimension,
            t: *t,
            history: self.history.clone(),
            units: self.problem.units(),
            // With another mesh the foundation is unknown.
            problem: (self.problem.mesh.points.len() == grid.points.len()).then(|| self.problem.clone()),
            sides,
            ..DrawnRun::default()
        };
        let table = if dimension > 1 { self.contact(snapshot)? } else { None };
        match (dimension, table) {
            (2, table) => {
                run.snapshot = Some(plane(&grid).map_err(format)?);
                run.contact = table.map_or_else(|| Ok(Vec::new()), |table| contact::in_plane(&table, &run.sides))?;
                contact::read_in_means(&self.problem, &mut run.contact);
            }
            (3, table) => {
                let mut rows = table.map_or_else(|| Ok(Vec::new()), |table| contact::in_space(&table, &run.sides))?;
                contact::read_in_means(&self.problem, &mut rows);
                run.solid = Some(solid(&grid, rows).map_err(format)?);
            }
            _ => run.rod = Some(rod(&grid).map_err(format)?),
        }
        Ok(run)
    }

    /// The contact points at the time of a snapshot, or `None` without contact or if they were not written at that
    /// time.
    fn contact(&self, snapshot: usize) -> Result<Option<CsvTable>, PlotError> {
        if self.problem.contacts.is_empty() {
            return Ok(None);
        }
        if snapshot + 1 == self.snapshots.len() {
            return CsvTable::read(&self.folder.join(CONTACT)).map(Some);
        }
        let stem = Path::new(&self.snapshots[snapshot].1).file_stem().unwrap_or_default();
        let path = self.folder.join("contact").join(stem).with_extension("csv");
        if path.exists() { CsvTable::read(&path).map(Some) } else { Ok(None) }
    }
}

/// The fields of a plane body.
fn plane(grid: &vtu::Grid) -> Result<PlaneSnapshot, String> {
    let snapshot = PlaneSnapshot {
        body: PlaneMesh::new(grid.points.iter().map(|p| [p[0], p[1]]).collect(), grid.cells())
            .map_err(|e| e.to_string())?,
        displacement: displacement(grid)?.iter().map(|u| [u[0], u[1]]).collect(),
        temperature: temperature(grid)?,
        von_mises: von_mises(grid)?,
        nodal_von_mises: optional(&grid.point_data, "nodal_von_mises"),
        regions: optional(&grid.cell_data, "region"),
    };
    snapshot.check().map_err(|e| e.to_string())?;
    Ok(snapshot)
}

fn optional(data: &BTreeMap<String, vtu::Array>, name: &str) -> Vec<f64> {
    data.get(name).filter(|array| array.components == 1).map(|array| array.values.clone()).unwrap_or_default()
}

/// The fields of a body on a line, its nodes in the order of x.
fn rod(grid: &vtu::Grid) -> Result<Rod, String> {
    let mut order: Vec<usize> = (0..grid.points.len()).collect();
    order.sort_by(|&i, &j| grid.points[i][0].total_cmp(&grid.points[j][0]));
    let (displacement, temperature) = (displacement(grid)?, optional(&grid.point_data, "temperature"));
    let finite = |name: &str, values: Vec<f64>| {
        if values.iter().all(|v| v.is_finite()) { Ok(values) } else { Err(format!("{name} is not finite")) }
    };
    Ok(Rod {
        x: finite("a coordinate", order.iter().map(|&i| grid.points[i][0]).collect())?,
        displacement: finite("the displacement", order.iter().map(|&i| displacement[i][0]).collect())?,
        temperature: finite("the temperature", order.iter().filter_map(|&i| temperature.get(i).copied()).collect())?,
    })
}

/// The fields of a body in space.
fn solid(grid: &vtu::Grid, contact: Vec<SolidContact>) -> Result<SpaceSnapshot, String> {
    let solid = SpaceSnapshot {
        surface: Skin::new(grid.points.clone(), grid.types.iter().copied().zip(grid.cells()))
            .map_err(|e| e.to_string())?,
        displacement: displacement(grid)?,
        temperature: temperature(grid)?,
        von_mises: von_mises(grid)?,
        nodal_von_mises: optional(&grid.point_data, "nodal_von_mises"),
        regions: optional(&grid.cell_data, "region"),
        contact,
    };
    solid.check().map_err(|e| e.to_string())?;
    Ok(solid)
}

type NamedArrays = BTreeMap<String, vtu::Array>;

/// The temperature of each node; empty in a run of mechanics only.
fn temperature(grid: &vtu::Grid) -> Result<Vec<f64>, String> {
    let mechanics_alone = has_mechanics(grid) && !grid.point_data.contains_key("temperature");
    if mechanics_alone { Ok(Vec::new()) } else { Ok(array(&grid.point_data, "temperature", 1)?.to_vec()) }
}

/// The von Mises stress of each cell; empty in a run of heat only.
fn von_mises(grid: &vtu::Grid) -> Result<Vec<f64>, String> {
    if has_mechanics(grid) { Ok(array(&grid.cell_data, "von_mises", 1)?.to_vec()) } else { Ok(Vec::new()) }
}

fn has_mechanics(grid: &vtu::Grid) -> bool {
    grid.point_data.contains_key("displacement")
}

/// The displacement of each node, zero in a run without mechanics.
fn displacement(grid: &vtu::Grid) -> Result<Vec<[f64; 3]>, String> {
    if !has_mechanics(grid) {
        return Ok(vec![[0.0; 3]; grid.points.len()]);
    }
    Ok(array(&grid.point_data, "displacement", 3)?.chunks_exact(3).map(|u| [u[0], u[1], u[2]]).collect())
}

fn array<'a>(data: &'a NamedArrays, name: &str, components: usize) -> Result<&'a [f64], String> {
    let array = data.get(name).ok_or_else(|| format!("it has no array {name}"))?;
    if array.components == components {
        Ok(&array.values)
    } else {
        Err(format!("the array {name} has {} components, expected {components}", array.components))
    }
}

fn history(table: &CsvTable) -> Result<HistoryColumns, PlotError> {
    table.numbers(columns::TIME.name)?;
    let numbers = table.names().iter().filter(|name| *name != columns::PHASE.name);
    numbers.map(|name| Ok((name.clone(), table.numbers(name)?))).collect()
}
