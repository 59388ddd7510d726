//! The motions without strain that supports and springs allow.

use crate::mesh::FacetSet;
use crate::mesh::defects::Component;
use crate::problem::Problem;
use crate::rigid::{free_motions, supported};

/// Number of independent motions without strain per part of the body that supports and springs allow; contact is not
/// counted.
#[must_use]
pub fn rigid_motions(problem: &Problem, parts: &[Component]) -> Vec<usize> {
    let (space, springs) = (problem.displacement_space(), supported(problem, false));
    let parts = parts.iter().enumerate();
    parts.map(|part| free_motions(&problem.mesh, &space, &springs, part).len()).collect()
}

/// True if each part of the body has a side whose temperature is prescribed or exchanges heat with surroundings.
#[must_use]
pub(super) fn holds_temperature(problem: &Problem, parts: &[Component]) -> bool {
    let sides = problem.boundary.iter().filter(|b| b.holds_temperature()).filter_map(|b| problem.mesh.named(&b.on));
    let held: Vec<u32> = sides.flat_map(FacetSet::node_list).collect();
    parts.iter().all(|part| held.iter().any(|node| part.nodes.binary_search(node).is_ok()))
}
