//! The equations that a problem has.

/// The equations that a problem solves. Half-steps left out are not computed, and their fields are not results.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Physics {
    /// (4.1) and (4.2).
    #[default]
    Coupled,
    /// (4.1) alone: no temperature.
    Mechanics,
    /// (4.1) at a prescribed temperature: [`ProblemData::temperature`](super::ProblemData::temperature).
    Warmed,
    /// (4.2) alone: no displacement. Contacts exchange heat across their gaps at rest, without pressure.
    Heat,
}

impl Physics {
    /// True if (4.1) is solved for the displacement.
    #[must_use]
    pub fn has_mechanics(self) -> bool {
        self != Physics::Heat
    }

    /// True if (4.2) is solved for the temperature.
    #[must_use]
    pub fn has_heat(self) -> bool {
        matches!(self, Physics::Coupled | Physics::Heat)
    }

    /// True if there is a temperature, solved for or prescribed.
    #[must_use]
    pub fn has_temperature(self) -> bool {
        self != Physics::Mechanics
    }
}
