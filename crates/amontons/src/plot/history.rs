//! Histories: energies, works, contact, heat and wear over time.

use super::charts::{self, Area, Chart, Column, Series};
use super::color::LINES;
use super::picture::{Picture, Stroke};
use super::profiles::{STATUSES, color};
use super::run::{History, Run};
use super::{Options, Panel, PlotError, axes, heading};

pub(super) fn draw(panels: &[Panel], options: &Options) -> Result<Picture, PlotError> {
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
        let charts = chart_list(panel.run, options);
        columns.push(Column {
            title: panel.title.to_owned(),
            x,
            x_label: "time t".to_owned(),
            x_unit: options.unit("s").to_owned(),
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

/// A unit in d dimensions: what is integrated over a plane body is per unit of thickness.
fn per_thickness(unit: &str, dimension: usize) -> String {
    match dimension {
        1 => format!("{unit}/m^{{2}}"),
        2 => format!("{unit}/m"),
        _ => unit.to_owned(),
    }
}

fn chart_list(run: &Run, options: &Options) -> Vec<Chart> {
    let history = &run.history;
    let unit = |unit: &str| if options.dimensionless { String::new() } else { per_thickness(unit, run.dimension) };
    let chart = |quantity: &str, unit: String, columns: &[(&str, &str)]| {
        let known = columns.iter().filter(|(name, _)| history.contains_key(*name));
        // Small quantities lie upon each other near zero: the later lines have gaps through which the earlier ones show.
        let dashes: [&[f64]; 5] = [&[], &[], &[], &[7.0, 4.0], &[2.0, 3.0]];
        let series = known.zip(LINES.into_iter().zip(dashes)).map(|((name, label), (color, dashes))| Series {
            label: (*label).to_owned(),
            stroke: Stroke::new(color, 1.6).dashed(dashes),
            pieces: vec![points(history, name)],
        });
        Chart { quantity: quantity.to_owned(), unit, areas: Vec::new(), series: series.collect(), zero: true }
    };
    let counts = STATUSES.map(|s| history.get(s.name()));
    let has_contact = counts.iter().flatten().any(|count| count.iter().any(|&c| c > 0.0));
    let contact_energy: &[(&str, &str)] = if has_contact { &[("contact_energy", "contact")] } else { &[] };
    let energies = [&[("kinetic", "kinetic"), ("elastic", "elastic")], contact_energy].concat();
    let mut charts = vec![
        chart("energies", unit("J"), &energies),
        chart(
            "work and dissipation since the start",
            unit("J"),
            &[
                ("load_work", "loads"),
                ("thermal_work", "thermal"),
                ("viscous_dissipation", "viscous"),
                ("friction_dissipation", "friction"),
                ("scheme_dissipation", "time scheme"),
            ],
        ),
        chart("closing error of the energy balance", unit("J"), &[("closing_error", "")]),
    ];
    if has_contact {
        charts.push(chart("contact force", unit("N"), &[("contact_force_x", "x"), ("contact_force_y", "y"), ("contact_force_z", "z")]));
        charts.push(status_chart(history));
        let is_lumped = has(history, "heat_foundation");
        let of_foundation = if is_lumped { &[("heat_foundation", "content of the foundation")][..] } else { &[] };
        let heat = [&[("heat_content", "content"), ("heat_contact", "left through Γ_{C} since the start")], of_foundation].concat();
        charts.push(chart("heat", unit("J"), &heat));
        charts.extend(surface_charts(run, options));
    } else {
        charts.push(chart("heat", unit("J"), &[("heat_content", "content")]));
    }
    charts
}

/// Whether a column has values other than zero.
fn has(history: &History, name: &str) -> bool {
    history.get(name).is_some_and(|column| column.iter().any(|v| *v != 0.0))
}

/// What friction, wear and the heat of the foundation are over time, where there is something to show.
fn surface_charts(run: &Run, options: &Options) -> Vec<Chart> {
    let history = &run.history;
    let chart = |quantity: &str, unit: &str, series: Vec<Series>| Chart {
        quantity: quantity.to_owned(),
        unit: if options.dimensionless { String::new() } else { unit.to_owned() },
        areas: Vec::new(),
        series,
        zero: true,
    };
    let line = |label: &str, color: usize, pieces: Vec<[f64; 2]>| Series {
        label: label.to_owned(),
        stroke: Stroke::new(LINES[color % LINES.len()], 1.6),
        pieces: vec![pieces],
    };
    let [area, volume] = match run.dimension {
        1 => ["", "m"],
        2 => ["m", "m^{2}"],
        _ => ["m^{2}", "m^{3}"],
    };
    let mut charts = Vec::new();
    if has(history, "friction_dissipation") {
        // The mean over each step, from the works since the start.
        let mut before = [0.0; 2];
        let power = points(history, "friction_dissipation").into_iter().map(|now| {
            let mean = (now[1] - before[1]) / (now[0] - before[0]);
            before = now;
            [now[0], if mean.is_finite() { mean } else { 0.0 }]
        });
        charts.push(chart("power of friction", &per_thickness("W", run.dimension), vec![line("", 1, power.collect())]));
    }
    let foundation = |name: &&String| name.starts_with("foundation_temperature");
    let lines = history.keys().filter(foundation).enumerate();
    let lines: Vec<Series> = lines.map(|(i, name)| line(name.split_once('@').map_or("", |(_, side)| side), i, points(history, name))).collect();
    if !lines.is_empty() {
        charts.push(chart("temperature of the foundation", "K", lines));
    }
    for (name, quantity, unit) in
        [("contact_area", "area of contact", area), ("wear_max", "largest depth worn off", "m"), ("wear_volume", "volume worn off", volume)]
    {
        if has(history, name) {
            charts.push(chart(quantity, unit, vec![line("", 0, points(history, name))]));
        }
    }
    charts
}

fn points(history: &History, name: &str) -> Vec<[f64; 2]> {
    let column = |name: &str| history.get(name).map_or(&[][..], Vec::as_slice).iter().copied();
    column("t").zip(column(name)).map(|(t, v)| [t, v]).collect()
}

/// The numbers of open, sticking and slipping points, one upon the other.
fn status_chart(history: &History) -> Chart {
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
    Chart { quantity: "contact points".to_owned(), unit: String::new(), areas, series: Vec::new(), zero: true }
}
