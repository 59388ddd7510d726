//! Colours: perceptually uniform maps for fields and a palette for lines.

/// A colour with opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Color {
    pub red: u8,
    pub green: u8,
    pub blue: u8,
    /// 0: invisible, 1: opaque.
    pub opacity: f64,
}

impl Color {
    /// The opaque colour 0xRRGGBB.
    pub(super) const fn new(rgb: u32) -> Color {
        Color { red: (rgb >> 16) as u8, green: (rgb >> 8) as u8, blue: rgb as u8, opacity: 1.0 }
    }

    /// The colour with this opacity.
    pub(super) const fn with_opacity(self, opacity: f64) -> Color {
        Color { opacity, ..self }
    }
}

pub(super) const WHITE: Color = Color::new(0xFF_FF_FF);
/// Text and frames.
pub(super) const INK: Color = Color::new(0x22_22_22);
/// Secondary text.
pub(super) const SOFT: Color = Color::new(0x55_55_55);
pub(super) const GRID: Color = Color::new(0xE4_E4_E4);
/// Zero lines and reference shapes.
pub(super) const GREY: Color = Color::new(0xA8_A8_A8);

/// Colours that colour-blind readers can distinguish: M. Okabe and K. Ito, *Color universal design* (2008).
pub(super) const BLUE: Color = Color::new(0x00_72_B2);
pub(super) const VERMILION: Color = Color::new(0xD5_5E_00);
pub(super) const GREEN: Color = Color::new(0x00_9E_73);
pub(super) const ORANGE: Color = Color::new(0xE6_9F_00);
pub(super) const PURPLE: Color = Color::new(0xCC_79_A7);
pub(super) const SKY: Color = Color::new(0x56_B4_E9);
/// Colours of lines in drawing order.
pub(super) const LINES: [Color; 6] = [BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY];

/// Number of intervals between the samples of a colour map.
const INTERVALS: usize = 32;

/// A perceptually uniform colour map.
///
/// The tables are samples at i/32 of the maps of the same names in matplotlib (S. van der Walt and N. Smith, 2015),
/// which are in the public domain (CC0). Linear interpolation differs from the originals by less than 2/255.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColorMap {
    /// From dark violet over green to yellow.
    Viridis,
    /// From black over red to light yellow.
    Inferno,
}

impl ColorMap {
    fn table(self) -> &'static [u32; INTERVALS + 1] {
        match self {
            ColorMap::Viridis => &VIRIDIS,
            ColorMap::Inferno => &INFERNO,
        }
    }

    /// Red, green and blue at a position from 0 to 1; positions outside take the colour of the nearer end.
    #[must_use]
    pub fn at(self, place: f64) -> [u8; 3] {
        let place = if place.is_nan() { 0.0 } else { place.clamp(0.0, 1.0) * INTERVALS as f64 };
        let i = (place as usize).min(INTERVALS - 1);
        let s = place - i as f64;
        let table = self.table();
        let (a, b) = (Color::new(table[i]), Color::new(table[i + 1]));
        let mix = |a: u8, b: u8| (f64::from(a) + s * (f64::from(b) - f64::from(a))).round() as u8;
        [mix(a.red, b.red), mix(a.green, b.green), mix(a.blue, b.blue)]
    }

    /// Red, green and blue of a value in a range; those of the middle if the range is one value.
    pub(super) fn of(self, [lo, hi]: [f64; 2], value: f64) -> [u8; 3] {
        self.at(if hi > lo { (value - lo) / (hi - lo) } else { 0.5 })
    }
}

#[rustfmt::skip]
#[allow(clippy::unreadable_literal)]
const VIRIDIS: [u32; INTERVALS + 1] = [
    0x440154, 0x470D60, 0x48186A, 0x482374, 0x472D7B, 0x453681, 0x424086, 0x3F4989, 0x3B528B, 0x375A8D, 0x33638D,
    0x2F6A8E, 0x2C728E, 0x297A8E, 0x26818E, 0x23898E, 0x21908C, 0x1F988B, 0x1F9F88, 0x21A685, 0x28AE80, 0x31B57B,
    0x3EBC74, 0x4CC26C, 0x5DC963, 0x6ECE58, 0x82D34C, 0x96D83F, 0xABDC32, 0xC0DF24, 0xD5E21A, 0xEAE51A, 0xFDE725,
];

#[rustfmt::skip]
#[allow(clippy::unreadable_literal)]
const INFERNO: [u32; INTERVALS + 1] = [
    0x000004, 0x040312, 0x0B0724, 0x150B37, 0x210C4A, 0x2E0A5A, 0x3C0965, 0x4A0C6B, 0x57106D, 0x63146E, 0x70196E,
    0x7D1E6D, 0x89226A, 0x962766, 0xA32B61, 0xAF315C, 0xBB3755, 0xC63E4D, 0xD14644, 0xDB4F3B, 0xE35932, 0xEB6528,
    0xF1711E, 0xF67F14, 0xF98D0A, 0xFB9C06, 0xFCAB0F, 0xFBBA1F, 0xF9CA32, 0xF5D949, 0xF2E865, 0xF3F586, 0xFCFFA4,
];

#[cfg(test)]
mod tests {
    use super::*;

    /// CIE lightness L* of an sRGB colour.
    fn lightness(rgb: [u8; 3]) -> f64 {
        let linear = rgb.map(|c| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        });
        let y = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
        if y > 216.0 / 24389.0 { 116.0 * y.cbrt() - 16.0 } else { y * 24389.0 / 27.0 }
    }

    #[test]
    fn lightness_rises_evenly() {
        for map in [ColorMap::Viridis, ColorMap::Inferno] {
            let steps: Vec<f64> = (0..=INTERVALS).map(|i| lightness(map.at(i as f64 / INTERVALS as f64))).collect();
            let mean = (steps[INTERVALS] - steps[0]) / INTERVALS as f64;
            for (i, pair) in steps.windows(2).enumerate() {
                let rise = pair[1] - pair[0];
                assert!(
                    rise > 0.3 * mean && rise < 1.7 * mean,
                    "{map:?} rises by {rise:.2} in interval {i}, the mean is {mean:.2}"
                );
            }
        }
    }

    #[test]
    fn ends_and_what_lies_outside() {
        assert_eq!(ColorMap::Viridis.at(0.0), [0x44, 0x01, 0x54]);
        assert_eq!(ColorMap::Viridis.at(1.0), [0xFD, 0xE7, 0x25]);
        assert_eq!(ColorMap::Inferno.at(-3.0), [0, 0, 4]);
        assert_eq!(ColorMap::Inferno.at(f64::INFINITY), [0xFC, 0xFF, 0xA4]);
        assert_eq!(ColorMap::Inferno.at(f64::NAN), [0, 0, 4]);
    }
}
