//! Modes of the last state of a run with their derivatives by parameters, through the state about which they are
//! linearised.
//!
//! The run is made at four values around that of each parameter; at the end of each the pencil is taken on the
//! eigenvectors of the modes, and the differences of these numbers are of fourth order. All contact points must keep
//! their status; the step is reduced until they do.

use std::sync::Arc;

use crate::adjoint::Parameter;
use crate::adjoint::stencil::{STEP, central};
use crate::output::{OutputError, Sink, Snapshot};
use crate::problem::{Fault, Problem};
use crate::stability::{DifferentiableModes, Modes, Reason, Search, StabilityError, SteadyState, modes};
use crate::state::State;

use super::{RunError, Settings, run};

/// Number of sizes of the step of a parameter, and by what it is reduced.
const TRIES: i32 = 3;
const SHRINK: f64 = 64.0;
/// Decades that are tried for the scale of a parameter that is zero.
const DECADES: i32 = 13;
/// Kink of a number relative to its derivative above which there is none.
const KINK: f64 = 1e-4;
/// Change of a number relative to its terms that the round-off of two states makes.
const ROUND_OFF: f64 = 1e-11;

/// Reason why modes or their derivatives were not found.
#[derive(Debug, thiserror::Error)]
pub enum ModeSlopesError {
    /// A run failed.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The modes were not found, or a parameter has no derivative.
    #[error(transparent)]
    Modes(#[from] StabilityError),
}

/// The modes of the last state of a run, with the state.
#[derive(Clone, Debug)]
pub struct FoundModes {
    /// The problem, as it was at the end.
    pub problem: Arc<Problem>,
    /// The state.
    pub state: State,
    /// The modes.
    pub modes: Modes,
}

/// Takes something of the last state of a run.
struct OfLastState<'a, T> {
    take: &'a mut dyn FnMut(SteadyState) -> Result<T, StabilityError>,
    found: Result<T, StabilityError>,
}

impl<T> Sink for OfLastState<'_, T> {
    fn last(&mut self, last: &Snapshot) -> Result<(), OutputError> {
        let Snapshot { problem, discretization: discrete, state, report: Some(report), .. } = *last else {
            return Ok(());
        };
        if state.is_last(&problem.timeline) {
            self.found = (self.take)(SteadyState { problem, discrete, state, report });
        }
        Ok(())
    }
}

/// Something of the last state of the run of a problem, whose steps another sink may see too.
fn at_end<T>(
    problem: &Problem,
    settings: &Settings,
    take: &mut dyn FnMut(SteadyState) -> Result<T, StabilityError>,
    sink: Option<&mut dyn Sink>,
) -> Result<T, ModeSlopesError> {
    let mut seen = OfLastState { take, found: Err(StabilityError::State(Reason::NoStep)) };
    match sink {
        Some(sink) => run(problem, settings, &mut [&mut seen, sink])?,
        None => run(problem, settings, &mut [&mut seen])?,
    };
    Ok(seen.found?)
}

/// Finds the modes of the last state of a run, with their derivatives by parameters of the problem. The sink sees the
/// run of the problem itself.
///
/// # Errors
/// If a run fails, the modes are not found, or contact points change their status however small the step of a
/// parameter.
pub fn modes_with(
    problem: &Problem,
    search: &Search,
    parameters: &[Parameter],
    settings: &Settings,
    sink: Option<&mut dyn Sink>,
) -> Result<FoundModes, ModeSlopesError> {
    let wanted = search.wanted(problem, settings.interrupt.as_deref());
    let kept = |at: SteadyState| (Arc::new(at.problem.clone()), at.state.clone());
    if parameters.is_empty() {
        let mut take = |at: SteadyState| {
            let found = modes(at.problem, at.discrete, at.state, at.report, &wanted)?;
            Ok((found, kept(at)))
        };
        let (modes, (problem, state)) = at_end(problem, settings, &mut take, sink)?;
        return Ok(FoundModes { problem, state, modes });
    }
    let mut take = |at: SteadyState| {
        let modes = DifferentiableModes::new(at, &wanted)?;
        let here = modes.projected(at, &wanted)?;
        Ok((modes, here.unwrap_or_default(), kept(at)))
    };
    let (mut modes, here, (problem, state)) = at_end(problem, settings, &mut take, sink)?;
    for parameter in parameters {
        let around = AroundParameter { parameter, search, settings, modes: &modes, here: &here };
        let slopes = around.slopes()?;
        modes.add((&parameter.name, parameter.value), &slopes)?;
    }
    Ok(FoundModes { problem, state, modes: modes.into_modes() })
}

/// The runs around the value of a parameter.
struct AroundParameter<'a> {
    parameter: &'a Parameter<'a>,
    search: &'a Search,
    settings: &'a Settings,
    modes: &'a DifferentiableModes,
    /// The numbers at the value itself.
    here: &'a [f64],
}

impl AroundParameter<'_> {
    /// The derivatives of the numbers, at the first size of the step at which no contact point changes its status and
    /// no law has a kink.
    fn slopes(&self) -> Result<Vec<f64>, ModeSlopesError> {
        let value = self.parameter.value;
        let sizes: Vec<f64> = if value.abs() > 0.0 {
            (0..TRIES).map(|shrunk| STEP * value.abs() / SHRINK.powi(shrunk)).collect()
        } else {
            (0..DECADES).map(|decade| STEP * 10f64.powi(-decade)).collect()
        };
        let (mut failed, mut first, mut bends) = (None, None, 0);
        for h in sizes {
            match self.at_step(h) {
                Ok(Some(found)) => {
                    let largest = *first.get_or_insert(h);
                    if !self.is_bent(&found, largest) {
                        return Ok(found.into_iter().map(|[slope, _]| slope).collect());
                    }
                    failed = Some(self.refusal("at which data or laws have a kink"));
                    bends += 1;
                    if bends == TRIES {
                        break;
                    }
                }
                Ok(None) => failed = Some(self.refusal("at which contact points change between open, stick and slip")),
                Err(error) if self.is_interrupted() => return Err(error),
                Err(error) => failed = Some(error),
            }
        }
        Err(failed.unwrap_or(ModeSlopesError::Modes(StabilityError::State(Reason::NoStep))))
    }

    /// The refusal of a value at which there are no derivatives.
    fn refusal(&self, why: &str) -> ModeSlopesError {
        let Parameter { name, value, .. } = self.parameter;
        let expected = "a value around which the modes are differentiable";
        let fault = Fault::new(name.clone(), format!("{value}, {why}"), expected);
        let hint = "move it a little, or take differences of `modes --each` to one side";
        ModeSlopesError::Modes(StabilityError::Problem(fault.hint(hint)))
    }

    /// True if derivatives have kinks beyond the round-off of the `largest` step: that of a smaller one might hide
    /// them.
    fn is_bent(&self, found: &[[f64; 2]], largest: f64) -> bool {
        let sizes = self.modes.sizes();
        let of = |([slope, _], size): (&[f64; 2], &f64)| slope.abs() / size;
        let most = found.iter().zip(&sizes).map(of).fold(0.0, f64::max);
        let limit = KINK * most + ROUND_OFF / largest;
        found.iter().zip(&sizes).any(|([_, bent], size)| bent.abs() > size * limit)
    }

    fn is_interrupted(&self) -> bool {
        let flag = self.settings.interrupt.as_ref();
        flag.is_some_and(|flag| flag.load(std::sync::atomic::Ordering::Relaxed))
    }

    /// The derivatives with a step, each with its kink; `None` if contact points change their status within it.
    fn at_step(&self, h: f64) -> Result<Option<Vec<[f64; 2]>>, ModeSlopesError> {
        let Parameter { value, problem, .. } = self.parameter;
        let mut all = Vec::with_capacity(4);
        for j in [-2.0, 2.0, -1.0, 1.0] {
            let other = problem(value + j * h).map_err(StabilityError::Problem)?;
            let wanted = self.search.wanted(&other, self.settings.interrupt.as_deref());
            let numbers = at_end(&other, self.settings, &mut |at| self.modes.projected(at, &wanted), None)?;
            let Some(numbers) = numbers.filter(|numbers| numbers.len() == self.here.len()) else { return Ok(None) };
            all.push(numbers);
        }
        let slope = |i: usize| {
            let at = |k: usize| [all[k][i]];
            let [[slope], [bent]] = central(h, [&at(0), &at(2), &[self.here[i]], &at(3), &at(1)]);
            [slope, bent]
        };
        Ok(Some((0..self.here.len()).map(slope).collect()))
    }
}
