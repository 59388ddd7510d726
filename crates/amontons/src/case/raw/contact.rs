//! `[contact]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Datum, Obstacle};

/// Contact of one side: `[contact]`; of several: `[[contact]]`.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "a table, or an array of tables")]
pub(in crate::case) enum Contacts {
    /// Of one side.
    One(Box<Contact>),
    /// Of several sides.
    Several(Vec<Contact>),
}

impl Contacts {
    /// The contacts with their paths.
    pub fn all(self) -> Vec<(String, Contact)> {
        match self {
            Contacts::One(contact) => vec![("contact".to_owned(), *contact)],
            Contacts::Several(all) => all.into_iter().enumerate().map(|(i, contact)| (format!("contact[{i}]"), contact)).collect(),
        }
    }

    /// The contacts with their paths, borrowed.
    pub fn each(&self) -> Vec<(String, &Contact)> {
        match self {
            Contacts::One(contact) => vec![("contact".to_owned(), &**contact)],
            Contacts::Several(all) => all.iter().enumerate().map(|(i, contact)| (format!("contact[{i}]"), contact)).collect(),
        }
    }

    /// Their sides.
    pub fn sides(&self) -> Vec<&str> {
        self.each().into_iter().map(|(_, contact)| contact.on.as_str()).collect()
    }
}

/// Contact of one side with a foundation: (2.8)–(2.10).
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Contact {
    /// Name of the side that is Γ_C.
    pub on: String,
    /// Gap g to the foundation along the outward normal, in m.
    ///
    /// With an obstacle what is added to the distance from it.
    #[serde(default)]
    pub gap: Datum,
    /// Shape of a rigid foundation that is not told by the gap alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub obstacle: Option<Obstacle>,
    /// Velocity v_F of the foundation in m/s, one entry a component, of which the tangential part counts; empty for a foundation at rest. Slip is w_τ − v_F.
    #[serde(default)]
    pub foundation_velocity: Vec<Datum>,
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
    /// Share η of the power of friction that enters the body as heat.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub frictional_heat: f64,
    /// Heat capacity of the foundation; without it its temperature is prescribed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub foundation: Option<Foundation>,
    /// Wear of the contact, by which the gap grows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wear: Option<Wear>,
}

/// A foundation with one temperature, which the heat from the contact and from friction raises.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Foundation {
    /// Heat capacity of the foundation in J/K, per unit of thickness in two dimensions.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub heat_capacity: f64,
    /// Temperature at t = 0 in K; without it `heat.foundation_temperature`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature: Option<f64>,
    /// Heat exchange with the surroundings in W/K, per unit of thickness in two dimensions.
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub exchange: f64,
    /// Temperature of the surroundings in K, a number or an expression in t; without it the temperature at t = 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surroundings: Option<Datum>,
}

/// Wear by its law.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
pub(in crate::case) enum Wear {
    /// The depth grows at the rate coefficient · p · ‖w_τ‖.
    Archard {
        /// Wear coefficient in 1/Pa: Archard's number over the hardness.
        #[schemars(range(min = 0.0))]
        coefficient: f64,
    },
    /// Archard's law with a coefficient by the temperature of the body, linear between the points of a table and constant outside.
    ArchardTemperature {
        /// Temperatures in K, each larger than the one before.
        temperature: Vec<f64>,
        /// Wear coefficients in 1/Pa.
        #[schemars(inner(range(min = 0.0)))]
        coefficient: Vec<f64>,
    },
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

/// Contact pressure by its law, r the penetration.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
pub(in crate::case) enum Normal {
    /// p_ν(r) = stiffness · max(r, 0), r the penetration.
    Compliance {
        /// Stiffness c_ν of the contact in Pa/m.
        #[schemars(range(min = 0.0))]
        stiffness: f64,
    },
    /// p_ν(r) = stiffness · max(r, 0)^exponent.
    Power {
        /// Factor c of the power law in Pa/m^exponent.
        #[schemars(range(min = 0.0))]
        stiffness: f64,
        /// Exponent m of the penetration; 1.5 for a sphere.
        #[schemars(range(min = 1.0))]
        exponent: f64,
    },
    /// Pressures at penetrations, linear between them; beyond the last the last piece goes on.
    Table {
        /// Penetrations in m, each larger than the one before, the first 0.
        penetration: Vec<f64>,
        /// Pressures in Pa, none smaller than the one before, the first 0.
        pressure: Vec<f64>,
    },
    /// Compliance down to a depth at which the foundation is rigid.
    Stop {
        /// Stiffness of the layer in Pa/m.
        #[schemars(range(min = 0.0))]
        stiffness: f64,
        /// Penetration in m at which the stop is.
        #[schemars(range(min = 0.0))]
        depth: f64,
    },
    /// A rigid foundation: no penetration, no tension.
    Signorini,
    /// A rigid foundation that the body cannot leave.
    Bilateral,
    /// A spring and a dashpot that do not pull: max(stiffness · r + damping · ṙ, 0) where r > 0.
    Damped {
        /// Stiffness of the spring in Pa/m.
        #[schemars(range(min = 0.0))]
        stiffness: f64,
        /// Damping of the dashpot in Pa s/m.
        #[schemars(range(min = 0.0))]
        damping: f64,
    },
    /// Hunt and Crossley: stiffness · max(r, 0)^exponent · max(1 + damping · ṙ, 0).
    HuntCrossley {
        /// Factor c of the power law in Pa/m^exponent.
        #[schemars(range(min = 0.0))]
        stiffness: f64,
        /// Exponent m of the penetration.
        #[serde(default = "one")]
        #[schemars(range(min = 1.0))]
        exponent: f64,
        /// Damping a in s/m.
        #[schemars(range(min = 0.0))]
        damping: f64,
    },
    /// A layer that gives way: linear up to the peak, then falling to the residual pressure.
    Softening {
        /// Stiffness up to the peak in Pa/m.
        #[schemars(extend("exclusiveMinimum" = 0))]
        stiffness: f64,
        /// Largest pressure in Pa.
        #[schemars(extend("exclusiveMinimum" = 0))]
        peak: f64,
        /// Rate in Pa/m at which the pressure falls after the peak.
        #[schemars(extend("exclusiveMinimum" = 0))]
        softening: f64,
        /// Pressure in Pa that is left at last, at most the peak.
        #[serde(default)]
        #[schemars(range(min = 0.0))]
        residual: f64,
    },
    /// A layer that pulls up to a bound: p = stiffness · r, released where −p would exceed the strength.
    Adhesion {
        /// Stiffness of the layer in Pa/m.
        #[schemars(extend("exclusiveMinimum" = 0))]
        stiffness: f64,
        /// Largest tension in Pa.
        #[schemars(range(min = 0.0))]
        strength: f64,
        /// Further opening in m over which the tension falls to zero; 0: at once.
        #[serde(default)]
        #[schemars(range(min = 0.0))]
        release: f64,
    },
}

/// Friction bound by its law, p the pressure and v the slip speed.
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
        /// Shear strength in Pa that the bound does not exceed.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 0.0))]
        cap: Option<f64>,
    },
    /// A bound that is given, on all of Γ_C and whatever the pressure.
    Tresca {
        /// Friction bound in Pa.
        #[schemars(range(min = 0.0))]
        bound: f64,
    },
    /// μ(v) = kinetic + (static − kinetic) exp(−v/decay_speed); without a decay speed the static coefficient holds where a point sticks only.
    StaticKinetic {
        /// Coefficient of a point at rest, at least the kinetic one.
        #[serde(rename = "static")]
        #[schemars(range(min = 0.0))]
        at_rest: f64,
        /// Coefficient of a point that slips.
        #[schemars(range(min = 0.0))]
        kinetic: f64,
        /// Slip speed in m/s over which the coefficient falls.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        decay_speed: Option<f64>,
        /// Shear strength in Pa that the bound does not exceed.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 0.0))]
        cap: Option<f64>,
    },
    /// A coefficient by the slip speed, linear between the points of a table and constant outside.
    SlipRate {
        /// Slip speeds in m/s, each larger than the one before.
        speed: Vec<f64>,
        /// Friction coefficients.
        #[schemars(inner(range(min = 0.0)))]
        coefficient: Vec<f64>,
        /// Shear strength in Pa that the bound does not exceed.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 0.0))]
        cap: Option<f64>,
    },
    /// A coefficient by the temperature of the body, linear between the points of a table and constant outside.
    Temperature {
        /// Temperatures in K, each larger than the one before.
        temperature: Vec<f64>,
        /// Friction coefficients.
        #[schemars(inner(range(min = 0.0)))]
        coefficient: Vec<f64>,
        /// Shear strength in Pa that the bound does not exceed.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 0.0))]
        cap: Option<f64>,
    },
    /// A coefficient by the pressure, linear between the points of a table and constant outside.
    Pressure {
        /// Pressures in Pa, each larger than the one before.
        pressure: Vec<f64>,
        /// Friction coefficients.
        #[schemars(inner(range(min = 0.0)))]
        coefficient: Vec<f64>,
        /// Shear strength in Pa that the bound does not exceed.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 0.0))]
        cap: Option<f64>,
    },
    /// A coefficient along a direction and one across it: an elliptic cone, with slip along its normal.
    Orthotropic {
        /// Coefficients along and across the direction, both positive.
        #[schemars(inner(range(min = 0.0)))]
        coefficients: [f64; 2],
        /// The direction of the first coefficient, one entry a component, of which the tangential part counts.
        direction: Vec<f64>,
    },
}

/// One law of heat exchange, h the conductance, r the penetration and p the pressure; in a sum it stands without a foundation temperature.
macro_rules! heat_laws {
    ($($(#[$about:meta])* $variant:ident { $($(#[$doc:meta])* $field:ident: $type:ty,)* },)*) => {
        /// Heat exchange by its law.
        #[derive(Debug, Default, Deserialize, Serialize, JsonSchema)]
        #[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
        pub(in crate::case) enum Heat {
            /// No heat exchange.
            #[default]
            None,
            $($(#[$about])* $variant {
                $($(#[$doc])* $field: $type,)*
                /// Temperature θ_F of the foundation in K.
                foundation_temperature: Datum,
            },)*
            /// Several laws side by side, their fluxes added.
            Sum {
                /// The laws.
                laws: Vec<HeatTerm>,
                /// Temperature θ_F of the foundation in K.
                foundation_temperature: Datum,
            },
        }

        /// A law in a sum.
        #[derive(Debug, Deserialize, Serialize, JsonSchema)]
        #[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
        pub(in crate::case) enum HeatTerm {
            $($(#[$about])* $variant { $($(#[$doc])* $field: $type,)* },)*
        }

        impl Heat {
            /// The laws and the temperature of the foundation.
            pub fn terms(self) -> (Vec<HeatTerm>, Option<Datum>) {
                match self {
                    Heat::None => (Vec::new(), None),
                    $(Heat::$variant { $($field,)* foundation_temperature } => {
                        (vec![HeatTerm::$variant { $($field,)* }], Some(foundation_temperature))
                    })*
                    Heat::Sum { laws, foundation_temperature } => (laws, Some(foundation_temperature)),
                }
            }
        }
    };
}

heat_laws! {
    /// k_c(r) rises linearly over 0 ≤ r ≤ width and is the conductance above, r the penetration.
    Ramp {
        /// Conductance of closed contact in W/(m² K).
        #[schemars(range(min = 0.0))]
        conductance: f64,
        /// Penetration in m at which the conductance is reached.
        #[schemars(extend("exclusiveMinimum" = 0))]
        width: f64,
        /// Bound L of the temperature difference in φ_L, in K; without it φ_L(s) = s.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        truncation: Option<f64>,
    },
    /// A conductance coefficient · max(r, 0)^exponent, r the penetration.
    Power {
        /// Factor of the power law in W/(m² K m^exponent).
        #[schemars(range(min = 0.0))]
        coefficient: f64,
        /// Exponent of the penetration.
        #[schemars(range(min = 1.0))]
        exponent: f64,
        /// Bound L of the temperature difference in φ_L, in K; without it φ_L(s) = s.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        truncation: Option<f64>,
    },
    /// A conductance coefficient · max(p, 0)^exponent, p the pressure.
    Pressure {
        /// Factor of the power law in W/(m² K Pa^exponent).
        #[schemars(range(min = 0.0))]
        coefficient: f64,
        /// Exponent of the pressure.
        #[serde(default = "one")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        exponent: f64,
        /// Bound L of the temperature difference in φ_L, in K; without it φ_L(s) = s.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        truncation: Option<f64>,
    },
    /// A conductance conductivity/(g + roughness), g the width of the gap where it is open and zero where it is closed.
    Gap {
        /// Conductivity of the gas in W/(m K).
        #[schemars(range(min = 0.0))]
        conductivity: f64,
        /// Width in m that a closed gap still has.
        #[schemars(extend("exclusiveMinimum" = 0))]
        roughness: f64,
        /// Bound L of the temperature difference in φ_L, in K; without it φ_L(s) = s.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        truncation: Option<f64>,
    },
    /// A flux constant · emissivity · (θ⁴ − θ_F⁴) with temperatures above absolute zero.
    Radiation {
        /// Emissivity of both surfaces together.
        #[schemars(range(min = 0.0))]
        emissivity: f64,
        /// Absolute zero on the scale of the temperatures.
        #[serde(default)]
        absolute_zero: f64,
        /// Constant of Stefan and Boltzmann in W/(m² K⁴).
        #[serde(default = "stefan_boltzmann")]
        #[schemars(range(min = 0.0))]
        constant: f64,
    },
}

fn one() -> f64 {
    1.0
}

fn stefan_boltzmann() -> f64 {
    crate::contact::STEFAN_BOLTZMANN
}
