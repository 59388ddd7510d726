//! Softening contact laws, with which a step may have several solutions (`book/src/theory.md`).

use super::laws::tested;
use super::sample::Samples;
use super::{Finding, FindingId, FindingStatus};
use crate::contact::{Contact, ContactPoint};
use crate::problem::Problem;
use crate::tensor::Point;

/// Number of pressures per point at which a law is sampled.
const SAMPLES: usize = 64;

/// Measures of softening of the laws of a contact; all zero if no law softens.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Falls {
    /// s in Pa/m: the slopes of p_ν are −s or more; infinite across a drop.
    pub pressure: f64,
    /// f in s/m: the slopes of the friction bound in the slip speed are −f p or more, as far as samples show.
    pub with_speed: f64,
    /// Drop of the friction bound at the start of slip over p, as far as samples show.
    pub at_start: f64,
}

impl Falls {
    /// Samples a contact with points at `places`, with pressures for friction up to `stress` in Pa.
    fn of(contact: &Contact, places: &[Point], stress: f64) -> Falls {
        let pressure = places
            .iter()
            .map(|x| -contact.normal.least_slope(x, f64::NEG_INFINITY, f64::INFINITY).min(0.0))
            .fold(0.0, f64::max);
        let mut falls = Falls { pressure, ..Falls::default() };
        if contact.friction.is_frictionless() {
            return falls;
        }
        let mut random = Samples::default();
        for x in places {
            for _ in 0..SAMPLES {
                let at = ContactPoint { x: *x, pressure: random.spread(stress, 12.0).abs(), ..ContactPoint::default() };
                let bound = |slip_speed: f64| contact.friction.bound(&ContactPoint { slip_speed, ..at }).value;
                falls.with_speed =
                    falls.with_speed.max(-contact.friction.least_slope(&at, 0.0, f64::INFINITY) / at.pressure);
                falls.at_start = falls.at_start.max((bound(0.0) - bound(f64::MIN_POSITIVE)) / at.pressure);
            }
        }
        falls
    }

    fn any(self) -> bool {
        self.pressure > 0.0 || self.with_speed > 0.0 || self.at_start > 0.0
    }
}

/// The softening of the laws of every contact.
pub(super) fn falls(problem: &Problem) -> Vec<Falls> {
    let stiffness =
        problem.materials.iter().flat_map(|m| [m.elasticity.constants().lipschitz, m.viscosity.constants().lipschitz]);
    let stress = stiffness.filter(|s| s.is_finite()).fold(0.0, f64::max);
    let stress = if stress > 0.0 { stress } else { 1.0 };
    tested(problem).map(|test| test.sampled(|| Falls::of(test.contact, &test.places, stress))).collect()
}

/// `softening`: reports softening laws, their slopes, and how a run treats them; `None` if no law softens.
pub(super) fn softening(problem: &Problem) -> Option<Finding> {
    let all = falls(problem);
    let side = all.iter().position(|falls| falls.any())?;
    let falls = all[side];
    let mut causes = Vec::new();
    if falls.pressure.is_infinite() {
        causes.push("the pressure drops from one value to another, in steps of any length".to_owned());
    } else if falls.pressure > 0.0 {
        causes.push(format!("the pressure decreases by up to s = {:.6e} Pa/m", falls.pressure));
    }
    if falls.with_speed > 0.0 {
        causes.push(format!(
            "friction decreases with the slip speed by up to {:.6e} s/m of the pressure",
            falls.with_speed
        ));
    }
    if falls.at_start > 0.0 {
        let drop = falls.at_start;
        causes.push(format!(
            "friction drops by {drop:.6e} of the pressure when slip starts: in between a point may stick or slip in any step, and keeps its previous state as long as possible"
        ));
    }
    let mut message = format!("a step may have several solutions: {}", causes.join("; "));
    if falls.pressure > 0.0 || falls.with_speed > 0.0 {
        message += ". A run follows the branch of the previous step. Steps in which the laws soften by more than the stiffness of the body are halved up to 5 times; those that remain ambiguous are counted in solver.ambiguous_steps. A step that is not counted has no other solution between its ends with the friction bounds found; with other bounds it may have one";
    }
    let part = if falls.pressure > 0.0 { "normal" } else { "friction" };
    let value = [falls.pressure, falls.with_speed, falls.at_start]
        .into_iter()
        .find(|fall| *fall > 0.0)
        .filter(|fall| fall.is_finite());
    let place = format!("{}.{part}", problem.contact_path(side));
    Some(Finding::new(FindingId::Softening, FindingStatus::NotCovered, message, &place).numbers(value, Some(0.0)))
}
