//! The data that the states of a run depend on.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::files::sha256;
use super::inputs::Input;

/// Longest value that is stored as it is; a longer one is stored as length and hash.
const LONGEST: usize = 120;

/// The data that the states of a run depend on: values of its case by dotted keys, and hashes of its files.
///
/// A run continues from a checkpoint of the same identity. Output options, end time and comments are not part of it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity(BTreeMap<String, String>);

impl Identity {
    /// The identity of a case with these values.
    #[must_use]
    pub fn new(values: impl IntoIterator<Item = (String, String)>, inputs: &[Input]) -> Identity {
        let short = |value: String| {
            if value.len() <= LONGEST {
                value
            } else {
                format!("{} bytes with SHA-256 {}", value.len(), sha256(&value))
            }
        };
        let files = inputs.iter().map(|input| (input.path.clone(), sha256(&input.bytes)));
        Identity(values.into_iter().map(|(key, value)| (key, short(value))).chain(files).collect())
    }

    /// The identity of a case known by its text only.
    #[must_use]
    pub fn of_text(text: &str, inputs: &[Input]) -> Identity {
        Identity::new([("the case".to_owned(), text.to_owned())], inputs)
    }

    /// SHA-256.
    pub(super) fn hash(&self) -> [u8; 32] {
        let mut hash = Sha256::new();
        for part in self.0.iter().flat_map(|(key, value)| [key, value]) {
            hash.update((part.len() as u64).to_le_bytes());
            hash.update(part);
        }
        hash.finalize().into()
    }

    /// The keys whose values differ in `now`, with both values.
    pub(super) fn differences(&self, now: &Identity) -> Vec<String> {
        let keys: std::collections::BTreeSet<&String> = self.0.keys().chain(now.0.keys()).collect();
        let differs = |key: &&String| self.0.get(*key) != now.0.get(*key);
        let told = |key: &String| match (self.0.get(key), now.0.get(key)) {
            (Some(then), Some(now)) => format!("{key} was {then} and is {now}"),
            (Some(then), None) => format!("{key} was {then} and is left out"),
            (None, now) => format!("{key} was left out and is {}", now.map_or("", String::as_str)),
        };
        keys.into_iter().filter(differs).map(told).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_name_the_keys() {
        let of = |values: &[(&str, &str)]| {
            Identity::new(values.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())), &[])
        };
        let then = of(&[("a", "1"), ("b", "2"), ("c", "3")]);
        let now = of(&[("a", "1"), ("b", "4"), ("d", "5")]);
        assert_eq!(then.differences(&now), ["b was 2 and is 4", "c was 3 and is left out", "d was left out and is 5"]);
        assert!(then.differences(&then).is_empty() && then.hash() == then.clone().hash() && then.hash() != now.hash());
        // The boundary between key and value counts.
        assert_ne!(of(&[("ab", "c")]).hash(), of(&[("a", "bc")]).hash());
    }
}
