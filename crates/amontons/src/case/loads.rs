//! Gravity, the loads of regions, and given temperatures.

use std::collections::BTreeSet;

use super::build::Build;
use super::place::At;
use super::raw;
use crate::field::Field;
use crate::mesh::Mesh;
use crate::problem::{GivenTemperature, RegionLoad};
use crate::tensor::Point;

/// The nodes of a region.
fn nodes_of(mesh: &Mesh, region: usize) -> Vec<Point> {
    let blocks = mesh.blocks.iter().filter(|block| block.region == region);
    let nodes: BTreeSet<u32> = blocks.flat_map(|block| block.nodes.iter().copied()).collect();
    nodes.into_iter().filter_map(|node| mesh.points.get(node as usize).copied()).collect()
}

impl Build<'_> {
    /// The loads of single regions: their own, and gravity by their densities.
    pub fn region_loads(&mut self, raw: &raw::Case, mesh: &Mesh) -> Vec<RegionLoad> {
        let gravity = self.gravity(&raw.load, mesh);
        let mut all = Vec::new();
        for region in 0..mesh.regions.len().max(1) {
            let name = mesh.regions.get(region);
            let own = raw.region.iter().position(|raw| Some(&raw.on) == name);
            let raw_own = own.and_then(|i| raw.region.get(i));
            let mut load = RegionLoad::on(region);
            if let (Some(i), Some(raw)) = (own, raw_own) {
                let path = format!("region[{i}]");
                load.body_force = self.vector(&format!("{path}.body_force"), &raw.body_force, &mesh.points);
                load.heat_source = self.field(&format!("{path}.heat_source"), &raw.heat_source, &mesh.points);
                load.keys[0] = path;
            }
            let prefix = match own.filter(|_| raw_own.is_some_and(|raw| raw.material.is_some())) {
                Some(i) => format!("region[{i}].material"),
                None => "material".to_owned(),
            };
            if !gravity.is_empty()
                && let Some(density) = self.densities.get(&prefix)
            {
                load.gravity = Some((gravity.clone(), density.clone()));
            }
            let acts = !load.body_force.is_empty() || load.gravity.is_some() || !load.heat_source.is_zero();
            all.extend(acts.then_some(load));
        }
        all
    }

    /// The given temperatures, by region and for the rest of the body.
    pub fn temperature(&mut self, raw: &raw::Case, mesh: &Mesh) -> Vec<GivenTemperature> {
        let mut all = Vec::new();
        for (i, own) in raw.region.iter().enumerate() {
            let number = mesh.regions.iter().position(|name| *name == own.on);
            let key = format!("region[{i}].temperature");
            if let (Some(datum), Some(region)) = (&own.temperature, number) {
                let nodes = nodes_of(mesh, region);
                let field = self.field(&key, datum, &nodes);
                all.push(GivenTemperature { region: Some(region), field, key });
            }
        }
        if let Some(datum) = &raw.load.temperature {
            let key = "load.temperature".to_owned();
            let field = self.field(&key, datum, &mesh.points);
            all.push(GivenTemperature { region: None, field, key });
        }
        all
    }

    /// Gravity; the materials must then have densities.
    fn gravity(&mut self, load: &raw::Load, mesh: &Mesh) -> Vec<Field> {
        let gravity = self.vector("load.gravity", &load.gravity, &mesh.points[..mesh.points.len().min(1)]);
        if gravity.iter().any(Field::depends_on_space) {
            let hint = "a force that varies in space is a `body_force`";
            let expected = "numbers or expressions in t";
            self.note("load.gravity", At::Value, "an expression in x, y or z", expected, Some(hint));
        }
        gravity
    }
}
