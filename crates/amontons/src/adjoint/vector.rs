//! Vectors of the numbers of a state.

use super::stencil;
use crate::linalg::{dot, max_abs, zeros};
use crate::state::State;

/// A vector of the numbers of a state: the derivatives of an output by the state, or those of the state by a parameter.
#[derive(Clone, Debug)]
pub(super) struct StateVector {
    pub u: Vec<f64>,
    pub w: Vec<f64>,
    pub theta: Vec<f64>,
    /// Of the mean rate of θ in the step that led to the state; empty if no step extrapolates it.
    pub theta_rate: Vec<f64>,
    pub branches: Vec<Vec<f64>>,
    /// Of depth of wear and of work of friction per contact point.
    pub wear: Vec<f64>,
    pub work: Vec<f64>,
    /// Of δ and of its rate per contact.
    pub advance: Vec<f64>,
    pub advance_rate: Vec<f64>,
    /// Of θ_F per contact; zero where it is prescribed.
    pub foundation: Vec<f64>,
    /// Of the depths of wear of sides of pairs.
    pub depths: Vec<Vec<f64>>,
}

/// θ_F per contact, zero where it is prescribed.
fn foundation(state: &State) -> Vec<f64> {
    state.surface.foundation.iter().map(|theta| theta.unwrap_or(0.0)).collect()
}

impl StateVector {
    /// No weights, of the size of a state.
    pub fn zero(state: &State) -> StateVector {
        StateVector {
            u: zeros(state.u.len()),
            w: zeros(state.w.len()),
            theta: zeros(state.theta.len()),
            theta_rate: zeros(state.theta_rate.len()),
            branches: state.branches.iter().map(|branch| zeros(branch.len())).collect(),
            wear: zeros(state.surface.wear.len()),
            work: zeros(state.surface.friction_work.len()),
            advance: zeros(state.surface.advance.len()),
            advance_rate: zeros(state.surface.advance_rate.len()),
            foundation: zeros(state.surface.foundation.len()),
            depths: state.surface.worn.depths.iter().map(|of| zeros(of.len())).collect(),
        }
    }

    /// A vector of this size without numbers other than zero.
    pub fn zeros(&self) -> StateVector {
        StateVector {
            u: zeros(self.u.len()),
            w: zeros(self.w.len()),
            theta: zeros(self.theta.len()),
            theta_rate: zeros(self.theta_rate.len()),
            branches: self.branches.iter().map(|branch| zeros(branch.len())).collect(),
            wear: zeros(self.wear.len()),
            work: zeros(self.work.len()),
            advance: zeros(self.advance.len()),
            advance_rate: zeros(self.advance_rate.len()),
            foundation: zeros(self.foundation.len()),
            depths: self.depths.iter().map(|of| zeros(of.len())).collect(),
        }
    }

    /// (4 v₀ − v₋₁)/3 of the vectors of two states, to which a step adds; v₀ of what it adds to the last state alone.
    pub fn mixed(start: &StateVector, before: &StateVector) -> StateVector {
        let mix = |now: &[f64], then: &[f64]| -> Vec<f64> {
            now.iter().zip(then).map(|(now, then)| (4.0 * now - then) / 3.0).collect()
        };
        StateVector {
            u: mix(&start.u, &before.u),
            w: mix(&start.w, &before.w),
            theta: mix(&start.theta, &before.theta),
            foundation: mix(&start.foundation, &before.foundation),
            branches: start.branches.iter().zip(&before.branches).map(|(now, then)| mix(now, then)).collect(),
            ..start.clone()
        }
    }

    /// Adds a multiple of the parts of another vector to which steps add: displacements, velocities, temperatures and
    /// branches.
    pub fn add_bar(&mut self, factor: f64, bar: &StateVector) {
        let add = |to: &mut [f64], from: &[f64]| {
            to.iter_mut().zip(from).for_each(|(to, from)| *to += factor * from);
        };
        add(&mut self.u, &bar.u);
        add(&mut self.w, &bar.w);
        add(&mut self.theta, &bar.theta);
        add(&mut self.foundation, &bar.foundation);
        self.branches.iter_mut().zip(&bar.branches).for_each(|(to, from)| add(to, from));
    }

    /// The derivative and the kink of values around a state, as [`stencil::central`] has them, the kink without
    /// round-off.
    pub fn central(h: f64, all: [&State; 5]) -> [StateVector; 2] {
        let of = |of: &dyn Fn(&State) -> &[f64]| {
            let values = all.map(of);
            stencil::of_lists(h, values, max_abs(values[2]))
        };
        let [u, w, theta] = [of(&|s| &s.u), of(&|s| &s.w), of(&|s| &s.theta)];
        let [wear, work] = [of(&|s| &s.surface.wear), of(&|s| &s.surface.friction_work)];
        let [advance, advance_rate] = [of(&|s| &s.surface.advance), of(&|s| &s.surface.advance_rate)];
        let rate = of(&|s| &s.theta_rate);
        let foundations = all.map(foundation);
        let foundations =
            stencil::of_lists(h, foundations.each_ref().map(|values| &values[..]), max_abs(&foundations[2]));
        let branches: Vec<[Vec<f64>; 2]> = (0..all[2].branches.len()).map(|b| of(&|s| &s.branches[b])).collect();
        let depths = |s: usize| of(&|state: &State| state.surface.worn.depths.get(s).map_or(&[][..], |of| of));
        let depths: Vec<[Vec<f64>; 2]> = (0..all[2].surface.worn.depths.len()).map(depths).collect();
        [0, 1].map(|k| StateVector {
            u: u[k].clone(),
            w: w[k].clone(),
            theta: theta[k].clone(),
            theta_rate: rate[k].clone(),
            branches: branches.iter().map(|both| both[k].clone()).collect(),
            wear: wear[k].clone(),
            work: work[k].clone(),
            advance: advance[k].clone(),
            advance_rate: advance_rate[k].clone(),
            foundation: foundations[k].clone(),
            depths: depths.iter().map(|both| both[k].clone()).collect(),
        })
    }

    /// All numbers, in lists.
    pub fn lists(&self) -> impl Iterator<Item = &Vec<f64>> {
        let StateVector { u, w, theta, theta_rate, branches, wear, work, depths, .. } = self;
        let StateVector { advance, advance_rate, foundation, .. } = self;
        let all = [u, w, theta, theta_rate, wear, work, advance, advance_rate, foundation];
        all.into_iter().chain(branches).chain(depths)
    }

    /// True if all numbers are zero.
    pub fn is_zero(&self) -> bool {
        self.lists().flatten().all(|value| *value == 0.0)
    }

    /// The sum of the products with the values of a state.
    pub fn product(&self, state: &State) -> f64 {
        let branches = self.branches.iter().zip(&state.branches).map(|(a, b)| dot(a, b)).sum::<f64>();
        let surface = &state.surface;
        dot(&self.u, &state.u)
            + dot(&self.w, &state.w)
            + dot(&self.theta, &state.theta)
            + branches
            + dot(&self.wear, &surface.wear)
            + dot(&self.work, &surface.friction_work)
            + dot(&self.advance, &surface.advance)
            + dot(&self.advance_rate, &surface.advance_rate)
            + dot(&self.foundation, &foundation(state))
            + self.depths.iter().zip(&surface.worn.depths).map(|(a, b)| dot(a, b)).sum::<f64>()
    }

    /// Takes from an equilibrium what a run starts with.
    pub fn start_from(&mut self, equilibrium: StateVector) {
        let StateVector { u, advance, .. } = equilibrium;
        (self.u, self.advance) = (u, advance);
    }

    /// Makes the numbers those of a state at rest.
    pub fn rest(&mut self) {
        self.w.fill(0.0);
        self.advance_rate.fill(0.0);
    }
}
