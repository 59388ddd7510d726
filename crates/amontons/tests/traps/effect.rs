//! Data that change nothing, friction that nothing slows down, stresses that cells do not resolve, and steps that take
//! too much: each with cases that give cause for a word and cases beside them that do not.

use crate::{BLOCK, no_word, problem, solved, told, warns};
use amontons::hypotheses::warnings::{Figures, of_run};
use amontons::hypotheses::{Finding, findings};
use amontons::output::{Final, Summary};
use amontons::run::{Settings, run};

fn of(summary: &Summary, id: &str) -> Option<Finding> {
    summary.warnings.iter().find(|finding| finding.id.as_str() == id).cloned()
}

/// Places that a case names as without effect.
fn idle(more: &[&str]) -> Vec<String> {
    let all = findings(&problem(BLOCK, more)).into_iter().filter(|finding| finding.id.as_str() == "no-effect");
    all.map(|finding| finding.place).collect()
}

const HEATED: &str = "contact.heat={ law = \"constant\", conductance = 1.0, foundation_temperature = 1.0 }";

/// Data that change nothing are told of, and change no more than what the iteration leaves.
#[test]
fn data_without_effect() {
    let no_friction = "contact.friction={ law = \"none\" }";
    let smooth = "contact.friction.coefficient=0";
    let cases: [(&[&str], &str, &str); 7] = [
        (&["material.density=0"], "initial.velocity=[1, 0]", "initial.velocity"),
        (&["time.inertia=false"], "initial.velocity=[0, 1]", "initial.velocity"),
        (&[no_friction], "contact.foundation_velocity=[1, 0]", "contact.foundation_velocity"),
        (&[smooth], "contact.foundation_velocity=[\"t\", 0]", "contact.foundation_velocity"),
        (&[no_friction, HEATED], "contact.frictional_heat=0.5", "contact.frictional_heat"),
        (&[no_friction], "contact.frictional_heat=0.5", "contact.frictional_heat"),
        (&[smooth], "contact.frictional_heat=1", "contact.frictional_heat"),
    ];
    for (base, datum, place) in cases {
        let with = [base, &[datum]].concat();
        assert_eq!(idle(&with), [place], "{with:?}");
        assert!(idle(base).is_empty(), "{base:?}");
        let [with, without] = [&with[..], base].map(|more| solved(BLOCK, more).last);
        let largest = |last: &Final| last.displacement_max.iter().chain(&last.displacement_min).copied().collect();
        let [with, without]: [Vec<f64>; 2] = [&with, &without].map(largest);
        assert!(with.iter().zip(&without).all(|(a, b)| (a - b).abs() <= 1e-8 * b.abs().max(1e-6)), "{datum}");
    }
}

/// The same data where they count: nothing is told of.
#[test]
fn data_with_effect() {
    let no_friction = "contact.friction={ law = \"none\" }";
    let wears = "contact.wear={ law = \"archard\", coefficient = 1e-9 }";
    let counting: [&[&str]; 8] = [
        &["initial.velocity=[1, 0]"],
        &["material.density=1e-9", "initial.velocity=[1, 0]"],
        &["material.density=0", "initial.velocity=[0, 0]"],
        &["contact.foundation_velocity=[1, 0]"],
        &["contact.foundation_velocity=[0, 0]", no_friction],
        &["contact.frictional_heat=0.5"],
        &[no_friction, "contact.foundation_velocity=[1, 0]", wears],
        &[HEATED],
    ];
    for more in counting {
        assert_eq!(idle(more), Vec::<String>::new(), "{more:?}");
    }
}

#[test]
fn friction_that_nothing_slows_down() {
    let friction =
        |more: &str| format!("contact.friction={{ law = \"static-kinetic\", static = 0.4, kinetic = 0.2{more} }}");
    let still = ["material.density=0", "material.viscosity={ law = \"lame\", first = 0.0, second = 0.0 }"];
    let of = |law: &str, more: &[&str]| told(&problem(BLOCK, &[&[law], more].concat()), "static-friction");
    let drops = friction("");
    assert_eq!(warns(of(&drops, &still), "contact.friction"), [0.0, 1.0]);
    assert_eq!(warns(of(&drops, &[still[1], "time.inertia=false"]), "contact.friction"), [0.0, 1.0]);
    no_word(of(&drops, &[]));
    no_word(of(&drops, &still[..1]));
    no_word(of(&drops, &still[1..]));
    no_word(of(&friction(", decay_speed = 0.1"), &still));
    no_word(of("contact.friction={ law = \"static-kinetic\", static = 0.3, kinetic = 0.3 }", &still));
    no_word(of("contact.friction={ law = \"coulomb\", coefficient = 0.3 }", &still));
}

/// A block that is pressed evenly or bent is resolved, and so is what round-off makes of an expansion that is free. The
/// end of a contact that is peeled, and a beam of few cells, are not.
#[test]
fn stresses_that_cells_do_not_resolve() {
    let text = BLOCK.replace("heat_capacity = 1.0\nconductivity = 1.0\n", "").replace("temperature = 0\n", "");
    let run = |top: &str| {
        let top = format!("boundary=[{{ on = \"top\", displacement = {top} }}]");
        solved(&text, &[&top, "load.body_force=[0, 0]", "contact.friction.coefficient=0"])
    };
    no_word(of(&run("[\"free\", -1e-3]"), "nodal-stress"));
    no_word(of(&run("[0, \"-1e-3*(1 + 0.3*x)\"]"), "nodal-stress"));
    no_word(of(&run("[0, \"1e-3 + 1e-4*x\"]"), "nodal-stress"));
    no_word(of(&solved(include_str!("../../benchmarks/thermal-expansion-rod.toml"), &[]), "nodal-stress"));
    for text in
        [include_str!("../../benchmarks/peel-moment.toml"), include_str!("../../benchmarks/beam-tensionless.toml")]
    {
        let [ratio, limit] = warns(of(&solved(text, &[]), "nodal-stress"), "mesh");
        assert!(ratio > 2.0 && limit == 1.5, "{ratio}");
    }
}

/// Steps of forty systems with 2000 unknowns, of which three were predicted, are told of; few, cheap ones, and steps as
/// predicted are not.
#[test]
fn steps_that_take_many_systems() {
    let problem = problem(BLOCK, &[]);
    let told = |systems: [usize; 2], steps: usize| {
        let figures = Figures {
            strain: 0.0,
            strain_at: [0.0; 3],
            temperature: [0.0; 2],
            outside: [None; 2],
            penetration: None,
            loose: Vec::new(),
            steps,
            contact_steps: steps,
            reversed_steps: 0,
            leak: None,
            few: None,
            scheme: [0.0; 3],
            impacts: 0.0,
            von_mises: 0.0,
            recovered: None,
            stiff: 0.0,
            systems,
            misfits: Vec::new(),
        };
        of_run(&problem, &figures).into_iter().find(|finding| finding.id.as_str() == "many-systems")
    };
    assert_eq!(warns(told([4080, 2000], 1), "time.steps"), [4080.0, 30.0]);
    assert_eq!(warns(told([400, 2000], 10), "time.steps"), [40.0, 30.0]);
    no_word(told([400, 200], 10));
    no_word(told([300, 2000], 10));
    no_word(told([0, 2000], 0));
}

/// Whoever watches a run is told of the iterations of its present step and of the attempts at it.
#[test]
fn a_step_tells_where_it_is() {
    let settings = Settings { certificate: false, ..Settings::default() };
    run(&problem(BLOCK, &[]), &settings, &mut []).expect("a run");
    assert!(settings.pulse.iterations() > 0 && settings.pulse.parts() == 1, "{:?}", settings.pulse);
}
