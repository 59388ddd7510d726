//! A pressure given by a formula in the penetration.

use super::{NormalLaw, Pressure};
use crate::expression::{ExpressionError, Formula, NamedConstants};
use crate::quadrature::{QuadratureRule, Shape, rule};
use crate::tensor::Point;

/// p = c f(r) for r > r₀, f a nondecreasing formula that vanishes at r₀ ≤ 0; no pressure below. With r₀ < 0 the
/// pressure begins in the gap, which (H8) does not cover.
#[derive(Clone, Debug, PartialEq)]
pub struct PressureFormula {
    /// c ≥ 0.
    factor: f64,
    /// f in Pa.
    pressure: Formula,
    /// r₀ in m.
    begin: f64,
    /// Quadrature rule for the energy.
    gauss: QuadratureRule,
}

/// Reason why a formula is no law for the pressure.
#[derive(Clone, Debug, PartialEq)]
pub enum PressureFormulaFault {
    /// The text is no formula.
    Text(ExpressionError),
    /// It is not 0 at r₀.
    Start(f64),
    /// It begins at a penetration that is above 0 or not finite.
    Begin(f64),
    /// The pressure decreases, or is not finite, beyond a penetration in m.
    Falls(f64),
}

/// Decades of the penetration, measured from r₀, in which a formula is sampled: from 10⁻¹² m to 10 m.
const DECADES: [i32; 2] = [-12, 1];
const PER_DECADE: i32 = 16;
/// Pressure beyond which a formula may overflow.
const ENOUGH: f64 = 1e16;
/// Relative round-off of a formula.
const ROUND_OFF: f64 = 1e-12;
/// Degree of the rule for the energy, its relative error, and the largest number of halvings of an interval.
const DEGREE: usize = 15;
const ACCURACY: f64 = 1e-14;
const HALVINGS: usize = 40;

impl PressureFormula {
    /// Names of the variables.
    pub const VARIABLES: [&'static str; 1] = ["r"];

    /// A formula times a factor, for penetrations above r₀ in m.
    ///
    /// # Errors
    /// Fails if the text is no formula in `r` and the constants, if r₀ is above 0, if the formula does not vanish at
    /// r₀, or if it decreases between 10⁻¹² m and 10 m beyond it.
    pub fn new(
        pressure: &str,
        factor: f64,
        begin: f64,
        constants: &NamedConstants,
    ) -> Result<PressureFormula, PressureFormulaFault> {
        if !(begin <= 0.0 && begin.is_finite()) {
            return Err(PressureFormulaFault::Begin(begin));
        }
        let pressure = Formula::with(pressure, &Self::VARIABLES, constants).map_err(PressureFormulaFault::Text)?;
        let law = PressureFormula { factor: 1.0, pressure, begin, gauss: rule(Shape::Segment, DEGREE) };
        let [first, last] = DECADES.map(|decade| decade * PER_DECADE);
        let penetrations = || (first..=last).map(|i| begin + 10f64.powf(f64::from(i) / f64::from(PER_DECADE)));
        let sizes = penetrations().map(|r| law.at(r).0.abs()).filter(|p| *p <= ENOUGH);
        let start = law.at(begin).0;
        if start.is_nan() || start.abs() > ROUND_OFF * sizes.fold(0.0, f64::max) {
            return Err(PressureFormulaFault::Start(start));
        }
        let mut before = start;
        for r in penetrations() {
            let (p, slope) = law.at(r);
            if !p.is_finite() || slope.is_nan() || p < before - ROUND_OFF * before.abs() {
                return Err(PressureFormulaFault::Falls(r));
            }
            if p > ENOUGH {
                break;
            }
            before = p;
        }
        Ok(PressureFormula { factor, ..law })
    }

    /// c f and its derivative.
    fn at(&self, r: f64) -> (f64, f64) {
        let (value, [slope, ..]) = self.pressure.derivatives([r, 0.0, 0.0, 0.0]);
        (self.factor * value, self.factor * slope)
    }

    /// ∫ c f between two penetrations by Gauss quadrature.
    fn integral(&self, from: f64, to: f64) -> f64 {
        let at = |(x, weight): (&Point, f64)| {
            weight * self.factor * self.pressure.value([from + x[0] * (to - from), 0.0, 0.0, 0.0])
        };
        (to - from) * self.gauss.iter().map(at).sum::<f64>()
    }

    /// This integral with the interval halved until both halves agree with the whole.
    fn halved(&self, [from, to]: [f64; 2], whole: f64, size: f64, left: usize) -> f64 {
        let middle = 0.5 * (from + to);
        let [a, b] = [self.integral(from, middle), self.integral(middle, to)];
        if left == 0 || (a + b - whole).abs() <= ACCURACY * size {
            return a + b;
        }
        self.halved([from, middle], a, size, left - 1) + self.halved([middle, to], b, size, left - 1)
    }
}

impl NormalLaw for PressureFormula {
    fn pressure(&self, _x: &Point, z: f64, _rate: f64, _lambda: f64) -> Pressure {
        if z <= self.begin {
            return Pressure::default();
        }
        let (value, slope) = self.at(z);
        Pressure { value: value.max(0.0), slope: slope.max(0.0), by_rate: 0.0 }
    }
    fn potential(&self, _x: &Point, r: f64) -> f64 {
        if r <= self.begin {
            return 0.0;
        }
        let whole = self.integral(self.begin, r);
        self.halved([self.begin, r], whole, whole.abs().max(f64::MIN_POSITIVE), HALVINGS)
    }
    fn lipschitz(&self) -> Option<f64> {
        // No bound of the slope is known that holds at all penetrations.
        None
    }
}

#[cfg(test)]
pub(super) fn samples() -> Vec<(std::sync::Arc<dyn NormalLaw>, f64)> {
    let all = [
        PressureFormula::new("1e4*r + 2e7*r^2", 1.0, 0.0, &NamedConstants::default()),
        PressureFormula::new("50*tanh(150*r)", 2.0, 0.0, &NamedConstants::default()),
        PressureFormula::new("10*(exp(4000*r) - exp(-4))", 1.0, -1e-3, &NamedConstants::default()),
    ];
    all.into_iter().flatten().map(|law| (std::sync::Arc::new(law) as std::sync::Arc<dyn NormalLaw>, 1e-3)).collect()
}
