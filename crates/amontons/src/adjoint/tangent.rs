//! One step of the sweep from the start of a run to its end.

use std::borrow::Cow;

use super::balances::largest_traction;
use super::bordered::{Bordered, BorderedPoint, BorderedRight, IDENTITY, Pushed, bears, jump};
use super::driven::{LinearDrive, Shifted, turned};
use super::error::GradientError;
use super::factors::{BodySlopes, StepFactors, coupled};
use super::instance::{BodyResidual, ProblemInstance, SolvedStep, StepResidual};
use super::lumped::{both_sides, sides_of, takes_friction, warmed};
use super::points::{INPUTS, LinearPoint, OUTPUTS};
use super::stencil;
use super::sweep::{Around, LinearStep, OfPoints, ahead};
use super::transpose::{heat_tangent, onto_sides};
use super::vector::StateVector;
use super::worn::{add_lists, grown, of_pairs_or, seen};
use crate::contact::{Flux, PointOnBoundary};
use crate::discretization::Discretization;
use crate::equation::heat::lumped;
use crate::equation::system::Step;
use crate::inclusion::Local;
use crate::linalg::{BlockMatrix, SolveError, max_abs, zeros};
use crate::space::Space;
use crate::time::Start;

/// The derivative by a parameter, at fixed unknowns, of the equations of a step and of what follows from them.
pub(super) struct ResidualSlope {
    mechanics: Vec<f64>,
    heat: Vec<f64>,
    rates: Vec<f64>,
    temperatures: Vec<f64>,
    defects: Vec<Local>,
    worn: Vec<f64>,
    work: Vec<f64>,
    theta_rate: Vec<f64>,
    u: Vec<f64>,
    branches: Vec<Vec<f64>>,
    lacking: Vec<f64>,
    missing: Vec<f64>,
    /// Of the depths of the vertices of all sides, one side after the other.
    grown: Vec<f64>,
}

impl ResidualSlope {
    /// The derivative, and how much of a kink there is, as [`stencil::central`] has it, without round-off; `None` if a
    /// difference leaves the branch of a contact point on both sides.
    pub fn of(
        around: &Around,
        discrete: &Discretization,
        points: &[LinearPoint],
    ) -> Option<(ResidualSlope, Option<ResidualSlope>)> {
        let here = around.all[2];
        let traction = largest_traction(&here.states);
        let lists = |of: &dyn Fn(&StepResidual) -> &[f64], size: f64| {
            stencil::of_lists(around.h, around.all.map(of), size.max(max_abs(of(here))))
        };
        let is_same = around.have_same_body();
        let over = |of: &dyn Fn(&BodyResidual) -> &[f64], size: f64| {
            if is_same {
                return [zeros(of(&here.body).len()), zeros(of(&here.body).len())];
            }
            lists(&|residual| of(&residual.body), size)
        };
        let [mut mechanics, mut heat] = [over(&|r| &r.mechanics, here.sizes[0]), over(&|r| &r.heat, here.sizes[1])];
        let [exerted, passed] = [lists(&|r| &r.exerted, here.sizes[0]), lists(&|r| &r.passed, here.sizes[1])];
        for k in [0, 1] {
            discrete.boundary.add_restricted(discrete.v.components, &exerted[k], &mut mechanics[k]);
            discrete.boundary.add_restricted(1, &passed[k], &mut heat[k]);
        }
        let [rates, temperatures] = [over(&|r| &r.rates, 0.0), over(&|r| &r.temperatures, 0.0)];
        let [u, rate] = [over(&|r| &r.u, 0.0), over(&|r| &r.theta_rate, 0.0)];
        let work = lists(&|r| &r.work, 0.0);
        let lacking = lists(&|r| &r.lacking, max_abs(&here.driving));
        let missing = lists(&|r| &r.missing, max_abs(&here.warming));
        let [worn, grown] = [lists(&|r| &r.worn, 0.0), lists(&|r| &r.grown, 0.0)];
        let branches: Vec<[Vec<f64>; 2]> =
            (0..here.body.branches.len()).map(|b| over(&|r| &r.branches[b], 0.0)).collect();
        let slopes: Vec<[Local; 2]> =
            points.iter().enumerate().map(|(i, point)| around.slopes(i, point.branch)).collect();
        if slopes.iter().any(|[slope, _]| slope.iter().any(|slope| slope.is_nan())) {
            return None;
        }
        let flat = |k: usize| -> Vec<f64> { slopes.iter().flat_map(|both| both[k]).collect() };
        let defects = stencil::without_round_off([flat(0), flat(1)], traction / around.h);
        let made = |k: usize| ResidualSlope {
            mechanics: mechanics[k].clone(),
            heat: heat[k].clone(),
            rates: rates[k].clone(),
            temperatures: temperatures[k].clone(),
            defects: defects[k].chunks_exact(3).map(|d| [d[0], d[1], d[2]]).collect(),
            worn: worn[k].clone(),
            work: work[k].clone(),
            theta_rate: rate[k].clone(),
            u: u[k].clone(),
            lacking: lacking[k].clone(),
            missing: missing[k].clone(),
            grown: grown[k].clone(),
            branches: branches.iter().map(|both| both[k].clone()).collect(),
        };
        Some((made(0), Some(made(1)).filter(|kink| !kink.is_zero())))
    }

    /// Adds derivatives of (4.1) and of (4.2) that are known.
    pub fn add(&mut self, known: [Option<Vec<f64>>; 2]) {
        for (to, from) in [&mut self.mechanics, &mut self.heat].into_iter().zip(known) {
            to.iter_mut().zip(from.into_iter().flatten()).for_each(|(to, from)| *to += from);
        }
    }

    fn is_zero(&self) -> bool {
        self.numbers().all(|value| *value == 0.0)
    }

    fn numbers(&self) -> impl Iterator<Item = &f64> {
        let ResidualSlope {
            mechanics, heat, rates, temperatures, defects, worn, work, theta_rate, u, branches, ..
        } = self;
        let ResidualSlope { lacking, missing, grown, .. } = self;
        let lists = [mechanics, heat, rates, temperatures, worn, work, theta_rate, u, lacking, missing, grown];
        let lists = lists.into_iter().chain(branches);
        lists.flatten().chain(defects.iter().flatten())
    }

    /// True if no number is larger than half of that of another one.
    pub fn is_half_of(&self, of: &ResidualSlope) -> bool {
        self.numbers().zip(of.numbers()).all(|(number, of)| number.abs() <= 0.5 * of.abs())
    }

    /// No derivative, of the size of another one.
    pub fn zero(of: &ResidualSlope) -> ResidualSlope {
        let none = |values: &[f64]| zeros(values.len());
        ResidualSlope {
            mechanics: none(&of.mechanics),
            heat: none(&of.heat),
            rates: none(&of.rates),
            temperatures: none(&of.temperatures),
            defects: vec![[0.0; 3]; of.defects.len()],
            worn: none(&of.worn),
            work: none(&of.work),
            theta_rate: none(&of.theta_rate),
            u: none(&of.u),
            lacking: none(&of.lacking),
            missing: none(&of.missing),
            grown: none(&of.grown),
            branches: of.branches.iter().map(|branch| none(branch)).collect(),
        }
    }
}

/// The derivative of the state at the end of a step, and those of the contact points at fixed data: by (p, q),
/// penetration and slip in the bases of the points.
pub(super) type Advanced = (StateVector, OfPoints);

impl LinearStep<'_, Shifted> {
    /// The derivative of the state at the end of the step by that at its start and by the equations:
    /// J dz = −∂R/∂z₀ dz₀ − ∂R/∂m.
    pub fn forward(
        &self,
        factors: &mut StepFactors,
        (start, before): (&StateVector, Option<&StateVector>),
        by: &ResidualSlope,
    ) -> Result<Advanced, GradientError> {
        let (base, solved, n) = (self.base, &self.solved, self.solved.n);
        let before = before.filter(|_| factors.rule.start == Start::TwoStates);
        let mixed = before.map(|before| StateVector::mixed(start, before));
        let start = Started { start, bar: mixed.as_ref().unwrap_or(start), before };
        let failed = |part| move |source| GradientError::Linear { step: n, part, source };
        let theta = if factors.is_coupled {
            self.coupled_forth(factors, &start, by).map_err(failed("the coupling"))?
        } else {
            let of_rate = start.start.theta_rate.iter().copied().chain(std::iter::repeat(0.0));
            let ahead = base.step(n, solved.old, ahead);
            start.start.theta.iter().zip(of_rate).map(|(theta, rate)| theta + ahead * rate).collect()
        };
        let MechanicsForth { w, points: all, advance } =
            self.mechanics_forth(factors, &start, by, &theta).map_err(failed("mechanics"))?;
        let mut foundation = start.start.foundation.clone();
        let theta = match self.heat_forth(factors, &start, by, (&w, &all)).map_err(failed("heat"))? {
            Some([at, foundations]) => {
                foundation.iter_mut().zip(&foundations).for_each(|(end, at)| *end = factors.rule.end([*end, *at]));
                start.start.theta.iter().zip(&at).map(|(start, at)| factors.rule.end([*start, *at])).collect()
            }
            None if by.temperatures.is_empty() => zeros(start.start.theta.len()),
            None => by.temperatures.clone(),
        };
        let rule = factors.rule;
        let at_end = |start: &[f64], at: &[f64]| -> Vec<f64> {
            start.iter().zip(at).map(|(start, at)| rule.end([*start, *at])).collect()
        };
        let mut end = base.step(n, solved.old, |step| self.end(step, &start, by, &all));
        let advanced = advance.iter().zip(&start.start.advance);
        end.advance_rate = advanced.map(|(end, start)| (end - start) / rule.k).collect();
        (end.advance, end.foundation) = (advance, foundation);
        for (i, (branch, of)) in end.branches.iter_mut().zip(&base.discrete.branches).enumerate() {
            let more = at_end(&start.start.branches[i], &of.step(rule, &start.bar.branches[i], &w));
            branch.iter_mut().zip(&more).for_each(|(branch, more)| *branch += more);
        }
        end.u.iter_mut().zip(&w).for_each(|(u, w)| *u += rule.gamma / rule.level * w);
        let w = if rule.is_steady() { zeros(w.len()) } else { at_end(&start.start.w, &w) };
        let points = all.iter().map(|(input, output)| [input[3], input[4], input[5], output[3], output[4], output[5]]);
        let theta_rate = by.theta_rate.iter().zip(theta.iter().zip(&start.start.theta));
        let theta_rate = theta_rate.map(|(by, (end, start))| by + (end - start) / rule.k).collect();
        Ok((StateVector { w, theta, theta_rate, ..end }, points.collect()))
    }

    /// The mechanical half-step, with the change `theta` of the temperature that drives it: w, and the changes of the
    /// inputs and outputs of each point.
    fn mechanics_forth(
        &self,
        factors: &mut StepFactors,
        start: &Started,
        by: &ResidualSlope,
        theta: &[f64],
    ) -> Result<MechanicsForth, SolveError> {
        let (base, solved, n) = (self.base, &self.solved, self.solved.n);
        let mut known = base.step(n, solved.old, |step| self.known(step, start, theta));
        let right = base.step(n, solved.old, |step| {
            let mut pushed = self.pushed(step, &factors.slopes, start, by, &known);
            if step.problem.physics.has_heat() {
                let thermal = factors.slopes.force(step.discrete, theta);
                pushed.right.iter_mut().zip(&thermal).for_each(|(right, force)| *right += force);
            }
            pushed
        });
        let (mut w, mut forces) = factors.moved(base, solved, self.points, &right)?;
        let mut advance = start.start.advance.clone();
        let right = self.driving(start, by);
        let found = base.step(n, solved.old, |step| self.driven.add(step, &right, (&mut w, &mut forces)));
        for (drive, found) in self.driven.drives.iter().zip(found) {
            advance[drive.contact] = found;
            self.advanced(drive.contact, found, &mut known);
        }
        let points = base.step(n, solved.old, |step| self.at_points(step, &w, &forces, &known));
        Ok(MechanicsForth { w, points, advance })
    }

    /// The right-hand sides of the equations of driven contacts.
    fn driving(&self, &Started { start, .. }: &Started, by: &ResidualSlope) -> Vec<f64> {
        let of = |drive: &LinearDrive| {
            let [by_length, by_rate] = drive.inertia;
            let at = |all: &[f64]| all.get(drive.contact).copied().unwrap_or(0.0);
            by_length * at(&start.advance) + by_rate * at(&start.advance_rate) - at(&by.lacking)
        };
        self.driven.drives.iter().map(of).collect()
    }

    /// Adds the changes of the inputs of the points with a change of δ of their contact at the end of the step.
    fn advanced(&self, contact: usize, change: f64, known: &mut [[f64; INPUTS]]) {
        let own = self.points.iter().zip(known).filter(|(point, _)| point.contact == contact);
        own.for_each(|(point, known)| add_product(change, &point.advance.at_end(), known));
    }

    /// True if a force drives a contact in the step. Otherwise it ends the step with the δ that it starts with.
    fn drives(&self, contact: usize) -> bool {
        self.driven.drives.iter().any(|drive| drive.contact == contact)
    }

    /// The heat half-step: the temperatures of the nodes and of the foundations of each contact at the time of its
    /// equations, or `None` without heat.
    fn heat_forth(
        &self,
        factors: &mut StepFactors,
        start: &Started,
        by: &ResidualSlope,
        (w, all): (&[f64], &[PointChange]),
    ) -> Result<Option<[Vec<f64>; 2]>, SolveError> {
        let (base, solved, n) = (self.base, &self.solved, self.solved.n);
        let right = base.step(n, solved.old, |step| self.warmed(step, factors, start, by, (w, all)));
        right.map(|right| factors.warmed(base, solved, &right)).transpose()
    }

    /// The temperature at the time of the equations if both half-steps hold at once.
    fn coupled_forth(
        &self,
        factors: &mut StepFactors,
        start: &Started,
        by: &ResidualSlope,
    ) -> Result<Vec<f64>, SolveError> {
        let mut through = |start: &Started, by: &ResidualSlope, theta: &[f64]| {
            let MechanicsForth { w, points, .. } = self.mechanics_forth(factors, start, by, theta)?;
            let [theta, _] = self.heat_forth(factors, start, by, (&w, &points))?.unwrap_or_default();
            Ok::<Vec<f64>, SolveError>(theta)
        };
        let right = through(start, by, &zeros(start.start.theta.len()))?;
        let (none, same) = (StateVector::zero(self.solved.old), ResidualSlope::zero(by));
        let none = Started { start: &none, bar: &none, before: None };
        coupled(&right, |theta| through(&none, &same, theta))
    }

    /// The changes of the inputs of each point that are known: of ū_ν − g, of the temperature, and what an opposite
    /// side that has moved adds to the jump of the velocities.
    fn known(&self, step: &Step, &Started { start, bar, .. }: &Started, theta: &[f64]) -> Vec<[f64; INPUTS]> {
        let sides =
            if step.problem.physics.has_heat() { sides_of(step, theta) } else { vec![[0.0; 2]; self.points.len()] };
        let worn = of_pairs_or(step, &seen(step, &start.depths), &start.wear);
        let of = |(i, point): (usize, &LinearPoint)| {
            let sign = step.boundary.points.get(i).map_or(1.0, |on| step.contacts[on.contact].sign());
            let [own, other] = sides[i];
            // The laws see the side `on`; the shares of the other side are negative in the jump.
            let temperature = if sign > 0.0 { own } else { 0.0 - other };
            let opening = jump(step, i, point, &bar.u)[0] - worn[i];
            let mut known = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, opening, temperature];
            add_product(start.advance[point.contact], &point.advance.at_start(), &mut known);
            known
        };
        let mut known: Vec<[f64; INPUTS]> = self.points.iter().enumerate().map(of).collect();
        for (contact, change) in start.advance.iter().enumerate().filter(|(contact, _)| !self.drives(*contact)) {
            self.advanced(contact, *change, &mut known);
        }
        known
    }

    /// The right-hand sides of the mechanical half-step: of (4.1), of contact points, and the prescribed velocities.
    fn pushed(
        &self,
        step: &Step,
        slopes: &BodySlopes,
        &Started { start, bar, .. }: &Started,
        by: &ResidualSlope,
        known: &[[f64; INPUTS]],
    ) -> Pushed {
        let (discrete, rule) = (step.discrete, step.rule);
        let mut right = discrete.inertia().1.apply(&bar.w);
        for force in &mut right {
            *force *= step.inertia() / rule.delta;
        }
        let mut take = |force: &[f64]| right.iter_mut().zip(force).for_each(|(right, force)| *right -= force);
        take(&slopes.elastic(discrete, &bar.u));
        for (branch, z) in discrete.branches.iter().zip(&bar.branches) {
            take(&branch.force(&branch.kept(rule, z)));
        }
        take(&by.mechanics);
        for (contact, change) in start.advance.iter().enumerate() {
            if *change != 0.0 && !self.drives(contact) {
                let turned = turned(step, self.points, contact);
                take(&turned.iter().map(|force| change * force).collect::<Vec<f64>>());
            }
        }
        let of_point = |((point, defect), known): ((&LinearPoint, &Local), &[f64; INPUTS])| -> Local {
            let seen = point.forth(known);
            std::array::from_fn(|a| 0.0 - defect[a] - seen[a])
        };
        let defects = self.points.iter().zip(&by.defects).zip(known).map(of_point).collect();
        let rates = by.rates.iter().zip(&bar.u).map(|(rate, u)| rate - u / rule.span).collect();
        Pushed { right, defects, held: held_values(&discrete.v, rates) }
    }

    /// The changes of the inputs and outputs of each point with those of w, (p, q) and what is known.
    fn at_points(&self, step: &Step, w: &[f64], forces: &[Local], known: &[[f64; INPUTS]]) -> Vec<PointChange> {
        let of = |(i, point): (usize, &LinearPoint)| {
            let ([v1, v2, v3], [p, q1, q2]) = (jump(step, i, point, w), forces[i]);
            let mut input = [v1, v2, v3, p, q1, q2, 0.0, 0.0];
            add_product(1.0, &known[i], &mut input);
            (input, point.forth(&input))
        };
        self.points.iter().enumerate().map(of).collect()
    }

    /// The right-hand side of the heat half-step with the prescribed temperatures, or `None` without heat.
    fn warmed(
        &self,
        step: &Step,
        factors: &StepFactors,
        &Started { start, bar, before }: &Started,
        by: &ResidualSlope,
        (w, all): (&[f64], &[PointChange]),
    ) -> Option<HeatRight> {
        if !step.problem.physics.has_heat() {
            return None;
        }
        let discrete = step.discrete;
        let earlier = before.map_or(&[][..], |before| &before.theta);
        let stored = factors.slopes.stored(step, &bar.theta, [&start.theta, earlier]);
        let u: Cow<[f64]> = if factors.follows {
            bar.u.iter().zip(w).map(|(u, w)| u + step.rule.gamma * w).collect()
        } else {
            Cow::Borrowed(&start.u)
        };
        let heated = discrete.e.apply(&u);
        let mut right: Vec<f64> = stored.iter().zip(heated.iter().zip(&by.heat)).map(|(s, (e, r))| s + e - r).collect();
        let of = |(i, (point, (input, output))): (usize, (&LinearPoint, &PointChange))| {
            let (Some(flux), Some(at)) = (self.solved.flux.get(i), step.boundary.points.get(i)) else {
                return [0.0; 2];
            };
            let power = point.power([input[4], input[5]], [output[4], output[5]]);
            let [s1, s2] = point.slip;
            let speed = s1.hypot(s2);
            let along = if speed > 0.0 { (s1 * output[4] + s2 * output[5]) / speed } else { 0.0 };
            let through = flux.by_pressure * input[3]
                + flux.by_penetration * output[7]
                + flux.by_slip_speed * along
                + flux.by_friction_power * power;
            let rubs = step.contacts.get(at.contact).is_some_and(takes_friction);
            let into = through + if rubs { power } else { 0.0 };
            [0.0 - at.weight * through, 0.0 - at.weight * into]
        };
        let of: Vec<[f64; 2]> = self.points.iter().zip(all).enumerate().map(of).collect();
        let mut foundation: Vec<f64> = lumped(step).iter().map(|of| of.map_or(0.0, |of| of.storage)).collect();
        let known = bar.foundation.iter().zip(&by.missing);
        foundation.iter_mut().zip(known).for_each(|(of, (bar, missing))| *of = *of * bar - missing);
        for (point, [_, into]) in step.boundary.points.iter().zip(&of) {
            foundation.get_mut(point.contact).into_iter().for_each(|sum| *sum -= into);
        }
        onto_sides(step, of.into_iter(), &mut right);
        // A prescribed temperature is taken between that at the start and the datum.
        let given = by.temperatures.iter().zip(&start.theta);
        let given = given.map(|(by, start)| by + (1.0 - step.rule.level) * start).collect();
        Some(HeatRight { right, held: held_values(&discrete.q, given), foundation })
    }

    /// The state at the end of the step, but for what the unknowns of the bodies add to u, w, θ and the branches.
    fn end(
        &self,
        step: &Step,
        &Started { start, bar, .. }: &Started,
        by: &ResidualSlope,
        all: &[PointChange],
    ) -> StateVector {
        let sum = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a + b).collect() };
        let mut end = StateVector {
            u: sum(&bar.u, &by.u),
            w: Vec::new(),
            theta: Vec::new(),
            branches: by.branches.clone(),
            wear: sum(&of_pairs_or(step, &zeros(start.wear.len()), &start.wear), &by.worn),
            depths: start.depths.clone(),
            work: sum(&start.work, &by.work),
            theta_rate: Vec::new(),
            foundation: Vec::new(),
            advance: Vec::new(),
            advance_rate: Vec::new(),
        };
        let mut worn = zeros(end.wear.len());
        for (i, (point, (input, output))) in self.points.iter().zip(all).enumerate() {
            if bears(step, i) {
                worn[i] = output[6];
                end.work[i] += point.rubbing * point.power([input[4], input[5]], [output[4], output[5]]);
            }
        }
        add_lists(&mut end.depths, 1.0, &grown(step, &worn));
        end.depths.iter_mut().flatten().zip(&by.grown).for_each(|(depth, more)| *depth += more);
        let depths = seen(step, &end.depths);
        let more = of_pairs_or(step, &depths, &worn);
        end.wear.iter_mut().zip(&more).for_each(|(wear, more)| *wear += more);
        end
    }
}

/// The derivatives of the state from which a step starts, of that to which it adds, [`Start`], and of that one step
/// before.
struct Started<'a> {
    start: &'a StateVector,
    bar: &'a StateVector,
    before: Option<&'a StateVector>,
}

/// The changes of the inputs and outputs of a contact point.
type PointChange = ([f64; INPUTS], [f64; OUTPUTS]);

/// The right-hand sides of a heat half-step: of (4.2) per node, of the balance of each foundation, and the prescribed
/// temperatures.
pub(super) struct HeatRight {
    right: Vec<f64>,
    foundation: Vec<f64>,
    held: Vec<f64>,
}

/// The changes of a mechanical half-step: of w, of the inputs and outputs of each point, and of δ of each contact.
struct MechanicsForth {
    w: Vec<f64>,
    points: Vec<PointChange>,
    advance: Vec<f64>,
}

fn add_product(factor: f64, from: &[f64; INPUTS], to: &mut [f64; INPUTS]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to += factor * from);
}

/// The components of values along prescribed degrees of freedom; zero along the others.
fn held_values(space: &Space, mut values: Vec<f64>) -> Vec<f64> {
    space.mask_free(&mut values);
    values
}

impl LinearPoint {
    /// The change of the outputs with that of the inputs.
    pub fn forth(&self, inputs: &[f64; INPUTS]) -> [f64; OUTPUTS] {
        std::array::from_fn(|k| self.by.iter().zip(inputs).map(|(by, input)| by[k] * input).sum())
    }

    /// The change of q·(w_τ − v_F) with those of q and of the slip.
    fn power(&self, q: [f64; 2], slip: [f64; 2]) -> f64 {
        (0..2).map(|a| q[a] * self.slip[a] + self.force[a + 1] * slip[a]).sum()
    }
}

impl StepFactors {
    /// J of the mechanical half-step: solves
    ///
    /// K v + Σ ω Nᵀ f = `right`,  G_v N v + G_f f = `defects` at each point, with v = `held` where w is prescribed,
    ///
    /// for v and f, with G_v and G_f as in [`StepFactors::mechanics`].
    pub fn moved(
        &mut self,
        base: &ProblemInstance,
        of: &SolvedStep,
        points: &[LinearPoint],
        pushed: &Pushed,
    ) -> Result<(Vec<f64>, Vec<Local>), SolveError> {
        let block =
            |point: &LinearPoint| BorderedPoint { onto: IDENTITY, seen: point.by_velocity(), own: point.by_force() };
        let blocks: Vec<BorderedPoint> = points.iter().map(block).collect();
        let Pushed { right, defects, held } = pushed;
        let right = BorderedRight { body: right, points: defects, held: Some(held) };
        let Bordered { x, forces, .. } = self.bordered(base, of, points, (&blocks, &right))?;
        Ok((x, forces))
    }

    /// J of the heat half-step: the temperatures of the nodes, and of the foundations of each contact.
    pub fn warmed(
        &mut self,
        base: &ProblemInstance,
        of: &SolvedStep,
        HeatRight { right, held, foundation }: &HeatRight,
    ) -> Result<[Vec<f64>; 2], SolveError> {
        let Some(factored) = &mut self.heat else { return Ok([Vec::new(), Vec::new()]) };
        let flux = of.flux;
        base.step(of.n, of.old, |step| {
            let tangent = heat_tangent(step, &mut factored.half, of);
            let apply = |matrix: &BlockMatrix, theta: &[f64]| -> Vec<f64> {
                let passed = passed(step, flux, theta, &warmed(step, flux, &[], theta));
                matrix.apply(theta).iter().zip(passed).map(|(a, b)| a + b).collect()
            };
            let none = zeros(right.len());
            let known = passed(step, flux, &none, &warmed(step, flux, foundation, &none));
            let right: Vec<f64> = right.iter().zip(&known).map(|(right, known)| right - known).collect();
            let [theta, _] = factored.solved(&step.discrete.q, &tangent, (held.clone(), &right), apply)?;
            let foundations = warmed(step, flux, foundation, &theta);
            Ok([theta, foundations])
        })
    }
}

/// The derivative of Σ ω Nᵀ q·ν in θ times `theta`, and in the temperatures of foundations times `foundation`.
fn passed(step: &Step, flux: &[Flux], theta: &[f64], foundation: &[f64]) -> Vec<f64> {
    let seen = both_sides(step, theta, foundation);
    let of = |(point, (flux, [own, other])): (&PointOnBoundary, (&Flux, &[f64; 2]))| {
        // The shares of the other side are negative in the jump.
        let change = point.weight * (flux.by_temperature * own - flux.by_foundation * other);
        [change; 2]
    };
    let mut all = zeros(theta.len());
    onto_sides(step, step.boundary.points.iter().zip(flux.iter().zip(&seen)).map(of), &mut all);
    all
}
