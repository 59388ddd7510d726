//! Values of the cells or the nodes of a mesh file, as a function of the position.

use std::sync::Arc;

use super::locator::{Grid, Locator};
use super::read::MeshFileError;
use super::{Block, Mesh, gmsh, vtu};
use crate::field::Field;
use crate::tensor::Point;

/// Values of a mesh: one per cell, constant in it, or one per node, by the shape functions between them.
#[derive(Debug)]
pub struct MeshData {
    mesh: Mesh,
    grid: Arc<Grid>,
    values: Values,
}

/// Values by block and cell, or by node.
#[derive(Debug)]
pub(in crate::mesh) enum Values {
    Cells(Vec<Vec<f64>>),
    Nodes(Vec<f64>),
}

impl MeshData {
    /// The data `name` of a file with this name, in the format of its extension: of the cells or, without such, of the
    /// nodes; `scale` is the factor of its coordinates.
    ///
    /// # Errors
    /// When the bytes are no mesh, or the mesh has no such data with one value per cell or node.
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
            axisymmetric: false,
        };
        let grid = Arc::new(Grid::new(&mesh));
        Ok(MeshData { mesh, grid, values })
    }

    /// The value at a point; NaN outside the mesh. On the boundary of cells with values of their own it is the mean of
    /// those that meet there.
    #[must_use]
    pub fn value(&self, x: &Point) -> f64 {
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

    /// The values as a field, times a factor.
    #[must_use]
    pub fn into_field(self, factor: Field) -> Field {
        match factor {
            Field::Constant(factor) => Field::of_space(move |x| factor * self.value(x)),
            factor => Field::of_space(move |x| factor.value(x, 0.0) * self.value(x)),
        }
    }
}
