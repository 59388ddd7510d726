//! Linear and nonsmooth algebra: sparse matrices, the factor with its condensed operator, and
//! Newton's method on the contact boundary.

mod condensed;
mod dense;
mod factor;
mod newton;
mod ordering;
mod sparse;

pub use condensed::{Condensed, Entry};
pub use dense::Dense;
pub use factor::{Backend, Factor, FactorError, Supernodal, Unknowns, backends};
pub use newton::{HeatStep, MechanicalStep, Multipliers, NotConverged, PointState, Solved, TOLERANCE};
pub use ordering::{Ordering, nested_dissection};
pub use sparse::{BlockMatrix, Graph, dot, max_abs, mechanical_products};
