//! Regions and sides of an input file: its sets, resolved to elements and facets.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::hash::Hash;
use std::sync::Arc;

use super::super::read::{FacetOf, FilePosition, Loose, MeshFileError, NodeSet, Plane, facet_with};
use super::model::{Cell, Has, Item, Model, Part, Set, index};
use super::solid::face;

/// How deep sets may be named in sets.
const DEEPEST: usize = 32;
/// Name of the region of elements in no set.
const BODY: &str = "body";

/// A body of the assembly: the flat part of the file, or an instance.
struct Body {
    name: Option<String>,
    part: Part,
    /// Number of its first node among all.
    first_node: u32,
    nodes: HashMap<i64, u32>,
    cells: HashMap<i64, usize>,
}

/// Sets of a body, or of the assembly, by kind and name in capitals.
type Key = (Option<usize>, Has, String);

/// What sets have been resolved to: a set that many name, and these again, is resolved once.
type Resolved<T> = RefCell<HashMap<Key, Arc<[T]>>>;

/// All sets with what is needed to resolve them.
struct Sets {
    bodies: Vec<Body>,
    known: HashMap<Key, Vec<Set>>,
    elements: Resolved<CellOf>,
    numbers: Resolved<u32>,
    /// In the order of the file: body, kind and name as written.
    order: Vec<(Option<usize>, Has, String)>,
}

/// A cell of a body.
type CellOf = (usize, usize);

/// What the file describes, whether it is the half section of a body of revolution, and what its elements say of the
/// direction that a plane body lacks.
pub(super) fn loose(model: Model) -> Result<(Loose, bool, Option<Plane>), MeshFileError> {
    let sets = Sets::of(model)?;
    let points = sets.bodies.iter().flat_map(|body| body.part.points.iter().copied()).collect();
    let mut loose = Loose { points, blocks: Vec::new(), names: BTreeMap::new(), node_sets: Vec::new() };
    let is_of_revolution = sets.is_of_revolution()?;
    let dim = sets.cells().map(|(body, cell)| sets.cell(body, cell).solid.kind.dim).max().unwrap_or(0);
    sets.regions(dim, &mut loose)?;
    if dim > 0 {
        sets.sides(&mut loose)?;
    }
    Ok((loose, is_of_revolution, sets.plane()))
}

/// The error of something that a line names and that there is not.
fn unknown(line: usize, found: String, expected: &str) -> MeshFileError {
    MeshFileError::Syntax { at: FilePosition::Line(line), found, expected: expected.to_owned() }
}

impl Sets {
    fn of(model: Model) -> Result<Sets, MeshFileError> {
        let mut sets = Sets {
            bodies: Vec::new(),
            known: HashMap::new(),
            elements: Resolved::default(),
            numbers: Resolved::default(),
            order: Vec::new(),
        };
        let mut first_node = 0;
        let mut flat = model.flat;
        // Sets outside of parts may be those of any instance.
        let of_assembly = if model.instances.is_empty() { Vec::new() } else { std::mem::take(&mut flat.sets) };
        let parts = model.instances.into_iter().map(|instance| (Some(instance.name), instance.part));
        for (name, mut part) in std::iter::once((None, flat)).chain(parts) {
            let own = std::mem::take(&mut part.sets);
            let nodes = index(part.tags.iter())?;
            let cells = part.cells.iter().enumerate().map(|(place, cell)| (cell.number, place)).collect();
            let more = part.points.len() as u32;
            sets.bodies.push(Body { name, part, first_node, nodes, cells });
            first_node += more;
            let body = sets.bodies.len() - 1;
            for set in own {
                sets.add(Some(body), set);
            }
        }
        for set in of_assembly {
            sets.add(None, set);
        }
        Ok(sets)
    }

    fn add(&mut self, body: Option<usize>, set: Set) {
        let key = (body, set.has, set.name.to_uppercase());
        let parts = self.known.entry(key).or_default();
        if parts.is_empty() {
            self.order.push((body, set.has, set.name.clone()));
        }
        parts.push(set);
    }

    /// All cells in turn.
    fn cells(&self) -> impl Iterator<Item = CellOf> {
        self.bodies.iter().enumerate().flat_map(|(b, body)| (0..body.part.cells.len()).map(move |cell| (b, cell)))
    }

    fn cell(&self, body: usize, cell: usize) -> &Cell {
        &self.bodies[body].part.cells[cell]
    }

    /// Numbers of the nodes of a cell among all nodes.
    fn nodes(&self, body: usize, cell: usize) -> Result<Vec<u32>, MeshFileError> {
        let Body { part, nodes, first_node, .. } = &self.bodies[body];
        let Cell { first, solid, line, .. } = &part.cells[cell];
        part.nodes[*first..first + solid.kind.nodes]
            .iter()
            .map(|&tag| {
                let at = FilePosition::Line(*line);
                let node = nodes.get(&tag).ok_or(MeshFileError::UnknownNode { at, tag, nodes: part.tags.len() })?;
                Ok(first_node + node)
            })
            .collect()
    }

    fn is_of_revolution(&self) -> Result<bool, MeshFileError> {
        let mut plane = self.cells().map(|(body, cell)| self.cell(body, cell)).filter(|cell| cell.solid.kind.dim == 2);
        let Some(first) = plane.next().map(|cell| cell.solid.axisymmetric) else { return Ok(false) };
        match plane.find(|cell| cell.solid.axisymmetric != first) {
            None => Ok(first),
            Some(other) => Err(unknown(
                other.line,
                "plane elements beside those of a body of revolution".to_owned(),
                "elements of one kind, CAX… or CPS…, CPE…",
            )),
        }
    }

    /// What all elements say of the direction that a plane body lacks, if it is the same.
    fn plane(&self) -> Option<Plane> {
        let mut of_cells = self.cells().map(|(body, cell)| self.cell(body, cell).solid.plane);
        let first = of_cells.next().flatten();
        first.filter(|_| of_cells.all(|other| other == first))
    }

    /// The name of a set of a body to the outside.
    fn outside(&self, body: Option<usize>, name: &str) -> String {
        let instances = self.bodies.iter().filter(|body| body.name.is_some()).count();
        match body.and_then(|body| self.bodies[body].name.as_ref()) {
            Some(instance) if instances > 1 => format!("{instance}.{name}"),
            _ => name.to_owned(),
        }
    }

    /// The cells with their regions.
    fn regions(&self, dim: usize, loose: &mut Loose) -> Result<(), MeshFileError> {
        let mut of_cell: HashMap<CellOf, BTreeSet<i64>> = HashMap::new();
        let mut groups: Vec<String> = Vec::new();
        let mut group = |name: String| {
            let known = groups.iter().position(|other| *other == name);
            known.unwrap_or_else(|| {
                groups.push(name);
                groups.len() - 1
            }) as i64
        };
        let sections: Vec<_> = self.order.iter().filter(|(_, has, _)| *has == Has::Section).collect();
        for (body, has, name) in &sections {
            let first = self.spelling(*body, Has::Elements, name);
            let number = group(self.outside(*body, &first));
            for cell in self.elements(*body, *has, name, 0)? {
                of_cell.entry(cell).or_default().insert(number);
            }
        }
        if sections.is_empty() {
            for (body, cell) in self.cells() {
                if let Some(set) = &self.cell(body, cell).set {
                    let first = self.spelling(Some(body), Has::Elements, set);
                    of_cell.entry((body, cell)).or_default().insert(group(self.outside(Some(body), &first)));
                }
            }
        }
        if !groups.is_empty() {
            let rest = self.cells().filter(|cell| !of_cell.contains_key(cell)).collect::<Vec<_>>();
            let (mut group_of_rest, body) = (None, BODY.to_owned());
            for cell in rest {
                let number = *group_of_rest.get_or_insert_with(|| {
                    groups.push(body.clone());
                    groups.len() as i64 - 1
                });
                of_cell.entry(cell).or_default().insert(number);
            }
        }
        for (number, name) in groups.into_iter().enumerate() {
            loose.names.insert((dim, number as i64), name);
        }
        for (body, cell) in self.cells() {
            let Cell { solid, line, .. } = self.cell(body, cell);
            let groups = of_cell.remove(&(body, cell)).unwrap_or_default();
            loose.push(solid.kind, &groups, *line, &self.nodes(body, cell)?);
        }
        Ok(())
    }

    /// The name of a set as it is spelled first.
    fn spelling(&self, body: Option<usize>, has: Has, name: &str) -> String {
        let first = self.known.get(&(body, has, name.to_uppercase())).and_then(|sets| sets.first());
        first.map_or_else(|| name.to_owned(), |set| set.name.clone())
    }

    /// Surfaces, and the sets of nodes.
    fn sides(&self, loose: &mut Loose) -> Result<(), MeshFileError> {
        // A surface goes before a set of nodes of its name.
        let (nodes, surfaces): (Vec<_>, Vec<_>) = self.order.iter().partition(|(_, has, _)| *has == Has::Nodes);
        let mut names: Vec<String> = Vec::new();
        for (body, has, name) in surfaces.into_iter().chain(nodes) {
            let name_outside = self.outside(*body, name);
            if names.iter().any(|other| other.eq_ignore_ascii_case(&name_outside)) {
                continue;
            }
            match has {
                Has::Faces => {
                    let facets = self.faces(*body, name, loose)?;
                    if facets.is_empty() {
                        continue;
                    }
                    loose.side(name_outside.clone(), &facets);
                }
                Has::Nodes | Has::NodesOfSurface => {
                    let nodes: BTreeSet<u32> = self.node_numbers(*body, *has, name, 0)?.into_iter().collect();
                    if nodes.is_empty() {
                        continue;
                    }
                    loose.node_sets.push(NodeSet { name: name_outside.clone(), nodes });
                }
                Has::Elements | Has::Section => continue,
            }
            names.push(name_outside);
        }
        Ok(())
    }

    /// The facets of a surface: of labelled faces, and of all free faces of elements without a label.
    fn faces(&self, body: Option<usize>, name: &str, loose: &Loose) -> Result<Vec<FacetOf>, MeshFileError> {
        let (mut facets, mut free) = (Vec::new(), None);
        for set in self.known.get(&(body, Has::Faces, name.to_uppercase())).into_iter().flatten() {
            for item in &set.items {
                let Item::Named { line, name, face: label } = item else { continue };
                let scope = self.scope(body, set.instance.as_deref());
                let cells = self.named_elements(scope, *line, name, 0)?;
                let Some(label) = label else {
                    let free = free.get_or_insert_with(|| loose.free());
                    for (body, cell) in BTreeSet::from_iter(cells) {
                        let nodes = self.nodes(body, cell)?;
                        let own = self.cell(body, cell).solid.kind.element.map_or(&[][..], |element| element.facets);
                        let own = own.iter().map(|facet| FacetOf::new(facet, &nodes));
                        facets.extend(own.filter(|facet| free.contains(&facet.key())));
                    }
                    continue;
                };
                for (body, cell) in cells {
                    let nodes = self.nodes(body, cell)?;
                    let element = self.cell(body, cell).solid.kind.element;
                    let number = label.strip_prefix('S').and_then(|number| number.parse().ok());
                    let found = element.zip(number).and_then(|(element, number)| {
                        let vertices = face(element, number)?;
                        facet_with(element, vertices)
                    });
                    let Some(found) = found else {
                        let what = element.map_or("element", |element| element.name);
                        return Err(unknown(
                            *line,
                            format!("the face {label} of a {what}"),
                            "S1, S2, … up to its number of faces",
                        ));
                    };
                    facets.push(FacetOf::new(found, &nodes));
                }
            }
        }
        Ok(facets)
    }

    /// The body that numbers in a set are those of: of its instance, its own, or the only one there is.
    fn scope(&self, body: Option<usize>, instance: Option<&str>) -> Option<usize> {
        let of = |name: &str| {
            self.bodies.iter().position(|body| body.name.as_ref().is_some_and(|own| own.eq_ignore_ascii_case(name)))
        };
        instance.and_then(of).or(body)
    }

    /// Body and name of something that is called `instance.name`, or that is of a scope.
    fn split<'n>(&self, scope: Option<usize>, name: &'n str) -> (Option<usize>, &'n str) {
        match name.split_once('.').map(|(instance, rest)| (self.scope(None, Some(instance)), rest)) {
            Some((Some(body), rest)) => (Some(body), rest),
            _ => (scope, name),
        }
    }

    /// What the entries of a set stand for, in their order and each once.
    fn resolved<T: Copy + Eq + Hash>(
        &self,
        (body, has, name): (Option<usize>, Has, &str),
        resolved: &Resolved<T>,
        resolve: impl Fn(Option<usize>, &Item) -> Result<Vec<T>, MeshFileError>,
    ) -> Result<Vec<T>, MeshFileError> {
        let key = (body, has, name.to_uppercase());
        if let Some(members) = resolved.borrow().get(&key) {
            return Ok(members.to_vec());
        }
        let (mut found, mut seen) = (Vec::new(), HashSet::new());
        for set in self.known.get(&key).into_iter().flatten() {
            let scope = self.scope(body, set.instance.as_deref());
            for item in &set.items {
                found.extend(resolve(scope, item)?.into_iter().filter(|member| seen.insert(*member)));
            }
        }
        resolved.borrow_mut().insert(key, found.clone().into());
        Ok(found)
    }

    /// The scope in which a set is defined that an entry of a scope names, `depth` sets deep.
    fn home(
        &self,
        (scope, line, depth): (Option<usize>, usize, usize),
        has: Has,
        name: &str,
    ) -> Result<Option<usize>, MeshFileError> {
        let known = |body: &Option<usize>| self.known.contains_key(&(*body, has, name.to_uppercase()));
        let home = if depth < DEEPEST { [scope, None].into_iter().find(known) } else { None };
        home.ok_or_else(|| {
            let kind = if has == Has::Nodes { "node" } else { "element" };
            unknown(line, format!("the {kind} set {name:?}"), "a set that the file defines")
        })
    }

    /// Elements of a set.
    fn elements(&self, body: Option<usize>, has: Has, name: &str, depth: usize) -> Result<Vec<CellOf>, MeshFileError> {
        self.resolved((body, has, name), &self.elements, |scope, item| match item {
            Item::Range(first, last, step) => {
                let Some(body) = scope else { return Ok(Vec::new()) };
                let mut cells: Vec<CellOf> =
                    within(&self.bodies[body].cells, *first, *last, *step).map(|cell| (body, *cell)).collect();
                cells.sort_unstable();
                Ok(cells)
            }
            Item::Named { line, name, .. } => self.named_elements(scope, *line, name, depth),
            Item::NodesOf { .. } => Ok(Vec::new()),
        })
    }

    /// Elements that an entry names: by number, or as a set.
    fn named_elements(
        &self,
        scope: Option<usize>,
        line: usize,
        name: &str,
        depth: usize,
    ) -> Result<Vec<CellOf>, MeshFileError> {
        let (scope, name) = self.split(scope, name);
        if let (Ok(number), Some(body)) = (name.parse::<i64>(), scope) {
            // Numbers of elements that are no parts of bodies are left out with these.
            return Ok(self.bodies[body].cells.get(&number).map(|&cell| (body, cell)).into_iter().collect());
        }
        let body = self.home((scope, line, depth), Has::Elements, name)?;
        self.elements(body, Has::Elements, name, depth + 1)
    }

    /// Nodes of a set, by their numbers among all.
    fn node_numbers(&self, body: Option<usize>, has: Has, name: &str, depth: usize) -> Result<Vec<u32>, MeshFileError> {
        self.resolved((body, has, name), &self.numbers, |scope, item| match item {
            Item::Range(first, last, step) => {
                let Some(Body { nodes, first_node, .. }) = scope.map(|body| &self.bodies[body]) else {
                    return Ok(Vec::new());
                };
                Ok(within(nodes, *first, *last, *step).map(|node| first_node + node).collect())
            }
            Item::Named { line, name, .. } => self.named_nodes(scope, *line, name, depth),
            Item::NodesOf { line, name } => {
                let cells = self.named_elements(scope, *line, name, depth)?;
                let nodes = cells.into_iter().map(|(body, cell)| self.nodes(body, cell));
                Ok(nodes.collect::<Result<Vec<_>, _>>()?.concat())
            }
        })
    }

    /// Nodes that an entry names: by number, or as a set.
    fn named_nodes(
        &self,
        scope: Option<usize>,
        line: usize,
        name: &str,
        depth: usize,
    ) -> Result<Vec<u32>, MeshFileError> {
        let (scope, name) = self.split(scope, name);
        if let (Ok(tag), Some(body)) = (name.parse::<i64>(), scope) {
            let Body { nodes, first_node, part, .. } = &self.bodies[body];
            let at = FilePosition::Line(line);
            let node = nodes.get(&tag).ok_or(MeshFileError::UnknownNode { at, tag, nodes: part.tags.len() })?;
            return Ok(vec![first_node + node]);
        }
        let body = self.home((scope, line, depth), Has::Nodes, name)?;
        self.node_numbers(body, Has::Nodes, name, depth + 1)
    }
}

/// The values of the numbers of a range that there are: as many as the smaller of both has.
fn within<T>(known: &HashMap<i64, T>, first: i64, last: i64, step: i64) -> impl Iterator<Item = &T> {
    let numbers = (last.saturating_sub(first) / step).saturating_add(1);
    let few = usize::try_from(numbers).is_ok_and(|numbers| numbers <= known.len());
    let by_number = few.then(|| (0..numbers).filter_map(move |n| known.get(&(first + n * step))));
    let by_member = (!few).then(|| {
        let inside = move |number: i64| (first..=last).contains(&number) && (number - first) % step == 0;
        known.iter().filter(move |(number, _)| inside(**number)).map(|(_, value)| value)
    });
    by_number.into_iter().flatten().chain(by_member.into_iter().flatten())
}
