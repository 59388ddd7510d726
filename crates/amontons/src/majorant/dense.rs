//! Small dense problems: semidefinite equations, and least quadratics under equations.

/// Pivot relative to the diagonal below which a row depends on those before.
const DEPENDENT: f64 = 1e-11;

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Cholesky's factor of a symmetric semidefinite matrix, without the rows that depend on others.
#[derive(Debug)]
pub(super) struct Semidefinite {
    l: Vec<Vec<f64>>,
    kept: Vec<usize>,
}

impl Semidefinite {
    pub fn new(mut l: Vec<Vec<f64>>) -> Semidefinite {
        let n = l.len();
        let mut kept: Vec<usize> = Vec::with_capacity(n);
        for j in 0..n {
            let before: f64 = kept.iter().map(|&k| l[j][k] * l[j][k]).sum();
            let (diagonal, pivot) = (l[j][j], l[j][j] - before);
            if pivot.is_nan() || pivot <= DEPENDENT * diagonal {
                continue;
            }
            let root = pivot.sqrt();
            let own = std::mem::take(&mut l[j]);
            for row in &mut l[j + 1..] {
                let sum: f64 = kept.iter().map(|&k| row[k] * own[k]).sum();
                row[j] = (row[j] - sum) / root;
            }
            l[j] = own;
            l[j][j] = root;
            kept.push(j);
        }
        Semidefinite { l, kept }
    }

    /// A solution, if there is one; the unknowns of rows that depend on others are zero.
    pub fn solve(&self, right: &[f64]) -> Vec<f64> {
        let (l, kept) = (&self.l, &self.kept);
        let mut x = vec![0.0; right.len()];
        for (place, &i) in kept.iter().enumerate() {
            let sum: f64 = kept[..place].iter().map(|&k| l[i][k] * x[k]).sum();
            x[i] = (right[i] - sum) / l[i][i];
        }
        for (place, &i) in kept.iter().enumerate().rev() {
            let sum: f64 = kept[place + 1..].iter().map(|&k| l[k][i] * x[k]).sum();
            x[i] = (x[i] - sum) / l[i][i];
        }
        x
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
        let normal = rows.iter().map(|a| rows.iter().map(|b| product(a, b)).collect()).collect();
        let empty = Semidefinite::new(Vec::new());
        let mut problem = Constrained { gram, rows, sizes, normal: Semidefinite::new(normal), inner: empty };
        // Z G Z + (I − Z) times a scale, Z = I − Aᵀ(AAᵀ)⁺A.
        let unit = |k: usize| -> Vec<f64> { (0..n).map(|j| f64::from(u8::from(j == k))).collect() };
        let scale = (0..n).map(|k| problem.gram[k][k]).fold(0.0, f64::max);
        let matrix = (0..n)
            .map(|k| {
                let column = problem.projected(&unit(k));
                let image = problem.projected(&problem.times(&column));
                (0..n).map(|l| image[l] + scale * (f64::from(u8::from(k == l)) - column[l])).collect()
            })
            .collect();
        problem.inner = Semidefinite::new(matrix);
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
