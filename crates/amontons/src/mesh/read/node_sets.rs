//! Node sets of a file, and the sides, edges or points that they define.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use super::loose::{Kind, Loose, LooseBlock, NodeSet};
use crate::element::{Element, Facet, POINT_LEFT};
use crate::mesh::topology::{SortedFacet, key};

/// A facet of a cell of the file, with those of its nodes that the file has.
#[derive(Clone, Debug)]
pub(in crate::mesh) struct FacetOf {
    facet: &'static Facet,
    nodes: Vec<u32>,
}

impl FacetOf {
    /// The facet of a cell that may lack nodes in the middle of its faces.
    pub(in crate::mesh) fn new(facet: &'static Facet, cell: &[u32]) -> FacetOf {
        FacetOf { facet, nodes: facet.nodes.iter().filter_map(|&node| cell.get(node).copied()).collect() }
    }

    /// Its key: the vertices.
    pub(in crate::mesh) fn key(&self) -> SortedFacet {
        key(self.nodes.iter().copied().take(self.facet.element.shape.vertices()))
    }
}

impl Kind {
    /// An element of the library with `given` of its nodes in the file.
    pub(in crate::mesh) fn of(element: &'static Element, given: usize) -> Kind {
        Kind { name: element.name, dim: element.dim(), nodes: given, element: Some(element) }
    }
}

impl Loose {
    /// Largest dimension of the elements.
    pub(in crate::mesh) fn dim(&self) -> usize {
        self.blocks.iter().filter(|block| !block.nodes.is_empty()).map(|block| block.kind.dim).max().unwrap_or(0)
    }

    /// Adds an element, to the last block if that is of the same kind.
    pub(in crate::mesh) fn push(&mut self, kind: Kind, groups: &BTreeSet<i64>, at: usize, nodes: &[u32]) {
        let same = |block: &&mut LooseBlock| {
            block.groups == *groups
                && block.kind.nodes == kind.nodes
                && block.kind.name == kind.name
                && block.kind.dim == kind.dim
        };
        if let Some(block) = self.blocks.last_mut().filter(same) {
            block.nodes.extend(nodes);
        } else {
            let (groups, nodes) = (groups.clone(), nodes.to_vec());
            self.blocks.push(LooseBlock { kind, groups, at, nodes, numbers: Vec::new() });
        }
    }

    /// Adds a named group and returns its tag.
    pub(in crate::mesh) fn group(&mut self, dim: usize, name: String) -> BTreeSet<i64> {
        let last = self.names.range((dim, i64::MIN)..=(dim, i64::MAX)).next_back().map_or(-1, |((_, tag), _)| *tag);
        self.names.insert((dim, last + 1), name);
        BTreeSet::from([last + 1])
    }

    /// Adds facets as a named side.
    pub(in crate::mesh) fn side(&mut self, name: String, facets: &[FacetOf]) {
        let Some(first) = facets.first() else { return };
        let groups = self.group(first.facet.element.dim(), name);
        self.facets(&groups, facets);
    }

    /// Adds facets with these groups.
    pub(in crate::mesh) fn facets(&mut self, groups: &BTreeSet<i64>, facets: &[FacetOf]) {
        for FacetOf { facet, nodes } in facets {
            self.push(Kind::of(facet.element, nodes.len()), groups, 0, nodes);
        }
    }

    /// The facets with a single cell.
    pub(in crate::mesh) fn free(&self) -> HashSet<SortedFacet> {
        let mut count: HashMap<SortedFacet, bool> = HashMap::new();
        self.each_facet(|facet| {
            count.entry(facet.key()).and_modify(|once| *once = false).or_insert(true);
        });
        count.into_iter().filter_map(|(key, once)| once.then_some(key)).collect()
    }

    /// The facets with a single cell, by their vertices.
    pub(in crate::mesh) fn free_facets(&self) -> HashMap<SortedFacet, FacetOf> {
        let (free, mut facets) = (self.free(), HashMap::new());
        self.each_facet(|facet| {
            let key = facet.key();
            if free.contains(&key) {
                facets.insert(key, facet);
            }
        });
        facets
    }

    /// Calls `look` for all facets of the cells of the highest dimension.
    fn each_facet(&self, mut look: impl FnMut(FacetOf)) {
        let dim = self.dim();
        for block in self.blocks.iter().filter(|block| block.kind.dim == dim) {
            let facets = block.kind.element.map_or(&[][..], |element| element.facets);
            for cell in block.nodes.chunks_exact(block.kind.nodes.max(1)) {
                for facet in facets {
                    look(FacetOf::new(facet, cell));
                }
            }
        }
    }

    /// Makes sides of the node sets that contain all nodes of facets of the boundary. Of the others it makes edges if
    /// the edges of cells in space cover all their nodes, else points. A set with the name of an existing side is
    /// dropped: nodes at a rim may contain an additional facet.
    pub(super) fn resolve_node_sets(&mut self) {
        let mut sets = std::mem::take(&mut self.node_sets);
        let below = self.dim().saturating_sub(1);
        let named: HashSet<&String> =
            self.names.iter().filter(|((dim, _), _)| *dim == below).map(|(_, name)| name).collect();
        sets.retain(|set| !named.contains(&set.name));
        let any: HashSet<u32> = sets.iter().flat_map(|set| set.nodes.iter().copied()).collect();
        if any.is_empty() {
            return;
        }
        let free = self.free();
        let (mut facets, mut edges): (Vec<FacetOf>, BTreeMap<SortedFacet, (&'static Element, Vec<u32>)>) =
            Default::default();
        self.each_facet(|of| {
            for edge in of.facet.element.facets.iter().filter(|edge| edge.element.dim() == 1) {
                let nodes: Vec<u32> = edge.nodes.iter().filter_map(|&node| of.nodes.get(node).copied()).collect();
                if nodes.iter().all(|node| any.contains(node)) {
                    edges.entry(key(nodes.iter().copied())).or_insert((edge.element, nodes));
                }
            }
            if of.nodes.iter().all(|node| any.contains(node)) && free.contains(&of.key()) {
                facets.push(of);
            }
        });
        for NodeSet { name, nodes } in sets {
            let has = |list: &[u32]| list.iter().all(|node| nodes.contains(node));
            let on_side: Vec<FacetOf> = facets.iter().filter(|facet| has(&facet.nodes)).cloned().collect();
            let inside: Vec<_> = edges.values().filter(|(_, edge)| has(edge)).collect();
            let on_edges: BTreeSet<u32> = inside.iter().flat_map(|(_, edge)| edge.iter().copied()).collect();
            if !on_side.is_empty() {
                self.side(name, &on_side);
            } else if on_edges.len() == nodes.len() {
                let groups = self.group(1, name);
                for (element, edge) in inside {
                    self.push(Kind::of(element, edge.len()), &groups, 0, edge);
                }
            } else {
                let groups = self.group(0, name);
                for node in nodes {
                    self.push(Kind::of(&POINT_LEFT, 1), &groups, 0, &[node]);
                }
            }
        }
    }
}
