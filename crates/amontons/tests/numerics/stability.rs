//! Eigenvalues of steady sliding against other programs and closed forms: blocks on a belt (squeal), layers on a
//! foundation that slides out of the plane (hot spots), with and without drag, and a rod whose conductance grows with
//! the pressure.

use amontons::case::{self, Case};
use amontons::run::{Settings, Stepping};
use amontons::stability::{ModeKind, ModeRegion, Modes, Wanted, modes};
use faer::c64;
use serde_json::Value;

use crate::common::file;

fn reference(name: &str) -> String {
    let path = file("crates/amontons/tests/reference/stability").join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn with(name: &str, overrides: &[String]) -> Case {
    let path = file("crates/amontons/tests/reference/stability").join(name);
    case::read(&path, overrides).unwrap_or_else(|error| panic!("{error}"))
}

/// The modes at the end of a run.
fn at_end(case: &Case, kind: ModeKind, count: usize) -> Modes {
    let mut run = Stepping::new(&case.problem, &Settings::default()).expect("a run");
    while !run.is_done() {
        run.step().expect("a step");
    }
    let seen = run.snapshot();
    let wanted = Wanted { kind, count, region: None, waves: None, interrupt: None };
    modes(&case.problem, seen.discretization, seen.state, seen.report.expect("a step"), &wanted).expect("modes")
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|value| value.as_f64().unwrap_or(f64::NAN)).collect()
}

/// Asserts that the modes are those of a table: frequency and growth, to 1e-8 of the modulus.
fn assert_modes(name: &str, found: &Modes, growth: &[f64], frequency: &[f64]) {
    assert_eq!(found.missing(), 0, "{name}: the count finds others");
    assert!(found.modes.len() >= growth.len(), "{name}: {} modes", found.modes.len());
    // Where two have nearly the same frequency, their order is round-off.
    for (growth, frequency) in growth.iter().zip(frequency) {
        let off = found.modes.iter().map(|mode| (mode.growth - growth).hypot(mode.frequency - frequency));
        let off = off.fold(f64::INFINITY, f64::min) / growth.hypot(*frequency);
        assert!(off < 1e-8, "{name}: {growth:e} + {frequency:e} i is {off:e} off");
    }
    assert!(found.modes.iter().all(|mode| mode.residual < 1e-9), "{name}: residuals");
}

#[test]
fn blocks_on_a_belt_squeal_as_elsewhere() {
    let all: Value = serde_json::from_str(&reference("squeal.json")).expect("a table");
    for block in all.as_array().expect("blocks") {
        let law = block["law"].as_str().expect("a law");
        let law = if law == "compliance" { "compliance" } else { "signorini" };
        let name = format!("{}-{law}", block["name"].as_str().expect("a name"));
        for (mu, expected) in block["eigenvalues"].as_object().expect("by μ") {
            let case = with(&format!("{name}.toml"), &[format!("contact.friction.coefficient={mu}")]);
            let found = at_end(&case, ModeKind::Squeal, 6);
            let name = format!("{name}, μ = {mu}");
            assert_modes(&name, &found, &numbers(&expected["growth"]), &numbers(&expected["frequency"]));
        }
    }
}

/// The rows of a table by column name.
fn table(name: &str) -> Vec<std::collections::BTreeMap<String, String>> {
    let text = reference(name);
    let split = |line: &str| -> Vec<String> {
        let (mut fields, mut quoted) = (vec![String::new()], false);
        for c in line.chars() {
            match c {
                '"' => quoted = !quoted,
                ',' if !quoted => fields.push(String::new()),
                c => fields.last_mut().expect("a field").push(c),
            }
        }
        fields
    };
    let mut lines = text.lines();
    let head = split(lines.next().expect("a header"));
    lines.map(|line| head.iter().cloned().zip(split(line)).collect()).collect()
}

fn number(row: &std::collections::BTreeMap<String, String>, key: &str) -> f64 {
    row[key].parse().unwrap_or(f64::NAN)
}

/// The hot spots of a layer with pressures too small to drag, against the discrete problem of another program: four
/// eigenvalues each.
#[test]
fn layers_grow_hot_spots_as_elsewhere() {
    for row in table("tei-fe.csv").iter().filter(|row| ["symmetry", "clamped"].contains(&row["top"].as_str())) {
        if number(row, "n") > 8.0 {
            continue;
        }
        let law = if row["c"] == "inf" { "rigid" } else { "compliance" };
        let name = format!("tei-{}-{}-{law}-{}", row["data"], row["top"], row["elements"]);
        let overrides = [
            format!("mesh.n={}", row["n"]),
            "time.end=1e-9".to_owned(),
            "time.steps=1".to_owned(),
            "initial.temperature=0".to_owned(),
            format!("contact.heat.conductance={}", row["h"]),
            format!("contact.foundation_velocity=[0, 0, {}]", row["V"]),
        ];
        let top = if row["top"] == "clamped" {
            "boundary[2].displacement=[0, -1e-13]"
        } else {
            "boundary[2].displacement=[\"free\", -1e-13]"
        };
        let case = with(&format!("{name}.toml"), &[&overrides[..], &[top.to_owned()]].concat());
        let found = at_end(&case, ModeKind::Thermal, 4);
        let growth: Vec<f64> = (1..5).map(|k| number(row, &format!("eigenvalue_{k}"))).collect();
        let frequency: Vec<f64> = (1..5).map(|k| number(row, &format!("imag_{k}")).abs()).collect();
        assert_modes(&format!("{name}, n = {}, h = {}", row["n"], row["h"]), &found, &growth, &frequency);
    }
}

/// Drag across the direction of sliding damps all modes but the even one.
#[test]
fn drag_damps_hot_spots_as_elsewhere() {
    for row in table("tei-drag.csv") {
        let modulus = 2.0 * 0.7 / (1.3 * 0.4);
        let press = (number(&row, "pstar") / modulus).max(1e-13);
        let overrides = [
            "time.end=1e-12".to_owned(),
            "time.steps=1".to_owned(),
            "initial.temperature=0".to_owned(),
            format!("boundary[2].displacement=[\"free\", {:?}]", -press),
        ];
        let found = at_end(&with("tei-a-symmetry-rigid-Q1.toml", &overrides), ModeKind::Thermal, 4);
        let growth: Vec<f64> = (1..5).map(|k| number(&row, &format!("eigenvalue_{k}"))).collect();
        assert_modes(&format!("drag at {}", row["pstar"]), &found, &growth, &[0.0; 4]);
    }
}

/// A rod between walls whose conductance grows with the pressure (Barber): P1, and of order 2 to the closed form.
#[test]
fn a_rod_with_a_conductance_of_pressure_grows_as_elsewhere() {
    for row in table("rod.csv") {
        // θ_L = h Δ L/K and p = 𝓜⟨θ⟩ − E g/L = ½, so that h = h₀ + p dh/dp holds with h₀ = ½.
        let (h, difference, young) = (number(&row, "h"), number(&row, "theta_F_minus_theta"), number(&row, "young"));
        let (slope, expansion) = (number(&row, "dh_dp"), number(&row, "expansion"));
        let end = h * difference;
        let (p, foundation) = (0.5, end + difference);
        let gap = (expansion * 0.5 * end - p) / young;
        let text = format!(
            r#"
name = "rod"
units = "dimensionless"
[mesh]
kind = "interval"
size = 1.0
n = {n}
[time]
end = 1e-12
steps = 1
[initial]
temperature = "{end:?}*x"
[material]
density = 0.0
heat_capacity = 1.0
conductivity = 1.0
expansion = {expansion}
elasticity = {{ law = "isotropic", young = {young}, poisson = 0.0 }}
[[boundary]]
on = "left"
displacement = [0]
temperature = 0
[contact]
on = "right"
gap = {gap:?}
normal = {{ law = "signorini" }}
heat = {{ law = "sum", foundation_temperature = {foundation:?}, laws = [
    {{ law = "constant", conductance = {rest:?} }},
    {{ law = "pressure", coefficient = {slope} }},
] }}
"#,
            n = row["n"],
            rest = h - p * slope,
        );
        let case = case::parse(&case::Source::new("rod.toml", text), &[]).unwrap_or_else(|error| panic!("{error}"));
        let found = at_end(&case, ModeKind::Thermal, 4);
        let growth: Vec<f64> =
            ["growth_fe", "eigenvalue_2", "eigenvalue_3", "eigenvalue_4"].map(|key| number(&row, key)).to_vec();
        assert_modes(&format!("rod, n = {}, {difference}", row["n"]), &found, &growth, &[0.0; 4]);
    }
}

fn parsed(text: String, overrides: &[&str]) -> Case {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    case::parse(&case::Source::new("case.toml", text), &overrides).unwrap_or_else(|error| panic!("{error}"))
}

/// Two bodies with symmetric sides, one above the other.
const TWO_BODIES: &str = r#"
name = "two"
units = "dimensionless"
[mesh]
kind = "blocks"
[[mesh.blocks]]
name = "upper"
size = [1.0, 1.0]
n = [N, N]
elements = "Q1"
[[mesh.blocks]]
name = "lower"
size = [1.0, 0.5]
n = [N, HALF]
elements = "Q1"
origin = [0.0, -0.5]
[time]
end = 1e-12
steps = 1
[material]
density = 0.0
heat_capacity = 1.0
expansion = 0.5
conductivity = 1.0
elasticity = { law = "isotropic", young = 2.0, poisson = 0.3, stress_state = "plane-strain" }
[[region]]
on = "lower"
[region.material]
density = 0.0
heat_capacity = 2.0
expansion = 2.0
conductivity = 0.5
elasticity = { law = "isotropic", young = 10.0, poisson = 0.25, stress_state = "plane-strain" }
[[boundary]]
on = "upper_left"
displacement = [0, "free"]
[[boundary]]
on = "upper_right"
displacement = [0, "free"]
[[boundary]]
on = "lower_left"
displacement = [0, "free"]
[[boundary]]
on = "lower_right"
displacement = [0, "free"]
[[boundary]]
on = "lower_bottom"
displacement = ["free", 0]
[[boundary]]
on = "upper_top"
displacement = ["free", -1e-12]
[contact]
on = "ON_SIDE"
with = "WITH_SIDE"
normal = { law = "signorini" }
friction = { law = "coulomb", coefficient = MU }
frictional_heat = SHARE
foundation_velocity = [0, 0, SPEED]
heat = { law = "constant", conductance = 2.0 }
"#;

/// Two bodies that exchange heat while one slides out of the plane, whichever of them is named first.
#[test]
fn two_bodies_grow_hot_spots_whichever_is_named_first() {
    for row in table("tei-fe.csv").iter().filter(|row| row["top"] == "two bodies, symmetry") {
        let n: usize = row["n"].parse().expect("a number");
        if n > 8 {
            continue;
        }
        let text = |on: &str, with: &str, share: f64, speed: f64| {
            let values = [
                ("HALF", (n / 2).to_string()),
                ("WITH_SIDE", with.to_owned()),
                ("ON_SIDE", on.to_owned()),
                ("SHARE", format!("{share:?}")),
                ("SPEED", format!("{speed:?}")),
                ("MU", row["mu"].clone()),
                ("N", n.to_string()),
            ];
            values.iter().fold(TWO_BODIES.to_owned(), |text, (name, value)| text.replace(name, value))
        };
        let eta = number(row, "eta");
        let both = [
            text("upper_bottom", "lower_top", eta, number(row, "V")),
            text("lower_top", "upper_bottom", 1.0 - eta, -number(row, "V")),
        ];
        for (side, text) in both.into_iter().enumerate() {
            let found = at_end(&parsed(text, &[]), ModeKind::Thermal, 4);
            let growth: Vec<f64> = (1..5).map(|k| number(row, &format!("eigenvalue_{k}"))).collect();
            assert_modes(&format!("two bodies, n = {n}, naming {side}"), &found, &growth, &[0.0; 4]);
            assert_eq!(found.bodies.len(), 2);
        }
    }
}

/// A block with every term: damping, branches, a damped layer, and friction that falls with the speed, turned by an
/// angle.
fn turned_block(angle: f64, unit: [f64; 2]) -> Case {
    let [length, stress] = unit;
    let (sine, cosine) = angle.sin_cos();
    let along = |x: f64, y: f64| format!("[{:?}, {:?}]", cosine * x - sine * y, sine * x + cosine * y);
    parsed(
        format!(
            r#"
name = "turned"
units = "dimensionless"
[mesh]
kind = "blocks"
[[mesh.blocks]]
name = "block"
size = [{size:?}, {height:?}]
n = [5, 4]
elements = "Q2"
turn = {{ angle = {angle:?} }}
[time]
end = 1.0
analysis = "steady"
[material]
density = {density:?}
elasticity = {{ law = "isotropic", young = {young:?}, poisson = 0.3, stress_state = "plane-strain" }}
viscosity = {{ law = "lame", first = {viscous:?}, second = {viscous:?} }}
prony = [{{ ratio = 0.02, time = 0.7 }}]
[[boundary]]
on = "block_top"
displacement = {press}
[contact]
on = "block_bottom"
normal = {{ law = "damped", stiffness = {stiffness:?}, damping = {damping:?} }}
friction = {{ law = "static-kinetic", static = 0.6, kinetic = 0.45, decay_speed = {decay:?} }}
foundation_velocity = {belt}
"#,
            size = length,
            height = 0.7 * length,
            density = stress / (length * length),
            young = stress,
            viscous = 1e-4 * stress,
            press = along(0.0, -0.01 * length),
            stiffness = stress / length,
            damping = 1e-3 * stress / length,
            decay = 0.3 * length,
            belt = along(0.5 * length, 0.0),
        ),
        &[],
    )
}

/// Eigenvalues do not know how a block is turned, nor the units of length and stress.
#[test]
fn modes_do_not_know_how_a_block_is_turned_or_measured() {
    let straight = at_end(&turned_block(0.0, [1.0, 1.0]), ModeKind::Squeal, 8);
    assert!(straight.missing() == 0 && straight.modes.len() >= 8);
    let growths: Vec<f64> = straight.modes.iter().map(|mode| mode.growth).collect();
    assert!(growths.iter().any(|growth| *growth > 1e-3) && growths.iter().any(|growth| *growth < -1e-3), "{growths:?}");
    for (angle, unit) in [(0.4, [1.0, 1.0]), (2.2, [1.0, 1.0]), (-1.3, [1e-3, 2.1e11]), (0.0, [50.0, 1e-4])] {
        let other = at_end(&turned_block(angle, unit), ModeKind::Squeal, 8);
        assert_eq!(other.modes.len(), straight.modes.len(), "{angle}, {unit:?}");
        for (a, b) in straight.modes.iter().zip(&other.modes) {
            let off = (a.growth - b.growth).hypot(a.frequency - b.frequency) / a.growth.hypot(a.frequency);
            assert!(off < 1e-8, "{angle}, {unit:?}: {} + {} i is {off:e} off", a.growth, a.frequency);
            let share = (a.by_contact[0] - b.by_contact[0]).abs();
            assert!(share < 1e-6 * a.frequency, "{angle}, {unit:?}: by contact {share:e}");
        }
    }
}

/// What contacts bring in less what the body damps is the growth; without damping it is all of it.
#[test]
fn growth_is_what_the_contact_brings_in() {
    let case = with("block-a-compliance.toml", &["contact.friction.coefficient=0.5".to_owned()]);
    for mode in at_end(&case, ModeKind::Squeal, 6).modes {
        assert!((mode.by_contact[0] - mode.growth).abs() < 1e-10 * mode.frequency, "{mode:?}");
    }
}

/// Ten steps of the midpoint rule from the steady state plus a small part of a mode, against its eigenvalue:
/// ((1 + λk/2)/(1 − λk/2))¹⁰ times the mode. Returns the largest difference in displacement, relative to the mode, and
/// the largest growth of the modes.
fn against_time(text: &str, kind: ModeKind, small: f64) -> (f64, f64) {
    let case = parsed(text.to_owned(), &[]);
    let mut run = Stepping::new(&case.problem, &Settings::default()).expect("a run");
    run.step().expect("the steady state");
    // A dynamic phase starts from rest: the velocity of the mode can be given after its first step.
    run.step().expect("a step at rest");
    let seen = run.snapshot();
    let region = (kind == ModeKind::Coupled).then_some(ModeRegion { growth: [-0.3, 2.0], frequency: [0.3, 3.0] });
    let wanted = Wanted { kind, count: 6, region, waves: None, interrupt: None };
    let report = seen.report.expect("a step");
    let found = modes(seen.problem, seen.discretization, seen.state, report, &wanted).expect("modes");
    let k = case.problem.timeline.instant(2).k;
    let saved = run.save();
    let (mut worst, mut warmest, mut hottest) = (0.0f64, 0.0f64, 0.0f64);
    for mode in found.modes.iter().filter(|mode| mode.frequency > 0.0) {
        let lambda = c64::new(mode.growth, mode.frequency);
        let part = |all: &[[f64; 2]], i: usize, factor: c64| (c64::new(all[i][0], all[i][1]) * factor).re;
        let mut begun = saved.clone();
        for i in 0..mode.displacement.len() {
            begun.state.u[i] += small * part(&mode.displacement, i, c64::new(1.0, 0.0));
            begun.state.w[i] += small * part(&mode.displacement, i, lambda);
        }
        for (i, theta) in mode.temperature.iter().enumerate().filter(|_| kind == ModeKind::Coupled) {
            begun.state.theta[i] += small * (c64::new(theta[0], theta[1])).re;
        }
        run.restore(&begun).expect("the state");
        for _ in 0..10 {
            run.step().expect("a step");
        }
        let one = (0.5 * k * lambda + 1.0) / (c64::new(1.0, 0.0) - 0.5 * k * lambda);
        let all = (0..10).fold(c64::new(1.0, 0.0), |power, _| power * one);
        for i in 0..mode.displacement.len() {
            let went = (run.state().u[i] - saved.state.u[i]) / small;
            worst = worst.max((went - part(&mode.displacement, i, all)).abs());
        }
        for i in 0..mode.temperature.len() {
            let went = (run.state().theta[i] - saved.state.theta[i]) / small;
            warmest = warmest.max((went - part(&mode.temperature, i, all)).abs());
            hottest = hottest.max(mode.temperature[i][0].hypot(mode.temperature[i][1]));
        }
    }
    assert!(found.missing() == 0 && found.modes.iter().any(|mode| mode.frequency > 0.0));
    if hottest > 0.0 {
        worst = worst.max(warmest / hottest);
    }
    (worst, found.largest_growth())
}

/// The phases of a search that is held against time.
const STEADY_THEN_FREE: &str = r#"
[time]
scheme = "theta"
[[phase]]
name = "slide"
end = 1.0
analysis = "steady"
[[phase]]
name = "free"
end = 1.55
steps = 11
"#;

#[test]
fn a_run_in_time_goes_on_as_its_mode_does() {
    let text = reference("block-a-compliance.toml")
        .replace("[time]\nend = 400.0\nsteps = 400\n", STEADY_THEN_FREE)
        .replace("coefficient = 0.3", "coefficient = 0.5");
    let (off, growth) = against_time(&text, ModeKind::Squeal, 1e-6);
    assert!(off < 1e-8 && growth > 0.01, "{off:e} off, {growth}");
}

/// A block in space on a belt across its edges, with friction that falls with the speed or is not the same in all
/// directions, a damped layer and a viscosity.
fn block_in_space(friction: &str) -> String {
    format!(
        r#"
name = "space"
units = "dimensionless"
[mesh]
kind = "box"
size = [1.0, 0.7, 0.8]
n = [2, 2, 2]
elements = "Q1"
{STEADY_THEN_FREE}
[material]
density = 1.0
elasticity = {{ law = "isotropic", young = 1.0, poisson = 0.3 }}
viscosity = {{ law = "lame", first = 0.002, second = 0.004 }}
[[boundary]]
on = "top"
displacement = [0, -0.05, 0]
[contact]
on = "bottom"
normal = {{ law = "damped", stiffness = 1.5, damping = 0.02 }}
friction = {friction}
foundation_velocity = [0.4, 0, 0.25]
"#
    )
}

/// Drag across the slip, a bound that falls with the speed, a cone that is not round, dampers: what the laws state is
/// what a run in time does. What is left is of second order in the perturbation.
#[test]
fn modes_in_space_go_on_as_a_run_in_time_does() {
    let falling = "{ law = \"static-kinetic\", static = 0.6, kinetic = 0.4, decay_speed = 0.3 }";
    let oval = "{ law = \"orthotropic\", coefficients = [0.3, 0.6], direction = [1, 0, 0.5] }";
    for friction in [falling, oval] {
        let text = block_in_space(friction);
        let offs = [1e-4, 1e-5].map(|small| against_time(&text, ModeKind::Squeal, small).0);
        assert!(offs[1] < 1e-4 && (offs[0] / offs[1] - 10.0).abs() < 1.0, "{friction}: {offs:?}");
    }
}

/// The benchmark `rubbing-bar` with viscosity and a branch that relaxes: with G(λ) = 1 + 0.3 λ/(λ + 2) + 0.01 λ and
/// κ = λ/√G its modes solve tanh κ = √G/g. The error is of second order in the cells.
#[test]
fn a_bar_that_relaxes_rubs_as_its_formula_says() {
    let (one, slope) = (c64::new(1.0, 0.0), 0.5);
    let modulus = |l: c64| one + 0.3 * l / (l + 2.0) + 0.01 * l;
    let residual = |l: c64| (l / modulus(l).sqrt()).tanh() - modulus(l).sqrt() / slope;
    let root = |mut l: c64| {
        for _ in 0..60 {
            let h = 1e-6 * l.norm();
            l -= residual(l) * (2.0 * h) / (residual(l + h) - residual(l - h));
        }
        assert!(residual(l).norm() < 1e-9, "{l}");
        l
    };
    let path = file("crates/amontons/benchmarks/rubbing-bar.toml");
    let errors = [50, 100].map(|n| {
        let overrides = [
            format!("mesh.n=[{n}, 1]"),
            "material.prony=[{ ratio = 0.3, time = 0.5 }]".to_owned(),
            "material.viscosity={ law = \"lame\", first = 0.0, second = 0.02 }".to_owned(),
        ];
        let found = at_end(&case::read(&path, &overrides).expect("the bar"), ModeKind::Squeal, 3);
        assert_eq!(found.missing(), 0);
        let off = |mode: &amontons::stability::Mode| {
            let lambda = c64::new(mode.growth, mode.frequency);
            (lambda - root(lambda)).norm() / lambda.norm()
        };
        found.modes.iter().take(3).map(off).fold(0.0, f64::max)
    });
    let order = (errors[0] / errors[1]).log2();
    assert!(errors[1] < 1e-3 && (order - 2.0).abs() < 0.1, "{errors:?}, order {order}");
}

/// A layer of height 1 between flat walls on a belt that warms up, C_F = 0.8 and H = 0.3, uniform along it: with
/// z² = bC/K, P = 𝓜 sinh(z)/z and the friction heat w = μ V P per cosh(z(1 − y)),
///
/// ```text
/// −K z sinh z = h (cosh z − θ_F) − η w,    (C_F b + H) θ_F = h (cosh z − θ_F) + (1 − η) w
/// ```
///
/// for real z, as it grows; and the error is of second order in the cells.
#[test]
fn a_layer_on_a_belt_that_warms_up_grows_as_its_formula_says() {
    let (h, capacity, exchange, share, rubbed) = (0.7, 0.8, 0.3, 0.6, 0.4 * 12.0 * 0.5);
    let residual = |b: f64| {
        let z = b.sqrt();
        let w = rubbed * z.sinh() / z;
        let foundation = (h * z.cosh() + (1.0 - share) * w) / (capacity * b + exchange + h);
        -z * z.sinh() - h * (z.cosh() - foundation) + share * w
    };
    let (mut low, mut high) = (1e-3, 100.0);
    assert!(residual(low) > 0.0 && residual(high) < 0.0);
    while high - low > 1e-12 * high {
        let middle = 0.5 * (low + high);
        *(if residual(middle) > 0.0 { &mut low } else { &mut high }) = middle;
    }
    let errors = [8, 16].map(|n| {
        let overrides = [
            format!("mesh.n=[1, {n}]"),
            "time.end=1e-9".to_owned(),
            "time.steps=1".to_owned(),
            "initial.temperature=0".to_owned(),
            format!("contact.heat.conductance={h}"),
            format!("contact.frictional_heat={share}"),
            format!("contact.foundation={{ heat_capacity = {capacity}, exchange = {exchange} }}"),
            "contact.friction.coefficient=0.4".to_owned(),
            "contact.foundation_velocity=[0, 0, 12]".to_owned(),
            "boundary[2].displacement=[\"free\", -1e-13]".to_owned(),
        ];
        let found = at_end(&with("tei-a-symmetry-rigid-Q1.toml", &overrides), ModeKind::Thermal, 2);
        assert_eq!(found.missing(), 0);
        (found.largest_growth() - low).abs() / low
    });
    let order = (errors[0] / errors[1]).log2();
    assert!(errors[1] < 5e-3 && (order - 2.0).abs() < 0.1, "{low}: {errors:?}, order {order}");
}

/// Squeal and heat in one pencil: expansion, heat of strain and of friction, and exchange with a belt that is warmer.
#[test]
fn warm_modes_go_on_as_a_run_in_time_does() {
    let text = block_in_space("{ law = \"coulomb\", coefficient = 0.5 }")
        .replace("[time]", "[scheme]\ncoupling = \"monolithic\"\n[time]")
        .replace(
            "density = 1.0\n",
            "density = 1.0\nheat_capacity = 1.0\nconductivity = 0.3\nexpansion = 0.1\ncoupling = 0.2\n",
        )
        .replace("displacement = [0, -0.05, 0]", "displacement = [0, -0.05, 0]\ntemperature = 0")
        + "frictional_heat = 0.7\nheat = { law = \"constant\", conductance = 0.4, foundation_temperature = 0.1 }\n";
    let offs = [1e-4, 1e-5].map(|small| against_time(&text, ModeKind::Coupled, small).0);
    assert!(offs[1] < 1e-4 && (offs[0] / offs[1] - 10.0).abs() < 1.0, "{offs:?}");
}
