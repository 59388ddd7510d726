//! Histories: energies, works, contact, heat and wear over time.

use super::charts::{self, Area, Chart, Column, Series};
use super::color::LINES;
use super::picture::{Picture, Stroke};
use super::profiles::{STATUSES, color};
use super::run::{History, Run};
use super::{Options, Panel, PlotError, axes, heading};
use crate::units::{Measure, Units};

pub(super) fn draw(panels: &[Panel], options: &Options) -> Result<Picture, PlotError> {
    let units = super::units(panels, options);
    let mut columns = Vec::new();
    for panel in panels {
        let history = &panel.run.history;
        let times = history.get("t").map_or(&[][..], Vec::as_slice);
        if let Some((name, column)) = history.iter().find(|(_, column)| column.len() != times.len()) {
            return Err(PlotError::Data(format!("the column {name} of the history has {} rows, expected {}", column.len(), times.len())));
        }
        let [first, last] = axes::range(times.iter().copied()).unwrap_or([0.0, 1.0]);
        // A run starts at 0, one step before its first row.
        let x = if first > 0.0 { [0.0, last] } else { axes::padded([first, last], 0.0) };
        let charts = chart_list(panel.run, units);
        columns.push(Column {
            title: panel.title.to_owned(),
            x,
            x_label: "time t".to_owned(),
            x_units: units,
            x_measure: Measure::Time,
            bands: Vec::new(),
            charts,
        });
    }
    if let [column] = &mut columns[..] {
        let half = column.charts.len().div_ceil(2);
        let right = Column { charts: column.charts.split_off(half), ..column.clone() };
        columns.push(right);
    }
    Ok(charts::draw(&heading(panels, "history"), &[], &columns, options.shared_scale))
}

/// Lines of columns by their names and labels, those that are not zero throughout.
fn lines(run: &Run, columns: &[(&str, &str)]) -> Vec<Series> {
    // Small quantities lie upon each other near zero: the later lines have gaps through which the earlier ones show.
    let dashes: [&[f64]; 5] = [&[], &[], &[], &[7.0, 4.0], &[2.0, 3.0]];
    let known = columns.iter().zip(LINES.into_iter().zip(dashes)).filter(|((name, _), _)| run.has(name));
    let series = known.map(|((name, label), (color, dashes))| Series {
        label: (*label).to_owned(),
        stroke: Stroke::new(color, 1.6).dashed(dashes),
        pieces: vec![points(&run.history, name)],
    });
    series.collect()
}

/// Charts of the quantities of the run; the closing error of a balance is always among them.
fn chart_list(run: &Run, units: Units) -> Vec<Chart> {
    let history = &run.history;
    let chart =
        |quantity: &str, measure: Measure, series: Vec<Series>| Chart { quantity: quantity.to_owned(), units, measure, areas: Vec::new(), series, zero: true };
    let of = |quantity: &str, measure: Measure, columns: &[(&str, &str)]| chart(quantity, measure, lines(run, columns));
    let counts = STATUSES.map(|s| history.get(s.name()));
    let has_contact = counts.iter().flatten().any(|count| count.iter().any(|&c| c > 0.0));
    let works = [
        ("load_work", "loads"),
        ("thermal_work", "thermal"),
        ("viscous_dissipation", "viscous"),
        ("friction_dissipation", "friction"),
        ("scheme_dissipation", "time scheme"),
    ];
    let mut charts = vec![
        of("energies", Measure::Energy, &[("kinetic", "kinetic"), ("elastic", "elastic"), ("contact_energy", "contact")]),
        of("work and dissipation since the start", Measure::Energy, &works),
    ];
    charts.retain(|chart| !chart.series.is_empty());
    let (column, balance) = if run.has_mechanics() { ("closing_error", "energy") } else { ("heat_closing_error", "heat") };
    if history.contains_key(column) {
        let series = vec![Series { label: String::new(), stroke: Stroke::new(LINES[0], 1.6), pieces: vec![points(history, column)] }];
        charts.push(chart(&format!("closing error of the {balance} balance"), Measure::Energy, series));
    }
    if has_contact {
        let force = of("contact force", Measure::Force, &[("contact_force_x", "x"), ("contact_force_y", "y"), ("contact_force_z", "z")]);
        charts.extend(Some(force).filter(|chart| !chart.series.is_empty()));
        charts.push(status_chart(history, units));
    }
    if run.has_heat() {
        let columns = [("heat_content", "content"), ("heat_contact", "left through Γ_{C} since the start"), ("heat_foundation", "content of the foundation")];
        charts.extend(Some(of("heat", Measure::Energy, &columns)).filter(|chart| !chart.series.is_empty()));
    }
    if has_contact {
        charts.extend(surface_charts(run, &chart));
    }
    charts
}

/// Friction power, temperature of the foundation, area and wear over time, if the run has them.
fn surface_charts(run: &Run, chart: &dyn Fn(&str, Measure, Vec<Series>) -> Chart) -> Vec<Chart> {
    let history = &run.history;
    let line = |label: &str, color: usize, pieces: Vec<[f64; 2]>| Series {
        label: label.to_owned(),
        stroke: Stroke::new(LINES[color % LINES.len()], 1.6),
        pieces: vec![pieces],
    };
    let mut charts = Vec::new();
    if run.has("friction_dissipation") {
        // The mean over each step, from the works since the start.
        let mut before = [0.0; 2];
        let power = points(history, "friction_dissipation").into_iter().map(|now| {
            let mean = (now[1] - before[1]) / (now[0] - before[0]);
            before = now;
            [now[0], if mean.is_finite() { mean } else { 0.0 }]
        });
        charts.push(chart("power of friction", Measure::Power, vec![line("", 1, power.collect())]));
    }
    let foundation = |name: &&String| name.starts_with("foundation_temperature");
    let lines = history.keys().filter(foundation).enumerate();
    let lines: Vec<Series> = lines.map(|(i, name)| line(name.split_once('@').map_or("", |(_, side)| side), i, points(history, name))).collect();
    if !lines.is_empty() {
        charts.push(chart("temperature of the foundation", Measure::Temperature, lines));
    }
    for (name, quantity, measure) in [
        ("contact_area", "area of contact", Measure::Area),
        ("wear_max", "largest depth worn off", Measure::Length),
        ("wear_volume", "volume worn off", Measure::Volume),
    ] {
        if run.has(name) {
            charts.push(chart(quantity, measure, vec![line("", 0, points(history, name))]));
        }
    }
    charts
}

fn points(history: &History, name: &str) -> Vec<[f64; 2]> {
    let column = |name: &str| history.get(name).map_or(&[][..], Vec::as_slice).iter().copied();
    column("t").zip(column(name)).map(|(t, v)| [t, v]).collect()
}

/// The numbers of open, sticking and slipping points, one upon the other.
fn status_chart(history: &History, units: Units) -> Chart {
    let times = points(history, "t");
    let mut below: Vec<[f64; 2]> = times.iter().map(|p| [p[0], 0.0]).collect();
    let mut areas = Vec::new();
    // Sticking and slipping points first: together they are the closed part.
    for status in [STATUSES[1], STATUSES[2], STATUSES[0]] {
        let count = points(history, status.name());
        let above: Vec<[f64; 2]> = below.iter().zip(count).map(|(b, c)| [b[0], b[1] + c[1]]).collect();
        let polygon = below.iter().copied().chain(above.iter().rev().copied()).collect();
        areas.push(Area { label: status.name().to_owned(), color: color(status), polygons: vec![polygon] });
        below = above;
    }
    Chart { quantity: "contact points".to_owned(), units, measure: Measure::Number, areas, series: Vec::new(), zero: true }
}
