//! Laws with varying coefficients: a function gives the law at every point, time and temperature.

use std::fmt;
use std::sync::Arc;

use super::coefficient::held;
use super::reference;
use crate::tensor::Point;

/// The law at a position, time and temperature.
type LawFunction<T> = dyn Fn(&Point, f64, f64) -> Arc<T> + Send + Sync;

/// A law with the position, time and temperature for which it holds.
pub struct LawInstance<T: ?Sized> {
    /// The position, m.
    pub x: Point,
    /// The time, s; 0 for laws that do not change with time.
    pub t: f64,
    /// The temperature, K; `None` for laws that do not depend on it.
    pub theta: Option<f64>,
    /// The law.
    pub law: Arc<T>,
}

/// A law whose coefficients vary over the body or over a side, and in time or with the temperature if the law allows
/// that: a function gives the law of constant coefficients at every point.
///
/// `T` is the trait of the law: `dyn TensorLaw`, `dyn NormalLaw`, `dyn FrictionLaw`, `dyn HeatLaw` or `dyn WearLaw`.
/// The constants of (H1)–(H8) are the extremes over the given points, which should be those at which the law is
/// evaluated: the nodes and the quadrature points.
///
/// ```
/// use std::sync::Arc;
/// use amontons::field::Graded;
/// use amontons::material::{Isotropic, StressState::PlaneStrain, TensorLaw};
///
/// let points = [[0.0; 3], [1.0, 0.0, 0.0]];
/// let law = Graded::elastic(&points, |x| Arc::new(Isotropic::lame(3, 0.0, 1.0 + x[0], PlaneStrain)));
/// assert_eq!((law.constants().monotonicity, law.constants().lipschitz), (1.0, 2.0));
/// ```
pub struct Graded<T: ?Sized> {
    at: Arc<LawFunction<T>>,
    t: f64,
    changes: bool,
    /// The temperatures between which the law is known, K; empty if it is independent of the temperature.
    temperatures: Arc<[f64]>,
    /// True if one of the laws is nonlinear (elasticity), or has a bound that drops when slip starts (friction).
    special: bool,
    least: LawInstance<T>,
    most: LawInstance<T>,
}

impl<T: ?Sized> Graded<T> {
    /// The law that `at` gives per point and time, with its extremes by `size` over points and times.
    ///
    /// Without points, the law at the origin is used.
    pub(crate) fn over(
        points: &[Point],
        times: &[f64],
        at: impl Fn(&Point, f64) -> Arc<T> + Send + Sync + 'static,
        size: impl Fn(&T) -> ([f64; 2], bool),
    ) -> Graded<T> {
        Graded::over_all(points, times, &[], move |x, t, _| at(x, t), size)
    }

    /// Like [`Graded::over`] for a law that also depends on the temperature, with its extremes over the temperatures.
    pub(crate) fn over_all(
        points: &[Point],
        times: &[f64],
        temperatures: &[f64],
        at: impl Fn(&Point, f64, f64) -> Arc<T> + Send + Sync + 'static,
        size: impl Fn(&T) -> ([f64; 2], bool),
    ) -> Graded<T> {
        let instance = |x: &Point, t: f64, theta: f64| LawInstance {
            x: *x,
            t,
            theta: (!temperatures.is_empty()).then_some(theta),
            law: at(x, t, theta),
        };
        let start = times.first().copied().unwrap_or(0.0);
        let origin = points.first().copied().unwrap_or_default();
        let rest = reference(temperatures);
        let (mut least, mut most) = (instance(&origin, start, rest), instance(&origin, start, rest));
        let ([mut low, mut high], mut special) = size(&least.law);
        let levels = if temperatures.is_empty() { &[0.0] } else { temperatures };
        let when = times.iter().flat_map(|&t| levels.iter().map(move |&theta| (t, theta)));
        for ((t, theta), x) in when.flat_map(|when| points.iter().map(move |x| (when, x))) {
            let here = instance(x, t, theta);
            let ([lower, upper], is_special) = size(&here.law);
            special |= is_special;
            if upper > high || upper.is_nan() {
                high = upper;
                most = here.clone();
            }
            if lower < low || lower.is_nan() {
                low = lower;
                least = here;
            }
        }
        let (at, changes) = (Arc::new(at), times.len() > 1);
        Graded { at, t: start, changes, temperatures: temperatures.into(), special, least, most }
    }

    /// The law at a point at its time; if it depends on the temperature, at its temperature nearest to 0.
    #[must_use]
    pub fn at(&self, x: &Point) -> Arc<T> {
        (self.at)(x, self.t, reference(&self.temperatures))
    }

    /// The law at a point and a temperature; constant beyond the range of its temperatures.
    #[must_use]
    pub fn at_temperature(&self, x: &Point, theta: f64) -> Arc<T> {
        (self.at)(x, self.t, held(&self.temperatures, theta))
    }

    /// The temperatures between which the law is known, K; empty if it is independent of the temperature.
    #[must_use]
    pub fn temperatures(&self) -> &[f64] {
        &self.temperatures
    }

    /// The laws at which the least and the largest constant are attained.
    #[must_use]
    pub fn extremes(&self) -> [&LawInstance<T>; 2] {
        [&self.least, &self.most]
    }

    /// True if one of the laws is nonlinear, or has a bound that drops when slip starts.
    pub(crate) fn is_special(&self) -> bool {
        self.special
    }

    /// This law at another time; `None` if it does not change with time.
    pub(crate) fn at_time(&self, t: f64) -> Option<Graded<T>> {
        self.changes.then(|| Graded { t, ..self.clone() })
    }
}

impl<T: ?Sized> Clone for LawInstance<T> {
    fn clone(&self) -> LawInstance<T> {
        LawInstance { x: self.x, t: self.t, theta: self.theta, law: Arc::clone(&self.law) }
    }
}

impl<T: ?Sized> Clone for Graded<T> {
    fn clone(&self) -> Graded<T> {
        Graded {
            at: Arc::clone(&self.at),
            temperatures: Arc::clone(&self.temperatures),
            least: self.least.clone(),
            most: self.most.clone(),
            ..*self
        }
    }
}

impl<T: fmt::Debug + ?Sized> fmt::Debug for Graded<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Graded").field("least", &self.least.law).field("most", &self.most.law).finish_non_exhaustive()
    }
}

impl<T: ?Sized + 'static> Graded<T> {
    /// The law derived from this one at each point by `other`, which must keep the order of constants.
    pub(crate) fn map(&self, other: impl Fn(&T, &Point) -> Arc<T> + Send + Sync + 'static) -> Graded<T> {
        let [least, most] = self.extremes().map(|i| LawInstance { law: other(i.law.as_ref(), &i.x), ..i.clone() });
        let at = Arc::clone(&self.at);
        let at = move |x: &Point, t: f64, theta: f64| other(at(x, t, theta).as_ref(), x);
        Graded { at: Arc::new(at), temperatures: Arc::clone(&self.temperatures), least, most, ..*self }
    }
}
