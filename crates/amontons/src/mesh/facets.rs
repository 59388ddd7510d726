//! Facets of a mesh: named sets, and the boundary of the body.

use std::collections::{HashMap, HashSet};

use rayon::prelude::*;

use super::{Block, Mesh};
use crate::element::Element;

/// Facets of one element type.
#[derive(Clone, Debug)]
pub struct FacetBlock {
    /// The element of every facet.
    pub element: &'static Element,
    /// Nodes of the facets, `element.nodes.len()` per facet, oriented outward as in [`crate::element::Facet`].
    pub nodes: Vec<u32>,
}

/// A part of the boundary.
#[derive(Clone, Debug, Default)]
pub struct FacetSet {
    /// The facets, grouped by element.
    pub blocks: Vec<FacetBlock>,
}

impl FacetSet {
    /// A set of facets of one element.
    #[must_use]
    pub fn of(element: &'static Element, nodes: Vec<u32>) -> FacetSet {
        FacetSet { blocks: vec![FacetBlock { element, nodes }] }
    }

    /// Adds a facet to the block of its element.
    pub fn push(&mut self, element: &'static Element, nodes: impl IntoIterator<Item = u32>) {
        let place = self.blocks.iter().position(|block| std::ptr::eq(block.element, element)).unwrap_or_else(|| {
            self.blocks.push(FacetBlock { element, nodes: Vec::new() });
            self.blocks.len() - 1
        });
        self.blocks[place].nodes.extend(nodes);
    }

    /// Element and nodes of each facet.
    pub fn facets(&self) -> impl Iterator<Item = (&'static Element, &[u32])> {
        self.blocks
            .iter()
            .flat_map(|block| block.nodes.chunks_exact(block.element.nodes.len()).map(|nodes| (block.element, nodes)))
    }

    /// Number of facets.
    #[must_use]
    pub fn len(&self) -> usize {
        self.blocks.iter().map(|block| block.nodes.len() / block.element.nodes.len()).sum()
    }

    /// True if there are no facets.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.blocks.iter().all(|block| block.nodes.is_empty())
    }

    /// The facets of another set that are also in this one, and the edges and points of the other set on facets of this
    /// one.
    #[must_use]
    pub fn common(&self, other: &FacetSet) -> FacetSet {
        let key = |(element, nodes): &(&'static Element, &[u32])| facet_key(element, nodes.iter().copied());
        let known: HashSet<FacetKey> = self.facets().map(|facet| key(&facet)).collect();
        let (nodes, dim) = (self.node_list(), self.facets().map(|(element, _)| element.dim()).max().unwrap_or(0));
        let is_on = |of: &[u32]| of.iter().all(|node| nodes.binary_search(node).is_ok());
        let mut common = FacetSet::default();
        for facet in other.facets() {
            if known.contains(&key(&facet)) || facet.0.dim() < dim && is_on(facet.1) {
                common.push(facet.0, facet.1.iter().copied());
            }
        }
        common
    }

    /// The nodes of the set, each once, ascending.
    #[must_use]
    pub fn node_list(&self) -> Vec<u32> {
        let mut list: Vec<u32> = self.blocks.iter().flat_map(|block| block.nodes.iter().copied()).collect();
        list.sort_unstable();
        list.dedup();
        list
    }
}

/// The vertices of a facet, ascending: equal for both cells that share it, regardless of orientation.
pub(crate) type FacetKey = [u32; 4];

/// Key of a facet from its nodes, vertices first.
pub(crate) fn facet_key(element: &Element, nodes: impl IntoIterator<Item = u32>) -> FacetKey {
    let mut key = [u32::MAX; 4];
    for (slot, node) in key.iter_mut().zip(nodes).take(element.shape.vertices()) {
        *slot = node;
    }
    key.sort_unstable();
    key
}

impl Mesh {
    /// The boundary of the body: the facets of a single cell, oriented outward, in the order of the cells.
    #[must_use]
    pub fn boundary(&self) -> FacetSet {
        boundary_of(&self.blocks.iter().collect::<Vec<_>>())
    }

    /// The nodes on the boundary of each region, ascending: those of facets with a single cell in the region.
    #[must_use]
    pub fn region_boundaries(&self) -> Vec<Vec<u32>> {
        let regions = self.blocks.iter().map(|block| block.region + 1).max().unwrap_or(0);
        let blocks = |region: usize| self.blocks.iter().filter(|block| block.region == region).collect::<Vec<_>>();
        (0..regions).map(|region| boundary_of(&blocks(region)).node_list()).collect()
    }

    /// The cell bounded by each facet of a set, as block and cell in the block; `None` if it bounds no cell, the first
    /// of both cells if it lies inside the body.
    #[must_use]
    pub fn cells_of(&self, set: &FacetSet) -> Vec<Option<(usize, usize)>> {
        let keys: Vec<FacetKey> =
            set.facets().map(|(element, nodes)| facet_key(element, nodes.iter().copied())).collect();
        let mut cells: HashMap<FacetKey, Option<(usize, usize)>> = keys.iter().map(|key| (*key, None)).collect();
        for (b, block) in self.blocks.iter().enumerate() {
            for (c, cell) in block.cells().enumerate() {
                for facet in block.element.facets {
                    if let Some(found @ None) =
                        cells.get_mut(&facet_key(facet.element, facet.nodes.iter().map(|&local| cell[local])))
                    {
                        *found = Some((b, c));
                    }
                }
            }
        }
        keys.iter().map(|key| cells.get(key).copied().flatten()).collect()
    }

    /// Facets of the boundary that belong to no facet set.
    #[must_use]
    pub fn unnamed_boundary_facets(&self) -> usize {
        let named: HashSet<FacetKey> = self
            .facets
            .values()
            .flat_map(|set| set.facets().map(|(element, nodes)| facet_key(element, nodes.iter().copied())))
            .collect();
        self.boundary()
            .facets()
            .filter(|(element, nodes)| !named.contains(&facet_key(element, nodes.iter().copied())))
            .count()
    }
}

/// The facets with a single cell among some blocks, oriented outward, in the order of the cells.
fn boundary_of(blocks: &[&Block]) -> FacetSet {
    let cells = blocks.iter().flat_map(|block| block.cells().map(|cell| (block.element, cell)));
    let facets = cells.flat_map(|(element, cell)| {
        element.facets.iter().map(|facet| facet_key(facet.element, facet.nodes.iter().map(|&local| cell[local])))
    });
    let mut sorted: Vec<(FacetKey, usize)> = facets.enumerate().map(|(place, key)| (key, place)).collect();
    sorted.par_sort_unstable();
    let mut is_single = vec![false; sorted.len()];
    for same in sorted.chunk_by(|a, b| a.0 == b.0) {
        if let [(_, place)] = same {
            is_single[*place] = true;
        }
    }
    let mut set = FacetSet::default();
    let mut is_single = is_single.into_iter();
    for block in blocks {
        for cell in block.cells() {
            for (facet, _) in block.element.facets.iter().zip(is_single.by_ref()).filter(|(_, is_single)| *is_single) {
                set.push(facet.element, facet.nodes.iter().map(|&local| cell[local]));
            }
        }
    }
    set
}
