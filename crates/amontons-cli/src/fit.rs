//! `fit`: the values of keys with which a run comes nearest to what was measured.

use std::path::{Path, PathBuf};

use amontons::case;
use amontons::identification::{
    DataCombination, DescentEnding, DescentState, IdentificationError, IdentificationRequest, Identified,
    IdentifiedParameter, MeasuredTable, identify,
};
use amontons::output::IdentifiedFolder;
use amontons::plot::{self, SweepPlot, SweepSeries};
use serde_json::json;

use crate::arguments::{Common, FitArguments, OutputFormat};
use crate::print;
use crate::progress::Progress;
use crate::status::CommandFailure;

/// Identifies the values, prints them, and writes them into a folder.
pub fn execute(file: &Path, arguments: &FitArguments, common: &Common) -> Result<(), CommandFailure> {
    let source = common.source(file)?;
    let case = case::parse(&source, &common.set)?;
    let out = common.out.clone().unwrap_or_else(|| PathBuf::from("results").join(format!("{}-fit", case.problem.name)));
    let told = |fault: amontons::problem::Fault| CommandFailure::Request(fault.to_string());
    let (measured, bytes) = measured(&arguments.data)?;
    let family = case::family(&source, &common.set, &arguments.free).map_err(told)?;
    let bounds = bounds(arguments)?;
    let of = format!("{}\n{}\n{:?}\n{bounds:?}", case.fingerprint(), String::from_utf8_lossy(&bytes), arguments.free);
    let (folder, from) = IdentifiedFolder::create::<DescentState>(&out, &of, common.force)?;
    let progress = Progress::new(common);
    progress.part("the first run", case.problem.timeline.steps());
    progress.begin_steps();
    let flag = progress.interrupt_flag();
    let request = IdentificationRequest {
        family: &family,
        bounds: &bounds,
        probes: &case.probes,
        measured: &measured,
        from,
        interrupt: Some(&flag),
    };
    let made = identify(&request, &mut |state| {
        progress.part(&format!("step {}, χ² {:.6e}", state.steps + 1, last(state)), case.problem.timeline.steps());
        folder.keep(state).map_err(|error| IdentificationError::Kept(Box::new(error)))
    });
    drop(progress);
    let found = made.map_err(|error| CommandFailure::Fit { error, folder: out.clone() })?;
    let values: Vec<(&str, f64)> = found.parameters.iter().map(|of| (of.name.as_str(), of.value)).collect();
    let set = case::settings(&source, &common.set, &values).map_err(told)?;
    let fitted = case::parse(&source, &common.set.iter().cloned().chain(set).collect::<Vec<_>>())?;
    let json = json!(found);
    folder.finish((&table(&found), &residuals(&found)), &json, &fitted.text, &fitted.inputs)?;
    picture(&case.problem.name, &found, &out)?;
    match common.format {
        OutputFormat::Json => print::json(&json)?,
        OutputFormat::Text if common.quiet => {}
        OutputFormat::Text => print::text(&text(&case.problem.name, &found, &out))?,
    }
    Ok(())
}

fn last(state: &DescentState) -> f64 {
    state.history.last().copied().unwrap_or(f64::NAN)
}

fn measured(path: &Path) -> Result<(MeasuredTable, Vec<u8>), CommandFailure> {
    let name = path.display().to_string();
    let told = |message: String| CommandFailure::Request(message);
    let bytes = std::fs::read(path).map_err(|error| told(format!("--data: cannot read {name}: {error}")))?;
    let table = MeasuredTable::parse(&name, &bytes).map_err(|fault| told(fault.to_string()))?;
    Ok((table, bytes))
}

/// The bounds of all keys.
fn bounds(arguments: &FitArguments) -> Result<Vec<[f64; 2]>, CommandFailure> {
    let mut all = vec![[f64::NEG_INFINITY, f64::INFINITY]; arguments.free.len()];
    for text in &arguments.bounds {
        let wrong = |found: &str| {
            CommandFailure::Usage(format!("--bounds {text}: found {found}, expected KEY=LOW,HIGH with a key of --free"))
        };
        let (key, ends) = text.rsplit_once('=').ok_or_else(|| wrong("no `=`"))?;
        let (low, high) = ends.split_once(',').ok_or_else(|| wrong("no comma"))?;
        let end = |text: &str, open: f64| match text.trim() {
            "" => Ok(open),
            text => text.parse::<f64>().ok().filter(|end| end.is_finite()).ok_or_else(|| wrong(&format!("`{text}`"))),
        };
        let ends = [end(low, f64::NEG_INFINITY)?, end(high, f64::INFINITY)?];
        let mut of = arguments.free.iter().zip(&mut all).filter(|(name, _)| *name == key.trim());
        let (_, bounds) = of.next().ok_or_else(|| wrong(&format!("the key {}", key.trim())))?;
        *bounds = ends;
    }
    Ok(all)
}

/// `fit.csv`: a row per parameter.
fn table(found: &Identified) -> String {
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:?}"));
    let mut text = "parameter,unit,start,value,deviation,low,high,at_bound\n".to_owned();
    for of in &found.parameters {
        let [low, high] = [0, 1].map(|end| number(of.interval.map(|interval| interval[end])));
        let (name, deviation) = (&of.name, number(of.deviation));
        let (unit, is_at_bound) = (&of.unit, of.is_at_bound);
        text += &format!("{name},{unit},{:?},{:?},{deviation},{low},{high},{is_at_bound}\n", of.start, of.value);
    }
    text
}

/// `residuals.csv`: a row per value.
fn residuals(found: &Identified) -> String {
    let mut text = "output,t,measured,fitted,residual,deviation\n".to_owned();
    for point in &found.points {
        let name = found.series.get(point.series).map_or("", |series| &series.name);
        let rest = point.measured - point.fitted;
        let (measured, fitted) = (point.measured, point.fitted);
        text += &format!("{name},{:?},{measured:?},{fitted:?},{rest:?},{:?}\n", point.t, point.deviation);
    }
    text
}

/// Draws each output as it was measured and as the run has it, and the residuals over their deviations.
fn picture(name: &str, found: &Identified, out: &Path) -> Result<(), CommandFailure> {
    let line = |number: usize, value: &dyn Fn(&amontons::identification::FittedPoint) -> f64| -> Vec<[f64; 2]> {
        found.points.iter().filter(|point| point.series == number).map(|point| [point.t, value(point)]).collect()
    };
    let mut series: Vec<SweepSeries> = Vec::new();
    for (number, of) in found.series.iter().enumerate() {
        let lines = vec![
            ("measured".to_owned(), line(number, &|point| point.measured)),
            ("fitted".to_owned(), line(number, &|point| point.fitted)),
        ];
        series.push(SweepSeries { quantity: of.name.clone(), lines });
    }
    let rest = |point: &amontons::identification::FittedPoint| (point.measured - point.fitted) / point.deviation;
    let lines = found.series.iter().enumerate().map(|(number, of)| (of.name.clone(), line(number, &rest))).collect();
    series.push(SweepSeries { quantity: "residual over deviation".to_owned(), lines });
    let title = format!("{name}: measured and fitted");
    let drawn = plot::sweep(&SweepPlot { title, x_label: "t in s".to_owned(), series })?;
    drawn.save(&out.join("fit"), plot::Options::default().pixels)?;
    Ok(())
}

/// The answer as text.
fn text(title: &str, found: &Identified, out: &Path) -> String {
    let count = found.points.len();
    let mut lines = vec![
        format!(
            "{title}: {} from {}, in {}",
            counted(found.parameters.len(), "parameter"),
            counted(count, "value"),
            counted(found.runs, "run")
        ),
        parameters(found),
    ];
    lines.extend(combinations(found));
    lines.extend(correlations(found));
    for of in &found.series {
        let deviation = of.deviation.map_or_else(String::new, |of| format!(", deviation taken for them {of:.3e}"));
        lines.push(format!("  {}: {} values, residuals of {:.3e} (rms){deviation}", of.name, of.count, of.rms));
        if of.is_opposite {
            let text =
                "measured values have the other sign than those of the run: forces are those on the body, in its axes";
            lines.push(format!("    {text}"));
        }
        if of.is_systematic {
            lines.push(format!(
                "    neighbouring residuals agree (correlation {:.2}): the case misses something, and the intervals are too narrow",
                of.autocorrelation
            ));
        }
    }
    lines.push(format!("  χ² {:.6e} with {} degrees of freedom", found.chi_square, found.freedom));
    let is_stated = found.series.iter().all(|of| of.deviation.is_none());
    let freedom = found.freedom as f64;
    if is_stated && found.chi_square > freedom + 4.0 * (2.0 * freedom).sqrt() {
        lines.push(
            "    more than the stated deviations let expect: the case misses something, or they are too small"
                .to_owned(),
        );
    }
    if found.ending == DescentEnding::Kink {
        lines.push("  contact points change their state at these values: the intervals hold to one side".to_owned());
    }
    lines.push(format!(
        "  results in {}, the case with these values in {}\n",
        out.display(),
        out.join("case.toml").display()
    ));
    lines.join("\n")
}

fn counted(count: usize, what: &str) -> String {
    if count == 1 { format!("1 {what}") } else { format!("{count} {what}s") }
}

fn parameters(found: &Identified) -> String {
    let title = |of: &IdentifiedParameter| match of.unit.as_str() {
        "" => of.name.clone(),
        unit => format!("{} in {unit}", of.name),
    };
    let longest = found.parameters.iter().map(|of| title(of).len()).max().unwrap_or(0).max(9);
    let mut lines = vec![format!("  {:<longest$} {:>14} {:>16}  95 % interval", "parameter", "start", "value")];
    for of in &found.parameters {
        let interval = match of.interval {
            Some([low, high]) => {
                let relative = 0.5 * (high - low) / of.value.abs();
                format!("{low:.6e} … {high:.6e}  (± {:.3} %)", 100.0 * relative)
            }
            None if found.freedom == 0 => "as many values as parameters: their spread is not known".to_owned(),
            None if of.is_at_bound => "at its bound: the data would have it beyond".to_owned(),
            None => "not determined by the data".to_owned(),
        };
        lines.push(format!("  {:<longest$} {:>14.6e} {:>16.9e}  {interval}", title(of), of.start, of.value));
    }
    lines.join("\n")
}

/// The combinations that the data do not determine, or how far they determine the worst one.
fn combinations(found: &Identified) -> Vec<String> {
    let product = |of: &DataCombination| {
        let factors = of.exponents.iter().zip(&found.parameters).filter(|(exponent, _)| exponent.abs() >= 0.05);
        factors.map(|(exponent, of)| format!("({})^{exponent:.2}", of.name)).collect::<Vec<_>>().join(" ")
    };
    let mut lines: Vec<String> = Vec::new();
    for of in found.combinations.iter().filter(|of| !of.is_determined) {
        let how = of.half_width.map_or_else(String::new, |width| format!(" (± {:.0} %)", 100.0 * width));
        lines.push(format!("  the data do not determine {}{how}", product(of)));
    }
    if let ([], [.., worst]) = (lines.as_slice(), found.combinations.as_slice())
        && found.combinations.len() > 1
    {
        let width = worst.half_width.unwrap_or(f64::INFINITY);
        lines.push(format!("  least determined combination: {} ± {:.3} %", product(worst), 100.0 * width));
    }
    lines
}

/// Pairs of parameters whose errors go together.
fn correlations(found: &Identified) -> Vec<String> {
    let mut lines = Vec::new();
    for (i, row) in found.correlations.iter().enumerate() {
        for (j, value) in row.iter().enumerate().skip(i + 1) {
            if let (Some(value), Some(a), Some(b)) = (value, found.parameters.get(i), found.parameters.get(j)) {
                lines.push(format!("  correlation of {} and {}: {value:.3}", a.name, b.name));
            }
        }
    }
    lines
}
