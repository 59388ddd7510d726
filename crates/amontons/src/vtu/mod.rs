//! XML files of VTK with one unstructured grid.
//!
//! Arrays may be inline, as text or base64, or appended, raw or as base64; each with or without zlib compression. Every
//! fault of a file is an error that names the array.

mod array;
pub(crate) mod write;

use std::collections::BTreeMap;

use array::{Encoding, Open};
use quick_xml::events::{BytesStart, Event};

use crate::machine;

/// Values of an array with their number of components.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Array {
    pub components: usize,
    pub values: Vec<f64>,
}

/// A grid with its data.
#[derive(Clone, Debug, Default)]
pub(crate) struct Grid {
    pub points: Vec<[f64; 3]>,
    /// Nodes of all cells, concatenated.
    pub connectivity: Vec<u32>,
    /// End of the nodes of each cell in `connectivity`.
    pub ends: Vec<usize>,
    /// Cell types of VTK.
    pub types: Vec<u8>,
    pub point_data: BTreeMap<String, Array>,
    pub cell_data: BTreeMap<String, Array>,
}

impl Grid {
    /// Nodes of each cell.
    pub(crate) fn cells(&self) -> impl Iterator<Item = &[u32]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.connectivity[start..end])
    }
}

/// An attribute of an XML element.
pub(crate) fn attribute(tag: &BytesStart, name: &str) -> Result<Option<String>, String> {
    let found = tag.try_get_attribute(name).map_err(|e| e.to_string())?;
    found.map(|a| a.unescape_value().map(std::borrow::Cow::into_owned).map_err(|e| e.to_string())).transpose()
}

#[derive(Clone, Copy, PartialEq)]
enum VtuSection {
    Points,
    Cells,
    PointData,
    CellData,
}

/// The XML part of a file: its undecoded arrays and the appended bytes.
struct Document<'a> {
    encoding: Encoding,
    arrays: Vec<(VtuSection, Open)>,
    appended: Appended<'a>,
    /// Numbers of points and of cells declared by the piece.
    counts: [u64; 2],
}

/// Largest number of nodes of a supported cell type.
const MOST_NODES: u64 = 64;

impl Document<'_> {
    /// Size that the piece allows for an array.
    fn room(&self, section: VtuSection, name: &str) -> ArrayRoom {
        let [points, cells] = self.counts;
        let (tuples, is_exact) = match section {
            VtuSection::Points | VtuSection::PointData => (points, true),
            VtuSection::Cells if name == "connectivity" => (cells.saturating_mul(MOST_NODES), false),
            VtuSection::Cells | VtuSection::CellData => (cells, true),
        };
        ArrayRoom { tuples, is_exact, numbers: u64::MAX }
    }
}

/// Allowed size of an array.
#[derive(Clone, Copy)]
struct ArrayRoom {
    /// Number of tuples, exact if `is_exact` is true, else an upper bound.
    tuples: u64,
    is_exact: bool,
    /// Largest number of values.
    numbers: u64,
}

impl ArrayRoom {
    /// Limits the number of values.
    fn within(self, numbers: u64) -> ArrayRoom {
        ArrayRoom { numbers, ..self }
    }

    /// True if an array of `bytes` bytes, with `size` bytes per number, has an allowed size.
    fn takes(self, bytes: u128, size: u64, components: usize) -> bool {
        let most = u128::from(self.tuples) * u128::from(size) * components as u128;
        let fits = if self.is_exact { bytes == most } else { bytes <= most };
        fits && bytes / u128::from(size.max(1)) <= u128::from(self.numbers)
    }
}

/// Bytes after the XML part, starting after the underscore.
struct Appended<'a> {
    bytes: &'a [u8],
    base64: bool,
}

/// Reads a grid, and those of its point and cell data whose names are wanted.
pub(crate) fn parse(bytes: &[u8], wanted: impl Fn(&str) -> bool) -> Result<Grid, String> {
    let mut document = document(bytes)?;
    let arrays = std::mem::take(&mut document.arrays);
    // Counts may be wrong, and all that is read must fit into a part of the memory; a run takes many times as much.
    let mut budget = machine::memory().map_or(u64::MAX, |memory| (memory.bytes / 8.0) as u64);
    let mut grid = Grid::default();
    let mut parts: BTreeMap<String, Array> = BTreeMap::new();
    for (section, open) in arrays {
        let part = match section {
            VtuSection::Points => "points".to_owned(),
            VtuSection::Cells if matches!(open.name.as_str(), "connectivity" | "offsets" | "types") => {
                open.name.clone()
            }
            VtuSection::PointData | VtuSection::CellData if wanted(&open.name) => String::new(),
            _ => continue,
        };
        let room = document.room(section, &open.name).within(budget / 8);
        let values = open.values(&document.encoding, &document.appended, room)?;
        budget = budget.saturating_sub(8 * values.len() as u64);
        let read = Array { components: open.components, values };
        drop(match section {
            VtuSection::PointData => grid.point_data.insert(open.name, read),
            VtuSection::CellData => grid.cell_data.insert(open.name, read),
            VtuSection::Points | VtuSection::Cells => parts.insert(part, read),
        });
    }
    let mut take = |name: &str| parts.remove(name).ok_or_else(|| format!("the array {name} is missing"));
    let points = take("points")?;
    if points.components != 3 || points.values.len() % 3 != 0 {
        return Err(format!(
            "the array points has {} values of {} components, not 3 per node",
            points.values.len(),
            points.components
        ));
    }
    grid.points = points.values.as_chunks::<3>().0.to_vec();
    grid.connectivity =
        whole("connectivity", take("connectivity")?, f64::from(u32::MAX))?.into_iter().map(|v| v as u32).collect();
    grid.ends = whole("offsets", take("offsets")?, f64::from(u32::MAX))?.into_iter().map(|v| v as usize).collect();
    grid.types = whole("types", take("types")?, f64::from(u8::MAX))?.into_iter().map(|v| v as u8).collect();
    check(&grid)?;
    Ok(grid)
}

/// The values of an array, checked to be integers from 0 to `largest`.
fn whole(name: &str, array: Array, largest: f64) -> Result<Vec<f64>, String> {
    match array.values.iter().find(|v| !(0.0..=largest).contains(*v) || v.fract() != 0.0) {
        Some(found) => Err(format!("the array {name} has the value {found}, not integers from 0 to {largest}")),
        None => Ok(array.values),
    }
}

fn document(bytes: &[u8]) -> Result<Document<'_>, String> {
    let mut reader = quick_xml::Reader::from_reader(bytes);
    let (mut encoding, mut section, mut pieces) = (None, None, 0);
    let mut counts = [0; 2];
    // An array may contain keys with text of their own.
    let mut inside_key = false;
    let mut open: Option<Open> = None;
    let mut arrays = Vec::new();
    let mut appended = Appended { bytes: &[], base64: false };
    loop {
        let event =
            reader.read_event().map_err(|e| format!("not well-formed at byte {}: {e}", reader.error_position()))?;
        match event {
            Event::Eof => break,
            Event::Start(tag) | Event::Empty(tag) if tag.name().as_ref() == b"VTKFile" => {
                encoding = Some(Encoding::of(&tag)?);
            }
            Event::Start(tag) => match tag.name().as_ref() {
                b"Piece" => (pieces, counts) = (pieces + 1, announced(&tag)?),
                b"Points" => section = Some(VtuSection::Points),
                b"Cells" => section = Some(VtuSection::Cells),
                b"PointData" => section = Some(VtuSection::PointData),
                b"CellData" => section = Some(VtuSection::CellData),
                b"DataArray" => open = Some(Open::of(&tag)?),
                b"InformationKey" => inside_key = true,
                b"AppendedData" => {
                    appended = behind_underscore(bytes, reader.buffer_position(), &tag)?;
                    break;
                }
                _ => {}
            },
            // Appended arrays have nothing between their tags.
            Event::Empty(tag) if tag.name().as_ref() == b"DataArray" => {
                arrays.extend(section.map(|s| Open::of(&tag).map(|open| (s, open))).transpose()?);
            }
            Event::Text(part) => {
                if let Some(open) = open.as_mut().filter(|_| !inside_key) {
                    open.text.push_str(&part.unescape().map_err(|e| e.to_string())?);
                }
            }
            Event::End(tag) => match tag.name().as_ref() {
                b"Points" | b"Cells" | b"PointData" | b"CellData" => section = None,
                b"InformationKey" => inside_key = false,
                b"DataArray" => arrays.extend(section.zip(open.take())),
                _ => {}
            },
            _ => {}
        }
    }
    match encoding {
        Some(encoding) if pieces == 1 => Ok(Document { encoding, arrays, appended, counts }),
        _ => Err(format!("expected a VTKFile with one Piece, found {pieces}")),
    }
}

/// The numbers of points and cells declared by a piece.
fn announced(tag: &BytesStart) -> Result<[u64; 2], String> {
    let count = |name: &str| -> Result<u64, String> {
        // Without a count there is no room for compressed data; other data are counted as they are read.
        let Some(text) = attribute(tag, name)? else { return Ok(0) };
        let count = text.trim().parse::<u32>();
        count.map(u64::from).map_err(|_| format!("{name} is {text:?}, expected a number of at most {}", u32::MAX))
    };
    Ok([count("NumberOfPoints")?, count("NumberOfCells")?])
}

/// The appended data after the underscore behind the opening tag. Raw bytes are no XML, so the XML ends there.
fn behind_underscore<'a>(bytes: &'a [u8], position: u64, tag: &BytesStart) -> Result<Appended<'a>, String> {
    let base64 = match attribute(tag, "encoding")?.as_deref() {
        Some("raw") => false,
        Some("base64") => true,
        other => return Err(format!("the encoding of the appended data is {other:?}, not raw or base64")),
    };
    let rest = usize::try_from(position).ok().and_then(|at| bytes.get(at..)).unwrap_or_default().trim_ascii_start();
    let rest = rest.strip_prefix(b"_").ok_or("the appended data do not begin with an underscore")?;
    let end = if base64 { rest.iter().position(|&b| b == b'<').unwrap_or(rest.len()) } else { rest.len() };
    Ok(Appended { bytes: &rest[..end], base64 })
}

/// Checks that the arrays are consistent.
pub(crate) fn check(grid: &Grid) -> Result<(), String> {
    let (nodes, cells) = (grid.points.len(), grid.ends.len());
    if grid.types.len() != cells {
        return Err(format!("there are {} cell types for {cells} cells", grid.types.len()));
    }
    let ascending = grid.ends.windows(2).all(|e| e[0] <= e[1]);
    if !ascending || grid.ends.last().copied().unwrap_or(0) != grid.connectivity.len() {
        return Err("the array offsets does not fit the array connectivity".to_owned());
    }
    if let Some(node) = grid.connectivity.iter().find(|&&n| n as usize >= nodes) {
        return Err(format!("a cell has node {node}, but there are {nodes} nodes"));
    }
    for (what, count, data) in [("points", nodes, &grid.point_data), ("cells", cells, &grid.cell_data)] {
        for (name, array) in data {
            if array.values.len() != count * array.components {
                let found = array.values.len();
                return Err(format!(
                    "the array {name} has {found} values, not {} for each of {count} {what}",
                    array.components
                ));
            }
        }
    }
    Ok(())
}
