//! `[contact.automatic]`: pairs of bodies that are near each other.

use std::collections::BTreeMap;

use crate::common::{self, Random, largest, spoil, told};
use amontons::case::{self, Source};
use amontons::contact::mortar::facing;
use amontons::mesh::{FacetSet, Mesh};
use amontons::problem::Problem;
use amontons::tensor::Point;

/// Three blocks on each other, the upper one at a distance of 1e-3.
const STACK: &str = r#"name = "stack"
[mesh]
kind = "blocks"
blocks = [
    { name = "low", size = [1.0, 0.5], n = [6, 3] },
    { name = "middle", size = [0.4, 0.3], n = [5, 4], origin = [0.25, 0.5] },
    { name = "high", size = [1.0, 0.2], n = [7, 2], origin = [0.0, 0.801] },
]
[time]
end = 1.0
steps = 2
[material]
density = 0
elasticity = { law = "isotropic", young = 100, poisson = 0.3, stress_state = "plane-strain" }
[[boundary]]
on = "low_bottom"
displacement = [0, 0]
[[boundary]]
on = "high_top"
displacement = ["1e-3*t", "-5e-3*t"]
[contact]
normal = { law = "signorini" }
friction = { law = "coulomb", coefficient = 0.3 }
automatic = { distance = 2e-3 }
"#;

/// The same with its sides by name.
fn named() -> String {
    let (head, _) = STACK.split_at(STACK.find("[contact]").expect("contact"));
    let pair = |on: &str, with: &str| {
        format!(
            "[[contact]]\non = \"{on}\"\nwith = \"{with}\"\nnormal = {{ law = \"signorini\" }}\n\
             friction = {{ law = \"coulomb\", coefficient = 0.3 }}\n"
        )
    };
    head.to_owned() + &pair("low_top", "middle_bottom") + &pair("middle_top", "high_bottom")
}

fn problem(text: &str) -> Problem {
    case::parse(&Source::new("near", text), &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).problem
}

/// Number of facets of each side of the contacts.
fn sides(problem: &Problem) -> BTreeMap<String, usize> {
    let of = |side: &str| (side.to_owned(), problem.mesh.facets.get(side).map_or(0, FacetSet::len));
    problem.contacts.iter().flat_map(|contact| contact.sides().map(of).collect::<Vec<_>>()).collect()
}

fn counts<const N: usize>(all: [(&str, usize); N]) -> BTreeMap<String, usize> {
    all.map(|(side, count)| (side.to_owned(), count)).into()
}

/// The facets that face each other are found: x from 0.25 to 0.65 is part of 4 of 6 cells below and of 4 of 7 above.
#[test]
fn what_is_near_is_a_pair() {
    let found = problem(STACK);
    let expected = counts([("low-middle", 3), ("middle-low", 5), ("middle-high", 5), ("high-middle", 4)]);
    assert_eq!(sides(&found), expected);
    let [found, named] = [found, problem(&named())].map(|problem| common::solve(&problem));
    let [found, named] = [&found, &named].map(|run| run.states.last().expect("a state"));
    let apart: Vec<f64> = found.u.iter().zip(&named.u).map(|(a, b)| a - b).collect();
    assert!(largest(&apart) <= 1e-12 * largest(&named.u), "{:e}", largest(&apart));
}

/// Nearer than the distance counts, what is behind or beside a face does not.
#[test]
fn only_facets_within_the_distance_that_face_each_other_count() {
    let near = |distance: &str| sides(&problem(&spoil(STACK, "distance = 2e-3", &format!("distance = {distance}"))));
    assert_eq!(near("\"0.5 mm\""), counts([("low-middle", 3), ("middle-low", 5)]));
    // Below the thickness of 0.2 a larger distance finds no more: the faces beside each other are perpendicular.
    assert_eq!(near("0.19"), near("2e-3"));
    // The lower and the upper block face each other beside the one between them, which hides one cell of the lower one
    // and two of the upper one.
    let far = near("0.31");
    assert_eq!((far["low-high"], far["high-low"]), (5, 5));
}

/// Of curved bodies those facets that are near: a round body over a plane, in the plane and in space.
#[test]
fn curved_bodies_are_near_where_they_nearly_touch() {
    let path = common::file("crates/amontons/benchmarks/pair-roller.toml");
    let text = std::fs::read_to_string(path).expect("the benchmark");
    let (head, rest) = text.split_at(text.find("[contact]").expect("contact"));
    let (_, verify) = rest.split_at(rest.find("[verify]").expect("checks"));
    // x²/2R ≤ 1 up to x = 10.
    let automatic =
        format!("{head}[contact]\nnormal = {{ law = \"signorini\" }}\nautomatic = {{ distance = 1.0 }}\n{verify}");
    let source = Source {
        files: case::Files::Folder(common::file("crates/amontons/benchmarks")),
        ..Source::new("near", automatic)
    };
    let problem = case::parse(&source, &[]).unwrap_or_else(|error| panic!("{error}")).problem;
    let set = &problem.mesh.facets["roller-block"];
    let reach = set.node_list().iter().map(|&node| problem.mesh.points[node as usize][0]).fold(0.0, f64::max);
    assert!((9.0..11.5).contains(&reach), "facets up to x = {reach}");
}

/// Bodies of one region have numbers for names, and sides that are named in another contact are left out.
#[test]
fn bodies_have_names_and_named_sides_are_taken() {
    let floor = "[[contact]]\non = \"low_top\"\nwith = \"middle_bottom\"\nnormal = { law = \"bilateral\" }\n\
                 friction = { law = \"stick\" }\n[[contact]]\n";
    let both = spoil(STACK, "[contact]\n", floor);
    let problem = problem(&both);
    assert_eq!(problem.contacts.len(), 2);
    assert_eq!(sides(&problem)["high-middle"], 4);
    assert_eq!(problem.contacts[1].on, "middle-high");
}

/// The same facets are found on bodies that are turned, larger and numbered in another way, in the plane and in
/// space.
#[test]
fn what_is_near_does_not_depend_on_place_size_or_numbers() {
    let space = STACK
        .replace(", n = [", ", elements = \"Q1\", n = [")
        .replace("[1.0, 0.5], elements = \"Q1\", n = [6, 3]", "[1.0, 0.5, 0.7], n = [6, 3, 4]")
        .replace("[0.4, 0.3], elements = \"Q1\", n = [5, 4]", "[0.4, 0.3, 0.5], elements = \"Q1\", n = [5, 4, 3]")
        .replace("[1.0, 0.2], elements = \"Q1\", n = [7, 2]", "[1.0, 0.2, 0.6], elements = \"Q1\", n = [7, 2, 3]")
        .replace("origin = [0.25, 0.5]", "origin = [0.25, 0.5, 0.1]")
        .replace("origin = [0.0, 0.801]", "origin = [0.0, 0.801, 0.0]")
        .replace(", stress_state = \"plane-strain\"", "")
        .replace("displacement = [0, 0]", "displacement = [0, 0, 0]")
        .replace("[\"1e-3*t\", \"-5e-3*t\"]", "[\"1e-3*t\", \"-5e-3*t\", 0]");
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    for text in [STACK, &space] {
        let problem = problem(text);
        let lengths = |mesh: &Mesh, distance: f64| -> Vec<[usize; 2]> {
            facing(mesh, distance, &|_, _| true).iter().map(|pair| pair.sides.each_ref().map(FacetSet::len)).collect()
        };
        let mut here = lengths(&problem.mesh, 2e-3);
        assert!(here.len() == 2 && here.iter().flatten().all(|&n| n > 2), "{here:?}");
        for pair in &mut here {
            pair.sort_unstable();
        }
        here.sort_unstable();
        for _ in 0..6 {
            let (angle, size) = (3.0 * random.number(), 10f64.powf(4.0 * random.number()));
            let (s, c) = angle.sin_cos();
            let mut mesh = (*problem.mesh).clone();
            // Turned about z and, in space, about x; shifted and scaled.
            let turn = |[x, y, z]: Point| -> Point { [c * x - s * y, s * x + c * y, z] };
            let tilt = |[x, y, z]: Point| -> Point {
                if mesh.dim == 3 { [x, c * y - s * z, s * y + c * z] } else { [x, y, z] }
            };
            let points: Vec<Point> = mesh.points.iter().map(|p| tilt(turn(*p)).map(|x| size * (x + 0.7))).collect();
            // The last node is the first one.
            let n = points.len() as u32;
            mesh.points = points.into_iter().rev().collect();
            for block in &mut mesh.blocks {
                block.nodes.iter_mut().for_each(|node| *node = n - 1 - *node);
            }
            let mut there = lengths(&mesh, 2e-3 * size);
            for pair in &mut there {
                pair.sort_unstable();
            }
            there.sort_unstable();
            assert_eq!(there, here, "turned by {angle}, {size:e} times as large");
        }
    }
}

#[test]
fn faults_of_automatic_pairs() {
    // Bodies that no contact holds are told of as well.
    let say = |text: String| {
        let all = told(&Source::new("near.toml", text), &[]);
        all.lines().find(|line| line.contains("contact.")).unwrap_or(&all).to_owned()
    };
    assert_eq!(
        say(spoil(STACK, "distance = 2e-3", "distance = 0")),
        "near.toml:24:26: contact.automatic.distance: found 0, expected a number > 0 (largest distance between facets that face each other at rest, in m; less than the thickness of the bodies)"
    );
    let apart = spoil(STACK, "origin = [0.25, 0.5]", "origin = [0.25, 0.51]");
    assert_eq!(
        say(spoil(&apart, "origin = [0.0, 0.801]", "origin = [0.0, 0.83]")),
        "near.toml:24:26: contact.automatic.distance: found no two bodies within 2e-3 m of each other, expected bodies that face each other; take a larger distance, or name the sides by `on` and `with`"
    );
    assert_eq!(
        say(spoil(STACK, "[contact]\n", "[contact]\non = \"low_top\"\n")),
        "near.toml:22:6: contact.on: found `on` besides `automatic`, expected sides that are named, or found; remove one of them: `automatic` finds the sides"
    );
    assert_eq!(
        say(spoil(STACK, "automatic = { distance = 2e-3 }\n", "")),
        "near.toml:21:1: contact.on: found no such key, expected a string (name of the side that is Γ_C), or `automatic`"
    );
    assert_eq!(
        say(spoil(
            STACK,
            "[contact]\n",
            "[contact]\nobstacle = { shape = \"plane\", point = [0, 0], normal = [0, 1] }\n"
        )),
        "near.toml:22:12: contact.obstacle: found `obstacle` besides `with`, expected a rigid foundation, or the other side of a pair, not both; remove one of them"
    );
    let twice = spoil(
        STACK,
        "[contact]\n",
        "[[contact]]\nnormal = { law = \"signorini\" }\nautomatic = { distance = 1e-3 }\n[[contact]]\n",
    );
    assert_eq!(
        say(twice),
        "near.toml:27:13: contact[1].automatic: found `automatic` again, expected one [[contact]] entry with `automatic`; give these bodies a contact by `on` and `with`: all that are near are in the first entry"
    );
}
