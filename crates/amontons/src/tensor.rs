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

    /// The deviator in three dimensions, σ − tr(σ)/3 I; that of a plane tensor has a component 33.
    #[must_use]
    pub fn deviator(&self) -> Sym {
        let mean = self.trace() / 3.0;
        let mut s = *self;
        for m in [0, 1, 3] {
            s.0[m] -= mean;
        }
        s
    }

    /// Von Mises stress `√(3/2 s·s)`, s the deviator in three dimensions.
    #[must_use]
    pub fn von_mises(&self) -> f64 {
        let s = self.deviator();
        let scale = safe_scale(
            s.0.iter().fold(0.0, |max, c| if c.is_nan() || max.is_nan() { f64::NAN } else { c.abs().max(max) }),
        );
        let s = scale * s;
        (1.5 * s.dot(&s)).sqrt() / scale
    }

    /// The tensor with the principal values `values` along the axes to which `rotation` turns the coordinate axes: 𝓚, 𝓜
    /// or 𝓡 of a material with its own axes. Missing values are zero.
    #[must_use]
    pub fn principal(values: &[f64], rotation: &Rotation) -> Sym {
        rotation.tensor(&Sym::from_fn(3, |i, j| if i == j { values.get(i).copied().unwrap_or(0.0) } else { 0.0 }))
    }

    /// Eigenvalues of the leading `dim` × `dim` block, ascending.
    #[must_use]
    pub fn eigenvalues(&self, dim: usize) -> Vec<f64> {
        symmetric_eigenvalues(dim, |i, j| self.get(i, j))
    }

    /// Principal values σ₁ ≥ σ₂ ≥ σ₃ in three dimensions, each with its unit direction, whose sign makes its largest
    /// component positive.
    #[must_use]
    pub fn principal_axes(&self) -> [(f64, Point); 3] {
        let mut vectors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let a = jacobi(3, |i, j| self.get(i, j), &mut vectors);
        let mut axes: [(f64, Point); 3] = std::array::from_fn(|c| {
            let v = [vectors[0][c], vectors[1][c], vectors[2][c]];
            let largest = v.iter().fold(0.0f64, |m, x| if x.abs() > m.abs() { *x } else { m });
            (a[c][c], v.map(|x| if largest < 0.0 { 0.0 - x } else { x }))
        });
        axes.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        axes
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
    /// The map τ ↦ λ tr(τ) I + c τ on 𝕊^d, with trace and identity in d dimensions.
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

/// A rotation of ℝ³, given by the matrix R whose columns are the turned coordinate axes.
///
/// It converts tensors from the axes of a material to those of the body: τ ↦ R τ Rᵀ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation([[f64; 3]; 3]);

/// A matrix that is not a rotation.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "not a rotation: the largest entry of RRᵀ − I is {deviation:e} and the determinant {determinant}, expected 0 and 1"
)]
pub struct NotARotation {
    /// Largest entry of RRᵀ − I.
    pub deviation: f64,
    /// det R.
    pub determinant: f64,
}

impl Rotation {
    /// No rotation.
    pub const IDENTITY: Rotation = Rotation([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);

    /// The rotation of axis 1 towards axis 2 by `angle` in radians.
    #[must_use]
    pub fn in_plane(angle: f64) -> Rotation {
        let (s, c) = angle.sin_cos();
        Rotation([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    }

    /// The rotation about a vector by `angle` in radians, by the right-hand rule (Rodrigues' formula).
    #[must_use]
    pub fn about(axis: &Point, angle: f64) -> Rotation {
        let size = length(axis);
        let [x, y, z] = axis.map(|c| c / size);
        let (s, c) = angle.sin_cos();
        let v = 1.0 - c;
        Rotation([
            [c + x * x * v, x * y * v - z * s, x * z * v + y * s],
            [y * x * v + z * s, c + y * y * v, y * z * v - x * s],
            [z * x * v - y * s, z * y * v + x * s, c + z * z * v],
        ])
    }

    /// R v.
    #[must_use]
    pub fn vector(&self, v: &Point) -> Point {
        self.0.map(|row| dot(&row, v))
    }

    /// Bunge's Euler angles (φ₁, Φ, φ₂) in radians: about axis 3, the turned axis 1, the turned axis 3;
    /// R = R₃(φ₁) R₁(Φ) R₃(φ₂). (φ₁, 0, 0) is [`Rotation::in_plane`].
    #[must_use]
    pub fn euler(angles: [f64; 3]) -> Rotation {
        let (s, c) = angles[1].sin_cos();
        let tilt = Rotation([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]);
        Rotation::in_plane(angles[0]).after(&tilt).after(&Rotation::in_plane(angles[2]))
    }

    /// The rotation with the matrix `rows`.
    ///
    /// # Errors
    /// Fails if an entry of RRᵀ − I exceeds 1e-9, or if R changes the handedness.
    pub fn new(rows: [[f64; 3]; 3]) -> Result<Rotation, NotARotation> {
        let [a, b, c] = rows;
        let determinant = dot(&a, &[b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]]);
        let product = |i: usize, j: usize| dot(&rows[i], &rows[j]) - if i == j { 1.0 } else { 0.0 };
        let deviation = MANDEL.iter().map(|&(i, j)| product(i, j).abs()).fold(0.0, |m, v| if v <= m { m } else { v });
        if deviation <= 1e-9 && determinant > 0.0 {
            Ok(Rotation(rows))
        } else {
            Err(NotARotation { deviation, determinant })
        }
    }

    /// The rotation that applies `first`, then this one.
    #[must_use]
    pub fn after(&self, first: &Rotation) -> Rotation {
        Rotation(std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| self.0[i][k] * first.0[k][j]).sum())))
    }

    /// R τ Rᵀ.
    #[must_use]
    pub fn tensor(&self, tau: &Sym) -> Sym {
        Sym::from_fn(3, |i, j| dot(&self.0[i], &tau.apply(&self.0[j])))
    }

    /// The map τ ↦ R A(Rᵀ τ R) Rᵀ: a material law in the axes of the body.
    #[must_use]
    pub fn map(&self, a: &SymMap) -> SymMap {
        // Columns of the orthogonal matrix that rotates Mandel vectors.
        let q: [Sym; 6] = std::array::from_fn(|m| {
            let mut unit = Sym::ZERO;
            unit.0[m] = 1.0;
            self.tensor(&unit)
        });
        let entry = |i: usize, j: usize| {
            (0..6).flat_map(|k| (0..6).map(move |l| (k, l))).map(|(k, l)| q[k].0[i] * a.0[k][l] * q[l].0[j]).sum()
        };
        SymMap(std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))))
    }
}

/// Eigenvalues, ascending, of a small symmetric matrix by cyclic Jacobi rotations.
///
/// Jacobi's method is backward stable and gives small eigenvalues of semidefinite matrices to the last bits, on which
/// the verdict on (H3) depends.
pub fn symmetric_eigenvalues(n: usize, f: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    let mut values: Vec<f64> = jacobi(n, f, &mut []).iter().enumerate().map(|(i, row)| row[i]).collect();
    values.sort_by(f64::total_cmp);
    values
}

/// The matrix after rotations that make it diagonal; the rows of `vectors`, if any, are rotated, too.
fn jacobi(n: usize, f: impl Fn(usize, usize) -> f64, vectors: &mut [Point]) -> Vec<Vec<f64>> {
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
                for row in vectors.iter_mut() {
                    let (x, y) = (row[p], row[q]);
                    row[p] = c * x - s * y;
                    row[q] = s * x + c * y;
                }
            }
        }
    }
    a
}

/// Dot product of two vectors.
#[must_use]
pub fn dot(a: &Point, b: &Point) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The difference a − b of two vectors.
#[must_use]
pub fn minus(a: &Point, b: &Point) -> Point {
    std::array::from_fn(|c| a[c] - b[c])
}

/// A power of two by which numbers up to `largest` can be multiplied so that their squares neither under- nor overflow;
/// 1 if none is needed.
#[must_use]
pub(crate) fn safe_scale(largest: f64) -> f64 {
    if largest == 0.0 || !largest.is_finite() || (1e-140..=1e140).contains(&largest) {
        1.0
    } else {
        (-largest.log2().floor()).clamp(-1000.0, 1000.0).exp2()
    }
}

/// The nonzero directions among three, of which unused ones are zero.
pub fn given(directions: &[Point; 3]) -> impl Iterator<Item = &Point> {
    directions.iter().filter(|direction| direction.iter().any(|c| *c != 0.0))
}

/// Euclidean length of a vector of any size; squares that would under- or overflow are scaled first.
#[must_use]
pub fn length(a: &Point) -> f64 {
    let scale = safe_scale(a.iter().fold(0.0, |m, c| m.max(c.abs())));
    let scaled = a.map(|c| c * scale);
    dot(&scaled, &scaled).sqrt() / scale
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
        for size in [1e-290, 1e-170, 1e170, 1e290] {
            assert!(((size * shear).von_mises() / size - 2.0 * 3f64.sqrt()).abs() < 1e-14, "{size:e}");
        }
    }

    /// A quarter turn exchanges axes; powers of tensors and eigenvalues of maps are invariant; the angles are Bunge's
    /// (1982, *Texture Analysis in Materials Science*).
    #[test]
    fn rotations_turn_tensors_and_maps() -> Result<(), NotARotation> {
        let k = Sym::principal(&[5.0, 2.0, 1.0], &Rotation::in_plane(0.5 * std::f64::consts::PI));
        assert!(
            (k.get(0, 0) - 2.0).abs() < 1e-15 && (k.get(1, 1) - 5.0).abs() < 1e-15 && (k.get(2, 2) - 1.0).abs() < 1e-15
        );
        // k₁₂ = (k₁ − k₂) sin α cos α.
        let k = Sym::principal(&[5.0, 2.0], &Rotation::in_plane(0.3));
        assert!((k.get(0, 1) - 3.0 * 0.3f64.sin() * 0.3f64.cos()).abs() < 1e-15);
        let (a, b, c) = (0.4f64, 1.1f64, -0.7f64);
        let r = Rotation::euler([a, b, c]);
        assert!((r.0[0][0] - (a.cos() * c.cos() - a.sin() * c.sin() * b.cos())).abs() < 1e-15);
        assert!((r.0[0][1] + a.cos() * c.sin() + a.sin() * c.cos() * b.cos()).abs() < 1e-15);
        assert!((r.0[0][2] - a.sin() * b.sin()).abs() < 1e-15 && (r.0[2][0] - c.sin() * b.sin()).abs() < 1e-15);
        let e = Sym::principal(&[5.0, 2.0, 1.0], &Rotation::new(r.0)?).eigenvalues(3);
        assert!((e[0] - 1.0).abs() < 1e-14 && (e[1] - 2.0).abs() < 1e-14 && (e[2] - 5.0).abs() < 1e-14);
        let map = SymMap(std::array::from_fn(|i| std::array::from_fn(|j| 1.0 / (1 + i + j) as f64)));
        let tau = Sym([0.3, -0.2, 0.5, 0.1, 0.7, -0.4]);
        let (inside, outside) = (r.tensor(&map.apply(&tau)), r.map(&map).apply(&r.tensor(&tau)));
        assert!((inside - outside).norm() < 1e-14);
        let mirror = Rotation::new([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]);
        assert_eq!(mirror, Err(NotARotation { deviation: 0.0, determinant: -1.0 }));
        assert!(
            Rotation::new([[1.0, 0.1, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
                .is_err_and(|e| (e.deviation - 0.1).abs() < 1e-15)
        );
        assert!(Rotation::new([[f64::NAN; 3]; 3]).is_err());
        Ok(())
    }

    #[test]
    fn eigenvalues_of_the_all_ones_tensor_are_zero_and_the_dimension() {
        let ones = Sym::from_fn(2, |_, _| 1.0);
        let e = ones.eigenvalues(2);
        assert!(e[0].abs() < 1e-15 && (e[1] - 2.0).abs() < 1e-15);
        let e = Sym::from_fn(3, |_, _| 1.0).eigenvalues(3);
        assert!(e[0].abs() < 1e-15 && e[1].abs() < 1e-15 && (e[2] - 3.0).abs() < 1e-14);
    }

    /// σ v = λ v with orthonormal v of either handedness, in descending order; uniaxial stress has a known axis.
    #[test]
    fn principal_axes_are_eigenvectors() {
        let s = Sym::from_fn(3, |i, j| [[3.0, -1.0, 0.5], [-1.0, 2.0, 4.0], [0.5, 4.0, -6.0]][i][j]);
        let axes = s.principal_axes();
        assert!(axes[0].0 > axes[1].0 && axes[1].0 > axes[2].0);
        assert!((axes.iter().map(|a| a.0).sum::<f64>() - s.trace()).abs() < 1e-14);
        for (i, (value, v)) in axes.iter().enumerate() {
            let image = s.apply(v);
            assert!((0..3).all(|c| (image[c] - value * v[c]).abs() < 1e-14), "{image:?}");
            for (j, (_, w)) in axes.iter().enumerate() {
                assert!((dot(v, w) - if i == j { 1.0 } else { 0.0 }).abs() < 1e-15);
            }
        }
        let n = [2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0];
        let (value, along) = Sym::from_fn(3, |i, j| 5.0 * n[i] * n[j]).principal_axes()[0];
        assert!((value - 5.0).abs() < 1e-14 && (0..3).all(|c| (along[c] - n[c]).abs() < 1e-14), "{along:?}");
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
