//! Pairs of sides that face each other, by dual mortar functions.
//!
//! The *nonmortar* side of a pair bears the laws, the *mortar* side is the other one. With a function φ_k for each
//! contact point k, and displacement functions N¹, N² of the two sides,
//!
//! ```text
//!     D_kj = ∫ φ_k N¹_j,    M_kl = ∫ φ_k (N²_l ∘ P),    ω_k = ∫ φ_k > 0
//!     (B x)_k = Σ_j D_kj/ω_k x¹_j − Σ_l M_kl/ω_k x²_l
//! ```
//!
//! P projects along the normal of the nonmortar facet. (B x)_k is the jump at a contact point with the weight ω_k: a
//! force on one side acts on the other with the opposite sign, since Σ_j D_kj = ω_k = Σ_l M_kl.
//!
//! - `cut`: the region of each flat *part* of a nonmortar facet that the mortar side covers; a quadratic facet has the
//!   parts that its nodes span. Facets face each other within 35° of opposite normals; of facets behind each other the
//!   nearest counts.
//! - `sight`: facets with a body between them do not face each other.
//! - `candidate`: nodes with *hats* H, the linear functions of the parts, on *patches* without a kink.
//! - `join`: a node that is covered too little for a law of its own, or at which two laws would meet, gives its
//!   function to its neighbours, φ_k = ψ_k + Σ_i T_ki ψ_i.
//! - `dual`: the functions ψ, dual to the hats.
//! - The gap of a point, −ν·(B X), is limited to the range of the distances on the support of φ_k: dual functions have
//!   negative weights on a part of the wedge next to a corner, and bodies that touch would overlap.
//! - `image`: facets of a sector also face those of the neighbouring sectors, and a node on the cut has the facets on
//!   both sides of it.
//!
//! Sources: dual functions, B. Wohlmuth, SIAM J. Numer. Anal. 38 (2000) 989; on covered parts, T. Cichosz and M.
//! Bischoff, CMAME 200 (2011) 1317; averaged normals and the gap along them, A. Popp, M. Gee and W. Wall, IJNME 79
//! (2009) 1354; the facet as plane of projection, M. Puso and T. Laursen, CMAME 193 (2004) 601. Record 22.

mod candidate;
mod cut;
mod dual;
mod facing;
mod image;
mod join;
mod part;
mod row;
mod sight;
mod tree;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

use rayon::prelude::*;

use super::Supports;
use crate::mesh::{FacetSet, Mesh, leader};
use crate::tensor::{Point, given};
pub use facing::{Facing, facing};
pub use image::SectorImage;

use candidate::Candidates;
use cut::{Covered, Opposite};
use join::{Joining, bears};
use part::SideFacets;
use sight::Sight;
use tree::SphereTree;

/// Two sides of a mesh that face each other.
#[derive(Clone, Copy)]
pub struct FacingSides<'a> {
    /// The mesh of all bodies.
    pub mesh: &'a Mesh,
    /// Positions of the nodes, of the mesh or of the displaced bodies.
    pub x: &'a [Point],
    /// The side that bears the laws.
    pub nonmortar: &'a FacetSet,
    /// The other side.
    pub mortar: &'a FacetSet,
    /// The supports of the nodes.
    pub supports: Supports<'a>,
    /// True if nodes that nothing faces have rows as well, with weight zero, as in an updated pairing.
    pub keeps_all: bool,
}

/// The share of a node of a side in a contact point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeShare {
    /// The node; if one node follows another, the leader.
    pub node: u32,
    /// The fraction, positive.
    pub part: f64,
    /// The sector of the node if it differs from that of the point.
    pub turn: Option<SectorImage>,
}

/// A contact point of a pair: a node of the nonmortar side that has a law of its own.
#[derive(Clone, Debug)]
pub struct MortarRow {
    /// The node.
    pub node: u32,
    /// Unit normal ν: the mean of the normals of the facets that bear φ, weighted by the integral of φ on them.
    pub normal: Point,
    /// ω in m^(d−1); zero where nothing faces the point.
    pub weight: f64,
    /// D_kj/ω_k by nonmortar node.
    pub own: Vec<(u32, f64)>,
    /// M_kl/ω_k by mortar node.
    pub other: Vec<(u32, f64)>,
    /// The entries that are turned into the sector of the point: number of the entry among those of `own` and then
    /// `other`, and the turn. Empty except at the cut of a sector.
    pub turned: Vec<(usize, SectorImage)>,
    /// The gap in m: −ν·(B X), limited to the range of the distances of the sides at the point.
    pub gap: f64,
    /// −ν·(B X) in m.
    pub gap_of_rows: f64,
    /// Length of the part of B X across ν in m: the lever arm by which a pressure violates the balance of moments.
    pub lever: f64,
    /// Shares by which quantities at the point, such as worn volume, are distributed to the nodes of its own and of the
    /// mortar side: fractions Σ_i T_ki ∫H_i H_l, normalized to sum 1. Entries of M take either sign.
    pub shares: [Vec<NodeShare>; 2],
    /// Directions in which the displacement is prescribed alike here and on the other side, so that friction has no
    /// component along them; filled up with zeros.
    pub held: [Point; 3],
}

/// A pair of sides.
#[derive(Clone, Debug, Default)]
pub struct Mortar {
    /// The contact points, by node ascending.
    pub rows: Vec<MortarRow>,
    /// Measure of the nonmortar side in m^(d−1).
    pub measure: f64,
    /// Measure of the part of it that the mortar side faces.
    pub covered: f64,
}

/// Mean measure of the facets of a side.
#[must_use]
pub fn mean_facet(mesh: &Mesh, set: &FacetSet) -> f64 {
    let facets = SideFacets::new(mesh, &mesh.points, set, &[SectorImage::SELF]);
    (0..facets.len()).map(|facet| facets.measure(facet)).sum::<f64>() / facets.len().max(1) as f64
}

/// The boundary of the bodies of a mesh as flat facets by their corners: segments in the plane, triangles in space,
/// oriented outwards as [`obstacle::ClosedSurface`](super::obstacle::ClosedSurface) expects.
#[must_use]
pub fn surface_of(mesh: &Mesh) -> Vec<Vec<Point>> {
    let boundary = mesh.boundary();
    let facets = SideFacets::new(mesh, &mesh.points, &boundary, &[SectorImage::SELF]);
    let cut = |corners: &[Point]| match corners {
        &[a, b, c, d] => vec![vec![a, b, c], vec![a, c, d]],
        other => vec![other.to_vec()],
    };
    facets.parts().iter().flat_map(|part| cut(&part.corners)).collect()
}

/// The fraction of the first side that the second faces, from 0 to 1, and vice versa.
#[must_use]
pub fn covered_shares(sides: &FacingSides) -> [f64; 2] {
    let turned = FacingSides { nonmortar: sides.mortar, mortar: sides.nonmortar, ..*sides };
    [sides, &turned].map(|sides| {
        let pairing = Pairing::new(sides);
        let [measure, covered] = pairing.measures();
        if measure > 0.0 { covered / measure } else { 0.0 }
    })
}

/// Number of nodes of the nonmortar side that are covered enough for a law of their own.
#[must_use]
pub fn bearing_nodes(sides: &FacingSides) -> usize {
    Pairing::new(sides).candidates.all.iter().filter(|candidate| bears(candidate.share)).count()
}

impl Mortar {
    /// The contact points of a pair.
    #[must_use]
    pub fn new(sides: &FacingSides) -> Mortar {
        Mortar::all(std::slice::from_ref(sides)).pop().unwrap_or_default()
    }

    /// The contact points of several pairs. A node at which the laws of two pairs would meet has none of its own.
    #[must_use]
    pub fn all(pairs: &[FacingSides]) -> Vec<Mortar> {
        let pairings: Vec<Pairing> = pairs.iter().map(Pairing::new).collect();
        let mut bearing: BTreeMap<u32, usize> = BTreeMap::new();
        for candidate in pairings.iter().flat_map(|pairing| &pairing.candidates.all) {
            if bears(candidate.share) {
                *bearing.entry(candidate.node).or_default() += 1;
            }
        }
        let is_crossed = |node: u32| bearing.get(&node).is_some_and(|count| *count > 1);
        pairings.iter().map(|pairing| pairing.mortar(&is_crossed)).collect()
    }
}

/// Two sides with the covered part of the nonmortar side.
struct Pairing<'a> {
    sides: &'a FacingSides<'a>,
    nonmortar: SideFacets<'a>,
    mortar: SideFacets<'a>,
    /// The turn to the next sector if the nonmortar side is on a sector.
    sector: Option<SectorImage>,
    /// By part of the nonmortar side.
    covered: Vec<Covered>,
    candidates: Candidates,
}

impl<'a> Pairing<'a> {
    fn new(sides: &'a FacingSides<'a>) -> Pairing<'a> {
        let FacingSides { mesh, x, supports, .. } = *sides;
        let lists = [sides.nonmortar, sides.mortar].map(FacetSet::node_list);
        let [sector, other] = lists.each_ref().map(|nodes| SectorImage::next(supports.links, x, nodes));
        let size = x.iter().flatten().fold(0.0, |most: f64, c| most.max(c.abs()));
        let images = match (sector, other) {
            (Some(next), Some(other)) if next.is_same(&other, size) => vec![SectorImage::SELF, next, next.inverse()],
            _ => vec![SectorImage::SELF],
        };
        let nonmortar = SideFacets::new(mesh, x, sides.nonmortar, &[SectorImage::SELF]);
        let mortar = SideFacets::new(mesh, x, sides.mortar, &images);
        let covered = covered(sides, &nonmortar, &mortar);
        let at_rest = SideFacets::new(mesh, &mesh.points, sides.nonmortar, &[SectorImage::SELF]);
        let mut candidates = Candidates::new(&at_rest, supports.links);
        candidates.cover(&nonmortar, &covered);
        Pairing { sides, nonmortar, mortar, sector, covered, candidates }
    }

    /// The measure of the nonmortar side and of its covered part.
    fn measures(&self) -> [f64; 2] {
        let measure = (0..self.nonmortar.len()).map(|facet| self.nonmortar.measure(facet)).sum();
        let weights = self.covered.iter().flat_map(|covered| &covered.samples).map(|sample| sample.weight);
        [measure, weights.sum()]
    }

    /// The nodes of the mortar facets that face the parts at a candidate.
    fn faced(&self, candidate: usize) -> BTreeSet<u32> {
        let parts = self.candidates.all[candidate].corners.iter().map(|(part, _)| *part);
        let samples = parts.flat_map(|part| &self.covered[part].samples);
        let facets: BTreeSet<usize> = samples.map(|sample| self.mortar.parts()[sample.other.0].facet).collect();
        facets.into_iter().flat_map(|facet| self.mortar.facet(facet).1).copied().collect()
    }

    /// The contact points; `is_crossed` is true if the laws of several pairs or patches meet at a node.
    fn mortar(&self, is_crossed: &dyn Fn(u32) -> bool) -> Mortar {
        let Supports { held, links, .. } = self.sides.supports;
        let shared: BTreeSet<u32> = self.sides.mortar.node_list().iter().map(|&node| leader(links, node)).collect();
        let dim = self.sides.mesh.dim;
        let is_held = |node: u32| given(&held(node)).count() >= dim;
        let is_named = |number: usize| {
            let node = self.candidates.all[number].node;
            is_crossed(node) || shared.contains(&node) || is_held(node) && self.faced(number).into_iter().any(is_held)
        };
        let joining = Joining::new(&self.candidates, &self.covered, &is_named);
        let [measure, covered] = self.measures();
        Mortar { rows: row::rows(self, &joining), measure, covered }
    }
}

/// The covered region of each part of the nonmortar side. The boundary of the bodies is needed only if something may
/// lie between the sides.
fn covered(sides: &FacingSides, nonmortar: &SideFacets, mortar: &SideFacets) -> Vec<Covered> {
    let tree = SphereTree::new(mortar.parts());
    let mut opposite = Opposite { facets: mortar, tree: &tree, sight: None, distance: None };
    let parts = nonmortar.parts();
    let mut all: Vec<Covered> = parts.par_iter().map(|part| cut::covered(nonmortar, &opposite, part)).collect();
    if all.iter().any(|covered| covered.is_far) {
        let own = OnceLock::new();
        let known = sides.supports.boundary.unwrap_or(&own);
        let boundary = known.get_or_init(|| sight::boundary(sides.mesh, sides.supports.links));
        let facets = SideFacets::new(sides.mesh, sides.x, boundary, &[SectorImage::SELF]);
        let sight = Sight::new(&facets);
        opposite.sight = Some(&sight);
        all.par_iter_mut().zip(parts).filter(|(covered, _)| covered.is_far).for_each(|(covered, part)| {
            *covered = cut::covered(nonmortar, &opposite, part);
        });
    }
    all
}
