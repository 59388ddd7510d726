//! The nodes of a nonmortar side that may become contact points: covered share and patch of each.

use std::collections::BTreeMap;

use super::cut::{Covered, FACING, whole};
use super::part::{FlatPiece, SideFacets};
use crate::mesh::{Link, leader, link_of};
use crate::tensor::{Point, dot};

/// cos 35°: facets that meet at a larger angle belong to two patches. It lies between the angles of polygons of 10 and
/// 11 facets, so that coarse circles are smooth and chamfers of 45° are not.
const SMOOTH: f64 = FACING;

/// The candidate to which a corner of a nonmortar part belongs.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Corner {
    /// The number of the candidate.
    pub candidate: usize,
    /// True if its node follows that of the candidate into the next sector.
    pub follows: bool,
}

/// A node on a patch.
#[derive(Clone, Debug)]
pub(super) struct Candidate {
    /// The node; if one node follows another, the leader.
    pub node: u32,
    /// The corners of parts at the node: part, and number of the corner in it.
    pub corners: Vec<(usize, usize)>,
    /// σ, the largest share of its hat that is covered on one of its parts.
    pub share: f64,
}

/// The candidates of a side, by node and patch, and the candidate of each corner of its parts.
pub(super) struct Candidates {
    pub all: Vec<Candidate>,
    /// By part and corner.
    pub of: Vec<[Corner; 4]>,
    /// Covered share of the hat of each corner on its part.
    pub shares: Vec<[f64; 4]>,
}

impl Candidates {
    /// The candidates of a side at rest: the assignment of nodes to patches does not depend on the motion of the
    /// bodies.
    pub fn new(at_rest: &SideFacets, links: &[Link]) -> Candidates {
        let patches = patches(at_rest, links);
        let mut numbers: BTreeMap<(u32, usize), Vec<(usize, usize)>> = BTreeMap::new();
        for (number, part) in at_rest.parts().iter().enumerate() {
            for corner in 0..part.corners.len() {
                let node = leader(links, at_rest.node(part, corner));
                numbers.entry((node, patches[number])).or_default().push((number, corner));
            }
        }
        let mut of = vec![[Corner::default(); 4]; at_rest.parts().len()];
        let mut all = Vec::with_capacity(numbers.len());
        for (candidate, ((node, _), corners)) in numbers.into_iter().enumerate() {
            for &(part, corner) in &corners {
                let follows = at_rest.node(&at_rest.parts()[part], corner) != node;
                of[part][corner] = Corner { candidate, follows };
            }
            all.push(Candidate { node, corners, share: 0.0 });
        }
        let shares = vec![[0.0; 4]; of.len()];
        Candidates { all, of, shares }
    }

    /// Finds the shares σ: for each candidate, the largest covered share of its hat on any part at the node.
    pub fn cover(&mut self, facets: &SideFacets, covered: &[Covered]) {
        for (number, part) in
            facets.parts().iter().enumerate().filter(|(number, _)| !covered[*number].samples.is_empty())
        {
            let whole = whole(facets, part);
            for corner in 0..part.corners.len() {
                let hat: f64 = covered[number].samples.iter().map(|sample| sample.weight * sample.hats[corner]).sum();
                let share = hat / whole[corner];
                self.shares[number][corner] = share;
                let largest = &mut self.all[self.of[number][corner].candidate].share;
                *largest = largest.max(share);
            }
        }
    }
}

/// The patch of each part. Parts that meet at an edge without a kink, and parts of one facet, share a patch.
fn patches(facets: &SideFacets, links: &[Link]) -> Vec<usize> {
    let parts = facets.parts();
    let mut union = Union { of: (0..parts.len()).collect() };
    let mut edges: BTreeMap<[u32; 2], Vec<(usize, Point)>> = BTreeMap::new();
    for facet in 0..facets.len() {
        let own = facets.numbers_of(facet);
        own.clone().zip(own.skip(1)).for_each(|(a, b)| union.join(a, b));
    }
    for (number, part) in parts.iter().enumerate() {
        for edge in edges_of(facets, part) {
            edges.entry(edge.map(|node| leader(links, node))).or_default().push((number, normal(part, edge, links)));
        }
    }
    for meeting in edges.values() {
        for (i, (a, normal)) in meeting.iter().enumerate() {
            for (b, other) in &meeting[i + 1..] {
                if dot(normal, other) > SMOOTH {
                    union.join(*a, *b);
                }
            }
        }
    }
    (0..parts.len()).map(|part| union.root(part)).collect()
}

/// The edges of a part by their nodes in ascending order; in the plane its end points.
fn edges_of(facets: &SideFacets, part: &FlatPiece) -> Vec<[u32; 2]> {
    let (n, node) = (part.corners.len(), |corner: usize| facets.node(part, corner));
    match n {
        1 => Vec::new(),
        2 => [0, 1].map(|corner| [node(corner); 2]).to_vec(),
        _ => (0..n).map(|i| [node(i).min(node((i + 1) % n)), node(i).max(node((i + 1) % n))]).collect(),
    }
}

/// The normal of a part at an edge, turned into the sector of the nodes that those of the edge follow.
fn normal(part: &FlatPiece, edge: [u32; 2], links: &[Link]) -> Point {
    match edge.map(|node| link_of(links, node)) {
        [Some(link), Some(_)] => link.back(&part.normal),
        _ => part.normal,
    }
}

/// Disjoint sets (union-find), each identified by its least member.
struct Union {
    of: Vec<usize>,
}

impl Union {
    fn root(&mut self, mut member: usize) -> usize {
        while self.of[member] != member {
            self.of[member] = self.of[self.of[member]];
            member = self.of[member];
        }
        member
    }

    fn join(&mut self, a: usize, b: usize) {
        let [a, b] = [a, b].map(|member| self.root(member));
        self.of[a.max(b)] = a.min(b);
    }
}
