//! The material of a case.

use std::sync::Arc;

use super::path::Path;
use super::place::{At, Finding};
use super::raw::{self, Elasticity, Tensor, Viscosity};
use crate::material::{Isotropic, Material, StressState};
use crate::tensor::Sym;

/// Builds the material of a body in `dim` dimensions; what is wrong with it goes to the findings.
pub(super) fn material(raw: &raw::Material, dim: usize, findings: &mut Vec<Finding>) -> Material {
    let mut note = |path: &str, found: String, expected: String, hint: Option<&str>| {
        let path = Path::parse(&format!("material.{path}")).unwrap_or_default();
        findings.push(Finding::new(path, At::Value, found, expected).hint(hint.map(str::to_owned)));
    };
    let Elasticity::Isotropic { young, poisson, stress_state } = raw.elasticity;
    let state = match stress_state {
        raw::StressState::PlaneStress => StressState::PlaneStress,
        raw::StressState::PlaneStrain => StressState::PlaneStrain,
    };
    if state == StressState::PlaneStrain && poisson >= 0.5 {
        let hint = "a nearly incompressible material has 0.49; an incompressible one needs a pressure unknown, which there is not";
        let expected = "a number > -1 and < 0.5 in plane strain (Poisson's ratio ν)".to_owned();
        note("elasticity.poisson", format!("{poisson:?}"), expected, Some(hint));
    }
    let Viscosity::Lame { first, second } = raw.viscosity;
    // (H1) on 𝕊^d: the eigenvalues are `second` and d first + second. No viscosity at all is no operator to be monotone.
    let least = dim as f64 * first + second;
    if (first, second) != (0.0, 0.0) && !(second > 0.0 && least > 0.0) {
        let found = format!("first = {first:?} and second = {second:?}, so {dim}·first + second = {least:?}");
        let expected = format!("second > 0 and {dim}·first + second > 0, as (H1) asks");
        note("viscosity", found, expected, Some("both 0 for no viscosity"));
    }
    let mut tensor = |key: &str, raw: &Tensor| {
        symmetric(raw, dim).unwrap_or_else(|found| {
            note(key, found, format!("a number or a symmetric {dim} × {dim} matrix"), None);
            Sym::identity(dim)
        })
    };
    let mut expansion = tensor("expansion", &raw.expansion);
    if let (Tensor::Multiple(factor), StressState::PlaneStrain, 2) = (&raw.expansion, state, dim) {
        // The body expands in the third direction too; the strain there is held at 0 by σ₃₃.
        expansion.0[3] = *factor;
    }
    let coupling = tensor("coupling", &raw.coupling);
    let conductivity = tensor("conductivity", &raw.conductivity);
    check_conductivity(&conductivity, raw.heat_capacity, dim, note);
    Material {
        density: raw.density,
        heat_capacity: raw.heat_capacity,
        elasticity: Arc::new(Isotropic::elastic(dim, young, poisson, state)),
        viscosity: Arc::new(Isotropic::lame(dim, first, second, state)),
        prony: None,
        expansion,
        coupling,
        conductivity,
    }
}

/// Heat that flows from cold to warm has no solution; a singular 𝓚 breaks (H3) but can be computed with.
fn check_conductivity(k: &Sym, heat_capacity: f64, dim: usize, mut note: impl FnMut(&str, String, String, Option<&str>)) {
    let eigenvalues = k.eigenvalues(dim);
    let (least, most) = (eigenvalues.first().copied().unwrap_or_default(), eigenvalues.last().copied().unwrap_or_default());
    if least < -1e-12 * most.abs() {
        let expected = "no negative eigenvalue: heat flows from warm to cold".to_owned();
        note("conductivity", format!("the eigenvalue {least:?}"), expected, None);
    } else if heat_capacity == 0.0 && most <= 0.0 {
        let expected = "a conductivity where the heat is steady".to_owned();
        note("conductivity", "0 besides heat_capacity 0".to_owned(), expected, Some("give one of the two a positive value"));
    }
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
