//! Numbers of a step that a study or a run for an accuracy compares: energies, resultants and extremes of
//! `history.csv`, and probes.

use super::columns::{history_measures, history_names, history_values};
use super::probe::ProbeSet;
use super::probe_place::Probe;
use super::{OutputError, Sink, Snapshot, Work};
use crate::convergence::{FinalValue, FinalValues};
use crate::problem::{Problem, ProblemData};
use crate::units::Measure;

/// The columns of `history.csv` at the end that measure a quantity of physics, and all probes.
#[must_use]
pub fn final_values(probes: Vec<Probe>) -> FinalValues {
    FinalValues::new(move |last| {
        ValueReader::new(last.problem, &probes).of(&Snapshot {
            problem: last.problem,
            discretization: last.discretization,
            state: last.state,
            report: Some(last.report),
            work: Work::default(),
            scheme: None,
        })
    })
}

/// Place, name and group of the columns of `history.csv` that measure a quantity of physics: no counts, no times, and
/// none of the errors by which the audit closes.
pub(crate) fn compared_columns(problem: &ProblemData) -> Vec<(usize, String, String)> {
    let measures = history_measures(problem);
    let group = |name: &str| {
        let (_, measure) = measures.iter().find(|(known, _)| known == name)?;
        let is_counted = matches!(measure, Measure::Number | Measure::Time);
        (!is_counted && !name.ends_with("closing_error")).then(|| format!("{measure:?}"))
    };
    let names = history_names(problem).into_iter().enumerate();
    names.filter_map(|(place, (name, _))| group(&name).map(|group| (place, name, group))).collect()
}

/// Reads the numbers of the steps of a problem.
struct ValueReader {
    /// Place, name and group of the columns of `history.csv` that are compared.
    history: Vec<(usize, String, String)>,
    /// The probes that have a place on the mesh.
    probes: Vec<(String, ProbeSet)>,
}

impl ValueReader {
    fn new(problem: &Problem, probes: &[Probe]) -> ValueReader {
        let set = |probe: &Probe| Some((probe.name.clone(), ProbeSet::new(problem, std::slice::from_ref(probe)).ok()?));
        ValueReader { history: compared_columns(problem), probes: probes.iter().filter_map(set).collect() }
    }

    /// The numbers of a step.
    fn of(&self, now: &Snapshot) -> Vec<FinalValue> {
        let columns = history_values(now).unwrap_or_default();
        let of_history = self.history.iter().filter_map(|(place, name, group)| {
            Some(FinalValue { name: name.clone(), group: group.clone(), value: *columns.get(*place)? })
        });
        let of_probe = |(probe, set): &(String, ProbeSet)| -> Vec<FinalValue> {
            let named = set.columns().iter().zip(set.values(now));
            named.map(|(name, value)| FinalValue { name: name.clone(), group: probe.clone(), value }).collect()
        };
        of_history.chain(self.probes.iter().flat_map(of_probe)).collect()
    }
}

/// The numbers of all steps of a run.
#[derive(Default)]
pub struct ValuesOfRun {
    probes: Vec<Probe>,
    reader: Option<ValueReader>,
    /// Time in s, and the numbers, which are the same ones in all steps.
    pub steps: Vec<(f64, Vec<FinalValue>)>,
}

impl ValuesOfRun {
    /// Takes the numbers of `history.csv`, and those of probes.
    #[must_use]
    pub fn new(probes: Vec<Probe>) -> ValuesOfRun {
        ValuesOfRun { probes, ..ValuesOfRun::default() }
    }
}

impl Sink for ValuesOfRun {
    fn step(&mut self, now: &Snapshot) -> Result<(), OutputError> {
        if now.report.is_some() {
            let reader = self.reader.get_or_insert_with(|| ValueReader::new(now.problem, &self.probes));
            self.steps.push((now.state.t, reader.of(now)));
        }
        Ok(())
    }
}
