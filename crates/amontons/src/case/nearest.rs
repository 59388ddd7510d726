//! The word that was probably meant.

/// The word that was probably meant: the nearest one, if it is near enough.
pub(super) fn nearest<'w>(word: &str, words: &[&'w str]) -> Option<&'w str> {
    let word = word.to_lowercase().replace([' ', '_'], "-");
    let distance = |w: &str| strsim::damerau_levenshtein(&w.to_lowercase().replace('_', "-"), &word);
    let near = words.iter().copied().min_by_key(|w| distance(w))?;
    // A third of the letters may be wrong; in words of one or two letters none.
    let budget = near.chars().count().max(word.chars().count()) / 3;
    (distance(near) <= budget).then_some(near)
}

/// The hint with the word that was probably meant.
pub(super) fn meant(word: &str, words: &[&str]) -> Option<String> {
    nearest(word, words).map(|near| format!("did you mean \"{near}\"?"))
}
