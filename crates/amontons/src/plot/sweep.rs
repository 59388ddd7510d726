//! Sweeps: figures of several runs over the value of a key.

use super::charts::{self, Chart, ChartColumn, Series};
use super::color::LINES;
use super::picture::{Picture, Stroke};
use super::{PlotError, axes};
use crate::units::{Measure, Units};

/// The data of the picture of a sweep.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SweepPlot {
    /// The title.
    pub title: String,
    /// The key whose values are along the axis.
    pub x_label: String,
    /// The figures, one chart each.
    pub series: Vec<SweepSeries>,
}

/// A figure of the runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SweepSeries {
    /// Its name.
    pub quantity: String,
    /// Lines with their labels: values of the key with the figure of the run. A single line needs no label.
    pub lines: Vec<(String, Vec<[f64; 2]>)>,
}

/// Draws a sweep.
///
/// # Errors
/// [`PlotError::Data`] if there is nothing to draw, or a number is not finite.
pub fn sweep(plot: &SweepPlot) -> Result<Picture, PlotError> {
    let points = || plot.series.iter().flat_map(|series| &series.lines).flat_map(|(_, points)| points);
    if points().any(|p| !(p[0].is_finite() && p[1].is_finite())) {
        return Err(PlotError::Data("a figure of a sweep is not finite".to_owned()));
    }
    let x = axes::range(points().map(|p| p[0])).ok_or_else(|| PlotError::Data("a sweep has no figures".to_owned()))?;
    let none = Units::default().without();
    let charts: Vec<Chart> = plot.series.iter().map(|series| chart(series, none)).collect();
    let column = ChartColumn {
        title: String::new(),
        x: axes::padded(x, 0.02),
        x_label: plot.x_label.clone(),
        x_units: none,
        x_measure: Measure::Number,
        bands: Vec::new(),
        charts,
    };
    let mut columns = vec![column];
    if let [column] = &mut columns[..]
        && column.charts.len() > 3
    {
        let half = column.charts.len().div_ceil(2);
        let right = ChartColumn { charts: column.charts.split_off(half), ..column.clone() };
        columns.push(right);
    }
    Ok(charts::draw(&plot.title, &[], &columns, false))
}

fn chart(series: &SweepSeries, units: Units) -> Chart {
    let line = |(i, (label, points)): (usize, &(String, Vec<[f64; 2]>))| {
        let mut points = points.clone();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let label = if series.lines.len() > 1 { label.clone() } else { String::new() };
        Series { label, stroke: Stroke::new(LINES[i % LINES.len()], 1.6), pieces: vec![points] }
    };
    Chart {
        quantity: series.quantity.clone(),
        units,
        measure: Measure::Number,
        areas: Vec::new(),
        series: series.lines.iter().enumerate().map(line).collect(),
        zero: false,
    }
}
