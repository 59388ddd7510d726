//! Time: the instants of a run, and the rule by which a step goes from one to the next.

mod analysis;
mod during;
mod instant;
mod made;
mod pace;
mod phase;
mod rule;
mod scheme;
mod span;
mod timeline;

pub use analysis::Analysis;
pub use during::During;
pub use instant::{Instant, Interval};
pub use made::MadeSteps;
pub use pace::{Budget, ChosenSteps, GAUGED, Pace, StepErrors};
pub use phase::{Steps, TimePhase};
pub use rule::{ContactRule, FrictionRule, PressureRule, Rule, Start};
pub use scheme::TimeScheme;
pub use timeline::{HALVINGS, Timeline};
