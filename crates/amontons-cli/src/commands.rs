//! The work of each command.

use std::path::Path;

use amontons::case;
use amontons::hypotheses;
use amontons::mesh::{self, Mesh};
use amontons::model::{MeshModel, Model};
use amontons::plot;
use amontons::units::{UnitSystem, Units};
use clap::CommandFactory;

use crate::after::{self, After};
use crate::arguments::{Arguments, Command, Common, OutputFormat};
use crate::print;
use crate::status::CommandFailure;
use crate::{
    accuracy, constants, converge, explain, fit, gradient, import, materials, modes, new, reproduce, single, sweep,
    verify,
};

/// Executes a command.
pub fn execute(command: Command) -> Result<(), CommandFailure> {
    match command.with_choices() {
        Command::Run { case, plot, report, certificate, each, jobs, common, .. } if !each.is_empty() => {
            let after = After { pictures: plot, report };
            let request = sweep::Request { each: &each, jobs: jobs.get(), after, certificate };
            sweep::execute(&case, &request, &common)
        }
        Command::Run { case, plot, report, certificate, accuracy, of, again, common, .. } => {
            let after = After { pictures: plot, report };
            accuracy::start(&case, (accuracy, &of), after, (certificate, again), &common)
        }
        Command::Resume { dir, plot, report, certificate, common } => {
            single::resume(&dir, After { pictures: plot, report }, certificate, &common)
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
