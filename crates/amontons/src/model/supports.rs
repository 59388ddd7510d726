//! The motions without strain that supports and springs leave a body.

use crate::mesh::FacetSet;
use crate::mesh::defects::Component;
use crate::problem::Problem;
use crate::rigid::{free_motions, supported};

/// Number of independent motions without strain of each part of the body that supports and springs do not hold; contact
/// is not counted.
#[must_use]
pub fn rigid_motions(problem: &Problem, parts: &[Component]) -> Vec<usize> {
    let (space, springs) = (problem.displacement_space(), supported(problem, false));
    let parts = parts.iter().enumerate();
    parts.map(|part| free_motions(&problem.mesh, &space, &springs, part).len()).collect()
}

/// Whether each part of the body has a side whose temperature is held, by a prescribed value or the surroundings.
#[must_use]
pub(super) fn holds_temperature(problem: &Problem, parts: &[Component]) -> bool {
    let sides = problem.boundary.iter().filter(|b| b.holds_temperature()).filter_map(|b| problem.mesh.named(&b.on));
    let held: Vec<u32> = sides.flat_map(FacetSet::node_list).collect();
    parts.iter().all(|part| held.iter().any(|node| part.nodes.binary_search(node).is_ok()))
}
