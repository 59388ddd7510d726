//! One run in its results folder: started, resumed, and what is printed of it.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use amontons::case::Case;
use amontons::mesh::Skipped;
use amontons::output::{self, Checkpoint, Folder, FolderLock, FolderOptions, Sink, Summary};
use amontons::run::{self, RunError, Settings};
use amontons::units::Measure;

use crate::after::After;
use crate::arguments::{CertificateChoice, Common, OutputFormat};
use crate::print;
use crate::progress::{Progress, StepSink};
use crate::status::CommandFailure;
use crate::team::OfFirst;

/// The results folder of a run from its start; with `again` one that is not there.
pub fn folder(case: &Case, again: bool, common: &Common) -> PathBuf {
    let named = common.out.clone().unwrap_or_else(|| PathBuf::from("results").join(&case.problem.name));
    if again { free(named) } else { named }
}

/// Runs a case from its start into a folder, beside tables of what was found before. The flag that ends it is one that
/// its progress has made.
pub fn run_into(
    (case, tables): (&Case, Vec<(&'static str, String)>),
    out: &Path,
    (after, choice): (After, CertificateChoice),
    (progress, interrupt): (Progress, Arc<AtomicBool>),
    common: &Common,
) -> Result<(), CommandFailure> {
    let certificate = choice.of(case);
    let settings = settings(case, out, certificate, (&progress, common.team.interrupt(&interrupt)));
    // What is known of an earlier run is read by all processes before the folder changes.
    common.team.wait();
    let create = || Folder::create(out, FolderOptions { tables, ..options(case, certificate, common) });
    let folder = common.team.first(create)?;
    drive(case, None, (folder, out, after), &settings, progress, common)
}

/// The first name that does not exist: the folder, then the folder with -2, -3 and so on.
fn free(named: PathBuf) -> PathBuf {
    let numbered = |number: usize| {
        let mut name = named.clone().into_os_string();
        name.push(format!("-{number}"));
        PathBuf::from(name)
    };
    // A folder whose name cannot be looked up is reported when it is made.
    let is_taken = |path: &Path| path.symlink_metadata().is_ok();
    if is_taken(&named) { (2..=9999).map(numbered).find(|path| !is_taken(path)).unwrap_or(named) } else { named }
}

/// Goes on with a run from its newest checkpoint.
pub fn resume(dir: &Path, after: After, choice: CertificateChoice, common: &Common) -> Result<(), CommandFailure> {
    let progress = Progress::new(common);
    let case = common.case(&dir.join("case.toml"))?;
    let out = common.out.as_deref().unwrap_or(dir);
    let same = out == dir || out.canonicalize().is_ok_and(|out| dir.canonicalize().is_ok_and(|dir| dir == out));
    // A run without a certificate is resumed without one.
    let certificate = choice.asked().unwrap_or_else(|| output::has_certificate(dir).unwrap_or(true));
    let options = options(&case, certificate, common);
    let (folder, checkpoint) = if same {
        let folder = common.team.first(|| Folder::reopen(dir, options))?;
        (folder, Checkpoint::read(dir, &case.identity())?)
    } else {
        let _lock = common.team.first(|| FolderLock::take(dir))?;
        let checkpoint = Checkpoint::read(dir, &case.identity())?;
        (common.team.first(|| Folder::copy(dir, out, options))?, checkpoint)
    };
    if let Some((why, step)) = checkpoint.as_ref().and_then(|c| Some((c.fallback.as_ref()?, c.state.step))) {
        note(&format!("{why}; going on from the checkpoint before, of step {step}"), common);
    }
    let interrupt = common.team.interrupt(&progress.interrupt_flag());
    let settings = settings(&case, dir, certificate, (&progress, interrupt));
    // All processes have read the checkpoint before the run replaces it.
    common.team.wait();
    drive(&case, checkpoint, (folder, out, after), &settings, progress, common)
}

/// Prints a note for the user; the command continues.
fn note(text: &str, common: &Common) {
    if !common.quiet {
        print::note(text);
    }
}

/// Settings of a run, with the certificate found in `dir` for the same inputs.
fn settings(
    case: &Case,
    dir: &Path,
    certificate: bool,
    (progress, interrupt): (&Progress, Arc<AtomicBool>),
) -> Settings {
    Settings {
        // Commands run in a pool with the requested number of threads.
        threads: None,
        interrupt: Some(interrupt),
        certificate,
        known: output::known_certificate(dir, &case.fingerprint()),
        watch: Some(progress.watch()),
        pulse: progress.pulse(),
        ..Settings::default()
    }
}

fn options(case: &Case, certificate: bool, common: &Common) -> FolderOptions {
    FolderOptions { force: common.force, certificate, ..case.folder_options() }
}

/// Runs a case into a folder, prints its summary, and makes pictures and report, even if it ended early.
fn drive(
    case: &Case,
    from: Option<Checkpoint>,
    (mut folder, out, after): (Option<Folder>, &Path, After),
    settings: &Settings,
    progress: Progress,
    common: &Common,
) -> Result<(), CommandFailure> {
    let mut steps = StepSink(&progress);
    let mut written = OfFirst { team: &common.team, sink: folder.as_mut().map(|folder| folder as &mut dyn Sink) };
    let mut sinks: Vec<&mut dyn Sink> = vec![&mut written, &mut steps];
    let result = match from {
        Some(checkpoint) => run::resume(&case.problem, checkpoint, settings, &mut sinks),
        None => run::run(&case.problem, settings, &mut sinks),
    };
    // The progress bar is removed before the summary is printed.
    drop(progress);
    let Some(folder) = folder else {
        return result.map(|_| ()).map_err(|error| CommandFailure::Run { error, hint: None });
    };
    folder.notes().iter().for_each(|text| note(text, common));
    let quiet = common.quiet || common.format == OutputFormat::Json;
    match result {
        Ok(summary) => {
            done(&folder.completed(&summary), &case.skipped, out, common)?;
            after.make(out, quiet)
        }
        Err(error) => {
            let hint = hint(&error, &folder, out);
            let is_written = hint.is_some() && !folder.keeps_older_results();
            if is_written && let Err(failure) = after.make(out, quiet) {
                note(&failure.message(), common);
            }
            Err(CommandFailure::Run { error, hint })
        }
    }
}

fn done(summary: &Summary, skipped: &[Skipped], out: &Path, common: &Common) -> Result<(), CommandFailure> {
    match common.format {
        OutputFormat::Json => print::json(&serde_json::json!(summary))?,
        OutputFormat::Text if common.quiet => {}
        OutputFormat::Text => print::text(&print::summary(summary, skipped, out))?,
    }
    Ok(())
}

/// Instruction what to do after a run that ended early.
fn hint(error: &RunError, folder: &Folder, out: &Path) -> Option<String> {
    let out = out.display();
    if let RunError::Unstarted { resumes } = error {
        return Some(match resumes {
            true => format!("{out} is as it was; go on with: amontons resume {out}"),
            false if folder.keeps_older_results() => format!("{out} still holds the results of an earlier run"),
            false => "there are no results yet; begin again with the same command".to_owned(),
        });
    }
    let summary = error.summary()?;
    if folder.keeps_older_results() {
        return Some(format!("{out} still holds the results of an earlier run"));
    }
    let kept = format!(
        "results up to step {}, t = {}, are in {out}",
        summary.steps,
        summary.units.exact(summary.time, Measure::Time)
    );
    Some(match error.advice() {
        Some(advice) => format!("{kept}; {advice}"),
        None => format!("{kept}; go on with: amontons resume {out}"),
    })
}
