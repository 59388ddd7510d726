//! The unknowns of a matrix, their location, and their elimination order.

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

/// Location of the unknowns of a matrix on the nodes of a mesh.
#[derive(Clone, Copy, Debug)]
pub struct Layout<'a> {
    /// Coordinates of the nodes.
    pub points: &'a [Point],
    /// Number of unknowns per node.
    pub components: usize,
    /// Free degrees of freedom, node-major: true if free.
    pub free: &'a [bool],
    /// Directions of the degrees of freedom of nodes where they are not the axes.
    pub frames: &'a [NodeFrame],
    /// Nodes that follow others; their unknowns are those of the followed nodes.
    pub links: &'a [Link],
    /// Nodes that move as rigid bodies; their unknowns are at the first nodes of the body.
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

    /// The unknowns in a given elimination order, on this layout.
    #[must_use]
    pub fn unknowns(&self, dofs: Vec<u32>, interior: usize) -> Unknowns {
        let frames = (self.frames.into(), self.components);
        let mut position = vec![u32::MAX; self.free.len()];
        dofs.iter().enumerate().for_each(|(k, &dof)| position[dof as usize] = k as u32);
        let (links, rigid) = (self.links.into(), self.rigid.into());
        Unknowns { dofs, position, interior, points: Arc::new([]), frames, links, rigid, choice: None, relief: None }
    }

    /// The matrix on the unknowns: in their directions, with following nodes eliminated, and with the motions of rigid
    /// bodies.
    #[must_use]
    pub fn matrix(&self, matrix: &Arc<BlockMatrix>) -> Arc<BlockMatrix> {
        matrix.in_frames(self.frames).linked(self.links).rigid(self.rigid)
    }

    /// The graph of the unknowns: with following nodes eliminated, and with the motions of rigid bodies.
    #[must_use]
    pub fn graph<'g>(&self, graph: &'g Graph) -> Cow<'g, Graph> {
        let linked = if self.links.is_empty() { Cow::Borrowed(graph) } else { Cow::Owned(graph.linked(self.links)) };
        if self.rigid.is_empty() { linked } else { Cow::Owned(linked.rigid(self.rigid)) }
    }

    /// True if all nodes have unknowns of their own.
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

    /// The contact nodes, ascending, with following nodes replaced by the nodes that they follow, and nodes of rigid
    /// bodies by the nodes that hold the motions.
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
    /// Degree of freedom per position.
    pub dofs: Vec<u32>,
    /// Position per degree of freedom; the largest `u32` for those that are no unknowns.
    pub position: Vec<u32>,
    /// Number of eliminated positions: the interior.
    pub interior: usize,
    /// Coordinates of all nodes, for a backend that needs them; may be empty.
    pub points: Arc<[Point]>,
    /// Directions of the degrees of freedom of nodes where they are not the axes, and the number of degrees of freedom
    /// per node.
    pub frames: (Arc<[NodeFrame]>, usize),
    /// Nodes that follow others.
    pub links: Arc<[Link]>,
    /// Nodes that move as rigid bodies.
    pub rigid: Arc<[RigidNodes]>,
    /// Choice of the solver with its reason, or `None` if the backend did not choose.
    pub choice: Option<Arc<Choice>>,
    /// Rule for replacing an iteration by a factor, or `None` if it is never replaced.
    pub relief: Option<Arc<Relief>>,
}

impl Unknowns {
    /// Orders the free degrees of freedom by nested dissection, those of the contact nodes last.
    #[must_use]
    pub fn new(matrix: &BlockMatrix, layout: &Layout) -> Unknowns {
        Unknowns::ordered(&layout.ordering(matrix.graph()), layout)
    }

    /// The free degrees of freedom in the order of their nodes.
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

    /// The matrix on the unknowns, as [`Layout::matrix`].
    #[must_use]
    pub fn matrix(&self, matrix: &Arc<BlockMatrix>) -> Arc<BlockMatrix> {
        matrix.in_frames(&self.frames.0).linked(&self.links).rigid(&self.rigid)
    }

    /// Number of unknowns.
    #[must_use]
    pub fn len(&self) -> usize {
        self.dofs.len()
    }

    /// Unknowns that are rigid motions, each with a stiffness of its body: the mean diagonal entry of the body's other
    /// degrees of freedom. A rigid motion itself may have no stiffness but round-off, as that of a loose part has.
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

    /// True if there are no unknowns.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.dofs.is_empty()
    }

    /// Degrees of freedom of the kept unknowns.
    #[must_use]
    pub fn kept(&self) -> &[u32] {
        &self.dofs[self.interior..]
    }

    /// First kept unknown per node, counted from the first kept one, with `components` degrees of freedom per node.
    #[must_use]
    pub fn kept_nodes(&self, components: usize) -> Vec<usize> {
        let node = |dof: u32| dof as usize / components.max(1);
        let kept = self.kept();
        (0..kept.len()).filter(|&i| i == 0 || node(kept[i]) != node(kept[i - 1])).collect()
    }

    /// Number of each degree of freedom among the kept unknowns, or `None` if it is not kept. A following node has the
    /// numbers of the node that it follows. `size` is the number of degrees of freedom.
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

    /// Transforms a vector from components along the axes to those along the degrees of freedom.
    fn entered<'v>(&self, full: &'v [f64]) -> Cow<'v, [f64]> {
        if self.frames.0.is_empty() && self.rigid.is_empty() {
            return Cow::Borrowed(full);
        }
        let mut values = full.to_vec();
        space::enter(&self.frames.0, &self.rigid, self.frames.1, &mut values);
        Cow::Owned(values)
    }

    /// Transforms a vector from components along the degrees of freedom to those along the axes.
    fn leave(&self, full: &mut [f64]) {
        space::leave(&self.frames.0, &self.rigid, self.frames.1, full);
    }

    /// Directions of the degrees of freedom of a node.
    #[must_use]
    pub fn directions(&self, node: u32) -> [Point; 3] {
        frame::directions(&self.frames.0, node)
    }

    /// Gathers forces over all degrees of freedom in elimination order; a force at a following node acts at the node
    /// that it follows.
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

    /// Forces on the kept unknowns, over all degrees of freedom; zero at nodes that follow others.
    #[must_use]
    pub fn forces(&self, kept: &[f64], size: usize) -> Vec<f64> {
        let mut full = zeros(size);
        self.kept().iter().zip(kept).for_each(|(&dof, force)| full[dof as usize] = *force);
        self.leave(&mut full);
        full
    }

    /// Returns the sum of [`Unknowns::add`].
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

    /// The kept unknowns of a vector over all degrees of freedom.
    #[must_use]
    pub fn kept_of(&self, full: &[f64]) -> Vec<f64> {
        let full = self.entered(full);
        self.kept().iter().map(|&d| full[d as usize]).collect()
    }

    /// [`Unknowns::gather`] from a vector that is already along the directions of the degrees of freedom, as is the
    /// matrix of a factor.
    #[must_use]
    pub fn pick(&self, full: &[f64]) -> Vec<f64> {
        self.dofs.par_iter().with_min_len(BLOCK).map(|&d| full[d as usize]).collect()
    }

    /// [`Unknowns::add`] to a vector along the directions of the degrees of freedom.
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
