//! Meshes: points, blocks of cells with their region, and named sets of boundary facets.

mod assembly;
mod bisect;
mod convert;
mod cyclic;
mod data;
pub mod defects;
pub mod exodus;
mod facets;
mod formats;
mod generate;
mod geometry;
pub mod gmsh;
pub mod inp;
mod locator;
mod locus;
pub mod mail;
pub mod med;
mod quality;
mod read;
mod refine;
mod round;
mod sites;
mod spheres;
pub mod stl;
mod surface;
mod topology;
pub mod vtu;

use std::collections::BTreeMap;

pub use bisect::{Bisection, MarkedCells, RefinementRounds, RoundSide, RoundsError, decisive_cells};
pub use cyclic::{Cyclic, Link, Links, NotCyclic, leader, link_of};
pub use data::MeshData;
pub use facets::{FacetBlock, FacetSet};
pub(crate) use facets::{FacetKey, facet_key};
pub use formats::{EXTENSIONS, parse, parse_file, read, read_all, read_confined};
pub use generate::{Diagonal, Elements, rectangle_nodes};
pub use geometry::{CellMap, FacetMap};
pub(crate) use geometry::{cross, invert};
pub use locator::Locator;
pub(crate) use locator::{CellPlace, OUTSIDE, reference_point};
pub use locus::Locus;
pub use read::{FilePosition, Include, MeshFile, MeshFileError, PlaneState, Skipped};

pub(crate) use spheres::Spheres;

use crate::element::{Element, ShapeTable};
use crate::tensor::{Point, Sym, length, minus};

/// Tolerance of a node at given coordinates, for their rounding, relative to the size of the body.
const NEAR: f64 = 1e-6;

/// A fault of a mesh or of the parameters of a generator.
#[derive(Debug, Clone, PartialEq)]
pub enum MeshError {
    /// A generator was given a length that is not positive and finite.
    Size {
        /// 0, 1 or 2.
        direction: usize,
        /// The length given.
        found: f64,
    },
    /// A generator was given no cells in a direction.
    Cells {
        /// 0, 1 or 2.
        direction: usize,
        /// The number given.
        found: usize,
    },
    /// More nodes than a 32-bit index can name.
    TooLarge {
        /// Number of nodes asked for.
        found: f64,
    },
    /// An angle of a sector that is not between 0 and 2π.
    Angle {
        /// The angle given, in rad.
        found: f64,
    },
    /// An inner radius that is not smaller than the outer one.
    Radii {
        /// Inner radius.
        inner: f64,
        /// Outer radius.
        outer: f64,
    },
    /// A number of cells around that cannot close a ring.
    Around {
        /// The number given.
        found: usize,
        /// The requirement.
        expected: &'static str,
    },
    /// A conversion that the library supports for some elements only.
    Elements {
        /// The conversion.
        what: &'static str,
        /// Name of the element.
        found: &'static str,
    },
    /// A body of revolution that extends beyond its axis.
    Axis {
        /// The node.
        node: usize,
        /// Its first coordinate.
        found: f64,
    },
    /// A cell or a facet refers to a missing node.
    Node {
        /// `a cell`, or `a facet of` a side.
        what: String,
        /// The node.
        node: u32,
        /// Number of nodes of the mesh.
        nodes: usize,
    },
    /// A cell to be refined does not exist.
    Marked {
        /// The cell.
        cell: usize,
        /// Number of cells of the mesh.
        cells: usize,
    },
    /// A cell has no positive measure.
    Cell {
        /// Block of cells.
        block: usize,
        /// Cell in the block.
        cell: usize,
        /// Its signed measure, from the least Jacobian at its quadrature points.
        measure: f64,
    },
}

impl MeshError {
    /// The fault in words, for messages.
    #[must_use]
    pub fn found(&self) -> String {
        match self {
            MeshError::Size { direction, found } => format!("the size of the mesh in direction {direction} is {found}"),
            MeshError::Cells { direction, found } => format!("the mesh has {found} cells in direction {direction}"),
            MeshError::TooLarge { found } => {
                format!("the mesh would have {found:.3e} nodes, more than the {} that can be numbered", u32::MAX)
            }
            MeshError::Angle { found } => format!("the angle of the sector is {found}"),
            MeshError::Radii { inner, outer } => {
                format!("the inner radius {inner} is not smaller than the outer one, {outer}")
            }
            MeshError::Around { found, .. } => format!("{found} cells around"),
            MeshError::Elements { what, found } => format!("{what} is not possible for cells of {found}"),
            MeshError::Axis { node, found } => format!("node {node} has r = {found:.6e}"),
            MeshError::Node { what, node, .. } => format!("{what} names node {node}"),
            MeshError::Marked { cell, .. } => format!("cell {cell} is marked"),
            MeshError::Cell { block, cell, measure } => {
                format!("cell {cell} of block {block} has measure {measure:.3e}")
            }
        }
    }

    /// The value expected, for messages; `None` if it is obvious.
    #[must_use]
    pub fn expected(&self) -> Option<String> {
        let expected = match self {
            MeshError::Size { .. } => "a positive length",
            MeshError::Cells { .. } => "at least 1",
            MeshError::Angle { .. } => "more than 0 and less than 2π",
            MeshError::Around { expected, .. } => expected,
            MeshError::Axis { .. } => "none below 0: the axis of an axisymmetric body is x = 0",
            MeshError::Node { nodes, .. } => return Some(format!("one below {nodes}, the number of nodes")),
            MeshError::Marked { cells, .. } => return Some(format!("one below {cells}, the number of cells")),
            MeshError::Cell { .. } => "a positive one: it is inverted or flat",
            MeshError::TooLarge { .. } | MeshError::Radii { .. } | MeshError::Elements { .. } => return None,
        };
        Some(expected.to_owned())
    }
}

impl std::fmt::Display for MeshError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.found())?;
        self.expected().map_or(Ok(()), |expected| write!(f, ", expected {expected}"))
    }
}

impl std::error::Error for MeshError {}

/// Cells of one element type and region.
#[derive(Clone, Debug)]
pub struct Block {
    /// The element of every cell.
    pub element: &'static Element,
    /// Index into [`Mesh::regions`].
    pub region: usize,
    /// Nodes of the cells, `element.nodes.len()` per cell.
    pub nodes: Vec<u32>,
}

impl Block {
    /// Number of cells.
    #[must_use]
    pub fn len(&self) -> usize {
        self.nodes.len() / self.element.nodes.len()
    }

    /// True if the block has no cells.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Nodes of each cell.
    pub fn cells(&self) -> impl Iterator<Item = &[u32]> {
        self.nodes.chunks_exact(self.element.nodes.len())
    }

    /// Nodes of each cell that VTK lists, see [`Element::vtk_nodes`].
    pub(crate) fn vtk_cells(&self) -> impl Iterator<Item = &[u32]> {
        let listed = self.element.vtk_nodes();
        self.cells().map(move |cell| cell.get(..listed).unwrap_or(cell))
    }
}

/// Distance from the axis of revolution that is round-off, relative to the size of the body.
const ON_AXIS: f64 = 1e-12;

/// A mesh of a body in d dimensions.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// Spatial dimension d.
    pub dim: usize,
    /// True for a body of revolution, of which the mesh with d = 2 is the half section: x is the distance r from the
    /// axis and y the height. Integrals are then taken over the whole body, 2πr dr dz.
    pub axisymmetric: bool,
    /// Thickness of a plane body in m: integrals are then taken over the whole body. `None` for integrals per metre of
    /// thickness; ignored for other bodies.
    pub thickness: Option<f64>,
    /// Coordinates of the nodes in m.
    pub points: Vec<Point>,
    /// The cells.
    pub blocks: Vec<Block>,
    /// Names of the regions.
    pub regions: Vec<String>,
    /// Named parts of the boundary.
    pub facets: BTreeMap<String, FacetSet>,
    /// Named edges and points: sets of elements of dimension d − 2 or less.
    pub edges: BTreeMap<String, FacetSet>,
}

impl Mesh {
    /// The side of a name, or else the edges or points of that name.
    #[must_use]
    pub fn named(&self, name: &str) -> Option<&FacetSet> {
        self.facets.get(name).or_else(|| self.edges.get(name))
    }

    /// The nodes with these coordinates, up to rounding; several if bodies touch.
    #[must_use]
    pub fn nodes_at(&self, at: &Point) -> Vec<u32> {
        let size = (0..self.dim).map(|d| {
            let along = || self.points.iter().map(|x| x[d]);
            along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
        });
        let near = NEAR * size.fold(0.0, f64::max);
        let away = |x: &Point| length(&minus(x, at));
        (0..).zip(&self.points).filter(|(_, x)| away(x) <= near).map(|(node, _)| node).collect()
    }

    /// Number of cells.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        self.blocks.iter().map(Block::len).sum()
    }

    /// Factor of measures of a plane body; 1 without a thickness, and for all other bodies.
    pub(crate) fn thickness(&self) -> f64 {
        let is_plane = self.dim == 2 && !self.axisymmetric;
        self.thickness.filter(|_| is_plane).unwrap_or(1.0)
    }

    /// Dimension of the tensors of a body: d, or 3 for a body of revolution, whose strain has a hoop component.
    #[must_use]
    pub fn tensor_dim(&self) -> usize {
        if self.axisymmetric { 3 } else { self.dim }
    }

    /// Checks that cells and facets name existing nodes. Call this before any other method.
    ///
    /// # Errors
    /// [`MeshError::Node`] with the first missing node.
    pub fn check_nodes(&self) -> Result<(), MeshError> {
        let nodes = self.points.len();
        let unknown = |list: &[u32]| list.iter().copied().find(|&node| node as usize >= nodes);
        let cells = self.blocks.iter().filter_map(|block| Some(("a cell".to_owned(), unknown(&block.nodes)?)));
        let sides = self
            .facets
            .iter()
            .chain(&self.edges)
            .flat_map(|(name, set)| set.blocks.iter().map(move |block| (name, block)));
        let facets = sides.filter_map(|(name, block)| Some((format!("a facet of \"{name}\""), unknown(&block.nodes)?)));
        match cells.chain(facets).next() {
            Some((what, node)) => Err(MeshError::Node { what, node, nodes }),
            None => Ok(()),
        }
    }

    /// Largest distance from the axis of revolution that is round-off, of the size of the body and of the coordinates
    /// that it was turned or moved with.
    fn round_off_of_axis(&self) -> f64 {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for x in &self.points {
            for d in 0..2 {
                (low[d], high[d]) = (low[d].min(x[d]), high[d].max(x[d]));
            }
        }
        let size = (0..2).map(|d| high[d] - low[d]).fold(0.0, f64::max);
        let farthest = (0..2).map(|d| high[d].abs().max(low[d].abs())).fold(0.0, f64::max);
        let least = (ON_AXIS * size).max(4.0 * f64::EPSILON * farthest);
        if least.is_finite() { least } else { 0.0 }
    }

    /// Moves the nodes of a body of revolution that are on the axis up to round-off exactly onto it, as after a
    /// rotation or in a file from another program. Other bodies are unchanged.
    #[must_use]
    pub fn onto_axis(mut self) -> Mesh {
        if self.axisymmetric {
            let least = self.round_off_of_axis();
            self.points.iter_mut().filter(|x| x[0].abs() <= least).for_each(|x| x[0] = 0.0);
        }
        self
    }

    /// Checks that every cell has a positive Jacobian at its quadrature points, beyond the round-off of its size.
    ///
    /// # Errors
    /// Reports the first inverted cell, a node of a body of revolution with r < 0, or a missing node.
    pub fn check(&self) -> Result<(), MeshError> {
        self.check_nodes()?;
        if self.axisymmetric
            && let Some(node) = self.points.iter().position(|p| p[0] < -self.round_off_of_axis())
        {
            return Err(MeshError::Axis { node, found: self.points[node][0] });
        }
        // The sign of the Jacobian is that of the plane map, also for a body of revolution.
        let dim = self.dim as i32;
        for (b, block) in self.blocks.iter().enumerate() {
            // Affine cells have one Jacobian; the others are checked at more points than the forms use.
            let affine = block.element.is_simplex() && block.element.degree == 1;
            let table = ShapeTable::new(block.element, if affine { 0 } else { 2 * block.element.degree + 2 });
            let mut map = CellMap::new(self, &table);
            for (c, nodes) in block.cells().enumerate() {
                let mut least = f64::INFINITY;
                for q in 0..table.len() {
                    map.at(nodes, q);
                    least = if map.jacobian.is_nan() { f64::NAN } else { least.min(map.jacobian) };
                }
                let round_off = 4.0 * f64::EPSILON * self.edges(block.element, nodes).1.powi(dim);
                if least.is_nan() || least <= round_off {
                    return Err(MeshError::Cell { block: b, cell: c, measure: least * block.element.shape.measure() });
                }
            }
        }
        Ok(())
    }

    /// The strain ε = ½(∇v + ∇vᵀ) of a vector field from its gradient; `radial` is v_r/r, the hoop strain ε_θθ of a
    /// body of revolution, ignored for others.
    #[must_use]
    pub fn strain(&self, gradient: &[[f64; 3]; 3], radial: f64) -> Sym {
        let mut strain = Sym::from_fn(self.dim, |i, j| 0.5 * (gradient[i][j] + gradient[j][i]));
        if self.axisymmetric {
            strain.0[3] = radial;
        }
        strain
    }

    /// Shortest and longest distance of two vertices of a cell.
    fn edges(&self, element: &Element, nodes: &[u32]) -> (f64, f64) {
        let vertices = &nodes[..element.shape.vertices().min(nodes.len())];
        let (mut shortest, mut longest) = (f64::INFINITY, 0.0f64);
        for (i, &a) in vertices.iter().enumerate() {
            for &b in &vertices[..i] {
                let (p, q) = (&self.points[a as usize], &self.points[b as usize]);
                let edge = length(&minus(p, q));
                shortest = shortest.min(edge);
                longest = longest.max(edge);
            }
        }
        (shortest, longest)
    }

    /// Spacing of the mesh: the shortest edge of its longest-edged cell, which is the paper's h = 1/n for a square
    /// divided into n × n squares with diagonals.
    #[must_use]
    pub fn spacing(&self) -> f64 {
        self.blocks
            .iter()
            .flat_map(|block| block.cells().map(|cell| self.edges(block.element, cell).0))
            .fold(0.0, f64::max)
    }

    /// Longest distance of two vertices of a cell, the diameter h of the estimates.
    #[must_use]
    pub fn h(&self) -> f64 {
        self.blocks
            .iter()
            .flat_map(|block| block.cells().map(|cell| self.edges(block.element, cell).1))
            .fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests;
