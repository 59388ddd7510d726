//! Heat that passes a contact, split by what it passes by.

use std::borrow::Cow;
use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Heat that passes a contact, W in a step and J since the start.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Passed {
    /// Out of the side `on`, by [`mechanism`](crate::contact::HeatLaw::mechanism) in the order of their names; friction
    /// heat that enters it is negative.
    pub by: Vec<(Cow<'static, str>, f64)>,
    /// Made by friction between the two bodies of a pair, of which each receives a part; zero at foundations.
    pub rubbed: f64,
}

impl Passed {
    /// This heat plus that of `power` during a time k in s.
    #[must_use]
    pub fn after(&self, k: f64, power: &Passed) -> Passed {
        // The names of the step, which take no memory, and no zero with a sign.
        let by = power.by.iter().map(|(mechanism, flow)| (mechanism.clone(), 0.0 + k * flow)).collect();
        let mut sum = Passed { by, rubbed: self.rubbed + k * power.rubbed };
        self.by.iter().for_each(|(mechanism, heat)| sum.add(mechanism.clone(), *heat));
        sum
    }

    /// Adds what passes by a mechanism.
    pub(super) fn add(&mut self, mechanism: Cow<'static, str>, heat: f64) {
        match self.by.binary_search_by(|(name, _)| name.cmp(&mechanism)) {
            Ok(place) => self.by[place].1 += heat,
            Err(place) => self.by.insert(place, (mechanism, heat)),
        }
    }

    /// Heat that has left the side `on` of a contact, by name of the mechanism.
    #[must_use]
    pub fn by_name(&self) -> BTreeMap<String, f64> {
        self.by.iter().map(|(name, heat)| (name.to_string(), *heat)).collect()
    }
}
