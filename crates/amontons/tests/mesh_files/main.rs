//! Meshes from files: formats against each other and against Gmsh's own integrals, hostile files, and defects of
//! meshes.
#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "a test fails by panicking, and files keep every digit"
)]

mod abaqus;
mod decks;
mod defects;
mod endings;
mod exodus;
mod files;
mod formats;
mod gmsh_tags;
mod hostile;
mod mail;
mod med;
mod messages;
mod writer;

use amontons::element::ShapeTable;
use amontons::mesh::{CellMap, Diagonal, FacetMap, FacetSet, Mesh};
use amontons::tensor::{Point, dot};

/// A rectangle of triangles in two regions.
fn two_regions() -> Mesh {
    let mut mesh = Mesh::rectangle([2.0, 1.0], [4, 3], Diagonal::Right).expect("a mesh");
    let mut upper = mesh.blocks[0].clone();
    upper.region = 1;
    upper.nodes = mesh.blocks[0].nodes.split_off(36);
    mesh.blocks.push(upper);
    mesh.regions = vec!["back plate".to_owned(), "pad".to_owned()];
    mesh
}

/// A cube of linear prisms.
fn prisms() -> Mesh {
    let section = Mesh::rectangle([1.0, 1.0], [2, 2], Diagonal::Right).expect("a mesh");
    section.extruded(1.0, 2, ["low", "high"]).expect("a mesh")
}

/// ∫ 1 and ∫ x over the cells of a region.
fn region(mesh: &Mesh, name: &str) -> (f64, f64) {
    let region = mesh.regions.iter().position(|r| r == name).expect("a region");
    let (mut measure, mut moment) = (0.0, 0.0);
    for block in mesh.blocks.iter().filter(|b| b.region == region) {
        let table = ShapeTable::new(block.element, 8);
        let mut map = CellMap::new(mesh, &table);
        for cell in block.cells() {
            for q in 0..table.len() {
                map.at(cell, q);
                measure += table.weights[q] * map.measure;
                moment += table.weights[q] * map.measure * map.position[0];
            }
        }
    }
    (measure, moment)
}

/// ∫ 1, ∫ x and ∫ x·ν over a set of facets.
fn side(mesh: &Mesh, set: &FacetSet) -> (f64, f64, f64) {
    let (mut measure, mut moment, mut flux) = (0.0, 0.0, 0.0);
    for block in &set.blocks {
        let table = ShapeTable::new(block.element, 24);
        let mut map = FacetMap::new(mesh, &table);
        for facet in block.nodes.chunks_exact(block.element.nodes.len()) {
            for q in 0..table.len() {
                map.at(facet, q);
                let weight = table.weights[q] * map.area;
                measure += weight;
                moment += weight * map.position[0];
                flux += weight * dot(&map.position, &map.normal);
            }
        }
    }
    (measure, moment, flux)
}

/// Whether two meshes are the same, up to the numbers of the nodes and the node at which a facet begins.
fn assert_same(found: &Mesh, expected: &Mesh) {
    let at = |mesh: &Mesh, nodes: &[u32]| -> Vec<Point> { nodes.iter().map(|&n| mesh.points[n as usize]).collect() };
    assert_eq!(found.dim, expected.dim);
    assert_eq!(found.points.len(), expected.points.len());
    assert_eq!(found.regions, expected.regions);
    assert_eq!(found.blocks.len(), expected.blocks.len());
    for (a, b) in found.blocks.iter().zip(&expected.blocks) {
        assert_eq!((a.element.name, a.region), (b.element.name, b.region));
        assert_eq!(at(found, &a.nodes), at(expected, &b.nodes));
    }
    assert_eq!(found.facets.keys().collect::<Vec<_>>(), expected.facets.keys().collect::<Vec<_>>());
    for (a, b) in found.facets.values().zip(expected.facets.values()) {
        assert_eq!(a.len(), b.len());
        for ((element, a), (other, b)) in a.facets().zip(b.facets()) {
            assert_eq!(element.name, other.name);
            let (mut a, mut b) = (at(found, a), at(expected, b));
            a.sort_by(|p, q| p.partial_cmp(q).expect("finite"));
            b.sort_by(|p, q| p.partial_cmp(q).expect("finite"));
            assert_eq!(a, b);
        }
        let ((area, _, flux), (_, _, other)) = (side(found, a), side(expected, b));
        assert!((flux - other).abs() < 1e-13 * (1.0 + area), "{flux} {other}");
    }
}
