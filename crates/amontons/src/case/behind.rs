//! The effusivity of bodies at a side, by which they share friction heat out.

use crate::element::{Element, ShapeTable};
use crate::material::Material;
use crate::mesh::{FacetMap, Mesh};
use crate::tensor::dot;

/// √(Kc) of the bodies at a side, c the heat capacity per volume and K the conductivity along the normal.
pub(super) struct Effusivities<'m> {
    mesh: &'m Mesh,
    materials: &'m [Material],
}

impl<'m> Effusivities<'m> {
    pub fn new(mesh: &'m Mesh, materials: &'m [Material]) -> Effusivities<'m> {
        Effusivities { mesh, materials }
    }

    /// The mean over the facets of a side; none of a side that is not there.
    pub fn of(&self, side: &str) -> Option<f64> {
        let set = self.mesh.facets.get(side)?;
        let cells = self.mesh.cells_of(set);
        let of_facet = |((element, nodes), cell): ((&'static Element, &[u32]), &Option<(usize, usize)>)| {
            let block = self.mesh.blocks.get((*cell)?.0)?;
            let material = self.materials.get(block.region).or(self.materials.last())?;
            let table = ShapeTable::at(element, &[element.centre()]);
            let mut map = FacetMap::new(self.mesh, &table);
            map.at(nodes, 0);
            let conductivity = dot(&map.normal, &material.conductivity.at(&map.position).apply(&map.normal));
            Some((conductivity * material.heat_capacity.at(&map.position)).sqrt())
        };
        let all: Vec<f64> = set.facets().zip(&cells).filter_map(of_facet).collect();
        (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
    }
}
