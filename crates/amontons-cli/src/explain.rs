//! `amontons explain`: the meaning of a word of the case file, the tables or the messages.

use amontons::case::{self, GlossaryEntry, Word};

use crate::arguments::OutputFormat;
use crate::print;
use crate::status::CommandFailure;

/// Prints the entries of a word, or the chapter of all words.
pub fn execute(word: Option<&str>, format: OutputFormat) -> Result<(), CommandFailure> {
    let Some(word) = word else {
        match format {
            OutputFormat::Json => print::json(&case::reference_json(&case::reference()))?,
            OutputFormat::Text => print::text(&case::reference_markdown())?,
        }
        return Ok(());
    };
    let entries = case::explain(word.trim_start_matches('(').trim_end_matches(')'));
    if entries.is_empty() {
        let near = case::similar(word).map_or_else(String::new, |near| format!("; did you mean \"{near}\"?"));
        let expected = "expected a key of the case file, a quantity of a probe, a value of the results or a finding";
        return Err(CommandFailure::Usage(format!("found \"{}\", {expected}{near}", word.escape_debug())));
    }
    match format {
        OutputFormat::Json => print::json(&case::reference_json(&entries))?,
        OutputFormat::Text => print::text(&entries.iter().map(told).collect::<Vec<_>>().join("\n"))?,
    }
    Ok(())
}

fn told(entry: &GlossaryEntry) -> String {
    let GlossaryEntry { word, place, name, meaning, expected, is_required } = entry;
    let mut text = format!("{name}, {}{place}\n", if *word == Word::Key { "key of " } else { "" });
    if !meaning.is_empty() {
        text += &format!("  {meaning}\n");
    }
    if !expected.is_empty() {
        let title = if *word == Word::Key { "expected" } else { "unit" };
        let required = if *is_required { " (required)" } else { "" };
        text += &format!("  {title}: {expected}{required}\n");
    }
    if *word == Word::Finding {
        text += "  the chapters on warnings and on the certificate of the guide say what to do about it\n";
    }
    text
}
