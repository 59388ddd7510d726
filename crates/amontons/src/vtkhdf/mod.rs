//! Files in the format VTKHDF: one unstructured grid with data over time, in HDF5.
//!
//! The mesh is stored once. The values of an array at all snapshots are concatenated in one dataset, and `Steps`
//! contains the offset of each snapshot; unchanged values are stored once, too. In addition to the data for VTK, the
//! group [`OWN`] has the steps of the snapshots, and each array the attribute `units`.

mod read;
mod write;

pub(crate) use read::Reader;
pub(crate) use write::{GridSeries, WriteError, write};

/// The group read by VTK.
const ROOT: &str = "VTKHDF";
/// The additional group with data unknown to VTK.
const OWN: &str = "amontons";
/// The dataset of the steps in that group.
const STEPS: &str = "steps";

/// Arrays of integers; all others are reals.
const WHOLE: [&str; 1] = ["region"];

/// Location of the values of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ArrayAssociation {
    Points,
    Cells,
}

impl ArrayAssociation {
    const ALL: [ArrayAssociation; 2] = [ArrayAssociation::Points, ArrayAssociation::Cells];

    /// The group of the arrays.
    fn data(self) -> &'static str {
        match self {
            ArrayAssociation::Points => "PointData",
            ArrayAssociation::Cells => "CellData",
        }
    }

    /// The group in `Steps` with the offsets of the snapshots.
    fn offsets(self) -> &'static str {
        match self {
            ArrayAssociation::Points => "PointDataOffsets",
            ArrayAssociation::Cells => "CellDataOffsets",
        }
    }
}

#[cfg(test)]
mod tests;
