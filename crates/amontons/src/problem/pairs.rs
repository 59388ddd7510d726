//! The checks of pairs of sides.

use std::collections::BTreeSet;
use std::sync::OnceLock;

use super::{Fault, ProblemData};
use crate::contact::mortar::Mortar;
use crate::contact::{Contact, Quadrature, Supports};
use crate::mesh::FacetSet;
use crate::space::Space;

/// Calls `make` with the supports of the nodes, that is the directions that a space prescribes. `boundary` keeps the
/// facets that bound the bodies from one pairing to the next.
pub fn with_supports<T>(space: &Space, boundary: Option<&OnceLock<FacetSet>>, make: impl FnOnce(Supports) -> T) -> T {
    make(Supports {
        held: &|node| space.held(node),
        alike: &|node, other, direction| space.is_alike([node, other], direction),
        links: &space.links,
        boundary,
    })
}

impl ProblemData {
    /// Checks that the two sides of a pair differ, do not overlap, face each other and are named once.
    pub(super) fn check_pair(&self, number: usize, path: &str, faults: &mut Vec<Fault>) {
        let contact = &self.contacts[number];
        let Some(pair) = &contact.pair else { return };
        let at = format!("{path}.with");
        if contact.quadrature == Quadrature::Gauss {
            let hint = "the points of a pair are the vertices of its nonmortar side";
            faults.push(
                Fault::new(format!("{path}.quadrature"), "Gauss points on a pair", "nodal quadrature").hint(hint),
            );
        }
        if pair.with == contact.on {
            let hint = "the two faces of one body are two sides with names of their own";
            faults.push(Fault::new(at, format!("\"{}\" with itself", contact.on), "another side").hint(hint));
            return;
        }
        let same = |other: &Contact| {
            other.pair.is_some()
                && other.acts()
                && other.sides().collect::<BTreeSet<_>>() == contact.sides().collect::<BTreeSet<_>>()
        };
        if let Some(first) = self.contacts[..number].iter().position(same) {
            let found = format!("\"{}\" and \"{}\" again", contact.on, pair.with);
            let hint = format!("remove it, or merge it with entry {}", first + 1);
            faults.push(Fault::new(at, found, "each pair of sides once").hint(hint));
            return;
        }
        let [Some(on), Some(with)] = [&contact.on, &pair.with].map(|side| self.mesh.facets.get(side)) else { return };
        if self.mesh.check_nodes().is_err() {
            return;
        }
        let key = |nodes: &[u32]| -> BTreeSet<u32> { nodes.iter().copied().collect() };
        let on_facets: BTreeSet<_> = on.facets().map(|(_, nodes)| key(nodes)).collect();
        let shared = with.facets().filter(|(_, nodes)| on_facets.contains(&key(nodes))).count();
        if shared > 0 {
            let found = format!("{shared} facets of \"{}\" on \"{}\" as well", contact.on, pair.with);
            faults.push(
                Fault::new(at, found, "sides that do not overlap").hint("name each facet in one of the two sides"),
            );
            return;
        }
        let mortar = contact.pairing(&self.mesh, &self.mesh.points, Supports::NONE).map(|sides| Mortar::new(&sides));
        if mortar.is_some_and(|mortar| mortar.covered <= 0.0) && !pair.is_updated() {
            let found = format!("no point of \"{}\" that faces \"{}\"", contact.on, pair.with);
            let hint = "check the names of the sides, the units of the mesh and the orientation of the bodies";
            faults.push(Fault::new(at, found, "sides that face each other along their normals").hint(hint));
        }
    }

    /// Propagates support through pairs: if one part of a joined group is held, all are. `held` has `[in mechanics, in
    /// heat]` per part.
    pub(super) fn join_parts(&self, part_of: &[usize], held: &mut [[bool; 2]]) {
        for what in [0, 1] {
            let joins = |contact: &&Contact| {
                contact.pair.is_some() && contact.acts() && (what == 0 || contact.heat.conductance_bound() > 0.0)
            };
            let groups: Vec<BTreeSet<usize>> = self
                .contacts
                .iter()
                .filter(joins)
                .map(|contact| {
                    let nodes =
                        contact.sides().filter_map(|side| self.mesh.facets.get(side)).flat_map(FacetSet::node_list);
                    nodes.filter_map(|node| part_of.get(node as usize).copied()).collect()
                })
                .collect();
            loop {
                let mut changed = false;
                for group in &groups {
                    if group.iter().any(|&part| held[part][what]) {
                        for &part in group {
                            changed |= !held[part][what];
                            held[part][what] = true;
                        }
                    }
                }
                if !changed {
                    break;
                }
            }
        }
    }
}
