//! `[material]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A symmetric tensor.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "a number or a symmetric matrix [[…], […]]")]
pub(in crate::case) enum Tensor {
    /// That multiple of the identity.
    Multiple(f64),
    /// The components, row by row.
    Matrix(Vec<Vec<f64>>),
}

/// Material: σ = 𝓔ε(u) + 𝓥ε(u̇) − θ𝓜 (2.1), q = −𝓚∇θ (2.2).
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Material {
    /// Density ρ in kg/m³; 0: quasistatic.
    #[schemars(range(min = 0.0))]
    pub density: f64,
    /// Heat capacity, the factor of θ̇ in (2.4), in J/(m³ K); 0: steady heat.
    #[schemars(range(min = 0.0))]
    pub heat_capacity: f64,
    /// Thermal expansion tensor 𝓜 of (2.1) in Pa/K.
    pub expansion: Tensor,
    /// Tensor 𝓡 of (2.4), heat per strain, in W/m³.
    pub coupling: Tensor,
    /// Heat conductivity tensor 𝓚 of (2.2) in W/(m K).
    pub conductivity: Tensor,
    /// Elasticity 𝓔.
    pub elasticity: Elasticity,
    /// Viscosity 𝓥.
    pub viscosity: Viscosity,
}

/// Elasticity by its law.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
pub(in crate::case) enum Elasticity {
    /// 𝓔τ = Eν/(1−ν²) tr(τ) I + E/(1+ν) τ in plane stress, (5.1).
    Isotropic {
        /// Young's modulus E in Pa.
        #[schemars(extend("exclusiveMinimum" = 0))]
        young: f64,
        /// Poisson's ratio ν.
        ///
        /// Above −1; below 1 in plane stress, below 0.5 in plane strain.
        #[schemars(extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 1))]
        poisson: f64,
        /// How the third direction of a plane body is held.
        #[serde(default)]
        stress_state: StressState,
    },
}

/// How the third direction of a plane body is held.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum StressState {
    /// σ₃₃ = 0: a thin sheet.
    #[default]
    PlaneStress,
    /// ε₃₃ = 0: a long body.
    PlaneStrain,
}

/// Viscosity by its law.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
pub(in crate::case) enum Viscosity {
    /// 𝓥τ = first tr(τ) I + second τ, (5.1).
    Lame {
        /// Factor of tr(τ) I in Pa s.
        first: f64,
        /// Factor of τ in Pa s.
        #[schemars(range(min = 0.0))]
        second: f64,
    },
}
