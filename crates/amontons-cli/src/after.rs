//! Output made from results: pictures and the report.

use std::path::Path;

use amontons::plot;

use crate::arguments::FieldArgument;
use crate::print;
use crate::status::CommandFailure;

/// The output to make when a run has ended.
#[derive(Clone, Copy, Debug)]
pub struct After {
    pub pictures: bool,
    pub report: bool,
}

impl After {
    /// Makes the requested output from the results in a folder, and prints the paths.
    pub fn make(self, dir: &Path, quiet: bool) -> Result<(), CommandFailure> {
        if self.pictures {
            draw(dir, &plot::Options::default(), quiet)?;
        }
        if self.report { report(dir, quiet) } else { Ok(()) }
    }
}

/// Draws the contents of a folder and prints the paths of the pictures.
pub fn draw(dir: &Path, options: &plot::Options, quiet: bool) -> Result<(), CommandFailure> {
    let paths = plot::folder(dir, options)?;
    if quiet {
        return Ok(());
    }
    Ok(print::text(&paths.iter().map(|path| format!("{}\n", path.display())).collect::<String>())?)
}

/// Writes the report of a folder and prints its path.
pub fn report(dir: &Path, quiet: bool) -> Result<(), CommandFailure> {
    let path = plot::report(dir)?;
    if quiet { Ok(()) } else { Ok(print::text(&format!("{}\n", path.display()))?) }
}

/// Writes an animation of the results in a folder and prints its path.
pub fn animate(dir: &Path, field: FieldArgument, options: &plot::Options) -> Result<(), CommandFailure> {
    let kind = match field {
        FieldArgument::Displacement => plot::PictureKind::Deformed,
        FieldArgument::VonMises => plot::PictureKind::VonMises,
        FieldArgument::Temperature => plot::PictureKind::Temperature,
    };
    Ok(print::text(&format!("{}\n", plot::animation(dir, kind, options)?.display()))?)
}
