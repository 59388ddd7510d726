//! LU factorization of a sparse complex matrix whose pattern is symmetric, with the determinant.
//!
//! The unknowns are eliminated supernode by supernode in a given order, each from its descendants in the elimination
//! tree; rows are exchanged within the diagonal block of a supernode only, so that the pattern is known before. This
//! suits the operators λ²M + λB + A of a body for Re λ > 0, whose real part is positive definite once they are divided
//! by λ: they need no exchange at all. Where the contact adds more than that, the growth shows in the residual, which
//! [`Pivots::solve`] reduces by one correction and its user checks.

use std::ops::Range;

use faer::dyn_stack::MemStack;
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place};
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use faer::sparse::linalg::cholesky::{SymbolicCholesky, SymbolicCholeskyRaw};
use faer::{Accum, MatMut, MatRef, Par, Spec, c64};

use super::error::SolveError;
use super::lu::work_space;
use super::supernodal::symbolic;

/// Marks the end of a list of supernodes.
const NONE: u32 = u32::MAX;
/// One and minus one.
const ONE: c64 = c64::new(1.0, 0.0);
const MINUS: c64 = c64::new(-1.0, 0.0);

/// A square matrix by columns, rows ascending within a column.
#[derive(Clone, Debug, Default)]
pub struct ComplexMatrix {
    /// Start of each column among the entries, and the number of entries.
    pub start: Vec<u32>,
    /// Row of each entry.
    pub rows: Vec<u32>,
    /// The entries.
    pub values: Vec<c64>,
}

impl ComplexMatrix {
    /// Number of columns.
    #[must_use]
    pub fn size(&self) -> usize {
        self.start.len().saturating_sub(1)
    }

    /// Rows and values of a column.
    pub fn column(&self, j: usize) -> impl Iterator<Item = (usize, c64)> + '_ {
        let range = self.start[j] as usize..self.start[j + 1] as usize;
        self.rows[range.clone()].iter().map(|row| *row as usize).zip(self.values[range].iter().copied())
    }

    /// y ← y + factor A x.
    pub fn add_product(&self, factor: c64, x: &[c64], y: &mut [c64]) {
        for (j, x) in x.iter().enumerate() {
            let x = factor * *x;
            self.column(j).for_each(|(row, value)| y[row] += value * x);
        }
    }

    /// y ← y − Aᵀ x.
    fn subtract_transposed(&self, x: &[c64], y: &mut [c64]) {
        for (j, y) in y.iter_mut().enumerate() {
            *y -= self.column(j).map(|(row, value)| value * x[row]).sum::<c64>();
        }
    }
}

/// The pattern of the factor of matrices with a symmetric pattern.
#[derive(Debug)]
pub struct Pattern {
    symbolic: SymbolicCholesky<u32>,
    /// Start of the numbers of each supernode in L and in U.
    places: Vec<[usize; 2]>,
    /// Supernode of each column.
    owner: Vec<u32>,
    size: usize,
}

/// The factors of a matrix: L with a unit diagonal and the diagonal blocks of U, and the rest of U by rows.
#[derive(Debug)]
pub struct Pivots<'a> {
    pattern: &'a Pattern,
    matrix: &'a ComplexMatrix,
    lower: Vec<c64>,
    upper: Vec<c64>,
    /// Row of the block of its supernode that is the pivot of each column.
    exchanged: Vec<u32>,
    /// The determinant as its angle in rad and the logarithm of its size.
    determinant: (f64, f64),
}

/// Pending updates: per supernode a linked list of its descendants that have rows among its columns.
struct WaitingNodes {
    head: Vec<u32>,
    link: Vec<u32>,
    next: Vec<usize>,
}

/// Work space of a factorization.
struct LuWork {
    /// Row in the present panel per row of the matrix.
    place: Vec<u32>,
    product: Vec<c64>,
    waiting: WaitingNodes,
}

impl Pattern {
    /// Finds the pattern of the factor for a matrix with a symmetric pattern.
    ///
    /// # Errors
    /// If it does not fit into memory.
    pub fn new(matrix: &ComplexMatrix) -> Result<Pattern, SolveError> {
        let size = matrix.size();
        let (mut start, mut rows) = (vec![0u32], Vec::new());
        for j in 0..size {
            let upper = matrix.rows[matrix.start[j] as usize..matrix.start[j + 1] as usize].iter();
            rows.extend(upper.copied().filter(|row| *row as usize <= j));
            start.push(rows.len() as u32);
        }
        let symbolic = symbolic(size, &start, &rows)?;
        let SymbolicCholeskyRaw::Supernodal(nodes) = symbolic.raw() else { return Err(SolveError::Memory { size }) };
        let (mut owner, mut places, mut ends) = (vec![0; size], Vec::new(), [0; 2]);
        for s in 0..nodes.n_supernodes() {
            let (columns, below) = (columns(nodes, s), nodes.supernode(s).pattern().len());
            owner[columns.clone()].fill(s as u32);
            places.push(ends);
            ends = [ends[0] + (columns.len() + below) * columns.len(), ends[1] + below * columns.len()];
        }
        places.push(ends);
        Ok(Pattern { symbolic, places, owner, size })
    }

    fn nodes(&self) -> Option<&SymbolicSupernodalCholesky<u32>> {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(nodes) => Some(nodes),
            SymbolicCholeskyRaw::Simplicial(_) => None,
        }
    }

    /// Number of entries of both factors.
    #[must_use]
    pub fn stored(&self) -> usize {
        self.places.last().map_or(0, |ends| ends[0] + ends[1])
    }
}

fn columns(nodes: &SymbolicSupernodalCholesky<u32>, s: usize) -> Range<usize> {
    nodes.supernode_begin()[s] as usize..nodes.supernode_end()[s] as usize
}

fn view(values: &[c64], rows: usize, columns: usize) -> MatRef<'_, c64> {
    MatRef::from_column_major_slice(values, rows, columns)
}

impl<'a> Pivots<'a> {
    /// Factorizes a matrix with this pattern, in the order of its unknowns.
    ///
    /// # Errors
    /// If a pivot is zero or not finite.
    pub fn new(pattern: &'a Pattern, matrix: &'a ComplexMatrix) -> Result<Pivots<'a>, SolveError> {
        let size = pattern.size;
        let Some(nodes) = pattern.nodes() else { return Err(SolveError::Memory { size }) };
        let count = nodes.n_supernodes();
        let ends = pattern.places[count];
        let mut made = Pivots {
            pattern,
            matrix,
            lower: vec![c64::default(); ends[0]],
            upper: vec![c64::default(); ends[1]],
            exchanged: vec![0; size],
            determinant: (0.0, 0.0),
        };
        let waiting = WaitingNodes { head: vec![NONE; count], link: vec![NONE; count], next: vec![0; count] };
        let mut work = LuWork { place: vec![0; size], product: Vec::new(), waiting };
        for s in 0..count {
            made.gather(nodes, s, &mut work);
            made.eliminate(nodes, s)?;
            wait(pattern, nodes, &mut work.waiting, s as u32, 0);
        }
        Ok(made)
    }

    /// Fills the panels of a supernode with the matrix and subtracts what its descendants add.
    fn gather(&mut self, nodes: &SymbolicSupernodalCholesky<u32>, s: usize, work: &mut LuWork) {
        let (own, below) = (columns(nodes, s), nodes.supernode(s).pattern());
        let (width, leading) = (own.len(), own.len() + below.len());
        for (k, row) in (own.start as u32..own.end as u32).chain(below.iter().copied()).enumerate() {
            work.place[row as usize] = k as u32;
        }
        let [l_at, u_at] = self.pattern.places[s];
        let (l_before, l_own) = self.lower.split_at_mut(l_at);
        let (u_before, u_own) = self.upper.split_at_mut(u_at);
        for (j, column) in own.clone().enumerate() {
            for (row, value) in self.matrix.column(column).filter(|(row, _)| *row >= own.start) {
                l_own[j * leading + work.place[row] as usize] = value;
            }
        }
        // The rows of U to the right of the columns: entries (own, row) of the columns `row` below.
        for &right in below {
            let at = work.place[right as usize] as usize - width;
            for (row, value) in self.matrix.column(right as usize).filter(|(row, _)| own.contains(row)) {
                u_own[(row - own.start) * below.len() + at] = value;
            }
        }
        let mut d = work.waiting.head[s];
        while d != NONE {
            let after = work.waiting.link[d as usize];
            let (from, rows) = (work.waiting.next[d as usize], nodes.supernode(d as usize).pattern());
            let to = from + rows[from..].partition_point(|row| (*row as usize) < own.end);
            let (k, [l_d, u_d]) = (columns(nodes, d as usize).len(), self.pattern.places[d as usize]);
            let left = view(&l_before[l_d..][..(k + rows.len()) * k], k + rows.len(), k);
            let right = view(&u_before[u_d..][..rows.len() * k], rows.len(), k);
            let left = left.submatrix(k, 0, rows.len(), k);
            // L of the rows from here on times U of the columns here, then U of the rows beyond times L of these rows.
            let (rest, here) = (rows.len() - from, to - from);
            subtract(&mut work.product, [left, right].map(|m| m.submatrix(from, 0, rest, k)), here, |r, c, value| {
                let column = rows[from + c] as usize - own.start;
                l_own[column * leading + work.place[rows[from + r] as usize] as usize] -= value;
            });
            let beyond = right.submatrix(to, 0, rows.len() - to, k);
            subtract(&mut work.product, [beyond, left.submatrix(from, 0, here, k)], here, |r, c, value| {
                let row = rows[from + c] as usize - own.start;
                u_own[row * below.len() + work.place[rows[to + r] as usize] as usize - width] -= value;
            });
            wait(self.pattern, nodes, &mut work.waiting, d, to);
            d = after;
        }
    }

    /// Eliminates the columns of a supernode.
    fn eliminate(&mut self, nodes: &SymbolicSupernodalCholesky<u32>, s: usize) -> Result<(), SolveError> {
        let (own, below) = (columns(nodes, s), nodes.supernode(s).pattern().len());
        let (width, leading, [l_at, u_at]) = (own.len(), own.len() + below, self.pattern.places[s]);
        let panel = MatMut::from_column_major_slice_mut(&mut self.lower[l_at..][..leading * width], leading, width);
        let (mut diagonal, mut rest) = panel.split_at_row_mut(width);
        let (mut forward, mut backward) = (vec![0u32; width], vec![0u32; width]);
        let mut memory = work_space(lu_in_place_scratch::<u32, c64>(width, width, Par::Seq, Spec::default()));
        let (info, _) = lu_in_place(
            diagonal.as_mut(),
            &mut forward,
            &mut backward,
            Par::Seq,
            MemStack::new(&mut memory),
            Spec::default(),
        );
        let (mut angle, mut size) = self.determinant;
        if info.transposition_count % 2 == 1 {
            angle += std::f64::consts::PI;
        }
        for j in 0..width {
            let pivot = diagonal[(j, j)];
            if !(pivot.norm().is_normal()) {
                return Err(SolveError::Singular { size: self.pattern.size });
            }
            angle += pivot.arg();
            size += pivot.norm().ln();
        }
        self.determinant = (angle, size);
        // L₂₁ = A₂₁ U₁₁⁻¹, and U₁₂ = L₁₁⁻¹ P A₁₂, which is kept by rows.
        let diagonal = diagonal.as_ref();
        solve_upper_transposed(diagonal, rest.as_mut());
        let mut turned = vec![c64::default(); width * below];
        let upper = &mut self.upper[u_at..][..below * width];
        for (j, row) in forward.iter().enumerate() {
            for i in 0..below {
                turned[i * width + j] = upper[*row as usize * below + i];
            }
        }
        let mut block = MatMut::from_column_major_slice_mut(&mut turned, width, below);
        solve_unit_lower_triangular_in_place(diagonal, block.as_mut(), Par::Seq);
        for j in 0..width {
            for i in 0..below {
                upper[j * below + i] = turned[i * width + j];
            }
        }
        self.exchanged[own].copy_from_slice(&forward);
        Ok(())
    }

    /// Angle of the determinant in rad, and the logarithm of its size.
    #[must_use]
    pub fn determinant(&self) -> (f64, f64) {
        self.determinant
    }

    /// Solves A x = r, with one correction by the residual.
    #[must_use]
    pub fn solve(&self, r: &[c64]) -> Vec<c64> {
        let mut x = r.to_vec();
        self.sweep(&mut x);
        let mut rest = r.to_vec();
        self.matrix.add_product(MINUS, &x, &mut rest);
        self.sweep(&mut rest);
        x.iter_mut().zip(&rest).for_each(|(x, change)| *x += *change);
        x
    }

    /// Solves Aᴴ x = r, with one correction by the residual.
    #[must_use]
    pub fn solve_adjoint(&self, r: &[c64]) -> Vec<c64> {
        let mut x: Vec<c64> = r.iter().map(c64::conj).collect();
        self.sweep_transposed(&mut x);
        let mut rest: Vec<c64> = r.iter().map(c64::conj).collect();
        self.matrix.subtract_transposed(&x, &mut rest);
        self.sweep_transposed(&mut rest);
        x.iter().zip(&rest).map(|(x, change)| (x + change).conj()).collect()
    }

    /// A forward sweep with Uᵀ and a backward one with Lᵀ.
    fn sweep_transposed(&self, x: &mut [c64]) {
        let Some(nodes) = self.pattern.nodes() else { return };
        let count = nodes.n_supernodes();
        for s in 0..count {
            let (own, below) = (columns(nodes, s), nodes.supernode(s).pattern());
            let (width, leading) = (own.len(), own.len() + below.len());
            let [l_at, u_at] = self.pattern.places[s];
            let (l, u) = (&self.lower[l_at..][..leading * width], &self.upper[u_at..][..below.len() * width]);
            for j in 0..width {
                let column = &l[j * leading..][..width];
                let known: c64 = column[..j].iter().zip(&x[own.start..]).map(|(u, x)| *u * *x).sum();
                let now = (x[own.start + j] - known) / column[j];
                x[own.start + j] = now;
                let row = &u[j * below.len()..][..below.len()];
                below.iter().zip(row).for_each(|(column, u)| x[*column as usize] -= *u * now);
            }
        }
        for s in (0..count).rev() {
            let (own, below) = (columns(nodes, s), nodes.supernode(s).pattern());
            let (width, leading) = (own.len(), own.len() + below.len());
            let l = &self.lower[self.pattern.places[s][0]..][..leading * width];
            let mut y = x[own.clone()].to_vec();
            for j in (0..width).rev() {
                let column = &l[j * leading..][..leading];
                let inside: c64 = column[j + 1..width].iter().zip(&y[j + 1..]).map(|(l, y)| *l * *y).sum();
                let outside: c64 = below.iter().zip(&column[width..]).map(|(row, l)| *l * x[*row as usize]).sum();
                y[j] -= inside + outside;
            }
            for (row, y) in self.exchanged[own.clone()].iter().zip(y) {
                x[own.start + *row as usize] = y;
            }
        }
    }

    /// A forward and a backward sweep.
    fn sweep(&self, x: &mut [c64]) {
        let Some(nodes) = self.pattern.nodes() else { return };
        let count = nodes.n_supernodes();
        for s in 0..count {
            let (own, below) = (columns(nodes, s), nodes.supernode(s).pattern());
            let (width, leading) = (own.len(), own.len() + below.len());
            let l = &self.lower[self.pattern.places[s][0]..][..leading * width];
            let mut y: Vec<c64> = self.exchanged[own.clone()].iter().map(|row| x[own.start + *row as usize]).collect();
            for j in 0..width {
                let (now, column) = (y[j], &l[j * leading..][..leading]);
                y[j + 1..].iter_mut().zip(&column[j + 1..width]).for_each(|(y, l)| *y -= *l * now);
                below.iter().zip(&column[width..]).for_each(|(row, l)| x[*row as usize] -= *l * now);
            }
            x[own].copy_from_slice(&y);
        }
        for s in (0..count).rev() {
            let (own, below) = (columns(nodes, s), nodes.supernode(s).pattern());
            let (width, leading) = (own.len(), own.len() + below.len());
            let [l_at, u_at] = self.pattern.places[s];
            let (l, u) = (&self.lower[l_at..][..leading * width], &self.upper[u_at..][..below.len() * width]);
            for j in (0..width).rev() {
                let row = &u[j * below.len()..][..below.len()];
                let known: c64 = below.iter().zip(row).map(|(column, u)| *u * x[*column as usize]).sum();
                x[own.start + j] -= known;
            }
            for j in (0..width).rev() {
                let column = &l[j * leading..][..width];
                let now = x[own.start + j] / column[j];
                x[own.start + j] = now;
                for (i, u) in column[..j].iter().enumerate() {
                    x[own.start + i] -= *u * now;
                }
            }
        }
    }
}

/// Adds a supernode to the list of the supernode whose columns contain its next row.
fn wait(pattern: &Pattern, nodes: &SymbolicSupernodalCholesky<u32>, waiting: &mut WaitingNodes, d: u32, next: usize) {
    waiting.next[d as usize] = next;
    if let Some(&row) = nodes.supernode(d as usize).pattern().get(next) {
        let owner = pattern.owner[row as usize] as usize;
        waiting.link[d as usize] = std::mem::replace(&mut waiting.head[owner], d);
    }
}

/// Calls `take` with the entries of A Bᵀ, B's first `columns` rows.
fn subtract(product: &mut Vec<c64>, [a, b]: [MatRef<c64>; 2], columns: usize, mut take: impl FnMut(usize, usize, c64)) {
    let (rows, k) = (a.nrows(), a.ncols());
    if rows == 0 || columns == 0 || k == 0 {
        return;
    }
    product.resize(rows * columns, c64::default());
    let target = MatMut::from_column_major_slice_mut(&mut product[..], rows, columns);
    matmul(target, Accum::Replace, a, b.submatrix(0, 0, columns, k).transpose(), ONE, Par::Seq);
    for (c, column) in product.chunks_exact(rows).enumerate() {
        column.iter().enumerate().for_each(|(r, value)| take(r, c, *value));
    }
}

/// X ← X U⁻¹ with the upper triangle of a block.
fn solve_upper_transposed(diagonal: MatRef<c64>, x: MatMut<c64>) {
    // X U = A is Uᵀ Xᵀ = Aᵀ, and Uᵀ is lower triangular.
    solve_lower_triangular_in_place(diagonal.transpose(), x.transpose_mut(), Par::Seq);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A complex matrix with the pattern of a grid, not symmetric, by a fixed sequence of numbers.
    fn sample(n: usize) -> ComplexMatrix {
        let size = n * n;
        let mut seed = 1u64;
        let mut next = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let near = |i: usize, j: usize| (i / n).abs_diff(j / n) <= 1 && (i % n).abs_diff(j % n) <= 1;
        let mut matrix = ComplexMatrix { start: vec![0], ..ComplexMatrix::default() };
        for j in 0..size {
            for i in (0..size).filter(|i| near(*i, j)) {
                matrix.rows.push(i as u32);
                matrix.values.push(c64::new(next() + if i == j { 1.0 } else { 0.0 }, next()));
            }
            matrix.start.push(matrix.rows.len() as u32);
        }
        matrix
    }

    /// Solutions and determinant are those of a dense factorization.
    #[test]
    fn the_factors_are_those_of_the_matrix() -> Result<(), SolveError> {
        for n in [1, 2, 5, 13] {
            let matrix = sample(n);
            let pattern = Pattern::new(&matrix)?;
            let made = Pivots::new(&pattern, &matrix)?;
            let size = matrix.size();
            let x: Vec<c64> = (0..size).map(|i| c64::new((i as f64).sin(), (2.0 * i as f64).cos())).collect();
            let mut r = vec![c64::default(); size];
            matrix.add_product(ONE, &x, &mut r);
            let error = made.solve(&r).iter().zip(&x).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
            assert!(error < 1e-11, "{n}: {error:e}");
            let adjoint = |j: usize| matrix.column(j).map(|(i, value)| value.conj() * x[i]).sum::<c64>();
            let r: Vec<c64> = (0..size).map(adjoint).collect();
            let error = made.solve_adjoint(&r).iter().zip(&x).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
            assert!(error < 1e-11, "{n}: adjoint {error:e}");
            let mut dense = faer::Mat::<c64>::zeros(size, size);
            for j in 0..size {
                matrix.column(j).for_each(|(i, value)| dense[(i, j)] = value);
            }
            let determinant = dense.determinant();
            let (angle, size) = made.determinant();
            assert!((size - determinant.norm().ln()).abs() < 1e-10, "{n}: {size} for {determinant:?}");
            let off = c64::from_polar(1.0, angle - determinant.arg());
            assert!((off - ONE).norm() < 1e-10, "{n}: {angle} for {}", determinant.arg());
        }
        Ok(())
    }
}
