//! Algebra: sparse matrices, the factor with its condensed operator, and the largest eigenvalue of a pencil.

mod condensed;
mod dense;
mod eigen;
mod factor;
mod krylov;
mod lu;
mod ordering;
mod sparse;
mod supernodal;
mod turn;

pub use condensed::{Condensed, Entry};
pub use dense::Dense;
pub use eigen::{Eigenpair, Pencil, Quotient, System, largest};
pub use factor::{Backend, Factor, FactorError, Unknowns};
pub use krylov::{Krylov, gmres};
pub use lu::is_positive_definite;
pub use ordering::{Ordering, nested_dissection};
pub use sparse::{BlockMatrix, Graph, dot, max_abs, mechanical_products};
pub use supernodal::{Fill, Supernodal, fill};
pub use turn::Turn;

/// Every backend, for tests that loop over them.
#[must_use]
pub fn backends() -> Vec<Box<dyn Backend>> {
    vec![Box::new(Supernodal), Box::new(Dense)]
}
