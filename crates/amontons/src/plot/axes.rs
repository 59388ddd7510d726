//! Frames with marks, labels and legends.

use super::color::{Color, GRID, INK, SOFT};
use super::font::{self, HALF, LABEL, NUMBER, TITLE};
use super::picture::{Anchor, MARGIN, OutlinePiece, Picture, Rect, Stroke, beside};
use super::ticks::Ticks;
use crate::units::{Measure, Units};

/// Length of marks outside a frame.
const MARK: f64 = 4.0;

/// A map from values to positions in a picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    pub values: [f64; 2],
    pub places: [f64; 2],
    pub logarithmic: bool,
}

impl Scale {
    pub(super) fn new(values: [f64; 2], places: [f64; 2]) -> Scale {
        Scale { values, places, logarithmic: false }
    }

    pub(super) fn at(&self, value: f64) -> f64 {
        let map = |v: f64| if self.logarithmic { v.log10() } else { v };
        let [a, b] = self.values.map(map);
        self.places[0] + (map(value) - a) / (b - a) * (self.places[1] - self.places[0])
    }
}

/// The least and the greatest finite value, or `None` if no value is finite.
pub(super) fn range(values: impl IntoIterator<Item = f64>) -> Option<[f64; 2]> {
    values.into_iter().filter(|v| v.is_finite()).fold(None, |range, v| match range {
        None => Some([v, v]),
        Some([lo, hi]) => Some([f64::min(lo, v), f64::max(hi, v)]),
    })
}

/// True if the ends of a range differ by more than round-off.
pub(super) fn differ([lo, hi]: [f64; 2]) -> bool {
    hi - lo > 1e-9 * lo.abs().max(hi.abs())
}

/// A range with margins at both ends. A range of one value, up to round-off, becomes an interval around it.
pub(super) fn padded([lo, hi]: [f64; 2], share: f64) -> [f64; 2] {
    if differ([lo, hi]) {
        let room = share * (hi - lo);
        [lo - room, hi + room]
    } else {
        let room = if lo == 0.0 { 1.0 } else { 0.5 * lo.abs() };
        [lo - room, hi + room]
    }
}

/// Label of an axis: `pressure (kPa)`, or `θ (×10^{3} K)` if the unit has no such prefix.
pub(super) fn labelled(quantity: &str, exponent: i32, units: Units, measure: Measure) -> String {
    match units.prefixed(exponent, measure) {
        Some(unit) => with_unit(quantity, 0, &unit),
        None => with_unit(quantity, exponent, units.of(measure)),
    }
}

/// Label with a unit: `quantity (×10^{3} Pa)`.
pub(super) fn with_unit(quantity: &str, exponent: i32, unit: &str) -> String {
    let power =
        if exponent == 0 { String::new() } else { format!("×10^{{{}}}", exponent.to_string().replace('-', "−")) };
    match (power.is_empty(), unit.is_empty()) {
        (true, true) => quantity.to_owned(),
        (true, false) => format!("{quantity} ({unit})"),
        (false, true) => format!("{quantity} ({power})"),
        (false, false) => format!("{quantity} ({power} {unit})"),
    }
}

/// Draws the vertical lines of a grid, marks below the frame and, if `numbers` is true, their numbers.
pub(super) fn x_marks(picture: &mut Picture, frame: Rect, scale: &Scale, ticks: &Ticks, grid: bool, numbers: bool) {
    let stroke = Stroke::new(INK, 0.8);
    if grid {
        let lines: Vec<_> =
            ticks.marks.iter().map(|(v, _)| [[scale.at(*v), frame.y], [scale.at(*v), frame.bottom()]]).collect();
        picture.lines(&lines, Stroke::new(GRID, 0.8));
    }
    let mark = |v: f64, length: f64| [[scale.at(v), frame.bottom()], [scale.at(v), frame.bottom() + length]];
    let mut marks: Vec<_> = ticks.marks.iter().map(|(v, _)| mark(*v, MARK)).collect();
    marks.extend(ticks.minor.iter().map(|&v| mark(v, 0.5 * MARK)));
    picture.lines(&marks, stroke);
    if numbers {
        for (v, label) in &ticks.marks {
            picture.text(
                [scale.at(*v), frame.bottom() + MARK + 3.0 + 0.75 * NUMBER],
                NUMBER,
                Anchor::Middle,
                INK,
                label,
            );
        }
    }
}

/// Draws the horizontal lines of a grid, and marks and numbers left of the frame.
pub(super) fn y_marks(picture: &mut Picture, frame: Rect, scale: &Scale, ticks: &Ticks, grid: bool) {
    if grid {
        let lines: Vec<_> =
            ticks.marks.iter().map(|(v, _)| [[frame.x, scale.at(*v)], [frame.right(), scale.at(*v)]]).collect();
        picture.lines(&lines, Stroke::new(GRID, 0.8));
    }
    let mark = |v: f64, length: f64| [[frame.x - length, scale.at(v)], [frame.x, scale.at(v)]];
    let mut marks: Vec<_> = ticks.marks.iter().map(|(v, _)| mark(*v, MARK)).collect();
    marks.extend(ticks.minor.iter().map(|&v| mark(v, 0.5 * MARK)));
    picture.lines(&marks, Stroke::new(INK, 0.8));
    for (v, label) in &ticks.marks {
        picture.text([frame.x - MARK - 3.0, scale.at(*v) + HALF * NUMBER], NUMBER, Anchor::End, INK, label);
    }
}

/// Width of the marks and numbers of [`y_marks`].
pub(super) fn y_room(ticks: &Ticks) -> f64 {
    MARK + 3.0 + ticks.marks.iter().map(|(_, label)| font::width(label, NUMBER)).fold(0.0, f64::max)
}

/// Draws the border of a frame.
pub(super) fn border(picture: &mut Picture, frame: Rect) {
    picture.frame(frame, Stroke::new(INK, 0.8));
}

/// The sign of an entry of a legend.
#[derive(Clone, Debug)]
pub(super) enum Sign {
    /// A piece of a line with its marker, if any.
    Line(Stroke, Option<Marker>),
    /// A filled box.
    Box(Color),
    /// No sign: the text stands alone.
    None,
}

impl Sign {
    fn width(&self) -> f64 {
        match self {
            Sign::Line(..) => 22.0 + 5.0,
            Sign::Box(_) => 12.0 + 5.0,
            Sign::None => 0.0,
        }
    }
}

/// Places entries of a legend one after the other and wraps lines at the width. Returns offset and line of each entry,
/// and the number of lines.
pub(super) fn flow(entries: &[(Sign, String)], width: f64) -> (Vec<(f64, usize)>, usize) {
    const BETWEEN: f64 = 14.0;
    let (mut x, mut line) = (0.0, 0);
    let places = entries
        .iter()
        .map(|(sign, text)| {
            let needed = sign.width() + font::width(text, LABEL);
            if x > 0.0 && x + needed > width {
                (x, line) = (0.0, line + 1);
            }
            let place = (x, line);
            x += needed + BETWEEN;
            place
        })
        .collect();
    (places, line + 1)
}

/// Width of a legend in one line.
pub(super) fn line_width(entries: &[(Sign, String)]) -> f64 {
    let (places, _) = flow(entries, f64::INFINITY);
    entries.last().zip(places.last()).map_or(0.0, |((sign, text), (x, _))| x + sign.width() + font::width(text, LABEL))
}

/// Height of a line of a legend.
pub(super) const LEGEND: f64 = 18.0;

/// Draws a legend that starts at this point of its first baseline; `width` is that of its lines.
pub(super) fn legend(picture: &mut Picture, at: [f64; 2], width: f64, entries: &[(Sign, String)]) {
    let (places, _) = flow(entries, width);
    for ((sign, text), (x, line)) in entries.iter().zip(places) {
        let (x, y) = (at[0] + x, at[1] + LEGEND * line as f64);
        let middle = y - HALF * LABEL;
        match sign {
            Sign::Line(stroke, marker) => {
                picture.line(&[[x, middle], [x + 22.0, middle]], stroke.clone());
                if let Some(marker) = marker {
                    marker.draw(picture, [x + 11.0, middle], stroke.color);
                }
            }
            Sign::Box(color) => {
                let place = Rect { x, y: middle - 6.0, width: 12.0, height: 12.0 };
                let outline = Stroke::new(SOFT, 0.5);
                picture.shape(
                    vec![OutlinePiece { points: place.corners(), closed: true }],
                    Some(*color),
                    Some(outline),
                );
            }
            Sign::None => {}
        }
        picture.text([x + sign.width(), y], LABEL, Anchor::Start, INK, text);
    }
}

/// A picture below its title and a legend.
pub(super) fn headed(picture: Picture, title: &str, entries: &[(Sign, String)]) -> Picture {
    let width = line_width(entries);
    let needed = font::width(title, TITLE).max(width) + 2.0 * MARGIN;
    let height = MARGIN + if entries.is_empty() { 0.0 } else { LEGEND };
    let mut head = Picture::new(needed.max(picture.width), height, title);
    let middle = 0.5 * head.width;
    head.text([middle, MARGIN + 0.8 * TITLE], TITLE, Anchor::Middle, INK, title);
    legend(&mut head, [middle - 0.5 * width, MARGIN + TITLE + LEGEND], f64::INFINITY, entries);
    beside(title, vec![head, picture], 1)
}

/// A sign at the points of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Marker {
    Circle,
    Square,
    Triangle,
    Diamond,
}

pub(super) const MARKERS: [Marker; 4] = [Marker::Circle, Marker::Square, Marker::Triangle, Marker::Diamond];

impl Marker {
    pub(super) fn draw(self, picture: &mut Picture, at: [f64; 2], color: Color) {
        let (corners, radius, turn) = match self {
            Marker::Circle => (24, 3.6, 0.0),
            Marker::Square => (4, 4.6, 0.25),
            Marker::Triangle => (3, 5.0, 0.5),
            Marker::Diamond => (4, 4.9, 0.0),
        };
        let corner = |i: usize| {
            let angle = std::f64::consts::TAU * (i as f64 / f64::from(corners)) + std::f64::consts::PI * turn;
            [at[0] + radius * angle.cos(), at[1] - radius * angle.sin()]
        };
        picture.polygon((0..corners as usize).map(corner).collect(), color);
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp)] // the values are exact

    use super::*;

    #[test]
    fn scales_map_ends_to_ends() {
        let linear = Scale::new([-1.0, 3.0], [100.0, 20.0]);
        assert_eq!([linear.at(-1.0), linear.at(1.0), linear.at(3.0)], [100.0, 60.0, 20.0]);
        let log = Scale { values: [1e-4, 1.0], places: [0.0, 40.0], logarithmic: true };
        assert!((log.at(1e-3) - 10.0).abs() < 1e-12 && (log.at(1e-1) - 30.0).abs() < 1e-12);
    }

    #[test]
    fn ranges_leave_out_what_is_not_finite() {
        assert_eq!(range([2.0, f64::NAN, -1.0, f64::INFINITY]), Some([-1.0, 2.0]));
        assert_eq!(range([f64::NAN]), None);
        assert_eq!(padded([0.0, 10.0], 0.1), [-1.0, 11.0]);
        assert_eq!(padded([4.0, 4.0], 0.1), [2.0, 6.0]);
        let off = padded([25.0, 25.0 + 1e-12], 0.0);
        assert!(off[0] < 13.0 && off[1] > 37.0, "{off:?}");
        assert_eq!(padded([0.0, 0.0], 0.1), [-1.0, 1.0]);
    }

    #[test]
    fn a_legend_breaks_where_its_width_ends() {
        let entries: Vec<_> = (0..3).map(|i| (Sign::Box(INK), format!("entry {i}"))).collect();
        assert_eq!(flow(&entries, 1000.0).1, 1);
        let (places, lines) = flow(&entries, 150.0);
        assert_eq!((lines, places[2].0, places[2].1), (2, 0.0, 1));
        assert_eq!(flow(&entries, 1.0).1, 3);
    }

    #[test]
    fn units_follow_the_quantity() {
        assert_eq!(with_unit("p", 0, ""), "p");
        assert_eq!(with_unit("p", -3, ""), "p (×10^{−3})");
        assert_eq!(with_unit("p", 3, "Pa"), "p (×10^{3} Pa)");
        assert_eq!(labelled("p", 3, Units::PLANE, Measure::Stress), "p (kPa)");
        assert_eq!(labelled("θ", 3, Units::PLANE, Measure::Temperature), "θ (×10^{3} K)");
        assert_eq!(labelled("p", 3, Units::PLANE.without(), Measure::Stress), "p (×10^{3})");
    }
}
