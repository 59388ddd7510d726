//! Aggregates of nodes with their modes: the coarse spaces of smoothed aggregation.
//!
//! P. Vaněk, J. Mandel, M. Brezina, "Algebraic multigrid by smoothed aggregation for second and fourth order elliptic
//! problems", Computing 56 (1996) 179–196.

use super::blocks::{BlockRowBuilder, BlockRowMatrix};

/// Fraction of √(‖A_ii‖ ‖A_jj‖) above which two nodes are strongly coupled.
const STRONG: f64 = 0.02;
/// Fraction of its length below which a mode of an aggregate counts as a combination of those before.
const DEPENDENT: f64 = 1e-6;

/// Aggregate per node, or `None` for a node that no unknown of the coarse space moves.
pub(super) type Aggregates = Vec<Option<u32>>;

/// Strongly coupled neighbours per node, the node itself not included.
pub(super) fn strong(matrix: &BlockRowMatrix<f64>) -> BlockRowMatrix<f64> {
    let norm = |block: &[f64]| block.iter().map(|v| v * v).sum::<f64>().sqrt();
    let diagonal: Vec<f64> =
        (0..matrix.len()).map(|i| matrix.row(i).find(|(j, _)| *j == i).map_or(0.0, |(_, block)| norm(block))).collect();
    BlockRowMatrix::from_rows(matrix.len(), matrix.width, [0, 0], |range| {
        let mut rows = BlockRowBuilder::default();
        for i in range {
            let joined =
                |&(j, block): &(usize, &[f64])| j != i && norm(block) > STRONG * (diagonal[i] * diagonal[j]).sqrt();
            rows.columns.extend(matrix.row(i).filter(joined).map(|(j, _)| j as u32));
            rows.ends.push(rows.columns.len() as u32);
        }
        rows
    })
}

/// Groups nodes into aggregates: a node without an aggregated neighbour takes all its neighbours; the remaining nodes
/// join the aggregate of a neighbour, or form one with remaining neighbours.
pub(super) fn aggregates(strong: &BlockRowMatrix<f64>, takes_part: &[bool]) -> (Aggregates, usize) {
    let n = takes_part.len();
    let neighbours =
        |i: usize| strong.columns[strong.start[i] as usize..strong.start[i + 1] as usize].iter().map(|&j| j as usize);
    let (mut of, mut count): (Aggregates, u32) = (vec![None; n], 0);
    for i in (0..n).filter(|&i| takes_part[i]) {
        if of[i].is_none() && neighbours(i).all(|j| of[j].is_none()) && neighbours(i).any(|j| takes_part[j]) {
            of[i] = Some(count);
            for j in neighbours(i).filter(|&j| takes_part[j]) {
                of[j] = Some(count);
            }
            count += 1;
        }
    }
    let first = of.clone();
    for i in (0..n).filter(|&i| takes_part[i] && first[i].is_none()) {
        of[i] = neighbours(i).find_map(|j| first[j]);
    }
    for i in (0..n).filter(|&i| takes_part[i]) {
        if of[i].is_none() {
            of[i] = Some(count);
            for j in neighbours(i) {
                if takes_part[j] && of[j].is_none() {
                    of[j] = Some(count);
                }
            }
            count += 1;
        }
    }
    (of, count as usize)
}

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
