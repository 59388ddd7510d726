//! The compiled part of the Python package amontons, used by its Python part.
//!
//! | module | holds |
//! |---|---|
//! | `attend` | work on a thread of its own, while Python answers signals |
//! | `case` | cases: read, checked, studied, verified |
//! | `run`, `snapshot` | runs and the data they keep |
//! | `stepping` | runs that are made step by step |
//! | `laws` | laws written in Python |
//! | `picture` | pictures of runs in memory |
//! | `view` | arrays without copies |
//! | `errors` | exceptions with the texts of the program |

mod accuracy;
mod attend;
mod case;
mod errors;
mod laws;
mod linearised;
mod picture;
mod run;
mod snapshot;
mod stepping;
mod view;

use pyo3::prelude::*;

#[pymodule]
fn _amontons(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<case::Case>()?;
    module.add_class::<run::Run>()?;
    module.add_class::<snapshot::Snapshot>()?;
    module.add_class::<stepping::Saved>()?;
    module.add_class::<stepping::Stepping>()?;
    module.add_function(wrap_pyfunction!(accuracy::accurate, module)?)?;
    module.add_function(wrap_pyfunction!(case::read, module)?)?;
    module.add_function(wrap_pyfunction!(case::check, module)?)?;
    module.add_function(wrap_pyfunction!(case::converge, module)?)?;
    module.add_function(wrap_pyfunction!(case::benchmarks, module)?)?;
    module.add_function(wrap_pyfunction!(case::verify, module)?)?;
    module.add_function(wrap_pyfunction!(case::verify_benchmark, module)?)?;
    module.add_function(wrap_pyfunction!(case::verify_folder, module)?)?;
    module.add_function(wrap_pyfunction!(linearised::fit, module)?)?;
    module.add_function(wrap_pyfunction!(linearised::gradient, module)?)?;
    module.add_function(wrap_pyfunction!(linearised::modes, module)?)?;
    module.add_function(wrap_pyfunction!(laws::test_law, module)?)?;
    module.add_function(wrap_pyfunction!(picture::picture, module)?)?;
    module.add_function(wrap_pyfunction!(picture::plot_folder, module)?)?;
    module.add_function(wrap_pyfunction!(run::run, module)?)
}
