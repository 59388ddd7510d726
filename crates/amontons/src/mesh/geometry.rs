//! Geometry of cells and facets at the points of a [`ShapeTable`].

use super::{FacetSet, Mesh};
use crate::element::ShapeTable;
use crate::quadrature::Shape;
use crate::tensor::{Point, dot, length};

/// Geometry of a cell at a point of a table: position, volume factor, physical gradients. One map serves many cells:
///
/// ```
/// use amontons::{element::ShapeTable, mesh::{CellMap, Diagonal, Mesh}};
///
/// let mesh = Mesh::rectangle([2.0, 1.0], [4, 2], Diagonal::Right)?;
/// let mut area = 0.0;
/// for block in &mesh.blocks {
///     let table = ShapeTable::new(block.element, 1);
///     let mut map = CellMap::new(&mesh, &table);
///     for cell in block.cells() {
///         for q in 0..table.len() {
///             map.at(cell, q);
///             area += table.weights[q] * map.measure;
///         }
///     }
/// }
/// assert!((area - 2.0).abs() < 1e-14);
/// # Ok::<(), amontons::mesh::MeshError>(())
/// ```
#[derive(Clone, Debug)]
pub struct CellMap<'a> {
    /// Position in m.
    pub position: Point,
    /// Determinant of the map from the reference cell; not positive if the cell is inverted.
    pub jacobian: f64,
    /// Volume element in m^d: the Jacobian, times 2πr in a body of revolution.
    pub measure: f64,
    /// Gradients of the shape functions in 1/m, one per node.
    pub gradients: Vec<Point>,
    mesh: &'a Mesh,
    table: &'a ShapeTable,
    q: usize,
}

impl<'a> CellMap<'a> {
    /// A map for cells with the element of the table. Its fields are valid only after a call of [`CellMap::at`].
    #[must_use]
    pub fn new(mesh: &'a Mesh, table: &'a ShapeTable) -> CellMap<'a> {
        CellMap {
            position: [0.0; 3],
            jacobian: 0.0,
            measure: 0.0,
            gradients: vec![[0.0; 3]; table.element.nodes.len()],
            mesh,
            table,
            q: 0,
        }
    }

    /// Goes to point `q` of the table in the cell with these nodes.
    pub fn at(&mut self, nodes: &[u32], q: usize) {
        self.q = q;
        match self.mesh.dim {
            1 => self.evaluate::<1>(nodes),
            2 => self.evaluate::<2>(nodes),
            _ => self.evaluate::<3>(nodes),
        }
    }

    /// Values of the shape functions, one per node.
    #[must_use]
    pub fn values(&self) -> &'a [f64] {
        self.table.values(self.q)
    }

    fn evaluate<const D: usize>(&mut self, nodes: &[u32]) {
        let (values, reference) = (self.table.values(self.q), self.table.gradients(self.q));
        let mut j = [[0.0; D]; D];
        let mut position = [0.0; 3];
        for ((&node, value), g) in nodes.iter().zip(values).zip(reference) {
            let p = &self.mesh.points[node as usize];
            for row in 0..D {
                position[row] += value * p[row];
                for col in 0..D {
                    j[row][col] += p[row] * g[col];
                }
            }
        }
        let (determinant, inverse) = invert(&j);
        for (gradient, g) in self.gradients.iter_mut().zip(reference) {
            for d in 0..D {
                gradient[d] = (0..D).map(|r| inverse[r][d] * g[r]).sum();
            }
        }
        self.position = position;
        self.jacobian = determinant;
        self.measure = determinant * self.mesh.across(&self.position);
    }
}

/// Geometry of a facet, or of an edge or point of the boundary, at a point of a table: position, area factor, unit
/// outward normal.
#[derive(Clone, Debug)]
pub struct FacetMap<'a> {
    /// Position in m.
    pub position: Point,
    /// Area element in m^(d−1): physical over reference measure, times 2πr in a body of revolution. For an edge it is
    /// the element of length, for a point 1.
    pub area: f64,
    /// Unit outward normal ν; zero for an edge or a point.
    pub normal: Point,
    mesh: &'a Mesh,
    table: &'a ShapeTable,
    q: usize,
}

impl<'a> FacetMap<'a> {
    /// A map for facets with the element of the table. Its fields are valid only after a call of [`FacetMap::at`].
    #[must_use]
    pub fn new(mesh: &'a Mesh, table: &'a ShapeTable) -> FacetMap<'a> {
        FacetMap { position: [0.0; 3], area: 0.0, normal: [0.0; 3], mesh, table, q: 0 }
    }

    /// Goes to point `q` of the table in the facet with these nodes.
    pub fn at(&mut self, nodes: &[u32], q: usize) {
        self.q = q;
        let (values, reference) = (self.table.values(q), self.table.gradients(q));
        let (mut position, mut tangents) = ([0.0; 3], [[0.0; 3]; 2]);
        for ((&node, value), g) in nodes.iter().zip(values).zip(reference) {
            let p = &self.mesh.points[node as usize];
            for d in 0..self.mesh.dim {
                position[d] += value * p[d];
                tangents[0][d] += g[0] * p[d];
                tangents[1][d] += g[1] * p[d];
            }
        }
        self.position = position;
        let element = self.table.element;
        if element.dim() + 1 < self.mesh.dim {
            self.area = length(&tangents[0]).max(f64::from(u8::from(element.dim() == 0)));
            self.area *= self.mesh.across(&self.position);
            return;
        }
        let normal = match element.shape {
            // The reference coordinate determines which end of the body the point is.
            Shape::Point => [2.0 * element.nodes[0][0] - 1.0, 0.0, 0.0],
            Shape::Segment => [tangents[0][1], -tangents[0][0], 0.0],
            _ => cross(&tangents[0], &tangents[1]),
        };
        let area = length(&normal);
        self.normal = normal.map(|c| c / area);
        self.area = area * self.mesh.across(&self.position);
    }

    /// Values of the shape functions of the facet, one per node.
    #[must_use]
    pub fn values(&self) -> &'a [f64] {
        self.table.values(self.q)
    }
}

impl Mesh {
    /// Area of a side in m², length of an edge in m, or number of points.
    pub(crate) fn measure(&self, set: &FacetSet) -> f64 {
        self.moments(set).measure
    }

    /// The centroid of a side, of an edge, or of points; `None` if the set is empty.
    #[must_use]
    pub fn centre(&self, set: &FacetSet) -> Option<Point> {
        self.moments(set).centre(self)
    }

    fn moments(&self, set: &FacetSet) -> Moments {
        let mut sum = Moments::default();
        for block in &set.blocks {
            let table = ShapeTable::new(block.element, 2 * block.element.degree + 1);
            let mut map = FacetMap::new(self, &table);
            for facet in block.nodes.chunks_exact(block.element.nodes.len()) {
                for (q, weight) in table.weights.iter().enumerate() {
                    map.at(facet, q);
                    sum.add(weight * map.area, &map.position);
                }
            }
        }
        sum
    }

    /// The centroid of a region, given by its number; `None` if the region has no cells.
    #[must_use]
    pub fn centre_of_region(&self, region: usize) -> Option<Point> {
        let mut sum = Moments::default();
        for block in self.blocks.iter().filter(|block| block.region == region) {
            let table = ShapeTable::new(block.element, 2 * block.element.degree + 1);
            let mut map = CellMap::new(self, &table);
            for cell in block.cells() {
                for (q, weight) in table.weights.iter().enumerate() {
                    map.at(cell, q);
                    sum.add(weight * map.measure, &map.position);
                }
            }
        }
        sum.centre(self)
    }

    /// Factor of measures at a point: 2πr in a body of revolution, the thickness of a plane body, 1 otherwise.
    fn across(&self, x: &Point) -> f64 {
        if self.axisymmetric { std::f64::consts::TAU * x[0] } else { self.thickness() }
    }
}

/// A measure, and its moments about the origin.
#[derive(Default)]
struct Moments {
    measure: f64,
    first: Point,
}

impl Moments {
    fn add(&mut self, measure: f64, x: &Point) {
        self.measure += measure;
        self.first.iter_mut().zip(x).for_each(|(sum, c)| *sum += measure * c);
    }

    /// The centroid, on the axis for a body of revolution; `None` if the measure is zero.
    fn centre(&self, mesh: &Mesh) -> Option<Point> {
        let centre = self.first.map(|c| c / self.measure);
        let on_axis = if mesh.axisymmetric { [0.0, centre[1], 0.0] } else { centre };
        (self.measure > 0.0).then_some(on_axis)
    }
}

/// u × v.
pub(crate) fn cross(u: &Point, v: &Point) -> Point {
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

/// Determinant and inverse of a D × D matrix, D at most 3.
pub(crate) fn invert<const D: usize>(a: &[[f64; D]; D]) -> (f64, [[f64; D]; D]) {
    // Rows beyond D are those of the identity, so one 3 × 3 inverse serves all; the compiler removes them.
    let mut full = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for r in 0..D {
        for c in 0..D {
            full[r][c] = a[r][c];
        }
    }
    let columns = [cross(&full[1], &full[2]), cross(&full[2], &full[0]), cross(&full[0], &full[1])];
    let determinant = dot(&full[0], &columns[0]);
    (determinant, std::array::from_fn(|r| std::array::from_fn(|c| columns[c][r] / determinant)))
}
