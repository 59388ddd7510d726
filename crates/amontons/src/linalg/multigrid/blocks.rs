//! Sparse matrices of rectangular blocks, and their products.

use rayon::prelude::*;

/// Block rows that are worked on at once: large enough to pay for a task, the same whatever the number of threads.
const CHUNK: usize = 1024;

/// A number that matrices are made of.
pub(super) trait Real:
    Copy
    + Default
    + Send
    + Sync
    + std::ops::Add<Output = Self>
    + std::ops::Mul<Output = Self>
    + std::ops::AddAssign
    + 'static
{
}

impl Real for f32 {}
impl Real for f64 {}

/// A matrix of R × C blocks by compressed block rows.
#[derive(Clone, Debug, Default)]
pub(super) struct Blocks<T> {
    /// Rows and columns of a block.
    pub shape: [usize; 2],
    /// Number of block columns.
    pub width: usize,
    pub start: Vec<u32>,
    pub columns: Vec<u32>,
    /// Blocks by rows.
    pub values: Vec<T>,
}

impl<T: Real> Blocks<T> {
    /// Number of block rows.
    pub fn len(&self) -> usize {
        self.start.len().saturating_sub(1)
    }

    /// Block columns and blocks of a block row.
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, &[T])> {
        let (from, to) = (self.start[i] as usize, self.start[i + 1] as usize);
        let size = self.shape[0] * self.shape[1];
        let columns = self.columns[from..to].iter().map(|&j| j as usize);
        columns.zip(self.values[from * size..to * size].chunks_exact(size.max(1)))
    }

    /// Puts rows together that are made one after the other, some at once.
    pub fn from_rows<F>(rows: usize, width: usize, shape: [usize; 2], make: F) -> Blocks<T>
    where
        F: Fn(std::ops::Range<usize>) -> Rows<T> + Sync,
    {
        let chunks: Vec<Rows<T>> =
            (0..rows.div_ceil(CHUNK)).into_par_iter().map(|c| make(c * CHUNK..((c + 1) * CHUNK).min(rows))).collect();
        let (mut start, mut columns, mut values) = (Vec::with_capacity(rows + 1), Vec::new(), Vec::new());
        start.push(0u32);
        columns.reserve_exact(chunks.iter().map(|c| c.columns.len()).sum());
        values.reserve_exact(chunks.iter().map(|c| c.values.len()).sum());
        for chunk in chunks {
            let before = columns.len() as u32;
            start.extend(chunk.ends.iter().map(|end| before + end));
            columns.extend(chunk.columns);
            values.extend(chunk.values);
        }
        Blocks { shape, width, start, columns, values }
    }

    /// The transposed matrix.
    pub fn transposed(&self) -> Blocks<T> {
        let [r, c] = self.shape;
        let mut start = vec![0u32; self.width + 1];
        for &j in &self.columns {
            start[j as usize + 1] += 1;
        }
        for j in 0..self.width {
            start[j + 1] += start[j];
        }
        let mut filled = start.clone();
        let mut columns = vec![0u32; self.columns.len()];
        let mut values = vec![T::default(); self.values.len()];
        for i in 0..self.len() {
            for (j, block) in self.row(i) {
                let slot = filled[j] as usize;
                filled[j] += 1;
                columns[slot] = i as u32;
                let out = &mut values[slot * r * c..][..r * c];
                for a in 0..r {
                    for b in 0..c {
                        out[b * r + a] = block[a * c + b];
                    }
                }
            }
        }
        Blocks { shape: [c, r], width: self.len(), start, columns, values }
    }

    /// The product with another matrix.
    pub fn times(&self, other: &Blocks<T>) -> Blocks<T> {
        let shape = [self.shape[0], other.shape[1]];
        Blocks::from_rows(self.len(), other.width, shape, |range| {
            let mut rows = Rows::default();
            let mut slot_of = Slots::new(other.width);
            for i in range {
                let first = rows.columns.len();
                for (k, a) in self.row(i) {
                    for (j, b) in other.row(k) {
                        let slot = slot_of.at(j, first, &mut rows, shape[0] * shape[1]);
                        let out = &mut rows.values[slot * shape[0] * shape[1]..][..shape[0] * shape[1]];
                        add_product(a, b, out, [shape[0], self.shape[1], shape[1]]);
                    }
                }
                rows.ends.push(rows.columns.len() as u32);
            }
            rows
        })
    }

    /// y = A x, or y += A x.
    pub fn apply(&self, x: &[T], y: &mut [T], adds: bool) {
        match self.shape {
            [1, 1] => self.product::<1, 1>(x, y, adds),
            [2, 2] => self.product::<2, 2>(x, y, adds),
            [3, 3] => self.product::<3, 3>(x, y, adds),
            [6, 6] => self.product::<6, 6>(x, y, adds),
            [2, 3] => self.product::<2, 3>(x, y, adds),
            [3, 2] => self.product::<3, 2>(x, y, adds),
            [3, 6] => self.product::<3, 6>(x, y, adds),
            [6, 3] => self.product::<6, 3>(x, y, adds),
            [r, c] => {
                for i in 0..self.len() {
                    let out = &mut y[i * r..][..r];
                    if !adds {
                        out.fill(T::default());
                    }
                    for (j, block) in self.row(i) {
                        add_product(block, &x[j * c..][..c], out, [r, c, 1]);
                    }
                }
            }
        }
    }

    fn product<const R: usize, const C: usize>(&self, x: &[T], y: &mut [T], adds: bool) {
        let (x, _) = x.as_chunks::<C>();
        let (y, _) = y.as_chunks_mut::<R>();
        y.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, y)| {
            for (k, y) in y.iter_mut().enumerate() {
                let i = chunk * CHUNK + k;
                let (from, to) = (self.start[i] as usize, self.start[i + 1] as usize);
                let mut sum = if adds { *y } else { [T::default(); R] };
                let blocks = self.values[from * R * C..to * R * C].chunks_exact(R * C);
                for (&j, block) in self.columns[from..to].iter().zip(blocks) {
                    let x = &x[j as usize];
                    for a in 0..R {
                        for b in 0..C {
                            sum[a] += block[a * C + b] * x[b];
                        }
                    }
                }
                *y = sum;
            }
        });
    }
}

impl Blocks<f64> {
    /// The same in single precision, over a number.
    pub fn single(&self, scale: f64) -> Blocks<f32> {
        Blocks {
            shape: self.shape,
            width: self.width,
            start: self.start.clone(),
            columns: self.columns.clone(),
            values: self.values.iter().map(|value| (value / scale) as f32).collect(),
        }
    }
}

/// Rows that are put together.
#[derive(Clone, Debug)]
pub(super) struct Rows<T> {
    /// Where each row ends among the columns.
    pub ends: Vec<u32>,
    pub columns: Vec<u32>,
    pub values: Vec<T>,
}

impl<T> Default for Rows<T> {
    fn default() -> Rows<T> {
        Rows { ends: Vec::new(), columns: Vec::new(), values: Vec::new() }
    }
}

/// Where the block of a column stands in the row that is being made.
struct Slots(Vec<u32>);

impl Slots {
    fn new(width: usize) -> Slots {
        Slots(vec![u32::MAX; width])
    }

    /// The position of the block in column j, made if the row, which begins at `first`, does not have it.
    fn at<T: Real>(&mut self, j: usize, first: usize, rows: &mut Rows<T>, size: usize) -> usize {
        let slot = self.0[j] as usize;
        if slot >= first && slot < rows.columns.len() && rows.columns[slot] as usize == j {
            return slot;
        }
        let slot = rows.columns.len();
        self.0[j] = slot as u32;
        rows.columns.push(j as u32);
        rows.values.resize((slot + 1) * size, T::default());
        slot
    }
}

/// out += A B of blocks r × m and m × c.
pub(super) fn add_product<T: Real>(a: &[T], b: &[T], out: &mut [T], [r, m, c]: [usize; 3]) {
    for i in 0..r {
        for k in 0..m {
            let factor = a[i * m + k];
            for j in 0..c {
                out[i * c + j] += factor * b[k * c + j];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(rows: usize, width: usize, shape: [usize; 2]) -> Blocks<f64> {
        Blocks::from_rows(rows, width, shape, |range| {
            let mut made = Rows::default();
            for i in range {
                for j in (0..width).filter(|j| (i * 5 + j * 3) % 4 == 0) {
                    made.columns.push(j as u32);
                    made.values.extend((0..shape[0] * shape[1]).map(|k| ((i * 7 + j * 11 + k * 3) % 13) as f64 - 6.0));
                }
                made.ends.push(made.columns.len() as u32);
            }
            made
        })
    }

    /// Products of whole numbers are exact: (A B) x = A (B x), and x·(A y) = (Aᵀ x)·y, for every shape of block.
    #[test]
    fn products_and_transposes() {
        for [r, m, c] in [[1, 1, 1], [2, 2, 3], [3, 3, 6], [6, 3, 6], [6, 6, 6], [3, 2, 2], [2, 3, 3], [4, 5, 2]] {
            let (a, b) = (sample(9, 7, [r, m]), sample(7, 8, [m, c]));
            let x: Vec<f64> = (0..8 * c).map(|i| ((i * 5) % 7) as f64).collect();
            let (mut bx, mut abx, mut both) = (vec![0.0; 7 * m], vec![1.0; 9 * r], vec![1.0; 9 * r]);
            b.apply(&x, &mut bx, false);
            a.apply(&bx, &mut abx, true);
            a.times(&b).apply(&x, &mut both, true);
            assert_eq!(abx, both, "{r} {m} {c}");
            let y: Vec<f64> = (0..9 * r).map(|i| ((i * 3) % 5) as f64).collect();
            let (mut ay, mut aty) = (vec![0.0; 9 * r], vec![0.0; 7 * m]);
            a.apply(&bx, &mut ay, false);
            a.transposed().apply(&y, &mut aty, false);
            let dot = |p: &[f64], q: &[f64]| p.iter().zip(q).map(|(p, q)| p * q).sum::<f64>();
            assert_eq!(dot(&ay, &y).to_bits(), dot(&bx, &aty).to_bits(), "{r} {m} {c}");
        }
    }
}
