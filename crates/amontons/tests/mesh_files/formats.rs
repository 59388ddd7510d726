//! The same mesh in every variant of the format.

use amontons::mesh::{Diagonal, Elements, Mesh, gmsh};

use super::writer::{Format, write};
use super::{assert_same, prisms, region, side, two_regions};

fn bodies() -> Vec<Mesh> {
    let linear_prisms = prisms();
    vec![
        two_regions(),
        Mesh::interval(1.5, 5, Elements::P1).expect("a mesh"),
        Mesh::interval(1.5, 5, Elements::P2).expect("a mesh"),
        Mesh::rectangle_of(Elements::P2, [1.0, 2.0], [3, 2], Diagonal::Crossed).expect("a mesh"),
        Mesh::rectangle_of(Elements::Q2, [1.0, 2.0], [3, 2], Diagonal::Right).expect("a mesh"),
        Mesh::ring([0.5, 1.0], Some(1.0), [2, 3], Elements::Q2).expect("a mesh"),
        Mesh::box_([1.0, 2.0, 3.0], [2, 2, 1], Elements::P1).expect("a mesh"),
        Mesh::box_([1.0, 2.0, 3.0], [1, 1, 2], Elements::P2).expect("a mesh"),
        Mesh::box_([1.0, 2.0, 3.0], [2, 1, 1], Elements::Q1).expect("a mesh"),
        Mesh::box_([1.0, 2.0, 3.0], [2, 1, 1], Elements::Q2).expect("a mesh"),
        linear_prisms.quadratic().expect("a mesh"),
        linear_prisms,
        super::files::read("pyramid5.e"),
        super::files::read("pyramid14.e"),
    ]
}

#[test]
fn every_variant_reads_back_to_the_same_mesh() {
    for mesh in bodies() {
        for format in Format::all() {
            if format.step > 1 && mesh.points.len() % 7 == 0 {
                continue;
            }
            let read = gmsh::parse(&write(&mesh, format)).unwrap_or_else(|e| panic!("{format:?}: {e}"));
            assert_same(&read, &mesh);
        }
    }
}

#[test]
fn facets_are_turned_outward_and_mirrored_blocks_turned_over() {
    for mesh in bodies() {
        let mut turned = mesh.clone();
        for set in turned.facets.values_mut() {
            for block in set.blocks.iter_mut().filter(|b| b.element.degree == 1) {
                block.nodes.chunks_exact_mut(block.element.nodes.len()).for_each(<[u32]>::reverse);
            }
        }
        // A mirrored body: every cell is inverted.
        turned.points.iter_mut().for_each(|p| p[0] = -p[0]);
        let read =
            gmsh::parse(&write(&turned, Format { version: 4, binary: None, step: 1, spread: 1 })).expect("a mesh");
        read.check().expect("no cell is inverted");
        let flux: f64 = read.facets.values().map(|set| side(&read, set).2).sum();
        let measure: f64 = mesh.regions.iter().map(|name| region(&mesh, name).0).sum();
        assert!((flux - mesh.dim as f64 * measure).abs() < 1e-13 * measure * 10.0, "{flux} {measure}");
    }
}

#[test]
fn scaling_multiplies_lengths() {
    let mesh = Mesh::rectangle([2000.0, 1000.0], [2, 2], Diagonal::Right).expect("a mesh").scaled(1e-3);
    assert!((region(&mesh, "body").0 - 2.0).abs() < 1e-14);
}

#[test]
fn without_groups_there_is_one_body_with_the_sides_of_its_curves() {
    let mesh = Mesh::rectangle([2.0, 1.0], [2, 2], Diagonal::Right).expect("a mesh");
    let text = String::from_utf8(write(&mesh, Format { version: 2, binary: None, step: 1, spread: 1 })).expect("text");
    // No groups: the physical tag is 0.
    let bare: String = text
        .lines()
        .map(|line| {
            let words: Vec<&str> = line.split_whitespace().collect();
            if words.len() >= 6 && words[2] == "2" {
                format!("{} {} 2 0 {}\n", words[0], words[1], words[4..].join(" "))
            } else {
                format!("{line}\n")
            }
        })
        .collect();
    let read = gmsh::parse(bare.as_bytes()).expect("a mesh");
    assert_eq!(read.regions, ["body"]);
    assert_eq!(read.facets.keys().collect::<Vec<_>>(), ["curve-1", "curve-2", "curve-3", "curve-4"]);
    let whole: f64 = read.facets.values().map(|set| side(&read, set).0).sum();
    assert!((whole - 6.0).abs() < 1e-13);
    // Groups without names are called by their tags.
    let at = text.find("$PhysicalNames").expect("names");
    let end = text.find("$EndPhysicalNames").expect("names") + "$EndPhysicalNames".len();
    let read = gmsh::parse(format!("{}{}", &text[..at], &text[end..]).as_bytes()).expect("a mesh");
    assert_eq!(read.regions, ["1"]);
    assert_eq!(read.facets.keys().collect::<Vec<_>>(), ["1", "2", "3", "4"]);
}
