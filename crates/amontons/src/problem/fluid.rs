//! The checks of fluids at contacts.

use std::collections::BTreeSet;

use super::boundary::unknown;
use super::{Fault, ProblemData};
use crate::contact::Contact;
use crate::mesh::FacetSet;

impl ProblemData {
    /// Checks that a fluid stands at a place that meets a contact which may open.
    pub(super) fn check_fluid(&self, contact: &Contact, path: &str, faults: &mut Vec<Fault>) {
        let Some(fluid) = &contact.fluid else { return };
        let path = format!("{path}.fluid");
        if contact.is_tie() {
            let fault = Fault::new(path, "a fluid between sides that are tied", "a contact that may open");
            faults.push(fault.hint("remove it"));
            return;
        }
        if !(fluid.sealed_above.is_finite() && fluid.sealed_above >= 0.0) {
            let found = fluid.sealed_above.to_string();
            faults.push(Fault::new(format!("{path}.sealed_above"), found, "a pressure in Pa that is not negative"));
        }
        let nodes = |name: &str| self.mesh.named(name).map(FacetSet::node_list).unwrap_or_default();
        let of_contact: BTreeSet<u32> = contact.sides().flat_map(nodes).collect();
        let known: Vec<&str> = self.mesh.facets.keys().chain(self.mesh.edges.keys()).map(String::as_str).collect();
        let named = [("from", &fluid.from), ("to", &fluid.to)]
            .into_iter()
            .filter(|(key, name)| *key == "from" || !name.is_empty());
        for (key, name) in named {
            let at = format!("{path}.{key}");
            if self.mesh.named(name).is_none() {
                faults.push(unknown(at, name, "sides, edges and points", &known));
            } else if contact.sides().any(|side| side == name) {
                let hint = "name the side that is beside it";
                let found = format!("\"{name}\", which is a side of the contact itself");
                faults.push(Fault::new(at, found, "a side, an edge or points that meet it").hint(hint));
            } else if nodes(name).iter().all(|node| !of_contact.contains(node)) {
                let found = format!("\"{name}\", which has no node of the contact");
                faults.push(Fault::new(at, found, "a side, an edge or points that meet the contact"));
            }
        }
    }
}
