//! Degrees of freedom: node-major components, some of them prescribed.

pub(crate) mod frame;
pub(crate) mod links;
pub(crate) mod rigid;

use std::borrow::Cow;
use std::collections::BTreeMap;

pub use frame::NodeFrame;
pub use rigid::RigidNodes;

use crate::field::Field;
use crate::mesh::{Link, Links, Mesh, leader, link_of};
use crate::tensor::{Point, dot, length};
use rigid::rigid_of;

/// A space of P1 functions with d or 1 components, prescribed on parts of the boundary: V^h or Q^h.
///
/// A degree of freedom is a component of the value at a node, along an axis or, at a node with an oblique prescribed
/// direction, in the [`NodeFrame`] of the node. Vectors passed to the methods always have components along the axes.
///
/// Degrees of freedom of a node that follows another one ([`Link`]) are not free: they are those of its leader. The
/// nodes of a rigid body ([`RigidNodes`]) have the degrees of freedom of its motions, stored in those of its first
/// nodes.
#[derive(Clone, Debug)]
pub struct Space {
    /// Number of components per node.
    pub components: usize,
    /// For each degree of freedom, true if it is unknown.
    pub free: Vec<bool>,
    /// Directions of the degrees of freedom of nodes where they differ from the axes, by node.
    pub frames: Vec<NodeFrame>,
    /// Nodes that follow others.
    pub links: Vec<Link>,
    /// Nodes that move as rigid bodies.
    pub rigid: Vec<RigidNodes>,
    prescribed: Vec<Prescribed>,
    /// The prescribed degrees of freedom.
    held: Vec<u32>,
    /// For each of them, number of the prescription that gives its value, and its index there.
    given: Vec<(usize, usize)>,
}

/// A direction in which values are prescribed on a facet set.
#[derive(Clone, Copy, Debug)]
pub struct Prescription<'a> {
    /// Name of the side, the edge or the points.
    pub on: &'a str,
    /// The direction, a unit vector; for scalars the first axis.
    pub direction: Point,
    /// The value along it.
    pub field: &'a Field,
}

/// Values that replace those of some prescriptions during a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Replacing<'a> {
    /// By number of the prescription, one value per node at which it gives the value: see [`Space::nodes_of`].
    pub values: &'a BTreeMap<usize, Vec<f64>>,
    /// Share of the way from the values at the start of the step to the new ones: less than 1 in a part of a step.
    pub share: f64,
}

/// The values given by one prescription.
#[derive(Clone, Debug)]
struct Prescribed {
    field: Field,
    nodes: Vec<u32>,
    points: Vec<Point>,
    dofs: Vec<u32>,
    /// Factor of the field at each of them.
    factors: Vec<f64>,
    /// Multiples of values prescribed before that are subtracted if directions are not orthogonal.
    less: Vec<(u32, u32, f64)>,
}

/// Length of the component of a direction orthogonal to those prescribed before that counts as zero: the least
/// precision of mesh files.
const ACROSS: f64 = 1e-6;
/// Cosine above which two directions count as equal.
const PARALLEL: f64 = 1.0 - 1e-12;
/// Relative difference of two values that are equal up to round-off.
const SAME: f64 = 1e-12;

impl Space {
    /// The space with some directions prescribed on parts of the boundary. At a node of two facet sets the first
    /// prescription of a direction counts.
    pub fn new<'a>(mesh: &Mesh, components: usize, prescriptions: impl IntoIterator<Item = Prescription<'a>>) -> Space {
        Space::linked(mesh, components, prescriptions, Links::default(), Vec::new())
    }

    /// Like [`Space::new`], with nodes that follow others, and nodes that move as rigid bodies. A value prescribed at a
    /// follower is prescribed at its leader; a value prescribed at a node of a rigid body is a condition on its motion.
    /// A node belongs to at most one body, and not to both a body and a link.
    pub fn linked<'a>(
        mesh: &Mesh,
        components: usize,
        prescriptions: impl IntoIterator<Item = Prescription<'a>>,
        links: Links,
        mut rigid: Vec<RigidNodes>,
    ) -> Space {
        static ZERO: Field = Field::ZERO;
        let of_side = |given: Prescription<'a>| {
            let nodes = mesh.named(given.on)?.node_list();
            let at = |node: u32| links::given(&links, node, given.direction, components);
            Some((given.field, nodes.into_iter().map(|node| (node, at(node))).collect::<Vec<_>>()))
        };
        let on_axis = links::held_on_axis(&links, components);
        let prescriptions: Vec<_> =
            prescriptions.into_iter().filter_map(of_side).chain(on_axis.map(|at| (&ZERO, at))).collect();
        let all = || prescriptions.iter().flat_map(|(_, nodes)| nodes);
        let oblique =
            all().filter(|(_, (node, direction))| axis(direction).is_none() && rigid_of(&rigid, *node).is_none());
        let mut axes: BTreeMap<u32, Vec<Point>> = oblique.map(|(_, (node, _))| (*node, Vec::new())).collect();
        let mut free = vec![true; mesh.points.len() * components];
        let mut prescribed = Vec::new();
        for (field, nodes) in &prescriptions {
            let mut part = Prescribed::new(field);
            for &(at, (node, direction)) in nodes {
                let dof = |c: usize| node as usize * components + c;
                let x = mesh.points[at as usize];
                if let Some((body, _)) = rigid_of(&rigid, node) {
                    part.hold(&mut rigid[body], (node, at, x), &direction)
                        .into_iter()
                        .for_each(|new| free[new] = false);
                } else if let Some(axes) = axes.get_mut(&node) {
                    if axes.len() < components
                        && let Some((along, rest, scale)) = across(&direction, axes)
                    {
                        let new = dof(axes.len());
                        free[new] = false;
                        part.push(new, (at, x), 1.0 / scale);
                        part.less.extend((0..).zip(along).map(|(c, along)| (new as u32, dof(c) as u32, along / scale)));
                        axes.push(rest);
                    }
                } else if let Some((c, sign)) = axis(&direction).filter(|(c, _)| *c < components && free[dof(*c)]) {
                    free[dof(c)] = false;
                    part.push(dof(c), (at, x), sign);
                }
            }
            prescribed.push(part);
        }
        let mut frames: Vec<NodeFrame> =
            axes.into_iter().map(|(node, axes)| NodeFrame { node, axes: completed(axes, components) }).collect();
        let held: Vec<u32> = (0u32..).zip(&free).filter_map(|(dof, free)| (!free).then_some(dof)).collect();
        links::add_frames(&links.nodes, components, &mut frames);
        for link in &links.nodes {
            free[link.node as usize * components..][..components].fill(false);
        }
        for body in &rigid {
            body.take(&mut free);
        }
        let given = sources(&held, &prescribed);
        Space { components, free, frames, links: links.nodes, rigid, prescribed, held, given }
    }

    /// The directions of the degrees of freedom of a node.
    #[must_use]
    pub fn directions(&self, node: u32) -> [Point; 3] {
        frame::directions(&self.frames, node)
    }

    /// True if the degrees of freedom of a node have their own directions, or are those of a rigid body.
    #[must_use]
    pub fn is_turned(&self, node: u32) -> bool {
        rigid_of(&self.rigid, node).is_some() || self.frames.binary_search_by_key(&node, |frame| frame.node).is_ok()
    }

    /// The directions in which the value at a node is prescribed.
    pub fn held_directions(&self, node: u32) -> impl Iterator<Item = Point> {
        let leader = leader(&self.links, node);
        let (axes, is_free): ([Point; 3], [bool; 3]) = if let Some((body, position)) = rigid_of(&self.rigid, leader) {
            let free = self.rigid[body].free_directions(position);
            let count = free.len();
            (completed(free, self.components), std::array::from_fn(|c| c < count))
        } else {
            let free = |c: usize| self.free.get(leader as usize * self.components + c).is_none_or(|free| *free);
            (self.directions(node), std::array::from_fn(free))
        };
        (0..self.components.min(3)).filter(move |&c| !is_free[c]).map(move |c| axes[c])
    }

    /// The directions in which the value at a node is prescribed, filled up with zeros.
    #[must_use]
    pub fn held(&self, node: u32) -> [Point; 3] {
        let mut directions = self.held_directions(node);
        std::array::from_fn(|_| directions.next().unwrap_or_default())
    }

    /// True if the value at a node is prescribed in all directions.
    #[must_use]
    pub fn is_held(&self, node: u32) -> bool {
        self.held_directions(node).count() == self.components
    }

    /// True if the values at two nodes are prescribed alike in a direction: by the same number, or by the same function
    /// of time.
    #[must_use]
    pub fn is_alike(&self, nodes: [u32; 2], direction: &Point) -> bool {
        let [Some(a), Some(b)] = nodes.map(|node| self.source(node, direction)) else { return false };
        let [(first, x, factor), (second, y, other)] = [a, b];
        let is_same = |a: f64, b: f64| (a - b).abs() <= SAME * a.abs().max(b.abs());
        if first.depends_on_time() || second.depends_on_time() {
            return first == second && is_same(factor, other) && !first.depends_on_space();
        }
        is_same(factor * first.value(&x, 0.0), other * second.value(&y, 0.0))
    }

    /// Number of the prescription that gives the value of prescribed degree of freedom `number`.
    #[must_use]
    pub fn prescription_of(&self, number: usize) -> Option<usize> {
        self.given.get(number).map(|(prescription, _)| *prescription)
    }

    /// The field that prescribes the value at a node in a direction, the position at which it is evaluated, and its
    /// factor.
    fn source(&self, node: u32, direction: &Point) -> Option<(&Field, Point, f64)> {
        let (node, direction) = match link_of(&self.links, node) {
            Some(link) => (link.to, link.back(direction)),
            None => (node, *direction),
        };
        let axes = self.directions(node);
        let along = |c: &usize| dot(&axes[*c], &direction).abs() > PARALLEL;
        let component = (0..self.components).find(along)?;
        let dof = (node as usize * self.components + component) as u32;
        let (part, at) = *self.given.get(self.held.binary_search(&dof).ok()?)?;
        let part = self.prescribed.get(part).filter(|part| part.less.iter().all(|(less, ..)| *less != dof))?;
        let sign = dot(&axes[component], &direction).signum();
        Some((&part.field, *part.points.get(at)?, sign * part.factors.get(at)?))
    }

    /// Number of unknowns.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.free.iter().filter(|&&f| f).count()
    }

    /// True if every prescribed value is the number zero.
    #[must_use]
    pub fn is_homogeneous(&self) -> bool {
        self.prescribed.iter().all(|p| p.field.is_zero())
    }

    /// Writes the prescribed values at time t into a vector over all degrees of freedom.
    pub fn prescribe(&self, t: f64, values: &mut [f64]) {
        self.prescribe_with(t, &Replacing { values: &BTreeMap::new(), share: 1.0 }, values);
    }

    /// Nodes at which prescription `number` gives the value, in the order of their values: those of its facet set, less
    /// those at which an earlier prescription counts.
    pub(crate) fn nodes_of(&self, number: usize) -> &[u32] {
        self.prescribed.get(number).map_or(&[], |part| &part.nodes)
    }

    /// Like [`Space::prescribe`], with values that replace those of some prescriptions. `values` holds those at the
    /// start of the step.
    pub(crate) fn prescribe_with(&self, t: f64, replacing: &Replacing, values: &mut [f64]) {
        self.enter(values);
        for (number, part) in self.prescribed.iter().enumerate() {
            let own = replacing.values.get(&number).filter(|own| own.len() == part.dofs.len());
            let moves_on = own.is_some() && replacing.share < 1.0;
            let start: Vec<f64> = part.dofs.iter().filter(|_| moves_on).map(|&dof| values[dof as usize]).collect();
            let given = own.map_or_else(|| Cow::Owned(part.field.values(&part.points, t)), |own| Cow::Borrowed(&**own));
            for ((&dof, factor), value) in part.dofs.iter().zip(&part.factors).zip(given.iter()) {
                values[dof as usize] = factor * value;
            }
            for &(dof, other, factor) in &part.less {
                values[dof as usize] -= factor * values[other as usize];
            }
            for (&dof, start) in part.dofs.iter().zip(start) {
                values[dof as usize] = start + replacing.share * (values[dof as usize] - start);
            }
        }
        self.each_linked(|own, followed| {
            if !self.free[followed] {
                values[own] = values[followed];
            }
        });
        self.leave(values);
    }

    /// Writes the rates (u_D(t) − ū)/k of the prescribed values into velocities; returns true if that changes them.
    pub(crate) fn prescribe_rates(&self, [t, k]: [f64; 2], replacing: &Replacing, bar: &[f64], w: &mut [f64]) -> bool {
        let (mut values, mut changes) = (bar.to_vec(), false);
        self.prescribe_with(t, replacing, &mut values);
        let (values, bar) = (self.in_frames(&values), self.in_frames(bar));
        self.enter(w);
        for dof in self.held.iter().map(|&dof| dof as usize) {
            let rate = (values[dof] - bar[dof]) / k;
            changes |= w[dof] - rate != 0.0;
            w[dof] = rate;
        }
        self.each_linked(|own, followed| w[own] = w[followed]);
        self.leave(w);
        changes
    }

    /// Calls `act` with each following degree of freedom and its leader.
    fn each_linked(&self, mut act: impl FnMut(usize, usize)) {
        for link in &self.links {
            for c in 0..self.components {
                act(link.node as usize * self.components + c, link.to as usize * self.components + c);
            }
        }
    }

    /// Copies the values of leading nodes to their followers.
    pub fn follow(&self, values: &mut [f64]) {
        links::follow(&self.links, &self.frames, self.components, values);
    }

    /// Moves the forces at followers to their leaders; forces at the nodes of rigid bodies are replaced by nodal forces
    /// that do the same work along their motions and no other work.
    pub fn gather(&self, forces: &mut [f64]) {
        if !self.links.is_empty() || !self.rigid.is_empty() {
            self.enter(forces);
            self.each_linked(|own, followed| forces[followed] += std::mem::take(&mut forces[own]));
            self.leave(forces);
        }
    }

    /// A vector in components along the directions of the degrees of freedom.
    #[must_use]
    pub fn in_frames<'v>(&self, values: &'v [f64]) -> Cow<'v, [f64]> {
        if self.rigid.is_empty() {
            return frame::entered(&self.frames, self.components, values);
        }
        let mut values = values.to_vec();
        self.enter(&mut values);
        Cow::Owned(values)
    }

    /// Converts components along the axes to those along the degrees of freedom.
    fn enter(&self, values: &mut [f64]) {
        enter(&self.frames, &self.rigid, self.components, values);
    }

    /// Converts components along the degrees of freedom to those along the axes.
    fn leave(&self, values: &mut [f64]) {
        leave(&self.frames, &self.rigid, self.components, values);
    }

    /// The given nodes, followed by those that hold the motions of rigid bodies.
    pub fn with_rigid<'s>(&'s self, nodes: &'s [u32]) -> impl Iterator<Item = u32> + 's {
        nodes.iter().chain(self.rigid.iter().flat_map(RigidNodes::slots)).copied()
    }

    /// True if a node is one of a rigid body.
    #[must_use]
    pub fn is_rigid(&self, node: u32) -> bool {
        rigid_of(&self.rigid, node).is_some()
    }

    /// Largest magnitude of the forces at some nodes on free degrees of freedom: the residual of equations that are
    /// solved.
    #[must_use]
    pub fn largest_at(&self, nodes: &[u32], forces: &[f64]) -> f64 {
        let mut values = self.in_frames(forces);
        if !self.links.is_empty() {
            let values = values.to_mut();
            self.each_linked(|own, followed| values[followed] += values[own]);
        }
        let dofs =
            nodes.iter().flat_map(|&node| (0..self.components).map(move |c| node as usize * self.components + c));
        dofs.filter(|&dof| self.free[dof]).fold(0.0, |most, dof| most.max(values[dof].abs()))
    }

    /// The entries of the prescribed degrees of freedom, in their order.
    #[must_use]
    pub fn prescribed_of(&self, values: &[f64]) -> Vec<f64> {
        let values = self.in_frames(values);
        self.held.iter().map(|&dof| values[dof as usize]).collect()
    }

    /// Forces over all degrees of freedom, in components along the axes, from those of the prescribed ones in their
    /// order.
    pub(crate) fn nodal(&self, held: &[f64]) -> Vec<f64> {
        let mut values = vec![0.0; self.free.len()];
        for (&dof, force) in self.held.iter().zip(held) {
            values[dof as usize] = *force;
        }
        self.leave(&mut values);
        values
    }

    /// Sets the entries of prescribed degrees of freedom to zero; entries of followers must have been gathered.
    pub fn mask(&self, values: &mut [f64]) {
        self.enter(values);
        self.held.iter().for_each(|&dof| values[dof as usize] = 0.0);
        self.leave(values);
    }

    /// Sets all entries except those of prescribed degrees of freedom to zero.
    pub fn mask_free(&self, values: &mut [f64]) {
        self.enter(values);
        values.iter_mut().zip(&self.free).filter(|(_, free)| **free).for_each(|(value, _)| *value = 0.0);
        self.each_linked(|own, followed| values[own] = values[followed]);
        self.leave(values);
    }

    /// The interpolant of fields, one per component; missing fields are zero.
    #[must_use]
    pub fn interpolate(&self, mesh: &Mesh, fields: &[Field], t: f64) -> Vec<f64> {
        let mut values = vec![0.0; mesh.points.len() * self.components];
        for (c, field) in fields.iter().enumerate().take(self.components) {
            for (node, value) in field.values(&mesh.points, t).into_iter().enumerate() {
                values[node * self.components + c] = value;
            }
        }
        self.follow(&mut values);
        if !self.rigid.is_empty() {
            self.enter(&mut values);
            self.leave(&mut values);
        }
        values
    }
}

/// Converts components along the axes to those in frames, and for rigid bodies to those of their motions.
pub(crate) fn enter(frames: &[NodeFrame], rigid: &[RigidNodes], components: usize, values: &mut [f64]) {
    frame::enter(frames, components, values);
    for body in rigid {
        body.enter(values);
    }
}

/// Converts these components back to those along the axes.
pub(crate) fn leave(frames: &[NodeFrame], rigid: &[RigidNodes], components: usize, values: &mut [f64]) {
    frame::leave(frames, components, values);
    for body in rigid {
        body.leave(values);
    }
}

impl Prescribed {
    fn new(field: &Field) -> Prescribed {
        let (nodes, points, dofs, factors, less) = Default::default();
        Prescribed { field: field.clone(), nodes, points, dofs, factors, less }
    }

    /// Prescribes the value of a node of a rigid body in a direction; returns the degree of freedom of the motion
    /// prescribed by it, or `None` if it was prescribed before.
    ///
    /// The field is evaluated at the node `at`, which may follow `node`.
    fn hold(&mut self, body: &mut RigidNodes, (node, at, x): (u32, u32, Point), direction: &Point) -> Option<usize> {
        let (number, along, scale) = body.hold(node, direction)?;
        let new = body.dof(number);
        self.push(new, (at, x), 1.0 / scale);
        let less = |(j, along): (usize, f64)| (new as u32, body.dof(j) as u32, along / scale);
        self.less.extend(along.into_iter().enumerate().map(less));
        Some(new)
    }

    fn push(&mut self, dof: usize, (node, x): (u32, Point), factor: f64) {
        self.dofs.push(dof as u32);
        self.nodes.push(node);
        self.points.push(x);
        self.factors.push(factor);
    }
}

/// For each prescribed degree of freedom, in order, number of the prescription that gives its value last, and its index
/// there.
fn sources(held: &[u32], prescribed: &[Prescribed]) -> Vec<(usize, usize)> {
    let mut given = vec![(usize::MAX, 0); held.len()];
    for (number, part) in prescribed.iter().enumerate() {
        for (at, dof) in part.dofs.iter().enumerate() {
            if let Ok(place) = held.binary_search(dof) {
                given[place] = (number, at);
            }
        }
    }
    given
}

/// The axis along which a direction lies, with its sign; `None` if it is oblique.
fn axis(direction: &Point) -> Option<(usize, f64)> {
    let c = (0..3).find(|&c| direction[c] != 0.0)?;
    (0..3).all(|d| d == c || direction[d] == 0.0).then(|| (c, direction[c].signum()))
}

/// The components of a direction along others, and the direction and length of the remainder; `None` if it is zero.
fn across(direction: &Point, axes: &[Point]) -> Option<(Vec<f64>, Point, f64)> {
    let along: Vec<f64> = axes.iter().map(|axis| dot(direction, axis)).collect();
    let mut rest = *direction;
    // Done twice, so that the remainder is orthogonal to the last digit.
    for _ in 0..2 {
        for axis in axes {
            let share = dot(&rest, axis);
            rest = std::array::from_fn(|c| rest[c] - share * axis[c]);
        }
    }
    let scale = length(&rest);
    (scale > ACROSS).then(|| (along, rest.map(|c| c / scale), scale))
}

/// Directions completed to a basis of the first `components` axes, by the remainders of these.
fn completed(mut axes: Vec<Point>, components: usize) -> [Point; 3] {
    while axes.len() < components {
        let unit = |c: usize| -> Point { std::array::from_fn(|d| f64::from(u8::from(c == d))) };
        let rests = (0..components).filter_map(|c| across(&unit(c), &axes));
        let Some((_, rest, _)) = rests.reduce(|best, next| if next.2 > best.2 + 0.01 { next } else { best }) else {
            break;
        };
        axes.push(rest);
    }
    std::array::from_fn(|a| axes.get(a).copied().unwrap_or_default())
}
