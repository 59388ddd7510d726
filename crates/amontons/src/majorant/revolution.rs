//! The complementary energy of a triangle of a body of revolution.
//!
//! The part τ = 2πr σ in the plane of r and z is a plane stress, here the composite one. Its tractions are the forces
//! per length of the ring, and its divergence says what the hoop stress is:
//!
//! ```text
//! div τ + 2πr f − 2πσ_θθ e_r = 0,   2πσ_θθ = 2πr f_r + (div τ)_r.
//! ```
//!
//! So σ is in balance if the divergence along the axis vanishes, as it does without a body force along the axis. The
//! energy ∫ ½ X:C⁻¹:X /(2πr), X = 2πr (σ̂ − σ_h), has polynomials but for 1/r, which is convex: with the linear
//! functions of the vertices 1/r ≤ Σ λ_v/r_v. With that, which is at least the energy, it is integrated exactly.

use std::f64::consts::TAU;

use super::composite::volume;
use super::simplex::{Deviation, ReferenceStresses, SimplexForm};
use super::stress::LocalCompliance;
use crate::tensor::{Point, Sym};

/// What is known at a point of a triangle: stress, compliance, and the body force along the radius.
pub(super) type KnownPoint = (Sym, LocalCompliance, f64);

/// A triangle with its distance from the axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct RevolvedTriangle {
    /// Distances of the vertices from the axis, m.
    radii: [f64; 3],
}

impl RevolvedTriangle {
    /// The triangle with these vertices, none of them on the axis.
    pub fn new(vertices: &[Point]) -> RevolvedTriangle {
        RevolvedTriangle { radii: std::array::from_fn(|v| vertices[v][0]) }
    }

    /// The distance from the axis, and what is at least its inverse, at a point.
    fn radius(&self, in_simplex: &[f64]) -> (f64, f64) {
        let sum = |of: &dyn Fn(f64) -> f64| -> f64 { in_simplex.iter().zip(self.radii).map(|(a, r)| a * of(r)).sum() };
        (sum(&|r| r), sum(&f64::recip))
    }

    /// 2πr σ for a unit of each datum of the reference triangle.
    fn stresses(&self, form: &SimplexForm, stresses: &ReferenceStresses, q: usize) -> (Vec<Sym>, f64, f64) {
        let (r, inverse) = self.radius(&stresses.points[q].in_simplex);
        let all = stresses.fields(q).map(|(field, divergence)| {
            let mut stress = form.map.stress(&field);
            // Component 33 has the place and the weight of a normal stress.
            stress.0[3] = r * form.map.piola(divergence)[0];
            stress
        });
        (all.collect(), r, inverse)
    }

    /// The form on the triangle.
    pub fn form(
        &self,
        stresses: &ReferenceStresses,
        vertices: &[Point],
        compliance: &[LocalCompliance],
    ) -> SimplexForm {
        let mut form = SimplexForm::empty(stresses, vertices, 1.0);
        let area = volume(2) * form.map.determinant;
        let size = ReferenceStresses::data(2);
        let mut packed = vec![0.0; size * (size + 1) / 2];
        for (q, (point, compliance)) in stresses.points.iter().zip(compliance).enumerate() {
            let (fields, _, inverse) = self.stresses(&form, stresses, q);
            let weight = point.weight * area * inverse / TAU;
            let mut places = packed.iter_mut();
            for (i, field) in fields.iter().enumerate() {
                let strain = weight * compliance.times(field);
                for (other, sum) in fields[..=i].iter().zip(&mut places) {
                    *sum += strain.dot(other);
                }
            }
        }
        form.fill(&packed);
        form
    }

    /// What a stress has beside the one with its moments, by the places of the composite element, and its integral.
    pub fn deviation(
        &self,
        form: &SimplexForm,
        stresses: &ReferenceStresses,
        (moments, total): (&[Point], &Sym),
        mut at: impl FnMut(usize) -> KnownPoint,
    ) -> Deviation {
        let data = form.data(moments, total);
        let area = volume(2) * form.map.determinant;
        let mut deviation = Deviation { slopes: vec![0.0; data.len()], energy: 0.0 };
        for (q, point) in stresses.points.iter().enumerate() {
            let (fields, r, inverse) = self.stresses(form, stresses, q);
            let (stress, compliance, force) = at(q);
            let mut off = fields.iter().zip(&data).fold((TAU * r) * stress, |sum, (field, x)| sum - *x * *field);
            off.0[3] -= TAU * r * r * force;
            let strain = compliance.times(&off);
            let weight = point.weight * area * inverse / TAU;
            deviation.energy += 0.5 * weight * off.dot(&strain);
            for (slope, field) in deviation.slopes.iter_mut().zip(&fields) {
                *slope -= weight * field.dot(&strain);
            }
        }
        deviation
    }
}
