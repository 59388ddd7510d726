//! Runs that are interrupted in the middle of a step, at the same place each time.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use amontons::contact::{NormalLaw, Pressure};
use amontons::field::Law;
use amontons::problem::Problem;
use amontons::tensor::Point;

/// A law that sets a flag when its pressure is asked for so many times.
#[derive(Debug)]
struct Interrupts {
    law: Law<dyn NormalLaw>,
    left: AtomicUsize,
    flag: Arc<AtomicBool>,
}

impl NormalLaw for Interrupts {
    fn pressure(&self, x: &Point, z: f64, rate: f64, lambda: f64) -> Pressure {
        if self.left.fetch_sub(1, Ordering::Relaxed) == 1 {
            self.flag.store(true, Ordering::Relaxed);
        }
        self.law.pressure(x, z, rate, lambda)
    }
    fn potential(&self, x: &Point, r: f64) -> f64 {
        self.law.potential(x, r)
    }
    fn lipschitz(&self) -> Option<f64> {
        self.law.lipschitz()
    }
    fn least_slope(&self, x: &Point, from: f64, to: f64) -> f64 {
        self.law.least_slope(x, from, to)
    }
}

/// The problem, whose linear systems end their work once the pressure of its first contact was asked for `left` times.
pub fn interrupted(problem: &Problem, left: usize) -> Problem {
    super::changed(problem, |data| {
        let (law, flag) = (data.contacts[0].normal.clone(), Arc::new(AtomicBool::new(false)));
        data.backend = data.backend.interruptible(&flag).expect("a backend that looks at the flag");
        data.contacts[0].normal = Interrupts { law, left: AtomicUsize::new(left), flag }.into();
    })
}
