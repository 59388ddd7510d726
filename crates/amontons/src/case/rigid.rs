//! `[[rigid]]`.

use super::build::Build;
use super::place::At;
use super::raw;
use crate::problem::RigidPart;
use crate::time::During;

impl Build<'_> {
    /// The sides and regions that move as rigid bodies, without faulty entries.
    pub fn rigid(&mut self, entries: Vec<raw::Rigid>) -> Vec<RigidPart> {
        let mut all = Vec::new();
        for (i, raw::Rigid { on, force, moment, phases, at, guided }) in entries.into_iter().enumerate() {
            let path = format!("rigid[{i}]");
            if !at.is_empty() && at.len() != self.dim {
                let (found, expected) = (format!("{} coordinates", at.len()), format!("{} coordinates", self.dim));
                self.note(&format!("{path}.at"), At::Value, found, expected, None);
                continue;
            }
            let place = std::array::from_fn(|c| at.get(c).copied().unwrap_or_default());
            let [force, moment] = [("force", force), ("moment", moment)]
                .map(|(key, data)| self.vector(&format!("{path}.{key}"), &data, &[place]));
            let during = phases.map_or(During::Run, During::Phases);
            let at = (!at.is_empty()).then_some(place);
            all.push(RigidPart { on, force, moment, during, at, turns: !guided });
        }
        all
    }
}
