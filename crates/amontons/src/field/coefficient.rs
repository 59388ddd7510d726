//! Coefficients of a material: a value for the whole region, or one that varies in space.

use std::fmt;
use std::sync::Arc;

use super::Field;
use crate::tensor::{Point, Sym};

/// A datum of the body: the same value everywhere, or a function of the position.
pub trait InSpace<T>: Sync {
    /// The value at a point.
    fn at(&self, x: &Point) -> T;
    /// The value, if it is the same everywhere.
    fn constant(&self) -> Option<T>;
}

/// A value is the same everywhere. For each type by itself: a reference to a coefficient is no value.
macro_rules! values {
    ($($value:ty),*) => {$(
        impl InSpace<$value> for $value {
            fn at(&self, _x: &Point) -> $value {
                *self
            }
            fn constant(&self) -> Option<$value> {
                Some(*self)
            }
        }
    )*};
}

values!(f64, Sym);

/// A function of the position.
type Function<T> = dyn Fn(&Point) -> T + Send + Sync;

/// A coefficient of a material in its region, such as the density (a number) or the conductivity (a tensor).
///
/// Numbers and tensors convert into it, [`Field`]s too, and [`Coefficient::varying`] takes any function:
///
/// ```
/// use amontons::field::{Coefficient, InSpace};
///
/// let density: Coefficient<f64> = 7800.0.into();
/// assert_eq!(density.constant(), Some(7800.0));
/// let graded = Coefficient::varying(|x| 1.0 + x[0]);
/// assert_eq!((graded.at(&[0.5, 0.0, 0.0]), graded.constant()), (1.5, None));
/// ```
#[derive(Clone)]
pub enum Coefficient<T> {
    /// The same value everywhere.
    Constant(T),
    /// A function of the position.
    Varying(Arc<Function<T>>),
}

impl<T> Coefficient<T> {
    /// A coefficient that is a function of the position.
    pub fn varying(value: impl Fn(&Point) -> T + Send + Sync + 'static) -> Coefficient<T> {
        Coefficient::Varying(Arc::new(value))
    }

    /// Whether it is a function of the position.
    #[must_use]
    pub fn varies(&self) -> bool {
        matches!(self, Coefficient::Varying(_))
    }
}

impl<T: Copy + Sync> Coefficient<T> {
    /// The value at a point.
    #[must_use]
    pub fn at(&self, x: &Point) -> T {
        match self {
            Coefficient::Constant(value) => *value,
            Coefficient::Varying(value) => value(x),
        }
    }

    /// The value, if it is the same everywhere.
    #[must_use]
    pub fn constant(&self) -> Option<T> {
        match self {
            Coefficient::Constant(value) => Some(*value),
            Coefficient::Varying(_) => None,
        }
    }
}

impl<T: Copy + Sync> InSpace<T> for Coefficient<T> {
    fn at(&self, x: &Point) -> T {
        self.at(x)
    }
    fn constant(&self) -> Option<T> {
        self.constant()
    }
}

impl<T> From<T> for Coefficient<T> {
    fn from(value: T) -> Coefficient<T> {
        Coefficient::Constant(value)
    }
}

impl From<Field> for Coefficient<f64> {
    /// The field at t = 0.
    fn from(field: Field) -> Coefficient<f64> {
        match field {
            Field::Constant(value) => Coefficient::Constant(value),
            field => Coefficient::varying(move |x| field.value(x, 0.0)),
        }
    }
}

impl<T: PartialEq> PartialEq<T> for Coefficient<T> {
    /// Whether it has this value everywhere; a function is equal to no value.
    fn eq(&self, other: &T) -> bool {
        matches!(self, Coefficient::Constant(value) if value == other)
    }
}

impl<T: PartialEq> PartialEq for Coefficient<T> {
    /// Whether both have the same value everywhere, or are the same function.
    fn eq(&self, other: &Coefficient<T>) -> bool {
        match (self, other) {
            (Coefficient::Constant(value), Coefficient::Constant(other)) => value == other,
            (Coefficient::Varying(value), Coefficient::Varying(other)) => Arc::ptr_eq(value, other),
            _ => false,
        }
    }
}

impl<T: fmt::Debug> fmt::Debug for Coefficient<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Coefficient::Constant(value) => value.fmt(f),
            Coefficient::Varying(_) => f.write_str("Varying"),
        }
    }
}
