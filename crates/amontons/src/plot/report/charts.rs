//! Histories of a page: charts of the run, every column of `history.csv`, and the probes.

use std::collections::BTreeSet;
use std::path::Path;

use serde_json::{Value, json};

use super::field::reading;
use super::pack::Pack;
use crate::case::Case;
use crate::contact::names;
use crate::output::names::PROBES;
use crate::output::{columns, history_measures};
use crate::plot::charts::{Chart, Series};
use crate::plot::color::{Color, LINES};
use crate::plot::run::DrawnRun;
use crate::plot::table::CsvTable;
use crate::plot::{PlotError, axes, history};
use crate::units::{Measure, Units};

/// Largest number of rows of a history, in addition to rows with an extreme of a column.
pub(super) const ROWS: usize = 2_000;

/// The rows of a table on the page: all, or every second, third … row and those with an extreme of a column.
fn kept(rows: usize, columns: &mut dyn Iterator<Item = &[f64]>) -> Vec<usize> {
    let each = rows.div_ceil(ROWS).max(1);
    let mut all: BTreeSet<usize> = (0..rows).step_by(each).chain(rows.checked_sub(1)).collect();
    if each > 1 {
        for column in columns {
            all.extend((0..rows).min_by(|&i, &j| column[i].total_cmp(&column[j])));
            all.extend((0..rows).max_by(|&i, &j| column[i].total_cmp(&column[j])));
        }
    }
    all.into_iter().collect()
}

pub(super) fn hexadecimal(color: Color) -> String {
    format!("#{:02x}{:02x}{:02x}", color.red, color.green, color.blue)
}

/// Lines over time, on the page.
struct ChartLines<'a> {
    name: String,
    measure: Measure,
    /// True if the lines are stacked parts of a whole.
    stacked: bool,
    all: Vec<(String, Color, &'a [f64], Vec<f64>)>,
}

/// The kept rows of a table, with their times.
struct KeptRows {
    kept: Vec<usize>,
    /// Number of the array of times.
    times: usize,
}

impl KeptRows {
    fn new(times: &[f64], columns: &mut dyn Iterator<Item = &[f64]>, pack: &mut Pack) -> KeptRows {
        let kept = kept(times.len(), columns);
        let times = pack.reals(kept.iter().map(|&i| times[i]));
        KeptRows { kept, times }
    }

    fn of(&self, values: &[f64], factor: f64, pack: &mut Pack) -> usize {
        pack.reals(self.kept.iter().map(|&i| values.get(i).copied().unwrap_or(f64::NAN) * factor))
    }

    fn write(&self, lines: &ChartLines, units: Units, pack: &mut Pack) -> Value {
        let all = lines.all.iter().flat_map(|line| &line.3);
        let largest = all.filter(|v| v.is_finite()).fold(0.0f64, |m, v| m.max(v.abs()));
        let (unit, factor) = reading(units, largest, lines.measure);
        let series = lines.all.iter().map(|(label, color, dashes, values)| {
            json!({
                "label": label,
                "color": hexadecimal(*color),
                "dashes": dashes,
                "values": self.of(values, factor, pack),
            })
        });
        json!({
            "name": lines.name,
            "unit": unit,
            "stacked": lines.stacked,
            "times": self.times,
            "series": series.collect::<Vec<_>>(),
        })
    }
}

/// The lines of a chart of a picture.
fn lines(chart: &Chart) -> ChartLines<'_> {
    let line = |series: &Series| series.pieces.iter().flatten().map(|p| p[1]).collect::<Vec<f64>>();
    let of_series = chart.series.iter();
    let mut all: Vec<_> = of_series.map(|s| (s.label.clone(), s.stroke.color, &s.stroke.dashes[..], line(s))).collect();
    // An area runs along its lower edge and back along its upper one: its height is the value.
    for area in &chart.areas {
        let edge: Vec<f64> = area.polygons.iter().flatten().map(|p| p[1]).collect();
        let n = edge.len() / 2;
        all.push((area.label.clone(), area.color, &[], (0..n).map(|i| edge[2 * n - 1 - i] - edge[i]).collect()));
    }
    ChartLines { name: chart.quantity.clone(), measure: chart.measure, stacked: !chart.areas.is_empty(), all }
}

/// The contact force on each side of a run with several.
fn forces(run: &DrawnRun) -> impl Iterator<Item = ChartLines<'_>> {
    let of_side = |side: String| {
        let line = |c: usize| {
            let values = run.history.get(&format!("{}@{side}", columns::CONTACT_FORCE.component(c)))?;
            Some((["x", "y", "z"][c].to_owned(), LINES[c], &[][..], values.clone()))
        };
        let lines: Vec<_> = (0..3).filter_map(line).collect();
        let name = format!("contact force on \"{side}\"");
        (!lines.is_empty()).then_some(ChartLines { name, measure: Measure::Force, stacked: false, all: lines })
    };
    let sides = run.problem.iter().flat_map(|problem| names(&problem.contacts));
    sides.filter_map(of_side)
}

/// The history of a run: the charts of its picture, and every column.
pub(super) fn write(run: &DrawnRun, units: Units, pack: &mut Pack) -> Value {
    let Some(times) = run.history.get(columns::TIME.name) else { return Value::Null };
    let rows = KeptRows::new(times, &mut run.history.values().map(Vec::as_slice), pack);
    let charts = history::chart_list(run, units);
    let forces = forces(run);
    let all = charts.iter().map(lines).chain(forces);
    let written: Vec<Value> = all.map(|lines| rows.write(&lines, units, pack)).collect();
    let measures = run.problem.as_ref().map(|problem| history_measures(problem)).unwrap_or_default();
    let column = |(name, measure): &(String, Measure)| {
        let values = run.history.get(name).filter(|_| name != columns::TIME.name && name != columns::STEP.name)?;
        let line = (String::new(), LINES[0], &[][..], values.clone());
        let lines = ChartLines { name: name.clone(), measure: *measure, stacked: false, all: vec![line] };
        Some(rows.write(&lines, units, pack))
    };
    let all: Vec<Value> = measures.iter().filter_map(column).collect();
    json!({ "charts": written, "columns": all, "rows": [rows.kept.len(), times.len()] })
}

/// The probes of a case, one chart each; null without probes.
pub(super) fn probes(dir: &Path, case: &Case, units: Units, pack: &mut Pack) -> Result<Value, PlotError> {
    let (probes, path) = (case.folder_options().probes, dir.join(PROBES));
    if probes.is_empty() {
        return Ok(Value::Null);
    }
    let table = CsvTable::read(&path)?;
    let times = table.numbers(columns::TIME.name)?;
    let dim = case.problem.mesh.dim;
    let mut all = Vec::new();
    for probe in &probes {
        let mut own = Vec::new();
        for (i, ending) in probe.quantity.columns(dim).iter().enumerate() {
            // Values unknown at a time are NaN.
            let values: Vec<f64> = table.column(&format!("{}{ending}", probe.name))?;
            let label = ending.trim_start_matches('_').to_owned();
            own.push((label, LINES[i % LINES.len()], &[][..], values));
        }
        let (name, measure) = (probe.name.clone(), probe.measure().unwrap_or(Measure::Number));
        all.push(ChartLines { name, measure, stacked: false, all: own });
    }
    let finite = all.iter().flat_map(|lines| &lines.all).map(|line| &line.3[..]);
    let rows = KeptRows::new(&times, &mut finite.filter(|v| axes::range(v.iter().copied()).is_some()), pack);
    let written: Vec<Value> = all.iter().map(|lines| rows.write(lines, units, pack)).collect();
    Ok(json!({ "charts": written, "rows": [rows.kept.len(), times.len()] }))
}
