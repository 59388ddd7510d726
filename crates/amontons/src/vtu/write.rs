//! Writes an unstructured grid with arrays compressed by zlib.

use std::borrow::Cow;
use std::io::{self, Write};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use miniz_oxide::deflate::compress_to_vec_zlib;
use rayon::prelude::*;

/// Block size of compression in bytes, as in VTK: blocks are independent, so threads share them.
const BLOCK: usize = 1 << 15;
/// Compression level: the fastest. Reals compress little on any level, node numbers much on every one.
const LEVEL: u8 = 1;

/// An array of numbers with its name.
pub(crate) struct WrittenArray<'a> {
    pub name: Cow<'a, str>,
    pub components: usize,
    pub values: ArrayNumbers<'a>,
}

/// Numbers of an array.
pub(crate) enum ArrayNumbers<'a> {
    Reals(Cow<'a, [f64]>),
    /// Reals that are made when they are written: the arrays of a file are not in memory together.
    Made(Box<dyn Fn() -> Vec<f64> + 'a>),
    /// Node numbers and similar, which may exceed 32 bits.
    Counts(Vec<i64>),
    Codes(Vec<u8>),
}

impl<'a> WrittenArray<'a> {
    /// An array of reals.
    pub fn reals(
        name: impl Into<Cow<'a, str>>,
        components: usize,
        values: impl Into<Cow<'a, [f64]>>,
    ) -> WrittenArray<'a> {
        WrittenArray { name: name.into(), components, values: ArrayNumbers::Reals(values.into()) }
    }

    /// An array of reals that `make` makes when the array is written.
    pub fn made(
        name: impl Into<Cow<'a, str>>,
        components: usize,
        make: impl Fn() -> Vec<f64> + 'a,
    ) -> WrittenArray<'a> {
        WrittenArray { name: name.into(), components, values: ArrayNumbers::Made(Box::new(make)) }
    }

    /// An array of whole numbers.
    pub fn counts(name: impl Into<Cow<'a, str>>, values: Vec<i64>) -> WrittenArray<'a> {
        WrittenArray { name: name.into(), components: 1, values: ArrayNumbers::Counts(values) }
    }

    fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let (kind, packed) = match &self.values {
            ArrayNumbers::Reals(values) => ("Float64", PackedBlocks::of(values, f64::to_le_bytes)),
            ArrayNumbers::Made(make) => ("Float64", PackedBlocks::of(&make(), f64::to_le_bytes)),
            ArrayNumbers::Counts(values) => ("Int64", PackedBlocks::of(values, i64::to_le_bytes)),
            ArrayNumbers::Codes(values) => ("UInt8", PackedBlocks::of(values, u8::to_le_bytes)),
        };
        let WrittenArray { name, components, .. } = self;
        // For scalars with an explicit single component, readers create columns.
        let components = if *components == 1 { String::new() } else { format!(" NumberOfComponents=\"{components}\"") };
        write!(out, "<DataArray type=\"{kind}\" Name=\"{name}\"{components} format=\"binary\">")?;
        packed.write(out)?;
        writeln!(out, "</DataArray>")
    }
}

/// Numbers of an array, compressed block by block.
struct PackedBlocks {
    blocks: Vec<Vec<u8>>,
    /// Size of the last block in bytes if it is shorter than the others, else zero.
    rest: usize,
}

impl PackedBlocks {
    /// Compresses numbers of N bytes each.
    fn of<T: Copy + Sync, const N: usize>(numbers: &[T], bytes: fn(T) -> [u8; N]) -> PackedBlocks {
        let pack = |block: &[T]| {
            let mut raw = Vec::with_capacity(block.len() * N);
            for number in block {
                raw.extend_from_slice(&bytes(*number));
            }
            compress_to_vec_zlib(&raw, LEVEL)
        };
        PackedBlocks { blocks: numbers.par_chunks(BLOCK / N).map(pack).collect(), rest: numbers.len() * N % BLOCK }
    }

    /// Writes the header, the number of blocks, the size of a block, that of the last one if it is shorter, and the
    /// compressed size of each, and then the blocks, both in base64.
    fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let sizes = self.blocks.iter().map(Vec::len);
        let header = [self.blocks.len(), BLOCK, self.rest].into_iter().chain(sizes);
        let header: Vec<u8> = header.flat_map(|count| (count as u64).to_le_bytes()).collect();
        out.write_all(STANDARD.encode(header).as_bytes())?;
        let mut encoded = EncoderWriter::new(out, &STANDARD);
        self.blocks.iter().try_for_each(|block| encoded.write_all(block))?;
        encoded.finish().map(|_| ())
    }
}

/// The cells of a grid.
pub(crate) struct Cells {
    pub connectivity: Vec<i64>,
    /// End of the nodes of each cell in `connectivity`.
    pub ends: Vec<i64>,
    /// Cell types of VTK.
    pub types: Vec<u8>,
}

/// Writes a grid with data at its points and cells.
///
/// # Errors
/// Fails if the destination cannot be written.
pub(crate) fn write(
    out: &mut dyn Write,
    points: &[[f64; 3]],
    cells: Cells,
    point_data: &[WrittenArray],
    cell_data: &[WrittenArray],
) -> io::Result<()> {
    writeln!(out, "<?xml version=\"1.0\"?>")?;
    writeln!(
        out,
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">"
    )?;
    writeln!(out, "<UnstructuredGrid>")?;
    writeln!(out, "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">", points.len(), cells.types.len())?;
    let section = |out: &mut dyn Write, name: &str, arrays: &[WrittenArray]| -> io::Result<()> {
        writeln!(out, "<{name}>")?;
        arrays.iter().try_for_each(|array| array.write(out))?;
        writeln!(out, "</{name}>")
    };
    section(out, "PointData", point_data)?;
    section(out, "CellData", cell_data)?;
    section(out, "Points", &[WrittenArray::reals("Points", 3, points.as_flattened())])?;
    let Cells { connectivity, ends, types } = cells;
    let types = WrittenArray { name: "types".into(), components: 1, values: ArrayNumbers::Codes(types) };
    let cells = [WrittenArray::counts("connectivity", connectivity), WrittenArray::counts("offsets", ends), types];
    section(out, "Cells", &cells)?;
    writeln!(out, "</Piece>\n</UnstructuredGrid>\n</VTKFile>")
}
