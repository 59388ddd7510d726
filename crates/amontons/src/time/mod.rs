//! Time: the instants of a run, and the rule by which a step goes from one to the next.

mod analysis;
mod during;
mod phase;
mod rule;
mod scheme;
mod timeline;

pub use analysis::Analysis;
pub use during::During;
pub use phase::TimePhase;
pub use rule::{ContactRule, FrictionRule, PressureRule, Rule, Start};
pub use scheme::TimeScheme;
pub use timeline::{HALVINGS, Instant, Interval, Timeline};
