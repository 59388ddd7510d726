//! What every sink of results must satisfy.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::contact::{Compliance, Contact};
use crate::material::{Isotropic, Material, StressState};
use crate::mesh::{Elements, Mesh};
use crate::output::{OutputError, Sink, Snapshot};
use crate::problem::{BoundaryCondition, Physics, Problem, ProblemData};
use crate::run::{RunError, Settings, run};

/// A rod that is pressed on a foundation, in four steps.
fn rod() -> Problem {
    let mesh = Mesh::interval(1.0, 4, Elements::P1).unwrap_or_else(|error| panic!("{error}"));
    let material = Material::new(1, Isotropic::elastic(1, 1.0, 0.0, StressState::PlaneStress));
    let mut data = ProblemData::new("a rod", mesh, material, 1.0, 4);
    data.physics = Physics::Mechanics;
    data.boundary = vec![BoundaryCondition::on("left").displacement([0.0; 1])];
    data.contacts = vec![Contact::new("right", Compliance { stiffness: 10.0 })];
    data.body_force = vec![1.0.into()];
    data.check().unwrap_or_else(|faults| panic!("{faults}"))
}

/// Asks the run to stop after its first step.
struct Stop(Arc<AtomicBool>);

impl Sink for Stop {
    fn step(&mut self, _: &Snapshot) -> Result<(), OutputError> {
        self.0.store(true, Ordering::Relaxed);
        Ok(())
    }
}

/// Checks that a sink takes a whole run, and one that is asked to stop after its first step, without an error.
///
/// # Panics
/// Panics if the sink violates the contract.
pub fn assert_sink<S: Sink>(make: impl Fn() -> S) {
    let settings = || Settings { certificate: false, threads: Some(1), ..Settings::default() };
    let (problem, mut sink) = (rod(), make());
    if let Err(error) = run(&problem, &settings(), &mut [&mut sink]) {
        panic!("a sink does not take a run: {error}");
    }
    let mut sink = make();
    let flag = Arc::new(AtomicBool::new(false));
    let stopped = Settings { interrupt: Some(Arc::clone(&flag)), ..settings() };
    match run(&problem, &stopped, &mut [&mut Stop(flag), &mut sink]) {
        Err(RunError::Interrupted(_)) => {}
        Err(error) => panic!("a sink does not take a run that is asked to stop: {error}"),
        Ok(_) => panic!("a run that is asked to stop goes on"),
    }
}
