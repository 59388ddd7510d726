//! The numbers whose accuracy is asked for.

use super::AccuracyError;
use super::bars::BarRow;
use crate::case::Case;
use crate::convergence::FinalValue;

/// A number at the end of the run.
#[derive(Clone, Debug)]
pub(super) struct Goal {
    /// Its name, that of a column of `history.csv` or `probes.csv`.
    pub name: String,
    /// The probe to which it belongs, with whose other components it shares a scale.
    probe: Option<String>,
}

impl Goal {
    /// The goals that are asked for by names of probes or of columns, among the numbers of a run.
    pub fn named(asked: &[String], case: &Case, values: &[FinalValue]) -> Result<Vec<Goal>, AccuracyError> {
        let probes: Vec<&str> = case.probes.iter().map(|probe| probe.name.as_str()).collect();
        let probe = |value: &FinalValue| probes.contains(&value.group.as_str()).then(|| value.group.clone());
        let mut goals = Vec::new();
        for name in asked {
            let is_meant =
                |value: &&FinalValue| value.name == *name || probe(value).is_some_and(|probe| probe == *name);
            let found = values.iter().filter(is_meant);
            let before = goals.len();
            goals.extend(found.map(|value| Goal { name: value.name.clone(), probe: probe(value) }));
            if goals.len() == before {
                let mut known = probes.clone();
                known.extend(values.iter().filter(|value| probe(value).is_none()).map(|value| value.name.as_str()));
                let hint = "add a [[probe]] to the case for others";
                let found = format!("--of: {name}: found no such number, expected one of {}; {hint}", known.join(", "));
                return Err(AccuracyError::Refused(found));
            }
        }
        Ok(goals)
    }

    /// The row of the number.
    pub fn row<'a>(&self, rows: &'a [BarRow]) -> Option<&'a BarRow> {
        rows.iter().rev().find(|row| row.name == self.name)
    }

    /// The size to which its accuracy is relative: that of the number, or of the largest component of its probe.
    pub fn scale(&self, values: &[FinalValue]) -> f64 {
        let shares = |value: &&FinalValue| value.name == self.name || self.probe.as_ref() == Some(&value.group);
        values.iter().filter(shares).map(|value| value.value.abs()).fold(0.0, f64::max)
    }

    /// The name of the number as an output that has derivatives, if it is one.
    pub fn output(&self) -> String {
        let along = |axis: &str| ["x", "y", "z"].iter().position(|known| *known == axis);
        match self.name.as_str() {
            "friction_dissipation" => "energy.friction_dissipation".to_owned(),
            "wear_volume" => "final.contact.wear_volume".to_owned(),
            name => match name.strip_prefix("contact_force_").and_then(along) {
                Some(component) => format!("final.contact.force.{component}"),
                None => name.to_owned(),
            },
        }
    }
}
