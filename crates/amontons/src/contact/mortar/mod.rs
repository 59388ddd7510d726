//! Pairs of sides that face each other, by dual mortar functions.
//!
//! Of a pair the *nonmortar* side bears the laws, the *mortar* side is the other one. With the dual functions ψ_i of
//! the nonmortar vertices,
//!
//! ```text
//!     D_ij = ∫ ψ_i N¹_j,    M_il = ∫ ψ_i (N²_l ∘ P),    ω_i = ∫ ψ_i,    P_il = M_il/ω_i
//!     (B x)_i = Σ_j D_ij/ω_i x¹_j − Σ_l P_il x²_l
//! ```
//!
//! P projects along the normal of the nonmortar facet. (B x)_i is the jump at a contact point with the weight ω_i: what
//! acts on one side at a point acts on the other with the opposite sign, since Σ_j D_ij = ω_i = Σ_l M_il.
//!
//! On each facet ψ = A L, A = diag(∫L) (∫L Lᵀ)⁻¹, with L the linear functions of its vertices and integrals over its
//! covered part. Quadratic sides have their contact points at the vertices as well: ∫ N_i of a quadratic facet is zero
//! or negative at vertices, ∫ L_i is not.
//!
//! Sources: dual functions, B. Wohlmuth, SIAM J. Numer. Anal. 38 (2000) 989; on covered parts, T. Cichosz and M.
//! Bischoff, CMAME 200 (2011) 1317; nodes without a multiplier, B. Wohlmuth, *Discretization Methods and Iterative
//! Solvers Based on Domain Decomposition*, Springer 2001, chapter 1; averaged normals and the gap along them, A. Popp,
//! M. Gee and W. Wall, IJNME 79 (2009) 1354; the facet as plane of projection, M. Puso and T. Laursen, CMAME 193
//! (2004) 601.

mod cut;
mod dual;
mod facing;
mod part;
mod tree;

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use super::Supports;
use crate::element::MAX_NODES;
use crate::mesh::{FacetSet, Mesh, link_of};
use crate::tensor::{Point, dot, length};
pub use facing::{Facing, facing};

use part::{Facets, Part};
use tree::Tree;

/// Share of the largest weight below which a node is not covered.
const COVERED: f64 = 1e-12;
/// Coefficients of a row, relative to 1, that are round-off.
const ROUND_OFF: f64 = 1e-15;
/// Length of a mean of unit normals below which it has no direction.
const DIRECTION: f64 = 1e-9;

/// Two sides of a mesh that face each other.
#[derive(Clone, Copy)]
pub struct Sides<'a> {
    /// The mesh of all bodies.
    pub mesh: &'a Mesh,
    /// Positions of its nodes: those of the mesh, or of the displaced bodies.
    pub x: &'a [Point],
    /// The side that bears the laws.
    pub nonmortar: &'a FacetSet,
    /// The other side.
    pub mortar: &'a FacetSet,
    /// What holds their nodes.
    pub supports: Supports<'a>,
}

/// A contact point of a pair: a vertex of the nonmortar side that has a multiplier.
#[derive(Clone, Debug)]
pub struct MortarRow {
    /// The vertex.
    pub node: u32,
    /// Mean of the unit normals of the adjacent facets, without its prescribed components, normalised.
    pub normal: Point,
    /// ω in m^(d−1); zero where nothing faces the point.
    pub weight: f64,
    /// D_ij/ω_i by nonmortar node.
    pub own: Vec<(u32, f64)>,
    /// P_il by mortar node.
    pub other: Vec<(u32, f64)>,
    /// The gap of the geometry, −ν·(B X), in m.
    pub gap: f64,
    /// Length of the part of B X across ν in m: the lever by which a pressure misses the balance of moments.
    pub lever: f64,
    /// Whether a component of the displacement is prescribed: the point then has no friction.
    pub is_held: bool,
}

/// A pair of sides.
#[derive(Clone, Debug, Default)]
pub struct Mortar {
    /// The contact points, by node ascending.
    pub rows: Vec<MortarRow>,
    /// Measure of the nonmortar side in m^(d−1).
    pub measure: f64,
    /// That of the part of it that the mortar side faces.
    pub covered: f64,
}

/// Mean measure of the facets of a side.
#[must_use]
pub fn mean_facet(mesh: &Mesh, set: &FacetSet) -> f64 {
    let facets = Facets::new(mesh, &mesh.points, set);
    (0..facets.len()).map(|facet| facets.measure(facet)).sum::<f64>() / facets.len().max(1) as f64
}

/// What a vertex gathers from its facets.
#[derive(Clone, Debug, Default)]
struct Gathered {
    normal: Point,
    own: BTreeMap<u32, f64>,
    other: BTreeMap<u32, f64>,
}

impl Mortar {
    /// The contact points of a pair; with `all` those that nothing faces as well, with weight zero.
    #[must_use]
    pub fn new(sides: &Sides, all: bool) -> Mortar {
        let [nonmortar, mortar] = [sides.nonmortar, sides.mortar].map(|set| Facets::new(sides.mesh, sides.x, set));
        let mut nodes: BTreeMap<u32, Gathered> = BTreeMap::new();
        for facet in 0..nonmortar.len() {
            for (node, normal) in nonmortar.normals(facet) {
                let sum = &mut nodes.entry(node).or_default().normal;
                *sum = std::array::from_fn(|c| sum[c] + normal[c]);
            }
        }
        for link in sides.supports.links {
            let [Some(own), Some(followed)] = [link.node, link.to].map(|node| nodes.get(&node)) else { continue };
            let mean = link.normals(&own.normal, &followed.normal);
            for (node, normal) in [link.node, link.to].into_iter().zip(mean) {
                nodes.entry(node).or_default().normal = normal;
            }
        }
        let shared: BTreeSet<u32> = sides.mortar.node_list().into_iter().collect();
        let nodes_of_side: BTreeSet<u32> = nodes.keys().copied().collect();
        let mut held = BTreeMap::new();
        for (&node, gathered) in &mut nodes {
            let held_along = (sides.supports.held)(node);
            let sum = &mut gathered.normal;
            for direction in &held_along {
                let along = dot(sum, direction);
                *sum = std::array::from_fn(|c| sum[c] - along * direction[c]);
            }
            let size = length(sum);
            // A node of both sides, and one that cannot move along its normal, has no multiplier, and of two nodes that
            // have one displacement only one does.
            let follows = link_of(sides.supports.links, node).is_some_and(|link| nodes_of_side.contains(&link.to));
            if size > DIRECTION && !shared.contains(&node) && !follows {
                *sum = sum.map(|c| c / size);
                held.insert(node, held_along.iter().flatten().any(|part| *part != 0.0));
            }
        }
        let (mut made, tree) = (Mortar::default(), Tree::new(mortar.parts()));
        let of_facet = |facet| Integrals::new(&nonmortar, (&mortar, &tree), facet, &held);
        let integrals: Vec<Integrals> = (0..nonmortar.len()).into_par_iter().map(of_facet).collect();
        for (facet, integrals) in integrals.iter().enumerate() {
            made.measure += nonmortar.measure(facet);
            made.covered += integrals.covered;
            for (vertex, own, other) in &integrals.rows {
                let Some(gathered) = nodes.get_mut(vertex) else { continue };
                for (sums, values) in [(&mut gathered.own, own), (&mut gathered.other, other)] {
                    for (node, value) in values {
                        *sums.entry(*node).or_default() += value;
                    }
                }
            }
        }
        made.rows = rows(sides, nodes, &held, all);
        made
    }
}

/// ∫ψ_i N of one facet.
#[derive(Default)]
struct Integrals {
    /// Measure of its covered part.
    covered: f64,
    /// By vertex that has a multiplier: D_ij and M_il by node.
    rows: Vec<(u32, Values, Values)>,
}

/// Values by node.
type Values = Vec<(u32, f64)>;

impl Integrals {
    fn new(
        nonmortar: &Facets,
        (mortar, tree): (&Facets, &Tree),
        facet: usize,
        has_multiplier: &BTreeMap<u32, bool>,
    ) -> Integrals {
        let samples = cut::samples(nonmortar, (mortar, tree), facet, None);
        if samples.is_empty() {
            return Integrals::default();
        }
        let (element, nodes) = nonmortar.facet(facet);
        let vertices = &nodes[..element.shape.vertices()];
        let kept: Vec<bool> = vertices.iter().map(|node| has_multiplier.contains_key(node)).collect();
        let dual = dual::Dual::new(nonmortar, facet, &samples, &kept);
        let mut rows: Vec<(u32, Values, Values)> = Vec::new();
        for (a, vertex) in vertices.iter().enumerate().filter(|(a, _)| kept[*a]) {
            rows.push((*vertex, nodes.iter().copied().zip(dual.own(a).iter().copied()).collect(), Vec::new()));
        }
        // The samples on one mortar facet follow each other.
        let mut first = 0;
        for on_other in samples.chunk_by(|a, b| a.other.0 == b.other.0) {
            let (_, nodes) = mortar.facet(on_other[0].other.0);
            let mut sums = vec![[0.0; MAX_NODES]; rows.len()];
            for (q, sample) in (first..).zip(on_other) {
                let values = mortar.values(sample.other.0, &sample.other.1);
                for (sums, (a, _)) in sums.iter_mut().zip(kept.iter().enumerate().filter(|(_, kept)| **kept)) {
                    let weight = sample.weight * dual.values(a)[q];
                    sums.iter_mut().zip(&values).for_each(|(sum, value)| *sum += weight * value);
                }
            }
            for ((_, _, other), sums) in rows.iter_mut().zip(sums) {
                other.extend(nodes.iter().copied().zip(sums));
            }
            first += on_other.len();
        }
        Integrals { covered: samples.iter().map(|sample| sample.weight).sum(), rows }
    }
}

fn rows(
    sides: &Sides,
    nodes: BTreeMap<u32, Gathered>,
    has_multiplier: &BTreeMap<u32, bool>,
    all: bool,
) -> Vec<MortarRow> {
    let weight = |gathered: &Gathered| gathered.own.values().sum::<f64>();
    let largest = nodes.values().map(weight).fold(0.0, f64::max);
    // No bodies that fit into the mesh are farther apart.
    let far = length(&std::array::from_fn(|c| {
        let along = || sides.mesh.points.iter().map(|x| x[c]);
        along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
    }));
    let mut rows = Vec::new();
    for (node, gathered) in nodes {
        let Some(&is_held) = has_multiplier.get(&node) else { continue };
        let weight = weight(&gathered);
        let is_covered = weight > COVERED * largest;
        if !is_covered && !all {
            continue;
        }
        let shares = |sums: &BTreeMap<u32, f64>| -> Vec<(u32, f64)> {
            sums.iter().map(|(&l, sum)| (l, sum / weight)).filter(|(_, share)| share.abs() > ROUND_OFF).collect()
        };
        let (own, other) =
            if is_covered { (shares(&gathered.own), shares(&gathered.other)) } else { (vec![(node, 1.0)], Vec::new()) };
        let place = |shares: &[(u32, f64)]| -> Point {
            std::array::from_fn(|c| shares.iter().map(|&(node, share)| share * sides.x[node as usize][c]).sum())
        };
        let (from, to) = (place(&own), place(&other));
        let apart: Point = std::array::from_fn(|c| to[c] - from[c]);
        let along = dot(&gathered.normal, &apart);
        let lever = length(&std::array::from_fn(|c| apart[c] - along * gathered.normal[c]));
        let (gap, lever) = if is_covered { (along, lever) } else { (far, 0.0) };
        let weight = if is_covered { weight } else { 0.0 };
        rows.push(MortarRow { node, normal: gathered.normal, weight, own, other, gap, lever, is_held });
    }
    rows
}

impl Part {
    /// Whether two parts look at each other.
    fn faces(&self, other: &Part) -> bool {
        dot(&self.normal, &other.normal) < 0.0
    }
}
