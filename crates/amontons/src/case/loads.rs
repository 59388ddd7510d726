//! Gravity, the loads of regions, and given temperatures.

use std::collections::BTreeSet;

use super::build::Build;
use super::nearest::meant;
use super::place::At;
use super::raw;
use crate::field::{Coefficient, Field};
use crate::mesh::Mesh;
use crate::problem::{GivenTemperature, RegionLoad};
use crate::tensor::Point;
use crate::time::During;

/// The nodes of a region.
fn nodes_of(mesh: &Mesh, region: usize) -> Vec<Point> {
    let blocks = mesh.blocks.iter().filter(|block| block.region == region);
    let nodes: BTreeSet<u32> = blocks.flat_map(|block| block.nodes.iter().copied()).collect();
    nodes.into_iter().filter_map(|node| mesh.points.get(node as usize).copied()).collect()
}

/// True if a load is not zero.
fn acts(load: &RegionLoad) -> bool {
    !load.body_force.is_empty() || load.gravity.is_some() || !load.heat_source.is_zero()
}

impl Build<'_> {
    /// The body force and the heat source that act in all of the body in all phases.
    pub fn load_of_all(&mut self, raw: &raw::Case, mesh: &Mesh) -> (Vec<Field>, Field) {
        raw.load.of_all().map_or((Vec::new(), Field::ZERO), |load| {
            let body_force = self.vector("load.body_force", &load.body_force, &mesh.points);
            (body_force, self.field("load.heat_source", &load.heat_source, &mesh.points))
        })
    }

    /// The loads of single regions: their own, and gravity by their densities.
    pub fn region_loads(&mut self, raw: &raw::Case, mesh: &Mesh) -> Vec<RegionLoad> {
        let gravity = raw.load.of_all().map_or_else(Vec::new, |load| self.gravity("load.gravity", &load.gravity, mesh));
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
            load.gravity = self.weight(raw, &gravity, mesh, region);
            all.extend(acts(&load).then_some(load));
        }
        if raw.load.of_all().is_none() {
            for (path, load) in raw.load.each() {
                all.extend(self.entry(raw, (&path, load), mesh));
            }
        }
        all
    }

    /// The loads of an entry in its region, or in all regions.
    fn entry(&mut self, raw: &raw::Case, (path, entry): (&str, &raw::Load), mesh: &Mesh) -> Vec<RegionLoad> {
        let known: Vec<&str> = mesh.regions.iter().map(String::as_str).collect();
        let regions: Vec<usize> = match &entry.on {
            None => (0..mesh.regions.len().max(1)).collect(),
            Some(on) => known.iter().position(|name| name == on).into_iter().collect(),
        };
        if let Some(on) = entry.on.as_ref().filter(|_| regions.is_empty()) {
            let expected = match known.as_slice() {
                [] => "no such key: the body has no regions".to_owned(),
                known => format!("one of the regions {}", known.join(", ")),
            };
            let hint = meant(on, &known);
            self.note(&format!("{path}.on"), At::Value, format!("\"{on}\""), expected, hint.as_deref());
        }
        for (key, given) in [("on", entry.on.is_some()), ("phases", entry.phases.is_some())] {
            if given && entry.temperature.is_some() {
                let hint = "give the temperature of a region in [[region]], and one that changes as an expression in t";
                let (found, path) = (format!("a given temperature beside `{key}`"), format!("{path}.temperature"));
                self.note(&path, At::Value, found, "one of all of the body at all times", Some(hint));
            }
        }
        let body_force = self.vector(&format!("{path}.body_force"), &entry.body_force, &mesh.points);
        let heat_source = self.field(&format!("{path}.heat_source"), &entry.heat_source, &mesh.points);
        let gravity = self.gravity(&format!("{path}.gravity"), &entry.gravity, mesh);
        let of = |region: usize| RegionLoad {
            body_force: body_force.clone(),
            heat_source: heat_source.clone(),
            gravity: self.weight(raw, &gravity, mesh, region),
            during: entry.phases.clone().map_or(During::Run, During::Phases),
            keys: [path.to_owned(), path.to_owned()],
            ..RegionLoad::on(region)
        };
        let all: Vec<RegionLoad> = regions.into_iter().map(of).collect();
        if entry.temperature.is_none() && !all.iter().any(acts) && self.is_sound && !all.is_empty() {
            let expected = "`body_force`, `gravity` or `heat_source`";
            self.note(path, At::Value, "a load that is zero", expected, Some("add one of them, or remove the entry"));
        }
        all
    }

    /// Gravity in a region, with the density there; `None` without gravity.
    fn weight(
        &self,
        raw: &raw::Case,
        gravity: &[Field],
        mesh: &Mesh,
        region: usize,
    ) -> Option<(Vec<Field>, Coefficient<f64>)> {
        let name = mesh.regions.get(region);
        let own = raw.region.iter().position(|raw| Some(&raw.on) == name && raw.material.is_some());
        let prefix = own.map_or_else(|| "material".to_owned(), |i| format!("region[{i}].material"));
        let density = self.densities.get(&prefix).filter(|_| !gravity.is_empty())?;
        Some((gravity.to_vec(), density.clone()))
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
        for (path, load) in raw.load.each() {
            let Some(datum) = &load.temperature else { continue };
            let key = format!("{path}.temperature");
            if all.iter().any(|before| before.region.is_none()) {
                let hint = "remove it: temperatures that are given do not add up";
                self.note(&key, At::Value, "a given temperature again", "one of all of the body", Some(hint));
            }
            let field = self.field(&key, datum, &mesh.points);
            all.push(GivenTemperature { region: None, field, key });
        }
        all
    }

    /// Gravity; the materials must then have densities.
    fn gravity(&mut self, path: &str, data: &[raw::Datum], mesh: &Mesh) -> Vec<Field> {
        let gravity = self.vector(path, data, &mesh.points[..mesh.points.len().min(1)]);
        if gravity.iter().any(Field::depends_on_space) {
            let hint = "a force that varies in space is a `body_force`";
            let expected = "numbers or expressions in t";
            self.note(path, At::Value, "an expression in x, y or z", expected, Some(hint));
        }
        gravity
    }
}
