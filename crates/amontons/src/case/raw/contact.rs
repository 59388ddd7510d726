//! `[contact]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Datum;

/// Contact of one side with a foundation: (2.8)–(2.10).
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Contact {
    /// Name of the side that is Γ_C.
    pub on: String,
    /// Gap g to the foundation along the outward normal, in m.
    #[serde(default)]
    pub gap: Datum,
    /// Where the integrals over Γ_C are evaluated.
    #[serde(default)]
    pub quadrature: Quadrature,
    /// Law of the contact pressure p_ν (2.8).
    pub normal: Normal,
    /// Law of the friction bound p_τ (2.9).
    #[serde(default)]
    pub friction: Friction,
    /// Law of the heat exchange with the foundation (2.10).
    #[serde(default)]
    pub heat: Heat,
}

/// Where the integrals over Γ_C are evaluated.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum Quadrature {
    /// At the nodes: each contact node obeys the laws on its own.
    #[default]
    Nodal,
    /// At Gauss points, two a segment.
    Gauss,
}

/// Contact pressure by its law.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
pub(in crate::case) enum Normal {
    /// p_ν(r) = stiffness · max(r, 0), r the penetration.
    Compliance {
        /// Stiffness c_ν of the contact in Pa/m.
        #[schemars(range(min = 0.0))]
        stiffness: f64,
    },
}

/// Friction bound by its law.
#[derive(Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
pub(in crate::case) enum Friction {
    /// No friction.
    #[default]
    None,
    /// p_τ = coefficient · p_ν.
    Coulomb {
        /// Friction coefficient μ.
        #[schemars(range(min = 0.0))]
        coefficient: f64,
    },
}

/// Heat exchange by its law.
#[derive(Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
pub(in crate::case) enum Heat {
    /// No heat exchange.
    #[default]
    None,
    /// k_c(r) rises linearly over 0 ≤ r ≤ width and is the conductance above, r the penetration.
    Ramp {
        /// Conductance of closed contact in W/(m² K).
        #[schemars(range(min = 0.0))]
        conductance: f64,
        /// Penetration in m at which the conductance is reached.
        #[schemars(extend("exclusiveMinimum" = 0))]
        width: f64,
        /// Temperature θ_F of the foundation in K.
        foundation_temperature: Datum,
        /// Bound L of the temperature difference in φ_L, in K; without it φ_L(s) = s.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        truncation: Option<f64>,
    },
}
