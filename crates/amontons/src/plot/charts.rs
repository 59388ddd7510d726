//! Small multiples: columns of charts that share the axis below them.

use super::axes::{self, LEGEND, Scale, Sign};
use super::color::{Color, GREY, INK};
use super::font::{self, HEADING, LABEL, TITLE};
use super::picture::{Anchor, MARGIN, Picture, Rect, Stroke};
use super::ticks::{self, Ticks};
use crate::units::{Measure, Units};

/// A line of a chart.
#[derive(Clone, Debug)]
pub(super) struct Series {
    /// Entry of the legend; empty for no entry.
    pub label: String,
    pub stroke: Stroke,
    /// Pieces of the line, in data coordinates.
    pub pieces: Vec<Vec<[f64; 2]>>,
}

/// A filled area of a chart.
#[derive(Clone, Debug)]
pub(super) struct Area {
    pub label: String,
    pub color: Color,
    /// Polygons, in data coordinates.
    pub polygons: Vec<Vec<[f64; 2]>>,
}

/// A chart of one quantity.
#[derive(Clone, Debug)]
pub(super) struct Chart {
    pub quantity: String,
    pub units: Units,
    pub measure: Measure,
    pub areas: Vec<Area>,
    pub series: Vec<Series>,
    /// True if the axis must reach zero.
    pub zero: bool,
}

impl Chart {
    fn values(&self) -> impl Iterator<Item = f64> {
        let lines = self.series.iter().flat_map(|s| &s.pieces);
        let areas = self.areas.iter().flat_map(|a| &a.polygons);
        lines.chain(areas).flatten().map(|p| p[1]).chain(self.zero.then_some(0.0))
    }

    /// True if all values are zero.
    fn is_zero(&self) -> bool {
        self.values().all(|v| v.abs() <= 0.0)
    }

    fn range(&self) -> [f64; 2] {
        axes::padded(axes::range(self.values()).unwrap_or([0.0, 1.0]), ROOM)
    }

    fn entries(&self, exponent: i32) -> Vec<(Sign, String)> {
        let heading = (Sign::None, axes::labelled(&self.quantity, exponent, self.units, self.measure));
        let areas = self.areas.iter().map(|a| (Sign::Box(a.color), a.label.clone()));
        let lines = self.series.iter().map(|s| (Sign::Line(s.stroke.clone(), None), s.label.clone()));
        std::iter::once(heading).chain(areas.chain(lines).filter(|(_, label)| !label.is_empty())).collect()
    }
}

/// Charts above each other.
#[derive(Clone, Debug)]
pub(super) struct ChartColumn {
    /// Title; empty for none.
    pub title: String,
    pub x: [f64; 2],
    pub x_label: String,
    pub x_units: Units,
    pub x_measure: Measure,
    /// Coloured intervals of x: a strip on top and a tint behind each chart.
    pub bands: Vec<([f64; 2], Color)>,
    pub charts: Vec<Chart>,
}

const HEIGHT: f64 = 112.0;
const STRIP: f64 = 12.0;
const MOST_MARKS: usize = 5;
/// Margin above and below the values of a chart, as a fraction of their range.
const ROOM: f64 = 0.07;

impl Chart {
    /// Draws areas and lines into a frame.
    fn draw(&self, picture: &mut Picture, frame: Rect, [scale_x, scale_y]: [&Scale; 2]) {
        if scale_y.values[0] < 0.0 && scale_y.values[1] > 0.0 {
            picture.line(&[[frame.x, scale_y.at(0.0)], [frame.right(), scale_y.at(0.0)]], Stroke::new(GREY, 1.0));
        }
        let place = |p: &[f64; 2]| [scale_x.at(p[0]), scale_y.at(p[1])];
        for area in &self.areas {
            for polygon in &area.polygons {
                picture.polygon(polygon.iter().map(place).collect(), area.color);
            }
        }
        for series in &self.series {
            let pieces: Vec<Vec<[f64; 2]>> =
                series.pieces.iter().map(|piece| piece.iter().map(place).collect()).collect();
            picture.lines(&pieces, series.stroke.clone());
        }
        axes::border(picture, frame);
    }
}

impl ChartColumn {
    fn label(&self, exponent: i32) -> String {
        axes::labelled(&self.x_label, exponent, self.x_units, self.x_measure)
    }

    /// Draws the bands as a strip of this height, from y downwards.
    fn draw_bands(&self, picture: &mut Picture, scale_x: &Scale, [y, height]: [f64; 2], opacity: f64) {
        for &([from, to], color) in &self.bands {
            let place = Rect { x: scale_x.at(from), y, width: scale_x.at(to) - scale_x.at(from), height };
            picture.polygon(place.corners(), color.with_opacity(opacity));
        }
    }
}

/// Heights of the parts above the charts, and of the start of the first row of charts.
struct Heads {
    legend: f64,
    titles: f64,
    strip: f64,
    charts: f64,
}

impl Heads {
    /// Layout below the title: a legend of this many lines, titles of the columns, a strip of bands.
    fn new(legend_lines: Option<usize>, columns: &[ChartColumn]) -> Heads {
        let mut top = MARGIN + TITLE + 6.0;
        let legend = top + LEGEND;
        if let Some(lines) = legend_lines {
            top += LEGEND * lines as f64 + 4.0;
        }
        let titles = top + HEADING + 4.0;
        if columns.iter().any(|c| !c.title.is_empty()) {
            top += HEADING + 8.0;
        }
        let strip = top + 6.0;
        if columns.iter().any(|c| !c.bands.is_empty()) {
            top += STRIP + 8.0;
        }
        Heads { legend, titles, strip, charts: top }
    }

    /// Upper ends of the frames of the rows, each below a legend of this many lines.
    fn row_tops(&self, legends: &[usize]) -> Vec<f64> {
        let mut y = self.charts;
        let below = |&lines: &usize| {
            let frame = y + 6.0 + LEGEND * lines as f64;
            y = frame + HEIGHT + 6.0;
            frame
        };
        legends.iter().map(below).collect()
    }
}

/// The common range of adjacent charts. The margin is added to the range of all values together, because a chart of
/// zeros has none.
fn shared_range<'c>(charts: impl Iterator<Item = &'c Chart>) -> Option<[f64; 2]> {
    axes::range(charts.flat_map(Chart::values)).map(|range| axes::padded(range, ROOM))
}

/// The marks of the vertical axis of a chart in a column and a row. For zeros only 0 has a mark: any other number would
/// not come from the data.
fn marks(columns: &[ChartColumn], (c, r): (usize, usize), range: [f64; 2], shared: bool) -> Ticks {
    let chart = &columns[c].charts[r];
    let mut marks = ticks::in_units(range, MOST_MARKS, chart.units, chart.measure);
    let mut in_row = columns.iter().filter_map(|column| column.charts.get(r));
    let is_zero = if shared { in_row.all(Chart::is_zero) } else { chart.is_zero() };
    if is_zero {
        marks.marks.retain(|(value, _)| value.abs() <= 0.0);
        marks.marks.iter_mut().for_each(|(_, text)| "0".clone_into(text));
    }
    marks
}

/// Draws columns of charts side by side under a title and a legend.
pub(super) fn draw(title: &str, legend: &[(Sign, String)], columns: &[ChartColumn], shared: bool) -> Picture {
    let width = if columns.len() > 2 { 340.0 } else { 430.0 };
    let rows = columns.iter().map(|c| c.charts.len()).max().unwrap_or(0);
    let range = |c: usize, r: usize| -> [f64; 2] {
        let own = columns[c].charts[r].range();
        if !shared {
            return own;
        }
        shared_range(columns.iter().filter_map(|column| column.charts.get(r))).unwrap_or(own)
    };
    let marks = |c: usize, r: usize| marks(columns, (c, r), range(c, r), shared);
    let entries = |c: usize, r: usize| columns[c].charts[r].entries(marks(c, r).exponent);
    let cells = |r: usize| (0..columns.len()).filter(move |&c| r < columns[c].charts.len());
    let headings: Vec<usize> =
        (0..rows).map(|r| cells(r).map(|c| axes::flow(&entries(c, r), width).1).max().unwrap_or(1)).collect();
    let rooms: Vec<f64> = columns
        .iter()
        .enumerate()
        .map(|(c, column)| (0..column.charts.len()).map(|r| axes::y_room(&marks(c, r))).fold(0.0, f64::max))
        .collect();

    let inner = MARGIN + rooms.iter().map(|room| room + width + MARGIN + 8.0).sum::<f64>();
    let total = inner.max(font::width(title, TITLE) + 2.0 * MARGIN);
    let (_, lines) = axes::flow(legend, total - 2.0 * MARGIN);
    let heads = Heads::new((!legend.is_empty()).then_some(lines), columns);
    let row_tops = heads.row_tops(&headings);
    let bottom = row_tops.last().map_or(heads.charts, |y| y + HEIGHT);
    let height = bottom + 24.0 + LABEL + MARGIN;

    let mut picture = Picture::new(total, height, title);
    picture.text([0.5 * total, MARGIN + 0.8 * TITLE], TITLE, Anchor::Middle, INK, title);
    let start = if lines > 1 { MARGIN } else { MARGIN + rooms.first().copied().unwrap_or(0.0) };
    axes::legend(&mut picture, [start, heads.legend], total - 2.0 * MARGIN, legend);

    let mut x = MARGIN + 0.5 * (total - inner);
    for (c, column) in columns.iter().enumerate() {
        x += rooms[c];
        let scale_x = Scale::new(column.x, [x, x + width]);
        let x_ticks = ticks::in_units(column.x, 7, column.x_units, column.x_measure);
        if !column.title.is_empty() {
            picture.text([x + 0.5 * width, heads.titles], HEADING, Anchor::Middle, INK, &column.title);
        }
        column.draw_bands(&mut picture, &scale_x, [heads.strip, STRIP], 1.0);
        for (r, chart) in column.charts.iter().enumerate() {
            let frame = Rect { x, y: row_tops[r], width, height: HEIGHT };
            let scale_y = Scale::new(range(c, r), [frame.bottom(), frame.y]);
            column.draw_bands(&mut picture, &scale_x, [frame.y, frame.height], 0.13);
            axes::x_marks(&mut picture, frame, &scale_x, &x_ticks, true, r + 1 == column.charts.len());
            axes::y_marks(&mut picture, frame, &scale_y, &marks(c, r), true);
            chart.draw(&mut picture, frame, [&scale_x, &scale_y]);
            let first = frame.y - 6.0 - LEGEND * (axes::flow(&entries(c, r), width).1 - 1) as f64;
            axes::legend(&mut picture, [x, first], width, &entries(c, r));
        }
        let last = column.charts.len().checked_sub(1).map_or(bottom, |r| row_tops[r] + HEIGHT);
        let below = [x + 0.5 * width, last + 24.0 + LABEL];
        picture.text(below, LABEL, Anchor::Middle, INK, column.label(x_ticks.exponent));
        x += width + MARGIN + 8.0;
    }
    picture
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chart with a line of these values.
    fn chart(values: [f64; 2]) -> Chart {
        let pieces = vec![vec![[0.0, values[0]], [1.0, values[1]]]];
        let series = vec![Series { label: String::new(), stroke: Stroke::new(INK, 1.0), pieces }];
        let (quantity, units) = ("slip velocity".to_owned(), Units::PLANE);
        Chart { quantity, units, measure: Measure::Velocity, areas: Vec::new(), series, zero: true }
    }

    /// At a time without slip the axis is that of the other times, not one of metres per second.
    #[test]
    fn a_shared_axis_is_that_of_the_values() {
        let (slides, still) = (chart([1e-6, 2e-6]), chart([0.0, 0.0]));
        let [low, high] = shared_range([&slides, &still].into_iter()).unwrap_or_default();
        assert!((-0.2e-6..=0.0).contains(&low) && (2e-6..2.2e-6).contains(&high), "{low} {high}");
        assert_eq!(shared_range([&still, &still].into_iter()), Some([-1.0, 1.0]));
    }
}
