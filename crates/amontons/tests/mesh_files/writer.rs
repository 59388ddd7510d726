//! A writer of Gmsh files, straight from the format's description, for all variants that the reader knows.
#![allow(clippy::too_many_lines, clippy::too_many_arguments, reason = "a test is one list of cases")]

use amontons::element::Element;
use amontons::mesh::Mesh;

/// A variant of the format.
#[derive(Clone, Copy, Debug)]
pub struct Format {
    /// 2 or 4, for 2.2 and 4.1.
    pub version: u8,
    /// None for text; whether big-endian for binary.
    pub binary: Option<bool>,
    /// Node i has the tag `1 + i * step mod n`, times `spread`.
    pub step: u64,
    pub spread: u64,
}

impl Format {
    pub fn all() -> Vec<Format> {
        let mut all = Vec::new();
        for version in [2, 4] {
            for binary in [None, Some(false), Some(true)] {
                for (step, spread) in [(1, 1), (7, 1), (7, 1000)] {
                    all.push(Format { version, binary, step, spread });
                }
            }
        }
        all
    }
}

struct Out {
    bytes: Vec<u8>,
    format: Format,
}

impl Out {
    fn text(&mut self, text: &str) {
        self.bytes.extend(text.as_bytes());
    }
    fn raw<const N: usize>(&mut self, mut little: [u8; N]) {
        if self.format.binary == Some(true) {
            little.reverse();
        }
        self.bytes.extend(little);
    }
    fn int(&mut self, value: i32) {
        if self.format.binary.is_some() { self.raw(value.to_le_bytes()) } else { self.text(&format!("{value} ")) }
    }
    /// A `size_t` of version 4, an `int` of version 2.
    fn size(&mut self, value: u64) {
        match self.format.binary {
            Some(_) if self.format.version == 4 => self.raw(value.to_le_bytes()),
            _ => self.int(value as i32),
        }
    }
    fn real(&mut self, value: f64) {
        if self.format.binary.is_some() { self.raw(value.to_le_bytes()) } else { self.text(&format!("{value:?} ")) }
    }
    fn line(&mut self) {
        if self.format.binary.is_none() {
            self.text("\n");
        }
    }
}

/// Elements of one kind and group, as both versions want them.
struct Group<'a> {
    element: &'static Element,
    nodes: &'a [u32],
    dim: usize,
    tag: i32,
}

/// A mesh as a file; every region and side is a physical group on an entity with the same tag.
pub fn write(mesh: &Mesh, format: Format) -> Vec<u8> {
    let mut out = Out { bytes: Vec::new(), format };
    let n = mesh.points.len() as u64;
    assert!(!n.is_multiple_of(format.step) || format.step == 1, "the tags repeat");
    let tag = |node: u32| (1 + u64::from(node) * format.step % n) * format.spread;
    out.text(&format!(
        "$MeshFormat\n{} {} 8\n",
        if format.version == 2 { "2.2" } else { "4.1" },
        i32::from(format.binary.is_some())
    ));
    if format.binary.is_some() {
        out.int(1);
        out.text("\n");
    }
    out.text("$EndMeshFormat\n");
    out.text(&format!("$PhysicalNames\n{}\n", mesh.regions.len() + mesh.facets.len()));
    for (i, name) in mesh.facets.keys().enumerate() {
        out.text(&format!("{} {} \"{name}\"\n", mesh.dim - 1, i + 1));
    }
    for (i, name) in mesh.regions.iter().enumerate() {
        out.text(&format!("{} {} \"{name}\"\n", mesh.dim, i + 1));
    }
    out.text("$EndPhysicalNames\n$Unknown\n1 2 3 $ \n$EndUnknown\n");
    let mut groups = Vec::new();
    for (i, set) in mesh.facets.values().enumerate() {
        groups.extend(set.blocks.iter().map(|b| Group {
            element: b.element,
            nodes: &b.nodes,
            dim: mesh.dim - 1,
            tag: i as i32 + 1,
        }));
    }
    groups.extend(mesh.blocks.iter().map(|b| Group {
        element: b.element,
        nodes: &b.nodes,
        dim: mesh.dim,
        tag: b.region as i32 + 1,
    }));
    if format.version == 2 {
        version_two(&mut out, mesh, &groups, tag);
    } else {
        version_four(&mut out, mesh, &groups, tag);
    }
    out.bytes
}

/// The number of the type of cells with all nodes of an element.
fn code(group: &Group) -> i32 {
    group.element.types[0].gmsh.expect("a type of Gmsh") as i32
}

fn connectivity(out: &mut Out, group: &Group, cell: &[u32], tag: &impl Fn(u32) -> u64) {
    for position in 0..cell.len() {
        out.size(tag(cell[group.element.orders.gmsh.local(position)]));
    }
    out.line();
}

fn version_two(out: &mut Out, mesh: &Mesh, groups: &[Group], tag: impl Fn(u32) -> u64) {
    out.text(&format!("$Nodes\n{}\n", mesh.points.len()));
    for (i, point) in mesh.points.iter().enumerate() {
        out.size(tag(i as u32));
        for &x in point {
            out.real(x);
        }
        out.line();
    }
    out.text("\n$EndNodes\n$Elements\n");
    let count: usize = groups.iter().map(|g| g.nodes.len() / g.element.nodes.len()).sum();
    out.text(&format!("{count}\n"));
    let mut number = 0;
    for group in groups {
        let cells = group.nodes.chunks_exact(group.element.nodes.len());
        if out.format.binary.is_some() {
            out.int(code(group));
            out.int(cells.len() as i32);
            out.int(2);
        }
        for cell in cells {
            number += 1;
            out.int(number);
            if out.format.binary.is_none() {
                out.int(code(group));
                out.int(2);
            }
            out.int(group.tag);
            out.int(group.tag);
            connectivity(out, group, cell, &tag);
        }
    }
    out.text("\n$EndElements\n");
}

fn version_four(out: &mut Out, mesh: &Mesh, groups: &[Group], tag: impl Fn(u32) -> u64) {
    out.text("$Entities\n");
    for dim in 0..4 {
        out.size(if dim == mesh.dim {
            mesh.regions.len()
        } else if dim + 1 == mesh.dim {
            mesh.facets.len()
        } else {
            0
        } as u64);
    }
    out.line();
    for (dim, count) in [(mesh.dim - 1, mesh.facets.len()), (mesh.dim, mesh.regions.len())] {
        for entity in 1..=count as i32 {
            out.int(entity);
            (0..if dim == 0 { 3 } else { 6 }).for_each(|_| out.real(0.5));
            out.size(1);
            // The sign is the orientation of the group.
            out.int(-entity);
            if dim > 0 {
                out.size(2);
                out.int(1);
                out.int(-2);
            }
            out.line();
        }
    }
    out.text("\n$EndEntities\n$Nodes\n");
    // Two blocks, the first with parametric coordinates of a surface.
    let half = mesh.points.len() / 2;
    let n = mesh.points.len() as u64;
    for value in [2, n, out.format.spread, n * out.format.spread] {
        out.size(value);
    }
    out.line();
    for (parametric, range) in [(1, 0..half), (0, half..mesh.points.len())] {
        out.int(2);
        out.int(1);
        out.int(parametric);
        out.size(range.len() as u64);
        out.line();
        for i in range.clone() {
            out.size(tag(i as u32));
            out.line();
        }
        for i in range {
            for &x in &mesh.points[i] {
                out.real(x);
            }
            (0..2 * parametric).for_each(|_| out.real(f64::from(parametric) * 9.0));
            out.line();
        }
    }
    out.text("\n$EndNodes\n$Elements\n");
    let count: usize = groups.iter().map(|g| g.nodes.len() / g.element.nodes.len()).sum();
    for value in [groups.len() as u64, count as u64, 1, count as u64] {
        out.size(value);
    }
    out.line();
    let mut number = 0;
    for group in groups {
        let cells = group.nodes.chunks_exact(group.element.nodes.len());
        out.int(group.dim as i32);
        out.int(group.tag);
        out.int(code(group));
        out.size(cells.len() as u64);
        out.line();
        for cell in cells {
            number += 1;
            out.size(number);
            connectivity(out, group, cell, &tag);
        }
    }
    out.text("\n$EndElements\n");
}
