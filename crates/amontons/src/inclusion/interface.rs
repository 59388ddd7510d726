//! The rows of N: what a contact point sees of the unknowns on Γ_C, in a basis of its own.
//!
//! Each contact point has the basis (ν, t₁, t₂) of its normal and d − 1 tangents, so that no direction of space is
//! preferred: the normal velocity, the slip and the tangential traction are numbers, and what happens in one direction
//! leaves no round-off in another.
//!
//! Where a point sees one node alone, and no other point sees that node (nodal quadrature, inside a side), the unknowns
//! of the node are taken in the basis of the point as well. Its row is then the identity, and the systems on Γ_C are
//! the same whatever way the body is turned.

use std::ops::Range;

use crate::contact::{ContactBoundary, PointOnBoundary};
use crate::linalg::{Share, Tangent, Turn};
use crate::mesh::{cross, leader};
use crate::space::Space;
use crate::space::rigid::rigid_of;
use crate::tensor::{Point, dot, given, length};

/// Stiffness of one side of a pair relative to that of the other that is round-off.
const NONE: f64 = 1e-13;
/// Cosine of two directions that is the round-off of coordinates.
const NOTHING: f64 = 64.0 * f64::EPSILON;
/// Cosine of the normal and a direction that is prescribed up to which the latter is a tangent.
const ALONG: f64 = 1e-12;

/// A vector or a force at a contact point by its components along (ν, t₁, t₂); a scalar by the first.
pub type Local = [f64; 3];

/// Derivative of a force in a velocity at a contact point, rows the force.
pub type LocalTangent = [[f64; 3]; 3];

/// The row of N of one contact point.
#[derive(Clone, Debug)]
pub struct Row {
    /// Weight ω in m^(d−1).
    pub weight: f64,
    /// Which of the contacts of the problem this is a point of.
    pub contact: usize,
    /// ν, t₁ and t₂; tangents beyond the dimension are those in which a body does not move.
    pub basis: [Point; 3],
    /// Range of its entries among those of all rows.
    entries: Range<usize>,
    /// Contribution of prescribed values to the jump.
    prescribed: Local,
}

impl Row {
    /// The components of a vector in the basis of the point.
    #[must_use]
    pub fn local(&self, v: &Point) -> Local {
        std::array::from_fn(|a| dot(&self.basis[a], v))
    }

    /// The vector with these components.
    #[must_use]
    pub fn global(&self, v: &Local) -> Point {
        std::array::from_fn(|c| (0..3).map(|a| v[a] * self.basis[a][c]).sum())
    }

    /// The vector with these tangential components.
    #[must_use]
    pub fn tangential(&self, v: &[f64; 2]) -> Point {
        self.global(&[0.0, v[0], v[1]])
    }

    /// The derivative with these components, in the axes of space.
    #[must_use]
    pub fn global_tangent(&self, tangent: &LocalTangent) -> [[f64; 3]; 3] {
        let rows: [Point; 3] = std::array::from_fn(|a| self.global(&tangent[a]));
        std::array::from_fn(|c| std::array::from_fn(|e| (0..3).map(|a| self.basis[a][c] * rows[a][e]).sum()))
    }
}

/// The rows of all contact points, and the nodes whose unknowns are in the basis of their point.
#[derive(Clone, Debug)]
pub struct Interface {
    /// The rows, one per contact point.
    pub rows: Vec<Row>,
    /// The entries of all rows, one row after the other: unknowns on Γ_C with what each adds to the components of the
    /// jump.
    entries: Vec<Share>,
    /// Nodes whose unknowns are taken in another basis than the axes of space.
    pub turns: Vec<Turn>,
    /// Number of components of an unknown at a node.
    components: usize,
}

impl Interface {
    /// The rows for vectors: `unknown` and `prescribed` are by contact node and component, then by the motions of rigid
    /// bodies ([`Space::with_rigid`]), the first with the unknown on Γ_C, none where the value is prescribed, the
    /// second with that value; components are along the directions of the space. `normals` has ν of each point.
    #[must_use]
    pub fn of_vectors(
        boundary: &ContactBoundary,
        unknown: &[Option<u32>],
        prescribed: &[f64],
        normals: &[Point],
        space: &Space,
    ) -> Interface {
        let dim = space.components;
        // Nodes of which one follows the other have the same unknowns.
        let leaders: Vec<u32> = boundary.nodes.iter().map(|&node| leader(&space.links, node)).collect();
        let shared = |node: usize| boundary.nodes.binary_search(&leaders[node]).unwrap_or(node);
        let mut of_leader = vec![0usize; boundary.nodes.len()];
        for &(node, _) in boundary.points.iter().flat_map(|point| &point.nodes) {
            of_leader[shared(node)] += 1;
        }
        let seen: Vec<usize> = (0..boundary.nodes.len()).map(|node| of_leader[shared(node)]).collect();
        let count = boundary.points.len();
        let on_nodes = OnNodes { unknown, prescribed, space, nodes: &boundary.nodes };
        let (mut rows, mut turns) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let mut entries =
            Vec::with_capacity(dim * boundary.points.iter().map(|point| point.nodes.len()).sum::<usize>());
        for (point, normal) in boundary.points.iter().zip(normals) {
            let basis = basis_at(point, &boundary.nodes, normal, space);
            let is_turned = |point: &PointOnBoundary| {
                point.nodes.first().is_some_and(|(node, _)| space.is_turned(boundary.nodes[*node]))
            };
            let own = own_node(point, &seen, unknown, dim).filter(|_| !is_turned(point));
            let turn = own.map(|unknowns| Turn { unknowns, basis, dim });
            rows.push(vector_row(point, basis, turn.as_ref(), &on_nodes, &mut entries));
            turns.extend(turn);
        }
        Interface { rows, entries, turns, components: dim }
    }

    /// The rows for scalars, likewise: the value on the side of a point is the first component, that on the other side
    /// of a pair with the opposite sign the second.
    #[must_use]
    pub fn of_scalars(boundary: &ContactBoundary, unknown: &[Option<u32>], prescribed: &[f64]) -> Interface {
        let mut entries = Vec::with_capacity(boundary.points.iter().map(|point| point.nodes.len()).sum());
        let row = |point: &PointOnBoundary| {
            let (first, mut fixed) = (entries.len(), [0.0; 3]);
            for (i, &(node, value)) in point.nodes.iter().enumerate() {
                let on = if i < point.own { [value, 0.0, 0.0] } else { [0.0, value, 0.0] };
                match unknown[node] {
                    Some(unknown) => entries.push((unknown, on)),
                    None => fixed = std::array::from_fn(|a| fixed[a] + on[a] * prescribed[node]),
                }
            }
            let entries = first..entries.len();
            Row { weight: point.weight, contact: point.contact, basis: [[0.0; 3]; 3], entries, prescribed: fixed }
        };
        let rows = boundary.points.iter().map(row).collect();
        let has_pairs = boundary.points.iter().any(|point| point.own < point.nodes.len());
        let components = if has_pairs { 2 } else { 1 };
        Interface { rows, entries, turns: Vec::new(), components }
    }

    /// The rows with a share of their weights: the forces of the points count by it.
    #[must_use]
    pub fn weighted(mut self, share: f64) -> Interface {
        self.rows.iter_mut().for_each(|row| row.weight *= share);
        self
    }

    /// Number of contact points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// True if there are no contact points.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The unknowns that a point sees with what each adds to the components of the jump.
    fn entries(&self, i: usize) -> &[Share] {
        &self.entries[self.rows[i].entries.clone()]
    }

    /// A vector over the unknowns on Γ_C in the bases of the nodes.
    #[must_use]
    pub fn turned(&self, x: &[f64]) -> Vec<f64> {
        let mut x = x.to_vec();
        self.turns.iter().for_each(|turn| turn.forward(&mut x));
        x
    }

    /// The vector `x` in the axes of space again.
    #[must_use]
    pub fn back(&self, x: &[f64]) -> Vec<f64> {
        let mut x = x.to_vec();
        self.turns.iter().for_each(|turn| turn.back(&mut x));
        x
    }

    /// The jump at a contact point: N x with the prescribed values.
    #[must_use]
    pub fn jump(&self, i: usize, x: &[f64]) -> Local {
        let (row, change) = (&self.rows[i], self.change(i, x));
        std::array::from_fn(|a| row.prescribed[a] + change[a])
    }

    /// N x without the prescribed values: the change of the jump.
    #[must_use]
    pub fn change(&self, i: usize, x: &[f64]) -> Local {
        let mut sum = [0.0; 3];
        for (unknown, on) in self.entries(i) {
            for a in 0..self.components {
                sum[a] += on[a] * x[*unknown as usize];
            }
        }
        sum
    }

    /// |N| |x|: the sizes of the terms that the jump is the sum of, but for prescribed values.
    #[must_use]
    pub fn sizes(&self, i: usize, x: &[f64]) -> Local {
        let mut sum = [0.0; 3];
        for (unknown, on) in self.entries(i) {
            for a in 0..self.components {
                sum[a] += (on[a] * x[*unknown as usize]).abs();
            }
        }
        sum
    }

    /// Adds ω Nᵀ f of one point.
    pub fn scatter(&self, i: usize, f: &Local, out: &mut [f64]) {
        let row = &self.rows[i];
        for (unknown, on) in self.entries(i) {
            out[*unknown as usize] += row.weight * (0..self.components).map(|a| on[a] * f[a]).sum::<f64>();
        }
    }

    /// Adds ω |N|ᵀ f of one point, f the sizes of terms that cancel.
    pub fn scatter_sizes(&self, i: usize, f: &Local, out: &mut [f64]) {
        let row = &self.rows[i];
        for (unknown, on) in self.entries(i) {
            out[*unknown as usize] += row.weight * (0..self.components).map(|a| (on[a] * f[a]).abs()).sum::<f64>();
        }
    }

    /// A tangent without entries, with room for those of all points.
    #[must_use]
    pub fn empty_tangent(&self) -> Tangent {
        Tangent::with_capacity(self.rows.len(), self.entries.len())
    }

    /// Adds ω Nᵀ T N of one point.
    pub fn add_tangent(&self, i: usize, tangent: &LocalTangent, out: &mut Tangent) {
        let (row, n) = (&self.rows[i], self.components);
        let moving = |a: usize, b: usize| if a < n && b < n { tangent[a][b] } else { 0.0 };
        out.add(row.weight, self.entries(i), &std::array::from_fn(|a| std::array::from_fn(|b| moving(a, b))));
    }

    /// The weighted sum of one component of the rows over the unknowns of a point: ω Nᵀ e₁ with a factor.
    pub fn scaled_row(&self, i: usize, factor: f64) -> impl Iterator<Item = (u32, f64)> + '_ {
        let row = &self.rows[i];
        self.entries(i).iter().map(move |(unknown, on)| (*unknown, row.weight * on[0] * factor))
    }

    /// True if a point depends on unknowns.
    #[must_use]
    pub fn is_free(&self, i: usize) -> bool {
        !self.entries(i).is_empty()
    }

    /// ρ of each point, the scale of S per area; of a pair that of both sides in series. On a side it is the mean of
    /// `diagonal` (of S, by unknown) over the nodes that the point sees, over their weights. Absolute values of the
    /// shape functions weigh and average: those of quadratic facets take either sign, and at the vertices of a triangle
    /// they integrate to zero, so that ∫ N would leave the sign of ρ to round-off. Scalars have no `space`.
    #[must_use]
    pub fn stiffness(
        &self,
        boundary: &ContactBoundary,
        space: Option<&Space>,
        unknown: &[Option<u32>],
        diagonal: &[f64],
    ) -> Vec<f64> {
        let mut weight = vec![0.0; boundary.nodes.len()];
        for point in &boundary.points {
            for &(node, value) in &point.nodes {
                weight[node] += point.weight * value.abs();
            }
        }
        let of_node = |node: usize| {
            let (mut sum, mut share) = (0.0, 0.0);
            for (at, direction) in degrees(space, &boundary.nodes, node) {
                if let Some(unknown) = unknown.get(at).copied().flatten() {
                    let square = dot(&direction, &direction);
                    sum += square * diagonal[unknown as usize];
                    share += square;
                }
            }
            if share > 0.0 { Some(sum / (share * weight[node])) } else { None }
        };
        let of_side = |nodes: &[(usize, f64)]| {
            let (mut sum, mut share) = (0.0, 0.0);
            for &(node, value) in nodes {
                if let Some(stiffness) = of_node(node) {
                    sum += value.abs() * stiffness;
                    share += value.abs();
                }
            }
            if share > 0.0 { sum / share } else { 0.0 }
        };
        let of_point = |point: &PointOnBoundary| {
            let (own, other) = point.nodes.split_at(point.own);
            match [of_side(own), of_side(other)] {
                _ if point.weight == 0.0 => 0.0,
                [own, _] if other.is_empty() => own,
                // A body that nothing but the pair holds may have no stiffness of its own.
                [own, other] if own.min(other) <= NONE * own.max(other) => own.max(other),
                [own, other] => 1.0 / (1.0 / own + 1.0 / other),
            }
        };
        boundary.points.iter().map(of_point).collect()
    }
}

/// The unknowns of the one node of a point, if no other point sees it and nothing is prescribed there.
fn own_node(point: &PointOnBoundary, seen: &[usize], unknown: &[Option<u32>], dim: usize) -> Option<[u32; 3]> {
    let &[(node, value)] = point.nodes.as_slice() else { return None };
    if value.to_bits() != 1f64.to_bits() || seen[node] != 1 {
        return None;
    }
    let mut unknowns = [0; 3];
    for c in 0..dim {
        unknowns[c] = unknown[node * dim + c]?;
    }
    Some(unknowns)
}

/// Data on the values at the contact nodes, followed by the motions of rigid bodies.
struct OnNodes<'a> {
    unknown: &'a [Option<u32>],
    prescribed: &'a [f64],
    space: &'a Space,
    nodes: &'a [u32],
}

/// The degrees of freedom that move a contact node, by their numbers in lists by contact node and motion of rigid
/// bodies, with what they move it by; without a space that of a scalar.
fn degrees(space: Option<&Space>, nodes: &[u32], node: usize) -> Vec<(usize, Point)> {
    let Some(space) = space else { return vec![(node, [1.0, 0.0, 0.0])] };
    let n = space.components;
    let Some((body, position)) = rigid_of(&space.rigid, nodes[node]) else {
        let directions = space.directions(nodes[node]);
        return (0..n).map(|c| (node * n + c, directions[c])).collect();
    };
    let before: usize = space.rigid.iter().take(body).map(|body| body.slots().len()).sum();
    let first = (nodes.len() + before) * n;
    space.rigid[body].at(position).enumerate().map(|(j, motion)| (first + j, motion)).collect()
}

/// The row of a point, its entries appended to those of the others.
fn vector_row(
    point: &PointOnBoundary,
    basis: [Point; 3],
    turn: Option<&Turn>,
    on_nodes: &OnNodes,
    entries: &mut Vec<Share>,
) -> Row {
    let OnNodes { unknown, prescribed, space, nodes } = *on_nodes;
    let dim = space.components;
    let (first, mut fixed) = (entries.len(), [0.0; 3]);
    if let Some(turn) = turn {
        entries.extend((0..dim).map(|a| (turn.unknowns[a], std::array::from_fn(|b| f64::from(u8::from(a == b))))));
    } else {
        for (node, value, turn) in point.entries() {
            for (at, direction) in degrees(Some(space), nodes, node) {
                let direction = turn.map_or(direction, |turn| turn.vector(&direction));
                let on: Local = std::array::from_fn(|a| value * cosine(&basis[a], &direction));
                match unknown[at] {
                    Some(unknown) => entries.push((unknown, on)),
                    None => fixed = std::array::from_fn(|a| fixed[a] + on[a] * prescribed[at]),
                }
            }
        }
    }
    Row { weight: point.weight, contact: point.contact, basis, entries: first..entries.len(), prescribed: fixed }
}

/// The cosine of the angle between two unit vectors; zero where it is round-off, so that what is prescribed in one
/// direction does not move a point in another.
fn cosine(a: &Point, b: &Point) -> f64 {
    let cosine = dot(a, b);
    if cosine.abs() < NOTHING { 0.0 } else { cosine }
}

/// The basis of a point. A tangent along which friction has no component is the last, and so is one along which the
/// node of a foundation is held in no direction of the axes.
fn basis_at(point: &PointOnBoundary, nodes: &[u32], normal: &Point, space: &Space) -> [Point; 3] {
    let usual = basis(normal, space.components);
    if space.components < 3 {
        return usual;
    }
    let with_last = |held: Point| {
        let first = cross(&held, normal);
        let first = first.map(|c| c / length(&first));
        [*normal, first, cross(normal, &first)]
    };
    if let Some(held) = given(&point.held).next() {
        return with_last(*held);
    }
    let &[(node, _)] = point.nodes.as_slice() else { return usual };
    if !space.is_turned(nodes[node]) {
        return usual;
    }
    let tangent = space.held_directions(nodes[node]).find(|held| dot(held, normal).abs() < ALONG);
    tangent.map_or(usual, with_last)
}

/// ν with two unit tangents across it and each other. Those of the space of the body come first: which is of no account
/// there.
#[must_use]
pub fn basis(normal: &Point, dim: usize) -> [Point; 3] {
    let n = *normal;
    match dim {
        1 => [n, [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        2 => [n, [-n[1], n[0], 0.0], [0.0, 0.0, 1.0]],
        _ => {
            // The axis that is farthest from ν.
            let least = (0..3).min_by(|&a, &b| n[a].abs().total_cmp(&n[b].abs())).unwrap_or(0);
            let axis: Point = std::array::from_fn(|c| f64::from(u8::from(c == least)));
            let across = cross(&n, &axis);
            let first = across.map(|c| c / length(&across));
            [n, first, cross(&n, &first)]
        }
    }
}
