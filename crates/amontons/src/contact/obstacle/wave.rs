//! A wavy surface.

use std::f64::consts::{PI, TAU};

use super::{
    Checks, Nearest, ObstacleShape, POINT, Point3, ShapeFault, ShapeFaults, across, at, keyed, minus, plus, unit,
};
use crate::field::Field;
use crate::tensor::{Point, dot};

/// The matter below the surface n·(x − p) = a cos(2π d·(x − p)/λ), d ⟂ n, which moves with p.
#[derive(Clone, Debug)]
pub struct Wave {
    point: Point3,
    normal: Point,
    direction: Point,
    amplitude: f64,
    /// 2π/λ in 1/m.
    frequency: f64,
}

impl Wave {
    /// The wave about the plane through `point` with the normal `normal`, with `amplitude` and `wavelength` in m along
    /// the part of `direction` in that plane; a crest is at `point` if the amplitude is positive. The lengths of the
    /// two vectors do not matter.
    ///
    /// # Errors
    /// Fails if the wavelength is not positive, the amplitude not finite, the normal zero, the direction zero or along
    /// the normal, or the point depends on space.
    pub fn new(
        point: Point3,
        normal: Point,
        direction: Point,
        amplitude: f64,
        wavelength: f64,
    ) -> Result<Wave, ShapeFaults> {
        let mut checks = Checks::default();
        let point = checks.moving(POINT, point);
        if !amplitude.is_finite() {
            checks.0.push(ShapeFault::NotFinite { key: "amplitude", value: amplitude });
        }
        let frequency = TAU / checks.positive("wavelength", wavelength);
        let (normal, along) = (checks.unit("normal", normal), checks.unit("direction", direction));
        let part = across(&along, &normal);
        // The remainder of a direction along the normal is round-off.
        let crosses = part.iter().any(|c| c.abs() > 1e-12);
        if !crosses && checks.0.is_empty() {
            checks.0.push(ShapeFault::AlongNormal { direction });
        }
        let direction = unit(&part).unwrap_or(along);
        checks.result(Wave { point, normal, direction, amplitude, frequency })
    }
}

/// A point relative to half a period of the wave, lengths in units of λ/2π: the wave is at α cos w, 0 ≤ w ≤ π.
///
/// The mirrors w = 0 and w = π map the wave to itself, so the nearest point of a point between them is also between
/// them.
struct HalfPeriod {
    /// α.
    amplitude: f64,
    /// Coordinate along the wave, in [0, π].
    v: f64,
    /// Coordinate along the normal.
    height: f64,
}

impl HalfPeriod {
    /// Half the squared distance to the wave at w.
    fn energy(&self, w: f64) -> f64 {
        let (s, h) = (w - self.v, self.amplitude * w.cos() - self.height);
        0.5 * (s * s + h * h)
    }

    /// Its derivative by w; at the mirrors sin w is set to exactly 0.
    fn slope(&self, w: f64) -> f64 {
        let sin = if w <= 0.0 || w >= PI { 0.0 } else { w.sin() };
        (w - self.v) - (self.amplitude * w.cos() - self.height) * self.amplitude * sin
    }

    /// The second derivative.
    fn curvature(&self, w: f64) -> f64 {
        let c = w.cos();
        1.0 + self.amplitude * (self.amplitude * (1.0 - 2.0 * c * c) + self.height * c)
    }

    /// The w at which the second derivative changes its sign: roots of a quadratic equation for cos w, so that the
    /// slope is monotone on at most three parts.
    fn inflections(&self) -> impl Iterator<Item = f64> {
        let (a, b, c) = (
            2.0 * self.amplitude * self.amplitude,
            -self.amplitude * self.height,
            -1.0 - self.amplitude * self.amplitude,
        );
        let q = -0.5 * (b + (b * b - 4.0 * a * c).sqrt().copysign(b));
        let mut roots = [q / a, c / q].map(f64::acos);
        roots.sort_by(f64::total_cmp);
        roots.into_iter().filter(|w| *w > 0.0 && *w < PI)
    }

    /// The w of the nearest point; the first of several.
    fn nearest(&self) -> Option<f64> {
        let mut start = 0.0;
        let mut nearest: Option<(f64, f64)> = None;
        for end in self.inflections().chain([PI]) {
            if self.slope(start) <= 0.0 && self.slope(end) >= 0.0 {
                let w = self.minimum(start, end);
                let energy = self.energy(w);
                if nearest.is_none_or(|(_, least)| energy < least) {
                    nearest = Some((w, energy));
                }
            }
            start = end;
        }
        nearest.map(|(w, _)| w)
    }

    /// The zero of the slope between `low`, where it is not positive, and `high`, where it is not negative: Newton's
    /// method, with bisection if that leaves the bracket or is slow.
    fn minimum(&self, mut low: f64, mut high: f64) -> f64 {
        let mut w = self.v.clamp(low, high);
        let mut last = high - low;
        for _ in 0..200 {
            let slope = self.slope(w);
            if slope == 0.0 {
                return w;
            }
            if slope < 0.0 {
                low = w;
            } else {
                high = w;
            }
            let newton = w - slope / self.curvature(w);
            let next = if newton > low && newton < high && (newton - w).abs() <= 0.5 * last {
                newton
            } else {
                low + 0.5 * (high - low)
            };
            last = (next - w).abs();
            if last <= f64::EPSILON * w || next <= low || next >= high {
                return next;
            }
            w = next;
        }
        w
    }
}

impl ObstacleShape for Wave {
    fn nearest(&self, x: &Point, t: f64) -> Nearest {
        let from = minus(x, &self.place(t));
        let phase = self.frequency * dot(&from, &self.direction);
        let half_periods = (phase / PI).floor();
        let v = (phase - half_periods * PI).clamp(0.0, PI);
        let turned = if half_periods.rem_euclid(2.0) == 0.0 { self.amplitude } else { -self.amplitude };
        let half =
            HalfPeriod { amplitude: self.frequency * turned, v, height: self.frequency * dot(&from, &self.normal) };
        let Some(w) = half.nearest() else { return Nearest::NONE };
        let incline = half.amplitude * w.sin();
        let Some([along, up, _]) = unit(&[incline, 1.0, 0.0]) else { return Nearest::NONE };
        let distance = (half.v - w) * along + (half.height - half.amplitude * w.cos()) * up;
        let normal = plus(&self.normal.map(|c| up * c), along, &self.direction);
        Nearest { distance: distance / self.frequency, normal }
    }
    fn place(&self, t: f64) -> Point {
        at(&self.point, t)
    }
    fn fields(&self) -> Vec<(&'static str, &Field)> {
        keyed(POINT, &self.point)
    }
}
