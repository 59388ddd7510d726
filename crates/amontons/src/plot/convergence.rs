//! Errors of a convergence study over the mesh width or time step, with a slope of first order.

use std::path::Path;

use super::axes::{self, LEGEND, MARKERS, Scale, Sign};
use super::color::{INK, LINES, SOFT};
use super::font::{self, HALF, HEADING, LABEL, NUMBER, TITLE};
use super::picture::{Anchor, MARGIN, Picture, Rect, Stroke};
use super::table::CsvTable;
use super::ticks::{self, Ticks};
use super::{Options, PlotError};
use crate::units::{Measure, Units};

/// The data of Figure 5 of the paper: errors of a sequence of discretizations.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvergencePlot {
    /// The title; may have subscripts and superscripts: `θ_{F}`.
    pub title: String,
    /// The refined quantity, one value per level: mesh widths h or time steps k, all positive.
    pub sizes: Vec<f64>,
    /// Label of the axis below: `h = k`.
    pub x_label: String,
    /// Label of the axis on the left, with its unit if any.
    pub y_label: String,
    /// The errors.
    pub series: Vec<ErrorSeries>,
    /// True if the legend has the order of each error on the two finest levels.
    pub has_orders: bool,
}

/// Errors by level.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorSeries {
    /// Name in the legend: `E^{hk}`.
    pub label: String,
    /// One error per level; errors that are not positive are left out.
    pub errors: Vec<f64>,
}

impl ConvergencePlot {
    /// Reads the study in a `convergence.csv`.
    ///
    /// # Errors
    /// The file is missing or damaged.
    pub fn read(path: &Path, options: &Options) -> Result<ConvergencePlot, PlotError> {
        let table = CsvTable::read(path)?;
        let (h, k) = (table.numbers("h")?, table.numbers("k")?);
        let names = [
            ("error", "E^{hk}"),
            ("error_u", "‖u − u^{hk}‖_{V}"),
            ("error_w", "‖w − w^{hk}‖_{H}"),
            ("error_theta", "‖θ − θ^{hk}‖_{L²}"),
        ];
        let series = names
            .into_iter()
            .map(|(name, label)| Ok(ErrorSeries { label: label.to_owned(), errors: table.numbers(name)? }));
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * a.abs();
        let (sizes, x_label) = if h.iter().zip(&k).all(|(h, k)| near(*h, *k)) {
            // Equal as numbers only: a width and a time step have different units.
            (h, "h = k".to_owned())
        } else if h.windows(2).all(|h| near(h[0], h[1])) {
            (k, axes::labelled("k", 0, options.units(Units::PLANE), Measure::Time))
        } else {
            (h, axes::labelled("h", 0, options.units(Units::PLANE), Measure::Length))
        };
        Ok(ConvergencePlot {
            title: "Errors against the reference solution".to_owned(),
            sizes,
            x_label,
            y_label: "error".to_owned(),
            series: series.collect::<Result<_, PlotError>>()?,
            has_orders: true,
        })
    }
}

impl ErrorSeries {
    /// The order observed on the two finest levels, or `None` if an error there is not positive.
    fn order(&self, h: &[f64]) -> Option<f64> {
        let mut levels: Vec<(f64, f64)> = h.iter().copied().zip(self.errors.iter().copied()).collect();
        levels.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let [(h0, e0), (h1, e1)] = levels.first_chunk::<2>()?;
        let order = (e1 / e0).ln() / (h1 / h0).ln();
        order.is_finite().then_some(order)
    }
}

/// Draws a convergence study.
///
/// # Errors
/// [`PlotError::Data`] if the numbers of levels differ, a size is not positive, or no error is positive and finite.
pub fn convergence(plot: &ConvergencePlot) -> Result<Picture, PlotError> {
    convergence_panels("", std::slice::from_ref(plot))
}

const WIDTH: f64 = 400.0;
const HEIGHT: f64 = 340.0;

/// Draws convergence studies side by side under a title, all with the same scales.
///
/// # Errors
/// As [`convergence`].
pub fn convergence_panels(title: &str, plots: &[ConvergencePlot]) -> Result<Picture, PlotError> {
    plots.iter().try_for_each(check)?;
    let widths = || plots.iter().flat_map(|p| p.sizes.iter().copied());
    let errors = || plots.iter().flat_map(|p| &p.series).flat_map(|s| s.errors.iter().copied()).filter(|&e| e > 0.0);
    let nothing = || PlotError::Data("a convergence study has no positive error".to_owned());
    let ([h_lo, h_hi], [e_lo, e_hi]) =
        (axes::range(widths()).ok_or_else(nothing)?, axes::range(errors()).ok_or_else(nothing)?);
    let x_values = [h_lo / 1.25, h_hi * 1.25];
    // The triangle stands below all errors.
    let triangle = triangle(plots, [h_lo, h_hi]);
    let y_values = [e_lo.min(triangle[0][1] / 1.5) / 1.3, e_hi * 1.4];
    let y_ticks = ticks::logarithmic(y_values[0], y_values[1]);
    let entries: Vec<Vec<(Sign, String)>> = plots.iter().map(legend).collect();
    let lines = entries.iter().map(|e| axes::flow(e, WIDTH).1).max().unwrap_or(1);
    let left = axes::y_room(&y_ticks) + LABEL + 10.0;
    let own_titles = plots.iter().map(|p| &p.title).any(|t| !t.is_empty());
    let head = if title.is_empty() { 0.0 } else { TITLE + 10.0 } + if own_titles { HEADING + 10.0 } else { 0.0 };
    let frame_y = MARGIN + head + 6.0 + LEGEND * lines as f64;
    let titles =
        plots.iter().map(|p| font::width(&p.title, if title.is_empty() { TITLE } else { HEADING })).fold(0.0, f64::max);
    let each = left + WIDTH.max(titles) + MARGIN;
    let total = MARGIN + each * plots.len() as f64;
    let named = if title.is_empty() { plots.first().map_or("", |p| &p.title) } else { title };
    let mut picture = Picture::new(
        total.max(font::width(title, TITLE) + 2.0 * MARGIN),
        frame_y + HEIGHT + 30.0 + LABEL + MARGIN,
        named,
    );
    picture.text([0.5 * picture.width, MARGIN + 0.8 * TITLE], TITLE, Anchor::Middle, INK, title);
    for (i, (plot, entries)) in plots.iter().zip(&entries).enumerate() {
        let x = MARGIN + each * i as f64 + left;
        let frame = Rect { x, y: frame_y, width: WIDTH, height: HEIGHT };
        let scale_x = Scale { values: x_values, places: [frame.x, frame.right()], logarithmic: true };
        let scale_y = Scale { values: y_values, places: [frame.bottom(), frame.y], logarithmic: true };
        let size = if title.is_empty() { TITLE } else { HEADING };
        picture.text([x + 0.5 * WIDTH.max(titles), MARGIN + head - 8.0], size, Anchor::Middle, INK, &plot.title);
        axes::legend(
            &mut picture,
            [x, frame_y - 8.0 - LEGEND * (axes::flow(entries, WIDTH).1 - 1) as f64],
            WIDTH,
            entries,
        );
        axes::x_marks(&mut picture, frame, &scale_x, &level_ticks(&plot.sizes, &scale_x), true, true);
        axes::y_marks(&mut picture, frame, &scale_y, &y_ticks, true);
        axes::border(&mut picture, frame);
        lines_of(&mut picture, plot, [&scale_x, &scale_y]);
        let [a, b, c] = triangle.map(|[h, e]| [scale_x.at(h), scale_y.at(e)]);
        picture.line(&[a, b, c, a], Stroke::new(SOFT, 1.0));
        picture.text([0.5 * (a[0] + b[0]), a[1] + 5.0 + 0.75 * NUMBER], NUMBER, Anchor::Middle, SOFT, "1");
        picture.text([b[0] + 6.0, 0.5 * (b[1] + c[1]) + HALF * NUMBER], NUMBER, Anchor::Start, SOFT, "1");
        picture.text([x + 0.5 * WIDTH, frame.bottom() + 26.0 + LABEL], LABEL, Anchor::Middle, INK, &plot.x_label);
        picture.text_upwards([x - left + 0.8 * LABEL, frame.y + 0.5 * HEIGHT], LABEL, INK, &plot.y_label);
    }
    Ok(picture)
}

/// Draws the errors of a study with a mark per level.
fn lines_of(picture: &mut Picture, plot: &ConvergencePlot, [scale_x, scale_y]: [&Scale; 2]) {
    for (s, series) in plot.series.iter().enumerate() {
        let positive = plot.sizes.iter().zip(&series.errors).filter(|(_, e)| **e > 0.0);
        let mut points: Vec<[f64; 2]> = positive.map(|(&h, &e)| [scale_x.at(h), scale_y.at(e)]).collect();
        points.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
        let stroke = style(s);
        picture.line(&points, stroke.clone());
        for point in points {
            MARKERS[s % MARKERS.len()].draw(picture, point, stroke.color);
        }
    }
}

fn check(plot: &ConvergencePlot) -> Result<(), PlotError> {
    if let Some(h) = plot.sizes.iter().find(|h| !(h.is_finite() && **h > 0.0)) {
        return Err(PlotError::Data(format!("a mesh width or time step is {h}, expected a positive number")));
    }
    for series in &plot.series {
        if series.errors.len() != plot.sizes.len() {
            return Err(PlotError::Data(format!(
                "{} has {} errors for {} levels",
                font::plain(&series.label),
                series.errors.len(),
                plot.sizes.len()
            )));
        }
        if let Some(e) = series.errors.iter().find(|e| !e.is_finite()) {
            return Err(PlotError::Data(format!("{} has the error {e}", font::plain(&series.label))));
        }
    }
    Ok(())
}

/// The first series is drawn strongest: it is the sum of the others.
fn style(series: usize) -> Stroke {
    let color = LINES[series % LINES.len()];
    if series == 0 { Stroke::new(color, 2.0) } else { Stroke::new(color, 1.2) }
}

fn legend(plot: &ConvergencePlot) -> Vec<(Sign, String)> {
    let entry = |(s, series): (usize, &ErrorSeries)| {
        let order = series.order(&plot.sizes).filter(|_| plot.has_orders);
        let order = order.map_or_else(String::new, |order| format!(", order {order:.2}").replace('-', "−"));
        (Sign::Line(style(s), Some(MARKERS[s % MARKERS.len()])), format!("{}{order}", series.label))
    };
    plot.series.iter().enumerate().map(entry).collect()
}

/// Marks at the widths, labelled `1/64` if they are such fractions; labels that would touch are left out.
fn level_ticks(h: &[f64], scale: &Scale) -> Ticks {
    let mut levels = h.to_vec();
    levels.sort_unstable_by(f64::total_cmp);
    let label = |h: f64| {
        let inverse = (1.0 / h).round();
        if inverse > 1.0 && (inverse * h - 1.0).abs() < 1e-9 { format!("1/{inverse}") } else { ticks::number(h) }
    };
    let mut ticks = Ticks { marks: Vec::new(), minor: Vec::new(), exponent: 0 };
    let mut end = f64::NEG_INFINITY;
    for h in levels {
        let text = label(h);
        let half = 0.5 * font::width(&text, NUMBER);
        if scale.at(h) - half > end + 6.0 {
            end = scale.at(h) + half;
            ticks.marks.push((h, text));
        } else {
            ticks.minor.push(h);
        }
    }
    ticks
}

/// Corners of a triangle whose upper side has slope 1, below all errors in the right half of the widths.
fn triangle(plots: &[ConvergencePlot], [lo, hi]: [f64; 2]) -> [[f64; 2]; 3] {
    // Between 0.5 and 0.8 of the way on the logarithmic axis.
    let at = |s: f64| lo * (hi / lo).powf(s);
    let (a, b) = if hi > lo { (at(0.5), at(0.8)) } else { (lo, lo * 1.2) };
    let lines = plots.iter().flat_map(|p| p.series.iter().map(|s| (&p.sizes, &s.errors)));
    // The slanted side, e = c·h, must stay below every error from its lower end on.
    let below =
        lines.flat_map(|(h, e)| h.iter().zip(e)).filter(|(h, e)| **h >= a / 2.1 && **e > 0.0).map(|(h, e)| e / h);
    let c = 0.55 * axes::range(below).map_or(1.0, |r| r[0]);
    [[a, c * a], [b, c * a], [b, c * b]]
}
