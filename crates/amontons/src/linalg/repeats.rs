//! Storage of repeated numbers once.
//!
//! On a uniform mesh the rows of a matrix are those of a few nodes, and the panels of a factor those of a few
//! subdomains. Sweeps and products are bound by memory traffic, and shared numbers stay in the caches.

use std::collections::HashMap;
use std::hash::Hash;

/// Largest difference of two equal entries of a factor, as a fraction of the largest entry of its column: translates
/// differ by the round-off of their coordinates, and an elimination leaves errors of this size anyhow.
pub(super) const ROUND_OFF: f64 = 16.0 * f64::EPSILON;

/// Number of last bits of a sum that are ignored.
const BITS: u32 = 12;
/// Number of latest places with the same sum that are compared: it bounds the search if many numbers are nearly the
/// same.
const LATEST: usize = 32;

/// Largest fraction of different rows with which rows are stored once, and how many rows beyond those visited it refers
/// to: rows that do not repeat are thus detected after some of them.
const DIFFERENT: f64 = 0.25;
const AHEAD: usize = 4096;

/// Stores equal rows once: the start of each row, and the numbers, or `None` if too many rows differ. Rows are equal to
/// the bit, because the audit of energy relies on the symmetry of the matrix.
pub(super) fn rows<'a>(count: usize, row: impl Fn(usize) -> &'a [f64]) -> Option<(Vec<u32>, Vec<f64>)> {
    let (mut starts, mut values) = (Vec::with_capacity(count), Vec::new());
    let (mut repeats, mut different) = (Repeats::new(0.0), 0.0);
    for (seen, row) in (0..count).map(row).enumerate() {
        let end = values.len();
        values.extend_from_slice(row);
        let place = repeats.place(row.len(), &values, end, &std::iter::once(row.len()));
        if place < end {
            values.truncate(end);
        } else {
            different += 1.0;
        }
        if different > DIFFERENT * count.min(seen + AHEAD) as f64 {
            return None;
        }
        starts.push(u32::try_from(place).ok()?);
    }
    Some((starts, values))
}

/// Places of stored numbers, by kind: numbers of different kinds are never the same.
#[derive(Debug)]
pub(super) struct Repeats<Kind> {
    places: HashMap<(Kind, u64), Vec<usize>>,
    /// Largest difference of equal entries, as a fraction of the largest entry of a column.
    same: f64,
}

impl<Kind: Eq + Hash> Repeats<Kind> {
    pub fn new(same: f64) -> Repeats<Kind> {
        Repeats { places: HashMap::new(), same }
    }

    /// Place of the numbers from `place` on, which are columns of these lengths: an earlier place if the same numbers
    /// stand there.
    pub fn place(
        &mut self,
        kind: Kind,
        values: &[f64],
        place: usize,
        columns: &(impl Iterator<Item = usize> + Clone),
    ) -> usize {
        let (before, own) = values.split_at(place);
        let alike = self.places.entry((kind, size(own))).or_default();
        let same = alike
            .iter()
            .rev()
            .take(LATEST)
            .copied()
            .find(|&earlier| are_same(self.same, &before[earlier..], own, columns.clone()));
        same.unwrap_or_else(|| {
            alike.push(place);
            place
        })
    }
}

/// Sum of the absolute values, rounded so that equal numbers agree in spite of round-off. If two sums are rounded to
/// different sides, the numbers are stored twice, which is harmless.
fn size(values: &[f64]) -> u64 {
    values.iter().map(|value| value.abs()).sum::<f64>().to_bits() >> BITS
}

/// True if two sets of columns have the same numbers.
fn are_same(same: f64, mut one: &[f64], mut other: &[f64], mut columns: impl Iterator<Item = usize>) -> bool {
    columns.all(|length| {
        let (a, b);
        ((a, one), (b, other)) = (one.split_at(length), other.split_at(length));
        let largest = a.iter().fold(0.0f64, |largest, value| largest.max(value.abs()));
        a.iter().zip(b).all(|(a, b)| (a - b).abs() <= same * largest)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_the_same_to_round_off_of_their_columns() {
        let own = [3.0, -1.0, 1e-8, 5e-9];
        let place = |change: [f64; 4], columns: [usize; 2], kind: u8| {
            let mut repeats = Repeats::new(ROUND_OFF);
            let mut values = vec![7.0];
            values.extend(own);
            assert_eq!(repeats.place(0, &values, 1, &[2, 2].into_iter()), 1);
            values.extend(own.iter().zip(change).map(|(value, change)| value + change));
            repeats.place(kind, &values, 5, &columns.into_iter())
        };
        let fine = f64::EPSILON;
        assert_eq!(place([0.0; 4], [2, 2], 0), 1);
        assert_eq!(place([4.0 * fine, -4.0 * fine, 1e-8 * fine, 0.0], [2, 2], 0), 1);
        // Another kind, another number, and a difference that is small only beside a larger column.
        assert_eq!(place([0.0; 4], [2, 2], 1), 5);
        assert_eq!(place([0.0, 1e-13, 0.0, 0.0], [2, 2], 0), 5);
        assert_eq!(place([0.0, 0.0, 0.0, fine], [2, 2], 0), 5);
        assert_eq!(place([0.0, 0.0, 0.0, fine], [4, 0], 0), 1);
    }

    /// The first `different` rows are different, and all others equal one of them.
    #[test]
    fn rows_that_repeat_are_found_where_few_differ() {
        let rows_of = |count: usize, different: usize| {
            let numbers: Vec<[f64; 2]> = (0..count).map(|i| [1.0, (i % different) as f64]).collect();
            rows(count, |i| &numbers[i]).map(|(starts, values)| {
                let same = (0..count).all(|i| values[starts[i] as usize..][..2] == numbers[i]);
                (same, values.len() / 2)
            })
        };
        assert_eq!(rows_of(40, 10), Some((true, 10)));
        assert_eq!(rows_of(40, 11), None);
        assert_eq!(rows_of(100_000, 1000), Some((true, 1000)));
        // A quarter of all differ, but those all come first.
        assert_eq!(rows_of(100_000, 2000), None);
    }

    #[test]
    fn numbers_of_one_size_are_told_apart() {
        let (mut repeats, values) = (Repeats::new(0.0), [1.0, 2.0, 2.0, 1.0, 1.0, -2.0, 2.0, 1.0, f64::NAN, 0.0]);
        let places: Vec<usize> = (0..values.len())
            .step_by(2)
            .map(|end| repeats.place((), &values[..end + 2], end, &std::iter::once(2)))
            .collect();
        assert_eq!(places, [0, 2, 4, 2, 8]);
    }
}
