//! The numbers at the end of a run whose derivatives are asked for.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::along::{ChangedPart, Scratch, StateChange, spread, strain_scale};
use super::error::GradientError;
use super::instance::{ProblemInstance, global};
use super::points::LinearPoint;
use super::stencil::derivative;
use super::sweep::OfPoints;
use super::vector::StateVector;
use crate::inclusion::PointState;
use crate::output::{OF_WHOLE, Probe, ProbeError, ProbeSet, Snapshot, Work};
use crate::problem::{Fault, Problem};
use crate::state::{State, StepReport};

/// A number at the end of a run.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct GradientOutput {
    pub name: String,
    kind: OutputKind,
}

#[derive(Clone, Debug, PartialEq)]
enum OutputKind {
    /// A column of a probe.
    Probe(Box<Probe>, usize),
    /// A component of the resultant of σν on Γ_C.
    Force(usize),
    /// Work of friction since the start.
    FrictionWork,
    /// Volume worn off.
    WearVolume,
}

/// Names of outputs other than probes, without the component.
const FORCE: &str = "final.contact.force.";
const FRICTION_WORK: &str = "energy.friction_dissipation";
const WEAR_VOLUME: &str = "final.contact.wear_volume";

impl GradientOutput {
    /// The output of a name: a column of `probes.csv`, or a figure of `summary.json`.
    pub fn named(name: &str, problem: &Problem, probes: &[Probe]) -> Result<GradientOutput, GradientError> {
        let dim = problem.mesh.dim;
        let column = name.strip_prefix("probes.").unwrap_or(name);
        let columns = |probe: &Probe| -> Vec<String> {
            let endings = probe.quantity.columns(dim);
            endings.into_iter().map(|ending| format!("{}{ending}", probe.name)).collect()
        };
        let found = probes.iter().find_map(|probe| {
            let column = columns(probe).iter().position(|known| known == column)?;
            Some(OutputKind::Probe(Box::new(probe.clone()), column))
        });
        let of_force = || name.strip_prefix(FORCE)?.parse::<usize>().ok().filter(|c| *c < dim).map(OutputKind::Force);
        let has_contact = !problem.contacts.is_empty();
        let kind = found.or_else(|| match name {
            FRICTION_WORK => Some(OutputKind::FrictionWork),
            WEAR_VOLUME if has_contact => Some(OutputKind::WearVolume),
            _ if has_contact => of_force(),
            _ => None,
        });
        let path = format!("output {name}");
        match kind {
            Some(OutputKind::Probe(probe, _)) if OF_WHOLE.contains(&probe.quantity.base) => {
                let found = format!("{}, a quantity of a side as a whole", probe.quantity.name());
                let fault = Fault::new(path, found, "a probe of the body or of contact points");
                Err(GradientError::refused(fault.hint(format!("the force on contacts is {FORCE}0"))))
            }
            Some(OutputKind::Probe(probe, _))
                if probe.quantity.base.is_of_strains() && problem.varying_branches() > 0 =>
            {
                let found = format!("{} of a body with relaxation times that vary in space", probe.quantity.name());
                let expected = "a displacement, a temperature or a quantity of contact";
                Err(GradientError::refused(Fault::new(path, found, expected)))
            }
            Some(kind) => Ok(GradientOutput { name: name.to_owned(), kind }),
            None => {
                let mut known: Vec<String> = probes.iter().flat_map(columns).collect();
                known.push(FRICTION_WORK.to_owned());
                if has_contact {
                    known.push(WEAR_VOLUME.to_owned());
                    known.extend((0..dim).map(|c| format!("{FORCE}{c}")));
                }
                let fault = Fault::new(path, "no number with derivatives", format!("one of {}", known.join(", ")));
                Err(GradientError::refused(fault.hint("add a [[probe]] to the case")))
            }
        }
    }
}

impl GradientOutput {
    /// True if it is one of stresses or strains, which rigid motions do not change.
    fn is_of_strains(&self) -> bool {
        let OutputKind::Probe(probe, _) = &self.kind else { return false };
        probe.quantity.base.is_of_strains()
    }
}

/// An output of a problem, ready to be evaluated.
pub(super) struct OutputReader<'a> {
    instance: &'a ProblemInstance,
    output: &'a GradientOutput,
    set: Option<Arc<ProbeSet>>,
}

impl GradientOutput {
    /// The probe of the output, prepared for a problem; `None` if the output is none of a probe.
    pub fn prepared(&self, instance: &ProblemInstance) -> Result<Option<Arc<ProbeSet>>, GradientError> {
        let OutputKind::Probe(probe, _) = &self.kind else { return Ok(None) };
        let made = ProbeSet::new(&instance.problem, std::slice::from_ref(&**probe));
        let told = |(_, error): (usize, ProbeError)| {
            let path = format!("output {}", self.name);
            GradientError::refused(Fault::new(path, error.to_string(), "a probe that can be read"))
        };
        made.map(|set| Some(Arc::new(set))).map_err(told)
    }
}

impl<'a> OutputReader<'a> {
    pub fn new(instance: &'a ProblemInstance, output: &'a GradientOutput) -> Result<OutputReader<'a>, GradientError> {
        Ok(OutputReader::with(instance, output, output.prepared(instance)?))
    }

    /// The reader with the prepared probe of the output.
    pub fn with(
        instance: &'a ProblemInstance,
        output: &'a GradientOutput,
        set: Option<Arc<ProbeSet>>,
    ) -> OutputReader<'a> {
        OutputReader { instance, output, set }
    }

    /// The value at a state with the report of its step.
    pub fn value(&self, state: &State, report: &StepReport) -> f64 {
        self.value_at(state, Some(report))
    }

    /// The value at a state with the report of its step, if a step led to it. Without one outputs of the contact points
    /// that a step determines are NaN.
    pub fn value_at(&self, state: &State, report: Option<&StepReport>) -> f64 {
        let ProblemInstance { problem, discrete, .. } = self.instance;
        let points = &discrete.boundary.points;
        match &self.output.kind {
            OutputKind::Probe(_, column) => {
                let now =
                    Snapshot { problem, discretization: discrete, state, report, work: Work::default(), scheme: None };
                let values = self.set.as_ref().map_or_else(Vec::new, |set| set.values(&now));
                values.get(*column).copied().unwrap_or(f64::NAN)
            }
            OutputKind::Force(c) => {
                let force = |(point, state): (&crate::contact::PointOnBoundary, &PointState)| {
                    let sign = problem.contacts.get(point.contact).map_or(1.0, crate::contact::Contact::sign);
                    0.0 - sign * point.weight * (state.pressure * state.normal[*c] + state.q[*c])
                };
                report.map_or(f64::NAN, |report| points.iter().zip(&report.contact.states).map(force).sum())
            }
            OutputKind::FrictionWork => self.over(&state.surface.friction_work),
            OutputKind::WearVolume => self.over(&state.surface.wear),
        }
    }

    /// The derivative along a change of the state and of its contact points; `None` where the output has a kink. The
    /// scratch holds the same state, and does so again afterwards.
    pub fn along(
        &self,
        scratch: &mut Scratch,
        (state, report): (&State, Option<&StepReport>),
        points: &[LinearPoint],
        (change, of_points): (&StateVector, &OfPoints),
    ) -> Option<f64> {
        match &self.output.kind {
            OutputKind::FrictionWork => return Some(self.over(&change.work)),
            OutputKind::WearVolume => return Some(self.over(&change.wear)),
            _ => {}
        }
        let value = self.value_at(state, report);
        if value.is_nan() {
            return Some(f64::NAN);
        }
        let mesh = &self.instance.problem.mesh;
        let nodes = self.set.as_ref().and_then(|set| set.nodes(mesh));
        let nodes: Option<Vec<u32>> = nodes.map(|nodes| nodes.into_iter().collect());
        let parts: &[ChangedPart] = if nodes.is_some() { &ChangedPart::OF_BODY } else { &ChangedPart::OF_CONTACT };
        let (is_of_strains, dim) = (self.output.is_of_strains(), mesh.dim);
        let along =
            StateChange { base: (state, report), change: (change, of_points), points, nodes, is_of_strains, dim };
        let mut sum = 0.0;
        let is_read = |part: &&ChangedPart| is_of_strains || **part != ChangedPart::Branches;
        for part in parts.iter().filter(is_read) {
            let Some(scale) = along.scale(*part) else { continue };
            let with = std::cell::RefCell::new(&mut *scratch);
            let at = |h: f64| {
                let mut scratch = with.borrow_mut();
                along.change(*part, &mut scratch, h);
                ([self.value_at(&scratch.state, scratch.report.as_ref())], ())
            };
            let found = derivative(at, scale, [value.abs()], ());
            along.change(*part, scratch, 0.0);
            let [slope] = found?;
            sum += slope;
        }
        Some(sum)
    }

    /// ∫ over Γ_C of values at the contact points.
    fn over(&self, of: &[f64]) -> f64 {
        let points = &self.instance.discrete.boundary.points;
        points.iter().zip(of).map(|(point, value)| point.weight * value).sum()
    }

    /// The derivatives by the last state and by the states of its contact points.
    pub fn slopes(&self, state: &State, report: &StepReport, points: &[LinearPoint]) -> (StateVector, OfPoints) {
        let mut last = (state.clone(), report.clone());
        let mut found = (StateVector::zero(state), vec![[0.0; 6]; points.len()]);
        let nodes = self.set.as_ref().and_then(|set| set.nodes(&self.instance.problem.mesh));
        match nodes {
            Some(nodes) => self.slopes_of_nodes(&mut last, &nodes, &mut found.0),
            None => self.slopes_of_contact(&mut last, points, &mut found),
        }
        found
    }

    /// The derivatives by the values at nodes that are read.
    fn slopes_of_nodes(&self, last: &mut (State, StepReport), nodes: &BTreeSet<u32>, found: &mut StateVector) {
        let dim = self.instance.problem.mesh.dim;
        let of = |values: &[f64]| {
            if !self.output.is_of_strains() {
                return size(values);
            }
            strain_scale(largest(values), spread(values, dim, |i| nodes.contains(&((i / dim) as u32))))
        };
        let (u, w, theta) = (of(&last.0.u), of(&last.0.w), size(&last.0.theta));
        // Of quantities of the body only those of strains have a part of the branches.
        let branches = if self.output.is_of_strains() { last.0.branches.len() } else { 0 };
        for node in nodes.iter().map(|node| *node as usize) {
            for i in node * dim..(node + 1) * dim {
                found.u[i] = self.slope(last, u, |(state, _), h| state.u[i] += h);
                found.w[i] = self.slope(last, w, |(state, _), h| state.w[i] += h);
            }
            for b in 0..branches {
                for i in node * dim..(node + 1) * dim {
                    found.branches[b][i] = self.slope(last, u, |(state, _), h| state.branches[b][i] += h);
                }
            }
            found.theta[node] = self.slope(last, theta, |(state, _), h| state.theta[node] += h);
        }
    }

    /// The derivatives by what contact keeps, and by the states of its points.
    fn slopes_of_contact(
        &self,
        last: &mut (State, StepReport),
        points: &[LinearPoint],
        (found, of_points): &mut (StateVector, OfPoints),
    ) {
        let surface = &last.0.surface;
        let [wear, work] = [size(&surface.wear), size(&surface.friction_work)];
        let deep = size(&surface.worn.depths.concat());
        let most = |of: fn(&PointState) -> f64| size(&last.1.contact.states.iter().map(of).collect::<Vec<f64>>());
        let traction = most(|state| state.pressure.abs().max(crate::tensor::length(&state.q)));
        let (depth, slip) = (most(|state| state.penetration), most(|state| crate::tensor::length(&state.slip)));
        let scales = [traction, traction, traction, depth, slip, slip];
        for s in 0..found.depths.len() {
            for a in 0..found.depths[s].len() {
                found.depths[s][a] = self.slope(last, deep, |(state, _), h| state.surface.worn.depths[s][a] += h);
            }
        }
        for (contact, slope) in found.advance.iter_mut().enumerate() {
            *slope = self.turned(last, points, contact);
        }
        for (i, point) in points.iter().enumerate() {
            found.wear[i] = self.slope(last, wear, |(state, _), h| state.surface.wear[i] += h);
            found.work[i] = self.slope(last, work, |(state, _), h| state.surface.friction_work[i] += h);
            for (k, scale) in scales.into_iter().enumerate() {
                of_points[i][k] = self.slope(last, scale, |(_, report), h| {
                    report.contact.states.get_mut(i).into_iter().for_each(|state| change(state, &point.basis, k, h));
                });
            }
        }
    }

    /// The derivative by δ of a contact, whose points turn, at fixed (p, q) and slip in their bases.
    fn turned(&self, last: &mut (State, StepReport), points: &[LinearPoint], contact: usize) -> f64 {
        let own = || points.iter().enumerate().filter(|(_, point)| point.contact == contact);
        let turning = own().fold(0.0, |most: f64, (_, point)| most.max(point.advance.turning()));
        if turning == 0.0 {
            return 0.0;
        }
        self.slope(last, turning.recip(), |(_, report), h| {
            for (i, point) in own() {
                let state = report.contact.states.get_mut(i).into_iter();
                state.for_each(|state| point.advance.turn(state, (&point.force, point.slip), h));
            }
        })
    }

    fn slope(&self, last: &mut (State, StepReport), scale: f64, change: impl Fn(&mut (State, StepReport), f64)) -> f64 {
        let last = std::cell::RefCell::new(last);
        let at = |h: f64| {
            let mut last = last.borrow_mut();
            change(&mut last, h);
            let value = self.value(&last.0, &last.1);
            change(&mut last, 0.0 - h);
            ([value], ())
        };
        derivative(at, scale, [0.0], ()).map_or(f64::NAN, |[slope]| slope)
    }
}

/// The largest magnitude of numbers.
fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most: f64, value| most.max(value.abs()))
}

/// The same as a scale: 1 if all are zero.
fn size(values: &[f64]) -> f64 {
    let largest = largest(values);
    if largest > 0.0 { largest } else { 1.0 }
}

/// Changes pressure, a component of q, the penetration, or a component of the slip.
fn change(state: &mut PointState, basis: &[[f64; 3]; 3], k: usize, h: f64) {
    let along = |a: usize| global(basis, &std::array::from_fn(|b| if a == b { h } else { 0.0 }));
    match k {
        0 => state.pressure += h,
        3 => state.penetration += h,
        1 | 2 => state.q.iter_mut().zip(along(k)).for_each(|(q, h)| *q += h),
        _ => state.slip.iter_mut().zip(along(k - 3)).for_each(|(s, h)| *s += h),
    }
}
