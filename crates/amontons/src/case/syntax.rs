//! Errors of the TOML parser as faults.

use std::ops::Range;

use super::fault::{CaseFault, FaultPlace, Lines};

/// An error of the TOML parser: its message and its place.
pub(super) type SyntaxError = (String, Option<Range<usize>>);

/// The kind of error found by the TOML parser. The parser reports it in words only, which are interpreted here and
/// nowhere else.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum SyntaxFault {
    /// A duplicate key; the rest of the text can be read.
    Duplicate,
    /// Elements of an array without a comma between them; the rest is misread.
    MissingComma,
    /// An unclosed bracket, with the expected one; the rest is misread.
    Unclosed(String),
    /// A missing value, or a string without quotes.
    NoValue,
    /// Something that should not be there.
    Superfluous,
    /// Any other error, with the expected text.
    Other(String),
}

impl SyntaxFault {
    pub(super) fn of(message: &str) -> SyntaxFault {
        const VALID: &str = "valid TOML";
        let (what, expected) = message.split_once(", expected ").unwrap_or((message, VALID));
        match (what, expected) {
            ("duplicate key", _) => SyntaxFault::Duplicate,
            ("missing comma between array elements", _) => SyntaxFault::MissingComma,
            (_, "literal string") => SyntaxFault::NoValue,
            _ if what.starts_with("unclosed") => {
                SyntaxFault::Unclosed(if expected == "nothing" { VALID } else { expected }.to_owned())
            }
            (_, "nothing") => SyntaxFault::Superfluous,
            _ => SyntaxFault::Other(expected.to_owned()),
        }
    }
}

/// The faults of a text, and true if all of them are duplicate keys, so that the rest of the text can be read.
pub(super) struct SyntaxFaults {
    pub faults: Vec<CaseFault>,
    pub only_duplicates: bool,
}

/// One fault per line: further errors of a line are mostly consequences of the first.
pub(super) fn faults(text: &str, mut errors: Vec<SyntaxError>) -> SyntaxFaults {
    errors.sort_by_key(|(_, span)| span.as_ref().map_or(0, |s| s.start));
    let mut faults: Vec<(usize, CaseFault)> = Vec::new();
    let mut only_duplicates = true;
    let lines = Lines::of(text);
    for (message, span) in errors {
        let kind = SyntaxFault::of(&message);
        let span = span.unwrap_or(0..0);
        let place = lines.place(span.clone());
        let FaultPlace::File { line, .. } = place else { continue };
        if faults.last().is_none_or(|(last, _)| *last != line) {
            only_duplicates &= kind == SyntaxFault::Duplicate;
            faults.push((line, fault(text, &message, &kind, span, place)));
        }
        if matches!(kind, SyntaxFault::Unclosed(_) | SyntaxFault::MissingComma) {
            break;
        }
    }
    SyntaxFaults { faults: faults.into_iter().map(|(_, fault)| fault).collect(), only_duplicates }
}

fn fault(text: &str, message: &str, kind: &SyntaxFault, span: Range<usize>, place: FaultPlace) -> CaseFault {
    let (found, at_end) = excerpt(text, span);
    let what = || message.split_once(", expected ").map_or(message, |(what, _)| what).to_owned();
    let (found, expected, hint) = match kind {
        SyntaxFault::Duplicate => (format!("{found} again"), "each key once in its table".to_owned(), None),
        SyntaxFault::NoValue if at_end => (found, "a value".to_owned(), None),
        SyntaxFault::NoValue => (found, "a value".to_owned(), Some("put strings in quotes".to_owned())),
        SyntaxFault::MissingComma => (found, "`,` or `]`".to_owned(), Some("close the array before it".to_owned())),
        SyntaxFault::Superfluous => (found, "valid TOML".to_owned(), Some(what())),
        SyntaxFault::Other(expected) | SyntaxFault::Unclosed(expected) => (found, expected.clone(), Some(what())),
    };
    CaseFault { place, path: String::new(), found, expected, hint }
}

/// The text at a span, or right after it if it is empty, and true if that is the end of the file or of a line.
fn excerpt(text: &str, span: Range<usize>) -> (String, bool) {
    const LONGEST: usize = 30;
    let start = span.start;
    match text.get(span).and_then(|t| t.lines().next()).filter(|t| !t.trim().is_empty()) {
        Some(found) => (format!("`{}`", found.chars().take(LONGEST).collect::<String>().escape_debug()), false),
        None => match text.get(start..).and_then(|rest| rest.chars().next()) {
            None => ("the end of the file".to_owned(), true),
            Some('\n' | '\r') => ("the end of the line".to_owned(), true),
            Some(c) => (format!("`{}`", c.escape_debug()), false),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The words of the parser are known; it gives no other information.
    #[test]
    fn the_words_of_the_parser_are_known() {
        let kinds = |text: &str| -> Vec<SyntaxFault> {
            toml::de::DeTable::parse_recoverable(text).1.iter().map(|error| SyntaxFault::of(error.message())).collect()
        };
        assert_eq!(kinds("a = 1\na = 2\n"), [SyntaxFault::Duplicate]);
        assert_eq!(kinds("a = [\"x\" \"y\"]\n"), [SyntaxFault::MissingComma]);
        assert_eq!(kinds("a = word\n"), [SyntaxFault::NoValue]);
        assert!(matches!(kinds("a = [1, 2\n")[..], [SyntaxFault::Unclosed(_), ..]));
        assert!(kinds("a = 1\n").is_empty());
    }
}
