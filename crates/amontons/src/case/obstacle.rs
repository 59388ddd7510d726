//! `[contact.obstacle]`: converts the raw shape to that of the library.

use std::sync::Arc;

use super::build::Build;
use super::place::At;
use super::raw::{self, Datum};
use super::solid::SolidFromFile;
use crate::contact::obstacle::{
    Cylinder, FacetedSolid, LevelSet, Obstacle, ObstacleLoad, ObstacleShape, Plane, Point3, ShapeFaults, Sphere,
    Turning, Wave,
};
use crate::field::Field;
use crate::tensor::Point;

impl Build<'_> {
    /// The obstacle at `path`, or `None` if it has a fault; `points` are those that may touch it.
    pub fn obstacle(&mut self, path: &str, raw: &raw::Obstacle, points: &[Point]) -> Option<Obstacle> {
        let (geometry, turning, load) = raw.common();
        let has_place = !matches!(raw, raw::Obstacle::Surface { .. });
        let turning = turning.map(|turning| self.turning(path, turning, has_place));
        let load = load.and_then(|load| self.load(path, load));
        let shape = self.shape_of(path, raw, points)?;
        let updated = geometry == raw::Geometry::Updated;
        // Faults of rotation and load are noted already.
        Some(Obstacle { shape, updated, turning: turning.flatten(), load })
    }

    /// The force on an obstacle.
    fn load(&mut self, path: &str, raw: &raw::ObstacleLoad) -> Option<ObstacleLoad> {
        let at = format!("{path}.load");
        let force = self.field(&format!("{at}.force"), &raw.force, &[[0.0; 3]]);
        let direction = self.direction(&at, "direction", &raw.direction)?;
        match ObstacleLoad::new(force, direction, raw.mass) {
            Ok(load) => Some(load),
            Err(faults) => {
                self.shape_faults(&at, faults);
                None
            }
        }
    }

    fn shape_of(&mut self, path: &str, raw: &raw::Obstacle, points: &[Point]) -> Option<Arc<dyn ObstacleShape>> {
        match raw {
            raw::Obstacle::Plane { point, normal, .. } => {
                let (point, normal) = (self.moving(path, "point", point), self.direction(path, "normal", normal));
                self.shape(path, Plane::new(point, normal?))
            }
            raw::Obstacle::Sphere { center, radius, inside, .. } => {
                let center = self.moving(path, "center", center);
                self.shape(path, Sphere::new(center, *radius, *inside))
            }
            raw::Obstacle::Cylinder { center, axis, radius, inside, .. } => {
                let (center, axis) = (self.moving(path, "center", center), self.axis(path, axis));
                self.shape(path, Cylinder::new(center, axis?, *radius, *inside))
            }
            raw::Obstacle::Wave { point, normal, direction, amplitude, wavelength, .. } => {
                let (point, normal, direction) = (
                    self.moving(path, "point", point),
                    self.direction(path, "normal", normal),
                    self.direction(path, "direction", direction),
                );
                self.shape(path, Wave::new(point, normal?, direction?, *amplitude, *wavelength))
            }
            raw::Obstacle::File { file, scale, turn, origin, inside, .. } => {
                let origin = if origin.is_empty() { Point3::default() } else { self.moving(path, "origin", origin) };
                let surface = self.facets(path, &SolidFromFile { file, scale: *scale, turn: turn.as_ref() })?;
                self.shape(path, FacetedSolid::new(Arc::new(surface), origin, *inside))
            }
            raw::Obstacle::Surface { level, .. } => self.surface(path, level, points),
        }
    }

    /// The rotation of an obstacle. `has_place` is true if its shape has a point that serves as default for `about`.
    fn turning(&mut self, path: &str, raw: &raw::Turning, has_place: bool) -> Option<Turning> {
        let at = format!("{path}.turning");
        if raw.about.is_none() && !has_place {
            let expected = format!("an array of {} (a point of the axis): a level has no place", self.dim);
            self.note(&format!("{at}.about"), At::Missing, "no such key", expected, None);
            return None;
        }
        let axis = self.axis(&at, &raw.axis);
        let angle = self.field(&format!("{at}.angle"), &raw.angle, &[[0.0; 3]]);
        let about = raw.about.as_ref().map(|about| self.moving(&at, "about", about));
        match Turning::new(angle, axis?, about) {
            Ok(turning) => Some(turning),
            Err(faults) => {
                self.shape_faults(path, faults);
                None
            }
        }
    }

    fn shape<S: ObstacleShape + 'static>(
        &mut self,
        path: &str,
        shape: Result<S, ShapeFaults>,
    ) -> Option<Arc<dyn ObstacleShape>> {
        match shape {
            Ok(shape) => Some(Arc::new(shape)),
            Err(faults) => {
                self.shape_faults(path, faults);
                None
            }
        }
    }

    fn shape_faults(&mut self, path: &str, ShapeFaults(faults): ShapeFaults) {
        for fault in faults {
            self.note(&format!("{path}.{}", fault.key()), At::Value, fault.found(), fault.expected(), None);
        }
    }

    /// The zero level of a function, which must have a nearest point for each of `points`.
    fn surface(&mut self, path: &str, level: &str, points: &[Point]) -> Option<Arc<dyn ObstacleShape>> {
        let key = format!("{path}.level");
        let level = self.expression(&key, level)?;
        let shape = self.shape(path, LevelSet::new(level))?;
        // Points of a placeholder mesh are irrelevant.
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
