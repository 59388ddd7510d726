//! (H6): loads, gap, initial and prescribed data.

use super::sample::{at, times};
use super::{Finding, FindingId, FindingStatus};
use crate::field::Field;
use crate::problem::Problem;
use crate::space::Prescription;
use crate::tensor::{Point, dot};
use crate::units::Measure;

/// Number of time levels at which the gap is evaluated.
const LEVELS: usize = 1024;

/// Mismatch of initial and prescribed values, relative to their size, that counts as round-off.
const MATCH: f64 = 1e-12;

/// Cosine of the angle above which two directions count as equal.
const PARALLEL: f64 = 1.0 - 1e-12;

/// One part of (H6).
struct Clause {
    status: FindingStatus,
    value: Option<f64>,
    message: String,
    place: String,
    repair: &'static str,
}

/// (H6) with the verdict of its worst part. Data are evaluated at the nodes of the mesh and at time levels; their
/// values in between are not known.
pub(super) fn h6(problem: &Problem) -> Finding {
    let parts = parts(problem);
    let worst = parts.iter().map(|p| p.status).max().unwrap_or(FindingStatus::Holds);
    let said: Vec<&str> = parts.iter().filter(|p| p.status == worst).map(|p| p.message.as_str()).collect();
    let first = parts.iter().find(|p| p.status == worst);
    let mut message = said.join("; ");
    if worst == FindingStatus::Holds {
        message = format!("{message}; j is convex, since p_τ ≥ 0 and its first term is linear in v");
    }
    let finding = Finding::new(FindingId::H6, worst, message, first.map_or("load", |p| p.place.as_str()));
    let needed = first.filter(|p| p.status != FindingStatus::Holds && p.value.is_some()).map(|_| 0.0);
    finding.numbers(first.and_then(|p| p.value), needed).repair(first.map_or("", |p| p.repair))
}

fn parts(problem: &Problem) -> Vec<Clause> {
    let mut parts = vec![finite(problem)];
    parts.extend(gap(problem));
    parts.extend(initial(problem));
    parts.extend(homogeneous(problem));
    parts
}

/// The requirement of Theorem 1 within (H6) that these data violate, if any: finite data and u₀ ∈ V. A negative gap is
/// allowed, and u̇₀ needs only be square integrable.
pub(super) fn not_in_v(problem: &Problem) -> Option<String> {
    let harmless = |part: &Clause| part.value.is_some() && !part.place.starts_with("initial.displacement");
    parts(problem)
        .into_iter()
        .find(|part| part.status == FindingStatus::Fails && !harmless(part))
        .map(|part| part.message)
}

/// Checks that loads are finite: bounded data are square integrable.
fn finite(problem: &Problem) -> Clause {
    for datum in problem
        .data()
        .into_iter()
        .chain(problem.initial_data())
        .filter(|d| !matches!(d.field, Field::Constant(v) if v.is_finite()))
    {
        let (points, place, field) = (problem.nodes_of(&datum), datum.key, datum.field);
        for t in [0.0, problem.timeline.end()] {
            let values = field.values(&points, t);
            if let Some(i) = values.iter().position(|v| !v.is_finite()) {
                let message = format!(
                    "{place} is {} at {}, t = {}",
                    values[i],
                    at(&points[i]),
                    problem.units().exact(t, Measure::Time)
                );
                return Clause {
                    status: FindingStatus::Fails,
                    value: None,
                    message,
                    place,
                    repair: "data that are finite everywhere",
                };
            }
        }
    }
    let message = "the data are finite at the nodes at t = 0 and t = T".to_owned();
    Clause { status: FindingStatus::Holds, value: None, message, place: "load".to_owned(), repair: "" }
}

/// g ≥ 0.
fn gap(problem: &Problem) -> Option<Clause> {
    let boundary = problem.contact_boundary();
    let least = problem.contacts.iter().enumerate().filter_map(|(side, contact)| {
        let points: Vec<Point> = boundary.points.iter().filter(|p| p.contact == side).map(|p| p.x).collect();
        let levels = if contact.gap_depends_on_time() { times(problem, LEVELS) } else { vec![0.0] };
        let values = levels
            .iter()
            .flat_map(|&t| contact.gaps(&points, t).into_iter().zip(&points).map(move |(g, x)| (g, *x, t)));
        let (least, x, t) = values.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some((
            least,
            x,
            t,
            levels,
            format!("{}.{}", problem.contact_path(side), if contact.obstacle.is_some() { "obstacle" } else { "gap" }),
        ))
    });
    let (least, x, t, levels, place) = least.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let (status, sign) =
        if least >= 0.0 { (FindingStatus::Holds, "g ≥ 0") } else { (FindingStatus::Fails, "the gap is negative") };
    let when = if levels.len() > 1 {
        format!(", t = {}, of {} time levels", problem.units().exact(t, Measure::Time), levels.len())
    } else {
        String::new()
    };
    let message = format!("{sign}: its least value is {least:.6e} at {}{when}", at(&x));
    Some(Clause {
        status,
        value: Some(least),
        message,
        place,
        repair: "use a gap that is not negative; for a body that is pressed in from the start give initial.displacement",
    })
}

/// The largest mismatch of an initial field on the boundary: amount, expected value, position, and key.
type Mismatch = Option<(f64, f64, Point, String)>;

/// The largest mismatches of u₀, u̇₀ and θ₀ with prescribed values, and of u̇₀ with the rates of these; without inertia
/// u̇₀ has no effect.
fn mismatches(problem: &Problem) -> [Mismatch; 3] {
    let mesh = &problem.mesh;
    let start = &problem.initial;
    let is_inert = problem.values_of(|m| &m.density).iter().any(|sample| sample.value > 0.0);
    let (mut is_seen, mut held) = (vec![false; mesh.points.len()], vec![Vec::new(); mesh.points.len()]);
    let mut worst: [Mismatch; 3] = [None, None, None];
    let part = |fields: &[Field], direction: &Point, x: &Point| -> f64 {
        fields.iter().zip(direction).filter(|(_, part)| **part != 0.0).map(|(f, part)| part * f.value(x, 0.0)).sum()
    };
    // At a node of two sides the first one counts.
    for b in &problem.boundary {
        let Some(set) = mesh.named(&b.on) else { continue };
        for Prescription { direction, field, .. } in b.prescriptions(mesh) {
            for node in set.node_list() {
                let before: &mut Vec<Point> = &mut held[node as usize];
                if before.iter().any(|other| dot(other, &direction).abs() > PARALLEL) {
                    continue;
                }
                before.push(direction);
                let x = &mesh.points[node as usize];
                let along = (0..mesh.dim).find(|&c| direction[c].abs() > PARALLEL);
                let (index, sign) = along.map_or((String::new(), 1.0), |c| (format!("[{c}]"), direction[c].signum()));
                let found = sign * part(&start.displacement, &direction, x);
                let place = format!("initial.displacement{index}");
                keep(&mut worst[0], found, sign * field.value(x, 0.0), x, place);
                if is_inert {
                    let (found, rate) = (part(&start.velocity, &direction, x), field.derivatives(x, 0.0).by_t);
                    keep(&mut worst[1], sign * found, sign * rate, x, format!("initial.velocity{index}"));
                }
            }
        }
        for node in b.temperature.iter().flat_map(|_| set.node_list()) {
            if let Some(field) =
                b.temperature.as_ref().filter(|_| !std::mem::replace(&mut is_seen[node as usize], true))
            {
                let x = &mesh.points[node as usize];
                let found = start.temperature.value(x, 0.0);
                keep(&mut worst[2], found, field.value(x, 0.0), x, "initial.temperature".to_owned());
            }
        }
    }
    worst
}

/// Checks that u₀, u̇₀ and θ₀ have the prescribed values and u̇₀ their rates. (H6) requires it of u₀ and u̇₀ only.
fn initial(problem: &Problem) -> Vec<Clause> {
    let mut parts: Vec<Clause> = Vec::new();
    for (worst, status) in
        mismatches(problem).into_iter().zip([FindingStatus::Fails, FindingStatus::Fails, FindingStatus::NotCovered])
    {
        let Some((mismatch, expected, x, place)) = worst else { continue };
        let what = if status == FindingStatus::Fails {
            "the first step has a jump"
        } else {
            "enough for a solution, but the errors of the first steps do not have the order of (4.4)"
        };
        let message =
            format!("{place} differs by {mismatch:.6e} from the prescribed {expected:.6e} at {}: {what}", at(&x));
        parts.push(Clause {
            status,
            value: Some(mismatch),
            message,
            place,
            repair: "initial data that have the prescribed values, and rates, at t = 0",
        });
    }
    if parts.is_empty() {
        let message = "initial and prescribed values agree".to_owned();
        parts.push(Clause {
            status: FindingStatus::Holds,
            value: Some(0.0),
            message,
            place: "initial".to_owned(),
            repair: "",
        });
    }
    parts
}

/// Keeps the larger mismatch.
fn keep(worst: &mut Mismatch, found: f64, expected: f64, x: &Point, place: String) {
    let mismatch = (found - expected).abs();
    if mismatch > MATCH * found.abs().max(expected.abs()) && worst.as_ref().is_none_or(|w| mismatch > w.0) {
        *worst = Some((mismatch, expected, *x, place));
    }
}

/// (2.5), (2.7): prescribed values are zero.
fn homogeneous(problem: &Problem) -> Option<Clause> {
    for (i, b) in problem.boundary.iter().enumerate() {
        let displacement =
            b.displacement.iter().flatten().flatten().chain(&b.normal_displacement).any(|f| !f.is_zero());
        if !displacement && b.temperature.as_ref().is_none_or(Field::is_zero) {
            continue;
        }
        let what = if displacement { "displacement" } else { "temperature" };
        let message = format!(
            "the prescribed {what} on \"{}\" is not zero as in (2.5), (2.7); subtracting a function with these values gives a problem of the paper's form with other loads, gap and θ_F, and the same (H1)–(H5), (H7), (H8)",
            b.on
        );
        return Some(Clause {
            status: FindingStatus::NotCovered,
            value: None,
            message,
            place: format!("boundary[{i}].{what}"),
            repair: "none is needed if the data are smooth in time",
        });
    }
    None
}
