//! Profiles along Γ_C.

use super::axes::Sign;
use super::charts::{self, Area, Chart, ChartColumn, Series};
use super::color::{BLUE, Color, GREEN, INK, LINES, ORANGE, PURPLE, VERMILION};
use super::font::typeset;
use super::picture::{Picture, Stroke};
use super::run::{self, ContactPart, ContactRow, PathPoint};
use super::{Options, PictureKind, PlotError, RunPanel, title};
use crate::contact::Status;
use crate::output::Lives;
use crate::units::{Extent, Measure, Units};

/// Colour of a status.
pub(super) fn color(status: Status) -> Color {
    match status {
        Status::Open => Color::new(0xD9_D9_D9),
        Status::Stick => LINES[0],
        Status::Slip => ORANGE,
    }
}

pub(super) const STATUSES: [Status; 3] = [Status::Open, Status::Stick, Status::Slip];

/// Draws one block of charts per contact side, with one column per panel.
pub(super) fn draw(kind: PictureKind, panels: &[RunPanel], options: &Options) -> Result<Picture, PlotError> {
    let units = super::units(panels, options);
    let sides = panels.iter().flat_map(|panel| &panel.run.contact).map(|row| row.side + 1).max().unwrap_or(1);
    let what = if kind == PictureKind::Wear { "wear" } else { "contact" };
    let has = ProfileContents::of(panels);
    let legend: Vec<(Sign, String)> = STATUSES.map(|s| (Sign::Box(color(s)), s.name().to_owned())).to_vec();
    let mut blocks = Vec::new();
    for side in 0..sides {
        let mut columns = Vec::new();
        for panel in panels {
            let Some(snapshot) = &panel.run.snapshot else { continue };
            let rows: Vec<&ContactRow> = panel.run.contact.iter().filter(|row| row.side == side).collect();
            if rows.is_empty() {
                continue;
            }
            let parts = run::along(&panel.run.bearing(&snapshot.body, side), &rows)?;
            columns.push(ChartColumn {
                title: panel.title.to_owned(),
                x: [0.0, parts.last().map_or(1.0, |part| part.s[1])],
                x_label: "arc length s along Γ_{C}".to_owned(),
                x_units: units,
                x_measure: Measure::Length,
                bands: bands(&parts),
                charts: if kind == PictureKind::Wear {
                    vec![wear(&parts, units)]
                } else {
                    chart_list(&parts, units, has)
                },
            });
        }
        if let ([column], PictureKind::Contact) = (&mut columns[..], kind) {
            let half = column.charts.len().div_ceil(2);
            let right = ChartColumn { charts: column.charts.split_off(half), ..column.clone() };
            columns.push(right);
        }
        if !columns.is_empty() {
            let name = panels.first().map_or_else(String::new, |panel| panel.run.side(side));
            let legend = if kind == PictureKind::Wear { &[][..] } else { &legend };
            blocks.push(charts::draw(
                &title(panels, &format!("{what}{name}"), options),
                legend,
                &columns,
                options.shared_scale,
            ));
        }
    }
    Ok(Picture::stacked(title(panels, what, options), blocks, Some("sides").filter(|_| panels.len() == 1)))
}

/// Optional quantities on Γ_C in any of the panels, besides pressure and gap.
#[derive(Clone, Copy)]
struct ProfileContents {
    friction: FrictionDirections,
    heat: bool,
    work: bool,
    round_off: RoundOff,
}

/// The directions of friction or slip.
#[derive(Clone, Copy, PartialEq, Eq)]
enum FrictionDirections {
    Without,
    Along,
    /// Also out of the plane or about the axis of revolution.
    Across,
}

/// Limits of round-off of the displacement; values up to them are drawn as zero.
#[derive(Clone, Copy)]
struct RoundOff {
    length: f64,
    velocity: f64,
    work: f64,
}

impl RoundOff {
    fn of(panels: &[RunPanel]) -> RoundOff {
        let length = 1e-12 * largest_displacement(panels);
        let times = panels.iter().map(|panel| panel.run.t).filter(|t| *t > 0.0);
        let pressures = panels.iter().flat_map(|panel| &panel.run.contact).map(|row| row.pressure.abs());
        let pressure = pressures.fold(0.0, f64::max);
        RoundOff { length, velocity: length / times.fold(f64::INFINITY, f64::min), work: length * pressure }
    }
}

impl ProfileContents {
    fn of(panels: &[RunPanel]) -> ProfileContents {
        let round_off = RoundOff::of(panels);
        let any = |f: &dyn Fn(&ContactRow) -> bool| panels.iter().flat_map(|panel| &panel.run.contact).any(f);
        let friction = if any(&|row| row.traction[2] != 0.0 || row.slip_velocity[2] != 0.0) {
            FrictionDirections::Across
        } else if any(&|row| row.traction.iter().any(|q| *q != 0.0) || row.bound.is_some_and(|b| b > 0.0)) {
            FrictionDirections::Along
        } else {
            FrictionDirections::Without
        };
        ProfileContents {
            friction,
            heat: panels.iter().any(|panel| panel.run.has_heat()),
            work: any(&|row| row.friction_work.abs() > round_off.work),
            round_off,
        }
    }
}

/// The largest ‖u‖ in all panels.
fn largest_displacement(panels: &[RunPanel]) -> f64 {
    let snapshots = panels.iter().filter_map(|panel| panel.run.snapshot.as_ref());
    snapshots.flat_map(|s| &s.displacement).map(|u| u[0].hypot(u[1])).fold(0.0, f64::max)
}

/// Intervals of equal status, each extending half way to the next point.
fn bands(parts: &[ContactPart]) -> Vec<([f64; 2], Color)> {
    let mut bands: Vec<([f64; 2], Color)> = Vec::new();
    for part in parts {
        let mut from = part.s[0];
        for (i, stop) in part.stops.iter().enumerate() {
            let to = part.stops.get(i + 1).map_or(part.s[1], |next| 0.5 * (stop.s + next.s));
            let color = color(stop.row.status);
            match bands.last_mut().filter(|band| band.1 == color && band.0[1] >= from) {
                Some(band) => band.0[1] = to,
                None => bands.push(([from, to], color)),
            }
            from = to;
        }
    }
    bands
}

/// The value, or zero if it is round-off.
fn but_zero(value: f64, round_off: f64) -> f64 {
    if value.abs() > round_off { value } else { 0.0 }
}

/// A line along Γ_C, interrupted where the value is NaN.
fn line(parts: &[ContactPart], label: &str, color: Color, value: &dyn Fn(&PathPoint) -> f64) -> Series {
    let of = |part: &ContactPart| -> Vec<[f64; 2]> { part.stops.iter().map(|stop| [stop.s, value(stop)]).collect() };
    let unbroken = |piece: Vec<[f64; 2]>| -> Vec<Vec<[f64; 2]>> {
        piece.split(|point| point[1].is_nan()).filter(|run| !run.is_empty()).map(<[_]>::to_vec).collect()
    };
    let pieces = parts.iter().flat_map(|part| unbroken(of(part))).collect();
    Series { label: label.to_owned(), stroke: Stroke::new(color, 1.6), pieces }
}

/// A chart of one line.
fn chart(quantity: &str, units: Units, measure: Measure, zero: bool, series: Series) -> Chart {
    Chart { quantity: quantity.to_owned(), units, measure, areas: Vec::new(), series: vec![series], zero }
}

fn wear(parts: &[ContactPart], units: Units) -> Chart {
    chart("depth worn off", units, Measure::Length, true, line(parts, "", BLUE, &|s| s.row.wear))
}

/// Temperature θ of the side and of the opposite surface.
fn temperatures(parts: &[ContactPart], units: Units) -> Chart {
    let opposite = line(parts, "of what it faces", ORANGE, &|s| s.row.opposite_temperature);
    let label = if opposite.pieces.is_empty() { "" } else { "of the side" };
    let own = line(parts, label, PURPLE, &|s| s.row.temperature);
    let mut chart = chart("temperature θ", units, Measure::Temperature, false, own);
    if !opposite.pieces.is_empty() {
        chart.series.push(opposite);
    }
    chart
}

/// The pressure. If it is the mean of neighbouring points, the label adds the largest one at a point, which the summary
/// reports.
fn pressure(parts: &[ContactPart], units: Units) -> Chart {
    let stops = parts.iter().flat_map(|part| &part.stops);
    let is_mean = stops.clone().any(|stop| (stop.row.pressure - stop.row.point_pressure).abs() > 0.0);
    let most = stops.map(|stop| stop.row.point_pressure).fold(0.0, f64::max);
    let label = if is_mean {
        let most = format!("up to {}", typeset(&units.write(most, Measure::Stress)));
        format!("{}; {}", Lives::Mean.words(), Lives::Point.after(&most))
    } else {
        String::new()
    };
    chart("pressure p", units, Measure::Stress, true, line(parts, &label, BLUE, &|s| s.row.pressure))
}

/// Friction traction with its cone, and slip velocity, along Γ_C and, if present, out of the plane.
fn friction(parts: &[ContactPart], units: Units, has: ProfileContents) -> [Chart; 2] {
    let along = |v: [f64; 3], stop: &PathPoint| v[0] * stop.tangent[0] + v[1] * stop.tangent[1];
    let out = if units.extent == Extent::Revolution { "about the axis" } else { "out of the plane" };
    let series = line(parts, "σ_{τ} along s", VERMILION, &|s| along(s.row.traction, s));
    let mut friction = chart("friction traction", units, Measure::Stress, true, series);
    if parts.iter().flat_map(|part| &part.stops).all(|stop| stop.row.bound.is_some()) {
        let edge = |part: &ContactPart, sign: f64| {
            part.stops.iter().map(move |s| [s.s, sign * s.row.bound.unwrap_or(0.0)]).collect::<Vec<_>>()
        };
        let polygon =
            |part: &ContactPart| edge(part, 1.0).into_iter().chain(edge(part, -1.0).into_iter().rev()).collect();
        let polygons = parts.iter().map(polygon).collect();
        friction.areas.push(Area {
            label: "friction cone ‖σ_{τ}‖ ≤ p_{τ}".to_owned(),
            color: INK.with_opacity(0.13),
            polygons,
        });
    }
    let is_across = has.friction == FrictionDirections::Across;
    let [name, label] = if is_across { ["slip velocity", "along s"] } else { ["slip velocity along s", ""] };
    let speed = |v: f64| but_zero(v, has.round_off.velocity);
    let slip = line(parts, label, VERMILION, &|s| speed(along(s.row.slip_velocity, s)));
    let mut slip = chart(name, units, Measure::Velocity, true, slip);
    if is_across {
        friction.series.push(line(parts, &format!("σ_{{τ}} {out}"), BLUE, &|s| s.row.traction[2]));
        slip.series.push(line(parts, out, BLUE, &|s| speed(s.row.slip_velocity[2])));
    }
    [friction, slip]
}

fn chart_list(parts: &[ContactPart], units: Units, has: ProfileContents) -> Vec<Chart> {
    let one = |quantity: &str, measure, zero, color, value: &dyn Fn(&PathPoint) -> f64| {
        chart(quantity, units, measure, zero, line(parts, "", color, value))
    };
    let mut charts = vec![pressure(parts, units)];
    if has.friction != FrictionDirections::Without {
        charts.extend(friction(parts, units, has));
    }
    charts.push(one("gap g − u_{ν}", Measure::Length, true, BLUE, &|s| {
        but_zero(0.0 - s.row.penetration, has.round_off.length)
    }));
    if has.heat {
        charts.push(temperatures(parts, units));
        charts.push(one("heat flux q·ν out of the body", Measure::HeatFlux, true, GREEN, &|s| s.row.heat_flux));
    }
    if has.work {
        charts.push(one("friction work since the start", Measure::SurfaceWork, true, VERMILION, &|s| {
            but_zero(s.row.friction_work, has.round_off.work)
        }));
    }
    charts
}
