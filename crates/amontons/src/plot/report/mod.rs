//! `report.html`: a results folder as one page that needs no other file, no network and only a browser.
//!
//! The page holds text as HTML and data as numbers, from which the browser draws the body, the sides of contact and the
//! histories. The same folder gives the same bits.

mod body;
mod charts;
mod field;
mod pack;
mod page;
mod sides;
mod thin;

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::accuracy::meshes;
use super::color::ColorMap;
use super::convergence::ConvergencePlot;
use super::folder::{Results, has_fields};
use super::table::CsvTable;
use super::{Options, PlotError, convergence, frames, profiles, time};
use crate::case::{self, Case, CaseError};
use crate::convergence::ValueRow;
use crate::machine;
use crate::output::names::{CASE, SUMMARY};
use crate::output::{LONGEST, Summary, write_file};
use crate::units::{Measure, UnitSystem, Units};
use pack::Pack;

/// Name of the page in a results folder.
pub(super) const FILE: &str = "report.html";
/// Largest number of snapshots on a page, and of values of the fields of the body in all of them.
const SNAPSHOTS: usize = 100;
const NUMBERS: usize = 1_500_000;

/// The contents of a page.
struct Contents {
    case: Case,
    text: String,
    summary: Option<Summary>,
    /// Names of columns and rows of a convergence study, and its picture as SVG.
    study: Option<(CsvTable, String)>,
    /// The meshes of a run for an accuracy, and their picture as SVG.
    accuracy: Option<(CsvTable, Option<String>)>,
    /// Probes, resultants and energies at the end on each level of the study.
    values: Vec<ValueRow>,
    /// Descriptions of the drawings, and their arrays.
    data: Value,
    arrays: String,
    /// Notes on results that the page leaves out.
    notes: Vec<String>,
}

/// Writes the page of a results folder of a run or a convergence study into it. Returns its path.
///
/// # Errors
/// A file is missing or damaged, or the page cannot be written; the error names the file.
pub fn report(dir: &Path) -> Result<PathBuf, PlotError> {
    let contents = Contents::read(dir)?;
    let path = dir.join(FILE);
    write_file(&path, page::write(&contents).as_bytes())
        .map_err(|source| PlotError::Write { path: path.clone(), source })?;
    Ok(path)
}

fn summary(dir: &Path) -> Result<Summary, PlotError> {
    let path = dir.join(SUMMARY);
    let text = machine::read_text(&path, LONGEST).map_err(|source| PlotError::Read { path: path.clone(), source })?;
    serde_json::from_str(&text).map_err(|e| PlotError::Format { path, what: e.to_string() })
}

fn read_case(dir: &Path) -> Result<(Case, String), PlotError> {
    let path = dir.join(CASE);
    if !path.exists() && dir.join("sweep.csv").exists() {
        return Err(PlotError::Data(format!("{} holds a sweep; make the report of one of its runs", dir.display())));
    }
    let text = machine::read_text(&path, LONGEST).map_err(|source| PlotError::Read { path: path.clone(), source })?;
    match case::read(&path, &[]) {
        Ok(case) => Ok((case, text)),
        Err(CaseError::Read { path, source }) => Err(PlotError::Read { path, source }),
        Err(faults @ CaseError::Faults { .. }) => Err(PlotError::Format { path, what: faults.to_string() }),
    }
}

fn study(dir: &Path, units: Units) -> Result<Option<(CsvTable, String)>, PlotError> {
    let path = dir.join("convergence.csv");
    if !path.exists() {
        return Ok(None);
    }
    let options = Options { dimensionless: units.system == UnitSystem::Dimensionless, ..Options::default() };
    let picture = convergence(&ConvergencePlot::read(&path, &options)?)?;
    Ok(Some((CsvTable::read(&path)?, picture.svg())))
}

/// The part of `convergence.json` with the numbers at the end.
#[derive(serde::Deserialize)]
struct ValuesOfStudy {
    #[serde(default)]
    values: Vec<ValueRow>,
}

/// The numbers at the end of a study; none of a study that was made without them.
fn values(dir: &Path) -> Result<Vec<ValueRow>, PlotError> {
    let path = dir.join("convergence.json");
    if !path.exists() {
        return Ok(Vec::new());
    }
    let text = machine::read_text(&path, LONGEST).map_err(|source| PlotError::Read { path: path.clone(), source })?;
    let read: Result<ValuesOfStudy, _> = serde_json::from_str(&text);
    read.map(|read| read.values).map_err(|e| PlotError::Format { path, what: e.to_string() })
}

/// 256 colours of a map, concatenated.
fn colors(map: ColorMap) -> String {
    (0..256).flat_map(|i| map.at(f64::from(i) / 255.0)).map(|c| format!("{c:02x}")).collect()
}

impl Contents {
    fn read(dir: &Path) -> Result<Contents, PlotError> {
        let (case, text) = read_case(dir)?;
        let units = case.problem.units();
        let study = study(dir, units)?;
        let values = if study.is_some() { values(dir)? } else { Vec::new() };
        let mut contents = Contents {
            case,
            text,
            summary: None,
            accuracy: meshes(dir)?.map(|(table, picture)| (table, picture.map(|picture| picture.svg()))),
            study,
            values,
            data: Value::Null,
            arrays: String::new(),
            notes: Vec::new(),
        };
        if contents.study.is_none() || has_fields(dir) {
            contents.run(dir)?;
        }
        Ok(contents)
    }

    /// Reads the run of the folder.
    fn run(&mut self, dir: &Path) -> Result<(), PlotError> {
        self.summary = Some(summary(dir)?);
        let (results, units) = (Results::read(dir)?, self.case.problem.units());
        // Number of values of all fields in a snapshot: displacement, stress and temperature.
        let nodes = self.case.problem.mesh.points.len().min(body::VERTICES);
        let most = (NUMBERS / (5 * nodes.max(1))).clamp(8, SNAPSHOTS);
        let (all, mut pack) = (results.snapshots.len(), Pack::default());
        let chosen = frames::evenly(all, most);
        if chosen.len() < all {
            self.notes.push(format!("The page has {} of {all} snapshots.", chosen.len()));
        }
        let times = chosen.iter().map(|&i| results.snapshots[i].0);
        let last = results.run(all - 1)?;
        let body = body::write(&results, &chosen, units, &mut pack)?;
        let data = json!({
            "times": times.clone().map(|t| time(t, units)).collect::<Vec<_>>(),
            "t": times.collect::<Vec<_>>(),
            "second": units.of(Measure::Time),
            "body": body,
            "rod": if body.is_null() { body::rod(&results, &chosen, units, &mut pack)? } else { Value::Null },
            "contact": sides::write(dir, &results, &chosen, units, &mut pack)?,
            "states": profiles::STATUSES.map(|s| json!([s.name(), charts::hexadecimal(profiles::color(s))])),
            "history": charts::write(&last, units, &mut pack),
            "probes": charts::probes(dir, &self.case, units, &mut pack)?,
            "maps": { "viridis": colors(ColorMap::Viridis), "inferno": colors(ColorMap::Inferno) },
            "none": pack::NONE,
        });
        self.note_coarser(&data);
        let (places, arrays) = pack.finish();
        (self.data, self.arrays) = (data, arrays);
        self.data["arrays"] = json!(places);
        Ok(())
    }

    /// Notes data that are drawn coarser than computed.
    fn note_coarser(&mut self, data: &Value) {
        let pair = |value: &Value| Some([value.get(0)?.as_u64()?, value.get(1)?.as_u64()?]);
        let mut note = |what: &str, value: &Value, files: &str| {
            if let Some([kept, all]) = pair(value).filter(|[kept, all]| kept < all) {
                self.notes.push(format!("{what} has {kept} of {all} {files}."));
            }
        };
        note("The surface of the body", &data["body"]["vertices"], "nodes, so small details are missing");
        for side in data["contact"]["sides"].as_array().into_iter().flatten() {
            let name = side["name"].as_str().unwrap_or_default();
            note(&format!("The side \"{name}\""), &side["vertices"], "nodes");
        }
        let with_extremes = "rows, among them the extremes of each column";
        note("The history", &data["history"]["rows"], &format!("{with_extremes}; history.csv has all"));
        note("The table of probes", &data["probes"]["rows"], &format!("{with_extremes}; probes.csv has all"));
    }
}
