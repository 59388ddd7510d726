//! `start-kept`: penetrations and gaps at t = 0 that a scheme which holds velocities on rigid foundations keeps.

use super::super::sample::at;
use super::super::{Finding, FindingId};
use super::warning;
use crate::contact::{Contact, ContactBoundary, GraphKind, PointOnBoundary};
use crate::problem::Problem;
use crate::tensor::{Point, dot, length};
use crate::units::Measure;

/// Penetration or gap at t = 0 that is round-off: over the largest position of a node.
const ROUND_OFF: f64 = 1e-12;

/// Warns of rigid contacts in the ϑ-scheme whose body starts inside the foundation or, if contact is bilateral, apart
/// from it.
pub(super) fn at_start(problem: &Problem) -> Vec<Finding> {
    // The steps of a quasistatic phase close gaps at their ends.
    let first = problem.timeline.instant(1);
    if !problem.has_impacts() || problem.rule(first.analysis, first.k).contact.is_none() {
        return Vec::new();
    }
    let (space, boundary) = (problem.displacement_space(), problem.contact_boundary());
    let u = space.interpolate(&problem.mesh, &problem.initial.displacement, 0.0);
    let least = ROUND_OFF * problem.mesh.points.iter().map(length).fold(0.0, f64::max);
    let contacts =
        problem.contacts.iter().enumerate().filter(|(_, contact)| contact.acts() && contact.normal.is_rigid());
    contacts.filter_map(|(number, _)| of_contact(problem, &boundary, &u, number, least)).collect()
}

fn of_contact(problem: &Problem, boundary: &ContactBoundary, u: &[f64], number: usize, least: f64) -> Option<Finding> {
    let contact = problem.contacts.get(number)?;
    let points = boundary.points.iter().filter(|point| point.contact == number && point.weight > 0.0);
    let apart = |point: &PointOnBoundary| {
        let r = penetration(problem, boundary, u, contact, point);
        if contact.normal.graph() == GraphKind::Bilateral { r.abs() } else { r }
    };
    let (point, depth) =
        points.map(|point| (point, apart(point))).max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, r)| *r > least)?;
    let message = format!(
        "at t = 0 \"{}\" is {} its rigid foundation by up to {}, at {}: the ϑ-scheme holds velocities there, so that this distance stays",
        contact.on,
        if penetration(problem, boundary, u, contact, point) > 0.0 { "inside" } else { "apart from" },
        problem.units().write(depth, Measure::Length),
        at(&point.x)
    );
    let repair = "let the gap of an interference change from zero, as \"-1e-3*t\" does, take a compliance, or time.scheme = \"euler\", which closes it in the first step; leave it if the distance is meant to stay";
    let place = format!("{}.gap", problem.contact_path(number));
    Some(warning(FindingId::StartKept, &place, [depth, least], message, repair))
}

/// r = u_ν − g at t = 0, m.
fn penetration(
    problem: &Problem,
    boundary: &ContactBoundary,
    u: &[f64],
    contact: &Contact,
    point: &PointOnBoundary,
) -> f64 {
    let moved = boundary.vector_at(point, problem.mesh.dim, u);
    let mut gap = contact.gap.value(&point.x, 0.0);
    if contact.pair.as_ref().is_some_and(|pair| !pair.gap_is_given) {
        gap += point.gap - if contact.is_tie() { point.closed } else { 0.0 };
    }
    let Some(obstacle) = &contact.obstacle else { return dot(&moved, &point.normal) - gap };
    let seen: Point = std::array::from_fn(|c| point.x[c] + if obstacle.updated { moved[c] } else { 0.0 });
    let nearest = obstacle.nearest(&seen, 0.0);
    let along = if obstacle.updated { 0.0 } else { dot(&moved, &nearest.normal) };
    -(nearest.distance + along + gap)
}
