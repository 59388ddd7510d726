//! Whether a step obeys the equations that are differentiated.

use super::balances::{MET, largest_traction};
use super::instance::{ProblemInstance, SolvedStep, StepResidual, driving};
use super::worn::of_pairs_or;
use crate::contact::{Flux, PointOnBoundary};
use crate::equation::system::Step;
use crate::inclusion::PointOutput;
use crate::linalg::max_abs;
use crate::space::Space;
use crate::tensor::length;

/// Roundings of what bears nothing, such as a body that has sprung back.
const ROUNDINGS: f64 = 64.0;

/// |ū| + γ|w|, the sizes of the summands of the displacement.
fn summands(step: &Step, of: &SolvedStep) -> Vec<f64> {
    step.bar.u.iter().zip(&of.at.w).map(|(u, w)| u.abs() + step.rule.gamma * w.abs()).collect()
}

/// Round-off of the forces of a body, N.
fn round_off_of_forces(base: &ProblemInstance, of: &SolvedStep) -> f64 {
    base.step(of.n, of.old, |step| {
        let theta = driving(step, &of.at.theta);
        ROUNDINGS * step.discrete.mechanical_round_off(&summands(step, of), &step.rates(&of.at.w), &theta)
    })
}

/// Round-off of heat that is conducted and passed on by contact, W.
fn round_off_of_heat(base: &ProblemInstance, of: &SolvedStep) -> f64 {
    base.step(of.n, of.old, |step| {
        let by_temperature = |(point, flux): (&PointOnBoundary, &Flux)| {
            point.weight * flux.by_temperature.abs().max(flux.by_foundation.abs())
        };
        let passed = step.boundary.points.iter().zip(of.flux).map(by_temperature).fold(0.0, f64::max);
        let theta = &of.at.theta;
        ROUNDINGS * (step.discrete.thermal_round_off(theta) + f64::EPSILON * passed * max_abs(theta))
    })
}

/// Round-off of the pressure that keeps a displacement back, Pa.
fn round_off_of_laws(base: &ProblemInstance, of: &SolvedStep) -> f64 {
    base.step(of.n, of.old, |step| {
        let stiffness = of.chosen.rho().iter().fold(0.0, |most: f64, rho| most.max(*rho)) / step.rule.span;
        ROUNDINGS * f64::EPSILON * stiffness * max_abs(&summands(step, of))
    })
}

/// Slip relative to the largest velocity up to which a point rests.
const RESTS: f64 = 1e-9;

/// The largest difference of numbers.
fn most(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()))
}

/// True if numbers are not the same.
fn apart(a: &[f64], b: &[f64]) -> bool {
    most(a, b) > MET * max_abs(a).max(max_abs(b))
}

fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

impl StepResidual {
    /// The largest depth that would come off at this slip velocity, m: where all points stick, wear is round-off.
    fn worn_at(&self, speed: f64) -> f64 {
        let per_slip = |point: &PointOutput| {
            let slip = point.slip[0].hypot(point.slip[1]);
            if slip > 0.0 { point.worn.abs() / slip } else { 0.0 }
        };
        speed * self.points.iter().map(per_slip).fold(0.0, f64::max)
    }

    /// True if the depths at the end of the step are not those that the equations give.
    fn is_worn_otherwise(&self, base: &ProblemInstance, of: &SolvedStep) -> bool {
        let (old, new) = (&of.old.surface, &of.new.surface);
        let worn = base.step(of.n, of.old, |step| of_pairs_or(step, &self.worn, &sum(&old.wear, &self.worn)));
        let depths = sum(&old.worn.depths.concat(), &self.grown);
        let least = RESTS * self.worn_at(max_abs(&of.at.w));
        let is_other = |a: &[f64], b: &[f64]| apart(a, b) && most(a, b) > least;
        is_other(&worn, &new.wear) || is_other(&depths, &new.worn.depths.concat())
    }

    /// The first equation that a step does not obey at its solution, in words: one that the run has in another form.
    pub fn unmet(&self, base: &ProblemInstance, of: &SolvedStep) -> Option<&'static str> {
        let (discrete, body) = (&base.discrete, &self.body);
        let largest = |space: &Space, rest: &[f64]| {
            let mut rest = rest.to_vec();
            space.gather(&mut rest);
            space.mask(&mut rest);
            max_abs(&rest)
        };
        let traction = largest_traction(&self.states);
        let points = discrete.boundary.points.iter().zip(&self.points).filter(|(point, _)| point.weight > 0.0);
        let defect = points.fold(0.0, |most: f64, (_, point)| most.max(max_abs(&point.defect)));
        let (old, new) = (&of.old.surface, &of.new.surface);
        let theta = if base.problem.physics.has_heat() { &of.at.theta } else { &of.new.theta };
        let work = sum(&old.friction_work, &self.work);
        // Where all points stick, their slip and its work are round-off.
        let q = self.states.iter().fold(0.0, |most: f64, state| most.max(length(&state.q)));
        let rubbed = base.instant(of.n).k * q * max_abs(&of.at.w);
        let rounded = |rest: f64, size: f64, round_off: &dyn Fn() -> f64| rest <= MET * size || rest <= round_off();
        let [of_forces, of_heat] =
            [&|| round_off_of_forces(base, of), &|| round_off_of_heat(base, of)] as [&dyn Fn() -> f64; 2];
        match () {
            () if !rounded(largest(&discrete.v, &self.mechanics(discrete)), self.sizes[0], of_forces) => {
                Some("the balance of forces")
            }
            () if !body.heat.is_empty()
                && !rounded(largest(&discrete.q, &self.heat(discrete)), self.sizes[1], of_heat) =>
            {
                Some("the balance of heat")
            }
            () if apart(&body.rates, &of.at.w) => Some("the prescribed displacements"),
            () if !body.temperatures.is_empty() && apart(&body.temperatures, theta) => {
                Some("the prescribed temperatures")
            }
            () if !rounded(defect, traction, &|| round_off_of_laws(base, of)) => Some("the laws of contact"),
            () if self.lacking.iter().zip(&self.driving).any(|(lack, size)| lack.abs() > MET * size) => {
                Some("the equilibrium of a driven contact")
            }
            () if self.missing.iter().zip(&self.warming).any(|(lack, size)| lack.abs() > MET * size) => {
                Some("the balance of heat of a foundation")
            }
            () if apart(&body.u, &of.new.u) => Some("the displacement at the end of the step"),
            () if self.is_worn_otherwise(base, of) => Some("the depth of wear"),
            () if apart(&work, &new.friction_work) && most(&work, &new.friction_work) > RESTS * rubbed => {
                Some("the work of friction")
            }
            () => None,
        }
    }
}
