//! Laws written in Python.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use amontons::arrays::{ArrayFunction, Arrays, INPUTS, Inputs};
use amontons::contact::{
    ArrayFriction, ArrayHeat, ArrayNormal, ArrayWear, Contact, FrictionLaw, HeatLaw, NormalLaw, WearLaw, names,
};
use amontons::contract;
use amontons::field;
use amontons::material::{ArrayTensor, OperatorConstants, TensorLaw};
use amontons::problem::{Problem, ProblemData};
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::errors;

/// Ends a run whose law has raised an exception.
#[derive(Clone, Debug, Default)]
pub struct Alarm {
    pub flag: Arc<AtomicBool>,
    raised: Arc<Mutex<Option<PyErr>>>,
}

impl Alarm {
    fn raise(&self, error: PyErr) {
        self.raised.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
        self.flag.store(true, Ordering::Relaxed);
    }

    fn is_raised(&self) -> bool {
        self.raised.lock().unwrap_or_else(PoisonError::into_inner).is_some()
    }

    /// The exception of a law, if there was one.
    pub fn take(&self) -> Option<PyErr> {
        self.raised.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// A function of Python: it takes the arguments of all rows as one array and returns their values as one.
struct Function {
    /// Name of the law.
    name: String,
    callable: Py<PyAny>,
    alarm: Alarm,
}

impl fmt::Debug for Function {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}

impl Function {
    /// The message for a value that is infinite or NaN: the law, the value and the arguments that gave it.
    fn not_a_number(&self, rows: &[Inputs], values: &[f64], at: usize) -> String {
        let row = at / (values.len() / rows.len().max(1)).max(1);
        let arguments = rows.get(row).map_or_else(String::new, |row| format!(" for the arguments {row:?}"));
        format!("the law {} gave {}{arguments}, expected finite numbers", self.name, values[at])
    }

    fn call(&self, rows: &[Inputs], out: &mut [f64]) -> PyResult<()> {
        Python::attach(|py| {
            let inputs = PyArray1::from_slice(py, rows.as_flattened()).reshape([rows.len(), INPUTS])?;
            let values: PyReadonlyArray1<f64> = self.callable.bind(py).call1((inputs,))?.extract()?;
            let values = values.as_slice()?;
            if values.len() != out.len() {
                return Err(errors::wrong(&format!("a law has {} values, expected {}", values.len(), out.len())));
            }
            if let Some(at) = values.iter().position(|value| !value.is_finite()) {
                return Err(errors::wrong(&self.not_a_number(rows, values, at)));
            }
            out.copy_from_slice(values);
            Ok(())
        })
    }
}

impl ArrayFunction for Function {
    fn evaluate(&self, rows: &[Inputs], out: &mut [f64]) {
        out.fill(f64::NAN);
        if self.alarm.is_raised() {
            return;
        }
        if let Err(error) = self.call(rows, out) {
            self.alarm.raise(error);
        }
    }
}

/// A law as described by the Python layer: its kind, its functions and its constants.
#[derive(FromPyObject)]
pub struct Law {
    name: String,
    kind: String,
    /// The contact side or the region, or `None` for all of them.
    place: Option<String>,
    functions: Vec<Py<PyAny>>,
    constants: Vec<Option<f64>>,
}

impl Law {
    fn arrays(&self, number: usize, outputs: usize, alarm: &Alarm) -> Option<Arrays> {
        let function = Python::attach(|py| self.functions.get(number).map(|function| function.clone_ref(py)))?;
        Some(Arrays::new(
            Arc::new(Function { name: self.name.clone(), callable: function, alarm: alarm.clone() }),
            outputs,
        ))
    }

    fn constant(&self, number: usize) -> Option<f64> {
        self.constants.get(number).copied().flatten()
    }

    fn normal(&self, alarm: &Alarm) -> Option<field::Law<dyn NormalLaw>> {
        Some(
            ArrayNormal {
                pressure: self.arrays(0, 3, alarm)?,
                potential: self.arrays(1, 1, alarm)?,
                lipschitz: self.constant(0),
                lipschitz_in_rate: self.constant(1),
                least_slope: self.constant(2).unwrap_or(0.0),
            }
            .into(),
        )
    }

    fn friction(&self, alarm: &Alarm) -> Option<field::Law<dyn FrictionLaw>> {
        Some(
            ArrayFriction {
                bound: self.arrays(0, 5, alarm)?,
                lipschitz: self.constant(0),
                least_slope: self.constant(1).unwrap_or(0.0),
                drops_from_rest: self.constant(2).is_some(),
            }
            .into(),
        )
    }

    fn heat(&self, alarm: &Alarm) -> Option<field::Law<dyn HeatLaw>> {
        Some(
            ArrayHeat {
                flux: self.arrays(0, 7, alarm)?,
                conductance_bound: self.constant(0).unwrap_or(f64::INFINITY),
                conductance_lipschitz: self.constant(1),
            }
            .into(),
        )
    }

    fn wear(&self, alarm: &Alarm) -> Option<field::Law<dyn WearLaw>> {
        Some(ArrayWear { coefficient: self.arrays(0, 2, alarm)? }.into())
    }

    fn tensor(&self, alarm: &Alarm) -> Option<field::Law<dyn TensorLaw>> {
        Some(
            ArrayTensor {
                value: self.arrays(0, 6, alarm)?,
                tangent: self.arrays(1, 36, alarm)?,
                potential: self.arrays(2, 1, alarm),
                constants: OperatorConstants {
                    monotonicity: self.constant(0).unwrap_or(0.0),
                    lipschitz: self.constant(1).unwrap_or(f64::INFINITY),
                },
            }
            .into(),
        )
    }

    /// Puts the law into a problem. Returns true if there was a place for it.
    fn put(&self, data: &mut ProblemData, alarm: &Alarm) -> bool {
        let regions = data.mesh.regions.clone();
        let called = names(&data.contacts);
        let named = data.contacts.iter_mut().zip(called);
        let is_meant = |(contact, called): &(&mut Contact, String)| {
            self.place.as_ref().is_none_or(|place| *place == contact.on || place == called)
        };
        let contacts = named.filter(is_meant).map(|(contact, _)| contact);
        let materials = data.materials.iter_mut().enumerate().filter(|(region, _)| {
            self.place.as_ref().is_none_or(|place| regions.get(*region).is_some_and(|name| name == place))
        });
        let materials = materials.map(|(_, material)| material);
        let mut found = false;
        match self.kind.as_str() {
            "elasticity" | "viscosity" => {
                for (material, law) in materials.zip(std::iter::repeat_with(|| self.tensor(alarm))) {
                    let Some(law) = law else { return false };
                    let place =
                        if self.kind == "viscosity" { &mut material.viscosity } else { &mut material.elasticity };
                    *place = law;
                    found = true;
                }
            }
            kind => {
                for contact in contacts {
                    match kind {
                        "normal" => self.normal(alarm).map(|law| contact.normal = law),
                        "friction" => self.friction(alarm).map(|law| contact.friction = law),
                        "heat" => self.heat(alarm).map(|law| contact.heat = law),
                        "wear" => self.wear(alarm).map(|law| contact.wear = Some(law)),
                        _ => None,
                    };
                    found = true;
                }
            }
        }
        found
    }
}

/// The problem with some of its laws replaced.
pub fn with_laws(py: Python<'_>, problem: &Problem, laws: &[Law], alarm: &Alarm) -> PyResult<Problem> {
    if laws.is_empty() {
        return Ok(problem.clone());
    }
    let mut lost = None;
    let made = problem.with(|data| {
        lost = laws.iter().find(|law| !law.put(data, alarm));
    });
    if let Some(law) = lost {
        let place = law.place.as_deref().unwrap_or_default();
        let (what, known) = if matches!(law.kind.as_str(), "elasticity" | "viscosity") {
            ("region", problem.mesh.regions.clone())
        } else {
            ("contact side", names(&problem.contacts))
        };
        let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
        return Err(errors::request(
            py,
            &format!("laws: found the {what} \"{place}\", expected one of the case, which has {known}"),
        ));
    }
    let made = made.map_err(|faults| errors::of_faults(py, &faults));
    match alarm.take() {
        Some(error) => Err(error),
        None => made,
    }
}

/// Tests the contract of a law at random points, for arguments of this size: slopes against differences, constants, and
/// the assumptions of the solver.
#[pyfunction]
#[pyo3(signature = (law, size, dim))]
pub fn test_law(py: Python<'_>, law: Law, size: f64, dim: usize) -> PyResult<Option<String>> {
    let alarm = Alarm::default();
    let test = || match law.kind.as_str() {
        "normal" => law.normal(&alarm).iter().for_each(|law| contract::assert_normal_law(law.as_ref(), size)),
        "friction" => law.friction(&alarm).iter().for_each(|law| contract::assert_friction_law(law.as_ref(), size)),
        "heat" => law.heat(&alarm).iter().for_each(|law| contract::assert_heat_law(law.as_ref(), size)),
        "wear" => law.wear(&alarm).iter().for_each(|law| contract::assert_wear_law(law.as_ref())),
        _ => law.tensor(&alarm).iter().for_each(|law| contract::assert_tensor_law(law.as_ref(), dim, size)),
    };
    let found = py.detach(|| quietly(std::panic::AssertUnwindSafe(test)));
    match alarm.take() {
        Some(error) => Err(error),
        None => Ok(found.err()),
    }
}

/// The message of a failed assertion, without printing it.
fn quietly(test: impl FnOnce() + std::panic::UnwindSafe) -> Result<(), String> {
    static HOOK: Mutex<()> = Mutex::new(());
    let _one_at_a_time = HOOK.lock().unwrap_or_else(PoisonError::into_inner);
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let result = std::panic::catch_unwind(test);
    std::panic::set_hook(hook);
    result.map_err(|panic| match panic.downcast::<String>() {
        Ok(text) => *text,
        Err(panic) => panic.downcast_ref::<&str>().map_or_else(String::new, |text| (*text).to_owned()),
    })
}
