//! A problem with its forms, and the equations of one of its steps at given unknowns.

use std::borrow::Cow;
use std::sync::{Arc, Mutex, PoisonError};

use super::balances::{driven, is_moved};
use super::exerted::{HeatOfContact, exerted, passed};
use super::worn::wear;
use crate::contact::{Flux, Status};
use crate::discretization::Discretization;
use crate::equation::StepInputs;
use crate::equation::acting::{boundary_at, contacts_at};
use crate::equation::given::Given;
use crate::equation::system::{Bar, Mixed, Products, Step};
use crate::inclusion::{Chosen, Local, Loose, Mechanical, PointInput, PointOutput, PointState};
use crate::linalg::{max_abs, zeros};
use crate::problem::{Coupling, Physics, Problem};
use crate::pulse::Pulse;
use crate::state::State;
use crate::step::across_gaps;
use crate::tensor::{Point, dot};
use crate::time::{Instant, Rule, Start};

/// A problem with its forms.
pub(super) struct ProblemInstance {
    pub problem: Problem,
    pub discrete: Arc<Discretization>,
    /// True if the residual of (4.1) and of (4.2) has the forms of the instance beside which it was made, and if loads
    /// and prescribed values are those of this instance.
    alike: [bool; 2],
    has_same_loads: bool,
    /// True if its only step leads to the equilibrium at t = 0, and takes no time.
    is_at_start: bool,
    /// What the step that was asked for last adds to.
    begun: Mutex<Option<Arc<StepStart>>>,
}

/// What a step adds to, with its products with the forms of inertia and storage.
struct StepStart {
    /// The number of the step, and where the state is in memory.
    key: [usize; 3],
    products: Products,
    mixed: Option<Mixed>,
}

/// A residual at other values of a parameter is sought beside that of the problem itself.
pub(super) type BaseResidual<'a> = (&'a ProblemInstance, &'a StepResidual);

/// A problem with its forms in each of its phases.
pub(super) struct PhasedInstance {
    pub first: ProblemInstance,
    later: Vec<ProblemInstance>,
}

impl PhasedInstance {
    /// The problem as it is in its first phase, and in the later ones; forms are shared where conditions are the same.
    pub fn new(problem: &Problem) -> PhasedInstance {
        let first = problem.in_phase(0);
        let discrete = Arc::new(Discretization::new(&first));
        PhasedInstance::with(problem, ProblemInstance::with(&first, &discrete))
    }

    fn with(problem: &Problem, first: ProblemInstance) -> PhasedInstance {
        let made = |phase: usize| {
            let of_phase = problem.in_phase(phase);
            let discrete = if problem.has_same_conditions([0, phase]) {
                Arc::clone(&first.discrete)
            } else {
                Arc::new(Discretization::beside(&of_phase, (&first.problem, &first.discrete)))
            };
            ProblemInstance::with(&of_phase, &discrete)
        };
        let later = (1..problem.timeline.phases().len()).map(made).collect();
        PhasedInstance { first, later }
    }

    /// The problem whose step leads to the equilibrium at t = 0.
    pub fn at_start(still: &Problem) -> PhasedInstance {
        let mut made = PhasedInstance::new(still);
        made.first.is_at_start = true;
        made
    }

    /// The same of a problem that differs from another one by a parameter. Parts of its residuals that the parameter
    /// does not change are then taken from those of the other one.
    pub fn beside(problem: &Problem, other: &PhasedInstance) -> PhasedInstance {
        let first = problem.in_phase(0);
        let discrete = Arc::new(Discretization::beside(&first, (&other.first.problem, &other.first.discrete)));
        let mut made = PhasedInstance::with(problem, ProblemInstance::with(&first, &discrete));
        if made.later.len() == other.later.len() {
            made.first.compare(&other.first);
            made.first.is_at_start = other.first.is_at_start;
            made.later.iter_mut().zip(&other.later).for_each(|(own, other)| own.compare(other));
        }
        made
    }

    /// The problem in the phase of step n.
    pub fn of(&self, n: usize) -> &ProblemInstance {
        self.in_phase(self.first.problem.timeline.instant(n).phase)
    }

    /// The problem in a phase.
    pub fn in_phase(&self, phase: usize) -> &ProblemInstance {
        phase.checked_sub(1).and_then(|later| self.later.get(later)).unwrap_or(&self.first)
    }

    /// The problem in a phase, which may be changed.
    pub fn in_phase_mut(&mut self, phase: usize) -> Option<&mut ProblemInstance> {
        match phase.checked_sub(1) {
            None => Some(&mut self.first),
            Some(later) => self.later.get_mut(later),
        }
    }

    /// The problem in all phases.
    pub fn all(&self) -> impl Iterator<Item = &ProblemInstance> {
        std::iter::once(&self.first).chain(&self.later)
    }

    /// How step n starts from the state before it.
    pub fn start(&self, n: usize) -> PhaseStart {
        let timeline = &self.first.problem.timeline;
        let now = timeline.instant(n);
        if n == 1 {
            return PhaseStart { k: now.k, ..PhaseStart::default() };
        }
        let was = timeline.instant(n - 1);
        PhaseStart {
            k: now.k,
            rests: !was.analysis.has_inertia() && now.analysis.has_inertia(),
            changes: !self.first.problem.has_same_conditions([was.phase, now.phase]),
        }
    }
}

/// How a step starts, and a phase with it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct PhaseStart {
    /// Length of the step, s.
    pub k: f64,
    /// True if the body is at rest: a phase without inertia ended, and one with inertia begins.
    pub rests: bool,
    /// True if conditions change.
    pub changes: bool,
}

/// A step: the state that it starts from, its unknowns, and what the iteration on Γ_C chose.
#[derive(Clone, Copy)]
pub(super) struct SolvedStep<'a> {
    pub n: usize,
    pub old: &'a State,
    pub new: &'a State,
    /// The new state with the unknowns at the time of the equations, as [`at_level`] has it.
    pub at: &'a State,
    pub states: &'a [PointState],
    pub flux: &'a [Flux],
    pub chosen: &'a Chosen,
    pub unknown: &'a [Option<u32>],
}

/// The state at the end of a step with w and θ at the time of its equations, [`Rule::level`]. At the end of a steady
/// step the body rests, and its unknown is the velocity that leads there in infinite time.
pub(super) fn at_level<'a>(rule: &Rule, old: &State, new: &'a State) -> Cow<'a, State> {
    if rule.is_steady() {
        let w = new.u.iter().zip(&old.u).map(|(new, old)| (new - old) / rule.gamma).collect();
        return Cow::Owned(State { w, ..new.clone() });
    }
    if rule.is_at_end() {
        return Cow::Borrowed(new);
    }
    let between = |old: &[f64], new: &[f64]| -> Vec<f64> {
        old.iter().zip(new).map(|(old, new)| rule.between([*old, *new])).collect()
    };
    let (w, theta) = (between(&old.w, &new.w), between(&old.theta, &new.theta));
    let mut surface = new.surface.clone();
    for (new, old) in surface.foundation.iter_mut().zip(&old.surface.foundation) {
        *new = old.zip(*new).map(|(old, new)| rule.between([old, new]));
    }
    Cow::Owned(State { w, theta, surface, ..new.clone() })
}

/// The equations of a step at given unknowns.
pub(super) struct StepResidual {
    /// What contact points have no share in; the same one where a parameter does not change it.
    pub body: Arc<BodyResidual>,
    /// Forces and heat fluxes of contact that the nodes of Γ_C lose, N and W.
    pub exerted: Vec<f64>,
    pub passed: Vec<f64>,
    /// The contact points.
    pub points: Vec<PointOutput>,
    /// Work of friction in the step at each point, J/m².
    pub work: Vec<f64>,
    /// The states of the contact points.
    pub states: Vec<PointState>,
    /// Per contact what it lacks to be in equilibrium with the force that drives it, and the sizes of these forces, N;
    /// zero where nothing drives it.
    pub lacking: Vec<f64>,
    pub driving: Vec<f64>,
    /// Per contact what the balance of its foundation lacks, and the sizes of its terms, W; zero where θ_F is
    /// prescribed.
    pub missing: Vec<f64>,
    pub warming: Vec<f64>,
    /// What of wear follows from the unknowns, [`wear`].
    pub worn: Vec<f64>,
    pub grown: Vec<f64>,
    /// Largest terms of (4.1) and of (4.2), whose round-off the residuals contain.
    pub sizes: [f64; 2],
}

/// The equations of the bodies in a step at given unknowns, without contact.
pub(super) struct BodyResidual {
    /// (4.1) per degree of freedom, N, and (4.2) per node, W.
    pub mechanics: Vec<f64>,
    pub heat: Vec<f64>,
    /// The velocities and temperatures, those that are prescribed by their data.
    pub rates: Vec<f64>,
    pub temperatures: Vec<f64>,
    /// What follows from the unknowns: the mean rate of θ, ū + γw, and the branches.
    pub theta_rate: Vec<f64>,
    pub u: Vec<f64>,
    pub branches: Vec<Vec<f64>>,
    /// Parts of the residuals, and the largest terms.
    parts: BodyParts,
    sizes: [f64; 2],
}

/// The parts of (4.1) and of (4.2) without loads, each with its largest term.
#[derive(Clone)]
struct BodyParts {
    mechanics: Arc<(Vec<f64>, f64)>,
    heat: Arc<(Vec<f64>, f64)>,
}

impl ProblemInstance {
    fn with(problem: &Problem, discrete: &Arc<Discretization>) -> ProblemInstance {
        let discrete = Arc::clone(discrete);
        let problem = problem.clone();
        ProblemInstance {
            problem,
            discrete,
            alike: [false; 2],
            has_same_loads: false,
            is_at_start: false,
            begun: Mutex::default(),
        }
    }

    /// Notes which forms are those of another instance, and whether the loads are.
    fn compare(&mut self, other: &ProblemInstance) {
        let is_warmed = self.problem.physics == Physics::Warmed;
        self.has_same_loads = self.discrete.shares_loads(&other.discrete) && !is_warmed;
        self.alike = self.discrete.has_same_forms(&other.discrete).map(|is_same| is_same && !is_warmed);
    }

    /// Leaves the forms of the bodies to the instance beside which it was made, whose derivatives are known.
    pub fn leave_forms(&mut self, other: &ProblemInstance) {
        self.alike = [true; 2];
        if let Some(discrete) = Arc::get_mut(&mut self.discrete) {
            discrete.take_forms(&other.discrete);
        }
    }

    /// What step n from a state adds to.
    fn begun(&self, n: usize, old: &State, rule: Rule) -> Arc<StepStart> {
        let key = [n, old.u.as_ptr().addr(), old.w.as_ptr().addr()];
        let mut begun = self.begun.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(begun) = begun.as_ref().filter(|begun| begun.key == key) {
            return Arc::clone(begun);
        }
        let discrete = &self.discrete;
        // The others are those of an iteration that is already made.
        let [a_u, a_w, b_w, d_theta] = <[Vec<f64>; 4]>::default();
        let (mass_w, mass_theta) = (discrete.inertia().1.apply(&old.w), discrete.stored_heat(&old.theta));
        let products = Products { t: old.t, mass_w, a_u, a_w, b_w, mass_theta, d_theta };
        let earlier = old.earlier.as_ref().filter(|_| rule.start == Start::TwoStates);
        let mixed = earlier.map(|earlier| Mixed::new(discrete, old, earlier));
        let made = Arc::new(StepStart { key, products, mixed });
        *begun = Some(Arc::clone(&made));
        made
    }

    /// The end of step n.
    pub fn instant(&self, n: usize) -> Instant {
        let now = self.problem.timeline.instant(n.max(1));
        if self.is_at_start { Instant { n, t: 0.0, ..now } } else { now }
    }

    /// The rule of step n from a state: one without a state before it starts anew.
    pub fn rule(&self, n: usize, old: &State) -> Rule {
        let now = self.instant(n);
        match old.earlier {
            Some(_) => self.problem.rule(now.analysis, now.k),
            None => self.problem.starting_rule(now.analysis, now.k),
        }
    }

    /// Something of a step that starts from a state.
    pub fn step<T>(&self, n: usize, old: &State, of: impl FnOnce(&Step) -> T) -> T {
        let begun = self.begun(n, old, self.rule(n, old));
        self.step_from(&begun, (n, old), of)
    }

    fn step_from<T>(&self, begun: &StepStart, (n, old): (usize, &State), of: impl FnOnce(&Step) -> T) -> T {
        let (now, rule) = (self.instant(n), self.rule(n, old));
        // The times of a run are data too.
        let start = if self.is_at_start { 0.0 } else { now.t - now.k };
        let old = &*if (old.t - start).abs() <= 1e-12 * now.t {
            Cow::Borrowed(old)
        } else {
            Cow::Owned(State { t: start, ..old.clone() })
        };
        let level = rule.time([old.t, now.t]);
        let contacts = contacts_at(&self.problem, level);
        let boundary = boundary_at(&self.discrete, &self.problem, old);
        let (loose, pulse, inputs) = (Arc::new(Loose::default()), Pulse::default(), StepInputs::default());
        of(&Step {
            problem: &self.problem,
            contacts: &contacts,
            discrete: &self.discrete,
            boundary: &boundary,
            old,
            bar: begun.mixed.as_ref().map_or_else(|| Bar::of(old, &begun.products), Mixed::bar),
            products: &begun.products,
            n,
            whole: [now.t, now.k],
            rule,
            t: now.t,
            level,
            apart: None,
            pulse: &pulse,
            may_be_halved: false,
            loose: &loose,
            inputs: &inputs,
        })
    }

    /// The equations of a step at its unknowns w, θ and `forces`, (p, q) of each point in its own basis; at another
    /// value of a parameter `beside` those of the problem itself.
    pub fn residual(&self, of: &SolvedStep, forces: &[Local], beside: Option<BaseResidual>) -> StepResidual {
        let same_rule = |(other, _): &BaseResidual| other.rule(of.n, of.old) == self.rule(of.n, of.old);
        let beside = beside.filter(same_rule);
        let other = beside.filter(|_| self.alike == [true; 2]).map(|(other, _)| other);
        let begun = other.unwrap_or(self).begun(of.n, of.old, self.rule(of.n, of.old));
        self.step_from(&begun, (of.n, of.old), |step| {
            let given = data(step, of.at);
            let term = given.frozen(step, of.unknown, of.chosen);
            let inputs = term.as_ref().map_or_else(Vec::new, |term| inputs(step, &given, term, of.at, forces));
            let points: Vec<PointOutput> = term.as_ref().map_or_else(Vec::new, |term| {
                inputs.iter().enumerate().map(|(i, input)| term.equations(i, input)).collect()
            });
            let states: Vec<PointState> = term.as_ref().map_or_else(
                || at_rest(step),
                |term| {
                    let of = |(i, (point, force))| state(&term.basis(i), point, force);
                    points.iter().zip(forces).enumerate().map(of).collect()
                },
            );
            let rubbed = |(state, frame)| {
                let state: &PointState = state;
                step.rubbing(frame) * dot(&state.q, &state.slip)
            };
            let work = states.iter().zip(&given.frames).map(rubbed).collect();
            let body = match beside {
                Some((other, here)) if self.has_body_of(other, of.n) => Arc::clone(&here.body),
                _ => Arc::new(BodyResidual::new(step, of, beside.map(|(_, here)| &*here.body), self.alike)),
            };
            let exerted = exerted(step, &states, &of.new.surface.wet.points);
            let HeatOfContact { passed, missing, warming } = passed(step, of.at, &states);
            let sizes = [body.sizes[0].max(max_abs(&exerted)), body.sizes[1].max(max_abs(&passed))];
            let [worn, grown] = wear(step, of.new, &points);
            let [lacking, driving] = driven(step, &states, &of.at.surface.advance);
            StepResidual {
                body,
                exerted,
                passed,
                points,
                work,
                states,
                lacking,
                driving,
                missing,
                warming,
                worn,
                grown,
                sizes,
            }
        })
    }

    /// True if the equations of the bodies in a step are those of another instance.
    fn has_body_of(&self, other: &ProblemInstance, n: usize) -> bool {
        self.alike == [true; 2] && self.has_same_loads && self.instant(n) == other.instant(n)
    }
}

impl StepResidual {
    /// (4.1) per degree of freedom, N.
    pub fn mechanics(&self, discrete: &Discretization) -> Vec<f64> {
        let mut sum = self.body.mechanics.clone();
        discrete.boundary.add_restricted(discrete.v.components, &self.exerted, &mut sum);
        sum
    }

    /// (4.2) per node, W.
    pub fn heat(&self, discrete: &Discretization) -> Vec<f64> {
        let mut sum = self.body.heat.clone();
        discrete.boundary.add_restricted(1, &self.passed, &mut sum);
        sum
    }
}

impl BodyResidual {
    /// The equations at the unknowns of a step; forms that are `alike` those beside which they are made are not
    /// multiplied again.
    fn new(step: &Step, of: &SolvedStep, beside: Option<&BodyResidual>, alike: [bool; 2]) -> BodyResidual {
        let [of_mechanics, of_heat] = alike.map(|is_alike| beside.filter(|_| is_alike).map(|known| &known.parts));
        let parts = BodyParts {
            mechanics: of_mechanics
                .map_or_else(|| Arc::new(of_bodies(step, of.at)), |known| Arc::clone(&known.mechanics)),
            heat: of_heat.map_or_else(|| Arc::new(of_conduction(step, of.at)), |known| Arc::clone(&known.heat)),
        };
        let (mechanics, u, acting) = balance(step, &of.at.w, &parts);
        let mut rates = of.at.w.clone();
        let free = step.replacing(|inputs| &inputs.displacements);
        step.discrete.v.prescribe_rates([step.t, step.rule.span], &free, step.bar.u, &mut rates);
        let (heat, temperatures, flowing) = warming(step, &of.at.theta, &parts);
        let theta_rate = step.theta_rate(&step.end(&step.old.theta, of.at.theta.clone()));
        let u = step.end(&step.old.u, u);
        let branches = step.old.branches.iter().zip(step.branches(&of.at.w));
        let branches = branches.map(|(old, branch)| step.end(old, branch)).collect();
        let sizes = [acting, flowing];
        BodyResidual { mechanics, heat, rates, temperatures, theta_rate, u, branches, parts, sizes }
    }
}

/// The data of the contact points of a step, with its unknowns at the time of its equations.
pub(super) fn data(step: &Step, at: &State) -> Given {
    let theta = step.boundary.scalars_on(step.contacts, &driving(step, &at.theta));
    let mut given = Given::new(step, &at.w).at(theta);
    if is_moved(step.problem) {
        given.lead(step, [&step.old.surface.advance, &at.surface.advance]);
    }
    given
}

/// What the equations of the contact points depend on, at the unknowns of a step.
pub(super) fn inputs(step: &Step, given: &Given, term: &Mechanical, new: &State, forces: &[Local]) -> Vec<PointInput> {
    let points = step.boundary.points.iter().zip(forces).enumerate();
    points
        .map(|(i, (point, force))| {
            let v = step.boundary.vector_at(point, step.discrete.mesh.dim, &new.w);
            PointInput {
                velocity: term.basis(i).map(|axis| dot(&axis, &v)),
                force: *force,
                opening: term.distance(i),
                temperature: given.temperature.get(i).copied().unwrap_or(0.0),
                sticks: new.multipliers.sticks.get(i).copied().unwrap_or(false),
            }
        })
        .collect()
}

/// A vector in the axes of space, by its components in a basis.
pub(super) fn global(basis: &[Point; 3], v: &Local) -> Point {
    std::array::from_fn(|c| (0..3).map(|a| v[a] * basis[a][c]).sum())
}

fn state(basis: &[Point; 3], point: &PointOutput, force: &Local) -> PointState {
    let PointOutput { penetration, slip: [s1, s2], worn, bound, .. } = *point;
    PointState {
        normal: basis[0],
        penetration,
        at_level: point.at_level,
        pressure: force[0],
        bound,
        q: global(basis, &[0.0, force[1], force[2]]),
        slip: global(basis, &[0.0, s1, s2]),
        wear: worn,
        opened: worn,
        status: Status::Open,
    }
}

/// The contact points of a step without mechanics, which exchange heat across their gaps.
fn at_rest(step: &Step) -> Vec<PointState> {
    if step.problem.physics.has_mechanics() { Vec::new() } else { across_gaps(step) }
}

/// The temperature in m and in the laws of bodies and contact: the given one; θ_{n−1}, extrapolated or not; or that of
/// the step, `at` the time of its equations.
pub(super) fn driving(step: &Step, at: &[f64]) -> Vec<f64> {
    match step.problem.physics {
        Physics::Warmed => step.problem.given_temperature(step.level),
        Physics::Coupled if is_coupled(step) => at.to_vec(),
        Physics::Coupled if step.coupling() == Coupling::Extrapolated => step.extrapolated(),
        Physics::Coupled | Physics::Heat => step.old.theta.clone(),
        Physics::Mechanics => zeros(step.old.theta.len()),
    }
}

/// True if each half-step has the solution of the other one.
pub(super) fn is_coupled(step: &Step) -> bool {
    step.problem.physics == Physics::Coupled && matches!(step.coupling(), Coupling::FixedPoint | Coupling::Monolithic)
}

/// ū + γw.
pub(super) fn deformation(step: &Step, w: &[f64]) -> Vec<f64> {
    step.bar.u.iter().zip(w).map(|(u, w)| u + step.rule.gamma * w).collect()
}

/// True if the displacement in e(u, ·) is that of the step: its heat follows its mechanics.
pub(super) fn follows(step: &Step) -> bool {
    step.problem.physics == Physics::Coupled && step.coupling() != Coupling::Staggered
}

/// The displacement in e(u, ·).
pub(super) fn heated_by<'a>(step: &Step<'a>, w: &[f64]) -> Cow<'a, [f64]> {
    if follows(step) { Cow::Owned(deformation(step, w)) } else { Cow::Borrowed(&step.old.u) }
}

/// What in (4.1) is of the bodies, and the largest term.
fn of_bodies(step: &Step, at: &State) -> (Vec<f64>, f64) {
    if !step.problem.physics.has_mechanics() {
        return (Vec::new(), 0.0);
    }
    let (discrete, u, theta) = (step.discrete, deformation(step, &at.w), driving(step, &at.theta));
    let [mass_w, a_u, _, b_w] = discrete.mechanical_products(&u, &step.rates(&at.w), &discrete.warmed(&theta));
    let (inertia, thermal) = (step.inertia() / step.rule.delta, discrete.thermal_force(&theta));
    let largest = [&a_u, &b_w, &thermal].map(|term| max_abs(term)).into_iter().fold(0.0, f64::max);
    let largest = largest.max(inertia * max_abs(&mass_w).max(max_abs(step.bar.mass_w)));
    let of = |i: usize| inertia * (mass_w[i] - step.bar.mass_w[i]) + b_w[i] + a_u[i] - thermal[i];
    let mut sum: Vec<f64> = (0..at.w.len()).map(of).collect();
    sum.iter_mut().zip(&step.relaxing(&at.w)).for_each(|(sum, force)| *sum += force);
    (sum, largest)
}

/// The residual of (4.1) at a velocity without contact, ū + γw, and the largest term.
fn balance(step: &Step, w: &[f64], parts: &BodyParts) -> (Vec<f64>, Vec<f64>, f64) {
    if !step.problem.physics.has_mechanics() {
        return (Vec::new(), step.old.u.clone(), 0.0);
    }
    let (load, (of_bodies, largest)) = (step.load(), &*parts.mechanics);
    let rest = of_bodies.iter().zip(load.iter()).map(|(of_bodies, load)| of_bodies - load).collect();
    (rest, deformation(step, w), largest.max(max_abs(&load)))
}

/// What in (4.2) is of the bodies, and the largest term; nothing without heat.
fn of_conduction(step: &Step, at: &State) -> (Vec<f64>, f64) {
    if !step.problem.physics.has_heat() {
        return (Vec::new(), 0.0);
    }
    let discrete = step.discrete;
    let [stored, conducted] = step.thermal_products(&at.theta);
    let heating = discrete.e.apply(&heated_by(step, &at.w));
    let storage = discrete.storage().0 / step.rule.delta;
    let largest = max_abs(&conducted).max(max_abs(&heating));
    let largest = largest.max(storage * max_abs(&stored).max(max_abs(step.bar.mass_theta)));
    let of = |i: usize| storage * (stored[i] - step.bar.mass_theta[i]) + conducted[i] - heating[i];
    ((0..at.theta.len()).map(of).collect(), largest)
}

/// The residual of (4.2) at a temperature without contact, and the temperature with its prescribed values, both empty
/// without heat, and the largest term.
fn warming(step: &Step, theta: &[f64], parts: &BodyParts) -> (Vec<f64>, Vec<f64>, f64) {
    if !step.problem.physics.has_heat() {
        let given =
            if step.problem.physics == Physics::Warmed { step.problem.given_temperature(step.t) } else { Vec::new() };
        return (Vec::new(), given, 0.0);
    }
    let (discrete, supply, (of_bodies, largest)) = (step.discrete, step.supply(), &*parts.heat);
    let rest = of_bodies.iter().zip(supply.iter()).map(|(of_bodies, supply)| of_bodies - supply).collect();
    let mut prescribed = step.old.theta.clone();
    discrete.q.prescribe_with(step.t, &step.replacing(|inputs| &inputs.temperatures), &mut prescribed);
    step.put_at_level(&mut prescribed);
    discrete.q.mask_free(&mut prescribed);
    let mut masked = theta.to_vec();
    discrete.q.mask(&mut masked);
    prescribed.iter_mut().zip(&masked).for_each(|(prescribed, free)| *prescribed += free);
    discrete.q.follow(&mut prescribed);
    (rest, prescribed, largest.max(max_abs(&supply)))
}
