//! Supports of the body, and supports that prevent contact from acting.

use super::super::sample::{at, times};
use super::super::{Finding, FindingId};
use super::warning;
use crate::contact::Contact;
use crate::mesh::FacetSet;
use crate::mesh::defects::{Component, components};
use crate::model::rigid_motions;
use crate::problem::Problem;
use crate::tensor::{Point, dot};

/// Direction cosine below which a displacement has no normal component.
const ACROSS: f64 = 1e-6;
/// Number of time levels at which prescribed displacements are evaluated.
const LEVELS: usize = 64;

/// `contact-held`: warns if the normal displacement of points of Γ_C is prescribed and closes the gap. Forces there go
/// into the support.
pub(super) fn contact_held(problem: &Problem) -> Vec<Finding> {
    let (mesh, space, boundary) = (&problem.mesh, problem.displacement_space(), problem.contact_boundary());
    let dim = mesh.dim;
    let held = |node: u32, normal: &Point| {
        let mut rest = *normal;
        for direction in space.held_directions(node) {
            let along = dot(&rest, &direction);
            rest = std::array::from_fn(|c| rest[c] - along * direction[c]);
        }
        rest.iter().take(dim).all(|c| c.abs() < ACROSS)
    };
    let mut findings = Vec::new();
    for (side, contact) in of_foundations(problem) {
        let on_side = || boundary.points.iter().filter(|p| p.contact == side);
        let candidates: Vec<_> =
            on_side().filter(|p| p.nodes.iter().all(|&(i, _)| held(boundary.nodes[i], &p.normal))).collect();
        if candidates.is_empty() {
            continue;
        }
        let places: Vec<Point> = candidates.iter().map(|p| p.x).collect();
        let mut closed = vec![false; candidates.len()];
        for t in times(problem, LEVELS) {
            let mut u = vec![0.0; space.free.len()];
            space.prescribe(t, &mut u);
            for (((point, gap), closed), place) in
                candidates.iter().zip(contact.gaps(&places, t)).zip(&mut closed).zip(&places)
            {
                let normal = dot(&boundary.vector_at(point, dim, &u), &point.normal);
                // A gap counts as closed up to the round-off of the coordinates.
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
        findings.push(warning(
            FindingId::ContactHeld,
            &format!("{}.on", problem.contact_path(side)),
            [share, 0.0],
            message,
            repair,
        ));
    }
    findings
}

/// The contacts with foundations that act in the phase of a problem, with their numbers.
fn of_foundations(problem: &Problem) -> impl Iterator<Item = (usize, &Contact)> {
    problem.contacts.iter().enumerate().filter(|(_, contact)| contact.pair.is_none() && contact.acts())
}

/// `part-free`: warns about parts of the body without contact that can move or turn without strain.
pub(super) fn part_free(problem: &Problem) -> Option<Finding> {
    let mesh = &*problem.mesh;
    let parts = components(mesh);
    let mut has_contact = vec![false; mesh.points.len()];
    let acting = problem.contacts.iter().filter(|contact| contact.acts());
    let sides = acting.flat_map(Contact::sides).filter_map(|side| mesh.facets.get(side));
    sides.flat_map(FacetSet::node_list).for_each(|node| has_contact[node as usize] = true);
    let motions = rigid_motions(problem, &parts);
    let free: Vec<(usize, &Component, usize)> = parts
        .iter()
        .enumerate()
        .filter(|(_, part)| !part.nodes.iter().any(|&node| has_contact[node as usize]))
        .filter_map(|(number, part)| Some((number, part, *motions.get(number).filter(|motions| **motions > 0)?)))
        .collect();
    let (number, part, motions) = *free.first()?;
    let [low, high] = part.bounds(mesh);
    let which = if parts.len() == 1 {
        "the body".to_owned()
    } else {
        format!("part {} of {} of the body", number + 1, parts.len())
    };
    let message = format!(
        "{which}, from {} to {}, has no contact and {motions} rigid motions without support: only its inertia holds it{}",
        at(&low),
        at(&high),
        if free.len() > 1 { format!("; so do {} more parts", free.len() - 1) } else { String::new() }
    );
    let repair = "give `displacement`, `normal_displacement` or `spring` on a side of the part, or merge its nodes with those of its neighbour";
    Some(warning(FindingId::PartFree, "boundary", [motions as f64, 0.0], message, repair))
}

/// `point-force`: forces on a set of dimension below d − 1, under which the displacement has no bound.
pub(super) fn point_force(problem: &Problem) -> Option<Finding> {
    let mesh = &*problem.mesh;
    let (i, b, set) = problem.boundary.iter().enumerate().find_map(|(i, b)| {
        let acts = b.force.iter().flatten().any(|field| !field.is_zero()) && !mesh.facets.contains_key(&b.on);
        Some((i, b, mesh.edges.get(&b.on).filter(|_| acts)?))
    })?;
    let dimension = set.blocks.iter().map(|block| block.element.dim()).max().unwrap_or(0);
    let along = if dimension == 0 { "points" } else { "an edge" };
    let message = format!(
        "a force acts on {along}, \"{}\": in theory the displacement there is infinite; on a mesh it grows as the mesh is refined",
        b.on
    );
    let repair = "give the force on a side, however small, where the displacement or the stress near it matters; leave it where only the motion of the rest does";
    let numbers = [dimension as f64, mesh.dim as f64 - 1.0];
    Some(warning(FindingId::PointForce, &format!("boundary[{i}].force"), numbers, message, repair))
}
