//! The sections `$ElementData` and `$NodeData` of an MSH file.

use std::collections::HashMap;

use super::super::data::Values;
use super::super::read::{MeshFileError, complete_data};
use super::cursor::Cursor;
use super::sections::{self, NodeTags};
use crate::mesh::Block;
use crate::tensor::Point;

/// Element or node numbers with one value each.
pub(super) struct DataSection {
    of_elements: bool,
    values: Vec<(i64, f64)>,
}

/// Reads the data section at the cursor if it has the wanted name, or skips it.
pub(super) fn section(cursor: &mut Cursor, word: &[u8], wanted: &str) -> Result<Option<DataSection>, MeshFileError> {
    let texts = cursor.text_integer("the number of string tags")?;
    cursor.line();
    let mut name = String::new();
    for i in 0..texts {
        let line = cursor.line().trim_ascii();
        let text = line.strip_prefix(b"\"").and_then(|line| line.strip_suffix(b"\"")).unwrap_or(line);
        if i == 0 {
            name = String::from_utf8_lossy(text).into_owned();
        }
    }
    if name != wanted {
        cursor.skip_section(word)?;
        return Ok(None);
    }
    for _ in 0..cursor.text_integer("the number of real tags")? {
        cursor.token();
    }
    let at = cursor.word_position();
    let integers = cursor.text_integer("the number of integer tags")?;
    let mut tags = [0; 3];
    for i in 0..integers {
        let tag = cursor.text_integer("an integer tag of data")?;
        if let Some(kept) = usize::try_from(i).ok().and_then(|i| tags.get_mut(i)) {
            *kept = tag;
        }
    }
    let [_, components, count] = tags;
    if components != 1 {
        return Err(cursor.fault(at, format!("data \"{wanted}\" of one component")));
    }
    let count = u64::try_from(count).map_err(|_| cursor.fault(at, "the number of values"))?;
    let count = cursor.fits(at, "values", count, 2, 12)?;
    cursor.begin_data();
    let mut values = Vec::with_capacity(count);
    for _ in 0..count {
        values.push((cursor.integer("the tag of an element or a node")?, cursor.real("a value")?));
    }
    let of_elements = word == b"$ElementData";
    cursor.end_section(if of_elements { "ElementData" } else { "NodeData" })?;
    Ok(Some(DataSection { of_elements, values }))
}

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
