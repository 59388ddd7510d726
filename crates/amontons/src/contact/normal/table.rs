//! A pressure tabulated over the penetration.

use super::{NormalLaw, Pressure};
use crate::contact::{PiecewiseLinear, TableFault};
use crate::tensor::Point;

/// p linear between the points of a table that starts at (r₀, 0), r₀ ≤ 0, and does not decrease; the last piece is
/// extended beyond the last point. With r₀ < 0 the pressure begins in the gap, as for rough surfaces and gaskets; (H8)
/// does not cover it.
#[derive(Clone, Debug, PartialEq)]
pub struct PressureTable {
    /// p in Pa at r in m.
    table: PiecewiseLinear,
}

/// Reason why a table is no law for the pressure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PressureTableFault {
    /// It is no function.
    Table(TableFault),
    /// The first point has a pressure, or a positive penetration.
    Start {
        /// First penetration.
        penetration: f64,
        /// First pressure.
        pressure: f64,
    },
    /// The pressure decreases.
    Falls {
        /// A pressure.
        before: f64,
        /// The one after it.
        next: f64,
    },
}

impl PressureTableFault {
    /// The value found, for messages.
    #[must_use]
    pub fn found(&self) -> String {
        match self {
            PressureTableFault::Table(fault) => fault.found(),
            PressureTableFault::Start { penetration, pressure } => {
                format!("a pressure of {pressure:?} at the penetration {penetration:?} at the beginning")
            }
            PressureTableFault::Falls { before, next } => format!("the pressure {next:?} after {before:?}"),
        }
    }

    /// The value expected, for messages.
    #[must_use]
    pub fn expected(&self) -> &'static str {
        match self {
            PressureTableFault::Table(fault) => fault.expected(),
            PressureTableFault::Start { .. } => "the pressure 0 at a penetration of at most 0",
            PressureTableFault::Falls { .. } => "pressures that do not fall",
        }
    }
}

impl std::fmt::Display for PressureTableFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}, expected {}", self.found(), self.expected())
    }
}

impl std::error::Error for PressureTableFault {}

impl From<TableFault> for PressureTableFault {
    fn from(fault: TableFault) -> PressureTableFault {
        PressureTableFault::Table(fault)
    }
}

impl PressureTable {
    /// The law through the points of penetration in m and pressure in Pa.
    ///
    /// # Errors
    /// Fails if the points are no function, do not start at (r₀, 0) with r₀ ≤ 0, or the pressure decreases.
    pub fn new(penetration: &[f64], pressure: &[f64]) -> Result<PressureTable, PressureTableFault> {
        let table = PiecewiseLinear::new(penetration, pressure)?;
        let (penetration, pressure) = table.points()[0];
        if !(penetration <= 0.0 && pressure == 0.0) {
            return Err(PressureTableFault::Start { penetration, pressure });
        }
        if let Some(pair) = table.points().windows(2).find(|pair| pair[1].1 < pair[0].1) {
            return Err(PressureTableFault::Falls { before: pair[0].1, next: pair[1].1 });
        }
        Ok(PressureTable { table })
    }

    /// r₀, the penetration at which the pressure begins, in m.
    fn start(&self) -> f64 {
        self.table.points().first().map_or(0.0, |first| first.0)
    }
}

impl NormalLaw for PressureTable {
    fn pressure(&self, _x: &Point, z: f64, _rate: f64, _lambda: f64) -> Pressure {
        if z <= self.start() {
            return Pressure::default();
        }
        let (value, slope) = self.table.extended(z);
        Pressure { value, slope, by_rate: 0.0 }
    }
    /// ∫ p dr, from the penetration where the pressure begins.
    fn potential(&self, x: &Point, r: f64) -> f64 {
        let points = self.table.points().iter().copied().filter(|p| p.0 < r);
        let end = (r, self.pressure(x, r, 0.0, 0.0).value);
        let mut last = (self.start(), 0.0);
        let mut sum = 0.0;
        for point in points.chain((r > self.start()).then_some(end)) {
            sum += 0.5 * (point.0 - last.0) * (point.1 + last.1);
            last = point;
        }
        sum
    }
    fn lipschitz(&self) -> Option<f64> {
        Some(self.table.slopes().fold(0.0, f64::max))
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<(std::sync::Arc<dyn NormalLaw>, f64)> {
    let touching = PressureTable::new(&[0.0, 1e-4, 2e-4, 4e-4], &[0.0, 2.0, 3.0, 30.0]);
    let before = PressureTable::new(&[-2e-4, -1e-4, 0.0, 2e-4], &[0.0, 2.0, 3.0, 30.0]);
    touching
        .into_iter()
        .chain(before)
        .map(|law| (std::sync::Arc::new(law) as std::sync::Arc<dyn NormalLaw>, 3e-4))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_that_are_no_laws() {
        let fault = |r: &[f64], p: &[f64]| PressureTable::new(r, p).err();
        assert_eq!(fault(&[0.0, 1.0], &[0.0, 1.0]), None);
        assert_eq!(fault(&[-0.1, 1.0], &[0.0, 1.0]), None);
        assert_eq!(
            fault(&[-0.1, 1.0], &[0.2, 1.0]),
            Some(PressureTableFault::Start { penetration: -0.1, pressure: 0.2 })
        );
        assert_eq!(
            fault(&[0.1, 1.0], &[0.0, 1.0]),
            Some(PressureTableFault::Start { penetration: 0.1, pressure: 0.0 })
        );
        assert_eq!(
            fault(&[0.0, 1.0, 2.0], &[0.0, 1.0, 0.5]),
            Some(PressureTableFault::Falls { before: 1.0, next: 0.5 })
        );
        assert_eq!(fault(&[0.0], &[0.0]), Some(PressureTableFault::Table(TableFault::Few { found: 1 })));
    }
}
