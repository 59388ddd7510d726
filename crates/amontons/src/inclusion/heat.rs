//! The heat step on Γ_C: conductance, radiation, heat of friction and foundations with a heat capacity.
//!
//! The flux Q = q·ν of a point is a multiplier as the pressure is: Q = H(θ + λ (Q − H)), H the law, so that a perfect
//! conductance is no harder than a small one, and its round-off is that of S θ and not that of h (θ − θ_F).

use std::borrow::Cow;

use super::frame::PointState;
use super::interface::Interface;
use super::newton::{Effort, Iterate, Right, Term, iterate};
use super::passed::Passed;
use super::{Failure, ITERATIONS, STIFF, Solved};
use crate::arrays::per_point;
use crate::contact::{Contact, ContactBoundary, ContactPoint, FRICTION, Flux, HeatLaw, Status, arrays};
use crate::linalg::{Condensed, Tangent};
use crate::tensor::{dot, length};

/// Data of a heat step on Γ_C that are known before it is solved.
pub struct HeatStep<'a> {
    /// The laws of each side.
    pub contacts: &'a [Contact],
    /// The contact points.
    pub boundary: &'a ContactBoundary,
    /// Unknown of each contact node, or `None` if it is prescribed.
    pub unknown: &'a [Option<u32>],
    /// Temperatures at the contact nodes, those that are prescribed filled in, K.
    pub theta_prescribed: &'a [f64],
    /// θ_F(t_n) at the contact points where it is prescribed, K.
    pub foundation: &'a [f64],
    /// Initial state of each side's foundation with a heat capacity, or `None` if θ_F is prescribed.
    pub lumped: &'a [Option<Lumped>],
    /// States of the contact points at u_n.
    pub states: &'a [PointState],
}

/// A foundation with a heat capacity in a step: C/k (θ_F − θ_F,n−1) + H (θ_F − θ_∞) is what it receives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lumped {
    /// C/k in W/K.
    pub storage: f64,
    /// θ_F at t_{n−1}, K.
    pub before: f64,
    /// H in W/K.
    pub exchange: f64,
    /// θ_∞(t_n) in K.
    pub surroundings: f64,
}

/// The contact points at given temperatures of the body.
#[derive(Clone, Debug, Default)]
pub struct Exchange {
    /// Temperature of the body that bears each point, K.
    pub temperature: Vec<f64>,
    /// Temperature of what each point faces, K: of the foundation, or of the other body of a pair.
    pub opposite: Vec<f64>,
    /// Heat flux q·ν at each point, of the side that bears it.
    pub flux: Vec<Flux>,
    /// Power of friction that enters both bodies of a pair, W/m².
    pub rubbed: Vec<f64>,
    /// θ_F of each foundation with a heat capacity, or `None` if it is prescribed.
    pub foundation: Vec<Option<f64>>,
    /// Heat that passes each contact, W.
    pub passed: Vec<Passed>,
}

impl Exchange {
    /// The temperature of the side `on` at each point, K.
    #[must_use]
    pub fn temperatures_on(&self, contacts: &[Contact], boundary: &ContactBoundary) -> Vec<f64> {
        let sides = boundary.points.iter().zip(self.temperature.iter().zip(&self.opposite));
        sides.map(|(point, (own, other))| if contacts[point.contact].sign() > 0.0 { *own } else { *other }).collect()
    }

    /// At each point what leaves the side that bears it, and what enters the other side of a pair, W/m².
    pub fn sides(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.flux.iter().zip(&self.rubbed).map(|(flux, rubbed)| [flux.value, flux.value + rubbed])
    }
}

/// Most iterations for the temperature at which a law has a flux; every third halves the interval.
const INVERSE: usize = 200;

/// The heat term of a step.
struct Thermal<'a> {
    step: &'a HeatStep<'a>,
    interface: Interface,
    /// λ of each point in K m²/W; zero where nothing is unknown.
    lambda: Vec<f64>,
}

/// The heat flux of one point at an iterate.
#[derive(Clone, Copy, Debug, Default)]
struct PointFlux {
    /// θ of the body and θ_F in K.
    temperature: f64,
    foundation: f64,
    /// Q, the multiplier, and J = H(θ + λ (Q − J)), which is Q at a solution, W/m².
    flux: f64,
    passed: f64,
    /// H with its slopes at the temperature where it is J.
    curve: Flux,
    /// 1/(1 + λ ∂H/∂θ): the slopes of J are those of H times this.
    softening: f64,
}

impl PointFlux {
    /// Flux of the linearised law at an unchanged temperature, and its slopes in θ and θ_F: δQ = (J − Q + ∂J/∂θ
    /// δθ + ∂J/∂θ_F δθ_F)/(1 − λ ∂J/∂θ).
    fn linear(&self) -> [f64; 3] {
        let yielding = self.softening.max(STIFF.recip());
        let slope = self.softening / yielding;
        [
            self.flux + (self.passed - self.flux) / yielding,
            slope * self.curve.by_temperature,
            slope * self.curve.by_foundation,
        ]
    }
}

impl HeatStep<'_> {
    /// The flux by the law out of the side that bears a point, at the temperatures of this side and of what it faces.
    /// The law is that of the side `on`.
    pub(super) fn flux(&self, i: usize, temperature: f64, opposite: f64) -> Flux {
        let contact = &self.contacts[self.boundary.points[i].contact];
        if contact.sign() > 0.0 {
            contact.heat.flux(&self.at(i, temperature, opposite))
        } else {
            contact.heat.flux(&self.at(i, opposite, temperature)).across(self.rubbed(i))
        }
    }

    /// Input of the laws at a point, at the temperatures of the side `on` and of the opposite body or foundation.
    pub(super) fn at(&self, i: usize, temperature: f64, foundation: f64) -> ContactPoint {
        let state = &self.states[i];
        ContactPoint {
            x: self.boundary.points[i].x,
            penetration: state.at_level,
            pressure: state.pressure,
            slip_speed: length(&state.slip),
            friction_power: dot(&state.q, &state.slip),
            temperature,
            foundation_temperature: foundation,
        }
    }

    /// True if a point lies between two bodies.
    fn is_pair(&self, i: usize) -> bool {
        let point = &self.boundary.points[i];
        point.own < point.nodes.len()
    }

    /// Power of friction that enters both bodies of a pair at a point, W/m².
    pub(super) fn rubbed(&self, i: usize) -> f64 {
        let rubs = self.contacts[self.boundary.points[i].contact].rubs();
        if rubs { dot(&self.states[i].q, &self.states[i].slip) } else { 0.0 }
    }

    /// A flux out of the side of a point and into the other side of a pair.
    fn both(&self, i: usize, flux: f64) -> [f64; 3] {
        [flux, flux + self.rubbed(i), 0.0]
    }

    /// Solves the step: `guess` is where the iteration starts, `r` the reduced right-hand side for the increment of the
    /// temperature over the guess. Returns the temperatures on Γ_C and the exchange there.
    ///
    /// # Errors
    /// If the iteration does not converge, or a linear system is not solved.
    pub fn solve(
        &self,
        condensed: &mut dyn Condensed,
        r: &[f64],
        guess: &[f64],
    ) -> Result<(Solved, Exchange), Failure> {
        condensed.turn(&[]);
        let interface = Interface::of_scalars(self.boundary, self.unknown, self.theta_prescribed);
        let rho = interface.stiffness(self.boundary, None, self.unknown, condensed.scale());
        let lambda = rho.iter().map(|rho| if *rho > 0.0 { rho.recip() } else { 0.0 }).collect();
        let term = Thermal { step: self, interface, lambda };
        let right = Right { r, guess, proximal: None, is_repeated: false, springs: &[], rigid: None, pulse: None };
        let start = Iterate { x: guess.to_vec(), multipliers: term.start(guess) };
        let outcome = iterate(
            &term,
            condensed,
            &right,
            start,
            &Effort { leaps: 0, is_free: false, iterations: ITERATIONS, enough: 0.0 },
        )?;
        if let Some(failure) = outcome.failure {
            return Err(failure.into());
        }
        let exchange = term.exchange(&outcome.end.x, &outcome.end.multipliers);
        let solved = Solved { x: outcome.end.x, iterations: outcome.iterations, ..Solved::default() };
        Ok((solved, exchange))
    }

    /// The derivative of Σ ω Nᵀ q·ν in θ at a solution. A foundation with a heat capacity follows all of its contact
    /// points: with c = Σ ω Nᵀ ∂(q·ν)/∂θ_F and r = Σ ω N ∂(q·ν)/∂θ, it adds c rᵀ over the slope of its balance.
    #[must_use]
    pub fn tangent(&self, exchange: &Exchange) -> Tangent {
        let interface = Interface::of_scalars(self.boundary, self.unknown, self.theta_prescribed);
        let slopes: Vec<[f64; 2]> =
            exchange.flux.iter().map(|flux| [flux.by_temperature, flux.by_foundation]).collect();
        self.tangent_of(&interface, &slopes)
    }

    /// The derivative of fluxes with these slopes in θ and θ_F.
    fn tangent_of(&self, interface: &Interface, slopes: &[[f64; 2]]) -> Tangent {
        let mut sum = interface.empty_tangent();
        for (i, [by_temperature, by_other]) in slopes.iter().enumerate() {
            let mut tangent = [[0.0; 3]; 3];
            tangent[0][0] = *by_temperature;
            if self.is_pair(i) {
                // The second component is −θ of the other side.
                tangent[0][1] = -by_other;
                tangent[1] = tangent[0];
            }
            interface.add_tangent(i, &tangent, &mut sum);
        }
        for (side, lumped) in self.lumped.iter().enumerate() {
            let Some(lumped) = lumped else { continue };
            let slope = lumped.slope(interface, side, slopes);
            let (mut by_foundation, mut by_body): (Vec<(u32, f64)>, Vec<(u32, f64)>) = Default::default();
            for (i, [of_body, of_foundation]) in
                slopes.iter().enumerate().filter(|(i, _)| interface.rows[*i].contact == side)
            {
                if *of_body != 0.0 || *of_foundation != 0.0 {
                    by_foundation.extend(interface.scaled_row(i, *of_foundation));
                    by_body.extend(interface.scaled_row(i, *of_body));
                }
            }
            sum.add_product_of(slope.recip(), &by_foundation, &by_body);
        }
        sum
    }

    /// The heat that passes each contact at the fluxes Q out of the sides that bear the points, with the temperatures
    /// of these sides and of what they face.
    fn passed(&self, flux: &[f64], temperatures: &[[f64; 2]]) -> Vec<Passed> {
        let none = |contact: &Contact| Passed {
            by: Vec::with_capacity(contact.heat.parts().len().max(1)),
            ..Passed::default()
        };
        let mut all: Vec<Passed> = self.contacts.iter().map(none).collect();
        for (i, (flux, at)) in flux.iter().zip(temperatures).enumerate() {
            let point = &self.boundary.points[i];
            let (Some(contact), Some(passed)) = (self.contacts.get(point.contact), all.get_mut(point.contact)) else {
                continue;
            };
            let (rubbed, [own, other]) = (self.rubbed(i), *at);
            passed.rubbed += point.weight * rubbed;
            let (flux, at) = if contact.sign() > 0.0 {
                (*flux, [own, other])
            } else {
                (Flux { value: *flux, ..Flux::default() }.across(rubbed).value, [other, own])
            };
            self.split(i, &*contact.heat, flux, at, |mechanism, value| {
                passed.add(Cow::Borrowed(mechanism), point.weight * value);
            });
        }
        all
    }

    /// Splits the flux out of the side `on` at a point. Friction heat does not depend on the temperatures. The rest is
    /// divided in the ratio of the laws, which stays exact where a conductance is so large that θ − θ_F is round-off;
    /// where the difference vanishes, in that of their slopes.
    fn split(
        &self,
        i: usize,
        law: &dyn HeatLaw,
        flux: f64,
        [temperature, foundation]: [f64; 2],
        mut add: impl FnMut(&'static str, f64),
    ) {
        if law.parts().is_empty() {
            law.mechanism().into_iter().for_each(|mechanism| add(mechanism, flux));
            return;
        }
        let at = self.at(i, temperature, foundation);
        let of_parts = || law.parts().iter().filter_map(|part| Some((part.mechanism()?, part.flux(&at))));
        let exchanging = || of_parts().filter(|(mechanism, _)| *mechanism != FRICTION);
        let rest = of_parts()
            .filter(|(mechanism, _)| *mechanism == FRICTION)
            .inspect(|(mechanism, friction)| add(mechanism, friction.value))
            .fold(flux, |rest, (_, friction)| rest - friction.value);
        let [value, slope] =
            exchanging().fold([0.0; 2], |[value, slope], (_, part)| [value + part.value, slope + part.by_temperature]);
        for (mechanism, part) in exchanging() {
            let share = if value != 0.0 {
                part.value / value
            } else if slope > 0.0 {
                part.by_temperature / slope
            } else {
                0.0
            };
            add(mechanism, rest * share);
        }
    }
}

impl Lumped {
    /// The slope of the balance of heat in θ_F: C/k + H − Σ ω ∂(q·ν)/∂θ_F.
    fn slope(&self, interface: &Interface, side: usize, slopes: &[[f64; 2]]) -> f64 {
        let rows = interface.rows.iter().zip(slopes).filter(|(row, _)| row.contact == side);
        rows.fold(self.storage + self.exchange, |sum, (row, [_, by_foundation])| sum - row.weight * by_foundation)
    }
}

impl Thermal<'_> {
    /// θ_F of each foundation with a heat capacity, by its balance at the fluxes Q.
    fn foundations(&self, flux: &[f64]) -> Vec<Option<f64>> {
        let of = |(side, lumped): (usize, &Option<Lumped>)| {
            let Lumped { storage, before, exchange, surroundings } = (*lumped)?;
            let rows = self.interface.rows.iter().enumerate().filter(|(_, row)| row.contact == side);
            let received: f64 = rows
                .map(|(i, row)| row.weight * (flux[i] + dot(&self.step.states[i].q, &self.step.states[i].slip)))
                .sum();
            // Increments, so that a foundation that receives nothing keeps its temperature to the bit.
            Some(before + (received + exchange * (surroundings - before)) / (storage + exchange))
        };
        self.step.lumped.iter().enumerate().map(of).collect()
    }

    /// The law of a point at a temperature with the flux Q as multiplier.
    fn law(&self, i: usize, temperature: f64, foundation: f64, flux: f64) -> PointFlux {
        let heat = |temperature: f64| self.step.flux(i, temperature, foundation);
        let lambda = self.lambda[i];
        let z = temperature + lambda * flux;
        // The temperature τ at which H is (z − τ)/λ: the difference of both rises with τ.
        let (mut law, mut at) = (heat(temperature), temperature);
        if lambda > 0.0 {
            let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
            for iteration in 0..INVERSE {
                let excess = (at - z) + lambda * law.value;
                *(if excess > 0.0 { &mut high } else { &mut low }) = at;
                let newton = at - excess / (1.0 + lambda * law.by_temperature);
                let next = if newton > low && newton < high || iteration % 3 < 2 {
                    newton.clamp(low, high)
                } else {
                    0.5 * (low + high)
                };
                if excess == 0.0 || (next - at).abs() <= f64::EPSILON * (at.abs() + z.abs()) || !next.is_finite() {
                    break;
                }
                at = next;
                law = heat(at);
            }
        }
        let stiff = lambda * law.by_temperature > 1.0;
        let passed = if stiff { (z - at) / lambda } else { law.value };
        PointFlux {
            temperature,
            foundation,
            flux,
            passed,
            softening: 1.0 / (1.0 + lambda * law.by_temperature),
            curve: law,
        }
    }

    fn laws_at(&self, theta: &[f64], flux: &[f64]) -> Vec<PointFlux> {
        let foundations = self.foundations(flux);
        let of = |i: usize| {
            let side = self.interface.rows[i].contact;
            let [own, other, _] = self.interface.jump(i, theta);
            let foundation = foundations.get(side).copied().flatten().unwrap_or(self.step.foundation[i]);
            self.law(i, own, if self.step.is_pair(i) { 0.0 - other } else { foundation }, flux[i])
        };
        per_point(&arrays(self.step.contacts), flux.len(), of)
    }

    /// Fluxes to start from: H of a small conductance, and that through the body of a large one.
    fn start(&self, theta: &[f64]) -> Vec<f64> {
        self.laws_at(theta, &vec![0.0; self.interface.len()]).iter().map(|law| law.passed).collect()
    }

    /// The exchange at a solution.
    fn exchange(&self, theta: &[f64], flux: &[f64]) -> Exchange {
        let laws = self.laws_at(theta, flux);
        let temperatures: Vec<[f64; 2]> = laws.iter().map(|law| [law.temperature, law.foundation]).collect();
        Exchange {
            passed: self.step.passed(flux, &temperatures),
            temperature: laws.iter().map(|law| law.temperature).collect(),
            opposite: laws.iter().map(|law| law.foundation).collect(),
            flux: laws.iter().zip(flux).map(|(law, flux)| Flux { value: *flux, ..law.curve }).collect(),
            rubbed: (0..flux.len()).map(|i| self.step.rubbed(i)).collect(),
            foundation: self.foundations(flux),
        }
    }

    /// Σ ω of the fluxes of the linearised laws that a foundation receives beyond Q at an unchanged temperature of the
    /// body and of itself, over the slope of its balance: by how much θ_F changes. `beyond` is by point.
    fn warming(&self, slopes: &[[f64; 2]], beyond: &[f64]) -> Vec<f64> {
        let of = |(side, lumped): (usize, &Option<Lumped>)| {
            let Some(lumped) = lumped else { return 0.0 };
            let rows = self.interface.rows.iter().zip(beyond).filter(|(row, _)| row.contact == side);
            rows.map(|(row, beyond)| row.weight * beyond).sum::<f64>() / lumped.slope(&self.interface, side, slopes)
        };
        self.step.lumped.iter().enumerate().map(of).collect()
    }
}

impl Term for Thermal<'_> {
    type Multipliers = Vec<f64>;
    type Laws = Vec<PointFlux>;

    fn laws(&self, x: &[f64], multipliers: &Vec<f64>) -> Vec<PointFlux> {
        self.laws_at(x, multipliers)
    }

    fn forces(&self, laws: &Vec<PointFlux>, out: &mut [f64]) {
        for (i, law) in laws.iter().enumerate() {
            self.interface.scatter(i, &self.step.both(i, law.flux), out);
        }
    }

    fn defects(&self, laws: &Vec<PointFlux>) -> Vec<f64> {
        self.interface.rows.iter().zip(laws).map(|(row, law)| row.weight * (law.flux - law.passed)).collect()
    }

    fn round_off(&self, _x: &[f64], laws: &Vec<PointFlux>) -> f64 {
        // The flux into a body of prescribed temperature is given, but for a foundation that it warms.
        let matters = |i: usize| {
            let lumped = self.step.lumped.get(self.interface.rows[i].contact);
            self.lambda[i] > 0.0 || lumped.is_some_and(Option::is_some)
        };
        let of = |(i, law): (usize, &PointFlux)| {
            let size = law.temperature.abs() + law.foundation.abs();
            self.interface.rows[i].weight * law.softening * law.curve.by_temperature * size
        };
        laws.iter().enumerate().filter(|(i, _)| matters(*i)).map(of).fold(0.0, f64::max)
    }

    fn linearise(&self, laws: &Vec<PointFlux>, right: &mut [f64]) -> Tangent {
        let linear: Vec<[f64; 3]> = laws.iter().map(PointFlux::linear).collect();
        let slopes: Vec<[f64; 2]> = linear.iter().map(|[_, body, foundation]| [*body, *foundation]).collect();
        let beyond: Vec<f64> = linear.iter().zip(laws).map(|([value, ..], law)| value - law.flux).collect();
        let warmer = self.warming(&slopes, &beyond);
        for (i, [value, _, by_foundation]) in linear.iter().enumerate() {
            let flux = value + by_foundation * warmer.get(self.interface.rows[i].contact).copied().unwrap_or(0.0);
            self.interface.scatter(i, &self.step.both(i, flux).map(|flux| -flux), right);
        }
        self.step.tangent_of(&self.interface, &slopes)
    }

    fn after(&self, laws: &Vec<PointFlux>, _before: &Vec<f64>, step: &[f64]) -> Vec<f64> {
        let linear: Vec<[f64; 3]> = laws.iter().map(PointFlux::linear).collect();
        let slopes: Vec<[f64; 2]> = linear.iter().map(|[_, body, foundation]| [*body, *foundation]).collect();
        let after: Vec<f64> = linear
            .iter()
            .enumerate()
            .map(|(i, [value, body, other])| {
                let change = self.interface.change(i, step);
                let after = value + body * change[0];
                if self.step.is_pair(i) { after - other * change[1] } else { after }
            })
            .collect();
        let beyond: Vec<f64> = after.iter().zip(laws).map(|(after, law)| after - law.flux).collect();
        let warmer = self.warming(&slopes, &beyond);
        let warming = |i: usize| warmer.get(self.interface.rows[i].contact).copied().unwrap_or(0.0);
        after
            .iter()
            .zip(&linear)
            .enumerate()
            .map(|(i, (after, [_, _, by_foundation]))| after + by_foundation * warming(i))
            .collect()
    }

    fn towards(from: &Vec<f64>, to: &Vec<f64>, alpha: f64) -> Vec<f64> {
        from.iter().zip(to).map(|(a, b)| a + alpha * (b - a)).collect()
    }

    fn settled(&self, _x: &[f64], laws: &Vec<PointFlux>, _multipliers: Vec<f64>) -> Vec<f64> {
        laws.iter().map(|law| law.passed).collect()
    }

    fn states(&self, _laws: &Vec<PointFlux>) -> Vec<Status> {
        Vec::new()
    }
}
