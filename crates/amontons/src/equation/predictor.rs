//! The velocity that a step of the contact-stabilised scheme starts from.

use std::sync::Arc;

use super::StepError;
use super::given::Given;
use super::system::{ACCEPTED, Bar, HalfStep, REFINE, Step, contact_forces};
use crate::contact::{Compliance, Contact, Frictionless, GraphKind};
use crate::inclusion::residual::Residual;
use crate::inclusion::{Loose, Multipliers, PointState};
use crate::linalg::{map, max_abs, zeros};
use crate::problem::Problem;
use crate::time::{Rule, Start};

/// Roundings of half a last bit or less that a penetration may contain.
const ROUNDINGS: f64 = 16.0;

/// The admissible velocity nearest to w₀ in the norm of the kinetic energy: v with M (v − w₀)/k + Σ ω Nᵀ p ν = 0,
/// 0 ≤ p ⊥ r₀ + k (v_ν − v_g) ≤ 0 at the points of rigid foundations. It is a step on Γ_C with M in the place of K.
///
/// Prescribed degrees of freedom keep w₀, as all do where no rigid contact acts: the step is then that of the ϑ-scheme
/// at ϑ = ½, prescribed accelerations and their reactions included. Layers and friction act in the step alone; ties
/// hold both sides together in both.
pub(crate) struct Admissible {
    w: Vec<f64>,
    /// The product with the form of inertia, as in [`Bar`].
    mass_w: Vec<f64>,
}

impl Admissible {
    /// What the step adds to, with this velocity in the place of w₀.
    pub fn bar<'a>(&'a self, bar: Bar<'a>) -> Bar<'a> {
        Bar { w: &self.w, mass_w: &self.mass_w, ..bar }
    }
}

/// Returns true if the steps of a rule start from an admissible velocity that may differ from w₀: a body with inertia
/// has a rigid contact.
pub(crate) fn acts(problem: &Problem, rule: &Rule) -> bool {
    rule.start == Start::Admissible
        && problem.physics.has_mechanics()
        && problem.contacts.iter().any(|contact| contact.normal.is_rigid())
}

/// A contact in the predictor: a rigid foundation without friction, or a tie; a layer bears nothing.
fn without_friction(contact: &Contact) -> Contact {
    let mut own = Contact { wear: None, ..contact.clone() };
    if !contact.normal.is_rigid() {
        own.normal = Compliance { stiffness: 0.0 }.into();
    }
    if !contact.normal.is_rigid() || !contact.friction.never_slips() {
        own.friction = Frictionless.into();
    }
    own
}

/// The admissible velocity of a step, by the factor of M/k.
///
/// # Errors
/// If the problem on Γ_C is not solved.
pub(crate) fn admissible(step: &Step, half: &mut HalfStep) -> Result<Admissible, StepError> {
    let (contacts, loose) =
        (step.contacts.iter().map(without_friction).collect::<Vec<Contact>>(), Arc::new(Loose::default()));
    let step = &Step { contacts: &contacts, loose: &loose, rule: Rule::backward_euler(step.rule.k), ..*step };
    let start = &step.old.w;
    let mut v = start.clone();
    let rigid = step.take(&mut v);
    let own = Given::new(step, start).at(vec![0.0; step.boundary.points.len()]);
    let round_off = round_off(step, &own);
    let given = if step.apart.is_some() { own.relative(step, &rigid, &v) } else { own };

    let mut multipliers = Multipliers::free(step.old.multipliers.sticks.clone());
    if is_admissible(step, &given.states(step, half, &v, &multipliers), round_off) {
        return Ok(Admissible { w: start.clone(), mass_w: step.products.mass_w.clone() });
    }
    let (rho, form) = step.discrete.inertia();
    let scale = rho / step.rule.k;
    // The change v − w₀, with all its digits, and M (v − w₀)/k.
    let (mut change, mut inertia, mut previous) = (zeros(v.len()), zeros(v.len()), f64::INFINITY);
    loop {
        let right: Vec<f64> = inertia.iter().map(|force| -force).collect();
        let now = map([&v, &change], |[v, change]| v + change);
        let states = solve(step, half, &given, &mut multipliers, (&right, &now, &mut change))?;
        inertia = form.apply(&change).iter().map(|momentum| scale * momentum).collect();
        let residual = residual(step, &inertia, &states)?;
        let ratio = residual.value / previous;
        if residual.value <= REFINE || ratio >= 0.5 {
            // A body that rests moves by the round-off of its gaps only, and all forces are round-off.
            let least = || scale * max_abs(&form.magnitude(&vec![1.0; v.len()])) * round_off / step.rule.k;
            if residual.value > ACCEPTED && residual.value * residual.scale > least() {
                let (residual, accepted) = (residual.value, ACCEPTED);
                return Err(StepError::Residual { step: step.n, t: step.t, part: "mechanics", residual, accepted });
            }
            break;
        }
        previous = residual.value;
    }
    let of_start = form.apply(&change);
    Ok(Admissible {
        w: map([start, &change], |[w, change]| w + change),
        mass_w: map([&step.products.mass_w, &of_start], |[before, change]| before + change),
    })
}

/// Round-off of penetrations, m.
fn round_off(step: &Step, given: &Given) -> f64 {
    let gap = given.frames.iter().map(|frame| frame.gap.abs()).fold(0.0, f64::max);
    let moved = max_abs(&step.on_contact(&step.old.u)) + step.rule.k * max_abs(&step.old.w);
    ROUNDINGS * f64::EPSILON * (gap + moved)
}

/// Returns true if no point would be inside a rigid foundation at the end of the step, but for round-off, and none is
/// tied.
fn is_admissible(step: &Step, states: &[PointState], round_off: f64) -> bool {
    step.boundary.points.iter().zip(states).all(|(point, state)| {
        match step.contacts.get(point.contact).map(|contact| contact.normal.graph()) {
            _ if point.weight == 0.0 => true,
            Some(GraphKind::Bilateral) => false,
            Some(GraphKind::Multivalued) => state.penetration <= round_off,
            Some(GraphKind::Function) | None => true,
        }
    })
}

/// Solves the problem on Γ_C from a velocity, and adds the increment to the change of the velocity.
fn solve(
    step: &Step,
    half: &mut HalfStep,
    given: &Given,
    multipliers: &mut Multipliers,
    (right, now, change): (&[f64], &[f64], &mut [f64]),
) -> Result<Vec<PointState>, StepError> {
    let unsolved = |source| step.unsolved("mechanics", source);
    let HalfStep { system, on_contact, .. } = half;
    let mut x = system.reduce(right).map_err(unsolved)?;
    let Some(mut term) = given.term(step, system, on_contact) else { return Ok(Vec::new()) };
    let guess = system.kept_of(now);
    system
        .settle(&mut x, now, |condensed, r| {
            let solved = term.solve(condensed, r, &guess, multipliers)?;
            Ok((solved.x, ()))
        })
        .map_err(|why| step.failed("mechanics", why))?;
    let increments = &x[system.unknowns().interior..];
    let kept: Vec<f64> = guess.iter().zip(increments).map(|(value, increment)| value + increment).collect();
    let states = term.point_states(&kept, multipliers);
    let increment = system.expand(x, &zeros(now.len())).map_err(unsolved)?;
    step.finite(&increment, "mechanics")?;
    change.iter_mut().zip(&increment).for_each(|(change, more)| *change += more);
    Ok(states)
}

/// The residual of M (v − w₀)/k + Σ ω Nᵀ (p ν + q) = 0, relative to its larger term.
fn residual(step: &Step, inertia: &[f64], states: &[PointState]) -> Result<Residual, StepError> {
    let space = &step.discrete.v;
    let (_, force) = contact_forces(step, states);
    let mut rest = map([inertia, &force], |[inertia, force]| inertia + force);
    space.gather(&mut rest);
    space.mask(&mut rest);
    let (acting, contact) = (max_abs(inertia), max_abs(&force));
    let scale = acting.max(contact);
    let value = step.relative(max_abs(&rest), scale, "mechanics")?;
    Ok(Residual { value, scale, acting, contact })
}
