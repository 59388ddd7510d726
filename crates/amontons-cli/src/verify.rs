//! `verify`: compares cases and the shipped benchmarks with their references.

use std::path::Path;

use amontons::case::Source;
use amontons::run::Settings;
use amontons::verify::{BENCHMARKS, Recomputed, Verdict, VerifyError, benchmark, recompute, verify_case};

use crate::arguments::{Common, OutputFormat};
use crate::print;
use crate::status::CommandFailure;

/// Evaluates the named benchmarks, case files and results folders, or all benchmarks without names.
pub fn execute(names: &[String], common: &Common) -> Result<(), CommandFailure> {
    let settings = Settings { certificate: false, ..Settings::default() };
    let mut verdicts: Vec<Verdict> = Vec::new();
    let (mut failures, mut unchecked): (Vec<String>, Vec<String>) = (Vec::new(), Vec::new());
    let wanted = chosen(names, common)?;
    let speaks = common.format == OutputFormat::Text && !common.quiet;
    if speaks {
        print::text(&header())?;
    }
    for target in &wanted {
        match target.verify(&common.set, &settings) {
            Ok(found) => {
                if speaks {
                    print::text(&found.verdicts.iter().map(row).collect::<String>())?;
                    let untold = found.unchecked.iter().map(|what| format!("not checked: {what}\n"));
                    print::text(&untold.collect::<String>())?;
                }
                verdicts.extend(found.verdicts);
                failures.extend(found.faults.into_iter().map(|fault| format!("{}: {fault}", target.name())));
                unchecked.extend(found.unchecked);
            }
            // A single case fails with its run; of several the others continue.
            Err(error) if wanted.len() == 1 => return Err(error.into()),
            Err(error) => failures.push(format!("{}: {error}", target.name())),
        }
    }
    let held = verdicts.iter().filter(|v| v.holds).count();
    let all_hold = failures.is_empty() && held == verdicts.len();
    if speaks {
        print::text(&format!("{held} of {} values hold\n", verdicts.len()))?;
    }
    let table = serde_json::json!({
        "verdicts": verdicts, "failures": failures, "unchecked": unchecked, "holds": all_hold,
    });
    if all_hold {
        return if common.format == OutputFormat::Json { Ok(print::json(&table)?) } else { Ok(()) };
    }
    failures.extend(verdicts.iter().filter(|v| !v.holds).map(|v| format!("{}: {} does not hold", v.benchmark, v.what)));
    Err(CommandFailure::Verification { message: failures.join("\n"), table })
}

/// The item that is evaluated.
enum VerifyTarget<'a> {
    /// A shipped benchmark or a case file.
    Case(Source),
    Folder(&'a str),
}

impl VerifyTarget<'_> {
    fn name(&self) -> &str {
        match self {
            VerifyTarget::Case(source) => &source.name,
            VerifyTarget::Folder(folder) => folder,
        }
    }

    fn verify(&self, overrides: &[String], settings: &Settings) -> Result<Recomputed, VerifyError> {
        match self {
            VerifyTarget::Case(source) => {
                let verdicts = verify_case(source, overrides, settings)?;
                Ok(Recomputed { verdicts, ..Recomputed::default() })
            }
            VerifyTarget::Folder(folder) => recompute(Path::new(folder)),
        }
    }
}

fn chosen<'a>(names: &'a [String], common: &Common) -> Result<Vec<VerifyTarget<'a>>, CommandFailure> {
    if names.is_empty() {
        return Ok(BENCHMARKS
            .iter()
            .map(|(name, text)| VerifyTarget::Case(common.team.source(benchmark(name, text))))
            .collect());
    }
    let target = |name: &'a String| match BENCHMARKS.iter().find(|(known, _)| known == name) {
        Some((name, text)) => Ok(VerifyTarget::Case(common.team.source(benchmark(name, text)))),
        None if Path::new(name).is_dir() && common.set.is_empty() => Ok(VerifyTarget::Folder(name)),
        None if Path::new(name).is_dir() => Err(CommandFailure::Usage(format!(
            "{name} is a results folder, whose figures are recomputed from its files: --set has no meaning there; verify the case file instead"
        ))),
        None if Path::new(name).is_file() => Ok(VerifyTarget::Case(common.source(Path::new(name))?)),
        None => {
            let known: Vec<&str> = BENCHMARKS.iter().map(|(known, _)| *known).collect();
            Err(CommandFailure::Usage(format!(
                "{name} is no case file, no results folder and no benchmark; the benchmarks are {}",
                known.join(", ")
            )))
        }
    };
    names.iter().map(target).collect()
}

fn header() -> String {
    format!(
        "{:<28} {:<46} {:>15} {:>15} {:>9} {:>9}  verdict\n",
        "case", "value", "computed", "reference", "error", "allowed"
    )
}

fn row(v: &Verdict) -> String {
    let verdict = if v.holds { "holds" } else { "FAILS" };
    format!(
        "{:<28} {:<46} {:>15.8e} {:>15.8e} {:>9.1e} {:>9.1e}  {verdict}\n",
        v.benchmark, v.what, v.computed, v.reference, v.error, v.tolerance
    )
}
