//! The steps of Gauss–Newton from the start to the minimum.

use serde::{Deserialize, Serialize};

use super::error::IdentificationError;
use super::least_squares::{Change, LinearModel};
use super::model::{Evaluated, OutputModel};
use super::{DescentEnding, IdentificationRequest};
use crate::adjoint::GradientError;
use crate::problem::Fault;

/// Squared change of the parameters, in their standard deviations, below which the minimum is reached.
const REACHED: f64 = 1e-10;
/// Gain of a damped step, in squared standard deviations, of which the linear model promised more: the way down is
/// along a kink, and the rest of it says nothing about the parameters.
const LEVEL: f64 = 1e-4;
/// Relative change of a parameter, and part of the data that residuals are, that count as round-off.
const ROUNDED: f64 = 1e-11;
/// Largest relative change of a parameter in which the model counts as linear, so that a small gain tells that the
/// minimum is near.
const SHORT: f64 = 0.1;
/// Part of the gain that the linear model promises below which a step is not taken, and above which damping is reduced.
const POOR: f64 = 1e-4;
const GOOD: f64 = 0.75;
/// Damping relative to the square of the largest singular value at a first failure, its growth at each further one, and
/// where it has gone.
const FIRST: f64 = 1e-3;
const GROWTH: f64 = 10.0;
const GONE: f64 = 1e-12;
/// Most steps; ten are many.
const STEPS: usize = 200;
/// Most estimates of the deviations of the data, and the relative change of one that is none.
const ESTIMATES: usize = 30;
const SETTLED: f64 = 1e-4;

/// Where a descent stands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DescentState {
    /// The parameters.
    pub values: Vec<f64>,
    /// Damping λ relative to the square of the largest singular value; 0 for Gauss–Newton.
    pub damping: f64,
    /// Standard deviations by series, as they are estimated; empty if the data state theirs.
    pub deviations: Vec<f64>,
    /// Estimates of the deviations that were made.
    pub estimates: usize,
    /// Steps that were taken, and runs.
    pub steps: usize,
    /// Runs.
    pub runs: usize,
    /// χ² after each step.
    pub history: Vec<f64>,
}

/// A descent at its end.
pub(super) struct DescentEnd {
    pub state: DescentState,
    pub evaluated: Evaluated,
    pub linear: LinearModel,
    /// True for parameters that a bound holds.
    pub held: Vec<bool>,
    pub ending: DescentEnding,
}

/// A descent.
pub(super) struct Descent<'a> {
    request: &'a IdentificationRequest<'a>,
    model: &'a OutputModel<'a>,
    state: DescentState,
    evaluated: Evaluated,
}

impl<'a> Descent<'a> {
    /// The descent at its start, or where an earlier one stands.
    pub fn new(
        request: &'a IdentificationRequest<'a>,
        model: &'a OutputModel<'a>,
    ) -> Result<Descent<'a>, IdentificationError> {
        if let Some(from) = &request.from {
            let series = if request.measured.states_deviations() { 0 } else { request.measured.series.len() };
            if from.values.len() != request.family.values.len() || from.deviations.len() != series {
                let fault = Fault::new("the state of the descent", "one of other parameters or data", "one of these");
                return Err(IdentificationError::data(fault));
            }
        }
        let state = request.from.clone().unwrap_or_else(|| DescentState {
            values: request.family.values.clone(),
            damping: 0.0,
            deviations: first_deviations(request),
            estimates: 0,
            steps: 0,
            runs: 0,
            history: Vec::new(),
        });
        let evaluated = model.at(&state.values)?;
        Ok(Descent { request, model, state, evaluated })
    }

    /// Descends.
    pub fn made(
        mut self,
        watch: &mut dyn FnMut(&DescentState) -> Result<(), IdentificationError>,
    ) -> Result<DescentEnd, IdentificationError> {
        if self.state.runs == 0 {
            self.state.runs = 1;
            self.state.history.push(self.linear().sum());
        }
        loop {
            watch(&self.state)?;
            if self.state.steps >= STEPS {
                let chi_square = self.linear().sum();
                return Err(IdentificationError::NoMinimum { steps: self.state.steps, chi_square });
            }
            let Some(ending) = self.step()? else { continue };
            if self.estimate() {
                continue;
            }
            let linear = self.linear();
            let held = self.held(&linear);
            return Ok(DescentEnd { state: self.state, evaluated: self.evaluated, linear, held, ending });
        }
    }

    fn linear(&self) -> LinearModel {
        self.model.linear(&self.evaluated, &self.state.values, &self.state.deviations)
    }

    /// How far each parameter may change, relative to its scale.
    fn room(&self) -> Vec<[f64; 2]> {
        let scales = self.model.scales(&self.state.values);
        let ends = self.state.values.iter().zip(self.request.bounds).zip(scales);
        ends.map(|((value, bounds), scale)| bounds.map(|bound| (bound - value) / scale)).collect()
    }

    /// Which parameters a bound holds: they are there, and the data would have them beyond.
    fn held(&self, linear: &LinearModel) -> Vec<bool> {
        let slope = |j: usize| super::singular::product(&linear.columns[j], &linear.residuals);
        let ends = self.state.values.iter().zip(self.request.bounds).enumerate();
        ends.map(|(j, (value, [low, high]))| (value <= low && slope(j) < 0.0) || (value >= high && slope(j) > 0.0))
            .collect()
    }

    /// Makes a step, or says why there is none.
    fn step(&mut self) -> Result<Option<DescentEnding>, IdentificationError> {
        let (linear, room) = (self.linear(), self.room());
        let (sum, largest) = (linear.sum(), linear.largest());
        let freedom = (linear.residuals.len() - linear.columns.len().min(linear.residuals.len() - 1)) as f64;
        let known = self.request.measured.states_deviations();
        let variance = if known { (sum / freedom).max(1.0) } else { sum / freedom };
        let whole = linear.change(0.0, &room);
        if whole.gain <= REACHED * variance && whole.is_below(SHORT) || self.is_met(sum) {
            return Ok(Some(DescentEnding::Minimum));
        }
        loop {
            let change = if self.state.damping > 0.0 {
                linear.change(self.state.damping * largest, &room)
            } else {
                whole.clone()
            };
            if change.is_below(ROUNDED) {
                // Undamped it is the minimum to round-off; damped so far, none of the steps descended.
                let ending = if self.state.damping > 0.0 { DescentEnding::Kink } else { DescentEnding::Minimum };
                self.state.damping = 0.0;
                return Ok(Some(ending));
            }
            let values = self.changed(&change);
            self.state.runs += 1;
            let tried = self.tried(&values)?;
            let gain =
                tried.as_ref().map(|tried| sum - self.model.linear(tried, &values, &self.state.deviations).sum());
            if let (Some(tried), Some(gain)) = (tried, gain)
                && gain > POOR * change.gain
            {
                (self.state.values, self.evaluated) = (values, tried);
                self.state.steps += 1;
                self.state.history.push(sum - gain);
                let is_level = self.state.damping > 0.0 && gain <= LEVEL * variance;
                if gain > GOOD * change.gain {
                    self.state.damping /= GROWTH;
                }
                if self.state.damping < GONE || is_level {
                    self.state.damping = 0.0;
                }
                return Ok(is_level.then_some(DescentEnding::Kink));
            }
            self.state.damping = if self.state.damping > 0.0 { self.state.damping * GROWTH } else { FIRST };
        }
    }

    /// The run with other parameters; `None` if there is none: the case refuses them, or a step fails.
    fn tried(&self, values: &[f64]) -> Result<Option<Evaluated>, IdentificationError> {
        match self.model.at(values) {
            Ok(evaluated) => Ok(Some(evaluated)),
            Err(IdentificationError::Run(
                GradientError::Refused(_) | GradientError::Kink { .. } | GradientError::Step(_),
            )) => Ok(None),
            Err(error) => Err(error),
        }
    }

    fn changed(&self, change: &Change) -> Vec<f64> {
        let scales = self.model.scales(&self.state.values);
        let values = self.state.values.iter().zip(&change.delta).zip(scales).zip(self.request.bounds);
        values.map(|(((value, delta), scale), [low, high])| (value + scale * delta).clamp(*low, *high)).collect()
    }

    /// True if the run meets the data to round-off.
    fn is_met(&self, sum: f64) -> bool {
        let deviations = self.model.deviations(&self.state.deviations);
        let values = self.request.measured.all().zip(deviations);
        let data: f64 = values.map(|((_, point), deviation)| (point.value / deviation).powi(2)).sum();
        sum <= ROUNDED * ROUNDED * data
    }

    /// Takes the deviations of series from their residuals, as the likelihood of all values has it; false if they are
    /// stated, or do not change any more.
    ///
    /// A series of n_c of n values has n_c (1 − p/n) degrees of freedom.
    fn estimate(&mut self) -> bool {
        if self.state.deviations.is_empty()
            || self.state.estimates >= ESTIMATES
            || self.request.measured.series.len() < 2
        {
            return false;
        }
        let (count, parameters) = (self.request.measured.count() as f64, self.state.values.len() as f64);
        let part = (1.0 - parameters / count).max(1.0 / count);
        let mut sums = vec![[0.0; 3]; self.state.deviations.len()];
        for ((series, point), value) in self.request.measured.all().zip(&self.evaluated.values) {
            let rest = point.value - value;
            sums[series] =
                [sums[series][0] + rest * rest, sums[series][1] + point.value * point.value, sums[series][2] + 1.0];
        }
        let estimated: Vec<f64> = sums
            .iter()
            .map(|[rests, squares, count]| (rests / (part * count)).max(ROUNDED * ROUNDED * squares / count).sqrt())
            .collect();
        let is_settled = |(new, old): (&f64, &f64)| (new - old).abs() <= SETTLED * old;
        if estimated.iter().zip(&self.state.deviations).all(is_settled) || estimated.iter().any(|of| *of <= 0.0) {
            return false;
        }
        self.state.deviations = estimated;
        self.state.estimates += 1;
        true
    }
}

/// The deviations to begin with, if the data do not state theirs: how far the values of each series are from their
/// mean.
fn first_deviations(request: &IdentificationRequest) -> Vec<f64> {
    if request.measured.states_deviations() {
        return Vec::new();
    }
    let of = |points: &[super::Measurement]| {
        let count = points.len().max(1) as f64;
        let mean = points.iter().map(|point| point.value).sum::<f64>() / count;
        let spread = (points.iter().map(|point| (point.value - mean).powi(2)).sum::<f64>() / count).sqrt();
        match (spread > 0.0, mean.abs()) {
            (true, _) => spread,
            (false, size) if size > 0.0 => size,
            _ => 1.0,
        }
    };
    request.measured.series.iter().map(|series| of(&series.points)).collect()
}
