//! Names and colours of fields, and their colour bar.

use super::PictureKind;
use super::axes::{self, Scale};
use super::color::{Color, ColorMap, INK};
use super::font::{self, HALF, LABEL, NUMBER, typeset};
use super::picture::{Anchor, Image, OutlinePiece, Picture, Rect, Stroke};
use super::ticks::{self, Ticks};
use crate::output::Lives;
use crate::units::{Measure, Units};

const BAR: f64 = 14.0;

/// Name, symbol, measured quantity and colour map of a field.
#[derive(Clone, Copy)]
pub(super) struct DrawnQuantity {
    pub name: &'static str,
    pub symbol: &'static str,
    pub measure: Measure,
    pub map: ColorMap,
}

impl DrawnQuantity {
    pub(super) fn of(kind: PictureKind) -> DrawnQuantity {
        match kind {
            PictureKind::VonMises => DrawnQuantity {
                name: "von Mises stress",
                symbol: "σ_{vM}",
                measure: Measure::Stress,
                map: ColorMap::Viridis,
            },
            PictureKind::Deformed => {
                DrawnQuantity {
                    name: "displacement", symbol: "‖u‖", measure: Measure::Length, map: ColorMap::Viridis
                }
            }
            _ => DrawnQuantity {
                name: "temperature",
                symbol: "θ",
                measure: Measure::Temperature,
                map: ColorMap::Inferno,
            },
        }
    }
}

/// `min 1, max 2 MPa at nodes`: the extremes of a field with their locations.
pub(super) fn extremes(units: Units, extent: [f64; 2], measure: Measure, lives: Lives) -> String {
    let (low, high, unit) = units.range(extent, measure);
    lives.after(format!("min {}, max {} {unit}", typeset(&low), typeset(&high)).trim_end())
}

/// The range of the colours: all values, except a few that are far above the rest.
///
/// Stresses are singular in corners and where conditions change; the triangles there would take most of the colours. At
/// most half a per cent of the area is left out, and only if the colours then cover less than four fifths of the
/// values.
pub(super) fn shown(values: &[[f64; 3]], areas: &[f64], [lo, hi]: [f64; 2]) -> [f64; 2] {
    let largest = |corners: &[f64; 3]| corners.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut by_value: Vec<(f64, f64)> = values.iter().map(largest).zip(areas.iter().copied()).collect();
    by_value.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
    let most = 0.005 * by_value.iter().map(|(_, area)| area).sum::<f64>();
    let mut above = 0.0;
    let rest = by_value.iter().find(|(_, area)| {
        above += area;
        above > most
    });
    match rest {
        Some((top, _)) if *top > lo && top - lo < 0.8 * (hi - lo) => [lo, *top],
        _ => [lo, hi],
    }
}

/// A field on the bodies of a picture: per body its extremes, its colours, and the largest value in the cells.
pub(super) struct FieldScales {
    kind: PictureKind,
    extents: Vec<[f64; 2]>,
    ranges: Vec<[f64; 2]>,
    /// The largest stress at the centre of a cell, or `None` if cell values are drawn.
    in_cells: Vec<Option<f64>>,
}

/// A field on a body, as a picture shows it.
pub(super) struct DrawnField<'a> {
    /// Its values at the corners of the triangles, and the areas of these.
    pub values: &'a [[f64; 3]],
    pub areas: Vec<f64>,
    /// The von Mises stresses of the cells, and those recovered at the nodes.
    pub cells: &'a [f64],
    pub nodal: &'a [f64],
}

impl FieldScales {
    /// The scales of fields of one kind; with `shared` all have the same colours.
    pub(super) fn new(kind: PictureKind, fields: &[DrawnField], shared: bool) -> FieldScales {
        let extents: Vec<[f64; 2]> = fields.iter().map(|field| common(field.values)).collect();
        let own = |(field, extent): (&DrawnField, &[f64; 2])| {
            if kind == PictureKind::VonMises { shown(field.values, &field.areas, *extent) } else { *extent }
        };
        let mut ranges: Vec<[f64; 2]> = fields.iter().zip(&extents).map(own).collect();
        if shared {
            let common = common(&ranges);
            ranges.fill(common);
        }
        let largest = |cells: &[f64]| cells.iter().copied().fold(0.0, f64::max);
        let in_cells = fields.iter().map(|field| (!field.nodal.is_empty()).then(|| largest(field.cells))).collect();
        FieldScales { kind, extents, ranges, in_cells }
    }

    /// Gives all bodies the extremes over all of them.
    pub(super) fn share_extremes(&mut self) {
        let extent = common(&self.extents);
        self.extents.fill(extent);
        let most = axes::range(self.in_cells.iter().flatten().copied()).map(|[_, most]| most);
        self.in_cells.fill(most);
    }

    /// The colour bar of a body, below its frame or on the right.
    pub(super) fn bar(&self, body: usize, units: Units, below: bool) -> ColorBar {
        ColorBar::new(&DrawnQuantity::of(self.kind), self.ranges[body], self.extents[body], units, below)
    }

    /// The extremes on a body. Stresses are drawn as recovered at the nodes; the largest value at the centre of a cell,
    /// which the summary reports, is added.
    pub(super) fn extremes(&self, body: usize, units: Units) -> String {
        let measure = DrawnQuantity::of(self.kind).measure;
        let with = |lives: Lives| extremes(units, self.extents[body], measure, lives);
        match (self.kind, self.in_cells[body]) {
            (PictureKind::VonMises, Some(cells)) => {
                let most = typeset(&units.write(cells, measure));
                format!("{}; {}", with(Lives::Recovered), Lives::Cell.after(&format!("up to {most}")))
            }
            (PictureKind::VonMises, None) => with(Lives::Cell),
            _ => with(Lives::Node),
        }
    }
}

/// The range of all values in some lists.
fn common<const N: usize>(lists: &[[f64; N]]) -> [f64; 2] {
    axes::range(lists.iter().flatten().copied()).unwrap_or([0.0, 1.0])
}

/// A colour bar, on the right of a frame or below it.
pub(super) struct ColorBar {
    map: ColorMap,
    range: [f64; 2],
    /// True if there are values above the range: the bar then ends in a point.
    pointed: bool,
    ticks: Ticks,
    label: String,
    below: bool,
}

impl ColorBar {
    const POINT: f64 = 10.0;

    pub(super) fn new(
        quantity: &DrawnQuantity,
        range: [f64; 2],
        extent: [f64; 2],
        units: Units,
        below: bool,
    ) -> ColorBar {
        // A field of one value has a bar, too.
        let shown = axes::padded(range, 0.0);
        let ticks = ticks::in_units(shown, 7, units, quantity.measure);
        let label = axes::labelled(quantity.symbol, ticks.exponent, units, quantity.measure);
        ColorBar { map: quantity.map, range: shown, pointed: extent[1] > shown[1], ticks, label, below }
    }

    /// Red, green and blue of a value.
    pub(super) fn color(&self, value: f64) -> [u8; 3] {
        self.map.of(self.range, value)
    }

    /// The values with a mark.
    pub(super) fn levels(&self) -> impl Iterator<Item = f64> {
        self.ticks.marks.iter().map(|(level, _)| *level)
    }

    /// Width of the bar and its labels on the right of the frame.
    pub(super) fn room(&self) -> f64 {
        let numbers = self.ticks.marks.iter().map(|(_, text)| font::width(text, NUMBER)).fold(0.0, f64::max);
        14.0 + font::width(&self.label, LABEL).max(BAR + 7.0 + numbers)
    }

    /// Draws the bar next to a frame.
    pub(super) fn draw(&self, picture: &mut Picture, rect: Rect) {
        const STEPS: u32 = 256;
        let point = if self.pointed { ColorBar::POINT } else { 0.0 };
        let place = if self.below {
            let width = (0.5 * rect.width).max(200.0).min(rect.width);
            Rect { x: rect.x, y: rect.bottom() + 56.0, width, height: BAR }
        } else {
            Rect { x: rect.right() + 14.0, y: rect.y + point, width: BAR, height: rect.height - point }
        };
        let color = |i: u32| {
            let [red, green, blue] = self.map.at(f64::from(i) / f64::from(STEPS - 1));
            [red, green, blue, 255]
        };
        let image = if self.below {
            Image { width: STEPS, height: 1, rgba: (0..STEPS).flat_map(color).collect() }
        } else {
            Image { width: 1, height: STEPS, rgba: (0..STEPS).rev().flat_map(color).collect() }
        };
        picture.image(place, image);
        let mut outline = place.corners();
        if self.pointed {
            let tip = if self.below {
                [place.right() + point, place.y + 0.5 * BAR]
            } else {
                [place.x + 0.5 * BAR, place.y - point]
            };
            let [red, green, blue, _] = color(STEPS - 1);
            let first = usize::from(self.below);
            picture.polygon(vec![outline[first], tip, outline[first + 1]], Color { red, green, blue, opacity: 1.0 });
            outline.insert(first + 1, tip);
        }
        picture.shape(vec![OutlinePiece { points: outline, closed: true }], None, Some(Stroke::new(INK, 0.8)));
        if self.below {
            axes::x_marks(picture, place, &Scale::new(self.range, [place.x, place.right()]), &self.ticks, false, true);
            picture.text([place.right() + point + 12.0, place.bottom() - 2.0], LABEL, Anchor::Start, INK, &self.label);
        } else {
            let scale = Scale::new(self.range, [place.bottom(), place.y]);
            let marks: Vec<_> = self
                .ticks
                .marks
                .iter()
                .map(|(v, _)| [[place.right(), scale.at(*v)], [place.right() + 4.0, scale.at(*v)]])
                .collect();
            picture.lines(&marks, Stroke::new(INK, 0.8));
            for (v, text) in &self.ticks.marks {
                picture.text([place.right() + 7.0, scale.at(*v) + HALF * NUMBER], NUMBER, Anchor::Start, INK, text);
            }
            picture.text([place.x, rect.y - 8.0], LABEL, Anchor::Start, INK, &self.label);
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp)] // the values are exact

    use super::super::body::PlaneMesh;
    use super::*;
    use crate::mesh::{Diagonal, Mesh};

    #[test]
    fn a_few_cells_far_above_the_rest_are_off_the_scale() -> Result<(), Box<dyn std::error::Error>> {
        let body = PlaneMesh::of_mesh(&Mesh::rectangle([1.0, 1.0], [20, 20], Diagonal::Right)?)?;
        let mut stress: Vec<[f64; 3]> = (0..800).map(|c| [1.0 + f64::from(c) / 800.0; 3]).collect();
        assert_eq!(shown(&stress, &body.areas(), [1.0, 2.0]), [1.0, 2.0]);
        // Three of 800 cells are less than half a per cent of the area, ten are more.
        for c in 0..3 {
            stress[c] = [9.0; 3];
        }
        let [lo, hi] = shown(&stress, &body.areas(), [1.0, 9.0]);
        assert!(lo <= 1.0 && hi > 1.99 && hi < 2.0, "{lo} to {hi}");
        for c in 0..10 {
            stress[c] = [9.0; 3];
        }
        assert_eq!(shown(&stress, &body.areas(), [1.0, 9.0]), [1.0, 9.0]);
        Ok(())
    }
}
