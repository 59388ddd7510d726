//! The materials of a case.

use std::sync::Arc;

use super::path::Path;
use super::place::{At, Finding};
use super::raw::{self, Elasticity, Expansion, Orientation, Tensor, Viscosity};
use crate::material::{
    Carreau, Hencky, Isotropic, LawError, Linear, Material, Orthotropic, Prony, ShearLaw, StressState, TensorLaw,
    VonMisesProjection, reduced,
};
use crate::mesh::Mesh;
use crate::tensor::{Rotation, Sym, mandel_len};

/// Builds the material at `prefix` of the case; what is wrong with it goes to the findings.
pub(super) fn material(raw: &raw::Material, prefix: &str, mesh: &Mesh, findings: &mut Vec<Finding>) -> Material {
    Builder { prefix, mesh, findings }.material(raw)
}

struct Builder<'a> {
    prefix: &'a str,
    mesh: &'a Mesh,
    findings: &'a mut Vec<Finding>,
}

type Law = Arc<dyn TensorLaw>;

impl Builder<'_> {
    fn note(&mut self, key: &str, found: String, expected: impl Into<String>, hint: Option<&str>) {
        let path = Path::parse(&format!("{}.{key}", self.prefix)).unwrap_or_default();
        self.findings.push(Finding::new(path, At::Value, found, expected).hint(hint.map(str::to_owned)));
    }

    /// Keys that are left out stand for zero; those that are required are noted elsewhere.
    fn material(mut self, raw: &raw::Material) -> Material {
        let dim = self.dim();
        let state =
            raw.elasticity.as_ref().map_or_else(StressState::default, |elasticity| self.stress_state(elasticity));
        let none = || -> Law { Arc::new(Isotropic::lame(dim, 0.0, 0.0, state)) };
        let elasticity =
            raw.elasticity.as_ref().map_or_else(none, |elasticity| self.elasticity(elasticity, dim, state));
        let viscosity = raw.viscosity.as_ref().map_or_else(none, |viscosity| self.viscosity(viscosity, state));
        let expansion = self.expansion(raw, elasticity.as_ref(), state);
        let coupling = raw.coupling.as_ref().map_or(Sym::ZERO, |coupling| self.tensor("coupling", coupling));
        let heat_capacity = raw.heat_capacity.unwrap_or(0.0);
        let conductivity = raw.conductivity.as_ref().map_or(Sym::ZERO, |conductivity| {
            let conductivity = self.tensor("conductivity", conductivity);
            self.check_conductivity(&conductivity, heat_capacity);
            conductivity
        });
        let prony = self.prony(&raw.prony, elasticity.as_ref());
        Material {
            density: raw.density.unwrap_or(0.0),
            heat_capacity,
            elasticity,
            viscosity,
            prony,
            expansion,
            coupling,
            conductivity,
        }
    }

    /// Dimension of the tensors.
    fn dim(&self) -> usize {
        self.mesh.tensor_dim()
    }

    /// How the directions are held that the body lacks; one that lacks none is not told how.
    fn stress_state(&mut self, raw: &Elasticity) -> StressState {
        let (Elasticity::Isotropic { stress_state, .. }
        | Elasticity::Orthotropic { stress_state, .. }
        | Elasticity::Anisotropic { stress_state, .. }
        | Elasticity::VonMisesProjection { stress_state, .. }
        | Elasticity::Hencky { stress_state, .. }) = raw;
        if stress_state.is_some() && self.dim() == 3 {
            let body = if self.mesh.axisymmetric { "a body of revolution" } else { "a body in space" };
            self.note(
                "elasticity.stress_state",
                format!("a stress state of {body}"),
                "one of a plane body or a line",
                Some("remove it"),
            );
        }
        match stress_state.unwrap_or_default() {
            raw::StressState::PlaneStress => StressState::PlaneStress,
            raw::StressState::PlaneStrain => StressState::PlaneStrain,
        }
    }

    /// The law in `dim` dimensions, those of the body or three.
    fn elasticity(&mut self, raw: &Elasticity, dim: usize, state: StressState) -> Law {
        let built = match *raw {
            Elasticity::Isotropic { young, poisson, .. } => {
                self.check_poisson(poisson, state);
                return Arc::new(Isotropic::elastic(dim, young, poisson, state));
            }
            Elasticity::Orthotropic { young, poisson, shear, orientation, .. } => {
                let turned = self.rotation("elasticity.orientation", orientation);
                Linear::orthotropic(&Orthotropic { young, poisson, shear }, &turned, dim, state).map(shared)
            }
            Elasticity::Anisotropic { ref voigt, orientation, .. } => {
                let turned = self.rotation("elasticity.orientation", orientation);
                Linear::new(voigt, &turned, dim, state).map(shared)
            }
            Elasticity::VonMisesProjection { young, poisson, excess, radius, .. } => {
                let (bulk, shear) = (young / (3.0 * (1.0 - 2.0 * poisson)), young / (2.0 * (1.0 + poisson)));
                hencky(bulk, VonMisesProjection::new(shear, excess, radius), dim, state)
            }
            Elasticity::Hencky { bulk, shear, shear_infinite, strain, exponent, .. } => {
                hencky(bulk, Carreau::new(shear, shear_infinite, strain.recip(), exponent), dim, state)
            }
        };
        built.unwrap_or_else(|error| self.refuse("elasticity", &error, dim))
    }

    fn viscosity(&mut self, raw: &Viscosity, state: StressState) -> Law {
        let dim = self.dim();
        let built = match *raw {
            Viscosity::Lame { first, second } => {
                // (H1) on 𝕊^d: the eigenvalues are `second` and d first + second. No viscosity at all is no operator to
                // be monotone.
                let least = dim as f64 * first + second;
                if (first, second) != (0.0, 0.0) && !(second > 0.0 && least > 0.0) {
                    let found =
                        format!("first = {first:?} and second = {second:?}, so {dim}·first + second = {least:?}");
                    let expected = format!("second > 0 and {dim}·first + second > 0, as (H1) asks");
                    self.note(
                        "viscosity",
                        found,
                        expected,
                        Some("set both to 0, or leave out `viscosity`, for no viscosity"),
                    );
                }
                return Arc::new(Isotropic::lame(dim, first, second, state));
            }
            Viscosity::Anisotropic { ref voigt, orientation } => {
                let turned = self.rotation("viscosity.orientation", orientation);
                Linear::new(voigt, &turned, dim, state).map(shared)
            }
            Viscosity::Carreau { bulk, zero, infinite, time, exponent } => {
                hencky(bulk, Carreau::new(zero, infinite, time, exponent), dim, state)
            }
            Viscosity::PowerLaw { bulk, consistency, exponent, threshold, floor } => {
                hencky(bulk, Carreau::power_law(consistency, exponent, threshold, floor), dim, state)
            }
        };
        built.unwrap_or_else(|error| self.refuse("viscosity", &error, dim))
    }

    /// Notes why the numbers make no law; some law stands in.
    fn refuse(&mut self, key: &str, error: &LawError, dim: usize) -> Law {
        let (found, expected) = match error {
            LawError::Range { name, found, expected } => (format!("{name} = {found:?}"), (*expected).to_owned()),
            LawError::NotSymmetric { row, column, found, mirrored } => (
                format!("{found:?} in row {row}, column {column} but {mirrored:?} in row {column}, column {row}"),
                "a symmetric 6 × 6 matrix".to_owned(),
            ),
            LawError::NotPositive { what, least, most } => {
                (format!("a {what} with eigenvalues from {least:.3e} to {most:.3e}"), "all of them positive".to_owned())
            }
            LawError::NotLinear => {
                ("branches besides a law that is not linear".to_owned(), "a linear elasticity".to_owned())
            }
        };
        self.note(key, found, expected, None);
        Arc::new(Isotropic::lame(dim, 0.0, 1.0, StressState::PlaneStress))
    }

    fn prony(&mut self, raw: &[raw::Branch], elasticity: &dyn TensorLaw) -> Option<Prony> {
        let pairs: Vec<(f64, f64)> = raw.iter().map(|branch| (branch.ratio, branch.time)).collect();
        if pairs.is_empty() {
            return None;
        }
        match Prony::ratios(elasticity, &pairs) {
            Ok(prony) => Some(prony),
            Err(error) => {
                self.refuse("prony", &error, self.dim());
                None
            }
        }
    }

    /// Axes of the material; those of a plane body are turned in its plane.
    fn rotation(&mut self, key: &str, raw: Orientation) -> Rotation {
        match raw {
            Orientation::Angle(angle) => Rotation::in_plane(angle),
            Orientation::Euler(angles) => {
                if self.mesh.dim == 1 {
                    self.note(key, "three angles".to_owned(), "one angle: the body is a line", None);
                }
                Rotation::euler(angles)
            }
        }
    }

    fn check_poisson(&mut self, poisson: f64, state: StressState) {
        let dim = self.dim();
        if (dim == 3 || (dim == 2 && state == StressState::PlaneStrain)) && poisson >= 0.5 {
            let hint = "use 0.49 for a nearly incompressible material; incompressible materials are not supported";
            let of = if dim == 3 { "in space" } else { "in plane strain" };
            self.note(
                "elasticity.poisson",
                format!("{poisson:?}"),
                format!("a number > -1 and < 0.5 {of} (Poisson's ratio ν)"),
                Some(hint),
            );
        }
    }

    /// 𝓜 of (2.1), as given or from the coefficients of thermal expansion.
    fn expansion(&mut self, raw: &raw::Material, elasticity: &dyn TensorLaw, state: StressState) -> Sym {
        if let (Some(coefficient), Some(law)) = (raw.expansion_coefficient, &raw.elasticity) {
            if raw.expansion.is_some() {
                let hint = "remove one of the two: 𝓜 = 𝓔α follows from the coefficient";
                self.note(
                    "expansion_coefficient",
                    "`expansion` besides it".to_owned(),
                    "either `expansion` or `expansion_coefficient`",
                    Some(hint),
                );
            }
            return self.thermal_stress(coefficient, law, elasticity, state);
        }
        let Some(given) = &raw.expansion else { return Sym::ZERO };
        let mut expansion = self.tensor("expansion", given);
        if let (Tensor::Multiple(factor), StressState::PlaneStrain, 2) = (given, state, self.dim()) {
            // The body expands in the third direction too; the strain there is held at 0 by σ₃₃.
            expansion.0[3] = *factor;
        }
        expansion
    }

    /// 𝓜 = 𝓔α. With `elasticity` reduced to plane stress that is 𝓔_red α_red: the strain that makes σ₃₃ vanish takes up
    /// α₃₃. Otherwise the strain is that of the plane, so that 𝓜 is the part in the plane, with 33, of the product in
    /// three dimensions.
    fn thermal_stress(
        &mut self,
        coefficient: Expansion,
        raw: &Elasticity,
        elasticity: &dyn TensorLaw,
        state: StressState,
    ) -> Sym {
        let (dim, alpha) = (self.dim(), along_axes(coefficient, raw));
        let is_plane_stress = dim < 3 && state == StressState::PlaneStress;
        if !elasticity.is_linear() && (is_plane_stress || !matches!(coefficient, Expansion::Isotropic(_))) {
            let expected = "one number in space, in plane strain or for a body of revolution: with this law 𝓜 depends on the strain otherwise";
            self.note(
                "expansion_coefficient",
                "a law of elasticity that is not linear".to_owned(),
                expected,
                Some("give `expansion`, the tensor 𝓜"),
            );
            return Sym::ZERO;
        }
        let in_space;
        let law = if is_plane_stress {
            elasticity
        } else {
            in_space = self.elasticity(raw, 3, state);
            in_space.as_ref()
        };
        let mut kept = alpha;
        if is_plane_stress {
            kept.0[mandel_len(dim)..].fill(0.0);
        }
        // A law that is not linear is isotropic, and linear in the change of volume.
        let mut thermal = law.tangent(&[0.0; 3], &Sym::ZERO).apply(&kept);
        let last = match (dim, state) {
            (2, StressState::PlaneStrain) => 4,
            _ => mandel_len(dim),
        };
        thermal.0[last..].fill(0.0);
        self.check_twist("expansion_coefficient", thermal).unwrap_or(Sym::ZERO)
    }

    /// The symmetric tensor that is meant, of a body of revolution by r, z, θ.
    fn tensor(&mut self, key: &str, raw: &Tensor) -> Sym {
        let dim = self.dim();
        match symmetric(raw, dim) {
            Ok(tensor) => self.check_twist(key, tensor),
            Err(found) => {
                self.note(key, found, format!("a number or a symmetric {dim} × {dim} matrix"), None);
                None
            }
        }
        .unwrap_or_else(|| Sym::identity(dim))
    }

    /// The tensor, if a body of revolution can have it: one without the components rθ and zθ.
    fn check_twist(&mut self, key: &str, tensor: Sym) -> Option<Sym> {
        let twist = tensor.get(0, 2).abs().max(tensor.get(1, 2).abs());
        // Round-off of a rotation is no twist.
        if !self.mesh.axisymmetric || twist <= 8.0 * f64::EPSILON * tensor.norm() {
            return Some(tensor);
        }
        self.note(
            key,
            "a component rθ or zθ".to_owned(),
            "a tensor that is the same around the axis of a body of revolution",
            None,
        );
        None
    }

    /// Heat that flows from cold to warm has no solution; a singular 𝓚 breaks (H3) but can be computed with.
    fn check_conductivity(&mut self, k: &Sym, heat_capacity: f64) {
        let eigenvalues = k.eigenvalues(self.dim());
        let (least, most) =
            (eigenvalues.first().copied().unwrap_or_default(), eigenvalues.last().copied().unwrap_or_default());
        if least < -1e-12 * most.abs() {
            self.note(
                "conductivity",
                format!("the eigenvalue {least:?}"),
                "no negative eigenvalue: heat flows from warm to cold",
                None,
            );
        } else if heat_capacity == 0.0 && most <= 0.0 {
            let hint = Some("give one of the two a positive value");
            self.note(
                "conductivity",
                "0 besides heat_capacity 0".to_owned(),
                "a positive conductivity if the heat is steady",
                hint,
            );
        }
    }
}

/// α in the axes of the body.
fn along_axes(coefficient: Expansion, raw: &Elasticity) -> Sym {
    let along = match coefficient {
        Expansion::Isotropic(alpha) => return alpha * Sym::identity(3),
        Expansion::Orthotropic(along) => along,
    };
    let (Elasticity::Orthotropic { orientation, .. } | Elasticity::Anisotropic { orientation, .. }) = raw else {
        return Sym::principal(&along, &Rotation::in_plane(0.0));
    };
    let rotation = match *orientation {
        Orientation::Angle(angle) => Rotation::in_plane(angle),
        Orientation::Euler(angles) => Rotation::euler(angles),
    };
    Sym::principal(&along, &rotation)
}

fn shared(law: Linear) -> Law {
    Arc::new(law)
}

fn hencky<S: ShearLaw + 'static>(
    bulk: f64,
    shear: Result<S, LawError>,
    dim: usize,
    state: StressState,
) -> Result<Law, LawError> {
    Ok(reduced(Hencky::new(bulk, shear?)?, dim, state))
}

/// The symmetric tensor that is meant.
///
/// # Errors
/// What is wrong with its shape or its symmetry.
fn symmetric(raw: &Tensor, dim: usize) -> Result<Sym, String> {
    let rows = match raw {
        Tensor::Multiple(factor) => return Ok(*factor * Sym::identity(dim)),
        Tensor::Matrix(rows) => rows,
    };
    if rows.len() != dim {
        return Err(format!("a matrix of {} rows", rows.len()));
    }
    if let Some((i, row)) = rows.iter().enumerate().find(|(_, row)| row.len() != dim) {
        return Err(format!("a row {} of length {}", i + 1, row.len()));
    }
    let entry = |i: usize, j: usize| rows.get(i).and_then(|row| row.get(j)).copied().unwrap_or_default();
    for i in 0..dim {
        for j in 0..i {
            if (entry(i, j) - entry(j, i)).abs() > 0.0 {
                return Err(format!(
                    "{:?} in row {}, column {} but {:?} in row {}, column {}",
                    entry(j, i),
                    j + 1,
                    i + 1,
                    entry(i, j),
                    i + 1,
                    j + 1
                ));
            }
        }
    }
    Ok(Sym::from_fn(dim, entry))
}
