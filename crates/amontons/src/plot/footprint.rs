//! The contact side of a body in space: pressure and state of each contact point, wear and work of friction.

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
use super::{Kind, Options, Panel, PlotError, ticks, title};

/// Pixels of an image to a unit.
const DENSITY: f64 = 2.0;

/// Γ_C seen along the axis that is nearest to its normal.
struct Side<'a> {
    rows: &'a [SolidContact],
    /// The coordinates that are seen.
    shown: [usize; 2],
    /// The part of the surface whose nodes are the contact points; none where the points are not nodes.
    plane: Option<Plane>,
}

/// A part of a surface that is seen along an axis.
struct Plane {
    body: Body,
    /// Nodes of each facet.
    facets: Vec<Vec<u32>>,
    /// The contact point of each node that bears one.
    rows: Vec<Option<usize>>,
}

/// A quantity at the contact points.
struct Field {
    quantity: Quantity,
    of: fn(&SolidContact) -> f64,
}

impl Field {
    /// What a picture shows: of wear and friction work what there is of them.
    fn of(kind: Kind, panels: &[Panel]) -> Vec<Field> {
        let field = |name, symbol, unit, map, of| Field { quantity: Quantity { name, symbol, unit, map }, of };
        if kind != Kind::Wear {
            return vec![field("pressure", "p_{ν}", "Pa", ColorMap::Viridis, |row| row.pressure)];
        }
        let [wear, work] = [0, 1].map(|i| panels.iter().any(|panel| panel.run.worn()[i]));
        let wear = wear.then(|| field("depth worn off", "depth", "m", ColorMap::Viridis, |row| row.wear));
        let work = work.then(|| field("friction work since the start", "work", "J/m^{2}", ColorMap::Inferno, |row| row.friction_work));
        wear.into_iter().chain(work).collect()
    }
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
            side.plane = Some(Plane { body, facets: cells, rows: nodes.iter().map(|&n| row(n)).collect() });
        }
        Ok(side)
    }

    fn at(&self, row: &SolidContact) -> [f64; 2] {
        self.shown.map(|d| row.x[d])
    }

    fn window(&self) -> [[f64; 2]; 2] {
        window(&self.rows.iter().map(|row| self.at(row)).collect::<Vec<_>>())
    }

    /// A panel for each field, which has these extents, and one for the states.
    fn plans(&self, name: &str, fields: &[Field], extents: &[[f64; 2]], has_states: bool, options: &Options) -> Vec<Plan> {
        const NAMES: [&str; 3] = ["x", "y", "z"];
        let heading = |what: &str| if name.is_empty() { what.to_owned() } else { format!("{name}: {what}") };
        let plan =
            |what: &str, note: String| Plan { title: heading(what), note, window: sheet::widened(self.window(), 0.04), labels: self.shown.map(|d| NAMES[d]) };
        let field = |(field, [lo, hi]): (&Field, &[f64; 2])| {
            let note = format!("min {}, max {} {}", ticks::number(*lo), ticks::number(*hi), options.unit(field.quantity.unit));
            plan(field.quantity.name, note.trim_end().to_owned())
        };
        let count = |status| self.rows.iter().filter(|row| row.status == status).count();
        let states = || STATUSES.map(|s| format!("{} {}", count(s), s.name())).join(", ");
        let states = has_states.then(|| plan("state of the contact points", states()));
        fields.iter().zip(extents).map(field).chain(states).collect()
    }

    /// Radius of a dot: dots of evenly spread points do not touch.
    fn radius(&self, frame: &Frame) -> f64 {
        let Rect { width, height, .. } = frame.rect;
        (0.33 * (width * height / self.rows.len().max(1) as f64).sqrt()).clamp(0.8, 5.0)
    }

    fn field(&self, picture: &mut Picture, frame: &Frame, field: &Field, range: [f64; 2]) {
        let map = field.quantity.map;
        if let Some(plane) = &self.plane {
            let values = plane.values(|row| self.rows.get(row).map(field.of));
            let [x, y] = plane.body.window();
            let (a, b) = (frame.at(&[x[0], y[1]]), frame.at(&[x[1], y[0]]));
            let place = Rect { x: a[0], y: a[1], width: b[0] - a[0], height: b[1] - a[1] };
            let pixels = |length: f64| (length * DENSITY).ceil().clamp(1.0, 4096.0) as u32;
            picture.image(place, shade::image(&plane.body, Values::Nodes(&values), map, range, pixels(place.width), pixels(place.height)));
        } else {
            for row in self.rows {
                let value = (field.of)(row);
                let [red, green, blue] = map.at(if range[1] > range[0] { (value - range[0]) / (range[1] - range[0]) } else { 0.5 });
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
        if let Some(Plane { body, .. }) = &self.plane {
            let lines: Vec<_> = body.boundary.iter().map(|e| e.map(|n| frame.at(&body.points[n as usize]))).collect();
            picture.lines(&lines, Stroke::new(color, 0.9));
        }
    }
}

impl Plane {
    /// The values at the nodes, of which those at contact points are known: the mean of what the facets say.
    fn values(&self, known: impl Fn(usize) -> Option<f64>) -> Vec<f64> {
        let at = |n: u32| self.rows.get(n as usize).copied().flatten().and_then(&known);
        let mut sums = vec![(0.0, 0.0); self.rows.len()];
        for (n, value) in self.facets.iter().flat_map(|facet| extended(facet, at)) {
            if let Some((sum, count)) = sums.get_mut(n as usize) {
                (*sum, *count) = (*sum + value, *count + 1.0);
            }
        }
        sums.into_iter().map(|(sum, count)| sum / f64::max(count, 1.0)).collect()
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

pub(super) fn draw(kind: Kind, panels: &[Panel], options: &Options) -> Result<Picture, PlotError> {
    let fields = Field::of(kind, panels);
    let has_states = kind != Kind::Wear;
    let mut sides = Vec::new();
    for panel in panels {
        if let Some(solid) = &panel.run.solid {
            sides.push((panel.title, Side::of(solid)?));
        }
    }
    let shown: Vec<(&Side, &Field)> = sides.iter().flat_map(|(_, side)| fields.iter().map(move |field| (side, field))).collect();
    let extents: Vec<[f64; 2]> = shown.iter().map(|(side, field)| axes::range(side.rows.iter().map(field.of)).unwrap_or([0.0, 1.0])).collect();
    let common = |i: usize| axes::range(extents.iter().skip(i % fields.len()).step_by(fields.len()).flatten().copied()).unwrap_or([0.0, 1.0]);
    let range = |i: usize| if options.shared_scale { common(i) } else { extents[i] };
    let titled = sides.iter().map(|(name, side)| (*name, side)).zip(extents.chunks(fields.len().max(1)));
    let plans: Vec<Plan> = titled.flat_map(|((name, side), extents)| side.plans(name, &fields, extents, has_states, options)).collect();
    let wide = sheet::is_wide(&plans);
    let bar = |(i, (_, field)): (usize, &(&Side, &Field))| Bar::new(&field.quantity, range(i), extents[i], options.unit(field.quantity.unit), wide);
    let bars: Vec<Bar> = shown.iter().enumerate().map(bar).collect();
    let room = if wide {
        Room { right: 8.0, below: 50.0, ..Room::default() }
    } else {
        Room { right: bars.iter().map(Bar::room).fold(0.0, f64::max), ..Room::default() }
    };
    let above = if has_states { LEGEND } else { 0.0 };
    let what = if has_states { "contact" } else { "wear" };
    let (mut picture, frames) = sheet::lay_out(&title(panels, what, options), &plans, Room { above, ..room }, options);
    if has_states {
        let legend: Vec<(Sign, String)> = STATUSES.map(|s| (Sign::Box(color(s)), s.name().to_owned())).to_vec();
        let width = axes::line_width(&legend);
        let left = 0.5 * (picture.width - width);
        axes::legend(&mut picture, [left, 30.0 + LEGEND + 0.3 * NUMBER], width, &legend);
    }
    let mut frames = frames.iter();
    for ((i, (side, field)), bar) in shown.iter().enumerate().zip(&bars) {
        let Some(frame) = frames.next() else { break };
        bar.draw(&mut picture, frame.rect);
        side.field(&mut picture, frame, field, bar.range);
        if has_states && (i + 1) % fields.len() == 0 {
            frames.next().into_iter().for_each(|frame| side.states(&mut picture, frame));
        }
    }
    Ok(picture)
}
