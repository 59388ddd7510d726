//! `converge`: a study, or one for each of several values.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use amontons::case::{self, ReferenceRequest, Source, StudyRequest};
use amontons::convergence::{Level, StudySettings, Table, Vary};
use amontons::output::StudyFolder;
use amontons::plot;
use amontons::run::with_threads;
use amontons::scheme::State;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::arguments::{Common, Format, StudyArguments};
use crate::commands::interrupt_flag;
use crate::print;
use crate::status::Failure;

/// Makes the studies that the arguments ask for and prints their tables.
pub fn execute(file: &Path, arguments: &StudyArguments, common: &Common) -> Result<(), Failure> {
    let source = case::source(file)?;
    let name = case::parse(&source, &common.set)?.problem.name;
    let out = common.out.clone().unwrap_or_else(|| PathBuf::from("results").join(format!("{name}-convergence")));
    let flag = interrupt_flag();
    let mut tables = Vec::new();
    for (folder, values) in variants(&arguments.each)? {
        let mut overrides = common.set.clone();
        overrides.extend(values.clone());
        let out = if folder.is_empty() { out.clone() } else { out.join(&folder) };
        let table = study(&source, &overrides, &request(arguments), &out, common, &flag)?;
        if common.format == Format::Text && !common.quiet {
            let title = if values.is_empty() { name.clone() } else { format!("{name}, {}", values.join(", ")) };
            print::text(&text(&title, &table, &out))?;
        }
        tables.push(serde_json::json!({ "set": values, "folder": out, "study": table }));
    }
    if common.format == Format::Json {
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

/// Folder and overrides of each study: one for each combination of the values of `--each`.
fn variants(each: &[String]) -> Result<Vec<(String, Vec<String>)>, Failure> {
    let mut variants = vec![(String::new(), Vec::new())];
    for argument in each {
        let Some((key, values)) = argument.split_once('=').filter(|(key, values)| !key.is_empty() && !values.is_empty()) else {
            return Err(Failure::Usage(format!("--each {argument}: expected KEY=VALUE,VALUE,…")));
        };
        let short = key.rsplit('.').next().unwrap_or(key);
        variants = variants
            .iter()
            .flat_map(|(folder, set)| {
                values.split(',').map(move |value| {
                    let part = format!("{short}={value}");
                    let folder = if folder.is_empty() { part } else { format!("{folder},{part}") };
                    let set: Vec<String> = set.iter().cloned().chain([format!("{key}={value}")]).collect();
                    (folder, set)
                })
            })
            .collect();
    }
    Ok(variants)
}

/// Makes one study in a folder of its own, levels that are there from an interrupted one taken as they are.
pub fn study(source: &Source, overrides: &[String], request: &StudyRequest, out: &Path, common: &Common, interrupt: &AtomicBool) -> Result<Table, Failure> {
    let study = case::study(source, overrides, request)?;
    let folder = StudyFolder::create(out, common.force)?;
    let failed = std::sync::Mutex::new(None);
    let keep = |level: &Level, states: &[State]| {
        // The study itself does not depend on it: told at the end.
        if let (Err(error), Ok(mut failed)) = (folder.keep(level, states), failed.lock()) {
            *failed = Some(error);
        }
    };
    let load = |level: &Level| folder.load(level);
    let bar = (!common.quiet).then(|| bar(study.steps())).flatten();
    let made = AtomicUsize::new(0);
    let progress = |_level: usize, _step: usize, _steps: usize| {
        let made = made.fetch_add(1, Ordering::Relaxed) + 1;
        if let Some(bar) = &bar {
            bar.set_position(made as u64);
        }
    };
    let settings = StudySettings { interrupt: Some(interrupt), progress: Some(&progress), load: Some(&load), keep: Some(&keep) };
    let table = with_threads(common.threads.map(usize::from), || study.run(&settings)).map_err(|error| Failure::Run { error, hint: None })?;
    if let Some(bar) = &bar {
        bar.finish_and_clear();
    }
    let table = table.map_err(|error| Failure::Study { error, folder: out.to_owned() })?;
    if let Ok(Some(error)) = failed.into_inner() {
        return Err(error.into());
    }
    let case = case::parse(source, overrides)?;
    folder.finish(&table, &case.text, &case.inputs)?;
    let picture = plot::convergence(&plot::ConvergencePlot::read(&out.join("convergence.csv"), &plot::Options::default())?)?;
    picture.save(&out.join("convergence"), plot::Options::default().pixels)?;
    Ok(table)
}

fn bar(steps: usize) -> Option<ProgressBar> {
    use std::io::IsTerminal;
    std::io::stderr().is_terminal().then(|| {
        let bar = ProgressBar::with_draw_target(Some(steps as u64), ProgressDrawTarget::stderr());
        match ProgressStyle::with_template("steps of all levels {pos}/{len} [{bar:40}] {elapsed} gone, {eta} left") {
            Ok(style) => bar.with_style(style),
            Err(_) => bar,
        }
    })
}

/// The table for reading.
pub fn text(title: &str, table: &Table, out: &Path) -> String {
    let mut lines = vec![format!("{title}")];
    lines.push(format!("  {:>6} {:>11} {:>11} {:>12} {:>12} {:>12} {:>12} {:>7}", "level", "h", "k", "error_w", "error_u", "error_theta", "E", "order"));
    for row in &table.rows {
        let order = row.order.map_or_else(String::new, |o| format!("{o:.4}"));
        lines.push(format!(
            "  {:>6} {:>11.5e} {:>11.5e} {:>12.5e} {:>12.5e} {:>12.5e} {:>12.5e} {order:>7}",
            row.level, row.h, row.k, row.error_w, row.error_u, row.error_theta, row.error
        ));
    }
    let slopes = table.slopes.iter().filter(|(name, slope)| *name != "error_u_h" && slope.is_finite());
    lines.push(format!("  least-squares slopes: {}", slopes.map(|(name, slope)| format!("{name} {slope:.3}")).collect::<Vec<_>>().join(", ")));
    lines.push(format!("  results in {}\n", out.display()));
    lines.join("\n") + "\n"
}
