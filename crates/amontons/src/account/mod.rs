//! The ledger after a step: every term of the energy and heat identities.

use std::borrow::Cow;

use crate::arrays::per_point;
use crate::contact::{GraphKind, MeanPressure, PointOnBoundary, arrays};
use crate::discretization::Relaxed;
use crate::equation::acting::contacts_at;
use crate::equation::foundation::frames;
use crate::equation::heat::{Amounts, Heat};
use crate::equation::mechanics::Mechanics;
use crate::equation::power::Powers;
use crate::equation::system::{Step, difference};
use crate::inclusion::{Frame, PointState};
use crate::linalg::dot;
use crate::state::Ledger;
use crate::tensor::{self, Point};
use crate::time::{Interval, Start};

/// Closing error, relative to the energy or heat turned over, above which the round-off of the terms is examined.
const TELLING: f64 = 1e-11;

/// The ledger after a step.
pub(crate) fn audit(step: &Step, m: &Mechanics, heat: &Heat) -> Ledger {
    let before = &step.old.ledger;
    let theta = step.end(&step.old.theta, heat.theta.clone());
    let energy = Energy::of(step, m, &theta);
    let error = energy.error(before);
    // If a body only moves rigidly, its stresses are round-off and no energy is turned over, nor if nothing but an
    // overlap at the start has strained it. The identity then counts as closed if the error is within the round-off of
    // its terms: of the work in the step, and of the energies before and after it.
    let mut turned_over = energy.load_work.abs() + energy.thermal_work.abs() + energy.modulus_work.abs();
    if (before.closing_error + error).abs() > TELLING * (before.turned_over + turned_over) {
        let moved = step.sizes(m.moving());
        let sizes = absolute(&moved, &step.discrete.elastic_sizes(&moved, &m.theta));
        turned_over += explained(error, sizes + energy.contact.abs() + before.contact_energy.abs());
    }

    let heat_content = step.discrete.storage().0 * heat.amounts.stored;
    let Amounts { supplied, coupling, contact, rubbed, prescribed, .. } = heat.amounts;
    let scheme = step.discrete.storage().0 * heat.amounts.scheme;
    let foundations = foundations(step, m, heat);
    let body = (heat_content - before.heat_content) + scheme + contact + prescribed - supplied - coupling - rubbed;
    let heat_error = body + foundations.error;
    let mut heat_moved =
        contact.abs() + prescribed.abs() + supplied.abs() + coupling.abs() + rubbed.abs() + foundations.moved;
    if (before.heat_closing_error + heat_error).abs() > TELLING * (before.heat_turned_over + heat_moved) {
        heat_moved += explained(heat_error, heat_sizes(step, heat));
    }
    Ledger {
        kinetic: energy.kinetic,
        elastic: energy.elastic,
        viscous_dissipation: before.viscous_dissipation + energy.viscous,
        friction_dissipation: before.friction_dissipation + energy.friction,
        contact_energy: energy.contact,
        load_work: before.load_work + energy.load_work,
        thermal_work: before.thermal_work + energy.thermal_work,
        modulus_work: before.modulus_work + energy.modulus_work,
        scheme_dissipation: before.scheme_dissipation + energy.scheme,
        wear_dissipation: before.wear_dissipation + energy.worn,
        impact_dissipation: before.impact_dissipation + energy.impact,
        closing_error: before.closing_error + error,
        turned_over: before.turned_over + turned_over,
        heat_content,
        heat_contact: before.heat_contact + contact,
        heat_prescribed: before.heat_prescribed + prescribed,
        heat_supplied: before.heat_supplied + supplied,
        heat_coupling: before.heat_coupling + coupling,
        heat_friction: before.heat_friction + if step.problem.physics.has_heat() { energy.friction } else { 0.0 },
        heat_pairs: before.heat_pairs + rubbed,
        heat_scheme: before.heat_scheme + scheme + foundations.scheme,
        heat_foundation: foundations.content,
        heat_surroundings: before.heat_surroundings + foundations.lost,
        heat_closing_error: before.heat_closing_error + heat_error,
        heat_turned_over: before.heat_turned_over + heat_moved,
    }
}

/// The terms of the identity of energy over a step, J.
struct Energy {
    /// Energy, dissipation and work on Γ_C in the step. `load_work` is the work of loads and supports, J.
    kinetic: f64,
    elastic: f64,
    contact: f64,
    /// Dissipated in it: by viscosity, friction, wear, impacts and the scheme.
    viscous: f64,
    friction: f64,
    worn: f64,
    impact: f64,
    scheme: f64,
    /// Work of the loads, the supports and the foundation; of heat; and of moduli and stiffnesses that change.
    load_work: f64,
    thermal_work: f64,
    modulus_work: f64,
}

impl Energy {
    fn of(step: &Step, m: &Mechanics, theta: &[f64]) -> Energy {
        let Step { old, rule, .. } = *step;
        let (rho, k) = (step.inertia(), rule.moving());
        // A step without inertia drops the kinetic energy of the steps before.
        let dropped = if rule.analysis.has_inertia() { 0.0 } else { old.ledger.kinetic };
        let stored = stored(step, m, theta);
        let Powers { kinetic, inertial, viscous, thermal: thermal_work, load: work, .. } = m.end.powers;
        let contact = contact(step, m, k * work + m.end.support_work);
        let compliance = contact.pressing
            - contact.damping
            - contact.worn
            - contact.impact
            - (contact.energy - old.ledger.contact_energy)
            + contact.stiffening;
        let kinetic = 0.5 * rho * kinetic;
        let of_inertia = match step.rule.start {
            Start::State => (step.rule.level - 0.5) * rho * inertial,
            Start::Admissible => rho * inertial,
            Start::TwoStates => k / step.rule.delta * rho * inertial - (kinetic - old.ledger.kinetic),
        };
        Energy {
            kinetic,
            elastic: stored.elastic,
            contact: contact.energy,
            viscous: k * viscous + stored.relaxed + contact.damping,
            friction: contact.friction,
            worn: contact.worn,
            impact: contact.impact,
            scheme: of_inertia + stored.scheme + compliance + dropped - m.end.massless_work,
            load_work: contact.load_work,
            thermal_work: k * thermal_work,
            modulus_work: stored.modulus + contact.stiffening,
        }
    }

    /// Left minus right side of the identity.
    fn error(&self, before: &Ledger) -> f64 {
        (self.kinetic - before.kinetic)
            + (self.elastic - before.elastic)
            + (self.contact - before.contact_energy)
            + self.viscous
            + self.friction
            + self.worn
            + self.impact
            + self.scheme
            - self.load_work
            - self.thermal_work
            - self.modulus_work
    }
}

/// Stored energy, dissipation and work of the tractions on Γ_C in a step, J.
#[derive(Default)]
struct OnContact {
    /// Energy stored in the compliance at the end of the step, and its increase by a stiffness that changes with time.
    energy: f64,
    stiffening: f64,
    friction: f64,
    /// Work of the pressure along the change of the penetration, wear included.
    pressing: f64,
    /// Shares of this work: dissipated by damped layers, lost with wear, and taken by impacts on rigid foundations.
    damping: f64,
    worn: f64,
    impact: f64,
    /// Work of the loads, the supports and a moving foundation.
    load_work: f64,
}

/// With the work of loads and supports.
fn contact(step: &Step, m: &Mechanics, load_work: f64) -> OnContact {
    let Step { contacts, discrete, boundary, old, rule, .. } = *step;
    let k = rule.moving();
    let changes = contacts.iter().any(|contact| contact.normal.at_time(step.level).is_some());
    let mut sum = OnContact { load_work, ..OnContact::default() };
    // Energy at the end of the step less the work along the penetration, with the laws at the time of the equations.
    let mut start = 0.0;
    let at_end = if changes { contacts_at(step.problem, step.t) } else { Cow::Borrowed(contacts) };
    let starts = if changes || damps(step) { penetrations_before(step, m) } else { vec![0.0; boundary.points.len()] };
    let asked = per_point(&arrays(contacts), boundary.points.len().min(m.end.states.len()), |i| {
        let (point, state) = (&boundary.points[i], &m.end.states[i]);
        let energy = at_end[point.contact].normal.potential(&point.x, state.penetration);
        (energy, at_rest(step, point, state, starts.get(i).copied()))
    });
    let states = m.end.states.iter().zip(&asked).zip(&starts);
    for ((point, frame), ((state, (energy, at_rest)), before)) in
        boundary.points.iter().zip(&m.given.frames).zip(states)
    {
        let (normal, weight) = (&contacts[point.contact].normal, k * point.weight);
        let w_nu = tensor::dot(&boundary.vector_at(point, discrete.mesh.dim, m.w()), &state.normal);
        if changes {
            let along = [state.penetration, *before].map(|r| normal.potential(&point.x, r));
            start += point.weight * (energy - (along[0] - along[1]));
        }
        let rubbed = step.rubbing(frame) * point.weight * tensor::dot(&state.q, &state.slip);
        sum.friction += rubbed;
        sum.energy += point.weight * energy;
        sum.pressing += weight * state.pressure * (w_nu - frame.gap_rate);
        sum.worn += point.weight * state.pressure * state.opened;
        if step.rule.contact.is_some() && normal.is_rigid() {
            sum.impact += state.pressure * (weight * (w_nu - frame.gap_rate) - point.weight * state.opened);
        }
        if let Some(at_rest) = at_rest {
            // The pressure in excess of the pressure at rest dissipates along [r] = k (w_ν − ġ) − [h]; along [h] the
            // whole pressure is lost with wear.
            let beyond = state.pressure - at_rest;
            sum.damping += point.weight * beyond * (k * (w_nu - frame.gap_rate) - state.opened);
        }
        sum.load_work -= if rule.is_steady() && frame.slides {
            // On the way to the steady state the foundation goes along with the body; then it slides.
            let w = boundary.vector_at(point, discrete.mesh.dim, m.w());
            weight * (state.pressure * frame.gap_rate + tensor::dot(&state.q, &w)) - rubbed
        } else {
            weight * (state.pressure * frame.gap_rate + tensor::dot(&state.q, &frame.velocity))
        };
    }
    if changes {
        sum.stiffening = start - old.ledger.contact_energy;
    }
    sum
}

/// The penetration of each point at the start of the step: r₀ = r₁ − k (w_ν − ġ) + [h], or of a step that adds to two
/// states, in which nothing wears, that of the state there.
fn penetrations_before(step: &Step, m: &Mechanics) -> Vec<f64> {
    let Step { problem, boundary, old, .. } = *step;
    let along = |point: &PointOnBoundary, v: &[f64], normal: &Point| {
        tensor::dot(&boundary.vector_at(point, step.discrete.mesh.dim, v), normal)
    };
    let points = boundary.points.iter();
    if step.rule.is_of_one_step() {
        let of = |(point, (frame, state)): (_, (&Frame, &PointState))| {
            let w_nu = along(point, m.w(), &state.normal);
            state.penetration - step.rule.moving() * (w_nu - frame.gap_rate) + state.opened
        };
        return points.zip(m.given.frames.iter().zip(&m.end.states)).map(of).collect();
    }
    let advance = [&*old.surface.advance; 2];
    let frames = frames(problem, boundary, &old.u, (&step.worn(), advance), Interval::at(old.t));
    points.zip(&frames).map(|(point, frame)| along(point, &old.u, &frame.normal) - frame.gap).collect()
}

/// True if pressures that are means over the step depend on a rate.
fn damps(step: &Step) -> bool {
    let are_means = !step.rule.is_at_end() && !step.rule.balances_contact_at_end();
    are_means && step.contacts.iter().any(|contact| contact.normal.lipschitz_in_rate() != Some(0.0))
}

/// The pressure of a layer without damping, or `None` where pressures do not depend on the rate.
///
/// At the end of the step it is asked of every function: what a multiplier is beyond the law is round-off there.
fn at_rest(step: &Step, point: &PointOnBoundary, state: &PointState, start: Option<f64>) -> Option<f64> {
    let normal = step.contacts[point.contact].normal.as_ref();
    if normal.graph() != GraphKind::Function {
        return None;
    }
    if step.rule.is_at_end() || step.rule.balances_contact_at_end() {
        return Some(normal.pressure(&point.x, state.penetration, 0.0, 0.0).value);
    }
    let mean = MeanPressure::of(normal, start?, &step.rule);
    (normal.lipschitz_in_rate() != Some(0.0)).then(|| mean.at_rest(&point.x, state.penetration).value)
}

/// Sum of the absolute heat contents and flows of a step, which may cancel over the body.
fn heat_sizes(step: &Step, heat: &Heat) -> f64 {
    let (c, storage) = step.discrete.storage();
    let sum = |sizes: Vec<f64>| sizes.iter().sum::<f64>();
    step.rule.k * sum(step.discrete.d.magnitude(&heat.theta))
        + c * (sum(storage.magnitude(&heat.theta)) + sum(storage.magnitude(&step.old.theta)))
}

/// Size of the cancelling terms if the error is within their round-off (4 ε · size), else 0.
fn explained(error: f64, size: f64) -> f64 {
    if error.abs() <= 4.0 * f64::EPSILON * size { size } else { 0.0 }
}

/// Σ |a_i| b_i.
fn absolute(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.abs() * b).sum()
}

/// Energy that the body stores after a step, and the dissipation in the step without viscosity.
struct Stored {
    /// Energy stored in elasticity, springs and branches, J.
    elastic: f64,
    /// Dissipated by the dashpots of the branches, J.
    relaxed: f64,
    /// Dissipated by the scheme, J.
    scheme: f64,
    /// Energy increase by moduli that change with the temperature, J.
    modulus: f64,
}

/// Stored energy and dissipation of a step. `theta` is the temperature at the end of the step.
fn stored(step: &Step, m: &Mechanics, theta: &[f64]) -> Stored {
    let Step { discrete, old, .. } = *step;
    let mut branches = 0.0;
    let mut sum = if discrete.is_linear() {
        let (elastic, strained) = (0.5 * m.end.powers.elastic, m.end.powers.strained);
        let scheme = match step.rule.start {
            Start::State | Start::Admissible => (step.rule.level - 0.5) * strained,
            Start::TwoStates => step.rule.k * strained - (elastic - before(step)),
        };
        Stored { elastic, relaxed: 0.0, scheme, modulus: 0.0 }
    } else if let Some(sum) = softening(step, m, theta) {
        sum
    } else {
        // The stress work in excess of the change of the potential is dissipated by the scheme. Without a potential the
        // work is treated as stored.
        let end = step.end(&old.u, m.u().to_vec());
        let work = dot(&moved(step, m, &end), &m.end.at.a_u);
        let before = before(step);
        let elastic = discrete.stored_energy(&end, &m.theta).unwrap_or(before + work);
        Stored { elastic, relaxed: 0.0, scheme: work - (elastic - before), modulus: 0.0 }
    };
    let starts = old.branches.iter().zip(step.bar.branches);
    for ((branch, at_level), (old, bar)) in discrete.branches.iter().zip(&m.branches).zip(starts) {
        let Relaxed { stored, dissipated, scheme } = branch.balance(step.rule, [old, bar], at_level);
        branches += stored;
        sum.relaxed += dissipated;
        sum.scheme += scheme;
    }
    sum.elastic += branches;
    sum
}

/// The displacement along which the stress of a step works: its change, or k w of a step that adds to two states.
fn moved(step: &Step, m: &Mechanics, end: &[f64]) -> Vec<f64> {
    match step.rule.start {
        Start::State | Start::Admissible => difference(end, &step.old.u),
        Start::TwoStates => m.moving().iter().map(|w| step.rule.k * w).collect(),
    }
}

/// Energy of the body at the start of a step, without the branches.
fn before(step: &Step) -> f64 {
    let branches = step.old.branches.iter().zip(&step.discrete.branches);
    step.old.ledger.elastic - branches.map(|(state, branch)| branch.energy(state)).sum::<f64>()
}

/// The stored energy for laws that depend on the temperature, or `None` if no law does or one has no potential.
///
/// With W(u, θ) the energy and θ̂ the temperature that (4.1) was made with, the stress works W(u_n, θ̂) − W(u_{n−1},
/// θ̂) and what the scheme dissipates. The energy at t is W(u_n, θ_n): its change beyond that work is made by the
/// moduli, which change at a fixed strain.
fn softening(step: &Step, m: &Mechanics, theta: &[f64]) -> Option<Stored> {
    let Step { discrete, old, .. } = *step;
    if !discrete.softens() {
        return None;
    }
    let energy = |u: &[f64], theta: &[f64]| discrete.stored_energy(u, theta);
    let end = step.end(&old.u, m.u().to_vec());
    let [to, elastic] = [energy(&end, &m.theta)?, energy(&end, theta)?];
    let from = if m.theta == old.theta { before(step) } else { energy(&old.u, &m.theta)? };
    let change = moved(step, m, &end);
    let scheme = if discrete.is_linearly_elastic() && step.rule.is_of_one_step() {
        (step.rule.level - 0.5) * dot(&change, &discrete.apply_a(&change, &m.theta))
    } else {
        dot(&change, &m.end.at.a_u) - (to - from)
    };
    Some(Stored { elastic, relaxed: 0.0, scheme, modulus: (from - before(step)) + (elastic - to) })
}

/// The foundations with a heat capacity after a step, J.
#[derive(Default)]
struct Foundations {
    content: f64,
    /// What the rate of the step times k is beyond the change of their content.
    scheme: f64,
    /// Heat lost to the surroundings in the step.
    lost: f64,
    /// Change of content minus what came in plus what went out, and the absolute amounts.
    error: f64,
    moved: f64,
}

fn foundations(step: &Step, m: &Mechanics, heat: &Heat) -> Foundations {
    let mut sum = Foundations::default();
    for (side, contact) in step.problem.contacts.iter().enumerate() {
        let at = |all: &[Option<f64>]| all.get(side).copied().flatten();
        let all = [&step.old.surface.foundation, step.bar.foundation, &heat.exchange.foundation].map(at);
        let (Some(foundation), [Some(before), Some(bar), Some(at_level)]) = (&contact.foundation_heat, all) else {
            continue;
        };
        let after = step.rule.end([before, at_level]);
        let points = step
            .boundary
            .points
            .iter()
            .zip(&m.end.states)
            .zip(&heat.exchange.flux)
            .filter(|((point, _), _)| point.contact == side);
        let received: f64 = points
            .map(|((point, state), flux)| {
                step.rule.k * point.weight * (flux.value + tensor::dot(&state.q, &state.slip))
            })
            .sum();
        let lost =
            step.rule.k * foundation.exchange * (at_level - foundation.surroundings.value(&[0.0; 3], step.level));
        sum.content += foundation.capacity * after;
        sum.lost += lost;
        let kept = match step.rule.start {
            Start::State if step.rule.is_steady() => 0.0,
            Start::State | Start::Admissible => foundation.capacity * (after - before),
            Start::TwoStates => step.rule.k / step.rule.delta * foundation.capacity * (at_level - bar),
        };
        sum.scheme += kept - foundation.capacity * (after - before);
        sum.error += kept - received + lost;
        sum.moved += received.abs() + lost.abs();
    }
    sum
}
