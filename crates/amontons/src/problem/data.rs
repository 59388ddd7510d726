//! The data of a problem that may vary in space and time, with their places in the case file.

use super::ProblemData;
use crate::field::{Coefficient, Field};
use crate::material::Material;
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

/// A value of a coefficient of a material.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample<T> {
    pub value: T,
    /// Where it is; none if the coefficient is the same in the whole region.
    pub x: Option<Point>,
}

impl ProblemData {
    /// The region that a material serves alone; none if it serves all.
    pub(crate) fn region_of(&self, material: usize) -> Option<usize> {
        (self.materials.len() > 1).then_some(material)
    }

    /// The value of a coefficient in a region, or its values at the points where it is evaluated if it varies.
    pub(crate) fn values_in<T: Copy + Sync>(
        &self,
        material: usize,
        of: impl Fn(&Material) -> &Coefficient<T>,
    ) -> Vec<Sample<T>> {
        let Some(coefficient) = self.materials.get(material).map(of) else { return Vec::new() };
        if let Some(value) = coefficient.constant() {
            return vec![Sample { value, x: None }];
        }
        let sites = self.mesh.sites(self.region_of(material));
        sites.into_iter().map(|x| Sample { value: coefficient.at(&x), x: Some(x) }).collect()
    }

    /// The same of all regions.
    pub(crate) fn values_of<T: Copy + Sync>(&self, of: impl Fn(&Material) -> &Coefficient<T>) -> Vec<Sample<T>> {
        (0..self.materials.len()).flat_map(|material| self.values_in(material, &of)).collect()
    }

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
