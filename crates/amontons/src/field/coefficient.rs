//! Material coefficients: constant over the region, or varying in space and with the temperature.

use std::fmt;
use std::sync::Arc;

use super::{Field, reference};
use crate::tensor::{Point, Sym};

/// A datum of the body: constant, or a function of position and temperature.
pub trait InSpace<T>: Sync {
    /// The value at a point; for a function of the temperature, at its temperature nearest to 0.
    fn at(&self, x: &Point) -> T;
    /// The value at a point and a temperature.
    fn at_temperature(&self, x: &Point, _theta: f64) -> T {
        self.at(x)
    }
    /// The value if it is constant; `None` otherwise.
    fn constant(&self) -> Option<T>;
}

/// Implements constants. Each type is listed, since a reference to a coefficient is no value.
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
///
/// A function of the temperature holds between given temperatures, K. Beyond them its value is constant, and a step
/// that ends there is refused:
///
/// ```
/// # use amontons::field::{Coefficient, InSpace};
/// let conductivity = Coefficient::of_temperature(&[0.0, 500.0], |_, theta| 50.0 - 0.02 * theta);
/// assert_eq!(conductivity.at_temperature(&[0.0; 3], 100.0), 48.0);
/// ```
#[derive(Clone)]
pub enum Coefficient<T> {
    /// A constant.
    Constant(T),
    /// A function of the position.
    Varying(Arc<Function<T>>),
    /// A function of the position and the temperature.
    Thermal(Arc<TemperatureDependent<T>>),
}

/// A function of the position and the temperature.
pub struct TemperatureDependent<T> {
    temperatures: Vec<f64>,
    at: Box<AtTemperature<T>>,
    /// The integral over the temperature from 0; `None` if not known.
    integral: Option<Box<AtTemperature<T>>>,
}

type AtTemperature<T> = dyn Fn(&Point, f64) -> T + Send + Sync;

impl<T> Coefficient<T> {
    /// Makes a coefficient that is a function of the position.
    pub fn varying(value: impl Fn(&Point) -> T + Send + Sync + 'static) -> Coefficient<T> {
        Coefficient::Varying(Arc::new(value))
    }

    /// Makes a coefficient that is a function of position and temperature.
    ///
    /// It holds from the first to the last of the ascending temperatures. Its bounds are taken at these temperatures
    /// only: include those of kinks and extrema.
    pub fn of_temperature(
        temperatures: &[f64],
        value: impl Fn(&Point, f64) -> T + Send + Sync + 'static,
    ) -> Coefficient<T> {
        let temperatures = temperatures.to_vec();
        Coefficient::Thermal(Arc::new(TemperatureDependent { temperatures, at: Box::new(value), integral: None }))
    }

    /// True if it depends on position or temperature.
    #[must_use]
    pub fn varies(&self) -> bool {
        !matches!(self, Coefficient::Constant(_))
    }

    /// The temperatures of a function of the temperature, K; empty for others.
    #[must_use]
    pub fn temperatures(&self) -> &[f64] {
        match self {
            Coefficient::Thermal(thermal) => &thermal.temperatures,
            _ => &[],
        }
    }
}

/// Gauss point of degree 5 on [−1, 1] next to 0.
const GAUSS: f64 = 0.774_596_669_241_483_4;

impl Coefficient<f64> {
    /// The integral over the temperature from 0: the enthalpy for a heat capacity c, cθ if c is constant.
    ///
    /// A function is integrated by Gauss's rule of degree 5 between its temperatures; beyond them its value is
    /// constant.
    #[must_use]
    pub fn integral(&self, x: &Point, theta: f64) -> f64 {
        let Coefficient::Thermal(thermal) = self else { return self.at(x) * theta };
        if let Some(integral) = &thermal.integral {
            return integral(x, theta);
        }
        let (from, to) = if theta < 0.0 { (theta, 0.0) } else { (0.0, theta) };
        let inside = thermal.temperatures.iter().copied().filter(|knot| (from..to).contains(knot) && *knot > from);
        let mut ends: Vec<f64> = std::iter::once(from).chain(inside).collect();
        ends.push(to);
        let part = |pair: &[f64]| {
            let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
            let at = |place: f64| self.at_temperature(x, middle + half * place);
            half * (5.0 * (at(-GAUSS) + at(GAUSS)) + 8.0 * at(0.0)) / 9.0
        };
        theta.signum() * ends.windows(2).map(part).sum::<f64>()
    }
}

impl<T: Copy + Sync> Coefficient<T> {
    /// The value at a point; for a function of the temperature, at its temperature nearest to 0.
    #[must_use]
    pub fn at(&self, x: &Point) -> T {
        match self {
            Coefficient::Constant(value) => *value,
            Coefficient::Varying(value) => value(x),
            Coefficient::Thermal(thermal) => (thermal.at)(x, reference(&thermal.temperatures)),
        }
    }

    /// The value at a point and a temperature; constant beyond the range of its temperatures.
    #[must_use]
    pub fn at_temperature(&self, x: &Point, theta: f64) -> T {
        match self {
            Coefficient::Thermal(thermal) => (thermal.at)(x, held(&thermal.temperatures, theta)),
            coefficient => coefficient.at(x),
        }
    }

    /// The value if it is constant; `None` otherwise.
    #[must_use]
    pub fn constant(&self) -> Option<T> {
        match self {
            Coefficient::Constant(value) => Some(*value),
            Coefficient::Varying(_) | Coefficient::Thermal(_) => None,
        }
    }
}

/// The temperature, clamped to the range of a list.
pub(super) fn held(temperatures: &[f64], theta: f64) -> f64 {
    match temperatures {
        [first, .., last] if first <= last => theta.clamp(*first, *last),
        [only] => *only,
        _ => theta,
    }
}

impl<T: Copy + Sync> InSpace<T> for Coefficient<T> {
    fn at(&self, x: &Point) -> T {
        self.at(x)
    }
    fn at_temperature(&self, x: &Point, theta: f64) -> T {
        self.at_temperature(x, theta)
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
            Field::Thermal(table) => {
                let whole = table.clone();
                Coefficient::Thermal(Arc::new(TemperatureDependent {
                    temperatures: table.temperatures().to_vec(),
                    at: Box::new(move |x, theta| table.value(x, theta)),
                    integral: Some(Box::new(move |x, theta| whole.integral(x, theta))),
                }))
            }
            field => Coefficient::varying(move |x| field.value(x, 0.0)),
        }
    }
}

impl<T: PartialEq> PartialEq<T> for Coefficient<T> {
    /// True if it has this value everywhere; a function equals no value.
    fn eq(&self, other: &T) -> bool {
        matches!(self, Coefficient::Constant(value) if value == other)
    }
}

impl<T: PartialEq> PartialEq for Coefficient<T> {
    /// True if both have the same constant value, or are the same function.
    fn eq(&self, other: &Coefficient<T>) -> bool {
        match (self, other) {
            (Coefficient::Constant(value), Coefficient::Constant(other)) => value == other,
            (Coefficient::Varying(value), Coefficient::Varying(other)) => Arc::ptr_eq(value, other),
            (Coefficient::Thermal(value), Coefficient::Thermal(other)) => Arc::ptr_eq(value, other),
            _ => false,
        }
    }
}

impl<T: fmt::Debug> fmt::Debug for Coefficient<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Coefficient::Constant(value) => value.fmt(f),
            Coefficient::Varying(_) => f.write_str("Varying"),
            Coefficient::Thermal(_) => f.write_str("Thermal"),
        }
    }
}
