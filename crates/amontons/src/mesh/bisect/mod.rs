//! Refinement of some cells of a mesh by bisection, with a closure that keeps the mesh conforming.
//!
//! Triangles are bisected at the edge opposite their newest vertex, tetrahedra by the marks of Arnold, Mukherjee and
//! Pouly (2000); both begin with the longest edge. The marks come from one order of all edges, hence agree on common
//! faces, for any conforming mesh; then the closure ends and the cells have a bounded number of shapes. A
//! quadrilateral is first cut into four triangles about its centre, a hexahedron or prism into pyramids and tetrahedra.

mod cell;
mod marking;
mod nodes;
mod order;
mod rounds;

use std::collections::BTreeMap;

use self::cell::{CutCell, Cuttable, Cutter, middles_of};
pub use self::marking::decisive_cells;
use self::nodes::BisectionNodes;
pub use self::nodes::RoundSide;
use self::order::EdgeOrder;
pub use self::rounds::{MarkedCells, RefinementRounds, RoundsError};
use super::{Block, FacetSet, Mesh, MeshError};
use crate::element::{ALL, Element};

impl Mesh {
    /// A conforming mesh in which every edge of the cells `marked` is cut in two, and as few others as that takes.
    /// Cells are numbered through the blocks. Existing nodes keep their numbers; new ones lie on the cells, so that
    /// curved cells keep their shape and regions and sides their measure.
    ///
    /// Keep a [`Bisection`] for several rounds: the shapes of cells are bounded over all rounds only with its marks.
    ///
    /// # Errors
    /// [`MeshError::Marked`] for a missing cell; [`MeshError::TooLarge`].
    pub fn refined_where(&self, marked: &[usize]) -> Result<Mesh, MeshError> {
        let mut bisection = Bisection::new(self);
        bisection.refine(marked)?;
        Ok(bisection.mesh())
    }
}

/// A mesh that is refined in rounds, with the marks of its cells.
pub struct Bisection {
    start: Mesh,
    cutter: Cutter,
    cells: Vec<CutCell>,
    facets: BTreeMap<String, Vec<CutCell>>,
    edges: BTreeMap<String, Vec<CutCell>>,
}

impl Bisection {
    /// Begins with a conforming mesh.
    #[must_use]
    pub fn new(mesh: &Mesh) -> Bisection {
        let mut cutter = Cutter { nodes: BisectionNodes::new(mesh), order: EdgeOrder::new(mesh) };
        for block in &mesh.blocks {
            let middles = middles_of(block.element);
            block.cells().for_each(|cell| cutter.nodes.know(block.element, cell, &middles));
        }
        let blocks = mesh.blocks.iter().enumerate();
        let cells = blocks.flat_map(|(b, block)| block.cells().map(move |cell| (block.element, cell, b)));
        let cells = cells.map(|(element, nodes, block)| cutter.cell(element, nodes, block)).collect();
        let sets = |sets: &BTreeMap<String, FacetSet>| -> BTreeMap<String, Vec<CutCell>> {
            let of_set = |set: &FacetSet| set.facets().map(|(element, nodes)| cutter.cell(element, nodes, 0)).collect();
            sets.iter().map(|(name, set)| (name.clone(), of_set(set))).collect()
        };
        let (facets, edges) = (sets(&mesh.facets), sets(&mesh.edges));
        let none = BTreeMap::new();
        let start = Mesh {
            points: Vec::new(),
            blocks: mesh.blocks.iter().map(|block| Block { nodes: Vec::new(), ..*block }).collect(),
            regions: mesh.regions.clone(),
            facets: none.clone(),
            edges: none,
            ..*mesh
        };
        Bisection { start, cutter, cells, facets, edges }
    }

    /// Puts new nodes of a side onto its circle or cylinder. Every edge between two nodes of the side has to lie on it,
    /// as in the generated round meshes.
    #[must_use]
    pub fn around(mut self, nodes: &[u32], round: RoundSide) -> Bisection {
        self.cutter.nodes.add_round(round, nodes);
        self
    }

    /// Number of cells.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        self.cells.len()
    }

    /// Cuts every edge of the cells `marked` of [`Bisection::mesh`], and what else has to be cut for a conforming mesh.
    ///
    /// # Errors
    /// [`MeshError::Marked`] for a missing cell; [`MeshError::TooLarge`].
    pub fn refine(&mut self, marked: &[usize]) -> Result<(), MeshError> {
        let cells = self.cells.len();
        if let Some(&cell) = marked.iter().find(|&&cell| cell >= cells) {
            return Err(MeshError::Marked { cell, cells });
        }
        self.cutter.nodes.start_round();
        let edges = marked.iter().flat_map(|&cell| Cutter::edges(&self.cells[cell]));
        for edge in edges.collect::<Vec<_>>() {
            self.cutter.nodes.cut(edge);
        }
        // A pass may cut edges of cells before; it ends because all cuts are among those of uniform refinement.
        let mut before = 0;
        while before < self.cutter.nodes.cuts() {
            before = self.cutter.nodes.cuts();
            self.cells = cut_all(&mut self.cutter, std::mem::take(&mut self.cells));
            let found = self.cutter.nodes.points.len();
            if found > u32::MAX as usize {
                return Err(MeshError::TooLarge { found: found as f64 });
            }
        }
        for set in self.facets.values_mut().chain(self.edges.values_mut()) {
            *set = cut_all(&mut self.cutter, std::mem::take(set));
        }
        let kind = |element: &Element| ALL.iter().position(|other| std::ptr::eq(*other, element));
        let blocks = &self.start.blocks;
        self.cells.sort_by_cached_key(|cell| {
            let is_own = blocks.get(cell.block).is_some_and(|block| std::ptr::eq(block.element, cell.element));
            (cell.block, !is_own, kind(cell.element))
        });
        Ok(())
    }

    /// Halves every edge, as [`Mesh::refined`] does: a quadrilateral becomes four. Later rounds begin with the longest
    /// edges of the new cells.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`].
    pub fn halve(&mut self) -> Result<(), MeshError> {
        let mesh = self.mesh();
        let found = mesh.points.len() as f64 * 2f64.powi(mesh.dim as i32);
        if found > f64::from(u32::MAX) {
            return Err(MeshError::TooLarge { found });
        }
        let (mut mesh, origins) = mesh.refined_with_origins()?;
        let sides = self.cutter.nodes.halved(&mut mesh, &origins);
        *self = sides.into_iter().fold(Bisection::new(&mesh), |made, (nodes, side)| made.around(&nodes, side));
        Ok(())
    }

    /// The mesh as it is. Cells of new elements follow those of the block from which they come.
    #[must_use]
    pub fn mesh(&mut self) -> Mesh {
        let mut blocks: Vec<Block> = Vec::new();
        let mut last = None;
        let mut middles = Vec::new();
        for cell in &self.cells {
            if last != Some((cell.block, cell.element.name)) {
                last = Some((cell.block, cell.element.name));
                middles = middles_of(cell.element);
                let region = self.start.blocks.get(cell.block).map_or(0, |block| block.region);
                blocks.push(Block { element: cell.element, region, nodes: Vec::new() });
            }
            let nodes = nodes_of(&mut self.cutter, cell, &middles);
            if let Some(block) = blocks.last_mut() {
                block.nodes.extend(nodes);
            }
        }
        let cutter = &mut self.cutter;
        let mut sets = |sets: &BTreeMap<String, Vec<CutCell>>| -> BTreeMap<String, FacetSet> {
            let mut all = BTreeMap::new();
            for (name, cells) in sets {
                let mut set = FacetSet::default();
                for cell in cells {
                    set.push(cell.element, nodes_of(cutter, cell, &middles_of(cell.element)));
                }
                all.insert(name.clone(), set);
            }
            all
        };
        let (facets, edges) = (sets(&self.facets), sets(&self.edges));
        let points = self.cutter.nodes.points.clone();
        Mesh { points, blocks, regions: self.start.regions.clone(), facets, edges, ..self.start }
    }
}

/// Cuts all cells that have a cut edge.
fn cut_all(cutter: &mut Cutter, cells: Vec<CutCell>) -> Vec<CutCell> {
    let mut out = Vec::with_capacity(cells.len());
    for cell in cells {
        cutter.cut(cell, &mut out);
    }
    out
}

/// All nodes of a cell or a facet.
fn nodes_of(cutter: &mut Cutter, cell: &CutCell, middles: &[Vec<usize>]) -> Vec<u32> {
    match &cell.what {
        Cuttable::Segment(vertices) => cutter.with_middles(vertices, middles),
        Cuttable::Triangle(vertices, _) => cutter.with_middles(vertices, middles),
        Cuttable::Tetrahedron(marked) => cutter.with_middles(&marked.vertices, middles),
        Cuttable::Whole(nodes) => nodes.clone(),
    }
}
