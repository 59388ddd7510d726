//! Finds the place in the file, or the override, where the value at a path comes from.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::fault::{CaseFault, FaultPlace, Lines};
use super::path::{Path, Segment};
use crate::problem::Fault;

/// The part of an entry that a finding is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum At {
    /// The key.
    Key,
    /// The value.
    Value,
    /// A byte inside the text of the value, which is a string.
    Inside(usize),
    /// The table that lacks the entry.
    Missing,
}

/// A fault by its path, before its place is looked up.
#[derive(Clone, Debug)]
pub(super) struct PathFault {
    pub path: Path,
    pub at: At,
    pub found: String,
    pub expected: String,
    pub hint: Option<String>,
}

impl PathFault {
    /// A finding without a hint.
    pub fn new(path: Path, at: At, found: impl Into<String>, expected: impl Into<String>) -> PathFault {
        PathFault { path, at, found: found.into(), expected: expected.into(), hint: None }
    }

    /// Adds a hint to the finding, if there is one.
    pub fn hint(mut self, hint: Option<String>) -> PathFault {
        self.hint = hint;
        self
    }
}

impl From<Fault> for PathFault {
    fn from(fault: Fault) -> PathFault {
        let path = Path::parse(&fault.path).unwrap_or_default();
        PathFault::new(path, At::Value, fault.found, fault.expected).hint(fault.hint)
    }
}

/// The file and the overrides that a case was read from.
pub(super) struct CaseOrigin<'a> {
    pub lines: Lines<'a>,
    /// The document in the file, before overrides.
    pub document: &'a DeTable<'a>,
    /// The overrides: the paths that were set, and the overrides as given.
    pub overrides: &'a [(Path, String)],
}

impl CaseOrigin<'_> {
    /// Looks up the place of a finding.
    pub fn locate(&self, finding: PathFault) -> CaseFault {
        let place = self.place(&finding.path, finding.at);
        let PathFault { path, found, expected, hint, .. } = finding;
        CaseFault { place, path: path.to_string(), found, expected, hint }
    }

    fn place(&self, path: &Path, at: At) -> FaultPlace {
        if let Some((_, given)) = self.overrides.iter().rev().find(|(set, _)| path.is_at_or_below(set)) {
            return FaultPlace::Override(given.clone());
        }
        let entry = self.entry(path);
        let span = match (entry, at) {
            (Some((key, _)), At::Key) => key,
            (Some((_, value)), At::Inside(offset)) => self.inside(value, offset),
            (Some((_, value)), _) => value,
            // A table that is missing in the file was made by an override.
            (None, _) => {
                if let Some((_, given)) = self.overrides.iter().rev().find(|(set, _)| set.is_at_or_below(path)) {
                    return FaultPlace::Override(given.clone());
                }
                return match path.parent() {
                    Some(parent) if !parent.0.is_empty() => self.place_of_table(&parent),
                    _ => FaultPlace::Whole,
                };
            }
        };
        self.lines.place(span)
    }

    /// The place of a table with a missing key: its header, or the override that made it.
    fn place_of_table(&self, path: &Path) -> FaultPlace {
        match self.entry(path) {
            Some((_, span)) => self.lines.place(span),
            None => self.place(path, At::Missing),
        }
    }

    /// The spans of the key and the value at a path.
    fn entry(&self, path: &Path) -> Option<(Range<usize>, Range<usize>)> {
        let (first, rest) = path.0.split_first()?;
        let Segment::Key(first) = first else { return None };
        let (mut key, mut value) = key_value(self.document, first)?;
        for segment in rest {
            match (segment, value.get_ref()) {
                (Segment::Key(name), DeValue::Table(table)) => (key, value) = key_value(table, name)?,
                (Segment::Index(index), DeValue::Array(array)) => {
                    value = array.get(*index)?;
                    key = value.span();
                }
                _ => return None,
            }
        }
        Some((key, value.span()))
    }

    /// The place in the file of a byte of a string. `span` is the span of the string with its quotes.
    fn inside(&self, span: Range<usize>, offset: usize) -> Range<usize> {
        let Some(raw) = self.lines.text().get(span.clone()) else { return span };
        let quote = ["\"\"\"", "'''", "\"", "'"].into_iter().find(|q| raw.starts_with(q)).map_or(0, str::len);
        let after = raw.get(quote..).unwrap_or_default();
        let newline = match after {
            _ if quote < 3 => 0,
            _ if after.starts_with("\r\n") => 2,
            _ => usize::from(after.starts_with('\n')),
        };
        let start = quote + newline + offset;
        // Bytes cannot be counted through escapes.
        let countable = raw.get(..start).is_some_and(|before| raw.starts_with('\'') || !before.contains('\\'));
        if !countable {
            return span;
        }
        let end = start + raw.get(start..).and_then(|rest| rest.chars().next()).map_or(0, char::len_utf8);
        span.start + start..span.start + end
    }
}

fn key_value<'t, 'i>(table: &'t DeTable<'i>, name: &str) -> Option<(Range<usize>, &'t Spanned<DeValue<'i>>)> {
    table.get_key_value(name).map(|(key, value)| (key.span(), value))
}
