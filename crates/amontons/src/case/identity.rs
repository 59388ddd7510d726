//! The data that the states of a run depend on: the values of its case, except output options and end time.

use toml_edit::{DocumentMut, Item, TableLike, Value};

use crate::output::{Identity, Input};

/// Tables and keys that states do not depend on. The step length is compared with the checkpoint instead.
const APART: [&str; 7] = ["name", "time", "output", "accuracy", "stability", "expected", "verify"];

/// The identity of a case with this text, which is TOML.
pub(super) fn identity(text: &str, inputs: &[Input]) -> Identity {
    let Ok(document) = text.parse::<DocumentMut>() else { return Identity::of_text(text, inputs) };
    let mut values = Vec::new();
    let table: &dyn TableLike = document.as_table();
    for (key, item) in table.iter().filter(|(key, _)| !APART.contains(key)) {
        collect(key, item, &mut values);
    }
    Identity::new(values, inputs)
}

/// The values at and below a key, by their dotted keys.
fn collect(key: &str, item: &Item, values: &mut Vec<(String, String)>) {
    if let Some(table) = item.as_table_like() {
        table.iter().for_each(|(inner, item)| collect(&format!("{key}.{inner}"), item, values));
    } else if let Some(tables) = item.as_array_of_tables() {
        for (i, table) in tables.iter().enumerate() {
            table.iter().for_each(|(inner, item)| collect(&format!("{key}[{i}].{inner}"), item, values));
        }
    } else if let Some(value) = item.as_value() {
        match value.as_array() {
            // An array of tables has the same keys in both notations.
            Some(array) if array.iter().any(Value::is_inline_table) => {
                for (i, value) in array.iter().enumerate() {
                    collect(&format!("{key}[{i}]"), &Item::Value(value.clone()), values);
                }
            }
            _ => values.push((key.to_owned(), written(value))),
        }
    }
}

/// A value in normal form: equal numbers are written alike, comments and blanks are left out.
fn written(value: &Value) -> String {
    match value {
        Value::String(text) => format!("{:?}", text.value()),
        Value::Integer(number) => format!("{:?}", *number.value() as f64),
        Value::Float(number) => format!("{:?}", number.value()),
        Value::Boolean(value) => value.value().to_string(),
        Value::Datetime(date) => date.value().to_string(),
        Value::Array(array) => format!("[{}]", array.iter().map(written).collect::<Vec<_>>().join(", ")),
        Value::InlineTable(table) => {
            let entries: Vec<String> = table.iter().map(|(key, value)| format!("{key} = {}", written(value))).collect();
            format!("{{{}}}", entries.join(", "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_notation_and_what_is_written_do_not_count() {
        let first = identity("a = 1\n[b]\nc = [1, 2.0] # a comment\n[[d]]\ne = 'x'\n[output]\nevery = 3\n", &[]);
        let same = "a = 1.0\nb = { c = [ 1.0,2 ] }\nd = [{ e = \"x\" }]\n[time]\nend = 2\n";
        assert_eq!(identity(same, &[]), first);
        for other in ["a = 2\nb = { c = [1, 2] }\nd = [{ e = 'x' }]", "a = 1\nb = { c = [1, 2] }\nd = [{ e = 'y' }]"] {
            assert_ne!(identity(other, &[]), first, "{other}");
        }
    }
}
