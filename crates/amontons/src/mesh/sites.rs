//! The points of the cells at which material coefficients are evaluated.

use std::collections::BTreeSet;

use super::{CellMap, Mesh};
use crate::element::{Element, ShapeTable};
use crate::tensor::Point;

impl Mesh {
    /// Degree of the rule for products of gradients, also of values if there is a hoop strain.
    pub(crate) fn gradient_products(&self, element: &Element) -> usize {
        2 * if self.axisymmetric { element.gradient_degree.max(element.degree) } else { element.gradient_degree }
    }

    /// Degree of the rule for products of values, and of values with gradients.
    pub(crate) fn value_products(&self, element: &Element, gradients: bool) -> usize {
        element.degree
            + if gradients { element.gradient_degree } else { element.degree }
            + usize::from(self.axisymmetric)
    }

    /// Degree of the rule for products of gradients of a scalar.
    pub(crate) fn flux_products(&self, element: &Element) -> usize {
        2 * element.gradient_degree + usize::from(self.axisymmetric)
    }

    /// A point for messages: `x = 1.0, y = 2.0`.
    pub(crate) fn place(&self, x: &Point) -> String {
        let along = ["x", "y", "z"].iter().zip(x).take(self.dim);
        along.map(|(axis, x)| format!("{axis} = {x:?}")).collect::<Vec<_>>().join(", ")
    }

    /// The nodes of the cells of a region, or of all, with the centres of the cells and their quadrature points.
    #[must_use]
    pub fn sites(&self, region: Option<usize>) -> Vec<Point> {
        let blocks = || self.blocks.iter().filter(|block| region.is_none_or(|region| block.region == region));
        let mut is_used = vec![false; self.points.len()];
        for &node in blocks().flat_map(|block| &block.nodes) {
            if let Some(used) = is_used.get_mut(node as usize) {
                *used = true;
            }
        }
        let mut sites: Vec<Point> =
            self.points.iter().zip(is_used).filter_map(|(x, used)| used.then_some(*x)).collect();
        for block in blocks() {
            let element = block.element;
            let degrees = BTreeSet::from([
                self.gradient_products(element),
                self.value_products(element, false),
                self.value_products(element, true),
                self.flux_products(element),
            ]);
            let tables = degrees.into_iter().map(|degree| ShapeTable::new(element, degree));
            for table in tables.chain([ShapeTable::at(element, &[element.centre()])]) {
                let mut map = CellMap::new(self, &table);
                for cell in block.cells() {
                    for q in 0..table.len() {
                        map.at(cell, q);
                        sites.push(map.position);
                    }
                }
            }
        }
        sites
    }
}
