//! The contact-stabilised Newmark scheme: two rods that collide by an independent program, what it shares with the
//! ϑ-scheme, identities of random motions, restarts, supports, and what it refuses. Its other reference cases are those
//! of `theta` and `bar`.

use amontons::case::{self, Source};
use amontons::output::Memory;
use amontons::problem::Problem;
use amontons::run::with_threads;
use amontons::step::{March, Scheme};

use crate::common::{self, Random, solve};

const BLOCK: &str = "crates/amontons/tests/reference/time/block-stabilised.toml";
const RODS: &str = "crates/amontons/tests/reference/time/two-rods-stabilised.toml";
/// Gap that a pressed point may have at the end of a step, over the gaps of the cases.
const TOUCHES: f64 = 1e-11;

fn problem(file: &str, keys: &[String]) -> Problem {
    case::read(&common::file(file), keys).unwrap_or_else(|error| panic!("{error}")).problem
}

fn parsed(text: &str, keys: &[String]) -> Problem {
    case::parse(&Source::new("case.toml", text), keys).unwrap_or_else(|error| panic!("{error}")).problem
}

/// Asserts that the identity closes, that no point is inside its rigid foundation or pressed apart from it, and that
/// neither impacts nor, without wear and moving supports, the scheme give energy.
fn holds(name: &str, memory: &Memory, is_taken: bool) {
    for (pair, report) in memory.states.windows(2).zip(&memory.reports) {
        let [before, now] = [0, 1].map(|i| &pair[i].ledger);
        let (step, size) = (pair[1].step, now.turned_over);
        let open = now.closing_error.abs();
        assert!(open <= 1e-12 * size, "{name}, step {step}: energy closes to {open:e} of {size:e}");
        let taken_by = [
            ("the scheme", now.scheme_dissipation - before.scheme_dissipation),
            ("an impact", now.impact_dissipation - before.impact_dissipation),
            ("friction", now.friction_dissipation - before.friction_dissipation),
        ];
        for (what, taken) in taken_by.into_iter().skip(usize::from(!is_taken)) {
            assert!(taken >= -1e-12 * size, "{name}, step {step}: {what} gives {taken:e} of {size:e}");
        }
        for state in &report.contact.states {
            assert!(state.penetration <= TOUCHES, "{name}, step {step}: inside by {:e}", state.penetration);
            assert!(state.pressure == 0.0 || state.penetration >= -TOUCHES, "{name}, step {step}: pressed apart");
        }
    }
}

/// The block thrown on a plane with random velocities, loads, gaps, friction and viscosity, with and without wear.
#[test]
fn identities_close_in_random_motions() {
    let mut random = Random(50);
    for number in 0..12 {
        let mut within = |from: f64, to: f64| from + (to - from) * 0.5 * (random.number() + 1.0);
        let mut keys = vec![
            format!(
                "initial.velocity=[\"{} + {}*y\", \"{} + {}*x\"]",
                within(-1.0, 1.0),
                within(-1.0, 1.0),
                within(-1.5, -0.2),
                within(-1.0, 1.0)
            ),
            format!("load.body_force=[{}, {}]", within(-2.0, 2.0), within(-5.0, 0.0)),
            format!("contact.gap=\"{} + {}*x\"", within(0.0, 0.02), within(0.0, 0.01)),
            format!("contact.friction.coefficient={}", within(0.0, 0.8)),
            format!("contact.foundation_velocity=[{}, 0]", within(-1.0, 1.0)),
            format!("material.viscosity.second={}", within(0.0, 0.1)),
            format!("material.elasticity.young={}", within(20.0, 500.0)),
        ];
        if number % 3 == 2 {
            keys.push("contact.wear={ law = \"archard\", coefficient = 0.002 }".to_owned());
        }
        let memory = solve(&problem(BLOCK, &keys));
        holds(&format!("throw {number}"), &memory, number % 3 != 2);
        let pressed = memory.reports.iter().flat_map(|report| &report.contact.states).filter(|s| s.pressure > 0.0);
        assert!(pressed.count() > 5, "throw {number} hits");
        let end = &memory.states[memory.states.len() - 1].ledger;
        assert!(end.impact_dissipation > 0.0 && end.scheme_dissipation != 0.0, "throw {number} has impacts");
    }
}

/// Two rods of one length change their velocities, and one that hits another of twice its length rests.
#[test]
fn rods_collide_as_in_an_independent_program() {
    for (n, length, time, [momentum, energy, left, right]) in [
        (
            [50, 50],
            1.0,
            "{ end = 0.35, steps = 700, scheme = \"contact-stabilised\" }",
            [0.987_122_649_670_347_9, 0.996_682_551_491_860_4, 0.112_762_608_720_191_32, 0.237_237_391_279_812_55],
        ),
        (
            [40, 80],
            2.0,
            "{ end = 0.29975, steps = 545, scheme = \"contact-stabilised\" }",
            [0.996_983_792_020_638_7, 0.998_779_340_976_586_5, 0.110_197_225_862_238_27, 0.089_557_907_342_515_63],
        ),
    ] {
        let blocks = format!(
            "mesh.blocks=[{{ name = \"lower\", size = [1.0], n = [{}] }}, {{ name = \"upper\", size = [{length:?}], n = [{}], origin = [1.0102] }}]",
            n[0], n[1]
        );
        let memory = solve(&problem(RODS, &[blocks, format!("time={time}")]));
        holds("two rods", &memory, true);
        let state = &memory.states[memory.states.len() - 1];
        // The right rod has cells of 1/n and all its momentum in the trapezoidal sum of its nodes.
        let (w, cell) = (&state.w[n[0] + 1..], length / f64::from(n[1] as u32));
        let of_right = cell * (w.iter().sum::<f64>() - 0.5 * (w[0] + w[w.len() - 1]));
        let found =
            [of_right, (state.ledger.kinetic + state.ledger.elastic) / 0.5, state.u[0], state.u[state.u.len() - 1]];
        for (what, (found, expected)) in ["momentum", "energy", "the left end", "the right end"]
            .iter()
            .zip(found.iter().zip([momentum, energy, left, right]))
        {
            assert!((found - expected).abs() < 1e-8, "{what} of {n:?}: {found}, expected {expected}");
        }
    }
}

const DRIVEN: &str = "name = \"driven\"\nunits = \"dimensionless\"\n[mesh]\nkind = \"interval\"\nsize = 1.0\nn = 16\n\
    [time]\nend = 1.0\nsteps = 100\nscheme = \"contact-stabilised\"\n[material]\ndensity = 1.0\n\
    elasticity = { law = \"isotropic\", young = 50.0, poisson = 0.0 }\n\
    viscosity = { law = \"lame\", first = 0.0, second = 0.5 }\n\
    [[boundary]]\non = \"right\"\ndisplacement = [\"-0.06*t^2\"]\n\
    [contact]\non = \"left\"\ngap = 0.02\nnormal = { law = \"signorini\" }\n";

fn with(keys: &[&str]) -> Vec<String> {
    keys.iter().map(|key| (*key).to_owned()).collect()
}

/// Without a rigid foundation that is reached the steps are those of the ϑ-scheme at ϑ = ½, to the bit: with layers,
/// and with supports that accelerate the body.
#[test]
fn without_impacts_it_is_the_midpoint_rule() {
    for keys in [&["contact.normal={ law = \"compliance\", stiffness = 300 }"][..], &["contact.gap=0.2"][..]] {
        let own = solve(&parsed(DRIVEN, &with(keys)));
        let theta = solve(&parsed(DRIVEN, &[with(keys), with(&["time.scheme=theta"])].concat()));
        assert!(own.states == theta.states, "{keys:?}: other bits");
        let reaction = |memory: &Memory| memory.reports.iter().map(|r| r.reactions.force.clone()).collect::<Vec<_>>();
        assert!(reaction(&own) == reaction(&theta), "{keys:?}: other reactions");
    }
}

/// A rod that is pushed against a wall by a support that accelerates presses as with backward Euler and many steps.
#[test]
fn a_support_pushes_a_rod_against_a_wall() {
    let end = |keys: &[&str]| {
        let memory = solve(&parsed(DRIVEN, &with(keys)));
        let pressure = memory.reports[memory.reports.len() - 1].contact.states[0].pressure;
        (memory, pressure)
    };
    let (memory, pressure) = end(&["time.steps=400"]);
    holds("driven", &memory, false);
    let (exact, expected) = end(&["time.scheme=euler", "time.steps=6400"]);
    assert!((pressure / expected - 1.0).abs() < 0.01, "{pressure}, expected {expected}");
    let [own, other] = [&memory, &exact].map(|memory| &memory.states[memory.states.len() - 1].u);
    for (own, other) in own.iter().zip(other) {
        assert!((own - other).abs() < 0.01 * 0.06, "{own}, expected {other}");
    }
}

/// A block that is pressed, held and let go in phases of other steps and supports, with impacts on the way: the
/// identity closes through all of it, and from every state, with what was kept, the run goes on with the same bits, on
/// one thread and on several.
#[test]
fn a_run_goes_on_through_phases_with_the_same_bits() {
    let phases = "phase=[{ name = \"press\", end = 0.04, steps = 2, analysis = \"quasistatic\" }, { name = \"throw\", end = 0.1, steps = 12 }, { name = \"let\", end = 0.2, steps = 25 }]";
    let keys = with(&[
        phases,
        "boundary=[{ on = \"top\", displacement = [\"0.1*t\", \"-0.06*sin(20*t)\"], phases = [\"press\", \"throw\"] }]",
        "initial.velocity=[0, 0]",
    ]);
    let text = std::fs::read_to_string(common::file(BLOCK)).expect("the case");
    let text = common::spoil(&text, "end = 0.2\nsteps = 40\n", "");
    let text = common::spoil(&text, "[[boundary]]\non = \"top\"\ntraction = [0, 0]\n", "");
    let problem = parsed(&text, &keys);
    let run = |threads: usize| {
        with_threads(Some(threads), || {
            let mut scheme = March::new(&problem).expect("regular systems");
            let mut states = vec![(scheme.initial().expect("finite data"), scheme.kept())];
            while states.len() <= problem.timeline.steps() {
                let next = scheme.step(&states[states.len() - 1].0).unwrap_or_else(|error| panic!("{error}"));
                states.push((next.0, scheme.kept()));
            }
            states
        })
        .unwrap_or_else(|error| panic!("{error}"))
    };
    let (one, several) = (run(1), run(3));
    assert!(one == several, "the number of threads changes bits");
    for pair in one.windows(2) {
        let mut again = March::new(&problem).expect("regular systems");
        again.recall(&pair[0].1).expect("regular systems");
        let found = again.step(&pair[0].0).unwrap_or_else(|error| panic!("{error}")).0;
        assert!(found == pair[1].0 && again.kept() == pair[1].1, "step {}", found.step);
        let ledger = &found.ledger;
        assert!(ledger.closing_error.abs() <= 1e-12 * ledger.turned_over, "step {} closes", found.step);
    }
    assert!(one.iter().any(|(state, _)| state.ledger.impact_dissipation > 0.0), "it hits");
}

/// The scheme converges on a fixed mesh, with order 2 if the impact falls on no step, to a limit of its own: 6 % from
/// that of impacts without rebound.
#[test]
fn the_limit_is_its_own() {
    let file = "crates/amontons/tests/reference/time/rod-stabilised.toml";
    let end = |steps: usize, scheme: &str| {
        let keys = [format!("time.steps={steps}"), format!("time.scheme={scheme}")];
        solve(&problem(file, &keys)).states.pop().expect("a state").u
    };
    let apart = |a: &[f64], b: &[f64]| {
        let difference: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
        common::largest(&difference) / common::largest(b)
    };
    let exact = end(7680, "contact-stabilised");
    let errors = [120, 480].map(|steps| apart(&end(steps, "contact-stabilised"), &exact));
    let order = (errors[0] / errors[1]).log2() / 2.0;
    assert!(order > 1.7 && errors[1] < 2e-3, "order {order}, {errors:?}");
    let other = apart(&end(7680, "theta"), &exact);
    assert!((0.03..0.1).contains(&other), "the ϑ-scheme is apart by {other}");
}

#[test]
fn data_that_it_does_not_take_are_refused() {
    for (keys, expected) in [
        (
            &["material.density=0"][..],
            "material.density: found 0 at x = 0.0, y = 0.0, with time.scheme = \"contact-stabilised\", expected a positive number",
        ),
        (
            &["rigid=[{ on = \"body\" }]"],
            "contact.normal: found a rigid foundation of a rigid part, with time.scheme = \"contact-stabilised\", expected a part that deforms",
        ),
        (
            &["contact.normal={ law = \"stop\", stiffness = 20.0, depth = 0.1 }"],
            "contact.normal: found a law with a rigid stop behind a layer, with time.scheme = \"contact-stabilised\"",
        ),
        (
            &["time.theta=0.5"],
            "time.theta: found 0.5 with the scheme \"contact-stabilised\", expected a key of the scheme \"theta\"",
        ),
    ] {
        let refused = case::read(&common::file(BLOCK), &with(keys)).err().map(|error| error.to_string());
        let told = refused.unwrap_or_default();
        assert!(told.contains(expected), "{keys:?}: {told}");
    }
}
