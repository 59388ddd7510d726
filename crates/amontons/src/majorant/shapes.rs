//! What cells of equal shape share: the matrices of their complementary energies.

use std::collections::HashMap;

use rayon::prelude::*;

use super::Refused;
use super::cube::{CubeStresses, NodalProducts};
use super::dense::congruent;
use super::hexahedron::{CubeProducts, HexahedronShape};
use super::parallelogram::PieceMoments;
use super::quadrilateral::{QuadrilateralShape, is_distorted};
use super::revolution::RevolvedTriangle;
use super::scope;
use super::simplex::{ReferenceStresses, SimplexForm, form, vertex};
use super::skeleton::{ElementTables, Skeleton};
use super::stress::StepLaws;
use crate::element::{Element, ShapeTable};
use crate::machine;
use crate::mesh::CellMap;
use crate::quadrature::Shape;
use crate::tensor::Point;

/// The shape of a simplex.
#[derive(Debug)]
pub(super) struct SimplexShape {
    pub form: SimplexForm,
    /// G in the components of the tractions on the facets, outward, in the order of the cell.
    pub gram: Vec<f64>,
}

/// The shape of a cell.
#[derive(Debug)]
pub(super) enum CellShape {
    Simplex(Box<SimplexShape>),
    Quadrilateral(Box<QuadrilateralShape>),
    Hexahedron(Box<HexahedronShape>),
}

impl CellShape {
    /// G in the components of the tractions on the facets.
    pub fn gram(&self) -> &[f64] {
        match self {
            CellShape::Simplex(shape) => &shape.gram,
            CellShape::Quadrilateral(shape) => &shape.gram,
            CellShape::Hexahedron(shape) => &shape.gram,
        }
    }
}

/// The shapes of the cells of a mesh with the laws of a rule in time.
#[derive(Debug)]
pub(super) struct CellShapes {
    pub stresses: ReferenceStresses,
    pub shapes: Vec<CellShape>,
    /// The shape of each cell.
    pub of_cell: Vec<u32>,
    /// The points of the parts of a simplex in the cells of each block of simplices, and the nodes of hexahedra.
    pub tables: Vec<Option<ShapeTable>>,
}

/// Binary digits of coordinates, relative to the size of a cell, in which cells of one shape agree.
const DIGITS: i32 = 40;

/// What tells shapes apart: the block, the order of the vertices by their numbers, and their positions about the first
/// vertex in parts of the size of the cell, and that size.
fn key(laws: &StepLaws, skeleton: &Skeleton, cell: usize) -> Vec<i64> {
    let nodes = skeleton.nodes(laws.mesh, cell);
    let nodes = &nodes[..skeleton.tables(cell).element.shape.vertices()];
    let at = |node: u32| &laws.mesh.points[node as usize];
    let edges = nodes.iter().flat_map(|&node| (0..3).map(move |c| at(node)[c] - at(nodes[0])[c]));
    let size = edges.clone().fold(0.0f64, |most, x| most.max(x.abs()));
    // A size that is a power of two is far from where the exponent changes.
    let exponent = (size * std::f64::consts::SQRT_2).log2().floor() as i32;
    let mut key = vec![skeleton.cells[cell].block as i64, i64::from(exponent)];
    if laws.mesh.axisymmetric || laws.varies(laws.region(skeleton, cell)) {
        key.push(cell as i64);
    }
    key.extend(nodes.iter().map(|node| nodes.iter().filter(|&other| other < node).count() as i64));
    let unit = f64::from(DIGITS.saturating_sub(exponent)).exp2();
    key.extend(edges.map(|x| (x * unit).round() as i64));
    key
}

impl CellShapes {
    /// The shapes, with points at which the energies of discrete stresses are integrated.
    ///
    /// # Errors
    /// If a stiffness is not positive definite.
    pub fn new(laws: &StepLaws, skeleton: &Skeleton, is_warm: bool) -> Result<CellShapes, Refused> {
        let is_distorted = (0..skeleton.cells.len()).any(|cell| {
            let element = skeleton.tables(cell).element;
            let at = |i: usize| laws.mesh.points[skeleton.nodes(laws.mesh, cell)[i] as usize];
            element.shape == Shape::Quadrilateral && is_distorted(&[0, 1, 2, 3].map(at))
        });
        let dim = laws.mesh.dim;
        let degree = |of: &ElementTables| {
            let element = of.element;
            let degree = match (element.is_simplex(), is_warm) {
                (true, false) => element.gradient_degree,
                (true, true) => element.degree,
                // Both coordinates count.
                (false, false) => 2 * element.degree - 1,
                (false, true) => 2 * element.degree,
            };
            // In a body of revolution stresses are multiplied by the radius, and one of its functions is a weight.
            if laws.mesh.axisymmetric {
                return 2 * (element.degree + 1) + 1;
            }
            2 * degree.max(1) + if is_distorted { 4 } else { 0 }
        };
        let varies = laws.mesh.blocks.iter().any(|block| laws.varies(block.region));
        let degree = skeleton.tables.iter().map(degree).max().unwrap_or(2) + if varies { 4 } else { 0 };
        let stresses = ReferenceStresses::new(dim, degree);
        let table = |element: &'static Element| {
            let at = |in_simplex: &Vec<f64>| -> Point {
                std::array::from_fn(|c| in_simplex.iter().zip(element.nodes).map(|(a, x)| a * x[c]).sum())
            };
            let points = stresses.points.iter().map(|point| at(&point.in_simplex));
            match element.shape {
                Shape::Quadrilateral => None,
                Shape::Hexahedron => Some(ShapeTable::at(element, element.nodes)),
                _ => Some(ShapeTable::at(element, &points.collect::<Vec<_>>())),
            }
        };
        let tables: Vec<Option<ShapeTable>> = skeleton.tables.iter().map(|tables| table(tables.element)).collect();
        let keys: Vec<Vec<i64>> =
            (0..skeleton.cells.len()).into_par_iter().map(|cell| key(laws, skeleton, cell)).collect();
        let (mut known, mut first, mut of_cell) = (HashMap::new(), Vec::new(), Vec::new());
        for (cell, key) in keys.into_iter().enumerate() {
            let number = *known.entry(key).or_insert_with(|| {
                first.push(cell);
                first.len() as u32 - 1
            });
            of_cell.push(number);
        }
        let is_hexahedron = |cell: &&usize| skeleton.tables(**cell).element.shape == Shape::Hexahedron;
        scope::check_hexahedra(first.iter().filter(is_hexahedron).count(), machine::memory())?;
        let hexahedra = Hexahedra::new(skeleton);
        let shape = |cell: usize| {
            let shape = one(laws, skeleton, cell, (&stresses, &tables, &hexahedra));
            shape.ok_or_else(|| Refused::new("a stiffness that is not positive"))
        };
        let shapes = first.into_par_iter().map(shape).collect::<Result<Vec<CellShape>, Refused>>()?;
        Ok(CellShapes { stresses, shapes, of_cell, tables })
    }

    /// The shape of a cell.
    pub fn of(&self, cell: usize) -> &CellShape {
        &self.shapes[self.of_cell[cell] as usize]
    }
}

/// The shape of one cell; `None` if its stiffness is not positive definite.
fn one(
    laws: &StepLaws,
    skeleton: &Skeleton,
    cell: usize,
    (stresses, tables, hexahedra): (&ReferenceStresses, &[Option<ShapeTable>], &Hexahedra),
) -> Option<CellShape> {
    let block = skeleton.cells[cell].block;
    match (&tables[block], hexahedra.of_block(block)) {
        (_, Some(cube)) => {
            HexahedronShape::new(laws, skeleton, cell, &cube).map(|shape| CellShape::Hexahedron(Box::new(shape)))
        }
        (Some(table), _) => {
            simplex(laws, skeleton, cell, (stresses, table)).map(|shape| CellShape::Simplex(Box::new(shape)))
        }
        (None, _) => QuadrilateralShape::new(laws, skeleton, cell, stresses)
            .map(|shape| CellShape::Quadrilateral(Box::new(shape))),
    }
}

/// What the hexahedra of a mesh need, if there are any.
struct Hexahedra {
    cube: Option<(CubeStresses, PieceMoments)>,
    /// Per block.
    nodal: Vec<Option<NodalProducts>>,
}

impl Hexahedra {
    fn new(skeleton: &Skeleton) -> Hexahedra {
        let is_hexahedron = |of: &ElementTables| of.element.shape == Shape::Hexahedron;
        let has_any = skeleton.tables.iter().any(is_hexahedron);
        let cube = has_any.then(|| (CubeStresses::new(), PieceMoments::new()));
        let of_block = |of: &ElementTables| {
            let (stresses, _) = cube.as_ref().filter(|_| is_hexahedron(of))?;
            Some(NodalProducts::new(stresses, of.element))
        };
        let nodal = skeleton.tables.iter().map(of_block).collect();
        Hexahedra { cube, nodal }
    }

    fn of_block(&self, block: usize) -> Option<CubeProducts<'_>> {
        let ((stresses, pieces), nodal) = (self.cube.as_ref()?, self.nodal.get(block)?.as_ref()?);
        Some(CubeProducts { stresses, pieces, nodal })
    }
}

fn simplex(
    laws: &StepLaws,
    skeleton: &Skeleton,
    cell: usize,
    (stresses, table): (&ReferenceStresses, &ShapeTable),
) -> Option<SimplexShape> {
    let (mesh, dim) = (laws.mesh, laws.mesh.dim);
    let (nodes, region) = (skeleton.nodes(mesh, cell), laws.region(skeleton, cell));
    let vertices: Vec<Point> = nodes[..=dim].iter().map(|&node| mesh.points[node as usize]).collect();
    let mut map = CellMap::new(mesh, table);
    let mut position = |q: usize| {
        map.at(nodes, q);
        map.position
    };
    let mut form = if mesh.axisymmetric {
        let compliance: Option<Vec<_>> =
            (0..stresses.points.len()).map(|q| laws.compliance(region, &position(q))).collect();
        RevolvedTriangle::new(&vertices).form(stresses, &vertices, &compliance?)
    } else {
        form(laws, region, stresses, &vertices, position)?
    };
    let k = dim * dim;
    let blocks: Vec<(usize, Vec<f64>)> = (0..=dim)
        .map(|local| {
            let facet = skeleton.cells[cell].facets[local];
            let first = skeleton.opposite(cell, local) * dim;
            let mut block = vec![0.0; k * k];
            for column in 0..k {
                let mut y = [0.0; 9];
                y[column] = 1.0;
                let moments = skeleton.modes[facet].moments(&y);
                for place in 0..dim {
                    let node = nodes[vertex(dim, first + place)];
                    let slot = skeleton.facets[facet].place(node).unwrap_or(0);
                    let moment = form.map.inverse_times(&moments[slot]);
                    (0..dim).for_each(|c| block[(place * dim + c) * k + column] = moment[c]);
                }
            }
            (first * dim, block)
        })
        .collect();
    let gram = congruent(&form.take_moments(), k, &blocks);
    Some(SimplexShape { form, gram })
}
