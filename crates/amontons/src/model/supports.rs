//! The motions without strain that supports and springs leave a body.

use crate::mesh::defects::Component;
use crate::mesh::{FacetSet, Mesh};
use crate::problem::{Problem, Support};
use crate::space::Space;
use crate::tensor::Point;

/// Number of independent motions without strain of each part of the body that supports and springs do not hold; contact
/// is not counted.
#[must_use]
pub fn rigid_motions(problem: &Problem, parts: &[Component]) -> Vec<usize> {
    let (space, springs) = (problem.displacement_space(), sprung(problem));
    parts.iter().map(|part| motions_of(&problem.mesh, &space, &springs, part)).collect()
}

/// Whether each part of the body has a side whose temperature is held, by a prescribed value or the surroundings.
#[must_use]
pub(super) fn holds_temperature(problem: &Problem, parts: &[Component]) -> bool {
    let sides = problem.boundary.iter().filter(|b| b.holds_temperature()).filter_map(|b| problem.mesh.named(&b.on));
    let held: Vec<u32> = sides.flat_map(FacetSet::node_list).collect();
    parts.iter().all(|part| held.iter().any(|node| part.nodes.binary_search(node).is_ok()))
}

/// Directions in which springs hold nodes.
fn sprung(problem: &Problem) -> Vec<(u32, Point)> {
    let mesh = &problem.mesh;
    let mut held = Vec::new();
    for b in &problem.boundary {
        let (Some(spring), Some(set)) = (&b.spring, mesh.facets.get(&b.on)) else { continue };
        match spring {
            Support::Components(fields) => {
                for (c, _) in fields.iter().enumerate().take(mesh.dim).filter(|(_, field)| !field.is_zero()) {
                    held.extend(
                        set.node_list()
                            .into_iter()
                            .map(|node| (node, std::array::from_fn(|d| f64::from(u8::from(d == c))))),
                    );
                }
            }
            Support::Normal(field) if field.is_zero() => {}
            Support::Normal(_) => {
                for block in &set.blocks {
                    let table = crate::element::ShapeTable::at(block.element, block.element.nodes);
                    let mut map = crate::mesh::FacetMap::new(mesh, &table);
                    for facet in block.nodes.chunks_exact(block.element.nodes.len()) {
                        for (q, &node) in facet.iter().enumerate() {
                            map.at(facet, q);
                            held.push((node, map.normal));
                        }
                    }
                }
            }
        }
    }
    held
}

/// Number of independent motions without strain that the supports of a part leave free: 1, 3 or 6, in a body of
/// revolution 1, less the rank of the supports on them.
fn motions_of(mesh: &Mesh, space: &Space, springs: &[(u32, Point)], part: &Component) -> usize {
    let dim = mesh.dim;
    let [low, high] = part.bounds(mesh);
    let centre: Point = std::array::from_fn(|d| 0.5 * (low[d] + high[d]));
    let size = (0..dim).map(|d| high[d] - low[d]).fold(0.0, f64::max);
    let motions =
        if mesh.axisymmetric { vec![5] } else { vec![vec![0], vec![0, 1, 2], (0..6).collect()].swap_remove(dim - 1) };
    // A body of revolution only moves along its axis, and a plane one turns about z.
    let value = |motion: usize, x: &Point, direction: &Point| {
        let [x, y, z]: Point = std::array::from_fn(|d| if size > 0.0 { (x[d] - centre[d]) / size } else { 0.0 });
        let v = match (dim, mesh.axisymmetric, motion) {
            (_, true, _) => [0.0, 1.0, 0.0],
            (_, _, 0) => [1.0, 0.0, 0.0],
            (_, _, 1) => [0.0, 1.0, 0.0],
            (2, _, _) => [-y, x, 0.0],
            (_, _, 2) => [0.0, 0.0, 1.0],
            (_, _, 3) => [-y, x, 0.0],
            (_, _, 4) => [0.0, -z, y],
            _ => [z, 0.0, -x],
        };
        (0..3).map(|d| v[d] * direction[d]).sum::<f64>()
    };
    // Gram–Schmidt over the rows of the supports, largest remainder decides whether a row is new.
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let along = |node: u32, direction: &Point| -> Vec<f64> {
        motions.iter().map(|&m| value(m, &mesh.points[node as usize], direction)).collect()
    };
    let mut add = |mut row: Vec<f64>| {
        for _ in 0..2 {
            for b in &basis {
                let along: f64 = row.iter().zip(b).map(|(r, b)| r * b).sum();
                row.iter_mut().zip(b).for_each(|(r, b)| *r -= along * b);
            }
        }
        let length = row.iter().map(|r| r * r).sum::<f64>().sqrt();
        if length > 1e-6 {
            basis.push(row.iter().map(|r| r / length).collect());
        }
        basis.len() < motions.len()
    };
    let mut more = true;
    for &node in &part.nodes {
        for direction in space.held_directions(node) {
            more = more && add(along(node, &direction));
        }
    }
    let inside = |node: u32| part.nodes.binary_search(&node).is_ok();
    for (node, direction) in springs.iter().filter(|(node, _)| inside(*node)) {
        more = more && add(along(*node, direction));
    }
    // A motion of a node that follows another one is the motion of that one, turned.
    for link in space.links.iter().filter(|link| inside(link.node) && inside(link.to)) {
        for axis in space.directions(link.to).iter().take(dim) {
            let [own, followed] = [along(link.node, &link.turned(axis)), along(link.to, axis)];
            more = more && add(own.iter().zip(followed).map(|(own, followed)| own - followed).collect());
        }
    }
    motions.len() - basis.len()
}
