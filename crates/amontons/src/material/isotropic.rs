//! The linear isotropic law of the paper, (5.1).

use super::{OperatorConstants, StressState, TensorLaw};
use crate::tensor::{Point, Sym, SymMap};

/// A linear isotropic operator τ ↦ λ tr(τ) I + c τ, constant over the body.
#[derive(Clone, Debug, PartialEq)]
pub struct Isotropic {
    dim: usize,
    lambda: f64,
    map: SymMap,
    /// True if the operator has a component 33 (plane strain).
    out_of_plane: bool,
}

impl Isotropic {
    /// 𝓔 of (5.1), `Eν/(1−ν²) tr(τ) I + E/(1+ν) τ`, in plane stress; in plane strain and in three dimensions the first
    /// coefficient is `Eν/((1+ν)(1−2ν))`. In one dimension plane stress is uniaxial stress, Eτ, and plane strain
    /// uniaxial strain. E is `young` in Pa, ν `poisson`.
    #[must_use]
    pub fn elastic(dim: usize, young: f64, poisson: f64, state: StressState) -> Isotropic {
        let (lambda, c) = (young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), young / (1.0 + poisson));
        match (dim, state) {
            (1, StressState::PlaneStress) => Isotropic::new(dim, 0.0, young, false),
            (2, StressState::PlaneStress) => Isotropic::new(dim, young * poisson / (1.0 - poisson * poisson), c, false),
            _ => Isotropic::new(dim, lambda, c, dim == 2),
        }
    }

    /// 𝓥 of (5.1), `μ₁ tr(τ) I + μ₂ τ`, coefficients in Pa s.
    #[must_use]
    pub fn lame(dim: usize, first: f64, second: f64, state: StressState) -> Isotropic {
        Isotropic::new(dim, first, second, dim == 2 && state == StressState::PlaneStrain)
    }

    /// 2μ ξ^D, the part of an isotropic law at a point that resists changes of shape, in plane strain or in space: μ is
    /// the shear modulus of the law.
    #[must_use]
    pub fn deviatoric(dim: usize, law: &dyn TensorLaw, x: &Point) -> Isotropic {
        let twice = law.tangent(x, &Sym::ZERO).0[2][2];
        Isotropic::lame(dim, -twice / 3.0, twice, StressState::PlaneStrain)
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
    fn constants(&self) -> OperatorConstants {
        OperatorConstants::of_linear(&self.map, self.dim)
    }
    fn bounds(&self) -> [SymMap; 2] {
        [self.map; 2]
    }
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
