//! The energy and heat audit: what flowed where since the start, and how far the sums are from closing.

use serde::{Deserialize, Serialize};

/// Energies at a time and flows accumulated since the start, J per unit of thickness in two dimensions.
///
/// Tested with k w_n, (4.1) becomes an identity in which every term is one of these:
///
/// ```text
/// [½ρ‖w‖²] + ½ρ‖wₙ − wₙ₋₁‖² + [½a(u,u)] + ½a(uₙ − uₙ₋₁, uₙ − uₙ₋₁) + k b(wₙ, wₙ)
///     + k Σ ω p w_ν + k Σ ω q·w_τ = k (fₙ, wₙ) + k m(θₙ₋₁, wₙ) + [½a]
/// ```
///
/// where \[½a\] is what the energy changes by at a fixed strain where 𝓔 depends on the temperature: ½a(u, u) is taken
/// at θ_n at the end of each step, ½a(uₙ − uₙ₋₁, uₙ − uₙ₋₁) and b at the temperature that the step sees. Further, with
/// k w_ν = \[r\] + \[g\] + \[h\] and p_ν the pressure at rest, k Σ ω p w_ν is the change of the compliance energy Ψ,
/// the dissipation Σ ω (p − p_ν)\[r\] of a layer with damping, Σ ω p \[h\] of wear, the work Σ ω p \[g\] on a
/// foundation that moves, and what is left, ψ = Σ ω p_ν \[r\] − \[Ψ\]. ψ ≥ 0 if p_ν is nondecreasing; with `softening`
/// and `adhesion` it may be negative, and with an obstacle that is followed \[r\] is a difference in two frames. The
/// identity tests only the sum of these terms.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Ledger {
    /// ½ρ‖w‖² at t.
    pub kinetic: f64,
    /// ½a(u, u) at t.
    pub elastic: f64,
    /// Σ k b(w, w), with what branches, dashpots and damped layers dissipate.
    pub viscous_dissipation: f64,
    /// Σ k Σ ω q·w_τ.
    pub friction_dissipation: f64,
    /// Ψ at t, the energy stored in the compliant layer.
    pub contact_energy: f64,
    /// Σ k (f, w), with the work of the supports that move and of a foundation that moves.
    pub load_work: f64,
    /// Σ k m(θ, w).
    pub thermal_work: f64,
    /// Work of moduli that change with the temperature and of contact stiffnesses that change with time: the energy
    /// that body and layer gain by it at a fixed strain and penetration.
    #[serde(default)]
    pub modulus_work: f64,
    /// What backward Euler dissipates: Σ ½ρ‖Δw‖² + ½a(Δu, Δu) + ψ; negative only if ψ is.
    pub scheme_dissipation: f64,
    /// Σ k Σ ω p ḣ, what is lost with the material that wears off.
    #[serde(default)]
    pub wear_dissipation: f64,
    /// Left minus right side of the identity, accumulated.
    pub closing_error: f64,
    /// Energy at the start plus the absolute work done since: what closing errors are compared with.
    pub turned_over: f64,
    /// ∫ c θ at t.
    pub heat_content: f64,
    /// Heat that left through Γ_C.
    pub heat_contact: f64,
    /// Heat that left through the boundary with prescribed temperature.
    pub heat_prescribed: f64,
    /// Heat of the source and the inflow.
    pub heat_supplied: f64,
    /// Σ k ∫ 𝓡:ε(u), heat of the deformation.
    pub heat_coupling: f64,
    /// Heat that friction made, in the body and in the foundation.
    #[serde(default)]
    pub heat_friction: f64,
    /// Heat that friction made between deformable bodies and that entered them.
    #[serde(default)]
    pub heat_pairs: f64,
    /// Σ C θ_F at t, over the foundations with a heat capacity.
    #[serde(default)]
    pub heat_foundation: f64,
    /// Heat that these lost to the surroundings.
    #[serde(default)]
    pub heat_surroundings: f64,
    /// Change of content minus what came in plus what went out, of the body and of the foundations with a heat
    /// capacity, accumulated.
    pub heat_closing_error: f64,
    /// Heat at the start plus the absolute amounts moved since.
    pub heat_turned_over: f64,
}

impl Ledger {
    /// Closing error of the mechanical identity relative to the energy turned over.
    #[must_use]
    pub fn relative_closing_error(&self) -> f64 {
        relative(self.closing_error, self.turned_over)
    }

    /// Closing error of the heat balance relative to the heat turned over.
    #[must_use]
    pub fn relative_heat_closing_error(&self) -> f64 {
        relative(self.heat_closing_error, self.heat_turned_over)
    }
}

/// Where nothing was turned over an error is infinite.
fn relative(error: f64, scale: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error / scale }
}
