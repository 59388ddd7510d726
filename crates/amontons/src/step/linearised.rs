//! The derivative of a step: of the temperature that (4.2) gives in the temperature that (4.1) was solved with.
//!
//! With Φ of (3.10) within a step, [`Linearised::apply`] is δθ − Φ′ δθ. Both half-steps are linearised at a solution:
//! contact by the tangents of its laws at each point, the body by its forms. The factors are those of the step, so a
//! product costs four sweeps.

use crate::equation::heat::Heat;
use crate::equation::mechanics::Mechanics;
use crate::equation::system::{HalfStep, Step, on_degrees};
use crate::inclusion::PointDerivative;
use crate::linalg::{BlockMatrix, SolveError, Tangent};
use crate::tensor::{self, Point, length};
use crate::time::Rule;

/// The derivative of both half-steps at a solution.
pub(super) struct Linearised {
    mechanics: Tangent,
    points: Vec<PointDerivative>,
    heat: Tangent,
    /// ∂(q·ν) in r, p, ‖w_τ‖ and q·w_τ, with q, the slip and ν at each contact point.
    fluxes: Vec<[f64; 4]>,
    friction: Vec<[Point; 2]>,
    normals: Vec<Point>,
    /// Derivative of the forces of the body with respect to the temperature, if it differs from m, and the nonsymmetric
    /// part of the derivative of conduction.
    force_slope: Option<BlockMatrix>,
    heat_slope: Option<BlockMatrix>,
    /// True if the whole power of friction enters the bodies, as at a pair.
    rubs: Vec<bool>,
}

impl Linearised {
    /// Linearises both half-steps. Matrices that depend on the temperature are factorized at the solution.
    pub fn new(
        step: &Step,
        [of_mechanics, of_heat]: [&mut HalfStep; 2],
        mechanics: &Mechanics,
        heat: &Heat,
    ) -> Result<Linearised, SolveError> {
        let Step { discrete, contacts, boundary, .. } = *step;
        if discrete.softens() {
            mechanics.renew(step, of_mechanics)?;
        }
        if !discrete.conducts_linearly() {
            heat.renew(step, of_heat)?;
        }
        let (tangent, points) = mechanics.contact_tangent(step, of_mechanics);
        let states = &mechanics.end.states;
        let fluxes = heat
            .exchange
            .flux
            .iter()
            .map(|f| [f.by_penetration, f.by_pressure, f.by_slip_speed, f.by_friction_power])
            .collect();
        Ok(Linearised {
            mechanics: tangent,
            points,
            heat: heat.contact_tangent(step, of_heat, states),
            fluxes,
            friction: states.iter().map(|state| [state.q, state.slip]).collect(),
            normals: states.iter().map(|state| state.normal).collect(),
            force_slope: discrete.mechanical_slope(mechanics.u(), mechanics.w(), &mechanics.theta),
            heat_slope: discrete.thermal_slope(&heat.theta),
            rubs: boundary.points.iter().map(|point| contacts[point.contact].rubs()).collect(),
        })
    }

    /// The right-hand side for a residual: P⁻¹J times the residual, with P the symmetric part of the derivative J of
    /// (4.2). Both sides of the equation are multiplied by P⁻¹J, so that J is not inverted.
    pub fn right(&self, of_heat: &mut HalfStep, residual: &[f64]) -> Result<Vec<f64>, SolveError> {
        let Some(slope) = &self.heat_slope else { return Ok(residual.to_vec()) };
        let more = of_heat.system.linearised(&self.heat, &slope.apply(residual))?;
        Ok(residual.iter().zip(&more).map(|(residual, more)| residual + more).collect())
    }

    /// δθ − Φ′ δθ, multiplied by P⁻¹J.
    pub fn apply(
        &self,
        step: &Step,
        [of_mechanics, of_heat]: [&mut HalfStep; 2],
        change: &[f64],
    ) -> Result<Vec<f64>, SolveError> {
        let Step { discrete, contacts, boundary, rule, .. } = *step;
        let (Rule { gamma, level, .. }, share) = (rule, rule.contact_share());
        let warmer = boundary.scalars_on(contacts, change);
        let contact = on_degrees(
            boundary,
            &discrete.v,
            self.points.iter().zip(&warmer).map(|(point, warmer)| point.force_by_temperature.map(|f| f * warmer)),
        );
        let slope = self.force_slope.as_ref().unwrap_or(&discrete.m);
        let right: Vec<f64> =
            slope.apply(change).iter().zip(&contact).map(|(thermal, contact)| thermal - share * contact).collect();
        let w = of_mechanics.system.linearised(&self.mechanics, &right)?;
        let u: Vec<f64> = w.iter().map(|w| gamma * w).collect();
        let points = boundary.points.iter().enumerate();
        let chi: Vec<[f64; 2]> = points
            .map(|(i, point)| {
                let v = boundary.vector_at(point, discrete.mesh.dim, &w);
                let derivative = &self.points[i];
                let force: [f64; 3] = std::array::from_fn(|c| {
                    tensor::dot(&derivative.force[c], &v) + derivative.force_by_temperature[c] * warmer[i]
                });
                let wear = tensor::dot(&derivative.wear, &v) + derivative.wear_by_temperature * warmer[i];
                let [by_penetration, by_pressure, by_slip_speed, by_friction_power] = self.fluxes[i];
                let ([q, slip], nu) = (&self.friction[i], &self.normals[i]);
                let (w_nu, pressure, speed) = (tensor::dot(&v, nu), tensor::dot(&force, nu), length(slip));
                let in_speed = if speed > 0.0 { tensor::dot(&v, slip) / speed } else { 0.0 };
                // q and the slip are tangential.
                let power = tensor::dot(&force, slip) + tensor::dot(q, &v);
                let out = by_penetration * (gamma * w_nu - level * wear)
                    + by_pressure * pressure
                    + by_slip_speed * in_speed
                    + by_friction_power * power;
                [out, out + if self.rubs[i] { power } else { 0.0 }]
            })
            .collect();
        let mut sum = vec![0.0; discrete.q.free.len()];
        boundary.scatter_heat(chi.into_iter(), &mut sum);
        let chi = sum;
        let mut right: Vec<f64> = discrete.e.apply(&u).iter().zip(&chi).map(|(e, chi)| e - chi).collect();
        if let Some(slope) = &self.heat_slope {
            right.iter_mut().zip(slope.apply(change)).for_each(|(right, slope)| *right -= slope);
        }
        let theta = of_heat.system.linearised(&self.heat, &right)?;
        Ok(change.iter().zip(&theta).map(|(change, theta)| change - theta).collect())
    }
}
