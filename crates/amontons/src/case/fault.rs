//! Faults of a case file and how they read.

use std::fmt;
use std::io;
use std::ops::Range;
use std::path::PathBuf;

use super::files::Files;

/// The text of a case, the name that messages call it by, and the files that it may refer to.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Source {
    /// Name shown in messages, usually the file name as given.
    pub name: String,
    /// The TOML text.
    pub text: String,
    /// The files that it may refer to.
    pub files: Files,
}

impl Source {
    /// A text that refers to no files.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Source {
        Source { name: name.into(), text: text.into(), files: Files::None }
    }
}

/// Where a fault is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FaultPlace {
    /// In the file.
    File {
        /// First byte in the text.
        start: usize,
        /// Byte behind the last one.
        end: usize,
        /// Line, from 1.
        line: usize,
        /// Column in characters, from 1.
        column: usize,
    },
    /// In an override, given as `KEY=VALUE`.
    Override(String),
    /// In the file as a whole: something that should be in it is not.
    Whole,
}

impl FaultPlace {
    /// The place of a span of bytes of a text.
    pub(super) fn in_file(text: &str, span: Range<usize>) -> FaultPlace {
        let mut start = span.start.min(text.len());
        while !text.is_char_boundary(start) {
            start -= 1;
        }
        let before = text.get(..start).unwrap_or_default();
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        FaultPlace::File { start, end: span.end.clamp(start, text.len()), line, column }
    }

    /// Faults of the whole come first, then those in the file, then those of overrides.
    fn order(&self) -> (u8, usize) {
        match self {
            FaultPlace::Whole => (0, 0),
            FaultPlace::File { start, .. } => (1, *start),
            FaultPlace::Override(_) => (2, 0),
        }
    }
}

/// One fault of a case: where, what was found, what was expected, what to try.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CaseFault {
    /// Where it is.
    pub place: FaultPlace,
    /// Dotted path of the datum, `boundary[1].on`; empty if the text is no TOML.
    pub path: String,
    /// What was found.
    pub found: String,
    /// What was expected.
    pub expected: String,
    /// What to try.
    pub hint: Option<String>,
}

impl fmt::Display for CaseFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.path.is_empty() {
            write!(f, "{}: ", self.path)?;
        }
        write!(f, "found {}, expected {}", self.found, self.expected)?;
        match &self.hint {
            Some(hint) => write!(f, "; {hint}"),
            None => Ok(()),
        }
    }
}

/// Why there is no case.
#[derive(Debug, thiserror::Error)]
pub enum CaseError {
    /// The file could not be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What went wrong, with what to try.
        source: io::Error,
    },
    /// The file, or an override, has faults. One per line: `file:line:column: path: found …, expected …; hint`.
    #[error("{}", lines(file, faults))]
    Faults {
        /// The file as it is, without overrides; the spans of the faults are spans of its text.
        file: Source,
        /// The faults in the order of their places.
        faults: Vec<CaseFault>,
    },
}

impl CaseError {
    /// The error of a case with these faults, sorted by place.
    pub(super) fn faults(file: &Source, mut faults: Vec<CaseFault>) -> CaseError {
        faults.sort_by_key(|fault| fault.place.order());
        CaseError::Faults { file: file.clone(), faults }
    }
}

fn lines(file: &Source, faults: &[CaseFault]) -> String {
    let line = |fault: &CaseFault| match &fault.place {
        FaultPlace::File { line, column, .. } => format!("{}:{line}:{column}: {fault}", file.name),
        FaultPlace::Override(given) => format!("--set {given}: {fault}"),
        FaultPlace::Whole => format!("{}: {fault}", file.name),
    };
    faults.iter().map(line).collect::<Vec<_>>().join("\n")
}
