//! The figures of a run held against those that its files give.

use std::path::Path;

use super::{Verdict, VerifyError, verdict};
use crate::case::Comparison;
use crate::contact::Status;
use crate::output::columns;
use crate::plot::{ContactRow, Run};

/// Recomputes the figures of a run from the files of its results folder and holds its summary against them.
///
/// # Errors
/// When files are missing or damaged.
pub fn recompute(folder: &Path) -> Result<Vec<Verdict>, VerifyError> {
    let path = folder.join("summary.json");
    let text = std::fs::read_to_string(&path)
        .map_err(|error| VerifyError::Check(format!("cannot read {}: {error}", path.display())))?;
    let summary: serde_json::Value =
        serde_json::from_str(&text).map_err(|error| VerifyError::Check(format!("{}: {error}", path.display())))?;
    let run = Run::read(folder)?;
    let name = summary["case"].as_str().unwrap_or("run").to_owned();
    let mut figures = of_fields(&run);
    let of_history = [
        ("/energy/kinetic", columns::KINETIC.name.to_owned()),
        ("/energy/elastic", columns::ELASTIC.name.to_owned()),
        ("/energy/load_work", columns::LOAD_WORK.name.to_owned()),
        ("/energy/viscous_dissipation", columns::VISCOUS_DISSIPATION.name.to_owned()),
        ("/energy/friction_dissipation", columns::FRICTION_DISSIPATION.name.to_owned()),
        ("/final/contact/force/0", columns::CONTACT_FORCE.component(0)),
        ("/final/contact/force/1", columns::CONTACT_FORCE.component(1)),
    ];
    figures
        .extend(of_history.into_iter().filter_map(|(place, column)| Some((place, *run.history.get(&column)?.last()?))));
    // The audit of the last row: what is stored and dissipated is the work done, up to the closing error.
    let at = |column: &str| run.history.get(column).and_then(|values| values.last()).copied().unwrap_or(0.0);
    let mut verdicts: Vec<Verdict> = figures
        .into_iter()
        .filter_map(|(place, computed)| {
            let reference = summary.pointer(place)?.as_f64()?;
            let is = Comparison { reference, tolerance: 1e-12, scale: reference.abs() };
            Some(verdict(&name, place.trim_start_matches('/').replace('/', "."), computed, &is))
        })
        .collect();
    let turned = summary.pointer("/energy/turned_over").and_then(serde_json::Value::as_f64).unwrap_or(1.0);
    let closing = summary.pointer("/energy/closing_error").and_then(serde_json::Value::as_f64).unwrap_or(f64::NAN);
    let is = Comparison { reference: closing, tolerance: 1e-12, scale: 1.0 };
    let error = at(columns::CLOSING_ERROR.name);
    // A run without mechanics turns nothing over.
    verdicts.push(verdict(
        &name,
        "energy.closing_error".to_owned(),
        if turned > 0.0 { error / turned } else { error },
        &is,
    ));
    Ok(verdicts)
}

/// Figures of the last fields and of the last contact points, by their places in the summary.
fn of_fields(run: &Run) -> Vec<(&'static str, f64)> {
    let mut figures: Vec<(&'static str, f64)> = Vec::new();
    let range = |values: &mut dyn Iterator<Item = f64>| {
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
    };
    if let Some(fields) = &run.snapshot {
        let [x, y] = [0, 1].map(|c| range(&mut fields.displacement.iter().map(|u| u[c])));
        let theta = range(&mut fields.temperature.iter().copied());
        let stress = range(&mut fields.von_mises.iter().copied());
        figures.extend([
            ("/final/displacement_min/0", x[0]),
            ("/final/displacement_max/0", x[1]),
            ("/final/displacement_min/1", y[0]),
            ("/final/displacement_max/1", y[1]),
            ("/final/temperature_min", theta[0]),
            ("/final/temperature_max", theta[1]),
            ("/final/von_mises_max", stress[1]),
        ]);
    }
    if !run.contact.is_empty() {
        let count = |status: Status| run.contact.iter().filter(|row| row.status == status).count() as f64;
        let largest = |value: fn(&ContactRow) -> f64| run.contact.iter().map(value).fold(0.0, f64::max);
        figures.extend([
            ("/final/contact/pressure_max", largest(|row| row.pressure)),
            ("/final/contact/penetration_max", largest(|row| row.penetration)),
            ("/final/contact/open", count(Status::Open)),
            ("/final/contact/stick", count(Status::Stick)),
            ("/final/contact/slip", count(Status::Slip)),
        ]);
    }
    figures
}
