//! Algebra: sparse matrices, the factor with its condensed operator, and the largest eigenvalue of a pencil.

mod automatic;
mod condensed;
mod congruence;
mod dense;
mod eigen;
mod error;
mod estimate;
mod factor;
mod graph;
mod krylov;
mod lu;
mod multigrid;
mod nonsymmetric;
mod numeric;
mod ordering;
mod pages;
mod panel;
mod products;
mod relief;
mod repeats;
mod schur;
mod sparse;
mod stop;
mod supernodal;
mod sweeps;
mod system;
mod tangent;
mod turn;
mod unknowns;
mod vectors;

use std::sync::Arc;

pub use automatic::Automatic;
pub use condensed::{Condensed, EXACT, TangentKey};
pub use congruence::NodalMap;
pub use dense::Dense;
pub use eigen::{Eigenpair, Pencil, Quotient, largest};
pub use error::SolveError;
pub(crate) use estimate::PATTERNS;
pub use estimate::{Choice, Decided, Demand, Estimate, Workload};
pub(crate) use factor::join;
pub use factor::{Backend, Factor};
pub use graph::Graph;
pub use krylov::{Definite, Gradients, Krylov, conjugate_gradients, gmres};
pub use multigrid::{ContactBlocks, ContactParts, KeptMatrix, Multigrid, limits};
pub use nonsymmetric::{ComplexMatrix, Pattern, Pivots};
pub use ordering::{Ordering, column_lengths, nested_dissection};
pub use products::{mechanical_products, thermal_products};
pub use relief::{Account, Relief};
pub use sparse::BlockMatrix;
pub use supernodal::Supernodal;
pub use system::System;
pub use tangent::{Entry, Share, Spring, Tangent};
pub use turn::Turn;
pub use unknowns::{Layout, Unknowns};
pub use vectors::{
    add_combination, by_blocks, copy, dot, dots, is_finite, larger, map, map_block, max_abs, orthogonalize, sum_block,
    zeros,
};

/// Every backend, for tests that loop over them.
#[must_use]
pub fn backends() -> Vec<Arc<dyn Backend>> {
    vec![Arc::new(Supernodal), Arc::new(Dense), Arc::new(Multigrid::default())]
}
