//! Rigid motions on Γ_C: which of them the points of contact resist, and what holds the others.
//!
//! A part without inertia and supports has motions without strain, which S does not resist: S z = 0. At an iterate
//! contact resists those along which a closed point would move, and the others make S + J singular. With the motions
//! a_k, orthonormal on the contact nodes, that are left,
//!
//! ```text
//!     A = Σ_i Σ_d (d·N_i Z)ᵀ (d·N_i Z),       a resisted motion has aᵀ A a > 0,
//! ```
//!
//! d the directions in which the point i resists. Each motion that is left is held by a spring of its own, v vᵀ α on
//! the unknowns, with α the mean stiffness of S over it: where nothing loads the motion, the spring bears nothing, and
//! the solution of the system is that of least motion.
//!
//! A curved side is known as well as its facets are: the motion of a shaft about its axis moves its points along their
//! normals by the angle between these and the facets. A motion that moves all points by no more than that is not
//! resisted either. It takes the spring in the equations as well, whose force is of the order of that angle.

use std::sync::Arc;

use faer::{Mat, Side};

use super::interface::{Interface, Local};
use super::point::Laws;
use crate::contact::{Contact, ContactBoundary, Pair, PointOnBoundary};
use crate::linalg::Spring;
use crate::mesh::Mesh;
use crate::rigid::{Motion, doubts};
use crate::space::rigid::rigid_of;
use crate::space::{RigidNodes, Space};
use crate::tensor::{Point, dot, length};

/// Share of A below which a motion may be one that is not resisted, and of a motion below which a point does not move.
const CANDIDATE: f64 = 1e-10;
const STILL: f64 = 1e-6;
/// Largest resisted part of a motion that counts as free, in multiples of the uncertainty due to the mesh.
pub(super) const DOUBTFUL: f64 = 2.0;
/// Stiffness of a point, relative to the largest of its tangent, below which it resists nothing.
const RESISTS: f64 = 1e-9;

/// The rigid motions of the parts that nothing but contact holds, on the unknowns that are kept.
#[derive(Clone, Debug, Default)]
pub struct Loose {
    /// The motions, orthonormal on the contact nodes.
    pub motions: Vec<Motion>,
    /// Their values at the unknowns of the contact nodes, in the directions of these.
    columns: Vec<Vec<(u32, f64)>>,
    /// The part of each contact node, where it is, and how well its normal is known.
    nodes: Vec<Node>,
    /// The part of each node of the mesh, and the first and the number of the motions of each part.
    parts: Vec<u32>,
    of_part: Vec<[usize; 2]>,
    /// Number of unknowns of the contact nodes.
    unknowns: usize,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    x: Point,
    /// The first of the motions of its part, and how many they are.
    first: usize,
    count: usize,
    doubt: f64,
}

impl Loose {
    /// The motions of `floating` at the contact nodes; `unknown` is as in [`super::MechanicalStep`].
    #[must_use]
    pub fn new(
        mesh: &Mesh,
        boundary: &ContactBoundary,
        contacts: &[Contact],
        space: &Space,
        (unknown, floating): (&[Option<u32>], &[Motion]),
    ) -> Loose {
        let mut loose = Loose::default();
        if floating.is_empty() {
            return loose;
        }
        let mut all: Vec<u32> = unknown.iter().copied().flatten().collect();
        all.sort_unstable();
        all.dedup();
        loose.unknowns = all.len();
        loose.parts = part_of(mesh);
        let part_of = loose.parts.clone();
        let part = |node: u32| part_of.get(node as usize).map_or(usize::MAX, |part| *part as usize);
        loose.of_part = vec![[0; 2]; floating.iter().map(|motion| motion.part + 1).max().unwrap_or(0)];
        let doubts = doubts(mesh, contacts, &boundary.nodes);
        let position = |node: u32| mesh.points.get(node as usize).copied().unwrap_or_default();
        let of_node = |(node, doubt): (&u32, f64)| Node { x: position(*node), first: 0, count: 0, doubt };
        loose.nodes = boundary.nodes.iter().zip(doubts).map(of_node).collect();
        let n = space.components;
        for own in floating.chunk_by(|a, b| a.part == b.part) {
            let Some(number) = own.first().map(|motion| motion.part) else { continue };
            let places: Vec<usize> = (0..boundary.nodes.len()).filter(|&i| part(boundary.nodes[i]) == number).collect();
            let rigid = bodies_of(space, boundary.nodes.len(), |node| part(node) == number);
            let column = |motion: &Motion| -> Vec<(u32, f64)> {
                let at = |&i: &usize| {
                    let node = boundary.nodes[i];
                    let (v, directions) = (motion.at(&position(node)), space.directions(node));
                    (0..n).filter_map(move |c| Some((unknown[i * n + c]?, dot(&v, &directions[c]))))
                };
                // A node and one that follows it have the same unknowns.
                let own = places.iter().filter(|i| rigid_of(&space.rigid, boundary.nodes[**i]).is_none());
                let mut column: Vec<(u32, f64)> = own.flat_map(at).collect();
                for (body, first) in &rigid {
                    let q = body.nodes.iter().enumerate().fold(vec![0.0; body.motions.len()], |mut q, (i, node)| {
                        let v = motion.at(&position(*node));
                        q.iter_mut().zip(body.at(i)).for_each(|(q, m)| *q += dot(&m, &v));
                        q
                    });
                    let unknown = |j: usize| unknown.get(first + j).copied().flatten();
                    column.extend(q.into_iter().enumerate().filter_map(|(j, q)| Some((unknown(j)?, q))));
                }
                column.sort_by_key(|(unknown, _)| *unknown);
                column.dedup_by_key(|(unknown, _)| *unknown);
                column
            };
            let (motions, columns) = orthonormal(own, &own.iter().map(column).collect::<Vec<_>>());
            for &i in &places {
                (loose.nodes[i].first, loose.nodes[i].count) = (loose.motions.len(), motions.len());
            }
            loose.of_part[number] = [loose.motions.len(), motions.len()];
            loose.motions.extend(motions);
            loose.columns.extend(columns);
        }
        loose
    }

    /// Resultant of forces over all nodes of the mesh, node-major, along each of the motions, and the sum of their
    /// sizes.
    #[must_use]
    pub fn loads(&self, mesh: &Mesh, forces: &[f64]) -> Vec<[f64; 2]> {
        let mut loads = vec![[0.0; 2]; self.motions.len()];
        for ((node, force), part) in forces.chunks_exact(mesh.dim).enumerate().zip(&self.parts) {
            let (Some(x), Some([first, count])) = (mesh.points.get(node), self.of_part.get(*part as usize)) else {
                continue;
            };
            let force: Point = std::array::from_fn(|c| force.get(c).copied().unwrap_or(0.0));
            for (motion, load) in self.motions.iter().zip(&mut loads).skip(*first).take(*count) {
                let v = motion.at(x);
                *load = [load[0] + dot(&v, &force), load[1] + length(&v) * length(&force)];
            }
        }
        loads
    }

    /// True if there is no such motion.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.motions.is_empty()
    }

    /// What the mesh does not know of the jump of each contact point, with ū at the contact nodes.
    pub(super) fn doubts(
        &self,
        boundary: &ContactBoundary,
        contacts: &[Contact],
        dim: usize,
        u_bar: &[f64],
    ) -> Vec<Doubt> {
        let of = |point: &PointOnBoundary| {
            let is_updated = contacts.get(point.contact).and_then(|c| c.pair.as_ref()).is_some_and(Pair::is_updated);
            let nodes = || point.nodes.iter().filter_map(|&(i, value)| Some((i, self.nodes.get(i)?, value)));
            let mut gap = [0.0; 3];
            for (i, node, value) in nodes() {
                let moved = u_bar.get(i * dim..).map_or(&[][..], |u| u.get(..dim).unwrap_or_default());
                for c in 0..dim {
                    gap[c] += value * (node.x[c] + if is_updated { moved.get(c).copied().unwrap_or(0.0) } else { 0.0 });
                }
            }
            // Only motions that both sides can have in common are known no better.
            let is_common = point.own < point.nodes.len() && nodes().all(|(_, node, _)| node.count > 0);
            let own = nodes().next();
            Doubt {
                angle: nodes()
                    .filter(|(.., value)| *value != 0.0)
                    .fold(0.0, |most: f64, (_, node, _)| most.max(node.doubt)),
                distance: if is_common { length(&gap) } else { 0.0 },
                first: own.map_or(0, |(_, node, _)| node.first),
                count: own.map_or(0, |(_, node, _)| node.count),
            }
        };
        boundary.points.iter().map(of).collect()
    }

    /// A sum of motions over the unknowns that are kept, `size` of them.
    fn vector(&self, a: &[f64], size: usize) -> Vec<f64> {
        let mut vector = vec![0.0; size];
        for (column, factor) in self.columns.iter().zip(a).filter(|(_, factor)| **factor != 0.0) {
            for &(unknown, value) in column {
                if let Some(entry) = vector.get_mut(unknown as usize) {
                    *entry += factor * value;
                }
            }
        }
        vector
    }
}

/// The rigid bodies of which the nodes are in a part, and where the unknowns of their motions begin in the list after
/// those of so many contact nodes.
fn bodies_of(space: &Space, nodes: usize, is_inside: impl Fn(u32) -> bool) -> Vec<(&RigidNodes, usize)> {
    let mut first = nodes * space.components;
    let mut all = Vec::new();
    for body in &space.rigid {
        if body.nodes.first().is_some_and(|&node| is_inside(node)) {
            all.push((body, first));
        }
        first += body.slots().len() * space.components;
    }
    all
}

/// The part of each node of a mesh.
fn part_of(mesh: &Mesh) -> Vec<u32> {
    let mut part_of = vec![u32::MAX; mesh.points.len()];
    for (number, part) in crate::mesh::defects::components(mesh).iter().enumerate() {
        for &node in &part.nodes {
            if let Some(part) = part_of.get_mut(node as usize) {
                *part = number as u32;
            }
        }
    }
    part_of
}

/// Sums of motions that are orthonormal on their columns; those without values there are left out.
fn orthonormal(motions: &[Motion], columns: &[Vec<(u32, f64)>]) -> (Vec<Motion>, Vec<Vec<(u32, f64)>>) {
    let n = motions.len();
    if n == 0 {
        return (Vec::new(), Vec::new());
    }
    let product = |a: &[(u32, f64)], b: &[(u32, f64)]| a.iter().zip(b).map(|(a, b)| a.1 * b.1).sum::<f64>();
    let gram = Mat::from_fn(n, n, |i, j| product(&columns[i], &columns[j]));
    let Ok(eigen) = gram.self_adjoint_eigen(Side::Lower) else { return (Vec::new(), Vec::new()) };
    let values: Vec<f64> = eigen.S().column_vector().iter().copied().collect();
    let most = values.iter().fold(0.0, |most: f64, value| most.max(*value));
    let (mut sums, mut sum_columns) = (Vec::new(), Vec::new());
    for k in (0..n).filter(|&k| values[k] > STILL * STILL * most) {
        let factors: Vec<f64> = eigen.U().col(k).iter().map(|entry| entry / values[k].sqrt()).collect();
        sums.extend(Motion::sum(factors.iter().copied().zip(motions)));
        let entry = |i: usize| {
            let of = |(factor, column): (&f64, &Vec<(u32, f64)>)| factor * column.get(i).map_or(0.0, |entry| entry.1);
            (columns[0][i].0, factors.iter().zip(columns).map(of).sum::<f64>())
        };
        sum_columns.push((0..columns[0].len()).map(entry).collect());
    }
    (sums, sum_columns)
}

/// Directions in which a point resists, along (ν, t₁, t₂).
pub(super) type Resists = [Local; 3];

/// The rigid motions at the contact points of a step.
#[derive(Debug)]
pub(super) struct Jumps {
    loose: Arc<Loose>,
    /// N_i Z of each point by its motions, and what the mesh does not know of it.
    points: Vec<Vec<(u32, Local)>>,
    doubts: Vec<Doubt>,
    /// The motions over the unknowns in the bases of the nodes, orthonormal.
    columns: Vec<Vec<(u32, f64)>>,
    /// Largest value of a motion at an unknown, and the number of unknowns of the contact nodes.
    size: f64,
    covers: usize,
}

/// Uncertainty of the jump of a point: an angle, and along a rotation common to both sides a distance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Doubt {
    angle: f64,
    distance: f64,
    first: usize,
    count: usize,
}

/// A motion that is not resisted.
#[derive(Clone, Debug)]
pub(super) struct Free {
    /// It as a sum of the motions.
    pub a: Vec<f64>,
    /// Over the unknowns, in the bases of the nodes.
    pub vector: Vec<f64>,
    /// True if no point moves along a direction in which it resists; else the motion is in doubt.
    pub is_exact: bool,
}

impl Jumps {
    /// Jumps of the motions at the points of an interface, with what the mesh does not know of them; `size` is the
    /// number of unknowns.
    pub fn new(loose: &Arc<Loose>, interface: &Interface, doubts: Vec<Doubt>, size: usize) -> Jumps {
        let count = loose.motions.len();
        let mut points = vec![Vec::new(); interface.len()];
        let unit = |k: usize| -> Vec<f64> { (0..count).map(|j| f64::from(u8::from(j == k))).collect() };
        let (mut most, mut columns) = (0.0, Vec::new());
        for k in 0..count {
            let column = interface.turned(&loose.vector(&unit(k), size));
            most = column.iter().fold(most, |most: f64, value| most.max(value.abs()));
            columns.push((0u32..).zip(column.iter().copied()).filter(|(_, value)| *value != 0.0).collect());
            for (i, point) in points.iter_mut().enumerate().filter(|(i, _)| interface.rows[*i].weight > 0.0) {
                let jump = interface.change(i, &column);
                if jump.iter().any(|c| *c != 0.0) {
                    point.push((k as u32, jump));
                }
            }
        }
        Jumps { loose: Arc::clone(loose), points, doubts, columns, size: most, covers: loose.unknowns }
    }

    /// The motions that the directions in which points resist leave free, beside those that are held already. With
    /// `in_doubt` those that move the points no more than the mesh knows as well.
    pub fn free(
        &self,
        interface: &Interface,
        resists: impl Fn(usize) -> Resists,
        held: &[Free],
        (in_doubt, size): (bool, usize),
    ) -> Vec<Free> {
        let n = self.loose.motions.len();
        let resists: Vec<Resists> = (0..self.points.len()).map(resists).collect();
        let mut matrix = Mat::<f64>::zeros(n, n);
        let mut add = |terms: &[(usize, f64)], sign: f64| {
            for &(i, a) in terms {
                for &(j, b) in terms {
                    matrix[(i, j)] += sign * a * b;
                }
            }
        };
        for free in held {
            add(&free.a.iter().copied().enumerate().collect::<Vec<_>>(), 1.0);
        }
        for (i, jumps) in self.points.iter().enumerate() {
            for direction in resists[i].iter().filter(|d| d.iter().any(|c| *c != 0.0)) {
                add(&jumps.iter().map(|(k, jump)| (*k as usize, dot(direction, jump))).collect::<Vec<_>>(), 1.0);
                if in_doubt {
                    self.unknown(i, direction).iter().for_each(|terms| add(terms, -1.0));
                }
            }
        }
        let Ok(eigen) = matrix.self_adjoint_eigen(Side::Lower) else { return Vec::new() };
        let values: Vec<f64> = eigen.S().column_vector().iter().copied().collect();
        let most = values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        let found =
            (0..n).filter(|&k| values[k] <= CANDIDATE * most).map(|k| eigen.U().col(k).iter().copied().collect());
        let made = found.filter_map(|mut a: Vec<f64>| {
            // Coefficients that are round-off are set to zero, so that the loads along their motions do not count.
            a.iter_mut().filter(|a| a.abs() < CANDIDATE).for_each(|a| *a = 0.0);
            let moves = self.moves(&resists, &a);
            let is_exact = moves <= STILL * self.size;
            if !is_exact && moves > self.leaves(&resists, &a, in_doubt) {
                return None;
            }
            let vector = interface.turned(&self.loose.vector(&a, size));
            Some(Free { a, vector, is_exact })
        });
        made.collect()
    }

    /// The number of unknowns of the contact nodes.
    pub fn covers(&self) -> usize {
        self.covers
    }

    /// Takes the rigid motions off a vector over the unknowns.
    pub fn take_off(&self, x: &mut [f64]) {
        for column in &self.columns {
            let share: f64 = column.iter().map(|(at, value)| value * x[*at as usize]).sum();
            for (at, value) in column {
                x[*at as usize] -= share * value;
            }
        }
    }

    /// Adds the forces that do along each motion what is given, to forces that do nothing.
    pub fn put_on(&self, loads: &[[f64; 2]], r: &mut [f64]) {
        for (column, [load, _]) in self.columns.iter().zip(loads) {
            for (at, value) in column {
                r[*at as usize] += load * value;
            }
        }
    }

    /// The largest distance between contact nodes along an axis.
    pub fn extent(&self) -> f64 {
        let along = |c: usize| {
            let at = self.loose.nodes.iter().map(|node| node.x[c]);
            at.clone().fold(f64::NEG_INFINITY, f64::max) - at.fold(f64::INFINITY, f64::min)
        };
        (0..3).map(along).fold(0.0, f64::max)
    }

    /// True if a motion closes no point.
    pub fn opens(&self, a: &[f64]) -> bool {
        let most = a.iter().fold(0.0, |most: f64, a| most.max(a.abs()));
        let normal = |jumps: &Vec<(u32, Local)>| jumps.iter().map(|(k, jump)| a[*k as usize] * jump[0]).sum::<f64>();
        most > 0.0
            && a.len() == self.loose.motions.len()
            && self.points.iter().all(|jumps| normal(jumps) <= STILL * most * self.size)
    }

    /// The part of a vector over the unknowns, in the axes of space, that is a sum of the motions.
    pub fn motion_of(&self, x: &[f64]) -> Vec<f64> {
        let of = |column: &Vec<(u32, f64)>| column.iter().map(|(at, value)| value * x[*at as usize]).sum();
        self.loose.columns.iter().map(of).collect()
    }

    /// Uncertain contributions of the motions to the jump of a point along a direction.
    fn unknown(&self, i: usize, direction: &Local) -> Vec<Vec<(usize, f64)>> {
        let Doubt { angle, distance, first, count } = self.doubts[i];
        let mut terms = Vec::new();
        if angle > 0.0 {
            for c in 0..3 {
                // The part across the direction, turned by the angle.
                let across = |jump: &Local| jump[c] - dot(direction, jump) * direction[c];
                terms.push(self.points[i].iter().map(|(k, jump)| (*k as usize, angle * across(jump))).collect());
            }
        }
        if distance > 0.0 {
            let motions = || self.loose.motions.iter().enumerate().skip(first).take(count);
            terms.extend((0..3).map(|c| motions().map(|(k, motion)| (k, distance * motion.turn[c])).collect()));
        }
        terms
    }

    /// Largest displacement of the resisting points along the directions in which they resist a motion.
    fn moves(&self, resists: &[Resists], a: &[f64]) -> f64 {
        let of = |(jumps, resists): (&Vec<(u32, Local)>, &Resists)| {
            let jump: Local = std::array::from_fn(|c| jumps.iter().map(|(k, jump)| a[*k as usize] * jump[c]).sum());
            resists.iter().map(|direction| dot(direction, &jump).abs()).fold(0.0, f64::max)
        };
        self.points.iter().zip(resists).map(of).fold(0.0, f64::max)
    }

    /// Largest such displacement that the uncertainty due to the mesh allows; zero unless `in_doubt`.
    fn leaves(&self, resists: &[Resists], a: &[f64], in_doubt: bool) -> f64 {
        if !in_doubt {
            return 0.0;
        }
        DOUBTFUL * (0..resists.len()).map(|i| self.doubt(i, &resists[i], a)).fold(0.0, f64::max)
    }

    /// Uncertainty of the motion of a point along the directions in which it resists.
    pub fn doubt(&self, i: usize, resists: &Resists, a: &[f64]) -> f64 {
        let size = |terms: &Vec<(usize, f64)>| terms.iter().map(|(k, value)| a[*k] * value).sum::<f64>();
        let of = |direction: &Local| self.unknown(i, direction).iter().map(|terms| size(terms).powi(2)).sum::<f64>();
        resists.iter().filter(|d| d.iter().any(|c| *c != 0.0)).map(of).fold(0.0, f64::max).sqrt()
    }

    /// The springs of motions in a tangent, with the energy of D = diag(S) along them: D V (Vᵀ D V)⁻¹ Vᵀ D. The motion
    /// is measured by D, so that a stiff part is moved towards what holds it, however far soft parts that hang on it
    /// sag.
    pub fn springs(free: &[Free], scale: &[f64]) -> Vec<Spring> {
        let n = free.len();
        if n == 0 {
            return Vec::new();
        }
        let product = |a: &Free, b: &Free| -> f64 {
            a.vector.iter().zip(&b.vector).zip(scale).map(|((a, b), scale)| scale * a * b).sum()
        };
        let gram = Mat::from_fn(n, n, |i, j| product(&free[i], &free[j]));
        let Ok(eigen) = gram.self_adjoint_eigen(Side::Lower) else { return Vec::new() };
        let values: Vec<f64> = eigen.S().column_vector().iter().copied().collect();
        let of = |k: usize| {
            let entry = |(at, scale): (usize, &f64)| {
                let sum: f64 = free.iter().enumerate().map(|(i, free)| eigen.U()[(i, k)] * free.vector[at]).sum();
                (at as u32, scale * sum)
            };
            let vector = scale.iter().enumerate().map(entry).filter(|(_, value)| *value != 0.0).collect();
            Spring { stiffness: values[k].recip(), vector }
        };
        (0..n).filter(|&k| values[k] > 0.0).map(of).collect()
    }

    /// The spring that holds a motion, with the mean stiffness of the operator over it; `scale` is that of its
    /// unknowns.
    pub fn spring(free: &Free, scale: &[f64]) -> Spring {
        let of = |(at, (value, scale)): (usize, (&f64, &f64))| (at as u32, *value, scale * value * value);
        let entries = free.vector.iter().zip(scale).enumerate().filter(|(_, (value, _))| **value != 0.0).map(of);
        let (mut vector, mut stiffness) = (Vec::new(), 0.0);
        for (at, value, part) in entries {
            vector.push((at, value));
            stiffness += part;
        }
        Spring { stiffness, vector }
    }
}

/// Supports of the rigid motions of a step.
#[derive(Clone, Debug)]
pub(super) struct Holds {
    pub jumps: Arc<Jumps>,
    /// The stiffness of S at each unknown.
    pub scale: Arc<[f64]>,
    /// The motions that are held at rest, with their springs.
    pub held: Vec<(Free, Spring)>,
}

impl Holds {
    pub fn frees(&self) -> Vec<Free> {
        self.held.iter().map(|(free, _)| free.clone()).collect()
    }

    pub fn springs(&self) -> Vec<Spring> {
        self.held.iter().map(|(_, spring)| spring.clone()).collect()
    }

    pub fn add(&mut self, free: &[Free]) {
        let with_spring = |free: &Free| (free.clone(), Jumps::spring(free, &self.scale));
        let more: Vec<_> = free.iter().map(with_spring).collect();
        self.held.extend(more);
    }
}

/// The directions in which a point resists a motion at an iterate.
pub(super) fn resisting(laws: &Laws, dim: usize) -> Resists {
    let (_, t) = laws.linear(dim);
    let normal = if t[0][0] > 0.0 { [1.0, 0.0, 0.0] } else { [0.0; 3] };
    // The principal directions of the symmetric part along the tangents.
    let (mean, half, mixed) = (0.5 * (t[1][1] + t[2][2]), 0.5 * (t[1][1] - t[2][2]), 0.5 * (t[1][2] + t[2][1]));
    let radius = half.hypot(mixed);
    let along = |value: f64, angle: f64| {
        let resists = value > RESISTS * (mean.abs() + radius);
        if resists { [0.0, angle.cos(), angle.sin()] } else { [0.0; 3] }
    };
    let angle = 0.5 * mixed.atan2(half);
    [normal, along(mean + radius, angle), along(mean - radius, angle + std::f64::consts::FRAC_PI_2)]
}

/// A rigid motion that nothing determines in a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Undetermined {
    /// It as a sum of [`Loose::motions`].
    pub sum: Vec<f64>,
    /// Unbalanced load along the motion, for the motion of this size: a force times a length over a time.
    pub load: f64,
}
