//! `verify`: the shipped benchmarks, held against their references.

use std::path::Path;

use amontons::run::Settings;
use amontons::verify::{BENCHMARKS, Verdict, recompute, verify};

use crate::arguments::{Common, Format};
use crate::print;
use crate::status::Failure;

/// Runs the benchmarks whose names are given, all without names; a results folder is recomputed from its files.
pub fn execute(names: &[String], common: &Common) -> Result<(), Failure> {
    let settings = Settings { threads: common.threads.map(usize::from), certificate: false, ..Settings::default() };
    let mut verdicts: Vec<Verdict> = Vec::new();
    let mut failures: Vec<String> = Vec::new();
    let wanted = chosen(names)?;
    if common.format == Format::Text && !common.quiet {
        print::text(&header())?;
    }
    for target in wanted {
        let result = match target {
            Target::Benchmark(name, text) => verify(name, text, &settings),
            Target::Folder(folder) => recompute(Path::new(folder)),
        };
        let name = match target {
            Target::Benchmark(name, _) => name,
            Target::Folder(folder) => folder,
        };
        match result {
            Ok(found) => {
                if common.format == Format::Text && !common.quiet {
                    print::text(&found.iter().map(row).collect::<String>())?;
                }
                verdicts.extend(found);
            }
            Err(error) => failures.push(format!("{name}: {error}")),
        }
    }
    let held = verdicts.iter().filter(|v| v.holds).count();
    match common.format {
        Format::Json => {
            print::json(&serde_json::json!({ "verdicts": verdicts, "failures": failures, "holds": held == verdicts.len() && failures.is_empty() }))?;
        }
        Format::Text if common.quiet => {}
        Format::Text => print::text(&format!("{held} of {} values hold\n", verdicts.len()))?,
    }
    if failures.is_empty() && held == verdicts.len() {
        return Ok(());
    }
    failures.extend(verdicts.iter().filter(|v| !v.holds).map(|v| format!("{}: {} does not hold", v.benchmark, v.what)));
    Err(Failure::Verification(failures.join("\n")))
}

#[derive(Clone, Copy)]
enum Target<'a> {
    Benchmark(&'a str, &'a str),
    Folder(&'a str),
}

fn chosen(names: &[String]) -> Result<Vec<Target<'_>>, Failure> {
    if names.is_empty() {
        return Ok(BENCHMARKS.iter().map(|(name, text)| Target::Benchmark(name, text)).collect());
    }
    names
        .iter()
        .map(|name| match BENCHMARKS.iter().find(|(known, _)| known == name) {
            Some((name, text)) => Ok(Target::Benchmark(name, text)),
            None if Path::new(name).is_dir() => Ok(Target::Folder(name)),
            None => {
                let known: Vec<&str> = BENCHMARKS.iter().map(|(known, _)| *known).collect();
                Err(Failure::Usage(format!("{name} is neither a benchmark nor a results folder; the benchmarks are {}", known.join(", "))))
            }
        })
        .collect()
}

fn header() -> String {
    format!("{:<28} {:<46} {:>15} {:>15} {:>9} {:>9}  verdict\n", "benchmark", "value", "computed", "reference", "error", "allowed")
}

fn row(v: &Verdict) -> String {
    let verdict = if v.holds { "holds" } else { "FAILS" };
    format!("{:<28} {:<46} {:>15.8e} {:>15.8e} {:>9.1e} {:>9.1e}  {verdict}\n", v.benchmark, v.what, v.computed, v.reference, v.error, v.tolerance)
}
