//! One step of the sweep from the end of a run to its start.

use std::borrow::Cow;
use std::sync::Arc;

use super::balances::{is_moved, largest_traction};
use super::driven::{DrivenStep, turned};
use super::error::GradientError;
use super::factors::{StepFactors, coupled};
use super::instance::{BodyResidual, ProblemInstance, SolvedStep, StepResidual};
use super::lumped::{both_sides, multipliers, takes_friction};
use super::points::{INPUTS, LinearPoint};
use super::stencil;
use super::transpose::{Transposed, onto_sides, unweighted};
use super::vector::StateVector;
use super::worn::{add_lists, grown_transposed, of_pairs_or, seen_transposed};
use crate::equation::heat::lumped;
use crate::equation::system::Step;
use crate::inclusion::Local;
use crate::linalg::{SolveError, dot, zeros};
use crate::problem::Coupling;
use crate::tensor::dot as inner;
use crate::time::Start;

/// The derivative of an output by the states of the contact points of the last step: by (p, q), penetration and slip
/// in the bases of the points.
pub(super) type OfPoints = Vec<[f64; 6]>;

/// The multipliers of the equations of a step.
pub(super) struct Multiplied {
    transposed: Transposed,
    heat: [Vec<f64>; 2],
    /// The weights of the state at the end of the step.
    after: StateVector,
    /// The multipliers at the nodes of Γ_C.
    on_contact: [Vec<f64>; 2],
    /// ω of the contact points, and the branches on which they are taken.
    areas: Vec<f64>,
    branches: Vec<[bool; 2]>,
    /// The multipliers of the equations of driven contacts, and of the balances of foundations, per contact.
    driven: Vec<f64>,
    foundations: Vec<f64>,
    /// The weights of the depths of wear at the contact points.
    wear: Vec<f64>,
}

/// A step, linearised.
pub(super) struct LinearStep<'a, T> {
    pub base: &'a ProblemInstance,
    pub solved: SolvedStep<'a>,
    pub points: &'a [LinearPoint],
    pub driven: &'a DrivenStep<T>,
}

impl LinearStep<'_, Transposed> {
    /// Makes the weights of the state at the end of the step those of the state at its start. `before` holds weights of
    /// the state at its start that a later step had, and then those of the state one step before.
    pub fn back(
        &self,
        factors: &mut StepFactors,
        (weights, before): (&mut StateVector, &mut Option<StateVector>),
        direct: Option<&OfPoints>,
    ) -> Result<Multiplied, GradientError> {
        let (base, solved, n) = (self.base, &self.solved, self.solved.n);
        let failed = |part| move |source| GradientError::Linear { step: n, part, source };
        let mut after = weights.clone();
        // At points of pairs the depth is that of the vertices, and what comes off adds to it.
        base.step(n, solved.old, |step| {
            add_lists(&mut after.depths, 1.0, &seen_transposed(step, &after.wear));
            after.wear = of_pairs_or(step, &grown_transposed(step, &after.depths), &after.wear);
        });
        if factors.rule.is_steady() {
            after.w.fill(0.0);
        }
        // Of the unknowns at the time of the equations, v₁ = v₀ + (v_ϑ − v₀)/ϑ.
        let share = factors.rule.level.recip();
        let mut of_heat: Vec<f64> = after.theta.iter().map(|theta| share * theta).collect();
        // θ̇ = (θ₁ − θ₀)/k = (θ_ϑ − θ₀)/(ϑk).
        let of_rate = share / factors.rule.k;
        of_heat.iter_mut().zip(&after.theta_rate).for_each(|(of, rate)| *of += of_rate * rate);
        let foundation: Vec<f64> = after.foundation.iter().map(|theta| share * theta).collect();
        let mut heat = factors.heat(base, solved, (&of_heat, &foundation)).map_err(failed("heat"))?;
        if factors.is_coupled {
            let y = self.coupled_back(factors, (&after, direct), &heat[0]).map_err(failed("the coupling"))?;
            let of = self.mechanics_back(factors, Some((&after, direct)), &y).map_err(failed("mechanics"))?;
            let more = base.step(n, solved.old, |step| of_temperature(step, factors, &of));
            of_heat.iter_mut().zip(&more).for_each(|(of, more)| *of += more);
            heat = factors.heat(base, solved, (&of_heat, &foundation)).map_err(failed("heat"))?;
        }
        let of = self.mechanics_back(factors, Some((&after, direct)), &heat[0]).map_err(failed("mechanics"))?;
        let areas: Vec<f64> =
            base.step(n, solved.old, |step| step.boundary.points.iter().map(|point| point.weight).collect());
        let wear = std::mem::take(&mut weights.wear);
        *weights = base.step(n, solved.old, |step| {
            let mut start = self.start(step, factors, (&after, before), (&heat, &of));
            start.theta.iter_mut().zip(&after.theta_rate).for_each(|(theta, rate)| *theta -= of_rate * rate);
            start
        });
        let branches = self.points.iter().map(|point| point.branch).collect();
        let boundary = &base.discrete.boundary;
        let restricted = |values: &[f64], components| {
            if values.is_empty() { Vec::new() } else { boundary.restricted(components, values) }
        };
        let on_contact = [restricted(&of.transposed.y, base.discrete.v.components), restricted(&heat[0], 1)];
        let foundations = base.step(n, solved.old, |step| self.foundations_back(step, &after, &heat[0]));
        let (transposed, driven) = (of.transposed, of.driven);
        Ok(Multiplied { transposed, heat, after, on_contact, areas, branches, driven, foundations, wear })
    }

    /// The weights of the state at the start of the step; `before` holds those that a later step had, and then those of
    /// the state one step before.
    fn start(
        &self,
        step: &Step,
        factors: &StepFactors,
        (after, before): (&StateVector, &mut Option<StateVector>),
        (heat, of): (&[Vec<f64>; 2], &MechanicsBack),
    ) -> StateVector {
        let (mut bar, later) = (after.clone(), before.take());
        let mut start = self.onto_start(step, factors, &mut bar, heat, of);
        let [_, of_start, of_before] = stored(step, factors, &heat[0]);
        add_to(&mut start.theta, of_start.as_deref());
        match step.rule.start {
            Start::TwoStates => {
                start.add_bar(4.0 / 3.0, &bar);
                let earlier = before.insert(StateVector::zero(step.old));
                earlier.add_bar(-1.0 / 3.0, &bar);
                add_to(&mut earlier.theta, of_before.as_deref());
            }
            Start::State | Start::Admissible => start.add_bar(1.0, &bar),
        }
        if let Some(later) = later {
            start.add_bar(1.0, &later);
        }
        start
    }

    /// The multipliers y of (4.2) if both half-steps hold at once: y = y₀ + T y, with `first` those of the temperature
    /// alone.
    fn coupled_back(
        &self,
        factors: &mut StepFactors,
        weights: EndWeights,
        first: &[f64],
    ) -> Result<Vec<f64>, SolveError> {
        let (n, old) = (self.solved.n, self.solved.old);
        let mut through = |weights: Option<EndWeights>, y: &[f64]| {
            let of = self.mechanics_back(factors, weights, y)?;
            let right = self.base.step(n, old, |step| of_temperature(step, factors, &of));
            let [more, _] = factors.heat(self.base, &self.solved, (&right, &[]))?;
            Ok::<Vec<f64>, SolveError>(more)
        };
        let of_mechanics = through(Some(weights), &zeros(first.len()))?;
        let right: Vec<f64> = first.iter().zip(&of_mechanics).map(|(a, b)| a + b).collect();
        coupled(&right, |y| through(None, y))
    }

    /// The transposed mechanical half-step of weights of the state at the end of the step, which may be none, and of
    /// multipliers of (4.2).
    fn mechanics_back(
        &self,
        factors: &mut StepFactors,
        weights: Option<EndWeights>,
        heat: &[f64],
    ) -> Result<MechanicsBack, SolveError> {
        let (base, solved, n) = (self.base, &self.solved, self.solved.n);
        let (after, direct) = match weights {
            Some((after, direct)) => (Cow::Borrowed(after), direct),
            None => (Cow::Owned(StateVector::zero(solved.new)), None),
        };
        let mut by_point = self.outputs(&after, heat);
        for (all, direct) in by_point.iter_mut().zip(direct.into_iter().flatten()) {
            all.iter_mut().zip(direct).for_each(|(all, direct)| *all += direct);
        }
        let inputs: Vec<[f64; INPUTS]> =
            self.points.iter().zip(&by_point).map(|(point, all)| point.weighted(all)).collect();
        let (mut right, force) = base.step(n, solved.old, |step| self.right(step, &after, &inputs));
        if factors.follows {
            let heating = base.discrete.e.apply_transposed(heat);
            right.iter_mut().zip(&heating).for_each(|(right, more)| *right += factors.rule.gamma * more);
        }
        let mut transposed = factors.mechanics(base, solved, self.points, (&right, &force))?;
        let ends = self.ends(&after, &inputs, factors.rule.k);
        let eta = base.step(n, solved.old, |step| self.driven.add(step, self.points, &ends, &mut transposed));
        let of_point = |(i, point): (usize, &LinearPoint)| {
            let area = base.discrete.boundary.points.get(i).map_or(0.0, |point| point.weight);
            let [a, b, c] = transposed.points[i].map(|mu| 0.0 - area * mu);
            let all = point.back(&[a, b, c, 0.0, 0.0, 0.0, 0.0, 0.0]);
            std::array::from_fn(|k| all[k] + inputs[i][k])
        };
        let known: Vec<[f64; INPUTS]> = self.points.iter().enumerate().map(of_point).collect();
        let mut driven = zeros(after.advance.len());
        for (drive, eta) in self.driven.drives.iter().zip(eta) {
            driven[drive.contact] = eta;
        }
        let advance =
            base.step(n, solved.old, |step| self.advance_back(step, (&transposed, &known), (&after, &driven)));
        Ok(MechanicsBack { transposed, known: known.iter().map(|all| [all[6], all[7]]).collect(), driven, advance })
    }

    /// The weights of δ of each contact at the end of the step, by the outputs of the points and by what follows.
    fn ends(&self, after: &StateVector, inputs: &[[f64; INPUTS]], k: f64) -> Vec<f64> {
        let rates = after.advance_rate.iter().map(|rate| rate / k);
        let mut ends: Vec<f64> = after.advance.iter().zip(rates).map(|(end, rate)| end + rate).collect();
        for (point, inputs) in self.points.iter().zip(inputs) {
            let more = dot(&point.advance.at_end(), inputs);
            ends.get_mut(point.contact).into_iter().for_each(|end| *end += more);
        }
        ends
    }

    /// The weights of δ and of its rate at the start of the step, per contact; `known` are the weights of the inputs of
    /// the points by equations and outputs. A contact that nothing drives ends the step with the δ that it starts with.
    fn advance_back(
        &self,
        step: &Step,
        (transposed, known): (&Transposed, &[[f64; INPUTS]]),
        (after, driven): (&StateVector, &[f64]),
    ) -> [Vec<f64>; 2] {
        let [mut start, mut rates] = [zeros(driven.len()), zeros(driven.len())];
        if !is_moved(step.problem) {
            return [after.advance.clone(), rates];
        }
        for contact in 0..driven.len() {
            let sum = |of: &dyn Fn(&LinearPoint) -> [f64; INPUTS]| -> f64 {
                let own = self.points.iter().zip(known).filter(|(point, _)| point.contact == contact);
                own.map(|(point, known)| dot(&of(point), known)).sum()
            };
            start[contact] = sum(&|point| point.advance.at_start());
            if let Some(drive) = self.driven.drives.iter().find(|drive| drive.contact == contact) {
                let [by_length, by_rate] = drive.inertia.map(|inertia| inertia * driven[contact]);
                start[contact] += by_length - after.advance_rate[contact] / step.rule.k;
                rates[contact] = by_rate;
            } else {
                let turned = dot(&turned(step, self.points, contact), &transposed.y);
                start[contact] += after.advance[contact] + sum(&|point| point.advance.at_end()) - turned;
            }
        }
        [start, rates]
    }

    /// The derivatives by (p, q), penetration, slip, wear and penetration at the time of the equations of each point of
    /// what follows from them in the step.
    fn outputs(&self, after: &StateVector, heat: &[f64]) -> Vec<[f64; 8]> {
        self.base.step(self.solved.n, self.solved.old, |step| {
            let seen = if heat.is_empty() {
                vec![[0.0; 2]; self.points.len()]
            } else {
                both_sides(step, heat, &self.foundations_back(step, after, heat))
            };
            let of = |(i, point): (usize, &LinearPoint)| {
                let ([_, q1, q2], [s1, s2], work) = (point.force, point.slip, point.rubbing * after.work[i]);
                let mut all = [0.0, work * s1, work * s2, 0.0, work * q1, work * q2, after.wear[i], 0.0];
                let (Some(flux), Some(at)) = (self.solved.flux.get(i), step.boundary.points.get(i)) else { return all };
                let [own, other] = seen[i].map(|seen| 0.0 - at.weight * seen);
                let through = own + other;
                let rubs = step.contacts.get(at.contact).is_some_and(takes_friction);
                let power = through * flux.by_friction_power + if rubs { other } else { 0.0 };
                let speed = s1.hypot(s2);
                let along = if speed > 0.0 { through * flux.by_slip_speed / speed } else { 0.0 };
                let more = [
                    through * flux.by_pressure,
                    power * s1,
                    power * s2,
                    0.0,
                    power * q1 + along * s1,
                    power * q2 + along * s2,
                    0.0,
                    through * flux.by_penetration,
                ];
                all.iter_mut().zip(more).for_each(|(all, more)| *all += more);
                all
            };
            self.points.iter().enumerate().map(of).collect()
        })
    }

    /// The multipliers of the balances of foundations with a heat capacity, per contact.
    fn foundations_back(&self, step: &Step, after: &StateVector, heat: &[f64]) -> Vec<f64> {
        if heat.is_empty() {
            return zeros(after.foundation.len());
        }
        let share = step.rule.level.recip();
        let weights: Vec<f64> = after.foundation.iter().map(|theta| share * theta).collect();
        multipliers(step, self.solved.flux, &weights, heat)
    }

    /// The right-hand side of the transposed mechanical half-step.
    fn right(&self, step: &Step, after: &StateVector, inputs: &[[f64; INPUTS]]) -> (Vec<f64>, Vec<Local>) {
        let rule = step.rule;
        let at_points = self
            .points
            .iter()
            .zip(inputs)
            .map(|(point, of)| super::instance::global(&point.basis, &[of[0], of[1], of[2]]));
        let mut right = unweighted(step, at_points);
        for (i, right) in right.iter_mut().enumerate() {
            *right += (after.w[i] + rule.gamma * after.u[i]) / rule.level;
        }
        for (branch, weights) in step.discrete.branches.iter().zip(&after.branches) {
            let more = branch.step_transposed(rule, weights);
            right.iter_mut().zip(&more).for_each(|(right, more)| *right += more / rule.level);
        }
        let per_area = |(of, point): (&[f64; INPUTS], &crate::contact::PointOnBoundary)| {
            if point.weight == 0.0 { [0.0; 3] } else { [of[3], of[4], of[5]].map(|f| f / point.weight) }
        };
        (right, inputs.iter().zip(&step.boundary.points).map(per_area).collect())
    }

    /// Makes the weights of the state at the end of the step those of what the step adds to; returns those of the state
    /// at its start.
    fn onto_start(
        &self,
        step: &Step,
        factors: &StepFactors,
        weights: &mut StateVector,
        [heat, held]: &[Vec<f64>; 2],
        of: &MechanicsBack,
    ) -> StateVector {
        let (discrete, rule) = (step.discrete, step.rule);
        let MechanicsBack { transposed: found, known, advance: [advance, advance_rate], .. } = of;
        let onto = |of: &mut [f64], more: &[f64], factor: f64| {
            of.iter_mut().zip(more).for_each(|(of, more)| *of += factor * more);
        };
        let (wear, work) = (of_pairs_or(step, &zeros(weights.wear.len()), &weights.wear), weights.work.clone());
        let (depths, advance, advance_rate) = (weights.depths.clone(), advance.clone(), advance_rate.clone());
        let mut start = StateVector { wear, work, advance, advance_rate, depths, ..StateVector::zero(step.old) };
        // The share of the values at the start in those at the end, 1 − 1/ϑ.
        let kept_of = 1.0 - rule.level.recip();
        let has_heat = step.problem.physics.has_heat();
        weights.theta.iter_mut().for_each(|theta| *theta *= if has_heat { kept_of } else { 0.0 });
        if has_heat {
            let eta = self.foundations_back(step, weights, heat);
            for ((theta, of), eta) in weights.foundation.iter_mut().zip(lumped(step)).zip(eta) {
                *theta = kept_of * *theta + of.map_or(0.0, |of| of.storage * eta);
            }
            add_to(&mut weights.theta, stored(step, factors, heat)[0].as_deref());
            // A prescribed temperature is taken between that at the start and the datum.
            onto(&mut start.theta, held, 1.0 - rule.level);
        }
        if !step.problem.physics.has_mechanics() {
            return start;
        }
        onto(&mut weights.u, &factors.slopes.elastic(discrete, &found.y), -1.0);
        onto(&mut weights.u, &found.prescribed, -1.0 / rule.span);
        let along = self.points.iter().zip(known).map(|(point, [of, _])| point.basis[0].map(|c| c * of));
        onto(&mut weights.u, &unweighted(step, along), 1.0);
        let inertia = discrete.inertia().1.apply(&found.y);
        for (w, m) in weights.w.iter_mut().zip(&inertia) {
            *w = kept_of * *w + step.inertia() / rule.delta * m;
        }
        for (branch, weights) in discrete.branches.iter().zip(&mut weights.branches) {
            let (kept, force) = (branch.kept(rule, weights), branch.kept(rule, &branch.force_transposed(&found.y)));
            for (weights, (kept, force)) in weights.iter_mut().zip(kept.iter().zip(&force)) {
                *weights = kept_of * *weights + kept / rule.level - force;
            }
        }
        if has_heat {
            let heating = discrete.e.apply_transposed(heat);
            onto(if factors.follows { &mut weights.u } else { &mut start.u }, &heating, 1.0);
            if !factors.is_coupled {
                let driving = of_temperature(step, factors, of);
                onto(&mut start.theta, &driving, 1.0);
                onto(&mut start.theta_rate, &driving, ahead(step));
            }
        }
        open(step, known, &mut start);
        start
    }
}

/// Takes the weights of ū_ν − g at the points, which the depths of wear diminish, from those of the state at the start.
fn open(step: &Step, known: &[[f64; 2]], start: &mut StateVector) {
    let opened: Vec<f64> = known.iter().map(|[of, _]| *of).collect();
    add_lists(&mut start.depths, -1.0, &seen_transposed(step, &opened));
    let of_foundations = of_pairs_or(step, &zeros(opened.len()), &opened);
    start.wear.iter_mut().zip(&of_foundations).for_each(|(wear, of)| *wear -= of);
}

/// Weights of the state at the end of a step, and of the contact points there.
type EndWeights<'a> = (&'a StateVector, Option<&'a OfPoints>);

/// A transposed mechanical half-step.
struct MechanicsBack {
    transposed: Transposed,
    /// The weights of ū_ν − g and of the temperature at each point.
    known: Vec<[f64; 2]>,
    /// Per contact the multipliers of the equations of driven ones, and the weights of δ and of its rate at the start.
    driven: Vec<f64>,
    advance: [Vec<f64>; 2],
}

/// The weights of the temperature that drives mechanics: in m, in the laws of the bodies and in those of contact.
fn of_temperature(step: &Step, factors: &StepFactors, of: &MechanicsBack) -> Vec<f64> {
    let mut sum = factors.slopes.force_transposed(step.discrete, &of.transposed.y);
    let signs = step.boundary.points.iter().map(|point| step.contacts[point.contact].sign());
    // The laws see the side `on`; the shares of the other side are negative in the jump.
    let of_sides =
        of.known.iter().zip(signs).map(|([_, of], sign)| if sign > 0.0 { [*of, 0.0] } else { [0.0, 0.0 - of] });
    onto_sides(step, of_sides, &mut sum);
    sum
}

/// The weights of θ̄, θ₀ and θ₋₁ in the stored heat.
fn stored(step: &Step, factors: &StepFactors, heat: &[f64]) -> [Option<Vec<f64>>; 3] {
    if heat.is_empty() { [None, None, None] } else { factors.slopes.stored_transposed(step, heat) }
}

/// The time by which the temperature that drives mechanics is extrapolated, s.
pub(super) fn ahead(step: &Step) -> f64 {
    if step.coupling() == Coupling::Extrapolated { step.rule.level * step.rule.k } else { 0.0 }
}

/// Adds numbers that may be none.
fn add_to(sum: &mut [f64], more: Option<&[f64]>) {
    sum.iter_mut().zip(more.into_iter().flatten()).for_each(|(sum, more)| *sum += more);
}

impl LinearPoint {
    /// Weights of (p, q), penetration, slip and wear turned into weights of the inputs.
    fn weighted(&self, of: &[f64; 8]) -> [f64; INPUTS] {
        let [p, q1, q2, penetration, s1, s2, worn, at_level] = *of;
        let mut all = self.back(&[0.0, 0.0, 0.0, penetration, s1, s2, worn, at_level]);
        [p, q1, q2].iter().zip(&mut all[3..6]).for_each(|(of, all)| *all += of);
        all
    }
}

/// Values of the equations at −2h, −h, 0, h and 2h of a parameter.
pub(super) struct Around<'a> {
    pub h: f64,
    pub all: [&'a StepResidual; 5],
}

impl Multiplied {
    /// The multipliers of (4.1) and (4.2), node-major.
    pub fn of_step(&self) -> [&[f64]; 2] {
        [&self.transposed.y, &self.heat[0]]
    }

    /// The derivative of the output by a parameter through this step, how much of a kink there is, as
    /// [`stencil::central`] has it, and the round-off of both; `through` are the derivatives of (4.1) and (4.2) that
    /// are known, and `size` that of the numbers whose sum it is.
    pub fn by_parameter(&self, around: &Around, through: &[Option<Vec<f64>>; 2], size: f64) -> [f64; 3] {
        let [slope, kink] = self.product(around);
        let of_points = self.of_defects(around);
        let known = through.iter().zip([&self.transposed.y, &self.heat[0]]);
        let known: f64 = known.filter_map(|(of, y)| of.as_ref().map(|of| dot(y, of))).sum();
        [slope - known - of_points[0], kink - of_points[1], f64::EPSILON * size / around.h]
    }

    /// The sizes of the numbers whose sum [`Multiplied::product`] is.
    pub fn size(&self, of: &StepResidual) -> f64 {
        let sum = |values: &[f64]| values.iter().map(|value| value.abs()).sum::<f64>();
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a * b).abs()).sum::<f64>();
        let Multiplied { transposed, heat: [heat, held], after, areas, driven, .. } = self;
        let traction = largest_traction(&of.states);
        let mu = transposed.points.iter().zip(areas).map(|(mu, area)| area * sum(mu)).sum::<f64>();
        of.sizes[0] * sum(&transposed.y)
            + of.sizes[1] * sum(heat)
            + traction * mu
            + product(&transposed.prescribed, &of.body.rates)
            + product(held, &of.body.temperatures)
            + product(&after.u, &of.body.u)
            + product(&after.work, &of.work)
            + product(driven, &of.driving)
            + product(&self.foundations, &of.warming)
    }

    /// The derivative and the kink of the sum of all equations but those of the contact points, and of what follows
    /// from the unknowns. Differences are taken of each number, so that those that do not change add no round-off.
    fn product(&self, around: &Around) -> [f64; 2] {
        let Multiplied { transposed, heat: [heat, held], on_contact: [y, y_heat], after, .. } = self;
        let (h, all) = (around.h, &around.all);
        let mut sum = [0.0; 2];
        let mut take = |factor: f64, [slope, kink]: [f64; 2]| sum = [sum[0] + factor * slope, sum[1] + factor * kink];
        // The multipliers have no components along held degrees of freedom.
        take(-1.0, stencil::product(h, y, all.map(|of| &of.exerted[..])));
        take(-1.0, stencil::product(h, y_heat, all.map(|of| &of.passed[..])));
        take(1.0, stencil::product(h, &after.work, all.map(|of| &of.work[..])));
        take(-1.0, stencil::product(h, &self.driven, all.map(|of| &of.lacking[..])));
        take(-1.0, stencil::product(h, &self.foundations, all.map(|of| &of.missing[..])));
        take(1.0, stencil::product(h, &self.wear, all.map(|of| &of.worn[..])));
        take(1.0, stencil::product(h, &after.depths.concat(), all.map(|of| &of.grown[..])));
        if around.have_same_body() {
            return sum;
        }
        let mut add = |factor: f64, weights: &[f64], of: &dyn Fn(&BodyResidual) -> &[f64]| {
            take(factor, stencil::product(h, weights, all.map(|all| of(&all.body))));
        };
        add(1.0, &transposed.prescribed, &|of| &of.rates);
        add(1.0, held, &|of| &of.temperatures);
        add(-1.0, &transposed.y, &|of| &of.mechanics);
        add(-1.0, heat, &|of| &of.heat);
        add(1.0, &after.u, &|of| &of.u);
        add(1.0, &after.theta_rate, &|of| &of.theta_rate);
        if heat.is_empty() {
            add(1.0, &after.theta, &|of| &of.temperatures);
        }
        for (i, weights) in after.branches.iter().enumerate() {
            add(1.0, weights, &|of| of.branches.get(i).map_or(&[], |branch| branch));
        }
        sum
    }

    /// The same of the equations of the contact points, on the branch of the solution; NaN if a difference of this step
    /// leaves it on both sides.
    fn of_defects(&self, around: &Around) -> [f64; 2] {
        let mut sum = [0.0; 2];
        for (i, (mu, area)) in self.transposed.points.iter().zip(&self.areas).enumerate() {
            let slopes = around.slopes(i, self.branches[i]);
            for (sum, slope) in sum.iter_mut().zip(slopes) {
                *sum += area * inner(mu, &slope);
            }
        }
        sum
    }
}

impl Around<'_> {
    /// True if the parameter changes nothing but contact.
    pub fn have_same_body(&self) -> bool {
        self.all.iter().all(|residual| Arc::ptr_eq(&residual.body, &self.all[2].body))
    }

    /// The derivative of the defect of a point on a branch, and how much of a kink it has.
    pub fn slopes(&self, i: usize, branch: [bool; 2]) -> [Local; 2] {
        let (values, h) = (self.all.map(|residual| residual.points[i]), self.h);
        let [a, b, at, c, d] = values.map(|point| point.defect);
        // A parameter that leaves the point on another branch does not tell them apart.
        let alike = values.iter().all(|point| point.branch == values[2].branch);
        if alike || values.iter().all(|point| point.branch == branch) {
            return stencil::central(h, [&a, &b, &at, &c, &d]);
        }
        let on = |of: [usize; 2]| of.iter().all(|&j| values[j].branch == branch);
        // To one side of second order: the second difference is zero of a law that is linear on the branch.
        let one_sided = |near: Local, far: Local, h: f64| {
            let slope: Local = std::array::from_fn(|k| (4.0 * near[k] - 3.0 * at[k] - far[k]) / (2.0 * h));
            [slope, std::array::from_fn(|k| ((far[k] - near[k]) - (near[k] - at[k])) / h)]
        };
        match (on([0, 1]), on([3, 4])) {
            (_, true) => one_sided(c, d, h),
            (true, false) => one_sided(b, a, 0.0 - h),
            (false, false) => [[f64::NAN; 3]; 2],
        }
    }
}
