//! Cell or node data of a mesh file, as a function of the position.

use std::sync::Arc;

use super::locator::{CellBoxes, CellPlace, Locator};
use super::read::{MeshFileError, Values};
use super::surface::SurfaceLocator;
use super::{Block, Mesh, gmsh, vtu};
use crate::field::Field;
use crate::tensor::Point;

/// Data of a mesh: one value per cell, constant in it, or one per node, interpolated by the shape functions.
#[derive(Debug)]
pub struct MeshData {
    mesh: Mesh,
    grid: Arc<CellBoxes>,
    /// Locator of the cells as a surface, if the mesh is one.
    surface: Option<SurfaceLocator>,
    values: Values,
}

impl MeshData {
    /// The data `name` of a file, in the format of its extension: cell data or, if missing, node data; `scale` is the
    /// factor of its coordinates.
    ///
    /// # Errors
    /// Fails if the bytes are no mesh, or if the mesh has no such data with one value per cell or node.
    pub fn read(file: &str, bytes: &[u8], name: &str, scale: f64) -> Result<MeshData, MeshFileError> {
        let is_gmsh = file.to_lowercase().ends_with(".msh");
        let (mut points, cells, values) = if is_gmsh { gmsh::data(bytes, name) } else { vtu::data(bytes, name) }?;
        points.iter_mut().flatten().for_each(|x| *x *= scale);
        let dim = cells.first().map_or(1, |block: &Block| block.element.dim());
        let regions = vec![String::new()];
        let mesh = Mesh {
            dim,
            points,
            blocks: cells,
            regions,
            facets: std::collections::BTreeMap::new(),
            edges: std::collections::BTreeMap::new(),
            axisymmetric: false,
            thickness: None,
        };
        let grid = Arc::new(CellBoxes::new(&mesh));
        Ok(MeshData { mesh, grid, surface: None, values })
    }

    /// The dimension of the cells.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.mesh.dim
    }

    /// Treats the mesh as a surface in a space of one more dimension: a point has the value of the nearest point of the
    /// surface, if that is near.
    #[must_use]
    pub fn on_surface(self) -> MeshData {
        MeshData { surface: Some(SurfaceLocator::new(&self.mesh)), ..self }
    }

    /// The value at a point; NaN outside the mesh. On the boundary between cells with cell data it is their mean.
    #[must_use]
    pub fn value(&self, x: &Point) -> f64 {
        if let Some(surface) = &self.surface {
            return self.above(&surface.below(&self.mesh, x));
        }
        let locator = Locator::of(&self.mesh, Arc::clone(&self.grid));
        match &self.values {
            Values::Cells(values) => {
                let found = locator.around(x);
                let of = |&(block, cell): &(usize, usize)| values[block][cell];
                if let [only] = found.as_slice() {
                    return of(only);
                }
                found.iter().map(of).sum::<f64>() / found.len() as f64
            }
            Values::Nodes(values) => locator.locate(x).map_or(f64::NAN, |(nodes, shapes)| {
                nodes.iter().zip(shapes).map(|(&node, shape)| shape * values[node as usize]).sum()
            }),
        }
    }

    /// The mean of the values at positions in cells.
    fn above(&self, places: &[(CellPlace, Point)]) -> f64 {
        let value = |&((block, cell), x): &(CellPlace, Point)| match &self.values {
            Values::Cells(values) => values[block as usize][cell as usize],
            Values::Nodes(values) => {
                let (element, nodes) = self.mesh.cell_at((block, cell));
                let mut shapes = vec![0.0; nodes.len()];
                (element.shape_functions)(&x, &mut shapes);
                nodes.iter().zip(shapes).map(|(&node, shape)| shape * values[node as usize]).sum()
            }
        };
        places.iter().map(value).sum::<f64>() / places.len() as f64
    }

    /// The data as a field, times a factor.
    #[must_use]
    pub fn into_field(self, factor: Field) -> Field {
        match factor {
            Field::Constant(factor) => Field::of_space(move |x| factor * self.value(x)),
            factor => Field::of_space(move |x| factor.value(x, 0.0) * self.value(x)),
        }
    }
}
