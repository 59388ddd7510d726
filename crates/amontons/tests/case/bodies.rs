//! Bodies of a case file: meshes of every kind and from files, materials by region and by law; and each fault with its
//! place.
#![allow(clippy::too_many_lines, clippy::too_many_arguments, reason = "a test is one list of cases")]
#![allow(clippy::float_cmp, reason = "some values are exact")]

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::common::{Random, largest, spoil, told};
use amontons::case::{self, Case, CaseError, Files, Source};
use amontons::material::Dilatation;
use amontons::mesh::FacetSet;
use amontons::output::Memory;
use amontons::run::{Settings, run};
use amontons::state::State;
use amontons::tensor::Sym;

/// A bar of two squares, (0, 1) × (0, 1) of the region soft and (1, 2) × (0, 1) of the region stiff.
const BAR: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n4\n2 1 \"soft\"\n2 2 \"stiff\"\n1 3 \"left\"\n1 4 \"right\"\n$EndPhysicalNames\n\
$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 2 0 0\n4 0 1 0\n5 1 1 0\n6 2 1 0\n$EndNodes\n\
$Elements\n4\n1 3 2 1 1 1 2 5 4\n2 3 2 2 2 2 3 6 5\n3 1 2 3 3 4 1\n4 1 2 4 4 3 6\n$EndElements\n";

const CASE: &str = r#"name = "body"
[mesh]
kind = "rectangle"
size = [2.0, 1.0]
n = 2
[time]
end = 1.0
steps = 2
[material]
density = 0.0
heat_capacity = 0.0
expansion = 0.0
coupling = 0.0
conductivity = 1.0
elasticity = { law = "isotropic", young = 10.0, poisson = 0.0, stress_state = "plane-stress" }
viscosity = { law = "lame", first = 0.0, second = 0.0 }
[[boundary]]
on = "left"
displacement = []
temperature = 0.0
"#;

/// The case on another mesh, with displacements of so many components.
fn body(mesh: &str, components: usize) -> String {
    let displacement = format!("displacement = {:?}", vec![0; components]);
    let text = spoil(CASE, "kind = \"rectangle\"\nsize = [2.0, 1.0]\nn = 2", mesh);
    let is_plane = components == 2 && !["axisymmetric", "box"].iter().any(|word| mesh.contains(word));
    let text = if is_plane { text } else { spoil(&text, ", stress_state = \"plane-stress\"", "") };
    spoil(&text, "displacement = []", &displacement)
}

fn source(text: String) -> Source {
    let files: BTreeMap<String, Arc<[u8]>> = [
        ("bar.msh", BAR.to_owned()),
        ("cut.msh", BAR.split("$Elements").next().unwrap().to_owned()),
        ("turned.msh", BAR.replace("5 1 1 0\n", "5 1 -1 0\n")),
        ("axis.msh", BAR.replace("\n1 0 0 0\n", "\n1 -6e-20 0 0\n").replace("4 0 1 0\n", "4 3e-17 1 0\n")),
        ("beyond.msh", BAR.replace("\n1 0 0 0\n", "\n1 -1e-9 0 0\n")),
        ("bar.stl", String::new()),
        // Two squares that do not touch.
        (
            "parts.msh",
            BAR.replace("$Nodes\n6\n", "$Nodes\n8\n7 5 0 0\n8 5 1 0\n")
                .replace("2 3 2 2 2 2 3 6 5", "2 3 2 2 2 3 7 8 6"),
        ),
    ]
    .map(|(name, text)| (name.to_owned(), Arc::from(text.as_bytes())))
    .into();
    Source { files: Files::Memory(files), ..Source::new("body.toml", text) }
}

fn parse(text: String, overrides: &[&str]) -> Result<Case, CaseError> {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    case::parse(&source(text), &overrides)
}

fn read(text: String) -> Case {
    parse(text, &[]).unwrap_or_else(|error| panic!("{error}"))
}

fn message(text: String, overrides: &[&str]) -> String {
    told(&source(text), overrides)
}

/// The last state of a run whose audit closes.
fn solved(case: &Case) -> State {
    let mut memory = Memory::default();
    run(&case.problem, &Settings::default(), &mut [&mut memory]).unwrap_or_else(|error| panic!("{error}"));
    let state = memory.states.pop().unwrap();
    assert!(state.ledger.relative_closing_error().abs() < 1e-12, "{:?}", state.ledger);
    assert!(
        state.ledger.heat_closing_error.abs() <= 1e-12 * state.ledger.heat_turned_over.max(largest(&state.theta)),
        "{:?}",
        state.ledger
    );
    state
}

#[track_caller]
fn assert_near(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    let error = found.iter().zip(expected).fold(0.0, |e: f64, (f, x)| e.max((f - x).abs()));
    assert!(error <= tolerance * largest(expected), "{found:?}, expected {expected:?}");
}

/// Every kind of mesh: dimension, nodes, the sides, and the cells that a study refines.
#[test]
fn meshes_of_every_kind() {
    let quarter = "radii = [1.0, 2.0]\nangle = 1.5707963267948966";
    for (mesh, on, dim, nodes, sides, cells) in [
        ("kind = \"interval\"\nsize = 3.0\nn = 4", "left", 1, 5, "left right", vec![4]),
        ("kind = \"interval\"\nsize = 3.0\nn = 4\nelements = \"P2\"", "left", 1, 9, "left right", vec![4]),
        (
            "kind = \"rectangle\"\nsize = [2, 1]\nn = [4, 2]\nelements = \"Q2\"",
            "left",
            2,
            45,
            "bottom left right top",
            vec![4, 2],
        ),
        (
            "kind = \"rectangle\"\nsize = [2, 1]\nn = 2\nelements = \"P2\"\ndiagonal = \"crossed\"",
            "left",
            2,
            41,
            "bottom left right top",
            vec![2, 2],
        ),
        (
            "kind = \"box\"\nsize = [3, 2, 1]\nn = [3, 2, 1]",
            "back",
            3,
            24,
            "back bottom front left right top",
            vec![3, 2, 1],
        ),
        (
            "kind = \"box\"\nsize = [3, 2, 1]\nn = 2\nelements = \"Q2\"",
            "back",
            3,
            125,
            "back bottom front left right top",
            vec![2, 2, 2],
        ),
        ("kind = \"disc\"\nradius = 2\nn = [1, 8]", "outer", 2, 9 + 8, "outer", vec![1, 8]),
        (
            &format!("kind = \"ring\"\n{quarter}\nn = [2, 3]\nelements = \"Q1\""),
            "start",
            2,
            12,
            "end inner outer start",
            vec![2, 3],
        ),
        (
            "kind = \"cylinder\"\nradii = [1, 2]\nheight = 3\nn = [1, 6, 2]\nelements = \"Q1\"",
            "outer",
            3,
            36,
            "bottom inner outer top",
            vec![1, 6, 2],
        ),
        ("file = \"bar.msh\"", "left", 2, 6, "left right", vec![1]),
        ("kind = \"file\"\nfile = \"bar.msh\"\nscale = 1e-3", "left", 2, 6, "left right", vec![1]),
    ] {
        let case = read(body(mesh, dim).replace("on = \"left\"", &format!("on = \"{on}\"")));
        let found = &case.problem.mesh;
        let names: Vec<&str> = found.facets.keys().map(String::as_str).collect();
        assert_eq!(
            (found.dim, found.points.len(), names.join(" ").as_str(), &case.cells),
            (dim, nodes, sides, &cells),
            "{mesh}"
        );
        assert_eq!(found.points.iter().map(|p| p[0]).fold(0.0, f64::max) < 0.01, mesh.contains("scale"), "{mesh}");
    }
}

/// Blocks in a row: each has its sides, about its own origin, and a disc in the half-plane of revolution is a torus.
#[test]
fn round_blocks_lie_at_their_origins() {
    let blocks = "kind = \"blocks\"\n[[mesh.blocks]]\nname = \"tyre\"\nradii = [0, 0.5]\norigin = [3, -1]\nn = [2, 12]\n\
                  [[mesh.blocks]]\nname = \"shoe\"\nradii = [0.5, 0.75]\nangle = 1.5707963267948966\norigin = [3, -1]\nn = [1, 6]\nelements = \"Q1\"";
    for (round, names) in [
        (blocks.to_owned(), "shoe_end shoe_inner shoe_outer shoe_start tyre_outer"),
        (blocks.replace("blocks\"\n", "blocks\"\naxisymmetric = true\n"), "shoe_end shoe_inner shoe_outer shoe_start tyre_outer"),
        (
            "kind = \"blocks\"\n[[mesh.blocks]]\nname = \"tyre\"\nradii = [0.25, 0.5]\nheight = 2\norigin = [3, -1, 4]\nn = [2, 12, 2]".to_owned(),
            "tyre_bottom tyre_inner tyre_outer tyre_top",
        ),
    ] {
        let dim = if round.contains("height") { 3 } else { 2 };
        let held = "[[boundary]]\non = \"shoe_outer\"\ndisplacement = [0, 0]\ntemperature = 0\n";
        let held = if round.contains("shoe") { held } else { "" };
        let case = read(body(&round, dim).replace("on = \"left\"", "on = \"tyre_outer\"") + held);
        let mesh = &case.problem.mesh;
        assert_eq!(mesh.facets.keys().map(String::as_str).collect::<Vec<_>>().join(" "), names, "{round}");
        for (side, radius) in [("tyre_outer", 0.5), ("tyre_inner", 0.25), ("shoe_inner", 0.5), ("shoe_outer", 0.75)] {
            for node in mesh.facets.get(side).map(FacetSet::node_list).unwrap_or_default() {
                let [x, y, z] = mesh.points[node as usize];
                assert!(((x - 3.0).hypot(y + 1.0) - radius).abs() < 1e-15, "{round}: {side} at ({x}, {y})");
                assert!(dim == 2 && z == 0.0 || dim == 3 && (4.0..=6.0).contains(&z), "{round}: {side} at z = {z}");
            }
        }
        assert_eq!(mesh.axisymmetric, round.contains("axisymmetric"), "{round}");
    }
}

/// Half rings that `turn` puts onto the axis, and nodes of a file that are there but for round-off, before and after
/// they are turned: all are on the axis. A node that is farther away is refused.
#[test]
fn nodes_within_round_off_of_the_axis_are_on_it() {
    let mut random = Random(0x5eed_0123_4567_89ab);
    let mut blocks: Vec<(String, usize)> = (0..20)
        .map(|_| {
            let size = 10f64.powf(3.0 * random.number());
            let ring = format!(
                "kind = \"blocks\"\naxisymmetric = true\n[[mesh.blocks]]\nname = \"a\"\nradii = [{:?}, {size:?}]\n\
                 angle = {:?}\norigin = [0, {:?}]\nn = [2, 4]\nelements = \"Q1\"\nturn = {{ angle = {:?} }}",
                0.4 * size,
                std::f64::consts::PI,
                size * random.number(),
                -std::f64::consts::FRAC_PI_2
            );
            (ring, 6)
        })
        .collect();
    let file = "file = \"axis.msh\"\naxisymmetric = true";
    blocks.push((file.to_owned(), 2));
    let turn = "turn = { angle = 6.283185307179586 }";
    blocks.push((
        format!("kind = \"blocks\"\naxisymmetric = true\n[[mesh.blocks]]\nname = \"a\"\nfile = \"axis.msh\"\n{turn}"),
        2,
    ));
    for (mesh, on_axis) in blocks {
        let on = if mesh.contains("radii") {
            "a_outer"
        } else if mesh.contains("name") {
            "a_right"
        } else {
            "right"
        };
        let case = read(body(&mesh, 2).replace("on = \"left\"", &format!("on = \"{on}\"")));
        let points = &case.problem.mesh.points;
        assert!(points.iter().all(|x| x[0] >= 0.0), "{mesh}");
        assert_eq!(points.iter().filter(|x| x[0] == 0.0).count(), on_axis, "{mesh}");
    }
    let beyond = told(&source(body("file = \"beyond.msh\"\naxisymmetric = true", 2)), &[]);
    assert!(beyond.contains("has r = -1.000000e-9, expected none below 0"), "{beyond}");
}

#[test]
fn a_body_of_revolution_has_a_hoop_strain() {
    let case = read(body("kind = \"rectangle\"\nsize = [1, 2]\norigin = [3, -1]\nn = 2\naxisymmetric = true", 2));
    let mesh = &case.problem.mesh;
    assert!(mesh.axisymmetric && mesh.points[0] == [3.0, -1.0, 0.0] && mesh.points[8] == [4.0, 1.0, 0.0]);
    // Uniaxial strain around: Eν/((1+ν)(1−2ν)) tr + E/(1+ν) with ν = 0.
    let hoop = Sym::from_fn(3, |i, j| if (i, j) == (2, 2) { 0.1 } else { 0.0 });
    assert!((case.problem.materials[0].elasticity.value(&[0.0; 3], &hoop).get(2, 2) - 1.0).abs() < 1e-15);
}

/// Two materials in a row, pulled by 5 and heated: strains 5/E, and a flux that is the same in both.
#[test]
fn regions_have_their_materials() {
    let stiff = "[[region]]\non = \"stiff\"\n[region.material]\ndensity = 7.0\nheat_capacity = 3.0\nexpansion = 0.0\ncoupling = 0.0\nconductivity = 3.0\n\
                 elasticity = { law = \"isotropic\", young = 40.0, poisson = 0.0, stress_state = \"plane-stress\" }\nviscosity = { law = \"lame\", first = 0.0, second = 0.0 }\n";
    let pulled =
        format!("{}[[boundary]]\non = \"right\"\ntraction = [5, 0]\ntemperature = 8\n", body("file = \"bar.msh\"", 2));
    let steady = format!(
        "{pulled}{}",
        stiff.replace("density = 7.0\nheat_capacity = 3.0", "density = 0.0\nheat_capacity = 0.0")
    );
    let state = solved(&read(steady));
    let along = |values: [f64; 3]| [values, values].concat();
    assert_near(&state.u.chunks_exact(2).map(|u| u[0]).collect::<Vec<_>>(), &along([0.0, 0.5, 0.625]), 1e-12);
    assert_near(&state.theta, &along([0.0, 6.0, 8.0]), 1e-12);
    // Of the 7 + 2 of mass in motion with 0.5 the kinetic energy is 9/8; the heat content at θ = 2 is 2 (3 + 1).
    let moving =
        ["material.density=2", "material.heat_capacity=1", "initial.velocity=[0.5, 0]", "initial.temperature=2"];
    let case = parse(format!("{pulled}{stiff}"), &moving).unwrap_or_else(|error| panic!("{error}"));
    let mut memory = Memory::default().states_every(1);
    run(&case.problem, &Settings::default(), &mut [&mut memory]).unwrap();
    let start = &memory.states[0].ledger;
    assert_near(&[start.kinetic, start.heat_content], &[0.125 * 9.0, 8.0], 1e-14);
    // Each region has its own choice of the strain.
    let nearly = stiff.replace("density = 7.0", "density = 7.0\ndilatation = \"mean\"");
    let case = parse(format!("{pulled}{nearly}"), &moving).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(case.problem.mesh.regions, ["soft", "stiff"]);
    assert_eq!(case.problem.dilatation(), [Dilatation::Full, Dilatation::Mean]);
    // The mesh is an input of the case.
    assert_eq!(case.inputs.iter().map(|input| input.path.as_str()).collect::<Vec<_>>(), ["inputs/bar.msh"]);
    assert!(case.text.contains("file = \"inputs/bar.msh\""));
}

/// The laws of the case are those of the library with these numbers: values in simple cases in closed form.
#[test]
fn laws_have_their_numbers() {
    let value = |mesh: &str, components: usize, law: &str, strain: &Sym| {
        let text = body(mesh, components)
            .replace("{ law = \"isotropic\", young = 10.0, poisson = 0.0 }", law)
            .replace("{ law = \"isotropic\", young = 10.0, poisson = 0.0, stress_state = \"plane-stress\" }", law);
        read(text).problem.materials[0].elasticity.value(&[0.0; 3], strain)
    };
    let square = "kind = \"rectangle\"\nsize = [2.0, 1.0]\nn = 2";
    let cube = "kind = \"box\"\nsize = [1, 1, 1]\nn = 1";
    let along = |axis: usize| Sym::from_fn(3, |i, j| if i == j && i == axis { 1.0 } else { 0.0 });
    // Plane stress of an orthotropic sheet: Q₁₁ = E₁/(1 − ν₁₂ν₂₁), and Q₂₂ along x where its axes are turned by a right
    // angle.
    let law = "{ law = \"orthotropic\", young = [8, 2, 2], poisson = [0.3, 0.3, 0.3], shear = [1, 1, 1], stress_state = \"plane-stress\" }";
    let q = 1.0 - 0.3 * 0.3 * 2.0 / 8.0;
    assert!((value(square, 2, law, &along(0)).get(0, 0) - 8.0 / q).abs() < 1e-13);
    let turned = law.replace(" }", ", orientation = 1.5707963267948966 }");
    assert!((value(square, 2, &turned, &along(0)).get(0, 0) - 2.0 / q).abs() < 1e-13);
    // The stiffness C₃₃ of a matrix along z.
    let rows: Vec<String> = (0..6)
        .map(|i| format!("{:?}", (0..6).map(|j| if i == j { f64::from(i + 1) } else { 0.0 }).collect::<Vec<_>>()))
        .collect();
    let law = format!("{{ law = \"anisotropic\", voigt = [{}] }}", rows.join(", "));
    assert!((value(cube, 3, &law, &along(2)).get(2, 2) - 3.0).abs() < 1e-14);
    // Simple shear ε₁₂ = 1, ‖ξ^D‖ = √2: 2μ + β (1 − κ/√2) times 1, μ = 4; and Hencky's with n = 1, which is linear.
    let shear = Sym::from_fn(3, |i, j| if i + j == 1 { 1.0 } else { 0.0 });
    let law = "{ law = \"von-mises-projection\", young = 10.0, poisson = 0.25, excess = 3.0, radius = 0.5 }";
    assert!((value(cube, 3, law, &shear).get(0, 1) - (8.0 + 3.0 * (1.0 - 0.5 / 2f64.sqrt()))).abs() < 1e-14);
    let law = "{ law = \"hencky\", bulk = 1.0, shear = 4.0, shear_infinite = 1.0, strain = 0.1, exponent = 1.0 }";
    assert!((value(cube, 3, law, &shear).get(0, 1) - 8.0).abs() < 1e-14);
}

#[test]
fn viscosities_branches_and_the_mean_dilatation() {
    let text = |viscosity: &str| {
        body("kind = \"rectangle\"\nsize = [2.0, 1.0]\nn = 2\nelements = \"Q1\"", 2)
            .replace("{ law = \"lame\", first = 0.0, second = 0.0 }", viscosity)
    };
    let shear = Sym::from_fn(2, |i, j| if i == j { 0.0 } else { 1.0 });
    for (law, factor) in [
        // 2η at the rate √2: η = 1 + 2 (1 + 9·2)^(−1/4) and η = 0.5 + 3 (0.01 + 2)^(−1/4).
        (
            "{ law = \"carreau\", bulk = 1, zero = 3, infinite = 1, time = 3, exponent = 0.5 }",
            2.0 + 4.0 * 19f64.powf(-0.25),
        ),
        (
            "{ law = \"power-law\", bulk = 1, consistency = 3, exponent = 0.5, threshold = 0.1, floor = 0.5 }",
            1.0 + 6.0 * 2.01f64.powf(-0.25),
        ),
    ] {
        let found = read(text(law)).problem.materials[0].viscosity.value(&[0.0; 3], &shear).get(0, 1);
        assert!((found - factor).abs() < 1e-13, "{law}: {found}");
    }
    let lame = text("{ law = \"lame\", first = 0.0, second = 0.0 }");
    let case = parse(
        lame,
        &["material.prony=[{ ratio = 0.5, time = 2.0 }, { ratio = 1, time = 20 }]", "material.dilatation=mean"],
    )
    .unwrap();
    assert_eq!(case.problem.dilatation(), [Dilatation::Mean]);
    let prony = case.problem.materials[0].prony.clone().unwrap();
    assert_eq!(prony.branches().iter().map(|b| b.time).collect::<Vec<_>>(), [2.0, 20.0]);
    assert!((prony.branches()[0].modulus.apply(&shear).get(0, 1) - 5.0).abs() < 1e-14);
}

/// A bar in every dimension, pulled by T = 5 with ν = 0: u = Tx/E.
#[test]
fn a_bar_is_pulled_in_one_two_and_three_dimensions() {
    for (mesh, components) in [
        ("kind = \"interval\"\nsize = 2\nn = 3\nelements = \"P2\"", 1),
        ("kind = \"rectangle\"\nsize = [2, 1]\nn = 3\nelements = \"Q2\"", 2),
        ("kind = \"box\"\nsize = [2, 1, 1]\nn = 2\nelements = \"P2\"", 3),
        ("kind = \"box\"\nsize = [2, 1, 1]\nn = 2\nelements = \"Q1\"", 3),
    ] {
        let traction = [5, 0, 0];
        let case = read(format!(
            "{}[[boundary]]\non = \"right\"\ntraction = {:?}\n",
            body(mesh, components),
            &traction[..components]
        ));
        let expected: Vec<f64> =
            case.problem.mesh.points.iter().flat_map(|p| [0.5 * p[0], 0.0, 0.0].into_iter().take(components)).collect();
        assert_near(&solved(&case).u, &expected, 1e-11);
    }
}

/// A test each: `name: mesh, components, "old" => "new" "line of the message"… ;`
macro_rules! spoiled {
    ($($name:ident: $mesh:literal, $components:literal, $old:literal => $new:literal $(set $set:literal)* $($line:literal)+;)*) => {
        $(#[test]
        fn $name() {
            let overrides: &[&str] = &[$($set),*];
            assert_eq!(message(spoil(&body($mesh, $components), $old, $new), overrides), [$($line),+].join("\n"));
        })*
    };
}

// Meshes.
spoiled! {
    no_such_mesh_file: "file = \"bra.msh\"", 2, "" => ""
        "body.toml:3:8: mesh.file: found \"bra.msh\", which is not there, expected a file beside the case file; did you mean \"bar.msh\"?";
    no_mesh_file: "file = \"bar.stl\"", 2, "" => ""
        "body.toml:3:8: mesh.file: found bar.stl: a surface of triangles (STL), without cells inside, expected cells that fill a body; mesh the volume inside, in Gmsh with `Merge`, `Surface Loop` and `Volume`, or mesh the CAD shape; a rigid obstacle may be a surface: `shape = \"file\"` in [contact.obstacle]";
    broken_mesh_file: "file = \"cut.msh\"", 2, "" => ""
        "body.toml:3:8: mesh.file: found cut.msh: line 20: the end of the file, expected a section $Elements";
    inverted_cells_of_a_file: "file = \"turned.msh\"", 2, "" => ""
        "body.toml:3:8: mesh.file: found turned.msh: cell 0 with nodes [0, 1, 4, 3] at [0.5, 0.0, 0.0] is inverted: the smallest Jacobian is -5.773502691896257e-1, expected a positive one; cell 1 with nodes [1, 2, 5, 4] at [1.5, 0.0, 0.0] is inverted: the smallest Jacobian is -5.773502691896257e-1, expected a positive one, expected a sound mesh";
    kind_and_file: "kind = \"box\"\nfile = \"bar.msh\"", 3, "" => ""
        "body.toml:2:1: mesh.size: found no such key, expected an array of 3, each a number > 0 (lengths of the sides in m)"
        "body.toml:2:1: mesh.n: found no such key, expected an integer ≥ 1 or three of them, [nx, ny, nz] (cells per side)"
        "body.toml:4:1: mesh.file: found an unknown key, expected one of elements, kind, n, refine_where, refined_cells, size; `file` belongs to [mesh] with kind = \"file\"";
    elements_unknown: "kind = \"interval\"\nsize = 1\nn = 2\nelements = \"P3\"", 1, "" => ""
        "body.toml:6:12: mesh.elements: found \"P3\", expected \"P1\", \"P2\", \"Q1\" or \"Q2\" (element type of the cells)";
    diagonal_of_quadrilaterals: "kind = \"rectangle\"\nsize = [2, 1]\nn = 2\nelements = \"Q1\"\ndiagonal = \"left\"", 2, "" => ""
        "body.toml:7:12: mesh.diagonal: found a diagonal besides quadrilaterals, expected a diagonal with triangles only, P1 or P2; remove one of them";
    disc_around: "kind = \"disc\"\nradius = 1\nn = [2, 6]", 2, "on = \"left\"" => "on = \"outer\""
        "body.toml:2:1: mesh: found 6 cells around, expected a multiple of 4, for the square in the middle";
    radii_swapped: "kind = \"ring\"\nradii = [2, 1]\nn = [2, 6]", 2, "on = \"left\"" => "on = \"outer\""
        "body.toml:2:1: mesh: found the inner radius 2 is not smaller than the outer one, 1, expected a mesh that can be built";
    two_cells_of_an_interval: "kind = \"interval\"\nsize = 1\nn = [2, 2]", 1, "" => ""
        "body.toml:5:5: mesh.n: found an array of 2, expected an integer ≥ 1 (number of cells)";
    two_sizes_of_a_box: "kind = \"box\"\nsize = [1, 1]\nn = 2", 3, "" => ""
        "body.toml:4:8: mesh.size: found an array of 2, expected an array of 3, each a number > 0 (lengths of the sides in m)";
    revolution_over_the_axis: "kind = \"rectangle\"\nsize = [2, 1]\norigin = [-1, 0]\nn = 2\naxisymmetric = true", 2, "" => ""
        "body.toml:2:1: mesh: found node 0 has r = -1.000000e0, expected none below 0: the axis of an axisymmetric body is x = 0, expected cells of positive measure";
    y_on_a_line: "kind = \"interval\"\nsize = 1\nn = 2", 1, "temperature = 0.0" => "temperature = \"y\""
        "body.toml:20:15: boundary[0].temperature: found `y` in an expression, expected an expression in x, t: the body is a line";
    two_components_in_space: "kind = \"box\"\nsize = [1, 1, 1]\nn = 1", 2, "" => ""
        "body.toml:19:16: boundary[0].displacement: found 2 components, expected 3 components";
}

// Materials and regions.
spoiled! {
    stress_state_in_space: "kind = \"box\"\nsize = [1, 1, 1]\nn = 1", 3, "poisson = 0.0 }" => "poisson = 0.0, stress_state = \"plane-strain\" }"
        "body.toml:15:79: material.elasticity.stress_state: found a stress state of a body in space, expected one of a plane body or a line; remove it";
    poisson_in_space: "kind = \"box\"\nsize = [1, 1, 1]\nn = 1", 3, "poisson = 0.0 }" => "poisson = 0.5 }"
        "body.toml:15:59: material.elasticity.poisson: found 0.5, expected a number > -1 and < 0.5 in space (Poisson's ratio ν); use 0.49 for a nearly incompressible material; incompressible materials are not supported";
    compliance_not_positive: "kind = \"box\"\nsize = [1, 1, 1]\nn = 1", 3, "{ law = \"isotropic\", young = 10.0, poisson = 0.0 }" => "{ law = \"orthotropic\", young = [1, 1, 1], poisson = [0.9, 0.9, 0.9], shear = [1, 1, 1] }"
        "body.toml:15:14: material.elasticity: found a compliance −ν_ij (E_j/E_i)^½ of the normal strains, with ones on its diagonal, with eigenvalues from -8.000e-1 to 1.900e0, expected all of them positive";
    softens_too_much: "kind = \"box\"\nsize = [1, 1, 1]\nn = 1", 3, "{ law = \"isotropic\", young = 10.0, poisson = 0.0 }" => "{ law = \"von-mises-projection\", young = 10.0, poisson = 0.25, excess = -9.0, radius = 0.5 }"
        "body.toml:15:14: material.elasticity: found β = -9.0, expected a number above −2μ, else the law is not strongly monotone";
    viscosity_rises: "kind = \"box\"\nsize = [1, 1, 1]\nn = 1", 3, "{ law = \"lame\", first = 0.0, second = 0.0 }" => "{ law = \"carreau\", bulk = 1, zero = 1, infinite = 2, time = 3, exponent = 0.5 }"
        "body.toml:16:13: material.viscosity: found η_∞ = 2.0, expected a number from 0 to η₀";
    branches_of_a_law_that_is_not_linear: "kind = \"box\"\nsize = [1, 1, 1]\nn = 1", 3, "{ law = \"isotropic\", young = 10.0, poisson = 0.0 }" => "{ law = \"von-mises-projection\", young = 10.0, poisson = 0.25, excess = 1.0, radius = 0.5 }\nprony = [{ ratio = 1, time = 1 }]"
        "body.toml:16:9: material.prony: found branches besides a law that is not linear, expected a linear elasticity";
    tensor_of_a_plane_body_in_space: "kind = \"box\"\nsize = [1, 1, 1]\nn = 1", 3, "conductivity = 1.0" => "conductivity = [[1, 0], [0, 1]]"
        "body.toml:14:16: material.conductivity: found a matrix of 2 rows, expected a number or a symmetric 3 × 3 matrix";
    torsion_of_a_body_of_revolution: "kind = \"rectangle\"\nsize = [2, 1]\nn = 2\naxisymmetric = true", 2, "expansion = 0.0" => "expansion = [[1, 0, 1], [0, 1, 0], [1, 0, 1]]"
        "body.toml:13:13: material.expansion: found a component rθ or zθ, expected a tensor that is the same around the axis of a body of revolution";
    unheld_part: "file = \"parts.msh\"", 2, "" => ""
        "body.toml:15:1: boundary: found no displacement prescribed and density 0 in part 1 of the body, x from 2.0 to 5.0, y from 0.0 to 1.0, expected a part Γ_D that holds the body; give `displacement` on a side, or a positive material.density"
        "body.toml:15:1: boundary: found no temperature prescribed and heat_capacity 0 in part 1 of the body, x from 2.0 to 5.0, y from 0.0 to 1.0, expected a side whose temperature is known; give `temperature` on a side, or a positive material.heat_capacity";
}

const STEEL: &str = "[region.material]\ndensity = 0.0\nheat_capacity = 0.0\nexpansion = 0.0\ncoupling = 0.0\nconductivity = 3.0\n\
                     elasticity = { law = \"isotropic\", young = 40.0, poisson = 0.0, stress_state = \"plane-stress\" }\nviscosity = { law = \"lame\", first = 0.0, second = 0.0 }\n";

/// A test each: the bar with this text at its end.
macro_rules! regions {
    ($($name:ident: $text:expr, $($line:literal)+;)*) => {
        $(#[test]
        fn $name() {
            assert_eq!(message(format!("{}{}", body("file = \"bar.msh\"", 2), $text), &[]), [$($line),+].join("\n"));
        })*
    };
}

regions! {
    unknown_region: format!("[[region]]\non = \"stif\"\n{STEEL}"),
        "body.toml:20:6: region[0].on: found \"stif\", expected one of the regions soft, stiff; did you mean \"stiff\"?";
    region_twice: format!("[[region]]\non = \"stiff\"\n{STEEL}[[region]]\non = \"stiff\"\n{STEEL}"),
        "body.toml:30:6: region[1].on: found \"stiff\" again, expected each region in one [[region]] entry";
    region_without_a_material: "[[region]]\non = \"stiff\"\n",
        "body.toml:19:1: region[0].material: found no such key, expected `material`, `body_force`, `heat_source` or `temperature`";
    faulty_region: format!("[[region]]\non = \"stiff\"\n{}", STEEL.replace("young = 40.0", "young = -40.0")),
        "body.toml:27:43: region[0].material.elasticity.young: found -40.0, expected a number > 0 (Young's modulus E in Pa)";
    region_with_a_negative_conductivity: format!("[[region]]\non = \"stiff\"\n{}", STEEL.replace("conductivity = 3.0", "conductivity = -3.0")),
        "body.toml:26:16: region[0].material.conductivity: found the eigenvalue -3.0, expected no negative eigenvalue: heat flows from warm to cold";
}

#[test]
fn a_huge_box_is_refused_before_it_is_built() {
    let message = message(body("kind = \"box\"\nsize = [1, 1, 1]\nn = 100_000", 3), &[]);
    assert!(
        message.starts_with("body.toml:5:5: mesh.n: found 100000 × 100000 × 100000 cells: 4.000e15 unknowns"),
        "{message}"
    );
    assert!(message.ends_with("; take fewer cells") && message.lines().count() == 1, "{message}");
}

/// Levels of a mesh from a file are the parts of each of its edges.
#[test]
fn a_mesh_from_a_file_is_halved() {
    let request = case::StudyRequest {
        vary: amontons::convergence::Vary::Space,
        levels: vec![2, 4],
        reference: case::ReferenceRequest::Finest,
        power: 1,
    };
    let thirds = case::StudyRequest { levels: vec![2, 3], ..request.clone() };
    let error = case::study(&source(body("file = \"bar.msh\"", 2)), &[], &thirds).unwrap_err().to_string();
    assert_eq!(
        error,
        "level 3 of a mesh from a file, expected powers of two (1, 2, 4, …), the number of parts of each edge"
    );
    let halves = case::study(&source(body("file = \"bar.msh\"", 2)), &[], &request).unwrap();
    let coarse = case::parse(&source(body("file = \"bar.msh\"", 2)), &[]).unwrap().problem.mesh.cell_count();
    assert_eq!(halves.levels[0].problem.mesh.cell_count(), coarse << halves.levels[0].problem.mesh.dim);
    let steps = case::StudyRequest { vary: amontons::convergence::Vary::Time, ..request.clone() };
    assert!(case::study(&source(body("file = \"bar.msh\"", 2)), &[], &steps).is_ok());
    let boxes =
        case::study(&source(body("kind = \"box\"\nsize = [1, 1, 1]\nn = [2, 4, 6]", 3)), &[], &request).unwrap();
    assert_eq!(boxes.levels[0].problem.mesh.points.len(), 3 * 5 * 7);
}
