//! The matrix of a level, as its products read it: in single precision, and of rows that repeat, as on a uniform mesh,
//! the numbers are stored once and stay in the caches.

use super::blocks::{Blocks, multiply};
use crate::linalg::pages::Numbers;
use crate::linalg::repeats;

/// How far an entry may be from that of another row to be the same, as a share of the largest of its row: well below
/// the last bit of single precision.
const SAME: f64 = 1e-9;

/// A square matrix of N × N blocks by compressed block rows.
#[derive(Debug)]
pub(super) struct Stored {
    /// Rows and columns of a block.
    pub size: usize,
    start: Vec<u32>,
    columns: Vec<u32>,
    values: Values,
}

/// The blocks.
#[derive(Debug)]
enum Values {
    /// Row by row.
    InOrder(Numbers<f32>),
    /// Those of rows that differ: where each row begins among the blocks. The first so many blocks may be those of
    /// several rows; the others are of one row each.
    Repeated { places: Vec<u32>, values: Vec<f32>, shared: usize },
}

impl Stored {
    /// A matrix over a number.
    pub fn new(matrix: &Blocks<f64>, scale: f64) -> Stored {
        let values = repeated(matrix, scale).unwrap_or_else(|| Values::InOrder(matrix.single(scale).values));
        Stored { size: matrix.shape[0], start: matrix.start.clone(), columns: matrix.columns.clone(), values }
    }

    /// The columns of the blocks of a row, and the blocks one after the other.
    fn row(&self, i: usize) -> (&[u32], &[f32]) {
        let (from, to, size) = (self.start[i] as usize, self.start[i + 1] as usize, self.size * self.size);
        let values = match &self.values {
            Values::InOrder(values) => &values[from * size..to * size],
            Values::Repeated { places, values, .. } => &values[places[i] as usize * size..][..(to - from) * size],
        };
        (&self.columns[from..to], values)
    }

    /// y = A x.
    pub fn apply(&self, x: &[f32], y: &mut [f32]) {
        multiply([self.size; 2], |i| self.row(i), x, y, false);
    }

    /// A block for writing to; none where the matrix has none. Its row is stored by itself from then on.
    pub fn block_mut(&mut self, i: usize, j: usize) -> Option<&mut [f32]> {
        let (from, to, size) = (self.start[i] as usize, self.start[i + 1] as usize, self.size * self.size);
        let at = self.columns[from..to].iter().position(|&column| column as usize == j)?;
        match &mut self.values {
            Values::InOrder(values) => Some(&mut values[(from + at) * size..][..size]),
            Values::Repeated { places, values, shared } => {
                let place = places[i] as usize;
                if place < *shared {
                    places[i] = u32::try_from(values.len() / size.max(1)).ok()?;
                    values.extend_from_within(place * size..(place + to - from) * size);
                }
                Some(&mut values[(places[i] as usize + at) * size..][..size])
            }
        }
    }
}

/// The rows that differ; none where too many of them do.
fn repeated(matrix: &Blocks<f64>, scale: f64) -> Option<Values> {
    let size = (matrix.shape[0] * matrix.shape[1]).max(1);
    let row = |i: usize| &matrix.values[matrix.start[i] as usize * size..matrix.start[i + 1] as usize * size];
    let (mut places, values) = repeats::rows(matrix.len(), row, SAME)?;
    for place in &mut places {
        *place /= size as u32;
    }
    let values: Vec<f32> = values.iter().map(|value| (value / scale) as f32).collect();
    let shared = values.len() / size;
    Some(Values::Repeated { places, values, shared })
}

#[cfg(test)]
mod tests {
    use super::super::blocks::Rows;
    use super::*;

    /// A matrix that joins neighbours: the rows of all nodes but the first and the last are the same, to the round-off
    /// of `noise`.
    fn even(rows: usize, noise: f64) -> Blocks<f64> {
        Blocks::from_rows(rows, rows, [2, 2], |range| {
            let mut made = Rows::default();
            for i in range {
                for j in i.saturating_sub(1)..(i + 2).min(rows) {
                    made.columns.push(j as u32);
                    let off = noise * (i as f64).sin();
                    made.values.extend((0..4).map(|k| (3 + j - i) as f64 - f64::from(k) + off));
                }
                made.ends.push(made.columns.len() as u32);
            }
            made
        })
    }

    /// The product is that of the matrix, whether its rows are stored once or in order, and stays so where blocks
    /// change: those of one row alone.
    #[test]
    fn rows_that_repeat_have_the_product_of_the_matrix() {
        let rows = 200;
        let x: Vec<f32> = (0..2 * rows).map(|i| ((i * 5) % 11) as f32 - 4.0).collect();
        for (noise, is_repeated) in [(0.0, true), (1e-12, true), (1e-3, false)] {
            let matrix = even(rows, noise);
            let (mut stored, mut plain) = (Stored::new(&matrix, 2.0), matrix.single(2.0));
            let blocks = match &stored.values {
                Values::InOrder(values) => values.len() / 4,
                Values::Repeated { values, .. } => values.len() / 4,
            };
            // A row whose sum is rounded to another side may be stored twice.
            let expected = if is_repeated { 7..=10 } else { 3 * rows - 2..=3 * rows - 2 };
            assert!(expected.contains(&blocks), "{noise:e}: {blocks} blocks");
            for changed in [None, Some((50, 51)), Some((50, 50)), Some((51, 50)), Some((0, 0))] {
                if let Some((i, j)) = changed {
                    stored.block_mut(i, j).expect("a block")[1] += 8.0;
                    let at = plain.row(i).position(|(column, _)| column == j).expect("a block");
                    plain.values[(plain.start[i] as usize + at) * 4 + 1] += 8.0;
                }
                let (mut one, mut other) = (vec![0.0; 2 * rows], vec![0.0; 2 * rows]);
                stored.apply(&x, &mut one);
                plain.apply(&x, &mut other, false);
                let largest = one.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
                assert!(largest <= 1e-5, "{noise:e}, {changed:?}: {largest:e}");
            }
            assert!(stored.block_mut(50, 53).is_none());
        }
    }
}
