//! Linear laws of any symmetry: anisotropic and orthotropic stiffness or viscosity with an orientation.

use super::reduced::reduce;
use super::{LawError, OperatorConstants, StressState, TensorLaw, in_range};
use crate::tensor::{Point, Rotation, Sym, SymMap, mandel_index, mandel_len, mandel_weight, symmetric_eigenvalues};

/// A linear operator with up to 21 constants, uniform over the body, reduced to `dim` dimensions as in
/// [`super::Reduced`].
///
/// m and M are the extreme eigenvalues on 𝕊^d.
#[derive(Clone, Debug, PartialEq)]
pub struct Linear {
    map: SymMap,
    constants: OperatorConstants,
}

/// Index pairs in Voigt's order: 11 22 33 23 13 12.
const VOIGT: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];

/// The engineering constants of an orthotropic material in its own axes 1, 2, 3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrthotropicConstants {
    /// E₁, E₂, E₃ in Pa (or Pa s for a viscosity).
    pub young: [f64; 3],
    /// ν₁₂, ν₁₃, ν₂₃: ν_ij is minus the ratio of the strain along j to that along i under uniaxial stress along i.
    pub poisson: [f64; 3],
    /// G₁₂, G₁₃, G₂₃ in Pa (or Pa s).
    pub shear: [f64; 3],
}

impl Linear {
    /// The law σ = C γ, C = `voigt` in the order 11 22 33 23 13 12 and in the material axes, to which `orientation`
    /// turns the axes of the body. Shear entries act on engineering strains: σ₁₂ = … + C₆₆ 2ε₁₂.
    ///
    /// # Errors
    /// Fails if entries are not finite, or if the matrix is not symmetric to 1e-9 of its largest entry or not positive
    /// definite.
    pub fn new(
        voigt: &[[f64; 6]; 6],
        orientation: &Rotation,
        dim: usize,
        state: StressState,
    ) -> Result<Linear, LawError> {
        let mut scale = 0.0f64;
        for &entry in voigt.iter().flatten() {
            scale = scale.max(in_range("an entry of the matrix", entry, "a finite number", true)?.abs());
        }
        for (row, column) in (0..6).flat_map(|i| (0..i).map(move |j| (i, j))) {
            let (found, mirrored) = (voigt[row][column], voigt[column][row]);
            if (found - mirrored).abs() > 1e-9 * scale {
                return Err(LawError::NotSymmetric { row: row + 1, column: column + 1, found, mirrored });
            }
        }
        Linear::of_map(&mandel(voigt), orientation, dim, state)
    }

    /// The law of an orthotropic material.
    ///
    /// # Errors
    /// Fails if moduli are not positive, or if the compliance is not positive definite for the Poisson ratios; |ν_ij| <
    /// (E_i/E_j)^½ is necessary.
    pub fn orthotropic(
        constants: &OrthotropicConstants,
        orientation: &Rotation,
        dim: usize,
        state: StressState,
    ) -> Result<Linear, LawError> {
        let OrthotropicConstants { young, poisson, shear } = *constants;
        for (modulus, name) in young.into_iter().chain(shear).zip(["E₁", "E₂", "E₃", "G₁₂", "G₁₃", "G₂₃"])
        {
            in_range(name, modulus, "a positive number", modulus > 0.0)?;
        }
        for (ratio, name) in poisson.into_iter().zip(["ν₁₂", "ν₁₃", "ν₂₃"]) {
            in_range(name, ratio, "a finite number", true)?;
        }
        // Compliance scaled to ones on the diagonal: s_ij (E_i E_j)^½.
        let coupling = |nu: f64, i: usize, j: usize| -nu * (young[j] / young[i]).sqrt();
        let [a, b, c] = [coupling(poisson[0], 0, 1), coupling(poisson[1], 0, 2), coupling(poisson[2], 1, 2)];
        let s = [[1.0, a, b], [a, 1.0, c], [b, c, 1.0]];
        let eigenvalues = symmetric_eigenvalues(3, |i, j| s[i][j]);
        let (least, most) = (eigenvalues[0], eigenvalues[2]);
        // Eigenvalues of a matrix with entries of order one have an error of a few units of round-off.
        if least.is_nan() || least <= 8.0 * f64::EPSILON * most {
            let what = "compliance −ν_ij (E_j/E_i)^½ of the normal strains, with ones on its diagonal,";
            return Err(LawError::NotPositive { what, least, most });
        }
        let cofactor = |i: usize, j: usize| {
            let (p, q, r, t) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
            s[p][r] * s[q][t] - s[p][t] * s[q][r]
        };
        let determinant: f64 = (0..3).map(|j| s[0][j] * cofactor(0, j)).sum();
        let mut voigt = [[0.0; 6]; 6];
        for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            voigt[i][j] = (young[i] * young[j]).sqrt() * cofactor(i, j) / determinant;
        }
        [voigt[5][5], voigt[4][4], voigt[3][3]] = shear;
        Linear::of_map(&mandel(&voigt), orientation, dim, state)
    }

    /// A map on the strains of a body, in Pa or Pa s, with its constants there.
    pub(super) fn with_constants(map: &SymMap, constants: OperatorConstants) -> Linear {
        Linear { map: *map, constants }
    }

    fn of_map(material: &SymMap, orientation: &Rotation, dim: usize, state: StressState) -> Result<Linear, LawError> {
        let eigenvalues = material.eigenvalues(3);
        let (least, most) = (eigenvalues[0], eigenvalues[5]);
        if least.is_nan() || least <= 0.0 {
            return Err(LawError::NotPositive { what: "matrix, in Mandel's scaling,", least, most });
        }
        let map = reduce(&orientation.map(material), mandel_len(dim), state);
        Ok(Linear { map, constants: OperatorConstants::of_linear(&map, dim) })
    }
}

/// The Mandel matrix of a Voigt matrix: engineering shear strains are √2 times Mandel's.
fn mandel(voigt: &[[f64; 6]; 6]) -> SymMap {
    let mut map = SymMap::default();
    for (a, &(i, j)) in VOIGT.iter().enumerate() {
        for (b, &(k, l)) in VOIGT.iter().enumerate() {
            map.0[mandel_index(i, j)][mandel_index(k, l)] =
                mandel_weight(i, j) * mandel_weight(k, l) * 0.5 * (voigt[a][b] + voigt[b][a]);
        }
    }
    map
}

impl TensorLaw for Linear {
    fn value(&self, _x: &Point, xi: &Sym) -> Sym {
        self.map.apply(xi)
    }
    fn tangent(&self, _x: &Point, _xi: &Sym) -> SymMap {
        self.map
    }
    fn is_linear(&self) -> bool {
        true
    }
    fn constants(&self) -> OperatorConstants {
        self.constants
    }
    fn bounds(&self) -> [SymMap; 2] {
        [self.map; 2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Carreau, Hencky, Isotropic, reduced};

    const X: Point = [0.0; 3];
    const PINE: OrthotropicConstants =
        OrthotropicConstants { young: [9.6, 0.77, 0.43], poisson: [0.31, 0.36, 0.64], shear: [0.8, 0.76, 0.08] };

    fn states() -> impl Iterator<Item = (usize, StressState)> {
        (1..=3).flat_map(|dim| [StressState::PlaneStress, StressState::PlaneStrain].map(|state| (dim, state)))
    }

    /// Matrix and constants agree to 1e-13, including the components that hold a plane strain.
    fn assert_same(law: &dyn TensorLaw, expected: &dyn TensorLaw, what: &str) {
        let (found, expected) = (law.tangent(&X, &Sym::ZERO), expected.tangent(&X, &Sym::ZERO));
        let scale = expected.0.iter().flatten().fold(0.0f64, |m, v| m.max(v.abs()));
        for (row, other) in found.0.iter().zip(&expected.0) {
            for (a, b) in row.iter().zip(other) {
                assert!((a - b).abs() <= 1e-13 * scale, "{what}: found {found:?}, expected {expected:?}");
            }
        }
    }

    /// Hooke's law by engineering constants, by its Voigt matrix, by bulk and shear modulus, and reduced from three
    /// dimensions, in any orientation.
    #[test]
    fn isotropic_constants_give_the_isotropic_law() -> Result<(), LawError> {
        let (e, nu) = (2.1e11, 0.3);
        let (lambda, shear) = (e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), 0.5 * e / (1.0 + nu));
        let constants = OrthotropicConstants { young: [e; 3], poisson: [nu; 3], shear: [shear; 3] };
        let voigt = std::array::from_fn(|i| {
            std::array::from_fn(|j| if i < 3 && j < 3 { lambda } else { 0.0 } + if i != j { 0.0 } else if i < 3 { 2.0 * shear } else { shear })
        });
        let turned = Rotation::euler([0.7, 0.4, -1.9]);
        for (dim, state) in states() {
            let mut expected = Isotropic::elastic(dim, e, nu, state);
            if dim == 1 && state == StressState::PlaneStress {
                expected = Isotropic::lame(1, 0.0, e, state);
            }
            assert_same(&Linear::orthotropic(&constants, &turned, dim, state)?, &expected, "engineering constants");
            assert_same(&Linear::new(&voigt, &turned, dim, state)?, &expected, "Voigt matrix");
            assert_same(reduced(Isotropic::elastic(3, e, nu, state), dim, state).as_ref(), &expected, "reduced");
            let newton = Hencky::new(e / (3.0 * (1.0 - 2.0 * nu)), Carreau::new(shear, 0.0, 1.0, 1.0)?)?;
            assert_same(reduced(newton, dim, state).as_ref(), &expected, "bulk and shear modulus");
            let (found, expected) = (reduced(newton, dim, state).constants(), expected.constants());
            assert!(
                (found.monotonicity / expected.monotonicity - 1.0).abs() < 1e-13
                    && (found.lipschitz / expected.lipschitz - 1.0).abs() < 1e-13
            );
        }
        Ok(())
    }

    /// Reduced stiffness Q and the turned Q̄ of laminate theory (Jones 1999, *Mechanics of Composite Materials*,
    /// section 2.6).
    #[test]
    fn plane_stress_is_the_reduced_stiffness_of_laminates() -> Result<(), LawError> {
        let OrthotropicConstants { young: [e1, e2, _], poisson: [nu12, ..], shear: [g, ..] } = PINE;
        let one = 1.0 - nu12 * nu12 * e2 / e1;
        let (q11, q12, q22, q66) = (e1 / one, nu12 * e2 / one, e2 / one, g);
        for angle in [0.0, 0.35, -1.2] {
            let (s, c) = f64::sin_cos(angle);
            let (p, r) = (q11 - q12 - 2.0 * q66, q12 - q22 + 2.0 * q66);
            let mixed = 2.0 * (q12 + 2.0 * q66) * s * s * c * c;
            let q = [
                [
                    q11 * c.powi(4) + mixed + q22 * s.powi(4),
                    (q11 + q22 - 4.0 * q66) * s * s * c * c + q12 * (s.powi(4) + c.powi(4)),
                    p * s * c.powi(3) + r * s.powi(3) * c,
                ],
                [0.0, q11 * s.powi(4) + mixed + q22 * c.powi(4), p * s.powi(3) * c + r * s * c.powi(3)],
                [0.0, 0.0, (q11 + q22 - 2.0 * q12 - 2.0 * q66) * s * s * c * c + q66 * (s.powi(4) + c.powi(4))],
            ];
            let law = Linear::orthotropic(&PINE, &Rotation::in_plane(angle), 2, StressState::PlaneStress)?;
            let map = law.tangent(&X, &Sym::ZERO);
            let weight = |i: usize| if i == 2 { std::f64::consts::SQRT_2 } else { 1.0 };
            for i in 0..3 {
                for j in i..3 {
                    let (found, expected) = (map.0[i][j] / (weight(i) * weight(j)), q[i][j]);
                    assert!(
                        (found - expected).abs() < 1e-13 * q11 && (map.0[i][j] - map.0[j][i]).abs() < 1e-13 * q11,
                        "Q̄ {i} {j}: {found} {expected}"
                    );
                }
            }
        }
        Ok(())
    }

    /// Uniaxial stress in space, the reduced compliance S_ij − S_i3 S_j3/S_33 of plane strain (Lekhnitskii 1963), and
    /// 1/E_x = c⁴/E₁ + s⁴/E₂ + (1/G₁₂ − 2ν₁₂/E₁) s²c² (Jones 1999, eq. 2.97) in one dimension.
    #[test]
    fn compliance_in_space_plane_strain_and_along_a_line() -> Result<(), LawError> {
        let OrthotropicConstants { young: [e1, e2, e3], poisson: [nu12, nu13, nu23], shear: [g12, g13, g23] } = PINE;
        let s = [
            [1.0 / e1, -nu12 / e1, -nu13 / e1],
            [-nu12 / e1, 1.0 / e2, -nu23 / e2],
            [-nu13 / e1, -nu23 / e2, 1.0 / e3],
        ];
        let close = |found: &Sym, expected: &Sym| {
            assert!((*found - *expected).norm() < 1e-13 * expected.norm(), "found {found:?}, expected {expected:?}");
        };
        let space = Linear::orthotropic(&PINE, &Rotation::IDENTITY, 3, StressState::PlaneStress)?;
        let stress = [[0.7, 0.4, -0.3], [0.4, -0.2, 0.5], [-0.3, 0.5, 0.9]];
        let shear = [[0.0, g12, g13], [g12, 0.0, g23], [g13, g23, 0.0]];
        let strain = Sym::from_fn(3, |i, j| {
            if i == j { (0..3).map(|k| s[i][k] * stress[k][k]).sum() } else { stress[i][j] / (2.0 * shear[i][j]) }
        });
        close(&space.value(&X, &strain), &Sym::from_fn(3, |i, j| stress[i][j]));

        let plane = Linear::orthotropic(&PINE, &Rotation::IDENTITY, 2, StressState::PlaneStrain)?;
        let held = |i: usize, j: usize| s[i][j] - s[i][2] * s[j][2] / s[2][2];
        let strain =
            Sym::from_fn(2, |i, j| if i == j { held(i, 0) * 0.7 - held(i, 1) * 0.2 } else { 0.4 / (2.0 * g12) });
        let mut expected = Sym::from_fn(2, |i, j| stress[i][j]);
        expected.0[3] = -(s[0][2] * 0.7 - s[1][2] * 0.2) / s[2][2];
        close(&plane.value(&X, &strain), &expected);

        let angle = 0.6;
        let (sin, c) = f64::sin_cos(angle);
        let line = Linear::orthotropic(&PINE, &Rotation::in_plane(angle), 1, StressState::PlaneStress)?;
        let e = 1.0 / (c.powi(4) / e1 + sin.powi(4) / e2 + (1.0 / g12 - 2.0 * nu12 / e1) * (sin * c).powi(2));
        assert!((line.constants().monotonicity / e - 1.0).abs() < 1e-13);
        Ok(())
    }

    /// Young's moduli of a copper crystal along ⟨100⟩ and ⟨111⟩, 1/E = s₁₁ − 2 (s₁₁ − s₁₂ − s₄₄/2)(l²m² + m²n² + n²l²)
    /// (Nye 1985, *Physical Properties of Crystals*, p. 145; stiffness in GPa).
    #[test]
    fn moduli_of_a_crystal_along_its_directions() -> Result<(), Box<dyn std::error::Error>> {
        let (c11, c12, c44) = (168.4, 121.4, 75.4);
        let mut voigt = [[0.0; 6]; 6];
        for i in 0..3 {
            voigt[i][..3].fill(c12);
            voigt[i][i] = c11;
            voigt[i + 3][i + 3] = c44;
        }
        let delta = (c11 - c12) * (c11 + 2.0 * c12);
        let (s11, s12, s44) = ((c11 + c12) / delta, -c12 / delta, 1.0 / c44);
        let (a, b, c) = (3f64.sqrt().recip(), 2f64.sqrt().recip(), 6f64.sqrt().recip());
        let turned = Rotation::new([[a, a, a], [b, -b, 0.0], [c, c, -2.0 * c]])?;
        for (orientation, mixed) in [(Rotation::IDENTITY, 0.0), (turned, 1.0 / 3.0)] {
            let law = Linear::new(&voigt, &orientation, 1, StressState::PlaneStress)?;
            let young = 1.0 / (s11 - 2.0 * (s11 - s12 - 0.5 * s44) * mixed);
            assert!((law.constants().lipschitz / young - 1.0).abs() < 1e-13, "{law:?}: {young}");
        }
        Ok(())
    }

    #[test]
    fn impossible_constants_are_refused_with_their_numbers() {
        let law = |change: fn(&mut OrthotropicConstants)| {
            let mut constants = OrthotropicConstants { young: [2.0; 3], poisson: [0.2; 3], shear: [1.0; 3] };
            change(&mut constants);
            Linear::orthotropic(&constants, &Rotation::IDENTITY, 2, StressState::PlaneStress)
        };
        assert!(law(|_| ()).is_ok());
        // ν = 0.5 in all three: incompressible, the eigenvalue 1 − 2ν of the scaled compliance is zero.
        assert!(
            matches!(law(|c| c.poisson = [0.5; 3]), Err(LawError::NotPositive { least, .. }) if least.abs() < 1e-15)
        );
        assert!(
            matches!(law(|c| c.poisson = [1.5, 0.0, 0.0]), Err(LawError::NotPositive { least, .. }) if (least + 0.5).abs() < 1e-14)
        );
        assert_eq!(
            law(|c| c.young[1] = -3.0),
            Err(LawError::Range { name: "E₂", found: -3.0, expected: "a positive number" })
        );
        assert!(matches!(law(|c| c.shear[2] = f64::NAN), Err(LawError::Range { name: "G₂₃", .. })));
        let matrix = |change: fn(&mut [[f64; 6]; 6])| {
            let mut voigt = std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 2.0 } else { 0.0 }));
            change(&mut voigt);
            Linear::new(&voigt, &Rotation::IDENTITY, 3, StressState::PlaneStress)
        };
        assert!(matrix(|_| ()).is_ok());
        assert_eq!(
            matrix(|m| m[3][1] = 0.5),
            Err(LawError::NotSymmetric { row: 4, column: 2, found: 0.5, mirrored: 0.0 })
        );
        // The leading block [[2, 3], [3, 2]] has the eigenvalues −1 and 5.
        let indefinite = matrix(|m| (m[0][1], m[1][0]) = (3.0, 3.0));
        assert!(
            matches!(indefinite, Err(LawError::NotPositive { least, most, .. }) if (least + 1.0).abs() < 1e-14 && (most - 5.0).abs() < 1e-14)
        );
        assert!(matches!(matrix(|m| m[5][5] = f64::INFINITY), Err(LawError::Range { .. })));
    }
}
