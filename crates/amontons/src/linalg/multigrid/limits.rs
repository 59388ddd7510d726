//! Limits of an iteration on all unknowns of a matrix, for every solver that iterates on them.

/// Smallest and largest number of products between two checks of the true residual. GMRES stores two vectors per
/// product, so the number of products is [`NUMBERS`] over the number of unknowns, within these limits.
pub const PRODUCTS: [usize; 2] = [60, 400];
/// Products between two checks times unknowns.
pub const NUMBERS: usize = 1 << 24;
/// Largest number of checks of the true residual.
pub const LOOKS: usize = 10;
/// Accepted residual relative to the requested one.
pub const NEARLY: f64 = 1.5;
/// Relative residual above which the matrix counts as singular.
pub const LEFT: f64 = 1e-2;
/// Relative residual at which a matrix counts as positive definite: all of its extreme eigenvalues have been seen.
pub const SEEN: f64 = 1e-10;
