//! Warnings of what a run came to, and of numbers that no material has: each with cases that give cause for it and
//! cases beside them that do not.

use crate::{BLOCK, no_word, problem, solved, told, warns};
use amontons::hypotheses::Finding;
use amontons::output::Summary;

fn of(summary: &Summary, id: &str) -> Option<Finding> {
    summary.warnings.iter().find(|finding| finding.id.as_str() == id).cloned()
}

const MECHANICS: [&str; 2] = ["boundary=[{ on = \"top\", displacement = [0, -1e-3] }]", "load.body_force=[0, 0]"];

fn block(more: &[&str]) -> Summary {
    // Without the keys of heat it is a case of mechanics.
    let text = BLOCK.replace("heat_capacity = 1.0\nconductivity = 1.0\n", "").replace("temperature = 0\n", "");
    solved(&text, &[&MECHANICS, more].concat())
}

#[test]
fn contacts_that_never_press() {
    for more in [
        &["contact.gap=0.5"][..],
        &["boundary=[{ on = \"top\", displacement = [0, 1e-3] }]"],
        &["contact.gap=0.5", "contact.normal={ law = \"signorini\" }"],
    ] {
        let [steps, least] = warns(of(&block(more), "no-contact"), "contact");
        assert_eq!([steps, least], [0.0, 1.0], "{more:?}");
    }
    // A foundation that holds the block, which is pulled.
    let pulled = "boundary=[{ on = \"top\", displacement = [0, 1e-3] }]";
    let holds = "contact.normal={ law = \"bilateral\" }";
    // With friction and without: then it bears by its tension alone.
    for friction in [0.2, 0.0] {
        let friction = format!("contact.friction.coefficient={friction}");
        no_word(of(&block(&[pulled, holds, &friction]), "no-contact"));
        no_word(of(&block(&[pulled, holds, &friction]), "few-points"));
    }
    // Pressed at first only, pressed at the end only, and a gap that heat crosses.
    for more in [
        &[][..],
        &["boundary=[{ on = \"top\", displacement = [0, \"if(t < 0.3, -1e-3, 1e-3)\"] }]"],
        &["boundary=[{ on = \"top\", displacement = [0, \"if(t < 0.9, 1e-3, -1e-3)\"] }]"],
    ] {
        no_word(of(&block(more), "no-contact"));
    }
    no_word(of(&solved(BLOCK, &["contact.gap=0.5", "load.body_force=[0, 0]"]), "no-contact"));
}

/// A parabola pressed into the block: of 5, 9 and 65 points some press.
#[test]
fn contacts_that_few_points_bear() {
    let pressed = |n: usize, gap: &str| {
        let mesh = format!("mesh={{ kind = \"rectangle\", size = [2.0, 1.0], n = [{n}, 4] }}");
        block(&[&mesh, &format!("contact.gap={gap}"), "contact.normal={ law = \"signorini\" }"])
    };
    let parabola = "\"0.01*(x - 1)^2\"";
    for n in [4, 8] {
        let [points, limit] = warns(of(&pressed(n, parabola), "few-points"), "mesh");
        assert!(points < 4.0 && limit == 4.0, "{points}");
    }
    no_word(of(&pressed(64, parabola), "few-points"));
    // All of a coarse side, and none of it.
    no_word(of(&pressed(2, "0"), "few-points"));
    no_word(of(&pressed(2, "0.5"), "few-points"));
}

/// A bar that rebounds from a wall loses a quarter of its energy to the scheme; a slow process of few steps, in which
/// the scheme takes half of the work, loses nothing.
#[test]
fn energy_that_the_scheme_takes() {
    let text = include_str!("../reference/field/k17-bar-impact.toml");
    let [share, limit] = warns(of(&solved(text, &[]), "scheme-share"), "time.steps");
    assert!((share - 0.24).abs() < 0.03 && limit == 0.02, "{share}");
    for density in ["0", "1e-3"] {
        no_word(of(&block(&["time.steps=1", &format!("material.density={density}")]), "scheme-share"));
    }
}

/// A rod without inertia and viscosity that starts inside its foundation: at ϑ = ½ it alternates about its motion in
/// all steps, and its wear has a limit that is wrong. With backward Euler, or pressed on from nothing, it does not.
#[test]
fn motions_that_alternate_from_step_to_step() {
    let text = include_str!("../../benchmarks/wear-relaxation-compliance.toml");
    let run = |more: &[&str]| of(&solved(text, &[&["time.steps=40"], more].concat()), "alternation");
    let [share, limit] = warns(run(&["time.scheme=theta"]), "time");
    assert!(share > 0.9 && limit == 0.25, "{share}");
    no_word(run(&[]));
    no_word(run(&["time.scheme=theta", "contact.gap=\"-0.02*t\""]));
    // Of a body at rest the round-off of the velocity changes its sign in 434 of 1000 steps.
    let at_rest = include_str!("../../benchmarks/foundation-surroundings.toml");
    no_word(of(&solved(at_rest, &[]), "alternation"));
    // Scaled in length, stiffness and time.
    for more in [
        &["mesh.size=[1e-3, 5e-4]", "contact.gap=-1e-4", "contact.normal.stiffness=3e3"][..],
        &["material.elasticity.young=2e11", "contact.normal.stiffness=3e11"],
        &["time.end=5e-6", "contact.foundation_velocity=[0, 3e6]"],
    ] {
        let [share, _] = warns(run(&[&["time.scheme=theta"], more].concat()), "time");
        assert!(share > 0.9, "{more:?}: {share}");
    }
}

/// Of all materials of the library none is told; each with its modulus in MPa is, and so is each with its density in
/// t/mm³. Rubber and gel are soft and light.
#[test]
fn moduli_and_densities_that_no_material_has() {
    let set = |young: f64, density: f64| {
        let young = format!("material.elasticity.young={young:e}");
        told(&problem(BLOCK, &[&young, &format!("material.density={density:e}")]), "magnitude")
    };
    for (young, density) in [(70e9, 2700.0), (110e9, 7200.0), (210e9, 7850.0), (34e9, 2447.0), (120e9, 8900.0)] {
        no_word(set(young, density));
        let [speed, limit] = warns(set(young / 1e6, density), "material.elasticity");
        assert!(speed < limit && limit == 30.0, "{speed}");
        let [speed, limit] = warns(set(young, 1e-12 * density), "material.elasticity");
        assert!(speed > limit && limit == 3e4, "{speed}");
    }
    for (young, density) in [(1e6, 1100.0), (1e3, 1000.0), (3e9, 1050.0), (1e12, 3500.0), (16e9, 11340.0), (1e5, 60.0)]
    {
        no_word(set(young, density));
    }
}

/// What is computed with where there is a choice is told: the scheme, the side of the points and why, the stress state
/// that a file decides.
#[test]
fn choices_are_told() {
    let told = |summary: &Summary| -> Vec<String> {
        summary.choices.iter().map(|choice| format!("{} {}: {}", choice.what, choice.value, choice.why)).collect()
    };
    let alone = told(&block(&[]));
    assert!(
        alone[0].starts_with("scheme backward Euler") && !alone.iter().any(|row| row.contains("nonmortar")),
        "{alone:?}"
    );
    let pair = include_str!("../reference/field/foot-plane.toml");
    let summary = solved(pair, &[]);
    let rows = told(&summary);
    assert!(rows.iter().any(|row| row.starts_with("contact.nonmortar ")), "{rows:?}");
    let shown = summary.rows();
    let first = shown.iter().position(|(name, _)| name == "computed with").expect("a row");
    assert_eq!(shown[0].0, "contact", "what was asked for comes first");
    assert!(shown[first..].iter().any(|(_, text)| text.starts_with("contact.nonmortar ")), "{shown:?}");
    assert!(!told(&solved(pair, &["contact.nonmortar=\"foot_bottom\""])).iter().any(|row| row.contains("nonmortar")));
}

/// The moment of the contact about the origin is that of its force at the centre of pressure, where nothing rubs.
#[test]
fn contact_has_a_moment_about_the_origin() {
    let contact = block(&["contact.friction.coefficient=0"]).last.contact.expect("contact");
    let moment = contact.moment_about_origin.expect("a moment");
    let expected = contact.center[0] * contact.force[1] - contact.center[1] * contact.force[0];
    assert!(moment.len() == 1 && expected != 0.0, "{moment:?}");
    assert!((moment[0] / expected - 1.0).abs() < 1e-12, "{moment:?}, {expected:e}");
}
