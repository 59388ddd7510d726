//! A step of bodies that move far: their rigid motion is split off from their deformation.
//!
//! The displacement of a small stiff body that has moved far is the same number at all nodes up to its last digits,
//! and K u of it is the round-off of that number. With u = R + d, R a rigid motion of each body, K u = K d; with the
//! velocity w = W + v likewise, with the rule d₁ = d̄ + σ v and R₁ = R̄ + σ W. Everything that depends on strains
//! sees d and v. On Γ_C the rigid motions are those of the foundation with the opposite sign. After each pass over the
//! body the rigid part of v is put to W, so that the deformation has all its digits in the next one, whatever the
//! acceleration.

use super::bodies::{Bodies, Body};
use super::given::Given;
use super::system::Step;
use crate::contact::Status;
use crate::inclusion::{Frame, PointState};
use crate::linalg::map;
use crate::state::{Carried, Rigid};
use crate::tensor::{Point, dot, length};

/// Sine of the angle between two normals below which they count as parallel to one plane.
const ACROSS: f64 = 1e-6;

/// The motion of a step that splits off rigid motions: u and w with them, and the parts of u.
pub(crate) struct Whole {
    pub u: Vec<f64>,
    pub w: Vec<f64>,
    pub carried: Carried,
    /// The data of the contact points relative to the rigid velocities.
    pub relative: Given,
}

impl Step<'_> {
    /// Removes the rigid motions from velocities and returns them; empty if the step does not split them off.
    pub fn take(&self, w: &mut [f64]) -> Vec<Rigid> {
        let mesh = &self.discrete.mesh;
        self.apart.map_or_else(Vec::new, |apart| apart.bodies.take(mesh.axisymmetric, w))
    }

    /// A field plus rigid motions; unchanged if the step does not split them off.
    pub fn with_rigid(&self, rigid: &[Rigid], field: &[f64]) -> Vec<f64> {
        let mut field = field.to_vec();
        if let Some(apart) = self.apart {
            apart.bodies.add(rigid, 1.0, &mut field);
        }
        field
    }

    /// A field minus rigid motions; unchanged if the step does not split them off.
    pub fn less_rigid(&self, rigid: &[Rigid], field: &[f64]) -> Vec<f64> {
        let mut field = field.to_vec();
        if let Some(apart) = self.apart {
            apart.bodies.add(rigid, -1.0, &mut field);
        }
        field
    }

    /// Displacement and velocity at t_ϑ composed of the rigid velocities W, the deformation, which determines the
    /// strains, and v, and the parts of the displacement at the end of the step; `relative` has the data of the contact
    /// points that belong to v.
    pub fn whole(&self, rigid: &[Rigid], deformation: &[f64], v: &[f64], relative: Given) -> Whole {
        let at_level = self.carried_on(rigid, self.rule.gamma);
        let (u, w) = (self.with_rigid(&at_level, deformation), self.with_rigid(rigid, v));
        let deformation = self.end(self.deformation_before(), deformation.to_vec());
        let carried = Carried { rigid: self.carried_on(rigid, self.rule.span), deformation };
        Whole { u, w, carried, relative }
    }

    /// The rigid velocities, with translations that balance load, contact forces and inertia of each body. The mass of
    /// a small body may be lost in the round-off of its stiffness, so that a factor of K does not contain it. Applies
    /// only to bodies that neither supports nor contact hold; with contact across the normals of the points that press,
    /// if no point sticks.
    pub fn driven(&self, rigid: &[Rigid], v: &[f64], forces: [&[f64]; 2], states: &[PointState]) -> Vec<Rigid> {
        let (rho, form) = self.discrete.inertia();
        let (Some(apart), factor, [load, contact]) = (self.apart, self.rule.inertia(rho) / self.rule.delta, forces)
        else {
            return rigid.to_vec();
        };
        if factor == 0.0 {
            return rigid.to_vec();
        }
        let (w, masses) = (self.with_rigid(rigid, v), form.apply(&vec![1.0; v.len()]));
        let held = self.held_directions(apart.bodies, states);
        let (dim, free) = (apart.bodies.dim, &self.discrete.v.free);
        let of = |((body, rigid), held): ((&Body, &Rigid), &Option<Vec<Point>>)| {
            let dofs = |c: usize| body.nodes.iter().map(move |&node| node as usize * dim + c);
            let Some(held) = held.as_ref().filter(|_| (0..dim).all(|c| dofs(c).all(|i| free[i]))) else {
                return *rigid;
            };
            let unbalanced = |c: usize| {
                let force = |i: usize| contact[i] - load[i] + factor * masses[i] * (w[i] - self.bar.w[i]);
                dofs(c).map(force).sum::<f64>() / (factor * dofs(c).map(|i| masses[i]).sum::<f64>())
            };
            let moves = |c: usize| c < dim && !(self.discrete.mesh.axisymmetric && c == 0);
            let change: Point = std::array::from_fn(|c| if moves(c) { 0.0 - unbalanced(c) } else { 0.0 });
            let change = held.iter().fold(change, |change, direction| less(&change, direction));
            rigid.and(&Rigid { translation: change, rotation: [0.0; 3] })
        };
        apart.bodies.all.iter().zip(rigid).zip(&held).map(of).collect()
    }

    /// Orthonormal directions in which contact holds each body, or `None` if contact holds it in all directions.
    fn held_directions(&self, bodies: &Bodies, states: &[PointState]) -> Vec<Option<Vec<Point>>> {
        let mut held: Vec<Option<Vec<Point>>> = vec![Some(Vec::new()); bodies.all.len()];
        for (point, state) in self.boundary.points.iter().zip(states) {
            if state.status == Status::Open || point.weight == 0.0 {
                continue;
            }
            for &(node, _) in &point.nodes {
                let number = self.boundary.nodes.get(node).and_then(|&node| bodies.of_node[node as usize]);
                let Some(of_body) = number.and_then(|number| held.get_mut(number)) else { continue };
                let Some(directions) = of_body else { continue };
                let across = directions.iter().fold(state.normal, |left, direction| less(&left, direction));
                let size = length(&across);
                if state.status == Status::Stick {
                    *of_body = None;
                } else if size > ACROSS {
                    directions.push(across.map(|c| c / size));
                }
            }
        }
        held
    }

    /// Rigid motions R̄ + γ W at t_ϑ, or R̄ + σ W at the end of the step, by the length γ or σ.
    fn carried_on(&self, rigid: &[Rigid], length: f64) -> Vec<Rigid> {
        let sum = |a: &Point, b: &Point| std::array::from_fn(|c| a[c] + length * b[c]);
        let old = self.apart.into_iter().flat_map(|apart| apart.carried.rigid.iter());
        let both = old.zip(rigid).map(|(old, new)| Rigid {
            translation: sum(&old.translation, &new.translation),
            rotation: sum(&old.rotation, &new.rotation),
        });
        both.collect()
    }

    /// The displacement that determines the strains before the step, or d̄.
    pub fn deformation_before(&self) -> &[f64] {
        self.apart.map_or(&self.old.u, |apart| &apart.carried.deformation)
    }

    /// The displacement that determines the strains, with velocity `v` (minus W if rigid motions are split off): ū + γ
    /// v, or d̄ + γ v.
    pub fn deformed(&self, v: &[f64]) -> Vec<f64> {
        let gamma = self.rule.gamma;
        let before: &[f64] = self.apart.map_or(self.bar.u, |apart| &apart.carried.deformation);
        map([before, v], |[u, v]| u + gamma * v)
    }

    /// The foundation relative to the rigid motions of the bodies: gaps, gap rates and velocities minus those motions.
    pub fn seen_from(&self, frames: &[Frame], rigid: &[Rigid]) -> Vec<Frame> {
        let (dim, size) = (self.discrete.mesh.dim, self.old.u.len());
        let field = |rigid: &[Rigid]| self.with_rigid(rigid, &vec![0.0; size]);
        let (moved, velocity) = (field(&self.carried_on(rigid, self.rule.span)), field(rigid));
        let of = |(point, frame): (_, &Frame)| {
            let [moved, velocity] = [&moved, &velocity].map(|field| self.boundary.vector_at(point, dim, field));
            let along = dot(&velocity, &frame.normal);
            Frame {
                gap: frame.gap - dot(&moved, &frame.normal),
                gap_rate: frame.gap_rate - along,
                velocity: std::array::from_fn(|c| frame.velocity[c] - (velocity[c] - along * frame.normal[c])),
                ..*frame
            }
        };
        self.boundary.points.iter().zip(frames).map(of).collect()
    }
}

/// A vector minus its component along a direction.
fn less(v: &Point, direction: &Point) -> Point {
    let along = dot(v, direction);
    std::array::from_fn(|c| v[c] - along * direction[c])
}
