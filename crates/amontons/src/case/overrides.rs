//! `--set KEY=VALUE`: changes a case and keeps its comments and its order.

use toml_edit::{DocumentMut, InlineTable, Item, Table, TableLike, Value};

use super::fault::{CaseFault, FaultPlace};
use super::path::{Path, Segment};
use super::syntax::{self, SyntaxError};

/// A case with overrides applied.
pub(super) struct Applied {
    /// The text with all overrides that could be applied.
    pub text: String,
    /// The paths that were set, and the overrides as given.
    pub set: Vec<(Path, String)>,
    /// The overrides that could not be applied.
    pub faults: Vec<CaseFault>,
}

/// Applies overrides, each `KEY=VALUE`, to the text of a case, one after the other.
///
/// # Errors
/// The text is not TOML.
pub(super) fn apply(text: &str, overrides: &[String]) -> Result<Applied, SyntaxError> {
    let mut applied = Applied { text: text.to_owned(), set: Vec::new(), faults: Vec::new() };
    if overrides.is_empty() {
        return Ok(applied);
    }
    let mut document: DocumentMut =
        text.parse().map_err(|e: toml_edit::TomlError| (e.message().to_owned(), e.span()))?;
    for given in overrides {
        match read(given).and_then(|(path, value)| set(&mut document, &path, value)) {
            Ok(path) => applied.set.push((path, given.clone())),
            Err(refusal) => applied.faults.push(refusal.into_fault(given)),
        }
    }
    applied.text = document.to_string();
    Ok(applied)
}

/// Replaces names of files in the text of a case by those of their copies.
///
/// # Errors
/// The text is not TOML.
pub(super) fn refer(text: &str, references: &[(Path, String)]) -> Result<String, SyntaxError> {
    if references.is_empty() {
        return Ok(text.to_owned());
    }
    let mut document: DocumentMut =
        text.parse().map_err(|e: toml_edit::TomlError| (e.message().to_owned(), e.span()))?;
    for (path, name) in references {
        let told = |refusal: OverrideRefusal| {
            (format!("{}: found {}, expected {}", refusal.path, refusal.found, refusal.expected), None)
        };
        set(&mut document, path, Value::from(name.as_str())).map_err(told)?;
    }
    Ok(document.to_string())
}

/// The faults of overrides that do not depend on the document.
pub(super) fn faults(overrides: &[String]) -> Vec<CaseFault> {
    overrides.iter().filter_map(|given| read(given).err().map(|refusal| refusal.into_fault(given))).collect()
}

/// The reason why an override cannot be applied.
struct OverrideRefusal {
    path: String,
    found: String,
    expected: String,
    hint: Option<String>,
}

impl OverrideRefusal {
    fn new(path: &(impl ToString + ?Sized), found: impl Into<String>, expected: impl Into<String>) -> OverrideRefusal {
        OverrideRefusal { path: path.to_string(), found: found.into(), expected: expected.into(), hint: None }
    }

    fn hint(mut self, hint: impl Into<String>) -> OverrideRefusal {
        self.hint = Some(hint.into());
        self
    }

    fn into_fault(self, given: &str) -> CaseFault {
        let OverrideRefusal { path, found, expected, hint } = self;
        CaseFault { place: FaultPlace::Override(given.to_owned()), path, found, expected, hint }
    }
}

/// Reads `KEY=VALUE`.
fn read(given: &str) -> Result<(Path, Value), OverrideRefusal> {
    let Some((key, value)) = given.split_once('=') else {
        return Err(OverrideRefusal::new("", "no `=`", "KEY=VALUE, such as mesh.n=32"));
    };
    let (key, value) = (key.trim(), value.trim());
    let path = Path::parse(key)
        .map_err(|found| OverrideRefusal::new("", found, "a dotted key, such as mesh.n or boundary[1].traction"))?;
    if value.is_empty() {
        return Err(OverrideRefusal::new(key, "no value", "a TOML value behind `=`"));
    }
    match value.parse::<Value>() {
        Ok(mut value) => {
            value.decor_mut().clear();
            Ok((path, value))
        }
        Err(_) if is_bare_word(value) => Ok((path, Value::from(value))),
        Err(error) => {
            let what = error.message().lines().next().unwrap_or_default().to_owned();
            Err(OverrideRefusal::new(key, format!("`{}`", value.escape_debug()), "a TOML value").hint(
                if syntax::SyntaxFault::of(&what) == syntax::SyntaxFault::NoValue {
                    format!("a string stands in quotes that the shell leaves alone: '{key}=\"{value}\"'")
                } else {
                    what
                },
            ))
        }
    }
}

/// True if a string value can be written without quotes.
fn is_bare_word(value: &str) -> bool {
    value.starts_with(|c: char| c.is_alphabetic())
        && value.chars().all(|c| c.is_alphanumeric() || matches!(c, '_' | '-' | '.'))
}

/// A place in a document that can be changed.
enum TomlPlace<'d> {
    Item(&'d mut Item),
    Value(&'d mut Value),
    Table(&'d mut Table),
}

impl<'d> TomlPlace<'d> {
    /// The entries of a table of any notation.
    fn into_table(self) -> Option<&'d mut dyn TableLike> {
        match self {
            TomlPlace::Item(item) => item.as_table_like_mut(),
            TomlPlace::Value(value) => value.as_inline_table_mut().map(|t| t as &mut dyn TableLike),
            TomlPlace::Table(table) => Some(table),
        }
    }

    fn is_table(&self) -> bool {
        match self {
            TomlPlace::Item(item) => item.is_table_like(),
            TomlPlace::Value(value) => value.is_inline_table(),
            TomlPlace::Table(_) => true,
        }
    }

    /// Number of entries of an array of any notation.
    fn array_len(&self) -> Option<usize> {
        match self {
            TomlPlace::Item(Item::ArrayOfTables(array)) => Some(array.len()),
            TomlPlace::Item(Item::Value(Value::Array(array))) | TomlPlace::Value(Value::Array(array)) => {
                Some(array.len())
            }
            _ => None,
        }
    }

    /// The names of the entries of an array of tables, for those that have one.
    fn names(&self) -> Vec<(usize, String)> {
        let name = |entry: &dyn TableLike| Some(entry.get("name")?.as_str()?.to_owned());
        let all: Vec<Option<String>> = match self {
            TomlPlace::Item(Item::ArrayOfTables(array)) => array.iter().map(|entry| name(entry)).collect(),
            TomlPlace::Item(Item::Value(Value::Array(array))) | TomlPlace::Value(Value::Array(array)) => {
                array.iter().map(|entry| entry.as_inline_table().and_then(|entry| name(entry))).collect()
            }
            _ => Vec::new(),
        };
        all.into_iter().enumerate().filter_map(|(i, name)| Some((i, name?))).collect()
    }

    /// Entry of an array of any notation.
    fn into_entry(self, index: usize) -> Option<TomlPlace<'d>> {
        match self {
            TomlPlace::Item(Item::ArrayOfTables(array)) => array.get_mut(index).map(TomlPlace::Table),
            TomlPlace::Item(Item::Value(Value::Array(array))) | TomlPlace::Value(Value::Array(array)) => {
                array.get_mut(index).map(TomlPlace::Value)
            }
            _ => None,
        }
    }

    /// Puts a value here; comments around the old one stay.
    fn replace(self, mut value: Value) -> Result<(), &'static str> {
        match self {
            TomlPlace::Item(Item::Value(old)) | TomlPlace::Value(old) => {
                *value.decor_mut() = old.decor().clone();
                *old = value;
            }
            TomlPlace::Item(item) => *item = Item::Value(value),
            TomlPlace::Table(table) => match value {
                Value::InlineTable(new) => *table = new.into_table(),
                _ => return Err("a table"),
            },
        }
        Ok(())
    }
}

/// Sets the value at a path and makes missing tables. Returns the path, in which indices now differ from keys.
fn set(document: &mut DocumentMut, path: &Path, value: Value) -> Result<Path, OverrideRefusal> {
    let lost = || OverrideRefusal::new(path, "no entry", "an entry that can be changed");
    let mut node = TomlPlace::Table(document.as_table_mut());
    let mut at = Path::default();
    for (i, segment) in path.0.iter().enumerate() {
        let last = i + 1 == path.0.len();
        if node.is_table() {
            let Segment::Key(key) = segment else {
                return Err(OverrideRefusal::new(path, format!("an index into {at}, which is a table"), "a key"));
            };
            at = at.key(key);
            let inline = !matches!(node, TomlPlace::Table(_) | TomlPlace::Item(Item::Table(_)));
            let Some(table) = node.into_table() else { return Err(lost()) };
            if table.get(key).is_none() {
                let new = if last { Item::Value(value.clone()) } else { new_table(inline) };
                table.insert(key, new);
                if last {
                    return Ok(at);
                }
            }
            let Some(item) = table.get_mut(key) else { return Err(lost()) };
            node = TomlPlace::Item(item);
        } else if let Some(count) = node.array_len() {
            let names = node.names();
            let index = array_index(segment, count, &names)
                .map_err(|(found, expected)| OverrideRefusal::new(path, found, expected))?;
            at = at.index(index);
            let Some(entry) = node.into_entry(index) else { return Err(lost()) };
            node = entry;
        } else {
            return Err(OverrideRefusal::new(
                path,
                format!("a value at {at}"),
                "a table or an array that the key leads through",
            ));
        }
    }
    node.replace(value)
        .map_err(|expected| OverrideRefusal::new(path, "a value that is no table for a [[table]]", expected))?;
    Ok(at)
}

/// A table without a header of its own if it contains only tables.
fn new_table(inline: bool) -> Item {
    if inline {
        return Item::Value(Value::InlineTable(InlineTable::new()));
    }
    let mut table = Table::new();
    table.set_implicit(true);
    table.decor_mut().set_prefix("\n");
    Item::Table(table)
}

/// The array index named by a segment: `[1]` or `.1`, or the name of the entry: `.press`.
fn array_index(segment: &Segment, count: usize, names: &[(usize, String)]) -> Result<usize, (String, String)> {
    let mut expected = match count {
        0 => "no index: the array is empty".to_owned(),
        _ => format!("an index from 0 to {}", count - 1),
    };
    let words: Vec<String> = names.iter().map(|(_, name)| format!("`{name}`")).collect();
    if !words.is_empty() {
        expected += &format!(", or a name: {}", words.join(", "));
    }
    let named = |key: &String| names.iter().find(|(_, name)| name == key).map(|(index, _)| *index);
    let index = match segment {
        Segment::Index(index) => Some(*index),
        Segment::Key(key) => named(key).or_else(|| key.parse().ok()),
    };
    match (index, segment) {
        (Some(index), _) if index < count => Ok(index),
        (Some(index), _) => Err((format!("index {index}"), expected)),
        (None, Segment::Key(key)) => Err((format!("the key `{key}` in an array"), expected)),
        (None, Segment::Index(_)) => Err(("an index".to_owned(), expected)),
    }
}
