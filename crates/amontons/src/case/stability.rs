//! The search for modes that a case asks for.

use super::build::Build;
use super::place::At;
use super::raw;
use crate::stability::{ModeKind, Search};

impl Build<'_> {
    /// The search for modes. Ranges have their bounds in order.
    pub(super) fn stability(&mut self, raw: Option<raw::Stability>) -> Search {
        let raw = raw.unwrap_or_default();
        for (key, range) in [("frequency", raw.frequency), ("growth", raw.growth)] {
            if let Some([from, to]) = range.filter(|[from, to]| from >= to) {
                let found = format!("from {from:?} to {to:?}");
                self.note(
                    &format!("stability.{key}"),
                    At::Value,
                    found,
                    "the lower bound first, then a larger one",
                    None,
                );
            }
        }
        let kind = raw.kind.map(|kind| match kind {
            raw::StabilityKind::Squeal => ModeKind::Squeal,
            raw::StabilityKind::Thermal => ModeKind::Thermal,
            raw::StabilityKind::Coupled => ModeKind::Coupled,
        });
        Search { kind, count: raw.count, hertz: raw.frequency, growth: raw.growth, waves: raw.waves }
    }
}
