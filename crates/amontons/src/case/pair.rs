//! Pairs of sides: `with`, `nonmortar`, `geometry`, and keys that a pair cannot have.

use super::build::Build;
use super::place::At;
use super::raw::{self, Datum};
use super::side_facts::SideFacts;
use crate::contact::{Geometry, Pair};
use crate::problem::Choice;

impl Build<'_> {
    /// Replaces the word "effusivity" by the fraction of friction heat that follows from effusivities.
    pub fn partition(&mut self, path: &str, raw: &mut raw::Contact, materials: &SideFacts) {
        if !matches!(&raw.frictional_heat, Datum::Expression(word) if word.trim() == "effusivity") {
            return;
        }
        let of = |side: &str| materials.effusivity(side);
        let both = raw.with.as_deref().and_then(|with| Some((of(&raw.on)?, of(with)?)));
        let share = both.map(|(on, with)| on / (on + with)).filter(|share| share.is_finite());
        raw.frictional_heat = Datum::Number(share.unwrap_or(0.0));
        if share.is_none() {
            let expected = "a number from 0 to 1, or a pair of bodies with a conductivity and a heat capacity";
            self.note(&format!("{path}.frictional_heat"), At::Value, "\"effusivity\"", expected, None);
        }
    }

    /// The second side of a contact, or `None` for a rigid foundation.
    pub fn pair(&mut self, path: &str, raw: &raw::Contact, materials: &SideFacts) -> Option<Pair> {
        let Some(with) = &raw.with else {
            self.without_pair(path, raw);
            return None;
        };
        self.not_of_pairs(path, raw);
        let on_is_mortar = match &raw.nonmortar {
            Some(side) if *side == *with => true,
            Some(side) if *side == raw.on => false,
            Some(side) => {
                let expected = format!("one of the sides of the pair, \"{}\" or \"{with}\"", raw.on);
                self.note(&format!("{path}.nonmortar"), At::Value, format!("\"{side}\""), expected, None);
                false
            }
            None => {
                let (second, why) = materials.second_bears([&raw.on, with]);
                let bears = if second { with } else { &raw.on };
                self.chosen.push(Choice::new(format!("{path}.nonmortar"), bears, why));
                second
            }
        };
        Some(Pair {
            with: with.clone(),
            on_is_mortar,
            geometry: match raw.geometry {
                Some(raw::Geometry::Updated) => Geometry::Updated,
                _ => Geometry::Reference,
            },
            gap_is_given: raw.gap.is_some(),
            closes: raw.close,
        })
    }

    /// Notes keys that only a pair can have.
    fn without_pair(&mut self, path: &str, raw: &raw::Contact) {
        for (key, given) in
            [("nonmortar", raw.nonmortar.is_some()), ("geometry", raw.geometry.is_some()), ("close", raw.close)]
        {
            if given {
                let found = format!("`{key}` without `with`");
                let hint = "give `with`, the other side of the pair, or remove it";
                self.note(&format!("{path}.{key}"), At::Value, found, "a pair of deformable sides", Some(hint));
            }
        }
        if raw.heat.lacks_foundation_temperature() {
            self.note(
                &format!("{path}.heat.foundation_temperature"),
                At::Missing,
                "no such key",
                "a number, an expression in x, y, z, t or a table in time (temperature θ_F of the foundation in K)",
                None,
            );
        }
    }

    /// Notes keys that only a foundation can have.
    fn not_of_pairs(&mut self, path: &str, raw: &raw::Contact) {
        for (key, given) in [
            ("obstacle", raw.obstacle.is_some()),
            ("foundation", raw.foundation.is_some()),
            ("heat.foundation_temperature", raw.heat.has_foundation_temperature()),
        ] {
            if given {
                let found = format!("`{key}` besides `with`");
                let expected = "a rigid foundation, or the other side of a pair, not both";
                self.note(&format!("{path}.{key}"), At::Value, found, expected, Some("remove one of them"));
            }
        }
    }
}
