//! The outputs of a run at the times of the data, with their derivatives.

use std::sync::atomic::Ordering;

use super::error::IdentificationError;
use super::least_squares::LinearModel;
use super::{IdentificationRequest, MeasuredTable};
use crate::adjoint::chosen::{made_steps, with_steps};
use crate::adjoint::{GradientError, Parameter, SeriesRequest, SeriesTable, series};
use crate::problem::{Fault, Problem};
use crate::time::MadeSteps;

/// The problems over values of several numbers of a case.
pub struct ParameterFamily<'a> {
    /// The names of the numbers, such as keys of the case.
    pub names: Vec<String>,
    /// Their values in the case.
    pub values: Vec<f64>,
    /// The units that the case writes behind them; empty for none.
    pub units: Vec<String>,
    /// The problem at other values.
    pub problem: Box<dyn Fn(&[f64]) -> Result<Problem, Fault> + 'a>,
}

/// Columns of `history.csv` with the names that outputs have.
const HISTORY: [(&str, &str); 5] = [
    ("contact_force_x", "final.contact.force.0"),
    ("contact_force_y", "final.contact.force.1"),
    ("contact_force_z", "final.contact.force.2"),
    ("friction_dissipation", "energy.friction_dissipation"),
    ("wear_volume", "final.contact.wear_volume"),
];

/// Times before 0 and after the end by which round-off may move them, relative to the end.
const ROUNDED: f64 = 1e-9;

/// f and J at parameters.
pub(super) struct Evaluated {
    /// f_i, in the order of the data.
    pub values: Vec<f64>,
    /// ∂f_i/∂m_j by parameter.
    slopes: Vec<Vec<f64>>,
    /// The margin of the run.
    pub margin: Option<f64>,
}

/// The outputs of runs over the parameters.
pub(super) struct OutputModel<'a> {
    request: &'a IdentificationRequest<'a>,
    outputs: Vec<String>,
    /// The steps that the run from the start chooses, in which all runs are made.
    made: Option<MadeSteps>,
}

impl<'a> OutputModel<'a> {
    /// The model of a request, whose data and bounds are checked.
    pub fn new(request: &'a IdentificationRequest<'a>) -> Result<OutputModel<'a>, IdentificationError> {
        let IdentificationRequest { family, bounds, measured, .. } = request;
        let told = |fault: Fault| Err(IdentificationError::data(fault));
        if let Some(name) =
            family.names.iter().enumerate().find_map(|(i, name)| family.names[..i].contains(name).then_some(name))
        {
            return told(Fault::new(name.clone(), "a parameter that is named twice", "each parameter once"));
        }
        let count = family.names.len();
        if family.values.len() != count || bounds.len() != count {
            let found = format!("{count} names, {} values and {} bounds", family.values.len(), bounds.len());
            return told(Fault::new("the parameters", found, "as many of each"));
        }
        let is_finite = |point: &super::Measurement| {
            let is_spread = |deviation: f64| deviation.is_finite() && deviation > 0.0;
            point.t.is_finite() && point.value.is_finite() && point.deviation.is_none_or(is_spread)
        };
        if measured.count() == 0 || !measured.all().all(|(_, point)| is_finite(point)) {
            let expected = "finite values at finite times, with positive deviations";
            return told(Fault::new(measured.name.clone(), "values that are none, or no values", expected));
        }
        for ((name, value), [low, high]) in family.names.iter().zip(&family.values).zip(*bounds) {
            if low >= high {
                let expected = "a lower bound and a larger upper one";
                return told(Fault::new(name.clone(), format!("bounds from {low:?} to {high:?}"), expected));
            }
            if !(low..=high).contains(&value) {
                let fault = Fault::new(name.clone(), format!("{value:?} in the case"), "a value within its bounds");
                return told(fault.hint(format!("start from another value with --set {name}=VALUE")));
            }
        }
        if measured.count() < family.names.len() {
            let found = format!("{} values for {} parameters", measured.count(), family.names.len());
            let fault = Fault::new(measured.name.clone(), found, "at least as many values as parameters");
            return told(fault.hint("measure more, or free fewer parameters"));
        }
        let output = |name: &String| {
            let known = HISTORY.iter().find(|(title, _)| title == name);
            known.map_or_else(|| name.clone(), |(_, name)| (*name).to_owned())
        };
        let start = (family.problem)(&family.values);
        let go_on = || !request.interrupt.is_some_and(|interrupt| interrupt.load(Ordering::Relaxed));
        let made = start.map_err(GradientError::refused).and_then(|start| made_steps(&start, &go_on));
        let outputs = measured.series.iter().map(|of| output(&of.name)).collect();
        Ok(OutputModel { request, outputs, made: made.map_err(of_run)? })
    }

    /// What relative changes of the parameters are relative to: their values, or what the bounds leave for a zero.
    pub fn scales(&self, values: &[f64]) -> Vec<f64> {
        let of = |(value, [low, high]): (&f64, &[f64; 2])| {
            let room = high - low;
            match value.abs() {
                size if size > 0.0 => size,
                _ if room.is_finite() => room,
                _ => 1.0,
            }
        };
        values.iter().zip(self.request.bounds).map(of).collect()
    }

    /// σ_i: those of the data, or those of their series.
    pub fn deviations(&self, of_series: &[f64]) -> Vec<f64> {
        let of = |(series, point): (usize, &super::Measurement)| {
            point.deviation.or_else(|| of_series.get(series).copied()).unwrap_or(1.0)
        };
        self.request.measured.all().map(of).collect()
    }

    /// Runs with the parameters.
    pub fn at(&self, values: &[f64]) -> Result<Evaluated, IdentificationError> {
        let family = self.request.family;
        let at = |values: &[f64]| {
            let problem = (family.problem)(values)?;
            Ok::<Problem, Fault>(match &self.made {
                Some(made) => with_steps(&problem, made),
                None => problem,
            })
        };
        let problem = at(values).map_err(|fault| IdentificationError::Run(GradientError::refused(fault)))?;
        let one = |j: usize| {
            let others = values.to_vec();
            let of = move |value: f64| {
                let mut values = others.clone();
                values[j] = value;
                at(&values)
            };
            Parameter { name: family.names[j].clone(), value: values[j], problem: Box::new(of) }
        };
        let parameters: Vec<Parameter> = (0..values.len()).map(one).collect();
        let made = series(&SeriesRequest {
            problem: &problem,
            probes: self.request.probes,
            outputs: &self.outputs,
            parameters: &parameters,
            interrupt: self.request.interrupt,
        });
        at_times(&made.map_err(of_run)?, self.request.measured, values.len())
    }

    /// r and J in relative changes of the parameters.
    pub fn linear(&self, evaluated: &Evaluated, values: &[f64], of_series: &[f64]) -> LinearModel {
        let deviations = self.deviations(of_series);
        let points = self.request.measured.all().zip(&evaluated.values).zip(&deviations);
        let over = |(slope, deviation): (&f64, &f64), scale: f64| slope * scale / deviation;
        LinearModel {
            residuals: points.map(|(((_, point), value), deviation)| (point.value - value) / deviation).collect(),
            columns: (evaluated.slopes.iter().zip(self.scales(values)))
                .map(|(slopes, scale)| slopes.iter().zip(&deviations).map(|pair| over(pair, scale)).collect())
                .collect(),
        }
    }
}

fn of_run(error: GradientError) -> IdentificationError {
    match error {
        GradientError::Interrupted => IdentificationError::Interrupted,
        error => IdentificationError::Run(error),
    }
}

/// The outputs at the times of the data, linear in time between steps.
fn at_times(
    table: &SeriesTable,
    measured: &MeasuredTable,
    parameters: usize,
) -> Result<Evaluated, IdentificationError> {
    let end = table.times.last().copied().unwrap_or(0.0);
    let count = measured.count();
    let mut found = Evaluated {
        values: Vec::with_capacity(count),
        slopes: vec![Vec::with_capacity(count); parameters],
        margin: table.margin,
    };
    for (series, point) in measured.all() {
        let name = &measured.series[series].name;
        let [low, high] = [0.0 - ROUNDED * end, end * (1.0 + ROUNDED)];
        if !(low..=high).contains(&point.t) {
            let fault =
                Fault::new(measured.name.clone(), format!("the time {:?} of {name}", point.t), "times of the run");
            return Err(IdentificationError::data(fault.hint(format!("the run is from 0 to {end:?} s"))));
        }
        let t = point.t.clamp(0.0, end);
        let n = table.times.partition_point(|time| *time < t).min(table.times.len().saturating_sub(1));
        let before = n.saturating_sub(1);
        let part = match table.times[n] - table.times[before] {
            span if span > 0.0 => (t - table.times[before]) / span,
            _ => 1.0,
        };
        let between = |of: &dyn Fn(usize) -> f64| {
            // At a step the value is that of the step alone.
            if part >= 1.0 { of(n) } else { of(before) + part * (of(n) - of(before)) }
        };
        let value = between(&|step| table.values[step][series]);
        if !value.is_finite() {
            let first = table.times.get(1).copied().unwrap_or(end);
            let fault = Fault::new(
                measured.name.clone(),
                format!("the time {:?} of {name}", point.t),
                "a time at which it has a value",
            );
            return Err(IdentificationError::data(
                fault.hint(format!("values of contact begin at the end of the first step, {first:?} s")),
            ));
        }
        found.values.push(value);
        for (j, slopes) in found.slopes.iter_mut().enumerate() {
            slopes.push(between(&|step| table.derivatives[step][series][j]));
        }
    }
    Ok(found)
}
