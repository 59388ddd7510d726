//! A hub that is pressed onto a shaft and pulled off, in space: against the same bodies in half section, which take
//! another code path, and where nothing moves any more.

use std::sync::Arc;

use crate::common;
use amontons::case::{self, Source};
use amontons::contact::Status;
use amontons::problem::{BoundaryCondition, Problem};
use amontons::state::StepReport;
use amontons::time::Timeline;

/// What both have: the laws, the steel, and a puller that moves the shaft by 0.1 mm from the second step on.
const LAWS: &str = r#"
[time]
end = 2.0
steps = 4
[material]
density = 0
elasticity = { law = "isotropic", young = "210 GPa", poisson = 0.3 }
[[contact]]
on = "hub_bottom"
normal = { law = "signorini" }
[[contact]]
on = "hub_inner"
with = "shaft_outer"
nonmortar = "hub_inner"
gap = "-5 um"
geometry = "updated"
normal = { law = "signorini" }
friction = { law = "coulomb", coefficient = 0.15 }
"#;

fn problem(text: &str) -> Problem {
    case::parse(&Source::new("fit.toml", text), &[]).unwrap_or_else(|error| panic!("{error}")).problem
}

/// The force on the ring that the hub leans on in each step, N.
fn forces(problem: &Problem) -> Vec<f64> {
    let points = problem.contact_boundary().points;
    let of = |report: &StepReport| {
        let on_ring = points.iter().zip(&report.contact.states).filter(|(point, _)| point.contact == 0);
        on_ring.map(|(point, state)| point.weight * state.pressure).sum()
    };
    common::solve(problem).reports.iter().map(of).collect()
}

/// In space, with so many cells around the shaft and around the bore, and along the shaft and the hub.
fn in_space([shaft, bore]: [usize; 2], [along, of_hub]: [usize; 2]) -> Problem {
    let mesh = format!(
        r#"
name = "fit"
[mesh]
kind = "blocks"
blocks = [
    {{ name = "shaft", radii = ["0 mm", "10 mm"], height = "30 mm", n = [3, {shaft}, {along}], elements = "Q1" }},
    {{ name = "hub", radii = ["10 mm", "20 mm"], height = "20 mm", origin = [0, 0, "5 mm"], n = [3, {bore}, {of_hub}], elements = "Q1" }},
]
[[boundary]]
on = "shaft_bottom"
displacement = [0, 0, "-2e-4*max(t - 1, 0)"]
"#
    );
    problem(&(mesh + LAWS))
}

/// The half section of the same bodies.
fn of_revolution() -> Problem {
    let mesh = r#"
name = "fit"
[mesh]
kind = "blocks"
axisymmetric = true
blocks = [
    { name = "shaft", size = ["10 mm", "30 mm"], n = [6, 6], elements = "Q1" },
    { name = "hub", size = ["10 mm", "20 mm"], origin = ["10 mm", "5 mm"], n = [3, 4], elements = "Q1" },
]
[[boundary]]
on = "shaft_bottom"
displacement = [0, "-2e-4*max(t - 1, 0)"]
"#;
    let laws = LAWS.replace("hub_inner", "hub_left").replace("shaft_outer", "shaft_right");
    problem(&(mesh.to_owned() + &laws))
}

/// The force that pulls the shaft comes with the second order in the cells around.
#[test]
fn a_hub_in_space_is_that_of_its_half_section() {
    let exact = forces(&of_revolution());
    assert!(exact[..2] == [0.0; 2] && exact[2..].iter().all(|f| (7.4e3..7.5e3).contains(f)), "{exact:?}");
    let errors = [[16, 12], [32, 24]].map(|around| {
        let found = forces(&in_space(around, [6, 4]));
        assert_eq!(found[..2], [0.0; 2], "the hub does not lean on the ring before it is pulled");
        [2, 3].map(|step| (found[step] / exact[step] - 1.0).abs())
    });
    for step in 0..2 {
        let [coarse, fine] = errors.map(|errors| errors[step]);
        let order = (coarse / fine).log2();
        assert!((1.9..2.1).contains(&order) && fine < 0.012, "errors {coarse:.3e}, {fine:.3e}, order {order:.3}");
    }
}

/// After the press-in nothing moves any more, most points are at the bound of friction, and steps cost next to nothing,
/// whichever way the axis points.
#[test]
fn a_hub_at_rest_takes_no_iterations() {
    let straight = common::changed(&in_space([24, 20], [12, 10]), |data| {
        data.contacts.remove(0);
        let held = BoundaryCondition::on("hub_bottom").normal_displacement(0.0);
        data.boundary = vec![BoundaryCondition::on("shaft_bottom").displacement([0.0; 3]), held];
        data.timeline = Timeline::equal(data.timeline.end(), 3);
    });
    for turn in 0..2 {
        let problem = common::changed(&straight, |data| {
            let mut mesh = (*data.mesh).clone();
            mesh.points.iter_mut().for_each(|x| x.rotate_right(turn));
            data.mesh = Arc::new(mesh);
        });
        let reports = common::solve(&problem).reports;
        let counts: Vec<usize> = reports.iter().map(|report| report.newton_mechanics).collect();
        let at_bound = reports[2].contact.states.iter().filter(|state| state.status == Status::Slip).count();
        println!("{counts:?} iterations, {at_bound} points at their bounds");
        assert!(counts[0] <= 12 && counts[1] <= 25 && counts[2..].iter().sum::<usize>() <= 10, "{counts:?} iterations");
        assert!(at_bound > 20, "{at_bound} points at their bounds");
    }
}

/// Blocks that overlap at the start press on each other by p = E δ/(2 l) in every step, on rigid contact and on a layer
/// that is far stiffer: nothing but the overlap does work, and in later steps none at all, so that the identity of
/// energy closes to the round-off of the energy that is stored.
#[test]
fn an_overlap_is_pressed_in_steps_that_do_no_work() {
    for (normal, yielding, elements) in [
        ("{ law = \"signorini\" }", 0.0, "Q1"),
        ("{ law = \"compliance\", stiffness = 1e18 }", 1e-18, "P1"),
        ("{ law = \"signorini\" }", 0.0, "P2"),
    ] {
        for overlap in [7e-6, 2.3e-6, 1.1e-7, 3.7e-9] {
            let text = format!(
                "name = \"overlap\"\n[mesh]\nkind = \"blocks\"\nblocks = [\n\
                 {{ name = \"a\", size = [0.1, 0.02], n = [6, 1], elements = \"{elements}\" }},\n\
                 {{ name = \"b\", size = [0.1, 0.02], n = [3, 1], origin = [0, {:?}], elements = \"{elements}\" }},\n]\n\
                 [time]\nend = 1\nsteps = 3\n[material]\ndensity = 0\nelasticity = {{ law = \"isotropic\", \
                 young = 73e9, poisson = 0.0, stress_state = \"plane-stress\" }}\n[[boundary]]\non = \"a_bottom\"\n\
                 displacement = [0, 0]\n[[boundary]]\non = \"b_top\"\ndisplacement = [0, 0]\n\
                 [contact]\non = \"b_bottom\"\nwith = \"a_top\"\nnormal = {normal}\n",
                0.02 - overlap
            );
            let memory = common::solve(&problem(&text));
            let expected = overlap / (0.04 / 73e9 + yielding);
            for state in &memory.reports {
                for (point, weight) in state.contact.states.iter().zip(&state.contact.weights) {
                    let off = point.pressure / expected - 1.0;
                    assert!(*weight <= 0.0 || off.abs() < 1e-8, "{off:e} of {expected:e}\n{text}");
                }
            }
            for state in &memory.states[1..] {
                let closing = state.ledger.relative_closing_error();
                assert!(closing.abs() < 1e-12, "{closing:e}\n{text}");
            }
        }
    }
}
