//! Nodes, elements and sets of a deck by numbers and names, as loads and conditions refer to them.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use amontons::mesh::inp::{SolidType, solid_type};

use super::deck::{Card, DataLine, DeckFault, DeckPlace};
use super::vector::{cross, dot, unit};

/// A node: its body and its number.
pub type DeckNodeId = (usize, i64);
/// An element: its body and its number.
pub type DeckElementId = (usize, i64);

/// The kind of members of a set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum DeckSetKind {
    Nodes,
    Elements,
    Surface,
}

/// An entry of a set.
#[derive(Clone, Debug)]
enum DeckSetItem {
    Range(i64, i64, i64),
    Named(DeckPlace, String),
    /// The nodes of a set of elements.
    NodesOf(DeckPlace, String),
}

/// An entry of a set, with the instance to which its numbers refer.
type SetEntry = (Option<String>, DeckSetItem);
/// Key of a set: the body in which it is defined, the kind of its members, and its name in capitals.
type DeckSetKey = (Option<usize>, DeckSetKind, String);

/// A set with the spelling of its first definition.
#[derive(Clone, Debug)]
struct DeckSet {
    spelling: String,
    entries: Vec<SetEntry>,
}

/// An element of a body.
#[derive(Clone, Debug)]
pub struct DeckElement {
    pub solid: SolidType,
    pub nodes: Vec<i64>,
}

/// Nodes and elements that are numbered together.
#[derive(Clone, Debug, Default)]
pub struct DeckBody {
    name: Option<String>,
    /// Name of the part of which it is an instance, in capitals.
    part: Option<String>,
    pub points: BTreeMap<i64, [f64; 3]>,
    pub cells: BTreeMap<i64, DeckElement>,
    sets: Vec<(DeckSetKind, String, SetEntry)>,
}

/// The mesh of a deck.
#[derive(Debug, Default)]
pub struct DeckMesh {
    pub bodies: Vec<DeckBody>,
    sets: HashMap<DeckSetKey, DeckSet>,
    /// The elements of each node.
    around: HashMap<DeckNodeId, Vec<DeckElementId>>,
    /// Types of elements that do not belong to bodies, each with its first line and count.
    pub others: Vec<(String, DeckPlace, usize)>,
}

/// A mesh while it is read.
#[derive(Debug, Default)]
struct MeshReader {
    flat: DeckBody,
    parts: BTreeMap<String, DeckBody>,
    instances: Vec<DeckBody>,
    part: Option<String>,
    instance: Option<DeckBody>,
    others: Vec<(String, DeckPlace, usize)>,
}

impl DeckMesh {
    /// Reads nodes, elements and sets of a deck; other keywords are skipped.
    pub fn of(cards: &[Card]) -> Result<DeckMesh, DeckFault> {
        let mut reading = MeshReader::default();
        for card in cards {
            reading.take(card)?;
        }
        let MeshReader { mut flat, instances, others, .. } = reading;
        let mut mesh = DeckMesh { others, ..DeckMesh::default() };
        let of_assembly = if instances.is_empty() { Vec::new() } else { std::mem::take(&mut flat.sets) };
        for mut body in std::iter::once(flat).chain(instances) {
            let own = std::mem::take(&mut body.sets);
            mesh.bodies.push(body);
            let place = mesh.bodies.len() - 1;
            for set in own {
                mesh.add(Some(place), set);
            }
        }
        for set in of_assembly {
            mesh.add(None, set);
        }
        // Elements of lower dimension are facets and edges, as written by Gmsh.
        let cells = mesh.bodies.iter().flat_map(|body| body.cells.values());
        let dim = cells.map(|cell| cell.solid.element.dim()).max().unwrap_or(0);
        for body in &mut mesh.bodies {
            body.cells.retain(|_, cell| cell.solid.element.dim() == dim);
        }
        for (number, body) in mesh.bodies.iter().enumerate() {
            for (&element, cell) in &body.cells {
                for &node in &cell.nodes {
                    mesh.around.entry((number, node)).or_default().push((number, element));
                }
            }
        }
        Ok(mesh)
    }

    fn add(&mut self, body: Option<usize>, (has, name, entry): (DeckSetKind, String, SetEntry)) {
        let key = (body, has, name.to_uppercase());
        let set = self.sets.entry(key).or_insert_with(|| DeckSet { spelling: name, entries: Vec::new() });
        set.entries.push(entry);
    }

    /// The body to which numbers without an instance refer: the only one with nodes, or the assembly, which may have
    /// reference nodes of its own.
    fn default_body(&self) -> Option<usize> {
        let mut with = (0..self.bodies.len()).filter(|&body| !self.bodies[body].points.is_empty());
        let of_assembly = self.bodies.first().is_some_and(|body| body.name.is_none() && !body.points.is_empty());
        with.next().filter(|_| of_assembly || with.next().is_none())
    }

    /// Body and name of an item called `instance.name`.
    fn split<'n>(&self, name: &'n str) -> (Option<usize>, &'n str) {
        let of = |instance: &str| {
            self.bodies.iter().position(|body| body.name.as_ref().is_some_and(|own| own.eq_ignore_ascii_case(instance)))
        };
        match name.split_once('.').map(|(instance, rest)| (of(instance), rest)) {
            Some((Some(body), rest)) => (Some(body), rest),
            _ => (None, name),
        }
    }

    /// The key of a set named outside of parts.
    fn find(&self, has: DeckSetKind, name: &str) -> Option<DeckSetKey> {
        let (body, name) = self.split(name);
        let name = name.to_uppercase();
        let places: Vec<Option<usize>> = match body {
            Some(body) => vec![Some(body)],
            None => std::iter::once(None).chain((0..self.bodies.len()).map(Some)).collect(),
        };
        places.into_iter().map(|body| (body, has, name.clone())).find(|key| self.sets.contains_key(key))
    }

    /// The name of a set in the case, preceded by that of its instance if there are several.
    pub fn spelling(&self, has: DeckSetKind, name: &str) -> Option<String> {
        let key = self.find(has, name)?;
        let own = self.sets.get(&key)?.spelling.clone();
        let several = self.bodies.iter().filter(|body| body.name.is_some()).count() > 1;
        let instance = key.0.filter(|_| several).and_then(|body| self.bodies[body].name.clone());
        Some(instance.map_or(own.clone(), |instance| format!("{instance}.{own}")))
    }

    /// The names in the case of an element set of a part, one per instance; without a part the name of the only set.
    pub fn regions(&self, part: Option<&str>, set: &str) -> Vec<String> {
        let Some(part) = part.map(str::to_uppercase) else {
            return self.spelling(DeckSetKind::Elements, set).into_iter().collect();
        };
        let instances = self.bodies.iter().filter(|body| body.part.as_ref() == Some(&part));
        let names = instances.filter_map(|body| body.name.as_ref());
        names.filter_map(|name| self.spelling(DeckSetKind::Elements, &format!("{name}.{set}"))).collect()
    }

    /// Number of instances of a part in the assembly.
    pub fn instances(&self, part: &str) -> usize {
        self.bodies.iter().filter(|body| body.part.as_ref().is_some_and(|own| own.eq_ignore_ascii_case(part))).count()
    }

    /// The name of the instance of a body, or `None` for a deck without parts.
    pub fn instance(&self, body: usize) -> Option<&str> {
        self.bodies.get(body).and_then(|body| body.name.as_deref())
    }

    /// The nodes that an entry names, by number or as a set.
    pub fn nodes(&self, place: &DeckPlace, name: &str) -> Result<BTreeSet<DeckNodeId>, DeckFault> {
        self.members(place, DeckSetKind::Nodes, name, "a node or a node set that the deck has")
    }

    /// The elements that an entry names, by number or as a set.
    pub fn elements(&self, place: &DeckPlace, name: &str) -> Result<BTreeSet<DeckElementId>, DeckFault> {
        self.members(place, DeckSetKind::Elements, name, "an element or an element set that the deck has")
    }

    fn members(
        &self,
        place: &DeckPlace,
        has: DeckSetKind,
        name: &str,
        expected: &str,
    ) -> Result<BTreeSet<(usize, i64)>, DeckFault> {
        let unknown = || DeckFault::new(place, format!("\"{}\"", name.escape_debug()), expected);
        let (body, rest) = self.split(name);
        if let Ok(number) = rest.parse::<i64>() {
            let body = body.or_else(|| self.default_body()).ok_or_else(unknown)?;
            let known = match has {
                DeckSetKind::Nodes => self.bodies[body].points.contains_key(&number),
                _ => self.bodies[body].cells.contains_key(&number),
            };
            return if known { Ok(BTreeSet::from([(body, number)])) } else { Err(unknown()) };
        }
        let key = self.find(has, name).ok_or_else(unknown)?;
        let mut found = BTreeSet::new();
        self.resolve(key, &mut HashSet::new(), &mut found)?;
        Ok(found)
    }

    /// Adds the members of a set. Each set is visited once, however often it is named.
    fn resolve(
        &self,
        key: DeckSetKey,
        seen: &mut HashSet<DeckSetKey>,
        found: &mut BTreeSet<(usize, i64)>,
    ) -> Result<(), DeckFault> {
        let mut waiting = vec![key];
        while let Some(key) = waiting.pop() {
            let (body, has, _) = key;
            let Some(set) = self.sets.get(&key) else { continue };
            if !seen.insert(key) {
                continue;
            }
            for (instance, item) in &set.entries {
                let scope = instance.as_ref().and_then(|name| self.split(&format!("{name}.")).0);
                let scope = scope.or(body).or_else(|| self.default_body());
                match item {
                    DeckSetItem::Range(first, last, step) => {
                        let Some(body) = scope else { continue };
                        self.range((body, has), (*first, *last, *step), found);
                    }
                    DeckSetItem::Named(place, name) => waiting.push(self.home(place, (scope, has), name)?),
                    DeckSetItem::NodesOf(place, name) => {
                        let (key, mut cells) =
                            (self.home(place, (scope, DeckSetKind::Elements), name)?, BTreeSet::new());
                        self.resolve(key, seen, &mut cells)?;
                        found.extend(cells.into_iter().flat_map(|cell| self.nodes_of(cell)));
                    }
                }
            }
        }
        Ok(())
    }

    fn range(
        &self,
        (body, has): (usize, DeckSetKind),
        (first, last, step): (i64, i64, i64),
        found: &mut BTreeSet<(usize, i64)>,
    ) {
        if first > last {
            return;
        }
        let inside = |number: &i64| (i128::from(*number) - i128::from(first)) % i128::from(step) == 0;
        let body_of = &self.bodies[body];
        match has {
            DeckSetKind::Nodes => {
                found.extend(body_of.points.range(first..=last).map(|(n, _)| *n).filter(inside).map(|n| (body, n)));
            }
            _ => found.extend(body_of.cells.range(first..=last).map(|(n, _)| *n).filter(inside).map(|n| (body, n))),
        }
    }

    /// The key of a set named by another set.
    fn home(
        &self,
        place: &DeckPlace,
        (scope, has): (Option<usize>, DeckSetKind),
        name: &str,
    ) -> Result<DeckSetKey, DeckFault> {
        let own = (scope, has, name.to_uppercase());
        let key = if self.sets.contains_key(&own) { Some(own) } else { self.find(has, name) };
        key.ok_or_else(|| DeckFault::new(place, format!("\"{}\"", name.escape_debug()), "a set that the deck has"))
    }

    /// The name of a surface in the case, or a fault if it does not exist.
    pub fn surface(&self, place: &DeckPlace, name: &str) -> Result<String, DeckFault> {
        self.spelling(DeckSetKind::Surface, name).ok_or_else(|| {
            DeckFault::new(place, format!("\"{}\"", name.escape_debug()), "a *SURFACE that the deck defines")
        })
    }

    pub fn cell(&self, (body, number): DeckElementId) -> Option<&DeckElement> {
        self.bodies.get(body)?.cells.get(&number)
    }

    /// The nodes of an element.
    pub fn nodes_of(&self, element: DeckElementId) -> Vec<DeckNodeId> {
        let nodes = self.cell(element).map(|cell| cell.nodes.as_slice()).unwrap_or_default();
        nodes.iter().map(|&node| (element.0, node)).collect()
    }

    pub fn point(&self, (body, number): DeckNodeId) -> [f64; 3] {
        self.bodies.get(body).and_then(|body| body.points.get(&number)).copied().unwrap_or_default()
    }

    /// True if a node belongs to an element.
    pub fn is_used(&self, node: &DeckNodeId) -> bool {
        self.around.contains_key(node)
    }

    /// All nodes of elements.
    pub fn all_nodes(&self) -> BTreeSet<DeckNodeId> {
        self.around.keys().copied().collect()
    }

    /// The elements that contain any of some nodes.
    fn about(&self, nodes: &BTreeSet<DeckNodeId>) -> BTreeSet<DeckElementId> {
        nodes.iter().filter_map(|node| self.around.get(node)).flatten().copied().collect()
    }

    /// The facets of the boundary with all nodes in a set, by their nodes in order.
    fn facets(&self, nodes: &BTreeSet<DeckNodeId>) -> Vec<Vec<DeckNodeId>> {
        let mut found: HashMap<Vec<DeckNodeId>, (usize, Vec<DeckNodeId>)> = HashMap::new();
        for element in self.about(nodes) {
            let Some(cell) = self.cell(element) else { continue };
            for facet in cell.solid.element.facets {
                let own = facet.nodes.iter().filter_map(|&node| cell.nodes.get(node).map(|&node| (element.0, node)));
                let own: Vec<DeckNodeId> = own.collect();
                if own.iter().all(|node| nodes.contains(node)) {
                    let mut key = own.clone();
                    key.sort_unstable();
                    found.entry(key).or_insert((0, own)).0 += 1;
                }
            }
        }
        found.into_values().filter(|(times, _)| *times == 1).map(|(_, facet)| facet).collect()
    }

    /// The nodes of the facets of the boundary that lie completely in a set of nodes.
    pub fn on_facets(&self, nodes: &BTreeSet<DeckNodeId>) -> BTreeSet<DeckNodeId> {
        self.facets(nodes).into_iter().flatten().collect()
    }

    /// True if the facets of the boundary within a set of nodes are normal to a unit vector, which may vary in space.
    pub fn is_normal(&self, nodes: &BTreeSet<DeckNodeId>, direction: impl Fn(&[f64; 3]) -> [f64; 3]) -> bool {
        // Decks have few digits.
        const NORMAL: f64 = 1e-3;
        self.facets(nodes).iter().all(|facet| {
            let points: Vec<[f64; 3]> = facet.iter().map(|&node| self.point(node)).collect();
            points.iter().all(|x| {
                let normal = direction(x);
                let mut edges = points.iter().map(|y| -> [f64; 3] { std::array::from_fn(|d| y[d] - x[d]) });
                edges.all(|edge| dot(&edge, &normal).abs() <= NORMAL * dot(&edge, &edge).sqrt())
            })
        })
    }

    /// Area of the facets of the boundary within a set of nodes, with straight edges: length in the plane, area of the
    /// whole ring for a body of revolution.
    pub fn area(&self, nodes: &BTreeSet<DeckNodeId>) -> f64 {
        let ring = self.bodies.iter().flat_map(|body| body.cells.values()).any(|cell| cell.solid.axisymmetric);
        let plane = self.bodies.iter().flat_map(|body| body.cells.values()).all(|cell| cell.solid.element.dim() == 2);
        let of = |facet: Vec<DeckNodeId>| {
            let points: Vec<[f64; 3]> = facet.iter().map(|&node| self.point(node)).collect();
            match points[..] {
                [a, b, ..] if plane => {
                    let around = if ring { std::f64::consts::PI * (a[0] + b[0]) } else { 1.0 };
                    around * (b[0] - a[0]).hypot(b[1] - a[1])
                }
                // Vertices come first: three for a triangle, which has three or six nodes, else four.
                [a, b, c] | [a, b, c, _, _, _] => triangle(a, b, c),
                [a, b, c, d, ..] => triangle(a, b, c) + triangle(a, c, d),
                _ => 0.0,
            }
        };
        // Sorted, so that sums have the same bits in every run.
        let mut facets = self.facets(nodes);
        facets.sort_unstable();
        facets.into_iter().map(of).sum()
    }

    /// Divides a set of nodes into sets of which no two nodes are in one element: sets of points.
    pub fn apart(&self, nodes: &BTreeSet<DeckNodeId>) -> Vec<BTreeSet<DeckNodeId>> {
        let mut colours: HashMap<DeckNodeId, usize> = HashMap::new();
        let mut parts: Vec<BTreeSet<DeckNodeId>> = Vec::new();
        for &node in nodes {
            let cells = self.around.get(&node).map(Vec::as_slice).unwrap_or_default();
            let beside = cells.iter().flat_map(|&element| self.nodes_of(element));
            let taken: HashSet<usize> = beside.filter_map(|other| colours.get(&other).copied()).collect();
            let colour = (0..=taken.len()).find(|colour| !taken.contains(colour)).unwrap_or_default();
            colours.insert(node, colour);
            if parts.len() <= colour {
                parts.resize(colour + 1, BTreeSet::new());
            }
            parts[colour].insert(node);
        }
        parts
    }

    /// True if all of the elements have the face with this number, from 1.
    pub fn has_face(&self, elements: &BTreeSet<DeckElementId>, number: usize) -> bool {
        let mut cells = elements.iter().filter_map(|&element| self.cell(element));
        cells.all(|cell| (1..=cell.solid.element.facets.len()).contains(&number))
    }
}

impl MeshReader {
    fn current(&mut self) -> &mut DeckBody {
        if let Some(instance) = &mut self.instance {
            return instance;
        }
        match &self.part {
            Some(name) => self.parts.entry(name.clone()).or_default(),
            None => &mut self.flat,
        }
    }

    fn take(&mut self, card: &Card) -> Result<(), DeckFault> {
        match card.name.as_str() {
            "PART" => self.part = Some(card.required("NAME")?.to_uppercase()),
            "END PART" => self.part = None,
            "INSTANCE" => {
                let mut body = self.parts.get(&card.required("PART")?.to_uppercase()).cloned().unwrap_or_default();
                body.name = Some(card.required("NAME")?.to_owned());
                body.part = Some(card.required("PART")?.to_uppercase());
                place(&mut body, card)?;
                self.instance = Some(body);
            }
            "END INSTANCE" => self.instances.extend(self.instance.take()),
            "NODE" => {
                for line in &card.data {
                    let number = integer(line, 0)?;
                    let coordinate = |index| Ok(line.number(index)?.unwrap_or(0.0));
                    let point = [coordinate(1)?, coordinate(2)?, coordinate(3)?];
                    self.current().points.insert(number, point);
                }
                if let Some(name) = card.parameter("NSET") {
                    let items = card.data.iter().map(|line| integer(line, 0).map(|n| DeckSetItem::Range(n, n, 1)));
                    self.set(DeckSetKind::Nodes, name, None, items.collect::<Result<_, _>>()?);
                }
            }
            "ELEMENT" => self.elements(card)?,
            "NSET" => {
                let items = match card.parameter("ELSET") {
                    Some(name) => vec![DeckSetItem::NodesOf(card.place.clone(), name.to_owned())],
                    None => members(card)?,
                };
                self.set(DeckSetKind::Nodes, card.required("NSET")?, card.parameter("INSTANCE"), items);
            }
            "ELSET" => {
                self.set(DeckSetKind::Elements, card.required("ELSET")?, card.parameter("INSTANCE"), members(card)?);
            }
            "SURFACE" => self.set(DeckSetKind::Surface, card.required("NAME")?, None, Vec::new()),
            _ => {}
        }
        Ok(())
    }

    fn set(&mut self, has: DeckSetKind, name: &str, instance: Option<&str>, items: Vec<DeckSetItem>) {
        let instance = instance.map(str::to_owned);
        let empty = items.is_empty().then_some(DeckSetItem::Range(0, -1, 1));
        let entries = items.into_iter().chain(empty).map(|item| (has, name.to_owned(), (instance.clone(), item)));
        self.current().sets.extend(entries);
    }

    fn elements(&mut self, card: &Card) -> Result<(), DeckFault> {
        let name = card.required("TYPE")?;
        let Some(solid) = solid_type(name) else {
            self.others.push((name.to_uppercase(), card.place.clone(), card.data.len()));
            return Ok(());
        };
        let mut items = Vec::new();
        let entries = card.data.iter().flat_map(|line| (0..line.entries.len()).map(move |index| (line, index)));
        let mut entries = entries.filter(|(line, index)| line.text(*index).is_some());
        while let Some((line, index)) = entries.next() {
            let number = integer(line, index)?;
            let nodes: Vec<i64> =
                entries.by_ref().take(solid.nodes).map(|(line, i)| integer(line, i)).collect::<Result<_, _>>()?;
            self.current().cells.insert(number, DeckElement { solid, nodes });
            items.push(DeckSetItem::Range(number, number, 1));
        }
        if let Some(name) = card.parameter("ELSET") {
            self.set(DeckSetKind::Elements, name, None, items);
        }
        Ok(())
    }
}

/// Places an instance: a translation, and a rotation about an axis in degrees.
fn place(body: &mut DeckBody, card: &Card) -> Result<(), DeckFault> {
    if let Some(line) = card.data.first() {
        let shift = [0, 1, 2].map(|d| line.number(d));
        for (d, shift) in shift.into_iter().enumerate() {
            let shift = shift?.unwrap_or(0.0);
            body.points.values_mut().for_each(|point| point[d] += shift);
        }
    }
    let Some(line) = card.data.get(1) else { return Ok(()) };
    let [ax, ay, az, bx, by, bz, angle] = line.numbers()?[..] else { return Ok(()) };
    let (sin, cos) = angle.to_radians().sin_cos();
    let Some(axis) = unit([bx - ax, by - ay, bz - az]) else { return Ok(()) };
    for point in body.points.values_mut() {
        let from = [point[0] - ax, point[1] - ay, point[2] - az];
        let (around, along) = (cross(&axis, &from), dot(&axis, &from) * (1.0 - cos));
        *point = std::array::from_fn(|d| [ax, ay, az][d] + cos * from[d] + sin * around[d] + along * axis[d]);
    }
    Ok(())
}

/// Area of a triangle.
fn triangle(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> f64 {
    let [u, v]: [[f64; 3]; 2] = [b, c].map(|p| std::array::from_fn(|d| p[d] - a[d]));
    let normal = cross(&u, &v);
    0.5 * dot(&normal, &normal).sqrt()
}

/// An integer of a data line.
pub fn integer(line: &DataLine, index: usize) -> Result<i64, DeckFault> {
    let text = line.need(index, "a whole number")?;
    text.parse().map_err(|_| DeckFault::new(&line.place, format!("\"{}\"", text.escape_debug()), "a whole number"))
}

/// The members of a set: numbers, names of sets, or ranges.
fn members(card: &Card) -> Result<Vec<DeckSetItem>, DeckFault> {
    let mut items = Vec::new();
    for line in &card.data {
        if card.has("GENERATE") {
            let (first, last) = (integer(line, 0)?, integer(line, 1)?);
            let step = if line.text(2).is_some() { integer(line, 2)? } else { 1 };
            if first > last || step < 1 {
                let expected = "a first number, a last one that is not smaller, and a positive step";
                return Err(DeckFault::new(&line.place, format!("\"{}\"", line.whole()), expected));
            }
            items.push(DeckSetItem::Range(first, last, step));
            continue;
        }
        for name in line.entries.iter().filter(|entry| !entry.is_empty()) {
            items.push(match name.parse::<i64>() {
                Ok(number) => DeckSetItem::Range(number, number, 1),
                Err(_) => DeckSetItem::Named(line.place.clone(), name.clone()),
            });
        }
    }
    Ok(items)
}

#[cfg(test)]
mod tests {
    use super::{DeckBody, place};
    use crate::import::deck;

    #[test]
    fn an_instance_is_moved_and_then_turned() {
        let file = std::env::temp_dir().join(format!("amontons-instance-{}.inp", std::process::id()));
        std::fs::write(&file, "*INSTANCE, NAME=A, PART=B\n1, 0, 0\n0, 0, 0, 0, 0, 2, 90\n").expect("a deck");
        let cards = deck::read(&file).expect("a card");
        std::fs::remove_file(&file).expect("a file");
        let mut body = DeckBody { points: [(1, [1.0, 0.0, 3.0])].into(), ..DeckBody::default() };
        place(&mut body, &cards[0]).expect("an instance");
        // (1, 0, 3) goes to (2, 0, 3), and about z by 90° to (0, 2, 3).
        for (found, expected) in body.points[&1].into_iter().zip([0.0, 2.0, 3.0]) {
            assert!((found - expected).abs() < 1e-15, "{found} {expected}");
        }
    }
}
