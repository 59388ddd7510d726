//! The rules of the steps of a problem, and the nodes whose equations are static in them.

use super::ProblemData;
use crate::contact::Contact;
use crate::mass::MassMatrix;
use crate::mesh::FacetSet;
use crate::time::{Analysis, Rule};

impl ProblemData {
    /// The rule of a step of length `k` in s that follows on one of the same length.
    #[must_use]
    pub fn rule(&self, analysis: Analysis, k: f64) -> Rule {
        self.with_mass(analysis.rule(self.scheme, k))
    }

    /// The rule of a step of length `k` in s with no step of the same length before it.
    #[must_use]
    pub fn starting_rule(&self, analysis: Analysis, k: f64) -> Rule {
        self.with_mass(analysis.starting_rule(self.scheme, k))
    }

    fn with_mass(&self, rule: Rule) -> Rule {
        match self.mass {
            MassMatrix::Consistent => rule,
            MassMatrix::Redistributed => rule.with_massless_contact(),
        }
    }

    /// The nodes without mass, ascending: those of all sides in contact if the mass is redistributed. A node that
    /// follows another one in a cyclic body has none if the other one has none.
    #[must_use]
    pub fn massless_nodes(&self) -> Vec<u32> {
        if self.mass == MassMatrix::Consistent || !self.physics.has_mechanics() {
            return Vec::new();
        }
        let sides = self.contacts.iter().flat_map(Contact::sides);
        let mut nodes: Vec<u32> =
            sides.filter_map(|side| self.mesh.named(side)).flat_map(FacetSet::node_list).collect();
        let sorted = |nodes: &mut Vec<u32>| {
            nodes.sort_unstable();
            nodes.dedup();
        };
        sorted(&mut nodes);
        let links = self.links().nodes;
        // First the leaders of nodes in contact, then all that follow those.
        for [from, to] in [[0, 1], [1, 0]] {
            let ends = links.iter().map(|link| [link.node, link.to]);
            let joined = ends.filter(|ends| nodes.binary_search(&ends[from]).is_ok()).map(|ends| ends[to]);
            let joined: Vec<u32> = joined.collect();
            nodes.extend(joined);
            sorted(&mut nodes);
        }
        nodes
    }
}
