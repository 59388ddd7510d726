//! Reads a results folder.

use std::path::Path;

use super::body::Body;
use super::run::{ContactRow, History, Run, Snapshot, Solid, SolidContact};
use super::surface::Surface;
use super::table::{self, Table};
use super::{PlotError, vtu};
use crate::contact::Status;

/// Cell types of VTK that are plane: triangles and quadrilaterals, linear and quadratic.
const PLANE: [u8; 4] = [5, 9, 22, 28];
/// Cell types of VTK that are lines.
const LINES: [u8; 2] = [3, 21];

impl Run {
    /// Reads the run in a results folder: `case.toml`, `fields.pvd` with its latest snapshot, `contact.csv` and `history.csv`.
    ///
    /// # Errors
    /// When a file is missing or is not what a run writes; the error names the file.
    pub fn read(folder: &Path) -> Result<Run, PlotError> {
        let case = Case::read(&folder.join("case.toml"))?;
        let collection = folder.join("fields.pvd");
        let (t, file) = vtu::latest(&collection)?;
        let path = folder.join(file);
        let grid = vtu::read(&path)?;
        let format = |what: String| PlotError::Format { path: path.clone(), what };
        let dimension = if grid.types.iter().all(|kind| PLANE.contains(kind)) {
            2
        } else if grid.types.iter().all(|kind| LINES.contains(kind)) {
            1
        } else {
            3
        };
        let snapshot = if dimension == 2 {
            let snapshot = Snapshot {
                body: Body::new(grid.points.iter().map(|p| [p[0], p[1]]).collect(), grid.cells()).map_err(|e| format(e.to_string()))?,
                displacement: displacement(&grid).map_err(format)?.iter().map(|u| [u[0], u[1]]).collect(),
                temperature: temperature(&grid).map_err(format)?,
                von_mises: von_mises(&grid).map_err(format)?,
            };
            snapshot.check().map_err(|e| format(e.to_string()))?;
            Some(snapshot)
        } else {
            None
        };
        let points =
            |dimension_drawn: usize| if case.has_contact && dimension == dimension_drawn { Some(Table::read(&folder.join("contact.csv"))) } else { None };
        let contact = points(2).transpose()?.map_or_else(|| Ok(Vec::new()), |table| contact(&table, case.coulomb))?;
        let solid = if dimension == 3 {
            let rows = points(3).transpose()?.map_or_else(|| Ok(Vec::new()), |table| contact_in_space(&table))?;
            Some(solid(&grid, rows).map_err(format)?)
        } else {
            None
        };
        let history = history(&Table::read(&folder.join("history.csv"))?)?;
        Ok(Run { name: case.name, dimension, t, snapshot, contact, solid, history })
    }
}

/// The fields of a body in space.
fn solid(grid: &vtu::Grid, contact: Vec<SolidContact>) -> Result<Solid, String> {
    let solid = Solid {
        surface: Surface::new(grid.points.clone(), grid.types.iter().copied().zip(grid.cells())).map_err(|e| e.to_string())?,
        displacement: displacement(grid)?,
        temperature: temperature(grid)?,
        von_mises: von_mises(grid)?,
        regions: grid.cell_data.get("region").map(|region| region.values.clone()).unwrap_or_default(),
        contact,
    };
    solid.check().map_err(|e| e.to_string())?;
    Ok(solid)
}

type Arrays = std::collections::BTreeMap<String, vtu::Array>;

/// The temperature of each node; empty in a run of mechanics alone.
fn temperature(grid: &vtu::Grid) -> Result<Vec<f64>, String> {
    let mechanics_alone = has_mechanics(grid) && !grid.point_data.contains_key("temperature");
    if mechanics_alone { Ok(Vec::new()) } else { Ok(array(&grid.point_data, "temperature", 1)?.to_vec()) }
}

/// The von Mises stress of each cell; empty in a run of heat alone.
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

fn array<'a>(data: &'a Arrays, name: &str, components: usize) -> Result<&'a [f64], String> {
    let array = data.get(name).ok_or_else(|| format!("it has no array {name}"))?;
    if array.components == components { Ok(&array.values) } else { Err(format!("the array {name} has {} components, expected {components}", array.components)) }
}

/// What the pictures need of a case file.
struct Case {
    name: String,
    has_contact: bool,
    /// Coefficient of Coulomb's law, where that is the law of friction.
    coulomb: Option<f64>,
}

impl Case {
    fn read(path: &Path) -> Result<Case, PlotError> {
        let text = table::text(path)?;
        let case: toml::Table = text.parse().map_err(|e: toml::de::Error| PlotError::Format { path: path.to_owned(), what: e.message().to_owned() })?;
        let name = case.get("name").and_then(toml::Value::as_str).unwrap_or_default().to_owned();
        let contact = case.get("contact");
        let friction = contact.and_then(|c| c.get("friction"));
        let coefficient = friction.filter(|f| f.get("law").and_then(toml::Value::as_str) == Some("coulomb")).and_then(|f| f.get("coefficient"));
        let coulomb = coefficient.and_then(|c| c.as_float().or_else(|| c.as_integer().map(|i| i as f64)));
        Ok(Case { name, has_contact: contact.is_some(), coulomb })
    }
}

/// The contact points of a body in space.
fn contact_in_space(table: &Table) -> Result<Vec<SolidContact>, PlotError> {
    let [x, y, z] = [table.numbers("x")?, table.numbers("y")?, table.numbers("z")?];
    let (pressure, status) = (table.numbers("pressure")?, statuses(table)?);
    let [wear, friction_work] = worn(table, x.len())?;
    let row = |i: usize| SolidContact { x: [x[i], y[i], z[i]], pressure: pressure[i], status: status[i], wear: wear[i], friction_work: friction_work[i] };
    Ok((0..x.len()).map(row).collect())
}

/// Wear and friction work, zero in a table without them.
fn worn(table: &Table, rows: usize) -> Result<[Vec<f64>; 2], PlotError> {
    let column = |name| if table.has(name) { table.numbers(name) } else { Ok(vec![0.0; rows]) };
    Ok([column("wear")?, column("friction_work")?])
}

/// The states of the contact points.
fn statuses(table: &Table) -> Result<Vec<Status>, PlotError> {
    let words: Vec<String> = table.column("status")?;
    let status = |word: &String| {
        let known = [Status::Open, Status::Stick, Status::Slip];
        known
            .into_iter()
            .find(|s| s.name() == word)
            .ok_or_else(|| PlotError::Format { path: table.path().to_owned(), what: format!("the status `{word}` is none of open, stick, slip") })
    };
    words.iter().map(status).collect()
}

fn contact(table: &Table, coulomb: Option<f64>) -> Result<Vec<ContactRow>, PlotError> {
    let pairs = |name: &str| -> Result<Vec<[f64; 2]>, PlotError> {
        let (x, y) = (table.numbers(&format!("{name}x"))?, table.numbers(&format!("{name}y"))?);
        Ok(x.into_iter().zip(y).map(|(x, y)| [x, y]).collect())
    };
    let (x, traction, slip_velocity) = (pairs("")?, pairs("traction_")?, pairs("slip_velocity_")?);
    let (penetration, pressure) = (table.numbers("penetration")?, table.numbers("pressure")?);
    let of_heat = |name: &str| if table.is_empty(name) { Ok(vec![f64::NAN; x.len()]) } else { table.numbers(name) };
    let (temperature, heat_flux) = (of_heat("temperature")?, of_heat("heat_flux")?);
    let status = statuses(table)?;
    let [wear, friction_work] = worn(table, x.len())?;
    let bound = if table.has("bound") { Some(table.numbers("bound")?) } else { None };
    let row = |i: usize| ContactRow {
        x: x[i],
        penetration: penetration[i],
        pressure: pressure[i],
        bound: bound.as_ref().map(|b| b[i]).or(coulomb.map(|mu| mu * pressure[i])),
        traction: traction[i],
        slip_velocity: slip_velocity[i],
        status: status[i],
        temperature: temperature[i],
        heat_flux: heat_flux[i],
        wear: wear[i],
        friction_work: friction_work[i],
    };
    Ok((0..x.len()).map(row).collect())
}

fn history(table: &Table) -> Result<History, PlotError> {
    table.numbers("t")?;
    table.names().iter().map(|name| Ok((name.clone(), table.numbers(name)?))).collect()
}
