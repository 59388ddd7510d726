//! The foundation at a contact point, and the state of the point.

use crate::contact::Status;
use crate::tensor::Point;

/// The foundation at one contact point in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frame {
    /// Unit normal ν of the contact, towards the foundation: that of the body, or the opposite of the normal of the
    /// obstacle.
    pub normal: Point,
    /// g(t_n) in m, with what has worn off before the step.
    pub gap: f64,
    /// Mean rate of g in the step but for wear, m/s.
    pub gap_rate: f64,
    /// v_F(t_n) in m/s, tangential.
    pub velocity: Point,
    /// True if the foundation slides at this velocity without moving away: it has a velocity of its own or turns in its
    /// place.
    pub slides: bool,
    /// Opening of the gap at the point within the step per depth worn off there: 1, or less if the worn surface is
    /// faced only in part.
    pub opening: f64,
}

/// How a contact point starts into a step of the ϑ-scheme.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Onset {
    /// Largest velocity of approach x_ν − v_g at t_ϑ on a rigid foundation, m/s; infinite if the point bears nothing.
    pub approach: f64,
    /// b = (1 − ϑ)(w₀,τ − v_F) in m/s, tangential, if the law of friction holds at the end of the step; else zero.
    pub slip: Point,
}

/// State of one contact point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointState {
    /// Unit normal ν of the contact, towards the foundation.
    pub normal: Point,
    /// Penetration r = u_ν − g at the end of the step, m.
    pub penetration: f64,
    /// Penetration at the time of the equations of the step, by which heat flows, m.
    pub at_level: f64,
    /// Pressure p in Pa.
    pub pressure: f64,
    /// Friction bound s in Pa.
    pub bound: f64,
    /// q = −σ_τ in Pa.
    pub q: Point,
    /// Slip velocity w_τ − v_F in m/s.
    pub slip: Point,
    /// Depth that wears off in the step, of both bodies of a pair together, m.
    pub wear: f64,
    /// Opening of the gap by wear in the step, m.
    pub opened: f64,
    /// Open, stick or slip.
    pub status: Status,
}

impl PointState {
    /// True if a traction acts at the point: pressure, adhesion or friction.
    #[must_use]
    pub fn bears(&self) -> bool {
        self.pressure != 0.0 || self.q.iter().any(|q| *q != 0.0)
    }
}

/// Derivative of the force p ν + q on the foundation in the velocity at a contact point, Pa s/m, rows the force.
pub type PointTangent = [[f64; 3]; 3];

/// Derivatives at a contact point, the multipliers eliminated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PointDerivative {
    /// Derivative of the force p ν + q in the velocity.
    pub force: PointTangent,
    /// Derivative of the force in the temperature of the body, Pa/K.
    pub force_by_temperature: Point,
    /// Derivative in the velocity of the depth by which the gap opens by wear in the step, s.
    pub wear: Point,
    /// Derivative of that depth in the temperature, m/K.
    pub wear_by_temperature: f64,
}
