//! Meshes of Code_Aster and Salome: MED (`.med`), which is HDF5.
//!
//! Groups of cells of dimension d become regions, those of dimension d − 1 sides, those of edges named edges. Node
//! groups that contain facets of the boundary are sides, the others edges or points. A cell without a group is in no
//! region, as in a file of Gmsh. Supported are files of versions 2.2 to 4 with one mesh, of which the first step is
//! read. MED orients cells in the opposite direction of VTK.

use std::collections::{BTreeMap, BTreeSet};

use hdf5_pure::{AttrValue, Dataset, File, Group};

use super::Mesh;
use super::read::{CHARACTER, FilePosition, Kind, Loose, LooseBlock, MeshFile, MeshFileError, NUMBER, NodeSet, Room};
use crate::element::CellType;
use crate::tensor::Point;

/// Length of a group name.
const NAME: usize = 80;

fn refuse(message: impl Into<String>) -> MeshFileError {
    MeshFileError::Grid { message: message.into() }
}

/// Converts an error of the HDF5 library.
fn told(what: &str) -> impl Fn(hdf5_pure::Error) -> MeshFileError + '_ {
    move |error| refuse(format!("{what} cannot be read: {error}"))
}

/// Reads a mesh from the bytes of a MED file: cells → blocks in the order of the types in the file.
///
/// # Errors
/// Fails if the bytes are no mesh of one body; the error names the part of the file.
pub fn parse(bytes: &[u8]) -> Result<Mesh, MeshFileError> {
    read(bytes).map(|read| read.mesh)
}

/// Reads the mesh and the list of skipped contents.
pub(super) fn read(bytes: &[u8]) -> Result<MeshFile, MeshFileError> {
    let file = File::from_bytes(bytes.to_vec())
        .map_err(|error| refuse(format!("no HDF5, which a MED file is: {error}; it may be truncated")))?;
    let root = file.root();
    let meshes = child(&root, "ENS_MAA").ok_or_else(|| refuse("HDF5 without meshes (ENS_MAA), expected a MED file"))?;
    let names = meshes.groups().map_err(told("ENS_MAA"))?;
    let [name] = names.as_slice() else {
        let found = if names.is_empty() { "no mesh".to_owned() } else { format!("the meshes {}", names.join(", ")) };
        return Err(refuse(format!("{found}, expected one; export the mesh of one body")));
    };
    let mesh = meshes.group(name).map_err(told(name))?;
    let step = step(&mesh, name)?;
    let room = Room::of(bytes);
    let points = points(&mesh, &step, room)?;
    let families = child(&root, "FAS").and_then(|all| child(&all, name));
    let mut read = MedReader { room, points: points.len(), blocks: Vec::new(), groups: MedGroups::default() };
    if let Some(cells) = child(&step, "MAI") {
        let of_cells = families_of(families.as_ref(), "ELEME", room)?;
        for kind in cells.groups().map_err(told("MAI"))? {
            read.cells(&cells.group(&kind).map_err(told(&kind))?, &kind, &of_cells)?;
        }
    }
    let node_sets = read.nodes(&step, &families_of(families.as_ref(), "NOEUD", room)?)?;
    let names = read.groups.names();
    Loose { points, blocks: read.blocks, names, node_sets, ..Loose::default() }.into_read(FilePosition::Cell)
}

fn child(group: &Group, name: &str) -> Option<Group> {
    group.group(name).ok()
}

/// The group with nodes and cells: the first step, or before version 3 the mesh itself.
fn step(mesh: &Group, name: &str) -> Result<Group, MeshFileError> {
    if child(mesh, "NOE").is_some() {
        return Ok(mesh.clone());
    }
    let mut steps = mesh.groups().map_err(told(name))?;
    steps.sort();
    let with_nodes = steps.iter().filter_map(|step| child(mesh, step)).find(|step| child(step, "NOE").is_some());
    with_nodes.ok_or_else(|| refuse(format!("the mesh {name} has no nodes (NOE)")))
}

fn integer(value: &AttrValue) -> Option<i64> {
    match value {
        AttrValue::I32(v) => Some(i64::from(*v)),
        AttrValue::I64(v) => Some(*v),
        AttrValue::U32(v) => Some(i64::from(*v)),
        AttrValue::I32Array(v) => v.first().map(|v| i64::from(*v)),
        AttrValue::I64Array(v) => v.first().copied(),
        _ => None,
    }
}

/// The coordinates: all x, all y, all z.
fn points(mesh: &Group, step: &Group, room: Room) -> Result<Vec<Point>, MeshFileError> {
    let attributes = mesh.attrs().map_err(told("the mesh"))?;
    let dim = ["ESP", "DIM"].iter().find_map(|key| integer(attributes.get(*key)?)).unwrap_or(0);
    let dim = usize::try_from(dim).ok().filter(|dim| (1..=3).contains(dim));
    let dim = dim.ok_or_else(|| refuse("a mesh without a dimension of space (ESP), expected 1, 2 or 3"))?;
    let data = step.dataset("NOE/COO").map_err(told("NOE/COO"))?;
    let values = fits(&data, "NOE/COO", NUMBER, room)?.read_f64().map_err(told("NOE/COO"))?;
    let count = values.len() / dim;
    if count * dim != values.len() || count > u32::MAX as usize {
        return Err(refuse(format!("{} coordinates (NOE/COO) in {dim} dimensions", values.len())));
    }
    if let Some(at) = values.iter().position(|x| !x.is_finite()) {
        return Err(refuse(format!(
            "the coordinate {} of node {}, expected a finite number",
            values[at],
            at % count + 1
        )));
    }
    let of = |node: usize| -> Point { std::array::from_fn(|d| if d < dim { values[d * count + node] } else { 0.0 }) };
    Ok((0..count).map(of).collect())
}

/// The group names of each family.
fn families_of(families: Option<&Group>, of: &str, room: Room) -> Result<Families, MeshFileError> {
    let mut all = BTreeMap::new();
    let Some(families) = families.and_then(|families| child(families, of)) else { return Ok(all) };
    for name in families.groups().map_err(told(of))? {
        let family = families.group(&name).map_err(told(&name))?;
        let attributes = family.attrs().map_err(told(&name))?;
        let number = attributes.get("NUM").and_then(integer);
        let number = number.ok_or_else(|| refuse(format!("the family {name} has no number (NUM)")))?;
        let mut groups = BTreeSet::new();
        if let Ok(names) = family.dataset("GRO/NOM") {
            let bytes = fits(&names, &name, CHARACTER, room)?.read_raw().map_err(told(&name))?;
            for name in bytes.chunks(NAME) {
                let end = name.iter().position(|byte| *byte == 0).unwrap_or(name.len());
                let name = String::from_utf8_lossy(&name[..end]).trim().to_owned();
                groups.extend((!name.is_empty()).then_some(name));
            }
        }
        all.insert(number, groups);
    }
    Ok(all)
}

/// Tags of the groups per dimension, in the order of occurrence.
#[derive(Default)]
struct MedGroups(BTreeMap<(usize, String), i64>);

impl MedGroups {
    fn tag(&mut self, dim: usize, name: &str) -> i64 {
        let next = self.0.len() as i64;
        *self.0.entry((dim, name.to_owned())).or_insert(next)
    }

    fn names(self) -> BTreeMap<(usize, i64), String> {
        self.0.into_iter().map(|((dim, name), tag)| ((dim, tag), name)).collect()
    }
}

struct MedReader {
    room: Room,
    /// Number of nodes.
    points: usize,
    blocks: Vec<LooseBlock>,
    groups: MedGroups,
}

type Families = BTreeMap<i64, BTreeSet<String>>;

impl MedReader {
    /// Reads the cells of one type.
    fn cells(&mut self, group: &Group, code: &str, families: &Families) -> Result<(), MeshFileError> {
        let found = CellType::find(|_, cell| cell.med == Some(code));
        let Some((element, &CellType { nodes, med: Some(name), .. })) = found else {
            let known = CellType::names(|cell| cell.med);
            let hint = if code == "TR7" { "; save triangles with a node in the middle as TR6, without it" } else { "" };
            return Err(refuse(format!("cells of type {code}, expected one of {known}{hint}")));
        };
        let kind = Kind { name, dim: element.dim(), nodes, element: Some(element) };
        let positions = element.orders.med.positions(nodes);
        let listed = integers(&group.dataset("NOD").map_err(told("NOD"))?, "NOD", self.room)?;
        let count = listed.len() / nodes;
        if count * nodes != listed.len() {
            return Err(refuse(format!("{} nodes of cells of type {code}, which have {nodes} each", listed.len())));
        }
        let of = family_of_each(group, count, code, self.room)?;
        let mut index: BTreeMap<i64, usize> = BTreeMap::new();
        for cell in 0..count {
            let family = of.as_ref().map_or(0, |of| of[cell]);
            let block = match index.get(&family) {
                Some(block) => *block,
                None => self.block(kind, families.get(&family), cell),
            };
            index.insert(family, block);
            for position in &positions {
                let node = self.node(listed[position * count + cell], cell, code)?;
                self.blocks[block].nodes.push(node);
            }
        }
        Ok(())
    }

    /// The node groups.
    fn nodes(&self, step: &Group, families: &Families) -> Result<Vec<NodeSet>, MeshFileError> {
        let of = child(step, "NOE")
            .map(|group| family_of_each(&group, self.points, "nodes", self.room))
            .transpose()?
            .flatten();
        let mut sets: BTreeMap<&String, BTreeSet<u32>> = BTreeMap::new();
        for (node, family) in of.iter().flatten().enumerate() {
            for name in families.get(family).into_iter().flatten() {
                sets.entry(name).or_default().insert(node as u32);
            }
        }
        Ok(sets.into_iter().map(|(name, nodes)| NodeSet { name: name.clone(), nodes }).collect())
    }

    fn block(&mut self, kind: Kind, groups: Option<&BTreeSet<String>>, at: usize) -> usize {
        let groups = groups.into_iter().flatten().map(|name| self.groups.tag(kind.dim, name)).collect();
        self.blocks.push(LooseBlock { kind, groups, at, nodes: Vec::new(), numbers: Vec::new() });
        self.blocks.len() - 1
    }

    fn node(&self, number: i64, cell: usize, code: &str) -> Result<u32, MeshFileError> {
        let index = number.checked_sub(1).and_then(|node| u32::try_from(node).ok());
        index.filter(|node| (*node as usize) < self.points).ok_or_else(|| {
            let expected = format!("one of the nodes 1 to {}", self.points);
            refuse(format!("node {number} of cell {cell} of type {code}, expected {expected}"))
        })
    }
}

/// The family of each of `count` cells or nodes; `None` if all are in family 0.
fn family_of_each(group: &Group, count: usize, of: &str, room: Room) -> Result<Option<Vec<i64>>, MeshFileError> {
    let Ok(data) = group.dataset("FAM") else { return Ok(None) };
    let families = integers(&data, "FAM", room)?;
    if families.len() != count {
        return Err(refuse(format!("{} families (FAM) of {count} {of}", families.len())));
    }
    Ok(Some(families))
}

fn integers(data: &Dataset, what: &str, room: Room) -> Result<Vec<i64>, MeshFileError> {
    fits(data, what, NUMBER, room)?.read_i64().map_err(told(what))
}

/// The data, or an error if the file is too short for them.
fn fits<'a>(data: &'a Dataset, what: &str, each: u64, room: Room) -> Result<&'a Dataset, MeshFileError> {
    room.holds(what, &data.shape().map_err(told(what))?, each)?;
    Ok(data)
}
