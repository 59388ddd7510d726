//! amontons in a browser: a run in memory, its numbers as JSON and its pictures as SVG.
//!
//! [`play`] is plain Rust; the type here passes it to the script of the page.

pub mod play;

use wasm_bindgen::prelude::*;

/// A finished run of a case.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Play(play::Play);

#[wasm_bindgen]
impl Play {
    /// Reads the text of a case with overrides, each `key=value`, and runs it. At most `frames` times are kept in
    /// addition to the start.
    ///
    /// # Errors
    /// The case has faults, or no step of the run could be made: the text gives place and reason.
    #[wasm_bindgen(constructor)]
    #[allow(clippy::needless_pass_by_value, reason = "arguments from a script are owned")]
    pub fn new(text: &str, overrides: Vec<String>, frames: usize) -> Result<Play, JsError> {
        play::Play::new(text, &overrides, frames).map(Play).map_err(|error| JsError::new(&error))
    }

    /// The data of the page as JSON: [`play::Play::told`].
    #[must_use]
    pub fn told(&self) -> String {
        self.0.told().to_string()
    }

    /// A picture at one of the kept times, as SVG.
    ///
    /// # Errors
    /// The run has no such picture or no such time.
    pub fn picture(&self, name: &str, frame: usize) -> Result<String, JsError> {
        self.0.picture(name, frame).map_err(|error| JsError::new(&error))
    }
}
