//! Rigid surfaces that may move: nearest points and normals, one shape per file.
//!
//! An obstacle defines the geometry of (2.8)–(2.10): contact acts along ν = −n, n the normal of the obstacle at its
//! nearest point, and the gap is the distance there. Both depend on the position alone, not on the mesh of the body.

mod closest;
mod cylinder;
mod descent;
mod facets;
mod file;
mod load;
mod motion;
mod plane;
mod sphere;
mod surface;
mod wave;

use std::fmt::Debug;
use std::sync::Arc;

pub use cylinder::Cylinder;
pub use facets::{ClosedSurface, FacetsFault};
pub use file::FacetedSolid;
pub use load::ObstacleLoad;
pub use motion::{ObstacleVelocity, Rate, Turning};
pub use plane::Plane;
pub use sphere::Sphere;
pub use surface::LevelSet;
pub use wave::Wave;

use crate::field::Field;
use crate::tensor::{Point, dot, length, minus};

/// A rigid obstacle that the body may touch.
#[derive(Clone, Debug)]
pub struct Obstacle {
    /// Its surface.
    pub shape: Arc<dyn ObstacleShape>,
    /// True if distances and normals are evaluated at x + u_{n−1} in each step; otherwise at x, for small
    /// displacements.
    pub updated: bool,
    /// Rotation of the obstacle; `None` if it does not turn.
    pub turning: Option<Turning>,
    /// The load under which it moves in addition to its place; `None` if its place is prescribed completely.
    pub load: Option<ObstacleLoad>,
}

impl Obstacle {
    /// The nearest point at a time; an obstacle under a load is moved by its δ, as far as known.
    #[must_use]
    pub fn nearest(&self, x: &Point, t: f64) -> Nearest {
        self.nearest_moved(x, t, self.known(t))
    }

    /// The nearest point at a time, for an obstacle that its load has moved by a length δ.
    #[must_use]
    pub fn nearest_moved(&self, x: &Point, t: f64, along: f64) -> Nearest {
        let direction = self.direction();
        let x: Point = std::array::from_fn(|c| x[c] - along * direction[c]);
        let Some(turning) = self.changes_by() else { return self.shape.nearest(&x, t) };
        let turn = turning.at(self.shape.place(t), t);
        let Nearest { distance, normal } = self.shape.nearest(&turn.before(&x), t);
        Nearest { distance, normal: turn.after(&normal) }
    }

    /// The rotation if it changes the surface; `None` for a ball about its centre, a cylinder about its axis, and a
    /// plane about its normal.
    fn changes_by(&self) -> Option<&Turning> {
        let turning = self.turning.as_ref()?;
        (!self.shape.turns_into_itself(turning.axis(), turning.is_about_place())).then_some(turning)
    }

    /// True if it turns while its surface stays in place.
    #[must_use]
    pub fn turns_in_place(&self) -> bool {
        self.turning.is_some() && self.changes_by().is_none()
    }

    /// The unit vector along which its load moves it; zero without a load.
    #[must_use]
    pub fn direction(&self) -> Point {
        self.load.as_ref().map_or([0.0; 3], |load| load.direction)
    }

    /// δ as far as known, m.
    fn known(&self, t: f64) -> f64 {
        self.load.as_ref().map_or(0.0, |load| load.known(t))
    }

    /// Its velocity as a rigid body at a time, including that of its load as far as known; `rate` differentiates a
    /// function of time at that time.
    #[must_use]
    pub fn motion(&self, t: f64, rate: &Rate) -> ObstacleVelocity {
        let motion = ObstacleVelocity::new(self.turning.as_ref(), &|t| self.shape.place(t), t, rate);
        let Some(load) = &self.load else { return motion };
        let [moved, speed] = [load.known(t), rate(&|t| load.known(t))].map(|size| load.direction.map(|c| size * c));
        motion.carried(&moved, &speed)
    }

    /// Position of a point that moves with the obstacle but does not turn, as far as known.
    #[must_use]
    pub fn place(&self, t: f64) -> Point {
        let (place, along, direction) = (self.shape.place(t), self.known(t), self.direction());
        std::array::from_fn(|c| place[c] + along * direction[c])
    }

    /// True if it may move or change its shape.
    #[must_use]
    pub fn depends_on_time(&self) -> bool {
        let turns = |turning: &Turning| turning.fields().iter().any(|(_, field)| field.depends_on_time());
        self.load.is_some() || self.shape.depends_on_time() || self.changes_by().is_some_and(turns)
    }

    /// The data that may vary in time, with their keys.
    #[must_use]
    pub fn fields(&self) -> Vec<(&'static str, &Field)> {
        let turning = self.turning.iter().flat_map(Turning::fields);
        self.shape.fields().into_iter().chain(turning).collect()
    }
}

/// The nearest point of an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Distance in m, negative inside the obstacle; NaN where there is no nearest point.
    pub distance: f64,
    /// Unit normal out of the obstacle at the nearest point of its surface; it is the gradient of the distance.
    pub normal: Point,
}

impl Nearest {
    /// No nearest point.
    pub const NONE: Nearest = Nearest { distance: f64::NAN, normal: [f64::NAN; 3] };
}

/// The surface of an obstacle. In two dimensions points have z = 0, and so have normals.
pub trait ObstacleShape: Debug + Send + Sync {
    /// The nearest point at a time; of several points equally near, each call returns the same.
    fn nearest(&self, x: &Point, t: f64) -> Nearest;
    /// Position in m of a point that moves with the obstacle; zero if it has none.
    fn place(&self, _t: f64) -> Point {
        [0.0; 3]
    }
    /// The data that may vary in time, with their keys.
    fn fields(&self) -> Vec<(&'static str, &Field)> {
        Vec::new()
    }
    /// True if a rotation about an axis with this unit vector leaves the surface unchanged; the axis goes through its
    /// place, or anywhere if `about_place` is false.
    fn turns_into_itself(&self, _axis: &Point, _about_place: bool) -> bool {
        false
    }
    /// The least and the largest coordinates of a bounded surface at a time, m; `None` if unbounded.
    fn bounds(&self, _t: f64) -> Option<[Point; 2]> {
        None
    }
    /// True if the nearest point may change with time.
    fn depends_on_time(&self) -> bool {
        self.fields().iter().any(|(_, field)| field.depends_on_time())
    }
}

/// A fault in a datum of a shape.
#[derive(Clone, Debug, PartialEq)]
pub enum ShapeFault {
    /// A length is not positive.
    NotPositive {
        /// Its key.
        key: &'static str,
        /// Its value.
        value: f64,
    },
    /// A number is infinite or not a number.
    NotFinite {
        /// Its key.
        key: &'static str,
        /// Its value.
        value: f64,
    },
    /// A vector is zero or has components that are not finite.
    NoDirection {
        /// Its key.
        key: &'static str,
        /// The vector.
        vector: Point,
    },
    /// The direction of a wave is that of its normal.
    AlongNormal {
        /// The direction.
        direction: Point,
    },
    /// A component of the place of an obstacle depends on position, though the obstacle moves as a whole.
    InSpace {
        /// The key of the component.
        key: &'static str,
    },
    /// The level of a surface does not depend on position.
    Level,
}

impl std::fmt::Display for ShapeFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}, expected {}", self.found(), self.expected())
    }
}

impl std::error::Error for ShapeFault {}

impl ShapeFault {
    /// The value found, for messages.
    #[must_use]
    pub fn found(&self) -> String {
        match self {
            ShapeFault::NotPositive { value, .. } => format!("{value:?}"),
            ShapeFault::NotFinite { value, .. } => value.to_string(),
            ShapeFault::NoDirection { vector, .. } if vector.iter().all(|c| *c == 0.0) => "zero".to_owned(),
            ShapeFault::NoDirection { vector, .. } => format!("{vector:?}"),
            ShapeFault::AlongNormal { .. } => "a direction along the normal".to_owned(),
            ShapeFault::InSpace { .. } => "an expression in space".to_owned(),
            ShapeFault::Level => "an expression that is the same everywhere".to_owned(),
        }
    }

    /// The value expected, for messages.
    #[must_use]
    pub fn expected(&self) -> &'static str {
        match self {
            ShapeFault::NotPositive { .. } => "a positive number",
            ShapeFault::NotFinite { .. } => "a finite number",
            ShapeFault::NoDirection { .. } => "a direction",
            ShapeFault::AlongNormal { .. } => "one across it",
            ShapeFault::InSpace { .. } => "a number or an expression in t: the obstacle moves as a whole",
            ShapeFault::Level => "one in space, positive outside the obstacle and negative inside",
        }
    }

    /// The key of the datum.
    #[must_use]
    pub fn key(&self) -> &'static str {
        match self {
            ShapeFault::NotPositive { key, .. }
            | ShapeFault::NotFinite { key, .. }
            | ShapeFault::NoDirection { key, .. }
            | ShapeFault::InSpace { key } => key,
            ShapeFault::AlongNormal { .. } => "direction",
            ShapeFault::Level => "level",
        }
    }
}

/// All faults of a shape.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", .0.iter().map(|fault| format!("{}: {fault}", fault.key())).collect::<Vec<_>>().join("\n"))]
pub struct ShapeFaults(pub Vec<ShapeFault>);

/// Collects faults.
#[derive(Default)]
struct Checks(Vec<ShapeFault>);

impl Checks {
    fn positive(&mut self, key: &'static str, value: f64) -> f64 {
        if !(value.is_finite() && value > 0.0) {
            self.0.push(ShapeFault::NotPositive { key, value });
        }
        value
    }

    /// The unit vector along `vector`.
    fn unit(&mut self, key: &'static str, vector: Point) -> Point {
        unit(&vector).unwrap_or_else(|| {
            self.0.push(ShapeFault::NoDirection { key, vector });
            vector
        })
    }

    /// Checks components that may depend on time but not on position.
    fn moving(&mut self, keys: [&'static str; 3], components: Point3) -> Point3 {
        let in_space = keys.into_iter().zip(&components).filter(|(_, field)| field.depends_on_space());
        self.0.extend(in_space.map(|(key, _)| ShapeFault::InSpace { key }));
        components
    }

    fn result<T>(self, shape: T) -> Result<T, ShapeFaults> {
        if self.0.is_empty() { Ok(shape) } else { Err(ShapeFaults(self.0)) }
    }
}

/// The coordinates in m of a point that may move; those beyond the dimension are zero.
pub type Point3 = [Field; 3];

const POINT: [&str; 3] = ["point[0]", "point[1]", "point[2]"];
const CENTER: [&str; 3] = ["center[0]", "center[1]", "center[2]"];

fn keyed<'a>(keys: [&'static str; 3], components: &'a Point3) -> Vec<(&'static str, &'a Field)> {
    keys.into_iter().zip(components).collect()
}

fn at(components: &Point3, t: f64) -> Point {
    [0, 1, 2].map(|c| components[c].value(&[0.0; 3], t))
}

/// a + s b.
fn plus(a: &Point, s: f64, b: &Point) -> Point {
    [0, 1, 2].map(|c| a[c] + s * b[c])
}

/// The unit vector along `v`; `None` if `v` is zero or not finite.
fn unit(v: &Point) -> Option<Point> {
    // Scaled first: the square of a short vector would underflow.
    let largest = v.iter().fold(0.0f64, |m, c| m.max(c.abs()));
    let scaled = v.map(|c| c / largest);
    let length = length(&scaled);
    (v.iter().all(|c| c.is_finite()) && length.is_finite()).then(|| scaled.map(|c| c / length))
}

/// The part of `v` across the unit vector `n`.
fn across(v: &Point, n: &Point) -> Point {
    plus(v, -dot(v, n), n)
}

/// A unit vector across the unit vector `n`, in the plane z = 0 if `n` is along z.
fn perpendicular(n: &Point) -> Point {
    let axis = if n[0].abs() <= n[1].abs() { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    unit(&across(&axis, n)).unwrap_or(axis)
}

/// The nearest point of a round surface, `from` the vector from the centre or axis to the point. On the centre or axis,
/// where all points are equally near, it is the one in direction `otherwise`.
fn round(from: &Point, radius: f64, inside: bool, otherwise: Point) -> Nearest {
    if from.iter().any(|c| c.is_nan()) {
        return Nearest::NONE;
    }
    let distance = length(from) - radius;
    let normal = unit(from).unwrap_or(otherwise);
    // A hollow shape has its matter outside.
    if inside { Nearest { distance: -distance, normal: normal.map(|c| -c) } } else { Nearest { distance, normal } }
}
