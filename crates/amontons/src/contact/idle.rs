//! Contacts that act in some phases of a run only.

use super::{Compliance, Contact, Frictionless, Insulated};
use crate::time::During;

impl Contact {
    /// Makes the contact act in the phases of these names only.
    #[must_use]
    pub fn phases(self, names: impl IntoIterator<Item = impl Into<String>>) -> Contact {
        Contact { during: During::phases(names), ..self }
    }

    /// True if the contact acts in some phase. Of the contacts of a problem with the conditions of one phase: in that
    /// phase.
    #[must_use]
    pub fn acts(&self) -> bool {
        self.during != During::NEVER
    }

    /// The contact in steps in which it does not act: nothing presses, rubs, exchanges heat or enters between its
    /// sides, as if its gap were infinite. It keeps its sides, so that Γ_C has the same points in all steps, and what
    /// says which of them wear.
    #[must_use]
    pub fn idle(&self) -> Contact {
        Contact {
            normal: Compliance { stiffness: 0.0 }.into(),
            friction: Frictionless.into(),
            heat: Insulated.into(),
            fluid: None,
            ..self.clone()
        }
    }
}
