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

    /// The same text, which may refer only to files in the folder of the case.
    #[must_use]
    pub fn confined(self) -> Source {
        let files = match self.files {
            Files::Folder(folder) => Files::Confined(folder),
            files => files,
        };
        Source { files, ..self }
    }
}

/// Most faults that are told: who has corrected them sees the others.
const MOST: usize = 50;

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

/// A text with the beginnings of its lines, so that places in it are found without reading it again.
pub(super) struct Lines<'t> {
    text: &'t str,
    starts: Vec<usize>,
}

impl<'t> Lines<'t> {
    pub(super) fn of(text: &'t str) -> Lines<'t> {
        Lines { text, starts: std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect() }
    }

    pub(super) fn text(&self) -> &'t str {
        self.text
    }

    /// The place of a span of bytes of the text.
    pub(super) fn place(&self, span: Range<usize>) -> FaultPlace {
        let mut start = span.start.min(self.text.len());
        while !self.text.is_char_boundary(start) {
            start -= 1;
        }
        let line = self.starts.partition_point(|&first| first <= start);
        let first = line.checked_sub(1).and_then(|i| self.starts.get(i)).copied().unwrap_or(0);
        let column = self.text.get(first..start).unwrap_or_default().chars().count() + 1;
        FaultPlace::File { start, end: span.end.clamp(start, self.text.len()), line, column }
    }
}

impl FaultPlace {
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
    #[error("{}", lines(file, faults, *more))]
    Faults {
        /// The file as it is, without overrides; the spans of the faults are spans of its text.
        file: Source,
        /// The faults in the order of their places: the first of them if there are many.
        faults: Vec<CaseFault>,
        /// How many faults are left out.
        more: usize,
    },
}

impl CaseError {
    /// The error of a case with these faults, sorted by place.
    pub(super) fn faults(file: &Source, mut faults: Vec<CaseFault>) -> CaseError {
        faults.sort_by_key(|fault| fault.place.order());
        let more = faults.len().saturating_sub(MOST);
        faults.truncate(MOST);
        CaseError::Faults { file: file.clone(), faults, more }
    }
}

fn lines(file: &Source, faults: &[CaseFault], more: usize) -> String {
    let line = |fault: &CaseFault| match &fault.place {
        FaultPlace::File { line, column, .. } => format!("{}:{line}:{column}: {fault}", file.name),
        FaultPlace::Override(given) => format!("--set {given}: {fault}"),
        FaultPlace::Whole => format!("{}: {fault}", file.name),
    };
    let rest = (more > 0).then(|| format!("{}: {more} more faults", file.name));
    faults.iter().map(line).chain(rest).collect::<Vec<_>>().join("\n")
}
