//! Sets of an input file, resolved to elements, nodes and facets, and the sides they define.

use std::cell::RefCell;
use std::collections::{BTreeSet, HashMap, HashSet};
use std::hash::Hash;
use std::sync::Arc;

use super::super::read::{FacetOf, FilePosition, Loose, MeshFileError, NodeSet, PlaneState, Skipped};
use super::model::{InpCell, InpModel, InpPart, InpSet, InpSetItem, SetKind, Sort, index};
use super::thin::BoundaryFacets;
use super::told::{Left, Told};

/// Largest depth of nested sets.
const DEEPEST: usize = 32;

/// A body of the assembly: the items outside of parts, or an instance.
struct InpBody {
    name: Option<String>,
    part: InpPart,
    /// Global number of its first node.
    first_node: u32,
    nodes: HashMap<i64, u32>,
    cells: HashMap<i64, usize>,
}

/// Sets of a body, or of the assembly, by kind and name in capitals.
type InpSetKey = (Option<usize>, SetKind, String);

/// Cache of resolved sets, so that a set used many times is resolved once.
type Resolved<T> = RefCell<HashMap<InpSetKey, Arc<[T]>>>;

/// All sets, with the data needed to resolve them.
pub(super) struct Sets {
    bodies: Vec<InpBody>,
    known: HashMap<InpSetKey, Vec<InpSet>>,
    elements: Resolved<CellOf>,
    numbers: Resolved<u32>,
    /// Sets in the order of the file: body, kind and name as written.
    pub(super) order: Vec<(Option<usize>, SetKind, String)>,
    /// Dimension of the cells of the body.
    pub(super) dim: usize,
    pub(super) told: Told,
    /// Elements used as facets of a side.
    on_sides: RefCell<HashSet<CellOf>>,
}

/// A cell of a body.
pub(super) type CellOf = (usize, usize);

/// Elements that fill a body, for messages.
const FILL: &str = "elements that fill a body, C3D… in space, CPS…, CPE… or CAX… in the plane; shells, membranes and beams are not computed: mesh the volume";

/// The error for an unknown item named by a line.
fn unknown(line: usize, found: String, expected: &str) -> MeshFileError {
    MeshFileError::Syntax { at: FilePosition::Line(line), found, expected: expected.to_owned() }
}

impl Sets {
    /// The contents described by the file, in addition to those skipped before.
    pub(super) fn loose(&self, mut skipped: Vec<Skipped>) -> Result<Loose, MeshFileError> {
        let points = self.bodies.iter().flat_map(|body| body.part.points.iter().copied()).collect();
        let mut loose = Loose { points, ..Loose::default() };
        if self.dim == 0 {
            skipped.extend(self.left_out());
            let of = |skipped: &Skipped| {
                let name = skipped.what.strip_prefix("elements of type ")?;
                Some(format!("{} element{} of type {name}", skipped.count, if skipped.count == 1 { "" } else { "s" }))
            };
            let found: Vec<String> = skipped.iter().filter_map(of).collect();
            let found = found.join(", ");
            return if found.is_empty() { Ok(loose) } else { Err(MeshFileError::NoBody { found, expected: FILL }) };
        }
        self.regions(&mut loose)?;
        self.sides(&mut loose)?;
        skipped.extend(self.left_out());
        skipped.extend(self.told.skipped());
        loose.skipped = skipped;
        Ok(loose)
    }

    /// The elements that are neither cells of the body nor facets of a side, by type.
    fn left_out(&self) -> Vec<Skipped> {
        let on_sides = self.on_sides.borrow();
        let mut skipped: Vec<Skipped> = Vec::new();
        let mut places: HashMap<&str, usize> = HashMap::new();
        for (body, cell) in self.cells().filter(|cell| !self.is_of_body(*cell) && !on_sides.contains(cell)) {
            let Sort { name, line } = &*self.cell(body, cell).of;
            let place = *places.entry(name).or_insert_with(|| {
                let what = format!("elements of type {name}");
                skipped.push(Skipped { what, file: None, line: Some(*line), count: 0 });
                skipped.len() - 1
            });
            skipped[place].count += 1;
        }
        skipped
    }

    pub(super) fn of(model: InpModel) -> Result<Sets, MeshFileError> {
        let mut sets = Sets {
            bodies: Vec::new(),
            known: HashMap::new(),
            elements: Resolved::default(),
            numbers: Resolved::default(),
            order: Vec::new(),
            dim: 0,
            told: Told::default(),
            on_sides: RefCell::default(),
        };
        let mut first_node = 0;
        let mut flat = model.flat;
        // Sets outside of parts may refer to any instance.
        let of_assembly = if model.instances.is_empty() { Vec::new() } else { std::mem::take(&mut flat.sets) };
        let parts = model.instances.into_iter().map(|instance| (Some(instance.name), instance.part));
        for (name, mut part) in std::iter::once((None, flat)).chain(parts) {
            let own = std::mem::take(&mut part.sets);
            let nodes = index(part.tags.iter())?;
            let cells = part.cells.iter().enumerate().map(|(place, cell)| (cell.number, place)).collect();
            let more = part.points.len() as u32;
            sets.bodies.push(InpBody { name, part, first_node, nodes, cells });
            first_node += more;
            let body = sets.bodies.len() - 1;
            for set in own {
                sets.add(Some(body), set);
            }
        }
        for set in of_assembly {
            sets.add(None, set);
        }
        let solids = sets.cells().map(|(body, cell)| sets.cell(body, cell).solid).filter(|solid| solid.fills);
        sets.dim = solids.map(|solid| solid.kind.dim).max().unwrap_or(0);
        Ok(sets)
    }

    fn add(&mut self, body: Option<usize>, set: InpSet) {
        let key = (body, set.has, set.name.to_uppercase());
        let parts = self.known.entry(key).or_default();
        // Sections are kept in their order.
        if parts.is_empty() || set.has == SetKind::Section {
            self.order.push((body, set.has, set.name.clone()));
        }
        parts.push(set);
    }

    /// All cells in order.
    fn cells(&self) -> impl Iterator<Item = CellOf> {
        self.bodies.iter().enumerate().flat_map(|(b, body)| (0..body.part.cells.len()).map(move |cell| (b, cell)))
    }

    /// The cells of the mesh in order.
    pub(super) fn body_cells(&self) -> impl Iterator<Item = CellOf> {
        self.cells().filter(|cell| self.is_of_body(*cell))
    }

    /// True if an element is a cell of the mesh.
    pub(super) fn is_of_body(&self, (body, cell): CellOf) -> bool {
        let solid = &self.cell(body, cell).solid;
        solid.fills && solid.kind.dim == self.dim
    }

    pub(super) fn cell(&self, body: usize, cell: usize) -> &InpCell {
        &self.bodies[body].part.cells[cell]
    }

    /// Global node numbers of a cell.
    pub(super) fn nodes(&self, body: usize, cell: usize) -> Result<Vec<u32>, MeshFileError> {
        let InpBody { part, nodes, first_node, .. } = &self.bodies[body];
        let InpCell { first, solid, line, .. } = &part.cells[cell];
        part.nodes[*first..first + solid.kind.nodes]
            .iter()
            .map(|&tag| {
                let at = FilePosition::Line(*line);
                let node = nodes.get(&tag).ok_or(MeshFileError::UnknownNode { at, tag, nodes: part.tags.len() })?;
                Ok(first_node + node)
            })
            .collect()
    }

    pub(super) fn is_of_revolution(&self) -> Result<bool, MeshFileError> {
        let mut plane =
            self.body_cells().map(|(body, cell)| self.cell(body, cell)).filter(|cell| cell.solid.kind.dim == 2);
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

    /// Plane stress or strain, if all elements agree on it.
    pub(super) fn plane(&self) -> Option<PlaneState> {
        let mut of_cells = self.body_cells().map(|(body, cell)| self.cell(body, cell).solid.plane);
        let first = of_cells.next().flatten();
        first.filter(|_| of_cells.all(|other| other == first))
    }

    /// The public name of a set of a body.
    pub(super) fn outside(&self, body: Option<usize>, name: &str) -> String {
        let instances = self.bodies.iter().filter(|body| body.name.is_some()).count();
        match body.and_then(|body| self.bodies[body].name.as_ref()) {
            Some(instance) if instances > 1 => format!("{instance}.{name}"),
            _ => name.to_owned(),
        }
    }

    /// The name of a set in its first spelling.
    pub(super) fn spelling(&self, body: Option<usize>, has: SetKind, name: &str) -> String {
        let first = self.known.get(&(body, has, name.to_uppercase())).and_then(|sets| sets.first());
        first.map_or_else(|| name.to_owned(), |set| set.name.clone())
    }

    /// The line in which a set is first defined.
    pub(super) fn line(&self, body: Option<usize>, has: SetKind, name: &str) -> usize {
        self.lines(body, has, name).next().unwrap_or(0)
    }

    /// The lines in which parts of a set are defined.
    pub(super) fn lines(&self, body: Option<usize>, has: SetKind, name: &str) -> impl Iterator<Item = usize> {
        self.known.get(&(body, has, name.to_uppercase())).into_iter().flatten().map(|set| set.line)
    }

    /// Adds the sides: surfaces, sets of elements on the boundary, and node sets.
    fn sides(&self, loose: &mut Loose) -> Result<(), MeshFileError> {
        let has_thin = self.cells().any(|cell| !self.is_of_body(cell));
        let skin = has_thin.then(|| BoundaryFacets::of(loose));
        let mut of_body = vec![false; loose.points.len()];
        loose.blocks.iter().flat_map(|block| &block.nodes).for_each(|&node| of_body[node as usize] = true);
        // For equal names the surface counts, then the element set, then the node set.
        let mut order: Vec<&(Option<usize>, SetKind, String)> = self.order.iter().collect();
        order.sort_by_key(|(_, has, _)| match has {
            SetKind::Faces | SetKind::NodesOfSurface | SetKind::Section => 0,
            SetKind::Elements => 1,
            SetKind::Nodes => 2,
        });
        let mut names: HashSet<String> = HashSet::new();
        for (body, has, name) in order {
            let (outside, line) = (self.outside(*body, name), self.line(*body, *has, name));
            let is_named = names.contains(&outside.to_uppercase());
            match has {
                SetKind::Section => continue,
                SetKind::Faces | SetKind::Elements => {
                    let facets = match has {
                        SetKind::Faces => self.faces(*body, name, loose, skin.as_ref())?,
                        _ => self.thin(*body, name, skin.as_ref())?,
                    };
                    if facets.is_empty() {
                        self.nothing_of(*body, *has, (name, &outside), line)?;
                        continue;
                    }
                    if is_named {
                        continue;
                    }
                    loose.side(outside.clone(), &facets);
                }
                SetKind::Nodes | SetKind::NodesOfSurface => {
                    let all = self.node_numbers(*body, *has, name, 0)?;
                    let nodes: BTreeSet<u32> = all.into_iter().filter(|node| of_body[*node as usize]).collect();
                    if nodes.is_empty() {
                        self.told.note(
                            if *has == SetKind::Nodes { Left::NodeSets } else { Left::Surfaces },
                            line,
                            &outside,
                            1,
                        );
                        continue;
                    }
                    if is_named {
                        continue;
                    }
                    loose.node_sets.push(NodeSet { name: outside.clone(), nodes });
                }
            }
            names.insert(outside.to_uppercase());
        }
        Ok(())
    }

    /// Records a surface or element set that defines no side, unless it is one of cells.
    fn nothing_of(
        &self,
        body: Option<usize>,
        has: SetKind,
        (name, outside): (&str, &str),
        line: usize,
    ) -> Result<(), MeshFileError> {
        if has == SetKind::Faces {
            self.told.note(Left::Surfaces, line, outside, 1);
        } else if !self.elements(body, has, name, 0)?.into_iter().any(|cell| self.is_of_body(cell)) {
            self.told.note(Left::ElementSets, line, outside, 1);
        }
        Ok(())
    }

    /// The boundary facets that the elements of a set represent; empty if one of them is a cell of the body.
    fn thin(
        &self,
        body: Option<usize>,
        name: &str,
        skin: Option<&BoundaryFacets>,
    ) -> Result<Vec<FacetOf>, MeshFileError> {
        let Some(skin) = skin else { return Ok(Vec::new()) };
        let cells = self.elements(body, SetKind::Elements, name, 0)?;
        if cells.iter().any(|cell| self.is_of_body(*cell)) {
            return Ok(Vec::new());
        }
        Ok(cells.into_iter().filter_map(|cell| self.facet_of(cell, skin)).collect())
    }

    /// The boundary facet that an element represents; records the element as part of a side.
    fn facet_of(&self, (body, cell): CellOf, skin: &BoundaryFacets) -> Option<FacetOf> {
        let kind = self.cell(body, cell).solid.kind;
        let nodes = self.nodes(body, cell).ok().filter(|_| kind.dim + 1 == self.dim)?;
        let facet = skin.facet(&kind, &nodes)?.clone();
        self.on_sides.borrow_mut().insert((body, cell));
        Some(facet)
    }

    /// The facets of a surface: labelled faces, all free faces of elements without a label, and elements that lie on
    /// the boundary.
    fn faces(
        &self,
        body: Option<usize>,
        name: &str,
        loose: &Loose,
        skin: Option<&BoundaryFacets>,
    ) -> Result<Vec<FacetOf>, MeshFileError> {
        let (mut facets, mut free) = (Vec::new(), None);
        for set in self.known.get(&(body, SetKind::Faces, name.to_uppercase())).into_iter().flatten() {
            for item in &set.items {
                let InpSetItem::Named { line, name, face: label } = item else { continue };
                let scope = self.scope(body, set.instance.as_deref());
                let cells = self.named_elements(scope, *line, name, 0)?;
                let (cells, others): (Vec<_>, Vec<_>) = cells.into_iter().partition(|cell| self.is_of_body(*cell));
                // The label of a shell edge begins with E.
                if let Some(skin) = skin.filter(|_| label.as_ref().is_none_or(|label| !label.starts_with('E'))) {
                    facets.extend(others.into_iter().filter_map(|cell| self.facet_of(cell, skin)));
                }
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
                    facets.push(self.labelled((body, cell), label, *line)?);
                }
            }
        }
        Ok(facets)
    }

    /// The face of a cell with a label.
    fn labelled(&self, (body, cell): CellOf, label: &str, line: usize) -> Result<FacetOf, MeshFileError> {
        let nodes = self.nodes(body, cell)?;
        let element = self.cell(body, cell).solid.kind.element;
        // The facets of an element have the order of the faces S1, S2, … of Abaqus.
        let number: Option<usize> = label.strip_prefix('S').and_then(|number| number.parse().ok());
        let place = number.and_then(|number| number.checked_sub(1));
        let found = element.zip(place).and_then(|(element, place)| element.facets.get(place));
        let found = found.ok_or_else(|| {
            let what = element.map_or("element", |element| element.name);
            unknown(line, format!("the face {label} of a {what}"), "S1, S2, … up to its number of faces")
        })?;
        Ok(FacetOf::new(found, &nodes))
    }

    /// The body to which numbers in a set refer: that of its instance, or else its own.
    fn scope(&self, body: Option<usize>, instance: Option<&str>) -> Option<usize> {
        let of = |name: &str| {
            self.bodies.iter().position(|body| body.name.as_ref().is_some_and(|own| own.eq_ignore_ascii_case(name)))
        };
        instance.and_then(of).or(body)
    }

    /// The body of nodes in the assembly outside of instances, such as reference points, if there are any.
    fn assembly(&self) -> Option<usize> {
        self.bodies.first().filter(|body| body.name.is_none() && !body.part.points.is_empty()).map(|_| 0)
    }

    /// Body and name for `instance.name`, or for a name within a scope.
    fn split<'n>(&self, scope: Option<usize>, name: &'n str) -> (Option<usize>, &'n str) {
        match name.split_once('.').map(|(instance, rest)| (self.scope(None, Some(instance)), rest)) {
            Some((Some(body), rest)) => (Some(body), rest),
            _ => (scope, name),
        }
    }

    /// The items that the entries of a set stand for, in their order and without repetition.
    fn resolved<T: Copy + Eq + Hash>(
        &self,
        (body, has, name): (Option<usize>, SetKind, &str),
        resolved: &Resolved<T>,
        resolve: impl Fn(Option<usize>, &InpSetItem) -> Result<Vec<T>, MeshFileError>,
    ) -> Result<Vec<T>, MeshFileError> {
        let key = (body, has, name.to_uppercase());
        if let Some(members) = resolved.borrow().get(&key) {
            return Ok(members.to_vec());
        }
        let (mut found, mut seen) = (Vec::new(), HashSet::new());
        for set in self.known.get(&key).into_iter().flatten() {
            let scope = self.scope(body, set.instance.as_deref());
            let scope = scope.or_else(|| self.assembly().filter(|_| set.instance.is_none()));
            for item in &set.items {
                found.extend(resolve(scope, item)?.into_iter().filter(|member| seen.insert(*member)));
            }
        }
        resolved.borrow_mut().insert(key, found.clone().into());
        Ok(found)
    }

    /// The scope in which a set named by an entry is defined, at nesting depth `depth`.
    fn home(
        &self,
        (scope, line, depth): (Option<usize>, usize, usize),
        has: SetKind,
        name: &str,
    ) -> Result<Option<usize>, MeshFileError> {
        let known = |body: &Option<usize>| self.known.contains_key(&(*body, has, name.to_uppercase()));
        let home = if depth < DEEPEST { [scope, None].into_iter().find(known) } else { None };
        home.ok_or_else(|| {
            let kind = if has == SetKind::Nodes { "node" } else { "element" };
            unknown(line, format!("the {kind} set {name:?}"), "a set that the file defines")
        })
    }

    /// Elements of a set.
    pub(super) fn elements(
        &self,
        body: Option<usize>,
        has: SetKind,
        name: &str,
        depth: usize,
    ) -> Result<Vec<CellOf>, MeshFileError> {
        self.resolved((body, has, name), &self.elements, |scope, item| match item {
            InpSetItem::Range(first, last, step) => {
                let Some(body) = scope else { return Ok(Vec::new()) };
                let mut cells: Vec<CellOf> =
                    within(&self.bodies[body].cells, *first, *last, *step).map(|cell| (body, *cell)).collect();
                cells.sort_unstable();
                Ok(cells)
            }
            InpSetItem::Named { line, name, .. } => self.named_elements(scope, *line, name, depth),
            InpSetItem::NodesOf { .. } => Ok(Vec::new()),
        })
    }

    /// Elements named by an entry: by number, or by set.
    fn named_elements(
        &self,
        scope: Option<usize>,
        line: usize,
        name: &str,
        depth: usize,
    ) -> Result<Vec<CellOf>, MeshFileError> {
        let (scope, name) = self.split(scope, name);
        if let (Ok(number), Some(body)) = (name.parse::<i64>(), scope) {
            let found = self.bodies[body].cells.get(&number).map(|&cell| (body, cell));
            if found.is_none() && !self.bodies[body].part.left_out.contains(&number) {
                self.told.note(Left::Elements, line, name, 1);
            }
            return Ok(found.into_iter().collect());
        }
        let body = self.home((scope, line, depth), SetKind::Elements, name)?;
        self.elements(body, SetKind::Elements, name, depth + 1)
    }

    /// Nodes of a set, by global number.
    fn node_numbers(
        &self,
        body: Option<usize>,
        has: SetKind,
        name: &str,
        depth: usize,
    ) -> Result<Vec<u32>, MeshFileError> {
        self.resolved((body, has, name), &self.numbers, |scope, item| match item {
            InpSetItem::Range(first, last, step) => {
                let Some(InpBody { nodes, first_node, .. }) = scope.map(|body| &self.bodies[body]) else {
                    return Ok(Vec::new());
                };
                Ok(within(nodes, *first, *last, *step).map(|node| first_node + node).collect())
            }
            InpSetItem::Named { line, name, .. } => self.named_nodes(scope, *line, name, depth),
            InpSetItem::NodesOf { line, name } => {
                let cells = self.named_elements(scope, *line, name, depth)?;
                let nodes = cells.into_iter().map(|(body, cell)| self.nodes(body, cell));
                Ok(nodes.collect::<Result<Vec<_>, _>>()?.concat())
            }
        })
    }

    /// Nodes named by an entry: by number, or by set.
    fn named_nodes(
        &self,
        scope: Option<usize>,
        line: usize,
        name: &str,
        depth: usize,
    ) -> Result<Vec<u32>, MeshFileError> {
        let (scope, name) = self.split(scope, name);
        if let (Ok(tag), Some(body)) = (name.parse::<i64>(), scope) {
            let InpBody { nodes, first_node, .. } = &self.bodies[body];
            let found = nodes.get(&tag).map(|node| first_node + node);
            if found.is_none() {
                self.told.note(Left::Nodes, line, name, 1);
            }
            return Ok(found.into_iter().collect());
        }
        let body = self.home((scope, line, depth), SetKind::Nodes, name)?;
        self.node_numbers(body, SetKind::Nodes, name, depth + 1)
    }
}

/// The values of those numbers of a range that exist; iterates over the smaller of both.
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
