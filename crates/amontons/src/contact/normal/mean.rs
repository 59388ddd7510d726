//! Mean pressure of a step: the discrete gradient of the energy of a layer.

use super::{GraphKind, NormalLaw, Pressure};
use crate::tensor::Point;
use crate::time::{PressureRule, Rule};

/// The mean pressure of a step of the ϑ-scheme over a law p_ν that is a function of the penetration r and its rate; of
/// one that does not depend on the rate
///
/// p = (2 − 2ϑ) [Ψ(r₁) − Ψ(r₀)]/(r₁ − r₀) + (2ϑ − 1) p_ν(r₁), Ψ′ = p_ν,
///
/// with r₀ at the start and r₁ at the end of the step. At ϑ = ½ its work is the change of the energy Ψ of the layer,
/// whatever the step; for ϑ > ½ a law that does not soften dissipates. At ϑ = 1 it is p_ν(r₁). With
/// [`PressureRule::Plain`] it is p_ν((1 − ϑ) r₀ + ϑ r₁), which gains or loses energy where the gap closes or opens.
///
/// A damped law presses by this times the ratio of the means of p_ν(r, ṙ) and p_ν(r, 0) along the way from r₀ to r₁,
/// with ṙ = (r₁ − r₀)/k: by no tension that the law does not have, and with work beyond that of the energy which is
/// never negative if damping resists. Where the layer bears nothing at rest, the mean of p_ν(r, ṙ) over the step is
/// added.
///
/// Source: O. Gonzalez, Comput. Methods Appl. Mech. Engrg. 190 (2000) 1763.
#[derive(Debug)]
pub struct MeanPressure<'a> {
    law: &'a dyn NormalLaw,
    start: f64,
    length: f64,
    theta: f64,
    rule: PressureRule,
}

/// Change of the penetration over its size below which the mean is a sum over points: the difference of the energies
/// would lose more digits than that.
const NEAR: f64 = 1e-3;
/// Round-off of a difference of energies over their size.
const ROUND_OFF: f64 = 8.0 * f64::EPSILON;
/// Points and weights of the Gauss rule of three points on (0, 1).
const GAUSS: [[f64; 2]; 3] = [
    [0.112_701_665_379_258_31, 0.277_777_777_777_777_8],
    [0.5, 0.444_444_444_444_444_4],
    [0.887_298_334_620_741_7, 0.277_777_777_777_777_8],
];

impl<'a> MeanPressure<'a> {
    /// Over a law, in a step of `length` k in s from the penetration `start` in m.
    #[must_use]
    pub fn new(law: &'a dyn NormalLaw, [start, length]: [f64; 2], theta: f64, rule: PressureRule) -> MeanPressure<'a> {
        MeanPressure { law, start, length, theta, rule }
    }

    /// Over a law, in a step by `rule` from the penetration `start` in m.
    #[must_use]
    pub fn of(law: &'a dyn NormalLaw, start: f64, rule: &Rule) -> MeanPressure<'a> {
        MeanPressure::new(law, [start, rule.k], rule.level, rule.contact.unwrap_or_default().pressure)
    }

    /// The pressure without damping in a step to the penetration `z`, with its slope in z.
    #[must_use]
    pub fn at_rest(&self, x: &Point, z: f64) -> Pressure {
        if self.rule == PressureRule::Plain {
            let at = self.law.pressure(x, self.start + self.theta * (z - self.start), 0.0, 0.0);
            return Pressure { value: at.value, slope: self.theta * at.slope, by_rate: 0.0 };
        }
        let end = self.law.pressure(x, z, 0.0, 0.0);
        let [mean, slope] = self.mean(x, z);
        let [of_mean, of_end] = [2.0 - 2.0 * self.theta, 2.0 * self.theta - 1.0];
        Pressure {
            value: of_mean * mean + of_end * end.value,
            slope: of_mean * slope + of_end * end.slope,
            by_rate: 0.0,
        }
    }

    /// The pressure `at_rest` with damping.
    fn damped(&self, x: &Point, z: f64, at_rest: Pressure) -> Pressure {
        let (moved, [from, to]) = (z - self.start, [self.start, z].map(|r| r.max(0.0)));
        let in_end = if z > 0.0 { 1.0 } else { 0.0 };
        if self.rule == PressureRule::Plain {
            let rate = (to - from) / self.length;
            let at = self.law.pressure(x, self.start + self.theta * moved, rate, 0.0);
            return Pressure { slope: self.theta * at.slope + in_end * at.by_rate / self.length, by_rate: 0.0, ..at };
        }
        // Means over the way within the layer, of the law at the rate of the step and at rest, with their slopes in z.
        let mean = |rate: f64| {
            GAUSS.into_iter().fold([0.0; 2], |[value, slope], [s, weight]| {
                let p = self.law.pressure(x, from + s * (to - from), rate, 0.0);
                let by_rate = if rate.abs() > 0.0 { p.by_rate / self.length } else { 0.0 };
                [value + weight * p.value, slope + weight * (in_end * s * p.slope + by_rate)]
            })
        };
        let ([moving, by_moving], [resting, by_resting]) = (mean(moved / self.length), mean(0.0));
        if resting > 0.0 {
            let factor = moving / resting;
            let slope = at_rest.slope * factor + at_rest.value * (by_moving - factor * by_resting) / resting;
            return Pressure { value: at_rest.value * factor, slope, by_rate: 0.0 };
        }
        // A dashpot alone, and a layer that pulls: over the share of the step in which the point is in the layer.
        let share = if moved.abs() > 0.0 { (to - from) / moved } else { in_end };
        let by_share = if moved.abs() > 0.0 { (in_end - share) / moved } else { 0.0 };
        Pressure {
            value: at_rest.value + share * (moving - resting),
            slope: at_rest.slope + share * (by_moving - by_resting) + by_share * (moving - resting),
            by_rate: 0.0,
        }
    }

    /// Mean of p_ν between both penetrations, and its derivative in the second one.
    fn mean(&self, x: &Point, end: f64) -> [f64; 2] {
        let change = end - self.start;
        let at = |r: f64| self.law.pressure(x, r, 0.0, 0.0);
        let [before, after] = [self.start, end].map(|r| self.law.potential(x, r));
        let of_energy = (after - before) / change;
        if change.abs() <= NEAR * end.abs().max(self.start.abs()) {
            let sum = |[value, slope]: [f64; 2], [s, weight]: [f64; 2]| {
                let p = at(self.start + s * change);
                [value + weight * p.value, slope + weight * s * p.slope]
            };
            let [value, slope] = GAUSS.into_iter().fold([0.0; 2], sum);
            // Both agree to round-off but where the law has a corner in between, at which the sum is not exact.
            let round_off = ROUND_OFF * (before.abs() + after.abs() + value.abs() * end.abs().max(self.start.abs()));
            if (value * change - (after - before)).abs() <= round_off {
                return [value, slope];
            }
        }
        [of_energy, (at(end).value - of_energy) / change]
    }
}

impl NormalLaw for MeanPressure<'_> {
    fn pressure(&self, x: &Point, z: f64, _rate: f64, _lambda: f64) -> Pressure {
        let at_rest = self.at_rest(x, z);
        if self.law.lipschitz_in_rate() == Some(0.0) { at_rest } else { self.damped(x, z, at_rest) }
    }
    /// The energy of the layer, which this pressure raises.
    fn potential(&self, x: &Point, r: f64) -> f64 {
        self.law.potential(x, r)
    }
    fn lipschitz(&self) -> Option<f64> {
        // The rate is the change of the penetration over the length of the step.
        let by_rate = self.law.lipschitz_in_rate()? / self.length;
        self.law.lipschitz().map(|most| self.theta * most + by_rate)
    }
    fn least_slope(&self, x: &Point, from: f64, to: f64) -> f64 {
        self.law.least_slope(x, from.min(self.start), to.max(self.start))
    }
    fn graph(&self) -> GraphKind {
        self.law.graph()
    }
}

#[cfg(test)]
mod tests {
    use super::super::samples;
    use super::*;
    use crate::contact::Compliance;

    const THETAS: [f64; 3] = [0.5, 0.6, 1.0];

    /// Linear compliance, with the gap that closes or opens within the step.
    #[test]
    fn the_mean_over_a_linear_layer_is_known() {
        let (law, c) = (Compliance { stiffness: 3.0 }, 3.0);
        let known = |r0: f64, r1: f64| match (r0 >= 0.0, r1 >= 0.0) {
            (true, true) => c * (r0 + r1) / 2.0,
            (false, false) => 0.0,
            (false, true) => c * r1 * r1 / (2.0 * (r1 - r0)),
            (true, false) => c * r0 * r0 / (2.0 * (r0 - r1)),
        };
        for [r0, r1] in [[0.2, 0.7], [0.7, 0.2], [-0.3, 0.5], [0.5, -0.3], [-0.1, -0.4], [0.4, 0.4], [0.4, 0.400_1]] {
            for theta in THETAS {
                let found = MeanPressure::new(&law, [r0, 1.0], theta, PressureRule::Gradient)
                    .pressure(&[0.0; 3], r1, 0.0, 0.0)
                    .value;
                let end = c * r1.max(0.0);
                let expected = (2.0 - 2.0 * theta) * known(r0, r1) + (2.0 * theta - 1.0) * end;
                assert!((found - expected).abs() < 1e-13, "{r0} to {r1}, ϑ = {theta}: {found} and {expected}");
            }
        }
    }

    /// At ϑ = ½ the work of the mean pressure is the change of the energy, of every law that is a function; the slope
    /// is the derivative.
    #[test]
    fn the_work_is_the_change_of_the_energy() {
        let x = [0.1, 0.2, 0.0];
        for (law, typical) in samples() {
            let is_function = law.graph() == GraphKind::Function && law.lipschitz_in_rate() == Some(0.0);
            if !is_function || law.lipschitz().is_none() {
                continue;
            }
            for [from, to] in [[0.2, 1.3], [1.3, 0.2], [-0.4, 0.9], [0.9, -0.4], [0.5, 0.500_01]] {
                let [r0, r1] = [from, to].map(|r| r * typical);
                let mean = MeanPressure::new(law.as_ref(), [r0, 1.0], 0.5, PressureRule::Gradient);
                let work = mean.pressure(&x, r1, 0.0, 0.0).value * (r1 - r0);
                let stored = law.potential(&x, r1) - law.potential(&x, r0);
                let size = law.potential(&x, r1).abs().max(law.potential(&x, r0).abs());
                assert!((work - stored).abs() <= 1e-9 * size, "{law:?}, {from} to {to}: {work:e} and {stored:e}");
            }
            let (r0, r1, h) = (0.3 * typical, 0.8 * typical, 1e-5 * typical);
            let rules = [PressureRule::Gradient, PressureRule::Plain];
            for (theta, rule) in THETAS.into_iter().flat_map(|theta| rules.map(|rule| (theta, rule))) {
                let mean = MeanPressure::new(law.as_ref(), [r0, 1.0], theta, rule);
                let [below, here, above] = [r1 - h, r1, r1 + h].map(|r| mean.pressure(&x, r, 0.0, 0.0));
                let slope = (above.value - below.value) / (2.0 * h);
                let size = law.lipschitz().unwrap_or(0.0);
                assert!((slope - here.slope).abs() <= 1e-5 * size, "{law:?}: {slope:e} and {:e}", here.slope);
            }
        }
    }

    /// Damping takes energy whatever the step, presses with no tension, and the slope is the derivative.
    #[test]
    fn damping_takes_energy_and_does_not_pull() {
        let (x, mut pressed) = ([0.1, 0.2, 0.0], 0);
        let damped = samples().into_iter().filter(|(law, _)| law.lipschitz_in_rate() != Some(0.0));
        for ((law, typical), theta) in damped.flat_map(|law| THETAS[..2].iter().map(move |theta| (law.clone(), *theta)))
        {
            for [from, to] in [[0.2, 1.3], [1.3, 0.2], [-0.4, 0.9], [0.9, -0.4], [0.5, 0.500_01], [-0.4, -0.2]] {
                let [r0, r1] = [from, to].map(|r| r * typical);
                for length in [1e-6, 1e-3, 1.0] {
                    let mean = MeanPressure::new(law.as_ref(), [r0, length], theta, PressureRule::Gradient);
                    let p = mean.pressure(&x, r1, 0.0, 0.0);
                    let taken = (p.value - mean.at_rest(&x, r1).value) * (r1 - r0);
                    assert!(p.value >= 0.0 && taken >= 0.0, "{law:?}, {from} to {to} in {length}: {p:?} {taken:e}");
                    let h = 1e-6 * typical;
                    let [below, above] = [r1 - h, r1 + h].map(|r| mean.pressure(&x, r, 0.0, 0.0));
                    let (slope, size) = ((above.value - below.value) / (2.0 * h), p.slope.abs().max(above.value / h));
                    assert!((slope - p.slope).abs() <= 1e-4 * size, "{law:?}, {from} to {to}: {slope:e} and {p:?}");
                    pressed += usize::from(p.value > 0.0);
                }
            }
        }
        assert!(pressed > 40, "{pressed}");
    }
}
