//! The static problem whose solution is a start in equilibrium.

use super::{GivenTemperature, Initial, Physics, Problem, ProblemData};
use crate::contact::Contact;
use crate::time::{Analysis, Timeline};

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
    /// The problem of the equilibrium at t = 0: one steady step from the reference state without wear and motion of
    /// foundations, at the initial temperature.
    pub(crate) fn at_equilibrium(&self) -> Problem {
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
        let data = ProblemData {
            timeline: Timeline::equal(self.timeline.end(), 1).with_analysis(Analysis::Steady),
            contacts: self.contacts.iter().map(rests).collect(),
            physics,
            temperature,
            initial: Initial::default(),
            ..self.0.clone()
        };
        Problem(data, self.1.clone())
    }
}
