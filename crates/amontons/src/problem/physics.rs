//! Which equations a problem has.

/// The equations that a problem solves. A half-step that it does not have is not computed, and its fields are not
/// results.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Physics {
    /// (4.1) and (4.2).
    #[default]
    Coupled,
    /// (4.1) alone: no temperature.
    Mechanics,
    /// (4.1) at a temperature that is given: [`ProblemData::temperature`](super::ProblemData::temperature).
    Warmed,
    /// (4.2) alone: no displacement. Contacts exchange heat across their gaps at rest, without pressure.
    Heat,
}

impl Physics {
    /// Whether (4.1) is solved for the displacement.
    #[must_use]
    pub fn has_mechanics(self) -> bool {
        self != Physics::Heat
    }

    /// Whether (4.2) is solved for the temperature.
    #[must_use]
    pub fn has_heat(self) -> bool {
        matches!(self, Physics::Coupled | Physics::Heat)
    }

    /// Whether there is a temperature, solved for or given.
    #[must_use]
    pub fn has_temperature(self) -> bool {
        self != Physics::Mechanics
    }
}
