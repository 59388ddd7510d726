//! Cells that share facets.

use super::Mesh;
use crate::element::Element;

/// Nodes of a facet, ascending, followed by `u32::MAX`.
pub(super) type SortedFacet = [u32; 9];

/// The key of a facet with these nodes, at most nine.
pub(super) fn key(nodes: impl Iterator<Item = u32>) -> SortedFacet {
    let mut key = [u32::MAX; 9];
    let mut count = 0;
    for (place, node) in key.iter_mut().zip(nodes) {
        *place = node;
        count += 1;
    }
    key[..count].sort_unstable();
    key
}

/// A facet of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Owner {
    pub block: u32,
    /// Cell in the block.
    pub cell: u32,
    /// Facet of the cell.
    pub facet: u32,
}

impl Owner {
    /// Nodes of the cell.
    pub(super) fn cell(self, mesh: &Mesh) -> &[u32] {
        let block = &mesh.blocks[self.block as usize];
        let n = block.element.nodes.len();
        &block.nodes[self.cell as usize * n..(self.cell as usize + 1) * n]
    }

    /// Element and nodes of the facet, oriented outward.
    pub(super) fn facet(self, mesh: &Mesh) -> (&'static Element, impl Iterator<Item = u32> + Clone + '_) {
        let facet = &mesh.blocks[self.block as usize].element.facets[self.facet as usize];
        let cell = self.cell(mesh);
        (facet.element, facet.nodes.iter().map(|&n| cell[n]))
    }

    /// Number of the cell among all cells of the mesh.
    pub(super) fn number(self, mesh: &Mesh) -> usize {
        mesh.blocks.iter().take(self.block as usize).map(super::Block::len).sum::<usize>() + self.cell as usize
    }
}

/// Visits every facet once with its cells, in the order of its key. Facets are binned by their lowest node and sorted
/// there, so the work is nearly linear in the number of cells.
pub(super) fn by_facet(mesh: &Mesh, mut visit: impl FnMut(&SortedFacet, &[Owner])) {
    let each = |body: &mut dyn FnMut(usize, Owner)| {
        for (b, block) in mesh.blocks.iter().enumerate() {
            for (c, cell) in block.cells().enumerate() {
                for (f, facet) in block.element.facets.iter().enumerate() {
                    let lowest = facet.nodes.iter().map(|&n| cell[n]).min().unwrap_or(0);
                    body(lowest as usize, Owner { block: b as u32, cell: c as u32, facet: f as u32 });
                }
            }
        }
    };
    let mut starts = vec![0_usize; mesh.points.len() + 1];
    each(&mut |lowest, _| starts[lowest + 1] += 1);
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    let mut owners = vec![Owner::default(); starts[mesh.points.len()]];
    let mut next = starts.clone();
    each(&mut |lowest, owner| {
        owners[next[lowest]] = owner;
        next[lowest] += 1;
    });
    let mut bin: Vec<(SortedFacet, Owner)> = Vec::new();
    let mut same: Vec<Owner> = Vec::new();
    for range in starts.windows(2) {
        bin.clear();
        bin.extend(owners[range[0]..range[1]].iter().map(|&owner| (key(owner.facet(mesh).1), owner)));
        bin.sort_unstable();
        for group in bin.chunk_by(|a, b| a.0 == b.0) {
            same.clear();
            same.extend(group.iter().map(|(_, owner)| *owner));
            visit(&group[0].0, &same);
        }
    }
}
