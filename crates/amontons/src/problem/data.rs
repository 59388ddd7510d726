//! The data of a problem that may vary in space and time, with their places in the case file.

use super::ProblemData;
use crate::field::Field;
use crate::tensor::Point;

/// A datum: its key in the case file, its field, and what it acts on.
#[derive(Clone, Debug)]
pub(crate) struct Datum<'a> {
    /// Dotted path of the case file.
    pub key: String,
    pub field: &'a Field,
    /// The side on which it acts; none where it acts on the body.
    pub side: Option<&'a str>,
}

impl ProblemData {
    /// Loads, conditions on sides and data of contact: what a step evaluates.
    pub(crate) fn data(&self) -> Vec<Datum<'_>> {
        let body = |key: String, field| Datum { key, field, side: None };
        let mut all = vec![body("load.heat_source".to_owned(), &self.heat_source)];
        all.extend(self.body_force.iter().enumerate().map(|(c, field)| body(format!("load.body_force[{c}]"), field)));
        for (i, b) in self.boundary.iter().enumerate() {
            all.extend(b.fields().into_iter().map(|(key, field)| Datum {
                key: format!("boundary[{i}].{key}"),
                field,
                side: Some(&b.on),
            }));
        }
        let sides: Vec<(String, &str)> = self
            .contacts
            .iter()
            .enumerate()
            .map(|(side, c)| (format!("{}.", self.contact_path(side)), c.on.as_str()))
            .collect();
        all.extend(self.contact_fields().into_iter().map(|(key, field)| {
            let side = sides.iter().find(|(path, _)| key.starts_with(path)).map(|(_, on)| *on);
            Datum { key, field, side }
        }));
        all
    }

    /// The initial data (2.11).
    pub(crate) fn initial_data(&self) -> Vec<Datum<'_>> {
        let body = |key: String, field| Datum { key, field, side: None };
        let start = &self.initial;
        let vectors = [("displacement", &start.displacement), ("velocity", &start.velocity)];
        let components = vectors.into_iter().flat_map(|(name, fields)| {
            fields.iter().enumerate().map(move |(c, f)| (format!("initial.{name}[{c}]"), f))
        });
        components
            .map(|(key, field)| body(key, field))
            .chain([body("initial.temperature".to_owned(), &start.temperature)])
            .collect()
    }

    /// The nodes on which a datum acts.
    pub(crate) fn nodes_of(&self, datum: &Datum) -> Vec<Point> {
        let Some(on) = datum.side else { return self.mesh.points.clone() };
        let nodes = self.mesh.facets.get(on).map(crate::mesh::FacetSet::node_list).unwrap_or_default();
        nodes.into_iter().filter_map(|node| self.mesh.points.get(node as usize).copied()).collect()
    }
}
