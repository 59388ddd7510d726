//! Uncertainty of the normals of a side at its nodes.

use std::collections::BTreeMap;

use super::free::normals;
use crate::contact::Contact;
use crate::mesh::Mesh;
use crate::tensor::{Point, dot, length};

/// Largest sine of the angle between the normal of a facet and the mean at a node that the mesh explains: if facets
/// turn by more than 35° at a node, the side has a kink there.
const KINK: f64 = 0.300_705_799_504_273;

/// Uncertainty of the normal at nodes in ascending order: sine of the largest angle between the facet normals of the
/// contact sides and their mean. It is zero on a plane, and on a curved side tends to zero as the mesh is refined.
#[must_use]
pub fn doubts(mesh: &Mesh, contacts: &[Contact], nodes: &[u32]) -> Vec<f64> {
    let mut doubts = vec![0.0; nodes.len()];
    for set in contacts.iter().flat_map(Contact::sides).filter_map(|side| mesh.facets.get(side)) {
        let mut at: BTreeMap<u32, Vec<Point>> = BTreeMap::new();
        normals(mesh, set, |node, normal| at.entry(node).or_default().push(normal));
        for (node, normals) in at {
            let Some(doubt) = nodes.binary_search(&node).ok().and_then(|i| doubts.get_mut(i)) else { continue };
            let sum: Point = std::array::from_fn(|c| normals.iter().map(|normal| normal[c]).sum());
            let size = length(&sum);
            let cosine = |normal: &Point| if size > 0.0 { (dot(normal, &sum) / size).clamp(-1.0, 1.0) } else { 0.0 };
            let sine = |normal: &Point| {
                // Computed from the difference, so that equal normals give exactly zero.
                let along = cosine(normal);
                length(&std::array::from_fn(|c| normal[c] - along * sum[c] / size.max(f64::MIN_POSITIVE)))
            };
            let most = normals.iter().map(sine).fold(0.0, f64::max);
            *doubt = f64::max(*doubt, if most < ROUND_OFF { 0.0 } else { most.min(KINK) });
        }
    }
    doubts
}

/// Sines below this are round-off of normals.
const ROUND_OFF: f64 = 1e-9;
