//! Which data a scheme in time takes.

use super::{Fault, ProblemData};
use crate::contact::{Contact, GraphKind};
use crate::mesh::FacetSet;
use crate::time::{Analysis, ContactRule, FrictionRule, TimeScheme};

impl ProblemData {
    /// True if bodies hit rigid foundations by a law of impact, as the ϑ-scheme does.
    #[must_use]
    pub fn has_impacts(&self) -> bool {
        matches!(self.scheme, TimeScheme::Theta { .. }) && self.contacts.iter().any(|contact| contact.normal.is_rigid())
    }

    /// True if a step adds to two states, as with BDF2.
    #[must_use]
    pub fn adds_to_two_states(&self) -> bool {
        self.scheme == TimeScheme::Bdf2
    }

    /// Checks that the scheme can take all laws of the problem. Backward Euler takes every law.
    pub(super) fn check_scheme(&self, faults: &mut Vec<Fault>) {
        let word = match self.scheme {
            TimeScheme::BackwardEuler => return,
            TimeScheme::Theta { level, contact } => {
                Self::check_theta(level, contact, faults);
                "theta"
            }
            TimeScheme::Bdf2 => "bdf2",
            TimeScheme::ContactStabilised => {
                self.check_masses(faults);
                self.check_deformable(faults);
                "contact-stabilised"
            }
        };
        let mut refuse = |path: String, found: &str, expected: &str| {
            let found = format!("{found}, with time.scheme = \"{word}\"");
            faults.push(Fault::new(path, found, expected).hint("use time.scheme = \"euler\""));
        };
        for (side, contact) in self.contacts.iter().enumerate() {
            let path = self.contact_path(side);
            for (key, found, expected) in of_contact(contact, self.scheme) {
                refuse(format!("{path}.{key}"), found, expected);
            }
        }
    }

    /// Checks that each cell has a mass: without it the kinetic energy says nothing of the velocity of its nodes.
    fn check_masses(&self, faults: &mut Vec<Fault>) {
        let is_dynamic = self.timeline.phases().any(|phase| phase.analysis == Analysis::Dynamic);
        let is_rigid = self.contacts.iter().any(|contact| contact.normal.is_rigid());
        if !(self.physics.has_mechanics() && is_dynamic && is_rigid) {
            return;
        }
        let points =
            |cell: &[u32]| cell.iter().filter_map(|&node| self.mesh.points.get(node as usize)).collect::<Vec<_>>();
        let massless = self.mesh.blocks.iter().find_map(|block| {
            let material = self.material_of(block.region)?;
            block.cells().map(points).find(|all| all.iter().all(|x| material.density.at(x) == 0.0))
        });
        if let Some(x) = massless.and_then(|all| all.first().copied()) {
            let found = format!("0 at {}, with time.scheme = \"contact-stabilised\"", self.mesh.place(x));
            let fault = Fault::new(
                "material.density",
                found,
                "a positive number: the velocity that a step starts from is the nearest one by its kinetic energy",
            );
            faults.push(fault.hint(
                "use time.scheme = \"theta\" or \"euler\", or give the density and let inertia act (time.inertia)",
            ));
        }
    }

    /// Checks that no rigid part meets a rigid foundation: the momentum that a step takes from the nodes in contact is
    /// not taken from their velocities, which is harmless in the cells at a side, but is all the momentum of the part.
    fn check_deformable(&self, faults: &mut Vec<Fault>) {
        if self.rigid.is_empty() || self.mesh.check_nodes().is_err() {
            return;
        }
        let rigid = self.rigid_nodes();
        for (side, contact) in self.contacts.iter().enumerate().filter(|(_, contact)| contact.normal.is_rigid()) {
            let sides = [Some(contact.on.as_str()), contact.pair.as_ref().map(|pair| pair.with.as_str())];
            let mut nodes =
                sides.into_iter().flatten().filter_map(|on| self.mesh.named(on)).flat_map(FacetSet::node_list);
            if nodes.any(|node| rigid.iter().any(|body| body.position(node).is_some())) {
                let found = "a rigid foundation of a rigid part, with time.scheme = \"contact-stabilised\"";
                let path = format!("{}.normal", self.contact_path(side));
                let fault =
                    Fault::new(path, found, "a part that deforms: a rigid one would keep its velocity in contact");
                faults.push(fault.hint("use time.scheme = \"theta\", or a compliance"));
            }
        }
    }

    /// Checks the numbers of the ϑ-scheme.
    fn check_theta(level: f64, rule: ContactRule, faults: &mut Vec<Fault>) {
        if !(0.5..=1.0).contains(&level) {
            let fault = Fault::new("time.theta", format!("{level:?}"), "a number from 0.5 to 1");
            faults.push(fault.hint("0.5 is of second order and adds no damping; 1 is backward Euler"));
        }
        let most = (1.0 - level) / level;
        if !(0.0..=most).contains(&rule.restitution) && (0.5..=1.0).contains(&level) {
            let found = format!("{:?} with theta = {level:?}", rule.restitution);
            let fault = Fault::new("time.restitution", found, format!("a number from 0 to {most:?}, (1 − ϑ)/ϑ"));
            faults.push(fault.hint("with more an impact would give energy"));
        }
    }
}

/// What of a contact a scheme other than backward Euler does not take: key, what was found, what was expected.
fn of_contact(contact: &Contact, scheme: TimeScheme) -> Vec<(&'static str, &'static str, &'static str)> {
    let rule = match scheme {
        TimeScheme::Theta { contact, .. } => Some(contact),
        TimeScheme::ContactStabilised => Some(ContactRule::default()),
        TimeScheme::BackwardEuler | TimeScheme::Bdf2 => None,
    };
    let law = &contact.normal;
    let obstacle = contact.obstacle.as_ref().is_some_and(|obstacle| obstacle.load.is_some());
    let is_stop = law.graph() != GraphKind::Function && !law.is_rigid();
    let wears = contact.wear.is_some();
    let wears_at_end = wears && rule.is_some_and(|rule| rule.friction == FrictionRule::End);
    let all = [
        (
            rule.is_some() && is_stop,
            "normal",
            "a law with a rigid stop behind a layer",
            "a layer, or a rigid foundation",
        ),
        (wears_at_end, "wear", "wear with time.friction = \"end\"", "wear with time.friction = \"mean\""),
        (wears && rule.is_none(), "wear", "wear, whose depth is a sum over steps of first order", "none"),
        (contact.preload.is_some(), "preload", "a preload", "none"),
        (contact.fluid.is_some(), "fluid", "a fluid", "none"),
        (obstacle, "obstacle.load", "an obstacle under a force", "an obstacle whose motion is given"),
    ];
    all.into_iter().filter(|(is, ..)| *is).map(|(_, key, found, expected)| (key, found, expected)).collect()
}
