//! The equations of a case: they follow from the keys of its materials, and every other key must belong to one of them.

use super::path::Path;
use super::place::{At, PathFault};
use super::raw::{self, Datum, Friction, Heat, HeatTerm, Scalar, Wear};
use super::schema::{SchemaView, rules};
use crate::contact::{ConductanceFormula, FrictionFormula};
use crate::expression::{Formula, NamedConstants};
use crate::problem::Physics;

/// The equations of a case: mechanics if a material has a density, an elasticity or a viscosity, heat if one has a heat
/// capacity or a conductivity, and both if one expands or gives off heat as it is strained.
///
/// Missing keys, and data of equations that the case does not have, go to the findings.
pub(super) fn physics(raw: &raw::Case, findings: &mut Vec<PathFault>) -> Physics {
    let own = raw.region.iter().enumerate();
    let own = own.filter_map(|(i, region)| Some((format!("region[{i}].material"), region.material.as_ref()?)));
    let materials: Vec<(String, &raw::Material)> =
        std::iter::once(("material".to_owned(), &raw.material)).chain(own).collect();
    let coupled =
        |m: &raw::Material| m.expansion.is_some() || m.expansion_coefficient.is_some() || m.coupling.is_some();
    let moves = |m: &raw::Material| {
        m.density.is_some() || m.elasticity.is_some() || m.viscosity.is_some() || !m.prony.is_empty() || coupled(m)
    };
    let conducts = |m: &raw::Material| m.heat_capacity.is_some() || m.conductivity.is_some() || coupled(m);
    let [mechanics, heat] = [materials.iter().any(|(_, m)| moves(m)), materials.iter().any(|(_, m)| conducts(m))];
    let is_warmed = is_warmed(raw) && mechanics;
    let heat = heat && !is_warmed;
    let physics = match (mechanics, heat) {
        (true, _) if is_warmed => Physics::Warmed,
        (true, false) => Physics::Mechanics,
        (false, true) => Physics::Heat,
        (true, true) => Physics::Coupled,
        (false, false) => {
            let expected =
                "`density` and `elasticity` for mechanics, `heat_capacity` and `conductivity` for heat, or all four";
            findings.push(PathFault::new(
                path("material"),
                At::Value,
                "a material without keys of mechanics or heat",
                expected,
            ));
            return Physics::Coupled;
        }
    };
    required(raw, &materials, [mechanics, heat], findings);
    let (others, hint) = match physics {
        Physics::Coupled => return physics,
        Physics::Warmed => {
            beside_temperature(raw, &materials, findings);
            return physics;
        }
        Physics::Mechanics => (of_heat(raw), "remove it, or give material.heat_capacity and material.conductivity"),
        Physics::Heat => (of_mechanics(raw), "remove it, or give material.density and material.elasticity"),
    };
    let (what, expected) =
        if mechanics { ("heat", "keys of mechanics only") } else { ("mechanics", "keys of heat only") };
    findings.extend(others.into_iter().map(|(key, found)| {
        PathFault::new(
            path(&key),
            At::Value,
            format!("{found} in a case without {what}"),
            format!("{expected}: no material has any of {what}"),
        )
        .hint(Some(hint.to_owned()))
    }));
    physics
}

/// Notes missing data that the equations need.
fn required(
    raw: &raw::Case,
    materials: &[(String, &raw::Material)],
    [mechanics, heat]: [bool; 2],
    findings: &mut Vec<PathFault>,
) {
    for (prefix, material) in materials {
        if mechanics {
            let needs_density = has_inertia(raw) || raw.load.each().iter().any(|(_, load)| !load.gravity.is_empty());
            needs(prefix, "density", material.density.is_some() || !needs_density, findings);
            needs(prefix, "elasticity", material.elasticity.is_some(), findings);
        }
        if heat {
            needs(prefix, "heat_capacity", material.heat_capacity.is_some() || !stores_heat(raw), findings);
            needs(prefix, "conductivity", material.conductivity.is_some(), findings);
        }
    }
    let lacking = |(_, contact): &(String, &raw::Contact)| mechanics && contact.normal.is_none();
    for (prefix, _) in raw.contact.iter().flat_map(raw::Contacts::each).filter(lacking) {
        let expected = "a table (law of the contact pressure p_ν (2.8))";
        findings.push(PathFault::new(path(&format!("{prefix}.normal")), At::Missing, "no such key", expected));
    }
}

/// The analyses of the phases, or of the run.
fn analyses(raw: &raw::Case) -> Vec<raw::PhaseAnalysis> {
    if raw.phase.is_empty() {
        return vec![raw.time.analysis.unwrap_or_default()];
    }
    raw.phase.iter().map(|phase| phase.analysis).collect()
}

/// True if inertia acts at some time.
fn has_inertia(raw: &raw::Case) -> bool {
    raw.time.inertia && analyses(raw).contains(&raw::PhaseAnalysis::Dynamic)
}

/// True if heat is stored at some time.
fn stores_heat(raw: &raw::Case) -> bool {
    analyses(raw).iter().any(|analysis| *analysis != raw::PhaseAnalysis::Steady)
}

/// True if a given temperature replaces the heat equation.
pub(super) fn is_warmed(raw: &raw::Case) -> bool {
    raw.load.each().iter().any(|(_, load)| load.temperature.is_some())
        || raw.region.iter().any(|region| region.temperature.is_some())
}

/// Notes keys of the heat equation in addition to a given temperature. Friction and wear may depend on it.
fn beside_temperature(raw: &raw::Case, materials: &[(String, &raw::Material)], findings: &mut Vec<PathFault>) {
    let sees_only = |key: &str| key.rsplit('.').next().is_some_and(|last| ["friction", "wear"].contains(&last));
    let mut others = of_heat(raw);
    others.retain(|(key, _)| !sees_only(key));
    for (prefix, m) in materials {
        let given = [
            ("heat_capacity", m.heat_capacity.is_some(), "a heat capacity"),
            ("conductivity", m.conductivity.is_some(), "a conductivity"),
            ("coupling", m.coupling.is_some(), "heat of the deformation"),
        ];
        let given = given.into_iter().filter(|(_, is, _)| *is);
        others.extend(given.map(|(key, _, what)| (format!("{prefix}.{key}"), what)));
    }
    findings.extend(others.into_iter().map(|(key, found)| {
        let expected = "no key of the heat equation: the temperature is known at all places and times";
        let hint = "remove it, or remove the temperature, for which heat is then solved";
        PathFault::new(path(&key), At::Value, format!("{found} beside a temperature that is given"), expected)
            .hint(Some(hint.to_owned()))
    }));
}

fn path(text: &str) -> Path {
    Path::parse(text).unwrap_or_default()
}

/// Notes a required key of a material that is missing.
fn needs(prefix: &str, key: &str, given: bool, findings: &mut Vec<PathFault>) {
    if given {
        return;
    }
    let schema = rules();
    let expected =
        SchemaView::new(&schema).property("material").and_then(|material| Some(material.property(key)?.expected()));
    findings.push(PathFault::new(
        path(&format!("{prefix}.{key}")),
        At::Missing,
        "no such key",
        expected.unwrap_or_default(),
    ));
}

fn is_zero(scalar: &Scalar) -> bool {
    matches!(scalar, Scalar::Number(value) if *value == 0.0)
}

/// True if a datum is the number zero.
pub(super) fn is_zero_datum(datum: &Datum) -> bool {
    matches!(datum, Datum::Number(value) if *value == 0.0)
}

/// True if friction depends on the temperature.
fn sees_temperature(friction: &Friction, constants: &NamedConstants) -> bool {
    match friction {
        Friction::Temperature { .. } => true,
        Friction::Expression { coefficient, .. } => {
            FrictionFormula::new(coefficient, 1.0, constants).is_ok_and(|law| law.sees_temperature())
        }
        _ => false,
    }
}

/// The dependence of a law of heat exchange on mechanics: pressure or penetration, or `None`.
fn sees_motion(law: &HeatTerm, constants: &NamedConstants) -> Option<&'static str> {
    match law {
        HeatTerm::Pressure { .. } => Some("a conductance of the pressure"),
        HeatTerm::Power { .. } | HeatTerm::Ramp { .. } => Some("a conductance of the penetration"),
        HeatTerm::Expression { conductance, .. } => {
            Formula::with(conductance, &ConductanceFormula::VARIABLES, constants)
                .is_ok_and(|formula| formula.uses(0))
                .then_some("a conductance of the pressure")
        }
        HeatTerm::Constant { .. } | HeatTerm::Gap { .. } | HeatTerm::Radiation { .. } => None,
    }
}

/// The keys of a contact that need mechanics, with a description.
fn of_motion(contact: &raw::Contact, constants: &NamedConstants) -> Vec<(&'static str, &'static str)> {
    let given = [
        ("normal", contact.normal.is_some(), "a law of contact pressure"),
        ("friction", !matches!(contact.friction, Friction::None), "friction"),
        ("frictional_heat", !is_zero_datum(&contact.frictional_heat), "heat of friction"),
        ("wear", contact.wear.is_some(), "wear"),
        ("foundation_velocity", !contact.foundation_velocity.is_empty(), "a velocity of the foundation"),
        ("preload", contact.preload.is_some(), "a preload"),
        ("fluid", contact.fluid.is_some(), "a fluid"),
        ("obstacle.load", contact.obstacle.as_ref().is_some_and(|of| of.common().2.is_some()), "a load of an obstacle"),
    ];
    let laws = contact.heat.clone().terms().0;
    let seen = laws.iter().find_map(|law| sees_motion(law, constants)).map(|what| ("heat", what));
    given.into_iter().filter(|(_, is, _)| *is).map(|(key, _, what)| (key, what)).chain(seen).collect()
}

/// The data of heat outside the materials: path and description.
pub(super) fn of_heat(raw: &raw::Case) -> Vec<(String, &'static str)> {
    let (mut found, constants) = (Vec::new(), raw.constants());
    for (path, load) in raw.load.each() {
        if !matches!(load.heat_source, Datum::Number(value) if value == 0.0) {
            found.push((format!("{path}.heat_source"), "a heat source"));
        }
    }
    let heated = raw.region.iter().enumerate().filter(|(_, region)| !is_zero_datum(&region.heat_source));
    found.extend(heated.map(|(i, _)| (format!("region[{i}].heat_source"), "a heat source")));
    for (i, b) in raw.boundary.iter().enumerate() {
        let given = [
            ("temperature", b.temperature.is_some(), "a temperature"),
            ("heat_inflow", b.heat_inflow.is_some(), "a heat inflow"),
            ("convection", b.convection.is_some(), "convection"),
        ];
        found.extend(
            given.into_iter().filter(|(_, is, _)| *is).map(|(key, _, what)| (format!("boundary[{i}].{key}"), what)),
        );
    }
    if !is_zero(&raw.initial.temperature) {
        found.push(("initial.temperature".to_owned(), "an initial temperature"));
    }
    if raw.exact.as_ref().is_some_and(|exact| exact.temperature.is_some()) {
        found.push(("exact.temperature".to_owned(), "a temperature"));
    }
    for (path, contact) in raw.contact.iter().flat_map(raw::Contacts::each) {
        let given = [
            ("heat", !matches!(contact.heat, Heat::None), "heat exchange"),
            (
                "frictional_heat",
                !matches!(contact.frictional_heat, Datum::Number(value) if value == 0.0),
                "heat of friction",
            ),
            ("foundation", contact.foundation.is_some(), "a foundation with a heat capacity"),
            ("friction", sees_temperature(&contact.friction, &constants), "friction of the temperature"),
            ("wear", matches!(contact.wear, Some(Wear::ArchardTemperature { .. })), "wear of the temperature"),
        ];
        found.extend(given.into_iter().filter(|(_, is, _)| *is).map(|(key, _, what)| (format!("{path}.{key}"), what)));
    }
    found
}

/// The data of mechanics outside the materials: path and description.
pub(super) fn of_mechanics(raw: &raw::Case) -> Vec<(String, &'static str)> {
    let (mut found, constants) = (Vec::new(), raw.constants());
    for (path, load) in raw.load.each() {
        if !load.body_force.is_empty() {
            found.push((format!("{path}.body_force"), "a body force"));
        }
        if !load.gravity.is_empty() {
            found.push((format!("{path}.gravity"), "gravity"));
        }
    }
    let loaded = raw.region.iter().enumerate().filter(|(_, region)| !region.body_force.is_empty());
    found.extend(loaded.map(|(i, _)| (format!("region[{i}].body_force"), "a body force")));
    found.extend((0..raw.rigid.len()).map(|i| (format!("rigid[{i}]"), "a rigid part")));
    let warmed = raw.region.iter().enumerate().filter(|(_, region)| region.temperature.is_some());
    let warmed = warmed.map(|(i, _)| format!("region[{i}].temperature"));
    let of_body = raw.load.each().into_iter().filter(|(_, load)| load.temperature.is_some());
    let warmed = warmed.chain(of_body.map(|(path, _)| format!("{path}.temperature")));
    found.extend(warmed.map(|key| (key, "a temperature that is given")));
    for (i, b) in raw.boundary.iter().enumerate() {
        let given = [
            ("displacement", b.displacement.is_some(), "a displacement"),
            ("normal_displacement", b.normal_displacement.is_some(), "a displacement"),
            ("traction", b.traction.is_some(), "a traction"),
            ("force", b.force.is_some(), "a force"),
            ("pressure", b.pressure.is_some(), "a pressure"),
            ("spring", b.spring.is_some(), "a spring"),
            ("dashpot", b.dashpot.is_some(), "a dashpot"),
        ];
        found.extend(
            given.into_iter().filter(|(_, is, _)| *is).map(|(key, _, what)| (format!("boundary[{i}].{key}"), what)),
        );
    }
    for (key, given, what) in [
        ("displacement", &raw.initial.displacement, "an initial displacement"),
        ("velocity", &raw.initial.velocity, "a velocity"),
    ] {
        if !given.is_empty() {
            found.push((format!("initial.{key}"), what));
        }
    }
    if raw.exact.as_ref().is_some_and(|exact| !exact.displacement.is_empty()) {
        found.push(("exact.displacement".to_owned(), "a displacement"));
    }
    for (path, contact) in raw.contact.iter().flat_map(raw::Contacts::each) {
        found.extend(of_motion(contact, &constants).into_iter().map(|(key, what)| (format!("{path}.{key}"), what)));
    }
    found
}
