//! What the TOML parser says, as faults.

use std::ops::Range;

use super::fault::{CaseFault, Place};

/// An error of the TOML parser: its message and its place.
pub(super) type SyntaxError = (String, Option<Range<usize>>);

/// What is expected of a key.
const ONCE: &str = "each key once in its table";

/// One fault a line: further errors of a line are mostly consequences of the first.
pub(super) fn faults(text: &str, mut errors: Vec<SyntaxError>) -> Vec<CaseFault> {
    errors.sort_by_key(|(_, span)| span.as_ref().map_or(0, |s| s.start));
    let mut faults: Vec<(usize, CaseFault)> = Vec::new();
    for (message, span) in errors {
        let span = span.unwrap_or(0..0);
        let place = Place::in_file(text, span.clone());
        let Place::File { line, .. } = place else { continue };
        if faults.last().is_none_or(|(last, _)| *last != line) {
            faults.push((line, fault(text, &message, span, place)));
        }
        // Behind a bracket that is not closed everything is misread.
        if message.starts_with("unclosed") || message.starts_with("missing comma") {
            break;
        }
    }
    faults.into_iter().map(|(_, fault)| fault).collect()
}

/// Whether a fault is a key given twice, behind which the rest of the text can be read.
pub(super) fn is_duplicate(fault: &CaseFault) -> bool {
    fault.path.is_empty() && fault.expected == ONCE
}

fn fault(text: &str, message: &str, span: Range<usize>, place: Place) -> CaseFault {
    let found = excerpt(text, span);
    let (what, expected) = message.split_once(", expected ").unwrap_or((message, "valid TOML"));
    let (found, expected, hint) = match (what, expected) {
        ("duplicate key", _) => (format!("{found} again"), ONCE.to_owned(), None),
        (_, "literal string") if found.starts_with("the end") => (found, "a value".to_owned(), None),
        (_, "literal string") => (found, "a value".to_owned(), Some("put strings in quotes".to_owned())),
        ("missing comma between array elements", _) => (found, "`,` or `]`".to_owned(), Some("close the array before it".to_owned())),
        (_, "nothing") => (found, "valid TOML".to_owned(), Some(what.to_owned())),
        _ => (found, expected.to_owned(), Some(what.to_owned())),
    };
    CaseFault { place, path: String::new(), found, expected, hint }
}

/// What stands at a span, or right behind it if it is empty.
fn excerpt(text: &str, span: Range<usize>) -> String {
    const LONGEST: usize = 30;
    let start = span.start;
    match text.get(span).and_then(|t| t.lines().next()).filter(|t| !t.trim().is_empty()) {
        Some(found) => format!("`{}`", found.chars().take(LONGEST).collect::<String>().escape_debug()),
        None => match text.get(start..).and_then(|rest| rest.chars().next()) {
            None => "the end of the file".to_owned(),
            Some('\n' | '\r') => "the end of the line".to_owned(),
            Some(c) => format!("`{}`", c.escape_debug()),
        },
    }
}
