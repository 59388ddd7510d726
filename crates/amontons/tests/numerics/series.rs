//! Derivatives of outputs at all steps: an independent program, the adjoint method, differences of whole runs.

use amontons::adjoint::{GradientError, GradientRequest, Parameter, SeriesRequest, SeriesTable, gradient, series};
use amontons::case::{self, Case, Source};

use super::gradient::{
    IN_SPACE, Overrides, TURNED, by_keys, known, output, overrides, parameter, parsed, source, unique,
};

/// The derivatives of a case at all steps.
fn at_all_steps(case: &Case, outputs: &[String], parameters: &[Parameter]) -> Result<SeriesTable, GradientError> {
    let Case { problem, probes, .. } = case;
    series(&SeriesRequest { problem, probes, outputs, parameters, interrupt: None })
}

/// The same of a text by keys.
pub(super) fn series_by_keys(text: &str, outputs: &[&str], keys: &[&str]) -> Result<SeriesTable, GradientError> {
    let source = Source::new("case", text);
    let base = parsed(&source, &[]);
    let outputs: Vec<String> = outputs.iter().map(ToString::to_string).collect();
    let parameters: Vec<Parameter> =
        keys.iter().map(|key| case::parameter(&source, &[], key).expect("a parameter")).collect();
    at_all_steps(&base, &outputs, &parameters)
}

/// Compares the last step with `gradients.csv` to 1e-8 and with the adjoint method to 1e-11, both of the larger of
/// derivative and 1e-6 times value over parameter.
fn compare(case: &str) {
    let (source, known) = (source(case), known(case));
    let outputs = unique(known.iter().map(|row| row.output.clone()));
    let names = unique(known.iter().map(|row| row.parameter.clone()));
    let made: Vec<(String, f64, Overrides)> = names
        .iter()
        .map(|name| {
            let at = known.iter().find(|row| row.parameter == *name).expect("a row").at;
            (name.clone(), at, overrides(case, name))
        })
        .collect();
    let parameters: Vec<Parameter> =
        made.iter().map(|(name, value, sets)| parameter(&source, (name, *value), sets)).collect();
    let (base, asked) = (parsed(&source, &[]), outputs.iter().map(|name| output(case, name).0).collect::<Vec<_>>());
    let found = at_all_steps(&base, &asked, &parameters).expect("a series");
    let Case { problem, probes, .. } = &base;
    let request =
        GradientRequest { problem, probes, outputs: &asked, parameters: &parameters, memory: None, interrupt: None };
    let adjoint = gradient(&request).expect("a gradient");
    assert_eq!(found.margin, adjoint.margin);
    assert_eq!((found.times.len(), found.values.len()), (found.derivatives.len(), found.times.len()));
    assert!(found.times.last().is_some_and(|t| (t - problem.timeline.end()).abs() <= 1e-12 * t));
    let (values, derivatives) = (found.values.last().expect("a step"), found.derivatives.last().expect("a step"));
    let mut worst = [0.0f64; 2];
    for row in &known {
        let i = outputs.iter().position(|name| *name == row.output).expect("an output");
        let j = names.iter().position(|name| *name == row.parameter).expect("a parameter");
        let (sign, slope) = (output(case, &row.output).1, derivatives[i][j]);
        let scale = if row.at == 0.0 { 0.0 } else { 1e-6 * (row.value / row.at).abs() };
        let scale = row.derivative.abs().max(scale);
        let errors = [slope - sign * row.derivative, slope - adjoint.derivatives[i][j]].map(|e| e.abs() / scale);
        println!("{case}: d {} / d {}: {slope:e}: {:.1e} {:.1e}", row.output, row.parameter, errors[0], errors[1]);
        worst.iter_mut().zip(errors).for_each(|(worst, error)| *worst = worst.max(error));
        assert!((values[i] - adjoint.outputs[i].1).abs() <= 1e-15 * values[i].abs(), "{}", row.output);
    }
    println!("{case}: worst {worst:?}");
    assert!(worst[0] <= 1e-8 && worst[1] <= 1e-11, "{case}: {worst:?}");
}

#[test]
fn the_last_step_agrees_with_an_independent_program_and_the_adjoint() {
    for case in ["rod", "rod-dynamic", "block-stick-slip", "paper-8", "pair", "thermal-pressure", "wear"] {
        compare(case);
    }
}

fn check_by_runs(text: &str, outputs: &[&str], keys: &[&str]) {
    check_within(4e-3, text, outputs, keys);
}

/// Compares the derivatives of a text by keys at all steps with differences of runs, relative to the largest derivative
/// of all steps: the errors fall with the square of the step, from the largest one that changes no contact state.
pub(super) fn check_within(step: f64, text: &str, outputs: &[&str], keys: &[&str]) {
    let found = series_by_keys(text, outputs, keys).expect("a series");
    let source = Source::new("case", text);
    let names: Vec<String> = outputs.iter().map(ToString::to_string).collect();
    let adjoint = by_keys(text, outputs, keys, None).expect("a gradient");
    for (j, key) in keys.iter().enumerate() {
        let at = case::parameter(&source, &[], key).expect("a parameter").value;
        let values = |value: f64| {
            at_all_steps(&parsed(&source, &[format!("{key}={value:?}")]), &names, &[]).expect("values").values
        };
        let runs =
            [step, 0.5 * step, 0.25 * step].map(|step| (step * at, [values(at - step * at), values(at + step * at)]));
        for (i, output) in outputs.iter().enumerate() {
            let number = |row: &Vec<f64>| Some(row[i]).filter(|value| !value.is_nan());
            let largest = found.derivatives.iter().fold(0.0, |most: f64, row| most.max(row[i][j].abs()));
            let value = found.values.iter().filter_map(number).fold(0.0, |most: f64, value| most.max(value.abs()));
            let scale = largest.max(1e-3 * value / at.abs());
            let errors = runs.each_ref().map(|(h, [below, above])| {
                let error = |(n, row): (usize, &Vec<Vec<f64>>)| {
                    let slope = (number(&above[n])? - number(&below[n])?) / (2.0 * h);
                    Some((slope - row[i][j]).abs() / scale)
                };
                found.derivatives.iter().enumerate().filter_map(error).fold(0.0, f64::max)
            });
            let last = found.derivatives.last().map_or(f64::NAN, |row| row[i][j]);
            let apart = (adjoint.derivatives[i][j] - last).abs() / scale;
            let [a, b, c] = errors;
            println!("{output} by {key}: {last:e}, runs {a:.1e} {b:.1e} {c:.1e}, adjoint {apart:.1e}");
            // Differences of runs have a round-off of some 1e-9.
            let falls = (a - 4.0 * b).abs() < 0.2 * b + 1e-9 && (b - 4.0 * c).abs() < 0.4 * c + 1e-9;
            assert!(c <= 1e-4 && (a <= 1e-8 || falls), "{output} by {key}: {errors:?}");
            assert!(apart <= 1e-10, "{output} by {key}: {apart:e}");
        }
    }
}

#[test]
fn differences_of_runs_approach_the_derivatives_at_all_steps() {
    let outputs = ["corner_x", "stress", "pressure", "warm", "final.contact.force.1", "energy.friction_dissipation"];
    let keys = ["material.prony[0].time", "contact.heat.exponent", "initial.velocity[1]", "mesh.blocks[0].turn.angle"];
    check_by_runs(TURNED, &outputs, &keys);
    let outputs = ["corner_z", "pressure", "final.contact.force.2"];
    check_by_runs(IN_SPACE, &outputs, &["material.elasticity.young", "contact.friction.coefficient"]);
}

/// At t = 0 a displacement and a temperature have their initial values, and what a step determines is not a number.
#[test]
fn the_first_row_is_that_of_the_initial_state() {
    let keys = ["initial.temperature", "initial.velocity[1]"];
    let outputs = ["warm", "pressure", "final.contact.force.1", "corner_y"];
    let text = TURNED.replace("displacement = [\"0.014*t\", \"-0.021*t\"]\ntemperature = 1.0", "displacement = [0, 0]");
    let found = series_by_keys(&text, &outputs, &keys).expect("a series");
    let is_near = |a: f64, b: f64| (a - b).abs() <= 1e-11;
    let (values, slopes) = (&found.values[0], &found.derivatives[0]);
    assert!(is_near(found.times[0], 0.0) && is_near(values[0], 1.0) && is_near(values[3], 0.0), "{values:?}");
    assert!(is_near(slopes[0][0], 1.0) && is_near(slopes[0][1], 0.0), "{slopes:?}");
    assert!(slopes[3].iter().all(|slope| is_near(*slope, 0.0)), "{slopes:?}");
    assert!(values[1].is_nan() && values[2].is_nan() && slopes[1][0].is_nan() && slopes[2][1].is_nan());
    assert!(found.values[1].iter().chain(found.derivatives[1].iter().flatten()).all(|value| value.is_finite()));
}

/// The line of the wear law, which BDF2 does not take.
fn wear_of(text: &str) -> String {
    text.lines().find(|line| line.starts_with("wear")).expect("wear").to_owned()
}

const OF_TURNED: [&str; 6] =
    ["corner_x", "stress", "pressure", "warm", "final.contact.force.1", "energy.friction_dissipation"];
const OF_SPACE: [&str; 4] = ["corner_x", "corner_z", "pressure", "final.contact.force.2"];

/// BDF2 adds to two states, and starts anew where a rigid foundation is hit.
#[test]
fn runs_by_bdf2_have_the_slopes_of_differences() {
    let with = |text: &str| text.replace("[time]", "[time]\nscheme = \"bdf2\"");
    let keys = ["material.elasticity.young", "material.prony[0].time", "initial.velocity[1]", "time.end"];
    check_by_runs(&with(&TURNED.replace(&wear_of(TURNED), "")), &OF_TURNED, &keys);
    check_by_runs(&with(IN_SPACE), &OF_SPACE, &["material.density", "material.elasticity.young", "mesh.size[1]"]);
}

/// Nodes in contact without mass.
#[test]
fn runs_with_redistributed_mass_have_the_slopes_of_differences() {
    let plane = source("block-stick-slip").text;
    let size = plane.lines().find(|line| line.starts_with("n = ")).expect("a mesh");
    for scheme in ["euler", "bdf2"] {
        let text = plane.replace(size, "n = [8, 6]");
        let text = text.replace("[time]", &format!("[time]\nscheme = \"{scheme}\"\nmass = \"redistributed\""));
        let outputs = ["corner_x", "pressure", "final.contact.force.0"];
        check_within(5e-4, &text, &outputs, &["material.elasticity.young", "contact.gap"]);
    }
}

/// The ϑ-scheme on layers: its equations hold within the step, with heat, wear and stress relaxation.
#[test]
fn runs_by_the_theta_scheme_have_the_slopes_of_differences() {
    for theta in ["0.5", "0.7"] {
        let text = TURNED.replace("[time]", &format!("[time]\nscheme = \"theta\"\ntheta = {theta}"));
        let text = text.replace("temperature = 1.0\n[[boundary]]", "temperature = \"1 + 0.5*t\"\n[[boundary]]");
        let keys =
            ["material.elasticity.young", "material.prony[0].time", "initial.velocity[1]", "initial.temperature"];
        check_by_runs(&text, &OF_TURNED, &keys);
    }
}

/// A support along the normal of a side that is off the axes.
#[test]
fn runs_with_supports_along_normals_have_the_slopes_of_differences() {
    let text = TURNED.replace("traction = [\"0.4*sin(2*t)\", 0.3]", "normal_displacement = \"0.002*t\"");
    check_by_runs(&text, &OF_TURNED, &["material.elasticity.young", "contact.friction.static", "time.end"]);
    let refused = series_by_keys(&text, &["corner_x"], &["mesh.blocks[0].turn.angle"]).unwrap_err().to_string();
    assert!(refused.contains("mesh.blocks[0].turn.angle: found a key that turns the directions"), "{refused}");
}

/// Phases with their own step lengths: the first without inertia, and a load and a support that end with it.
#[test]
fn runs_of_phases_have_the_slopes_of_differences() {
    let phases = "[[phase]]\nname = \"press\"\nend = 0.5\nsteps = 3\nanalysis = \"quasistatic\"\n\
                  [[phase]]\nname = \"slide\"\nend = 0.8\nsteps = 4\n\
                  [[phase]]\nname = \"on\"\nend = 1.0\nsteps = 3\n[material]";
    let text = TURNED.replace("end = 1.0\nsteps = 6\n", "").replace("[material]", phases);
    let support =
        "[[boundary]]\non = \"body_right\"\nnormal_displacement = \"0.002*t\"\nphases = [\"press\"]\n[contact]";
    let keys = ["material.elasticity.young", "material.prony[0].time", "phase[0].end", "load.body_force[1]"];
    for scheme in ["euler", "bdf2"] {
        let text = if scheme == "bdf2" { text.replace(&wear_of(&text), "") } else { text.clone() };
        let text = text.replace("[time]", &format!("[time]\nscheme = \"{scheme}\""));
        check_by_runs(&text, &OF_TURNED, &keys);
        check_by_runs(&text.replace("[contact]", support), &OF_TURNED[..4], &keys[..2]);
    }
}

/// Steps that follow from an accuracy, in a run and in phases: small changes of the data choose the same.
#[test]
fn runs_with_chosen_steps_have_the_slopes_of_differences() {
    let keys = ["material.elasticity.young", "contact.heat.exponent", "load.body_force[1]"];
    let text = TURNED.replace("steps = 6", "steps = \"auto\"\naccuracy = 0.1");
    check_within(1e-3, &text, &OF_TURNED, &keys);
    let phases = "[[phase]]\nname = \"press\"\nend = 0.5\nsteps = 3\nanalysis = \"quasistatic\"\n\
                  [[phase]]\nname = \"slide\"\nend = 1.0\nsteps = \"auto\"\naccuracy = 0.1\n[material]";
    let text = TURNED.replace("end = 1.0\nsteps = 6\n", "scheme = \"theta\"\n").replace("[material]", phases);
    check_within(1e-3, &text, &OF_TURNED[..4], &["material.elasticity.young", "phase[0].end"]);
    let found = series_by_keys(&text, &OF_TURNED[..1], &["phase[1].accuracy"]).unwrap_err().to_string();
    assert!(found.contains("phase[1].accuracy: found a key that changes how steps are chosen"), "{found}");
}

/// A stiff block on a spring k is pulled by F = 4t against the friction of N = 10: u = max(0, (F − μN)/k), k = 100.
const PULLED: &str = r#"
name = "pulled"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [1.0, 0.1]
n = [2, 1]
diagonal = "right"
[time]
end = 1.0
steps = 7
inertia = false
[material]
elasticity = { law = "isotropic", young = 1e9, poisson = 0.0, stress_state = "plane-strain" }
[[boundary]]
on = "top"
traction = ["4*t", -10.0]
[[boundary]]
on = "left"
spring = [1000.0, 0.0]
[contact]
on = "bottom"
gap = 0.0
normal = { law = "signorini" }
friction = { law = "coulomb", coefficient = 0.3 }
[[probe]]
name = "block"
quantity = "displacement"
at = [0.5, 0.0]
"#;

/// Before the block slips nothing depends on the friction; then ∂u/∂μ = −N/k, and ∂u/∂k = −u/k.
#[test]
fn a_pulled_block_depends_on_the_friction_once_it_slips() {
    let keys = ["contact.friction.coefficient", "boundary[1].spring[0]"];
    let found = series_by_keys(PULLED, &["block_x"], &keys).expect("a series");
    for (n, t) in found.times.iter().enumerate() {
        let u = (0.04 * t - 0.03).max(0.0);
        let by_friction = if u > 0.0 { -0.1 } else { 0.0 };
        let (value, slopes) = (found.values[n][0], &found.derivatives[n][0]);
        assert!((value - u).abs() <= 1e-8, "{value} {u}");
        assert!((slopes[0] - by_friction).abs() <= 1e-7, "step {n}: {} {by_friction}", slopes[0]);
        assert!((slopes[1] + u / 1000.0).abs() <= 1e-11, "step {n}: {} {}", slopes[1], -u / 1000.0);
    }
    assert!(found.values[5][0].abs() <= 1e-8 && found.values[6][0] > 4e-3);
}
