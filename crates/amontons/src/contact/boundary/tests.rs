//! Weights, normals and exactness of the contact points of foundations.

use super::*;
use crate::mesh::{Diagonal, Elements, MeshError};

const EVERY: [Elements; 4] = [Elements::P1, Elements::P2, Elements::Q1, Elements::Q2];

#[test]
fn weights_sum_to_the_length_and_corners_have_half() -> Result<(), MeshError> {
    let mesh = Mesh::rectangle([2.0, 1.0], [8, 2], Diagonal::Right)?;
    for quadrature in [Quadrature::Nodal, Quadrature::Gauss] {
        let boundary = ContactBoundary::new(&mesh, &mesh.facets["bottom"], quadrature);
        let sum: f64 = boundary.points.iter().map(|p| p.weight).sum();
        assert!((sum - 2.0).abs() < 1e-14);
        assert!(boundary.points.iter().all(|p| (p.normal[1] + 1.0).abs() < 1e-15));
        assert_eq!(boundary.points.len(), if quadrature == Quadrature::Nodal { 9 } else { 16 });
    }
    let nodal = ContactBoundary::new(&mesh, &mesh.facets["bottom"], Quadrature::Nodal);
    assert!((nodal.points[0].weight - 0.125).abs() < 1e-15 && (nodal.points[1].weight - 0.25).abs() < 1e-15);
    Ok(())
}

/// Weights are positive and sum to the area, and linear functions are integrated exactly on every kind of flat facet;
/// the Gauss points are exact for squares of the shape functions.
#[test]
fn both_quadratures_are_exact_for_linear_functions() -> Result<(), MeshError> {
    for elements in EVERY {
        let line = Mesh::interval(2.0, 3, elements)?;
        let plane = Mesh::rectangle_of(elements, [2.0, 1.0], [3, 2], Diagonal::Left)?;
        let body = Mesh::box_([2.0, 1.0, 3.0], [3, 1, 2], elements)?;
        // ∫ 1, ∫ x, ∫ z over the end x = 2 of the line and over the bottom of the others.
        for (mesh, side, exact) in
            [(line, "right", [1.0, 2.0, 0.0]), (plane, "bottom", [2.0, 2.0, 0.0]), (body, "bottom", [6.0, 6.0, 9.0])]
        {
            for quadrature in [Quadrature::Nodal, Quadrature::Gauss] {
                let boundary = ContactBoundary::new(&mesh, &mesh.facets[side], quadrature);
                assert!(boundary.points.iter().all(|p| p.weight > 0.0));
                let normal = if mesh.dim == 1 { [1.0, 0.0, 0.0] } else { [0.0, -1.0, 0.0] };
                assert!(boundary.points.iter().all(|p| (0..3).all(|d| (p.normal[d] - normal[d]).abs() < 1e-14)));
                let sum = |f: &dyn Fn(&Point) -> f64| boundary.points.iter().map(|p| p.weight * f(&p.x)).sum::<f64>();
                for (found, expected) in [sum(&|_| 1.0), sum(&|x| x[0]), sum(&|x| x[2])].into_iter().zip(exact) {
                    assert!(
                        (found - expected).abs() < 1e-13,
                        "{elements:?} {quadrature:?} d = {}: {found}, expected {expected}",
                        mesh.dim
                    );
                }
                if quadrature == Quadrature::Gauss && mesh.dim == 3 {
                    assert!((sum(&|x| x[0] * x[0]) - 8.0).abs() < 1e-12);
                }
                // The values at a point sum to one and reproduce its position.
                for point in &boundary.points {
                    let x: f64 = point.nodes.iter().map(|&(i, v)| v * mesh.points[boundary.nodes[i] as usize][0]).sum();
                    assert!((x - point.x[0]).abs() < 1e-14);
                }
            }
        }
    }
    Ok(())
}

/// Weights of Simpson's rule, and of the rule with the edge middles.
#[test]
fn weights_of_quadratic_facets() -> Result<(), MeshError> {
    let weights = |mesh: &Mesh, side: &str| -> Vec<f64> {
        let mut weights: Vec<f64> =
            ContactBoundary::new(mesh, &mesh.facets[side], Quadrature::Nodal).points.iter().map(|p| p.weight).collect();
        weights.sort_by(f64::total_cmp);
        weights
    };
    let assert_near = |found: Vec<f64>, expected: Vec<f64>| {
        assert!(
            found.len() == expected.len() && found.iter().zip(&expected).all(|(f, e)| (f - e).abs() < 1e-15),
            "{found:?}, expected {expected:?}"
        );
    };
    assert_near(
        weights(&Mesh::rectangle_of(Elements::P2, [1.0, 1.0], [1, 1], Diagonal::Right)?, "bottom"),
        vec![1.0 / 6.0, 1.0 / 6.0, 2.0 / 3.0],
    );
    let face = [vec![1.0 / 36.0; 4], vec![1.0 / 9.0; 4], vec![4.0 / 9.0]].concat();
    assert_near(weights(&Mesh::box_([1.0; 3], [1, 1, 1], Elements::Q2)?, "bottom"), face);
    // Two triangles of area 1/2 give a third of it to each edge middle; the diagonal belongs to both.
    let face = [vec![1.0 / 6.0; 4], vec![1.0 / 3.0]].concat();
    assert_near(weights(&Mesh::box_([1.0; 3], [1, 1, 1], Elements::P2)?, "bottom"), face);
    Ok(())
}

/// The patch test of contact: on flat sides the weights are the loads of a uniform pressure, ∫ N_i, with both
/// quadratures.
#[test]
fn a_uniform_pressure_is_its_consistent_load() -> Result<(), MeshError> {
    for elements in EVERY {
        for (mesh, side) in [
            (Mesh::rectangle_of(elements, [2.0, 1.0], [3, 2], Diagonal::Left)?, "bottom"),
            (Mesh::box_([2.0, 1.0, 3.0], [3, 1, 2], elements)?, "bottom"),
            (
                Mesh { axisymmetric: true, ..Mesh::rectangle_of(elements, [2.0, 1.0], [3, 2], Diagonal::Left)? },
                "bottom",
            ),
        ] {
            let set = &mesh.facets[side];
            let mut load = vec![0.0; mesh.points.len()];
            for block in &set.blocks {
                let table = ShapeTable::new(block.element, 6);
                let mut map = FacetMap::new(&mesh, &table);
                for facet in block.nodes.chunks_exact(block.element.nodes.len()) {
                    for q in 0..table.len() {
                        map.at(facet, q);
                        for (&node, value) in facet.iter().zip(map.values()) {
                            load[node as usize] += table.weights[q] * map.area * value;
                        }
                    }
                }
            }
            for quadrature in [Quadrature::Nodal, Quadrature::Gauss] {
                let boundary = ContactBoundary::new(&mesh, set, quadrature);
                let mut found = vec![0.0; mesh.points.len()];
                for point in &boundary.points {
                    for &(node, value) in &point.nodes {
                        found[boundary.nodes[node] as usize] += point.weight * value;
                    }
                }
                for (node, (found, load)) in found.iter().zip(&load).enumerate() {
                    let of = format!(
                        "{elements:?}, d = {}, axisymmetric: {}, {quadrature:?}, node {node}",
                        mesh.dim, mesh.axisymmetric
                    );
                    assert!((found - load).abs() < 1e-13, "{of}: {found}, expected {load}");
                }
            }
        }
    }
    Ok(())
}

/// On a cylinder the weights sum to the area, and the normals converge to the radial direction at order 2 or
/// better.
#[test]
fn curved_contact() -> Result<(), MeshError> {
    for elements in [Elements::P2, Elements::Q2] {
        for quadrature in [Quadrature::Nodal, Quadrature::Gauss] {
            let mut errors = Vec::new();
            for around in [16, 32] {
                let mesh = Mesh::cylinder([1.0, 2.0], None, 1.0, [1, around, around / 16], elements)?;
                let boundary = ContactBoundary::new(&mesh, &mesh.facets["outer"], quadrature);
                assert!(boundary.points.iter().all(|p| p.weight > 0.0));
                let area: f64 = boundary.points.iter().map(|p| p.weight).sum();
                let off = |p: &PointOnBoundary| {
                    let r = p.x[0].hypot(p.x[1]);
                    (p.normal[0] - p.x[0] / r).hypot(p.normal[1] - p.x[1] / r).hypot(p.normal[2])
                };
                errors.push([
                    (area - 4.0 * std::f64::consts::PI).abs(),
                    boundary.points.iter().map(off).fold(0.0, f64::max),
                ]);
            }
            let [area, normal] = [0, 1].map(|i| (errors[0][i] / errors[1][i]).log2());
            assert!(
                area > 3.85 && (errors[1][1] < 1e-13 || normal > 1.85),
                "{elements:?} {quadrature:?}: orders {area}, {normal}; {errors:?}"
            );
        }
    }
    Ok(())
}
