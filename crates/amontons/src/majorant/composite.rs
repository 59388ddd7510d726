//! The composite element of Johnson and Mercier: symmetric stresses with given tractions on a simplex.
//!
//! The simplex is cut into d + 1 parts at its barycentre. The stress is linear in each part, and its tractions are
//! continuous between the parts. It is determined by linear tractions on the facets and its mean. If these balance a
//! load in the sense ∫_∂K t·v − ∫ σ:ε(v) = −∫ f·v for all linear v, then div σ = −f with a constant f.
//!
//! Sources: C. Johnson, B. Mercier, Numer. Math. 30 (1978) 103–116 (plane); J. Gopalakrishnan, J. Guzmán, J. J. Lee,
//! "The Johnson–Mercier elasticity element in any dimensions" (2024).

use faer::Mat;
use faer::prelude::Solve;

use crate::tensor::{MANDEL, Point, Sym, mandel_index, mandel_len};

/// The element on the simplex with the vertices 0, e_1 … e_d.
///
/// The stress of another simplex with edges B e_i is σ = B σ̂ Bᵀ / det B: moments of tractions then are B times those
/// of σ̂, and ∫ σ is B ∫ σ̂ Bᵀ.
#[derive(Debug)]
pub(super) struct Composite {
    pub dim: usize,
    /// Components of σ̂ at the nodes of the parts, per moment or mean that is 1: row (part, node, component).
    inverse: Vec<Vec<f64>>,
}

/// Gradients of the barycentric coordinates of the reference simplex.
fn gradients(dim: usize) -> Vec<Point> {
    let unit = |c: usize| -> Point { std::array::from_fn(|i| f64::from(u8::from(i == c))) };
    let first: Point = std::array::from_fn(|i| if i < dim { -1.0 } else { 0.0 });
    std::iter::once(first).chain((0..dim).map(unit)).collect()
}

/// The volume of the reference simplex.
pub(super) fn volume(dim: usize) -> f64 {
    [1.0, 1.0, 0.5, 1.0 / 6.0][dim.min(3)]
}

impl Composite {
    /// Number of data: d moments per facet and vertex of the facet, then the components of ∫ σ̂.
    pub fn data(dim: usize) -> usize {
        (dim + 1) * dim * dim + mandel_len(dim)
    }

    /// Place of the moments of a facet, which is opposite to a vertex, at a vertex: component c follows.
    pub fn place(dim: usize, facet: usize, vertex: usize) -> usize {
        (facet * dim + if vertex > facet { vertex - 1 } else { vertex }) * dim
    }

    /// The element in one, two or three dimensions.
    pub fn new(dim: usize) -> Composite {
        let (n, m, gradients) = (dim + 1, mandel_len(dim), gradients(dim));
        let size = n * n * m;
        let unknown = |part: usize, node: usize, r: usize, c: usize| (part * n + node) * m + component(r, c);
        let mut rows: Vec<(Vec<f64>, Option<usize>)> = Vec::new();
        // Tractions are continuous between the parts s and t, on which λ_s = λ_t.
        for s in 0..n {
            for t in s + 1..n {
                let normal: Point = std::array::from_fn(|c| gradients[s][c] - gradients[t][c]);
                // Node t of part s and node s of part t lie off the facet; the centre is node s of part s.
                for node in (0..n).filter(|&node| node != t) {
                    let other = if node == s { t } else { node };
                    for r in 0..dim {
                        let mut row = vec![0.0; size];
                        for c in 0..dim {
                            row[unknown(s, node, r, c)] += normal[c];
                            row[unknown(t, other, r, c)] -= normal[c];
                        }
                        rows.push((row, None));
                    }
                }
            }
        }
        // Moments of tractions: |F| ν = −d |K| ∇λ, ∫ φ_a φ_b = |F| (1 + δ_ab)/(d (d + 1)).
        for facet in 0..n {
            for a in (0..n).filter(|&a| a != facet) {
                for r in 0..dim {
                    let mut row = vec![0.0; size];
                    for b in (0..n).filter(|&b| b != facet) {
                        let share = if a == b { 2.0 } else { 1.0 } / (dim * (dim + 1)) as f64;
                        for c in 0..dim {
                            let normal = -(dim as f64) * volume(dim) * gradients[facet][c];
                            row[unknown(facet, b, r, c)] += share * normal;
                        }
                    }
                    rows.push((row, Some(Composite::place(dim, facet, a) + r)));
                }
            }
        }
        for k in 0..m {
            let mut row = vec![0.0; size];
            for corner in 0..n * n {
                row[corner * m + k] = volume(dim) / (n * n) as f64;
            }
            rows.push((row, Some((dim + 1) * dim * dim + k)));
        }
        Composite { dim, inverse: solved(&rows, Composite::data(dim)) }
    }

    /// The stresses of the reference simplex at node `node` of part `part`; node s of part s is the centre.
    pub fn at_node(&self, data: &[f64], part: usize, node: usize) -> Sym {
        let m = mandel_len(self.dim);
        let first = (part * (self.dim + 1) + node) * m;
        let sum = |row: &Vec<f64>| -> f64 { row.iter().zip(data).map(|(a, b)| a * b).sum() };
        let components: Vec<f64> = self.inverse[first..first + m].iter().map(sum).collect();
        Sym::from_fn(self.dim, |r, c| components[component(r, c)])
    }
}

fn get(tensor: &Sym, i: usize, j: usize, dim: usize) -> f64 {
    if i < dim && j < dim { tensor.get(i, j) } else { 0.0 }
}

/// Number of a component in the order of Mandel's.
fn component(r: usize, c: usize) -> usize {
    mandel_index(r, c)
}

/// The map of the reference simplex onto a simplex.
#[derive(Clone, Copy, Debug)]
pub(super) struct SimplexMap {
    pub dim: usize,
    /// Columns of B.
    columns: [Point; 3],
    /// Rows of B⁻¹.
    inverse: [Point; 3],
    /// det B, and the volume of the simplex.
    pub determinant: f64,
}

impl SimplexMap {
    /// The map onto the simplex with these vertices.
    pub fn new(dim: usize, vertices: &[Point]) -> SimplexMap {
        let mut columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for (c, column) in columns.iter_mut().enumerate().take(dim) {
            for d in 0..dim {
                column[d] = vertices[c + 1][d] - vertices[0][d];
            }
        }
        let cross =
            |a: &Point, b: &Point| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let [a, b, c] = &columns;
        let rows = [cross(b, c), cross(c, a), cross(a, b)];
        let determinant: f64 = a.iter().zip(&rows[0]).map(|(x, y)| x * y).sum();
        SimplexMap {
            dim,
            columns,
            inverse: rows.map(|row| row.map(|x| x / determinant)),
            determinant: determinant.abs(),
        }
    }

    /// B⁻¹ v.
    pub fn inverse_times(&self, v: &Point) -> Point {
        self.inverse.map(|row| row.iter().zip(v).map(|(a, b)| a * b).sum())
    }

    /// B⁻ᵀ v.
    pub fn inverse_transposed_times(&self, v: &Point) -> Point {
        std::array::from_fn(|c| self.inverse.iter().zip(v).map(|(row, v)| row[c] * v).sum())
    }

    /// The gradient of the linear function of a vertex, 1/m.
    pub fn gradient(&self, vertex: usize) -> Point {
        match vertex {
            0 => std::array::from_fn(|c| 0.0 - self.inverse[..self.dim].iter().map(|row| row[c]).sum::<f64>()),
            vertex => self.inverse[vertex - 1],
        }
    }

    /// B⁻¹ T B⁻ᵀ of a symmetric tensor, by component in the order of Mandel's, which are not weighted.
    pub fn pulled(&self, total: &Sym) -> [f64; 6] {
        let dim = self.dim;
        let rows: [Point; 3] =
            std::array::from_fn(|j| self.inverse_times(&std::array::from_fn(|i| get(total, i, j, dim))));
        let column = |j: usize| -> Point { std::array::from_fn(|i| if i < dim { rows[i][j] } else { 0.0 }) };
        let columns: [Point; 3] = std::array::from_fn(|j| self.inverse_times(&column(j)));
        let mut pulled = [0.0; 6];
        for (value, &(r, c)) in pulled.iter_mut().zip(&MANDEL).take(mandel_len(dim)) {
            *value = 0.5 * (columns[r][c] + columns[c][r]);
        }
        pulled
    }

    /// B v / det B, the divergence of a stress from that of σ̂.
    pub fn piola(&self, v: &Point) -> Point {
        let sum = |c: usize| (0..self.dim).map(|k| self.columns[k][c] * v[k]).sum::<f64>() / self.determinant;
        std::array::from_fn(|c| if c < self.dim { sum(c) } else { 0.0 })
    }

    /// Bᵀ ε B of a strain.
    pub fn strain(&self, strain: &Sym) -> Sym {
        let dim = self.dim;
        let b = |i: usize, k: usize| self.columns[k][i];
        Sym::from_fn(dim, |k, l| {
            let mut sum = 0.0;
            for i in 0..dim {
                for j in 0..dim {
                    sum += b(i, k) * strain.get(i, j) * b(j, l);
                }
            }
            sum
        })
    }

    /// B σ̂ Bᵀ / det B.
    pub fn stress(&self, reference: &Sym) -> Sym {
        let dim = self.dim;
        let b = |i: usize, k: usize| self.columns[k][i];
        Sym::from_fn(dim, |i, j| {
            let mut sum = 0.0;
            for k in 0..dim {
                for l in 0..dim {
                    sum += b(i, k) * reference.get(k, l) * b(j, l);
                }
            }
            sum / self.determinant
        })
    }
}

/// All unknowns per datum that is 1.
fn solved(rows: &[(Vec<f64>, Option<usize>)], data: usize) -> Vec<Vec<f64>> {
    let size = rows.len();
    let matrix = Mat::from_fn(size, size, |i, j| rows[i].0[j]);
    let right = Mat::from_fn(size, data, |i, j| f64::from(u8::from(rows[i].1 == Some(j))));
    let solution = matrix.partial_piv_lu().solve(right);
    (0..size).map(|i| (0..data).map(|j| solution[(i, j)]).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A linear stress with constant divergence is its own composite stress: traction moments and mean determine it.
    #[test]
    fn a_linear_stress_is_found_from_its_tractions_and_its_mean() {
        for dim in 1..=3 {
            let element = Composite::new(dim);
            let vertices: Vec<Point> =
                [[0.3, -0.2, 0.1], [2.0, 0.4, -0.3], [0.1, 1.4, 0.2], [-0.5, 0.3, 0.9]][..=dim].to_vec();
            let map = SimplexMap::new(dim, &vertices);
            let at = |x: &Point| {
                Sym::from_fn(dim, |i, j| {
                    let k = (i.min(j) + 2 * i.max(j)) as f64;
                    1.0 + k + (0..dim).map(|c| (0.7 + (k * 1.3 + c as f64).sin()) * x[c]).sum::<f64>()
                })
            };
            let values: Vec<Sym> = vertices.iter().map(at).collect();
            // Area times outward normal of the facet opposite to a vertex: −d |K| ∇λ.
            let normal = |facet: usize| -> Point {
                let gradient = gradients(dim)[facet];
                std::array::from_fn(|c| {
                    let along: f64 = (0..dim).map(|k| map.inverse[k][c] * gradient[k]).sum();
                    -(dim as f64) * volume(dim) * map.determinant * along
                })
            };
            let moment = |facet: usize, a: usize| -> Point {
                let mut sum = [0.0; 3];
                for b in (0..=dim).filter(|&b| b != facet) {
                    let share = if a == b { 2.0 } else { 1.0 } / (dim * (dim + 1)) as f64;
                    let traction = values[b].apply(&normal(facet));
                    (0..3).for_each(|c| sum[c] += share * traction[c]);
                }
                sum
            };
            let share = volume(dim) * map.determinant / (dim + 1) as f64;
            let total = values.iter().fold(Sym::ZERO, |sum, value| sum + share * *value);
            let pairs = (0..=dim).flat_map(|facet| (0..=dim).map(move |vertex| (facet, vertex)));
            let moments: Vec<(usize, usize, Point)> = pairs
                .filter(|(facet, vertex)| facet != vertex)
                .map(|(facet, vertex)| (facet, vertex, moment(facet, vertex)))
                .collect();
            let mut data = vec![0.0; Composite::data(dim)];
            for (facet, vertex, moment) in &moments {
                let moment = map.inverse_times(moment);
                let place = Composite::place(dim, *facet, *vertex);
                data[place..place + dim].copy_from_slice(&moment[..dim]);
            }
            data[(dim + 1) * dim * dim..].copy_from_slice(&map.pulled(&total)[..mandel_len(dim)]);
            let centre: Point = std::array::from_fn(|c| vertices.iter().map(|x| x[c]).sum::<f64>() / (dim + 1) as f64);
            let size = values.iter().fold(0.0, |most: f64, value| most.max(value.norm()));
            for part in 0..=dim {
                for node in 0..=dim {
                    let x = if node == part { centre } else { vertices[node] };
                    let difference = map.stress(&element.at_node(&data, part, node)) - at(&x);
                    assert!(difference.norm() < 1e-12 * size, "{dim} {part} {node}: {difference:?} of {size}");
                }
            }
        }
    }
}
