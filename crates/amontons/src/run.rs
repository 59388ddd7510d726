//! A run: solves a problem from the start, or from a checkpoint, to its end, and passes its results to sinks.
//!
//! A run ends with a [`Summary`], or with a [`RunError`] that gives the reason. A failed step is never a result; the
//! results of the steps before it are kept.

mod differentiated;
mod stepping;

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use rayon::ThreadPool;

use crate::discretization::Discretization;
use crate::equation::{SetupError, Solvers, StepError};
use crate::hypotheses::{self, Finding};
use crate::linalg::{Backend, BlockMatrix, Choice, Decided, Estimate, Factor, Layout, SolveError, Unknowns};
use crate::machine::Instant;
use crate::output::{
    Checkpoint, CheckpointError, Outcome, OutputError, RunStart, Seconds, Sink, Snapshot, Summary, UnknownCounts, Work,
};
use crate::problem::Problem;
use crate::pulse::Pulse;
use crate::state::{State, StepReport};
use crate::step::{Kept, MakeScheme, March, Scheme};
pub use differentiated::{FoundModes, ModeSlopesError, modes_with};
pub use stepping::{Stepping, SteppingError};

/// Settings of a run. Only the scheme changes results.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Number of threads; `None` for those of the current thread pool, or else one per core.
    pub threads: Option<usize>,
    /// Ends the run before its next step when it becomes true.
    pub interrupt: Option<Arc<AtomicBool>>,
    /// Evaluates all hypotheses for the summary, which takes some factorizations; if false, only those that cost
    /// nothing.
    pub certificate: bool,
    /// The certificate of an earlier run with the same inputs, [`crate::output::known_certificate`]; it is not
    /// recomputed.
    pub known: Option<Vec<Finding>>,
    /// Called when a phase of the run begins.
    pub watch: Option<Watch>,
    /// Receives the progress within each step.
    pub pulse: Pulse,
    /// The time-stepping scheme. A run must be resumed with the scheme that it began with.
    pub scheme: MakeScheme,
}

/// Phase of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Assembles the matrices, before and after the hypotheses are evaluated.
    Assembly,
    /// Evaluates the hypotheses.
    Certificate,
    /// Factorizes the matrices.
    Factor,
    /// Makes the steps and passes each to the sinks.
    Steps,
    /// Writes the last results.
    Results,
}

/// Called when a phase of a run begins, by the thread that begins it.
#[derive(Clone)]
pub struct Watch(pub Arc<dyn Fn(Phase) + Send + Sync>);

impl fmt::Debug for Watch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Watch")
    }
}

impl Default for Settings {
    fn default() -> Settings {
        Settings {
            threads: None,
            interrupt: None,
            certificate: true,
            known: None,
            watch: None,
            pulse: Pulse::default(),
            scheme: March::make,
        }
    }
}

/// Reason why a run failed.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The threads could not be started.
    #[error("cannot start {threads} threads: {message}; ask for fewer with --threads")]
    Threads {
        /// Number requested.
        threads: usize,
        /// The error of the system.
        message: String,
    },
    /// The problem could not be set up.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// A step failed; sinks have the results up to the step before.
    #[error("{source}")]
    Step {
        /// The cause.
        source: StepError,
        /// The run up to the last good step.
        summary: Box<Summary>,
    },
    /// All steps were made, but the results cannot be trusted; sinks have the results.
    #[error("the results cannot be trusted: {}", .0.error.as_deref().unwrap_or("a figure is not finite"))]
    Unsound(Box<Summary>),
    /// The run was asked to stop; sinks have the results so far.
    #[error("interrupted after step {}", .0.steps)]
    Interrupted(Box<Summary>),
    /// The run was asked to stop before its first step; sinks were not started.
    #[error("interrupted before a step was made")]
    Unstarted {
        /// True if the run was to resume from a checkpoint.
        resumes: bool,
    },
    /// Results could not be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The run cannot be resumed from the checkpoint.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
}

/// Relative residual above which the remaining residual is more than round-off.
const ROUND_OFF: f64 = 1e-5;

impl RunError {
    /// The run up to its last good step; `None` if it ended before its steps.
    #[must_use]
    pub fn summary(&self) -> Option<&Summary> {
        match self {
            RunError::Step { summary, .. } | RunError::Unsound(summary) | RunError::Interrupted(summary) => {
                Some(summary)
            }
            _ => None,
        }
    }

    /// An instruction for a failed step or untrustworthy results; `None` for other errors.
    #[must_use]
    pub fn advice(&self) -> Option<String> {
        match self {
            RunError::Step { source, .. } => Some(step_advice(source)),
            RunError::Setup(SetupError::Equilibrium { source }) => Some(step_advice(source)),
            RunError::Unsound(_) => Some("`amontons check` may name the cause in the data".to_owned()),
            _ => None,
        }
    }
}

/// An instruction for a failed step.
fn step_advice(error: &StepError) -> String {
    let text = match error {
        StepError::Residual { residual, .. } if *residual > ROUND_OFF => {
            "nothing holds the body against the load: it slides or turns without resistance; give it a support, a spring or friction that is strong enough, or a density, with which it moves"
        }
        StepError::Residual { .. } => {
            "the remaining residual is round-off: stiffnesses or conductances of the case differ by more than about 1e9; reduce that ratio, or add a support if the body drifts"
        }
        StepError::Data { key, .. } => return format!("correct {key}"),
        StepError::Uncovered { found, .. } => {
            return format!(
                "extend the table of {} to the temperatures that occur, or change the heat load",
                found.key
            );
        }
        StepError::Driven { .. } => {
            "give the body a support or a spring along this motion, friction that is strong enough, or a density, with which it moves; or correct the load"
        }
        StepError::Unborne { at, .. } if at.ends_with("obstacle.load") => {
            "the obstacle meets the body along the direction of its load; the body is held against it; and the force is not that of a pull, which only a law with adhesion bears"
        }
        StepError::Unborne { .. } => {
            "both parts of the bolt bear on the joint or are held, so that it is stretched as they are drawn together; and the joint bears the force"
        }
        StepError::NotConverged { slides: true, .. } => {
            "no point of a body that contact alone holds sticks: where the load is more than friction bears, it slides or turns without resistance; give the body a support, a spring, friction that is strong enough or a density, with which it moves; if it is not, try more steps (time.steps)"
        }
        StepError::NotSteady { .. } => {
            "lower the speed, the friction or the pressure, or let more heat leave; more steps do not help"
        }
        StepError::DrawnAlong { .. } => {
            "lower the friction, hold the body, or follow it in time with analysis = \"quasistatic\"; more steps do not help"
        }
        _ => "try more steps (time.steps), or a finer mesh where the contact changes",
    };
    text.to_owned()
}

/// Runs a problem from t = 0.
///
/// # Errors
/// Fails if the run does not reach its end: see [`RunError`].
pub fn run(problem: &Problem, settings: &Settings, sinks: &mut [&mut dyn Sink]) -> Result<Summary, RunError> {
    drive(problem, None, settings, sinks)
}

/// Resumes a run from a checkpoint. States and reports have the same bits as those of a run without interruption.
///
/// # Errors
/// Fails if the checkpoint belongs to another problem or the run does not reach its end: see [`RunError`].
pub fn resume(
    problem: &Problem,
    from: Checkpoint,
    settings: &Settings,
    sinks: &mut [&mut dyn Sink],
) -> Result<Summary, RunError> {
    drive(problem, Some(from), settings, sinks)
}

fn drive(
    problem: &Problem,
    from: Option<Checkpoint>,
    settings: &Settings,
    sinks: &mut [&mut dyn Sink],
) -> Result<Summary, RunError> {
    let begin = Instant::now();
    let solvers = from.as_ref().map_or(&[][..], |checkpoint| &checkpoint.kept.solvers);
    let problem = &problem.interruptible(settings.interrupt.as_ref()).decided(solvers);
    let pool = pool(settings.threads)?;
    let begins = |phase: Phase| settings.watch.iter().for_each(|watch| (watch.0)(phase));
    let resumed = from.is_some();
    unless_interrupted(settings, resumed, Ok(()))?;
    begins(Phase::Assembly);
    let discrete = Arc::new(within(pool.as_ref(), || Discretization::new(problem)));
    unless_interrupted(settings, resumed, Ok(()))?;
    // Evaluated before the factors of the run are made, so that both are not in memory at once.
    begins(Phase::Certificate);
    let judging = Instant::now();
    let findings = within(pool.as_ref(), || judged(problem, &discrete, settings));
    unless_interrupted(settings, resumed, Ok(()))?;
    let certificate = judging.elapsed().as_secs_f64();
    begins(Phase::Assembly);
    let backend = Arc::new(Timed::new(&problem.backend, settings.watch.clone()));
    let solver: Arc<dyn Backend> = Arc::<Timed>::clone(&backend);
    let made = within(pool.as_ref(), || scheme(problem, &discrete, &solver, settings));
    let mut scheme = unless_interrupted(settings, resumed, made)?;
    let unknowns = counted(&*scheme);
    let Checkpoint { mut state, mut report, work: before, kept, .. } = beginning(from, problem, &*scheme)?;
    // Factorizations repeated by a resumed run have been counted already.
    unless_interrupted(settings, resumed, within(pool.as_ref(), || scheme.recall(&kept)))?;
    let again = if resumed { scheme.solvers().factorizations } else { [0; 2] };
    let mut clock = Clock { begin, seconds: before.seconds, before: before.seconds.total, again };
    let factor = backend.seconds();
    clock.seconds.factor += factor;
    clock.seconds.certificate += certificate;
    clock.seconds.setup += begin.elapsed().as_secs_f64() - factor - certificate;

    let threads = pool.as_ref().map_or_else(rayon::current_num_threads, ThreadPool::current_num_threads);
    let from = seen(problem, &*scheme, &state, report.as_ref(), clock.work(before, &*scheme));
    let start = RunStart { from, threads, resumed, certificate: settings.certificate.then_some(&findings[..]) };
    clock.output(|| sinks.iter_mut().try_for_each(|sink| sink.start(&start)))?;

    begins(Phase::Steps);
    let failed = loop {
        if state.is_last(&problem.timeline) || interrupted(settings) {
            break None;
        }
        let step = Instant::now();
        let made = within(pool.as_ref(), || scheme.step(&state));
        clock.seconds.steps += step.elapsed().as_secs_f64();
        match made {
            Ok((next, how)) => (state, report) = (next, Some(how)),
            Err(error) if error.is_interruption() => break None,
            Err(error) => break Some(error),
        }
        let work = clock.work(before, &*scheme);
        let now = seen(problem, &*scheme, &state, report.as_ref(), work);
        clock.output(|| sinks.iter_mut().try_for_each(|sink| sink.step(&now)))?;
    };

    begins(Phase::Results);
    let last = seen(problem, &*scheme, &state, report.as_ref(), clock.work(before, &*scheme));
    let outcome = outcome(failed.as_ref(), state.is_last(&problem.timeline));
    clock.output(|| sinks.iter_mut().try_for_each(|sink| hand_over(*sink, &last, outcome)))?;
    let last = Snapshot { work: clock.work(before, &*scheme), ..last };
    let error = failed.as_ref().map(ToString::to_string);
    let summary = sound(Summary::new(&last, unknowns, findings, outcome, error), &*scheme);
    sinks.iter_mut().try_for_each(|sink| sink.finish(&summary))?;
    ended(failed, summary)
}

/// The scheme, set up to report its progress within each step.
fn scheme(
    problem: &Problem,
    discrete: &Arc<Discretization>,
    solver: &Arc<dyn Backend>,
    settings: &Settings,
) -> Result<Box<dyn Scheme>, SetupError> {
    let mut scheme = (settings.scheme)(problem, discrete, solver)?;
    scheme.watched_by(&settings.pulse);
    Ok(scheme)
}

/// The snapshot passed to sinks.
fn seen<'a>(
    problem: &'a Problem,
    scheme: &'a dyn Scheme,
    state: &'a State,
    report: Option<&'a StepReport>,
    work: Work,
) -> Snapshot<'a> {
    let problem = scheme.problem().unwrap_or(problem);
    Snapshot { problem, discretization: scheme.discretization(), state, report, work, scheme: Some(scheme) }
}

fn counted(scheme: &dyn Scheme) -> UnknownCounts {
    let [displacement, temperature, contact] = scheme.solvers().unknowns;
    UnknownCounts { displacement, temperature, contact }
}

/// The findings on the data requested by the settings.
fn judged(problem: &Problem, discrete: &Arc<Discretization>, settings: &Settings) -> Vec<Finding> {
    match &settings.known {
        Some(known) if settings.certificate => known.clone(),
        _ if settings.certificate => hypotheses::certificate_or_findings_on(problem, &|| Arc::clone(discrete)).findings,
        _ => hypotheses::without_factors(problem),
    }
}

/// The initial state of a run, or that of its checkpoint.
fn beginning(from: Option<Checkpoint>, problem: &Problem, scheme: &dyn Scheme) -> Result<Checkpoint, RunError> {
    let Some(checkpoint) = from else {
        let state = scheme.initial()?;
        return Ok(Checkpoint {
            state,
            report: None,
            work: Work::default(),
            kept: Kept::default(),
            k: problem.timeline.instant(1).k,
            fallback: None,
        });
    };
    checkpoint.check(scheme.discretization(), problem)?;
    Ok(checkpoint)
}

/// The outcome of a run from its error, and whether it made its last step.
fn outcome(failed: Option<&StepError>, is_over: bool) -> Outcome {
    match failed {
        Some(_) => Outcome::NotConverged,
        None if !is_over => Outcome::Interrupted,
        None => Outcome::Done,
    }
}

/// Marks the summary of a run as unsound if its figures cannot be trusted.
fn sound(mut summary: Summary, scheme: &dyn Scheme) -> Summary {
    let Solvers { backend, backend_reason, .. } = scheme.solvers();
    backend.clone_into(&mut summary.solver.backend);
    summary.solver.backend_reason = backend_reason;
    if summary.outcome == Outcome::Done
        && let Some(why) = summary.unsound()
    {
        (summary.outcome, summary.error) = (Outcome::Unsound, Some(why));
    }
    summary
}

/// The result of a run from its error, if any, and its summary.
fn ended(failed: Option<StepError>, summary: Summary) -> Result<Summary, RunError> {
    match (failed, summary.outcome) {
        (Some(source), _) => Err(RunError::Step { source, summary: Box::new(summary) }),
        (None, Outcome::Done) => Ok(summary),
        (None, Outcome::Unsound) => Err(RunError::Unsound(Box::new(summary))),
        (None, _) => Err(RunError::Interrupted(Box::new(summary))),
    }
}

/// The result of work before the first step. An interruption there leaves nothing to keep: half a certificate is
/// useless.
fn unless_interrupted<T>(settings: &Settings, resumes: bool, made: Result<T, SetupError>) -> Result<T, RunError> {
    if interrupted(settings) { Err(RunError::Unstarted { resumes }) } else { Ok(made?) }
}

/// Passes the last good step to a sink.
fn hand_over(sink: &mut dyn Sink, last: &Snapshot, outcome: Outcome) -> Result<(), OutputError> {
    if outcome == Outcome::Interrupted { sink.interrupted(last) } else { sink.last(last) }
}

fn interrupted(settings: &Settings) -> bool {
    settings.interrupt.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed))
}

/// Stack size of a thread in bytes, equal to that of the main thread on most systems.
const STACK: usize = 8 << 20;
/// Largest number of threads on machines with few cores, and threads per core on others: more starve the machine.
const LEAST_BOUND: usize = 64;
const PER_CORE: usize = 4;

/// A separate pool, so that nothing global is set and a failure to start a thread is an error; `None` if the current
/// pool will do.
fn pool(threads: Option<usize>) -> Result<Option<ThreadPool>, RunError> {
    // A browser has one thread, which does all computations.
    if cfg!(target_family = "wasm") {
        return Ok(None);
    }
    let inside = rayon::current_thread_index().is_some();
    if inside && threads.is_none_or(|threads| threads == rayon::current_num_threads()) {
        return Ok(None);
    }
    let (most, asked) = (most_threads(), threads.unwrap_or(0));
    if asked > most {
        let message = format!("at most {most} can be asked for, 64 or four per core");
        return Err(RunError::Threads { threads: asked, message });
    }
    let built = rayon::ThreadPoolBuilder::new().num_threads(asked).stack_size(STACK).build();
    built.map(Some).map_err(|error| {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        RunError::Threads { threads: threads.unwrap_or(cores), message: error.to_string() }
    })
}

/// Largest number of threads that can be requested: 64 on every machine, more with many cores.
#[must_use]
pub fn most_threads() -> usize {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    LEAST_BOUND.max(PER_CORE * cores)
}

/// Computes with a number of threads, or with all available ones.
///
/// # Errors
/// [`RunError::Threads`] if they cannot be started.
pub fn with_threads<T: Send>(threads: Option<usize>, compute: impl FnOnce() -> T + Send) -> Result<T, RunError> {
    Ok(within(pool(threads)?.as_ref(), compute))
}

/// Computes in the given pool, or in the current one if `None`.
fn within<T: Send>(pool: Option<&ThreadPool>, compute: impl FnOnce() -> T + Send) -> T {
    match pool {
        Some(pool) => pool.install(compute),
        None => compute(),
    }
}

/// Times of a run.
#[derive(Debug)]
struct Clock {
    begin: Instant,
    seconds: Seconds,
    /// Total of the earlier sessions.
    before: f64,
    /// Factorizations of this session that an earlier one also made.
    again: [usize; 2],
}

impl Clock {
    /// Work so far.
    fn work(&self, before: Work, scheme: &dyn Scheme) -> Work {
        let [factorizations, contact_factorizations] = scheme.solvers().factorizations;
        Work {
            factorizations: before.factorizations + factorizations - self.again[0],
            contact_factorizations: before.contact_factorizations + contact_factorizations - self.again[1],
            seconds: Seconds { total: self.before + self.begin.elapsed().as_secs_f64(), ..self.seconds },
        }
    }

    /// Counts the time of `write` as output.
    fn output(&mut self, write: impl FnOnce() -> Result<(), OutputError>) -> Result<(), OutputError> {
        let begin = Instant::now();
        let result = write();
        self.seconds.output += begin.elapsed().as_secs_f64();
        result
    }
}

/// A backend that records when it factorizes.
#[derive(Debug)]
struct Timed {
    backend: Arc<dyn Backend>,
    /// Called at the first factorization.
    watch: Mutex<Option<Watch>>,
    intervals: Arc<Mutex<Vec<(Instant, Instant)>>>,
}

impl Timed {
    fn new(backend: &Arc<dyn Backend>, watch: Option<Watch>) -> Timed {
        Timed { backend: Arc::clone(backend), watch: Mutex::new(watch), intervals: Arc::default() }
    }

    /// Seconds spent in factorizations; simultaneous ones count once.
    fn seconds(&self) -> f64 {
        let mut intervals = self.intervals.lock().unwrap_or_else(PoisonError::into_inner).clone();
        intervals.sort();
        let mut sum = 0.0;
        let mut until: Option<Instant> = None;
        for (begin, end) in intervals {
            let begin = until.map_or(begin, |until| begin.max(until));
            sum += end.saturating_duration_since(begin).as_secs_f64();
            until = Some(until.map_or(end, |until| end.max(until)));
        }
        sum
    }
}

impl Backend for Timed {
    fn decided(&self, before: &[Decided]) -> Option<Arc<dyn Backend>> {
        let backend = self.backend.decided(before)?;
        let watch = Mutex::new(self.watch.lock().unwrap_or_else(PoisonError::into_inner).take());
        Some(Arc::new(Timed { backend, watch, intervals: Arc::clone(&self.intervals) }))
    }
    fn order(&self, matrix: &BlockMatrix, layout: &Layout) -> Unknowns {
        self.backend.order(matrix, layout)
    }
    fn choice(&self, estimate: &Estimate) -> Choice {
        self.backend.choice(estimate)
    }
    fn proves(&self, matrix: &BlockMatrix, layout: &Layout) -> bool {
        self.backend.proves(matrix, layout)
    }
    fn is_collective(&self) -> bool {
        self.backend.is_collective()
    }
    fn alone(&self) -> Option<Arc<dyn Backend>> {
        self.backend.alone()
    }
    fn reason(&self) -> Option<String> {
        self.backend.reason()
    }
    fn is_positive_definite(&self, matrix: &Arc<BlockMatrix>, layout: &Layout) -> Result<bool, SolveError> {
        self.backend.is_positive_definite(matrix, layout)
    }
    fn factorize(&self, matrix: &Arc<BlockMatrix>, unknowns: &Unknowns) -> Result<Box<dyn Factor>, SolveError> {
        if let Some(watch) = self.watch.lock().unwrap_or_else(PoisonError::into_inner).take() {
            (watch.0)(Phase::Factor);
        }
        let begin = Instant::now();
        let factor = self.backend.factorize(matrix, unknowns);
        self.intervals.lock().unwrap_or_else(PoisonError::into_inner).push((begin, Instant::now()));
        factor
    }
}
