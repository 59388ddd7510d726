//! The derivatives of the equations of the contact points at a solution, and how near the points are to a kink.

pub(super) use super::advance::INPUTS;
use super::advance::{PointAdvance, advances};
use super::balances::bound;
use super::exerted::fluid_at;
use super::instance::{ProblemInstance, SolvedStep, data, inputs};
use super::stencil::derivative;
use crate::contact::{Contact, GraphKind, Status};
use crate::inclusion::{Local, LocalTangent, Mechanical, PointInput, PointOutput, PointState};
use crate::linalg::max_abs;
use crate::tensor::{Point, dot, length};
use crate::time::Rule;

/// Margin up to which a contact point counts as on a change of its state.
pub(super) const TOUCHES: f64 = 1e-9;
/// Number of outputs of a point.
pub(super) const OUTPUTS: usize = 8;

/// The equations of a contact point, linearised at a solution.
#[derive(Clone, Copy, Debug)]
pub(super) struct LinearPoint {
    /// ν, t₁ and t₂.
    pub basis: [Point; 3],
    /// Slip velocity along the tangents, m/s.
    pub slip: [f64; 2],
    /// (p, q) in the basis, Pa.
    pub force: Local,
    /// Time for which friction works in the step, s.
    pub rubbing: f64,
    /// The branch of the laws.
    pub branch: [bool; 2],
    /// True if the point may open: its contact is not bilateral.
    pub may_open: bool,
    /// Derivatives by input: jump of the velocities (3), (p, q) (3), ū_ν − g, and temperature; of defect (3),
    /// penetration, slip (2), wear depth, and penetration at the time of the equations.
    pub by: [[f64; OUTPUTS]; INPUTS],
    /// The number of its contact, and the changes with δ of this contact.
    pub contact: usize,
    pub advance: PointAdvance,
    /// Pressure of a fluid, Pa.
    pub fluid: f64,
}

impl LinearPoint {
    /// Derivative of the defect in the velocity, rows the defect.
    pub fn by_velocity(&self) -> LocalTangent {
        std::array::from_fn(|a| std::array::from_fn(|b| self.by[b][a]))
    }

    /// Derivative of the defect in the force.
    pub fn by_force(&self) -> LocalTangent {
        std::array::from_fn(|a| std::array::from_fn(|b| self.by[b + 3][a]))
    }

    /// Weights of the outputs turned into weights of the inputs.
    pub fn back(&self, outputs: &[f64; OUTPUTS]) -> [f64; INPUTS] {
        self.by.map(|by| by.iter().zip(outputs).map(|(by, output)| by * output).sum())
    }
}

/// A branch on which a point is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Forced {
    /// The step n and the contact point.
    pub n: usize,
    pub point: usize,
    pub branch: [bool; 2],
}

/// (p, q) of the points in their bases.
pub(super) fn forces(term: Option<&Mechanical>, states: &[PointState]) -> Vec<Local> {
    let Some(term) = term else { return Vec::new() };
    let of = |(i, state): (usize, &PointState)| {
        let [_, t1, t2] = term.basis(i);
        [state.pressure, dot(&t1, &state.q), dot(&t2, &state.q)]
    };
    states.iter().enumerate().map(of).collect()
}

/// The linearised points of a step, or the first one that no direction leaves on its branch.
pub(super) fn linearised(
    base: &ProblemInstance,
    of: &SolvedStep,
    forced: Option<&Forced>,
) -> Result<Vec<LinearPoint>, usize> {
    base.step(of.n, of.old, |step| {
        let given = data(step, of.at);
        let Some(term) = given.frozen(step, of.unknown, of.chosen) else { return Ok(Vec::new()) };
        let inputs = inputs(step, &given, &term, of.at, &forces(Some(&term), of.states));
        let outputs: Vec<PointOutput> = inputs.iter().enumerate().map(|(i, at)| term.equations(i, at)).collect();
        let scales = InputScales::new(of, &inputs, &outputs, step.rule.span);
        let advances = advances(step, of)?;
        let all = inputs.iter().zip(&outputs).zip(given.frames.iter().zip(&advances)).enumerate();
        all.map(|(i, ((input, output), (frame, advance)))| {
            let branch = forced
                .filter(|forced| forced.n == of.n && forced.point == i)
                .map_or(output.branch, |forced| forced.branch);
            let mut by = [[0.0; OUTPUTS]; INPUTS];
            let (rubs, sizes) = (term.rubs_along(i), scales.sizes(i, output));
            for (j, by) in by.iter_mut().enumerate() {
                // Along these tangents nothing moves and nothing rubs.
                if let 1 | 2 | 4 | 5 = j
                    && !rubs[(j - 1) % 3]
                {
                    by[j % 3] = if j > 2 { 1.0 } else { 0.0 };
                    continue;
                }
                // The pressure of a point that nothing unknown moves is zero, at a kink of what wears off by it.
                if j == 3 && term.is_given(i) {
                    by[0] = 1.0;
                    continue;
                }
                let at = |change: f64| {
                    let output = term.equations(i, &changed(input, j, change));
                    (numbers(&output), output.branch)
                };
                *by = derivative(at, scales.of(i, j), sizes, branch).ok_or(i)?;
            }
            let number = step.boundary.points.get(i).map_or(0, |on| on.contact);
            let contact = step.contacts.get(number);
            Ok(LinearPoint {
                contact: number,
                advance: *advance,
                fluid: fluid_at(step, i, &of.new.surface.wet.points),
                may_open: contact.is_none_or(|contact| contact.normal.graph() != GraphKind::Bilateral),
                basis: term.basis(i),
                slip: output.slip,
                force: input.force,
                rubbing: step.rubbing(frame),
                branch,
                by,
            })
        })
        .collect()
    })
}

fn numbers(output: &PointOutput) -> [f64; OUTPUTS] {
    let PointOutput { defect: [a, b, c], penetration, at_level, slip: [s1, s2], worn, .. } = *output;
    [a, b, c, penetration, s1, s2, worn, at_level]
}

fn changed(input: &PointInput, j: usize, by: f64) -> PointInput {
    let mut input = *input;
    match j {
        0..3 => input.velocity[j] += by,
        3..6 => input.force[j - 3] += by,
        6 => input.opening += by,
        _ => input.temperature += by,
    }
    input
}

/// InputScales of the inputs of each point: those of its own penetration, traction and slip, or the largest ones of all
/// points where it has none.
struct InputScales(Vec<[f64; INPUTS]>);

impl InputScales {
    fn new(of: &SolvedStep, inputs: &[PointInput], outputs: &[PointOutput], span: f64) -> InputScales {
        let warm = inputs.iter().fold(0.0, |warm: f64, input| warm.max(input.temperature.abs()));
        let raw = |(i, (input, output)): (usize, (&PointInput, &PointOutput))| {
            let rho = of.chosen.rho().get(i).copied().filter(|rho| *rho > 0.0).unwrap_or(0.0);
            let per_rho = if rho > 0.0 { rho.recip() } else { 0.0 };
            let depth = output.penetration.abs().max(span * per_rho * input.force[0].abs());
            let q = input.force[1].hypot(input.force[2]);
            let slip = output.slip[0].hypot(output.slip[1]);
            let (speed, traction) = (slip.max(per_rho * q), q.max(rho * slip).max(bound(output.bound)));
            let pressure = input.force[0].abs().max(rho / span * output.penetration.abs());
            [depth / span, speed, speed, pressure, traction, traction, depth, warm]
        };
        let raw: Vec<[f64; INPUTS]> = inputs.iter().zip(outputs).enumerate().map(raw).collect();
        let most: [f64; INPUTS] = std::array::from_fn(|j| raw.iter().fold(0.0, |most: f64, raw| most.max(raw[j])));
        let or = |own: f64, most: f64| match () {
            // Round-off of a point that touches.
            () if own > 1e-9 * most => own,
            () if most > 0.0 => most,
            () => 1.0,
        };
        InputScales(raw.iter().map(|raw| std::array::from_fn(|j| or(raw[j], most[j]))).collect())
    }

    /// The sizes of the terms of the outputs of a point.
    fn sizes(&self, i: usize, output: &PointOutput) -> [f64; OUTPUTS] {
        let [_, speed, _, p, q, _, depth, _] = self.0.get(i).copied().unwrap_or([1.0; INPUTS]);
        [p.max(q), p.max(q), p.max(q), depth, speed, speed, output.worn, depth]
    }

    fn of(&self, i: usize, j: usize) -> f64 {
        self.0.get(i).map_or(1.0, |scales| scales[j])
    }
}

/// How far a contact point is from a change of its state in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PointMargin {
    pub value: f64,
    /// What the branch would be beyond the change; `None` if a fluid would reach other points there.
    pub beyond: Option<[bool; 2]>,
    pub n: usize,
    pub point: usize,
}

/// The margins of all points of a step: |r|/(k max|w|) of open points, p/max p and (s − ‖q‖)/max p of closed ones, and
/// ‖w_τ − v_F‖/max|w| of those that slip, max|w| the largest component. Without pressure max s is taken for max p. A
/// point that a fluid passes up to a pressure is as far from a change as its pressure is from that one.
pub(super) fn margins(contacts: &[Contact], of: &SolvedStep, points: &[LinearPoint], rule: &Rule) -> Vec<PointMargin> {
    let largest = |of_point: &dyn Fn(&PointState) -> f64| of.states.iter().map(of_point).fold(0.0, f64::max);
    let pressure = largest(&|state| state.pressure.abs());
    let bound = largest(&|state| bound(state.bound));
    let scales = MarginScales {
        speed: max_abs(&of.at.w),
        pressure,
        // A pressure that is round-off of the bound is none.
        traction: if pressure > TOUCHES * bound { pressure } else { bound },
        rule,
    };
    let mut all = Vec::new();
    for (i, (state, point)) in of.states.iter().zip(points).enumerate() {
        let Some(rho) = of.chosen.rho().get(i).copied().filter(|rho| *rho > 0.0) else { continue };
        let found = scales.of(state, point, rho).into_iter().flatten();
        let made = |value, beyond| PointMargin { value, beyond, n: of.n, point: i };
        match contacts.get(point.contact).and_then(|contact| contact.fluid.as_ref()) {
            None => all.extend(found.map(|(value, beyond)| made(value, Some(beyond)))),
            Some(fluid) => {
                all.extend(found.map(|(value, _)| made(value, None)));
                if fluid.sealed_above > 0.0 && state.pressure > 0.0 {
                    all.push(made((state.pressure - fluid.sealed_above).abs() / pressure, None));
                }
            }
        }
    }
    all
}

/// The sizes to which the distances of the points of a step from a change of state are relative.
struct MarginScales<'a> {
    /// max|w| in m/s, max p and the largest traction in Pa.
    speed: f64,
    pressure: f64,
    traction: f64,
    rule: &'a Rule,
}

impl MarginScales<'_> {
    /// The margins of a point, with the branches beyond.
    fn of(&self, state: &PointState, point: &LinearPoint, rho: f64) -> [Option<(f64, [bool; 2])>; 2] {
        let ([presses, sticks], rule) = (point.branch, self.rule);
        let over = |value: f64, scale: f64, beyond| (scale > 0.0).then(|| (value / scale, beyond));
        let mut first = None;
        if point.may_open {
            let opened = [!presses, sticks];
            if !presses {
                return [over(state.penetration.abs(), rule.k * self.speed, opened), None];
            }
            // A point that hardly touches bears a pressure of the stiffness of the body times a length.
            let depth = state.penetration.abs().max(rule.span / rho * state.pressure.abs());
            let touches = over(depth, rule.k * self.speed, opened).filter(|(margin, _)| *margin <= TOUCHES);
            if touches.is_some() {
                return [touches, None];
            }
            first = over(state.pressure.abs(), self.pressure, opened);
        }
        let turned = [presses, !sticks];
        let second = match state.status {
            _ if state.bound <= 0.0 => None,
            Status::Slip => {
                // A point that hardly slips slips as far as a rounding of q moves it, which may be the largest speed.
                let slip = length(&state.slip);
                let starts = over(rho * slip, state.bound, turned).filter(|(margin, _)| *margin <= TOUCHES);
                starts.or_else(|| over(slip, self.speed, turned))
            }
            _ => over((state.bound - length(&state.q)).max(0.0), self.traction, turned),
        };
        [first, second]
    }
}
