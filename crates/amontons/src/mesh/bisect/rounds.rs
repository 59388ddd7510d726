//! Rounds of refinement as a text: which cells of a mesh are marked in each.

use std::fmt;

use super::{Bisection, RoundSide};
use crate::mesh::Mesh;

/// The cells of a mesh that are marked in rounds, one after the other, as [`Bisection`](super::Bisection) numbers them.
///
/// As a text: a line `cells N` with the number of cells before the first round, then a line per round with the numbers
/// of the marked cells, ascending, from 0, or with the word `all`. Lines that begin with `#` say what they like.
///
/// ```
/// use amontons::mesh::{Mesh, RefinementRounds};
///
/// let rounds = RefinementRounds::parse("cells 2\n0\n0 2\n")?;
/// let mesh = rounds.refined(&Mesh::interval(1.0, 2, amontons::mesh::Elements::P1)?, Vec::new())?;
/// assert_eq!(mesh.cell_count(), 5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RefinementRounds {
    /// Number of cells of the mesh before the first round.
    pub cells: usize,
    /// The cells that are marked, per round.
    pub marked: Vec<MarkedCells>,
}

/// The cells that are refined in a round.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MarkedCells {
    /// These, and what else has to be cut: [`Bisection::refine`](super::Bisection::refine).
    These(Vec<usize>),
    /// All, into cells of their own kind: [`Bisection::halve`](super::Bisection::halve).
    All,
}

/// Why a text is not one of rounds, or not one for a mesh.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: found {found}, expected {expected}")]
pub struct RoundsError {
    /// The line, or the round.
    pub place: String,
    /// What is there.
    pub found: String,
    /// What should be.
    pub expected: String,
}

/// Longest word of a file that a message repeats.
const SHOWN: usize = 40;

impl RefinementRounds {
    /// Reads a text.
    ///
    /// # Errors
    /// If a line is not of the form above.
    pub fn parse(text: &str) -> Result<RefinementRounds, RoundsError> {
        let told = |line: usize, found: &str, expected: &str| {
            let found = format!("`{}`", found.chars().take(SHOWN).collect::<String>());
            RoundsError { place: format!("line {line}"), found, expected: expected.to_owned() }
        };
        let mut lines = text.lines().enumerate().filter(|(_, line)| !line.starts_with('#'));
        let (n, first) = lines.next().unwrap_or((0, ""));
        let cells = first.strip_prefix("cells ").and_then(|count| count.trim().parse().ok());
        let cells = cells.ok_or_else(|| told(n + 1, first, "`cells N` with the number of cells of the mesh"))?;
        let mut marked = Vec::new();
        for (n, line) in lines {
            let of = |word: &str| {
                word.parse::<usize>()
                    .map_err(|_| told(n + 1, word, "numbers of cells, whole and not negative, or `all`"))
            };
            marked.push(match line.trim() {
                "all" => MarkedCells::All,
                these => MarkedCells::These(these.split_whitespace().map(of).collect::<Result<_, RoundsError>>()?),
            });
        }
        Ok(RefinementRounds { cells, marked })
    }

    /// Number of rounds in which all cells are halved.
    #[must_use]
    pub fn halvings(&self) -> u32 {
        self.marked.iter().filter(|marked| **marked == MarkedCells::All).count() as u32
    }

    /// A mesh refined in all rounds. New nodes of the sides in `round` are put on their circles.
    ///
    /// # Errors
    /// If the mesh has another number of cells than at the first round, if a marked cell is missing, or if the mesh
    /// becomes too large.
    pub fn refined(&self, mesh: &Mesh, round: Vec<(Vec<u32>, RoundSide)>) -> Result<Mesh, RoundsError> {
        if mesh.cell_count() != self.cells {
            return Err(RoundsError {
                place: "the first round".to_owned(),
                found: format!("cells of a mesh of {}", self.cells),
                expected: format!("those of this one of {}", mesh.cell_count()),
            });
        }
        let mut bisection = round.into_iter().fold(Bisection::new(mesh), |made, (nodes, of)| made.around(&nodes, of));
        for (n, marked) in self.marked.iter().enumerate() {
            let made = match marked {
                MarkedCells::These(cells) => bisection.refine(cells),
                MarkedCells::All => bisection.halve(),
            };
            made.map_err(|error| RoundsError {
                place: format!("round {}", n + 1),
                found: error.found(),
                expected: error.expected().unwrap_or_else(|| "a mesh that can be built".to_owned()),
            })?;
        }
        Ok(bisection.mesh())
    }
}

impl fmt::Display for RefinementRounds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "cells {}", self.cells)?;
        self.marked.iter().try_for_each(|marked| {
            let MarkedCells::These(cells) = marked else { return writeln!(f, "all") };
            let words: Vec<String> = cells.iter().map(ToString::to_string).collect();
            writeln!(f, "{}", words.join(" "))
        })
    }
}
