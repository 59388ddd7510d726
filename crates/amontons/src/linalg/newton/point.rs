//! The laws at one contact point, linearised, the multipliers eliminated.

use crate::contact::{Bound, Cone, Contact, ContactPoint, GraphKind, PointOnBoundary, Pressure, Status, worn};
use crate::tensor::{Point, dot, length};

/// Stiffness of a point that sticks, or lies on a rigid foundation, over ρ. The error of one iteration is of the order of its inverse and
/// vanishes with the iterations, because each starts from the multiplier of the one before.
const STICK: f64 = (1u64 << 27) as f64;

/// What the foundation is at one contact point in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frame {
    /// Unit normal ν of the contact, towards the foundation: that of the body, or the opposite of the normal of the obstacle.
    pub normal: Point,
    /// g(t_n) in m, with what has worn off before the step.
    pub gap: f64,
    /// Mean rate of g in the step but for wear, m/s.
    pub gap_rate: f64,
    /// v_F(t_n) in m/s, tangential.
    pub velocity: Point,
}

/// State of one contact point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointState {
    /// Unit normal ν of the contact, towards the foundation.
    pub normal: Point,
    /// Penetration r = u_ν − g in m.
    pub penetration: f64,
    /// Pressure p in Pa.
    pub pressure: f64,
    /// Friction bound s in Pa.
    pub bound: f64,
    /// q = −σ_τ in Pa.
    pub q: Point,
    /// Slip velocity w_τ − v_F in m/s.
    pub slip: Point,
    /// Depth that wears off in the step, m.
    pub wear: f64,
    /// Open, stick or slip.
    pub status: Status,
}

/// Derivative of the force p ν + q on the foundation in the velocity at a contact point, Pa s/m, rows the force.
pub type PointTangent = [[f64; 3]; 3];

/// Derivatives at a contact point, the multipliers eliminated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PointDerivative {
    /// Of the force p ν + q in the velocity.
    pub force: PointTangent,
    /// Of the force in the temperature of the body, Pa/K.
    pub force_by_temperature: Point,
    /// Of the depth that wears off in the step in the velocity, s.
    pub wear: Point,
    /// Of that depth in the temperature, m/K.
    pub wear_by_temperature: f64,
}

/// The multipliers of one point.
#[derive(Clone, Copy)]
pub(super) struct Multiplier {
    pub p: f64,
    pub q: Point,
    /// Whether it stuck at the last iterate: which branch it is on where the bound drops when slip starts.
    pub sticks: bool,
}

/// What moves a point: its kinematics at an iterate.
pub(super) struct Kinematics {
    /// ν.
    pub normal: Point,
    /// r but for what wears off in the step, m, and the rate of r₊ in m/s.
    pub penetration: f64,
    pub rate: f64,
    /// w_τ − v_F in m/s.
    pub slip: Point,
    /// θ of the body in K.
    pub temperature: f64,
}

/// A point with the state that its law sees and its linearisation.
pub(super) struct Local {
    pub state: PointState,
    /// Whether it is on the branch of sticking; without a bound, as it was.
    pub sticks: bool,
    /// The pressure that the normal law gives: p itself for a function, J = p_ν(r + λp) for a graph.
    pub pressed: f64,
    /// Slope of the pressure in w_ν.
    pub p_slope: f64,
    /// 1 − λ dJ/dz of a graph, but not zero; 1 for a function.
    yielding: f64,
    /// Derivatives of s with respect to w_ν and ‖w_τ‖, and its change with the pressure that the linearised graph has at δw = 0.
    s_normal: f64,
    s_speed: f64,
    s_change: f64,
    /// Derivative of the pressure with respect to ‖w_τ‖, and what of it the bound follows.
    p_speed: f64,
    follows: f64,
    /// Derivatives of s at fixed pressure and of the pressure with respect to the temperature.
    s_theta: f64,
    p_theta: f64,
    /// k κ, and k times its derivative in the temperature.
    wear_rate: [f64; 2],
    /// z = q + ρ w_τ, scaled where the cone is not round, and the projection of q + ρ w_τ onto the cone.
    z: Point,
    pub projected: Point,
    cone: Option<Cone>,
}

impl Local {
    /// The laws at a point in the time step k. Without ρ the multipliers are taken as they are.
    pub fn new(contact: &Contact, point: &PointOnBoundary, k: f64, at: &Kinematics, multiplier: &Multiplier, rho: f64) -> Local {
        let graph = contact.normal.graph();
        let lambda = if graph == GraphKind::Function { 0.0 } else { k / rho };
        let speed = length(&at.slip);
        let seen = ContactPoint { x: point.x, penetration: at.penetration, temperature: at.temperature, ..ContactPoint::default() };
        // What wears off makes the contact softer: λ_w p₊ = k κ ‖w_τ‖ p₊ is the depth.
        let wear_rate = contact.wear.as_ref().map_or([0.0; 2], |law| [k * law.coefficient(&seen), k * law.by_temperature(&seen)]);
        let wear_by_speed = wear_rate[0];
        let by_wear = wear_by_speed * speed;
        let Pressure { value: pressed, slope, by_rate } = if graph == GraphKind::Function || rho > 0.0 {
            let z = at.penetration + if lambda > 0.0 { lambda * multiplier.p } else { 0.0 };
            worn(contact.normal.as_ref(), &point.x, z, at.rate, [lambda, by_wear])
        } else {
            Pressure { value: multiplier.p, ..Pressure::default() }
        };
        let p_slope = k * slope + if at.penetration > 0.0 { by_rate } else { 0.0 };
        // Friction does not know tension, but where contact is bilateral.
        let (load, sign) = match graph {
            GraphKind::Bilateral => (pressed.abs(), pressed.signum()),
            _ if pressed > 0.0 => (pressed, 1.0),
            _ => (0.0, 0.0),
        };
        let pressure = if graph == GraphKind::Function { pressed } else { multiplier.p };
        let wear = by_wear * pressure.max(0.0);
        let penetration = at.penetration - wear;
        let seen = ContactPoint { penetration, pressure: load, slip_speed: if multiplier.sticks { 0.0 } else { speed }, ..seen };
        let s: Bound = contact.friction.bound(&seen);
        let cone = contact.friction.cone(&point.x, &at.normal);
        let q = &multiplier.q;
        let z: Point = match &cone {
            None => std::array::from_fn(|c| q[c] + rho * at.slip[c]),
            Some(cone) => {
                let (q, slip) = (cone.inverse(q), cone.apply(&at.slip));
                std::array::from_fn(|c| q[c] + rho * slip[c])
            }
        };
        let z_length = length(&z);
        let sticks = z_length <= s.value;
        let projected = if sticks { z } else { z.map(|c| c * (s.value / z_length)) };
        let status = match (s.value > 0.0, sticks) {
            (true, true) => Status::Stick,
            (true, false) => Status::Slip,
            (false, _) if pressed == 0.0 => Status::Open,
            (false, _) => Status::Slip,
        };
        // δp = s k δw_ν, or for a graph δp = (s k δw_ν + J − p)/(1 − λ s); s follows p + δp.
        let yielding = (1.0 - slope * lambda).max(STICK.recip());
        // With p ∈ G(z − (λ + λ_w) p): ∂p/∂λ_w = −p ∂p/∂z. At a point that sticks the slip is round-off and has no direction.
        let by_depth = if sticks { 0.0 } else { -pressed.max(0.0) * slope / yielding };
        let follows = sign * s.by_pressure;
        Local {
            state: PointState { normal: at.normal, penetration, pressure, bound: s.value, q: *q, slip: at.slip, wear, status },
            sticks: if s.value > 0.0 { sticks } else { multiplier.sticks },
            pressed,
            p_slope,
            yielding,
            s_normal: k * s.by_penetration + follows * p_slope / yielding,
            s_speed: s.by_slip_speed,
            s_change: follows * (pressed - pressure) * (yielding.recip() - 1.0),
            p_speed: wear_by_speed * by_depth,
            follows,
            s_theta: s.by_temperature,
            p_theta: wear_rate[1] * speed * by_depth,
            wear_rate,
            z,
            projected: cone.map_or(projected, |cone| cone.apply(&projected)),
            cone,
        }
    }

    /// Force p ν + q on the foundation and its derivative in the velocity, laws linearised.
    pub fn linear(&self, rho: f64, dim: usize) -> (Point, PointTangent) {
        let state = &self.state;
        let nu = &state.normal;
        let pressure = state.pressure + (self.pressed - state.pressure) / self.yielding;
        let stiffness = self.p_slope / self.yielding;
        let mut force: Point = std::array::from_fn(|c| pressure * nu[c]);
        let mut tangent = [[0.0; 3]; 3];
        for c in 0..dim {
            for e in 0..dim {
                tangent[c][e] = stiffness * nu[c] * nu[e];
            }
        }
        let speed = length(&state.slip);
        if self.p_speed != 0.0 && speed > 0.0 {
            for c in 0..dim {
                for e in 0..dim {
                    tangent[c][e] += self.p_speed * nu[c] * state.slip[e] / speed;
                }
            }
        }
        if state.bound > 0.0 {
            let (q, friction) = self.friction(nu, rho, dim);
            for c in 0..dim {
                force[c] += q[c];
                for e in 0..dim {
                    tangent[c][e] += friction[c][e];
                }
            }
        }
        (force, tangent)
    }

    /// The direction in which the bound acts: that of slip, and none where the point sticks.
    fn direction(&self) -> Point {
        if self.state.status != Status::Slip || self.state.bound <= 0.0 {
            return [0.0; 3];
        }
        let z_length = length(&self.z);
        let n = self.z.map(|c| c / z_length);
        self.cone.map_or(n, |cone| cone.apply(&n))
    }

    /// The derivatives at a solution of the step.
    pub fn derivative(&self, rho: f64, dim: usize) -> PointDerivative {
        let force = self.linear(rho, dim).1;
        let (state, n) = (&self.state, self.direction());
        let in_bound = self.s_theta + self.follows * self.p_theta;
        let force_by_temperature = std::array::from_fn(|c| self.p_theta * state.normal[c] + in_bound * n[c]);
        let speed = length(&state.slip);
        let (mut wear, mut wear_by_temperature) = ([0.0; 3], 0.0);
        if state.pressure > 0.0 && state.status == Status::Slip && speed > 0.0 {
            // That of k κ ‖w_τ‖ p.
            let [rate, by_temperature] = self.wear_rate;
            for (e, wear) in wear.iter_mut().enumerate() {
                let pressure: f64 = (0..3).map(|c| state.normal[c] * force[c][e]).sum();
                *wear = rate * (state.pressure * state.slip[e] / speed + speed * pressure);
            }
            wear_by_temperature = by_temperature * speed * state.pressure + rate * speed * self.p_theta;
        }
        PointDerivative { force, force_by_temperature, wear, wear_by_temperature }
    }

    /// q of the linearised law and its derivative in the velocity. With the cone D, all but the derivatives of s is that of the disc in
    /// q̃ = D⁻¹ q and w̃ = D w_τ.
    fn friction(&self, nu: &Point, rho: f64, dim: usize) -> (Point, PointTangent) {
        let state = &self.state;
        let (q, slip, projected) = match &self.cone {
            None => (state.q, state.slip, self.projected),
            Some(cone) => (cone.inverse(&state.q), cone.apply(&state.slip), cone.inverse(&self.projected)),
        };
        let mut force = [0.0; 3];
        let mut tangent = [[0.0; 3]; 3];
        // The direction in which s acts.
        let mut n = [0.0; 3];
        if state.status == Status::Stick {
            let stiffness = STICK * rho;
            for c in 0..dim {
                force[c] = q[c] + stiffness * slip[c];
                for e in 0..dim {
                    tangent[c][e] = stiffness * (f64::from(u8::from(c == e)) - nu[c] * nu[e]);
                }
            }
        } else {
            let z_length = length(&self.z);
            n = self.z.map(|c| c / z_length);
            // Across n the projection turns: δq = s/‖z‖ (δq + ρ δw) is solved for δq here.
            let turn = (state.bound * rho / (z_length - state.bound)).min(STICK * rho);
            let along = dot(&q, &n);
            for c in 0..dim {
                let across = q[c] - along * n[c];
                let lag = (projected[c] - q[c]) - (state.bound - along) * n[c];
                force[c] = (state.bound + self.s_change) * n[c] + if dim > 2 { across + lag * z_length / (z_length - state.bound) } else { 0.0 };
                if dim > 2 {
                    for e in 0..dim {
                        tangent[c][e] = turn * (f64::from(u8::from(c == e)) - nu[c] * nu[e] - n[c] * n[e]);
                    }
                }
            }
        }
        if let Some(cone) = &self.cone {
            // Rows, then columns.
            let columns: PointTangent = std::array::from_fn(|e| cone.apply(&[tangent[0][e], tangent[1][e], tangent[2][e]]));
            let rows: PointTangent = std::array::from_fn(|c| cone.apply(&[columns[0][c], columns[1][c], columns[2][c]]));
            (force, tangent, n) = (cone.apply(&force), rows, cone.apply(&n));
        }
        let speed = length(&state.slip);
        for c in 0..dim {
            for e in 0..dim {
                let in_speed = if speed > 0.0 { (self.s_speed + self.follows * self.p_speed) * state.slip[e] / speed } else { 0.0 };
                tangent[c][e] += n[c] * (self.s_normal * nu[e] + in_speed);
            }
        }
        (force, tangent)
    }
}
