//! Linear tractions on a facet by their force, their moment, and what has neither.
//!
//! With the arms r_v of the vertices from the centre of a facet, the tangents t_k and a length ℓ, the moments
//! β_v = ∫_F t φ_v of a linear traction are
//!
//! ```text
//! β_v = f/d + Σ_k g_vk N_k,   Σ_v (r_v·t_k/ℓ) g_vj = δ_kj,
//! ```
//!
//! f the force, N_k = Σ_v (r_v·t_k/ℓ) β_v the couples, and Σ_k t_k × N_k = m the moment over ℓ. The couples without a
//! moment are tangential and symmetric: one on a side in the plane, three on a triangle.
//!
//! On a parallelogram the moments with the bilinear functions have one part more without force and moment, ±H/4 at the
//! vertices by turns, and the traction has parts without such moments (`parallelogram`).

use crate::tensor::{Point, dot, length, minus};

/// Parts of a component of a traction on a parallelogram that have no moments with the functions of its vertices.
pub(super) const PARTS: usize = 8;

/// The components of a traction on a facet: force, moment over ℓ, the couples without a moment, and on a parallelogram
/// H and the parts without moments, N.
pub(super) type FacetComponents = [f64; MOST];

/// First component of the parts without moments of a traction on a parallelogram.
const FIRST_PART: usize = 12;
/// Components of a traction on a parallelogram, which has most.
pub(super) const MOST: usize = FIRST_PART + 3 * PARTS;

/// Number of components of a traction on a facet with a number of vertices.
pub(super) const fn components(dim: usize, vertices: usize) -> usize {
    if vertices == 4 { MOST } else { dim * dim }
}

/// Number of components of force and moment.
pub(super) const fn wrench(dim: usize) -> usize {
    dim * (dim + 1) / 2
}

pub(super) fn cross(a: &Point, b: &Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The frame of a facet.
#[derive(Clone, Copy, Debug)]
pub(super) struct FacetModes {
    dim: usize,
    vertices: usize,
    pub centre: Point,
    /// ℓ, m.
    pub size: f64,
    tangents: [Point; 2],
    normal: Point,
    /// r_v·t_k/ℓ per vertex.
    arms: [[f64; 2]; 4],
    /// g_vk per vertex.
    weights: [[f64; 2]; 4],
}

/// ±1 by turns around a parallelogram.
fn turns(vertex: usize) -> f64 {
    if vertex.is_multiple_of(2) { 1.0 } else { -1.0 }
}

impl FacetModes {
    /// The frame of a facet with these vertices, in their order around a parallelogram.
    pub fn new(dim: usize, vertices: &[Point]) -> FacetModes {
        let n = vertices.len() as f64;
        let centre: Point = std::array::from_fn(|c| vertices.iter().map(|x| x[c]).sum::<f64>() / n);
        let mut modes = FacetModes {
            dim,
            vertices: vertices.len(),
            centre,
            size: 1.0,
            tangents: [[0.0; 3]; 2],
            normal: [0.0; 3],
            arms: [[0.0; 2]; 4],
            weights: [[0.0; 2]; 4],
        };
        if dim < 2 {
            return modes;
        }
        let side = minus(&vertices[1], &vertices[0]);
        let long = length(&side);
        let t = side.map(|c| c / long);
        modes.tangents[0] = t;
        if dim == 2 {
            modes.size = long;
            modes.normal = [-t[1], t[0], 0.0];
            modes.arms[..2].copy_from_slice(&[[-0.5, 0.0], [0.5, 0.0]]);
            modes.weights[..2].copy_from_slice(&[[-1.0, 0.0], [1.0, 0.0]]);
            return modes;
        }
        let across = cross(&t, &minus(&vertices[2], &vertices[0]));
        let height = dot(&across, &across).sqrt();
        modes.normal = across.map(|c| c / height);
        modes.size = (long * height).sqrt();
        modes.tangents[1] = cross(&modes.normal, &t);
        for (arm, x) in modes.arms.iter_mut().zip(vertices) {
            let r = minus(x, &centre);
            *arm = modes.tangents.map(|t| dot(&r, &t) / modes.size);
        }
        let sum = |i: usize, j: usize| -> f64 { modes.arms.iter().map(|a| a[i] * a[j]).sum() };
        let (a, b, c) = (sum(0, 0), sum(0, 1), sum(1, 1));
        let determinant = a * c - b * b;
        modes.weights = modes.arms.map(|r| [(c * r[0] - b * r[1]) / determinant, (a * r[1] - b * r[0]) / determinant]);
        modes
    }

    /// The couples N_k of components.
    pub fn couples(&self, y: &[f64]) -> [Point; 2] {
        let ([t1, t2], n) = (&self.tangents, &self.normal);
        match self.dim {
            2 => [std::array::from_fn(|c| y[2] * n[c] + y[3] * t1[c]), [0.0; 3]],
            3 => {
                let m = [y[3], y[4], y[5]];
                let (along, turn) = ([dot(&m, t1), dot(&m, t2)], 0.5 * dot(&m, n));
                [
                    std::array::from_fn(|c| y[6] * t1[c] + (y[8] + turn) * t2[c] - along[1] * n[c]),
                    std::array::from_fn(|c| y[7] * t2[c] + (y[8] - turn) * t1[c] + along[0] * n[c]),
                ]
            }
            _ => [[0.0; 3]; 2],
        }
    }

    /// Number of components.
    pub fn components(&self) -> usize {
        components(self.dim, self.vertices)
    }

    /// What the components of a traction on a parallelogram have beside force and couples: H and the parts without
    /// moments.
    pub fn further<'y>(&self, y: &'y [f64]) -> impl Iterator<Item = Point> + 'y {
        let count = if self.vertices == 4 { MOST / 3 - 3 } else { 0 };
        (0..count).map(|part| std::array::from_fn(|c| y[9 + 3 * part + c]))
    }

    /// The moments of the vertices, N.
    pub fn moments(&self, y: &[f64]) -> [Point; 4] {
        let (d, n, couples) = (self.dim, self.vertices as f64, self.couples(y));
        let by_turns = self.further(y).next().unwrap_or([0.0; 3]);
        std::array::from_fn(|v| {
            let g = &self.weights[v];
            let turn = 0.25 * turns(v);
            let of = |c: usize| y[c] / n + g[0] * couples[0][c] + g[1] * couples[1][c] + turn * by_turns[c];
            std::array::from_fn(|c| if c < d && v < self.vertices { of(c) } else { 0.0 })
        })
    }

    /// The components of the moments of the vertices.
    pub fn of_moments(&self, moments: &[Point]) -> FacetComponents {
        let mut y = [0.0; MOST];
        let mut couples = [[0.0; 3]; 2];
        for (v, (moment, arm)) in moments.iter().zip(&self.arms).enumerate().take(self.vertices) {
            for c in 0..self.dim {
                y[c] += moment[c];
                if self.vertices == 4 {
                    y[9 + c] += turns(v) * moment[c];
                }
                (0..2).for_each(|k| couples[k][c] += arm[k] * moment[c]);
            }
        }
        let ([t1, t2], [a, b]) = (&self.tangents, &couples);
        match self.dim {
            2 => (y[2], y[3]) = (dot(a, &self.normal), dot(a, t1)),
            3 => {
                let (first, second) = (cross(t1, a), cross(t2, b));
                (0..3).for_each(|c| y[3 + c] = first[c] + second[c]);
                (y[6], y[7], y[8]) = (dot(a, t1), dot(b, t2), 0.5 * (dot(a, t2) + dot(b, t1)));
            }
            _ => {}
        }
        y
    }

    /// The slope in the components of a function whose slope in the moments is known.
    pub fn slopes(&self, of_moments: &[Point]) -> FacetComponents {
        let (d, n) = (self.dim, self.vertices as f64);
        let mut y = [0.0; MOST];
        let mut couples = [[0.0; 3]; 2];
        for (v, (slope, g)) in of_moments.iter().zip(&self.weights).enumerate().take(self.vertices) {
            for c in 0..d {
                y[c] += slope[c] / n;
                if self.vertices == 4 {
                    y[9 + c] += 0.25 * turns(v) * slope[c];
                }
                (0..2).for_each(|k| couples[k][c] += g[k] * slope[c]);
            }
        }
        let ([t1, t2], n, [a, b]) = (&self.tangents, &self.normal, &couples);
        match d {
            2 => (y[2], y[3]) = (dot(a, n), dot(a, t1)),
            3 => {
                let turn = 0.5 * (dot(a, t2) - dot(b, t1));
                (0..3).for_each(|c| y[3 + c] = turn * n[c] - dot(a, n) * t2[c] + dot(b, n) * t1[c]);
                (y[6], y[7], y[8]) = (dot(a, t1), dot(b, t2), dot(a, t2) + dot(b, t1));
            }
            _ => {}
        }
        y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Components give their moments back, force and moment are those of the vertices, and slopes are the transpose.
    #[test]
    fn components_are_moments_in_another_frame() {
        for (dim, n) in [(1, 1), (2, 2), (3, 3), (3, 4)] {
            // The last one makes a parallelogram of the others.
            let vertices = [[0.3, -0.2, 0.1], [1.4, 0.9, -0.3], [0.1, 1.2, 0.8], [-1.0, 0.1, 1.2]]
                .map(|x: Point| std::array::from_fn::<f64, 3, _>(|c| if c < dim { x[c] } else { 0.0 }));
            let vertices = &vertices[..n];
            let modes = FacetModes::new(dim, vertices);
            let given: Vec<Point> = (0..n)
                .map(|v| std::array::from_fn(|c| if c < dim { (1.7 * (v * v) as f64 + c as f64).sin() } else { 0.0 }))
                .collect();
            let y = modes.of_moments(&given);
            let back = modes.moments(&y);
            for (a, b) in given.iter().zip(&back) {
                assert!((0..3).all(|c| (a[c] - b[c]).abs() < 1e-14), "{dim}: {a:?} {b:?}");
            }
            let sum =
                |of: &dyn Fn(usize) -> Point| -> Point { std::array::from_fn(|c| (0..n).map(|v| of(v)[c]).sum()) };
            let force = sum(&|v| given[v]);
            let moment = sum(&|v| cross(&minus(&vertices[v], &modes.centre), &given[v]));
            assert!((0..dim).all(|c| (force[c] - y[c]).abs() < 1e-14));
            let of_modes = if dim == 2 { [0.0, 0.0, y[2]] } else { [y[3], y[4], y[5]] };
            assert!((0..3).all(|c| (moment[c] - modes.size * of_modes[c]).abs() < 1e-14), "{moment:?} {y:?}");
            let slope = sum(&|v| std::array::from_fn(|c| given[v][c] * back[v][c]));
            let product: f64 = modes.slopes(&given).iter().zip(&y).map(|(a, b)| a * b).sum();
            assert!((product - slope.iter().sum::<f64>()).abs() < 1e-13);
        }
    }
}
