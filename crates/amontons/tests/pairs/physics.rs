//! What pairs of bodies do as a whole: sliding over facets, sides that are swapped, cracks, stiffness, rigid motions.

use crate::common;
use amontons::case::{self, Source};
use amontons::contact::Status;
use amontons::discretization::Discretization;
use amontons::inclusion::PointState;
use amontons::output::Memory;
use amontons::problem::{Problem, with_supports};
use amontons::run::{self, Settings};

fn problem(text: &str) -> Problem {
    case::parse(&Source::new("pair.toml", text), &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).problem
}

fn made(text: &str) -> Memory {
    let (problem, mut memory) = (problem(text), Memory::new().states_every(1).reports());
    let settings = Settings { certificate: false, ..Settings::default() };
    run::run(&problem, &settings, &mut [&mut memory]).unwrap_or_else(|error| panic!("{error}\n{text}"));
    memory
}

fn two(lower: &str, upper: &str) -> String {
    format!(
        "name = \"pair\"\n[mesh]\nkind = \"blocks\"\n[[mesh.blocks]]\nname = \"lower\"\n{lower}\n[[mesh.blocks]]\nname = \"upper\"\n{upper}\n"
    )
}

fn material(young: f64) -> String {
    format!(
        "density = 0\nelasticity = {{ law = \"isotropic\", young = {young:?}, poisson = 0.3, stress_state = \"plane-strain\" }}\n"
    )
}

/// Ten facets of the rail at μ = 0.3 under the pressure 2 on a length of 1: once it slips, the block feels 0.6 along
/// and 2 across in every step, whichever facets face each other. The faces tilt by strains of the order p/E, here 2e-7,
/// and with them the force; with E = 1e3 it is 0.60017 in place of 0.6.
#[test]
fn a_block_that_slides_over_facets_feels_a_constant_force() {
    let text = two("size = [4.0, 0.5]\nn = [27, 4]", "size = [1.0, 0.5]\nn = [6, 4]\norigin = [0.5, 0.5]")
        + "[time]\nend = 1.0\nsteps = 60\n[material]\n"
        + &material(1e7)
        + "[[boundary]]\non = \"lower_bottom\"\ndisplacement = [0, 0]\n\
           [[boundary]]\non = \"upper_top\"\ndisplacement = [\"1.5*t\", \"free\"]\ntraction = [0, -2]\n\
           [contact]\non = \"upper_bottom\"\nwith = \"lower_top\"\ngeometry = \"updated\"\n\
           normal = { law = \"signorini\" }\nfriction = { law = \"coulomb\", coefficient = 0.3 }\n";
    let memory = made(&text);
    let mut compared = 0;
    for report in &memory.reports {
        let [along, across, _] = report.contact.force;
        assert!((across - 2.0).abs() < 1e-9, "{across}");
        if report.contact.states.iter().all(|state| state.status != Status::Stick) {
            assert!((along + 0.6).abs() < 1e-6, "{along}");
            compared += 1;
        }
    }
    assert!(compared >= 55, "{compared} steps of slip");
    let moved = memory.states.last().expect("a state").u.iter().fold(0.0, |most: f64, u| most.max(*u));
    assert!(moved > 1.4, "{moved}");
    assert!(memory.states.last().expect("a state").ledger.relative_closing_error() < 1e-12);
}

/// Which side bears the points is of no account but for the size of the facets: where the solution is smooth, energies
/// differ by the order 2 of the method.
#[test]
fn swapped_sides_differ_by_less_on_finer_meshes() {
    let energy = |n: usize, nonmortar: &str| {
        let text = two(
            &format!("size = [1.0, 1.0]\nn = [{}, {}]", 4 * n, 4 * n),
            &format!("size = [1.0, 0.5]\nn = [{}, {}]\norigin = [0.0, 1.0]", 5 * n, 3 * n),
        ) + "[time]\nend = 1.0\nsteps = 1\n[material]\n"
            + &material(10.0)
            + "[[boundary]]\non = \"lower_bottom\"\ndisplacement = [\"free\", 0]\n\
               [[boundary]]\non = \"lower_left\"\ndisplacement = [0, \"free\"]\n\
               [[boundary]]\non = \"upper_left\"\ndisplacement = [0, \"free\"]\n\
               [[boundary]]\non = \"lower_right\"\ndisplacement = [0, \"free\"]\n\
               [[boundary]]\non = \"upper_right\"\ndisplacement = [0, \"free\"]\n\
               [[boundary]]\non = \"upper_top\"\npressure = \"1 + 0.5*cos(pi*x)\"\n\
               [contact]\non = \"upper_bottom\"\nwith = \"lower_top\"\nnormal = { law = \"signorini\" }\n\
               nonmortar = \""
            + nonmortar
            + "\"\n";
        made(&text).states.last().expect("a state").ledger.elastic
    };
    let difference = |n: usize| (energy(n, "upper_bottom") / energy(n, "lower_top") - 1.0).abs();
    let [coarse, fine] = [difference(1), difference(4)];
    let order = (coarse / fine).log2() / 2.0;
    assert!(order > 1.9, "order {order}: {coarse:e}, {fine:e}");
}

/// Twelve decades of the quotient of stiffnesses take about as many iterations.
#[test]
fn stiffness_does_not_matter_to_the_iteration() {
    let iterations = |young: f64| {
        let text = two("size = [1.0, 0.5]\nn = [9, 4]", "size = [0.6, 0.5]\nn = [7, 5]\norigin = [0.2, 0.5]")
            + "[time]\nend = 1.0\nsteps = 20\n[material]\n"
            + &material(1.0)
            + "[[region]]\non = \"upper\"\n[region.material]\n"
            + &material(young)
            + "[[boundary]]\non = \"lower_bottom\"\ndisplacement = [0, 0]\n\
               [[boundary]]\non = \"upper_top\"\ndisplacement = [\"0.02*sin(6.283*t)\", \"-0.01*min(5*t, 1)\"]\n\
               [contact]\non = \"upper_bottom\"\nwith = \"lower_top\"\nnormal = { law = \"signorini\" }\n\
               friction = { law = \"coulomb\", coefficient = 0.4 }\n";
        let memory = made(&text);
        let last = memory.states.last().expect("a state");
        assert!(
            last.ledger.relative_closing_error() < 1e-10,
            "E = {young:e}: {:e}",
            last.ledger.relative_closing_error()
        );
        assert_eq!(last.counts.halved_steps, 0);
        last.counts.newton_mechanics_total
    };
    let all: Vec<usize> = [1e-6, 1e-3, 1.0, 1e3, 1e6].map(iterations).to_vec();
    let (least, most) = (all.iter().min().expect("a count"), all.iter().max().expect("a count"));
    assert!(most * 2 <= least * 3, "{all:?}");
}

/// A pair moved as a whole, forth and back, keeps its contact forces.
#[test]
fn a_rigid_motion_changes_no_contact_force() {
    let text = two("size = [1.0, 0.5]\nn = [5, 3]", "size = [1.0, 0.5]\nn = [7, 3]\norigin = [0.0, 0.5]")
        + "[time]\nend = 3.0\nsteps = 3\n[material]\n"
        + &material(10.0)
        + "[[boundary]]\non = \"lower_bottom\"\ndisplacement = [\"0.3*max(t - 1, 0)\", \"-0.2*max(t - 1, 0)\"]\n\
           [[boundary]]\non = \"upper_top\"\ndisplacement = [\"0.01*min(t, 1) + 0.3*max(t - 1, 0)\", \"-0.02*min(t, 1) - 0.2*max(t - 1, 0)\"]\n\
           [contact]\non = \"upper_bottom\"\nwith = \"lower_top\"\nnormal = { law = \"signorini\" }\n\
           friction = { law = \"coulomb\", coefficient = 0.4 }\n";
    let memory = made(&text);
    let force = |i: usize| memory.reports[i].contact.force;
    assert!(force(0)[1] > 0.1);
    for c in 0..2 {
        assert!((force(2)[c] - force(0)[c]).abs() < 1e-10 * force(0)[1], "{:?}, {:?}", force(2), force(0));
    }
}

/// A slit through half of a plate: its faces are two sides of one body, whose tip they share. Pressed together they
/// bear what the plate bears without a slit.
#[test]
fn the_faces_of_a_slit_bear_the_pressure() {
    use amontons::contact::{Contact, Pair, Signorini};
    use amontons::mesh::{Diagonal, FacetSet, Mesh};
    let mut mesh = Mesh::rectangle([2.0, 2.0], [8, 8], Diagonal::Right).expect("a mesh");
    // The nodes of y = 1, x < 1 are doubled: cells above have the new ones.
    let n = mesh.points.len() as u32;
    let on_slit: Vec<u32> = (0..4).map(|i| 4 * 9 + i).collect();
    for &node in &on_slit {
        let x = mesh.points[node as usize];
        mesh.points.push(x);
    }
    for cell in mesh.blocks[0].nodes.chunks_exact_mut(3) {
        if cell.iter().map(|&node| mesh.points[node as usize][1]).sum::<f64>() > 3.0 {
            for node in cell {
                if let Some(i) = on_slit.iter().position(|old| old == node) {
                    *node = n + i as u32;
                }
            }
        }
    }
    for (name, set) in &mut mesh.facets {
        if name == "left" {
            for block in &mut set.blocks {
                for edge in block.nodes.chunks_exact_mut(2) {
                    let is_above = edge.iter().any(|&node| mesh.points[node as usize][1] > 1.1);
                    edge.iter_mut().filter(|node| is_above && **node == on_slit[0]).for_each(|node| *node = n);
                }
            }
        }
    }
    let segment = &amontons::element::P1_SEGMENT;
    let below = (0..4u32).flat_map(|i| [4 * 9 + i + 1, 4 * 9 + i]).collect();
    let above = (0..4u32).flat_map(|i| [n + i, if i < 3 { n + i + 1 } else { 4 * 9 + 4 }]).collect();
    mesh.facets.insert("below".to_owned(), FacetSet::of(segment, below));
    mesh.facets.insert("above".to_owned(), FacetSet::of(segment, above));
    let text = "name = \"slit\"\n[mesh]\nkind = \"rectangle\"\nsize = [2.0, 2.0]\nn = 8\n[time]\nend = 1.0\nsteps = 1\n[material]\n"
        .to_owned()
        + &material(100.0)
        + "[[boundary]]\non = \"bottom\"\ndisplacement = [\"free\", 0]\n[[boundary]]\non = \"right\"\ndisplacement = [0, \"free\"]\n\
           [[boundary]]\non = \"top\"\npressure = 2\n";
    let slit = problem(&text).with(|data| {
        data.mesh = std::sync::Arc::new(mesh);
        data.contacts = vec![Contact::new("above", Signorini).with(Pair::new("below"))];
    });
    let problem = slit.unwrap_or_else(|faults| panic!("{faults}"));
    let mut memory = Memory::new().reports();
    let settings = Settings { certificate: false, ..Settings::default() };
    run::run(&problem, &settings, &mut [&mut memory]).expect("a run");
    let states = &memory.reports[0].contact.states;
    // All vertices but the tip.
    assert_eq!(states.len(), 4);
    assert!(states.iter().all(|state| (state.pressure - 2.0).abs() < 1e-12), "{states:?}");
}

/// A block that rubs on another and is warmer: conduction, radiation and friction at once.
fn rubbing(geometry: &str, curved: bool, nonmortar: &str) -> Problem {
    let heat = "{ law = \"sum\", laws = [{ law = \"pressure\", coefficient = 2.0, exponent = 0.95 }, \
                { law = \"constant\", conductance = 1.5 }, \
                { law = \"radiation\", emissivity = 0.8, absolute_zero = -2.0, constant = 0.1 }] }";
    let thermal = "conductivity = 1\nheat_capacity = 1\n";
    let mut text = two("size = [1.0, 0.5]\nn = [9, 4]", "size = [0.6, 0.5]\nn = [7, 5]\norigin = [0.2, 0.5]")
        + "[time]\nend = 1.0\nsteps = 6\n[material]\n"
        + &material(10.0)
        + thermal
        + "[initial]\ntemperature = \"y\"\n[[boundary]]\non = \"lower_bottom\"\ndisplacement = [0, 0]\n\
           [[boundary]]\non = \"upper_top\"\ndisplacement = [\"0.1*t\", \"-0.01*min(5*t, 1)\"]\n[contact]\n\
           on = \"upper_bottom\"\nwith = \"lower_top\"\nnormal = { law = \"signorini\" }\nfrictional_heat = 0.3\n\
           friction = { law = \"coulomb\", coefficient = 0.4 }\nwear = { law = \"archard\", coefficient = 1e-4, fraction = 0.25 }\n";
    text += &format!("geometry = \"{geometry}\"\nnonmortar = \"{nonmortar}\"\nheat = {heat}\n");
    let problem = problem(&text);
    if !curved {
        return problem;
    }
    common::changed(&problem, |data| {
        for x in &mut std::sync::Arc::make_mut(&mut data.mesh).points {
            x[1] += 0.03 * (std::f64::consts::PI * x[0]).sin() * (1.0 - (x[1] - 0.5).abs() * 2.0);
        }
    })
}

/// The moment that is reported is that of the forces on the nodes of both bodies, Σ x × f; it vanishes where the sides
/// lie on one line, and is small beside the moment of the forces on one body where they are curved.
#[test]
fn the_defect_of_moments_is_that_of_the_nodal_forces() {
    for (geometry, curved) in [("reference", false), ("reference", true), ("updated", false), ("updated", true)] {
        let problem = rubbing(geometry, curved, "upper_bottom");
        let memory = common::solve(&problem);
        let discrete = Discretization::new(&problem);
        for n in 1..memory.reports.len() {
            let (before, contact) = (&memory.states[n].u, &memory.reports[n].contact);
            let updated = with_supports(&discrete.v, None, |supports| {
                discrete.boundary.updated(&problem.contacts, &problem.mesh, before, supports)
            });
            let (boundary, moves) = (updated.as_deref().unwrap_or(&discrete.boundary), updated.is_some());
            let mut forces = vec![0.0; 2 * problem.mesh.points.len()];
            let traction = |s: &PointState| std::array::from_fn(|c| 0.0 - s.pressure * s.normal[c] - s.q[c]);
            boundary.scatter(2, contact.states.iter().map(traction), &mut forces);
            let (mut moment, mut of_one) = (0.0, 0.0f64);
            for (i, f) in forces.chunks_exact(2).enumerate() {
                let x: [f64; 2] =
                    std::array::from_fn(|c| problem.mesh.points[i][c] + if moves { before[2 * i + c] } else { 0.0 });
                moment += x[0] * f[1] - x[1] * f[0];
                of_one += (x[0] * f[1]).abs();
            }
            let told = contact.moments[0][2];
            assert!((told - moment).abs() < 1e-13 * of_one, "{geometry} {curved}: {told:e}, {moment:e}");
            if curved {
                assert!(told.abs() < 1e-2 * of_one && told.abs() > 1e-9 * of_one, "{told:e} of {of_one:e}");
            } else if !moves {
                assert!(told.abs() < 1e-9 * of_one, "{told:e} of {of_one:e}");
            }
        }
    }
}

/// The heat that has passed by pressure, by the constant conductance, by radiation and from friction: what has left one
/// side and not entered the other is what friction made; a body that exchanges heat with the other alone has lost the
/// sum; at each instant radiation is σε(θ⁴ − θ_other⁴) and the conductances are as their laws say.
#[test]
fn heat_is_split_by_what_it_passes_by() {
    for nonmortar in ["upper_bottom", "lower_top"] {
        let problem = rubbing("reference", false, nonmortar);
        let memory = common::solve(&problem);
        let contact = &problem.contacts[0];
        let last = memory.states.last().expect("a state");
        let out = last.surface.passed[0].by_name();
        assert_eq!(out.keys().collect::<Vec<_>>(), ["constant", "friction", "pressure", "radiation"]);
        let made = last.ledger.heat_pairs;
        assert!(made > 0.0 && (out["friction"] + 0.3 * made).abs() < 1e-12 * made, "{} of {made}", out["friction"]);
        // The upper body is insulated elsewhere.
        let discrete = Discretization::new(&problem);
        let first_above = problem.mesh.points.len() - 8 * 6;
        let content = |theta: &[f64]| {
            let stored = discrete.stored_heat(theta);
            stored[first_above..].iter().sum::<f64>()
        };
        let lost = content(&memory.states[0].theta) - content(&last.theta);
        let sum: f64 = out.values().sum();
        assert!(lost.abs() > 1e-3 && (lost - sum).abs() < 1e-11 * lost.abs(), "{lost}, {sum}");

        let k = problem.timeline.longest();
        let mut expected = [0.0; 3];
        for report in &memory.reports {
            let of = &report.contact;
            for (i, state) in of.states.iter().enumerate() {
                // Σ of the three laws is the flux without friction, and each is positive.
                let rubbed = if nonmortar == "upper_bottom" { 0.3 } else { 0.7 } * of.rubbed[i];
                let (theta, rest) = (of.temperature[i], of.flux[i].value + rubbed);
                let laws = |other: f64| {
                    let h = 2.0 * state.pressure.max(0.0).powf(0.95);
                    let fourth = |theta: f64| (theta + 2.0).powi(4);
                    [h * (theta - other), 1.5 * (theta - other), 0.08 * (fourth(theta) - fourth(other))]
                };
                // θ of the other side from the sum of the laws, by bisection.
                let (mut low, mut high) = (theta - 10.0, theta + 10.0);
                for _ in 0..100 {
                    let middle = 0.5 * (low + high);
                    *(if laws(middle).iter().sum::<f64>() > rest { &mut low } else { &mut high }) = middle;
                }
                assert!((low - of.opposite[i]).abs() < 1e-9, "{low} and {}", of.opposite[i]);
                let sign = contact.sign() * k * of.weights[i];
                expected.iter_mut().zip(laws(low)).for_each(|(sum, value)| *sum += sign * value);
            }
        }
        for (way, expected) in ["pressure", "constant", "radiation"].into_iter().zip(expected) {
            assert!((out[way] - expected).abs() < 1e-9 * sum.abs(), "{way}: {}, {expected}", out[way]);
        }
    }
}

/// What wears off is shared out by `fraction`, whichever side bears the points.
#[test]
fn wear_comes_off_both_sides() {
    for nonmortar in ["upper_bottom", "lower_top"] {
        let problem = rubbing("reference", false, nonmortar);
        let summary = run::run(&problem, &Settings::default(), &mut []).expect("a run");
        let contact = summary.last.contact.expect("contact");
        let [upper, lower] = ["upper_bottom", "lower_top"].map(|side| contact.wear_volumes[side]);
        assert!(upper > 0.0 && (lower - 3.0 * upper).abs() < 1e-12 * lower, "{upper}, {lower}");
        assert!((upper + lower - contact.wear_volume).abs() < 1e-12 * lower);
    }
}

/// A block that nothing touches at first, pressed by another one that comes down on it. The tangents of iterates at
/// which it is loose are singular: where round-off decides how far it is thrown, no such iterate is a solution.
#[test]
fn a_loose_body_is_not_lost() {
    let mut random = common::Random(11);
    for _ in 0..200 {
        let mut near = |value: f64, share: f64| value * (1.0 + share * random.number());
        let text = format!(
            "name = \"stack\"\n[mesh]\nkind = \"blocks\"\nblocks = [\n\
             {{ name = \"low\", size = [1.0, 0.5], n = [6, 3] }},\n\
             {{ name = \"middle\", size = [{:?}, 0.3], n = [5, 4], origin = [{:?}, 0.5] }},\n\
             {{ name = \"high\", size = [1.0, 0.2], n = [7, 2], origin = [0.0, 0.801] }},\n]\n\
             [time]\nend = 1.0\nsteps = 2\n[material]\n{}\
             [[boundary]]\non = \"low_bottom\"\ndisplacement = [0, 0]\n\
             [[boundary]]\non = \"high_top\"\ndisplacement = [\"{:?}*t\", \"{:?}*t\"]\n",
            near(0.4, 0.2),
            near(0.25, 0.2),
            material(100.0),
            near(1e-3, 2.0),
            near(-5e-3, 0.2),
        ) + &[("low_top", "middle_bottom"), ("middle_top", "high_bottom")]
            .map(|(on, with)| {
                format!(
                    "[[contact]]\non = \"{on}\"\nwith = \"{with}\"\nnormal = {{ law = \"signorini\" }}\n\
                     friction = {{ law = \"coulomb\", coefficient = 0.3 }}\n"
                )
            })
            .concat();
        let memory = made(&text);
        let last = memory.states.last().expect("a state");
        assert!(last.counts.residual_max < 1e-9, "{:e}\n{text}", last.counts.residual_max);
        assert!(common::largest(&last.u) < 0.1, "{:e}\n{text}", common::largest(&last.u));
    }
}

/// A block that falls on another one while its top is moved sideways: where nothing touches, the rest of what moves it
/// sideways is far larger than its load, and round-off alone holds it against that load.
#[test]
fn a_block_that_is_moved_while_it_falls_is_found() {
    let mut random = common::Random(25);
    for _ in 0..60 {
        let mut between = |low: f64, high: f64| low + 0.5 * (high - low) * (1.0 + random.number());
        let (n, load) = (between(2.0, 8.0) as usize, between(0.1, 1.0));
        let width = between(0.8, 1.0);
        let text = format!(
            "name = \"falling\"\n[mesh]\nkind = \"blocks\"\nblocks = [\n\
             {{ name = \"low\", size = [1.0, 0.5], n = [6, 4], elements = \"P1\" }},\n\
             {{ name = \"high\", size = [{width:?}, 0.2], n = [{n}, 5], origin = [{:?}, {:?}] }},\n]\n\
             [time]\nend = 1.0\nsteps = 5\n[material]\n{}\
             [[boundary]]\non = \"low_bottom\"\ndisplacement = [0, 0]\n\
             [[boundary]]\non = \"high_top\"\ndisplacement = [\"{:?}*sin(2*t)\", \"free\"]\ntraction = [0, \"-{load:?}*t\"]\n\
             [[contact]]\non = \"high_bottom\"\nwith = \"low_top\"\nnormal = {{ law = \"compliance\", stiffness = {:?} }}\n",
            between(0.0, 0.3),
            0.5 + 10f64.powf(between(-5.0, -2.0)),
            material(5000.0),
            between(-5e-4, 5e-4),
            10f64.powf(between(2.0, 6.0)),
        );
        let memory = made(&text);
        for (step, report) in (1..).zip(&memory.reports) {
            let (force, pressed) = (report.contact.force[1].abs(), width * load * 0.2 * f64::from(step));
            assert!((force - pressed).abs() < 1e-8 * pressed, "{force} and {pressed}\n{text}");
        }
    }
}

/// A block is pressed onto another and shaken, with friction that falls from 0.6 to 0.4 within slip of 0.1 m/s.
const SHAKEN: &str = r#"
name = "shaken"
units = "dimensionless"
[mesh]
kind = "blocks"
blocks = [
  { name = "a", elements = "Q1", size = [1.0, 0.4, 1.0], origin = [0, -0.4, 0], n = [2, 2, 2] },
  { name = "b", elements = "Q1", size = [1.0, 0.4, 1.0], n = [3, 2, 3] },
]
[time]
end = 0.4
steps = 8
[material]
density = 0
elasticity = { law = "isotropic", young = 1.0, poisson = 0.3 }
[[boundary]]
on = "b_top"
displacement = ["0.02*sin(5*t)", "-0.01*min(1, t/0.1)", 0]
[[boundary]]
on = "a_bottom"
displacement = [0, 0, 0]
[contact]
on = "b_bottom"
with = "a_top"
normal = { law = "signorini" }
friction = { law = "static-kinetic", static = 0.6, kinetic = 0.4, decay_speed = 0.1 }
[solver]
solver = "iterative"
"#;

/// An iteration tells the steps with several solutions that a factor tells: seven of eight without inertia, whose body
/// is softer than friction falls, and none with enough of it. Both take the same Newton iterations.
#[test]
fn falling_friction_is_told_by_an_iteration_as_by_a_factor() {
    let swapped =
        SHAKEN.replace("on = \"b_bottom\"", "on = \"a_top\"").replace("with = \"a_top\"", "with = \"b_bottom\"");
    let soft = SHAKEN.replace(r#"{ law = "signorini" }"#, r#"{ law = "compliance", stiffness = 50.0 }"#);
    let heavy = SHAKEN.replace("density = 0", "density = 0.1");
    for (text, ambiguous) in [(SHAKEN, 7), (&swapped, 7), (&soft, 7), (&heavy, 0)] {
        let last = |text: &str| made(text).states.pop().expect("a state");
        let (factor, iteration) = (last(&text.replace("iterative", "direct")), last(text));
        assert_eq!([&factor, &iteration].map(|state| state.counts.ambiguous_steps), [ambiguous; 2]);
        let newton = [&factor, &iteration].map(|state| state.counts.newton_mechanics_total);
        assert!(newton[1] <= newton[0] + newton[0] / 4, "{newton:?}");
        assert!(iteration.counts.krylov_iterations <= 8 * newton[1], "{}", iteration.counts.krylov_iterations);
        let scale = factor.u.iter().fold(0.0f64, |m, u| m.max(u.abs()));
        let difference = factor.u.iter().zip(&iteration.u).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(difference <= 1e-7 * scale, "{:.1e}", difference / scale);
    }
}
