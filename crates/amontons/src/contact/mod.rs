//! Contact on Γ_C: laws at a point, and the contact points on the boundary of a mesh.
//!
//! A law is a pure function: it sees the state of one point of Γ_C and returns a pressure, a friction bound or a heat
//! flux with slopes. The projection onto the friction cone, the elimination of the multipliers and all coupling between
//! points belong to [`crate::inclusion`].

mod arrays;
mod boundary;
mod fluid;
mod foundation;
mod friction;
mod graded;
mod heat;
mod idle;
mod means;
pub mod mortar;
mod names;
mod normal;
pub mod obstacle;
mod pair;
mod preload;
mod table;
mod wear;
mod worn;

pub(crate) use arrays::arrays;
pub use arrays::{ArrayFriction, ArrayHeat, ArrayNormal, ArrayWear, CONTACT_INPUTS};
pub use boundary::{Contact, ContactBoundary, PointOnBoundary, Quadrature, Side};
pub use fluid::{Fluid, Leak, Ways, Wet};
pub use foundation::LumpedFoundation;
pub use friction::{
    Bound, Capped, Cone, Coulomb, FrictionFormula, FrictionLaw, FrictionVariable, Frictionless, NoSlip,
    OrthotropicFriction, StaticKinetic, Tabulated, Tresca,
};
pub use heat::{
    ConductanceFormula, ConstantConductance, FRICTION, Flux, FrictionalHeat, GapConduction, HeatLaw, Insulated,
    PowerConductance, PressureConductance, Radiation, Ramp, STEFAN_BOLTZMANN, Sum,
};
pub use means::{Shares, read, read_vector};
pub use names::{names, names_of_points};
pub use normal::{
    Adhesion, Bilateral, Compliance, Damped, GraphKind, HuntCrossley, Impact, MeanPressure, NormalLaw, Power, Pressure,
    PressureFormula, PressureFormulaFault, PressureTable, PressureTableFault, Signorini, Softening, Stop, Yield,
    resolvent,
};
pub use obstacle::Obstacle;
pub use pair::{Geometry, Pair, Supports};
pub use preload::Preload;
pub use table::{PiecewiseLinear, TableFault};
pub use wear::{Archard, WearLaw};
pub use worn::{Worn, WornSides};

#[cfg(test)]
pub(crate) use {
    friction::samples as friction_samples, heat::samples as heat_samples, normal::samples as normal_samples,
    wear::samples as wear_samples,
};

/// State of one point of Γ_C, the argument of contact laws.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactPoint {
    /// Position in m.
    pub x: crate::tensor::Point,
    /// Penetration r = u_ν − g in m; negative if the gap is open.
    pub penetration: f64,
    /// Pressure p = −σ_ν in Pa; friction laws see p₊, or |p| if contact is bilateral.
    pub pressure: f64,
    /// Slip speed ‖w_τ‖ against the foundation in m/s; friction laws see zero while the point sticks.
    pub slip_speed: f64,
    /// Power of friction q·w_τ in W/m², used by heat laws.
    pub friction_power: f64,
    /// Temperature θ of the body in K; for a pair that of the side `on`.
    pub temperature: f64,
    /// Temperature θ_F of the foundation in K, used by heat laws; for a pair that of the side `with`.
    pub foundation_temperature: f64,
}

/// Contact state of a point of Γ_C.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Status {
    /// No pressure and no friction bound.
    Open,
    /// Friction traction inside the cone, no slip.
    Stick,
    /// Pressure, and friction traction at its bound.
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
