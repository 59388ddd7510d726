//! Histories: energies, works, contact, heat and wear over time.

use super::charts::{self, Area, Chart, ChartColumn, Series};
use super::color::LINES;
use super::picture::{Picture, Stroke};
use super::profiles::{STATUSES, color};
use super::run::{DrawnRun, HistoryColumns};
use super::{Options, PlotError, RunPanel, axes, heading};
use crate::output::columns;
use crate::units::{Measure, Units};

pub(super) fn draw(panels: &[RunPanel], options: &Options) -> Result<Picture, PlotError> {
    let units = super::units(panels, options);
    let mut columns = Vec::new();
    for panel in panels {
        let history = &panel.run.history;
        let times = history.get(columns::TIME.name).map_or(&[][..], Vec::as_slice);
        if let Some((name, column)) = history.iter().find(|(_, column)| column.len() != times.len()) {
            return Err(PlotError::Data(format!(
                "the column {name} of the history has {} rows, expected {}",
                column.len(),
                times.len()
            )));
        }
        let [first, last] = axes::range(times.iter().copied()).unwrap_or([0.0, 1.0]);
        // A run starts at 0, one step before its first row.
        let x = if first > 0.0 { [0.0, last] } else { axes::padded([first, last], 0.0) };
        let charts = chart_list(panel.run, units);
        columns.push(ChartColumn {
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
        let right = ChartColumn { charts: column.charts.split_off(half), ..column.clone() };
        columns.push(right);
    }
    Ok(charts::draw(&heading(panels, "history"), &[], &columns, options.shared_scale))
}

/// Lines of columns by their names and labels, without those that are zero throughout.
fn lines(run: &DrawnRun, columns: &[(&str, &str)]) -> Vec<Series> {
    // Small quantities overlap near zero: later lines are dashed so that earlier ones show through.
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
pub(super) fn chart_list(run: &DrawnRun, units: Units) -> Vec<Chart> {
    let history = &run.history;
    let chart = |quantity: &str, measure: Measure, series: Vec<Series>| Chart {
        quantity: quantity.to_owned(),
        units,
        measure,
        areas: Vec::new(),
        series,
        zero: true,
    };
    let of = |quantity: &str, measure: Measure, columns: &[(&str, &str)]| chart(quantity, measure, lines(run, columns));
    let counts = [columns::OPEN, columns::STICK, columns::SLIP].map(|count| history.get(count.name));
    let has_contact = counts.iter().flatten().any(|count| count.iter().any(|&c| c > 0.0));
    let works = [
        (columns::LOAD_WORK.name, "loads"),
        (columns::THERMAL_WORK.name, "thermal"),
        (columns::VISCOUS_DISSIPATION.name, "viscous"),
        (columns::FRICTION_DISSIPATION.name, "friction"),
        (columns::SCHEME_DISSIPATION.name, "time scheme"),
        (columns::IMPACT_DISSIPATION.name, "impacts"),
    ];
    let energies = [
        (columns::KINETIC.name, "kinetic"),
        (columns::ELASTIC.name, "elastic"),
        (columns::CONTACT_ENERGY.name, "contact"),
    ];
    let mut charts = vec![
        of("energies", Measure::Energy, &energies),
        of("work and dissipation since the start", Measure::Energy, &works),
    ];
    charts.retain(|chart| !chart.series.is_empty());
    let (column, balance) = if run.has_mechanics() {
        (columns::CLOSING_ERROR.name, "energy")
    } else {
        (columns::HEAT_CLOSING_ERROR.name, "heat")
    };
    if history.contains_key(column) {
        let series = vec![Series {
            label: String::new(),
            stroke: Stroke::new(LINES[0], 1.6),
            pieces: vec![points(history, column)],
        }];
        charts.push(chart(&format!("closing error of the {balance} balance"), Measure::Energy, series));
    }
    if has_contact {
        charts.extend(force_chart(run, &chart));
        charts.extend(moment_chart(run, &chart));
        charts.push(status_chart(history, units));
    }
    if run.has_heat() {
        let heats = [
            (columns::HEAT_CONTENT.name, "content"),
            (columns::HEAT_CONTACT.name, "left through Γ_{C} since the start"),
            (columns::HEAT_FOUNDATION.name, "content of the foundation"),
        ];
        charts.extend(Some(of("heat", Measure::Energy, &heats)).filter(|chart| !chart.series.is_empty()));
    }
    if has_contact {
        charts.extend(surface_charts(run, &chart));
    }
    charts
}

/// The contact force by its components, or `None` if it is zero.
fn force_chart(run: &DrawnRun, chart: &dyn Fn(&str, Measure, Vec<Series>) -> Chart) -> Option<Chart> {
    let [x, y, z] = [0, 1, 2].map(|c| columns::CONTACT_FORCE.component(c));
    let series = lines(run, &[(&x, "x"), (&y, "y"), (&z, "z")]);
    (!series.is_empty()).then(|| chart("contact force", Measure::Force, series))
}

/// The moment of contact: in space about the origin, by components; for bodies of revolution about the axis, of all
/// contacts together and of each of several. `None` if it is zero.
fn moment_chart(run: &DrawnRun, chart: &dyn Fn(&str, Measure, Vec<Series>) -> Chart) -> Option<Chart> {
    let history = &run.history;
    let [x, y, z] = [0, 1, 2].map(|c| columns::CONTACT_MOMENTS.component(c));
    let in_space = lines(run, &[(&x, "x"), (&y, "y"), (&z, "z")]);
    if !in_space.is_empty() {
        return Some(chart("moment of contact about the origin", Measure::Moment, in_space));
    }
    let all = history.keys().filter_map(|name| Some((name, columns::CONTACT_MOMENT.side_of(name)?)));
    let told: Vec<(&String, &str)> = all.filter(|(name, _)| run.has(name)).collect();
    let one = told.len() == 1;
    let series = told.iter().enumerate().map(|(i, (name, side))| Series {
        label: if side.is_empty() && !one { "all contacts".to_owned() } else { (*side).to_owned() },
        stroke: Stroke::new(LINES[i % LINES.len()], 1.6),
        pieces: vec![points(history, name)],
    });
    let series: Vec<Series> = series.collect();
    (!series.is_empty()).then(|| chart("moment of contact about the axis", Measure::Moment, series))
}

/// Friction power, temperature of the foundation, area and wear over time, if the run has them.
fn surface_charts(run: &DrawnRun, chart: &dyn Fn(&str, Measure, Vec<Series>) -> Chart) -> Vec<Chart> {
    let history = &run.history;
    let line = |label: &str, color: usize, pieces: Vec<[f64; 2]>| Series {
        label: label.to_owned(),
        stroke: Stroke::new(LINES[color % LINES.len()], 1.6),
        pieces: vec![pieces],
    };
    let mut charts = Vec::new();
    if run.has(columns::FRICTION_DISSIPATION.name) {
        // The mean power over each step, from the work since the start.
        let mut before = [0.0; 2];
        let power = points(history, columns::FRICTION_DISSIPATION.name).into_iter().map(|now| {
            let mean = (now[1] - before[1]) / (now[0] - before[0]);
            before = now;
            [now[0], if mean.is_finite() { mean } else { 0.0 }]
        });
        charts.push(chart("power of friction", Measure::Power, vec![line("", 1, power.collect())]));
    }
    let foundations = history.keys().filter_map(|name| Some((name, columns::FOUNDATION_TEMPERATURE.side_of(name)?)));
    let lines: Vec<Series> =
        foundations.enumerate().map(|(i, (name, side))| line(side, i, points(history, name))).collect();
    if !lines.is_empty() {
        charts.push(chart("temperature of the foundation", Measure::Temperature, lines));
    }
    let obstacles = history.keys().filter_map(|name| Some((name, columns::OBSTACLE_DISPLACEMENT.side_of(name)?)));
    let lines: Vec<Series> =
        obstacles.enumerate().map(|(i, (name, side))| line(side, i, points(history, name))).collect();
    if !lines.is_empty() {
        charts.push(chart("obstacle moved along its load", Measure::Length, lines));
    }
    for (column, quantity) in [
        (columns::CONTACT_AREA, "area of contact"),
        (columns::WEAR_MAX, "largest depth worn off"),
        (columns::WEAR_VOLUME, "volume worn off"),
    ] {
        if run.has(column.name) {
            let measure = column.measure.unwrap_or(Measure::Number);
            charts.push(chart(quantity, measure, vec![line("", 0, points(history, column.name))]));
        }
    }
    charts
}

fn points(history: &HistoryColumns, name: &str) -> Vec<[f64; 2]> {
    let column = |name: &str| history.get(name).map_or(&[][..], Vec::as_slice).iter().copied();
    column(columns::TIME.name).zip(column(name)).map(|(t, v)| [t, v]).collect()
}

/// The numbers of open, sticking and slipping points, stacked.
fn status_chart(history: &HistoryColumns, units: Units) -> Chart {
    let times = points(history, columns::TIME.name);
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
    Chart {
        quantity: "contact points".to_owned(),
        units,
        measure: Measure::Number,
        areas,
        series: Vec::new(),
        zero: true,
    }
}
