//! Arrays of numbers of a page, compressed together.
//!
//! Each array is a sequence of integers. The differences of successive numbers are written byte by byte: first the
//! lowest bytes of all, then the next. Slowly varying data then compress well, without loss.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// Number of steps between two ends; the largest 16-bit number stands for a missing value.
pub(super) const PARTS: f64 = 65_534.0;
pub(super) const NONE: u32 = 65_535;
const LEVEL: u8 = 8;

/// Arrays of numbers, referred to by their index.
#[derive(Debug, Default)]
pub(super) struct Pack {
    bytes: Vec<u8>,
    /// Start, length and bytes per number of each array.
    places: Vec<[usize; 3]>,
}

impl Pack {
    fn add(&mut self, values: impl Iterator<Item = u32>, width: usize) -> usize {
        let mut last = 0u32;
        let steps: Vec<u32> = values.map(|v| v.wrapping_sub(std::mem::replace(&mut last, v))).collect();
        self.places.push([self.bytes.len(), steps.len(), width]);
        for byte in 0..width {
            self.bytes.extend(steps.iter().map(|step| (step >> (8 * byte)) as u8));
        }
        self.places.len() - 1
    }

    /// Adds integers.
    pub(super) fn counts(&mut self, values: &[u32]) -> usize {
        self.add(values.iter().copied(), 4)
    }

    /// Adds numbers in single precision, seven digits.
    pub(super) fn reals(&mut self, values: impl IntoIterator<Item = f64>) -> usize {
        self.add(values.into_iter().map(|v| (v as f32).to_bits()), 4)
    }

    /// Adds numbers between two ends, rounded to 1/[`PARTS`] of their distance; NaN stays NaN.
    pub(super) fn shares(&mut self, values: impl IntoIterator<Item = f64>, [low, high]: [f64; 2]) -> usize {
        let share = |v: f64| match (v - low) / (high - low) {
            share if share.is_finite() => (share.clamp(0.0, 1.0) * PARTS).round() as u32,
            _ if v.is_finite() => 0,
            _ => NONE,
        };
        self.add(values.into_iter().map(share), 2)
    }

    /// Start, length and bytes per number of each array, and the arrays as text.
    pub(super) fn finish(self) -> (Vec<[usize; 3]>, String) {
        (self.places, STANDARD.encode(miniz_oxide::deflate::compress_to_vec_zlib(&self.bytes, LEVEL)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sums of the differences are the numbers.
    #[test]
    fn arrays_can_be_read_back() {
        let mut pack = Pack::default();
        pack.counts(&[7, 3, u32::MAX]);
        pack.shares([2.0, 4.0, 3.0, f64::NAN], [2.0, 4.0]);
        let bytes = pack.bytes.clone();
        let (places, _) = pack.finish();
        let read = |i: usize| {
            let [start, count, width] = places[i];
            let mut sum = 0u32;
            let step = |k| (0..width).map(|b| u32::from(bytes[start + b * count + k]) << (8 * b)).sum::<u32>();
            let mut next = |k| {
                sum = sum.wrapping_add(step(k));
                if width == 2 { sum & 0xFFFF } else { sum }
            };
            (0..count).map(&mut next).collect::<Vec<u32>>()
        };
        assert_eq!(read(0), [7, 3, u32::MAX]);
        assert_eq!(read(1), [0, 65_534, 32_767, 65_535]);
    }
}
