//! Contact laws that are evaluated for many points at once.

use std::sync::Arc;

use super::{Bound, Contact, ContactPoint, Flux, FrictionLaw, GraphKind, HeatLaw, NormalLaw, Pressure, WearLaw};
use crate::arrays::{Arrays, Inputs, OnArrays};
use crate::field::Law;
use crate::tensor::Point;

/// Names of the arguments of contact laws on arrays, in their order: position in m, penetration in m, its rate in m/s,
/// pressure in Pa, slip speed in m/s, friction power in W/m², temperatures of the body and of the foundation in K.
pub const CONTACT_INPUTS: [&str; 10] = [
    "x",
    "y",
    "z",
    "penetration",
    "rate",
    "pressure",
    "slip_speed",
    "friction_power",
    "temperature",
    "foundation_temperature",
];

/// The arguments at a contact point.
fn inputs(at: &ContactPoint, rate: f64) -> Inputs {
    let [x, y, z] = at.x;
    [
        x,
        y,
        z,
        at.penetration,
        rate,
        at.pressure,
        at.slip_speed,
        at.friction_power,
        at.temperature,
        at.foundation_temperature,
    ]
}

/// A normal law on arrays, a function p(r, ṙ).
#[derive(Debug)]
pub struct ArrayNormal {
    /// p with its slopes, the values of [`Pressure`] in their order.
    pub pressure: Arrays,
    /// ∫₀^r p at ṙ = 0 in J/m².
    pub potential: Arrays,
    /// L_ν in Pa/m; `None` if slopes are not bounded.
    pub lipschitz: Option<f64>,
    /// Largest derivative in the rate, Pa s/m; `None` if it is not bounded.
    pub lipschitz_in_rate: Option<f64>,
    /// Least slope in Pa/m; negative if the law softens.
    pub least_slope: f64,
}

impl From<ArrayNormal> for Law<dyn NormalLaw> {
    fn from(law: ArrayNormal) -> Self {
        let arrays = vec![law.pressure.clone(), law.potential.clone()];
        Law::on_arrays(Arc::new(OnArrays(law)), arrays)
    }
}

impl NormalLaw for OnArrays<ArrayNormal> {
    fn pressure(&self, x: &Point, z: f64, rate: f64, _lambda: f64) -> Pressure {
        let at = ContactPoint { x: *x, penetration: z, ..ContactPoint::default() };
        let [value, slope, by_rate] = self.0.pressure.at(&inputs(&at, rate));
        Pressure { value, slope, by_rate }
    }
    fn potential(&self, x: &Point, r: f64) -> f64 {
        let at = ContactPoint { x: *x, penetration: r, ..ContactPoint::default() };
        let [energy] = self.0.potential.at(&inputs(&at, 0.0));
        energy
    }
    fn lipschitz(&self) -> Option<f64> {
        self.0.lipschitz
    }
    fn lipschitz_in_rate(&self) -> Option<f64> {
        self.0.lipschitz_in_rate
    }
    fn least_slope(&self, _x: &Point, _from: f64, _to: f64) -> f64 {
        self.0.least_slope.min(0.0)
    }
    fn graph(&self) -> GraphKind {
        GraphKind::Function
    }
}

/// A friction law on arrays.
#[derive(Debug)]
pub struct ArrayFriction {
    /// The bound with its slopes, the values of [`Bound`] in their order.
    pub bound: Arrays,
    /// L_τ/L_ν, the largest slope of the bound in the pressure; `None` if it is unbounded, or if the bound does not
    /// vanish with the pressure.
    pub lipschitz: Option<f64>,
    /// Least slope in the slip speed in Pa s/m; negative if the bound decreases with the slip speed.
    pub least_slope: f64,
    /// True if the bound drops when slip starts.
    pub drops_from_rest: bool,
}

impl From<ArrayFriction> for Law<dyn FrictionLaw> {
    fn from(law: ArrayFriction) -> Self {
        let arrays = vec![law.bound.clone()];
        Law::on_arrays(Arc::new(OnArrays(law)), arrays)
    }
}

impl FrictionLaw for OnArrays<ArrayFriction> {
    fn bound(&self, at: &ContactPoint) -> Bound {
        let [value, by_penetration, by_pressure, by_slip_speed, by_temperature] = self.0.bound.at(&inputs(at, 0.0));
        Bound { value, by_penetration, by_pressure, by_slip_speed, by_temperature }
    }
    fn lipschitz(&self, l_nu: Option<f64>) -> Option<f64> {
        Some(self.0.lipschitz? * l_nu?)
    }
    fn least_slope(&self, _at: &ContactPoint, _from: f64, _to: f64) -> f64 {
        self.0.least_slope.min(0.0)
    }
    fn drops_from_rest(&self) -> bool {
        self.0.drops_from_rest
    }
}

/// A law of heat exchange on arrays.
#[derive(Debug)]
pub struct ArrayHeat {
    /// The flux with its slopes, the values of [`Flux`] in their order.
    pub flux: Arrays,
    /// M_kc of (H7) in W/(m² K); infinite if there is none.
    pub conductance_bound: f64,
    /// L_kc of (H7) in W/(m³ K); `None` if there is none.
    pub conductance_lipschitz: Option<f64>,
}

impl From<ArrayHeat> for Law<dyn HeatLaw> {
    fn from(law: ArrayHeat) -> Self {
        let arrays = vec![law.flux.clone()];
        Law::on_arrays(Arc::new(OnArrays(law)), arrays)
    }
}

impl HeatLaw for OnArrays<ArrayHeat> {
    fn flux(&self, at: &ContactPoint) -> Flux {
        let [value, by_temperature, by_foundation, by_penetration, by_pressure, by_slip_speed, by_friction_power] =
            self.0.flux.at(&inputs(at, 0.0));
        Flux { value, by_temperature, by_foundation, by_penetration, by_pressure, by_slip_speed, by_friction_power }
    }
    fn conductance_bound(&self) -> f64 {
        self.0.conductance_bound
    }
    fn conductance_lipschitz(&self) -> Option<f64> {
        self.0.conductance_lipschitz
    }
}

/// A wear law on arrays.
#[derive(Debug)]
pub struct ArrayWear {
    /// κ in 1/Pa and ∂κ/∂θ in 1/(Pa K).
    pub coefficient: Arrays,
}

impl From<ArrayWear> for Law<dyn WearLaw> {
    fn from(law: ArrayWear) -> Self {
        let arrays = vec![law.coefficient.clone()];
        Law::on_arrays(Arc::new(OnArrays(law)), arrays)
    }
}

impl WearLaw for OnArrays<ArrayWear> {
    fn coefficient(&self, at: &ContactPoint) -> f64 {
        self.0.coefficient.at::<2>(&inputs(at, 0.0))[0]
    }
    fn by_temperature(&self, at: &ContactPoint) -> f64 {
        self.0.coefficient.at::<2>(&inputs(at, 0.0))[1]
    }
}

/// All array functions in the laws of these contacts.
pub(crate) fn arrays(contacts: &[Contact]) -> Vec<&Arrays> {
    let mut all = Vec::new();
    for contact in contacts {
        all.extend(contact.normal.arrays());
        all.extend(contact.friction.arrays());
        all.extend(contact.heat.arrays());
        all.extend(contact.wear.iter().flat_map(Law::arrays));
    }
    all
}
