//! The sections `$ElementData` and `$NodeData` of an MSH file.

use std::collections::HashMap;

use super::super::read::{MeshFileError, Values, complete_data};
use super::sections::{self, DataSection, NodeTags};
use crate::mesh::Block;
use crate::tensor::Point;

/// The points of a file, its cells of the highest dimension by element, and the data `name` of these cells or of the
/// points.
pub(in crate::mesh) fn data(bytes: &[u8], name: &str) -> Result<(Vec<Point>, Vec<Block>, Values), MeshFileError> {
    let (mut points, tags, mut cells, section) = sections::with_data(bytes, name)?;
    let Some(DataSection { of_elements, values }) = section else {
        let message = format!("no data \"{name}\", expected $ElementData or $NodeData with this name");
        return Err(MeshFileError::Grid { message });
    };
    let dim = cells.iter().map(|block| block.kind.dim).max().unwrap_or(0);
    cells.retain(|block| block.kind.dim == dim && dim > 0 && block.kind.element.is_some());
    let mut by_cell: Vec<Vec<f64>> = Vec::new();
    let by_number: HashMap<i64, f64> = values.iter().copied().collect();
    let mut missing = 0;
    for block in &cells {
        let value = |number: &i64| by_number.get(number).copied();
        let own: Vec<Option<f64>> = block.numbers.iter().map(value).collect();
        missing += own.iter().filter(|value| value.is_none()).count();
        by_cell.push(own.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect());
    }
    if of_elements {
        let all: usize = by_cell.iter().map(Vec::len).sum();
        if missing > 0 {
            let found = format!("the data \"{name}\" lack {missing} of {all} cells");
            return Err(MeshFileError::Grid { message: format!("{found}, expected a value per cell") });
        }
        let blocks = complete_data(&mut points, &mut Vec::new(), cells);
        return Ok((points, blocks, Values::Cells(by_cell)));
    }
    let mut nodes = of_nodes(&tags, points.len(), &values);
    let blocks = complete_data(&mut points, &mut nodes, cells);
    Ok((points, blocks, Values::Nodes(nodes)))
}

/// Values per node; NaN for nodes without one.
fn of_nodes(tags: &NodeTags, count: usize, values: &[(i64, f64)]) -> Vec<f64> {
    let mut nodes = vec![f64::NAN; count];
    for &(tag, value) in values {
        if let Some(node) = tags.index(tag).and_then(|index| nodes.get_mut(index as usize)) {
            *node = value;
        }
    }
    nodes
}
