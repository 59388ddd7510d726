//! The times of a step.

use super::analysis::Analysis;

/// The end of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// Number n of the step that ends here.
    pub n: usize,
    /// t_n in s.
    pub t: f64,
    /// Length of the step, s: t_n − t_{n−1} to round-off.
    pub k: f64,
    /// Index of the phase of the step.
    pub phase: usize,
    /// What of the equations acts in the step.
    pub analysis: Analysis,
}

/// The times of a step, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Interval {
    /// t₀.
    pub start: f64,
    /// t₁.
    pub end: f64,
    /// t_ϑ, at which the equations hold.
    pub level: f64,
    /// t₋₁, if the step adds to two states.
    pub before: Option<f64>,
    /// The time in which what the step changes does so: its length, and in a steady step far more.
    pub within: f64,
}

impl Interval {
    /// An interval of no length.
    #[must_use]
    pub fn at(t: f64) -> Interval {
        Interval { start: t, end: t, level: t, before: None, within: 0.0 }
    }

    /// The times with those changes that go on for ever made in the length of the step.
    #[must_use]
    pub fn lasting(self) -> Interval {
        Interval { within: self.end - self.start, ..self }
    }

    /// The rate of a function of time in the step: the mean rate, or that of BDF2; 0 in an interval of no length.
    #[must_use]
    pub fn rate(&self, of: &dyn Fn(f64) -> f64) -> f64 {
        self.rate_of(self.before.map(of), [of(self.start), of(self.end)])
    }

    /// The rate of a quantity by its values at t₋₁, and at t₀ and t₁.
    #[must_use]
    pub fn rate_of(&self, before: Option<f64>, [start, end]: [f64; 2]) -> f64 {
        let (change, length) = (end - start, self.within);
        match before {
            _ if length <= 0.0 => 0.0,
            None => change / length,
            Some(before) => (1.5 * change - 0.5 * (start - before)) / length,
        }
    }
}
