//! A half-space.

use super::motion::is_along;
use super::{Checks, Nearest, ObstacleShape, POINT, Point3, ShapeFaults, at, keyed, minus};
use crate::field::Field;
use crate::tensor::{Point, dot};

/// The half-space n·(x − p) < 0, which moves with p.
#[derive(Clone, Debug)]
pub struct Plane {
    point: Point3,
    normal: Point,
}

impl Plane {
    /// The half-space below the plane through `point` with the normal `normal`, of any length.
    ///
    /// # Errors
    /// Fails if the normal is zero or the point depends on space.
    pub fn new(point: Point3, normal: Point) -> Result<Plane, ShapeFaults> {
        let mut checks = Checks::default();
        let plane = Plane { point: checks.moving(POINT, point), normal: checks.unit("normal", normal) };
        checks.result(plane)
    }
}

impl ObstacleShape for Plane {
    fn nearest(&self, x: &Point, t: f64) -> Nearest {
        Nearest { distance: dot(&minus(x, &self.place(t)), &self.normal), normal: self.normal }
    }
    fn place(&self, t: f64) -> Point {
        at(&self.point, t)
    }
    fn fields(&self) -> Vec<(&'static str, &Field)> {
        keyed(POINT, &self.point)
    }
    fn turns_into_itself(&self, axis: &Point, _about_place: bool) -> bool {
        is_along(&self.normal, axis)
    }
}
