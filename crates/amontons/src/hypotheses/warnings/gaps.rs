//! `pair-gap`, `start-inside`: gaps at rest between the sides of pairs on the mesh, and to obstacles.
//!
//! The vertices of a curved side lie on it, while its facets cut in by their depth. If both sides have the same
//! curvature, as a shaft in its bearing, and their facets do not match one by one, the gap of the mesh is the true gap
//! plus a share of both depths that varies along the side. That variation is distinguished from a shift of the bodies,
//! with the gap a + b·ν, by the remainder of the gap after the best fit of this form.

use std::collections::BTreeMap;

use super::super::{Finding, FindingId};
use super::warning;
use crate::contact::{Contact, PointOnBoundary};
use crate::element::ShapeTable;
use crate::mesh::{FacetMap, FacetSet, Mesh};
use crate::problem::Problem;
use crate::tensor::{Point, dot, length};
use crate::units::{Measure, Units};

/// Depth of an overlap that is round-off of a mesh file: relative to a facet, and to the size of the side.
const OF_FACET: f64 = 1e-6;
const OF_SIDE: f64 = 2e-7;
/// Fractions of the mean gap above which facets change pressures: their depth, and the variation of the gap by them,
/// which vanishes if facets match one by one.
const DEEP: f64 = 0.25;
const VARIES: f64 = 0.01;
/// Cosine of the angle between facets beyond which they form a kink instead of a curvature: 35°.
const KINK: f64 = 0.819;

/// `pair-gap`: warns if bodies overlap at rest, or if the facets of their sides are deep compared with the gap. A given
/// gap is not checked.
pub(super) fn of_pairs(problem: &Problem) -> Vec<Finding> {
    let of_mesh = |contact: &Contact| contact.pair.as_ref().filter(|pair| !pair.gap_is_given).map(|pair| pair.closes);
    if !problem.contacts.iter().any(|contact| of_mesh(contact).is_some()) {
        return Vec::new();
    }
    let boundary = problem.contact_boundary();
    let sides = problem.contacts.iter().enumerate().filter_map(|(i, contact)| Some((i, contact, of_mesh(contact)?)));
    sides.filter_map(|(i, contact, closes)| of_pair(problem, &boundary.points, (i, contact), closes)).collect()
}

fn of_pair(
    problem: &Problem,
    points: &[PointOnBoundary],
    (number, contact): (usize, &Contact),
    closes: bool,
) -> Option<Finding> {
    let (mesh, units) = (&*problem.mesh, problem.units());
    let write = |value: f64| units.write(value, Measure::Length);
    let shift = |x: &Point| contact.gap.value(x, 0.0);
    let points: Vec<(&PointOnBoundary, f64)> = points
        .iter()
        .filter(|point| point.contact == number && point.weight > 0.0)
        .map(|point| (point, point.gap - if contact.is_tie() { point.closed } else { 0.0 } + shift(&point.x)))
        .collect();
    let (deepest, low) = *points.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let high = points.iter().map(|(_, gap)| *gap).fold(low, f64::max);
    let pair = contact.pair.as_ref()?;
    let names = [contact.on.as_str(), pair.with.as_str()];
    let sets = names.map(|name| mesh.facets.get(name));
    let depths = sets.map(|set| set.map_or(0.0, |set| depth(mesh, set)));
    let round_off = sets.iter().flatten().map(|set| round_off(mesh, set)).fold(0.0, f64::max);
    let overlap = if contact.acts() && !closes && low < -round_off { -low } else { 0.0 };
    let (mean, varies) = variation(&points);
    let deep = depths[0].max(depths[1]);
    if contact.is_tie() {
        return of_tie(problem, (number, contact), &points, 2.0 * deep + round_off);
    }
    let cuts = deep > DEEP * mean && varies > (VARIES * mean).max(round_off);
    if overlap == 0.0 && !cuts {
        return None;
    }
    let (from, to, unit) = units.range([low, high], Measure::Length);
    let [on, with] = names;
    let mut message = format!("the gap that the mesh gives between \"{on}\" and \"{with}\" goes from {from} to {to}");
    message += &if unit.is_empty() { unit } else { format!(" {unit}") };
    if overlap > 0.0 {
        let (depth, place) = (write(overlap), mesh.place(&deepest.x));
        message += &format!("; they overlap at rest by up to {depth}, at {place}: the first step pushes them apart");
    }
    if cuts {
        let [own, other] = depths.map(write);
        message += &format!(
            "; the facets of \"{on}\" are {own} deep, those of \"{with}\" {other}, beside a mean gap of {}: pressures follow the facets",
            write(mean)
        );
    }
    let numbers = if overlap > 0.0 { [overlap, round_off] } else { [deep, DEEP * mean] };
    let place = format!("{}.gap", problem.contact_path(number));
    Some(warning(FindingId::PairGap, &place, numbers, message, repair(cuts, units)))
}

/// Warns if the sides of a tie are farther apart than their facets explain.
fn of_tie(
    problem: &Problem,
    (number, contact): (usize, &Contact),
    points: &[(&PointOnBoundary, f64)],
    most: f64,
) -> Option<Finding> {
    let (farthest, gap) = *points.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    let names: Vec<String> = contact.sides().map(|name| format!("\"{name}\"")).collect();
    let (apart, place) = (problem.units().write(gap.abs(), Measure::Length), problem.mesh.place(&farthest.x));
    let how = if gap > 0.0 { "apart" } else { "inside each other" };
    let message =
        format!("the tied sides {} are up to {apart} {how}, at {place}: they keep this distance", names.join(" and "));
    let repair = "mend the mesh so that the sides touch, or name only those facets that do".to_owned();
    let at = format!("{}.with", problem.contact_path(number));
    (gap.abs() > most).then(|| warning(FindingId::PairGap, &at, [gap.abs(), most], message, repair))
}

/// The instruction that repairs a gap.
fn repair(cuts: bool, units: Units) -> String {
    let example = if units.of(Measure::Length).is_empty() { "" } else { ", such as gap = \"10 µm\"," };
    if cuts {
        format!(
            "give the clearance or interference as `gap`{example} in place of the gap of the mesh, or take finer or quadratic cells"
        )
    } else {
        format!(
            "give an interference that is meant as `gap`{example} in place of the gap of the mesh, take `close = true` to let the bodies touch without stress, or mend the mesh"
        )
    }
}

/// `start-inside`: warns if a side is inside an obstacle at t = 0 by more than the depth of its facets. The gap of a
/// foundation without an obstacle is a datum: a negative one is an intended preload.
pub(super) fn of_obstacles(problem: &Problem) -> Vec<Finding> {
    if problem.contacts.iter().all(|contact| contact.obstacle.is_none()) {
        return Vec::new();
    }
    let boundary = problem.contact_boundary();
    let sides = problem.contacts.iter().enumerate().filter(|(_, contact)| contact.acts());
    sides.filter_map(|(number, contact)| of_obstacle(problem, &boundary.points, number, contact)).collect()
}

fn of_obstacle(problem: &Problem, points: &[PointOnBoundary], number: usize, contact: &Contact) -> Option<Finding> {
    let (mesh, obstacle) = (&*problem.mesh, contact.obstacle.as_ref()?);
    let set = mesh.facets.get(&contact.on)?;
    let displaced = |x: &Point| -> Point {
        std::array::from_fn(|c| problem.initial.displacement.get(c).map_or(0.0, |field| field.value(x, 0.0)))
    };
    let inside = |point: &PointOnBoundary| {
        let u = displaced(&point.x);
        let x: Point = std::array::from_fn(|c| point.x[c] + if obstacle.updated { u[c] } else { 0.0 });
        let nearest = obstacle.nearest(&x, 0.0);
        let moved = if obstacle.updated { 0.0 } else { dot(&u, &nearest.normal) };
        -(nearest.distance + moved + contact.gap.value(&point.x, 0.0))
    };
    let depths: Vec<(&PointOnBoundary, f64)> =
        points.iter().filter(|point| point.contact == number).map(|point| (point, inside(point))).collect();
    let limit = limit(mesh, set);
    let (deepest, most) = *depths.iter().filter(|(_, depth)| *depth > limit).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let message = format!(
        "at t = 0 \"{}\" is inside the obstacle by up to {}, at {}, and at {} of its {} contact points: the first step pushes it out",
        contact.on,
        problem.units().write(most, Measure::Length),
        mesh.place(&deepest.x),
        depths.iter().filter(|(_, depth)| *depth > limit).count(),
        depths.len()
    );
    let repair = "let the obstacle start outside of the body: move it, turn its normal, or turn the sign of its level, which is positive outside of the obstacle; leave it if an interference is meant";
    let place = format!("{}.obstacle", problem.contact_path(number));
    Some(warning(FindingId::StartInside, &place, [most, limit], message, repair))
}

/// The depth up to which a side is not inside what it faces: its facets cut in by so much.
pub(super) fn limit(mesh: &Mesh, set: &FacetSet) -> f64 {
    round_off(mesh, set).max(depth(mesh, set))
}

/// The overlap depth that is round-off on a side, m.
fn round_off(mesh: &Mesh, set: &FacetSet) -> f64 {
    let facet = GapFacet::all(mesh, set).iter().map(|facet| facet.size).fold(f64::INFINITY, f64::min);
    let far = set.node_list().into_iter().filter_map(|node| mesh.points.get(node as usize)).map(length);
    (if facet.is_finite() { OF_FACET * facet } else { 0.0 }).max(OF_SIDE * far.fold(0.0, f64::max))
}

/// A facet: its vertices with their normals, and its size.
struct GapFacet {
    vertices: Vec<(u32, Point)>,
    size: f64,
}

impl GapFacet {
    fn all(mesh: &Mesh, set: &FacetSet) -> Vec<GapFacet> {
        let mut all = Vec::new();
        for block in &set.blocks {
            let count = block.element.shape.vertices();
            let table = ShapeTable::at(block.element, block.element.nodes.get(..count).unwrap_or_default());
            let mut map = FacetMap::new(mesh, &table);
            for nodes in block.nodes.chunks_exact(block.element.nodes.len()) {
                let mut vertices = Vec::with_capacity(count);
                for (q, &node) in nodes.iter().take(count).enumerate() {
                    map.at(nodes, q);
                    vertices.push((node, map.normal));
                }
                let size = vertices.iter().map(|(node, _)| distance(mesh, vertices.first().map(|v| v.0), *node));
                let size = size.fold(0.0, f64::max);
                all.push(GapFacet { vertices, size });
            }
        }
        all
    }

    /// Its vertices (of a line) or edges (of a face), which it may share with other facets: nodes, normal, and extent
    /// of the facet from there.
    fn rims(&self, mesh: &Mesh) -> Vec<([u32; 2], Point, f64)> {
        let n = self.vertices.len();
        let at = |i: usize| self.vertices.get(i % n.max(1)).copied().unwrap_or((0, [0.0; 3]));
        let rim = |i: usize| {
            let ((a, normal), (b, other)) = (at(i), at(i + 1));
            if n == 2 {
                return ([a, a], normal, self.size);
            }
            let far = self.vertices.iter().map(|(node, _)| from_line(mesh, [a, b], *node)).fold(0.0, f64::max);
            let mean: Point = std::array::from_fn(|c| normal[c] + other[c]);
            let size = length(&mean).max(f64::MIN_POSITIVE);
            ([a.min(b), a.max(b)], mean.map(|c| c / size), far)
        };
        (0..if n < 2 { 0 } else { n }).map(rim).collect()
    }
}

fn point(mesh: &Mesh, node: u32) -> Point {
    mesh.points.get(node as usize).copied().unwrap_or_default()
}

fn distance(mesh: &Mesh, from: Option<u32>, to: u32) -> f64 {
    let (a, b) = (point(mesh, from.unwrap_or(to)), point(mesh, to));
    length(&std::array::from_fn(|c| a[c] - b[c]))
}

/// Distance of a node from the line through two others.
fn from_line(mesh: &Mesh, [a, b]: [u32; 2], node: u32) -> f64 {
    let [a, b, x] = [a, b, node].map(|node| point(mesh, node));
    let (along, v): (Point, Point) = (std::array::from_fn(|c| b[c] - a[c]), std::array::from_fn(|c| x[c] - a[c]));
    let squared = dot(&along, &along).max(f64::MIN_POSITIVE);
    let share = dot(&along, &v) / squared;
    length(&std::array::from_fn(|c| v[c] - share * along[c]))
}

/// Median depth, in m, by which the facets of a side cut into the surface through their vertices. For a chord of length
/// h between facets that turn by α it is h/2 tan α/4; zero for a plane side, and nearly zero for quadratic facets that
/// follow the surface.
fn depth(mesh: &Mesh, set: &FacetSet) -> f64 {
    let facets = GapFacet::all(mesh, set);
    let mut rims: BTreeMap<[u32; 2], Vec<(usize, Point, f64)>> = BTreeMap::new();
    for (number, facet) in facets.iter().enumerate() {
        for (key, normal, extent) in facet.rims(mesh) {
            rims.entry(key).or_default().push((number, normal, extent));
        }
    }
    let mut depths = vec![0.0f64; facets.len()];
    for shared in rims.values() {
        let [(i, first, of_first), (j, second, of_second)] = shared.as_slice() else { continue };
        let cosine = dot(first, second).min(1.0);
        if cosine < KINK {
            continue;
        }
        // The sine of half the angle is accurate where the cosine is not.
        let half = 0.5 * length(&std::array::from_fn(|c| first[c] - second[c]));
        let depth = 0.25 * (of_first + of_second) * (0.5 * half.min(1.0).asin()).tan();
        for number in [*i, *j] {
            if let Some(own) = depths.get_mut(number) {
                *own = own.max(depth);
            }
        }
    }
    depths.sort_by(f64::total_cmp);
    depths.get(depths.len() / 2).copied().unwrap_or(0.0)
}

/// The mean size of the gap, and its variation beyond the best fit a + b·ν, the gap of shifted bodies.
fn variation(points: &[(&PointOnBoundary, f64)]) -> (f64, f64) {
    let weight: f64 = points.iter().map(|(point, _)| point.weight).sum();
    let mean = points.iter().map(|(point, gap)| point.weight * gap).sum::<f64>() / weight;
    // Gram–Schmidt over the functions 1, ν_x, ν_y, ν_z of the points, omitting linear combinations of others.
    let product = |a: &[f64], b: &[f64]| -> f64 {
        points.iter().zip(a).zip(b).map(|(((point, _), a), b)| point.weight * a * b).sum::<f64>() / weight
    };
    let functions = (0..4).map(|k| -> Vec<f64> {
        points
            .iter()
            .map(|(point, _)| if k == 0 { 1.0 } else { point.normal.get(k - 1).copied().unwrap_or(0.0) })
            .collect()
    });
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for mut function in functions {
        without(&mut function, &basis, &product);
        let size = product(&function, &function).sqrt();
        if size > 1e-6 {
            basis.push(function.into_iter().map(|f| f / size).collect());
        }
    }
    let mut rest: Vec<f64> = points.iter().map(|(_, gap)| *gap).collect();
    without(&mut rest, &basis, &product);
    let [low, high] = rest.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], r| [r.min(l), r.max(h)]);
    (mean.abs(), high - low)
}

/// Removes the part along an orthonormal basis from a function, twice to reduce round-off.
fn without(function: &mut [f64], basis: &[Vec<f64>], product: &dyn Fn(&[f64], &[f64]) -> f64) {
    for b in basis.iter().chain(basis) {
        let along = product(function, b);
        function.iter_mut().zip(b).for_each(|(f, b)| *f -= along * b);
    }
}
