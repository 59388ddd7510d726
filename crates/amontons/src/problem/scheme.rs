//! Which data a scheme in time takes.

use std::sync::Arc;

use super::{Fault, ProblemData};
use crate::contact::{Contact, GraphKind};
use crate::element::ShapeTable;
use crate::linalg::{BlockMatrix, Graph};
use crate::mass::{MassMatrix, NotMoved, means, redistributed};
use crate::mesh::{CellMap, FacetSet};
use crate::time::{Analysis, ContactRule, FrictionRule, PressureRule, TimeScheme};

impl ProblemData {
    /// True if bodies hit rigid foundations by a law of impact, as the ϑ-scheme does.
    #[must_use]
    pub fn has_impacts(&self) -> bool {
        self.mass == MassMatrix::Consistent
            && matches!(self.scheme, TimeScheme::Theta { .. })
            && self.contacts.iter().any(|contact| contact.normal.is_rigid())
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
                self.check_theta(level, contact, faults);
                "theta"
            }
            TimeScheme::Bdf2 => "bdf2",
            TimeScheme::ContactStabilised if self.mass == MassMatrix::Redistributed => {
                let found = "\"redistributed\" with time.scheme = \"contact-stabilised\"";
                let expected = "\"consistent\": the velocity that a step starts from is that of nodes with mass";
                faults.push(Fault::new("time.mass", found, expected).hint("use time.scheme = \"theta\""));
                return;
            }
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

    /// Checks that the mass of the nodes in contact can be moved to others.
    pub(super) fn check_mass(&self, faults: &mut Vec<Fault>) {
        let massless = self.massless_nodes();
        let place = |node: u32| self.mesh.points.get(node as usize).map_or_else(String::new, |x| self.mesh.place(x));
        let rigid = self.rigid_nodes();
        let is_rigid = |node: &&u32| rigid.iter().any(|body| body.position(**node).is_some());
        if let Some(&node) = massless.iter().find(is_rigid) {
            let found = format!("\"redistributed\" with a rigid part in contact at {}", place(node));
            let fault = Fault::new("time.mass", found, "parts in contact that deform: a rigid one moves with its mass");
            faults.push(fault.hint("use mass = \"consistent\", or let the part deform"));
            return;
        }
        let (found, at) = match self.moved_mass(massless) {
            Ok(()) => return,
            Err(NotMoved::AllInContact(node)) => ("a body all of whose nodes are in contact", node),
            Err(NotMoved::TooFew(node)) => ("a body with too few layers of nodes off contact for its inertia", node),
        };
        let found = format!("\"redistributed\" with {found}, at {}", place(at));
        let expected = "some layers of cells behind each side in contact";
        let hint = "use smaller cells, contact on a part of the boundary only, or mass = \"consistent\"";
        faults.push(Fault::new("time.mass", found, expected).hint(hint));
    }

    /// Moves the mass of nodes in contact.
    fn moved_mass(&self, massless: Vec<u32>) -> Result<(), NotMoved> {
        if massless.is_empty() {
            return Ok(());
        }
        let cells = Graph::of_mesh(&self.mesh);
        let map = means(&cells, massless)?;
        let mut form = BlockMatrix::zero(&Arc::new(map.joined(&cells)), 1, 1);
        for block in &self.mesh.blocks {
            let Some(material) = self.material_of(block.region) else { continue };
            let table = ShapeTable::new(block.element, 2 * block.element.degree);
            let (mut at, size) = (CellMap::new(&self.mesh, &table), block.element.nodes.len());
            for cell in block.cells() {
                let mut own = vec![0.0; size * size];
                for (q, weight) in table.weights.iter().enumerate() {
                    at.at(cell, q);
                    let mass = weight * at.measure * material.density.at(&at.position);
                    let pairs = table.values(q).iter().flat_map(|a| table.values(q).iter().map(move |b| a * b));
                    own.iter_mut().zip(pairs).for_each(|(sum, product)| *sum += mass * product);
                }
                form.add(cell, &own);
            }
        }
        redistributed(&self.mesh, &form, &map).map(|_| ())
    }

    /// Checks the numbers of the ϑ-scheme.
    fn check_theta(&self, level: f64, rule: ContactRule, faults: &mut Vec<Fault>) {
        if !(0.5..=1.0).contains(&level) {
            let fault = Fault::new("time.theta", format!("{level:?}"), "a number from 0.5 to 1");
            faults.push(fault.hint("0.5 is of second order and adds no damping; 1 is backward Euler"));
        }
        if self.mass == MassMatrix::Redistributed {
            let all = [
                (
                    rule.restitution.abs() > 0.0,
                    "restitution",
                    "a coefficient of restitution",
                    "none: a node without mass has no impact",
                ),
                (
                    rule.pressure == PressureRule::Plain,
                    "pressure",
                    "\"plain\"",
                    "none: the pressure is that at the end of the step",
                ),
                (
                    rule.friction == FrictionRule::End,
                    "friction",
                    "\"end\"",
                    "none: a node without mass has one velocity in a step",
                ),
            ];
            for (_, key, found, expected) in all.into_iter().filter(|(is, ..)| *is) {
                let found = format!("{found} with mass = \"redistributed\"");
                faults.push(
                    Fault::new(format!("time.{key}"), found, expected).hint("remove it, or use mass = \"consistent\""),
                );
            }
            return;
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
