//! Sides and regions that move as rigid bodies.

use std::collections::BTreeSet;

use super::boundary::unknown;
use super::{Fault, ProblemData};
use crate::field::Field;
use crate::mesh::defects::components;
use crate::mesh::{Mesh, cross};
use crate::space::{RigidNodes, Space};
use crate::tensor::{Point, dot, length};
use crate::time::During;

/// A side, region, edge or set of points that moves as one rigid body with small rotations, and its loads.
///
/// Loads move and rotate the part. Conditions of other sides or points hold it at the nodes they share with it. A
/// region has the mass of its material.
#[derive(Clone, Debug)]
pub struct RigidPart {
    /// Name of the side, region, edge or points.
    pub on: String,
    /// Force in N, per unit of thickness in the plane, one field of time per component; empty for none.
    pub force: Vec<Field>,
    /// Moment in N m about the point of action of the force: three fields of time in space, one in the plane; empty for
    /// none.
    pub moment: Vec<Field>,
    /// The phases in which force and moment act.
    pub during: During,
    /// Point of action of the force, m, or `None` for the centre of the area of a side or the volume of a region.
    pub at: Option<Point>,
    /// True if it can rotate; otherwise it keeps its direction, as a guided platen.
    pub turns: bool,
}

impl RigidPart {
    /// A part without loads.
    #[must_use]
    pub fn on(on: impl Into<String>) -> RigidPart {
        RigidPart { on: on.into(), force: Vec::new(), moment: Vec::new(), during: During::Run, at: None, turns: true }
    }

    /// True if the part is all cells of this region.
    pub(crate) fn is_region(&self, mesh: &Mesh, region: usize) -> bool {
        mesh.named(&self.on).is_none() && self.region(mesh) == Some(region)
    }

    /// The number of its region, or `None` if it is no region.
    fn region(&self, mesh: &Mesh) -> Option<usize> {
        mesh.regions.iter().position(|region| *region == self.on)
    }

    /// Its nodes, ascending; empty if the mesh has no such name.
    #[must_use]
    pub fn nodes(&self, mesh: &Mesh) -> Vec<u32> {
        if let Some(set) = mesh.named(&self.on) {
            return set.node_list();
        }
        let Some(region) = self.region(mesh) else { return Vec::new() };
        let blocks = mesh.blocks.iter().filter(|block| block.region == region);
        let nodes: BTreeSet<u32> = blocks.flat_map(|block| block.nodes.iter().copied()).collect();
        nodes.into_iter().collect()
    }

    /// The centre of its area, volume, length or points, or `None` if the mesh has no such name.
    #[must_use]
    pub fn centre(&self, mesh: &Mesh) -> Option<Point> {
        match mesh.named(&self.on) {
            Some(set) => mesh.centre(set),
            None => mesh.centre_of_region(self.region(mesh)?),
        }
    }
}

/// Relative tolerance for prescribed values of one rigid body, which come from typed digits.
const SAME: f64 = 1e-6;

impl ProblemData {
    /// The nodes of the rigid parts that exist. A part that shares nodes with an earlier one is left out.
    #[must_use]
    pub fn rigid_nodes(&self) -> Vec<RigidNodes> {
        let mut taken: BTreeSet<u32> = BTreeSet::new();
        let mut all = Vec::new();
        for part in &self.rigid {
            let nodes = part.nodes(&self.mesh);
            if !nodes.is_empty() && nodes.iter().all(|node| !taken.contains(node)) {
                taken.extend(&nodes);
                all.push(RigidNodes::new(&self.mesh, nodes, part.turns));
            }
        }
        all
    }

    /// Checks that rigid parts exist, belong to one body each and share no node, and that their conditions and loads
    /// fit a rigid body.
    pub(super) fn check_rigid(&self, faults: &mut Vec<Fault>) {
        // Missing nodes are reported elsewhere.
        if self.rigid.is_empty() || self.mesh.check_nodes().is_err() {
            return;
        }
        let known = faults.len();
        let mut owner = vec![None; self.mesh.points.len()];
        let parts = components(&self.mesh);
        let links = self.links();
        let cut: BTreeSet<u32> = links.nodes.iter().flat_map(|link| [link.node, link.to]).collect();
        for (i, part) in self.rigid.iter().enumerate() {
            let at = format!("rigid[{i}].on");
            let nodes = part.nodes(&self.mesh);
            if nodes.is_empty() {
                let sides = self.mesh.facets.keys().map(String::as_str);
                let names: Vec<&str> = sides.chain(self.mesh.regions.iter().map(String::as_str)).collect();
                faults.push(unknown(at, &part.on, "sides and regions", &names));
                continue;
            }
            let owner_of = |node: &u32| owner.get(*node as usize).copied().flatten();
            if let Some(other) = nodes.iter().find_map(owner_of) {
                let found = format!("\"{}\", which has nodes of rigid[{other}]", part.on);
                let hint = "give both one name (`union` in [[side]]): bodies that share a node move as one";
                faults.push(Fault::new(at, found, "nodes of no other rigid part").hint(hint));
                continue;
            }
            for &node in &nodes {
                owner.get_mut(node as usize).into_iter().for_each(|owner| *owner = Some(i));
            }
            let bodies = parts.iter().filter(|body| nodes.iter().any(|node| body.nodes.binary_search(node).is_ok()));
            if bodies.count() > 1 {
                let hint = "give each body a rigid part of its own, and join the bodies by a tie";
                let found = format!("\"{}\", which is on several bodies", part.on);
                faults.push(Fault::new(at, found, "a side or a region of one body").hint(hint));
                continue;
            }
            if nodes.iter().any(|node| cut.contains(node)) {
                let found = format!("\"{}\", which has nodes of a cut of a sector", part.on);
                faults.push(Fault::new(at, found, "nodes away from the cuts of cyclic sectors"));
                continue;
            }
            self.check_load_of(i, part, faults);
        }
        if faults.len() == known {
            self.check_prescribed_motion(faults);
        }
    }

    /// Checks that the load of a rigid part has the right components, does not vary in space, and moves it.
    fn check_load_of(&self, number: usize, part: &RigidPart, faults: &mut Vec<Fault>) {
        let dim = self.mesh.dim;
        let moments = if self.mesh.axisymmetric { 0 } else { [0, 0, 1, 3].get(dim).copied().unwrap_or(0) };
        for (key, fields, expected) in [("force", &part.force, dim), ("moment", &part.moment, moments)] {
            let path = format!("rigid[{number}].{key}");
            if !fields.is_empty() && fields.len() != expected {
                let expected = match expected {
                    0 => "no moment: this body does not turn".to_owned(),
                    1 => "1 component".to_owned(),
                    n => format!("{n} components"),
                };
                faults.push(Fault::new(&path, format!("{} components", fields.len()), expected));
            }
            if fields.iter().any(Field::depends_on_space) {
                let found = "an expression in x, y or z";
                faults.push(Fault::new(path, found, "a number or an expression in t: the force of the whole body"));
            }
        }
        self.check_work_of(number, part, faults);
    }

    /// Checks that a force and a moment do work along some motion of their part.
    fn check_work_of(&self, number: usize, part: &RigidPart, faults: &mut Vec<Fault>) {
        let dim = self.mesh.dim;
        let body = RigidNodes::new(&self.mesh, part.nodes(&self.mesh), part.turns);
        let at = part.at.or_else(|| part.centre(&self.mesh)).unwrap_or_default();
        let axis = |c: usize| -> Point { std::array::from_fn(|d| f64::from(u8::from(c == d))) };
        let about = |c: usize| axis(if dim == 3 { c } else { 2 });
        let idle = |force: Point, moment: Point| body.work(&at, &force, &moment).iter().all(|work| *work == 0.0);
        let acts = |fields: &[Field], c: usize| fields.get(c).is_some_and(|field| !field.is_zero());
        if (0..dim).any(|c| acts(&part.force, c) && idle(axis(c), [0.0; 3])) {
            let found = format!("a force on \"{}\" in a direction in which it does not move", part.on);
            let hint = "a rigid part of a body of revolution moves along the axis alone";
            let expected = "a force that moves the part";
            faults.push(Fault::new(format!("rigid[{number}].force"), found, expected).hint(hint));
        }
        let about_line = |t: f64| {
            let value = |fields: &[Field], c: usize| fields.get(c).map_or(0.0, |field| field.value(&at, t));
            let centre = body.motions.first().map_or(at, |motion| motion.centre);
            let arm = std::array::from_fn(|c| at[c] - centre[c]);
            let by_force = cross(&arm, &std::array::from_fn(|c| value(&part.force, c)));
            let moment: Point = std::array::from_fn(|c| value(&part.moment, c) + by_force[c]);
            body.line.is_some_and(|line| dot(&moment, &line).abs() > SAME * length(&moment))
        };
        let is_idle = (0..3).any(|c| acts(&part.moment, c) && idle([0.0; 3], about(c)));
        if is_idle || [0.0, 0.37 * self.timeline.end(), self.timeline.end()].into_iter().any(about_line) {
            let found = format!("a moment on \"{}\", which has no motion about its axis", part.on);
            let hint = "nodes on a line do not turn about it, and neither a point nor a part that is `guided` turns";
            let expected = "a moment that turns the part";
            faults.push(Fault::new(format!("rigid[{number}].moment"), found, expected).hint(hint));
        }
    }

    /// Checks that the displacements prescribed at the nodes of a rigid part are a rigid motion.
    fn check_prescribed_motion(&self, faults: &mut Vec<Fault>) {
        let space: Space = self.displacement_space();
        let n = self.mesh.dim;
        for t in [0.0, 0.37 * self.timeline.end(), self.timeline.end()] {
            let mut u = vec![0.0; self.mesh.points.len() * n];
            space.prescribe(t, &mut u);
            for (entry, condition) in self.boundary.iter().enumerate() {
                for given in condition.prescriptions(&self.mesh) {
                    let Some(set) = self.mesh.named(given.on) else { continue };
                    let nodes = set.node_list();
                    let of_rigid = |node: &&u32| space.rigid.iter().any(|body| body.position(**node).is_some());
                    let nodes: Vec<u32> = nodes.iter().filter(of_rigid).copied().collect();
                    let x: Vec<Point> = nodes.iter().map(|&node| self.mesh.points[node as usize]).collect();
                    let values = given.field.values(&x, t);
                    let largest = values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
                    let off = nodes.iter().zip(&values).find(|(node, value)| {
                        let at = **node as usize * n;
                        let u: Point = std::array::from_fn(|c| if c < n { u[at + c] } else { 0.0 });
                        (dot(&u, &given.direction) - **value).abs() > SAME * largest.max(length(&u))
                    });
                    if let Some((node, value)) = off {
                        let x = self.mesh.points[*node as usize];
                        let at: Vec<String> = x.iter().take(n).map(|c| format!("{c:?}")).collect();
                        let found = format!(
                            "a displacement of {value:?} at ({}) that is not that of a rigid body, at t = {t:?}",
                            at.join(", ")
                        );
                        let hint = "prescribe the displacement of a rigid part at as many points as it has motions, `at` in [[boundary]], or one for all of it";
                        faults.push(
                            Fault::new(format!("boundary[{entry}]"), found, "displacements that a rigid part can have")
                                .hint(hint),
                        );
                        return;
                    }
                }
            }
        }
    }
}
