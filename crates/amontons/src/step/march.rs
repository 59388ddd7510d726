//! The steps of Problem 4.1, one after the other, by the rule of the scheme.

use std::borrow::Cow;
use std::sync::{Arc, OnceLock};

use super::change::{released, supported};
use super::coupling::{Coupled, Made};
use super::initial::{self, extremes, first_temperature};
use super::{Kept, Scheme, alone, datum};
use crate::account::audit;
use crate::contact::{Contact, ContactBoundary, Supports};
use crate::discretization::Discretization;
use crate::equation::apart::Whole;
use crate::equation::bodies::{Apart, Bodies};
use crate::equation::mechanics::{Balanced, Mechanics};
use crate::equation::system::{Bar, HalfStep, Mixed, Products, Step};
use crate::equation::systems::{Cache, SystemError, Systems};
use crate::equation::{SetupError, Solvers, StepError, StepInputs, tried};
use crate::inclusion::PointState;
use crate::linalg::{Backend, dot};
use crate::problem::{Problem, StartState, with_supports};
use crate::pulse::Pulse;
use crate::state::{Carried, ContactReport, Counts, Earlier, Ledger, Reactions, State, StepReport};
use crate::time::{Analysis, HALVINGS, Instant, Rule, Start};

/// Residual of the iteration on Γ_C below which its failure may be due to round-off of the velocities.
const NOISE: f64 = 1e-2;
/// Motion in a step, relative to the displacement, below which its sense does not matter.
const MOVES: f64 = 1e-6;

/// The scheme of a run for (4.1) and (4.2), coupled as [`coupling`](crate::problem::ProblemData::coupling) says.
///
/// A step whose contact iteration does not converge is made in two halves, and these again. The same holds for a step
/// in which softening laws may have several solutions between the previous state and the new one: the shorter the step,
/// the nearer the solution is to the previous branch.
#[derive(Debug)]
pub struct March {
    /// The problem and its forms with the conditions of the phase of the last step.
    problem: Problem,
    discrete: Arc<Discretization>,
    /// The systems of the phases that have begun and are not over, or that a later phase has, too, and those of halved
    /// steps, k/2, k/4 and so on, while steps are halved.
    cache: Cache,
    /// Products that one step computes and the next one needs, with the state they belong to.
    products: Option<Products>,
    /// Bodies whose rigid motions are split off, made at first use, or `None` if they cannot be.
    bodies: OnceLock<Option<Bodies>>,
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
        let made = cache.systems(problem, discrete, first.analysis.starting_rule(problem.scheme, first.k));
        made.map_err(|(part, source)| SetupError::Factor { part, source })?;
        Ok(March {
            problem: problem.clone(),
            discrete: Arc::clone(discrete),
            cache,
            products: None,
            bodies: OnceLock::new(),
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

    /// Advances a state to t, a part 2^−halvings of the step n, in halves if necessary.
    fn advance(&mut self, old: &State, n: usize, t: f64, halvings: u32) -> Result<(State, StepReport), StepError> {
        let made = self.attempt(old, n, t, halvings);
        self.refine(made, old, n, t, halvings)
    }

    /// Makes the part in halves if it was not solved, or may have other solutions: shorter parts have fewer solutions
    /// and show where the branch is in doubt. If both halves are in doubt and the shortest parts would be too, as with
    /// velocity-weakening friction on a body without inertia, halving gives no information, and the two halves stand.
    fn refine(
        &mut self,
        made: Result<(State, StepReport), StepError>,
        old: &State,
        n: usize,
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
        let first = self.attempt(old, n, middle, halvings + 1);
        if let (Ok(_), Ok((state, first))) = (&made, &first)
            && first.is_ambiguous
            && let Some((end, second)) = tried(self.attempt(state, n, t, halvings + 1))?
            && second.is_ambiguous
            && !self.shortest_is_unique(old, n, &end)?
        {
            return Ok((end, second.after(first)));
        }
        let halves = self.refine(first, old, n, middle, halvings + 1).and_then(|(state, first)| {
            let (state, second) = self.advance(&state, n, t, halvings + 1)?;
            Ok((state, second.after(&first)))
        });
        // A solved step stands if its halves are not solved. For an unsolved step the error names the first part that
        // is not solved. An interrupted step is made anew, in halves, by the resumed run.
        halves.or_else(|first| match made {
            _ if !first.is_unsolved() => Err(first),
            Err(_) if halvings == 0 => {
                self.with_patience(old, n, t).map_err(|error| if error.is_unsolved() { first } else { error })
            }
            made => made.map_err(|_| first),
        })
    }

    /// Makes a step whose halves are not solved either, with as many iterations as it needs.
    fn with_patience(&mut self, old: &State, n: usize, t: f64) -> Result<(State, StepReport), StepError> {
        self.is_patient = true;
        let made = self.attempt(old, n, t, 0);
        self.is_patient = false;
        made
    }

    /// The rule of a part 2^−halvings of step n, made from a state. A part of a step has no step of its length before
    /// it.
    fn rule(&self, old: &State, n: usize, halvings: u32) -> Rule {
        let (now, scheme) = (self.problem.timeline.instant(n), self.problem.scheme);
        let follows = old.earlier.as_ref().is_some_and(|earlier| earlier.k.to_bits() == now.k.to_bits());
        if halvings == 0 && follows {
            return now.analysis.rule(scheme, now.k);
        }
        now.analysis.starting_rule(scheme, now.k / f64::from(1u32 << halvings))
    }

    /// Factorizes for step n, made from a state, and for its parts of ½ … 2^−halvings.
    ///
    /// # Errors
    /// Those of [`Cache::systems`].
    fn halve(&mut self, old: &State, n: usize, halvings: u32) -> Result<(), SystemError> {
        for rule in (0..=halvings).map(|halvings| self.rule(old, n, halvings)).collect::<Vec<_>>() {
            self.cache.systems(&self.problem, &self.discrete, rule)?;
        }
        Ok(())
    }

    /// Drops the systems that neither the step made last from a state nor a later step of its phase or of later ones
    /// needs, among them those of halved steps.
    fn drop_others(&mut self, old: &State, now: &Instant) {
        let ends = self.problem.timeline.ends_from(now.phase);
        let mut rules: Vec<Rule> = ends.map(|end| rule_of(&self.problem, &end)).collect();
        rules.push(self.rule(old, now.n, 0));
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
        (self.problem, self.products, self.bodies) = (problem, None, OnceLock::new());
    }

    /// The state from which a step starts: that at the end of the step before, at rest if the step is steady or if a
    /// phase without inertia ended there and a dynamic one begins, with the energy of the supports of its phase.
    fn begun<'s>(&mut self, old: &'s State, now: &Instant) -> Cow<'s, State> {
        let had_inertia = old.step == 0 || self.problem.timeline.instant(old.step).analysis.has_inertia();
        let rests = now.analysis == Analysis::Steady || (!had_inertia && now.analysis.has_inertia());
        let phases = [self.problem.timeline.instant(old.step).phase, now.phase];
        let changes = !self.problem.has_same_conditions(phases);
        if !rests && !changes {
            return Cow::Borrowed(old);
        }
        let mut begun = old.clone();
        if changes {
            supported(&self.problem.at_step(old.step), &self.discrete, &mut begun);
        }
        if rests {
            begun.w.fill(0.0);
            begun.surface.advance_rate.fill(0.0);
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
    fn shortest_is_unique(&mut self, old: &State, n: usize, end: &State) -> Result<bool, StepError> {
        let singular = |(_, source)| StepError::Singular { step: n, t: end.t, source };
        self.halve(old, n, HALVINGS).map_err(singular)?;
        let rule = self.rule(old, n, HALVINGS);
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
            n,
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

    /// Makes a step, or a part of it, as a whole. If round-off of the displacement may have caused a failure, the rigid
    /// motions of bodies are split off from their deformation, in this and all later steps.
    fn attempt(&mut self, old: &State, n: usize, t: f64, halvings: u32) -> Result<(State, StepReport), StepError> {
        let is_noise = |error: &StepError| match error {
            StepError::Residual { part, .. } => *part == "mechanics",
            StepError::NotConverged { part, why, .. } => *part == "mechanics" && why.residual < NOISE,
            _ => false,
        };
        if !old.carried.rigid.is_empty() {
            self.bodies();
        }
        let made = self.make_step(old, n, t, halvings);
        let Err(error) = made else { return made };
        if !old.carried.rigid.is_empty() || !is_noise(&error) {
            return Err(error);
        }
        let is_axisymmetric = self.discrete.mesh.axisymmetric;
        let Some(bodies) = self.bodies() else { return Err(error) };
        let apart = State { carried: bodies.apart(is_axisymmetric, &old.u), ..old.clone() };
        tried(self.make_step(&apart, n, t, halvings))?.ok_or(error)
    }

    fn bodies(&self) -> Option<&Bodies> {
        let made = || Bodies::new(&self.problem, &self.discrete.mesh, self.discrete.is_linear());
        self.bodies.get_or_init(made).as_ref()
    }

    /// Makes a step, or a part of it, as a whole.
    fn make_step(&mut self, old: &State, n: usize, t: f64, halvings: u32) -> Result<(State, StepReport), StepError> {
        let singular = |(_, source)| StepError::Singular { step: n, t, source };
        self.halve(old, n, halvings).map_err(singular)?;
        let rule = self.rule(old, n, halvings);
        let products = self
            .products
            .take()
            .filter(|p| p.t.to_bits() == old.t.to_bits())
            .unwrap_or_else(|| Products::of(&self.discrete, old));
        let Self { problem, discrete, cache, bodies, pulse, is_patient, inputs, .. } = self;
        let is_patient = *is_patient;
        pulse.begin_part();
        let Systems { mechanics, heat, loose, .. } = cache.systems(problem, discrete, rule).map_err(singular)?;
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
            t,
            level,
            rule,
            apart: bodies.map(|bodies| Apart { bodies, carried: carried.as_ref().unwrap_or(&old.carried) }),
            may_be_halved: halvings < HALVINGS && !is_patient,
            pulse,
            loose,
            inputs,
        };
        let before = krylov_iterations(mechanics.as_ref(), heat.as_ref());
        let made = match (&mut *mechanics, &mut *heat) {
            (Some(mechanics), Some(heat)) => Coupled::new(&now, mechanics, heat).solve(),
            (Some(mechanics), None) => alone::mechanics(&now, mechanics),
            (None, Some(heat)) => alone::heat(&now, heat),
            // No value of `Physics` leads here.
            (None, None) => Err(StepError::NotFinite { step: n, t, part: "the data" }),
        };
        let krylov = krylov_iterations(mechanics.as_ref(), heat.as_ref()) - before;
        let made = made?;
        if let Some(found) = problem.uncovered(&made.heat.theta) {
            return Err(StepError::Uncovered { step: n, t, found: Box::new(found) });
        }
        let ledger = audit(&now, &made.mechanics, &made.heat);
        if !(ledger.closing_error.is_finite() && ledger.heat_closing_error.is_finite()) {
            return Err(StepError::NotFinite { step: n, t, part: "the energy" });
        }
        let (mut state, mut report, products) = made.end(&now, ledger);
        state.counts.krylov_iterations += krylov;
        report.contact.boundary = (!Arc::ptr_eq(&boundary, &discrete.boundary)).then(|| Arc::clone(&boundary));
        // Products are computed anew if they are of a deformation, as after a break, or were taken before the end of a
        // step.
        self.products = (state.carried.rigid.is_empty() && now.rule.is_at_end()).then_some(products);
        Ok((state, report))
    }
}

impl Made {
    /// Residual of (4.1), (4.2) and of their coupling.
    fn residual(&self) -> f64 {
        self.mechanics.residual.max(self.heat.residual).max(self.report.defect.unwrap_or(0.0))
    }

    /// The counts with those of this step.
    fn counts(&self, old: &Counts) -> Counts {
        Counts {
            newton_mechanics_total: old.newton_mechanics_total + self.iterations[0],
            newton_mechanics_max: old.newton_mechanics_max.max(self.iterations[0]),
            newton_heat_total: old.newton_heat_total + self.iterations[1],
            sweeps: old.sweeps + self.sweeps,
            residual_max: old.residual_max.max(self.residual()),
            passes_total: old.passes_total + self.report.passes,
            contraction_max: old.contraction_max.max(self.report.contraction.unwrap_or_default()),
            ..*old
        }
    }

    /// The state at the end of the step, the report, and the products that the next step needs.
    fn end(self, step: &Step, ledger: Ledger) -> (State, StepReport, Products) {
        let (old, residual, counts) = (step.old, self.residual(), self.counts(&step.old.counts));
        let Made { mechanics, heat, report: coupling, iterations, .. } = self;
        let theta = step.theta_at_end(heat.theta);
        let surface = old.surface.after(step, &mechanics, &heat.exchange);
        let Mechanics { end, whole, branches, is_unique, .. } = mechanics;
        let Balanced { at, u, states, force, reactions, .. } = end;
        let (u, w, carried) = match whole {
            None => (u, at.w, Carried::default()),
            Some(Whole { u, w, carried, .. }) => (u, w, carried),
        };
        let state = State {
            step: step.n,
            t: step.t,
            u: step.end(&old.u, u),
            w: step.end(&old.w, step.rates(&w).into_owned()),
            theta_rate: step.theta_rate(&theta),
            earlier: None,
            theta,
            multipliers: at.multipliers,
            branches: old.branches.iter().zip(branches).map(|(old, branch)| step.end(old, branch)).collect(),
            carried,
            surface,
            ledger,
            counts,
            temperatures: old.temperatures,
            released: old.released.clone(),
        };
        let report = StepReport {
            newton_mechanics: iterations[0],
            newton_heat: iterations[1],
            parts: 1,
            is_ambiguous: !is_unique,
            residual,
            coupling,
            loose: step.motions(&at.hold.loose),
            reactions: Reactions { force: reactions, heat: heat.reactions },
            forces: step.nodal_forces(),
            contact: ContactReport {
                moments: step.moments(&states),
                boundary: None,
                weights: step.boundary.points.iter().map(|point| point.weight).collect(),
                states,
                temperature: heat.exchange.temperature,
                opposite: heat.exchange.opposite,
                flux: heat.exchange.flux,
                rubbed: heat.exchange.rubbed,
                force,
                heat_flow: heat.through_contact,
            },
        };
        let products = Products {
            t: step.t,
            mass_w: at.mass_w.into_owned(),
            a_u: at.a_u.into_owned(),
            a_w: at.a_w.into_owned(),
            b_w: at.b_w.into_owned(),
            mass_theta: heat.mass_theta,
            d_theta: heat.d_theta,
        };
        (state, report, products)
    }
}

/// True if the velocity at the end of a step is nearly that at its start with the other sign: of their sum less than
/// half of the larger is left. Velocities that move the body by less than a millionth of its displacement do not count.
fn is_reversed(start: &State, end: &State) -> bool {
    let [before, after, product] = [[&start.w, &start.w], [&end.w, &end.w], [&start.w, &end.w]].map(|[a, b]| dot(a, b));
    let moves = (end.t - start.t) * after.sqrt() > MOVES * dot(&end.u, &end.u).sqrt();
    moves && product < 0.0 && before + 2.0 * product + after < 0.25 * before.max(after)
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
    now.analysis.rule(problem.scheme, now.k)
}

/// Krylov iterations of both half-steps so far.
fn krylov_iterations(mechanics: Option<&HalfStep>, heat: Option<&HalfStep>) -> usize {
    mechanics.into_iter().chain(heat).map(|half| half.system.iterations()).sum()
}

/// Γ_C in a step that starts from the state `old`, with updated pairs searched anew.
fn boundary_at(discrete: &Discretization, problem: &Problem, old: &State) -> Arc<ContactBoundary> {
    let of = |supports: Supports| discrete.boundary.updated(&problem.contacts, &discrete.mesh, &old.u, supports);
    let updated = with_supports(&discrete.v, Some(&discrete.outside), of);
    updated.unwrap_or_else(|| Arc::clone(&discrete.boundary))
}

/// The contacts of a problem with their laws at a time.
fn contacts_at(problem: &Problem, t: f64) -> Cow<'_, [Contact]> {
    if problem.contacts.iter().all(|contact| contact.at_time(t).is_none()) {
        return Cow::Borrowed(&problem.contacts);
    }
    Cow::Owned(problem.contacts.iter().map(|contact| contact.at_time(t).unwrap_or_else(|| contact.clone())).collect())
}

impl Scheme for March {
    fn discretization(&self) -> &Discretization {
        &self.discrete
    }

    fn initial(&self) -> Result<State, SetupError> {
        let found = match self.problem.initial.state {
            StartState::Given => None,
            StartState::Equilibrium => Some(self.equilibrium()?),
        };
        initial::state(&self.problem, &self.discrete, found.as_ref())
    }

    fn problem(&self) -> Option<&Problem> {
        Some(&self.problem)
    }

    fn step(&mut self, old: &State) -> Result<(State, StepReport), StepError> {
        let now = self.problem.timeline.instant(old.step + 1);
        self.pulse.begin_step();
        let before = self.problem.phase();
        if self.problem.timeline.ends_phase(old.step) {
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
    /// The state in equilibrium at t = 0: one static step that takes no time, so that all data are those at t = 0.
    fn equilibrium(&self) -> Result<State, SetupError> {
        let still = self.problem.at_equilibrium();
        let mut march = March::new(&still)?;
        march.pulse = self.pulse.clone();
        let start = initial::state(&still, &march.discrete, None)?;
        let made = match march.attempt(&start, 1, 0.0, 0) {
            Err(StepError::NotConverged { .. }) => march.with_patience(&start, 1, 0.0),
            made => made,
        };
        let found = made.map_err(|error| datum::named(&still, &start, error));
        found.map(|(state, _)| state).map_err(|source| SetupError::Equilibrium { source: Box::new(source) })
    }

    /// Makes a step with the conditions of its phase.
    fn made(&mut self, old: &State, now: &Instant) -> Result<(State, StepReport), StepError> {
        let old = &*self.begun(old, now);
        let made = self.advance(old, now.n, now.t, 0);
        let (mut state, report) = made.map_err(|error| datum::named(&self.problem, old, error))?;
        if report.parts > 1 {
            state.counts.halved_steps += 1;
        } else {
            self.drop_others(old, now);
        }
        let adds_to_both = rule_of(&self.problem, now).start == Start::TwoStates;
        state.earlier = adds_to_both.then(|| Earlier::of(old, now.k));
        state.counts.ambiguous_steps += usize::from(report.is_ambiguous);
        state.counts.contact_steps += usize::from(report.contact.states.iter().any(PointState::bears));
        state.counts.reversed_steps += usize::from(is_reversed(old, &state));
        state.temperatures = extremes(old.temperatures, &state.theta);
        if self.problem.timeline.ends_phase(now.n) {
            state.released = released(&self.problem, &self.discrete, &report, now);
        }
        Ok((state, report))
    }
}
