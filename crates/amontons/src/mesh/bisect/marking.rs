//! The cells that cause an error.

/// Share of the error that the marked cells have (Dörfler, 1996): with a half of it refinement has the best rate, and
/// more rounds than with more.
const MARKED: f64 = 0.5;
/// Relative difference of two errors of cells that are equal but for round-off, as those of mirrored cells.
const SAME: f64 = 1e-6;

/// The cells with the largest of these errors, as few as have half of their sum together, ascending. Cells with equal
/// errors are all marked or none, so that what is symmetric stays so.
#[must_use]
pub fn decisive_cells(errors: &[f64]) -> Vec<usize> {
    let mut order: Vec<(usize, f64)> = errors.iter().copied().enumerate().collect();
    order.sort_by(|(i, a), (j, b)| b.total_cmp(a).then(i.cmp(j)));
    let (mut sum, mut last) = (0.0, f64::INFINITY);
    let enough = MARKED * errors.iter().sum::<f64>();
    let is_marked = |&(_, error): &(usize, f64)| {
        let takes = sum < enough || error >= last * (1.0 - SAME);
        if takes {
            (sum, last) = (sum + error, error);
        }
        takes && error > 0.0
    };
    let mut marked: Vec<usize> = order.into_iter().take_while(is_marked).map(|(cell, _)| cell).collect();
    marked.sort_unstable();
    marked
}
