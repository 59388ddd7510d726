//! Several obstacles of one side: a body in a groove, between walls, in a corner and on rollers.
#![allow(clippy::too_many_lines, reason = "a test is one list of cases")]

use std::f64::consts::{FRAC_PI_2, PI};

use crate::common::solve;
use amontons::case::{self, Source};
use amontons::output::{
    ContactSummary, ContactValues, Memory, ProbeSet, Snapshot, Work, contact_columns, history_columns,
};
use amontons::problem::Problem;
use amontons::step::{March, Scheme};
use amontons::tensor::{Point, Rotation, dot, length};

fn problem(text: &str) -> Problem {
    case::parse(&Source::new("case.toml", text), &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).problem
}

/// What acts on each contact at the end, by its name.
fn force(memory: &Memory, name: &str) -> Point {
    let contact = memory.summary.as_ref().and_then(|summary| summary.last.contact.as_ref()).expect("contact");
    let of: &ContactSummary = contact.sides.get(name).unwrap_or_else(|| panic!("{name} of {:?}", contact.sides.keys()));
    std::array::from_fn(|c| of.force.get(c).copied().unwrap_or(0.0))
}

fn distance(a: &Point, b: &Point) -> f64 {
    length(&std::array::from_fn(|c| a[c] - b[c]))
}

fn vector(v: &Point, dim: usize) -> String {
    format!("{:?}", &v[..dim])
}

/// A body whose weight is `load`, with the blocks of a mesh and what else holds of it.
fn body(dim: usize, block: &str, load: &Point, solver: &str, rest: &str) -> String {
    let state = if dim == 2 { ", stress_state = \"plane-stress\"" } else { "" };
    format!(
        r#"name = "body"
[mesh]
kind = "blocks"
blocks = [{{ name = "body", {block} }}]
[time]
end = 1
steps = 2
[material]
density = 0
elasticity = {{ law = "isotropic", young = 1e4, poisson = 0.3{state} }}
viscosity = {{ law = "lame", first = 10, second = 10 }}
[load]
body_force = {load}
[solver]
solver = "{solver}"
{rest}"#,
        load = vector(load, dim),
    )
}

fn plane(on: &str, name: &str, point: &Point, normal: &Point, dim: usize) -> String {
    format!(
        "[[contact]]\non = \"{on}\"\nname = \"{name}\"\nnormal = {{ law = \"signorini\" }}\n\
         obstacle = {{ shape = \"plane\", point = {}, normal = {} }}\n",
        vector(point, dim),
        vector(normal, dim)
    )
}

/// A disc of 24 nodes around in a groove whose flanks are at an angle α to the vertical: without friction each bears
/// W/(2 sin α) along its normal, whatever the way is turned and in whichever order the flanks are given.
#[test]
fn the_flanks_of_a_groove_bear_half_the_weight_over_the_sine() {
    for (alpha, turn) in [(0.5, 0.0), (FRAC_PI_2 / 2.0, 0.7), (1.2, -2.3)] {
        let turned = Rotation::in_plane(turn);
        let area = 12.0 * (PI / 12.0).sin();
        let load = turned.vector(&[0.0, -3.0, 0.0]);
        let normals = [1.0, -1.0].map(|s| turned.vector(&[s * f64::cos(alpha), alpha.sin(), 0.0]));
        let [left, right] =
            [0, 1].map(|i| plane("body_outer", ["left", "right"][i], &normals[i].map(|c: f64| -c), &normals[i], 2));
        let expected = normals.map(|n| n.map(|c| c * 3.0 * area / (2.0 * alpha.sin())));
        for solver in ["direct", "iterative"] {
            let block = format!("radii = [0, 1], n = [4, 24], turn = {{ angle = {turn:?} }}");
            for contacts in [[&left, &right], [&right, &left]] {
                let text = body(2, &block, &load, solver, &(contacts[0].clone() + contacts[1]));
                let memory = solve(&problem(&text));
                let error = distance(&force(&memory, "left"), &expected[0])
                    .max(distance(&force(&memory, "right"), &expected[1]));
                println!("α = {alpha}, {solver}: {error:e} of {:e}", length(&expected[0]));
                assert!(error < 1e-9 * length(&expected[0]), "{error:e}");
            }
        }
    }
}

/// A block whose whole surface is one side, in the corner of three planes, turned at random: each plane bears its
/// component of the weight. Nodes of edges touch two planes, that of the corner three, and with friction that never
/// slips more conditions than unknowns hold there; the planes then bear the weight together.
#[test]
fn a_box_in_a_corner() {
    let turned = Rotation::about(&[0.3, -0.8, 0.5], 1.1);
    let parts = [1.0, 2.0, 0.5];
    let load = turned.vector(&parts.map(|c: f64| -c));
    let volume = 1.0 * 0.8 * 0.6;
    let laws = ["", "friction = { law = \"stick\" }\n", "friction = { law = \"coulomb\", coefficient = 0.3 }\n"];
    for (solver, law) in [("direct", 0), ("iterative", 0), ("direct", 1), ("direct", 2)].map(|(s, law)| (s, laws[law]))
    {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| turned.vector(&axis));
        let contacts = [0, 1, 2].map(|c| plane("skin", ["x", "y", "z"][c], &[0.0; 3], &axes[c], 3) + law);
        let sides = "[[side]]\nname = \"skin\"\nof = [\"body_left\", \"body_bottom\", \"body_back\"]\n";
        let block = "size = [1.0, 0.8, 0.6], n = [3, 3, 2], turn = { axis = [0.3, -0.8, 0.5], angle = 1.1 }";
        let memory = solve(&problem(&body(3, block, &load, solver, &(sides.to_owned() + &contacts.concat()))));
        let forces = ["x", "y", "z"].map(|name| force(&memory, name));
        let sum: Point = std::array::from_fn(|c| forces.iter().map(|f| f[c]).sum());
        let error = distance(&sum, &load.map(|c| -c * volume));
        println!("{solver}, {law:?}: {error:e}");
        assert!(error < 1e-9, "{error:e}");
        if law.is_empty() {
            for c in 0..3 {
                let error = distance(&forces[c], &axes[c].map(|a| a * parts[c] * volume));
                assert!(error < 1e-9, "{c}: {error:e}");
            }
        }
        let closing = memory.states.iter().map(|state| state.ledger.relative_closing_error().abs());
        assert!(closing.fold(0.0, f64::max) < 1e-12);
    }
}

/// Walls of compliance c that come together by δ on each side of a block of length 2: p = c (δ − s) = E s, where s is
/// by how much each end gives way. The walls are two obstacles of one side, and each node has the gap of both.
#[test]
fn a_block_between_two_walls() {
    let (young, stiffness, delta) = (1e4, 5e4, 1e-3);
    let pressure = young * stiffness * delta / (young + stiffness);
    for (dim, solver) in [(2, "direct"), (2, "iterative"), (3, "direct"), (3, "iterative")] {
        let turned = if dim == 2 { Rotation::in_plane(0.4) } else { Rotation::about(&[1.0, 2.0, -1.0], 0.8) };
        let along = turned.vector(&[1.0, 0.0, 0.0]);
        let ends = [-1.0, 1.0].map(|s| {
            let start = if s < 0.0 { [0.0; 3] } else { along.map(|c| 2.0 * c) };
            let motion: Vec<String> =
                (0..dim).map(|c| format!("\"{:?} + {:?}*t\"", start[c], -s * delta * along[c])).collect();
            format!(
                "[[contact]]\non = \"ends\"\nnormal = {{ law = \"compliance\", stiffness = {stiffness:?} }}\n\
                 obstacle = {{ shape = \"plane\", point = [{}], normal = {} }}\n",
                motion.join(", "),
                vector(&along.map(|c| -s * c), dim)
            )
        });
        let (block, area) = if dim == 2 {
            ("size = [2.0, 1.0], n = [4, 2], turn = { angle = 0.4 }", 1.0)
        } else {
            ("size = [2.0, 1.0, 0.5], n = [4, 2, 1], turn = { axis = [1, 2, -1], angle = 0.8 }", 0.5)
        };
        let rest = format!(
            "[[side]]\nname = \"ends\"\nof = [\"body_left\", \"body_right\"]\n{}[[boundary]]\non = \"body_bottom\"\nnormal_displacement = 0\n",
            ends.concat()
        );
        let rest = rest + if dim == 3 { "[[boundary]]\non = \"body_back\"\nnormal_displacement = 0\n" } else { "" };
        // Without viscosity the state at the end is that of the end alone.
        let text = body(dim, block, &[0.0; 3], solver, &rest)
            .replace("viscosity = { law = \"lame\", first = 10, second = 10 }\n", "");
        let memory = solve(&problem(&text));
        for (name, s) in [("ends", -1.0), ("ends-2", 1.0)] {
            let expected = along.map(|c| -s * c * pressure * area);
            let error = distance(&force(&memory, name), &expected) / length(&expected);
            println!("{dim}-d, {solver}, {name}: {error:e}");
            assert!(error < 1e-9, "{error:e}");
        }
        let contact = &memory.reports.last().expect("a step").contact;
        let half = contact.states.len() / 2;
        let open = contact.states.iter().filter(|state| state.pressure == 0.0).count();
        assert_eq!(open, half, "each node touches one of the walls");
        for state in contact.states.iter().filter(|state| state.pressure == 0.0) {
            assert!((state.penetration + 2.0).abs() < 1e-2, "the gap to the other wall: {}", state.penetration);
        }
    }
}

/// A shaft on two rollers: by symmetry both bear the same, together the weight, and turned about the vertical plane
/// they change places.
#[test]
fn a_shaft_on_two_rollers() {
    let roller = |name: &str, x: f64| {
        format!(
            "[[contact]]\non = \"body_outer\"\nname = \"{name}\"\nnormal = {{ law = \"signorini\" }}\n\
             obstacle = {{ shape = \"cylinder\", center = [{x:?}, {:?}], radius = 0.5 }}\n",
            -1.5 * (PI / 4.0).cos()
        )
    };
    let x = 1.5 * (PI / 4.0).sin();
    let area = 12.0 * (PI / 12.0).sin();
    let contacts = roller("left", -x) + &roller("right", x);
    let memory = solve(&problem(&body(2, "radii = [0, 1], n = [4, 24]", &[0.0, -2.0, 0.0], "direct", &contacts)));
    let [left, right] = ["left", "right"].map(|name| force(&memory, name));
    assert!((left[1] + right[1] - 2.0 * area).abs() < 1e-9 && (left[0] + right[0]).abs() < 1e-9);
    assert!((left[1] - right[1]).abs() < 1e-9, "{left:?} {right:?}");
    // The nodes at ±45° touch first and bear W/(2 cos 45°) along the line of the centres.
    assert!((left[0] - left[1]).abs() < 1e-6 * left[1], "{left:?}");
}

/// A block on a leaning plane and on a roller that both move, of one side, with friction, wear, heat and foundations of
/// their own: energy and heat close, each point keeps the distance to its own obstacle, and the order of the entries
/// does not matter.
#[test]
fn two_moving_tools_on_one_side() {
    for dim in [2, 3] {
        let v = |components: [&str; 3]| format!("[{}]", components[..dim].join(", "));
        let tools = [
            format!(
                "[[contact]]\non = \"bottom\"\nname = \"ramp\"\nnormal = {{ law = \"compliance\", stiffness = 500.0 }}\n\
                 obstacle = {{ shape = \"plane\", point = {}, normal = {} }}\n\
                 friction = {{ law = \"coulomb\", coefficient = 0.3 }}\nwear = {{ law = \"archard\", coefficient = 0.02 }}\n\
                 heat = {{ law = \"pressure\", coefficient = 0.1, foundation_temperature = 5 }}\nfrictional_heat = 0.4\n\
                 foundation = {{ heat_capacity = 0.3, exchange = 0.2 }}\n",
                v(["\"0.3*t\"", "0", "0"]),
                v(["0.2", "1", "0"])
            ),
            format!(
                "[[contact]]\non = \"bottom\"\nname = \"roller\"\nnormal = {{ law = \"signorini\" }}\n\
                 obstacle = {{ shape = \"sphere\", center = {}, radius = 1.0, geometry = \"updated\" }}\n\
                 friction = {{ law = \"coulomb\", coefficient = 0.1 }}\nwear = {{ law = \"archard\", coefficient = 0.05 }}\n\
                 heat = {{ law = \"constant\", conductance = 0.5, foundation_temperature = -1 }}\nfrictional_heat = 0.7\n\
                 foundation = {{ heat_capacity = 0.5 }}\n",
                v(["\"0.8 - 0.2*t\"", "\"-1.05 + 0.08*t\"", "\"0.3 + 0.2*t\""])
            ),
        ];
        let mesh = if dim == 2 {
            "kind = \"rectangle\"\nsize = [1.0, 0.8]\nn = [8, 4]"
        } else {
            "kind = \"box\"\nsize = [1.0, 0.8, 0.6]\nn = [5, 3, 3]\nelements = \"Q1\""
        };
        let run = |contacts: String| {
            let text = format!(
                "name = \"tools\"\n[mesh]\n{mesh}\n[time]\nend = 1\nsteps = 12\n[material]\ndensity = 1\nheat_capacity = 1\n\
                 conductivity = 0.5\nexpansion = 0.1\ncoupling = 0.1\n\
                 elasticity = {{ law = \"isotropic\", young = 20, poisson = 0.2{} }}\n\
                 viscosity = {{ law = \"lame\", first = 1, second = 1 }}\n[load]\nbody_force = {}\n{contacts}",
                if dim == 2 { ", stress_state = \"plane-stress\"" } else { "" },
                v(["0.5", "-6", "0.2"]),
            );
            let problem = problem(&text);
            let memory = solve(&problem);
            (problem, memory)
        };
        let (problem, memory) = run(tools.concat());
        let boundary = &March::new(&problem).expect("a system").discretization().boundary.clone();
        let (mut pressed, mut worst) = ([0; 2], [0.0f64; 2]);
        for (states, report) in memory.states.windows(2).zip(&memory.reports) {
            let [old, new] = states else { continue };
            worst[0] = worst[0]
                .max(new.ledger.relative_closing_error().abs())
                .max(new.ledger.relative_heat_closing_error().abs());
            for (i, (point, state)) in boundary.points.iter().zip(&report.contact.states).enumerate() {
                let obstacle = problem.contacts[point.contact].obstacle.as_ref().expect("an obstacle");
                let node = boundary.nodes[point.nodes[0].0] as usize;
                let at =
                    |u: &[f64]| -> Point { std::array::from_fn(|c| if c < dim { u[node * dim + c] } else { 0.0 }) };
                let seen = if obstacle.updated { at(&old.u) } else { [0.0; 3] };
                let nearest = obstacle.nearest(&std::array::from_fn(|c| point.x[c] + seen[c]), new.t);
                let further: Point = std::array::from_fn(|c| at(&new.u)[c] - seen[c]);
                let gap = nearest.distance + dot(&further, &nearest.normal) + new.surface.wear[i];
                worst[1] = worst[1].max((state.penetration + gap).abs());
                pressed[point.contact] += usize::from(state.pressure > 0.0);
            }
        }
        println!("{dim}-d: pressed {pressed:?}, worst {worst:?}");
        assert!(pressed.iter().all(|pressed| *pressed > 5), "{pressed:?}");
        assert!(worst[0] < 1e-12 && worst[1] < 1e-12, "{worst:?}");
        let (_, other) = run(tools[1].clone() + &tools[0]);
        let [one, other] = [&memory, &other].map(|memory| memory.states.last().expect("a state"));
        let difference = one.u.iter().zip(&other.u).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let warmth = one.theta.iter().zip(&other.theta).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(difference < 1e-10 && warmth < 1e-9, "the order of the entries: {difference:e} {warmth:e}");
    }
}

/// What is said of names that are not one contact's, and of points of several contacts.
#[test]
fn names_and_probes() {
    let contacts = |second: &str| {
        let flank = |more: &str, lean: &str| {
            format!(
                "[[contact]]\non = \"bottom\"\n{more}normal = {{ law = \"compliance\", stiffness = 10 }}\n\
                 obstacle = {{ shape = \"plane\", point = [0.5, -0.1], normal = [{lean}, 1] }}\n"
            )
        };
        flank("", "0.2") + &flank(second, "-0.2")
    };
    let base = crate::common::SMALL;
    let (before, after) = base.split_once("[contact]").expect("a contact");
    let rest = after.split_once("[[boundary]]").expect("a boundary").1;
    let text = |second: &str, more: &str| format!("{before}{}[[boundary]]{rest}{more}", contacts(second));
    let told = |second: &str, more: &str| crate::common::told(&Source::new("two.toml", text(second, more)), &[]);
    assert_eq!(told("", ""), "no fault");
    let again = "contact[1].name: found \"bottom\" again, expected a name of its own for each contact; \
                 entry 1 of the file goes by this name";
    assert!(told("name = \"bottom\"\n", "").contains(again), "{}", told("name = \"bottom\"\n", ""));
    let probe = |keys: &str| format!("[[probe]]\nname = \"p\"\nquantity = \"pressure\"\n{keys}");
    let at = probe("at = [0.25, 0]");
    let several = "probe[0].at: found a point of 2 contacts of one side, expected `contact` besides `at`: \
                   one of bottom, left";
    assert!(told("name = \"left\"\n", &at).contains(several), "{}", told("name = \"left\"\n", &at));
    let unknown = probe("contact = \"lefft\"\ntake = \"mean\"");
    let near = "probe[0].contact: found \"lefft\", expected one of the contacts bottom, left; did you mean \"left\"?";
    assert!(told("name = \"left\"\n", &unknown).contains(near), "{}", told("name = \"left\"\n", &unknown));
    let body = probe("contact = \"left\"\ntake = \"mean\"").replace("\"pressure\"", "\"temperature\"");
    assert!(told("name = \"left\"\n", &body).contains("temperature, which is not of the contact"));
    // Over the side both count, of one contact its own; at a node between both the mean of the nodes.
    let all: Vec<String> = [
        "on = \"bottom\"\ntake = \"integral\"",
        "contact = \"bottom\"\ntake = \"integral\"",
        "contact = \"left\"\ntake = \"integral\"",
        "at = [0, 0]\ncontact = \"left\"",
        "contact = \"left\"\ntake = \"max\"",
    ]
    .iter()
    .enumerate()
    .map(|(i, keys)| probe(keys).replace("\"p\"", &format!("\"p{i}\"")).replace("[[probe]]", "\n[[probe]]"))
    .collect();
    let text =
        text("name = \"left\"\n", &all.concat()).replace("displacement = [0, 0]", "displacement = [0, \"-0.3*t\"]");
    let case = case::parse(&Source::new("two.toml", text), &[]).unwrap_or_else(|error| panic!("{error}"));
    let memory = solve(&case.problem);
    let (state, report) = (memory.states.last().expect("a state"), memory.reports.last());
    let scheme = March::new(&case.problem).expect("a system");
    let discretization = scheme.discretization();
    let now = Snapshot { problem: &case.problem, discretization, state, report, work: Work::default(), scheme: None };
    let values = ProbeSet::new(&case.problem, &case.probes).expect("probes").values(&now);
    println!("{values:?}");
    let normal = |name: &str| {
        let f = force(&memory, name);
        (f[0].powi(2) + f[1].powi(2)).sqrt()
    };
    assert!(values[1] > 1e-3 && values[2] > 1e-3 && (values[0] - values[1] - values[2]).abs() < 1e-14);
    assert!((values[1] - normal("bottom")).abs() < 1e-14 && (values[2] - normal("left")).abs() < 1e-14);
    let first = |contact: usize| {
        let at = |i: &usize| discretization.boundary.points[*i].contact == contact;
        let i = (0..discretization.boundary.points.len()).find(at).expect("a point");
        report.map_or(f64::NAN, |report| report.contact.states[i].pressure)
    };
    assert_eq!(values[3].to_bits(), first(1).to_bits());
    assert!(values[4] >= values[3]);
    let columns = history_columns(&case.problem);
    for name in ["contact_force_x@bottom", "contact_force_x@left", "pressure_max@left"] {
        assert!(columns.iter().any(|column| column == name), "{columns:?}");
    }
    let (_, sides) = contact_columns(&now).into_iter().find(|(name, _)| name == "side").expect("a column");
    let ContactValues::Words(sides) = sides else { panic!("words") };
    assert_eq!(sides, ["bottom", "bottom", "bottom", "left", "left", "left"]);
}

/// A side that faces another body and a roller at once: what is pressed on it from above goes through both, and the
/// support below bears it.
#[test]
fn a_pair_and_an_obstacle_on_one_side() {
    let text = |order: [usize; 2]| {
        let contacts = [
            "[[contact]]\non = \"up_bottom\"\nwith = \"low_top\"\nnormal = { law = \"signorini\" }\n\
             friction = { law = \"coulomb\", coefficient = 0.2 }\n",
            "[[contact]]\non = \"low_top\"\nname = \"roller\"\nnormal = { law = \"compliance\", stiffness = 1e4 }\n\
             obstacle = { shape = \"cylinder\", center = [1.5, \"1.501 - 0.01*t\"], radius = 0.5 }\n",
        ];
        format!(
            "name = \"both\"\n[mesh]\nkind = \"blocks\"\nblocks = [{{ name = \"low\", size = [2.0, 1.0], n = [8, 4] }}, \
             {{ name = \"up\", size = [1.0, 0.5], origin = [0.0, 1.0], n = [5, 2] }}]\n[time]\nend = 1\nsteps = 3\n\
             [material]\ndensity = 0\nelasticity = {{ law = \"isotropic\", young = 1e3, poisson = 0.3, stress_state = \"plane-stress\" }}\n\
             [[boundary]]\non = \"low_bottom\"\ndisplacement = [0, 0]\n[[boundary]]\non = \"up_top\"\ndisplacement = [0, \"-0.004*t\"]\n\
             {}{}",
            contacts[order[0]], contacts[order[1]]
        )
    };
    let [one, other] = [[0, 1], [1, 0]].map(|order| {
        let problem = problem(&text(order));
        let memory = solve(&problem);
        let closing = memory.states.iter().map(|state| state.ledger.relative_closing_error().abs()).fold(0.0, f64::max);
        assert!(closing < 1e-12, "{closing:e}");
        let boundary = March::new(&problem).expect("a system").discretization().boundary.clone();
        let states = &memory.reports.last().expect("a step").contact.states;
        // Of the low body: the pair presses at x < 1, the roller about x = 1.5.
        for (point, _) in boundary.points.iter().zip(states).filter(|(_, state)| state.pressure > 1e-9) {
            let is_pair = problem.contacts[point.contact].pair.is_some();
            assert!(if is_pair { point.x[0] < 1.01 } else { (point.x[0] - 1.5).abs() < 0.3 }, "{:?}", point.x);
        }
        memory
    });
    let [pair, roller] = ["up_bottom", "roller"].map(|name| force(&one, name));
    assert!(pair[1] > 0.5 && roller[1] < -0.5, "{pair:?} {roller:?}");
    for name in ["up_bottom", "roller"] {
        assert!(distance(&force(&one, name), &force(&other, name)) < 1e-9, "{name}");
    }
}
