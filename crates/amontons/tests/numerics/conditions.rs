//! Conditions that begin, change and end with a phase, and starts in equilibrium, against closed forms.

use amontons::case::{self, Source};
use amontons::hypotheses::{self, FindingId};
use amontons::output::{Memory, Probe, ProbePlace, ProbeSet, Quantity, Take};
use amontons::problem::Problem;
use amontons::run::{self, Settings, Stepping};
use amontons::state::State;

/// A rod of length 1 with E = 4 in one cell, so that m = ρ/3 moves on a spring κ = 4. Its right end is drawn to 0.1.
const ROD: &str = r#"
name = "rod"
units = "dimensionless"
[mesh]
kind = "interval"
size = 1.0
n = 1
[material]
density = 3.0
elasticity = { law = "isotropic", young = 4.0, poisson = 0.0 }
[[boundary]]
on = "left"
displacement = [0]
[[boundary]]
on = "right"
displacement = ["0.1*t"]
phases = ["tighten"]
[[boundary]]
on = "right"
traction = [0.3]
phases = ["load"]
[[phase]]
name = "tighten"
end = 1.0
steps = 4
analysis = "quasistatic"
[[phase]]
name = "load"
end = 3.0
steps = 8
analysis = "quasistatic"
[[phase]]
name = "hold"
end = 4.0
steps = 2
analysis = "quasistatic"
"#;

fn read(text: &str) -> Problem {
    let case = case::parse(&Source::new("case.toml", text), &[]);
    case.unwrap_or_else(|error| panic!("{error}")).problem
}

/// A run without a certificate, with all states and reports.
fn run(problem: &Problem) -> Memory {
    let mut memory = Memory::new().states_every(1).reports();
    run::run(problem, &Settings { certificate: false, ..Settings::default() }, &mut [&mut memory]).expect("a run");
    memory
}

/// Asserts that both identities close to round-off after each step.
fn closes(states: &[State]) {
    for state in states {
        let ledger = &state.ledger;
        let scale = ledger.turned_over.max(f64::MIN_POSITIVE);
        assert!(ledger.closing_error.abs() <= 1e-13 * scale, "{}: {ledger:?}", state.step);
        let scale = ledger.heat_turned_over.max(f64::MIN_POSITIVE);
        assert!(ledger.heat_closing_error.abs() <= 1e-13 * scale, "{}: {ledger:?}", state.step);
    }
}

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found:e}, expected {expected:e}");
}

/// Going on from each state of a run, through a file, gives the bits of the run.
fn goes_on(problem: &Problem, states: &[State]) {
    let settings = Settings::default();
    for from in 0..states.len() {
        let mut first = Stepping::new(problem, &settings).expect("a run");
        for _ in 0..from {
            first.step().expect("a step");
        }
        let mut again = Stepping::resume(problem, first.save(), &settings).expect("a state");
        while !again.is_done() {
            let step = again.step().expect("a step").step;
            assert!(again.state() == &states[step], "step {step} after a break at {from}");
        }
    }
}

#[test]
fn a_support_that_ends_lets_a_rod_spring_back_at_once() {
    let problem = read(ROD);
    let run = run(&problem);
    for state in &run.states[1..] {
        let expected = match state.step {
            n @ 0..=4 => 0.025 * n as f64,
            5..=12 => 0.3 / 4.0,
            _ => 0.0,
        };
        near(state.u[1], expected, 1e-15);
    }
    closes(&run.states);
    goes_on(&problem, &run.states);
}

#[test]
fn a_released_force_falls_to_zero_over_the_phase() {
    let text = ROD.replace("phases = [\"tighten\"]", "phases = [\"tighten\"]\nrelease = \"phase\"");
    let problem = read(&text.replace("traction = [0.3]", "traction = [0.0]"));
    let run = run(&problem);
    for (n, state) in run.states.iter().enumerate().skip(4).take(9) {
        near(state.u[1], 0.1 * (1.0 - (n - 4) as f64 / 8.0), 1e-15);
    }
    near(run.states[14].u[1], 0.0, 1e-15);
    assert_eq!(
        run.states.iter().map(|state| state.released.len()).collect::<Vec<_>>()[3..],
        [0, 2, 2, 2, 2, 2, 2, 2, 2, 0, 0, 0]
    );
    // All of the work of tightening, half of κ u², is given back in it.
    near(run.states[4].ledger.elastic, 0.02, 1e-16);
    closes(&run.states);
    goes_on(&problem, &run.states);
}

#[test]
fn a_rod_that_is_let_go_swings_with_the_frequency_and_the_energy_of_the_scheme() {
    let text = ROD.replace("end = 3.0\nsteps = 8\nanalysis = \"quasistatic\"", "end = 3.0\nsteps = 40");
    let text = text.replace("[[phase]]\nname = \"hold\"\nend = 4.0\nsteps = 2\nanalysis = \"quasistatic\"\n", "");
    let text = text.replace("traction = [0.3]", "traction = [0.0]");
    let problem = read(&text.replace("[material]", "[time]\nscheme = \"theta\"\n[material]"));
    let run = run(&problem);
    // m = 1, κ = 4: ω = 2, and a step of the midpoint rule turns by 2 atan(ωk/2).
    let angle = 2.0 * (2.0f64 * 0.05 / 2.0).atan();
    for (n, state) in run.states.iter().skip(4).enumerate() {
        near(state.u[1], 0.1 * (n as f64 * angle).cos(), 1e-14);
        near(state.ledger.kinetic + state.ledger.elastic, 0.02, 1e-15);
    }
    closes(&run.states);
    goes_on(&problem, &run.states);
}

#[test]
fn springs_take_their_energy_with_them_and_bring_it() {
    let text = ROD.replace("displacement = [\"0.1*t\"]", "traction = [\"0.8*t\"]\nspring = [4]");
    let text = text.replace("traction = [0.3]\nphases = [\"load\"]", "spring = [12]\nphases = [\"hold\"]");
    let problem = read(&text);
    let run = run(&problem);
    // κ + 4 = 8 under 0.8; then free; then a spring that holds the rod where it is.
    near(run.states[4].u[1], 0.1, 1e-15);
    near(run.states[4].ledger.elastic, 0.04, 1e-15);
    near(run.states[5].u[1], 0.0, 1e-15);
    // Work of the load in four steps of backward Euler, 0.8 · 0.1 · 5/8; the spring took 0.02.
    near(run.states[5].ledger.load_work, 0.05 - 0.02, 1e-15);
    closes(&run.states);
    goes_on(&problem, &run.states);
}

#[test]
fn systems_stay_if_the_same_degrees_of_freedom_are_held() {
    let count = |text: &str| {
        let mut run = Stepping::new(&read(text), &Settings::default()).expect("a run");
        while !run.is_done() {
            run.step().expect("a step");
        }
        run.snapshot().work.factorizations
    };
    let equal = ROD.replace("end = 4.0\nsteps = 2", "end = 3.5\nsteps = 2");
    // Held, free, free.
    assert_eq!(count(&equal), 2);
    let held =
        equal.replace("traction = [0.3]\nphases = [\"load\"]", "displacement = [0.2]\nphases = [\"load\", \"hold\"]");
    assert_eq!(count(&held), 1);
}

#[test]
fn a_reaction_is_read_in_each_phase() {
    let problem = read(ROD);
    let probe = |quantity: &str, on: &str| Probe {
        name: format!("{quantity}-{on}"),
        quantity: Quantity::parse(quantity).expect("a quantity"),
        place: ProbePlace::On(on.to_owned(), Take::Integral),
        about: None,
    };
    let probes = [probe("reaction", "left"), probe("reaction", "right"), probe("total_force", "right")];
    let set = ProbeSet::new(&problem, &probes).expect("probes");
    let mut run = Stepping::new(&problem, &Settings::default()).expect("a run");
    let mut values = Vec::new();
    while !run.is_done() {
        run.step().expect("a step");
        values.push(set.values(&run.snapshot()));
    }
    for (n, expected) in [(3, [-0.4, 0.4, 0.4]), (7, [-0.3, 0.0, 0.3]), (12, [0.0; 3])] {
        values[n].iter().zip(expected).for_each(|(found, expected)| near(*found, expected, 1e-14));
    }
}

#[test]
fn a_heated_side_that_is_insulated_keeps_the_heat() {
    let problem = read(
        r#"
name = "bar"
units = "dimensionless"
[mesh]
kind = "interval"
size = 1.0
n = 8
[material]
heat_capacity = 2.0
conductivity = 1.0
[[boundary]]
on = "left"
temperature = 1.0
phases = ["heat"]
[[boundary]]
on = "left"
convection = { coefficient = 1.0, ambient = 0.0 }
phases = ["cool"]
[[phase]]
name = "heat"
end = 0.5
steps = 10
[[phase]]
name = "rest"
end = 20.0
steps = 20
[[phase]]
name = "cool"
end = 21.0
steps = 10
"#,
    );
    let run = run(&problem);
    let heat = |n: usize| run.states[n].ledger.heat_content;
    for n in 11..=30 {
        near(heat(n), heat(10), 1e-14);
    }
    // The rod is then of one temperature.
    run.states[30].theta.iter().for_each(|theta| near(*theta, heat(10) / 2.0, 1e-9));
    assert!(heat(40) < 0.8 * heat(30), "{}", heat(40));
    closes(&run.states);
    goes_on(&problem, &run.states);
}

/// A strip with EA = 1000 on a base that resists with τ = 10 per length: load, unload and reverse, each a phase.
fn on_base(force: f64) -> Problem {
    let entry = |phase: &str, traction: String| {
        format!("[[boundary]]\non = \"left\"\ntraction = [\"{traction}\", 0]\nphases = [\"{phase}\"]\n")
    };
    let f = force / 0.005;
    let tractions = [
        entry("load", format!("{f}*t")),
        entry("unload", format!("{f}*(2 - t)")),
        entry("reverse", format!("-{f}*(t - 2)")),
    ];
    let phase = |(name, end): (&str, f64)| {
        format!("[[phase]]\nname = \"{name}\"\nend = {end:?}\nsteps = 10\nanalysis = \"quasistatic\"\n")
    };
    let phases = [("load", 1.0), ("unload", 2.0), ("reverse", 3.0)].map(phase);
    let text = format!(
        r#"
name = "rod-on-base"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [1.5, 0.005]
n = [300, 1]
[material]
density = 0.0
elasticity = {{ law = "isotropic", young = 2e5, poisson = 0.0, stress_state = "plane-stress" }}
[[boundary]]
on = "top"
normal_displacement = 0
[contact]
on = "bottom"
normal = {{ law = "bilateral" }}
friction = {{ law = "tresca", bound = 10.0 }}
{}{}"#,
        tractions.concat(),
        phases.concat()
    );
    read(&text)
}

#[test]
fn a_rod_on_a_base_is_loaded_unloaded_and_reversed_by_phases() {
    for force in [5.0, 10.0] {
        let run = run(&on_base(force));
        let loaded = force * force / (2.0 * 10.0 * 1000.0);
        // Masing: half of the displacement stays.
        for (step, expected) in [(10, loaded), (20, 0.5 * loaded), (30, -loaded)] {
            near(run.states[step].u[0], expected, 0.01 * loaded);
        }
        closes(&run.states);
    }
}

/// The heavy rod on its end: E = ρ = L = g = 1.
const HEAVY: &str = r#"
name = "heavy"
units = "dimensionless"
[mesh]
kind = "interval"
size = 1.0
n = 16
[time]
end = 8.0
steps = 400
[material]
density = 1.0
elasticity = { law = "isotropic", young = 1.0, poisson = 0.0 }
[load]
gravity = [-1.0]
[[boundary]]
on = "left"
displacement = [0]
[initial]
state = "equilibrium"
"#;

#[test]
fn a_heavy_rod_in_equilibrium_stays_and_otherwise_swings() {
    for scheme in ["euler", "theta"] {
        let text = HEAVY.replace("steps = 400", &format!("steps = 400\nscheme = \"{scheme}\""));
        let resting = run(&read(&text));
        for state in &resting.states {
            near(state.u[16], -0.5, 1e-12);
            assert!(state.ledger.kinetic < 1e-20, "{}", state.ledger.kinetic);
        }
        // ½∫(1 − x)² of the strain.
        near(resting.states[0].ledger.elastic, 1.0 / 6.0, 1e-3);
        closes(&resting.states);
    }
    // Without it the end falls to −1 at half of the period 4.
    let text = HEAVY.replace("[initial]\nstate = \"equilibrium\"\n", "");
    let text = text.replace("steps = 400", "steps = 1600\nscheme = \"theta\"").replace("n = 16", "n = 64");
    let swinging = run(&read(&text));
    let ends: Vec<f64> = swinging.states.iter().map(|state| state.u[64]).collect();
    near(ends[400], -1.0, 5e-3);
    near(ends[800], 0.0, 5e-3);
    near(ends[1200], -1.0, 5e-3);
}

#[test]
fn an_equilibrium_relaxes_branches_and_presses_on_layers() {
    let text = HEAVY.replace(
        "[[boundary]]\non = \"left\"\ndisplacement = [0]",
        "viscosity = { law = \"lame\", first = 0.0, second = 0.0 }\n[contact]\non = \"left\"\nnormal = { law = \"compliance\", stiffness = 10.0 }",
    );
    let text = text.replace("viscosity = { law = \"lame\", first = 0.0, second = 0.0 }\n", "");
    let text = text.replace("[load]", "[[material.prony]]\ntime = 0.5\nratio = 0.25\n[load]");
    let resting = run(&read(&text));
    let last = resting.states.last().expect("a state");
    for state in [&resting.states[0], last] {
        // The pressure is the weight 1; the long-term modulus is that of the case or what the branches leave of it.
        near(state.u[0], -0.1, 1e-11);
        near(state.u[16], resting.states[0].u[16], 1e-10);
        assert!(state.ledger.kinetic < 1e-20);
    }
    near(resting.states[0].ledger.contact_energy, 0.05, 1e-12);
    closes(&resting.states);
}

#[test]
fn a_body_that_nothing_holds_has_no_equilibrium() {
    let layer = "[contact]\non = \"left\"\nnormal = { law = \"compliance\", stiffness = 10.0 }";
    let text = HEAVY.replace("[[boundary]]\non = \"left\"\ndisplacement = [0]", layer);
    let lifted = read(&text.replace("gravity = [-1.0]", "gravity = [1.0]"));
    let error = run::run(&lifted, &Settings::default(), &mut []).expect_err("no equilibrium");
    let told = error.to_string();
    assert!(told.starts_with("found no equilibrium to start from (initial.state): "), "{told}");
    assert!(error.advice().is_some_and(|advice| advice.contains("give the body a support")), "{error:?}");
}

/// Verdicts that depend on supports say of which phase they are; without conditions that change they do not.
#[test]
fn the_certificate_says_whose_conditions_it_judges() {
    let told = |text: &str| {
        let found = hypotheses::full(&read(text)).findings;
        let unique = found.into_iter().find(|finding| finding.id == FindingId::StepUnique);
        unique.expect("the verdict").message
    };
    let end = "; judged with the conditions of the phase \"tighten\" alone";
    assert!(told(ROD).ends_with(end), "{}", told(ROD));
    let same = ROD
        .replace("phases = [\"tighten\"]\n", "")
        .replace("[[boundary]]\non = \"right\"\ntraction = [0.3]\nphases = [\"load\"]\n", "");
    assert!(!told(&same).contains("judged with"), "{}", told(&same));
}
