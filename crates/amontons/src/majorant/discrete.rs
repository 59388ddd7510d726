//! The tractions of the discrete stress on the facets of its cells.

use super::composite::{SimplexMap, volume};
use super::skeleton::Skeleton;
use super::stress::{StepLaws, StepMotion};
use crate::mesh::{CellMap, FacetMap};
use crate::tensor::{Point, Sym, length};

/// The discrete stress of a cell as tractions see it.
#[derive(Clone, Debug)]
pub(super) struct CellStress {
    /// Moments ∫_F σν φ per facet and vertex of the facet, in the order of the facet, N.
    pub moments: [[Point; 4]; 6],
    /// Areas of the facets, m².
    pub areas: [f64; 6],
    /// ∫ σ, N m; zero in quadrilaterals and hexahedra.
    pub total: Sym,
    /// True if the stress is linear in a simplex: it is the composite stress with these data.
    pub is_linear: bool,
}

impl CellStress {
    /// The stress of a cell.
    pub fn new(laws: &StepLaws, skeleton: &Skeleton, motion: &StepMotion, cell: usize) -> CellStress {
        if laws.is_linear(skeleton, cell, motion) {
            return CellStress::of_linear(laws, skeleton, motion, cell);
        }
        let (mut moments, mut areas) = ([[[0.0; 3]; 4]; 6], [0.0; 6]);
        for local in 0..skeleton.cells[cell].facets.len() {
            (moments[local], areas[local]) = traction(laws, skeleton, (cell, local), motion);
        }
        let mut total = Sym::ZERO;
        let tables = skeleton.tables(cell);
        if tables.element.is_simplex() {
            let (region, nodes) = (laws.region(skeleton, cell), skeleton.nodes(laws.mesh, cell));
            laws.integrate(&tables.body, nodes, |map, weight| {
                total += weight * laws.at(region, map, nodes, motion);
            });
        }
        CellStress { moments, areas, total, is_linear: false }
    }

    /// The stress of a simplex that is linear there, from its values at the vertices.
    fn of_linear(laws: &StepLaws, skeleton: &Skeleton, motion: &StepMotion, cell: usize) -> CellStress {
        let (mesh, tables) = (laws.mesh, skeleton.tables(cell));
        let (nodes, region, dim) = (skeleton.nodes(mesh, cell), laws.region(skeleton, cell), mesh.dim);
        let vertices: [Point; 4] = std::array::from_fn(|v| mesh.points[nodes[v.min(dim)] as usize]);
        let map = SimplexMap::new(dim, &vertices[..=dim]);
        let mut at = CellMap::new(mesh, &tables.vertices);
        let stresses: [Sym; 4] = std::array::from_fn(|v| {
            at.at(nodes, v.min(dim));
            laws.at(region, &at, nodes, motion)
        });
        let size = volume(dim) * map.determinant * mesh.thickness();
        let mut all = CellStress {
            moments: [[[0.0; 3]; 4]; 6],
            areas: [0.0; 6],
            total: stresses[..=dim].iter().fold(Sym::ZERO, |sum, s| sum + (size / (dim + 1) as f64) * *s),
            is_linear: true,
        };
        for (local, &facet) in skeleton.cells[cell].facets.iter().enumerate() {
            let area = map.gradient(skeleton.opposite(cell, local)).map(|c| 0.0 - dim as f64 * size * c);
            // ∫ φ_a φ_b = |F| (1 + δ_ab)/(d (d + 1)).
            let share = 1.0 / (dim * (dim + 1)) as f64;
            let moments = &mut all.moments[local];
            let own: [usize; 3] = std::array::from_fn(|slot| skeleton.corner(mesh, (cell, facet), slot.min(dim - 1)));
            let tractions = own.map(|v| stresses[v].apply(&area));
            for (a, moment) in moments.iter_mut().enumerate().take(dim) {
                for (b, traction) in tractions.iter().enumerate().take(dim) {
                    let share = if a == b { 2.0 * share } else { share };
                    (0..dim).for_each(|c| moment[c] += share * traction[c]);
                }
            }
            all.areas[local] = length(&area);
        }
        all
    }
}

/// Moments ∫_F σν φ of the stress of a cell per vertex of a facet, and the area of the facet.
fn traction(
    laws: &StepLaws,
    skeleton: &Skeleton,
    (cell, local): (usize, usize),
    motion: &StepMotion,
) -> ([Point; 4], f64) {
    let (tables, nodes) = (skeleton.tables(cell), skeleton.nodes(laws.mesh, cell));
    let (points, facet) = (&tables.facets[local], &skeleton.facets[skeleton.cells[cell].facets[local]]);
    let own: Vec<u32> = tables.element.facets[local].nodes.iter().map(|&node| nodes[node]).collect();
    let mut map = CellMap::new(laws.mesh, &points.table);
    let mut on_facet = FacetMap::new(laws.mesh, &points.own);
    let (mut moments, mut area) = ([[0.0; 3]; 4], 0.0);
    for (q, hats) in points.hats.iter().enumerate() {
        map.at(nodes, q);
        on_facet.at(&own, q);
        let weight = points.own.weights[q] * on_facet.area;
        area += weight;
        let traction = laws.at(laws.region(skeleton, cell), &map, nodes, motion).apply(&on_facet.normal);
        for (value, node) in hats.iter().zip(&own) {
            if let Some(place) = facet.place(*node) {
                (0..3).for_each(|c| moments[place][c] += weight * value * traction[c]);
            }
        }
    }
    (moments, area)
}
