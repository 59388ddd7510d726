//! Contact of rigid parts with rigid bodies.

use std::collections::BTreeSet;

use super::warning;
use crate::contact::{Contact, GraphKind};
use crate::hypotheses::{Finding, FindingId};
use crate::problem::Problem;

/// `rigid-on-rigid`: more points press than a rigid body has equations, so their pressures are undetermined. One
/// warning per contact.
pub(super) fn on_rigid(problem: &Problem) -> Vec<Finding> {
    let rigid: BTreeSet<u32> = problem.rigid.iter().flat_map(|part| part.nodes(&problem.mesh)).collect();
    if rigid.is_empty() {
        return Vec::new();
    }
    let of = |(number, contact): (usize, &Contact)| {
        if contact.normal.graph() == GraphKind::Function {
            return None;
        }
        let of_side = |side: &str| -> BTreeSet<u32> {
            let nodes = problem.mesh.facets.get(side).map(crate::mesh::FacetSet::node_list).unwrap_or_default();
            nodes.into_iter().collect()
        };
        // The opposite side of a pair is rigid only if all of it is.
        let faces_deformable =
            contact.facing().is_some_and(|side| of_side(side).iter().any(|node| !rigid.contains(node)));
        let count = of_side(contact.bearing()).intersection(&rigid).count();
        // A resultant and its line of action determine two pressures in the plane, three in space.
        let determined = problem.mesh.dim.min(3);
        if faces_deformable || count <= determined {
            return None;
        }
        let message = format!(
            "\"{}\" is rigid, and so is what it meets: of the pressures at {count} points only the resultant and its place are determined",
            contact.bearing()
        );
        let repair = "`compliance` with the stiffness of the softer surface, or a layer at the contact that deforms";
        let place = format!("{}.normal", problem.contact_path(number));
        Some(warning(FindingId::RigidOnRigid, &place, [count as f64, determined as f64], message, repair))
    };
    problem.contacts.iter().enumerate().filter_map(of).collect()
}
