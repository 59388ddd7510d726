#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::PathBuf;

use super::*;
use crate::vtu::{Array, Grid};

const AT: [(usize, f64); 4] = [(0, 0.0), (3, 0.1), (6, 0.2), (7, 0.7)];

/// Two triangles with values that vary between snapshots, except the regions and, at the third, a scalar.
fn grid(index: usize) -> Grid {
    let value = |i: usize| (i as f64 + 0.1).sin() * 10f64.powi(i as i32 - 3) * (index as f64 + 1.0);
    let array =
        |components: usize, tuples: usize| Array { components, values: (0..components * tuples).map(value).collect() };
    let mut grid = Grid {
        points: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, -0.0], [1.0, 0.1, 0.0]],
        connectivity: vec![0, 1, 2, 1, 3, 2],
        ends: vec![3, 6],
        types: vec![5, 5],
        ..Grid::default()
    };
    grid.point_data.insert("displacement".to_owned(), array(3, 4));
    let scalar = Array { components: 1, values: vec![if index == 2 { 1.0 } else { index as f64 }, -0.0, 0.0, 1e-310] };
    grid.point_data.insert("temperature".to_owned(), scalar);
    grid.cell_data.insert("stress".to_owned(), array(6, 2));
    grid.cell_data.insert("region".to_owned(), Array { components: 1, values: vec![0.0, 4_294_967_296.0] });
    grid
}

fn only(mut grid: Grid, wanted: &dyn Fn(&str) -> bool) -> Grid {
    grid.point_data.retain(|name, _| wanted(name));
    grid.cell_data.retain(|name, _| wanted(name));
    grid
}

fn path(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("amontons-vtkhdf-{name}-{}", std::process::id()))
}

fn written(name: &str, room: f64, grid: impl Fn(usize) -> Grid) -> Result<Vec<u8>, String> {
    let path = path(name);
    let source = |index: usize, wanted: &dyn Fn(&str) -> bool| Ok(only(grid(index), wanted));
    let unit = |name: &str| (name == "stress").then(|| "N/m²".to_owned());
    let series = GridSeries { at: &AT, source: &source, unit: &unit, room };
    let result = match write(&path, &series) {
        Ok(()) => Ok(fs::read(&path).unwrap()),
        Err(WriteError::Snapshots(why)) => Err(why),
        Err(WriteError::File(error)) => panic!("{error}"),
    };
    let _ = fs::remove_file(&path);
    result
}

fn opened(name: &str, bytes: &[u8]) -> Result<Vec<Grid>, String> {
    let path = path(name);
    fs::write(&path, bytes).unwrap();
    let read = Reader::open(&path).and_then(|reader| {
        assert_eq!(reader.at(), AT);
        (0..AT.len()).map(|index| reader.grid(index)).collect()
    });
    fs::remove_file(&path).unwrap();
    read
}

fn bits(array: &Array) -> (usize, Vec<u64>) {
    (array.components, array.values.iter().map(|v| v.to_bits()).collect())
}

#[test]
fn what_is_written_is_read_to_the_bit() {
    let bytes = written("round", 1e9, grid).unwrap();
    for (index, read) in opened("round", &bytes).unwrap().into_iter().enumerate() {
        let wrote = grid(index);
        let points = |grid: &Grid| grid.points.iter().flatten().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(points(&read), points(&wrote));
        assert_eq!((&read.connectivity, &read.ends, &read.types), (&wrote.connectivity, &wrote.ends, &wrote.types));
        for (read, wrote) in [(&read.point_data, &wrote.point_data), (&read.cell_data, &wrote.cell_data)] {
            assert!(read.keys().eq(wrote.keys()));
            assert!(read.iter().all(|(name, array)| bits(array) == bits(&wrote[name])));
        }
    }
    // Unchanged values are stored once: the regions, and the scalar of the second and third snapshot.
    let path = path("once");
    fs::write(&path, &bytes).unwrap();
    let file = hdf5_pure::File::open(&path).unwrap();
    let numbers = |name: &str| file.dataset(name).unwrap().read_i64().unwrap();
    assert_eq!(numbers("VTKHDF/Steps/CellDataOffsets/region"), [0; 4]);
    assert_eq!(numbers("VTKHDF/CellData/region"), [0, 4_294_967_296]);
    assert_eq!(numbers("VTKHDF/Steps/PointDataOffsets/temperature"), [0, 4, 4, 8]);
    assert_eq!(file.dataset("VTKHDF/Points").unwrap().shape().unwrap(), [4, 3]);
    let unit = file.dataset("VTKHDF/CellData/stress").unwrap().attrs().unwrap();
    assert_eq!(unit.get("units").and_then(|unit| unit.as_str()), Some("N/m²"));
    fs::remove_file(&path).unwrap();
}

/// With little memory the snapshots are read several times; the file is the same.
#[test]
fn the_bytes_do_not_depend_on_the_memory() {
    let plenty = written("plenty", 1e9, grid).unwrap();
    // The largest array takes 3 · 8 · 12 · 4 bytes.
    assert!(plenty == written("little", 1152.0, grid).unwrap());
    let refused =
        "to compress the array displacement of all snapshots needs 1.2e3 bytes of memory, of which 1.2e3 may be taken";
    assert_eq!(written("none", 1151.0, grid).unwrap_err(), refused);
}

/// A snapshot of another series is reported.
#[test]
fn snapshots_of_different_series_are_refused() {
    let spoiled = |name: &str, spoil: fn(&mut Grid)| {
        let other = |index: usize| {
            let mut grid = grid(index);
            if index == 2 {
                spoil(&mut grid);
            }
            grid
        };
        written(name, 1e9, other).unwrap_err()
    };
    let mesh = "step 6: another mesh than that of the first snapshot";
    assert_eq!(spoiled("points", |grid| grid.points[1][2] = 1e-300), mesh);
    assert_eq!(spoiled("cells", |grid| grid.connectivity.swap(0, 1)), mesh);
    let more = |grid: &mut Grid| drop(grid.cell_data.insert("strain".to_owned(), grid.cell_data["stress"].clone()));
    assert_eq!(spoiled("more", more), "step 6: other arrays than at the first snapshot");
    let renamed = |grid: &mut Grid| {
        let array = grid.cell_data.remove("stress").unwrap();
        grid.cell_data.insert("strain".to_owned(), array);
    };
    assert_eq!(spoiled("renamed", renamed), "step 6: no array stress with the components that it has at first");
}

/// Truncated or corrupted files are read, or refused without a panic.
#[test]
fn damaged_files_are_refused_or_read() {
    let bytes = written("damaged", 1e9, grid).unwrap();
    for end in (0..bytes.len()).step_by(97) {
        assert!(opened("cut", &bytes[..end]).is_err(), "{end}");
    }
    for at in (0..bytes.len()).step_by(7) {
        let mut spoiled = bytes.clone();
        spoiled[at] ^= 0xa5;
        let path = path("spoiled");
        fs::write(&path, &spoiled).unwrap();
        if let Ok(reader) = Reader::open(&path) {
            let _ = (0..reader.at().len().min(4)).map(|index| reader.grid(index)).collect::<Vec<_>>();
        }
    }
    let _ = fs::remove_file(path("spoiled"));
}

/// Chunks hold whole snapshots of small grids and equal parts of large ones, and never more tuples than two bytes can
/// count.
#[test]
fn chunks_have_a_size_that_all_readers_take() {
    assert_eq!(write::chunk(24, [289, 100_000]), 2601);
    assert_eq!(write::chunk(24, [289, 300]), 300);
    assert_eq!(write::chunk(24, [66_049, 1_387_029]), 33_025);
    assert_eq!(write::chunk(8, [66_049, 1_387_029]), 33_025);
    for tuples in [1, 255, 65_535, 65_536, 131_072, 1 << 30] {
        for bytes in [1, 8, 24, 48, 512] {
            let rows = write::chunk(bytes, [tuples, 3 * tuples]);
            assert!((1..=65_535).contains(&rows) && rows <= 3 * tuples, "{rows} of {tuples} tuples of {bytes} bytes");
        }
    }
}
