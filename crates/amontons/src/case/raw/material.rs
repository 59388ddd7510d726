//! `[material]` and `[[region]]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Coefficient, Datum, Steady};

/// A region of the body with a material or with loads of its own.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Region {
    /// Name of the region in the mesh.
    pub on: String,
    /// Material of the region, with all keys that the case uses; default: that of `[material]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<Material>,
    /// Body force in the region in N/m³, which adds to that of `[load]`, one entry per component; empty for none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub body_force: Vec<Datum>,
    /// Heat source in the region in W/m³, which adds to that of `[load]`.
    #[serde(default)]
    pub heat_source: Datum,
    /// Temperature θ in K that is given in the region at all times, in the place of that of `[load]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature: Option<Datum>,
}

/// Material: σ = 𝓔ε(u) + 𝓥ε(u̇) − θ𝓜 (2.1), q = −𝓚∇θ (2.2).
///
/// A case without heat leaves out `heat_capacity`, `conductivity`, `expansion` and `coupling`; a case without mechanics
/// leaves out `density`, `elasticity` and `viscosity`.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "a table or the name of a material", extend("x-short-for" = "base"))]
pub(in crate::case) struct Material {
    /// Name of a material whose values hold for the keys that are left out, such as "steel-s235".
    ///
    /// `amontons materials` lists them with their sources. `material = "steel-s235"` is short for a table with this key
    /// alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base: Option<String>,
    /// Plane stress or plane strain for the elasticity of `base` of a plane body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stress_state: Option<StressState>,
    /// Density ρ in kg/m³; 0: quasistatic.
    ///
    /// Required for mechanics.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0))]
    pub density: Option<Steady>,
    /// Heat capacity per volume, the factor of θ̇ in (2.4), in J/(m³ K); 0: steady heat.
    ///
    /// Density times specific heat. Required for heat.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0))]
    pub heat_capacity: Option<Coefficient>,
    /// Thermal stress tensor 𝓜 of (2.1) in Pa/K, 0 if left out.
    ///
    /// Give `expansion_coefficient` instead if you know the coefficient of thermal expansion α.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expansion: Option<Tensor>,
    /// Coefficient of thermal expansion α in 1/K, from which 𝓜 = 𝓔α follows.
    ///
    /// Three numbers are the coefficients along the axes of the material, those of `elasticity.orientation`. The
    /// product with the three-dimensional elasticity is taken first and then reduced to plane stress or plane strain.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expansion_coefficient: Option<Expansion>,
    /// What tables over the temperature in `expansion` and `expansion_coefficient` hold; default: secant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expansion_kind: Option<ExpansionKind>,
    /// Tensor 𝓡 of (2.4), heat per strain, in W/m³, 0 if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coupling: Option<Tensor>,
    /// Heat conductivity tensor 𝓚 of (2.2) in W/(m K).
    ///
    /// Required for heat.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub conductivity: Option<Tensor>,
    /// Elasticity 𝓔.
    ///
    /// Required for mechanics.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub elasticity: Option<Elasticity>,
    /// Viscosity 𝓥; none if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub viscosity: Option<Viscosity>,
    /// Branches of a generalized Maxwell body: relaxing stress in addition to 𝓔 and 𝓥.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub prony: Vec<Branch>,
    /// How the dilatation (change of volume) of a cell is computed.
    #[serde(default)]
    pub dilatation: Dilatation,
}

/// A symmetric tensor.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "a number, an expression in x, y, z, data of a mesh file or a symmetric matrix [[…], […]]")]
pub(in crate::case) enum Tensor {
    /// That multiple of the identity.
    Multiple(Coefficient),
    /// The components, row by row.
    Matrix(Vec<Vec<Coefficient>>),
}

/// Coefficients of thermal expansion.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(
    title = "a number, an expression in x, y, z, data of a mesh file, or three of them along the axes of the material"
)]
pub(in crate::case) enum Expansion {
    /// The same in all directions.
    Isotropic(Coefficient),
    /// α₁, α₂, α₃ along the axes of the material.
    Orthotropic([Coefficient; 3]),
}

/// What a table of thermal expansion over the temperature holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum ExpansionKind {
    /// The mean coefficient from 0 to θ: the thermal strain is α(θ) θ.
    Secant,
    /// The coefficient at θ: the thermal strain is ∫ α from 0 to θ.
    Tangent,
}

/// Law of elasticity.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
pub(in crate::case) enum Elasticity {
    /// 𝓔τ = Eν/(1−ν²) tr(τ) I + E/(1+ν) τ in plane stress, (5.1).
    Isotropic {
        /// Young's modulus E in Pa.
        #[schemars(extend("exclusiveMinimum" = 0))]
        young: Coefficient,
        /// Poisson's ratio ν.
        ///
        /// Above −1; below 1 in plane stress, below 0.5 in plane strain.
        #[schemars(extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 1))]
        poisson: Coefficient,
        /// Plane stress or plane strain, of a plane body; the elements of an `.inp` file may say it.
        ///
        /// A line is a bar with free sides unless it says otherwise.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        stress_state: Option<StressState>,
    },
    /// An orthotropic material: three planes of symmetry, axes 1, 2, 3.
    Orthotropic {
        /// Young's moduli E₁, E₂, E₃ in Pa.
        young: [Coefficient; 3],
        /// Poisson's ratios ν₁₂, ν₁₃, ν₂₃.
        poisson: [Coefficient; 3],
        /// Shear moduli G₁₂, G₁₃, G₂₃ in Pa.
        shear: [Coefficient; 3],
        /// Orientation of the axes of the material: angles in rad.
        #[serde(default)]
        orientation: Orientation,
        /// Plane stress or plane strain, of a plane body; the elements of an `.inp` file may say it.
        ///
        /// A line is a bar with free sides unless it says otherwise.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        stress_state: Option<StressState>,
    },
    /// A material of any symmetry, given by its stiffness matrix.
    Anisotropic {
        /// Stiffness in Pa in the order 11 22 33 23 13 12; shear entries act on engineering strains.
        voigt: Box<[[Coefficient; 6]; 6]>,
        /// Orientation of the axes of the material: angles in rad.
        #[serde(default)]
        orientation: Orientation,
        /// Plane stress or plane strain, of a plane body; the elements of an `.inp` file may say it.
        ///
        /// A line is a bar with free sides unless it says otherwise.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        stress_state: Option<StressState>,
    },
    /// 𝓒ξ + β (ξ − P_K ξ) with 𝓒 isotropic, P_K the projection on {ξ: ‖ξ^D‖ ≤ κ}; with β < 0 Hencky's deformation
    /// theory.
    VonMisesProjection {
        /// Young's modulus E of 𝓒 in Pa.
        #[schemars(extend("exclusiveMinimum" = 0))]
        young: Coefficient,
        /// Poisson's ratio ν of 𝓒, below 0.5.
        #[schemars(extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 0.5))]
        poisson: Coefficient,
        /// Factor β in Pa, above −E/(1+ν).
        excess: Coefficient,
        /// Radius κ of the convex, a strain.
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: Coefficient,
        /// Plane stress or plane strain, of a plane body; the elements of an `.inp` file may say it.
        ///
        /// A line is a bar with free sides unless it says otherwise.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        stress_state: Option<StressState>,
    },
    /// κ tr(ξ) I + 2μ(‖ξ^D‖) ξ^D, whose shear modulus falls from μ₀ to μ_∞ as Carreau's viscosity does.
    Hencky {
        /// Bulk modulus κ in Pa.
        #[schemars(extend("minimum" = 0))]
        bulk: Coefficient,
        /// Shear modulus μ₀ at rest in Pa.
        #[schemars(extend("exclusiveMinimum" = 0))]
        shear: Coefficient,
        /// Shear modulus μ_∞ at large strain in Pa, from 0 to μ₀.
        #[schemars(extend("minimum" = 0))]
        shear_infinite: Coefficient,
        /// Norm of the deviatoric strain at which the material softens.
        #[schemars(extend("exclusiveMinimum" = 0))]
        strain: Coefficient,
        /// Exponent n of the stress between the two limits.
        #[schemars(extend("minimum" = 0, "maximum" = 1))]
        exponent: Coefficient,
        /// Plane stress or plane strain, of a plane body; the elements of an `.inp` file may say it.
        ///
        /// A line is a bar with free sides unless it says otherwise.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        stress_state: Option<StressState>,
    },
}

/// Orientation of the axes of a material.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "an angle in rad, an expression in x, y, z, data of a mesh file, or three Euler angles")]
pub(in crate::case) enum Orientation {
    /// Angle in rad by which axis 1 is rotated from x towards y.
    Angle(Coefficient),
    /// Bunge's Euler angles in rad: rotations about z, the rotated x and the rotated z.
    Euler([Coefficient; 3]),
}

impl Default for Orientation {
    fn default() -> Orientation {
        Orientation::Angle(Coefficient::default())
    }
}

/// Plane stress or plane strain: of a plane body, unless the elements of its `.inp` file say it. A line is a bar
/// with free sides unless it says otherwise.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum StressState {
    /// Plane stress, σ₃₃ = 0: a thin sheet.
    #[default]
    PlaneStress,
    /// Plane strain, ε₃₃ = 0: a long body.
    PlaneStrain,
}

/// Law of viscosity.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
pub(in crate::case) enum Viscosity {
    /// 𝓥τ = first tr(τ) I + second τ, (5.1).
    Lame {
        /// Factor of tr(τ) I in Pa s.
        first: Coefficient,
        /// Factor of τ in Pa s.
        #[schemars(extend("minimum" = 0))]
        second: Coefficient,
    },
    /// A viscosity of any symmetry, given by its matrix.
    Anisotropic {
        /// Viscosity in Pa s in the order 11 22 33 23 13 12; shear entries act on engineering strain rates.
        voigt: Box<[[Coefficient; 6]; 6]>,
        /// Orientation of the axes of the material: angles in rad.
        #[serde(default)]
        orientation: Orientation,
    },
    /// bulk tr(ξ) I + 2η(‖ξ^D‖) ξ^D, η falling from η₀ to η_∞ (Carreau, 1972).
    Carreau {
        /// Bulk viscosity in Pa s.
        #[schemars(extend("minimum" = 0))]
        bulk: Coefficient,
        /// Viscosity η₀ at rest in Pa s.
        #[schemars(extend("exclusiveMinimum" = 0))]
        zero: Coefficient,
        /// Viscosity η_∞ at high rates in Pa s, from 0 to η₀.
        #[schemars(extend("minimum" = 0))]
        infinite: Coefficient,
        /// Time λ in s: the viscosity decreases at strain rates above 1/λ.
        #[schemars(extend("exclusiveMinimum" = 0))]
        time: Coefficient,
        /// Exponent n of the stress between the two limits.
        #[schemars(extend("minimum" = 0, "maximum" = 1))]
        exponent: Coefficient,
    },
    /// bulk tr(ξ) I + 2 (floor + K (δ² + ‖ξ^D‖²)^((n−1)/2)) ξ^D, a regularised power law.
    PowerLaw {
        /// Bulk viscosity in Pa s.
        #[schemars(extend("minimum" = 0))]
        bulk: Coefficient,
        /// Consistency K in Pa sⁿ.
        #[schemars(extend("exclusiveMinimum" = 0))]
        consistency: Coefficient,
        /// Exponent n of the stress.
        #[schemars(extend("minimum" = 0, "maximum" = 1))]
        exponent: Coefficient,
        /// Strain rate δ in 1/s below which the viscosity is nearly constant.
        #[schemars(extend("exclusiveMinimum" = 0))]
        threshold: Coefficient,
        /// Viscosity at high rates in Pa s.
        #[serde(default)]
        #[schemars(extend("minimum" = 0))]
        floor: Coefficient,
    },
}

/// A branch of a generalized Maxwell body.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Branch {
    /// Modulus of the branch divided by that of 𝓔, the long-term modulus.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub ratio: Steady,
    /// Relaxation time in s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub time: Steady,
    /// Whether the branch resists changes of shape alone: the stress deviator relaxes or creeps, the pressure does not.
    #[serde(default)]
    pub deviatoric: bool,
}

/// How the dilatation (change of volume) of a cell is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum Dilatation {
    /// At each point.
    #[default]
    Full,
    /// Its mean over the cell, which prevents locking of nearly incompressible bodies; for Q1, Q2 and P2.
    Mean,
}
