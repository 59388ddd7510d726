//! Motion of an obstacle: with its place, and by rotation about an axis.

use super::{Checks, Point3, ShapeFault, ShapeFaults, across, at, keyed, minus, plus};
use crate::field::Field;
use crate::mesh::cross;
use crate::tensor::{Point, Rotation, length};

const ABOUT: [&str; 3] = ["turning.about[0]", "turning.about[1]", "turning.about[2]"];
const ANGLE: &str = "turning.angle";
/// Sine of the angle between directions that are equal up to round-off.
const PARALLEL: f64 = 1e-12;

/// A rotation of an obstacle: the shape at a time is turned by an angle about an axis through a point.
#[derive(Clone, Debug)]
pub struct Turning {
    angle: Field,
    axis: Point,
    about: Option<Point3>,
}

impl Turning {
    /// The rotation by `angle` in rad, by the right-hand rule about the direction `axis`, of any length: (0, 0, 1) in
    /// two dimensions. The axis goes through `about`, or through the place of the shape and moves with it.
    ///
    /// # Errors
    /// Fails if the axis is zero, or the angle or the point depend on space.
    pub fn new(angle: Field, axis: Point, about: Option<Point3>) -> Result<Turning, ShapeFaults> {
        let mut checks = Checks::default();
        if angle.depends_on_space() {
            checks.0.push(ShapeFault::InSpace { key: ANGLE });
        }
        let about = about.map(|about| checks.moving(ABOUT, about));
        let axis = checks.unit("turning.axis", axis);
        checks.result(Turning { angle, axis, about })
    }

    /// Unit vector along the axis.
    #[must_use]
    pub fn axis(&self) -> &Point {
        &self.axis
    }

    /// True if the axis goes through the place of the shape.
    #[must_use]
    pub fn is_about_place(&self) -> bool {
        self.about.is_none()
    }

    /// The data that may vary in time, with their keys.
    pub(super) fn fields(&self) -> Vec<(&'static str, &Field)> {
        let about = self.about.iter().flat_map(|about| keyed(ABOUT, about));
        std::iter::once((ANGLE, &self.angle)).chain(about).collect()
    }

    /// The angle at a time, rad.
    fn angle(&self, t: f64) -> f64 {
        self.angle.value(&[0.0; 3], t)
    }

    /// A point of the axis at a time, for a shape at `place`.
    fn about(&self, place: Point, t: f64) -> Point {
        self.about.as_ref().map_or(place, |about| at(about, t))
    }

    /// The rotation at a time and a point of its axis.
    pub(super) fn at(&self, place: Point, t: f64) -> PivotRotation {
        let angle = self.angle(t);
        let [to, back] = [angle, -angle].map(|angle| Rotation::about(&self.axis, angle));
        PivotRotation { about: self.about(place, t), to, back }
    }
}

/// A rotation about a point.
pub(super) struct PivotRotation {
    about: Point,
    to: Rotation,
    back: Rotation,
}

impl PivotRotation {
    /// The position of a point before the rotation.
    pub fn before(&self, x: &Point) -> Point {
        plus(&self.about, 1.0, &self.back.vector(&minus(x, &self.about)))
    }

    /// A direction after the rotation.
    pub fn after(&self, direction: &Point) -> Point {
        self.to.vector(direction)
    }
}

/// True if a direction is parallel to a unit vector, in either sense.
pub(super) fn is_along(direction: &Point, unit: &Point) -> bool {
    length(&across(direction, unit)) < PARALLEL
}

/// The velocity of a rigid obstacle: v + ω × (x − a).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ObstacleVelocity {
    /// v in m/s.
    pub velocity: Point,
    /// ω in rad/s.
    pub spin: Point,
    /// A point a of the axis, m.
    pub about: Point,
}

impl ObstacleVelocity {
    /// The velocity at time t of an obstacle whose place is a function of time; `rate` differentiates a function of
    /// time at that time.
    ///
    /// With the place p and the rotation R about a(t), a point of the obstacle is x = a + R (ξ + p − a), ξ fixed, so
    /// that ẋ = ȧ + R (ṗ − ȧ) + ω × (x − a).
    pub(super) fn new(
        turning: Option<&Turning>,
        place: &dyn Fn(f64) -> Point,
        t: f64,
        rate: &Rate,
    ) -> ObstacleVelocity {
        let of = |point: &dyn Fn(f64) -> Point| -> Point { std::array::from_fn(|c| rate(&|t| point(t)[c])) };
        let carried = of(place);
        let Some(turning) = turning else {
            return ObstacleVelocity { velocity: carried, ..ObstacleVelocity::default() };
        };
        let speed = rate(&|t| turning.angle(t));
        let spin = turning.axis.map(|c| c * speed);
        let about = turning.about(place(t), t);
        if turning.is_about_place() {
            return ObstacleVelocity { velocity: carried, spin, about };
        }
        let axis = of(&|t| turning.about(place(t), t));
        let turned = Rotation::about(&turning.axis, turning.angle(t)).vector(&minus(&carried, &axis));
        ObstacleVelocity { velocity: plus(&axis, 1.0, &turned), spin, about }
    }

    /// This motion with a further displacement `by` and `velocity`, which also carry the axis.
    pub(super) fn carried(&self, by: &Point, velocity: &Point) -> ObstacleVelocity {
        ObstacleVelocity {
            velocity: plus(&self.velocity, 1.0, velocity),
            spin: self.spin,
            about: plus(&self.about, 1.0, by),
        }
    }

    /// The velocity of the obstacle at a point, m/s.
    #[must_use]
    pub fn at(&self, x: &Point) -> Point {
        if self.spin.iter().all(|c| *c == 0.0) {
            return self.velocity;
        }
        plus(&self.velocity, 1.0, &cross(&self.spin, &minus(x, &self.about)))
    }
}

/// Differentiates a function of time at a fixed time.
pub type Rate<'r> = dyn Fn(&dyn Fn(f64) -> f64) -> f64 + 'r;
