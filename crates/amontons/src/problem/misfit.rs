//! What does not fit where a phase begins.

use serde::{Deserialize, Serialize};

use crate::tensor::Point;

/// A condition that begins with a phase and does not fit the state of the body there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Misfit {
    /// Number of the phase that begins.
    pub phase: usize,
    /// The condition.
    pub of: MisfitOf,
    /// Distance between where the side is and where the condition has it, m.
    pub size: f64,
    /// Position of the largest distance, m.
    pub at: Point,
}

/// The condition of a misfit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum MisfitOf {
    /// A prescribed displacement, by number of the entry.
    Displacement(usize),
    /// A contact, by number, whose side is inside its foundation or its other side.
    Contact(usize),
}
