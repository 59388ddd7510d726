//! A plane body coloured by a field, with its foundation and its undeformed outline.

use super::axes::{self, LEGEND, Sign};
use super::body::{PlaneMesh, window};
use super::color::{Color, INK, VERMILION, WHITE};
use super::field::{ColorBar, DrawnField, DrawnQuantity, FieldScales};
use super::font::{self, HALF, NUMBER, TITLE, typeset};
use super::ground::{self, Ground};
use super::names;
use super::picture::{Anchor, OutlinePiece, Picture, Rect, Stroke};
use super::run::{DrawnRun, PlaneSnapshot};
use super::shade;
use super::sheet::{self, Margins, PanelPlan, SheetPanel};
use super::zoom::{self, Zone, clipped};
use super::{Options, PictureKind, RunPanel, title};
use crate::mesh::Mesh;
use crate::units::{Extent, Measure, Units};

const REFERENCE: Color = Color::new(0x9A_9A_9A);
const MESH: Color = Color::new(0x22_22_22);

/// The factor by which displacements of this magnitude are drawn on a body of this size: the largest of 1, 2, 5, 10, 20
/// … for which no point moves by more than a fifth of the size, and at least 1.
#[must_use]
pub fn scale_factor(displacement: f64, size: f64) -> f64 {
    let most = 0.2 * size / displacement;
    if !(most.is_finite() && most > 1.0) {
        return 1.0;
    }
    let power = 10f64.powf(most.log10().floor());
    // A quotient of 10 up to rounding belongs to the next power.
    [10.0, 5.0, 2.0, 1.0].into_iter().map(|m| (m * power).round()).find(|&f| f <= most * (1.0 + 1e-9)).unwrap_or(1.0)
}

/// The factor of the displacement in the picture `deformed`, common to all panels: that of the options, 1 if an
/// enlargement would be false, else a round number. Other pictures show the true displacement.
pub(super) fn factor(
    kind: PictureKind,
    runs: &[&DrawnRun],
    sizes: impl Iterator<Item = (f64, f64)>,
    options: &Options,
) -> f64 {
    if kind != PictureKind::Deformed {
        return 1.0;
    }
    if let Some(factor) = options.scale_factor {
        return factor;
    }
    let mut factor = sizes.map(|(u, size)| scale_factor(u, size)).fold(f64::INFINITY, f64::min);
    for run in runs {
        let Some(problem) = &run.problem else { continue };
        if !ground::can_be_enlarged(problem) {
            return 1.0;
        }
        // A thin body must not be inverted: even 1.5 times the factor must keep the orientation of every cell.
        while factor > 1.0 && !keeps_orientation(run, &problem.mesh, 1.5 * factor) {
            factor = below(factor);
        }
    }
    factor
}

/// The next smaller of 1, 2, 5, 10, 20 …
fn below(factor: f64) -> f64 {
    let power = 10f64.powf((factor.log10() + 1e-9).floor());
    let leading = (factor / power).round();
    (if leading > 4.0 {
        2.0 * power
    } else if leading > 1.0 {
        power
    } else {
        0.5 * power
    })
    .max(1.0)
}

/// True if the displacement times this factor inverts no cell.
fn keeps_orientation(run: &DrawnRun, mesh: &Mesh, factor: f64) -> bool {
    let mut moved = mesh.clone();
    let plane = run.snapshot.iter().flat_map(|s| s.displacement.iter().map(|u| [u[0], u[1], 0.0]));
    let space = run.solid.iter().flat_map(|s| s.displacement.iter().copied());
    for (p, u) in moved.points.iter_mut().zip(plane.chain(space)) {
        *p = [0, 1, 2].map(|d| p[d] + factor * u[d]);
    }
    moved.check().is_ok()
}

/// Text of a factor: `displacement × 50`.
pub(super) fn times(factor: f64) -> String {
    if (factor - 1.0).abs() < 1e-9 {
        "displacement to scale".to_owned()
    } else {
        format!("displacement × {}", super::ticks::number(factor))
    }
}

/// A body as drawn.
struct DrawnBody<'a> {
    run: &'a DrawnRun,
    snapshot: &'a PlaneSnapshot,
    /// The body with its nodes displaced.
    moved: PlaneMesh,
    /// The field at the corners of its triangles.
    values: Vec<[f64; 3]>,
    grounds: Vec<Ground>,
}

impl DrawnBody<'_> {
    fn of<'a>(kind: PictureKind, run: &'a DrawnRun, snapshot: &'a PlaneSnapshot, factor: f64) -> DrawnBody<'a> {
        let body = &snapshot.body;
        let points =
            body.points.iter().zip(&snapshot.displacement).map(|(p, u)| [p[0] + factor * u[0], p[1] + factor * u[1]]);
        let moved = body.moved(points.collect());
        let values = snapshot.corners(kind);
        DrawnBody { run, snapshot, moved, values, grounds: Vec::new() }
    }

    /// True if the undeformed body differs visibly from the deformed one: a point moves by more than 0.3 per cent of
    /// the size.
    fn shows_reference(&self) -> bool {
        let [x, y] = self.snapshot.body.window();
        let size = (x[1] - x[0]).max(y[1] - y[0]);
        self.moved
            .points
            .iter()
            .zip(&self.snapshot.body.points)
            .any(|(p, q)| (p[0] - q[0]).hypot(p[1] - q[1]) > 3e-3 * size)
    }

    /// The window that holds the deformed and the undeformed body and the foundation near to it.
    fn window(&self, factor: f64) -> [[f64; 2]; 2] {
        let mut points = self.moved.points.clone();
        if self.shows_reference() {
            points.extend(&self.snapshot.body.points);
        }
        if let Some(problem) = &self.run.problem {
            points.extend(ground::feet(problem, &self.snapshot.body, &self.moved.points, self.run.t, factor));
        }
        window(&points)
    }
}

pub(super) fn draw(kind: PictureKind, panels: &[RunPanel], options: &Options) -> Picture {
    let units = super::units(panels, options);
    let stage = PlaneScene::new(kind, panels, options, kind);
    let zone = stage.zone();
    let part = |i: usize| zone.as_ref().and_then(|zone| stage.enlarged(i, zone));
    let whole = |i: usize| BodyPanel { body: i, window: stage.windows[i], times: None, title: String::new() };
    let all: Vec<BodyPanel> = (0..stage.bodies.len()).flat_map(|i| std::iter::once(whole(i)).chain(part(i))).collect();
    stage.picture(&all, &title(panels, stage.quantity.name, options), units, 0.0)
}

/// One picture per run, all with the same scales of colours, displacements and lengths and the same frame.
pub(super) fn frames(kind: PictureKind, panels: &[RunPanel], options: &Options) -> Vec<Picture> {
    let units = super::units(panels, options);
    let mut stage =
        PlaneScene::new(kind, panels, &Options { shared_scale: true, ..options.clone() }, PictureKind::Deformed);
    // Only the title differs between frames, so that nothing else moves.
    stage.scales.share_extremes();
    let titles: Vec<String> =
        panels.iter().map(|panel| title(std::slice::from_ref(panel), stage.quantity.name, options)).collect();
    let widest = titles.iter().map(|title| font::width(title, TITLE)).fold(0.0, f64::max) + 32.0;
    let numbered = titles.iter().enumerate();
    let whole = |i: usize| BodyPanel { body: i, window: stage.windows[i], times: None, title: String::new() };
    numbered.map(|(i, title)| stage.picture(&[whole(i)], title, units, widest)).collect()
}

/// A panel: a body, or an enlargement of it.
struct BodyPanel {
    body: usize,
    window: [[f64; 2]; 2],
    /// Enlargement relative to the whole body, or `None` for the body itself.
    times: Option<f64>,
    /// Title of an enlargement.
    title: String,
}

/// Bodies as drawn, with the data common to all of them.
struct PlaneScene<'a> {
    kind: PictureKind,
    quantity: DrawnQuantity,
    bodies: Vec<&'a RunPanel<'a>>,
    shapes: Vec<DrawnBody<'a>>,
    scales: FieldScales,
    windows: Vec<[[f64; 2]; 2]>,
    factor: f64,
}

impl<'a> PlaneScene<'a> {
    /// The bodies of runs, with displacements enlarged as in pictures of the kind `enlarged`.
    fn new(kind: PictureKind, panels: &'a [RunPanel<'a>], options: &Options, enlarged: PictureKind) -> PlaneScene<'a> {
        let with: Vec<(&RunPanel, &PlaneSnapshot)> =
            panels.iter().filter_map(|panel| Some((panel, panel.run.snapshot.as_ref()?))).collect();
        let runs: Vec<&DrawnRun> = with.iter().map(|(panel, _)| panel.run).collect();
        let sizes = with.iter().map(|(_, s)| {
            let [x, y] = s.body.window();
            (s.displacement.iter().map(|u| u[0].hypot(u[1])).fold(0.0, f64::max), (x[1] - x[0]).max(y[1] - y[0]))
        });
        let factor = factor(enlarged, &runs, sizes, options);
        let mut shapes: Vec<DrawnBody> =
            with.iter().map(|(panel, s)| DrawnBody::of(kind, panel.run, s, factor)).collect();
        let fields = shapes.iter().map(|s| DrawnField {
            values: &s.values,
            areas: s.moved.areas(),
            cells: &s.snapshot.von_mises,
            nodal: &s.snapshot.nodal_von_mises,
        });
        let scales = FieldScales::new(kind, &fields.collect::<Vec<_>>(), options.shared_scale);
        let windows = windows(&shapes, factor);
        for (shape, window) in shapes.iter_mut().zip(&windows) {
            if let Some(problem) = &shape.run.problem {
                shape.grounds = ground::grounds(problem, &shape.snapshot.body, shape.run.t, factor, *window);
            }
        }
        let bodies = with.iter().map(|(panel, _)| *panel).collect();
        PlaneScene { kind, quantity: DrawnQuantity::of(kind), bodies, shapes, scales, windows, factor }
    }

    /// The contact that is enlarged.
    fn zone(&self) -> Option<Zone> {
        let runs: Vec<&DrawnRun> = self.shapes.iter().map(|shape| shape.run).collect();
        let flat = |body: &PlaneMesh| body.points.iter().map(|p| [p[0], p[1], 0.0]).collect::<Vec<_>>();
        let nodes: Vec<_> = self.shapes.iter().map(|shape| flat(&shape.snapshot.body)).collect();
        let moved: Vec<_> = self.shapes.iter().map(|shape| flat(&shape.moved)).collect();
        zoom::zone(&runs, &nodes, &moved)
    }

    /// The part of a body around a contact, the same at all times of a run, or `None` if the contact is not small.
    fn enlarged(&self, body: usize, zone: &Zone) -> Option<BodyPanel> {
        let points: Vec<[f64; 2]> = zone.points.iter().map(|p| [p[0], p[1]]).collect();
        let (window, times) = zoom::window(&points, self.windows[body])?;
        let RunPanel { title, run } = self.bodies[body];
        let apart = if title.is_empty() { "" } else { ", " };
        let title = format!("{title}{apart}contact{}, enlarged × {}", run.side(zone.side), super::ticks::number(times));
        Some(BodyPanel { body, window, times: Some(times), title })
    }

    /// A picture with some of the bodies and their parts, at least `least` wide.
    fn picture(&self, which: &[BodyPanel], title: &str, units: Units, least: f64) -> Picture {
        let labels = if units.extent == Extent::Revolution { ["r", "z"] } else { ["x", "y"] };
        let plan = |part: &BodyPanel| {
            let i = part.body;
            let whole = || self.scales.extremes(i, units);
            PanelPlan {
                title: if part.times.is_some() { part.title.clone() } else { self.bodies[i].title.to_owned() },
                note: if part.times.is_some() { "enlargement of the framed part".to_owned() } else { whole() },
                window: part.window,
                labels,
                mirrored: false,
            }
        };
        let plans: Vec<PanelPlan> = which.iter().map(plan).collect();
        let wide = sheet::is_wide(&plans);
        let bars: Vec<ColorBar> = which.iter().map(|part| self.scales.bar(part.body, units, wide)).collect();
        let entries = legend(&self.shapes, self.factor, self.kind);
        let legend_width = axes::line_width(&entries);
        let above = if entries.is_empty() { 0.0 } else { LEGEND + 4.0 };
        let least = legend_width.max(least);
        let in_twos = which.iter().filter(|part| part.times.is_some()).count() * 2 == which.len();
        let room = if wide {
            Margins { right: 8.0, below: 50.0, above, least, in_twos }
        } else {
            Margins { right: bars.iter().map(ColorBar::room).fold(0.0, f64::max), above, below: 0.0, least, in_twos }
        };
        let (mut picture, frames) = sheet::lay_out(title, &plans, room, units);
        let left = 0.5 * (picture.width - legend_width);
        axes::legend(&mut picture, [left, 16.0 + TITLE + LEGEND - 2.0], f64::INFINITY, &entries);
        for (k, ((part, bar), frame)) in which.iter().zip(&bars).zip(&frames).enumerate() {
            if part.times.is_some() {
                self.enlargement(&mut picture, frame, part, bar, units);
                continue;
            }
            self.body(&mut picture, frame, part.body, bar, units);
            if let Some(next) = which.get(k + 1).filter(|next| next.times.is_some()) {
                let [x, y] = next.window;
                let line = [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]], [x[0], y[0]]];
                picture.line(&frame.all(&line), Stroke::new(INK, 0.8));
            }
        }
        picture
    }

    /// Draws a part of a body with everything within its frame.
    fn enlargement(&self, picture: &mut Picture, frame: &SheetPanel, part: &BodyPanel, bar: &ColorBar, units: Units) {
        let shape = &self.shapes[part.body];
        bar.draw(picture, frame.rect);
        shade::draw(picture, frame, &shape.moved, &shape.values, bar, part.window);
        lines(picture, frame, shape, self.kind, bar);
        let Some(problem) = &shape.run.problem else { return };
        let grounds = ground::grounds(problem, &shape.snapshot.body, shape.run.t, self.factor, part.window);
        for ground in grounds {
            // The velocity of the foundation is shown in the picture of the whole body.
            foundation(picture, frame, &Ground { moves: None, ..ground }, units);
        }
    }

    /// Draws a body in its frame, with its colour bar, the axis of revolution and the foundation.
    fn body(&self, picture: &mut Picture, frame: &SheetPanel, body: usize, bar: &ColorBar, units: Units) {
        let shape = &self.shapes[body];
        bar.draw(picture, frame.rect);
        shade::draw(picture, frame, &shape.moved, &shape.values, bar, shape.moved.window());
        lines(picture, frame, shape, self.kind, bar);
        if units.extent == Extent::Revolution && frame.x.values[0] < 0.0 {
            let at = frame.x.at(0.0);
            let ends = [[at, frame.rect.y], [at, frame.rect.bottom()]];
            picture.line(&ends, Stroke::new(INK, 0.8).dashed(&[10.0, 3.0, 2.0, 3.0]));
        }
        for ground in &shape.grounds {
            foundation(picture, frame, ground, units);
        }
        names::draw(picture, frame, shape.run, &shape.moved, &shape.snapshot.regions);
    }
}

/// The windows of the panels; the same for all if their bodies have the same extents.
fn windows(shapes: &[DrawnBody], factor: f64) -> Vec<[[f64; 2]; 2]> {
    let own: Vec<[[f64; 2]; 2]> = shapes.iter().map(|shape| shape.window(factor)).collect();
    let same = shapes.windows(2).all(|s| s[0].snapshot.body.window() == s[1].snapshot.body.window());
    let common = [0, 1].map(|d| axes::range(own.iter().flat_map(|w| w[d])).unwrap_or([0.0, 1.0]));
    own.into_iter().map(|own| sheet::widened(if same { common } else { own }, 0.06)).collect()
}

fn legend(shapes: &[DrawnBody], factor: f64, kind: PictureKind) -> Vec<(Sign, String)> {
    let mut entries = Vec::new();
    if kind == PictureKind::Deformed || factor > 1.0 {
        entries.push((Sign::Line(Stroke::new(MESH, 1.4), None), times(factor)));
    }
    if shapes.iter().any(DrawnBody::shows_reference) {
        entries.push((Sign::Line(Stroke::new(REFERENCE, 1.2).dashed(&[5.0, 3.0]), None), "undeformed".to_owned()));
    }
    if shapes.iter().any(|s| !s.grounds.is_empty()) {
        entries.push((Sign::Line(Stroke::new(VERMILION, 2.0), None), "foundation".to_owned()));
    }
    entries
}

/// Draws the mesh or level lines, the outline, and the undeformed outline.
fn lines(picture: &mut Picture, frame: &SheetPanel, shape: &DrawnBody, kind: PictureKind, bar: &ColorBar) {
    let through = |body: &PlaneMesh, lines: &[Vec<u32>]| -> Vec<Vec<[f64; 2]>> {
        let drawn = lines.iter().map(|line| simplified(&frame.all(line.iter().map(|&n| &body.points[n as usize]))));
        drawn.flat_map(|line| clipped(&line, frame.rect)).collect()
    };
    if kind == PictureKind::Deformed {
        let mesh = shape.snapshot.body.lines();
        let width = if mesh.len() > 2_000 { 0.25 } else { 0.45 };
        picture.lines(&through(&shape.moved, &mesh), Stroke::new(MESH.with_opacity(0.55), width));
    }
    if kind == PictureKind::Temperature {
        let levels = bar.levels().flat_map(|level| shade::level_line(&shape.moved, &shape.snapshot.temperature, level));
        let pieces: Vec<_> = levels.flat_map(|[a, b]| clipped(&[frame.at(&a), frame.at(&b)], frame.rect)).collect();
        picture.lines(&pieces, Stroke::new(WHITE.with_opacity(0.55), 0.7));
    }
    let outline = loops(&shape.snapshot.body.boundary);
    let drawn = |body: &PlaneMesh| -> Vec<OutlinePiece> {
        let points = |nodes: &Vec<u32>| simplified(&frame.all(nodes.iter().map(|&n| &body.points[n as usize])));
        outline.iter().flat_map(|nodes| within(points(nodes), frame.rect)).collect()
    };
    if shape.shows_reference() {
        picture.shape(drawn(&shape.snapshot.body), None, Some(Stroke::new(REFERENCE, 1.0).dashed(&[5.0, 3.0])));
    }
    picture.shape(drawn(&shape.moved), None, Some(Stroke::new(INK, 1.2)));
}

/// A closed line, or its pieces inside a rectangle if it leaves it.
fn within(mut points: Vec<[f64; 2]>, rect: Rect) -> Vec<OutlinePiece> {
    // A line on the border of the frame is inside.
    const NEAR: f64 = 0.5;
    let outside = |p: &[f64; 2]| {
        p[0] < rect.x - NEAR || p[0] > rect.right() + NEAR || p[1] < rect.y - NEAR || p[1] > rect.bottom() + NEAR
    };
    if !points.iter().any(outside) {
        return vec![OutlinePiece { points, closed: true }];
    }
    points.extend(points.first().copied());
    clipped(&points, rect).into_iter().map(|points| OutlinePiece { points, closed: false }).collect()
}

/// Draws the surface as a line, hatched on the side of the foundation, with an arrow if the foundation moves.
fn foundation(picture: &mut Picture, frame: &SheetPanel, ground: &Ground, units: Units) {
    const EACH: f64 = 9.0;
    const LENGTH: f64 = 7.0;
    let mut hatches = Vec::new();
    for line in &ground.lines {
        let points = frame.all(line);
        let mut along = 0.5 * EACH;
        for pair in points.windows(2) {
            let (dx, dy) = (pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
            let length = dx.hypot(dy);
            while along < length {
                // Right of the line; downwards is positive in the picture.
                let (p, t) =
                    ([pair[0][0] + along / length * dx, pair[0][1] + along / length * dy], [dx / length, dy / length]);
                hatches.push([p, [p[0] - LENGTH * (t[1] + 0.8 * t[0]), p[1] + LENGTH * (t[0] - 0.8 * t[1])]]);
                along += EACH;
            }
            along -= length;
        }
        picture.lines(&clipped(&simplified(&points), frame.rect), Stroke::new(VERMILION, 1.6));
    }
    let inside = |p: &[f64; 2]| {
        frame.rect.x <= p[0] && p[0] <= frame.rect.right() && frame.rect.y <= p[1] && p[1] <= frame.rect.bottom()
    };
    hatches.retain(|hatch| hatch.iter().all(inside));
    picture.lines(&hatches, Stroke::new(VERMILION, 0.7));
    if let Some(moves) = ground.moves {
        velocity(picture, frame, ground, moves, units);
    }
}

/// Draws an arrow with the speed of a moving foundation.
fn velocity(picture: &mut Picture, frame: &SheetPanel, ground: &Ground, (at, v): ([f64; 2], [f64; 2]), units: Units) {
    let speed = v[0].hypot(v[1]);
    let text = typeset(&units.write(speed, Measure::Velocity));
    let direction = [v[0] / speed, -v[1] / speed];
    // An arrow along the surface is placed in the foundation, clear of the line and its hatches.
    let inwards =
        inwards(frame, ground, frame.at(&at)).filter(|n| (n[0] * direction[0] + n[1] * direction[1]).abs() < 0.7);
    let [x, y] = [0, 1].map(|d| frame.at(&at)[d] + inwards.map_or(0.0, |n| 15.0 * n[d]));
    // The arrow stays within the frame.
    let within = |x: f64, lo: f64, hi: f64, room: f64| x.clamp(lo + room, (hi - room).max(lo + room));
    let near = if inwards.is_some() { 10.0 } else { 34.0 };
    let at = [within(x, frame.rect.x, frame.rect.right(), 34.0), within(y, frame.rect.y, frame.rect.bottom(), near)];
    let end = |s: f64| [0, 1].map(|d| at[d] + s * direction[d]);
    picture.arrow(end(-20.0), end(20.0), VERMILION, 2.4);
    // A horizontal arrow has its number on the outer side, others next to them, towards the middle of the frame.
    let (width, middle) =
        (font::width(&text, NUMBER), [frame.rect.x + 0.5 * frame.rect.width, frame.rect.y + 0.5 * frame.rect.height]);
    let is_level = direction[0].abs() > 0.7;
    let x = match inwards {
        _ if !is_level => at[0] + (0.5 * width + 9.0) * if at[0] > middle[0] { -1.0 } else { 1.0 },
        // Next to the arrow, away from the nearer border.
        Some(_) => at[0] + (0.5 * width + 28.0) * if at[0] > middle[0] { -1.0 } else { 1.0 },
        None => at[0],
    };
    let y = match inwards {
        Some(_) if is_level => at[1],
        _ if is_level => at[1] + if at[1] > middle[1] { 22.0 } else { -20.0 },
        _ => at[1] - 14.0 * if at[1] > middle[1] { -1.0 } else { 1.0 },
    };
    let place = Rect { x: x - 0.5 * width - 3.0, y: y - 0.5 * NUMBER - 3.0, width: width + 6.0, height: NUMBER + 6.0 };
    picture.polygon(place.corners(), WHITE.with_opacity(0.85));
    picture.text([x, y + HALF * NUMBER], NUMBER, Anchor::Middle, VERMILION, text);
}

/// The unit normal of the surface nearest to a point of the picture, pointing into the foundation.
fn inwards(frame: &SheetPanel, ground: &Ground, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
    let lines: Vec<Vec<[f64; 2]>> = ground.lines.iter().map(|line| frame.all(line)).collect();
    let away = |pair: &&[[f64; 2]]| (0.5 * (pair[0][0] + pair[1][0]) - x).hypot(0.5 * (pair[0][1] + pair[1][1]) - y);
    let nearest = lines.iter().flat_map(|line| line.windows(2)).min_by(|a, b| away(a).total_cmp(&away(b)))?;
    let (dx, dy) = (nearest[1][0] - nearest[0][0], nearest[1][1] - nearest[0][1]);
    // Right of the line; downwards is positive in the picture.
    let size = dx.hypot(dy);
    (size > 0.0).then(|| [-dy / size, dx / size])
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

/// A line without points that are within a twentieth of a unit of the remaining line.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_go_down_by_nice_numbers() {
        let mut factors = vec![2000.0];
        while factors.last().is_some_and(|f| *f > 1.0) {
            factors.extend(factors.last().copied().map(below));
        }
        let expected = [2000.0, 1000.0, 500.0, 200.0, 100.0, 50.0, 20.0, 10.0, 5.0, 2.0, 1.0];
        assert!(
            factors.len() == expected.len() && factors.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-9),
            "{factors:?}"
        );
    }
}
