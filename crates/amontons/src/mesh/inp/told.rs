//! Items named by sets and sections that are no part of the mesh, collected by kind for messages.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

use super::super::read::{Skipped, listed};

/// A kind of item that is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Left {
    /// Numbers in node sets that the file lacks.
    Nodes,
    /// Numbers in element sets that the file lacks.
    Elements,
    Surfaces,
    ElementSets,
    NodeSets,
    Sections,
    /// Cells assigned to a later section.
    Taken,
    /// Cell sets that no section names.
    Unnamed,
}

impl Left {
    fn words(self) -> &'static str {
        match self {
            Left::Nodes => "nodes that sets name and the file lacks",
            Left::Elements => "elements that sets name and the file lacks",
            Left::Surfaces => "surfaces without a face of the body",
            Left::ElementSets => "element sets without a cell of the body",
            Left::NodeSets => "node sets without a node of the body",
            Left::Sections => "sections without a cell of the body",
            Left::Taken => "cells that a later section takes from",
            Left::Unnamed => "element sets of cells that are no region",
        }
    }
}

#[derive(Default)]
struct LeftItems {
    line: usize,
    count: usize,
    names: BTreeSet<String>,
}

/// Items left out, by kind.
#[derive(Default)]
pub(super) struct Told(RefCell<BTreeMap<Left, LeftItems>>);

impl Told {
    /// Records an item by its name and the number of things it stands for.
    pub fn note(&self, left: Left, line: usize, name: &str, count: usize) {
        let mut entries = self.0.borrow_mut();
        let entry = entries.entry(left).or_insert_with(|| LeftItems { line, ..LeftItems::default() });
        entry.line = entry.line.min(line);
        entry.count += count;
        entry.names.insert(name.to_owned());
    }

    /// One entry per kind.
    pub fn skipped(&self) -> Vec<Skipped> {
        let entry = |(left, LeftItems { line, count, names }): (&Left, &LeftItems)| {
            let colon = if *left == Left::Taken { "" } else { ":" };
            let what = format!("{}{colon} {}", left.words(), listed(names.iter()));
            Skipped { what, file: None, line: Some(*line), count: *count }
        };
        self.0.borrow().iter().map(entry).collect()
    }
}
