//! Contact on Γ_C: laws at a point, and their place on the boundary of a mesh.
//!
//! A law is a pure function: it sees the state of one point of Γ_C and returns a pressure, a
//! friction bound or a heat flux with slopes. The projection onto the friction cone, the
//! elimination of the multipliers and all that couples points belongs to [`crate::linalg`].

mod boundary;
mod friction;
mod heat;
mod normal;

pub use boundary::{Contact, ContactBoundary, PointOnBoundary, Quadrature};
pub use friction::{Bound, Coulomb, FrictionLaw, Frictionless};
pub use heat::{Flux, HeatLaw, Insulated, Ramp};
pub use normal::{Compliance, NormalLaw, ValueSlope};

#[cfg(test)]
pub(crate) use {friction::samples as friction_samples, heat::samples as heat_samples, normal::samples as normal_samples};

/// What a law may look at: the state of one point of Γ_C.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactPoint {
    /// Position in m.
    pub x: crate::tensor::Point,
    /// Penetration r = u_ν − g in m; negative where the gap is open.
    pub penetration: f64,
    /// Pressure p = −σ_ν in Pa.
    pub pressure: f64,
    /// Slip speed ‖u̇_τ‖ in m/s.
    pub slip_speed: f64,
    /// Temperature θ of the body in K.
    pub temperature: f64,
    /// Temperature θ_F of the foundation in K.
    pub foundation_temperature: f64,
}

/// State of a point of Γ_C.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Status {
    /// No pressure.
    Open,
    /// Pressure, and a friction traction inside the cone: no slip.
    Stick,
    /// Pressure, and a friction traction at its bound.
    Slip,
}

impl Status {
    /// The word in result files: `open`, `stick` or `slip`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Status::Open => "open",
            Status::Stick => "stick",
            Status::Slip => "slip",
        }
    }
}
