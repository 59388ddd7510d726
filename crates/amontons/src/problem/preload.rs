//! The checks of sections that are tightened.

use super::boundary::plane_of;
use super::{Fault, ProblemData};
use crate::contact::{Contact, Preload};

impl ProblemData {
    /// A preload is that of a tie across a plane section, and ends after the run has begun.
    pub(super) fn check_preload(&self, contact: &Contact, path: &str, faults: &mut Vec<Fault>) {
        let Some(Preload { force, until }) = &contact.preload else { return };
        let path = format!("{path}.preload");
        if !contact.is_tie() {
            let hint = "give `with`, the other side of the section, `normal = { law = \"bilateral\" }` and \
                        `friction = { law = \"stick\" }`";
            faults.push(Fault::new(path, "a preload of sides that may part or slip", "that of a tie").hint(hint));
            return;
        }
        if contact.pair.as_ref().is_some_and(crate::contact::Pair::is_updated) {
            let found = "the preload of a pair with `geometry = \"updated\"`";
            let fault = Fault::new(path, found, "a section whose sides stay where they are on each other");
            faults.push(fault.hint("remove `geometry`"));
            return;
        }
        if !(until.is_finite() && *until > 0.0) {
            let expected = "a time in s after the start, at which the section is tight";
            faults.push(Fault::new(format!("{path}.until"), until.to_string(), expected));
        }
        if force.depends_on_space() {
            let hint = "the force is that of the whole section";
            let fault = Fault::new(format!("{path}.force"), "an expression in space", "a number or an expression in t");
            faults.push(fault.hint(hint));
        }
        let on = contact.bearing();
        let Some(facets) = self.mesh.facets.get(on).filter(|_| self.mesh.check_nodes().is_ok()) else { return };
        if let Err((number, normal)) = plane_of(&self.mesh, facets) {
            let found = format!("\"{on}\", whose facet {number} has the normal {}", self.mesh.place(&normal));
            let hint = "cut the bolt where its section is plane";
            faults.push(Fault::new(path, found, "a section in one plane").hint(hint));
        }
    }
}
