//! Displacements of bodies that have moved far: their rigid motion apart from their deformation.

use serde::{Deserialize, Serialize};

use super::State;
use crate::tensor::Point;

/// A rigid motion of small angles about the centre c of a body: a + b × (x − c).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Rigid {
    /// a, m or m/s.
    pub translation: Point,
    /// b, in radians or per second.
    pub rotation: Point,
}

impl Rigid {
    /// The sum of two motions.
    pub(crate) fn and(&self, other: &Rigid) -> Rigid {
        let sum = |a: &Point, b: &Point| std::array::from_fn(|c| a[c] + b[c]);
        Rigid {
            translation: sum(&self.translation, &other.translation),
            rotation: sum(&self.rotation, &other.rotation),
        }
    }
}

/// Displacement of a state split into the rigid motion of each body and the deformation; empty if it is not split.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Carried {
    /// Rigid motion R of each body, in the order of the lowest nodes.
    pub rigid: Vec<Rigid>,
    /// d = u − R, m, node-major.
    pub deformation: Vec<f64>,
}

impl Carried {
    /// (4 c₀ − c₋₁)/3 of the parts of two states.
    pub(crate) fn mixed(now: &Carried, before: &Carried) -> Carried {
        let mix = |now: f64, before: f64| (4.0 * now - before) / 3.0;
        let points = |a: &Point, b: &Point| std::array::from_fn(|c| mix(a[c], b[c]));
        let of = |(now, before): (&Rigid, &Rigid)| Rigid {
            translation: points(&now.translation, &before.translation),
            rotation: points(&now.rotation, &before.rotation),
        };
        let deformation = now.deformation.iter().zip(&before.deformation).map(|(now, before)| mix(*now, *before));
        Carried { rigid: now.rigid.iter().zip(&before.rigid).map(of).collect(), deformation: deformation.collect() }
    }
}

impl State {
    /// Displacement that determines the strains: u, or d if rigid motions are split off.
    #[must_use]
    pub fn deformation(&self) -> &[f64] {
        if self.carried.rigid.is_empty() { &self.u } else { &self.carried.deformation }
    }
}
