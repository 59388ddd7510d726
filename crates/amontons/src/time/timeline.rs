//! The instants t_0 = 0 < t_1 < … < t_N = T of a run.

use std::sync::Arc;

use super::analysis::Analysis;
use super::instant::Instant;
use super::made::MadeSteps;
use super::pace::Pace;
use super::phase::{DEEPEST, LONGEST, Steps, TimePhase, first_level};
use super::span::PhaseSpan;

/// Difference of two step lengths, relative to one of them, that counts as round-off.
const SAME: f64 = 4.0 * f64::EPSILON;
/// Largest number of halvings of a step.
pub const HALVINGS: u32 = 5;

/// The instants of a run: phases, one after the other, each with equal steps or with steps that are chosen as the run
/// goes on.
///
/// All other modules take the start and length of a step from here, so that only this type knows which steps are equal.
/// What a step number alone asks for is, in a run with chosen steps, that of equal ones, for estimates before the run:
/// [`Steps::nominal`](super::Steps::nominal). [`Timeline::made`] and [`Timeline::next`] tell of steps that are made.
///
/// ```
/// use amontons::time::{TimePhase, Timeline};
///
/// let timeline = Timeline::equal(2.0, 8);
/// assert_eq!(timeline.time(8), 2.0);
/// assert_eq!(timeline.instants().map(|now| now.k).sum::<f64>(), timeline.end());
///
/// let all = vec![TimePhase::quasistatic("press", 1.0, 2), TimePhase::dynamic("spin", 1.5, 50)];
/// let phases = Timeline::in_phases(all);
/// assert_eq!((phases.steps(), phases.time(2), phases.instant(3).k), (52, 1.0, 0.01));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Timeline {
    spans: Arc<[PhaseSpan]>,
    has_phases: bool,
}

impl Timeline {
    /// N equal steps to T, in s.
    #[must_use]
    pub fn equal(end: f64, steps: usize) -> Timeline {
        Timeline::single(end, Steps::Equal(steps))
    }

    /// The timeline of a run without phases with another analysis.
    #[must_use]
    pub fn with_analysis(&self, analysis: Analysis) -> Timeline {
        let phases = self.phases().map(|phase| TimePhase { analysis, ..phase.clone() });
        Timeline::of(phases.collect(), self.has_phases)
    }

    /// Steps to T, in s, that follow from an accuracy.
    #[must_use]
    pub fn automatic(end: f64, accuracy: f64) -> Timeline {
        Timeline::single(end, Steps::Automatic { accuracy })
    }

    /// Steps to T, in s, without phases.
    #[must_use]
    pub fn single(end: f64, steps: Steps) -> Timeline {
        Timeline::of(vec![TimePhase { steps, ..TimePhase::dynamic("", end, 1) }], false)
    }

    /// Phases, one after the other. Steps of phases whose lengths differ by round-off have the same length to the bit,
    /// so that they share their systems.
    #[must_use]
    pub fn in_phases(phases: Vec<TimePhase>) -> Timeline {
        Timeline::of(phases, true)
    }

    fn of(phases: Vec<TimePhase>, has_phases: bool) -> Timeline {
        let mut spans: Vec<PhaseSpan> = Vec::with_capacity(phases.len());
        for phase in phases {
            let (start, first) = spans.last().map_or((0.0, 0), |span| (span.phase.end, span.last()));
            let k = (phase.end - start) / phase.steps.nominal() as f64;
            let mut span = PhaseSpan { phase, start, first, k };
            let is_equal = |other: &&PhaseSpan| other.is_equal() && span.is_equal();
            let same =
                spans.iter().filter(is_equal).find(|other| (other.k - k).abs() <= SAME * other.mean().max(span.mean()));
            span.k = same.map_or(k, |other| other.k);
            spans.push(span);
        }
        Timeline { spans: spans.into(), has_phases }
    }

    /// True if the steps of a phase are chosen as the run goes on.
    #[must_use]
    pub fn is_automatic(&self) -> bool {
        self.spans.iter().any(PhaseSpan::is_automatic)
    }

    /// The timeline with the steps that a run with automatic ones made; other phases keep their steps.
    #[must_use]
    pub fn with_made(&self, made: &MadeSteps) -> Timeline {
        let of = |(i, phase): (usize, &TimePhase)| {
            let ends = made.of_phase(i).filter(|_| phase.steps.accuracy().is_some());
            TimePhase {
                steps: ends.map_or_else(|| phase.steps.clone(), |ends| Steps::Made(ends.into())),
                ..phase.clone()
            }
        };
        Timeline::of(self.phases().enumerate().map(of).collect(), self.has_phases)
    }

    /// The last step that was made before a place; at t = 0 that of number 0, with the length of the first one.
    #[must_use]
    pub fn made(&self, n: usize, pace: &Pace) -> Instant {
        if !self.is_automatic() {
            return Instant { n, t: self.time(n), ..self.instant(n.max(1)) };
        }
        let over = pace.ends.len();
        let phase = if n > 0 && pace.ends.last() == Some(&n) { over - 1 } else { over };
        let Some(span) = self.spans.get(phase) else { return self.instant(n) };
        let t = if phase < over {
            span.phase.end
        } else if span.is_automatic() {
            span.time_at(pace.at)
        } else {
            span.time(span.first + n - pace.ends.last().copied().unwrap_or(0))
        };
        let k = if n == 0 { span.k } else { pace.k };
        Instant { n, t, k, phase, analysis: span.phase.analysis }
    }

    /// The step behind a place; in an automatic phase with 2^−level of it.
    #[must_use]
    pub fn next(&self, n: usize, pace: &Pace, level: u32) -> Instant {
        let next = self.instant(n + 1);
        if !self.is_automatic() {
            return next;
        }
        let phase = pace.ends.len();
        let Some(span) = self.spans.get(phase) else { return next };
        if !span.is_automatic() {
            let made = n - pace.ends.last().copied().unwrap_or(0);
            return Instant { n: n + 1, ..span.instant(span.first + made + 1, phase) };
        }
        let k = span.length() / (1u64 << level) as f64;
        Instant { n: n + 1, t: span.time_at(pace.behind(level)), k, phase, analysis: span.phase.analysis }
    }

    /// The place behind a step that was made, in an automatic phase with its level.
    #[must_use]
    pub fn after(&self, pace: &Pace, made: &Instant, level: u32) -> Pace {
        let Some(span) = self.spans.get(made.phase).filter(|_| self.is_automatic()) else { return pace.clone() };
        let at = if span.is_automatic() { pace.behind(level) } else { 0 };
        let is_over = if span.is_automatic() {
            at >= 1 << DEEPEST
        } else {
            made.n - pace.ends.last().copied().unwrap_or(0) >= span.steps()
        };
        let pace = Pace { k: made.k, at, level, ..pace.clone() };
        if is_over { pace.at_end(made.n, span.phase.steps.accuracy()) } else { pace }
    }

    /// The accuracy of the steps of a phase, if they are chosen.
    #[must_use]
    pub fn accuracy(&self, phase: usize) -> Option<f64> {
        self.spans.get(phase).and_then(|span| span.phase.steps.accuracy())
    }

    /// The level with which an automatic phase begins.
    #[must_use]
    pub fn first_level(accuracy: f64) -> u32 {
        first_level(accuracy)
    }

    /// True if all steps were made.
    #[must_use]
    pub fn is_over(&self, n: usize, pace: &Pace) -> bool {
        if self.is_automatic() { pace.ends.len() >= self.spans.len() } else { n >= self.steps() }
    }

    /// The last step of each phase that is over at a place; of a run of equal steps that of all phases. Empty in a run
    /// without phases.
    #[must_use]
    pub fn ends_at(&self, pace: &Pace) -> Vec<usize> {
        if self.is_automatic() && self.has_phases { pace.ends.clone() } else { self.phase_ends() }
    }

    /// True if a phase ends with the step before a place.
    #[must_use]
    pub fn is_between(&self, n: usize, pace: &Pace) -> bool {
        if self.is_automatic() { n > 0 && pace.ends.last() == Some(&n) } else { self.ends_phase(n) }
    }

    /// The phases; one without a name if the run has none.
    pub fn phases(&self) -> impl DoubleEndedIterator<Item = &TimePhase> + ExactSizeIterator {
        self.spans.iter().map(|span| &span.phase)
    }

    /// True if the run is made of phases that have names.
    #[must_use]
    pub fn has_phases(&self) -> bool {
        self.has_phases
    }

    /// The phase in which step n is made, or `None` in a run without phases. The state at t = 0 counts to the first
    /// one.
    #[must_use]
    pub fn phase_of(&self, n: usize) -> Option<&TimePhase> {
        let (_, span) = self.span(n)?;
        self.has_phases.then_some(&span.phase)
    }

    /// True if a phase ends with step n.
    #[must_use]
    pub fn ends_phase(&self, n: usize) -> bool {
        self.spans.iter().any(|span| n > 0 && n == span.last())
    }

    /// The last step of each phase; empty in a run without phases.
    #[must_use]
    pub fn phase_ends(&self) -> Vec<usize> {
        let spans: &[PhaseSpan] = if self.has_phases { &self.spans } else { &[] };
        spans.iter().map(PhaseSpan::last).collect()
    }

    /// The phase whose steps lead to a time, by its number; at t = 0 the first one.
    #[must_use]
    pub fn phase_at(&self, t: f64) -> usize {
        self.spans.iter().position(|span| t <= span.phase.end).unwrap_or(self.spans.len().saturating_sub(1))
    }

    /// The share of its phase that is left at a time: 1 at its start, 0 at its end.
    pub(crate) fn left_of_phase(&self, t: f64) -> f64 {
        self.spans.get(self.phase_at(t)).map_or(0.0, |span| (span.phase.end - t) / span.length())
    }

    /// The phase of step n with its index. Steps after the end belong to the last one.
    fn span(&self, n: usize) -> Option<(usize, &PhaseSpan)> {
        let is_in = |(_, span): &(usize, &PhaseSpan)| n <= span.last();
        self.spans.iter().enumerate().find(is_in).or_else(|| self.spans.iter().enumerate().next_back())
    }

    /// T in s.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.spans.last().map_or(0.0, |span| span.phase.end)
    }

    /// Number N of steps; of automatic phases their nominal number.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.spans.last().map_or(0, PhaseSpan::last)
    }

    /// t_n in s, with the ends of all phases to the last bit.
    #[must_use]
    pub fn time(&self, n: usize) -> f64 {
        if n == 0 { 0.0 } else { self.span(n).map_or(0.0, |(_, span)| span.time(n)) }
    }

    /// The end of step n.
    #[must_use]
    pub fn instant(&self, n: usize) -> Instant {
        let none = Instant { n, t: 0.0, k: 0.0, phase: 0, analysis: Analysis::Dynamic };
        self.span(n).map_or(none, |(phase, span)| span.instant(n, phase))
    }

    /// The ends of all steps.
    pub fn instants(&self) -> impl Iterator<Item = Instant> {
        let timeline = self.clone();
        (1..=self.steps()).map(move |n| timeline.instant(n))
    }

    /// The last step of each phase from the given one on, whose `analysis` is that of all its steps, and `k` if
    /// they are equal.
    pub fn ends_from(&self, phase: usize) -> impl Iterator<Item = Instant> {
        let spans = self.spans.iter().enumerate().skip(phase);
        spans.map(|(phase, span)| span.instant(span.last(), phase))
    }

    /// Steps with all lengths and analyses that a run may need after this step: of phases with equal steps from the
    /// present one on, and in an automatic phase twice this length, this length, half and a quarter of it.
    #[must_use]
    pub fn needed_after(&self, now: &Instant) -> Vec<Instant> {
        let is_chosen = |phase: usize| self.spans.get(phase).is_some_and(|span| !span.is_equal());
        let equal = self.ends_from(now.phase).filter(|end| !is_chosen(end.phase));
        let near = [2.0, 1.0, 0.5, 0.25].map(|times| Instant { k: now.k * times, ..*now });
        equal.chain(near.into_iter().filter(|near| is_chosen(near.phase))).collect()
    }

    /// Length of the longest step, s.
    #[must_use]
    pub fn longest(&self) -> f64 {
        self.spans.iter().flat_map(PhaseSpan::lengths).reduce(f64::max).unwrap_or(0.0)
    }

    /// The last step of a phase with the longest steps, for each analysis of the run in the order of the phases; of a
    /// phase with chosen steps the longest one that may be chosen.
    #[must_use]
    pub fn longest_steps(&self) -> Vec<Instant> {
        let mut all: Vec<Instant> = Vec::new();
        for (span, mut end) in self.spans.iter().zip(self.ends_from(0)) {
            // Chosen steps are made in halves.
            let chosen = || span.length() / f64::from(1u32 << (LONGEST + 1));
            end.k = if span.is_automatic() { chosen() } else { span.lengths().into_iter().fold(0.0, f64::max) };
            match all.iter_mut().find(|other| other.analysis == end.analysis) {
                Some(other) if end.k > other.k => *other = end,
                Some(_) => {}
                None => all.push(end),
            }
        }
        all
    }

    /// Number of step lengths with their analyses, each of which has its own systems; a phase with chosen steps counts
    /// as one.
    #[must_use]
    pub fn lengths(&self) -> usize {
        let of = |span: &PhaseSpan| {
            let analysis = span.phase.analysis;
            span.lengths().into_iter().map(move |k| (k.to_bits(), analysis))
        };
        let mut all: Vec<(u64, Analysis)> = self.spans.iter().flat_map(of).collect();
        all.sort_by_key(|(k, analysis)| (*k, analysis.name()));
        all.dedup();
        all.len()
    }

    /// True if inertia does not act in some phase.
    #[must_use]
    pub fn lacks_inertia(&self) -> bool {
        self.phases().any(|phase| !phase.analysis.has_inertia())
    }

    /// The index of the first steady phase, if there is one.
    #[must_use]
    pub fn first_steady(&self) -> Option<usize> {
        self.phases().position(|phase| phase.analysis == Analysis::Steady)
    }

    /// Length of the shortest step, s.
    #[must_use]
    pub fn shortest(&self) -> f64 {
        self.spans.iter().flat_map(PhaseSpan::lengths).reduce(f64::min).unwrap_or(0.0)
    }

    /// True if all steps have one length.
    #[must_use]
    pub fn is_equal(&self) -> bool {
        self.spans.iter().all(|span| span.is_equal() && is_same(span.k, self.longest()))
    }

    /// The timeline with each step divided into `parts` equal steps.
    #[must_use]
    pub fn refined(&self, parts: usize) -> Timeline {
        let phases = self.phases().map(|phase| TimePhase { steps: phase.steps.refined(parts), ..phase.clone() });
        Timeline::of(phases.collect(), self.has_phases)
    }

    /// Number of equal parts into which each step of this timeline divides the steps of `coarse`, or `None` if their
    /// steps do not nest.
    #[must_use]
    pub fn parts_of(&self, coarse: &Timeline) -> Option<usize> {
        let parts = self.steps().checked_div(coarse.steps()).filter(|parts| *parts > 0)?;
        let is_nested = |(fine, coarse): (&PhaseSpan, &PhaseSpan)| {
            let are_equal = fine.is_equal() && coarse.is_equal();
            are_equal && fine.steps() == parts * coarse.steps() && is_same(fine.phase.end, coarse.phase.end)
        };
        let same = self.spans.len() == coarse.spans.len() && self.spans.iter().zip(&*coarse.spans).all(is_nested);
        same.then_some(parts)
    }

    /// At most `most` instants that are spread over the run, and its end; t_0 is the first of them. In a run of phases
    /// each phase has its share of `most`, and all ends of phases are among them.
    #[must_use]
    pub fn spread(&self, most: usize) -> Vec<f64> {
        let share = (most / self.spans.len().max(1)).max(1);
        let of = |span: &PhaseSpan| {
            let every = span.steps().div_ceil(share).max(1);
            let (from, to) = (span.first, span.last());
            (from..to).step_by(every).collect::<Vec<usize>>()
        };
        self.spans.iter().flat_map(of).chain([self.steps()]).map(|n| self.time(n)).collect()
    }

    /// The length of a step, or of a step halved a few times, that is `k` to round-off, or `k` if none is.
    #[must_use]
    pub fn snapped(&self, k: f64) -> f64 {
        // Chosen lengths are kept to the bit, and one of them may lie beside that of another phase.
        if !self.spans.iter().all(PhaseSpan::is_equal) {
            return k;
        }
        let halves =
            |span: &PhaseSpan| (0..=HALVINGS).map(|halvings| span.k / f64::from(1u32 << halvings)).collect::<Vec<_>>();
        self.spans.iter().flat_map(halves).find(|own| is_same(*own, k)).unwrap_or(k)
    }

    /// The length that the last step before a place has here, if it is another than `k` by more than round-off.
    #[must_use]
    pub fn other_length(&self, n: usize, pace: &Pace, k: f64) -> Option<f64> {
        let chosen = |span: &&PhaseSpan| n > 0 && span.is_automatic();
        let own = match self.spans.get(self.made(n, pace).phase) {
            Some(span) if self.is_automatic() => {
                // The level of the last step is not kept: any length of the phase will do.
                let lengths = (0..=DEEPEST).map(|level| span.length() / (1u64 << level) as f64);
                let found = Some(span).filter(chosen).and_then(|_| lengths.into_iter().find(|own| is_same(*own, k)));
                found.unwrap_or(span.k)
            }
            _ => self.instant(n.max(1)).k,
        };
        (!is_same(own, k)).then_some(own)
    }
}

/// True if two positive numbers are the same to round-off.
fn is_same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a
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
            for Instant { n, t, k, .. } in timeline.instants() {
                assert!((t - before - k).abs() <= 4.0 * f64::EPSILON * end, "{t} after {before}");
                assert_eq!(t.to_bits(), (end * (n as f64 / steps as f64)).to_bits());
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

    fn three() -> Timeline {
        let all = vec![
            TimePhase::quasistatic("press", 0.1, 3),
            TimePhase::dynamic("spin", 0.7, 18),
            TimePhase::dynamic("cool", 10.7, 4),
        ];
        Timeline::in_phases(all)
    }

    #[test]
    fn ends_of_phases_are_hit_to_the_bit() {
        let timeline = three();
        for (n, end) in [(0, 0.0f64), (3, 0.1), (21, 0.7), (25, 10.7)] {
            assert_eq!(timeline.time(n).to_bits(), end.to_bits());
            assert_eq!(timeline.ends_phase(n), n > 0);
        }
        let mut before = 0.0;
        for Instant { n, t, k, phase, analysis } in timeline.instants() {
            assert!((t - before - k).abs() <= 1e-15 * t && t > before, "{t} after {before}: {k}");
            let expected = if n <= 3 { 0 } else { 1 + usize::from(n > 21) };
            assert_eq!((phase, analysis == Analysis::Quasistatic), (expected, n <= 3));
            before = t;
        }
        assert_eq!((timeline.longest(), timeline.is_equal()), (2.5, false));
        // 0.1 and (0.7 − 0.1)/6 differ in their last bits.
        let same = Timeline::in_phases(vec![TimePhase::dynamic("a", 0.1, 1), TimePhase::dynamic("b", 0.7, 6)]);
        assert_eq!(same.instant(2).k.to_bits(), 0.1f64.to_bits());
        assert_ne!(((0.7f64 - 0.1) / 6.0).to_bits(), 0.1f64.to_bits());
        // Far from t = 0 the round-off of a step length is that of the times.
        let far = Timeline::in_phases(vec![
            TimePhase::dynamic("a", 1000.0, 100_000),
            TimePhase::dynamic("b", 1000.1, 10),
            TimePhase::dynamic("c", 1000.2, 20),
        ]);
        assert_eq!([1, 100_001].map(|n| far.instant(n).k.to_bits()), [0.01f64.to_bits(); 2]);
        assert!((far.instant(100_011).k - 0.005).abs() < 1e-12);
    }

    #[test]
    fn phases_are_refined_and_spread_each_for_itself() {
        let (coarse, fine) = (three(), three().refined(4));
        assert_eq!((fine.steps(), fine.parts_of(&coarse), coarse.parts_of(&fine)), (100, Some(4), None));
        assert_eq!(fine.time(84).to_bits(), 0.7f64.to_bits());
        let other =
            Timeline::in_phases(vec![TimePhase::dynamic("press", 0.1, 6), TimePhase::dynamic("spin", 10.7, 94)]);
        assert_eq!(other.parts_of(&coarse), None);
        let spread = coarse.spread(3);
        assert_eq!(spread, [0.0, 0.1, 0.7, 10.7]);
    }
}
