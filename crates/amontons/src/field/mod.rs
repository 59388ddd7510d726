//! Data that may vary in space, in time and with the temperature: a number, an expression in x, y, z, t, a table, or a
//! function.

mod coefficient;
mod law;
mod table;
mod thermal;

pub use coefficient::{Coefficient, InSpace, TemperatureDependent};
pub(crate) use law::law_kind;
pub use law::{Graded, Law, LawInstance, LawKind};
pub use table::{TableError, TimeTable};
pub use thermal::TemperatureTable;
#[cfg(feature = "case")]
pub(crate) use thermal::common;
pub(crate) use thermal::reference;

use std::fmt;
use std::sync::Arc;

use crate::expression::{Derivatives, Expression};
use crate::tensor::Point;

/// A scalar function of position and time, in the unit of its quantity.
#[derive(Clone, Debug, PartialEq)]
pub enum Field {
    /// A constant.
    Constant(f64),
    /// An expression in x, y, z and t.
    Expression(Expression),
    /// Values at times, linear between them, times a factor.
    Table(TimeTable),
    /// A function of the position, such as values on a mesh.
    Function(SpaceFunction),
    /// Values at temperatures, linear between them, times a factor.
    Thermal(TemperatureTable),
}

/// A function of the position.
#[derive(Clone)]
pub struct SpaceFunction(Arc<dyn Fn(&Point) -> f64 + Send + Sync>);

impl fmt::Debug for SpaceFunction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("SpaceFunction")
    }
}

impl PartialEq for SpaceFunction {
    /// True if both are the same function in memory.
    fn eq(&self, other: &SpaceFunction) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// Step of difference quotients relative to a coordinate, where truncation and round-off balance.
const STEP: f64 = 1e-5;

impl SpaceFunction {
    /// Value, and derivatives by central differences.
    fn derivatives(&self, x: &Point) -> Derivatives {
        let slope = |d: usize| {
            let h = STEP * (1.0 + x[d].abs());
            let at = |h: f64| (self.0)(&std::array::from_fn(|c| if c == d { x[c] + h } else { x[c] }));
            (at(h) - at(-h)) / (2.0 * h)
        };
        Derivatives { value: (self.0)(x), by_x: std::array::from_fn(slope), by_t: 0.0 }
    }
}

impl Default for Field {
    fn default() -> Field {
        Field::ZERO
    }
}

impl From<f64> for Field {
    fn from(value: f64) -> Field {
        Field::Constant(value)
    }
}

impl From<Expression> for Field {
    fn from(expression: Expression) -> Field {
        Field::Expression(expression)
    }
}

impl Field {
    /// Zero everywhere and always.
    pub const ZERO: Field = Field::Constant(0.0);

    /// A function of the position.
    #[must_use]
    pub fn of_space(value: impl Fn(&Point) -> f64 + Send + Sync + 'static) -> Field {
        Field::Function(SpaceFunction(Arc::new(value)))
    }

    /// Value at a point and a time; for a table over the temperature, at its temperature nearest to 0.
    #[must_use]
    pub fn value(&self, x: &Point, t: f64) -> f64 {
        match self {
            Field::Constant(value) => *value,
            Field::Expression(e) => e.value(x, t),
            Field::Table(table) => table.value(x, t),
            Field::Function(function) => (function.0)(x),
            Field::Thermal(table) => table.value(x, reference(table.temperatures())),
        }
    }

    /// Value at a position, time and temperature.
    #[must_use]
    pub fn value_at(&self, x: &Point, t: f64, theta: f64) -> f64 {
        match self {
            Field::Thermal(table) => table.value(x, theta),
            field => field.value(x, t),
        }
    }

    /// The temperatures of a table over the temperature, K; empty for other data.
    #[must_use]
    pub fn temperatures(&self) -> &[f64] {
        match self {
            Field::Thermal(table) => table.temperatures(),
            _ => &[],
        }
    }

    /// Value and derivatives at a point and a time.
    #[must_use]
    pub fn derivatives(&self, x: &Point, t: f64) -> Derivatives {
        match self {
            Field::Constant(value) => Derivatives { value: *value, ..Derivatives::default() },
            Field::Expression(e) => e.derivatives(x, t),
            Field::Table(table) => table.derivatives(x, t),
            Field::Function(function) => function.derivatives(x),
            Field::Thermal(_) => {
                let field = self.clone();
                SpaceFunction(Arc::new(move |x| field.value(x, t))).derivatives(x)
            }
        }
    }

    /// Values at many points at one time.
    #[must_use]
    pub fn values(&self, points: &[Point], t: f64) -> Vec<f64> {
        let mut out = vec![0.0; points.len()];
        match self {
            Field::Constant(value) => out.fill(*value),
            Field::Expression(e) => e.values(points, t, &mut out),
            Field::Table(table) => table.values(points, t, &mut out),
            Field::Function(_) | Field::Thermal(_) => {
                out.iter_mut().zip(points).for_each(|(out, x)| *out = self.value(x, t));
            }
        }
        out
    }

    /// True if the value changes with time.
    #[must_use]
    pub fn depends_on_time(&self) -> bool {
        match self {
            Field::Constant(_) | Field::Function(_) | Field::Thermal(_) => false,
            Field::Expression(e) => e.depends_on_time(),
            Field::Table(_) => true,
        }
    }

    /// True if the value may vary in space.
    #[must_use]
    pub fn depends_on_space(&self) -> bool {
        match self {
            Field::Constant(_) => false,
            Field::Expression(e) => e.depends_on_space(),
            Field::Table(table) => table.depends_on_space(),
            Field::Function(_) => true,
            Field::Thermal(table) => table.depends_on_space(),
        }
    }

    /// The first and the last time at which it has a value, s.
    #[must_use]
    pub fn span(&self) -> [f64; 2] {
        match self {
            Field::Table(table) => table.span(),
            _ => [f64::NEG_INFINITY, f64::INFINITY],
        }
    }

    /// True if the field is the number zero.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        matches!(self, Field::Constant(0.0))
    }
}
