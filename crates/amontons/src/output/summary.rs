//! `summary.json`: the results of a run in a few numbers.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::shown::FIGURES;
use super::{ErrorSummary, Snapshot, cell_values, limits, strain_norm};
use crate::contact::{Contact, PointOnBoundary, Status, names};
use crate::hypotheses::warnings::Figures;
use crate::hypotheses::{self, Finding, warnings};
use crate::inclusion::{Passed, PointState};
use crate::linalg::max_abs;
use crate::machine;
use crate::problem::{Choice, Problem};
use crate::state::{Accumulated, ContactReport, Contraction, Ledger};
use crate::tensor::Point;
use crate::time::ChosenSteps;
use crate::units::Units;

/// The reason why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Outcome {
    /// All steps were made.
    #[serde(rename = "done")]
    Done,
    /// A step could not be made.
    #[serde(rename = "not converged")]
    NotConverged,
    /// The run was asked to stop.
    #[serde(rename = "interrupted")]
    Interrupted,
    /// All steps were made, but the results cannot be trusted: a figure is not finite, or an identity of the audit
    /// fails grossly.
    #[serde(rename = "unsound")]
    Unsound,
}

/// The results of a run: `summary.json`. Numbers are those of the last good step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Name of the case.
    pub case: String,
    /// The reason why the run ended.
    pub outcome: Outcome,
    /// The error, if any.
    pub error: Option<String>,
    /// Spatial dimension d.
    pub dimension: usize,
    /// The units of the numbers below.
    #[serde(default)]
    pub units: Units,
    /// Time of the last good step in s.
    pub time: f64,
    /// Number of good steps.
    pub steps: usize,
    /// Name of the phase of the last good step, or `None` in a run without phases.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub phase: Option<String>,
    /// The steps that were chosen by their errors, or `None` in a run of equal steps.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chosen: Option<ChosenSteps>,
    /// Numbers of unknowns.
    pub unknowns: UnknownCounts,
    /// The last good step.
    #[serde(rename = "final")]
    pub last: Final,
    /// The choices of the program that the run was computed with.
    #[serde(default)]
    pub choices: Vec<Choice>,
    /// Work of the solver.
    pub solver: SolverCounts,
    /// Bound of the discretization error of the last step, if it was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub discretization_error: Option<ErrorSummary>,
    /// The last row of the audit, with `closing_error` and `heat_closing_error` divided by the turnover.
    pub energy: Ledger,
    /// Hypotheses and conditions with their numbers.
    pub findings: Vec<Finding>,
    /// The findings to act on.
    #[serde(default)]
    pub warnings: Vec<Finding>,
    /// Times spent.
    pub seconds: Seconds,
    /// Peak memory of the program, bytes, or `None` if the system does not report it.
    pub peak_memory_bytes: Option<u64>,
}

/// Numbers of unknowns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct UnknownCounts {
    /// Unknowns of the mechanical step.
    pub displacement: usize,
    /// Unknowns of the heat step.
    pub temperature: usize,
    /// Unknowns of the mechanical step on Γ_C.
    pub contact: usize,
}

/// Values at the last good step. A problem without heat has no temperature, one without mechanics no displacement and
/// no stress: `null` and empty arrays in `summary.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Final {
    /// Least nodal displacement, m, by component.
    pub displacement_min: Vec<f64>,
    /// Largest nodal displacement, m, by component.
    pub displacement_max: Vec<f64>,
    /// Largest nodal velocity, m/s, by component, with its sign.
    pub velocity_max: Vec<f64>,
    /// Least nodal temperature, K.
    pub temperature_min: Option<f64>,
    /// Largest nodal temperature, K.
    pub temperature_max: Option<f64>,
    /// Largest von Mises stress at a cell centre, Pa.
    pub von_mises_max: Option<f64>,
    /// Largest principal strain in magnitude, or `None` without mechanics.
    #[serde(default)]
    pub strain_max: Option<f64>,
    /// Largest amount by which a temperature was below the least value that the data allow, since the start, K, or
    /// `None` if they allow any.
    #[serde(default)]
    pub undershoot: Option<f64>,
    /// Largest amount by which a temperature was above the largest value that the data allow, since the start, K, or
    /// `None` if they allow any.
    #[serde(default)]
    pub overshoot: Option<f64>,
    /// Largest penetration divided by the height of the lowest cell of its side, or `None` without contact.
    #[serde(default)]
    pub penetration_per_cell: Option<f64>,
    /// Norms of the fields.
    pub norms: Norms,
    /// Contact, or `None` before the first step and without mechanics.
    pub contact: Option<ContactSummary>,
}

/// Norms of the fields that a problem has.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Norms {
    /// ‖u‖_H, or `None` without mechanics.
    pub displacement_l2: Option<f64>,
    /// ‖u‖_V = ‖ε(u)‖, or `None` without mechanics.
    pub displacement_v: Option<f64>,
    /// ‖w‖_H, or `None` without mechanics.
    pub velocity_l2: Option<f64>,
    /// ‖θ‖, or `None` without heat.
    pub temperature_l2: Option<f64>,
}

/// The state of Γ_C.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactSummary {
    /// Resultant of σν by component: N/m in the plane, N in space and for a whole body of revolution. If a foundation
    /// slides out of the plane there is a third component. Empty between bodies at rest.
    pub force: Vec<f64>,
    /// Moment of σν about the axis of revolution, N m, or `None` if no foundation turns about it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moment: Option<f64>,
    /// Moment of σν about the origin: about the normal in the plane, N m/m, or three components in space, N m; `None`
    /// for other bodies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moment_about_origin: Option<Vec<f64>>,
    /// ∫ q·ν: W/m in the plane, W in space and for a whole body of revolution; `None` without heat.
    pub heat_flow: Option<f64>,
    /// Largest penetration, m; 0 if all points are open.
    pub penetration_max: f64,
    /// Largest pressure, Pa.
    pub pressure_max: f64,
    /// Contact points without pressure.
    pub open: usize,
    /// Contact points that stick.
    pub stick: usize,
    /// Contact points that slip.
    pub slip: usize,
    /// Area in contact: m²/m in the plane, m² in space and for a whole body of revolution.
    #[serde(default)]
    pub area: f64,
    /// Centre of pressure Σ ω p₊ x / Σ ω p₊, m, by component; zero without pressure.
    #[serde(default)]
    pub center: Vec<f64>,
    /// Largest depth of wear, m.
    #[serde(default)]
    pub wear_max: f64,
    /// ∫ h, the volume of wear: m³/m in the plane, m³ in space and for a whole body of revolution.
    #[serde(default)]
    pub wear_volume: f64,
    /// The volume of wear of each side of a pair, by the names of the sides.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub wear_volumes: BTreeMap<String, f64>,
    /// Moment of the contact forces on both bodies of a pair, N m by component, in the plane and in a body of
    /// revolution about its normal or axis alone: the defect of angular momentum. Zero if both sides lie on one plane.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moment_defect: Option<Vec<f64>>,
    /// Heat that has left the side since the start, J, by mechanism: the laws of heat exchange by their names, and
    /// `friction`, which is negative if friction heats the side. For a single contact.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub heat_passed: BTreeMap<String, f64>,
    /// Tension of the section of a bolt, N, in the plane N/m; for a single contact with a preload.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tension: Option<f64>,
    /// Distance by which its sides are drawn together, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drawn: Option<f64>,
    /// Displacement of an obstacle along its load, m; for a single contact with such an obstacle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub obstacle_displacement: Option<f64>,
    /// Area wetted by a fluid, with the unit of `area`, m²; for a single contact with a fluid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wet_area: Option<f64>,
    /// Time at which the fluid first leaked through the contact, s, or `None` if it has not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub leaks_since: Option<f64>,
    /// θ_F of a foundation with heat capacity, K; for a single contact.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub foundation_temperature: Option<f64>,
    /// Each of several contacts by its name, or by that of its side if it has none.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub sides: BTreeMap<String, ContactSummary>,
}

impl ContactSummary {
    /// Sums up the contact points after a step, of all contacts or of one.
    #[must_use]
    pub fn new(now: &Snapshot, contact: &ContactReport, side: Option<usize>) -> ContactSummary {
        let Snapshot { problem, discretization, state, .. } = *now;
        let (dim, several) = (problem.mesh.dim, problem.contacts.len() > 1);
        let all = &discretization.boundary.points;
        let points = || all.iter().enumerate().filter(|(_, point)| side.is_none_or(|side| point.contact == side));
        let weight = |i: usize, point: &PointOnBoundary| contact.weights.get(i).copied().unwrap_or(point.weight);
        let sign = |point: &PointOnBoundary| problem.contacts.get(point.contact).map_or(1.0, Contact::sign);
        let states = || {
            let of_points = points().filter_map(|(i, point)| Some((i, point, contact.states.get(i)?)));
            of_points
                .map(|(i, point, state)| (Weighted { weight: weight(i, point), x: point.x, sign: sign(point) }, state))
                .filter(|(point, _)| point.weight > 0.0)
        };
        let count = |status| states().filter(|(_, s)| s.status == status).count();
        let of_all = |v: [f64; 3]| v[..dim].to_vec();
        let pressing: f64 = states().map(|(point, s)| point.weight * s.pressure.max(0.0)).sum();
        let moment = |c: usize| states().map(|(point, s)| point.weight * s.pressure.max(0.0) * point.x[c]).sum::<f64>();
        let only = side.or((!several).then_some(0));
        let of_pair = only.and_then(|side| problem.contacts.get(side)).filter(|contact| contact.pair.is_some());
        let (force, heat_flow) = if side.is_some() || of_pair.is_some() {
            let flow = points().filter_map(|(i, point)| {
                let (flux, rubbed) = (contact.flux.get(i)?.value, contact.rubbed.get(i)?);
                Some(weight(i, point) * if sign(point) > 0.0 { flux } else { 0.0 - flux - rubbed })
            });
            (resultant(states()), sum(&mut flow.into_iter()))
        } else {
            (contact.force, contact.heat_flow)
        };
        let one = only.and_then(|side| Some((side, problem.contacts.get(side)?)));
        let [wear_volume, wear_max] = worn_off(now, contact, side);
        let [tension, drawn] = tightened(now, one, &mut states());
        let volumes = one.and_then(|(side, of)| Some(of_sides(of, *state.surface.worn.volumes.get(side)?)));
        let about_axis = states().map(|(point, s)| point.sign * point.weight * point.x[0] * s.q[2]);
        let moves = problem.physics.has_mechanics();
        let sides = if several && side.is_none() { names(&problem.contacts) } else { Vec::new() };
        let of_contact = |(side, name)| (name, ContactSummary::new(now, contact, Some(side)));
        ContactSummary {
            force: if moves { force[..problem.components_of_force()].to_vec() } else { Vec::new() },
            moment: problem.turns().then(|| 0.0 - about_axis.sum::<f64>()),
            moment_about_origin: about_origin(problem, states()).filter(|_| moves),
            heat_flow: problem.physics.has_heat().then_some(heat_flow),
            penetration_max: states().fold(0.0, |max, (_, s)| s.penetration.max(max)),
            pressure_max: states().fold(0.0, |max, (_, s)| s.pressure.max(max)),
            open: count(Status::Open),
            stick: count(Status::Stick),
            slip: count(Status::Slip),
            area: sum(&mut states().filter(|(_, s)| s.status != Status::Open).map(|(point, _)| point.weight)),
            center: of_all([0, 1, 2].map(|c| if pressing > 0.0 { moment(c) / pressing } else { 0.0 })),
            wear_max,
            wear_volume,
            wear_volumes: volumes.unwrap_or_default(),
            moment_defect: one.and_then(|(side, of)| moment_defect(problem, of, contact.moments.get(side)?)),
            heat_passed: passed(one.and_then(|(side, _)| state.surface.passed.get(side))),
            tension,
            drawn,
            obstacle_displacement: one.and_then(|(side, of)| moved(now, (side, of))),
            wet_area: one.and_then(|(side, of)| wet(now, contact, (side, of))),
            leaks_since: one.and_then(|(side, _)| Some((*state.surface.wet.leaks.get(side)?)?.t)),
            foundation_temperature: only.and_then(|side| state.surface.foundation.get(side).copied().flatten()),
            sides: sides.into_iter().enumerate().map(of_contact).collect(),
        }
    }
}

/// The area wetted by a fluid.
fn wet(now: &Snapshot, contact: &ContactReport, (side, of): (usize, &Contact)) -> Option<f64> {
    of.fluid.as_ref()?;
    let wet = now.state.surface.wet.points.iter().enumerate().filter(|(_, wet)| **wet);
    let points = wet.filter_map(|(i, _)| Some((i, now.discretization.boundary.points.get(i)?)));
    let own = points.filter(|(_, point)| point.contact == side);
    Some(sum(&mut own.map(|(i, point)| contact.weights.get(i).copied().unwrap_or(point.weight))))
}

/// The tension of a section with a preload, and the distance by which its sides are drawn together.
fn tightened(
    now: &Snapshot,
    of: Option<(usize, &Contact)>,
    states: &mut dyn Iterator<Item = (Weighted, &PointState)>,
) -> [Option<f64>; 2] {
    let Some((side, _)) = of.filter(|(_, contact)| contact.preload.is_some()) else { return [None; 2] };
    let pressing: f64 = states.map(|(point, s)| point.weight * s.pressure).sum();
    [Some(0.0 - pressing), now.state.surface.advance.get(side).copied()]
}

/// The displacement of the obstacle of a contact along its load.
fn moved(now: &Snapshot, (side, of): (usize, &Contact)) -> Option<f64> {
    of.obstacle.as_ref()?.load.as_ref()?;
    now.state.surface.advance.get(side).copied()
}

/// Heat that has passed a contact, by mechanism.
fn passed(of: Option<&Passed>) -> BTreeMap<String, f64> {
    of.map(Passed::by_name).unwrap_or_default()
}

/// The volume of wear and the largest depth, of all contacts or of one. Wear of pairs is stored on the bodies, because
/// their contact points move.
fn worn_off(now: &Snapshot, contact: &ContactReport, side: Option<usize>) -> [f64; 2] {
    let Snapshot { problem, discretization, state, .. } = *now;
    let Accumulated { wear, worn, .. } = &state.surface;
    let is_meant = |contact: usize| side.is_none_or(|side| contact == side);
    let is_pair = |contact: usize| problem.contacts.get(contact).is_some_and(|contact| contact.pair.is_some());
    let points = || discretization.boundary.points.iter().zip(wear).enumerate();
    let meant = || points().filter(|(_, (point, _))| is_meant(point.contact));
    let still = meant().filter(|(_, (point, _))| !is_pair(point.contact));
    let still = still.map(|(i, (point, depth))| contact.weights.get(i).copied().unwrap_or(point.weight) * depth);
    let of_pairs = worn.volumes.iter().enumerate().filter(|(contact, _)| is_meant(*contact) && is_pair(*contact));
    let volume = sum(&mut still.chain(of_pairs.map(|(_, [on, with])| on + with)));
    let of_bodies = (0..problem.contacts.len()).filter(|contact| is_meant(*contact));
    let deepest = of_bodies.map(|contact| discretization.worn.largest(contact, &worn.depths)).fold(0.0, f64::max);
    [volume, meant().fold(deepest, |most, (_, (_, depth))| depth.max(most))]
}

/// The volume of wear of each side of a pair.
fn of_sides(contact: &Contact, volumes: [f64; 2]) -> BTreeMap<String, f64> {
    let sides = contact.sides().zip(volumes).filter(|_| contact.wear.is_some() && contact.pair.is_some());
    sides.map(|(side, volume)| (side.to_owned(), volume)).collect()
}

/// The components of the moment that a problem has, or `None` on a line and in a body of revolution that nothing turns.
fn moment_defect(problem: &Problem, contact: &Contact, moment: &Point) -> Option<Vec<f64>> {
    let (mesh, [_, about_axis, about_plane]) = (&problem.mesh, *moment);
    let components = match mesh.dim {
        2 if mesh.axisymmetric => problem.turns().then(|| vec![about_axis]),
        2 => Some(vec![about_plane]),
        3 => Some(moment.to_vec()),
        _ => None,
    };
    components.filter(|_| contact.pair.is_some() && problem.physics.has_mechanics())
}

/// The resultant of the tractions at contact points.
fn resultant<'a>(states: impl Iterator<Item = (Weighted, &'a PointState)>) -> Point {
    let sum = states.fold([0.0; 3], |sum: Point, (point, s)| {
        std::array::from_fn(|c| sum[c] + point.sign * point.weight * (s.pressure * s.normal[c] + s.q[c]))
    });
    sum.map(|component| 0.0 - component)
}

/// The moment of the tractions at contact points about the origin, with the components that the body has.
fn about_origin<'a>(problem: &Problem, states: impl Iterator<Item = (Weighted, &'a PointState)>) -> Option<Vec<f64>> {
    const ROUND_OFF: f64 = 1e-9;
    let (mut moment, mut size) = ([0.0; 3], 0.0);
    for (point, s) in states {
        let [x, f] = [point.x, resultant(std::iter::once((point, s)))];
        for (c, sum) in moment.iter_mut().enumerate() {
            let [a, b] = [x[(c + 1) % 3] * f[(c + 2) % 3], x[(c + 2) % 3] * f[(c + 1) % 3]];
            *sum += a - b;
            size += a.abs() + b.abs();
        }
    }
    let moment = moment.map(|m: f64| if m.abs() < ROUND_OFF * size { 0.0 } else { m });
    match (problem.mesh.dim, problem.mesh.axisymmetric) {
        (2, false) => Some(vec![moment[2]]),
        (3, _) => Some(moment.to_vec()),
        _ => None,
    }
}

/// A contact point in a step.
#[derive(Clone, Copy)]
struct Weighted {
    weight: f64,
    x: Point,
    /// Factor that turns a force into the force on the side `on`.
    sign: f64,
}

/// Work of the solver, counted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolverCounts {
    /// Newton iterations of mechanical steps.
    pub newton_mechanics_total: usize,
    /// Most Newton iterations of one mechanical step.
    pub newton_mechanics_max: usize,
    /// Newton iterations of heat steps.
    pub newton_heat_total: usize,
    /// Factorizations of the systems, without those that a resumed run repeats at its start.
    pub factorizations: usize,
    /// Factorizations of condensed systems on Γ_C; a resumed run repeats the ones it had kept.
    pub contact_factorizations: usize,
    /// Sweeps over a factor, forward or backward.
    pub sweeps: usize,
    /// Solver of the linear systems: `direct` or `iterative`.
    #[serde(default)]
    pub backend: String,
    /// Reason for the choice: the predicted costs of both.
    #[serde(default)]
    pub backend_reason: String,
    /// Krylov iterations; 0 with a direct solver.
    #[serde(default)]
    pub krylov_iterations: usize,
    /// Largest residual of a step, relative to its largest term; a residual that is round-off is relative to the sizes
    /// of the summands of its terms.
    pub residual_max: f64,
    /// Iterations over both half-steps: one per step with staggered coupling.
    pub passes_total: usize,
    /// Largest contraction factors of the fixed-point coupling over the steps; 0 without any.
    pub contraction_max: Contraction,
    /// Steps made in halves, because a step did not converge or could have several solutions.
    #[serde(default)]
    pub halved_steps: usize,
    /// Steps that may have several solutions, however short their parts.
    #[serde(default)]
    pub ambiguous_steps: usize,
    /// Steps with a contact point that bears a traction at the end.
    #[serde(default)]
    pub contact_steps: usize,
    /// Steps at whose end the velocity is nearly that of their start with the other sign.
    #[serde(default)]
    pub reversed_steps: usize,
}

/// Wall-clock times in s over all sessions of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Seconds {
    /// Assembling and ordering.
    pub setup: f64,
    /// Factorizing.
    pub factor: f64,
    /// Time stepping.
    pub steps: f64,
    /// Evaluation of the hypotheses.
    #[serde(default)]
    pub certificate: f64,
    /// Output by sinks.
    pub output: f64,
    /// The whole run.
    pub total: f64,
}

impl Final {
    fn new(last: &Snapshot, figures: &Figures) -> Final {
        let Snapshot { problem, discretization, state, report, .. } = *last;
        let (dim, physics) = (problem.mesh.dim, problem.physics);
        let of_motion = |values: Vec<f64>| if physics.has_mechanics() { values } else { Vec::new() };
        let von_mises =
            || max_abs(&cell_values(problem, state).iter().map(|cell| cell.stress.von_mises()).collect::<Vec<_>>());
        Final {
            displacement_min: of_motion(by_component(&state.u, dim, f64::INFINITY, f64::min)),
            displacement_max: of_motion(by_component(&state.u, dim, f64::NEG_INFINITY, f64::max)),
            velocity_max: of_motion(by_component(&state.w, dim, f64::NEG_INFINITY, f64::max)),
            temperature_min: state.theta.iter().copied().reduce(f64::min).filter(|_| physics.has_temperature()),
            temperature_max: state.theta.iter().copied().reduce(f64::max).filter(|_| physics.has_temperature()),
            von_mises_max: physics.has_mechanics().then(von_mises),
            strain_max: physics.has_mechanics().then_some(figures.strain),
            undershoot: figures.outside[0].filter(|_| physics.has_heat()),
            overshoot: figures.outside[1].filter(|_| physics.has_heat()),
            penetration_per_cell: figures.penetration.map(|p| p.depth / p.cell).filter(|_| physics.has_mechanics()),
            norms: Norms {
                displacement_l2: physics.has_mechanics().then(|| discretization.norm(&discretization.mass, &state.u)),
                displacement_v: physics.has_mechanics().then(|| strain_norm(&problem.mesh, state.deformation())),
                velocity_l2: physics.has_mechanics().then(|| discretization.norm(&discretization.mass, &state.w)),
                temperature_l2: physics
                    .has_temperature()
                    .then(|| discretization.norm(&discretization.mass, &state.theta)),
            },
            contact: report
                .filter(|_| physics.has_mechanics() || !problem.contacts.is_empty())
                .map(|report| ContactSummary::new(last, &report.contact, None)),
        }
    }
}

/// The values of `final` in `summary.json` after a step.
#[cfg(feature = "case")]
pub(crate) fn of_last(last: &Snapshot) -> Final {
    Final::new(last, &limits::figures(last))
}

impl Summary {
    /// Sums up a run that ended after `last`. `findings` are those on the data; the findings of the audit are added.
    #[must_use]
    pub fn new(
        last: &Snapshot,
        unknowns: UnknownCounts,
        findings: Vec<Finding>,
        outcome: Outcome,
        error: Option<String>,
    ) -> Summary {
        let Snapshot { problem, state, work, .. } = *last;
        let counts = &state.counts;
        let (ledger_energy, ledger_heat) =
            (state.ledger.relative_closing_error(), state.ledger.relative_heat_closing_error());
        let figures = limits::figures(last);
        let audit = hypotheses::audit(problem.physics, ledger_energy, ledger_heat);
        let findings: Vec<Finding> =
            findings.into_iter().chain(audit).chain(warnings::of_run(problem, &figures)).collect();
        let energy = Ledger {
            closing_error: state.ledger.relative_closing_error(),
            heat_closing_error: state.ledger.relative_heat_closing_error(),
            ..state.ledger.clone()
        };
        Summary {
            discretization_error: None,
            case: problem.name.clone(),
            outcome,
            error,
            dimension: problem.mesh.dim,
            units: problem.units(),
            time: state.t,
            steps: state.step,
            phase: state.phase(&problem.timeline).map(|phase| phase.name.clone()),
            chosen: problem.timeline.is_automatic().then_some(state.pace.chosen),
            unknowns,
            last: Final::new(last, &figures),
            choices: problem.choices(),
            solver: SolverCounts {
                newton_mechanics_total: counts.newton_mechanics_total,
                newton_mechanics_max: counts.newton_mechanics_max,
                newton_heat_total: counts.newton_heat_total,
                factorizations: work.factorizations,
                contact_factorizations: work.contact_factorizations,
                sweeps: counts.sweeps,
                backend: String::new(),
                backend_reason: String::new(),
                krylov_iterations: counts.krylov_iterations,
                residual_max: counts.residual_max,
                passes_total: counts.passes_total,
                contraction_max: counts.contraction_max,
                halved_steps: counts.halved_steps,
                ambiguous_steps: counts.ambiguous_steps,
                contact_steps: counts.contact_steps,
                reversed_steps: counts.reversed_steps,
            },
            energy,
            warnings: findings.iter().filter(|finding| finding.warns()).cloned().collect(),
            findings,
            seconds: work.seconds,
            peak_memory_bytes: machine::peak_memory(),
        }
    }
}

impl Summary {
    /// The reason why the results of a run cannot be trusted, if any: a figure that is not finite, or an identity that
    /// fails grossly.
    #[must_use]
    pub fn unsound(&self) -> Option<String> {
        if let Some((key, value)) = self.figures().into_iter().find(|(_, value)| !value.is_finite()) {
            return Some(format!("{key} is {value}, expected a finite number"));
        }
        let identities = [("energy", self.energy.closing_error), ("heat", self.energy.heat_closing_error)];
        let (name, error) = identities.into_iter().find(|(_, error)| error.abs() > hypotheses::GROSS)?;
        Some(format!(
            "the {name} identity closes to {error:.1e} of what was turned over, expected at most {:.0e}",
            hypotheses::GROSS
        ))
    }

    /// The numbers of the run with their keys in `summary.json`.
    fn figures(&self) -> Vec<(String, f64)> {
        let errors = [
            ("energy.closing_error", self.energy.closing_error),
            ("energy.heat_closing_error", self.energy.heat_closing_error),
        ];
        let of_last = FIGURES.iter().flat_map(|figure| figure.values(&self.last));
        of_last.chain(errors.map(|(key, value)| (key.to_owned(), value))).collect()
    }
}

/// A sum that is 0 without terms; `Iterator::sum` would return −0.
fn sum(values: &mut dyn Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |sum, value| sum + value)
}

/// Folds a node-major vector component by component.
fn by_component(values: &[f64], dim: usize, start: f64, fold: fn(f64, f64) -> f64) -> Vec<f64> {
    (0..dim).map(|c| values.iter().skip(c).step_by(dim).copied().fold(start, fold)).collect()
}
