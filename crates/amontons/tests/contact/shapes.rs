//! Every shape against formulas, searches along its surface, and the differences of its distance.
#![allow(clippy::float_cmp, reason = "some numbers are exact")]

use std::f64::consts::TAU;
use std::sync::Arc;

use amontons::contact::Obstacle;
use amontons::contact::obstacle::{
    Cylinder, LevelSet, Nearest, ObstacleShape, Plane, ShapeFault, ShapeFaults, Sphere, Wave,
};
use amontons::expression::Expression;
use amontons::field::Field;
use amontons::tensor::{Point, dot, length};

use crate::common::Random as Numbers;

type Point3 = [Field; 3];

/// Numbers and places that are the same in every run.
struct Random(Numbers);

impl Random {
    fn new(seed: u64) -> Random {
        Random(Numbers(seed))
    }

    /// In [0, 1).
    fn number(&mut self) -> f64 {
        0.5 + 0.5 * self.0.number()
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.number()
    }

    /// A point of the cube [−size, size]^dim.
    fn point(&mut self, dim: usize, size: f64) -> Point {
        [0, 1, 2].map(|c| if c < dim { self.between(-size, size) } else { 0.0 })
    }
}

fn plus(a: &Point, factor: f64, b: &Point) -> Point {
    std::array::from_fn(|c| a[c] + factor * b[c])
}

fn minus(a: &Point, b: &Point) -> Point {
    plus(a, -1.0, b)
}

fn fixed(p: Point) -> Point3 {
    p.map(Field::Constant)
}

fn expression(text: &str) -> Field {
    Field::Expression(Expression::parse(text).unwrap())
}

fn surface(level: &str) -> LevelSet {
    LevelSet::new(Expression::parse(level).unwrap()).unwrap()
}

fn assert_near(found: Nearest, expected: Nearest, tolerance: f64, of: &str) {
    let off = length(&minus(&found.normal, &expected.normal));
    assert!(
        (found.distance - expected.distance).abs() <= tolerance && off <= tolerance,
        "{of}: {found:?}, expected {expected:?}"
    );
}

/// The least of `f` on [low, high]: a dense search, then golden section.
fn least(low: f64, high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let step = (high - low) / 20_000.0;
    let best = (0..=20_000).map(|i| low + f64::from(i) * step).min_by(|a, b| f(*a).total_cmp(&f(*b))).unwrap();
    let (mut a, mut b) = (best - step, best + step);
    let ratio = 0.5 * (5f64.sqrt() - 1.0);
    for _ in 0..60 {
        let (c, d) = (b - ratio * (b - a), a + ratio * (b - a));
        if f(c) < f(d) { b = d } else { a = c }
    }
    f(0.5 * (a + b))
}

#[test]
fn planes_by_the_formula_of_hesse() {
    let mut random = Random::new(1);
    for dim in [2, 3] {
        for _ in 0..50 {
            let (normal, p, x) = (random.point(dim, 1.0), random.point(dim, 5.0), random.point(dim, 5.0));
            let plane = Plane::new(fixed(p), normal.map(|c| 1e3 * c)).unwrap();
            let distance = (0..3).map(|c| normal[c] * (x[c] - p[c])).sum::<f64>()
                / normal.iter().map(|c| c * c).sum::<f64>().sqrt();
            let found = plane.nearest(&x, 0.0);
            assert!((found.distance - distance).abs() < 1e-14 && (length(&found.normal) - 1.0).abs() < 1e-15);
            // Along the normal the distance is that which was gone.
            let foot = plus(&x, -found.distance, &found.normal);
            assert!((plane.nearest(&plus(&foot, 0.7, &found.normal), 0.0).distance - 0.7).abs() < 1e-14);
        }
    }
}

#[test]
fn balls_and_sockets_by_the_radius() {
    let mut random = Random::new(2);
    for dim in [2, 3] {
        for _ in 0..50 {
            let (c, x, radius) = (random.point(dim, 2.0), random.point(dim, 5.0), random.between(0.1, 3.0));
            let r = ((x[0] - c[0]).powi(2) + (x[1] - c[1]).powi(2) + (x[2] - c[2]).powi(2)).sqrt();
            let outward = [0, 1, 2].map(|d| (x[d] - c[d]) / r);
            let ball = Nearest { distance: r - radius, normal: outward };
            let socket = Nearest { distance: radius - r, normal: outward.map(|c| -c) };
            assert_near(Sphere::new(fixed(c), radius, false).unwrap().nearest(&x, 0.0), ball, 1e-14, "ball");
            assert_near(Sphere::new(fixed(c), radius, true).unwrap().nearest(&x, 0.0), socket, 1e-14, "socket");
        }
    }
    // In the middle of a socket all points are equally near: one of them is taken.
    let middle = Sphere::new(fixed([1.0, 2.0, 3.0]), 2.0, true).unwrap().nearest(&[1.0, 2.0, 3.0], 0.0);
    assert!(middle.distance == 2.0 && length(&middle.normal) == 1.0);
}

#[test]
fn cylinders_by_the_cross_product() {
    let mut random = Random::new(3);
    for _ in 0..50 {
        let (c, x, axis, radius) =
            (random.point(3, 2.0), random.point(3, 5.0), random.point(3, 1.0), random.between(0.1, 3.0));
        let v = minus(&x, &c);
        // ‖v × a‖/‖a‖.
        let cross = [v[1] * axis[2] - v[2] * axis[1], v[2] * axis[0] - v[0] * axis[2], v[0] * axis[1] - v[1] * axis[0]];
        let r = length(&cross) / length(&axis);
        let [shaft, bore] =
            [false, true].map(|inside| Cylinder::new(fixed(c), axis, radius, inside).unwrap().nearest(&x, 0.0));
        assert!((shaft.distance - (r - radius)).abs() < 1e-14 && (bore.distance - (radius - r)).abs() < 1e-14);
        assert!(
            dot(&shaft.normal, &axis).abs() < 1e-14
                && (dot(&shaft.normal, &v) - r).abs() < 1e-14
                && bore.normal == shaft.normal.map(|c| -c)
        );
    }
    // In the plane the axis is z, and the cylinder a disc.
    for inside in [false, true] {
        for _ in 0..20 {
            let (c, x) = (fixed(random.point(2, 1.0)), random.point(2, 3.0));
            let disc = Sphere::new(c.clone(), 0.5, inside).unwrap().nearest(&x, 0.0);
            assert_near(Cylinder::new(c, [0.0, 0.0, 1.0], 0.5, inside).unwrap().nearest(&x, 0.0), disc, 1e-15, "disc");
        }
    }
    let middle = Cylinder::new(fixed([0.0; 3]), [0.0, 0.0, 1.0], 2.0, true).unwrap().nearest(&[0.0; 3], 0.0);
    assert!(middle.distance == 2.0 && middle.normal[2] == 0.0 && length(&middle.normal) == 1.0);
}

/// Shallow and steep waves, near and far, above and below, in phase and out of it.
#[test]
fn waves_by_a_search_along_them() {
    let mut random = Random::new(4);
    for round in 0..300 {
        let wavelength = random.between(0.2, 3.0);
        let amplitude = wavelength * random.between(-1.0, 1.0) * [0.02, 0.3, 1.5][round % 3];
        let wave =
            Wave::new(fixed([0.3, -0.1, 0.0]), [0.0, 2.0, 0.0], [-3.0, 0.7, 0.0], amplitude, wavelength).unwrap();
        // On crests, in troughs and between.
        let s = if round % 5 == 0 {
            0.5 * wavelength * (random.between(-8.0, 8.0)).round()
        } else {
            random.between(-4.0, 4.0)
        };
        let h = amplitude.abs().max(0.1) * random.between(-3.0, 3.0);
        let surface = |s: f64| amplitude * (TAU * s / wavelength).cos();
        let distance = least(s - wavelength, s + wavelength, |w| (w - s).hypot(surface(w) - h));
        let expected = if h >= surface(s) { distance } else { -distance };
        let found = wave.nearest(&[s + 0.3, h - 0.1, 0.0], 0.0);
        assert!((found.distance - expected).abs() < 1e-13, "{round}: {found:?}, expected {expected}");
        // The nearest point is on the wave, and the normal there is that of the graph.
        let foot = [s - found.distance * found.normal[0], h - found.distance * found.normal[1]];
        let incline = TAU * amplitude / wavelength * (TAU * foot[0] / wavelength).sin();
        assert!((foot[1] - surface(foot[0])).abs() < 1e-13, "{round}: {foot:?}");
        assert!(
            (found.normal[0] - incline * found.normal[1]).abs() < 1e-12 * (1.0 + incline.abs())
                && found.normal[1] > 0.0,
            "{round}: {found:?}"
        );
    }
}

/// A wave in space is that in the plane of its normal and its direction, which need be neither of unit length nor
/// perpendicular.
#[test]
fn waves_in_space_are_those_in_their_plane() {
    let mut random = Random::new(5);
    let (p, n, d) = ([0.1, 0.2, 0.3], [2.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0], [1.0 / 3.0, 2.0 / 3.0, -2.0 / 3.0]);
    let leaning = plus(&d.map(|c| 5.0 * c), 3.0, &n);
    let wave = Wave::new(fixed(p), n.map(|c| 7.0 * c), leaning, 0.3, 1.1).unwrap();
    let plane = Wave::new(fixed([0.0; 3]), [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], 0.3, 1.1).unwrap();
    for _ in 0..50 {
        let x = random.point(3, 2.0);
        let v = minus(&x, &p);
        let flat = plane.nearest(&[dot(&v, &d), dot(&v, &n), 0.0], 0.0);
        let normal = plus(&n.map(|c| flat.normal[1] * c), flat.normal[0], &d);
        assert_near(wave.nearest(&x, 0.0), Nearest { normal, ..flat }, 1e-13, "wave");
    }
    // Without an amplitude it is a plane.
    let (wave, plane) = (Wave::new(fixed(p), n, d, 0.0, 1.1).unwrap(), Plane::new(fixed(p), n).unwrap());
    assert_near(wave.nearest(&[0.7, -3.0, 0.2], 0.0), plane.nearest(&[0.7, -3.0, 0.2], 0.0), 1e-14, "plane");
}

/// x²/4 + y² = 1 by its angle, from outside and from inside, where the level falls and the evolute is crossed.
#[test]
fn an_ellipse_by_a_search_along_it() {
    let ellipse = surface("x^2/4 + y^2 - 1");
    let round = surface("x^2/4 + y^2 + z^2 - 1");
    let mut random = Random::new(6);
    let mut points: Vec<Point> = (0..200).map(|_| random.point(2, 3.0)).collect();
    points.extend([
        [0.0, 0.0, 0.0],
        [0.0, 0.01, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 5.0, 0.0],
        [-9.0, 0.0, 0.0],
        [1e-9, 0.0, 0.0],
        [40.0, 30.0, 0.0],
    ]);
    for x in points {
        let distance = least(0.0, TAU, |w: f64| (2.0 * w.cos() - x[0]).hypot(w.sin() - x[1]));
        let expected = if x[0] * x[0] / 4.0 + x[1] * x[1] >= 1.0 { distance } else { -distance };
        let found = ellipse.nearest(&x, 0.0);
        assert!((found.distance - expected).abs() < 4e-14 * (1.0 + distance), "{x:?}: {found:?}, expected {expected}");
        let foot = plus(&x, -found.distance, &found.normal);
        assert!(
            (foot[0] * foot[0] / 4.0 + foot[1] * foot[1] - 1.0).abs() < 1e-12 * (1.0 + distance),
            "{x:?}: {foot:?}"
        );
        // Turned about its long axis.
        let turned = [x[0], 0.6 * x[1], 0.8 * x[1]];
        let found = round.nearest(&turned, 0.0);
        assert!(
            (found.distance - expected).abs() < 4e-14 * (1.0 + distance),
            "{turned:?}: {found:?}, expected {expected}"
        );
    }
}

/// Levels that are no distances, of shapes that are known: the nearest point does not depend on the level, nor on the
/// units.
#[test]
fn levels_give_the_distances_of_the_shapes_that_they_are() {
    let mut random = Random::new(7);
    let ball = Sphere::new(fixed([0.2, -0.1, 0.3]), 1.5, false).unwrap();
    let wave = Wave::new(fixed([0.0; 3]), [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], 0.05, 1.0).unwrap();
    let plane = Plane::new(fixed([0.0, 0.25, 0.0]), [3.0, 4.0, 0.0]).unwrap();
    let levels: [(&str, &dyn ObstacleShape, usize); 6] = [
        ("(x - 0.2)^2 + (y + 0.1)^2 + (z - 0.3)^2 - 2.25", &ball, 3),
        ("exp((x - 0.2)^2 + (y + 0.1)^2 + (z - 0.3)^2 - 2.25) - 1", &ball, 3),
        ("1e6*log(((x - 0.2)^2 + (y + 0.1)^2 + (z - 0.3)^2)/2.25)", &ball, 3),
        ("y - 0.05*cos(2*pi*x)", &wave, 3),
        ("(y - 0.05*cos(2*pi*x))*(2 + sin(x + y))", &wave, 2),
        ("tanh(3*x + 4*y - 1)", &plane, 2),
    ];
    for (text, shape, dim) in levels {
        let level = surface(text);
        for _ in 0..60 {
            let x = random.point(dim, if dim == 2 { 0.5 } else { 1.2 });
            assert_near(level.nearest(&x, 0.0), shape.nearest(&x, 0.0), 2e-11, &format!("{text} at {x:?}"));
        }
    }
    let metres = surface("x^2/4 + y^2 - 1");
    let micrometres = surface("(x/1e6)^2/4 + (y/1e6)^2 - 1");
    for _ in 0..30 {
        let x = random.point(2, 3.0);
        let (a, b) = (metres.nearest(&x, 0.0), micrometres.nearest(&x.map(|c| 1e6 * c), 0.0));
        assert_near(Nearest { distance: b.distance / 1e6, ..b }, a, 1e-13, "units");
    }
}

/// The distance is the true one to the rounding of coordinates, however small it is.
#[test]
fn distances_next_to_a_level_are_true_to_round_off() {
    let mut random = Random::new(8);
    for text in ["x^2 + y^2 - 1", "(x^2 + y^2)^3 - 1", "sqrt(x^2 + y^2) - 1"] {
        let level = surface(text);
        for exponent in 1..=16 {
            let (angle, size) = (random.between(0.0, TAU), 10f64.powi(-exponent) * random.between(-1.0, 1.0));
            let x = [(1.0 + size) * angle.cos(), (1.0 + size) * angle.sin(), 0.0];
            // (r² − 1)/(r + 1), without the rounding of the root.
            let expected = (x[0].mul_add(x[0], x[1].mul_add(x[1], -1.0))) / (1.0 + length(&x));
            let found = level.nearest(&x, 0.0);
            assert!((found.distance - expected).abs() < 1e-15, "{text}: {}, expected {expected}", found.distance);
        }
    }
}

/// Around rectangles and a cube the distance is that to a side, an edge or a corner.
#[test]
fn edges_of_a_level() {
    // Half the sides, along (0.8, 0.6), (−0.6, 0.8) and z.
    let boxes = [
        ("max(abs(0.8*x + 0.6*y), abs(0.8*y - 0.6*x)) - 1", 2, [1.0, 1.0, 1.0]),
        ("max(abs(0.8*x + 0.6*y), 3*abs(0.8*y - 0.6*x)) - 1", 2, [1.0, 1.0 / 3.0, 1.0]),
        ("max(abs(0.8*x + 0.6*y), abs(0.8*y - 0.6*x), 2*abs(z)) - 1", 3, [1.0, 1.0, 0.5]),
    ];
    let mut random = Random::new(9);
    for (text, dim, half) in boxes {
        let level = surface(text);
        for _ in 0..300 {
            let x = random.point(dim, 2.5);
            let turned = [0.8 * x[0] + 0.6 * x[1], 0.8 * x[1] - 0.6 * x[0], x[2]];
            let beyond: Vec<f64> = (0..dim).map(|c| turned[c].abs() - half[c]).collect();
            let side = beyond.iter().fold(f64::NEG_INFINITY, |m, b| m.max(*b));
            let expected =
                if side <= 0.0 { side } else { beyond.iter().map(|b| b.max(0.0).powi(2)).sum::<f64>().sqrt() };
            let found = level.nearest(&x, 0.0);
            assert!(
                (found.distance - expected).abs() < 1e-14 && (length(&found.normal) - 1.0).abs() < 1e-14,
                "{text}, {x:?}: {found:?}, expected {expected}"
            );
        }
    }
}

/// Of two discs the nearer one is found although the gradient leads to the other, if it fills the widest gap between
/// the rays that look for it.
#[test]
fn the_nearer_of_two_parts() {
    let level = surface("min((x + 2)^2 + y^2 - 1, 0.05*((x - 2)^2 + y^2 - 1))");
    let (mut random, mut misled) = (Random::new(11), 0);
    for _ in 0..1000 {
        let x = random.point(2, 4.0);
        let [left, right] = [-2.0, 2.0].map(|c| (x[0] - c).hypot(x[1]));
        // The lattice of rays has none between 0 and atan(1/2).
        let half_gap = 0.5 * 0.5f64.atan();
        let sphere = 0.999 * (right - 1.0);
        let seen = sphere * sphere + left * left - 1.0 < 2.0 * sphere * left * half_gap.cos();
        if left.min(right) < 1.0 || left >= right || !seen {
            continue;
        }
        misled += usize::from(20.0 * (left * left - 1.0) > right * right - 1.0);
        let found = level.nearest(&x, 0.0);
        assert!((found.distance - (left - 1.0)).abs() < 1e-14, "{x:?}: {found:?}, expected {}", left - 1.0);
    }
    assert!(misled > 100, "{misled}");
}

#[test]
fn without_a_zero_level_nothing_is_nearest() {
    for text in ["x^2 + y^2 + 1", "1/y", "sqrt(x - 9) + 1", "0*x + 1", "step(x) - 0.5"] {
        let found = surface(text).nearest(&[0.5, 0.25, 0.0], 0.0);
        assert!(found.distance.is_nan(), "{text}: {found:?}");
    }
}

/// ∇d = n, by central differences of order 2, on every curved shape; the normal is of unit length, and the distance
/// falls by as much as one goes down.
#[test]
fn normals_are_gradients_of_distances() {
    let shapes: [(&str, Arc<dyn ObstacleShape>, usize); 7] = [
        ("ball", Arc::new(Sphere::new(fixed([0.1, 0.2, -0.3]), 1.0, false).unwrap()), 3),
        ("socket", Arc::new(Sphere::new(fixed([0.1, 0.2, 0.0]), 4.0, true).unwrap()), 2),
        ("shaft", Arc::new(Cylinder::new(fixed([0.1, 0.2, -0.3]), [1.0, 2.0, 3.0], 1.0, false).unwrap()), 3),
        ("bore", Arc::new(Cylinder::new(fixed([0.1, 0.2, -0.3]), [1.0, 2.0, 3.0], 4.0, true).unwrap()), 3),
        ("wave", Arc::new(Wave::new(fixed([0.1, -3.0, 0.0]), [0.2, 1.0, 0.1], [1.0, 0.0, 0.4], 0.2, 3.0).unwrap()), 3),
        ("ellipse", Arc::new(surface("x^2/4 + y^2 - 0.1")), 2),
        ("quartic", Arc::new(surface("x^4 + y^4 + 2*z^4 - 0.5 + 0.1*x*y")), 3),
    ];
    let mut random = Random::new(10);
    for (name, shape, dim) in shapes {
        let points: Vec<Point> = (0..20)
            .map(|_| random.point(dim, 1.0))
            .map(|x| x.map(|c| if c == 0.0 { 0.0 } else { c + c.signum() }))
            .collect();
        let error = |h: f64| {
            let mut sum = 0.0;
            for x in &points {
                let at = shape.nearest(x, 0.0);
                assert!((length(&at.normal) - 1.0).abs() < 1e-14);
                for c in 0..3 {
                    let mut e = [0.0; 3];
                    e[c] = 1.0;
                    if c < dim {
                        let slope = (shape.nearest(&plus(x, h, &e), 0.0).distance
                            - shape.nearest(&plus(x, -h, &e), 0.0).distance)
                            / (2.0 * h);
                        sum += (slope - at.normal[c]).powi(2);
                    } else {
                        assert!(at.normal[c] == 0.0);
                    }
                }
                let down = shape.nearest(&plus(x, -0.3 * at.distance, &at.normal), 0.0);
                assert_near(down, Nearest { distance: 0.7 * at.distance, ..at }, 1e-11, name);
            }
            sum.sqrt()
        };
        let (coarse, fine) = (error(2e-2), error(1e-2));
        let order = (coarse / fine).log2();
        assert!((order - 2.0).abs() < 0.05 && fine < 1e-3, "{name}: order {order}, error {fine}");
    }
}

#[test]
fn obstacles_move_with_their_data() {
    let path = || [expression("0.5*t"), Field::Constant(2.0), expression("1 - t^2")];
    let sphere = Obstacle {
        shape: Arc::new(Sphere::new(path(), 1.0, false).unwrap()),
        updated: true,
        turning: None,
        load: None,
    };
    assert_eq!(sphere.place(2.0), [1.0, 2.0, -3.0]);
    assert_eq!(sphere.nearest(&[1.0, 2.0, 1.0], 2.0), Nearest { distance: 3.0, normal: [0.0, 0.0, 1.0] });
    assert_eq!(
        sphere.fields().iter().map(|(key, field)| (*key, field.value(&[0.0; 3], 2.0))).collect::<Vec<_>>(),
        [("center[0]", 1.0), ("center[1]", 2.0), ("center[2]", -3.0)]
    );
    let shapes: [Arc<dyn ObstacleShape>; 4] = [
        Arc::new(Plane::new(path(), [1.0, 2.0, 3.0]).unwrap()),
        Arc::new(Sphere::new(path(), 0.7, true).unwrap()),
        Arc::new(Cylinder::new(path(), [1.0, 2.0, 3.0], 0.7, false).unwrap()),
        Arc::new(Wave::new(path(), [1.0, 2.0, 3.0], [1.0, 0.0, 0.0], 0.1, 0.7).unwrap()),
    ];
    // Seen from a point that goes along, nothing changes.
    for shape in shapes {
        let seen = |t: f64| shape.nearest(&plus(&[0.4, 1.7, 0.8], 1.0, &minus(&shape.place(t), &shape.place(0.0))), t);
        assert_near(seen(3.0), seen(0.0), 1e-14, &format!("{shape:?}"));
        assert_eq!(shape.fields().len(), 3);
    }
    // A level that falls at a rate of 0.5.
    let level = Obstacle { shape: Arc::new(surface("y + 0.5*t + x^2*0")), updated: false, turning: None, load: None };
    assert_eq!(level.nearest(&[0.3, 1.0, 0.0], 4.0), Nearest { distance: 3.0, normal: [0.0, 1.0, 0.0] });
    assert!(level.place(4.0) == [0.0; 3] && level.fields().is_empty());
    let at_rest = Obstacle { shape: Arc::new(surface("y + x^2*0")), updated: false, turning: None, load: None };
    let ball = Obstacle {
        shape: Arc::new(Sphere::new(fixed([0.0; 3]), 1.0, false).unwrap()),
        updated: false,
        turning: None,
        load: None,
    };
    assert_eq!([&sphere, &level, &at_rest, &ball].map(Obstacle::depends_on_time), [true, true, false, false]);
}

#[test]
fn faults_of_shapes_are_told_at_once() {
    let told = |faults: ShapeFaults| faults.to_string();
    let wave = Wave::new(
        [expression("x"), Field::ZERO, expression("t*z")],
        [0.0; 3],
        [f64::NAN, 0.0, 0.0],
        f64::INFINITY,
        -1.0,
    );
    let expected = [
        "point[0]: an expression in space, expected a number or an expression in t: the obstacle moves as a whole",
        "point[2]: an expression in space, expected a number or an expression in t: the obstacle moves as a whole",
        "amplitude: inf, expected a finite number",
        "wavelength: -1.0, expected a positive number",
        "normal: zero, expected a direction",
        "direction: [NaN, 0.0, 0.0], expected a direction",
    ];
    assert_eq!(wave.map_err(told).err(), Some(expected.join("\n")));
    let along = Wave::new(fixed([0.0; 3]), [1.0, 2.0, 3.0], [-2.0, -4.0, -6.0], 0.1, 1.0);
    assert_eq!(along.err(), Some(ShapeFaults(vec![ShapeFault::AlongNormal { direction: [-2.0, -4.0, -6.0] }])));
    assert_eq!(
        Sphere::new(fixed([0.0; 3]), 0.0, false).map_err(told).err(),
        Some("radius: 0.0, expected a positive number".to_owned())
    );
    assert_eq!(
        Plane::new(fixed([0.0; 3]), [0.0; 3]).map_err(told).err(),
        Some("normal: zero, expected a direction".to_owned())
    );
    assert_eq!(Cylinder::new(fixed([0.0; 3]), [0.0; 3], f64::NAN, true).err().map(|faults| faults.0.len()), Some(2));
    assert_eq!(LevelSet::new(Expression::parse("t - 1").unwrap()).err(), Some(ShapeFaults(vec![ShapeFault::Level])));
}
