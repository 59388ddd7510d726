//! The contact side of a body in space: pressure and state of each contact point.

use std::collections::{HashMap, HashSet};

use super::axes::{self, LEGEND, NUMBER, Sign};
use super::body::{Body, window};
use super::color::{Color, ColorMap, GREY, INK};
use super::field::{Bar, Quantity};
use super::picture::{Line, Picture, Rect, Stroke};
use super::profiles::{STATUSES, color};
use super::run::{Solid, SolidContact};
use super::shade::{self, Values};
use super::sheet::{self, Frame, Plan, Room};
use super::{Options, Panel, PlotError, ticks, title};

/// Pixels of an image to a unit.
const DENSITY: f64 = 2.0;

/// Γ_C seen along the axis that is nearest to its normal.
struct Side<'a> {
    rows: &'a [SolidContact],
    /// The coordinates that are seen.
    shown: [usize; 2],
    /// The part of the surface whose nodes are the contact points, with the pressure at each node; none where the points are not nodes.
    plane: Option<(Body, Vec<f64>)>,
}

impl Side<'_> {
    fn of(solid: &Solid) -> Result<Side<'_>, PlotError> {
        // Positions have the same bits in both files; adding zero makes −0 and 0 one.
        let key = |p: [f64; 3]| p.map(|x| (x + 0.0).to_bits());
        let rows: HashMap<[u64; 3], usize> = solid.contact.iter().enumerate().map(|(i, row)| (key(row.x), i)).collect();
        let surface = &solid.surface;
        let row = |n: u32| rows.get(&key(surface.points[n as usize])).copied();
        // Vertices of quadratic triangles may bear no contact point.
        let bearing = |nodes: &[u32]| nodes.iter().skip(if nodes.len() == 6 { 3 } else { 0 }).all(|&n| row(n).is_some());
        let facets: Vec<usize> = (0..surface.facets.len()).filter(|&f| bearing(&surface.facets[f].0)).collect();
        let on_facets: HashSet<u32> = facets.iter().flat_map(|&f| surface.facets[f].0.iter().copied()).collect();
        let sum = |sizes: &mut [f64; 3], normal: [f64; 3]| sizes.iter_mut().zip(normal).for_each(|(s, n)| *s += n.abs());
        let mut sizes = [0.0; 3];
        let are_nodes = on_facets.iter().filter(|&&n| row(n).is_some()).count() == solid.contact.len();
        if are_nodes {
            for &f in &facets {
                sum(&mut sizes, surface.normal(f));
            }
        } else {
            // The points alone: they lie flattest along the axis of their least extent.
            let extent = |d: usize| axes::range(solid.contact.iter().map(|r| r.x[d])).map_or(0.0, |[lo, hi]| hi - lo);
            sizes = [0, 1, 2].map(|d| -extent(d));
        }
        let along = (0..3).max_by(|&i, &j| sizes[i].total_cmp(&sizes[j])).unwrap_or(2);
        let shown = [[1, 2], [0, 2], [0, 1]][along];
        let mut side = Side { rows: &solid.contact, shown, plane: None };
        if are_nodes {
            let mut nodes: Vec<u32> = on_facets.into_iter().collect();
            nodes.sort_unstable();
            let number: HashMap<u32, u32> = nodes.iter().enumerate().map(|(i, &n)| (n, i as u32)).collect();
            let points = nodes.iter().map(|&n| shown.map(|d| surface.points[n as usize][d])).collect();
            let cells: Vec<Vec<u32>> = facets.iter().map(|&f| surface.facets[f].0.iter().map(|n| number[n]).collect()).collect();
            let body = Body::new(points, cells.iter().map(Vec::as_slice))?;
            let known = |n: u32| row(n).map(|r| solid.contact[r].pressure);
            let mut sums = vec![(0.0, 0.0); nodes.len()];
            for &f in &facets {
                for (n, value) in extended(&surface.facets[f].0, known) {
                    let sum = &mut sums[number[&n] as usize];
                    *sum = (sum.0 + value, sum.1 + 1.0);
                }
            }
            side.plane = Some((body, sums.into_iter().map(|(sum, count)| sum / f64::max(count, 1.0)).collect()));
        }
        Ok(side)
    }

    fn at(&self, row: &SolidContact) -> [f64; 2] {
        self.shown.map(|d| row.x[d])
    }

    fn window(&self) -> [[f64; 2]; 2] {
        window(&self.rows.iter().map(|row| self.at(row)).collect::<Vec<_>>())
    }

    /// Radius of a dot: dots of evenly spread points do not touch.
    fn radius(&self, frame: &Frame) -> f64 {
        let Rect { width, height, .. } = frame.rect;
        (0.33 * (width * height / self.rows.len().max(1) as f64).sqrt()).clamp(0.8, 5.0)
    }

    fn pressure(&self, picture: &mut Picture, frame: &Frame, range: [f64; 2]) {
        let map = ColorMap::Viridis;
        if let Some((body, values)) = &self.plane {
            let [x, y] = body.window();
            let (a, b) = (frame.at(&[x[0], y[1]]), frame.at(&[x[1], y[0]]));
            let place = Rect { x: a[0], y: a[1], width: b[0] - a[0], height: b[1] - a[1] };
            let pixels = |length: f64| (length * DENSITY).ceil().clamp(1.0, 4096.0) as u32;
            picture.image(place, shade::image(body, Values::Nodes(values), map, range, pixels(place.width), pixels(place.height)));
        } else {
            for row in self.rows {
                let [red, green, blue] = map.at(if range[1] > range[0] { (row.pressure - range[0]) / (range[1] - range[0]) } else { 0.5 });
                let fill = Color { red, green, blue, opacity: 1.0 };
                picture.polygon(dot(frame.at(&self.at(row)), self.radius(frame)), fill);
            }
        }
        self.outline(picture, frame, INK);
    }

    fn states(&self, picture: &mut Picture, frame: &Frame) {
        self.outline(picture, frame, GREY);
        for status in STATUSES {
            let of = |row: &&SolidContact| row.status == status;
            let line = |row: &SolidContact| Line { points: dot(frame.at(&self.at(row)), self.radius(frame)), closed: true };
            picture.shape(self.rows.iter().filter(of).map(line).collect(), Some(color(status)), None);
        }
    }

    fn outline(&self, picture: &mut Picture, frame: &Frame, color: Color) {
        if let Some((body, _)) = &self.plane {
            let lines: Vec<_> = body.boundary.iter().map(|e| e.map(|n| frame.at(&body.points[n as usize]))).collect();
            picture.lines(&lines, Stroke::new(color, 0.9));
        }
    }
}

/// The values at the nodes of a facet: those that are known, and at a vertex of a quadratic triangle without one that of the linear
/// function through the midpoints, not below 0.
fn extended(nodes: &[u32], known: impl Fn(u32) -> Option<f64>) -> Vec<(u32, f64)> {
    let value = |i: usize| nodes.get(i).and_then(|&n| known(n)).unwrap_or_default();
    // Midpoint 3 lies between the vertices 0 and 1, 4 between 1 and 2, 5 between 2 and 0.
    let from_midpoints = |i: usize| (value(3 + i) + value(3 + (i + 2) % 3) - value(3 + (i + 1) % 3)).max(0.0);
    nodes.iter().enumerate().map(|(i, &n)| (n, known(n).unwrap_or_else(|| from_midpoints(i)))).collect()
}

/// A disc as a polygon of ten corners.
fn dot([x, y]: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
    let angle = |i: u32| f64::from(i) * std::f64::consts::TAU / 10.0;
    (0..10).map(|i| [x + radius * angle(i).cos(), y + radius * angle(i).sin()]).collect()
}

pub(super) fn draw(panels: &[Panel], options: &Options) -> Result<Picture, PlotError> {
    const NAMES: [&str; 3] = ["x", "y", "z"];
    let quantity = Quantity { name: "contact", symbol: "p_{ν}", unit: "Pa", map: ColorMap::Viridis };
    let unit = options.unit(quantity.unit);
    let mut sides = Vec::new();
    for panel in panels {
        if let Some(solid) = &panel.run.solid {
            sides.push((panel.title, Side::of(solid)?));
        }
    }
    let extents: Vec<[f64; 2]> = sides.iter().map(|(_, s)| axes::range(s.rows.iter().map(|r| r.pressure)).unwrap_or([0.0, 1.0])).collect();
    let mut ranges = extents.clone();
    if options.shared_scale {
        let common = axes::range(ranges.iter().flatten().copied()).unwrap_or([0.0, 1.0]);
        ranges.fill(common);
    }
    let mut plans = Vec::new();
    for ((name, side), [lo, hi]) in sides.iter().zip(&extents) {
        let heading = |what: &str| if name.is_empty() { what.to_owned() } else { format!("{name}: {what}") };
        let plan =
            |what: &str, note: String| Plan { title: heading(what), note, window: sheet::widened(side.window(), 0.04), labels: side.shown.map(|d| NAMES[d]) };
        let count = |status| side.rows.iter().filter(|row| row.status == status).count();
        let states: Vec<String> = STATUSES.iter().map(|&s| format!("{} {}", count(s), s.name())).collect();
        plans.push(plan("pressure", format!("min {}, max {} {unit}", ticks::number(*lo), ticks::number(*hi)).trim_end().to_owned()));
        plans.push(plan("state of the contact points", states.join(", ")));
    }
    let wide = sheet::is_wide(&plans);
    let bars: Vec<Bar> = ranges.iter().zip(&extents).map(|(range, extent)| Bar::new(&quantity, *range, *extent, unit, wide)).collect();
    let room = if wide {
        Room { right: 8.0, below: 50.0, ..Room::default() }
    } else {
        Room { right: bars.iter().map(Bar::room).fold(0.0, f64::max), ..Room::default() }
    };
    let (mut picture, frames) = sheet::lay_out(&title(panels, quantity.name, options), &plans, Room { above: LEGEND, ..room }, options);
    let legend: Vec<(Sign, String)> = STATUSES.map(|s| (Sign::Box(color(s)), s.name().to_owned())).to_vec();
    let width = axes::line_width(&legend);
    let left = 0.5 * (picture.width - width);
    axes::legend(&mut picture, [left, 30.0 + LEGEND + 0.3 * NUMBER], width, &legend);
    for ((pair, (_, side)), bar) in frames.chunks_exact(2).zip(&sides).zip(&bars) {
        bar.draw(&mut picture, pair[0].rect);
        side.pressure(&mut picture, &pair[0], bar.range);
        side.states(&mut picture, &pair[1]);
    }
    Ok(picture)
}
