//! Dual functions of the vertices of a nonmortar facet on its covered part.

use faer::Mat;
use faer::prelude::Solve;

use super::cut::Sample;
use super::part::Facets;
use crate::element::Element;

/// Most vertices of a facet.
const VERTICES: usize = 4;

/// ψ of the vertices of a facet at the samples of its covered part.
pub(super) struct Dual {
    /// ψ_a by vertex and sample.
    psi: Vec<Vec<f64>>,
    /// ∫ψ_a N_j by vertex and node of the facet.
    own: Vec<Vec<f64>>,
}

impl Dual {
    /// The functions of the vertices that are `kept`; those of the others are shared out among these in equal parts, so
    /// that they still sum to 1.
    pub fn new(facets: &Facets, facet: usize, samples: &[Sample], kept: &[bool]) -> Dual {
        let (element, nodes) = facets.facet(facet);
        let linear = Element::find(element.shape, 1).unwrap_or(element);
        let n = kept.len();
        let of_vertices = |sample: &Sample| {
            let mut values = [0.0; VERTICES];
            (linear.shape_functions)(&sample.own, &mut values[..n]);
            values
        };
        let values: Vec<[f64; VERTICES]> = samples.iter().map(of_vertices).collect();
        let integral = |f: &dyn Fn(usize) -> f64| -> f64 {
            samples.iter().enumerate().map(|(q, sample)| sample.weight * f(q)).sum()
        };
        let shares: Vec<f64> = (0..n).map(|a| integral(&|q| values[q][a])).collect();
        let gram = Mat::from_fn(n, n, |a, b| integral(&|q| values[q][a] * values[q][b]));
        // Aᵀ = (∫L Lᵀ)⁻¹ diag(∫L).
        let factors = gram.partial_piv_lu().solve(Mat::from_fn(n, n, |a, b| if a == b { shares[a] } else { 0.0 }));
        let mut psi: Vec<Vec<f64>> = (0..n)
            .map(|a| values.iter().map(|values| (0..n).map(|b| factors[(b, a)] * values[b]).sum()).collect())
            .collect();
        // On a linear facet D is diagonal to the last bit.
        let mut own: Vec<Vec<f64>> = if nodes.len() == n {
            (0..n).map(|a| (0..n).map(|b| if a == b { shares[a] } else { 0.0 }).collect()).collect()
        } else {
            let all: Vec<_> = samples.iter().map(|sample| facets.values(facet, &sample.own)).collect();
            (0..n).map(|a| (0..nodes.len()).map(|j| integral(&|q| psi[a][q] * all[q][j])).collect()).collect()
        };
        let count = kept.iter().filter(|kept| **kept).count();
        if count < n && count > 0 {
            for values in [&mut psi, &mut own] {
                let removed: Vec<f64> = (0..values[0].len())
                    .map(|i| (0..n).filter(|&a| !kept[a]).map(|a| values[a][i]).sum::<f64>() / count as f64)
                    .collect();
                for values in values.iter_mut().zip(kept).filter(|(_, kept)| **kept).map(|(values, _)| values) {
                    values.iter_mut().zip(&removed).for_each(|(value, removed)| *value += removed);
                }
            }
        }
        Dual { psi, own }
    }

    /// ψ_a at the samples.
    pub fn values(&self, vertex: usize) -> &[f64] {
        &self.psi[vertex]
    }

    /// ∫ψ_a N_j by node of the facet.
    pub fn own(&self, vertex: usize) -> &[f64] {
        &self.own[vertex]
    }
}
