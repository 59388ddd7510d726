//! Laws that are evaluated for many points at once.
//!
//! A law is a function of one point, which the solver calls wherever it needs a value: in a loop over points, and
//! within the scalar iteration of a point. An array function is slow if called like that. [`Arrays`] calls it once per
//! round for all points together: while [`per_point`] or [`all_at_once`] runs, arguments without a known value are
//! collected and the points that need them are set aside; the function then gets all of them as rows, and these points
//! are computed again. A law is a pure function, so the results equal those of calls point by point, to the last bit.
//!
//! Outside of these functions a value is computed at once, from an array of one row.

use std::cell::Cell;
use std::collections::HashMap;
use std::fmt::{self, Debug};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Largest number of arguments of a law.
pub const INPUTS: usize = 10;

/// The arguments of a law at a point; unused ones are 0.
pub type Inputs = [f64; INPUTS];

/// A law on arrays: a pure function of each row.
pub trait ArrayFunction: Debug + Send + Sync {
    /// Computes the values of all rows, in their order. `out` has room for the same number of values per row.
    fn evaluate(&self, rows: &[Inputs], out: &mut [f64]);
}

/// An array function that can be evaluated at a single point. Clones share their collected arguments.
#[derive(Clone)]
pub struct Arrays {
    function: Arc<dyn ArrayFunction>,
    outputs: usize,
    known: Arc<Mutex<Known>>,
}

/// A law that is given by array functions and its constants.
#[derive(Debug)]
pub(crate) struct OnArrays<D>(pub(crate) D);

impl Debug for Arrays {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.function.fmt(f)
    }
}

/// Arguments with their values.
#[derive(Default)]
struct Known {
    /// Number of active collections; values are kept only while there is one.
    collecting: usize,
    /// Number of times that a value was unknown.
    misses: u64,
    /// Number of each row by the bits of its arguments.
    rows: HashMap<[u64; INPUTS], usize>,
    /// Values of the first rows.
    values: Vec<f64>,
    /// Arguments of the further rows, without values yet.
    wanted: Vec<Inputs>,
}

/// State of a thread: true in `takes` if missing values are collected and the computation is repeated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct ThreadState {
    takes: bool,
    /// True if a value was missing.
    lacks: bool,
    /// True if a single point is computed, whose further arguments depend on missing values.
    is_point: bool,
}

thread_local! {
    static PART: Cell<ThreadState> = const { Cell::new(ThreadState { takes: false, lacks: false, is_point: false }) };
}

impl Arrays {
    /// A function with this many values per row, at least one.
    #[must_use]
    pub fn new(function: Arc<dyn ArrayFunction>, outputs: usize) -> Arrays {
        Arrays { function, outputs: outputs.max(1), known: Arc::default() }
    }

    /// The values at a point, at most `N` of them. While arguments are collected, unknown values are 0, and results
    /// that depend on them are computed again.
    #[must_use]
    pub fn at<const N: usize>(&self, inputs: &Inputs) -> [f64; N] {
        let (mut out, part) = ([0.0; N], PART.get());
        let mut known = self.lock();
        if !part.takes || known.collecting == 0 {
            drop(known);
            let mut row = vec![0.0; self.outputs];
            self.function.evaluate(&[*inputs], &mut row);
            out.iter_mut().zip(&row).for_each(|(out, value)| *out = *value);
            return out;
        }
        if part.is_point && part.lacks {
            return out;
        }
        let next = known.rows.len();
        let row = *known.rows.entry(inputs.map(f64::to_bits)).or_insert(next);
        if let Some(values) = known.values.chunks_exact(self.outputs).nth(row) {
            out.iter_mut().zip(values).for_each(|(out, value)| *out = *value);
            return out;
        }
        if row == next {
            known.wanted.push(*inputs);
        }
        known.misses += 1;
        PART.set(ThreadState { lacks: true, ..part });
        out
    }

    /// Computes the values of the collected arguments.
    fn evaluate(&self) {
        let mut known = self.lock();
        let wanted = std::mem::take(&mut known.wanted);
        if wanted.is_empty() {
            return;
        }
        // Other threads wait meanwhile, so that row numbers and values correspond.
        let mut values = vec![0.0; wanted.len() * self.outputs];
        self.function.evaluate(&wanted, &mut values);
        known.values.extend(values);
    }

    fn lock(&self) -> MutexGuard<'_, Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Makes laws collect arguments until it is dropped.
struct Collecting<'a>(&'a [&'a Arrays]);

impl<'a> Collecting<'a> {
    fn begin(laws: &'a [&'a Arrays]) -> Collecting<'a> {
        for law in laws {
            law.lock().collecting += 1;
        }
        Collecting(laws)
    }

    fn evaluate(&self) {
        self.0.iter().for_each(|law| law.evaluate());
    }

    fn misses(&self) -> u64 {
        self.0.iter().map(|law| law.lock().misses).sum()
    }
}

impl Drop for Collecting<'_> {
    fn drop(&mut self) {
        for law in self.0 {
            let mut known = law.lock();
            known.collecting -= 1;
            if known.collecting == 0 {
                *known = Known { misses: known.misses, ..Known::default() };
            }
        }
    }
}

/// Takes part in a collection while it exists.
struct TakingPart(ThreadState);

impl TakingPart {
    fn begin(is_point: bool) -> TakingPart {
        TakingPart(PART.replace(ThreadState { takes: true, lacks: false, is_point }))
    }

    /// Ends the participation; returns true if a value was missing.
    fn end(self) -> bool {
        let lacks = PART.get().lacks;
        drop(self);
        lacks
    }
}

impl Drop for TakingPart {
    fn drop(&mut self) {
        PART.set(self.0);
    }
}

/// Computes `of` for each of `count` points, with the values of array laws computed for all points together. At each
/// point a law may depend on values of others, evaluated one after the other. `of` runs on the calling thread.
pub fn per_point<T: Send + 'static>(laws: &[&Arrays], count: usize, of: impl Fn(usize) -> T) -> Vec<T> {
    if laws.is_empty() || PART.get().takes {
        return (0..count).map(of).collect();
    }
    let collecting = Collecting::begin(laws);
    let mut done: Vec<Option<T>> = (0..count).map(|_| None).collect();
    let mut left: Vec<usize> = (0..count).collect();
    while !left.is_empty() {
        left.retain(|&i| {
            let part = TakingPart::begin(true);
            let value = of(i);
            let lacks = part.end();
            if !lacks {
                done[i] = Some(value);
            }
            lacks
        });
        collecting.evaluate();
    }
    done.into_iter().flatten().collect()
}

/// Computes `pass` with the values of array laws computed for all points together. `pass` runs on the calling thread
/// and is repeated until no value is missing: twice if no argument of a law depends on values of laws.
pub fn all_at_once<T>(laws: &[&Arrays], mut pass: impl FnMut() -> T) -> T {
    if laws.is_empty() || PART.get().takes {
        return pass();
    }
    let collecting = Collecting::begin(laws);
    loop {
        let part = TakingPart::begin(false);
        let made = pass();
        if !part.end() {
            return made;
        }
        collecting.evaluate();
    }
}

/// Like [`all_at_once`] for a `pass` on several threads, which evaluates laws within [`taking_part`].
pub fn all_at_once_in_parallel<T>(laws: &[&Arrays], mut pass: impl FnMut() -> T) -> T {
    if laws.is_empty() {
        return pass();
    }
    let collecting = Collecting::begin(laws);
    loop {
        let before = collecting.misses();
        let made = pass();
        collecting.evaluate();
        if collecting.misses() == before {
            return made;
        }
    }
}

/// Evaluates laws within a pass of [`all_at_once_in_parallel`].
pub fn taking_part<T>(ask: impl FnOnce() -> T) -> T {
    let _part = TakingPart::begin(false);
    ask()
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "values are the same to the last bit")]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use rayon::prelude::*;

    use super::*;

    /// x ↦ x², 3x, counting calls and rows.
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
        // ((i²)²)² at points that share their arguments in pairs.
        let powers = per_point(&[&law, &other], 10, |i| {
            let square = at(&law, at(&law, (i / 2) as f64)[0])[0];
            at(&other, square)[0]
        });
        let expected: Vec<f64> = (0..10).map(|i: i32| f64::from(i / 2).powi(8)).collect();
        assert_eq!(powers, expected);
        // 0 and 1 are their own squares: 0 1 2 3 4, then 4 9 16, of which 4 is known.
        assert_eq!((square.calls.load(Ordering::Relaxed), square.rows.load(Ordering::Relaxed)), (2, 7));
        // Outside a collection each value takes a call.
        assert_eq!(at(&law, 5.0), [25.0, 15.0]);
        assert_eq!(square.calls.load(Ordering::Relaxed), 3);
    }

    #[test]
    fn passes_on_several_threads_take_one_call() {
        let square = Arc::new(Square::default());
        let law = Arrays::new(Arc::<Square>::clone(&square), 2);
        let sum: f64 = all_at_once_in_parallel(&[&law], || {
            let ask = |i: i32| taking_part(|| at(&law, f64::from(i))[1]);
            let all: Vec<f64> = (0..1000).into_par_iter().map(ask).collect();
            all.iter().sum()
        });
        assert_eq!(sum.to_bits(), (3.0f64 * 499_500.0).to_bits());
        assert_eq!((square.calls.load(Ordering::Relaxed), square.rows.load(Ordering::Relaxed)), (1, 1000));
    }

    #[test]
    fn passes_at_the_same_time_and_values_asked_beside_them_are_right() {
        let law = Arrays::new(Arc::new(Square::default()), 2);
        let pass = |first: i32| {
            let ask = |i: i32| taking_part(|| at(&law, f64::from(i))[0]);
            let of = || (first..first + 300).into_par_iter().map(ask).collect::<Vec<f64>>();
            all_at_once_in_parallel(&[&law], of) == (first..first + 300).map(|i| f64::from(i * i)).collect::<Vec<f64>>()
        };
        let pointwise = |first: i32| {
            let squares = per_point(&[&law], 40, |i| at(&law, at(&law, f64::from(first + i as i32))[0])[0]);
            squares == (first..first + 40).map(|i| f64::from(i).powi(4)).collect::<Vec<f64>>()
        };
        let beside =
            |first: i32| (first..first + 50).all(|i| at(&law, f64::from(i))[0].to_bits() == f64::from(i * i).to_bits());
        let right = (0..60).into_par_iter().all(|n| match n % 3 {
            0 => pass(5 * n),
            1 => pointwise(n),
            _ => beside(n),
        });
        assert!(right);
    }
}
