//! Backward Euler for Problem 4.1.

use std::sync::Arc;

use super::audit::audit;
use super::coupling::{Coupled, Made};
use super::system::{Products, Step, System, vector_at};
use super::{ContactReport, Counts, Discretization, Ledger, Scheme, SetupError, State, StepError, StepReport};
use crate::linalg::{Backend, Multipliers, dot};
use crate::problem::Problem;
use crate::tensor;

/// Backward Euler for (4.1) and (4.2), coupled as [`Problem::coupling`] says.
#[derive(Debug)]
pub struct BackwardEuler {
    problem: Problem,
    discrete: Discretization,
    mechanics: System,
    heat: System,
    /// Products that one step computes and the next one needs, with the step they belong to.
    products: Option<Products>,
}

impl BackwardEuler {
    /// Assembles and factorizes: the only factorizations of a run where all laws of the body are linear.
    ///
    /// # Errors
    /// When a system is singular or does not fit into memory.
    pub fn new(problem: &Problem, backend: Arc<dyn Backend>) -> Result<BackwardEuler, SetupError> {
        let discrete = Discretization::new(problem);
        // Laws that are not linear have their tangent at rest here; each step makes its own.
        let (k, rest) = (problem.k(), vec![0.0; discrete.v.free.len()]);
        let backends = [Arc::clone(&backend), backend];
        let (mechanics, heat) = rayon::join(
            || System::new(&discrete.mechanical_tangent(k, &rest, &rest), &discrete, &discrete.v, &backends[0]),
            || System::new(&discrete.thermal_matrix(k), &discrete, &discrete.q, &backends[1]),
        );
        let mechanics = mechanics.map_err(|source| SetupError::Factor { part: "mechanical", source })?;
        let heat = heat.map_err(|source| SetupError::Factor { part: "heat", source })?;
        Ok(BackwardEuler { problem: problem.clone(), discrete, mechanics, heat, products: None })
    }

    /// Unknowns of displacement, temperature and on Γ_C.
    #[must_use]
    pub fn unknowns(&self) -> [usize; 3] {
        [self.mechanics.unknowns.len(), self.heat.unknowns.len(), self.mechanics.condensed.len()]
    }

    /// Numbers that both factors store.
    #[must_use]
    pub fn stored(&self) -> usize {
        self.mechanics.factor.stored() + self.heat.factor.stored()
    }
}

impl Scheme for BackwardEuler {
    fn discretization(&self) -> &Discretization {
        &self.discrete
    }

    fn initial(&self) -> Result<State, SetupError> {
        let (mesh, data) = (&self.discrete.mesh, &self.problem.initial);
        let u = self.discrete.v.interpolate(mesh, &data.displacement, 0.0);
        let w = self.discrete.v.interpolate(mesh, &data.velocity, 0.0);
        let theta = self.discrete.q.interpolate(mesh, std::slice::from_ref(&data.temperature), 0.0);
        for (values, name) in [(&u, "displacement"), (&w, "velocity"), (&theta, "temperature")] {
            if values.iter().any(|v| !v.is_finite()) {
                return Err(SetupError::Initial(name));
            }
        }
        let ((rho, inertia), (c, storage)) = (self.discrete.inertia(), self.discrete.storage());
        let kinetic = 0.5 * rho * dot(&w, &inertia.apply(&w));
        // Without a potential the energy is counted from the initial state.
        let elastic = self.discrete.stored_energy(&u).unwrap_or(0.0);
        let branches = vec![vec![0.0; u.len()]; self.discrete.branches.len()];
        let mut contact_energy = 0.0;
        if let Some(contact) = &self.problem.contact {
            let gap = self.discrete.at_contact(&contact.gap, 0.0);
            for (point, gap) in self.discrete.boundary.points.iter().zip(gap) {
                let r = tensor::dot(&vector_at(&self.discrete, point, &u), &point.normal) - gap;
                contact_energy += point.weight * contact.normal.potential(&point.x, r);
            }
        }
        let heat_content = c * storage.apply(&theta).iter().sum::<f64>();
        let ledger = Ledger {
            kinetic,
            elastic,
            contact_energy,
            turned_over: kinetic + elastic + contact_energy,
            heat_content,
            heat_turned_over: heat_content.abs(),
            ..Ledger::default()
        };
        let belt = self.problem.contact.as_ref().map_or(Vec::new(), |c| self.discrete.foundation_velocity(c, 0.0));
        let at_rest = self.discrete.boundary.points.iter().enumerate().map(|(i, point)| {
            let (v, v_f) = (vector_at(&self.discrete, point, &w), belt.get(i).copied().unwrap_or_default());
            let normal = tensor::dot(&v, &point.normal);
            (0..3).all(|c| v[c] - normal * point.normal[c] - v_f[c] == 0.0)
        });
        let multipliers = Multipliers::free(at_rest.collect());
        Ok(State { step: 0, t: 0.0, u, w, theta, multipliers, branches, ledger, counts: Counts::default() })
    }

    fn step(&mut self, old: &State) -> Result<(State, StepReport), StepError> {
        let step = old.step + 1;
        let t = self.problem.time(step);
        let products = self.products.take().filter(|p| p.step == old.step).unwrap_or_else(|| Products::of(&self.discrete, old));
        let Self { problem, discrete, mechanics, heat, .. } = self;
        let now = Step { problem, discrete, old, products: &products, n: step, t };
        let Made { mechanics, heat, report, iterations, sweeps } = Coupled::new(now, mechanics, heat).solve()?;
        let ledger = audit(&now, &mechanics, &heat);
        if !(ledger.closing_error.is_finite() && ledger.heat_closing_error.is_finite()) {
            return Err(StepError::NotFinite { step, t, part: "the energy" });
        }
        let counts = Counts {
            newton_mechanics_total: old.counts.newton_mechanics_total + iterations[0],
            newton_mechanics_max: old.counts.newton_mechanics_max.max(iterations[0]),
            newton_heat_total: old.counts.newton_heat_total + iterations[1],
            sweeps: old.counts.sweeps + sweeps,
            residual_max: old.counts.residual_max.max(mechanics.residual).max(heat.residual).max(report.defect.unwrap_or(0.0)),
            passes_total: old.counts.passes_total + report.passes,
            contraction_max: old.counts.contraction_max.max(report.contraction.unwrap_or_default()),
        };
        let report = StepReport {
            newton_mechanics: iterations[0],
            newton_heat: iterations[1],
            residual: mechanics.residual.max(heat.residual).max(report.defect.unwrap_or(0.0)),
            coupling: report,
            contact: ContactReport {
                states: mechanics.states,
                temperature: heat.temperature,
                flux: heat.flux,
                force: mechanics.force,
                heat_flow: heat.through_contact,
            },
        };
        self.products = Some(Products {
            step,
            mass_w: mechanics.mass_w,
            a_u: mechanics.a_u,
            a_w: mechanics.a_w,
            b_w: mechanics.b_w,
            mass_theta: heat.mass_theta,
            d_theta: heat.d_theta,
        });
        let state = State {
            step,
            t,
            u: mechanics.u,
            w: mechanics.w,
            theta: heat.theta,
            multipliers: mechanics.multipliers,
            branches: mechanics.branches,
            ledger,
            counts,
        };
        Ok((state, report))
    }

    fn factorizations(&self) -> (usize, usize) {
        (self.mechanics.factorizations() + self.heat.factorizations(), self.mechanics.condensed.factorizations() + self.heat.condensed.factorizations())
    }
}
