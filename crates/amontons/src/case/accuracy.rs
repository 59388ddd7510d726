//! The accuracy that a case asks for.

use super::build::Build;
use super::nearest::meant;
use super::place::At;
use super::raw;
use super::request::AskedAccuracy;
use crate::output::{Probe, compared_columns};
use crate::problem::ProblemData;

impl Build<'_> {
    /// The accuracy that a case asks for.
    pub(super) fn asked_accuracy(
        &mut self,
        raw: Option<raw::Accuracy>,
        probes: &[Probe],
        data: &ProblemData,
    ) -> Option<AskedAccuracy> {
        let raw::Accuracy { of, relative, refined } = raw?;
        if !(relative > 0.0 && relative < 1.0) {
            let expected = "a part of the number between 0 and 1, such as 0.01";
            self.note("accuracy.relative", At::Value, format!("{relative:?}"), expected, None);
        }
        let names: Vec<String> = probes.iter().map(|probe| probe.name.clone()).collect();
        let columns = probes.iter().flat_map(|probe| {
            let endings = probe.quantity.columns(data.mesh.dim).into_iter();
            endings.map(|ending| format!("{}{ending}", probe.name)).collect::<Vec<_>>()
        });
        let of_history = compared_columns(data).into_iter().map(|(_, name, _)| name);
        let known: Vec<String> = names.iter().cloned().chain(columns).chain(of_history).collect();
        let known: Vec<&str> = known.iter().map(String::as_str).collect();
        let probes = if names.is_empty() { String::new() } else { format!(" ({})", names.join(", ")) };
        let expected = format!("the name of a probe{probes}, or of a column of history.csv with a unit");
        if of.is_empty() {
            self.note("accuracy.of", At::Value, "no name", expected.clone(), None);
        }
        for (i, name) in of.iter().enumerate().filter(|(_, name)| !known.contains(&name.as_str())) {
            let hint = meant(name, &known).unwrap_or_else(|| "add a [[probe]] to the case".to_owned());
            self.note(&format!("accuracy.of[{i}]"), At::Value, format!("\"{name}\""), expected.clone(), Some(&hint));
        }
        Some(AskedAccuracy { of, relative, refined })
    }
}
