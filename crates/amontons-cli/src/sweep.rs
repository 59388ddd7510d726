//! `run --each`: a run for each combination of values, with one table and one picture.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use amontons::case::{self, Case};
use amontons::output::{
    self, Checkpoint, Folder, FolderLock, FolderOptions, Outcome, OutputError, ResultTable as Kept, RunStart, Shown,
    Sink, Snapshot, Summary,
};
use amontons::plot::{self, SweepPlot, SweepSeries};
use amontons::run::{self, RunError, Settings};
use amontons::units::{Measure, Units};
use serde_json::Value;

use crate::after::After;
use crate::arguments::{CertificateChoice, Common, OutputFormat};
use crate::print;
use crate::progress::Progress;
use crate::status::CommandFailure;
use crate::variants::{Variant, variants};

/// Request for a sweep.
pub struct Request<'a> {
    /// Arguments `KEY=VALUE,VALUE,…`.
    pub each: &'a [String],
    /// Number of simultaneous runs.
    pub jobs: usize,
    pub after: After,
    pub certificate: CertificateChoice,
}

/// A run of the sweep.
struct SweepRun {
    variant: Variant,
    case: Case,
    folder: PathBuf,
}

/// Data common to the runs.
struct ParameterSweep<'a> {
    request: &'a Request<'a>,
    common: &'a Common,
    progress: &'a Progress,
    flag: Arc<AtomicBool>,
    /// Number of steps made by all runs.
    made: AtomicUsize,
    threads: usize,
}

/// Makes the runs of all combinations. Results of an earlier sweep are reused, and its unfinished runs are continued.
pub fn execute(file: &Path, request: &Request, common: &Common) -> Result<(), CommandFailure> {
    let source = common.source(file)?;
    let first = case::parse(&source, &common.set)?;
    if first.accuracy.as_ref().is_some_and(|asked| !asked.refined) && !common.quiet {
        print::note("the runs of a sweep have the cells and steps of the case: [accuracy] is for single runs");
    }
    let name = first.problem.name.clone();
    let out = common.out.clone().unwrap_or_else(|| PathBuf::from("results").join(format!("{name}-sweep")));
    // Faults of all cases are reported before the first run begins.
    let parts = variants(request.each)?.into_iter().map(|variant| {
        let overrides: Vec<String> = common.set.iter().cloned().chain(variant.overrides()).collect();
        let case = case::parse(&source, &overrides)?;
        Ok(SweepRun { folder: out.join(&variant.folder), variant, case })
    });
    let parts = parts.collect::<Result<Vec<SweepRun>, CommandFailure>>()?;
    fs::create_dir_all(&out).map_err(|source| OutputError::Io { doing: "create", path: out.clone(), source })?;
    // Two sweeps would mistake the runs of each other for failed ones.
    let _lock = FolderLock::take(&out)?;
    let progress = Progress::new(common);
    progress.part(&format!("{} runs", parts.len()), parts.iter().map(|part| part.case.problem.timeline.steps()).sum());
    progress.begin_steps();
    let jobs = request.jobs.clamp(1, parts.len().max(1));
    let sweep = ParameterSweep {
        request,
        common,
        progress: &progress,
        flag: progress.interrupt_flag(),
        made: AtomicUsize::new(0),
        threads: (rayon::current_num_threads() / jobs).max(1),
    };
    let results = sweep.all(&parts, jobs);
    drop(progress);
    let rows: Vec<SweepRow> = parts.iter().zip(&results).map(|(part, result)| SweepRow::new(part, result)).collect();
    let table = SweepTable::new(&rows, parts.first().map(|part| &part.case));
    table.write(&out)?;
    picture(&name, &rows, &table, &out)?;
    if common.format == OutputFormat::Json {
        print::json(&table.json(&out))?;
    } else if !common.quiet {
        print::text(&table.text(&name, &out))?;
    }
    results.into_iter().find_map(Result::err).map_or(Ok(()), Err)
}

impl ParameterSweep<'_> {
    /// The results of all parts, `jobs` at a time; each run has a share of the threads.
    fn all(&self, parts: &[SweepRun], jobs: usize) -> Vec<Result<Summary, CommandFailure>> {
        let next = AtomicUsize::new(0);
        let results: Mutex<BTreeMap<usize, Result<Summary, CommandFailure>>> = Mutex::default();
        let work = || {
            while let Some((number, part)) = {
                let number = next.fetch_add(1, Ordering::Relaxed);
                parts.get(number).map(|part| (number, part))
            } {
                let result = self.one(part);
                results.lock().unwrap_or_else(PoisonError::into_inner).insert(number, result);
            }
        };
        std::thread::scope(|scope| {
            for _ in 1..jobs {
                scope.spawn(work);
            }
            work();
        });
        results.into_inner().unwrap_or_else(PoisonError::into_inner).into_values().collect()
    }

    /// Makes a run in its own folder: skipped if it is done, continued from its checkpoint if it has one, otherwise
    /// started.
    fn one(&self, part: &SweepRun) -> Result<Summary, CommandFailure> {
        let SweepRun { case, folder, .. } = part;
        if let Some(summary) = output::finished_run(folder, &case.fingerprint()).filter(|_| !self.common.force) {
            self.made.fetch_add(case.problem.timeline.steps(), Ordering::Relaxed);
            return Ok(summary);
        }
        let certificate = self.request.certificate.of(case);
        let settings = Settings {
            threads: Some(self.threads),
            interrupt: Some(Arc::clone(&self.flag)),
            certificate,
            known: output::known_certificate(folder, &case.fingerprint()),
            ..Settings::default()
        };
        let options = FolderOptions { force: self.common.force, certificate, ..case.folder_options() };
        let mut count = Count(self);
        let checkpoint = match Checkpoint::read(folder, &case.identity()) {
            Ok(checkpoint) if !self.common.force => checkpoint,
            // Results of another case are refused when the folder is made.
            _ => None,
        };
        let result = if let Some(checkpoint) = checkpoint {
            let mut results = Folder::reopen(folder, options)?;
            run::resume(&case.problem, checkpoint, &settings, &mut [&mut results, &mut count])
        } else {
            let mut results = Folder::create(folder, options)?;
            run::run(&case.problem, &settings, &mut [&mut results, &mut count])
        };
        let result = result.map_err(|error| {
            let again = "the same command goes on where it stopped";
            let hint = match &error {
                RunError::Interrupted(_) | RunError::Unstarted { .. } => again.to_owned(),
                _ => format!("{}: results up to the step before are in {}", part.variant.folder, folder.display()),
            };
            CommandFailure::Run { error, hint: Some(hint) }
        })?;
        self.request.after.make(folder, true)?;
        Ok(result)
    }
}

/// Counts the steps of all runs.
struct Count<'a, 'b>(&'a ParameterSweep<'b>);

impl Sink for Count<'_, '_> {
    fn start(&mut self, start: &RunStart) -> Result<(), OutputError> {
        self.0.made.fetch_add(start.from.state.step, Ordering::Relaxed);
        Ok(())
    }

    fn step(&mut self, _now: &Snapshot) -> Result<(), OutputError> {
        self.0.progress.done(self.0.made.fetch_add(1, Ordering::Relaxed) + 1);
        Ok(())
    }
}

/// A row of the table.
struct SweepRow {
    folder: String,
    values: Vec<(String, String)>,
    outcome: String,
    /// Figures of the last good step by their path in `summary.json`; empty without one.
    figures: BTreeMap<String, f64>,
    summary: Option<Summary>,
}

impl SweepRow {
    fn new(part: &SweepRun, result: &Result<Summary, CommandFailure>) -> SweepRow {
        let summary = match result {
            Ok(summary) => Some(summary),
            Err(CommandFailure::Run {
                error: RunError::Step { summary, .. } | RunError::Unsound(summary) | RunError::Interrupted(summary),
                ..
            }) => Some(&**summary),
            Err(_) => None,
        };
        let mut figures = BTreeMap::new();
        if let Some(summary) = summary {
            figures.insert("steps".to_owned(), summary.steps as f64);
            figures.insert("seconds".to_owned(), summary.seconds.total);
            let value = serde_json::to_value(summary).unwrap_or_default();
            flatten("final", &value["final"], &mut figures);
            flatten("energy", &value["energy"], &mut figures);
        }
        for (name, value) in probes(&part.folder) {
            figures.insert(format!("probes.{name}"), value);
        }
        let outcome = match (summary, result) {
            (Some(summary), _) => word(summary.outcome).to_owned(),
            (None, Err(failure)) => format!("failed: {}", failure.message()),
            (None, Ok(_)) => String::new(),
        };
        SweepRow {
            folder: part.variant.folder.clone(),
            values: part.variant.values.clone(),
            outcome,
            figures,
            summary: summary.cloned(),
        }
    }
}

fn word(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Done => "done",
        Outcome::NotConverged => "not converged",
        Outcome::Interrupted => "interrupted",
        Outcome::Unsound => "unsound",
    }
}

/// The numbers of a value by their paths.
fn flatten(path: &str, value: &Value, into: &mut BTreeMap<String, f64>) {
    match value {
        Value::Number(number) => {
            into.extend(number.as_f64().map(|number| (path.to_owned(), number)));
        }
        Value::Array(entries) => {
            entries.iter().enumerate().for_each(|(i, entry)| flatten(&format!("{path}.{i}"), entry, into));
        }
        Value::Object(entries) => {
            entries.iter().for_each(|(key, entry)| flatten(&format!("{path}.{key}"), entry, into));
        }
        _ => {}
    }
}

/// The last row of `probes.csv`, if any.
fn probes(folder: &Path) -> Vec<(String, f64)> {
    let path = folder.join("probes.csv");
    let text = if path.is_file() { fs::read_to_string(path).unwrap_or_default() } else { String::new() };
    let (Some(head), Some(last)) = (text.lines().next(), text.lines().last()) else { return Vec::new() };
    let cells = head.split(',').zip(last.split(',')).filter(|(name, _)| !matches!(*name, "step" | "t"));
    cells.filter_map(|(name, value)| Some((name.to_owned(), value.parse().ok()?))).collect()
}

/// The table of a sweep.
struct SweepTable<'a> {
    rows: &'a [SweepRow],
    /// Names of the figures that at least one run has.
    figures: Vec<String>,
    /// The measured quantities of figures with a unit, and the units of the case.
    measures: BTreeMap<String, Measure>,
    units: Units,
}

impl<'a> SweepTable<'a> {
    fn new(rows: &'a [SweepRow], case: Option<&Case>) -> SweepTable<'a> {
        let mut figures: Vec<String> = rows.iter().flat_map(|row| row.figures.keys().cloned()).collect();
        figures.sort();
        figures.dedup();
        let units = case.map_or_else(Units::default, |case| case.problem.units());
        SweepTable { rows, figures, measures: case.map(measures).unwrap_or_default(), units }
    }

    /// A figure with its unit.
    fn cell(&self, figure: &str, value: f64) -> String {
        self.units.write(value, self.measures.get(figure).copied().unwrap_or(Measure::Number))
    }

    /// The figures that are shown and drawn, with their titles: the most common ones and the probes, if they differ
    /// between runs.
    fn shown(&self) -> Vec<(String, String)> {
        let most = SHOWN.iter().map(|(figure, title)| ((*figure).to_owned(), (*title).to_owned()));
        let probes = self.figures.iter().filter_map(|figure| {
            let name = figure.strip_prefix("probes.")?;
            Some((figure.clone(), name.to_owned()))
        });
        most.chain(probes).filter(|(figure, _)| self.varies(figure)).collect()
    }

    fn keys(&self) -> impl Iterator<Item = &str> {
        self.rows.first().into_iter().flat_map(|row| row.values.iter().map(|(key, _)| key.as_str()))
    }

    /// Writes `sweep.csv`.
    fn write(&self, out: &Path) -> Result<(), CommandFailure> {
        let quote = |text: &str| {
            if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
        };
        let mut text =
            ["folder"].into_iter().chain(self.keys()).chain(["outcome"]).map(quote).collect::<Vec<_>>().join(",");
        for name in &self.figures {
            text += &format!(",{name}");
        }
        for row in self.rows {
            text += &format!("\n{}", quote(&row.folder));
            for value in row.values.iter().map(|(_, value)| value.as_str()).chain([row.outcome.as_str()]) {
                text += &format!(",{}", quote(value));
            }
            for name in &self.figures {
                text += &row.figures.get(name).map_or_else(|| ",".to_owned(), |value| format!(",{value:?}"));
            }
        }
        text.push('\n');
        let path = out.join("sweep.csv");
        let failed = |source| OutputError::Io { doing: "write", path: path.clone(), source };
        fs::create_dir_all(out).map_err(failed)?;
        // The file is complete or absent.
        let newer = out.join("sweep.csv.new");
        fs::write(&newer, text).and_then(|()| fs::rename(&newer, &path)).map_err(failed)?;
        Ok(())
    }

    fn json(&self, out: &Path) -> Value {
        let runs = self.rows.iter().map(|row| {
            let set: Vec<String> = row.values.iter().map(|(key, value)| format!("{key}={value}")).collect();
            serde_json::json!({ "set": set, "folder": out.join(&row.folder), "outcome": row.outcome, "summary": row.summary })
        });
        serde_json::json!({ "runs": runs.collect::<Vec<Value>>() })
    }

    /// The table as text.
    fn text(&self, name: &str, out: &Path) -> String {
        let shown = self.shown();
        let mut cells: Vec<Vec<String>> = vec![
            self.keys()
                .map(str::to_owned)
                .chain(["outcome".to_owned()])
                .chain(shown.iter().map(|(_, title)| title.clone()))
                .collect(),
        ];
        for row in self.rows {
            let figure = |name: &str| row.figures.get(name).map_or_else(String::new, |value| self.cell(name, *value));
            let values = row.values.iter().map(|(_, value)| value.clone()).chain([row.outcome.clone()]);
            cells.push(values.chain(shown.iter().map(|(name, _)| figure(name))).collect());
        }
        let columns = cells.first().map_or(0, Vec::len);
        let width = |c: usize| cells.iter().filter_map(|row| row.get(c)).map(|cell| cell.chars().count()).max();
        let widths: Vec<usize> = (0..columns).map(|c| width(c).unwrap_or(0)).collect();
        let lines = cells.iter().map(|row| {
            let padded = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:>width$}"));
            format!("  {}\n", padded.collect::<Vec<_>>().join("  "))
        });
        format!(
            "{name}: {} runs\n{}  table            {}\n",
            self.rows.len(),
            lines.collect::<String>(),
            out.join("sweep.csv").display()
        )
    }

    /// True if a figure exists and differs between runs.
    fn varies(&self, figure: &str) -> bool {
        let mut values = self.rows.iter().filter_map(|row| row.figures.get(figure));
        values.next().is_some_and(|first| values.any(|value| value.to_bits() != first.to_bits()))
    }
}

/// The quantities measured by the figures of a case, by their names in `sweep.csv`.
fn measures(case: &Case) -> BTreeMap<String, Measure> {
    let key = |value: &Shown| match value.table {
        Kept::Summary => Some(value.name.clone()),
        Kept::History => Some(format!("energy.{}", value.name)),
        _ => None,
    };
    let known = output::shown().into_iter().filter_map(|value| Some((key(&value)?, value.measure?)));
    let probes = case.probes.iter().filter_map(|probe| Some((probe, probe.measure()?)));
    let of_probes = probes.flat_map(|(probe, measure)| {
        let endings = probe.quantity.columns(case.problem.mesh.dim);
        endings.into_iter().map(move |ending| (format!("probes.{}{ending}", probe.name), measure))
    });
    known.chain(of_probes).collect()
}

/// Figures that are shown and drawn if they differ between runs, with their titles.
const SHOWN: [(&str, &str); 8] = [
    ("final.contact.pressure_max", "largest pressure"),
    ("final.contact.area", "area of contact"),
    ("final.contact.heat_flow", "heat flow"),
    ("final.contact.wear_max", "wear depth"),
    ("final.temperature_max", "largest temperature"),
    ("final.von_mises_max", "von Mises stress"),
    ("final.norms.displacement_l2", "norm of displacement"),
    ("energy.friction_dissipation", "friction work"),
];

/// Draws the figures over the first key with numeric values; without such a key there is no picture.
fn picture(name: &str, rows: &[SweepRow], table: &SweepTable, out: &Path) -> Result<(), CommandFailure> {
    let number = |row: &SweepRow, key: usize| row.values.get(key).and_then(|(_, value)| value.parse::<f64>().ok());
    let keys = table.keys().count();
    let Some(key) = (0..keys).find(|&key| rows.iter().all(|row| number(row, key).is_some())) else { return Ok(()) };
    let mut series: Vec<SweepSeries> = Vec::new();
    for (figure, title) in &table.shown() {
        let mut lines: BTreeMap<String, Vec<[f64; 2]>> = BTreeMap::new();
        for row in rows {
            let others = row.values.iter().enumerate().filter(|(k, _)| *k != key);
            let label: Vec<String> = others
                .map(|(_, (key, value))| format!("{} = {value}", key.rsplit('.').next().unwrap_or(key)))
                .collect();
            let point = number(row, key).zip(row.figures.get(figure).copied());
            let line = lines.entry(label.join(", ")).or_default();
            line.extend(point.filter(|(_, y)| y.is_finite()).map(|(x, y)| [x, y]));
        }
        let unit = table.measures.get(figure).map_or("", |measure| table.units.of(*measure));
        let quantity = if unit.is_empty() { title.clone() } else { format!("{title} in {unit}") };
        series.push(SweepSeries { quantity, lines: lines.into_iter().collect() });
    }
    if series.is_empty() {
        return Ok(());
    }
    let x_label = table.keys().nth(key).unwrap_or_default().to_owned();
    let drawn = plot::sweep(&SweepPlot { title: format!("{name}: {} runs", rows.len()), x_label, series })?;
    drawn.save(&out.join("sweep"), plot::Options::default().pixels)?;
    Ok(())
}
