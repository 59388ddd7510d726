//! Meshes of several blocks: `[[mesh.blocks]]`.

use super::build::Build;
use super::memory::Demand;
use super::mesh::{counts, generate};
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
        let (mut bodies, mut nodes, mut contact_nodes) = (Vec::new(), 0.0, 0.0);
        let dim = blocks.first().map_or(0, |block| block.size.len());
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
            let (_, of_body, on_contact) = counts(&shape, &cells, &of_block);
            (nodes, contact_nodes) = (nodes + of_body, contact_nodes + on_contact);
            let demand = Demand::of(dim, nodes, contact_nodes).solved_by(self.solver);
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
        let n = block.n.clone();
        for (key, found) in [("size", block.size.len()), ("n", n.len()), ("origin", block.origin.len())] {
            let is_left_out = key == "origin" && found == 0;
            if !is_left_out && (found != dim || !(1..=3).contains(&dim)) {
                let expected = match dim {
                    1..=3 => format!("{dim} of them, as `size` of the first block has"),
                    _ => "1, 2 or 3 of them".to_owned(),
                };
                self.note(&format!("{path}.{key}"), At::Value, format!("{found} numbers"), expected, None);
                return None;
            }
        }
        let (size, elements) = (&block.size, block.elements);
        let shape = match size[..] {
            [size] => raw::Mesh::Interval { size, n: n[0], elements },
            [x, y] => raw::Mesh::Rectangle {
                size: [x, y],
                n: raw::Cells2::Each([n[0], n[1]]),
                elements,
                diagonal: block.diagonal,
                origin: [0.0; 2],
                axisymmetric: false,
            },
            [x, y, z] => raw::Mesh::Box { size: [x, y, z], n: raw::Cells3::Each([n[0], n[1], n[2]]), elements },
            _ => return None,
        };
        Some((shape, n))
    }
}
