//! Units of numbers, which depend on the dimension of the body, and their readable form.
//!
//! Units are defined in this module only. A plane body without a thickness is taken per metre of it, a body on a line
//! per square metre of cross-section; integrals over a body of revolution extend over the full turn, 2πr dr dz, and so
//! have the units of a body in space. Summary, pictures, the units of columns in `manifest.json` and the tables of the
//! book use this module. Files for programs keep all digits: only [`Units::write`], [`Units::range`] and
//! [`Units::vector`] round.

use serde::{Deserialize, Serialize};

/// The system of units of a case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum UnitSystem {
    /// SI units.
    #[default]
    #[serde(rename = "SI")]
    Si,
    /// Numbers without units.
    #[serde(rename = "dimensionless")]
    Dimensionless,
}

/// The temperature scale of a case. Temperature differences are in K on both scales.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum TemperatureScale {
    /// K.
    #[default]
    #[serde(rename = "K")]
    Kelvin,
    /// °C.
    #[serde(rename = "°C")]
    Celsius,
}

impl TemperatureScale {
    /// True for kelvin, the default scale.
    #[must_use]
    pub fn is_kelvin(&self) -> bool {
        *self == TemperatureScale::Kelvin
    }
}

/// Domain of integrals over a body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Extent {
    /// A body on a line: per m² of its cross-section.
    Line,
    /// A plane body: per m of its thickness.
    #[default]
    Plane,
    /// A plane body of a given thickness: the whole body.
    Sheet,
    /// A body of revolution: the full turn.
    Revolution,
    /// A body in space.
    Space,
}

/// The units of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Units {
    /// SI or none.
    pub system: UnitSystem,
    /// Domain of forces, energies, powers, areas and volumes.
    pub extent: Extent,
    /// The temperature scale; omitted from files if it is kelvin.
    #[serde(default, skip_serializing_if = "TemperatureScale::is_kelvin")]
    pub temperature: TemperatureScale,
}

/// The quantity measured by a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// A count or a ratio.
    Number,
    /// Time.
    Time,
    /// Coordinates, displacements, gaps, depths.
    Length,
    /// Velocity.
    Velocity,
    /// Temperature.
    Temperature,
    /// Difference of two temperatures.
    TemperatureDifference,
    /// Stress and pressure.
    Stress,
    /// Heat flux through a surface.
    HeatFlux,
    /// Work per area of a surface.
    SurfaceWork,
    /// Force on a body, an integral over a side.
    Force,
    /// Moment of the forces on a side about a point or an axis.
    Moment,
    /// Rotation.
    Angle,
    /// Energy, work and heat of a body.
    Energy,
    /// Power and heat flow.
    Power,
    /// Area of a side.
    Area,
    /// Volume of a body, or worn off a side.
    Volume,
    /// Mass of a body.
    Mass,
}

/// Prefixes of units with their powers of ten.
const PREFIXES: [(i32, &str); 9] =
    [(-12, "p"), (-9, "n"), (-6, "µ"), (-3, "m"), (0, ""), (3, "k"), (6, "M"), (9, "G"), (12, "T")];

/// 3 − log₁₀ 999.5.
const ROUNDED_UP: f64 = 2.172_02e-4;

/// The least and the largest power of ten of the prefixes of a unit.
fn prefixes(symbol: &str) -> [i32; 2] {
    match symbol {
        // Seconds, kelvins and radians are not counted in thousands, and prefixes of areas or volumes would be squared
        // or cubed.
        "s" | "K" | "rad" => [-12, 0],
        "m" | "m/s" => [-12, 3],
        // Millipascals are not in use.
        "Pa" => [0, 12],
        "" | "°C" | "m²" | "m³" | "m²/m" | "m³/m" | "m²/m²" | "m³/m²" => [0, 0],
        _ => [-12, 12],
    }
}

impl Units {
    /// SI units of a body in the plane.
    pub const PLANE: Units =
        Units { system: UnitSystem::Si, extent: Extent::Plane, temperature: TemperatureScale::Kelvin };
    /// SI units of a body in space.
    pub const SPACE: Units = Units { extent: Extent::Space, ..Units::PLANE };

    /// Makes the numbers dimensionless.
    #[must_use]
    pub fn without(self) -> Units {
        Units { system: UnitSystem::Dimensionless, ..self }
    }

    /// The unit of a quantity without prefix; empty for counts, ratios and dimensionless cases.
    #[must_use]
    pub fn of(self, measure: Measure) -> &'static str {
        let by_extent = |all: [&'static str; 3]| match self.extent {
            Extent::Line => all[0],
            Extent::Plane => all[1],
            Extent::Sheet | Extent::Revolution | Extent::Space => all[2],
        };
        if self.system == UnitSystem::Dimensionless {
            return "";
        }
        match measure {
            Measure::Number => "",
            Measure::Time => "s",
            Measure::Length => "m",
            Measure::Velocity => "m/s",
            Measure::Temperature if self.temperature == TemperatureScale::Celsius => "°C",
            Measure::Temperature | Measure::TemperatureDifference => "K",
            Measure::Stress => "Pa",
            Measure::HeatFlux => "W/m²",
            Measure::SurfaceWork => "J/m²",
            Measure::Force => by_extent(["N/m²", "N/m", "N"]),
            Measure::Moment => by_extent(["N m/m²", "N m/m", "N m"]),
            Measure::Angle => "rad",
            Measure::Energy => by_extent(["J/m²", "J/m", "J"]),
            Measure::Power => by_extent(["W/m²", "W/m", "W"]),
            Measure::Area => by_extent(["m²/m²", "m²/m", "m²"]),
            Measure::Volume => by_extent(["m³/m²", "m³/m", "m³"]),
            Measure::Mass => by_extent(["kg/m²", "kg/m", "kg"]),
        }
    }

    /// The power of ten, a multiple of three, of the prefix with which a number of this size is written; zero if its
    /// unit takes no prefix.
    #[must_use]
    pub fn power(self, value: f64, measure: Measure) -> i32 {
        let [least, most] = prefixes(self.of(measure));
        let size = value.abs();
        if !(size.is_finite() && size > 0.0) {
            return 0;
        }
        // A number that three digits round up to the next thousand has the next prefix: 999.96 is 1.00 k.
        let power = 3 * ((size.log10() + ROUNDED_UP).floor() as i32).div_euclid(3);
        // A number too small for every prefix has a power of ten instead.
        if power < least { 0 } else { power.min(most) }
    }

    /// The unit with the prefix of a power of ten: `kPa`; `None` if the unit has no such prefix.
    #[must_use]
    pub fn prefixed(self, power: i32, measure: Measure) -> Option<String> {
        let unit = self.of(measure);
        let [least, most] = prefixes(unit);
        let prefix = PREFIXES.iter().find(|(p, _)| *p == power && (least..=most).contains(p))?.1;
        Some(format!("{prefix}{unit}"))
    }

    /// A number as an engineer writes it: `2.13 µm`, `60.4 kJ`, `-3.2 kN/m`; without a unit `0.0125` or `2.13e-6`.
    #[must_use]
    pub fn write(self, value: f64, measure: Measure) -> String {
        let power = self.power(value, measure);
        let unit = self.prefixed(power, measure).unwrap_or_default();
        format!("{} {unit}", Units::digits(value, power, measure)).trim_end().to_owned()
    }

    /// Writes one of several values, the largest of which is `beside`: round-off of that is written as zero.
    #[must_use]
    pub fn write_beside(self, value: f64, beside: f64, measure: Measure) -> String {
        self.write(beyond(value, beside), measure)
    }

    /// The ends of a range in a common unit, and the unit: `("-3.2", "12", "µm")`.
    #[must_use]
    pub fn range(self, [low, high]: [f64; 2], measure: Measure) -> (String, String, String) {
        let largest = low.abs().max(high.abs());
        let power = self.power(largest, measure);
        let unit = self.prefixed(power, measure).unwrap_or_default();
        let scaled = |value: f64| value / 10f64.powi(power);
        // The number of decimals is that of the larger end.
        let digits = Units::DIGITS[usize::from(measure == Measure::Temperature)] as i32 - 1;
        let decimals = digits.saturating_sub(scaled(largest).log10().floor() as i32);
        let number = |value: f64| match usize::try_from(decimals) {
            Ok(decimals) if largest > 0.0 && decimals < 8 => rounded(scaled(value), decimals),
            _ => Units::digits(value, power, measure),
        };
        (number(low), number(high), unit)
    }

    /// A number with all its digits and its unit: `0.125 s`.
    #[must_use]
    pub fn exact(self, value: f64, measure: Measure) -> String {
        format!("{value} {}", self.of(measure)).trim_end().to_owned()
    }

    /// The components of a vector in one unit: `(0, -824) N/m`.
    #[must_use]
    pub fn vector(self, components: &[f64], measure: Measure) -> String {
        self.vector_beside(components, 0.0, measure)
    }

    /// Writes a sum of vectors with components as large as `beside`: round-off of these, or of the largest component,
    /// is written as zero.
    #[must_use]
    pub fn vector_beside(self, components: &[f64], beside: f64, measure: Measure) -> String {
        let largest = components.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let most = largest.max(beside);
        let power = if beyond(largest, most) == 0.0 { 0 } else { self.power(largest, measure) };
        let number = |v: &f64| Units::digits(beyond(*v, most), power, measure);
        let numbers: Vec<String> = components.iter().map(number).collect();
        format!("({}) {}", numbers.join(", "), self.prefixed(power, measure).unwrap_or_default()).trim_end().to_owned()
    }

    /// Three digits, but four for temperatures, whose zero is far away.
    const DIGITS: [usize; 2] = [3, 4];

    fn digits(value: f64, power: i32, measure: Measure) -> String {
        significant(value / 10f64.powi(power), Units::DIGITS[usize::from(measure == Measure::Temperature)])
    }
}

/// Fraction of the largest of several values that is round-off, and a value that counts as zero in any unit.
const ROUND_OFF: f64 = 1e-9;
const NOTHING: f64 = 1e-290;

/// A value, or zero if it is round-off of the largest value `beside`.
#[must_use]
pub fn beyond(value: f64, beside: f64) -> f64 {
    if value.abs() < (ROUND_OFF * beside).max(NOTHING) { 0.0 } else { value }
}

/// A number rounded to `digits` digits, without trailing zeros.
fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return value.to_string();
    }
    let scientific = format!("{value:.*e}", digits - 1);
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if !(-4..6).contains(&exponent) {
        return format!("{}e{exponent}", trimmed(mantissa));
    }
    // Rounded once, to these digits: zeros replace the digits cut off.
    let rounded: f64 = scientific.parse().unwrap_or(value);
    self::rounded(rounded, usize::try_from(digits as i32 - 1 - exponent).unwrap_or(0))
}

/// A number with at most `decimals` decimals; zero has no sign.
fn rounded(value: f64, decimals: usize) -> String {
    let text = trimmed(&format!("{value:.decimals$}"));
    if text == "-0" { "0".to_owned() } else { text }
}

/// A decimal number without trailing zeros.
fn trimmed(text: &str) -> String {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_engineers_write_them() {
        let cases = [
            (2.13e-6, Measure::Length, "2.13 µm"),
            (60_380.0, Measure::Energy, "60.4 kJ"),
            (-3200.0, Measure::Force, "-3.2 kN"),
            (-0.0, Measure::Energy, "0 J"),
            (0.0, Measure::Number, "0"),
            (999.96, Measure::Stress, "1 kPa"),
            (999.4, Measure::Stress, "999 Pa"),
            (999.5, Measure::Stress, "1 kPa"),
            (0.999_96, Measure::Length, "1 m"),
            (1234.0, Measure::Time, "1230 s"),
            (0.02, Measure::Time, "20 ms"),
            (2.1e11, Measure::Stress, "210 GPa"),
            (1500.0, Measure::Temperature, "1500 K"),
            (293.15, Measure::Temperature, "293.1 K"),
            (0.0031, Measure::Area, "0.0031 m²"),
            (2e-9, Measure::Volume, "2e-9 m³"),
            (0.0125, Measure::Number, "0.0125"),
            (123_456.0, Measure::Number, "123000"),
            (2.134e-6, Measure::Number, "2.13e-6"),
            (1e-20, Measure::Length, "1e-20 m"),
            (f64::NAN, Measure::Length, "NaN m"),
        ];
        for (value, measure, text) in cases {
            assert_eq!(Units::SPACE.write(value, measure), text, "{value:e}");
        }
    }

    /// A written number of any size reads back within half a unit of the third digit.
    #[test]
    fn what_is_written_is_the_number() {
        for i in -119..140 {
            let value = 1.234_567 * 10f64.powf(f64::from(i) * 0.1);
            let text = Units::SPACE.write(-value, Measure::Force);
            let (number, unit) = text.split_once(' ').unwrap_or((&text, ""));
            let prefix = unit.trim_end_matches('N');
            let power = PREFIXES.iter().find(|(_, p)| *p == prefix).map_or(i32::MAX, |p| p.0);
            let read = -number.parse::<f64>().unwrap_or(f64::NAN) * 10f64.powi(power);
            assert!((read - value).abs() <= 5.001e-3 * value, "{value:e} is written {text}");
            assert!(
                number.parse::<f64>().is_ok_and(|n| (0.999..1000.0).contains(&n.abs())),
                "{value:e} is written {text}"
            );
        }
    }

    #[test]
    fn a_range_has_one_unit() {
        let text = |range, measure| {
            let (low, high, unit) = Units::PLANE.range(range, measure);
            format!("{low} … {high} {unit}")
        };
        assert_eq!(text([-3.2e-6, 1.2e-5], Measure::Length), "-3.2 … 12 µm");
        assert_eq!(text([20.0, 50.0], Measure::Temperature), "20 … 50 K");
        assert_eq!(text([0.0, 2.5e6], Measure::Stress), "0 … 2.5 MPa");
        assert_eq!(text([-0.003_484, 15.108], Measure::Temperature), "0 … 15.11 K");
        assert_eq!(text([0.0, 0.0], Measure::Stress), "0 … 0 Pa");
        assert_eq!(text([1.694e-6, 7.5e-5], Measure::Length), "1.7 … 75 µm");
        // Round-off of the largest component is zero.
        assert_eq!(Units::PLANE.vector(&[-1.8e-13, -823.9], Measure::Force), "(0, -824) N/m");
        assert_eq!(Units::SPACE.without().vector(&[0.5, -2.0, 1e-3], Measure::Force), "(0.5, -2, 0.001)");
    }

    /// Per metre of thickness in the plane, per square metre of cross-section on a line, whole for the full turn and in
    /// space; nothing without units.
    #[test]
    fn integrals_have_the_units_of_their_extent() {
        let of = |extent, measure| Units { extent, ..Units::PLANE }.of(measure);
        for (measure, line, plane, whole) in [
            (Measure::Force, "N/m²", "N/m", "N"),
            (Measure::Energy, "J/m²", "J/m", "J"),
            (Measure::Power, "W/m²", "W/m", "W"),
            (Measure::Area, "m²/m²", "m²/m", "m²"),
            (Measure::Volume, "m³/m²", "m³/m", "m³"),
        ] {
            assert_eq!(
                [Extent::Line, Extent::Plane, Extent::Revolution, Extent::Space].map(|e| of(e, measure)),
                [line, plane, whole, whole]
            );
            assert_eq!(Units::PLANE.without().of(measure), "");
        }
        assert_eq!(Units::PLANE.without().write(-0.0, Measure::Energy), "0");
        assert_eq!(Units::PLANE.without().write(6.04e4, Measure::Energy), "60400");
    }

    #[test]
    fn prefixes_stand_where_the_unit_takes_them() {
        assert_eq!(Units::SPACE.prefixed(3, Measure::Stress).as_deref(), Some("kPa"));
        assert_eq!(Units::SPACE.prefixed(3, Measure::Temperature), None);
        let celsius = Units { temperature: TemperatureScale::Celsius, ..Units::SPACE };
        let written = [Measure::Temperature, Measure::TemperatureDifference].map(|of| celsius.write(-1.25, of));
        assert_eq!(written, ["-1.25 °C", "-1.25 K"]);
        // A power of ten has no prefix, and no pressure is in mPa.
        assert_eq!(Units::SPACE.write(6.26e-34, Measure::Length), "6.26e-34 m");
        assert_eq!(Units::SPACE.write(0.65, Measure::Stress), "0.65 Pa");
        // A sum that is the round-off of its terms.
        assert_eq!(Units::SPACE.vector_beside(&[1.3e-12, 1e-13], 1e3, Measure::Force), "(0, 0) N");
        assert_eq!(Units::SPACE.prefixed(-3, Measure::Area), None);
        assert_eq!(Units::SPACE.without().prefixed(3, Measure::Stress), None);
        assert_eq!(Units::SPACE.without().prefixed(0, Measure::Stress).as_deref(), Some(""));
    }
}
