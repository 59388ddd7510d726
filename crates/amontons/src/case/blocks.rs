//! Meshes of several blocks: `[[mesh.blocks]]`.

use super::build::Build;
use super::memory::{MeshDemand, MeshSize};
use super::mesh::{FileOf, MeshFromFile, generate, measured, size};
use super::place::At;
use super::raw;
use super::side_names::SideNames;
use crate::machine::FreeMemory;
use crate::mesh::{Mesh, MeshError, PlaneState};
use crate::tensor::Rotation;

/// The source of the mesh of a block.
enum BlockSource {
    File(Mesh),
    /// A generated mesh with these cells.
    Shape(raw::Mesh, Vec<usize>),
}

impl BlockSource {
    fn mesh(self) -> Result<Mesh, MeshError> {
        match self {
            BlockSource::File(mesh) => Ok(mesh),
            BlockSource::Shape(shape, cells) => generate(&shape, &cells),
        }
    }
}

/// A block before it is placed.
struct UnplacedBlock {
    mesh: BlockSource,
    size: MeshSize,
    /// Stress state of a plane body by the elements of its file, if they say it.
    plane: Option<PlaneState>,
}

impl Build<'_> {
    /// The mesh of several blocks, or `None` if one has a fault.
    pub fn blocks(
        &mut self,
        blocks: &[raw::Block],
        axisymmetric: bool,
        sides: &SideNames,
        available: Option<FreeMemory>,
    ) -> Option<Mesh> {
        let (mut bodies, mut all, mut said) = (Vec::new(), MeshSize::default(), Vec::new());
        for (i, block) in blocks.iter().enumerate() {
            let path = format!("mesh.blocks[{i}]");
            if blocks[..i].iter().any(|other| other.name == block.name) {
                let found = format!("\"{}\" again", block.name);
                self.note(&format!("{path}.name"), At::Value, found, "a name of its own for each block", None);
                return None;
            }
            let UnplacedBlock { mesh, size, plane } = self.body(&path, block, all.dim, axisymmetric, sides)?;
            said.push(plane);
            all.dim = size.dim;
            all.nodes += size.nodes;
            all.contact_nodes += size.contact_nodes;
            all.neighbours = all.neighbours.max(size.neighbours);
            let demand = MeshDemand::of(&all, self.solver);
            if !self.affordable(&path, "the blocks", "take fewer cells", &demand, available) {
                return None;
            }
            let mesh = mesh.mesh().map_err(|error| self.no_block(i, &error)).ok()?;
            let mut mesh = self.placed(&path, block, mesh)?;
            mesh.axisymmetric = (axisymmetric || mesh.axisymmetric) && all.dim == 2;
            bodies.push((block.name.clone(), mesh.onto_axis()));
        }
        // The stress state counts only if all elements say the same.
        self.of_file.plane =
            said.first().copied().flatten().filter(|plane| said.iter().all(|other| *other == Some(*plane)));
        self.one_section(&bodies)?;
        Mesh::assembly(&bodies).map_err(|error| self.no_block(0, &error)).ok()
    }

    /// A mesh, rotated and moved to its place.
    fn placed(&mut self, path: &str, block: &raw::Block, mut mesh: Mesh) -> Option<Mesh> {
        if let Some(turn) = &block.turn {
            let at = format!("{path}.turn");
            if mesh.dim == 1 {
                self.note(&at, At::Value, "a rotation of a line", "none", Some("remove it"));
                return None;
            }
            self.dim = mesh.dim;
            let axis = self.axis(&at, &turn.axis)?;
            if !self.is_direction(&format!("{at}.axis"), &axis) {
                return None;
            }
            mesh = mesh.turned(&Rotation::about(&axis, turn.angle));
        }
        let at = |c: usize| block.origin.get(c).copied().unwrap_or(0.0);
        Some(mesh.moved([at(0), at(1), at(2)]))
    }

    fn no_block(&mut self, i: usize, error: &MeshError) {
        let expected = error.expected().unwrap_or_else(|| "a block that can be built".to_owned());
        self.note(&format!("mesh.blocks[{i}]"), At::Value, error.found(), expected, None);
    }

    /// Checks that all bodies are half sections of bodies of revolution, or none; `None` if they differ.
    fn one_section(&mut self, bodies: &[(String, Mesh)]) -> Option<()> {
        let first = bodies.first().is_some_and(|(_, mesh)| mesh.axisymmetric);
        let Some(i) = bodies.iter().position(|(_, mesh)| mesh.axisymmetric != first) else { return Some(()) };
        let found = "a body of revolution beside a plane one";
        let hint = "axisymmetric = true in [mesh] makes all of them half sections";
        self.note(&format!("mesh.blocks[{i}]"), At::Value, found, "bodies of one kind", Some(hint));
        None
    }

    /// A block before it is placed, in `dim` dimensions if other blocks exist, or `None` if its entries do not fit.
    fn body(
        &mut self,
        path: &str,
        block: &raw::Block,
        dim: usize,
        axisymmetric: bool,
        sides: &SideNames,
    ) -> Option<UnplacedBlock> {
        let prefixed = |side: &str| format!("{}_{side}", block.name);
        let Some(file) = &block.file else {
            if block.scale.is_some() {
                let hint = Some("remove it, or give a `file`");
                self.note(&format!("{path}.scale"), At::Key, "`scale`", "it only besides a `file`", hint);
                return None;
            }
            let dim = if dim == 0 { dimension(block) } else { dim };
            let (shape, cells) = self.block_shape(path, block, dim)?;
            let of_block: Vec<&str> = sides.contact.iter().filter_map(|on| on.strip_prefix(&*prefixed(""))).collect();
            let size = size(&shape, &cells, &of_block);
            return Some(UnplacedBlock {
                mesh: BlockSource::Shape(shape, cells),
                size: MeshSize { dim, ..size },
                plane: None,
            });
        };
        if let Some(key) = of_generated(block) {
            let hint = Some("remove it: the file has the body");
            self.note(&format!("{path}.{key}"), At::Key, format!("`{key}`"), "it only without a `file`", hint);
            return None;
        }
        let of = FileOf { name: file, scale: block.scale.unwrap_or(1.0), axisymmetric };
        let MeshFromFile { mesh, plane } =
            self.file(&format!("{path}.file"), &of, &|side| sides.used.contains(&prefixed(side).as_str()))?;
        let expected = if dim == 0 { mesh.dim } else { dim };
        if mesh.dim != expected {
            let found = format!("\"{file}\", a body in {} dimensions", mesh.dim);
            let expected = format!("one in {expected}, as the first block is");
            self.note(&format!("{path}.file"), At::Value, found, expected, None);
            return None;
        }
        if !(block.origin.is_empty() || block.origin.len() == mesh.dim) {
            let found = format!("{} numbers", block.origin.len());
            self.note(&format!("{path}.origin"), At::Value, found, format!("{} of them", mesh.dim), None);
            return None;
        }
        let on_contact: Vec<&str> = sides.contact.iter().filter_map(|on| on.strip_prefix(&*prefixed(""))).collect();
        Some(UnplacedBlock { size: measured(&mesh, &on_contact, 0), mesh: BlockSource::File(mesh), plane })
    }

    /// The block as a mesh with its cells, or `None` if its entries do not fit.
    fn block_shape(&mut self, path: &str, block: &raw::Block, dim: usize) -> Option<(raw::Mesh, Vec<usize>)> {
        let (n, elements) = (block.n.clone(), block.elements);
        if n.is_empty() {
            let expected = "an array of integers ≥ 1 (cells per side)";
            self.note(&format!("{path}.n"), At::Missing, "no such key", expected, None);
            return None;
        }
        if let Some((key, expected)) = misplaced(block) {
            self.note(&format!("{path}.{key}"), At::Key, format!("`{key}`"), expected, Some("remove it"));
            return None;
        }
        if block.size.is_empty() == block.radii.is_none() {
            let found = match block.radii {
                Some(_) => "both `size` and `radii`",
                None => "neither `size` nor `radii` nor `file`",
            };
            let expected =
                "one of them: `size` of an interval, rectangle or box, `radii` of a round body, a mesh `file`";
            self.note(path, At::Value, found, expected, None);
            return None;
        }
        if !self.has_dimension(path, block, dim) {
            return None;
        }
        Some((shape_of(block, &n, elements)?, n))
    }

    /// True if all keys of the block have one number for each of the `dim` dimensions.
    fn has_dimension(&mut self, path: &str, block: &raw::Block, dim: usize) -> bool {
        let own = if block.size.is_empty() { "radii" } else { "size" };
        for (key, found) in [(own, dimension(block)), ("n", block.n.len()), ("origin", block.origin.len())] {
            let is_left_out = key == "origin" && found == 0;
            if !is_left_out && (found != dim || !(1..=3).contains(&dim)) {
                let (found, expected) = match dim {
                    1..=3 if key == "radii" => {
                        (format!("a body in {found} dimensions"), format!("one in {dim}, as the first block is"))
                    }
                    1..=3 => (
                        format!("{found} numbers"),
                        format!("{dim} of them, as the first block is in {dim} dimensions"),
                    ),
                    _ => (format!("{found} numbers"), "1, 2 or 3 of them".to_owned()),
                };
                self.note(&format!("{path}.{key}"), At::Value, found, expected, None);
                return false;
            }
        }
        true
    }
}

/// A key without meaning in this block, with the blocks in which it has one.
fn misplaced(block: &raw::Block) -> Option<(&'static str, &'static str)> {
    let is_rectangle = block.size.len() == 2 && matches!(block.elements, raw::Elements::P1 | raw::Elements::P2);
    if block.height.is_some() && block.radii.is_none() {
        Some(("height", "it only besides the `radii` of a cylinder"))
    } else if block.angle.is_some() && block.radii.is_none() {
        Some(("angle", "it only besides the `radii` of a ring or a cylinder"))
    } else if block.diagonal.is_some() && !is_rectangle {
        Some(("diagonal", "it only in a rectangle of triangles, P1 or P2"))
    } else {
        None
    }
}

/// A key of a generated block.
fn of_generated(block: &raw::Block) -> Option<&'static str> {
    let given = [
        ("size", !block.size.is_empty()),
        ("radii", block.radii.is_some()),
        ("height", block.height.is_some()),
        ("angle", block.angle.is_some()),
        ("n", !block.n.is_empty()),
        ("diagonal", block.diagonal.is_some()),
    ];
    given.into_iter().find_map(|(key, is)| is.then_some(key))
}

/// Number of dimensions of a block.
fn dimension(block: &raw::Block) -> usize {
    match block.radii {
        Some(_) if block.size.is_empty() => 2 + usize::from(block.height.is_some()),
        _ => block.size.len(),
    }
}

/// The mesh of a block of the form that its keys give.
fn shape_of(block: &raw::Block, n: &[usize], elements: raw::Elements) -> Option<raw::Mesh> {
    let (refine_where, refined_cells) = (Vec::new(), None);
    let made = match (&block.size[..], block.radii, block.height) {
        (&[size], ..) => raw::Mesh::Interval { size, n: n[0], elements, refine_where, refined_cells },
        (&[x, y], ..) => raw::Mesh::Rectangle {
            size: [x, y],
            n: raw::Cells2::Each([n[0], n[1]]),
            elements,
            diagonal: block.diagonal,
            origin: [0.0; 2],
            axisymmetric: false,
            refine_where,
            refined_cells,
        },
        (&[x, y, z], ..) => raw::Mesh::Box {
            size: [x, y, z],
            n: raw::Cells3::Each([n[0], n[1], n[2]]),
            elements,
            refine_where,
            refined_cells,
        },
        (_, Some(radii), Some(height)) => raw::Mesh::Cylinder {
            radii,
            angle: block.angle,
            height,
            n: raw::Cells3::Each([n[0], n[1], n[2]]),
            elements,
            refine_where,
            refined_cells,
        },
        (_, Some([0.0, radius]), None) if block.angle.is_none() => {
            raw::Mesh::Disc { radius, n: raw::Cells2::Each([n[0], n[1]]), elements, refine_where, refined_cells }
        }
        (_, Some(radii), None) => raw::Mesh::Ring {
            radii,
            angle: block.angle,
            n: raw::Cells2::Each([n[0], n[1]]),
            elements,
            refine_where,
            refined_cells,
        },
        _ => return None,
    };
    Some(made)
}
