//! Keys of a case as parameters of derivatives and identification.

use toml_edit::{DocumentMut, Item};

use super::fault::{CaseError, Source};
use super::overrides;
use super::parse::parse;
use super::path::{Path, Segment};
use crate::adjoint::Parameter;
use crate::identification::ParameterFamily;
use crate::problem::{Fault, Problem};

/// The number at a key of a case with overrides, as a parameter of derivatives. A number with a unit counts in this
/// unit.
///
/// # Errors
/// If the case has no value there, or the value is no number.
pub fn parameter<'a>(source: &'a Source, overrides: &'a [String], key: &str) -> Result<Parameter<'a>, Fault> {
    let number = KeyNumber::new(source, overrides, key)?;
    let (name, value) = (key.to_owned(), number.value);
    Ok(Parameter { name, value, problem: Box::new(move |value| problem(source, overrides, &[(&number, value)])) })
}

/// The numbers at keys of a case with overrides, as parameters that are identified together.
///
/// # Errors
/// Those of [`parameter`].
pub fn family<'a>(source: &'a Source, overrides: &'a [String], keys: &[String]) -> Result<ParameterFamily<'a>, Fault> {
    let numbers = keys.iter().map(|key| KeyNumber::new(source, overrides, key)).collect::<Result<Vec<_>, _>>()?;
    Ok(ParameterFamily {
        names: keys.to_vec(),
        values: numbers.iter().map(|number| number.value).collect(),
        units: numbers.iter().map(|number| number.unit.as_deref().unwrap_or_default().trim().to_owned()).collect(),
        problem: Box::new(move |values| {
            let all: Vec<(&KeyNumber, f64)> = numbers.iter().zip(values.iter().copied()).collect();
            problem(source, overrides, &all)
        }),
    })
}

/// The overrides that give keys of a case other numbers, in the units that the case writes behind them.
///
/// # Errors
/// Those of [`parameter`].
pub fn settings(source: &Source, overrides: &[String], values: &[(&str, f64)]) -> Result<Vec<String>, Fault> {
    values.iter().map(|(key, value)| Ok(KeyNumber::new(source, overrides, key)?.setting(*value))).collect()
}

/// A number of a case.
struct KeyNumber {
    key: String,
    value: f64,
    /// What follows it in a text with a unit.
    unit: Option<String>,
}

impl KeyNumber {
    fn new(source: &Source, overrides: &[String], key: &str) -> Result<KeyNumber, Fault> {
        let told = |found: String, hint: &str| Fault::new(key, found, "a key with a number").hint(hint);
        let path = Path::parse(key).map_err(|found| told(found, "write it as for --set"))?;
        let applied = overrides::apply(&source.text, overrides).map_err(|(what, _)| told(what, "correct the case"))?;
        let document: DocumentMut =
            applied.text.parse().map_err(|_| told("a text that is no TOML".to_owned(), "correct the case"))?;
        let item = at(document.as_item(), &path)
            .ok_or_else(|| told("no value".to_owned(), "give it in the case or by --set; keys are those of --set"))?;
        let (value, unit) = number(item).ok_or_else(|| {
            let found = item.to_string();
            let hint = "derivatives are by numbers: not by expressions, words, tables or whole vectors; a number in an \
                        expression can be a key of [constants]";
            told(format!("`{}`", found.trim().escape_debug()), hint)
        })?;
        Ok(KeyNumber { key: key.to_owned(), value, unit })
    }

    /// The override that gives the key another number.
    fn setting(&self, value: f64) -> String {
        let KeyNumber { key, unit, .. } = self;
        unit.as_ref().map_or_else(|| format!("{key}={value:?}"), |unit| format!("{key}=\"{value:?}{unit}\""))
    }
}

/// The problem with other numbers at keys.
fn problem(source: &Source, overrides: &[String], values: &[(&KeyNumber, f64)]) -> Result<Problem, Fault> {
    let set = values.iter().map(|(number, value)| number.setting(*value));
    let all: Vec<String> = overrides.iter().cloned().chain(set).collect();
    let names = values.iter().map(|(number, _)| number.key.as_str()).collect::<Vec<_>>().join(", ");
    match parse(source, &all) {
        Ok(case) => Ok(case.problem),
        Err(CaseError::Faults { faults, .. }) => Err(faults.into_iter().next().map_or_else(
            || Fault::new(names.clone(), "these values", "values that the case may have"),
            |fault| {
                let at = if fault.path.is_empty() { names.clone() } else { fault.path };
                Fault::new(at, fault.found, format!("{}, at values around those of {names}", fault.expected))
            },
        )),
        Err(error) => Err(Fault::new(names, error.to_string(), "a case that can be read")),
    }
}

/// The item at a path; entries of arrays are named by index or by their `name`.
fn at<'d>(root: &'d Item, path: &Path) -> Option<&'d Item> {
    path.0.iter().try_fold(root, |item, segment| match segment {
        Segment::Index(index) => item.get(*index),
        Segment::Key(key) => item.get(key.as_str()).or_else(|| {
            let named = |i: &usize| item.get(*i).and_then(|entry| entry.get("name")?.as_str()) == Some(key.as_str());
            let count = item
                .as_array()
                .map(toml_edit::Array::len)
                .or(item.as_array_of_tables().map(toml_edit::ArrayOfTables::len));
            let index = (0..count?).find(named).or_else(|| key.parse().ok())?;
            item.get(index)
        }),
    })
}

/// The number of an item, with what follows it in a text with a unit.
fn number(item: &Item) -> Option<(f64, Option<String>)> {
    if let Some(value) = item.as_float().or_else(|| item.as_integer().map(|value| value as f64)) {
        return Some((value, None));
    }
    let text = item.as_str()?;
    let (number, unit) = text.trim().split_once(' ')?;
    Some((number.parse().ok()?, Some(format!(" {}", unit.trim()))))
}
