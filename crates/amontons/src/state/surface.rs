//! Memory of Γ_C: what contact and foundation accumulate from step to step.

use serde::{Deserialize, Serialize};

use crate::contact::{Wet, Worn};
use crate::inclusion::Passed;

/// What Γ_C and the foundation accumulate from step to step.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Accumulated {
    /// Depth worn off at each contact point, m; of a pair that of both bodies where they face each other now.
    pub wear: Vec<f64>,
    /// What has come off the sides of pairs.
    pub worn: Worn,
    /// Work of friction at each contact point since the start, J/m².
    pub friction_work: Vec<f64>,
    /// θ_F of each contact whose foundation has a heat capacity, K; none where it is prescribed.
    pub foundation: Vec<Option<f64>>,
    /// Heat that has passed each contact since the start, J.
    pub passed: Vec<Passed>,
    /// δ of each contact, m: by how much the sides of a section are drawn together, or an obstacle under a load has
    /// moved along its direction; zero elsewhere.
    pub advance: Vec<f64>,
    /// The mean rate of δ in the last step, m/s.
    pub advance_rate: Vec<f64>,
    /// Where fluids are.
    pub wet: Wet,
}
