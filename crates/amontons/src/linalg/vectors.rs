//! Loops over vectors: entrywise functions, sums, combinations, the largest entry.
//!
//! Each thread works on blocks of fixed size, so that no result depends on the number of threads. A loop reads each of
//! its vectors once; for vectors that do not fit into a cache this is its cost.

#![allow(clippy::inline_always, reason = "a loop is compiled for the vector instructions of the function it is in")]

use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

/// Entries per block: large enough to pay for a task.
pub(super) const BLOCK: usize = 1 << 14;

/// Entries per piece that is written at once.
const WRITTEN: usize = 16;

/// Builds a vector of `length` entries from pieces: each thread writes its own, once.
fn written(length: usize, piece: impl Fn(usize) -> [f64; WRITTEN] + Sync) -> Vec<f64> {
    let mut entries = vec![0.0; length];
    entries.par_chunks_mut(BLOCK).enumerate().for_each(|(block, entries)| {
        let first = block * (BLOCK / WRITTEN);
        let (pieces, rest) = entries.as_chunks_mut();
        let count = pieces.len();
        pieces.iter_mut().enumerate().for_each(|(k, entries)| *entries = piece(first + k));
        if !rest.is_empty() {
            rest.copy_from_slice(&piece(first + count)[..rest.len()]);
        }
    });
    entries
}

/// A vector of zeros.
#[must_use]
pub fn zeros(length: usize) -> Vec<f64> {
    written(length, |_| [0.0; WRITTEN])
}

/// A copy of a vector.
#[must_use]
pub fn copy(of: &[f64]) -> Vec<f64> {
    map([of], |[entry]| entry)
}

/// The vector of the entries f(a_i, b_i, …) of vectors of equal length.
#[must_use]
pub fn map<const N: usize>(of: [&[f64]; N], f: impl Fn([f64; N]) -> f64 + Sync) -> Vec<f64> {
    let length = of.first().map_or(0, |v| v.len());
    let of = of.map(|v| v[..length].as_chunks::<WRITTEN>());
    written(length, |i| {
        let mut out = [0.0; WRITTEN];
        if i < length / WRITTEN {
            let of = of.map(|(pieces, _)| &pieces[i]);
            for (k, out) in out.iter_mut().enumerate() {
                *out = f(of.map(|v| v[k]));
            }
        } else {
            for (k, out) in out.iter_mut().enumerate().take(length % WRITTEN) {
                *out = f(of.map(|(_, rest)| rest[k]));
            }
        }
        out
    })
}

/// Writes the entries f(a_i, b_i, …) of blocks of equal length, and returns the largest absolute value per block, NaN
/// if there is one.
pub fn map_block<const N: usize>(of: [&[f64]; N], out: &mut [f64], f: impl Fn([f64; N]) -> f64) -> [f64; N] {
    Arch::new().dispatch(MapBlock { of, out, f })
}

/// Arguments of [`map_block`].
struct MapBlock<'a, const N: usize, F> {
    of: [&'a [f64]; N],
    out: &'a mut [f64],
    f: F,
}

impl<const N: usize, F: Fn([f64; N]) -> f64> NullaryFnOnce for MapBlock<'_, N, F> {
    type Output = [f64; N];

    #[inline(always)]
    fn call(self) -> [f64; N] {
        let MapBlock { of, out, f } = self;
        let mut sizes = [[0; 4]; N];
        let (fours, rest) = (of.map(|v| v.as_chunks::<4>().0), of.map(|v| v.as_chunks::<4>().1));
        let (out, out_rest) = out.as_chunks_mut::<4>();
        for (i, out) in out.iter_mut().enumerate() {
            for l in 0..4 {
                let entries = fours.map(|v| v[i][l]);
                out[l] = f(entries);
                for (sizes, entry) in sizes.iter_mut().zip(entries) {
                    sizes[l] = sizes[l].max(size(entry));
                }
            }
        }
        for (i, out) in out_rest.iter_mut().enumerate() {
            let entries = rest.map(|v| v[i]);
            *out = f(entries);
            for (sizes, entry) in sizes.iter_mut().zip(entries) {
                sizes[0] = sizes[0].max(size(entry));
            }
        }
        sizes.map(|lanes| of_size(lanes.into_iter().fold(0, i64::max)))
    }
}

/// The larger of two absolute values; NaN if one is NaN.
#[must_use]
pub fn larger(a: f64, b: f64) -> f64 {
    of_size(size(a).max(size(b)))
}

/// Results of `then` on each block of vectors of equal length, in the order of the blocks. `then` gets the first entry,
/// the blocks, and the block of another vector, to write to, which may be empty.
#[must_use]
pub fn by_blocks<const N: usize, T: Send + 'static>(
    of: [&[f64]; N],
    out: &mut [f64],
    then: impl Fn(usize, [&[f64]; N], &mut [f64]) -> T + Sync,
) -> Vec<T> {
    let size = of.first().map_or(0, |v| v.len());
    let of_block = |block: usize, out: &mut [f64]| {
        let (first, last) = (block * BLOCK, size.min((block + 1) * BLOCK));
        then(first, of.map(|v| &v[first..last]), out)
    };
    if out.is_empty() {
        return (0..size.div_ceil(BLOCK)).into_par_iter().map(|block| of_block(block, &mut [])).collect();
    }
    out.par_chunks_mut(BLOCK).enumerate().map(|(block, out)| of_block(block, out)).collect()
}

/// Sums Σ f(a_i, b_i, …) over blocks of equal length, several sums at once, each in eight lanes.
#[must_use]
pub fn sum_block<const N: usize, const M: usize>(of: [&[f64]; N], f: impl Fn([f64; N]) -> [f64; M]) -> [f64; M] {
    Arch::new().dispatch(SumBlock { of, f })
}

/// Arguments of [`sum_block`].
struct SumBlock<'a, const N: usize, F> {
    of: [&'a [f64]; N],
    f: F,
}

impl<const N: usize, const M: usize, F: Fn([f64; N]) -> [f64; M]> NullaryFnOnce for SumBlock<'_, N, F> {
    type Output = [f64; M];

    #[inline(always)]
    fn call(self) -> [f64; M] {
        let SumBlock { of, f } = self;
        let (eights, rest) = (of.map(|v| v.as_chunks::<8>().0), of.map(|v| v.as_chunks::<8>().1));
        let mut lanes = [[0.0; 8]; M];
        for i in 0..eights.first().map_or(0, |v| v.len()) {
            for l in 0..8 {
                for (lanes, value) in lanes.iter_mut().zip(f(eights.map(|v| v[i][l]))) {
                    lanes[l] += value;
                }
            }
        }
        let mut of_rest = [0.0; M];
        for i in 0..rest.first().map_or(0, |v| v.len()) {
            for (sum, value) in of_rest.iter_mut().zip(f(rest.map(|v| v[i]))) {
                *sum += value;
            }
        }
        std::array::from_fn(|k| lanes[k].iter().sum::<f64>() + of_rest[k])
    }
}

/// Scalar product a·b.
#[must_use]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let of_block = |(a, b): (&[f64], &[f64])| sum_block([a, b], |[a, b]| [a * b])[0];
    let partial: Vec<f64> = a.par_chunks(BLOCK).zip(b.par_chunks(BLOCK)).map(of_block).collect();
    partial.iter().sum()
}

/// Scalar products of a vector with each of several vectors.
#[must_use]
pub fn dots<V: AsRef<[f64]> + Sync>(vectors: &[V], x: &[f64]) -> Vec<f64> {
    let of_block = |(block, x): (usize, &[f64])| dots_of_block(vectors, block * BLOCK, x);
    sums_of(vectors.len(), &x.par_chunks(BLOCK).enumerate().map(of_block).collect::<Vec<_>>())
}

/// Scalar products of a block, which begins at entry `at`, with each of several vectors.
fn dots_of_block<V: AsRef<[f64]>>(vectors: &[V], at: usize, x: &[f64]) -> Vec<f64> {
    vectors.iter().map(|v| sum_block([&v.as_ref()[at..at + x.len()], x], |[v, x]| [v * x])[0]).collect()
}

/// Sums of `count` numbers over the blocks.
fn sums_of(count: usize, partial: &[Vec<f64>]) -> Vec<f64> {
    (0..count).map(|i| partial.iter().map(|of_block| of_block[i]).sum()).collect()
}

/// y ← y + Σ f_i v_i.
pub fn add_combination<V: AsRef<[f64]> + Sync>(y: &mut [f64], factors: &[f64], vectors: &[V]) {
    y.par_chunks_mut(BLOCK).enumerate().for_each(|(block, y)| add_to_block(y, block * BLOCK, factors, vectors));
}

/// y ← y + Σ f_i v_i for a block that begins at entry `at`.
fn add_to_block<V: AsRef<[f64]>>(y: &mut [f64], at: usize, factors: &[f64], vectors: &[V]) {
    for (factor, v) in factors.iter().zip(vectors) {
        for (y, v) in y.iter_mut().zip(&v.as_ref()[at..]) {
            *y += factor * v;
        }
    }
}

/// Orthogonalizes a vector against a basis and returns the components that it had: `duals[i]`·x is that along
/// `basis[i]`. It is done twice, which makes the rest orthogonal to round-off (Giraud, Langou, Rozložník, Comput. Math.
/// Appl. 50 (2005) 1069). The basis is read three times: per block, the second components are computed as soon as the
/// first are subtracted.
pub fn orthogonalize<V: AsRef<[f64]> + Sync>(x: &mut [f64], basis: &[V], duals: &[V]) -> Vec<f64> {
    let minus = |components: Vec<f64>| components.into_iter().map(|component| -component).collect::<Vec<f64>>();
    let first = minus(dots(duals, x));
    let of_block = |(block, x): (usize, &mut [f64])| {
        add_to_block(x, block * BLOCK, &first, basis);
        dots_of_block(duals, block * BLOCK, x)
    };
    let partial: Vec<Vec<f64>> = x.par_chunks_mut(BLOCK).enumerate().map(of_block).collect();
    let second = minus(sums_of(duals.len(), &partial));
    add_combination(x, &second, basis);
    first.iter().zip(&second).map(|(first, second)| -first - second).collect()
}

/// Largest absolute value; NaN if an entry is NaN.
#[must_use]
pub fn max_abs(v: &[f64]) -> f64 {
    of_size(v.par_chunks(BLOCK).map(largest).reduce(|| 0, i64::max))
}

fn largest(v: &[f64]) -> i64 {
    let (chunks, rest) = v.as_chunks::<8>();
    let mut lanes = [0; 8];
    for chunk in chunks {
        for l in 0..8 {
            lanes[l] = lanes[l].max(size(chunk[l]));
        }
    }
    rest.iter().map(|x| size(*x)).chain(lanes).fold(0, i64::max)
}

/// Bits of the absolute value of a number, whose order is that of the values, NaN above all.
fn size(x: f64) -> i64 {
    x.abs().to_bits().cast_signed()
}

fn of_size(size: i64) -> f64 {
    f64::from_bits(size.cast_unsigned())
}

/// True if every entry is finite.
#[must_use]
pub fn is_finite(v: &[f64]) -> bool {
    v.par_chunks(BLOCK).all(|v| v.chunks(64).all(|v| v.iter().fold(true, |all, x| all & x.is_finite())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_those_of_the_entries() {
        let [a, b]: [Vec<f64>; 2] = [7, 5].map(|n| (0..40_001).map(|i| f64::from(i % n)).collect());
        let plain: f64 = a.iter().map(|x| x * x).sum();
        assert!((dot(&a, &a) - plain).abs() < 1e-9);
        let of_both: f64 = a.iter().zip(&b).map(|(a, b)| a - 2.0 * b).sum();
        let [product, difference] = sum_block([&a, &b], |[a, b]| [a * a, a - 2.0 * b]);
        assert!((product - plain).abs() < 1e-9 && (difference - of_both).abs() < 1e-9);
        let mapped = map([&a, &b], |[a, b]| a - 2.0 * b);
        assert!(mapped.len() == a.len() && (0..a.len()).all(|i| (mapped[i] - (a[i] - 2.0 * b[i])).abs() == 0.0));
        assert_eq!(dots(&[&a, &b], &a), [dot(&a, &a), dot(&b, &a)]);
        assert!(dot(&[], &[]).abs() == 0.0 && map([&[]], |[a]| a).is_empty());
        let mut of_both = vec![0.0; a.len()];
        let largest = map_block([&a, &b], &mut of_both, |[a, b]| a - 2.0 * b);
        assert!(mapped == of_both && largest.map(f64::to_bits) == [6.0, 4.0].map(f64::to_bits));
        // The first entry of a block identifies its place.
        for out in [&mut of_both[..], &mut []] {
            let told = by_blocks([&a, &b], out, |first, [a, b], out| {
                out.iter_mut().zip(a).for_each(|(out, a)| *out = 2.0 * a);
                (first, a.len(), b.first().copied())
            });
            let expected = (0..3).map(|k| (BLOCK * k, BLOCK.min(40_001 - BLOCK * k), Some(b[BLOCK * k])));
            assert!(told.into_iter().eq(expected));
        }
        assert!(of_both.iter().zip(&a).all(|(out, a)| (out - 2.0 * a).abs() == 0.0));
    }

    /// A combination of orthonormal vectors is reduced to zero, and its components are those it was made of.
    #[test]
    fn what_is_orthogonal_to_a_basis_is_left() {
        let n: usize = 40_001;
        let entry = |i: usize, k: usize| if i % 3 == k { 1.0 / (n - k).div_ceil(3) as f64 } else { 0.0 };
        let basis: Vec<Vec<f64>> = (0..3).map(|k| (0..n).map(|i| entry(i, k).sqrt()).collect()).collect();
        let mut x = vec![0.0; n];
        add_combination(&mut x, &[1.0, -2.0, 3.0], &basis);
        let components = orthogonalize(&mut x, &basis, &basis);
        assert!(components.iter().zip([1.0, -2.0, 3.0]).all(|(found, value)| (found - value).abs() < 1e-12));
        assert!(max_abs(&dots(&basis, &x)) < 1e-12, "{:?}", dots(&basis, &x));
    }

    #[test]
    fn what_is_no_number_is_seen() {
        assert!(max_abs(&[1.0, f64::NAN, 2.0]).is_nan());
        assert!(max_abs(&[1.0, -f64::NAN, f64::INFINITY]).is_nan());
        for at in 0..7 {
            let mut one = [-3.0; 7];
            one[at] = f64::NAN;
            let [first, second] = map_block([&one, &[-4.0; 7]], &mut [0.0; 7], |[a, b]| a + b);
            assert!(first.is_nan() && (second - 4.0).abs() == 0.0 && larger(first, second).is_nan());
            assert!(larger(second, first).is_nan() && (larger(second, -5.0) - 5.0).abs() == 0.0);
        }
        let with = |i: usize, value: f64| (0..20).map(|k| if k == i { value } else { 2.0 }).collect::<Vec<_>>();
        assert!((0..20).all(|i| max_abs(&with(i, f64::NAN)).is_nan()));
        assert!((0..20).all(|i| (max_abs(&with(i, -3.0)) - 3.0).abs() == 0.0));
        let mut long = vec![1.0; 3 * BLOCK + 5];
        assert!(is_finite(&long));
        for at in [0, BLOCK, 3 * BLOCK + 4] {
            for (value, finite) in [(f64::INFINITY, false), (-5.0, true)] {
                long[at] = value;
                assert_eq!((max_abs(&long), is_finite(&long)), (value.abs(), finite));
            }
            long[at] = f64::NAN;
            assert!(max_abs(&long).is_nan() && !is_finite(&long));
            long[at] = 1.0;
        }
        assert_eq!((max_abs(&[]), max_abs(&[f64::NEG_INFINITY; 9])), (0.0, f64::INFINITY));
    }
}
