//! What is known of the sides of a pair: what the bodies behind them are made of, their facets, what holds them, and
//! how much of one the other faces. By these friction heat is shared out, and the side is chosen that bears the contact
//! points.

use std::cell::OnceCell;

use crate::contact::Supports;
use crate::contact::mortar::{Sides, bearing_nodes, covered_shares, mean_facet};
use crate::element::{Element, ShapeTable};
use crate::material::{Constants, Material};
use crate::mesh::{FacetMap, FacetSet, Mesh};
use crate::problem::BoundaryCondition;
use crate::space::Space;
use crate::tensor::{Sym, dot};

/// Quotients that are nearer to 1 are equal but for round-off.
const EQUAL: f64 = 1.01;
/// Stiffness of one body relative to that of the other from which on the softer one bears the points: a fine stiff side
/// finds the kinks of a coarse soft one and touches there alone.
const SOFTER: f64 = 2.5;
/// Difference of the shares that are covered from which on the side bears the points that is covered more.
const MORE: f64 = 0.01;
/// Size of the facets of one side relative to those of the other from which on the finer one bears the points.
const FINER: f64 = 2.0;

/// The sides of a mesh with the bodies behind them.
pub(super) struct SideFacts<'m> {
    mesh: &'m Mesh,
    materials: &'m [Material],
    boundary: &'m [BoundaryCondition],
    /// V^h, made where it is asked for.
    space: OnceCell<Space>,
}

impl<'m> SideFacts<'m> {
    pub fn new(mesh: &'m Mesh, materials: &'m [Material], boundary: &'m [BoundaryCondition]) -> SideFacts<'m> {
        SideFacts { mesh, materials, boundary, space: OnceCell::new() }
    }

    /// √(Kc), c the heat capacity per volume and K the conductivity along the normal, as its mean over the facets of a
    /// side; none of a side that is not there.
    pub fn effusivity(&self, side: &str) -> Option<f64> {
        self.mean(side, |material, map| {
            let conductivity = dot(&map.normal, &material.conductivity.at(&map.position).apply(&map.normal));
            (conductivity * material.heat_capacity.at(&map.position)).sqrt()
        })
    }

    /// Whether the second side of a pair bears the contact points where the case does not say which does, and why. In
    /// this order, each with some play so that round-off decides nothing:
    ///
    /// 1. a side of which not every node is held as a whole;
    /// 2. that of the softer body, whatever the meshes, if there are as many points on it as hold a body from turning,
    ///    or no more on the other;
    /// 3. the side that the other faces more of: points that are partly covered are less accurate;
    /// 4. the one with the finer facets;
    /// 5. the smaller one; the first.
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

    /// Whether every node of a side is held in all directions.
    fn is_held(&self, side: &str) -> bool {
        let space = self.space.get_or_init(|| {
            let prescribed = self.boundary.iter().flat_map(|b| b.prescriptions(self.mesh));
            Space::new(self.mesh, self.mesh.dim, prescribed)
        });
        self.mesh.facets.get(side).is_some_and(|set| set.node_list().into_iter().all(|node| space.is_held(node)))
    }

    /// The largest eigenvalue of 𝓔 at rest in the cells behind a side, Pa, as its mean over the facets.
    fn stiffness(&self, side: &str) -> Option<f64> {
        self.mean(side, |material, map| {
            let tangent = material.elasticity.tangent(&map.position, &Sym::ZERO);
            Constants::of_linear(&tangent, self.mesh.dim).lipschitz
        })
    }

    /// The shares of both sides that the other one faces.
    fn covered(&self, sides: [&str; 2]) -> Option<[f64; 2]> {
        let [Some(nonmortar), Some(mortar)] = sides.map(|side| self.mesh.facets.get(side)) else { return None };
        self.mesh.check_nodes().ok()?;
        Some(covered_shares(&self.pair(nonmortar, mortar)))
    }

    /// Whether as many points stand on the first of two sides as hold a body from turning.
    fn holds(&self, sides: [&str; 2]) -> bool {
        let [Some(nonmortar), Some(mortar)] = sides.map(|side| self.mesh.facets.get(side)) else { return true };
        self.mesh.check_nodes().is_err() || bearing_nodes(&self.pair(nonmortar, mortar)) >= self.mesh.dim
    }

    fn pair(&self, nonmortar: &'m FacetSet, mortar: &'m FacetSet) -> Sides<'m> {
        let (mesh, supports) = (self.mesh, Supports::NONE);
        Sides { mesh, x: &mesh.points, nonmortar, mortar, supports, keeps_all: false }
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
