//! Contacts, loads and ties that act in some phases only, against closed forms; energy, heat, and runs that go on.

use amontons::case::{self, Source};
use amontons::contact::Status;
use amontons::inclusion::PointState;
use amontons::output::Memory;
use amontons::problem::Problem;
use amontons::run::{self, Settings, Stepping};
use amontons::state::State;
use amontons::time::{During, TimePhase, TimeScheme, Timeline};

use crate::common::{changed, paper};

fn schemes() -> [TimeScheme; 4] {
    [TimeScheme::BackwardEuler, TimeScheme::theta(0.5), TimeScheme::Bdf2, TimeScheme::ContactStabilised]
}

/// A rod of length 1 with E = 4 in one cell, so that m = ρ/3 moves on a spring κ = 4. A tool presses its right end.
pub const ROD: &str = r#"
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
[[contact]]
on = "right"
gap = "-0.1*t"
normal = { law = "signorini" }
phases = ["press"]
[[phase]]
name = "press"
end = 1.0
steps = 4
analysis = "quasistatic"
[[phase]]
name = "free"
end = 2.0
steps = 4
analysis = "quasistatic"
"#;

pub fn read(text: &str) -> Problem {
    let case = case::parse(&Source::new("case.toml", text), &[]);
    case.unwrap_or_else(|error| panic!("{error}")).problem
}

/// A run without a certificate, with all states and reports.
pub fn run(problem: &Problem) -> Memory {
    let mut memory = Memory::new().states_every(1).reports();
    run::run(problem, &Settings { certificate: false, ..Settings::default() }, &mut [&mut memory]).expect("a run");
    memory
}

/// Asserts that both identities close to round-off after each step.
pub fn closes(states: &[State]) {
    for state in states {
        let ledger = &state.ledger;
        let scale = ledger.turned_over.max(f64::MIN_POSITIVE);
        assert!(ledger.closing_error.abs() <= 1e-12 * scale, "{}: {ledger:?}", state.step);
        let scale = ledger.heat_turned_over.max(f64::MIN_POSITIVE);
        assert!(ledger.heat_closing_error.abs() <= 1e-12 * scale, "{}: {ledger:?}", state.step);
    }
}

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found:e}, expected {expected:e}");
}

/// Going on from each state of a run, through a file, gives the bits of the run, on one thread as on three.
fn goes_on(problem: &Problem, states: &[State]) {
    let settings = Settings::default();
    let pools = [1, 3].map(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("threads"));
    for from in 0..states.len() {
        let mut first = Stepping::new(problem, &settings).expect("a run");
        for _ in 0..from {
            first.step().expect("a step");
        }
        let mut again = Stepping::resume(problem, first.save(), &settings).expect("a state");
        while !again.is_done() {
            let step = pools[from % 2].install(|| again.step().expect("a step").step);
            assert!(again.state() == &states[step], "step {step} after a break at {from}");
        }
    }
}

#[test]
fn a_rod_springs_back_at_once_where_its_tool_is_taken_away() {
    let problem = read(ROD);
    let run = run(&problem);
    for state in &run.states[1..] {
        let expected = if state.step <= 4 { -0.025 * state.step as f64 } else { 0.0 };
        near(state.u[1], expected, 1e-15);
    }
    for (n, report) in run.reports.iter().enumerate() {
        let point = &report.contact.states[0];
        near(point.pressure, if n < 4 { 0.1 * (n + 1) as f64 } else { 0.0 }, 1e-14);
        assert_eq!(point.status == Status::Open, n >= 4);
    }
    closes(&run.states);
    goes_on(&problem, &run.states);
}

#[test]
fn a_released_rod_swings_with_the_frequency_and_the_energy_of_the_scheme() {
    let text = ROD.replace("end = 2.0\nsteps = 4\nanalysis = \"quasistatic\"", "end = 3.0\nsteps = 40");
    let problem = changed(&read(&text), |data| data.scheme = TimeScheme::theta(0.5));
    let run = run(&problem);
    // m = 1, κ = 4: ω = 2, and a step of the midpoint rule turns by 2 atan(ωk/2).
    let angle = 2.0 * (2.0f64 * 0.05 / 2.0).atan();
    for (n, state) in run.states.iter().skip(4).enumerate() {
        near(state.u[1], -0.1 * (n as f64 * angle).cos(), 1e-14);
        near(state.ledger.kinetic + state.ledger.elastic, 0.02, 1e-15);
    }
    goes_on(&problem, &run.states);
    for scheme in schemes() {
        let problem = changed(&problem, |data| data.scheme = scheme);
        let run = self::run(&problem);
        closes(&run.states);
        goes_on(&problem, &run.states);
    }
}

/// The end of an elastic rod goes −δ, δ, −δ in the period 4L/c.
#[test]
fn a_released_rod_swings_with_its_period() {
    let text = ROD.replace("n = 1\n", "n = 50\n").replace("density = 3.0", "density = 4.0");
    let text = text.replace("end = 2.0\nsteps = 4\nanalysis = \"quasistatic\"", "end = 9.0\nsteps = 1600");
    let problem = changed(&read(&text), |data| data.scheme = TimeScheme::theta(0.5));
    let states = run(&problem).states;
    let end = |t: usize| *states[4 + 200 * t].u.last().expect("a node");
    for (t, expected) in [(0, -0.1), (1, 0.0), (2, 0.1), (3, 0.0), (4, -0.1), (6, 0.1), (8, -0.1)] {
        near(end(t), expected, 4e-3);
    }
    closes(&states);
}

/// κ = 4 under a layer c = 12 that is drawn by 0.1: u = −0.075, r = 0.025.
#[test]
fn a_layer_takes_its_energy_with_it_and_brings_it() {
    let text = ROD.replace("{ law = \"signorini\" }", "{ law = \"compliance\", stiffness = 12 }");
    for scheme in schemes() {
        let problem = changed(&read(&text), |data| data.scheme = scheme);
        let run = run(&problem);
        let [pressed, free] = [4, 5].map(|n| &run.states[n]);
        near(pressed.u[1], -0.075, 1e-15);
        near(pressed.ledger.contact_energy, 0.5 * 12.0 * 0.025 * 0.025, 1e-15);
        near(free.ledger.contact_energy, 0.0, 0.0);
        let work = free.ledger.load_work - pressed.ledger.load_work;
        near(work, -pressed.ledger.contact_energy, 1e-15);
        near(free.u[1], 0.0, 1e-15);
        closes(&run.states);
        goes_on(&problem, &run.states);
    }
    // A layer that begins where the rod is inside by 0.1: it brings ½ · 12 · 0.01 and presses the rod to −0.075.
    let text = text.replace("\"-0.1*t\"", "-0.1").replace("phases = [\"press\"]", "phases = [\"free\"]");
    let run = run(&read(&text));
    near(run.states[4].u[1], 0.0, 1e-15);
    near(run.states[5].u[1], -0.075, 1e-15);
    near(run.states[5].ledger.load_work, 0.06, 1e-15);
    closes(&run.states);
}

#[test]
fn two_tools_press_one_side_one_after_the_other() {
    let tool = "[[contact]]\non = \"right\"\nname = \"second\"\ngap = -0.05\nnormal = { law = \"signorini\" }\nphases = [\"free\"]\n[[phase]]\nname = \"press\"";
    let text = ROD.replace("[[phase]]\nname = \"press\"", tool);
    let problem = read(&text);
    let run = run(&problem);
    near(run.states[4].u[1], -0.1, 1e-15);
    near(run.states[5].u[1], -0.05, 1e-15);
    for (n, pressures) in [(3, [0.4, 0.0]), (4, [0.0, 0.2])] {
        let found = &run.reports[n].contact.states;
        assert_eq!(found.len(), 2);
        found.iter().zip(pressures).for_each(|(state, pressure)| near(state.pressure, pressure, 1e-14));
    }
    closes(&run.states);
    goes_on(&problem, &run.states);
    // In a phase with inertia the second one begins where the rod has gone through it.
    let text = text.replace("end = 2.0\nsteps = 4\nanalysis = \"quasistatic\"", "end = 2.0\nsteps = 40");
    for scheme in schemes() {
        let problem = changed(&read(&text), |data| data.scheme = scheme);
        let run = self::run(&problem);
        closes(&run.states);
        goes_on(&problem, &run.states);
    }
}

/// The paper's square with friction and heat, on a foundation that comes, goes and comes again.
fn grip(scheme: TimeScheme, set: &[&str]) -> Problem {
    let mut all = vec!["mesh.n=6", "contact.heat.foundation_temperature=10", "contact.frictional_heat=0.5"];
    all.extend(set);
    changed(&paper(&all).problem, |data| {
        data.scheme = scheme;
        data.contacts.iter_mut().for_each(|contact| contact.during = During::phases(["press", "again"]));
        data.timeline = Timeline::in_phases(vec![
            TimePhase::quasistatic("press", 0.25, 3),
            TimePhase::dynamic("free", 0.5, 4),
            TimePhase::dynamic("again", 0.75, 4),
            TimePhase::quasistatic("rest", 1.0, 2),
        ]);
    })
}

#[test]
fn heat_and_energy_close_where_a_grip_ends_and_begins() {
    for scheme in schemes() {
        for coupling in ["staggered", "fixed-point", "monolithic"] {
            let problem = grip(scheme, &[&format!("scheme.coupling=\"{coupling}\"")]);
            let run = run(&problem);
            closes(&run.states);
            let flow = |n: usize| run.states[n].ledger.heat_contact;
            let rubbed = |n: usize| run.states[n].ledger.friction_dissipation;
            assert!(flow(3).abs() > 1e-3 && flow(11).to_bits() != flow(7).to_bits(), "{:e}", flow(3));
            for (from, to) in [(3, 7), (11, 13)] {
                assert_eq!(flow(from).to_bits(), flow(to).to_bits());
                assert_eq!(rubbed(from).to_bits(), rubbed(to).to_bits());
            }
            let open = run.reports[3..7].iter().flat_map(|report| &report.contact.states);
            assert!(open.clone().all(|state| state.status == Status::Open && !state.bears()));
            assert!(
                open.count() > 0
                    && run.reports[7..11].iter().any(|report| report.contact.states.iter().any(PointState::bears))
            );
            if coupling == "staggered" {
                goes_on(&problem, &run.states);
            }
        }
    }
}

/// A contact that acts in all phases by name has the bits of one without `phases`.
#[test]
fn a_contact_of_all_phases_is_a_contact() {
    for scheme in schemes() {
        let named = changed(&grip(scheme, &[]), |data| {
            data.contacts[0].during = During::phases(["press", "free", "again", "rest"]);
        });
        let plain = changed(&named, |data| data.contacts[0].during = During::Run);
        assert!(run(&named).states == run(&plain).states);
    }
}

/// Two blocks of height ½ and E = 4; the upper one is lifted by 0.1, glued, and lifted by 0.1 more.
fn glued(scheme: TimeScheme, contact: &str) -> Problem {
    let block = |name: &str, y: f64| {
        format!("[[mesh.blocks]]\nname = \"{name}\"\nsize = [1.0, 0.5]\nn = [2, 2]\norigin = [0.0, {y:?}]\n")
    };
    let text = format!(
        r#"
name = "glued"
units = "dimensionless"
[mesh]
kind = "blocks"
{}{}[material]
density = 1.0
elasticity = {{ law = "isotropic", young = 4.0, poisson = 0.0, stress_state = "plane-strain" }}
[[boundary]]
on = "lower_bottom"
displacement = [0, 0]
[[boundary]]
on = "upper_top"
displacement = [0, "0.1*t"]
[[contact]]
on = "lower_top"
with = "upper_bottom"
{contact}phases = ["pull"]
[[phase]]
name = "lift"
end = 1.0
steps = 2
analysis = "quasistatic"
[[phase]]
name = "pull"
end = 2.0
steps = 4
analysis = "quasistatic"
[[phase]]
name = "free"
end = 3.0
steps = 2
analysis = "quasistatic"
"#,
        block("lower", 0.0),
        block("upper", 0.5)
    );
    changed(&read(&text), |data| data.scheme = scheme)
}

/// The force is E times the strain that the pull adds.
#[test]
fn a_tie_that_begins_bears_only_what_is_loaded_after() {
    let tie = "normal = { law = \"bilateral\" }\nfriction = { law = \"stick\" }\n";
    for contact in [tie, "normal = { law = \"bilateral\" }\n"] {
        for scheme in schemes() {
            let problem = glued(scheme, contact);
            let run = run(&problem);
            for (n, report) in run.reports.iter().enumerate() {
                let expected = if (2..6).contains(&n) { 4.0 * 0.1 * 0.25 * (n - 1) as f64 } else { 0.0 };
                near(report.contact.force[1], expected, 1e-12);
            }
            closes(&run.states);
            goes_on(&problem, &run.states);
        }
    }
}

/// With inertia the glue holds in all schemes what it met: no shock, and the same energy.
#[test]
fn a_tie_that_begins_with_inertia_holds_its_distance() {
    let tie = "normal = { law = \"bilateral\" }\nfriction = { law = \"stick\" }\n";
    for scheme in schemes() {
        let problem = changed(&glued(scheme, tie), |data| {
            data.timeline = Timeline::in_phases(vec![
                TimePhase::quasistatic("lift", 1.0, 2),
                TimePhase::dynamic("pull", 2.0, 20),
                TimePhase::dynamic("free", 3.0, 20),
            ]);
        });
        let run = run(&problem);
        closes(&run.states);
        for report in &run.reports[2..22] {
            for state in &report.contact.states {
                near(state.penetration, 0.0, 1e-13);
                assert_eq!(state.status, Status::Stick);
            }
        }
        goes_on(&problem, &run.states);
    }
}

const LOADED: &str = r#"
name = "loaded"
units = "dimensionless"
[mesh]
kind = "interval"
size = 1.0
n = 4
[material]
density = 2.0
heat_capacity = 2.0
conductivity = 1.0
elasticity = { law = "isotropic", young = 4.0, poisson = 0.0 }
[[boundary]]
on = "left"
displacement = [0]
[[load]]
body_force = [1.0]
phases = ["one"]
[[load]]
gravity = [3.0]
phases = ["two"]
[[load]]
heat_source = 5.0
phases = ["two", "three"]
[[phase]]
name = "one"
end = 1.0
steps = 2
analysis = "quasistatic"
[[phase]]
name = "two"
end = 2.0
steps = 2
analysis = "quasistatic"
[[phase]]
name = "three"
end = 3.0
steps = 2
analysis = "quasistatic"
"#;

/// u(L) = f L²/(2E) at the nodes; q V t of heat.
#[test]
fn loads_act_in_their_phases() {
    let problem = read(LOADED);
    let run = run(&problem);
    for (n, state) in run.states.iter().enumerate().skip(1) {
        let force = [1.0, 6.0, 0.0][(n - 1) / 2];
        near(*state.u.last().expect("a node"), force / 8.0, 1e-14);
        near(state.ledger.heat_content, 5.0 * (state.t - 1.0).max(0.0), 1e-13);
    }
    closes(&run.states);
    goes_on(&problem, &run.states);
}

#[test]
fn a_load_of_all_phases_is_a_load() {
    let plain = LOADED.replace("phases = [\"one\"]\n[[load]]\ngravity = [3.0]\nphases = [\"two\"]\n[[load]]\n", "");
    let plain = plain.replace("phases = [\"two\", \"three\"]\n", "");
    let one = plain.replace("[[load]]", "[load]");
    assert!(one != plain && one.matches("load").count() == 2);
    let [one, listed] = [one, plain].map(|text| run(&read(&text)).states);
    for (a, b) in one.iter().zip(&listed) {
        a.u.iter().zip(&b.u).for_each(|(a, b)| near(*a, *b, 1e-15));
        a.theta.iter().zip(&b.theta).for_each(|(a, b)| near(*a, *b, 1e-14));
    }
}

#[test]
fn a_load_of_a_rigid_part_acts_in_its_phases() {
    let rigid = "[[rigid]]\non = \"right\"\nforce = [0.8]\nphases = [\"free\"]\n[[phase]]\nname = \"press\"";
    let problem = read(&ROD.replace("[[phase]]\nname = \"press\"", rigid));
    let run = run(&problem);
    near(run.states[4].u[1], -0.1, 1e-15);
    near(run.states[5].u[1], 0.2, 1e-14);
    closes(&run.states);
    goes_on(&problem, &run.states);
}

#[test]
fn systems_stay_where_a_contact_ends() {
    let mut run = Stepping::new(&read(ROD), &Settings::default()).expect("a run");
    while !run.is_done() {
        run.step().expect("a step");
    }
    assert_eq!(run.snapshot().work.factorizations, 1);
}

/// A block that a tool presses and drags, and that another one catches, turned by an angle.
fn turned(angle: f64, scheme: TimeScheme) -> (Problem, [f64; 2]) {
    let (sine, cosine) = angle.sin_cos();
    let drag = format!("[{:?}, {:?}]", -0.3 * sine, 0.3 * cosine);
    let text = format!(
        r#"
name = "block"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [1.0, 0.7]
n = [4, 3]
[material]
density = 1.0
elasticity = {{ law = "isotropic", young = 4.0, poisson = 0.3, stress_state = "plane-strain" }}
[[boundary]]
on = "left"
displacement = [0, 0]
[[contact]]
on = "right"
gap = "-0.02*t"
foundation_velocity = {drag}
normal = {{ law = "compliance", stiffness = 200.0 }}
friction = {{ law = "coulomb", coefficient = 0.3 }}
phases = ["press"]
[[contact]]
on = "right"
gap = 0.005
normal = {{ law = "signorini" }}
friction = {{ law = "coulomb", coefficient = 0.2 }}
phases = ["catch"]
[[phase]]
name = "press"
end = 1.0
steps = 4
analysis = "quasistatic"
[[phase]]
name = "catch"
end = 2.0
steps = 20
"#
    );
    let problem = changed(&read(&text), |data| {
        data.scheme = scheme;
        let mut mesh = (*data.mesh).clone();
        for x in &mut mesh.points {
            *x = [cosine * x[0] - sine * x[1], sine * x[0] + cosine * x[1], 0.0];
        }
        data.mesh = mesh.into();
    });
    (problem, [sine, cosine])
}

#[test]
fn a_block_that_is_turned_moves_alike() {
    for scheme in schemes() {
        let (plain, _) = turned(0.0, scheme);
        let plain = run(&plain);
        closes(&plain.states);
        assert!(plain.reports[3].contact.states.iter().any(|state| state.status == Status::Slip));
        for angle in [1.0, 2.5] {
            let (problem, [sine, cosine]) = turned(angle, scheme);
            for (a, b) in run(&problem).states.iter().zip(&plain.states) {
                for (a, b) in a.u.chunks_exact(2).zip(b.u.chunks_exact(2)) {
                    near(a[0], cosine * b[0] - sine * b[1], 1e-10);
                    near(a[1], sine * b[0] + cosine * b[1], 1e-10);
                }
            }
        }
    }
}

/// Right and left change their places: the bits change their sign.
#[test]
fn a_rod_that_is_mirrored_moves_alike() {
    let text = ROD.replace("end = 2.0\nsteps = 4\nanalysis = \"quasistatic\"", "end = 2.0\nsteps = 40");
    let mirrored = text.replace("\"right\"", "\"\"").replace("\"left\"", "\"right\"").replace("\"\"", "\"left\"");
    let [one, other] = [text, mirrored].map(|text| run(&read(&text)).states);
    for (a, b) in one.iter().zip(&other) {
        a.u.iter().zip(b.u.iter().rev()).for_each(|(a, b)| near(*a, -b, 1e-15));
    }
}

/// Steps that choose their lengths, and a steady phase, know of contacts that act in some phases only.
#[test]
fn chosen_steps_and_steady_phases_know_their_contacts() {
    for scheme in [TimeScheme::BackwardEuler, TimeScheme::theta(0.5)] {
        let problem = changed(&grip(scheme, &[]), |data| {
            data.timeline = Timeline::in_phases(vec![
                TimePhase::quasistatic("press", 0.25, 1).automatic(1e-2),
                TimePhase::dynamic("free", 0.5, 1).automatic(5e-2),
                TimePhase::dynamic("again", 0.75, 1).automatic(5e-2),
                TimePhase::quasistatic("rest", 1.0, 1).automatic(1e-2),
            ]);
        });
        let run = run(&problem);
        closes(&run.states);
        let acts = |report: &amontons::state::StepReport| report.contact.states.iter().any(PointState::bears);
        for (state, report) in run.states[1..].iter().zip(&run.reports) {
            let phase = state.phase(&problem.timeline).expect("a phase").name.as_str();
            assert!(!acts(report) || ["press", "again"].contains(&phase), "{phase}");
        }
        assert!(run.reports.iter().any(acts));
    }
    let steady = changed(&grip(TimeScheme::BackwardEuler, &[]), |data| {
        data.boundary.iter_mut().for_each(|condition| condition.temperature = Some(1.0.into()));
        data.timeline = Timeline::in_phases(vec![
            TimePhase::steady("press", 0.25, 1),
            TimePhase::steady("free", 0.5, 1),
            TimePhase::dynamic("again", 0.75, 4),
            TimePhase::steady("rest", 1.0, 1),
        ]);
    });
    let run = run(&steady);
    closes(&run.states);
    assert!(run.states[1].ledger.heat_contact.abs() > 1e-3);
    assert_eq!(run.states[1].ledger.heat_contact.to_bits(), run.states[2].ledger.heat_contact.to_bits());
}
