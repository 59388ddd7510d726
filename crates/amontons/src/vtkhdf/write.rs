//! Writes a series of grids.

use std::path::Path;

use hdf5_pure::{
    AttrValue, DatasetBuilder, File, FileAccessProperties, FileBuilder, FileLocking, SyncPolicy, make_f64_type,
    make_i64_type,
};

use super::{ArrayAssociation, OWN, ROOT, STEPS, WHOLE};
use crate::machine;
use crate::vtu::{Array, Grid};

/// The version of the format: the first one with data over time.
const VERSION: [i64; 2] = [2, 0];
/// Compression level: the fastest. Level 4 saves 3 % more and takes three times as long. Bytes are shuffled first, so
/// that corresponding bytes of the reals are adjacent.
const LEVEL: u32 = 1;
/// Least and largest size of a chunk in bytes: VTK's library caches chunks of up to a megabyte.
const CHUNK: [usize; 2] = [1 << 16, 1 << 20];
/// Largest number of tuples in a chunk: `hdf5-pure` stores larger numbers in four bytes, while HDF5 2.0 expects the
/// minimum.
const LONGEST: usize = u16::MAX as usize;

/// Reads the grid of the snapshot with an index: the mesh, and the arrays whose names are wanted.
pub(crate) type GridSource<'a> = &'a dyn Fn(usize, &dyn Fn(&str) -> bool) -> Result<Grid, String>;

/// Grids over time.
pub(crate) struct GridSeries<'a> {
    /// Steps and times of the snapshots, at least one.
    pub at: &'a [(usize, f64)],
    /// The grids.
    pub source: GridSource<'a>,
    /// The unit of an array; `None` if it has none.
    pub unit: &'a dyn Fn(&str) -> Option<String>,
    /// Bytes of memory available for array values.
    pub room: f64,
}

impl GridSeries<'_> {
    /// Memory for values: a part of the free memory, in bytes.
    pub fn room() -> f64 {
        machine::memory().map_or(1e9, |memory| memory.bytes / 8.0)
    }
}

/// Reason why a series is not written.
#[derive(Debug)]
pub(crate) enum WriteError {
    /// The snapshots do not form one series.
    Snapshots(String),
    /// The file cannot be written.
    File(hdf5_pure::Error),
}

impl From<hdf5_pure::Error> for WriteError {
    fn from(error: hdf5_pure::Error) -> WriteError {
        WriteError::File(error)
    }
}

/// An array that all snapshots have.
struct ArrayLayout {
    place: ArrayAssociation,
    name: String,
    components: usize,
    /// Number of tuples per snapshot.
    tuples: usize,
}

/// The values of an array at all snapshots.
struct PackedArray<'a> {
    layout: &'a ArrayLayout,
    bytes: Vec<u8>,
    /// Offsets of the values of each snapshot, in tuples.
    offsets: Vec<i64>,
    /// The last values added.
    last: Vec<f64>,
}

/// Writes a series into a new file.
///
/// The snapshots are read repeatedly if the values of all arrays do not fit into memory; arrays are written one by one,
/// so that the bytes of the file do not depend on the memory.
///
/// # Errors
/// Fails if the snapshots do not all have the same mesh and arrays, if one array does not fit into memory, or if the
/// file cannot be written.
pub(crate) fn write(path: &Path, series: &GridSeries) -> Result<(), WriteError> {
    let mut mesh = (series.source)(0, &|_| true).map_err(WriteError::Snapshots)?;
    let layouts = layouts(&mesh);
    (mesh.point_data, mesh.cell_data) = Default::default();
    let batches = batches(&layouts, series)?;
    skeleton(&mesh, series.at).write(path)?;
    // The file is known to nobody else and needs no lock. The last call makes sure that it is on the disk.
    let properties =
        FileAccessProperties::new().with_locking(FileLocking::Disabled).with_sync_policy(SyncPolicy::OnClose);
    let file = File::open_rw_with_options(path, properties)?;
    for batch in batches {
        for column in gather(batch, layouts.len(), &mesh, series)? {
            column.store(&file, series)?;
        }
    }
    file.close()?;
    Ok(())
}

/// The arrays of a grid.
fn layouts(grid: &Grid) -> Vec<ArrayLayout> {
    let of = |place: ArrayAssociation, tuples: usize| {
        let arrays = data(grid, place).iter();
        arrays.map(move |(name, array)| ArrayLayout { place, name: name.clone(), components: array.components, tuples })
    };
    of(ArrayAssociation::Points, grid.points.len()).chain(of(ArrayAssociation::Cells, grid.types.len())).collect()
}

fn data(grid: &Grid, place: ArrayAssociation) -> &std::collections::BTreeMap<String, Array> {
    match place {
        ArrayAssociation::Points => &grid.point_data,
        ArrayAssociation::Cells => &grid.cell_data,
    }
}

/// Splits arrays into batches whose values fit into memory.
fn batches<'a>(layouts: &'a [ArrayLayout], series: &GridSeries) -> Result<Vec<&'a [ArrayLayout]>, WriteError> {
    // Values, their bytes, and the compressed bytes.
    let bytes = |layout: &ArrayLayout| 3.0 * 8.0 * (layout.components * layout.tuples * series.at.len()) as f64;
    let (mut all, mut first, mut taken) = (Vec::new(), 0, 0.0);
    for (i, layout) in layouts.iter().enumerate() {
        if bytes(layout) > series.room {
            let ArrayLayout { name, .. } = layout;
            let [needed, room] = [bytes(layout), series.room];
            return Err(WriteError::Snapshots(format!(
                "to compress the array {name} of all snapshots needs {needed:.1e} bytes of memory, of which {room:.1e} may be taken"
            )));
        }
        if taken + bytes(layout) > series.room {
            all.push(&layouts[first..i]);
            (first, taken) = (i, 0.0);
        }
        taken += bytes(layout);
    }
    all.push(&layouts[first..]);
    Ok(all)
}

/// The file without the values of the arrays.
fn skeleton(mesh: &Grid, at: &[(usize, f64)]) -> FileBuilder {
    let mut file = FileBuilder::new();
    let mut root = file.create_group(ROOT);
    root.set_attr("Version", AttrValue::I64Array(VERSION.to_vec()));
    root.set_attr("Type", AttrValue::AsciiString("UnstructuredGrid".to_owned()));
    let counts = [
        ("NumberOfPoints", mesh.points.len()),
        ("NumberOfCells", mesh.types.len()),
        ("NumberOfConnectivityIds", mesh.connectivity.len()),
    ];
    for (name, count) in counts {
        root.create_dataset(name).with_i64_data(&[count as i64]);
    }
    let shape = [mesh.points.len() as u64, 3];
    let points = mesh.points.as_flattened();
    compress(root.create_dataset("Points").with_f64_data(points).with_shape(&shape), [3, 8], [mesh.points.len(); 2]);
    let connectivity: Vec<i64> = mesh.connectivity.iter().map(|&node| i64::from(node)).collect();
    compress(root.create_dataset("Connectivity").with_i64_data(&connectivity), [1, 8], [connectivity.len(); 2]);
    let offsets: Vec<i64> = std::iter::once(0).chain(mesh.ends.iter().map(|&end| end as i64)).collect();
    compress(root.create_dataset("Offsets").with_i64_data(&offsets), [1, 8], [offsets.len(); 2]);
    compress(root.create_dataset("Types").with_u8_data(&mesh.types), [1, 1], [mesh.types.len(); 2]);
    for place in ArrayAssociation::ALL {
        let group = root.create_group(place.data()).finish();
        root.add_group(group);
    }
    let mut steps = root.create_group("Steps");
    steps.set_attr("NSteps", AttrValue::I64(at.len() as i64));
    steps.create_dataset("Values").with_f64_data(&at.iter().map(|(_, t)| *t).collect::<Vec<_>>());
    // One part at all times, the initial one.
    let (parts, none) = (vec![1; at.len()], vec![0; at.len()]);
    steps.create_dataset("NumberOfParts").with_i64_data(&parts);
    for name in ["PartOffsets", "PointOffsets"] {
        steps.create_dataset(name).with_i64_data(&none);
    }
    for name in ["CellOffsets", "ConnectivityIdOffsets"] {
        steps.create_dataset(name).with_i64_data(&none).with_shape(&[at.len() as u64, 1]);
    }
    for place in ArrayAssociation::ALL {
        let group = steps.create_group(place.offsets()).finish();
        steps.add_group(group);
    }
    root.add_group(steps.finish());
    file.add_group(root.finish());
    let mut own = file.create_group(OWN);
    own.create_dataset(STEPS).with_i64_data(&at.iter().map(|(step, _)| *step as i64).collect::<Vec<_>>());
    file.add_group(own.finish());
    file
}

/// Sets up compressed chunks for a dataset.
fn compress(dataset: &mut DatasetBuilder, [components, size]: [usize; 2], counts: [usize; 2]) {
    let rows = chunk(components * size, counts) as u64;
    let shape = if components > 1 { vec![rows, components as u64] } else { vec![rows] };
    dataset.with_chunks(&shape).with_shuffle().with_deflate(LEVEL);
}

/// Number of tuples in a chunk, for tuples of `bytes` bytes, `tuples` per snapshot and `all` in total.
pub(super) fn chunk(bytes: usize, [tuples, all]: [usize; 2]) -> usize {
    let [least, most] = CHUNK.map(|bound| (bound / bytes).min(LONGEST));
    let rows = match tuples.max(1) {
        tuples if tuples < least => tuples * (least / tuples),
        // Parts of about equal size, the last of which ends about where the snapshot does.
        tuples => tuples.div_ceil(tuples.div_ceil(most)),
    };
    rows.clamp(1, all.max(1))
}

/// Reads the values of some of the arrays at all snapshots.
fn gather<'a>(
    batch: &'a [ArrayLayout],
    arrays: usize,
    mesh: &Grid,
    series: &GridSeries,
) -> Result<Vec<PackedArray<'a>>, WriteError> {
    let column = |layout| PackedArray { layout, bytes: Vec::new(), offsets: Vec::new(), last: Vec::new() };
    let mut columns: Vec<PackedArray> = batch.iter().map(column).collect();
    for (i, (step, _)) in series.at.iter().enumerate() {
        let refuse = |what: String| WriteError::Snapshots(format!("step {step}: {what}"));
        let is_whole = batch.len() == arrays;
        let wanted = |name: &str| is_whole || batch.iter().any(|layout| layout.name == name);
        let grid = (series.source)(i, &wanted).map_err(refuse)?;
        let same =
            grid.points.iter().flatten().map(|x| x.to_bits()).eq(mesh.points.iter().flatten().map(|x| x.to_bits()))
                && (&grid.connectivity, &grid.ends, &grid.types) == (&mesh.connectivity, &mesh.ends, &mesh.types);
        if !same {
            return Err(refuse("another mesh than that of the first snapshot".to_owned()));
        }
        if grid.point_data.len() + grid.cell_data.len() != columns.len() {
            return Err(refuse("other arrays than at the first snapshot".to_owned()));
        }
        for column in &mut columns {
            let ArrayLayout { place, name, components, .. } = column.layout;
            match data(&grid, *place).get(name).filter(|array| array.components == *components) {
                Some(array) => column.push(&array.values),
                None => return Err(refuse(format!("no array {name} with the components that it has at first"))),
            }
        }
    }
    Ok(columns)
}

impl PackedArray<'_> {
    /// True if the values are whole numbers.
    fn is_whole(&self) -> bool {
        WHOLE.contains(&self.layout.name.as_str())
    }

    /// Appends the values of a snapshot, unless they equal the last ones.
    fn push(&mut self, values: &[f64]) {
        let same = values.iter().map(|v| v.to_bits()).eq(self.last.iter().map(|v| v.to_bits()));
        if !same || self.offsets.is_empty() {
            if self.is_whole() {
                self.bytes.extend(values.iter().flat_map(|&value| (value as i64).to_le_bytes()));
            } else {
                self.bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
            }
            self.last = values.to_vec();
        }
        self.offsets.push((self.bytes.len() / (8 * self.layout.components) - self.layout.tuples) as i64);
    }

    /// Writes the values and the offsets of the snapshots into a file.
    fn store(self, file: &File, series: &GridSeries) -> Result<(), WriteError> {
        let kind = if self.is_whole() { make_i64_type() } else { make_f64_type() };
        let ArrayLayout { place, name, components, tuples } = self.layout;
        let count = self.bytes.len() as u64 / 8;
        let root = file.root();
        root.create_dataset(&format!("{ROOT}/{}/{name}", place.data()), |dataset| {
            dataset.with_raw_data(kind, self.bytes, count);
            if *components > 1 {
                dataset.with_shape(&[count / *components as u64, *components as u64]);
            }
            compress(dataset, [*components, 8], [*tuples, count as usize / *components]);
            if let Some(unit) = (series.unit)(name) {
                dataset.set_attr("units", AttrValue::String(unit));
            }
        })?;
        root.create_dataset(&format!("{ROOT}/Steps/{}/{name}", place.offsets()), |dataset| {
            dataset.with_i64_data(&self.offsets);
        })?;
        // One array per commit, regardless of the available memory.
        file.commit()?;
        Ok(())
    }
}
