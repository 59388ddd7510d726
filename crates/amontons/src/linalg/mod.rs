//! Linear and nonsmooth algebra: sparse matrices, the factor with its condensed operator, Newton's method on the
//! contact boundary, and the largest eigenvalue of a pencil.

mod condensed;
mod dense;
mod eigen;
mod factor;
mod krylov;
mod lu;
mod newton;
mod ordering;
mod sparse;
mod supernodal;

pub use condensed::{Condensed, Entry};
pub use dense::Dense;
pub use eigen::{Eigenpair, Pencil, Quotient, System, largest};
pub use factor::{Backend, Factor, FactorError, Unknowns, backends};
pub use krylov::{Krylov, gmres};
pub use newton::{Exchange, Frame, HeatStep, Lumped, MechanicalStep, Multipliers, NotConverged, PointDerivative, PointState, PointTangent, Solved, TOLERANCE};
pub use ordering::{Ordering, nested_dissection};
pub use sparse::{BlockMatrix, Graph, dot, max_abs, mechanical_products};
pub use supernodal::{Fill, Supernodal, fill};
