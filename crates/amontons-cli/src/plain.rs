//! Foreign text, such as names of a mesh file, made safe for a terminal: it cannot move the cursor, change the title or
//! hide other text.

use std::borrow::Cow;

/// Longest message in characters.
const LONGEST: usize = 4000;

/// True if a terminal would not just show a character: control characters except line end and tab, and those that
/// change the direction of writing.
fn is_hidden(c: char) -> bool {
    c.is_control() && !matches!(c, '\n' | '\t')
        || matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// The text with hidden characters escaped: `\u{1b}` for an escape.
pub fn plain(text: &str) -> Cow<'_, str> {
    if !text.contains(is_hidden) {
        return Cow::Borrowed(text);
    }
    let shown = |c: char| if is_hidden(c) { c.escape_unicode().to_string() } else { c.to_string() };
    // Files of Windows end their lines with both characters.
    Cow::Owned(text.replace("\r\n", "\n").chars().map(shown).collect())
}

/// Equivalent JSON without such characters, which occur only in its strings.
pub fn json(text: &str) -> Cow<'_, str> {
    if !text.contains(is_hidden) {
        return Cow::Borrowed(text);
    }
    let shown = |c: char| if is_hidden(c) { format!("\\u{:04x}", u32::from(c)) } else { c.to_string() };
    Cow::Owned(text.chars().map(shown).collect())
}

/// A message without hidden characters, cut off if it is too long.
pub fn message(text: &str) -> String {
    let text = plain(text);
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{} … ({} more bytes)", &text[..end], text.len() - end),
        None => text.into_owned(),
    }
}

/// A text of the same length in bytes without hidden characters, so that offsets in it stay valid.
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
