//! A picture as a PNG file.

use tiny_skia::{
    FillRule, FilterQuality, IntSize, LineCap, LineJoin, Paint, PathBuilder, Pixmap, PixmapPaint, PremultipliedColorU8,
    StrokeDash, Transform,
};

use super::PlotError;
use super::color::Color;
use super::font::{self, Pen};
use super::picture::{Image, Item, OutlinePiece, Picture, Stroke};

/// Largest number of pixels of a picture: 400 MB of memory.
const MOST: f64 = 1e8;

impl Picture {
    /// The picture as a PNG file with this number of pixels per unit.
    ///
    /// # Errors
    /// [`PlotError::Size`] if there would be no pixels or more than fit an image.
    pub fn png(&self, pixels: f64) -> Result<Vec<u8>, PlotError> {
        let canvas = draw(self, pixels)?;
        canvas.encode_png().map_err(|_| PlotError::Size { width: self.width, height: self.height })
    }
}

/// Red, green and blue of each pixel, row by row.
pub(super) fn colors(picture: &Picture, pixels: f64) -> Result<Vec<[u8; 3]>, PlotError> {
    // The background is opaque, so no colour is premultiplied.
    let canvas = draw(picture, pixels)?;
    Ok(canvas.pixels().iter().map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]).collect())
}

fn draw(picture: &Picture, pixels: f64) -> Result<Pixmap, PlotError> {
    let (width, height) = ((picture.width * pixels).round(), (picture.height * pixels).round());
    let refused = || PlotError::Size { width, height };
    if !(width >= 1.0 && height >= 1.0 && width * height <= MOST) {
        return Err(refused());
    }
    let mut canvas = Pixmap::new(width as u32, height as u32).ok_or_else(refused)?;
    canvas.fill(tiny_skia::Color::WHITE);
    let scale = Transform::from_scale(pixels as f32, pixels as f32);
    for item in &picture.items {
        match item {
            Item::Shape { lines, fill, stroke } => shape(&mut canvas, scale, lines, *fill, stroke.as_ref()),
            Item::Text { at, size, anchor, upwards, color, text } => {
                let layout = font::layout(text);
                let turn = if *upwards { Transform::from_rotate(-90.0) } else { Transform::identity() };
                let size = *size as f32;
                let place = scale.pre_translate(at[0] as f32, at[1] as f32).pre_concat(turn).pre_scale(size, -size);
                let start = anchor.offset(layout.width);
                for glyph in layout.glyphs {
                    let Some(path) = outline(glyph.id) else { continue };
                    let place = place
                        .pre_translate((start + glyph.x) as f32, glyph.y as f32)
                        .pre_scale(glyph.scale as f32, glyph.scale as f32);
                    canvas.fill_path(&path, &paint(*color), FillRule::Winding, place, None);
                }
            }
            Item::Image { place, image } => {
                let Some(source) = pixmap(image) else { continue };
                let (sx, sy) = (place.width / f64::from(image.width), place.height / f64::from(image.height));
                let place = scale.pre_translate(place.x as f32, place.y as f32).pre_scale(sx as f32, sy as f32);
                let paint = PixmapPaint { quality: FilterQuality::Bilinear, ..PixmapPaint::default() };
                canvas.draw_pixmap(0, 0, source.as_ref(), &paint, place, None);
            }
        }
    }
    Ok(canvas)
}

/// An image as a PNG file, or `None` if it has no pixels.
pub(super) fn encode(image: &Image) -> Option<Vec<u8>> {
    pixmap(image)?.encode_png().ok()
}

fn pixmap(image: &Image) -> Option<Pixmap> {
    let premultiplied = image
        .rgba
        .chunks_exact(4)
        .flat_map(|p| {
            let c = tiny_skia::ColorU8::from_rgba(p[0], p[1], p[2], p[3]).premultiply();
            let c: PremultipliedColorU8 = c;
            [c.red(), c.green(), c.blue(), c.alpha()]
        })
        .collect();
    Pixmap::from_vec(premultiplied, IntSize::from_wh(image.width, image.height)?)
}

fn paint(color: Color) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(color.red, color.green, color.blue, (color.opacity * 255.0).round() as u8);
    paint
}

fn shape(canvas: &mut Pixmap, scale: Transform, lines: &[OutlinePiece], fill: Option<Color>, stroke: Option<&Stroke>) {
    let mut builder = PathBuilder::new();
    for line in lines {
        for (i, p) in line.points.iter().enumerate() {
            let (x, y) = (p[0] as f32, p[1] as f32);
            if i == 0 { builder.move_to(x, y) } else { builder.line_to(x, y) }
        }
        if line.closed {
            builder.close();
        }
    }
    let Some(path) = builder.finish() else { return };
    if let Some(color) = fill {
        canvas.fill_path(&path, &paint(color), FillRule::EvenOdd, scale, None);
    }
    if let Some(stroke) = stroke {
        let dash = StrokeDash::new(stroke.dashes.iter().map(|&d| d as f32).collect(), 0.0);
        let style = tiny_skia::Stroke {
            width: stroke.width as f32,
            line_join: LineJoin::Round,
            line_cap: LineCap::Butt,
            dash,
            ..tiny_skia::Stroke::default()
        };
        canvas.stroke_path(&path, &paint(stroke.color), &style, scale, None);
    }
}

fn outline(id: u16) -> Option<tiny_skia::Path> {
    let mut builder = PathBuilder::new();
    let f = |p: [f64; 2]| (p[0] as f32, p[1] as f32);
    for pen in font::outline(id) {
        match pen {
            Pen::Move(a) => builder.move_to(f(a).0, f(a).1),
            Pen::Line(a) => builder.line_to(f(a).0, f(a).1),
            Pen::Quad(a, b) => builder.quad_to(f(a).0, f(a).1, f(b).0, f(b).1),
            Pen::Cubic(a, b, c) => builder.cubic_to(f(a).0, f(a).1, f(b).0, f(b).1, f(c).0, f(c).1),
            Pen::Close => builder.close(),
        }
    }
    builder.finish()
}
