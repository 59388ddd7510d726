//! A run step by step: for loops of one's own and for coupling with other programs.

use std::sync::Arc;

use rayon::ThreadPool;

use super::{Clock, RunError, Settings, Timed, beginning, pool, scheme, seen, step_advice, within};
use crate::discretization::Discretization;
use crate::equation::{Along, SetupError, StepError, StepInputs, named};
use crate::linalg::Backend;
use crate::machine::Instant;
use crate::output::{Checkpoint, CheckpointError, Snapshot, Work};
use crate::problem::{Fault, Problem};
use crate::state::{State, StepReport};
use crate::step::{Kept, Scheme};

/// A run whose steps are made one by one. Between them loads and prescribed values can be set, and states saved and
/// restored.
///
/// Without inputs its states have the same bits as those of [`run`](super::run()). Inputs hold until they are changed;
/// no state holds them, so whoever restores a state sets them, too, if they were others. Values in place of prescribed
/// ones hold to the end of the last phase with the same conditions. The certificate is not
/// evaluated, and no sink is called: pass [`Stepping::snapshot`] to those you want.
///
/// ```
/// use amontons::{case, run::{Settings, Stepping}};
///
/// let source = case::Source::new("starter.toml", case::STARTER);
/// let case = case::parse(&source, &["mesh.n=[8, 4]".into(), "time.steps=4".into()])?;
/// let mut run = Stepping::new(&case.problem, &Settings::default())?;
/// while !run.is_done() {
///     let before = run.save();
///     run.step()?;
///     let tried = run.state().u.clone();
///     run.restore(&before)?;
///     run.step()?;
///     assert_eq!(run.state().u, tried);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Stepping {
    problem: Problem,
    scheme: Box<dyn Scheme>,
    pool: Option<ThreadPool>,
    clock: Clock,
    /// Work of the sessions before.
    before: Work,
    inputs: Arc<StepInputs>,
    state: State,
    report: Option<StepReport>,
    /// What the scheme has to go back to before it goes on, if a failed step was interrupted on the way back.
    behind: Option<Kept>,
}

/// Reason why a run that is made step by step did not go on. Its state is unchanged.
#[derive(Debug, thiserror::Error)]
pub enum SteppingError {
    /// The step was not solved.
    #[error("{source}")]
    Step {
        /// The cause.
        source: StepError,
    },
    /// The run is at its end.
    #[error("step {}: found a run at its end after {steps} steps, expected a step before it; give time.end and time.steps larger numbers", .steps + 1)]
    AtEnd {
        /// Number of steps.
        steps: usize,
    },
    /// An input does not fit the problem.
    #[error("{0}")]
    Input(Fault),
    /// The scheme takes no inputs.
    #[error("{on}: found a time-stepping scheme without inputs, expected one with Scheme::take_inputs, as March")]
    Scheme {
        /// The input.
        on: &'static str,
    },
    /// The state does not belong to the problem.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// A matrix could not be factorized.
    #[error(transparent)]
    Setup(#[from] SetupError),
}

impl SteppingError {
    /// An instruction for a failed step; `None` for other errors.
    #[must_use]
    pub fn advice(&self) -> Option<String> {
        match self {
            SteppingError::Step { source } => Some(step_advice(source)),
            _ => None,
        }
    }
}

impl Stepping {
    /// Assembles and factorizes, and starts at t = 0. The settings for the certificate are ignored.
    ///
    /// # Errors
    /// Fails if the problem cannot be set up: see [`RunError`].
    pub fn new(problem: &Problem, settings: &Settings) -> Result<Stepping, RunError> {
        Stepping::start(problem, None, settings)
    }

    /// Goes on from a saved state, which may come from another session. The next step has the bits of a run without a
    /// break.
    ///
    /// # Errors
    /// Fails if the state belongs to another problem, or the problem cannot be set up: see [`RunError`].
    pub fn resume(problem: &Problem, from: Checkpoint, settings: &Settings) -> Result<Stepping, RunError> {
        Stepping::start(problem, Some(from), settings)
    }

    fn start(problem: &Problem, from: Option<Checkpoint>, settings: &Settings) -> Result<Stepping, RunError> {
        let begin = Instant::now();
        let solvers = from.as_ref().map_or(&[][..], |checkpoint| &checkpoint.kept.solvers);
        let problem = problem.interruptible(settings.interrupt.as_ref()).decided(solvers);
        let pool = pool(settings.threads)?;
        let resumed = from.is_some();
        let backend = Arc::new(Timed::new(&problem.backend, settings.watch.clone()));
        let solver: Arc<dyn Backend> = Arc::<Timed>::clone(&backend);
        let mut scheme = within(pool.as_ref(), || {
            let discrete = Arc::new(Discretization::new(&problem));
            scheme(&problem, &discrete, &solver, settings)
        })?;
        let Checkpoint { state, report, work: before, kept, .. } = beginning(from, &problem, &*scheme)?;
        within(pool.as_ref(), || scheme.recall(&kept))?;
        let again = if resumed { scheme.solvers().factorizations } else { [0; 2] };
        let mut clock = Clock { begin, seconds: before.seconds, before: before.seconds.total, again };
        clock.seconds.factor += backend.seconds();
        clock.seconds.setup += begin.elapsed().as_secs_f64() - backend.seconds();
        Ok(Stepping { problem, scheme, pool, clock, before, inputs: Arc::default(), state, report, behind: None })
    }

    /// Makes the next step and returns its state. If it fails, the state stays as it is, and a later attempt has the
    /// bits of a first one: change an input and try again.
    ///
    /// # Errors
    /// [`SteppingError::Step`] if the step is not solved or is interrupted, [`SteppingError::AtEnd`] after the last
    /// step.
    pub fn step(&mut self) -> Result<&State, SteppingError> {
        if self.is_done() {
            return Err(SteppingError::AtEnd { steps: self.state.step });
        }
        if let Some(kept) = self.behind.clone() {
            self.go_back(&kept)?;
        }
        let set = self.leave_conditions();
        let Stepping { scheme, pool, state, .. } = self;
        let (kept, begin) = (scheme.kept(), Instant::now());
        let made = within(pool.as_ref(), || scheme.step(state));
        self.clock.seconds.steps += begin.elapsed().as_secs_f64();
        match made {
            Ok((next, report)) => (self.state, self.report) = (next, Some(report)),
            Err(source) => {
                // An interruption may end this, too; the next step then begins with it.
                self.behind = self.go_back(&kept).is_err().then_some(kept);
                if let Some(set) = set {
                    self.scheme.take_inputs(&set);
                    self.inputs = set;
                }
                return Err(SteppingError::Step { source });
            }
        }
        Ok(&self.state)
    }

    /// Drops the inputs that replace prescribed values before a phase with other conditions, and returns those before.
    fn leave_conditions(&mut self) -> Option<Arc<StepInputs>> {
        let timeline = &self.problem.timeline;
        let State { step, pace, .. } = &self.state;
        let phases = [timeline.made(*step, pace), timeline.next(*step, pace, pace.level)].map(|now| now.phase);
        if self.state.step == 0 || self.problem.has_same_conditions(phases) {
            return None;
        }
        let left = Arc::new(self.inputs.without_prescribed());
        self.scheme.take_inputs(&left).then(|| std::mem::replace(&mut self.inputs, left))
    }

    /// True after the last step.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.state.is_last(&self.problem.timeline)
    }

    /// The state: u, w, θ and what Γ_C remembers, at t_n.
    #[must_use]
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The report of the step that led to the state: contact points, reactions, iterations. `None` at t = 0.
    #[must_use]
    pub fn report(&self) -> Option<&StepReport> {
        self.report.as_ref()
    }

    /// Forces that the support exerts at the nodes of a side, N, per unit of thickness in two dimensions: one vector
    /// per node, nodes ascending. Zero where nothing is prescribed, and NaN at t = 0.
    ///
    /// A node of two sides has the force of both, and a node that follows another one has none: it acts at the other.
    ///
    /// # Errors
    /// [`SteppingError::Input`] if the mesh does not have the side.
    pub fn reactions(&self, on: &str) -> Result<Vec<f64>, SteppingError> {
        let discrete = self.scheme.discretization();
        let all = self.report.as_ref().map(|report| discrete.v.nodal(&report.reactions.force));
        self.at_nodes("reactions", on, all.as_deref(), self.problem.mesh.dim)
    }

    /// Heat that prescribed temperatures supply at the nodes of a side, W, per unit of thickness in two dimensions, as
    /// [`Stepping::reactions`].
    ///
    /// # Errors
    /// [`SteppingError::Input`] if the mesh does not have the side.
    pub fn heat_reactions(&self, on: &str) -> Result<Vec<f64>, SteppingError> {
        let discrete = self.scheme.discretization();
        let all = self.report.as_ref().map(|report| discrete.q.nodal(&report.reactions.heat));
        self.at_nodes("heat_reactions", on, all.as_deref(), 1)
    }

    /// The values at the nodes of a side; NaN if there are none yet.
    fn at_nodes(&self, key: &str, on: &str, all: Option<&[f64]>, components: usize) -> Result<Vec<f64>, SteppingError> {
        let set = named(&self.problem.mesh, key, on).map_err(SteppingError::Input)?;
        let dofs = set.node_list().into_iter().flat_map(|node| {
            let first = node as usize * components;
            first..first + components
        });
        let value = |dof: usize| all.map_or(Some(f64::NAN), |all| all.get(dof).copied()).unwrap_or_default();
        Ok(dofs.map(value).collect())
    }

    /// The problem.
    #[must_use]
    pub fn problem(&self) -> &Problem {
        &self.problem
    }

    /// The run at its state, for probes, tables and sinks.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot<'_> {
        seen(&self.problem, &*self.scheme, &self.state, self.report.as_ref(), self.work())
    }

    fn work(&self) -> Work {
        self.clock.work(self.before, &*self.scheme)
    }

    /// The state with all that the next steps depend on, inputs excepted. [`Checkpoint::write`] keeps it in a file.
    #[must_use]
    pub fn save(&self) -> Checkpoint {
        Checkpoint {
            state: self.state.clone(),
            report: self.report.clone(),
            work: self.work(),
            kept: self.behind.clone().unwrap_or_else(|| self.scheme.kept()),
            k: self.state.made(&self.problem.timeline).k,
            fallback: None,
        }
    }

    /// Goes back, or on, to a saved state of this run. The inputs stay as they are. Steps from there have the bits that
    /// they had with the same inputs.
    ///
    /// # Errors
    /// If the state belongs to another problem, or a matrix cannot be factorized.
    pub fn restore(&mut self, saved: &Checkpoint) -> Result<(), SteppingError> {
        saved.check(self.scheme.discretization(), &self.problem)?;
        self.go_back(&saved.kept)?;
        (self.state, self.report) = (saved.state.clone(), saved.report.clone());
        Ok(())
    }

    fn go_back(&mut self, kept: &Kept) -> Result<(), SetupError> {
        let Stepping { scheme, pool, .. } = self;
        within(pool.as_ref(), || scheme.go_back(kept))?;
        self.behind = None;
        Ok(())
    }

    /// The inputs that are set.
    #[must_use]
    pub fn inputs(&self) -> &StepInputs {
        &self.inputs
    }

    /// Sets all inputs at once, to those of [`Stepping::inputs`] at another time; `StepInputs::default()` removes all.
    ///
    /// # Errors
    /// [`SteppingError::Scheme`] if the scheme takes no inputs.
    pub fn set_inputs(&mut self, inputs: &StepInputs) -> Result<(), SteppingError> {
        self.change("inputs", |now, _, _| {
            now.clone_from(inputs);
            Ok(())
        })
    }

    /// Changes the inputs and passes them to the scheme.
    fn change(
        &mut self,
        on: &'static str,
        change: impl FnOnce(&mut StepInputs, &Problem, &Discretization) -> Result<(), Fault>,
    ) -> Result<(), SteppingError> {
        let mut inputs = StepInputs::clone(&self.inputs);
        let problem = self.scheme.problem().unwrap_or(&self.problem);
        change(&mut inputs, problem, self.scheme.discretization()).map_err(SteppingError::Input)?;
        let inputs = Arc::new(inputs);
        if !self.scheme.take_inputs(&inputs) {
            return Err(SteppingError::Scheme { on });
        }
        self.inputs = inputs;
        Ok(())
    }

    /// Sets the force on a side, an edge or points, N, per unit of thickness in two dimensions. It adds to the loads of
    /// the problem and replaces the force set there before.
    ///
    /// `values` holds one number per component, which is spread evenly as the `force` of a case is, or one vector per
    /// node, nodes ascending. A force along a prescribed displacement is borne by the support.
    ///
    /// # Errors
    /// [`SteppingError::Input`] if the mesh does not have the side, the number of values is another, a value is not
    /// finite, or the problem has no mechanics.
    pub fn set_force(&mut self, on: &str, values: &[f64]) -> Result<(), SteppingError> {
        self.change("force", |inputs, problem, _| inputs.set_force(problem, on, values))
    }

    /// Sets forces at all nodes, one vector per node, N. They add to those on sides and replace those set in this way
    /// before.
    ///
    /// # Errors
    /// Those of [`Stepping::set_force`], except for the side.
    pub fn set_forces(&mut self, values: &[f64]) -> Result<(), SteppingError> {
        self.change("forces", |inputs, problem, _| inputs.set_forces(problem, values))
    }

    /// Sets the heat supplied on a side, an edge or points, W, per unit of thickness in two dimensions: one number,
    /// which is spread evenly, or one per node, nodes ascending. It adds to the loads of the problem and replaces the
    /// heat set there before.
    ///
    /// # Errors
    /// [`SteppingError::Input`] if the mesh does not have the side, the number of values is another, a value is not
    /// finite, or the problem has no heat equation.
    pub fn set_heat(&mut self, on: &str, values: &[f64]) -> Result<(), SteppingError> {
        self.change("heat", |inputs, problem, _| inputs.set_heat(problem, on, values))
    }

    /// Sets the heat supplied at all nodes, one number per node, W. It adds to that on sides and replaces the one set
    /// in this way before.
    ///
    /// # Errors
    /// Those of [`Stepping::set_heat`], except for the side.
    pub fn set_heats(&mut self, values: &[f64]) -> Result<(), SteppingError> {
        self.change("heat", |inputs, problem, _| inputs.set_heats(problem, values))
    }

    /// Sets a component of the displacement that the problem prescribes on a side, m, in place of the value of the
    /// problem: one number, or one per node, nodes ascending. It is reached at the end of the next step.
    ///
    /// At a node of two sides the side counts that comes first in the problem.
    ///
    /// # Errors
    /// [`SteppingError::Input`] if the mesh does not have the side, the problem does not prescribe the component there,
    /// the number of values is another, or a value is not finite.
    pub fn set_displacement(&mut self, on: &str, along: Along, values: &[f64]) -> Result<(), SteppingError> {
        let set = |inputs: &mut StepInputs, problem: &Problem, discrete: &Discretization| {
            inputs.set_displacement(problem, discrete, on, along, values)
        };
        self.change("displacement", set)
    }

    /// Sets the temperature that the problem prescribes on a side, K, in place of the value of the problem: one number,
    /// or one per node, nodes ascending. It is reached at the end of the next step.
    ///
    /// # Errors
    /// Those of [`Stepping::set_displacement`].
    pub fn set_temperature(&mut self, on: &str, values: &[f64]) -> Result<(), SteppingError> {
        let set = |inputs: &mut StepInputs, problem: &Problem, discrete: &Discretization| {
            inputs.set_temperature(problem, discrete, on, values)
        };
        self.change("temperature", set)
    }

    /// Sets the temperature of the foundation of a contact, K, by the name of the contact in results.
    ///
    /// # Errors
    /// [`SteppingError::Input`] if no contact has the name, its foundation has no prescribed temperature, or the value
    /// is not finite.
    pub fn set_foundation_temperature(&mut self, contact: &str, value: f64) -> Result<(), SteppingError> {
        self.change("foundation_temperature", |inputs, problem, _| {
            inputs.set_foundation_temperature(problem, contact, value)
        })
    }
}
