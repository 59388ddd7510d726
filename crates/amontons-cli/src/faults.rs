//! Faults of a case file with excerpts of it.

use std::io::{self, IsTerminal, Write};

use amontons::case::{CaseFault, FaultPlace, Source};
use ariadne::{Color, Config, IndexType, Label, Report, ReportKind};
use serde_json::{Value, json};

use crate::plain;

/// Longest line in bytes of which an excerpt is shown.
const LONGEST: usize = 1000;

/// Prints all faults with their places and their number.
pub fn print(file: &Source, faults: &[CaseFault], more: usize) {
    let mut text = Vec::new();
    // Writing into memory does not fail.
    let _ = write(file, (faults, more), colours(), &mut text);
    // If standard error fails, nothing can be reported.
    let _ = io::stderr().lock().write_all(&text);
}

/// True if standard error shows colours.
fn colours() -> bool {
    io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

fn write(file: &Source, (faults, more): (&[CaseFault], usize), colours: bool, out: &mut Vec<u8>) -> io::Result<()> {
    let name = &*plain::plain(&file.name);
    let text = plain::same_length(&file.text);
    let mut source = (name, ariadne::Source::from(&*text));
    for fault in faults {
        let message = plain::message(&if fault.path.is_empty() {
            format!("found {}", fault.found)
        } else {
            format!("{}: found {}", fault.path, fault.found)
        });
        let expected = plain::message(&fault.expected);
        let hint = fault.hint.as_deref().map(plain::message);
        let apart =
            |place: &str, out: &mut Vec<u8>| without_excerpt(place, [&message, &expected], hint.as_deref(), out);
        match &fault.place {
            FaultPlace::File { line, column, .. }
                if text.lines().nth(line - 1).is_some_and(|it| it.len() > LONGEST) =>
            {
                apart(&format!("{name}, line {line}, column {column}"), out)?;
            }
            FaultPlace::File { start, end, .. } => {
                let span = || (name, *start..*end);
                let config = Config::new().with_index_type(IndexType::Byte).with_color(colours);
                let label = Label::new(span()).with_message(format!("expected {expected}")).with_color(Color::Red);
                let mut report = Report::build(ReportKind::Error, span())
                    .with_config(config)
                    .with_message(&message)
                    .with_label(label);
                if let Some(hint) = &hint {
                    report = report.with_help(hint);
                }
                report.finish().write(&mut source, &mut *out)?;
            }
            FaultPlace::Override(given) => apart(&format!("--set {}", plain::message(given)), out)?,
            FaultPlace::Whole => apart(name, out)?,
        }
        writeln!(out)?;
    }
    let count = faults.len() + more;
    let told = if more > 0 { format!(", the first {} of them are told", faults.len()) } else { String::new() };
    writeln!(out, "{name}: {count} fault{}{told}", if count == 1 { "" } else { "s" })
}

fn without_excerpt(place: &str, words: [&str; 2], hint: Option<&str>, out: &mut Vec<u8>) -> io::Result<()> {
    let [message, expected] = words;
    writeln!(out, "Error: {message}\n   in {place}\n   expected {expected}")?;
    match hint {
        Some(hint) => writeln!(out, "   Help: {hint}"),
        None => Ok(()),
    }
}

/// The faults as JSON.
pub fn json(file: &Source, faults: &[CaseFault]) -> Value {
    let one = |fault: &CaseFault| {
        let place = match &fault.place {
            FaultPlace::File { start, end, line, column } => {
                json!({ "file": file.name, "line": line, "column": column, "start": start, "end": end })
            }
            FaultPlace::Override(given) => json!({ "override": given }),
            FaultPlace::Whole => json!({ "file": file.name }),
        };
        json!({ "path": fault.path, "where": place, "found": fault.found, "expected": fault.expected, "hint": fault.hint })
    };
    faults.iter().map(one).collect()
}
