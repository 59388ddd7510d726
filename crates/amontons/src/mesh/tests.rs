//! Tests of meshes against closed forms: measures, sides, normals, convergence orders of curved boundaries.

use std::collections::BTreeSet;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::*;
use crate::tensor::{Rotation, dot};

const EVERY: [Elements; 4] = [Elements::P1, Elements::P2, Elements::Q1, Elements::Q2];

/// ∫ f over the body.
fn volume_integral(mesh: &Mesh, f: impl Fn(&Point) -> f64) -> f64 {
    let mut sum = 0.0;
    for block in &mesh.blocks {
        let table = ShapeTable::new(block.element, 2 * block.element.degree + 2);
        let mut map = CellMap::new(mesh, &table);
        for cell in block.cells() {
            for (q, weight) in table.weights.iter().enumerate() {
                map.at(cell, q);
                sum += weight * map.measure * f(&map.position);
            }
        }
    }
    sum
}

/// ∫ f(x, ν) over a set of facets.
fn surface_integral(mesh: &Mesh, set: &FacetSet, f: impl Fn(&Point, &Point) -> f64) -> f64 {
    let mut sum = 0.0;
    for block in &set.blocks {
        let table = ShapeTable::new(block.element, 2 * block.element.degree + 2);
        let mut map = FacetMap::new(mesh, &table);
        for facet in block.nodes.chunks_exact(block.element.nodes.len()) {
            for (q, weight) in table.weights.iter().enumerate() {
                map.at(facet, q);
                sum += weight * map.area * f(&map.position, &map.normal);
            }
        }
    }
    sum
}

/// The sides are the whole boundary; by Gauss' theorem the flux of x through it is d |Ω|, so all normals point outward.
fn assert_closed(mesh: &Mesh, what: &str) {
    mesh.check().unwrap_or_else(|e| panic!("{what}: {e}"));
    assert_eq!(mesh.unnamed_boundary_facets(), 0, "{what}");
    let boundary = mesh.boundary();
    assert_eq!(boundary.len(), mesh.facets.values().map(FacetSet::len).sum::<usize>(), "{what}: facets of the sides");
    let volume = volume_integral(mesh, |_| 1.0);
    let flux = |set: &FacetSet| surface_integral(mesh, set, dot);
    let sides: f64 = mesh.facets.values().map(flux).sum();
    for found in [flux(&boundary), sides] {
        assert!((found - mesh.dim as f64 * volume).abs() < 1e-12 * volume, "{what}: flux {found}, volume {volume}");
    }
}

#[test]
fn intervals_rectangles_and_boxes_have_their_measures() -> Result<(), MeshError> {
    for elements in EVERY {
        let what = format!("{elements:?}");
        let line = Mesh::interval(2.5, 7, elements)?;
        assert_closed(&line, &what);
        assert_eq!(
            (line.points.len(), line.facets["left"].node_list(), line.facets["right"].node_list()),
            (7 * elements.degree() + 1, vec![0], vec![7])
        );
        assert!((volume_integral(&line, |x| x[0] * x[0]) - 2.5f64.powi(3) / 3.0).abs() < 1e-13);

        let plane = Mesh::rectangle_of(elements, [2.0, 3.0], [4, 5], Diagonal::Right)?;
        assert_closed(&plane, &what);
        assert_eq!(plane.points.len(), (4 * elements.degree() + 1) * (5 * elements.degree() + 1));
        assert!((volume_integral(&plane, |x| x[0] * x[1]) - 9.0).abs() < 1e-12);
        for (side, length, normal) in [
            ("left", 3.0, [-1.0, 0.0]),
            ("right", 3.0, [1.0, 0.0]),
            ("bottom", 2.0, [0.0, -1.0]),
            ("top", 2.0, [0.0, 1.0]),
        ] {
            let found = surface_integral(&plane, &plane.facets[side], |_, n| n[0] * normal[0] + n[1] * normal[1]);
            assert!((found - length).abs() < 1e-13, "{what} {side}");
        }

        let body = Mesh::box_([2.0, 3.0, 0.5], [3, 4, 2], elements)?;
        assert_closed(&body, &what);
        assert_eq!(body.cell_count(), 24 * if elements.are_simplices() { 6 } else { 1 });
        assert_eq!(body.points.len(), [3, 4, 2].iter().map(|n| n * elements.degree() + 1).product::<usize>());
        assert!((volume_integral(&body, |x| x[0] * x[1] * x[2]) - 1.125).abs() < 1e-12);
        for (side, area, normal) in
            [("left", 1.5, [-1.0, 0.0, 0.0]), ("right", 1.5, [1.0, 0.0, 0.0]), ("bottom", 1.0, [0.0, -1.0, 0.0])]
        {
            assert!(
                (surface_integral(&body, &body.facets[side], |_, n| dot(n, &normal)) - area).abs() < 1e-13,
                "{what} {side}"
            );
        }
        for (side, normal) in [("top", [0.0, 1.0, 0.0]), ("back", [0.0, 0.0, -1.0]), ("front", [0.0, 0.0, 1.0])] {
            let area = if side == "top" { 1.0 } else { 6.0 };
            assert!(
                (surface_integral(&body, &body.facets[side], |_, n| dot(n, &normal)) - area).abs() < 1e-13,
                "{what} {side}"
            );
        }
    }
    Ok(())
}

/// Convergence order from the errors of a refinement by two.
fn slope(errors: [f64; 2]) -> f64 {
    (errors[0] / errors[1]).log2()
}

/// Areas and lengths of round bodies converge like their boundary: with order 2 for linear sides, 4 for quadratic ones.
#[test]
fn round_bodies_converge_to_their_measures() -> Result<(), MeshError> {
    for elements in EVERY {
        let order = 2.0 * elements.degree() as f64;
        let discs = [1, 2].map(|f| Mesh::disc(2.0, [2 * f, 16 * f], elements));
        let rings = [1, 2].map(|f| Mesh::ring([1.0, 2.0], None, [2 * f, 16 * f], elements));
        let sectors = [1, 2].map(|f| Mesh::ring([1.0, 2.0], Some(1.3), [2 * f, 4 * f], elements));
        let solids = [1, 2].map(|f| Mesh::cylinder([0.0, 2.0], None, 0.5, [2 * f, 16 * f, 1], elements));
        let hollows = [1, 2].map(|f| Mesh::cylinder([1.0, 2.0], None, 0.5, [2 * f, 16 * f, 1], elements));
        let arcs = [TAU * 2.0, TAU, TAU * 2.0, 1.3, 2.6, PI * 2.0, PI, PI * 2.0];
        let exact = [(discs, 4.0 * PI), (rings, 3.0 * PI), (sectors, 1.95), (solids, 2.0 * PI), (hollows, 1.5 * PI)];
        let mut arc = arcs.iter();
        for (k, (meshes, volume)) in exact.into_iter().enumerate() {
            let what = format!("{elements:?} body {k}");
            let [coarse, fine] = meshes;
            let meshes = [coarse?, fine?];
            for mesh in &meshes {
                assert_closed(mesh, &what);
            }
            let errors = [0, 1].map(|i| (volume_integral(&meshes[i], |_| 1.0) - volume).abs());
            assert!((slope(errors) - order).abs() < 0.15, "{what}: errors of the volume {errors:?}");
            for name in ["inner", "outer"].into_iter().filter(|name| meshes[0].facets.contains_key(*name)) {
                let exact = match (k, name) {
                    (0 | 1, "outer") => 2.0 * TAU,
                    (1, _) => TAU,
                    (2, "outer") => 2.6,
                    (2, _) => 1.3,
                    (_, "outer") => TAU,
                    _ => PI,
                };
                arc.next();
                let errors =
                    [0, 1].map(|i| (surface_integral(&meshes[i], &meshes[i].facets[name], |_, _| 1.0) - exact).abs());
                assert!((slope(errors) - order).abs() < 0.15, "{what}: errors of the side {name} {errors:?}");
                // Every node of the side lies on the circle.
                let radius = if name == "outer" { 2.0 } else { 1.0 };
                let off = |mesh: &Mesh| {
                    mesh.facets[name]
                        .node_list()
                        .iter()
                        .map(|&n| (mesh.points[n as usize][0].hypot(mesh.points[n as usize][1]) - radius).abs())
                        .fold(0.0, f64::max)
                };
                assert!(off(&meshes[0]) < 1e-15 * 4.0, "{what} {name}");
            }
        }
    }
    Ok(())
}

/// A sector of a cylinder is bounded by its sides: six areas, and a volume that converges with the arcs.
#[test]
fn a_sector_of_a_cylinder_has_six_sides() -> Result<(), MeshError> {
    for elements in EVERY {
        let mesh = Mesh::cylinder([1.0, 2.0], Some(1.2), 0.5, [2, 12, 3], elements)?;
        assert_closed(&mesh, "a sector");
        let sides = [("start", 0.5), ("end", 0.5), ("bottom", 1.8), ("top", 1.8), ("inner", 0.6), ("outer", 1.2)];
        assert_eq!(mesh.facets.len(), sides.len());
        for (side, area) in sides {
            let found = mesh.measure(&mesh.facets[side]);
            assert!((found - area).abs() < 2e-3 * area, "{elements:?}: {side} has {found}, expected {area}");
        }
        assert!((volume_integral(&mesh, |_| 1.0) - 0.9).abs() < 2e-3, "{elements:?}");
    }
    let none = Mesh::cylinder([0.0, 1.0], Some(1.2), 1.0, [1, 4, 1], Elements::P1);
    assert!(matches!(none, Err(MeshError::Size { direction: 0, .. })), "{none:?}");
    let whole = Mesh::cylinder([1.0, 2.0], Some(7.0), 1.0, [1, 4, 1], Elements::P1);
    assert!(matches!(whole, Err(MeshError::Angle { .. })), "{whole:?}");
    Ok(())
}

/// The ends of a sector are straight with the right normals.
#[test]
fn ends_of_a_sector() -> Result<(), MeshError> {
    let mesh = Mesh::ring([1.0, 3.0], Some(PI / 2.0), [3, 4], Elements::Q2)?;
    for (side, normal) in [("start", [0.0, -1.0, 0.0]), ("end", [-1.0, 0.0, 0.0])] {
        assert!((surface_integral(&mesh, &mesh.facets[side], |_, n| dot(n, &normal)) - 2.0).abs() < 1e-14, "{side}");
    }
    Ok(())
}

/// A body of revolution given by its half section: a solid cylinder, and the moment ∫ r.
#[test]
fn bodies_of_revolution() -> Result<(), MeshError> {
    for elements in EVERY {
        let mesh = Mesh { axisymmetric: true, ..Mesh::rectangle_of(elements, [2.0, 0.5], [5, 2], Diagonal::Left)? };
        mesh.check()?;
        assert!((volume_integral(&mesh, |_| 1.0) - TAU).abs() < 1e-13);
        assert!((volume_integral(&mesh, |x| x[0]) - TAU * 4.0 / 3.0).abs() < 1e-13);
        assert!((surface_integral(&mesh, &mesh.facets["right"], |_, n| n[0]) - TAU).abs() < 1e-13);
        assert!((surface_integral(&mesh, &mesh.facets["top"], |_, n| n[1]) - 4.0 * PI).abs() < 1e-13);
        let mut beyond = mesh;
        beyond.points[0][0] = -0.1;
        assert_eq!(beyond.check(), Err(MeshError::Axis { node: 0, found: -0.1 }));
    }
    Ok(())
}

/// A half ring turned onto the axis reaches it up to round-off: its nodes are moved onto the axis, for any size and any
/// rotation, and its volume is unchanged. A body that extends beyond the axis is refused.
#[test]
fn turned_bodies_of_revolution_reach_their_axis() -> Result<(), MeshError> {
    let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed >> 11) as f64 / (1u64 << 53) as f64
    };
    let about = |angle: f64| Rotation::about(&[0.0, 0.0, 1.0], angle);
    for elements in EVERY {
        let mut volume: Option<f64> = None;
        for _ in 0..40 {
            let size = 10f64.powf(12.0 * random() - 6.0);
            let (angle, shift) = (TAU * random(), size * (random() - 0.5));
            let ring = Mesh::ring([0.5 * size, size], Some(PI), [2, 6], elements)?;
            let ends: BTreeSet<u32> =
                ["start", "end"].into_iter().flat_map(|side| ring.facets[side].node_list()).collect();
            // Turned by any angle and back, and by a right angle more.
            let turned = ring.turned(&about(angle)).turned(&about(-angle - FRAC_PI_2)).moved([0.0, shift, 0.0]);
            let mesh = Mesh { axisymmetric: true, ..turned };
            mesh.check()?;
            let mesh = mesh.onto_axis();
            mesh.check()?;
            let on_axis: BTreeSet<u32> =
                (0..).zip(&mesh.points).filter(|(_, x)| x[0] == 0.0).map(|(node, _)| node).collect();
            assert_eq!(on_axis, ends);
            let found = volume_integral(&mesh, |_| 1.0) / size.powi(3);
            assert!((found / *volume.get_or_insert(found) - 1.0).abs() < 1e-11, "{elements:?}: {found}");
            for beyond in [1e-9, 1e-3] {
                let moved = mesh.clone().moved([-beyond * size, 0.0, 0.0]).onto_axis();
                assert!(matches!(moved.check(), Err(MeshError::Axis { .. })), "{beyond}");
                // Nodes next to the axis stay there.
                let beside = mesh.clone().moved([beyond * size, 0.0, 0.0]).onto_axis();
                assert!(beside.points.iter().all(|x| x[0] > 0.0), "{beyond}");
            }
        }
    }
    Ok(())
}

#[test]
fn spacing_is_that_of_the_cells() -> Result<(), MeshError> {
    for elements in EVERY {
        let mesh = Mesh::rectangle_of(elements, [1.0, 1.0], [4, 4], Diagonal::Right)?;
        assert!((mesh.spacing() - 0.25).abs() < 1e-15 && (mesh.h() - 0.25 * 2f64.sqrt()).abs() < 1e-15);
        let mesh = Mesh::box_([1.0, 1.0, 1.0], [4, 4, 4], elements)?;
        assert!((mesh.spacing() - 0.25).abs() < 1e-15 && (mesh.h() - 0.25 * 3f64.sqrt()).abs() < 1e-15);
    }
    Ok(())
}

#[test]
fn bad_numbers_are_named() {
    assert!(matches!(Mesh::rectangle([1.0, -1.0], [1, 1], Diagonal::Right), Err(MeshError::Size { direction: 1, .. })));
    assert!(matches!(Mesh::rectangle([1.0, f64::NAN], [1, 1], Diagonal::Right), Err(MeshError::Size { .. })));
    assert!(matches!(Mesh::rectangle([1.0, 1.0], [0, 1], Diagonal::Right), Err(MeshError::Cells { direction: 0, .. })));
    assert!(matches!(
        Mesh::rectangle([1.0, 1.0], [1 << 20, 1 << 20], Diagonal::Right),
        Err(MeshError::TooLarge { .. })
    ));
    assert!(matches!(Mesh::interval(f64::INFINITY, 1, Elements::P1), Err(MeshError::Size { direction: 0, .. })));
    assert!(matches!(Mesh::interval(1.0, 0, Elements::P1), Err(MeshError::Cells { direction: 0, found: 0 })));
    assert!(matches!(Mesh::box_([1.0, 1.0, 0.0], [1, 1, 1], Elements::P1), Err(MeshError::Size { direction: 2, .. })));
    assert!(matches!(Mesh::box_([1.0; 3], [1, 1, 0], Elements::Q1), Err(MeshError::Cells { direction: 2, .. })));
    assert!(matches!(Mesh::box_([1.0; 3], [2000; 3], Elements::Q1), Err(MeshError::TooLarge { .. })));
    assert!(matches!(Mesh::disc(1.0, [2, 6], Elements::P1), Err(MeshError::Around { found: 6, .. })));
    assert!(matches!(Mesh::ring([2.0, 1.0], None, [2, 6], Elements::P1), Err(MeshError::Radii { .. })));
    assert!(matches!(Mesh::ring([1.0, 2.0], Some(7.0), [2, 6], Elements::P1), Err(MeshError::Angle { .. })));
    assert!(matches!(Mesh::ring([1.0, 2.0], None, [2, 2], Elements::P1), Err(MeshError::Around { found: 2, .. })));
    assert!(matches!(
        Mesh::cylinder([0.0, 1.0], None, -1.0, [1, 4, 1], Elements::P1),
        Err(MeshError::Size { direction: 2, .. })
    ));
    assert!(matches!(Mesh::cylinder([f64::NAN, 1.0], None, 1.0, [1, 4, 1], Elements::P1), Err(MeshError::Size { .. })));
}

/// A cell that is inverted, flat, or folded at only one of its points is found.
#[test]
fn inverted_and_folded_cells_are_named() -> Result<(), MeshError> {
    let mut mesh = Mesh::rectangle([1.0, 1.0], [2, 2], Diagonal::Right)?;
    mesh.blocks[0].nodes.swap(0, 1);
    assert!(matches!(mesh.check(), Err(MeshError::Cell { block: 0, cell: 0, .. })));
    let mut mesh = Mesh::box_([1.0; 3], [2, 2, 2], Elements::P1)?;
    let n = mesh.blocks[0].nodes[8..12].to_vec();
    for d in 0..3 {
        // Moves the last vertex into the plane of the others.
        mesh.points[n[3] as usize][d] =
            (mesh.points[n[0] as usize][d] + mesh.points[n[1] as usize][d] + mesh.points[n[2] as usize][d]) / 3.0;
    }
    assert!(matches!(mesh.check(), Err(MeshError::Cell { .. })));
    // A middle node within the first quarter of the edge folds a quadratic triangle near one vertex.
    let mut mesh = Mesh::rectangle_of(Elements::P2, [1.0, 1.0], [1, 1], Diagonal::Right)?;
    let middle = mesh.blocks[0].nodes[3] as usize;
    mesh.points[middle][0] = 0.05;
    assert!(matches!(mesh.check(), Err(MeshError::Cell { block: 0, cell: 0, .. })));
    Ok(())
}

/// A handmade mesh whose cells or facets refer to a missing node is refused before any other check.
#[test]
fn nodes_that_there_are_not_are_named() -> Result<(), MeshError> {
    let sound = Mesh::rectangle([1.0, 1.0], [2, 2], Diagonal::Right)?;
    let (mut cell, mut facet) = (sound.clone(), sound.clone());
    cell.blocks[0].nodes[4] = 99;
    let Some(set) = facet.facets.get_mut("top") else { panic!("a top") };
    set.blocks[0].nodes[0] = 9;
    let text = |mesh: &Mesh| mesh.check().err().map(|error| error.to_string());
    assert_eq!(text(&sound), None);
    assert_eq!(text(&cell).as_deref(), Some("a cell names node 99, expected one below 9, the number of nodes"));
    assert_eq!(
        text(&facet).as_deref(),
        Some("a facet of \"top\" names node 9, expected one below 9, the number of nodes")
    );
    Ok(())
}
