//! Products of several matrices on one graph in one loop, with a function applied to the results while they are in the
//! caches.
//!
//! The products are compiled for the vector instructions of the machine; every sum has the same order on all machines
//! and with any number of threads.
#![allow(clippy::inline_always, reason = "a loop is compiled for the vector instructions of the function it is in")]

use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use super::sparse::{BlockMatrix, CHUNK};
use super::vectors::by_blocks;

/// Computes M w, A u, A w and B w in one loop over the matrices: M of 1 × 1 blocks, A and B of d × d blocks that act on
/// differences, all on one graph. A is read once for both of its products. `then` is applied to each block of M w, A u
/// and B w while it is in the caches: it gets the first entry of the block, the products, and the block of `rest`, to
/// write to, which may be empty. Its results are returned in the order of the blocks.
///
/// The bits are those of [`BlockMatrix::apply`].
#[must_use]
pub fn mechanical_products<T: Send + 'static>(
    [mass, a, b]: [&BlockMatrix; 3],
    [u, w]: [&[f64]; 2],
    rest: &mut [f64],
    then: impl Fn(usize, [&[f64]; 3], &mut [f64]) -> T + Sync,
) -> ([Vec<f64>; 4], Vec<T>) {
    match a.block_shape() {
        (2, 2) if a.is_of_differences() && b.is_of_differences() => {
            products_of::<2, 4, T>([mass, a, b], [u, w], rest, then)
        }
        (3, 3) if a.is_of_differences() && b.is_of_differences() => {
            products_of::<3, 9, T>([mass, a, b], [u, w], rest, then)
        }
        _ => {
            let products = [mass.apply(w), a.apply(u), a.apply(w), b.apply(w)];
            let [mass_w, a_u, _, b_w] = &products;
            let made = by_blocks([mass_w, a_u, b_w], rest, then);
            (products, made)
        }
    }
}

fn products_of<const C: usize, const B: usize, T: Send + 'static>(
    [mass, a, b]: [&BlockMatrix; 3],
    [u, w]: [&[f64]; 2],
    rest: &mut [f64],
    then: impl Fn(usize, [&[f64]; 3], &mut [f64]) -> T + Sync,
) -> ([Vec<f64>; 4], Vec<T>) {
    let mut out: [Vec<f64>; 4] = std::array::from_fn(|_| vec![0.0; a.graph().len() * C]);
    let (u, w) = (u.as_chunks::<C>().0, w.as_chunks::<C>().0);
    let [mass_w, a_u, a_w, b_w] = &mut out;
    let length = CHUNK * C;
    let rows = mass_w
        .par_chunks_mut(length)
        .zip(a_u.par_chunks_mut(length))
        .zip(a_w.par_chunks_mut(length).zip(b_w.par_chunks_mut(length)))
        .enumerate();
    let of_rows = |(chunk, ((mass_w, a_u), (a_w, b_w))): (usize, (RowPair, RowPair)), rest: &mut [f64]| {
        let out = [&mut *mass_w, &mut *a_u, a_w, &mut *b_w];
        Arch::new().dispatch(ProductRows::<C, B> { mass, a, b, first: chunk * CHUNK, u, w, out });
        then(chunk * length, [mass_w, a_u, b_w], rest)
    };
    let made = if rest.is_empty() {
        rows.map(|rows| of_rows(rows, &mut [])).collect()
    } else {
        rows.zip(rest.par_chunks_mut(length)).map(|(rows, rest)| of_rows(rows, rest)).collect()
    };
    (out, made)
}

/// Computes M θ and D θ in one loop over the matrices of 1 × 1 blocks, of which D acts on differences, on one graph.
/// `then` is applied to each block of them, as in [`mechanical_products`].
///
/// The bits are those of [`BlockMatrix::apply`].
#[must_use]
pub fn thermal_products<T: Send + 'static>(
    [mass, d]: [&BlockMatrix; 2],
    theta: &[f64],
    rest: &mut [f64],
    then: impl Fn(usize, [&[f64]; 2], &mut [f64]) -> T + Sync,
) -> ([Vec<f64>; 2], Vec<T>) {
    let mut out = [vec![0.0; theta.len()], vec![0.0; theta.len()]];
    let [mass_theta, d_theta] = &mut out;
    let rows = mass_theta.par_chunks_mut(CHUNK).zip(d_theta.par_chunks_mut(CHUNK)).enumerate();
    let of_rows = |(chunk, (mass_theta, d_theta)): (usize, RowPair), rest: &mut [f64]| {
        let out = [&mut *mass_theta, &mut *d_theta];
        Arch::new().dispatch(ThermalProducts { mass, d, first: chunk * CHUNK, theta, out });
        then(chunk * CHUNK, [mass_theta, d_theta], rest)
    };
    let made = if rest.is_empty() {
        rows.map(|rows| of_rows(rows, &mut [])).collect()
    } else {
        rows.zip(rest.par_chunks_mut(CHUNK)).map(|(rows, rest)| of_rows(rows, rest)).collect()
    };
    (out, made)
}

/// Corresponding rows of two products.
type RowPair<'a> = (&'a mut [f64], &'a mut [f64]);

/// Some rows of M w, A u, A w and B w, beginning at the row of node `first`.
struct ProductRows<'a, const C: usize, const B: usize> {
    mass: &'a BlockMatrix,
    a: &'a BlockMatrix,
    b: &'a BlockMatrix,
    first: usize,
    u: &'a [[f64; C]],
    w: &'a [[f64; C]],
    out: [&'a mut [f64]; 4],
}

impl<const C: usize, const B: usize> NullaryFnOnce for ProductRows<'_, C, B> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let ProductRows { mass, a, b, first, u, w, out } = self;
        let graph = &**a.graph();
        let [mass_w, a_u, a_w, b_w] = out.map(|rows| rows.as_chunks_mut::<C>().0);
        for (k, mass_w) in mass_w.iter_mut().enumerate() {
            let (u0, w0) = (u[first + k], w[first + k]);
            let (mut m_w, mut sums) = ([0.0; C], [[0.0; B]; 3]);
            let of_row = graph.row(first + k).iter().zip(mass.row_read(first + k));
            let [a, b] = [a, b].map(|matrix| matrix.row_read(first + k).as_chunks::<B>().0);
            for ((&j, m), (a, b)) in of_row.zip(a.iter().zip(b)) {
                let (u, w) = (u[j as usize], w[j as usize]);
                // Entry (r, c) of a block, number r C + c, multiplies component c.
                let du: [f64; B] = std::array::from_fn(|i| u[i % C] - u0[i % C]);
                let dw: [f64; B] = std::array::from_fn(|i| w[i % C] - w0[i % C]);
                for r in 0..C {
                    m_w[r] += m * w[r];
                }
                for i in 0..B {
                    sums[0][i] += a[i] * du[i];
                    sums[1][i] += a[i] * dw[i];
                    sums[2][i] += b[i] * dw[i];
                }
            }
            *mass_w = m_w;
            for (out, sums) in [&mut a_u[k], &mut a_w[k], &mut b_w[k]].into_iter().zip(&sums) {
                *out = std::array::from_fn(|r| sums[r * C..(r + 1) * C].iter().sum());
            }
        }
    }
}

/// Some rows of M θ and D θ, beginning at the row of node `first`.
struct ThermalProducts<'a> {
    mass: &'a BlockMatrix,
    d: &'a BlockMatrix,
    first: usize,
    theta: &'a [f64],
    out: [&'a mut [f64]; 2],
}

impl NullaryFnOnce for ThermalProducts<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let ThermalProducts { mass, d, first, theta, out: [mass_theta, d_theta] } = self;
        for (k, (mass_theta, d_theta)) in mass_theta.iter_mut().zip(d_theta).enumerate() {
            let (origin, mut sums) = (theta[first + k], [0.0; 2]);
            let entries = mass.row_read(first + k).iter().zip(d.row_read(first + k));
            for (&j, (mass, d)) in d.graph().row(first + k).iter().zip(entries) {
                sums[0] += mass * theta[j as usize];
                sums[1] += d * (theta[j as usize] - origin);
            }
            [*mass_theta, *d_theta] = sums;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::linalg::Graph;
    use crate::mesh::{Block, Diagonal, Mesh, MeshError};

    /// `then` also gets every block of rows exactly once and complete.
    #[test]
    fn products_in_one_pass_have_the_same_bits() -> Result<(), MeshError> {
        let mesh = Mesh::rectangle([1.0, 1.0], [60, 50], Diagonal::Crossed)?;
        let graph = Arc::new(Graph::of_mesh(&mesh));
        let filled = |rows: usize, seed: usize| {
            let mut matrix = BlockMatrix::zero(&graph, rows, rows);
            for (k, cell) in mesh.blocks.iter().flat_map(Block::cells).enumerate() {
                let values: Vec<f64> = (0..9 * rows * rows).map(|v| ((v * 7 + k * 3 + seed) as f64).sin()).collect();
                matrix.add(cell, &values);
            }
            matrix
        };
        let (mass, a, b) = (filled(1, 1), filled(2, 2).of_differences(), filled(2, 3).of_differences());
        let [u, w]: [Vec<f64>; 2] = [1.0, 2.0].map(|f| (0..graph.len() * 2).map(|i| (f * i as f64).cos()).collect());
        let expected = [mass.apply(&w), a.apply(&u), a.apply(&w), b.apply(&w)];
        for rests in [0, 2 * graph.len()] {
            let mut rest = vec![0.0; rests];
            let (found, seen) =
                mechanical_products([&mass, &a, &b], [&u, &w], &mut rest, |first, [mass_w, a_u, b_w], rest| {
                    for (i, rest) in rest.iter_mut().enumerate() {
                        *rest = mass_w[i] + a_u[i] - 2.0 * b_w[i];
                    }
                    (first, b_w.len())
                });
            assert_eq!(found, expected);
            assert!(
                seen.len() > 2
                    && seen.iter().fold(0, |end, (first, n)| if *first == end { end + n } else { 0 }) == w.len()
            );
            let [mass_w, a_u, _, b_w] = &expected;
            assert!(rest.iter().enumerate().all(|(i, rest)| (rest - (mass_w[i] + a_u[i] - 2.0 * b_w[i])).abs() == 0.0));
        }
        let (d, theta) = (filled(1, 7).of_differences(), &u[..graph.len()]);
        let mut rest = vec![0.0; theta.len()];
        let (found, seen) = thermal_products([&mass, &d], theta, &mut rest, |first, [mass_theta, d_theta], rest| {
            for (i, rest) in rest.iter_mut().enumerate() {
                *rest = mass_theta[i] - d_theta[i];
            }
            (first, d_theta.len())
        });
        assert_eq!(found, [mass.apply(theta), d.apply(theta)]);
        assert!(
            seen.len() > 2
                && seen.iter().fold(0, |end, (first, n)| if *first == end { end + n } else { 0 }) == theta.len()
        );
        let [mass_theta, d_theta] = &found;
        assert!(rest.iter().enumerate().all(|(i, rest)| (rest - (mass_theta[i] - d_theta[i])).abs() == 0.0));
        Ok(())
    }
}
