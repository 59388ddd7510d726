//! The data of a problem that may vary in space and time, with their places in the case file.

use super::ProblemData;
use crate::field::{Coefficient, Field};
use crate::material::Material;
use crate::tensor::Point;

/// Physical quantity of a datum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DatumRole {
    /// A temperature: initial, prescribed, of surroundings or of a foundation.
    Temperature,
    HeatSource,
    HeatInflow,
    BodyForce,
    /// A traction or a pressure.
    Traction,
    /// A force on a side, an edge or points.
    Force,
    /// A displacement, initial or prescribed.
    Displacement,
    /// The initial velocity.
    Velocity,
    FoundationVelocity,
    /// A gap, the shape of an obstacle, or a coefficient.
    Other,
}

/// A datum: its key in the case file, its field, and where it acts.
#[derive(Clone, Debug)]
pub(crate) struct Datum<'a> {
    /// Dotted path of the case file.
    pub key: String,
    pub role: DatumRole,
    pub field: &'a Field,
    /// Index of its contact, or `None` for data without contact.
    pub contact: Option<usize>,
    /// The side on which it acts, or `None` for the body.
    pub side: Option<&'a str>,
}

/// A value of a coefficient of a material.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MaterialSample<T> {
    pub value: T,
    /// Its position, or `None` if the coefficient is the same in the whole region.
    pub x: Option<Point>,
    /// The temperature, K, or `None` if the coefficient does not depend on it.
    pub theta: Option<f64>,
}

impl ProblemData {
    /// The region of a material, or `None` if the material serves all regions.
    pub(crate) fn region_of(&self, material: usize) -> Option<usize> {
        (self.materials.len() > 1).then_some(material)
    }

    /// The values of a coefficient in a region: one if it is constant, else one per point of evaluation, and per
    /// tabulated temperature if it depends on the temperature.
    pub(crate) fn values_in<T: Copy + Sync>(
        &self,
        material: usize,
        of: impl Fn(&Material) -> &Coefficient<T>,
    ) -> Vec<MaterialSample<T>> {
        let Some(coefficient) = self.materials.get(material).map(of) else { return Vec::new() };
        if let Some(value) = coefficient.constant() {
            return vec![MaterialSample { value, x: None, theta: None }];
        }
        let sites = self.mesh.sites(self.region_of(material));
        if coefficient.temperatures().is_empty() {
            return sites
                .into_iter()
                .map(|x| MaterialSample { value: coefficient.at(&x), x: Some(x), theta: None })
                .collect();
        }
        let at = |theta: f64, x: Point| MaterialSample {
            value: coefficient.at_temperature(&x, theta),
            x: Some(x),
            theta: Some(theta),
        };
        let (levels, at) = (coefficient.temperatures().iter(), &at);
        levels.flat_map(|&theta| sites.iter().map(move |&x| at(theta, x))).collect()
    }

    /// The values of a coefficient in all regions.
    pub(crate) fn values_of<T: Copy + Sync>(
        &self,
        of: impl Fn(&Material) -> &Coefficient<T>,
    ) -> Vec<MaterialSample<T>> {
        (0..self.materials.len()).flat_map(|material| self.values_in(material, &of)).collect()
    }

    /// All data that a step evaluates: loads, conditions on sides and data of contact.
    pub(crate) fn data(&self) -> Vec<Datum<'_>> {
        let body = |key: String, role, field| Datum { key, role, field, contact: None, side: None };
        let mut all = vec![body("load.heat_source".to_owned(), DatumRole::HeatSource, &self.heat_source)];
        let components = self.body_force.iter().enumerate();
        all.extend(components.map(|(c, field)| body(format!("load.body_force[{c}]"), DatumRole::BodyForce, field)));
        for load in &self.region_loads {
            let roles = [DatumRole::BodyForce, DatumRole::Other, DatumRole::HeatSource];
            for (role, fields) in roles.into_iter().zip(load.fields()) {
                all.extend(fields.into_iter().map(|(key, field)| body(key, role, field)));
            }
        }
        all.extend(self.temperature_data());
        for (i, part) in self.rigid.iter().enumerate() {
            for (key, role, fields) in
                [("force", DatumRole::Force, &part.force), ("moment", DatumRole::Other, &part.moment)]
            {
                let fields = fields.iter().enumerate();
                all.extend(fields.map(|(c, field)| body(format!("rigid[{i}].{key}[{c}]"), role, field)));
            }
        }
        for (i, b) in self.boundary.iter().enumerate() {
            let side = Some(b.on.as_str());
            let on =
                |(key, role, field)| Datum { key: format!("boundary[{i}].{key}"), role, field, contact: None, side };
            all.extend(b.fields().into_iter().map(on));
        }
        all.extend(self.contact_fields());
        all
    }

    /// The initial data (2.11).
    pub(crate) fn initial_data(&self) -> Vec<Datum<'_>> {
        let body = |key: String, role, field| Datum { key, role, field, contact: None, side: None };
        let start = &self.initial;
        let vectors = [
            ("displacement", DatumRole::Displacement, &start.displacement),
            ("velocity", DatumRole::Velocity, &start.velocity),
        ];
        let components = vectors.into_iter().flat_map(|(name, role, fields)| {
            fields.iter().enumerate().map(move |(c, f)| (format!("initial.{name}[{c}]"), role, f))
        });
        components
            .map(|(key, role, field)| body(key, role, field))
            .chain([body("initial.temperature".to_owned(), DatumRole::Temperature, &start.temperature)])
            .collect()
    }

    /// The data of contact.
    pub(crate) fn contact_fields(&self) -> Vec<Datum<'_>> {
        let mut all = Vec::new();
        for (i, contact) in self.contacts.iter().enumerate() {
            let path = self.contact_path(i);
            let datum = |key: String, role, field| Datum {
                key: format!("{path}.{key}"),
                role,
                field,
                contact: Some(i),
                side: Some(contact.on.as_str()),
            };
            all.push(datum("gap".to_owned(), DatumRole::Other, &contact.gap));
            let temperature = &contact.foundation_temperature;
            all.push(datum("heat.foundation_temperature".to_owned(), DatumRole::Temperature, temperature));
            let velocity = contact.foundation_velocity.iter().enumerate();
            all.extend(
                velocity
                    .map(|(c, field)| datum(format!("foundation_velocity[{c}]"), DatumRole::FoundationVelocity, field)),
            );
            let surroundings = contact.foundation_heat.iter().map(|foundation| &foundation.surroundings);
            all.extend(
                surroundings.map(|field| datum("foundation.surroundings".to_owned(), DatumRole::Temperature, field)),
            );
            let pressure = contact.fluid.iter().map(|fluid| &fluid.pressure);
            all.extend(pressure.map(|field| datum("fluid.pressure".to_owned(), DatumRole::Traction, field)));
            let force = contact.preload.iter().map(|preload| &preload.force);
            all.extend(force.map(|field| datum("preload.force".to_owned(), DatumRole::Force, field)));
            let force = contact.obstacle.iter().filter_map(|obstacle| Some(&obstacle.load.as_ref()?.force));
            all.extend(force.map(|field| datum("obstacle.load.force".to_owned(), DatumRole::Force, field)));
            let obstacle = contact.obstacle.iter().flat_map(|obstacle| obstacle.fields());
            all.extend(obstacle.map(|(key, field)| datum(format!("obstacle.{key}"), DatumRole::Other, field)));
        }
        all
    }

    /// The nodes on which a datum acts.
    pub(crate) fn nodes_of(&self, datum: &Datum) -> Vec<Point> {
        let Some(on) = datum.side else { return self.mesh.points.clone() };
        let nodes = self.mesh.named(on).map(crate::mesh::FacetSet::node_list).unwrap_or_default();
        nodes.into_iter().filter_map(|node| self.mesh.points.get(node as usize).copied()).collect()
    }
}
