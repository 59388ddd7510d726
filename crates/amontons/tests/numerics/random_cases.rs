//! Derivatives of small cases that look random, at all steps, held to differences of whole runs.

use std::fmt::Write as _;

use amontons::adjoint::{GradientError, GradientRequest, Parameter, SeriesRequest, SeriesTable, gradient, series};
use amontons::case::{self, Case, Source};
use amontons::contact::Status;
use amontons::output::Memory;
use amontons::run::{Settings, run};

use super::common::Random;
use super::gradient::parsed;

/// Choices that look random, from a seed.
struct Dice(Random);

impl Dice {
    /// A number in (low, high).
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * 0.5 * (1.0 + self.0.number())
    }

    fn one<'a>(&mut self, of: &[&'a str]) -> &'a str {
        of[self.between(0.0, of.len() as f64) as usize % of.len()]
    }
}

/// A rotation by an angle about an axis of length 1.
fn rotation(axis: [f64; 3], angle: f64) -> [[f64; 3]; 3] {
    let (s, c) = angle.sin_cos();
    let [x, y, z] = axis;
    let cross = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let own = if i == j { c } else { 0.0 };
            own + s * cross[i][j] + (1.0 - c) * axis[i] * axis[j]
        })
    })
}

/// A body on a rigid foundation, or on another body, turned off the axes.
struct Turned {
    dim: usize,
    rows: [[f64; 3]; 3],
    turn: String,
}

impl Turned {
    fn new(dice: &mut Dice, dim: usize) -> Turned {
        let angle = dice.between(0.2, 1.2);
        if dim == 2 {
            return Turned { dim, rows: rotation([0.0, 0.0, 1.0], angle), turn: format!("{{ angle = {angle:?} }}") };
        }
        let axis: [f64; 3] = std::array::from_fn(|_| dice.between(0.2, 1.0));
        let size = axis.iter().map(|a| a * a).sum::<f64>().sqrt();
        let axis = axis.map(|a| a / size);
        Turned { dim, rows: rotation(axis, angle), turn: format!("{{ angle = {angle:?}, axis = {axis:?} }}") }
    }

    /// A position, or a constant vector.
    fn vector(&self, v: [f64; 3]) -> String {
        let at = |i: usize| -> f64 { (0..3).map(|j| self.rows[i][j] * v[j]).sum() };
        format!("{:?}", (0..self.dim).map(at).collect::<Vec<f64>>())
    }

    /// A vector of expressions.
    fn expressions(&self, v: [&str; 3]) -> String {
        let at = |i: usize| {
            let terms: Vec<String> = (0..self.dim).map(|j| format!("({:?})*({})", self.rows[i][j], v[j])).collect();
            format!("\"{}\"", terms.join(" + "))
        };
        format!("[{}]", (0..self.dim).map(at).collect::<Vec<String>>().join(", "))
    }
}

/// The laws of a contact, and a key of them.
fn laws(dice: &mut Dice, is_pair: bool, has_heat: bool) -> (String, &'static str) {
    let normal = dice.one(&[
        "{ law = \"signorini\" }",
        "{ law = \"compliance\", stiffness = 800.0 }",
        "{ law = \"power\", stiffness = 9000.0, exponent = 1.4 }",
        "{ law = \"damped\", stiffness = 900.0, damping = 6.0 }",
    ]);
    let all = [
        ("{ law = \"coulomb\", coefficient = 0.3 }", "contact.friction.coefficient"),
        ("{ law = \"static-kinetic\", static = 0.4, kinetic = 0.3, decay_speed = 0.2 }", "contact.friction.kinetic"),
        ("{ law = \"tresca\", bound = 0.05 }", "contact.friction.bound"),
        ("{ law = \"expression\", coefficient = \"0.2 + 0.1*exp(-v/0.3)\", factor = 1.1 }", "contact.friction.factor"),
    ];
    let (friction, key) = all[dice.between(0.0, 4.0) as usize % 4];
    let mut text = format!("normal = {normal}\nfriction = {friction}\n");
    if has_heat {
        let foundation = if is_pair { "" } else { ", foundation_temperature = 2.0" };
        let _ = writeln!(text, "frictional_heat = 0.6");
        let _ = writeln!(text, "heat = {{ law = \"pressure\", coefficient = 0.6, exponent = 0.95{foundation} }}");
    }
    if !is_pair && dice.between(0.0, 1.0) < 0.4 {
        text += "wear = { law = \"archard\", coefficient = 0.002 }\n";
    }
    (text, key)
}

/// The text of a case, with its outputs and keys.
fn made(seed: u64) -> (String, Vec<String>, Vec<String>) {
    let mut dice = Dice(Random(0x9e37_79b9_7f4a_7c15 + seed));
    (0..8).for_each(|_| _ = dice.between(0.0, 1.0));
    let (dim, is_pair, has_heat) = (if seed % 4 == 3 { 3 } else { 2 }, seed % 3 == 1, dice.between(0.0, 1.0) < 0.5);
    let turned = Turned::new(&mut dice, dim);
    let solid = |size: [f64; 3], n: [usize; 3]| format!("size = {:?}, n = {:?}", &size[..dim], &n[..dim]);
    let (upper, counts) = ([1.0, 0.5, 0.4], if dim == 2 { [4, 2, 1] } else { [2, 1, 1] });
    let body = format!("{{ name = \"body\", {}, turn = {}", solid(upper, counts), turned.turn);
    let base = format!("{{ name = \"base\", {}, turn = {} }}", solid([1.2, 0.4, 0.6], [3, 1, 1]), turned.turn);
    let (blocks, on) = if is_pair {
        let origin = turned.vector([0.1, 0.4, 0.1]);
        (format!("[{base}, {body}, origin = {origin} }}]"), "base_top")
    } else {
        (format!("[{body} }}]"), "body_bottom")
    };
    let stress_state = if dim == 2 { ", stress_state = \"plane-strain\"" } else { "" };
    let physics =
        if has_heat { "heat_capacity = 2.0\nexpansion = 0.4\ncoupling = 0.2\nconductivity = 0.8\n" } else { "" };
    let prony = if dice.between(0.0, 1.0) < 0.4 { "prony = [{ ratio = 0.3, time = 0.4 }]\n" } else { "" };
    let (shear, press) = (dice.between(0.01, 0.03), dice.between(0.012, 0.03));
    let moved = [format!("{shear:?}*sin(3*t)"), format!("-{press:?}*t"), format!("{:?}*t*t", 0.5 * shear)];
    let moved = turned.expressions([&moved[0], &moved[1], &moved[2]]);
    let (contact, key) = laws(&mut dice, is_pair, has_heat);
    let warm = if has_heat { "temperature = 1.0\n" } else { "" };
    let mut text = format!(
        "name = \"random\"\nunits = \"dimensionless\"\n[mesh]\nkind = \"blocks\"\nblocks = {blocks}\n[time]\n\
         end = 1.0\nsteps = 6\n[material]\ndensity = {:?}\n{physics}\
         elasticity = {{ law = \"isotropic\", young = {:?}, poisson = 0.3{stress_state} }}\nviscosity = {{ law = \"lame\", first = 0.2, second = 0.5 }}\n{prony}\
         [[boundary]]\non = \"body_top\"\ndisplacement = {moved}\n{warm}",
        dice.between(0.5, 1.5),
        dice.between(40.0, 120.0)
    );
    if is_pair {
        let still = turned.vector([0.0; 3]);
        let _ = write!(text, "[[boundary]]\non = \"base_bottom\"\ndisplacement = {still}\n{warm}");
    }
    // Some points touch at once, others close during the run, or stay open.
    let gap = dice.between(0.0005, 0.012);
    let _ = write!(text, "[contact]\non = \"{on}\"\ngap = {gap:?}\n{contact}");
    if is_pair {
        text += "with = \"body_bottom\"\nnonmortar = \"body_bottom\"\ngeometry = \"reference\"\n";
    }
    if has_heat {
        text += "[initial]\ntemperature = 1.0\n";
    }
    let seen = if is_pair { [0.8, 0.6, 0.3] } else { [0.7, 0.2, 0.2] };
    let _ = write!(text, "[[probe]]\nname = \"seen\"\nquantity = \"displacement\"\nat = {}\n", turned.vector(seen));
    let _ =
        write!(text, "[[probe]]\nname = \"pressure\"\nquantity = \"pressure\"\non = \"{on}\"\ntake = \"integral\"\n");
    let mut outputs = vec!["seen_x", "seen_y", "pressure", "final.contact.force.0", "energy.friction_dissipation"];
    if has_heat {
        let _ =
            write!(text, "[[probe]]\nname = \"warm\"\nquantity = \"temperature\"\non = \"{on}\"\ntake = \"mean\"\n");
        outputs.push("warm");
    }
    let keys = [key, "material.elasticity.young", "contact.gap", "material.density"];
    (text, outputs.into_iter().map(String::from).collect(), keys.iter().map(ToString::to_string).collect())
}

/// The same of a body that is not linear, changes with its temperature, or is coupled at once.
fn varied(seed: u64) -> (String, Vec<String>, Vec<String>) {
    let (mut text, outputs, mut keys) = made(seed);
    let mut dice = Dice(Random(0x5851_f42d_4c95_7f2d ^ seed));
    (0..8).for_each(|_| _ = dice.between(0.0, 1.0));
    let has_heat = text.contains("heat_capacity");
    let without_branches: Vec<&str> = text.lines().filter(|line| !line.starts_with("prony")).collect();
    if !has_heat || dice.between(0.0, 1.0) < 0.4 {
        let hencky = "elasticity = { law = \"hencky\", bulk = 70.0, shear = 35.0, shear_infinite = 15.0, strain = 0.01, \
                      exponent = 0.5";
        let end = |line: &str| line.find(", stress_state").map_or(" }".to_owned(), |at| line[at..].to_owned());
        let of = |line: &&str| {
            if line.starts_with("elasticity") { format!("{hencky}{}", end(line)) } else { (*line).to_owned() }
        };
        text = without_branches.iter().map(of).collect::<Vec<String>>().join("\n") + "\n";
        "material.elasticity.shear".clone_into(&mut keys[1]);
    }
    if has_heat {
        let table = |low: f64, high: f64| format!("{{ temperature = [-10.0, 20.0], value = [{low}, {high}] }}");
        let tables =
            [("heat_capacity = 2.0", 1.0, 4.0), ("expansion = 0.4", 0.2, 0.9), ("conductivity = 0.8", 0.4, 1.8)];
        for (number, low, high) in tables {
            if dice.between(0.0, 1.0) < 0.7 {
                let key = &number[..number.find(" =").unwrap_or(0)];
                text = text.replace(number, &format!("{key} = {}", table(low, high)));
            }
        }
        let coupling = dice.one(&["staggered", "monolithic", "fixed-point"]);
        let _ = write!(text, "[scheme]\ncoupling = \"{coupling}\"\n");
    }
    (text, outputs, keys)
}

/// The same with an obstacle that a force presses on the body from below, which may warm, and with wear of pairs.
fn driven(seed: u64) -> (String, Vec<String>, Vec<String>) {
    let (mut text, outputs, mut keys) = made(seed);
    let mut dice = Dice(Random(0x2545_f491_4f6c_dd1d ^ seed));
    (0..8).for_each(|_| _ = dice.between(0.0, 1.0));
    if text.contains("nonmortar") {
        let fraction = dice.between(0.1, 0.9);
        let wear = format!("wear = {{ law = \"archard\", coefficient = 0.02, fraction = {fraction:?} }}");
        text = text.replacen("[contact]\n", &format!("[contact]\n{wear}\n"), 1);
        keys.extend(["contact.wear.coefficient".to_owned(), "contact.wear.fraction".to_owned()]);
        return (text, outputs, keys);
    }
    let dim = if text.contains("stress_state") { 2 } else { 3 };
    // The turn of the body is the first that a seed makes.
    let mut of_turn = Dice(Random(0x9e37_79b9_7f4a_7c15 + seed));
    (0..9).for_each(|_| _ = of_turn.between(0.0, 1.0));
    let turned = Turned::new(&mut of_turn, dim);
    let radius = dice.between(2.0, 6.0);
    let center = turned.vector([dice.between(0.3, 0.7), 0.0 - radius, 0.2]);
    let direction = turned.vector([dice.between(-0.2, 0.2), 1.0, if dim == 3 { 0.1 } else { 0.0 }]);
    let (force, mass) = (dice.between(0.2, 0.6), dice.one(&["", ", mass = 0.7"]));
    let area = if dim == 2 { 1.0 } else { 0.4 };
    let obstacle = format!(
        "obstacle = {{ shape = \"sphere\", center = {center}, radius = {radius:?}, load = {{ force = \"press*(0.2 + t)\", \
         direction = {direction}{mass} }} }}\n"
    );
    let foundation = if text.contains("heat_capacity") {
        keys.push("contact.foundation.heat_capacity".to_owned());
        "foundation = { heat_capacity = 0.2, exchange = 0.3, surroundings = 1.5 }\n"
    } else {
        ""
    };
    text = text.replacen("[contact]\n", &format!("[contact]\n{obstacle}{foundation}"), 1);
    text = text.replacen("[mesh]\n", &format!("[constants]\npress = {:?}\n[mesh]\n", area * force), 1);
    keys.push("constants.press".to_owned());
    (text, outputs, keys)
}

/// The outputs at all steps, and the status of all contact points.
fn values(source: &Source, outputs: &[String], set: &str) -> (Vec<Vec<f64>>, Vec<Status>) {
    let case = parsed(source, &[set.to_owned()]);
    let Case { problem, probes, .. } = &case;
    let made = series(&SeriesRequest { problem, probes, outputs, parameters: &[], interrupt: None }).expect("values");
    let mut memory = Memory::new().reports();
    run(problem, &Settings::default(), &mut [&mut memory]).expect("a run");
    let status = memory.reports.iter().flat_map(|report| report.contact.states.iter().map(|state| state.status));
    (made.values, status.collect())
}

/// The errors of a derivative at all steps, relative to its largest size over all steps.
fn errors(found: &[f64], [below, above]: [&[f64]; 2], h: f64, scale: f64) -> f64 {
    let of = |((found, below), above): ((&f64, &f64), &f64)| ((above - below) / (2.0 * h) - found).abs() / scale;
    found.iter().zip(below).zip(above).map(of).filter(|error| !error.is_nan()).fold(0.0, f64::max)
}

/// A derivative at all steps beside central differences of runs over h, h/2 and h/4.
struct Compared {
    /// Errors relative to the scale, and the round-off of the last difference.
    errors: [f64; 3],
    rounded: f64,
    /// The largest derivative of all steps.
    scale: f64,
}

impl Compared {
    fn new(
        (found, (i, j)): (&SeriesTable, (usize, usize)),
        value: f64,
        h: f64,
        runs: &[[(Vec<Vec<f64>>, Vec<Status>); 2]; 3],
    ) -> Compared {
        let slopes: Vec<f64> = found.derivatives.iter().map(|row| row[i][j]).collect();
        let all = |values: &[Vec<f64>]| -> Vec<f64> { values.iter().map(|row| row[i]).collect() };
        let most = |of: &[f64]| of.iter().filter(|v| !v.is_nan()).fold(0.0f64, |most, v| most.max(v.abs()));
        let size = most(&all(&found.values)) / value.abs();
        let scale = most(&slopes).max(1e-3 * size);
        let error = |k: usize, h: f64| {
            let [low, high] = &runs[k];
            errors(&slopes, [&all(&low.0), &all(&high.0)], h, scale)
        };
        // Round-off of a difference of runs whose residuals are at most 1e-13 of their terms.
        let rounded = 1e-12 * size * value / (0.25 * h * scale);
        Compared { errors: [error(0, h), error(1, 0.5 * h), error(2, 0.25 * h)], rounded, scale }
    }

    /// True if the error is small and round-off, or falls with the square of the difference.
    fn is_met(&self) -> bool {
        let [_, coarse, fine] = self.errors;
        fine <= 1e-3 && (fine <= self.rounded || (coarse / fine - 4.0).abs() < 0.2)
    }
}

/// What was counted over all cases: derivatives, keys whose differences change a state, and statuses.
#[derive(Default)]
struct Counts {
    checked: usize,
    changed: usize,
    /// Open, stick and slip.
    seen: [usize; 3],
}

/// Compares the derivatives of a case by both methods with differences of runs; returns what is wrong.
fn wrong(
    seed: u64,
    (text, outputs, keys): (String, Vec<String>, Vec<String>),
    counts: &mut Counts,
) -> Result<Vec<String>, GradientError> {
    let source = Source::new("random", text);
    let case = parsed(&source, &[]);
    let parameter = |key: &String| case::parameter(&source, &[], key).expect("a parameter");
    let (outputs, parameters) = (&outputs, &keys.iter().map(parameter).collect::<Vec<Parameter>>());
    let Case { problem, probes, .. } = &case;
    let found = series(&SeriesRequest { problem, probes, outputs, parameters, interrupt: None })?;
    let request = GradientRequest { problem, probes, outputs, parameters, memory: None, interrupt: None };
    let (adjoint, mut wrong) = (gradient(&request)?, Vec::new());
    if found.ties > 0 || found.margin != adjoint.margin {
        wrong.push(format!("{seed}: ties {}, margins {:?} {:?}", found.ties, found.margin, adjoint.margin));
    }
    let here = values(&source, outputs, &format!("{}={:?}", keys[0], parameters[0].value)).1;
    let all = [Status::Open, Status::Stick, Status::Slip];
    let number = |one: Status| here.iter().filter(|status| **status == one).count();
    counts.seen.iter_mut().zip(all).for_each(|(seen, one)| *seen += number(one));
    for (j, (key, parameter)) in keys.iter().zip(parameters).enumerate() {
        let at = |h: f64| values(&source, outputs, &format!("{key}={:?}", parameter.value + h));
        let mut compared: Option<Vec<Compared>> = None;
        for step in [4e-3, 2.5e-4, 1.5625e-5] {
            let h = step * parameter.value;
            let all = [h, 0.5 * h, 0.25 * h].map(|h| [at(0.0 - h), at(h)]);
            // A law that bends, such as a power of a small penetration, has its order at smaller differences.
            let is_met = compared.as_ref().is_some_and(|all| all.iter().all(Compared::is_met));
            if !is_met && all.iter().flatten().all(|(_, status)| *status == here) {
                let of = |i: usize| Compared::new((&found, (i, j)), parameter.value, h, &all);
                compared = Some((0..outputs.len()).map(of).collect());
            }
        }
        counts.changed += usize::from(compared.is_none());
        for (i, compared) in compared.iter().flatten().enumerate() {
            let last = found.derivatives.last().map_or(f64::NAN, |row| row[i][j]);
            let apart = (last - adjoint.derivatives[i][j]).abs() / compared.scale;
            let output = &outputs[i];
            println!("{seed} {output} by {key}: {last:e}, runs {:?}, adjoint {apart:.1e}", compared.errors);
            if !compared.is_met() || apart > 1e-10 {
                wrong.push(format!("{seed}: {output} by {key}: {:?}, adjoint {apart:e}", compared.errors));
            }
            counts.checked += 1;
        }
    }
    Ok(wrong)
}

/// Checks cases of these seeds.
fn check(seeds: std::ops::Range<u64>, of: fn(u64) -> (String, Vec<String>, Vec<String>), least: usize) {
    let mut counts = Counts::default();
    let told = |seed: u64, error: GradientError| vec![format!("{seed}: {error}")];
    let all = seeds.flat_map(|seed| wrong(seed, of(seed), &mut counts).unwrap_or_else(|error| told(seed, error)));
    let wrong: Vec<String> = all.collect();
    let Counts { checked, changed, seen } = counts;
    println!("checked {checked}, changed {changed}, open, stick, slip {seen:?}");
    assert!(wrong.is_empty(), "{wrong:#?}");
    let all: usize = seen.iter().sum();
    let is_mixed = seen.iter().all(|seen| 10 * seen > all);
    assert!(checked > least && changed < 8 && is_mixed, "{checked} {changed} {seen:?}");
}

#[test]
fn random_cases_have_the_slopes_of_differences_of_runs() {
    check(0..20, made, 300);
}

#[test]
fn random_cases_of_other_bodies_have_the_slopes_of_differences_of_runs() {
    check(100..116, varied, 200);
}

#[test]
fn random_cases_of_driven_and_worn_contacts_have_the_slopes_of_differences_of_runs() {
    check(200..218, driven, 300);
}
