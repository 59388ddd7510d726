//! The force that presses an obstacle against the body.

use super::{Checks, ShapeFaults};
use crate::field::Field;
use crate::tensor::Point;

/// A load on a guided obstacle, which keeps its orientation and moves along a line as far as the body allows.
///
/// Besides its prescribed motion it moves, with its axis of rotation, by δ(t) along the unit vector d, so that
///
/// ```text
///     m δ̈ = F(t) + d·∫ (p ν + q)
/// ```
///
/// with the forces p ν + q of the body on it. Without a mass it is in equilibrium at each time. δ and its rate are zero
/// at t = 0.
///
/// Source: the balance of momentum of a rigid body that is guided along a line.
#[derive(Clone, Debug)]
pub struct ObstacleLoad {
    /// F in N along d, a function of time, per unit of thickness in two dimensions; on the whole ring of a body of
    /// revolution.
    pub force: Field,
    /// d, a unit vector.
    pub direction: Point,
    /// m ≥ 0 in kg, per unit of thickness in two dimensions.
    pub mass: f64,
    /// δ in m as computed by a run, to show the obstacle where it was; `None` before the run.
    pub found: Option<Field>,
}

impl ObstacleLoad {
    /// A load along a vector of any length.
    ///
    /// # Errors
    /// Fails if the direction is zero or not finite.
    pub fn new(force: Field, direction: Point, mass: f64) -> Result<ObstacleLoad, ShapeFaults> {
        let mut checks = Checks::default();
        let direction = checks.unit("direction", direction);
        checks.result(ObstacleLoad { force, direction, mass, found: None })
    }

    /// δ as far as known, m; zero before the run.
    pub(super) fn known(&self, t: f64) -> f64 {
        self.found.as_ref().map_or(0.0, |found| found.value(&[0.0; 3], t))
    }
}
