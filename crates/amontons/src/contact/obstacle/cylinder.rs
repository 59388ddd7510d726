//! A shaft, or the space around a bore.

use super::motion::is_along;
use super::{
    CENTER, Checks, Nearest, ObstacleShape, Point3, ShapeFaults, across, at, keyed, minus, perpendicular, round,
};
use crate::field::Field;
use crate::tensor::Point;

/// The infinite cylinder of points nearer than R to the axis through c, or, for a bore around the body, of points
/// farther than R.
#[derive(Clone, Debug)]
pub struct Cylinder {
    center: Point3,
    axis: Point,
    radius: f64,
    inside: bool,
}

impl Cylinder {
    /// The cylinder with `radius` in m about the axis through `center` in the direction `axis` of any length, (0, 0, 1)
    /// in two dimensions. With `inside` it is the bore of this radius.
    ///
    /// # Errors
    /// Fails if the radius is not positive, the axis zero or the centre depends on space.
    pub fn new(center: Point3, axis: Point, radius: f64, inside: bool) -> Result<Cylinder, ShapeFaults> {
        let mut checks = Checks::default();
        let center = checks.moving(CENTER, center);
        let cylinder =
            Cylinder { center, axis: checks.unit("axis", axis), radius: checks.positive("radius", radius), inside };
        checks.result(cylinder)
    }
}

impl ObstacleShape for Cylinder {
    fn nearest(&self, x: &Point, t: f64) -> Nearest {
        // Applied twice: the rounding of a long vector is not small compared with a short remainder.
        let from = across(&across(&minus(x, &self.place(t)), &self.axis), &self.axis);
        round(&from, self.radius, self.inside, perpendicular(&self.axis))
    }
    fn place(&self, t: f64) -> Point {
        at(&self.center, t)
    }
    fn fields(&self) -> Vec<(&'static str, &Field)> {
        keyed(CENTER, &self.center)
    }
    fn turns_into_itself(&self, axis: &Point, about_place: bool) -> bool {
        about_place && is_along(&self.axis, axis)
    }
}
