//! Meshes: points, blocks of cells with their region, and named sets of boundary facets.

use std::collections::{BTreeMap, HashMap};

use crate::element::{Element, P1_TRIANGLE};
use crate::tensor::{Point, dot, length};

/// What is wrong with a mesh or with the numbers that describe one.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// A generator was given a length that is not positive and finite.
    #[error("the size of the mesh in direction {direction} is {found}, expected a positive length")]
    Size {
        /// 0, 1 or 2.
        direction: usize,
        /// The length given.
        found: f64,
    },
    /// A generator was given no cells in a direction.
    #[error("the mesh has {found} cells in direction {direction}, expected at least 1")]
    Cells {
        /// 0, 1 or 2.
        direction: usize,
        /// The number given.
        found: usize,
    },
    /// More nodes than a 32-bit index can name.
    #[error("the mesh would have {found:.3e} nodes, more than the {} that can be numbered", u32::MAX)]
    TooLarge {
        /// Number of nodes asked for.
        found: f64,
    },
    /// A cell has no positive measure.
    #[error("cell {cell} of block {block} has measure {measure:.3e}, expected a positive one: it is inverted or flat")]
    Cell {
        /// Block of cells.
        block: usize,
        /// Cell in the block.
        cell: usize,
        /// Its signed measure.
        measure: f64,
    },
}

/// How the squares of a rectangle mesh are cut into triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Diagonal {
    /// From lower left to upper right: /.
    #[default]
    Right,
    /// From upper left to lower right: \.
    Left,
    /// Both, with a node in the middle: ×.
    Crossed,
}

/// Cells of one element type and region.
#[derive(Clone, Debug)]
pub struct Block {
    /// The element of every cell.
    pub element: &'static Element,
    /// Index into [`Mesh::regions`].
    pub region: usize,
    /// Nodes of the cells, `element.nodes.len()` a cell.
    pub nodes: Vec<u32>,
}

impl Block {
    /// Number of cells.
    #[must_use]
    pub fn len(&self) -> usize {
        self.nodes.len() / self.element.nodes.len()
    }

    /// Whether the block has no cells.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Nodes of each cell.
    pub fn cells(&self) -> impl Iterator<Item = &[u32]> {
        self.nodes.chunks_exact(self.element.nodes.len())
    }
}

/// A named part of the boundary.
#[derive(Clone, Debug)]
pub struct FacetSet {
    /// The element of every facet.
    pub element: &'static Element,
    /// Nodes of the facets, `element.nodes.len()` a facet, oriented so that the body lies on the left.
    pub nodes: Vec<u32>,
}

impl FacetSet {
    /// Nodes of each facet.
    pub fn facets(&self) -> impl Iterator<Item = &[u32]> {
        self.nodes.chunks_exact(self.element.nodes.len())
    }

    /// The nodes of the set, each once, ascending.
    #[must_use]
    pub fn node_list(&self) -> Vec<u32> {
        let mut list = self.nodes.clone();
        list.sort_unstable();
        list.dedup();
        list
    }
}

/// A mesh of a body in d dimensions.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// Spatial dimension d.
    pub dim: usize,
    /// Coordinates of the nodes in m.
    pub points: Vec<Point>,
    /// The cells.
    pub blocks: Vec<Block>,
    /// Names of the regions.
    pub regions: Vec<String>,
    /// Named parts of the boundary.
    pub facets: BTreeMap<String, FacetSet>,
}

impl Mesh {
    /// The rectangle (0, size₀) × (0, size₁) cut into cells₀ × cells₁ squares, each cut into
    /// triangles; facet sets `left`, `right`, `bottom`, `top`; nodes numbered row by row.
    ///
    /// # Errors
    /// When a size is not positive and finite, a number of cells zero, or the mesh too large.
    pub fn rectangle(size: [f64; 2], cells: [usize; 2], diagonal: Diagonal) -> Result<Mesh, MeshError> {
        for direction in 0..2 {
            if !(size[direction].is_finite() && size[direction] > 0.0) {
                return Err(MeshError::Size { direction, found: size[direction] });
            }
            if cells[direction] == 0 {
                return Err(MeshError::Cells { direction, found: 0 });
            }
        }
        let nodes = rectangle_nodes(cells, diagonal);
        if nodes > f64::from(u32::MAX) {
            return Err(MeshError::TooLarge { found: nodes });
        }
        let [nx, ny] = cells;
        let at = |i: usize, j: usize| (j * (nx + 1) + i) as u32;
        let x = |i: f64| size[0] * (i / nx as f64);
        let y = |j: f64| size[1] * (j / ny as f64);
        let mut points = Vec::with_capacity(nodes as usize);
        for j in 0..=ny {
            for i in 0..=nx {
                points.push([x(i as f64), y(j as f64), 0.0]);
            }
        }
        let mut triangles = Vec::new();
        for j in 0..ny {
            for i in 0..nx {
                let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
                match diagonal {
                    Diagonal::Right => triangles.extend([a, b, c, a, c, d]),
                    Diagonal::Left => triangles.extend([a, b, d, b, c, d]),
                    Diagonal::Crossed => {
                        let m = points.len() as u32;
                        points.push([x(i as f64 + 0.5), y(j as f64 + 0.5), 0.0]);
                        triangles.extend([a, b, m, b, c, m, c, d, m, d, a, m]);
                    }
                }
            }
        }
        let side = |nodes: Vec<u32>| FacetSet { element: &crate::element::P1_SEGMENT, nodes };
        let facets = BTreeMap::from([
            ("bottom".to_owned(), side((0..nx).flat_map(|i| [at(i, 0), at(i + 1, 0)]).collect())),
            ("right".to_owned(), side((0..ny).flat_map(|j| [at(nx, j), at(nx, j + 1)]).collect())),
            ("top".to_owned(), side((0..nx).rev().flat_map(|i| [at(i + 1, ny), at(i, ny)]).collect())),
            ("left".to_owned(), side((0..ny).rev().flat_map(|j| [at(0, j + 1), at(0, j)]).collect())),
        ]);
        let blocks = vec![Block { element: &P1_TRIANGLE, region: 0, nodes: triangles }];
        Ok(Mesh { dim: 2, points, blocks, regions: vec!["body".to_owned()], facets })
    }

    /// Number of cells.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        self.blocks.iter().map(Block::len).sum()
    }

    /// Checks that every cell has a positive measure.
    ///
    /// # Errors
    /// Names the first cell that has not.
    pub fn check(&self) -> Result<(), MeshError> {
        for (b, block) in self.blocks.iter().enumerate() {
            for (c, nodes) in block.cells().enumerate() {
                let map = CellMap::new(self, block.element, nodes, &block.element.nodes[0]);
                let measure = map.determinant * block.element.shape.measure();
                if measure.is_nan() || measure <= 0.0 {
                    return Err(MeshError::Cell { block: b, cell: c, measure });
                }
            }
        }
        Ok(())
    }

    /// Spacing of the mesh: the shortest edge of its longest-edged cell, which is the paper's h = 1/n for a
    /// square cut into n × n squares by diagonals.
    #[must_use]
    pub fn spacing(&self) -> f64 {
        let mut spacing: f64 = 0.0;
        for block in &self.blocks {
            for cell in block.cells() {
                let mut edges = f64::INFINITY;
                for (i, &a) in cell.iter().enumerate() {
                    for &b in &cell[..i] {
                        let (p, q) = (&self.points[a as usize], &self.points[b as usize]);
                        edges = edges.min(length(&std::array::from_fn(|k| p[k] - q[k])));
                    }
                }
                spacing = spacing.max(edges);
            }
        }
        spacing
    }

    /// Longest edge of the cells, the diameter of the estimates.
    #[must_use]
    pub fn h(&self) -> f64 {
        let mut h: f64 = 0.0;
        for block in &self.blocks {
            for cell in block.cells() {
                for (i, &a) in cell.iter().enumerate() {
                    for &b in &cell[..i] {
                        let (p, q) = (&self.points[a as usize], &self.points[b as usize]);
                        h = h.max(length(&std::array::from_fn(|k| p[k] - q[k])));
                    }
                }
            }
        }
        h
    }

    /// Facets of the boundary (those of one cell only) that belong to no facet set.
    #[must_use]
    pub fn unnamed_boundary_facets(&self) -> usize {
        let mut seen: HashMap<Vec<u32>, usize> = HashMap::new();
        let key = |nodes: &[u32]| {
            let mut key = nodes.to_vec();
            key.sort_unstable();
            key
        };
        for block in &self.blocks {
            for cell in block.cells() {
                for facet in block.element.facets {
                    let nodes: Vec<u32> = facet.iter().map(|&i| cell[i]).collect();
                    *seen.entry(key(&nodes)).or_default() += 1;
                }
            }
        }
        for set in self.facets.values() {
            for facet in set.facets() {
                seen.remove(&key(facet));
            }
        }
        seen.values().filter(|&&count| count == 1).count()
    }
}

/// Number of nodes of [`Mesh::rectangle`], as a real because it may not fit an integer.
#[must_use]
pub fn rectangle_nodes(cells: [usize; 2], diagonal: Diagonal) -> f64 {
    let [nx, ny] = [cells[0] as f64, cells[1] as f64];
    (nx + 1.0) * (ny + 1.0) + if diagonal == Diagonal::Crossed { nx * ny } else { 0.0 }
}

/// Geometry of a cell at a reference point: position, volume factor, physical gradients.
#[derive(Clone, Debug)]
pub struct CellMap {
    /// Position in m.
    pub position: Point,
    /// Determinant of the map from the reference cell.
    pub determinant: f64,
    /// Values of the shape functions.
    pub values: [f64; crate::element::MAX_NODES],
    /// Gradients of the shape functions in 1/m.
    pub gradients: [Point; crate::element::MAX_NODES],
}

impl CellMap {
    /// Evaluates the map of the cell with these nodes at a reference point.
    #[must_use]
    pub fn new(mesh: &Mesh, element: &Element, nodes: &[u32], at: &Point) -> CellMap {
        let mut values = [0.0; crate::element::MAX_NODES];
        let mut reference = [[0.0; 3]; crate::element::MAX_NODES];
        (element.shape_functions)(at, &mut values);
        (element.gradients)(at, &mut reference);
        let dim = mesh.dim;
        // Rows beyond the dimension stay those of the identity, so one 3 × 3 inverse serves all.
        let mut j = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mut position = [0.0; 3];
        for row in 0..dim {
            j[row] = [0.0; 3];
        }
        for (n, &node) in nodes.iter().enumerate() {
            let p = &mesh.points[node as usize];
            for row in 0..dim {
                position[row] += values[n] * p[row];
                for col in 0..dim {
                    j[row][col] += p[row] * reference[n][col];
                }
            }
        }
        let (determinant, inverse) = invert(&j);
        let mut gradients = [[0.0; 3]; crate::element::MAX_NODES];
        for n in 0..nodes.len() {
            for d in 0..dim {
                gradients[n][d] = (0..dim).map(|r| inverse[r][d] * reference[n][r]).sum();
            }
        }
        CellMap { position, determinant, values, gradients }
    }
}

/// Geometry of a facet at a reference point: position, area factor, unit outward normal.
#[derive(Clone, Debug)]
pub struct FacetMap {
    /// Position in m.
    pub position: Point,
    /// Area element: physical over reference measure.
    pub area: f64,
    /// Unit outward normal ν.
    pub normal: Point,
    /// Values of the shape functions of the facet.
    pub values: [f64; crate::element::MAX_NODES],
}

impl FacetMap {
    /// Evaluates the map of the facet with these nodes at a reference point.
    #[must_use]
    pub fn new(mesh: &Mesh, element: &Element, nodes: &[u32], at: &Point) -> FacetMap {
        let mut values = [0.0; crate::element::MAX_NODES];
        let mut reference = [[0.0; 3]; crate::element::MAX_NODES];
        (element.shape_functions)(at, &mut values);
        (element.gradients)(at, &mut reference);
        let mut position = [0.0; 3];
        let mut tangent = [0.0; 3];
        for (n, &node) in nodes.iter().enumerate() {
            for d in 0..mesh.dim {
                position[d] += values[n] * mesh.points[node as usize][d];
                tangent[d] += reference[n][0] * mesh.points[node as usize][d];
            }
        }
        let area = length(&tangent);
        FacetMap { position, area, normal: [tangent[1] / area, -tangent[0] / area, 0.0], values }
    }
}

fn invert(a: &[[f64; 3]; 3]) -> (f64, [[f64; 3]; 3]) {
    let cross = |u: &Point, v: &Point| [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let columns = [cross(&a[1], &a[2]), cross(&a[2], &a[0]), cross(&a[0], &a[1])];
    let determinant = dot(&a[0], &columns[0]);
    let inverse = std::array::from_fn(|r| std::array::from_fn(|c| columns[c][r] / determinant));
    (determinant, inverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangles_have_their_area_sides_and_outward_normals() -> Result<(), MeshError> {
        for diagonal in [Diagonal::Right, Diagonal::Left, Diagonal::Crossed] {
            let mesh = Mesh::rectangle([2.0, 3.0], [4, 5], diagonal)?;
            mesh.check()?;
            assert_eq!(mesh.points.len(), rectangle_nodes([4, 5], diagonal) as usize);
            let area: f64 = mesh.blocks.iter().flat_map(|b| b.cells().map(|c| 0.5 * CellMap::new(&mesh, b.element, c, &[0.2, 0.3, 0.0]).determinant)).sum();
            assert!((area - 6.0).abs() < 1e-13);
            assert_eq!(mesh.unnamed_boundary_facets(), 0);
            for (name, normal, length) in
                [("left", [-1.0, 0.0, 0.0], 3.0), ("right", [1.0, 0.0, 0.0], 3.0), ("bottom", [0.0, -1.0, 0.0], 2.0), ("top", [0.0, 1.0, 0.0], 2.0)]
            {
                let set = &mesh.facets[name];
                let mut sum = 0.0;
                for facet in set.facets() {
                    let map = FacetMap::new(&mesh, set.element, facet, &[0.5, 0.0, 0.0]);
                    assert!((0..3).all(|d| (map.normal[d] - normal[d]).abs() < 1e-15), "{name} {:?}", map.normal);
                    sum += map.area;
                }
                assert!((sum - length).abs() < 1e-14);
            }
        }
        Ok(())
    }

    #[test]
    fn gradients_of_linear_functions_are_exact() -> Result<(), MeshError> {
        let mesh = Mesh::rectangle([1.0, 0.5], [3, 2], Diagonal::Crossed)?;
        let f = |p: &Point| 2.0 * p[0] - 7.0 * p[1];
        for block in &mesh.blocks {
            for cell in block.cells() {
                let map = CellMap::new(&mesh, block.element, cell, &[0.1, 0.6, 0.0]);
                for (d, expected) in [2.0, -7.0].into_iter().enumerate() {
                    let g: f64 = cell.iter().enumerate().map(|(n, &node)| f(&mesh.points[node as usize]) * map.gradients[n][d]).sum();
                    assert!((g - expected).abs() < 1e-13);
                }
            }
        }
        Ok(())
    }

    #[test]
    fn bad_numbers_and_inverted_cells_are_named() -> Result<(), MeshError> {
        assert!(matches!(Mesh::rectangle([1.0, -1.0], [1, 1], Diagonal::Right), Err(MeshError::Size { direction: 1, .. })));
        assert!(matches!(Mesh::rectangle([1.0, f64::NAN], [1, 1], Diagonal::Right), Err(MeshError::Size { .. })));
        assert!(matches!(Mesh::rectangle([1.0, 1.0], [0, 1], Diagonal::Right), Err(MeshError::Cells { direction: 0, .. })));
        assert!(matches!(Mesh::rectangle([1.0, 1.0], [1 << 20, 1 << 20], Diagonal::Right), Err(MeshError::TooLarge { .. })));
        let mut mesh = Mesh::rectangle([1.0, 1.0], [2, 2], Diagonal::Right)?;
        mesh.blocks[0].nodes.swap(0, 1);
        assert!(matches!(mesh.check(), Err(MeshError::Cell { block: 0, cell: 0, .. })));
        Ok(())
    }
}
