//! A body without a case file: a rod between a warm clamp and a cold foundation, on which it is pressed.

use amontons::contact::{Compliance, Contact, Ramp};
use amontons::hypotheses;
use amontons::material::{Isotropic, Material, StressState::PlaneStress};
use amontons::mesh::{Elements, Mesh};
use amontons::output::Memory;
use amontons::problem::{BoundaryCondition, ProblemData};
use amontons::run::{Settings, run};
use amontons::tensor::Sym;

/// Pressure in Pa and heat flux in W/m² at the foundation. The rod has E = 70 GPa, 150 W/(m K) and a length of 0.1 m;
/// its clamp at 400 K is moved by 0.1 mm towards a foundation at 300 K with 1e12 Pa/m and 5e3 W/(m² K).
///
/// # Errors
/// When the data have faults or the run fails.
pub fn pressed_rod() -> Result<[f64; 2], Box<dyn std::error::Error>> {
    let mut aluminium = Material::new(1, Isotropic::elastic(1, 7e10, 0.3, PlaneStress)).viscosity(Isotropic::lame(
        1,
        0.0,
        1e6,
        PlaneStress,
    ));
    aluminium.conductivity = Sym([150.0, 0.0, 0.0, 0.0, 0.0, 0.0]).into();

    let mut rod = ProblemData::new("rod", Mesh::interval(0.1, 10, Elements::P1)?, aluminium, 1.0, 100);
    rod.boundary = vec![BoundaryCondition::on("left").displacement([1e-4]).temperature(400.0)];
    let conductance = Ramp { conductance: 5e3, width: 1e-9, truncation: None };
    rod.contacts = vec![Contact::new("right", Compliance { stiffness: 1e12 }).heat(conductance, 300.0)];
    let rod = rod.check()?;

    for finding in hypotheses::findings(&rod).iter().filter(|finding| finding.fails()) {
        println!("({}) {}", finding.id, finding.message);
    }
    let summary = run(&rod, &Settings::default(), &mut [&mut Memory::new()])?;
    Ok(summary.last.contact.map_or([0.0; 2], |contact| [contact.pressure_max, contact.heat_flow.unwrap_or(0.0)]))
}

/// Prints the pressure and the heat flux.
///
/// # Errors
/// When the data have faults or the run fails.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let [pressure, flux] = pressed_rod()?;
    println!("pressure {pressure:.6e} Pa, heat flux {flux:.6e} W/m²");
    Ok(())
}
