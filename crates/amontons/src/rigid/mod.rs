//! Motions without strain of the parts of a body: those that supports allow, and their description in words.
//!
//! A part connected by common nodes moves without strain as v(x) = s + ω × (x − c). Supports, springs and dashpots
//! prevent some of these motions; inertia determines all. The remaining ones are held by contact or not at all.

mod doubt;
mod free;
mod words;

use crate::mesh::defects::components;
use crate::mesh::{Mesh, cross};
use crate::problem::Problem;
use crate::tensor::Point;

pub use doubt::doubts;
pub use free::{free_motions, supported};
pub use words::described;

/// A motion without strain of one part of a body: v(x) = s + ω × (x − c).
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Number of the part, in the order of [`components`].
    pub part: usize,
    /// s, the velocity of the centre.
    pub shift: Point,
    /// ω, the rate of turning.
    pub turn: Point,
    /// c, the middle of the bounding box of the part, m.
    pub centre: Point,
}

impl Motion {
    /// v(x).
    #[must_use]
    pub fn at(&self, x: &Point) -> Point {
        let arm: Point = std::array::from_fn(|c| x[c] - self.centre[c]);
        let turned = cross(&self.turn, &arm);
        std::array::from_fn(|c| self.shift[c] + turned[c])
    }

    /// The weighted sum of motions of one part; `None` if there are no terms.
    #[must_use]
    pub fn sum<'a>(terms: impl IntoIterator<Item = (f64, &'a Motion)>) -> Option<Motion> {
        terms.into_iter().fold(None, |sum, (factor, motion)| {
            let sum = sum.unwrap_or(Motion { shift: [0.0; 3], turn: [0.0; 3], ..motion.clone() });
            let shift = std::array::from_fn(|c| sum.shift[c] + factor * motion.shift[c]);
            let turn = std::array::from_fn(|c| sum.turn[c] + factor * motion.turn[c]);
            Some(Motion { shift, turn, ..sum })
        })
    }
}

/// The motions that only contact can hold: those of parts without inertia that supports, springs and dashpots allow.
/// Motions of one part are independent and of the same size.
#[must_use]
pub fn floating(problem: &Problem) -> Vec<Motion> {
    if problem.contacts.is_empty() {
        return Vec::new();
    }
    let parts = components(&problem.mesh);
    let inert = inert(problem, parts.len());
    let held = supported(problem, true);
    let space = problem.displacement_space();
    let loose = parts.iter().enumerate().filter(|(number, _)| !inert[*number]);
    loose.flat_map(|(number, part)| free_motions(&problem.mesh, &space, &held, (number, part))).collect()
}

/// For each part, true if it has inertia somewhere.
fn inert(problem: &Problem, parts: usize) -> Vec<bool> {
    let mesh: &Mesh = &problem.mesh;
    let mut part_of = vec![0; mesh.points.len()];
    for (number, part) in components(mesh).iter().enumerate() {
        part.nodes.iter().for_each(|&node| part_of[node as usize] = number);
    }
    let mut inert = vec![false; parts];
    for block in &mesh.blocks {
        let Some(material) = problem.material_of(block.region) else { continue };
        for cell in block.cells() {
            let has = |node: &u32| mesh.points.get(*node as usize).is_some_and(|x| material.density.at(x) > 0.0);
            let part = cell.first().and_then(|node| part_of.get(*node as usize)).and_then(|part| inert.get_mut(*part));
            if let Some(part) = part.filter(|part| !**part) {
                *part = cell.iter().any(has);
            }
        }
    }
    inert
}
