//! The temperatures that the tables of the materials cover.

use super::{Fault, ProblemData};
use crate::element::ShapeTable;
use crate::material::Material;
use crate::tensor::Point;

/// Relative tolerance beyond a table: the accuracy to which a step is solved.
const SLACK: f64 = 1e-10;

/// A temperature that a coefficient does not cover.
#[derive(Clone, Debug, PartialEq)]
pub struct Uncovered {
    /// Dotted path of the coefficient.
    pub key: String,
    /// The first and the last temperature of its table, K.
    pub range: [f64; 2],
    /// The temperature, K.
    pub theta: f64,
    /// Its position, m.
    pub at: Point,
}

/// The coefficients of a material that depend on the temperature, with their first and last temperature.
fn covered(material: &Material) -> impl Iterator<Item = (&'static str, [f64; 2])> {
    let tables = [
        ("elasticity", material.elasticity.temperatures()),
        ("viscosity", material.viscosity.temperatures()),
        ("expansion", material.expansion.temperatures()),
        ("conductivity", material.conductivity.temperatures()),
        ("heat_capacity", material.heat_capacity.temperatures()),
    ];
    tables.into_iter().filter_map(|(key, table)| Some((key, [*table.first()?, *table.last()?])))
}

/// The first coefficient of a material that depends on the temperature, with its first and last temperature.
pub(crate) fn first_warm(material: &Material) -> Option<(&'static str, [f64; 2])> {
    covered(material).next()
}

impl ProblemData {
    /// The temperature at or between the nodes that is farthest outside a material table, or `None` if the tables cover
    /// all.
    pub(crate) fn uncovered(&self, theta: &[f64]) -> Option<Uncovered> {
        let mut worst: Option<(f64, Uncovered)> = None;
        let mut look = |(key, range): (&str, [f64; 2]), theta: f64, at: Point| {
            let slack = SLACK * range[0].abs().max(range[1].abs());
            let beyond = (range[0] - theta).max(theta - range[1]);
            if beyond > slack && worst.as_ref().is_none_or(|(most, _)| beyond > *most) {
                worst = Some((beyond, Uncovered { key: format!("material.{key}"), range, theta, at }));
            }
        };
        for block in &self.mesh.blocks {
            let tables: Vec<_> = self.material_of(block.region).map_or_else(Vec::new, |m| covered(m).collect());
            if tables.is_empty() {
                continue;
            }
            for &node in &block.nodes {
                let (Some(x), Some(&theta)) = (self.mesh.points.get(node as usize), theta.get(node as usize)) else {
                    continue;
                };
                for table in &tables {
                    look(*table, theta, *x);
                }
            }
            // Between its nodes a polynomial of degree 1 has no extremes.
            if block.element.degree > 1 {
                let shapes = ShapeTable::new(block.element, self.mesh.value_products(block.element, false));
                let mut map = crate::mesh::CellMap::new(&self.mesh, &shapes);
                for (cell, q) in block.cells().flat_map(|cell| (0..shapes.len()).map(move |q| (cell, q))) {
                    map.at(cell, q);
                    let at = |(&node, value): (&u32, &f64)| theta.get(node as usize).map_or(0.0, |theta| value * theta);
                    let here = cell.iter().zip(map.values()).map(at).sum();
                    for table in &tables {
                        look(*table, here, map.position);
                    }
                }
            }
        }
        worst.map(|(_, found)| found)
    }

    /// Checks that the tables of the materials cover the initial temperature.
    pub(super) fn check_tables(&self, faults: &mut Vec<Fault>) {
        let theta = self.first_temperature();
        if let Some(Uncovered { key, range: [first, last], theta, at }) = self.uncovered(&theta) {
            let found = format!("the temperature {theta:?} at {}", self.mesh.place(&at));
            let expected = format!("temperatures from {first:?} to {last:?}, which {key} covers");
            let (path, hint) = match self.temperature.first() {
                Some(given) => (given.key.as_str(), "extend the table, or give another temperature"),
                None => ("initial.temperature", "extend the table, or give another initial temperature"),
            };
            faults.push(Fault::new(path, found, expected).hint(hint));
        }
    }
}
