//! `reproduce`: the figures of the paper's section 5 for three readings of its tensors, with a report.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use amontons::case::{self, ReferenceRequest, Source, StudyRequest};
use amontons::convergence::{StudyTable, Vary};
use amontons::output::{self, Checkpoint, Folder, FolderOptions, OutputError, StudyFolder, Summary};
use amontons::plot::{self, PictureKind};
use amontons::run::{self, RunError, Settings};

use crate::arguments::{Common, OutputFormat};
use crate::converge::{self, Running};
use crate::print;
use crate::progress::{Progress, StepSink};
use crate::status::CommandFailure;

/// The paper's example.
const PAPER: &str = include_str!("paper.toml");

/// A reading of the paper's tensors: name, description, overrides.
type Reading = (&'static str, &'static str, &'static [&'static str]);

/// The readings: the default, all three tensors the identity, and all three all ones as printed.
const READINGS: [Reading; 3] = [
    ("default", "𝓜, 𝓡 all ones as printed, 𝓚 the identity", &[]),
    ("identity", "𝓜, 𝓡, 𝓚 the identity", &["material.expansion=1", "material.coupling=1", "material.conductivity=1"]),
    ("literal", "𝓜, 𝓡, 𝓚 all ones as printed; 𝓚 is singular", &["material.conductivity=[[1, 1], [1, 1]]"]),
];

const FOUNDATION: [&str; 2] = ["0", "10"];

/// Results of a reading at both temperatures of the foundation.
struct Reproduced {
    reading: Reading,
    runs: Vec<Summary>,
    studies: Vec<StudyTable>,
}

/// Makes runs, studies, figures and report in one folder. Results of an interrupted attempt are reused.
pub fn execute(levels: &[usize], reference: usize, common: &Common) -> Result<(), CommandFailure> {
    let out = common.out.clone().unwrap_or_else(|| PathBuf::from("results").join("reproduce"));
    let report = out.join("report.md");
    if report.exists() && !common.force {
        let advice = "replace it with --force, or give another folder with --out".to_owned();
        return Err(OutputError::HoldsResults { path: out, found: "a finished report".to_owned(), advice }.into());
    }
    let progress = Progress::new(common);
    let flag = progress.interrupt_flag();
    let request = StudyRequest {
        vary: Vary::Both,
        levels: levels.to_vec(),
        reference: ReferenceRequest::Level(reference),
        power: 1,
    };
    let work = ReproduceContext { source: Source::new("paper.toml", PAPER), request, progress: &progress, flag };
    let mut all = Vec::new();
    for reading in READINGS {
        let folder = out.join(reading.0);
        let mut done = Reproduced { reading, runs: Vec::new(), studies: Vec::new() };
        for foundation in FOUNDATION {
            let number = FOUNDATION.len() * all.len() + done.runs.len() + 1;
            let of = format!("{number} of {} ({}, θ_F = {foundation})", FOUNDATION.len() * READINGS.len(), reading.0);
            let mut overrides: Vec<String> = common.set.clone();
            overrides.extend(reading.2.iter().map(|&o| o.to_owned()));
            overrides.push(format!("contact.heat.foundation_temperature={foundation}"));
            done.runs.push(work.run(&overrides, &folder.join(format!("run-{foundation}")), &of)?);
            done.studies.push(work.study(&overrides, &folder.join(format!("study-{foundation}")), &of)?);
        }
        figures(&folder, reference)?;
        all.push(done);
    }
    drop(progress);
    let text = write_report(&all, levels, reference);
    std::fs::write(&report, &text).map_err(|source| OutputError::Io {
        doing: "write",
        path: report.clone(),
        source,
    })?;
    match common.format {
        OutputFormat::Json => print::json(&serde_json::json!({ "report": report, "folder": out }))?,
        OutputFormat::Text if common.quiet => {}
        OutputFormat::Text => print::text(&text)?,
    }
    Ok(())
}

/// Data common to the runs and studies.
struct ReproduceContext<'a> {
    source: Source,
    request: StudyRequest,
    progress: &'a Progress,
    flag: Arc<AtomicBool>,
}

impl ReproduceContext<'_> {
    /// Makes a run in its own folder: skipped if it is done, continued from its checkpoint if it has one, otherwise
    /// started.
    fn run(&self, overrides: &[String], folder: &Path, of: &str) -> Result<Summary, CommandFailure> {
        let case = case::parse(&self.source, overrides)?;
        if let Some(summary) = output::finished_run(folder, &case.fingerprint()) {
            return Ok(summary);
        }
        self.progress.part(&format!("run {of}"), case.problem.timeline.steps());
        let settings = Settings {
            interrupt: Some(self.flag.clone()),
            certificate: false,
            watch: Some(self.progress.watch()),
            ..Settings::default()
        };
        let options = FolderOptions { force: true, certificate: false, ..case.folder_options() };
        let mut steps = StepSink(self.progress);
        let result = match Checkpoint::read(folder, &case.identity()) {
            Ok(Some(checkpoint)) => run::resume(
                &case.problem,
                checkpoint,
                &settings,
                &mut [&mut Folder::reopen(folder, options)?, &mut steps],
            ),
            // Without a checkpoint of this case there is nothing to continue.
            _ => run::run(&case.problem, &settings, &mut [&mut Folder::create(folder, options)?, &mut steps]),
        };
        result.map_err(|error| {
            let hint = matches!(error, RunError::Interrupted(_) | RunError::Unstarted { .. })
                .then(|| "the same command goes on where it stopped".to_owned());
            CommandFailure::Run { error, hint }
        })
    }

    /// Makes a study in its own folder: reused if it is finished, else continued from its stored levels, which are then
    /// removed.
    fn study(&self, overrides: &[String], path: &Path, of: &str) -> Result<StudyTable, CommandFailure> {
        let study = case::study(&self.source, overrides, &self.request)?;
        if let Some(table) = StudyFolder::finished(path, &study) {
            return Ok(table);
        }
        let folder = StudyFolder::create(path, true)?;
        let part = format!("study {of}");
        let running = Running { part: &part, progress: self.progress, interrupt: &self.flag };
        let table = converge::study(&study, &folder, &running)?;
        converge::write(&self.source, overrides, &table, &folder)?;
        folder.seal(&study)?;
        folder.clean()?;
        Ok(table)
    }
}

/// Figures 2–5, left θ_F = 0, right θ_F = 10.
fn figures(folder: &Path, reference: usize) -> Result<(), CommandFailure> {
    let options = plot::Options { dimensionless: true, ..plot::Options::default() };
    let runs = FOUNDATION.map(|f| (format!("θ_{{F}} = {f}"), folder.join(format!("run-{f}"))));
    let panels: Vec<(&str, &Path)> = runs.iter().map(|(title, dir)| (title.as_str(), dir.as_path())).collect();
    let kinds = [
        (PictureKind::Deformed, "figure-2-deformed"),
        (PictureKind::Temperature, "figure-3-temperature"),
        (PictureKind::VonMises, "figure-4-von-mises"),
        (PictureKind::Contact, "contact"),
        (PictureKind::History, "history"),
    ];
    for (kind, name) in kinds {
        plot::side_by_side(kind, &panels, &folder.join(name), &options)?;
    }
    let mut studies = Vec::new();
    for f in FOUNDATION {
        let mut study =
            plot::ConvergencePlot::read(&folder.join(format!("study-{f}")).join("convergence.csv"), &options)?;
        study.title = format!("θ_{{F}} = {f}");
        studies.push(study);
    }
    plot::convergence_panels(&format!("Errors against h = k = 1/{reference}"), &studies)?
        .save(&folder.join("figure-5-errors"), options.pixels)?;
    Ok(())
}

/// The pictures of a reading in the report.
const PICTURES: [(&str, &str); 4] = [
    ("Figure 2: deformed body", "figure-2-deformed"),
    ("Figure 3: temperature", "figure-3-temperature"),
    ("Figure 4: von Mises stress", "figure-4-von-mises"),
    ("Figure 5: errors", "figure-5-errors"),
];

/// The orders of the studies of a reading, and their verdict on statement 2.
fn write_studies(out: &mut String, done: &Reproduced) {
    let _ = writeln!(out, "| θ_F | E^hk by level | orders | least-squares slope |\n|---|---|---|---|");
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
    let times = done.studies.iter().filter_map(|t| t.rows.last()).map(|r| format!("t = {:.4}", r.time_of_error));
    let late = times.collect::<Vec<_>>().join(" and ");
    let _ = writeln!(out, "\n{verdict} On the finest level the maximum over time is taken at {late}.\n");
}

fn write_report(all: &[Reproduced], levels: &[usize], reference: usize) -> String {
    let mut out = String::from("# The paper's section 5, recomputed\n\n");
    let _ = writeln!(
        out,
        "Runs with h = k = 1/64; errors on the levels {levels:?} against {reference}.\n\n\
         **Statement 1** (on Figures 2–4): as the foundation is warmer, deformation, stress and temperature are larger.\n\
         **Statement 2** (on Figure 5): linear convergence (4.40) is almost observed.\n"
    );
    for done in all {
        let (name, what, _) = done.reading;
        let _ = writeln!(out, "## Reading `{name}`: {what}\n");
        let _ = writeln!(out, "| | θ_F = 0 | θ_F = 10 | larger? |\n|---|---|---|---|");
        let quantity = |f: fn(&Summary) -> f64| done.runs.iter().map(f).collect::<Vec<f64>>();
        let largest = |s: &Summary| {
            s.last.displacement_max.iter().chain(&s.last.displacement_min).fold(0.0f64, |m, v| m.max(v.abs()))
        };
        let mut supported = Vec::new();
        for (label, values) in [
            ("largest displacement component", quantity(largest)),
            ("‖ε(u)‖", quantity(|s| s.last.norms.displacement_v.unwrap_or(0.0))),
            (
                "largest von Mises stress (not convergent: corners are singular)",
                quantity(|s| s.last.von_mises_max.unwrap_or(0.0)),
            ),
            ("largest temperature", quantity(|s| s.last.temperature_max.unwrap_or(0.0))),
        ] {
            if let [cold, warm] = values[..] {
                let _ = writeln!(
                    out,
                    "| {label} | {cold:.6} | {warm:.6} | {} |",
                    if warm > cold { "yes" } else { "**no**" }
                );
                supported.push(warm > cold);
            }
        }
        let verdict = if supported.iter().all(|&s| s) {
            "The numbers support statement 1."
        } else {
            "The numbers do **not** support statement 1."
        };
        let _ = writeln!(out, "\n{verdict}\n");
        write_studies(&mut out, done);
        for (title, file) in PICTURES {
            let _ = writeln!(out, "![{title}, reading {name}]({name}/{file}.png)\n");
        }
    }
    out
}
