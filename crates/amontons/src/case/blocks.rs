//! Meshes of several blocks: `[[mesh.blocks]]`.

use super::build::Build;
use super::memory::{Demand, Size};
use super::mesh::{generate, size};
use super::place::At;
use super::raw;
use crate::machine::Memory;
use crate::mesh::{Mesh, MeshError};

impl Build<'_> {
    /// The mesh of several blocks, of which `contact_on` bear contact; none where it cannot be had.
    pub fn blocks(
        &mut self,
        blocks: &[raw::Block],
        axisymmetric: bool,
        contact_on: &[&str],
        available: Option<Memory>,
    ) -> Option<Mesh> {
        let dim = blocks.first().map_or(0, dimension);
        let (mut bodies, mut all) = (Vec::new(), Size { dim, ..Size::default() });
        for (i, block) in blocks.iter().enumerate() {
            let path = format!("mesh.blocks[{i}]");
            if blocks[..i].iter().any(|other| other.name == block.name) {
                let found = format!("\"{}\" again", block.name);
                self.note(&format!("{path}.name"), At::Value, found, "a name of its own for each block", None);
                return None;
            }
            let (shape, cells) = self.block_shape(&path, block, dim)?;
            let of_block: Vec<&str> =
                contact_on.iter().filter_map(|on| on.strip_prefix(block.name.as_str())?.strip_prefix('_')).collect();
            let own = size(&shape, &cells, &of_block);
            all.nodes += own.nodes;
            all.contact_nodes += own.contact_nodes;
            all.neighbours = all.neighbours.max(own.neighbours);
            let demand = Demand::of(&all, self.solver);
            if !self.affordable(&path, "the blocks", "take fewer cells", &demand, available) {
                return None;
            }
            bodies.push((i, block, generate(&shape, &cells)));
        }
        let made = bodies.into_iter().map(|(i, block, mesh)| {
            let at = |c: usize| block.origin.get(c).copied().unwrap_or(0.0);
            let mut mesh = mesh.map_err(|error| (i, error))?.moved([at(0), at(1), at(2)]);
            mesh.axisymmetric = axisymmetric && dim == 2;
            Ok((block.name.clone(), mesh))
        });
        let made: Result<Vec<(String, Mesh)>, (usize, MeshError)> = made.collect();
        match made.and_then(|bodies| Mesh::assembly(&bodies).map_err(|error| (0, error))) {
            Ok(mesh) => Some(mesh),
            Err((i, error)) => {
                let expected = error.expected().unwrap_or_else(|| "a block that can be built".to_owned());
                self.note(&format!("mesh.blocks[{i}]"), At::Value, error.found(), expected, None);
                None
            }
        }
    }

    /// The block as a mesh of its own, and its cells; none where its entries do not fit.
    fn block_shape(&mut self, path: &str, block: &raw::Block, dim: usize) -> Option<(raw::Mesh, Vec<usize>)> {
        let (n, elements) = (block.n.clone(), block.elements);
        if let Some((key, expected)) = misplaced(block) {
            self.note(&format!("{path}.{key}"), At::Key, format!("`{key}`"), expected, Some("remove it"));
            return None;
        }
        if block.size.is_empty() == block.radii.is_none() {
            let found = if block.radii.is_some() { "both `size` and `radii`" } else { "neither `size` nor `radii`" };
            let expected = "one of them: `size` of an interval, rectangle or box, `radii` of a round body";
            self.note(path, At::Value, found, expected, None);
            return None;
        }
        if !self.has_dimension(path, block, dim) {
            return None;
        }
        let shape = match (&block.size[..], block.radii, block.height) {
            (&[size], ..) => raw::Mesh::Interval { size, n: n[0], elements },
            (&[x, y], ..) => raw::Mesh::Rectangle {
                size: [x, y],
                n: raw::Cells2::Each([n[0], n[1]]),
                elements,
                diagonal: block.diagonal,
                origin: [0.0; 2],
                axisymmetric: false,
            },
            (&[x, y, z], ..) => raw::Mesh::Box { size: [x, y, z], n: raw::Cells3::Each([n[0], n[1], n[2]]), elements },
            (_, Some(radii), Some(height)) => raw::Mesh::Cylinder {
                radii,
                angle: block.angle,
                height,
                n: raw::Cells3::Each([n[0], n[1], n[2]]),
                elements,
            },
            (_, Some([0.0, radius]), None) if block.angle.is_none() => {
                raw::Mesh::Disc { radius, n: raw::Cells2::Each([n[0], n[1]]), elements }
            }
            (_, Some(radii), None) => {
                raw::Mesh::Ring { radii, angle: block.angle, n: raw::Cells2::Each([n[0], n[1]]), elements }
            }
            _ => return None,
        };
        Some((shape, n))
    }

    /// Whether all keys of the block have a number for each of the `dim` dimensions.
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

/// A key that means nothing in a block, and where it does.
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

/// In how many dimensions a block is.
fn dimension(block: &raw::Block) -> usize {
    match block.radii {
        Some(_) if block.size.is_empty() => 2 + usize::from(block.height.is_some()),
        _ => block.size.len(),
    }
}
