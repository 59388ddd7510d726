//! Runs: a sink that keeps the requested data, and the thread that makes the steps.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use amontons::case;
use amontons::hypotheses;
use amontons::output::{
    self, Folder, FolderOptions, OutputError, ProbeSet, RunStart, Sink, Snapshot as Now, Summary, history_columns,
    history_values,
};
use amontons::problem::Problem;
use amontons::run::{RunError, Settings, run as drive, with_threads};
use pyo3::prelude::*;
use pyo3::types::PyBool;

use crate::attend::{Desk, attend};
use crate::case::Case;
use crate::errors;
use crate::laws::{Alarm, Law, with_laws};
use crate::snapshot::Snapshot;
use crate::view::{Keeper, array};

/// A table of numbers, row after row.
#[derive(Default)]
struct Table {
    columns: Vec<String>,
    values: Vec<f64>,
}

/// The results of a run.
#[pyclass(frozen, module = "amontons._amontons")]
pub struct Run {
    problem: Arc<Problem>,
    history: Table,
    probes: Table,
    snapshots: Vec<Py<Snapshot>>,
    summary: Option<String>,
    /// The exception of a run that ended early, which the Python layer raises.
    error: Mutex<Option<PyErr>>,
    notes: Vec<String>,
    points: Vec<f64>,
}

impl Keeper for Run {}

impl Run {
    fn table<'py>(slf: &Bound<'py, Self>, of: fn(&Run) -> &Table) -> PyResult<(Vec<String>, Bound<'py, PyAny>)> {
        let table = of(slf.get());
        let columns = table.columns.len();
        let rows = table.values.len().checked_div(columns).unwrap_or(0);
        Ok((table.columns.clone(), array(slf, |run| &of(run).values, [rows, columns])?))
    }

    pub fn problem(&self) -> &Arc<Problem> {
        &self.problem
    }

    /// The columns of the history with their values.
    pub fn history(&self) -> impl Iterator<Item = (&String, Vec<f64>)> {
        let (columns, values) = (&self.history.columns, &self.history.values);
        let column = |c: usize| values.iter().skip(c).step_by(columns.len()).copied().collect();
        columns.iter().enumerate().map(move |(c, name)| (name, column(c)))
    }
}

#[pymethods]
impl Run {
    /// Names of the columns of `history.csv`, and the rows as an array without a copy.
    #[getter]
    fn history_table<'py>(slf: &Bound<'py, Self>) -> PyResult<(Vec<String>, Bound<'py, PyAny>)> {
        Run::table(slf, |run| &run.history)
    }

    /// Names of the columns of `probes.csv`, and the rows as an array without a copy.
    #[getter]
    fn probes_table<'py>(slf: &Bound<'py, Self>) -> PyResult<(Vec<String>, Bound<'py, PyAny>)> {
        Run::table(slf, |run| &run.probes)
    }

    /// The kept states, by ascending time.
    #[getter]
    fn snapshots(&self, py: Python<'_>) -> Vec<Py<Snapshot>> {
        self.snapshots.iter().map(|snapshot| snapshot.clone_ref(py)).collect()
    }

    /// The text of `summary.json`, or `None` if the run ended before its first step.
    #[getter]
    fn summary_json(&self) -> Option<&str> {
        self.summary.as_deref()
    }

    /// Notes of the writer of the results folder.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// The exception that ended the run, or `None` if it reached its end or was stopped by the callback.
    fn take_error(&self, py: Python<'_>) -> Option<Py<PyAny>> {
        let error = self.error.lock().unwrap_or_else(PoisonError::into_inner).take()?;
        Some(error.into_value(py).into_any())
    }

    /// Coordinates of the nodes in m, three per node.
    #[getter]
    fn points<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let rows = slf.get().points.len() / 3;
        array(slf, |run| &run.points, [rows, 3])
    }

    /// The blocks of cells: name of the element, its VTK type, name of the region, and the nodes of each cell.
    fn blocks<'py>(slf: &Bound<'py, Self>) -> PyResult<Vec<(&'static str, u8, String, Bound<'py, PyAny>)>> {
        let mesh = &slf.get().problem.mesh;
        let block = |b: usize| {
            let block = &mesh.blocks[b];
            let (element, region) = (block.element, mesh.regions.get(block.region).cloned().unwrap_or_default());
            let nodes = array(slf, |run| &run.problem.mesh.blocks[b].nodes, [block.len(), element.nodes.len()])?;
            Ok((element.name, element.vtk(), region, nodes))
        };
        (0..mesh.blocks.len()).map(block).collect()
    }

    /// The nodes of each named side, ascending.
    fn sides(&self) -> Vec<(String, Vec<u32>)> {
        self.problem.mesh.facets.iter().map(|(name, set)| (name.clone(), set.node_list())).collect()
    }

    /// Dimension d.
    #[getter]
    fn dimension(&self) -> usize {
        self.problem.mesh.dim
    }
}

/// The callback after each step.
struct Call<'a> {
    callback: Option<&'a Py<PyAny>>,
    desk: &'a Desk,
    /// Set if the callback asks the run to stop.
    stopped: &'a Arc<AtomicBool>,
    /// Flag that ends the run.
    flag: &'a Arc<AtomicBool>,
}

impl Call<'_> {
    /// Calls the callback, if any, and waits for its answer.
    fn after(&self, snapshot: impl FnOnce() -> Snapshot) {
        let Some(callback) = self.callback else { return };
        let (callback, snapshot) = (Python::attach(|py| callback.clone_ref(py)), snapshot());
        let (stopped, flag) = (Arc::clone(self.stopped), Arc::clone(self.flag));
        self.desk.send(Box::new(move |py| {
            let answer = callback.call1(py, (snapshot,))?;
            if answer.bind(py).is_exact_instance_of::<PyBool>() && !answer.is_truthy(py)? {
                stopped.store(true, Ordering::Relaxed);
                flag.store(true, Ordering::Relaxed);
            }
            Ok(())
        }));
    }
}

/// Data kept of a run.
#[derive(Default)]
struct Kept {
    history: Vec<f64>,
    probed: Vec<f64>,
    snapshots: Vec<Snapshot>,
    summary: Option<Summary>,
}

/// Keeps the tables and the snapshots, and calls the callback.
struct Recorder<'a> {
    problem: &'a Arc<Problem>,
    every: usize,
    probes: ProbeSet,
    call: Call<'a>,
    kept: Kept,
}

impl Recorder<'_> {
    fn keep_if_due(&mut self, now: &Now) {
        if self.every > 0 && now.state.step.is_multiple_of(self.every) {
            self.kept.snapshots.push(Snapshot::new(self.problem, now));
        }
    }
}

impl Sink for Recorder<'_> {
    fn start(&mut self, start: &RunStart) -> Result<(), OutputError> {
        self.keep_if_due(&start.from);
        Ok(())
    }

    fn step(&mut self, now: &Now) -> Result<(), OutputError> {
        self.kept.history.extend(history_values(now).unwrap_or_default());
        self.kept.probed.extend([now.state.step as f64, now.state.t]);
        self.kept.probed.extend(self.probes.values(now));
        self.keep_if_due(now);
        self.call.after(|| Snapshot::new(self.problem, now));
        Ok(())
    }

    fn last(&mut self, last: &Now) -> Result<(), OutputError> {
        if self.kept.snapshots.last().is_none_or(|snapshot| snapshot.state.step != last.state.step) {
            self.kept.snapshots.push(Snapshot::new(self.problem, last));
        }
        Ok(())
    }

    fn finish(&mut self, summary: &Summary) -> Result<(), OutputError> {
        self.kept.summary = Some(summary.clone());
        Ok(())
    }
}

/// Request for a run from the Python layer.
#[derive(FromPyObject)]
pub struct Request {
    out: Option<PathBuf>,
    force: bool,
    threads: Option<usize>,
    certificate: Option<bool>,
    callback: Option<Py<PyAny>>,
    laws: Vec<Law>,
}

impl Request {
    /// The writer of the results folder, if requested.
    fn folder(&self, py: Python<'_>, case: &case::Case) -> PyResult<Option<Folder>> {
        let Some(out) = &self.out else { return Ok(None) };
        let options = FolderOptions { force: self.force, certificate: self.judges_all(case), ..case.folder_options() };
        Folder::create(out, options).map(Some).map_err(|error| errors::of_output(py, &error))
    }

    /// True if all hypotheses are evaluated: as requested, else if that takes at most about a tenth of the run.
    fn judges_all(&self, case: &case::Case) -> bool {
        self.certificate.unwrap_or_else(|| hypotheses::are_affordable(&case.problem))
    }

    fn settings(&self, case: &case::Case, alarm: &Alarm) -> Settings {
        Settings {
            // The run is made in a pool with the requested number of threads, so that its steps do not change the
            // thread.
            threads: None,
            interrupt: Some(Arc::clone(&alarm.flag)),
            certificate: self.judges_all(case),
            known: self.out.as_ref().and_then(|out| output::known_certificate(out, &case.fingerprint())),
            ..Settings::default()
        }
    }
}

/// Runs a case.
#[pyfunction]
pub fn run(py: Python<'_>, case: &Bound<'_, Case>, request: Request) -> PyResult<Run> {
    let (case, alarm) = (&case.get().read, Alarm::default());
    let problem = Arc::new(with_laws(py, &case.problem, &request.laws, &alarm)?);
    let probes = ProbeSet::new(&problem, &case.probes).map_err(|(i, error)| {
        let name = case.probes.get(i).map_or("", |probe| &probe.name);
        errors::request(py, &format!("probe {name}: found {error}"))
    })?;
    let probed = ["step", "t"].map(str::to_owned).into_iter().chain(probes.columns().iter().cloned()).collect();
    let (mut folder, settings) = (request.folder(py, case)?, request.settings(case, &alarm));
    let stopped = Arc::new(AtomicBool::new(false));
    let (made, raised) = attend(py, &alarm.flag, |desk| {
        with_threads(request.threads, || {
            let call = Call { callback: request.callback.as_ref(), desk, stopped: &stopped, flag: &alarm.flag };
            let mut recorder = Recorder { problem: &problem, every: case.every, probes, call, kept: Kept::default() };
            let mut sinks: Vec<&mut dyn Sink> = Vec::new();
            sinks.extend(folder.as_mut().map(|folder| folder as &mut dyn Sink));
            sinks.push(&mut recorder);
            let result = drive(&problem, &settings, &mut sinks);
            (result, recorder.kept)
        })
    })?;
    let (result, kept) = made.unwrap_or_else(|error| (Err(error), Kept::default()));
    let raised = raised.or_else(|| alarm.take());
    let error = ending(py, result.err(), raised, stopped.load(Ordering::Relaxed));
    let summary = kept.summary.map(|summary| serde_json::to_string(&summary)).transpose();
    Ok(Run {
        history: Table { columns: history_columns(&problem), values: kept.history },
        probes: Table { columns: probed, values: if case.probes.is_empty() { Vec::new() } else { kept.probed } },
        snapshots: kept.snapshots.into_iter().map(|snapshot| Py::new(py, snapshot)).collect::<PyResult<_>>()?,
        summary: summary.map_err(|error| errors::wrong(&error))?,
        error: Mutex::new(error),
        notes: folder.map_or_else(Vec::new, |folder| folder.notes().to_vec()),
        points: problem.mesh.points.as_flattened().to_vec(),
        problem,
    })
}

/// The exception of a run: an exception of Python comes first, and a run stopped by the callback has none.
fn ending(py: Python<'_>, error: Option<RunError>, raised: Option<PyErr>, stopped: bool) -> Option<PyErr> {
    match (raised, error) {
        (Some(raised), _) => Some(raised),
        (None, Some(RunError::Interrupted(_))) if stopped => None,
        (None, error) => error.map(|error| errors::of_run(py, &error)),
    }
}
