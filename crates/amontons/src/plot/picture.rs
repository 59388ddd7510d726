//! A picture as a list of shapes, texts and images, from which SVG and PNG are written.

use super::color::{Color, SOFT};
use super::font::NUMBER;

/// Longest side of a picture, in pixels of a PNG and in units: a unit has at least one pixel, so that texts are
/// legible.
const LONGEST: f64 = 4000.0;
/// Pixels of an image per unit of the picture.
pub(super) const DENSITY: f64 = 2.0;
/// Height of a note below a picture.
const NOTE: f64 = 20.0;
pub(super) const MARGIN: f64 = 16.0;

/// A rectangle; y grows downwards, as in all coordinates of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Rect {
    pub x: f64,
    pub y: f64,
    pub width: f64,
    pub height: f64,
}

impl Rect {
    pub(super) fn right(&self) -> f64 {
        self.x + self.width
    }
    pub(super) fn bottom(&self) -> f64 {
        self.y + self.height
    }
    /// Numbers of pixels of an image in it.
    pub(super) fn pixels(&self) -> [u32; 2] {
        [self.width, self.height].map(|length| (length * DENSITY).ceil().clamp(1.0, 4096.0) as u32)
    }
    pub(super) fn corners(&self) -> Vec<[f64; 2]> {
        vec![[self.x, self.y], [self.right(), self.y], [self.right(), self.bottom()], [self.x, self.bottom()]]
    }
}

/// Colour, width and dashes of a line.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Stroke {
    pub color: Color,
    pub width: f64,
    /// Lengths of dashes and gaps; empty for a solid line.
    pub dashes: Vec<f64>,
}

impl Stroke {
    pub(super) fn new(color: Color, width: f64) -> Stroke {
        Stroke { color, width, dashes: Vec::new() }
    }
    pub(super) fn dashed(self, dashes: &[f64]) -> Stroke {
        Stroke { dashes: dashes.to_vec(), ..self }
    }
}

/// The point of a text that is placed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// A piece of the outline of a shape.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct OutlinePiece {
    pub points: Vec<[f64; 2]>,
    pub closed: bool,
}

#[derive(Clone, Debug)]
pub(super) enum Item {
    Shape { lines: Vec<OutlinePiece>, fill: Option<Color>, stroke: Option<Stroke> },
    Text { at: [f64; 2], size: f64, anchor: Anchor, upwards: bool, color: Color, text: String },
    Image { place: Rect, image: Image },
}

impl Item {
    /// The item moved right and down.
    fn moved(mut self, [dx, dy]: [f64; 2]) -> Item {
        match &mut self {
            Item::Shape { lines, .. } => {
                lines.iter_mut().flat_map(|line| &mut line.points).for_each(|p| *p = [p[0] + dx, p[1] + dy]);
            }
            Item::Text { at, .. } => *at = [at[0] + dx, at[1] + dy],
            Item::Image { place, .. } => (place.x, place.y) = (place.x + dx, place.y + dy),
        }
        self
    }
}

/// An image of straight RGBA pixels, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Image {
    pub width: u32,
    pub height: u32,
    pub rgba: Vec<u8>,
}

impl Image {
    /// Exchanges left and right.
    pub(super) fn mirror(&mut self) {
        for row in self.rgba.chunks_exact_mut(4 * self.width as usize) {
            for i in 0..self.width as usize / 2 {
                let j = self.width as usize - 1 - i;
                (0..4).for_each(|c| row.swap(4 * i + c, 4 * j + c));
            }
        }
    }
}

#[cfg(test)]
impl Image {
    /// Red, green, blue and opacity of the pixel in column i and row j, from the upper left.
    pub fn pixel(&self, i: u32, j: u32) -> [u8; 4] {
        let at = 4 * (j * self.width + i) as usize;
        std::array::from_fn(|c| self.rgba[at + c])
    }
}

/// Widths of the columns and heights of the rows of pictures in this many columns.
fn extents(pictures: &[Picture], columns: usize) -> [Vec<f64>; 2] {
    let widest = |c: usize| pictures.iter().skip(c).step_by(columns).map(|p| p.width).fold(0.0, f64::max);
    let heights = pictures.chunks(columns).map(|row| row.iter().map(|p| p.height).fold(0.0, f64::max));
    [(0..columns).map(widest).collect(), heights.collect()]
}

/// Pictures in rows of this many columns, aligned at the lower ends of a row.
pub(super) fn beside(title: impl Into<String>, pictures: Vec<Picture>, columns: usize) -> Picture {
    let [widths, heights] = extents(&pictures, columns);
    let mut all = Picture::new(widths.iter().sum(), heights.iter().sum(), title);
    for (k, picture) in pictures.into_iter().enumerate() {
        let (row, column) = (k / columns, k % columns);
        let left: f64 = widths[..column].iter().sum();
        let bottom: f64 = heights[..=row].iter().sum();
        let by = [left + (0.5 * (widths[column] - picture.width)).floor(), bottom - picture.height];
        all.items.extend(picture.items.into_iter().map(|item| item.moved(by)));
    }
    all
}

/// A drawn picture, which can be written as SVG or PNG; both show the same.
#[derive(Clone, Debug)]
pub struct Picture {
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) title: String,
    pub(super) items: Vec<Item>,
}

impl Picture {
    /// A blank picture; the title describes it to readers who cannot see it.
    pub(super) fn new(width: f64, height: f64, title: impl Into<String>) -> Picture {
        Picture { width: width.ceil(), height: height.ceil(), title: title.into(), items: Vec::new() }
    }

    /// Joins pictures vertically, in several columns if one would be too high. With `what`, the name of the pictures,
    /// only the first ones are kept if they do not fit a sheet.
    pub(super) fn stacked(title: impl Into<String>, mut pictures: Vec<Picture>, what: Option<&str>) -> Picture {
        let count = pictures.len();
        let mut columns = 1;
        loop {
            let longest = |columns: usize| {
                let [widths, heights] = extents(&pictures, columns);
                widths.iter().sum::<f64>().max(heights.iter().sum())
            };
            // The smallest number of columns for which the longer side is short enough, else the one with the shortest.
            let fits = (1..=pictures.len()).find(|&columns| longest(columns) <= 0.5 * LONGEST);
            let shortest = || (1..=pictures.len()).min_by(|&a, &b| longest(a).total_cmp(&longest(b)));
            columns = fits.or_else(shortest).unwrap_or(columns);
            if pictures.len() < 2 || what.is_none() || longest(columns) <= LONGEST - NOTE {
                break;
            }
            pictures.pop();
        }
        let shown = pictures.len();
        let all = beside(title, pictures, columns);
        match what.filter(|_| shown < count) {
            Some(what) => all.noted(&format!("{shown} of {count} {what} shown")),
            None => all,
        }
    }

    /// The picture above a line of text.
    pub(super) fn noted(mut self, text: &str) -> Picture {
        self.text([0.5 * self.width, self.height + 0.4 * NOTE], NUMBER, Anchor::Middle, SOFT, text);
        self.height += NOTE;
        self
    }

    /// True if a side, with a note, is longer than a sheet may be.
    pub(super) fn is_too_large(&self) -> bool {
        self.width.max(self.height) > LONGEST - NOTE
    }

    /// Pixels per unit: as requested, or fewer so that no side has more than 4000 pixels.
    #[must_use]
    pub fn density(&self, pixels: f64) -> f64 {
        let most = LONGEST / self.width.max(self.height);
        if pixels > most { most } else { pixels }
    }

    /// Adds an arrow between two points.
    pub(super) fn arrow(&mut self, from: [f64; 2], to: [f64; 2], color: Color, width: f64) {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let length = dx.hypot(dy);
        let (x, y, head) = (dx / length, dy / length, (3.5 * width).min(0.6 * length));
        let back = [to[0] - head * x, to[1] - head * y];
        let wing = |side: f64| [back[0] - side * 0.5 * head * y, back[1] + side * 0.5 * head * x];
        self.line(&[from, back], Stroke::new(color, width));
        self.polygon(vec![wing(1.0), to, wing(-1.0)], color);
    }

    /// Width and height in units of 1/96 inch.
    #[must_use]
    pub fn size(&self) -> (f64, f64) {
        (self.width, self.height)
    }

    /// Adds a line through points.
    pub(super) fn line(&mut self, points: &[[f64; 2]], stroke: Stroke) {
        self.lines(&[points], stroke);
    }

    /// Adds several lines as one shape.
    pub(super) fn lines<P: AsRef<[[f64; 2]]>>(&mut self, lines: &[P], stroke: Stroke) {
        let lines =
            lines.iter().map(|points| OutlinePiece { points: points.as_ref().to_vec(), closed: false }).collect();
        self.shape(lines, None, Some(stroke));
    }

    /// Adds a filled polygon.
    pub(super) fn polygon(&mut self, points: Vec<[f64; 2]>, fill: Color) {
        self.shape(vec![OutlinePiece { points, closed: true }], Some(fill), None);
    }

    /// Adds the outline of a rectangle.
    pub(super) fn frame(&mut self, rect: Rect, stroke: Stroke) {
        self.shape(vec![OutlinePiece { points: rect.corners(), closed: true }], None, Some(stroke));
    }

    /// Adds a shape, filled by the even–odd rule. Points that are not finite are left out.
    pub(super) fn shape(&mut self, mut lines: Vec<OutlinePiece>, fill: Option<Color>, stroke: Option<Stroke>) {
        for line in &mut lines {
            line.points.retain(|p| p[0].is_finite() && p[1].is_finite());
        }
        lines.retain(|line| line.points.len() > 1);
        if !lines.is_empty() {
            self.items.push(Item::Shape { lines, fill, stroke });
        }
    }

    /// Adds a text on a baseline.
    pub(super) fn text(&mut self, at: [f64; 2], size: f64, anchor: Anchor, color: Color, text: impl Into<String>) {
        self.items.push(Item::Text { at, size, anchor, upwards: false, color, text: text.into() });
    }

    /// Adds a vertical text that reads upwards, centred at a point of its baseline.
    pub(super) fn text_upwards(&mut self, at: [f64; 2], size: f64, color: Color, text: impl Into<String>) {
        self.items.push(Item::Text { at, size, anchor: Anchor::Middle, upwards: true, color, text: text.into() });
    }

    /// Adds an image.
    pub(super) fn image(&mut self, place: Rect, image: Image) {
        self.items.push(Item::Image { place, image });
    }
}

impl Anchor {
    /// Offset of the start of a text of this width from the point at which it is placed.
    pub(super) fn offset(self, width: f64) -> f64 {
        match self {
            Anchor::Start => 0.0,
            Anchor::Middle => -0.5 * width,
            Anchor::End => -width,
        }
    }
}
