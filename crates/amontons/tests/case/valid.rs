//! Cases that hold: the shipped ones, what may be left out, and overrides.
#![allow(clippy::float_cmp)]

use amontons::case::{self, Case, CaseError, Source};
use amontons::contact::Quadrature;
use amontons::field::Field;
use amontons::material::Material;
use amontons::tensor::Sym;

const PAPER: &str = include_str!("../../../../cases/paper.toml");

type Outcome = Result<(), CaseError>;

fn parse(text: &str, overrides: &[&str]) -> Result<Case, CaseError> {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    case::parse(&Source::new("case.toml", text), &overrides)
}

fn ones() -> Sym {
    Sym::from_fn(2, |_, _| 1.0)
}

/// Section 5 of the paper, number by number.
#[test]
fn the_paper_has_its_numbers() -> Outcome {
    let case = parse(PAPER, &[])?;
    let p = &case.problem;
    assert_eq!(
        (p.name.as_str(), p.mesh.points.len(), p.timeline.steps(), p.timeline.end(), case.every),
        ("paper", 65 * 65, 64, 1.0, 16)
    );
    let Material { density, heat_capacity, expansion, coupling, conductivity, .. } = &p.materials[0];
    assert_eq!((density.constant(), heat_capacity.constant()), (Some(1.0), Some(1.0)));
    let tensors = [expansion, coupling, conductivity].map(amontons::field::Coefficient::constant);
    assert_eq!(tensors, [ones(), ones(), Sym::identity(2)].map(Some));
    assert!((p.materials[0].elasticity.constants().monotonicity - 2.0 / 1.1).abs() < 1e-14);
    assert!((p.materials[0].viscosity.constants().lipschitz - 30.0).abs() < 1e-13);
    assert_eq!(p.body_force, [Field::ZERO, Field::Constant(-1.0)]);
    assert_eq!(p.boundary.iter().map(|b| b.on.as_str()).collect::<Vec<_>>(), ["top", "left", "right"]);
    assert_eq!(p.boundary[2].traction, Some(vec![Field::Constant(-0.8), Field::Constant(0.4)]));
    let contact = p.contacts.first().expect("contact");
    assert_eq!((contact.on.as_str(), contact.quadrature), ("bottom", Quadrature::Nodal));
    assert_eq!(contact.normal.lipschitz(), Some(1e4));
    assert_eq!(contact.friction.lipschitz(Some(1e4)), Some(2e3));
    assert_eq!((contact.heat.conductance_bound(), contact.heat.truncation()), (1.0, None));
    assert!((contact.heat.conductance_lipschitz().expect("a ramp is Lipschitz") - 1e5).abs() < 1e-9);
    Ok(())
}

#[test]
fn the_readings_of_the_paper_need_overrides_only() -> Outcome {
    let problem = parse(PAPER, &["material.expansion=1", "material.coupling=1", "material.conductivity=1"])?.problem;
    let identity = &problem.materials[0];
    for tensor in [&identity.expansion, &identity.coupling, &identity.conductivity] {
        assert_eq!(*tensor, Sym::identity(2));
    }
    assert_eq!(parse(PAPER, &["material.conductivity=[[1,1],[1,1]]"])?.problem.materials[0].conductivity, ones());
    let hot = parse(PAPER, &["contact.heat.foundation_temperature=10"])?.problem.into_data().contacts.swap_remove(0);
    assert_eq!(hot.foundation_temperature, Field::Constant(10.0));
    assert_eq!(
        parse(PAPER, &["contact.quadrature=gauss"])?.problem.into_data().contacts.swap_remove(0).quadrature,
        Quadrature::Gauss
    );
    Ok(())
}

#[test]
fn the_starter_holds() -> Outcome {
    let case = parse(case::STARTER, &[])?;
    assert_eq!((case.problem.mesh.points.len(), case.every, case.expected), (33 * 17, 10, None));
    // In plane strain a number for 𝓜 acts in the third direction too.
    assert_eq!(case.problem.materials[0].expansion.at(&[0.0; 3]).get(2, 2), 3000.0);
    Ok(())
}

/// The part of the paper's case up to and including its conditions on the sides.
fn without_contact() -> &'static str {
    PAPER.split("[contact]").next().unwrap_or_default()
}

#[test]
fn contact_initial_data_loads_and_output_may_be_left_out() -> Outcome {
    let case = parse(without_contact(), &[])?;
    assert!(case.problem.contacts.is_empty() && case.every == 0);
    assert!(case.problem.initial.displacement.is_empty() && case.problem.initial.temperature.is_zero());
    let (before, after) = (without_contact().split("[load]").next(), without_contact().find("[[boundary]]"));
    let text = format!("{}{}", before.unwrap_or_default(), &without_contact()[after.unwrap_or_default()..]);
    let problem = parse(&text, &[])?.problem;
    assert!(problem.body_force.is_empty() && problem.heat_source.is_zero());
    Ok(())
}

#[test]
fn friction_and_heat_of_a_contact_may_be_left_out() -> Outcome {
    let contact = "[contact]\non = \"bottom\"\nnormal = { law = \"compliance\", stiffness = 5 }\n";
    let contact = parse(&format!("{}{contact}", without_contact()), &[])?.problem.into_data().contacts.swap_remove(0);
    assert!(contact.friction.is_frictionless() && contact.heat.conductance_bound() == 0.0 && contact.gap.is_zero());
    Ok(())
}

#[test]
fn what_varies_is_a_number_or_an_expression() -> Outcome {
    for key in [
        "load.body_force[0]",
        "load.heat_source",
        "boundary[0].displacement[1]",
        "boundary.0.temperature",
        "boundary[1].traction[0]",
        "contact.gap",
        "contact.heat.foundation_temperature",
    ] {
        parse(PAPER, &[&format!("{key}=0.5")])?;
        parse(PAPER, &[&format!("{key}=\"sin(pi*x)*exp(-t) + y\"")])?;
    }
    let problem = parse(PAPER, &["load.heat_source=\"2*x + t\"", "initial.velocity[1]=\"x^2\"", "mesh.n=4"])?.problem;
    assert!((problem.heat_source.value(&[0.5, 0.0, 0.0], 3.0) - 4.0).abs() < 1e-15);
    assert!((problem.initial.velocity[1].value(&[3.0, 0.0, 0.0], 0.0) - 9.0).abs() < 1e-14);
    Ok(())
}

/// An expression has to be finite where it acts, not elsewhere.
#[test]
fn an_expression_may_be_infinite_where_it_does_not_act() -> Outcome {
    parse(PAPER, &["boundary[2].traction[0]=\"1/x\""])?;
    assert!(parse(PAPER, &["boundary[1].traction[0]=\"1/x\""]).is_err());
    Ok(())
}

#[test]
fn limits_that_make_sense_are_taken() -> Outcome {
    for overrides in [
        ["material.density=0", "material.heat_capacity=0"],
        ["material.viscosity.first=0", "material.viscosity.second=0"],
        ["contact.normal.stiffness=0", "contact.friction.coefficient=0"],
        ["material.elasticity.poisson=0.49", "material.elasticity.stress_state=plane-strain"],
        ["material.elasticity.poisson=0.5", "material.elasticity.stress_state=plane-stress"],
        ["mesh.n=[3, 5]", "mesh.diagonal=crossed"],
    ] {
        parse(PAPER, &overrides)?;
    }
    Ok(())
}

#[test]
fn overrides_keep_comments_and_order() -> Outcome {
    let case = parse(PAPER, &["mesh.n=8", "material.elasticity.young=3e0", "boundary[1].traction[1]=0.5"])?;
    let expected =
        PAPER.replace("n = 64\n", "n = 8\n").replace("young = 2.0", "young = 3e0").replace("[1.4, 0.4]", "[1.4, 0.5]");
    assert_eq!(case.text, expected);
    assert_eq!(parse(PAPER, &[])?.text, PAPER);
    Ok(())
}

#[test]
fn overrides_make_what_is_missing_and_their_text_is_a_case() -> Outcome {
    let law = "contact.normal={ law = \"compliance\", stiffness = 7 }";
    let overrides = [
        "initial.temperature=5",
        "contact.on=bottom",
        law,
        "contact.friction.law=coulomb",
        "contact.friction.coefficient=0.1",
    ];
    let case = parse(without_contact(), &overrides)?;
    let again = parse(&case.text, &[])?;
    for case in [case, again] {
        assert_eq!(case.problem.initial.temperature, Field::Constant(5.0));
        assert_eq!(case.problem.contacts[0].friction.lipschitz(Some(7.0)), Some(0.1 * 7.0));
    }
    Ok(())
}

#[test]
fn the_last_of_several_overrides_holds() -> Outcome {
    assert_eq!(parse(PAPER, &["time.steps=3", "time.steps=5"])?.problem.timeline.steps(), 5);
    Ok(())
}

#[test]
fn files_of_other_systems_are_read() -> Outcome {
    let windows = format!("\u{feff}{}", PAPER.replace('\n', "\r\n"));
    parse(&windows, &[])?;
    assert_eq!(parse(&windows, &["mesh.n=4"])?.problem.mesh.points.len(), 25);
    Ok(())
}

#[test]
fn expected_values_are_numbers_or_arrays() -> Outcome {
    let plain = PAPER.split("[expected]").next().unwrap_or_default();
    let block =
        "[expected]\ntolerance = 1e-6\nvalues = { \"final.temperature_max\" = 0.5, \"final.velocity_max\" = [1, 2] }\n";
    let expected = parse(&format!("{plain}\n{block}"), &[])?.expected.expect("expected values");
    assert_eq!(expected.tolerance, 1e-6);
    assert_eq!(expected.values["final.temperature_max"], [0.5]);
    assert_eq!(expected.values["final.velocity_max"], [1.0, 2.0]);
    Ok(())
}

/// The schema is 2020-12, knows no null, closes every table and describes every key.
#[test]
fn the_schema_is_complete() {
    let schema = case::schema();
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    assert!(!schema.to_string().contains("null"));
    let mut tables = 0;
    walk(&schema, &mut |node| {
        if node["type"] == "object" && node.get("properties").is_some() {
            tables += 1;
            assert_eq!(node["additionalProperties"], false, "{node}");
            for (key, property) in node["properties"].as_object().into_iter().flatten() {
                assert!(
                    property["description"].as_str().is_some_and(|text| !text.trim().is_empty()),
                    "{key} has no description"
                );
            }
        }
    });
    assert!(tables > 12);
}

fn walk(node: &serde_json::Value, visit: &mut impl FnMut(&serde_json::Value)) {
    visit(node);
    match node {
        serde_json::Value::Object(fields) => fields.values().for_each(|f| walk(f, visit)),
        serde_json::Value::Array(entries) => entries.iter().for_each(|e| walk(e, visit)),
        _ => {}
    }
}

/// Each shape with its keys, by the distance of a point that is known.
#[test]
fn obstacles_are_read_with_their_keys() -> Outcome {
    let x = [0.5, 0.0, 0.0];
    for (keys, updated, distance, place) in [
        ("shape = 'plane', point = [0, '-0.1 - t'], normal = [0, 2]", false, 0.6, [0.0, -0.6, 0.0]),
        (
            "shape = 'sphere', center = [0.5, { times = [0, 1], values = [-2, -3] }], radius = 1, geometry = 'updated'",
            true,
            1.5,
            [0.5, -2.5, 0.0],
        ),
        (
            "shape = 'sphere', center = [0.5, 0.5], radius = 2, inside = true, geometry = 'reference'",
            false,
            1.5,
            [0.5, 0.5, 0.0],
        ),
        (
            "shape = 'cylinder', center = ['0.5 + t', 1], radius = 5, inside = true",
            false,
            5.0 - 1.25f64.sqrt(),
            [1.0, 1.0, 0.0],
        ),
        // A trough is below the point.
        (
            "shape = 'wave', point = [0, -1], normal = [0, 1], direction = [1, 0], amplitude = 0.01, wavelength = 1",
            false,
            1.01,
            [0.0, -1.0, 0.0],
        ),
        ("shape = 'surface', level = '4*(y + 0.25 + t)'", false, 0.75, [0.0; 3]),
        // Turned by a right angle, the plane is that of x = 1 with its matter beyond.
        (
            "shape = 'plane', point = [1, '2*t'], normal = [0, 1], turning = { angle = 'pi*t' }, geometry = 'updated'",
            true,
            0.5,
            [1.0, 1.0, 0.0],
        ),
        (
            "shape = 'plane', point = [0, -1], normal = [0, 1], turning = { angle = 1.5707963267948966, about = ['2*t', 0] }",
            false,
            1.5,
            [0.0, -1.0, 0.0],
        ),
    ] {
        let contact =
            parse(PAPER, &[&format!("contact.obstacle={{ {keys} }}")])?.problem.into_data().contacts.swap_remove(0);
        let obstacle = contact.obstacle.expect("an obstacle");
        let nearest = obstacle.nearest(&x, 0.5);
        assert!((nearest.distance - distance).abs() < 1e-14, "{keys}: {nearest:?}");
        assert_eq!((obstacle.updated, obstacle.place(0.5)), (updated, place), "{keys}");
    }
    assert!(parse(PAPER, &[])?.problem.contacts[0].obstacle.is_none());
    Ok(())
}
