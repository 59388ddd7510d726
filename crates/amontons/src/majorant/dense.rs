//! Small dense problems: semidefinite equations, and least quadratics under equations.

/// Pivot relative to the diagonal below which a row depends on those before.
const DEPENDENT: f64 = 1e-11;
/// Diagonal relative to the largest one below which a row is zero: the square of round-off, as of a component of a
/// normal that would vanish.
const NONE: f64 = 64.0 * f64::EPSILON * f64::EPSILON;

/// The product of two vectors, with four partial sums.
pub(super) fn product(a: &[f64], b: &[f64]) -> f64 {
    let (fours, rest) = (a.chunks_exact(4).zip(b.chunks_exact(4)), a.len() / 4 * 4);
    let mut sums = [0.0; 4];
    for (a, b) in fours {
        (0..4).for_each(|i| sums[i] += a[i] * b[i]);
    }
    let rest: f64 = a[rest..].iter().zip(b.iter().skip(rest)).map(|(a, b)| a * b).sum();
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// Cholesky's factor of a symmetric semidefinite matrix, without the rows that depend on others.
#[derive(Debug)]
pub(super) struct Semidefinite {
    /// Rows of the lower triangle one after the other; the diagonal of a row that depends on others is zero.
    l: Vec<f64>,
    n: usize,
}

impl Semidefinite {
    /// The factor of a matrix whose lower triangle is given.
    pub fn new(matrix: &[Vec<f64>]) -> Semidefinite {
        let packed = matrix.iter().enumerate().flat_map(|(i, row)| row[..=i].iter().copied()).collect();
        Semidefinite::packed(packed, matrix.len())
    }

    /// The factor of a matrix whose lower triangle is given, row by row.
    pub fn packed(mut l: Vec<f64>, n: usize) -> Semidefinite {
        let largest = (0..n).map(|i| l[i * (i + 1) / 2 + i]).fold(0.0, f64::max);
        for i in 0..n {
            let (before, rest) = l.split_at_mut(i * (i + 1) / 2);
            let row = &mut rest[..=i];
            for j in 0..i {
                let other = &before[j * (j + 1) / 2..][..=j];
                let pivot = other[j];
                row[j] = if pivot > 0.0 { (row[j] - product(&row[..j], &other[..j])) / pivot } else { 0.0 };
            }
            let (diagonal, pivot) = (row[i], row[i] - product(&row[..i], &row[..i]));
            row[i] = if pivot > DEPENDENT * diagonal && pivot > NONE * largest { pivot.sqrt() } else { 0.0 };
        }
        Semidefinite { l, n }
    }

    /// A solution, if there is one; the unknowns of rows that depend on others are zero.
    pub fn solve(&self, right: &[f64]) -> Vec<f64> {
        let mut x = right.to_vec();
        self.solve_in_place(&mut x);
        x
    }

    /// L⁻¹ X in the place of X, given row by row; the rows that depend on others become zero.
    pub fn forward(&self, rows: &mut [f64], width: usize) {
        for i in 0..self.n {
            let own = &self.l[i * (i + 1) / 2..][..=i];
            let (before, rest) = rows.split_at_mut(i * width);
            let row = &mut rest[..width];
            if own[i] <= 0.0 {
                row.fill(0.0);
                continue;
            }
            for (other, l) in before.chunks_exact(width).zip(own) {
                row.iter_mut().zip(other).for_each(|(x, y)| *x -= l * y);
            }
            for x in row {
                *x /= own[i];
            }
        }
    }

    /// The same in the place of the right-hand side.
    pub fn solve_in_place(&self, x: &mut [f64]) {
        let row = |i: usize| &self.l[i * (i + 1) / 2..][..=i];
        for i in 0..self.n {
            let row = row(i);
            x[i] = if row[i] > 0.0 { (x[i] - product(&row[..i], &x[..i])) / row[i] } else { 0.0 };
        }
        for i in (0..self.n).rev() {
            let row = row(i);
            if row[i] > 0.0 {
                x[i] /= row[i];
            }
            let (before, own) = x.split_at_mut(i);
            let own = own[0];
            before.iter_mut().zip(row).for_each(|(x, l)| *x -= l * own);
        }
    }
}

/// The problem of the least ½ y·G y + h·y among the y with A y = c, of equations that may depend on each other.
#[derive(Debug)]
pub(super) struct Constrained {
    gram: Vec<Vec<f64>>,
    /// Rows of A over their lengths, as forces and moments have different units.
    rows: Vec<Vec<f64>>,
    sizes: Vec<f64>,
    normal: Semidefinite,
    inner: Semidefinite,
}

impl Constrained {
    pub fn new(gram: Vec<Vec<f64>>, rows: &[Vec<f64>]) -> Constrained {
        let n = gram.len();
        let sizes: Vec<f64> = rows.iter().map(|row| product(row, row).sqrt().max(f64::MIN_POSITIVE)).collect();
        let rows: Vec<Vec<f64>> =
            rows.iter().zip(&sizes).map(|(row, size)| row.iter().map(|x| x / size).collect()).collect();
        let normal: Vec<Vec<f64>> = rows.iter().map(|a| rows.iter().map(|b| product(a, b)).collect()).collect();
        let empty = Semidefinite::new(&[]);
        let mut problem = Constrained { gram, rows, sizes, normal: Semidefinite::new(&normal), inner: empty };
        // Z G Z + (I − Z) times a scale, Z = I − Aᵀ(AAᵀ)⁺A.
        let unit = |k: usize| -> Vec<f64> { (0..n).map(|j| f64::from(u8::from(j == k))).collect() };
        let scale = (0..n).map(|k| problem.gram[k][k]).fold(0.0, f64::max);
        let matrix: Vec<Vec<f64>> = (0..n)
            .map(|k| {
                let column = problem.projected(&unit(k));
                let image = problem.projected(&problem.times(&column));
                (0..n).map(|l| image[l] + scale * (f64::from(u8::from(k == l)) - column[l])).collect()
            })
            .collect();
        problem.inner = Semidefinite::new(&matrix);
        problem
    }

    fn times(&self, v: &[f64]) -> Vec<f64> {
        self.gram.iter().map(|row| product(row, v)).collect()
    }

    /// The shortest y with A y = c, c over the lengths of the rows.
    fn shortest(&self, right: &[f64]) -> Vec<f64> {
        let multipliers = self.normal.solve(right);
        (0..self.gram.len()).map(|k| self.rows.iter().zip(&multipliers).map(|(row, m)| row[k] * m).sum()).collect()
    }

    fn projected(&self, v: &[f64]) -> Vec<f64> {
        let across = self.shortest(&self.rows.iter().map(|row| product(row, v)).collect::<Vec<_>>());
        v.iter().zip(&across).map(|(a, b)| a - b).collect()
    }

    /// The least value's y with A y = 0.
    pub fn homogeneous(&self, linear: &[f64]) -> Vec<f64> {
        let slope: Vec<f64> = linear.iter().map(|x| 0.0 - x).collect();
        self.projected(&self.inner.solve(&self.projected(&slope)))
    }

    /// The least value's y with A y = c.
    pub fn solve(&self, linear: &[f64], right: &[f64]) -> Vec<f64> {
        let right: Vec<f64> = right.iter().zip(&self.sizes).map(|(x, size)| x / size).collect();
        let first = self.shortest(&right);
        let slope: Vec<f64> = self.times(&first).iter().zip(linear).map(|(a, b)| a + b).collect();
        first.iter().zip(&self.homogeneous(&slope)).map(|(a, b)| a + b).collect()
    }
}

/// XᵀGX, X of square blocks, each with its first row in G.
pub(super) fn congruent(gram: &[f64], k: usize, blocks: &[(usize, Vec<f64>)]) -> Vec<f64> {
    let n = k * blocks.len();
    let mut half = vec![0.0; n * n];
    for (row, of_row) in gram.chunks_exact(n).zip(half.chunks_exact_mut(n)) {
        for ((first, block), out) in blocks.iter().zip(of_row.chunks_exact_mut(k)) {
            for (x, weights) in row[*first..][..k].iter().zip(block.chunks_exact(k)) {
                out.iter_mut().zip(weights).for_each(|(out, weight)| *out += x * weight);
            }
        }
    }
    let mut whole = vec![0.0; n * n];
    for ((first, block), rows) in blocks.iter().zip(whole.chunks_exact_mut(k * n)) {
        for (i, weights) in block.chunks_exact(k).enumerate() {
            let image = &half[(first + i) * n..][..n];
            for (row, weight) in rows.chunks_exact_mut(n).zip(weights) {
                row.iter_mut().zip(image).for_each(|(out, x)| *out += weight * x);
            }
        }
    }
    whole
}

/// Remainder of a row, relative to the row, below which it depends on those before.
const DEPENDENT_ROW: f64 = 1e-9;

/// An orthonormal basis of the vectors of which the products with all rows vanish.
pub(super) fn kernel(rows: &[Vec<f64>], n: usize) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let add = |basis: &mut Vec<Vec<f64>>, row: &[f64], least: f64| {
        let size = product(row, row).sqrt();
        let mut rest = row.to_vec();
        for _ in 0..2 {
            for known in basis.iter() {
                let along = product(known, &rest);
                rest.iter_mut().zip(known).for_each(|(x, y)| *x -= along * y);
            }
        }
        let left = product(&rest, &rest).sqrt();
        let is_new = left > least * size;
        if is_new {
            basis.push(rest.iter().map(|x| x / left).collect());
        }
        is_new
    };
    for row in rows {
        add(&mut basis, row, DEPENDENT_ROW);
    }
    let known = basis.len();
    // Of n units, at least n − r leave a remainder of at least 1/√n.
    let mut order: Vec<(usize, f64)> =
        (0..n).map(|k| (k, basis.iter().map(|row| row[k] * row[k]).sum::<f64>())).collect();
    order.sort_by(|a, b| a.1.total_cmp(&b.1));
    for (k, _) in order {
        if basis.len() == n {
            break;
        }
        let unit: Vec<f64> = (0..n).map(|j| f64::from(u8::from(j == k))).collect();
        add(&mut basis, &unit, 1e-3);
    }
    basis.split_off(known)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A component that is round-off does not decide on the solution: the first row depends on the others.
    #[test]
    fn a_row_of_round_off_counts_as_zero() {
        let n = [1e-17, 0.3, -0.9];
        let matrix: Vec<Vec<f64>> = n.iter().map(|a| n.iter().map(|b| a * b).collect()).collect();
        let right = [3e-17, 0.6, -1.8];
        let found = Semidefinite::new(&matrix).solve(&right);
        for (row, right) in matrix.iter().zip(right) {
            assert!((product(row, &found) - right).abs() < 1e-14, "{found:?}");
        }
    }

    /// The kernel is orthonormal, annihilates the rows, and has the dimension that remains.
    #[test]
    fn a_kernel_annihilates_rows_that_depend_on_each_other() {
        let row = |seed: f64| -> Vec<f64> { (0..7).map(|k| (seed + 1.9 * f64::from(k)).sin()).collect() };
        let (a, b) = (row(0.3), row(1.1));
        let both: Vec<f64> = a.iter().zip(&b).map(|(a, b)| 2.0 * a - b).collect();
        let found = kernel(&[a.clone(), b.clone(), both, vec![0.0; 7]], 7);
        assert_eq!(found.len(), 5);
        for (i, v) in found.iter().enumerate() {
            assert!(product(v, &a).abs() < 1e-14 && product(v, &b).abs() < 1e-14);
            for (j, other) in found.iter().enumerate() {
                assert!((product(v, other) - f64::from(u8::from(i == j))).abs() < 1e-14);
            }
        }
    }
}
