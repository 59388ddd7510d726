//! Quadrature on the reference cells, of any degree, computed rather than tabulated.
//!
//! Gauss–Legendre points come from Newton's method on the Legendre recurrence; simplices are
//! reached by collapsing a cube onto them (Duffy), which raises the degree to be met by d − 1.

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
}

impl Shape {
    /// Dimension of the reference cell.
    #[must_use]
    pub fn dim(self) -> usize {
        match self {
            Shape::Point => 0,
            Shape::Segment => 1,
            Shape::Triangle => 2,
        }
    }

    /// Measure of the reference cell.
    #[must_use]
    pub fn measure(self) -> f64 {
        match self {
            Shape::Point | Shape::Segment => 1.0,
            Shape::Triangle => 0.5,
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

/// A rule on `shape` that integrates polynomials of total degree `degree` exactly.
#[must_use]
pub fn rule(shape: Shape, degree: usize) -> Rule {
    // n Gauss points meet degree 2n − 1; the collapse of a simplex adds d − 1 to the degree.
    let points = |degree: usize| degree / 2 + 1;
    match shape {
        Shape::Point => Rule { points: vec![[0.0; 3]], weights: vec![1.0] },
        Shape::Segment => {
            let (points, weights) = gauss_legendre(points(degree)).into_iter().map(|(x, w)| ([x, 0.0, 0.0], w)).unzip();
            Rule { points, weights }
        }
        Shape::Triangle if degree <= 1 => Rule { points: vec![[1.0 / 3.0, 1.0 / 3.0, 0.0]], weights: vec![0.5] },
        Shape::Triangle => {
            let line = gauss_legendre(points(degree + 1));
            let (mut points, mut weights) = (Vec::new(), Vec::new());
            for &(s, ws) in &line {
                for &(t, wt) in &line {
                    points.push([s, (1.0 - s) * t, 0.0]);
                    weights.push(ws * wt * (1.0 - s));
                }
            }
            Rule { points, weights }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ x^a y^b over the reference triangle is a! b! / (a + b + 2)!.
    #[test]
    fn monomials_are_exact_up_to_the_degree_and_not_far_beyond() {
        let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
        for degree in 0..9 {
            let r = rule(Shape::Triangle, degree);
            for a in 0..=degree {
                let b = degree - a;
                let computed: f64 = r.iter().map(|(x, w)| w * x[0].powi(a as i32) * x[1].powi(b as i32)).sum();
                let exact = factorial(a) * factorial(b) / factorial(a + b + 2);
                assert!((computed - exact).abs() < 1e-15, "degree {degree}, x^{a} y^{b}");
            }
            let line = rule(Shape::Segment, degree);
            let computed: f64 = line.iter().map(|(x, w)| w * x[0].powi(degree as i32)).sum();
            assert!((computed - 1.0 / (degree as f64 + 1.0)).abs() < 1e-15);
        }
        let two = gauss_legendre(2);
        assert!((two[0].0 - (0.5 - 0.5 / 3f64.sqrt())).abs() < 1e-16);
        let fourth: f64 = two.iter().map(|(x, w)| w * x.powi(4)).sum();
        assert!((fourth - 0.2).abs() > 1e-3, "two points cannot meet degree 4");
    }

    #[test]
    fn weights_sum_to_the_measure() {
        for shape in [Shape::Point, Shape::Segment, Shape::Triangle] {
            for degree in 0..7 {
                let sum: f64 = rule(shape, degree).weights.iter().sum();
                assert!((sum - shape.measure()).abs() < 1e-15);
            }
        }
    }
}
