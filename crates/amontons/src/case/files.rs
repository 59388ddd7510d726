//! Files next to a case: their sources, and the copies kept with the results.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::nearest::{meant, nearest};
use super::path;
use crate::machine;
use crate::output::{INPUTS, Input};

/// Longest mesh or table in bytes.
const LONGEST: u64 = 4 << 30;

/// The place of the files that a case refers to.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Files {
    /// No files: the case is a text alone and may not refer to files.
    #[default]
    None,
    /// This folder, that of the case file; relative names start here.
    Folder(PathBuf),
    /// This folder and those below it only.
    Confined(PathBuf),
    /// Memory, by the names used in the case.
    Memory(BTreeMap<String, Arc<[u8]>>),
    /// A file in memory, by the name used in the case, before those of another place.
    With(Box<(String, Arc<[u8]>, Files)>),
}

/// The reason why a file is missing.
#[derive(Debug)]
pub(super) struct Missing {
    pub found: String,
    pub expected: String,
    pub hint: Option<String>,
}

/// Reads the files of one case, each once, and notes the keys that refer to them.
#[derive(Debug)]
pub(super) struct Loader<'s> {
    files: &'s Files,
    read: BTreeMap<String, Arc<[u8]>>,
    references: Vec<(path::Path, String)>,
}

impl<'s> Loader<'s> {
    pub fn new(files: &'s Files) -> Loader<'s> {
        Loader { files, read: BTreeMap::new(), references: Vec::new() }
    }

    /// The file of this name, to which the key at `path` refers.
    ///
    /// # Errors
    /// The file is missing or cannot be read.
    pub fn get(&mut self, path: &path::Path, name: &str) -> Result<Arc<[u8]>, Missing> {
        let bytes = match self.read.get(name) {
            Some(bytes) => Arc::clone(bytes),
            None => read(self.files, name)?,
        };
        self.read.insert(name.to_owned(), Arc::clone(&bytes));
        self.references.push((path.clone(), name.to_owned()));
        Ok(bytes)
    }

    /// The file of this name. With `refers` the key at `path` refers to it, else another key does.
    ///
    /// # Errors
    /// The file is missing or cannot be read.
    pub fn look(&mut self, path: &path::Path, name: &str, refers: bool) -> Result<Arc<[u8]>, Missing> {
        match self.read.get(name) {
            Some(bytes) if !refers => Ok(Arc::clone(bytes)),
            _ => self.get(path, name),
        }
    }

    /// The bytes of a file included by another one. No key refers to it, and no copy is kept.
    ///
    /// # Errors
    /// The reason, to follow the name of the file.
    pub fn include(&self, name: &str) -> Result<Arc<[u8]>, String> {
        read(self.files, name).map_err(|missing| {
            let found = missing.found.strip_prefix(&format!("\"{name}\", ")).unwrap_or(&missing.found).to_owned();
            missing.hint.map_or(found.clone(), |hint| format!("{found} ({hint})"))
        })
    }

    /// Replaces a file by one that contains its included files: the copy needs no other file.
    pub fn complete(&mut self, name: &str, whole: Arc<[u8]>) {
        self.read.insert(name.to_owned(), whole);
    }

    /// The copies to keep, and the new values of the keys that refer to them.
    ///
    /// A name that already is one of a copy stays, so that a case read from a results folder is the case that was run.
    pub fn copies(self) -> (Vec<Input>, Vec<(path::Path, String)>) {
        let is_copy = |name: &str| {
            name.strip_prefix(INPUTS)
                .and_then(|rest| rest.strip_prefix('/'))
                .is_some_and(|file| !file.contains(['/', '\\']))
        };
        let mut copies: BTreeMap<&str, String> =
            self.read.keys().filter(|name| is_copy(name)).map(|name| (name.as_str(), name.clone())).collect();
        for name in self.read.keys().filter(|name| !is_copy(name)) {
            let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
            let (stem, ending) =
                file.rsplit_once('.').map_or((file, String::new()), |(stem, ending)| (stem, format!(".{ending}")));
            let numbered = (2..).map(|n| format!("{INPUTS}/{stem}-{n}{ending}"));
            let mut candidates = std::iter::once(format!("{INPUTS}/{file}")).chain(numbered);
            if let Some(copy) = candidates.find(|candidate| copies.values().all(|taken| taken != candidate)) {
                copies.insert(name, copy);
            }
        }
        let mut inputs: Vec<Input> = self
            .read
            .iter()
            .filter_map(|(name, bytes)| {
                Some(Input { path: copies.get(name.as_str())?.clone(), bytes: Arc::clone(bytes) })
            })
            .collect();
        inputs.sort_by(|a, b| a.path.cmp(&b.path));
        let references = self
            .references
            .iter()
            .filter_map(|(path, name)| Some((path.clone(), copies.get(name.as_str())?.clone())))
            .collect();
        (inputs, references)
    }
}

fn read(files: &Files, name: &str) -> Result<Arc<[u8]>, Missing> {
    const BESIDE: &str = "a file beside the case file";
    let missing = |what: &str, hint: Option<String>| Missing {
        found: format!("\"{name}\", {what}"),
        expected: BESIDE.to_owned(),
        hint,
    };
    let did_you_mean = |near: &str| format!("did you mean \"{near}\"?");
    match files {
        Files::None => {
            let expected = "data in the case itself: it is a text without a folder".to_owned();
            Err(Missing { found: format!("the file \"{name}\""), expected, hint: None })
        }
        Files::With(file) => match &**file {
            (own, bytes, _) if own == name => Ok(Arc::clone(bytes)),
            (_, _, others) => read(others, name),
        },
        Files::Memory(all) => {
            let names: Vec<&str> = all.keys().map(String::as_str).collect();
            all.get(name).cloned().ok_or_else(|| missing("which is not there", meant(name, &names)))
        }
        Files::Folder(folder) | Files::Confined(folder) => {
            let path = folder.join(name);
            if matches!(files, Files::Confined(_)) && !machine::is_inside(folder, &path) {
                return Err(Missing {
                    found: format!("\"{name}\", which is not in the folder of the case"),
                    expected: "a file in that folder: --confine allows no other".to_owned(),
                    hint: None,
                });
            }
            // The bytes are kept and parsed, so only a part of the memory may be used.
            let longest = machine::memory().map_or(LONGEST, |memory| LONGEST.min((memory.bytes / 4.0) as u64));
            machine::read(&path, longest).map(Arc::from).map_err(|error| {
                if error.kind() == std::io::ErrorKind::NotFound {
                    return missing("which is not there", similar(&path, name).map(|near| did_you_mean(&near)));
                }
                if path.is_dir() {
                    return missing("which is no file", None);
                }
                missing(&format!("which cannot be read: {error}"), None)
            })
        }
    }
}

/// A file in the same folder with a similar name, written as in the case.
fn similar(path: &Path, name: &str) -> Option<String> {
    let file = path.file_name()?.to_str()?;
    let mut names: Vec<String> =
        fs::read_dir(path.parent()?).ok()?.filter_map(|entry| entry.ok()?.file_name().into_string().ok()).collect();
    names.sort();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let near = nearest(file, &names)?;
    Some(format!("{}{near}", name.strip_suffix(file)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn copies(names: &[&str]) -> Vec<(String, String)> {
        let files = Files::Memory(names.iter().map(|name| ((*name).to_owned(), Arc::from(name.as_bytes()))).collect());
        let mut loader = Loader::new(&files);
        for name in names {
            assert!(loader.get(&path::Path::default(), name).is_ok());
        }
        let (inputs, references) = loader.copies();
        assert!(inputs.is_sorted_by(|a, b| a.path < b.path));
        references.into_iter().zip(names).map(|((_, copy), name)| ((*name).to_owned(), copy)).collect()
    }

    #[test]
    fn copies_have_names_of_their_own_and_keep_them() {
        let names = ["load.csv", "../a/load.csv", "/b/load.csv", "inputs/load.csv", "inputs/x/load.csv", "mesh"];
        let first = copies(&names);
        let mut stored: Vec<&str> = first.iter().map(|(_, copy)| copy.as_str()).collect();
        assert_eq!(first[3].1, "inputs/load.csv");
        assert_eq!(first[5].1, "inputs/mesh");
        for (name, copy) in copies(&stored) {
            assert_eq!(name, copy);
        }
        stored.sort_unstable();
        stored.dedup();
        assert_eq!(stored.len(), names.len());
    }
}
