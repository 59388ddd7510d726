//! Laws that are evaluated for many points at once.
//!
//! A law is a function of one point, which the solver calls wherever it needs a value: in a loop over points, and within
//! the scalar iteration of a point. A function of arrays is slow if it is called like that. [`Arrays`] calls it once per
//! round for all points together: while [`per_point`] or [`all_at_once`] runs, arguments without a known value are
//! collected and the points that need them are set aside; the function then gets all of them as rows, and these points
//! are computed again. A law is a pure function, so the results are those of calls point by point, to the last bit.
//!
//! Elsewhere a value is computed at once, from an array of one row.

use std::cell::Cell;
use std::collections::HashMap;
use std::fmt::Debug;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Most arguments of a law.
pub const INPUTS: usize = 10;

/// The arguments of a law at a point; unused ones are 0.
pub type Inputs = [f64; INPUTS];

/// A law on arrays: a pure function of each row.
pub trait ArrayFunction: Debug + Send + Sync {
    /// Computes the values of all rows, in their order. `out` has room for the same number of values per row.
    fn evaluate(&self, rows: &[Inputs], out: &mut [f64]);
}

/// A function of arrays that can be asked for the values of one point.
#[derive(Debug)]
pub struct Arrays {
    function: Arc<dyn ArrayFunction>,
    outputs: usize,
    /// Values known so far, while arguments are collected.
    known: Mutex<Option<Known>>,
}

/// Arguments with their values.
#[derive(Debug, Default)]
struct Known {
    /// Number of each row by the bits of its arguments.
    rows: HashMap<[u64; INPUTS], usize>,
    /// Values of the first rows.
    values: Vec<f64>,
    /// Arguments of the rows after these.
    wanted: Vec<Inputs>,
}

thread_local! {
    /// Whether the point that this thread computes lacks a value; none outside of [`per_point`].
    static LACKS: Cell<Option<bool>> = const { Cell::new(None) };
}

impl Arrays {
    /// A function with this many values per row.
    #[must_use]
    pub fn new(function: Arc<dyn ArrayFunction>, outputs: usize) -> Arrays {
        Arrays { function, outputs, known: Mutex::new(None) }
    }

    /// The values at a point, at most `N` of them. While arguments are collected, values that are not known yet are 0,
    /// and the point is computed again.
    #[must_use]
    pub fn at<const N: usize>(&self, inputs: &Inputs) -> [f64; N] {
        let mut out = [0.0; N];
        let mut known = self.lock();
        let Some(collected) = known.as_mut() else {
            drop(known);
            let mut row = vec![0.0; self.outputs];
            self.function.evaluate(&[*inputs], &mut row);
            out.iter_mut().zip(&row).for_each(|(out, value)| *out = *value);
            return out;
        };
        if LACKS.get() == Some(true) {
            return out;
        }
        let next = collected.rows.len();
        let row = *collected.rows.entry(inputs.map(f64::to_bits)).or_insert(next);
        if let Some(values) = collected.values.chunks_exact(self.outputs).nth(row) {
            out.iter_mut().zip(values).for_each(|(out, value)| *out = *value);
            return out;
        }
        if row == next {
            collected.wanted.push(*inputs);
        }
        if LACKS.get().is_some() {
            LACKS.set(Some(true));
        }
        out
    }

    /// Computes the values of the arguments collected; whether there were any.
    fn evaluate(&self) -> bool {
        let wanted = self.lock().as_mut().map(|known| std::mem::take(&mut known.wanted)).unwrap_or_default();
        if wanted.is_empty() {
            return false;
        }
        let mut values = vec![0.0; wanted.len() * self.outputs];
        self.function.evaluate(&wanted, &mut values);
        if let Some(known) = self.lock().as_mut() {
            known.values.extend(values);
        }
        true
    }

    fn lock(&self) -> MutexGuard<'_, Option<Known>> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Laws that collect arguments, until it is dropped.
struct Collecting<'a>(&'a [&'a Arrays]);

impl<'a> Collecting<'a> {
    fn begin(laws: &'a [&'a Arrays]) -> Collecting<'a> {
        laws.iter().for_each(|law| *law.lock() = Some(Known::default()));
        Collecting(laws)
    }

    /// Computes the values that are wanted; whether there were any.
    fn evaluate(&self) -> bool {
        self.0.iter().fold(false, |any, law| law.evaluate() || any)
    }
}

impl Drop for Collecting<'_> {
    fn drop(&mut self) {
        self.0.iter().for_each(|law| *law.lock() = None);
        LACKS.set(None);
    }
}

/// Computes `of` for each of so many points, the values of laws on arrays for all points together. At each point the
/// laws may be asked for values that depend on others, one after the other.
pub fn per_point<T>(laws: &[&Arrays], count: usize, of: impl Fn(usize) -> T) -> Vec<T> {
    if laws.is_empty() || LACKS.get().is_some() {
        return (0..count).map(of).collect();
    }
    let collecting = Collecting::begin(laws);
    let mut done: Vec<Option<T>> = (0..count).map(|_| None).collect();
    let mut left: Vec<usize> = (0..count).collect();
    while !left.is_empty() {
        left.retain(|&i| {
            LACKS.set(Some(false));
            let value = of(i);
            let lacks = LACKS.get() == Some(true);
            if !lacks {
                done[i] = Some(value);
            }
            lacks
        });
        collecting.evaluate();
    }
    done.into_iter().flatten().collect()
}

/// Computes `pass` with the values of laws on arrays for all points together. `pass` is computed again until no value is
/// missing: twice where the arguments of the laws do not depend on values of theirs. It may work on several threads.
pub fn all_at_once<T>(laws: &[&Arrays], mut pass: impl FnMut() -> T) -> T {
    if laws.is_empty() || LACKS.get().is_some() {
        return pass();
    }
    let collecting = Collecting::begin(laws);
    loop {
        let made = pass();
        if !collecting.evaluate() {
            return made;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use rayon::prelude::*;

    use super::*;

    /// x ↦ x², 3x, with the calls and the rows counted.
    #[derive(Debug, Default)]
    struct Square {
        calls: AtomicUsize,
        rows: AtomicUsize,
    }

    impl ArrayFunction for Square {
        fn evaluate(&self, rows: &[Inputs], out: &mut [f64]) {
            self.calls.fetch_add(1, Ordering::Relaxed);
            self.rows.fetch_add(rows.len(), Ordering::Relaxed);
            for (row, out) in rows.iter().zip(out.chunks_exact_mut(2)) {
                out.copy_from_slice(&[row[0] * row[0], 3.0 * row[0]]);
            }
        }
    }

    fn at(law: &Arrays, x: f64) -> [f64; 2] {
        let mut inputs = Inputs::default();
        inputs[0] = x;
        law.at(&inputs)
    }

    #[test]
    fn values_that_depend_on_values_take_a_call_each_for_all_points() {
        let square = Arc::new(Square::default());
        let (law, other) = (Arrays::new(Arc::<Square>::clone(&square), 2), Arrays::new(Arc::new(Square::default()), 2));
        // ((i²)²)², at points of which every two have the same arguments.
        let powers = per_point(&[&law, &other], 10, |i| {
            let square = at(&law, at(&law, (i / 2) as f64)[0])[0];
            at(&other, square)[0]
        });
        let expected: Vec<f64> = (0..10).map(|i: i32| f64::from(i / 2).powi(8)).collect();
        assert_eq!(powers, expected);
        // 0 and 1 are their own squares: 0 1 2 3 4, then 4 9 16, of which 4 is known.
        assert_eq!((square.calls.load(Ordering::Relaxed), square.rows.load(Ordering::Relaxed)), (2, 7));
        // Outside, a value takes a call.
        assert_eq!(at(&law, 5.0), [25.0, 15.0]);
        assert_eq!(square.calls.load(Ordering::Relaxed), 3);
    }

    #[test]
    fn passes_on_several_threads_take_one_call() {
        let square = Arc::new(Square::default());
        let law = Arrays::new(Arc::<Square>::clone(&square), 2);
        let sum: f64 = all_at_once(&[&law], || {
            let all: Vec<f64> = (0..1000).into_par_iter().map(|i| at(&law, f64::from(i))[1]).collect();
            all.iter().sum()
        });
        assert_eq!(sum.to_bits(), (3.0f64 * 499_500.0).to_bits());
        assert_eq!((square.calls.load(Ordering::Relaxed), square.rows.load(Ordering::Relaxed)), (1, 1000));
    }
}
