//! Which data a steady phase takes.

use super::{Fault, ProblemData};
use crate::contact::Contact;
use crate::time::{Analysis, TimePhase};

impl ProblemData {
    /// True if mechanics and heat are solved together in some step, as in each step of a steady phase.
    #[must_use]
    pub fn couples_mutually(&self) -> bool {
        self.coupling.is_mutual() || self.timeline.first_steady().is_some()
    }

    /// Checks that all contacts may come to a steady state.
    pub(super) fn check_steady(&self, faults: &mut Vec<Fault>) {
        let is_steady = |phase: &TimePhase| phase.analysis == Analysis::Steady;
        for (side, contact) in self.contacts.iter().enumerate() {
            let acts = |phase: &TimePhase| is_steady(phase) && contact.during.has(phase);
            let Some(number) = self.timeline.phases().position(acts) else { continue };
            let at = if self.timeline.has_phases() { format!("phase[{number}]") } else { "time".to_owned() };
            for (key, found, expected) in of_contact(contact) {
                let found = format!("{found}, with {at}.analysis = \"steady\"");
                let fault = Fault::new(format!("{}.{key}", self.contact_path(side)), found, expected);
                faults.push(fault.hint("use analysis = \"quasistatic\", with steps in time"));
            }
        }
    }
}

/// What of a contact has no steady state: key, what was found, what was expected.
fn of_contact(contact: &Contact) -> Vec<(&'static str, &'static str, &'static str)> {
    let heat = contact.foundation_heat.as_ref();
    let keeps_heat = heat.is_some_and(|heat| heat.exchange <= 0.0);
    let obstacle = contact.obstacle.as_ref().is_some_and(|obstacle| obstacle.load.is_some());
    let all = [
        (contact.wear.is_some(), "wear", "wear, which never ends", "none"),
        (contact.preload.is_some(), "preload", "a preload, whose section is drawn together in time", "none"),
        (contact.fluid.is_some(), "fluid", "a fluid, which spreads in time", "none"),
        (obstacle, "obstacle.load", "an obstacle under a force, which moves in time", "one whose place is given"),
        (keeps_heat, "heat", "a foundation that keeps all its heat", "one that gives heat to its surroundings"),
    ];
    all.into_iter().filter(|(is, ..)| *is).map(|(_, key, found, expected)| (key, found, expected)).collect()
}
