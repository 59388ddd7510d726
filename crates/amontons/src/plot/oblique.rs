//! The surface of a body in space, deformed, with a field in colours and a colour bar.

use super::axes::{self, HEADING, LABEL, LEGEND, NUMBER, Sign, TITLE};
use super::color::{Color, ColorMap, INK, SOFT, VERMILION};
use super::field::{self, Bar, Quantity};
use super::ground::{self, Patch};
use super::picture::{Anchor, Picture, Rect, Stroke};
use super::plane::{factor, times, typeset};
use super::render::{self, Scene, View};
use super::run::{Run, Solid, at_corners};
use super::surface::{dot, norm};
use super::{Kind, Options, Panel, body, font, title};
use crate::units::{Measure, Units};

/// Pixels of an image to a unit.
const DENSITY: f64 = 2.0;
const MARGIN: f64 = 16.0;
const LONGEST: f64 = 400.0;
/// Colour of the foundation behind a body.
const GROUND: [u8; 3] = [0xDD, 0xD6, 0xCE];
/// Most bodies in a row.
const COLUMNS: usize = 2;

/// From where a body is seen: it lies between both eyes, so that all of its surface is on one of the pictures, but for
/// hollows.
const VIEWS: [(&str, [f64; 2]); 2] = [("from above", [-60.0, 32.0]), ("from below", [-60.0, -32.0])];

/// A body from one direction.
struct Sight<'a> {
    solid: &'a Solid,
    heading: String,
    view: View,
    /// Deformed nodes as they are seen, and those of the foundation behind them.
    points: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    /// The foundation in front of the body, as it is seen.
    in_front: Vec<[[f64; 2]; 2]>,
    window: [[f64; 2]; 2],
}

/// The field that a picture shows, at the corners of the triangles of the surface.
fn values(kind: Kind, solid: &Solid) -> Vec<[f64; 3]> {
    let surface = &solid.surface;
    let corners = |nodal: &[f64], cells| at_corners(&surface.triangles, &surface.owners, nodal, cells);
    match kind {
        Kind::VonMises => corners(&solid.nodal_von_mises, (&solid.von_mises, &solid.regions)),
        Kind::Deformed => corners(&solid.displacement.iter().map(|u| norm(*u)).collect::<Vec<f64>>(), (&[], &[])),
        _ => corners(&solid.temperature, (&[], &[])),
    }
}

/// Bodies in space as they are drawn, with what all of them have in common.
struct Stage<'a> {
    solids: Vec<(&'a Panel<'a>, &'a Solid)>,
    fields: Vec<Vec<[f64; 3]>>,
    extents: Vec<[f64; 2]>,
    ranges: Vec<[f64; 2]>,
    factor: f64,
}

impl<'a> Stage<'a> {
    /// The bodies of runs, their displacements enlarged as in pictures of the kind `enlarged`.
    fn new(kind: Kind, panels: &'a [Panel<'a>], options: &Options, enlarged: Kind) -> Stage<'a> {
        let solids: Vec<(&Panel, &Solid)> =
            panels.iter().filter_map(|panel| panel.run.solid.as_ref().map(|s| (panel, s))).collect();
        let runs: Vec<&Run> = solids.iter().map(|(panel, _)| panel.run).collect();
        let sizes = solids.iter().map(|(_, s)| {
            let size =
                [0, 1, 2].map(|d| axes::range(s.surface.points.iter().map(|p| p[d])).map_or(0.0, |[lo, hi]| hi - lo));
            (s.displacement.iter().map(|u| norm(*u)).fold(0.0, f64::max), size.into_iter().fold(0.0, f64::max))
        });
        let factor = factor(enlarged, &runs, sizes, options);
        let fields: Vec<Vec<[f64; 3]>> = solids.iter().map(|(_, s)| values(kind, s)).collect();
        let extents: Vec<[f64; 2]> =
            fields.iter().map(|v| axes::range(v.iter().flatten().copied()).unwrap_or([0.0, 1.0])).collect();
        let stress = |((v, (_, s)), extent): ((&Vec<[f64; 3]>, &(&Panel, &Solid)), &[f64; 2])| {
            if kind == Kind::VonMises { field::shown(v, &s.surface.areas(), *extent) } else { *extent }
        };
        let mut ranges: Vec<[f64; 2]> = fields.iter().zip(&solids).zip(&extents).map(stress).collect();
        if options.shared_scale {
            let common = axes::range(ranges.iter().flatten().copied()).unwrap_or([0.0, 1.0]);
            ranges.fill(common);
        }
        Stage { solids, fields, extents, ranges, factor }
    }
}

pub(super) fn draw(kind: Kind, panels: &[Panel], options: &Options) -> Picture {
    let (units, quantity) = (super::units(panels, options), Quantity::of(kind));
    let stage = Stage::new(kind, panels, options, kind);
    let sights: Vec<(usize, Sight)> = stage
        .solids
        .iter()
        .enumerate()
        .flat_map(|(i, entry)| {
            let views = if stage.solids.len() == 1 { VIEWS.to_vec() } else { vec![best_view(entry.0.run)] };
            let factor = stage.factor;
            views.into_iter().map(move |view| (i, sight(*entry, view, factor)))
        })
        .collect();
    let title = title(panels, quantity.name, options);
    let texts = Texts { title, quantity, units, factor: stage.factor };
    lay_out(kind, &sights, &stage.fields, (&stage.ranges, &stage.extents), &texts)
}

/// A picture per run, all from one side, with one scale of colours, of displacements and of lengths.
pub(super) fn frames(kind: Kind, panels: &[Panel], options: &Options) -> Vec<Picture> {
    let units = super::units(panels, options);
    let stage = Stage::new(kind, panels, &Options { shared_scale: true, ..options.clone() }, Kind::Deformed);
    let sight = |entry: &(&'_ Panel<'_>, &'_ Solid)| best_view(entry.0.run);
    let mut sights: Vec<Sight> =
        stage.solids.iter().map(|entry| self::sight(*entry, sight(entry), stage.factor)).collect();
    let window = [0, 1].map(|d| axes::range(sights.iter().flat_map(|s| s.window[d])).unwrap_or([0.0, 1.0]));
    for sight in &mut sights {
        sight.window = window;
    }
    let extent = axes::range(stage.extents.iter().flatten().copied()).unwrap_or([0.0, 1.0]);
    let frame = |(i, sight): (usize, Sight)| {
        let quantity = Quantity::of(kind);
        let title = title(&panels[i..=i], quantity.name, options);
        let texts = Texts { title, quantity, units, factor: stage.factor };
        lay_out(kind, &[(0, sight)], &stage.fields[i..=i], (&stage.ranges[i..=i], &[extent]), &texts)
    };
    sights.into_iter().enumerate().map(frame).collect()
}

/// What a picture says.
struct Texts {
    title: String,
    quantity: Quantity,
    units: Units,
    factor: f64,
}

/// Places the bodies in rows, each with a bar of colours on its right.
fn lay_out(
    kind: Kind,
    sights: &[(usize, Sight)],
    fields: &[Vec<[f64; 3]>],
    (ranges, extents): (&[[f64; 2]], &[[f64; 2]]),
    texts: &Texts,
) -> Picture {
    let Texts { title, quantity, units, factor } = texts;
    // The same scale everywhere.
    let span = |d: usize| sights.iter().map(|(_, s)| s.window[d][1] - s.window[d][0]).fold(f64::MIN_POSITIVE, f64::max);
    let scale = LONGEST / span(0).max(span(1));
    let [each_width, each_height] = [(span(0) * scale).ceil().max(80.0), (span(1) * scale).ceil()];
    let bars: Vec<Bar> =
        ranges.iter().zip(extents).map(|(range, extent)| Bar::new(quantity, *range, *extent, *units, false)).collect();
    let notes: Vec<String> = extents.iter().map(|extent| note(*units, *extent, quantity.measure, *factor)).collect();
    let is_last = |k: usize| sights.get(k + 1).is_none_or(|next| next.0 != sights[k].0);
    let beside = bars.iter().map(Bar::room).fold(0.0, f64::max) + MARGIN;
    let texts_width = notes.iter().map(|n| font::width(n, NUMBER) + 70.0).fold(0.0, f64::max);
    let column = each_width.max(if sights.len() > fields.len() { 0.0 } else { texts_width - beside }) + beside;
    let columns = if sights.len() <= 3 { sights.len() } else { COLUMNS.max(sights.len().div_ceil(3)) };
    let rows = sights.len().div_ceil(columns.max(1));
    let width = (2.0 * MARGIN + columns as f64 * column).max(font::width(title, TITLE).max(texts_width) + 2.0 * MARGIN);
    let legend = legend(sights);
    let top = (MARGIN + TITLE + 8.0 + if legend.is_empty() { 0.0 } else { LEGEND }).ceil();
    // Above a body its heading; below it room for the directions of the axes, a note and a length.
    let (above, below) = ((6.0 + HEADING + 10.0 + LABEL).ceil(), 76.0);
    let mut picture = Picture::new(width, top + rows as f64 * (above + each_height + below) + MARGIN, title);
    picture.text([0.5 * picture.width, MARGIN + 0.8 * TITLE], TITLE, Anchor::Middle, INK, title);
    let left = 0.5 * (picture.width - axes::line_width(&legend));
    axes::legend(&mut picture, [left, MARGIN + TITLE + LEGEND], f64::INFINITY, &legend);
    for (k, (i, sight)) in sights.iter().enumerate() {
        let x = MARGIN + (k % columns) as f64 * column;
        let y = top + (k / columns) as f64 * (above + each_height + below) + above;
        let rect = Rect { x, y, width: each_width, height: each_height };
        picture.text([x + 0.5 * rect.width, y - LABEL - 8.0], HEADING, Anchor::Middle, INK, &sight.heading);
        sight.draw(&mut picture, (rect, scale), kind == Kind::Deformed, &fields[*i], (&bars[*i], quantity.map));
        if k == 0 || sights[k - 1].0 != *i {
            picture.text([x + 70.0, rect.bottom() + 40.0], NUMBER, Anchor::Start, SOFT, &notes[*i]);
            length_bar(&mut picture, [x + 70.0, rect.bottom() + 58.0], scale, *units);
        }
        if is_last(k) {
            bars[*i].draw(&mut picture, rect);
        }
    }
    picture
}

fn legend(sights: &[(usize, Sight)]) -> Vec<(Sign, String)> {
    let behind = sights.iter().any(|(_, sight)| sight.triangles.len() > sight.solid.surface.triangles.len());
    let in_front = sights.iter().any(|(_, sight)| !sight.in_front.is_empty());
    let [red, green, blue] = GROUND;
    let box_ = || (Sign::Box(Color { red, green, blue, opacity: 1.0 }), "foundation".to_owned());
    let line = || (Sign::Line(Stroke::new(VERMILION, 1.2), None), "foundation, in front".to_owned());
    behind.then(box_).into_iter().chain(in_front.then(line)).collect()
}

/// A bar of a length of 1, 2 or 5 times a power of ten, as long as it is in the picture.
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
        [end + 7.0, y + axes::HALF * NUMBER],
        NUMBER,
        Anchor::Start,
        INK,
        typeset(&units.write(length, Measure::Length)),
    );
}

/// `min 1, max 2 K; displacement × 50`.
fn note(units: Units, extent: [f64; 2], measure: Measure, factor: f64) -> String {
    format!("{}; {}", field::extremes(units, extent, measure), times(factor))
}

/// The view on the contact sides of a body, from above where there are none.
fn best_view(run: &Run) -> (&'static str, [f64; 2]) {
    let below = run.problem.as_ref().is_some_and(|problem| {
        problem.contact_boundary().points.iter().map(|p| p.weight * p.normal[2]).sum::<f64>() < 0.0
    });
    VIEWS[usize::from(below)]
}

fn sight<'a>(
    (panel, solid): (&Panel, &'a Solid),
    (name, [azimuth, elevation]): (&str, [f64; 2]),
    factor: f64,
) -> Sight<'a> {
    let view = View::new(azimuth, elevation);
    let moved = solid
        .surface
        .points
        .iter()
        .zip(&solid.displacement)
        .map(|(p, u)| view.place([0, 1, 2].map(|d| p[d] + factor * u[d])));
    let mut points: Vec<[f64; 3]> = moved.collect();
    let mut triangles = solid.surface.triangles.clone();
    let mut in_front = Vec::new();
    let patches = panel
        .run
        .problem
        .as_ref()
        .map_or_else(Vec::new, |problem| ground::patches(problem, &solid.displacement, panel.run.t, factor));
    for Patch { points: own, triangles: parts, normal } in patches {
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
    let plane: Vec<[f64; 2]> = points.iter().map(|p| [p[0], p[1]]).chain(in_front.iter().flatten().copied()).collect();
    let heading = if panel.title.is_empty() { name.to_owned() } else { format!("{}, {name}", panel.title) };
    Sight {
        solid,
        heading,
        view,
        points,
        triangles,
        in_front,
        window: super::sheet::widened(body::window(&plane), 0.01),
    }
}

impl Sight<'_> {
    /// Draws a field, with the mesh on request, in a rectangle.
    fn draw(
        &self,
        picture: &mut Picture,
        (rect, scale): (Rect, f64),
        mesh: bool,
        field: &[[f64; 3]],
        (bar, map): (&Bar, ColorMap),
    ) {
        const MESH: Color = Color::new(0x1B_3A_5C);
        let surface = &self.solid.surface;
        let [lo, hi] = bar.range;
        let color = |v: f64| if v.is_nan() { GROUND } else { map.at(if hi > lo { (v - lo) / (hi - lo) } else { 0.5 }) };
        let values = |t: usize| field.get(t).copied().unwrap_or([f64::NAN; 3]);
        let lines: Vec<[u32; 2]> =
            if mesh { surface.edges.iter().map(|e| e.nodes).collect() } else { surface.outline(&self.solid.regions) };
        let ink = if mesh { MESH } else { INK };
        let scene = Scene {
            points: &self.points,
            triangles: &self.triangles,
            values: &values,
            color: &color,
            lines: &lines,
            ink,
        };
        let [[left, right], [bottom, top]] = self.window;
        let size = [(right - left) * scale, (top - bottom) * scale];
        let pixels = |length: f64| (length * DENSITY).ceil().clamp(1.0, 4096.0) as u32;
        let place = Rect {
            x: rect.x + 0.5 * (rect.width - size[0]),
            y: rect.y + 0.5 * (rect.height - size[1]),
            width: size[0],
            height: size[1],
        };
        picture.image(place, render::image(&scene, self.window, pixels(size[0]), pixels(size[1])));
        let at = |p: [f64; 2]| [place.x + (p[0] - left) * scale, place.y + (top - p[1]) * scale];
        let outline: Vec<_> = self.in_front.iter().map(|edge| edge.map(at)).collect();
        picture.lines(&outline, Stroke::new(VERMILION, 1.2));
        self.axes(picture, [rect.x + 30.0, rect.bottom() + 38.0]);
    }

    /// The directions of x, y and z.
    fn axes(&self, picture: &mut Picture, origin: [f64; 2]) {
        const LENGTH: f64 = 22.0;
        for (d, name) in ["x", "y", "z"].into_iter().enumerate() {
            let along = |length: f64| [origin[0] + length * self.view.right[d], origin[1] - length * self.view.up[d]];
            picture.line(&[origin, along(LENGTH)], Stroke::new(SOFT, 1.2));
            let [x, y] = along(LENGTH + 7.0);
            picture.text([x, y + axes::HALF * NUMBER], NUMBER, Anchor::Middle, SOFT, name);
        }
    }
}
