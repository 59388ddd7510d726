//! `converge`: a study, or one for each of several values.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use amontons::case::{self, ReferenceRequest, Source, StudyRequest};
use amontons::convergence::{ReferenceProgress, Study, StudyLevel, StudySettings, StudyTable, ValueRow, Vary};
use amontons::output::{OutputError, StudyFolder};
use amontons::plot;
use amontons::state::State;

use crate::arguments::{Common, OutputFormat, StudyArguments};
use crate::print;
use crate::progress::Progress;
use crate::status::CommandFailure;
use crate::variants::variants;

/// Makes the requested studies and prints their tables.
pub fn execute(file: &Path, arguments: &StudyArguments, common: &Common) -> Result<(), CommandFailure> {
    let source = common.source(file)?;
    let name = case::parse(&source, &common.set)?.problem.name.clone();
    let out = common.out.clone().unwrap_or_else(|| PathBuf::from("results").join(format!("{name}-convergence")));
    let progress = Progress::new(common);
    let flag = progress.interrupt_flag();
    let mut tables = Vec::new();
    let variants = variants(&arguments.each)?;
    for (number, variant) in variants.iter().enumerate() {
        let (folder, values) = (&variant.folder, variant.overrides());
        let overrides: Vec<String> = common.set.iter().cloned().chain(values.clone()).collect();
        let out = if folder.is_empty() { out.clone() } else { out.join(folder) };
        let part = format!("study {} of {}", number + 1, variants.len());
        let running = Running { part: &part, progress: &progress, interrupt: &flag };
        let made = case::study(&source, &overrides, &request(arguments))?;
        let folder = StudyFolder::create(&out, common.force)?;
        let table = study(&made, &folder, &running)?;
        write(&source, &overrides, &table, &folder)?;
        if common.format == OutputFormat::Text && !common.quiet {
            let title = if values.is_empty() { name.clone() } else { format!("{name}, {}", values.join(", ")) };
            print::text(&text(&title, &table, &out))?;
        }
        tables.push(serde_json::json!({ "set": values, "folder": out, "study": table }));
    }
    if common.format == OutputFormat::Json {
        print::json(&serde_json::json!({ "studies": tables }))?;
    }
    Ok(())
}

fn request(arguments: &StudyArguments) -> StudyRequest {
    let reference = match (arguments.exact, arguments.reference) {
        (true, _) => ReferenceRequest::Exact,
        (false, Some(level)) => ReferenceRequest::Level(level),
        (false, None) => ReferenceRequest::Finest,
    };
    StudyRequest { vary: arguments.vary.into(), levels: arguments.levels.clone(), reference, power: 1 }
}

impl From<crate::arguments::VaryArgument> for Vary {
    fn from(vary: crate::arguments::VaryArgument) -> Vary {
        match vary {
            crate::arguments::VaryArgument::Both => Vary::Both,
            crate::arguments::VaryArgument::Space => Vary::Space,
            crate::arguments::VaryArgument::Time => Vary::Time,
        }
    }
}

/// Reporting and interruption of a study.
pub struct Running<'a> {
    /// Name in the progress: `study 3 of 6`.
    pub part: &'a str,
    pub progress: &'a Progress,
    pub interrupt: &'a AtomicBool,
}

/// Makes one study in its own folder. Finished levels of an interrupted one are reused, and the reference continues
/// where it stopped.
pub fn study(study: &Study, folder: &StudyFolder, running: &Running) -> Result<StudyTable, CommandFailure> {
    let failed = std::sync::Mutex::new(None);
    // The study does not depend on the stored levels: a failure is reported at the end.
    let note = |result: Result<(), OutputError>| {
        if let (Err(error), Ok(mut failed)) = (result, failed.lock()) {
            *failed = Some(error);
        }
    };
    let keep = |level: &StudyLevel, states: &[State]| note(folder.keep(level, states));
    let keep_reference = |progress: &ReferenceProgress| note(folder.keep_reference(study, progress));
    let (load, load_reference) = (|level: &StudyLevel| folder.load(level), || folder.load_reference(study));
    running.progress.part(running.part, study.steps());
    running.progress.begin_steps();
    let made = AtomicUsize::new(0);
    let progress =
        |_level: usize, _step: usize, _steps: usize| running.progress.done(made.fetch_add(1, Ordering::Relaxed) + 1);
    let settings = StudySettings {
        interrupt: Some(running.interrupt),
        progress: Some(&progress),
        load: Some(&load),
        keep: Some(&keep),
        load_reference: Some(&load_reference),
        keep_reference: Some(&keep_reference),
        ..StudySettings::default()
    };
    let table =
        study.run(&settings).map_err(|error| CommandFailure::Study { error, folder: folder.path().to_owned() })?;
    match failed.into_inner() {
        Ok(Some(error)) => Err(error.into()),
        _ => Ok(table),
    }
}

/// Writes the table of a study, and draws it.
pub fn write(
    source: &Source,
    overrides: &[String],
    table: &StudyTable,
    folder: &StudyFolder,
) -> Result<(), CommandFailure> {
    let case = case::parse(source, overrides)?;
    let out = folder.path();
    folder.finish(table, &case.text, &case.inputs)?;
    let picture =
        plot::convergence(&plot::ConvergencePlot::read(&out.join("convergence.csv"), &plot::Options::default())?)?;
    picture.save(&out.join("convergence"), plot::Options::default().pixels)?;
    Ok(())
}

/// The table as text.
pub fn text(title: &str, table: &StudyTable, out: &Path) -> String {
    let mut lines = vec![format!("{title}")];
    lines.push(format!(
        "  {:>6} {:>11} {:>11} {:>12} {:>12} {:>12} {:>12} {:>7}",
        "level", "h", "k", "error_w", "error_u", "error_theta", "E", "order"
    ));
    for row in &table.rows {
        let order = row.order.map_or_else(String::new, |o| format!("{o:.4}"));
        lines.push(format!(
            "  {:>6} {:>11.5e} {:>11.5e} {:>12.5e} {:>12.5e} {:>12.5e} {:>12.5e} {order:>7}",
            row.level, row.h, row.k, row.error_w, row.error_u, row.error_theta, row.error
        ));
    }
    let slopes = table.slopes.iter().filter(|(name, slope)| *name != "error_u_h" && slope.is_finite());
    lines.push(format!(
        "  least-squares slopes: {}",
        slopes.map(|(name, slope)| format!("{name} {slope:.3}")).collect::<Vec<_>>().join(", ")
    ));
    lines.extend(values(&table.values));
    lines.push(format!("  results in {}\n", out.display()));
    lines.join("\n") + "\n"
}

/// The numbers at the end: one line per number with its value on each level, order and limit, or why it has none.
fn values(rows: &[ValueRow]) -> Vec<String> {
    let Some(first) = rows.first() else { return Vec::new() };
    let width = rows.iter().map(|row| row.name.chars().count()).max().unwrap_or(0).max("at the end".len());
    let levels: String = first.levels.iter().map(|level| format!(" {:>14}", level.level)).collect();
    let mut lines = vec![format!("  {:<width$}{levels} {:>7} {:>16} {:>10}", "at the end", "order", "limit", "+-")];
    for row in rows {
        let values: String = row.levels.iter().map(|level| format!(" {:>14.7e}", level.value)).collect();
        let Some(last) = row.levels.last() else { continue };
        let order = last.order.map_or_else(|| "-".to_owned(), |order| format!("{order:.3}"));
        let limit = match (last.limit, last.error) {
            (Some(limit), Some(error)) => format!(" {order:>7} {limit:>16.9e} {error:>10.1e}"),
            _ => String::new(),
        };
        let remark = if last.remark.is_empty() { String::new() } else { format!("  {}", last.remark) };
        lines.push(format!("  {:<width$}{values}{limit}{remark}", row.name));
    }
    lines
}
