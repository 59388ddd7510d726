//! Convergence studies: the errors of (5.2) on a sequence of meshes and steps, with observed orders; and limits
//! of numbers on refined meshes: of probes, resultants and energies at the end, and of constants.
//!
//! The levels are solved first, in parallel, and keep their states; the reference is solved last and compared with them
//! step by step, so that its states need not be kept.

mod limit;
mod norms;
mod study;
mod transfer;
mod values;

pub use crate::mesh::Locator;
pub use limit::{ConstantsRow, ConstantsTable, Limit, NoLimit, limit, limit_of};
pub use norms::{Errors, Exact, InnerProducts, against_exact, of_difference};
pub use study::{
    ErrorRow, Reference, ReferenceProgress, Study, StudyError, StudyLevel, StudySettings, StudyTable, Vary, slope,
};
pub use transfer::{Transfer, TransferError};
#[cfg(feature = "case")]
pub(crate) use values::rounded;
pub use values::{FinalValue, FinalValues, LastStep, LevelValue, ValueRow, csv as values_csv};
