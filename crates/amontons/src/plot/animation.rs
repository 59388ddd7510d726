//! The deformed body with a field, as an animation over the snapshots: a GIF, which every slide program accepts.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use gif::{Encoder, Frame, Repeat};

use super::color::{Color, INK, VERMILION, WHITE};
use super::field::DrawnQuantity;
use super::folder::Results;
use super::picture::Picture;
use super::{DrawnRun, HistoryColumns, Options, PictureKind, PlotError, RunPanel, frames, oblique, plane, raster};
use crate::output::write_file;
use crate::problem::Problem;
use crate::stability::Mode;
use crate::state::State;

/// Largest number of frames, and of nodes in all frames together.
const FRAMES: usize = 200;
const NODES: usize = 4_000_000;
/// Hundredths of a second: total duration, least and largest duration of a frame, and duration of the last.
const ALL: usize = 500;
const EACH: [usize; 2] = [4, 50];
const LAST: u16 = 150;

/// Writes `plots/deformed.gif`, `plots/von-mises.gif` or `plots/temperature.gif` of a results folder: the moving body,
/// coloured by the field of a kind. All frames have the same colour scale and window. The frames are the times of the
/// options, or all snapshots, or evenly spaced ones of them: at most 200 frames of together four million nodes. Returns
/// the path.
///
/// # Errors
/// As [`super::folder()`]; also [`PlotError::Data`] for a kind that is no field of a body or a field that the run
/// lacks.
pub fn animation(dir: &Path, kind: PictureKind, options: &Options) -> Result<PathBuf, PlotError> {
    let results = Results::read(dir)?;
    let times: Vec<f64> = results.snapshots.iter().map(|(t, _)| *t).collect();
    let most = (NODES / results.problem.mesh.points.len().max(1)).clamp(2, FRAMES);
    let chosen =
        if options.times.is_empty() { frames::evenly(times.len(), most) } else { frames::at(&options.times, &times)? };
    let runs: Vec<DrawnRun> = chosen.into_iter().map(|i| results.run(i)).collect::<Result<_, _>>()?;
    let pictures = pictures(kind, &runs, options)?;
    let into = dir.join("plots");
    std::fs::create_dir_all(&into).map_err(|source| PlotError::Write { path: into.clone(), source })?;
    let path = into.join(kind.file_name()).with_extension("gif");
    let bytes = encode(
        &pictures,
        DrawnQuantity::of(kind),
        pictures.first().map_or(options.pixels, |picture| picture.density(options.pixels)),
    )?;
    write_file(&path, &bytes).map_err(|source| PlotError::Write { path: path.clone(), source })?;
    Ok(path)
}

/// Frames of a period of a mode.
const PERIOD: usize = 24;
/// Largest displacement of a drawn mode relative to the size of the body.
const SWING: f64 = 0.08;

/// Writes a period of a mode of a state as a GIF: the body as it moves, enlarged, or the temperature of a hot spot.
///
/// # Errors
/// [`PlotError::Data`] for a rod, and if a value is not finite.
pub fn mode_animation(problem: &Arc<Problem>, state: &State, mode: &Mode, path: &Path) -> Result<(), PlotError> {
    let points = &problem.mesh.points;
    let extent = (0..3).map(|c| {
        let along = || points.iter().map(|x| x[c]);
        along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
    });
    let size = extent.fold(0.0, f64::max);
    let largest = mode.displacement.iter().map(|u| u[0].hypot(u[1])).fold(0.0, f64::max);
    let is_warm = mode.temperature.iter().any(|theta| theta[0].hypot(theta[1]) > 0.0);
    let kind = if is_warm { PictureKind::Temperature } else { PictureKind::Deformed };
    let factor = if largest > 0.0 { SWING * size / largest } else { 0.0 };
    let frame = |i: usize| {
        let (sine, cosine) = (std::f64::consts::TAU * i as f64 / PERIOD as f64).sin_cos();
        let at = |all: &[[f64; 2]], factor: f64| -> Vec<f64> {
            all.iter().map(|value| factor * (value[0] * cosine - value[1] * sine)).collect()
        };
        let swung = State {
            u: at(&mode.displacement, factor),
            theta: if is_warm { at(&mode.temperature, 1.0) } else { state.theta.clone() },
            ..state.clone()
        };
        DrawnRun::of_state(problem, &swung, &[], HistoryColumns::default())
    };
    let runs = (0..PERIOD).map(frame).collect::<Result<Vec<_>, _>>()?;
    let options = Options { scale_factor: Some(1.0), dimensionless: true, ..Options::default() };
    let bytes = encode(&pictures(kind, &runs, &options)?, DrawnQuantity::of(kind), 1.0)?;
    write_file(path, &bytes).map_err(|source| PlotError::Write { path: path.to_owned(), source })
}

/// The frames as pictures.
fn pictures(kind: PictureKind, runs: &[DrawnRun], options: &Options) -> Result<Vec<Picture>, PlotError> {
    let name = runs.first().map_or("", |run| run.name.as_str());
    if !matches!(kind, PictureKind::Deformed | PictureKind::VonMises | PictureKind::Temperature)
        || !runs.iter().all(|run| kind.is_in(run))
        || !runs.iter().any(|run| kind.is_told_by(run))
    {
        let what = DrawnQuantity::of(kind).name;
        return Err(PlotError::Data(format!("the run {name} has no {what} over a body in the plane or in space")));
    }
    let panels: Vec<RunPanel> = runs.iter().map(|run| RunPanel { title: "", run }).collect();
    let in_space = runs.iter().any(|run| run.solid.is_some());
    Ok(if in_space { oblique::frames(kind, &panels, options) } else { plane::frames(kind, &panels, options) })
}

/// A palette: colours of a map, darker ones for lines and shades, the foundation blended with white, greys.
struct Palette {
    colors: Vec<[u8; 3]>,
    known: HashMap<[u8; 3], u8>,
}

impl Palette {
    fn new(quantity: DrawnQuantity) -> Palette {
        let mix = |a: [u8; 3], b: Color, share: f64| {
            let b = [b.red, b.green, b.blue];
            [0, 1, 2].map(|c| (f64::from(a[c]) * (1.0 - share) + f64::from(b[c]) * share).round() as u8)
        };
        let map = |count: u32| (0..count).map(move |i| quantity.map.at(f64::from(i) / f64::from(count - 1)));
        let grey = |i: u32| [(i * 255 / 31) as u8; 3];
        let white = [WHITE.red, WHITE.green, WHITE.blue];
        let mut colors: Vec<[u8; 3]> = map(96).collect();
        colors.extend([0.12, 0.25, 0.42].into_iter().flat_map(|share| map(32).map(move |c| mix(c, INK, share))));
        colors.extend((0..32).map(grey));
        colors.extend((1..=16).map(|i| mix(white, VERMILION, f64::from(i) / 16.0)));
        // Shades of the foundation in space.
        colors.extend((8..=16).map(|i| [0xDD, 0xD6, 0xCE].map(|c: u32| (c * i / 16) as u8)));
        Palette { colors, known: HashMap::new() }
    }

    /// The index of the nearest colour.
    fn nearest(&mut self, color: [u8; 3]) -> u8 {
        let away = |c: &[u8; 3]| (0..3).map(|d| (i32::from(c[d]) - i32::from(color[d])).pow(2)).sum::<i32>();
        let colors = &self.colors;
        *self.known.entry(color).or_insert_with(|| {
            let nearest = colors.iter().enumerate().min_by_key(|(_, c)| away(c));
            nearest.map_or(0, |(i, _)| i as u8)
        })
    }
}

/// The smallest rectangle outside of which two images of a width are equal: left, top, width, height; one pixel for
/// equal images.
fn changed(before: &[u8], now: &[u8], width: usize) -> [usize; 4] {
    let differs = |i: &usize| before[*i] != now[*i];
    let rows = || (0..now.len()).filter(differs).map(|i| i / width);
    let columns = || (0..now.len()).filter(differs).map(|i| i % width);
    let (left, right) = (columns().min().unwrap_or(0), columns().max().unwrap_or(0));
    let (top, bottom) = (rows().next().unwrap_or(0), rows().next_back().unwrap_or(0));
    [left, top, right - left + 1, bottom - top + 1]
}

fn encode(pictures: &[Picture], quantity: DrawnQuantity, pixels: f64) -> Result<Vec<u8>, PlotError> {
    let fault = |error: gif::EncodingError| PlotError::Data(format!("the animation cannot be written: {error}"));
    let mut palette = Palette::new(quantity);
    let global: Vec<u8> = palette.colors.iter().flatten().copied().collect();
    let size = |of: fn(&Picture) -> f64| pictures.iter().map(of).fold(0.0, f64::max);
    let (wide, high) = (size(|p| p.width), size(|p| p.height));
    let refused = |_| PlotError::Size { width: wide * pixels, height: high * pixels };
    let [width, height] = [wide, high].map(|length| u16::try_from((length * pixels).round() as u64).map_err(refused));
    let (width, height) = (width?, height?);
    let each = (ALL / pictures.len().max(1)).clamp(EACH[0], EACH[1]) as u16;
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width, height, &global).map_err(fault)?;
    encoder.set_repeat(Repeat::Infinite).map_err(fault)?;
    let mut before: Vec<u8> = Vec::new();
    for (i, picture) in pictures.iter().enumerate() {
        let whole = Picture { width: wide, height: high, ..picture.clone() };
        let now: Vec<u8> = raster::colors(&whole, pixels)?.into_iter().map(|color| palette.nearest(color)).collect();
        let row = usize::from(width);
        let [left, top, columns, rows] =
            if i == 0 { [0, 0, row, usize::from(height)] } else { changed(&before, &now, row) };
        let part = (top..top + rows).flat_map(|j| now[j * row + left..][..columns].iter().copied());
        let frame = Frame {
            delay: if i + 1 == pictures.len() { LAST } else { each },
            left: left as u16,
            top: top as u16,
            width: columns as u16,
            height: rows as u16,
            buffer: part.collect::<Vec<u8>>().into(),
            ..Frame::default()
        };
        encoder.write_frame(&frame).map_err(fault)?;
        before = now;
    }
    drop(encoder);
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_changes_is_in_the_rectangle() {
        let before = [0u8; 20];
        let mut now = before;
        (now[7], now[13]) = (1, 2);
        // Columns 2 and 3 of five, rows 1 and 2.
        assert_eq!(changed(&before, &now, 5), [2, 1, 2, 2]);
        assert_eq!(changed(&before, &before, 5), [0, 0, 1, 1]);
    }

    #[test]
    fn the_palette_has_white_and_the_colours_of_the_map() {
        let quantity = DrawnQuantity::of(PictureKind::Deformed);
        let mut palette = Palette::new(quantity);
        assert!(palette.colors.len() <= 256, "{}", palette.colors.len());
        for color in [[255; 3], quantity.map.at(0.0), quantity.map.at(1.0)] {
            let nearest = palette.nearest(color);
            assert_eq!(palette.colors[usize::from(nearest)], color);
        }
    }
}
