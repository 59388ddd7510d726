//! Laws that may vary: a function gives the law at every point, time and temperature.

use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

use super::coefficient::held;
use super::reference;
use crate::arrays::Arrays;
use crate::tensor::Point;

/// A law of the body or of a side, with what it depends on besides its arguments: place, time, temperature, functions
/// on arrays.
///
/// `T` is the trait of the law: `dyn TensorLaw`, `dyn NormalLaw`, `dyn FrictionLaw`, `dyn HeatLaw` or `dyn WearLaw`.
/// The methods of the trait evaluate the law at the point that they get, at the time of [`Law::at_time`]. Each law of
/// constant coefficients converts into it, and [`Law::in_space`] and [`Law::varying`] take functions:
///
/// ```
/// use std::sync::Arc;
/// use amontons::field::Law;
/// use amontons::material::{Isotropic, StressState::PlaneStrain, TensorLaw};
///
/// let points = [[0.0; 3], [1.0, 0.0, 0.0]];
/// let law = Law::<dyn TensorLaw>::in_space(&points, |x| Arc::new(Isotropic::lame(3, 0.0, 1.0 + x[0], PlaneStrain)));
/// assert_eq!((law.constants().monotonicity, law.constants().lipschitz), (1.0, 2.0));
/// ```
pub struct Law<T: ?Sized> {
    /// The law, which evaluates at any point.
    whole: Arc<T>,
    graded: Option<Arc<Graded<T>>>,
    /// The law at a time; `None` if it does not change with time.
    at_time: Option<Arc<AtTime<T>>>,
    arrays: Vec<Arrays>,
}

type AtTime<T> = dyn Fn(f64) -> Law<T> + Send + Sync;

/// The trait of a kind of laws, as far as laws that vary depend on it.
pub trait LawKind: Send + Sync + 'static {
    /// Two numbers, of which the first is least and the second largest where the constants of a varying law are
    /// attained, and true if the law is nonlinear (elasticity) or its bound drops when slip starts (friction).
    fn rank(&self) -> ([f64; 2], bool);
    /// The law that evaluates, at each point, the one that holds there.
    fn by_points(graded: Arc<Graded<Self>>) -> Arc<Self>;
}

/// Makes a trait of laws a [`LawKind`] with its rank, and its laws convert into [`Law`].
macro_rules! law_kind {
    ($kind:ident, $rank:expr) => {
        impl $crate::field::LawKind for dyn $kind {
            fn rank(&self) -> ([f64; 2], bool) {
                let rank: fn(&dyn $kind) -> ([f64; 2], bool) = $rank;
                rank(self)
            }
            fn by_points(graded: std::sync::Arc<$crate::field::Graded<Self>>) -> std::sync::Arc<Self> {
                graded
            }
        }

        impl<L: $kind + 'static> From<L> for $crate::field::Law<dyn $kind> {
            fn from(law: L) -> Self {
                let law: std::sync::Arc<dyn $kind> = std::sync::Arc::new(law);
                law.into()
            }
        }
    };
}
pub(crate) use law_kind;

impl<T: ?Sized> Law<T> {
    /// A law that is the same everywhere and calls these functions on arrays.
    pub(crate) fn on_arrays(law: Arc<T>, arrays: Vec<Arrays>) -> Law<T> {
        Law { whole: law, graded: None, at_time: None, arrays }
    }

    /// The law with its dependence on time.
    pub(crate) fn changing(self, at_time: impl Fn(f64) -> Law<T> + Send + Sync + 'static) -> Law<T> {
        Law { at_time: Some(Arc::new(at_time)), ..self }
    }

    /// The law at all points and its time.
    pub(crate) fn shared(&self) -> Arc<T> {
        Arc::clone(&self.whole)
    }

    /// The laws at the points, if its coefficients vary in space, in time or with the temperature.
    #[must_use]
    pub fn graded(&self) -> Option<&Graded<T>> {
        self.graded.as_deref()
    }

    /// The law at a point and its time; if it depends on the temperature, at its temperature nearest to 0.
    #[must_use]
    pub fn at(&self, x: &Point) -> Arc<T> {
        self.graded().map_or_else(|| self.shared(), |graded| graded.at(x))
    }

    /// The law at a time in s; `None` if it does not change with time.
    #[must_use]
    pub fn at_time(&self, t: f64) -> Option<Law<T>> {
        self.at_time.as_ref().map(|at_time| at_time(t))
    }

    /// The law at a point and a temperature in K; `None` if it is independent of the temperature.
    #[must_use]
    pub fn at_temperature(&self, x: &Point, theta: f64) -> Option<Arc<T>> {
        let graded = self.graded().filter(|graded| !graded.temperatures().is_empty())?;
        Some(graded.at_temperature(x, theta))
    }

    /// The temperatures between which the law is known, K; empty if it is independent of the temperature.
    #[must_use]
    pub fn temperatures(&self) -> &[f64] {
        self.graded().map_or(&[], Graded::temperatures)
    }

    /// The array functions of the law; they are evaluated for many points at once.
    #[must_use]
    pub fn arrays(&self) -> &[Arrays] {
        &self.arrays
    }
}

impl<T: LawKind + ?Sized> Law<T> {
    /// The law that `at` gives per point; its constants are the extremes over the points.
    #[must_use]
    pub fn in_space(points: &[Point], at: impl Fn(&Point) -> Arc<T> + Send + Sync + 'static) -> Law<T> {
        Law::varying(points, &[0.0], &[], move |x, _, _| at(x))
    }

    /// The law that `at` gives per point, time and temperature; its constants are the extremes over these.
    ///
    /// With fewer than two times in s the law does not change with time. It holds from the first to the last of the
    /// ascending temperatures in K; without temperatures it is independent of them. Only elasticity and viscosity may
    /// depend on the temperature. Without points, the law at the origin is used.
    #[must_use]
    pub fn varying(
        points: &[Point],
        times: &[f64],
        temperatures: &[f64],
        at: impl Fn(&Point, f64, f64) -> Arc<T> + Send + Sync + 'static,
    ) -> Law<T> {
        Law::of_graded(Graded::over(points, times, temperatures, at))
    }

    fn of_graded(graded: Graded<T>) -> Law<T> {
        let graded = Arc::new(graded);
        let whole = T::by_points(Arc::clone(&graded));
        let fixed = Law { whole, graded: Some(Arc::clone(&graded)), at_time: None, arrays: Vec::new() };
        if graded.changes { fixed.changing(move |t| Law::of_graded(Graded { t, ..(*graded).clone() })) } else { fixed }
    }

    /// The law derived from this one at each point by `other`, which must keep the order of constants.
    #[must_use]
    pub(crate) fn map(&self, other: impl Fn(&T, &Point) -> Arc<T> + Send + Sync + 'static) -> Law<T> {
        match self.graded() {
            Some(graded) => Law::of_graded(graded.map(other)),
            None => other(self, &[0.0; 3]).into(),
        }
    }
}

impl<T: ?Sized> From<Arc<T>> for Law<T> {
    fn from(law: Arc<T>) -> Law<T> {
        Law::on_arrays(law, Vec::new())
    }
}

impl<T: ?Sized> Deref for Law<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.whole
    }
}

impl<T: ?Sized> AsRef<T> for Law<T> {
    fn as_ref(&self) -> &T {
        self
    }
}

impl<T: ?Sized> Clone for Law<T> {
    fn clone(&self) -> Law<T> {
        Law {
            whole: Arc::clone(&self.whole),
            graded: self.graded.clone(),
            at_time: self.at_time.clone(),
            arrays: self.arrays.clone(),
        }
    }
}

impl<T: fmt::Debug + ?Sized> fmt::Debug for Law<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.whole.fmt(f)
    }
}

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

/// The laws at the points of a [`Law`] that varies: a function gives the law of constant coefficients at every point.
///
/// The constants of (H1)–(H8) are the extremes over the given points, which should be those at which the law is
/// evaluated: the nodes and the quadrature points.
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

impl<T: LawKind + ?Sized> Graded<T> {
    /// The laws that `at` gives, with the extremes over points, times and temperatures.
    fn over(
        points: &[Point],
        times: &[f64],
        temperatures: &[f64],
        at: impl Fn(&Point, f64, f64) -> Arc<T> + Send + Sync + 'static,
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
        let ([mut low, mut high], mut special) = least.law.rank();
        let levels = if temperatures.is_empty() { &[0.0] } else { temperatures };
        let when = times.iter().flat_map(|&t| levels.iter().map(move |&theta| (t, theta)));
        for ((t, theta), x) in when.flat_map(|when| points.iter().map(move |x| (when, x))) {
            let here = instance(x, t, theta);
            let ([lower, upper], is_special) = here.law.rank();
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
}

impl<T: ?Sized> Graded<T> {
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
    fn map(&self, other: impl Fn(&T, &Point) -> Arc<T> + Send + Sync + 'static) -> Graded<T> {
        let [least, most] = self.extremes().map(|i| LawInstance { law: other(i.law.as_ref(), &i.x), ..i.clone() });
        let at = Arc::clone(&self.at);
        let at = move |x: &Point, t: f64, theta: f64| other(at(x, t, theta).as_ref(), x);
        Graded { at: Arc::new(at), temperatures: Arc::clone(&self.temperatures), least, most, ..*self }
    }
}
