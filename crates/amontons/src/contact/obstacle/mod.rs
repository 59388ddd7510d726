//! Rigid surfaces that may move: what of them is nearest to a point, one shape per file.
//!
//! An obstacle gives (2.8)–(2.10) their geometry: contact acts along ν = −n, n the normal of the obstacle at the point
//! of it that is nearest, and the gap is the distance there. Both are functions of the place alone, whatever the mesh
//! of the body is.

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
pub use facets::{Facets, FacetsFault};
pub use file::File;
pub use load::ObstacleLoad;
pub use motion::{Motion, Rate, Turning};
pub use plane::Plane;
pub use sphere::Sphere;
pub use surface::Surface;
pub use wave::Wave;

use crate::field::Field;
use crate::tensor::{Point, dot, length};

/// A rigid obstacle that the body may touch.
#[derive(Clone, Debug)]
pub struct Obstacle {
    /// Its surface.
    pub shape: Arc<dyn Shape>,
    /// Whether distances and normals are those at x + u_{n−1}, anew in each step; else they are those at x, for small
    /// displacements.
    pub updated: bool,
    /// How it turns; none where it does not.
    pub turning: Option<Turning>,
    /// The force under which it moves besides what its place does; none where its place says where it is.
    pub load: Option<ObstacleLoad>,
}

impl Obstacle {
    /// What is nearest to a point at a time, of an obstacle under a load where that has moved it, as far as is known.
    #[must_use]
    pub fn nearest(&self, x: &Point, t: f64) -> Nearest {
        self.nearest_moved(x, t, self.known(t))
    }

    /// What is nearest to a point at a time, of an obstacle that has moved by a length δ along the direction of its
    /// load.
    #[must_use]
    pub fn nearest_moved(&self, x: &Point, t: f64, along: f64) -> Nearest {
        let direction = self.direction();
        let x: Point = std::array::from_fn(|c| x[c] - along * direction[c]);
        let Some(turning) = self.changes_by() else { return self.shape.nearest(&x, t) };
        let turn = turning.at(self.shape.place(t), t);
        let Nearest { distance, normal } = self.shape.nearest(&turn.before(&x), t);
        Nearest { distance, normal: turn.after(&normal) }
    }

    /// The rotation where it changes the place of the surface: not of a ball about its centre, a cylinder about its
    /// axis, and a plane about its normal.
    fn changes_by(&self) -> Option<&Turning> {
        let turning = self.turning.as_ref()?;
        (!self.shape.turns_into_itself(turning.axis(), turning.is_about_place())).then_some(turning)
    }

    /// Whether it turns, and its surface stays where it is.
    #[must_use]
    pub fn turns_in_place(&self) -> bool {
        self.turning.is_some() && self.changes_by().is_none()
    }

    /// The unit vector along which its load moves it; zero without a load.
    #[must_use]
    pub fn direction(&self) -> Point {
        self.load.as_ref().map_or([0.0; 3], |load| load.direction)
    }

    /// δ as far as it is known.
    fn known(&self, t: f64) -> f64 {
        self.load.as_ref().map_or(0.0, |load| load.known(t))
    }

    /// Its velocity as a rigid body at a time, `rate` making the rate at that time of a function of time; what its load
    /// adds, as far as it is known.
    #[must_use]
    pub fn motion(&self, t: f64, rate: &Rate) -> Motion {
        let motion = Motion::new(self.turning.as_ref(), &|t| self.shape.place(t), t, rate);
        let Some(load) = &self.load else { return motion };
        let [moved, speed] = [load.known(t), rate(&|t| load.known(t))].map(|size| load.direction.map(|c| size * c));
        motion.carried(&moved, &speed)
    }

    /// Place of a point that moves with the obstacle and does not turn, as far as it is known.
    #[must_use]
    pub fn place(&self, t: f64) -> Point {
        let (place, along, direction) = (self.shape.place(t), self.known(t), self.direction());
        std::array::from_fn(|c| place[c] + along * direction[c])
    }

    /// Whether it may move or change its shape.
    #[must_use]
    pub fn depends_on_time(&self) -> bool {
        let turns = |turning: &Turning| turning.fields().iter().any(|(_, field)| field.depends_on_time());
        self.load.is_some() || self.shape.depends_on_time() || self.changes_by().is_some_and(turns)
    }

    /// The data that may vary in time, by their keys.
    #[must_use]
    pub fn fields(&self) -> Vec<(&'static str, &Field)> {
        let turning = self.turning.iter().flat_map(Turning::fields);
        self.shape.fields().into_iter().chain(turning).collect()
    }
}

/// What of an obstacle is nearest to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Distance in m, negative inside the obstacle; NaN where there is no nearest point.
    pub distance: f64,
    /// Unit normal out of the obstacle at the nearest point of its surface, which is the gradient of the distance.
    pub normal: Point,
}

impl Nearest {
    /// No nearest point.
    pub const NONE: Nearest = Nearest { distance: f64::NAN, normal: [f64::NAN; 3] };
}

/// The surface of an obstacle. In two dimensions points have z = 0, and so have normals.
pub trait Shape: Debug + Send + Sync {
    /// What is nearest to a point at a time; of several points equally near the same in each call.
    fn nearest(&self, x: &Point, t: f64) -> Nearest;
    /// Place in m of a point that moves with the obstacle; zero where it has none.
    fn place(&self, _t: f64) -> Point {
        [0.0; 3]
    }
    /// The data that may vary in time, by their keys.
    fn fields(&self) -> Vec<(&'static str, &Field)> {
        Vec::new()
    }
    /// Whether a rotation about an axis with this unit vector leaves it where it is: about its place, or about any
    /// point.
    fn turns_into_itself(&self, _axis: &Point, _about_place: bool) -> bool {
        false
    }
    /// The least and the largest coordinates of a surface of finite size at a time, m.
    fn bounds(&self, _t: f64) -> Option<[Point; 2]> {
        None
    }
    /// Whether what is nearest may change with time.
    fn depends_on_time(&self) -> bool {
        self.fields().iter().any(|(_, field)| field.depends_on_time())
    }
}

/// What is wrong with a datum of a shape.
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
    /// The place of an obstacle that would move as a whole depends on where it is looked at.
    InSpace {
        /// The key of the component.
        key: &'static str,
    },
    /// The level of a surface is the same everywhere.
    Level,
}

impl std::fmt::Display for ShapeFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}, expected {}", self.found(), self.expected())
    }
}

impl std::error::Error for ShapeFault {}

impl ShapeFault {
    /// What was found.
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

    /// What was expected.
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

/// What is wrong with a shape, all at once.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", .0.iter().map(|fault| format!("{}: {fault}", fault.key())).collect::<Vec<_>>().join("\n"))]
pub struct ShapeFaults(pub Vec<ShapeFault>);

/// Collects what is wrong.
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

    /// Components that may depend on time.
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

fn minus(a: &Point, b: &Point) -> Point {
    [0, 1, 2].map(|c| a[c] - b[c])
}

/// a + s b.
fn plus(a: &Point, s: f64, b: &Point) -> Point {
    [0, 1, 2].map(|c| a[c] + s * b[c])
}

/// The unit vector along `v`; none of a vector that is zero or not finite.
fn unit(v: &Point) -> Option<Point> {
    // The square of a short vector would underflow.
    let largest = v.iter().fold(0.0f64, |m, c| m.max(c.abs()));
    let scaled = v.map(|c| c / largest);
    let length = length(&scaled);
    (v.iter().all(|c| c.is_finite()) && length.is_finite()).then(|| scaled.map(|c| c / length))
}

/// The part of `v` across the unit vector `n`.
fn across(v: &Point, n: &Point) -> Point {
    plus(v, -dot(v, n), n)
}

/// A unit vector across the unit vector `n`, in the plane z = 0 where `n` is along z.
fn perpendicular(n: &Point) -> Point {
    let axis = if n[0].abs() <= n[1].abs() { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    unit(&across(&axis, n)).unwrap_or(axis)
}

/// The nearest point of a round surface, `from` the vector to the point from the centre or axis; on the centre or axis,
/// where all points are equally near, it is the one in direction `otherwise`.
fn round(from: &Point, radius: f64, inside: bool, otherwise: Point) -> Nearest {
    if from.iter().any(|c| c.is_nan()) {
        return Nearest::NONE;
    }
    let distance = length(from) - radius;
    let normal = unit(from).unwrap_or(otherwise);
    // A hollow one has its matter outside.
    if inside { Nearest { distance: -distance, normal: normal.map(|c| -c) } } else { Nearest { distance, normal } }
}
