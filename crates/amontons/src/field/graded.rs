//! Laws whose coefficients vary: at every point the law that a function gives there.

use std::fmt;
use std::sync::Arc;

use crate::tensor::Point;

/// The law at a point and a time.
type At<T> = dyn Fn(&Point, f64) -> Arc<T> + Send + Sync;

/// A law with the place and the time at which it stands.
pub struct Instance<T: ?Sized> {
    /// The place, m.
    pub x: Point,
    /// The time, s; 0 for laws that do not change with time.
    pub t: f64,
    /// The law there.
    pub law: Arc<T>,
}

/// A law whose coefficients vary over the body or over a side, and in time where the law may: at every point the law of
/// constant coefficients that a function gives there.
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
        let instance = |x: &Point, t: f64| Instance { x: *x, t, law: at(x, t) };
        let start = times.first().copied().unwrap_or(0.0);
        let origin = points.first().copied().unwrap_or_default();
        let (mut least, mut most) = (instance(&origin, start), instance(&origin, start));
        let ([mut low, mut high], mut special) = size(&least.law);
        for (t, x) in times.iter().flat_map(|&t| points.iter().map(move |x| (t, x))) {
            let here = instance(x, t);
            let ([lower, upper], is_special) = size(&here.law);
            special |= is_special;
            if upper > high || upper.is_nan() {
                high = upper;
                most = Instance { x: *x, t, law: Arc::clone(&here.law) };
            }
            if lower < low || lower.is_nan() {
                low = lower;
                least = here;
            }
        }
        Graded { at: Arc::new(at), t: start, changes: times.len() > 1, special, least, most }
    }

    /// The law at a point, at the present time.
    #[must_use]
    pub fn at(&self, x: &Point) -> Arc<T> {
        (self.at)(x, self.t)
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
        Instance { x: self.x, t: self.t, law: Arc::clone(&self.law) }
    }
}

impl<T: ?Sized> Clone for Graded<T> {
    fn clone(&self) -> Graded<T> {
        Graded { at: Arc::clone(&self.at), least: self.least.clone(), most: self.most.clone(), ..*self }
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
        let at = move |x: &Point, t: f64| other(at(x, t).as_ref(), x);
        Graded { at: Arc::new(at), least, most, ..*self }
    }
}
