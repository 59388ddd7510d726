//! What every law, element and backend must satisfy: assertions to run on your own.
//!
//! Each function panics with what was found and what was expected when its contract is broken. The
//! library runs them over all that it ships; run them over yours in a test:
//!
//! ```
//! use amontons::{contact::Compliance, contract};
//! contract::assert_normal_law(&Compliance { stiffness: 1e4 }, 1e-4);
//! ```
#![allow(clippy::panic, reason = "an assertion is there to panic")]

use std::sync::Arc;

use crate::contact::obstacle::Shape;
use crate::contact::{ContactPoint, FrictionLaw, GraphKind, HeatLaw, NormalLaw, WearLaw, resolvent};
use crate::element::{Element, MAX_NODES, Table};
use crate::forms;
use crate::hypotheses::Samples;
use crate::linalg::{Backend, Graph, Unknowns};
use crate::material::{Isotropic, StressState, TensorLaw};
use crate::mesh::{Diagonal, FacetMap, Mesh};
use crate::quadrature::rule;
use crate::tensor::{Point, Rotation, Sym, length, mandel_len};

fn samples() -> Samples {
    Samples::default()
}

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found - expected).abs() <= tolerance, "{what}: found {found:e}, expected {expected:e} within {tolerance:e}");
}

/// Shape functions are one at their node, zero at the others, sum to one and have the gradients they
/// claim; facets have the nodes of their element and close the cell.
///
/// # Panics
/// When the element breaks the contract.
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
    let mut listed = element.gmsh_nodes.to_vec();
    listed.sort_unstable();
    assert!(listed.into_iter().eq(0..n), "{}: the nodes of Gmsh are no permutation: {:?}", element.name, element.gmsh_nodes);
}

/// Facets have the nodes of their element in its order, and close the cell: with the outward normal,
/// ∫ ν = 0 and ∫ x·ν = d |K| (Gauss), and x·ν > c·ν for the centre c of a convex cell.
fn assert_facets(element: &'static Element) {
    let mesh = Mesh {
        dim: element.dim().max(1),
        axisymmetric: false,
        points: element.nodes.to_vec(),
        blocks: Vec::new(),
        regions: Vec::new(),
        facets: std::collections::BTreeMap::new(),
    };
    let (mut total, mut flux, centre) = ([0.0; 3], 0.0, element.centre());
    for facet in element.facets {
        assert_eq!(facet.nodes.len(), facet.element.nodes.len(), "{}: nodes of a facet", element.name);
        assert!(facet.nodes.iter().all(|&i| i < element.nodes.len()), "{}: a facet names a node that is not there: {:?}", element.name, facet.nodes);
        let nodes: Vec<u32> = facet.nodes.iter().map(|&i| i as u32).collect();
        // The corners of a facet determine the places of its other nodes.
        let flat = Element::find(facet.element.shape, 1).unwrap_or(facet.element);
        let linear = Table::at(flat, facet.element.nodes);
        for (q, &node) in facet.nodes.iter().enumerate().filter(|_| facet.element.dim() > 0) {
            for d in 0..3 {
                let expected: f64 = linear.values(q).iter().zip(facet.nodes).map(|(value, &i)| value * element.nodes[i][d]).sum();
                near(element.nodes[node][d], expected, 1e-15, &format!("{}: node {node} of the facet {:?}", element.name, facet.nodes));
            }
        }
        let table = Table::new(facet.element, 3);
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

/// (H1), (H2): zero at zero, the tangent is the derivative, the value that of the potential (and the tangent symmetric)
/// where there is one, and the declared constants m, M and bounds hold, on samples from a thousandth to a thousand times `size`.
///
/// # Panics
/// When the law breaks the contract.
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
                near(declared.0[m], slope.0[m], 1e-7 * stiffness, &format!("{law:?}: component {m} of the tangent at {a:?}"));
            }
            let form = declared.dot(&direction);
            let [low, high] = law.bounds().map(|map| map.apply(&direction).dot(&direction));
            let slack = 1e-12 * stiffness;
            assert!(low - slack <= form && form <= high + slack, "{law:?}: declared bounds {low:e} and {high:e}, but the tangent gives {form:e} at {a:?}");
            if let (Some(w), Some(v)) = (law.potential(&x, &plus), law.potential(&x, &minus)) {
                let work = law.value(&x, &a).dot(&direction);
                near((w - v) / (2.0 * h), work, 1e-8 * scale, &format!("{law:?}: slope of the potential at {a:?}"));
                for (i, j) in (0..mandel_len(dim)).flat_map(|i| (0..i).map(move |j| (i, j))) {
                    near(tangent.0[i][j], tangent.0[j][i], 1e-13 * stiffness, &format!("{law:?}: symmetry of the tangent in {i}, {j}"));
                }
            }
        }
    }
    if let Some(w) = law.potential(&x, &Sym::ZERO) {
        near(w, 0.0, 0.0, &format!("{law:?}: the potential at zero"));
    }
}

/// m and M between two arguments; the constants refer to the d-dimensional part, which alone does work.
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

/// Objectivity of an isotropic law: a turned argument gives the turned value, and the same potential.
///
/// # Panics
/// When the law has a direction of its own.
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
            near((found - expected).norm(), 0.0, slack, &format!("{law:?}: value at a turned argument, {found:?} for {expected:?}"));
            if let (Some(w), Some(v)) = (law.potential(&x, &turned), law.potential(&x, &xi)) {
                near(w, v, slack * size, &format!("{law:?}: potential at a turned argument"));
            }
        }
    }
}

/// A slope lies between the two one-sided differences: at a kink either side is as good as the other. At a jump there is none.
fn slope_between(slope: f64, f: impl Fn(f64) -> f64, h: f64, slack: f64, what: &str) {
    let (left, right) = ((f(0.0) - f(-h)) / h, (f(h) - f(0.0)) / h);
    // A jump of f of 1e-3 of the size of f within h would be a slope of a thousand times the scale that slack is made of.
    let (low, high) = (left.min(right), left.max(right));
    assert!(slope >= low - slack && slope <= high + slack, "{what}: slope {slope:e}, expected one between {low:e} and {high:e}");
}

/// The graph keeps (H8) as far as it claims to, and has the slopes, potential and Lipschitz constant it claims; `r` is a penetration typical of
/// the law. A function that declares a Lipschitz constant vanishes without penetration, unless it pulls; a graph gives the same p for every λ.
///
/// # Panics
/// When the law breaks the contract.
pub fn assert_normal_law(law: &dyn NormalLaw, r: f64) {
    let x = [0.3, 0.2, 0.1];
    let mut random = samples();
    if law.graph() != GraphKind::Function {
        return assert_graph(law, r);
    }
    let p = |r: f64, rate: f64| law.pressure(&x, r, rate, 0.0);
    near(p(0.0, 0.0).value, 0.0, 0.0, &format!("{law:?}: pressure at zero penetration"));
    near(law.potential(&x, 0.0), 0.0, 0.0, &format!("{law:?}: energy at zero penetration"));
    let size = (0..=16).map(|i| p(f64::from(i - 8) / 4.0 * r, 0.0).value.abs()).fold(0.0, f64::max);
    let pulls = p(-1e-3 * r, 0.0).value < 0.0;
    for _ in 0..256 {
        let (a, b) = (2.0 * r * random.number(), 2.0 * r * random.number());
        let ga = p(a, 0.0);
        if a <= 0.0 && !pulls {
            near(ga.value, 0.0, 0.0, &format!("{law:?}: pressure over an open gap"));
            near(law.potential(&x, a), 0.0, 0.0, &format!("{law:?}: energy over an open gap"));
        }
        assert!(ga.value >= 0.0 || pulls, "{law:?}: negative pressure at {a:e}");
        let h = 1e-6 * r;
        slope_between(ga.slope, |h| p(a + h, 0.0).value, h, 1e-4 * size / r, &format!("{law:?}: pressure at {a:e}"));
        let energy = |h: f64| law.potential(&x, a + h);
        near((energy(h) - energy(-h)) / (2.0 * h), ga.value, 1e-5 * size, &format!("{law:?}: derivative of the potential at {a:e}"));
        if let Some(l) = law.lipschitz() {
            let slack = 1e-12 * l * r;
            assert!((ga.value - p(b, 0.0).value).abs() <= l * (a - b).abs() + slack, "{law:?}: declared L = {l:e} fails between {a:e} and {b:e}");
        }
        // Between two penetrations it falls by no more than it says.
        let (low, high) = (a.min(b), a.max(b));
        let (least, mean) = (law.least_slope(&x, low, high), (p(high, 0.0).value - p(low, 0.0).value) / (high - low));
        assert!(mean >= least - 1e-9 * (least.abs() + size / r), "{law:?}: least slope {least:e} between {low:e} and {high:e}, but the mean is {mean:e}");
        // What wears off makes it softer: p = G(r − λ p₊), with the slope that it has.
        let by_wear = r / size * 10f64.powf(3.0 * random.number());
        let rubbed = |h: f64| resolvent(law, &x, a + h, 0.0, [0.0, by_wear]);
        let value = rubbed(0.0).value;
        near(value, p(a - by_wear * value.max(0.0), 0.0).value, 1e-12 * size, &format!("{law:?}: worn by {by_wear:e} p at {a:e}"));
        if least >= 0.0 && law.least_slope(&x, f64::NEG_INFINITY, f64::INFINITY) >= 0.0 {
            slope_between(rubbed(0.0).slope, |h| rubbed(h).value, h, 1e-4 * size / r, &format!("{law:?}: worn, at {a:e}"));
        }
        // In the rate: nondecreasing, and of the slope it has.
        let (rate, other) = (2.0 * random.number(), 2.0 * random.number());
        let moving = p(a, rate);
        assert!((moving.value - p(a, other).value) * (rate - other) >= 0.0, "{law:?}: not monotone in the rate at {a:e}");
        slope_between(moving.by_rate, |h| p(a, rate + h).value, 1e-6, 1e-4 * size, &format!("{law:?}: pressure in the rate at {a:e}, {rate:e}"));
        slope_between(moving.slope, |h| p(a + h, rate).value, h, 1e-4 * (size + moving.value.abs()) / r, &format!("{law:?}: pressure at {a:e}, {rate:e}"));
    }
}

/// p ∈ G(z − λ p) is nondecreasing in z, has the slope it claims, and the same point of G is found with every λ.
fn assert_graph(law: &dyn NormalLaw, r: f64) {
    let x = [0.3, 0.2, 0.1];
    let mut random = samples();
    assert!(law.lipschitz().is_none(), "{law:?}: a multivalued graph has no Lipschitz constant");
    for _ in 0..256 {
        let lambda = r * 10f64.powf(6.0 * random.number());
        let (a, b) = (2.0 * r * random.number(), 2.0 * r * random.number());
        let (pa, pb) = (law.pressure(&x, a, 0.0, lambda), law.pressure(&x, b, 0.0, lambda));
        assert!((pa.value - pb.value) * (a - b) >= 0.0, "{law:?}: not monotone between {a:e} and {b:e}");
        assert!(pa.value >= 0.0 || law.graph() == GraphKind::Bilateral, "{law:?}: tension at {a:e}");
        let h = 1e-6 * r;
        slope_between(pa.slope, |h| law.pressure(&x, a + h, 0.0, lambda).value, h, 1e-6 * pa.value.abs() / r + 1e-9 * pa.slope, &format!("{law:?}: at {a:e}"));
        assert!(lambda * pa.slope <= 1.0 + 1e-12, "{law:?}: the slope at {a:e} is that of no monotone graph");
        let (at, other) = (a - lambda * pa.value, lambda * 10f64.powf(random.number()));
        let again = law.pressure(&x, at + other * pa.value, 0.0, other).value;
        near(again, pa.value, 1e-9 * (pa.value.abs() + r / other), &format!("{law:?}: the point (r, p) = ({at:e}, {:e}) with another λ", pa.value));
    }
}

/// The bound is not negative, and has the slopes and Lipschitz constant it claims; with such a constant it vanishes with the pressure, as (H8)
/// asks. `p` is a pressure typical of the law.
///
/// # Panics
/// When the law breaks the contract.
pub fn assert_friction_law(law: &dyn FrictionLaw, p: f64) {
    let mut random = samples();
    let l_nu = 1e4;
    for _ in 0..256 {
        let pressure = p * (1.0 + random.number());
        let at = ContactPoint {
            pressure,
            penetration: pressure / l_nu,
            slip_speed: random.number().abs(),
            temperature: 3.0 * random.number(),
            ..ContactPoint::default()
        };
        let bound = law.bound(&at);
        assert!(bound.value >= 0.0, "{law:?}: negative bound {:e} at {at:?}", bound.value);
        let at_rest = law.bound(&ContactPoint { slip_speed: 0.0, ..at }).value;
        let creeping = law.bound(&ContactPoint { slip_speed: 1e-12, ..at }).value;
        assert!(at_rest >= creeping * (1.0 - 1e-9), "{law:?}: the bound rises from {at_rest:e} to {creeping:e} when slip starts");
        assert!(law.drops_from_rest() || at_rest <= creeping * (1.0 + 1e-9) + 1e-300, "{law:?}: the bound drops from {at_rest:e} to {creeping:e}, unsaid");
        if law.is_frictionless() {
            near(bound.value, 0.0, 0.0, &format!("{law:?}: bound of a law without friction"));
        }
        let at = &at;
        let s = |change: fn(&mut ContactPoint, f64)| {
            move |h: f64| {
                let mut at = *at;
                change(&mut at, h);
                law.bound(&at).value
            }
        };
        slope_between(bound.by_pressure, s(|at, h| at.pressure += h), 1e-6 * p, 1e-5, &format!("{law:?}: in pressure"));
        slope_between(bound.by_penetration, s(|at, h| at.penetration += h), 1e-6 * p / l_nu, 1e-5 * l_nu, &format!("{law:?}: in penetration"));
        slope_between(bound.by_slip_speed, s(|at, h| at.slip_speed += h), 1e-6, 1e-4 * p, &format!("{law:?}: in slip speed"));
        slope_between(bound.by_temperature, s(|at, h| at.temperature += h), 1e-6, 1e-4 * p, &format!("{law:?}: in temperature"));
        let faster = ContactPoint { slip_speed: at.slip_speed + random.number().abs(), ..*at };
        let (least, rise) = (law.least_slope(at, at.slip_speed, faster.slip_speed), law.bound(&faster).value - bound.value);
        let slack = 1e-12 * (bound.value + p);
        assert!(
            rise >= least * (faster.slip_speed - at.slip_speed) - slack,
            "{law:?}: least slope {least:e} in the slip speed, but from {at:?} to {faster:?} it changes by {rise:e}"
        );
        if let Some(l) = law.lipschitz(Some(l_nu)) {
            let total = bound.by_penetration + bound.by_pressure * l_nu;
            assert!(total.abs() <= l * (1.0 + 1e-12), "{law:?}: declared L_τ = {l:e}, but the slope is {total:e}");
        }
    }
    if law.lipschitz(Some(l_nu)).is_some() {
        let none = law.bound(&ContactPoint::default());
        near(none.value, 0.0, 0.0, &format!("{law:?}: bound without pressure"));
    }
}

/// The coefficient is a number that is not negative, whatever the point, and has the slope in the temperature that it claims.
///
/// # Panics
/// When the law breaks the contract.
pub fn assert_wear_law(law: &dyn WearLaw) {
    let mut random = samples();
    for _ in 0..256 {
        let at = ContactPoint { temperature: 1e3 * random.number(), pressure: random.number().abs(), ..ContactPoint::default() };
        let coefficient = law.coefficient(&at);
        assert!(coefficient.is_finite() && coefficient >= 0.0, "{law:?}: coefficient {coefficient:e} at {at:?}");
        let warmer = |h: f64| law.coefficient(&ContactPoint { temperature: at.temperature + h, ..at });
        slope_between(law.by_temperature(&at), warmer, 1e-4, 1e-6 * coefficient, &format!("{law:?}: in temperature"));
    }
}

/// The surface of an obstacle in `dim` dimensions: at points of a box of side 2 `size` around `about` the normal is of unit length and the gradient of
/// the distance, and the point that it leads to, by the distance, lies on the surface. Points where two parts of the surface are nearly equally near have no gradient; one in ten may be
/// such.
///
/// # Panics
/// When the shape breaks the contract.
pub fn assert_shape(shape: &dyn Shape, about: &Point, size: f64, dim: usize) {
    let mut random = samples();
    let (mut kinks, points) = (0, 100);
    for _ in 0..points {
        let x: Point = std::array::from_fn(|c| if c < dim { about[c] + size * random.number() } else { 0.0 });
        let found = shape.nearest(&x, 0.0);
        near(length(&found.normal), 1.0, 1e-14, &format!("{shape:?}: length of the normal at {x:?}"));
        let foot: Point = std::array::from_fn(|c| x[c] - found.distance * found.normal[c]);
        near(shape.nearest(&foot, 0.0).distance, 0.0, 1e-12 * (size + found.distance.abs()), &format!("{shape:?}: distance of the nearest point to {x:?}"));
        let h = 1e-5 * size;
        let gradient: Point = std::array::from_fn(|c| {
            let moved = |h: f64| shape.nearest(&std::array::from_fn(|d| if c == d { x[d] + h } else { x[d] }), 0.0).distance;
            if c < dim { (moved(h) - moved(-h)) / (2.0 * h) } else { 0.0 }
        });
        kinks += usize::from((0..3).any(|c| (gradient[c] - found.normal[c]).abs() > 1e-4));
    }
    assert!(10 * kinks <= points, "{shape:?}: the normal is not the gradient of the distance at {kinks} of {points} points");
    assert!(shape.fields().iter().all(|(_, field)| !field.depends_on_time()) || shape.depends_on_time(), "{shape:?}: data that move, a shape that does not");
}

/// (H7) as far as it is claimed: a flux from warm to cold, nondecreasing in θ, with the slopes, the bound and the Lipschitz constant it claims;
/// none without a temperature difference but that of friction. `r` is a penetration typical of the law.
///
/// # Panics
/// When the law breaks the contract.
pub fn assert_heat_law(law: &dyn HeatLaw, r: f64) {
    let mut random = samples();
    for _ in 0..256 {
        let at = ContactPoint {
            penetration: 2.0 * r * random.number(),
            pressure: 3.0 * (1.0 + random.number()),
            slip_speed: random.number().abs(),
            temperature: 4.0 * random.number(),
            foundation_temperature: random.number(),
            ..ContactPoint::default()
        };
        let flux = law.flux(&at);
        let difference = at.temperature - at.foundation_temperature;
        let rounding = 1e-12 * flux.value.abs();
        assert!(flux.value * difference >= 0.0, "{law:?}: heat flows from cold to warm at {at:?}");
        let allowed = law.conductance_bound() * difference.abs() * (1.0 + 1e-12);
        assert!(law.conductance_bound().is_infinite() || flux.value.abs() <= allowed, "{law:?}: declared M_kc is exceeded at {at:?}");
        let at = &at;
        let q = |change: fn(&mut ContactPoint, f64)| {
            move |h: f64| {
                let mut at = *at;
                change(&mut at, h);
                law.flux(&at).value
            }
        };
        assert!(flux.by_temperature >= 0.0, "{law:?}: flux decreases with the temperature at {at:?}");
        // The curvature of a law, times the step of the difference.
        let scale = 1e-4 * (flux.value.abs() + flux.by_temperature);
        slope_between(flux.by_temperature, q(|at, h| at.temperature += h), 1e-6, scale, &format!("{law:?}: in temperature"));
        assert!(flux.by_foundation <= 0.0, "{law:?}: flux increases with the temperature of the foundation at {at:?}");
        slope_between(flux.by_foundation, q(|at, h| at.foundation_temperature += h), 1e-6, scale, &format!("{law:?}: in the foundation's temperature"));
        slope_between(flux.by_penetration, q(|at, h| at.penetration += h), 1e-6 * r, scale / r, &format!("{law:?}: in penetration"));
        slope_between(flux.by_pressure, q(|at, h| at.pressure += h), 1e-6, scale, &format!("{law:?}: in pressure"));
        slope_between(flux.by_slip_speed, q(|at, h| at.slip_speed += h), 1e-6, scale, &format!("{law:?}: in slip speed"));
        let heated = |power: f64| law.flux(&ContactPoint { friction_power: power, ..*at });
        near(heated(0.7).value - flux.value, 0.7 * flux.by_friction_power, 1e-12 + rounding, &format!("{law:?}: friction heat"));
        assert!((-1.0..=0.0).contains(&flux.by_friction_power), "{law:?}: more than the power of friction enters the body");
        let level = law.flux(&ContactPoint { temperature: at.foundation_temperature, ..*at });
        near(level.value, 0.0, 0.0, &format!("{law:?}: flux without a temperature difference"));
        if let (Some(l), None) = (law.conductance_lipschitz(), law.truncation()) {
            let other = ContactPoint { penetration: 2.0 * r * random.number(), ..*at };
            let change = (law.flux(&other).value - flux.value).abs();
            let allowed = l * (other.penetration - at.penetration).abs() * difference.abs();
            assert!(change <= allowed * (1.0 + 1e-9) + rounding, "{law:?}: declared L_kc = {l:e} is exceeded at {at:?}");
        }
    }
}

/// The sweeps around a contact problem without forces solve the system, the condensed operator is the
/// Schur complement, and a matrix that is not positive definite is refused.
///
/// # Panics
/// When the backend breaks the contract, or the small mesh of the test cannot be made.
pub fn assert_backend(backend: &dyn Backend) {
    let Ok(mesh) = Mesh::rectangle([1.0, 0.7], [9, 7], Diagonal::Left) else { panic!("a mesh of 9 × 7 squares") };
    let graph = Arc::new(Graph::of_mesh(&mesh));
    let mut matrix = forms::a(&mesh, &graph, &[&Isotropic::elastic(2, 2.0, 0.3, StressState::PlaneStrain)]);
    let size = graph.len() * 2;
    let mut free = vec![true; size];
    for node in mesh.facets["top"].node_list() {
        free[2 * node as usize] = false;
        free[2 * node as usize + 1] = false;
    }
    let contact = mesh.facets["bottom"].node_list();
    let unknowns = Unknowns::new(&matrix, &mesh.points, 2, &free, &contact);
    assert_eq!(unknowns.contact().len(), 2 * contact.len(), "{backend:?}: contact unknowns");
    let Ok(factor) = backend.factorize(&matrix, &unknowns) else { panic!("{backend:?}: a positive definite matrix was refused") };
    let mut random = samples();
    let solution: Vec<f64> = free.iter().map(|&f| if f { random.number() } else { 0.0 }).collect();
    let right = matrix.apply(&solution);

    // Without forces on Γ_C its unknowns are those of S w = r̂; taken from the solution they must satisfy it.
    let mut x = unknowns.gather(&right);
    factor.forward(&mut x);
    let s = factor.condensed();
    let on_contact: Vec<f64> = unknowns.contact().iter().map(|&d| solution[d as usize]).collect();
    for i in 0..s.nrows() {
        let row: f64 = (0..s.ncols()).map(|j| s[(i, j)] * on_contact[j]).sum();
        near(row, x[unknowns.interior + i], 1e-11, &format!("{backend:?}: condensed system, row {i}"));
        for j in 0..i {
            near(s[(i, j)], s[(j, i)], 1e-12, &format!("{backend:?}: symmetry of S"));
        }
    }
    x[unknowns.interior..].copy_from_slice(&on_contact);
    factor.backward(&mut x);
    for (&dof, value) in unknowns.dofs.iter().zip(&x) {
        near(*value, solution[dof as usize], 1e-11, &format!("{backend:?}: solution at degree of freedom {dof}"));
    }
    matrix.add_scaled(-1e6, &forms::inner_h(&mesh, &graph));
    assert!(backend.factorize(&matrix, &unknowns).is_err(), "{backend:?}: an indefinite matrix was accepted");
}

#[cfg(test)]
mod tests;
