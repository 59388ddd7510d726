//! Two runs that exchange a force and a displacement: the halves of a bar, each its own run.
//!
//! The right half gets the displacement of the interface and returns the force that it takes; the left half gets the
//! opposite force and returns the displacement. Each step is repeated until both displacements agree, with the
//! relaxation of Aitken. The result is that of one run with the whole bar.

use amontons::equation::Along;
use amontons::expression::Expression;
use amontons::material::{Isotropic, Material, StressState::PlaneStress};
use amontons::mesh::{Elements, Mesh};
use amontons::output::Checkpoint;
use amontons::problem::{BoundaryCondition, Physics, ProblemData};
use amontons::run::{Settings, Stepping, SteppingError};

/// Difference of both displacements of the interface, relative to the displacement, at which a step is done.
const ACCEPTED: f64 = 1e-13;
/// Most iterations of a step.
const ITERATIONS: usize = 20;
const STEPS: usize = 20;

/// A bar of a length in m, with conditions at its ends.
fn bar(length: f64, conditions: Vec<BoundaryCondition>) -> Result<Stepping, Box<dyn std::error::Error>> {
    let mut material = Material::new(1, Isotropic::elastic(1, 1e6, 0.0, PlaneStress));
    material.density = 1000.0.into();
    let cells = (8.0 * length).round() as usize;
    let mut bar = ProblemData::new("bar", Mesh::interval(length, cells, Elements::P1)?, material, 0.2, STEPS);
    bar.physics = Physics::Mechanics;
    bar.boundary = conditions;
    Ok(Stepping::new(&bar.check()?, &Settings::default())?)
}

/// The end of the bar that is held, and the end that is pulled.
fn ends() -> Result<[BoundaryCondition; 2], Box<dyn std::error::Error>> {
    let pull = Expression::parse("100*sin(30*t)")?;
    Ok([BoundaryCondition::on("left").displacement([0.0]), BoundaryCondition::on("right").force([pull])])
}

/// The displacements of the whole bar after each step.
///
/// # Errors
/// If the data have faults or a step fails.
pub fn whole() -> Result<Vec<Vec<f64>>, Box<dyn std::error::Error>> {
    let mut whole = bar(2.0, ends()?.to_vec())?;
    let mut all = Vec::new();
    while !whole.is_done() {
        all.push(whole.step()?.u.clone());
    }
    Ok(all)
}

/// Makes the step of both halves from saved states with a displacement of the interface; returns the displacement that
/// the left half has then.
fn try_with(halves: &mut [Stepping; 2], saved: &[Checkpoint; 2], displacement: f64) -> Result<f64, SteppingError> {
    let [left, right] = halves;
    left.restore(&saved[0])?;
    right.restore(&saved[1])?;
    right.set_displacement("left", Along::Axis(0), &[displacement])?;
    right.step()?;
    let opposite: Vec<f64> = right.reactions("left")?.iter().map(|force| -force).collect();
    left.set_force("right", &opposite)?;
    Ok(left.step()?.u.last().copied().unwrap_or_default())
}

/// The displacements of both halves after each step.
///
/// # Errors
/// If the data have faults, a step fails, or the halves do not come to agree.
pub fn halves() -> Result<Vec<[Vec<f64>; 2]>, Box<dyn std::error::Error>> {
    let [held, pulled] = ends()?;
    let interface = BoundaryCondition::on("left").displacement([0.0]);
    let mut halves = [bar(1.0, vec![held])?, bar(1.0, vec![interface, pulled])?];
    let (mut all, mut interface) = (Vec::new(), 0.0);
    while !halves[0].is_done() {
        let saved = halves.each_ref().map(Stepping::save);
        let (mut relaxation, mut before) = (0.5, None::<f64>);
        for iteration in 1.. {
            let difference = try_with(&mut halves, &saved, interface)? - interface;
            if difference.abs() <= ACCEPTED * interface.abs() {
                break;
            }
            if iteration == ITERATIONS {
                return Err(format!("the halves differ by {difference:e} m after {iteration} iterations").into());
            }
            if let Some(before) = before {
                relaxation *= -before / (difference - before);
            }
            interface += relaxation * difference;
            before = Some(difference);
        }
        all.push(halves.each_ref().map(|half| half.state().u.clone()));
    }
    Ok(all)
}

/// Prints the displacement of the interface and of the pulled end.
///
/// # Errors
/// If one of the runs fails.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    for [left, right] in halves()? {
        println!("{:.6e} m  {:.6e} m", left.last().unwrap_or(&0.0), right.last().unwrap_or(&0.0));
    }
    Ok(())
}
