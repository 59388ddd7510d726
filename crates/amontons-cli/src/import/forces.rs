//! Forces at nodes in the form of the case: sets of points that share a force.

use std::collections::BTreeSet;

use super::conditions::Conditions;
use super::mesh::{DeckMesh, DeckNodeId};
use super::sides::DeckSides;
use super::time::Track;

/// A force that acts equally at each of some points.
#[derive(Clone, Debug)]
pub struct Force {
    pub on: String,
    pub from: String,
    /// Number of the points.
    pub count: usize,
    /// Force by component.
    pub tracks: [Track; 3],
}

/// Sets of points with the same force. No two points are in one element, so that a set contains no edge or facet, over
/// which the case would spread the force by length or area.
pub fn grouped(conditions: &Conditions, mesh: &DeckMesh, sides: &mut DeckSides) -> Vec<Force> {
    let mut groups: Vec<(&[Track; 3], BTreeSet<DeckNodeId>)> = Vec::new();
    for (node, tracks) in &conditions.forces {
        match groups.iter_mut().find(|(known, _)| *known == tracks) {
            Some((_, nodes)) => {
                nodes.insert(*node);
            }
            None => groups.push((tracks, BTreeSet::from([*node]))),
        }
    }
    let mut forces = Vec::new();
    for (tracks, nodes) in groups {
        let first = nodes.first().and_then(|node| conditions.force_from.get(node)).cloned();
        let (label, from) = first.unwrap_or_default();
        for part in mesh.apart(&nodes) {
            let wanted = if label.starts_with("node-") { label.clone() } else { format!("{label}-points") };
            let on = sides.nodes(mesh, &wanted, &part);
            forces.push(Force { on, from: from.clone(), count: part.len(), tracks: tracks.clone() });
        }
    }
    forces
}
