//! A picture as an SVG document, and the files of a picture.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::PlotError;
use super::color::Color;
use super::font::{self, Pen};
use super::picture::{Item, OutlinePiece, Picture, Stroke};
use super::raster;

impl Picture {
    /// The picture as an SVG document, with all text as outlines.
    #[must_use]
    pub fn svg(&self) -> String {
        write(self)
    }

    /// Writes `stem`.svg and `stem`.png, the latter with this number of pixels per unit, or with fewer if a side would
    /// have more than 4000 pixels. Returns their paths.
    ///
    /// # Errors
    /// A file cannot be written, or the picture cannot be drawn in this size.
    pub fn save(&self, stem: &Path, pixels: f64) -> Result<[PathBuf; 2], PlotError> {
        let with = |extension: &str| {
            let mut name = stem.as_os_str().to_owned();
            name.push(extension);
            PathBuf::from(name)
        };
        let write = |path: PathBuf, bytes: &[u8]| match std::fs::write(&path, bytes) {
            Ok(()) => Ok(path),
            Err(source) => Err(PlotError::Write { path, source }),
        };
        Ok([write(with(".svg"), self.svg().as_bytes())?, write(with(".png"), &self.png(self.density(pixels))?)?])
    }
}

fn write(picture: &Picture) -> String {
    let mut glyphs = BTreeSet::new();
    let mut body = String::new();
    for item in &picture.items {
        match item {
            Item::Shape { lines, fill, stroke } => shape(&mut body, lines, *fill, stroke.as_ref()),
            Item::Text { at, size, anchor, upwards, color, text } => {
                let layout = font::layout(text);
                let turn = if *upwards { " rotate(-90)" } else { "" };
                let _ = write!(body, r#"<g aria-label="{}"{}"#, escaped(&font::plain(text)), paint("fill", *color));
                let _ =
                    writeln!(body, r#" transform="translate({} {}){turn} scale({size})">"#, short(at[0]), short(at[1]));
                let start = anchor.offset(layout.width);
                for glyph in layout.glyphs {
                    if font::outline(glyph.id).is_empty() {
                        continue;
                    }
                    glyphs.insert(glyph.id);
                    let _ = write!(
                        body,
                        r##"<use xlink:href="#g{}" transform="translate({:.4} {:.4})"##,
                        glyph.id,
                        start + glyph.x,
                        -glyph.y
                    );
                    let _ = if glyph.scale < 1.0 {
                        write!(body, " scale({})\"/>", glyph.scale)
                    } else {
                        body.write_str("\"/>")
                    };
                }
                body.push_str("\n</g>\n");
            }
            Item::Image { place, image } => {
                // An image that cannot be encoded has no pixels, so nothing is shown.
                let Some(png) = raster::encode(image) else { continue };
                let _ = writeln!(
                    body,
                    r#"<image x="{}" y="{}" width="{}" height="{}" preserveAspectRatio="none" xlink:href="data:image/png;base64,{}"/>"#,
                    short(place.x),
                    short(place.y),
                    short(place.width),
                    short(place.height),
                    STANDARD.encode(png)
                );
            }
        }
    }
    let (width, height, title) = (picture.width, picture.height, escaped(&font::plain(&picture.title)));
    let mut out = String::with_capacity(body.len() + 16_384);
    let _ = writeln!(
        out,
        r#"<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" width="{width}" height="{height}" viewBox="0 0 {width} {height}" role="img" aria-label="{title}">"#
    );
    let _ = writeln!(out, "<title>{title}</title>\n<defs>");
    for id in glyphs {
        let _ = writeln!(out, r#"<path id="g{id}" d="{}"/>"#, glyph(id));
    }
    let _ = writeln!(out, "</defs>\n<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>");
    out.push_str(&body);
    out.push_str("</svg>\n");
    out
}

/// Outline of a glyph at size 1, y downwards.
fn glyph(id: u16) -> String {
    let mut d = String::new();
    let p = |p: [f64; 2]| format!("{:.4} {:.4}", p[0], -p[1]);
    for pen in font::outline(id) {
        let _ = match pen {
            Pen::Move(a) => write!(d, "M{}", p(a)),
            Pen::Line(a) => write!(d, "L{}", p(a)),
            Pen::Quad(a, b) => write!(d, "Q{} {}", p(a), p(b)),
            Pen::Cubic(a, b, c) => write!(d, "C{} {} {}", p(a), p(b), p(c)),
            Pen::Close => d.write_str("Z"),
        };
    }
    d
}

fn shape(out: &mut String, lines: &[OutlinePiece], fill: Option<Color>, stroke: Option<&Stroke>) {
    out.push_str("<path");
    match fill {
        Some(color) => {
            out.push_str(&paint("fill", color));
            if lines.len() > 1 {
                out.push_str(r#" fill-rule="evenodd""#);
            }
        }
        None => out.push_str(r#" fill="none""#),
    }
    if let Some(stroke) = stroke {
        out.push_str(&paint("stroke", stroke.color));
        let _ = write!(out, r#" stroke-width="{}" stroke-linejoin="round""#, short(stroke.width));
        if !stroke.dashes.is_empty() {
            let dashes: Vec<String> = stroke.dashes.iter().map(|&d| short(d)).collect();
            let _ = write!(out, r#" stroke-dasharray="{}""#, dashes.join(" "));
        }
    }
    out.push_str(r#" d=""#);
    for line in lines {
        for (i, p) in line.points.iter().enumerate() {
            let _ = write!(out, "{}{} {}", if i == 0 { 'M' } else { 'L' }, short(p[0]), short(p[1]));
        }
        if line.closed {
            out.push('Z');
        }
    }
    out.push_str("\"/>\n");
}

fn paint(what: &str, color: Color) -> String {
    let opaque = format!(r##" {what}="#{:02x}{:02x}{:02x}""##, color.red, color.green, color.blue);
    if color.opacity >= 1.0 { opaque } else { format!(r#"{opaque} {what}-opacity="{}""#, short(color.opacity)) }
}

/// A coordinate rounded to a hundredth, below visible size.
fn short(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Text escaped for attributes and elements, without control characters, which XML does not allow.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() || matches!(c, '\u{FFFE}' | '\u{FFFF}') => {}
            c => out.push(c),
        }
    }
    out
}
