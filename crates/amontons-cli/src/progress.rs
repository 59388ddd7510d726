//! Progress of a command: a bar on a terminal, a line per minute elsewhere, or a JSON object per line.
//!
//! The work notes its progress. A separate thread reports it, so that a long certificate or factorization is reported,
//! too.

use std::io::{IsTerminal, Write};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use amontons::contact::Status;
use amontons::output::{OutputError, RunStart, Sink, Snapshot};
use amontons::pulse::Pulse;
use amontons::run::{Phase, Watch};
use amontons::units::{Measure, Units};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};

use crate::arguments::{Common, ProgressArgument};
use crate::signals;
use crate::status::INTERRUPTED;

/// Delay before a command gets a bar, and time between two updates of the bar.
const PATIENCE: Duration = Duration::from_secs(1);
const REDRAW: Duration = Duration::from_millis(200);
/// Number of iterations of a step from which on they are shown.
const MANY: usize = 20;
/// Time between lines if standard error is no terminal.
const MINUTE: Duration = Duration::from_mins(1);
/// Least time between JSON lines of steps.
const JSON: Duration = Duration::from_secs(1);

/// Form of the progress reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ProgressMode {
    Bar,
    Lines,
    Json,
    Silent,
}

/// Progress of the work.
#[derive(Clone, Debug)]
struct ProgressPlace {
    /// The part of the command, such as `study 3 of 6`; empty if there is one part.
    part: String,
    /// One of `mesh`, `assembly`, `certificate`, `factor`, `steps`, `results`.
    phase: &'static str,
    begin: Instant,
    phase_begin: Instant,
    /// Steps done, steps done before the phase began, and all steps.
    step: usize,
    first: usize,
    steps: usize,
    /// True if the number of all steps is an estimate: that of steps so far over their share of the time.
    is_estimate: bool,
    t: Option<f64>,
    /// The phase of the case in which the step was made; empty in a case without phases.
    of_case: String,
    /// Unit of the time.
    units: Units,
    /// Iterations and parts reported by the current step.
    pulse: Pulse,
    /// Numbers of open, sticking and slipping contact points.
    contact: Option<[usize; 3]>,
    told: Option<Instant>,
    ended: bool,
}

impl ProgressPlace {
    /// Estimated seconds for the remaining steps, or `None` before the first step.
    fn left(&self) -> Option<f64> {
        let done = self.step.checked_sub(self.first).filter(|&done| done > 0 && self.phase == "steps")?;
        Some(self.phase_begin.elapsed().as_secs_f64() / done as f64 * self.steps.saturating_sub(self.step) as f64)
    }

    /// Progress within the current step, if it takes many iterations: `, in step 13 iteration 40 of part 3`.
    fn within(&self) -> String {
        let (iterations, parts) = (self.pulse.iterations(), self.pulse.parts());
        if iterations < MANY || self.step >= self.steps {
            return String::new();
        }
        let part = if parts > 1 { format!(" of part {parts}") } else { String::new() };
        format!(", in step {} iteration {iterations}{part}", self.step + 1)
    }

    /// A line of progress: `study 3 of 6: step 12 of 64, t = 0.1875 s; contact: 3 open, 0 stick, 5 slip; 2 min gone,
    /// about 9 min left`.
    fn line(&self) -> String {
        let part = if self.part.is_empty() { String::new() } else { format!("{}: ", self.part) };
        let gone = duration(self.begin.elapsed().as_secs_f64());
        if self.phase != "steps" {
            return format!(
                "{part}{}, {} in this phase; {gone} gone",
                self.phase,
                duration(self.phase_begin.elapsed().as_secs_f64())
            );
        }
        let time = self.t.map_or_else(String::new, |t| {
            format!(", t = {t:.6} {}", self.units.of(Measure::Time)).trim_end().to_owned()
        });
        let contact = self.contact.map_or_else(String::new, |[open, stick, slip]| {
            format!("; contact: {open} open, {stick} stick, {slip} slip")
        });
        let left = self.left().map_or_else(String::new, |left| format!(", about {} left", duration(left)));
        let (of_case, within) = (self.of_case(), self.within());
        format!("{part}step {} of {}{of_case}{within}{time}{contact}; {gone} gone{left}", self.step, self.all())
    }

    /// A text that fits next to a bar in 80 columns, the most important first: `step 12 of 64, about 9 min left; 3
    /// open, 0 stick, 5 slip`.
    fn short(&self) -> String {
        let part = if self.part.is_empty() { String::new() } else { format!("{}: ", self.part) };
        if self.phase != "steps" {
            return format!("{part}{}, {}", self.phase, duration(self.phase_begin.elapsed().as_secs_f64()));
        }
        let left = self.left().map_or_else(
            || format!(", {} gone", duration(self.begin.elapsed().as_secs_f64())),
            |left| format!(", about {} left", duration(left)),
        );
        let contact = self
            .contact
            .map_or_else(String::new, |[open, stick, slip]| format!("; {open} open, {stick} stick, {slip} slip"));
        let (of_case, within) = (self.of_case(), self.within());
        format!("{part}step {} of {}{of_case}{within}{left}{contact}", self.step, self.all())
    }

    /// The number of all steps, as far as it is known.
    fn all(&self) -> String {
        format!("{}{}", if self.is_estimate { "about " } else { "" }, self.steps)
    }

    /// The phase of the case behind a number of steps: ` (spin)`.
    fn of_case(&self) -> String {
        if self.of_case.is_empty() { String::new() } else { format!(" ({})", self.of_case) }
    }

    fn json(&self) -> Value {
        let mut value = json!({ "phase": self.phase, "seconds": self.begin.elapsed().as_secs_f64() });
        if !self.part.is_empty() {
            value["part"] = json!(self.part);
        }
        if self.phase == "steps" {
            value["step"] = json!(self.step);
            value["steps"] = json!(self.steps);
            value["seconds_left"] = json!(self.left());
            value["iteration"] = json!(self.pulse.iterations());
            value["attempts"] = json!(self.pulse.parts());
            value["t"] = json!(self.t);
            if !self.of_case.is_empty() {
                value["phase_of_case"] = json!(self.of_case);
            }
            value["contact"] = self
                .contact
                .map_or(Value::Null, |[open, stick, slip]| json!({ "open": open, "stick": stick, "slip": slip }));
        }
        value
    }

    /// True if the command is a single run that has made no step, or has not found its mesh: there is nothing to finish
    /// or to keep.
    fn has_nothing(&self) -> bool {
        self.part.is_empty() && matches!(self.phase, REFINING | "certificate" | "assembly" | "factor")
    }

    /// Message after a first signal.
    fn after_interrupt(&self, signal: &str) -> String {
        let first = match self.phase {
            "steps" if self.step < self.steps => format!("step {} of {}", self.step + 1, self.all()),
            _ if self.has_nothing() => return format!("{signal}: the run ends before its first step"),
            phase => format!("the present phase ({phase})"),
        };
        let kept = if self.part.is_empty() { "a checkpoint is written" } else { "what is finished is kept" };
        // A long step is not finished: linear algebra and contact iterations stop at once.
        format!("{signal}: the run ends in or after {first}, and {kept}; a second Ctrl-C stops at once")
    }
}

/// The phase in which a mesh is refined until the error is small.
const REFINING: &str = "refinement";

/// Text of a duration: `3 s`, `2 min 10 s`, `1 h 5 min`.
fn duration(seconds: f64) -> String {
    let s = seconds.round() as u64;
    match s {
        0..=59 => format!("{s} s"),
        60..=3599 => format!("{} min {} s", s / 60, s % 60),
        _ => format!("{} h {} min", s / 3600, s % 3600 / 60),
    }
}

/// Data shared by the work and the reporting thread.
#[derive(Debug)]
struct Shared {
    mode: ProgressMode,
    place: Mutex<ProgressPlace>,
    wake: Condvar,
}

impl Shared {
    fn place(&self) -> MutexGuard<'_, ProgressPlace> {
        self.place.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn phase(&self, phase: &'static str) {
        let mut place = self.place();
        (place.phase, place.phase_begin, place.first, place.told) = (phase, Instant::now(), place.step, None);
        if self.mode == ProgressMode::Json {
            tell(&place.json().to_string());
            place.told = Some(Instant::now());
        }
    }

    fn step(&self, step: usize, t: Option<f64>, contact: Option<[usize; 3]>) {
        let mut place = self.place();
        (place.step, place.t, place.contact) = (step, t, contact);
        let due = place.told.is_none_or(|told| told.elapsed() >= JSON) || step == place.steps;
        if self.mode == ProgressMode::Json && due {
            tell(&place.json().to_string());
            place.told = Some(Instant::now());
        }
    }
}

/// Prints a line on standard error; an error there cannot be reported.
fn tell(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// Reports the progress of a command until it is dropped.
pub struct Progress {
    shared: Arc<Shared>,
    reporter: Option<JoinHandle<()>>,
}

impl Progress {
    /// Progress reports as requested by the arguments, starting with the phase `mesh`.
    pub fn new(common: &Common) -> Progress {
        let mode = match common.progress {
            ProgressArgument::Json => ProgressMode::Json,
            ProgressArgument::None => ProgressMode::Silent,
            ProgressArgument::Auto if common.quiet => ProgressMode::Silent,
            ProgressArgument::Auto if std::io::stderr().is_terminal() => ProgressMode::Bar,
            ProgressArgument::Auto => ProgressMode::Lines,
        };
        Progress::with(mode, MINUTE)
    }

    fn with(mode: ProgressMode, interval: Duration) -> Progress {
        let now = Instant::now();
        let place = ProgressPlace {
            part: String::new(),
            phase: "mesh",
            begin: now,
            phase_begin: now,
            step: 0,
            first: 0,
            steps: 0,
            is_estimate: false,
            t: None,
            of_case: String::new(),
            units: Units::default(),
            pulse: Pulse::default(),
            contact: None,
            told: None,
            ended: false,
        };
        let shared = Arc::new(Shared { mode, place: Mutex::new(place), wake: Condvar::new() });
        if mode == ProgressMode::Json {
            shared.phase("mesh");
        }
        let reporter = matches!(mode, ProgressMode::Bar | ProgressMode::Lines).then(|| {
            let shared = Arc::clone(&shared);
            let report = move || report(&shared, if shared.mode == ProgressMode::Bar { REDRAW } else { interval });
            // Without a reporting thread there are no reports.
            std::thread::Builder::new().spawn(report).ok()
        });
        Progress { shared, reporter: reporter.flatten() }
    }

    /// Begins a part of the command with a number of steps.
    pub fn part(&self, name: &str, steps: usize) {
        let mut place = self.shared.place();
        (place.part, place.steps, place.step, place.t, place.contact) = (name.to_owned(), steps, 0, None, None);
    }

    /// Begins the steps of a study.
    pub fn begin_steps(&self) {
        self.shared.phase("steps");
    }

    /// Begins the runs that look for a mesh, which keep nothing.
    pub fn begin_refining(&self) {
        self.shared.phase(REFINING);
    }

    /// Notes the number of finished steps of a study.
    pub fn done(&self, steps: usize) {
        self.shared.step(steps, None, None);
    }

    /// Follows the phases of a run.
    pub fn watch(&self) -> Watch {
        let shared = Arc::clone(&self.shared);
        Watch(Arc::new(move |phase| {
            shared.phase(match phase {
                Phase::Certificate => "certificate",
                Phase::Assembly => "assembly",
                Phase::Factor => "factor",
                Phase::Steps => "steps",
                Phase::Results => "results",
            });
        }))
    }

    /// The counts of iterations and parts of the current step of a run.
    pub fn pulse(&self) -> Pulse {
        self.shared.place().pulse.clone()
    }

    /// A flag that is set by Ctrl-C and the signals of batch systems, with a message about what happens next. The
    /// program ends at once before the first step of a run, whose set-up may take minutes, and after a second Ctrl-C.
    pub fn interrupt_flag(&self) -> Arc<AtomicBool> {
        let flag = Arc::new(AtomicBool::new(false));
        let shared = Arc::clone(&self.shared);
        signals::interrupts(&flag, move |signal| {
            let place = shared.place().clone();
            let message = place.after_interrupt(signal);
            match shared.mode {
                ProgressMode::Json => tell(&json!({ "interrupted": message }).to_string()),
                // The reason why a program ends is always reported.
                ProgressMode::Silent if !place.has_nothing() => {}
                ProgressMode::Silent | ProgressMode::Bar | ProgressMode::Lines => tell(&message),
            }
            if place.has_nothing() {
                std::process::exit(i32::from(INTERRUPTED.1));
            }
        });
        flag
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.shared.place().ended = true;
        self.shared.wake.notify_all();
        if let Some(reporter) = self.reporter.take() {
            // A reporter that has panicked has nothing left to report.
            let _ = reporter.join();
        }
    }
}

/// Draws a bar or prints lines until the command ends.
fn report(shared: &Shared, interval: Duration) {
    let mut bar: Option<ProgressBar> = None;
    let mut place = shared.place();
    while !place.ended {
        place = shared.wake.wait_timeout(place, interval).unwrap_or_else(PoisonError::into_inner).0;
        if place.ended {
            break;
        }
        if shared.mode == ProgressMode::Lines {
            tell(&format!("amontons: {}", place.line()));
        } else if place.begin.elapsed() > PATIENCE {
            draw(bar.get_or_insert_with(new_bar), &place);
        }
    }
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
}

fn new_bar() -> ProgressBar {
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    match ProgressStyle::with_template("[{bar:8}] {wide_msg}") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

fn draw(bar: &ProgressBar, place: &ProgressPlace) {
    bar.set_length(place.steps.max(1) as u64);
    bar.set_position(place.step as u64);
    bar.set_message(place.short());
}

/// The name of the phase of the last step; empty in a case without phases.
fn phase_of_case(now: &Snapshot) -> String {
    now.state.phase(&now.problem.timeline).map_or_else(String::new, |phase| phase.name.clone())
}

/// The number of all steps: if it is not known, that of steps so far over their share of the time.
fn steps_in_all(now: &Snapshot, known: usize) -> usize {
    let (timeline, made) = (&now.problem.timeline, now.state.step);
    match (timeline.is_automatic(), now.state.is_last(timeline)) {
        (false, _) => known,
        (true, true) => made,
        (true, false) => ((made as f64 * timeline.end() / now.state.t).ceil() as usize).max(made + 1),
    }
}

/// Notes the steps of a run.
pub struct StepSink<'a>(pub &'a Progress);

impl Sink for StepSink<'_> {
    fn start(&mut self, start: &RunStart) -> Result<(), OutputError> {
        let mut place = self.0.shared.place();
        (place.step, place.steps, place.t) =
            (start.from.state.step, start.from.problem.timeline.steps(), Some(start.from.state.t));
        place.is_estimate = start.from.problem.timeline.is_automatic();
        place.units = start.from.problem.units();
        place.of_case = phase_of_case(&start.from);
        Ok(())
    }

    fn step(&mut self, now: &Snapshot) -> Result<(), OutputError> {
        let states = now.report.map(|report| &report.contact.states).filter(|states| !states.is_empty());
        let count = |status| states.map_or(0, |states| states.iter().filter(|state| state.status == status).count());
        let contact = states.map(|_| [Status::Open, Status::Stick, Status::Slip].map(count));
        {
            let mut place = self.0.shared.place();
            place.of_case = phase_of_case(now);
            place.steps = steps_in_all(now, place.steps);
        }
        self.0.shared.step(now.state.step, Some(now.state.t), contact);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_tells_phase_step_contact_and_time_left() {
        let progress = Progress::with(ProgressMode::Silent, MINUTE);
        progress.shared.phase("certificate");
        assert_eq!(progress.shared.place().line(), "certificate, 0 s in this phase; 0 s gone");
        let told = progress.shared.place().after_interrupt("SIGTERM");
        assert_eq!(told, "SIGTERM: the run ends before its first step");
        progress.part("study 3 of 6", 8);
        // The previous studies are finished and reported in order.
        progress.shared.phase("factor");
        let told = progress.shared.place().after_interrupt("SIGTERM");
        assert!(
            told.starts_with(
                "SIGTERM: the run ends in or after the present phase (factor), and what is finished is kept"
            ),
            "{told}"
        );
        progress.shared.phase("steps");
        assert_eq!(progress.shared.place().left(), None);
        progress.shared.step(2, Some(0.25), Some([3, 0, 5]));
        let mut place = progress.shared.place().clone();
        // 40 s for 2 of 8 steps: 120 s for the other 6.
        let ago = |seconds| Instant::now().checked_sub(Duration::from_secs(seconds)).unwrap();
        (place.begin, place.phase_begin) = (ago(3700), ago(40));
        assert_eq!(
            place.line(),
            "study 3 of 6: step 2 of 8, t = 0.250000 s; contact: 3 open, 0 stick, 5 slip; 1 h 1 min gone, about 2 min 0 s left"
        );
        let value = place.json();
        assert_eq!(
            (&value["step"], &value["contact"]["slip"], &value["part"]),
            (&json!(2), &json!(5), &json!("study 3 of 6"))
        );
        assert_eq!(
            place.after_interrupt("Ctrl-C"),
            "Ctrl-C: the run ends in or after step 3 of 8, and what is finished is kept; a second Ctrl-C stops at once"
        );
        place.step = 8;
        assert!(
            place.after_interrupt("Ctrl-C").starts_with("Ctrl-C: the run ends in or after the present phase (steps)"),
            "there is no step 9 of 8"
        );
    }
}
