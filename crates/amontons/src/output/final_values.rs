//! Numbers at the end of a run that a study compares: energies, resultants and extremes of `history.csv`, and probes.

use super::columns::{history_measures, history_names, history_values};
use super::probe::ProbeSet;
use super::probe_place::Probe;
use super::{Snapshot, Work};
use crate::convergence::{FinalValue, FinalValues, LastStep};
use crate::units::Measure;

/// The columns of `history.csv` at the end that measure a quantity of physics, and all probes. Counts, times and the
/// errors by which the audit closes are left out.
#[must_use]
pub fn final_values(probes: Vec<Probe>) -> FinalValues {
    FinalValues::new(move |last| {
        let mut values = of_history(last);
        values.extend(of_probes(last, &probes));
        values
    })
}

fn snapshot<'a>(last: &LastStep<'a>) -> Snapshot<'a> {
    Snapshot {
        problem: last.problem,
        discretization: last.discretization,
        state: last.state,
        report: Some(last.report),
        work: Work::default(),
        scheme: None,
    }
}

fn of_history(last: &LastStep) -> Vec<FinalValue> {
    let values = history_values(&snapshot(last)).unwrap_or_default();
    let compared = |(name, measure): &(String, Measure)| {
        !matches!(measure, Measure::Number | Measure::Time) && !name.ends_with("closing_error")
    };
    let measures = history_measures(last.problem);
    let of_name = |name: &str| measures.iter().find(|measure| measure.0 == name).filter(|measure| compared(measure));
    let named = history_names(last.problem).into_iter().zip(values);
    let value = |((name, _), value): ((String, _), f64)| {
        let group = format!("{:?}", of_name(&name)?.1);
        Some(FinalValue { name, group, value })
    };
    named.filter_map(value).collect()
}

/// The probes; none if a probe has no place on the mesh of the level.
fn of_probes(last: &LastStep, probes: &[Probe]) -> Vec<FinalValue> {
    let mut all = Vec::new();
    for probe in probes {
        let Ok(set) = ProbeSet::new(last.problem, std::slice::from_ref(probe)) else { continue };
        let values = set.columns().iter().zip(set.values(&snapshot(last)));
        all.extend(values.map(|(name, value)| FinalValue { name: name.clone(), group: probe.name.clone(), value }));
    }
    all
}
