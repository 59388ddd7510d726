//! Numbers with a unit: `"210 GPa"`, `"3 mm"`, `"20 °C"`.
//!
//! The unit of a key is taken from its description, which names the SI unit: `Young's modulus E in Pa`.

/// A unit as a power of ten times a factor, in the base units kg, m, s and K.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unit {
    /// Exponents of kg, m, s and K.
    dimension: [i32; 4],
    ten: i32,
    factor: f64,
    /// True for °C alone: a temperature on another scale than K.
    is_celsius: bool,
}

/// A number with a unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NumberWithUnit {
    /// The number in SI units, for °C alone on the Celsius scale.
    pub number: f64,
    pub unit: Unit,
}

/// A text that begins with a number.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum NumberText {
    Quantity(NumberWithUnit),
    /// A number and an unknown word.
    Unknown(String),
}

const NONE: Unit = Unit { dimension: [0; 4], ten: 0, factor: 1.0, is_celsius: false };

const fn of(dimension: [i32; 4], ten: i32) -> Unit {
    Unit { dimension, ten, factor: 1.0, is_celsius: false }
}

/// Units that take prefixes.
const PREFIXED: [(&str, Unit); 9] = [
    ("m", of([0, 1, 0, 0], 0)),
    ("g", of([1, 0, 0, 0], -3)),
    ("s", of([0, 0, 1, 0], 0)),
    ("K", of([0, 0, 0, 1], 0)),
    ("N", of([1, 1, -2, 0], 0)),
    ("Pa", of([1, -1, -2, 0], 0)),
    ("J", of([1, 2, -2, 0], 0)),
    ("W", of([1, 2, -3, 0], 0)),
    ("Hz", of([0, 0, -1, 0], 0)),
];

/// Units that take no prefixes.
const PLAIN: [(&str, Unit); 10] = [
    ("°C", Unit { is_celsius: true, ..of([0, 0, 0, 1], 0) }),
    ("degC", Unit { is_celsius: true, ..of([0, 0, 0, 1], 0) }),
    ("bar", of([1, -1, -2, 0], 5)),
    ("min", Unit { factor: 6.0, ..of([0, 0, 1, 0], 1) }),
    ("h", Unit { factor: 36.0, ..of([0, 0, 1, 0], 2) }),
    ("rad", NONE),
    ("°", Unit { factor: std::f64::consts::PI / 180.0, ..NONE }),
    ("deg", Unit { factor: std::f64::consts::PI / 180.0, ..NONE }),
    ("%", of([0; 4], -2)),
    ("1", NONE),
];

const PREFIXES: [(&str, i32); 12] = [
    ("p", -12),
    ("n", -9),
    ("µ", -6),
    ("μ", -6),
    ("u", -6),
    ("m", -3),
    ("c", -2),
    ("d", -1),
    ("h", 2),
    ("k", 3),
    ("M", 6),
    ("G", 9),
];

const SUPERSCRIPTS: [(char, char); 11] = [
    ('⁰', '0'),
    ('¹', '1'),
    ('²', '2'),
    ('³', '3'),
    ('⁴', '4'),
    ('⁵', '5'),
    ('⁶', '6'),
    ('⁷', '7'),
    ('⁸', '8'),
    ('⁹', '9'),
    ('⁻', '-'),
];

/// Largest exponent of a unit.
const MOST: i32 = 9;

impl Unit {
    /// Reads a unit such as `W/(m² K)`: factors with exponents, divided by others. After a `/` stands one factor, or
    /// several in parentheses.
    pub fn parse(text: &str) -> Option<Unit> {
        let text = text.trim();
        let mut unit: Option<Unit> = None;
        let (mut rest, mut divides) = (text, false);
        loop {
            rest = rest.trim_start_matches([' ', '·', '*', '\u{a0}']);
            let (factor, behind) = if let Some(inner) = rest.strip_prefix('(').filter(|_| divides) {
                let (inner, behind) = inner.split_once(')')?;
                (Unit::parse(inner).filter(|_| !inner.contains(['/', '(']))?, behind)
            } else {
                let end = rest.find([' ', '·', '*', '/', '(', ')', '\u{a0}']).unwrap_or(rest.len());
                let (word, behind) = rest.split_at(end);
                (factor(word)?, behind)
            };
            let factor = if divides { factor.power(-1) } else { factor };
            // °C alone is a temperature; in a product it is a difference of temperatures.
            unit = Some(
                unit.map_or(Unit { is_celsius: factor.is_celsius && !divides, ..factor }, |unit| unit.times(factor)),
            );
            rest = behind.trim_start();
            if rest.is_empty() {
                return unit;
            }
            divides = rest.starts_with('/');
            rest = rest.strip_prefix('/').unwrap_or(rest);
        }
    }

    /// True for a coherent SI unit.
    fn is_coherent(&self) -> bool {
        self.ten == 0 && self.factor.to_bits() == 1f64.to_bits() && !self.is_celsius
    }

    fn times(self, other: Unit) -> Unit {
        let dimension = std::array::from_fn(|i| self.dimension[i] + other.dimension[i]);
        Unit { dimension, ten: self.ten + other.ten, factor: self.factor * other.factor, is_celsius: false }
    }

    fn power(self, n: i32) -> Unit {
        Unit {
            dimension: self.dimension.map(|d| d * n),
            ten: self.ten * n,
            factor: self.factor.powi(n),
            is_celsius: self.is_celsius && n == 1,
        }
    }

    /// True if quantities in both units can be compared. With `per_length` this unit may also be per length, as for
    /// data per unit of thickness in the plane.
    pub fn is_like(&self, other: &Unit, per_length: bool) -> bool {
        let of_plane = other.times(of([0, -1, 0, 0], 0));
        self.dimension == other.dimension || (per_length && self.dimension == of_plane.dimension)
    }

    /// True for °C alone.
    pub fn is_celsius(&self) -> bool {
        self.is_celsius
    }

    /// True for the unit of a pure number, such as %; of the units of angles only the radian.
    pub fn is_number(&self) -> bool {
        self.dimension == [0; 4] && self.factor.to_bits() == 1f64.to_bits()
    }

    /// True for a temperature.
    pub fn is_temperature(&self) -> bool {
        self.dimension == [0, 0, 0, 1]
    }
}

/// One symbol with its exponent: `mm²`, `s^-1`, `m3`.
fn factor(word: &str) -> Option<Unit> {
    let plain: String =
        word.chars().map(|c| SUPERSCRIPTS.iter().find(|(high, _)| *high == c).map_or(c, |(_, low)| *low)).collect();
    let named = |word: &str| PLAIN.iter().find(|(name, _)| *name == word).map(|(_, unit)| *unit);
    if let Some(unit) = named(&plain) {
        return Some(unit);
    }
    let end = plain.find(|c: char| c.is_ascii_digit() || c == '^' || c == '-').unwrap_or(plain.len());
    let (symbol, exponent) = plain.split_at(end);
    let exponent = exponent.strip_prefix('^').unwrap_or(exponent);
    let n: i32 = if exponent.is_empty() { 1 } else { exponent.parse().ok()? };
    if !(-MOST..=MOST).contains(&n) {
        return None;
    }
    let base = |word: &str| PREFIXED.iter().find(|(name, _)| *name == word).map(|(_, unit)| *unit);
    let prefixed = || {
        PREFIXES.iter().find_map(|(prefix, ten)| {
            let unit = base(symbol.strip_prefix(prefix)?)?;
            Some(Unit { ten: unit.ten + ten, ..unit })
        })
    };
    Some(named(symbol).or_else(|| base(symbol)).or_else(prefixed)?.power(n))
}

/// Reads a number with a unit, or returns `None` for another text, such as an expression.
pub(super) fn read(text: &str) -> Option<NumberText> {
    let text = text.trim();
    let (mantissa, exponent, rest) = number(text)?;
    let is_apart = rest.starts_with([' ', '\u{a0}']);
    let word = rest.trim_start_matches([' ', '\u{a0}']);
    if !(word.starts_with(|c: char| c.is_alphabetic() || "°%".contains(c)) || word.starts_with("1/")) {
        return None;
    }
    let Some(unit) = Unit::parse(word) else {
        // `2x` is an expression without its `*`, not a quantity with an unknown unit.
        return is_apart.then(|| NumberText::Unknown(word.to_owned()));
    };
    // One rounding only: 7 mm are 0.007 to the last bit.
    let number = format!("{mantissa}e{}", exponent.saturating_add(unit.ten)).parse::<f64>().ok()? * unit.factor;
    Some(NumberText::Quantity(NumberWithUnit { number, unit }))
}

/// Digits and exponent of the number at the start of a text, and the rest of the text.
fn number(text: &str) -> Option<(&str, i32, &str)> {
    let digits = |from: usize| {
        let rest = text.get(from..).unwrap_or_default();
        from + rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len())
    };
    let sign = usize::from(text.starts_with(['+', '-']));
    let whole = digits(sign);
    let end = if text.get(whole..)?.starts_with('.') { digits(whole + 1) } else { whole };
    let mantissa = text.get(..end).filter(|mantissa| mantissa.contains(|c: char| c.is_ascii_digit()))?;
    let rest = text.get(end..)?;
    if let Some(exponent) = rest.strip_prefix(['e', 'E']) {
        let first = end + 1 + usize::from(exponent.starts_with(['+', '-']));
        let last = digits(first);
        if last > first {
            let exponent = text.get(end + 1..last)?.parse().ok()?;
            return Some((mantissa, exponent, text.get(last..)?));
        }
    }
    Some((mantissa, 0, rest))
}

/// The SI unit named after `in` in a description, with its text: `Pa s` in `Damping of the dashpot in Pa s.`
pub(super) fn of_description(description: &str) -> Option<(Unit, &str)> {
    let paragraph = description.split("\n\n").next().unwrap_or_default();
    paragraph.match_indices(" in ").find_map(|(at, word)| {
        let text = paragraph.get(at + word.len()..)?;
        let ends = text.char_indices().map(|(i, c)| (i, Some(c))).chain([(text.len(), None)]);
        let units = ends.filter(|&(i, next)| is_end(text.get(i..).unwrap_or_default(), next)).filter_map(|(i, _)| {
            let text = text.get(..i)?;
            Some((Unit::parse(text).filter(Unit::is_coherent)?, text))
        });
        // The longest text that is a unit: `Pa s`, not `Pa`.
        units.fold(None, |_, unit| Some(unit))
    })
}

/// True if a unit may end here: at a punctuation mark, or before a word.
fn is_end(rest: &str, next: Option<char>) -> bool {
    match next {
        None | Some(',' | ';' | ':' | '.' | '\n') => true,
        Some(' ') => {
            let word = rest.trim_start().split([' ', ',', ';', ':', '.', '\n']).next().unwrap_or_default();
            word.len() > 1 && word.chars().all(|c| c.is_ascii_lowercase())
        }
        Some(_) => false,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::panic, reason = "a test fails by panicking")]

    use super::*;

    fn number(text: &str) -> f64 {
        match read(text) {
            Some(NumberText::Quantity(quantity)) => quantity.number,
            other => panic!("{text}: {other:?}"),
        }
    }

    #[test]
    fn quantities_are_the_numbers_that_one_would_write() {
        for (text, expected) in [
            ("210 GPa", 210e9),
            ("7 mm", 0.007),
            ("1.1mm", 0.0011),
            ("-3e2 µm", -3e-4),
            ("3 μm", 3e-6),
            ("0.3 um", 3e-7),
            ("12e-6 1/K", 12e-6),
            ("12 K^-1", 12.0),
            ("7850 kg/m³", 7850.0),
            ("7.85 g/cm^3", 7850.0),
            ("50 W/(m K)", 50.0),
            ("50 W/m/K", 50.0),
            ("50 W/(m °C)", 50.0),
            ("20 °C", 20.0),
            ("20 degC", 20.0),
            ("200 N/mm²", 2e8),
            ("200 N/mm2", 2e8),
            ("2 bar", 2e5),
            ("1.5 h", 5400.0),
            ("2 min", 120.0),
            ("3.6 km/h", 1.0),
            ("30 deg", std::f64::consts::PI / 6.0),
            ("40 %", 0.4),
            ("2 MPa s", 2e6),
            ("2 MPa·s", 2e6),
            (".5 kN", 500.0),
            ("4.2e3 J/(kg K)", 4200.0),
        ] {
            assert!((number(text) - expected).abs() <= 1e-16 * expected.abs(), "{text}: {:?}", number(text));
        }
        // An exponent beyond the range of numbers stays there with any unit.
        let extremes = [number("1e2147483647 km"), number("1e-2147483648 mm")].map(f64::to_bits);
        assert_eq!(extremes, [f64::INFINITY, 0.0].map(f64::to_bits));
        // Decimal units take one rounding: the result is the number written in SI, to the last bit.
        for (text, expected) in [("1.1 mm", 1.1e-3), ("0.3 µm", 0.3e-6), ("2.1e2 GPa", 2.1e11), ("7.3 g/cm³", 7300.0)]
        {
            assert_eq!(number(text).to_bits(), f64::to_bits(expected), "{text}");
        }
    }

    #[test]
    fn expressions_and_names_are_none() {
        for text in ["2*x", "2", "x", "sin(x)", "2x", "2t", "3 + x", "2 (x)", "", "-", "1e5", ".", "m", "2 - 1 m"] {
            assert_eq!(read(text), None, "{text}");
        }
        for text in [
            "3 furlong",
            "2 x",
            "5 W/(m",
            "5 W//m",
            "5 W/(m/K)",
            "5 mm^10",
            "5 m^-2147483648",
            "5 m^1.5",
            "3 m/",
            "1 KPa",
        ] {
            assert!(matches!(read(text), Some(NumberText::Unknown(_))), "{text}");
        }
    }

    #[test]
    fn descriptions_name_units() {
        for (description, expected) in [
            ("Young's modulus E in Pa.", Some("Pa")),
            ("Heat flux into the body, −q·ν, in W/m².", Some("W/m²")),
            ("Conductivity of the gas in W/(m K).", Some("W/(m K)")),
            ("Stiffness in Pa in the order 11 22", Some("Pa")),
            ("Viscosity in Pa s in the order 11 22", Some("Pa s")),
            ("Density ρ in kg/m³; 0: quasistatic.\n\nRequired in s.", Some("kg/m³")),
            ("Temperature at t = 0 in K; default: of `heat` at t = 0.", Some("K")),
            ("Strain rate δ in 1/s below which it is constant.", Some("1/s")),
            ("Factor of the power law in W/(m² K m^exponent).", None),
            ("Consistency K in Pa sⁿ.", None),
            ("Factor c in Pa/m^exponent.", None),
            ("Factor of the coordinates: 0.001 if the file is in mm.", None),
            ("A number or an expression in t.", None),
        ] {
            assert_eq!(of_description(description).map(|(_, text)| text), expected, "{description}");
        }
    }

    #[test]
    fn units_are_compared_by_their_dimensions() {
        let unit = |text: &str| Unit::parse(text).unwrap_or(NONE);
        assert!(unit("N/mm²").is_like(&unit("Pa"), false) && unit("Pa/m").is_like(&unit("N/m³"), false));
        assert!(!unit("N").is_like(&unit("Pa"), false) && !unit("1/K").is_like(&unit("K"), false));
        assert!(unit("J/(m K)").is_like(&unit("J/K"), true) && !unit("J/(m K)").is_like(&unit("J/K"), false));
        assert!(unit("°C").is_celsius() && !unit("1/°C").is_celsius() && !unit("W/(m °C)").is_celsius());
    }
}
