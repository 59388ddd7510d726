//! Layers that damp, soften or change, foundations that warm up and heat laws of the temperature in the schemes of
//! second order: closed forms, orders, identities.

use amontons::case::{self, Source};
use amontons::output::Memory;
use amontons::step::{March, Scheme};

use crate::common::{self, solve};

/// The schemes of second order.
const SCHEMES: [&str; 2] = ["time.scheme=theta", "time.scheme=bdf2"];

/// A run with other keys, whose identities close.
fn run(text: &str, keys: &[&str]) -> Memory {
    let keys: Vec<String> = keys.iter().map(|&key| key.to_owned()).collect();
    let problem = case::parse(&Source::new("layer.toml", text), &keys).unwrap_or_else(|error| panic!("{error}"));
    let memory = solve(&problem.problem);
    let ledger = &memory.states.last().expect("a state").ledger;
    assert!(
        ledger.closing_error.abs() <= 1e-12 * ledger.turned_over.max(1e-300),
        "{keys:?}: {:e}",
        ledger.closing_error
    );
    let heat = ledger.heat_closing_error.abs();
    assert!(heat <= 1e-11 * ledger.heat_turned_over.max(1e-300), "{keys:?}: {heat:e}");
    memory
}

fn benchmark(name: &str) -> String {
    std::fs::read_to_string(common::file(&format!("crates/amontons/benchmarks/{name}.toml"))).expect("a benchmark")
}

/// Asserts the order of a number of a run, from its errors with steps and four times as many.
fn order(name: &str, errors: [f64; 2], expected: f64) {
    let found = (errors[0] / errors[1]).log2() / 2.0;
    assert!((found - expected).abs() < 0.25, "{name}: order {found} of {errors:?}");
}

/// Restitution by a spring and a dashpot that do not pull, ζ = 0.3, exp(−2ζ arccos ζ/√(1 − ζ²)): the kinetic energy
/// that is left, and the scheme takes none of it. The dashpot presses from the contact on with d v₀: the step in which
/// this begins leaves an error of the second order with a sign that depends on where in the step it is.
#[test]
fn a_damped_layer_leaves_the_velocity_that_is_known() {
    let text = benchmark("impact-damped-layer");
    let left = 0.5 * 0.450_975_452_893_128_46f64.powi(2);
    let at = |steps: &str, scheme: &str| {
        let keys = [steps, scheme, "material.elasticity.young=1e9"];
        let ledger = run(&text, &keys).states.pop().expect("a state").ledger;
        ((ledger.kinetic - left).abs(), ledger.scheme_dissipation.abs(), ledger.viscous_dissipation)
    };
    let (error, taken, damped) = at("time.steps=4000", SCHEMES[0]);
    assert!(error < 2e-7 && taken < 1e-13 && (damped - (0.5 - left)).abs() < 2e-7, "{error:e} {taken:e} {damped:e}");
    let (error, ..) = at("time.steps=4000", SCHEMES[1]);
    assert!(error < 1e-4, "{error:e}");
}

/// Damping that grows with the penetration has no such step.
#[test]
fn damping_that_grows_with_the_penetration_is_of_second_order() {
    let text = benchmark("impact-hunt-crossley");
    for scheme in SCHEMES {
        let left = |steps: &str| {
            let ledger = run(&text, &[steps, scheme]).states.pop().expect("a state").ledger;
            assert!(scheme != SCHEMES[0] || ledger.scheme_dissipation.abs() < 1e-13, "{:e}", ledger.scheme_dissipation);
            ledger.kinetic
        };
        let exact = left("time.steps=16000");
        let errors = ["time.steps=500", "time.steps=2000"].map(|steps| (left(steps) - exact).abs());
        order(scheme, errors, 2.0);
    }
}

/// A mass on a layer that softens, and snaps through: at ϑ = ½ it keeps its energy.
#[test]
fn a_softening_layer_keeps_the_energy_and_is_of_second_order() {
    let text = benchmark("snap-through-softening-layer");
    for scheme in SCHEMES {
        let ends = ["time.steps=200", "time.steps=800", "time.steps=6400"].map(|steps| {
            let state = run(&text, &[steps, scheme]).states.pop().expect("a state");
            let taken = state.ledger.scheme_dissipation.abs();
            assert!(scheme != SCHEMES[0] || taken < 1e-13, "{steps}: the scheme took {taken:e}");
            state.ledger.kinetic
        });
        order(scheme, [0, 1].map(|i| (ends[i] - ends[2]).abs()), 2.0);
    }
}

/// A mass m = 1 under g = 1 on a layer that loosens, c = 10/(1 + t)²: u = (1 + t)²/12 + (1 + t)^½ cos(ω ln(1 + t))/50,
/// ω² = 10 − ¼, by Euler's equation. The mass is a rod of one element, 10⁹ times as stiff.
#[test]
fn a_layer_that_changes_with_time_is_of_second_order() {
    let text = "name = \"loosens\"\n[mesh]\nkind = \"interval\"\nsize = 1.0\nn = 1\n[time]\nend = 2.0\nsteps = 10\n\
        [material]\ndensity = 1.0\nelasticity = { law = \"isotropic\", young = 1e10, poisson = 0.0 }\n\
        [load]\nbody_force = [1]\n[initial]\ndisplacement = [\"1/12 + 1/50\"]\nvelocity = [\"1/6 + 1/100\"]\n\
        [contact]\non = \"right\"\nnormal = { law = \"compliance\", stiffness = \"10/(1 + t)^2\" }\n";
    let exact = 0.75 + 3f64.sqrt() * (9.75f64.sqrt() * 3f64.ln()).cos() / 50.0;
    for scheme in SCHEMES {
        let errors = ["time.steps=50", "time.steps=200"].map(|steps| {
            let memory = run(text, &[steps, scheme]);
            let state = memory.states.last().expect("a state");
            let ledger = &state.ledger;
            assert!(ledger.modulus_work < -0.01 * ledger.turned_over, "the layer gives energy: {ledger:?}");
            assert!(scheme != SCHEMES[0] || ledger.scheme_dissipation.abs() < 1e-12, "{:e}", ledger.scheme_dissipation);
            // The energy in the history is that of the layer at the end.
            let of_layer = 0.5 * 10.0 / 9.0 * state.u[1].powi(2);
            assert!((ledger.contact_energy - of_layer).abs() < 1e-12, "{:e} of {of_layer:e}", ledger.contact_energy);
            (state.u[1] - exact).abs()
        });
        order(scheme, errors, 2.0);
    }
}

/// A body and a foundation that exchange heat, θ − θ_F = exp(−3t): of second order, and nothing is lost.
#[test]
fn a_foundation_that_warms_up_is_of_second_order() {
    let text = benchmark("foundation-two-capacities");
    let exact = 0.517_913_226_567_713_4;
    for scheme in SCHEMES {
        let errors = ["time.steps=10", "time.steps=40"].map(|steps| {
            let keys = [steps, scheme, "material.conductivity=1e8"];
            let memory = run(&text, &keys);
            let state = memory.states.last().expect("a state");
            let kept = state.ledger.heat_content + state.ledger.heat_foundation;
            assert!((kept - 1.0).abs() < 1e-9, "{scheme}: {kept}");
            (state.surface.foundation[0].expect("a foundation that warms up") - exact).abs()
        });
        order(scheme, errors, 2.0);
    }
}

/// A step goes on from a state that was kept, foundations with their state before included.
#[test]
fn a_foundation_goes_on_from_a_kept_state() {
    let keys = ["time.steps=6", "time.scheme=bdf2"].map(str::to_owned);
    let text = benchmark("foundation-two-capacities");
    let problem =
        case::parse(&Source::new("layer.toml", text.as_str()), &keys).unwrap_or_else(|error| panic!("{error}"));
    let memory = solve(&problem.problem);
    for states in memory.states.windows(2) {
        let mut march = March::new(&problem.problem).expect("a regular system");
        let next = march.step(&states[0]).expect("a step").0;
        assert_eq!(next.surface, states[1].surface, "step {}", next.step);
    }
}

/// H = θ + θ²/2 and K = ϰ (1 + θ), so that H obeys the linear heat equation: in a rod without loss H = 2 + cos(πx) ×
/// exp(−ϰπ²t). Order in time by runs with twice as many steps each, and the closed form to the order of the cells.
#[test]
fn heat_laws_of_the_temperature_are_of_second_order() {
    let text = "name = \"enthalpy\"\n[mesh]\nkind = \"interval\"\nsize = 1.0\nn = 40\n[time]\nend = 1.0\nsteps = 8\n\
        [material]\nheat_capacity = { temperature = [0, 4], value = [1, 5] }\n\
        conductivity = { temperature = [0, 4], value = [0.2, 1.0] }\n\
        [initial]\ntemperature = \"sqrt(1 + 2*(2 + cos(pi*x))) - 1\"\n";
    for (scheme, expected) in [(SCHEMES[0], 2.0), (SCHEMES[1], 2.0), ("time.scheme=euler", 1.0)] {
        let ends = ["time.steps=20", "time.steps=40", "time.steps=80"].map(|steps| {
            let memory = run(text, &[steps, scheme]);
            let state = memory.states.last().expect("a state");
            let content = state.ledger.heat_content;
            assert!((content - memory.states[0].ledger.heat_content).abs() < 1e-11, "{scheme}: {content}");
            state.theta[0]
        });
        let found = ((ends[0] - ends[1]) / (ends[1] - ends[2])).log2();
        assert!((found - expected).abs() < 0.2, "{scheme}: order {found} of {ends:?}");
        let exact = (1.0 + 2.0 * (2.0 + (-0.2 * std::f64::consts::PI.powi(2)).exp())).sqrt() - 1.0;
        let error = (ends[2] - exact).abs();
        assert!(error < if expected > 1.5 { 2e-4 } else { 2e-2 }, "{scheme}: {error:e}");
    }
}
