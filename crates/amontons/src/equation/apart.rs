//! Bodies that move far: their rigid motion is split off from their deformation.
//!
//! The displacement of a small stiff body that has moved far is the same number at all nodes up to its last digits,
//! and K u of it is the round-off of that number. With u = R + d, R a rigid motion of each body, K u = K d; with the
//! velocity w = W + v likewise, d_n = d_{n−1} + k v_n and R_n = R_{n−1} + k W_n. Everything that depends on strains
//! sees d and v. On Γ_C the rigid motions are those of the foundation with the opposite sign. After each pass over the
//! body the rigid part of v is put to W, so that the deformation has all its digits in the next one, whatever the
//! acceleration.

use super::given::Given;
use super::system::Step;
use crate::contact::Status;
use crate::inclusion::{Frame, PointState};
use crate::linalg::map;
use crate::mesh::Mesh;
use crate::mesh::defects::components;
use crate::problem::Problem;
use crate::state::{Carried, Rigid};
use crate::tensor::{Point, dot, length};

/// Fraction of the moments of a body below which its nodes count as collinear, so that it does not rotate about their
/// line.
const FLAT: f64 = 1e-9;
/// Sine of the angle between two normals below which they count as parallel to one plane.
const ACROSS: f64 = 1e-6;

/// The bodies of a mesh, whose rigid motions have no strain.
#[derive(Debug)]
pub(crate) struct Bodies {
    dim: usize,
    all: Vec<Body>,
    /// The body of each node, or `None` for a node without cells.
    of_node: Vec<Option<usize>>,
}

#[derive(Debug)]
struct Body {
    nodes: Vec<u32>,
    /// x − c of each node, and the inverse of Σ (|x − c|² 1 − (x − c)(x − c)ᵀ); zero if the body does not rotate.
    arms: Vec<Point>,
    inverse: [Point; 3],
}

impl Bodies {
    /// The bodies of a mesh, or `None` if a law is not linear, or if rigid motions cause forces (springs, dashpots) or
    /// are not those of the mesh (sectors, whose nodes follow each other rotated; rigid bodies).
    pub fn new(problem: &Problem, mesh: &Mesh, is_linear: bool) -> Option<Bodies> {
        let is_free = problem.boundary.iter().all(|b| b.spring.is_none() && b.dashpot.is_none());
        if !is_linear || !is_free || !problem.cyclic.is_empty() || !problem.rigid.is_empty() {
            return None;
        }
        let turns = mesh.dim > 1 && !mesh.axisymmetric;
        let of = |nodes: Vec<u32>| {
            let n = nodes.len().max(1) as f64;
            let x = |node: &u32| mesh.points[*node as usize];
            let centre: Point = std::array::from_fn(|c| nodes.iter().map(|node| x(node)[c]).sum::<f64>() / n);
            let arm = |node: &u32| -> Point { std::array::from_fn(|c| x(node)[c] - centre[c]) };
            let arms: Vec<Point> = nodes.iter().map(arm).collect();
            let inverse = if turns { inverse(&arms, mesh.dim) } else { [[0.0; 3]; 3] };
            Body { nodes, arms, inverse }
        };
        let all: Vec<Body> = components(mesh).into_iter().map(|part| of(part.nodes)).collect();
        let mut of_node = vec![None; mesh.points.len()];
        for (number, body) in all.iter().enumerate() {
            body.nodes.iter().for_each(|&node| of_node[node as usize] = Some(number));
        }
        Some(Bodies { dim: mesh.dim, all, of_node })
    }

    /// Removes from a field the rigid motion of each body that is nearest to it in the mean square over the nodes, and
    /// returns it. A body of revolution moves along its axis only.
    pub fn take(&self, is_axisymmetric: bool, v: &mut [f64]) -> Vec<Rigid> {
        let all = self.all.iter().map(|body| {
            let at = |node: u32| -> Point {
                std::array::from_fn(|c| if c < self.dim { v[node as usize * self.dim + c] } else { 0.0 })
            };
            let n = body.nodes.len().max(1) as f64;
            let moves = |c: usize| c < self.dim && !(is_axisymmetric && c == 0);
            let mean = |c: usize| body.nodes.iter().map(|&node| at(node)[c]).sum::<f64>() / n;
            let translation: Point = std::array::from_fn(|c| if moves(c) { mean(c) } else { 0.0 });
            let moment = body.nodes.iter().zip(&body.arms).fold([0.0; 3], |sum: Point, (&node, arm)| {
                let v = at(node);
                let turn = cross(arm, &std::array::from_fn(|c| v[c] - translation[c]));
                std::array::from_fn(|c| sum[c] + turn[c])
            });
            let rotation = std::array::from_fn(|c| dot(&body.inverse[c], &moment));
            Rigid { translation, rotation }
        });
        let all: Vec<Rigid> = all.collect();
        self.add(&all, -1.0, v);
        all
    }

    /// Adds a multiple of rigid motions to a field.
    pub fn add(&self, rigid: &[Rigid], factor: f64, field: &mut [f64]) {
        for (body, Rigid { translation, rotation }) in self.all.iter().zip(rigid) {
            for (&node, arm) in body.nodes.iter().zip(&body.arms) {
                let turned = cross(rotation, arm);
                for c in 0..self.dim {
                    field[node as usize * self.dim + c] += factor * (translation[c] + turned[c]);
                }
            }
        }
    }
}

/// The motion of a step that splits off rigid motions: u and w with them, and the parts of u.
pub(crate) struct Whole {
    pub u: Vec<f64>,
    pub w: Vec<f64>,
    pub carried: Carried,
    /// The data of the contact points relative to the rigid velocities.
    pub relative: Given,
}

/// Bodies and split displacement of a step that splits off rigid motions.
#[derive(Clone, Copy)]
pub(crate) struct Apart<'a> {
    pub bodies: &'a Bodies,
    pub carried: &'a Carried,
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

    /// Displacement and velocity composed of the rigid velocities W, the deformation, which determines the strains, and
    /// v; `relative` has the data of the contact points that belong to v.
    pub fn whole(&self, rigid: &[Rigid], deformation: &[f64], v: &[f64], relative: Given) -> Whole {
        let moved = self.carried_on(rigid);
        let (u, w) = (self.with_rigid(&moved, deformation), self.with_rigid(rigid, v));
        Whole { u, w, carried: Carried { rigid: moved, deformation: deformation.to_vec() }, relative }
    }

    /// The rigid velocities, with translations that balance load, contact forces and inertia of each body. The mass of
    /// a small body may be lost in the round-off of its stiffness, so that a factor of K does not contain it. Applies
    /// only to bodies that neither supports nor contact hold; with contact across the normals of the points that press,
    /// if no point sticks.
    pub fn driven(&self, rigid: &[Rigid], v: &[f64], forces: [&[f64]; 2], states: &[PointState]) -> Vec<Rigid> {
        let (rho, form) = self.discrete.inertia();
        let (Some(apart), factor, [load, contact]) = (self.apart, rho / self.rule.delta, forces) else {
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

    /// Rigid motions at t_ϑ: R_{n−1} + γ W.
    pub fn carried_on(&self, rigid: &[Rigid]) -> Vec<Rigid> {
        let gamma = self.rule.gamma;
        let sum = |a: &Point, b: &Point| std::array::from_fn(|c| a[c] + gamma * b[c]);
        let old = self.apart.into_iter().flat_map(|apart| apart.carried.rigid.iter());
        let both = old.zip(rigid).map(|(old, new)| Rigid {
            translation: sum(&old.translation, &new.translation),
            rotation: sum(&old.rotation, &new.rotation),
        });
        both.collect()
    }

    /// The displacement before the step that determines the strains.
    pub fn deformation_before(&self) -> &[f64] {
        self.apart.map_or(&self.old.u, |apart| &apart.carried.deformation)
    }

    /// The displacement that determines the strains, with velocity `v` (minus W if rigid motions are split off): ū + γ
    /// v, or d_{n−1} + γ v.
    pub fn deformed(&self, v: &[f64]) -> Vec<f64> {
        let gamma = self.rule.gamma;
        let before: &[f64] = self.apart.map_or(self.bar.u, |apart| &apart.carried.deformation);
        map([before, v], |[u, v]| u + gamma * v)
    }

    /// The foundation relative to the rigid motions of the bodies: gaps, gap rates and velocities minus those motions.
    pub fn seen_from(&self, frames: &[Frame], rigid: &[Rigid]) -> Vec<Frame> {
        let (dim, size) = (self.discrete.mesh.dim, self.old.u.len());
        let field = |rigid: &[Rigid]| self.with_rigid(rigid, &vec![0.0; size]);
        let (moved, velocity) = (field(&self.carried_on(rigid)), field(rigid));
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

fn cross(a: &Point, b: &Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The inverse of the moments of a body; zero if its nodes lie on a line. A plane body rotates about the last axis
/// only.
fn inverse(arms: &[Point], dim: usize) -> [Point; 3] {
    let mut moments = [[0.0; 3]; 3];
    for arm in arms {
        let squared = dot(arm, arm);
        for (a, row) in moments.iter_mut().enumerate() {
            for (b, entry) in row.iter_mut().enumerate() {
                *entry += if a == b { squared } else { 0.0 } - arm[a] * arm[b];
            }
        }
    }
    let mut inverse = [[0.0; 3]; 3];
    if dim < 3 {
        inverse[2][2] = if moments[2][2] > 0.0 { moments[2][2].recip() } else { 0.0 };
        return inverse;
    }
    let [a, b, c] = moments;
    let columns = [cross(&b, &c), cross(&c, &a), cross(&a, &b)];
    let determinant = dot(&a, &columns[0]);
    let size = moments[0][0] + moments[1][1] + moments[2][2];
    if determinant > FLAT * size.powi(3) {
        // The matrix is symmetric.
        inverse = columns.map(|column| column.map(|entry| entry / determinant));
    }
    inverse
}
