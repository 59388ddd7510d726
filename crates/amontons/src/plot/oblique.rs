//! The surface of a body in space, deformed, with a field in colours and a colour bar.

use super::axes::{self, HEADING, LABEL, NUMBER, TITLE};
use super::color::{Color, ColorMap, INK, SOFT};
use super::field::{self, Bar, Quantity};
use super::picture::{Anchor, Picture, Rect, Stroke};
use super::render::{self, Scene, View};
use super::run::Solid;
use super::shade::Values;
use super::surface::norm;
use super::{Kind, Options, Panel, body, font, scale_factor, ticks, title};

/// Pixels of an image to a unit.
const DENSITY: f64 = 2.0;
const MARGIN: f64 = 16.0;
const LONGEST: f64 = 400.0;

/// From where a body is seen: it lies between both eyes, so that all of its surface is on one of the pictures, but for hollows.
const VIEWS: [(&str, [f64; 2]); 2] = [("from above", [-60.0, 32.0]), ("from below", [-60.0, -32.0])];

/// A body from one direction.
struct Sight<'a> {
    solid: &'a Solid,
    heading: String,
    view: View,
    /// Deformed nodes as they are seen.
    points: Vec<[f64; 3]>,
    window: [[f64; 2]; 2],
}

/// The field that a picture shows, with the values of one body.
fn values(kind: Kind, solid: &Solid) -> (Vec<f64>, bool) {
    match kind {
        Kind::VonMises => (solid.von_mises.clone(), true),
        Kind::Deformed => (solid.displacement.iter().map(|u| norm(*u)).collect(), false),
        _ => (solid.temperature.clone(), false),
    }
}

pub(super) fn draw(kind: Kind, panels: &[Panel], options: &Options) -> Picture {
    let quantity = match kind {
        Kind::Deformed => Quantity { name: "displacement", symbol: "‖u‖", unit: "m", map: ColorMap::Viridis },
        _ => Quantity::of(kind),
    };
    let solids: Vec<(&Panel, &Solid)> = panels.iter().filter_map(|panel| panel.run.solid.as_ref().map(|s| (panel, s))).collect();
    // One factor for all panels, so that they can be compared.
    let chosen = solids.iter().map(|(_, s)| {
        let size = [0, 1, 2].map(|d| axes::range(s.surface.points.iter().map(|p| p[d])).map_or(0.0, |[lo, hi]| hi - lo));
        scale_factor(s.displacement.iter().map(|u| norm(*u)).fold(0.0, f64::max), size.into_iter().fold(0.0, f64::max))
    });
    let factor = options.scale_factor.unwrap_or_else(|| chosen.fold(f64::INFINITY, f64::min));
    let unit = options.unit(quantity.unit);
    let fields: Vec<(Vec<f64>, bool)> = solids.iter().map(|(_, s)| values(kind, s)).collect();
    let extents: Vec<[f64; 2]> = fields.iter().map(|(v, _)| axes::range(v.iter().copied()).unwrap_or([0.0, 1.0])).collect();
    let mut ranges: Vec<[f64; 2]> = Vec::new();
    for (((_, s), (v, by_cell)), extent) in solids.iter().zip(&fields).zip(&extents) {
        let values = if *by_cell { Values::Cells(v) } else { Values::Nodes(v) };
        ranges.push(field::shown(values, &s.surface.areas(), *extent));
    }
    if options.shared_scale {
        let common = axes::range(ranges.iter().flatten().copied()).unwrap_or([0.0, 1.0]);
        ranges.fill(common);
    }
    let views = if solids.len() == 1 { &VIEWS[..] } else { &VIEWS[..1] };
    let sights: Vec<(usize, Sight)> =
        solids.iter().enumerate().flat_map(|(i, entry)| views.iter().map(move |view| (i, sight(*entry, *view, factor)))).collect();
    // The same scale everywhere.
    let span = |d: usize| sights.iter().map(|(_, s)| s.window[d][1] - s.window[d][0]).fold(f64::MIN_POSITIVE, f64::max);
    let scale = LONGEST / span(0).max(span(1));
    let height = (span(1) * scale).ceil();

    let bars: Vec<Bar> = ranges.iter().zip(&extents).map(|(range, extent)| Bar::new(&quantity, *range, *extent, unit, false)).collect();
    let widths: Vec<f64> = sights.iter().map(|(_, s)| ((s.window[0][1] - s.window[0][0]) * scale).ceil().max(80.0)).collect();
    let is_last = |k: usize| sights.get(k + 1).is_none_or(|next| next.0 != sights[k].0);
    let beside = |k: usize| if is_last(k) { bars[sights[k].0].room() + MARGIN } else { MARGIN };
    let title = title(panels, quantity.name, options);
    let notes: Vec<String> = extents.iter().map(|extent| note(*extent, factor, unit)).collect();
    let texts = notes.iter().map(|n| font::width(n, NUMBER)).chain([font::width(&title, TITLE)]).fold(0.0, f64::max) + 70.0;
    let width = (MARGIN + (0..sights.len()).map(|k| widths[k] + beside(k)).sum::<f64>()).max(texts + 2.0 * MARGIN);
    let top = (MARGIN + TITLE + 14.0 + HEADING + 10.0 + LABEL).ceil();
    // Room for the directions of the axes and a note.
    let below = 70.0;
    let mut picture = Picture::new(width, top + height + below + MARGIN, &title);
    picture.text([0.5 * picture.width, MARGIN + 0.8 * TITLE], TITLE, Anchor::Middle, INK, &title);
    let mut x = MARGIN;
    for (k, (i, sight)) in sights.iter().enumerate() {
        let rect = Rect { x, y: top, width: widths[k], height };
        let (field, by_cell) = &fields[*i];
        picture.text([x + 0.5 * rect.width, top - LABEL - 8.0], HEADING, Anchor::Middle, INK, &sight.heading);
        sight.draw(&mut picture, rect, scale, kind == Kind::Deformed, (field, *by_cell), (&bars[*i], quantity.map));
        if k == 0 || sights[k - 1].0 != *i {
            picture.text([x + 70.0, rect.bottom() + 40.0], NUMBER, Anchor::Start, SOFT, &notes[*i]);
        }
        if is_last(k) {
            bars[*i].draw(&mut picture, rect);
        }
        x += rect.width + beside(k);
    }
    picture
}

/// `min 1, max 2 K; displacement × 50`.
fn note([lo, hi]: [f64; 2], factor: f64, unit: &str) -> String {
    let times = if (factor - 1.0).abs() < 1e-9 { "displacement to scale".to_owned() } else { format!("displacement × {}", ticks::number(factor)) };
    let values = format!("min {}, max {} {unit}", ticks::number(lo), ticks::number(hi));
    format!("{}; {times}", values.trim_end())
}

fn sight<'a>((panel, solid): (&Panel, &'a Solid), (name, [azimuth, elevation]): (&str, [f64; 2]), factor: f64) -> Sight<'a> {
    let view = View::new(azimuth, elevation);
    let moved = solid.surface.points.iter().zip(&solid.displacement).map(|(p, u)| view.place([0, 1, 2].map(|d| p[d] + factor * u[d])));
    let points: Vec<[f64; 3]> = moved.collect();
    let plane: Vec<[f64; 2]> = points.iter().map(|p| [p[0], p[1]]).collect();
    let heading = if panel.title.is_empty() { name.to_owned() } else { panel.title.to_owned() };
    Sight { solid, heading, view, points, window: super::sheet::widened(body::window(&plane), 0.01) }
}

impl Sight<'_> {
    fn draw(&self, picture: &mut Picture, rect: Rect, scale: f64, mesh: bool, (field, by_cell): (&[f64], bool), (bar, map): (&Bar, ColorMap)) {
        const MESH: Color = Color::new(0x1B_3A_5C);
        let surface = &self.solid.surface;
        let [lo, hi] = bar.range;
        let color = |v: f64| map.at(if hi > lo { (v - lo) / (hi - lo) } else { 0.5 });
        let values = |t: usize| if by_cell { [field[surface.owners[t] as usize]; 3] } else { surface.triangles[t].map(|n| field[n as usize]) };
        let lines: Vec<[u32; 2]> = if mesh { surface.edges.iter().map(|e| e.nodes).collect() } else { surface.outline(&self.solid.regions) };
        let ink = if mesh { MESH } else { INK };
        let scene = Scene { points: &self.points, triangles: &surface.triangles, values: &values, color: &color, lines: &lines, ink };
        let [[left, right], [bottom, top]] = self.window;
        let size = [(right - left) * scale, (top - bottom) * scale];
        let pixels = |length: f64| (length * DENSITY).ceil().clamp(1.0, 4096.0) as u32;
        let place = Rect { x: rect.x + 0.5 * (rect.width - size[0]), y: rect.y + 0.5 * (rect.height - size[1]), width: size[0], height: size[1] };
        picture.image(place, render::image(&scene, self.window, pixels(size[0]), pixels(size[1])));
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
