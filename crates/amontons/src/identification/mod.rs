//! Identification: the parameters of a case with which a run comes nearest to what was measured.
//!
//! With measured values y_i at times t_i, of standard deviations σ_i, and f_i(m) the same outputs of a run with the
//! parameters m,
//!
//! ```text
//!     χ²(m) = Σ ((y_i − f_i(m)) / σ_i)²   is made smallest within bounds,
//! ```
//!
//! by Gauss–Newton with the derivatives ∂f/∂m of [`crate::adjoint::series`]. Between steps outputs are linear in time.
//! At the minimum the same derivatives tell how far the data determine m: cov m = (JᵀJ)⁻¹ with J = (∂f/∂m)/σ.
//!
//! | module | holds |
//! |---|---|
//! | `measured` | y_i with t_i and σ_i |
//! | `model` | f and J at parameters |
//! | `least_squares`, `singular` | the step of Gauss–Newton within bounds |
//! | `descent` | the steps, and the σ_i where the data do not state them |
//! | `statistics` | intervals, correlations, combinations that data determine |

mod descent;
mod error;
mod least_squares;
mod measured;
mod model;
mod singular;
mod statistics;

use std::sync::atomic::AtomicBool;

pub use descent::DescentState;
pub use error::IdentificationError;
pub use measured::{MeasuredSeries, MeasuredTable, Measurement};
pub use model::ParameterFamily;
use serde::Serialize;
pub use statistics::DataCombination;
use statistics::{DataStatistics, statistics};

use crate::output::Probe;
use descent::{Descent, DescentEnd};
use model::OutputModel;

/// What is asked for.
pub struct IdentificationRequest<'a> {
    /// The problems over values of the parameters, with the values to start from.
    pub family: &'a ParameterFamily<'a>,
    /// Lower and upper bound of each parameter; infinite where there is none.
    pub bounds: &'a [[f64; 2]],
    /// The probes that the measured series may name.
    pub probes: &'a [Probe],
    /// What was measured.
    pub measured: &'a MeasuredTable,
    /// Where an earlier, unfinished descent stands; it goes on with the same bits.
    pub from: Option<DescentState>,
    /// Ends the computation when it becomes true.
    pub interrupt: Option<&'a AtomicBool>,
}

/// Parameters that were identified, with what the data say about them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Identified {
    /// The parameters.
    pub parameters: Vec<IdentifiedParameter>,
    /// Coefficients of correlation of their errors; `None` where the data do not determine one, and of parameters at
    /// their bounds.
    pub correlations: Vec<Vec<Option<f64>>>,
    /// Combinations of parameters with independent errors, the best determined one first.
    pub combinations: Vec<DataCombination>,
    /// The measured outputs.
    pub series: Vec<FittedSeries>,
    /// All values.
    pub points: Vec<FittedPoint>,
    /// χ² at the minimum.
    pub chi_square: f64,
    /// Number of values less that of parameters that no bound holds.
    pub freedom: usize,
    /// Why the descent ended.
    pub ending: DescentEnding,
    /// Steps of Gauss–Newton, and runs with their derivatives.
    pub steps: usize,
    /// Runs.
    pub runs: usize,
    /// The least margin of the last run: how far contact points are from a change of state.
    pub margin: Option<f64>,
}

/// Why a descent ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DescentEnding {
    /// The next step would change the parameters by less than 1e-5 of their standard deviations, or by round-off.
    Minimum,
    /// No shorter step descends, though the derivatives say so: a contact point changes its state here, or the data are
    /// met to round-off.
    Kink,
}

/// A parameter that was identified.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct IdentifiedParameter {
    /// The key.
    pub name: String,
    /// The unit of the values, as the case writes it behind the number; empty for none.
    pub unit: String,
    /// Where the descent began.
    pub start: f64,
    /// The value at the minimum.
    pub value: f64,
    /// Its standard deviation; `None` if the data do not determine it, if a bound holds it, or if there are as many
    /// parameters as values, whose spread nothing tells.
    pub deviation: Option<f64>,
    /// The 95 % interval.
    pub interval: Option<[f64; 2]>,
    /// True if it is at a bound, and the data would have it beyond.
    pub is_at_bound: bool,
}

/// A measured output beside its run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FittedSeries {
    /// The title of the column.
    pub name: String,
    /// Number of values.
    pub count: usize,
    /// Root of the mean square of the residuals, in the unit of the output.
    pub rms: f64,
    /// Standard deviation that was taken for the values, if they do not state their own.
    pub deviation: Option<f64>,
    /// Correlation of each residual with the next one. Noise has none; of a model that misses something residuals keep
    /// their sign, and intervals are too narrow.
    pub autocorrelation: f64,
    /// True if this correlation is larger than that of noise in 999 of 1000 cases.
    pub is_systematic: bool,
    /// True if the values of the run have the other sign than those measured, for the most part.
    pub is_opposite: bool,
}

/// A measured value beside that of the run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FittedPoint {
    /// Number of its series.
    pub series: usize,
    /// Time, s.
    pub t: f64,
    /// The measured value.
    pub measured: f64,
    /// The value of the run.
    pub fitted: f64,
    /// The standard deviation that was taken for the measured value.
    pub deviation: f64,
}

/// Quantile 0.9995 of the normal distribution: correlations of noise are below it over √n in 999 of 1000 cases.
const SYSTEMATIC: f64 = 3.29;

/// Identifies parameters. `watch` is told each state of the descent, from which it can go on.
///
/// # Errors
/// If the measured outputs are not there, are fewer than the parameters, or lie outside the run; if a run at the start
/// fails or has no derivatives; or if `watch` fails.
pub fn identify(
    request: &IdentificationRequest,
    watch: &mut dyn FnMut(&DescentState) -> Result<(), IdentificationError>,
) -> Result<Identified, IdentificationError> {
    let model = OutputModel::new(request)?;
    let found = Descent::new(request, &model)?.made(watch)?;
    Ok(found.told(request, &model))
}

impl DescentEnd {
    /// The answer with its statistics.
    fn told(self, request: &IdentificationRequest, model: &OutputModel) -> Identified {
        let DescentEnd { state, evaluated, linear, held, ending } = self;
        let free: Vec<bool> = held.iter().map(|held| !held).collect();
        let count = free.iter().filter(|free| **free).count();
        let freedom = request.measured.count().saturating_sub(count);
        let is_known = request.measured.states_deviations();
        let chi_square = linear.sum();
        let variance = if is_known { Some(1.0) } else { (freedom > 0).then(|| chi_square / freedom as f64) };
        let DataStatistics { deviations, quantile, correlations, combinations } =
            statistics(&linear, &free, variance, (!is_known).then_some(freedom));
        let values = state.values.iter().zip(&request.family.values).zip(&request.family.names);
        let parameters = values.enumerate().map(|(j, ((value, start), name))| {
            let deviation = deviations[j].map(|deviation| deviation * model.scales(&state.values)[j]);
            IdentifiedParameter {
                name: name.clone(),
                unit: request.family.units.get(j).cloned().unwrap_or_default(),
                start: *start,
                value: *value,
                deviation,
                interval: deviation.map(|deviation| [value - quantile * deviation, value + quantile * deviation]),
                is_at_bound: held[j],
            }
        });
        let taken = model.deviations(&state.deviations);
        let points: Vec<FittedPoint> = request
            .measured
            .all()
            .zip(evaluated.values.iter().zip(&taken))
            .map(|((series, point), (fitted, deviation))| FittedPoint {
                series,
                t: point.t,
                measured: point.value,
                fitted: *fitted,
                deviation: *deviation,
            })
            .collect();
        let series = request.measured.series.iter().enumerate();
        let series = series.map(|(i, of)| fitted(&of.name, i, &points, state.deviations.get(i).copied()));
        Identified {
            parameters: parameters.collect(),
            correlations,
            combinations,
            series: series.collect(),
            chi_square,
            freedom,
            ending,
            steps: state.steps,
            runs: state.runs,
            margin: evaluated.margin,
            points,
        }
    }
}

/// The figures of a series.
fn fitted(name: &str, number: usize, points: &[FittedPoint], deviation: Option<f64>) -> FittedSeries {
    let mut own: Vec<&FittedPoint> = points.iter().filter(|point| point.series == number).collect();
    own.sort_by(|a, b| a.t.total_cmp(&b.t));
    let rests: Vec<f64> = own.iter().map(|point| point.measured - point.fitted).collect();
    let over: Vec<f64> = own.iter().zip(&rests).map(|(point, rest)| rest / point.deviation).collect();
    let squares: f64 = over.iter().map(|rest| rest * rest).sum();
    let products: f64 = over.windows(2).map(|pair| pair[0] * pair[1]).sum();
    let autocorrelation = if squares > 0.0 { products / squares } else { 0.0 };
    FittedSeries {
        name: name.to_owned(),
        count: own.len(),
        rms: (rests.iter().map(|rest| rest * rest).sum::<f64>() / own.len().max(1) as f64).sqrt(),
        deviation,
        autocorrelation,
        is_opposite: own.iter().map(|point| point.measured * point.fitted).sum::<f64>() < 0.0,
        is_systematic: autocorrelation > SYSTEMATIC / (own.len().max(1) as f64).sqrt(),
    }
}
