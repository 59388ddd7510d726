//! A foundation, or the other side of a pair, that slides out of the plane of a body or about its axis of revolution.

use std::f64::consts::PI;

use crate::common::{self, Random};
use amontons::case::{self, Source};
use amontons::contact::Status;
use amontons::output::Memory;
use amontons::problem::Problem;
use amontons::tensor::dot;

fn problem(text: &str) -> Problem {
    case::parse(&Source::new("across", text), &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).problem
}

/// A block that is pressed and dragged, in the plane or as a slab whose nodes do not move across the plane.
fn block(dim: usize, seed: u64) -> String {
    let mut random = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    let mut number = |middle: f64, spread: f64| middle + spread * random.number();
    let [a, b, mu] = [number(0.0, 1.0), number(0.0, 2.0), number(0.4, 0.2)];
    let [drag, press, bend, share] = [number(0.0, 0.02), number(0.01, 0.004), number(0.0, 0.01), number(0.5, 0.3)];
    let [x, y] = [number(1.3, 0.3), number(0.5, 0.1)];
    let (mesh, thickness, held) = if dim == 2 {
        (format!("kind = \"rectangle\"\nsize = [{x}, {y}]\nn = [6, 3]"), String::new(), "")
    } else {
        let hold = |side: &str| format!("[[boundary]]\non = \"{side}\"\ndisplacement = [\"free\", \"free\", 0]\n");
        (format!("kind = \"box\"\nsize = [{x}, {y}, 1.0]\nn = [6, 3, 1]"), hold("front") + &hold("back"), ", 0")
    };
    format!(
        r#"name = "across"
[mesh]
{mesh}
elements = "Q1"
[time]
end = 1.0
steps = 5
[scheme]
coupling = "monolithic"
[material]
density = 1.5
heat_capacity = 2.0
conductivity = 0.3
expansion = 0.5
coupling = 0.1
elasticity = {{ law = "isotropic", young = 100, poisson = 0.3{plane} }}
viscosity = {{ law = "lame", first = 0.5, second = 1.0 }}
{thickness}
[[boundary]]
on = "top"
displacement = ["{drag}*t", "-{press}*t - {bend}*t*x"{held}]
temperature = 0
[contact]
on = "bottom"
normal = {{ law = "compliance", stiffness = 2e3 }}
friction = {{ law = "static-kinetic", static = {top}, kinetic = {mu}, decay_speed = 0.7 }}
wear = {{ law = "archard", coefficient = 1e-4 }}
heat = {{ law = "constant", conductance = 3, foundation_temperature = 0.2 }}
frictional_heat = {share}
foundation_velocity = ["0.01*sin(7*t)", 0, "{a} + {b}*x"]
"#,
        plane = if dim == 2 { ", stress_state = \"plane-strain\"" } else { "" },
        top = 1.3 * mu,
    )
}

/// Sums over Γ_C at the end: p ν + q, the slip velocity, heat flux, depth worn off; and the terms of the audit.
fn sums(problem: &Problem, run: &Memory) -> Vec<(&'static str, f64)> {
    let (state, report) = (run.states.last().expect("a state"), run.reports.last().expect("a report"));
    let (contact, ledger) = (&report.contact, &state.ledger);
    let weighted = |of: &dyn Fn(usize) -> f64| (0..contact.states.len()).map(|i| contact.weights[i] * of(i)).sum();
    let of =
        |c: usize| weighted(&|i| contact.states[i].pressure * contact.states[i].normal[c] + contact.states[i].q[c]);
    let slip = |c: usize| weighted(&|i| contact.states[i].slip[c]);
    let largest = |values: &[f64]| common::largest(values);
    assert!(contact.states.iter().any(|s| s.status == Status::Slip) && problem.slides_out() == (problem.mesh.dim == 2));
    vec![
        ("force x", of(0)),
        ("force y", of(1)),
        ("force z", of(2)),
        ("slip x", slip(0)),
        ("slip z", slip(2)),
        ("flux", weighted(&|i| contact.flux[i].value)),
        ("power", weighted(&|i| dot(&contact.states[i].q, &contact.states[i].slip))),
        ("wear", weighted(&|i| state.surface.wear[i])),
        ("work", weighted(&|i| state.surface.friction_work[i])),
        ("u", largest(&state.u)),
        ("w", largest(&state.w)),
        ("θ", largest(&state.theta)),
        ("friction", ledger.friction_dissipation),
        ("load", ledger.load_work),
        ("worn", ledger.wear_dissipation),
        ("heat of friction", ledger.heat_friction),
        ("heat out", ledger.heat_contact),
    ]
}

/// A plane case and the slab of thickness 1, where slip has two directions and the second is that of nodes that are
/// held, are two ways to the same numbers.
#[test]
fn sliding_out_of_the_plane_is_that_of_a_slab() {
    for seed in [3, 17, 4711, 90_210] {
        let [plane, slab] = [2, 3].map(|dim| {
            let problem = problem(&block(dim, seed));
            let run = common::solve(&problem);
            let ledger = &run.states.last().expect("a state").ledger;
            assert!(ledger.closing_error.abs() <= 1e-12 * ledger.turned_over, "energy {:e}", ledger.closing_error);
            assert!(ledger.heat_closing_error.abs() <= 1e-12 * ledger.heat_turned_over);
            sums(&problem, &run)
        });
        for ((what, plane), (_, slab)) in plane.iter().zip(&slab) {
            println!("{seed}: {what} {plane:.6e}");
            assert!((plane - slab).abs() <= 1e-9 * slab.abs(), "{seed}: {what} is {plane:e}, of the slab {slab:e}");
        }
    }
}

/// Friction of a foundation that comes to rest ends with the slip, and a body in the plane sticks then.
#[test]
fn a_foundation_that_stops_lets_the_body_stick() {
    let text = block(2, 17);
    let (before, velocity) = text.split_at(text.find("foundation_velocity").expect("the velocity"));
    let more = &velocity[velocity.find('\n').expect("a line")..];
    // The supports stop as well.
    let stopped =
        format!("{before}foundation_velocity = [0, 0, \"max(0.6 - t, 0)\"]{more}").replace("*t", "*min(t, 0.5)");
    let run = common::solve(&problem(&stopped));
    for (step, report) in (1..).zip(&run.reports) {
        let states = &report.contact.states;
        let pressed = || states.iter().filter(|s| s.pressure > 0.0);
        if step < 3 {
            assert!(pressed().all(|s| s.status == Status::Slip && s.q[2] < 0.0), "step {step}: {states:?}");
        } else {
            assert!(pressed().all(|s| s.q[2] == 0.0 && s.slip[2] == 0.0), "step {step}: {states:?}");
            assert!(pressed().any(|s| s.status == Status::Stick), "step {step}: {states:?}");
        }
    }
}

/// An annular facing that is pressed uniformly on a disc that turns: M = 2π μ p (R³ − r³)/3, exact for weights
/// ∫ N 2π r dr, and the power M ω; as one body on a rigid disc, and as a pair of bodies with either side nonmortar.
#[test]
fn a_clutch_of_revolution_has_the_moment_of_its_pressure() {
    let [inner, outer, p, mu, omega] = [0.09, 0.12, 4e5, 0.3, 100.0];
    let moment = 2.0 * PI / 3.0 * mu * p * (f64::powi(outer, 3) - f64::powi(inner, 3));
    let facing = |more: &str, contact: &str| {
        format!(
            r#"name = "clutch"
[mesh]
kind = "blocks"
axisymmetric = true
[[mesh.blocks]]
name = "facing"
size = [0.03, 0.003]
n = [5, 2]
origin = [0.09, 0.0]
{more}
[time]
end = 0.1
steps = 2
[material]
density = 0
heat_capacity = 3e6
conductivity = 12
elasticity = {{ law = "isotropic", young = 3e8, poisson = 0 }}
[[boundary]]
on = "facing_top"
pressure = {p}
[[boundary]]
on = "facing_left"
displacement = [0, "free"]
[contact]
{contact}
normal = {{ law = "compliance", stiffness = 1e12 }}
friction = {{ law = "coulomb", coefficient = {mu} }}
foundation_velocity = [0, 0, "{omega}*x"]
frictional_heat = 0.3
"#
        )
    };
    let disc = "[[mesh.blocks]]\nname = \"disc\"\nsize = [0.03, 0.01]\nn = [7, 2]\norigin = [0.09, -0.01]\n";
    let held = "[[boundary]]\non = \"disc_bottom\"\ndisplacement = [0, 0]\n";
    let pair = |nonmortar: &str| {
        let contact = format!("on = \"facing_bottom\"\nwith = \"disc_top\"\nnonmortar = \"{nonmortar}\"");
        facing(disc, &contact).replace("[contact]", &format!("{held}[contact]"))
    };
    let cases = [facing("", "on = \"facing_bottom\""), pair("facing_bottom"), pair("disc_top")];
    for text in &cases {
        let problem = problem(text);
        let run = common::solve(&problem);
        let end = &run.summary.as_ref().expect("a summary").last;
        let contact = end.contact.as_ref().expect("contact");
        let found = contact.moment.expect("a moment");
        // The disc turns, which is `with`, whichever side bears the points. Friction along r, which expands, takes part
        // of the bound.
        assert!((found / moment - 1.0).abs() < 1e-5, "{found}, expected {moment}");
        let ledger = &run.states.last().expect("a state").ledger;
        assert!((ledger.friction_dissipation / (moment * omega * problem.timeline.end()) - 1.0).abs() < 1e-5);
        assert!(ledger.closing_error.abs() <= 1e-12 * ledger.turned_over);
        assert!(ledger.heat_closing_error.abs() <= 1e-12 * ledger.heat_turned_over);
        assert_eq!(contact.force.len(), 2);
    }
}

#[test]
fn a_tie_does_not_slide_out_of_the_plane() {
    let slides = block(2, 17);
    let (before, rest) = slides.split_at(slides.find("friction = ").expect("a law"));
    let text = format!("{before}friction = {{ law = \"stick\" }}{}", &rest[rest.find('\n').expect("a line")..]);
    assert_eq!(
        common::told(&Source::new("out.toml", text), &[]).lines().next(),
        Some(
            "out.toml:32:23: contact.foundation_velocity: found friction that never slips, with a velocity out of the plane \
             of the body, expected friction that can slip; remove the velocity out of the plane, or give another friction law"
        )
    );
}

/// A rod that is pressed on a foundation which slides past its end: the power of friction is μ p ‖v‖ of both
/// components, half of it enters the rod, and nothing moves.
#[test]
fn a_foundation_slides_past_the_end_of_a_rod() {
    let ([p, mu], v) = ([2.0, 0.3], [0.6, -0.8]);
    let text = format!(
        r#"name = "rod"
[mesh]
kind = "interval"
size = 1.0
n = 4
[time]
end = 2.0
steps = 4
[material]
density = 0
heat_capacity = 1
conductivity = 1
elasticity = {{ law = "isotropic", young = 10, poisson = 0 }}
[[boundary]]
on = "right"
displacement = [{shortened}]
[contact]
on = "left"
normal = {{ law = "compliance", stiffness = 50 }}
friction = {{ law = "coulomb", coefficient = {mu} }}
foundation_velocity = [0, {v1}, {v2}]
frictional_heat = 0.5
"#,
        v1 = v[0],
        v2 = v[1],
        // By the rod, of Young's modulus 10, and by the compliance.
        shortened = -p * (1.0 / 10.0 + 1.0 / 50.0)
    );
    let run = common::solve(&problem(&text));
    let (state, report) = (run.states.last().expect("a state"), run.reports.last().expect("a report"));
    let point = &report.contact.states[0];
    // Friction on the foundation is along the slip w − v_F = −v_F of unit length.
    for (c, v) in v.iter().enumerate() {
        assert!((point.q[c + 1] + mu * p * v).abs() <= 1e-12 * mu * p, "{point:?}");
    }
    let power = mu * p;
    assert!((state.ledger.friction_dissipation - power * 2.0).abs() <= 1e-12 * power * 2.0);
    assert!((state.ledger.heat_content - 0.5 * power * 2.0).abs() <= 1e-10 * power);
}
