//! The work of each command.

use std::path::{Path, PathBuf};

use amontons::case::{self, Case};
use amontons::hypotheses;
use amontons::mesh::{self, Mesh, Skipped};
use amontons::model::{MeshModel, Model};
use amontons::output::{self, Checkpoint, Folder, FolderLock, FolderOptions, Sink, Summary};
use amontons::plot;
use amontons::run::{self, RunError, Settings};
use amontons::units::{Measure, UnitSystem, Units};
use clap::CommandFactory;

use crate::after::{self, After};
use crate::arguments::{Arguments, CertificateChoice, Command, Common, OutputFormat};
use crate::print;
use crate::progress::{Progress, StepSink};
use crate::status::CommandFailure;
use crate::{
    accuracy, constants, converge, explain, fit, gradient, import, materials, modes, new, reproduce, sweep, verify,
};

/// Executes a command.
pub fn execute(command: Command) -> Result<(), CommandFailure> {
    match command.with_choices() {
        Command::Run { case, plot, report, certificate, each, jobs, common, .. } if !each.is_empty() => {
            let after = After { pictures: plot, report };
            let request = sweep::Request { each: &each, jobs: jobs.get(), after, certificate };
            sweep::execute(&case, &request, &common)
        }
        Command::Run { case, plot, report, certificate, accuracy: Some(accuracy), common, .. } => {
            accuracy::execute(&case, accuracy, (After { pictures: plot, report }, certificate), &common)
        }
        Command::Run { case, plot, report, certificate, again, common, .. } => {
            start(&case, After { pictures: plot, report }, (certificate, again), &common)
        }
        Command::Resume { dir, plot, report, certificate, common } => {
            resume(&dir, After { pictures: plot, report }, certificate, &common)
        }
        Command::Report { dir } => after::report(&dir, false),
        Command::Check { case, levels, plot, common } => check(&case, &levels, plot.as_deref(), &common),
        Command::Converge { case, study, common } => converge::execute(&case, &study, &common),
        Command::Modes { case, modes, common } => modes::execute(&case, &modes, &common),
        Command::Gradient { case, of, with, common } => gradient::execute(&case, &of, &with, &common),
        Command::Fit { case, fit, common } => fit::execute(&case, &fit, &common),
        Command::Plot { dir, time, dimensionless, scale, pixels, animate } => {
            let pixels = pixels.unwrap_or(if animate.is_some() { 1.0 } else { 2.0 });
            let options =
                plot::Options { times: time, dimensionless, pixels, scale_factor: scale, ..plot::Options::default() };
            match animate {
                Some(field) => after::animate(&dir, field, &options),
                None => after::draw(&dir, &options, false),
            }
        }
        Command::Verify { names, common } => verify::execute(&names, &common),
        Command::Reproduce { levels, reference, common } => reproduce::execute(&levels, reference, &common),
        Command::Explain { word, format } => explain::execute(word.as_deref(), format),
        Command::Mesh { file, plot, scale, confine, format } => {
            if confine {
                check_confined(&file)?;
            }
            show_mesh(&file, plot.as_deref(), (scale, confine), format)
        }
        Command::Import { deck, out, units, force } => import::execute(&deck, out.as_deref(), units, force),
        Command::Schema => Ok(print::json(&case::schema())?),
        Command::Materials { name } => show_materials(name.as_deref()),
        Command::New { file, template, mesh } => new::execute(&file, template, mesh.as_deref()),
        Command::Man { command } => show_manual(command.as_deref()),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Arguments::command(), "amontons", &mut script);
            Ok(print::text(&String::from_utf8_lossy(&script))?)
        }
    }
}

/// Prints the manual page of the program or of a command.
fn show_manual(command: Option<&str>) -> Result<(), CommandFailure> {
    let mut program = Arguments::command();
    program.build();
    let page = match command {
        None => &program,
        Some(name) => program.find_subcommand(name).ok_or_else(|| {
            let known: Vec<&str> = program.get_subcommands().map(clap::Command::get_name).collect();
            CommandFailure::Usage(format!("found \"{}\", expected one of {}", name.escape_debug(), known.join(", ")))
        })?,
    };
    let mut text = Vec::new();
    clap_mangen::Man::new(page.clone())
        .render(&mut text)
        .map_err(|source| CommandFailure::Request(source.to_string()))?;
    Ok(print::text(&String::from_utf8_lossy(&text))?)
}

/// Prints the materials that a case may name, or one.
fn show_materials(name: Option<&str>) -> Result<(), CommandFailure> {
    let Some(name) = name else { return Ok(print::text(&materials::all())?) };
    let known = case::materials().get_key_value(name);
    let (name, material) = known.ok_or_else(|| {
        let found = name.escape_debug();
        CommandFailure::Usage(format!(
            "found \"{found}\", expected the name of a material; `amontons materials` lists them"
        ))
    })?;
    Ok(print::text(&materials::one(name, material))?)
}

/// Checks that the file, after links, is in the folder of its name.
fn check_confined(file: &Path) -> Result<(), CommandFailure> {
    let named = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let inside = file.canonicalize().ok().zip(named.canonicalize().ok());
    match inside {
        Some((real, folder)) if !real.starts_with(&folder) => {
            let message = format!("{}: found a link out of its folder, which --confine refuses", file.display());
            Err(CommandFailure::Usage(message))
        }
        _ => Ok(()),
    }
}

/// Prints the content of a mesh. A defect of its cells or sides is a failed check.
fn show_mesh(
    file: &Path,
    plot: Option<&Path>,
    (scale, confine): (f64, bool),
    format: OutputFormat,
) -> Result<(), CommandFailure> {
    if !(scale.is_finite() && scale > 0.0) {
        return Err(CommandFailure::Usage(format!("--scale: found {scale}, expected a positive number")));
    }
    let (mesh, units, skipped) = if file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml")) {
        let case = case::read(file, &[])?;
        ((*case.problem.mesh).clone(), case.problem.units(), Vec::new())
    } else {
        // The unit of the coordinates of a mesh file is unknown.
        let read = if confine { mesh::read_confined(file)? } else { mesh::read_all(file)? };
        (read.mesh, Units { system: UnitSystem::Dimensionless, ..Units::SPACE }, read.skipped)
    };
    let mesh = mesh.scaled(scale);
    let model = MeshModel::new(&mesh);
    let table = serde_json::json!({ "mesh": model, "skipped": skipped });
    if format == OutputFormat::Text {
        print::text(&crate::model::mesh(&file.display().to_string(), &model, &skipped))?;
    }
    if let Some(stem) = plot {
        let name = file.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        draw_sides((&mesh, &name, units), stem, format == OutputFormat::Json)?;
    }
    if !model.defects.is_empty() {
        return Err(CommandFailure::Verification { message: model.defects.join("\n"), table });
    }
    if format == OutputFormat::Json { Ok(print::json(&table)?) } else { Ok(()) }
}

/// Draws the sides of a mesh into two files and prints their names.
fn draw_sides((mesh, name, units): (&Mesh, &str, Units), stem: &Path, quiet: bool) -> Result<(), CommandFailure> {
    let written = plot::sides(mesh, name, units)?.save(stem, 2.0)?;
    if quiet {
        return Ok(());
    }
    Ok(print::text(&format!("{} {}\n", written[0].display(), written[1].display()))?)
}

fn start(
    file: &Path,
    after: After,
    (choice, again): (CertificateChoice, bool),
    common: &Common,
) -> Result<(), CommandFailure> {
    let case = common.case(file)?;
    let named = common.out.clone().unwrap_or_else(|| PathBuf::from("results").join(&case.problem.name));
    let out = if again { free(named) } else { named };
    run_into(&case, &out, (after, choice), common)
}

/// Runs a case from its start into a folder.
pub fn run_into(
    case: &Case,
    out: &Path,
    (after, choice): (After, CertificateChoice),
    common: &Common,
) -> Result<(), CommandFailure> {
    let progress = Progress::new(common);
    let certificate = choice.of(case);
    let settings = settings(case, out, certificate, &progress);
    let folder = Folder::create(out, options(case, certificate, common))?;
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

fn resume(dir: &Path, after: After, choice: CertificateChoice, common: &Common) -> Result<(), CommandFailure> {
    let progress = Progress::new(common);
    let case = common.case(&dir.join("case.toml"))?;
    let out = common.out.as_deref().unwrap_or(dir);
    let same = out == dir || out.canonicalize().is_ok_and(|out| dir.canonicalize().is_ok_and(|dir| dir == out));
    // A run without a certificate is resumed without one.
    let certificate = choice.asked().unwrap_or_else(|| output::has_certificate(dir).unwrap_or(true));
    let options = options(&case, certificate, common);
    let (folder, checkpoint) = if same {
        (Folder::reopen(dir, options)?, Checkpoint::read(dir, &case.identity())?)
    } else {
        let _lock = FolderLock::take(dir)?;
        let checkpoint = Checkpoint::read(dir, &case.identity())?;
        (Folder::copy(dir, out, options)?, checkpoint)
    };
    if let Some((why, step)) = checkpoint.as_ref().and_then(|c| Some((c.fallback.as_ref()?, c.state.step))) {
        note(&format!("{why}; going on from the checkpoint before, of step {step}"), common);
    }
    let settings = settings(&case, dir, certificate, &progress);
    drive(&case, checkpoint, (folder, out, after), &settings, progress, common)
}

/// Prints a note for the user; the command continues.
fn note(text: &str, common: &Common) {
    if !common.quiet {
        print::note(text);
    }
}

/// Settings of a run, with the certificate found in `dir` for the same inputs.
fn settings(case: &Case, dir: &Path, certificate: bool, progress: &Progress) -> Settings {
    Settings {
        // Commands run in a pool with the requested number of threads.
        threads: None,
        interrupt: Some(progress.interrupt_flag()),
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
    (mut folder, out, after): (Folder, &Path, After),
    settings: &Settings,
    progress: Progress,
    common: &Common,
) -> Result<(), CommandFailure> {
    let mut steps = StepSink(&progress);
    let mut sinks: Vec<&mut dyn Sink> = vec![&mut folder, &mut steps];
    let result = match from {
        Some(checkpoint) => run::resume(&case.problem, checkpoint, settings, &mut sinks),
        None => run::run(&case.problem, settings, &mut sinks),
    };
    // The progress bar is removed before the summary is printed.
    drop(progress);
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

fn check(file: &Path, levels: &[usize], plot: Option<&Path>, common: &Common) -> Result<(), CommandFailure> {
    let case = common.case(file)?;
    let problem = &case.problem;
    if let Some(stem) = plot {
        let drawn = (&*problem.mesh, problem.name.as_str(), problem.units());
        draw_sides(drawn, stem, common.quiet || common.format == OutputFormat::Json)?;
    }
    let (certificate, model) = (hypotheses::full(problem), Model::new(problem));
    let table = constants::table(file, levels, common)?;
    match common.format {
        OutputFormat::Json => {
            let mut value = print::valid_json(&case, &model, &certificate);
            if let Some(table) = &table {
                constants::add_json(table, &mut value);
            }
            print::json(&value)?;
        }
        OutputFormat::Text if common.quiet => {}
        OutputFormat::Text => {
            let constants = table.as_ref().map(constants::text).unwrap_or_default();
            print::text(&(print::valid(&file.display().to_string(), &case, &model, &certificate) + &constants))?;
        }
    }
    Ok(())
}
