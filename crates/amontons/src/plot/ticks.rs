//! Marks of an axis and their labels.

use crate::units::{Measure, Units};

/// Marks of an axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ticks {
    /// Values with their labels, ascending.
    pub marks: Vec<(f64, String)>,
    /// Values with a mark but no label.
    pub minor: Vec<f64>,
    /// Power of ten by which the labels are multiplied.
    pub exponent: i32,
}

/// Marks at multiples of 1, 2, 2.5 or 5 times a power of ten, at most `most` of them, in a closed interval. The labels
/// have the power of ten of a prefix, if the unit has one.
pub(super) fn in_units(range: [f64; 2], most: usize, units: Units, measure: Measure) -> Ticks {
    let power = power_of_thousand(range[0].abs().max(range[1].abs()));
    let takes_it = !units.of(measure).is_empty() && units.prefixed(power, measure).is_some();
    marks(range, most, |largest| if takes_it { power } else { exponent(largest) })
}

fn marks([lo, hi]: [f64; 2], most: usize, exponent: impl Fn(f64) -> i32) -> Ticks {
    let span = hi - lo;
    if !(span.is_finite() && span > 0.0) {
        return Ticks { marks: vec![(lo, number(lo))], minor: Vec::new(), exponent: 0 };
    }
    let step = step(lo, hi, most.max(2));
    let (first, count) = multiples(lo, hi, step);
    let largest = lo.abs().max(hi.abs());
    let exponent = exponent(largest);
    let unit = 10f64.powi(exponent);
    let decimals = decimals(step / unit);
    let marks = (0..count).map(|i| (first + i as f64) * step).map(|v| (v, fixed(v / unit, decimals))).collect();
    Ticks { marks, minor: Vec::new(), exponent }
}

/// The smallest round step with at most `most` multiples between `lo` and `hi`.
fn step(lo: f64, hi: f64, most: usize) -> f64 {
    let raw = (hi - lo) / most as f64;
    let power = 10f64.powf(raw.log10().floor());
    [1.0, 2.0, 2.5, 5.0, 10.0, 20.0]
        .iter()
        .map(|m| m * power)
        .find(|&s| multiples(lo, hi, s).1 <= most)
        .unwrap_or(50.0 * power)
}

/// The first multiple of a step not below `lo`, counted in steps, and the number of multiples up to `hi`.
fn multiples(lo: f64, hi: f64, step: f64) -> (f64, usize) {
    // An end that is a multiple up to rounding belongs to the interval.
    let slack = 1e-9 * (hi - lo) / step;
    let first = (lo / step - slack).ceil();
    let last = (hi / step + slack).floor();
    (first, if last < first { 0 } else { (last - first) as usize + 1 })
}

/// Power of ten, a multiple of three, that keeps labels short: the largest is from 0.4 to 400.
fn exponent(largest: f64) -> i32 {
    if (0.01..10_000.0).contains(&largest) { 0 } else { power_of_thousand(largest) }
}

fn power_of_thousand(largest: f64) -> i32 {
    if largest > 0.0 && largest.is_finite() { 3 * ((largest.log10() + 0.4) / 3.0).floor() as i32 } else { 0 }
}

/// Decimals that write multiples of a step exactly.
fn decimals(step: f64) -> usize {
    (0..12)
        .find(|&d| {
            let scaled = step * 10f64.powi(d);
            (scaled - scaled.round()).abs() < 1e-6 * scaled
        })
        .unwrap_or(12) as usize
}

fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let is_zero = text.chars().all(|c| matches!(c, '0' | '.' | '-'));
    match text.strip_prefix('-') {
        Some(rest) if is_zero => rest.to_owned(),
        Some(rest) => format!("−{rest}"),
        None => text,
    }
}

/// Marks of a logarithmic axis from `lo` to `hi`, both positive: powers of ten, and 2 and 5 times them if there would
/// be few.
pub(super) fn logarithmic(lo: f64, hi: f64) -> Ticks {
    let (first, last) = (lo.log10().floor() as i32, hi.log10().ceil() as i32);
    let inside = |v: &f64| *v >= lo * (1.0 - 1e-9) && *v <= hi * (1.0 + 1e-9);
    let all = |factors: &[f64]| -> Vec<f64> {
        (first..=last).flat_map(|e| factors.iter().map(move |m| m * 10f64.powi(e))).filter(inside).collect()
    };
    let powers = all(&[1.0]);
    let (values, every) =
        if powers.len() >= 3 { (powers, (last - first) as usize / 8 + 1) } else { (all(&[1.0, 2.0, 5.0]), 1) };
    let marks = values.iter().step_by(every).map(|&v| (v, power_label(v))).collect();
    Ticks { marks, minor: all(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]), exponent: 0 }
}

/// Label of a power of ten: `10^{−3}` or `2·10^{−3}`.
fn power_label(value: f64) -> String {
    let e = (value.log10() + 1e-9).floor() as i32;
    let m = (value / 10f64.powi(e)).round();
    let power = format!("10^{{{}}}", e.to_string().replace('-', "−"));
    if m < 1.5 { power } else { format!("{m}·{power}") }
}

/// A number in a few digits: 0.25, 1, 12000, 3.1·10^{−7}.
pub(super) fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let magnitude = value.abs();
    if (1e-3..1e6).contains(&magnitude) {
        let digits = (3 - magnitude.log10().floor() as i32).clamp(0, 12) as usize;
        let text = format!("{value:.digits$}");
        let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        return text.replace('-', "−");
    }
    let text = format!("{value:.2e}");
    let (mantissa, e) = text.split_once('e').unwrap_or((&text, "0"));
    let mantissa = mantissa.trim_end_matches('0').trim_end_matches('.');
    format!("{mantissa}·10^{{{e}}}").replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn linear(lo: f64, hi: f64, most: usize) -> Ticks {
        in_units([lo, hi], most, Units::PLANE.without(), Measure::Number)
    }

    #[test]
    fn labels_follow_the_prefix_of_the_unit() {
        let t = in_units([0.0, 0.012], 4, Units::PLANE, Measure::Length);
        assert_eq!((t.exponent, labels(&t)), (-3, vec!["0", "5", "10"]));
        let t = in_units([0.0, 4.5e6], 5, Units::PLANE, Measure::Stress);
        assert_eq!((t.exponent, labels(&t)), (6, vec!["0", "1", "2", "3", "4"]));
        // Kelvins take no power of a thousand.
        assert_eq!(in_units([0.0, 1500.0], 4, Units::PLANE, Measure::Temperature).exponent, 0);
    }

    fn labels(t: &Ticks) -> Vec<&str> {
        t.marks.iter().map(|(_, l)| l.as_str()).collect()
    }

    #[test]
    fn marks_are_nice_and_inside() {
        assert_eq!(labels(&linear(0.0, 1.0, 6)), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(&linear(-0.3, 2.6, 4)), ["0", "1", "2"]);
        assert_eq!(labels(&linear(-2.2, 2.2, 5)), ["−2", "−1", "0", "1", "2"]);
        for &(lo, hi) in &[(0.0, 0.0925), (-1e-17, 3e-16), (123_456.0, 123_789.0), (-0.05, 0.0003), (2.0, 2.000_1)] {
            for most in 3..9 {
                let t = linear(lo, hi, most);
                assert!(t.marks.len() >= 2 && t.marks.len() <= most, "{lo} {hi} {most}: {:?}", t.marks);
                assert!(t.marks.iter().all(|m| m.0 >= lo - 1e-9 * (hi - lo) && m.0 <= hi + 1e-9 * (hi - lo)));
                let mut distinct = labels(&t);
                distinct.dedup();
                assert_eq!(distinct.len(), t.marks.len(), "{lo} {hi} {most}: {distinct:?}");
            }
        }
    }

    #[test]
    fn labels_share_a_power_of_ten() {
        let t = linear(0.0, 0.0012, 4);
        assert_eq!((t.exponent, labels(&t)), (-3, vec!["0.0", "0.5", "1.0"]));
        let t = linear(0.0, 45_000.0, 5);
        assert_eq!((t.exponent, labels(&t)), (3, vec!["0", "10", "20", "30", "40"]));
        let t = linear(-3e-7, 7e-16, 6);
        for (v, label) in &t.marks {
            let read: f64 = label.replace('−', "-").parse().unwrap_or(f64::NAN);
            assert!((read * 10f64.powi(t.exponent) - v).abs() < 1e-15, "{label} stands at {v}");
        }
        assert_eq!(linear(0.0, 7.7e-16, 4).exponent, -15);
    }

    #[test]
    fn an_empty_interval_has_one_mark() {
        assert_eq!(labels(&linear(1.0, 1.0, 5)), ["1"]);
        assert_eq!(linear(0.0, f64::NAN, 5).marks.len(), 1);
    }

    #[test]
    fn logarithmic_marks() {
        assert_eq!(labels(&logarithmic(1e-4, 0.2)), ["10^{−4}", "10^{−3}", "10^{−2}", "10^{−1}"]);
        assert_eq!(labels(&logarithmic(3e-3, 4e-2)), ["5·10^{−3}", "10^{−2}", "2·10^{−2}"]);
        assert!(logarithmic(1e-30, 1e30).marks.len() < 12);
    }

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (1.0, "1"),
            (0.25, "0.25"),
            (-3.0, "−3"),
            (1200.0, "1200"),
            (1.0 / 3.0, "0.3333"),
            (3.1e-7, "3.1·10^{−7}"),
            (0.0, "0"),
        ] {
            assert_eq!(number(value), text);
        }
    }
}
