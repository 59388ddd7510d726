//! Tests that every law, element and backend satisfies its contract, and that violations are caught.

use super::*;
use crate::contact::obstacle::{Nearest, ObstacleShape};
use crate::contact::{Bound, Compliance, Coulomb, Flux, Pressure, Ramp};
use crate::contact::{FrictionLaw, HeatLaw, NormalLaw};
use crate::linalg::{Pencil, SolveError};
use crate::material::OperatorConstants;
use crate::material::{Isotropic, StressState};
use crate::output::{Memory, OutputError, Sink, Snapshot};
use crate::step::March;
use crate::tensor::{Point, SymMap};
use crate::time::TimeScheme;

#[test]
fn every_element_keeps_its_contract() {
    for element in crate::element::ALL {
        assert_element(element);
    }
}

#[test]
fn every_scheme_keeps_its_contract() {
    assert_scheme(March::make, TimeScheme::BackwardEuler, 1.0);
    assert_scheme(March::make, TimeScheme::theta(0.6), 1.0);
    assert_scheme(March::make, TimeScheme::theta(0.5), 2.0);
    assert_scheme(March::make, TimeScheme::Bdf2, 2.0);
    assert_scheme(March::make, TimeScheme::ContactStabilised, 2.0);
}

/// Backward Euler is not of second order.
#[test]
#[should_panic(expected = "expected 2")]
fn a_scheme_of_first_order_is_not_of_second_order() {
    assert_scheme(March::make, TimeScheme::BackwardEuler, 2.0);
}

#[test]
fn a_sink_in_memory_keeps_its_contract() {
    assert_sink(Memory::new);
}

/// A sink that takes no results.
struct Full;

impl Sink for Full {
    fn step(&mut self, _: &Snapshot) -> Result<(), OutputError> {
        Err(OutputError::Io { doing: "write", path: "a full disk".into(), source: std::io::Error::other("no space") })
    }
}

#[test]
#[should_panic(expected = "does not take a run")]
fn a_sink_that_fails_is_caught() {
    assert_sink(|| Full);
}

/// B = diag(1, 2, …) and K = diag(2, 3, …), whose entry (0, 1) makes K unsymmetric if it is not zero.
struct Numbers(f64);

impl Pencil for Numbers {
    fn size(&self) -> usize {
        5
    }
    fn numerator(&self, x: &[f64]) -> Vec<f64> {
        x.iter().enumerate().map(|(i, x)| (i + 1) as f64 * x).collect()
    }
    fn denominator(&self, x: &[f64]) -> Result<Vec<f64>, SolveError> {
        let mut y: Vec<f64> = x.iter().enumerate().map(|(i, x)| (i + 2) as f64 * x).collect();
        y[0] += self.0 * x[1];
        Ok(y)
    }
    fn solve(&mut self, r: &mut [f64], _: f64) -> Result<(), SolveError> {
        r.iter_mut().enumerate().for_each(|(i, r)| *r /= (i + 2) as f64);
        Ok(())
    }
}

#[test]
fn a_pencil_keeps_its_contract() {
    assert_pencil(&mut Numbers(0.0));
}

#[test]
#[should_panic(expected = "K of a pencil is not symmetric")]
fn a_pencil_without_symmetry_is_caught() {
    assert_pencil(&mut Numbers(1e-3));
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
    for (dim, law) in crate::material::samples()
        .into_iter()
        .skip(crate::material::isotropic_samples().len())
        .filter(|(dim, _)| *dim > 1)
    {
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
    for law in crate::contact::wear_samples() {
        assert_wear_law(law.as_ref());
    }
}

#[test]
fn every_shape_keeps_its_contract() {
    use crate::contact::obstacle::{Cylinder, LevelSet, Plane, Sphere, Wave};
    use crate::expression::Expression;
    use crate::field::Field;
    let fixed = |p: [f64; 3]| p.map(Field::Constant);
    let level = Expression::parse("x^2/4 + y^2 - 1").unwrap();
    let about = [0.3, 2.5, 0.2];
    for dim in [2, 3] {
        let shapes: [Box<dyn ObstacleShape>; 6] = [
            Box::new(Plane::new(fixed([0.1, 0.2, 0.0]), [0.3, 1.0, 0.0]).unwrap()),
            Box::new(Sphere::new(fixed([0.0; 3]), 1.2, false).unwrap()),
            Box::new(Sphere::new(fixed([0.0; 3]), 5.0, true).unwrap()),
            Box::new(Cylinder::new(fixed([0.1, 0.0, 0.0]), [0.0, 0.0, 1.0], 0.9, false).unwrap()),
            Box::new(Wave::new(fixed([0.0; 3]), [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], 0.1, 1.0).unwrap()),
            Box::new(LevelSet::new(level.clone()).unwrap()),
        ];
        for shape in shapes {
            assert_shape(shape.as_ref(), &about, 1.0, dim);
        }
    }
}

/// A plane whose distance is measured along y.
#[derive(Debug)]
struct Slanted;
impl ObstacleShape for Slanted {
    fn nearest(&self, x: &Point, _t: f64) -> Nearest {
        Nearest { distance: x[1] - 0.5 * x[0], normal: [-0.5 / 1.25f64.sqrt(), 1.0 / 1.25f64.sqrt(), 0.0] }
    }
}

#[test]
#[should_panic(expected = "distance of the nearest point")]
fn a_gap_that_is_no_distance_is_caught() {
    assert_shape(&Slanted, &[0.0, 1.0, 0.0], 1.0, 2);
}

#[test]
fn every_backend_keeps_its_contract() {
    for backend in crate::linalg::backends() {
        assert_backend(&backend);
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
    fn constants(&self) -> OperatorConstants {
        let c = self.0.constants();
        OperatorConstants { monotonicity: 2.0 * c.monotonicity, ..c }
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
    fn pressure(&self, x: &Point, z: f64, rate: f64, lambda: f64) -> Pressure {
        self.0.pressure(x, z, rate, lambda)
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
