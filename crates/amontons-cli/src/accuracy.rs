//! `run --accuracy`: runs on meshes that are finer where it matters, until the error is small enough.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use amontons::accuracy::{
    AccuracyEnding, AccuracyError, AccuracyNews, AccuracyRequest, AccurateCase, BarRow, EnergyLevel, ValueLevel,
    bars_csv, of_energy, of_values,
};
use amontons::case::{self, Case, Source};
use amontons::output::{ACCURACY, BARS, Folder, per_cent};
use amontons::run::Settings;

use crate::after::After;
use crate::arguments::{CertificateChoice, Common, OutputFormat};
use crate::print;
use crate::progress::Progress;
use crate::single;
use crate::status::CommandFailure;

/// The runs as the program shows them: the last case, its tables, and what is missing of what was asked.
struct Refined {
    case: Case,
    tables: Vec<(&'static str, String)>,
    ending: AccuracyEnding,
    /// The error of the last level, relative, as a number and in words.
    relative: f64,
    error: String,
}

/// Runs a case from its start into its folder, with cells and steps that are refined if an accuracy is asked for.
pub fn start(
    file: &Path,
    (relative, of): (Option<f64>, &[String]),
    after: After,
    (choice, again): (CertificateChoice, bool),
    common: &Common,
) -> Result<(), CommandFailure> {
    let progress = Progress::new(common);
    let source = common.source(file)?;
    let case = case::parse(&source, &common.set)?;
    let out = single::folder(&case, again, common);
    let interrupt = progress.interrupt_flag();
    match Asked::new(relative, of, &case) {
        Some(asked) => refine(&source, &asked, &out, (after, choice), (progress, interrupt), common),
        None => single::run_into((&case, Vec::new()), &out, (after, choice), (progress, interrupt), common),
    }
}

/// What is asked for: an error relative to the solution, and the numbers that are to be as accurate. Without numbers it
/// is the error in the norm of the energy.
struct Asked {
    relative: f64,
    of: Vec<String>,
}

impl Asked {
    /// What the arguments, or else the case, ask for; `None` if the case is run as it is.
    fn new(relative: Option<f64>, of: &[String], case: &Case) -> Option<Asked> {
        let in_case = case.accuracy.as_ref();
        let relative = relative.or_else(|| in_case.filter(|asked| !asked.refined).map(|asked| asked.relative))?;
        let of = if of.is_empty() { in_case.map(|asked| asked.of.clone()).unwrap_or_default() } else { of.to_vec() };
        Some(Asked { relative, of })
    }
}

/// Refines until the error is at most as large as asked, and runs the case on the last mesh into a results folder.
fn refine(
    source: &Source,
    asked: &Asked,
    out: &Path,
    (after, certificate): (After, CertificateChoice),
    (progress, interrupt): (Progress, Arc<AtomicBool>),
    common: &Common,
) -> Result<(), CommandFailure> {
    common.team.first(|| Folder::check(out, common.force))?;
    // What is made before the mesh is found is not kept: the program then ends at once.
    progress.begin_refining();
    let settings = Settings::default();
    let request = AccuracyRequest { source, overrides: &common.set, relative: asked.relative, settings: &settings };
    let Refined { case, tables, ending, relative, error } =
        if asked.of.is_empty() { energy(&request, common)? } else { values(&request, &asked.of, common)? };
    single::run_into((&case, tables), out, (after, certificate), (progress, interrupt), common)?;
    let why = match ending {
        AccuracyEnding::Reached => return Ok(()),
        AccuracyEnding::NoMesh(why) => format!("the next mesh cannot be had: {why}"),
        AccuracyEnding::Stands(why) => why,
    };
    let wanted = per_cent(asked.relative);
    let message = format!("an error of at most {wanted} was asked for, and that of the results is {error}: {why}");
    let table = serde_json::json!({ "asked": asked.relative, "relative": relative, "why": why });
    Err(CommandFailure::Verification { message, table })
}

impl From<AccuracyError> for CommandFailure {
    fn from(error: AccuracyError) -> CommandFailure {
        match error {
            AccuracyError::Case(error) => error.into(),
            AccuracyError::Run(error) => CommandFailure::Run { error, hint: None },
            AccuracyError::Refused(message) => CommandFailure::Usage(message),
        }
    }
}

/// Prints a text about a level, if anyone reads it.
fn tell(text: &str, common: &Common) {
    if !common.quiet && common.format == OutputFormat::Text {
        // The results do not depend on it.
        let _ = print::text(text);
    }
}

/// Refines by the bound in the norm of the energy.
fn energy(request: &AccuracyRequest, common: &Common) -> Result<Refined, CommandFailure> {
    tell(&format!("{:>5} {:>9} {:>9}  error in the norm of the energy\n", "mesh", "cells", "nodes"), common);
    let mut number = 0;
    let found = of_energy(request, &mut |level| {
        let EnergyLevel { cells, nodes, relative, is_guaranteed, .. } = level;
        let word = if *is_guaranteed { "at most" } else { "about" };
        tell(&format!("{number:>5} {cells:>9} {nodes:>9}  {word} {}\n", per_cent(*relative)), common);
        number += 1;
    })?;
    let AccurateCase { case, levels, ending } = found;
    let relative = levels.last().map_or(f64::NAN, |level| level.relative);
    let mut text = "mesh,cells,nodes,relative,energy,guaranteed\n".to_owned();
    for (number, EnergyLevel { cells, nodes, relative, energy, is_guaranteed }) in levels.iter().enumerate() {
        let _ = writeln!(text, "{number},{cells},{nodes},{relative:?},{energy:?},{}", u8::from(*is_guaranteed));
    }
    let error = format!("at most {}", per_cent(relative));
    Ok(Refined { case, tables: vec![(ACCURACY, text)], ending, relative, error })
}

/// Refines by the bars of numbers at the end of the run.
fn values(request: &AccuracyRequest, of: &[String], common: &Common) -> Result<Refined, CommandFailure> {
    tell(&format!("{:>5} {:>9} {:>9} {:>7}  at the end\n", "mesh", "cells", "nodes", "steps"), common);
    let (mut number, mut said) = (0, false);
    let found = of_values(request, of, &mut |news| {
        let level = match news {
            AccuracyNews::Level(level) => level,
            AccuracyNews::Steps(steps, change) => {
                let so_far =
                    format!("{:>25} {steps:>7}  halving the steps changed a number by {}\n", "", per_cent(change));
                return tell(&so_far, common);
            }
        };
        let ValueLevel { cells, nodes, steps, goals, unweighted, .. } = level;
        let head = format!("{number:>5} {cells:>9} {nodes:>9} {steps:>7}  ");
        let lines: Vec<String> =
            goals.iter().map(|goal| format!("{} ({})", with_bar(&goal.row), per_cent(goal.relative))).collect();
        tell(&format!("{head}{}\n", lines.join(&format!("\n{:>width$}", "", width = head.len()))), common);
        if let Some(why) = unweighted.as_ref().filter(|_| !said) {
            // What else there are gradients of is no help here.
            let why = why.split(", expected").next().unwrap_or(why);
            let text =
                "the cells with the largest jumps of stress and heat flux are refined: these numbers have no gradients";
            tell(&format!("{:>5} {text} ({why})\n", ""), common);
            said = true;
        }
        number += 1;
    })?;
    let AccurateCase { case, levels, ending } = found;
    let mut history = "mesh,cells,nodes,steps,quantity,value,bar,mesh_part,steps_part,relative\n".to_owned();
    for (number, level) in levels.iter().enumerate() {
        let ValueLevel { cells, nodes, steps, goals, .. } = level;
        for goal in goals {
            let BarRow { name, value, mesh, steps: of_steps, .. } = &goal.row;
            let (bar, relative) = (goal.row.bar(), goal.relative);
            let _ = writeln!(
                history,
                "{number},{cells},{nodes},{steps},{name},{value:?},{bar:?},{mesh:?},{of_steps:?},{relative:?}"
            );
        }
    }
    let worst = levels.last().map(|level| &level.goals[..]).unwrap_or_default();
    let worst = worst.iter().max_by(|a, b| a.relative.total_cmp(&b.relative));
    let relative = worst.map_or(f64::NAN, |goal| goal.relative);
    let error = worst.map_or_else(String::new, |goal| format!("about {} of {}", per_cent(relative), goal.row.name));
    let bars = bars_csv(levels.last().map(|level| &level.bars[..]).unwrap_or_default());
    Ok(Refined { case, tables: vec![(ACCURACY, history), (BARS, bars)], ending, relative, error })
}

/// A number with its bar: `pressure 0.49961 +- 0.0021 (cells 0.0018, steps 0.0003)`.
fn with_bar(row: &BarRow) -> String {
    let BarRow { name, value, mesh, steps, .. } = row;
    let bar = row.bar();
    // Two digits of the bar, and those of the value down to them.
    let digits = if bar > 0.0 && bar < value.abs() { (value.abs() / bar).log10().ceil() as usize + 1 } else { 6 };
    let digits = digits.min(f64::DIGITS as usize);
    format!("{name} {value:.digits$e} +- {bar:.1e} (cells {mesh:.1e}, steps {steps:.1e})")
}
