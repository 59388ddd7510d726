//! The meshes of a run for an accuracy: errors over the size of the cells.

use std::path::Path;

use super::convergence::{ConvergencePlot, ErrorSeries};
use super::folder::problem;
use super::table::CsvTable;
use super::{Picture, PlotError, convergence};
use crate::output::names::ACCURACY;

/// The table of the meshes in a results folder, with its picture; `None` if the folder has none, and no picture of a
/// single mesh or of errors that are zero.
pub(super) fn meshes(dir: &Path) -> Result<Option<(CsvTable, Option<Picture>)>, PlotError> {
    let path = dir.join(ACCURACY);
    if !path.exists() {
        return Ok(None);
    }
    let table = CsvTable::read(&path)?;
    let dim = problem(dir)?.mesh.dim;
    let (meshes, nodes): (Vec<usize>, Vec<f64>) = (table.column("mesh")?, table.numbers("nodes")?);
    let errors = table.numbers("relative")?;
    let names: Vec<String> = if table.names().iter().any(|name| name == "quantity") {
        table.column("quantity")?
    } else {
        vec!["in the norm of the energy".to_owned(); meshes.len()]
    };
    let mut series: Vec<ErrorSeries> = Vec::new();
    for (name, &error) in names.iter().zip(&errors) {
        match series.iter_mut().find(|series| series.label == *name) {
            Some(series) => series.errors.push(error),
            None => series.push(ErrorSeries { label: name.clone(), errors: vec![error] }),
        }
    }
    let mut sizes: Vec<(usize, f64)> =
        meshes.iter().zip(&nodes).map(|(&mesh, nodes)| (mesh, nodes.powf(-1.0 / dim as f64))).collect();
    sizes.dedup_by_key(|(mesh, _)| *mesh);
    let is_drawn = sizes.len() > 1 && series.iter().flat_map(|series| &series.errors).any(|&error| error > 0.0);
    let plot = ConvergencePlot {
        title: "Errors on the meshes".to_owned(),
        sizes: sizes.into_iter().map(|(_, size)| size).collect(),
        x_label: if dim == 1 { "1/nodes".to_owned() } else { format!("nodes^{{−1/{dim}}}") },
        y_label: "error over the size of the number".to_owned(),
        series,
        // Meshes that are refined in places halve nothing.
        has_orders: false,
    };
    let picture = if is_drawn { Some(convergence(&plot)?) } else { None };
    Ok(Some((table, picture)))
}
