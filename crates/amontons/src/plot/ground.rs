//! The foundation at the time of a picture: obstacles by their exact surface, others by their gap.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use super::body::PlaneMesh;
use super::run::HistoryColumns;
use crate::contact::{Contact, Obstacle, names};
use crate::element::CellType;
use crate::field::{Field, TimeTable};
use crate::mesh::FacetSet;
use crate::output::columns;
use crate::problem::Problem;
use crate::tensor::{Point, dot, length};

/// Number of grid cells along the longer side of a window in which the surface of an obstacle is searched.
const GRID: usize = 160;
/// Number of bisections of a grid edge: a crossing is found to 1e-12 of its length.
const HALVINGS: usize = 40;

/// The surface of a foundation in the plane.
#[derive(Clone, Debug)]
pub(super) struct Ground {
    /// Lines along the surface, with the foundation on their right.
    pub lines: Vec<Vec<[f64; 2]>>,
    /// A point of the surface and the velocity of the foundation there, m/s, if it moves.
    pub moves: Option<([f64; 2], [f64; 2])>,
}

/// The problem with loaded obstacles at the displacements recorded in the history of its run.
pub(super) fn found(problem: &Arc<Problem>, history: &HistoryColumns) -> Arc<Problem> {
    let is_loaded = |contact: &Contact| contact.obstacle.as_ref().is_some_and(|obstacle| obstacle.load.is_some());
    if !problem.contacts.iter().any(is_loaded) {
        return Arc::clone(problem);
    }
    let sides = names(&problem.contacts);
    let of = |number: usize| {
        let side = if sides.len() > 1 { columns::in_header(sides.get(number)?) } else { String::new() };
        let of_side = |name: &&String| columns::OBSTACLE_DISPLACEMENT.side_of(name) == Some(side.as_str());
        let (times, moved) = (history.get(columns::TIME.name)?, history.get(history.keys().find(of_side)?)?);
        let rows = times.iter().zip(moved).filter(|(t, _)| **t > 0.0).map(|(t, moved)| (*t, *moved));
        let (times, moved) = std::iter::once((0.0, 0.0)).chain(rows).unzip();
        Some(Field::Table(TimeTable::new(times, moved).ok()?.hold()))
    };
    Arc::new(problem.with_found(&of))
}

/// True if displacements and gaps of a body can be enlarged by one factor so that touching points still touch: every
/// contact side is flat with constant gap. At an obstacle, a curved side or a varying gap an enlarged displacement
/// would be false.
pub(super) fn can_be_enlarged(problem: &Problem) -> bool {
    problem.contacts.iter().enumerate().all(|(side, contact)| {
        let of_pair = contact.pair.is_none() || (contact.gap.is_zero() && touches(problem, side));
        of_pair && contact.obstacle.is_none() && !contact.gap.depends_on_space() && {
            let boundary = problem.contact_boundary();
            let mut normals = boundary.points.iter().filter(|point| point.contact == side).map(|point| point.normal);
            normals.next().is_none_or(|first| normals.all(|n| dot(&n, &first) > 1.0 - 1e-9))
        }
    })
}

/// The foundations of a plane body, with displacements and gaps drawn `factor` times as large, and obstacles within a
/// window of the picture.
pub(super) fn grounds(problem: &Problem, body: &PlaneMesh, t: f64, factor: f64, window: [[f64; 2]; 2]) -> Vec<Ground> {
    let of = |contact: &Contact| {
        let set = problem.mesh.facets.get(&contact.on)?;
        let ground = match &contact.obstacle {
            Some(obstacle) => around(problem, contact, obstacle, t, window),
            None => offset(problem, contact, &chains(body, set), body, t, factor),
        };
        (!ground.lines.is_empty()).then_some(ground)
    };
    foundations(problem).filter_map(of).collect()
}

/// The contacts whose foundation is drawn; the other side of a pair is a body.
fn foundations(problem: &Problem) -> impl Iterator<Item = &Contact> {
    problem.contacts.iter().filter(|contact| contact.pair.is_none())
}

/// True if the sides of a pair touch everywhere at rest.
fn touches(problem: &Problem, side: usize) -> bool {
    let mesh = &problem.mesh;
    let extent = |c: usize| super::axes::range(mesh.points.iter().map(|x| x[c])).map_or(0.0, |[low, high]| high - low);
    let size = (0..mesh.dim).map(extent).fold(0.0, f64::max);
    let boundary = problem.contact_boundary();
    boundary.points.iter().filter(|point| point.contact == side).all(|point| point.gap.abs() <= 1e-9 * size)
}

/// Points of the foundation that a picture should show: its surface, or for an obstacle the foot of the nearest point
/// of the side.
pub(super) fn feet(problem: &Problem, body: &PlaneMesh, moved: &[[f64; 2]], t: f64, factor: f64) -> Vec<[f64; 2]> {
    let mut all = Vec::new();
    for contact in foundations(problem) {
        let Some(set) = problem.mesh.facets.get(&contact.on) else { continue };
        let Some(obstacle) = &contact.obstacle else {
            all.extend(offset(problem, contact, &chains(body, set), body, t, factor).lines.into_iter().flatten());
            continue;
        };
        let nodes = set.node_list().into_iter().filter_map(|n| moved.get(n as usize));
        let near = nodes
            .map(|p| (p, obstacle.nearest(&[p[0], p[1], 0.0], t)))
            .min_by(|a, b| a.1.distance.total_cmp(&b.1.distance));
        all.extend(
            near.map(|(p, at)| [0, 1].map(|d| p[d] - at.distance * at.normal[d]))
                .filter(|p| p.iter().all(|x| x.is_finite())),
        );
    }
    all
}

/// Velocity of the foundation of a contact at a point: the sum of v_F and the velocity of its obstacle, or of its
/// surface along its normal.
fn velocity(problem: &Problem, contact: &Contact, x: &Point, normal: Option<Point>, t: f64) -> Point {
    let h = 1e-6 * problem.timeline.end();
    let [from, to] = [(t - h).max(0.0), (t + h).min(problem.timeline.end())];
    let mut v: Point =
        std::array::from_fn(|c| contact.foundation_velocity.get(c).map_or(0.0, |field| field.value(x, t)));
    let along_normal = |rate: f64, n: &Point| -> Point { n.map(|c| c * rate) };
    let more = match &contact.obstacle {
        Some(obstacle) => {
            let at = obstacle.nearest(x, t);
            let moves = obstacle.motion(t, &|of| (of(to) - of(from)) / (to - from)).at(x);
            if length(&moves) > 0.0 {
                moves
            } else {
                // The distance decreases if the surface approaches.
                along_normal(
                    (obstacle.nearest(x, from).distance - obstacle.nearest(x, to).distance) / (to - from),
                    &at.normal,
                )
            }
        }
        // The gap is measured along the normal of the body.
        None => normal.map_or([0.0; 3], |n| {
            along_normal((contact.gap.value(x, to) - contact.gap.value(x, from)) / (to - from), &n)
        }),
    };
    v.iter_mut().zip(more).for_each(|(v, more)| *v += more);
    v
}

fn moving(at: [f64; 2], v: Point) -> Option<([f64; 2], [f64; 2])> {
    (length(&v) > 0.0 && v.iter().all(|c| c.is_finite())).then_some((at, [v[0], v[1]]))
}

/// Chains of boundary nodes of a body that belong to a facet set, with the body on their left.
fn chains(body: &PlaneMesh, set: &FacetSet) -> Vec<Vec<u32>> {
    let nodes: HashSet<[u32; 2]> = set.facets().flat_map(|(_, facet)| pairs(facet)).collect();
    let edges: Vec<[u32; 2]> =
        body.boundary.iter().copied().filter(|[a, b]| nodes.contains(&[*a.min(b), *a.max(b)])).collect();
    chained(&edges)
}

/// The pieces of a segment, whose middle node is last, each with its ends in ascending order.
fn pairs(facet: &[u32]) -> Vec<[u32; 2]> {
    let pair = |a: u32, b: u32| [a.min(b), a.max(b)];
    match *facet {
        [a, b] => vec![pair(a, b)],
        [a, b, m] => vec![pair(a, m), pair(m, b)],
        _ => Vec::new(),
    }
}

/// Edges joined end to end, open chains before closed ones.
fn chained(edges: &[[u32; 2]]) -> Vec<Vec<u32>> {
    let mut next: HashMap<u32, u32> = edges.iter().map(|&[a, b]| (a, b)).collect();
    let entered: HashSet<u32> = edges.iter().map(|e| e[1]).collect();
    let mut starts: Vec<u32> = edges.iter().map(|e| e[0]).collect();
    starts.sort_unstable_by_key(|n| (entered.contains(n), *n));
    let mut all = Vec::new();
    for start in starts {
        let (mut chain, mut at) = (vec![start], start);
        while let Some(b) = next.remove(&at) {
            chain.push(b);
            at = b;
        }
        if chain.len() > 1 {
            all.push(chain);
        }
    }
    all
}

/// The foundation at the gap g from a side: the points x + factor·g ν, and a little beyond the ends of a flat side.
fn offset(problem: &Problem, contact: &Contact, chains: &[Vec<u32>], body: &PlaneMesh, t: f64, factor: f64) -> Ground {
    let mut ground = Ground { lines: Vec::new(), moves: None };
    for chain in chains {
        let p = |i: usize| body.points[chain[i] as usize];
        let last = chain.len() - 1;
        let normal = |i: usize| {
            let (a, b) = (p(i.saturating_sub(1)), p((i + 1).min(last)));
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            let size = dx.hypot(dy);
            [dy / size, -dx / size]
        };
        let at = |i: usize| -> [f64; 2] {
            let (x, n) = (p(i), normal(i));
            let gap = factor * contact.gap.value(&[x[0], x[1], 0.0], t);
            [x[0] + gap * n[0], x[1] + gap * n[1]]
        };
        let mut line: Vec<[f64; 2]> = (0..=last).map(at).collect();
        let is_flat = (1..last).all(|i| (normal(i)[0] * normal(0)[0] + normal(i)[1] * normal(0)[1]) > 1.0 - 1e-9);
        if is_flat {
            let (a, b) = (line[0], line[last]);
            let beyond = |from: [f64; 2], to: [f64; 2]| [0, 1].map(|d| to[d] + 0.06 * (to[d] - from[d]));
            line.insert(0, beyond(b, a));
            line.push(beyond(a, b));
        }
        let (x, n) = (p(last), normal(last));
        let v = velocity(problem, contact, &[x[0], x[1], 0.0], Some([n[0], n[1], 0.0]), t);
        ground.moves = ground.moves.or(moving(at(last), v));
        ground.lines.push(line);
    }
    ground
}

/// The surface of an obstacle within a window, moved outwards by minus the gap, which is added to its distance.
fn around(problem: &Problem, contact: &Contact, obstacle: &Obstacle, t: f64, window: [[f64; 2]; 2]) -> Ground {
    let level = |p: [f64; 2]| {
        let x = [p[0], p[1], 0.0];
        obstacle.nearest(&x, t).distance + contact.gap.value(&x, t)
    };
    let lines = contour(&level, window);
    // The velocity is shown at the right, where it hides little, but not at the border.
    let within = |p: &[f64; 2], d: usize| {
        (p[d] - 0.5 * (window[d][0] + window[d][1])).abs() < 0.44 * (window[d][1] - window[d][0])
    };
    let rightmost = |a: &&[f64; 2], b: &&[f64; 2]| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]));
    let farthest =
        |directions: usize| lines.iter().flatten().filter(|p| (0..directions).all(|d| within(p, d))).max_by(rightmost);
    let farthest = farthest(2).or_else(|| farthest(1)).or_else(|| farthest(0));
    let moves = farthest.and_then(|&p| moving(p, velocity(problem, contact, &[p[0], p[1], 0.0], None, t)));
    Ground { lines, moves }
}

/// An edge of a grid by its ends, the lower one first.
type GridEdge = ((usize, usize), (usize, usize));

/// Lines on which a level is zero, with its negative side on their right; a level that is NaN counts as positive.
fn contour(level: &dyn Fn([f64; 2]) -> f64, [wx, wy]: [[f64; 2]; 2]) -> Vec<Vec<[f64; 2]>> {
    let (width, height) = (wx[1] - wx[0], wy[1] - wy[0]);
    let size = width.max(height) / GRID as f64;
    let (nx, ny) = ((width / size).ceil() as usize, (height / size).ceil() as usize);
    if nx == 0 || ny == 0 {
        return Vec::new();
    }
    let corner = |i: usize, j: usize| [wx[0] + width * i as f64 / nx as f64, wy[0] + height * j as f64 / ny as f64];
    let is_in: Vec<bool> =
        (0..=ny).flat_map(|j| (0..=nx).map(move |i| (i, j))).map(|(i, j)| level(corner(i, j)) < 0.0).collect();
    let inside = |i: usize, j: usize| is_in[j * (nx + 1) + i];
    let crossing = |a: (usize, usize), b: (usize, usize)| {
        let (mut lo, mut hi) = (corner(a.0, a.1), corner(b.0, b.1));
        let start = inside(a.0, a.1);
        for _ in 0..HALVINGS {
            let middle = [0.5 * (lo[0] + hi[0]), 0.5 * (lo[1] + hi[1])];
            if (level(middle) < 0.0) == start { lo = middle } else { hi = middle }
        }
        [0.5 * (lo[0] + hi[0]), 0.5 * (lo[1] + hi[1])]
    };
    // Grid edges by their lower end and direction. A segment starts where a turn around its cell enters the obstacle,
    // and ends where it leaves it.
    let key = |a: (usize, usize), b: (usize, usize)| -> GridEdge { if a < b { (a, b) } else { (b, a) } };
    let mut next: HashMap<GridEdge, GridEdge> = HashMap::new();
    let mut order = Vec::new();
    for j in 0..ny {
        for i in 0..nx {
            let around = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
            let turn: Vec<(GridEdge, bool)> = (0..4)
                .map(|k| (around[k], around[(k + 1) % 4]))
                .filter(|(a, b)| inside(a.0, a.1) != inside(b.0, b.1))
                .map(|(a, b)| (key(a, b), inside(b.0, b.1)))
                .collect();
            for (k, (from, enters)) in turn.iter().enumerate() {
                if *enters {
                    next.insert(*from, turn[(k + 1) % turn.len()].0);
                    order.push(*from);
                }
            }
        }
    }
    let entered: HashSet<GridEdge> = next.values().copied().collect();
    order.sort_by_key(|edge| entered.contains(edge));
    let mut lines = Vec::new();
    for start in order {
        let (mut line, mut at) = (vec![crossing(start.0, start.1)], start);
        while let Some(edge) = next.remove(&at) {
            line.push(crossing(edge.0, edge.1));
            at = edge;
        }
        if line.len() > 1 {
            lines.push(line);
        }
    }
    lines
}

/// Part of the foundation below a side of a body in space: triangles of surface points, somewhat larger than the side.
pub(super) struct GroundPatch {
    pub points: Vec<[f64; 3]>,
    pub triangles: Vec<[u32; 3]>,
    /// Mean normal of the body there, pointing into the foundation.
    pub normal: [f64; 3],
}

/// The foundation below the contact sides of a body in space whose displacements are drawn `factor` times as large.
pub(super) fn patches(problem: &Problem, displacement: &[[f64; 3]], t: f64, factor: f64) -> Vec<GroundPatch> {
    /// Distance by which a patch extends beyond its side, relative to the size of the side.
    const BEYOND: f64 = 0.05;
    let mut all = Vec::new();
    for contact in foundations(problem) {
        let Some(set) = problem.mesh.facets.get(&contact.on) else { continue };
        let nodes = set.node_list();
        let number: HashMap<u32, u32> = nodes.iter().enumerate().map(|(i, &n)| (n, i as u32)).collect();
        let x: Vec<Point> = nodes.iter().map(|&n| problem.mesh.points[n as usize]).collect();
        let mut normals = vec![[0.0; 3]; nodes.len()];
        let mut triangles = Vec::new();
        for (_, facet) in set.facets() {
            let Some(drawing) = CellType::drawing(facet.len()) else { continue };
            for part in drawing.triangles {
                let triangle = part.map(|i| number[&facet[i]]);
                let across = super::surface::across(triangle.map(|n| x[n as usize]));
                for n in triangle {
                    normals[n as usize] = [0, 1, 2].map(|d| normals[n as usize][d] + across[d]);
                }
                triangles.push(triangle);
            }
        }
        let sum = normals.iter().fold([0.0; 3], |sum, n| [0, 1, 2].map(|d| sum[d] + n[d]));
        let extent = |d: usize| super::axes::range(x.iter().map(|p| p[d])).map_or(0.0, |[lo, hi]| hi - lo);
        let beyond = BEYOND * (0..3).map(extent).fold(0.0, f64::max);
        // Outward direction within the surface, along its rim.
        let mut outwards = vec![[0.0; 3]; nodes.len()];
        for [a, b] in rim(&triangles) {
            let [p, q] = [a, b].map(|n| x[n as usize]);
            let edge: Point = [0, 1, 2].map(|d| q[d] - p[d]);
            let n = normals[a as usize];
            let out = super::surface::across([[0.0; 3], edge, n]);
            let size = length(&out);
            for n in [a, b] {
                outwards[n as usize] = [0, 1, 2].map(|d| outwards[n as usize][d] + out[d] / size);
            }
        }
        let place = |i: usize| {
            let n = normals[i].map(|c| c / length(&normals[i]));
            let u = displacement.get(nodes[i] as usize).copied().unwrap_or_default();
            let size = length(&outwards[i]);
            // The sum of the normals of two edges, scaled so that a corner stays a corner.
            let share = if size > 0.0 { 2.0 * beyond / (size * size).max(0.5) } else { 0.0 };
            let wide: Point = [0, 1, 2].map(|d| x[i][d] + share * outwards[i][d]);
            match &contact.obstacle {
                Some(obstacle) => {
                    let at: Point = [0, 1, 2].map(|d| wide[d] + factor * u[d]);
                    let foot = obstacle.nearest(&at, t);
                    let distance = foot.distance + contact.gap.value(&x[i], t);
                    [0, 1, 2].map(|d| at[d] - distance * foot.normal[d])
                }
                None => [0, 1, 2].map(|d| wide[d] + factor * contact.gap.value(&x[i], t) * n[d]),
            }
        };
        let points: Vec<[f64; 3]> = (0..nodes.len()).map(place).collect();
        if points.iter().flatten().all(|c| c.is_finite()) {
            let (points, triangles) = hull(&points, sum).unwrap_or((points, triangles));
            all.push(GroundPatch { points, triangles, normal: sum });
        }
    }
    all
}

/// The convex hull of coplanar points with a normal, so that slots, holes and arcs of a side do not appear in a flat
/// foundation, or `None` if the points are not coplanar.
fn hull(points: &[[f64; 3]], normal: [f64; 3]) -> Option<(Vec<[f64; 3]>, Vec<[u32; 3]>)> {
    /// Tolerance of the distance from the plane, relative to the size of the points.
    const FLAT: f64 = 1e-6;
    let (first, rest) = points.split_first()?;
    let from_first = |p: &[f64; 3]| -> Point { [0, 1, 2].map(|d| p[d] - first[d]) };
    let away: Vec<Point> = rest.iter().map(from_first).collect();
    let longest = away.iter().copied().max_by(|a, b| length(a).total_cmp(&length(b)))?;
    let widest = away
        .iter()
        .map(|a| super::surface::across([[0.0; 3], longest, *a]))
        .max_by(|a, b| length(a).total_cmp(&length(b)))?;
    let size = length(&longest);
    let sign = if dot(&widest, &normal) < 0.0 { -1.0 } else { 1.0 };
    let n: Point = widest.map(|c| sign * c / length(&widest));
    if !away.iter().all(|a| dot(a, &n).abs() <= FLAT * size) {
        return None;
    }
    // Axes of the plane, the normal towards the eye.
    let e: Point = longest.map(|c| c / size);
    let f = super::surface::across([[0.0; 3], n, e]);
    let mut flat: Vec<([f64; 2], [f64; 3])> =
        points.iter().map(|p| ([dot(&from_first(p), &e), dot(&from_first(p), &f)], *p)).collect();
    flat.sort_by(|(a, _), (b, _)| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let half = |sorted: &mut dyn Iterator<Item = &([f64; 2], [f64; 3])>| {
        let mut chain: Vec<([f64; 2], [f64; 3])> = Vec::new();
        for point in sorted {
            while let [.., (a, _), (b, _)] = chain[..] {
                let turn = (b[0] - a[0]) * (point.0[1] - a[1]) - (b[1] - a[1]) * (point.0[0] - a[0]);
                if turn > 1e-12 * size * size {
                    break;
                }
                chain.pop();
            }
            chain.push(*point);
        }
        chain.pop();
        chain
    };
    let (lower, upper) = (half(&mut flat.iter()), half(&mut flat.iter().rev()));
    let around: Vec<[f64; 3]> = lower.into_iter().chain(upper).map(|(_, p)| p).collect();
    let triangles = (2..around.len() as u32).map(|i| [0, i - 1, i]).collect();
    (around.len() > 2).then_some((around, triangles))
}

/// Edges that belong to one triangle only.
pub(super) fn rim(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let edges = || triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let all: HashSet<[u32; 2]> = edges().collect();
    edges().filter(|[a, b]| !all.contains(&[*b, *a])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const WINDOW: [[f64; 2]; 2] = [[-2.0, 2.0], [-1.5, 1.5]];

    /// A circle of radius 1: one closed line of length 2π around the disc, with the disc on its right.
    #[test]
    fn a_contour_follows_its_level() {
        let lines = contour(&|p| p[0].hypot(p[1]) - 1.0, WINDOW);
        assert_eq!(lines.len(), 1);
        let line = &lines[0];
        assert!(line.iter().all(|p| (p[0].hypot(p[1]) - 1.0).abs() < 1e-12));
        let area: f64 = line.windows(2).map(|e| 0.5 * (e[0][0] * e[1][1] - e[1][0] * e[0][1])).sum();
        assert!((area + std::f64::consts::PI).abs() < 1e-3, "signed area {area}: it turns clockwise");
        assert_eq!(line.first(), line.last());
        // The exterior of the circle is the obstacle of a bore.
        let area: f64 = contour(&|p| 1.0 - p[0].hypot(p[1]), WINDOW)[0]
            .windows(2)
            .map(|e| 0.5 * (e[0][0] * e[1][1] - e[1][0] * e[0][1]))
            .sum();
        assert!(area > 0.0);
    }

    #[test]
    fn a_contour_may_leave_the_window_and_have_parts() {
        let lines = contour(&|p| (0.7 - p[1]).min(p[1] + 0.3), WINDOW);
        assert_eq!(lines.len(), 2);
        for line in &lines {
            let level = line[0][1];
            assert!((level - 0.7).abs() < 1e-12 || (level + 0.3).abs() < 1e-12);
            assert!(line.iter().all(|p| (p[1] - level).abs() < 1e-12));
            assert!(((line[line.len() - 1][0] - line[0][0]).abs() - 4.0).abs() < 1e-12);
        }
        assert!(contour(&|_| f64::NAN, WINDOW).is_empty());
    }

    /// The hull of a square with a notch and a point inside is the square; its triangles face the normal.
    #[test]
    fn a_flat_patch_has_no_notches() -> Result<(), Box<dyn std::error::Error>> {
        // On the plane x + z = 1, coordinates s along (1, 0, −1)/√2 and y.
        let at = |s: f64, y: f64| [0.5 + s / 2f64.sqrt(), y, 0.5 - s / 2f64.sqrt()];
        let points = [at(0.0, 0.0), at(1.0, 0.0), at(0.5, 0.5), at(1.0, 1.0), at(0.0, 1.0), at(0.2, 0.4)];
        for sign in [1.0, -1.0] {
            let normal = [sign, 0.0, sign];
            let (around, triangles) = hull(&points, normal).ok_or("the points are in a plane")?;
            assert_eq!(around.len(), 4);
            let across = triangles.iter().map(|t| super::super::surface::across(t.map(|n| around[n as usize])));
            let area = across.fold(0.0, |sum, a| sum + 0.5 * dot(&a, &normal) / 2f64.sqrt());
            assert!((area - 1.0).abs() < 1e-12, "area {area} towards the normal");
        }
        let mut bent = points;
        bent[5][2] += 0.01;
        assert!(hull(&bent, [1.0, 0.0, 1.0]).is_none());
        Ok(())
    }

    /// A foundation in space is drawn at its position: on a moving ball, and on a plane with a growing gap, which is
    /// enlarged like the displacement.
    #[test]
    fn patches_follow_moving_foundations() -> Result<(), Box<dyn std::error::Error>> {
        let text = |contact: &str| {
            format!(
                "name = \"block\"\n[mesh]\nkind = \"box\"\nsize = [1.0, 1.0, 0.5]\nn = 2\n[time]\nend = 1.0\nsteps = 1\n[material]\ndensity = 1.0\n\
                 elasticity = {{ law = \"isotropic\", young = 1.0, poisson = 0.3 }}\n[contact]\non = \"front\"\n\
                 normal = {{ law = \"compliance\", stiffness = 1.0 }}\n{contact}"
            )
        };
        let parse = |contact: &str| crate::case::parse(&crate::case::Source::new("block.toml", text(contact)), &[]);
        let ball =
            parse("obstacle = { shape = \"sphere\", center = [0.4, 0.5, \"3 - 0.5*t\"], radius = 2.0 }")?.problem;
        let gap = parse("gap = \"0.1 + 0.2*t\"")?.problem;
        let rest = vec![[0.0; 3]; ball.mesh.points.len()];
        for t in [0.0, 0.6, 1.0] {
            let [patch] = &patches(&ball, &rest, t, 1.0)[..] else { return Err("one patch".into()) };
            for p in &patch.points {
                let away = [p[0] - 0.4, p[1] - 0.5, p[2] - (3.0 - 0.5 * t)];
                assert!((length(&away) - 2.0).abs() < 1e-12, "t = {t}: {p:?} is not on the ball");
            }
            let [patch] = &patches(&gap, &rest, t, 3.0)[..] else { return Err("one patch".into()) };
            assert!(
                patch.points.iter().all(|p| (p[2] - 0.5 - 3.0 * (0.1 + 0.2 * t)).abs() < 1e-12),
                "t = {t}: {:?}",
                patch.points
            );
            // Margins on all four sides of a side with edges of length 1.
            let reach = |d: usize| super::super::axes::range(patch.points.iter().map(|p| p[d]));
            for d in 0..2 {
                assert!(
                    reach(d).is_some_and(|[low, high]| low < -0.01 && low > -0.2 && high > 1.01 && high < 1.2),
                    "{:?}",
                    reach(d)
                );
            }
        }
        Ok(())
    }

    #[test]
    fn edges_are_joined() {
        assert_eq!(chained(&[[3, 4], [1, 2], [2, 3]]), [vec![1, 2, 3, 4]]);
        assert_eq!(chained(&[[1, 2], [2, 1]]), [vec![1, 2, 1]]);
        assert_eq!(chained(&[[5, 6], [1, 2]]).len(), 2);
    }
}
