//! The contact points of a run, from a table of their columns: of a file, or of a run in memory.

use super::PlotError;
use super::run::{ContactRow, SolidContact};
use crate::contact::{NoSlip, Status, read, read_vector};
use crate::output::ContactValues;
use crate::output::columns::{self, Column, ContactColumns};
use crate::problem::Problem;

/// A table with the columns of `contact.csv`.
pub(super) trait ContactTable {
    /// Number of rows.
    fn rows(&self) -> usize;
    /// True if there is a column of this name.
    fn has(&self, name: &str) -> bool;
    /// True if a column has no values because the run does not have the field.
    fn is_empty(&self, name: &str) -> bool;
    /// A column of finite numbers.
    fn numbers(&self, name: &str) -> Result<Vec<f64>, PlotError>;
    /// A column of optional numbers: NaN where they are missing.
    fn optional_numbers(&self, name: &str) -> Result<Vec<f64>, PlotError>;
    /// A column of text.
    fn words(&self, name: &str) -> Result<Vec<String>, PlotError>;
    /// The error for this fault of the table.
    fn fault(&self, what: String) -> PlotError;
}

/// The columns of a run in memory.
impl ContactTable for &[(String, ContactValues)] {
    fn rows(&self) -> usize {
        self.first().map_or(0, |(_, values)| match values {
            ContactValues::Numbers(values) => values.len(),
            ContactValues::Words(words) => words.len(),
        })
    }
    fn has(&self, name: &str) -> bool {
        self.iter().any(|(known, _)| known == name)
    }
    fn is_empty(&self, name: &str) -> bool {
        self.optional_numbers(name).is_ok_and(|values| values.iter().all(|v| v.is_nan()))
    }
    fn numbers(&self, name: &str) -> Result<Vec<f64>, PlotError> {
        match self.iter().find(|(known, _)| known == name) {
            Some((_, ContactValues::Numbers(values))) if values.iter().all(|v| v.is_finite()) => Ok(values.clone()),
            Some(_) => {
                Err(self.fault(format!("the column {name} of the contact points has values that are not finite")))
            }
            None => Err(self.fault(format!("the contact points have no column {name}"))),
        }
    }
    fn optional_numbers(&self, name: &str) -> Result<Vec<f64>, PlotError> {
        match self.iter().find(|(known, _)| known == name) {
            Some((_, ContactValues::Numbers(values))) => Ok(values.clone()),
            _ => Ok(vec![f64::NAN; self.rows()]),
        }
    }
    fn words(&self, name: &str) -> Result<Vec<String>, PlotError> {
        match self.iter().find(|(known, _)| known == name) {
            Some((_, ContactValues::Words(words))) => Ok(words.clone()),
            _ => Err(self.fault(format!("the contact points have no column {name}"))),
        }
    }
    fn fault(&self, what: String) -> PlotError {
        PlotError::Data(what)
    }
}

/// Replaces pressures, tractions and bounds by means of neighbouring points, because they alternate between the nodes
/// of quadratic facets.
pub(super) fn read_in_means<R: Tractions>(problem: &Problem, rows: &mut [R]) {
    let (mesh, boundary) = (&problem.mesh, problem.contact_boundary());
    if boundary.points.len() != rows.len() {
        return;
    }
    let before: Vec<[f64; 5]> = rows.iter().map(Tractions::tractions).collect();
    for (side, contact) in problem.contacts.iter().enumerate() {
        let Some(set) = mesh.facets.get(contact.bearing()) else { continue };
        for (point, shares) in boundary.readable(mesh, side, set) {
            let [pressure, bound] = [0, 4].map(|c| read(&shares, |i| before[i][c]));
            let [x, y, z] = read_vector(&shares, |i| [before[i][1], before[i][2], before[i][3]]);
            rows[point].replace([pressure, x, y, z, bound]);
        }
    }
}

/// A contact point whose tractions are drawn: pressure, three components of the friction traction, bound.
pub(super) trait Tractions {
    fn tractions(&self) -> [f64; 5];
    fn replace(&mut self, values: [f64; 5]);
}

impl Tractions for ContactRow {
    fn tractions(&self) -> [f64; 5] {
        let [x, y, z] = self.traction;
        [self.pressure, x, y, z, self.bound.unwrap_or(0.0)]
    }
    fn replace(&mut self, [pressure, x, y, z, bound]: [f64; 5]) {
        (self.pressure, self.traction, self.bound) = (pressure, [x, y, z], self.bound.map(|_| bound));
    }
}

impl Tractions for SolidContact {
    fn tractions(&self) -> [f64; 5] {
        [self.pressure, 0.0, 0.0, 0.0, 0.0]
    }
    fn replace(&mut self, [pressure, ..]: [f64; 5]) {
        self.pressure = pressure;
    }
}

/// The contact points of a body in space.
pub(super) fn in_space(table: &impl ContactTable, sides: &[String]) -> Result<Vec<SolidContact>, PlotError> {
    let triple = |of: &Column<ContactColumns>| -> Result<[Vec<f64>; 3], PlotError> {
        Ok([table.numbers(&of.component(0))?, table.numbers(&of.component(1))?, table.numbers(&of.component(2))?])
    };
    let ([x, y, z], slip) = (triple(&columns::POSITION)?, triple(&columns::SLIP_VELOCITY)?);
    let (pressure, status, side) = (table.numbers(columns::PRESSURE.name)?, statuses(table)?, on_sides(table, sides)?);
    let [wear, friction_work] = worn(table, x.len())?;
    let row = |i: usize| SolidContact {
        x: [x[i], y[i], z[i]],
        pressure: pressure[i],
        point_pressure: pressure[i],
        status: status[i],
        slip_velocity: [slip[0][i], slip[1][i], slip[2][i]],
        wear: wear[i],
        friction_work: friction_work[i],
        side: side[i],
    };
    Ok((0..x.len()).map(row).collect())
}

/// Wear and friction work; zero if the table lacks them.
fn worn(table: &impl ContactTable, rows: usize) -> Result<[Vec<f64>; 2], PlotError> {
    let column = |name| if table.has(name) { table.numbers(name) } else { Ok(vec![0.0; rows]) };
    Ok([column(columns::WEAR.name)?, column(columns::FRICTION_WORK.name)?])
}

/// The side of each contact point; the first side if the table has no such column.
fn on_sides(table: &impl ContactTable, sides: &[String]) -> Result<Vec<usize>, PlotError> {
    if !table.has(columns::SIDE.name) {
        return Ok(vec![0; table.rows()]);
    }
    let names = table.words(columns::SIDE.name)?;
    let fault = |name: &String| table.fault(format!("the side `{name}` is none of {}", sides.join(", ")));
    names.iter().map(|name| sides.iter().position(|side| side == name).ok_or_else(|| fault(name))).collect()
}

/// The states of the contact points.
fn statuses(table: &impl ContactTable) -> Result<Vec<Status>, PlotError> {
    let status = |word: &String| {
        let known = [Status::Open, Status::Stick, Status::Slip];
        let fault = || table.fault(format!("the status `{word}` is none of open, stick, slip"));
        known.into_iter().find(|s| s.name() == word).ok_or_else(fault)
    };
    table.words(columns::STATUS.name)?.iter().map(status).collect()
}

/// The contact points of a plane body.
pub(super) fn in_plane(table: &impl ContactTable, sides: &[String]) -> Result<Vec<ContactRow>, PlotError> {
    let pairs = |of: &Column<ContactColumns>| -> Result<Vec<[f64; 2]>, PlotError> {
        let (x, y) = (table.numbers(&of.component(0))?, table.numbers(&of.component(1))?);
        Ok(x.into_iter().zip(y).map(|(x, y)| [x, y]).collect())
    };
    // Components out of the plane exist only if a foundation slides that way.
    let triples = |of: &Column<ContactColumns>| -> Result<Vec<[f64; 3]>, PlotError> {
        let (plane, out) = (pairs(of)?, of.component(2));
        let out = if table.has(&out) { table.numbers(&out)? } else { vec![0.0; plane.len()] };
        Ok(plane.into_iter().zip(out).map(|([x, y], z)| [x, y, z]).collect())
    };
    let (x, traction, slip_velocity) =
        (pairs(&columns::POSITION)?, triples(&columns::TRACTION)?, triples(&columns::SLIP_VELOCITY)?);
    let (penetration, pressure) = (table.numbers(columns::PENETRATION.name)?, table.numbers(columns::PRESSURE.name)?);
    let of_heat = |name: &str| if table.is_empty(name) { Ok(vec![f64::NAN; x.len()]) } else { table.numbers(name) };
    let (temperature, heat_flux) = (of_heat(columns::TEMPERATURE.name)?, of_heat(columns::HEAT_FLUX.name)?);
    let opposite_temperature = table.optional_numbers(columns::OPPOSITE_TEMPERATURE.name)?;
    let (status, side) = (statuses(table)?, on_sides(table, sides)?);
    let [wear, friction_work] = worn(table, x.len())?;
    let bound = if table.has(columns::BOUND.name) { Some(table.numbers(columns::BOUND.name)?) } else { None };
    let row = |i: usize| ContactRow {
        x: x[i],
        penetration: penetration[i],
        pressure: pressure[i],
        point_pressure: pressure[i],
        bound: bound.as_ref().map(|b| b[i]).filter(|&bound| bound < NoSlip::BOUND),
        traction: traction[i],
        slip_velocity: slip_velocity[i],
        status: status[i],
        temperature: temperature[i],
        opposite_temperature: opposite_temperature[i],
        heat_flux: heat_flux[i],
        wear: wear[i],
        friction_work: friction_work[i],
        side: side[i],
    };
    Ok((0..x.len()).map(row).collect())
}
