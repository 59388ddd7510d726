//! `no-effect` and `static-friction`: data without effect, and friction whose slip no data limit.
//!
//! Loads along a held direction, and heat into a side of prescribed temperature, are faults instead.

use super::super::{Finding, FindingId};
use super::warning;
use crate::contact::{Contact, ContactPoint, Obstacle};
use crate::field::Law;
use crate::material::{Material, TensorLaw};
use crate::mesh::FacetSet;
use crate::problem::{Physics, Problem};
use crate::tensor::Sym;

/// `no-effect`: data without effect on the results, one finding per datum.
pub(super) fn without_effect(problem: &Problem) -> Vec<Finding> {
    let told = |(place, message, repair): (String, String, &'static str)| {
        warning(FindingId::NoEffect, &place, [0.0, 1.0], message, repair)
    };
    let of_contacts = problem.contacts.iter().enumerate().flat_map(|(side, contact)| {
        let path = problem.contact_path(side);
        let slides = slides_without_friction(&path, contact).or_else(|| turns_without_friction(&path, contact));
        slides.into_iter().chain(heats_without_friction(&path, contact))
    });
    let of_body = velocity_without_inertia(problem).into_iter().chain(temperature_without_expansion(problem));
    of_body.chain(of_contacts).map(told).collect()
}

/// Path, message, and repair.
type Idle = (String, String, &'static str);

/// Initial velocity without inertia: the body is in balance from the first step on.
fn velocity_without_inertia(problem: &Problem) -> Option<Idle> {
    let is_given = problem.initial.velocity.iter().any(|velocity| !velocity.is_zero());
    if !is_given || has_inertia(problem) {
        return None;
    }
    let message = "without a density a body has no inertia: its velocity at the start changes nothing";
    let repair =
        "give material.density, or leave inertia on; prescribe a displacement that depends on t to drive the body";
    Some(("initial.velocity".to_owned(), message.to_owned(), repair))
}

/// Temperature without effect: it acts only by expansion, temperature-dependent laws, friction and wear.
fn temperature_without_expansion(problem: &Problem) -> Option<Idle> {
    let expands = |m: &Material| {
        let is_fixed = |law: &Law<dyn TensorLaw>| law.temperatures().is_empty();
        m.expansion.constant() != Some(Sym::ZERO) || !is_fixed(&m.elasticity) || !is_fixed(&m.viscosity)
    };
    let given = problem.temperature.first().filter(|_| problem.physics == Physics::Warmed)?;
    if problem.materials.iter().any(expands) || !problem.contacts.is_empty() {
        return None;
    }
    let message = "no material expands and no law depends on the temperature that is given: it changes nothing";
    Some((given.key.clone(), message.to_owned(), "give material.expansion_coefficient, or remove the temperature"))
}

/// Sliding without effect: a sliding foundation acts only by friction and by the wear of sliding.
fn slides_without_friction(path: &str, contact: &Contact) -> Option<Idle> {
    let slides = contact.foundation_velocity.iter().any(|velocity| !velocity.is_zero());
    if !slides || !contact.friction.is_frictionless() || contact.wear.is_some() || contact.obstacle.is_some() {
        return None;
    }
    let message = "without friction and wear nothing depends on the velocity of what the side slides on";
    Some((format!("{path}.foundation_velocity"), message.to_owned(), "give `friction`, or remove the velocity"))
}

/// Turning without effect: a roller about its axis, and a table about its normal, act only by friction.
fn turns_without_friction(path: &str, contact: &Contact) -> Option<Idle> {
    let turns = contact.obstacle.as_ref().is_some_and(Obstacle::turns_in_place);
    if !turns || !contact.friction.is_frictionless() || contact.wear.is_some() {
        return None;
    }
    let message = "without friction and wear nothing depends on the rotation of an obstacle that stays in its place";
    Some((format!("{path}.obstacle.turning"), message.to_owned(), "give `friction`, or remove `turning`"))
}

fn heats_without_friction(path: &str, contact: &Contact) -> Option<Idle> {
    let rubs = ContactPoint { friction_power: 1.0, ..ContactPoint::default() };
    let heats = (contact.heat.flux(&rubs).value - contact.heat.flux(&ContactPoint::default()).value).abs() > 0.0;
    if !heats || !contact.friction.is_frictionless() {
        return None;
    }
    let message = "without friction there is no heat of friction";
    Some((format!("{path}.frictional_heat"), message.to_owned(), "give `friction`, or remove `frictional_heat`"))
}

/// True if some material has a density.
fn has_inertia(problem: &Problem) -> bool {
    problem.values_of(|material| &material.density).iter().any(|density| density.value > 0.0)
}

/// `static-friction`: friction drops when slip starts, at a side of a body that neither inertia nor viscosity slows. A
/// point then jumps within a step of any length.
pub(super) fn jumps(problem: &Problem) -> Vec<Finding> {
    let drops = problem.contacts.iter().enumerate().filter(|(_, contact)| contact.friction.drops_from_rest());
    let jumping = drops.filter(|(_, contact)| contact.sides().any(|side| !is_slowed(problem, side)));
    let told = |(side, _): (usize, &Contact)| {
        let message = "friction drops when slip starts, and neither inertia nor viscosity slows the slip: points jump within a step, \
                       however short it is, so that slip velocities grow with the number of steps and which points jump first may depend on it"
            .to_owned();
        let repair = "give material.density or material.viscosity, or equal coefficients `static` and `kinetic`";
        warning(
            FindingId::StaticFriction,
            &format!("{}.friction", problem.contact_path(side)),
            [0.0, 1.0],
            message,
            repair,
        )
    };
    jumping.map(told).collect()
}

/// True if the body of a side has a density or a viscosity.
fn is_slowed(problem: &Problem, side: &str) -> bool {
    let mesh = &*problem.mesh;
    let Some(nodes) = mesh.facets.get(side).map(FacetSet::node_list) else { return true };
    let is_on = |cell: &[u32]| cell.iter().any(|node| nodes.binary_search(node).is_ok());
    mesh.blocks.iter().filter(|block| block.cells().any(is_on)).all(|block| {
        let Some(material) = problem.material_of(block.region) else { return true };
        let Some(x) = block.cells().next().and_then(|cell| mesh.points.get(*cell.first()? as usize)) else {
            return true;
        };
        let viscous = material.viscosity.tangent(x, &Sym::ZERO).0.iter().flatten().any(|entry| *entry != 0.0);
        let is_inert = material.density.at(x) > 0.0 && !problem.timeline.lacks_inertia();
        is_inert || viscous || material.prony.is_some()
    })
}
