//! Nodes that move as one rigid body.
//!
//! The displacement of such nodes is u(x_i) = Σ_j q_j m_j(x_i), m_j the motions without strain, m(x) = s + ω × (x − c)
//! with small rotations. The m_j are orthonormal over the nodes, Σ_i m_j(x_i)·m_l(x_i) = δ_jl: a displacement has q_j =
//! Σ_i m_j(x_i)·u_i, and nodal forces f_i do the work Q_j = Σ_i m_j(x_i)·f_i along them. The same map takes
//! displacements to q, in m, and forces to Q, in N. The q_j replace the unknowns of (4.1) at these nodes.
//!
//! A value prescribed at a node in a direction d is one equation for q, Σ_j d·m_j(x_i) q_j = u_D. The first of the m_j
//! are the directions of these equations, so that these q_j are prescribed and the others free.

use crate::mesh::{Mesh, cross};
use crate::tensor::{Point, dot, length};

/// Fraction of a motion that counts as zero after other motions are subtracted, as for rotation of nodes on a line
/// about it.
const NOTHING: f64 = 1e-6;

/// Largest number of motions without strain: three translations and three rotations.
const MOTIONS: usize = 6;

/// Nodes that move as one rigid body.
#[derive(Clone, Debug)]
pub struct RigidNodes {
    /// The nodes, ascending.
    pub nodes: Vec<u32>,
    /// Their positions, m.
    places: Vec<Point>,
    /// The m_j; prescribed ones first.
    pub motions: Vec<RigidMotion>,
    /// Number of prescribed motions.
    pub held: usize,
    /// The line in space on which all nodes lie, about which they cannot turn; `None` if they lie on no line.
    pub line: Option<Point>,
    /// Components per node.
    components: usize,
}

/// A motion without strain, m(x) = s + ω × (x − c).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RigidMotion {
    /// s.
    pub shift: Point,
    /// ω.
    pub turn: Point,
    /// c.
    pub centre: Point,
}

impl RigidMotion {
    /// m(x).
    #[must_use]
    pub fn at(&self, x: &Point) -> Point {
        let turned = cross(&self.turn, &std::array::from_fn(|c| x[c] - self.centre[c]));
        std::array::from_fn(|c| self.shift[c] + turned[c])
    }

    /// a m + b m′, for motions about one centre.
    fn sum(&self, a: f64, b: f64, other: &RigidMotion) -> RigidMotion {
        let of = |own: &Point, other: &Point| std::array::from_fn(|c| a * own[c] + b * other[c]);
        RigidMotion { shift: of(&self.shift, &other.shift), turn: of(&self.turn, &other.turn), centre: self.centre }
    }
}

impl RigidNodes {
    /// The nodes of a set, ascending, with their motions, including rotations if `turns` is true. A body of revolution
    /// moves only along its axis.
    #[must_use]
    pub fn new(mesh: &Mesh, nodes: Vec<u32>, turns: bool) -> RigidNodes {
        let places: Vec<Point> =
            nodes.iter().map(|&node| mesh.points.get(node as usize).copied().unwrap_or_default()).collect();
        let mut rigid = RigidNodes { nodes, places, motions: Vec::new(), held: 0, line: None, components: mesh.dim };
        let moves = |motion: &RigidMotion| turns || motion.turn.iter().all(|c| *c == 0.0);
        for motion in rigid.candidates(mesh).into_iter().filter(moves) {
            let size = rigid.product(&motion, &motion).sqrt();
            let mut rest = motion;
            // Done twice, so that the remainder is orthogonal to the last digit.
            for _ in 0..2 {
                for other in &rigid.motions {
                    rest = rest.sum(1.0, -rigid.product(&rest, other), other);
                }
            }
            let left = rigid.product(&rest, &rest).sqrt();
            if left > NOTHING * size {
                rigid.motions.push(rest.sum(1.0 / left, 0.0, &rest));
            }
        }
        if turns && mesh.dim == 3 && rigid.motions.len() + 1 == MOTIONS {
            rigid.leave_line();
        }
        rigid
    }

    /// Removes the rotation of nodes on a line about that line, which moves no node: moments about the line do no work.
    fn leave_line(&mut self) {
        let centre = self.motions.first().map_or([0.0; 3], |motion| motion.centre);
        let arm = |x: &Point| -> Point { std::array::from_fn(|c| x[c] - centre[c]) };
        let Some(farthest) = self.places.iter().map(arm).max_by(|a, b| length(a).total_cmp(&length(b))) else { return };
        let size = length(&farthest);
        let line = farthest.map(|c| c / size);
        for motion in &mut self.motions {
            let along = dot(&motion.turn, &line);
            motion.turn = std::array::from_fn(|c| motion.turn[c] - along * line[c]);
        }
        self.line = Some(line);
    }

    /// Motions along the axes, and about axes through the centre of the nodes.
    fn candidates(&self, mesh: &Mesh) -> Vec<RigidMotion> {
        let n = self.places.len().max(1) as f64;
        let centre: Point = std::array::from_fn(|c| self.places.iter().map(|x| x[c]).sum::<f64>() / n);
        let unit = |axis: usize| -> Point { std::array::from_fn(|c| f64::from(u8::from(c == axis))) };
        let shifted = |axis: usize| RigidMotion { shift: unit(axis), turn: [0.0; 3], centre };
        let turned = |axis: usize| RigidMotion { shift: [0.0; 3], turn: unit(axis), centre };
        match mesh.dim {
            _ if mesh.axisymmetric => vec![shifted(1)],
            1 => vec![shifted(0)],
            2 => vec![shifted(0), shifted(1), turned(2)],
            _ => (0..3).map(shifted).chain((0..3).map(turned)).collect(),
        }
    }

    /// Σ_i m(x_i)·m′(x_i).
    fn product(&self, a: &RigidMotion, b: &RigidMotion) -> f64 {
        self.places.iter().map(|x| dot(&a.at(x), &b.at(x))).sum()
    }

    /// The degree of freedom that holds q_j, one of those of the first nodes.
    #[must_use]
    pub fn dof(&self, j: usize) -> usize {
        let n = self.components.max(1);
        self.nodes.get(j / n).map_or(0, |node| *node as usize * n + j % n)
    }

    /// The nodes whose degrees of freedom hold the q_j.
    #[must_use]
    pub fn slots(&self) -> &[u32] {
        let count = self.motions.len().div_ceil(self.components.max(1));
        &self.nodes[..count.min(self.nodes.len())]
    }

    /// Index of a node among the nodes of the body.
    #[must_use]
    pub fn position(&self, node: u32) -> Option<usize> {
        self.nodes.binary_search(&node).ok()
    }

    /// The displacement of a node by each motion.
    pub fn at(&self, position: usize) -> impl Iterator<Item = Point> + '_ {
        let x = self.places.get(position).copied().unwrap_or_default();
        self.motions.iter().map(move |motion| motion.at(&x))
    }

    /// Q of a force and of a moment at a position.
    #[must_use]
    pub fn work(&self, x: &Point, force: &Point, moment: &Point) -> Vec<f64> {
        self.motions.iter().map(|motion| dot(&motion.at(x), force) + dot(&motion.turn, moment)).collect()
    }

    /// The nodal forces that do the work Q, node-major.
    #[must_use]
    pub fn forces(&self, work: &[f64]) -> Vec<Point> {
        (0..self.nodes.len()).map(|i| self.sum(i, work)).collect()
    }

    /// Replaces the values at the nodes by q, and by zero in the remaining entries.
    pub fn enter(&self, values: &mut [f64]) {
        let n = self.components;
        let mut q = [0.0; MOTIONS];
        for (i, &node) in self.nodes.iter().enumerate() {
            let Some(at) = values.get_mut(node as usize * n..(node as usize + 1) * n) else { continue };
            let v: Point = std::array::from_fn(|c| at.get(c).copied().unwrap_or_default());
            at.fill(0.0);
            q.iter_mut().zip(self.at(i)).for_each(|(q, m)| *q += dot(&m, &v));
        }
        for (j, q) in q.into_iter().enumerate().take(self.motions.len()) {
            values.get_mut(self.dof(j)).into_iter().for_each(|value| *value = q);
        }
    }

    /// Replaces q by the values at the nodes.
    pub fn leave(&self, values: &mut [f64]) {
        let n = self.components;
        let entry = |j: usize| values.get(self.dof(j)).copied().filter(|_| j < self.motions.len());
        let q: [f64; MOTIONS] = std::array::from_fn(|j| entry(j).unwrap_or_default());
        for (i, &node) in self.nodes.iter().enumerate() {
            let u = self.sum(i, &q);
            let at = values.get_mut(node as usize * n..(node as usize + 1) * n);
            at.into_iter().flatten().zip(u).for_each(|(value, c)| *value = c);
        }
    }

    /// Σ_j q_j m_j at a node.
    fn sum(&self, position: usize, q: &[f64]) -> Point {
        let add = |sum: Point, (m, q): (Point, &f64)| std::array::from_fn(|c| sum[c] + q * m[c]);
        self.at(position).zip(q).fold([0.0; 3], add)
    }

    /// Prescribes the value of a node in a direction. Returns the number of the motion prescribed by it, the factors of
    /// the motions prescribed before in that value, and the factor of the new motion; `None` if it was prescribed
    /// before.
    pub fn hold(&mut self, node: u32, direction: &Point) -> Option<(usize, Vec<f64>, f64)> {
        let position = self.position(node)?;
        let along: Vec<f64> = self.at(position).map(|m| dot(&m, direction)).collect();
        let size = along.iter().map(|c| c * c).sum::<f64>().sqrt();
        let (before, rest) = along.split_at(self.held);
        let scale = rest.iter().map(|c| c * c).sum::<f64>().sqrt();
        if scale <= NOTHING * size {
            return None;
        }
        let (number, before) = (self.held, before.to_vec());
        let towards: Vec<f64> = rest.iter().map(|c| c / scale).collect();
        self.turn(&towards);
        self.held += 1;
        Some((number, before, scale))
    }

    /// Recombines the free motions so that the first becomes Σ_j t_j m_j for a unit vector t: a reflection that takes
    /// the first unit vector to ±t, and the sign.
    fn turn(&mut self, t: &[f64]) {
        let free = &mut self.motions[self.held..];
        let sign = if t.first().is_some_and(|first| *first > 0.0) { -1.0 } else { 1.0 };
        // v = t − sign e₁; H = 1 − 2 v vᵀ/‖v‖² takes e₁ to sign t.
        let mut v = t.to_vec();
        v.iter_mut().take(1).for_each(|first| *first -= sign);
        let square = v.iter().map(|c| c * c).sum::<f64>();
        if square > 0.0 {
            let Some(first) = free.first().copied() else { return };
            let zero = first.sum(0.0, 0.0, &first);
            let along = free.iter().zip(&v).fold(zero, |sum, (motion, v)| sum.sum(1.0, *v, motion));
            for (motion, v) in free.iter_mut().zip(&v) {
                *motion = motion.sum(1.0, -2.0 * v / square, &along);
            }
        }
        if let Some(first) = free.first_mut() {
            let reflected = *first;
            *first = reflected.sum(sign, 0.0, &reflected);
        }
    }

    /// Keeps only those degrees of freedom of the nodes free that hold free motions.
    pub fn take(&self, free: &mut [bool]) {
        let motions: Vec<bool> =
            (0..self.motions.len()).map(|j| free.get(self.dof(j)).copied().unwrap_or_default()).collect();
        for &node in &self.nodes {
            let own = node as usize * self.components..(node as usize + 1) * self.components;
            free.get_mut(own).into_iter().for_each(|own| own.fill(false));
        }
        for (j, is_free) in motions.into_iter().enumerate() {
            free.get_mut(self.dof(j)).into_iter().for_each(|free| *free = is_free);
        }
    }

    /// Orthonormal directions in which the free motions can move a node.
    #[must_use]
    pub fn free_directions(&self, position: usize) -> Vec<Point> {
        let all: Vec<Point> = self.at(position).collect();
        let size = all.iter().map(length).fold(0.0, f64::max);
        let mut found: Vec<Point> = Vec::new();
        for motion in all.get(self.held..).unwrap_or_default() {
            let mut rest = *motion;
            for _ in 0..2 {
                for other in &found {
                    let along = dot(&rest, other);
                    rest = std::array::from_fn(|c| rest[c] - along * other[c]);
                }
            }
            let left = length(&rest);
            if left > NOTHING * size {
                found.push(rest.map(|c| c / left));
            }
        }
        found
    }
}

/// The rigid body to which a node belongs, by its number, and the index of the node in it.
#[must_use]
pub fn rigid_of(rigid: &[RigidNodes], node: u32) -> Option<(usize, usize)> {
    rigid.iter().enumerate().find_map(|(number, body)| Some((number, body.position(node)?)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Diagonal;

    fn off(rigid: &RigidNodes) -> f64 {
        let n = rigid.motions.len();
        let unit = |j: usize, l: usize| if j == l { 1.0 } else { 0.0 };
        let pairs = (0..n).flat_map(|j| (0..n).map(move |l| (j, l)));
        let product = |(j, l): (usize, usize)| rigid.product(&rigid.motions[j], &rigid.motions[l]) - unit(j, l);
        pairs.map(|pair| product(pair).abs()).fold(0.0, f64::max)
    }

    /// Statics: the nodal forces have the resultant and moment of the load they replace, except for the moment about
    /// the line if the nodes lie on a line.
    #[test]
    fn forces_have_their_resultant_and_moment() -> Result<(), crate::mesh::MeshError> {
        let mut mesh = Mesh::box_([1.0, 0.5, 0.7], [2, 2, 2], crate::mesh::Elements::Q1)?;
        mesh.points.iter_mut().for_each(|x| *x = [0.6 * x[0] - 0.8 * x[1] + 30.0, 0.8 * x[0] + 0.6 * x[1], x[2] - 9.0]);
        let cross = |a: &Point, b: &Point| -> Point { cross(a, b) };
        let all: Vec<u32> = mesh.facets["top"].node_list();
        let first = mesh.points[all[0] as usize];
        let line: Vec<u32> = all
            .iter()
            .copied()
            .filter(|&node| {
                let arm: Point = std::array::from_fn(|c| mesh.points[node as usize][c] - first[c]);
                length(&cross(&arm, &[0.6, 0.8, 0.0])) < 1e-12
            })
            .collect();
        assert_eq!((all.len(), line.len()), (9, 3));
        for (nodes, is_line) in [(all, false), (line, true)] {
            let body = RigidNodes::new(&mesh, nodes, true);
            assert!(off(&body) < 1e-12 && body.line.is_some() == is_line);
            let (at, force, moment) = ([29.0, 2.0, -8.5], [0.3, -1.1, 0.7], [0.2, 0.5, -0.4]);
            let forces = body.forces(&body.work(&at, &force, &moment));
            let mut left = [force, moment];
            for (node, f) in body.nodes.iter().zip(&forces) {
                let arm: Point = std::array::from_fn(|c| mesh.points[*node as usize][c] - at[c]);
                let moment = cross(&arm, f);
                left = [[0, 1, 2].map(|c| left[0][c] - f[c]), [0, 1, 2].map(|c| left[1][c] - moment[c])];
            }
            let about = body.line.unwrap_or_default();
            // Only the moment about the line is not transmitted, including that of the force.
            let beside = cross(&left[1], &about);
            assert!(length(&left[0]) < 1e-12 && length(&if is_line { beside } else { left[1] }) < 1e-12, "{left:?}");
        }
        Ok(())
    }

    /// Motions stay orthonormal while directions are prescribed, even far from the origin; no free motion moves a
    /// prescribed value.
    #[test]
    fn free_motions_leave_what_is_prescribed() -> Result<(), crate::mesh::MeshError> {
        let mut mesh = Mesh::rectangle([1.0, 0.5], [4, 2], Diagonal::Right)?;
        mesh.points.iter_mut().for_each(|x| *x = [x[0] + 1e3, x[1] - 2e3, 0.0]);
        let mut rigid = RigidNodes::new(&mesh, mesh.facets["top"].node_list(), true);
        assert_eq!(rigid.motions.len(), 3);
        assert!(off(&rigid) < 1e-13);
        let node = rigid.nodes[1];
        for (direction, held) in [([0.6, 0.8, 0.0], 1), ([0.6, 0.8, 0.0], 1), ([1.0, 0.0, 0.0], 2)] {
            rigid.hold(node, &direction);
            assert_eq!(rigid.held, held);
            assert!(off(&rigid) < 1e-13, "{}", off(&rigid));
            let free: Vec<Point> = rigid.at(1).skip(held).collect();
            assert!(free.iter().all(|m| dot(m, &direction).abs() < 1e-13), "{free:?}");
        }
        // The body turns about the held node.
        assert!(rigid.free_directions(1).is_empty());
        assert_eq!(rigid.free_directions(0).len(), 1);
        let mut values: Vec<f64> = (0..30).map(|i| f64::from(i * i % 7)).collect();
        rigid.leave(&mut values);
        let once = values.clone();
        rigid.enter(&mut values);
        rigid.leave(&mut values);
        assert!(once.iter().zip(&values).all(|(a, b)| (a - b).abs() < 1e-12));
        Ok(())
    }
}
