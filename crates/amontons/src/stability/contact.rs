//! The laws of contact, linearised at a state in which closed points slide or stick and open points stay open.
//!
//! For a perturbation u′ of the displacement with its rate u̇′ and θ′ of the temperature, r′ = ν·u′ and s′ = u̇′_τ:
//!
//! | point | normal | tangential |
//! |---|---|---|
//! | open | p′ = 0 | q′ = 0 |
//! | closed, compliance | p′ = ∂p/∂r r′ + ∂p/∂ṙ ṙ′ | |
//! | closed, rigid | r′ = 0, p′ the reaction | |
//! | slides | | q′ = (∂s/∂p p′ + ∂s/∂r r′ + ∂s/∂‖w_τ‖ e·s′ + ∂s/∂θ θ′) n + (s/‖w_τ‖) (s′ − (n·s′) n) |
//! | sticks | | s′ = 0, q′ the reaction |
//!
//! | wears | p′ unknown, [`WearingNormal`] | |
//!
//! with the bound s, the slip velocity w_τ of the state, e = w_τ/‖w_τ‖ and n = e, or the normal of the cone where it is
//! not round. The last term of sliding, the drag, exists only across the direction of sliding: in space, or where the
//! foundation slides in a direction in which the body does not move.

use super::{Reason, StabilityError};
use crate::arrays::per_point;
use crate::contact::{
    Bound, Contact, ContactBoundary, ContactPoint, Flux, GraphKind, NormalLaw, PointOnBoundary, Status, arrays,
};
use crate::inclusion::PointState;
use crate::mesh::cross;
use crate::state::StepReport;
use crate::tensor::{Point, dot, length};

/// Part of the compliance 1/(∂p/∂r) of a graph below which the point is rigid: round-off of its resolvent.
const RIGID: f64 = 1e-9;

/// A matrix in the axes of space, rows the result.
pub(super) type SpaceMap = [Point; 3];

/// A component of the perturbation that a point holds, and its reaction: a force on the foundation and the heat that it
/// drives out of the side of the point and into the other one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct HeldComponent {
    /// Direction in which the jump of u′ vanishes.
    pub direction: Point,
    /// Force per reaction, without dimension.
    pub force: Point,
    /// Heat per reaction, m/s.
    pub heat: [f64; 2],
}

/// The normal law of a closed point that wears, with p′ as an unknown: the depth h that is worn off grows with
/// λh′ = W_p p′ + W_v e·u̇′ + W_θ θ′ of W = κ p ‖w_τ‖, and the layer or the rigid foundation bears r′ − h′ = C p′, so
/// that
///
/// ```text
/// W_p p′ + λ C p′ − λ (ν − W_v e)·u′ + W_θ θ′ = 0
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct WearingNormal {
    /// W_p in m/(Pa s), and C = 1/(∂p/∂r) in m/Pa, 0 of a rigid foundation.
    pub by_pressure: f64,
    pub compliance: f64,
    /// ν − W_v e.
    pub approach: Point,
    /// W_θ by the temperatures of both sides, m/(s K).
    pub by_temperature: [f64; 2],
    /// Force on the foundation and heat out of one side and into the other per p′.
    pub force: Point,
    pub heat: [f64; 2],
}

/// The linearised laws of one contact point: the force p′ν + q′ and the heat out of the side of the point and into the
/// other one by the jump of u′, by that of u̇′, and by the temperatures of both sides.
#[derive(Clone, Debug, Default)]
pub(super) struct PointTerm {
    pub held: Vec<HeldComponent>,
    pub wearing: Option<WearingNormal>,
    pub force_by_jump: SpaceMap,
    pub force_by_rate: SpaceMap,
    pub force_by_temperature: [Point; 2],
    pub heat_by_jump: [Point; 2],
    pub heat_by_rate: [Point; 2],
    /// Rows out and into, columns the temperature on the side of the point and on the other one.
    pub heat_by_temperature: [[f64; 2]; 2],
}

/// a bᵀ, times a factor.
fn outer(factor: f64, a: &Point, b: &Point) -> SpaceMap {
    a.map(|a| b.map(|b| factor * a * b))
}

fn add(sum: &mut SpaceMap, term: &SpaceMap) {
    sum.iter_mut().zip(term).for_each(|(sum, term)| sum.iter_mut().zip(term).for_each(|(sum, term)| *sum += term));
}

fn scaled(factor: f64, v: &Point) -> Point {
    v.map(|c| factor * c)
}

/// Mᵀ v.
fn transposed(map: &SpaceMap, v: &Point) -> Point {
    std::array::from_fn(|c| (0..3).map(|r| map[r][c] * v[r]).sum())
}

/// The normal law at a point: its slopes in r and ṙ, or rigid.
enum Slope {
    Rigid,
    Of { by_penetration: f64, by_rate: f64 },
}

/// Slope of a normal law at a pressure on its graph.
fn slope(law: &dyn NormalLaw, x: &Point, state: &PointState) -> Slope {
    let none = Slope::Of { by_penetration: 0.0, by_rate: 0.0 };
    if law.graph() == GraphKind::Function {
        let at = law.pressure(x, state.penetration, 0.0, 0.0);
        return Slope::Of { by_penetration: at.slope, by_rate: at.by_rate };
    }
    let p = state.pressure;
    if p == 0.0 && law.graph() != GraphKind::Bilateral {
        return none;
    }
    // Of p ∈ G(z − λp) with z = r + λp: 1 − λ ∂p/∂z is the part of λ that the graph adds nothing to.
    let lambda = if p.abs() > 0.0 { (state.penetration.abs() + 1.0) / p.abs() } else { 1.0 };
    let at = law.pressure(x, state.penetration + lambda * p, 0.0, lambda);
    let left = 1.0 - lambda * at.slope;
    if left <= RIGID { Slope::Rigid } else { Slope::Of { by_penetration: at.slope / left, by_rate: at.by_rate / left } }
}

/// A contact point at the state.
struct PointAtState<'a> {
    contact: &'a Contact,
    point: &'a PointOnBoundary,
    state: &'a PointState,
    /// Temperature on the side of the point and opposite it, K.
    temperatures: [f64; 2],
}

/// Friction at a point: the bound with its slopes, the direction n, e, and the derivative of q in the slip at a fixed
/// bound.
struct Sliding {
    bound: Bound,
    n: Point,
    e: Point,
    drag: SpaceMap,
}

impl PointAtState<'_> {
    /// Argument of the laws.
    fn seen(&self) -> ContactPoint {
        let [own, other] = self.temperatures;
        let (on, with) = if self.contact.sign() > 0.0 { (own, other) } else { (other, own) };
        let pressed = match self.contact.normal.graph() {
            GraphKind::Bilateral => self.state.pressure.abs(),
            _ => self.state.pressure.max(0.0),
        };
        ContactPoint {
            x: self.point.x,
            penetration: self.state.penetration,
            pressure: pressed,
            slip_speed: length(&self.state.slip),
            friction_power: dot(&self.state.q, &self.state.slip),
            temperature: on,
            foundation_temperature: with,
        }
    }

    /// The part of a vector along which friction acts: tangential, without the directions in which both sides of a pair
    /// are held alike.
    fn tangential(&self) -> SpaceMap {
        let mut map = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        add(&mut map, &outer(-1.0, &self.state.normal, &self.state.normal));
        for held in &self.point.held {
            let along = dot(held, &self.state.normal);
            let held: Point = std::array::from_fn(|c| held[c] - along * self.state.normal[c]);
            let size = length(&held);
            if size > 0.5 {
                add(&mut map, &outer(-1.0 / (size * size), &held, &held));
            }
        }
        map
    }

    fn sliding(&self) -> Option<Sliding> {
        let (state, law) = (self.state, &self.contact.friction);
        let speed = length(&state.slip);
        if state.status != Status::Slip || state.bound <= 0.0 || speed <= 0.0 {
            return None;
        }
        let bound = law.bound(&self.seen());
        let e = scaled(1.0 / speed, &state.slip);
        let tangential = self.tangential();
        // q = s D z/‖z‖ with z = D w_τ.
        let shape = law.cone(&self.point.x, &state.normal);
        let of = |v: &Point| shape.as_ref().map_or(*v, |cone| cone.apply(v));
        let z = of(&state.slip);
        let size = length(&z);
        let n = scaled(1.0 / size, &of(&z));
        let across = |v: &Point| -> Point {
            let v = of(&transposed(&tangential, v));
            let along = dot(&v, &z) / size;
            of(&std::array::from_fn(|c| v[c] - along * z[c] / size))
        };
        let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| across(&axis));
        let turn: SpaceMap = std::array::from_fn(|r| std::array::from_fn(|c| bound.value / size * columns[c][r]));
        Some(Sliding { bound, n, e, drag: turn })
    }

    /// The slopes of the heat out of the side of the point.
    fn flux(&self) -> Flux {
        let flux = self.contact.heat.flux(&self.seen());
        if self.contact.sign() > 0.0 {
            return flux;
        }
        flux.across(if self.contact.rubs() { dot(&self.state.q, &self.state.slip) } else { 0.0 })
    }

    /// The wear at a closed point whose pressure follows the penetration, without what the normal law and friction add;
    /// `None` where nothing is worn off.
    fn wear(&self, slope: &Slope) -> Option<WearingNormal> {
        let (law, state) = (self.contact.wear.as_ref()?, self.state);
        let speed = length(&state.slip);
        let yields = matches!(slope, Slope::Of { by_penetration, .. } if *by_penetration <= 0.0);
        if state.pressure <= 0.0 || state.status != Status::Slip || speed <= 0.0 || yields {
            return None;
        }
        let seen = self.seen();
        let coefficient = law.coefficient(&seen);
        let by_slip = scaled(coefficient * state.pressure / speed, &state.slip);
        let mut wear = WearingNormal {
            by_pressure: coefficient * speed,
            approach: std::array::from_fn(|c| state.normal[c] - by_slip[c]),
            ..WearingNormal::default()
        };
        wear.by_temperature[self.on()] = law.by_temperature(&seen) * state.pressure * speed;
        (coefficient > 0.0).then_some(wear)
    }

    /// The linearised laws. `has_heat` is false if no temperature is perturbed.
    fn linearised(&self, has_heat: bool) -> PointTerm {
        let (state, nu) = (self.state, &self.state.normal);
        let mut term = PointTerm::default();
        let closed = state.bears() || state.status != Status::Open;
        let flux = if has_heat { self.flux() } else { Flux::default() };
        // Slopes of p′ν + q′ in p′.
        let sliding = self.sliding().filter(|_| closed);
        let sign = if state.pressure < 0.0 { -1.0 } else { 1.0 };
        let with_pressure: Point = sliding
            .as_ref()
            .map_or(*nu, |sliding| std::array::from_fn(|c| nu[c] + sign * sliding.bound.by_pressure * sliding.n[c]));
        let by_pressure = flux.by_pressure;
        let tangential = self.tangential();
        if let Some(Sliding { bound, n, e, drag }) = &sliding {
            add(&mut term.force_by_jump, &outer(bound.by_penetration, n, nu));
            add(&mut term.force_by_rate, &outer(bound.by_slip_speed, n, &transposed(&tangential, e)));
            add(&mut term.force_by_rate, drag);
            term.force_by_temperature[self.on()] = scaled(bound.by_temperature, n);
        }
        let slope = if closed { slope(&*self.contact.normal, &self.point.x, state) } else { open() };
        // Heat by the power of friction q·w_τ, out of this side and into the other.
        // A foundation with a heat capacity takes what does not enter the body, as the other side of a pair.
        let rubs = f64::from(u8::from(self.contact.rubs() || self.contact.foundation_heat.is_some()));
        let powers = [flux.by_friction_power, flux.by_friction_power + rubs];
        let slip = &state.slip;
        let heat_of = |force: &Point| powers.map(|power| power * dot(force, slip));
        let wear = self.wear(&slope).filter(|_| closed);
        match (slope, wear) {
            (slope, Some(wear)) => {
                // The bound and the flux by the penetration r′ − h′ = C p′.
                let compliance = match slope {
                    Slope::Rigid => 0.0,
                    Slope::Of { by_penetration, .. } => by_penetration.recip(),
                };
                let of_bound = sliding.as_ref().map_or([0.0; 3], |s| scaled(compliance * s.bound.by_penetration, &s.n));
                let force: Point = std::array::from_fn(|c| with_pressure[c] + of_bound[c]);
                let through = by_pressure + compliance * flux.by_penetration;
                let heat = if has_heat { heat_of(&force).map(|heat| heat + through) } else { [0.0; 2] };
                term.force_by_jump = SpaceMap::default();
                term.wearing = Some(WearingNormal { compliance, force, heat, ..wear });
            }
            (Slope::Rigid, None) => {
                let heat = heat_of(&with_pressure).map(|heat| heat + by_pressure);
                term.held.push(HeldComponent { direction: *nu, force: with_pressure, heat });
            }
            (Slope::Of { by_penetration, by_rate }, None) => {
                add(&mut term.force_by_jump, &outer(by_penetration, &with_pressure, nu));
                add(&mut term.force_by_rate, &outer(by_rate, &with_pressure, nu));
                for side in 0..2 {
                    term.heat_by_jump[side] = scaled(by_pressure * by_penetration, nu);
                    term.heat_by_rate[side] = scaled(by_pressure * by_rate, nu);
                }
            }
        }
        if state.status == Status::Stick && closed {
            for direction in self.tangents(&tangential) {
                term.held.push(HeldComponent { direction, force: direction, heat: [0.0; 2] });
            }
        }
        if has_heat {
            self.add_heat(&mut term, &flux, powers);
        }
        term
    }

    /// Adds the heat that follows the force, the slip and the temperatures.
    fn add_heat(&self, term: &mut PointTerm, flux: &Flux, powers: [f64; 2]) {
        let (slip, q, nu) = (&self.state.slip, &self.state.q, &self.state.normal);
        let speed = length(slip);
        let e = if speed > 0.0 { scaled(1.0 / speed, slip) } else { [0.0; 3] };
        // At a point that wears, penetration follows the pressure.
        let through = if term.wearing.is_some() { 0.0 } else { flux.by_penetration };
        for (side, power) in powers.into_iter().enumerate() {
            let [by_jump, by_rate] = [&term.force_by_jump, &term.force_by_rate].map(|map| transposed(map, slip));
            for c in 0..3 {
                term.heat_by_jump[side][c] += power * by_jump[c] + through * nu[c];
                term.heat_by_rate[side][c] += power * (by_rate[c] + q[c]) + flux.by_slip_speed * e[c];
            }
            let of_force = term.force_by_temperature.map(|force| power * dot(&force, slip));
            term.heat_by_temperature[side] = [flux.by_temperature + of_force[0], flux.by_foundation + of_force[1]];
        }
    }

    /// Number of the side `on` among that of the point and the other one.
    fn on(&self) -> usize {
        usize::from(self.contact.sign() < 0.0)
    }

    /// Unit vectors that span the directions of friction.
    fn tangents(&self, tangential: &SpaceMap) -> Vec<Point> {
        let sizes = tangential.map(|row| length(&row));
        let mut found: Vec<Point> = Vec::new();
        let largest = (0..3).max_by(|a, b| sizes[*a].total_cmp(&sizes[*b])).unwrap_or_default();
        if sizes[largest] > 0.5 {
            let first = scaled(1.0 / sizes[largest], &tangential[largest]);
            let second = transposed(tangential, &cross(&self.state.normal, &first));
            found.push(first);
            if length(&second) > 0.5 {
                found.push(second);
            }
        }
        found
    }
}

fn open() -> Slope {
    Slope::Of { by_penetration: 0.0, by_rate: 0.0 }
}

/// The linearised laws at all contact points.
///
/// # Errors
/// If a contact has no steady state, or the report does not have the points of the boundary.
pub(super) fn linearised(
    contacts: &[Contact],
    boundary: &ContactBoundary,
    report: &StepReport,
    has_heat: bool,
) -> Result<Vec<PointTerm>, StabilityError> {
    let states = &report.contact;
    if states.states.len() != boundary.points.len() {
        return Err(StabilityError::State(Reason::NoStep));
    }
    let temperature = |all: &[f64], i: usize| all.get(i).copied().unwrap_or_default();
    Ok(per_point(&arrays(contacts), boundary.points.len(), |i| {
        let point = &boundary.points[i];
        let temperatures = [temperature(&states.temperature, i), temperature(&states.opposite, i)];
        PointAtState { contact: &contacts[point.contact], point, state: &states.states[i], temperatures }
            .linearised(has_heat)
    }))
}
