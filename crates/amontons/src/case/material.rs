//! The materials of a case.

use std::sync::Arc;

use super::path::Path;
use super::place::{At, Finding};
use super::raw::{self, Elasticity, Orientation, Tensor, Viscosity};
use crate::material::{
    Carreau, Hencky, Isotropic, LawError, Linear, Material, Orthotropic, Prony, ShearLaw, StressState, TensorLaw, VonMisesProjection, reduced,
};
use crate::mesh::Mesh;
use crate::tensor::{Rotation, Sym};

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

    fn material(mut self, raw: &raw::Material) -> Material {
        let state = self.stress_state(&raw.elasticity);
        let elasticity = self.elasticity(&raw.elasticity, state);
        let viscosity = self.viscosity(&raw.viscosity, state);
        let expansion = self.expansion(&raw.expansion, state);
        let coupling = self.tensor("coupling", &raw.coupling);
        let conductivity = self.tensor("conductivity", &raw.conductivity);
        self.check_conductivity(&conductivity, raw.heat_capacity);
        let prony = self.prony(&raw.prony, elasticity.as_ref());
        Material { density: raw.density, heat_capacity: raw.heat_capacity, elasticity, viscosity, prony, expansion, coupling, conductivity }
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
            self.note("elasticity.stress_state", format!("a stress state of {body}"), "one of a plane body or a line", Some("drop it"));
        }
        match stress_state.unwrap_or_default() {
            raw::StressState::PlaneStress => StressState::PlaneStress,
            raw::StressState::PlaneStrain => StressState::PlaneStrain,
        }
    }

    fn elasticity(&mut self, raw: &Elasticity, state: StressState) -> Law {
        let dim = self.dim();
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
                // (H1) on 𝕊^d: the eigenvalues are `second` and d first + second. No viscosity at all is no operator to be monotone.
                let least = dim as f64 * first + second;
                if (first, second) != (0.0, 0.0) && !(second > 0.0 && least > 0.0) {
                    let found = format!("first = {first:?} and second = {second:?}, so {dim}·first + second = {least:?}");
                    let expected = format!("second > 0 and {dim}·first + second > 0, as (H1) asks");
                    self.note("viscosity", found, expected, Some("both 0 for no viscosity"));
                }
                return Arc::new(Isotropic::lame(dim, first, second, state));
            }
            Viscosity::Anisotropic { ref voigt, orientation } => {
                let turned = self.rotation("viscosity.orientation", orientation);
                Linear::new(voigt, &turned, dim, state).map(shared)
            }
            Viscosity::Carreau { bulk, zero, infinite, time, exponent } => hencky(bulk, Carreau::new(zero, infinite, time, exponent), dim, state),
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
            LawError::NotSymmetric { row, column, found, mirrored } => {
                (format!("{found:?} in row {row}, column {column} but {mirrored:?} in row {column}, column {row}"), "a symmetric 6 × 6 matrix".to_owned())
            }
            LawError::NotPositive { what, least, most } => {
                (format!("a {what} with eigenvalues from {least:.3e} to {most:.3e}"), "all of them positive".to_owned())
            }
            LawError::NotLinear => ("branches besides a law that is not linear".to_owned(), "a linear elasticity".to_owned()),
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
            let hint = "a nearly incompressible material has 0.49; an incompressible one needs a pressure unknown, which there is not";
            let of = if dim == 3 { "in space" } else { "in plane strain" };
            self.note("elasticity.poisson", format!("{poisson:?}"), format!("a number > -1 and < 0.5 {of} (Poisson's ratio ν)"), Some(hint));
        }
    }

    fn expansion(&mut self, raw: &Tensor, state: StressState) -> Sym {
        let mut expansion = self.tensor("expansion", raw);
        if let (Tensor::Multiple(factor), StressState::PlaneStrain, 2) = (raw, state, self.dim()) {
            // The body expands in the third direction too; the strain there is held at 0 by σ₃₃.
            expansion.0[3] = *factor;
        }
        expansion
    }

    /// The symmetric tensor that is meant, of a body of revolution by r, z, θ.
    fn tensor(&mut self, key: &str, raw: &Tensor) -> Sym {
        let dim = self.dim();
        let around = self.mesh.axisymmetric;
        let built = symmetric(raw, dim).and_then(|tensor| {
            let twists = around && (tensor.get(0, 2), tensor.get(1, 2)) != (0.0, 0.0);
            if twists { Err("a component rθ or zθ, which is not that of a body of revolution".to_owned()) } else { Ok(tensor) }
        });
        built.unwrap_or_else(|found| {
            self.note(key, found, format!("a number or a symmetric {dim} × {dim} matrix"), None);
            Sym::identity(dim)
        })
    }

    /// Heat that flows from cold to warm has no solution; a singular 𝓚 breaks (H3) but can be computed with.
    fn check_conductivity(&mut self, k: &Sym, heat_capacity: f64) {
        let eigenvalues = k.eigenvalues(self.dim());
        let (least, most) = (eigenvalues.first().copied().unwrap_or_default(), eigenvalues.last().copied().unwrap_or_default());
        if least < -1e-12 * most.abs() {
            self.note("conductivity", format!("the eigenvalue {least:?}"), "no negative eigenvalue: heat flows from warm to cold", None);
        } else if heat_capacity == 0.0 && most <= 0.0 {
            let hint = Some("give one of the two a positive value");
            self.note("conductivity", "0 besides heat_capacity 0".to_owned(), "a conductivity where the heat is steady", hint);
        }
    }
}

fn shared(law: Linear) -> Law {
    Arc::new(law)
}

fn hencky<S: ShearLaw + 'static>(bulk: f64, shear: Result<S, LawError>, dim: usize, state: StressState) -> Result<Law, LawError> {
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
                return Err(format!("{:?} in row {}, column {} but {:?} in row {}, column {}", entry(j, i), j + 1, i + 1, entry(i, j), i + 1, j + 1));
            }
        }
    }
    Ok(Sym::from_fn(dim, entry))
}
