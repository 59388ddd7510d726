//! Tractions on a parallelogram in four triangles about its middle.
//!
//! Triangle j has the vertices j and j + 1 and the middle. A traction is linear on each triangle. Its moments with the
//! bilinear functions of the vertices, b_v = ∫ t φ_v, enter the balance of cells. For any b_v there is one continuous
//! traction whose value at the middle is the mean of those at the vertices; all others add a part without moments.

use super::dense::{Semidefinite, kernel};
use super::modes::PARTS;
use super::skeleton::linear_functions;
use crate::element::Q1_QUADRILATERAL;
use crate::quadrature::{QuadratureRule, Shape, rule};
use crate::tensor::Point;

/// Moments ∫ t λ of a component of a traction per triangle and vertex of the triangle.
pub(super) const MOMENTS: usize = 12;

/// The triangle of a point of the square [0, 1]², and its barycentric coordinates there.
fn in_triangle(x: &Point) -> (usize, [f64; 3]) {
    let [x, y, _] = *x;
    let edges = [(y, x), (1.0 - x, y), (1.0 - y, 1.0 - x), (x, 1.0 - y)];
    let nearest = (1..4).fold(0, |best, j| if edges[j].0 < edges[best].0 { j } else { best });
    let (distance, along) = edges[nearest];
    (nearest, [1.0 - distance - along, along - distance, 2.0 * distance])
}

/// The functions of the vertices that are linear on each triangle, and a quarter at the middle.
pub(super) fn functions(x: &Point) -> Vec<f64> {
    let (triangle, [first, second, middle]) = in_triangle(x);
    let mut values = vec![0.25 * middle; 4];
    values[triangle] += first;
    values[(triangle + 1) % 4] += second;
    values
}

/// A rule on the four triangles, from one on the triangle (0,0), (1,0), (0,1).
pub(super) fn on_triangles(of_triangle: &QuadratureRule) -> QuadratureRule {
    let mut all = QuadratureRule { points: Vec::new(), weights: Vec::new() };
    for j in 0..4 {
        let [a, b] = [j, (j + 1) % 4].map(|v| Q1_QUADRILATERAL.nodes[v]);
        for (x, weight) in of_triangle.iter() {
            let (s, t) = (x[0], x[1]);
            let at = |c: usize| (1.0 - s - t) * a[c] + s * b[c] + t * 0.5;
            all.points.push([at(0), at(1), 0.0]);
            // The triangle has half the area of that of the rule.
            all.weights.push(0.5 * weight);
        }
    }
    all
}

/// The rule of a degree for functions that are polynomials on each triangle, or on the whole of another shape.
pub(super) fn traction_rule(shape: Shape, degree: usize) -> QuadratureRule {
    if shape == Shape::Quadrilateral { on_triangles(&rule(Shape::Triangle, degree)) } else { rule(shape, degree) }
}

/// ∫ over the parallelogram, of unit area, of the bilinear function of vertex `a` times that of vertex `b`.
pub(super) fn bilinear_products(a: usize, b: usize) -> f64 {
    [4.0, 2.0, 1.0, 2.0][(4 + a - b) % 4] / 36.0
}

/// The moments of the triangles of the tractions on a parallelogram.
#[derive(Debug)]
pub(super) struct PieceMoments {
    /// Of the continuous tractions, per moment of a triangle and b_v.
    pub by_vertex: Vec<[f64; 4]>,
    /// Of the parts without b_v, per moment of a triangle.
    pub parts: Vec<[f64; PARTS]>,
}

impl PieceMoments {
    pub fn new() -> PieceMoments {
        let (mut products, mut spread) = (vec![vec![0.0; 4]; 4], vec![[0.0; 4]; MOMENTS]);
        // ∫ λ φ_v per moment of a triangle.
        let mut of_moments = vec![[0.0; 4]; MOMENTS];
        for (x, weight) in traction_rule(Shape::Quadrilateral, 3).iter() {
            let (own, bilinear) = (functions(x), linear_functions(Shape::Quadrilateral, &Q1_QUADRILATERAL, x));
            let (triangle, coordinates) = in_triangle(x);
            for (row, value) in products.iter_mut().zip(&own) {
                row.iter_mut().zip(&bilinear).for_each(|(sum, other)| *sum += weight * value * other);
            }
            for (slot, value) in coordinates.iter().enumerate() {
                let at = 3 * triangle + slot;
                for v in 0..4 {
                    spread[at][v] += weight * value * own[v];
                    of_moments[at][v] += weight * value * bilinear[v];
                }
            }
        }
        let factor = Semidefinite::new(&products);
        let by_vertex = spread.iter().map(|row| first_four(&factor.solve(row))).collect();
        // With the areas ¼, the inverse of ∫ λ_a λ_b = (1 + δ_ab)/48 is 48 (δ_ab − ¼).
        let value = |v: usize, at: usize| -> f64 {
            let triangle = at / 3 * 3;
            let sum: f64 = of_moments[triangle..triangle + 3].iter().map(|row| row[v]).sum();
            48.0 * (of_moments[at][v] - 0.25 * sum)
        };
        let rows: Vec<Vec<f64>> = (0..4).map(|v| (0..MOMENTS).map(|at| value(v, at)).collect()).collect();
        let basis = kernel(&rows, MOMENTS);
        let of_part = |at: usize| std::array::from_fn(|part| basis.get(part).map_or(0.0, |own| own[at]));
        PieceMoments { by_vertex, parts: (0..MOMENTS).map(of_part).collect() }
    }
}

fn first_four(values: &[f64]) -> [f64; 4] {
    std::array::from_fn(|v| values.get(v).copied().unwrap_or(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A linear traction has the moments of its triangles from its moments at the vertices; the parts have none.
    #[test]
    fn linear_tractions_are_found_from_their_moments_at_the_vertices() {
        let pieces = PieceMoments::new();
        let traction = |x: &Point| 0.3 + 1.7 * x[0] - 0.6 * x[1];
        let (mut moments, mut triangles) = ([0.0; 4], [0.0; MOMENTS]);
        for (x, weight) in traction_rule(Shape::Quadrilateral, 3).iter() {
            let bilinear = linear_functions(Shape::Quadrilateral, &Q1_QUADRILATERAL, x);
            moments.iter_mut().zip(bilinear).for_each(|(sum, value)| *sum += weight * value * traction(x));
            let (triangle, coordinates) = in_triangle(x);
            (0..3).for_each(|slot| triangles[3 * triangle + slot] += weight * coordinates[slot] * traction(x));
            let sum: f64 = functions(x).iter().sum();
            assert!((sum - 1.0).abs() < 1e-15 && functions(x).iter().all(|value| *value >= 0.0));
        }
        for (row, expected) in pieces.by_vertex.iter().zip(triangles) {
            let found: f64 = row.iter().zip(&moments).map(|(a, b)| a * b).sum();
            assert!((found - expected).abs() < 1e-15, "{found} {expected}");
        }
        for part in 0..PARTS {
            // The traction of a part: its values at the vertices of a triangle from its moments.
            let value = |x: &Point| {
                let (triangle, coordinates) = in_triangle(x);
                let own: [f64; 3] = std::array::from_fn(|slot| pieces.parts[3 * triangle + slot][part]);
                let mean = own.iter().sum::<f64>() / 4.0;
                coordinates.iter().zip(own).map(|(a, b)| 48.0 * a * (b - mean)).sum::<f64>()
            };
            let mut sums = [0.0; 4];
            let mut size = 0.0;
            for (x, weight) in traction_rule(Shape::Quadrilateral, 3).iter() {
                let bilinear = linear_functions(Shape::Quadrilateral, &Q1_QUADRILATERAL, x);
                sums.iter_mut().zip(bilinear).for_each(|(sum, b)| *sum += weight * b * value(x));
                size += weight * value(x).powi(2);
            }
            assert!(size > 1.0 && sums.iter().all(|sum| sum.abs() < 1e-13), "{part}: {sums:?} {size}");
        }
    }
}
