//! Profiles along Γ_C.

use super::axes::Sign;
use super::charts::{self, Area, Chart, Column, Series};
use super::color::{BLUE, Color, GREEN, INK, LINES, ORANGE, PURPLE, VERMILION};
use super::picture::{Picture, Stroke};
use super::run::{self, Part, Stop};
use super::{Kind, Options, Panel, PlotError, title};
use crate::contact::Status;

/// Colour of a status.
pub(super) fn color(status: Status) -> Color {
    match status {
        Status::Open => Color::new(0xD9_D9_D9),
        Status::Stick => LINES[0],
        Status::Slip => ORANGE,
    }
}

pub(super) const STATUSES: [Status; 3] = [Status::Open, Status::Stick, Status::Slip];

pub(super) fn draw(kind: Kind, panels: &[Panel], options: &Options) -> Result<Picture, PlotError> {
    let mut columns = Vec::new();
    for panel in panels {
        let Some(snapshot) = &panel.run.snapshot else { continue };
        let parts = run::along(&snapshot.body, &panel.run.contact)?;
        columns.push(Column {
            title: panel.title.to_owned(),
            x: [0.0, parts.last().map_or(1.0, |part| part.s[1])],
            x_label: "arc length s along Γ_{C}".to_owned(),
            x_unit: options.unit("m").to_owned(),
            bands: bands(&parts),
            charts: if kind == Kind::Wear { wear_list(&parts, panel.run.worn(), options) } else { chart_list(&parts, options) },
        });
    }
    if let ([column], Kind::Contact) = (&mut columns[..], kind) {
        let right = Column { charts: column.charts.split_off(3), ..column.clone() };
        columns.push(right);
    }
    let legend: Vec<(Sign, String)> = STATUSES.map(|s| (Sign::Box(color(s)), s.name().to_owned())).to_vec();
    Ok(charts::draw(&title(panels, if kind == Kind::Wear { "wear" } else { "contact" }, options), &legend, &columns, options.shared_scale))
}

/// Intervals of the same status, each reaching half way to the next point.
fn bands(parts: &[Part]) -> Vec<([f64; 2], Color)> {
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

/// A line along Γ_C.
fn line(parts: &[Part], label: &str, color: Color, value: &dyn Fn(&Stop) -> f64) -> Series {
    let pieces = parts.iter().map(|part| part.stops.iter().map(|stop| [stop.s, value(stop)]).collect()).collect();
    Series { label: label.to_owned(), stroke: Stroke::new(color, 1.6), pieces }
}

/// A chart of one line.
fn chart(quantity: &str, unit: &str, zero: bool, series: Series) -> Chart {
    Chart { quantity: quantity.to_owned(), unit: unit.to_owned(), areas: Vec::new(), series: vec![series], zero }
}

fn wear_list(parts: &[Part], [wear, work]: [bool; 2], options: &Options) -> Vec<Chart> {
    let wear = wear.then(|| chart("depth worn off", options.unit("m"), true, line(parts, "", BLUE, &|s| s.row.wear)));
    let work = work.then(|| chart("friction work since the start", options.unit("J/m^{2}"), true, line(parts, "", VERMILION, &|s| s.row.friction_work)));
    wear.into_iter().chain(work).collect()
}

fn chart_list(parts: &[Part], options: &Options) -> Vec<Chart> {
    let line = |label: &str, color: Color, value: &dyn Fn(&Stop) -> f64| line(parts, label, color, value);
    let along = |v: [f64; 2], stop: &Stop| v[0] * stop.tangent[0] + v[1] * stop.tangent[1];
    let chart = |quantity: &str, unit: &str, zero: bool, series: Series| chart(quantity, options.unit(unit), zero, series);
    let mut friction = chart("friction traction", "Pa", true, line("σ_{τ} along s", VERMILION, &|s| along(s.row.traction, s)));
    if parts.iter().flat_map(|part| &part.stops).all(|stop| stop.row.bound.is_some()) {
        let edge = |part: &Part, sign: f64| part.stops.iter().map(move |s| [s.s, sign * s.row.bound.unwrap_or(0.0)]).collect::<Vec<_>>();
        let polygon = |part: &Part| edge(part, 1.0).into_iter().chain(edge(part, -1.0).into_iter().rev()).collect();
        friction.areas.push(Area { label: "within ±p_{τ}".to_owned(), color: INK.with_opacity(0.13), polygons: parts.iter().map(polygon).collect() });
    }
    let mut charts = vec![
        chart("pressure p_{ν}", "Pa", true, line("", BLUE, &|s| s.row.pressure)),
        friction,
        chart("slip velocity along s", "m/s", true, line("", VERMILION, &|s| along(s.row.slip_velocity, s))),
        chart("gap g − u_{ν}", "m", true, line("", BLUE, &|s| -s.row.penetration)),
    ];
    if parts.iter().flat_map(|part| &part.stops).all(|stop| stop.row.temperature.is_finite()) {
        charts.push(chart("temperature θ", "K", false, line("", PURPLE, &|s| s.row.temperature)));
        charts.push(chart("heat flux q·ν out of the body", "W/m^{2}", true, line("", GREEN, &|s| s.row.heat_flux)));
    }
    charts
}
