//! `modes`: the modes of the state at the end of a run, over values of keys, and the value at which one begins to grow.

use std::path::{Path, PathBuf};

use amontons::adjoint::Parameter;
use amontons::case::{self, Case, Source};
use amontons::contact::names;
use amontons::output::{ModesFolder, ModesOf, OutputError, Sink, Snapshot, modes_json};
use amontons::plot::{self, SweepPlot, SweepSeries};
use amontons::problem::Problem;
use amontons::run::{self, FoundModes, ModeSlopesError, Settings};
use amontons::stability::{Mode, ModeCount, Modes, StabilityError};

use crate::arguments::{Common, ModesArguments, OutputFormat};
use crate::print;
use crate::progress::Progress;
use crate::status::CommandFailure;
use crate::variants::{Variant, variants};

mod critical;

/// Growth relative to |λ| up to which it is the round-off of a mode that neither grows nor decays.
pub const NEUTRAL: f64 = 1e-8;

/// Runs a case to its end and finds the modes of its last state.
pub fn execute(file: &Path, arguments: &ModesArguments, common: &Common) -> Result<(), CommandFailure> {
    let source = common.source(file)?;
    let name = case::parse(&source, &common.set)?.problem.name.clone();
    let out = common.out.clone().unwrap_or_else(|| PathBuf::from("results").join(format!("{name}-modes")));
    let progress = Progress::new(common);
    let seeker = Seeker { source: &source, common, progress: &progress, with: &arguments.with };
    // Faults of all cases are reported before the first run begins.
    let variants = variants(&arguments.each)?;
    let cases = variants.iter().map(|variant| seeker.case(variant)).collect::<Result<Vec<Case>, _>>()?;
    let folder = ModesFolder::create(&out, common.force)?;
    let (mut found, mut failed) = (Vec::new(), None);
    for part in seeker.all(&variants, &cases, &folder) {
        match part {
            Ok(part) => found.push(part),
            Err(failure) => {
                failed = Some(failure);
                break;
            }
        }
    }
    let Some(last) = found.last() else { return failed.map_or(Ok(()), Err) };
    let all: Vec<ModesOf> = found.iter().map(|(_, of)| of.clone()).collect();
    let problem = &last.0.problem;
    let mut json = modes_json(problem, &all);
    // What was found is written before anything else can fail.
    let case = cases.first().map_or(("", &[][..]), |case| (&case.text, &case.inputs));
    folder.finish(case, problem, &all, &json)?;
    picture(&name, &all, &out)?;
    if let Some(failed) = failed {
        return Err(failed);
    }
    if let Some(number) = arguments.animate {
        animate(&last.0, number.get(), &out)?;
    }
    let critical = arguments.critical.as_ref().map(|range| critical::find(&seeker, range)).transpose()?;
    if let Some((critical, object)) = critical.as_ref().zip(json.as_object_mut()) {
        object.insert("critical".to_owned(), critical.json());
        folder.finish(case, problem, &all, &json)?;
    }
    drop(progress);
    match common.format {
        OutputFormat::Json => print::json(&json)?,
        OutputFormat::Text if common.quiet => {}
        OutputFormat::Text => {
            let tables = all.iter().map(|of| told(&name, problem, of)).collect::<String>();
            let critical = critical.map_or_else(String::new, |critical| critical.text());
            print::text(&format!("{tables}{critical}  results in {}\n", out.display()))?;
        }
    }
    match all.iter().find(|of| of.modes.missing() != 0) {
        Some(of) => Err(CommandFailure::Modes(StabilityError::Missing { missing: of.modes.missing() })),
        None => Ok(()),
    }
}

/// Finds the modes of variants of a case.
pub struct Seeker<'a> {
    source: &'a Source,
    common: &'a Common,
    progress: &'a Progress,
    /// The keys by which the modes are differentiated.
    with: &'a [String],
}

/// A search with the state that it was made of.
type SearchedVariant = (FoundModes, ModesOf);

impl Seeker<'_> {
    /// The modes of all variants, one after the other, with the shapes of each written.
    fn all<'v>(
        &'v self,
        variants: &'v [Variant],
        cases: &'v [Case],
        folder: &'v ModesFolder,
    ) -> impl Iterator<Item = Result<SearchedVariant, CommandFailure>> + 'v {
        variants.iter().zip(cases).enumerate().map(move |(number, (variant, case))| {
            let found = self.find((variant, case), &format!("{} of {}", number + 1, variants.len()), self.with)?;
            let shapes = if variant.folder.is_empty() { "mode" } else { &variant.folder };
            folder.shapes(shapes, &found.problem, &found.modes)?;
            let of = ModesOf { values: variant.values.clone(), modes: found.modes.clone() };
            Ok((found, of))
        })
    }

    /// The overrides with the values of a variant.
    fn overrides(&self, variant: &Variant) -> Vec<String> {
        self.common.set.iter().cloned().chain(variant.overrides()).collect()
    }

    /// The case with the values of a variant.
    pub fn case(&self, variant: &Variant) -> Result<Case, CommandFailure> {
        Ok(case::parse(self.source, &self.overrides(variant))?)
    }

    /// Runs a case and finds the modes of its last state, with their derivatives by some keys.
    pub fn find(
        &self,
        (variant, case): (&Variant, &Case),
        part: &str,
        keys: &[String],
    ) -> Result<FoundModes, CommandFailure> {
        let overrides = self.overrides(variant);
        let parameter = |key: &String| {
            case::parameter(self.source, &overrides, key).map_err(|fault| CommandFailure::Request(fault.to_string()))
        };
        let parameters = keys.iter().map(parameter).collect::<Result<Vec<Parameter>, CommandFailure>>()?;
        self.progress.part(part, case.problem.timeline.steps());
        self.progress.begin_steps();
        let settings = Settings {
            interrupt: Some(self.progress.interrupt_flag()),
            certificate: false,
            watch: Some(self.progress.watch()),
            ..Settings::default()
        };
        let mut seen = ToldSteps { progress: self.progress };
        let found = run::modes_with(&case.problem, &case.stability, &parameters, &settings, Some(&mut seen));
        found.map_err(|error| match error {
            ModeSlopesError::Run(error) => {
                let hint = Some("modes need a state at the end of the run".to_owned());
                CommandFailure::Run { error, hint }
            }
            ModeSlopesError::Modes(error) => CommandFailure::Modes(error),
        })
    }
}

/// Tells the progress of a run.
struct ToldSteps<'a> {
    progress: &'a Progress,
}

impl Sink for ToldSteps<'_> {
    fn step(&mut self, now: &Snapshot) -> Result<(), OutputError> {
        self.progress.done(now.state.step);
        Ok(())
    }
}

/// Writes an animation of a mode.
fn animate(found: &FoundModes, number: usize, out: &Path) -> Result<(), CommandFailure> {
    let Some(mode) = found.modes.modes.get(number - 1) else {
        let count = found.modes.modes.len();
        return Err(CommandFailure::Usage(format!("--animate: found {number}, expected a mode between 1 and {count}")));
    };
    let path = out.join(format!("mode-{number}.gif"));
    Ok(plot::mode_animation(&found.problem, &found.state, mode, &path)?)
}

/// Draws frequency and growth over the first key whose values are numbers.
fn picture(name: &str, all: &[ModesOf], out: &Path) -> Result<(), CommandFailure> {
    let keys = all.first().map_or(0, |of| of.values.len());
    let number = |of: &ModesOf, key: usize| of.values.get(key).and_then(|(_, value)| value.parse::<f64>().ok());
    let Some(key) = (0..keys).find(|&key| all.len() > 1 && all.iter().all(|of| number(of, key).is_some())) else {
        return Ok(());
    };
    let most = all.iter().map(|of| of.modes.modes.len()).max().unwrap_or_default();
    let lines = |value: fn(&Mode) -> f64| -> Vec<(String, Vec<[f64; 2]>)> {
        let line = |mode: usize| {
            let point = |of: &ModesOf| Some([number(of, key)?, value(of.modes.modes.get(mode)?)]);
            (format!("{}", mode + 1), all.iter().filter_map(point).collect())
        };
        (0..most).map(line).collect()
    };
    let series = vec![
        SweepSeries { quantity: "frequency in Hz".to_owned(), lines: lines(Mode::hertz) },
        SweepSeries { quantity: "growth in 1/s".to_owned(), lines: lines(|mode| mode.growth) },
    ];
    let x_label = all.first().and_then(|of| of.values.get(key)).map_or_else(String::new, |(key, _)| key.clone());
    let drawn = plot::sweep(&SweepPlot { title: format!("{name}: modes"), x_label, series })?;
    drawn.save(&out.join("modes"), plot::Options::default().pixels)?;
    Ok(())
}

/// The table of a search as text.
fn told(name: &str, problem: &Problem, ModesOf { values, modes }: &ModesOf) -> String {
    let set: Vec<String> = values.iter().map(|(key, value)| format!(", {key} = {value}")).collect();
    let [open, stick, slip] = modes.points;
    let mut lines = vec![format!("{} modes of {name}{}", modes.kind.name(), set.concat())];
    lines.push(format!("  contact points: {open} open, {stick} stick, {slip} slip"));
    if slip == 0 {
        lines.push("  no contact point slips: friction feeds none of these modes".to_owned());
    }
    if modes.unsteady > UNSTEADY {
        lines.push(format!(
            "  the state is not steady: the body moves with up to {:.1e} of the velocity at which contacts slip",
            modes.unsteady
        ));
    }
    let contacts = names(&problem.contacts);
    let is_sector = modes.sectors > 1;
    let waves = |text: &str| if is_sector { format!(" {text:>5}") } else { String::new() };
    let header: Vec<String> = contacts.iter().map(|name| format!("{:>14}", format!("by {name}"))).collect();
    lines.push(format!(
        "  {:>4}{} {:>13} {:>14} {:>10} {:>9}{}",
        "mode",
        waves("waves"),
        "frequency/Hz",
        "growth/(1/s)",
        "damping",
        "residual",
        header.concat()
    ));
    for (number, mode) in (1..).zip(&modes.modes) {
        let by: Vec<String> = mode.by_contact.iter().map(|growth| format!("{growth:>14.5e}")).collect();
        lines.push(format!(
            "  {number:>4}{} {:>13.7e} {:>14.7e} {:>10.2e} {:>9.1e}{}",
            mode.waves.map_or_else(String::new, |number| waves(&number.to_string())),
            mode.hertz(),
            if mode.growth.abs() <= NEUTRAL * mode.frequency { 0.0 } else { mode.growth },
            if mode.growth.abs() <= NEUTRAL * mode.frequency { 0.0 } else { mode.damping_ratio() },
            mode.residual,
            by.concat()
        ));
    }
    lines.extend(differentiated(modes));
    lines.extend(counted(modes));
    lines.join("\n") + "\n"
}

/// The derivatives by parameter.
fn differentiated(modes: &Modes) -> Vec<String> {
    let mut lines = Vec::new();
    for (k, (name, value)) in modes.parameters.iter().enumerate() {
        lines.push(format!("  derivatives by m = {name} at {value:?}"));
        lines.push(format!("  {:>4} {:>16} {:>16}", "mode", "d frequency/dm", "d growth/dm"));
        for (number, mode) in (1..).zip(&modes.modes) {
            let of = |slope: Option<f64>| slope.map_or_else(|| "none".to_owned(), |slope| format!("{slope:.7e}"));
            let [growth, hertz] = mode.slope(k).map_or([None; 2], |slope| slope.map(Some));
            lines.push(format!("  {number:>4} {:>16} {:>16}", of(hertz), of(growth)));
        }
    }
    if modes.modes.iter().any(|mode| mode.slopes.iter().any(Option::is_none)) {
        lines.push("  none: there the mode meets another one, and its derivative is infinite".to_owned());
    }
    lines
}

/// How many grow, and what the counts say.
fn counted(modes: &Modes) -> Vec<String> {
    let growing = modes.modes.iter().filter(|mode| mode.growth > NEUTRAL * mode.growth.hypot(mode.frequency)).count();
    let grow = format!("  {growing} of {} grow", modes.modes.len());
    let cost = format!("({} unknowns, {} factorizations)", modes.unknowns, modes.factorizations);
    let region = |ModeCount { region, missing, .. }: &ModeCount| {
        let [from, to] = region.frequency.map(|rate| rate / std::f64::consts::TAU);
        let count = match missing {
            0 => "the count finds no other".to_owned(),
            missing => format!("the count has {missing:+} more"),
        };
        let [least, most] = region.growth;
        format!("frequencies {from:.4e} to {to:.4e} Hz, growth {least:.4e} to {most:.4e} 1/s: {count}")
    };
    match &modes.counts[..] {
        [only] if modes.sectors == 1 => vec![format!("{grow}; {} {cost}", region(only))],
        all => {
            // Numbers of waves with the same region and the same answer stand on one line.
            let same = |a: &ModeCount, b: &ModeCount| region(a) == region(b);
            let groups = all.chunk_by(same).map(|group| {
                let found: Vec<String> = group.iter().map(|count| count.modes.to_string()).collect();
                let waves = match group {
                    [first, .., last] => format!("{} to {}", first.waves, last.waves),
                    group => group.first().map_or_else(String::new, |only| only.waves.to_string()),
                };
                let region = group.first().map(region).unwrap_or_default();
                format!("  waves {waves}: {} modes in {region}", found.join(", "))
            });
            groups.chain([format!("{grow} {cost}, a body of {} sectors", modes.sectors)]).collect()
        }
    }
}

/// Velocity of the body over that of slip above which a state is called not steady.
const UNSTEADY: f64 = 1e-6;
