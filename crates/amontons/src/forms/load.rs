//! The load vectors (f(t), v)_V of (2.16) and (q_h(t), η)_Q of (2.17).

use std::sync::{Arc, Mutex, PoisonError};

use crate::element::{Element, ShapeTable};
use crate::field::Field;
use crate::mesh::{CellMap, FacetMap, FacetSet, Mesh};
use crate::problem::{BoundaryCondition, Convection, ProblemData, RegionLoad, RigidPart};
use crate::space::RigidNodes;
use crate::tensor::Point;

/// Degree of the rules for data times shape functions: exact for cubic data on P1.
pub(crate) fn data_degree(element: &Element) -> usize {
    element.degree + 3
}

/// Points of a time-independent field that are evaluated at once: they fit into a cache.
const POINTS: usize = 4096;

/// A load that is linear in its data: fixed entries, and terms whose field varies with time.
#[derive(Debug, Default)]
pub struct Load {
    constant: Arc<Vec<f64>>,
    varying: Arc<Vec<Varying>>,
    /// The last load made; its memory is reused.
    last: Mutex<Arc<Vec<f64>>>,
}

#[derive(Clone, Debug)]
struct Varying {
    field: Field,
    points: Vec<Point>,
    /// Degree of freedom and weight for the value at each point, `per_point` entries per point.
    entries: Vec<(u32, f64)>,
    per_point: usize,
}

impl Load {
    fn new(size: usize) -> Load {
        Load { constant: Arc::new(vec![0.0; size]), ..Load::default() }
    }

    /// The same load, whose terms are shared.
    #[must_use]
    pub fn shared(&self) -> Load {
        Load { constant: Arc::clone(&self.constant), varying: Arc::clone(&self.varying), last: Mutex::default() }
    }

    /// True if the terms are those of another load, shared with it.
    #[must_use]
    pub fn is_shared(&self, other: &Load) -> bool {
        Arc::ptr_eq(&self.constant, &other.constant) && Arc::ptr_eq(&self.varying, &other.varying)
    }

    /// The load vector at time t in N or W, one entry per degree of freedom; shared if no term varies.
    #[must_use]
    pub fn at(&self, t: f64) -> Arc<Vec<f64>> {
        if self.varying.is_empty() {
            return Arc::clone(&self.constant);
        }
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        match Arc::get_mut(&mut last) {
            Some(load) => load.clone_from(&self.constant),
            None => *last = Arc::new(Vec::clone(&self.constant)),
        }
        let load = Arc::make_mut(&mut last);
        self.varying.iter().for_each(|term| term.add(t, load));
        Arc::clone(&last)
    }

    /// Adds ∫ field N for points with the given entries.
    fn add(&mut self, field: &Field, per_point: usize, points: Vec<Point>, entries: Vec<(u32, f64)>) {
        if field.is_zero() {
            return;
        }
        let term = Varying { field: field.clone(), points, entries, per_point };
        if field.depends_on_time() {
            Arc::make_mut(&mut self.varying).push(term);
        } else {
            let constant = Arc::make_mut(&mut self.constant);
            term.add(0.0, constant);
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

/// ∫ field η over the body or a region, η a component of a node, `factor` the factor of the field at a point.
struct CellTerms<'a> {
    field: &'a Field,
    region: Option<usize>,
    /// Component, and number of components.
    component: (usize, usize),
    factor: &'a dyn Fn(&Point) -> f64,
}

/// ∫_Ω field η, η the component `c` of `components`.
fn cell_terms(mesh: &Mesh, load: &mut Load, field: &Field, components: usize, c: usize) {
    add_cell_terms(mesh, load, &CellTerms { field, region: None, component: (c, components), factor: &|_| 1.0 });
}

fn add_cell_terms(mesh: &Mesh, load: &mut Load, terms: &CellTerms) {
    let CellTerms { field, region, component: (c, components), factor } = *terms;
    if field.is_zero() {
        return;
    }
    for block in mesh.blocks.iter().filter(|block| region.is_none_or(|region| block.region == region)) {
        let table = ShapeTable::new(block.element, data_degree(block.element));
        let mut map = CellMap::new(mesh, &table);
        let (mut points, mut entries) = (Vec::new(), Vec::new());
        for nodes in block.cells() {
            for q in 0..table.len() {
                map.at(nodes, q);
                points.push(map.position);
                let weight = table.weights[q] * map.measure * factor(&map.position);
                entries.extend(
                    nodes
                        .iter()
                        .zip(map.values())
                        .map(|(&node, value)| (node * components as u32 + c as u32, weight * value)),
                );
            }
            if points.len() >= POINTS && !field.depends_on_time() {
                load.add(field, nodes.len(), std::mem::take(&mut points), std::mem::take(&mut entries));
            }
        }
        load.add(field, block.element.nodes.len(), points, entries);
    }
}

/// ∫ field direction·v over a side, an edge or points, v with `components` components.
fn facet_terms(
    mesh: &Mesh,
    load: &mut Load,
    set: &FacetSet,
    field: &Field,
    components: usize,
    direction: impl Fn(&FacetMap) -> Point,
) {
    if field.is_zero() {
        return;
    }
    for block in &set.blocks {
        let table = ShapeTable::new(block.element, data_degree(block.element));
        let mut map = FacetMap::new(mesh, &table);
        let (mut points, mut entries) = (Vec::new(), Vec::new());
        for nodes in block.nodes.chunks_exact(block.element.nodes.len()) {
            for q in 0..table.len() {
                map.at(nodes, q);
                points.push(map.position);
                let direction = direction(&map);
                for (&node, value) in nodes.iter().zip(map.values()) {
                    let first = node * components as u32;
                    entries.extend(
                        (0..components).map(|c| (first + c as u32, table.weights[q] * map.area * value * direction[c])),
                    );
                }
            }
        }
        load.add(field, block.element.nodes.len() * components, points, entries);
    }
}

fn unit(c: usize) -> Point {
    std::array::from_fn(|d| if d == c { 1.0 } else { 0.0 })
}

/// Forces and moments on a rigid part, as nodal forces that do the same work in its rigid motions.
fn rigid_terms(mesh: &Mesh, load: &mut Load, part: &RigidPart) {
    let body = RigidNodes::new(mesh, part.nodes(mesh), part.turns);
    let at = part.at.or_else(|| part.centre(mesh)).unwrap_or_default();
    let axis = |c: usize| if mesh.dim == 3 { unit(c) } else { unit(2) };
    let of_force = part.force.iter().enumerate().map(|(c, field)| (field, unit(c), [0.0; 3]));
    let of_moment = part.moment.iter().enumerate().map(|(c, field)| (field, [0.0; 3], axis(c)));
    for (field, force, moment) in of_force.chain(of_moment) {
        let forces = body.forces(&body.work(&at, &force, &moment));
        let entries = body
            .nodes
            .iter()
            .zip(&forces)
            .flat_map(|(&node, force)| (0..mesh.dim).map(move |c| (node * mesh.dim as u32 + c as u32, force[c])));
        let entries: Vec<(u32, f64)> = entries.collect();
        load.add(field, entries.len(), vec![at], entries);
    }
}

/// (f(t), v)_V of (2.16) with all loads of a problem: those of [`f`], of its regions and on its rigid parts.
#[must_use]
pub fn mechanical_load(problem: &ProblemData) -> Load {
    let mesh = &problem.mesh;
    let mut load = f(mesh, &problem.body_force, &problem.boundary);
    for RegionLoad { region, body_force, gravity, .. } in &problem.region_loads {
        let mut add = |field: &Field, c: usize, factor: &dyn Fn(&Point) -> f64| {
            let terms = CellTerms { field, region: Some(*region), component: (c, mesh.dim), factor };
            add_cell_terms(mesh, &mut load, &terms);
        };
        body_force.iter().enumerate().for_each(|(c, field)| add(field, c, &|_| 1.0));
        if let Some((fields, density)) = gravity {
            fields.iter().enumerate().for_each(|(c, field)| add(field, c, &|x| density.at(x)));
        }
    }
    problem.rigid.iter().for_each(|part| rigid_terms(mesh, &mut load, part));
    load
}

/// (q_h(t), η)_Q of (2.17) with all loads of a problem: those of [`q`] and of its regions.
#[must_use]
pub fn thermal_load(problem: &ProblemData) -> Load {
    let mesh = &problem.mesh;
    let mut load = q(mesh, &problem.heat_source, &problem.boundary);
    for RegionLoad { region, heat_source: field, .. } in &problem.region_loads {
        let terms = CellTerms { field, region: Some(*region), component: (0, 1), factor: &|_| 1.0 };
        add_cell_terms(mesh, &mut load, &terms);
    }
    load
}

/// (f(t), v)_V of (2.16): body force, tractions, forces F with the traction F/|Γ| on their side, edge or points, and
/// pressures p with the traction −pν.
#[must_use]
pub fn f(mesh: &Mesh, body_force: &[Field], boundary: &[BoundaryCondition]) -> Load {
    let mut load = Load::new(mesh.points.len() * mesh.dim);
    for (c, field) in body_force.iter().enumerate() {
        cell_terms(mesh, &mut load, field, mesh.dim, c);
    }
    for condition in boundary {
        if let Some(set) = mesh.named(&condition.on) {
            condition_terms(mesh, &mut load, condition, set);
        }
    }
    load
}

/// Adds the terms of a condition on some facets of its side.
fn condition_terms(mesh: &Mesh, load: &mut Load, condition: &BoundaryCondition, set: &FacetSet) {
    for (c, field) in condition.traction.iter().flatten().enumerate() {
        facet_terms(mesh, load, set, field, mesh.dim, |_| unit(c));
    }
    let size = mesh.named(&condition.on).map_or(1.0, |set| mesh.measure(set));
    for (c, field) in condition.force.iter().flatten().enumerate() {
        facet_terms(mesh, load, set, field, mesh.dim, |_| unit(c).map(|e| e / size));
    }
    if let Some(pressure) = &condition.pressure {
        facet_terms(mesh, load, set, pressure, mesh.dim, |map| map.normal.map(|nu| -nu));
    }
}

/// The loads of a problem on some facets: conditions on the facets that both have, and loads on rigid parts whose nodes
/// all belong to these facets.
pub(crate) fn load_on(problem: &ProblemData, set: &FacetSet) -> Load {
    let (mesh, nodes) = (&problem.mesh, set.node_list());
    let mut load = Load::new(mesh.points.len() * mesh.dim);
    for condition in &problem.boundary {
        let common = mesh.named(&condition.on).map(|of_condition| set.common(of_condition));
        if let Some(common) = common.filter(|common| !common.is_empty()) {
            condition_terms(mesh, &mut load, condition, &common);
        }
    }
    let is_in = |node: &u32| nodes.binary_search(node).is_ok();
    let of_set = problem.rigid.iter().filter(|part| part.nodes(mesh).iter().all(is_in));
    of_set.for_each(|part| rigid_terms(mesh, &mut load, part));
    load
}

/// (q_h(t), η)_Q of (2.17): heat source, heat inflow through the boundary, and h θ_a of convection.
#[must_use]
pub fn q(mesh: &Mesh, heat_source: &Field, boundary: &[BoundaryCondition]) -> Load {
    let mut load = Load::new(mesh.points.len());
    cell_terms(mesh, &mut load, heat_source, 1, 0);
    for condition in boundary {
        let Some(set) = mesh.named(&condition.on) else { continue };
        if let Some(field) = &condition.heat_inflow {
            facet_terms(mesh, &mut load, set, field, 1, |_| unit(0));
        }
        if let Some(Convection { coefficient, ambient }) = &condition.convection {
            facet_terms(mesh, &mut load, set, ambient, 1, |map| [coefficient.value(&map.position, 0.0), 0.0, 0.0]);
        }
    }
    load
}
