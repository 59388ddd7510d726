//! Constitutive data: (2.1) σ = 𝓔ε(u) + 𝓥ε(u̇) − θ𝓜 and (2.2) q = −𝓚∇θ.

use std::fmt::Debug;
use std::sync::Arc;

use crate::tensor::{Point, Sym, SymMap, mandel_len};

/// Constants of an operator on 𝕊^d: (H1) and (H2) ask for `monotonicity` > 0 and a finite `lipschitz`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constants {
    /// m: (A(ξ₁) − A(ξ₂))·(ξ₁ − ξ₂) ≥ m ‖ξ₁ − ξ₂‖².
    pub monotonicity: f64,
    /// M: ‖A(ξ₁) − A(ξ₂)‖ ≤ M ‖ξ₁ − ξ₂‖.
    pub lipschitz: f64,
}

impl Constants {
    /// The constants of a symmetric linear map: its extreme eigenvalues on 𝕊^d.
    #[must_use]
    pub fn of_linear(map: &SymMap, dim: usize) -> Constants {
        let e = map.eigenvalues(dim);
        let lipschitz = e.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        Constants { monotonicity: e.first().copied().unwrap_or(0.0), lipschitz }
    }
}

/// An operator Ω × 𝕊^d → 𝕊^d, serving 𝓔 of (H2) in Pa and 𝓥 of (H1) in Pa s.
///
/// In two dimensions the argument has components 11, 22, 12 and so has the value that enters the
/// forms; the component 33 of the value is the stress that holds a plane strain (0 in plane stress).
pub trait TensorLaw: Debug + Send + Sync {
    /// The value at the point `x` and argument `xi`.
    fn value(&self, x: &Point, xi: &Sym) -> Sym;
    /// Derivative of the value with respect to `xi`.
    fn tangent(&self, x: &Point, xi: &Sym) -> SymMap;
    /// Whether the value is a linear function of `xi`, the same at every `x`.
    fn is_linear(&self) -> bool {
        false
    }
    /// m and M of (H1), (H2) on 𝕊^d.
    fn constants(&self) -> Constants;
}

/// How the third direction of a plane body is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum StressState {
    /// σ₃₃ = 0.
    #[default]
    PlaneStress,
    /// ε₃₃ = 0.
    PlaneStrain,
}

/// A linear isotropic operator τ ↦ λ tr(τ) I + c τ, constant over the body.
#[derive(Clone, Debug, PartialEq)]
pub struct Isotropic {
    dim: usize,
    lambda: f64,
    map: SymMap,
    /// Whether the operator has a component 33 (plane strain).
    out_of_plane: bool,
}

impl Isotropic {
    /// 𝓔 of (5.1), `Eν/(1−ν²) tr(τ) I + E/(1+ν) τ`, in plane stress; in plane strain and in three
    /// dimensions `Eν/((1+ν)(1−2ν))` stands in its first term. E is `young` in Pa, ν `poisson`.
    #[must_use]
    pub fn elastic(dim: usize, young: f64, poisson: f64, state: StressState) -> Isotropic {
        let plane_stress = dim == 2 && state == StressState::PlaneStress;
        let lambda = if plane_stress { young * poisson / (1.0 - poisson * poisson) } else { young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)) };
        Isotropic::new(dim, lambda, young / (1.0 + poisson), dim == 2 && !plane_stress)
    }

    /// 𝓥 of (5.1), `μ₁ tr(τ) I + μ₂ τ`, coefficients in Pa s.
    #[must_use]
    pub fn lame(dim: usize, first: f64, second: f64, state: StressState) -> Isotropic {
        Isotropic::new(dim, first, second, dim == 2 && state == StressState::PlaneStrain)
    }

    fn new(dim: usize, lambda: f64, c: f64, out_of_plane: bool) -> Isotropic {
        Isotropic { dim, lambda, map: SymMap::isotropic(dim, lambda, c), out_of_plane }
    }
}

impl TensorLaw for Isotropic {
    fn value(&self, _x: &Point, xi: &Sym) -> Sym {
        let mut value = self.map.apply(xi);
        if self.out_of_plane {
            value.0[3] = self.lambda * (xi.0[0] + xi.0[1]);
        }
        value
    }
    fn tangent(&self, _x: &Point, _xi: &Sym) -> SymMap {
        let mut map = self.map;
        if self.out_of_plane {
            map.0[3][0] = self.lambda;
            map.0[3][1] = self.lambda;
        }
        map
    }
    fn is_linear(&self) -> bool {
        true
    }
    fn constants(&self) -> Constants {
        Constants::of_linear(&self.map, self.dim)
    }
}

/// The material of a body.
#[derive(Clone, Debug)]
pub struct Material {
    /// ρ in kg/m³; 0 for a quasistatic problem.
    pub density: f64,
    /// Factor of θ̇ in (2.4), J/(m³ K); 1 in the paper; 0 for steady heat.
    pub heat_capacity: f64,
    /// 𝓔, (H2).
    pub elasticity: Arc<dyn TensorLaw>,
    /// 𝓥, (H1).
    pub viscosity: Arc<dyn TensorLaw>,
    /// 𝓜 in Pa/K, (H4); a component 33 acts on the stress of a plane strain only.
    pub expansion: Sym,
    /// 𝓡 in W/m³ per unit strain, (H5).
    pub coupling: Sym,
    /// 𝓚 in W/(m K), (H3).
    pub conductivity: Sym,
}

impl Material {
    /// (2.1): σ = 𝓔ε(u) + 𝓥ε(u̇) − θ𝓜.
    #[must_use]
    pub fn stress(&self, x: &Point, strain: &Sym, strain_rate: &Sym, theta: f64) -> Sym {
        self.elasticity.value(x, strain) + self.viscosity.value(x, strain_rate) - theta * self.expansion
    }
}

/// Names of the stress components in the order of VTK: xx yy zz xy yz zx, as pairs of indices.
pub const VTK_COMPONENTS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];

/// Sample laws with the dimension they act in, for tests that hold for every law.
#[must_use]
pub fn samples() -> Vec<(usize, Arc<dyn TensorLaw>)> {
    let mut laws: Vec<(usize, Arc<dyn TensorLaw>)> = Vec::new();
    for dim in 1..=3 {
        for state in [StressState::PlaneStress, StressState::PlaneStrain] {
            laws.push((dim, Arc::new(Isotropic::elastic(dim, 2.0, 0.1, state))));
            laws.push((dim, Arc::new(Isotropic::elastic(dim, 2.1e11, 0.3, state))));
            laws.push((dim, Arc::new(Isotropic::lame(dim, 10.0, 10.0, state))));
        }
    }
    debug_assert!(laws.iter().all(|(dim, _)| mandel_len(*dim) <= 6));
    laws
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (5.1) written out by components.
    #[test]
    fn the_paper_s_operators_by_components() {
        let (young, nu) = (2.0, 0.1);
        let law = Isotropic::elastic(2, young, nu, StressState::PlaneStress);
        let tau = Sym::from_fn(2, |i, j| [[0.3, -0.2], [-0.2, 0.7]][i][j]);
        let sigma = law.value(&[0.0; 3], &tau);
        assert!((sigma.get(0, 0) - (young * nu / (1.0 - nu * nu) * 1.0 + young / (1.0 + nu) * 0.3)).abs() < 1e-15);
        assert!((sigma.get(0, 1) - young / (1.0 + nu) * -0.2).abs() < 1e-15);
        assert!((law.constants().monotonicity - young / (1.0 + nu)).abs() < 1e-14);
        assert!((law.constants().lipschitz - young / (1.0 - nu)).abs() < 1e-14);
    }

    /// Uniaxial stress in plane stress gives −ν across; plane strain is Hooke's law with ε₃₃ = 0.
    #[test]
    fn both_plane_states_satisfy_hooke_in_three_dimensions() {
        let (young, nu) = (210.0, 0.3);
        let strain = Sym::from_fn(2, |i, j| [[1.0, 0.0], [0.0, -nu]][i][j]);
        let sigma = Isotropic::elastic(2, young, nu, StressState::PlaneStress).value(&[0.0; 3], &strain);
        assert!((sigma.get(0, 0) - young).abs() < 1e-12 && sigma.get(1, 1).abs() < 1e-12);

        let strain = Sym::from_fn(2, |i, j| [[0.2, 0.1], [0.1, -0.4]][i][j]);
        let s = Isotropic::elastic(2, young, nu, StressState::PlaneStrain).value(&[0.0; 3], &strain);
        let e = |a: f64, b: f64, c: f64| (a - nu * (b + c)) / young;
        let (x, y, z) = (s.get(0, 0), s.get(1, 1), s.get(2, 2));
        assert!((e(x, y, z) - 0.2).abs() < 1e-14 && (e(y, x, z) + 0.4).abs() < 1e-14 && e(z, x, y).abs() < 1e-14);
    }
}
