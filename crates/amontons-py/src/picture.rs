//! Pictures of runs that are in memory.

use std::path::PathBuf;
use std::sync::Arc;

use amontons::contact::Status;
use amontons::output::ContactValues;
use amontons::plot::{self, Body, ContactRow, Kind, Options, Panel, Skin, Solid, SolidContact};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors;
use crate::run::Run;
use crate::snapshot::Snapshot;

/// Columns of the contact points at a time.
struct Points<'a>(&'a Snapshot);

impl Points<'_> {
    fn number(&self, name: &str, i: usize) -> f64 {
        let column = self.0.contact.iter().position(|(known, _)| known == name);
        column.and_then(|column| self.0.numbers(column).get(i)).copied().unwrap_or(0.0)
    }

    fn word(&self, name: &str, i: usize) -> &str {
        self.0
            .contact
            .iter()
            .find_map(|(known, values)| match values {
                ContactValues::Words(words) if known == name => words.get(i).map(String::as_str),
                _ => None,
            })
            .unwrap_or_default()
    }

    fn len(&self) -> usize {
        self.0
            .contact
            .iter()
            .map(|(_, values)| match values {
                ContactValues::Numbers(values) => values.len(),
                ContactValues::Words(words) => words.len(),
            })
            .next()
            .unwrap_or(0)
    }

    fn status(&self, i: usize) -> Status {
        let word = self.word("status", i);
        [Status::Open, Status::Stick, Status::Slip].into_iter().find(|s| s.name() == word).unwrap_or(Status::Open)
    }

    fn side(&self, i: usize, sides: &[String]) -> usize {
        let name = self.word("side", i);
        sides.iter().position(|side| side == name).unwrap_or(0)
    }

    fn plane(&self, sides: &[String]) -> Vec<ContactRow> {
        let pair = |name: &str, i: usize| ["x", "y"].map(|axis| self.number(&format!("{name}{axis}"), i));
        let row = |i: usize| ContactRow {
            x: pair("", i),
            penetration: self.number("penetration", i),
            pressure: self.number("pressure", i),
            bound: Some(self.number("bound", i)),
            traction: pair("traction_", i),
            slip_velocity: pair("slip_velocity_", i),
            status: self.status(i),
            temperature: self.number("temperature", i),
            opposite_temperature: self.number("opposite_temperature", i),
            heat_flux: self.number("heat_flux", i),
            wear: self.number("wear", i),
            friction_work: self.number("friction_work", i),
            side: self.side(i, sides),
        };
        (0..self.len()).map(row).collect()
    }

    fn space(&self, sides: &[String]) -> Vec<SolidContact> {
        let triple = |name: &str, i: usize| ["x", "y", "z"].map(|axis| self.number(&format!("{name}{axis}"), i));
        let row = |i: usize| SolidContact {
            x: triple("", i),
            pressure: self.number("pressure", i),
            status: self.status(i),
            slip_velocity: triple("slip_velocity_", i),
            wear: self.number("wear", i),
            friction_work: self.number("friction_work", i),
            side: self.side(i, sides),
        };
        (0..self.len()).map(row).collect()
    }
}

/// What a picture shows of a run at a time.
fn shown(py: Python<'_>, run: &Run, at: &Snapshot) -> Result<plot::Run, plot::PlotError> {
    let problem = run.problem();
    let (mesh, physics) = (&problem.mesh, problem.physics);
    let sides: Vec<String> = problem.contacts.iter().map(|contact| contact.bearing().to_owned()).collect();
    let von_mises = if physics.has_mechanics() { at.cells(py).von_mises.clone() } else { Vec::new() };
    let nodal_von_mises = if physics.has_mechanics() { py.detach(|| at.nodal_von_mises()) } else { Vec::new() };
    let temperature = if physics.has_heat() { at.state.theta.clone() } else { Vec::new() };
    let regions = mesh.blocks.iter().flat_map(|b| std::iter::repeat_n(b.region as f64, b.len())).collect();
    let u = |node: usize, c: usize| at.state.u.get(node * mesh.dim + c).copied().unwrap_or(0.0);
    let nodes = mesh.points.len();
    let mut drawn = plot::Run {
        name: problem.name.clone(),
        dimension: mesh.dim,
        t: at.state.t,
        history: run.history().map(|(name, values)| (name.clone(), values)).collect(),
        units: problem.units(),
        problem: Some(Arc::clone(problem)),
        ..plot::Run::default()
    };
    let points = Points(at);
    match mesh.dim {
        2 => {
            drawn.contact = points.plane(&sides);
            drawn.snapshot = Some(plot::Snapshot {
                body: Body::of_mesh(mesh)?,
                displacement: (0..nodes).map(|n| [u(n, 0), u(n, 1)]).collect(),
                temperature,
                von_mises,
                nodal_von_mises,
                regions,
            });
        }
        3 => {
            drawn.solid = Some(Solid {
                surface: Skin::of_mesh(mesh)?,
                displacement: (0..nodes).map(|n| [u(n, 0), u(n, 1), u(n, 2)]).collect(),
                temperature,
                von_mises,
                nodal_von_mises,
                regions,
                contact: points.space(&sides),
            });
        }
        _ => {}
    }
    drawn.sides = sides;
    Ok(drawn)
}

/// Draws a picture of a run at one of its snapshots: SVG and PNG.
#[pyfunction]
pub fn picture<'py>(
    run: &Bound<'py, Run>,
    snapshot: &Bound<'py, Snapshot>,
    name: &str,
    pixels: f64,
) -> PyResult<(String, Bound<'py, PyBytes>)> {
    let py = run.py();
    let Some(kind) = Kind::ALL.into_iter().find(|kind| kind.file_name() == name) else {
        let known: Vec<String> = Kind::ALL.iter().map(|kind| format!("\"{}\"", kind.file_name())).collect();
        return Err(errors::request(
            py,
            &format!("found the picture \"{name}\", expected one of {}", known.join(", ")),
        ));
    };
    let draw = || {
        let drawn = shown(py, run.get(), snapshot.get())?;
        let picture = plot::picture(kind, &[Panel { title: "", run: &drawn }], &Options::default())?;
        Ok((picture.svg(), picture.png(pixels)?))
    };
    let (svg, png) = draw().map_err(|error| errors::of_plot(py, &error))?;
    Ok((svg, PyBytes::new(py, &png)))
}

/// Draws all pictures of a results folder, as `amontons plot` does; returns their paths.
#[pyfunction]
pub fn plot_folder(py: Python<'_>, folder: PathBuf) -> PyResult<Vec<PathBuf>> {
    py.detach(|| plot::folder(&folder, &Options::default())).map_err(|error| errors::of_plot(py, &error))
}
