//! Sides that a case names by their place, and bodies from several files.

use std::f64::consts::PI;

use crate::common::{Random, told};
use amontons::case::{self, Files, Source};
use amontons::mesh::Mesh;
use amontons::model::MeshModel;

const REST: &str = "[time]\nend = 1\nsteps = 1\n[material]\nheat_capacity = 1\nconductivity = 1\n";
const BOX: &str = "kind = \"box\"\nsize = [2, 3, 4]\nn = [2, 3, 4]\nelements = \"Q1\"\n";

/// A case of heat of a mesh with sides.
fn text(mesh: &str, sides: &str) -> String {
    format!("name = \"places\"\n{REST}\n[mesh]\n{mesh}\n{sides}")
}

fn mesh(mesh: &str, sides: &str) -> Mesh {
    let source = Source::new("places.toml", text(mesh, sides));
    let read = case::parse(&source, &[]).unwrap_or_else(|error| panic!("{error}"));
    (*read.problem.mesh).clone()
}

fn area(mesh: &Mesh, side: &str) -> f64 {
    MeshModel::new(mesh).sides.iter().find(|size| size.name == side).expect("a side").measure
}

/// The area of the one side `on` of a mesh.
fn of(shape: &str, on: &str) -> f64 {
    area(&mesh(shape, &format!("[[side]]\nname = \"it\"\n{on}")), "it")
}

fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-12 * expected.max(1.0), "{found} for {expected}");
}

#[test]
fn planes_and_boxes_have_the_areas_of_the_faces() {
    close(of(BOX, "on = { plane = { point = [0, 0, 4], normal = [0, 0, -7] } }"), 6.0);
    close(of(BOX, "on = { plane = { point = [2, 9, 9], normal = [1, 0, 0] } }"), 12.0);
    // Half of the top, and the two quarters of the sides that the box cuts off.
    close(of(BOX, "on = { box = { from = [-1, -1, 4], to = [1, 9, 9] } }"), 3.0);
    close(of(BOX, "on = { box = { from = [0, 0, 3], to = [2, 3, 4] } }"), 6.0 + 2.0 * 2.0 + 2.0 * 3.0);
    // Both ends of one table each: a union, in which nothing counts twice.
    let ends =
        "on = [{ plane = { point = [0, 0, 0], normal = [0, 0, 1] } }, { box = { from = [0, 0, 0], to = [1, 3, 4] } }]";
    close(of(BOX, ends), 6.0 + 12.0 + 2.0 * 4.0 + 3.0);
    // A facet of which one vertex is outside does not count.
    close(of(BOX, "on = { near = { point = [0, 0, 0], distance = 1.42 } }"), 3.0);
    close(of(BOX, "on = { normal = { direction = [0, 1, 0] } }"), 8.0);
    close(of(BOX, "on = { normal = { direction = [1, 1, 0], angle = \"45 deg\" } }"), 12.0 + 8.0);
}

#[test]
fn sides_are_parts_and_unions_of_others() {
    close(of(BOX, "of = [\"left\", \"top\", \"left\"]"), 12.0 + 8.0);
    close(of(BOX, "of = [\"left\"]\non = { box = { from = [0, 0, 0], to = [0, 1, 4] } }"), 4.0);
    let chain = "[[side]]\nname = \"a\"\nof = [\"left\", \"right\"]\n[[side]]\nname = \"b\"\nof = [\"a\"]\non = { box = { from = [0, 0, 0], to = [2, 2, 1] } }";
    close(area(&mesh(BOX, chain), "b"), 2.0 * 2.0);
}

#[test]
fn regions_tell_bodies_apart_that_touch() {
    let pair = "kind = \"blocks\"\nblocks = [{ name = \"low\", size = [2, 1], n = [4, 2] }, { name = \"high\", size = [1, 1], origin = [0.5, 1], n = [3, 2] }]\n";
    let plane = "on = { plane = { point = [0, 1], normal = [0, 1] } }";
    close(of(pair, plane), 3.0);
    close(of(pair, &format!("{plane}\nregion = \"low\"")), 2.0);
    close(of(pair, &format!("{plane}\nregion = \"high\"")), 1.0);
    close(of(pair, "on = { plane = { point = [0, 1], normal = [0, 1] }, normal = { direction = [0, -1] } }"), 1.0);
}

#[test]
fn curved_surfaces_are_found_by_their_radius() {
    // The sides of a polygon of 48 chords, and of one of 24 beside each other in one body of quadratic cells.
    for (elements, chord) in [("Q1", 1.0), ("P2", 1.0)] {
        let ring = format!("kind = \"ring\"\nradii = [1, 2]\nn = [2, 48]\nelements = \"{elements}\"\n");
        let whole = mesh(&ring, "[[side]]\nname = \"it\"\non = { cylinder = { radius = 2 } }");
        close(area(&whole, "it"), area(&whole, "outer") * chord);
        assert!((area(&whole, "it") / (4.0 * PI) - 1.0).abs() < 1e-3);
    }
    let tube = "kind = \"cylinder\"\nradii = [1, 2]\nheight = 3\nn = [2, 48, 3]\nelements = \"Q1\"\n";
    let both = mesh(tube, "[[side]]\nname = \"it\"\non = { cylinder = { axis = [0, 0, -2], radius = 1 } }");
    close(area(&both, "it"), area(&both, "inner"));
    let part = "[[side]]\nname = \"it\"\non = { cylinder = { axis = [0, 0, 1], radius = 2 }, box = { from = [-9, -9, 1], to = [9, 9, 2] } }";
    let part = mesh(tube, part);
    close(area(&part, "it"), area(&part, "outer") / 3.0);
    // All vertices of a box lie on the ball about its middle: 1 + 4 + 4 = 9, and so all its facets do.
    let cube = "kind = \"box\"\nsize = [2, 4, 4]\nn = [1, 1, 1]\nelements = \"Q1\"\n";
    close(of(cube, "on = { sphere = { center = [1, 2, 2], radius = 3 } }"), 2.0 * (16.0 + 8.0 + 8.0));
}

#[test]
fn ends_of_a_line_are_points() {
    let line = "kind = \"interval\"\nsize = 2\nn = 4\n";
    for place in ["plane = { point = [2], normal = [1] }", "near = { point = [1.9], distance = 0.2 }"] {
        let made = mesh(line, &format!("[[side]]\nname = \"it\"\non = {{ {place} }}"));
        assert_eq!(made.facets["it"].node_list(), made.facets["right"].node_list());
    }
}

/// What is found does not depend on the place, the direction and the size of the body.
#[test]
fn places_are_found_wherever_the_body_lies() {
    let mut random = Random(7);
    for _ in 0..40 {
        let mut three = || [random.number(), random.number(), random.number()];
        let (axis, at) = (three(), three().map(|x| 10.0 * x));
        let (angle, size) = (3.0 * random.number(), 10f64.powf(3.0 * random.number()));
        let turn = amontons::tensor::Rotation::about(&axis, angle);
        let sizes = [2.0 * size, 3.0 * size, 4.0 * size];
        let block = format!(
            "kind = \"blocks\"\nblocks = [{{ name = \"it\", size = {sizes:?}, n = [2, 3, 4], elements = \"Q1\", turn = {{ axis = {axis:?}, angle = {angle:?} }}, origin = {at:?} }}]\n"
        );
        let moved = |x: [f64; 3]| -> [f64; 3] {
            let turned = turn.vector(&x.map(|c| c * size));
            std::array::from_fn(|c| turned[c] + at[c])
        };
        for (point, normal, side) in
            [([2.0, 1.0, 1.0], [1.0, 0.0, 0.0], "it_right"), ([1.0, 1.0, 0.0], [0.0, 0.0, 1.0], "it_back")]
        {
            let (point, normal) = (moved(point), turn.vector(&normal));
            let made = mesh(
                &block,
                &format!("[[side]]\nname = \"a\"\non = {{ plane = {{ point = {point:?}, normal = {normal:?} }} }}"),
            );
            assert_eq!(made.facets["a"].node_list(), made.facets[side].node_list(), "{axis:?} {angle} {at:?} {size}");
        }
    }
}

const FIRST: &str = "*NODE\n1, 0, 0\n2, 10, 0\n3, 10, 5\n4, 0, 5\n5, 20, 0\n6, 20, 5\n*ELEMENT, TYPE=CPE4, ELSET=SOFT\n1, 1, 2, 3, 4\n*ELEMENT, TYPE=CPE4, ELSET=HARD\n2, 2, 5, 6, 3\n*SOLID SECTION, ELSET=SOFT\n*SOLID SECTION, ELSET=HARD\n*SURFACE, NAME=TOP\n1, S3\n2, S3\n";
const SECOND: &str =
    "*NODE\n1, 0, 0\n2, 1, 0\n3, 0, 1\n*ELEMENT, TYPE=CPE3, ELSET=TIP\n1, 1, 2, 3\n*SURFACE, NAME=BASE\n1, S1\n";

fn files(names: &[(&str, &str)]) -> Files {
    Files::Memory(names.iter().map(|(name, text)| ((*name).to_owned(), text.as_bytes().into())).collect())
}

#[test]
fn bodies_of_several_files_meet() {
    let blocks = "kind = \"blocks\"\nblocks = [\n  { name = \"base\", file = \"a.inp\", scale = 0.1 },\n  { name = \"tip\", file = \"b.inp\", turn = { angle = \"180 deg\" }, origin = [1, 1.5] },\n  { name = \"pad\", size = [1, 1], n = [2, 2], origin = [-1, -1] },\n]\n";
    let sides = "[[side]]\nname = \"left of the base\"\nof = [\"base_TOP\"]\nregion = \"base_SOFT\"\n";
    let source = Source {
        files: files(&[("a.inp", FIRST), ("b.inp", SECOND)]),
        ..Source::new("places.toml", text(blocks, sides))
    };
    let read = case::parse(&source, &[]).unwrap_or_else(|error| panic!("{error}"));
    let made = &read.problem.mesh;
    assert_eq!(made.regions, ["base_SOFT", "base_HARD", "tip", "pad"]);
    close(area(made, "base_TOP"), 2.0);
    close(area(made, "left of the base"), 1.0);
    close(area(made, "tip_BASE"), 1.0);
    close(area(made, "pad_top"), 1.0);
    let low =
        made.facets["tip_BASE"].node_list().iter().map(|&n| made.points[n as usize][1]).fold(f64::INFINITY, f64::min);
    close(low, 1.5);
    // The copies that results keep are enough to read the case again.
    let names: Vec<&str> = read.inputs.iter().map(|input| input.path.as_str()).collect();
    assert_eq!(names, ["inputs/a.inp", "inputs/b.inp"]);
}

/// A side that is named by its place is cut in parts with the mesh.
#[test]
fn sides_of_a_file_are_refined_with_it() {
    for refine in [0, 2] {
        let shape = format!("file = \"a.inp\"\nscale = 0.1\nrefine = {refine}\n");
        let side = "[[side]]\nname = \"it\"\non = { box = { from = [1, 0], to = [2, 0.5] } }\n";
        let source = Source { files: files(&[("a.inp", FIRST)]), ..Source::new("x.toml", text(&shape, side)) };
        let read = case::parse(&source, &[]).unwrap_or_else(|error| panic!("{error}"));
        // Bottom, right end and top of the second cell.
        close(area(&read.problem.mesh, "it"), 1.0 + 0.5 + 1.0);
        assert_eq!(read.problem.mesh.facets["it"].len(), 3 << refine);
    }
}

/// The messages about sides and blocks.
fn message(shape: &str, sides: &str) -> String {
    told(&Source { files: files(&[("a.inp", FIRST)]), ..Source::new("x.toml", text(shape, sides)) }, &[])
}

#[test]
fn faults_of_sides_are_told() {
    let side = |rest: &str| message(BOX, &format!("[[side]]\nname = \"it\"\n{rest}"));
    for (rest, expected) in [
        (
            "on = { plane = { point = [0, 0, 4.1], normal = [0, 0, 1] } }",
            "found no facet there, expected at least one of 52 facets, which have x from 0.0 to 2.0, y from 0.0 to 3.0, z from 0.0 to 4.0",
        ),
        (
            "on = { plane = { point = [0, 0, 4], normal = [0, 0, 1] }, normal = { direction = [0, 0, -1] } }",
            "found no facet in all of these places: 6 facets of `plane`, 6 facets of `normal`",
        ),
        (
            "on = { plane = { point = [0, 4], normal = [0, 0, 1] } }",
            "side[0].on.plane.point: found 2 components, expected 3 components",
        ),
        (
            "on = { plane = { point = [0, 0, 4], normal = [0, 0, 0] } }",
            "side[0].on.plane.normal: found a vector without a direction, expected one that is not zero",
        ),
        (
            "on = { box = { from = [0, 2, 0], to = [1, 1, 1] } }",
            "side[0].on.box: found from 2.0 to 1.0 along y, expected `from` below `to` along every axis; exchange these coordinates",
        ),
        ("on = {}", "side[0].on: found no place, expected `plane`, `box`, `cylinder`, `sphere`, `near` or `normal`"),
        (
            "on = { cylinder = { axis = [0, 0, 1], radius = 0 } }",
            "side[0].on.cylinder.radius: found 0, expected a number > 0",
        ),
        (
            "on = { cylinder = { axis = [0, 0, 0], radius = 1 } }",
            "side[0].on.cylinder.axis: found a vector without a direction, expected one that is not zero",
        ),
        ("on = { normal = { direction = [0, 0, 1], angle = \"200 deg\" } }", "side[0].on.normal.angle: found"),
        (
            "of = [\"lefft\"]",
            "side[0].of[0]: found \"lefft\", expected one of the sides back, bottom, front, left, right, top; did you mean \"left\"?",
        ),
        ("region = \"steel\"", "side[0].region: found \"steel\", expected one of the regions body"),
        (
            "",
            "side[0]: found neither `on` nor `of` nor `region`, expected one of them: `on`, places such as { plane = … }, `of`, names of sides, or the name of a `region`",
        ),
        ("on = { plan = { point = [0, 0, 4], normal = [0, 0, 1] } }", "side[0].on.plan: found an unknown key"),
    ] {
        let told = side(rest);
        assert!(told.contains(expected) && told.lines().count() == 1, "{rest}\n{told}");
    }
    for (name, expected) in [
        ("left", "side[0].name: found \"left\", which is a side already, expected a name that nothing else has"),
        ("body", "side[0].name: found \"body\", which is a region of the mesh, expected a name that nothing else has"),
        ("", "side[0].name: found \"\", which is no name, expected a name that nothing else has"),
    ] {
        let told = message(BOX, &format!("[[side]]\nname = \"{name}\"\nof = [\"right\"]"));
        assert!(told.contains(expected) && told.lines().count() == 1, "{told}");
    }
    let condition = "[[side]]\nname = \"it\"\non = { near = { point = [9, 9, 9], distance = 1 } }\n[[boundary]]\non = \"it\"\ntemperature = 0\n";
    assert_eq!(message(BOX, condition).lines().count(), 1, "one message of one cause");
}

/// What stands in the place of one side overlaps the other one, which is no second cause.
#[test]
fn a_side_that_is_not_found_is_one_fault() {
    let pair = "kind = \"blocks\"\nblocks = [{ name = \"low\", size = [2, 1], n = [4, 2] }, { name = \"high\", size = [1, 1], origin = [0.5, 1], n = [3, 2] }]\n";
    let plane = |y: f64| format!("region = \"low\"\non = {{ plane = {{ point = [0, {y}], normal = [0, 1] }} }}\n");
    let sides = format!(
        "[[side]]\nname = \"seat\"\n{}[[side]]\nname = \"face\"\nregion = \"high\"\n[contact]\non = \"seat\"\nwith = \"face\"\n\
         normal = {{ law = \"bilateral\" }}\nheat = {{ law = \"constant\", conductance = 1 }}\n",
        plane(1.1)
    );
    let moves =
        "density = 0\nelasticity = { law = \"isotropic\", young = 1, poisson = 0, stress_state = \"plane-strain\" }\n";
    let whole = text(pair, &sides).replace("conductivity = 1\n", &format!("conductivity = 1\n{moves}"));
    let told = told(&Source::new("x.toml", whole), &[]);
    assert!(told.contains("side[0].on: found no facet there") && told.lines().count() == 1, "{told}");
}

#[test]
fn faults_of_files_in_blocks_are_told() {
    let block = |rest: &str| message(&format!("kind = \"blocks\"\nblocks = [{{ name = \"a\", {rest} }}]\n"), "");
    for (rest, expected) in [
        ("file = \"b.inp\"", "mesh.blocks[0].file: found \"b.inp\", which is not there"),
        (
            "file = \"a.inp\", n = [2, 2]",
            "mesh.blocks[0].n: found `n`, expected it only without a `file`; remove it: the file has the body",
        ),
        ("file = \"a.inp\", origin = [1, 2, 3]", "mesh.blocks[0].origin: found 3 numbers, expected 2 of them"),
        (
            "file = \"a.inp\", turn = { axis = [0, 0, 1], angle = 1 }",
            "mesh.blocks[0].turn.axis: found an axis, expected none: in the plane it is z",
        ),
        (
            "size = [1, 1], n = [1, 1], scale = 2",
            "mesh.blocks[0].scale: found `scale`, expected it only besides a `file`; remove it, or give a `file`",
        ),
        ("size = [1, 1]", "mesh.blocks[0].n: found no such key, expected an array of integers ≥ 1 (cells per side)"),
        ("n = [1, 1]", "mesh.blocks[0]: found neither `size` nor `radii` nor `file`"),
        (
            "size = [1], n = [1], turn = { angle = 1 }",
            "mesh.blocks[0].turn: found a rotation of a line, expected none; remove it",
        ),
    ] {
        let told = block(rest);
        assert!(told.contains(expected) && told.lines().count() == 1, "{rest}\n{told}");
    }
    let two = "kind = \"blocks\"\nblocks = [{ name = \"a\", size = [1, 1, 1], n = [1, 1, 1] }, { name = \"b\", file = \"a.inp\" }]\n";
    assert!(
        message(two, "").contains("mesh.blocks[1].file: found \"a.inp\", a body in 2 dimensions, expected one in 3")
    );
}
