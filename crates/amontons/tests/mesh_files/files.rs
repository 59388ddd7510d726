//! Files written by Gmsh 4.15 and VTK 9.7, with the integrals that Gmsh's own Jacobians give. The `.geo` files beside
//! them are their sources.

use std::path::{Path, PathBuf};

use amontons::element::{Element, ShapeTable};
use amontons::mesh::{self, Mesh, defects};

use super::{assert_same, region, side};

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes").join(name)
}

pub fn read(name: &str) -> Mesh {
    mesh::read(&path(name)).unwrap_or_else(|e| panic!("{e}"))
}

/// The two programs' rules, of degree 20 and 24, have ten digits where a facet is curved.
fn close(found: (f64, f64), expected: (f64, f64)) {
    let tolerance = 1e-10 * expected.0.max(1.0);
    assert!(
        (found.0 - expected.0).abs() < tolerance && (found.1 - expected.1).abs() < tolerance,
        "{found:?} {expected:?}"
    );
}

/// Regions and sides of a file: name, number of elements, ∫ 1 and ∫ x.
fn integrals_agree(mesh: &Mesh, regions: &[(&str, usize, f64, f64)], sides: &[(&str, usize, f64, f64)]) {
    mesh.check().expect("a sound mesh");
    assert_eq!(defects::defects(mesh), []);
    assert_eq!(defects::components(mesh).len(), 1);
    assert_eq!(mesh.regions, regions.iter().map(|r| r.0).collect::<Vec<_>>());
    for &(name, _, measure, moment) in regions {
        close(region(mesh, name), (measure, moment));
    }
    assert_eq!(mesh.cell_count(), regions.iter().map(|r| r.1).sum::<usize>());
    assert_eq!(mesh.facets.len(), sides.len());
    for &(name, count, measure, moment) in sides {
        let set = &mesh.facets[name];
        assert_eq!(set.len(), count);
        let found = side(mesh, set);
        close((found.0, found.1), (measure, moment));
    }
}

fn ring(mesh: &Mesh, name: impl Fn(&'static str, &'static str) -> &'static str) {
    integrals_agree(
        mesh,
        &[(name("pad lining", "1"), 31, 2.356_216_653_552_301, 2.333_336_861_001_004)],
        &[
            (name("start", "11"), 2, 1.0, 1.5),
            (name("outer", "12"), 7, 3.141_584_388_529_672_4, 3.999_978_939_828_364),
            (name("end", "13"), 2, 1.0, 0.0),
            (name("inner", "14"), 4, 1.570_757_880_834_477_3, 0.999_950_954_403_080_9),
        ],
    );
    // Gauss: ∫ x·ν over the whole boundary is twice the area; the sides of the ring are all of it.
    let flux: f64 = mesh.facets.values().map(|set| side(mesh, set).2).sum();
    assert!((flux - 2.0 * 2.356_216_653_552_301).abs() < 1e-9);
    assert_eq!(mesh.unnamed_boundary_facets(), 0);
    // The curved area is that of the ring to the fourth order: 4 and 7 edges on the arcs.
    assert!((region(mesh, &mesh.regions[0]).0 - 0.75 * std::f64::consts::PI).abs() < 3e-5);
}

#[test]
fn a_quarter_ring_of_quadratic_triangles() {
    ring(&read("quarter_ring.msh"), |name, _| name);
}

#[test]
fn a_cylinder_of_two_regions_of_quadratic_tetrahedra() {
    let mesh = read("cylinder.msh");
    integrals_agree(
        &mesh,
        &[
            ("back plate", 36, 3.139_511_550_745_315, 0.000_202_666_250_501),
            ("pad", 36, 3.139_496_079_582_815_3, 0.000_198_487_143_076),
        ],
        &[
            ("bottom", 7, 3.137_444_835_415_266_6, 0.0),
            ("top", 7, 3.137_444_835_415_265_8, 0.0),
            ("side", 56, 12.562_361_589_360_933, 0.000_779_275_817_217),
        ],
    );
    let flux: f64 = mesh.facets.values().map(|set| side(&mesh, set).2).sum();
    let volume = region(&mesh, "pad").0 + region(&mesh, "back plate").0;
    assert!((flux - 3.0 * volume).abs() < 1e-9, "{flux} {volume}");
}

#[test]
fn prisms_and_hexahedra_of_first_and_second_order() {
    let linear = read("blocks_linear.msh");
    assert_eq!(linear.blocks.iter().map(|b| b.element.name).collect::<Vec<_>>(), ["Q1 hexahedron", "P1 prism"]);
    integrals_agree(
        &linear,
        &[("body", 22, 1.75, 0.811_004_233_917_558)],
        &[("bottom", 11, 1.75, 0.811_004_233_917_558), ("round", 6, 1.552_914_270_615_124, 0.965_925_826_216_833_8)],
    );
    assert_eq!(linear.facets["bottom"].blocks.len(), 2);
    let quadratic = read("blocks_quadratic.msh");
    assert_eq!(quadratic.blocks.iter().map(|b| b.element.name).collect::<Vec<_>>(), ["Q2 hexahedron", "P2 prism"]);
    let area = 1.785_276_180_410_1;
    integrals_agree(
        &quadratic,
        &[("body", 22, area, 0.833_255_930_044_8)],
        &[("bottom", 11, area, 0.833_255_930_044_8), ("round", 6, 1.570_675_936_297, 0.999_846_190_363_5)],
    );
}

/// The bases of the pyramids lie on a part of a cylinder. Without the nodes in the middle of faces and cells the body
/// is the same.
#[test]
fn pyramids_between_hexahedra_and_tetrahedra() {
    for name in ["blocks_pyramids.msh", "blocks_pyramids_incomplete.msh"] {
        let mesh = read(name);
        assert_eq!(
            mesh.blocks.iter().map(|b| (b.element.name, b.len())).collect::<Vec<_>>(),
            [("Q2 hexahedron", 8), ("P2 tetrahedron", 63), ("P2 pyramid", 4)],
            "{name}"
        );
        let (below, above) = (0.453_730_705_884_866, 0.426_269_294_106_507_05);
        integrals_agree(
            &mesh,
            &[("below", 8, below, 0.226_865_352_943_854_65), ("above", 67, above, 0.213_134_647_051_861_97)],
            &[("bottom", 4, 0.8, 0.4), ("front", 10, 1.1, 0.55), ("top", 12, 0.8, 0.4)],
        );
        assert!((below + above - 0.88).abs() < 1e-10, "the file fills its box");
        let whole = mesh.boundary();
        assert!((side(&mesh, &whole).2 - 3.0 * 0.88).abs() < 1e-10, "{name}");
    }
}

/// The nodes of a cell of a file are where the map of its vertices has them: the order of the file was understood.
pub fn assert_places(mesh: &Mesh, name: &str) {
    let [block] = mesh.blocks.as_slice() else { panic!("{name}: {} kinds of cells", mesh.blocks.len()) };
    let element = block.element;
    let linear = Element::find(element.shape, 1).expect("a linear element");
    let table = ShapeTable::at(linear, element.nodes);
    for cell in block.cells() {
        for (i, &node) in cell.iter().enumerate() {
            for d in 0..3 {
                let share = |(&vertex, value): (&u32, &f64)| mesh.points[vertex as usize][d] * value;
                let expected: f64 = cell.iter().zip(table.values(i)).map(share).sum();
                let found = mesh.points[node as usize][d];
                assert!((found - expected).abs() < 1e-15, "{name}: node {i} at {:?}", mesh.points[node as usize]);
            }
        }
    }
}

/// `meshes/vtk_cells.py` wrote the pyramid with VTK; Gmsh's own reference nodes are those of a single cell.
#[test]
fn single_pyramids_have_their_nodes_in_place() {
    for name in ["pyramid13.vtu", "pyramid13.e", "pyramid14.e"] {
        let mesh = read(name);
        mesh.check().expect("a sound mesh");
        assert_eq!(mesh.blocks[0].element.name, "P2 pyramid");
        assert_places(&mesh, name);
        // A third of the determinant of the three edges.
        assert!((region(&mesh, &mesh.regions[0]).0 - 0.992_187_5 / 3.0).abs() < 1e-15, "{name}");
    }
}

#[test]
fn vtk_in_every_encoding_is_the_mesh_of_gmsh() {
    let mut first = read("quarter_ring.msh");
    let tags = [("start", "11"), ("outer", "12"), ("end", "13"), ("inner", "14")];
    first.facets = tags.into_iter().map(|(name, tag)| (tag.to_owned(), first.facets[name].clone())).collect();
    first.regions = vec!["1".to_owned()];
    for encoding in
        ["ascii", "base64", "base64_zlib", "raw", "raw_zlib", "raw_big", "append64", "append64_zlib", "meshio"]
    {
        let read = read(&format!("quarter_ring_{encoding}.vtu"));
        ring(&read, |_, tag| tag);
        if encoding != "ascii" {
            assert_same(&read, &first);
        }
    }
}
