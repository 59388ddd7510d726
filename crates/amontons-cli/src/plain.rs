//! Text of others, such as the names of a mesh file, on a terminal: it cannot move the cursor, change the title or hide
//! what stands beside it.

use std::borrow::Cow;

/// Longest message in characters.
const LONGEST: usize = 4000;

/// Whether a terminal would do something else with a character than show it: controls but for the line end and the tab,
/// and those that turn the direction of writing.
fn is_hidden(c: char) -> bool {
    c.is_control() && !matches!(c, '\n' | '\t')
        || matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A text as it is shown: `\u{1b}` in the place of an escape.
pub fn plain(text: &str) -> Cow<'_, str> {
    if !text.contains(is_hidden) {
        return Cow::Borrowed(text);
    }
    let shown = |c: char| if is_hidden(c) { c.escape_unicode().to_string() } else { c.to_string() };
    // Files of Windows end their lines with both.
    Cow::Owned(text.replace("\r\n", "\n").chars().map(shown).collect())
}

/// JSON that means the same and has no such characters, which stand in its texts alone.
pub fn json(text: &str) -> Cow<'_, str> {
    if !text.contains(is_hidden) {
        return Cow::Borrowed(text);
    }
    let shown = |c: char| if is_hidden(c) { format!("\\u{:04x}", u32::from(c)) } else { c.to_string() };
    Cow::Owned(text.chars().map(shown).collect())
}

/// A message as it is shown, cut off where it would fill the terminal.
pub fn message(text: &str) -> String {
    let text = plain(text);
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{} … ({} more bytes)", &text[..end], text.len() - end),
        None => text.into_owned(),
    }
}

/// A text of the same length in bytes, whose characters a terminal shows: places in it stay.
pub fn same_length(text: &str) -> Cow<'_, str> {
    let is_hidden = |c: char| is_hidden(c) && c != '\r';
    if !text.contains(is_hidden) {
        return Cow::Borrowed(text);
    }
    let shown = |c: char| if is_hidden(c) { "?".repeat(c.len_utf8()) } else { c.to_string() };
    Cow::Owned(text.chars().map(shown).collect())
}

#[cfg(test)]
mod tests {
    use super::{LONGEST, json, message, plain, same_length};

    #[test]
    fn controls_are_shown_and_not_done() {
        assert_eq!(plain("a\u{1b}]0;b\u{7}\n\tc"), "a\\u{1b}]0;b\\u{7}\n\tc");
        assert_eq!(plain("\u{202e}\u{9b}31m"), "\\u{202e}\\u{9b}31m");
        assert_eq!(plain("line\r\nover\rwritten \u{7f}"), "line\nover\\u{d}written \\u{7f}");
        for unchanged in ["", "Grüße, 10 µm × 2", "…\n"] {
            assert_eq!(plain(unchanged), unchanged);
        }
    }

    #[test]
    fn json_means_the_same() {
        let value = serde_json::json!({ "name": "\u{1b}\u{9b}\u{202e}é\n" });
        let text = value.to_string();
        let shown = json(&text);
        assert!(!shown.contains(super::is_hidden), "{shown}");
        assert_eq!(serde_json::from_str::<serde_json::Value>(&shown).ok(), Some(value));
    }

    #[test]
    fn a_message_has_an_end() {
        let long = message(&"é".repeat(3 * LONGEST));
        assert!(long.chars().count() < LONGEST + 40 && long.ends_with(&format!("({} more bytes)", 4 * LONGEST)));
        assert_eq!(message("short"), "short");
    }

    #[test]
    fn places_stay() {
        let text = "name = \"\u{1b}\u{9b}\"\r\nx\r\n";
        assert_eq!(same_length(text), "name = \"???\"\r\nx\r\n");
    }
}
