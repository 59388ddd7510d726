//! Which candidates have a law of their own, and to which of these the others give their functions.
//!
//! A node whose hat is covered by a sliver only would have a force as small as the sliver and a pressure of any size:
//! it is *joined* to its neighbours (the idea of E. Béchet, N. Moës and B. Wohlmuth, IJNME 78 (2009) 931, for cut
//! meshes, on the covered part of a side). So are nodes at which two laws would meet: at a kink between two patches, of
//! two pairs, on both sides; and a node that is held as a whole and faces another one that is: nothing determines a
//! traction there.

use super::candidate::Candidates;
use super::cut::Covered;

/// Least share σ of a hat that is covered of a node with a law of its own. In the plane σ is the square of the covered
/// part of a facet, and no ratio of small numbers squared is near 0.7; 0.6 to 0.8 would do.
const OWN: f64 = 0.7;
/// Shares that differ by less are equal.
const SAME: f64 = 1e-9;
/// Share of a hat below which it is not covered.
const COVERED: f64 = 1e-12;

/// T: to which candidates each gives its function, in which parts.
pub(super) struct Joining {
    /// Whether a candidate has a law of its own.
    pub has_law: Vec<bool>,
    /// T_ki by i: the candidates k with their parts, which sum to 1; itself of a candidate with a law, none of one that
    /// is not covered.
    pub to: Vec<Vec<(usize, f64)>>,
}

/// Whether a candidate is covered as far as a node with a law of its own is.
pub(super) fn bears(share: f64) -> bool {
    share >= OWN - SAME
}

impl Joining {
    /// The joining of a side. `is_named` says of a candidate that it is joined whatever its share is.
    pub fn new(candidates: &Candidates, covered: &[Covered], is_named: &dyn Fn(usize) -> bool) -> Joining {
        let all = &candidates.all;
        let is_named: Vec<bool> = (0..all.len()).map(is_named).collect();
        let mut has_law: Vec<bool> = all.iter().zip(&is_named).map(|(own, named)| bears(own.share) && !named).collect();
        let itself = |i: usize| if has_law[i] { vec![(i, 1.0)] } else { Vec::new() };
        let mut to: Vec<Vec<(usize, f64)>> = (0..all.len()).map(itself).collect();
        let mut others: Vec<usize> = (0..all.len()).filter(|&i| !has_law[i] && all[i].share > COVERED).collect();
        let rounded = |i: usize| (all[i].share / SAME).round() as i64;
        others.sort_by_key(|&i| (is_named[i], -rounded(i), i));
        for i in others {
            let near: Vec<(usize, f64)> =
                neighbours(candidates, covered, i).into_iter().filter(|&(k, _)| has_law[k]).collect();
            let sum: f64 = near.iter().map(|(_, common)| common).sum();
            if near.is_empty() {
                has_law[i] = true;
                to[i] = vec![(i, 1.0)];
            } else {
                to[i] = near.into_iter().map(|(k, common)| (k, common / sum)).collect();
            }
        }
        Joining { has_law, to }
    }
}

/// C_ik = ∫ H_i H_k over the covered parts at a candidate, by k.
fn neighbours(candidates: &Candidates, covered: &[Covered], i: usize) -> Vec<(usize, f64)> {
    let mut found: Vec<(usize, f64)> = Vec::new();
    for &(part, corner) in &candidates.all[i].corners {
        for (other, of) in candidates.of[part].iter().enumerate() {
            let product = |hats: &[f64; 4]| hats[corner] * hats[other];
            let common: f64 = covered[part].samples.iter().map(|sample| sample.weight * product(&sample.hats)).sum();
            if of.candidate == i || common <= 0.0 {
                continue;
            }
            match found.iter_mut().find(|(k, _)| *k == of.candidate) {
                Some((_, sum)) => *sum += common,
                None => found.push((of.candidate, common)),
            }
        }
    }
    found.sort_unstable_by_key(|(k, _)| *k);
    found
}
