//! Numeric factorization, supernode by supernode, each from its descendants in the elimination tree (left-looking: E.
//! G. Ng, B. W. Peyton, SIAM J. Sci. Comput. 14 (1993) 1034), and S on the columns that are not eliminated.
//!
//! The work is cut into pieces; it can be interrupted between them.

use std::ops::Range;

use faer::dyn_stack::MemStack;
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use faer::{Accum, Mat, MatMut, MatRef, Par, Spec};

use super::error::SolveError;
use super::factor::LowerTriangle;
use super::lu::work_space;
use super::stop::StopFlag;

/// Columns per block of the elimination.
const BLOCK: usize = 128;
/// Operations per piece of work: about a tenth of a second.
const PIECE: usize = 4_000_000_000;
/// Marks the end of a list of supernodes.
const NONE: u32 = u32::MAX;

/// Supernodes of a factor; its first `interior` columns are eliminated.
pub(super) struct Supernodes<'a> {
    symbolic: &'a SymbolicSupernodalCholesky<u32>,
    interior: usize,
    /// Supernode per column.
    owner: Vec<u32>,
    /// Start of the numbers of each supernode, stored one after the other.
    places: Vec<usize>,
}

/// The columns of a supernode as a dense panel.
struct DenseSupernode<'a> {
    columns: Range<usize>,
    leading: usize,
    values: &'a mut [f64],
}

/// Work space shared by the elimination of all panels.
struct EliminationWorkspace<'a> {
    /// Row in the current panel per row of the matrix.
    place: Vec<u32>,
    product: Vec<f64>,
    stop: &'a StopFlag,
}

/// Pending updates: per supernode a linked list of its descendants that have rows among its columns.
struct Waiting {
    head: Vec<u32>,
    link: Vec<u32>,
    /// Per supernode the position in its pattern of its first row that has not been used.
    next: Vec<usize>,
}

impl<'a> Supernodes<'a> {
    pub fn new(symbolic: &'a SymbolicSupernodalCholesky<u32>, interior: usize) -> Supernodes<'a> {
        let mut owner = vec![0; symbolic.nrows()];
        for s in 0..symbolic.n_supernodes() {
            for column in symbolic.supernode_begin()[s]..symbolic.supernode_end()[s] {
                owner[column as usize] = s as u32;
            }
        }
        let mut supernodes = Supernodes { symbolic, interior, owner, places: Vec::new() };
        let numbers =
            |s: usize| (supernodes.columns(s).len() + supernodes.pattern(s).len()) * supernodes.columns(s).len();
        let begins = (0..symbolic.n_supernodes()).scan(0, |end, s| Some(std::mem::replace(end, *end + numbers(s))));
        supernodes.places = begins.collect();
        supernodes
    }

    fn columns(&self, s: usize) -> Range<usize> {
        self.symbolic.supernode_begin()[s] as usize..self.symbolic.supernode_end()[s] as usize
    }

    /// Rows of a supernode below its columns.
    fn pattern(&self, s: usize) -> &[u32] {
        self.symbolic.supernode(s).pattern()
    }

    /// Start of the values of a supernode.
    pub fn offset(&self, s: usize) -> usize {
        self.places[s]
    }

    /// Number of columns of a supernode that are eliminated.
    fn eliminated(&self, s: usize) -> usize {
        let columns = self.columns(s);
        self.interior.clamp(columns.start, columns.end) - columns.start
    }

    /// Computes the factor of the matrix given by its lower half; the columns from `interior` on hold S.
    ///
    /// # Errors
    /// When a pivot is not positive, or the computation is interrupted.
    pub fn factorize(&self, lower: &LowerTriangle, values: &mut [f64], stop: &StopFlag) -> Result<(), SolveError> {
        let (count, size) = (self.symbolic.n_supernodes(), self.owner.len());
        let mut work = EliminationWorkspace { place: vec![0u32; size], product: Vec::new(), stop };
        let mut waiting = Waiting { head: vec![NONE; count], link: vec![NONE; count], next: vec![0; count] };
        for s in 0..count {
            stop.go_on()?;
            let (columns, pattern) = (self.columns(s), self.pattern(s));
            let leading = columns.len() + pattern.len();
            for (k, row) in (columns.start as u32..columns.end as u32).chain(pattern.iter().copied()).enumerate() {
                work.place[row as usize] = k as u32;
            }
            let (before, own) = values.split_at_mut(self.places[s]);
            let mut panel =
                DenseSupernode { columns: columns.clone(), leading, values: &mut own[..leading * columns.len()] };
            for (column, own) in columns.clone().zip(panel.values.chunks_exact_mut(leading)) {
                for (row, value) in lower.column(column) {
                    own[work.place[row as usize] as usize] = value;
                }
            }
            let mut d = waiting.head[s];
            while d != NONE {
                let after = waiting.link[d as usize];
                let from = waiting.next[d as usize];
                let to = self.update(d as usize, from, &mut panel, before, &mut work)?;
                self.wait(&mut waiting, d as usize, to);
                d = after;
            }
            let eliminated = self.eliminated(s);
            eliminate(panel.values, [leading, columns.len()], eliminated, stop)
                .map_err(|error| error.of(columns.start, size))?;
            if eliminated > 0 {
                self.wait(&mut waiting, s, 0);
            }
        }
        Ok(())
    }

    /// Adds a supernode to the list of the supernode whose columns contain its next row.
    fn wait(&self, waiting: &mut Waiting, d: usize, next: usize) {
        waiting.next[d] = next;
        if let Some(&row) = self.pattern(d).get(next) {
            let owner = self.owner[row as usize] as usize;
            waiting.link[d] = std::mem::replace(&mut waiting.head[owner], d as u32);
        }
    }

    /// Subtracts L_d L_dᵀ from a panel; returns the position of the first row of d after its columns.
    fn update(
        &self,
        d: usize,
        from: usize,
        panel: &mut DenseSupernode,
        before: &[f64],
        work: &mut EliminationWorkspace,
    ) -> Result<usize, SolveError> {
        let (pattern, width, used) = (self.pattern(d), self.columns(d).len(), self.eliminated(d));
        let to = from + pattern[from..].partition_point(|&row| (row as usize) < panel.columns.end);
        let leading = width + pattern.len();
        let l = MatRef::from_column_major_slice(&before[self.offset(d)..][..leading * width], leading, width);
        let strip = (PIECE / (2 * (pattern.len() - from) * used).max(1)).max(8);
        for first in (from..to).step_by(strip) {
            work.stop.go_on()?;
            let (rows, cols) = (pattern.len() - first, strip.min(to - first));
            work.product.resize(rows * cols, 0.0);
            let [left, right] = [rows, cols].map(|rows| l.submatrix(width + first, 0, rows, used));
            let target = MatMut::from_column_major_slice_mut(&mut work.product, rows, cols);
            matmul(target, Accum::Replace, left, right.transpose(), 1.0, Par::Seq);
            for (c, column) in work.product.chunks_exact(rows).enumerate() {
                let at = (pattern[first + c] as usize - panel.columns.start) * panel.leading;
                let target = &mut panel.values[at..at + panel.leading];
                for (&row, value) in pattern[first + c..].iter().zip(&column[c..]) {
                    target[work.place[row as usize] as usize] -= value;
                }
            }
        }
        Ok(to)
    }

    /// The condensed operator S, from the columns that are not eliminated.
    pub fn condensed(&self, values: &[f64]) -> Mat<f64> {
        let n = self.owner.len() - self.interior;
        let mut s = Mat::<f64>::zeros(n, n);
        for (node, columns) in (0..self.symbolic.n_supernodes()).map(|node| (node, self.columns(node))) {
            let rows: Vec<usize> = columns.clone().chain(self.pattern(node).iter().map(|&row| row as usize)).collect();
            for column in columns.start.max(self.interior)..columns.end {
                let at = self.offset(node) + (column - columns.start) * rows.len();
                for (k, &row) in rows.iter().enumerate().skip(column - columns.start) {
                    let (i, j) = (row - self.interior, column - self.interior);
                    s[(i, j)] = values[at + k];
                    s[(j, i)] = values[at + k];
                }
            }
        }
        s
    }
}

/// Succeeds if a dense symmetric matrix with `shift` added to its diagonal has a Cholesky factor.
///
/// # Errors
/// The column without a positive pivot, or the interruption.
pub(super) fn has_factor(matrix: MatRef<f64>, shift: f64, stop: &StopFlag) -> Result<(), Ended> {
    let n = matrix.nrows();
    let mut values = Vec::with_capacity(n * n);
    (0..n).for_each(|j| values.extend(matrix.col(j).iter().copied()));
    for j in 0..n {
        values[j * n + j] += shift;
    }
    eliminate(&mut values, [n, n], n, stop)
}

/// Reason why an elimination ended early.
pub(super) enum Ended {
    /// At this column without a positive pivot.
    NotPositive(usize),
    Stopped(SolveError),
}

impl Ended {
    /// The error, for columns that begin at column `first` of a matrix of size `size`.
    pub fn of(self, first: usize, size: usize) -> SolveError {
        match self {
            Ended::NotPositive(column) => SolveError::NotPositive { pivot: first + column, size },
            Ended::Stopped(error) => error,
        }
    }
}

/// Eliminates the first `eliminated` columns of a panel given by its lower half: these columns then hold L, the columns
/// after them the Schur complement.
fn eliminate(
    panel: &mut [f64],
    [leading, columns]: [usize; 2],
    eliminated: usize,
    stop: &StopFlag,
) -> Result<(), Ended> {
    for first in (0..eliminated).step_by(BLOCK) {
        let width = BLOCK.min(eliminated - first);
        let (_, rest) = panel.split_at_mut(first * leading);
        let (own, after) = rest.split_at_mut(width * leading);
        let own = MatMut::from_column_major_slice_mut(own, leading, width);
        let (mut diagonal, mut below) = own.split_at_row_mut(first).1.split_at_row_mut(width);
        let mut memory = work_space(cholesky_in_place_scratch::<f64>(width, Par::Seq, Spec::default()));
        cholesky_in_place(
            diagonal.as_mut(),
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut memory),
            Spec::default(),
        )
        .map_err(|LltError::NonPositivePivot { index }| Ended::NotPositive(first + index))?;
        solve_lower_triangular_in_place(diagonal.as_ref(), below.as_mut().transpose_mut(), Par::Seq);
        let (below, last) = (below.as_ref(), columns - first - width);
        let strip = (PIECE / (2 * below.nrows() * width).max(1)).max(BLOCK);
        for from in (0..last).step_by(strip) {
            stop.go_on().map_err(Ended::Stopped)?;
            let cols = strip.min(last - from);
            let target =
                MatMut::from_column_major_slice_mut(&mut after[from * leading..][..cols * leading], leading, cols);
            let target = target.split_at_row_mut(first + width + from).1;
            let rows = below.nrows() - from;
            let (left, right) = (below.submatrix(from, 0, rows, width), below.submatrix(from, 0, cols, width));
            matmul(target, Accum::Add, left, right.transpose(), -1.0, Par::Seq);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;

    use super::*;

    /// 4 on the diagonal, −1/n elsewhere: positive definite.
    fn sample(n: usize) -> Vec<f64> {
        (0..n * n).map(|k| if k / n == k % n { 4.0 } else { -1.0 / n as f64 }).collect()
    }

    /// L Lᵀ + S is the matrix, for any number of eliminated columns.
    #[test]
    fn an_elimination_ends_at_any_column() {
        let n = 2 * BLOCK + 37;
        let matrix = sample(n);
        for eliminated in [0, 1, BLOCK, BLOCK + 5, n] {
            let mut panel = matrix.clone();
            assert!(eliminate(&mut panel, [n, n], eliminated, &StopFlag::default()).is_ok());
            for (i, j) in (0..n).step_by(7).flat_map(|i| (0..=i).step_by(5).map(move |j| (i, j))) {
                let l = |i: usize, k: usize| panel[k * n + i];
                let product: f64 = (0..eliminated.min(j + 1)).map(|k| l(i, k) * l(j, k)).sum();
                let left = if j >= eliminated { l(i, j) } else { 0.0 };
                assert!((product + left - matrix[j * n + i]).abs() < 1e-14, "{eliminated}: ({i}, {j})");
            }
        }
    }

    /// A nonpositive pivot is reported, and an interruption ends the work.
    #[test]
    fn an_elimination_names_its_pivot_and_ends() {
        let n = BLOCK + 9;
        let mut panel = sample(n);
        panel[(BLOCK + 3) * n + BLOCK + 3] = -1.0;
        let found = eliminate(&mut panel, [n, n], n, &StopFlag::default());
        assert!(matches!(found, Err(Ended::NotPositive(column)) if column == BLOCK + 3));
        let stop = StopFlag::when(&Arc::new(AtomicBool::new(true)));
        assert!(matches!(eliminate(&mut sample(n), [n, n], n, &stop), Err(Ended::Stopped(SolveError::Interrupted))));
        assert_eq!(stop.looks(), 1);
    }

    /// At most one piece of work lies between two checks of the flag: n³/3 operations take at least so many checks.
    #[test]
    fn the_flag_is_looked_at_between_pieces() {
        let n = 3000;
        let stop = StopFlag::default();
        assert!(eliminate(&mut sample(n), [n, n], n, &stop).is_ok());
        let largest = 2 * n * n * BLOCK;
        assert!(largest <= PIECE && stop.looks() >= n / BLOCK, "{} looks", stop.looks());
    }
}
