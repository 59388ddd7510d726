//! Γ_C on a mesh: contact points with their normals, weights and gaps.

use std::sync::Arc;

use super::{FrictionLaw, HeatLaw, NormalLaw};
use crate::element::MAX_NODES;
use crate::field::Field;
use crate::mesh::{FacetMap, FacetSet, Mesh};
use crate::quadrature::{gauss_legendre, rule};
use crate::tensor::Point;

/// Where the integrals over Γ_C are evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Quadrature {
    /// At the nodes, with weights ω_i = ∫ N_i: each contact node obeys the laws on its own.
    #[default]
    Nodal,
    /// At Gauss points of each facet, two for P1 segments: the laws hold at each point.
    Gauss,
}

/// Contact of one part of the boundary with the foundation.
#[derive(Clone, Debug)]
pub struct Contact {
    /// Name of the facet set that is Γ_C.
    pub on: String,
    /// g in m.
    pub gap: Field,
    /// Where the laws are evaluated.
    pub quadrature: Quadrature,
    /// p_ν.
    pub normal: Arc<dyn NormalLaw>,
    /// p_τ.
    pub friction: Arc<dyn FrictionLaw>,
    /// k_c and φ_L.
    pub heat: Arc<dyn HeatLaw>,
    /// θ_F in K.
    pub foundation_temperature: Field,
}

/// A point of Γ_C at which the laws are evaluated.
#[derive(Clone, Debug)]
pub struct PointOnBoundary {
    /// Position in m.
    pub x: Point,
    /// Unit outward normal ν.
    pub normal: Point,
    /// Weight ω in m^(d−1).
    pub weight: f64,
    /// Contact nodes (indices into [`ContactBoundary::nodes`]) with the value of their shape function here.
    pub nodes: Vec<(usize, f64)>,
}

/// Γ_C on a mesh.
#[derive(Clone, Debug)]
pub struct ContactBoundary {
    /// Mesh nodes of Γ_C, ascending.
    pub nodes: Vec<u32>,
    /// The points of the quadrature.
    pub points: Vec<PointOnBoundary>,
}

impl ContactBoundary {
    /// Places the contact points on a facet set.
    #[must_use]
    pub fn new(mesh: &Mesh, set: &FacetSet, quadrature: Quadrature) -> ContactBoundary {
        let nodes = set.node_list();
        let local = |node: u32| nodes.binary_search(&node).unwrap_or_else(|slot| slot);
        let points = match quadrature {
            Quadrature::Nodal => nodal_points(mesh, set, &nodes, local),
            Quadrature::Gauss => gauss_points(mesh, set, local),
        };
        ContactBoundary { nodes, points }
    }
}

/// A point a node: weight ∫ N_i, and the normal of the weighted sum over the facets that meet there.
fn nodal_points(mesh: &Mesh, set: &FacetSet, nodes: &[u32], local: impl Fn(u32) -> usize) -> Vec<PointOnBoundary> {
    let mut points: Vec<PointOnBoundary> =
        nodes.iter().enumerate().map(|(i, &n)| PointOnBoundary { x: mesh.points[n as usize], normal: [0.0; 3], weight: 0.0, nodes: vec![(i, 1.0)] }).collect();
    let quadrature = rule(set.element.shape, set.element.degree);
    for facet in set.facets() {
        for (at, weight) in quadrature.iter() {
            let map = FacetMap::new(mesh, set.element, facet, at);
            for (n, &node) in facet.iter().enumerate() {
                let share = weight * map.area * map.values[n];
                let point = &mut points[local(node)];
                point.weight += share;
                for d in 0..3 {
                    point.normal[d] += share * map.normal[d];
                }
            }
        }
    }
    for point in &mut points {
        let length = crate::tensor::length(&point.normal);
        point.normal = point.normal.map(|c| c / length);
    }
    points
}

fn gauss_points(mesh: &Mesh, set: &FacetSet, local: impl Fn(u32) -> usize) -> Vec<PointOnBoundary> {
    let line = gauss_legendre(set.element.degree + 1);
    let mut points = Vec::new();
    for facet in set.facets() {
        for &(s, weight) in &line {
            let map = FacetMap::new(mesh, set.element, facet, &[s, 0.0, 0.0]);
            let nodes = facet.iter().take(MAX_NODES).enumerate().map(|(n, &node)| (local(node), map.values[n])).collect();
            points.push(PointOnBoundary { x: map.position, normal: map.normal, weight: weight * map.area, nodes });
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Diagonal, MeshError};

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
}
