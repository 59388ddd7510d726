//! Derivatives of outputs at all steps, by the linearised steps forward along with the run.

use std::sync::atomic::AtomicBool;

use super::error::GradientError;
use super::parameter::Parameter;
use crate::output::Probe;
use crate::problem::{Fault, Problem};

/// What is asked for: derivatives of outputs at all steps.
pub struct SeriesRequest<'a> {
    /// The problem.
    pub problem: &'a Problem,
    /// The probes that outputs may name.
    pub probes: &'a [Probe],
    /// Names of outputs, as in [`GradientRequest`](super::GradientRequest).
    pub outputs: &'a [String],
    /// The data by which they are differentiated.
    pub parameters: &'a [Parameter<'a>],
    /// Ends the computation when it becomes true.
    pub interrupt: Option<&'a AtomicBool>,
}

/// Outputs at all steps, with their derivatives.
#[derive(Clone, Debug, PartialEq)]
pub struct SeriesTable {
    /// Times of the steps 0 to N, s.
    pub times: Vec<f64>,
    /// Values by step and output.
    pub values: Vec<Vec<f64>>,
    /// Derivatives by step, output and parameter.
    pub derivatives: Vec<Vec<Vec<f64>>>,
    /// The least margin: how far the contact points are from a change of state, over all steps. `None` without contact
    /// points that could change.
    pub margin: Option<f64>,
    /// Number of contact points and steps that are on a change of state.
    pub ties: usize,
}

/// Computes outputs at all steps, and their derivatives by all parameters.
///
/// # Errors
/// Those of [`gradient`](super::gradient).
pub fn series(request: &SeriesRequest) -> Result<SeriesTable, GradientError> {
    let fault = Fault::new("method", "the tangent method", "the adjoint method");
    let _ = request.outputs;
    Err(GradientError::refused(fault))
}
