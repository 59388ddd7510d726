//! Pictures of a run and of a convergence study, as SVG and PNG, without fonts or libraries of the system.
//!
//! [`folder()`] draws the content of a results folder; [`side_by_side`] compares runs in panels of one picture. Both
//! use [`DrawnRun`], which is plain data, and [`picture()`]; [`Film`] collects them for a run without a folder. A
//! convergence study is drawn by [`convergence()`].
//!
//! ```no_run
//! use amontons::plot::{self, Options};
//!
//! for path in plot::folder("results/paper".as_ref(), &Options::default())? {
//!     println!("{}", path.display());
//! }
//! # Ok::<(), plot::PlotError>(())
//! ```

// Pixels and counts are computed as reals; a cast turns a negative one into zero.
#![allow(clippy::cast_sign_loss)]

mod accuracy;
mod animation;
mod axes;
mod body;
mod charts;
mod color;
mod contact;
mod convergence;
mod field;
mod folder;
mod font;
mod footprint;
mod frames;
mod ground;
mod history;
mod memory;
mod names;
mod oblique;
mod picture;
mod plane;
mod profiles;
mod raster;
mod render;
mod report;
mod run;
mod shade;
mod sheet;
mod sides;
mod surface;
mod svg;
mod sweep;
mod table;
mod ticks;
mod views;
mod vtu;
mod zoom;

use std::path::{Path, PathBuf};

use crate::output::names::CASE;
use crate::units::{Measure, UnitSystem, Units};

pub use animation::{animation, mode_animation};
pub use body::PlaneMesh;
pub use color::ColorMap;
pub use convergence::{ConvergencePlot, ErrorSeries, convergence, convergence_panels};
pub use memory::Film;
pub use picture::Picture;
pub use plane::scale_factor;
pub use report::report;
pub use run::{ContactRow, DrawnRun, HistoryColumns, PlaneSnapshot, Rod, SolidContact, SpaceSnapshot};
pub use sides::sides;
pub use surface::Skin;
pub use sweep::{SweepPlot, SweepSeries, sweep};

/// The reasons why a picture could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    /// A file could not be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// A file or folder could not be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// A file that was not written by a run or a study.
    #[error("{}: {what}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// The fault of the file.
        what: String,
    },
    /// Data that contradict each other or are not finite.
    #[error("{0}")]
    Data(String),
    /// The picture would have no pixels, or too many.
    #[error("a picture of {width} × {height} pixels cannot be drawn, expected at least one pixel and at most 10⁸")]
    Size {
        /// Width in pixels.
        width: f64,
        /// Height in pixels.
        height: f64,
    },
}

/// Largest number of panels of one picture.
const PANELS: usize = 48;

/// Options of pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// True to leave out the units even if the case has them.
    pub dimensionless: bool,
    /// Times of the frames that [`folder()`] draws; empty: it chooses them.
    pub times: Vec<f64>,
    /// Pixels of a PNG per unit of the picture, 1/96 inch; reduced if a side would have more than 4000 pixels.
    pub pixels: f64,
    /// Factor of the displacement in pictures of the deformed body. By default 1 if an obstacle, a curved side or a
    /// varying gap would make an enlarged displacement false, and a round number otherwise.
    pub scale_factor: Option<f64>,
    /// True if panels side by side share one scale of values.
    pub shared_scale: bool,
}

impl Default for Options {
    fn default() -> Options {
        Options { dimensionless: false, times: Vec::new(), pixels: 2.0, scale_factor: None, shared_scale: false }
    }
}

impl Options {
    /// The units of a run, or none.
    fn units(&self, units: Units) -> Units {
        if self.dimensionless { units.without() } else { units }
    }
}

/// The units of the runs in a picture.
fn units(panels: &[RunPanel], options: &Options) -> Units {
    options.units(panels.first().map(|panel| panel.run.units).unwrap_or_default())
}

/// Text of a time: `t = 0.5 s`.
fn time(t: f64, units: Units) -> String {
    format!("t = {} {}", ticks::number(t), units.of(Measure::Time)).trim_end().to_owned()
}

/// The kinds of pictures of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureKind {
    /// The deformed mesh and its foundation, coloured by the displacement.
    Deformed,
    /// The temperature.
    Temperature,
    /// The von Mises stress, recovered at the nodes.
    VonMises,
    /// Pressure, friction with its cone, slip velocity, gap, temperature and heat flux along each side of Γ_C; for a
    /// body in space pressure, status and slip direction on each side.
    Contact,
    /// Depth of wear on Γ_C.
    Wear,
    /// Energies, works, contact force, contact status, heat, friction power, wear and foundation temperature over time.
    History,
}

impl PictureKind {
    /// Every kind.
    pub const ALL: [PictureKind; 6] = [
        PictureKind::Deformed,
        PictureKind::Temperature,
        PictureKind::VonMises,
        PictureKind::Contact,
        PictureKind::Wear,
        PictureKind::History,
    ];

    /// Name of the files of the picture, without extension.
    #[must_use]
    pub fn file_name(self) -> &'static str {
        match self {
            PictureKind::Deformed => "deformed",
            PictureKind::Temperature => "temperature",
            PictureKind::VonMises => "von-mises",
            PictureKind::Contact => "contact",
            PictureKind::Wear => "wear",
            PictureKind::History => "history",
        }
    }

    /// True if a run has the data of the picture: fields of a plane body or a body in space, contact, wear, or rows of
    /// its history.
    #[must_use]
    pub fn is_in(self, run: &DrawnRun) -> bool {
        match self {
            PictureKind::Temperature => run.fields()[0],
            PictureKind::Deformed | PictureKind::VonMises => run.fields()[1],
            PictureKind::Contact => {
                run.snapshot.is_some() && !run.contact.is_empty()
                    || run.solid.as_ref().is_some_and(|s| !s.contact.is_empty())
            }
            PictureKind::Wear => PictureKind::Contact.is_in(run) && run.worn()[0],
            PictureKind::History => run.history.get("t").is_some_and(|t| !t.is_empty()),
        }
    }

    /// True if the picture is not trivial: nonzero displacements, stresses, different temperatures or a heat flow.
    #[must_use]
    pub fn is_told_by(self, run: &DrawnRun) -> bool {
        self.is_in(run)
            && match self {
                PictureKind::Deformed => run.has_moved(),
                PictureKind::VonMises => run.has_stress(),
                PictureKind::Temperature => run.has_heat(),
                PictureKind::Contact | PictureKind::Wear | PictureKind::History => true,
            }
    }
}

/// A run in a picture, with a title if several stand side by side.
#[derive(Clone, Debug)]
pub struct RunPanel<'a> {
    /// The title; empty for none.
    pub title: &'a str,
    /// The run.
    pub run: &'a DrawnRun,
}

/// Draws a picture of one run, or of several side by side. No side is longer than 4000 units of 1/96 inch: if the
/// panels do not fit, evenly spaced ones are drawn, and a note gives their number.
///
/// Texts may have subscripts and superscripts: `θ_{F}`, `10^{3}`.
///
/// # Errors
/// [`PlotError::Data`] if a run lacks the data of the picture or its data contradict each other.
pub fn picture(kind: PictureKind, panels: &[RunPanel], options: &Options) -> Result<Picture, PlotError> {
    for RunPanel { run, .. } in panels {
        if run.dimension == 1 && kind != PictureKind::History {
            let what = kind.file_name();
            return Err(PlotError::Data(format!(
                "the run {} is of a body in d = 1, which the picture `{what}` does not show",
                run.name
            )));
        }
        if !kind.is_in(run) {
            return Err(PlotError::Data(format!(
                "the run {} has no data for the picture `{}`",
                run.name,
                kind.file_name()
            )));
        }
        if let Some(snapshot) = &run.snapshot {
            snapshot.check()?;
        }
        if let Some(solid) = &run.solid {
            solid.check()?;
        }
    }
    let in_space = panels.iter().filter(|panel| panel.run.solid.is_some()).count();
    if in_space > 0 && in_space < panels.len() && kind != PictureKind::History {
        return Err(PlotError::Data("bodies in the plane and bodies in space do not go into one picture".to_owned()));
    }
    if panels.is_empty() {
        return Err(PlotError::Data(format!("there is no run for the picture `{}`", kind.file_name())));
    }
    let mut shown = panels.len().min(PANELS);
    loop {
        let chosen = if shown > 1 { frames::evenly(panels.len(), shown) } else { vec![panels.len() - 1] };
        let some: Vec<RunPanel> = chosen.iter().filter_map(|&i| panels.get(i).cloned()).collect();
        let picture = drawn(kind, &some, options)?;
        if shown > 1 && picture.is_too_large() {
            shown -= shown.div_ceil(8);
            continue;
        }
        let all = panels.len();
        let what = if panels.windows(2).all(|p| p[0].run.name == p[1].run.name) { "times" } else { "runs" };
        return Ok(if shown < all { picture.noted(&format!("{shown} of {all} {what} shown")) } else { picture });
    }
}

/// A picture of some panels, of any size.
fn drawn(kind: PictureKind, panels: &[RunPanel], options: &Options) -> Result<Picture, PlotError> {
    let in_space = panels.iter().filter(|panel| panel.run.solid.is_some()).count();
    match kind {
        PictureKind::Contact | PictureKind::Wear if in_space > 0 => footprint::draw(kind, panels, options),
        PictureKind::Deformed | PictureKind::Temperature | PictureKind::VonMises if in_space > 0 => {
            Ok(oblique::draw(kind, panels, options))
        }
        PictureKind::Deformed | PictureKind::Temperature | PictureKind::VonMises => {
            Ok(plane::draw(kind, panels, options))
        }
        PictureKind::Contact | PictureKind::Wear => profiles::draw(kind, panels, options),
        PictureKind::History => history::draw(panels, options),
    }
}

/// Title such as `paper: temperature at t = 1 s`, without the name if several runs stand side by side.
fn title(panels: &[RunPanel], what: &str, options: &Options) -> String {
    let same_time = panels.windows(2).all(|p| p[0].run.t.total_cmp(&p[1].run.t).is_eq());
    let when = panels
        .first()
        .filter(|_| same_time)
        .map_or_else(String::new, |p| format!(" at {}", time(p.run.t, units(panels, options))));
    heading(panels, &format!("{what}{when}"))
}

fn heading(panels: &[RunPanel], what: &str) -> String {
    // One run, at one time or at several.
    let same = panels.windows(2).all(|p| p[0].run.name == p[1].run.name && p[0].run.t.total_cmp(&p[1].run.t).is_ne());
    match panels {
        [RunPanel { run, .. }, ..] if same && !run.name.is_empty() => format!("{}: {what}", run.name),
        _ => what.chars().take(1).flat_map(char::to_uppercase).chain(what.chars().skip(1)).collect(),
    }
}

/// Draws all pictures of the run and of the convergence study in a results folder into its folder `plots`. Returns
/// their paths.
///
/// Pictures of the body and of Γ_C show the times of the options, or those that [`DrawnRun::frames`] chooses. A body in
/// one dimension has no pictures of its fields and of Γ_C. Fields that a run does not have are not drawn: no
/// temperature without heat, no wear without wear.
///
/// # Errors
/// A file is missing or damaged, or a picture cannot be written; the error names the file.
pub fn folder(dir: &Path, options: &Options) -> Result<Vec<PathBuf>, PlotError> {
    let into = dir.join("plots");
    let make = || std::fs::create_dir_all(&into).map_err(|source| PlotError::Write { path: into.clone(), source });
    let mut paths = Vec::new();
    let study = dir.join("convergence.csv");
    let is_study = study.exists();
    if is_study {
        let has_none = dir.join(CASE).exists() && folder::problem(dir)?.system == UnitSystem::Dimensionless;
        let plot = ConvergencePlot::read(
            &study,
            &Options { dimensionless: options.dimensionless || has_none, ..options.clone() },
        )?;
        make()?;
        paths.extend(convergence(&plot)?.save(&into.join("convergence"), options.pixels)?);
    }
    if let Some((_, Some(picture))) = accuracy::meshes(dir)? {
        make()?;
        paths.extend(picture.save(&into.join("accuracy"), options.pixels)?);
    }
    if !is_study || folder::has_fields(dir) {
        let runs = DrawnRun::frames(dir, &options.times)?;
        make()?;
        for kind in PictureKind::ALL {
            paths.extend(
                strip(kind, &runs, options)?
                    .map(|picture| picture.save(&into.join(kind.file_name()), options.pixels))
                    .transpose()?
                    .into_iter()
                    .flatten(),
            );
        }
    }
    Ok(paths)
}

/// The picture of a run at several times, with one scale of values, or `None` if there is nothing to show.
fn strip(kind: PictureKind, runs: &[DrawnRun], options: &Options) -> Result<Option<Picture>, PlotError> {
    if !runs.iter().any(|run| kind.is_told_by(run)) {
        return Ok(None);
    }
    // The history covers the whole run at each time.
    let frames: Vec<&DrawnRun> = if kind == PictureKind::History {
        runs.iter().rev().take(1).collect()
    } else {
        runs.iter().filter(|run| kind.is_in(run)).collect()
    };
    let several = frames.len() > 1;
    let titles: Vec<String> =
        frames.iter().map(|run| if several { time(run.t, options.units(run.units)) } else { String::new() }).collect();
    let panels: Vec<RunPanel> = frames.iter().zip(&titles).map(|(run, title)| RunPanel { title, run }).collect();
    picture(kind, &panels, &Options { shared_scale: options.shared_scale || several, ..options.clone() }).map(Some)
}

/// Draws the runs of several results folders side by side, each under its title, and writes `out`.svg and `out`.png.
///
/// # Errors
/// As [`folder()`]; also if a run lacks the data of the picture.
pub fn side_by_side(
    kind: PictureKind,
    runs: &[(&str, &Path)],
    out: &Path,
    options: &Options,
) -> Result<[PathBuf; 2], PlotError> {
    let read: Vec<DrawnRun> = runs.iter().map(|(_, dir)| DrawnRun::read(dir)).collect::<Result<_, _>>()?;
    let panels: Vec<RunPanel> = runs.iter().zip(&read).map(|(&(title, _), run)| RunPanel { title, run }).collect();
    if let Some(parent) = out.parent().filter(|p| !p.as_os_str().is_empty()) {
        std::fs::create_dir_all(parent).map_err(|source| PlotError::Write { path: parent.to_owned(), source })?;
    }
    picture(kind, &panels, options)?.save(out, options.pixels)
}
