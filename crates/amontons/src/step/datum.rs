//! Search for the datum that is not finite if a step failed.

use crate::element::{Element, ShapeTable};
use crate::equation::StepError;
use crate::forms;
use crate::mesh::{CellMap, FacetMap, Mesh};
use crate::problem::{Datum, Problem};
use crate::state::State;
use crate::tensor::Point;

/// Adds to the error of a step with values that are not finite the datum that caused it, if one is found. Other errors
/// are returned unchanged.
pub(crate) fn named(problem: &Problem, old: &State, error: StepError) -> StepError {
    let StepError::NotFinite { step, t, .. } = error else { return error };
    // The data of the foundation are used at both ends of a step.
    let found = [t, old.t].into_iter().find_map(|t| Some((t, culprit(problem, old, t)?)));
    found.map_or(error, |(t, (key, value, at))| StepError::Data { step, t, key, value, at })
}

/// A datum that has no finite value at a time: key, value, and position.
fn culprit(problem: &Problem, old: &State, t: f64) -> Option<(String, f64, Point)> {
    let first = |points: &[Point], datum: &Datum| {
        let values = datum.field.values(points, t);
        let (value, x) = values.into_iter().zip(points).find(|(value, _)| !value.is_finite())?;
        Some((datum.key.clone(), value, *x))
    };
    let data = problem.data();
    // The nodes are searched first: a fault of an expression is easier to see there.
    let at_nodes = data.iter().find_map(|datum| first(&problem.nodes_of(datum), datum));
    let inside = || {
        data.iter()
            .filter(|datum| datum.field.depends_on_space())
            .find_map(|datum| first(&quadrature(&problem.mesh, datum.side), datum))
    };
    at_nodes.or_else(inside).or_else(|| obstacle(problem, old, t))
}

/// The quadrature points of the loads on a side or in the body.
fn quadrature(mesh: &Mesh, side: Option<&str>) -> Vec<Point> {
    let table = |element: &'static Element| ShapeTable::new(element, forms::data_degree(element));
    let mut points = Vec::new();
    let Some(side) = side else {
        for block in &mesh.blocks {
            let table = table(block.element);
            let mut map = CellMap::new(mesh, &table);
            for (cell, q) in block.cells().flat_map(|cell| (0..table.len()).map(move |q| (cell, q))) {
                map.at(cell, q);
                points.push(map.position);
            }
        }
        return points;
    };
    for block in mesh.facets.get(side).into_iter().flat_map(|set| &set.blocks) {
        let table = table(block.element);
        let mut map = FacetMap::new(mesh, &table);
        for facet in block.nodes.chunks_exact(block.element.nodes.len()) {
            for q in 0..table.len() {
                map.at(facet, q);
                points.push(map.position);
            }
        }
    }
    points
}

/// An obstacle that has no nearest point.
fn obstacle(problem: &Problem, old: &State, t: f64) -> Option<(String, f64, Point)> {
    let (boundary, dim) = (problem.contact_boundary(), problem.mesh.dim);
    boundary.points.iter().find_map(|point| {
        let obstacle = problem.contacts.get(point.contact)?.obstacle.as_ref()?;
        let u = boundary.vector_at(point, dim, &old.u);
        let found = [point.x, std::array::from_fn(|c| point.x[c] + u[c])]
            .into_iter()
            .map(|x| (obstacle.nearest(&x, t).distance, x))
            .find(|(distance, _)| !distance.is_finite())?;
        Some((format!("{}.obstacle", problem.contact_path(point.contact)), found.0, found.1))
    })
}
