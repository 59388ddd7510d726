//! Derivatives of outputs at all steps, by the linearised steps forward along with the run.
//!
//! With the state of every contact point frozen and J = ∂R/∂z, the derivative of the state by a parameter m is
//!
//! ```text
//!     dz_n/dm = −J⁻¹ (∂R/∂z_{n−1} dz_{n−1}/dm + ∂R/∂m),
//! ```
//!
//! for all parameters with the same factors of K. No history of the run is kept.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::along::Scratch;
use super::chosen::{made_steps, with_steps};
use super::driven::{DrivenStep, Shifted};
use super::error::GradientError;
use super::factors::StepFactors;
use super::history::{KeptStep, made, started};
use super::instance::{PhasedInstance, ProblemInstance, SolvedStep, StepResidual, at_level};
use super::outputs::{GradientOutput, OutputReader};
use super::parameter::{Parameter, Variants};
use super::points::{LinearPoint, PointMargin, TOUCHES, margins};
use super::stencil;
use super::sweep::{Around, LinearStep, OfPoints};
use super::tangent::ResidualSlope;
use super::vector::StateVector;
use super::{Equilibrium, KINK, NOTHING, ROUNDINGS, SIZES, at_solution, keep_least, scope};
use crate::inclusion::Local;
use crate::output::{Probe, ProbeSet};
use crate::problem::{Fault, Problem};
use crate::state::{State, StepReport};
use crate::step::{March, Scheme, initial_state};

/// What is asked for: derivatives of outputs at all steps.
pub struct SeriesRequest<'a> {
    /// The problem.
    pub problem: &'a Problem,
    /// The probes that outputs may name.
    pub probes: &'a [Probe],
    /// Names of outputs, as in [`GradientRequest`](super::GradientRequest).
    pub outputs: &'a [String],
    /// The data by which they are differentiated.
    pub parameters: &'a [Parameter<'a>],
    /// Ends the computation when it becomes true.
    pub interrupt: Option<&'a AtomicBool>,
}

/// Outputs at all steps, with their derivatives. At step 0 outputs of contact points, which no step has determined, are
/// NaN.
#[derive(Clone, Debug, PartialEq)]
pub struct SeriesTable {
    /// Times of the steps 0 to N, s.
    pub times: Vec<f64>,
    /// Values by step and output.
    pub values: Vec<Vec<f64>>,
    /// Derivatives by step, output and parameter.
    pub derivatives: Vec<Vec<Vec<f64>>>,
    /// The least margin: how far the contact points are from a change of state, over all steps. `None` without contact
    /// points that could change.
    pub margin: Option<f64>,
    /// Number of contact points and steps that are on a change of state.
    pub ties: usize,
}

/// Computes outputs at all steps, and their derivatives by all parameters, along with the run.
///
/// # Errors
/// Those of [`gradient`](super::gradient).
pub fn series(request: &SeriesRequest) -> Result<SeriesTable, GradientError> {
    let go_on = || !request.interrupt.is_some_and(|interrupt| interrupt.load(Ordering::Relaxed));
    let Some(made) = made_steps(request.problem, &go_on)? else { return series_of(request) };
    let problem = &with_steps(request.problem, &made);
    let parameters = request.parameters.iter().map(|parameter| parameter.with_steps(request.problem, &made));
    series_of(&SeriesRequest { problem, parameters: &parameters.collect::<Vec<_>>(), ..*request })
}

/// The derivatives along with a run whose steps are given.
fn series_of(request: &SeriesRequest) -> Result<SeriesTable, GradientError> {
    let base = PhasedInstance::new(request.problem);
    scope::check(&base)?;
    let named = |name: &String| GradientOutput::named(name, request.problem, request.probes);
    let outputs = request.outputs.iter().map(named).collect::<Result<Vec<GradientOutput>, GradientError>>()?;
    let prepared = |output: &GradientOutput| output.prepared(&base.first);
    let sets = outputs.iter().map(prepared).collect::<Result<Vec<PreparedProbe>, GradientError>>()?;
    let mut sweep =
        ForwardSweep { request, base: &base, outputs: &outputs, sets, columns: Vec::new(), kinks: Vec::new() };
    sweep.run()
}

/// The probe of an output, prepared for a problem.
type PreparedProbe = Option<Arc<ProbeSet>>;

/// A state with the report of its step.
type Reported<'a> = (&'a State, Option<&'a StepReport>);

/// The run with the derivatives of its state.
struct ForwardSweep<'a> {
    request: &'a SeriesRequest<'a>,
    base: &'a PhasedInstance,
    outputs: &'a [GradientOutput],
    /// By output.
    sets: Vec<PreparedProbe>,
    columns: Vec<ParameterColumn>,
    /// By step, output and parameter: how much of a kink the derivative has, and the step of the parameter.
    kinks: Vec<Vec<Vec<[f64; 2]>>>,
}

/// The derivative of the state by a parameter.
struct ParameterColumn {
    variants: Variants,
    /// Number of times that the step of the parameter was reduced, and true if that did not make its kink smaller.
    shrunk: i32,
    is_bent: bool,
    /// The probes for the variants, by output.
    sets: Vec<[PreparedProbe; 4]>,
    /// The derivatives of the state, and how much of a kink they have.
    state: StateVector,
    kink: Option<StateVector>,
    /// The same of the state one step before.
    before: Option<StateVector>,
    kink_before: Option<StateVector>,
    /// The same of the contact points at fixed data.
    points: OfPoints,
    bent_points: OfPoints,
}

/// The equations of a step in the variants of a parameter, with their derivative and how much of a kink there is.
struct StepSlopes {
    all: [StepResidual; 4],
    slope: ResidualSlope,
    kink: Option<ResidualSlope>,
}

impl StepSlopes {
    fn is_less_bent(&self, before: &StepSlopes) -> bool {
        match (&self.kink, &before.kink) {
            (Some(kink), Some(before)) => kink.is_half_of(before),
            (kink, _) => kink.is_none(),
        }
    }
}

impl ForwardSweep<'_> {
    fn run(&mut self) -> Result<SeriesTable, GradientError> {
        let (phased, request) = (self.base, self.request);
        let ProblemInstance { problem, discrete, .. } = &phased.first;
        let mut march = March::on(problem, discrete, &problem.backend)?;
        let (start, steps) = (march.initial()?, problem.timeline.steps());
        let mut table =
            SeriesTable { times: vec![start.t], values: Vec::new(), derivatives: Vec::new(), margin: None, ties: 0 };
        let (mut near, mut factors): (Vec<PointMargin>, Option<StepFactors>) = (Vec::new(), None);
        let mut old = KeptStep { state: start, states: Vec::new(), flux: Vec::new() };
        for n in 1..=steps {
            if request.interrupt.is_some_and(|interrupt| interrupt.load(Ordering::Relaxed)) {
                return Err(GradientError::Interrupted);
            }
            let (state, report) = made(&mut march, &old.state)?;
            let new = KeptStep::of(&state, &report);
            let (base, phase) = (phased.of(n), phased.start(n));
            let start = &*started(&old.state, &new.state, phase);
            let at = &*at_level(&base.rule(n, start), start, &new.state);
            let mut factor = StepFactors::kept_or_made(factors.take(), base, (n, start, at))?;
            let (chosen, unknown) = (factor.chosen(base, n, [start, at]), factor.on_contact());
            let solved = SolvedStep {
                n,
                old: start,
                new: &new.state,
                at,
                states: &new.states,
                flux: &new.flux,
                chosen: &chosen,
                unknown: &unknown,
            };
            let (points, forces, here) = at_solution(base, &solved, None)?;
            keep_least(&mut near, margins(&base.problem.contacts, &solved, &points, &factor.rule));
            let driven = &driven(&mut factor, base, (&solved, &points))?;
            let step = LinearStep { base, solved, points: &points, driven };
            if n == 1 {
                self.begin((&solved, &forces))?;
                self.add_row(&mut table, (&old.state, None), &[], None)?;
            }
            if phase.rests {
                self.columns.iter_mut().for_each(ParameterColumn::rest);
            }
            let all = self.advance(&mut factor, &step, (&forces, &here))?;
            table.times.push(state.t);
            self.add_row(&mut table, (&state, Some(&report)), &points, Some((&here, &all)))?;
            (old, factors) = (new, Some(factor));
        }
        self.check(&table)?;
        table.margin = near.iter().map(|near| near.value).min_by(f64::total_cmp);
        table.ties = near.iter().filter(|near| near.value <= TOUCHES).count();
        Ok(table)
    }

    /// Makes the columns with the derivatives of the initial state, at the equations of the first step.
    fn begin(&mut self, first: (&SolvedStep, &[Local])) -> Result<(), GradientError> {
        let base = self.base;
        let initial = |of: &PhasedInstance| initial_state(&of.first.problem, &of.first.discrete, None);
        let start = initial(base)?;
        for parameter in self.request.parameters {
            let variants = parameter.variants(base, first, 0)?;
            let [a, b, c, d] = variants.all.each_ref().map(initial);
            let all = [&a?, &b?, &start, &c?, &d?];
            let [state, kink] = StateVector::central(variants.h, all);
            let sets = self.prepared(&variants)?;
            let kink = Some(kink).filter(|kink| !kink.is_zero());
            let (points, bent_points, before, kink_before) = Default::default();
            self.columns.push(ParameterColumn {
                variants,
                shrunk: 0,
                is_bent: false,
                sets,
                state,
                kink,
                before,
                kink_before,
                points,
                bent_points,
            });
        }
        match Equilibrium::of(base)? {
            Some(equilibrium) => self.begin_at(&equilibrium),
            None => Ok(()),
        }
    }

    /// Gives the columns the derivatives of the equilibrium from which the run starts.
    fn begin_at(&mut self, Equilibrium { instance, start, kept }: &Equilibrium) -> Result<(), GradientError> {
        let base = &instance.first;
        let at = &*at_level(&base.rule(0, start), start, &kept.state);
        let mut factors = StepFactors::kept_or_made(None, base, (0, start, at))?;
        let (chosen, unknown) = (factors.chosen(base, 0, [start, at]), factors.on_contact());
        let (states, flux, new) = (&kept.states, &kept.flux, &kept.state);
        let solved = SolvedStep { n: 0, old: start, new, at, states, flux, chosen: &chosen, unknown: &unknown };
        let (points, forces, here) = at_solution(base, &solved, None)?;
        let driven = &driven(&mut factors, base, (&solved, &points))?;
        let step = LinearStep { base, solved, points: &points, driven };
        let none = StateVector::zero(start);
        for (column, parameter) in self.columns.iter_mut().zip(self.request.parameters) {
            let of_start = parameter.at_equilibrium();
            let variants = of_start.variants(instance, (&step.solved, &forces), 0)?;
            let found = variants.slopes(&step, (&forces, &here)).ok_or_else(|| parameter.kink())?;
            column.state.start_from(step.forward(&mut factors, (&none, None), &found.slope)?.0);
            if let Some(kink) = found.kink {
                let kink = step.forward(&mut factors, (&none, None), &kink)?.0;
                column.kink.get_or_insert_with(|| none.clone()).start_from(kink);
            }
        }
        Ok(())
    }

    fn prepared(&self, variants: &Variants) -> Result<Vec<[PreparedProbe; 4]>, GradientError> {
        let of = |output: &GradientOutput| {
            let [a, b, c, d] = variants.all.each_ref().map(|instance| output.prepared(&instance.first));
            Ok([a?, b?, c?, d?])
        };
        self.outputs.iter().map(of).collect()
    }

    /// Takes the columns to the end of a step. Returns the equations of the step in their variants.
    fn advance(
        &mut self,
        factors: &mut StepFactors,
        step: &LinearStep<Shifted>,
        here: (&[Local], &StepResidual),
    ) -> Result<Vec<[StepResidual; 4]>, GradientError> {
        let mut equations = Vec::with_capacity(self.columns.len());
        for j in 0..self.columns.len() {
            let StepSlopes { all, slope, kink } = self.slopes(j, step, here)?;
            if let Some(column) = self.columns.get_mut(j) {
                column.advance(factors, step, &slope, kink)?;
            }
            equations.push(all);
        }
        Ok(equations)
    }

    /// The derivatives of the equations of a step by a parameter. Its step is reduced where a difference leaves the
    /// branch of a point on both sides, and where a law bends within it.
    fn slopes(
        &mut self,
        j: usize,
        step: &LinearStep<Shifted>,
        here: (&[Local], &StepResidual),
    ) -> Result<StepSlopes, GradientError> {
        let parameter = &self.request.parameters[j];
        let mut found = self.columns[j].variants.slopes(step, here);
        while self.columns[j].shrunk + 1 < SIZES {
            let is_bent = self.columns[j].is_bent;
            if found.as_ref().is_some_and(|found| is_bent || found.kink.is_none()) {
                break;
            }
            let shrunk = self.columns[j].shrunk + 1;
            let variants = parameter.variants(self.base, (&step.solved, here.0), shrunk)?;
            let sets = self.prepared(&variants)?;
            let column = &mut self.columns[j];
            let before = (std::mem::replace(&mut column.variants, variants), std::mem::replace(&mut column.sets, sets));
            let finer = column.variants.slopes(step, here);
            if found.as_ref().is_some_and(|found| !finer.as_ref().is_some_and(|finer| finer.is_less_bent(found))) {
                // A kink of the data themselves, which is followed.
                ((column.variants, column.sets), column.is_bent) = (before, true);
                break;
            }
            (column.shrunk, found) = (shrunk, finer);
        }
        found.ok_or_else(|| parameter.kink())
    }

    /// Adds the values and the derivatives of all outputs at a state.
    fn add_row(
        &mut self,
        table: &mut SeriesTable,
        (state, report): Reported,
        points: &[LinearPoint],
        equations: Option<(&StepResidual, &[[StepResidual; 4]])>,
    ) -> Result<(), GradientError> {
        let mut scratch = Scratch { state: state.clone(), report: report.cloned() };
        let readers = self.outputs.iter().zip(&self.sets);
        let readers: Vec<OutputReader> = readers
            .map(|(output, set)| OutputReader::with(self.base.of(state.step.max(1)), output, set.clone()))
            .collect();
        let values: Vec<f64> = readers.iter().map(|reader| reader.value_at(state, report)).collect();
        let mut rows = vec![Vec::with_capacity(self.columns.len()); self.outputs.len()];
        let mut kinks = vec![Vec::with_capacity(self.columns.len()); self.outputs.len()];
        for (j, column) in self.columns.iter().enumerate() {
            let of_step = equations.and_then(|(here, all)| Some((here, all.get(j)?)));
            let direct = self.direct(column, (state, report), &mut scratch, (of_step, &values));
            for (i, (reader, row)) in readers.iter().zip(&mut rows).enumerate() {
                let smooth = reader.along(&mut scratch, (state, report), points, (&column.state, &column.points));
                let Some(slope) = smooth else { return Err(no_slope(&self.outputs[i])) };
                let kink = column.kink.as_ref();
                let bent = kink.map_or(Some(0.0), |kink| {
                    reader.along(&mut scratch, (state, report), points, (kink, &column.bent_points))
                });
                let [more, bent_directly] = direct[i];
                let (slope, bent) = (slope + more, bent.unwrap_or(f64::NAN) + bent_directly);
                kinks[i].push([bent, column.variants.h]);
                row.push(slope);
            }
        }
        table.values.push(values);
        table.derivatives.push(rows);
        self.kinks.push(kinks);
        Ok(())
    }

    /// Returns an error if a derivative is none, because the data have a kink. Round-off of an output is that of its
    /// largest value.
    fn check(&self, table: &SeriesTable) -> Result<(), GradientError> {
        for i in 0..self.outputs.len() {
            let number = |row: &Vec<f64>| row.get(i).map_or(0.0, |value| value.abs());
            let largest = table.values.iter().map(number).filter(|value| value.is_finite()).fold(0.0, f64::max);
            for ((values, slopes), kinks) in table.values.iter().zip(&table.derivatives).zip(&self.kinks) {
                for (j, ([bent, h], slope)) in kinks[i].iter().zip(&slopes[i]).enumerate() {
                    let rounded = NOTHING * largest / h;
                    let is_smooth = bent.abs() <= KINK * slope.abs() + ROUNDINGS * rounded;
                    if !(values[i].is_nan() || is_smooth) {
                        return Err(self.request.parameters[j].kink());
                    }
                }
            }
        }
        Ok(())
    }

    /// ∂o/∂m of the outputs at fixed unknowns, and how much of a kink it has.
    fn direct(
        &self,
        column: &ParameterColumn,
        (state, report): Reported,
        scratch: &mut Scratch,
        (of_step, values): (Option<(&StepResidual, &[StepResidual; 4])>, &[f64]),
    ) -> Vec<[f64; 2]> {
        let mut found = vec![[0.0; 4]; self.outputs.len()];
        for (v, instance) in column.variants.all.iter().enumerate() {
            if let (Some(report), Some((_, all))) = (&mut scratch.report, of_step) {
                for (to, from) in report.contact.states.iter_mut().zip(&all[v].states) {
                    *to = crate::inclusion::PointState { status: to.status, ..*from };
                }
            }
            for ((output, sets), found) in self.outputs.iter().zip(&column.sets).zip(&mut found) {
                let instance = instance.of(state.step.max(1));
                let reader = OutputReader::with(instance, output, sets[v].clone());
                found[v] = reader.value_at(state, scratch.report.as_ref());
            }
        }
        if let (Some(to), Some(from)) = (&mut scratch.report, report) {
            to.contact.states.clone_from(&from.contact.states);
        }
        let of = |([a, b, c, d], at): (&[f64; 4], &f64)| {
            let [[slope], [bent]] = stencil::central(column.variants.h, [&[*a], &[*b], &[*at], &[*c], &[*d]]);
            [slope, bent]
        };
        found.iter().zip(values).map(of).collect()
    }
}

/// The driven contacts of a step.
fn driven(
    factors: &mut StepFactors,
    base: &ProblemInstance,
    (of, points): (&SolvedStep, &[LinearPoint]),
) -> Result<DrivenStep<Shifted>, GradientError> {
    let failed = |source| GradientError::Linear { step: of.n, part: "driven contacts", source };
    DrivenStep::forth(factors, base, of, points).map_err(failed)
}

fn no_slope(output: &GradientOutput) -> GradientError {
    let found = "a number with a kink in a step, such as the largest of several equal ones";
    let fault = Fault::new(format!("output {}", output.name), found, "a differentiable number");
    GradientError::refused(fault)
}

impl Variants {
    /// The derivatives of the equations of a step; `None` if a difference leaves the branch of a point on both sides.
    fn slopes(&self, step: &LinearStep<Shifted>, (forces, here): (&[Local], &StepResidual)) -> Option<StepSlopes> {
        let of = |variant: &PhasedInstance| {
            variant.of(step.solved.n.max(1)).residual(&step.solved, forces, Some((step.base, here)))
        };
        let all = self.all.each_ref().map(of);
        let [a, b, c, d] = all.each_ref();
        let around = Around { h: self.h, all: [a, b, here, c, d] };
        let (mut slope, kink) = ResidualSlope::of(&around, &step.base.discrete, step.points)?;
        slope.add(self.through_forms(step.base, &step.solved));
        Some(StepSlopes { all, slope, kink })
    }
}

impl ParameterColumn {
    /// Makes the derivatives those of a state at rest.
    fn rest(&mut self) {
        self.state.rest();
        self.kink.iter_mut().for_each(StateVector::rest);
    }

    fn advance(
        &mut self,
        factors: &mut StepFactors,
        step: &LinearStep<Shifted>,
        slope: &ResidualSlope,
        kink: Option<ResidualSlope>,
    ) -> Result<(), GradientError> {
        if self.kink.is_some() || self.kink_before.is_some() || kink.is_some() {
            let start = self.kink.take().unwrap_or_else(|| StateVector::zero(step.solved.old));
            let kink = kink.unwrap_or_else(|| ResidualSlope::zero(slope));
            let before = self.kink_before.take().unwrap_or_else(|| StateVector::zero(step.solved.old));
            let (end, points) = step.forward(factors, (&start, Some(&before)), &kink)?;
            (self.kink, self.kink_before, self.bent_points) = (Some(end), Some(start), points);
        }
        let (end, points) = step.forward(factors, (&self.state, self.before.as_ref()), slope)?;
        self.before = Some(std::mem::replace(&mut self.state, end));
        self.points = points;
        Ok(())
    }
}
