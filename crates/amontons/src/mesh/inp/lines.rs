//! The lines of an input file: keywords with their parameters, and the data lines below them.

use std::collections::BTreeMap;

use super::super::read::{FilePosition, MeshFileError};

/// A keyword with its data lines.
#[derive(Clone, Debug)]
pub struct Keyword<'a> {
    /// Line of the keyword, from 1.
    pub line: usize,
    /// Name in capitals without the star, words separated by one space: `SOLID SECTION`.
    pub name: String,
    /// Parameters by their names in capitals; the value is empty if there is none.
    pub parameters: BTreeMap<String, String>,
    /// Data lines with their numbers.
    pub data: Vec<(usize, &'a str)>,
}

impl Keyword<'_> {
    /// The value of a parameter; `None` if it is missing or empty.
    pub fn parameter(&self, name: &str) -> Option<&str> {
        self.parameters.get(name).map(String::as_str).filter(|value| !value.is_empty())
    }

    /// The value of a mandatory parameter.
    ///
    /// # Errors
    /// Fails if the parameter is missing or empty; the error names the line of the keyword.
    pub fn required(&self, name: &str) -> Result<&str, MeshFileError> {
        self.parameter(name).ok_or_else(|| MeshFileError::Syntax {
            at: FilePosition::Line(self.line),
            found: format!("*{} without {name}", self.name),
            expected: format!("*{}, {name}=…", self.name),
        })
    }

    /// True if a parameter is given, with or without a value.
    pub fn has(&self, name: &str) -> bool {
        self.parameters.contains_key(name)
    }

    /// The nonempty entries of all data lines, with their line numbers.
    pub fn entries(&self) -> impl Iterator<Item = (usize, &str)> {
        self.data.iter().flat_map(|&(line, text)| entries(text).map(move |entry| (line, entry)))
    }
}

/// The nonempty entries of a data line.
pub fn entries(text: &str) -> impl Iterator<Item = &str> {
    text.split(',').map(|entry| entry.trim().trim_matches('"')).filter(|entry| !entry.is_empty())
}

/// A number of a data line.
pub(super) fn number<T: std::str::FromStr>(line: usize, text: &str, expected: &str) -> Result<T, MeshFileError> {
    text.parse().map_err(|_| MeshFileError::Syntax {
        at: FilePosition::Line(line),
        found: format!("{text:?}"),
        expected: expected.to_owned(),
    })
}

/// The keywords of a file in order. Lines with two stars are comments; a keyword that ends with a comma continues on
/// the next line.
///
/// # Errors
/// Fails if the first line is neither a keyword nor a comment; the error names it.
pub fn keywords(text: &str) -> Result<Vec<Keyword<'_>>, MeshFileError> {
    let mut keywords: Vec<Keyword> = Vec::new();
    let mut continues = false;
    for (line, text) in text.lines().enumerate().map(|(index, text)| (index + 1, text.trim())) {
        if text.starts_with("**") || text.is_empty() {
            continue;
        }
        if let Some(rest) = text.strip_prefix('*') {
            let (name, rest) = rest.split_once(',').unwrap_or((rest, ""));
            let words: Vec<String> = name.split_whitespace().map(str::to_uppercase).collect();
            let mut keyword = Keyword { line, name: words.join(" "), parameters: BTreeMap::new(), data: Vec::new() };
            parameters(rest, &mut keyword.parameters);
            keywords.push(keyword);
            continues = text.ends_with(',');
            continue;
        }
        let Some(keyword) = keywords.last_mut() else {
            return Err(MeshFileError::Syntax {
                at: FilePosition::Line(line),
                found: format!("{:?}", text.chars().take(40).collect::<String>()),
                expected: "a keyword line, which begins with a star".to_owned(),
            });
        };
        if continues {
            parameters(text, &mut keyword.parameters);
            continues = text.ends_with(',');
        } else {
            keyword.data.push((line, text));
        }
    }
    Ok(keywords)
}

/// Reads the parameters of a keyword line.
fn parameters(text: &str, into: &mut BTreeMap<String, String>) {
    for parameter in text.split(',').map(str::trim).filter(|parameter| !parameter.is_empty()) {
        let (name, value) = parameter.split_once('=').unwrap_or((parameter, ""));
        let name: String = name.split_whitespace().collect();
        into.insert(name.to_uppercase(), value.trim().trim_matches('"').to_owned());
    }
}
