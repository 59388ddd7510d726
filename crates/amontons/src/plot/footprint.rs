//! The contact sides of a body in space, seen from outside the body: pressure, status, slip direction and wear of each
//! point.

use std::collections::{HashMap, HashSet};

use super::axes::{self, Sign};
use super::body::{PlaneMesh, window};
use super::color::{Color, ColorMap, GREY, INK};
use super::field::{self, ColorBar, DrawnQuantity};
use super::font::typeset;
use super::picture::{OutlinePiece, Picture, Rect, Stroke};
use super::profiles::{STATUSES, color};
use super::run::{DrawnRun, SolidContact, SpaceSnapshot, at_corners};
use super::sheet::{self, Margins, PanelPlan, SheetPanel};
use super::surface::{dot, norm};
use super::{Options, PictureKind, PlotError, RunPanel, shade, title};
use crate::contact::Status;
use crate::output::Lives;
use crate::units::{Measure, Units};

/// Largest number of arrows along the longer side of a panel.
const ARROWS: f64 = 16.0;

/// A side of Γ_C as seen from the front.
struct SeenSide<'a> {
    title: String,
    rows: Vec<&'a SolidContact>,
    /// Slip velocities up to this one are round-off of the displacement.
    slow: f64,
    view: SideView,
    /// The part of the surface whose nodes are the contact points, or `None` if the points are not nodes.
    plane: Option<ViewPlane>,
}

/// The direction from which a side is seen.
#[derive(Clone, Copy)]
struct SideView {
    /// Unit vectors of the two drawn coordinates; the second points upwards.
    along: [[f64; 3]; 2],
    labels: [&'static str; 2],
    /// True if the first coordinate runs to the left.
    mirrored: bool,
}

impl SideView {
    /// The view from this direction, with z upwards, or y, so that the surface is seen from outside and not through the
    /// body.
    fn new(eye: [f64; 3]) -> SideView {
        const NAMES: [&str; 3] = ["x", "y", "z"];
        const ALONG_AXIS: f64 = 0.985;
        let unit = |d: usize| [0, 1, 2].map(|c| if c == d { 1.0 } else { 0.0 });
        let size = norm(eye);
        let eye = eye.map(|c| c / size);
        let axis = (0..3).max_by(|&i, &j| eye[i].abs().total_cmp(&eye[j].abs())).unwrap_or(2);
        if eye[axis].abs() > ALONG_AXIS {
            let shown = [[1, 2], [0, 2], [0, 1]][axis];
            // right × up = eye holds for (y, z) and (x, y) in front of x and z, and for (x, z) in front of −y.
            let right_handed = (eye[axis] > 0.0) == (axis != 1);
            return SideView { along: shown.map(unit), labels: shown.map(|d| NAMES[d]), mirrored: !right_handed };
        }
        let upwards = if eye[2].abs() < 0.9 { unit(2) } else { unit(1) };
        let part = dot(upwards, eye);
        let up = [0, 1, 2].map(|c| upwards[c] - part * eye[c]);
        let up = up.map(|c| c / norm(up));
        let right = [up[1] * eye[2] - up[2] * eye[1], up[2] * eye[0] - up[0] * eye[2], up[0] * eye[1] - up[1] * eye[0]];
        SideView { along: [right, up], labels: ["s_{1}", "s_{2}"], mirrored: false }
    }

    fn at(&self, x: [f64; 3]) -> [f64; 2] {
        self.along.map(|direction| dot(direction, x))
    }
}

/// A part of a surface projected onto a plane.
struct ViewPlane {
    body: PlaneMesh,
    /// Nodes of each facet.
    facets: Vec<Vec<u32>>,
    /// The row of the contact point of each node of the side, if it has one.
    rows: Vec<Option<usize>>,
}

/// A quantity at the contact points.
struct FootprintField {
    quantity: DrawnQuantity,
    /// True for the pressure, which may be drawn as the mean of neighbouring points.
    is_pressure: bool,
    of: fn(&SolidContact) -> f64,
}

impl FootprintField {
    /// The fields of a picture: pressure, and friction work if there is some, or wear.
    fn of(kind: PictureKind, panels: &[RunPanel]) -> Vec<FootprintField> {
        let field = |name, symbol, measure, map, of| {
            let quantity = DrawnQuantity { name, symbol, measure, map };
            FootprintField { quantity, is_pressure: symbol == "p", of }
        };
        if kind == PictureKind::Wear {
            return vec![field("depth worn off", "depth", Measure::Length, ColorMap::Viridis, |row| row.wear)];
        }
        let work = panels.iter().any(|panel| panel.run.worn()[1]);
        let pressure = field("pressure", "p", Measure::Stress, ColorMap::Viridis, |row| row.pressure);
        let work = work.then(|| {
            field("friction work since the start", "work", Measure::SurfaceWork, ColorMap::Inferno, |row| {
                row.friction_work
            })
        });
        std::iter::once(pressure).chain(work).collect()
    }
}

/// The sides of a run, each from the front; a curved side such as a bore from two opposite directions.
fn sides<'a>(panel: &RunPanel, run: &'a DrawnRun, solid: &'a SpaceSnapshot) -> Result<Vec<SeenSide<'a>>, PlotError> {
    let count = solid.contact.iter().map(|row| row.side + 1).max().unwrap_or(0);
    let largest = solid.displacement.iter().map(|u| norm(*u)).fold(0.0, f64::max);
    let slow = if run.t > 0.0 { 1e-12 * largest / run.t } else { 0.0 };
    let mut all = Vec::new();
    for number in 0..count {
        let rows: Vec<&SolidContact> = solid.contact.iter().filter(|row| row.side == number).collect();
        if rows.is_empty() {
            continue;
        }
        let title = format!("{}{}", panel.title, run.side(number)).trim_start().to_owned();
        all.extend(SeenSide::of(title, &rows, solid)?.into_iter().map(|side| SeenSide { slow, ..side }));
    }
    Ok(all)
}

impl<'a> SeenSide<'a> {
    fn of(title: String, rows: &[&'a SolidContact], solid: &SpaceSnapshot) -> Result<Vec<SeenSide<'a>>, PlotError> {
        // Positions have the same bits in both files; adding zero makes −0 equal to 0.
        let key = |p: [f64; 3]| p.map(|x| (x + 0.0).to_bits());
        let numbers: HashMap<[u64; 3], usize> = rows.iter().enumerate().map(|(i, row)| (key(row.x), i)).collect();
        let surface = &solid.surface;
        let row = |n: u32| numbers.get(&key(surface.points[n as usize])).copied();
        // Vertices of quadratic triangles may have no contact point.
        let bearing =
            |nodes: &[u32]| nodes.iter().skip(if nodes.len() == 6 { 3 } else { 0 }).all(|&n| row(n).is_some());
        let facets: Vec<usize> = (0..surface.facets.len()).filter(|&f| bearing(&surface.facets[f].0)).collect();
        let on_facets: HashSet<u32> = facets.iter().flat_map(|&f| surface.facets[f].0.iter().copied()).collect();
        if on_facets.iter().filter(|&&n| row(n).is_some()).count() != rows.len() {
            // Only the points are drawn, seen along the axis of their least extent.
            let extent = |d: usize| axes::range(rows.iter().map(|r| r.x[d])).map_or(0.0, |[lo, hi]| hi - lo);
            let axis = (0..3).min_by(|&i, &j| extent(i).total_cmp(&extent(j))).unwrap_or(2);
            let eye = [0, 1, 2].map(|d| if d == axis { 1.0 } else { 0.0 });
            return Ok(vec![SeenSide { title, rows: rows.to_vec(), slow: 0.0, view: SideView::new(eye), plane: None }]);
        }
        let normals: Vec<[f64; 3]> = facets.iter().map(|&f| surface.normal(f)).collect();
        let sum = normals.iter().fold([0.0; 3], |sum, n| [0, 1, 2].map(|d| sum[d] + n[d]));
        let area: f64 = normals.iter().map(|n| norm(*n)).sum();
        let eyes = if norm(sum) > 0.35 * area {
            vec![sum]
        } else {
            let across = |d: usize| normals.iter().map(|n| n[d].abs()).sum::<f64>();
            let axis = (0..3).max_by(|&i, &j| across(i).total_cmp(&across(j))).unwrap_or(0);
            [1.0, -1.0].map(|sign| [0, 1, 2].map(|d| if d == axis { sign } else { 0.0 })).to_vec()
        };
        let mut all = Vec::new();
        for &eye in &eyes {
            let view = SideView::new(eye);
            let seen: Vec<usize> =
                facets.iter().zip(&normals).filter(|(_, n)| dot(**n, eye) > 0.0).map(|(f, _)| *f).collect();
            let mut nodes: Vec<u32> = seen.iter().flat_map(|&f| surface.facets[f].0.iter().copied()).collect();
            nodes.sort_unstable();
            nodes.dedup();
            let number: HashMap<u32, u32> = nodes.iter().enumerate().map(|(i, &n)| (n, i as u32)).collect();
            let points = nodes.iter().map(|&n| view.at(surface.points[n as usize])).collect();
            let cells: Vec<Vec<u32>> =
                seen.iter().map(|&f| surface.facets[f].0.iter().map(|n| number[n]).collect()).collect();
            let body = PlaneMesh::new(points, cells.iter().map(Vec::as_slice))?;
            let plane = ViewPlane { body, facets: cells, rows: nodes.iter().map(|&n| row(n)).collect() };
            let from = if eyes.len() > 1 {
                format!(", seen from {}{}", if eye.iter().sum::<f64>() > 0.0 { "+" } else { "−" }, axis_name(eye))
            } else {
                String::new()
            };
            let title = format!("{title}{from}");
            all.push(SeenSide { title, rows: rows.to_vec(), slow: 0.0, view, plane: Some(plane) });
        }
        Ok(all)
    }

    /// The visible rows.
    fn seen(&self) -> Vec<&'a SolidContact> {
        match &self.plane {
            Some(plane) => plane.rows.iter().flatten().filter_map(|&row| self.rows.get(row).copied()).collect(),
            None => self.rows.clone(),
        }
    }

    fn at(&self, row: &SolidContact) -> [f64; 2] {
        self.view.at(row.x)
    }

    fn window(&self) -> [[f64; 2]; 2] {
        window(&self.seen().into_iter().map(|row| self.at(row)).collect::<Vec<_>>())
    }

    /// One panel per field, with these extents, and one for the status.
    fn plans(&self, fields: &[FootprintField], extents: &[[f64; 2]], has_states: bool, units: Units) -> Vec<PanelPlan> {
        let heading =
            |what: &str| if self.title.is_empty() { what.to_owned() } else { format!("{}: {what}", self.title) };
        let plan = |what: &str, note: String| PanelPlan {
            title: heading(what),
            note,
            window: sheet::widened(self.window(), 0.04),
            labels: self.view.labels,
            mirrored: self.view.mirrored,
        };
        let field = |(field, extent): (&FootprintField, &[f64; 2])| {
            let note = |lives: Lives| field::extremes(units, *extent, field.quantity.measure, lives);
            plan(field.quantity.name, if field.is_pressure { self.pressures(&note, units) } else { note(Lives::Point) })
        };
        let seen = self.seen();
        let count = |status| seen.iter().filter(|row| row.status == status).count();
        let fastest =
            seen.iter().filter(|row| row.status == Status::Slip).map(|row| norm(row.slip_velocity)).fold(0.0, f64::max);
        let slip = if fastest > self.slow {
            format!("; slip {}", up_to_at_point(fastest, units, Measure::Velocity))
        } else {
            String::new()
        };
        let states = || format!("{}{slip}", STATUSES.map(|s| format!("{} {}", count(s), s.name())).join(", "));
        let states = has_states.then(|| plan("state and direction of slip", states()));
        fields.iter().zip(extents).map(field).chain(states).collect()
    }

    /// The note on pressures. If they are means of neighbouring points, it adds the largest one at a point, which the
    /// summary reports.
    fn pressures(&self, note: &dyn Fn(Lives) -> String, units: Units) -> String {
        if self.rows.iter().all(|row| (row.pressure - row.point_pressure).abs() <= 0.0) {
            return note(Lives::Point);
        }
        let most = self.rows.iter().map(|row| row.point_pressure).fold(0.0, f64::max);
        format!("{}; {}", note(Lives::Mean), up_to_at_point(most, units, Measure::Stress))
    }

    /// Radius of a dot, such that evenly spread dots do not touch.
    fn radius(&self, frame: &SheetPanel) -> f64 {
        let Rect { width, height, .. } = frame.rect;
        (0.33 * (width * height / self.rows.len().max(1) as f64).sqrt()).clamp(0.8, 5.0)
    }

    fn field(&self, picture: &mut Picture, frame: &SheetPanel, field: &FootprintField, bar: &ColorBar) {
        if let Some(plane) = &self.plane {
            let nodal = plane.values(|row| self.rows.get(row).map(|row| (field.of)(row)));
            let values = at_corners(&plane.body.triangles, &plane.body.owners, &nodal, &[], &[]);
            shade::draw(picture, frame, &plane.body, &values, bar, plane.body.window());
        } else {
            for row in &self.rows {
                let [red, green, blue] = bar.color((field.of)(row));
                let fill = Color { red, green, blue, opacity: 1.0 };
                picture.polygon(dot_at(frame.at(&self.at(row)), self.radius(frame)), fill);
            }
        }
        self.outline(picture, frame, INK);
    }

    fn states(&self, picture: &mut Picture, frame: &SheetPanel) {
        self.outline(picture, frame, GREY);
        let seen = self.seen();
        for status in STATUSES {
            let of = |row: &&&SolidContact| row.status == status;
            let line = |row: &&SolidContact| OutlinePiece {
                points: dot_at(frame.at(&self.at(row)), self.radius(frame)),
                closed: true,
            };
            picture.shape(seen.iter().filter(of).map(line).collect(), Some(color(status)), None);
        }
        self.arrows(picture, frame, &seen);
    }

    /// Draws the slip direction of the body on the foundation, at most one arrow per square of a grid.
    fn arrows(&self, picture: &mut Picture, frame: &SheetPanel, seen: &[&SolidContact]) {
        let each = frame.rect.width.max(frame.rect.height) / ARROWS;
        let mut taken = HashSet::new();
        for row in seen.iter().filter(|row| row.status == Status::Slip) {
            let at = frame.at(&self.at(row));
            let square = at.map(|x| (x / each).floor() as i64);
            let [right, up] = self.view.at(row.slip_velocity);
            let (dx, dy) = (if self.view.mirrored { -right } else { right }, -up);
            let size = dx.hypot(dy);
            let speed = norm(row.slip_velocity);
            if speed > self.slow && size > 1e-9 * speed && taken.insert(square) {
                let half = [0.42 * each * dx / size, 0.42 * each * dy / size];
                picture.arrow([at[0] - half[0], at[1] - half[1]], [at[0] + half[0], at[1] + half[1]], INK, 1.2);
            }
        }
    }

    fn outline(&self, picture: &mut Picture, frame: &SheetPanel, color: Color) {
        if let Some(ViewPlane { body, .. }) = &self.plane {
            let lines: Vec<_> = body.boundary.iter().map(|e| e.map(|n| frame.at(&body.points[n as usize]))).collect();
            picture.lines(&lines, Stroke::new(color, 0.9));
        }
    }
}

fn axis_name(eye: [f64; 3]) -> &'static str {
    if eye[0] != 0.0 {
        "x"
    } else if eye[1] != 0.0 {
        "y"
    } else {
        "z"
    }
}

impl ViewPlane {
    /// The values at the nodes, given those at contact points: the mean over the facets of a node.
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

/// The values at the nodes of a facet. At a vertex of a quadratic triangle without a value it is that of the linear
/// function through the midpoints, not below 0.
fn extended(nodes: &[u32], known: impl Fn(u32) -> Option<f64>) -> Vec<(u32, f64)> {
    let value = |i: usize| nodes.get(i).and_then(|&n| known(n)).unwrap_or_default();
    // Midpoint 3 is between the vertices 0 and 1, 4 between 1 and 2, 5 between 2 and 0.
    let from_midpoints = |i: usize| (value(3 + i) + value(3 + (i + 2) % 3) - value(3 + (i + 1) % 3)).max(0.0);
    nodes.iter().enumerate().map(|(i, &n)| (n, known(n).unwrap_or_else(|| from_midpoints(i)))).collect()
}

/// A disc as a polygon with ten corners.
fn dot_at([x, y]: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
    let angle = |i: u32| f64::from(i) * std::f64::consts::TAU / 10.0;
    (0..10).map(|i| [x + radius * angle(i).cos(), y + radius * angle(i).sin()]).collect()
}

pub(super) fn draw(kind: PictureKind, panels: &[RunPanel], options: &Options) -> Result<Picture, PlotError> {
    let units = super::units(panels, options);
    let fields = FootprintField::of(kind, panels);
    let has_states = kind != PictureKind::Wear;
    let mut all = Vec::new();
    for panel in panels {
        if let Some(solid) = &panel.run.solid {
            all.extend(sides(panel, panel.run, solid)?);
        }
    }
    let shown: Vec<(&SeenSide, &FootprintField)> =
        all.iter().flat_map(|side| fields.iter().map(move |field| (side, field))).collect();
    let extents: Vec<[f64; 2]> = shown
        .iter()
        .map(|(side, field)| axes::range(side.rows.iter().map(|row| (field.of)(row))).unwrap_or([0.0, 1.0]))
        .collect();
    let common = |i: usize| {
        axes::range(extents.iter().skip(i % fields.len()).step_by(fields.len()).flatten().copied())
            .unwrap_or([0.0, 1.0])
    };
    let range = |i: usize| if options.shared_scale { common(i) } else { extents[i] };
    let mut rows = Vec::new();
    let legend: Vec<(Sign, String)> = STATUSES.map(|s| (Sign::Box(color(s)), s.name().to_owned())).to_vec();
    let heading = title(panels, if has_states { "contact" } else { "wear" }, options);
    // One row of panels per side and time.
    for (s, (side, extents)) in all.iter().zip(extents.chunks(fields.len().max(1))).enumerate() {
        let plans = side.plans(&fields, extents, has_states, units);
        let wide = sheet::is_wide(&plans);
        let bars: Vec<ColorBar> = fields
            .iter()
            .zip(extents)
            .enumerate()
            .map(|(f, (field, extent))| {
                ColorBar::new(&field.quantity, range(s * fields.len() + f), *extent, units, wide)
            })
            .collect();
        let room = if wide {
            Margins { right: 8.0, below: 50.0, ..Margins::default() }
        } else {
            Margins { right: bars.iter().map(ColorBar::room).fold(0.0, f64::max), ..Margins::default() }
        };
        let (mut row, frames) = sheet::lay_out("", &plans, room, units);
        for ((field, bar), frame) in fields.iter().zip(&bars).zip(&frames) {
            bar.draw(&mut row, frame.rect);
            side.field(&mut row, frame, field, bar);
        }
        if let Some(frame) = frames.get(fields.len()) {
            side.states(&mut row, frame);
        }
        rows.push(row);
    }
    let sheet = Picture::stacked(heading.clone(), rows, Some("sides").filter(|_| panels.len() == 1));
    Ok(axes::headed(sheet, &heading, if has_states { &legend } else { &[] }))
}

/// Note on a maximum: `up to 3 MPa at a contact point`.
fn up_to_at_point(most: f64, units: Units, measure: Measure) -> String {
    Lives::Point.after(&format!("up to {}", typeset(&units.write(most, measure))))
}
