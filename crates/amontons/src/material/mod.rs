//! Constitutive data: (2.1) σ = 𝓔ε(u) + 𝓥ε(u̇) − θ𝓜 and (2.2) q = −𝓚∇θ.

use std::fmt::Debug;
use std::sync::Arc;

use crate::field::{Coefficient, Law};
use crate::tensor::{Point, Rotation, Sym, SymMap, mandel_len};

mod arrays;
mod graded;
mod hencky;
mod isotropic;
mod linear;
mod prony;
mod reduced;
mod shear;

pub use arrays::ArrayTensor;
pub(crate) use arrays::{arrays, material_arrays};
pub use hencky::Hencky;
pub use isotropic::Isotropic;
pub use linear::{Linear, OrthotropicConstants};
pub use prony::{Branch, BranchBalance, Prony};
pub use reduced::{Reduced, reduced};
pub use shear::{Carreau, ShearLaw, VonMisesProjection};

/// Constants of an operator on 𝕊^d: (H1) and (H2) require `monotonicity` > 0 and a finite `lipschitz`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OperatorConstants {
    /// m: (A(ξ₁) − A(ξ₂))·(ξ₁ − ξ₂) ≥ m ‖ξ₁ − ξ₂‖².
    pub monotonicity: f64,
    /// M: ‖A(ξ₁) − A(ξ₂)‖ ≤ M ‖ξ₁ − ξ₂‖.
    pub lipschitz: f64,
}

impl OperatorConstants {
    /// The constants of a symmetric linear map: its extreme eigenvalues on 𝕊^d.
    #[must_use]
    pub fn of_linear(map: &SymMap, dim: usize) -> OperatorConstants {
        let e = map.eigenvalues(dim);
        let lipschitz = e.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        OperatorConstants { monotonicity: e.first().copied().unwrap_or(0.0), lipschitz }
    }
}

/// Reason why numbers define no valid law.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LawError {
    /// A number outside its range.
    #[error("{name} = {found:?}, expected {expected}")]
    Range {
        /// Name of the number, as in the documentation of the law.
        name: &'static str,
        /// The number.
        found: f64,
        /// Its range.
        expected: &'static str,
    },
    /// A matrix that is not symmetric.
    #[error(
        "the matrix is not symmetric: {found:?} in row {row}, column {column} but {mirrored:?} in row {column}, column {row}"
    )]
    NotSymmetric {
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
        /// Entry there.
        found: f64,
        /// Entry on the other side of the diagonal.
        mirrored: f64,
    },
    /// A stiffness or compliance for which some strain has no positive energy.
    #[error(
        "the {what} is not positive definite: its eigenvalues reach from {least:e} to {most:e}, expected all positive"
    )]
    NotPositive {
        /// The matrix and its scaling.
        what: &'static str,
        /// Least eigenvalue.
        least: f64,
        /// Largest eigenvalue.
        most: f64,
    },
    /// A law that must be linear but is not.
    #[error("the law is not linear; the branches of a generalized Maxwell body are")]
    NotLinear,
}

/// `found`, or an error if it is outside the range or not finite.
fn in_range(name: &'static str, found: f64, expected: &'static str, holds: bool) -> Result<f64, LawError> {
    if holds && found.is_finite() { Ok(found) } else { Err(LawError::Range { name, found, expected }) }
}

/// An operator Ω × 𝕊^d → 𝕊^d, serving 𝓔 of (H2) in Pa and 𝓥 of (H1) in Pa s.
///
/// In two dimensions the argument has components 11, 22, 12, and so has the part of the value that enters the forms;
/// the other components of the value are the stress that holds a plane strain (0 in plane stress). Axisymmetric bodies
/// use laws of three dimensions: 11, 22, 12 are rr, zz, rz and 33 is θθ.
pub trait TensorLaw: Debug + Send + Sync {
    /// The value at the point `x` and argument `xi`.
    fn value(&self, x: &Point, xi: &Sym) -> Sym;
    /// Derivative of the value with respect to `xi`.
    fn tangent(&self, x: &Point, xi: &Sym) -> SymMap;
    /// True if the value is a linear function of `xi`, symmetric and, unless the law varies ([`Law`]), the same at
    /// every `x`.
    fn is_linear(&self) -> bool {
        false
    }
    /// m and M of (H1), (H2) on 𝕊^d.
    fn constants(&self) -> OperatorConstants;
    /// W with dW/dξ the value on 𝕊^d and W(0) = 0, for 𝓔 the stored energy in J/m³; `None` if there is none.
    fn potential(&self, x: &Point, xi: &Sym) -> Option<f64> {
        self.is_linear().then(|| 0.5 * self.value(x, xi).dot(xi))
    }
    /// Linear maps L, U with L ≤ D ≤ U as quadratic forms, for the tangent D at every argument.
    ///
    /// They keep the constants optimal when a law is reduced to a plane ([`Reduced`]); m and M alone would not.
    fn bounds(&self) -> [SymMap; 2] {
        let OperatorConstants { monotonicity, lipschitz } = self.constants();
        [monotonicity, lipschitz].map(|c| SymMap::isotropic(3, 0.0, c))
    }
}

/// Condition on the directions that a body of one or two dimensions lacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum StressState {
    /// No stress in these directions: σ₃₃ = σ₂₃ = σ₁₃ = 0; in one dimension uniaxial stress.
    #[default]
    PlaneStress,
    /// No strain in these directions: ε₃₃ = ε₂₃ = ε₁₃ = 0; in one dimension uniaxial strain.
    PlaneStrain,
}

/// The strain of a cell that enters elasticity and viscosity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Dilatation {
    /// ε(u) unchanged.
    #[default]
    Full,
    /// The trace of ε(u) is replaced by its mean over the cell, ε̄ = ε + (mean tr ε − tr ε) I/d (the B̄ method; Hughes,
    /// *The Finite Element Method*, 1987, section 4.5). Prevents locking of nearly incompressible bodies with Q1
    /// quadrilaterals and hexahedra. It costs quadratic elements one order, and has no effect on linear simplices.
    Mean,
}

/// The material of a body. Make it by [`Material::new`], then set its fields.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Material {
    /// ρ in kg/m³; 0 for a quasistatic problem.
    pub density: Coefficient<f64>,
    /// Factor of θ̇ in (2.4), J/(m³ K); 1 in the paper; 0 for steady heat.
    pub heat_capacity: Coefficient<f64>,
    /// 𝓔, (H2).
    pub elasticity: Law<dyn TensorLaw>,
    /// 𝓥, (H1).
    pub viscosity: Law<dyn TensorLaw>,
    /// Relaxing stress, in addition to 𝓔 and 𝓥.
    pub prony: Option<Prony>,
    /// 𝓜 in Pa/K, (H4); a component 33 acts only on the stress that holds a plane strain.
    pub expansion: Coefficient<Sym>,
    /// 𝓡 in W/m³ per unit strain, (H5).
    pub coupling: Coefficient<Sym>,
    /// 𝓚 in W/(m K), (H3).
    pub conductivity: Coefficient<Sym>,
    /// The strain that enters elasticity, viscosity and branches.
    pub dilatation: Dilatation,
}

impl Material {
    /// A material with the law 𝓔 on bodies of `dim` dimensions. Density, heat capacity, conductivity and couplings are
    /// zero, and there is no viscosity.
    #[must_use]
    pub fn new(dim: usize, elasticity: impl Into<Law<dyn TensorLaw>>) -> Material {
        Material {
            density: 0.0.into(),
            heat_capacity: 0.0.into(),
            elasticity: elasticity.into(),
            viscosity: Isotropic::lame(dim, 0.0, 0.0, StressState::PlaneStress).into(),
            prony: None,
            expansion: Sym::ZERO.into(),
            coupling: Sym::ZERO.into(),
            conductivity: Sym::ZERO.into(),
            dilatation: Dilatation::Full,
        }
    }

    /// Sets the viscosity law 𝓥.
    #[must_use]
    pub fn viscosity(self, law: impl Into<Law<dyn TensorLaw>>) -> Material {
        Material { viscosity: law.into(), ..self }
    }

    /// The branches with space-dependent relaxation time, in their order.
    pub fn varying_branches(&self) -> impl Iterator<Item = &Branch> {
        self.prony.as_ref().map_or(&[][..], Prony::branches).iter().filter(|branch| branch.time_varies())
    }

    /// (2.1): σ = 𝓔ε(u) + 𝓥ε(u̇) − θ𝓜, without the stress of `prony`, which depends on the past.
    #[must_use]
    pub fn stress(&self, x: &Point, strain: &Sym, strain_rate: &Sym, theta: f64) -> Sym {
        let value = |law: &Law<dyn TensorLaw>, xi: &Sym| {
            law.at_temperature(x, theta).map_or_else(|| law.value(x, xi), |law| law.value(x, xi))
        };
        value(&self.elasticity, strain) + value(&self.viscosity, strain_rate)
            - theta * self.expansion.at_temperature(x, theta)
    }

    /// True if 𝓔 or 𝓥 depend on the temperature.
    #[must_use]
    pub fn laws_depend_on_temperature(&self) -> bool {
        [&self.elasticity, &self.viscosity].into_iter().any(|law| !law.temperatures().is_empty())
    }
}

/// Stress components in the order of VTK, xx yy zz xy yz zx, as pairs of indices.
pub const VTK_COMPONENTS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];

/// Sample isotropic laws with their dimension, for tests that hold for every such law.
#[must_use]
pub fn isotropic_samples() -> Vec<(usize, Arc<dyn TensorLaw>)> {
    let mut laws: Vec<(usize, Arc<dyn TensorLaw>)> = Vec::new();
    for dim in 1..=3 {
        for state in [StressState::PlaneStress, StressState::PlaneStrain] {
            laws.push((dim, Arc::new(Isotropic::elastic(dim, 2.0, 0.1, state))));
            laws.push((dim, Arc::new(Isotropic::elastic(dim, 2.1e11, 0.3, state))));
            laws.push((dim, Arc::new(Isotropic::lame(dim, 10.0, 10.0, state))));
            // Kinks and bends lie at the size of the arguments that the contract samples.
            for excess in [5.0, -1.5] {
                laws.extend(
                    VonMisesProjection::new(1.0, excess, 1e-3)
                        .and_then(|s| Hencky::new(2.0, s))
                        .map(|law| (dim, reduced(law, dim, state))),
                );
            }
            laws.extend(
                Carreau::new(3.0, 0.1, 2e3, 0.4)
                    .and_then(|s| Hencky::new(1.5, s))
                    .map(|law| (dim, reduced(law, dim, state))),
            );
            laws.extend(
                Carreau::power_law(0.1, 0.25, 1e-4, 0.2)
                    .and_then(|s| Hencky::new(20.0, s))
                    .map(|law| (dim, reduced(law, dim, state))),
            );
        }
    }
    debug_assert!(laws.iter().all(|(dim, _)| mandel_len(*dim) <= 6));
    laws
}

/// Sample laws with their dimension, for tests that hold for every law.
#[must_use]
pub fn samples() -> Vec<(usize, Arc<dyn TensorLaw>)> {
    let mut laws = isotropic_samples();
    // Pine and a carbon-fibre ply, in Pa.
    let pine = OrthotropicConstants {
        young: [9.6e9, 0.77e9, 0.43e9],
        poisson: [0.31, 0.36, 0.64],
        shear: [0.8e9, 0.76e9, 0.08e9],
    };
    let ply = OrthotropicConstants { young: [140e9, 10e9, 10e9], poisson: [0.3, 0.3, 0.45], shear: [5e9, 5e9, 3.4e9] };
    for dim in 1..=3 {
        for state in [StressState::PlaneStress, StressState::PlaneStrain] {
            for (constants, angles) in [(&pine, [0.4, 0.0, 0.0]), (&ply, [0.3, 0.9, -0.5])] {
                laws.extend(
                    Linear::orthotropic(constants, &Rotation::euler(angles), dim, state)
                        .map(|law| (dim, Arc::new(law) as Arc<dyn TensorLaw>)),
                );
            }
        }
    }
    laws
}
