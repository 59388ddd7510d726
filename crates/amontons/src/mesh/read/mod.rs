//! What the readers of the formats share: the contents of a file before it is a mesh, and their errors.

mod announced;
mod error;
mod loose;
mod node_sets;
mod overlap;
mod serendipity;

use std::sync::Arc;

use super::Mesh;
pub(super) use announced::{CHARACTER, NUMBER, Room};
pub use error::{FilePosition, MeshFileError};
pub(super) use loose::{Kind, Loose, LooseBlock, NodeSet};
pub(super) use node_sets::FacetOf;
pub(super) use serendipity::complete_data;

/// Plane state given by the elements of a plane mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaneState {
    /// Plane stress, as CPS3.
    Stress,
    /// Plane strain, as CPE4.
    Strain,
}

/// A mesh from a file, with the skipped contents of the file.
#[derive(Clone, Debug)]
pub struct MeshFile {
    /// The mesh.
    pub mesh: Mesh,
    /// Plane state, if all elements agree on it; `None` in formats without one.
    pub plane: Option<PlaneState>,
    /// Skipped contents of the file, in order.
    pub skipped: Vec<Skipped>,
    /// The text of an input file with its includes inserted; `None` if it includes no file.
    pub whole: Option<Arc<[u8]>>,
}

/// Contents of a file that are no part of the mesh.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Skipped {
    /// A keyword with its star, elements of a type, or sets with their names.
    pub what: String,
    /// The included file with the contents; `None` for the mesh file itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Line of the first occurrence, in formats with lines.
    pub line: Option<usize>,
    /// Number of keywords or elements.
    pub count: usize,
}

impl Skipped {
    /// The first few skipped items in one line; `None` if nothing was skipped.
    #[must_use]
    pub fn in_one_line(all: &[Skipped]) -> Option<String> {
        const SHOWN: usize = 4;
        let word = |skipped: &Skipped| match skipped.count {
            1 => skipped.what.clone(),
            count => format!("{} ({count})", skipped.what),
        };
        let shown: Vec<String> = all.iter().take(SHOWN).map(word).collect();
        let more = all.len().saturating_sub(SHOWN);
        let rest =
            if more > 0 { format!("; and {more} more, which `amontons mesh FILE` lists") } else { String::new() };
        (!all.is_empty()).then(|| format!("{}{rest}", shown.join("; ")))
    }
}

/// The first few names in quotes.
pub(super) fn listed<'n>(names: impl Iterator<Item = &'n String>) -> String {
    const SHOWN: usize = 6;
    let mut names = names.map(|name| format!("{name:?}"));
    let mut text = names.by_ref().take(SHOWN).collect::<Vec<_>>().join(", ");
    let more = names.count();
    if more > 0 {
        text += &format!(" and {more} more");
    }
    text
}

/// Returns the bytes of an included file, whose name has the same base folder as that of the mesh file; or the reason
/// why it is not available, as the end of a message.
pub type Include<'a> = dyn FnMut(&str) -> Result<Arc<[u8]>, String> + 'a;

/// Data of the cells or nodes of a file: values by block and cell, or by node.
#[derive(Debug)]
pub(super) enum Values {
    Cells(Vec<Vec<f64>>),
    Nodes(Vec<f64>),
}
