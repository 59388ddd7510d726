//! Rigid parts in the form of the case.

use std::collections::BTreeSet;

use amontons::mesh::Mesh;
use amontons::mesh::defects::components;
use amontons::problem::RigidPart;

use super::model::DeckModel;
use super::notes::{Matter, Notes};
use super::rigid::DeckRigid;
use super::time::Track;
use super::units::{UnitFactors, numbers, quoted};

/// Tolerance of the distance between a reference node and a node of its part, relative to the size of the mesh.
const SAME: f64 = 1e-9;

/// Writes the rigid parts of a deck.
struct RigidWriter<'a> {
    model: &'a DeckModel,
    mesh: &'a Mesh,
    units: UnitFactors,
    notes: &'a mut Notes,
}

/// The tables `[[rigid]]` with the supports of the parts, and the names of those whose reactions are requested.
pub fn text(model: &DeckModel, mesh: &Mesh, units: UnitFactors, notes: &mut Notes) -> (String, Vec<String>) {
    let (mut text, mut held, mut taken) = (String::new(), Vec::new(), BTreeSet::new());
    let mut writing = RigidWriter { model, mesh, units, notes };
    for part in &model.rigid {
        let nodes = RigidPart::on(&part.on).nodes(mesh);
        if writing.is_of_case(part, &nodes, &taken) {
            taken.extend(&nodes);
            let guided = writing.is_guided(part);
            text += &writing.part(part, guided);
            let of_part = writing.held(part, &nodes, guided);
            held.extend((!of_part.is_empty() && guided).then(|| part.on.clone()));
            text += &of_part;
        }
    }
    (text, held)
}

/// True if a direction has an event.
fn acts(tracks: &[Track; 3], axis: usize) -> bool {
    tracks.get(axis).is_some_and(|track| !track.0.is_empty())
}

impl RigidWriter<'_> {
    fn note(&mut self, part: &DeckRigid, what: &str, why: impl Into<String>, matter: Matter) {
        self.notes.add(&part.place, format!("{what} of the rigid part {}", part.on.escape_debug()), why, matter);
    }

    /// True if the case can have the part: its nodes are in one body and in no other part.
    fn is_of_case(&mut self, part: &DeckRigid, nodes: &[u32], taken: &BTreeSet<u32>) -> bool {
        let holds =
            |body: &amontons::mesh::defects::Component| nodes.iter().any(|n| body.nodes.binary_search(n).is_ok());
        let why = if nodes.is_empty() {
            "no side, region or points of the case have its nodes"
        } else if nodes.iter().any(|node| taken.contains(node)) {
            "another rigid part has some of its nodes: give both sides one name by [[side]]"
        } else if components(self.mesh).iter().filter(|body| holds(body)).count() > 1 {
            "it is on several bodies: give each a rigid part, and join them by ties"
        } else {
            if nodes.len() < part.nodes.len() {
                let why = format!("it has {} nodes in the deck, {} in the case", part.nodes.len(), nodes.len());
                self.note(part, "some nodes", why, Matter::Answer);
            }
            return true;
        };
        self.note(part, "the motion", why, Matter::Answer);
        false
    }

    /// The axes about which a part of the case can rotate.
    fn axes(&self) -> std::ops::Range<usize> {
        match (self.mesh.dim, self.mesh.axisymmetric) {
            (_, true) => 0..0,
            (2, _) => 2..3,
            _ => 0..3,
        }
    }

    /// True if a part does not rotate. Notes rotations that a case cannot express.
    fn is_guided(&mut self, part: &DeckRigid) -> bool {
        let axes = self.axes();
        let held: Vec<usize> = axes.clone().filter(|&axis| acts(&part.turning, axis)).collect();
        let moves = |track: &Track| track.0.iter().any(|event| event.value.is_some_and(|value| value != 0.0));
        if held.iter().any(|&axis| part.turning.get(axis).is_some_and(moves)) {
            let why = "the rotation that the deck prescribes is 0 in the case: prescribe displacements as expressions";
            self.note(part, "the rotation", why, Matter::Answer);
        }
        if !held.is_empty() && held.len() < axes.len() {
            let why = "the case holds all rotations or none (`guided`): here none, in the deck some";
            self.note(part, "the rotation", why, Matter::Answer);
        }
        for &axis in &held {
            self.late(part, &part.turning[axis]);
        }
        held.len() == axes.len()
    }

    /// Notes supports of a part that exist in some steps only.
    fn late(&mut self, part: &DeckRigid, track: &Track) {
        self.model.time.note_late(track, &format!("condition on {}", part.on.escape_debug()), self.notes);
    }

    fn history(&self, track: &Track, factor: f64) -> String {
        let history = self.model.time.history(track, &self.model.amplitudes, (0.0, true));
        history.mapped(factor, 0.0).text(self.units.time, None)
    }

    fn vector(&self, tracks: &[Track; 3], axes: impl Iterator<Item = usize>, factor: f64) -> String {
        let one = |axis: usize| tracks.get(axis).map_or_else(|| "0.0".to_owned(), |track| self.history(track, factor));
        format!("[{}]", axes.map(one).collect::<Vec<_>>().join(", "))
    }

    /// Force and moment with their point of action.
    fn part(&mut self, part: &DeckRigid, guided: bool) -> String {
        let dim = self.mesh.dim;
        let from = part.from.join(", ");
        let mut text = format!("\n[[rigid]]                            # {from}\non = {}\n", quoted(&part.on));
        // A part of a body of revolution moves along the axis only.
        let moving = if self.mesh.axisymmetric { 1..2 } else { 0..dim };
        if (0..3).any(|axis| !moving.contains(&axis) && acts(&part.force, axis)) {
            self.note(part, "a force", "the part does not move in its direction", Matter::Answer);
        }
        if moving.clone().any(|axis| acts(&part.force, axis)) {
            let own: [Track; 3] = std::array::from_fn(|axis| {
                part.force.get(axis).filter(|_| moving.contains(&axis)).cloned().unwrap_or_default()
            });
            text += &format!("force = {}\n", self.vector(&own, 0..dim, self.units.force()));
            if let Some(at) = part.at {
                text += &format!("at = {}\n", numbers(at.iter().take(dim).map(|x| x * self.units.length)));
            }
        }
        let axes = self.axes();
        let (turned, idle): (Vec<usize>, Vec<usize>) =
            (0..3).filter(|&axis| acts(&part.moment, axis)).partition(|axis| axes.contains(axis) && !guided);
        if idle.iter().any(|axis| axes.contains(axis)) {
            self.note(part, "a moment", "the rotation is held, which takes it", Matter::Nothing);
        }
        if idle.iter().any(|axis| !axes.contains(axis)) {
            self.note(part, "a moment", "the part does not turn about its axis", Matter::Answer);
        }
        if !turned.is_empty() {
            text += &format!("moment = {}\n", self.vector(&part.moment, axes.clone(), self.units.moment()));
        }
        text + if guided && !axes.is_empty() { "guided = true\n" } else { "" }
    }

    /// The condition on the motion prescribed at the reference node: for the part if it does not rotate, else for its
    /// node at that position. Empty without one.
    fn held(&mut self, part: &DeckRigid, nodes: &[u32], guided: bool) -> String {
        let dim = self.mesh.dim;
        let axes = 0..dim;
        let known = part.at.and_then(|at| self.node_at(&at, nodes));
        if part.is_of_body && known.is_none() {
            let why = "its reference node is one of a body, to which the case does not join it";
            self.note(part, "the motion", why, Matter::Answer);
        }
        let moves = |track: &Track| track.0.iter().any(|event| event.value.is_some_and(|value| value != 0.0));
        if self.mesh.axisymmetric && part.motion.first().is_some_and(moves) {
            self.note(part, "a displacement", "a part of a body of revolution moves along its axis", Matter::Answer);
        }
        // No part of a body of revolution moves radially.
        let held: Vec<usize> =
            axes.filter(|&axis| acts(&part.motion, axis) && !(self.mesh.axisymmetric && axis == 0)).collect();
        if held.is_empty() {
            return String::new();
        }
        for &axis in &held {
            self.late(part, &part.motion[axis]);
        }
        let place = match known {
            _ if guided => format!("on = {}", quoted(&part.on)),
            Some(x) => format!("at = {}", numbers(x.iter().take(dim).map(|x| x * self.units.length))),
            None => {
                let why = "the part turns about a reference node that is none of its nodes: the case lets it move; hold one of its nodes by `at` in [[boundary]]";
                self.note(part, "a displacement", why, Matter::Answer);
                return String::new();
            }
        };
        let one = |axis: usize| match part.motion.get(axis) {
            Some(track) if held.contains(&axis) => self.history(track, self.units.length),
            _ => "\"free\"".to_owned(),
        };
        let all: Vec<String> = (0..dim).map(one).collect();
        let from =
            part.from.iter().filter(|from| from.starts_with("*BOUNDARY")).cloned().collect::<Vec<_>>().join(", ");
        format!("\n[[boundary]]                         # {from}\n{place}\ndisplacement = [{}]\n", all.join(", "))
    }

    /// The coordinates of the node of a part at a position, or `None` if there is no node.
    fn node_at(&self, at: &[f64; 3], nodes: &[u32]) -> Option<[f64; 3]> {
        let size = self.mesh.points.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
        let mut points = nodes.iter().filter_map(|&node| self.mesh.points.get(node as usize));
        points.find(|point| point.iter().zip(at).all(|(a, b)| (a - b).abs() <= SAME * size)).copied()
    }
}

/// Probes of the reactions of rigid parts.
pub fn probe(on: &str) -> String {
    let admitted = |c: char| if c.is_ascii_alphanumeric() || "_-.".contains(c) { c } else { '_' };
    let name: String = format!("reaction-{on}").chars().map(admitted).collect();
    let place = format!("on = {}\ntake = \"integral\"\n", quoted(on));
    format!("\n[[probe]]\nname = \"{name}\"\nquantity = \"reaction\"\n{place}")
}
