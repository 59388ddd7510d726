//! `*INCLUDE`: replaces these lines by the text of the included files.
//!
//! A file name is relative to the folder of the including file. The origin of every line is recorded, so that messages
//! name the file and its line. In the whole text a comment replaces the keyword.

use std::borrow::Cow;
use std::path::PathBuf;

use super::super::read::{FilePosition, Include, MeshFileError, Skipped};

/// Largest depth of nested includes; Abaqus allows five.
const DEEPEST: usize = 16;
/// Largest number of included files.
const MOST: usize = 1000;
/// Longest whole text in bytes, as for a single file.
const LONGEST: usize = 4 << 30;

/// A text with the origin of its lines.
pub(super) struct JoinedText<'a> {
    pub bytes: Cow<'a, [u8]>,
    stretches: Vec<Stretch>,
    /// Names of the files; the first is the mesh file.
    names: Vec<String>,
}

/// Consecutive lines from one file.
#[derive(Clone, Copy)]
struct Stretch {
    /// Its first line in the whole text, from 1.
    first: usize,
    file: usize,
    /// Number of that line in its file.
    line: usize,
}

impl<'a> JoinedText<'a> {
    /// The text of a file of this name.
    ///
    /// # Errors
    /// Fails if an included file cannot be read, includes itself, or is nested too deep, or if the text is too long.
    pub fn of(name: &str, bytes: &'a [u8], include: Option<&mut Include>) -> Result<JoinedText<'a>, MeshFileError> {
        let stretch = Stretch { first: 1, file: 0, line: 1 };
        if !lines(bytes).any(|(_, text)| is_include(text)) {
            return Ok(JoinedText {
                bytes: Cow::Borrowed(bytes),
                stretches: vec![stretch],
                names: vec![name.to_owned()],
            });
        }
        let longest = crate::machine::memory().map_or(LONGEST, |memory| LONGEST.min((memory.bytes / 4.0) as usize));
        let text = JoinedText { bytes: Cow::Owned(Vec::new()), stretches: Vec::new(), names: Vec::new() };
        let mut made = Making { text, lines: 0, longest, open: Vec::new(), include };
        made.take(name, bytes)?;
        Ok(made.text)
    }

    /// True if it includes other files.
    pub fn includes(&self) -> bool {
        matches!(self.bytes, Cow::Owned(_))
    }

    /// File and line of a line of the whole text; the file is `None` for the mesh file itself.
    fn place(&self, line: usize) -> (Option<&String>, usize) {
        let at = self.stretches.partition_point(|stretch| stretch.first <= line).saturating_sub(1);
        let Some(Stretch { first, file, line: own }) = self.stretches.get(at).copied() else { return (None, line) };
        (self.names.get(file).filter(|_| file > 0), own + line.saturating_sub(first))
    }

    /// An error in the whole text, located in its file.
    pub fn told(&self, fault: MeshFileError) -> MeshFileError {
        let Some(FilePosition::Line(line)) = fault.at() else { return fault };
        let (file, line) = self.place(line);
        inside(file, fault.in_line(line))
    }

    /// A skipped item, located in its file.
    pub fn located(&self, skipped: Skipped) -> Skipped {
        let Some(line) = skipped.line else { return skipped };
        let (file, line) = self.place(line);
        Skipped { file: file.cloned(), line: Some(line), ..skipped }
    }
}

/// The error in the file of this name, unless it is the mesh file.
fn inside(file: Option<&String>, fault: MeshFileError) -> MeshFileError {
    match file {
        Some(file) => MeshFileError::In { path: PathBuf::from(file), fault: Box::new(fault) },
        None => fault,
    }
}

/// A whole text under construction.
struct Making<'i, 'f, 'a> {
    text: JoinedText<'a>,
    /// Lines of the text so far.
    lines: usize,
    longest: usize,
    /// Names of the files that include each other, from the first to the current one.
    open: Vec<String>,
    include: Option<&'i mut Include<'f>>,
}

impl Making<'_, '_, '_> {
    /// Adds the file of a name.
    fn take(&mut self, name: &str, bytes: &[u8]) -> Result<(), MeshFileError> {
        let file = self.text.names.len();
        self.text.names.push(name.to_owned());
        self.open.push(name.to_owned());
        self.text.stretches.push(Stretch { first: self.lines + 1, file, line: 1 });
        let mut all = lines(bytes);
        while let Some((line, text)) = all.next() {
            if !is_include(text) {
                self.push(text);
                continue;
            }
            // A keyword that ends with a comma continues on the next line.
            let (mut keyword, mut last) = (text.to_vec(), line);
            while keyword.trim_ascii_end().ends_with(b",") {
                let Some((line, more)) = all.next() else { break };
                keyword.extend(more);
                last = line;
            }
            let own = name.to_owned();
            self.include(&keyword, line).map_err(|fault| match fault {
                MeshFileError::In { .. } => fault,
                fault => inside(Some(&own).filter(|_| file > 0), fault),
            })?;
            self.text.stretches.push(Stretch { first: self.lines + 1, file, line: last + 1 });
        }
        self.open.pop();
        Ok(())
    }

    fn push(&mut self, text: &[u8]) {
        self.lines += 1;
        let bytes = self.text.bytes.to_mut();
        bytes.extend(text);
        if !text.ends_with(b"\n") {
            bytes.push(b'\n');
        }
    }

    /// Adds the file named by a keyword.
    fn include(&mut self, keyword: &[u8], line: usize) -> Result<(), MeshFileError> {
        let at = FilePosition::Line(line);
        let written = String::from_utf8_lossy(keyword);
        let words = written.split(',').filter_map(|word| word.split_once('='));
        let named = words.filter(|(key, _)| key.trim().eq_ignore_ascii_case("INPUT")).map(|(_, value)| value).next();
        let named =
            named.map(|value| value.trim().trim_matches('"').replace('\\', "/")).filter(|name| !name.is_empty());
        let refuse = |found: String, expected: &str| MeshFileError::Syntax { at, found, expected: expected.to_owned() };
        let Some(named) = named else {
            return Err(refuse("*INCLUDE without INPUT".to_owned(), "*INCLUDE, INPUT=… with the name of a file"));
        };
        let folder = self.open.last().and_then(|name| name.rsplit_once('/')).map_or("", |(folder, _)| folder);
        let name =
            if folder.is_empty() || named.starts_with('/') { named.clone() } else { format!("{folder}/{named}") };
        let Some(include) = self.include.as_deref_mut() else {
            return Err(MeshFileError::Include { at, name: named });
        };
        if self.open.iter().any(|open| plain(open) == plain(&name)) {
            return Err(refuse(
                format!("*INCLUDE of {named:?}, which includes this file"),
                "files that do not include themselves",
            ));
        }
        if self.open.len() > DEEPEST || self.text.names.len() > MOST {
            let found =
                format!("*INCLUDE of {named:?}, {} deep and the {}th in all", self.open.len(), self.text.names.len());
            return Err(refuse(found, &format!("at most {DEEPEST} deep and {MOST} in all")));
        }
        let bytes = include(&name)
            .map_err(|why| refuse(format!("*INCLUDE of {named:?}, {why}"), "a file beside the one that includes it"))?;
        if self.text.bytes.len().saturating_add(bytes.len()) > self.longest {
            let expected = format!("a whole text of at most {} bytes", self.longest);
            return Err(refuse(format!("*INCLUDE of {named:?} with {} bytes", bytes.len()), &expected));
        }
        self.push(format!("** *INCLUDE of {named}").as_bytes());
        self.take(&name, &bytes)
    }
}

/// The parts of a path without `.` and, after a folder, `..`.
fn plain(name: &str) -> Vec<&str> {
    let mut parts: Vec<&str> = Vec::new();
    for part in name.split('/').filter(|part| !part.is_empty() && *part != ".") {
        match parts.last() {
            Some(last) if part == ".." && *last != ".." => drop(parts.pop()),
            _ => parts.push(part),
        }
    }
    parts
}

/// The lines with their ends, numbered from 1.
fn lines(bytes: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    bytes.split_inclusive(|byte| *byte == b'\n').enumerate().map(|(index, text)| (index + 1, text))
}

fn is_include(text: &[u8]) -> bool {
    let text = text.trim_ascii_start();
    let keyword = text.strip_prefix(b"*").unwrap_or_default().trim_ascii_start();
    let name = keyword.split(|byte| *byte == b',').next().unwrap_or_default();
    name.trim_ascii().eq_ignore_ascii_case(b"INCLUDE")
}
