//! Several bodies in one mesh.

use super::{Mesh, MeshError};
use crate::tensor::Rotation;

impl Mesh {
    /// Joins bodies into one mesh; bodies that touch keep separate nodes. A body with one region becomes a region with
    /// the name of the body; other regions and all facet sets are prefixed by the name of the body, as in `pad_top`.
    ///
    /// # Errors
    /// Fails if there are more nodes than can be numbered.
    pub fn assembly(bodies: &[(String, Mesh)]) -> Result<Mesh, MeshError> {
        let count: usize = bodies.iter().map(|(_, mesh)| mesh.points.len()).sum();
        if u32::try_from(count).is_err() {
            return Err(MeshError::TooLarge { found: count as f64 });
        }
        let mut all = Mesh {
            dim: bodies.iter().map(|(_, mesh)| mesh.dim).max().unwrap_or(1),
            axisymmetric: bodies.iter().any(|(_, mesh)| mesh.axisymmetric),
            thickness: bodies.iter().find_map(|(_, mesh)| mesh.thickness),
            points: Vec::with_capacity(count),
            blocks: Vec::new(),
            regions: Vec::new(),
            facets: std::collections::BTreeMap::new(),
            edges: std::collections::BTreeMap::new(),
        };
        for (name, mesh) in bodies {
            let (first, first_region) = (all.points.len() as u32, all.regions.len());
            match mesh.regions.len() {
                0 | 1 => all.regions.push(name.clone()),
                _ => all.regions.extend(mesh.regions.iter().map(|region| format!("{name}_{region}"))),
            }
            all.points.extend_from_slice(&mesh.points);
            for mut block in mesh.blocks.iter().cloned() {
                block.region += first_region;
                block.nodes.iter_mut().for_each(|node| *node += first);
                all.blocks.push(block);
            }
            for (of, into) in [(&mesh.facets, &mut all.facets), (&mesh.edges, &mut all.edges)] {
                for (side, mut set) in of.clone() {
                    for node in set.blocks.iter_mut().flat_map(|block| &mut block.nodes) {
                        *node += first;
                    }
                    into.insert(format!("{name}_{side}"), set);
                }
            }
        }
        Ok(all)
    }

    /// Turns the mesh about the origin.
    #[must_use]
    pub fn turned(mut self, by: &Rotation) -> Mesh {
        for x in &mut self.points {
            *x = by.vector(x);
        }
        self
    }

    /// Moves the mesh by a vector in m.
    #[must_use]
    pub fn moved(mut self, by: [f64; 3]) -> Mesh {
        for x in &mut self.points {
            *x = std::array::from_fn(|c| x[c] + by[c]);
        }
        self
    }
}
