//! Selects the candidates that have a law of their own, and assigns the functions of the others to them.
//!
//! A node whose hat is covered only by a sliver would have a force as small as the sliver and an arbitrarily large
//! pressure: it is *joined* to its neighbours (the idea of E. Béchet, N. Moës and B. Wohlmuth, IJNME 78 (2009) 931, for
//! cut meshes, on the covered part of a side). So are nodes at which two laws would meet (at a kink between two
//! patches, of two pairs, on both sides), and a fully held node that faces another fully held one: its traction is
//! undetermined.

use std::collections::BTreeMap;

use super::candidate::Candidates;
use super::cut::Covered;

/// Least covered share σ of a hat for a node with a law of its own. In the plane σ is the square of the covered part of
/// a facet, and no square of a ratio of small integers is near 0.7; 0.6 to 0.8 would do.
const OWN: f64 = 0.7;
/// Shares that differ by less are equal.
const SAME: f64 = 1e-9;
/// Share of a hat below which it counts as uncovered.
const COVERED: f64 = 1e-12;

/// The matrix T: the candidates to which each gives its function, with fractions.
pub(super) struct Joining {
    /// True if a candidate has a law of its own.
    pub has_law: Vec<bool>,
    /// T_ki by i: the receiving candidates k with their fractions, which sum to 1; a candidate with a law keeps its
    /// own, an uncovered candidate has no entries.
    pub to: Vec<Vec<(usize, f64)>>,
}

/// True if a candidate is covered enough for a law of its own.
pub(super) fn bears(share: f64) -> bool {
    share >= OWN - SAME
}

impl Joining {
    /// The joining of a side. `is_named` selects candidates that are joined regardless of their share.
    pub fn new(candidates: &Candidates, covered: &[Covered], is_named: &dyn Fn(usize) -> bool) -> Joining {
        let all = &candidates.all;
        let is_named: Vec<bool> = (0..all.len()).map(is_named).collect();
        let mut has_law: Vec<bool> = all.iter().zip(&is_named).map(|(own, named)| bears(own.share) && !named).collect();
        let itself = |i: usize| if has_law[i] { vec![(i, 1.0)] } else { Vec::new() };
        let mut to: Vec<Vec<(usize, f64)>> = (0..all.len()).map(itself).collect();
        let mut others: Vec<usize> = (0..all.len()).filter(|&i| !has_law[i] && all[i].share > COVERED).collect();
        let rounded = |i: usize| (all[i].share / SAME).round() as i64;
        others.sort_by_key(|&i| (is_named[i], -rounded(i), i));
        let near: Vec<Vec<(usize, f64)>> = others.iter().map(|&i| neighbours(candidates, covered, i)).collect();
        let mut waiting: Vec<(usize, &[(usize, f64)])> =
            others.into_iter().zip(near.iter().map(Vec::as_slice)).collect();
        let mut is_beside = vec![false; all.len()];
        // A candidate without a taker waits until its neighbours have one: a sliver next to a joined node passes its
        // function on to the takers of that node. If no candidate finds one, the most covered gets a law after all.
        while let Some(&(first, _)) = waiting.first() {
            let before = waiting.len();
            waiting.retain(|&(i, near)| {
                let beside = near.iter().any(|&(k, _)| has_law[k]);
                let takers = takers(near, &has_law, &is_beside, &to);
                let sum: f64 = takers.iter().map(|(_, common)| common).sum();
                is_beside[i] = beside;
                to[i] = takers.into_iter().map(|(k, common)| (k, common / sum)).collect();
                to[i].is_empty()
            });
            if waiting.len() == before {
                waiting.remove(0);
                has_law[first] = true;
                to[first] = vec![(first, 1.0)];
            }
        }
        Joining { has_law, to }
    }
}

/// The candidates that take the function of a candidate with these neighbours, with weights: its neighbours with laws;
/// if all neighbours are slivers, as at the corner of a triangle, the takers of those that are next to a node with a
/// law. Farther nodes take nothing: a strip narrower than a facet has laws along its whole length.
fn takers(near: &[(usize, f64)], has_law: &[bool], is_beside: &[bool], to: &[Vec<(usize, f64)>]) -> Vec<(usize, f64)> {
    let with_laws: Vec<(usize, f64)> = near.iter().copied().filter(|&(k, _)| has_law[k]).collect();
    if !with_laws.is_empty() {
        return with_laws;
    }
    let passing = near.iter().filter(|&&(k, _)| is_beside[k]);
    summed(passing.flat_map(|&(k, common)| to[k].iter().map(move |&(l, part)| (l, part * common))))
}

/// C_ik = ∫ H_i H_k over the covered parts at candidate i, by neighbour k.
fn neighbours(candidates: &Candidates, covered: &[Covered], i: usize) -> Vec<(usize, f64)> {
    let at_corner = |&(part, corner): &(usize, usize)| {
        candidates.of[part].iter().enumerate().map(move |(other, of)| {
            let product = |hats: &[f64; 4]| hats[corner] * hats[other];
            let common = covered[part].samples.iter().map(|sample| sample.weight * product(&sample.hats)).sum();
            (of.candidate, common)
        })
    };
    summed(candidates.all[i].corners.iter().flat_map(at_corner).filter(|&(k, common)| k != i && common > 0.0))
}

/// Sums the values per candidate, ordered by candidate.
fn summed(of: impl Iterator<Item = (usize, f64)>) -> Vec<(usize, f64)> {
    let mut sums = BTreeMap::new();
    of.for_each(|(k, part)| *sums.entry(k).or_insert(0.0) += part);
    sums.into_iter().collect()
}
