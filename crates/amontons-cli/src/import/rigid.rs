//! `*RIGID BODY`, `*COUPLING` with `*KINEMATIC`, `*KINEMATIC COUPLING`: nodes that move as one rigid body.

use std::collections::{BTreeMap, BTreeSet};

use super::deck::{Card, DataLine, DeckFault, DeckPlace};
use super::material::DeckSection;
use super::mesh::{DeckMesh, DeckNodeId, DeckSetKind, integer};
use super::notes::{Matter, Notes};
use super::sides::DeckSides;
use super::time::{Event, Track};

/// Nodes of a deck that move as one rigid body, with the loads and conditions of their reference node.
#[derive(Clone, Debug)]
pub struct DeckRigid {
    pub place: DeckPlace,
    /// The keywords with their lines.
    pub from: Vec<String>,
    what: NodeNaming,
    /// Its name in the case, empty until `settle`.
    pub on: String,
    /// The nodes of bodies; empty if they are given by a surface.
    pub nodes: BTreeSet<DeckNodeId>,
    /// Coordinates of the reference node.
    pub at: Option<[f64; 3]>,
    /// True if an element contains the reference node: its displacement and force are then those of a node of a body.
    pub is_of_body: bool,
    pub force: [Track; 3],
    pub moment: [Track; 3],
    /// Prescribed displacements of the reference node.
    pub motion: [Track; 3],
    /// Prescribed rotations.
    pub turning: [Track; 3],
}

/// The way in which a deck names the nodes.
#[derive(Clone, Debug)]
enum NodeNaming {
    Surface(String),
    Nodes(String),
    Elements(String),
    /// Nodes on separate lines.
    Lines,
}

/// The meaning of the directions 1 to 3 of a node.
#[derive(Clone, Copy, Debug)]
enum AxesRole {
    Reference,
    Rotation,
}

/// A `*COUPLING` whose kind is given by the next keyword.
#[derive(Clone, Debug)]
struct DeckCoupling {
    place: DeckPlace,
    surface: String,
    reference: DeckNodeId,
}

/// All rigid parts of a deck.
#[derive(Debug, Default)]
pub struct Rigids {
    pub parts: Vec<DeckRigid>,
    /// Reference and rotational nodes with the number of their part.
    controls: BTreeMap<DeckNodeId, (usize, AxesRole)>,
    coupling: Option<DeckCoupling>,
}

/// The single node named by a parameter.
fn one(card: &Card, name: &str, mesh: &DeckMesh) -> Result<DeckNodeId, DeckFault> {
    let text = card.required(name)?;
    let nodes = mesh.nodes(&card.place, text)?;
    let mut all = nodes.iter();
    if let (Some(node), None) = (all.next(), all.next()) {
        return Ok(*node);
    }
    let found = format!("{name}={}, which has {} nodes", text.escape_debug(), nodes.len());
    Err(DeckFault::new(&card.place, found, "one node"))
}

/// The first and the last direction of a line, starting at an entry.
fn directions(line: &DataLine, at: usize) -> Result<std::ops::RangeInclusive<i64>, DeckFault> {
    let first = integer(line, at)?;
    let last = if line.text(at + 1).is_some() { integer(line, at + 1)? } else { first };
    Ok(first..=last)
}

impl Rigids {
    /// Reads a keyword of a rigid part. Returns false for other keywords.
    pub fn take(&mut self, card: &Card, mesh: &DeckMesh, dim: usize, notes: &mut Notes) -> Result<bool, DeckFault> {
        match card.name.as_str() {
            "RIGID BODY" => self.body(card, mesh, notes)?,
            "COUPLING" => {
                let surface = mesh.surface(&card.place, card.required("SURFACE")?)?;
                let reference = one(card, "REFNODE", mesh)?;
                self.coupling = Some(DeckCoupling { place: card.place.clone(), surface, reference });
            }
            "KINEMATIC" => {
                let Some(DeckCoupling { place, surface, reference }) = self.coupling.take() else { return Ok(false) };
                let mut coupled = BTreeSet::new();
                for line in &card.data {
                    coupled.extend(directions(line, 0)?);
                }
                if !card.data.is_empty() && !(1..=dim as i64).all(|direction| coupled.contains(&direction)) {
                    let why = "a rigid part of a case has all displacements of its nodes: those of the deck are free";
                    notes.add(&place, "*COUPLING of some directions", why, Matter::Answer);
                    return Ok(true);
                }
                let from = vec![format!("*COUPLING {place}"), format!("*KINEMATIC {}", card.place)];
                let part = DeckRigid::new((place, from), NodeNaming::Surface(surface), BTreeSet::new());
                self.push(part, (Some(reference), None), mesh, notes);
            }
            "DISTRIBUTING" if self.coupling.is_some() => {
                self.coupling = None;
                return Ok(false);
            }
            "KINEMATIC COUPLING" => self.kinematic(card, mesh, dim, notes)?,
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn body(&mut self, card: &Card, mesh: &DeckMesh, notes: &mut Notes) -> Result<(), DeckFault> {
        let set = ["NSET", "PINNSET", "TIENSET"].into_iter().find_map(|name| card.parameter(name));
        let (what, nodes) = match (set, card.parameter("ELSET")) {
            (Some(name), _) => (NodeNaming::Nodes(name.to_owned()), mesh.nodes(&card.place, name).unwrap_or_default()),
            (None, Some(name)) => {
                // Rigid elements and shells belong to no body.
                let elements = mesh.elements(&card.place, name).unwrap_or_default();
                let nodes = elements.into_iter().flat_map(|element| mesh.nodes_of(element)).collect();
                (NodeNaming::Elements(name.to_owned()), nodes)
            }
            (None, None) => {
                notes.keyword(&card.place, &card.name);
                return Ok(());
            }
        };
        let nodes: BTreeSet<DeckNodeId> = nodes.into_iter().filter(|node| mesh.is_used(node)).collect();
        if nodes.is_empty() {
            let why = "no node of it belongs to a solid element: an obstacle can take the place of a rigid surface";
            notes.add(&card.place, "*RIGID BODY", why, Matter::Answer);
            return Ok(());
        }
        let node = |name: &str| card.has(name).then(|| one(card, name, mesh)).transpose();
        let controls = (node("REFNODE")?, node("ROTNODE")?);
        let from = vec![format!("*RIGID BODY {}", card.place)];
        self.push(DeckRigid::new((card.place.clone(), from), what, nodes), controls, mesh, notes);
        Ok(())
    }

    fn kinematic(&mut self, card: &Card, mesh: &DeckMesh, dim: usize, notes: &mut Notes) -> Result<(), DeckFault> {
        let reference = one(card, "REFNODE", mesh)?;
        let expected = "a node or a node set, and its first and last direction";
        let mut nodes = BTreeSet::new();
        for line in &card.data {
            nodes.extend(mesh.nodes(&line.place, line.need(0, expected)?)?);
            if line.text(1).is_some() {
                let coupled = directions(line, 1)?;
                if *coupled.start() > 1 || *coupled.end() < dim as i64 {
                    let why = "a rigid part of a case has all displacements of its nodes: those of the deck are free";
                    notes.add(&line.place, "*KINEMATIC COUPLING of some directions", why, Matter::Answer);
                    return Ok(());
                }
            }
        }
        let what = match card.data.as_slice() {
            [line] if line.text(0).is_some_and(|name| name.parse::<i64>().is_err()) => {
                NodeNaming::Nodes(line.need(0, expected)?.to_owned())
            }
            _ => NodeNaming::Lines,
        };
        let nodes: BTreeSet<DeckNodeId> = nodes.into_iter().filter(|node| mesh.is_used(node)).collect();
        if nodes.is_empty() {
            let why = "no node of it belongs to a solid element";
            notes.add(&card.place, "*KINEMATIC COUPLING", why, Matter::Answer);
            return Ok(());
        }
        let from = vec![format!("*KINEMATIC COUPLING {}", card.place)];
        self.push(DeckRigid::new((card.place.clone(), from), what, nodes), (Some(reference), None), mesh, notes);
        Ok(())
    }

    /// Adds a part with its reference node and the node of its rotations.
    fn push(
        &mut self,
        mut part: DeckRigid,
        controls: (Option<DeckNodeId>, Option<DeckNodeId>),
        mesh: &DeckMesh,
        notes: &mut Notes,
    ) {
        let (reference, rotation) = controls;
        if [reference, rotation].iter().flatten().any(|node| self.controls.contains_key(node)) {
            let why = "its reference node is that of another rigid part: give both sides one name by [[side]]";
            notes.add(&part.place, "rigid part", why, Matter::Answer);
            return;
        }
        let number = self.parts.len();
        for (node, role) in [(rotation, AxesRole::Rotation), (reference, AxesRole::Reference)] {
            self.controls.extend(node.map(|node| (node, (number, role))));
        }
        part.at = reference.map(|node| mesh.point(node));
        part.is_of_body = reference.is_some_and(|node| mesh.is_used(&node));
        self.parts.push(part);
    }

    /// The reference and rotational nodes among some nodes.
    pub fn controls(&self, nodes: &BTreeSet<DeckNodeId>) -> BTreeSet<DeckNodeId> {
        nodes.iter().filter(|node| self.controls.contains_key(node)).copied().collect()
    }

    /// True if a direction of a control node is a motion of its part only, and not of a node of a body.
    pub fn is_apart(&self, node: &DeckNodeId, direction: usize) -> bool {
        self.controls.get(node).is_some_and(|(part, role)| {
            let is_of_body = self.parts.get(*part).is_some_and(|part| part.is_of_body);
            matches!(role, AxesRole::Rotation) || (4..=6).contains(&direction) || !is_of_body
        })
    }

    /// Sets the condition or load in a direction of a control node. Returns false if it has no such direction.
    pub fn set(&mut self, card: &Card, (node, direction): (&DeckNodeId, usize), event: Event) -> bool {
        if !self.is_apart(node, direction) {
            return true;
        }
        let Some((part, role)) = self.controls.get(node) else { return false };
        let Some(part) = self.parts.get_mut(*part) else { return false };
        let is_load = card.name == "CLOAD";
        let (tracks, axis) = match (role, direction) {
            (AxesRole::Reference, 1..=3) => (if is_load { &mut part.force } else { &mut part.motion }, direction - 1),
            (AxesRole::Reference, 4..=6) => (if is_load { &mut part.moment } else { &mut part.turning }, direction - 4),
            (AxesRole::Rotation, 1..=3) => (if is_load { &mut part.moment } else { &mut part.turning }, direction - 1),
            _ => return false,
        };
        if let Some(track) = tracks.get_mut(axis) {
            track.set(event, is_load);
        }
        let from = format!("*{} {}", card.name, card.place);
        if !part.from.contains(&from) {
            part.from.push(from);
        }
        true
    }

    /// Removes in a step the conditions that a keyword with OP=NEW does not repeat.
    pub fn renew(&mut self, card: &Card, step: usize) {
        for part in &mut self.parts {
            let tracks = match card.name.as_str() {
                "CLOAD" => [&mut part.force, &mut part.moment],
                "BOUNDARY" => [&mut part.motion, &mut part.turning],
                _ => return,
            };
            let before = |track: &&mut Track| track.0.last().is_some_and(|last| last.step < step);
            tracks.into_iter().flatten().filter(before).for_each(|track| track.remove(step));
        }
    }

    /// Sets the names of the parts in the case, once all sections are known.
    pub fn settle(
        &mut self,
        mesh: &DeckMesh,
        sections: &[DeckSection],
        sides: &mut DeckSides,
        notes: &mut Notes,
    ) -> Result<(), DeckFault> {
        let regions: Vec<&String> = sections.iter().flat_map(|section| &section.regions).collect();
        for part in &mut self.parts {
            let nodes = || part.nodes.clone();
            let wanted = format!("rigid-{}", part.place.line);
            let names = match &part.what {
                NodeNaming::Surface(name) => vec![name.clone()],
                NodeNaming::Elements(name) => {
                    let own = mesh.spelling(DeckSetKind::Elements, name);
                    match own.filter(|own| regions.contains(&own)) {
                        Some(region) => vec![region],
                        None => sides.split(mesh, (None, &wanted), &nodes()),
                    }
                }
                NodeNaming::Nodes(name) => match regions.iter().find(|region| is_all_of(&part.nodes, region, mesh)) {
                    Some(region) => vec![(*region).clone()],
                    None if name.parse::<i64>().is_err() => sides.of_set(mesh, &part.place, name)?,
                    None => sides.split(mesh, (None, &wanted), &nodes()),
                },
                NodeNaming::Lines => sides.split(mesh, (None, &wanted), &nodes()),
            };
            if let [first, second, ..] = names.as_slice() {
                let why = format!("the case has the side {first} of it, without the nodes {second} beside it");
                notes.add(&part.place, "rigid part", why, Matter::Answer);
            }
            part.on = names.into_iter().next().unwrap_or_default();
        }
        Ok(())
    }
}

/// True if the nodes are all nodes of a region.
fn is_all_of(nodes: &BTreeSet<DeckNodeId>, region: &str, mesh: &DeckMesh) -> bool {
    let elements = mesh.elements(&DeckPlace::start(), region).unwrap_or_default();
    let own: BTreeSet<DeckNodeId> = elements.into_iter().flat_map(|element| mesh.nodes_of(element)).collect();
    own == *nodes
}

impl DeckRigid {
    fn new((place, from): (DeckPlace, Vec<String>), what: NodeNaming, nodes: BTreeSet<DeckNodeId>) -> DeckRigid {
        let none = <[Track; 3]>::default;
        DeckRigid {
            place,
            from,
            what,
            on: String::new(),
            nodes,
            at: None,
            is_of_body: false,
            force: none(),
            moment: none(),
            motion: none(),
            turning: none(),
        }
    }
}
