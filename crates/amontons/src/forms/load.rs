//! The load vectors (f(t), v)_V of (2.16) and (q_h(t), η)_Q of (2.17).

use crate::element::{Element, MAX_NODES};
use crate::field::Field;
use crate::mesh::{CellMap, FacetMap, Mesh};
use crate::problem::BoundaryCondition;
use crate::quadrature::{Rule, rule};
use crate::tensor::Point;

/// Degree of the rules that integrate data against shape functions: exact for cubic data on P1.
fn data_degree(element: &Element) -> usize {
    element.degree + 3
}

/// A load linear in its data: fixed entries, and terms whose field varies with time.
#[derive(Debug, Default)]
pub struct Load {
    constant: Vec<f64>,
    varying: Vec<Varying>,
}

#[derive(Debug)]
struct Varying {
    field: Field,
    points: Vec<Point>,
    /// Where and with what weight the value at each point enters, `per_point` entries a point.
    entries: Vec<(u32, f64)>,
    per_point: usize,
}

impl Load {
    fn new(size: usize) -> Load {
        Load { constant: vec![0.0; size], varying: Vec::new() }
    }

    /// The load vector at time t.
    #[must_use]
    pub fn at(&self, t: f64) -> Vec<f64> {
        let mut load = self.constant.clone();
        for term in &self.varying {
            term.add(t, &mut load);
        }
        load
    }

    /// Adds ∫ field N for the points given by `place`.
    fn add(&mut self, field: &Field, per_point: usize, points: Vec<Point>, entries: Vec<(u32, f64)>) {
        if field.is_zero() {
            return;
        }
        let term = Varying { field: field.clone(), points, entries, per_point };
        if field.depends_on_time() {
            self.varying.push(term);
        } else {
            term.add(0.0, &mut self.constant);
        }
    }
}

impl Varying {
    fn add(&self, t: f64, load: &mut [f64]) {
        let values = self.field.values(&self.points, t);
        for (value, entries) in values.iter().zip(self.entries.chunks_exact(self.per_point)) {
            for &(at, weight) in entries {
                load[at as usize] += weight * value;
            }
        }
    }
}

/// Points and entries of ∫ · N_i over cells or facets, for component `c` of `components`.
fn over<'a>(
    shapes: impl Iterator<Item = (&'a Element, &'a [u32])>,
    map: impl Fn(&Element, &[u32], &Point) -> (Point, f64, [f64; MAX_NODES]),
    components: usize,
    c: usize,
) -> (Vec<Point>, Vec<(u32, f64)>) {
    let (mut points, mut entries) = (Vec::new(), Vec::new());
    let mut cached: Option<(&'static str, Rule)> = None;
    for (element, nodes) in shapes {
        if cached.as_ref().is_none_or(|(name, _)| *name != element.name) {
            cached = Some((element.name, rule(element.shape, data_degree(element))));
        }
        let Some((_, rule)) = &cached else { continue };
        for (at, weight) in rule.iter() {
            let (x, measure, values) = map(element, nodes, at);
            points.push(x);
            entries.extend(nodes.iter().zip(values).map(|(&node, value)| (node * components as u32 + c as u32, weight * measure * value)));
        }
    }
    (points, entries)
}

fn cell_terms(mesh: &Mesh, load: &mut Load, field: &Field, components: usize, c: usize) {
    if field.is_zero() {
        return;
    }
    for block in &mesh.blocks {
        let (points, entries) = over(
            block.cells().map(|cell| (block.element, cell)),
            |element, nodes, at| {
                let map = CellMap::new(mesh, element, nodes, at);
                (map.position, map.determinant, map.values)
            },
            components,
            c,
        );
        load.add(field, block.element.nodes.len(), points, entries);
    }
}

fn facet_terms(mesh: &Mesh, load: &mut Load, on: &str, field: &Field, components: usize, c: usize) {
    let Some(set) = mesh.facets.get(on).filter(|_| !field.is_zero()) else { return };
    let (points, entries) = over(
        set.facets().map(|facet| (set.element, facet)),
        |element, nodes, at| {
            let map = FacetMap::new(mesh, element, nodes, at);
            (map.position, map.area, map.values)
        },
        components,
        c,
    );
    load.add(field, set.element.nodes.len(), points, entries);
}

/// (f(t), v)_V of (2.16): body force and tractions.
#[must_use]
pub fn f(mesh: &Mesh, body_force: &[Field], boundary: &[BoundaryCondition]) -> Load {
    let mut load = Load::new(mesh.points.len() * mesh.dim);
    for (c, field) in body_force.iter().enumerate() {
        cell_terms(mesh, &mut load, field, mesh.dim, c);
    }
    for condition in boundary {
        for (c, field) in condition.traction.iter().flatten().enumerate() {
            facet_terms(mesh, &mut load, &condition.on, field, mesh.dim, c);
        }
    }
    load
}

/// (q_h(t), η)_Q of (2.17): heat source, and heat inflow through the boundary.
#[must_use]
pub fn q(mesh: &Mesh, heat_source: &Field, boundary: &[BoundaryCondition]) -> Load {
    let mut load = Load::new(mesh.points.len());
    cell_terms(mesh, &mut load, heat_source, 1, 0);
    for condition in boundary {
        if let Some(field) = &condition.heat_inflow {
            facet_terms(mesh, &mut load, &condition.on, field, 1, 0);
        }
    }
    load
}
