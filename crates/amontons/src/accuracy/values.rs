//! Until the bars of numbers at the end of the run are small enough.
//!
//! A level is five runs: on a mesh with the steps, halved and quartered, and on the mesh with halved cells with the
//! steps and halved. The last one is the result. Its change by halving the cells is at least the error of its mesh if
//! halving takes half of the error or more, its change by halving the steps at least the error of its steps: 5/4 of
//! both together are the bar. It is an index of grid convergence with order one (P. J. Roache, J. Fluids Eng. 116
//! (1994) 405–413), and an estimate, not a bound.
//!
//! Halving may hit the same number by chance. So the first level is never the last, and half of the change from level
//! to level counts as one by halving.
//!
//! Steps are halved until their part is at most a quarter of the bar that is asked for, first on the mesh with whole
//! cells, where it is cheap, and where two halvings have to agree. Then the cells are marked that cause the rest.

use super::bars::{BarRow, bars, raise};
use super::goals::Goal;
use super::{AccuracyEnding, AccuracyError, AccuracyRequest, AccurateCase, marks, no_mesh, rounds_of, stands};
use crate::adjoint::GradientError;
use crate::case::{Case, divided_steps};
use crate::convergence::FinalValue;
use crate::mesh::{MarkedCells, RefinementRounds};
use crate::output::{JumpsOfRun, Sink, ValuesOfRun};
use crate::run::{self, RunError};

/// Part of a bar that the steps may have.
const OF_STEPS: f64 = 0.25;

/// A number at the end of the run with its bar.
#[derive(Clone, Debug, PartialEq)]
pub struct GoalBar {
    /// The number with its bar.
    pub row: BarRow,
    /// The bar over the number, or over the largest component of its probe.
    pub relative: f64,
}

/// What a run for an accuracy has found so far.
#[derive(Clone, Copy, Debug)]
pub enum AccuracyNews<'a> {
    /// On a mesh with whole cells: the number of steps, and the largest change of a number by halving those before,
    /// relative to it. Steps are halved once more.
    Steps(usize, f64),
    /// A level.
    Level(&'a ValueLevel),
}

/// A level: a mesh with its steps.
#[derive(Clone, Debug, PartialEq)]
pub struct ValueLevel {
    /// Number of cells of the mesh with halved cells.
    pub cells: usize,
    /// Number of its nodes.
    pub nodes: usize,
    /// Number of steps; of chosen ones those that were made.
    pub steps: usize,
    /// The numbers asked for.
    pub goals: Vec<GoalBar>,
    /// The bars of all numbers at all instants that the three runs have.
    pub bars: Vec<BarRow>,
    /// Why the cells of the next mesh are those with the largest jumps, without derivatives as weights; empty if the
    /// derivatives are there.
    pub unweighted: Option<String>,
}

impl ValueLevel {
    /// The largest bar of a number asked for, relative to it.
    fn worst(&self) -> f64 {
        self.goals.iter().map(|goal| goal.relative).fold(0.0, worse)
    }
}

/// Refines cells and steps until the bars of the numbers `asked`, names of probes or of columns of `history.csv` and
/// `probes.csv`, are small enough. What is found is told.
///
/// # Errors
/// The case cannot be read, one of its first runs fails, or a number is not known.
pub fn of_values(
    request: &AccuracyRequest,
    asked: &[String],
    tell: &mut dyn FnMut(AccuracyNews),
) -> Result<AccurateCase<ValueLevel>, AccuracyError> {
    request.check()?;
    let start = request.refined(&RefinementRounds::default(), &[])?;
    let mut refining = Refining { request, asked, rounds: rounds_of(&start), start, parts: 1, before: None };
    let (mut levels, mut last): (Vec<ValueLevel>, Option<Case>) = (Vec::new(), None);
    loop {
        let made = match refining.level(tell) {
            Ok(made) => made,
            Err(error) => match last {
                Some(case) => return error.ending().map(|ending| AccurateCase { case, levels, ending }),
                None => return Err(error),
            },
        };
        tell(AccuracyNews::Level(&made.level));
        let worst = made.level.worst();
        levels.push(made.level);
        let corner = "its bar does not fall with finer cells and steps: the number may have no limit, as a maximum at a \
                      corner";
        let ending = if worst <= request.relative && (levels.len() > 1 || made.next.is_none()) {
            Some(AccuracyEnding::Reached)
        } else if let Some(why) = made.stands {
            Some(AccuracyEnding::Stands(why))
        } else if stands(levels.iter().map(ValueLevel::worst)) {
            Some(AccuracyEnding::Stands(corner.to_owned()))
        } else {
            None
        };
        if let Some(ending) = ending {
            return Ok(AccurateCase { case: made.case, levels, ending });
        }
        refining.rounds.marked.extend(made.next);
        last = Some(made.case);
    }
}

/// The mesh and the steps as they are.
struct Refining<'a> {
    request: &'a AccuracyRequest<'a>,
    asked: &'a [String],
    start: Case,
    rounds: RefinementRounds,
    /// The parts of each step of the case.
    parts: usize,
    /// The bars of the level before.
    before: Option<Vec<BarRow>>,
}

/// A level that was made.
struct MadeLevel {
    level: ValueLevel,
    case: Case,
    /// The cells to refine next, if the mesh is too coarse.
    next: Option<MarkedCells>,
    /// Why halving steps is no use, if it is none.
    stands: Option<String>,
}

/// A run of a case.
struct LevelRun {
    case: Case,
    steps: Vec<(f64, Vec<FinalValue>)>,
    jumps: JumpsOfRun,
}

impl LevelRun {
    fn end(&self) -> &[FinalValue] {
        self.steps.last().map_or(&[], |(_, values)| values)
    }

    /// The largest bar of a number at the end by its change since a run with longer steps, relative to it.
    fn change(&self, before: &LevelRun, goals: &[Goal]) -> f64 {
        let last = |run: &LevelRun| run.steps.last().cloned().into_iter().collect::<Vec<_>>();
        let (made, before) = (last(self), last(before));
        let rows = bars(&made, &made, &before);
        let bar = |goal: &Goal| goal.row(&rows).map(|row| relative(row.steps, goal.scale(self.end())));
        goals.iter().filter_map(bar).fold(0.0, worse)
    }
}

impl Refining<'_> {
    fn run(&self, rounds: &RefinementRounds, parts: usize) -> Result<LevelRun, AccuracyError> {
        let mut more = if parts > 1 { divided_steps(&self.start, parts) } else { Vec::new() };
        if self.start.accuracy.is_some() {
            more.push("accuracy.refined=true".to_owned());
        }
        let case = self.request.refined(rounds, &more)?;
        let (mut values, mut jumps) = (ValuesOfRun::new(case.probes.clone()), JumpsOfRun::default());
        let mut sinks: Vec<&mut dyn Sink> = vec![&mut values];
        // Marks are of the mesh with whole cells.
        if rounds.marked.len() == self.rounds.marked.len() {
            sinks.push(&mut jumps);
        }
        run::run(&case.problem, &self.request.settings(), &mut sinks)?;
        Ok(LevelRun { case, steps: values.steps, jumps })
    }

    /// The runs with whole cells: with whole steps and with halved ones. Steps are divided until their part of the bars
    /// is small enough, or does not fall any more: then the reason is told. Two halvings have to change little, as one
    /// may hit the same number by chance: where a point slips, few steps may all see one path.
    fn steps(
        &mut self,
        tell: &mut dyn FnMut(AccuracyNews),
    ) -> Result<(Vec<Goal>, [LevelRun; 2], Option<String>), AccuracyError> {
        let (mut whole, mut halved) = (self.run(&self.rounds, self.parts)?, self.run(&self.rounds, 2 * self.parts)?);
        let goals = Goal::named(self.asked, &self.start, whole.end())?;
        let mut changes = Vec::new();
        loop {
            let quartered = self.run(&self.rounds, 4 * self.parts)?;
            let worst = halved.change(&whole, &goals);
            changes.push(worst);
            let why = if worst.is_nan() {
                "it has no value at the end of the run, as the centre of a contact that has parted"
            } else {
                "its bar does not fall with shorter steps: it may depend on the instant at which a point sticks, slips \
                 or meets the other side"
            };
            let stands = (worst.is_nan() || stands(changes.iter().copied())).then(|| why.to_owned());
            let is_small = |change: f64| change <= OF_STEPS * self.request.relative;
            if is_small(worst) && is_small(quartered.change(&halved, &goals)) || stands.is_some() {
                return Ok((goals, [whole, halved], stands));
            }
            tell(AccuracyNews::Steps(halved.steps.len(), worst));
            self.parts *= 2;
            (whole, halved) = (halved, quartered);
        }
    }

    fn level(&mut self, tell: &mut dyn FnMut(AccuracyNews)) -> Result<MadeLevel, AccuracyError> {
        let (goals, [whole, halved], stands) = self.steps(tell)?;
        let mut rounds = self.rounds.clone();
        rounds.marked.push(MarkedCells::All);
        let of_steps = self.run(&rounds, self.parts)?;
        let fine = self.run(&rounds, 2 * self.parts)?;
        let mut bars = bars(&fine.steps, &halved.steps, &of_steps.steps);
        let is_first = self.before.is_none();
        raise(&mut bars, &self.before.take().unwrap_or_default());
        self.before = Some(bars.clone());
        let of_goal = |goal: &Goal| {
            let row = goal.row(&bars)?.clone();
            Some(GoalBar { relative: relative(row.bar(), goal.scale(fine.end())), row })
        };
        let found: Vec<GoalBar> = goals.iter().filter_map(of_goal).collect();
        let mesh = &fine.case.problem.mesh;
        let mut level = ValueLevel {
            cells: mesh.cell_count(),
            nodes: mesh.points.len(),
            steps: fine.steps.len(),
            goals: found,
            bars,
            unweighted: None,
        };
        let mut next = None;
        let asked = self.request.relative;
        // A first level may hit the same number twice by chance: a second one shows it.
        if is_first && level.worst() > 0.0 || level.worst() > asked {
            let shares = |part: fn(&BarRow) -> f64| {
                let of_goal = |goal: &GoalBar| relative(part(&goal.row), goal.row.bar()) * goal.relative;
                level.goals.iter().map(of_goal).fold(0.0, worse)
            };
            let of_steps = shares(|row| row.steps);
            if is_first || shares(|row| row.mesh) > (1.0 - OF_STEPS) * asked {
                let most = goals.iter().map(|goal| (goal, asked * goal.scale(fine.end())));
                let most: Vec<(&Goal, f64)> = most.filter(|(_, most)| *most > 0.0).collect();
                let (cells, unweighted) = self.marked(&whole, &most)?;
                (next, level.unweighted) = (Some(cells), unweighted);
            }
            self.parts *= if of_steps > OF_STEPS * asked { 2 } else { 1 };
        }
        Ok(MadeLevel { level, case: fine.case, next, stands })
    }

    /// The cells to refine, and why derivatives do not weight them if they do not. The sides of a sector have to keep
    /// the same mesh: it is refined as a whole. So is a mesh without jumps, as that of bodies under uniform stress,
    /// whose sides alone make an error.
    fn marked(&self, whole: &LevelRun, goals: &[(&Goal, f64)]) -> Result<(MarkedCells, Option<String>), AccuracyError> {
        if !whole.case.problem.cyclic.is_empty() {
            return Ok((MarkedCells::All, None));
        }
        let (cells, unweighted) = marks::marked(&whole.case, &whole.jumps, goals, self.request).map_err(interrupted)?;
        Ok((if cells.is_empty() { MarkedCells::All } else { MarkedCells::These(cells) }, unweighted))
    }
}

/// The larger of two errors; none is worse.
fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

/// A bar over a size; nothing is accurate beside nothing.
fn relative(bar: f64, scale: f64) -> f64 {
    if bar > 0.0 || bar.is_nan() { bar / scale } else { 0.0 }
}

/// Derivatives that were interrupted, as a run that was.
fn interrupted(_: GradientError) -> AccuracyError {
    AccuracyError::Run(RunError::Unstarted { resumes: false })
}

impl AccuracyError {
    /// Why a finer mesh cannot be had, or the error if it is another one.
    fn ending(self) -> Result<AccuracyEnding, AccuracyError> {
        match self {
            AccuracyError::Case(error) => no_mesh(error),
            AccuracyError::Run(error @ (RunError::Step { .. } | RunError::Setup(_) | RunError::Unsound(_))) => {
                Ok(AccuracyEnding::NoMesh(error.to_string()))
            }
            error => Err(error),
        }
    }
}
