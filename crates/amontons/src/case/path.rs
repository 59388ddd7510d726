//! Dotted paths into a case: `boundary[1].traction[0]`.

use std::fmt;

/// One step of a path.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Segment {
    /// A key of a table.
    Key(String),
    /// An index of an array.
    Index(usize),
}

/// A path from the root of a case to one of its values.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Path(pub Vec<Segment>);

/// Paths of placeholders for faulty values.
#[derive(Debug, Default)]
pub(super) struct Doubtful {
    /// Ascending, so that paths below a path follow it.
    paths: Vec<Path>,
    /// True if the mesh as a whole is among them, and if anything in it is.
    pub mesh_unknown: bool,
    pub has_in_mesh: bool,
}

impl Doubtful {
    pub fn new(mut paths: Vec<Path>) -> Doubtful {
        paths.sort_unstable();
        let mesh_unknown = paths.binary_search(&Path::default().key("mesh")).is_ok();
        let has_in_mesh = paths.iter().any(|path| path.is_in("mesh"));
        Doubtful { paths, mesh_unknown, has_in_mesh }
    }

    /// True if there are no such paths.
    pub fn is_empty(&self) -> bool {
        self.paths.is_empty()
    }

    /// True if one of the paths is at, above or below another path.
    pub fn is_related(&self, path: &Path) -> bool {
        let above = (0..=path.0.len()).any(|n| {
            let prefix = &path.0[..n];
            self.paths.binary_search_by(|other| other.0.as_slice().cmp(prefix)).is_ok()
        });
        let next = self.paths.partition_point(|other| other < path);
        above || self.paths.get(next).is_some_and(|other| other.is_at_or_below(path))
    }
}

impl Path {
    /// Reads a path: keys separated by dots, indices in brackets or between dots. A key that contains dots or brackets
    /// is quoted.
    ///
    /// Numbers between dots are read as keys; only the document decides whether they are indices.
    ///
    /// # Errors
    /// The fault of the text.
    pub fn parse(text: &str) -> Result<Path, String> {
        // Each segment may cost a level of recursion in the TOML writer.
        const LONGEST: usize = 1000;
        if text.len() > LONGEST {
            return Err(format!("a key of {} bytes", text.len()));
        }
        let mut path = Path::default();
        let mut rest = text;
        loop {
            rest = path.read_key(rest)?;
            while let Some(inside) = rest.strip_prefix('[') {
                let (digits, tail) = inside.split_once(']').ok_or("`[` without `]`")?;
                let index = digits.trim().parse().map_err(|_| format!("`{digits}` as an index"))?;
                path.0.push(Segment::Index(index));
                rest = tail;
            }
            match rest.strip_prefix('.') {
                Some(tail) => rest = tail,
                None if rest.is_empty() => return Ok(path),
                None => return Err(format!("`{rest}` behind a key")),
            }
        }
    }

    /// Reads one key from the beginning of a text and returns what follows it.
    fn read_key<'t>(&mut self, text: &'t str) -> Result<&'t str, String> {
        let quote = text.chars().next().filter(|c| matches!(c, '"' | '\''));
        let (key, rest) = match quote {
            Some(quote) => {
                let inside = text.get(1..).unwrap_or_default();
                inside.split_once(quote).ok_or_else(|| format!("{quote} without a second one"))?
            }
            None => text.split_at(text.find(['.', '[', ']']).unwrap_or(text.len())),
        };
        let key = if quote.is_some() { key } else { key.trim() };
        if key.is_empty() {
            return Err("an empty key".to_owned());
        }
        self.0.push(Segment::Key(key.to_owned()));
        Ok(rest)
    }

    /// The path to an entry of the table at this path.
    pub fn key(&self, key: &str) -> Path {
        self.child(Segment::Key(key.to_owned()))
    }

    /// The path to an entry of the array at this path.
    pub fn index(&self, index: usize) -> Path {
        self.child(Segment::Index(index))
    }

    fn child(&self, segment: Segment) -> Path {
        let mut path = self.clone();
        path.0.push(segment);
        path
    }

    /// The path without its last segment, or `None` for the root.
    pub fn parent(&self) -> Option<Path> {
        self.0.split_last().map(|(_, parent)| Path(parent.to_vec()))
    }

    /// True if it is the key `table` of the root, or below it.
    pub fn is_in(&self, table: &str) -> bool {
        matches!(self.0.first(), Some(Segment::Key(key)) if key == table)
    }

    /// True if `self` is `other` or below it.
    pub fn is_at_or_below(&self, other: &Path) -> bool {
        self.0.starts_with(&other.0)
    }
}

impl fmt::Display for Path {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, segment) in self.0.iter().enumerate() {
            match segment {
                Segment::Index(index) => write!(f, "[{index}]")?,
                Segment::Key(key) => {
                    let bare =
                        !key.is_empty() && key.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-'));
                    let dot = if i == 0 { "" } else { "." };
                    if bare { write!(f, "{dot}{key}")? } else { write!(f, "{dot}{key:?}")? }
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_written_as_they_are_read() {
        for text in ["mesh.n", "boundary[1].traction[0]", "a[0][1].b", "expected.values.\"final.temperature_max\""] {
            assert_eq!(Path::parse(text).map(|p| p.to_string()), Ok(text.to_owned()));
        }
    }

    #[test]
    fn what_is_no_path_is_refused() {
        for text in ["", ".", "a.", ".a", "a..b", "a[", "a[x]", "a[-1]", "a[0]b", "[0]", "\"a", "a]"] {
            assert!(Path::parse(text).is_err(), "{text}");
        }
    }
}
