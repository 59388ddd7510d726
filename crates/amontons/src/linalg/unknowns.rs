//! The unknowns of a matrix, where they are, and the order in which they are eliminated.

use std::borrow::Cow;
use std::sync::Arc;

use rayon::prelude::*;

use super::estimate::Choice;
use super::graph::Graph;
use super::ordering::{Ordering, nested_dissection};
use super::relief::Relief;
use super::sparse::BlockMatrix;
use super::vectors::{BLOCK, copy, zeros};
use crate::mesh::{Link, Mesh, leader};
use crate::space::rigid::rigid_of;
use crate::space::{self, NodeFrame, RigidNodes, Space, frame, links};
use crate::tensor::Point;

/// Where the unknowns of a matrix are.
#[derive(Clone, Copy, Debug)]
pub struct Layout<'a> {
    /// Coordinates of the nodes.
    pub points: &'a [Point],
    /// Unknowns of a node.
    pub components: usize,
    /// Whether a degree of freedom, node-major, is free.
    pub free: &'a [bool],
    /// Directions of the degrees of freedom where they are not the axes.
    pub frames: &'a [NodeFrame],
    /// Nodes that follow others; what is at them is at these.
    pub links: &'a [Link],
    /// Nodes that move as rigid bodies; what is at them is at the first of them.
    pub rigid: &'a [RigidNodes],
    /// Nodes whose unknowns are kept.
    pub contact: &'a [u32],
}

impl<'a> Layout<'a> {
    /// The unknowns of a space on a mesh.
    #[must_use]
    pub fn of(mesh: &'a Mesh, space: &'a Space, contact: &'a [u32]) -> Layout<'a> {
        let Space { components, free, frames, links, rigid, .. } = space;
        Layout { points: &mesh.points, components: *components, free, frames, links, rigid, contact }
    }

    /// Where unknowns are that have an order.
    #[must_use]
    pub fn unknowns(&self, dofs: Vec<u32>, interior: usize) -> Unknowns {
        let frames = (self.frames.into(), self.components);
        let mut position = vec![u32::MAX; self.free.len()];
        dofs.iter().enumerate().for_each(|(k, &dof)| position[dof as usize] = k as u32);
        let (links, rigid) = (self.links.into(), self.rigid.into());
        Unknowns { dofs, position, interior, points: Arc::new([]), frames, links, rigid, choice: None, relief: None }
    }

    /// The matrix of the unknowns: in their directions, without the nodes that follow others, and with the motions of
    /// rigid bodies.
    #[must_use]
    pub fn matrix(&self, matrix: &Arc<BlockMatrix>) -> Arc<BlockMatrix> {
        matrix.in_frames(self.frames).linked(self.links).rigid(self.rigid)
    }

    /// The graph of the unknowns: without the nodes that follow others, and with the motions of rigid bodies.
    #[must_use]
    pub fn graph<'g>(&self, graph: &'g Graph) -> Cow<'g, Graph> {
        let linked = if self.links.is_empty() { Cow::Borrowed(graph) } else { Cow::Owned(graph.linked(self.links)) };
        if self.rigid.is_empty() { linked } else { Cow::Owned(linked.rigid(self.rigid)) }
    }

    /// Whether all nodes have unknowns of their own.
    fn is_plain(&self) -> bool {
        self.links.is_empty() && self.rigid.is_empty()
    }

    /// Orders the nodes that have an unknown by nested dissection, the contact nodes last.
    #[must_use]
    pub fn ordering(&self, graph: &Graph) -> Ordering {
        let keep: Vec<bool> = self.free.chunks_exact(self.components).map(|node| node.contains(&true)).collect();
        if self.is_plain() {
            return nested_dissection(graph, self.points, &keep, self.contact);
        }
        nested_dissection(graph, self.points, &keep, &self.leading_contact())
    }

    /// The contact nodes, ascending, with the nodes that they follow in place of those that follow others, and those of
    /// the motions in place of the nodes of rigid bodies.
    #[must_use]
    pub fn leading_contact(&self) -> Vec<u32> {
        let mut contact: Vec<u32> = Vec::with_capacity(self.contact.len());
        for &node in self.contact {
            match rigid_of(self.rigid, node) {
                Some((body, _)) => contact.extend(self.rigid[body].slots()),
                None => contact.push(leader(self.links, node)),
            }
        }
        contact.sort_unstable();
        contact.dedup();
        contact
    }
}

/// The unknowns of a system in elimination order: those that are eliminated, then those that are kept.
#[derive(Clone, Debug)]
pub struct Unknowns {
    /// Degree of freedom at each position.
    pub dofs: Vec<u32>,
    /// Position of each degree of freedom; the largest number for those that are no unknowns.
    pub position: Vec<u32>,
    /// How many positions are eliminated: the interior.
    pub interior: usize,
    /// Coordinates of all nodes, for a backend that asks for them; may be empty.
    pub points: Arc<[Point]>,
    /// Directions of the degrees of freedom of nodes where they are not the axes, and the number of those of a node.
    pub frames: (Arc<[NodeFrame]>, usize),
    /// Nodes that follow others.
    pub links: Arc<[Link]>,
    /// Nodes that move as rigid bodies.
    pub rigid: Arc<[RigidNodes]>,
    /// How systems are solved and why, where a backend has chosen.
    pub choice: Option<Arc<Choice>>,
    /// When an iteration is left for a factor; none where it is not.
    pub relief: Option<Arc<Relief>>,
}

impl Unknowns {
    /// Orders the degrees of freedom that are free by nested dissection, those of the contact nodes last.
    #[must_use]
    pub fn new(matrix: &BlockMatrix, layout: &Layout) -> Unknowns {
        Unknowns::ordered(&layout.ordering(matrix.graph()), layout)
    }

    /// The degrees of freedom that are free in the order of their nodes.
    #[must_use]
    pub fn ordered(ordering: &Ordering, layout: &Layout) -> Unknowns {
        let Layout { components, free, .. } = *layout;
        let (mut dofs, mut interior) = (Vec::new(), 0);
        for (k, &node) in ordering.order.iter().enumerate() {
            dofs.extend((0..components as u32).map(|c| node * components as u32 + c).filter(|&d| free[d as usize]));
            if k < ordering.interior {
                interior = dofs.len();
            }
        }
        layout.unknowns(dofs, interior)
    }

    /// [`Layout::matrix`].
    #[must_use]
    pub fn matrix(&self, matrix: &Arc<BlockMatrix>) -> Arc<BlockMatrix> {
        matrix.in_frames(&self.frames.0).linked(&self.links).rigid(&self.rigid)
    }

    /// Number of unknowns.
    #[must_use]
    pub fn len(&self) -> usize {
        self.dofs.len()
    }

    /// The unknowns that are motions of rigid bodies, with the mean stiffness of a node of the body as it would be
    /// without the others: the motion of a rigid body may have no stiffness but round-off, as that of a loose part has.
    #[must_use]
    pub fn rigid_stiffness(&self, matrix: &BlockMatrix) -> Vec<(usize, f64)> {
        let n = self.frames.1.max(1);
        let mut all = Vec::new();
        for body in self.rigid.iter() {
            let motions: Vec<usize> = (0..body.motions.len()).map(|j| body.dof(j)).collect();
            let dofs = body.nodes.iter().flat_map(|&node| (0..n).map(move |c| node as usize * n + c));
            let own: Vec<f64> = dofs
                .filter(|dof| !motions.contains(dof))
                .map(|dof| matrix.get(dof / n, dof % n, dof / n, dof % n).abs())
                .collect();
            let mean = own.iter().sum::<f64>() / own.len().max(1) as f64;
            let known = motions.into_iter().filter_map(|dof| self.position.get(dof)).map(|at| *at as usize);
            all.extend(known.filter(|&at| at < self.dofs.len()).map(|at| (at, mean)));
        }
        all
    }

    /// Whether there is nothing to solve for.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.dofs.is_empty()
    }

    /// Degrees of freedom of the unknowns that are kept.
    #[must_use]
    pub fn kept(&self) -> &[u32] {
        &self.dofs[self.interior..]
    }

    /// The first kept unknown of each node, counted from the first of all, with `components` degrees of freedom per
    /// node.
    #[must_use]
    pub fn kept_nodes(&self, components: usize) -> Vec<usize> {
        let node = |dof: u32| dof as usize / components.max(1);
        let kept = self.kept();
        (0..kept.len()).filter(|&i| i == 0 || node(kept[i]) != node(kept[i - 1])).collect()
    }

    /// The number of each degree of freedom among the unknowns that are kept; none where it is not kept. At a node that
    /// follows another one they are those of that node. `size` is the number of degrees of freedom.
    #[must_use]
    pub fn positions(&self, size: usize) -> Vec<Option<u32>> {
        let mut positions = vec![None; size];
        for (k, &dof) in self.kept().iter().enumerate() {
            positions[dof as usize] = Some(k as u32);
        }
        let components = self.frames.1;
        for Link { node, to, .. } in self.links.iter() {
            let [own, followed] = [node, to].map(|node| *node as usize * components);
            positions.copy_within(followed..followed + components, own);
        }
        positions
    }

    /// A vector by its components along the degrees of freedom.
    fn entered<'v>(&self, full: &'v [f64]) -> Cow<'v, [f64]> {
        if self.frames.0.is_empty() && self.rigid.is_empty() {
            return Cow::Borrowed(full);
        }
        let mut values = full.to_vec();
        space::enter(&self.frames.0, &self.rigid, self.frames.1, &mut values);
        Cow::Owned(values)
    }

    /// From components along the degrees of freedom to those along the axes.
    fn leave(&self, full: &mut [f64]) {
        space::leave(&self.frames.0, &self.rigid, self.frames.1, full);
    }

    /// The directions of the degrees of freedom of a node.
    #[must_use]
    pub fn directions(&self, node: u32) -> [Point; 3] {
        frame::directions(&self.frames.0, node)
    }

    /// Forces over all degrees of freedom, in elimination order; what is at a node that follows another one acts there.
    #[must_use]
    pub fn gather(&self, full: &[f64]) -> Vec<f64> {
        let components = self.frames.1;
        let mut forces = self.entered(full);
        for Link { node, to, .. } in self.links.iter() {
            let [own, followed] = [node, to].map(|node| *node as usize * components);
            for c in 0..components {
                let force = forces[own + c];
                forces.to_mut()[followed + c] += force;
            }
        }
        self.pick(&forces)
    }

    /// Adds a vector in elimination order to its degrees of freedom.
    pub fn add(&self, x: &[f64], full: &mut [f64]) {
        let (frames, components) = (&self.frames.0, self.frames.1);
        if frames.is_empty() && self.rigid.is_empty() {
            self.put(x, full);
        } else {
            let mut change = zeros(full.len());
            self.put(x, &mut change);
            self.leave(&mut change);
            full.iter_mut().zip(change).for_each(|(value, change)| *value += change);
        }
        links::follow(&self.links, frames, components, full);
    }

    /// Forces on the unknowns that are kept, over all degrees of freedom; none at nodes that follow others.
    #[must_use]
    pub fn forces(&self, kept: &[f64], size: usize) -> Vec<f64> {
        let mut full = zeros(size);
        self.kept().iter().zip(kept).for_each(|(&dof, force)| full[dof as usize] = *force);
        self.leave(&mut full);
        full
    }

    /// The sum of [`Unknowns::add`].
    #[must_use]
    pub fn sum(&self, x: &[f64], full: &[f64]) -> Vec<f64> {
        if !self.frames.0.is_empty() || !self.links.is_empty() || !self.rigid.is_empty() {
            let mut sum = copy(full);
            self.add(x, &mut sum);
            return sum;
        }
        let entry = |(value, &at): (&f64, &u32)| x.get(at as usize).map_or(*value, |change| value + change);
        full.par_iter().zip(&self.position).with_min_len(BLOCK).map(entry).collect()
    }

    /// The unknowns that are kept of a vector over all degrees of freedom.
    #[must_use]
    pub fn kept_of(&self, full: &[f64]) -> Vec<f64> {
        let full = self.entered(full);
        self.kept().iter().map(|&d| full[d as usize]).collect()
    }

    /// [`Unknowns::gather`] from a vector that is in the directions of the degrees of freedom, as the matrix of a
    /// factor is.
    #[must_use]
    pub fn pick(&self, full: &[f64]) -> Vec<f64> {
        self.dofs.par_iter().with_min_len(BLOCK).map(|&d| full[d as usize]).collect()
    }

    /// [`Unknowns::add`] to such a vector.
    pub fn put(&self, x: &[f64], full: &mut [f64]) {
        full.par_chunks_mut(BLOCK).zip(self.position.par_chunks(BLOCK)).for_each(|(full, positions)| {
            for (entry, &position) in full.iter_mut().zip(positions) {
                if let Some(value) = x.get(position as usize) {
                    *entry += value;
                }
            }
        });
    }
}
