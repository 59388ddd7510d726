//! The functions ψ of the corners of a nonmortar part on its covered part c, and their integrals.
//!
//! ```text
//!     ψ_a = Σ_b A_ab H_b,  A = diag(∫H) (∫H Hᵀ)⁻¹      if all corners have laws of their own
//!     ψ_a = ∫H_a / |c|                                 else
//! ```
//!
//! Both satisfy Σ_a ψ_a = 1 and ∫ψ_a = ∫H_a, so that weights are positive and a constant pressure is exact. The second
//! needs no inverse on slivers.

use faer::Mat;
use faer::prelude::Solve;

use super::cut::MortarPoint;
use super::part::{FlatPiece, SideFacets};

/// Values per node of a facet.
pub(super) type FacetValues = Vec<f64>;

/// Integrals of the functions ψ of the corners of a part.
pub(super) struct Dual {
    /// ∫ψ_a.
    pub weight: Vec<f64>,
    /// ∫ψ_a N_j by corner and node of the facet.
    pub own: Vec<FacetValues>,
    /// Per mortar part: its number, ∫ψ_a N_l by corner and node of its facet, and ∫H_a H_l by corner and corner.
    pub other: Vec<(usize, Vec<FacetValues>, Vec<[f64; 4]>)>,
}

impl Dual {
    /// Integrates over the quadrature points of a part; `is_dual` is true if all its corners have laws of their own.
    pub fn new(
        nonmortar: &SideFacets,
        mortar: &SideFacets,
        part: &FlatPiece,
        samples: &[MortarPoint],
        is_dual: bool,
    ) -> Dual {
        let n = part.corners.len();
        let integral =
            |f: &dyn Fn(&MortarPoint) -> f64| -> f64 { samples.iter().map(|sample| sample.weight * f(sample)).sum() };
        let weight: Vec<f64> = (0..n).map(|a| integral(&|sample| sample.hats[a])).collect();
        let psi = if is_dual { dual(n, &weight, &integral, samples) } else { constant(&weight, samples) };
        let (_, nodes) = nonmortar.facet(part.facet);
        let own = if is_dual && nodes.len() == n {
            // On a linear facet D is exactly diagonal.
            (0..n).map(|a| (0..n).map(|b| if a == b { weight[a] } else { 0.0 }).collect()).collect()
        } else {
            let mut own = vec![vec![0.0; nodes.len()]; n];
            for (q, sample) in samples.iter().enumerate() {
                add(&mut own, &psi, q, sample.weight, &nonmortar.values(part.facet, &sample.own));
            }
            own
        };
        let mut other = Vec::new();
        let mut first = 0;
        // The samples on one mortar part are consecutive.
        for on_other in samples.chunk_by(|a, b| a.other.0 == b.other.0) {
            let number = on_other[0].other.0;
            let facet = mortar.parts()[number].facet;
            let (mut sums, mut hats) = (vec![vec![0.0; mortar.facet(facet).1.len()]; n], vec![[0.0; 4]; n]);
            for (q, sample) in (first..).zip(on_other) {
                add(&mut sums, &psi, q, sample.weight, &mortar.values(facet, &sample.other.2));
                for (hats, own) in hats.iter_mut().zip(&sample.hats) {
                    hats.iter_mut().zip(&sample.other.1).for_each(|(sum, hat)| *sum += sample.weight * own * hat);
                }
            }
            other.push((number, sums, hats));
            first += on_other.len();
        }
        Dual { weight, own, other }
    }
}

/// Adds w ψ_a(x_q) N_j(x_q).
fn add(sums: &mut [FacetValues], psi: &[Vec<f64>], q: usize, weight: f64, values: &[f64]) {
    for (sums, psi) in sums.iter_mut().zip(psi) {
        let weight = weight * psi[q];
        sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
    }
}

/// ψ_a by corner and sample: a constant per corner.
fn constant(weight: &[f64], samples: &[MortarPoint]) -> Vec<Vec<f64>> {
    let covered: f64 = weight.iter().sum();
    weight.iter().map(|own| vec![own / covered; samples.len()]).collect()
}

/// ψ_a by corner and sample, dual to the hats. The Gram matrix is scaled by its diagonal before the solve.
fn dual(
    n: usize,
    weight: &[f64],
    integral: &dyn Fn(&dyn Fn(&MortarPoint) -> f64) -> f64,
    samples: &[MortarPoint],
) -> Vec<Vec<f64>> {
    let gram = Mat::from_fn(n, n, |a, b| integral(&|sample| sample.hats[a] * sample.hats[b]));
    let scale: Vec<f64> = (0..n).map(|a| gram[(a, a)].sqrt().recip()).collect();
    let scaled = Mat::from_fn(n, n, |a, b| scale[a] * gram[(a, b)] * scale[b]);
    // Aᵀ = (∫H Hᵀ)⁻¹ diag(∫H).
    let right = Mat::from_fn(n, n, |a, b| if a == b { scale[a] * weight[a] } else { 0.0 });
    let factors = scaled.partial_piv_lu().solve(right);
    let of = |a: usize, sample: &MortarPoint| (0..n).map(|b| scale[b] * factors[(b, a)] * sample.hats[b]).sum();
    (0..n).map(|a| samples.iter().map(|sample| of(a, sample)).collect()).collect()
}
