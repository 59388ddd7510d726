//! Memory of Γ_C: quantities that contact and foundation accumulate from step to step.

use serde::{Deserialize, Serialize};

use crate::contact::{Wet, Worn};
use crate::inclusion::Passed;

/// Quantities that Γ_C and the foundation accumulate from step to step.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Accumulated {
    /// Depth worn off at each contact point, m; for a pair the sum over both bodies at the positions that face each
    /// other now.
    pub wear: Vec<f64>,
    /// Wear of the sides of pairs.
    pub worn: Worn,
    /// Work of friction at each contact point since the start, J/m².
    pub friction_work: Vec<f64>,
    /// θ_F of each contact whose foundation has a heat capacity, K, or `None` if θ_F is prescribed.
    pub foundation: Vec<Option<f64>>,
    /// Heat that has passed each contact since the start, J.
    pub passed: Vec<Passed>,
    /// δ of each contact, m: the length by which the sides of a section are drawn together, or the displacement of an
    /// obstacle under a load along its direction; zero elsewhere.
    pub advance: Vec<f64>,
    /// The mean rate of δ in the last step, m/s.
    pub advance_rate: Vec<f64>,
    /// Distance from the body at rest at which a bilateral contact that began with a phase holds its points, m, per
    /// contact point; empty if there is none.
    pub offset: Vec<f64>,
    /// Wetted places, which fluids have reached.
    pub wet: Wet,
}
