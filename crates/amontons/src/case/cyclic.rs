//! `[[cyclic]]`.

use super::build::Build;
use super::place::At;
use super::raw;
use crate::mesh::Cyclic;

impl Build<'_> {
    /// The sectors that are repeated about an axis, without faulty entries.
    pub fn cyclic(&mut self, entries: Vec<raw::Cyclic>) -> Vec<Cyclic> {
        let mut all = Vec::new();
        for (i, entry) in entries.into_iter().enumerate() {
            let path = format!("cyclic[{i}]");
            let raw::Cyclic { sides, center, axis } = entry;
            if !center.is_empty() && center.len() != self.dim {
                let expected = format!("{} coordinates", self.dim);
                self.note(
                    &format!("{path}.center"),
                    At::Value,
                    format!("{} coordinates", center.len()),
                    expected,
                    None,
                );
                continue;
            }
            let through = std::array::from_fn(|c| center.get(c).copied().unwrap_or_default());
            all.extend(self.axis(&path, &axis).map(|axis| Cyclic { sides, through, axis }));
        }
        all
    }
}
