//! Contracts of laws, elements, backends, schemes and sinks: assertions to run on your own ones.
//!
//! Each function panics with the value found and the value expected if its contract is violated. The library runs them
//! on all that it ships; run them on yours in a test:
//!
//! ```
//! use amontons::{contact::Compliance, contract};
//! contract::assert_normal_law(&Compliance { stiffness: 1e4 }, 1e-4);
//! ```
#![allow(clippy::panic, reason = "an assertion is there to panic")]

mod backend;
mod contact;
mod pencil;
mod scheme;
mod sink;

pub use backend::assert_backend;
pub use contact::{assert_friction_law, assert_heat_law, assert_normal_law};
pub use pencil::assert_pencil;
pub use scheme::assert_scheme;
pub use sink::assert_sink;

use crate::contact::obstacle::ObstacleShape;
use crate::contact::{ContactPoint, WearLaw};
use crate::element::{Element, FileOrders, MAX_NODES, ShapeTable};
use crate::hypotheses::Samples;
use crate::material::TensorLaw;
use crate::mesh::{FacetMap, Mesh};
use crate::quadrature::rule;
use crate::tensor::{Point, Rotation, Sym, length, mandel_len};

fn samples() -> Samples {
    Samples::default()
}

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{what}: found {found:e}, expected {expected:e} within {tolerance:e}"
    );
}

/// Checks that shape functions are one at their node, zero at the others, sum to one and have the declared gradients;
/// that facets have the nodes of their element and close the cell, and that on a facet the functions are those of its
/// element.
///
/// # Panics
/// Panics if the element violates the contract.
pub fn assert_element(element: &'static Element) {
    let n = element.nodes.len();
    assert!(n <= MAX_NODES, "{}: {n} nodes, more than MAX_NODES", element.name);
    let mut values = [0.0; MAX_NODES];
    for (i, node) in element.nodes.iter().enumerate() {
        (element.shape_functions)(node, &mut values[..n]);
        for (j, value) in values.iter().enumerate().take(n) {
            near(*value, f64::from(u8::from(i == j)), 1e-14, &format!("{}: N_{j} at node {i}", element.name));
        }
    }
    let dim = element.shape.dim();
    for (at, _) in rule(element.shape, 4).iter() {
        let mut gradients = [[0.0; 3]; MAX_NODES];
        (element.shape_functions)(at, &mut values[..n]);
        (element.gradients)(at, &mut gradients[..n]);
        near(values[..n].iter().sum(), 1.0, 1e-14, &format!("{}: sum of the shape functions", element.name));
        for d in 0..dim {
            let h = 1e-6;
            let (mut plus, mut minus) = (*at, *at);
            plus[d] += h;
            minus[d] -= h;
            let (mut p, mut m) = ([0.0; MAX_NODES], [0.0; MAX_NODES]);
            (element.shape_functions)(&plus, &mut p[..n]);
            (element.shape_functions)(&minus, &mut m[..n]);
            for i in 0..n {
                near(gradients[i][d], (p[i] - m[i]) / (2.0 * h), 1e-8, &format!("{}: gradient of N_{i}", element.name));
            }
        }
    }
    assert_facets(element);
    assert_traces(element);
    assert_types(element);
}

/// Checks that the first type of cells has all nodes, and that every format lists each node of each type and each side
/// once.
fn assert_types(element: &'static Element) {
    let FileOrders { gmsh, med, mail, exodus, exodus_sides } = element.orders;
    let counts: Vec<usize> = element.types.iter().map(|cell| cell.nodes).collect();
    assert_eq!(counts.first(), Some(&element.nodes.len()), "{}: nodes of the first type of cells", element.name);
    let of_nodes = [gmsh, med, mail, exodus].into_iter().flat_map(|order| counts.iter().map(move |&n| (order, n)));
    for (order, count) in of_nodes.chain([(exodus_sides, element.facets.len())]) {
        let mut listed: Vec<usize> = (0..count).map(|position| order.local(position)).collect();
        listed.sort_unstable();
        assert!(listed.into_iter().eq(0..count), "{}: {order:?} is no permutation of {count}", element.name);
    }
}

/// Checks that facets have the nodes of their element in its order and close the cell: with the outward normal, ∫ ν = 0
/// and ∫ x·ν = d |K| (Gauss), and x·ν > c·ν for the centre c of a convex cell.
fn assert_facets(element: &'static Element) {
    let mesh = Mesh {
        dim: element.dim().max(1),
        axisymmetric: false,
        thickness: None,
        points: element.nodes.to_vec(),
        blocks: Vec::new(),
        regions: Vec::new(),
        facets: std::collections::BTreeMap::new(),
        edges: std::collections::BTreeMap::new(),
    };
    let (mut total, mut flux, centre) = ([0.0; 3], 0.0, element.centre());
    for facet in element.facets {
        assert_eq!(facet.nodes.len(), facet.element.nodes.len(), "{}: nodes of a facet", element.name);
        assert!(
            facet.nodes.iter().all(|&i| i < element.nodes.len()),
            "{}: a facet names a node that is not there: {:?}",
            element.name,
            facet.nodes
        );
        let nodes: Vec<u32> = facet.nodes.iter().map(|&i| i as u32).collect();
        // The corners of a facet determine the positions of its other nodes.
        let flat = Element::find(facet.element.shape, 1).unwrap_or(facet.element);
        let linear = ShapeTable::at(flat, facet.element.nodes);
        for (q, &node) in facet.nodes.iter().enumerate().filter(|_| facet.element.dim() > 0) {
            for d in 0..3 {
                let expected: f64 =
                    linear.values(q).iter().zip(facet.nodes).map(|(value, &i)| value * element.nodes[i][d]).sum();
                near(
                    element.nodes[node][d],
                    expected,
                    1e-15,
                    &format!("{}: node {node} of the facet {:?}", element.name, facet.nodes),
                );
            }
        }
        let table = ShapeTable::new(facet.element, 3);
        let mut map = FacetMap::new(&mesh, &table);
        for (q, weight) in table.weights.iter().enumerate() {
            map.at(&nodes, q);
            let height: f64 = (0..3).map(|d| (map.position[d] - centre[d]) * map.normal[d]).sum();
            assert!(height > 0.0, "{}: facet {:?} is turned inwards", element.name, facet.nodes);
            for d in 0..3 {
                total[d] += weight * map.area * map.normal[d];
                flux += weight * map.area * map.normal[d] * map.position[d];
            }
        }
    }
    for d in total {
        near(d, 0.0, 1e-14, &format!("{}: the facets do not close the cell", element.name));
    }
    let volume = if element.dim() > 0 { element.shape.measure() * element.dim() as f64 } else { 0.0 };
    near(flux, volume, 1e-14, &format!("{}: ∫ x·ν over the facets", element.name));
}

/// Checks that on a facet the functions of its nodes are those of its element and all others vanish, so that adjacent
/// cells have the same values there.
fn assert_traces(element: &'static Element) {
    let n = element.nodes.len();
    for facet in element.facets {
        let of_facet = facet.element.nodes.len();
        for (at, _) in rule(facet.element.shape, 4).iter() {
            let (mut expected, mut found, mut own) = ([0.0; MAX_NODES], [0.0; MAX_NODES], [0.0; MAX_NODES]);
            (facet.element.shape_functions)(at, &mut own[..of_facet]);
            let mut x = [0.0; 3];
            for (&node, value) in facet.nodes.iter().zip(own) {
                expected[node] = value;
                (0..3).for_each(|d| x[d] += value * element.nodes[node][d]);
            }
            (element.shape_functions)(&x, &mut found[..n]);
            for (i, (found, expected)) in found.iter().zip(expected).enumerate().take(n) {
                near(*found, expected, 1e-14, &format!("{}: N_{i} on the facet {:?}", element.name, facet.nodes));
            }
        }
    }
}

/// Checks (H1), (H2): zero at zero, the tangent is the derivative, a potential has the value as derivative (and the
/// tangent is then symmetric), and the declared constants m, M and bounds hold, on samples from a thousandth to a
/// thousand times `size`.
///
/// # Panics
/// Panics if the law violates the contract.
pub fn assert_tensor_law(law: &dyn TensorLaw, dim: usize, size: f64) {
    let x = [0.3, 0.2, 0.1];
    let constants = law.constants();
    let stiffness = constants.lipschitz.max(constants.monotonicity.abs());
    assert_eq!(law.value(&x, &Sym::ZERO), Sym::ZERO, "{law:?}: the value at zero, (H1) iv");
    let mut random = samples();
    for size in [1e-3 * size, size, 1e3 * size] {
        let scale = stiffness * size;
        for _ in 0..64 {
            let (a, b) = (random.sym(dim, size), random.sym(dim, size));
            assert_monotone(law, dim, (&a, &b), 1e-12 * scale * size);
            let h = 1e-6 * size;
            let tangent = law.tangent(&x, &a);
            let direction = random.sym(dim, 1.0);
            let (plus, minus) = (a + h * direction, a + (-h) * direction);
            let slope = (0.5 / h) * (law.value(&x, &plus) - law.value(&x, &minus));
            let declared = tangent.apply(&direction);
            for m in 0..6 {
                near(
                    declared.0[m],
                    slope.0[m],
                    1e-7 * stiffness,
                    &format!("{law:?}: component {m} of the tangent at {a:?}"),
                );
            }
            let form = declared.dot(&direction);
            let [low, high] = law.bounds().map(|map| map.apply(&direction).dot(&direction));
            let slack = 1e-12 * stiffness;
            assert!(
                low - slack <= form && form <= high + slack,
                "{law:?}: declared bounds {low:e} and {high:e}, but the tangent gives {form:e} at {a:?}"
            );
            if let (Some(w), Some(v)) = (law.potential(&x, &plus), law.potential(&x, &minus)) {
                let work = law.value(&x, &a).dot(&direction);
                near((w - v) / (2.0 * h), work, 1e-8 * scale, &format!("{law:?}: slope of the potential at {a:?}"));
                for (i, j) in (0..mandel_len(dim)).flat_map(|i| (0..i).map(move |j| (i, j))) {
                    near(
                        tangent.0[i][j],
                        tangent.0[j][i],
                        1e-13 * stiffness,
                        &format!("{law:?}: symmetry of the tangent in {i}, {j}"),
                    );
                }
            }
        }
    }
    if let Some(w) = law.potential(&x, &Sym::ZERO) {
        near(w, 0.0, 0.0, &format!("{law:?}: the potential at zero"));
    }
}

/// Checks m and M between two arguments; the constants refer to the d-dimensional part, which alone does work.
fn assert_monotone(law: &dyn TensorLaw, dim: usize, (a, b): (&Sym, &Sym), slack: f64) {
    let x = [0.3, 0.2, 0.1];
    let constants = law.constants();
    let difference = *a - *b;
    let mut change = law.value(&x, a) - law.value(&x, b);
    change.0[mandel_len(dim)..].fill(0.0);
    let squared = difference.dot(&difference);
    assert!(
        change.dot(&difference) >= constants.monotonicity * squared - slack,
        "{law:?}: declared m = {:e}, but two arguments give {:e}",
        constants.monotonicity,
        change.dot(&difference) / squared
    );
    assert!(
        change.norm() * difference.norm() <= constants.lipschitz * squared + slack,
        "{law:?}: declared M = {:e}, but two arguments give {:e}",
        constants.lipschitz,
        change.norm() / difference.norm()
    );
}

/// Checks that an isotropic law is objective: a rotated argument gives the rotated value and the same potential.
///
/// # Panics
/// Panics if the law has a preferred direction.
pub fn assert_isotropic(law: &dyn TensorLaw, dim: usize, size: f64) {
    let x = [0.3, 0.2, 0.1];
    let mut random = samples();
    for size in [1e-3 * size, size, 1e3 * size] {
        for _ in 0..64 {
            let angles = [3.0 * random.number(), random.number(), random.number()];
            let rotation = match dim {
                3 => Rotation::euler(angles),
                2 => Rotation::in_plane(angles[0]),
                _ => Rotation::IDENTITY,
            };
            let xi = random.sym(dim, size);
            let turned = rotation.tensor(&xi);
            let (found, expected) = (law.value(&x, &turned), rotation.tensor(&law.value(&x, &xi)));
            let slack = 1e-13 * law.constants().lipschitz * size;
            near(
                (found - expected).norm(),
                0.0,
                slack,
                &format!("{law:?}: value at a turned argument, {found:?} for {expected:?}"),
            );
            if let (Some(w), Some(v)) = (law.potential(&x, &turned), law.potential(&x, &xi)) {
                near(w, v, slack * size, &format!("{law:?}: potential at a turned argument"));
            }
        }
    }
}

/// Checks that a slope lies between the two one-sided differences: at a kink either side is admissible. A jump has no
/// slope.
fn slope_between(slope: f64, f: impl Fn(f64) -> f64, h: f64, slack: f64, what: &str) {
    let (left, right) = ((f(0.0) - f(-h)) / h, (f(h) - f(0.0)) / h);
    // A jump of 1e-3 of the size of f within h would be a slope of a thousand times the scale on which slack is based.
    let (low, high) = (left.min(right), left.max(right));
    assert!(
        slope >= low - slack && slope <= high + slack,
        "{what}: slope {slope:e}, expected one between {low:e} and {high:e}"
    );
}

/// Checks that the coefficient is a nonnegative number at any point and has the temperature slope it returns.
///
/// # Panics
/// Panics if the law violates the contract.
pub fn assert_wear_law(law: &dyn WearLaw) {
    let mut random = samples();
    for _ in 0..256 {
        let at = ContactPoint {
            temperature: 1e3 * random.number(),
            pressure: random.number().abs(),
            ..ContactPoint::default()
        };
        let coefficient = law.coefficient(&at);
        assert!(coefficient.is_finite() && coefficient >= 0.0, "{law:?}: coefficient {coefficient:e} at {at:?}");
        let warmer = |h: f64| law.coefficient(&ContactPoint { temperature: at.temperature + h, ..at });
        slope_between(law.by_temperature(&at), warmer, 1e-4, 1e-6 * coefficient, &format!("{law:?}: in temperature"));
    }
}

/// Checks the surface of an obstacle in `dim` dimensions: at points of a box of side 2 `size` around `about` the normal
/// has unit length and is the gradient of the distance, and the point at that distance along it lies on the surface.
/// Points at nearly equal distance from two parts of the surface have no gradient; one point in ten may be such.
///
/// # Panics
/// Panics if the shape violates the contract.
pub fn assert_shape(shape: &dyn ObstacleShape, about: &Point, size: f64, dim: usize) {
    let mut random = samples();
    let (mut kinks, points) = (0, 100);
    for _ in 0..points {
        let x: Point = std::array::from_fn(|c| if c < dim { about[c] + size * random.number() } else { 0.0 });
        let found = shape.nearest(&x, 0.0);
        near(length(&found.normal), 1.0, 1e-14, &format!("{shape:?}: length of the normal at {x:?}"));
        let foot: Point = std::array::from_fn(|c| x[c] - found.distance * found.normal[c]);
        near(
            shape.nearest(&foot, 0.0).distance,
            0.0,
            1e-12 * (size + found.distance.abs()),
            &format!("{shape:?}: distance of the nearest point to {x:?}"),
        );
        let h = 1e-5 * size;
        let gradient: Point = std::array::from_fn(|c| {
            let moved =
                |h: f64| shape.nearest(&std::array::from_fn(|d| if c == d { x[d] + h } else { x[d] }), 0.0).distance;
            if c < dim { (moved(h) - moved(-h)) / (2.0 * h) } else { 0.0 }
        });
        kinks += usize::from((0..3).any(|c| (gradient[c] - found.normal[c]).abs() > 1e-4));
    }
    assert!(
        10 * kinks <= points,
        "{shape:?}: the normal is not the gradient of the distance at {kinks} of {points} points"
    );
    assert!(
        shape.fields().iter().all(|(_, field)| !field.depends_on_time()) || shape.depends_on_time(),
        "{shape:?}: data that move, a shape that does not"
    );
}

#[cfg(test)]
mod tests;
