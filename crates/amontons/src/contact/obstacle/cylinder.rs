//! A shaft, or the space around a bore.

use super::motion::is_along;
use super::{CENTER, Checks, Nearest, Point3, Shape, ShapeFaults, across, at, keyed, minus, perpendicular, round};
use crate::field::Field;
use crate::tensor::Point;

/// The cylinder without ends of points nearer than R to the axis through c, or of those farther, around a bore that the
/// body is within.
#[derive(Clone, Debug)]
pub struct Cylinder {
    center: Point3,
    axis: Point,
    radius: f64,
    inside: bool,
}

impl Cylinder {
    /// The cylinder with `radius` in m whose axis goes through `center` in the direction `axis`, of any length: (0, 0,
    /// 1) in two dimensions. With `inside` it is the bore of this radius.
    ///
    /// # Errors
    /// When the radius is not positive, the axis zero or the centre depends on space.
    pub fn new(center: Point3, axis: Point, radius: f64, inside: bool) -> Result<Cylinder, ShapeFaults> {
        let mut checks = Checks::default();
        let center = checks.moving(CENTER, center);
        let cylinder =
            Cylinder { center, axis: checks.unit("axis", axis), radius: checks.positive("radius", radius), inside };
        checks.result(cylinder)
    }
}

impl Shape for Cylinder {
    fn nearest(&self, x: &Point, t: f64) -> Nearest {
        // Twice, as the rounding of a long vector is not small beside a short rest.
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
