//! Memory of Γ_C: what contact and foundation keep from step to step.

use super::fluid;
use super::mechanics::Mechanics;
use super::system::Step;
use crate::contact::Contact;
use crate::discretization::Discretization;
use crate::inclusion::{Exchange, Passed};
use crate::problem::Problem;
use crate::state::Accumulated;
use crate::tensor::dot;
use crate::time::Rule;

impl Accumulated {
    /// The accumulated quantities at t = 0.
    pub(crate) fn new(problem: &Problem, discrete: &Discretization) -> Accumulated {
        let boundary = &discrete.boundary;
        let n = boundary.points.len();
        let first =
            |side: usize| boundary.points.iter().find(|point| point.contact == side).map_or([0.0; 3], |point| point.x);
        let start = |(side, contact): (usize, &Contact)| {
            let foundation = contact.foundation_heat.as_ref()?;
            Some(foundation.temperature.unwrap_or_else(|| contact.foundation_temperature.value(&first(side), 0.0)))
        };
        Accumulated {
            wear: vec![0.0; n],
            worn: discrete.worn.fresh(),
            friction_work: vec![0.0; n],
            foundation: problem.contacts.iter().enumerate().map(start).collect(),
            passed: vec![Passed::default(); problem.contacts.len()],
            advance: vec![0.0; problem.contacts.len()],
            advance_rate: vec![0.0; problem.contacts.len()],
            offset: Vec::new(),
            wet: fluid::dry(problem, discrete),
        }
    }

    /// The accumulated quantities after a step.
    pub(crate) fn after(&self, step: &Step, mechanics: &Mechanics, exchange: &Exchange) -> Accumulated {
        let (states, advance) = (&mechanics.end.states, mechanics.given.advance.clone());
        let Step { contacts, discrete, boundary, rule: Rule { k, .. }, .. } = *step;
        let mut wear: Vec<f64> = self.wear.iter().zip(states).map(|(wear, state)| wear + state.wear).collect();
        let depths: Vec<f64> = states.iter().map(|state| state.wear).collect();
        let worn = discrete.worn.after(contacts, boundary, &self.worn, &depths);
        let at_points = discrete.worn.at_points(contacts, boundary, &wear, &worn.depths);
        wear.iter_mut().zip(&at_points).for_each(|(wear, [depth, _])| *wear = *depth);
        let rubbed = states.iter().zip(&mechanics.given.frames);
        let rubbed = rubbed.map(|(state, frame)| step.rubbing(frame) * dot(&state.q, &state.slip));
        let friction_work = self.friction_work.iter().zip(rubbed).map(|(sum, work)| sum + work).collect();
        let powers = exchange.passed.iter().map(Some).chain(std::iter::repeat(None));
        let passed = self.passed.iter().zip(powers);
        let passed = passed.map(|(sum, power)| power.map_or_else(|| sum.clone(), |power| sum.after(k, power)));
        let foundation = self.foundation.iter().zip(&exchange.foundation);
        let foundation = foundation.map(|(start, at)| Some(step.rule.end([(*start)?, (*at)?]))).collect();
        let passed = passed.collect();
        let wet = fluid::after(step, &self.wet, &mechanics.wet, states);
        let rates = advance.iter().zip(&self.advance).map(|(now, before)| (now - before) / k);
        let (advance_rate, offset) = (rates.collect(), self.offset.clone());
        Accumulated { wear, worn, friction_work, foundation, passed, advance, advance_rate, offset, wet }
    }
}
