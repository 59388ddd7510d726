//! Surfaces of facets: their distance and normals against those of the shapes that they bound.

use amontons::contact::obstacle::ClosedSurface;
use amontons::tensor::{Point, length};

use crate::common::Random;

pub type Surface = Vec<[Point; 3]>;

pub fn minus(a: &Point, b: &Point) -> Point {
    std::array::from_fn(|c| a[c] - b[c])
}

/// An octahedron whose triangles are cut in four so many times, its vertices on the sphere of radius 1.
pub fn ball(times: usize) -> Surface {
    let unit = |x: Point| x.map(|c| c / length(&x));
    let mut all: Surface = Vec::new();
    for s in 0..8 {
        let sign = [0, 1, 2].map(|c| if s >> c & 1 == 0 { 1.0 } else { -1.0 });
        let axes = [[sign[0], 0.0, 0.0], [0.0, sign[1], 0.0], [0.0, 0.0, sign[2]]];
        let [a, b, c] = axes;
        all.push(if sign.iter().product::<f64>() > 0.0 { [a, b, c] } else { [a, c, b] });
    }
    for _ in 0..times {
        let cut = |[a, b, c]: &[Point; 3]| {
            let middle = |p: &Point, q: &Point| unit(std::array::from_fn(|i| p[i] + q[i]));
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            [[*a, ab, ca], [ab, *b, bc], [ca, bc, *c], [ab, bc, ca]]
        };
        all = all.iter().flat_map(cut).collect();
    }
    all
}

/// A box from the origin, each side cut into n × n squares of two triangles.
pub fn cuboid(size: Point, n: usize) -> Surface {
    let mut all = Vec::new();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for end in [0.0, 1.0] {
            let at = |i: usize, j: usize| -> Point {
                let mut x = [0.0; 3];
                (x[axis], x[u], x[v]) =
                    (end * size[axis], size[u] * i as f64 / n as f64, size[v] * j as f64 / n as f64);
                x
            };
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                let both = if end > 0.5 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] };
                all.extend(both);
            }
        }
    }
    all
}

pub fn facets(surface: &[[Point; 3]]) -> ClosedSurface {
    let all: Vec<Vec<Point>> = surface.iter().map(|corners| corners.to_vec()).collect();
    ClosedSurface::new(&all).unwrap_or_else(|fault| panic!("{fault:?}"))
}

/// The distance of a box is exact, also around its edges and corners, inside and outside, whatever the squares that
/// its sides are cut into, and whichever way round all its triangles are.
#[test]
fn a_box_of_facets_is_a_box() {
    let size = [1.0, 0.7, 0.4];
    let turned: Surface = cuboid(size, 3).iter().map(|[a, b, c]| [*a, *c, *b]).collect();
    let mut random = Random(7);
    for surface in [cuboid(size, 1), cuboid(size, 5), turned] {
        let facets = facets(&surface);
        let (mut worst, mut kinds) = ([0.0f64; 2], [0; 4]);
        for _ in 0..4000 {
            let x: Point = std::array::from_fn(|c| size[c] * (0.5 + random.number()));
            let beyond: Point = std::array::from_fn(|c| (x[c] - size[c]).max(0.0) + x[c].min(0.0));
            let found = facets.nearest(&x);
            let outside = length(&beyond);
            kinds[beyond.iter().filter(|c| **c != 0.0).count()] += 1;
            if outside > 0.0 {
                worst[0] = worst[0].max((found.distance - outside).abs());
                worst[1] = worst[1].max(length(&minus(&found.normal, &beyond.map(|c| c / outside))));
            } else {
                let depth = (0..3).map(|c| x[c].min(size[c] - x[c])).fold(f64::INFINITY, f64::min);
                worst[0] = worst[0].max((found.distance + depth).abs());
                // The way out is the shortest.
                let on: Point = std::array::from_fn(|c| x[c] - found.distance * found.normal[c]);
                let off = (0..3).map(|c| on[c].abs().min((on[c] - size[c]).abs())).fold(f64::INFINITY, f64::min);
                worst[1] = worst[1].max(off);
            }
        }
        println!("{} facets: {worst:?}, {kinds:?}", facets.len());
        assert!(kinds.iter().all(|count| *count > 50), "inside, before sides, edges and corners: {kinds:?}");
        assert!(worst[0] < 1e-15 && worst[1] < 1e-13, "{worst:?}");
    }
}

/// On the surface and next to it, where the difference of places has no digits left, the normal is that of the side.
#[test]
#[allow(clippy::float_cmp, reason = "the normal of a side is exact")]
fn next_to_a_box_normals_have_all_digits() {
    let facets = facets(&cuboid([1.0, 0.7, 0.4], 4));
    for above in [0.0, 1e-15, 1e-9, -1e-9, 1e-3] {
        for (x, z) in [(0.25, 0.1), (0.5, 0.2), (0.3, 0.17), (0.125, 0.05)] {
            let found = facets.nearest(&[x, 0.7 + above, z]);
            assert_eq!(found.normal.map(f64::abs), [0.0, 1.0, 0.0]);
            assert!(found.normal[1] > 0.0 && (found.distance - above).abs() < 2e-16, "{found:?}");
        }
    }
    assert!(facets.nearest(&[f64::NAN, 0.0, 0.0]).distance.is_nan());
}

/// Facets of a ball: the distance converges with the square of their size, the normal with their size.
#[test]
fn a_ball_of_facets_converges() {
    let mut errors = Vec::new();
    for times in 2..6 {
        let facets = facets(&ball(times));
        let mut random = Random(3);
        let mut worst = [0.0f64; 2];
        for _ in 0..600 {
            let x: Point = std::array::from_fn(|_| 1.4 * random.number());
            if length(&x) < 0.5 {
                continue;
            }
            let found = facets.nearest(&x);
            worst[0] = worst[0].max((found.distance - (length(&x) - 1.0)).abs());
            worst[1] = worst[1].max(length(&minus(&found.normal, &x.map(|c| c / length(&x)))));
        }
        errors.push(worst);
    }
    let orders: Vec<[f64; 2]> =
        errors.windows(2).map(|pair| [0, 1].map(|i| (pair[0][i] / pair[1][i]).log2())).collect();
    println!("errors {errors:?}, orders {orders:?}");
    assert!(orders.iter().skip(1).all(|[distance, normal]| (distance - 2.0).abs() < 0.3 && *normal > 0.7));
    assert!(errors[3][0] < 2e-3 && errors[3][1] < 0.1, "{errors:?}");
}
