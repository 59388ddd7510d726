//! `run --accuracy`: runs on meshes that are finer where the error is, until its bound is small enough.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use amontons::case::{self, Case, CaseError};
use amontons::mesh::RefinementRounds;
use amontons::output::{ErrorOfRun, FolderLock, OutputError, per_cent};
use amontons::run::{self, Settings};

use crate::after::After;
use crate::arguments::{CertificateChoice, Common, OutputFormat};
use crate::print;
use crate::progress::Progress;
use crate::single;
use crate::status::CommandFailure;

/// Name of the file with the marked cells, in the case that is run.
const CELLS: &str = "refined-cells.txt";
/// The history in the results folder.
const HISTORY: &str = "accuracy.csv";
/// Rounds over which the error has to fall to [`FALLEN`] of it: it does so where cells are the reason for it.
const PATIENCE: usize = 4;
const FALLEN: f64 = 0.9;

/// A run on one of the meshes.
struct RefinedRun {
    cells: usize,
    nodes: usize,
    relative: f64,
    energy: f64,
    is_guaranteed: bool,
}

/// Why the last mesh is the last.
enum AccuracyEnding {
    Reached,
    /// The next mesh cannot be had: the reason.
    NoMesh(String),
    /// The error does not fall any more.
    Stands,
}

/// The runs so far, and the case of the last one.
struct Adapted {
    case: Case,
    levels: Vec<RefinedRun>,
    ending: AccuracyEnding,
}

/// Refines until the relative error in the norm of the energy is at most `accuracy`, and runs the case on the last mesh
/// into its results folder.
pub fn execute(
    file: &Path,
    accuracy: f64,
    (after, certificate): (After, CertificateChoice),
    common: &Common,
) -> Result<(), CommandFailure> {
    if !(accuracy > 0.0 && accuracy < 1.0) {
        let found =
            format!("--accuracy: found {accuracy}, expected a part of the solution between 0 and 1, such as 0.01");
        return Err(CommandFailure::Usage(found));
    }
    // What is made before the mesh is found is not kept: the program then ends at once.
    let progress = Progress::new(common);
    let interrupt = progress.interrupt_flag();
    progress.begin_refining();
    let Adapted { case, levels, ending } = adapted(file, accuracy, common)?;
    let out = common.out.clone().unwrap_or_else(|| PathBuf::from("results").join(&case.problem.name));
    single::run_into(&case, &out, (after, certificate), (progress, interrupt), common)?;
    let path = out.join(HISTORY);
    let _lock = FolderLock::take(&out)?;
    fs::write(&path, csv(&levels)).map_err(|source| OutputError::Io { doing: "write", path, source })?;
    let why = match ending {
        AccuracyEnding::Reached => return Ok(()),
        AccuracyEnding::NoMesh(why) => format!("the next mesh cannot be had: {why}"),
        AccuracyEnding::Stands => "it does not fall with finer cells any more".to_owned(),
    };
    let last = levels.last().map_or(f64::NAN, |level| level.relative);
    let message = format!(
        "an error of at most {} was asked for, and that of the results is at most {}: {why}",
        per_cent(accuracy),
        per_cent(last)
    );
    let table = serde_json::json!({ "asked": accuracy, "relative": last, "why": why });
    Err(CommandFailure::Verification { message, table })
}

/// Runs on finer and finer meshes.
fn adapted(file: &Path, accuracy: f64, common: &Common) -> Result<Adapted, CommandFailure> {
    let source = common.source(file)?;
    let set: Vec<String> = common.set.iter().cloned().chain(["output.error=true".to_owned()]).collect();
    let start = case::parse(&source, &set)?;
    let mut rounds = start
        .rounds
        .clone()
        .unwrap_or_else(|| RefinementRounds { cells: start.problem.mesh.cell_count(), marked: Vec::new() });
    let (mut case, mut before): (Case, Option<Case>) = (start, None);
    let mut levels: Vec<RefinedRun> = Vec::new();
    loop {
        let judged = judged(&case)?;
        let worst = match (judged.worst(), before.take()) {
            (Ok(worst), _) => worst,
            // The bound of a finer mesh may take too much memory.
            (Err(refused), Some(case)) => {
                let ending = AccuracyEnding::NoMesh(refused.reason().to_owned());
                return Ok(Adapted { case, levels, ending });
            }
            (Err(refused), None) => return Err(CommandFailure::Usage(no_bound(&refused.to_string()))),
        };
        let level = RefinedRun {
            cells: case.problem.mesh.cell_count(),
            nodes: case.problem.mesh.points.len(),
            relative: judged.relative(),
            energy: worst.energy,
            is_guaranteed: judged.is_guaranteed(),
        };
        tell(levels.len(), &level, common)?;
        let marked = worst.marked();
        levels.push(level);
        let relative = |n: usize| levels.get(n).map(|level| level.relative);
        let now = levels.len() - 1;
        if relative(now).is_some_and(|relative| relative <= accuracy) {
            return Ok(Adapted { case, levels, ending: AccuracyEnding::Reached });
        }
        let earlier = now.checked_sub(PATIENCE).and_then(relative);
        if marked.is_empty() || earlier.zip(relative(now)).is_some_and(|(earlier, now)| now > FALLEN * earlier) {
            return Ok(Adapted { case, levels, ending: AccuracyEnding::Stands });
        }
        rounds.marked.push(marked);
        let next = source.with_file(CELLS, rounds.to_string().into_bytes());
        let with_cells: Vec<String> = set.iter().cloned().chain([format!("mesh.refined_cells=\"{CELLS}\"")]).collect();
        match case::parse(&next, &with_cells) {
            Ok(finer) => before = Some(std::mem::replace(&mut case, finer)),
            Err(error @ CaseError::Faults { .. }) => {
                let why = error.to_string().lines().next().unwrap_or_default().to_owned();
                return Ok(Adapted { case, levels, ending: AccuracyEnding::NoMesh(why) });
            }
            Err(error) => return Err(error.into()),
        }
    }
}

/// The error of the run of a case, which writes no results.
fn judged(case: &Case) -> Result<ErrorOfRun, CommandFailure> {
    let mut judge = ErrorOfRun::every(case.every);
    let settings = Settings { certificate: false, ..Settings::default() };
    let made = run::run(&case.problem, &settings, &mut [&mut judge]);
    made.map_err(|error| CommandFailure::Run { error, hint: None })?;
    Ok(judge)
}

fn no_bound(why: &str) -> String {
    format!("--accuracy: {why}; refine the mesh by hand (mesh.n, mesh.refine_where) and compare (amontons converge)")
}

/// Prints what a mesh has brought.
fn tell(number: usize, level: &RefinedRun, common: &Common) -> Result<(), CommandFailure> {
    if common.quiet || common.format == OutputFormat::Json {
        return Ok(());
    }
    let mut text = String::new();
    if number == 0 {
        let _ = writeln!(text, "{:>5} {:>9} {:>9}  error in the norm of the energy", "mesh", "cells", "nodes");
    }
    let RefinedRun { cells, nodes, relative, is_guaranteed, .. } = level;
    let word = if *is_guaranteed { "at most" } else { "about" };
    let _ = writeln!(text, "{number:>5} {cells:>9} {nodes:>9}  {word} {}", per_cent(*relative));
    Ok(print::text(&text)?)
}

fn csv(levels: &[RefinedRun]) -> String {
    let mut text = "mesh,cells,nodes,relative,energy,guaranteed\n".to_owned();
    for (number, RefinedRun { cells, nodes, relative, energy, is_guaranteed }) in levels.iter().enumerate() {
        let _ = writeln!(text, "{number},{cells},{nodes},{relative:?},{energy:?},{}", u8::from(*is_guaranteed));
    }
    text
}
