//! The steps of a deck as one time line, amplitudes, and histories of loads and conditions over all steps.

use std::collections::HashMap;

use super::deck::{Card, DeckFault, DeckPlace};
use super::notes::{Matter, Notes};
use super::units::{number, numbers};

/// Largest number of equal steps of a case unless the deck requests them by DIRECT.
const MOST_STEPS: usize = 1000;
/// Largest number of equal steps of a case.
const MOST_DIRECT: usize = 100_000;
/// Number of points of a smooth rise of an amplitude.
const SMOOTH: usize = 20;

/// The equations of a case.
#[derive(Clone, Copy, Debug)]
pub struct DeckPhysics {
    pub mechanics: bool,
    pub heat: bool,
    /// True if heat is stored.
    pub stores: bool,
}

/// The equations of a step of a deck.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Procedure {
    pub mechanics: bool,
    pub heat: bool,
    /// True if inertia acts or heat is stored.
    pub transient: bool,
}

/// A step of a deck.
#[derive(Clone, Debug)]
pub struct DeckStep {
    pub place: DeckPlace,
    pub procedure: Option<Procedure>,
    pub start: f64,
    pub period: f64,
    increment: f64,
    direct: bool,
    /// `*STEP, AMPLITUDE=…`, if given.
    ramp: Option<bool>,
    pub large: bool,
}

impl DeckStep {
    /// A step from the keyword `*STEP`.
    pub fn of(card: &Card, start: f64) -> DeckStep {
        let ramp = card.word("AMPLITUDE").map(|word| word == "RAMP");
        let large = card.has("NLGEOM") && card.word("NLGEOM").as_deref() != Some("NO");
        let place = card.place.clone();
        DeckStep { place, procedure: None, start, period: 1.0, increment: 1.0, direct: false, ramp, large }
    }

    pub fn end(&self) -> f64 {
        self.start + self.period
    }

    /// True if loads without an amplitude grow over the step.
    fn ramps(&self) -> bool {
        self.ramp.unwrap_or_else(|| self.procedure.is_none_or(|procedure| !procedure.transient))
    }

    /// Reads the procedure of a step with its times.
    pub fn proceed(&mut self, card: &Card, procedure: Procedure) -> Result<(), DeckFault> {
        if self.procedure.is_some() {
            let expected = "one procedure per step";
            return Err(DeckFault::new(
                &card.place,
                format!("*{} in a step that has a procedure", card.name),
                expected,
            ));
        }
        self.procedure = Some(procedure);
        self.direct = card.has("DIRECT");
        let Some(line) = card.data.first() else { return Ok(()) };
        let positive = |index: usize| match line.number(index)? {
            Some(value) if value > 0.0 => Ok(Some(value)),
            None | Some(0.0) => Ok(None),
            Some(value) => Err(DeckFault::new(&line.place, number(value), "a positive time")),
        };
        self.period = positive(1)?.unwrap_or(1.0);
        self.increment = positive(0)?.unwrap_or(self.period).min(self.period);
        Ok(())
    }
}

/// An amplitude: factors at times.
#[derive(Clone, Debug)]
pub struct Amplitude {
    points: Vec<(f64, f64)>,
    total: bool,
}

impl Amplitude {
    /// Reads `*AMPLITUDE`.
    pub fn of(card: &Card) -> Result<Amplitude, DeckFault> {
        let definition = card.word("DEFINITION").unwrap_or_else(|| "TABULAR".to_owned());
        let smooth = match definition.as_str() {
            "TABULAR" => false,
            "SMOOTH STEP" => true,
            other => {
                let found = format!("*AMPLITUDE, DEFINITION={}", other.escape_debug());
                return Err(DeckFault::new(&card.place, found, "TABULAR or SMOOTH STEP: write it as a table"));
            }
        };
        let mut points: Vec<(f64, f64)> = Vec::new();
        for line in &card.data {
            for (pair, entries) in line.entries.chunks(2).enumerate() {
                if entries.iter().all(String::is_empty) {
                    continue;
                }
                let point = (line.value(2 * pair, "a time")?, line.value(2 * pair + 1, "a factor")?);
                if points.last().is_some_and(|last| last.0 >= point.0) {
                    let found = format!("the time {} after {}", number(point.0), number(points[points.len() - 1].0));
                    return Err(DeckFault::new(&line.place, found, "times that increase"));
                }
                points.push(point);
            }
        }
        if points.is_empty() {
            return Err(DeckFault::new(&card.place, "*AMPLITUDE without points", "pairs of a time and a factor"));
        }
        let total = card.word("TIME").is_some_and(|word| word == "TOTAL TIME");
        Ok(Amplitude { points: if smooth { smoothed(&points) } else { points }, total })
    }

    /// The factor at a time; constant beyond the table.
    fn at(&self, t: f64) -> f64 {
        let after = self.points.partition_point(|point| point.0 <= t);
        match (after.checked_sub(1).and_then(|before| self.points.get(before)), self.points.get(after)) {
            (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (t - a.0) / (b.0 - a.0),
            (Some(only), None) | (None, Some(only)) => only.1,
            (None, None) => 0.0,
        }
    }
}

/// Rises of degree five between points.
fn smoothed(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut all: Vec<(f64, f64)> = points.iter().take(1).copied().collect();
    for pair in points.windows(2) {
        let [(t, a), (end, b)] = pair else { continue };
        all.extend((1..=SMOOTH).map(|part| {
            let s = part as f64 / SMOOTH as f64;
            (t + s * (end - t), a + (b - a) * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s))
        }));
    }
    all
}

/// Value of a load or a condition from a step on.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Number of the step, from 0; keywords before the steps belong to the first.
    pub step: usize,
    /// The value, or `None` if it is removed.
    pub value: Option<f64>,
    pub amplitude: Option<String>,
}

/// All events of a load or a condition.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Track(pub Vec<Event>);

impl Track {
    /// Sets the value in a step. With `adds` it is added to the value already set in the step.
    pub fn set(&mut self, event: Event, adds: bool) {
        match self.0.last_mut().filter(|last| last.step == event.step) {
            Some(last) if adds && last.value.is_some() && last.amplitude == event.amplitude => {
                last.value = last.value.zip(event.value).map(|(a, b)| a + b);
            }
            Some(last) => *last = event,
            None => self.0.push(event),
        }
    }

    /// Removes the load or condition in a step.
    pub fn remove(&mut self, step: usize) {
        if self.0.last().is_some_and(|last| last.value.is_some()) {
            self.set(Event { step, value: None, amplitude: None }, false);
        }
    }
}

/// A value over time: its points, in the units of the deck.
#[derive(Clone, Debug, PartialEq)]
pub struct DeckAmplitude(pub Vec<(f64, f64)>);

impl DeckAmplitude {
    /// The value, if it is the same at all times.
    pub fn constant(&self) -> Option<f64> {
        let first = self.0.first()?.1;
        self.0.iter().all(|point| same(point.1, first)).then_some(first)
    }

    /// The values times a factor, plus a summand.
    pub fn mapped(&self, factor: f64, summand: f64) -> DeckAmplitude {
        DeckAmplitude(self.0.iter().map(|&(t, value)| (t, value * factor + summand)).collect())
    }

    /// The text of the case: a number, or a table in time whose times are multiplied by `time`; `space` is a factor in
    /// space.
    pub fn text(&self, time: f64, space: Option<&str>) -> String {
        match (self.constant(), space) {
            (Some(value), None) => number(value),
            (Some(value), Some(space)) => format!("\"{}*({space})\"", number(value)),
            (None, space) => {
                let times = numbers(self.0.iter().map(|point| point.0 * time));
                let values = numbers(self.0.iter().map(|point| point.1));
                let factor = space.map_or_else(String::new, |space| format!(", factor = \"{space}\""));
                format!("{{ times = {times}, values = {values}{factor} }}")
            }
        }
    }
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * a.abs().max(b.abs())
}

/// All steps of a deck, and the equal steps of the case.
#[derive(Debug)]
pub struct TimeLine {
    pub steps: Vec<DeckStep>,
    pub end: f64,
    pub count: usize,
}

impl TimeLine {
    /// Joins the steps, and finds equal steps of the case that meet their ends.
    pub fn of(steps: Vec<DeckStep>, notes: &mut Notes) -> TimeLine {
        let end = steps.last().map_or(1.0, DeckStep::end);
        let wanted = steps.iter().map(|step| step.increment).fold(end, f64::min);
        let least = (end / wanted - 1e-9).ceil().max(1.0);
        let direct = steps.iter().all(|step| step.direct);
        let most = if direct { MOST_DIRECT } else { MOST_STEPS };
        if least > most as f64
            && let Some(step) = steps.first()
        {
            let why = format!("the case has {most} equal steps, the deck begins with increments of {}", number(wanted));
            notes.add(&step.place, "increments", why, Matter::Perhaps);
        }
        let least = least.min(most as f64) as usize;
        let meets = |count: &usize| {
            steps.iter().all(|step| {
                let place = step.end() / end * *count as f64;
                (place - place.round()).abs() < 1e-6
            })
        };
        let found = (least..=8 * least + 1000).find(meets);
        if found.is_none()
            && let Some(step) = steps.last()
        {
            let why = "the ends of the steps of the deck lie within equal steps of the case";
            notes.add(&step.place, "*STEP", why, Matter::Perhaps);
        }
        TimeLine { steps, end, count: found.unwrap_or(least) }
    }

    /// The history of a track over all steps, starting at a value; `grows` is true if it ramps like loads.
    pub fn history(
        &self,
        track: &Track,
        all: &HashMap<String, Amplitude>,
        (begin, grows): (f64, bool),
    ) -> DeckAmplitude {
        let mut points: Vec<(f64, f64)> = Vec::new();
        let mut value = begin;
        let mut holds: Option<&Event> = None;
        let k = self.end / self.count.max(1) as f64;
        for (number, step) in self.steps.iter().enumerate() {
            let new = track.0.iter().rev().find(|event| event.step == number);
            let (start, end) = (step.start, step.end());
            holds = new.or(holds);
            let amplitude = holds.and_then(|event| Some((event.value?, all.get(event.amplitude.as_ref()?)?)));
            match (amplitude, new) {
                (Some((size, amplitude)), _) if new.is_some() || amplitude.total => {
                    let origin = if amplitude.total { 0.0 } else { start };
                    let inside = amplitude.points.iter().map(|point| point.0 + origin);
                    let inside = inside.filter(|&t| t > start && t < end);
                    let first = if number == 0 { start } else { (start + k).min(end) };
                    points.extend((number > 0).then_some((start, value)));
                    let times = [first].into_iter().chain(inside.filter(|&t| t > first)).chain([end]);
                    points.extend(times.map(|t| (t, size * amplitude.at(t - origin))));
                }
                (_, Some(event)) => {
                    let goal = event.value.unwrap_or(0.0);
                    if grows && step.ramps() {
                        points.push((start, value));
                    } else if number == 0 {
                        points.push((start, goal));
                    } else {
                        points.extend([(start, value), ((start + k).min(end), goal)]);
                    }
                    points.push((end, goal));
                }
                (_, None) => points.extend([(start, value), (end, value)]),
            }
            value = points.last().map_or(value, |point| point.1);
        }
        DeckAmplitude(simple(points))
    }

    /// Notes a condition that begins or ends with a step: in a case it holds in all steps.
    pub fn note_late(&self, track: &Track, what: &str, notes: &mut Notes) {
        let place = |step: usize| self.steps.get(step).map_or_else(DeckPlace::start, |step| step.place.clone());
        if let Some(first) = track.0.first().filter(|first| first.step > 0) {
            let why = "the case has it from the start, the deck from this step on";
            notes.add(&place(first.step), what, why, Matter::Answer);
        }
        if let Some(gone) = track.0.iter().find(|event| event.value.is_none()) {
            let why = "the case has it to the end with the value 0, the deck removes it in this step";
            notes.add(&place(gone.step), what, why, Matter::Answer);
        }
    }
}

/// The points without those that repeat a time or lie on the line of their neighbours.
fn simple(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let mut kept: Vec<(f64, f64)> = Vec::new();
    for point in points {
        if let Some(last) = kept.last_mut().filter(|last| point.0 <= last.0 * (1.0 + 1e-12)) {
            last.1 = point.1;
            continue;
        }
        if let [.., a, b] = kept[..] {
            let line = a.1 + (point.1 - a.1) * (b.0 - a.0) / (point.0 - a.0);
            if (line - b.1).abs() <= 1e-12 * a.1.abs().max(b.1.abs()).max(point.1.abs()) {
                kept.pop();
            }
        }
        kept.push(point);
    }
    kept
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::{Amplitude, DeckStep, Event, Notes, Procedure, TimeLine, Track, smoothed};
    use crate::import::deck::DeckPlace;

    /// Steps one after the other: their periods, and whether each is transient.
    fn steps(all: &[(f64, bool)], increment: f64) -> TimeLine {
        let mut steps: Vec<DeckStep> = Vec::new();
        for &(period, transient) in all {
            let start = steps.last().map_or(0.0, DeckStep::end);
            let procedure = Some(Procedure { mechanics: true, heat: false, transient });
            let place = DeckPlace::start();
            steps.push(DeckStep {
                place,
                procedure,
                start,
                period,
                increment,
                direct: false,
                ramp: None,
                large: false,
            });
        }
        TimeLine::of(steps, &mut Notes::default())
    }

    fn set(step: usize, value: f64, amplitude: Option<&str>) -> Event {
        Event { step, value: Some(value), amplitude: amplitude.map(str::to_owned) }
    }

    #[test]
    fn steps_of_the_case_meet_those_of_the_deck() {
        // Ends at 1 and 1.5 of 1.5: multiples of 0.5, divided into parts of at most 0.2, 0.5/3 each.
        assert_eq!(steps(&[(1.0, false), (0.5, false)], 0.2).count, 9);
        // Tiny initial increments of a deck are not followed.
        assert_eq!(steps(&[(1.0, true)], 1e-9).count, 1000);
    }

    #[test]
    fn loads_ramp_in_static_steps_and_are_there_at_once_in_others() {
        let none = HashMap::new();
        let track = Track(vec![set(0, 2.0, None), set(1, 5.0, None)]);
        let history = |line: &TimeLine| line.history(&track, &none, (0.0, true)).0;
        assert_eq!(history(&steps(&[(1.0, false), (1.0, false)], 0.5)), [(0.0, 0.0), (1.0, 2.0), (2.0, 5.0)]);
        let mixed = steps(&[(1.0, false), (1.0, true)], 0.5);
        assert_eq!(history(&mixed), [(0.0, 0.0), (1.0, 2.0), (1.5, 5.0), (2.0, 5.0)]);
        let mut removed = track.clone();
        removed.remove(2);
        let line = steps(&[(1.0, false), (1.0, false), (2.0, false)], 0.5);
        let found = line.history(&removed, &none, (0.0, true)).0;
        assert_eq!(found, [(0.0, 0.0), (1.0, 2.0), (2.0, 5.0), (4.0, 0.0)]);
    }

    #[test]
    fn amplitudes_count_from_the_step_or_from_the_start() {
        let points = vec![(0.0, 0.0), (0.5, 1.0), (3.0, 0.5)];
        let own = |total: bool| HashMap::from([("A".to_owned(), Amplitude { points: points.clone(), total })]);
        let line = steps(&[(1.0, false), (1.0, false)], 0.25);
        let track = Track(vec![set(0, 2.0, Some("A"))]);
        // A factor of 0.9 at 1 s and of 0.7 at 2 s; the factor by step time keeps its value from the end of the step.
        let of_step = line.history(&track, &own(false), (0.0, true)).0;
        assert_eq!(of_step.len(), 4);
        assert!((of_step[2].1 - 1.8).abs() < 1e-14 && (of_step[3].1 - 1.8).abs() < 1e-14, "{of_step:?}");
        let of_total = line.history(&track, &own(true), (0.0, true)).0;
        assert!((of_total[2].0 - 2.0).abs() < 1e-14 && (of_total[2].1 - 1.4).abs() < 1e-14, "{of_total:?}");
    }

    #[test]
    fn a_smooth_step_is_flat_at_its_ends_and_half_way_up_in_the_middle() {
        let points = smoothed(&[(0.0, 0.0), (2.0, 4.0)]);
        let middle = points.iter().find(|point| (point.0 - 1.0).abs() < 1e-12).expect("the middle");
        assert!((middle.1 - 2.0).abs() < 1e-12, "{middle:?}");
        assert!(points[1].1 < 0.01 && (points[20].1 - 4.0).abs() < 1e-12, "{points:?}");
    }
}
