//! What holds the body, and what holds it where contact should.

use super::super::Finding;
use super::super::laws::at;
use super::super::sample::times;
use super::warning;
use crate::mesh::Mesh;
use crate::mesh::defects::{Component, components};
use crate::problem::{Problem, Support};
use crate::space::Space;
use crate::tensor::Point;

/// Direction cosines below which a displacement has no part along the normal.
const ACROSS: f64 = 1e-6;
/// Time levels at which prescribed displacements are looked at.
const LEVELS: usize = 64;

/// `contact-held`: points of Γ_C whose normal displacement a side prescribes, where it closes the gap. Forces there go into the support.
pub(super) fn contact_held(problem: &Problem) -> Vec<Finding> {
    let (mesh, space, boundary) = (&problem.mesh, problem.displacement_space(), problem.contact_boundary());
    let dim = mesh.dim;
    let held = |node: u32, normal: &Point| (0..dim).all(|c| normal[c].abs() < ACROSS || !space.free[node as usize * dim + c]);
    let mut findings = Vec::new();
    for (side, contact) in problem.contacts.iter().enumerate() {
        let on_side = || boundary.points.iter().filter(|p| p.side == side);
        let candidates: Vec<_> = on_side().filter(|p| p.nodes.iter().all(|&(i, _)| held(boundary.nodes[i], &p.normal))).collect();
        if candidates.is_empty() {
            continue;
        }
        let places: Vec<Point> = candidates.iter().map(|p| p.x).collect();
        let mut closed = vec![false; candidates.len()];
        for t in times(problem, LEVELS) {
            let mut u = vec![0.0; space.free.len()];
            space.prescribe(t, &mut u);
            for (((point, gap), closed), place) in candidates.iter().zip(contact.gaps(&places, t)).zip(&mut closed).zip(&places) {
                let move_of = |&(i, n): &(usize, f64)| (0..dim).map(|c| n * point.normal[c] * u[boundary.nodes[i] as usize * dim + c]).sum::<f64>();
                let normal = point.nodes.iter().map(move_of).sum::<f64>();
                // A gap that is closed to the round-off of the coordinates is closed.
                let round_off = 4.0 * f64::EPSILON * place.iter().fold(normal.abs(), |max, x| max.max(x.abs()));
                *closed |= normal - gap >= -round_off;
            }
        }
        let bearing = || candidates.iter().zip(&closed).filter(|(_, closed)| **closed).map(|(point, _)| point);
        let Some(first) = bearing().next() else { continue };
        let share = bearing().map(|p| p.weight).sum::<f64>() / on_side().map(|p| p.weight).sum::<f64>();
        let message = format!(
            "the normal displacement is prescribed at {} of {} contact points of \"{}\", {:.2} % of its area, the first at {}: the foundation bears nothing \
             there, the support does",
            bearing().count(),
            on_side().count(),
            contact.on,
            100.0 * share,
            at(&first.x)
        );
        let repair = "prescribe tangential components only next to Γ_C (\"free\" for the others), or end one of the two sides before the other";
        findings.push(warning("contact-held", &format!("{}.on", problem.contact_path(side)), [share, 0.0], message, repair));
    }
    findings
}

/// `part-free`: parts of the body without contact that can move, or turn, without strain.
pub(super) fn part_free(problem: &Problem) -> Option<Finding> {
    let mesh = &*problem.mesh;
    let space = problem.displacement_space();
    let parts = components(mesh);
    let mut has_contact = vec![false; mesh.points.len()];
    let sides = problem.contacts.iter().filter_map(|contact| mesh.facets.get(&contact.on));
    sides.flat_map(|set| set.node_list()).for_each(|node| has_contact[node as usize] = true);
    let springs = sprung(problem);
    let free: Vec<(usize, &Component, usize)> = parts
        .iter()
        .enumerate()
        .filter(|(_, part)| !part.nodes.iter().any(|&node| has_contact[node as usize]))
        .map(|(number, part)| (number, part, rigid_motions(mesh, &space, &springs, part)))
        .filter(|(.., motions)| *motions > 0)
        .collect();
    let (number, part, motions) = *free.first()?;
    let [low, high] = part.bounds(mesh);
    let which = if parts.len() == 1 { "the body".to_owned() } else { format!("part {} of {} of the body", number + 1, parts.len()) };
    let message = format!(
        "{which}, from {} to {}, has no contact and can move without strain in {motions} ways: nothing but its inertia holds it{}",
        at(&low),
        at(&high),
        if free.len() > 1 { format!("; so do {} more parts", free.len() - 1) } else { String::new() }
    );
    let repair = "give `displacement`, `normal_displacement` or `spring` on a side of the part, or merge its nodes with those of its neighbour";
    Some(warning("part-free", "boundary", [motions as f64, 0.0], message, repair))
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
                    held.extend(set.node_list().into_iter().map(|node| (node, std::array::from_fn(|d| f64::from(u8::from(d == c))))));
                }
            }
            Support::Normal(field) if field.is_zero() => {}
            Support::Normal(_) => {
                for block in &set.blocks {
                    let table = crate::element::Table::at(block.element, block.element.nodes);
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

/// Number of independent motions without strain of a part that its supports leave free: 1, 3 or 6, a body of revolution 1, less the rank of
/// the supports on them.
fn rigid_motions(mesh: &Mesh, space: &Space, springs: &[(u32, Point)], part: &Component) -> usize {
    let dim = mesh.dim;
    let [low, high] = part.bounds(mesh);
    let centre: Point = std::array::from_fn(|d| 0.5 * (low[d] + high[d]));
    let size = (0..dim).map(|d| high[d] - low[d]).fold(0.0, f64::max);
    let motions = if mesh.axisymmetric { vec![5] } else { vec![vec![0], vec![0, 1, 2], (0..6).collect()].swap_remove(dim - 1) };
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
    let mut add = |node: u32, direction: &Point| {
        let mut row: Vec<f64> = motions.iter().map(|&m| value(m, &mesh.points[node as usize], direction)).collect();
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
        for c in (0..dim).filter(|c| !space.free[node as usize * dim + c]) {
            more = more && add(node, &std::array::from_fn(|d| f64::from(u8::from(d == c))));
        }
    }
    let inside = |node: u32| part.nodes.binary_search(&node).is_ok();
    for (node, direction) in springs.iter().filter(|(node, _)| inside(*node)) {
        more = more && add(*node, direction);
    }
    motions.len() - basis.len()
}
