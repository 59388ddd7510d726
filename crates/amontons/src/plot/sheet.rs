//! Panels with equal scales in x and y, side by side or, if they are wide, above each other.

use super::axes::{self, Scale};
use super::color::{INK, SOFT};
use super::font::{self, HEADING, LABEL, NUMBER, TITLE};
use super::picture::{Anchor, MARGIN, Picture, Rect};
use super::ticks::{self, Ticks};
use crate::units::{Measure, Units};

/// The content of a panel.
#[derive(Clone, Debug)]
pub(super) struct PanelPlan {
    pub title: String,
    /// A line below the title; empty for none.
    pub note: String,
    /// Ranges of x and y.
    pub window: [[f64; 2]; 2],
    /// Names of both coordinates.
    pub labels: [&'static str; 2],
    /// True if the first coordinate runs to the left.
    pub mirrored: bool,
}

/// Space around the panels of a sheet.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Margins {
    pub right: f64,
    pub below: f64,
    /// Height between the title and the panels.
    pub above: f64,
    /// The least width of all panels together.
    pub least: f64,
    /// True if the panels come in pairs.
    pub in_twos: bool,
}

/// A panel in a picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct SheetPanel {
    pub rect: Rect,
    pub x: Scale,
    pub y: Scale,
}

impl SheetPanel {
    pub(super) fn at(&self, p: &[f64; 2]) -> [f64; 2] {
        [self.x.at(p[0]), self.y.at(p[1])]
    }
    pub(super) fn all<'p>(&self, points: impl IntoIterator<Item = &'p [f64; 2]>) -> Vec<[f64; 2]> {
        points.into_iter().map(|p| self.at(p)).collect()
    }
}

/// A range widened by a fraction of the larger range.
pub(super) fn widened([x, y]: [[f64; 2]; 2], share: f64) -> [[f64; 2]; 2] {
    let size = (x[1] - x[0]).max(y[1] - y[0]);
    let room = share * if size > 0.0 { size } else { 1.0 };
    [x, y].map(|r| [r[0] - room, r[1] + room])
}

/// True if windows are so wide that their panels are stacked.
pub(super) fn is_wide(plans: &[PanelPlan]) -> bool {
    plans.iter().any(|plan| size(plan)[0] > 2.2 * size(plan)[1])
}

fn size(plan: &PanelPlan) -> [f64; 2] {
    plan.window.map(|r| (r[1] - r[0]).max(f64::MIN_POSITIVE))
}

/// Number of columns for a number of panels: a few wide ones are stacked, others form rows of at most four, many of
/// them a roughly square sheet.
fn columns(count: usize, wide: bool) -> usize {
    match count {
        _ if wide => count.div_ceil(6).clamp(1, 5),
        0..=3 => count.max(1),
        4..=16 => count.div_ceil(2).min(4),
        _ => ((count as f64).sqrt().ceil() as usize).min(8),
    }
}

/// Marks of both axes of a panel of this size.
fn plan_ticks(plan: &PanelPlan, [w, h]: [f64; 2], units: Units) -> [Ticks; 2] {
    let marks = |range: [f64; 2], length: f64, each: f64| {
        ticks::in_units(range, ((length / each) as usize).clamp(2, 7), units, Measure::Length)
    };
    [marks(plan.window[0], w, 55.0), marks(plan.window[1], h, 32.0)]
}

/// Draws the heading of a panel above its frame, lifted if it is wide, and its axes with names, the vertical one `left`
/// of the frame.
fn label(picture: &mut Picture, plan: &PanelPlan, frame: &SheetPanel, left: f64, lift: f64, units: Units) {
    let rect = frame.rect;
    let middle = rect.x + 0.5 * rect.width;
    let note_height = if plan.note.is_empty() { 0.0 } else { NUMBER + 5.0 };
    picture.text([middle, rect.y - 8.0 - lift - note_height], HEADING, Anchor::Middle, INK, &plan.title);
    picture.text([middle, rect.y - 7.0 - lift], NUMBER, Anchor::Middle, SOFT, &plan.note);
    let [x_ticks, y_ticks] = plan_ticks(plan, [rect.width, rect.height], units);
    axes::x_marks(picture, rect, &frame.x, &x_ticks, false, true);
    axes::y_marks(picture, rect, &frame.y, &y_ticks, false);
    axes::border(picture, rect);
    let named = |name: &str, exponent: i32| axes::labelled(name, exponent, units, Measure::Length);
    picture.text(
        [middle, rect.bottom() + 8.0 + NUMBER + 6.0 + 0.8 * LABEL],
        LABEL,
        Anchor::Middle,
        INK,
        named(plan.labels[0], x_ticks.exponent),
    );
    picture.text_upwards(
        [rect.x - left + 0.8 * LABEL, rect.y + 0.5 * rect.height],
        LABEL,
        INK,
        named(plan.labels[1], y_ticks.exponent),
    );
}

/// Lays out the panels and draws titles, borders, marks and labels.
pub(super) fn lay_out(title: &str, plans: &[PanelPlan], room: Margins, units: Units) -> (Picture, Vec<SheetPanel>) {
    let wide = is_wide(plans);
    let longest = if wide {
        720.0
    } else if plans.len() == 1 {
        440.0
    } else {
        350.0
    };
    // Whole units, so that frames and images align with pixels.
    let extent = |plan: &PanelPlan| {
        let size = size(plan);
        let scale = longest / size[0].max(size[1]);
        size.map(|s| (s * scale).round().max(24.0))
    };
    // Left of a frame: a vertical label and the numbers.
    let left =
        plans.iter().map(|plan| axes::y_room(&plan_ticks(plan, extent(plan), units)[1])).fold(0.0, f64::max).ceil()
            + LABEL
            + 8.0;
    let has = |text: fn(&PanelPlan) -> &str| plans.iter().any(|plan| !text(plan).is_empty());
    let text = |plan: &PanelPlan| font::width(&plan.title, HEADING).max(font::width(&plan.note, NUMBER));
    // Headings wider than their frame are placed above the items next to the frame.
    let lift = if plans.iter().any(|plan| text(plan) > extent(plan)[0]) { LABEL + 6.0 } else { 0.0 };
    let headings =
        lift + if has(|p| &p.title) { HEADING + 6.0 } else { 0.0 } + if has(|p| &p.note) { NUMBER + 5.0 } else { 0.0 };
    let columns = columns(plans.len(), wide).next_multiple_of(if room.in_twos && !wide { 2 } else { 1 });
    let apart = if plans.len() > columns { 14.0 } else { 0.0 };
    let below = 8.0 + NUMBER + 6.0 + LABEL + room.below + apart;
    let cell = |plan: &PanelPlan| {
        let [w, h] = extent(plan);
        let over = 0.5 * (text(plan) - w);
        [(left.max(over) + w + room.right.max(over) + MARGIN).ceil(), (headings + h + below).ceil()]
    };
    let top = (MARGIN + TITLE + 10.0 + room.above).ceil();
    let cells: Vec<[f64; 2]> = plans.iter().map(cell).collect();
    let widths: Vec<f64> =
        (0..columns).map(|c| cells.iter().skip(c).step_by(columns).map(|cell| cell[0]).fold(0.0, f64::max)).collect();
    let heights: Vec<f64> =
        cells.chunks(columns).map(|row| row.iter().map(|cell| cell[1]).fold(0.0, f64::max)).collect();
    let [inner_width, inner_height]: [f64; 2] = [widths.iter().sum(), heights.iter().sum()];
    let width = (MARGIN + inner_width.max(room.least)).max(font::width(title, TITLE) + 2.0 * MARGIN);
    let mut picture = Picture::new(width.ceil(), top + inner_height + MARGIN, title);
    picture.text([0.5 * picture.width, MARGIN + 0.8 * TITLE], TITLE, Anchor::Middle, INK, title);

    let start = [MARGIN + ((width - MARGIN - inner_width) / 2.0).floor(), top];
    let mut frames = Vec::new();
    for (i, plan) in plans.iter().enumerate() {
        let [w, h] = extent(plan);
        let (row, column) = (i / columns, i % columns);
        let corner = [start[0] + widths[..column].iter().sum::<f64>(), start[1] + heights[..row].iter().sum::<f64>()];
        let tallest = plans.iter().skip(row * columns).take(columns).map(|plan| extent(plan)[1]).fold(0.0, f64::max);
        let lowered = tallest - h;
        let shift = (0.5 * (text(plan) - w) - left).max(0.0).ceil();
        let rect = Rect { x: corner[0] + left + shift, y: corner[1] + headings + lowered, width: w, height: h };
        let [left_end, right_end] = if plan.mirrored { [rect.right(), rect.x] } else { [rect.x, rect.right()] };
        let frame = SheetPanel {
            rect,
            x: Scale::new(plan.window[0], [left_end, right_end]),
            y: Scale::new(plan.window[1], [rect.bottom(), rect.y]),
        };
        label(&mut picture, plan, &frame, left, lift, units);
        frames.push(frame);
    }
    (picture, frames)
}
