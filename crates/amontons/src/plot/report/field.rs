//! A field over the snapshots of a page, in its display unit.

use serde_json::{Value, json};

use super::pack::Pack;
use crate::plot::axes;
use crate::plot::color::ColorMap;
use crate::units::{Measure, Units};

/// A field with one number, or the components of a vector, per vertex and snapshot.
#[derive(Clone, Debug)]
pub(super) struct PageField {
    pub name: String,
    /// Symbol with subscripts, as in pictures; empty for none.
    pub symbol: &'static str,
    pub measure: Measure,
    pub map: ColorMap,
    /// One list per component, which holds one list per snapshot.
    pub components: Vec<Vec<Vec<f64>>>,
    /// The colour range, or `None` for the range of all values.
    pub shown: Option<[f64; 2]>,
}

/// The unit for values up to this size, and the factor that converts them to it.
pub(super) fn reading(units: Units, largest: f64, measure: Measure) -> (String, f64) {
    let power = units.power(largest, measure);
    match units.prefixed(power, measure) {
        Some(unit) => (unit, 10f64.powi(-power)),
        None => (units.of(measure).to_owned(), 1.0),
    }
}

impl PageField {
    fn values(&self) -> impl Iterator<Item = f64> {
        self.components.iter().flatten().flatten().copied()
    }

    /// The values; magnitudes of a vector.
    fn magnitudes(&self) -> Vec<f64> {
        let [first, others @ ..] = &self.components[..] else { return Vec::new() };
        if others.is_empty() {
            return self.values().collect();
        }
        let square = |at: usize, i: usize| self.components.iter().map(|c| c[at][i].powi(2)).sum::<f64>();
        let all = first.iter().enumerate().flat_map(|(at, values)| (0..values.len()).map(move |i| (at, i)));
        all.map(|(at, i)| square(at, i).sqrt()).collect()
    }

    /// True if there is a finite value other than zero.
    pub(super) fn is_told(&self) -> bool {
        self.values().any(|v| v != 0.0 && v.is_finite())
    }

    /// The field on the page: description and numbers of its arrays.
    pub(super) fn write(&self, units: Units, pack: &mut Pack) -> Value {
        let [low, high] = axes::range(self.values()).unwrap_or([0.0, 0.0]);
        let extent = axes::range(self.magnitudes()).unwrap_or([0.0, 0.0]);
        let shown = self.shown.unwrap_or(extent);
        let largest = extent[0].abs().max(extent[1].abs());
        let (unit, factor) = reading(units, largest, self.measure);
        let mut arrays = |values: &Vec<Vec<f64>>| -> Vec<usize> {
            values.iter().map(|at| pack.shares(at.iter().copied(), [low, high])).collect()
        };
        let components: Vec<Vec<usize>> = self.components.iter().map(&mut arrays).collect();
        json!({
            "name": self.name,
            "symbol": self.symbol,
            "unit": unit,
            "factor": factor,
            "map": match self.map { ColorMap::Viridis => "viridis", ColorMap::Inferno => "inferno" },
            "range": [low * factor, high * factor],
            "extent": extent.map(|v| v * factor),
            "shown": shown.map(|v| v * factor),
            "arrays": components,
        })
    }
}
