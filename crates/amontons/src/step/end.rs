//! The state at the end of a step, and its report.

use super::coupling::Made;
use crate::equation::apart::Whole;
use crate::equation::mechanics::{Balanced, Mechanics};
use crate::equation::system::{Products, Step};
use crate::inclusion::{Exchange, PointState};
use crate::state::{Carried, ContactReport, Counts, Ledger, Reactions, State, StepReport};

impl Made {
    /// Residual of (4.1), (4.2) and of their coupling.
    fn residual(&self) -> f64 {
        self.mechanics.residual.max(self.heat.residual).max(self.report.defect.unwrap_or(0.0))
    }

    /// The counts with those of this step.
    fn counts(&self, old: &Counts) -> Counts {
        Counts {
            newton_mechanics_total: old.newton_mechanics_total + self.iterations[0],
            newton_mechanics_max: old.newton_mechanics_max.max(self.iterations[0]),
            newton_heat_total: old.newton_heat_total + self.iterations[1],
            sweeps: old.sweeps + self.sweeps,
            residual_max: old.residual_max.max(self.residual()),
            passes_total: old.passes_total + self.report.passes,
            contraction_max: old.contraction_max.max(self.report.contraction.unwrap_or_default()),
            ..old.clone()
        }
    }

    /// The state at the end of the step, the report, and the products that the next step needs.
    pub(super) fn end(self, step: &Step, ledger: Ledger) -> (State, StepReport, Products) {
        let (old, residual, counts) = (step.old, self.residual(), self.counts(&step.old.counts));
        let Made { mechanics, heat, report: coupling, iterations, .. } = self;
        let theta = step.theta_at_end(heat.theta);
        let surface = old.surface.after(step, &mechanics, &heat.exchange);
        let Mechanics { end, whole, branches, is_unique, .. } = mechanics;
        let Balanced { at, u, states, force, reactions, .. } = end;
        let (u, w, carried) = match whole {
            None => (u, at.w, Carried::default()),
            Some(Whole { u, w, carried, .. }) => (u, w, carried),
        };
        let state = State {
            step: step.n,
            t: step.t,
            u: step.end(&old.u, u),
            w: step.end_velocity(step.rates(&w).into_owned()),
            theta_rate: step.theta_rate(&theta),
            earlier: None,
            settling: 0,
            theta,
            multipliers: at.multipliers,
            branches: old.branches.iter().zip(branches).map(|(old, branch)| step.end(old, branch)).collect(),
            carried,
            surface,
            ledger,
            counts,
            temperatures: old.temperatures,
            released: old.released.clone(),
            pace: old.pace.clone(),
            coarse: None,
        };
        let report = StepReport {
            newton_mechanics: iterations[0],
            newton_heat: iterations[1],
            parts: 1,
            is_ambiguous: !is_unique,
            residual,
            coupling,
            loose: step.motions(&at.hold.loose),
            reactions: Reactions { force: reactions, heat: heat.reactions },
            forces: step.nodal_forces(),
            contact: ContactReport { force, heat_flow: heat.through_contact, ..at_points(step, states, heat.exchange) },
        };
        let products = Products {
            t: step.t,
            mass_w: at.mass_w.into_owned(),
            a_u: at.a_u.into_owned(),
            a_w: at.a_w.into_owned(),
            b_w: at.b_w.into_owned(),
            mass_theta: heat.mass_theta,
            d_theta: heat.d_theta,
        };
        (state, report, products)
    }
}

/// What happened at the contact points.
fn at_points(step: &Step, mut states: Vec<PointState>, exchange: Exchange) -> ContactReport {
    for (point, state) in step.boundary.points.iter().zip(&mut states) {
        // A body that has passed the place of a foundation that does not act does not penetrate it.
        if step.problem.contacts.get(point.contact).is_some_and(|contact| !contact.acts()) {
            state.penetration = state.penetration.min(0.0);
        }
    }
    ContactReport {
        moments: step.moments(&states),
        weights: step.boundary.points.iter().map(|point| point.weight).collect(),
        states,
        temperature: exchange.temperature,
        opposite: exchange.opposite,
        flux: exchange.flux,
        rubbed: exchange.rubbed,
        ..ContactReport::default()
    }
}
