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

use crate::contact::{ContactPoint, FrictionLaw, HeatLaw, NormalLaw};
use crate::element::{Element, MAX_NODES, Table};
use crate::forms;
use crate::hypotheses::Samples;
use crate::linalg::{Backend, Graph, Unknowns};
use crate::material::{Isotropic, StressState, TensorLaw};
use crate::mesh::{Diagonal, FacetMap, Mesh};
use crate::quadrature::rule;
use crate::tensor::{Rotation, Sym, mandel_len};

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

/// m and M between two arguments; only the d-dimensional part does work and is what they speak of.
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

/// (H8): p ≥ 0, zero without penetration, nondecreasing, with the slope, potential, resolvent and
/// Lipschitz constant it claims; `r` is a penetration typical of the law.
///
/// # Panics
/// When the law breaks the contract.
pub fn assert_normal_law(law: &dyn NormalLaw, r: f64) {
    let x = [0.3, 0.2, 0.1];
    let mut random = samples();
    if law.lipschitz().is_some() {
        near(law.pressure(&x, 0.0, 0.0).value, 0.0, 0.0, &format!("{law:?}: pressure at zero penetration"));
        near(law.pressure(&x, -r, 0.0).value, 0.0, 0.0, &format!("{law:?}: pressure over an open gap"));
        near(law.potential(&x, -r), 0.0, 0.0, &format!("{law:?}: energy over an open gap"));
    }
    for _ in 0..64 {
        let (a, b) = (2.0 * r * random.number(), 2.0 * r * random.number());
        let lambda = law.lipschitz().map_or(1.0, |l| random.number().abs() / l.max(f64::MIN_POSITIVE));
        let (pa, pb) = (law.pressure(&x, a, lambda), law.pressure(&x, b, lambda));
        assert!(pa.value >= 0.0, "{law:?}: negative pressure at {a:e}");
        assert!((pa.value - pb.value) * (a - b) >= 0.0, "{law:?}: not monotone between {a:e} and {b:e}");
        let h = 1e-6 * r;
        if (a.abs()) > 2.0 * h {
            let slope = (law.pressure(&x, a + h, lambda).value - law.pressure(&x, a - h, lambda).value) / (2.0 * h);
            near(pa.slope, slope, 1e-6 * (1.0 + slope.abs()), &format!("{law:?}: slope at {a:e}"));
        }
        if let Some(l) = law.lipschitz() {
            let (ga, gb) = (law.pressure(&x, a, 0.0), law.pressure(&x, b, 0.0));
            let slack = 1e-12 * l * r;
            assert!((ga.value - gb.value).abs() <= l * (a - b).abs() + slack, "{law:?}: declared L = {l:e} fails between {a:e} and {b:e}");
            let at = a - lambda * pa.value;
            near(law.pressure(&x, at, 0.0).value, pa.value, 1e-10 * l * r, &format!("{law:?}: resolvent at {a:e}"));
            let energy = (law.potential(&x, a + h) - law.potential(&x, a - h)) / (2.0 * h);
            near(energy, ga.value, 1e-6 * l * r, &format!("{law:?}: derivative of the potential at {a:e}"));
        }
    }
}

/// (H8): the bound is not negative, zero without pressure, and has the slopes and Lipschitz constant it
/// claims; `p` is a pressure typical of the law.
///
/// # Panics
/// When the law breaks the contract.
pub fn assert_friction_law(law: &dyn FrictionLaw, p: f64) {
    let mut random = samples();
    let l_nu = 1e4;
    for _ in 0..64 {
        let pressure = p * (1.0 + random.number());
        let at = ContactPoint { pressure, penetration: pressure / l_nu, slip_speed: random.number().abs(), ..ContactPoint::default() };
        let bound = law.bound(&at);
        assert!(bound.value >= 0.0, "{law:?}: negative bound {:e} at {at:?}", bound.value);
        if law.is_frictionless() {
            near(bound.value, 0.0, 0.0, &format!("{law:?}: bound of a law without friction"));
        }
        let slope = |change: fn(&mut ContactPoint, f64), h: f64| {
            let (mut plus, mut minus) = (at, at);
            change(&mut plus, h);
            change(&mut minus, -h);
            (law.bound(&plus).value - law.bound(&minus).value) / (2.0 * h)
        };
        let h = 1e-6 * p;
        near(bound.by_pressure, slope(|at, h| at.pressure += h, h), 1e-6, &format!("{law:?}: slope in pressure"));
        let h = 1e-6 * p / l_nu;
        near(bound.by_penetration, slope(|at, h| at.penetration += h, h), 1e-6 * l_nu, &format!("{law:?}: slope in penetration"));
        near(bound.by_slip_speed, slope(|at, h| at.slip_speed += h, 1e-6), 1e-6 * p, &format!("{law:?}: slope in slip speed"));
        if let Some(l) = law.lipschitz(Some(l_nu)) {
            let total = bound.by_penetration + bound.by_pressure * l_nu;
            assert!(total.abs() <= l * (1.0 + 1e-12), "{law:?}: declared L_τ = {l:e}, but the slope is {total:e}");
        }
    }
    let none = law.bound(&ContactPoint::default());
    near(none.value, 0.0, 0.0, &format!("{law:?}: bound without pressure"));
}

/// (H7): no flux over an open gap or without a temperature difference, nondecreasing in θ, with the slope,
/// the bound and the Lipschitz constant it claims; `r` is a penetration typical of the law.
///
/// # Panics
/// When the law breaks the contract.
pub fn assert_heat_law(law: &dyn HeatLaw, r: f64) {
    let mut random = samples();
    let open = ContactPoint { penetration: -r, temperature: 5.0, foundation_temperature: 1.0, ..ContactPoint::default() };
    near(law.flux(&open).value, 0.0, 0.0, &format!("{law:?}: flux over an open gap"));
    for _ in 0..64 {
        let at = ContactPoint { penetration: 2.0 * r * random.number(), temperature: 4.0 * random.number(), foundation_temperature: random.number(), ..open };
        let flux = law.flux(&at);
        let difference = at.temperature - at.foundation_temperature;
        let slack = 1e-12 * (1.0 + law.conductance_bound());
        assert!(flux.value * difference >= -slack, "{law:?}: heat flows from cold to warm at {at:?}");
        assert!(flux.value.abs() <= law.conductance_bound() * difference.abs() + slack, "{law:?}: declared M_kc is exceeded at {at:?}");
        let h = 1e-6;
        let slope = (law.flux(&ContactPoint { temperature: at.temperature + h, ..at }).value
            - law.flux(&ContactPoint { temperature: at.temperature - h, ..at }).value)
            / (2.0 * h);
        assert!(slope >= -slack / h, "{law:?}: flux decreases with the temperature at {at:?}");
        let kink = law.truncation().is_some_and(|l| (difference.abs() - l).abs() < 2.0 * h);
        if !kink {
            near(flux.by_temperature, slope, 1e-8 * (1.0 + law.conductance_bound()), &format!("{law:?}: slope in temperature"));
        }
        // At the kinks of k_c a one-sided slope is as good as the other.
        let step = 1e-6 * r;
        let flux_at = |penetration: f64| law.flux(&ContactPoint { penetration, ..at }).value;
        let (left, right) = ((flux.value - flux_at(at.penetration - step)) / step, (flux_at(at.penetration + step) - flux.value) / step);
        let slack = 1e-4 * (law.conductance_bound() / r + left.abs()) * (1.0 + difference.abs());
        let between = flux.by_penetration >= left.min(right) - slack && flux.by_penetration <= left.max(right) + slack;
        assert!(between, "{law:?}: slope in penetration {:e}, expected one between {left:e} and {right:e}", flux.by_penetration);
        if let (Some(l), None) = (law.conductance_lipschitz(), law.truncation()) {
            let other = ContactPoint { penetration: 2.0 * r * random.number(), ..at };
            let change = (law.flux(&other).value - flux.value).abs();
            let allowed = l * (other.penetration - at.penetration).abs() * difference.abs();
            assert!(change <= allowed * (1.0 + 1e-12) + slack, "{law:?}: declared L_kc = {l:e} is exceeded at {at:?}");
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
mod tests {
    use super::*;
    use crate::contact::{Bound, Compliance, Coulomb, Flux, Ramp, ValueSlope};
    use crate::material::Constants;
    use crate::tensor::{Point, SymMap};

    #[test]
    fn every_element_keeps_its_contract() {
        for element in crate::element::ALL {
            assert_element(element);
        }
    }

    #[test]
    fn every_tensor_law_keeps_its_contract() {
        for (dim, law) in crate::material::samples() {
            assert_tensor_law(law.as_ref(), dim, 1e-3);
        }
        for (dim, law) in crate::material::isotropic_samples() {
            assert_isotropic(law.as_ref(), dim, 1e-3);
        }
    }

    #[test]
    #[should_panic(expected = "turned argument")]
    fn a_law_with_a_direction_is_not_isotropic() {
        for (dim, law) in crate::material::samples().into_iter().skip(crate::material::isotropic_samples().len()).filter(|(dim, _)| *dim > 1) {
            assert_isotropic(law.as_ref(), dim, 1e-3);
        }
    }

    #[test]
    fn every_contact_law_keeps_its_contract() {
        for (law, r) in crate::contact::normal_samples() {
            assert_normal_law(law.as_ref(), r);
        }
        for law in crate::contact::friction_samples() {
            assert_friction_law(law.as_ref(), 2.0);
        }
        for (law, r) in crate::contact::heat_samples() {
            assert_heat_law(law.as_ref(), r);
        }
    }

    #[test]
    fn every_backend_keeps_its_contract() {
        for backend in crate::linalg::backends() {
            assert_backend(backend.as_ref());
        }
    }

    /// A law that declares a monotonicity twice its own.
    #[derive(Debug)]
    struct Boastful(Isotropic);
    impl TensorLaw for Boastful {
        fn value(&self, x: &Point, xi: &Sym) -> Sym {
            self.0.value(x, xi)
        }
        fn tangent(&self, x: &Point, xi: &Sym) -> SymMap {
            self.0.tangent(x, xi)
        }
        fn constants(&self) -> Constants {
            let c = self.0.constants();
            Constants { monotonicity: 2.0 * c.monotonicity, ..c }
        }
    }

    #[test]
    #[should_panic(expected = "declared m")]
    fn a_law_with_wrong_constants_is_caught() {
        assert_tensor_law(&Boastful(Isotropic::elastic(2, 2.0, 0.1, StressState::PlaneStress)), 2, 1.0);
    }

    /// A compliance that declares half its stiffness.
    #[derive(Debug)]
    struct Soft(Compliance);
    impl NormalLaw for Soft {
        fn pressure(&self, x: &Point, z: f64, lambda: f64) -> ValueSlope {
            self.0.pressure(x, z, lambda)
        }
        fn potential(&self, x: &Point, r: f64) -> f64 {
            self.0.potential(x, r)
        }
        fn lipschitz(&self) -> Option<f64> {
            self.0.lipschitz().map(|l| 0.5 * l)
        }
    }

    #[test]
    #[should_panic(expected = "declared L = ")]
    fn a_normal_law_with_a_wrong_constant_is_caught() {
        assert_normal_law(&Soft(Compliance { stiffness: 1e4 }), 1e-4);
    }

    /// Coulomb friction that declares half its coefficient.
    #[derive(Debug)]
    struct Smooth(Coulomb);
    impl FrictionLaw for Smooth {
        fn bound(&self, at: &ContactPoint) -> Bound {
            self.0.bound(at)
        }
        fn lipschitz(&self, l_nu: Option<f64>) -> Option<f64> {
            self.0.lipschitz(l_nu).map(|l| 0.5 * l)
        }
    }

    #[test]
    #[should_panic(expected = "declared L_τ")]
    fn a_friction_law_with_a_wrong_constant_is_caught() {
        assert_friction_law(&Smooth(Coulomb { coefficient: 0.3 }), 2.0);
    }

    /// A ramp that declares wrong constants.
    #[derive(Debug)]
    struct Conducting(Ramp, f64, f64);
    impl HeatLaw for Conducting {
        fn flux(&self, at: &ContactPoint) -> Flux {
            self.0.flux(at)
        }
        fn conductance_bound(&self) -> f64 {
            self.1 * self.0.conductance_bound()
        }
        fn conductance_lipschitz(&self) -> Option<f64> {
            self.0.conductance_lipschitz().map(|l| self.2 * l)
        }
    }

    fn ramp() -> Ramp {
        Ramp { conductance: 30.0, width: 0.5, truncation: None }
    }

    #[test]
    #[should_panic(expected = "declared M_kc")]
    fn a_heat_law_with_a_wrong_bound_is_caught() {
        assert_heat_law(&Conducting(ramp(), 0.5, 1.0), 0.5);
    }

    #[test]
    #[should_panic(expected = "declared L_kc")]
    fn a_heat_law_with_a_wrong_constant_is_caught() {
        assert_heat_law(&Conducting(ramp(), 1.0, 0.5), 0.5);
    }
}
