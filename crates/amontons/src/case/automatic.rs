//! `[contact.automatic]`: pairs of bodies that are near each other.

use std::collections::{BTreeMap, BTreeSet};

use super::build::Build;
use super::place::At;
use super::raw::{Automatic, Contact};
use crate::contact::mortar::{Facing, facing};
use crate::mesh::Mesh;
use crate::mesh::defects::components;

impl Build<'_> {
    /// The contacts with the names of their sides. An entry with `automatic` is replaced by the pairs found, whose
    /// sides are added to the mesh.
    pub fn named_pairs(&mut self, contacts: Vec<(String, Contact)>, mesh: &mut Mesh) -> Vec<(String, Contact)> {
        let taken: BTreeSet<Vec<u32>> = contacts
            .iter()
            .filter(|(_, contact)| contact.automatic.is_none())
            .flat_map(|(_, contact)| std::iter::once(&contact.on).chain(&contact.with))
            .filter_map(|side| mesh.facets.get(side))
            .flat_map(|set| set.facets().map(|(_, nodes)| sorted(nodes)).collect::<Vec<_>>())
            .collect();
        let mut all = Vec::with_capacity(contacts.len());
        let first = contacts.iter().position(|(_, contact)| contact.automatic.is_some());
        for (number, (path, contact)) in contacts.into_iter().enumerate() {
            let Some(automatic) = contact.automatic else {
                if contact.on.is_empty() {
                    let expected = "a string (name of the side that is Γ_C), or `automatic`";
                    self.note(&format!("{path}.on"), At::Missing, "no such key", expected, None);
                }
                all.push((path, contact));
                continue;
            };
            if first != Some(number) {
                let hint = "give these bodies a contact by `on` and `with`: all that are near are in the first entry";
                let expected = "one [[contact]] entry with `automatic`";
                self.note(&format!("{path}.automatic"), At::Value, "`automatic` again", expected, Some(hint));
                continue;
            }
            self.not_beside_automatic(&path, &contact);
            for [on, with] in self.near(&path, automatic, &taken, mesh) {
                let pair = Contact { on, with: Some(with), automatic: None, ..contact.clone() };
                all.push((path.clone(), pair));
            }
        }
        all
    }

    /// Notes keys that name sides or a contact in addition to `automatic`.
    fn not_beside_automatic(&mut self, path: &str, contact: &Contact) {
        let named = [
            ("on", !contact.on.is_empty()),
            ("name", !contact.name.is_empty()),
            ("with", contact.with.is_some()),
            ("nonmortar", contact.nonmortar.is_some()),
        ];
        for (key, _) in named.into_iter().filter(|(_, given)| *given) {
            let hint = "remove one of them: `automatic` finds the sides";
            let found = format!("`{key}` besides `automatic`");
            self.note(&format!("{path}.{key}"), At::Value, found, "sides that are named, or found", Some(hint));
        }
    }

    /// The pairs of sides that face each other, by their names in the mesh.
    fn near(
        &mut self,
        path: &str,
        Automatic { distance }: Automatic,
        taken: &BTreeSet<Vec<u32>>,
        mesh: &mut Mesh,
    ) -> Vec<[String; 2]> {
        if !self.is_sound {
            return Vec::new();
        }
        let pairs = facing(mesh, distance, &|_, nodes| !taken.contains(&sorted(nodes)));
        if pairs.is_empty() {
            let found = format!("no two bodies within {distance:e} m of each other");
            let hint = "take a larger distance, or name the sides by `on` and `with`";
            self.note(
                &format!("{path}.automatic.distance"),
                At::Value,
                found,
                "bodies that face each other",
                Some(hint),
            );
        }
        let names = names(mesh);
        let mut all = Vec::new();
        for Facing { bodies, sides } in pairs {
            let [a, b] = bodies.map(|body| names.get(body).map_or("", String::as_str));
            let pair = [free(format!("{a}-{b}"), mesh), free(format!("{b}-{a}"), mesh)];
            for (name, side) in pair.iter().zip(sides) {
                mesh.facets.insert(name.clone(), side);
            }
            all.push(pair);
        }
        all
    }
}

/// The name, changed until no side of the mesh has it.
fn free(mut name: String, mesh: &Mesh) -> String {
    while mesh.facets.contains_key(&name) {
        name.push('\'');
    }
    name
}

/// The names of the bodies: the region if it is exactly one body, else numbers.
fn names(mesh: &Mesh) -> Vec<String> {
    let mut body_of = BTreeMap::new();
    let bodies = components(mesh);
    for (body, component) in bodies.iter().enumerate() {
        body_of.extend(component.nodes.iter().map(|&node| (node, body)));
    }
    let mut regions = vec![BTreeSet::new(); bodies.len()];
    let mut bodies_of = BTreeMap::<usize, BTreeSet<usize>>::new();
    for block in &mesh.blocks {
        for body in block.cells().filter_map(|cell| body_of.get(cell.first()?)) {
            regions[*body].insert(block.region);
            bodies_of.entry(block.region).or_default().insert(*body);
        }
    }
    let name = |(body, regions): (usize, &BTreeSet<usize>)| {
        let only = regions
            .first()
            .filter(|region| regions.len() == 1 && bodies_of.get(region).is_some_and(|of| of.len() == 1));
        only.and_then(|&region| mesh.regions.get(region)).cloned().unwrap_or_else(|| format!("body{}", body + 1))
    };
    regions.iter().enumerate().map(name).collect()
}

fn sorted(nodes: &[u32]) -> Vec<u32> {
    let mut nodes = nodes.to_vec();
    nodes.sort_unstable();
    nodes
}
