//! The numbers of one array, in the encodings of VTK's XML files.

use std::borrow::Cow;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use miniz_oxide::inflate::decompress_to_vec_zlib_with_limit;
use quick_xml::events::BytesStart;

use super::{Appended, ArrayRoom, attribute};

/// Storage format of the numbers of a file.
pub(super) struct Encoding {
    little: bool,
    /// Bytes of the counts in front of each array.
    header: usize,
    /// True if arrays are compressed by zlib.
    zlib: bool,
}

impl Encoding {
    pub(super) fn of(tag: &BytesStart) -> Result<Encoding, String> {
        let zlib = match attribute(tag, "compressor")?.as_deref() {
            None | Some("") => false,
            Some("vtkZLibDataCompressor") => true,
            Some(other) => {
                return Err(format!("the data are compressed by {other}, which is not supported; try zlib or none"));
            }
        };
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
        Ok(Encoding { little, header, zlib })
    }

    /// Splits a count off the front of some bytes.
    fn count<'a>(&self, bytes: &'a [u8]) -> Option<(u64, &'a [u8])> {
        let (head, rest) = bytes.split_at_checked(self.header)?;
        let shift = |i: usize| 8 * if self.little { i } else { head.len() - 1 - i };
        Some((head.iter().enumerate().map(|(i, &b)| u64::from(b) << shift(i)).sum(), rest))
    }

    /// The data after their header, if `takes` accepts their number of bytes.
    fn unpack(&self, bytes: &[u8], takes: impl Fn(u128) -> bool) -> Result<Vec<u8>, String> {
        let (count, body) = self.count(bytes).ok_or("no data")?;
        if self.zlib {
            return self.inflate(count, body, takes);
        }
        let data = usize::try_from(count).ok().and_then(|count| body.get(..count));
        data.map(<[u8]>::to_vec).ok_or_else(|| format!("{} bytes of data, {count} announced", body.len()))
    }

    /// Decompresses data: after the number of blocks follow the size of a block, the size of the last block (0: like
    /// the others), the compressed size of each, and the blocks.
    fn inflate(&self, blocks: u64, body: &[u8], takes: impl Fn(u128) -> bool) -> Result<Vec<u8>, String> {
        let damaged = || "the compressed data are damaged".to_owned();
        let (size, body) = self.count(body).ok_or_else(damaged)?;
        let (last, mut body) = self.count(body).ok_or_else(damaged)?;
        if blocks > (body.len() / self.header) as u64 {
            return Err(damaged());
        }
        let of_last = if last > 0 { last } else { size };
        let announced = u128::from(size) * u128::from(blocks.saturating_sub(1)) + u128::from(of_last);
        if blocks > 0 && !takes(announced) {
            return Err(format!(
                "{announced} bytes of data are announced, expected as many as the counts of the file, and the memory, allow"
            ));
        }
        let mut sizes = Vec::new();
        for _ in 0..blocks {
            let (compressed, rest) = self.count(body).ok_or_else(damaged)?;
            sizes.push(usize::try_from(compressed).map_err(|_| damaged())?);
            body = rest;
        }
        let mut data = Vec::new();
        for (i, &compressed) in sizes.iter().enumerate() {
            let (block, rest) = body.split_at_checked(compressed).ok_or_else(damaged)?;
            let expected = if i + 1 == sizes.len() { of_last } else { size };
            let expected = usize::try_from(expected).map_err(|_| damaged())?;
            let inflated = decompress_to_vec_zlib_with_limit(block, expected)
                .ok()
                .filter(|inflated| inflated.len() == expected)
                .ok_or_else(damaged)?;
            data.extend(inflated);
            body = rest;
        }
        Ok(data)
    }
}

/// A `DataArray` as in the file.
pub(super) struct Open {
    pub name: String,
    kind: String,
    format: String,
    pub components: usize,
    offset: Option<usize>,
    pub text: String,
}

impl Open {
    pub(super) fn of(tag: &BytesStart) -> Result<Open, String> {
        let name = attribute(tag, "Name")?.unwrap_or_default();
        let components = attribute(tag, "NumberOfComponents")?.map_or(Ok(1), |n| n.trim().parse::<usize>());
        let components = components
            .ok()
            .filter(|n| (1..=64).contains(n))
            .ok_or_else(|| format!("the array {name} has no valid number of components"))?;
        let kind = attribute(tag, "type")?.unwrap_or_default();
        let format = attribute(tag, "format")?.unwrap_or_default();
        let offset = attribute(tag, "offset")?.and_then(|o| o.trim().parse().ok());
        Ok(Open { name, kind, format, components, offset, text: String::new() })
    }

    /// The numbers of the array.
    pub(super) fn values(&self, encoding: &Encoding, appended: &Appended, room: ArrayRoom) -> Result<Vec<f64>, String> {
        let fault = |what: &str| format!("the array {}: {what}", self.name);
        let base64 = |text: &[u8]| decode(text).map_err(|e| fault(&format!("not base64: {e}")));
        let packed = match self.format.as_str() {
            "ascii" => {
                let read: Result<Vec<f64>, _> = self.text.split_ascii_whitespace().map(str::parse).collect();
                return self.finite(read.map_err(|_| fault("something is not a number"))?);
            }
            "binary" => Cow::Owned(base64(self.text.as_bytes())?),
            "appended" => {
                let from = self
                    .offset
                    .and_then(|at| appended.bytes.get(at..))
                    .ok_or_else(|| fault("its offset is not within the appended data"))?;
                if appended.base64 { Cow::Owned(base64(from)?) } else { Cow::Borrowed(from) }
            }
            other => return Err(fault(&format!("the format {other} is not supported"))),
        };
        let size = self.size().ok_or_else(|| fault(&format!("numbers of type {} are not supported", self.kind)))?;
        let data =
            encoding.unpack(&packed, |bytes| room.takes(bytes, size, self.components)).map_err(|what| fault(&what))?;
        let count = data.len();
        self.finite(
            self.numbers(&data, encoding.little)
                .ok_or_else(|| fault(&format!("numbers of type {} cannot be read from {count} bytes", self.kind)))?,
        )
    }

    /// Bytes per number.
    fn size(&self) -> Option<u64> {
        let digits = self.kind.trim_start_matches(|c: char| c.is_ascii_alphabetic());
        matches!(digits, "8" | "16" | "32" | "64").then(|| digits.parse::<u64>().ok()).flatten().map(|bits| bits / 8)
    }

    fn finite(&self, values: Vec<f64>) -> Result<Vec<f64>, String> {
        if values.iter().all(|v| v.is_finite()) {
            Ok(values)
        } else {
            Err(format!("the array {}: it has values that are not finite", self.name))
        }
    }

    fn numbers(&self, bytes: &[u8], little: bool) -> Option<Vec<f64>> {
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

/// Decodes consecutive pieces of base64: header and blocks of a compressed array are padded separately.
fn decode(text: &[u8]) -> Result<Vec<u8>, base64::DecodeError> {
    let text: Vec<u8> = text.iter().copied().filter(|b| !b.is_ascii_whitespace()).collect();
    let mut data = Vec::with_capacity(text.len() / 4 * 3);
    let mut rest = text.as_slice();
    while !rest.is_empty() {
        let padding = rest.iter().position(|&b| b == b'=').unwrap_or(rest.len());
        let end = padding + rest[padding..].iter().take_while(|&&b| b == b'=').count();
        STANDARD.decode_vec(&rest[..end], &mut data)?;
        rest = &rest[end..];
    }
    Ok(data)
}
