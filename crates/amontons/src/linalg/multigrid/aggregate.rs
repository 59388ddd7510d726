//! Aggregates of strongly coupled nodes: the nodes of the coarser levels of smoothed aggregation.
//!
//! P. Vaněk, J. Mandel, M. Brezina, "Algebraic multigrid by smoothed aggregation for second and fourth order elliptic
//! problems", Computing 56 (1996) 179–196.

use rayon::prelude::*;

use super::blocks::BlockRowMatrix;
use crate::tensor::Point;

/// Fraction of √(s_i s_j) above which two nodes are strongly coupled; s_i is the largest s_ij with j ≠ i. In cells as
/// wide as high all neighbours are, in cells four times as wide as high those across alone.
const STRONG: f64 = 0.15;
/// Mean number of nodes of an aggregate below which neighbouring aggregates are joined: a row of nodes has aggregates
/// of three, and with the six unknowns of a coarse node its levels would be larger than the matrix.
const FEW: usize = 5;

/// Nodes per task.
const NODES: usize = 1024;

/// Neighbours of each node.
pub(super) struct Neighbours {
    start: Vec<u32>,
    nodes: Vec<u32>,
}

impl Neighbours {
    /// Neighbours of `count` nodes: `add` adds those of a node.
    fn by_rows(count: usize, add: impl Fn(usize, &mut Vec<u32>) + Sync) -> Neighbours {
        let row = |i: usize| {
            let mut row = Vec::new();
            add(i, &mut row);
            row
        };
        let rows: Vec<Vec<u32>> = (0..count).into_par_iter().with_min_len(NODES).map(row).collect();
        let mut start = vec![0];
        start.extend(rows.iter().scan(0, |end, row| {
            *end += row.len() as u32;
            Some(*end)
        }));
        Neighbours { start, nodes: rows.concat() }
    }

    /// Neighbours of a node, in ascending order.
    pub fn of(&self, node: usize) -> &[u32] {
        &self.nodes[self.start[node] as usize..self.start[node + 1] as usize]
    }
}

/// Aggregate per node, or `None` for a node that no unknown of the coarse space moves.
pub(super) type Aggregates = Vec<Option<u32>>;

/// Strongly coupled neighbours per node, the node itself not included: along their couplings, error that the smoother
/// leaves varies slowly. Two measures have to agree, s_ij = ‖A_ij‖ and s_ij = 1/|x_i − x_j|². The first one sees
/// coefficients; the second one sees flat hexahedra and quadratic cells, whose matrices have large entries sideways, as
/// a mass matrix has them. `points` may be empty: then the first measure decides.
pub(super) fn strong(matrix: &BlockRowMatrix<f64>, points: &[Point]) -> Neighbours {
    let norm = |_: usize, (_, block): (usize, &[f64])| block.iter().map(|v| v * v).sum::<f64>().sqrt();
    let near = |i: usize, (j, _): (usize, &[f64])| match (points.get(i), points.get(j)) {
        (Some(x), Some(y)) => (0..3).map(|c| (x[c] - y[c]).powi(2)).sum::<f64>().recip(),
        _ => 1.0,
    };
    let largest = |measure: &(dyn Fn(usize, (usize, &[f64])) -> f64 + Sync)| -> Vec<f64> {
        let of_row = |i: usize| {
            let others = matrix.row(i).filter(|(j, _)| *j != i).map(|other| measure(i, other));
            others.filter(|s| s.is_finite()).fold(0.0, f64::max)
        };
        (0..matrix.len()).into_par_iter().with_min_len(NODES).map(of_row).collect()
    };
    let (largest_norm, nearest) = (largest(&norm), largest(&near));
    Neighbours::by_rows(matrix.len(), |i, row| {
        let exceeds = |s: f64, of: &[f64], j: usize| s > STRONG * (of[i] * of[j]).sqrt();
        let is_strong = |&other: &(usize, &[f64])| {
            let j = other.0;
            j != i && exceeds(norm(i, other), &largest_norm, j) && exceeds(near(i, other), &nearest, j)
        };
        row.extend(matrix.row(i).filter(is_strong).map(|(j, _)| j as u32));
    })
}

/// Mean points of the nodes of each aggregate.
pub(super) fn centers(of: &Aggregates, count: usize, points: &[Point]) -> Vec<Point> {
    let mut sums = vec![([0.0; 3], 0.0); count];
    for (aggregate, point) in of.iter().zip(points) {
        if let Some((sum, nodes)) = aggregate.and_then(|a| sums.get_mut(a as usize)) {
            sum.iter_mut().zip(point).for_each(|(sum, x)| *sum += x);
            *nodes += 1.0;
        }
    }
    if points.is_empty() { Vec::new() } else { sums.into_iter().map(|(sum, nodes)| sum.map(|x| x / nodes)).collect() }
}

/// Groups nodes into aggregates of strongly coupled nodes, and groups of few nodes once more.
pub(super) fn aggregates(strong: &Neighbours, takes_part: &[bool]) -> (Aggregates, usize) {
    let (of, count) = grouped(strong, takes_part);
    let nodes = takes_part.iter().filter(|takes_part| **takes_part).count();
    if nodes >= FEW * count {
        return (of, count);
    }
    let mut members = vec![Vec::new(); count];
    for (i, aggregate) in of.iter().enumerate() {
        if let Some(a) = aggregate {
            members[*a as usize].push(i);
        }
    }
    let between = Neighbours::by_rows(count, |a, row| {
        let near = members[a].iter().flat_map(|&i| strong.of(i)).filter_map(|&j| of[j as usize]);
        row.extend(near.filter(|b| *b as usize != a));
        row.sort_unstable();
        row.dedup();
    });
    let (joined, count) = grouped(&between, &vec![true; count]);
    (of.into_iter().map(|aggregate| aggregate.and_then(|a| joined[a as usize])).collect(), count)
}

/// Groups nodes: a node without a grouped neighbour takes all its neighbours; the remaining nodes join the group of a
/// neighbour, or form one with remaining neighbours.
fn grouped(near: &Neighbours, takes_part: &[bool]) -> (Aggregates, usize) {
    let n = takes_part.len();
    let neighbours = |i: usize| near.of(i).iter().map(|&j| j as usize);
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
