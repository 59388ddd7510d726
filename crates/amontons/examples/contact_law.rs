//! A friction law of one's own in a run: Coulomb's law for small pressures, bounded by the shear strength of the softer
//! body.
//!
//! A layer is pressed on a foundation and sheared at its top until all of its lower side slips.

use amontons::contact::{Bound, Compliance, Contact, ContactPoint, FrictionLaw};
use amontons::contract::assert_friction_law;
use amontons::expression::Expression;
use amontons::field::Field;
use amontons::material::{Isotropic, Material, StressState::PlaneStrain};
use amontons::mesh::{Diagonal, Mesh};
use amontons::output::Memory;
use amontons::problem::{BoundaryCondition, Physics, ProblemData};
use amontons::run::{Settings, run};

/// p_τ = τ_max tanh(μ p/τ_max).
#[derive(Debug)]
pub struct Saturating {
    /// μ.
    pub coefficient: f64,
    /// τ_max in Pa.
    pub strength: f64,
}

impl FrictionLaw for Saturating {
    fn bound(&self, at: &ContactPoint) -> Bound {
        let tanh = (self.coefficient * at.pressure / self.strength).tanh();
        Bound { value: self.strength * tanh, by_pressure: self.coefficient * (1.0 - tanh * tanh), ..Bound::default() }
    }

    fn lipschitz(&self, l_nu: Option<f64>) -> Option<f64> {
        l_nu.map(|l_nu| self.coefficient * l_nu)
    }
}

/// The force of friction per metre on a layer of 0.2 m whose contact has the pressure 1e6 Pa.
///
/// # Errors
/// When the data have faults or the run fails.
pub fn friction_force(law: Saturating) -> Result<f64, Box<dyn std::error::Error>> {
    let polymer = Material::new(2, Isotropic::elastic(2, 5e9, 0.0, PlaneStrain));
    let mut layer = ProblemData::new("layer", Mesh::rectangle([0.2, 0.1], [8, 4], Diagonal::Right)?, polymer, 1.0, 10);
    layer.physics = Physics::Mechanics;
    // Uniform compression to the pressure p = 1e6 Pa: u_y = −p/c − (p/E) y. The top is sheared by 0.1 mm.
    let (pressed, shear) = (Field::from(Expression::parse("-1e-4 - 2e-4*y")?), Expression::parse("1e-4*t")?);
    let side =
        |on| BoundaryCondition { displacement: Some(vec![None, Some(pressed.clone())]), ..BoundaryCondition::on(on) };
    layer.boundary =
        vec![BoundaryCondition::on("top").displacement([shear.into(), pressed.clone()]), side("left"), side("right")];
    layer.initial.displacement = vec![0.0.into(), pressed.clone()];
    layer.contacts = vec![Contact::new("bottom", Compliance { stiffness: 1e10 }).friction(law)];
    let summary = run(&layer.check()?, &Settings::default(), &mut [&mut Memory::new()])?;
    Ok(summary.last.contact.map_or(0.0, |contact| contact.force[0]))
}

/// Tests the law, and prints the force.
///
/// # Errors
/// When the data have faults or the run fails.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    assert_friction_law(&Saturating { coefficient: 0.5, strength: 3e5 }, 1e6);
    println!("friction: {:.6e} N/m", friction_force(Saturating { coefficient: 0.5, strength: 3e5 })?);
    Ok(())
}
