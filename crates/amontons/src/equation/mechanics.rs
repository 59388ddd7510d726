//! The mechanical half-step (4.1).

use std::borrow::Cow;
use std::sync::Arc;

use super::StepError;
use super::apart::Whole;
use super::fluid::Pools;
use super::given::Given;
use super::iterate::{Hold, Iterate, begun, products_apart};
use super::massless::{Massless, reactions};
use super::power::{PowerTerms, Powers};
use super::system::{
    ACCEPTED, HalfStep, REFINE, Renewal, Rounded, Step, contact_forces, on_degrees, over_blocks, without_contact,
};
use crate::discretization::Warmed;
use crate::inclusion::residual::Residual;
use crate::inclusion::{Drive, Drives, Frame, Multipliers, PointDerivative, PointState, Solved};
use crate::linalg::{SolveError, Tangent, by_blocks, copy, dot, join, map, map_block, max_abs, zeros};
use crate::state::{Rigid, State};
use crate::tensor::Point;

/// A solved mechanical half-step.
pub(crate) struct Mechanics {
    /// The equation at the solution.
    pub end: Balanced,
    /// The motion with the rigid motions of the bodies, if these are split off.
    pub whole: Option<Whole>,
    /// z of the relaxing branches at the time of the equations; empty without branches.
    pub branches: Vec<Vec<f64>>,
    /// True if softening laws allow only one solution between the previous state and this one.
    pub is_unique: bool,
    /// Newton iterations on Γ_C, and sweeps.
    pub iterations: usize,
    pub sweeps: usize,
    /// Residual relative to the largest term of the equation, or to the summands of the terms if it is round-off.
    pub residual: f64,
    /// The contact points that fluids wet.
    pub wet: Vec<bool>,
    /// The temperature used by the half-step, and its m(θ, ·).
    pub theta: Vec<f64>,
    pub thermal: Vec<f64>,
    /// Data of the contact points.
    pub given: Given,
}

/// Work done on the other threads while the mechanical half-step is solved.
pub(crate) trait Beside: Send {
    /// Runs in parallel with the contact, which takes one thread.
    fn with_contact(&mut self) {}

    /// Runs in parallel with the backward sweep and the balance, with the states of the contact points. It is called in
    /// every iteration if the laws of the body are linear; the states of the last iteration are those of the solution.
    fn with_rest(&mut self, _states: &[PointState]) {}
}

/// No parallel work.
impl Beside for () {}

/// Most iterations over the body, and the shortest fraction of an iteration that is tried.
const ITERATIONS: usize = 50;
const SHORTEST_STEP: f64 = 1.0 / 256.0;
/// Ratio of two consecutive residuals above which the tangent is recomputed.
const SLOW: f64 = 0.01;

impl Mechanics {
    /// Solves (4.1) with the temperature `theta` in m, from the velocity w_{n−1} or from a solution of the same
    /// step with another temperature.
    ///
    /// The step is solved for the increment over the current velocity, with the contact solved inside. For a linear
    /// body one iteration suffices; another one removes the round-off of the sweeps. For a nonlinear law the iterations
    /// are Newton's method over the body, and K_u is the tangent at the current velocity. If laws are linear and depend
    /// on the temperature, K_u is that of an earlier temperature as long as the iterations converge fast.
    ///
    /// `beside` is called in every iteration, as [`Beside`] says.
    pub fn solve(
        step: &Step,
        half: &mut HalfStep,
        theta: &[f64],
        from: Option<&Mechanics>,
        beside: &mut dyn Beside,
    ) -> Result<Mechanics, StepError> {
        let discrete = step.discrete;
        let is_linear = discrete.is_linear();
        let warmed = discrete.warmed(theta);
        let (wet, given, mut now) = match from {
            None => {
                let (given, now) = begun(step, &warmed);
                (&step.old.surface.wet.points, given, now)
            }
            Some(from) => (&from.wet, from.given.clone(), from.again(step, &warmed)),
        };
        let mut equation = Equation::new(step, wet.clone(), given, (theta, warmed))?;
        let (mut newton, mut passes) = (0, 0);
        let (mut previous, mut renewal) = (f64::INFINITY, Renewal::default());
        // K_u depends on the temperature only.
        let softens = !is_linear && discrete.is_linear_at_each_temperature();
        let mut is_stale = !is_linear && !softens;
        loop {
            if is_stale {
                let u = step.deformed(&now.w);
                let tangent = discrete.mechanical_tangent(step.rule, &u, &now.w, &equation.warmed);
                let at = if softens { theta } else { &[] };
                half.replace(tangent, at).map_err(|source| step.singular(source))?;
            }
            let settled = equation.settle(half, &now, beside)?;
            newton += settled.iterations;
            if let Some(pools) = step.spread(&equation.pools, &settled.found.states) {
                equation.pour(pools);
                continue;
            }
            passes += 1;
            equation.given.advance(step, &settled.drives, &settled.lengths);
            let next = if is_linear {
                let states = settled.found.states.clone();
                let expand = || equation.expand(half, &now, settled);
                join(half.system.is_collective(), expand, || beside.with_rest(&states)).0?
            } else {
                let next = equation.expand(half, &now, settled)?;
                equation.shortened(half, &now, next, previous)?
            };
            let (residual, ratio) = (next.residual.value, next.residual.value / previous);
            let goes_on =
                if is_linear { ratio < 0.5 } else { passes < ITERATIONS && (ratio < 0.5 || residual > ACCEPTED) };
            let has_ended = if softens { Renewal::has_ended(residual, ratio) } else { residual <= REFINE };
            if has_ended || !goes_on {
                return equation.found(half, next, [newton, 2 * passes]);
            }
            is_stale = if softens { renewal.is_due(ratio) } else { !is_linear && ratio > SLOW };
            previous = residual;
            now = next.at;
        }
    }

    /// The displacement at the time of the equations.
    pub fn u(&self) -> &[f64] {
        self.whole.as_ref().map_or(&self.end.u, |whole| &whole.u)
    }

    /// The velocity.
    pub fn w(&self) -> &[f64] {
        self.whole.as_ref().map_or(&self.end.at.w, |whole| &whole.w)
    }

    /// The part of the velocity that determines the strain rates.
    pub fn moving(&self) -> &[f64] {
        &self.end.at.w
    }

    /// The displacement that determines the strains.
    pub fn deformed(&self) -> &[f64] {
        &self.end.u
    }

    /// The data of the contact points that belong to [`Mechanics::moving`].
    fn seen(&self) -> &Given {
        self.whole.as_ref().map_or(&self.given, |whole| &whole.relative)
    }

    /// The iterate from which the half-step is solved again with another temperature.
    fn again(&self, step: &Step, warmed: &Warmed) -> Iterate<'_> {
        let at = &self.end.at;
        if step.discrete.softens() {
            let products = step.discrete.mechanical_products(self.u(), &step.rates(&at.w), warmed);
            return Iterate::new(step, at.w.clone(), at.multipliers.clone(), products);
        }
        Iterate {
            w: at.w.clone(),
            rigid: at.rigid.clone(),
            multipliers: at.multipliers.clone(),
            mass_w: Cow::Borrowed(&at.mass_w),
            a_u: Cow::Borrowed(&at.a_u),
            a_w: Cow::Borrowed(&at.a_w),
            b_w: Cow::Borrowed(&at.b_w),
            relaxing: at.relaxing.clone(),
            hold: at.hold.clone(),
        }
    }

    /// Factorizes K_u at the solution.
    pub fn renew(&self, step: &Step, half: &mut HalfStep) -> Result<(), SolveError> {
        let warmed = step.discrete.warmed(&self.theta);
        let tangent = step.discrete.mechanical_tangent(step.rule, self.u(), self.w(), &warmed);
        half.replace(tangent, &self.theta)
    }

    /// True if softening laws allow a step only one solution between w_{n−1} and the velocity of a state.
    pub fn is_unique(step: &Step, half: &mut HalfStep, end: &State) -> Result<bool, StepError> {
        let temperature = step.boundary.scalars_on(step.contacts, &step.old.theta);
        let given = Given::new(step, &end.w).at(temperature);
        given
            .is_unique(step, half, [&step.old.w, &end.w], &end.multipliers)
            .map_err(|source| step.unsolved("mechanics", source))
    }

    /// Σ ω Nᵀ of the change of the contact forces if their laws use other temperatures of the side `on`.
    pub fn contact_change(&self, step: &Step, half: &HalfStep, temperature: &[f64]) -> Vec<f64> {
        let w = half.system.kept_of(self.moving());
        let tractions = |given: &Given| {
            given
                .term(step, &half.system, &half.on_contact)
                .map_or_else(Vec::new, |term| term.tractions(&w, &self.end.at.multipliers))
        };
        let (now, then) = (tractions(self.seen()), tractions(&self.seen().clone().at(temperature.to_vec())));
        let change = now.iter().zip(&then).map(|(now, then)| std::array::from_fn(|c| then[c] - now[c]));
        let mut change = on_degrees(step.boundary, &step.discrete.v, change);
        let share = step.rule.contact_share();
        for force in &mut change {
            *force *= share;
        }
        change
    }

    /// The derivatives of the contact forces at the solution: their contribution to S, and the derivative at each
    /// contact point.
    pub fn contact_tangent(&self, step: &Step, half: &mut HalfStep) -> (Tangent, Vec<PointDerivative>) {
        let w = half.system.kept_of(self.moving());
        let HalfStep { system, on_contact, .. } = half;
        let term = self.seen().term(step, system, on_contact);
        term.map_or_else(Default::default, |mut term| {
            term.tangent(system.condensed_mut(), &w, &self.end.at.multipliers)
        })
    }
}

/// Equation (4.1) in a step, with the data known before it is solved.
struct Equation<'a> {
    step: &'a Step<'a>,
    /// The loads without and with the pressure of fluids, those with what the equations of nodes without mass have
    /// more, and the wet points.
    dry: Arc<Vec<f64>>,
    applied: Arc<Vec<f64>>,
    load: Arc<Vec<f64>>,
    massless: Option<Massless>,
    pools: Pools,
    /// The temperature of the body, its laws there, and m(θ, ·).
    theta: &'a [f64],
    warmed: Warmed<'a>,
    thermal: Vec<f64>,
    given: Given,
}

impl<'a> Equation<'a> {
    /// The equation with the temperature `theta` in m and in the laws of the body and of contact.
    fn new(
        step: &'a Step,
        wet: Vec<bool>,
        mut given: Given,
        (theta, warmed): (&'a [f64], Warmed<'a>),
    ) -> Result<Equation<'a>, StepError> {
        given.temperature = step.boundary.scalars_on(step.contacts, theta);
        let numbers = |Frame { gap, gap_rate, normal: n, velocity: v, .. }: &Frame| {
            [*gap, *gap_rate, n[0], n[1], n[2], v[0], v[1], v[2]]
        };
        step.finite(&given.frames.iter().flat_map(numbers).collect::<Vec<f64>>(), "the foundation")?;
        let (dry, thermal) = (step.load(), step.discrete.thermal_force(theta));
        let ([applied, load], pools) = ([&dry, &dry].map(Arc::clone), Pools::default());
        let massless = Massless::of(step, &dry);
        let mut equation = Equation { step, dry, applied, load, massless, pools, theta, warmed, thermal, given };
        equation.pour(Pools { left: vec![false; wet.len()], wet });
        Ok(equation)
    }

    /// Sets the contact points wet by fluids.
    fn pour(&mut self, pools: Pools) {
        let step = self.step;
        self.applied = step.with_fluid(&self.dry, &pools.wet, &self.given.frames);
        let with_more = |massless: &Massless| Arc::new(massless.load(&self.applied));
        self.load = self.massless.as_ref().map_or_else(|| Arc::clone(&self.applied), with_more);
        self.given.loads = step.loose.loads(&step.discrete.mesh, &self.load);
        self.pools = pools;
    }

    /// The scale ρ/δ of the inertia term.
    fn inertia(&self) -> f64 {
        self.step.inertia() / self.step.rule.delta
    }

    /// The terms of (4.1) at an iterate that [`right_hand_side`] sums: all but those of contact and of the branches.
    fn terms<'t>(&'t self, at: &'t Iterate) -> [&'t [f64]; 6] {
        [&self.load, &self.thermal, &at.mass_w, self.step.bar.mass_w, &at.b_w, &at.a_u]
    }

    /// The right-hand side for the increment over the velocity of an iterate, without contact.
    fn right(&self, at: &Iterate) -> Vec<f64> {
        let inertia = self.inertia();
        let right = map(self.terms(at), |terms| right_hand_side(inertia, terms));
        if at.relaxing.is_empty() { right } else { map([&right, &at.relaxing], |[right, relaxing]| right - relaxing) }
    }

    /// The data of the contact points relative to the split-off rigid motions, with δ increased by `lengths`.
    fn seen(&self, now: &Iterate, drives: &[Drive], lengths: &[f64]) -> Cow<'_, Given> {
        let given = if drives.is_empty() {
            Cow::Borrowed(&self.given)
        } else {
            Cow::Owned(self.given.advanced(self.step, drives, lengths))
        };
        if self.step.apart.is_none() { given } else { Cow::Owned(given.relative(self.step, &now.rigid, &now.w)) }
    }

    /// Makes the forward sweep and solves the contact.
    fn settle(&self, half: &mut HalfStep, now: &Iterate, beside: &mut dyn Beside) -> Result<Settled, StepError> {
        let step = self.step;
        let right = self.right(now);
        step.finite(&right, "the data")?;
        let HalfStep { system, on_contact, .. } = half;
        let given = self.seen(now, &[], &[]);
        let mut term = given.term(step, system, on_contact);
        let guess = system.kept_of(&now.w);
        let mut multipliers = now.multipliers.clone();
        let mut x = system.reduce(&right).map_err(|source| step.unsolved("mechanics", source))?;
        let drives = step.drives(&self.given.advance);
        let frames = |lengths: &[f64]| self.seen(now, &drives, lengths).into_owned().frames;
        let driven = Drives { all: &drives, frames: &frames };
        let is_collective = system.is_collective();
        let (Solved { iterations, loose, held, .. }, lengths) = system
            .settle(&mut x, &now.w, |condensed, r| {
                let contact = || {
                    let Some(term) = &mut term else {
                        let (x, iterations) = without_contact(condensed, r, &guess)?;
                        return Ok((x, (Solved { iterations, ..Solved::default() }, Vec::new())));
                    };
                    let (mut solved, lengths) = term.solve_driven(condensed, [r, &guess], &mut multipliers, &driven)?;
                    Ok((std::mem::take(&mut solved.x), (solved, lengths)))
                };
                join(is_collective, contact, || beside.with_contact()).0
            })
            .map_err(|why| step.failed("mechanics", why))?;
        let increments = &x[system.unknowns().interior..];
        let kept: Vec<f64> = guess.iter().zip(increments).map(|(value, change)| value + change).collect();
        let advanced = (!drives.is_empty()).then(|| self.seen(now, &drives, &lengths));
        if let Some(given) = &advanced {
            term = given.term(step, system, on_contact);
        }
        let states = term.map_or_else(Vec::new, |term| term.point_states(&kept, &multipliers));
        let forces = if held.is_empty() { held } else { system.unknowns().forces(&held, now.w.len()) };
        let found = Found { multipliers, states, hold: Hold { loose, forces } };
        Ok(Settled { x, found, iterations, drives, lengths })
    }

    /// Makes the backward sweep and evaluates the residual of (4.1) with the resulting velocity.
    fn expand(&self, half: &HalfStep, now: &Iterate, settled: Settled) -> Result<Balanced, StepError> {
        let Settled { x, found, .. } = settled;
        let w = half.system.expand(x, &now.w).map_err(|source| self.step.unsolved("mechanics", source))?;
        self.step.finite(&w, "mechanics")?;
        self.balance(w, &now.rigid, found)
    }

    /// The residual of (4.1) tested with every basis function; at prescribed nodes it is the reaction.
    fn balance(&self, mut v: Vec<f64>, rigid: &[Rigid], found: Found) -> Result<Balanced, StepError> {
        let Found { multipliers, states, hold } = found;
        let Step { discrete, rule, .. } = *self.step;
        let k = rule.moving();
        // The rigid motion added by the iteration moves from v to W.
        let more = self.step.take(&mut v);
        let rigid: Vec<Rigid> = rigid.iter().zip(&more).map(|(a, b)| a.and(b)).collect();
        let (force, mut contact_force) = contact_forces(self.step, &states);
        self.massless.iter().for_each(|massless| massless.share(&mut contact_force));
        let rigid = self.step.driven(&rigid, &v, [&self.load, &contact_force], &states);
        let whole = self.step.apart.map(|_| self.step.with_rigid(&rigid, &v));
        let w: &[f64] = whole.as_ref().unwrap_or(&v);
        let u = self.step.deformed(&v);
        let (inertia, mut rest) = (self.inertia(), zeros(v.len()));
        // Per block of the terms: the residual of (4.1), the largest entries, and the sums of the audit.
        let of_block = |first: usize, [mass_w, a_u, b_w]: [&[f64]; 3], rest: &mut [f64]| {
            let [load, thermal, bar, force, applied] =
                [&*self.load, &self.thermal, self.step.bar.mass_w, &contact_force, &self.applied]
                    .map(|v| &v[first..first + mass_w.len()]);
            let [u, w, v] = [&*u, w, &*v].map(|v| &v[first..first + mass_w.len()]);
            let largest = map_block([force, load, thermal, mass_w, bar, b_w, a_u], rest, |[force, terms @ ..]| {
                force - right_hand_side(inertia, terms)
            });
            let terms = PowerTerms { first, u, w, v, mass_w, a_u, b_w, thermal, load: applied };
            (largest, Powers::of_block(self.step, &terms))
        };
        let (products, blocks) = if self.step.apart.is_some() {
            let products = products_apart(self.step, [&u, &v], &rigid, &self.warmed);
            let [mass_w, a_u, _, b_w] = &products;
            let blocks = by_blocks([mass_w, a_u, b_w], &mut rest, of_block);
            (products, blocks)
        } else {
            discrete.mechanical_products_then([&u, &self.step.rates(&v)], &self.warmed, &mut rest, of_block)
        };
        let rates = discrete.v.prescribed_of(w);
        let held_work = k * dot(&hold.forces, &w[..hold.forces.len()]);
        let more = self.massless.as_ref().map_or(0.0, |massless| k * massless.power(self.step, &states, w));
        rest.iter_mut().zip(&hold.forces).for_each(|(rest, force)| *rest -= force);
        let at = Iterate { rigid, hold, ..Iterate::new(self.step, v, multipliers, products) };
        let (largest, powers) = over_blocks(&blocks);
        rest.iter_mut().zip(&at.relaxing).for_each(|(rest, relaxing)| *rest += relaxing);
        discrete.v.gather(&mut rest);
        let (reactions, [reaction_work, added]) = reactions(self.massless.as_ref(), &discrete.v, &rest, (&rates, k));
        let (support_work, massless_work) = (reaction_work + held_work, more - added);
        discrete.v.mask(&mut rest);
        let residual = self.residual(&rest, largest, [&at.relaxing, &contact_force])?;
        Ok(Balanced {
            at,
            u,
            states,
            residual,
            force,
            reactions,
            support_work,
            massless_work,
            powers: Powers::new(powers),
        })
    }

    /// The residual with the largest entries of its terms.
    fn residual(
        &self,
        rest: &[f64],
        [_, load, thermal, mass_w, bar, b_w, a_u]: [f64; 7],
        [relaxing, contact_force]: [&[f64]; 2],
    ) -> Result<Residual, StepError> {
        let (step, inertia) = (self.step, self.inertia());
        let known = step.drives(&self.given.advance).iter().map(|drive| step.at_points(drive)).fold(load, f64::max);
        let acting = (inertia * mass_w.max(bar)).max(thermal).max(known);
        let contact = step.discrete.v.largest_at(&step.boundary.nodes, contact_force);
        let scale = [b_w, a_u, max_abs(relaxing)].into_iter().fold(acting.max(contact), f64::max);
        let value = step.relative(max_abs(rest), scale, "mechanics")?;
        Ok(Residual { value, scale, acting, contact })
    }

    /// The iterate `next`. If its residual exceeds the previous one, the best of ever shorter fractions of the way to
    /// it, because a nonlinear law may overshoot.
    fn shortened(
        &self,
        half: &HalfStep,
        now: &Iterate,
        mut next: Balanced,
        previous: f64,
    ) -> Result<Balanced, StepError> {
        let mut alpha = 0.5;
        while next.residual.value > previous && alpha >= SHORTEST_STEP {
            let part = |old: f64, new: f64| old + alpha * (new - old);
            let w: Vec<f64> = now.w.iter().zip(&next.at.w).map(|(old, new)| part(*old, *new)).collect();
            let multipliers = now.multipliers.towards(&next.at.multipliers, alpha);
            let states = self.given.states(self.step, half, &w, &multipliers);
            let hold = now.hold.towards(&next.at.hold, alpha);
            let shorter = self.balance(w, &now.rigid, Found { multipliers, states, hold })?;
            if shorter.residual.value < next.residual.value {
                next = shorter;
            }
            alpha *= 0.5;
        }
        Ok(next)
    }

    /// The solution, if its residual is accepted.
    fn found(
        self,
        half: &mut HalfStep,
        end: Balanced,
        [iterations, sweeps]: [usize; 2],
    ) -> Result<Mechanics, StepError> {
        let Equation { step, pools, theta, thermal, given, .. } = self;
        let (v, rigid) = (&end.at.w, &end.at.rigid);
        let round_off = |w: &[f64], sizes: &[f64]| step.discrete.mechanical_round_off(sizes, w, theta);
        let residual = step.accept(end.residual, "mechanics", |of| match of {
            Rounded::Here => round_off(v, &step.sizes(v)),
            Rounded::Before => round_off(step.bar.w, &step.sizes(step.bar.w)),
            Rounded::Prescribed => {
                let (mut w, mut sizes) = (v.clone(), step.sizes(v));
                step.discrete.v.mask_free(&mut w);
                step.discrete.v.mask_free(&mut sizes);
                given.put_foundations(step, [&mut w, &mut sizes]);
                round_off(&w, &sizes)
            }
            Rounded::Places => {
                let places = step.discrete.mesh.points.iter();
                let sizes: Vec<f64> =
                    places.flat_map(|x| x.iter().take(step.discrete.mesh.dim)).map(|x| x.abs()).collect();
                round_off(&zeros(sizes.len()), &sizes)
            }
        })?;
        let whole = step.apart.map(|_| step.whole(rigid, &end.u, v, given.relative(step, rigid, v)));
        let (seen, from) = match &whole {
            None => (&given, Cow::Borrowed(&step.old.w)),
            Some(whole) => (&whole.relative, Cow::Owned(step.less_rigid(rigid, &step.old.w))),
        };
        let is_unique = seen
            .is_unique(step, half, [&from, v], &end.at.multipliers)
            .map_err(|source| step.unsolved("mechanics", source))?;
        Ok(Mechanics {
            branches: step.branches(v),
            whole,
            is_unique,
            iterations,
            sweeps,
            residual,
            wet: pools.wet,
            theta: copy(theta),
            thermal,
            given,
            end,
        })
    }
}

/// The sum of the terms of (4.1) without contact.
fn right_hand_side(inertia: f64, [load, thermal, mass_w, bar, b_w, a_u]: [f64; 6]) -> f64 {
    load + thermal - inertia * (mass_w - bar) - b_w - a_u
}

/// An iteration whose contact is solved: the increments on Γ_C with the reduced values of the body, and the contact
/// points.
struct Settled {
    x: Vec<f64>,
    found: Found,
    /// Newton iterations on Γ_C.
    iterations: usize,
    /// The driven contacts, and by how much their δ has grown, m.
    drives: Vec<Drive>,
    lengths: Vec<f64>,
}

/// Solution on Γ_C.
struct Found {
    multipliers: Multipliers,
    states: Vec<PointState>,
    hold: Hold,
}

/// An iterate with the residual of (4.1).
#[derive(Default)]
pub(crate) struct Balanced {
    pub at: Iterate<'static>,
    /// ū + γ w of the iterate.
    pub u: Vec<f64>,
    pub states: Vec<PointState>,
    /// Residual, whose acting terms are loads, forces of driven contacts, heat and inertia.
    pub residual: Residual,
    /// Resultant of σν on Γ_C.
    pub force: Point,
    /// Reactions of the supports, one number per prescribed degree of freedom, N; their work in the step, J.
    pub reactions: Vec<f64>,
    pub support_work: f64,
    /// Work in the step of what the equations of nodes without mass have more than those at t_ϑ, J.
    pub massless_work: f64,
    /// The sums that the audit needs.
    pub powers: Powers,
}
