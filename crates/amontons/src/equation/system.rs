//! Data shared by the parts of a step: its input, and the systems of both half-steps.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::sync::Arc;

use super::StepError;
use super::bodies::Apart;
use super::inputs::StepInputs;
use crate::contact::{Contact, ContactBoundary, Status};
use crate::discretization::Discretization;
use crate::inclusion::residual::{Residual, grown, is_small};
use crate::inclusion::{Failure, Frame, Loose, NotConverged, PointState, Undetermined};
use crate::linalg::{
    Backend, BlockMatrix, Condensed, EXACT, Layout, SolveError, System, Tangent, is_finite, larger, map, zeros,
};
use crate::mesh::defects::components;
use crate::model::rigid_motions;
use crate::problem::{Coupling, Physics, Problem};
use crate::pulse::Pulse;
use crate::rigid::{described, floating};
use crate::space::Space;
use crate::state::{Earlier, State};
use crate::tensor::Point;
use crate::time::{Interval, Rule, Start};

/// Largest accepted relative residual of a step.
pub const ACCEPTED: f64 = 1e-10;
/// Roundings of a state, each of half a last bit or less, that a residual may contain: those of u and of its terms.
const ROUNDINGS: f64 = 2.0;
/// Relative residual above which another iteration of sweeps is made.
pub const REFINE: f64 = 1e-11;

/// Input of a step.
#[derive(Clone, Copy)]
pub(crate) struct Step<'a> {
    pub problem: &'a Problem,
    /// The contacts of the problem with their laws at the time of the equations.
    pub contacts: &'a [Contact],
    pub discrete: &'a Discretization,
    /// Γ_C in this step, with updated pairs.
    pub boundary: &'a ContactBoundary,
    /// The state that the step starts from.
    pub old: &'a State,
    /// ū, w̄, θ̄ and z̄ with their products, and the products of the state that the step starts from.
    pub bar: Bar<'a>,
    pub products: &'a Products,
    /// n.
    pub n: usize,
    /// End and length of the whole step, of which this may be a part, s.
    pub whole: [f64; 2],
    /// The rule in time, the end t_n of the step, and the time t_ϑ at which its equations hold, s.
    pub rule: Rule,
    pub t: f64,
    pub level: f64,
    /// Split-off rigid motions of the bodies, or `None` if the step does not split them off.
    pub apart: Option<Apart<'a>>,
    /// Receives the progress of each iteration on Γ_C.
    pub pulse: &'a Pulse,
    /// True if the step is halved when an iteration on Γ_C does not converge.
    pub may_be_halved: bool,
    /// The rigid motions of the parts that are supported by contact only.
    pub loose: &'a Arc<Loose>,
    /// Loads and prescribed values set from the outside.
    pub inputs: &'a StepInputs,
}

/// Values to which the rule in time adds, [`Start`].
#[derive(Clone, Copy)]
pub(crate) struct Bar<'a> {
    pub u: &'a [f64],
    pub w: &'a [f64],
    pub theta: &'a [f64],
    pub branches: &'a [Vec<f64>],
    /// θ̄_F of each foundation with a heat capacity, K.
    pub foundation: &'a [Option<f64>],
    /// Products of w̄ and θ̄ with the forms of inertia and storage, as in [`Products`].
    pub mass_w: &'a [f64],
    pub mass_theta: &'a [f64],
}

impl<'a> Bar<'a> {
    /// The state that the step starts from.
    pub fn of(state: &'a State, products: &'a Products) -> Bar<'a> {
        let State { u, w, theta, branches, surface, .. } = state;
        let foundation = &surface.foundation;
        Bar { u, w, theta, branches, foundation, mass_w: &products.mass_w, mass_theta: &products.mass_theta }
    }
}

/// (4 v₀ − v₋₁)/3 of the vectors of two states.
pub(crate) struct Mixed {
    u: Vec<f64>,
    w: Vec<f64>,
    theta: Vec<f64>,
    branches: Vec<Vec<f64>>,
    foundation: Vec<Option<f64>>,
    mass_w: Vec<f64>,
    mass_theta: Vec<f64>,
}

impl Mixed {
    pub fn new(discrete: &Discretization, state: &State, earlier: &Earlier) -> Mixed {
        let mix = |now: &[f64], before: &[f64]| map([now, before], |[now, before]| (4.0 * now - before) / 3.0);
        let branches = state.branches.iter().zip(&earlier.branches);
        let [u, w, theta] =
            [(&state.u, &earlier.u), (&state.w, &earlier.w), (&state.theta, &earlier.theta)].map(|(a, b)| mix(a, b));
        let mass_w = discrete.inertia().1.apply(&w);
        let mass_theta = if discrete.stores_linearly() {
            discrete.storage().1.apply(&theta)
        } else {
            mix(&discrete.stored_heat(&state.theta), &discrete.stored_heat(&earlier.theta))
        };
        let foundation = state.surface.foundation.iter().zip(&earlier.foundation);
        let foundation = foundation.map(|(now, before)| Some((4.0 * (*now)? - (*before)?) / 3.0)).collect();
        let branches = branches.map(|(now, before)| mix(now, before)).collect();
        Mixed { u, w, theta, branches, foundation, mass_w, mass_theta }
    }

    pub fn bar(&self) -> Bar<'_> {
        let Mixed { u, w, theta, branches, foundation, mass_w, mass_theta } = self;
        Bar { u, w, theta, branches, foundation, mass_w, mass_theta }
    }
}

/// State whose round-off is requested.
#[derive(Clone, Copy)]
pub(crate) enum Rounded {
    Here,
    /// The previous state.
    Before,
    /// The prescribed values of this state only.
    Prescribed,
    /// The positions of the nodes, which determine the gaps.
    Places,
}

impl Step<'_> {
    /// The entries of a vector at the contact nodes, followed by those of the nodes that hold the motions of rigid
    /// bodies.
    pub fn on_contact(&self, values: &[f64]) -> Vec<f64> {
        let n = self.discrete.mesh.dim;
        let mut seen = Vec::with_capacity(self.boundary.nodes.len() * n);
        for node in self.discrete.v.with_rigid(&self.boundary.nodes) {
            seen.extend_from_slice(&values[node as usize * n..(node as usize + 1) * n]);
        }
        seen
    }

    /// |ū| + γ |v|, the sizes of the summands of the displacement that determines the strains.
    pub fn sizes(&self, v: &[f64]) -> Vec<f64> {
        let before: &[f64] = self.apart.map_or(self.bar.u, |apart| &apart.carried.deformation);
        before.iter().zip(v).map(|(u, v)| u.abs() + self.rule.gamma * v.abs()).collect()
    }

    /// The state of the relaxing branches.
    pub fn branches(&self, w: &[f64]) -> Vec<Vec<f64>> {
        let branches = self.discrete.branches.iter().zip(self.bar.branches);
        branches.map(|(branch, bar)| branch.step(self.rule, bar, w)).collect()
    }

    /// Σ ∫ 𝓖e_n:ε(·) of the branches with the strains e_n of their springs; empty without branches.
    pub fn relaxing(&self, w: &[f64]) -> Vec<f64> {
        let mut sum = Vec::new();
        for (branch, z) in self.discrete.branches.iter().zip(self.branches(w)) {
            let force = branch.force(&z);
            if sum.is_empty() {
                sum = force;
            } else {
                sum.iter_mut().zip(&force).for_each(|(sum, force)| *sum += force);
            }
        }
        sum
    }

    /// The scale of the inertia that acts in the step, as [`Discretization::inertia`] has it.
    pub fn inertia(&self) -> f64 {
        self.rule.inertia(self.discrete.inertia().0)
    }

    /// The times of the step.
    pub fn interval(&self) -> Interval {
        let before = match self.rule.start {
            Start::State | Start::Admissible => None,
            Start::TwoStates => Some(self.old.t - self.rule.k),
        };
        let within = if self.rule.is_steady() { self.rule.span } else { self.t - self.old.t };
        Interval { start: self.old.t, end: self.t, level: self.level, before, within }
    }

    /// The velocities that inertia and viscosity see: none in a steady step.
    pub fn rates<'v>(&self, w: &'v [f64]) -> Cow<'v, [f64]> {
        if self.rule.is_steady() { Cow::Owned(zeros(w.len())) } else { Cow::Borrowed(w) }
    }

    /// The coupling of the half-steps. A steady step has no start that a scheme in time could couple them by.
    pub fn coupling(&self) -> Coupling {
        if self.rule.is_steady() { Coupling::Monolithic } else { self.problem.coupling }
    }

    /// The time for which friction works at the slip velocity of the step, s. A foundation that slides does so for the
    /// length of the step, and over one that rests the body moves.
    pub fn rubbing(&self, frame: &Frame) -> f64 {
        if frame.slides { self.rule.k } else { self.rule.moving() }
    }

    /// Interpolates temperatures at the end of the step to the time of its equations.
    pub fn put_at_level(&self, theta: &mut [f64]) {
        if !self.rule.is_at_end() {
            let start = self.old.theta.iter();
            theta.iter_mut().zip(start).for_each(|(theta, start)| *theta = self.rule.between([*start, *theta]));
        }
    }

    /// The temperature at the time of the equations, extrapolated: θ₀ + ϑk θ̇ with the mean rate θ̇ of the step before;
    /// in the first step θ₀.
    pub fn extrapolated(&self) -> Vec<f64> {
        let ahead = self.rule.level * self.rule.k;
        let rates = self.old.theta_rate.iter().copied().chain(std::iter::repeat(0.0));
        self.old.theta.iter().zip(rates).map(|(theta, rate)| theta + ahead * rate).collect()
    }

    /// The temperature at the end of the step, given or solved for.
    pub fn theta_at_end(&self, at_level: Vec<f64>) -> Vec<f64> {
        match self.problem.physics {
            Physics::Warmed => self.problem.given_temperature(self.t),
            _ => self.end(&self.old.theta, at_level),
        }
    }

    /// The mean rate of θ in the step with the temperature `theta` at its end, K/s; empty if no step extrapolates it.
    pub fn theta_rate(&self, theta: &[f64]) -> Vec<f64> {
        if self.coupling() != Coupling::Extrapolated {
            return Vec::new();
        }
        theta.iter().zip(&self.old.theta).map(|(end, start)| (end - start) / self.rule.k).collect()
    }

    /// The values at the end of the step of an unknown that was solved for at the time of the equations.
    pub fn end(&self, start: &[f64], at_level: Vec<f64>) -> Vec<f64> {
        if self.rule.is_at_end() {
            return at_level;
        }
        start.iter().zip(&at_level).map(|(start, at)| self.rule.end([*start, *at])).collect()
    }

    /// The velocity at the end of the step by that at the time of the equations.
    pub fn end_velocity(&self, mut at_level: Vec<f64>) -> Vec<f64> {
        if self.rule.balances_contact_at_end() {
            let of_step: Vec<(usize, f64)> = self.massless_dofs().map(|i| (i, at_level[i])).collect();
            let mut w = self.end(&self.old.w, at_level);
            for (i, velocity) in of_step {
                w[i] = velocity;
            }
            return w;
        }
        if self.rule.start != Start::Admissible {
            return self.end(&self.old.w, at_level);
        }
        let before = self.old.w.iter().zip(self.bar.w);
        at_level.iter_mut().zip(before).for_each(|(w, (start, bar))| *w = self.rule.end_velocity([*start, *bar, *w]));
        at_level
    }

    /// Returns an error if a value is not finite.
    pub fn finite(&self, values: &[f64], part: &'static str) -> Result<(), StepError> {
        if is_finite(values) { Ok(()) } else { Err(StepError::NotFinite { step: self.n, t: self.t, part }) }
    }

    /// A residual relative to the largest term of its equation.
    pub fn relative(&self, residual: f64, scale: f64, part: &'static str) -> Result<f64, StepError> {
        let relative = if residual == 0.0 { 0.0 } else { residual / scale };
        if relative.is_nan() { Err(StepError::NotFinite { step: self.n, t: self.t, part }) } else { Ok(relative) }
    }

    /// The residual relative to the largest term, if it is small enough to be accepted: below [`ACCEPTED`], or within
    /// the round-off of the state, provided that this is small relative to the terms that act on the body. A contact
    /// force within that round-off counts as zero. If nothing acts, the round-off of the state must be small relative
    /// to the prescribed motion, or hardly exceed that of the previous state, or the motion must be within the last
    /// bits of the positions of the nodes. A residual that is round-off is given relative to the sizes of the summands
    /// of the terms.
    pub fn accept(
        &self,
        Residual { value: residual, scale, acting, contact }: Residual,
        part: &'static str,
        round_off: impl Fn(Rounded) -> f64,
    ) -> Result<f64, StepError> {
        if residual <= ACCEPTED {
            return Ok(residual);
        }
        // A body on which nothing acts goes back to rest: what is left of its displacement is round-off of that before.
        let before = || if acting == 0.0 && contact == 0.0 { round_off(Rounded::Before) } else { 0.0 };
        let here = round_off(Rounded::Here).max(before());
        let acting = if contact > ROUNDINGS * here { acting.max(contact) } else { acting };
        let may_be_left = || {
            let prescribed = || round_off(Rounded::Prescribed) / f64::EPSILON;
            is_small(here, acting)
                || (acting == 0.0
                    && (here <= grown(round_off(Rounded::Before))
                        || is_small(here, prescribed())
                        || here <= ROUNDINGS * f64::EPSILON * round_off(Rounded::Places)))
        };
        if residual * scale <= ROUNDINGS * here && may_be_left() {
            return Ok(f64::EPSILON * (residual * scale / here));
        }
        Err(StepError::Residual { step: self.n, t: self.t, part, residual, accepted: ACCEPTED })
    }

    /// A tangent that could not be factorized.
    pub fn singular(&self, source: SolveError) -> StepError {
        StepError::Singular { step: self.n, t: self.t, source }
    }

    /// A linear system that was not solved.
    pub fn unsolved(&self, part: &'static str, source: SolveError) -> StepError {
        StepError::Linear { step: self.n, t: self.t, part, source }
    }

    /// Number of such parts in a whole step: 1, or 2, 4, … if the step was halved.
    fn parts(&self) -> usize {
        (self.whole[1] / self.rule.k).round() as usize
    }

    /// A problem on Γ_C that was not solved.
    pub fn failed(&self, part: &'static str, why: Failure) -> StepError {
        match why {
            Failure::NotConverged(why) => {
                let (unsettled, slides) = (self.unsettled(&why), self.slides(&why));
                let (step, parts) = (self.n, self.parts());
                StepError::NotConverged { step, t: self.t, part, parts, why: Box::new(why), unsettled, slides }
            }
            Failure::Linear(source) => self.unsolved(part, source),
            Failure::Driven(driven) => {
                let motions = self.motions(&driven).join("; ");
                StepError::Driven { step: self.n, t: self.t, motions }
            }
            Failure::Unborne { drive, reached } => {
                let key = if drive.direction.is_some() { "obstacle.load" } else { "preload" };
                let at = format!("{}.{key}", self.problem.contact_path(drive.contact));
                StepError::Unborne { step: self.n, t: self.t, at, force: drive.force, reached }
            }
        }
    }

    /// Rigid motions in words.
    pub fn motions(&self, motions: &[Undetermined]) -> Vec<String> {
        let sums: Vec<Vec<f64>> = motions.iter().map(|motion| motion.sum.clone()).collect();
        described(&self.problem.mesh, &self.loose.motions, &sums)
    }

    /// True if no point sticks at the last iterate of a body without inertia that is supported by contact only.
    fn slides(&self, why: &NotConverged) -> bool {
        if why.states.is_empty() || self.inertia() != 0.0 {
            return false;
        }
        let stuck = self.boundary.points.iter().zip(&why.states).filter(|(_, status)| **status == Status::Stick);
        let stuck: BTreeSet<u32> = stuck
            .flat_map(|(point, _)| point.nodes.iter().filter_map(|&(i, _)| self.boundary.nodes.get(i).copied()))
            .collect();
        let parts = components(&self.problem.mesh);
        let motions = rigid_motions(self.problem, &parts);
        let mut free = parts.iter().zip(motions).filter(|(_, motions)| *motions > 0);
        free.any(|(part, _)| part.nodes.iter().all(|node| !stuck.contains(node)))
    }

    /// The first contact points that did not settle: position, side, laws, states of the last iterates.
    fn unsettled(&self, why: &NotConverged) -> String {
        const TOLD: usize = 3;
        let name = |law: String| law.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default().to_owned();
        let one = |(i, states): &(usize, Vec<Status>)| {
            let point = self.boundary.points.get(*i)?;
            let contact = self.problem.contacts.get(point.contact)?;
            let laws = [format!("{:?}", contact.normal), format!("{:?}", contact.friction)].map(name).join(", ");
            let states: Vec<&str> = states.iter().map(|status| status.name()).collect();
            let [x, y, z] = point.x;
            Some(format!("({x}, {y}, {z}) on \"{}\" ({laws}): {}", contact.on, states.join(", ")))
        };
        let told: Vec<String> = why.unsettled.iter().filter_map(one).take(TOLD).collect();
        if told.is_empty() {
            return String::new();
        }
        let count = why.unsettled.len();
        let points = if count == 1 { "point does" } else { "points do" };
        format!("; {count} contact {points} not settle: {}", told.join("; "))
    }
}

/// Rule for the refactorization of a matrix that changes from iteration to iteration.
///
/// A factorization costs as much as many iterations with its factor, and the matrix changes little from step to step:
/// it is kept as long as the residual decreases fast. Refactorization may not help at a kink of a law; the interval
/// between two doubles each time.
#[derive(Default)]
pub(crate) struct Renewal {
    passes: usize,
    wait: usize,
}

/// Ratio of two consecutive residuals above which the matrix is refactorized.
const SLOW: f64 = 0.1;

impl Renewal {
    /// True if an iteration whose matrix is not that of the iterate has reached the round-off of the residual. The sums
    /// of the audit use every entry of the iterate, so it is not accepted merely because it happens to be near.
    pub fn has_ended(residual: f64, ratio: f64) -> bool {
        residual <= f64::EPSILON || (residual <= REFINE && ratio > 0.25) || (residual <= ACCEPTED && ratio > 0.5)
    }

    /// True if an iteration that multiplied the residual by `ratio` calls for a new factor.
    pub fn is_due(&mut self, ratio: f64) -> bool {
        self.passes += 1;
        if ratio <= SLOW || self.passes <= self.wait {
            return false;
        }
        (self.passes, self.wait) = (0, (2 * self.wait).max(1));
        true
    }
}

/// Products of a state with the forms, which one step computes and the next one needs.
#[derive(Debug)]
pub(crate) struct Products {
    /// t_n of the state.
    pub t: f64,
    /// (ρ·, ·), or (·, ·) if the density is uniform.
    pub mass_w: Vec<f64>,
    pub a_u: Vec<f64>,
    /// a(w, ·); empty if a is not linear.
    pub a_w: Vec<f64>,
    pub b_w: Vec<f64>,
    pub mass_theta: Vec<f64>,
    pub d_theta: Vec<f64>,
}

impl Products {
    /// The products of a state.
    pub fn of(discrete: &Discretization, state: &State) -> Products {
        let warmed = discrete.warmed(&state.theta);
        let [mass_w, a_u, a_w, b_w] = discrete.mechanical_products(state.deformation(), &state.w, &warmed);
        let [mass_theta, d_theta] = discrete.thermal_products(&state.theta);
        Products { t: state.t, mass_w, a_u, a_w, b_w, mass_theta, d_theta }
    }
}

/// A matrix of a half-step with the unknowns of its contact nodes.
#[derive(Debug)]
pub(crate) struct HalfStep {
    pub system: System,
    /// The kept unknown of each degree of freedom of the contact nodes, followed by the motions of rigid bodies, or
    /// `None` if it is prescribed.
    pub on_contact: Vec<Option<u32>>,
    /// The temperature at which the matrix was refactorized; empty if it is the initial one or does not matter.
    pub at: Vec<f64>,
}

impl HalfStep {
    /// Replaces the matrix by that of a temperature and factorizes it; `theta` is empty if the temperature does not
    /// matter.
    pub fn replace(&mut self, matrix: BlockMatrix, theta: &[f64]) -> Result<(), SolveError> {
        self.system.replace(&Arc::new(matrix))?;
        self.at = theta.to_vec();
        Ok(())
    }

    /// Factorizes a matrix with the contact unknowns last.
    pub fn new(
        matrix: BlockMatrix,
        discrete: &Discretization,
        space: &Space,
        backend: &Arc<dyn Backend>,
    ) -> Result<HalfStep, SolveError> {
        let (contact, components) = (&discrete.boundary.nodes, space.components);
        let system = System::new(backend, &Arc::new(matrix), &Layout::of(&discrete.mesh, space, contact))?;
        let position = system.unknowns().positions(space.free.len());
        // The motions follow all nodes and belong to no node.
        let is_motion = |(i, node): (usize, u32)| (node, i >= contact.len() || !space.is_rigid(node));
        let count = if contact.is_empty() { 0 } else { usize::MAX };
        let seen = space.with_rigid(contact).take(count).enumerate().map(is_motion);
        let dofs = seen.flat_map(|(node, is)| (0..components).map(move |c| (node as usize * components + c, is)));
        let on_contact = dofs.map(|(dof, is)| position[dof].filter(|_| is)).collect();
        Ok(HalfStep { system, on_contact, at: Vec::new() })
    }

    /// The motions of the parts that are supported by contact only.
    pub fn motions(&self, problem: &Problem, discrete: &Discretization) -> Loose {
        let Discretization { mesh, boundary, v, .. } = discrete;
        Loose::new(mesh, boundary, &problem.contacts, v, (&self.on_contact, &floating(problem)))
    }
}

/// Solves a problem without contact: the increment over the guess, plus the guess. A backend may keep unknowns of the
/// body.
pub(crate) fn without_contact(
    condensed: &mut dyn Condensed,
    r: &[f64],
    guess: &[f64],
) -> Result<(Vec<f64>, usize), Failure> {
    let mut x = r.to_vec();
    if !x.is_empty() {
        condensed.solve(&Tangent::new(), &mut x, EXACT)?;
        x.iter_mut().zip(guess).for_each(|(x, guess)| *x += guess);
    }
    Ok((x, 0))
}

/// Σ ω Nᵀ f over all degrees of freedom, of vectors at the contact points, or of scalars in their first components.
pub(crate) fn on_degrees(boundary: &ContactBoundary, space: &Space, vectors: impl Iterator<Item = Point>) -> Vec<f64> {
    let mut sum = zeros(space.free.len());
    boundary.scatter(space.components, vectors, &mut sum);
    sum
}

/// The resultant of σν on Γ_C, and Σ ω Nᵀ (p ν + q) over all degrees of freedom.
pub(crate) fn contact_forces(step: &Step, states: &[PointState]) -> (Point, Vec<f64>) {
    let Step { discrete, boundary, .. } = *step;
    let force =
        |state: &PointState| -> Point { std::array::from_fn(|c| state.pressure * state.normal[c] + state.q[c]) };
    let mut resultant = [0.0; 3];
    for (point, state) in boundary.points.iter().zip(states) {
        let weight = point.weight * step.contacts[point.contact].sign();
        for (sum, force) in resultant.iter_mut().zip(force(state)) {
            *sum -= weight * force;
        }
    }
    (resultant, on_degrees(boundary, &discrete.v, states.iter().map(force)))
}

/// Combines numbers per block of the vectors: the largest of the first ones and the sums of the others.
pub(crate) fn over_blocks<const N: usize, const M: usize>(blocks: &[([f64; N], [f64; M])]) -> ([f64; N], [f64; M]) {
    let most = |i: usize| blocks.iter().fold(0.0, |most, (largest, _)| larger(most, largest[i]));
    (std::array::from_fn(most), std::array::from_fn(|i| blocks.iter().map(|(_, sums)| sums[i]).sum()))
}

/// a − b.
pub(crate) fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    map([a, b], |[a, b]| a - b)
}
