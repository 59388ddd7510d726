//! Whether what a steady step leads to is at rest.

use crate::equation::StepError;
use crate::equation::mechanics::Mechanics;
use crate::equation::system::Step;
use crate::tensor::length;

/// Velocity of a body over that of a foundation above which it is not at rest. At rest it is what rounds off a
/// displacement in infinite time, about 1e-21.
const AT_REST: f64 = 1e-6;

/// Checks that no body goes along with a foundation that slides. The equations of a steady step are scale-free in what
/// sticks: a body that friction jams has solutions that move for ever, with forces without bound.
pub(super) fn check(step: &Step, mechanics: &Mechanics) -> Result<(), StepError> {
    if !step.rule.is_steady() {
        return Ok(());
    }
    let sliding = mechanics.given.frames.iter().filter(|frame| frame.slides);
    let fastest = sliding.map(|frame| length(&frame.velocity)).fold(0.0, f64::max);
    let nodes = mechanics.w().chunks(step.discrete.mesh.dim).zip(&step.discrete.mesh.points);
    let moving = nodes.map(|(w, x)| (w.iter().map(|w| w * w).sum::<f64>().sqrt(), *x));
    match moving.max_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((v, at)) if v > AT_REST * fastest && fastest > 0.0 => {
            Err(StepError::DrawnAlong { step: step.n, t: step.t, at, share: v / fastest })
        }
        _ => Ok(()),
    }
}
