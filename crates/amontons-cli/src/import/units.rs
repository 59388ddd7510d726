//! The units of a deck, and the notation of numbers.

use crate::arguments::DeckUnits;

/// Factors from the units of a deck to those of the case.
#[derive(Clone, Copy, Debug)]
pub struct UnitFactors {
    pub length: f64,
    mass: f64,
    pub time: f64,
    pub dimensionless: bool,
}

impl From<DeckUnits> for UnitFactors {
    fn from(units: DeckUnits) -> UnitFactors {
        let (length, mass, time) = match units {
            DeckUnits::None | DeckUnits::MKgS => (1.0, 1.0, 1.0),
            DeckUnits::MmNS => (1e-3, 1e3, 1.0),
            DeckUnits::MmKgMs => (1e-3, 1.0, 1e-3),
        };
        UnitFactors { length, mass, time, dimensionless: units == DeckUnits::None }
    }
}

impl UnitFactors {
    /// Factor of pressure, stress and moduli.
    pub fn stress(&self) -> f64 {
        self.mass / (self.length * self.time * self.time)
    }

    pub fn force(&self) -> f64 {
        self.mass * self.length / (self.time * self.time)
    }

    pub fn moment(&self) -> f64 {
        self.force() * self.length
    }

    pub fn density(&self) -> f64 {
        self.mass / self.length.powi(3)
    }

    /// Factor of accelerations.
    pub fn acceleration(&self) -> f64 {
        self.length / (self.time * self.time)
    }

    /// Factor of specific heat per mass and kelvin.
    pub fn specific_heat(&self) -> f64 {
        (self.length / self.time).powi(2)
    }

    /// Factor of conductivities.
    pub fn conductivity(&self) -> f64 {
        self.mass * self.length / self.time.powi(3)
    }

    /// Factor of heat fluxes per area, film coefficients and conductances of gaps.
    pub fn flux(&self) -> f64 {
        self.mass / self.time.powi(3)
    }

    /// Factor of contact stiffnesses: pressure per length.
    pub fn slope(&self) -> f64 {
        self.stress() / self.length
    }

    /// Factor of heat and force per volume.
    pub fn per_volume(&self, of_area: f64) -> f64 {
        of_area / self.length
    }
}

/// A number in the case, without the round-off of the conversion of units.
pub fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.13e}").parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0.0".to_owned(),
        size if (1e-3..1e6).contains(&size) => format!("{rounded:?}"),
        _ => format!("{rounded:e}"),
    }
}

/// Numbers as an array of the case.
pub fn numbers(values: impl IntoIterator<Item = f64>) -> String {
    format!("[{}]", values.into_iter().map(number).collect::<Vec<_>>().join(", "))
}

/// A text in TOML notation.
pub fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
