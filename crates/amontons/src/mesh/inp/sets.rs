//! Regions and sides of an input file: its sets, resolved to elements and facets.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use super::super::read::{FilePosition, Kind, Loose, LooseBlock, MeshFileError};
use super::super::topology::{Key, key};
use super::model::{Cell, Has, Item, Model, Part, Set, index};
use super::solid::{face, facet};
use crate::element::{Element, Facet, POINT_LEFT};

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

/// All sets with what is needed to resolve them.
struct Sets {
    bodies: Vec<Body>,
    /// Sets of a body, or of the assembly, by kind and name in capitals.
    known: HashMap<(Option<usize>, Has, String), Vec<Set>>,
    /// In the order of the file: body, kind and name as written.
    order: Vec<(Option<usize>, Has, String)>,
}

/// A cell of a body.
type CellOf = (usize, usize);

/// What the file describes, and whether it is the half section of a body of revolution.
pub(super) fn loose(model: Model) -> Result<(Loose, bool), MeshFileError> {
    let sets = Sets::of(model)?;
    let points = sets.bodies.iter().flat_map(|body| body.part.points.iter().copied()).collect();
    let mut loose = Loose { points, blocks: Vec::new(), names: BTreeMap::new() };
    let is_of_revolution = sets.is_of_revolution()?;
    let dim = sets.cells().map(|(body, cell)| sets.cell(body, cell).solid.kind.dim).max().unwrap_or(0);
    sets.regions(dim, &mut loose)?;
    if dim > 0 {
        sets.sides(dim, &mut loose)?;
    }
    Ok((loose, is_of_revolution))
}

/// The error of something that a line names and that there is not.
fn unknown(line: usize, found: String, expected: &str) -> MeshFileError {
    MeshFileError::Syntax { at: FilePosition::Line(line), found, expected: expected.to_owned() }
}

impl Sets {
    fn of(model: Model) -> Result<Sets, MeshFileError> {
        let mut sets = Sets { bodies: Vec::new(), known: HashMap::new(), order: Vec::new() };
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
            push(loose, solid.kind, groups, *line, self.nodes(body, cell)?);
        }
        Ok(())
    }

    /// The name of a set as it is spelled first.
    fn spelling(&self, body: Option<usize>, has: Has, name: &str) -> String {
        let first = self.known.get(&(body, has, name.to_uppercase())).and_then(|sets| sets.first());
        first.map_or_else(|| name.to_owned(), |set| set.name.clone())
    }

    /// Surfaces, and the sets of nodes that hold facets of the boundary; other sets of nodes are edges or points.
    fn sides(&self, dim: usize, loose: &mut Loose) -> Result<(), MeshFileError> {
        let boundary = self.boundary(dim)?;
        let mut names: Vec<String> = Vec::new();
        let mut without_facets: Vec<(String, Vec<u32>)> = Vec::new();
        let order: Vec<_> = self.order.iter().collect();
        let of_surfaces = order.iter().filter(|(_, has, _)| matches!(has, Has::Faces | Has::NodesOfSurface));
        let of_nodes = order.iter().filter(|(_, has, _)| *has == Has::Nodes);
        for (body, has, name) in of_surfaces.chain(of_nodes).copied() {
            let outside = self.outside(*body, name);
            // A surface goes before a set of nodes of its name.
            if names.iter().any(|other| other.eq_ignore_ascii_case(&outside)) {
                continue;
            }
            let facets = if *has == Has::Faces {
                self.faces(*body, name, &boundary)?
            } else {
                let list = self.node_numbers(*body, *has, name, 0)?;
                let nodes: HashSet<u32> = list.iter().copied().collect();
                let inside = |facet: &&FacetOf| facet.nodes.iter().all(|node| nodes.contains(node));
                let facets: Vec<FacetOf> = boundary.facets.iter().filter(inside).cloned().collect();
                if facets.is_empty() {
                    without_facets.push((outside.clone(), list));
                }
                facets
            };
            if facets.is_empty() {
                continue;
            }
            let group = names.len() as i64;
            loose.names.insert((dim - 1, group), outside.clone());
            names.push(outside);
            for FacetOf { facet, nodes, line, given } in facets {
                let kind = Kind { name: facet.element.name, dim: dim - 1, nodes: given, element: Some(facet.element) };
                push(loose, kind, BTreeSet::from([group]), line, nodes);
            }
        }
        self.edges(dim, &without_facets, names.len() as i64, loose)
    }

    /// Sets of nodes as edges of cells in space where these have all of the nodes, else as points. Their groups have
    /// numbers from `first`.
    fn edges(
        &self,
        dim: usize,
        sets: &[(String, Vec<u32>)],
        first: i64,
        loose: &mut Loose,
    ) -> Result<(), MeshFileError> {
        let any: HashSet<u32> = sets.iter().flat_map(|(_, nodes)| nodes.iter().copied()).collect();
        let mut edges: BTreeMap<Key, (&'static Element, Vec<u32>)> = BTreeMap::new();
        self.each_facet(if any.is_empty() { 0 } else { dim }, |_, facet| {
            for edge in facet.facet.element.facets.iter().filter(|edge| edge.element.dim() == 1) {
                let nodes: Vec<u32> = edge.nodes.iter().filter_map(|&n| facet.nodes.get(n).copied()).collect();
                if nodes.iter().all(|node| any.contains(node)) {
                    edges.entry(key(nodes.iter().copied())).or_insert((edge.element, nodes));
                }
            }
        })?;
        for (group, (name, list)) in (first..).zip(sets) {
            let nodes: BTreeSet<u32> = list.iter().copied().collect();
            let inside = || edges.values().filter(|(_, edge)| edge.iter().all(|node| nodes.contains(node)));
            let on_edges: BTreeSet<u32> = inside().flat_map(|(_, edge)| edge.iter().copied()).collect();
            let groups = BTreeSet::from([group]);
            let one = |element: &'static Element, given: usize| Kind {
                name: element.name,
                dim: element.dim(),
                nodes: given,
                element: Some(element),
            };
            if on_edges.len() == nodes.len() {
                loose.names.insert((1, group), name.clone());
                for (element, edge) in inside() {
                    push(loose, one(element, edge.len()), groups.clone(), 0, edge.clone());
                }
            } else {
                loose.names.insert((0, group), name.clone());
                push(loose, one(&POINT_LEFT, 1), groups, 0, nodes.into_iter().collect());
            }
        }
        Ok(())
    }

    /// The facets that one cell of the highest dimension has.
    fn boundary(&self, dim: usize) -> Result<Boundary, MeshFileError> {
        let mut count: HashMap<Key, u32> = HashMap::new();
        self.each_facet(dim, |_, facet| *count.entry(facet.key()).or_insert(0) += 1)?;
        let mut boundary = Boundary { of_cell: Vec::new(), facets: Vec::new() };
        self.each_facet(dim, |cell, facet| {
            if count.get(&facet.key()) == Some(&1) {
                boundary.facets.push(facet.clone());
                boundary.of_cell.push((cell, facet));
            }
        })?;
        Ok(boundary)
    }

    /// Looks at all facets of the cells of a dimension.
    fn each_facet(&self, dim: usize, mut look: impl FnMut(CellOf, FacetOf)) -> Result<(), MeshFileError> {
        for (body, cell) in self.cells().filter(|&(body, cell)| self.cell(body, cell).solid.kind.dim == dim) {
            let nodes = self.nodes(body, cell)?;
            let Cell { solid, line, .. } = self.cell(body, cell);
            for facet in solid.kind.element.map_or(&[][..], |element| element.facets) {
                look((body, cell), FacetOf::new(facet, &nodes, *line));
            }
        }
        Ok(())
    }

    /// The facets of a surface: of labelled faces, and of all free faces of elements without a label.
    fn faces(&self, body: Option<usize>, name: &str, boundary: &Boundary) -> Result<Vec<FacetOf>, MeshFileError> {
        let mut facets = Vec::new();
        for set in self.known.get(&(body, Has::Faces, name.to_uppercase())).into_iter().flatten() {
            for item in &set.items {
                let Item::Named { line, name, face: label } = item else { continue };
                let scope = self.scope(body, set.instance.as_deref());
                let cells = self.named_elements(scope, *line, name, 0)?;
                let Some(label) = label else {
                    let cells: HashSet<CellOf> = cells.into_iter().collect();
                    let free = boundary.of_cell.iter().filter(|(cell, _)| cells.contains(cell));
                    facets.extend(free.map(|(_, facet)| facet.clone()));
                    continue;
                };
                for (body, cell) in cells {
                    let nodes = self.nodes(body, cell)?;
                    let element = self.cell(body, cell).solid.kind.element;
                    let number = label.strip_prefix('S').and_then(|number| number.parse().ok());
                    let found = element.zip(number).and_then(|(element, number)| {
                        let vertices = face(element, number)?;
                        facet(element, vertices)
                    });
                    let Some(found) = found else {
                        let what = element.map_or("element", |element| element.name);
                        return Err(unknown(
                            *line,
                            format!("the face {label} of a {what}"),
                            "S1, S2, … up to its number of faces",
                        ));
                    };
                    facets.push(FacetOf::new(found, &nodes, *line));
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

    /// What the entries of a set stand for, in their order.
    fn resolved<T>(
        &self,
        (body, has, name): (Option<usize>, Has, &str),
        resolve: impl Fn(Option<usize>, &Item) -> Result<Vec<T>, MeshFileError>,
    ) -> Result<Vec<T>, MeshFileError> {
        let mut found = Vec::new();
        for set in self.known.get(&(body, has, name.to_uppercase())).into_iter().flatten() {
            let scope = self.scope(body, set.instance.as_deref());
            for item in &set.items {
                found.extend(resolve(scope, item)?);
            }
        }
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
        self.resolved((body, has, name), |scope, item| match item {
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
        self.resolved((body, has, name), |scope, item| match item {
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

/// A facet of a cell of the file, with the nodes that the file has of it.
#[derive(Clone, Debug)]
struct FacetOf {
    facet: &'static Facet,
    nodes: Vec<u32>,
    line: usize,
    /// Number of nodes.
    given: usize,
}

impl FacetOf {
    fn new(facet: &'static Facet, cell: &[u32], line: usize) -> FacetOf {
        let nodes: Vec<u32> = facet.nodes.iter().filter_map(|&node| cell.get(node).copied()).collect();
        FacetOf { facet, given: nodes.len(), nodes, line }
    }

    fn key(&self) -> Key {
        key(self.nodes.iter().copied().take(self.facet.element.shape.vertices()))
    }
}

/// The boundary of the bodies.
struct Boundary {
    of_cell: Vec<(CellOf, FacetOf)>,
    facets: Vec<FacetOf>,
}

/// Adds an element, to the last block if it is alike.
fn push(loose: &mut Loose, kind: Kind, groups: BTreeSet<i64>, line: usize, nodes: Vec<u32>) {
    let same = |block: &&mut LooseBlock| {
        block.groups == groups
            && block.kind.nodes == kind.nodes
            && block.kind.name == kind.name
            && block.kind.dim == kind.dim
    };
    match loose.blocks.last_mut().filter(same) {
        Some(block) => block.nodes.extend(nodes),
        None => loose.blocks.push(LooseBlock { kind, groups, at: line, nodes, numbers: Vec::new() }),
    }
}
