//! Supports, loads and heat of a deck, by the sides and points they act on.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::deck::{Card, DataLine, DeckFault};
use super::mesh::{DeckElementId, DeckMesh, DeckNodeId, integer};
use super::notes::{Matter, Notes};
use super::rigid::Rigids;
use super::sides::DeckSides;
use super::time::{Event, Track};
use super::transform::{NodeAxes, Transforms};
use super::units::number;

/// The quantity prescribed on a side or at points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PrescribedQuantity {
    Displacement(usize),
    Normal,
    Temperature,
    Traction(usize),
    Pressure,
    HeatInflow,
    Ambient,
}

/// The conditions on one side or at points.
#[derive(Clone, Debug, Default)]
pub struct DeckPrescription {
    pub on: String,
    /// The keywords with their lines.
    pub from: Vec<String>,
    /// Tracks, each with its keyword.
    pub tracks: BTreeMap<PrescribedQuantity, (Track, String)>,
    /// Film coefficient.
    pub film: Option<f64>,
}

/// A force of the whole body.
#[derive(Clone, Debug, PartialEq)]
pub enum Volume {
    /// An acceleration.
    Gravity([f64; 3]),
    /// Force per volume along an axis.
    Force(usize),
    /// Square of a speed of rotation about an axis through a point.
    Centrifugal([f64; 3], [f64; 3]),
    /// Heat per volume.
    Heat,
}

/// All conditions and loads of a deck.
#[derive(Debug, Default)]
pub struct Conditions {
    pub entries: Vec<DeckPrescription>,
    by_name: HashMap<String, usize>,
    /// Forces at nodes by component.
    pub forces: BTreeMap<DeckNodeId, [Track; 3]>,
    /// Name and line of the keyword of each force at a node.
    pub force_from: BTreeMap<DeckNodeId, (String, String)>,
    pub volume: Vec<(Volume, Track, String)>,
    /// `*TEMPERATURE` of all nodes.
    pub field: Track,
    pub initial: Option<f64>,
}

/// The data needed to read a condition.
pub struct ConditionContext<'a> {
    pub mesh: &'a DeckMesh,
    pub sides: &'a mut DeckSides,
    pub notes: &'a mut Notes,
    pub transforms: &'a Transforms,
    pub rigid: &'a mut Rigids,
    pub dim: usize,
    /// Thickness of a plane body; 1 for other bodies.
    pub thickness: f64,
    /// Number of the present step, from 0.
    pub step: usize,
}

impl ConditionContext<'_> {
    fn event(&self, card: &Card, value: f64) -> Event {
        Event { step: self.step, value: Some(value), amplitude: card.word("AMPLITUDE") }
    }
}

fn source(card: &Card) -> String {
    format!("*{} {}", card.name, card.place)
}

/// True if an entry is the number of a node or an element.
fn is_number(text: &str) -> bool {
    text.parse::<i64>().is_ok()
}

impl Conditions {
    /// The entry of a side or of points, made if missing.
    fn entry(&mut self, on: &str, card: &Card) -> &mut DeckPrescription {
        let place = *self.by_name.entry(on.to_owned()).or_insert_with(|| {
            self.entries.push(DeckPrescription { on: on.to_owned(), ..DeckPrescription::default() });
            self.entries.len() - 1
        });
        let entry = &mut self.entries[place];
        let from = source(card);
        if !entry.from.contains(&from) {
            entry.from.push(from);
        }
        entry
    }

    fn set(&mut self, on: &str, card: &Card, quantity: PrescribedQuantity, event: Event) {
        let (track, _) =
            self.entry(on, card).tracks.entry(quantity).or_insert_with(|| (Track::default(), card.name.clone()));
        track.set(event, false);
    }

    /// Removes in a step the conditions that a keyword with OP=NEW does not repeat.
    fn renew(&mut self, card: &Card, step: usize) {
        if card.word("OP").as_deref() != Some("NEW") {
            return;
        }
        for entry in &mut self.entries {
            let own = entry.tracks.values_mut().filter(|(_, by)| *by == card.name);
            own.filter(|(track, _)| track.0.last().is_some_and(|last| last.step < step))
                .for_each(|(track, _)| track.remove(step));
        }
        if card.name == "CLOAD" {
            self.forces.values_mut().flatten().for_each(|track| track.remove(step));
        }
        let volume = self.volume.iter_mut().filter(|(_, _, by)| by.starts_with(&format!("*{} ", card.name)));
        volume.for_each(|(_, track, _)| track.remove(step));
    }

    /// Reads a keyword that prescribes something. Returns false for other keywords.
    pub fn take(&mut self, card: &Card, scene: &mut ConditionContext) -> Result<bool, DeckFault> {
        match card.name.as_str() {
            "BOUNDARY" | "CLOAD" | "DLOAD" | "DSLOAD" | "FILM" | "SFILM" | "DFLUX" | "DSFLUX" | "CFLUX" => {
                self.renew(card, scene.step);
                if card.word("OP").as_deref() == Some("NEW") {
                    scene.rigid.renew(card, scene.step);
                }
            }
            _ => {}
        }
        match card.name.as_str() {
            "BOUNDARY" => self.boundary(card, scene)?,
            "CLOAD" => self.forces(card, scene)?,
            "DLOAD" => self.on_elements(card, scene, 'P')?,
            "FILM" => self.on_elements(card, scene, 'F')?,
            "DFLUX" => self.on_elements(card, scene, 'S')?,
            "DSLOAD" | "SFILM" | "DSFLUX" => self.on_surfaces(card, scene)?,
            "TEMPERATURE" => self.temperature(card, scene)?,
            "INITIAL CONDITIONS" => self.initial(card, scene)?,
            "CFLUX" => self.heat_at_nodes(card, scene)?,
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn boundary(&mut self, card: &Card, scene: &mut ConditionContext) -> Result<(), DeckFault> {
        if card.has("USER") || card.word("TYPE").is_some_and(|kind| kind != "DISPLACEMENT") {
            let found = "*BOUNDARY of velocities, accelerations or a subroutine";
            return Err(DeckFault::new(&card.place, found, "prescribed displacements and temperatures"));
        }
        for lines in alike(&card.data, |line| line.entries.get(1..).map(<[String]>::to_vec)) {
            let Some(line) = lines.first() else { continue };
            let name = line.need(0, "a node or a node set")?;
            let Some((dofs, value)) = freedoms(line, scene)? else { continue };
            let all = nodes_of(&lines, scene.mesh)?;
            let nodes = of_bodies((card, line), &all, (&dofs, value), scene);
            if nodes.is_empty() && !all.is_empty() {
                continue;
            }
            let targets = if is_number(name) {
                scene.sides.split(scene.mesh, (None, &format!("nodes-{}", line.place.line)), &nodes)
            } else {
                scene.sides.of_set(scene.mesh, &line.place, name)?
            };
            if targets.is_empty() {
                let why = "no node of it belongs to a solid element";
                scene.notes.add(&line.place, format!("*BOUNDARY of {name}"), why, Matter::Answer);
            }
            let quantities = match scene.transforms.of(&nodes, &line.place)? {
                Some(local) if dofs.iter().any(|dof| *dof <= 3) => {
                    let quantities = turned(&local, &dofs, (line, value), scene.dim)?;
                    if quantities.iter().any(|(quantity, _)| *quantity == PrescribedQuantity::Normal) {
                        check_normal(&local, &dofs, (line, &nodes), scene)?;
                    }
                    quantities
                }
                _ => dofs.iter().filter_map(|&dof| quantity(dof, scene.dim)).map(|q| (q, value)).collect(),
            };
            for target in targets {
                for &(quantity, value) in &quantities {
                    let event = scene.event(card, value);
                    self.set(&target, card, quantity, event);
                }
            }
        }
        Ok(())
    }

    fn forces(&mut self, card: &Card, scene: &mut ConditionContext) -> Result<(), DeckFault> {
        for line in &card.data {
            let name = line.need(0, "a node or a node set")?;
            let (dof, value) = (integer(line, 1)?, line.value(2, "a node, a direction and a force")?);
            let nodes = scene.mesh.nodes(&line.place, name)?;
            let direction = usize::try_from(dof).unwrap_or_default();
            let nodes = of_bodies((card, line), &nodes, (&[direction], value), scene);
            if nodes.is_empty() {
                continue;
            }
            let Some(axis) = usize::try_from(dof - 1).ok().filter(|axis| *axis < scene.dim) else {
                let why = "a solid takes forces along its axes";
                scene.notes.add(&line.place, format!("*CLOAD in direction {dof}"), why, Matter::Answer);
                continue;
            };
            let local = scene.transforms.of(&nodes, &line.place)?;
            for node in nodes {
                let own = local.as_ref().map(|local| local.axes(&scene.mesh.point(node)));
                for d in 0..scene.dim {
                    let share = own.map_or(f64::from(u8::from(d == axis)), |axes| axes[axis][d]);
                    let tracks = self.forces.entry(node).or_default();
                    if share != 0.0 || !tracks[d].0.is_empty() {
                        tracks[d].set(scene.event(card, share * value), true);
                    }
                }
                let label = if is_number(name) { format!("node-{}", node.1) } else { name.replace('.', "-") };
                self.force_from.entry(node).or_insert_with(|| (label, source(card)));
            }
        }
        Ok(())
    }

    /// Loads of elements and sets of elements: on faces, or of the whole body.
    fn on_elements(&mut self, card: &Card, scene: &mut ConditionContext, letter: char) -> Result<(), DeckFault> {
        for lines in alike(&card.data, |line| line.entries.get(1..).map(<[String]>::to_vec)) {
            let Some(line) = lines.first() else { continue };
            let label = line.need(1, "an element, a label and a value")?.to_uppercase();
            if self.of_volume(card, (line, &label), scene)? {
                continue;
            }
            let face = label.strip_prefix(letter).and_then(|number| number.parse::<usize>().ok());
            let mut faces = Vec::new();
            let mut elements: BTreeSet<DeckElementId> = BTreeSet::new();
            for line in &lines {
                let name = line.need(0, "an element or an element set")?;
                elements.extend(scene.mesh.elements(&line.place, name)?);
                faces.push((name.to_owned(), face.unwrap_or_default()));
            }
            let Some(face) = face.filter(|_| line.text(2).is_some()) else {
                let why = format!("the label {} is not taken", label.escape_debug());
                scene.notes.add(&line.place, format!("*{}", card.name), why, Matter::Answer);
                continue;
            };
            if elements.is_empty() {
                let found = format!("\"{}\" without a solid element", faces[0].0.escape_debug());
                return Err(DeckFault::new(&line.place, found, "a set of elements of the body"));
            }
            if !scene.mesh.has_face(&elements, face) {
                let found = format!("the face {label} of an element without it");
                return Err(DeckFault::new(
                    &line.place,
                    found,
                    format!("{letter}1, {letter}2, … up to its number of faces"),
                ));
            }
            let wanted = match lines.as_slice() {
                [_] => format!("{}-{label}", faces[0].0.replace('.', "-")),
                _ => format!("faces-{}", line.place.line),
            };
            let known = (card.name.clone() + &faces.iter().map(|f| f.0.as_str()).collect::<Vec<_>>().join(","), face);
            let name = scene.sides.face_set(scene.mesh, known, &wanted, &faces);
            self.on_side(&name, (card, line), 2, scene)?;
        }
        Ok(())
    }

    /// Heat flows into nodes, spread evenly over the side formed by them.
    fn heat_at_nodes(&mut self, card: &Card, scene: &mut ConditionContext) -> Result<(), DeckFault> {
        for lines in alike(&card.data, |line| line.entries.get(1..).map(<[String]>::to_vec)) {
            let Some(line) = lines.first() else { continue };
            let value = line.value(2, "a node, the degree of freedom 11 and a heat flow")?;
            let nodes = nodes_of(&lines, scene.mesh)?;
            let area = scene.mesh.area(&nodes) * scene.thickness;
            if area <= 0.0 || scene.mesh.on_facets(&nodes) != nodes {
                let why = "a heat flow into nodes that are no side is not taken: give `heat_inflow` on a side";
                scene.notes.add(&line.place, "*CFLUX", why, Matter::Answer);
                continue;
            }
            let name = line.need(0, "a node or a node set")?;
            let targets = if is_number(name) {
                scene.sides.split(scene.mesh, (None, &format!("nodes-{}", line.place.line)), &nodes)
            } else {
                scene.sides.of_set(scene.mesh, &line.place, name)?
            };
            let why = "the heat flow into the nodes is spread evenly over their side";
            scene.notes.add(&line.place, "*CFLUX", why, Matter::Perhaps);
            for target in targets {
                let event = scene.event(card, value * nodes.len() as f64 / area);
                self.set(&target, card, PrescribedQuantity::HeatInflow, event);
            }
        }
        Ok(())
    }

    fn on_surfaces(&mut self, card: &Card, scene: &mut ConditionContext) -> Result<(), DeckFault> {
        for line in &card.data {
            let name = scene.mesh.surface(&line.place, line.need(0, "a surface")?)?;
            let label = line.need(1, "a surface, a label and a value")?.to_uppercase();
            match (card.name.as_str(), label.as_str()) {
                ("DSLOAD", "TRVEC") => {
                    let size = line.value(2, "a traction and its direction")?;
                    let along = direction(line, 3)?;
                    for (d, along) in along.iter().enumerate().take(scene.dim) {
                        self.set(&name, card, PrescribedQuantity::Traction(d), scene.event(card, size * along));
                    }
                }
                ("DSLOAD", "P") | ("SFILM", "F") | ("DSFLUX", "S") => self.on_side(&name, (card, line), 2, scene)?,
                _ => {
                    let why = format!("the label {} is not taken", label.escape_debug());
                    scene.notes.add(&line.place, format!("*{}", card.name), why, Matter::Answer);
                }
            }
        }
        Ok(())
    }

    /// Sets pressure, heat flux or exchange of a side from the entries of a line, starting at an index.
    fn on_side(
        &mut self,
        on: &str,
        (card, line): (&Card, &DataLine),
        at: usize,
        scene: &mut ConditionContext,
    ) -> Result<(), DeckFault> {
        let value = line.value(at, "a value")?;
        let quantity = match card.name.as_str() {
            "DLOAD" | "DSLOAD" => PrescribedQuantity::Pressure,
            "DFLUX" | "DSFLUX" => PrescribedQuantity::HeatInflow,
            _ => PrescribedQuantity::Ambient,
        };
        self.set(on, card, quantity, scene.event(card, value));
        if quantity != PrescribedQuantity::Ambient {
            return Ok(());
        }
        let film = line.value(at + 1, "a temperature of the surroundings and a film coefficient")?;
        if card.has("FILMAMPLITUDE") {
            let why = "the film coefficient of a case is constant in time";
            scene.notes.add(&card.place, "FILM AMPLITUDE", why, Matter::Answer);
        }
        let entry = self.entry(on, card);
        if entry.film.is_some_and(|before| before.total_cmp(&film).is_ne()) {
            let why = "the film coefficient of a case is constant in time: that of the last step holds";
            scene.notes.add(&line.place, format!("*{}", card.name), why, Matter::Answer);
        }
        entry.film = Some(film);
        Ok(())
    }

    /// Reads gravity, centrifugal force, force or heat per volume. Returns false for other labels.
    fn of_volume(
        &mut self,
        card: &Card,
        (line, label): (&DataLine, &str),
        scene: &mut ConditionContext,
    ) -> Result<bool, DeckFault> {
        let (volume, value) = match (card.name.as_str(), label) {
            ("DLOAD", "GRAV") => (Volume::Gravity(direction(line, 3)?), line.value(2, "an acceleration")?),
            ("DLOAD", "CENTRIF") => {
                let point = [0, 1, 2].map(|d| line.number(3 + d));
                let [x, y, z] = point;
                let point = [x?.unwrap_or(0.0), y?.unwrap_or(0.0), z?.unwrap_or(0.0)];
                (Volume::Centrifugal(point, direction(line, 6)?), line.value(2, "the square of a speed")?)
            }
            ("DLOAD", "BX" | "BY" | "BZ") => {
                let axis = ["BX", "BY", "BZ"].iter().position(|name| *name == label).unwrap_or_default();
                (Volume::Force(axis), line.value(2, "a force per volume")?)
            }
            ("DFLUX", "BF") => (Volume::Heat, line.value(2, "a heat source per volume")?),
            _ => return Ok(false),
        };
        let name = line.text(0).unwrap_or_default();
        let all: usize = scene.mesh.bodies.iter().map(|body| body.cells.len()).sum();
        if !name.is_empty() && scene.mesh.elements(&line.place, name)?.len() < all {
            let why = format!("a case has {label} in the whole body, the deck in {} alone", name.escape_debug());
            scene.notes.add(&line.place, format!("*{}", card.name), why, Matter::Answer);
        }
        let event = scene.event(card, value);
        match self.volume.iter_mut().find(|(other, _, _)| *other == volume) {
            Some((_, track, _)) => track.set(event, false),
            None => self.volume.push((volume, Track(vec![event]), source(card))),
        }
        Ok(true)
    }

    /// `*TEMPERATURE`: one temperature of all nodes. Temperatures per node cannot be expressed as a function of
    /// position.
    fn temperature(&mut self, card: &Card, scene: &mut ConditionContext) -> Result<(), DeckFault> {
        if let Some(value) = whole_field(card, scene.mesh, 1)? {
            self.field.set(scene.event(card, value), false);
        } else {
            let why = "temperatures that differ from node to node are not taken: give `temperature` in [load] as an expression or as data of a mesh file";
            scene.notes.add(&card.place, "*TEMPERATURE", why, Matter::Answer);
        }
        Ok(())
    }

    fn initial(&mut self, card: &Card, scene: &mut ConditionContext) -> Result<(), DeckFault> {
        if card.word("TYPE").as_deref() != Some("TEMPERATURE") {
            let what = format!("*INITIAL CONDITIONS, TYPE={}", card.word("TYPE").unwrap_or_default().escape_debug());
            scene.notes.add(&card.place, what, "see `[initial]` of the case", Matter::Answer);
            return Ok(());
        }
        let found = whole_field(card, scene.mesh, 1)?;
        if found.is_none() || self.initial.is_some_and(|before| found != Some(before)) {
            let expected = "one initial temperature of all nodes";
            return Err(DeckFault::new(&card.place, "initial temperatures that differ, or not of all nodes", expected));
        }
        self.initial = found;
        Ok(())
    }
}

/// The common value of all nodes, given by lines with a node or a set and a value, or `None` if there is no common one.
fn whole_field(card: &Card, mesh: &DeckMesh, at: usize) -> Result<Option<f64>, DeckFault> {
    let mut covered: BTreeSet<DeckNodeId> = BTreeSet::new();
    let mut value = None;
    for line in &card.data {
        covered.extend(mesh.nodes(&line.place, line.need(0, "a node or a node set")?)?);
        let own = line.value(at, "a temperature")?;
        if value.is_some_and(|before: f64| before.total_cmp(&own).is_ne()) {
            return Ok(None);
        }
        value = Some(own);
    }
    Ok(value.filter(|_| mesh.all_nodes().is_subset(&covered)))
}

/// Groups consecutive lines that name nodes or elements by number and are otherwise equal; other lines stay single.
fn alike<T: PartialEq>(lines: &[DataLine], rest: impl Fn(&DataLine) -> T) -> Vec<Vec<&DataLine>> {
    let mut groups: Vec<Vec<&DataLine>> = Vec::new();
    for line in lines {
        let by_number = |line: &DataLine| line.text(0).is_some_and(is_number);
        let joins = |group: &&mut Vec<&DataLine>| {
            group.first().is_some_and(|first| by_number(first) && by_number(line) && rest(first) == rest(line))
        };
        match groups.last_mut().filter(joins) {
            Some(group) => group.push(line),
            None => groups.push(vec![line]),
        }
    }
    groups
}

fn nodes_of(lines: &[&DataLine], mesh: &DeckMesh) -> Result<BTreeSet<DeckNodeId>, DeckFault> {
    let mut nodes = BTreeSet::new();
    for line in lines {
        nodes.extend(mesh.nodes(&line.place, line.need(0, "a node or a node set")?)?);
    }
    Ok(nodes)
}

/// Applies a line to the rigid parts of its reference nodes. Returns the remaining nodes, which belong to bodies.
fn of_bodies(
    (card, line): (&Card, &DataLine),
    nodes: &BTreeSet<DeckNodeId>,
    (dofs, value): (&[usize], f64),
    scene: &mut ConditionContext,
) -> BTreeSet<DeckNodeId> {
    let controls = scene.rigid.controls(nodes);
    if controls.is_empty() {
        return nodes.clone();
    }
    if !matches!(scene.transforms.of(&controls, &line.place), Ok(None)) {
        let why = "the axes of a *TRANSFORM at a reference node are not taken";
        scene.notes.add(&line.place, format!("*{}", card.name), why, Matter::Answer);
        return nodes.difference(&controls).copied().collect();
    }
    for (node, dof) in controls.iter().flat_map(|node| dofs.iter().map(move |dof| (node, *dof))) {
        let event = scene.event(card, value);
        if !scene.rigid.set(card, (node, dof), event) {
            let why = "a reference node has displacements and rotations";
            scene.notes.add(&line.place, format!("*{} in direction {dof}", card.name), why, Matter::Answer);
        }
    }
    let is_apart = |node: &&DeckNodeId| dofs.iter().all(|dof| scene.rigid.is_apart(node, *dof));
    let apart: BTreeSet<DeckNodeId> = controls.iter().filter(is_apart).copied().collect();
    nodes.difference(&apart).copied().collect()
}

/// Degrees of freedom and the value that a line of `*BOUNDARY` prescribes.
fn freedoms(line: &DataLine, scene: &mut ConditionContext) -> Result<Option<(Vec<usize>, f64)>, DeckFault> {
    let word = line.need(1, "a node or a node set and a degree of freedom")?.to_uppercase();
    let fixed = match word.as_str() {
        "ENCASTRE" => Some(vec![1, 2, 3, 4, 5, 6]),
        "PINNED" => Some(vec![1, 2, 3]),
        "XSYMM" => Some(vec![1, 5, 6]),
        "YSYMM" => Some(vec![2, 4, 6]),
        "ZSYMM" => Some(vec![3, 4, 5]),
        _ => None,
    };
    if let Some(fixed) = fixed {
        return Ok(Some((fixed, 0.0)));
    }
    let first = integer(line, 1)?;
    let last = if line.text(2).is_some() { integer(line, 2)? } else { first };
    let value = line.number(3)?.unwrap_or(0.0);
    if first < 1 || last < first || last > 32 {
        let found = format!("degrees of freedom {first} to {last}");
        return Err(DeckFault::new(&line.place, found, "a first one and a last one that is not smaller, 1 to 3 or 11"));
    }
    let dofs: Vec<usize> = (first..=last).filter_map(|dof| usize::try_from(dof).ok()).collect();
    let strange = |dof: &&usize| !(1..=6).contains(*dof) && **dof != 11;
    if let Some(dof) = dofs.iter().find(strange) {
        let why = "solids have displacements and a temperature";
        scene.notes.add(&line.place, format!("degree of freedom {dof}"), why, Matter::Answer);
    }
    Ok(Some((dofs, value)))
}

fn quantity(dof: usize, dim: usize) -> Option<PrescribedQuantity> {
    match dof {
        1..=3 if dof <= dim => Some(PrescribedQuantity::Displacement(dof - 1)),
        11 => Some(PrescribedQuantity::Temperature),
        _ => None,
    }
}

/// Degrees of freedom in local axes, converted to the axes of the case.
fn turned(
    local: &NodeAxes,
    dofs: &[usize],
    (line, value): (&DataLine, f64),
    dim: usize,
) -> Result<Vec<(PrescribedQuantity, f64)>, DeckFault> {
    let heat = dofs.iter().filter(|dof| **dof == 11).map(|_| (PrescribedQuantity::Temperature, value));
    let moved: Vec<usize> = dofs.iter().copied().filter(|dof| *dof <= dim.min(3)).collect();
    if moved.len() == dim && value == 0.0 {
        return Ok((0..dim).map(|d| (PrescribedQuantity::Displacement(d), 0.0)).chain(heat).collect());
    }
    let mut all: Vec<(PrescribedQuantity, f64)> = heat.collect();
    for dof in &moved {
        match local.along(dof - 1) {
            Some((axis, sign)) if axis < dim => all.push((PrescribedQuantity::Displacement(axis), sign * value)),
            _ if moved.len() == 1 && value == 0.0 && !local.is_radial(dof - 1) => {
                all.push((PrescribedQuantity::Normal, 0.0));
            }
            _ => {
                let found = format!("the degree of freedom {dof} in the axes of a *TRANSFORM, {}", number(value));
                let expected = "axes along x, y or z, or a plane side that is held along its normal with 0";
                return Err(DeckFault::new(&line.place, found, expected));
            }
        }
    }
    Ok(all)
}

/// Checks that nodes held along one local axis are those of a side to which this axis is normal.
fn check_normal(
    local: &NodeAxes,
    dofs: &[usize],
    (line, nodes): (&DataLine, &BTreeSet<DeckNodeId>),
    scene: &ConditionContext,
) -> Result<(), DeckFault> {
    let refuse = |found: &str, expected: &str| Err(DeckFault::new(&line.place, found, expected));
    if scene.mesh.on_facets(nodes) != *nodes {
        let found = "nodes that are held along one axis of a *TRANSFORM and are no side";
        return refuse(found, "a node set of whole facets, or axes along x, y or z");
    }
    let Some(axis) = dofs.iter().find(|dof| **dof <= scene.dim).map(|dof| dof - 1) else { return Ok(()) };
    if !scene.mesh.is_normal(nodes, |x| local.axes(x).get(axis).copied().unwrap_or_default()) {
        let found = format!("a side that is held along axis {} of a *TRANSFORM, to which it is not normal", axis + 1);
        return refuse(&found, "an axis along x, y or z, or along the normal of the side");
    }
    Ok(())
}

/// A unit vector.
fn direction(line: &DataLine, at: usize) -> Result<[f64; 3], DeckFault> {
    let mut along = [0.0; 3];
    for (d, along) in along.iter_mut().enumerate() {
        *along = line.number(at + d)?.unwrap_or(0.0);
    }
    let length = along.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 && length.is_finite() {
        return Ok(along.map(|x| x / length));
    }
    Err(DeckFault::new(
        &line.place,
        format!("\"{}\"", line.whole().escape_debug()),
        "a value and a direction that is not zero",
    ))
}
