//! Prolongations: the modes of the finer level as a basis per aggregate, and their smoothing.

use super::aggregate::{Aggregates, Neighbours};
use super::blocks::{BlockRowBuilder, BlockRowMatrix, add_product};

/// Fraction of its length below which a mode of an aggregate counts as a combination of those before.
const DEPENDENT: f64 = 1e-6;

/// The tentative prolongation, with the modes of the finer level as an orthonormal basis per aggregate, and the coarse
/// modes in this basis. `modes` has a block of `size` × m per node.
pub(super) fn tentative(
    of: &Aggregates,
    count: usize,
    modes: &[f64],
    [size, m]: [usize; 2],
) -> (BlockRowMatrix<f64>, Vec<f64>) {
    let mut members = vec![Vec::new(); count];
    for (i, aggregate) in of.iter().enumerate() {
        if let Some(a) = aggregate {
            members[*a as usize].push(i);
        }
    }
    let (mut basis, mut coarse) = (vec![0.0; of.len() * size * m], vec![0.0; count * m * m]);
    for (aggregate, nodes) in members.iter().enumerate() {
        let mut columns: Vec<Vec<f64>> = (0..m)
            .map(|k| nodes.iter().flat_map(|&i| (0..size).map(move |c| modes[(i * size + c) * m + k])).collect())
            .collect();
        let r = &mut coarse[aggregate * m * m..][..m * m];
        orthonormalize(&mut columns, r);
        for (k, column) in columns.iter().enumerate() {
            for (value, (&i, c)) in column.iter().zip(nodes.iter().flat_map(|i| (0..size).map(move |c| (i, c)))) {
                basis[(i * size + c) * m + k] = *value;
            }
        }
    }
    let prolongation = BlockRowMatrix::from_rows(of.len(), count, [size, m], |range| {
        let mut rows = BlockRowBuilder::default();
        for i in range {
            if let Some(a) = of[i] {
                rows.columns.push(a);
                rows.values.extend(&basis[i * size * m..][..size * m]);
            }
            rows.ends.push(rows.columns.len() as u32);
        }
        rows
    });
    (prolongation, coarse)
}

/// Makes columns orthonormal, and linearly dependent ones zero; `r` is the upper triangle, by rows.
fn orthonormalize(columns: &mut [Vec<f64>], r: &mut [f64]) {
    let m = columns.len();
    for k in 0..m {
        let (before, rest) = columns.split_at_mut(k);
        let column = &mut rest[0];
        let size = dot(column, column).sqrt();
        for _ in 0..2 {
            for (l, other) in before.iter().enumerate() {
                let c = dot(other, column);
                r[l * m + k] += c;
                column.iter_mut().zip(other).for_each(|(v, o)| *v -= c * o);
            }
        }
        let length = dot(column, column).sqrt();
        if length > DEPENDENT * size {
            r[k * m + k] = length;
            for v in column.iter_mut() {
                *v /= length;
            }
        } else {
            column.fill(0.0);
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// What smooths a tentative prolongation.
pub(super) struct ProlongationSmoother<'a> {
    pub matrix: &'a BlockRowMatrix<f64>,
    pub strong: &'a Neighbours,
    /// Inverse diagonal blocks, and the largest eigenvalue of D⁻¹A.
    pub diagonal: &'a [f64],
    pub largest: f64,
}

impl ProlongationSmoother<'_> {
    /// Smoothed prolongation P = (I − 4/3λ D⁻¹Â) T. In Â, a weak coupling to an aggregate that no strong one leads to
    /// counts on the diagonal: in cells that are wide and flat, P would otherwise spread sideways on each level, and
    /// the coarse matrices would fill (Vaněk, Mandel, Brezina 1996). Rows of degrees of freedom that are left out are
    /// zero.
    pub fn smoothed(&self, tentative: &BlockRowMatrix<f64>, takes_part: Option<&[bool]>) -> BlockRowMatrix<f64> {
        let [n, m] = tentative.shape;
        BlockRowMatrix::from_rows(tentative.len(), tentative.width, [n, m], |range| {
            let mut made = BlockRowBuilder::default();
            for i in range {
                let takes_part = takes_part.map(|takes_part| &takes_part[i * n..][..n]);
                let first = made.values.len();
                if takes_part.is_none_or(|takes_part| takes_part.contains(&true)) {
                    self.add_row(tentative, i, &mut made);
                }
                for (k, value) in made.values[first..].iter_mut().enumerate() {
                    if takes_part.is_some_and(|takes_part| !takes_part[k / m % n]) {
                        *value = 0.0;
                    }
                }
                made.ends.push(made.columns.len() as u32);
            }
            made
        })
    }

    /// Adds the blocks of row i of P.
    fn add_row(&self, tentative: &BlockRowMatrix<f64>, i: usize, made: &mut BlockRowBuilder<f64>) {
        let [n, m] = tentative.shape;
        let aggregate = |node: usize| tentative.places().row(node).first().copied();
        let own = aggregate(i);
        let near = self.strong.of(i).iter().filter_map(|&j| aggregate(j as usize));
        let mut columns: Vec<u32> = own.into_iter().chain(near).collect();
        columns.sort_unstable();
        columns.dedup();
        let own_place = own.and_then(|a| columns.binary_search(&a).ok());
        let mut product = vec![0.0; columns.len() * n * m];
        for (j, block) in self.matrix.row(i) {
            let Some(a) = aggregate(j) else { continue };
            let found = columns.binary_search(&a).ok().map(|place| (j, place));
            let Some((node, place)) = found.or_else(|| Some((i, own_place?))) else { continue };
            let Some((_, t)) = tentative.row(node).next() else { continue };
            add_product(block, t, &mut product[place * n * m..][..n * m], [n, n, m]);
        }
        let inverse = &self.diagonal[i * n * n..][..n * n];
        let omega = 4.0 / (3.0 * self.largest);
        for (&a, product) in columns.iter().zip(product.chunks_exact(n * m)) {
            let first = made.values.len();
            made.values.resize(first + n * m, 0.0);
            let block = &mut made.values[first..];
            add_product(inverse, product, block, [n, n, m]);
            for value in &mut *block {
                *value *= -omega;
            }
            if let Some((_, t)) = tentative.row(i).next().filter(|(b, _)| *b == a as usize) {
                block.iter_mut().zip(t).for_each(|(value, t)| *value += t);
            }
        }
        made.columns.extend(columns);
    }
}

#[cfg(test)]
mod tests {
    use super::super::aggregate::{aggregates, strong};
    use super::*;
    use crate::tensor::Point;

    /// Matrix of −Δ with trilinear cells of size `h` on n³ nodes, without boundary conditions, and the nodes.
    fn laplacian(n: usize, h: Point) -> (BlockRowMatrix<f64>, Vec<Point>) {
        let place = |i: usize| [i % n, i / n % n, i / n / n];
        let end = |k: usize| if k == 0 || k == n - 1 { 0.5 } else { 1.0 };
        let matrix = BlockRowMatrix::from_rows(n * n * n, n * n * n, [1, 1], |range| {
            let mut made = BlockRowBuilder::default();
            for i in range {
                let own = place(i);
                for j in 0..n * n * n {
                    let other = place(j);
                    if (0..3).any(|c| own[c].abs_diff(other[c]) > 1) {
                        continue;
                    }
                    let is_same = |c: usize| own[c] == other[c];
                    let mass = |c: usize| h[c] * if is_same(c) { 2.0 / 3.0 * end(own[c]) } else { 1.0 / 6.0 };
                    let stiff = |c: usize| if is_same(c) { 2.0 * end(own[c]) / h[c] } else { -1.0 / h[c] };
                    made.columns.push(j as u32);
                    made.values.push((0..3).map(|c| stiff(c) * mass((c + 1) % 3) * mass((c + 2) % 3)).sum::<f64>());
                }
                made.ends.push(made.columns.len() as u32);
            }
            made
        });
        (matrix, (0..n * n * n).map(|i| std::array::from_fn(|c| h[c] * place(i)[c] as f64)).collect())
    }

    /// In flat and in long cells, in whichever direction, aggregates are along the strong couplings, the coarse matrix
    /// stays small beside the fine one, and constants are in the coarse space.
    #[test]
    fn slender_cells_have_small_coarse_matrices() {
        for (h, most) in [
            ([1.0, 1.0, 1.0], 0.1),
            ([8.0, 8.0, 1.0], 0.25),
            ([1.0, 200.0, 200.0], 0.25),
            ([50.0, 1.0, 1.0], 0.25),
            ([400.0, 20.0, 1.0], 0.25),
        ] {
            let (matrix, points) = laplacian(9, h);
            let strong = strong(&matrix, &points);
            let (of, count) = aggregates(&strong, &vec![true; matrix.len()]);
            for (i, &a) in of.iter().enumerate().filter(|_| h[0] > 1.0 && h[1] > 1.0 || h[0] < h[1]) {
                let thin = if h[0] < h[1] { 0 } else { 2 };
                let is_aside = |j: usize| (0..3).any(|c| c != thin && (points[i][c] - points[j][c]).abs() > 0.0);
                assert!((0..of.len()).all(|j| of[j] != a || !is_aside(j)), "{h:?}: node {i} is joined sideways");
            }
            let (tentative, coarse) = tentative(&of, count, &vec![1.0; matrix.len()], [1, 1]);
            let diagonal: Vec<f64> = (0..matrix.len())
                .filter_map(|i| matrix.row(i).find(|(j, _)| *j == i))
                .map(|(_, d)| d[0].recip())
                .collect();
            let smoother = ProlongationSmoother { matrix: &matrix, strong: &strong, diagonal: &diagonal, largest: 2.0 };
            let smoothed = smoother.smoothed(&tentative, None);
            let (mut constant, around) = (vec![0.0; matrix.len()], smoothed.transposed().around(&matrix, &smoothed));
            smoothed.apply(&coarse, &mut constant, false);
            assert!(constant.iter().all(|value| (value - 1.0).abs() < 1e-12), "{h:?}: no constants");
            let share = around.columns.len() as f64 / matrix.columns.len() as f64;
            println!("{h:?}: {count} aggregates, coarse matrix {share:.3} of the fine one");
            assert!(share < most, "{h:?}: {share}");
        }
    }

    /// Degrees of freedom that are left out have empty rows.
    #[test]
    fn nodes_that_are_left_out_are_not_moved() {
        let (matrix, points) = laplacian(4, [1.0; 3]);
        let takes_part: Vec<bool> = points.iter().map(|x| x[2] > 0.0).collect();
        let strong = strong(&matrix, &points);
        let (of, count) = aggregates(&strong, &takes_part);
        let modes: Vec<f64> = takes_part.iter().map(|t| f64::from(u8::from(*t))).collect();
        let (tentative, _) = tentative(&of, count, &modes, [1, 1]);
        let diagonal = vec![0.5; matrix.len()];
        let smoother = ProlongationSmoother { matrix: &matrix, strong: &strong, diagonal: &diagonal, largest: 2.0 };
        let smoothed = smoother.smoothed(&tentative, Some(&takes_part));
        for (i, takes_part) in takes_part.iter().enumerate() {
            assert_eq!(smoothed.row(i).count() > 0, *takes_part, "node {i}");
        }
    }
}
