//! Reads a series of grids written by this program.

use std::collections::BTreeMap;
use std::path::Path;

use hdf5_pure::{AttrValue, Dataset, File};

use super::{ArrayAssociation, OWN, ROOT, STEPS};
use crate::machine;
use crate::vtu::{self, Array, Grid};

/// Largest number of nodes of a cell, and of components of an array.
const MOST: u64 = 64;

/// A file read snapshot by snapshot.
#[derive(Debug)]
pub(crate) struct Reader {
    file: File,
    at: Vec<(usize, f64)>,
    points: u64,
    cells: u64,
    /// Numbers that may be read per snapshot: counts may be wrong, and the data must fit into a part of the memory.
    most: u64,
}

/// Converts an error of the HDF5 library.
fn told(name: &str) -> impl Fn(hdf5_pure::Error) -> String + '_ {
    move |error| format!("{name} cannot be read: {error}")
}

impl Reader {
    /// Opens a file and reads its times.
    ///
    /// # Errors
    /// The fault of the file.
    pub fn open(path: &Path) -> Result<Reader, String> {
        // The library would wait for a pipe.
        machine::open(path).map_err(|error| format!("cannot be read: {error}"))?;
        let file = File::open_streaming(path).map_err(|error| format!("cannot be read: {error}"))?;
        let most = machine::memory().map_or(u64::MAX, |memory| (memory.bytes / 64.0) as u64);
        let mut reader = Reader { file, at: Vec::new(), points: 0, cells: 0, most };
        let kind = reader.file.group(ROOT).and_then(|root| root.attrs()).map_err(told(ROOT))?;
        match kind.get("Type") {
            Some(AttrValue::AsciiString(kind) | AttrValue::String(kind)) if kind == "UnstructuredGrid" => {}
            _ => return Err("it has no unstructured grid".to_owned()),
        }
        let steps = reader.whole(&format!("{OWN}/{STEPS}"), most)?;
        let times = reader.dataset(&format!("{ROOT}/Steps/Values"), &[steps.len() as u64])?.read_f64();
        let times = times.map_err(told("Steps/Values"))?;
        if times.iter().any(|t| !t.is_finite()) || steps.is_empty() {
            return Err("it has no steps, or times that are not numbers".to_owned());
        }
        let step = |step: i64| usize::try_from(step).map_err(|_| format!("it has a step {step}"));
        reader.at = steps.into_iter().zip(times).map(|(n, t)| Ok((step(n)?, t))).collect::<Result<_, String>>()?;
        (reader.points, reader.cells) = (reader.count("NumberOfPoints")?, reader.count("NumberOfCells")?);
        Ok(reader)
    }

    /// Reads a dataset with one count.
    fn count(&self, name: &str) -> Result<u64, String> {
        let found = self.whole(&format!("{ROOT}/{name}"), 1)?;
        let count = found.first().and_then(|&n| u32::try_from(n).ok());
        count.map(u64::from).ok_or_else(|| format!("{name} is not a number of at most {}", u32::MAX))
    }

    /// Steps and times of the snapshots.
    pub fn at(&self) -> &[(usize, f64)] {
        &self.at
    }

    /// The grid of the snapshot with an index, with all its data.
    ///
    /// # Errors
    /// The fault of the file.
    pub fn grid(&self, index: usize) -> Result<Grid, String> {
        let points = self.reals("Points", 0, [self.points, 3])?;
        let connectivity = self.whole(&format!("{ROOT}/Connectivity"), self.cells.saturating_mul(MOST))?;
        let node = |node: i64| u32::try_from(node).map_err(|_| format!("a cell has node {node}"));
        let mut offsets = self.whole(&format!("{ROOT}/Offsets"), self.cells + 1)?.into_iter();
        if offsets.next() != Some(0) {
            return Err("Offsets do not begin with 0".to_owned());
        }
        let end = |end: i64| usize::try_from(end).map_err(|_| format!("the nodes of a cell end at {end}"));
        let types = self.dataset(&format!("{ROOT}/Types"), &[self.cells])?.read_u8().map_err(told("Types"))?;
        let mut grid = Grid {
            points: points.as_chunks::<3>().0.to_vec(),
            connectivity: connectivity.into_iter().map(node).collect::<Result<_, String>>()?,
            ends: offsets.map(end).collect::<Result<_, String>>()?,
            types,
            ..Grid::default()
        };
        (grid.point_data, grid.cell_data) =
            (self.data(ArrayAssociation::Points, index)?, self.data(ArrayAssociation::Cells, index)?);
        vtu::check(&grid)?;
        Ok(grid)
    }

    /// The arrays at the points or cells of a snapshot.
    fn data(&self, place: ArrayAssociation, index: usize) -> Result<BTreeMap<String, Array>, String> {
        let tuples = if place == ArrayAssociation::Points { self.points } else { self.cells };
        let names = self.file.group(&format!("{ROOT}/{}", place.data())).and_then(|group| group.datasets());
        let mut arrays = BTreeMap::new();
        for name in names.map_err(told(place.data()))? {
            let offsets = self.whole(&format!("{ROOT}/Steps/{}/{name}", place.offsets()), self.at.len() as u64)?;
            let offset = offsets.get(index).and_then(|&offset| u64::try_from(offset).ok());
            let offset = offset.ok_or_else(|| format!("the values of {name} at snapshot {index} have no place"))?;
            let path = format!("{}/{name}", place.data());
            let components = match self.shape(&format!("{ROOT}/{path}"))?.as_slice() {
                [_] => 1,
                [_, components] if (1..=MOST).contains(components) => *components,
                shape => return Err(format!("{path} has the shape {shape:?}")),
            };
            let values = self.reals(&path, offset, [tuples, components])?;
            arrays.insert(name, Array { components: components as usize, values });
        }
        Ok(arrays)
    }

    fn shape(&self, path: &str) -> Result<Vec<u64>, String> {
        self.file.dataset(path).and_then(|dataset| dataset.shape()).map_err(told(path))
    }

    /// The dataset of a path; fails if its shape is not the expected one.
    fn dataset(&self, path: &str, expected: &[u64]) -> Result<Dataset, String> {
        let dataset = self.file.dataset(path).map_err(told(path))?;
        let shape = dataset.shape().map_err(told(path))?;
        if shape != expected {
            return Err(format!("{path} has the shape {shape:?}, expected {expected:?}"));
        }
        Ok(dataset)
    }

    /// The integers of a dataset with at most `most` of them.
    fn whole(&self, path: &str, most: u64) -> Result<Vec<i64>, String> {
        let found = self.shape(path)?.iter().fold(1, |all: u64, n| all.saturating_mul(*n));
        if found > most.min(self.most) {
            return Err(format!("{path} has {found} numbers, expected at most {}", most.min(self.most)));
        }
        self.file.dataset(path).and_then(|dataset| dataset.read_i64()).map_err(told(path))
    }

    /// Tuples of reals from an offset in a dataset.
    fn reals(&self, name: &str, offset: u64, [tuples, components]: [u64; 2]) -> Result<Vec<f64>, String> {
        let path = format!("{ROOT}/{name}");
        let there = self.shape(&path)?;
        let fits = offset.checked_add(tuples).is_some_and(|end| there.first().is_some_and(|rows| end <= *rows));
        if !fits || tuples.saturating_mul(components) > self.most {
            return Err(format!("{name} has the shape {there:?}, expected {tuples} tuples from {offset} on"));
        }
        let dataset = self.file.dataset(&path).map_err(told(name))?;
        let values = dataset.read_f64_rows(offset, tuples).map_err(told(name))?;
        match values.iter().find(|value| !value.is_finite()) {
            Some(value) => Err(format!("{name} has the value {value}")),
            None => Ok(values),
        }
    }
}
