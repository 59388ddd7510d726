//! Runs that are made step by step.

use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, PoisonError};

use amontons::equation::{Along, StepInputs};
use amontons::output::Checkpoint;
use amontons::problem::Problem;
use amontons::run::{Settings, Stepping as Steps, SteppingError};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::attend::attend;
use crate::case::Case;
use crate::errors;
use crate::laws::{Alarm, Law, with_laws};
use crate::snapshot::Snapshot;

/// A run whose steps are made one by one.
#[pyclass(frozen, module = "amontons._amontons")]
pub struct Stepping {
    problem: Arc<Problem>,
    /// `None` after it was closed.
    run: Mutex<Option<Steps>>,
    alarm: Alarm,
}

/// A saved state of a run.
#[pyclass(frozen, module = "amontons._amontons")]
pub struct Saved(Checkpoint);

#[pymethods]
impl Saved {
    /// Number of the step, n.
    #[getter]
    fn step(&self) -> usize {
        self.0.state.step
    }

    /// Time t_n in s.
    #[getter]
    fn t(&self) -> f64 {
        self.0.state.t
    }
}

impl Stepping {
    /// Does something with the run. The lock of the interpreter is not held meanwhile: another thread of Python may be
    /// making a step, which calls laws.
    fn with<T: Send>(&self, py: Python<'_>, act: impl FnOnce(&mut Steps) -> T + Send) -> PyResult<T> {
        let done = py.detach(|| {
            let mut run = self.run.lock().unwrap_or_else(PoisonError::into_inner);
            run.as_mut().map(act)
        });
        done.ok_or_else(|| errors::request(py, CLOSED))
    }

    /// The same with something that can fail.
    fn tried<T: Send>(
        &self,
        py: Python<'_>,
        act: impl FnOnce(&mut Steps) -> Result<T, SteppingError> + Send,
    ) -> PyResult<T> {
        self.with(py, act)?.map_err(|error| errors::of_stepping(py, &error))
    }
}

const CLOSED: &str = "found a run that is closed, expected one that goes on; make another with Case.stepping()";

/// The numbers of an array.
fn numbers(values: &PyReadonlyArray1<f64>) -> Vec<f64> {
    values.as_array().iter().copied().collect()
}

#[pymethods]
impl Stepping {
    #[new]
    fn new(py: Python<'_>, case: &Bound<'_, Case>, laws: Vec<Law>, threads: Option<usize>) -> PyResult<Stepping> {
        let alarm = Alarm::default();
        let problem = Arc::new(with_laws(py, &case.get().read.problem, &laws, &alarm)?);
        let settings = Settings { threads, interrupt: Some(Arc::clone(&alarm.flag)), ..Settings::default() };
        let (made, raised) = attend(py, &alarm.flag, |_| Steps::new(&problem, &settings))?;
        if let Some(raised) = raised.or_else(|| alarm.take()) {
            return Err(raised);
        }
        let run = made.map_err(|error| errors::of_run(py, &error))?;
        Ok(Stepping { problem, run: Mutex::new(Some(run)), alarm })
    }

    /// Makes the next step.
    fn make_step(&self, py: Python<'_>) -> PyResult<()> {
        self.alarm.flag.store(false, Ordering::Relaxed);
        let work = |_: &_| {
            let mut run = self.run.lock().unwrap_or_else(PoisonError::into_inner);
            run.as_mut().map(|run| run.step().map(|_| ()))
        };
        let (made, raised) = attend(py, &self.alarm.flag, work)?;
        if let Some(raised) = raised.or_else(|| self.alarm.take()) {
            return Err(raised);
        }
        made.ok_or_else(|| errors::request(py, CLOSED))?.map_err(|error| errors::of_stepping(py, &error))
    }

    /// The run at its state.
    fn state(&self, py: Python<'_>) -> PyResult<Snapshot> {
        self.with(py, |run| Snapshot::new(&self.problem, &run.snapshot()))
    }

    /// Number of steps made.
    fn made(&self, py: Python<'_>) -> PyResult<usize> {
        self.with(py, |run| run.state().step)
    }

    fn is_done(&self, py: Python<'_>) -> PyResult<bool> {
        self.with(py, |run| run.is_done())
    }

    /// The time of the state, s.
    fn time(&self, py: Python<'_>) -> PyResult<f64> {
        self.with(py, |run| run.state().t)
    }

    /// The end of the next step, s, if there is one and it is known before the step is made.
    fn next_time(&self, py: Python<'_>) -> PyResult<Option<f64>> {
        self.with(py, |run| {
            let (timeline, state) = (&run.problem().timeline, run.state());
            let next = timeline.next(state.step, &state.pace, state.pace.level);
            (!run.is_done() && timeline.accuracy(next.phase).is_none()).then_some(next.t)
        })
    }

    fn save(&self, py: Python<'_>) -> PyResult<Saved> {
        self.with(py, |run| run.save()).map(Saved)
    }

    fn restore(&self, py: Python<'_>, saved: &Bound<'_, Saved>) -> PyResult<()> {
        let saved = &saved.get().0;
        self.tried(py, |run| run.restore(saved))
    }

    fn close(&self, py: Python<'_>) {
        py.detach(|| self.run.lock().unwrap_or_else(PoisonError::into_inner).take());
    }

    /// Coordinates of the nodes in m, three per node.
    fn points<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.problem.mesh.points.as_flattened())
    }

    /// Dimension d.
    fn dimension(&self) -> usize {
        self.problem.mesh.dim
    }

    /// The nodes of each named side, ascending.
    fn sides(&self) -> Vec<(String, Vec<u32>)> {
        self.problem.mesh.facets.iter().map(|(name, set)| (name.clone(), set.node_list())).collect()
    }

    /// Forces, or heat, that prescribed values supply at the nodes of a side, one vector or number per node.
    fn reactions<'py>(&self, py: Python<'py>, on: &str, of_heat: bool) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let all = self.tried(py, |run| if of_heat { run.heat_reactions(on) } else { run.reactions(on) })?;
        Ok(PyArray1::from_vec(py, all))
    }

    /// Sets the force on a side, or at all nodes.
    fn set_force(&self, py: Python<'_>, on: Option<&str>, values: PyReadonlyArray1<f64>) -> PyResult<()> {
        let values = numbers(&values);
        self.tried(py, |run| match on {
            Some(on) => run.set_force(on, &values),
            None => run.set_forces(&values),
        })
    }

    /// Sets the heat supplied on a side, or at all nodes.
    fn set_heat(&self, py: Python<'_>, on: Option<&str>, values: PyReadonlyArray1<f64>) -> PyResult<()> {
        let values = numbers(&values);
        self.tried(py, |run| match on {
            Some(on) => run.set_heat(on, &values),
            None => run.set_heats(&values),
        })
    }

    /// Sets a component of the displacement, or the one along the normal, on a side.
    fn set_displacement(
        &self,
        py: Python<'_>,
        on: &str,
        component: Option<usize>,
        values: PyReadonlyArray1<f64>,
    ) -> PyResult<()> {
        let values = numbers(&values);
        self.tried(py, |run| run.set_displacement(on, component.map_or(Along::Normal, Along::Axis), &values))
    }

    fn set_temperature(&self, py: Python<'_>, on: &str, values: PyReadonlyArray1<f64>) -> PyResult<()> {
        let values = numbers(&values);
        self.tried(py, |run| run.set_temperature(on, &values))
    }

    fn set_foundation_temperature(&self, py: Python<'_>, contact: &str, value: f64) -> PyResult<()> {
        self.tried(py, |run| run.set_foundation_temperature(contact, value))
    }

    /// Removes all inputs.
    fn clear(&self, py: Python<'_>) -> PyResult<()> {
        self.tried(py, |run| run.set_inputs(&StepInputs::default()))
    }
}
