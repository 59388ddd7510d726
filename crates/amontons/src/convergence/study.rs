//! A study: its levels, its reference, and the resulting table.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::norms::{Errors, Exact, against_exact};
use super::transfer::{Transfer, TransferError};
use super::values::{self, FinalValue, FinalValues, LastStep, OfLevel, ValueRow};
use crate::discretization::Discretization;
use crate::equation::{SetupError, StepError};
use crate::forms;
use crate::machine::Instant;
use crate::material::{Isotropic, StressState};
use crate::problem::Problem;
use crate::state::{State, StepReport};
use crate::step::{MakeScheme, March, Scheme};

/// Quantity refined from level to level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Vary {
    /// Mesh and step together.
    #[default]
    Both,
    /// The mesh only.
    Space,
    /// The step only.
    Time,
}

/// One level of a study.
#[derive(Clone, Debug)]
pub struct StudyLevel {
    /// The number that names it.
    pub level: usize,
    /// The problem on its mesh with its steps.
    pub problem: Problem,
    /// The text of its case, which identifies states kept earlier.
    pub text: String,
    /// The numbers of its last step that the table compares; `None` for none.
    pub measured: Option<FinalValues>,
}

impl StudyLevel {
    /// The numbers of a last step.
    fn values(&self, discretization: &Discretization, state: &State, report: &StepReport) -> Vec<FinalValue> {
        let last = LastStep { problem: &self.problem, discretization, state, report };
        self.measured.as_ref().map_or_else(Vec::new, |measured| measured.of(&last))
    }
}

/// Solution with which the levels are compared.
#[derive(Clone, Debug)]
pub enum Reference {
    /// The solution on a finer level.
    Level(Box<StudyLevel>),
    /// A closed form.
    Exact(Exact),
}

/// Levels and reference.
#[derive(Clone, Debug)]
pub struct Study {
    /// Quantity that is refined.
    pub vary: Vary,
    /// The levels, coarsest first.
    pub levels: Vec<StudyLevel>,
    /// Solution with which they are compared.
    pub reference: Reference,
}

/// Settings of a study.
pub struct StudySettings<'a> {
    /// Ends the study at the next step when set.
    pub interrupt: Option<&'a AtomicBool>,
    /// Called after every step with level, step, and number of steps.
    pub progress: Option<&'a (dyn Fn(usize, usize, usize) + Sync)>,
    /// Loads finished levels of an earlier attempt: states at all times of a level, or `None`.
    pub load: Option<&'a (dyn Fn(&StudyLevel) -> Option<Vec<State>> + Sync)>,
    /// Keeps a finished level.
    pub keep: Option<&'a (dyn Fn(&StudyLevel, &[State]) + Sync)>,
    /// Loads the progress of the reference in an earlier attempt with the same levels.
    pub load_reference: Option<&'a (dyn Fn() -> Option<ReferenceProgress> + Sync)>,
    /// Keeps the progress of the reference when the study is interrupted, and once per minute.
    pub keep_reference: Option<&'a (dyn Fn(&ReferenceProgress) + Sync)>,
    /// The time-stepping scheme of all levels.
    pub scheme: MakeScheme,
}

impl Default for StudySettings<'_> {
    fn default() -> Self {
        StudySettings {
            interrupt: None,
            progress: None,
            load: None,
            keep: None,
            load_reference: None,
            keep_reference: None,
            scheme: March::make,
        }
    }
}

/// Progress of the reference of a study: its state, and the errors of the levels up to its time.
#[derive(Clone, Debug)]
pub struct ReferenceProgress {
    /// The state.
    pub state: State,
    /// The errors of each level.
    pub worst: Vec<Worst>,
}

/// A row of the table: the errors of a level, each the maximum over the times of the level.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorRow {
    /// The number that names the level.
    pub level: usize,
    /// Spacing of the mesh, [`crate::mesh::Mesh::spacing`], m.
    pub h: f64,
    /// Time step in s.
    pub k: f64,
    /// Maximum of ‖w − w^{hk}‖_H.
    pub error_w: f64,
    /// Maximum of ‖ε(u − u^{hk})‖.
    pub error_u: f64,
    /// Maximum of ‖θ − θ^{hk}‖_{L²}.
    pub error_theta: f64,
    /// Maximum of ‖u − u^{hk}‖_H.
    pub error_u_h: f64,
    /// E^{hk}, the maximum of the sum of the three of (5.2).
    pub error: f64,
    /// Time at which the maximum of the sum is taken, s.
    pub time_of_error: f64,
    /// log(E of the row before / E) / log of the refinement; `None` in the first row.
    pub order: Option<f64>,
}

/// The result of a study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StudyTable {
    /// Quantity that was refined.
    pub vary: Vary,
    /// The rows, coarsest first.
    pub rows: Vec<ErrorRow>,
    /// Least-squares slopes of the logarithms over all rows, by name of the error.
    pub slopes: Vec<(String, f64)>,
    /// True if every comparison was made by interpolation between nested meshes.
    pub nested: bool,
    /// Probes, resultants and energies at the end on each level, with orders and limits.
    #[serde(default)]
    pub values: Vec<ValueRow>,
}

/// Reason why a study ended early.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// A level could not be set up.
    #[error("level {level}: {source}")]
    Setup {
        /// The level.
        level: usize,
        /// The cause.
        source: SetupError,
    },
    /// A step of a level failed.
    #[error("level {level}: {source}")]
    Step {
        /// The level.
        level: usize,
        /// The cause.
        source: StepError,
    },
    /// A level cannot be compared with the reference.
    #[error("level {level}: {source}")]
    Transfer {
        /// The level.
        level: usize,
        /// The cause.
        source: TransferError,
    },
    /// The times of a level are not times of the reference.
    #[error(
        "level {level} has {steps} steps, which do not divide the {reference} steps of the reference: they have no common times"
    )]
    Times {
        /// The level.
        level: usize,
        /// Its number of steps.
        steps: usize,
        /// Steps of the reference.
        reference: usize,
    },
    /// The study was interrupted.
    #[error("interrupted")]
    Interrupted,
}

impl Study {
    /// Steps of all levels and of the reference.
    #[must_use]
    pub fn steps(&self) -> usize {
        let reference = match &self.reference {
            Reference::Level(level) => level.problem.timeline.steps(),
            Reference::Exact(_) => 0,
        };
        self.levels.iter().map(|level| level.problem.timeline.steps()).sum::<usize>() + reference
    }

    /// Solves all levels and compares them.
    ///
    /// # Errors
    /// Fails if a level fails, if times or meshes do not match, or if the study is interrupted.
    pub fn run(&self, settings: &StudySettings) -> Result<StudyTable, StudyError> {
        match &self.reference {
            Reference::Exact(exact) => {
                let rows = self.levels.par_iter().map(|level| {
                    let mut worst = Worst::default();
                    let values = walk(level, settings, |state| {
                        worst.take(state.t, against_exact(&level.problem.mesh, state, exact));
                        Ok(())
                    })?;
                    Ok((worst.row(level), values))
                });
                let (rows, values) = rows.collect::<Result<Vec<_>, StudyError>>()?.into_iter().unzip();
                Ok(self.table(rows, true, values))
            }
            Reference::Level(reference) => self.against(reference, settings),
        }
    }

    /// Checks that the times of all levels are times of the reference.
    fn check_times(&self, reference: &StudyLevel) -> Result<(), StudyError> {
        let timeline = &reference.problem.timeline;
        let misses = |level: &&StudyLevel| timeline.parts_of(&level.problem.timeline).is_none();
        self.levels.iter().find(misses).map_or(Ok(()), |level| {
            let steps = level.problem.timeline.steps();
            Err(StudyError::Times { level: level.level, steps, reference: timeline.steps() })
        })
    }

    fn against(&self, reference: &StudyLevel, settings: &StudySettings) -> Result<StudyTable, StudyError> {
        let steps = reference.problem.timeline.steps();
        self.check_times(reference)?;
        let trajectories = self.levels.par_iter().map(|level| trajectory(level, settings));
        let (trajectories, mut values): (Vec<_>, Vec<_>) =
            trajectories.collect::<Result<Vec<_>, StudyError>>()?.into_iter().unzip();

        let discrete = Arc::new(Discretization::new(&reference.problem));
        let mut scheme = scheme_of(reference, &discrete, settings)?;
        let mut state = scheme.initial().map_err(|source| StudyError::Setup { level: reference.level, source })?;
        let unit = Isotropic::lame(reference.problem.mesh.tensor_dim(), 0.0, 1.0, StressState::PlaneStress).into();
        let strain = forms::a(&reference.problem.mesh, discrete.mass.graph(), &[&unit]);
        let mut worst = vec![Worst::default(); self.levels.len()];
        let mut transfers = Vec::new();
        for level in &self.levels {
            transfers.push(
                Transfer::new(&discrete, &strain, &level.problem.mesh)
                    .map_err(|source| StudyError::Transfer { level: level.level, source })?,
            );
        }
        if let Some(kept) =
            settings.load_reference.and_then(|load| load()).filter(|kept| kept.worst.len() == self.levels.len())
        {
            (state, worst) = (kept.state, kept.worst);
        }
        let keep = |state: &State, worst: &[Worst]| {
            if let Some(keep) = settings.keep_reference {
                keep(&ReferenceProgress { state: state.clone(), worst: worst.to_vec() });
            }
        };
        let mut kept = Instant::now();
        for n in state.step + 1..=steps {
            if let Err(interrupted) = check(settings) {
                keep(&state, &worst);
                return Err(interrupted);
            }
            if kept.elapsed() >= KEEP {
                keep(&state, &worst);
                kept = Instant::now();
            }
            let step = scheme.step(&state).map_err(|source| StudyError::Step { level: reference.level, source })?;
            state = step.0;
            if n == steps {
                values.push(reference.values(&discrete, &state, &step.1));
            }
            if let Some(progress) = settings.progress {
                progress(reference.level, n, steps);
            }
            worst.par_iter_mut().enumerate().for_each(|(i, worst)| {
                let own = self.levels[i].problem.timeline.steps();
                if (n * own).is_multiple_of(steps) {
                    worst.take(state.t, transfers[i].errors(&trajectories[i][n * own / steps - 1], &state));
                }
            });
        }
        let nested = transfers.iter().all(Transfer::is_nested);
        let rows = self.levels.iter().zip(&worst).map(|(level, worst)| worst.row(level)).collect();
        Ok(self.table(rows, nested, values))
    }

    fn table(&self, mut rows: Vec<ErrorRow>, nested: bool, values: Vec<Vec<FinalValue>>) -> StudyTable {
        let size = |row: &ErrorRow| if self.vary == Vary::Time { row.k } else { row.h };
        for i in 1..rows.len() {
            let (a, b) = (&rows[i - 1], &rows[i]);
            let order = (a.error / b.error).ln() / (size(a) / size(b)).ln();
            // Zero errors have no order.
            rows[i].order = order.is_finite().then_some(order);
        }
        let fit =
            |value: fn(&ErrorRow) -> f64| slope(&rows.iter().map(|row| (size(row), value(row))).collect::<Vec<_>>());
        let slopes = vec![
            ("error_w", fit(|r| r.error_w)),
            ("error_u", fit(|r| r.error_u)),
            ("error_theta", fit(|r| r.error_theta)),
            ("error_u_h", fit(|r| r.error_u_h)),
            ("error", fit(|r| r.error)),
        ];
        let slopes = slopes.into_iter().map(|(name, slope)| (name.to_owned(), slope)).collect();
        StudyTable { vary: self.vary, rows, slopes, nested, values: self.values(values) }
    }

    /// The numbers of all levels, the last one of which may be the reference.
    fn values(&self, values: Vec<Vec<FinalValue>>) -> Vec<ValueRow> {
        let reference = if let Reference::Level(level) = &self.reference { Some(&**level) } else { None };
        let levels = self.levels.iter().chain(reference).zip(values).map(|(level, values)| {
            let (h, k) = (level.problem.mesh.spacing(), level.problem.timeline.longest());
            OfLevel { level: level.level, h, k, values }
        });
        let is_of_time = self.vary == Vary::Time;
        values::rows(&levels.collect::<Vec<_>>(), |level| if is_of_time { level.k } else { level.h })
    }
}

/// The states of a level after each step, loaded or computed, and the numbers of its last step.
fn trajectory(level: &StudyLevel, settings: &StudySettings) -> Result<(Vec<State>, Vec<FinalValue>), StudyError> {
    if let Some(states) =
        settings.load.and_then(|load| load(level)).filter(|s| s.len() == level.problem.timeline.steps())
    {
        let values = last_again(level, &states, settings)?;
        return Ok((states, values));
    }
    let mut states = Vec::new();
    let values = walk(level, settings, |state| {
        states.push(state.clone());
        Ok(())
    })?;
    if let Some(keep) = settings.keep {
        keep(level, &states);
    }
    Ok((states, values))
}

/// The numbers of the last step of a level that was loaded: the step is made again, for its report.
fn last_again(level: &StudyLevel, states: &[State], settings: &StudySettings) -> Result<Vec<FinalValue>, StudyError> {
    if level.measured.is_none() {
        return Ok(Vec::new());
    }
    let discretization = Arc::new(Discretization::new(&level.problem));
    let mut scheme = scheme_of(level, &discretization, settings)?;
    let before = match states {
        [.., before, _] => before.clone(),
        _ => scheme.initial().map_err(|source| StudyError::Setup { level: level.level, source })?,
    };
    let step = scheme.step(&before).map_err(|source| StudyError::Step { level: level.level, source })?;
    Ok(level.values(&discretization, &step.0, &step.1))
}

impl StudyTable {
    /// The table as `convergence.csv`.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut out = String::from("level,h,k,error_w,error_u,error_theta,error,order\n");
        for row in &self.rows {
            let order = row.order.map_or(String::new(), |o| format!("{o:.6}"));
            let numbers = [row.h, row.k, row.error_w, row.error_u, row.error_theta, row.error]
                .map(|v| format!("{v:e}"))
                .join(",");
            out.push_str(&format!("{},{numbers},{order}\n", row.level));
        }
        out
    }
}

/// Interval at which the progress of the reference is kept.
const KEEP: Duration = Duration::from_mins(1);

/// The largest errors of a level over time.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Worst {
    errors: Errors,
    sum: f64,
    time: f64,
}

impl Worst {
    fn take(&mut self, t: f64, errors: Errors) {
        self.errors = self.errors.max(&errors);
        if errors.sum() > self.sum {
            (self.sum, self.time) = (errors.sum(), t);
        }
    }

    fn row(&self, level: &StudyLevel) -> ErrorRow {
        let Errors { w, u, theta, u_h } = self.errors;
        let mesh = &level.problem.mesh;
        let h = mesh.spacing();
        ErrorRow {
            level: level.level,
            h,
            k: level.problem.timeline.longest(),
            error_w: w,
            error_u: u,
            error_theta: theta,
            error_u_h: u_h,
            error: self.sum,
            time_of_error: self.time,
            order: None,
        }
    }
}

/// Least-squares slope of log(y) over log(x).
#[must_use]
pub fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let (mx, my) = (logs.iter().map(|p| p.0).sum::<f64>() / n, logs.iter().map(|p| p.1).sum::<f64>() / n);
    let covariance: f64 = logs.iter().map(|(x, y)| (x - mx) * (y - my)).sum();
    covariance / logs.iter().map(|(x, _)| (x - mx).powi(2)).sum::<f64>()
}

fn check(settings: &StudySettings) -> Result<(), StudyError> {
    match settings.interrupt {
        Some(flag) if flag.load(Ordering::Relaxed) => Err(StudyError::Interrupted),
        _ => Ok(()),
    }
}

fn scheme_of(
    level: &StudyLevel,
    discrete: &Arc<Discretization>,
    settings: &StudySettings,
) -> Result<Box<dyn Scheme>, StudyError> {
    (settings.scheme)(&level.problem, discrete, &level.problem.backend)
        .map_err(|source| StudyError::Setup { level: level.level, source })
}

/// Makes all steps of a level and passes on each state. Returns the numbers of the last step.
fn walk(
    level: &StudyLevel,
    settings: &StudySettings,
    mut visit: impl FnMut(&State) -> Result<(), StudyError>,
) -> Result<Vec<FinalValue>, StudyError> {
    let discretization = Arc::new(Discretization::new(&level.problem));
    let mut scheme = scheme_of(level, &discretization, settings)?;
    let mut state = scheme.initial().map_err(|source| StudyError::Setup { level: level.level, source })?;
    let mut values = Vec::new();
    while !state.is_last(&level.problem.timeline) {
        check(settings)?;
        let step = scheme.step(&state).map_err(|source| StudyError::Step { level: level.level, source })?;
        state = step.0;
        if state.is_last(&level.problem.timeline) {
            values = level.values(&discretization, &state, &step.1);
        }
        if let Some(progress) = settings.progress {
            let steps = level.problem.timeline.steps();
            progress(level.level, state.step.min(steps), steps);
        }
        visit(&state)?;
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slope_of_a_power_is_its_exponent() {
        let points: Vec<(f64, f64)> = [1.0, 0.5, 0.25, 0.1].iter().map(|h: &f64| (*h, 3.0 * h.powf(1.5))).collect();
        assert!((slope(&points) - 1.5).abs() < 1e-14);
    }
}
