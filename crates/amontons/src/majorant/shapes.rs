//! What cells of equal shape share: the matrices of their complementary energies.

use std::collections::HashMap;

use rayon::prelude::*;

use super::Refused;
use super::dense::congruent;
use super::quadrilateral::{QuadrilateralShape, is_distorted};
use super::revolution::RevolvedTriangle;
use super::simplex::{ReferenceStresses, SimplexForm, form, vertex};
use super::skeleton::{ElementTables, Skeleton};
use super::stress::StepLaws;
use crate::element::{Element, ShapeTable};
use crate::mesh::CellMap;
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
}

impl CellShape {
    /// G in the components of the tractions on the facets.
    pub fn gram(&self) -> &[f64] {
        match self {
            CellShape::Simplex(shape) => &shape.gram,
            CellShape::Quadrilateral(shape) => &shape.gram,
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
    /// The points of the parts of a simplex in the cells of each block of simplices.
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
            !element.is_simplex() && is_distorted(&[0, 1, 2, 3].map(at))
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
            element.is_simplex().then(|| ShapeTable::at(element, &points.collect::<Vec<_>>()))
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
        let shape = |cell: usize| {
            let table = tables[skeleton.cells[cell].block].as_ref();
            let shape = match table {
                Some(table) => {
                    simplex(laws, skeleton, cell, (&stresses, table)).map(|shape| CellShape::Simplex(Box::new(shape)))
                }
                None => QuadrilateralShape::new(laws, skeleton, cell, &stresses)
                    .map(|shape| CellShape::Quadrilateral(Box::new(shape))),
            };
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
