//! Sets and surfaces without a name in the deck, for a mesh file that includes it.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::deck::{DeckFault, DeckPlace};
use super::mesh::{DeckMesh, DeckNodeId, DeckSetKind};

/// Number of entries per line of a set.
const PER_LINE: usize = 16;

/// Sets and surfaces made for a case.
#[derive(Debug, Default)]
pub struct DeckSides {
    text: String,
    names: Vec<String>,
    /// Names in the case of node sets used by conditions.
    known: HashMap<String, Vec<String>>,
    /// Names of surfaces by the faces they are made of.
    faces: HashMap<(String, usize), String>,
}

impl DeckSides {
    /// The keywords; empty if the names of the deck are enough.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// A name that exists neither in the deck nor in this file: the wanted one, or one with a number.
    fn free(&mut self, mesh: &DeckMesh, wanted: &str) -> String {
        let taken = |name: &str| {
            self.names.iter().any(|own| own.eq_ignore_ascii_case(name))
                || [DeckSetKind::Nodes, DeckSetKind::Surface].iter().any(|&has| mesh.spelling(has, name).is_some())
        };
        let numbered = (2..).map(|number| format!("{wanted}-{number}"));
        let name = std::iter::once(wanted.to_owned()).chain(numbered).find(|name| !taken(name));
        let name = name.unwrap_or_else(|| wanted.to_owned());
        self.names.push(name.clone());
        name
    }

    /// Makes a set of nodes.
    pub fn nodes(&mut self, mesh: &DeckMesh, wanted: &str, nodes: &BTreeSet<DeckNodeId>) -> String {
        let name = self.free(mesh, wanted);
        let mut bodies: BTreeMap<usize, Vec<String>> = BTreeMap::new();
        for (body, number) in nodes {
            bodies.entry(*body).or_default().push(number.to_string());
        }
        for (body, numbers) in bodies {
            let instance = mesh.instance(body).map_or_else(String::new, |instance| format!(", INSTANCE={instance}"));
            self.text += &format!("*NSET, NSET={name}{instance}\n");
            numbers.chunks(PER_LINE).for_each(|chunk| self.text += &format!("{}\n", chunk.join(", ")));
        }
        name
    }

    /// Makes a surface of faces: of elements and sets of elements, each with the number of its face.
    pub fn surface(&mut self, mesh: &DeckMesh, wanted: &str, faces: &[(String, usize)]) -> String {
        let name = self.free(mesh, wanted);
        self.text += &format!("*SURFACE, NAME={name}, TYPE=ELEMENT\n");
        for (of, face) in faces {
            self.text += &format!("{of}, S{face}\n");
        }
        name
    }

    /// The surface of the faces named by a keyword, made on first use.
    pub fn face_set(
        &mut self,
        mesh: &DeckMesh,
        known: (String, usize),
        wanted: &str,
        faces: &[(String, usize)],
    ) -> String {
        if let Some(name) = self.faces.get(&known) {
            return name.clone();
        }
        let name = self.surface(mesh, wanted, faces);
        self.faces.insert(known, name.clone());
        name
    }

    /// The names in the case of a node set of the deck: of its side, and of its remaining points.
    pub fn of_set(&mut self, mesh: &DeckMesh, place: &DeckPlace, name: &str) -> Result<Vec<String>, DeckFault> {
        if let Some(known) = self.known.get(&name.to_uppercase()) {
            return Ok(known.clone());
        }
        let all = mesh.nodes(place, name)?;
        let nodes: BTreeSet<DeckNodeId> = all.iter().filter(|node| mesh.is_used(node)).copied().collect();
        let spelling = mesh.spelling(DeckSetKind::Nodes, name);
        let hidden = mesh.spelling(DeckSetKind::Surface, name).is_some() || nodes.len() < all.len();
        let wanted = spelling.clone().map_or_else(|| format!("node-{name}"), |spelling| spelling.replace('.', "-"));
        let own = spelling.filter(|_| !hidden);
        let found = self.split(mesh, (own, &wanted), &nodes);
        self.known.insert(name.to_uppercase(), found.clone());
        Ok(found)
    }

    /// Names for nodes: of the side formed by their facets, and of the remaining points. `own` is the name of a set of
    /// the deck with these nodes.
    pub fn split(
        &mut self,
        mesh: &DeckMesh,
        (own, wanted): (Option<String>, &str),
        nodes: &BTreeSet<DeckNodeId>,
    ) -> Vec<String> {
        if nodes.is_empty() {
            return Vec::new();
        }
        let on_facets = mesh.on_facets(nodes);
        let beside: BTreeSet<DeckNodeId> = nodes.difference(&on_facets).copied().collect();
        // A set with facets is a side of these only; the remaining points need their own set.
        let mut found = vec![own.unwrap_or_else(|| self.nodes(mesh, wanted, nodes))];
        if !on_facets.is_empty() && !beside.is_empty() {
            found.push(self.nodes(mesh, &format!("{wanted}-points"), &beside));
        }
        found
    }
}
