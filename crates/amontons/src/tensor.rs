//! Points, symmetric tensors of 𝕊^d and linear maps on them.
//!
//! A symmetric tensor is stored by Mandel components in the nested order
//! `11 · 22, √2·12 · 33, √2·23, √2·13`, so that the first 1, 3 or 6 of them are the tensor in
//! d = 1, 2 or 3 dimensions, and the inner product `σ·τ = σ_ij τ_ij` of the paper (section 2)
//! is the plain dot product of the components.

use std::ops::{Add, AddAssign, Mul, Sub};

/// Cartesian coordinates or a vector; components beyond the dimension are zero.
pub type Point = [f64; 3];

/// Index pair (i, j), i ≤ j, of each Mandel component.
pub const MANDEL: [(usize, usize); 6] = [(0, 0), (1, 1), (0, 1), (2, 2), (1, 2), (0, 2)];

/// Number of Mandel components of 𝕊^d: d (d + 1) / 2.
#[must_use]
pub const fn mandel_len(dim: usize) -> usize {
    dim * (dim + 1) / 2
}

/// Position of component (i, j) in the Mandel order.
#[must_use]
pub fn mandel_index(i: usize, j: usize) -> usize {
    const INDEX: [[usize; 3]; 3] = [[0, 2, 5], [2, 1, 4], [5, 4, 3]];
    INDEX[i][j]
}

/// Factor by which component (i, j) of a tensor enters its Mandel vector: 1 or √2.
#[must_use]
pub fn mandel_weight(i: usize, j: usize) -> f64 {
    if i == j { 1.0 } else { std::f64::consts::SQRT_2 }
}

/// A symmetric second-order tensor by its Mandel components.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sym(pub [f64; 6]);

impl Sym {
    /// The zero tensor.
    pub const ZERO: Sym = Sym([0.0; 6]);

    /// The identity of 𝕊^d.
    #[must_use]
    pub fn identity(dim: usize) -> Sym {
        Sym::from_fn(dim, |i, j| if i == j { 1.0 } else { 0.0 })
    }

    /// The tensor with components `f(i, j)`, i ≤ j < dim.
    pub fn from_fn(dim: usize, f: impl Fn(usize, usize) -> f64) -> Sym {
        let mut sym = Sym::ZERO;
        for (m, &(i, j)) in MANDEL.iter().enumerate().take(mandel_len(dim)) {
            sym.0[m] = mandel_weight(i, j) * f(i, j);
        }
        sym
    }

    /// Component (i, j) of the tensor.
    #[must_use]
    pub fn get(&self, i: usize, j: usize) -> f64 {
        self.0[mandel_index(i, j)] / mandel_weight(i, j)
    }

    /// Trace over all three directions.
    #[must_use]
    pub fn trace(&self) -> f64 {
        self.0[0] + self.0[1] + self.0[3]
    }

    /// Inner product σ·τ = σ_ij τ_ij.
    #[must_use]
    pub fn dot(&self, other: &Sym) -> f64 {
        self.0.iter().zip(&other.0).map(|(a, b)| a * b).sum()
    }

    /// Norm ‖σ‖ = (σ·σ)^½.
    #[must_use]
    pub fn norm(&self) -> f64 {
        self.dot(self).sqrt()
    }

    /// The vector σ v.
    #[must_use]
    pub fn apply(&self, v: &Point) -> Point {
        std::array::from_fn(|i| (0..3).map(|j| self.get(i, j) * v[j]).sum())
    }

    /// Von Mises stress `√(3/2 s·s)`, s the deviator in three dimensions.
    #[must_use]
    pub fn von_mises(&self) -> f64 {
        let mean = self.trace() / 3.0;
        let mut s = *self;
        for m in [0, 1, 3] {
            s.0[m] -= mean;
        }
        (1.5 * s.dot(&s)).sqrt()
    }

    /// Eigenvalues of the leading `dim` × `dim` block, ascending.
    #[must_use]
    pub fn eigenvalues(&self, dim: usize) -> Vec<f64> {
        symmetric_eigenvalues(dim, |i, j| self.get(i, j))
    }
}

impl Add for Sym {
    type Output = Sym;
    fn add(mut self, other: Sym) -> Sym {
        self += other;
        self
    }
}

impl AddAssign for Sym {
    fn add_assign(&mut self, other: Sym) {
        for (a, b) in self.0.iter_mut().zip(&other.0) {
            *a += b;
        }
    }
}

impl Sub for Sym {
    type Output = Sym;
    fn sub(mut self, other: Sym) -> Sym {
        for (a, b) in self.0.iter_mut().zip(&other.0) {
            *a -= b;
        }
        self
    }
}

impl Mul<Sym> for f64 {
    type Output = Sym;
    fn mul(self, mut sym: Sym) -> Sym {
        for a in &mut sym.0 {
            *a *= self;
        }
        sym
    }
}

/// A linear map on symmetric tensors by its matrix in Mandel components.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SymMap(pub [[f64; 6]; 6]);

impl SymMap {
    /// The map τ ↦ λ tr(τ) I + c τ on 𝕊^d, trace and identity those of d dimensions.
    #[must_use]
    pub fn isotropic(dim: usize, lambda: f64, c: f64) -> SymMap {
        let identity = Sym::identity(dim);
        let mut map = SymMap::default();
        for a in 0..mandel_len(dim) {
            for b in 0..mandel_len(dim) {
                map.0[a][b] = lambda * identity.0[a] * identity.0[b];
            }
            map.0[a][a] += c;
        }
        map
    }

    /// The image of `xi`.
    #[must_use]
    pub fn apply(&self, xi: &Sym) -> Sym {
        Sym(std::array::from_fn(|a| (0..6).map(|b| self.0[a][b] * xi.0[b]).sum()))
    }

    /// Eigenvalues on 𝕊^d of the symmetric part, ascending.
    #[must_use]
    pub fn eigenvalues(&self, dim: usize) -> Vec<f64> {
        symmetric_eigenvalues(mandel_len(dim), |i, j| 0.5 * (self.0[i][j] + self.0[j][i]))
    }
}

/// Eigenvalues, ascending, of a small symmetric matrix by cyclic Jacobi rotations.
///
/// Jacobi is backward stable and gives small eigenvalues of semidefinite matrices to the last
/// bits, which the verdict on (H3) depends on.
pub fn symmetric_eigenvalues(n: usize, f: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    let mut a: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| f(i, j)).collect()).collect();
    for _sweep in 0..64 {
        let off: f64 = (0..n).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| a[i][j].powi(2)).sum();
        if off == 0.0 {
            break;
        }
        for p in 0..n {
            for q in p + 1..n {
                if a[p][q] == 0.0 {
                    continue;
                }
                let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let t = if theta >= 0.0 { 1.0 } else { -1.0 } / (theta.abs() + theta.hypot(1.0));
                let c = 1.0 / t.hypot(1.0);
                let s = t * c;
                for row in &mut a {
                    let (x, y) = (row[p], row[q]);
                    row[p] = c * x - s * y;
                    row[q] = s * x + c * y;
                }
                for k in 0..n {
                    let (x, y) = (a[p][k], a[q][k]);
                    a[p][k] = c * x - s * y;
                    a[q][k] = s * x + c * y;
                }
                a[p][q] = 0.0;
                a[q][p] = 0.0;
            }
        }
    }
    let mut values: Vec<f64> = (0..n).map(|i| a[i][i]).collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Dot product of two vectors.
#[must_use]
pub fn dot(a: &Point, b: &Point) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Euclidean length of a vector.
#[must_use]
pub fn length(a: &Point) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inner_product_is_the_full_contraction() {
        let a = [[1.0, 2.0, 3.0], [2.0, -4.0, 5.0], [3.0, 5.0, 6.0]];
        let b = [[0.5, -1.0, 2.0], [-1.0, 3.0, 0.25], [2.0, 0.25, -2.0]];
        for dim in 1..=3 {
            let full: f64 = (0..dim).flat_map(|i| (0..dim).map(move |j| (i, j))).map(|(i, j)| a[i][j] * b[i][j]).sum();
            let (s, t) = (Sym::from_fn(dim, |i, j| a[i][j]), Sym::from_fn(dim, |i, j| b[i][j]));
            assert!((s.dot(&t) - full).abs() < 1e-14);
            assert!((s.get(dim - 1, 0) - a[dim - 1][0]).abs() < 1e-15);
        }
    }

    #[test]
    fn von_mises_of_known_states() {
        let uniaxial = Sym::from_fn(3, |i, j| if i == 0 && j == 0 { 7.0 } else { 0.0 });
        assert!((uniaxial.von_mises() - 7.0).abs() < 1e-14);
        let shear = Sym::from_fn(2, |i, j| if i == j { 0.0 } else { 2.0 });
        assert!((shear.von_mises() - 2.0 * 3f64.sqrt()).abs() < 1e-14);
    }

    #[test]
    fn eigenvalues_of_the_all_ones_tensor_are_zero_and_the_dimension() {
        let ones = Sym::from_fn(2, |_, _| 1.0);
        let e = ones.eigenvalues(2);
        assert!(e[0].abs() < 1e-15 && (e[1] - 2.0).abs() < 1e-15);
        let e = Sym::from_fn(3, |_, _| 1.0).eigenvalues(3);
        assert!(e[0].abs() < 1e-15 && e[1].abs() < 1e-15 && (e[2] - 3.0).abs() < 1e-14);
    }

    #[test]
    fn isotropic_map_has_its_two_eigenvalues() {
        for dim in 1..=3 {
            let (lambda, c) = (0.7, 1.3);
            let e = SymMap::isotropic(dim, lambda, c).eigenvalues(dim);
            assert!((e[mandel_len(dim) - 1] - (dim as f64 * lambda + c)).abs() < 1e-14);
            assert!(dim == 1 || (e[0] - c).abs() < 1e-14);
        }
    }
}
