//! The cells that cause the errors of numbers.
//!
//! The error of an output is the sum over the steps of the residual times the multipliers z of the step: the residual
//! is weighted by z − I z, what the mesh cannot represent of z, since z itself is a test function (R. Becker,
//! R. Rannacher, Acta Numerica 10 (2001) 1–102). A cell has about ‖σ − σ̄‖ ‖∇z − ∇z̄‖ of it, with the jumps of stress
//! and of the gradient of z: [`crate::output::JumpsOfRun`]. The product says where to refine; how large the error is,
//! is measured.

use super::AccuracyRequest;
use super::goals::Goal;
use crate::adjoint::{GradientError, GradientRequest, multipliers};
use crate::case::Case;
use crate::mesh::decisive_cells;
use crate::output::{JumpsOfRun, gradient_jumps};

/// The cells to refine for goals with largest errors, and why derivatives do not weight them if they do not.
pub(super) fn marked(
    case: &Case,
    jumps: &JumpsOfRun,
    goals: &[(&Goal, f64)],
    request: &AccuracyRequest,
) -> Result<(Vec<usize>, Option<String>), GradientError> {
    match weighted(case, jumps, goals, request) {
        Ok(errors) => Ok((decisive_cells(&errors), None)),
        Err(GradientError::Interrupted) => Err(GradientError::Interrupted),
        Err(refused) => Ok((decisive_cells(&unweighted(jumps)), Some(refused.to_string()))),
    }
}

/// The errors of the cells by the jumps alone, each of the two kinds relative to its sum.
fn unweighted(jumps: &JumpsOfRun) -> Vec<f64> {
    let [stress, flux] = [&jumps.stress, &jumps.flux].map(|squares| {
        let sum: f64 = squares.iter().sum();
        squares.iter().map(move |square| if sum > 0.0 { square / sum } else { 0.0 }).collect::<Vec<f64>>()
    });
    stress.iter().zip(&flux).map(|(a, b)| a + b).collect()
}

/// The errors of the cells, each goal relative to the error that it may have.
fn weighted(
    case: &Case,
    jumps: &JumpsOfRun,
    goals: &[(&Goal, f64)],
    request: &AccuracyRequest,
) -> Result<Vec<f64>, GradientError> {
    let mesh = &case.problem.mesh;
    let outputs: Vec<String> = goals.iter().map(|(goal, _)| goal.output()).collect();
    let none = || vec![0.0; mesh.cell_count()];
    let mut weights: Vec<[Vec<f64>; 2]> = goals.iter().map(|_| [none(), none()]).collect();
    let asked = GradientRequest {
        problem: &case.problem,
        probes: &case.probes,
        outputs: &outputs,
        parameters: &[],
        memory: None,
        interrupt: request.settings.interrupt.as_deref(),
    };
    multipliers(&asked, &mut |output, both| {
        let Some(weights) = weights.get_mut(output) else { return };
        for ((sums, z), components) in weights.iter_mut().zip(both).zip([mesh.dim, 1]) {
            if z.iter().any(|z| *z != 0.0) {
                let more = gradient_jumps(mesh, components, z);
                sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
            }
        }
    })?;
    let mut errors = none();
    for ([stress, flux], (_, most)) in weights.iter().zip(goals) {
        let products = jumps.stress.iter().zip(stress).zip(jumps.flux.iter().zip(flux));
        for (error, ((sigma, z), (q, z_heat))) in errors.iter_mut().zip(products) {
            *error += ((sigma * z).sqrt() + (q * z_heat).sqrt()) / most;
        }
    }
    Ok(errors)
}
