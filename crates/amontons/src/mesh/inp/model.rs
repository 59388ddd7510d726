//! Nodes, elements and sets of an input file: the parts, and the positions of their instances in an assembly.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::Arc;

use super::super::read::{FilePosition, MeshFileError, Skipped};
use super::lines::{Keyword, entries, number};
use super::solid::{self, InpSolid, InpType};
use crate::tensor::Point;

/// Keywords that generate nodes or elements: without them the mesh would be incomplete.
const MAKERS: [&str; 8] = ["NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "SUBMODEL"];

/// Common data of the elements of one keyword.
#[derive(Debug)]
pub(super) struct Sort {
    /// The name of their type.
    pub name: String,
    /// Line of the keyword.
    pub line: usize,
}

/// An element of a body.
#[derive(Clone, Debug)]
pub(super) struct InpCell {
    pub solid: InpSolid,
    pub number: i64,
    /// Its line.
    pub line: usize,
    /// Position of its first node in the node list of its part.
    pub first: usize,
    pub of: Arc<Sort>,
    /// The set named by its keyword.
    pub set: Option<Arc<str>>,
}

/// Nodes and elements with a common numbering.
#[derive(Clone, Debug, Default)]
pub(super) struct InpPart {
    pub tags: Vec<i64>,
    pub points: Vec<Point>,
    pub cells: Vec<InpCell>,
    /// Numbers of the nodes of the cells.
    pub nodes: Vec<i64>,
    pub sets: Vec<InpSet>,
    /// Numbers of the elements left out.
    pub left_out: HashSet<i64>,
}

/// The contents of a set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum SetKind {
    Nodes,
    Elements,
    /// Faces of elements, or nodes that define facets.
    Faces,
    NodesOfSurface,
    /// Elements of one material.
    Section,
}

/// A set as defined by the file, in parts.
#[derive(Clone, Debug)]
pub(super) struct InpSet {
    pub has: SetKind,
    pub name: String,
    pub line: usize,
    /// The instance to which its numbers refer.
    pub instance: Option<String>,
    pub items: Vec<InpSetItem>,
}

/// An entry of a set.
#[derive(Clone, Debug)]
pub(super) enum InpSetItem {
    /// First and last number, and step.
    Range(i64, i64, i64),
    /// A number or the name of a set, and the label of a face, if given.
    Named { line: usize, name: String, face: Option<String> },
    /// The nodes of a set of elements.
    NodesOf { line: usize, name: String },
}

/// A part at its position in the assembly.
#[derive(Clone, Debug)]
pub(super) struct Instance {
    pub name: String,
    pub part: InpPart,
}

/// The mesh data in the keywords of a file.
#[derive(Debug, Default)]
pub(super) struct InpModel {
    /// Items outside of parts.
    pub flat: InpPart,
    parts: BTreeMap<String, InpPart>,
    pub instances: Vec<Instance>,
    pub skipped: Vec<Skipped>,
    part: Option<String>,
    instance: Option<Instance>,
}

impl InpModel {
    /// Reads the keywords in order.
    pub fn of(keywords: &[Keyword]) -> Result<InpModel, MeshFileError> {
        let mut model = InpModel::default();
        for keyword in keywords {
            model.take(keyword)?;
        }
        Ok(model)
    }

    /// The part to which nodes, elements and sets are currently added.
    fn current(&mut self) -> &mut InpPart {
        if let Some(instance) = &mut self.instance {
            return &mut instance.part;
        }
        match &self.part {
            Some(name) => self.parts.entry(name.clone()).or_default(),
            None => &mut self.flat,
        }
    }

    fn take(&mut self, keyword: &Keyword) -> Result<(), MeshFileError> {
        match keyword.name.as_str() {
            "PART" => {
                let name = keyword.required("NAME")?.to_uppercase();
                self.parts.entry(name.clone()).or_default();
                self.part = Some(name);
            }
            "END PART" => self.part = None,
            "INSTANCE" => self.begin(keyword)?,
            "END INSTANCE" => self.instances.extend(self.instance.take()),
            "ASSEMBLY" | "END ASSEMBLY" | "HEADING" => {}
            "NODE" => {
                nodes(keyword, self.current())?;
                if let Some(name) = keyword.parameter("NSET") {
                    let numbers = keyword.data.iter().filter_map(|&(line, text)| Some((line, entries(text).next()?)));
                    let items = numbers
                        .map(|(line, name)| InpSetItem::Named { line, name: name.to_owned(), face: None })
                        .collect();
                    self.current().sets.push(InpSet {
                        has: SetKind::Nodes,
                        name: name.to_owned(),
                        line: keyword.line,
                        instance: None,
                        items,
                    });
                }
            }
            "ELEMENT" => self.elements(keyword)?,
            "NSET" => {
                let items = match keyword.parameter("ELSET") {
                    Some(name) => vec![InpSetItem::NodesOf { line: keyword.line, name: name.to_owned() }],
                    None => members(keyword)?,
                };
                self.set(keyword, SetKind::Nodes, "NSET", items)?;
            }
            "ELSET" => self.set(keyword, SetKind::Elements, "ELSET", members(keyword)?)?,
            "SURFACE" => self.surface(keyword)?,
            "SOLID SECTION" => {
                let name = keyword.required("ELSET")?.to_owned();
                let items = vec![InpSetItem::Named { line: keyword.line, name: name.clone(), face: None }];
                self.current().sets.push(InpSet {
                    has: SetKind::Section,
                    name,
                    line: keyword.line,
                    instance: None,
                    items,
                });
            }
            name if MAKERS.contains(&name) => {
                return Err(MeshFileError::Syntax {
                    at: FilePosition::Line(keyword.line),
                    found: format!("*{name}"),
                    expected: "nodes and elements written out in one file; try to let the preprocessor, or CalculiX's cgx, write them".to_owned(),
                });
            }
            name => self.skip(format!("*{name}"), keyword.line, 1),
        }
        Ok(())
    }

    /// Records a skipped item; repeated items are counted.
    fn skip(&mut self, what: String, line: usize, count: usize) {
        match self.skipped.iter_mut().find(|skipped| skipped.what == what) {
            Some(skipped) => skipped.count += count,
            None => self.skipped.push(Skipped { what, file: None, line: Some(line), count }),
        }
    }

    /// Begins an instance of a part, moved as given by the first data line and turned as given by the second one.
    fn begin(&mut self, keyword: &Keyword) -> Result<(), MeshFileError> {
        let (name, part) = (keyword.required("NAME")?.to_owned(), keyword.required("PART")?);
        let Some(known) = self.parts.get(&part.to_uppercase()) else {
            return Err(MeshFileError::Syntax {
                at: FilePosition::Line(keyword.line),
                found: format!("an instance of the part {part:?}"),
                expected: "a part that the file has defined before".to_owned(),
            });
        };
        let mut part = known.clone();
        let mut numbers = Vec::new();
        for &(line, text) in &keyword.data {
            let values: Vec<f64> =
                entries(text).map(|entry| number(line, entry, "a number")).collect::<Result<_, _>>()?;
            numbers.push((line, values));
        }
        let wrong = |line: usize, found: usize, expected: &str| MeshFileError::Syntax {
            at: FilePosition::Line(line),
            found: format!("{found} numbers"),
            expected: expected.to_owned(),
        };
        if let Some((line, values)) = numbers.first() {
            let shift: Point = match values[..] {
                [x, y, z] => [x, y, z],
                [x, y] => [x, y, 0.0],
                _ => return Err(wrong(*line, values.len(), "the three components of a translation")),
            };
            part.points.iter_mut().for_each(|point| *point = std::array::from_fn(|d| point[d] + shift[d]));
        }
        if let Some((line, values)) = numbers.get(1) {
            let [ax, ay, az, bx, by, bz, angle] = values[..] else {
                return Err(wrong(*line, values.len(), "two points of an axis and an angle in degrees, seven numbers"));
            };
            let turn = InpRotation::new([ax, ay, az], [bx, by, bz], angle)
                .ok_or_else(|| wrong(*line, values.len(), "two different points of the axis of a rotation"))?;
            part.points.iter_mut().for_each(|point| *point = turn.apply(point));
        }
        self.instance = Some(Instance { name, part });
        Ok(())
    }

    fn elements(&mut self, keyword: &Keyword) -> Result<(), MeshFileError> {
        let name = keyword.required("TYPE")?.to_uppercase();
        let solid = match solid::of(&name) {
            InpType::Solid(solid) => solid,
            InpType::Missing => {
                return Err(MeshFileError::Element {
                    at: FilePosition::Line(keyword.line),
                    found: name,
                    known:
                        "bodies of 2 or 3 nodes on a line, 3, 4, 6 or 8 in the plane, 4, 5, 6, 8, 10, 15 or 20 in space"
                            .to_owned(),
                });
            }
            InpType::Other => {
                self.leave_out(keyword, &name);
                return Ok(());
            }
        };
        let set: Option<Arc<str>> = keyword.parameter("ELSET").map(Arc::from);
        let of = Arc::new(Sort { name: name.clone(), line: keyword.line });
        let mut items = Vec::new();
        let part = self.current();
        let mut numbers = keyword.entries();
        while let Some((line, text)) = numbers.next() {
            let element = number(line, text, "the number of an element")?;
            let first = part.nodes.len();
            for found in 0..solid.kind.nodes {
                let Some((line, text)) = numbers.next() else {
                    return Err(MeshFileError::Syntax {
                        at: FilePosition::Line(line),
                        found: format!("element {element} with {found} nodes"),
                        expected: format!("the {} nodes of the type {name}", solid.kind.nodes),
                    });
                };
                part.nodes.push(number(line, text, "the number of a node")?);
            }
            items.push(InpSetItem::Range(element, element, 1));
            part.cells.push(InpCell { solid, number: element, line, first, of: Arc::clone(&of), set: set.clone() });
        }
        if let Some(name) = set {
            part.sets.push(InpSet {
                has: SetKind::Elements,
                name: name.to_string(),
                line: keyword.line,
                instance: None,
                items,
            });
        }
        Ok(())
    }

    /// Leaves out elements of a type but keeps their numbers and sets.
    fn leave_out(&mut self, keyword: &Keyword, name: &str) {
        let mut continues = false;
        let mut items = Vec::new();
        for &(_, text) in &keyword.data {
            if let Some(Ok(number)) = entries(text).next().map(str::parse).filter(|_| !continues) {
                items.push(InpSetItem::Range(number, number, 1));
            }
            continues = text.ends_with(',');
        }
        let part = self.current();
        part.left_out.extend(items.iter().filter_map(|item| match item {
            InpSetItem::Range(number, ..) => Some(*number),
            _ => None,
        }));
        let count = items.len();
        if let Some(set) = keyword.parameter("ELSET") {
            part.sets.push(InpSet {
                has: SetKind::Elements,
                name: set.to_owned(),
                line: keyword.line,
                instance: None,
                items,
            });
        }
        self.skip(format!("elements of type {name}"), keyword.line, count);
    }

    fn set(&mut self, keyword: &Keyword, has: SetKind, key: &str, items: Vec<InpSetItem>) -> Result<(), MeshFileError> {
        let name = keyword.required(key)?.to_owned();
        let instance = keyword.parameter("INSTANCE").map(str::to_owned);
        self.current().sets.push(InpSet { has, name, line: keyword.line, instance, items });
        Ok(())
    }

    fn surface(&mut self, keyword: &Keyword) -> Result<(), MeshFileError> {
        let name = keyword.required("NAME")?.to_owned();
        if let Some(combine) = keyword.parameter("COMBINE") {
            self.skip(format!("*SURFACE, COMBINE={}", combine.to_uppercase()), keyword.line, 1);
            return Ok(());
        }
        let has = match keyword.parameter("TYPE").map(str::to_uppercase).as_deref() {
            None | Some("ELEMENT") => SetKind::Faces,
            Some("NODE") => SetKind::NodesOfSurface,
            Some(other) => {
                self.skip(format!("*SURFACE, TYPE={other}"), keyword.line, 1);
                return Ok(());
            }
        };
        let item = |&(line, text): &(usize, &str)| {
            let mut entries = entries(text);
            let name = entries.next()?.to_owned();
            Some(InpSetItem::Named { line, name, face: entries.next().map(str::to_uppercase) })
        };
        let items = keyword.data.iter().filter_map(item).collect();
        self.current().sets.push(InpSet { has, name, line: keyword.line, instance: None, items });
        Ok(())
    }
}

/// The members of a set: numbers, set names, or ranges.
fn members(keyword: &Keyword) -> Result<Vec<InpSetItem>, MeshFileError> {
    if !keyword.has("GENERATE") {
        let named = |(line, name): (usize, &str)| InpSetItem::Named { line, name: name.to_owned(), face: None };
        return Ok(keyword.entries().map(named).collect());
    }
    let range = |&(line, text): &(usize, &str)| {
        let numbers: Vec<i64> =
            entries(text).map(|entry| number(line, entry, "an integer")).collect::<Result<_, _>>()?;
        match numbers[..] {
            [first, last] if first <= last => Ok(InpSetItem::Range(first, last, 1)),
            [first, last, step] if first <= last && step > 0 => Ok(InpSetItem::Range(first, last, step)),
            _ => Err(MeshFileError::Syntax {
                at: FilePosition::Line(line),
                found: format!("{text:?}"),
                expected: "a first number, a last one that is not smaller, and a positive step".to_owned(),
            }),
        }
    };
    keyword.data.iter().map(range).collect()
}

/// Reads nodes: number and up to three coordinates.
fn nodes(keyword: &Keyword, part: &mut InpPart) -> Result<(), MeshFileError> {
    for &(line, text) in &keyword.data {
        let mut entries = text.split(',').map(str::trim);
        let tag: i64 = number(line, entries.next().unwrap_or_default(), "the number of a node")?;
        let mut point = [0.0_f64; 3];
        for (coordinate, entry) in point.iter_mut().zip(entries).filter(|(_, entry)| !entry.is_empty()) {
            *coordinate = number::<f64>(line, entry, "a coordinate")?;
            if !coordinate.is_finite() {
                let (at, found) = (FilePosition::Line(line), *coordinate);
                return Err(MeshFileError::Coordinate { at, tag: tag.unsigned_abs(), found });
            }
        }
        part.tags.push(tag);
        part.points.push(point);
    }
    Ok(())
}

/// Index of each node of a part by its number.
pub(super) fn index<'a>(tags: impl Iterator<Item = &'a i64>) -> Result<HashMap<i64, u32>, MeshFileError> {
    let mut index = HashMap::new();
    for (place, &tag) in tags.enumerate() {
        if index.insert(tag, place as u32).is_some() {
            return Err(MeshFileError::RepeatedNode { tag: tag.unsigned_abs() });
        }
    }
    Ok(index)
}

/// A rotation about an axis (Rodrigues' formula).
struct InpRotation {
    at: Point,
    axis: Point,
    cos: f64,
    sin: f64,
}

impl InpRotation {
    /// The rotation about the axis from `a` to `b` by an angle in degrees; `None` if the axis or angle is undefined.
    fn new(a: Point, b: Point, degrees: f64) -> Option<InpRotation> {
        let d: Point = std::array::from_fn(|i| b[i] - a[i]);
        let length = crate::tensor::length(&d);
        let axis = d.map(|x| x / length);
        let (sin, cos) = degrees.to_radians().sin_cos();
        (length > 0.0 && length.is_finite() && cos.is_finite()).then_some(InpRotation { at: a, axis, cos, sin })
    }

    fn apply(&self, x: &Point) -> Point {
        let v: Point = std::array::from_fn(|i| x[i] - self.at[i]);
        let along = crate::tensor::dot(&self.axis, &v) * (1.0 - self.cos);
        let cross = |i: usize| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            self.axis[j] * v[k] - self.axis[k] * v[j]
        };
        std::array::from_fn(|i| self.at[i] + self.cos * v[i] + self.sin * cross(i) + along * self.axis[i])
    }
}
