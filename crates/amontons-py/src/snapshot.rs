//! A run at one time.

use std::sync::{Arc, OnceLock};

use amontons::material::VTK_COMPONENTS;
use amontons::output::{self, ContactValues, PointValues, contact_columns, history_columns, history_values};
use amontons::problem::Problem;
use amontons::state::State;
use amontons::tensor::Sym;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::view::{Keeper, array};

/// A run at one time: its fields and its contact points.
#[pyclass(frozen, module = "amontons._amontons")]
pub struct Snapshot {
    pub problem: Arc<Problem>,
    pub state: State,
    /// Columns of `contact.csv`; empty at t = 0.
    pub contact: Vec<(String, ContactValues)>,
    /// The row of the step in `history.csv`; empty at t = 0.
    history: Vec<f64>,
    cells: OnceLock<Cells>,
}

impl Keeper for Snapshot {}

/// Values of the cells at their centres.
pub struct Cells {
    stress: Vec<f64>,
    strain: Vec<f64>,
    heat_flux: Vec<f64>,
    von_mises: Vec<f64>,
}

impl Cells {
    fn new(problem: &Problem, state: &State) -> Cells {
        let values = output::cell_values(problem, state);
        let tensors = |of: fn(&PointValues) -> &Sym| -> Vec<f64> {
            values.iter().flat_map(|v| VTK_COMPONENTS.map(|(i, j)| of(v).get(i, j))).collect()
        };
        Cells {
            stress: tensors(|v| &v.stress),
            strain: tensors(|v| &v.strain),
            heat_flux: values.iter().flat_map(|v| v.heat_flux).collect(),
            von_mises: values.iter().map(|v| v.stress.von_mises()).collect(),
        }
    }
}

impl Snapshot {
    pub fn new(problem: &Arc<Problem>, now: &output::Snapshot) -> Snapshot {
        Snapshot {
            problem: Arc::clone(problem),
            state: now.state.clone(),
            contact: contact_columns(now),
            history: history_values(now).unwrap_or_default(),
            cells: OnceLock::new(),
        }
    }

    /// The values of the cells, computed on first use.
    pub fn cells(&self, py: Python<'_>) -> &Cells {
        py.detach(|| self.cells.get_or_init(|| Cells::new(&self.problem, &self.state)))
    }
}

#[pymethods]
impl Snapshot {
    /// Number of the step, n.
    #[getter]
    fn step(&self) -> usize {
        self.state.step
    }

    /// Time t_n in s.
    #[getter]
    fn t(&self) -> f64 {
        self.state.t
    }

    /// Names of the fields of the case.
    #[getter]
    fn field_names(&self) -> Vec<&'static str> {
        let physics = self.problem.physics;
        let of_mechanics = ["displacement", "velocity", "stress", "strain", "von_mises"];
        let mechanics = of_mechanics.into_iter().filter(|_| physics.has_mechanics());
        let temperature = physics.has_temperature().then_some("temperature");
        mechanics.chain(temperature).chain(physics.has_heat().then_some("heat_flux")).collect()
    }

    /// A field as an array without a copy: of the nodes or of the cells.
    fn field<'py>(slf: &Bound<'py, Self>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let (py, this) = (slf.py(), slf.get());
        if !this.field_names().contains(&name) {
            return Err(pyo3::exceptions::PyKeyError::new_err(name.to_owned()));
        }
        let (nodes, dim) = (this.problem.mesh.points.len(), this.problem.mesh.dim);
        let cells = this.problem.mesh.cell_count();
        match name {
            "displacement" => array(slf, |s| &s.state.u, [nodes, dim]),
            "velocity" => array(slf, |s| &s.state.w, [nodes, dim]),
            "temperature" => array(slf, |s| &s.state.theta, [nodes]),
            "stress" => array(slf, |s| &s.cells(py).stress, [cells, 6]),
            "strain" => array(slf, |s| &s.cells(py).strain, [cells, 6]),
            "heat_flux" => array(slf, |s| &s.cells(py).heat_flux, [cells, 3]),
            _ => array(slf, |s| &s.cells(py).von_mises, [cells]),
        }
    }

    /// The columns of `contact.csv`: arrays of numbers and lists of strings.
    fn contact_columns<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        let columns = PyDict::new(slf.py());
        for (number, (name, values)) in slf.get().contact.iter().enumerate() {
            match values {
                ContactValues::Numbers(values) => {
                    columns.set_item(name, array(slf, |s| s.numbers(number), [values.len()])?)?;
                }
                ContactValues::Words(words) => columns.set_item(name, PyList::new(slf.py(), words)?)?,
            }
        }
        Ok(columns)
    }

    /// The row of the step in `history.csv`, by column; empty at t = 0.
    fn history_row<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let row = PyDict::new(py);
        for (name, value) in history_columns(&self.problem).iter().zip(&self.history) {
            row.set_item(name, value)?;
        }
        Ok(row)
    }
}

impl Snapshot {
    /// The numbers of a column of `contact.csv`.
    pub fn numbers(&self, column: usize) -> &[f64] {
        match self.contact.get(column) {
            Some((_, ContactValues::Numbers(values))) => values,
            _ => &[],
        }
    }
}
