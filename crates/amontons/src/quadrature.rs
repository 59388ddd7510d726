//! Quadrature on the reference cells, of any degree, computed rather than tabulated.
//!
//! Gauss–Legendre points come from Newton's method on the Legendre recurrence; simplices are
//! reached by collapsing a cube onto them (Duffy), which raises the degree to be met by one for each collapse.

use crate::tensor::Point;

/// Points of a reference cell with their weights; the weights sum to its measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    /// Reference coordinates.
    pub points: Vec<Point>,
    /// Weights, one a point.
    pub weights: Vec<f64>,
}

impl Rule {
    /// Points with their weights.
    pub fn iter(&self) -> impl Iterator<Item = (&Point, f64)> {
        self.points.iter().zip(self.weights.iter().copied())
    }
}

/// The shapes that cells and facets have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Shape {
    /// One vertex; the facet of an interval.
    Point,
    /// The interval [0, 1].
    Segment,
    /// The triangle (0,0), (1,0), (0,1).
    Triangle,
    /// The square [0, 1]².
    Quadrilateral,
    /// The tetrahedron (0,0,0), (1,0,0), (0,1,0), (0,0,1).
    Tetrahedron,
    /// The cube [0, 1]³.
    Hexahedron,
    /// The unit triangle times [0, 1].
    Prism,
    /// The pyramid over [0, 1]² with the apex (0, 0, 1).
    Pyramid,
}

impl Shape {
    /// Every shape.
    pub const ALL: [Shape; 8] =
        [Shape::Point, Shape::Segment, Shape::Triangle, Shape::Quadrilateral, Shape::Tetrahedron, Shape::Hexahedron, Shape::Prism, Shape::Pyramid];

    /// Dimension of the reference cell.
    #[must_use]
    pub fn dim(self) -> usize {
        match self {
            Shape::Point => 0,
            Shape::Segment => 1,
            Shape::Triangle | Shape::Quadrilateral => 2,
            Shape::Tetrahedron | Shape::Hexahedron | Shape::Prism | Shape::Pyramid => 3,
        }
    }

    /// Measure of the reference cell.
    #[must_use]
    pub fn measure(self) -> f64 {
        match self {
            Shape::Point | Shape::Segment | Shape::Quadrilateral | Shape::Hexahedron => 1.0,
            Shape::Triangle | Shape::Prism => 0.5,
            Shape::Tetrahedron => 1.0 / 6.0,
            Shape::Pyramid => 1.0 / 3.0,
        }
    }

    /// Number of vertices.
    #[must_use]
    pub fn vertices(self) -> usize {
        match self {
            Shape::Point => 1,
            Shape::Segment => 2,
            Shape::Triangle => 3,
            Shape::Quadrilateral | Shape::Tetrahedron => 4,
            Shape::Pyramid => 5,
            Shape::Prism => 6,
            Shape::Hexahedron => 8,
        }
    }

    /// How far a reference point lies inside the cell: the least of the distances to the faces, up to constant
    /// factors; negative outside.
    #[must_use]
    pub fn depth(self, x: &Point) -> f64 {
        let [x, y, z] = *x;
        let between = |c: f64| c.min(1.0 - c);
        match self {
            Shape::Point => 0.0,
            Shape::Segment => between(x),
            Shape::Triangle => x.min(y).min(1.0 - x - y),
            Shape::Quadrilateral => between(x).min(between(y)),
            Shape::Tetrahedron => x.min(y).min(z).min(1.0 - x - y - z),
            Shape::Hexahedron => between(x).min(between(y)).min(between(z)),
            Shape::Prism => x.min(y).min(1.0 - x - y).min(between(z)),
            Shape::Pyramid => x.min(y).min(z).min(1.0 - z - x).min(1.0 - z - y),
        }
    }
}

/// n-point Gauss–Legendre rule on [0, 1], exact for polynomials of degree 2n − 1.
#[must_use]
pub fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let n = n.max(1);
    let legendre = |x: f64| {
        let (mut p0, mut p1) = (1.0, x);
        for k in 2..=n {
            let k = k as f64;
            (p0, p1) = (p1, ((2.0 * k - 1.0) * x * p1 - (k - 1.0) * p0) / k);
        }
        (p1, n as f64 * (x * p1 - p0) / (x * x - 1.0))
    };
    let mut rule: Vec<(f64, f64)> = (0..n)
        .map(|i| {
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
            for _ in 0..100 {
                let (p, dp) = legendre(x);
                let dx = p / dp;
                x -= dx;
                if dx.abs() < 1e-16 {
                    break;
                }
            }
            let (_, dp) = legendre(x);
            (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * dp * dp))
        })
        .collect();
    // The rule is symmetric; make it so to the last bit.
    for i in 0..n / 2 {
        let (x, w) = (0.5 * (rule[i].0 + 1.0 - rule[n - 1 - i].0), 0.5 * (rule[i].1 + rule[n - 1 - i].1));
        rule[i] = (x, w);
        rule[n - 1 - i] = (1.0 - x, w);
    }
    if n % 2 == 1 {
        rule[n / 2].0 = 0.5;
    }
    rule
}

/// A rule on `shape` with positive weights that integrates exactly the polynomials of degree `degree`: of that total
/// degree on simplices and pyramids, of that degree in each coordinate on quadrilaterals and hexahedra, of that degree
/// in the plane and in the height on prisms.
#[must_use]
pub fn rule(shape: Shape, degree: usize) -> Rule {
    // n Gauss points meet degree 2n − 1; each collapse of a direction multiplies by a distance to the vertex.
    let line = |extra: usize| gauss_legendre(usize::midpoint(degree, extra) + 1);
    let mut rule = Rule { points: Vec::new(), weights: Vec::new() };
    let mut push = |x: Point, w: f64| {
        rule.points.push(x);
        rule.weights.push(w);
    };
    match shape {
        Shape::Point => push([0.0; 3], 1.0),
        Shape::Segment => line(0).iter().for_each(|&(x, w)| push([x, 0.0, 0.0], w)),
        Shape::Triangle => triangle(degree).iter().for_each(|&(x, y, w)| push([x, y, 0.0], w)),
        Shape::Quadrilateral => products(&line(0), &line(0), &[(0.0, 1.0)], push),
        Shape::Hexahedron => products(&line(0), &line(0), &line(0), push),
        Shape::Prism => {
            let plane = triangle(degree);
            for &(z, wz) in &line(0) {
                for &(x, y, w) in &plane {
                    push([x, y, z], w * wz);
                }
            }
        }
        Shape::Pyramid => products(&line(0), &line(0), &line(2), |[s, t, z], w| push([(1.0 - z) * s, (1.0 - z) * t, z], w * (1.0 - z) * (1.0 - z))),
        Shape::Tetrahedron if degree <= 1 => push([0.25; 3], 1.0 / 6.0),
        Shape::Tetrahedron if degree == 2 => {
            // Four points on the lines from the centre to the vertices (Keast, 1986).
            let (a, b) = ((5.0 - 5f64.sqrt()) / 20.0, (5.0 + 3.0 * 5f64.sqrt()) / 20.0);
            for x in [[a, a, a], [b, a, a], [a, b, a], [a, a, b]] {
                push(x, 1.0 / 24.0);
            }
        }
        Shape::Tetrahedron => products(&line(0), &line(1), &line(2), |[s, t, z], w| {
            let (rest, size) = (1.0 - z, (1.0 - t) * (1.0 - z));
            push([size * s, rest * t, z], w * size * rest);
        }),
    }
    rule
}

/// Points (x, y) of the triangle with their weights.
fn triangle(degree: usize) -> Vec<(f64, f64, f64)> {
    if degree <= 1 {
        return vec![(1.0 / 3.0, 1.0 / 3.0, 0.5)];
    }
    let (outer, inner) = (gauss_legendre(degree.div_ceil(2) + 1), gauss_legendre(degree / 2 + 1));
    outer.iter().flat_map(|&(s, ws)| inner.iter().map(move |&(t, wt)| (s, (1.0 - s) * t, ws * wt * (1.0 - s)))).collect()
}

fn products(x: &[(f64, f64)], y: &[(f64, f64)], z: &[(f64, f64)], mut push: impl FnMut(Point, f64)) {
    for &(z, wz) in z {
        for &(y, wy) in y {
            for &(x, wx) in x {
                push([x, y, z], wx * wy * wz);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factorial(n: usize) -> f64 {
        (1..=n).map(|k| k as f64).product()
    }

    /// ∫ x^a y^b z^c over a reference cell.
    fn exact(shape: Shape, [a, b, c]: [usize; 3]) -> f64 {
        let line = |n: usize| 1.0 / (n as f64 + 1.0);
        let plane = factorial(a) * factorial(b) / factorial(a + b + 2);
        match shape {
            Shape::Point => 1.0,
            Shape::Segment => line(a),
            Shape::Triangle => plane,
            Shape::Quadrilateral => line(a) * line(b),
            Shape::Hexahedron => line(a) * line(b) * line(c),
            Shape::Prism => plane * line(c),
            Shape::Tetrahedron => factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + 3),
            // ∫ (1 − z)^(a+b+2) z^c is a Beta function.
            Shape::Pyramid => line(a) * line(b) * factorial(a + b + 2) * factorial(c) / factorial(a + b + c + 3),
        }
    }

    fn computed(shape: Shape, degree: usize, [a, b, c]: [usize; 3]) -> f64 {
        rule(shape, degree).iter().map(|(x, w)| w * x[0].powi(a as i32) * x[1].powi(b as i32) * x[2].powi(c as i32)).sum()
    }

    #[test]
    fn monomials_are_exact_up_to_the_degree() {
        for shape in Shape::ALL {
            let dim = shape.dim();
            for degree in 0..8 {
                let most = |d: usize| if d < dim { degree } else { 0 };
                for a in 0..=most(0) {
                    for b in 0..=most(1) {
                        for c in 0..=most(2) {
                            let met = match shape {
                                Shape::Triangle | Shape::Tetrahedron | Shape::Pyramid => a + b + c <= degree,
                                Shape::Prism => a + b <= degree,
                                _ => true,
                            };
                            let (found, expected) = (computed(shape, degree, [a, b, c]), exact(shape, [a, b, c]));
                            assert!(!met || (found - expected).abs() < 1e-14, "{shape:?} degree {degree}, x^{a} y^{b} z^{c}: {found} instead of {expected}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn the_next_degree_is_not_met() {
        for shape in Shape::ALL.into_iter().filter(|s| s.dim() > 0) {
            for degree in [1, 3, 5] {
                let monomials = if shape.dim() > 1 { vec![[degree + 1, 0, 0], [0, degree + 1, 0]] } else { vec![[degree + 1, 0, 0]] };
                let error = monomials.into_iter().map(|m| (computed(shape, degree, m) - exact(shape, m)).abs()).fold(0.0, f64::max);
                assert!(error > 1e-6, "{shape:?} degree {degree} meets the next degree: it has more points than it needs");
            }
        }
    }

    #[test]
    fn weights_are_positive_and_sum_to_the_measure() {
        for shape in Shape::ALL {
            for degree in 0..7 {
                let rule = rule(shape, degree);
                let sum: f64 = rule.weights.iter().sum();
                assert!((sum - shape.measure()).abs() < 1e-14);
                assert!(rule.iter().all(|(x, w)| w > 0.0 && (shape == Shape::Point || shape.depth(x) > 0.0)));
            }
        }
    }

    #[test]
    fn two_gauss_points_are_those_of_the_formula() {
        assert!((gauss_legendre(2)[0].0 - (0.5 - 0.5 / 3f64.sqrt())).abs() < 1e-16);
    }
}
