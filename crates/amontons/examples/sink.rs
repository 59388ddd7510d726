//! A sink of one's own: it takes the contact force after every step of a rod that is pressed on a foundation.

use amontons::contact::{Compliance, Contact};
use amontons::expression::Expression;
use amontons::material::{Isotropic, Material, StressState::PlaneStress};
use amontons::mesh::{Elements, Mesh};
use amontons::output::{OutputError, Sink, Snapshot, Summary};
use amontons::problem::{BoundaryCondition, Physics, ProblemData};
use amontons::run::{Settings, run};

/// Times in s with the normal force on the contact in N.
#[derive(Debug, Default)]
pub struct Forces(pub Vec<[f64; 2]>);

impl Sink for Forces {
    fn step(&mut self, now: &Snapshot) -> Result<(), OutputError> {
        if let Some(report) = now.report {
            self.0.push([now.state.t, report.contact.force[0].abs()]);
        }
        Ok(())
    }

    fn finish(&mut self, summary: &Summary) -> Result<(), OutputError> {
        println!(
            "{} steps, largest force {:.6e} N",
            summary.steps,
            self.0.iter().fold(0.0, |most: f64, [_, force]| most.max(*force))
        );
        Ok(())
    }
}

/// The forces on a rod of E = 1 MPa and a length of 1 m, whose end is moved by t mm towards a foundation with 4e6 Pa/m.
///
/// # Errors
/// When the data have faults or the run fails.
pub fn forces() -> Result<Forces, Box<dyn std::error::Error>> {
    let mut rod = ProblemData::new(
        "rod",
        Mesh::interval(1.0, 4, Elements::P1)?,
        Material::new(1, Isotropic::elastic(1, 1e6, 0.0, PlaneStress)),
        1.0,
        5,
    );
    rod.physics = Physics::Mechanics;
    rod.boundary = vec![BoundaryCondition::on("left").displacement([Expression::parse("1e-3*t")?])];
    rod.contacts = vec![Contact::new("right", Compliance { stiffness: 4e6 })];
    let mut forces = Forces::default();
    run(&rod.check()?, &Settings::default(), &mut [&mut forces])?;
    Ok(forces)
}

/// Prints the forces.
///
/// # Errors
/// When the data have faults or the run fails.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    for [t, force] in forces()?.0 {
        println!("{t:.2} s  {force:.6e} N");
    }
    Ok(())
}
