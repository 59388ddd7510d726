//! Laws whose coefficients vary: at every point, time and temperature the law that a function gives there.

use std::fmt;
use std::sync::Arc;

use super::coefficient::held;
use super::reference;
use crate::tensor::Point;

/// The law at a position, time and temperature.
type At<T> = dyn Fn(&Point, f64, f64) -> Arc<T> + Send + Sync;

/// A law with the place, the time and the temperature at which it stands.
pub struct Instance<T: ?Sized> {
    /// The place, m.
    pub x: Point,
    /// The time, s; 0 for laws that do not change with time.
    pub t: f64,
    /// The temperature, K; none for laws that do not depend on it.
    pub theta: Option<f64>,
    /// The law there.
    pub law: Arc<T>,
}

/// A law whose coefficients vary over the body or over a side, and in time or with the temperature where the law may:
/// at every point the law of constant coefficients that a function gives there.
///
/// `T` is the trait of the law: `dyn TensorLaw`, `dyn NormalLaw`, `dyn FrictionLaw`, `dyn HeatLaw` or `dyn WearLaw`.
/// The constants of (H1)–(H8) are those of the least and the largest of the laws at the points given, which should be
/// those at which the law is evaluated: the nodes and the points of the integrals.
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
    at: Arc<At<T>>,
    t: f64,
    changes: bool,
    /// The temperatures between which the law is known, K; empty if it does not depend on the temperature.
    temperatures: Arc<[f64]>,
    /// Whether one of the laws is special: not linear (elasticity), or with a bound that drops when slip starts
    /// (friction).
    special: bool,
    least: Instance<T>,
    most: Instance<T>,
}

impl<T: ?Sized> Graded<T> {
    /// The law that `at` gives at a point and a time, with its extremes by `size` over points and times.
    ///
    /// Without points the law at the origin is taken.
    pub(crate) fn over(
        points: &[Point],
        times: &[f64],
        at: impl Fn(&Point, f64) -> Arc<T> + Send + Sync + 'static,
        size: impl Fn(&T) -> ([f64; 2], bool),
    ) -> Graded<T> {
        Graded::over_all(points, times, &[], move |x, t, _| at(x, t), size)
    }

    /// The same of a law that depends on the temperature, with its extremes over the temperatures, too.
    pub(crate) fn over_all(
        points: &[Point],
        times: &[f64],
        temperatures: &[f64],
        at: impl Fn(&Point, f64, f64) -> Arc<T> + Send + Sync + 'static,
        size: impl Fn(&T) -> ([f64; 2], bool),
    ) -> Graded<T> {
        let instance = |x: &Point, t: f64, theta: f64| Instance {
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

    /// The law at a point, at the present time; of one that depends on the temperature at that which is nearest to 0.
    #[must_use]
    pub fn at(&self, x: &Point) -> Arc<T> {
        (self.at)(x, self.t, reference(&self.temperatures))
    }

    /// The law at a point and a temperature; beyond its temperatures that at the first or the last of them.
    #[must_use]
    pub fn at_temperature(&self, x: &Point, theta: f64) -> Arc<T> {
        (self.at)(x, self.t, held(&self.temperatures, theta))
    }

    /// The temperatures between which the law is known, K; empty if it does not depend on the temperature.
    #[must_use]
    pub fn temperatures(&self) -> &[f64] {
        &self.temperatures
    }

    /// The laws at which the least and the largest constant are attained.
    #[must_use]
    pub fn extremes(&self) -> [&Instance<T>; 2] {
        [&self.least, &self.most]
    }

    /// Whether one of the laws is not linear, or has a bound that drops when slip starts.
    pub(crate) fn is_special(&self) -> bool {
        self.special
    }

    /// The same law at another time; none for a law that does not change with time.
    pub(crate) fn at_time(&self, t: f64) -> Option<Graded<T>> {
        self.changes.then(|| Graded { t, ..self.clone() })
    }
}

impl<T: ?Sized> Clone for Instance<T> {
    fn clone(&self) -> Instance<T> {
        Instance { x: self.x, t: self.t, theta: self.theta, law: Arc::clone(&self.law) }
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
    /// The law that `other` makes of this one at each point, which keeps the order of constants.
    pub(crate) fn map(&self, other: impl Fn(&T, &Point) -> Arc<T> + Send + Sync + 'static) -> Graded<T> {
        let [least, most] = self.extremes().map(|i| Instance { law: other(i.law.as_ref(), &i.x), ..i.clone() });
        let at = Arc::clone(&self.at);
        let at = move |x: &Point, t: f64, theta: f64| other(at(x, t, theta).as_ref(), x);
        Graded { at: Arc::new(at), temperatures: Arc::clone(&self.temperatures), least, most, ..*self }
    }
}
