//! The equations of a step, (4.1) and (4.2): their data, systems and residuals, and the powers of their terms.

pub(crate) mod acting;
pub(crate) mod apart;
pub(crate) mod bodies;
mod error;
mod fluid;
pub(crate) mod foundation;
pub(crate) mod given;
pub(crate) mod heat;
mod inputs;
pub(crate) mod iterate;
mod massless;
pub(crate) mod mechanics;
mod memory;
mod mixing;
mod onset;
pub(crate) mod power;
pub(crate) mod predictor;
pub(crate) mod system;
pub(crate) mod systems;

pub(crate) use error::tried;
pub use error::{SetupError, StepError};
pub(crate) use inputs::named;
pub use inputs::{Along, StepInputs};
pub use system::{ACCEPTED, REFINE};
pub use systems::{Kept, KeptRule, Solvers};
