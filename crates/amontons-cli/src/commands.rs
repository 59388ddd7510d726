//! What each command does.

use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use amontons::case::{self, Case};
use amontons::hypotheses;
use amontons::output::{Checkpoint, Folder, FolderOptions, OutputError, Sink, Summary};
use amontons::plot;
use amontons::run::{self, RunError, Settings};
use amontons::scheme::StepError;
use clap::CommandFactory;

use crate::arguments::{Arguments, Command, Common, Format};
use crate::print;
use crate::progress::Progress;
use crate::status::Failure;
use crate::{constants, converge, reproduce, verify};

/// Exit code after a second Ctrl-C.
const KILLED: i32 = 130;

/// Does what a command says.
pub fn execute(command: Command) -> Result<(), Failure> {
    match command {
        Command::Run { case, plot, common } => start(&case, plot, &common),
        Command::Resume { dir, common } => resume(&dir, &common),
        Command::Check { case, levels, common } => check(&case, &levels, &common),
        Command::Converge { case, study, common } => converge::execute(&case, &study, &common),
        Command::Plot { dir, time, dimensionless, scale, pixels } => {
            draw(&dir, &plot::Options { times: time, dimensionless, pixels, scale_factor: scale, ..plot::Options::default() }, false)
        }
        Command::Verify { names, common } => verify::execute(&names, &common),
        Command::Reproduce { levels, reference, common } => reproduce::execute(&levels, reference, &common),
        Command::Schema => Ok(print::json(&case::schema())?),
        Command::New { file } => new(&file),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Arguments::command(), "amontons", &mut script);
            Ok(print::text(&String::from_utf8_lossy(&script))?)
        }
    }
}

/// Draws what a folder holds and tells where the pictures are.
fn draw(dir: &Path, options: &plot::Options, quiet: bool) -> Result<(), Failure> {
    let paths = plot::folder(dir, options)?;
    if quiet {
        return Ok(());
    }
    Ok(print::text(&paths.iter().map(|path| format!("{}\n", path.display())).collect::<String>())?)
}

fn start(file: &Path, pictures: bool, common: &Common) -> Result<(), Failure> {
    let case = case::read(file, &common.set)?;
    let out = common.out.clone().unwrap_or_else(|| PathBuf::from("results").join(&case.problem.name));
    let mut folder = Folder::create(&out, options(&case, common))?;
    drive(&case, None, &mut folder, &out, common)?;
    if pictures { draw(&out, &plot::Options::default(), common.quiet || common.format == Format::Json) } else { Ok(()) }
}

fn resume(dir: &Path, common: &Common) -> Result<(), Failure> {
    let case = case::read(&dir.join("case.toml"), &common.set)?;
    let checkpoint = Checkpoint::read(dir, &case.fingerprint())?;
    let out = common.out.as_deref().unwrap_or(dir);
    let mut folder = if out == dir { Folder::reopen(dir, options(&case, common))? } else { Folder::copy(dir, out, options(&case, common))? };
    drive(&case, Some(checkpoint), &mut folder, out, common)
}

fn options(case: &Case, common: &Common) -> FolderOptions {
    FolderOptions {
        inputs: case.inputs.clone(),
        every: case.every,
        fields: case.fields.clone(),
        probes: case.probes.clone(),
        force: common.force,
        ..FolderOptions::new(&case.text)
    }
}

/// Runs a case into a folder and prints what it came to.
fn drive(case: &Case, from: Option<Checkpoint>, folder: &mut Folder, out: &Path, common: &Common) -> Result<(), Failure> {
    let settings = Settings { threads: common.threads.map(usize::from), interrupt: Some(interrupt_flag()), ..Settings::default() };
    let mut progress = if common.quiet { None } else { Progress::on_terminal() };
    let mut sinks: Vec<&mut dyn Sink> = vec![folder];
    sinks.extend(progress.as_mut().map(|progress| progress as &mut dyn Sink));
    let result = match from {
        Some(checkpoint) => run::resume(&case.problem, checkpoint, &settings, &mut sinks),
        None => run::run(&case.problem, &settings, &mut sinks),
    };
    match result {
        Ok(summary) => done(&summary, out, common),
        Err(error) => {
            let hint = hint(&error, folder, out);
            Err(Failure::Run { error, hint })
        }
    }
}

fn done(summary: &Summary, out: &Path, common: &Common) -> Result<(), Failure> {
    match common.format {
        Format::Json => print::json(&serde_json::json!(summary))?,
        Format::Text if common.quiet => {}
        Format::Text => print::text(&print::summary(summary, out))?,
    }
    Ok(())
}

/// What to do about a run that has ended early.
fn hint(error: &RunError, folder: &Folder, out: &Path) -> Option<String> {
    let out = out.display();
    let (RunError::Step { summary, .. } | RunError::Interrupted(summary)) = error else { return None };
    if folder.keeps_older_results() {
        return Some(format!("{out} holds the results of an earlier run as before"));
    }
    let kept = format!("results up to step {}, t = {} s, are in {out}", summary.steps, summary.time);
    Some(match error {
        RunError::Step { source: StepError::Residual { .. }, .. } => format!(
            "{kept}; what is left is the round-off of the displacement or temperature, if stiffnesses or conductances of the case lie more than about 1e9 apart: bring them nearer, or hold the body where it drifts"
        ),
        RunError::Interrupted(_) => format!("{kept}; go on with: amontons resume {out}"),
        _ => format!("{kept}; try more steps (time.steps), or a finer mesh where the contact changes"),
    })
}

/// A flag that Ctrl-C sets; a second Ctrl-C ends the program at once.
pub fn interrupt_flag() -> Arc<AtomicBool> {
    let flag = Arc::new(AtomicBool::new(false));
    let set = Arc::clone(&flag);
    // Where there is no handler to be had, Ctrl-C ends the program at once: checkpoints are written all the same.
    let _ = ctrlc::set_handler(move || {
        if set.swap(true, Ordering::Relaxed) {
            std::process::exit(KILLED);
        }
    });
    flag
}

fn check(file: &Path, levels: &[usize], common: &Common) -> Result<(), Failure> {
    let case = case::read(file, &common.set)?;
    let problem = &case.problem;
    let full = run::with_threads(common.threads.map(usize::from), || hypotheses::full(problem));
    let certificate = full.map_err(|error| Failure::Run { error, hint: None })?;
    let table = constants::table(file, levels, common)?;
    match common.format {
        Format::Json => {
            let mut value = print::valid_json(problem, &certificate);
            if let Some(table) = &table {
                constants::add_json(table, &mut value);
            }
            print::json(&value)?;
        }
        Format::Text if common.quiet => {}
        Format::Text => {
            let constants = table.as_ref().map(constants::text).unwrap_or_default();
            print::text(&(print::valid(&file.display().to_string(), problem, &certificate) + &constants))?;
        }
    }
    Ok(())
}

fn new(file: &Path) -> Result<(), Failure> {
    let failed = |source: io::Error| match source.kind() {
        io::ErrorKind::AlreadyExists => Failure::Exists(file.to_owned()),
        _ => OutputError::Io { doing: "create", path: file.to_owned(), source }.into(),
    };
    let mut out = OpenOptions::new().write(true).create_new(true).open(file).map_err(failed)?;
    out.write_all(case::STARTER.as_bytes()).map_err(failed)?;
    Ok(print::text(&format!("{}: a starter case; run it with: amontons run {}\n", file.display(), file.display()))?)
}
