//! Several bodies in one mesh.

use super::{Mesh, MeshError};

impl Mesh {
    /// Bodies side by side, whether they touch or not: the nodes of each remain its own. The regions are the bodies by
    /// their names, the facet sets those of each body after its name, `pad_top`.
    ///
    /// # Errors
    /// When there are more nodes than can be numbered.
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
            regions: bodies.iter().map(|(name, _)| name.clone()).collect(),
            facets: std::collections::BTreeMap::new(),
            edges: std::collections::BTreeMap::new(),
        };
        for (region, (name, mesh)) in bodies.iter().enumerate() {
            let first = all.points.len() as u32;
            all.points.extend_from_slice(&mesh.points);
            for mut block in mesh.blocks.iter().cloned() {
                block.region = region;
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

    /// The same mesh elsewhere.
    #[must_use]
    pub fn moved(mut self, by: [f64; 3]) -> Mesh {
        for x in &mut self.points {
            *x = std::array::from_fn(|c| x[c] + by[c]);
        }
        self
    }
}
