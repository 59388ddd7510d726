//! `reproduce`: the figures of the paper's section 5 for three readings of its tensors, with a report.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use amontons::case::{self, ReferenceRequest, Source, StudyRequest};
use amontons::convergence::{Table, Vary};
use amontons::output::{Folder, FolderOptions, OutputError, Summary};
use amontons::plot::{self, Kind};
use amontons::run::{self, Settings};

use crate::arguments::{Common, Format};
use crate::commands::interrupt_flag;
use crate::converge;
use crate::print;
use crate::status::Failure;

/// The paper's example.
const PAPER: &str = include_str!("../../../cases/paper.toml");

/// A reading of the paper's tensors: name, what it is, overrides.
type Reading = (&'static str, &'static str, &'static [&'static str]);

/// The readings: the default, all three tensors the identity, and all three all ones as printed.
const READINGS: [Reading; 3] = [
    ("default", "𝓜, 𝓡 all ones as printed, 𝓚 the identity", &[]),
    ("identity", "𝓜, 𝓡, 𝓚 the identity", &["material.expansion=1", "material.coupling=1", "material.conductivity=1"]),
    ("literal", "𝓜, 𝓡, 𝓚 all ones as printed; 𝓚 is singular", &["material.conductivity=[[1, 1], [1, 1]]"]),
];

const FOUNDATION: [&str; 2] = ["0", "10"];

/// A reading at both temperatures of the foundation.
struct Reproduced {
    reading: Reading,
    runs: Vec<Summary>,
    studies: Vec<Table>,
}

/// Runs, studies, figures and report, in one folder.
pub fn execute(levels: &[usize], reference: usize, common: &Common) -> Result<(), Failure> {
    let out = common.out.clone().unwrap_or_else(|| PathBuf::from("results").join("reproduce"));
    let report = out.join("report.md");
    if report.exists() && !common.force {
        return Err(OutputError::HoldsResults { path: out, found: "report.md".to_owned() }.into());
    }
    let flag = interrupt_flag();
    let source = Source::new("paper.toml", PAPER);
    let mut all = Vec::new();
    for reading in READINGS {
        let folder = out.join(reading.0);
        let mut done = Reproduced { reading, runs: Vec::new(), studies: Vec::new() };
        for foundation in FOUNDATION {
            let mut overrides: Vec<String> = common.set.clone();
            overrides.extend(reading.2.iter().map(|&o| o.to_owned()));
            overrides.push(format!("contact.heat.foundation_temperature={foundation}"));
            let case = case::parse(&source, &overrides)?;
            let run_folder = folder.join(format!("run-{foundation}"));
            let mut results = Folder::create(
                &run_folder,
                FolderOptions { every: case.every, fields: case.fields.clone(), probes: case.probes.clone(), force: true, ..FolderOptions::new(&case.text) },
            )?;
            let settings = Settings { threads: common.threads.map(usize::from), interrupt: Some(flag.clone()), certificate: false };
            let summary = run::run(&case.problem, &settings, &mut [&mut results]).map_err(|error| Failure::Run { error, hint: None })?;
            done.runs.push(summary);
            // Levels of an interrupted attempt are taken as they are.
            let request = StudyRequest { vary: Vary::Both, levels: levels.to_vec(), reference: ReferenceRequest::Level(reference), power: 1 };
            let study_folder = folder.join(format!("study-{foundation}"));
            let forced = Common { force: true, ..common.clone() };
            let table = converge::study(&source, &overrides, &request, &study_folder, &forced, &flag)?;
            if common.format == Format::Text && !common.quiet {
                print::text(&converge::text(&format!("{}, θ_F = {foundation}", reading.0), &table, &study_folder))?;
            }
            done.studies.push(table);
        }
        figures(&folder, reference)?;
        all.push(done);
    }
    let text = write_report(&all, levels, reference);
    std::fs::write(&report, &text).map_err(|source| OutputError::Io { doing: "write", path: report.clone(), source })?;
    match common.format {
        Format::Json => print::json(&serde_json::json!({ "report": report, "folder": out }))?,
        Format::Text if common.quiet => {}
        Format::Text => print::text(&text)?,
    }
    Ok(())
}

/// Figures 2–5, left θ_F = 0, right θ_F = 10.
fn figures(folder: &Path, reference: usize) -> Result<(), Failure> {
    let options = plot::Options { dimensionless: true, ..plot::Options::default() };
    let runs = FOUNDATION.map(|f| (format!("θ_{{F}} = {f}"), folder.join(format!("run-{f}"))));
    let panels: Vec<(&str, &Path)> = runs.iter().map(|(title, dir)| (title.as_str(), dir.as_path())).collect();
    let kinds = [
        (Kind::Deformed, "figure-2-deformed"),
        (Kind::Temperature, "figure-3-temperature"),
        (Kind::VonMises, "figure-4-von-mises"),
        (Kind::Contact, "contact"),
        (Kind::History, "history"),
    ];
    for (kind, name) in kinds {
        plot::side_by_side(kind, &panels, &folder.join(name), &options)?;
    }
    let mut studies = Vec::new();
    for f in FOUNDATION {
        let mut study = plot::ConvergencePlot::read(&folder.join(format!("study-{f}")).join("convergence.csv"), &options)?;
        study.title = format!("θ_{{F}} = {f}");
        studies.push(study);
    }
    plot::convergence_panels(&format!("Errors against h = k = 1/{reference}"), &studies)?.save(&folder.join("figure-5-errors"), options.pixels)?;
    Ok(())
}

fn write_report(all: &[Reproduced], levels: &[usize], reference: usize) -> String {
    let mut out = String::from("# The paper's section 5, recomputed\n\n");
    let _ = writeln!(
        out,
        "Runs with h = k = 1/64; errors on the levels {levels:?} against {reference}. Figures are in the folder of each reading.\n\n\
         **Statement 1** (on Figures 2–4): as the foundation is warmer, deformation, stress and temperature are larger.\n\
         **Statement 2** (on Figure 5): linear convergence (4.40) is almost observed.\n"
    );
    for done in all {
        let (name, what, _) = done.reading;
        let _ = writeln!(out, "## Reading `{name}`: {what}\n");
        let _ = writeln!(out, "| | θ_F = 0 | θ_F = 10 | larger? |\n|---|---|---|---|");
        let quantity = |f: fn(&Summary) -> f64| done.runs.iter().map(f).collect::<Vec<f64>>();
        let largest = |s: &Summary| s.last.displacement_max.iter().chain(&s.last.displacement_min).fold(0.0f64, |m, v| m.max(v.abs()));
        let mut supported = Vec::new();
        for (label, values) in [
            ("largest displacement component", quantity(largest)),
            ("‖ε(u)‖", quantity(|s| s.last.norms.displacement_v)),
            ("largest von Mises stress (not convergent: corners are singular)", quantity(|s| s.last.von_mises_max.unwrap_or(0.0))),
            ("largest temperature", quantity(|s| s.last.temperature_max.unwrap_or(0.0))),
        ] {
            if let [cold, warm] = values[..] {
                let _ = writeln!(out, "| {label} | {cold:.6} | {warm:.6} | {} |", if warm > cold { "yes" } else { "**no**" });
                supported.push(warm > cold);
            }
        }
        let verdict = if supported.iter().all(|&s| s) { "The numbers support statement 1." } else { "The numbers do **not** support statement 1." };
        let _ = writeln!(out, "\n{verdict}\n\n| θ_F | E^hk by level | orders | least-squares slope |\n|---|---|---|---|");
        let mut linear = true;
        for (foundation, table) in FOUNDATION.iter().zip(&done.studies) {
            let errors: Vec<String> = table.rows.iter().map(|r| format!("{:.4e}", r.error)).collect();
            let orders: Vec<String> = table.rows.iter().filter_map(|r| r.order).map(|o| format!("{o:.3}")).collect();
            let slope = table.slopes.iter().find(|(name, _)| *name == "error").map_or(f64::NAN, |(_, slope)| *slope);
            linear &= (slope - 1.0).abs() <= 0.15;
            let _ = writeln!(out, "| {foundation} | {} | {} | {slope:.3} |", errors.join(", "), orders.join(", "));
        }
        let verdict = if linear {
            "The slopes lie within 0.15 of 1: the numbers support statement 2."
        } else {
            "A slope is farther than 0.15 from 1: statement 2 is supported with reserve only."
        };
        let late = done.studies.iter().filter_map(|t| t.rows.last()).map(|r| format!("t = {:.4}", r.time_of_error)).collect::<Vec<_>>().join(" and ");
        let _ = writeln!(out, "\n{verdict} On the finest level the maximum over time is taken at {late}.\n");
    }
    out
}
