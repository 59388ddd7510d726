//! `[contact]`.

use schemars::JsonSchema;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};

use super::{Datum, Fluid, Foundation, Geometry, Obstacle, Preload};

/// Contact of one side: `[contact]`; of several, or of one with several obstacles: `[[contact]]`.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "a table, or an array of tables")]
pub(in crate::case) enum Contacts {
    /// Of one side.
    One(#[serde(deserialize_with = "from_table")] Box<Contact>),
    /// Of several sides.
    Several(Vec<Contact>),
}

/// Reads a contact from a table. An array without entries is refused, so that it means no contact.
fn from_table<'de, D: Deserializer<'de>>(raw: D) -> Result<Box<Contact>, D::Error> {
    let table = toml::Table::deserialize(raw)?;
    Contact::deserialize(table).map(Box::new).map_err(Error::custom)
}

impl Contacts {
    /// The contacts with their paths in the case file.
    pub fn all(self) -> Vec<(String, Contact)> {
        match self {
            Contacts::One(contact) => vec![("contact".to_owned(), *contact)],
            Contacts::Several(all) => {
                all.into_iter().enumerate().map(|(i, contact)| (format!("contact[{i}]"), contact)).collect()
            }
        }
    }

    /// The contacts with their paths in the case file, borrowed.
    pub fn each(&self) -> Vec<(String, &Contact)> {
        match self {
            Contacts::One(contact) => vec![("contact".to_owned(), &**contact)],
            Contacts::Several(all) => {
                all.iter().enumerate().map(|(i, contact)| (format!("contact[{i}]"), contact)).collect()
            }
        }
    }

    /// The names of their sides.
    pub fn sides(&self) -> Vec<&str> {
        let all = self.each().into_iter();
        let named = all.filter(|(_, contact)| contact.automatic.is_none());
        named.flat_map(|(_, contact)| std::iter::once(contact.on.as_str()).chain(contact.with.as_deref())).collect()
    }
}

/// Which facets of bodies are pairs.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Automatic {
    /// Largest distance between facets that face each other at rest, in m; less than the thickness of the bodies.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub distance: f64,
}

/// Contact of one side with a foundation, (2.8)–(2.10), or with a side of another body.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Contact {
    /// Name of the side that is Γ_C; omit it with `automatic`.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub on: String,
    /// Name of the contact in results; default: that of the side `on`, with a number from its second entry on.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Name of the side of a deformable body that `on` faces: a pair. Omit it if the foundation is rigid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub with: Option<String>,
    /// In the place of `on` and `with`: all bodies that are near each other at rest are pairs with these laws.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub automatic: Option<Automatic>,
    /// The side of a pair that bears the contact points, `on` or `with`; default: that of the softer body, else the one
    /// that is covered more, the finer or the smaller one. The other keys do not change their meaning with it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nonmortar: Option<String>,
    /// Configuration in which the facing points of a pair are found; default: `reference`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub geometry: Option<Geometry>,
    /// Whether sides of a pair that overlap at rest are treated as touching there, without stress.
    #[serde(default)]
    pub close: bool,
    /// Gap g to the foundation along the outward normal, in m.
    ///
    /// Default: 0, in a pair that of the geometry. With an obstacle: an offset added to the distance. In a pair it
    /// replaces the gap of the geometry; negative values are an interference.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gap: Option<Datum>,
    /// Shape of the rigid foundation. Omit it if the gap describes the foundation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub obstacle: Option<Obstacle>,
    /// Velocity v_F of the foundation, or of the side `with` besides that of its body, in m/s, one entry per component;
    /// empty for a foundation at rest.
    ///
    /// Only its tangential part is used. The slip velocity is w_τ − v_F. In the plane three entries are a velocity with
    /// a part out of the plane, of a body of revolution with one about its axis: ω r is `"100*x"` at 100 rad/s.
    #[serde(default)]
    pub foundation_velocity: Vec<Datum>,
    /// Where the integrals over Γ_C are evaluated.
    #[serde(default)]
    pub quadrature: Quadrature,
    /// Law of the contact pressure p_ν (2.8); omit it in a case of heat alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal: Option<Normal>,
    /// Law of the friction bound p_τ (2.9).
    #[serde(default)]
    pub friction: Friction,
    /// Law of the heat exchange with the foundation (2.10).
    #[serde(default)]
    pub heat: Heat,
    /// Fraction η of the friction power that enters the body as heat, from 0 to 1.
    ///
    /// In a pair the fraction that enters the side `on`, or `"effusivity"` for √(Kc) of this side over the sum of both;
    /// the rest enters the other side.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "maximum" = 1))]
    pub frictional_heat: Datum,
    /// Heat balance of the foundation. Without it `foundation_temperature` prescribes the temperature.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub foundation: Option<Foundation>,
    /// Wear law; wear increases the gap.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wear: Option<Wear>,
    /// Tension to which the section of a bolt is tightened and then left to itself; the contact is a tie.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub preload: Option<Preload>,
    /// Fluid that enters where the contact is open, and presses its sides apart there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fluid: Option<Fluid>,
    /// Names of the phases in which the contact acts; without the key it acts in all of them.
    ///
    /// In the others nothing presses, rubs or exchanges heat there. Two contacts that act in different phases may be on
    /// one side.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub phases: Option<Vec<String>>,
}

/// Wear law.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
pub(in crate::case) enum Wear {
    /// Archard's law: the wear depth grows at the rate coefficient · p · ‖slip velocity‖.
    Archard {
        /// Wear coefficient in 1/Pa: Archard's dimensionless number divided by the hardness.
        #[schemars(extend("minimum" = 0))]
        coefficient: Datum,
        /// Fraction of the depth that comes off the side `on`, from 0 to 1, default 1; the rest comes off what it
        /// faces.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 0.0, max = 1.0))]
        fraction: Option<f64>,
    },
    /// Archard's law with a coefficient that depends on the temperature of the body, of a pair that of the side `on`,
    /// linear between the points of a table and constant outside.
    ArchardTemperature {
        /// Temperatures in K in increasing order.
        temperature: Vec<f64>,
        /// Wear coefficients in 1/Pa.
        #[schemars(inner(range(min = 0.0)))]
        coefficient: Vec<f64>,
        /// Factor of the values.
        #[serde(default = "one")]
        #[schemars(extend("minimum" = 0))]
        factor: Datum,
        /// Fraction of the depth that comes off the side `on`, from 0 to 1, default 1; the rest comes off what it
        /// faces.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 0.0, max = 1.0))]
        fraction: Option<f64>,
    },
}

impl Wear {
    /// Fraction of the depth that comes off the side `on`.
    pub fn fraction(&self) -> f64 {
        match self {
            Wear::Archard { fraction, .. } | Wear::ArchardTemperature { fraction, .. } => fraction.unwrap_or(1.0),
        }
    }
}

/// Where the integrals over Γ_C are evaluated.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum Quadrature {
    /// At the nodes: the contact laws hold at each contact node separately.
    #[default]
    Nodal,
    /// At Gauss points, degree + 1 per direction: the laws hold at each of them.
    Gauss,
}

/// Law of the contact pressure p_ν as a function of the penetration r.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
pub(in crate::case) enum Normal {
    /// Normal compliance: p_ν(r) = stiffness · max(r, 0), r the penetration.
    Compliance {
        /// Stiffness c_ν of the contact in Pa/m.
        #[schemars(extend("minimum" = 0))]
        stiffness: Datum,
    },
    /// Power law: p_ν(r) = stiffness · max(r, 0)^exponent.
    Power {
        /// Factor c of the power law in Pa/m^exponent.
        #[schemars(extend("minimum" = 0))]
        stiffness: Datum,
        /// Exponent m of the penetration; 1.5 for a sphere.
        #[schemars(extend("minimum" = 1))]
        exponent: Datum,
    },
    /// Table of pressures over penetrations, linear between its points and extrapolated beyond the last one.
    Table {
        /// Penetrations in m in increasing order, the first 0, or negative where the pressure begins in the gap.
        penetration: Vec<f64>,
        /// Pressures in Pa, not decreasing, the first 0.
        pressure: Vec<f64>,
        /// Factor of the values.
        #[serde(default = "one")]
        #[schemars(extend("minimum" = 0))]
        factor: Datum,
    },
    /// A formula of your own over the penetration.
    Expression {
        /// Pressure (Pa) as a formula in the penetration `r` (m), such as "1e9*r + 2e13*r^2"; 0 where it begins, and
        /// not decreasing beyond.
        pressure: String,
        /// Penetration in m from which on the formula counts; default: 0. Below 0 the pressure begins in the gap.
        #[serde(default)]
        #[schemars(range(max = 0.0))]
        begin: f64,
        /// Factor of the formula.
        #[serde(default = "one")]
        #[schemars(extend("minimum" = 0))]
        factor: Datum,
    },
    /// Compliant layer on a rigid stop: compliance up to the penetration `depth`, no further penetration.
    Stop {
        /// Stiffness of the layer in Pa/m.
        #[schemars(extend("minimum" = 0))]
        stiffness: Datum,
        /// Penetration in m at which the stop is reached.
        #[schemars(extend("minimum" = 0))]
        depth: Datum,
    },
    /// Signorini's conditions: a rigid foundation without penetration and without tension.
    Signorini,
    /// Bilateral contact: a rigid foundation from which the body cannot separate.
    Bilateral,
    /// Spring and dashpot without tension: max(stiffness · r + damping · ṙ, 0) for r > 0.
    Damped {
        /// Stiffness of the spring in Pa/m.
        #[schemars(extend("minimum" = 0))]
        stiffness: Datum,
        /// Damping of the dashpot in Pa s/m.
        #[schemars(extend("minimum" = 0))]
        damping: Datum,
    },
    /// Hunt and Crossley's law: stiffness · max(r, 0)^exponent · max(1 + damping · ṙ, 0).
    HuntCrossley {
        /// Factor c of the power law in Pa/m^exponent.
        #[schemars(extend("minimum" = 0))]
        stiffness: Datum,
        /// Exponent m of the penetration.
        #[serde(default = "one")]
        #[schemars(extend("minimum" = 1))]
        exponent: Datum,
        /// Damping a in s/m.
        #[schemars(extend("minimum" = 0))]
        damping: Datum,
    },
    /// Softening layer: linear up to the peak pressure, then decreasing to the residual pressure.
    Softening {
        /// Stiffness up to the peak in Pa/m.
        #[schemars(extend("exclusiveMinimum" = 0))]
        stiffness: Datum,
        /// Peak pressure in Pa.
        #[schemars(extend("exclusiveMinimum" = 0))]
        peak: Datum,
        /// Slope in Pa/m at which the pressure decreases after the peak.
        #[schemars(extend("exclusiveMinimum" = 0))]
        softening: Datum,
        /// Residual pressure in Pa, at most the peak.
        #[serde(default)]
        #[schemars(extend("minimum" = 0))]
        residual: Datum,
    },
    /// Adhesive layer: p = stiffness · r, also in tension, until −p reaches the strength.
    Adhesion {
        /// Stiffness of the layer in Pa/m.
        #[schemars(extend("exclusiveMinimum" = 0))]
        stiffness: Datum,
        /// Tensile strength in Pa.
        #[schemars(extend("minimum" = 0))]
        strength: Datum,
        /// Further opening in m over which the tension decreases to zero; 0: at once.
        #[serde(default)]
        #[schemars(extend("minimum" = 0))]
        release: Datum,
    },
}

/// Law of the friction bound p_τ as a function of the pressure p and the slip speed v.
#[derive(Clone, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
pub(in crate::case) enum Friction {
    /// No friction.
    #[default]
    None,
    /// Coulomb's law: p_τ = coefficient · p_ν.
    Coulomb {
        /// Friction coefficient μ.
        #[schemars(extend("minimum" = 0))]
        coefficient: Datum,
        /// Shear strength in Pa: upper limit of the friction bound.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minimum" = 0))]
        cap: Option<Datum>,
    },
    /// No slip, whatever the pressure; with `bilateral` contact the sides are tied.
    Stick,
    /// Tresca friction: a constant bound on all of Γ_C, whatever the pressure.
    Tresca {
        /// Friction bound in Pa.
        #[schemars(extend("minimum" = 0))]
        bound: Datum,
    },
    /// Static and kinetic friction: μ(v) = kinetic + (static − kinetic) exp(−v/decay_speed).
    ///
    /// Without a decay speed μ is static where a point sticks and kinetic where it slips.
    StaticKinetic {
        /// Static friction coefficient, not less than the kinetic one.
        #[serde(rename = "static")]
        #[schemars(extend("minimum" = 0))]
        at_rest: Datum,
        /// Kinetic friction coefficient.
        #[schemars(extend("minimum" = 0))]
        kinetic: Datum,
        /// Slip speed in m/s over which the coefficient decreases.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        decay_speed: Option<Datum>,
        /// Shear strength in Pa: upper limit of the friction bound.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minimum" = 0))]
        cap: Option<Datum>,
    },
    /// Friction coefficient that depends on the slip speed, linear between the points of a table and constant outside.
    SlipRate {
        /// Slip speeds in m/s in increasing order.
        speed: Vec<f64>,
        /// Friction coefficients.
        #[schemars(inner(range(min = 0.0)))]
        coefficient: Vec<f64>,
        /// Factor of the values.
        #[serde(default = "one")]
        #[schemars(extend("minimum" = 0))]
        factor: Datum,
        /// Shear strength in Pa: upper limit of the friction bound.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minimum" = 0))]
        cap: Option<Datum>,
    },
    /// Friction coefficient that depends on the temperature of the body, of a pair that of the side `on`, linear
    /// between the points of a table and constant outside.
    Temperature {
        /// Temperatures in K in increasing order.
        temperature: Vec<f64>,
        /// Friction coefficients.
        #[schemars(inner(range(min = 0.0)))]
        coefficient: Vec<f64>,
        /// Factor of the values.
        #[serde(default = "one")]
        #[schemars(extend("minimum" = 0))]
        factor: Datum,
        /// Shear strength in Pa: upper limit of the friction bound.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minimum" = 0))]
        cap: Option<Datum>,
    },
    /// Friction coefficient that depends on the pressure, linear between the points of a table and constant outside.
    Pressure {
        /// Pressures in Pa in increasing order.
        pressure: Vec<f64>,
        /// Friction coefficients.
        #[schemars(inner(range(min = 0.0)))]
        coefficient: Vec<f64>,
        /// Factor of the values.
        #[serde(default = "one")]
        #[schemars(extend("minimum" = 0))]
        factor: Datum,
        /// Shear strength in Pa: upper limit of the friction bound.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minimum" = 0))]
        cap: Option<Datum>,
    },
    /// A formula of your own over pressure, slip speed and temperature.
    Expression {
        /// Friction coefficient as a formula in the pressure `p` (Pa), the slip speed `v` (m/s) and the temperature
        /// `theta` of the body, such as "0.2 + 0.1*exp(-v/0.3)". Where it is negative, it counts as 0.
        coefficient: String,
        /// Factor of the formula.
        #[serde(default = "one")]
        #[schemars(extend("minimum" = 0))]
        factor: Datum,
        /// Shear strength in Pa: upper limit of the friction bound.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minimum" = 0))]
        cap: Option<Datum>,
    },
    /// Orthotropic friction: an elliptic friction cone with one coefficient along a direction and one across it.
    ///
    /// The slip velocity is normal to the cone.
    Orthotropic {
        /// Coefficients along and across the direction, both positive.
        coefficients: [Datum; 2],
        /// Direction of the first coefficient, one entry per component; only its tangential part is used.
        direction: Vec<Datum>,
    },
}

/// One law of heat exchange, h the conductance, r the penetration and p the pressure; in a sum it stands without a
/// foundation temperature.
macro_rules! heat_laws {
    ($($(#[$about:meta])* $variant:ident { $($(#[$doc:meta])* $field:ident: $type:ty,)* },)*) => {
        /// Law of the heat exchange with the foundation.
        #[derive(Clone, Debug, Default, Deserialize, Serialize, JsonSchema)]
        #[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
        pub(in crate::case) enum Heat {
            /// No heat exchange.
            #[default]
            None,
            $($(#[$about])* $variant {
                $($(#[$doc])* $field: $type,)*
                /// Temperature θ_F of the foundation in K; not in a pair.
                #[serde(default, skip_serializing_if = "Option::is_none")]
                foundation_temperature: Option<Datum>,
            },)*
            /// Sum of several laws: their heat fluxes are added.
            Sum {
                /// The laws.
                laws: Vec<HeatTerm>,
                /// Temperature θ_F of the foundation in K; not in a pair.
                #[serde(default, skip_serializing_if = "Option::is_none")]
                foundation_temperature: Option<Datum>,
            },
        }

        /// A law in a sum.
        #[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
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
                        (vec![HeatTerm::$variant { $($field,)* }], foundation_temperature)
                    })*
                    Heat::Sum { laws, foundation_temperature } => (laws, foundation_temperature),
                }
            }

            /// True if a foundation temperature is given.
            pub fn has_foundation_temperature(&self) -> bool {
                match self {
                    Heat::None => false,
                    $(Heat::$variant { foundation_temperature, .. })|* | Heat::Sum { foundation_temperature, .. } => {
                        foundation_temperature.is_some()
                    }
                }
            }

            /// True if the foundation temperature is missing.
            pub fn lacks_foundation_temperature(&self) -> bool {
                !matches!(self, Heat::None) && !self.has_foundation_temperature()
            }
        }
    };
}

heat_laws! {
    /// The same conductance at every contact point, open or closed.
    Constant {
        /// Conductance in W/(m² K).
        #[schemars(extend("minimum" = 0))]
        conductance: Datum,
        /// Truncation L of the temperature difference in φ_L, in K; without it φ_L(s) = s.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        truncation: Option<Datum>,
    },
    /// Conductance that rises linearly over 0 ≤ r ≤ width and is constant above, r the penetration.
    Ramp {
        /// Conductance of closed contact in W/(m² K).
        #[schemars(extend("minimum" = 0))]
        conductance: Datum,
        /// Penetration in m at which the conductance is reached.
        #[schemars(extend("exclusiveMinimum" = 0))]
        width: Datum,
        /// Truncation L of the temperature difference in φ_L, in K; without it φ_L(s) = s.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        truncation: Option<Datum>,
    },
    /// Conductance coefficient · max(r, 0)^exponent, r the penetration.
    Power {
        /// Factor of the power law in W/(m² K m^exponent).
        #[schemars(extend("minimum" = 0))]
        coefficient: Datum,
        /// Exponent of the penetration.
        #[schemars(extend("minimum" = 1))]
        exponent: Datum,
        /// Truncation L of the temperature difference in φ_L, in K; without it φ_L(s) = s.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        truncation: Option<Datum>,
    },
    /// Conductance coefficient · max(p, 0)^exponent, p the pressure.
    Pressure {
        /// Factor of the power law in W/(m² K Pa^exponent).
        #[schemars(extend("minimum" = 0))]
        coefficient: Datum,
        /// Exponent of the pressure.
        #[serde(default = "one")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        exponent: Datum,
        /// Truncation L of the temperature difference in φ_L, in K; without it φ_L(s) = s.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        truncation: Option<Datum>,
    },
    /// Gas conduction across the gap: conductance conductivity/(g + roughness), g the width of an open gap and zero in
    /// contact.
    Gap {
        /// Conductivity of the gas in W/(m K).
        #[schemars(extend("minimum" = 0))]
        conductivity: Datum,
        /// Effective width in m of a closed gap.
        #[schemars(extend("exclusiveMinimum" = 0))]
        roughness: Datum,
        /// Truncation L of the temperature difference in φ_L, in K; without it φ_L(s) = s.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        truncation: Option<Datum>,
    },
    /// A formula of your own over pressure and penetration.
    Expression {
        /// Conductance (W/(m² K)) as a formula in the pressure `p` (Pa) and the penetration `r` (m), which is negative
        /// where the gap is open, such as "50 + 2*p^0.95". Where the formula is negative, it counts as 0.
        conductance: String,
        /// Factor of the formula.
        #[serde(default = "one")]
        #[schemars(extend("minimum" = 0))]
        factor: Datum,
        /// Truncation L of the temperature difference in φ_L, in K; without it φ_L(s) = s.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        truncation: Option<Datum>,
    },
    /// Radiation: heat flux constant · emissivity · (θ⁴ − θ_F⁴), temperatures measured from absolute zero.
    Radiation {
        /// Effective emissivity of the two surfaces.
        #[schemars(extend("minimum" = 0))]
        emissivity: Datum,
        /// Absolute zero in K on the temperature scale of the case: 0 for kelvin, −273.15 for degrees Celsius.
        #[serde(default)]
        absolute_zero: f64,
        /// Constant of Stefan and Boltzmann in W/(m² K⁴).
        #[serde(default = "stefan_boltzmann")]
        #[schemars(extend("minimum" = 0))]
        constant: f64,
    },
}

fn one() -> Datum {
    Datum::Number(1.0)
}

fn stefan_boltzmann() -> f64 {
    crate::contact::STEFAN_BOLTZMANN
}
