//! Faults of a case file and their messages.

use std::fmt;
use std::io;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use super::files::Files;
use crate::linalg::Backend;

/// The text of a case, its name in messages, and the files that it may refer to.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Source {
    /// Name shown in messages, usually the file name as given.
    pub name: String,
    /// The TOML text.
    pub text: String,
    /// The files that it may refer to.
    pub files: Files,
    /// The backend that solves its linear systems in place of that of `solver.solver`, if any.
    pub backend: GivenBackend,
}

/// A backend that a program gives to a case, or none.
#[derive(Clone, Debug, Default)]
pub struct GivenBackend(Option<Arc<dyn Backend>>);

impl GivenBackend {
    /// The backend, or `None` if the case chooses its own.
    pub(super) fn get(&self) -> Option<&Arc<dyn Backend>> {
        self.0.as_ref()
    }
}

impl PartialEq for GivenBackend {
    fn eq(&self, other: &GivenBackend) -> bool {
        match (self.get(), other.get()) {
            (Some(own), Some(other)) => Arc::ptr_eq(own, other),
            (own, other) => own.is_none() && other.is_none(),
        }
    }
}

impl Eq for GivenBackend {}

impl Source {
    /// The text with a file in memory, under a name that it may use.
    #[must_use]
    pub fn with_file(&self, name: &str, bytes: impl Into<Arc<[u8]>>) -> Source {
        let file = Box::new((name.to_owned(), bytes.into(), self.files.clone()));
        Source { files: Files::With(file), ..self.clone() }
    }

    /// A text that refers to no files.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Source {
        Source { name: name.into(), text: text.into(), files: Files::None, backend: GivenBackend::default() }
    }

    /// Solves the linear systems of the case with this backend.
    #[must_use]
    pub fn solved_by(self, backend: Arc<dyn Backend>) -> Source {
        Source { backend: GivenBackend(Some(backend)), ..self }
    }

    /// Restricts the source to files in the folder of the case.
    #[must_use]
    pub fn confined(self) -> Source {
        let files = match self.files {
            Files::Folder(folder) => Files::Confined(folder),
            files => files,
        };
        Source { files, ..self }
    }
}

/// Largest number of faults shown; the others appear when these are corrected.
const MOST: usize = 50;

/// The place of a fault.
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
    /// The file as a whole, if something is missing in it.
    Whole,
}

/// A text with the starts of its lines, so that places are found without another pass.
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
    /// Order of faults: whole file, places in the file, overrides.
    fn order(&self) -> (u8, usize) {
        match self {
            FaultPlace::Whole => (0, 0),
            FaultPlace::File { start, .. } => (1, *start),
            FaultPlace::Override(_) => (2, 0),
        }
    }
}

/// One fault of a case: place, found, expected, hint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CaseFault {
    /// Its place.
    pub place: FaultPlace,
    /// Dotted path of the datum, `boundary[1].on`; empty if the text is no TOML.
    pub path: String,
    /// The value found, or a description of it.
    pub found: String,
    /// The values that are allowed.
    pub expected: String,
    /// Instruction how to correct it.
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

/// The reason why there is no case.
#[derive(Debug, thiserror::Error)]
pub enum CaseError {
    /// The file could not be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The error of the system, with a hint.
        source: io::Error,
    },
    /// The file, or an override, has faults. One per line: `file:line:column: path: found …, expected …; hint`.
    #[error("{}", lines(file, faults, *more))]
    Faults {
        /// The file as it is, without overrides; the spans of the faults are spans of its text.
        file: Box<Source>,
        /// The faults in the order of their places: the first of them if there are many.
        faults: Vec<CaseFault>,
        /// Number of faults left out.
        more: usize,
    },
}

impl CaseError {
    /// The error of a case with these faults, sorted by place.
    pub(super) fn faults(file: &Source, mut faults: Vec<CaseFault>) -> CaseError {
        faults.sort_by_key(|fault| fault.place.order());
        let more = faults.len().saturating_sub(MOST);
        faults.truncate(MOST);
        CaseError::Faults { file: Box::new(file.clone()), faults, more }
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
