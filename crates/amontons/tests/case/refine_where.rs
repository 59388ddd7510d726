//! `[[mesh.refine_where]]`: where cells become finer, what they keep, and each fault with its place.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::common::{spoil, told};
use amontons::case::{self, Case, Files, Source};
use amontons::mesh::defects::defects;
use amontons::mesh::{Bisection, Block, MarkedCells, Mesh, RefinementRounds};
use amontons::output::Memory;
use amontons::run::{Settings, run};

/// Four cells of a plane file: (0, 1) × (0, 1) of the region soft and (1, 2) × (0, 1) of the region stiff.
const BAR: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n4\n2 1 \"soft\"\n2 2 \"stiff\"\n1 3 \"left\"\n1 4 \"right\"\n$EndPhysicalNames\n\
$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 2 0 0\n4 0 1 0\n5 1 1 0\n6 2 1 0\n$EndNodes\n\
$Elements\n4\n1 3 2 1 1 1 2 5 4\n2 3 2 2 2 2 3 6 5\n3 1 2 3 3 4 1\n4 1 2 4 4 3 6\n$EndElements\n";

/// Pulled by 1 Pa with E = 10 Pa and ν = 0: u = x/10, on any mesh.
const CASE: &str = r#"name = "finer"
[mesh]
kind = "rectangle"
size = [2.0, 1.0]
n = 2
[[mesh.refine_where]]
side = "left"
[time]
end = 1.0
steps = 1
[material]
density = 0.0
heat_capacity = 0.0
conductivity = 1.0
elasticity = { law = "isotropic", young = 10.0, poisson = 0.0, stress_state = "plane-stress" }
viscosity = { law = "lame", first = 0.0, second = 0.0 }
[[boundary]]
on = "left"
displacement = [0, 0]
temperature = 0.0
[[boundary]]
on = "right"
traction = [1, 0]
"#;

const RECTANGLE: &str = "kind = \"rectangle\"\nsize = [2.0, 1.0]\nn = 2";

fn source(text: &str) -> Source {
    let files: BTreeMap<String, Arc<[u8]>> = [("bar.msh".to_owned(), Arc::from(BAR.as_bytes()))].into();
    Source { files: Files::Memory(files), ..Source::new("bar.toml", text) }
}

fn read(text: &str) -> Case {
    case::parse(&source(text), &[]).unwrap_or_else(|error| panic!("{error}"))
}

fn mesh_of(text: &str) -> Arc<Mesh> {
    let mesh = Arc::clone(&read(text).problem.mesh);
    assert!(defects(&mesh).is_empty(), "{text}: {}", defects(&mesh)[0]);
    mesh
}

/// The case in space.
fn in_space(mesh: &str) -> String {
    let text = spoil(CASE, RECTANGLE, mesh);
    let text = spoil(&text, ", stress_state = \"plane-stress\"", "");
    spoil(&spoil(&text, "[0, 0]", "[0, 0, 0]"), "[1, 0]", "[1, 0, 0]")
}

/// A linear field is exact on triangles beside quadrilaterals, and on tetrahedra and pyramids beside hexahedra.
#[test]
fn a_uniform_stress_is_exact_on_a_mesh_that_is_finer_in_places() {
    let plane = ["P1", "P2", "Q1", "Q2"].map(|e| spoil(CASE, RECTANGLE, &format!("{RECTANGLE}\nelements = \"{e}\"")));
    let space = ["P1", "P2", "Q1", "Q2"]
        .map(|e| in_space(&format!("kind = \"box\"\nsize = [2.0, 1.0, 1.0]\nn = [3, 1, 1]\nelements = \"{e}\"")));
    let line = spoil(CASE, RECTANGLE, "kind = \"interval\"\nsize = 2.0\nn = 2");
    let line = spoil(&spoil(&line, "[0, 0]", "[0]"), "[1, 0]", "[1]");
    let line = spoil(&line, ", stress_state = \"plane-stress\"", "");
    let file = spoil(CASE, RECTANGLE, "file = \"bar.msh\"\nrefine = 1");
    for text in plane.iter().chain(&space).chain([&line, &file]) {
        let case = read(&spoil(text, "side = \"left\"", "side = \"left\"\ntimes = 2"));
        let mesh = &case.problem.mesh;
        assert!(defects(mesh).is_empty(), "{text}: {}", defects(mesh)[0]);
        let mut memory = Memory::default();
        run(&case.problem, &Settings::default(), &mut [&mut memory]).unwrap_or_else(|error| panic!("{error}"));
        let state = memory.states.pop().unwrap();
        for (x, u) in mesh.points.iter().zip(state.u.chunks_exact(mesh.dim)) {
            assert!((u[0] - 0.1 * x[0]).abs() < 1e-13, "{text}: {x:?} {u:?}");
            assert!(u[1..].iter().all(|u| u.abs() < 1e-13), "{text}: {x:?} {u:?}");
        }
    }
}

/// Each time halves the facets of a side; those of the side opposite remain.
#[test]
fn a_side_is_refined_as_often_as_asked() {
    for elements in ["P1", "P2", "Q1", "Q2"] {
        for times in 1..4 {
            let text = spoil(CASE, RECTANGLE, &format!("{RECTANGLE}\nelements = \"{elements}\""));
            let mesh = mesh_of(&spoil(&text, "side = \"left\"", &format!("side = \"left\"\ntimes = {times}")));
            assert_eq!(mesh.facets["left"].len(), 2 << times, "{elements} {times}");
            assert_eq!(mesh.facets["right"].len(), 2, "{elements} {times}");
            assert_eq!(mesh.unnamed_boundary_facets(), 0);
        }
    }
}

/// Cells are those in all places of an entry, and entries follow each other.
#[test]
fn places_are_boxes_regions_and_conditions() {
    let with = |places: &str| mesh_of(&spoil(CASE, "side = \"left\"", places));
    // Of the four squares the upper left one, two triangles, with two neighbours that follow.
    let corner = with("box = { from = [-1, 0.6], to = [0.9, 2] }");
    let shortest = |mesh: &Mesh, x: [f64; 2]| {
        let near = mesh.points.iter().map(|p| (p[0] - x[0]).hypot(p[1] - x[1])).filter(|d| *d > 1e-9);
        near.fold(f64::INFINITY, f64::min)
    };
    assert_eq!(
        corner.points.len(),
        mesh_of(&spoil(CASE, "side = \"left\"", "where = \"(x < 0.9)*(y > 0.6)\"")).points.len()
    );
    assert!(
        (shortest(&corner, [0.0, 1.0]) - 0.25).abs() < 1e-12 && (shortest(&corner, [2.0, 0.0]) - 0.5).abs() < 1e-12
    );
    // A box inside a cell refines the cell.
    let inside = with("box = { from = [0.61, 0.2], to = [0.62, 0.21] }\ntimes = 6");
    assert!(
        (shortest(&inside, [0.615, 0.205])) < 2.0_f64.powi(-6) && inside.cell_count() < 200,
        "{}",
        inside.cell_count()
    );
    let both = with("side = \"left\"\nwhere = \"y < 0.25\"");
    assert!((shortest(&both, [0.0, 0.0]) - 0.25).abs() < 1e-12 && (shortest(&both, [0.0, 1.0]) - 0.5).abs() < 1e-12);
    let in_turn = with("side = \"left\"\n[[mesh.refine_where]]\nwhere = \"x < 0.1\"");
    assert!((shortest(&in_turn, [0.0, 0.0]) - 0.125).abs() < 1e-12);
    // The region of a file, of which all cells are refined once; then all of both.
    let file = spoil(CASE, RECTANGLE, "file = \"bar.msh\"\nrefine = 1");
    let mesh = mesh_of(&spoil(&file, "side = \"left\"", "region = \"soft\""));
    let of_region = |region: usize| mesh.blocks.iter().filter(|b| b.region == region).map(Block::len).sum::<usize>();
    assert_eq!([of_region(0), of_region(1)], [8 * 4, 5 * 4], "the common edge is cut, and the cell beside it");
}

/// New nodes of round sides lie on the circle or the cylinder, wherever a block is placed.
#[test]
fn round_sides_stay_round() {
    let radius = |mesh: &Mesh, side: &str, centre: [f64; 3], axis: [f64; 3]| -> Vec<f64> {
        let of = |node: &u32| {
            let x: [f64; 3] = std::array::from_fn(|d| mesh.points[*node as usize][d] - centre[d]);
            let along: f64 = (0..3).map(|d| x[d] * axis[d]).sum();
            (0..3).map(|d| (x[d] - along * axis[d]).powi(2)).sum::<f64>().sqrt()
        };
        mesh.facets[side].node_list().iter().map(of).collect()
    };
    let up = [0.0, 0.0, 1.0];
    for elements in ["P1", "P2", "Q1", "Q2"] {
        let rest = format!("elements = \"{elements}\"");
        let check = |text: &str, sides: [(&str, f64); 2], centre: [f64; 3], axis: [f64; 3], facets: usize| {
            let text = spoil(text, "side = \"left\"", &format!("side = \"{}\"", sides[1].0));
            let text = spoil(&text, "on = \"left\"", &format!("on = \"{}\"", sides[0].0));
            let mesh = mesh_of(&spoil(&text, "on = \"right\"", &format!("on = \"{}\"", sides[1].0)));
            for (side, expected) in sides {
                let found = radius(&mesh, side, centre, axis);
                assert!(found.iter().all(|r| (r - expected).abs() < 1e-12), "{elements} {side}: {found:?}");
            }
            assert_eq!(mesh.facets[sides[1].0].len(), facets, "{elements}");
        };
        let ring = spoil(CASE, RECTANGLE, &format!("kind = \"ring\"\nradii = [1.0, 2.0]\nn = [2, 12]\n{rest}"));
        check(&ring, [("inner", 1.0), ("outer", 2.0)], [0.0; 3], up, 24);
        check(&ring, [("outer", 2.0), ("inner", 1.0)], [0.0; 3], up, 24);
        let disc = spoil(CASE, RECTANGLE, &format!("kind = \"disc\"\nradius = 2.0\nn = [1, 8]\n{rest}"));
        let disc = spoil(&disc, "[[boundary]]\non = \"right\"\ntraction = [1, 0]\n", "");
        let disc = mesh_of(&disc.replace("\"left\"", "\"outer\""));
        let found = radius(&disc, "outer", [0.0; 3], up);
        assert!(found.iter().all(|r| (r - 2.0).abs() < 1e-12), "{elements}: {found:?}");
        assert_eq!(disc.facets["outer"].len(), 16, "{elements}");
        let block = format!(
            "kind = \"blocks\"\n[[mesh.blocks]]\nname = \"shaft\"\nradii = [0.5, 1.0]\nheight = 1.0\nn = [1, 12, 1]\n\
             origin = [1, 2, 3]\nturn = {{ axis = [1, 0, 0], angle = 1.5707963267948966 }}\n{rest}"
        );
        // Two triangles in four each, or a quadrilateral in four that are halved.
        let facets = 12 * 8;
        let sides = [("shaft_inner", 0.5), ("shaft_outer", 1.0)];
        check(&in_space(&block), sides, [1.0, 2.0, 3.0], [0.0, -1.0, 0.0], facets);
    }
}

#[test]
fn faults_are_told_with_their_places() {
    let message = |places: &str| told(&source(&spoil(CASE, "side = \"left\"", places)), &[]);
    for (places, expected) in [
        (
            "side = \"lefft\"",
            "bar.toml:7:8: mesh.refine_where[0].side: found \"lefft\", expected one of the sides bottom, left, right, top; did you mean \"left\"?",
        ),
        (
            "region = \"soft\"",
            "bar.toml:7:10: mesh.refine_where[0].region: found \"soft\", expected one of the regions body",
        ),
        (
            "times = 2",
            "bar.toml:6:1: mesh.refine_where[0]: found no place, expected one of them: `side`, `region`, `box` or `where`; for finer cells everywhere, give more cells with `n`, or `refine` beside a file",
        ),
        (
            "side = \"left\"\ntimes = 0",
            "bar.toml:8:9: mesh.refine_where[0].times: found 0, expected an integer ≥ 1 and ≤ 16 (number of times, each for the cells that are then in the places)",
        ),
        (
            "where = \"x > 3\"",
            "bar.toml:6:1: mesh.refine_where[0]: found no cell there, expected at least one of 8 cells, which have x from 0.0 to 2.0, y from 0.0 to 1.0; a cell counts if it is in all places of the entry",
        ),
        (
            "side = \"left\"\nbox = { from = [1.5, 0], to = [2, 1] }",
            "bar.toml:6:1: mesh.refine_where[0]: found no cell there, expected at least one of 8 cells, which have x from 0.0 to 2.0, y from 0.0 to 1.0; a cell counts if it is in all places of the entry",
        ),
        (
            "where = \"x < t\"",
            "bar.toml:7:9: mesh.refine_where[0].where: found `t` in a condition, expected a condition in x, y: the mesh is the same at all times",
        ),
        (
            "where = \"z < 1\"",
            "bar.toml:7:9: mesh.refine_where[0].where: found `z` in an expression, expected an expression in x, y, t: the body is plane",
        ),
        (
            "box = { from = [1, 0], to = [0, 1] }",
            "bar.toml:7:7: mesh.refine_where[0].box: found from 1.0 to 0.0 along x, expected `from` below `to` along every axis; exchange these coordinates",
        ),
        (
            "sides = [\"left\"]",
            "bar.toml:7:1: mesh.refine_where[0].sides: found an unknown key, expected one of box, region, side, times, where; did you mean `side`?",
        ),
    ] {
        assert_eq!(message(places), expected);
    }
}

/// Sides of a sector that are cut differently do not match: the case is refused.
#[test]
fn a_sector_must_match_itself() {
    let text = spoil(CASE, RECTANGLE, "kind = \"ring\"\nradii = [1.0, 2.0]\nangle = 1.5707963267948966\nn = [2, 4]");
    let text = spoil(&text, "on = \"left\"", "on = \"inner\"");
    let text = spoil(&text, "on = \"right\"", "on = \"outer\"");
    let text = format!("{text}\n[[cyclic]]\nsides = [\"start\", \"end\"]\n");
    let on = |side: &str| spoil(&text, "side = \"left\"", &format!("side = \"{side}\""));
    assert!(told(&source(&on("start")), &[]).contains("cyclic[0].sides"), "{}", told(&source(&on("start")), &[]));
    mesh_of(&on("outer"));
}

/// The case with a file of rounds, on a rectangle of 8 cells.
fn rounds_of(text: &str) -> Source {
    let files: BTreeMap<String, Arc<[u8]>> = [("rounds.txt".to_owned(), Arc::from(text.as_bytes()))].into();
    let case = spoil(CASE, "[[mesh.refine_where]]\nside = \"left\"", "refined_cells = \"rounds.txt\"");
    Source { files: Files::Memory(files), ..Source::new("bar.toml", case) }
}

/// The rounds of a file are those of [`Bisection`], and the case of the results folder has them.
#[test]
fn cells_of_a_file_are_refined_in_rounds() {
    let case = case::parse(&rounds_of("cells 8\n# the first\n0 3\n1\n"), &[]).unwrap_or_else(|error| panic!("{error}"));
    let start = mesh_of(&spoil(CASE, "[[mesh.refine_where]]\nside = \"left\"", ""));
    let mut bisection = Bisection::new(&start);
    for marked in [&[0, 3][..], &[1]] {
        bisection.refine(marked).expect("cells");
    }
    assert_eq!(bisection.mesh().points, case.problem.mesh.points);
    assert_eq!(
        case.rounds.as_ref().map(|rounds| rounds.marked.clone()),
        Some([vec![0, 3], vec![1]].map(MarkedCells::These).to_vec())
    );
    assert!(case.text.contains("refined_cells = \"inputs/rounds.txt\""), "{}", case.text);
    assert_eq!(case.inputs.len(), 1);
}

#[test]
fn faults_of_refined_cells_are_told_with_their_places() {
    let hint = "leave the key out, or take the file of a run with --accuracy of the same mesh";
    for (text, expected) in [
        ("0 3\n", "line 1: found `0 3`, expected `cells N` with the number of cells of the mesh"),
        ("cells 8\n0 x\n", "line 2: found `x`, expected numbers of cells, whole and not negative, or `all`"),
        ("cells 8\n-1\n", "line 2: found `-1`, expected numbers of cells, whole and not negative, or `all`"),
        ("cells 12\n0\n", "the first round: found cells of a mesh of 12, expected those of this one of 8"),
        ("cells 8\n8\n", "round 1: found cell 8 is marked, expected one below 8, the number of cells"),
    ] {
        let told = told(&rounds_of(text), &[]);
        let (place, rest) = expected.split_once(": found ").expect("a place");
        let told_of = format!("bar.toml:6:17: mesh.refined_cells: found rounds.txt: {place}: {rest}; {hint}");
        assert_eq!(told, told_of);
    }
}

/// So many rounds of all cells that no memory has room for them are refused before one is made.
#[test]
fn too_many_halvings_are_refused() {
    for halvings in [25, 70, 1000] {
        let told = told(&rounds_of(&format!("cells 8\n{}", "all\n".repeat(halvings))), &[]);
        assert!(
            told.starts_with("bar.toml:6:17: mesh.refined_cells: found ") && told.contains("take fewer rounds"),
            "{told}"
        );
    }
}

/// A round of all cells divides them into cells of their own kind, and the nodes of round sides stay on them.
#[test]
fn a_round_of_all_cells_halves_every_edge() {
    let start = Mesh::rectangle_of(amontons::mesh::Elements::Q1, [2.0, 1.0], [3, 2], amontons::mesh::Diagonal::Right);
    let start = start.expect("a mesh");
    let rounds = RefinementRounds { cells: 6, marked: vec![MarkedCells::All, MarkedCells::These(vec![0])] };
    assert_eq!(RefinementRounds::parse(&rounds.to_string()), Ok(rounds.clone()));
    let halved =
        RefinementRounds { cells: 6, marked: vec![MarkedCells::All] }.refined(&start, Vec::new()).expect("cells");
    assert_eq!(halved.points, start.refined().expect("a mesh").points);
    assert!(halved.cell_count() == 24 && halved.blocks.iter().all(|block| block.element.nodes.len() == 4));
    let mixed = rounds.refined(&start, Vec::new()).expect("cells");
    assert!(defects(&mixed).is_empty() && mixed.cell_count() > 24, "{:?}", defects(&mixed));
    for (kind, elements) in [("disc", "P1"), ("disc", "Q2"), ("ring", "Q1"), ("ring", "P2")] {
        let shape = if kind == "disc" { "radius = 2.0\nn = [2, 8]" } else { "radii = [1.0, 2.0]\nn = [2, 12]" };
        let text = format!(
            "name = \"r\"\nunits = \"dimensionless\"\n[mesh]\nkind = \"{kind}\"\n{shape}\nelements = \"{elements}\"\n\
             refined_cells = \"rounds.txt\"\n[time]\nend = 1.0\nsteps = 1\nanalysis = \"quasistatic\"\n[material]\n\
             elasticity = {{ law = \"isotropic\", young = 1.0, poisson = 0.3, stress_state = \"plane-strain\" }}\n\
             [[boundary]]\non = \"outer\"\ndisplacement = [0.0, 0.0]\n"
        );
        let plain = text.replace("refined_cells = \"rounds.txt\"\n", "");
        let coarse = case::parse(&Source::new("r.toml", &*plain), &[]).unwrap_or_else(|error| panic!("{error}"));
        let count = coarse.problem.mesh.cell_count();
        let source = Source::new("r.toml", &*text)
            .with_file("rounds.txt", format!("cells {count}\nall\n0 1\nall\n").into_bytes());
        let fine = case::parse(&source, &[]).unwrap_or_else(|error| panic!("{kind} {elements}: {error}"));
        let mesh = &fine.problem.mesh;
        assert!(defects(mesh).is_empty(), "{kind} {elements}: {:?}", defects(mesh));
        assert!(mesh.cell_count() > 16 * count, "{kind} {elements}: {} of {count}", mesh.cell_count());
        for node in mesh.facets["outer"].node_list() {
            let x = mesh.points[node as usize];
            assert!((x[0].hypot(x[1]) - 2.0).abs() < 1e-12, "{kind} {elements}: {x:?}");
        }
    }
}
