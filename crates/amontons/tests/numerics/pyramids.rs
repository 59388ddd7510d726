//! Quadratic pyramids, of which VTK has those of thirteen nodes: results of a run, and data of files with such cells.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use amontons::case::{self, Files, Source};
use amontons::mesh::{self, MeshData};
use amontons::output::Folder;
use amontons::plot;
use amontons::run::{Settings, run};
use amontons::tensor::Point;
use amontons::verify::recompute;

const CASE: &str = r#"
name = "pyramids"
[mesh]
file = "blocks_pyramids_incomplete.msh"
[time]
end = 1
steps = 2
[material]
density = 1
heat_capacity = 1
expansion = 0.1
coupling = 0.1
conductivity = 1
elasticity = { law = "isotropic", young = 10, poisson = 0.25 }
viscosity = { law = "lame", first = 1, second = 1 }
[load]
body_force = [0.1, 0, -1]
[[boundary]]
on = "top"
displacement = [0, 0, -0.01]
temperature = 1
[contact]
on = "bottom"
normal = { law = "compliance", stiffness = 100 }
friction = { law = "coulomb", coefficient = 0.2 }
[output]
every = 1
fields = ["stress", "strain", "nodal-stress"]
"#;

/// The fields of a run name the first thirteen nodes of each pyramid; what reads them takes these for the cells of the
/// mesh.
#[test]
fn results_have_pyramids_of_thirteen_nodes() {
    let meshes = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes");
    for format in ["vtu", "vtkhdf"] {
        let text = CASE.replace("every = 1", &format!("every = 1\nformat = \"{format}\""));
        let source = Source { files: Files::Folder(meshes.clone()), ..Source::new("pyramids.toml".to_owned(), text) };
        let case = case::parse(&source, &[]).unwrap_or_else(|error| panic!("{error}"));
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("pyramids").join(format);
        let _ = fs::remove_dir_all(&path);
        let mut folder = Folder::create(&path, case.folder_options()).expect("a folder");
        run(&case.problem, &Settings::default(), &mut [&mut folder]).expect("a run");
        let found = recompute(&path).expect("a run");
        assert!(found.holds(), "{found:?}");
        let pictures = plot::folder(&path, &plot::Options::default()).expect("pictures");
        assert!(pictures.iter().any(|picture| picture.to_string_lossy().contains("von-mises")), "{pictures:?}");
        if format == "vtu" {
            let ours = &case.problem.mesh;
            let read = mesh::read(&path.join("fields/step_0000002.vtu")).expect("a mesh");
            read.check().expect("a sound mesh");
            assert_eq!(mesh::defects::defects(&read), []);
            // The nodes in the middle of the bases were left out and are added again.
            assert_eq!((read.points.len(), read.cell_count()), (ours.points.len(), ours.cell_count()));
            let kinds = |mesh: &mesh::Mesh| -> Vec<(&str, usize)> {
                mesh.blocks.iter().map(|block| (block.element.name, block.len())).collect()
            };
            assert_eq!(kinds(&read), kinds(ours));
        }
    }
}

fn quadratic([x, y, z]: &Point) -> f64 {
    1.0 + x - y * y + 2.0 * x * z - 0.5 * z * z + x * y
}

/// Data at the nodes of a cell that lacks nodes are those of its own shape functions, to which quadratic functions
/// belong: a pyramid of VTK, one of Gmsh by its reference nodes, and a square of eight nodes.
#[test]
fn data_at_the_nodes_of_incomplete_cells_are_read() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes/pyramid13.vtu");
    let text = fs::read_to_string(&file).expect("a file");
    let shear = |[x, y, z]: Point| [2.0 * x + 0.25 * y, y - 0.25 * z, 0.125 * x + 0.5 * z];
    let read = mesh::read(&file).expect("a mesh");
    let values: Vec<String> = read.points[..13].iter().map(|x| quadratic(x).to_string()).collect();
    let array = format!(
        "<PointData><DataArray type=\"Float64\" Name=\"value\" format=\"ascii\">{}</DataArray>",
        values.join(" ")
    );
    let vtu = text.replace("<PointData>", &array);
    let data = MeshData::read("pyramid.vtu", vtu.as_bytes(), "value", 1.0).expect("data");
    for x in [[0.5, 0.5, 0.0], [0.3, 0.4, 0.1], [0.1, 0.2, 0.7]].map(shear) {
        assert!((data.value(&x) - quadratic(&x)).abs() < 1e-14, "{x:?}: {}", data.value(&x));
    }

    // Gmsh's own reference nodes, over the base [−1, 1]².
    let corners = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let middles = [
        [0.0, -1.0, 0.0],
        [-1.0, 0.0, 0.0],
        [-0.5, -0.5, 0.5],
        [1.0, 0.0, 0.0],
        [0.5, -0.5, 0.5],
        [0.0, 1.0, 0.0],
        [0.5, 0.5, 0.5],
        [-0.5, 0.5, 0.5],
    ];
    let pyramid = [corners.as_slice(), &middles].concat();
    let data = gmsh(19, &pyramid);
    for x in [[0.0, 0.0, 0.0], [0.3, -0.2, 0.1], [-0.1, 0.2, 0.7]] {
        assert!((data.value(&x) - quadratic(&x)).abs() < 1e-14, "{x:?}: {}", data.value(&x));
    }
    let square: Vec<Point> = pyramid[..4].iter().chain([5, 8, 10, 6].map(|i| &pyramid[i])).copied().collect();
    let data = gmsh(16, &square);
    for x in [[0.0, 0.0, 0.0], [0.3, -0.2, 0.0]] {
        assert!((data.value(&x) - quadratic(&x)).abs() < 1e-14, "{x:?}: {}", data.value(&x));
    }
}

/// One cell of Gmsh with values at its nodes.
fn gmsh(code: u32, nodes: &[Point]) -> MeshData {
    let mut text = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", nodes.len());
    for (i, [x, y, z]) in nodes.iter().enumerate() {
        let _ = writeln!(text, "{} {x} {y} {z}", i + 1);
    }
    let listed: String = (1..=nodes.len()).fold(String::new(), |all, i| format!("{all} {i}"));
    let _ = writeln!(text, "$EndNodes\n$Elements\n1\n1 {code} 2 0 1{listed}\n$EndElements");
    let _ = writeln!(text, "$NodeData\n1\n\"value\"\n1\n0.0\n3\n0\n1\n{}", nodes.len());
    for (i, x) in nodes.iter().enumerate() {
        let _ = writeln!(text, "{} {}", i + 1, quadratic(x));
    }
    text += "$EndNodeData\n";
    MeshData::read("cell.msh", text.as_bytes(), "value", 1.0).expect("data")
}
