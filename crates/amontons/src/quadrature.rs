//! Quadrature on the reference cells, of any degree and with all symmetries of the cell.
//!
//! Gauss–Legendre points come from Newton's method on the Legendre recurrence. A rule on a simplex consists of the
//! orbits of a few points under the permutations of its vertices: known ones up to degree 6, above that those of a cube
//! collapsed onto the simplex (Duffy), where each collapse raises the required degree by one.

use crate::tensor::Point;

/// Points of a reference cell with their weights; the weights sum to its measure.
#[derive(Clone, Debug, PartialEq)]
pub struct QuadratureRule {
    /// Reference coordinates.
    pub points: Vec<Point>,
    /// Weights, one per point.
    pub weights: Vec<f64>,
}

impl QuadratureRule {
    /// Points with their weights.
    pub fn iter(&self) -> impl Iterator<Item = (&Point, f64)> {
        self.points.iter().zip(self.weights.iter().copied())
    }
}

/// The shapes of cells and facets.
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
    pub const ALL: [Shape; 8] = [
        Shape::Point,
        Shape::Segment,
        Shape::Triangle,
        Shape::Quadrilateral,
        Shape::Tetrahedron,
        Shape::Hexahedron,
        Shape::Prism,
        Shape::Pyramid,
    ];

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

    /// Depth of a reference point inside the cell: the least distance to its faces, up to constant factors; negative
    /// outside.
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
    // The rule is symmetric; makes it so to the last bit.
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

/// A rule on `shape` with positive weights at inner points that is exact for polynomials of degree `degree`: the total
/// degree on simplices and pyramids, the degree in each coordinate on quadrilaterals and hexahedra, the degree in the
/// plane and in the height on prisms.
///
/// Every rule has the symmetries of its shape, so an integral over a cell does not depend on the vertex with which its
/// numbering starts.
#[must_use]
pub fn rule(shape: Shape, degree: usize) -> QuadratureRule {
    // n Gauss points reach degree 2n − 1; each collapse of a direction multiplies by a distance to the vertex.
    let line = |extra: usize| gauss_legendre(usize::midpoint(degree, extra) + 1);
    let mut rule = QuadratureRule { points: Vec::new(), weights: Vec::new() };
    let mut push = |x: Point, w: f64| {
        rule.points.push(x);
        rule.weights.push(w);
    };
    match shape {
        Shape::Point => push([0.0; 3], 1.0),
        Shape::Segment => line(0).iter().for_each(|&(x, w)| push([x, 0.0, 0.0], w)),
        Shape::Triangle => images(&triangle_orbits(degree), 0.5, push),
        Shape::Quadrilateral => products(&line(0), &line(0), &[(0.0, 1.0)], push),
        Shape::Hexahedron => products(&line(0), &line(0), &line(0), push),
        Shape::Prism => {
            for &(z, wz) in &line(0) {
                images(&triangle_orbits(degree), 0.5, |[x, y, _], w| push([x, y, z], w * wz));
            }
        }
        Shape::Pyramid => products(&line(0), &line(0), &line(2), |[s, t, z], w| {
            push([(1.0 - z) * s, (1.0 - z) * t, z], w * (1.0 - z) * (1.0 - z));
        }),
        Shape::Tetrahedron => images(&tetrahedron_orbits(degree), 1.0 / 6.0, push),
    }
    rule
}

/// Points of a simplex that its symmetries map onto each other: their fraction of the measure, and the barycentric
/// coordinates of one of them.
type Orbit<const N: usize> = (f64, [f64; N]);

/// Orbits of rules on the triangle: degree 2 (Strang, Fix, 1973), 4 and 6 (Cowper, 1973), 5 (Radon, 1948).
fn triangle_orbits(degree: usize) -> Vec<Orbit<3>> {
    let median = |share: f64, a: f64| (share, [a, a, 1.0 - 2.0 * a]);
    match degree {
        0 | 1 => vec![(1.0, [1.0 / 3.0; 3])],
        2 => vec![median(1.0, 1.0 / 6.0)],
        3 | 4 => vec![
            median(0.670_144_769_034_034_4, 0.445_948_490_915_964_9),
            median(0.329_855_230_965_965_6, 0.091_576_213_509_770_74),
        ],
        5 => {
            let root = 15f64.sqrt();
            let pair = [-root, root].map(|root| median((155.0 + root) / 400.0, (6.0 + root) / 21.0));
            vec![(0.225, [1.0 / 3.0; 3]), pair[0], pair[1]]
        }
        6 => {
            let (a, b) = (0.310_352_451_033_784_4, 0.053_145_049_844_816_945);
            vec![
                median(0.350_358_827_179_138_1, 0.249_286_745_170_910_43),
                median(0.152_534_719_110_620_44, 0.063_089_014_491_502_23),
                (0.497_106_453_710_241_4, [a, b, 1.0 - a - b]),
            ]
        }
        _ => {
            let (outer, inner) = (gauss_legendre(usize::midpoint(degree, 1) + 1), half(degree / 2 + 1));
            let mut orbits = Vec::new();
            products(&outer, &inner, &[(0.0, 1.0)], |[s, t, _], w| {
                orbits.push((2.0 * w * (1.0 - s), [s, (1.0 - s) * t, (1.0 - s) * (1.0 - t)]));
            });
            orbits
        }
    }
}

/// Orbits of rules on the tetrahedron: degree 2 and 6 (Keast, 1986), 5 (Walkington, 2000).
fn tetrahedron_orbits(degree: usize) -> Vec<Orbit<4>> {
    let median = |share: f64, a: f64| (share, [a, a, a, 1.0 - 3.0 * a]);
    match degree {
        0 | 1 => vec![(1.0, [0.25; 4])],
        2 => vec![median(1.0, (5.0 - 5f64.sqrt()) / 20.0)],
        3..=5 => {
            let a = 0.045_503_704_125_649_65;
            vec![
                median(0.293_972_172_465_447_8, 0.092_735_250_310_891_22),
                median(0.450_751_702_872_063_4, 0.310_885_919_263_300_6),
                (0.255_276_124_662_488_8, [a, a, 0.5 - a, 0.5 - a]),
            ]
        }
        6 => {
            let (a, b) = (0.063_661_001_875_017_53, 0.269_672_331_458_315_8);
            vec![
                median(0.159_691_001_032_669_98, 0.214_602_871_259_152_03),
                median(0.221_428_726_174_618_9, 0.322_337_890_142_275_5),
                median(0.040_308_844_221_282_57, 0.040_673_958_534_611_35),
                (81.0 / 140.0, [a, a, b, 1.0 - 2.0 * a - b]),
            ]
        }
        _ => {
            let line = |extra: usize| gauss_legendre(usize::midpoint(degree, extra) + 1);
            let mut orbits = Vec::new();
            products(&half(degree / 2 + 1), &line(1), &line(2), |[s, t, z], w| {
                let (rest, size) = (1.0 - z, (1.0 - t) * (1.0 - z));
                orbits.push((6.0 * w * size * rest, [size * s, size * (1.0 - s), rest * t, z]));
            });
            orbits
        }
    }
}

/// The points of an n-point Gauss–Legendre rule in [0, ½], with the weights of their mirror images added.
fn half(n: usize) -> Vec<(f64, f64)> {
    gauss_legendre(n)
        .into_iter()
        .filter(|&(x, _)| x <= 0.5)
        .map(|(x, w)| (x, if x < 0.5 { 2.0 * w } else { w }))
        .collect()
}

/// The points of orbits with their weights, on a simplex of a given measure.
fn images<const N: usize>(orbits: &[Orbit<N>], measure: f64, mut push: impl FnMut(Point, f64)) {
    for (share, at) in orbits {
        let (mut at, mut points) = (*at, Vec::new());
        permutations(&mut at, 0, &mut points);
        for point in &points {
            push(
                std::array::from_fn(|d| if d + 1 < N { point[d] } else { 0.0 }),
                measure * share / points.len() as f64,
            );
        }
    }
}

/// The distinct permutations of all entries from `first` on.
fn permutations<const N: usize>(entries: &mut [f64; N], first: usize, found: &mut Vec<[f64; N]>) {
    if first == N {
        found.push(*entries);
    }
    for i in first..N {
        if !entries[first..i].contains(&entries[i]) {
            entries.swap(first, i);
            permutations(entries, first + 1, found);
            entries.swap(first, i);
        }
    }
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

    fn computed(rule: &QuadratureRule, [a, b, c]: [usize; 3]) -> f64 {
        rule.iter().map(|(x, w)| w * x[0].powi(a as i32) * x[1].powi(b as i32) * x[2].powi(c as i32)).sum()
    }

    #[test]
    fn monomials_are_exact_up_to_the_degree() {
        for shape in Shape::ALL {
            let dim = shape.dim();
            for degree in 0..10 {
                let rule = rule(shape, degree);
                let most = |d: usize| if d < dim { degree } else { 0 };
                for a in 0..=most(0) {
                    for b in 0..=most(1) {
                        for c in 0..=most(2) {
                            let met = match shape {
                                Shape::Triangle | Shape::Tetrahedron | Shape::Pyramid => a + b + c <= degree,
                                Shape::Prism => a + b <= degree,
                                _ => true,
                            };
                            let (found, expected) = (computed(&rule, [a, b, c]), exact(shape, [a, b, c]));
                            assert!(
                                !met || (found - expected).abs() < 1e-14,
                                "{shape:?} degree {degree}, x^{a} y^{b} z^{c}: {found} instead of {expected}"
                            );
                        }
                    }
                }
            }
        }
    }

    /// Degrees at which a rule gains points, each with their number: n Gauss points in each direction, and the orbits
    /// from the literature.
    #[test]
    fn the_next_degree_is_not_met() {
        let known: [(Shape, &[(usize, usize)]); 7] = [
            (Shape::Segment, &[(1, 1), (3, 2), (5, 3)]),
            (Shape::Triangle, &[(1, 1), (2, 3), (4, 6), (5, 7), (6, 12)]),
            (Shape::Quadrilateral, &[(1, 1), (3, 4), (5, 9)]),
            (Shape::Tetrahedron, &[(1, 1), (2, 4), (5, 14), (6, 24)]),
            (Shape::Hexahedron, &[(1, 1), (3, 8), (5, 27)]),
            (Shape::Prism, &[(1, 1), (5, 21)]),
            (Shape::Pyramid, &[(1, 2), (3, 12), (5, 36)]),
        ];
        for (shape, degrees) in known {
            for &(degree, points) in degrees {
                let rule = rule(shape, degree);
                assert_eq!(rule.points.len(), points, "{shape:?} degree {degree}");
                let monomials = if shape.dim() > 1 {
                    vec![[degree + 1, 0, 0], [0, degree + 1, 0]]
                } else {
                    vec![[degree + 1, 0, 0]]
                };
                let error =
                    monomials.into_iter().map(|m| (computed(&rule, m) - exact(shape, m)).abs()).fold(0.0, f64::max);
                assert!(
                    error > 1e-7,
                    "{shape:?} degree {degree} meets the next degree: it has more points than it needs"
                );
            }
        }
    }

    /// Affine maps that generate the symmetries of a shape: exchanges of vertices.
    fn symmetries(shape: Shape) -> Vec<fn(Point) -> Point> {
        match shape {
            Shape::Point => vec![],
            Shape::Segment => vec![|[x, y, z]| [1.0 - x, y, z]],
            Shape::Triangle => vec![|[x, y, z]| [y, x, z], |[x, y, z]| [1.0 - x - y, y, z]],
            Shape::Quadrilateral => vec![|[x, y, z]| [y, x, z], |[x, y, z]| [1.0 - x, y, z]],
            Shape::Tetrahedron => {
                vec![|[x, y, z]| [y, x, z], |[x, y, z]| [x, z, y], |[x, y, z]| [1.0 - x - y - z, y, z]]
            }
            Shape::Hexahedron => vec![|[x, y, z]| [y, x, z], |[x, y, z]| [x, z, y], |[x, y, z]| [1.0 - x, y, z]],
            Shape::Prism => vec![|[x, y, z]| [y, x, z], |[x, y, z]| [1.0 - x - y, y, z], |[x, y, z]| [x, y, 1.0 - z]],
            Shape::Pyramid => vec![|[x, y, z]| [y, x, z], |[x, y, z]| [1.0 - z - x, y, z]],
        }
    }

    /// The points and weights of a cell do not depend on the numbering of its vertices.
    #[test]
    fn rules_have_the_symmetries_of_their_shape() {
        for shape in Shape::ALL {
            for degree in 0..9 {
                let rule = rule(shape, degree);
                for (index, symmetry) in symmetries(shape).into_iter().enumerate() {
                    for (x, w) in rule.iter() {
                        let image = symmetry(*x);
                        let near = |y: &Point| (0..3).all(|d| (y[d] - image[d]).abs() < 4e-16);
                        let matches: Vec<f64> = rule.iter().filter(|(y, _)| near(y)).map(|(_, w)| w).collect();
                        let of = format!("{shape:?} degree {degree}, symmetry {index}: {x:?} goes to {image:?}");
                        assert!(
                            matches.len() == 1 && (matches[0] - w).abs() < 1e-15 * w,
                            "{of}, weights {w} and {matches:?}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn weights_are_positive_and_sum_to_the_measure() {
        for shape in Shape::ALL {
            for degree in 0..10 {
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
