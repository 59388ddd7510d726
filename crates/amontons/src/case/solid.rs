//! `[contact.obstacle]` from a file: its boundary as a surface of facets.

use super::build::Build;
use super::path::Path;
use super::place::At;
use super::raw;
use crate::contact::mortar::surface_of;
use crate::contact::obstacle::ClosedSurface;
use crate::mesh::defects::defects;
use crate::mesh::{self, stl};
use crate::tensor::{Point, Rotation};

/// A solid in a file, with its scale and rotation.
pub(super) struct SolidFromFile<'r> {
    pub file: &'r str,
    pub scale: f64,
    pub turn: Option<&'r raw::Turn>,
}

impl Build<'_> {
    /// The surface of the solid in a file, scaled and rotated, or `None`, with a note, if it has a fault.
    pub(super) fn facets(&mut self, path: &str, from: &SolidFromFile) -> Option<ClosedSurface> {
        let (key, name) = (format!("{path}.file"), from.file);
        let bytes = match self.loader.get(&Path::parse(&key).unwrap_or_default(), name) {
            Ok(bytes) => bytes,
            Err(missing) => {
                self.note(&key, At::Value, missing.found, missing.expected, missing.hint.as_deref());
                return None;
            }
        };
        let mut facets = if name.to_lowercase().ends_with(".stl") {
            self.triangles(&key, name, &bytes)?
        } else {
            self.boundary_of(&key, name, &bytes)?
        };
        let rotation = match from.turn {
            Some(turn) => self.rotation(path, turn)?,
            None => Rotation::IDENTITY,
        };
        let place = |x: &mut Point| {
            *x = x.map(|c| from.scale * c);
            if from.turn.is_some() {
                *x = rotation.vector(x);
            }
        };
        facets.iter_mut().flatten().for_each(place);
        match ClosedSurface::new(&facets) {
            Ok(surface) => Some(surface),
            Err(fault) => {
                let found = fault.found(self.dim, &|x| self.place(x));
                let [expected, hint] = fault.expected();
                self.note(&key, At::Value, format!("{name}: {found}"), expected, Some(hint));
                None
            }
        }
    }

    /// The triangles of an STL file.
    fn triangles(&mut self, key: &str, name: &str, bytes: &[u8]) -> Option<Vec<Vec<Point>>> {
        if self.dim != 3 {
            let found = format!("\"{name}\", a surface in space");
            let hint = "give the outline as a plane mesh of the solid, or one of the other shapes";
            self.note(key, At::Value, found, "a mesh file of a plane solid", Some(hint));
            return None;
        }
        match stl::parse(bytes) {
            Ok(triangles) => Some(triangles.into_iter().map(|corners| corners.to_vec()).collect()),
            Err(error) => {
                self.unread(key, name, &error, "a surface of triangles");
                None
            }
        }
    }

    /// The boundary of the body of a mesh file.
    fn boundary_of(&mut self, key: &str, name: &str, bytes: &[u8]) -> Option<Vec<Vec<Point>>> {
        let read = mesh::parse_file(name, bytes, Some(&mut |other: &str| self.loader.include(other)));
        let read = match read {
            Ok(read) => read,
            Err(error) => {
                self.unread(key, name, &error, "a mesh of one body, or a surface of triangles (STL)");
                return None;
            }
        };
        if let Some(whole) = read.whole {
            self.loader.complete(name, whole);
        }
        if read.mesh.dim != self.dim {
            let found = format!("\"{name}\", a solid in {} dimensions", read.mesh.dim);
            self.note(key, At::Value, found, format!("one in {}, as the body is", self.dim), None);
            return None;
        }
        let harmful: Vec<String> = defects(&read.mesh)
            .iter()
            .filter(|defects| defects.first.iter().any(|defect| defect.side().is_none()))
            .map(|defects| format!("{name}: {defects}"))
            .collect();
        for defect in &harmful {
            self.note(key, At::Value, defect.replace('\n', "; "), "a sound mesh", None);
        }
        harmful.is_empty().then(|| surface_of(&read.mesh))
    }

    fn unread(&mut self, key: &str, name: &str, error: &mesh::MeshFileError, otherwise: &str) {
        let expected = error.expected().unwrap_or_else(|| otherwise.to_owned());
        self.note(key, At::Value, format!("{name}: {}{}", error.place(), error.found()), expected, None);
    }

    /// The rotation of a solid.
    fn rotation(&mut self, path: &str, turn: &raw::Turn) -> Option<Rotation> {
        let at = format!("{path}.turn");
        let axis = self.axis(&at, &turn.axis)?;
        self.is_direction(&format!("{at}.axis"), &axis).then(|| Rotation::about(&axis, turn.angle))
    }
}
