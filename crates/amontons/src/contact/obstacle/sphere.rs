//! A ball, or the space around a socket.

use super::{CENTER, Checks, Nearest, ObstacleShape, Point3, ShapeFaults, at, keyed, minus, round};
use crate::field::Field;
use crate::tensor::Point;

/// The ball ‖x − c‖ < R, or ‖x − c‖ > R for a socket around the body; in two dimensions a disc.
#[derive(Clone, Debug)]
pub struct Sphere {
    center: Point3,
    radius: f64,
    inside: bool,
}

impl Sphere {
    /// The ball around `center` with `radius` in m; with `inside` the socket of this radius.
    ///
    /// # Errors
    /// Fails if the radius is not positive or the centre depends on space.
    pub fn new(center: Point3, radius: f64, inside: bool) -> Result<Sphere, ShapeFaults> {
        let mut checks = Checks::default();
        let sphere =
            Sphere { center: checks.moving(CENTER, center), radius: checks.positive("radius", radius), inside };
        checks.result(sphere)
    }
}

impl ObstacleShape for Sphere {
    fn nearest(&self, x: &Point, t: f64) -> Nearest {
        round(&minus(x, &self.place(t)), self.radius, self.inside, [1.0, 0.0, 0.0])
    }
    fn place(&self, t: f64) -> Point {
        at(&self.center, t)
    }
    fn fields(&self) -> Vec<(&'static str, &Field)> {
        keyed(CENTER, &self.center)
    }
    fn turns_into_itself(&self, _axis: &Point, about_place: bool) -> bool {
        about_place
    }
}
