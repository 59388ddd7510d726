//! Whether a state fits a problem.

use super::CheckpointError;
use crate::discretization::Discretization;
use crate::mesh::defects::components;
use crate::problem::Problem;
use crate::state::State;

/// An error if a number is not the expected one.
pub(super) fn same(what: &'static str, found: usize, expected: usize) -> Result<(), CheckpointError> {
    if found == expected { Ok(()) } else { Err(CheckpointError::Shape { what, found, expected }) }
}

/// Checks the sizes of a state.
pub(super) fn state(state: &State, discretization: &Discretization, problem: &Problem) -> Result<(), CheckpointError> {
    let (nodes, dim) = (discretization.mesh.points.len(), discretization.mesh.dim);
    same("displacements", state.u.len(), nodes * dim)?;
    if !state.carried.rigid.is_empty() {
        same("deformations", state.carried.deformation.len(), nodes * dim)?;
        let bodies = components(&discretization.mesh).len();
        same("bodies", state.carried.rigid.len(), bodies)?;
    }
    same("velocities", state.w.len(), nodes * dim)?;
    if !state.released.is_empty() {
        same("forces of supports", state.released.len(), nodes * dim)?;
    }
    same("temperatures", state.theta.len(), nodes)?;
    if !state.theta_rate.is_empty() {
        same("rates of the temperature", state.theta_rate.len(), nodes)?;
    }
    earlier(state, discretization)?;
    same("branches", state.branches.len(), discretization.branches.len())?;
    for (kept, branch) in state.branches.iter().zip(&discretization.branches) {
        same("numbers of a branch", kept.len(), branch.size(nodes * dim))?;
    }
    let points = discretization.boundary.points.len();
    for kept in [
        state.multipliers.q.len(),
        state.multipliers.p.len(),
        state.multipliers.sticks.len(),
        state.surface.wear.len(),
        state.surface.friction_work.len(),
    ] {
        same("contact points", kept, points)?;
    }
    let worn = &state.surface.worn;
    let (kept, expected): (Vec<usize>, _) = (worn.depths.iter().map(Vec::len).collect(), discretization.worn.lengths());
    same("sides that wear", kept.len(), expected.len())?;
    kept.into_iter().zip(expected).try_for_each(|(kept, of)| same("vertices of a side that wears", kept, of))?;
    same("volumes worn off", worn.volumes.len(), problem.contacts.len())?;
    same("foundations", state.surface.foundation.len(), problem.contacts.len())?;
    same("contacts", state.surface.passed.len(), problem.contacts.len())?;
    same("contacts", state.surface.advance.len(), problem.contacts.len())?;
    let wet = &state.surface.wet;
    let of_fluids = |count: usize| if discretization.ways.is_empty() { 0 } else { count };
    same("points that may be wet", wet.points.len(), of_fluids(points))?;
    same("contacts that may leak", wet.leaks.len(), of_fluids(problem.contacts.len()))?;
    Ok(())
}

/// Checks the sizes of the state one step before.
fn earlier(state: &State, discretization: &Discretization) -> Result<(), CheckpointError> {
    let Some(earlier) = &state.earlier else { return Ok(()) };
    let (nodes, dim) = (discretization.mesh.points.len(), discretization.mesh.dim);
    same("earlier displacements", earlier.u.len(), nodes * dim)?;
    same("earlier velocities", earlier.w.len(), nodes * dim)?;
    same("earlier temperatures", earlier.theta.len(), nodes)?;
    same("earlier foundations", earlier.foundation.len(), state.surface.foundation.len())?;
    same("earlier branches", earlier.branches.len(), state.branches.len())?;
    for (earlier, now) in earlier.branches.iter().zip(&state.branches) {
        same("earlier numbers of a branch", earlier.len(), now.len())?;
    }
    if !earlier.carried.rigid.is_empty() {
        same("earlier deformations", earlier.carried.deformation.len(), nodes * dim)?;
        same("earlier bodies", earlier.carried.rigid.len(), components(&discretization.mesh).len())?;
    }
    Ok(())
}
