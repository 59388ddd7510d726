//! Singular values of a tall matrix of few columns.

/// Sine of the angle between two columns below which they are orthogonal.
const ORTHOGONAL: f64 = 1e-15;
/// Sweeps over all pairs of columns; ten are many.
const SWEEPS: usize = 60;

/// The decomposition A = U S Vᵀ of a matrix with p columns, by rotations of pairs of columns (Hestenes 1958), which
/// find small singular values with their own relative accuracy.
#[derive(Clone, Debug)]
pub(super) struct SingularValues {
    /// The columns of U S, largest first.
    pub scaled: Vec<Vec<f64>>,
    /// The columns of V in the same order.
    pub right: Vec<Vec<f64>>,
    /// The singular values.
    pub values: Vec<f64>,
}

impl SingularValues {
    /// Decomposes the matrix with these columns.
    pub fn new(mut columns: Vec<Vec<f64>>) -> SingularValues {
        let p = columns.len();
        let mut right: Vec<Vec<f64>> = (0..p).map(|j| (0..p).map(|i| f64::from(u8::from(i == j))).collect()).collect();
        for _ in 0..SWEEPS {
            let mut is_done = true;
            for a in 0..p {
                for b in a + 1..p {
                    let [aa, bb, ab] = [(a, a), (b, b), (a, b)].map(|(i, j)| product(&columns[i], &columns[j]));
                    if ab.abs() <= ORTHOGONAL * (aa * bb).sqrt() {
                        continue;
                    }
                    is_done = false;
                    let zeta = 0.5 * (bb - aa) / ab;
                    let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
                    let cosine = 1.0 / tangent.hypot(1.0);
                    for of in [&mut columns, &mut right] {
                        rotate(of, [a, b], cosine, cosine * tangent);
                    }
                }
            }
            if is_done {
                break;
            }
        }
        let mut order: Vec<(f64, usize)> =
            columns.iter().enumerate().map(|(j, column)| (product(column, column).sqrt(), j)).collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let sorted = |of: &mut Vec<Vec<f64>>| order.iter().map(|&(_, j)| std::mem::take(&mut of[j])).collect();
        SingularValues {
            scaled: sorted(&mut columns),
            right: sorted(&mut right),
            values: order.iter().map(|(value, _)| *value).collect(),
        }
    }
}

/// Sum of the products of two columns.
pub(super) fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn rotate(columns: &mut [Vec<f64>], [a, b]: [usize; 2], cosine: f64, sine: f64) {
    let (before, after) = columns.split_at_mut(b);
    for (x, y) in before[a].iter_mut().zip(&mut after[0]) {
        (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A Läuchli matrix, whose small singular value the products AᵀA lose, and the columns of a rank of one.
    #[test]
    fn small_singular_values_are_exact() {
        let e = 1e-9;
        let found = SingularValues::new(vec![vec![1.0, e, 0.0], vec![1.0, 0.0, e]]);
        let exact = [(2.0 + e * e).sqrt(), e];
        for (found, exact) in found.values.iter().zip(exact) {
            assert!((found / exact - 1.0).abs() < 1e-14, "{found} {exact}");
        }
        let [x, y] = [found.right[1][0], found.right[1][1]];
        assert!((x + y).abs() < 1e-15 && (x.abs() - 0.5f64.sqrt()).abs() < 1e-15, "{x} {y}");
        let flat = SingularValues::new(vec![vec![2.0, 4.0], vec![1.0, 2.0], vec![0.0, 0.0]]);
        assert!((flat.values[0] - 5.0).abs() < 1e-14 && flat.values[1] < 1e-15 && flat.values[2] < 1e-15);
    }
}
