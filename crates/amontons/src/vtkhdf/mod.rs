//! Files in the format VTKHDF: one unstructured grid with data over time, in HDF5.
//!
//! The mesh is there once. The values of an array at all snapshots stand one behind the other in one dataset, and
//! `Steps` says where those of each snapshot begin; values that do not change are there once, too. Beside what VTK
//! reads, the group [`OWN`] has the steps of the snapshots, and each array the attribute `units`.

mod read;
mod write;

pub(crate) use read::Reader;
pub(crate) use write::{Series, WriteError, write};

/// The group of what VTK reads.
const ROOT: &str = "VTKHDF";
/// The group beside it, with what VTK does not know.
const OWN: &str = "amontons";
/// The dataset of the steps in it.
const STEPS: &str = "steps";

/// Arrays of whole numbers; all others are reals.
const WHOLE: [&str; 1] = ["region"];

/// What the values of an array belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    Points,
    Cells,
}

impl Place {
    const ALL: [Place; 2] = [Place::Points, Place::Cells];

    /// The group of the arrays.
    fn data(self) -> &'static str {
        match self {
            Place::Points => "PointData",
            Place::Cells => "CellData",
        }
    }

    /// The group in `Steps` of the places at which the values of the snapshots begin.
    fn offsets(self) -> &'static str {
        match self {
            Place::Points => "PointDataOffsets",
            Place::Cells => "CellDataOffsets",
        }
    }
}

#[cfg(test)]
mod tests;
