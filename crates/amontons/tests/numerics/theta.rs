//! The ϑ-scheme: the states of sixteen cases by an independent program, order, energy, and what it shares with backward
//! Euler.

use amontons::case::{self, Source};
use amontons::hypotheses::{self, FindingId};
use amontons::output::Memory;
use amontons::problem::Problem;
use serde_json::Value;

use crate::common::{self, solve};

/// The numbers of a list of records under a key, one after the other.
fn numbers(records: &Value, key: &str) -> Vec<f64> {
    let of = |record: &Value| match &record[key] {
        Value::Array(all) => all.iter().filter_map(Value::as_f64).collect(),
        one => one.as_f64().into_iter().collect::<Vec<f64>>(),
    };
    records.as_array().expect("records").iter().flat_map(of).collect()
}

/// Asserts that numbers agree to a fraction of the largest of them.
fn agree(name: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{name}");
    let size = expected.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
        let error = (found - expected).abs();
        assert!(error <= tolerance * size, "{name}, number {i}: {found:e}, expected {expected:e}, off by {error:e}");
    }
}

/// The cases, and the fraction of the largest number of a kind to which they agree.
const CASES: [(&str, f64); 19] = [
    ("rod-compliance-midpoint", 1e-9),
    ("rod-compliance-plain", 1e-9),
    ("rod-signorini-velocity", 1e-9),
    ("rod-signorini-restitution", 1e-9),
    ("two-rods", 1e-9),
    ("block-compliance-midpoint", 1e-9),
    ("block-signorini-midpoint", 1e-9),
    ("block-signorini-theta06", 1e-9),
    ("stick-slip-midpoint", 1e-8),
    ("stick-slip-friction-end", 1e-8),
    ("thermo-staggered", 1e-9),
    ("thermo-extrapolated", 1e-9),
    ("thermo-extrapolated-06", 1e-9),
    ("thermo-midpoint", 1e-9),
    ("paper-8-midpoint", 1e-9),
    ("paper-8-midpoint-10", 1e-9),
    ("rod-stabilised", 1e-9),
    ("two-rods-stabilised", 1e-9),
    ("block-stabilised", 1e-9),
];

/// Runs a case of the reference and asserts its u, w and θ at all nodes and its p, q, slip and r at all contact points.
pub(crate) fn run_as_expected(name: &str, tolerance: f64) -> (Memory, Value) {
    let at = |end: &str| common::file(&format!("crates/amontons/tests/reference/time/{name}.{end}"));
    let problem = case::read(&at("toml"), &[]).unwrap_or_else(|error| panic!("{error}")).problem;
    let text = std::fs::read_to_string(at("json")).expect("the reference numbers");
    let expected: Value = serde_json::from_str(&text).expect("records");
    let memory = solve(&problem);
    let (state, report) = (memory.states.last().expect("a state"), memory.reports.last().expect("a report"));
    agree(&format!("{name}: u"), &state.u, &numbers(&expected["nodes"], "displacement"), tolerance);
    agree(&format!("{name}: w"), &state.w, &numbers(&expected["nodes"], "velocity"), tolerance);
    let theta = numbers(&expected["nodes"], "temperature");
    if !theta.is_empty() {
        agree(&format!("{name}: temperature"), &state.theta, &theta, tolerance);
    }
    let points = &report.contact.states;
    let of = |value: &dyn Fn(&amontons::inclusion::PointState) -> f64| points.iter().map(value).collect::<Vec<f64>>();
    let contact = &expected["contact"];
    agree(&format!("{name}: p"), &of(&|s| s.pressure), &numbers(contact, "pressure"), tolerance);
    agree(&format!("{name}: r"), &of(&|s| s.penetration), &numbers(contact, "penetration"), tolerance);
    let friction = numbers(contact, "friction");
    if !friction.is_empty() {
        agree(&format!("{name}: q"), &of(&|s| s.q[0]), &friction, 1e-8);
        agree(&format!("{name}: slip"), &of(&|s| s.slip[0]), &numbers(contact, "slip_velocity"), 1e-8);
    }
    (memory, expected)
}

/// The states and ledgers of all cases.
#[test]
fn states_agree_with_an_independent_program() {
    for (name, tolerance) in CASES {
        let (memory, expected) = run_as_expected(name, tolerance);
        let state = memory.states.last().expect("a state");
        let ledger = &expected["ledger"];
        let start = &memory.states[0].ledger;
        for (key, found) in [
            ("kinetic", state.ledger.kinetic - start.kinetic),
            ("elastic", state.ledger.elastic - start.elastic),
            ("contact", state.ledger.contact_energy - start.contact_energy),
            ("visc", state.ledger.viscous_dissipation),
            ("fric", state.ledger.friction_dissipation),
            ("impact", state.ledger.impact_dissipation),
            ("thermal", state.ledger.thermal_work),
        ] {
            let (expected, size) = (ledger[key].as_f64().expect("a number"), state.ledger.turned_over);
            assert!((found - expected).abs() <= 1e-9 * size, "{name}: {key} {found:e}, expected {expected:e}");
        }
        let taken: f64 = ["num_k", "num_e", "num_c"].iter().map(|key| ledger[key].as_f64().expect("a number")).sum();
        // The reference writes what the predictor takes on the other side of the identity.
        let taken = taken - ledger["stab"].as_f64().unwrap_or(0.0);
        let found = state.ledger.scheme_dissipation;
        assert!((found - taken).abs() <= 1e-9 * state.ledger.turned_over, "{name}: {found:e}, expected {taken:e}");
        assert!(state.ledger.closing_error.abs() <= 1e-11 * state.ledger.turned_over, "{name}");
        assert!(state.ledger.heat_closing_error.abs() <= 1e-11 * state.ledger.heat_turned_over.max(1.0), "{name}");
    }
}

/// The keys that pose the heated block of the reference as one that is pressed on a belt, from nothing.
pub(crate) const PRESSED: [&str; 8] = [
    "contact.gap=0",
    "contact.normal.stiffness=200",
    "contact.foundation_velocity=[0.5, 0]",
    "contact.heat.exponent=1",
    "contact.heat.foundation_temperature=\"t^2\"",
    "initial.temperature=0",
    "boundary[0].temperature=0",
    "boundary[0].displacement=[0, \"-0.02*t^2\"]",
];

/// The orders of the couplings at ϑ = ½ and above of a block that is pressed on a belt that rubs and warms it, from
/// nothing: u and θ at the end against steps that are much shorter.
#[test]
fn extrapolated_temperatures_are_of_second_order() {
    let file = common::file("crates/amontons/tests/reference/time/thermo-extrapolated.toml");
    let end = |steps: usize, keys: [&str; 2]| {
        let own = [format!("time.steps={steps}"), keys[0].to_owned(), format!("scheme.coupling={}", keys[1])];
        let overrides = [&PRESSED.map(str::to_owned)[..], &own].concat();
        let problem = case::read(&file, &overrides).unwrap_or_else(|error| panic!("{error}")).problem;
        let state = solve(&problem).states.pop().expect("a state");
        let ledger = &state.ledger;
        assert!(ledger.friction_dissipation > 0.1 * ledger.turned_over, "it rubs");
        assert!(ledger.closing_error.abs() <= 1e-11 * ledger.turned_over, "{keys:?}, {steps} steps");
        assert!(ledger.heat_closing_error.abs() <= 1e-11 * ledger.heat_turned_over, "{keys:?}, {steps} steps");
        [state.u, state.theta]
    };
    let half = "time.theta=0.5";
    let exact = end(2560, [half, "monolithic"]);
    for (keys, order) in [
        ([half, "extrapolated"], 2.0),
        ([half, "monolithic"], 2.0),
        ([half, "staggered"], 1.0),
        (["time.theta=0.6", "extrapolated"], 1.0),
    ] {
        let errors = [80, 320].map(|steps| {
            let found = end(steps, keys);
            [0, 1].map(|i| found[i].iter().zip(&exact[i]).fold(0.0f64, |most, (a, b)| most.max((a - b).abs())))
        });
        for i in [0, 1] {
            let found = (errors[0][i] / errors[1][i]).log2() / 2.0;
            assert!((found - order).abs() < 0.15, "{keys:?}: order {found} of {}", ["u", "θ"][i]);
        }
    }
}

/// A rod that opens and closes on a layer.
const ROD: &str = r#"
name = "rod"
units = "dimensionless"
[mesh]
kind = "interval"
size = 2.0
n = 8
[time]
end = 0.6
steps = 60
scheme = "theta"
[material]
density = 1.5
elasticity = { law = "isotropic", young = 300.0, poisson = 0.0 }
viscosity = { law = "lame", first = 0.0, second = 0.0 }
[initial]
velocity = [-1.0]
[contact]
on = "left"
gap = 0.0131
normal = { law = "compliance", stiffness = 500.0 }
"#;

fn rod(overrides: &[String]) -> Problem {
    case::parse(&Source::new("rod.toml", ROD), overrides).unwrap_or_else(|faults| panic!("{faults}")).problem
}

/// Of a rod that bounces without viscosity: energy to round-off at ϑ = ½, errors of order 2; at ϑ = 0.6 and with
/// backward Euler energy is lost, and the order is 1.
#[test]
fn a_rod_bounces_without_loss_and_to_second_order() {
    let end = |steps: usize, more: &[&str]| {
        let mut overrides = vec![format!("time.steps={steps}")];
        overrides.extend(more.iter().map(|&more| more.to_owned()));
        solve(&rod(&overrides)).states.pop().expect("a state")
    };
    let reference = end(40_960, &[]).u;
    let error = |steps: usize, more: &[&str]| {
        let u = end(steps, more).u;
        u.iter().zip(&reference).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()))
    };
    let order = |more: &[&str]| (error(640, more) / error(2560, more)).log2() / 2.0;
    let [middle, above, euler] = [&[][..], &["time.theta=0.6"], &["time.scheme=euler"]].map(order);
    assert!(middle > 1.8, "order {middle} at ϑ = 1/2");
    assert!((above - 1.0).abs() < 0.2 && (euler - 1.0).abs() < 0.2, "orders {above} and {euler}");
    let lost = |more: &[&str]| {
        let ledger = end(300, more).ledger;
        assert!(ledger.contact_energy >= 0.0 && ledger.closing_error.abs() <= 1e-11 * ledger.turned_over);
        1.0 - (ledger.kinetic + ledger.elastic + ledger.contact_energy) / 1.5
    };
    let [middle, above, euler] = [&[][..], &["time.theta=0.6"], &["time.scheme=euler"]].map(lost);
    assert!(middle.abs() < 1e-12, "{middle:e} of the energy");
    assert!(above > 1e-3 && euler > 2.0 * above, "{above} and {euler} of the energy");
}

/// Two rods like it that meet halfway, on layers in series.
const PAIR: &str = r#"
name = "pair"
units = "dimensionless"
[mesh]
kind = "blocks"
[[mesh.blocks]]
name = "first"
size = [2.0]
n = [8]
origin = [-2.0131]
[[mesh.blocks]]
name = "second"
size = [2.0]
n = [8]
origin = [0.0131]
[time]
end = 0.6
steps = 60
scheme = "theta"
[material]
density = 1.5
elasticity = { law = "isotropic", young = 300.0, poisson = 0.0 }
viscosity = { law = "lame", first = 0.0, second = 0.0 }
[initial]
velocity = ["if(x < 0, 1, -1)"]
[contact]
on = "second_left"
with = "first_right"
normal = { law = "compliance", stiffness = 250.0 }
"#;
const COMPLIANT: &str = "normal = { law = \"compliance\", stiffness = 250.0 }";

/// A rod that starts inside a wall, or away from one that it cannot leave, stays there, and is told so.
#[test]
fn a_distance_at_the_start_is_kept_and_told() {
    let told = |law: &str, gap: &str, more: &[String]| {
        let all = [&[format!("contact.normal={{ law = \"{law}\" }}"), format!("contact.gap=\"{gap}\"")], more].concat();
        let problem = rod(&all);
        let findings = hypotheses::findings(&problem);
        let kept = findings.into_iter().find(|finding| finding.id == FindingId::StartKept);
        kept.map(|finding| finding.value.expect("a distance"))
    };
    for (law, gap) in [("signorini", "-0.01"), ("bilateral", "-0.01"), ("bilateral", "0.01")] {
        assert!(told(law, gap, &[]).is_some_and(|distance| (distance - 0.01).abs() < 1e-12), "{law}, {gap}");
        assert_eq!(told(law, gap, &["time.scheme=euler".to_owned()]), None, "{law}, {gap}");
    }
    for (law, gap) in [("signorini", "0"), ("signorini", "0.01"), ("signorini", "-0.01*t"), ("bilateral", "-0.01*t")] {
        assert_eq!(told(law, gap, &[]), None, "{law}, {gap}");
    }
    let kept = "initial.displacement=[-0.0031]".to_owned();
    assert!(told("signorini", "0", &[kept]).is_some_and(|distance| (distance - 0.0031).abs() < 1e-12));
    let still = ["initial.velocity=[0]", "contact.gap=-0.01", "contact.normal={ law = \"signorini\" }"];
    let end = solve(&rod(&still.map(str::to_owned))).states.pop().expect("a state");
    assert!(end.u.iter().all(|u| u.abs() < 1e-15), "it is kept");
}

/// Two equal bars that meet halfway do what one does that meets a wall: each takes half of the penetration.
#[test]
fn two_bars_that_collide_do_what_a_bar_and_a_wall_do() {
    for theta in [0.5, 0.7, 1.0] {
        let overrides = [format!("time.theta={theta}")];
        let pair = case::parse(&Source::new("pair.toml", PAIR), &overrides).unwrap_or_else(|faults| panic!("{faults}"));
        let (pair, alone) = (solve(&pair.problem), solve(&rod(&overrides)));
        assert!(alone.reports.iter().any(|report| report.contact.states[0].pressure > 1.0), "nothing touches");
        let size = |values: &[f64]| values.iter().fold(0.0f64, |most, x| most.max(x.abs()));
        let fastest = alone.states.iter().map(|state| size(&state.w)).fold(0.0, f64::max);
        for (pair, alone) in pair.states.iter().zip(&alone.states) {
            let n = alone.u.len();
            let [first, second] = [&pair.w[..n], &pair.w[n..]];
            for i in 0..n {
                let (own, mirrored) = (second[i] - alone.w[i], first[n - 1 - i] + alone.w[i]);
                assert!(own.abs().max(mirrored.abs()) <= 1e-11 * fastest, "ϑ = {theta}, t = {}, node {i}", alone.t);
            }
            let (energy, of_one) = (&pair.ledger, &alone.ledger);
            assert!((energy.kinetic - 2.0 * of_one.kinetic).abs() <= 1e-11 * energy.turned_over, "t = {}", alone.t);
            assert!(energy.closing_error.abs() <= 1e-12 * energy.turned_over, "t = {}", alone.t);
        }
        let lost = |memory: &Memory| memory.states.last().expect("a state").ledger.scheme_dissipation;
        assert!((lost(&pair) - 2.0 * lost(&alone)).abs() <= 1e-11 * pair.states[0].ledger.kinetic, "ϑ = {theta}");
    }
}

/// A rigid block that is thrown on a rigid foundation with friction rebounds by Newton's and Coulomb's law of impact:
/// e V up, and V_τ − μ (1 + e) V along. Two that meet along the normal share the momentum.
#[test]
fn rigid_blocks_rebound_by_the_laws_of_impact() {
    const THROWN: &str = r#"
name = "thrown"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [1.0, 0.5]
n = [4, 2]
[time]
end = 0.3
steps = 30
scheme = "theta"
[material]
density = 2.0
elasticity = { law = "isotropic", young = 100.0, poisson = 0.3, stress_state = "plane-strain" }
[[rigid]]
on = "body"
guided = true
[initial]
velocity = [1.0, -1.0]
[contact]
on = "bottom"
gap = 0.1037
normal = { law = "signorini" }
friction = { law = "coulomb", coefficient = 0.2 }
"#;
    for (theta, e) in [(0.5, 0.0), (0.5, 0.5), (0.5, 1.0), (0.6, 0.4), (1.0, 0.0)] {
        for friction in ["mean", "end"] {
            let keys = [format!("theta={theta}"), format!("restitution={e}"), format!("friction={friction}")];
            let overrides = keys.clone().map(|key| format!("time.{key}"));
            let problem = case::parse(&Source::new("thrown.toml", THROWN), &overrides);
            let problem = problem.unwrap_or_else(|faults| panic!("{faults}")).problem;
            let state = solve(&problem).states.pop().expect("a state");
            let expected = [1.0 - 0.2 * (1.0 + e), e];
            for (w, expected) in state.w.iter().zip(expected.iter().cycle()) {
                assert!((w - expected).abs() < 1e-12, "{keys:?}: {w}, expected {expected}");
            }
            let ledger = &state.ledger;
            // Where the law of friction holds at the end of the step its power is that of the mean velocity, too.
            let rubbed = 0.5 * (1.0 - expected[0] * expected[0]);
            let taken = (theta - 0.5) * ((1.0 + e).powi(2) + 0.04 * (1.0 + e).powi(2));
            let lost = [ledger.friction_dissipation, ledger.impact_dissipation, ledger.scheme_dissipation];
            let all = rubbed + 0.5 * (1.0 - e * e);
            assert!((lost.iter().sum::<f64>() - all).abs() < 1e-12, "{keys:?}: {lost:?}, expected {all} in all");
            assert!((lost[2] - taken).abs() < 1e-12, "{keys:?}: {lost:?}, expected {taken} by the scheme");
            assert!(ledger.closing_error.abs() < 1e-14, "{keys:?}");
        }
    }
}

/// With `friction = "end"` a coefficient that depends on the slip speed is that of the speed at the end of the step:
/// the velocity of a rigid block that slides under its weight loses k g μ(w₁) in a step, exactly.
#[test]
fn friction_at_the_end_sees_the_speed_at_the_end() {
    const SLIDING: &str = r#"
name = "sliding"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [1.0, 0.5]
n = [2, 1]
[time]
end = 0.4
steps = 8
scheme = "theta"
friction = "end"
[material]
density = 2.0
elasticity = { law = "isotropic", young = 100.0, poisson = 0.3, stress_state = "plane-strain" }
[[rigid]]
on = "body"
guided = true
[load]
body_force = [0, -6.0]
[initial]
velocity = [1.0, 0.0]
[contact]
on = "bottom"
normal = { law = "signorini" }
friction = { law = "slip-rate", speed = [0, 0.2, 2.0], coefficient = [0.1, 0.2, 0.5] }
"#;
    let (k, g) = (0.05, 3.0);
    let mu = |v: f64| if v < 0.2 { 0.1 + 0.5 * v } else { 0.2 + (v - 0.2) / 6.0 };
    for theta in [0.5, 0.8] {
        let overrides = [format!("time.theta={theta}")];
        let problem = case::parse(&Source::new("sliding.toml", SLIDING), &overrides);
        let states = solve(&problem.unwrap_or_else(|faults| panic!("{faults}")).problem).states;
        for pair in states.windows(2) {
            let [before, after] = [pair[0].w[0], pair[1].w[0]];
            let lost = k * g * mu(after);
            assert!((before - after - lost).abs() < 1e-12, "ϑ = {theta}: {before} to {after}, expected {lost} less");
        }
        assert!(states[8].w[0] < 0.7, "it slows down");
    }
}

/// A rod on a wall and two like it that meet halfway do the same on rigid foundations, whichever side is named first.
#[test]
fn impacts_of_pairs_are_those_of_walls() {
    let wall = ["contact.normal={ law = \"signorini\" }".to_owned()];
    let alone = solve(&rod(&wall)).states.pop().expect("a state");
    let pair = |swapped: bool| {
        let mut text = PAIR.replace(COMPLIANT, "normal = { law = \"signorini\" }");
        if swapped {
            text = text.replace(
                "on = \"second_left\"\nwith = \"first_right\"",
                "on = \"first_right\"\nwith = \"second_left\"",
            );
        }
        let problem = case::parse(&Source::new("pair.toml", &text), &[]).unwrap_or_else(|faults| panic!("{faults}"));
        solve(&problem.problem).states.pop().expect("a state")
    };
    for swapped in [false, true] {
        let pair = pair(swapped);
        let n = alone.w.len();
        for (found, expected) in pair.w[n..].iter().zip(&alone.w) {
            assert!((found - expected).abs() < 1e-11, "swapped {swapped}: {found}, expected {expected}");
        }
        assert!((pair.ledger.impact_dissipation - 2.0 * alone.ledger.impact_dissipation).abs() < 1e-12);
    }
    assert!(alone.ledger.impact_dissipation > 1e-3, "nothing hits");
}

/// A rod that wears on a belt and is pressed on by δ = a t: h = a (t − τ (1 − exp(−t/τ))) with τ of its benchmark. The
/// depth is of order 2 at ϑ = ½ and of order 1 with backward Euler, and the energy lost with wear closes the identity.
#[test]
fn wear_is_of_second_order() {
    let file = common::file("crates/amontons/benchmarks/wear-relaxation-compliance.toml");
    let (a, t, tau) = (0.02, 5.0, 50.0 / 9.0);
    let exact = a * (t - tau * (1.0 - f64::exp(-t / tau)));
    let error = |steps: usize, scheme: &str| {
        let gap = format!("contact.gap=\"-{a}*t\"");
        let overrides = [format!("time.steps={steps}"), format!("time.scheme={scheme}"), gap];
        let problem = case::read(&file, &overrides).unwrap_or_else(|error| panic!("{error}")).problem;
        let state = solve(&problem).states.pop().expect("a state");
        let ledger = &state.ledger;
        assert!(ledger.wear_dissipation > 0.0 && ledger.closing_error.abs() <= 1e-12 * ledger.turned_over, "{scheme}");
        state.surface.wear.iter().fold(0.0f64, |most, depth| most.max((depth - exact).abs()))
    };
    for (scheme, order) in [("theta", 2.0), ("euler", 1.0)] {
        let found = (error(20, scheme) / error(80, scheme)).log2() / 2.0;
        assert!((found - order).abs() < 0.05, "{scheme}: order {found}");
    }
}

/// A rod with a Maxwell branch that is drawn at the rate a: its spring has the strain a τ (1 − exp(−t/τ)) at all times.
/// Of order 2 at ϑ = ½ and of order 1 with backward Euler; energy closes with a time that is one for the body, and with
/// one that varies.
#[test]
fn branches_relax_to_second_order() {
    const DRAWN: &str = r#"
name = "drawn"
units = "dimensionless"
[mesh]
kind = "interval"
size = 1.0
n = 4
[time]
end = 2.0
steps = 20
inertia = false
[material]
elasticity = { law = "isotropic", young = 3.0, poisson = 0.0 }
prony = [{ ratio = 0.5, time = 0.8 }]
[[boundary]]
on = "left"
displacement = [0]
[[boundary]]
on = "right"
displacement = ["0.3*t"]
[initial]
velocity = ["0.3*x"]
"#;
    let (a, t, tau) = (0.3, 2.0, 0.8);
    let exact = a * tau * (1.0 - f64::exp(-t / tau));
    let end = |steps: usize, more: &[&str]| {
        let mut overrides = vec![format!("time.steps={steps}")];
        overrides.extend(more.iter().map(|&more| more.to_owned()));
        let problem = case::parse(&Source::new("drawn.toml", DRAWN), &overrides);
        let state = solve(&problem.unwrap_or_else(|faults| panic!("{faults}")).problem).states.pop().expect("a state");
        let ledger = &state.ledger;
        assert!(ledger.viscous_dissipation > 0.0 && ledger.closing_error.abs() <= 1e-12 * ledger.turned_over);
        state
    };
    let error = |steps: usize, scheme: &str| {
        let state = end(steps, &[&format!("time.scheme={scheme}")]);
        (state.branches[0].last().expect("an end") - exact).abs()
    };
    for (scheme, order) in [("theta", 2.0), ("euler", 1.0)] {
        let found = (error(40, scheme) / error(160, scheme)).log2() / 2.0;
        assert!((found - order).abs() < 0.05, "{scheme}: order {found}");
    }
    let varying = "material.prony=[{ ratio = 0.5, time = \"0.8 + 0.3*x\" }]";
    for theta in ["time.theta=0.5", "time.theta=0.7"] {
        end(20, &["time.scheme=theta", theta, varying]);
    }
}

/// ϑ = 1 is backward Euler to the bit.
#[test]
fn at_one_it_is_backward_euler() {
    for overrides in [&["mesh.n=8", "time.steps=8"][..], &["mesh.n=8", "time.steps=8", "scheme.coupling=monolithic"]] {
        let run = |more: &[&str]| {
            let problem = common::paper(&[overrides, more].concat()).problem;
            solve(&problem).states.pop().expect("a state")
        };
        let (euler, theta) = (run(&[]), run(&["time.scheme=theta", "time.theta=1.0"]));
        assert!(euler == theta, "{overrides:?}");
    }
}

/// Laws that the scheme does not take are refused by name.
#[test]
fn laws_that_it_does_not_take_are_refused() {
    let refused = |overrides: &[&str]| {
        let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
        case::parse(&Source::new("rod.toml", ROD), &overrides)
            .err()
            .map(|faults| faults.to_string())
            .unwrap_or_default()
    };
    let told = refused(&["contact.normal={ law = \"stop\", stiffness = 500.0, depth = 0.1 }"]);
    let expected =
        "contact.normal: found a law with a rigid stop behind a layer, with time.scheme = \"theta\", expected a layer";
    assert!(told.contains(expected) && told.contains("time.scheme = \"euler\""), "{told}");
    let told = refused(&["time.theta=0.4"]);
    assert!(told.contains("time.theta: found 0.4, expected a number"), "{told}");
    for (key, found) in
        [("theta=0.6", "0.6"), ("restitution=0.5", "0.5"), ("pressure=plain", "\"plain\""), ("friction=end", "\"end\"")]
    {
        let told = refused(&["time.scheme=euler", &format!("time.{key}")]);
        let name = key.split('=').next().unwrap_or_default();
        let expected = format!("time.{name}: found {found} with the scheme \"euler\", expected a key of the scheme");
        assert!(told.contains(&expected), "{told}");
    }
    let told = refused(&["time.theta=0.6", "time.restitution=0.7"]);
    assert!(told.contains("time.restitution: found 0.7 with theta = 0.6, expected a number from 0 to 0.66"), "{told}");
    let wear = "contact.wear={ law = \"archard\", coefficient = 0.05 }";
    let told = refused(&["time.friction=end", wear]);
    assert!(told.contains("contact.wear: found wear with time.friction = \"end\""), "{told}");
}
