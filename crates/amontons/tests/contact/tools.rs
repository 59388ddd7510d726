//! Rigid obstacles from files, and obstacles that turn.
#![allow(clippy::too_many_lines, clippy::float_cmp, reason = "a test is one list of cases, and some numbers are exact")]

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::common::solve;
use crate::facets::{Surface, cuboid, facets, minus};
use crate::stuck_indentation::writer;
use amontons::case::{self, Files, Source};
use amontons::contact::mortar::surface_of;
use amontons::contact::obstacle::{ClosedSurface, FacetedSolid, ObstacleShape, Plane, Turning, Wave};
use amontons::contact::{Obstacle, PointOnBoundary};
use amontons::expression::Expression;
use amontons::field::Field;
use amontons::mesh::{Diagonal, Elements, Mesh};
use amontons::output::Memory;
use amontons::problem::Problem;
use amontons::step::{March, Scheme};
use amontons::tensor::{Point, Rotation, dot, length};

fn cross(a: &Point, b: &Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// A text of STL with all digits.
fn text_of(surface: &[[Point; 3]]) -> Vec<u8> {
    let facet = |corners: &[Point; 3]| {
        let vertices = corners.map(|[x, y, z]| format!("vertex {x:e} {y:e} {z:e}\n")).concat();
        format!("facet normal 0 0 0\nouter loop\n{vertices}endloop\nendfacet\n")
    };
    format!("solid\n{}endsolid\n", surface.iter().map(facet).collect::<String>()).into_bytes()
}

/// A path and a turn: each point of the obstacle moves with the velocity that friction sees there, and keeps its
/// distance from the surface.
#[test]
fn points_of_an_obstacle_move_as_it_says() {
    let of = |text: &str| Field::from(Expression::parse(text).expect("an expression"));
    let place = || ["0.1 + 0.3*t", "0.2*t^2", "-0.4*sin(t)"].map(of);
    let about = || ["1 + 0.5*t", "0.1*cos(t)", "0.2"].map(of);
    let axis = [0.3, -0.5, 0.8];
    let shapes: [Arc<dyn ObstacleShape>; 3] = [
        Arc::new(FacetedSolid::new(Arc::new(facets(&cuboid([1.0, 0.7, 0.4], 2))), place(), false).expect("a box")),
        Arc::new(Plane::new(place(), [0.2, 1.0, -0.4]).expect("a plane")),
        Arc::new(Wave::new(place(), [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], 0.1, 0.5).expect("a wave")),
    ];
    for shape in shapes {
        for about in [None, Some(about())] {
            let turning = Turning::new(of("0.4 + 1.3*t - 0.2*t^2"), axis, about.clone()).expect("a rotation");
            let obstacle = Obstacle { shape: Arc::clone(&shape), updated: false, turning: Some(turning), load: None };
            let at = |field: &Field, t: f64| field.value(&[0.0; 3], t);
            let of_body = |t: f64| -> Point {
                let p: Point = place().each_ref().map(|field| at(field, t));
                let a: Point = about.as_ref().map_or(p, |about| about.each_ref().map(|field| at(field, t)));
                let turn = Rotation::about(&axis, 0.4 + 1.3 * t - 0.2 * t * t);
                let before: Point = std::array::from_fn(|c| [1.3, 0.9, 0.7][c] + p[c] - a[c]);
                let after = turn.vector(&before);
                std::array::from_fn(|c| a[c] + after[c])
            };
            let start = obstacle.nearest(&of_body(0.0), 0.0).distance;
            for t in [0.3, 0.8, 2.0] {
                let x = of_body(t);
                let distance = obstacle.nearest(&x, t).distance;
                assert!((distance - start).abs() < 1e-14, "{shape:?}, t = {t}: {distance} {start}");
                let h = 1e-5;
                let rate = |f: &dyn Fn(f64) -> f64| (f(t + h) - f(t - h)) / (2.0 * h);
                let moves = obstacle.motion(t, &rate).at(&x);
                let (from, to) = (of_body(t - h), of_body(t + h));
                let exact: Point = std::array::from_fn(|c| (to[c] - from[c]) / (2.0 * h));
                assert!(length(&minus(&moves, &exact)) < 1e-9, "{shape:?}, t = {t}: {moves:?} {exact:?}");
            }
        }
    }
}

/// What a case needs besides its contact: a block that is held on top, in the plane or in space.
fn block(dim: usize, young: f64, rest: &str) -> String {
    let (mesh, state) = if dim == 2 {
        ("{ name = \"block\", size = [1.0, 0.5], n = [8, 4] }", ", stress_state = \"plane-stress\"")
    } else {
        ("{ name = \"block\", size = [1.0, 0.5, 0.8], n = [4, 2, 4], elements = \"Q1\" }", "")
    };
    format!(
        r#"name = "block"
[mesh]
kind = "blocks"
blocks = [{mesh}]
[time]
end = 1
steps = 5
[material]
density = 0
elasticity = {{ law = "isotropic", young = {young:e}, poisson = 0.3{state} }}
{rest}"#
    )
}

fn source(text: &str, files: &[(&str, Vec<u8>)]) -> Source {
    let files =
        files.iter().map(|(name, bytes)| ((*name).to_owned(), bytes.clone().into())).collect::<BTreeMap<_, _>>();
    Source { files: Files::Memory(files), ..Source::new("tool.toml", text) }
}

fn problem(text: &str, files: &[(&str, Vec<u8>)]) -> Problem {
    case::parse(&source(text, files), &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).problem
}

fn told(text: &str, files: &[(&str, Vec<u8>)]) -> String {
    crate::common::told(&source(text, files), &[])
}

fn largest_difference(one: &Memory, other: &Memory) -> f64 {
    let [one, other] = [one, other].map(|memory| &memory.states.last().expect("a state").u);
    one.iter().zip(other.iter()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn closing(memory: &Memory) -> f64 {
    memory.states.iter().map(|state| state.ledger.relative_closing_error().abs()).fold(0.0, f64::max)
}

fn msh(mesh: &Mesh) -> Vec<u8> {
    writer::write(mesh, writer::Format { version: 4, binary: None, step: 1, spread: 1 })
}

const HELD: [&str; 2] = [
    "[[boundary]]\non = \"block_top\"\ndisplacement = [0, 0]\n",
    "[[boundary]]\non = \"block_top\"\ndisplacement = [0, 0, 0]\n",
];

/// A punch larger than the side that it is pressed on does what a plane does, from a surface of triangles, a mesh of
/// hexahedra or of quadratic tetrahedra, and in the plane from a mesh of triangles: to round-off.
#[test]
fn a_flat_punch_is_a_plane() {
    for (dim, updated) in [(3, false), (3, true), (2, false)] {
        let laws = format!(
            "geometry = \"{}\" }}\nnormal = {{ law = \"signorini\" }}\nfriction = {{ law = \"coulomb\", coefficient = 0.3 }}\n",
            if updated { "updated" } else { "reference" }
        );
        let contact = |shape: &str| {
            let text = format!("{}[contact]\non = \"block_bottom\"\nobstacle = {{ {shape}, {laws}", HELD[dim - 2]);
            block(dim, 10.0, &text)
        };
        let files: Vec<(&str, Vec<u8>)> = if dim == 3 {
            let size = [3.0, 1.5, 2.5];
            let hexahedra = Mesh::box_(size, [3, 2, 3], Elements::Q1).expect("a box");
            let tetrahedra = Mesh::box_(size, [2, 2, 2], Elements::P2).expect("a box");
            vec![
                ("punch.stl", text_of(&cuboid(size, 3))),
                ("punch.msh", msh(&hexahedra)),
                ("quadratic.msh", msh(&tetrahedra)),
            ]
        } else {
            let plate = Mesh::rectangle([3.0, 1.5], [4, 2], Diagonal::Right).expect("a rectangle");
            vec![("punch.msh", msh(&plate))]
        };
        let (moves, normal) = if dim == 3 {
            ("[\"-1 + 0.2*t\", \"-1.5 + 0.03*t\", -0.7]", "[0, 1, 0]")
        } else {
            ("[\"-1 + 0.2*t\", \"-1.5 + 0.03*t\"]", "[0, 1]")
        };
        let point = moves.replace("-1.5 + ", "");
        let plane = solve(&problem(&contact(&format!("shape = \"plane\", point = {point}, normal = {normal}")), &[]));
        for (name, _) in &files {
            let shape = format!("shape = \"file\", file = \"{name}\", origin = {moves}");
            let memory = solve(&problem(&contact(&shape), &files));
            let difference = largest_difference(&memory, &plane);
            println!("{dim}-d, {name}: {difference:e}");
            assert!(difference < 1e-14, "{name}: {difference:e}");
            let pressed = memory.reports.last().expect("a step").contact.states.iter().filter(|s| s.pressure > 0.0);
            assert!(pressed.count() > 4);
        }
    }
}

/// A body within a surface, in millimetres and turned: the tray that it stands in is a plane below it.
#[test]
fn a_tray_around_the_body() {
    let tray: Surface =
        cuboid([3000.0, 2500.0, 3000.0], 2).iter().map(|facet| facet.map(|[x, y, z]| [y, x, z])).collect();
    let contact = |obstacle: &str| {
        let rest = format!(
            "{}[contact]\non = \"block_bottom\"\nobstacle = {{ {obstacle} }}\nnormal = {{ law = \"signorini\" }}\n",
            HELD[1]
        );
        block(3, 10.0, &rest)
    };
    let files = [("tray.stl", text_of(&tray))];
    // 2.5 m × 3 m × 3 m; turned by −90° about z, (x, y) becomes (y, −x), and the floor is at y = −2.5 m of the file.
    let turned = "scale = 1e-3, turn = { axis = [0, 0, 1], angle = -1.5707963267948966 }";
    let origin = "origin = [-1, \"2.5 + 0.02*t\", -1]";
    let inside = format!("shape = \"file\", file = \"tray.stl\", inside = true, {turned}, {origin}");
    let tray = solve(&problem(&contact(&inside), &files));
    let plane = solve(&problem(&contact("shape = \"plane\", point = [0, \"0.02*t\", 0], normal = [0, 1, 0]"), &[]));
    let difference = largest_difference(&tray, &plane);
    assert!(difference < 1e-14, "{difference:e}");
}

/// A plane that turns about a point of its own under a body as good as rigid: at x it has come up by x sin φ, and a
/// damped layer bears c x sin φ + d x Δ(sin φ)/k there.
#[test]
fn a_plane_that_turns_under_a_body() {
    let (stiffness, damping, omega) = (1e3, 70.0, 0.04);
    let rest = format!(
        "{}[contact]\non = \"block_bottom\"\nobstacle = {{ shape = \"plane\", point = [0, 0], normal = [0, 1], turning = {{ angle = \"{omega}*t\" }} }}\n\
         normal = {{ law = \"damped\", stiffness = {stiffness:?}, damping = {damping:?} }}\n",
        HELD[0]
    );
    let memory = solve(&problem(&block(2, 1e13, &rest), &[]));
    assert!(closing(&memory) < 1e-12);
    for (step, report) in memory.reports.iter().enumerate() {
        let [before, now] = [step, step + 1].map(|n| omega * n as f64 / 5.0);
        let bears = 0.5 * (stiffness * now.sin() + damping * (now.sin() - before.sin()) * 5.0);
        let exact = [-bears * now.sin(), bears * now.cos()];
        for c in 0..2 {
            let error = (report.contact.force[c] - exact[c]).abs();
            assert!(error < 1e-8 * bears, "{step}: {:?} {exact:?}", report.contact.force);
        }
    }
}

fn boundary_of(problem: &Problem) -> Vec<PointOnBoundary> {
    March::new(problem).expect("a system").discretization().boundary.points.clone()
}

/// A roller turns under a block that is pressed on it: Coulomb's limit at every point that touches, in the direction in
/// which the roller moves, and what the roller works, its moment times ω, is what friction takes, in the plane and in
/// space. The surface of the roller is where it was.
#[test]
fn a_roller_that_drags_a_block() {
    let (omega, radius, friction) = (-3.0, 0.6, 0.25);
    for (dim, solver) in [(2, "direct"), (3, "direct"), (3, "iterative")] {
        let axis = if dim == 3 { ", axis = [0, 0, 1]" } else { "" };
        let (center, turning) = if dim == 3 {
            ("[0.45, -0.58, 0.1], axis = [0, 0, 1]", format!("{{ angle = \"{omega}*t\"{axis} }}"))
        } else {
            ("[0.45, -0.58]", format!("{{ angle = \"{omega}*t\" }}"))
        };
        let rest = format!(
            "[solver]\nsolver = \"{solver}\"\n{}[contact]\non = \"block_bottom\"\n\
             obstacle = {{ shape = \"cylinder\", center = {center}, radius = {radius:?}, turning = {turning} }}\n\
             normal = {{ law = \"compliance\", stiffness = 1e4 }}\nfriction = {{ law = \"coulomb\", coefficient = {friction:?} }}\n",
            HELD[dim - 2]
        );
        let problem = problem(&block(dim, 1e3, &rest), &[]);
        assert!(!problem.contacts[0].gap_depends_on_time(), "the surface stays in place");
        let memory = solve(&problem);
        assert!(closing(&memory) < 1e-12, "{:e}", closing(&memory));
        let (boundary, states) = (boundary_of(&problem), &memory.reports.last().expect("a step").contact.states);
        let (mut moment, mut pressed) = (0.0, 0);
        for (point, state) in boundary.iter().zip(states).filter(|(_, state)| state.pressure > 0.0) {
            let centre = [0.45, -0.58, point.x[2]];
            let obstacle = problem.contacts[0].obstacle.as_ref().expect("an obstacle");
            let nearest = obstacle.nearest(&point.x, 1.0);
            let foot: Point = std::array::from_fn(|c| point.x[c] - nearest.distance * nearest.normal[c]);
            let arm = minus(&foot, &centre);
            let surface = cross(&[0.0, 0.0, omega], &arm);
            assert!((length(&surface) - omega.abs() * radius).abs() < 1e-14);
            // The body rests: its slip is −v_F, and q, which acts on the roller, is along it.
            assert!(length(&std::array::from_fn(|c| state.slip[c] + surface[c])) < 1e-6, "{:?}", state.slip);
            assert!((length(&state.q) - friction * state.pressure).abs() < 1e-9 * state.pressure);
            assert!(dot(&state.q, &surface) < 0.0);
            moment -= point.weight * cross(&arm, &state.q)[2];
            pressed += 1;
        }
        assert!(pressed > 1, "{pressed}");
        let [before, now] = [4, 5].map(|n| &memory.states[n].ledger);
        let k = 0.2;
        let power = moment * omega;
        for (what, change) in [
            ("friction", now.friction_dissipation - before.friction_dissipation),
            ("work of the roller", now.load_work - before.load_work),
        ] {
            println!("{dim}-d, {solver}, {what}: {} of {}", change / k, power);
            assert!(power > 0.1 && (change / k - power).abs() < 1e-9 * power, "{what}: {} {power}", change / k);
        }
    }
}

/// A plane that turns about its normal is a turntable: what the velocity of the foundation by its formula does, at a
/// speed of many turns a step.
#[test]
fn a_turntable_is_a_velocity_of_the_foundation() {
    for omega in [0.7, 300.0] {
        let contact = |more: &str, turning: &str| {
            let rest = format!(
                "{}[contact]\non = \"block_bottom\"\n{more}obstacle = {{ shape = \"plane\", point = [0.4, \"0.02*t\", 0.3], normal = [0, 1, 0]{turning} }}\n\
                 normal = {{ law = \"compliance\", stiffness = 1e4 }}\nfriction = {{ law = \"coulomb\", coefficient = 0.4 }}\n",
                HELD[1]
            );
            solve(&problem(&block(3, 1e3, &rest), &[]))
        };
        let velocity = format!("foundation_velocity = [\"{omega}*(z - 0.3)\", 0, \"-{omega}*(x - 0.4)\"]\n");
        let [table, formula] = [
            contact("", &format!(", turning = {{ angle = \"{omega}*t\", axis = [0, 2, 0] }}")),
            contact(&velocity, ""),
        ];
        let size = table.states.last().expect("a state").u.iter().fold(0.0f64, |m, u| m.max(u.abs()));
        let difference = largest_difference(&table, &formula);
        println!("ω = {omega}: {difference:e} of {size:e}");
        assert!(size > 1e-4 && difference < 1e-12 * size, "{difference:e}");
        let [a, b] =
            [&table, &formula].map(|memory| memory.states.last().expect("a state").ledger.friction_dissipation);
        assert!(a > 0.0 && (a - b).abs() < 1e-10 * a, "{a} {b}");
    }
}

/// A tool from a file that comes down, turns and is heated by friction: everything turned at random is the same turned,
/// with either solver, and the energy closes.
#[test]
fn a_tool_that_turns_is_the_same_whatever_the_axes() {
    let whole = Rotation::about(&[0.4, 1.0, -0.6], 1.3);
    let files = [("tool.stl", text_of(&cuboid([0.6, 0.3, 0.5], 2)))];
    let run = |rotation: Option<&Rotation>, solver: &str| {
        let vector = |v: Point| rotation.map_or(v, |rotation| rotation.vector(&v));
        let list = |v: Point| format!("{v:?}");
        let (from, by) = (vector([0.2, -0.31, 0.15]), vector([0.1, 0.06, -0.05]));
        let origin: Vec<String> = (0..3).map(|c| format!("\"{:?} + {:?}*t\"", from[c], by[c])).collect();
        let (body, tool) = if rotation.is_some() {
            (", turn = { axis = [0.4, 1.0, -0.6], angle = 1.3 }", ", turn = { axis = [0.4, 1.0, -0.6], angle = 1.3 }")
        } else {
            ("", "")
        };
        let rest = format!(
            "viscosity = {{ law = \"lame\", first = 1, second = 1 }}\nheat_capacity = 1\nconductivity = 0.1\n[solver]\nsolver = \"{solver}\"\n\
             {}temperature = 0\n[contact]\non = \"block_bottom\"\n\
             obstacle = {{ shape = \"file\", file = \"tool.stl\"{tool}, origin = [{}], geometry = \"updated\", turning = {{ angle = \"0.2*t + 0.1*t^2\", axis = {}, about = {} }} }}\n\
             normal = {{ law = \"compliance\", stiffness = 2e3 }}\nfriction = {{ law = \"coulomb\", coefficient = 0.3 }}\nfrictional_heat = 0.5\n",
            HELD[1],
            origin.join(", "),
            list(vector([0.1, 1.0, 0.2])),
            list(vector([0.5, 0.0, 0.4]))
        );
        let text = block(3, 10.0, &rest).replace("elements = \"Q1\"", &format!("elements = \"Q1\"{body}"));
        solve(&problem(&text, &files))
    };
    for solver in ["direct", "iterative"] {
        let [straight, turned] = [run(None, solver), run(Some(&whole), solver)];
        let [a, b] = [&straight, &turned].map(|memory| memory.states.last().expect("a state"));
        let node = |u: &[f64], i: usize| -> Point { std::array::from_fn(|c| u[3 * i + c]) };
        let nodes = a.theta.len();
        let error = |i: usize| length(&minus(&whole.vector(&node(&a.u, i)), &node(&b.u, i)));
        let worst = (0..nodes).map(error).fold(0.0, f64::max);
        let warmth = a.theta.iter().zip(b.theta.iter()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let size = a.u.iter().fold(0.0f64, |m, u| m.max(u.abs()));
        let hottest = a.theta.iter().fold(0.0f64, |m, u| m.max(u.abs()));
        println!("{solver}: {worst:e} of {size:e}, {warmth:e} of {hottest:e}, closing {:e}", closing(&turned));
        assert!(size > 1e-3 && worst < 1e-9 * size && hottest > 1e-4 && warmth < 1e-8 * hottest);
        assert!(closing(&straight) < 1e-12 && closing(&turned) < 1e-12);
    }
}

/// What is said of surfaces that bound no solid, of files that are none, and of rotations that have no meaning.
#[test]
fn what_is_said_of_spoiled_files() {
    let contact = |dim: usize, obstacle: &str| {
        let rest = format!(
            "{}[contact]\non = \"block_bottom\"\nobstacle = {{ {obstacle} }}\nnormal = {{ law = \"signorini\" }}\n",
            HELD[dim - 2]
        );
        block(dim, 10.0, &rest)
    };
    let whole = cuboid([1.0; 3], 1);
    let open: Surface = whole.iter().skip(1).copied().collect();
    let mut twisted = whole.clone();
    twisted[4].swap(0, 1);
    let mut flat = whole.clone();
    flat.push([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [1.0, 0.0, 0.0]]);
    let mut crowded = whole.clone();
    crowded.push([[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [2.0, 0.5, 0.0]]);
    let sheet: Surface = vec![whole[0], {
        let [a, b, c] = whole[0];
        [a, c, b]
    }];
    let stl = |surface: &Surface| vec![("a.stl", text_of(surface))];
    let key = "contact.obstacle.file: found a.stl: ";
    for (surface, expected) in [
        (&open, "3 edges of one facet alone, the first from "),
        (&twisted, "3 edges where the normals of two facets disagree, the first from "),
        (&flat, "1 facet without area, the first number 12 (from 0) at "),
        (&crowded, "2 edges of one facet alone, the first from "),
        (&sheet, "a surface that encloses nothing, expected the boundary of a solid; check the file"),
    ] {
        let said = told(&contact(3, "shape = \"file\", file = \"a.stl\""), &stl(surface));
        assert!(said.contains(&format!("{key}{expected}")), "{said}");
        assert_eq!(said.lines().count(), 1, "{said}");
    }
    let solid = "shape = \"file\", file = \"a.stl\"";
    let cases = [
        (
            3,
            solid,
            vec![("a.stl", b"solid\nfacet\n".to_vec())],
            "a.stl: line 2: the end of the file after 0 triangles, expected `endsolid`; the file may be truncated",
        ),
        (3, solid, vec![], "found \"a.stl\", which is not there, expected a file beside the case file"),
        (2, solid, stl(&whole), "found \"a.stl\", a surface in space, expected a mesh file of a plane solid"),
        (
            3,
            "shape = \"file\", file = \"plate.msh\"",
            vec![("plate.msh", msh(&Mesh::rectangle([1.0; 2], [1; 2], Diagonal::Right).expect("a mesh")))],
            "found \"plate.msh\", a solid in 2 dimensions, expected one in 3, as the body is",
        ),
        (3, "shape = \"file\"", vec![], "contact.obstacle.file: found no such key"),
        (
            3,
            "shape = \"file\", file = \"a.stl\", scale = 0",
            stl(&whole),
            "contact.obstacle.scale: found 0, expected a number > 0",
        ),
        (
            3,
            "shape = \"file\", file = \"a.stl\", origin = [\"x\", 0, 0]",
            stl(&whole),
            "contact.obstacle.origin[0]: found an expression in space, expected a number or an expression in t",
        ),
        (
            3,
            "shape = \"file\", file = \"a.stl\", origin = [0]",
            stl(&whole),
            "contact.obstacle.origin: found 1 components, expected 3 components",
        ),
        (
            3,
            "shape = \"sphere\", center = [0, 0, 0], radius = 1, turning = { angle = \"t\", axis = [0, 0, 0] }",
            vec![],
            "contact.obstacle.turning.axis: found zero, expected a direction",
        ),
        (
            3,
            "shape = \"sphere\", center = [0, 0, 0], radius = 1, turning = { angle = \"t\" }",
            vec![],
            "contact.obstacle.turning.axis: found 0 components, expected 3 components",
        ),
        (
            2,
            "shape = \"plane\", point = [0, 0], normal = [0, 1], turning = { angle = \"t*x\" }",
            vec![],
            "contact.obstacle.turning.angle: found an expression in space, expected a number or an expression in t",
        ),
        (
            2,
            "shape = \"plane\", point = [0, 0], normal = [0, 1], turning = { angle = \"t\", axis = [0, 0, 1] }",
            vec![],
            "contact.obstacle.turning.axis: found an axis, expected none: in the plane it is z",
        ),
        (
            2,
            "shape = \"surface\", level = \"y\", turning = { angle = \"t\" }",
            vec![],
            "contact.obstacle.turning.about: found no such key, expected an array of 2 (a point of the axis): a level has no place",
        ),
    ];
    for (dim, obstacle, files, expected) in cases {
        let said = told(&contact(dim, obstacle), &files);
        assert!(said.contains(expected) && said.lines().count() == 1, "{said}\nexpected {expected}");
    }
    let axisymmetric = block(2, 10.0, "[contact]\non = \"block_bottom\"\nobstacle = { shape = \"plane\", point = [0, 0], normal = [0, 1], turning = { angle = \"t\" } }\nnormal = { law = \"signorini\" }\n")
        .replace(", stress_state = \"plane-stress\"", "")
        .replace("kind = \"blocks\"", "kind = \"blocks\"\naxisymmetric = true");
    let said = told(&axisymmetric, &[]);
    let expected = "contact.obstacle.turning: found a rotation beside a body of revolution, expected an obstacle that does not turn";
    assert!(said.contains(expected), "{said}");
}

/// Millimetres that are taken for metres are told.
#[test]
fn an_obstacle_in_millimetres() {
    let contact = |scale: &str| {
        let rest = format!(
            "{}[contact]\non = \"block_bottom\"\nobstacle = {{ shape = \"file\", file = \"a.stl\", origin = [-1000, -900, -900]{scale} }}\nnormal = {{ law = \"signorini\" }}\n",
            HELD[1]
        );
        let files = [("a.stl", text_of(&cuboid([2000.0, 800.0, 1800.0], 1)))];
        let problem = problem(&block(3, 10.0, &rest), &files);
        amontons::hypotheses::findings(&problem).iter().map(|finding| finding.message.clone()).collect::<Vec<_>>()
    };
    let told = contact("");
    assert!(told.iter().any(|finding| finding.contains("times larger than the body")), "{told:?}");
    assert!(contact(", scale = 1e-3").iter().all(|finding| !finding.contains("times")));
}

/// The boundary of a mesh is the surface that a file of it has.
#[test]
fn the_boundary_of_a_mesh_is_closed() {
    for elements in [Elements::P1, Elements::P2, Elements::Q1, Elements::Q2] {
        let mesh = Mesh::box_([1.0, 0.7, 0.4], [2, 3, 2], elements).expect("a box");
        let facets = ClosedSurface::new(&surface_of(&mesh)).unwrap_or_else(|fault| panic!("{fault:?}"));
        let found = facets.nearest(&[0.5, 1.0, 0.2]);
        assert!((found.distance - 0.3).abs() < 1e-15 && found.normal == [0.0, 1.0, 0.0], "{elements:?}: {found:?}");
        let disc = Mesh::disc(1.0, [2, 16], elements).expect("a disc");
        let facets = ClosedSurface::new(&surface_of(&disc)).unwrap_or_else(|fault| panic!("{fault:?}"));
        assert!((facets.nearest(&[2.0, 0.0, 0.0]).distance - 1.0).abs() < 1e-14);
        assert!(facets.nearest(&[0.1, 0.2, 0.0]).distance < -0.7);
    }
}

/// A roller without friction changes nothing, and that is told; a plane that tilts does something.
#[test]
fn a_roller_without_friction() {
    let said = |obstacle: &str, more: &str| {
        let rest = format!(
            "{}[contact]\non = \"block_bottom\"\nobstacle = {{ {obstacle} }}\nnormal = {{ law = \"compliance\", stiffness = 10 }}\n{more}",
            HELD[0]
        );
        let findings = amontons::hypotheses::findings(&problem(&block(2, 10.0, &rest), &[]));
        let found = findings.iter().filter(|finding| finding.place == "contact.obstacle.turning" && finding.warns());
        found.count()
    };
    let roller = "shape = \"cylinder\", center = [0.5, -1], radius = 1, turning = { angle = \"2*t\" }";
    let plane = "shape = \"plane\", point = [0, 0], normal = [0, 1], turning = { angle = { times = [0, 1], values = [\"0 deg\", \"3 deg\"] } }";
    assert_eq!(said(roller, ""), 1);
    assert_eq!(said(roller, "friction = { law = \"coulomb\", coefficient = 0.1 }\n"), 0);
    assert_eq!(said(roller, "wear = { law = \"archard\", coefficient = 0.1 }\n"), 0);
    assert_eq!(said(plane, ""), 0);
}
