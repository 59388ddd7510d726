//! Derivatives of runs by data of the problem: of numbers at the end by an adjoint through all steps ([`gradient`]), of
//! outputs at all steps by the linearised steps forward ([`series`]).
//!
//! A step at its solution is a smooth system R(z; z₀, m) = 0 in its unknowns z, as long as no contact point changes its
//! state. With J = ∂R/∂z, y the solution of Jᵀ y = λ and λ the derivatives of an output o by what the step ends with,
//!
//! ```text
//!     do/dm = ∂o/∂m − Σ y·∂R/∂m,       λ at the start = −(∂R/∂z₀)ᵀ y,
//! ```
//!
//! summed from the last step to the first one. The matrix of the bodies is symmetric and has one factor; what contact
//! adds to J is not symmetric, because pressure acts on friction and not the other way round, and is transposed.
//! Half-steps that hold at once are solved for together.
//!
//! | module | holds |
//! |---|---|
//! | `scope`, `chosen` | the problems that have derivatives, and the steps of runs that choose them |
//! | `history` | the states of the run |
//! | `instance`, `exerted` | the equations of a step at given unknowns |
//! | `points` | the linearised contact points, and their distances to a change of state |
//! | `met` | whether a step obeys the equations that are differentiated |
//! | `factors` | the matrices of a step at its solution with their factors, and derivatives of forms in the state |
//! | `forms` | derivatives of forms by a parameter |
//! | `bordered` | a linearised half-step with the equations of its contact points |
//! | `balances` | the equations of foundations with a heat capacity, and of contacts that move as a force asks |
//! | `advance`, `driven` | contacts that move as a force asks: what their points see of it, and their equations |
//! | `lumped`, `worn` | foundations with a heat capacity, and depths of wear of pairs |
//! | `vector` | numbers of a state |
//! | `transpose`, `sweep` | Jᵀ, and a step backward |
//! | `tangent`, `series` | J, and the steps forward along with a run, for outputs at all steps |
//! | `outputs`, `along`, `parameter` | o with its derivatives, and the problems around a value of m |
//! | `stencil` | differences of fourth order |
//!
//! ∂R/∂m is a difference of equations at fixed unknowns, never of runs: any number of a case is a parameter.

mod advance;
mod along;
mod balances;
mod bordered;
pub(crate) mod chosen;
mod driven;
mod error;
mod exerted;
mod factors;
mod forms;
mod history;
mod instance;
mod lumped;
mod met;
mod outputs;
mod parameter;
mod points;
mod scope;
mod series;
pub(crate) mod stencil;
mod sweep;
mod tangent;
#[cfg(all(test, feature = "case"))]
mod tests;
mod transpose;
mod vector;
mod worn;

use std::sync::atomic::{AtomicBool, Ordering};

use driven::DrivenStep;
pub use error::{GradientError, RefusedGradient};
use factors::StepFactors;
use history::{KeptStep, RunHistory, started};
use instance::{PhasedInstance, ProblemInstance, SolvedStep, StepResidual, at_level};
use outputs::{GradientOutput, OutputReader};
pub use parameter::Parameter;
use parameter::Variants;
use points::{Forced, LinearPoint, PointMargin, TOUCHES, linearised, margins};
use serde::Serialize;
pub use series::{SeriesRequest, SeriesTable, series};
use sweep::{Around, LinearStep, Multiplied, OfPoints};
use vector::StateVector;

use crate::inclusion::Local;
use crate::output::Probe;
use crate::problem::{Fault, Problem, StartState};
use crate::state::{State, StepReport};
use crate::step::{EquilibriumStep, March, initial_state};

/// Memory granted to the states of a run, bytes.
const GRANTED: usize = 1 << 30;
/// Kink of a parameter relative to the derivative above which there is none, and the roundings that are no kink.
const KINK: f64 = 1e-4;
/// The same above which a smaller step of the parameter is tried: a law that bends within the step, such as a power of
/// a small penetration, is resolved by it, and a kink is not.
const BENT: f64 = 1e-7;
const ROUNDINGS: f64 = 256.0;
/// Part of an output that counts as a rounding.
const NOTHING: f64 = 16.0 * f64::EPSILON;
/// Number of sizes of the step of a parameter.
const SIZES: i32 = 3;

/// What is asked for.
pub struct GradientRequest<'a> {
    /// The problem.
    pub problem: &'a Problem,
    /// The probes that outputs may name.
    pub probes: &'a [Probe],
    /// Names of numbers at the end of the run: columns of probes, `final.contact.force.0`,
    /// `energy.friction_dissipation`, `final.contact.wear_volume`.
    pub outputs: &'a [String],
    /// The data by which they are differentiated.
    pub parameters: &'a [Parameter<'a>],
    /// Memory for the states of the run in bytes; `None` for 1 GiB. States that do not fit are made again.
    pub memory: Option<usize>,
    /// Ends the computation when it becomes true.
    pub interrupt: Option<&'a AtomicBool>,
}

/// Derivatives of numbers at the end of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GradientTable {
    /// Names of the outputs and parameters, with their values.
    pub outputs: Vec<(String, f64)>,
    /// The parameters.
    pub parameters: Vec<(String, f64)>,
    /// Derivatives by output and parameter.
    pub derivatives: Vec<Vec<f64>>,
    /// The least margin: how far the contact points are from a change of state, over all steps. With a margin of 0 the
    /// derivatives are one-sided. `None` without contact points that could change.
    pub margin: Option<f64>,
    /// Number of contact points and steps that are on a change of state.
    pub ties: usize,
    /// If exactly one point is: the derivatives with this point in its other state.
    pub beyond: Option<Vec<Vec<f64>>>,
    /// Where the margin is least: the step and the position of the contact point, m.
    pub nearest: Option<(usize, [f64; 3])>,
}

/// Computes the derivatives of all outputs by all parameters.
///
/// # Errors
/// If the problem has a feature whose derivative is not there, if a name is unknown, if a parameter changes the number
/// of steps, nodes or contact points, or if a step fails.
pub fn gradient(request: &GradientRequest) -> Result<GradientTable, GradientError> {
    let go_on = || !request.interrupt.is_some_and(|interrupt| interrupt.load(Ordering::Relaxed));
    let Some(made) = chosen::made_steps(request.problem, &go_on)? else { return gradient_of(request) };
    let problem = &chosen::with_steps(request.problem, &made);
    let parameters = request.parameters.iter().map(|parameter| parameter.with_steps(request.problem, &made));
    gradient_of(&GradientRequest { problem, parameters: &parameters.collect::<Vec<_>>(), ..*request })
}

/// The derivatives of a run whose steps are given.
fn gradient_of(request: &GradientRequest) -> Result<GradientTable, GradientError> {
    let base = PhasedInstance::new(request.problem);
    scope::check(&base)?;
    let outputs = outputs_of(request)?;
    let go_on = || !request.interrupt.is_some_and(|interrupt| interrupt.load(Ordering::Relaxed));
    let mut history = RunHistory::new(&base, request.memory.unwrap_or(GRANTED), &go_on)?;
    let equilibrium = Equilibrium::of(&base)?;
    let equilibrium = equilibrium.as_ref();
    let mut whole =
        WholeSweep { request, base: &base, outputs: &outputs, history: &mut history, equilibrium, go_on: &go_on };
    let (derivatives, near) = whole.derivatives(None)?;
    let ties: Vec<PointMargin> = near.iter().copied().filter(|near| near.value <= TOUCHES).collect();
    let nearest = near.iter().min_by(|a, b| a.value.total_cmp(&b.value)).copied();
    let beyond = match ties.as_slice() {
        [PointMargin { n, point, beyond: Some(branch), .. }] => {
            Some(whole.derivatives(Some(Forced { n: *n, point: *point, branch: *branch }))?.0)
        }
        _ => None,
    };
    let last = whole.last()?;
    let at_last = base.of(last.0.step);
    let values = outputs.iter().map(|output| Ok(OutputReader::new(at_last, output)?.value(&last.0, &last.1)));
    let values = values.collect::<Result<Vec<f64>, GradientError>>()?;
    let place = |near: PointMargin| Some((near.n, base.first.discrete.boundary.points.get(near.point)?.x));
    Ok(GradientTable {
        outputs: request.outputs.iter().cloned().zip(values).collect(),
        parameters: request.parameters.iter().map(|parameter| (parameter.name.clone(), parameter.value)).collect(),
        derivatives,
        margin: nearest.map(|nearest| nearest.value),
        ties: ties.len(),
        beyond,
        nearest: nearest.and_then(place),
    })
}

/// Called with an output and the multipliers of (4.1) and (4.2) of a step, node-major: the derivatives of the output by
/// a force and by a supply of heat at each node in that step. Those of (4.2) are empty without temperature.
pub type SeeMultipliers<'a> = dyn FnMut(usize, [&[f64]; 2]) + 'a;

/// Shows the multipliers of all outputs, of each step from the last one to the first. The parameters are not used.
///
/// # Errors
/// As [`gradient`].
pub fn multipliers(request: &GradientRequest, see: &mut SeeMultipliers) -> Result<(), GradientError> {
    let go_on = || !request.interrupt.is_some_and(|interrupt| interrupt.load(Ordering::Relaxed));
    match chosen::made_steps(request.problem, &go_on)? {
        Some(made) => {
            let problem = &chosen::with_steps(request.problem, &made);
            multipliers_of(&GradientRequest { problem, ..*request }, see)
        }
        None => multipliers_of(request, see),
    }
}

/// The multipliers of a run whose steps are given.
fn multipliers_of(request: &GradientRequest, see: &mut SeeMultipliers) -> Result<(), GradientError> {
    let base = PhasedInstance::new(request.problem);
    scope::check(&base)?;
    let outputs = outputs_of(request)?;
    let go_on = || !request.interrupt.is_some_and(|interrupt| interrupt.load(Ordering::Relaxed));
    let mut history = RunHistory::new(&base, request.memory.unwrap_or(GRANTED), &go_on)?;
    let request = &GradientRequest { parameters: &[], ..*request };
    let mut whole =
        WholeSweep { request, base: &base, outputs: &outputs, history: &mut history, equilibrium: None, go_on: &go_on };
    whole.sweep(None, &[], see).map(|_| ())
}

fn outputs_of(request: &GradientRequest) -> Result<Vec<GradientOutput>, GradientError> {
    request.outputs.iter().map(|name| GradientOutput::named(name, request.problem, request.probes)).collect()
}

/// Sums over the steps: the derivative, its kink, and the round-off of both, by output.
type Sums = Vec<[f64; 3]>;

/// The derivatives of an output by a state, by the one before it, and by the contact points of the last step.
struct OutputWeights {
    state: StateVector,
    before: Option<StateVector>,
    direct: Option<OfPoints>,
}

/// The sweep over all steps.
struct WholeSweep<'a> {
    request: &'a GradientRequest<'a>,
    base: &'a PhasedInstance,
    outputs: &'a [GradientOutput],
    history: &'a mut RunHistory,
    equilibrium: Option<&'a Equilibrium>,
    go_on: &'a dyn Fn() -> bool,
}

impl WholeSweep<'_> {
    /// The last state with the report of its step.
    fn last(&mut self) -> Result<(State, StepReport), GradientError> {
        let (steps, report) = (self.history.steps, self.history.report.clone());
        Ok((self.history.around(steps)?[1].state.clone(), report))
    }

    /// The derivatives by output and parameter, and the margins of all points that are near or nearest.
    fn derivatives(&mut self, forced: Option<Forced>) -> Result<(Vec<Vec<f64>>, Vec<PointMargin>), GradientError> {
        let count = self.request.parameters.len();
        let (mut sizes, mut kept): (_, Vec<Option<Sums>>) = (vec![0; count], vec![None; count]);
        let mut open = vec![true; count];
        loop {
            let (sums, near) = self.sweep(forced.as_ref(), &sizes, &mut |_, _| {})?;
            for (j, found) in sums.into_iter().enumerate() {
                if !open[j] {
                    continue;
                }
                // A difference leaves the branch of a point on both sides, or a law bends within it.
                let is_better = kept[j].as_ref().is_none_or(|kept| is_less_bent(&found, kept));
                if is_better {
                    kept[j] = Some(found);
                }
                let bends = kept[j].iter().flatten().any(is_bent);
                open[j] = bends && is_better && sizes[j] + 1 < SIZES;
                sizes[j] += i32::from(open[j]);
            }
            if open.iter().all(|open| !open) {
                let sums: Vec<Sums> = kept.into_iter().map(Option::unwrap_or_default).collect();
                self.check(&sums)?;
                let by_output = (0..self.outputs.len()).map(|i| sums.iter().map(|sums| sums[i][0]).collect()).collect();
                return Ok((by_output, near));
            }
        }
    }

    /// Returns an error if a derivative is none, because the data have a kink.
    fn check(&self, sums: &[Sums]) -> Result<(), GradientError> {
        for (parameter, sums) in self.request.parameters.iter().zip(sums) {
            let is_smooth = |[slope, kink, rounded]: &[f64; 3]| {
                slope.is_finite() && kink.abs() <= KINK * slope.abs() + ROUNDINGS * rounded
            };
            if !sums.iter().all(is_smooth) {
                return Err(parameter.kink());
            }
        }
        Ok(())
    }

    /// One sweep from the last step to the first one, and to the equilibrium from which the run starts.
    fn sweep(
        &mut self,
        forced: Option<&Forced>,
        sizes: &[i32],
        see: &mut SeeMultipliers,
    ) -> Result<(Vec<Sums>, Vec<PointMargin>), GradientError> {
        let (phased, request, outputs) = (self.base, self.request, self.outputs);
        let (last, steps) = (self.last()?, self.history.steps);
        let mut back = BackSweep {
            outputs,
            sizes,
            forced,
            ended: Vec::new(),
            variants: Vec::new(),
            factors: None,
            see,
            sums: vec![vec![[0.0; 3]; outputs.len()]; request.parameters.len()],
            near: Vec::new(),
        };
        for n in (1..=steps).rev() {
            if !(self.go_on)() {
                return Err(GradientError::Interrupted);
            }
            let [old, new] = self.history.around(n)?;
            let (base, start) = (phased.of(n), phased.start(n));
            let old = &*started(&old.state, &new.state, start);
            let begins = (n == steps).then_some((phased, request.parameters));
            back.visit(base, (n, old, new), begins, Some(&last).filter(|_| n == steps))?;
            if start.rests {
                back.ended.iter_mut().for_each(|weighted| weighted.state.rest());
            }
        }
        if let Some(Equilibrium { instance, start, kept }) = self.equilibrium {
            let others = back.without_equilibrium();
            add_start(&phased.first, &back.variants, &others, &mut back.sums)?;
            let still: Vec<Parameter> = request.parameters.iter().map(Parameter::at_equilibrium).collect();
            back.factors = None;
            back.visit(&instance.first, (0, start, kept), Some((instance, &still)), None)?;
        } else {
            add_start(&phased.first, &back.variants, &back.ended, &mut back.sums)?;
        }
        Ok((back.sums, back.near))
    }
}

/// A sweep backward, as far as it has come.
struct BackSweep<'a, 's> {
    outputs: &'a [GradientOutput],
    /// The sizes of the steps of the parameters.
    sizes: &'a [i32],
    forced: Option<&'a Forced>,
    ended: Vec<OutputWeights>,
    variants: Vec<Variants>,
    factors: Option<StepFactors>,
    see: &'a mut SeeMultipliers<'s>,
    sums: Vec<Sums>,
    near: Vec<PointMargin>,
}

impl BackSweep<'_, '_> {
    /// Takes the weights to the start of a step, and adds what its equations have of the parameters. A sweep, and the
    /// step to an equilibrium, `begins` with the problem and the parameters; `last` is the end of the run.
    fn visit(
        &mut self,
        base: &ProblemInstance,
        (n, old, new): (usize, &State, &KeptStep),
        begins: Option<(&PhasedInstance, &[Parameter])>,
        last: Option<&(State, StepReport)>,
    ) -> Result<(), GradientError> {
        let at = &*at_level(&base.rule(n, old), old, &new.state);
        let mut made = StepFactors::kept_or_made(self.factors.take(), base, (n, old, at))?;
        let (chosen, unknown) = (made.chosen(base, n, [old, at]), made.on_contact());
        let (states, flux) = (&new.states, &new.flux);
        let solved = SolvedStep { n, old, new: &new.state, at, states, flux, chosen: &chosen, unknown: &unknown };
        let (points, forces, here) = at_solution(base, &solved, self.forced)?;
        keep_least(&mut self.near, margins(&base.problem.contacts, &solved, &points, &made.rule));
        if let Some((phased, parameters)) = begins {
            let parameters = parameters.iter().zip(self.sizes);
            let all = parameters.map(|(of, size)| of.variants(phased, (&solved, &forces), *size));
            self.variants = all.collect::<Result<_, _>>()?;
        }
        if let Some(last) = last {
            self.ended = at_end(base, self.outputs, last, &points)?;
        }
        let failed = |source| GradientError::Linear { step: n, part: "driven contacts", source };
        let driven = &DrivenStep::back(&mut made, base, &solved, &points).map_err(failed)?;
        let step = LinearStep { base, solved, points: &points, driven };
        let of_outputs = self.ended.iter_mut().map(|OutputWeights { state, before, direct }| {
            step.back(&mut made, (state, before), direct.take().as_ref())
        });
        let multiplied = of_outputs.collect::<Result<Vec<Multiplied>, GradientError>>()?;
        multiplied.iter().enumerate().for_each(|(i, multiplied)| (self.see)(i, multiplied.of_step()));
        let sizes: Vec<f64> = multiplied.iter().map(|multiplied| multiplied.size(&here)).collect();
        for (variants, sums) in self.variants.iter().zip(&mut self.sums) {
            let residual =
                |variant: &PhasedInstance| variant.of(n.max(1)).residual(&solved, &forces, Some((base, &here)));
            let all = variants.all.each_ref().map(residual);
            if let Some(last) = last {
                add_outputs(self.outputs, variants, (base, &here), &all, (last, sums))?;
            }
            let [a, b, c, d] = all.each_ref();
            let around = Around { h: variants.h, all: [a, b, &here, c, d] };
            let through = variants.through_forms(base, &solved);
            for (sum, (multiplied, size)) in sums.iter_mut().zip(multiplied.iter().zip(&sizes)) {
                add(sum, multiplied.by_parameter(&around, &through, *size));
            }
        }
        self.factors = Some(made);
        Ok(())
    }

    /// The weights of the initial state but for those that become the ones of the equilibrium: of its displacement and
    /// of the lengths by which contacts have moved.
    fn without_equilibrium(&mut self) -> Vec<OutputWeights> {
        let of_equilibrium = |OutputWeights { state, .. }: &mut OutputWeights| {
            let none = StateVector { u: state.u.clone(), advance: state.advance.clone(), ..state.zeros() };
            let mut others = std::mem::replace(state, none);
            others.u.fill(0.0);
            others.advance.fill(0.0);
            OutputWeights { state: others, before: None, direct: None }
        };
        self.ended.iter_mut().map(of_equilibrium).collect()
    }
}

/// True if a derivative is lost, or its kink more than round-off and than [`BENT`].
fn is_bent([slope, kink, rounded]: &[f64; 3]) -> bool {
    slope.is_nan() || kink.abs() > BENT * slope.abs() + ROUNDINGS * rounded
}

/// True if all kinks of sums at a smaller step are at most half of those before.
fn is_less_bent(found: &Sums, before: &Sums) -> bool {
    let mut both = found.iter().zip(before).filter(|(_, before)| is_bent(before));
    both.all(|(found, before)| before[0].is_nan() || found[1].abs() <= 0.5 * before[1].abs())
}

/// The linearised contact points of a step, their forces, and its equations, which are met.
fn at_solution(
    base: &ProblemInstance,
    solved: &SolvedStep,
    forced: Option<&Forced>,
) -> Result<(Vec<LinearPoint>, Vec<Local>, StepResidual), GradientError> {
    let points = linearised(base, solved, forced).map_err(|i| kink(base, solved.n, i))?;
    let forces: Vec<Local> = points.iter().map(|point| point.force).collect();
    let here = base.residual(solved, &forces, None);
    match here.unmet(base, solved) {
        Some(unmet) => Err(unknown_form(solved.n, unmet)),
        None => Ok((points, forces, here)),
    }
}

/// The refusal of a step whose equations are not those that are differentiated.
fn unknown_form(n: usize, unmet: &str) -> GradientError {
    let found = format!("another form of {unmet}");
    let fault = Fault::new(format!("step {n}"), found, "a step whose equations are those that are differentiated");
    GradientError::refused(fault.hint("take differences of whole runs (`run --each`)"))
}

fn add(sum: &mut [f64; 3], more: [f64; 3]) {
    sum.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
}

fn kink(base: &ProblemInstance, n: usize, i: usize) -> GradientError {
    GradientError::Kink { step: n, x: base.discrete.boundary.points.get(i).map_or([0.0; 3], |point| point.x) }
}

/// Keeps the margins that count as zero, and the least one.
fn keep_least(near: &mut Vec<PointMargin>, more: Vec<PointMargin>) {
    near.extend(more);
    let least = near.iter().fold(f64::INFINITY, |least, near| least.min(near.value));
    let mut has_least = false;
    near.retain(|near| {
        let is_least = near.value <= least && !has_least;
        has_least |= is_least;
        is_least || near.value <= TOUCHES
    });
}

/// The derivatives of the outputs by the last state.
fn at_end(
    base: &ProblemInstance,
    outputs: &[GradientOutput],
    (state, report): &(State, StepReport),
    points: &[LinearPoint],
) -> Result<Vec<OutputWeights>, GradientError> {
    let slopes = |output| {
        let (weights, of_points) = OutputReader::new(base, output)?.slopes(state, report, points);
        if weights.lists().flatten().chain(of_points.iter().flatten()).any(|slope| !slope.is_finite()) {
            let found = "a number with a kink here, such as the largest of several equal ones";
            let fault = Fault::new(format!("output {}", output.name), found, "a differentiable number");
            return Err(GradientError::refused(fault));
        }
        Ok(OutputWeights { state: weights, before: None, direct: Some(of_points) })
    };
    outputs.iter().map(slopes).collect()
}

/// Adds ∂o/∂m of the outputs at fixed unknowns of the last step.
fn add_outputs(
    outputs: &[GradientOutput],
    variants: &Variants,
    (base, here): (&ProblemInstance, &StepResidual),
    all: &[StepResidual; 4],
    ((state, report), sums): (&(State, StepReport), &mut Sums),
) -> Result<(), GradientError> {
    let at = |instance, residual: &StepResidual, output| {
        let mut report = report.clone();
        for (to, from) in report.contact.states.iter_mut().zip(&residual.states) {
            *to = crate::inclusion::PointState { status: to.status, ..*from };
        }
        Ok::<[f64; 1], GradientError>([OutputReader::new(instance, output)?.value(state, &report)])
    };
    for (output, sum) in outputs.iter().zip(sums) {
        let [a, b, c, d] = variants.all.each_ref().map(|variant| variant.of(state.step));
        let values = [at(a, &all[0], output)?, at(b, &all[1], output)?, at(base, here, output)?];
        let after = [at(c, &all[2], output)?, at(d, &all[3], output)?];
        let [one, two, middle] = values.each_ref();
        let [[slope], [bent]] = stencil::central(variants.h, [one, two, middle, &after[0], &after[1]]);
        add(sum, [slope, bent, NOTHING * middle[0].abs() / variants.h]);
    }
    Ok(())
}

/// The equilibrium from which a run starts, as the step of a problem of its own.
struct Equilibrium {
    instance: PhasedInstance,
    /// The reference state, and the equilibrium.
    start: State,
    kept: KeptStep,
}

impl Equilibrium {
    /// The equilibrium of a run that starts so.
    fn of(base: &PhasedInstance) -> Result<Option<Equilibrium>, GradientError> {
        let ProblemInstance { problem, discrete, .. } = &base.first;
        if problem.initial.state != StartState::Equilibrium {
            return Ok(None);
        }
        let EquilibriumStep { start, end, report } = March::on(problem, discrete, &problem.backend)?.equilibrium()?;
        let kept = KeptStep::of(&end, &report);
        Ok(Some(Equilibrium { instance: PhasedInstance::at_start(&problem.at_equilibrium()), start, kept }))
    }
}

/// Adds the derivatives through the initial state.
fn add_start(
    base: &ProblemInstance,
    variants: &[Variants],
    ended: &[OutputWeights],
    sums: &mut [Sums],
) -> Result<(), GradientError> {
    let state = |of: &ProblemInstance| initial_state(&of.problem, &of.discrete, None);
    let here = state(base)?;
    for (variants, sums) in variants.iter().zip(sums) {
        let [a, b, c, d] = variants.all.each_ref().map(|variant| state(&variant.first));
        let all = [a?, b?, here.clone(), c?, d?];
        for (OutputWeights { state: weights, .. }, sum) in ended.iter().zip(sums) {
            let values = all.each_ref().map(|state| [weights.product(state)]);
            let [[slope], [bent]] = stencil::central(variants.h, values.each_ref());
            add(sum, [slope, bent, f64::EPSILON * values[2][0].abs() / variants.h]);
        }
    }
    Ok(())
}

impl GradientTable {
    /// The table as CSV: a row per output and parameter.
    #[must_use]
    pub fn csv(&self) -> String {
        let margin = self.margin.map_or_else(String::new, |margin| format!("{margin:?}"));
        let mut text = "output,parameter,value,at,derivative,margin,beyond\n".to_owned();
        for (i, (output, value)) in self.outputs.iter().enumerate() {
            for (j, (parameter, at)) in self.parameters.iter().enumerate() {
                let slope = |of: &[Vec<f64>]| of.get(i).and_then(|row| row.get(j)).map(|slope| format!("{slope:?}"));
                let here = slope(&self.derivatives).unwrap_or_default();
                let beyond = self.beyond.as_deref().and_then(slope).unwrap_or_default();
                text += &format!("{output},{parameter},{value:?},{at:?},{here},{margin},{beyond}\n");
            }
        }
        text
    }
}
