//! Prescribed temperatures of a body without heat equation.

use super::{Datum, DatumRole, ProblemData};
use crate::field::Field;
use crate::mesh::Mesh;

/// A prescribed temperature in a region or in the whole body.
#[derive(Clone, Debug)]
pub struct GivenTemperature {
    /// The number of the region, as [`Mesh::regions`] lists them, or `None` for all regions without an entry.
    pub region: Option<usize>,
    /// θ in K.
    pub field: Field,
    /// Key in the case file, for messages.
    pub key: String,
}

/// The number of the entry that counts per node: the first of its regions, else that of the body.
pub(super) fn entries(mesh: &Mesh, given: &[GivenTemperature]) -> Vec<Option<usize>> {
    let common = given.iter().position(|entry| entry.region.is_none());
    let mut of = vec![common; mesh.points.len()];
    for (number, entry) in given.iter().enumerate().rev() {
        let blocks = mesh.blocks.iter().filter(|block| Some(block.region) == entry.region);
        for &node in blocks.flat_map(|block| &block.nodes) {
            of.get_mut(node as usize).into_iter().for_each(|of| *of = Some(number));
        }
    }
    of
}

impl ProblemData {
    /// The prescribed temperature at the nodes at time `t`, K; zero at nodes without one.
    #[must_use]
    pub fn given_temperature(&self, t: f64) -> Vec<f64> {
        let of = entries(&self.mesh, &self.temperature);
        let mut theta = vec![0.0; of.len()];
        for (number, entry) in self.temperature.iter().enumerate() {
            let here = || of.iter().enumerate().filter(|(_, of)| **of == Some(number)).map(|(node, _)| node);
            let points: Vec<_> = here().filter_map(|node| self.mesh.points.get(node).copied()).collect();
            for (node, value) in here().zip(entry.field.values(&points, t)) {
                theta.get_mut(node).into_iter().for_each(|theta| *theta = value);
            }
        }
        theta
    }

    /// The temperature at the start: prescribed or initial, K.
    #[must_use]
    pub fn first_temperature(&self) -> Vec<f64> {
        if self.temperature.is_empty() {
            self.initial.temperature.values(&self.mesh.points, 0.0)
        } else {
            self.given_temperature(0.0)
        }
    }

    /// The fields of the temperature that is given.
    pub(super) fn temperature_data(&self) -> impl Iterator<Item = Datum<'_>> {
        self.temperature.iter().map(|entry| Datum {
            key: entry.key.clone(),
            role: DatumRole::Temperature,
            field: &entry.field,
            contact: None,
            side: None,
        })
    }
}
