//! Heat that passes a contact, split by what it passes by.

use std::borrow::Cow;
use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::heat::HeatStep;
use crate::contact::{Contact, FRICTION, Flux, HeatLaw};

/// Heat that passes a contact, W in a step and J since the start.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Passed {
    /// Out of the side `on`, by [`HeatLaw::mechanism`] in the order of their names; friction heat that enters it is
    /// negative.
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
    fn add(&mut self, mechanism: Cow<'static, str>, heat: f64) {
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

impl HeatStep<'_> {
    /// The heat that passes each contact at the fluxes Q out of the sides that bear the points, with the temperatures
    /// of these sides and of what they face.
    pub(super) fn passed(&self, flux: &[f64], temperatures: &[[f64; 2]]) -> Vec<Passed> {
        let none = |contact: &Contact| Passed {
            by: Vec::with_capacity(contact.heat.parts().len().max(1)),
            ..Passed::default()
        };
        let mut all: Vec<Passed> = self.contacts.iter().map(none).collect();
        for (i, (flux, at)) in flux.iter().zip(temperatures).enumerate() {
            let point = &self.boundary.points[i];
            let (Some(contact), Some(passed)) = (self.contacts.get(point.contact), all.get_mut(point.contact)) else {
                continue;
            };
            let (rubbed, [own, other]) = (self.rubbed(i), *at);
            passed.rubbed += point.weight * rubbed;
            let (flux, at) = if contact.sign() > 0.0 {
                (*flux, [own, other])
            } else {
                (Flux { value: *flux, ..Flux::default() }.across(rubbed).value, [other, own])
            };
            self.split(i, &*contact.heat, flux, at, |mechanism, value| {
                passed.add(Cow::Borrowed(mechanism), point.weight * value);
            });
        }
        all
    }

    /// Splits the flux out of the side `on` at a point. Friction heat does not depend on the temperatures. The rest is
    /// divided in the ratio of the laws, which stays exact where a conductance is so large that θ − θ_F is round-off;
    /// where the difference vanishes, in that of their slopes.
    fn split(
        &self,
        i: usize,
        law: &dyn HeatLaw,
        flux: f64,
        [temperature, foundation]: [f64; 2],
        mut add: impl FnMut(&'static str, f64),
    ) {
        if law.parts().is_empty() {
            law.mechanism().into_iter().for_each(|mechanism| add(mechanism, flux));
            return;
        }
        let at = self.at(i, temperature, foundation);
        let of_parts = || law.parts().iter().filter_map(|part| Some((part.mechanism()?, part.flux(&at))));
        let exchanging = || of_parts().filter(|(mechanism, _)| *mechanism != FRICTION);
        let rest = of_parts()
            .filter(|(mechanism, _)| *mechanism == FRICTION)
            .inspect(|(mechanism, friction)| add(mechanism, friction.value))
            .fold(flux, |rest, (_, friction)| rest - friction.value);
        let [value, slope] =
            exchanging().fold([0.0; 2], |[value, slope], (_, part)| [value + part.value, slope + part.by_temperature]);
        for (mechanism, part) in exchanging() {
            let share = if value != 0.0 {
                part.value / value
            } else if slope > 0.0 {
                part.by_temperature / slope
            } else {
                0.0
            };
            add(mechanism, rest * share);
        }
    }
}
