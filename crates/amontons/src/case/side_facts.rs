//! Facts about the sides of a pair: materials behind them, facets, supports, and the fraction that the other side
//! faces. They decide on the partition of friction heat and on the side that bears the contact points.

use std::cell::OnceCell;

use crate::contact::Supports;
use crate::contact::mortar::{FacingSides, bearing_nodes, covered_shares, mean_facet};
use crate::element::{Element, ShapeTable};
use crate::material::{Material, OperatorConstants};
use crate::mesh::{FacetMap, FacetSet, Mesh};
use crate::problem::BoundaryCondition;
use crate::space::Space;
use crate::tensor::{Sym, dot};

/// Ratios nearer to 1 count as equal, because of round-off.
const EQUAL: f64 = 1.01;
/// Ratio of stiffnesses above which the softer body bears the points: a fine stiff side finds the kinks of a coarse
/// soft one and touches only there.
const SOFTER: f64 = 2.5;
/// Difference of covered fractions above which the side with the larger one bears the points.
const MORE: f64 = 0.01;
/// Ratio of facet sizes above which the finer side bears the points.
const FINER: f64 = 2.0;

/// The sides of a mesh with the bodies behind them.
pub(super) struct SideFacts<'m> {
    mesh: &'m Mesh,
    materials: &'m [Material],
    boundary: &'m [BoundaryCondition],
    /// V^h, made on demand.
    space: OnceCell<Space>,
}

impl<'m> SideFacts<'m> {
    pub fn new(mesh: &'m Mesh, materials: &'m [Material], boundary: &'m [BoundaryCondition]) -> SideFacts<'m> {
        SideFacts { mesh, materials, boundary, space: OnceCell::new() }
    }

    /// √(Kc), c the heat capacity per volume and K the conductivity along the normal, as its mean over the facets of a
    /// side, or `None` for a missing side.
    pub fn effusivity(&self, side: &str) -> Option<f64> {
        self.mean(side, |material, map| {
            let conductivity = dot(&map.normal, &material.conductivity.at(&map.position).apply(&map.normal));
            (conductivity * material.heat_capacity.at(&map.position)).sqrt()
        })
    }

    /// True if the second side of a pair bears the contact points when the case does not say which, and the reason. The
    /// criteria apply in this order, each with a tolerance for round-off:
    ///
    /// 1. the side that is not held at every node;
    /// 2. the side of the softer body, whatever the meshes, unless too few of its points bear to hold a body from
    ///    turning and the other side has enough;
    /// 3. the side of which the other faces more: partly covered points are less accurate;
    /// 4. the side with the finer facets;
    /// 5. the smaller side; the first.
    pub fn second_bears(&self, sides: [&str; 2]) -> (bool, &'static str) {
        let decide = |[first, second]: [f64; 2], play: f64| -> Option<bool> {
            if second * play < first {
                Some(true)
            } else if first * play < second {
                Some(false)
            } else {
                None
            }
        };
        let by_support = || decide(sides.map(|side| if self.is_held(side) { 2.0 } else { 1.0 }), EQUAL);
        let by_stiffness = || {
            let second = decide(sides.map(|side| self.stiffness(side).unwrap_or(0.0)), SOFTER)?;
            let [softer, other] = if second { [sides[1], sides[0]] } else { sides };
            if !self.holds([softer, other]) && self.holds([other, softer]) {
                return Some((!second, "too few points of the softer body lie on the other"));
            }
            Some((second, "its body is the softer one"))
        };
        let by_cover = || {
            let [first, second] = self.covered(sides)?;
            ((first - second).abs() > MORE).then_some(second > first)
        };
        let sizes = sides.map(|side| self.sizes(side));
        let by_facets = || decide(sizes.map(|[facet, _]| facet), FINER);
        let by_size = || decide(sizes.map(|[_, size]| size), EQUAL);
        let because = |why: &'static str| move |second: bool| (second, why);
        by_support()
            .map(because("the other side is held as a whole"))
            .or_else(by_stiffness)
            .or_else(|| by_cover().map(because("more of it is faced")))
            .or_else(|| by_facets().map(because("its facets are finer")))
            .or_else(|| by_size().map(because("it is the smaller one")))
            .unwrap_or((false, "the sides are alike, and it is named first"))
    }

    /// True if every node of a side is held in all directions.
    fn is_held(&self, side: &str) -> bool {
        let space = self.space.get_or_init(|| {
            let prescribed = self.boundary.iter().flat_map(|b| b.prescriptions(self.mesh));
            Space::new(self.mesh, self.mesh.dim, prescribed)
        });
        self.mesh.facets.get(side).is_some_and(|set| set.node_list().into_iter().all(|node| space.is_held(node)))
    }

    /// The largest eigenvalue of 𝓔 at rest in the cells behind a side, Pa, averaged over the facets.
    fn stiffness(&self, side: &str) -> Option<f64> {
        self.mean(side, |material, map| {
            let tangent = material.elasticity.tangent(&map.position, &Sym::ZERO);
            OperatorConstants::of_linear(&tangent, self.mesh.dim).lipschitz
        })
    }

    /// The fractions of both sides that the other one faces.
    fn covered(&self, sides: [&str; 2]) -> Option<[f64; 2]> {
        let [Some(nonmortar), Some(mortar)] = sides.map(|side| self.mesh.facets.get(side)) else { return None };
        self.mesh.check_nodes().ok()?;
        Some(covered_shares(&self.pair(nonmortar, mortar)))
    }

    /// True if the first of two sides has at least as many bearing points as hold a body from turning, d.
    fn holds(&self, sides: [&str; 2]) -> bool {
        let [Some(nonmortar), Some(mortar)] = sides.map(|side| self.mesh.facets.get(side)) else { return true };
        self.mesh.check_nodes().is_err() || bearing_nodes(&self.pair(nonmortar, mortar)) >= self.mesh.dim
    }

    fn pair(&self, nonmortar: &'m FacetSet, mortar: &'m FacetSet) -> FacingSides<'m> {
        let (mesh, supports) = (self.mesh, Supports::NONE);
        FacingSides { mesh, x: &mesh.points, nonmortar, mortar, supports, keeps_all: false }
    }

    /// Size of a facet along the side in m, and measure of the side, in m^(d−1).
    fn sizes(&self, side: &str) -> [f64; 2] {
        self.mesh.facets.get(side).map_or([0.0; 2], |set| {
            let facet = mean_facet(self.mesh, set);
            [if self.mesh.dim == 3 { facet.sqrt() } else { facet }, facet * set.len() as f64]
        })
    }

    fn mean(&self, side: &str, of: impl Fn(&Material, &FacetMap) -> f64) -> Option<f64> {
        let set = self.mesh.facets.get(side)?;
        let cells = self.mesh.cells_of(set);
        let of_facet = |((element, nodes), cell): ((&'static Element, &[u32]), &Option<(usize, usize)>)| {
            let block = self.mesh.blocks.get((*cell)?.0)?;
            let material = self.materials.get(block.region).or(self.materials.last())?;
            let table = ShapeTable::at(element, &[element.centre()]);
            let mut map = FacetMap::new(self.mesh, &table);
            map.at(nodes, 0);
            Some(of(material, &map))
        };
        let all: Vec<f64> = set.facets().zip(&cells).filter_map(of_facet).collect();
        (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
    }
}
