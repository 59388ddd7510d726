//! Properties of contact laws found by samples: the arguments that they depend on, and their action over an open gap.

use super::laws::Test;
use super::sample::Samples;
use crate::contact::{ContactPoint, GraphKind};
use crate::tensor::Point;

/// Number of random arguments per contact point.
const SAMPLES: usize = 128;

/// Powers of ten of pressures, slip speeds and temperatures, in the units of the case.
const DECADES: std::ops::RangeInclusive<i32> = -20..=20;

/// Temperatures of both signs over many decades, K.
fn temperatures() -> impl Iterator<Item = f64> {
    (-40..=60).flat_map(|tenth| [-1.0, 1.0].map(|sign| sign * 10f64.powf(0.1 * f64::from(tenth))))
}

fn differ(a: f64, b: f64) -> bool {
    a.to_bits() != b.to_bits()
}

impl Test<'_> {
    fn random(&self, mut holds: impl FnMut(&Point, &mut Samples) -> bool) -> bool {
        let mut random = Samples::default();
        self.places.iter().any(|x| (0..SAMPLES).any(|_| holds(x, &mut random)))
    }

    /// Contact points over all decades of the pressure, at rest.
    fn pressed(&self) -> impl Iterator<Item = ContactPoint> {
        let at =
            |x: &Point, decade: i32| ContactPoint { x: *x, pressure: 10f64.powi(decade), ..ContactPoint::default() };
        self.places.iter().flat_map(move |x| DECADES.map(move |decade| at(x, decade)))
    }

    /// True if the pressure depends on the rate of the penetration.
    pub(super) fn rate_matters(&self) -> bool {
        self.sampled(|| {
            let law = &self.contact.normal;
            law.graph() == GraphKind::Function
                && self.random(|x, random| {
                    let (r, rate) = (random.spread(self.length, 12.0).abs(), random.spread(self.length, 12.0).abs());
                    differ(law.pressure(x, r, rate, 0.0).value, law.pressure(x, r, 0.0, 0.0).value)
                })
        })
    }

    /// True if the friction bound depends on the slip speed.
    pub(super) fn friction_sees_slip(&self) -> bool {
        self.sampled(|| {
            let law = &self.contact.friction;
            self.pressed().any(|at| {
                DECADES.step_by(2).any(|speed| {
                    differ(law.bound(&at).value, law.bound(&ContactPoint { slip_speed: 10f64.powi(speed), ..at }).value)
                })
            })
        })
    }

    /// True if the friction bound depends on the temperature.
    pub(super) fn friction_sees_heat(&self) -> bool {
        self.sampled(|| {
            let law = &self.contact.friction;
            self.pressed().any(|at| {
                let rest = law.bound(&at).value;
                temperatures().any(|temperature| {
                    let bound = law.bound(&ContactPoint { temperature, ..at });
                    bound.by_temperature != 0.0 || differ(bound.value, rest)
                })
            })
        })
    }

    /// True if the friction bound depends on the position alone, as Tresca's does.
    pub(super) fn friction_is_given(&self) -> bool {
        self.sampled(|| {
            let law = &self.contact.friction;
            let given = |at: &ContactPoint| law.bound(&ContactPoint { x: at.x, ..ContactPoint::default() }).value;
            let penetrations = [0.0, -self.length, 1e-6 * self.length, self.length];
            let varies = |at: ContactPoint| {
                penetrations
                    .into_iter()
                    .any(|penetration| differ(law.bound(&ContactPoint { penetration, ..at }).value, given(&at)))
            };
            !self.pressed().any(varies) && !self.friction_sees_slip() && !self.friction_sees_heat()
        })
    }

    /// True if friction generates heat: the flux depends on its power or on the slip speed.
    pub(super) fn friction_makes_heat(&self) -> bool {
        self.sampled(|| {
            let law = &self.contact.heat;
            self.pressed().any(|at| {
                let slipping = ContactPoint { slip_speed: 1.0, friction_power: at.pressure, ..at };
                differ(law.flux(&slipping).value, law.flux(&at).value) || law.flux(&at).by_friction_power != 0.0
            })
        })
    }

    /// True if the flux depends on the pressure.
    pub(super) fn heat_sees_pressure(&self) -> bool {
        self.sampled(|| {
            let law = &self.contact.heat;
            let warm = |at: ContactPoint| ContactPoint { temperature: 1.0, ..at };
            self.pressed().any(|at| {
                law.flux(&warm(at)).by_pressure != 0.0
                    || differ(
                        law.flux(&warm(at)).value,
                        law.flux(&warm(ContactPoint { x: at.x, ..ContactPoint::default() })).value,
                    )
            })
        })
    }

    /// True if the flux is no product k_c φ_L(θ − θ_F) as in (2.10): its slope at θ = θ_F depends on θ, as for
    /// radiation.
    pub(super) fn heat_sees_level(&self) -> bool {
        self.sampled(|| {
            let law = &self.contact.heat;
            let slope = |x: &Point, r: f64, theta: f64| {
                law.flux(&ContactPoint {
                    x: *x,
                    penetration: r,
                    pressure: 1.0,
                    temperature: theta,
                    foundation_temperature: theta,
                    ..ContactPoint::default()
                })
                .by_temperature
            };
            let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * a.abs().max(b.abs());
            self.places.iter().any(|x| {
                [-self.length, self.length]
                    .into_iter()
                    .any(|r| temperatures().any(|theta| !near(slope(x, r, theta), slope(x, r, 0.0))))
            })
        })
    }

    /// The action of a law over an open gap and the law's key in the contact; `None` if no law acts there.
    pub(super) fn acts_open(&self) -> Option<(&'static str, &'static str)> {
        self.sampled(|| {
            let contact = self.contact;
            if contact.normal.graph() == GraphKind::Bilateral {
                return Some(("bilateral contact is closed from the start", "normal"));
            }
            // Openings over all decades, and rates of either sign.
            let openings = || (-1000..=40).step_by(5).map(|power| -self.length * 2f64.powi(power));
            let lambda = if contact.normal.graph() == GraphKind::Function { 0.0 } else { 1.0 };
            let pulls = |x: &Point| {
                openings().any(|r| {
                    [-self.length, 0.0, self.length]
                        .into_iter()
                        .any(|rate| contact.normal.pressure(x, r, rate, lambda).value != 0.0)
                })
            };
            let open = |x: &Point, r: f64| ContactPoint { x: *x, penetration: r, ..ContactPoint::default() };
            let rubs = |x: &Point| openings().any(|r| contact.friction.bound(&open(x, r)).value != 0.0);
            let warmed = |x: &Point, r: f64| {
                let flux = |temperature: f64, foundation_temperature: f64| {
                    contact.heat.flux(&ContactPoint { temperature, foundation_temperature, ..open(x, r) }).value != 0.0
                };
                temperatures().step_by(7).any(|theta| flux(theta, 0.0) || flux(0.0, theta))
            };
            if self.places.iter().any(pulls) {
                Some(("the normal law acts over an open gap", "normal"))
            } else if self.places.iter().any(rubs) {
                Some(("friction acts over an open gap", "friction"))
            } else if self.places.iter().any(|x| openings().step_by(4).any(|r| warmed(x, r))) {
                Some(("heat passes over an open gap", "heat"))
            } else {
                None
            }
        })
    }

    /// True if the contact transmits nothing, open or closed: no pressure, no friction, no heat.
    pub(super) fn does_nothing(&self) -> bool {
        self.sampled(|| {
            let contact = self.contact;
            let closed = |x: &Point, r: f64, temperature: f64| ContactPoint {
                x: *x,
                penetration: r,
                temperature,
                ..ContactPoint::default()
            };
            let acts =
                |at: &ContactPoint| contact.heat.flux(at).value != 0.0 || contact.friction.bound(at).value != 0.0;
            let closed = |x: &Point| {
                (-1000..=40)
                    .step_by(20)
                    .any(|power| [-1.0, 1.0].into_iter().any(|t| acts(&closed(x, self.length * 2f64.powi(power), t))))
            };
            contact.normal.lipschitz() == Some(0.0)
                && !self.rate_matters()
                && self.acts_open().is_none()
                && !self.places.iter().any(closed)
        })
    }
}
