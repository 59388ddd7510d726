//! The deformed mesh over the undeformed one, with the foundation.

use super::axes::{self, LEGEND, Sign};
use super::body::{Body, window};
use super::color::{BLUE, Color, INK, VERMILION};
use super::picture::{Line, Picture, Stroke};
use super::run::{self, Part};
use super::sheet::{self, Frame, Plan, Room};
use super::{Options, Panel, PlotError, ticks, title};

const REFERENCE: Color = Color::new(0xC4_C4_C4);
const MESH: Color = Color::new(0x1B_3A_5C);

/// The factor by which displacements of some magnitude are drawn on a body of some size: the largest of 1, 2, 5, 10, 20 … with
/// which no point moves by more than a fifth of the size, and at least 1.
#[must_use]
pub fn scale_factor(displacement: f64, size: f64) -> f64 {
    let most = 0.2 * size / displacement;
    if !(most.is_finite() && most > 1.0) {
        return 1.0;
    }
    let power = 10f64.powf(most.log10().floor());
    // Where the quotient is 10 but for rounding, the next power is meant.
    [10.0, 5.0, 2.0, 1.0].into_iter().map(|m| (m * power).round()).find(|&f| f <= most * (1.0 + 1e-9)).unwrap_or(1.0)
}

/// A flat foundation: points of its surface at both ends, and the direction in which it lies.
struct Foundation {
    ends: [[f64; 2]; 2],
    inwards: [f64; 2],
}

struct Shape<'a> {
    body: &'a Body,
    moved: Vec<[f64; 2]>,
    foundation: Option<Foundation>,
}

pub(super) fn draw(panels: &[Panel], options: &Options) -> Result<Picture, PlotError> {
    let snapshots = || panels.iter().filter_map(|panel| panel.run.snapshot.as_ref().map(|s| (panel, s)));
    let chosen = snapshots().map(|(_, s)| {
        let [x, y] = s.body.window();
        let most = s.displacement.iter().map(|u| u[0].hypot(u[1])).fold(0.0, f64::max);
        scale_factor(most, (x[1] - x[0]).max(y[1] - y[0]))
    });
    // One factor for all panels, so that they can be compared.
    let factor = options.scale_factor.unwrap_or_else(|| chosen.fold(f64::INFINITY, f64::min));
    let mut shapes = Vec::new();
    for (panel, s) in snapshots() {
        let moved = s.body.points.iter().zip(&s.displacement).map(|(p, u)| [p[0] + factor * u[0], p[1] + factor * u[1]]).collect();
        let parts = run::along(&s.body, &panel.run.contact)?;
        shapes.push(Shape { foundation: foundation(&parts, &s.displacement, factor, &s.body), body: &s.body, moved });
    }
    let windows: Vec<[[f64; 2]; 2]> = shapes.iter().map(view).collect();
    // The same body is drawn to the same scale everywhere.
    let same = shapes.windows(2).all(|s| s[0].body.window() == s[1].body.window());
    let common = [0, 1].map(|d| axes::range(windows.iter().flat_map(|w| w[d])).unwrap_or([0.0, 1.0]));
    let windows = windows.into_iter().map(|own| sheet::widened(if same { common } else { own }, 0.05));
    let plans: Vec<Plan> =
        panels.iter().zip(windows).map(|(panel, window)| Plan { title: panel.title.to_owned(), note: String::new(), window, labels: ["x", "y"] }).collect();
    let times = if (factor - 1.0).abs() < 1e-9 { "displacement to scale".to_owned() } else { format!("displacement × {}", ticks::number(factor)) };
    let title = title(panels, "deformed mesh", options);
    let mut entries = vec![
        (Sign::Line(Stroke::new(REFERENCE, 1.5), None), "undeformed".to_owned()),
        (Sign::Line(Stroke::new(MESH, 1.2), None), format!("deformed, {times}")),
    ];
    if shapes.iter().any(|s| s.foundation.is_some()) {
        entries.push((Sign::Line(Stroke::new(VERMILION, 2.0), None), "foundation".to_owned()));
    }
    let legend_width = axes::line_width(&entries);
    let room = Room { right: 8.0, above: LEGEND + 4.0, below: 0.0, least: legend_width };
    let (mut picture, frames) = sheet::lay_out(&title, &plans, room, options);
    let left = frames.first().map_or(0.0, |f| f.rect.x).min(picture.width - 16.0 - legend_width);
    axes::legend(&mut picture, [left, 16.0 + axes::TITLE + LEGEND], f64::INFINITY, &entries);
    for (shape, frame) in shapes.iter().zip(&frames) {
        draw_shape(&mut picture, frame, shape);
    }
    Ok(picture)
}

/// The window that holds all of a shape.
fn view(shape: &Shape) -> [[f64; 2]; 2] {
    let mut points = shape.moved.clone();
    points.extend(&shape.body.points);
    if let Some(foundation) = &shape.foundation {
        points.extend(foundation.ends);
    }
    window(&points)
}

fn draw_shape(picture: &mut Picture, frame: &Frame, shape: &Shape) {
    let lines = shape.body.lines();
    let dense = lines.len() > 2_000;
    let through =
        |points: &[[f64; 2]]| -> Vec<Vec<[f64; 2]>> { lines.iter().map(|line| simplified(&frame.all(line.iter().map(|&n| &points[n as usize])))).collect() };
    picture.lines(&through(&shape.body.points), Stroke::new(REFERENCE, if dense { 0.4 } else { 0.8 }));
    let outline = loops(&shape.body.boundary);
    let outline = outline.iter().map(|nodes| Line { points: simplified(&frame.all(nodes.iter().map(|&n| &shape.moved[n as usize]))), closed: true });
    let outline: Vec<Line> = outline.collect();
    picture.shape(outline.clone(), Some(BLUE.with_opacity(0.10)), None);
    picture.lines(&through(&shape.moved), Stroke::new(MESH, if dense { 0.4 } else { 0.7 }));
    picture.shape(outline, None, Some(Stroke::new(INK, 1.4)));
    if let Some(foundation) = &shape.foundation {
        draw_foundation(picture, frame, foundation);
    }
}

/// The surface as a line, hatched on the side of the foundation.
fn draw_foundation(picture: &mut Picture, frame: &Frame, foundation: &Foundation) {
    const EACH: f64 = 9.0;
    const LENGTH: f64 = 7.0;
    let [a, b] = foundation.ends.map(|p| frame.at(&p));
    let length = (b[0] - a[0]).hypot(b[1] - a[1]);
    let along = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
    // Downwards is positive in the picture.
    let inwards = [foundation.inwards[0], -foundation.inwards[1]];
    let count = (length / EACH) as usize;
    let hatch = |i: usize| {
        let s = (i as f64 + 1.0) * length / (count as f64 + 1.0);
        let p = [a[0] + s * along[0], a[1] + s * along[1]];
        [p, [p[0] + LENGTH * (inwards[0] - 0.8 * along[0]), p[1] + LENGTH * (inwards[1] - 0.8 * along[1])]]
    };
    let hatches: Vec<_> = (0..count).map(hatch).collect();
    picture.lines(&hatches, Stroke::new(VERMILION, 0.8));
    picture.line(&[a, b], Stroke::new(VERMILION, 2.0));
}

/// The foundation where it is flat: the line of the points x + factor·g ν, with g = u_ν − r.
///
/// The gap is enlarged like the displacement, so that a closed gap looks closed.
fn foundation(parts: &[Part], displacement: &[[f64; 2]], factor: f64, body: &Body) -> Option<Foundation> {
    let stops: Vec<_> = parts.iter().flat_map(|part| &part.stops).collect();
    let first = stops.first()?;
    let normal = first.normal;
    let [wx, wy] = body.window();
    let size = (wx[1] - wx[0]).max(wy[1] - wy[0]);
    let mut places = Vec::new();
    for stop in &stops {
        let u_nu: f64 = stop.on.iter().map(|&(n, share)| share * (displacement[n][0] * stop.normal[0] + displacement[n][1] * stop.normal[1])).sum();
        let gap = factor * (u_nu - stop.row.penetration);
        places.push([stop.row.x[0] + gap * stop.normal[0], stop.row.x[1] + gap * stop.normal[1]]);
    }
    let height = |p: &[f64; 2]| p[0] * normal[0] + p[1] * normal[1];
    let is_flat = places.iter().all(|p| (height(p) - height(&places[0])).abs() < 1e-5 * size)
        && stops.iter().all(|s| s.normal[0] * normal[0] + s.normal[1] * normal[1] > 0.999);
    if !is_flat {
        return None;
    }
    let tangent = first.tangent;
    // The foundation goes on where the body has moved beyond the undeformed Γ_C.
    let moved = stops
        .iter()
        .flat_map(|s| s.on.iter().map(|&(n, _)| [body.points[n][0] + factor * displacement[n][0], body.points[n][1] + factor * displacement[n][1]]));
    let s = |p: &[f64; 2]| p[0] * tangent[0] + p[1] * tangent[1];
    let [lo, hi] = axes::range(places.iter().copied().chain(moved).map(|p| s(&p)))?;
    let room = 0.04 * size;
    let level = height(&places[0]);
    let at = |s: f64| [s * tangent[0] + level * normal[0], s * tangent[1] + level * normal[1]];
    Some(Foundation { ends: [at(lo - room), at(hi + room)], inwards: normal })
}

/// Closed lines of nodes along boundary edges.
fn loops(boundary: &[[u32; 2]]) -> Vec<Vec<u32>> {
    let mut next: std::collections::BTreeMap<u32, Vec<u32>> = std::collections::BTreeMap::new();
    for [a, b] in boundary {
        next.entry(*a).or_default().push(*b);
    }
    let mut loops = Vec::new();
    for [start, _] in boundary {
        let mut line = Vec::new();
        let mut at = *start;
        while let Some(b) = next.get_mut(&at).and_then(Vec::pop) {
            line.push(at);
            at = b;
        }
        if line.len() > 2 {
            loops.push(line);
        }
    }
    loops
}

/// A line without the points that lie within a twentieth of a unit of the line that remains.
fn simplified(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    const NEAR: f64 = 0.05;
    let Some(last) = points.len().checked_sub(1) else { return Vec::new() };
    let mut keep = vec![false; points.len()];
    (keep[0], keep[last]) = (true, true);
    let mut spans = vec![(0, last)];
    while let Some((from, to)) = spans.pop() {
        let (a, b) = (points[from], points[to]);
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let length = dx.hypot(dy);
        let off = |p: &[f64; 2]| {
            let (x, y) = (p[0] - a[0], p[1] - a[1]);
            if length > 0.0 { (dx * y - dy * x).abs() / length } else { x.hypot(y) }
        };
        let farthest = (from + 1..to).map(|i| (i, off(&points[i]))).max_by(|x, y| x.1.total_cmp(&y.1));
        if let Some((i, distance)) = farthest.filter(|f| f.1 > NEAR) {
            debug_assert!(distance.is_finite());
            keep[i] = true;
            spans.extend([(from, i), (i, to)]);
        }
    }
    points.iter().zip(keep).filter_map(|(p, keep)| keep.then_some(*p)).collect()
}
