//! The steps of Problem 4.1, one after the other, by the rule of the scheme.

use std::borrow::Cow;
use std::sync::{Arc, OnceLock};

use super::change::{met, misfits, released, supported};
use super::initial::{self, extremes, first_temperature};
use super::{Kept, Scheme, alone, datum, steady};
use crate::account::audit;
use crate::discretization::Discretization;
use crate::equation::acting::{boundary_at, contacts_at};
use crate::equation::bodies::{Apart, Bodies};
use crate::equation::mechanics::Mechanics;
use crate::equation::predictor;
use crate::equation::system::{Bar, Mixed, Products, Step};
use crate::equation::systems::{Cache, SystemError, Systems};
use crate::equation::{SetupError, Solvers, StepError, StepInputs, tried};
use crate::inclusion::PointState;
use crate::linalg::{Backend, BlockMatrix};
use crate::problem::{Problem, StartState};
use crate::pulse::Pulse;
use crate::state::{Carried, Earlier, State, StepReport};
use crate::time::{Analysis, HALVINGS, Instant, Rule, Start};

/// Residual of the iteration on Γ_C below which its failure may be due to round-off of the velocities.
const NOISE: f64 = 1e-2;
/// Steps from one in which a rigid foundation is hit to the first one whose start and end both have velocities of after
/// it: in the step of the impact bodies move by what the gap was, in the next one they come to rest on the foundation.
const SETTLING: u32 = 2;

/// The scheme of a run for (4.1) and (4.2), coupled as [`coupling`](crate::problem::ProblemData::coupling) says.
///
/// A step whose contact iteration does not converge is made in two halves, and these again. The same holds for a step
/// in which softening laws may have several solutions between the previous state and the new one: the shorter the step,
/// the nearer the solution is to the previous branch.
#[derive(Debug)]
pub struct March {
    /// The problem and its forms with the conditions of the phase of the last step.
    pub(super) problem: Problem,
    pub(super) discrete: Arc<Discretization>,
    /// The systems of the phases that have begun and are not over, or that a later phase has, too, and those of halved
    /// steps, k/2, k/4 and so on, while steps are halved.
    cache: Cache,
    /// Products that one step computes and the next one needs, with the state they belong to.
    pub(super) products: Option<Products>,
    /// Bodies whose rigid motions are split off, made at first use, or `None` if they cannot be.
    bodies: OnceLock<Option<Bodies>>,
    /// The form of the elastic energy, in which the error of a chosen step is measured, made at first use.
    pub(super) elastic: OnceLock<BlockMatrix>,
    /// Receives the progress of each step.
    pulse: Pulse,
    /// True if a step takes as many iterations as it needs; else it is halved after a limited number.
    is_patient: bool,
    /// Loads and prescribed values set from the outside.
    inputs: Arc<StepInputs>,
}

impl March {
    /// Assembles, and factorizes for the first phase. A later phase makes its matrices when it begins, if no phase
    /// before had its step length and analysis. No other factorization is made in a run if all laws of the body are
    /// linear and no step is halved.
    ///
    /// # Errors
    /// If a system is singular or does not fit into memory.
    pub fn new(problem: &Problem) -> Result<March, SetupError> {
        March::on(problem, &Arc::new(Discretization::new(problem)), &problem.backend)
    }

    /// The scheme as the setting of a run or a study.
    ///
    /// # Errors
    /// Those of [`March::new`].
    pub fn make(
        problem: &Problem,
        discrete: &Arc<Discretization>,
        backend: &Arc<dyn Backend>,
    ) -> Result<Box<dyn Scheme>, SetupError> {
        Ok(Box::new(March::on(problem, discrete, backend)?))
    }

    /// The scheme with the forms of the problem, which do not depend on its steps, and with a backend, which may be
    /// another than that of the problem.
    ///
    /// # Errors
    /// Those of [`March::new`].
    pub fn on(
        problem: &Problem,
        discrete: &Arc<Discretization>,
        backend: &Arc<dyn Backend>,
    ) -> Result<March, SetupError> {
        let mut cache = Cache::new(backend, first_temperature(problem, discrete));
        let first = problem.timeline.instant(1);
        let made = cache.systems(problem, discrete, problem.starting_rule(first.analysis, first.k));
        made.map_err(|(part, source)| SetupError::Factor { part, source })?;
        Ok(March {
            problem: problem.clone(),
            discrete: Arc::clone(discrete),
            cache,
            products: None,
            bodies: OnceLock::new(),
            elastic: OnceLock::new(),
            pulse: Pulse::default(),
            is_patient: false,
            inputs: Arc::default(),
        })
    }

    /// Numbers stored by all factors.
    #[must_use]
    pub fn stored(&self) -> usize {
        self.cache.stored()
    }

    /// Advances a state to t, a part 2^−halvings of a step, in halves if necessary.
    pub(super) fn advance(
        &mut self,
        old: &State,
        now: &Instant,
        t: f64,
        halvings: u32,
    ) -> Result<(State, StepReport), StepError> {
        let made = self.attempt(old, now, t, halvings);
        self.refine(made, old, now, t, halvings)
    }

    /// Makes the part in halves if it was not solved, or may have other solutions: shorter parts have fewer solutions
    /// and show where the branch is in doubt. If both halves are in doubt and the shortest parts would be too, as with
    /// velocity-weakening friction on a body without inertia, halving gives no information, and the two halves stand.
    fn refine(
        &mut self,
        made: Result<(State, StepReport), StepError>,
        old: &State,
        now: &Instant,
        t: f64,
        halvings: u32,
    ) -> Result<(State, StepReport), StepError> {
        let again = match &made {
            Ok((_, report)) => report.is_ambiguous,
            Err(error) => matches!(error, StepError::NotConverged { .. }),
        };
        if !again || halvings == HALVINGS {
            return made;
        }
        let middle = old.t + 0.5 * (t - old.t);
        let first = self.attempt(old, now, middle, halvings + 1);
        if let (Ok(_), Ok((state, first))) = (&made, &first)
            && first.is_ambiguous
            && let Some((end, second)) = tried(self.attempt(state, now, t, halvings + 1))?
            && second.is_ambiguous
            && !self.shortest_is_unique(old, now, &end)?
        {
            return Ok((end, second.after(first)));
        }
        let halves = self.refine(first, old, now, middle, halvings + 1).and_then(|(state, first)| {
            let (state, second) = self.advance(&state, now, t, halvings + 1)?;
            Ok((state, second.after(&first)))
        });
        // A solved step stands if its halves are not solved. For an unsolved step the error names the first part that
        // is not solved. An interrupted step is made anew, in halves, by the resumed run.
        halves.or_else(|first| match made {
            _ if !first.is_unsolved() => Err(first),
            Err(_) if halvings == 0 => {
                self.with_patience(old, now, t).map_err(|error| if error.is_unsolved() { first } else { error })
            }
            made => made.map_err(|_| first),
        })
    }

    /// Makes a step whose halves are not solved either, with as many iterations as it needs.
    fn with_patience(&mut self, old: &State, now: &Instant, t: f64) -> Result<(State, StepReport), StepError> {
        self.is_patient = true;
        let made = self.attempt(old, now, t, 0);
        self.is_patient = false;
        made
    }

    /// The rule of a part 2^−halvings of a step, made from a state. A part of a step that was not solved as a whole has
    /// no step of its length before it.
    fn rule(&self, old: &State, now: &Instant, halvings: u32) -> Rule {
        let k = now.k / f64::from(1u32 << halvings);
        let follows = old.earlier.as_ref().is_some_and(|earlier| earlier.k.to_bits() == k.to_bits());
        if follows { self.problem.rule(now.analysis, k) } else { self.problem.starting_rule(now.analysis, k) }
    }

    /// Factorizes for a step, made from a state, and for its parts of ½ … 2^−halvings.
    ///
    /// # Errors
    /// Those of [`Cache::systems`].
    fn halve(&mut self, old: &State, now: &Instant, halvings: u32) -> Result<(), SystemError> {
        for rule in (0..=halvings).map(|halvings| self.rule(old, now, halvings)).collect::<Vec<_>>() {
            self.cache.systems(&self.problem, &self.discrete, rule)?;
        }
        Ok(())
    }

    /// Drops the systems that neither the step made last from a state nor a later step of its phase or of later ones
    /// needs, among them those of halved steps.
    fn drop_others(&mut self, old: &State, now: &Instant) {
        let ends = self.problem.timeline.needed_after(now);
        let mut rules: Vec<Rule> = ends.iter().map(|end| rule_of(&self.problem, end)).collect();
        rules.push(self.rule(old, now, 0));
        self.cache.keep_only(|rule| rules.contains(rule));
    }

    /// Takes the conditions of a phase. Systems stay if the same degrees of freedom are prescribed.
    fn enter(&mut self, phase: usize) {
        if self.problem.has_same_conditions([self.problem.phase(), phase]) {
            self.problem = self.problem.in_phase(phase);
            return;
        }
        let problem = self.problem.in_phase(phase);
        if !problem.has_same_systems(&self.problem) {
            self.cache.drop_all(self.discrete.mesh.dim);
        }
        self.discrete = Arc::new(Discretization::new(&problem));
        (self.problem, self.products) = (problem, None);
        // Springs of the phase before are no part of them any more.
        (self.bodies, self.elastic) = (OnceLock::new(), OnceLock::new());
    }

    /// The state from which a step starts: that at the end of the step before, at rest if the step is steady or if a
    /// phase without inertia ended there and a dynamic one begins, with the energy of the supports of its phase.
    fn begun<'s>(&mut self, old: &'s State, now: &Instant) -> Cow<'s, State> {
        let was = old.made(&self.problem.timeline);
        let had_inertia = old.step == 0 || was.analysis.has_inertia();
        let rests = now.analysis == Analysis::Steady || (!had_inertia && now.analysis.has_inertia());
        let phases = [was.phase, now.phase];
        let changes = !self.problem.has_same_conditions(phases);
        if !rests && !changes {
            return Cow::Borrowed(old);
        }
        let mut begun = old.clone();
        if rests {
            begun.w.fill(0.0);
            begun.surface.advance_rate.fill(0.0);
        }
        if changes {
            let before = self.problem.in_phase(was.phase);
            begun.counts.misfits.extend(misfits(&before, &self.problem, &self.discrete, now, &begun));
            supported(&before, &self.discrete, &mut begun);
            met(&before, &self.problem, &self.discrete, now, &mut begun);
        }
        // Rates of three states hold no jump.
        begun.earlier = begun.earlier.filter(|_| !rests && !changes);
        if changes {
            // Springs of the phase before may have kept rigid motions in, and springs of this one may.
            begun.carried = Carried::default();
        }
        if rests {
            self.products = None;
        }
        Cow::Owned(begun)
    }

    /// True if the shortest part of a step would have one solution between the velocities of two states.
    fn shortest_is_unique(&mut self, old: &State, now: &Instant, end: &State) -> Result<bool, StepError> {
        let singular = |(_, source)| StepError::Singular { step: now.n, t: end.t, source };
        self.halve(old, now, HALVINGS).map_err(singular)?;
        let rule = self.rule(old, now, HALVINGS);
        let made = self.cache.systems(&self.problem, &self.discrete, rule).map_err(singular)?;
        let Systems { mechanics: Some(mechanics), loose, .. } = made else { return Ok(true) };
        let products = Products::of(&self.discrete, old);
        let contacts = contacts_at(&self.problem, rule.time([old.t, end.t]));
        let boundary = boundary_at(&self.discrete, &self.problem, old);
        let now = Step {
            problem: &self.problem,
            contacts: &contacts,
            discrete: &self.discrete,
            boundary: &boundary,
            old,
            bar: Bar::of(old, &products),
            products: &products,
            n: now.n,
            whole: [now.t, now.k],
            t: end.t,
            level: rule.time([old.t, end.t]),
            rule,
            apart: None,
            may_be_halved: false,
            pulse: &self.pulse,
            loose,
            inputs: &self.inputs,
        };
        Mechanics::is_unique(&now, mechanics, end)
    }

    /// Makes a step, or a part of it, as a whole. A step that adds to two states and hits a rigid foundation is made
    /// anew by backward Euler: the velocities before an impact would throw the body back, by how much depends on where
    /// in the step it is hit. If round-off of the displacement may have caused a failure, the rigid motions of bodies
    /// are split off from their deformation, in this and all later steps.
    pub(super) fn attempt(
        &mut self,
        old: &State,
        now: &Instant,
        t: f64,
        halvings: u32,
    ) -> Result<(State, StepReport), StepError> {
        let is_noise = |error: &StepError| match error {
            StepError::Residual { part, .. } => *part == "mechanics",
            StepError::NotConverged { part, why, .. } => *part == "mechanics" && why.residual < NOISE,
            _ => false,
        };
        if !old.carried.rigid.is_empty() {
            self.bodies();
        }
        let made = self.make_step(old, now, t, halvings);
        let adds_to_both = self.rule(old, now, halvings).start == Start::TwoStates;
        if let Ok((state, _)) = &made
            && state.settling == SETTLING
            && adds_to_both
        {
            let alone = State { earlier: None, ..old.clone() };
            return self.make_step(&alone, now, t, halvings);
        }
        let Err(error) = made else { return made };
        if !old.carried.rigid.is_empty() || !is_noise(&error) {
            return Err(error);
        }
        let is_axisymmetric = self.discrete.mesh.axisymmetric;
        let Some(bodies) = self.bodies() else { return Err(error) };
        let apart = State { carried: bodies.apart(is_axisymmetric, &old.u), ..old.clone() };
        tried(self.make_step(&apart, now, t, halvings))?.ok_or(error)
    }

    fn bodies(&self) -> Option<&Bodies> {
        let made = || Bodies::new(&self.problem, &self.discrete.mesh, self.discrete.is_linear());
        self.bodies.get_or_init(made).as_ref()
    }

    /// Makes a step, or a part of it, as a whole.
    fn make_step(
        &mut self,
        old: &State,
        whole: &Instant,
        t: f64,
        halvings: u32,
    ) -> Result<(State, StepReport), StepError> {
        let n = whole.n;
        let singular = |(_, source)| StepError::Singular { step: n, t, source };
        self.halve(old, whole, halvings).map_err(singular)?;
        let rule = self.rule(old, whole, halvings);
        let products = self
            .products
            .take()
            .filter(|p| p.t.to_bits() == old.t.to_bits())
            .unwrap_or_else(|| Products::of(&self.discrete, old));
        let Self { problem, discrete, cache, bodies, pulse, is_patient, inputs, .. } = self;
        let is_patient = *is_patient;
        pulse.begin_part();
        let systems = cache.systems(problem, discrete, rule).map_err(singular)?;
        let (loose, before) = (Arc::clone(&systems.loose), systems.iterations());
        let level = rule.time([old.t, t]);
        let earlier = old.earlier.as_ref().filter(|_| rule.start == Start::TwoStates);
        let mixed = earlier.map(|earlier| Mixed::new(discrete, old, earlier));
        let bodies = bodies.get().and_then(Option::as_ref).filter(|_| !old.carried.rigid.is_empty());
        let carried = bodies.zip(earlier).map(|(bodies, earlier)| mixed_parts(bodies, discrete, old, earlier));
        let contacts = contacts_at(problem, level);
        let boundary = boundary_at(discrete, problem, old);
        let now = Step {
            problem,
            contacts: &contacts,
            discrete,
            boundary: &boundary,
            old,
            bar: mixed.as_ref().map_or_else(|| Bar::of(old, &products), Mixed::bar),
            products: &products,
            n,
            whole: [whole.t, whole.k],
            t,
            level,
            rule,
            apart: bodies.map(|bodies| Apart { bodies, carried: carried.as_ref().unwrap_or(&old.carried) }),
            may_be_halved: halvings < HALVINGS && !is_patient,
            pulse,
            loose: &loose,
            inputs,
        };
        let admissible = systems.predictor.as_mut().map(|half| predictor::admissible(&now, half)).transpose()?;
        let bar = admissible.as_ref().map_or(now.bar, |admissible| admissible.bar(now.bar));
        let now = Step { bar, ..now };
        let made = alone::solved(&now, systems)?;
        steady::check(&now, &made.mechanics)?;
        if let Some(found) = problem.uncovered(&made.heat.theta) {
            return Err(StepError::Uncovered { step: n, t, found: Box::new(found) });
        }
        let ledger = audit(&now, &made.mechanics, &made.heat);
        if !(ledger.closing_error.is_finite() && ledger.heat_closing_error.is_finite()) {
            return Err(StepError::NotFinite { step: n, t, part: "the energy" });
        }
        let adds_to_both = rule_of(problem, whole).start == Start::TwoStates;
        let hits = adds_to_both && now.hits(&made.mechanics.given.frames, &made.mechanics.end.states);
        let (mut state, mut report, products) = made.end(&now, ledger);
        state.settling = if hits { SETTLING } else { old.settling.saturating_sub(1) };
        state.counts.krylov_iterations += systems.iterations() - before;
        report.contact.boundary = (!Arc::ptr_eq(&boundary, &discrete.boundary)).then(|| Arc::clone(&boundary));
        // Products are computed anew if they are of a deformation, as after a break, or were taken before the end of a
        // step.
        self.products = (state.carried.rigid.is_empty() && now.rule.is_at_end()).then_some(products);
        Ok((state, report))
    }
}

/// The step to an equilibrium at t = 0.
pub(crate) struct EquilibriumStep {
    /// The reference state.
    pub start: State,
    pub end: State,
    pub report: StepReport,
}

/// (4 c₀ − c₋₁)/3 of the parts of the displacement, which may not yet have been split one step before.
fn mixed_parts(bodies: &Bodies, discrete: &Discretization, old: &State, earlier: &Earlier) -> Carried {
    if earlier.carried.rigid.is_empty() {
        let before = bodies.apart(discrete.mesh.axisymmetric, &earlier.u);
        return Carried::mixed(&old.carried, &before);
    }
    Carried::mixed(&old.carried, &earlier.carried)
}

/// The rule of a step that follows on one of the same length.
fn rule_of(problem: &Problem, now: &Instant) -> Rule {
    problem.rule(now.analysis, now.k)
}

impl Scheme for March {
    fn discretization(&self) -> &Discretization {
        &self.discrete
    }

    fn initial(&self) -> Result<State, SetupError> {
        let found = match self.problem.initial.state {
            StartState::Given => None,
            StartState::Equilibrium => Some(self.equilibrium()?.end),
        };
        initial::state(&self.problem, &self.discrete, found.as_ref())
    }

    fn problem(&self) -> Option<&Problem> {
        Some(&self.problem)
    }

    fn step(&mut self, old: &State) -> Result<(State, StepReport), StepError> {
        let now = self.problem.timeline.next(old.step, &old.pace, old.pace.level);
        self.pulse.begin_step();
        let before = self.problem.phase();
        if self.problem.timeline.is_between(old.step, &old.pace) {
            self.enter(now.phase);
            self.drop_others(old, &now);
        }
        let made = self.made(old, &now);
        if made.is_err() {
            // The state before still has the conditions of its phase.
            self.enter(before);
        }
        made
    }

    fn solvers(&self) -> Solvers {
        self.cache.solvers()
    }

    fn kept(&self) -> Kept {
        Kept { phase: self.problem.phase(), ..self.cache.kept(self.discrete.mesh.dim) }
    }

    fn recall(&mut self, kept: &Kept) -> Result<(), SetupError> {
        self.enter(kept.phase);
        // At t = 0 nothing is kept.
        if kept.rules.is_empty() {
            return Ok(());
        }
        let made = self.cache.recall(&self.problem, &self.discrete, kept);
        made.map_err(|(part, source)| SetupError::Factor { part, source })
    }

    fn go_back(&mut self, kept: &Kept) -> Result<(), SetupError> {
        self.products = None;
        self.enter(kept.phase);
        let made = self.cache.go_back(&self.problem, &self.discrete, kept);
        made.map_err(|(part, source)| SetupError::Factor { part, source })
    }

    fn take_inputs(&mut self, inputs: &Arc<StepInputs>) -> bool {
        self.inputs = Arc::clone(inputs);
        true
    }

    fn watched_by(&mut self, pulse: &Pulse) {
        self.pulse = pulse.clone();
    }
}

impl March {
    /// The step to the state in equilibrium at t = 0: a static one that takes no time, so that all data are those of
    /// the start.
    pub(crate) fn equilibrium(&self) -> Result<EquilibriumStep, SetupError> {
        let still = self.problem.at_equilibrium();
        let mut march = March::new(&still)?;
        march.pulse = self.pulse.clone();
        let start = initial::state(&still, &march.discrete, None)?;
        let first = still.timeline.instant(1);
        let made = match march.attempt(&start, &first, 0.0, 0) {
            Err(StepError::NotConverged { .. }) => march.with_patience(&start, &first, 0.0),
            made => made,
        };
        let found = made.map_err(|error| datum::named(&still, &start, error));
        let (end, report) = found.map_err(|source| SetupError::Equilibrium { source: Box::new(source) })?;
        Ok(EquilibriumStep { start, end, report })
    }

    /// What the next step of the length `k` in s adds to besides `state`, if it adds to two states: that from which
    /// this one was made.
    pub(super) fn before(&self, [old, state]: [&State; 2], now: &Instant, k: f64) -> Option<Earlier> {
        let adds_to_both = rule_of(&self.problem, now).start == Start::TwoStates && state.settling == 0;
        adds_to_both.then(|| Earlier::of(old, k))
    }

    /// Makes a step with the conditions of its phase.
    fn made(&mut self, old: &State, now: &Instant) -> Result<(State, StepReport), StepError> {
        let old = &*self.begun(old, now);
        let accuracy = self.problem.timeline.accuracy(now.phase);
        let made = match accuracy {
            Some(accuracy) => self.choose(old, accuracy),
            None => self.advance(old, now, now.t, 0).map(|(mut state, report)| {
                state.earlier = self.before([old, &state], now, now.k);
                state.pace = self.problem.timeline.after(&old.pace, now, 0);
                (state, report)
            }),
        };
        let (mut state, report) = made.map_err(|error| datum::named(&self.problem, old, error))?;
        // A chosen step is made in two halves.
        if report.parts > if accuracy.is_some() { 2 } else { 1 } {
            state.counts.halved_steps += 1;
        } else {
            self.drop_others(old, &state.made(&self.problem.timeline));
        }
        state.counts.ambiguous_steps += usize::from(report.is_ambiguous);
        state.counts.contact_steps += usize::from(report.contact.states.iter().any(PointState::bears));
        state.counts.reversed_steps += usize::from(state.is_reversal_of(old));
        state.temperatures = extremes(old.temperatures, &state.theta);
        if self.problem.timeline.is_between(state.step, &state.pace) {
            state.released = released(&self.problem, &self.discrete, &report, now);
        }
        Ok((state, report))
    }
}
