//! A time-stepping scheme of one's own: every step of the run is made of four shorter ones, so that results are written
//! at a quarter of the times that are computed.
//!
//! A rod falls on a compliant foundation; the steps of impact are short, the rows of the history are few.

use std::sync::Arc;

use amontons::contact::{Compliance, Contact};
use amontons::discretization::Discretization;
use amontons::equation::{SetupError, Solvers, StepError};
use amontons::linalg::Backend;
use amontons::material::{Isotropic, Material, StressState::PlaneStress};
use amontons::mesh::{Elements, Mesh};
use amontons::output::Memory;
use amontons::problem::{Physics, Problem, ProblemData};
use amontons::run::{RunError, Settings, run};
use amontons::state::{State, StepReport};
use amontons::step::{MakeScheme, March, Scheme};

/// Shorter steps per step of the run.
const PARTS: usize = 4;

/// Backward Euler with shorter steps than those of the problem.
#[derive(Debug)]
pub struct Substeps(March);

impl Substeps {
    /// The scheme as the setting of a run.
    ///
    /// # Errors
    /// Those of [`March::new`].
    pub fn make(
        problem: &Problem,
        discrete: &Arc<Discretization>,
        backend: &Arc<dyn Backend>,
    ) -> Result<Box<dyn Scheme>, SetupError> {
        let finer = problem.with(|data| data.timeline = data.timeline.refined(PARTS))?;
        Ok(Box::new(Substeps(March::on(&finer, discrete, backend)?)))
    }
}

impl Scheme for Substeps {
    fn discretization(&self) -> &Discretization {
        self.0.discretization()
    }

    fn initial(&self) -> Result<State, SetupError> {
        self.0.initial()
    }

    fn step(&mut self, state: &State) -> Result<(State, StepReport), StepError> {
        let n = state.step;
        let (mut now, mut report) = self.0.step(&State { step: PARTS * n, ..state.clone() })?;
        for _ in 1..PARTS {
            (now, report) = self.0.step(&now)?;
        }
        now.step = n + 1;
        Ok((now, report))
    }

    fn solvers(&self) -> Solvers {
        self.0.solvers()
    }
}

/// The states of a rod of 1 m that falls with 1 m/s on a foundation with 4e6 Pa/m.
///
/// # Errors
/// When the data have faults or the run fails.
pub fn states(steps: usize, scheme: MakeScheme) -> Result<Vec<State>, Box<dyn std::error::Error>> {
    let mesh = Mesh::interval(1.0, 16, Elements::P1)?;
    let mut material = Material::new(1, Isotropic::elastic(1, 1e6, 0.0, PlaneStress));
    material.density = 1000.0.into();
    let mut rod = ProblemData::new("rod", mesh, material, 0.1, steps);
    rod.physics = Physics::Mechanics;
    rod.initial.velocity = vec![1.0.into()];
    rod.contacts = vec![Contact::new("right", Compliance { stiffness: 4e6 })];
    let mut memory = Memory::new().states_every(1);
    let settings = Settings { scheme, certificate: false, ..Settings::default() };
    run(&rod.check()?, &settings, &mut [&mut memory]).map_err(|error: RunError| error.to_string())?;
    Ok(memory.states)
}

/// Prints the velocity of the end of the rod.
///
/// # Errors
/// When the data have faults or the run fails.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    for state in states(10, Substeps::make)? {
        println!("{:.3} s  {:.6e} m/s", state.t, state.w.last().unwrap_or(&0.0));
    }
    Ok(())
}
