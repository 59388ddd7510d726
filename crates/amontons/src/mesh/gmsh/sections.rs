//! The sections of an MSH file.

use std::collections::{BTreeMap, BTreeSet};

use super::super::read::{Kind, Loose, LooseBlock, MeshFileError};
use super::cursor::{Cursor, NumberEncoding};
use super::entities::Entities;
use crate::tensor::Point;

/// Contents of a file read so far.
#[derive(Default)]
struct GmshFile {
    version: Option<Version>,
    names: BTreeMap<(usize, i64), String>,
    entities: Option<Entities>,
    nodes: Option<(NodeTags, Vec<Point>)>,
    blocks: Option<EntityBlocks>,
    data: Option<DataSection>,
}

/// Elements, and the entity tag of each block, 0 for none.
type EntityBlocks = (Vec<LooseBlock>, Vec<i64>);

#[derive(Clone, Copy, PartialEq)]
enum Version {
    Two,
    Four,
}

/// Reads all sections except data; also returns the entity of each block, and true if the file is binary.
pub(super) fn parse(bytes: &[u8]) -> Result<(Loose, Vec<i64>, bool), MeshFileError> {
    let (mut file, binary) = read(bytes, None)?;
    let (points, _, (blocks, entities)) = file.parts(bytes)?;
    Ok((Loose { points, blocks, names: file.names, ..Loose::default() }, entities, binary))
}

/// Nodes with their tags, elements, and the data with this name, if any.
pub(super) fn with_data(
    bytes: &[u8],
    name: &str,
) -> Result<(Vec<Point>, NodeTags, Vec<LooseBlock>, Option<DataSection>), MeshFileError> {
    let (mut file, _) = read(bytes, Some(name))?;
    let data = file.data.take();
    let (points, tags, (blocks, _)) = file.parts(bytes)?;
    Ok((points, tags, blocks, data))
}

fn read(bytes: &[u8], wanted: Option<&str>) -> Result<(GmshFile, bool), MeshFileError> {
    let mut cursor = Cursor::new(bytes);
    let mut file = GmshFile::default();
    loop {
        let (at, name) = cursor.word();
        match (name, file.version) {
            (b"", _) => break,
            (b"$MeshFormat", None) => file.version = Some(format(&mut cursor)?),
            (b"$NOD", None) => return Err(MeshFileError::Version { at: cursor.place(at), found: "1".to_owned() }),
            (b"$PhysicalNames", Some(_)) => file.names = physical_names(&mut cursor)?,
            (b"$Entities", Some(Version::Four)) => {
                cursor.line();
                file.entities.get_or_insert_default().groups.extend(entities(&mut cursor)?);
            }
            (b"$PartitionedEntities", Some(Version::Four)) => {
                file.entities.get_or_insert_default().partitioned(&mut cursor)?;
            }
            (b"$Nodes", Some(version)) if file.nodes.is_none() => file.nodes = Some(nodes(&mut cursor, version)?),
            (b"$Elements", Some(version)) if file.blocks.is_none() => {
                let Some((tags, _)) = &file.nodes else { return Err(cursor.fault(at, "$Nodes before $Elements")) };
                file.blocks = Some(match version {
                    Version::Two => elements_of_two(&mut cursor, tags)?,
                    Version::Four => elements_of_four(&mut cursor, tags, file.entities.as_ref())?,
                });
            }
            (b"$ElementData" | b"$NodeData", Some(_)) if wanted.is_some() && file.data.is_none() => {
                file.data = data_section(&mut cursor, name, wanted.unwrap_or_default())?;
            }
            _ if name.starts_with(b"$") && file.version.is_some() || name == b"$Comments" => {
                cursor.skip_section(name)?;
            }
            _ => {
                let expected = if file.version.is_none() {
                    "$MeshFormat, with which a Gmsh file begins"
                } else {
                    "a section, $Nodes or another"
                };
                return Err(cursor.fault(at, expected));
            }
        }
    }
    Ok((file, cursor.mode != NumberEncoding::Ascii))
}

impl GmshFile {
    /// Nodes with their tags, and elements; every file must have them.
    fn parts(&mut self, bytes: &[u8]) -> Result<(Vec<Point>, NodeTags, EntityBlocks), MeshFileError> {
        let (cursor, end) = (Cursor::new(bytes), bytes.len());
        let (tags, points) = self.nodes.take().ok_or_else(|| cursor.fault(end, "a section $Nodes"))?;
        let blocks = self.blocks.take().ok_or_else(|| cursor.fault(end, "a section $Elements"))?;
        Ok((points, tags, blocks))
    }
}

fn format(cursor: &mut Cursor) -> Result<Version, MeshFileError> {
    let at = cursor.position();
    let found = String::from_utf8_lossy(cursor.token()).into_owned();
    let version = match found.as_str() {
        "2" | "2.0" | "2.1" | "2.2" => Version::Two,
        "4.1" => Version::Four,
        _ => {
            let is_number = found.parse::<f64>().is_ok_and(|v| (0.0..100.0).contains(&v));
            return Err(if is_number {
                MeshFileError::Version { at: cursor.place(at), found }
            } else {
                cursor.fault(at, "the version of the format")
            });
        }
    };
    let at = cursor.position();
    let binary = match cursor.text_integer("0 for text or 1 for binary")? {
        0 => false,
        1 => true,
        _ => return Err(cursor.fault(at, "0 for text or 1 for binary")),
    };
    let at = cursor.position();
    let size = match (cursor.text_integer("the bytes of a number: 8")?, version) {
        (8, _) => 8,
        (4, Version::Four) => 4,
        _ => return Err(cursor.fault(at, "the bytes of a number: 8")),
    };
    cursor.line();
    if binary {
        cursor.byte_order(size)?;
    }
    cursor.end_section("MeshFormat")?;
    Ok(version)
}

/// Lines `dimension tag "name"`, which are text in every file.
fn physical_names(cursor: &mut Cursor) -> Result<BTreeMap<(usize, i64), String>, MeshFileError> {
    let count = cursor.text_integer("the number of physical names")?;
    let mut names = BTreeMap::new();
    for _ in 0..count {
        let at = cursor.word_position();
        let dim = cursor.text_integer("the dimension of a physical group")?;
        let dim =
            usize::try_from(dim).ok().filter(|d| *d <= 3).ok_or_else(|| cursor.fault(at, "a dimension from 0 to 3"))?;
        let tag = cursor.text_integer("the tag of a physical group")?;
        let at = cursor.word_position();
        let line = cursor.line().trim_ascii();
        let name = line.strip_prefix(b"\"").and_then(|l| l.strip_suffix(b"\"")).filter(|n| !n.is_empty());
        let name = name.ok_or_else(|| cursor.fault(at, "the name of the physical group in double quotes"))?;
        names.insert((dim, tag), String::from_utf8_lossy(name).into_owned());
    }
    cursor.end_section("PhysicalNames")?;
    Ok(names)
}

/// The physical groups of the entities, from points to volumes.
fn entities(cursor: &mut Cursor) -> Result<BTreeMap<(i64, i64), Vec<i64>>, MeshFileError> {
    let mut counts = [0; 4];
    for count in &mut counts {
        *count = cursor.size("the number of entities")?;
    }
    let mut groups = BTreeMap::new();
    for (dim, count) in counts.into_iter().enumerate() {
        for _ in 0..count {
            let tag = cursor.integer("the tag of an entity")?;
            // A point has its position, the others their bounding box.
            for _ in 0..if dim == 0 { 3 } else { 6 } {
                cursor.real("a coordinate of the bounding box of an entity")?;
            }
            let physical = cursor.list("physical groups of an entity")?;
            // The sign of a group gives its orientation, which is taken from the cells instead.
            groups.insert((dim as i64, tag), physical.into_iter().map(i64::abs).collect());
            if dim > 0 {
                cursor.list("bounding entities of an entity")?;
            }
        }
    }
    cursor.end_section("Entities")?;
    Ok(groups)
}

/// Element or node numbers with one value each.
pub(super) struct DataSection {
    pub of_elements: bool,
    pub values: Vec<(i64, f64)>,
}

/// Reads the data section at the cursor if it has the wanted name, or skips it.
fn data_section(cursor: &mut Cursor, word: &[u8], wanted: &str) -> Result<Option<DataSection>, MeshFileError> {
    let texts = cursor.text_integer("the number of string tags")?;
    cursor.line();
    let mut name = String::new();
    for i in 0..texts {
        let line = cursor.line().trim_ascii();
        let text = line.strip_prefix(b"\"").and_then(|line| line.strip_suffix(b"\"")).unwrap_or(line);
        if i == 0 {
            name = String::from_utf8_lossy(text).into_owned();
        }
    }
    if name != wanted {
        cursor.skip_section(word)?;
        return Ok(None);
    }
    for _ in 0..cursor.text_integer("the number of real tags")? {
        cursor.token();
    }
    let at = cursor.word_position();
    let integers = cursor.text_integer("the number of integer tags")?;
    let mut tags = [0; 3];
    for i in 0..integers {
        let tag = cursor.text_integer("an integer tag of data")?;
        if let Some(kept) = usize::try_from(i).ok().and_then(|i| tags.get_mut(i)) {
            *kept = tag;
        }
    }
    let [_, components, count] = tags;
    if components != 1 {
        return Err(cursor.fault(at, format!("data \"{wanted}\" of one component")));
    }
    let count = u64::try_from(count).map_err(|_| cursor.fault(at, "the number of values"))?;
    let count = cursor.fits(at, "values", count, 2, 12)?;
    cursor.begin_data();
    let mut values = Vec::with_capacity(count);
    for _ in 0..count {
        values.push((cursor.integer("the tag of an element or a node")?, cursor.real("a value")?));
    }
    let of_elements = word == b"$ElementData";
    cursor.end_section(if of_elements { "ElementData" } else { "NodeData" })?;
    Ok(Some(DataSection { of_elements, values }))
}

/// Map from node tags to indices.
pub(super) enum NodeTags {
    /// Index by tag, `u32::MAX` for an unused tag, and the number of nodes.
    Dense(Vec<u32>, usize),
    /// Pairs of tag and index, sorted.
    Sparse(Vec<(u64, u32)>),
}

impl NodeTags {
    fn new(tags: &[u64]) -> Result<NodeTags, MeshFileError> {
        let largest = tags.iter().copied().max().unwrap_or(0);
        if largest < 4 * tags.len() as u64 + 64 {
            let mut dense = vec![u32::MAX; largest as usize + 1];
            for (index, &tag) in tags.iter().enumerate() {
                if std::mem::replace(&mut dense[tag as usize], index as u32) != u32::MAX {
                    return Err(MeshFileError::RepeatedNode { tag });
                }
            }
            return Ok(NodeTags::Dense(dense, tags.len()));
        }
        let mut sparse: Vec<(u64, u32)> = tags.iter().enumerate().map(|(index, &tag)| (tag, index as u32)).collect();
        sparse.sort_unstable();
        match sparse.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            Some(pair) => Err(MeshFileError::RepeatedNode { tag: pair[0].0 }),
            None => Ok(NodeTags::Sparse(sparse)),
        }
    }

    pub(super) fn index(&self, tag: i64) -> Option<u32> {
        match self {
            NodeTags::Dense(dense, _) => {
                usize::try_from(tag).ok().and_then(|t| dense.get(t)).copied().filter(|&i| i != u32::MAX)
            }
            NodeTags::Sparse(sparse) => {
                let tag = u64::try_from(tag).ok()?;
                sparse.binary_search_by_key(&tag, |pair| pair.0).ok().and_then(|at| sparse.get(at)).map(|pair| pair.1)
            }
        }
    }

    fn len(&self) -> usize {
        match self {
            NodeTags::Dense(_, count) => *count,
            NodeTags::Sparse(sparse) => sparse.len(),
        }
    }
}

fn coordinates(cursor: &mut Cursor, tag: u64) -> Result<Point, MeshFileError> {
    let mut point = [0.0; 3];
    for x in &mut point {
        let at = cursor.position();
        *x = cursor.real("a coordinate of a node")?;
        if !x.is_finite() {
            return Err(MeshFileError::Coordinate { at: cursor.place(at), tag, found: *x });
        }
    }
    Ok(point)
}

fn nodes(cursor: &mut Cursor, version: Version) -> Result<(NodeTags, Vec<Point>), MeshFileError> {
    let read = match version {
        Version::Two => nodes_of_two(cursor)?,
        Version::Four => nodes_of_four(cursor)?,
    };
    cursor.end_section("Nodes")?;
    Ok((NodeTags::new(&read.0)?, read.1))
}

/// A count that version 2 writes as text also in binary files; the data begin on the next line.
fn text_count(cursor: &mut Cursor, what: &'static str) -> Result<(usize, u64), MeshFileError> {
    let at = cursor.word_position();
    let count = u64::try_from(cursor.text_integer(what)?).map_err(|_| cursor.fault(at, what))?;
    if matches!(cursor.mode, NumberEncoding::Binary { .. }) {
        cursor.line();
    }
    Ok((at, count))
}

fn nodes_of_two(cursor: &mut Cursor) -> Result<(Vec<u64>, Vec<Point>), MeshFileError> {
    let (at, count) = text_count(cursor, "nodes")?;
    let count = cursor.fits(at, "nodes", count, 4, 28)?;
    let (mut tags, mut points) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for _ in 0..count {
        let at = cursor.position();
        let tag = u64::try_from(cursor.integer("the tag of a node")?)
            .map_err(|_| cursor.fault(at, "a tag that is not negative"))?;
        tags.push(tag);
        points.push(coordinates(cursor, tag)?);
    }
    Ok((tags, points))
}

fn nodes_of_four(cursor: &mut Cursor) -> Result<(Vec<u64>, Vec<Point>), MeshFileError> {
    cursor.line();
    let blocks = cursor.size("the number of blocks of nodes")?;
    let at = cursor.position();
    let count = cursor.size("the number of nodes")?;
    cursor.size("the smallest tag of a node")?;
    cursor.size("the largest tag of a node")?;
    let count = cursor.fits(at, "nodes", count, 4, cursor.size_bytes() + 24)?;
    let (mut tags, mut points) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for _ in 0..blocks {
        let at = cursor.position();
        let dim = cursor.integer("the dimension of an entity")?;
        let dim =
            usize::try_from(dim).ok().filter(|d| *d <= 3).ok_or_else(|| cursor.fault(at, "a dimension from 0 to 3"))?;
        cursor.integer("the tag of an entity")?;
        let parameters = if cursor.integer("0 or 1 for parametric coordinates")? == 0 { 0 } else { dim };
        let at = cursor.position();
        let own = cursor.size("the number of nodes of a block")?;
        let own =
            cursor.fits(at, "nodes of a block", own, 4 + parameters, cursor.size_bytes() + 8 * (3 + parameters))?;
        if tags.len() + own > count {
            return Err(cursor.fault(at, format!("no more than the {count} nodes announced")));
        }
        let first = tags.len();
        for _ in 0..own {
            tags.push(cursor.size("the tag of a node")?);
        }
        for i in first..first + own {
            points.push(coordinates(cursor, tags[i])?);
            for _ in 0..parameters {
                cursor.real("a parametric coordinate of a node")?;
            }
        }
    }
    if tags.len() != count {
        let at = cursor.position();
        return Err(cursor.fault(at, format!("{count} nodes, as announced, of which {} came", tags.len())));
    }
    Ok((tags, points))
}

fn kind(cursor: &mut Cursor) -> Result<Kind, MeshFileError> {
    let at = cursor.position();
    let code = cursor.integer("the type of an element")?;
    super::kind(code).ok_or_else(|| MeshFileError::ElementType { at: cursor.place(at), found: code })
}

/// Reads the nodes of an element in the order of the library.
fn connectivity(
    cursor: &mut Cursor,
    kind: &Kind,
    tags: &NodeTags,
    version: Version,
    nodes: &mut Vec<u32>,
) -> Result<(), MeshFileError> {
    let first = nodes.len();
    nodes.resize(first + kind.nodes, 0);
    for i in 0..kind.nodes {
        let at = cursor.position();
        let tag = match version {
            Version::Two => cursor.integer("the tag of a node")?,
            Version::Four => i64::try_from(cursor.size("the tag of a node")?).unwrap_or(i64::MAX),
        };
        let local = kind.element.map_or(i, |element| element.orders.gmsh.local(i));
        nodes[first + local] = tags.index(tag).ok_or_else(|| MeshFileError::UnknownNode {
            at: cursor.place(at),
            tag,
            nodes: tags.len(),
        })?;
    }
    Ok(())
}

fn elements_of_four(
    cursor: &mut Cursor,
    tags: &NodeTags,
    entities: Option<&Entities>,
) -> Result<EntityBlocks, MeshFileError> {
    cursor.line();
    let blocks = cursor.size("the number of blocks of elements")?;
    let at_count = cursor.position();
    let count = cursor.size("the number of elements")?;
    cursor.size("the smallest tag of an element")?;
    cursor.size("the largest tag of an element")?;
    let (mut read, mut of) = (Vec::new(), Vec::new());
    let mut total = 0;
    for _ in 0..blocks {
        let at = cursor.position();
        let (dim, entity) = (cursor.integer("the dimension of an entity")?, cursor.integer("the tag of an entity")?);
        let unknown = || MeshFileError::UnknownEntity { at: cursor.place(at), dim, tag: entity };
        let groups = match entities.map(|all| (all.groups.get(&(dim, entity)), all.ghosts.contains(&entity))) {
            None => Some(Vec::new()),
            Some((Some(groups), _)) => Some(groups.clone()),
            Some((None, true)) => None,
            Some((None, false)) => return Err(unknown()),
        };
        let kind = kind(cursor)?;
        if dim != kind.dim as i64 {
            return Err(cursor.fault(at, format!("the dimension {} of a {}", kind.dim, kind.name)));
        }
        let at_own = cursor.position();
        let own = cursor.size("the number of elements of a block")?;
        let own =
            cursor.fits(at_own, "elements of a block", own, 1 + kind.nodes, cursor.size_bytes() * (1 + kind.nodes))?;
        let mut nodes = Vec::with_capacity(own * kind.nodes);
        let mut numbers = Vec::with_capacity(own);
        for _ in 0..own {
            numbers.push(i64::try_from(cursor.size("the tag of an element")?).unwrap_or(i64::MAX));
            connectivity(cursor, &kind, tags, Version::Four, &mut nodes)?;
        }
        total += own as u64;
        // Ghost cells belong to another partition.
        if let Some(groups) = groups {
            read.push(LooseBlock { kind, groups: groups.into_iter().collect(), at, nodes, numbers });
            of.push(entities.map_or(entity, |all| all.known((dim, entity))));
        }
    }
    if total != count {
        return Err(cursor.fault(at_count, format!("the number of elements that follow, {total}")));
    }
    cursor.end_section("Elements")?;
    Ok((read, of))
}

fn elements_of_two(cursor: &mut Cursor, tags: &NodeTags) -> Result<EntityBlocks, MeshFileError> {
    let mut read = BlocksOfTwo::default();
    let (at, count) = text_count(cursor, "elements")?;
    let count = cursor.fits(at, "elements", count, 4, 8)?;
    let mut done = 0;
    while done < count {
        let at = cursor.position();
        // In text the element tag comes first; in binary a header precedes elements of one type.
        let mut number = 0;
        let (kind, follow) = if cursor.mode == NumberEncoding::Ascii {
            number = cursor.integer("the tag of an element")?;
            (kind(cursor)?, 1)
        } else {
            let kind = kind(cursor)?;
            let at = cursor.position();
            let follow = usize::try_from(cursor.integer("the number of elements that follow")?).ok();
            (
                kind,
                follow
                    .filter(|n| (1..=count - done).contains(n))
                    .ok_or_else(|| cursor.fault(at, "a number of elements within those announced"))?,
            )
        };
        let at_tags = cursor.position();
        let tag_count = u64::try_from(cursor.integer("the number of tags of an element")?).unwrap_or(u64::MAX);
        let tag_count = cursor.fits(at_tags, "tags of an element", tag_count, 1, 4)?;
        for _ in 0..follow {
            if cursor.mode != NumberEncoding::Ascii {
                number = cursor.integer("the tag of an element")?;
            }
            // Physical group, entity, number of partitions, and the partitions, of which the first owns the element.
            let mut own = [0; 4];
            for i in 0..tag_count {
                let tag = cursor.integer("a tag of an element")?;
                if let Some(own) = own.get_mut(i) {
                    *own = tag;
                }
            }
            let [physical, entity, _, partition] = own;
            if partition < 0 {
                connectivity(cursor, &kind, tags, Version::Two, &mut Vec::new())?;
                continue;
            }
            let block = read.of(&kind, physical.abs(), entity, at);
            block.numbers.push(number);
            connectivity(cursor, &kind, tags, Version::Two, &mut block.nodes)?;
        }
        done += follow;
    }
    cursor.end_section("Elements")?;
    Ok((read.blocks, read.entities))
}

/// Blocks of version 2, whose elements are listed one by one.
#[derive(Default)]
struct BlocksOfTwo {
    blocks: Vec<LooseBlock>,
    /// The entity of each block.
    entities: Vec<i64>,
    /// Block by name of the element, physical group and entity.
    index: BTreeMap<(&'static str, i64, i64), usize>,
    last: Option<((&'static str, i64, i64), usize)>,
}

impl BlocksOfTwo {
    fn of(&mut self, kind: &Kind, physical: i64, entity: i64, at: usize) -> &mut LooseBlock {
        let key = (kind.name, physical, entity);
        let index = match self.last {
            Some((last, index)) if last == key => index,
            _ => *self.index.entry(key).or_insert_with(|| {
                let groups = if physical == 0 { BTreeSet::new() } else { BTreeSet::from([physical]) };
                self.blocks.push(LooseBlock { kind: *kind, groups, at, nodes: Vec::new(), numbers: Vec::new() });
                self.entities.push(entity);
                self.blocks.len() - 1
            }),
        };
        self.last = Some((key, index));
        &mut self.blocks[index]
    }
}
