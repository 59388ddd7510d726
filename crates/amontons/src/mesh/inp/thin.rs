//! Shells, membranes, plane elements and lines on the boundary of a body of higher dimension, as facets of it.

use std::collections::HashMap;

use super::super::read::{FacetOf, Kind, Loose};
use super::solid::vertices;
use crate::mesh::topology::{SortedFacet, key};

/// The facets of the boundary by their vertices.
pub(super) struct BoundaryFacets {
    free: HashMap<SortedFacet, FacetOf>,
}

impl BoundaryFacets {
    /// The boundary of the cells.
    pub fn of(loose: &Loose) -> BoundaryFacets {
        BoundaryFacets { free: loose.free_facets() }
    }

    /// The boundary facet with the nodes of an element.
    pub fn facet(&self, kind: &Kind, nodes: &[u32]) -> Option<&FacetOf> {
        if let (1, [a, b, c]) = (kind.dim, nodes) {
            // Abaqus puts the middle node between the others, Gmsh after them.
            let ends = [[a, c], [a, b], [b, c]];
            return ends.into_iter().find_map(|ends| self.free.get(&key(ends.into_iter().copied())));
        }
        self.free.get(&key(nodes.iter().copied().take(vertices(kind))))
    }
}
