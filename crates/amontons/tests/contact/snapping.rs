//! Steps that take many iterations: points on a layer that softens, which snap through one after the other.

use amontons::case::{self, Source};
use amontons::pulse::Pulse;
use amontons::step::Scheme;

use crate::softening::{run, scheme};

/// A row of points on a layer that softens, which snap through one after the other, in a body of some viscosity.
const ROW: &str = r#"
name = "row"
units = "dimensionless"
mesh = { kind = "rectangle", size = [100, 1], n = [8, 1], elements = "Q1" }
time = { end = 4, steps = 20, inertia = false }
[material]
elasticity = { law = "isotropic", young = 1, poisson = 0, stress_state = "plane-strain" }
viscosity = { law = "lame", first = 0.05, second = 0.05 }
[[boundary]]
on = "top"
displacement = [0, "0.5 - 0.3*t"]
[contact]
on = "bottom"
gap = "0.02*sin(7*x)"
normal = { law = "softening", stiffness = 3, peak = 0.1, softening = 1.5, residual = 0.01 }
"#;

/// A step whose contact iteration takes more than some 300 iterations, here 430, is given up and made in halves, which
/// take a few each. Three other steps are made in halves as well.
#[test]
fn a_step_that_takes_many_iterations_is_made_in_halves() {
    let problem = case::parse(&Source::new("row", ROW), &[]).unwrap_or_else(|error| panic!("{error}")).problem;
    let (mut scheme, mut state) = scheme(&problem);
    let pulse = Pulse::default();
    scheme.watched_by(&pulse);
    let (mut halved, mut given_up) = (0, 0);
    for _ in 0..problem.timeline.steps() {
        let (next, report) = scheme.step(&state).unwrap_or_else(|error| panic!("{error}"));
        state = next;
        if report.parts > 1 {
            let (made, attempts) = (pulse.iterations(), pulse.parts());
            println!("step {}: {} parts, {made} iterations in {attempts} attempts", state.step, report.parts);
            halved += 1;
            given_up += usize::from(made > 200);
            assert!(made < 300 * attempts, "step {}: {made} iterations", state.step);
        }
    }
    assert_eq!((halved, state.counts.halved_steps), (4, 4));
    assert!(given_up > 0 && state.counts.newton_mechanics_max < 300, "{:?}", state.counts);
}

/// Where the halves are not solved either, a step is made with as many iterations as it takes.
#[test]
fn a_step_whose_halves_are_not_solved_takes_its_iterations() {
    let damped = "viscosity = { law = \"lame\", first = 0.05, second = 0.05 }\n";
    let text = ROW.replace("softening = 1.5", "softening = 3").replace("n = [8, 1]", "n = [16, 1]").replace(damped, "");
    let problem = case::parse(&Source::new("row", text), &[]).unwrap_or_else(|error| panic!("{error}")).problem;
    let (states, reports) = run(&problem);
    let most = reports.iter().filter(|report| report.parts == 1).map(|report| report.newton_mechanics).max();
    assert!(most > Some(300), "{most:?}");
    assert_eq!(states.last().unwrap().step, problem.timeline.steps());
}
