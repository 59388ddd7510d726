//! Reads the unstructured grids of a results folder.
//!
//! What is understood is what the writer of a run produces: XML with inline data, as text or as base64 without compression.
//! Every fault of a file is an error that names the array.

use std::collections::BTreeMap;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use quick_xml::events::{BytesStart, Event};

use super::PlotError;

/// Values of an array with their number of components.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Array {
    pub components: usize,
    pub values: Vec<f64>,
}

/// A grid with its data.
#[derive(Clone, Debug, Default)]
pub(super) struct Grid {
    pub points: Vec<[f64; 3]>,
    /// Nodes of the cells, one after the other.
    pub connectivity: Vec<u32>,
    /// Where the nodes of each cell end.
    pub ends: Vec<usize>,
    /// Cell types of VTK.
    pub types: Vec<u8>,
    pub point_data: BTreeMap<String, Array>,
    pub cell_data: BTreeMap<String, Array>,
}

impl Grid {
    /// Nodes of each cell.
    pub(super) fn cells(&self) -> impl Iterator<Item = &[u32]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.connectivity[start..end])
    }
}

/// Reads a grid from a file.
pub(super) fn read(path: &Path) -> Result<Grid, PlotError> {
    let text = super::table::text(path)?;
    parse(&text).map_err(|what| PlotError::Format { path: path.to_owned(), what })
}

/// The data set of the latest time in a collection: its time and file.
pub(super) fn latest(path: &Path) -> Result<(f64, String), PlotError> {
    let text = super::table::text(path)?;
    let fault = |what: String| PlotError::Format { path: path.to_owned(), what };
    let mut reader = quick_xml::Reader::from_str(&text);
    let mut latest: Option<(f64, String)> = None;
    loop {
        match reader.read_event().map_err(|e| fault(e.to_string()))? {
            Event::Start(tag) | Event::Empty(tag) if tag.name().as_ref() == b"DataSet" => {
                let file = attribute(&tag, "file").map_err(fault)?.ok_or_else(|| fault("a DataSet has no file".to_owned()))?;
                let time = attribute(&tag, "timestep").map_err(fault)?.and_then(|t| t.parse::<f64>().ok()).filter(|t| t.is_finite());
                let time = time.ok_or_else(|| fault(format!("the DataSet of {file} has no timestep that is a number")))?;
                if latest.as_ref().is_none_or(|(t, _)| time >= *t) {
                    latest = Some((time, file));
                }
            }
            Event::Eof => break,
            _ => {}
        }
    }
    latest.ok_or_else(|| fault("it names no DataSet".to_owned()))
}

fn attribute(tag: &BytesStart, name: &str) -> Result<Option<String>, String> {
    let found = tag.try_get_attribute(name).map_err(|e| e.to_string())?;
    found.map(|a| a.unescape_value().map(std::borrow::Cow::into_owned).map_err(|e| e.to_string())).transpose()
}

/// How the numbers of a file are stored.
struct Encoding {
    little: bool,
    /// Bytes of the count before each array.
    header: usize,
}

/// A `DataArray` that is being read.
struct Open {
    name: String,
    kind: String,
    format: String,
    components: usize,
    text: String,
}

#[derive(Clone, Copy, PartialEq)]
enum Section {
    Points,
    Cells,
    PointData,
    CellData,
}

fn parse(text: &str) -> Result<Grid, String> {
    let mut reader = quick_xml::Reader::from_str(text);
    let mut encoding = None;
    let mut section = None;
    let mut open: Option<Open> = None;
    let mut arrays: BTreeMap<&str, Array> = BTreeMap::new();
    let mut grid = Grid::default();
    let mut pieces = 0;
    loop {
        let event = reader.read_event().map_err(|e| format!("not well-formed at byte {}: {e}", reader.error_position()))?;
        match event {
            Event::Eof => break,
            Event::Start(tag) | Event::Empty(tag) if tag.name().as_ref() == b"VTKFile" => encoding = Some(head(&tag)?),
            Event::Start(tag) => match tag.name().as_ref() {
                b"Piece" => pieces += 1,
                b"Points" => section = Some(Section::Points),
                b"Cells" => section = Some(Section::Cells),
                b"PointData" => section = Some(Section::PointData),
                b"CellData" => section = Some(Section::CellData),
                b"DataArray" => open = Some(start(&tag)?),
                _ => {}
            },
            Event::Text(part) => {
                if let Some(open) = &mut open {
                    open.text.push_str(&part.unescape().map_err(|e| e.to_string())?);
                }
            }
            Event::End(tag) => match tag.name().as_ref() {
                b"Points" | b"Cells" | b"PointData" | b"CellData" => section = None,
                b"DataArray" => {
                    let (Some(array), Some(section), Some(encoding)) = (open.take(), section, &encoding) else { continue };
                    let values = array.values(encoding)?;
                    let read = Array { components: array.components, values };
                    match (section, array.name.as_str()) {
                        (Section::Points, _) => drop(arrays.insert("points", read)),
                        (Section::Cells, "connectivity") => drop(arrays.insert("connectivity", read)),
                        (Section::Cells, "offsets") => drop(arrays.insert("offsets", read)),
                        (Section::Cells, "types") => drop(arrays.insert("types", read)),
                        (Section::Cells, _) => {}
                        (Section::PointData, _) => drop(grid.point_data.insert(array.name, read)),
                        (Section::CellData, _) => drop(grid.cell_data.insert(array.name, read)),
                    }
                }
                _ => {}
            },
            _ => {}
        }
    }
    if encoding.is_none() || pieces != 1 {
        return Err(format!("expected a VTKFile with one Piece, found {pieces}"));
    }
    let mut take = |name: &str| arrays.remove(name).ok_or_else(|| format!("the array {name} is missing"));
    grid.points = take("points")?.values.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
    grid.connectivity = take("connectivity")?.values.into_iter().map(|v| v as u32).collect();
    grid.ends = take("offsets")?.values.into_iter().map(|v| v as usize).collect();
    grid.types = take("types")?.values.into_iter().map(|v| v as u8).collect();
    check(&grid)?;
    Ok(grid)
}

/// Checks that the arrays fit each other.
fn check(grid: &Grid) -> Result<(), String> {
    let (nodes, cells) = (grid.points.len(), grid.ends.len());
    if grid.types.len() != cells {
        return Err(format!("there are {} cell types for {cells} cells", grid.types.len()));
    }
    let ascending = grid.ends.windows(2).all(|e| e[0] <= e[1]);
    if !ascending || grid.ends.last().is_some_and(|&end| end != grid.connectivity.len()) {
        return Err("the array offsets does not fit the array connectivity".to_owned());
    }
    if let Some(node) = grid.connectivity.iter().find(|&&n| n as usize >= nodes) {
        return Err(format!("a cell has node {node}, but there are {nodes} nodes"));
    }
    for (what, count, data) in [("points", nodes, &grid.point_data), ("cells", cells, &grid.cell_data)] {
        for (name, array) in data {
            if array.values.len() != count * array.components {
                let found = array.values.len();
                return Err(format!("the array {name} has {found} values, expected {} for each of {count} {what}", array.components));
            }
        }
    }
    Ok(())
}

fn head(tag: &BytesStart) -> Result<Encoding, String> {
    if attribute(tag, "compressor")?.is_some_and(|c| !c.is_empty()) {
        return Err("the data are compressed, which is not supported".to_owned());
    }
    let little = match attribute(tag, "byte_order")?.as_deref() {
        Some("LittleEndian") | None => true,
        Some("BigEndian") => false,
        Some(other) => return Err(format!("the byte order {other} is not known")),
    };
    let header = match attribute(tag, "header_type")?.as_deref() {
        Some("UInt32") | None => 4,
        Some("UInt64") => 8,
        Some(other) => return Err(format!("the header type {other} is not known")),
    };
    Ok(Encoding { little, header })
}

fn start(tag: &BytesStart) -> Result<Open, String> {
    let name = attribute(tag, "Name")?.unwrap_or_default();
    let components = attribute(tag, "NumberOfComponents")?.map_or(Ok(1), |n| n.trim().parse::<usize>());
    let components = components.ok().filter(|n| (1..=64).contains(n)).ok_or_else(|| format!("the array {name} has no valid number of components"))?;
    let kind = attribute(tag, "type")?.unwrap_or_default();
    let format = attribute(tag, "format")?.unwrap_or_default();
    Ok(Open { name, kind, format, components, text: String::new() })
}

impl Open {
    fn values(&self, encoding: &Encoding) -> Result<Vec<f64>, String> {
        let fault = |what: &str| format!("the array {}: {what}", self.name);
        let values: Vec<f64> = match self.format.as_str() {
            "ascii" => {
                let read: Result<Vec<f64>, _> = self.text.split_ascii_whitespace().map(str::parse).collect();
                read.map_err(|_| fault("something is not a number"))?
            }
            "binary" => {
                let bytes = STANDARD.decode(self.text.trim()).map_err(|e| fault(&format!("not base64: {e}")))?;
                let (head, body) = bytes.split_at_checked(encoding.header).ok_or_else(|| fault("no data"))?;
                let count = head.iter().enumerate().map(|(i, &b)| u64::from(b) << (8 * if encoding.little { i } else { head.len() - 1 - i })).sum::<u64>();
                if count != body.len() as u64 {
                    return Err(fault(&format!("{} bytes of data, {count} announced", body.len())));
                }
                self.decode(body, encoding.little).ok_or_else(|| fault(&format!("numbers of type {} cannot be read from {count} bytes", self.kind)))?
            }
            other => return Err(fault(&format!("the format {other} is not supported"))),
        };
        if values.iter().all(|v| v.is_finite()) { Ok(values) } else { Err(fault("it has values that are not finite")) }
    }

    fn decode(&self, bytes: &[u8], little: bool) -> Option<Vec<f64>> {
        /// Reads numbers of N bytes.
        fn each<const N: usize>(bytes: &[u8], little: bool, value: impl Fn([u8; N]) -> f64) -> Option<Vec<f64>> {
            let (chunks, rest) = bytes.as_chunks::<N>();
            let in_order = |mut chunk: [u8; N]| {
                if !little {
                    chunk.reverse();
                }
                value(chunk)
            };
            rest.is_empty().then(|| chunks.iter().copied().map(in_order).collect())
        }
        match self.kind.as_str() {
            "Int8" => each(bytes, little, |b| f64::from(i8::from_le_bytes(b))),
            "UInt8" => each(bytes, little, |b| f64::from(u8::from_le_bytes(b))),
            "Int16" => each(bytes, little, |b| f64::from(i16::from_le_bytes(b))),
            "UInt16" => each(bytes, little, |b| f64::from(u16::from_le_bytes(b))),
            "Int32" => each(bytes, little, |b| f64::from(i32::from_le_bytes(b))),
            "UInt32" => each(bytes, little, |b| f64::from(u32::from_le_bytes(b))),
            "Int64" => each(bytes, little, |b| i64::from_le_bytes(b) as f64),
            "UInt64" => each(bytes, little, |b| u64::from_le_bytes(b) as f64),
            "Float32" => each(bytes, little, |b| f64::from(f32::from_le_bytes(b))),
            "Float64" => each(bytes, little, f64::from_le_bytes),
            _ => None,
        }
    }
}
