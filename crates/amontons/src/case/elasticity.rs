//! The laws of elasticity and viscosity of a case, with their coefficients.

use std::sync::Arc;

use super::coefficient::Refusal;
use super::raw::{Coefficient, Elasticity, Orientation, Viscosity};
use crate::material::{
    Carreau, Hencky, Isotropic, LawError, Linear, OrthotropicConstants, ShearLaw, StressState, TensorLaw,
    VonMisesProjection, reduced,
};
use crate::tensor::Rotation;

pub(super) type ElasticLaw = Arc<dyn TensorLaw>;

/// Dimensions of the body and of the law, and the stress state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dimensions {
    pub body: usize,
    pub dim: usize,
    pub state: StressState,
}

/// Coefficients with their keys below the material.
type KeyedModuli<'a> = Vec<(String, &'a Coefficient)>;

/// Function that makes a law of the values of its coefficients.
type MakeElastic = Box<dyn Fn(&[f64]) -> Result<ElasticLaw, Refusal> + Send + Sync>;

fn keyed<'a>(law: &str, coefficients: &[(&str, &'a Coefficient)]) -> KeyedModuli<'a> {
    coefficients.iter().map(|(key, coefficient)| (format!("{law}.{key}"), *coefficient)).collect()
}

fn triple<'a>(law: &str, key: &str, coefficients: &'a [Coefficient; 3]) -> KeyedModuli<'a> {
    coefficients.iter().enumerate().map(|(i, coefficient)| (format!("{law}.{key}[{i}]"), coefficient)).collect()
}

fn matrix<'a>(law: &str, rows: &'a [[Coefficient; 6]; 6]) -> KeyedModuli<'a> {
    let row = |(i, row): (usize, &'a [Coefficient; 6])| {
        row.iter().enumerate().map(|(j, entry)| (format!("{law}.voigt[{i}][{j}]"), entry)).collect::<Vec<_>>()
    };
    rows.iter().enumerate().flat_map(row).collect()
}

/// The number of the first angle among the coefficients of a law that has an orientation.
pub(super) fn angles_from(raw: &Elasticity) -> Option<usize> {
    match raw {
        Elasticity::Orthotropic { .. } => Some(9),
        Elasticity::Anisotropic { .. } => Some(36),
        _ => None,
    }
}

/// The angles of an orientation.
fn angles<'a>(key: &str, orientation: &'a Orientation) -> KeyedModuli<'a> {
    match orientation {
        Orientation::Angle(angle) => vec![(key.to_owned(), angle)],
        Orientation::Euler(angles) => {
            angles.iter().enumerate().map(|(i, angle)| (format!("{key}[{i}]"), angle)).collect()
        }
    }
}

/// The rotation by one angle in the plane or by three Euler angles.
pub(super) fn rotation(angles: &[f64]) -> Rotation {
    match *angles {
        [first, second, third] => Rotation::euler([first, second, third]),
        _ => Rotation::in_plane(angles.first().copied().unwrap_or_default()),
    }
}

/// The coefficients of an elasticity, in the order in which [`elastic_law`] takes their values.
pub(super) fn elastic_coefficients(raw: &Elasticity) -> KeyedModuli<'_> {
    let law = "elasticity";
    match raw {
        Elasticity::Isotropic { young, poisson, .. } => keyed(law, &[("young", young), ("poisson", poisson)]),
        Elasticity::Orthotropic { young, poisson, shear, orientation, .. } => {
            let mut all = triple(law, "young", young);
            all.extend(triple(law, "poisson", poisson));
            all.extend(triple(law, "shear", shear));
            all.extend(angles("elasticity.orientation", orientation));
            all
        }
        Elasticity::Anisotropic { voigt, orientation, .. } => {
            let mut all = matrix(law, voigt);
            all.extend(angles("elasticity.orientation", orientation));
            all
        }
        Elasticity::VonMisesProjection { young, poisson, excess, radius, .. } => {
            keyed(law, &[("young", young), ("poisson", poisson), ("excess", excess), ("radius", radius)])
        }
        Elasticity::Hencky { bulk, shear, shear_infinite, strain, exponent, .. } => keyed(
            law,
            &[
                ("bulk", bulk),
                ("shear", shear),
                ("shear_infinite", shear_infinite),
                ("strain", strain),
                ("exponent", exponent),
            ],
        ),
    }
}

/// The elasticity for the values of its coefficients.
pub(super) fn elastic_law(raw: &Elasticity, shape: Dimensions) -> MakeElastic {
    let Dimensions { dim, state, .. } = shape;
    match raw {
        Elasticity::Isotropic { .. } => Box::new(move |v| {
            check_poisson(v[1], shape)?;
            Ok(Arc::new(Isotropic::elastic(dim, v[0], v[1], state)))
        }),
        Elasticity::Orthotropic { .. } => Box::new(move |v| {
            let constants = OrthotropicConstants { young: three(v), poisson: three(&v[3..]), shear: three(&v[6..]) };
            shared(Linear::orthotropic(&constants, &rotation(&v[9..]), dim, state))
        }),
        Elasticity::Anisotropic { .. } => {
            Box::new(move |v| shared(Linear::new(&six_by_six(v), &rotation(&v[36..]), dim, state)))
        }
        Elasticity::VonMisesProjection { .. } => Box::new(move |v| {
            let (young, poisson) = (v[0], v[1]);
            let (bulk, shear) = (young / (3.0 * (1.0 - 2.0 * poisson)), young / (2.0 * (1.0 + poisson)));
            hencky(bulk, VonMisesProjection::new(shear, v[2], v[3]), shape)
        }),
        Elasticity::Hencky { .. } => {
            Box::new(move |v| hencky(v[0], Carreau::new(v[1], v[2], v[3].recip(), v[4]), shape))
        }
    }
}

/// The coefficients of a viscosity, in the order in which [`viscous_law`] takes their values.
pub(super) fn viscous_coefficients(raw: &Viscosity) -> KeyedModuli<'_> {
    let law = "viscosity";
    match raw {
        Viscosity::Lame { first, second } => keyed(law, &[("first", first), ("second", second)]),
        Viscosity::Anisotropic { voigt, orientation } => {
            let mut all = matrix(law, voigt);
            all.extend(angles("viscosity.orientation", orientation));
            all
        }
        Viscosity::Carreau { bulk, zero, infinite, time, exponent } => keyed(
            law,
            &[("bulk", bulk), ("zero", zero), ("infinite", infinite), ("time", time), ("exponent", exponent)],
        ),
        Viscosity::PowerLaw { bulk, consistency, exponent, threshold, floor } => keyed(
            law,
            &[
                ("bulk", bulk),
                ("consistency", consistency),
                ("exponent", exponent),
                ("threshold", threshold),
                ("floor", floor),
            ],
        ),
    }
}

/// The viscosity for the values of its coefficients.
pub(super) fn viscous_law(raw: &Viscosity, shape: Dimensions) -> MakeElastic {
    let Dimensions { dim, state, .. } = shape;
    match raw {
        Viscosity::Lame { .. } => Box::new(move |v| {
            check_lame(v[0], v[1], dim)?;
            Ok(Arc::new(Isotropic::lame(dim, v[0], v[1], state)))
        }),
        Viscosity::Anisotropic { .. } => {
            Box::new(move |v| shared(Linear::new(&six_by_six(v), &rotation(&v[36..]), dim, state)))
        }
        Viscosity::Carreau { .. } => Box::new(move |v| hencky(v[0], Carreau::new(v[1], v[2], v[3], v[4]), shape)),
        Viscosity::PowerLaw { .. } => {
            Box::new(move |v| hencky(v[0], Carreau::power_law(v[1], v[2], v[3], v[4]), shape))
        }
    }
}

fn three(values: &[f64]) -> [f64; 3] {
    std::array::from_fn(|i| values.get(i).copied().unwrap_or_default())
}

fn six_by_six(values: &[f64]) -> [[f64; 6]; 6] {
    std::array::from_fn(|i| std::array::from_fn(|j| values.get(6 * i + j).copied().unwrap_or_default()))
}

fn shared(law: Result<Linear, LawError>) -> Result<ElasticLaw, Refusal> {
    law.map(|law| Arc::new(law) as ElasticLaw).map_err(|error| refusal(&error))
}

fn hencky<S: ShearLaw + 'static>(
    bulk: f64,
    shear: Result<S, LawError>,
    shape: Dimensions,
) -> Result<ElasticLaw, Refusal> {
    let law = shear.and_then(|shear| Hencky::new(bulk, shear)).map_err(|error| refusal(&error))?;
    Ok(reduced(law, shape.dim, shape.state))
}

fn check_poisson(poisson: f64, shape: Dimensions) -> Result<(), Refusal> {
    let Dimensions { body, state, .. } = shape;
    if (body == 3 || (body == 2 && state == StressState::PlaneStrain)) && poisson >= 0.5 {
        let of = if body == 3 { "in space" } else { "in plane strain" };
        return Err(Refusal {
            key: "poisson",
            found: format!("{poisson:?}"),
            expected: format!("a number > -1 and < 0.5 {of} (Poisson's ratio ν)"),
            hint: Some("use 0.49 for a nearly incompressible material; incompressible materials are not supported"),
        });
    }
    Ok(())
}

/// Checks (H1) on 𝕊^d: the eigenvalues are `second` and d first + second. Zero viscosity need not be monotone.
fn check_lame(first: f64, second: f64, dim: usize) -> Result<(), Refusal> {
    let least = dim as f64 * first + second;
    if (first, second) == (0.0, 0.0) || (second > 0.0 && least > 0.0) {
        return Ok(());
    }
    Err(Refusal {
        key: "",
        found: format!("first = {first:?} and second = {second:?}, so {dim}·first + second = {least:?}"),
        expected: format!("second > 0 and {dim}·first + second > 0, as (H1) asks"),
        hint: Some("set both to 0, or leave out `viscosity`, for no viscosity"),
    })
}

/// The reason why numbers give no law.
pub(super) fn refusal(error: &LawError) -> Refusal {
    match error {
        LawError::Range { name, found, expected } => Refusal::new(format!("{name} = {found:?}"), *expected),
        LawError::NotSymmetric { row, column, found, mirrored } => Refusal::new(
            format!("{found:?} in row {row}, column {column} but {mirrored:?} in row {column}, column {row}"),
            "a symmetric 6 × 6 matrix",
        ),
        LawError::NotPositive { what, least, most } => {
            Refusal::new(format!("a {what} with eigenvalues from {least:.3e} to {most:.3e}"), "all of them positive")
        }
        LawError::NotLinear => Refusal::new("branches besides a law that is not linear", "a linear elasticity"),
    }
}
