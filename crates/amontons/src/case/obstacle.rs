//! `[contact.obstacle]`: from the raw shape to that of the library.

use std::sync::Arc;

use super::build::Build;
use super::place::At;
use super::raw::{self, Datum};
use crate::contact::obstacle::{Cylinder, Obstacle, Plane, Shape, ShapeFaults, Sphere, Surface, Wave};
use crate::field::Field;
use crate::tensor::Point;

impl Build<'_> {
    /// The obstacle at `path`, none of a faulty one; `points` are those that may touch it.
    pub fn obstacle(&mut self, path: &str, raw: raw::Obstacle, points: &[Point]) -> Option<Obstacle> {
        let (shape, geometry): (Option<Arc<dyn Shape>>, _) = match raw {
            raw::Obstacle::Plane { point, normal, geometry } => {
                let (point, normal) = (self.moving(path, "point", &point), self.direction(path, "normal", &normal));
                (self.shape(path, Plane::new(point, normal?)), geometry)
            }
            raw::Obstacle::Sphere { center, radius, inside, geometry } => {
                let center = self.moving(path, "center", &center);
                (self.shape(path, Sphere::new(center, radius, inside)), geometry)
            }
            raw::Obstacle::Cylinder { center, axis, radius, inside, geometry } => {
                let (center, axis) = (self.moving(path, "center", &center), self.axis(path, &axis));
                (self.shape(path, Cylinder::new(center, axis?, radius, inside)), geometry)
            }
            raw::Obstacle::Wave { point, normal, direction, amplitude, wavelength, geometry } => {
                let (point, normal, direction) = (
                    self.moving(path, "point", &point),
                    self.direction(path, "normal", &normal),
                    self.direction(path, "direction", &direction),
                );
                (self.shape(path, Wave::new(point, normal?, direction?, amplitude, wavelength)), geometry)
            }
            raw::Obstacle::Surface { level, geometry } => (self.surface(path, &level, points), geometry),
        };
        Some(Obstacle { shape: shape?, updated: geometry == raw::Geometry::Updated })
    }

    fn shape<S: Shape + 'static>(&mut self, path: &str, shape: Result<S, ShapeFaults>) -> Option<Arc<dyn Shape>> {
        let faults = match shape {
            Ok(shape) => return Some(Arc::new(shape)),
            Err(ShapeFaults(faults)) => faults,
        };
        for fault in faults {
            self.note(&format!("{path}.{}", fault.key()), At::Value, fault.found(), fault.expected(), None);
        }
        None
    }

    /// The zero level, which each point has something nearest of.
    fn surface(&mut self, path: &str, level: &str, points: &[Point]) -> Option<Arc<dyn Shape>> {
        let key = format!("{path}.level");
        let level = self.expression(&key, level)?;
        let shape = self.shape(path, Surface::new(level))?;
        // Points of a stand-in mesh say nothing.
        let known = !self.doubtful.has_in_mesh;
        if let Some(x) = points.iter().find(|x| known && !shape.nearest(x, 0.0).distance.is_finite()) {
            let found = format!("no point of the zero level that is nearest to {} at t = 0", self.place(x));
            let hint = "a level is positive outside the obstacle, negative inside and continuous";
            self.note(&key, At::Value, found, "one for each node of the side", Some(hint));
            return None;
        }
        Some(shape)
    }

    /// A point that may move.
    fn moving(&mut self, path: &str, key: &str, data: &[Datum]) -> [Field; 3] {
        let path = format!("{path}.{key}");
        if data.len() != self.dim {
            self.wants_components(&path, data.len());
        }
        let mut components = self.vector(&path, data, &[[0.0; 3]]).into_iter();
        [0; 3].map(|_: i32| components.next().unwrap_or_default())
    }

    /// A vector of numbers.
    fn direction(&mut self, path: &str, key: &str, components: &[f64]) -> Option<Point> {
        if components.len() != self.dim {
            self.wants_components(&format!("{path}.{key}"), components.len());
            return None;
        }
        Some([0, 1, 2].map(|c| components.get(c).copied().unwrap_or_default()))
    }

    /// The axis of a cylinder or a sector: in the plane it is z.
    pub fn axis(&mut self, path: &str, components: &[f64]) -> Option<Point> {
        if self.dim == 3 {
            return self.direction(path, "axis", components);
        }
        if !components.is_empty() {
            self.note(&format!("{path}.axis"), At::Value, "an axis", "none: in the plane it is z", None);
            return None;
        }
        Some([0.0, 0.0, 1.0])
    }
}
