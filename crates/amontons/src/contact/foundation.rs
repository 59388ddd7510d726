//! A foundation that warms up: one temperature for all of it.

use crate::field::Field;

/// A foundation that conducts so well that it has a single temperature θ_F, which heat from the contact and from
/// friction raises:
///
/// ```text
///     C θ̇_F = ∫_{Γ_C} (q·ν + q·w_τ) − H (θ_F − θ_∞)
/// ```
///
/// The first term is the heat that leaves the body plus the friction heat that does not enter it.
#[derive(Clone, Debug)]
pub struct LumpedFoundation {
    /// C > 0 in J/K, per unit of thickness in two dimensions.
    pub capacity: f64,
    /// θ_F at t = 0 in K; `None` to start from [`super::Contact::foundation_temperature`].
    pub temperature: Option<f64>,
    /// H ≥ 0 in W/K, per unit of thickness in two dimensions: exchange with the surroundings.
    pub exchange: f64,
    /// θ_∞ in K, a function of time only.
    pub surroundings: Field,
}
