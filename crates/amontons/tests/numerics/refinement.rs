//! Uniform refinement of meshes: the same body in finer cells, and the orders that studies on mesh files observe.

use std::collections::BTreeSet;

use amontons::case::{self, Files, ReferenceRequest, Source, StudyRequest};
use amontons::convergence::{StudySettings, Vary};
use amontons::element::{P1_PYRAMID, ShapeTable};
use amontons::mesh::{Block, CellMap, Diagonal, Elements, FacetMap, FacetSet, Mesh};
use amontons::quadrature::Shape;

pub fn volume(mesh: &Mesh) -> f64 {
    let mut sum = 0.0;
    for block in &mesh.blocks {
        let table = ShapeTable::new(block.element, 8);
        let mut map = CellMap::new(mesh, &table);
        for cell in block.cells() {
            // Cell by cell: thousands of small numbers of the same size added to a large one round to the same side.
            let mut of_cell = 0.0;
            for q in 0..table.len() {
                map.at(cell, q);
                assert!(map.jacobian > 0.0);
                of_cell += table.weights[q] * map.measure;
            }
            sum += of_cell;
        }
    }
    sum
}

/// ∫ 1 and ∫ x·ν over a side.
pub fn side(mesh: &Mesh, set: &FacetSet) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for block in &set.blocks {
        let table = ShapeTable::new(block.element, 16);
        let mut map = FacetMap::new(mesh, &table);
        for facet in block.nodes.chunks_exact(block.element.nodes.len()) {
            for q in 0..table.len() {
                map.at(facet, q);
                let weight = table.weights[q] * map.area;
                let flux: f64 = (0..3).map(|d| map.position[d] * map.normal[d]).sum();
                sums = [sums[0] + weight, sums[1] + weight * flux];
            }
        }
    }
    sums
}

/// A pyramid that is not regular, with its base and one of its sides.
fn pyramid() -> Mesh {
    let points = vec![[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [1.2, 1.0, 0.0], [0.0, 0.9, 0.0], [0.3, 0.4, 1.1]];
    let block = Block { element: &P1_PYRAMID, region: 0, nodes: vec![0, 1, 2, 3, 4] };
    let mut mesh = Mesh {
        dim: 3,
        axisymmetric: false,
        thickness: None,
        points,
        blocks: vec![block],
        regions: vec!["body".to_owned()],
        facets: std::collections::BTreeMap::new(),
        edges: std::collections::BTreeMap::new(),
    };
    mesh.facets.insert("all".to_owned(), mesh.boundary());
    mesh
}

/// The mesh moved by a map that is quadratic: edges and faces are curved.
fn bent(mesh: &Mesh) -> Mesh {
    let mut bent = mesh.clone();
    for [x, y, z] in &mut bent.points {
        *z += 0.1 * *x * *y - 0.15 * *x * *x;
        *x += 0.1 * *y * *y;
    }
    bent
}

pub fn bodies() -> Vec<Mesh> {
    let prisms = Mesh::rectangle([1.0, 2.0], [2, 1], Diagonal::Right)
        .expect("a mesh")
        .extruded(1.0, 2, ["low", "high"])
        .expect("a mesh");
    vec![
        Mesh::interval(1.5, 3, Elements::P2).expect("a mesh"),
        Mesh::rectangle_of(Elements::P1, [1.0, 2.0], [2, 2], Diagonal::Crossed).expect("a mesh"),
        Mesh::ring([0.5, 1.0], Some(1.0), [2, 3], Elements::P2).expect("a mesh"),
        Mesh::ring([0.5, 1.0], None, [2, 8], Elements::Q2).expect("a mesh"),
        Mesh::rectangle_of(Elements::Q1, [1.0, 2.0], [2, 2], Diagonal::Right).expect("a mesh"),
        Mesh::box_([1.0, 2.0, 3.0], [1, 2, 1], Elements::P1).expect("a mesh"),
        Mesh::cylinder([0.5, 1.0], None, 1.0, [1, 8, 1], Elements::P2).expect("a mesh"),
        Mesh::box_([1.0, 2.0, 3.0], [1, 2, 1], Elements::Q1).expect("a mesh"),
        Mesh::cylinder([0.5, 1.0], None, 1.0, [1, 8, 1], Elements::Q2).expect("a mesh"),
        prisms.quadratic().expect("a mesh"),
        prisms,
        pyramid(),
        bent(&pyramid().quadratic().expect("a mesh")),
    ]
}

/// The mesh turned by a random rotation in space (of a plane body in its plane), with its nodes in another order.
pub fn turned(mesh: &Mesh, seed: u64) -> Mesh {
    let mut state = seed;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / (1u64 << 31) as f64
    };
    let mut points = mesh.points.clone();
    for (i, j) in [(0, 1), (1, 2), (0, 2)].into_iter().take(if mesh.dim < 3 { mesh.dim - 1 } else { 3 }) {
        let (sin, cos) = (6.0 * random()).sin_cos();
        for p in &mut points {
            (p[i], p[j]) = (cos * p[i] - sin * p[j], sin * p[i] + cos * p[j]);
        }
    }
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    for i in (1..order.len()).rev() {
        order.swap(i, (random() * (i as f64 + 1.0)) as usize);
    }
    let mut turned = mesh.clone();
    for (old, &new) in order.iter().enumerate() {
        turned.points[new as usize] = points[old];
    }
    let sides = turned.facets.values_mut().flat_map(|set| &mut set.blocks).flat_map(|block| &mut block.nodes);
    for node in turned.blocks.iter_mut().flat_map(|block| &mut block.nodes).chain(sides) {
        *node = order[*node as usize];
    }
    turned
}

/// The body, its regions and its sides keep their measures and the flux of x through them; cells fit their neighbours.
#[test]
fn a_refined_mesh_is_the_same_body() {
    let turned = bodies().into_iter().zip(1..).map(|(mesh, seed)| turned(&mesh, seed));
    for mesh in bodies().into_iter().chain(turned) {
        let name = mesh.blocks[0].element.name;
        let mut finer = mesh.clone();
        for _ in 0..2 {
            let before = finer.clone();
            finer = finer.refined().expect("a mesh");
            finer.check().expect("a sound mesh");
            let parts = |block: &Block| if block.element.shape == Shape::Pyramid { 10 } else { 1 << mesh.dim };
            let expected: usize = before.blocks.iter().map(|block| block.len() * parts(block)).sum();
            assert_eq!(finer.cell_count(), expected, "{name}");
            let volumes = [&finer, &mesh].map(volume);
            assert!((volumes[0] - volumes[1]).abs() < 1e-12 * volumes[1], "{name}: {volumes:?}");
            assert_eq!(
                finer.boundary().len(),
                before.boundary().len() << (mesh.dim - 1),
                "{name}: a node is there twice"
            );
            for (side_name, set) in &mesh.facets {
                let (found, expected) = (side(&finer, &finer.facets[side_name]), side(&mesh, set));
                for (found, expected) in found.into_iter().zip(expected) {
                    assert!((found - expected).abs() < 1e-12 * (1.0 + expected.abs()), "{name} {side_name}");
                }
            }
            assert_eq!(finer.unnamed_boundary_facets(), before.unnamed_boundary_facets() << (mesh.dim - 1), "{name}");
            assert_eq!(finer.points[..before.points.len()], before.points[..], "{name}");
        }
    }
}

/// A mesh of squares refined is the mesh of twice as many squares, node by node.
#[test]
fn refined_squares_are_squares() {
    for elements in [Elements::P1, Elements::P2, Elements::Q1, Elements::Q2] {
        let mesh = |n: usize| Mesh::rectangle_of(elements, [1.0, 1.0], [n, n], Diagonal::Right).expect("a mesh");
        let (refined, made) = (mesh(4).refined().expect("a mesh"), mesh(8));
        let places = |mesh: &Mesh| -> BTreeSet<[u64; 2]> {
            mesh.points.iter().map(|p| [p[0].to_bits(), p[1].to_bits()]).collect()
        };
        assert_eq!(places(&refined), places(&made));
        let cells = |mesh: &Mesh| -> BTreeSet<BTreeSet<[u64; 2]>> {
            let at = |&node: &u32| [0, 1].map(|d| mesh.points[node as usize][d].to_bits());
            mesh.blocks.iter().flat_map(|block| block.cells().map(|cell| cell.iter().map(at).collect())).collect()
        };
        assert_eq!(cells(&refined), cells(&made));
    }
}

/// The shapes of tetrahedra change in the first refinement and then no more: by the shortest diagonal of each
/// octahedron those of a cube fall into the same few classes (Zhang, Houston J. Math. 21, 1995).
#[test]
fn refined_tetrahedra_keep_their_shape() {
    let mesh = Mesh::box_([1.0, 1.0, 1.0], [1, 1, 1], Elements::P1).expect("a mesh");
    let mut finer = mesh.refined().expect("a mesh");
    let worst = finer.worst_quality().0;
    assert!(worst > 0.9 * mesh.worst_quality().0, "{worst}");
    for _ in 0..3 {
        finer = finer.refined().expect("a mesh");
        assert!((finer.worst_quality().0 - worst).abs() < 1e-12, "{} {worst}", finer.worst_quality().0);
    }
}

/// θ = ln r² on a quarter ring of Gmsh, held on its boundary: quadratic elements converge with order 3 in L².
#[test]
fn a_study_on_a_mesh_file_observes_the_orders() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes");
    let held = ["inner", "outer", "start", "end"]
        .map(|on| format!("[[boundary]]\non = \"{on}\"\ntemperature = \"log(x^2 + y^2)\"\n"))
        .concat();
    let text = format!(
        "name = \"ring\"\n[mesh]\nfile = \"quarter_ring.msh\"\n[time]\nend = 1\nsteps = 1\n\
         [material]\nheat_capacity = 0\nconductivity = 1\n{held}[exact]\ntemperature = \"log(x^2 + y^2)\"\n"
    );
    let source = Source { files: Files::Folder(folder), ..Source::new("ring.toml".to_owned(), text) };
    let request =
        StudyRequest { vary: Vary::Space, levels: vec![1, 2, 4, 8], reference: ReferenceRequest::Exact, power: 1 };
    let study = case::study(&source, &[], &request).unwrap_or_else(|error| panic!("{error}"));
    let table = study.run(&StudySettings::default()).expect("a study");
    let errors: Vec<f64> = table.rows.iter().map(|row| row.error_theta).collect();
    for pair in errors.windows(2).skip(1) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 3.0).abs() < 0.15, "{errors:?}");
    }
    let wrong = StudyRequest { levels: vec![1, 3], ..request };
    let told = case::study(&source, &[], &wrong).expect_err("a refusal").to_string();
    assert!(told.contains("level 3 of a mesh from a file") && told.contains("1, 2, 4"), "{told}");
}

/// A rounded body is another one on each mesh. A study against a fine mesh observes the errors of one against the
/// closed form: Lamé's tube in a sector, and a disc that is held at its rim and pulled outward by the force (x, y),
/// which has u = (1 − r²)/(8 (λ + 2 μ)) (x, y).
#[test]
fn studies_of_rounded_bodies_observe_the_errors() {
    let tube = "[mesh]\nkind = \"ring\"\nradii = [1.0, 2.0]\nangle = 1.0\nn = [4, 4]\nelements = \"KIND\"\n\
        [[boundary]]\non = \"inner\"\npressure = 1\n[[boundary]]\non = \"start\"\nnormal_displacement = 0\n\
        [[boundary]]\non = \"end\"\nnormal_displacement = 0\n\
        [exact]\ndisplacement = [\"1.3/3000*(0.4 + 4/(x^2 + y^2))*x\", \"1.3/3000*(0.4 + 4/(x^2 + y^2))*y\"]\n";
    let disc = "[mesh]\nkind = \"disc\"\nradius = 1.0\nn = [4, AROUND]\nelements = \"KIND\"\n\
        [load]\nbody_force = [\"x\", \"y\"]\n[[boundary]]\non = \"outer\"\ndisplacement = [0.0, 0.0]\n\
        [exact]\ndisplacement = [\"0.52/5600*(1 - x^2 - y^2)*x\", \"0.52/5600*(1 - x^2 - y^2)*y\"]\n";
    let common = "[time]\nend = 1\nsteps = 1\n[material]\ndensity = 0\n\
        elasticity = { law = \"isotropic\", young = 1000.0, poisson = 0.3, stress_state = \"plane-strain\" }\n";
    let errors = |text: &str, levels: &[usize], reference: ReferenceRequest| -> Vec<f64> {
        let source = Source::new("rounded.toml", format!("name = \"rounded\"\n{text}{common}"));
        let request = StudyRequest { vary: Vary::Space, levels: levels.to_vec(), reference, power: 1 };
        let study = case::study(&source, &[], &request).unwrap_or_else(|error| panic!("{error}"));
        let table = study.run(&StudySettings::default()).unwrap_or_else(|error| panic!("{error}"));
        table.rows.iter().map(|row| row.error_u).collect()
    };
    let (fine, coarse) = (disc.replace("AROUND", "16"), disc.replace("AROUND", "8"));
    for (body, elements, levels, near) in [
        (tube, "P1", &[4, 8][..], 0.1),
        (tube, "P2", &[4, 8], 0.01),
        (tube, "Q1", &[4, 8], 0.1),
        (tube, "Q2", &[4, 8], 0.01),
        (&fine, "P1", &[4, 8], 0.1),
        (&fine, "Q1", &[4, 8], 0.1),
        (&coarse, "P1", &[8], 0.1),
    ] {
        let text = body.replace("KIND", elements);
        let against = errors(&text, levels, ReferenceRequest::Level(64));
        for (against, exact) in against.iter().zip(errors(&text, levels, ReferenceRequest::Exact)) {
            assert!((against / exact - 1.0).abs() < near, "{elements}: {against:e}, expected {exact:e}");
        }
        let order = if elements.ends_with('1') { 1.0 } else { 2.0 };
        for pair in against.windows(2) {
            let observed = (pair[0] / pair[1]).log2();
            assert!((observed - order).abs() < 0.1 + near, "{elements}: order {observed}");
        }
    }
}

/// Two rings of millimetres that are pressed into each other: where one reaches over the chords of the other, each is
/// compared with itself. Errors halve with the cells.
#[test]
fn studies_of_rounded_pairs_keep_the_bodies_apart() {
    let mut text = "name = \"rings\"\n[mesh]\nkind = \"blocks\"\n".to_owned();
    for (name, radii) in [("shaft", "[0.5e-3, 1e-3]"), ("hub", "[1e-3, 2e-3]")] {
        text += &format!("[[mesh.blocks]]\nname = \"{name}\"\nradii = {radii}\nangle = 1.0\nn = [4, 4]\n");
    }
    text += "[time]\nend = 1\nsteps = 1\n[material]\ndensity = 0\n\
        elasticity = { law = \"isotropic\", young = 1000.0, poisson = 0.3, stress_state = \"plane-strain\" }\n\
        [[contact]]\non = \"shaft_outer\"\nwith = \"hub_inner\"\ngap = -1e-5\nnormal = { law = \"signorini\" }\n";
    for side in ["shaft_start", "shaft_end", "hub_start", "hub_end"] {
        text += &format!("[[boundary]]\non = \"{side}\"\nnormal_displacement = 0\n");
    }
    let levels = vec![4, 8, 16];
    let request = StudyRequest { vary: Vary::Space, levels, reference: ReferenceRequest::Level(64), power: 1 };
    let study = case::study(&Source::new("rings.toml", text), &[], &request).unwrap_or_else(|error| panic!("{error}"));
    let table = study.run(&StudySettings::default()).unwrap_or_else(|error| panic!("{error}"));
    let errors: Vec<f64> = table.rows.iter().map(|row| row.error_u).collect();
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 1.0).abs() < 0.15, "{errors:?}");
    }
}
