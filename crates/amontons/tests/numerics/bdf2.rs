//! BDF2: the states of a case by an independent program, orders, identities, and restarts.

use amontons::case;
use amontons::output::Memory;
use amontons::state::State;
use amontons::step::{March, Scheme};

use crate::common::{self, solve};
use crate::theta::{PRESSED, run_as_expected};

/// Asserts that both identities close to round-off at the end of each step.
fn closes(name: &str, memory: &Memory) {
    for State { step, ledger, .. } in &memory.states {
        let [energy, heat] = [ledger.closing_error.abs(), ledger.heat_closing_error.abs()];
        assert!(energy <= 1e-12 * ledger.turned_over, "{name}, step {step}: energy closes to {energy:e}");
        assert!(heat <= 1e-12 * ledger.heat_turned_over.max(1.0), "{name}, step {step}: heat closes to {heat:e}");
    }
}

fn run(file: &str, overrides: &[String]) -> Memory {
    let problem = case::read(&common::file(file), overrides).unwrap_or_else(|error| panic!("{error}")).problem;
    solve(&problem)
}

fn words(all: &[&str]) -> Vec<String> {
    all.iter().map(|word| (*word).to_owned()).collect()
}

#[test]
fn states_agree_with_an_independent_program() {
    let (memory, expected) = run_as_expected("bdf2-closed", 1e-9);
    closes("bdf2-closed", &memory);
    let state = memory.states.last().expect("a state");
    for (key, found) in [
        ("kinetic", state.ledger.kinetic),
        ("elastic", state.ledger.elastic),
        ("contact_energy", state.ledger.contact_energy),
    ] {
        let expected = expected["energy"][key].as_f64().expect("a number");
        assert!((found - expected).abs() <= 1e-9 * state.ledger.turned_over, "{key}: {found:e}, expected {expected:e}");
    }
}

/// The largest differences of u and θ at the end.
fn apart(a: &State, b: &State) -> [f64; 2] {
    let of = |a: &[f64], b: &[f64]| a.iter().zip(b).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
    [of(&a.u, &b.u), of(&a.theta, &b.theta)]
}

/// A block pressed on a belt that rubs and warms it, with a branch that relaxes: order 2 with all couplings but the
/// staggered one. What the scheme took is half a step of the power at the end, and does not add up.
#[test]
fn orders_of_the_couplings() {
    let file = "crates/amontons/tests/reference/time/bdf2-closed.toml";
    let end = |steps: usize, coupling: &str| {
        let relaxes = words(&[
            "material.elasticity={ law = \"isotropic\", young = 60.0, poisson = 0.3, stress_state = \"plane-strain\" }",
            "material.prony=[{ ratio = 0.4, time = 0.3 }]",
        ]);
        let own = words(&[&format!("time.steps={steps}"), &format!("scheme.coupling={coupling}")]);
        let mut memory = run(file, &[words(&PRESSED), relaxes, own].concat());
        closes(coupling, &memory);
        memory.states.pop().expect("a state")
    };
    let exact = end(2560, "monolithic");
    for (coupling, order) in [("monolithic", 2.0), ("extrapolated", 2.0), ("staggered", 1.0)] {
        let states = [80, 320].map(|steps| end(steps, coupling));
        let errors = [0, 1].map(|i| apart(&states[i], &exact));
        for i in [0, 1] {
            let found = (errors[0][i] / errors[1][i]).log2() / 2.0;
            assert!((found - order).abs() < 0.2, "{coupling}: order {found} of {}", ["u", "θ"][i]);
        }
        let taken = states.map(|state| (state.ledger.scheme_dissipation / state.ledger.turned_over).abs());
        assert!(taken[0] < 1e-2 && taken[1] < 0.3 * taken[0], "{coupling}: the scheme took {taken:?}");
    }
}

/// A rod heated from one end by the flux of a stopping brake, so long that its other end stays cold: a half-space. The
/// temperatures at the surface are T(t) = 2 q₀ √t (1 − 2t/(3 t_s))/(e √π) with e = √(k ρ c).
#[test]
fn heat_alone_is_of_second_order() {
    let at_the_surface = |steps: usize, scheme: &str| {
        let text = "name = \"half-space\"\n[mesh]\nkind = \"interval\"\nsize = 0.06\nn = 600\n\
            [time]\nend = 4\nsteps = 16\n[material]\nheat_capacity = 3588000\nconductivity = 50\n\
            [[boundary]]\non = \"left\"\nheat_inflow = \"1e6*(1 - t/4)\"\n";
        let keys = words(&[&format!("time.steps={steps}"), &format!("time.scheme={scheme}")]);
        let problem = case::parse(&case::Source::new("half-space.toml", text), &keys);
        let memory = solve(&problem.unwrap_or_else(|error| panic!("{error}")).problem);
        closes(scheme, &memory);
        memory.states.last().expect("a state").theta[0]
    };
    // √t at the start is not smooth, so the order is that of the start; the error is far below that of backward Euler.
    let errors = ["euler", "bdf2"].map(|scheme| (at_the_surface(64, scheme) - 56.163_295).abs() / 56.163_295);
    assert!(errors[1] < 2e-3 && errors[1] < 0.25 * errors[0], "{errors:?}");
}

/// A beam of a body that is thrown, with a quasistatic start, phases of two lengths, and steps halved by a law that
/// softens: the identities close through each start of the formula.
#[test]
fn identities_close_where_the_formula_starts_anew() {
    let text = "name = \"rod\"\n[mesh]\nkind = \"interval\"\nsize = 1.0\nn = 8\n[time]\nscheme = \"bdf2\"\n\
        [[phase]]\nname = \"press\"\nend = 0.2\nsteps = 2\nanalysis = \"quasistatic\"\n\
        [[phase]]\nname = \"let\"\nend = 0.6\nsteps = 40\n[[phase]]\nname = \"on\"\nend = 1.2\nsteps = 15\n\
        [material]\ndensity = 1.0\nelasticity = { law = \"isotropic\", young = 100.0, poisson = 0.0 }\n\
        prony = [{ ratio = 0.5, time = 0.3 }]\n[load]\nbody_force = [\"if(t <= 0.2, 5*t, 0)\"]\n\
        [[boundary]]\non = \"left\"\ndisplacement = [0]\n[contact]\non = \"right\"\ngap = 0.001\n\
        normal = { law = \"compliance\", stiffness = 300 }\n";
    let problem = case::parse(&case::Source::new("rod.toml", text), &[]).unwrap_or_else(|error| panic!("{error}"));
    let memory = solve(&problem.problem);
    closes("rod", &memory);
    let last = &memory.states.last().expect("a state").ledger;
    assert!(last.viscous_dissipation > 0.01 * last.turned_over && last.kinetic > 0.0, "it moves and relaxes");
}

#[test]
fn laws_that_it_does_not_take_are_refused() {
    let file = "crates/amontons/tests/reference/time/bdf2-closed.toml";
    for (key, expected) in [
        (
            "contact.wear={ law = \"archard\", coefficient = 0.05 }",
            "contact.wear: found wear, whose depth is a sum over steps of first order, with time.scheme = \"bdf2\", expected none",
        ),
        ("time.theta=0.5", "time.theta: found 0.5 with the scheme \"bdf2\", expected a key of the scheme \"theta\""),
        (
            "time.scheme=bdf3",
            "time.scheme: found \"bdf3\", expected \"euler\", \"theta\", \"bdf2\" or \"contact-stabilised\"",
        ),
    ] {
        let refused = case::read(&common::file(file), &words(&[key])).err().map(|error| error.to_string());
        let told = refused.unwrap_or_default();
        assert!(told.contains(expected), "{key}: {told}");
    }
}

const ROD: &str = "name = \"rod\"\nunits = \"dimensionless\"\n[mesh]\nkind = \"interval\"\nsize = 1.0\nn = 4\n\
    [material]\ndensity = 1.0\nelasticity = { law = \"isotropic\", young = 4.0, poisson = 0.0 }\n\
    viscosity = { law = \"lame\", first = 0.0, second = 0.1 }\n[[boundary]]\non = \"left\"\ndisplacement = [0]\n";

/// A foundation that moves on a damped layer, p = c r + d ṙ: the rate of the gap is of second order, too.
#[test]
fn a_damped_layer_on_a_moving_foundation_is_of_second_order() {
    let text = format!(
        "{ROD}[time]\nend = 1.0\nsteps = 10\nscheme = \"bdf2\"\n[contact]\non = \"right\"\ngap = \"-0.1*t^3\"\n\
        normal = {{ law = \"damped\", stiffness = 20.0, damping = 5.0 }}\n"
    );
    let end = |steps: usize| {
        let keys = words(&[&format!("time.steps={steps}")]);
        let problem = case::parse(&case::Source::new("rod.toml", text.as_str()), &keys);
        let memory = solve(&problem.unwrap_or_else(|error| panic!("{error}")).problem);
        closes("damped layer", &memory);
        let pressure = memory.reports.last().expect("a report").contact.states[0].pressure;
        (memory.states.last().expect("a state").u[4], pressure)
    };
    let exact = end(5120);
    let errors = [40, 160].map(end).map(|(u, p)| [(u - exact.0).abs(), (p - exact.1).abs()]);
    for i in [0, 1] {
        let order = (errors[0][i] / errors[1][i]).log2() / 2.0;
        assert!((order - 2.0).abs() < 0.2, "order {order} of {}", ["u", "p"][i]);
    }
}

/// Where conditions change the next step is one of backward Euler, although its length is that of the step before.
#[test]
fn a_change_of_conditions_starts_the_formula_anew() {
    let text = format!(
        "{ROD}[[boundary]]\non = \"right\"\ndisplacement = [\"0.1*t\"]\nphases = [\"draw\"]\n[time]\nscheme = \"bdf2\"\n\
        [[phase]]\nname = \"draw\"\nend = 1.0\nsteps = 10\n[[phase]]\nname = \"free\"\nend = 2.0\nsteps = 10\n"
    );
    let read = |scheme: &str| {
        let keys = words(&[&format!("time.scheme={scheme}")]);
        let case = case::parse(&case::Source::new("rod.toml", text.as_str()), &keys);
        case.unwrap_or_else(|error| panic!("{error}")).problem
    };
    let memory = solve(&read("bdf2"));
    let differs = |n: usize| {
        let mut euler = March::new(&read("euler")).expect("a regular system");
        let next = euler.step(&memory.states[n]).expect("a step").0;
        apart(&next, &memory.states[n + 1])[0]
    };
    assert!(differs(0) < 1e-15 && differs(10) < 1e-15, "{:e} {:e}", differs(0), differs(10));
    assert!(differs(9) > 1e-6 && differs(11) > 1e-6, "{:e} {:e}", differs(9), differs(11));
}

/// A step that hits a rigid wall and the two after it are made by backward Euler, from each state with the same bits.
#[test]
fn an_impact_starts_the_formula_anew() {
    let text = format!(
        "{ROD}[time]\nend = 0.4\nsteps = 100\n[initial]\nvelocity = [\"x\"]\n[contact]\non = \"right\"\ngap = 0.1003\n\
         normal = {{ law = \"signorini\" }}\n"
    );
    let read = |scheme: &str| {
        let keys = words(&[&format!("time.scheme={scheme}")]);
        let case = case::parse(&case::Source::new("rod.toml", text.as_str()), &keys);
        case.unwrap_or_else(|error| panic!("{error}")).problem
    };
    let memory = solve(&read("bdf2"));
    closes("hit", &memory);
    let hit = memory.reports.iter().position(|report| report.contact.states[0].pressure > 0.0).expect("it hits");
    for (n, pair) in memory.states.windows(2).enumerate() {
        let next = |scheme: &str| {
            let mut march = March::new(&read(scheme)).expect("a regular system");
            march.step(&pair[0]).expect("a step").0
        };
        assert!(next("bdf2") == pair[1], "step {} goes on with other bits", pair[1].step);
        let differs = apart(&next("euler"), &pair[1])[0];
        if (hit..hit + 3).contains(&n) {
            assert!(differs < 1e-15, "step {}: {differs:e}", pair[1].step);
        } else if n > 0 && n < hit || n == hit + 3 {
            assert!(differs > 1e-9, "step {}: {differs:e}", pair[1].step);
        }
    }
}
