//! Sparse matrices of rectangular blocks, and their products.

use rayon::prelude::*;

use crate::linalg::pages::Numbers;

/// Block rows that are worked on at once: large enough to pay for a task, the same whatever the number of threads.
const CHUNK: usize = 1024;

/// A number that matrices are made of.
pub(super) trait Real:
    bytemuck::Pod
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
#[derive(Clone, Debug)]
pub(super) struct Blocks<T: Real> {
    /// Rows and columns of a block.
    pub shape: [usize; 2],
    /// Number of block columns.
    pub width: usize,
    pub start: Vec<u32>,
    pub columns: Vec<u32>,
    /// Blocks by rows.
    pub values: Numbers<T>,
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
        let (mut start, mut columns) = (Vec::with_capacity(rows + 1), Vec::new());
        start.push(0u32);
        columns.reserve_exact(chunks.iter().map(|c| c.columns.len()).sum());
        let count = chunks.iter().map(|c| c.values.len()).sum();
        let values = Numbers::of(count, |values| {
            let mut rest = values;
            for chunk in chunks {
                let before = columns.len() as u32;
                start.extend(chunk.ends.iter().map(|end| before + end));
                columns.extend(chunk.columns);
                let (own, others) = rest.split_at_mut(chunk.values.len());
                own.copy_from_slice(&chunk.values);
                rest = others;
            }
        });
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
        let values = Numbers::of(self.values.len(), |values| {
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
        });
        Blocks { shape: [c, r], width: self.len(), start, columns, values }
    }

    /// The product with another matrix. Its blocks are written where they stay, so that a large product is never in
    /// memory twice.
    pub fn times(&self, other: &Blocks<T>) -> Blocks<T> {
        let shape = [self.shape[0], other.shape[1]];
        let size = shape[0] * shape[1];
        let (start, columns) = self.pattern(other);
        let fill = |range: std::ops::Range<usize>, values: &mut [T]| {
            let (first, mut slot_of) = (start[range.start], vec![0u32; other.width]);
            for i in range {
                for slot in start[i]..start[i + 1] {
                    slot_of[columns[slot as usize] as usize] = slot - first;
                }
                for (k, a) in self.row(i) {
                    for (j, b) in other.row(k) {
                        let out = &mut values[slot_of[j] as usize * size..][..size];
                        add_product(a, b, out, [shape[0], self.shape[1], shape[1]]);
                    }
                }
            }
        };
        let values = Numbers::of(columns.len() * size, |values| {
            rayon::scope(|scope| {
                let mut rest = values;
                for first in (0..self.len()).step_by(CHUNK) {
                    let range = first..(first + CHUNK).min(self.len());
                    let (own, others) = rest.split_at_mut((start[range.end] - start[range.start]) as usize * size);
                    rest = others;
                    let fill = &fill;
                    scope.spawn(move |_| fill(range, own));
                }
            });
        });
        Blocks { shape, width: other.width, start, columns, values }
    }

    /// Where the rows of the product with another matrix begin, and the columns of their blocks.
    fn pattern(&self, other: &Blocks<T>) -> (Vec<u32>, Vec<u32>) {
        let of_chunk = |chunk: usize| {
            // The last row that a column was seen in, counted from one.
            let mut seen = vec![0u32; other.width];
            let (mut lengths, mut columns) = (Vec::with_capacity(CHUNK), Vec::new());
            for i in chunk * CHUNK..((chunk + 1) * CHUNK).min(self.len()) {
                let before = columns.len();
                for (k, _) in self.row(i) {
                    for (j, _) in other.row(k) {
                        if std::mem::replace(&mut seen[j], i as u32 + 1) != i as u32 + 1 {
                            columns.push(j as u32);
                        }
                    }
                }
                lengths.push((columns.len() - before) as u32);
            }
            (lengths, columns)
        };
        let chunks: Vec<(Vec<u32>, Vec<u32>)> = (0..self.len().div_ceil(CHUNK)).into_par_iter().map(of_chunk).collect();
        let (mut start, mut columns, mut end) = (Vec::with_capacity(self.len() + 1), Vec::new(), 0);
        start.push(0);
        columns.reserve_exact(chunks.iter().map(|(_, columns)| columns.len()).sum());
        for (lengths, own) in chunks {
            columns.extend(own);
            start.extend(lengths.iter().map(|length| {
                end += length;
                end
            }));
        }
        (start, columns)
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
        let values = &self.values[..];
        y.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, y)| {
            for (k, y) in y.iter_mut().enumerate() {
                let i = chunk * CHUNK + k;
                let (from, to) = (self.start[i] as usize, self.start[i + 1] as usize);
                let mut sum = if adds { *y } else { [T::default(); R] };
                let blocks = values[from * R * C..to * R * C].chunks_exact(R * C);
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
            values: Numbers::of(self.values.len(), |single| {
                single
                    .par_iter_mut()
                    .zip(&self.values[..])
                    .for_each(|(single, value)| *single = (value / scale) as f32);
            }),
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

/// out += A B of blocks r × m and m × c. Those of bodies in the plane and in space have sizes that the loops know.
pub(super) fn add_product<T: Real>(a: &[T], b: &[T], out: &mut [T], sizes: [usize; 3]) {
    match sizes {
        [_, 2, 3] => add_sized::<T, 2, 3>(a, b, out),
        [_, 3, 3] => add_sized::<T, 3, 3>(a, b, out),
        [_, 3, 6] => add_sized::<T, 3, 6>(a, b, out),
        [_, 6, 6] => add_sized::<T, 6, 6>(a, b, out),
        [r, m, c] => add_loops(a, b, out, [r, m, c]),
    }
}

fn add_sized<T: Real, const M: usize, const C: usize>(a: &[T], b: &[T], out: &mut [T]) {
    let ((a, _), (b, _), (out, _)) = (a.as_chunks::<M>(), b.as_chunks::<C>(), out.as_chunks_mut::<C>());
    let b: &[[T; C]] = &b[..M];
    for (a, out) in a.iter().zip(out) {
        for k in 0..M {
            for j in 0..C {
                out[j] += a[k] * b[k][j];
            }
        }
    }
}

fn add_loops<T: Real>(a: &[T], b: &[T], out: &mut [T], [r, m, c]: [usize; 3]) {
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

    /// Products of whole numbers are exact: (A B) x = A (B x), and x·(A y) = (Aᵀ x)·y, for every shape of block, with
    /// few rows and with those of several tasks.
    #[test]
    fn products_and_transposes() {
        let shapes = [[1, 1, 1], [2, 2, 3], [3, 3, 6], [6, 3, 6], [6, 6, 6], [3, 2, 2], [2, 3, 3], [4, 5, 2]];
        for ([r, m, c], rows) in shapes.into_iter().flat_map(|shape| [(shape, 9), (shape, 2 * CHUNK + 5)]) {
            let (a, b) = (sample(rows, 7, [r, m]), sample(7, 8, [m, c]));
            let x: Vec<f64> = (0..8 * c).map(|i| ((i * 5) % 7) as f64).collect();
            let (mut bx, mut abx, mut both) = (vec![0.0; 7 * m], vec![1.0; rows * r], vec![1.0; rows * r]);
            b.apply(&x, &mut bx, false);
            a.apply(&bx, &mut abx, true);
            let product = a.times(&b);
            product.apply(&x, &mut both, true);
            let wrong = abx.iter().zip(&both).position(|(one, other)| (one - other).abs() > 0.0);
            assert_eq!(wrong, None, "{r} {m} {c}, {rows} rows");
            for i in 0..rows {
                let columns: std::collections::HashSet<usize> = product.row(i).map(|(j, _)| j).collect();
                assert_eq!(columns.len(), product.row(i).count(), "a column stands twice in row {i}");
            }
            let y: Vec<f64> = (0..rows * r).map(|i| ((i * 3) % 5) as f64).collect();
            let (mut ay, mut aty) = (vec![0.0; rows * r], vec![0.0; 7 * m]);
            a.apply(&bx, &mut ay, false);
            a.transposed().apply(&y, &mut aty, false);
            let dot = |p: &[f64], q: &[f64]| p.iter().zip(q).map(|(p, q)| p * q).sum::<f64>();
            assert_eq!(dot(&ay, &y).to_bits(), dot(&bx, &aty).to_bits(), "{r} {m} {c}");
        }
    }
}
