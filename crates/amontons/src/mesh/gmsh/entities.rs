//! Entities that replace missing physical groups, cells written once per group, and partitions, in Gmsh files.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::super::read::{Loose, LooseBlock};
use super::cursor::Cursor;
use crate::mesh::read::MeshFileError;
use crate::mesh::topology::{SortedFacet, key};

/// Prefix of the names of groups that Gmsh creates for partitions.
const OF_PARTITION: &str = "_part{";
/// Gmsh's names of entities per dimension.
const ENTITIES: [&str; 4] = ["point", "curve", "surface", "volume"];

/// Entities by their dimension and tag.
#[derive(Default)]
pub(super) struct Entities {
    /// Physical groups of each entity.
    pub groups: BTreeMap<(i64, i64), Vec<i64>>,
    /// The original entity of each partitioned one.
    pub parents: BTreeMap<(i64, i64), (i64, i64)>,
    /// Tags of entities of ghost cells.
    pub ghosts: BTreeSet<i64>,
}

impl Entities {
    /// The tag of the original entity, 0 for interfaces between partitions.
    pub fn known(&self, entity: (i64, i64)) -> i64 {
        match self.parents.get(&entity) {
            Some((dim, tag)) if *dim == entity.0 => *tag,
            Some(_) => 0,
            None => entity.1,
        }
    }

    /// Reads the section of partitioned entities.
    pub fn partitioned(&mut self, cursor: &mut Cursor) -> Result<(), MeshFileError> {
        cursor.line();
        cursor.size("the number of partitions")?;
        let at = cursor.position();
        let ghosts = cursor.size("the number of ghost entities")?;
        for _ in 0..cursor.fits(at, "ghost entities", ghosts, 2, 8)? {
            self.ghosts.insert(cursor.integer("the tag of a ghost entity")?);
            cursor.integer("the partition of a ghost entity")?;
        }
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = cursor.size("the number of entities")?;
        }
        for (dim, count) in (0..).zip(counts) {
            for _ in 0..count {
                let tag = cursor.integer("the tag of an entity")?;
                let parent = [cursor.integer("the dimension of an entity")?, cursor.integer("the tag of an entity")?];
                cursor.list("partitions of an entity")?;
                for _ in 0..if dim == 0 { 3 } else { 6 } {
                    cursor.real("a coordinate of the bounding box of an entity")?;
                }
                let physical = cursor.list("physical groups of an entity")?;
                if dim > 0 {
                    cursor.list("bounding entities of an entity")?;
                }
                self.groups.insert((dim, tag), physical.into_iter().map(i64::abs).collect());
                self.parents.insert((dim, tag), (parent[0], parent[1]));
            }
        }
        cursor.end_section("PartitionedEntities")
    }
}

/// Joins the copies of a cell that version 2 writes, one per physical group: of one type and entity, in blocks of
/// different groups.
pub(super) fn join_copies(loose: &mut Loose, entities: &[i64]) {
    let dim = loose.dim();
    let mut families: BTreeMap<(&str, i64), Vec<usize>> = BTreeMap::new();
    for (place, (block, entity)) in loose.blocks.iter().zip(entities).enumerate() {
        if block.kind.dim == dim && *entity != 0 && !block.groups.is_empty() {
            families.entry((block.kind.name, *entity)).or_default().push(place);
        }
    }
    for places in families.into_values().filter(|places| places.len() > 1) {
        let blocks: Vec<LooseBlock> = places
            .iter()
            .map(|&place| {
                let block = &mut loose.blocks[place];
                let empty = LooseBlock { nodes: Vec::new(), numbers: Vec::new(), ..block.clone() };
                std::mem::replace(block, empty)
            })
            .collect();
        // There are at most as many combinations of groups as blocks, since each block has one entity and all of its
        // cells.
        for (place, block) in joined(blocks).into_iter().enumerate() {
            match places.get(place) {
                Some(&place) => loose.blocks[place] = block,
                None => loose.blocks.push(block),
            }
        }
    }
}

/// The cells of blocks by their groups; cells with the same vertices in different blocks are merged.
fn joined(blocks: Vec<LooseBlock>) -> Vec<LooseBlock> {
    let Some(first) = blocks.first() else { return blocks };
    let (kind, at) = (first.kind, first.at);
    let vertices = kind.element.map_or(kind.nodes, |element| element.shape.vertices());
    let mut cells: Vec<(usize, Vec<u32>, Option<i64>, BTreeSet<i64>)> = Vec::new();
    let mut places: HashMap<SortedFacet, usize> = HashMap::new();
    for (number, block) in blocks.iter().enumerate() {
        let tags = block.numbers.iter().copied().map(Some).chain(std::iter::repeat(None));
        for (nodes, tag) in block.nodes.chunks_exact(kind.nodes.max(1)).zip(tags) {
            let next = cells.len();
            let place = *places.entry(key(nodes.iter().copied().take(vertices.min(9)))).or_insert(next);
            match cells.get_mut(place).filter(|(of, ..)| *of != number) {
                Some((_, _, _, groups)) => groups.extend(&block.groups),
                None => cells.push((number, nodes.to_vec(), tag, block.groups.clone())),
            }
        }
    }
    let mut joined: BTreeMap<BTreeSet<i64>, LooseBlock> = BTreeMap::new();
    for (_, nodes, tag, groups) in cells {
        let block = joined.entry(groups.clone()).or_insert_with(|| LooseBlock {
            kind,
            groups,
            at,
            nodes: Vec::new(),
            numbers: Vec::new(),
        });
        block.nodes.extend(nodes);
        block.numbers.extend(tag);
    }
    joined.into_values().collect()
}

/// Names sides and regions by the tags of their entities if there are no physical groups of their dimension.
pub(super) fn name(loose: &mut Loose, entities: &[i64]) {
    let of_partitions: BTreeSet<(usize, i64)> =
        loose.names.iter().filter(|(_, name)| name.starts_with(OF_PARTITION)).map(|(group, _)| *group).collect();
    for block in &mut loose.blocks {
        let dim = block.kind.dim;
        block.groups.retain(|group| !of_partitions.contains(&(dim, *group)));
    }
    let dim = loose.dim();
    let has_groups = |loose: &Loose, of: usize| {
        loose.blocks.iter().any(|block| block.kind.dim == of && !block.nodes.is_empty() && !block.groups.is_empty())
    };
    if dim > 0 && !has_groups(loose, dim - 1) {
        name_sides(loose, entities, dim);
    }
    if !has_groups(loose, dim) {
        let of_cells: BTreeSet<i64> = tagged(loose, entities, dim).map(|place| entities[place]).collect();
        if of_cells.len() > 1 {
            give(loose, entities, dim);
        }
    }
}

/// The nonempty blocks of a dimension.
fn tagged<'l>(loose: &'l Loose, entities: &'l [i64], dim: usize) -> impl Iterator<Item = usize> + 'l {
    let blocks = loose.blocks.iter().zip(entities).enumerate();
    blocks.filter(move |(_, (block, _))| block.kind.dim == dim && !block.nodes.is_empty()).map(|(place, _)| place)
}

/// Assigns to each block of a dimension the group of its entity.
fn give(loose: &mut Loose, entities: &[i64], dim: usize) {
    let kind = ENTITIES.get(dim).copied().unwrap_or_default();
    for (block, &entity) in loose.blocks.iter_mut().zip(entities).filter(|(block, _)| block.kind.dim == dim) {
        if entity != 0 || dim == 0 {
            block.groups = BTreeSet::from([entity]);
            loose.names.insert((dim, entity), format!("{kind}-{entity}"));
        }
    }
}

/// Names the boundary parts by their entities, unless there is only one.
fn name_sides(loose: &mut Loose, entities: &[i64], dim: usize) {
    let places: Vec<usize> = tagged(loose, entities, dim - 1).filter(|&place| entities[place] != 0).collect();
    if places.is_empty() {
        return;
    }
    let free = loose.free();
    let mut found = 0;
    let mut of_sides = BTreeSet::new();
    for place in places {
        let block = &mut loose.blocks[place];
        let Some(element) = block.kind.element else { continue };
        let vertices = element.shape.vertices();
        let is_free = |nodes: &&[u32]| free.contains(&key(nodes.iter().copied().take(vertices)));
        let on_side: Vec<&[u32]> = block.nodes.chunks_exact(block.kind.nodes.max(1)).filter(is_free).collect();
        found += on_side.len();
        if !on_side.is_empty() {
            of_sides.insert(entities[place]);
        }
        block.nodes = on_side.concat();
        block.numbers.clear();
    }
    if of_sides.len() > 1 || found < free.len() {
        give(loose, entities, dim - 1);
    }
}
