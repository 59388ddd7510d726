//! The checks of preloads on sections and of loads on obstacles.

use super::boundary::plane_of;
use super::{Fault, ProblemData};
use crate::contact::obstacle::ObstacleLoad;
use crate::contact::{Contact, Preload};
use crate::tensor::dot;

impl ProblemData {
    /// Checks that a preload belongs to a tie across a plane section and ends after the run has begun.
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

    /// Checks that the load of an obstacle is one force in space, along a line that its prescribed motion leaves free.
    pub(super) fn check_obstacle_load(&self, contact: &Contact, path: &str, faults: &mut Vec<Fault>) {
        let Some(obstacle) = &contact.obstacle else { return };
        let Some(ObstacleLoad { force, direction, mass, .. }) = &obstacle.load else { return };
        let path = format!("{path}.obstacle.load");
        if force.depends_on_space() {
            let (at, found) = (format!("{path}.force"), "an expression in space");
            let fault = Fault::new(at, found, "a number or an expression in t");
            faults.push(fault.hint("the force is that on the whole obstacle"));
        }
        if !(mass.is_finite() && *mass >= 0.0) {
            faults.push(Fault::new(format!("{path}.mass"), mass.to_string(), "a mass in kg that is not negative"));
        }
        if self.mesh.axisymmetric && (direction[0] != 0.0 || direction[2] != 0.0) {
            let found = format!("a direction {} beside a body of revolution", self.mesh.place(direction));
            let hint = "a rigid obstacle of revolution moves along the axis alone, which is y";
            faults.push(Fault::new(format!("{path}.direction"), found, "a direction along the axis").hint(hint));
        }
        let moves = |t: f64| {
            let [first, now] = [0.0, t].map(|t| obstacle.shape.place(t));
            let moved = std::array::from_fn(|c| now[c] - first[c]);
            dot(&moved, direction).abs() > 1e-9 * crate::tensor::length(&moved)
        };
        if [0.37 * self.timeline.end(), self.timeline.end()].into_iter().any(moves) {
            let hint = "across that direction it may move as given; along it the force moves it";
            let found = "an obstacle that is given a motion along the direction of its load";
            faults.push(Fault::new(path, found, "a place that does not move along the load").hint(hint));
        }
    }
}
