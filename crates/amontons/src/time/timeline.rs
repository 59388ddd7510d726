//! The instants t_0 = 0 < t_1 < … < t_N = T of a run.

/// The instants of a run: N equal steps from 0 to T.
///
/// All other modules take the start and length of a step from here, so that only this type knows that steps are equal.
///
/// ```
/// use amontons::time::Timeline;
///
/// let timeline = Timeline::equal(2.0, 8);
/// assert_eq!(timeline.time(8), 2.0);
/// assert_eq!(timeline.instants().map(|now| now.k).sum::<f64>(), timeline.end());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timeline {
    end: f64,
    steps: usize,
}

/// The end of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// Number n of the step that ends here.
    pub n: usize,
    /// t_n in s.
    pub t: f64,
    /// Length t_n − t_{n−1} of the step, s.
    pub k: f64,
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
}

impl Timeline {
    /// N equal steps to T, in s.
    #[must_use]
    pub fn equal(end: f64, steps: usize) -> Timeline {
        Timeline { end, steps }
    }

    /// T in s.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.end
    }

    /// Number N of steps.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// t_n in s, with t_N = T to the last bit.
    #[must_use]
    pub fn time(&self, n: usize) -> f64 {
        if n == 0 { 0.0 } else { self.end * (n as f64 / self.steps as f64) }
    }

    /// The end of step n.
    #[must_use]
    pub fn instant(&self, n: usize) -> Instant {
        Instant { n, t: self.time(n), k: self.longest() }
    }

    /// The ends of all steps.
    pub fn instants(&self) -> impl Iterator<Item = Instant> {
        let timeline = *self;
        (1..=self.steps).map(move |n| timeline.instant(n))
    }

    /// Length of the longest step, s.
    #[must_use]
    pub fn longest(&self) -> f64 {
        self.end / self.steps as f64
    }

    /// The timeline with each step divided into `parts` equal steps.
    #[must_use]
    pub fn refined(&self, parts: usize) -> Timeline {
        Timeline::equal(self.end, self.steps * parts)
    }

    /// At most `most` instants that are spread over the run, and its end; t_0 is the first of them.
    #[must_use]
    pub fn spread(&self, most: usize) -> Vec<f64> {
        let every = self.steps.div_ceil(most.max(1)).max(1);
        (0..self.steps).step_by(every).chain([self.steps]).map(|n| self.time(n)).collect()
    }

    /// Returns true if the steps have this length, to round-off.
    #[must_use]
    pub fn has_length(&self, k: f64) -> bool {
        (self.longest() - k).abs() <= 4.0 * f64::EPSILON * self.longest()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instants_go_from_zero_to_the_end() {
        for (end, steps) in [(1.0, 1), (0.3, 7), (1e-9, 1000)] {
            let timeline = Timeline::equal(end, steps);
            assert_eq!(timeline.time(0).to_bits(), 0.0f64.to_bits());
            assert_eq!(timeline.time(steps).to_bits(), end.to_bits());
            let mut before = 0.0;
            for Instant { t, k, .. } in timeline.instants() {
                assert!((t - before - k).abs() <= 4.0 * f64::EPSILON * end, "{t} after {before}");
                before = t;
            }
        }
    }

    #[test]
    fn few_instants_are_spread_over_the_run() {
        let timeline = Timeline::equal(1.0, 10);
        assert_eq!(timeline.spread(100).len(), 11);
        assert_eq!(timeline.spread(3), [0.0, 0.4, 0.8, 1.0]);
        assert_eq!(timeline.spread(1), [0.0, 1.0]);
    }
}
