//! The static problem whose solution is a start in equilibrium.

use super::{GivenTemperature, Initial, Physics, Problem, ProblemData};
use crate::contact::Contact;
use crate::material::{Isotropic, Material, StressState};
use crate::time::{TimePhase, Timeline};

/// Length of the only step, in lengths of the run: velocities in it, and what laws make of them, are round-off.
const LONG: f64 = (1u64 << 40) as f64;

/// How a run starts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StartState {
    /// From the initial displacement and velocity.
    #[default]
    Given,
    /// From rest, in the static equilibrium under the loads at t = 0.
    Equilibrium,
}

impl Problem {
    /// The problem of the equilibrium at t = 0: one step from the reference state without inertia, viscosity, relaxing
    /// stress, wear and motion of foundations, at the initial temperature.
    pub(crate) fn at_equilibrium(&self) -> Problem {
        let dim = self.mesh.dim;
        let still = |material: &Material| Material {
            density: 0.0.into(),
            viscosity: Isotropic::lame(dim, 0.0, 0.0, StressState::PlaneStress).into(),
            prony: None,
            ..material.clone()
        };
        let rests = |contact: &Contact| Contact { foundation_velocity: Vec::new(), wear: None, ..contact.clone() };
        let initial = GivenTemperature {
            region: None,
            field: self.initial.temperature.clone(),
            key: "initial.temperature".to_owned(),
        };
        let (physics, temperature) = match self.physics {
            Physics::Coupled | Physics::Heat => (Physics::Warmed, vec![initial]),
            own @ (Physics::Mechanics | Physics::Warmed) => (own, self.temperature.clone()),
        };
        let step = TimePhase::quasistatic("", LONG * self.timeline.end(), 1);
        let data = ProblemData {
            timeline: Timeline::in_phases(vec![step]),
            materials: self.materials.iter().map(still).collect(),
            contacts: self.contacts.iter().map(rests).collect(),
            physics,
            temperature,
            initial: Initial::default(),
            ..self.0.clone()
        };
        Problem(data, self.1.clone())
    }
}
