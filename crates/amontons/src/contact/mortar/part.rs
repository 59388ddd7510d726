//! Facets of a side, and the flat parts that represent them in projections between sides.

use crate::element::{Element, MAX_NODES};
use crate::mesh::{FacetSet, Mesh, cross};
use crate::quadrature::Shape;
use crate::tensor::{Point, dot, length};

use super::image::SectorImage;

/// Corners of the parts of quadratic facets, by reference coordinates: halves of a segment, quarters of a triangle and
/// of a quadrilateral.
const HALVES: [&[[f64; 2]]; 2] = [&[[0.0, 0.0], [0.5, 0.0]], &[[0.5, 0.0], [1.0, 0.0]]];
const TRIANGLES: [&[[f64; 2]]; 4] = [
    &[[0.0, 0.0], [0.5, 0.0], [0.0, 0.5]],
    &[[0.5, 0.0], [1.0, 0.0], [0.5, 0.5]],
    &[[0.0, 0.5], [0.5, 0.5], [0.0, 1.0]],
    &[[0.5, 0.0], [0.5, 0.5], [0.0, 0.5]],
];
const SQUARES: [&[[f64; 2]]; 4] = [
    &[[0.0, 0.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]],
    &[[0.5, 0.0], [1.0, 0.0], [1.0, 0.5], [0.5, 0.5]],
    &[[0.5, 0.5], [1.0, 0.5], [1.0, 1.0], [0.5, 1.0]],
    &[[0.0, 0.5], [0.5, 0.5], [0.5, 1.0], [0.0, 1.0]],
];

/// A flat part of a facet: the facet itself if it is linear, else one of the parts that its nodes span.
#[derive(Clone, Debug)]
pub(super) struct FlatPiece {
    /// The facet.
    pub facet: usize,
    /// Corners in space and on the reference facet.
    pub corners: Vec<Point>,
    pub reference: Vec<Point>,
    /// The corners by their number among the nodes of the facet.
    pub local: Vec<usize>,
    /// Unit normal, outward.
    pub normal: Point,
    /// Mean of the corners, and the largest distance of a corner from it.
    pub centre: Point,
    pub radius: f64,
}

/// A facet of a side, or its image in a neighbouring sector.
#[derive(Clone, Copy)]
struct SideFacet<'a> {
    element: &'static Element,
    /// Its nodes, vertices first.
    nodes: &'a [u32],
    /// Number of its image among those of the side.
    image: usize,
}

/// The facets of a side at given positions of the nodes, and their images in neighbouring sectors.
pub(super) struct SideFacets<'a> {
    all: Vec<SideFacet<'a>>,
    parts: Vec<FlatPiece>,
    /// Number of the first part of each facet.
    first: Vec<usize>,
    x: &'a [Point],
    images: Vec<SectorImage>,
    pub is_axisymmetric: bool,
    /// Thickness of a plane body in m; 1 otherwise.
    thickness: f64,
}

impl<'a> SideFacets<'a> {
    /// The facets of a side, once per image; the first image is the side itself.
    pub fn new(mesh: &Mesh, x: &'a [Point], set: &'a FacetSet, images: &[SectorImage]) -> SideFacets<'a> {
        let of_image = |image: usize| set.facets().map(move |(element, nodes)| SideFacet { element, nodes, image });
        let mut facets = SideFacets {
            all: (0..images.len()).flat_map(of_image).collect(),
            parts: Vec::new(),
            first: Vec::new(),
            x,
            images: images.to_vec(),
            is_axisymmetric: mesh.axisymmetric,
            thickness: mesh.thickness(),
        };
        for number in 0..facets.all.len() {
            facets.first.push(facets.parts.len());
            let made = facets.split(number);
            facets.parts.extend(made);
        }
        facets.first.push(facets.parts.len());
        facets
    }

    pub fn len(&self) -> usize {
        self.all.len()
    }

    /// Element and nodes of a facet, vertices first.
    pub fn facet(&self, facet: usize) -> (&'static Element, &'a [u32]) {
        (self.all[facet].element, self.all[facet].nodes)
    }

    /// The power of the turn that maps a facet of the side to this one.
    pub fn power(&self, facet: usize) -> i8 {
        self.images[self.all[facet].image].power
    }

    pub fn parts(&self) -> &[FlatPiece] {
        &self.parts
    }

    pub fn parts_of(&self, facet: usize) -> &[FlatPiece] {
        &self.parts[self.numbers_of(facet)]
    }

    /// The numbers of the parts of a facet.
    pub fn numbers_of(&self, facet: usize) -> std::ops::Range<usize> {
        self.first[facet]..self.first[facet + 1]
    }

    /// The node at a corner of a part.
    pub fn node(&self, part: &FlatPiece, corner: usize) -> u32 {
        self.all[part.facet].nodes[part.local[corner]]
    }

    /// Position of a node of a facet.
    fn place(&self, facet: usize, local: usize) -> Point {
        let SideFacet { nodes, image, .. } = self.all[facet];
        self.images[image].position(&self.x[nodes[local] as usize])
    }

    /// The shape functions of a facet at a reference point.
    pub fn values(&self, facet: usize, at: &Point) -> [f64; MAX_NODES] {
        let (element, nodes) = self.facet(facet);
        let mut values = [0.0; MAX_NODES];
        (element.shape_functions)(at, &mut values[..nodes.len()]);
        values
    }

    /// Position of a reference point of a facet.
    pub fn position(&self, facet: usize, at: &Point) -> Point {
        let (values, (_, nodes)) = (self.values(facet, at), self.facet(facet));
        (0..nodes.len()).fold([0.0; 3], |sum, local| {
            let x = self.place(facet, local);
            std::array::from_fn(|c| sum[c] + values[local] * x[c])
        })
    }

    /// Unit outward normal of a facet at one of its nodes; on a curved facet that of the curve there, since a mean over
    /// the facet would be wrong by the order of its size.
    pub fn normal_at(&self, facet: usize, local: usize) -> Point {
        let (element, nodes) = self.facet(facet);
        let mut gradients = [[0.0; 3]; MAX_NODES];
        (element.gradients)(&element.nodes[local], &mut gradients[..nodes.len()]);
        let mut tangents = [[0.0; 3]; 2];
        for (node, gradient) in gradients.iter().take(nodes.len()).enumerate() {
            let x = self.place(facet, node);
            for (tangent, g) in tangents.iter_mut().zip(gradient) {
                (0..3).for_each(|c| tangent[c] += g * x[c]);
            }
        }
        let normal = match element.shape {
            Shape::Point => [2.0 * element.nodes[0][0] - 1.0, 0.0, 0.0],
            Shape::Segment => [tangents[0][1], -tangents[0][0], 0.0],
            _ => cross(&tangents[0], &tangents[1]),
        };
        let size = length(&normal);
        normal.map(|c| c / size)
    }

    /// Length or area of a facet, as the sum over its parts if it is curved; the swept area in a body of revolution.
    pub fn measure(&self, facet: usize) -> f64 {
        self.parts_of(facet).iter().map(|part| part.area() * self.across(&part.centre)).sum()
    }

    /// 2πr in a body of revolution, the thickness of a plane body, 1 otherwise.
    pub fn across(&self, x: &Point) -> f64 {
        if self.is_axisymmetric { std::f64::consts::TAU * x[0] } else { self.thickness }
    }

    /// The flat parts of a facet.
    fn split(&self, facet: usize) -> Vec<FlatPiece> {
        let (element, _) = self.facet(facet);
        let of = |local: Vec<usize>| {
            let corners = local.iter().map(|&i| self.place(facet, i)).collect();
            let reference = local.iter().map(|&i| element.nodes[i]).collect();
            FlatPiece::new(facet, corners, reference, local)
        };
        let at = |corner: &[f64; 2]| {
            element.nodes.iter().position(|node| (0..2).all(|c| node[c].to_bits() == corner[c].to_bits())).unwrap_or(0)
        };
        let split = |all: &[&[[f64; 2]]]| all.iter().map(|part| of(part.iter().map(at).collect())).collect();
        match (element.shape, element.degree) {
            (Shape::Segment, 2) => split(&HALVES),
            (Shape::Triangle, 2) => split(&TRIANGLES),
            (Shape::Quadrilateral, 2) => split(&SQUARES),
            (shape, _) => vec![of((0..shape.vertices()).collect())],
        }
    }
}

/// Σ x_i × x_{i+1} of a polygon about its first corner: twice its area along its normal, even if it is warped.
fn doubled_area(corners: &[Point]) -> Point {
    let from = |x: &Point| -> Point { std::array::from_fn(|c| x[c] - corners[0][c]) };
    corners.windows(2).fold([0.0; 3], |sum, pair| {
        let term = cross(&from(&pair[0]), &from(&pair[1]));
        std::array::from_fn(|c| sum[c] + term[c])
    })
}

impl FlatPiece {
    pub fn new(facet: usize, corners: Vec<Point>, reference: Vec<Point>, local: Vec<usize>) -> FlatPiece {
        let n = corners.len() as f64;
        let centre: Point = std::array::from_fn(|c| corners.iter().map(|x| x[c]).sum::<f64>() / n);
        let distance = |x: &Point| length(&std::array::from_fn(|c| x[c] - centre[c]));
        let radius = corners.iter().map(distance).fold(0.0, f64::max);
        let normal = match corners.as_slice() {
            // The reference coordinate determines which end of the body the point is.
            [_] => [2.0 * reference[0][0] - 1.0, 0.0, 0.0],
            [a, b] => [b[1] - a[1], a[0] - b[0], 0.0],
            _ => doubled_area(&corners),
        };
        let size = length(&normal);
        FlatPiece { facet, corners, reference, local, normal: normal.map(|c| c / size), centre, radius }
    }

    /// Length or area; 1 for a point.
    pub fn area(&self) -> f64 {
        match self.corners.len() {
            1 => 1.0,
            2 => 2.0 * self.radius,
            _ => 0.5 * length(&doubled_area(&self.corners)),
        }
    }

    /// True if the part and the contents of a sphere may cover each other, seen along the normal of the part.
    pub fn may_cover(&self, centre: &Point, radius: f64) -> bool {
        let apart: Point = std::array::from_fn(|c| centre[c] - self.centre[c]);
        let along = dot(&apart, &self.normal);
        let across = dot(&apart, &apart) - along * along;
        across <= (self.radius + radius).powi(2) * (1.0 + 1e-9)
    }

    /// True if the contents of a sphere may be within a distance of the part.
    pub fn is_within(&self, distance: f64, centre: &Point, radius: f64) -> bool {
        let apart: Point = std::array::from_fn(|c| centre[c] - self.centre[c]);
        dot(&apart, &apart) <= (self.radius + radius + distance).powi(2) * (1.0 + 1e-9)
    }
}
