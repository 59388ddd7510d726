//! The surface of a body in space, deformed, coloured by a field, with a colour bar.

use super::axes::{self, LEGEND, Sign};
use super::color::{Color, INK, SOFT, VERMILION};
use super::field::{ColorBar, DrawnField, DrawnQuantity, FieldScales};
use super::font::{self, HALF, HEADING, LABEL, NUMBER, TITLE, typeset};
use super::ground::{self, GroundPatch};
use super::picture::{Anchor, MARGIN, Picture, Rect, Stroke};
use super::plane::{factor, times};
use super::render::{self, ShadedTriangle, View};
use super::run::{DrawnRun, SpaceSnapshot};
use super::surface::{dot, norm};
use super::views::{self, Look};
use super::zoom::{self, Zone, clipped};
use super::{Options, PictureKind, RunPanel, body, title};
use crate::units::{Measure, Units};

const LONGEST: f64 = 400.0;
/// Colour of the foundation behind a body.
const GROUND: [u8; 3] = [0xDD, 0xD6, 0xCE];
/// Least number of columns if there are several rows.
const COLUMNS: usize = 2;
/// Largest number of views of one run.
const VIEWS: usize = 36;

/// A body seen from one direction.
#[derive(Clone)]
struct BodyView<'a> {
    solid: &'a SpaceSnapshot,
    heading: String,
    view: View,
    /// The mean outward normal of the contact shown.
    normal: Option<[f64; 3]>,
    /// Projected deformed nodes, including those of the foundation behind the body.
    points: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    /// The surface triangle of each drawn triangle; the foundation has none.
    which: Vec<usize>,
    /// The nodes of the body shown, or `None` if all are.
    shown: Option<Vec<bool>>,
    /// Enlargement relative to the other views; 1 for views that are not enlarged.
    times: f64,
    /// The projected lines of the foundation in front of the body.
    in_front: Vec<[[f64; 2]; 2]>,
    window: [[f64; 2]; 2],
}

/// Bodies in space as drawn, with the data common to all of them.
struct SpaceScene<'a> {
    solids: Vec<(&'a RunPanel<'a>, &'a SpaceSnapshot)>,
    fields: Vec<Vec<[f64; 3]>>,
    scales: FieldScales,
    factor: f64,
}

impl<'a> SpaceScene<'a> {
    /// The bodies of runs, with displacements enlarged as in pictures of the kind `enlarged`.
    fn new(kind: PictureKind, panels: &'a [RunPanel<'a>], options: &Options, enlarged: PictureKind) -> SpaceScene<'a> {
        let solids: Vec<(&RunPanel, &SpaceSnapshot)> =
            panels.iter().filter_map(|panel| panel.run.solid.as_ref().map(|s| (panel, s))).collect();
        let runs: Vec<&DrawnRun> = solids.iter().map(|(panel, _)| panel.run).collect();
        let sizes = solids.iter().map(|(_, s)| {
            let size =
                [0, 1, 2].map(|d| axes::range(s.surface.points.iter().map(|p| p[d])).map_or(0.0, |[lo, hi]| hi - lo));
            (s.displacement.iter().map(|u| norm(*u)).fold(0.0, f64::max), size.into_iter().fold(0.0, f64::max))
        });
        let factor = factor(enlarged, &runs, sizes, options);
        let fields: Vec<Vec<[f64; 3]>> = solids.iter().map(|(_, s)| s.corners(kind)).collect();
        let drawn = fields.iter().zip(&solids).map(|(values, (_, s))| DrawnField {
            values,
            areas: s.surface.areas(),
            cells: &s.von_mises,
            nodal: &s.nodal_von_mises,
        });
        let scales = FieldScales::new(kind, &drawn.collect::<Vec<_>>(), options.shared_scale);
        SpaceScene { solids, fields, scales, factor }
    }

    /// The contact that is enlarged.
    fn zone(&self) -> Option<Zone> {
        let runs: Vec<&DrawnRun> = self.solids.iter().map(|(panel, _)| panel.run).collect();
        let nodes: Vec<_> = self.solids.iter().map(|(_, s)| s.surface.points.clone()).collect();
        let moved: Vec<_> = self.solids.iter().map(|(_, s)| displaced(s, self.factor)).collect();
        zoom::zone(&runs, &nodes, &moved)
    }

    /// A body in all its views, with its contact enlarged if that is small.
    fn sights(&self, body: usize, zone: Option<&Zone>) -> Vec<BodyView<'a>> {
        let (entry, all) = (self.solids[body], self.solids.len() == 1);
        let looks = views::looks(entry.0.run, all);
        let mut sights: Vec<BodyView> =
            looks.into_iter().take(VIEWS).map(|look| sight(entry, look, self.factor)).collect();
        let enlarged = zone.and_then(|zone| {
            let side = entry.0.run.side(zone.side);
            let seen = sights.iter().find(|sight| sight.shows(entry.0.run, zone.side))?;
            let part = |p: &[f64; 3]| [dot(seen.view.right, *p), dot(seen.view.up, *p)];
            let points: Vec<[f64; 2]> = zone.points.iter().map(part).collect();
            let (window, times) = zoom::window(&points, seen.window)?;
            let heading = format!("contact{side}, enlarged × {}", super::ticks::number(times));
            Some(BodyView { heading, times, window, ..seen.clone() })
        });
        sights.extend(enlarged);
        sights
    }

    /// Places views of the bodies in rows, each with a bar of colours on its right.
    fn lay_out(&self, kind: PictureKind, sights: &[(usize, BodyView)], title: &str, units: Units) -> Picture {
        // One scale for all bodies.
        let length = |s: &BodyView, d: usize| s.times * (s.window[d][1] - s.window[d][0]);
        let span = |d: usize| sights.iter().map(|(_, s)| length(s, d)).fold(f64::MIN_POSITIVE, f64::max);
        let scale = LONGEST / span(0).max(span(1));
        let [each_width, each_height] = [(span(0) * scale).ceil().max(80.0), (span(1) * scale).ceil()];
        let bars: Vec<ColorBar> = (0..self.solids.len()).map(|i| self.scales.bar(i, units, false)).collect();
        let note = |i: usize| {
            let text = format!("{}; {}", self.scales.extremes(i, units), times(self.factor));
            let (first, second) = text.split_once("; ").unwrap_or((&text, ""));
            [first.to_owned(), second.to_owned()]
        };
        let notes: Vec<[String; 2]> = (0..self.solids.len()).map(note).collect();
        let is_last = |k: usize| sights.get(k + 1).is_none_or(|next| next.0 != sights[k].0);
        let beside = bars.iter().map(ColorBar::room).fold(0.0, f64::max) + MARGIN;
        let texts_width = notes.iter().flatten().map(|n| font::width(n, NUMBER) + 70.0).fold(0.0, f64::max);
        let column = each_width.max(texts_width - beside) + beside;
        let columns = columns(sights.len());
        let rows = sights.len().div_ceil(columns.max(1));
        let width =
            (2.0 * MARGIN + columns as f64 * column).max(font::width(title, TITLE).max(texts_width) + 2.0 * MARGIN);
        let legend = legend(sights);
        let top = (MARGIN + TITLE + 8.0 + if legend.is_empty() { 0.0 } else { LEGEND }).ceil();
        // The heading above a body; axes, a note and a length bar below it.
        let (above, below) = ((6.0 + HEADING + 10.0 + LABEL).ceil(), 88.0);
        let mut picture = Picture::new(width, top + rows as f64 * (above + each_height + below) + MARGIN, title);
        picture.text([0.5 * picture.width, MARGIN + 0.8 * TITLE], TITLE, Anchor::Middle, INK, title);
        let left = 0.5 * (picture.width - axes::line_width(&legend));
        axes::legend(&mut picture, [left, MARGIN + TITLE + LEGEND], f64::INFINITY, &legend);
        for (k, (i, sight)) in sights.iter().enumerate() {
            let x = MARGIN + (k % columns) as f64 * column;
            let y = top + (k / columns) as f64 * (above + each_height + below) + above;
            let rect = Rect { x, y, width: each_width, height: each_height };
            picture.text([x + 0.5 * rect.width, y - LABEL - 8.0], HEADING, Anchor::Middle, INK, &sight.heading);
            let scale = scale * sight.times;
            sight.draw(&mut picture, (rect, scale), kind == PictureKind::Deformed, &self.fields[*i], &bars[*i]);
            let is_first = k == 0 || sights[k - 1].0 != *i;
            if is_first {
                for (line, text) in notes[*i].iter().enumerate() {
                    let y = rect.bottom() + 36.0 + 15.0 * line as f64;
                    picture.text([x + 70.0, y], NUMBER, Anchor::Start, SOFT, text);
                }
            }
            if is_first || sight.times > 1.0 {
                length_bar(&mut picture, [x + 70.0, rect.bottom() + 68.0], scale, units);
            }
            if is_last(k) {
                bars[*i].draw(&mut picture, rect);
            }
        }
        picture
    }
}

pub(super) fn draw(kind: PictureKind, panels: &[RunPanel], options: &Options) -> Picture {
    let stage = SpaceScene::new(kind, panels, options, kind);
    let zone = stage.zone();
    let sights: Vec<(usize, BodyView)> = (0..stage.solids.len())
        .flat_map(|i| stage.sights(i, zone.as_ref()).into_iter().map(move |sight| (i, sight)))
        .collect();
    stage.lay_out(kind, &sights, &title(panels, DrawnQuantity::of(kind).name, options), super::units(panels, options))
}

/// One picture per run, all from the same direction, with the same scales of colours, displacements and lengths.
pub(super) fn frames(kind: PictureKind, panels: &[RunPanel], options: &Options) -> Vec<Picture> {
    let units = super::units(panels, options);
    let mut stage =
        SpaceScene::new(kind, panels, &Options { shared_scale: true, ..options.clone() }, PictureKind::Deformed);
    // A pair is shown as a whole.
    let look = |run: &DrawnRun| {
        let seen = views::looks(run, false).into_iter().next();
        seen.filter(|look| look.nodes.is_none())
            .or_else(|| views::looks(&DrawnRun::default(), false).into_iter().next())
    };
    let seen = stage.solids.iter().filter_map(|entry| Some((entry, look(entry.0.run)?)));
    let mut sights: Vec<BodyView> = seen.map(|(entry, look)| sight(*entry, look, stage.factor)).collect();
    let window = [0, 1].map(|d| axes::range(sights.iter().flat_map(|s| s.window[d])).unwrap_or([0.0, 1.0]));
    for sight in &mut sights {
        sight.window = window;
    }
    stage.scales.share_extremes();
    let frame = |(i, sight): (usize, BodyView)| {
        let title = title(&panels[i..=i], DrawnQuantity::of(kind).name, options);
        stage.lay_out(kind, &[(i, sight)], &title, units)
    };
    sights.into_iter().enumerate().map(frame).collect()
}

/// Number of columns for a number of views: one row of up to three, else rows of a roughly square sheet.
fn columns(count: usize) -> usize {
    match count {
        0..=3 => count.max(1),
        4..=9 => COLUMNS.max(count.div_ceil(3)),
        _ => (count as f64).sqrt().ceil() as usize,
    }
}

fn legend(sights: &[(usize, BodyView)]) -> Vec<(Sign, String)> {
    let behind = sights.iter().any(|(_, sight)| sight.triangles.len() > sight.which.len());
    let in_front = sights.iter().any(|(_, sight)| !sight.in_front.is_empty());
    let [red, green, blue] = GROUND;
    let box_ = || (Sign::Box(Color { red, green, blue, opacity: 1.0 }), "foundation".to_owned());
    let line = || (Sign::Line(Stroke::new(VERMILION, 1.2), None), "foundation, in front".to_owned());
    behind.then(box_).into_iter().chain(in_front.then(line)).collect()
}

/// Draws a bar with a length of 1, 2 or 5 times a power of ten, to the scale of the picture.
fn length_bar(picture: &mut Picture, [x, y]: [f64; 2], scale: f64, units: Units) {
    let most = 90.0 / scale;
    let power = 10f64.powf(most.log10().floor());
    let length = [5.0, 2.0, 1.0].into_iter().map(|m| m * power).find(|l| *l <= most).unwrap_or(power);
    let end = x + length * scale;
    picture.lines(
        &[[[x, y], [end, y]], [[x, y - 4.0], [x, y + 4.0]], [[end, y - 4.0], [end, y + 4.0]]],
        Stroke::new(INK, 1.4),
    );
    picture.text(
        [end + 7.0, y + HALF * NUMBER],
        NUMBER,
        Anchor::Start,
        INK,
        typeset(&units.write(length, Measure::Length)),
    );
}

/// The nodes of a body, displaced by `factor` times their displacements.
fn displaced(solid: &SpaceSnapshot, factor: f64) -> Vec<[f64; 3]> {
    let moved = solid.surface.points.iter().zip(&solid.displacement);
    moved.map(|(p, u)| [0, 1, 2].map(|d| p[d] + factor * u[d])).collect()
}

fn sight<'a>((panel, solid): (&RunPanel, &'a SpaceSnapshot), look: Look, factor: f64) -> BodyView<'a> {
    let Look { name, view, nodes: shown, normal } = look;
    let mut points: Vec<[f64; 3]> = displaced(solid, factor).into_iter().map(|p| view.place(p)).collect();
    let is_shown = |node: u32| shown.as_ref().is_none_or(|shown| shown.get(node as usize) == Some(&true));
    let all = solid.surface.triangles.iter().enumerate();
    let (which, mut triangles): (Vec<usize>, Vec<[u32; 3]>) =
        all.filter(|(_, triangle)| is_shown(triangle[0])).map(|(t, triangle)| (t, *triangle)).unzip();
    let mut in_front = Vec::new();
    // The foundation of one body of several is not drawn, so that nothing hides the body.
    let patches = panel
        .run
        .problem
        .as_ref()
        .filter(|_| shown.is_none())
        .map_or_else(Vec::new, |problem| ground::patches(problem, &solid.displacement, panel.run.t, factor));
    for GroundPatch { points: own, triangles: parts, normal } in patches {
        let seen: Vec<[f64; 3]> = own.iter().map(|p| view.place(*p)).collect();
        if dot(normal, view.eye) < 0.0 {
            let first = points.len() as u32;
            points.extend(seen);
            triangles.extend(parts.iter().map(|t| t.map(|n| n + first)));
        } else {
            let at = |n: u32| [seen[n as usize][0], seen[n as usize][1]];
            in_front.extend(ground::rim(&parts).into_iter().map(|[a, b]| [at(a), at(b)]));
        }
    }
    let seen = triangles.iter().flatten().map(|&n| points[n as usize]).map(|p| [p[0], p[1]]);
    let plane: Vec<[f64; 2]> = seen.chain(in_front.iter().flatten().copied()).collect();
    let heading = if panel.title.is_empty() { name } else { format!("{}, {name}", panel.title) };
    BodyView {
        solid,
        heading,
        view,
        normal,
        points,
        triangles,
        which,
        shown,
        times: 1.0,
        in_front,
        window: super::sheet::widened(body::window(&plane), 0.01),
    }
}

impl BodyView<'_> {
    /// True if a node belongs to the body shown.
    fn has(&self, node: u32) -> bool {
        self.shown.as_ref().is_none_or(|shown| shown.get(node as usize) == Some(&true))
    }

    /// True if a contact side is visible.
    fn shows(&self, run: &DrawnRun, side: usize) -> bool {
        let Some(problem) = &run.problem else { return false };
        let points = &problem.contact_boundary().points;
        let mut normals = points.iter().filter(|point| point.contact == side).map(|point| point.normal);
        let nodes = problem.contacts.get(side).and_then(|contact| problem.mesh.facets.get(contact.bearing()));
        let node = nodes.and_then(|set| set.node_list().first().copied());
        self.normal.is_some() && node.is_none_or(|node| self.has(node)) && normals.any(|n| dot(n, self.view.eye) > 0.0)
    }

    /// Draws a field, with the mesh if requested, in a rectangle.
    fn draw(&self, picture: &mut Picture, (rect, scale): (Rect, f64), mesh: bool, field: &[[f64; 3]], bar: &ColorBar) {
        const MESH: Color = Color::new(0x1B_3A_5C);
        let surface = &self.solid.surface;
        let color = |v: f64| if v.is_nan() { GROUND } else { bar.color(v) };
        let values = |t: usize| self.which.get(t).and_then(|&t| field.get(t)).copied().unwrap_or([f64::NAN; 3]);
        let mut lines: Vec<[u32; 2]> =
            if mesh { surface.edges.iter().map(|e| e.nodes).collect() } else { surface.outline(&self.solid.regions) };
        lines.retain(|[node, _]| self.has(*node));
        let ink = if mesh { MESH } else { INK };
        let scene = ShadedTriangle {
            points: &self.points,
            triangles: &self.triangles,
            values: &values,
            color: &color,
            lines: &lines,
            ink,
        };
        let [[left, right], [bottom, top]] = self.window;
        let size = [(right - left) * scale, (top - bottom) * scale];
        let place = Rect {
            x: rect.x + 0.5 * (rect.width - size[0]),
            y: rect.y + 0.5 * (rect.height - size[1]),
            width: size[0],
            height: size[1],
        };
        let [width, height] = place.pixels();
        picture.image(place, render::image(&scene, self.window, width, height));
        let at = |p: [f64; 2]| [place.x + (p[0] - left) * scale, place.y + (top - p[1]) * scale];
        let outline: Vec<_> = self.in_front.iter().flat_map(|edge| clipped(&edge.map(at), place)).collect();
        picture.lines(&outline, Stroke::new(VERMILION, 1.2));
        self.axes(picture, [rect.x + 30.0, rect.bottom() + 38.0]);
    }

    /// Draws the directions of x, y and z.
    fn axes(&self, picture: &mut Picture, origin: [f64; 2]) {
        const LENGTH: f64 = 22.0;
        for (d, name) in ["x", "y", "z"].into_iter().enumerate() {
            let along = |length: f64| [origin[0] + length * self.view.right[d], origin[1] - length * self.view.up[d]];
            picture.line(&[origin, along(LENGTH)], Stroke::new(SOFT, 1.2));
            let [x, y] = along(LENGTH + 7.0);
            picture.text([x, y + HALF * NUMBER], NUMBER, Anchor::Middle, SOFT, name);
        }
    }
}
