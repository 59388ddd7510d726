//! Text as outlines of an embedded font, so that it looks the same whatever fonts the system has.
//!
//! The font is DejaVu Sans 2.37 (licence next to it), reduced to Latin, Greek and Cyrillic letters and mathematical
//! signs. Texts have one markup: `_{…}` sets a subscript and `^{…}` a superscript.

use std::sync::OnceLock;

use ttf_parser::{Face, GlyphId};

static FONT: &[u8] = include_bytes!("font/DejaVuSans.ttf");

/// Sizes of texts.
pub(super) const TITLE: f64 = 16.0;
pub(super) const HEADING: f64 = 13.0;
pub(super) const LABEL: f64 = 12.0;
pub(super) const NUMBER: f64 = 11.0;
/// Distance from the middle of a text down to its baseline, in units of its size.
pub(super) const HALF: f64 = 0.36;
/// Size of a subscript or superscript relative to the text.
const SCRIPT: f64 = 0.72;
/// Offsets of a subscript downwards and of a superscript upwards, in units of the text size.
const LOWERED: f64 = 0.18;
const RAISED: f64 = 0.36;

fn face() -> Option<&'static Face<'static>> {
    static FACE: OnceLock<Option<Face<'static>>> = OnceLock::new();
    FACE.get_or_init(|| Face::parse(FONT, 0).ok()).as_ref()
}

/// A glyph of a laid out text, in units of the text size from the start of its baseline.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Glyph {
    pub id: u16,
    pub x: f64,
    /// Offset upwards.
    pub y: f64,
    pub scale: f64,
}

/// A text laid out at size 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct TextLayout {
    pub glyphs: Vec<Glyph>,
    pub width: f64,
}

/// Lays out a text at size 1.
pub(super) fn layout(text: &str) -> TextLayout {
    let Some(face) = face() else { return TextLayout::default() };
    let em = f64::from(face.units_per_em());
    let mut out = TextLayout::default();
    for (part, place) in parts(text) {
        let (scale, y) = match place {
            GlyphPlace::Base => (1.0, 0.0),
            GlyphPlace::Sub => (SCRIPT, -LOWERED),
            GlyphPlace::Super => (SCRIPT, RAISED),
        };
        for c in part.chars() {
            // A character missing in the font is shown by its box for missing glyphs.
            let id = face.glyph_index(c).unwrap_or(GlyphId(0));
            out.glyphs.push(Glyph { id: id.0, x: out.width, y, scale });
            out.width += scale * f64::from(face.glyph_hor_advance(id).unwrap_or(0)) / em;
        }
    }
    out
}

/// Width of a text of this size.
pub(super) fn width(text: &str, size: f64) -> f64 {
    layout(text).width * size
}

/// A text without its markup.
pub(super) fn plain(text: &str) -> String {
    parts(text).into_iter().map(|(part, _)| part).collect()
}

/// A number with typographic signs and powers of ten.
pub(super) fn typeset(text: &str) -> String {
    let text = match text.split_once('e') {
        Some((mantissa, rest))
            if mantissa.chars().last().is_some_and(|c| c.is_ascii_digit())
                && rest.starts_with(|c: char| c == '-' || c.is_ascii_digit()) =>
        {
            let (power, unit) = rest.split_once(' ').unwrap_or((rest, ""));
            format!("{mantissa}·10^{{{power}}} {unit}").trim_end().to_owned()
        }
        _ => text.to_owned(),
    };
    text.replace('-', "−")
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum GlyphPlace {
    Base,
    Sub,
    Super,
}

/// Cuts a text at its markup; unclosed markup is text.
fn parts(text: &str) -> Vec<(&str, GlyphPlace)> {
    let mut parts = Vec::new();
    let mut rest = text;
    while let Some((start, place)) = next_script(rest) {
        let (before, script) = rest.split_at(start);
        let Some((inside, after)) = script[2..].split_once('}') else { break };
        parts.push((before, GlyphPlace::Base));
        parts.push((inside, place));
        rest = after;
    }
    parts.push((rest, GlyphPlace::Base));
    parts
}

fn next_script(text: &str) -> Option<(usize, GlyphPlace)> {
    let sub = text.find("_{").map(|i| (i, GlyphPlace::Sub));
    let sup = text.find("^{").map(|i| (i, GlyphPlace::Super));
    match (sub, sup) {
        (Some(a), Some(b)) => Some(if a.0 < b.0 { a } else { b }),
        (a, b) => a.or(b),
    }
}

/// One stroke of the pen along an outline, upwards and in units of the text size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Pen {
    Move([f64; 2]),
    Line([f64; 2]),
    Quad([f64; 2], [f64; 2]),
    Cubic([f64; 2], [f64; 2], [f64; 2]),
    Close,
}

/// Outline of a glyph at size 1; empty for a space.
pub(super) fn outline(id: u16) -> Vec<Pen> {
    let Some(face) = face() else { return Vec::new() };
    let mut tracer = Tracer { scale: 1.0 / f64::from(face.units_per_em()), pens: Vec::new() };
    // A glyph without an outline has no bounds, which is no fault.
    let _bounds = face.outline_glyph(GlyphId(id), &mut tracer);
    tracer.pens
}

struct Tracer {
    scale: f64,
    pens: Vec<Pen>,
}

impl Tracer {
    fn point(&self, x: f32, y: f32) -> [f64; 2] {
        [f64::from(x) * self.scale, f64::from(y) * self.scale]
    }
}

impl ttf_parser::OutlineBuilder for Tracer {
    fn move_to(&mut self, x: f32, y: f32) {
        self.pens.push(Pen::Move(self.point(x, y)));
    }
    fn line_to(&mut self, x: f32, y: f32) {
        self.pens.push(Pen::Line(self.point(x, y)));
    }
    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.pens.push(Pen::Quad(self.point(x1, y1), self.point(x, y)));
    }
    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.pens.push(Pen::Cubic(self.point(x1, y1), self.point(x2, y2), self.point(x, y)));
    }
    fn close(&mut self) {
        self.pens.push(Pen::Close);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_has_what_the_pictures_say() {
        let text = "ABCxyz0123456789 (Γ_C) p_ν σ_τ θ_F ε μ ‖·‖ −×⁻²½≤≥→∞äöéßШж";
        assert!(face().is_some());
        for c in text.chars().filter(|c| !c.is_whitespace()) {
            let layout = layout(&c.to_string());
            assert!(
                layout.glyphs[0].id != 0 && layout.width > 0.0 && !outline(layout.glyphs[0].id).is_empty(),
                "{c} is missing"
            );
        }
        assert_eq!(layout("漢").glyphs[0].id, 0);
    }

    #[test]
    fn markup_sets_scripts_and_nothing_else() {
        assert_eq!(
            parts("p_{ν} (10^{3} Pa)"),
            [
                ("p", GlyphPlace::Base),
                ("ν", GlyphPlace::Sub),
                (" (10", GlyphPlace::Base),
                ("3", GlyphPlace::Super),
                (" Pa)", GlyphPlace::Base)
            ]
        );
        assert_eq!(parts("my_case {a} x_{"), [("my_case {a} x_{", GlyphPlace::Base)]);
        assert_eq!(plain("E^{hk}"), "Ehk");
        assert!(layout("x^{2}").width < layout("x2").width);
    }

    #[test]
    fn widths_add_up() {
        assert!((width("ab", 10.0) - width("a", 10.0) - width("b", 10.0)).abs() < 1e-12);
    }

    #[test]
    fn numbers_are_set_with_the_signs_of_a_page() {
        assert_eq!(typeset("-2.13 µm"), "−2.13 µm");
        assert_eq!(typeset("2.13e-6"), "2.13·10^{−6}");
        assert_eq!(typeset("1e-8 pm"), "1·10^{−8} pm");
    }
}
