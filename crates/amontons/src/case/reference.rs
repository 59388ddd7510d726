//! Every word of the program with its meaning: keys of the case file, quantities of probes, values in result files and
//! findings. Source of the chapter "Reference" of the guide and of `amontons explain`.

use serde_json::Value;

use super::schema::{SchemaView, schema};
use crate::hypotheses::FindingId;
use crate::output::{ResultTable, quantities, shown};
use crate::units::{Measure, Units};

/// The kind of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Word {
    /// A key of the case file.
    Key,
    /// A quantity of a probe.
    Quantity,
    /// A value in a file of results: a key of the summary, a column, an array.
    Value,
    /// The id of a finding.
    Finding,
}

/// A word with its meaning.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GlossaryEntry {
    /// Its kind.
    pub word: Word,
    /// Its place; for a key the table, `[contact.friction] with law = "coulomb"`.
    pub place: String,
    /// Its name.
    pub name: String,
    /// Its meaning; for a key the description in the schema.
    pub meaning: String,
    /// Allowed values of a key, such as `a number ≥ 0`; the unit of other words.
    pub expected: String,
    /// True if a key is required in its table.
    pub is_required: bool,
}

/// Place of the keys of tables of values.
const VALUES: &str = "a table in the place of a value";

/// The name of a value in a file.
fn of_table(table: ResultTable) -> &'static str {
    match table {
        ResultTable::Summary => "key",
        ResultTable::History | ResultTable::Contact => "column",
        ResultTable::Fields | ResultTable::Surface => "array",
    }
}

/// All words: keys in the order of their tables, then quantities, values of results and findings.
#[must_use]
pub fn reference() -> Vec<GlossaryEntry> {
    let schema = schema();
    let mut all = Vec::new();
    keys(&SchemaView::new(&schema), "", "above all tables", &mut all);
    // Tables of values come last; regions repeat [material].
    all.sort_by_key(|entry| entry.place == VALUES);
    all.retain(|entry| !entry.place.starts_with("[region.material"));
    let unit =
        |measure: Option<Measure>| measure.map_or_else(String::new, |measure| Units::SPACE.of(measure).to_owned());
    let other = |word: Word, place: &str, name: String, meaning: String, expected: String| GlossaryEntry {
        word,
        place: place.to_owned(),
        name,
        meaning,
        expected,
        is_required: false,
    };
    all.extend(quantities().into_iter().map(|(name, meaning, measure)| {
        other(Word::Quantity, "quantity of a [[probe]]", name, meaning, unit(Some(measure)))
    }));
    all.extend(shown().into_iter().map(|value| {
        let place = format!("{} of {}", of_table(value.table), value.table.file());
        let meaning =
            value.lives.after(&format!("{}{}", value.meaning(), if value.lives.words().is_empty() { "" } else { "," }));
        other(Word::Value, &place, value.name, meaning, unit(value.measure))
    }));
    all.extend(
        FindingId::ALL
            .iter()
            .map(|id| other(Word::Finding, "finding", id.as_str().to_owned(), id.meaning().to_owned(), String::new())),
    );
    all
}

/// The entries that match a word: a name, a path such as `contact.friction.coefficient` or `final.von_mises_max`, or
/// the end of one.
#[must_use]
pub fn explain(word: &str) -> Vec<GlossaryEntry> {
    let place = |entry: &GlossaryEntry| {
        let header = entry.place.split(']').next().unwrap_or_default();
        header.trim_start_matches('[').to_owned()
    };
    let is_meant = |entry: &GlossaryEntry| {
        let path = format!(".{}.{}", place(entry), entry.name);
        let has_end = matches!(entry.word, Word::Key | Word::Value) && path.ends_with(&format!(".{word}"));
        entry.name == word || has_end
    };
    reference().into_iter().filter(is_meant).collect()
}

/// Collects the keys of a table with this header and of the tables in it.
fn keys(table: &SchemaView, section: &str, header: &str, all: &mut Vec<GlossaryEntry>) {
    let Some((tag, variants)) = table.variants() else {
        return keys_of(table, section, header, all);
    };
    for (name, variant) in &variants {
        keys_of(variant, section, &format!("{header} with {tag} = \"{name}\""), all);
    }
}

fn keys_of(table: &SchemaView, section: &str, header: &str, all: &mut Vec<GlossaryEntry>) {
    let required = table.required();
    let properties: Vec<(&str, SchemaView)> =
        table.keys().into_iter().filter_map(|name| Some((name, table.property(name)?))).collect();
    all.extend(properties.iter().map(|(name, property)| GlossaryEntry {
        word: Word::Key,
        place: header.to_owned(),
        name: (*name).to_owned(),
        meaning: property.description().unwrap_or_default().replace('\n', " "),
        expected: property.expects(),
        is_required: required.contains(name),
    }));
    for (name, property) in properties {
        let dotted = if section.is_empty() { name.to_owned() } else { format!("{section}.{name}") };
        let inner = property.table();
        if property.has_scalars() {
            // A table of values, allowed in place of a number. There are few kinds, so duplicates are left out.
            let mut values = Vec::new();
            keys(&inner, "", VALUES, &mut values);
            values.retain(|entry| !all.contains(entry));
            all.extend(values);
            continue;
        }
        match inner.items() {
            Some(items) => keys(&items.table(), &dotted, &format!("[[{dotted}]]"), all),
            None => keys(&inner, &dotted, &format!("[{dotted}]"), all),
        }
    }
}

/// The reference as a chapter of the guide, in Markdown.
#[must_use]
pub fn markdown() -> String {
    let all = reference();
    let mut text = String::from(
        "# Reference\n\nEvery key of the case file, quantity of a probe, value in the files of results and finding. `amontons explain WORD` prints the entry of one; \
         `amontons schema` prints the keys as a JSON Schema. Keys marked with * are required in their table.\n",
    );
    let cell = |text: &str| text.replace('|', "\\|").replace('<', "&lt;");
    let mut place = "";
    for entry in &all {
        if entry.place != place {
            place = &entry.place;
            let title = match entry.word {
                Word::Key if place.starts_with('[') => format!("`{place}`"),
                Word::Key if place == VALUES => "A table in the place of a value".to_owned(),
                Word::Key => "Above all tables".to_owned(),
                Word::Quantity => "Quantities of probes".to_owned(),
                Word::Value => {
                    place.rsplit_once(' ').map_or_else(String::new, |(_, file)| format!("Values of `{file}`"))
                }
                Word::Finding => "Findings".to_owned(),
            };
            let head = if entry.word == Word::Key { "key | expected" } else { "name | unit" };
            text += &format!("\n## {title}\n\n| {head} | meaning |\n|---|---|---|\n");
        }
        let star = if entry.is_required { " *" } else { "" };
        text += &format!("| `{}`{star} | {} | {} |\n", entry.name, cell(&entry.expected), cell(&entry.meaning));
    }
    text
}

/// The known word nearest to an unknown one.
#[must_use]
pub fn similar(word: &str) -> Option<String> {
    let all = reference();
    let names: Vec<&str> = all.iter().map(|entry| entry.name.as_str()).collect();
    super::nearest::nearest(word.rsplit('.').next().unwrap_or(word), &names).map(str::to_owned)
}

/// The entries as JSON.
#[must_use]
pub fn json(entries: &[GlossaryEntry]) -> Value {
    let of = |entry: &GlossaryEntry| {
        let GlossaryEntry { word, place, name, meaning, expected, is_required } = entry;
        let word = match word {
            Word::Key => "key",
            Word::Quantity => "quantity",
            Word::Value => "value",
            Word::Finding => "finding",
        };
        serde_json::json!({ "word": word, "place": place, "name": name, "meaning": meaning, "expected": expected, "required": is_required })
    };
    entries.iter().map(of).collect()
}
