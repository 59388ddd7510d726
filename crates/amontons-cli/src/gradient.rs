//! `gradient`: derivatives of numbers at the end of a run by keys of its case.

use std::path::{Path, PathBuf};

use amontons::adjoint::{GradientRequest, GradientTable, Parameter, gradient};
use amontons::case;
use amontons::output::GradientFolder;

use crate::arguments::{Common, OutputFormat};
use crate::print;
use crate::progress::Progress;
use crate::status::CommandFailure;

/// Computes the derivatives, prints them, and writes them into a folder.
pub fn execute(file: &Path, of: &[String], with: &[String], common: &Common) -> Result<(), CommandFailure> {
    let source = common.source(file)?;
    let case = case::parse(&source, &common.set)?;
    let name = format!("{}-gradient", case.problem.name);
    let out = common.out.clone().unwrap_or_else(|| PathBuf::from("results").join(name));
    let parameter = |key: &String| {
        case::parameter(&source, &common.set, key).map_err(|fault| CommandFailure::Request(fault.to_string()))
    };
    let parameters = with.iter().map(parameter).collect::<Result<Vec<Parameter>, CommandFailure>>()?;
    let folder = common.team.first(|| GradientFolder::create(&out, common.force))?;
    let progress = Progress::new(common);
    let flag = common.team.interrupt(&progress.interrupt_flag());
    let request = GradientRequest {
        problem: &case.problem,
        probes: &case.probes,
        outputs: of,
        parameters: &parameters,
        memory: None,
        interrupt: Some(&flag),
    };
    let made = gradient(&request);
    drop(progress);
    let table = made?;
    common
        .team
        .first(|| folder.map_or(Ok(()), |folder| folder.finish((&table.csv(), &table), &case.text, &case.inputs)))?;
    match common.format {
        OutputFormat::Json => print::json(&serde_json::json!(table))?,
        OutputFormat::Text if common.quiet => {}
        OutputFormat::Text => print::text(&text(&case.problem.name, &table, &out))?,
    }
    Ok(())
}

/// The table as text.
fn text(title: &str, table: &GradientTable, out: &Path) -> String {
    let longest = |names: &[(String, f64)]| names.iter().map(|(name, _)| name.len()).max().unwrap_or(0).max(9);
    let (first, second) = (longest(&table.outputs), longest(&table.parameters));
    let beyond = if table.beyond.is_some() { format!(" {:>16}", "other side") } else { String::new() };
    let mut lines = vec![
        format!("{title}"),
        format!(
            "  {:<first$} {:>16}  {:<second$} {:>16} {:>16}{beyond}",
            "output", "value", "parameter", "at", "derivative"
        ),
    ];
    for (i, (output, value)) in table.outputs.iter().enumerate() {
        for (j, (parameter, at)) in table.parameters.iter().enumerate() {
            let slope = |of: &[Vec<f64>]| of.get(i).and_then(|row| row.get(j)).copied().unwrap_or(f64::NAN);
            let here = slope(&table.derivatives);
            let beyond = table.beyond.as_deref().map(|of| format!(" {:>16.9e}", slope(of))).unwrap_or_default();
            lines.push(format!(
                "  {output:<first$} {value:>16.9e}  {parameter:<second$} {at:>16.9e} {here:>16.9e}{beyond}"
            ));
        }
    }
    lines.push(margin(table));
    lines.push(format!("  results in {}\n", out.display()));
    lines.join("\n")
}

/// How far the contact is from a change of state.
fn margin(table: &GradientTable) -> String {
    let Some((margin, (step, [x, y, z]))) = table.margin.zip(table.nearest) else {
        return "  no contact point could change its state".to_owned();
    };
    let place = format!("at ({x}, {y}, {z}) in step {step}");
    match table.ties {
        0 => format!("  margin {margin:.3e}, {place}: no contact point is on a change of state"),
        1 => {
            let other = "the derivatives are one-sided, those of the other side stand beside them";
            format!("  margin 0: the point {place} is on a change of state; {other}")
        }
        ties => {
            let found = "the derivatives are one-sided, with the states that were found";
            format!("  margin 0: {ties} contact points and steps are on a change of state, one {place}; {found}")
        }
    }
}
