//! The contracts of contact laws.

use super::{near, samples, slope_between};
use crate::contact::{Bound, ContactPoint, Flux, FrictionLaw, GraphKind, HeatLaw, NormalLaw, Yield, resolvent};
use crate::tensor::Point;

/// Point at which laws are evaluated.
const X: Point = [0.3, 0.2, 0.1];

/// Checks that the graph satisfies (H8) as far as declared, and has the slopes, potential and Lipschitz constant it
/// declares; `r` is a typical penetration. A function with a Lipschitz constant must vanish without penetration, unless
/// it pulls or begins to push in the gap: then it must vanish at wide gaps. A graph must give the same p for every λ.
///
/// # Panics
/// Panics if the law violates the contract.
pub fn assert_normal_law(law: &dyn NormalLaw, r: f64) {
    let mut random = samples();
    if law.graph() != GraphKind::Function {
        return assert_graph(law, r);
    }
    let p = |r: f64, rate: f64| law.pressure(&X, r, rate, 0.0);
    let [pulls, pushes] = [p(-1e-3 * r, 0.0).value < 0.0, p(-1e-3 * r, 0.0).value > 0.0];
    let closing = if pushes { -1e3 * r } else { 0.0 };
    near(p(closing, 0.0).value, 0.0, 0.0, &format!("{law:?}: pressure at zero penetration"));
    near(law.potential(&X, closing), 0.0, 0.0, &format!("{law:?}: energy at zero penetration"));
    let size = (0..=16).map(|i| p(f64::from(i - 8) / 4.0 * r, 0.0).value.abs()).fold(0.0, f64::max);
    for _ in 0..256 {
        let (a, b) = (2.0 * r * random.number(), 2.0 * r * random.number());
        let ga = p(a, 0.0);
        if a <= closing && !pulls {
            near(ga.value, 0.0, 0.0, &format!("{law:?}: pressure over an open gap"));
            near(law.potential(&X, a), 0.0, 0.0, &format!("{law:?}: energy over an open gap"));
        }
        assert!(ga.value >= 0.0 || pulls, "{law:?}: negative pressure at {a:e}");
        let h = 1e-6 * r;
        slope_between(ga.slope, |h| p(a + h, 0.0).value, h, 1e-4 * size / r, &format!("{law:?}: pressure at {a:e}"));
        let energy = |h: f64| law.potential(&X, a + h);
        near(
            (energy(h) - energy(-h)) / (2.0 * h),
            ga.value,
            1e-5 * size,
            &format!("{law:?}: derivative of the potential at {a:e}"),
        );
        if let Some(l) = law.lipschitz() {
            let slack = 1e-12 * l * r;
            assert!(
                (ga.value - p(b, 0.0).value).abs() <= l * (a - b).abs() + slack,
                "{law:?}: declared L = {l:e} fails between {a:e} and {b:e}"
            );
        }
        // Between two penetrations it decreases by no more than declared.
        let (low, high) = (a.min(b), a.max(b));
        let (least, mean) = (law.least_slope(&X, low, high), (p(high, 0.0).value - p(low, 0.0).value) / (high - low));
        assert!(
            mean >= least - 1e-9 * (least.abs() + size / r),
            "{law:?}: least slope {least:e} between {low:e} and {high:e}, but the mean is {mean:e}"
        );
        // Wear makes it softer: p = G(r − λ p₊), with the slope it returns.
        let by_wear = r / size * 10f64.powf(3.0 * random.number());
        let rubbed = |h: f64| resolvent(law, &X, a + h, 0.0, &Yield { by_wear, ..Yield::default() });
        let value = rubbed(0.0).value;
        near(
            value,
            p(a - by_wear * value.max(0.0), 0.0).value,
            1e-12 * size,
            &format!("{law:?}: worn by {by_wear:e} p at {a:e}"),
        );
        if least >= 0.0 && law.least_slope(&X, f64::NEG_INFINITY, f64::INFINITY) >= 0.0 {
            slope_between(
                rubbed(0.0).slope,
                |h| rubbed(h).value,
                h,
                1e-4 * size / r,
                &format!("{law:?}: worn, at {a:e}"),
            );
        }
        assert_rate(law, a, [2.0 * random.number(), 2.0 * random.number()], [r, size]);
    }
}

/// Checks at a penetration and two rates that the pressure does not decrease with the rate and has the slopes it
/// returns; `size` is the pressure of the law at r.
fn assert_rate(law: &dyn NormalLaw, a: f64, [rate, other]: [f64; 2], [r, size]: [f64; 2]) {
    let p = |r: f64, rate: f64| law.pressure(&X, r, rate, 0.0);
    let (moving, h) = (p(a, rate), 1e-6 * r);
    assert!((moving.value - p(a, other).value) * (rate - other) >= 0.0, "{law:?}: not monotone in the rate at {a:e}");
    if let Some(l) = law.lipschitz_in_rate() {
        assert!(
            (moving.value - p(a, other).value).abs() <= l * (rate - other).abs() + 1e-12 * size,
            "{law:?}: declared constant {l:e} of the rate fails between {rate:e} and {other:e} at {a:e}"
        );
    }
    if a > 0.0 && law.least_slope(&X, f64::NEG_INFINITY, f64::INFINITY) >= 0.0 {
        // In series with a layer: p = G(r − λ p, ṙ − λ p/γ), with the slopes it returns.
        let (lambda, gamma) = (r / size, 0.1);
        let by = Yield { lambda, lambda_rate: lambda / gamma, ..Yield::default() };
        let series = |h: f64, v: f64| resolvent(law, &X, a + h, rate + v, &by);
        let found = series(0.0, 0.0);
        let left = a - lambda * found.value;
        let made = if left > 0.0 { p(left, rate - by.lambda_rate * found.value).value } else { p(left, 0.0).value };
        near(found.value, made, 1e-12 * size.max(moving.value), &format!("{law:?}: in series at {a:e}, {rate:e}"));
        let text = format!("{law:?}: in series at {a:e}, {rate:e}");
        slope_between(found.slope, |h| series(h, 0.0).value, h, 1e-4 * size / r, &text);
        slope_between(found.by_rate, |v| series(0.0, v).value, 1e-6, 1e-4 * size, &text);
    }
    slope_between(
        moving.by_rate,
        |h| p(a, rate + h).value,
        1e-6,
        1e-4 * size,
        &format!("{law:?}: pressure in the rate at {a:e}, {rate:e}"),
    );
    slope_between(
        moving.slope,
        |h| p(a + h, rate).value,
        h,
        1e-4 * (size + moving.value.abs()) / r,
        &format!("{law:?}: pressure at {a:e}, {rate:e}"),
    );
}

/// Checks that p ∈ G(z − λ p) is nondecreasing in z, has the slope it returns, and gives the same point of G for every
/// λ.
fn assert_graph(law: &dyn NormalLaw, r: f64) {
    let mut random = samples();
    assert!(law.lipschitz().is_none(), "{law:?}: a multivalued graph has no Lipschitz constant");
    for _ in 0..256 {
        let lambda = r * 10f64.powf(6.0 * random.number());
        let (a, b) = (2.0 * r * random.number(), 2.0 * r * random.number());
        let (pa, pb) = (law.pressure(&X, a, 0.0, lambda), law.pressure(&X, b, 0.0, lambda));
        assert!((pa.value - pb.value) * (a - b) >= 0.0, "{law:?}: not monotone between {a:e} and {b:e}");
        assert!(pa.value >= 0.0 || law.graph() == GraphKind::Bilateral, "{law:?}: tension at {a:e}");
        let h = 1e-6 * r;
        slope_between(
            pa.slope,
            |h| law.pressure(&X, a + h, 0.0, lambda).value,
            h,
            1e-6 * pa.value.abs() / r + 1e-9 * pa.slope,
            &format!("{law:?}: at {a:e}"),
        );
        assert!(lambda * pa.slope <= 1.0 + 1e-12, "{law:?}: the slope at {a:e} is that of no monotone graph");
        let (at, other) = (a - lambda * pa.value, lambda * 10f64.powf(random.number()));
        let again = law.pressure(&X, at + other * pa.value, 0.0, other).value;
        near(
            again,
            pa.value,
            1e-9 * (pa.value.abs() + r / other),
            &format!("{law:?}: the point (r, p) = ({at:e}, {:e}) with another λ", pa.value),
        );
    }
}

/// Checks that the bound is not negative, and has the slopes and Lipschitz constant it declares; with such a constant
/// it must vanish with the pressure, as (H8) requires. `p` is a typical pressure.
///
/// # Panics
/// Panics if the law violates the contract.
pub fn assert_friction_law(law: &dyn FrictionLaw, p: f64) {
    let mut random = samples();
    let l_nu = 1e4;
    for _ in 0..256 {
        let pressure = p * (1.0 + random.number());
        let at = ContactPoint {
            pressure,
            penetration: pressure / l_nu,
            slip_speed: random.number().abs(),
            temperature: 3.0 * random.number(),
            ..ContactPoint::default()
        };
        let bound = law.bound(&at);
        assert!(bound.value >= 0.0, "{law:?}: negative bound {:e} at {at:?}", bound.value);
        let at_rest = law.bound(&ContactPoint { slip_speed: 0.0, ..at }).value;
        let creeping = law.bound(&ContactPoint { slip_speed: 1e-12, ..at }).value;
        assert!(
            at_rest >= creeping * (1.0 - 1e-9),
            "{law:?}: the bound rises from {at_rest:e} to {creeping:e} when slip starts"
        );
        assert!(
            law.drops_from_rest() || at_rest <= creeping * (1.0 + 1e-9) + 1e-300,
            "{law:?}: the bound drops from {at_rest:e} to {creeping:e}, unsaid"
        );
        if law.is_frictionless() {
            near(bound.value, 0.0, 0.0, &format!("{law:?}: bound of a law without friction"));
        }
        assert_bound_slopes(law, &at, bound, [p, l_nu]);
        let at = &at;
        let faster = ContactPoint { slip_speed: at.slip_speed + random.number().abs(), ..*at };
        let (least, rise) =
            (law.least_slope(at, at.slip_speed, faster.slip_speed), law.bound(&faster).value - bound.value);
        let slack = 1e-12 * (bound.value + p);
        assert!(
            rise >= least * (faster.slip_speed - at.slip_speed) - slack,
            "{law:?}: least slope {least:e} in the slip speed, but from {at:?} to {faster:?} it changes by {rise:e}"
        );
        if let Some(l) = law.lipschitz(Some(l_nu)) {
            let total = bound.by_penetration + bound.by_pressure * l_nu;
            assert!(total.abs() <= l * (1.0 + 1e-12), "{law:?}: declared L_τ = {l:e}, but the slope is {total:e}");
        }
    }
    if law.lipschitz(Some(l_nu)).is_some() {
        let none = law.bound(&ContactPoint::default());
        near(none.value, 0.0, 0.0, &format!("{law:?}: bound without pressure"));
    }
}

/// Checks the slopes of the bound, for pressures of size p and layers of stiffness L_ν.
fn assert_bound_slopes(law: &dyn FrictionLaw, at: &ContactPoint, bound: Bound, [p, l_nu]: [f64; 2]) {
    let s = |change: fn(&mut ContactPoint, f64)| {
        move |h: f64| {
            let mut at = *at;
            change(&mut at, h);
            law.bound(&at).value
        }
    };
    slope_between(bound.by_pressure, s(|at, h| at.pressure += h), 1e-6 * p, 1e-5, &format!("{law:?}: in pressure"));
    slope_between(
        bound.by_penetration,
        s(|at, h| at.penetration += h),
        1e-6 * p / l_nu,
        1e-5 * l_nu,
        &format!("{law:?}: in penetration"),
    );
    slope_between(
        bound.by_slip_speed,
        s(|at, h| at.slip_speed += h),
        1e-6,
        1e-4 * p,
        &format!("{law:?}: in slip speed"),
    );
    slope_between(
        bound.by_temperature,
        s(|at, h| at.temperature += h),
        1e-6,
        1e-4 * p,
        &format!("{law:?}: in temperature"),
    );
}

/// Checks (H7) as far as declared: a flux from warm to cold, nondecreasing in θ, with the slopes, bound and Lipschitz
/// constant it declares; without a temperature difference only frictional heat may flow. `r` is a typical penetration.
///
/// # Panics
/// Panics if the law violates the contract.
pub fn assert_heat_law(law: &dyn HeatLaw, r: f64) {
    let mut random = samples();
    for _ in 0..256 {
        let at = ContactPoint {
            penetration: 2.0 * r * random.number(),
            pressure: 3.0 * (1.0 + random.number()),
            slip_speed: random.number().abs(),
            temperature: 4.0 * random.number(),
            foundation_temperature: random.number(),
            ..ContactPoint::default()
        };
        let flux = law.flux(&at);
        let difference = at.temperature - at.foundation_temperature;
        let rounding = 1e-12 * flux.value.abs();
        assert!(flux.value * difference >= 0.0, "{law:?}: heat flows from cold to warm at {at:?}");
        let allowed = law.conductance_bound() * difference.abs() * (1.0 + 1e-12);
        assert!(
            law.conductance_bound().is_infinite() || flux.value.abs() <= allowed,
            "{law:?}: declared M_kc is exceeded at {at:?}"
        );
        let at = &at;
        assert_flux_slopes(law, at, flux, r);
        let heated = |power: f64| law.flux(&ContactPoint { friction_power: power, ..*at });
        near(
            heated(0.7).value - flux.value,
            0.7 * flux.by_friction_power,
            1e-12 + rounding,
            &format!("{law:?}: friction heat"),
        );
        assert!(
            (-1.0..=0.0).contains(&flux.by_friction_power),
            "{law:?}: more than the power of friction enters the body"
        );
        let level = law.flux(&ContactPoint { temperature: at.foundation_temperature, ..*at });
        near(level.value, 0.0, 0.0, &format!("{law:?}: flux without a temperature difference"));
        if let (Some(l), None) = (law.conductance_lipschitz(), law.truncation()) {
            let other = ContactPoint { penetration: 2.0 * r * random.number(), ..*at };
            let change = (law.flux(&other).value - flux.value).abs();
            let allowed = l * (other.penetration - at.penetration).abs() * difference.abs();
            assert!(
                change <= allowed * (1.0 + 1e-9) + rounding,
                "{law:?}: declared L_kc = {l:e} is exceeded at {at:?}"
            );
        }
    }
}

/// Checks that the flux grows with θ and decreases with θ_F, and has the slopes it returns.
fn assert_flux_slopes(law: &dyn HeatLaw, at: &ContactPoint, flux: Flux, r: f64) {
    let q = |change: fn(&mut ContactPoint, f64)| {
        move |h: f64| {
            let mut at = *at;
            change(&mut at, h);
            law.flux(&at).value
        }
    };
    assert!(flux.by_temperature >= 0.0, "{law:?}: flux decreases with the temperature at {at:?}");
    // The curvature of a law, times the step of the difference.
    let scale = 1e-4 * (flux.value.abs() + flux.by_temperature);
    slope_between(
        flux.by_temperature,
        q(|at, h| at.temperature += h),
        1e-6,
        scale,
        &format!("{law:?}: in temperature"),
    );
    assert!(flux.by_foundation <= 0.0, "{law:?}: flux increases with the temperature of the foundation at {at:?}");
    slope_between(
        flux.by_foundation,
        q(|at, h| at.foundation_temperature += h),
        1e-6,
        scale,
        &format!("{law:?}: in the foundation's temperature"),
    );
    slope_between(
        flux.by_penetration,
        q(|at, h| at.penetration += h),
        1e-6 * r,
        scale / r,
        &format!("{law:?}: in penetration"),
    );
    slope_between(flux.by_pressure, q(|at, h| at.pressure += h), 1e-6, scale, &format!("{law:?}: in pressure"));
    slope_between(flux.by_slip_speed, q(|at, h| at.slip_speed += h), 1e-6, scale, &format!("{law:?}: in slip speed"));
}
