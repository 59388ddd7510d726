//! What the bodies behind a side are made of, and the size of the side: by these friction heat is shared out, and the
//! side of a pair is chosen that bears the contact points.

use crate::contact::mortar::mean_facet;
use crate::element::{Element, ShapeTable};
use crate::material::Material;
use crate::mesh::{FacetMap, Mesh};
use crate::tensor::dot;

/// The bodies behind the sides of a mesh.
pub(super) struct SideMaterials<'m> {
    mesh: &'m Mesh,
    materials: &'m [Material],
}

impl<'m> SideMaterials<'m> {
    pub fn new(mesh: &'m Mesh, materials: &'m [Material]) -> SideMaterials<'m> {
        SideMaterials { mesh, materials }
    }

    /// √(Kc), c the heat capacity per volume and K the conductivity along the normal, as its mean over the facets of a
    /// side; none of a side that is not there.
    pub fn effusivity(&self, side: &str) -> Option<f64> {
        self.mean(side, |material, map| {
            let conductivity = dot(&map.normal, &material.conductivity.at(&map.position).apply(&map.normal));
            (conductivity * material.heat_capacity.at(&map.position)).sqrt()
        })
    }

    /// m_a of (H2) in Pa, likewise.
    pub fn stiffness(&self, side: &str) -> Option<f64> {
        self.mean(side, |material, _| material.elasticity.constants().monotonicity)
    }

    /// Size of a facet along the side in m, and measure of the side, in m^(d−1).
    pub fn sizes(&self, side: &str) -> [f64; 2] {
        self.mesh.facets.get(side).map_or([0.0; 2], |set| {
            let facet = mean_facet(self.mesh, set);
            [if self.mesh.dim == 3 { facet.sqrt() } else { facet }, facet * set.len() as f64]
        })
    }

    fn mean(&self, side: &str, of: impl Fn(&Material, &FacetMap) -> f64) -> Option<f64> {
        let set = self.mesh.facets.get(side)?;
        let cells = self.mesh.cells_of(set);
        let of_facet = |((element, nodes), cell): ((&'static Element, &[u32]), &Option<(usize, usize)>)| {
            let block = self.mesh.blocks.get((*cell)?.0)?;
            let material = self.materials.get(block.region).or(self.materials.last())?;
            let table = ShapeTable::at(element, &[element.centre()]);
            let mut map = FacetMap::new(self.mesh, &table);
            map.at(nodes, 0);
            Some(of(material, &map))
        };
        let all: Vec<f64> = set.facets().zip(&cells).filter_map(of_facet).collect();
        (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
    }
}
