//! The laws of contact at one point, linearised, the multipliers eliminated.

use super::STIFF;
use super::frame::{PointDerivative, PointState};
use super::friction::{Friction, Shape, Slip, Tangential};
use super::interface::{Local, LocalTangent, Row};
use super::normal::{Approach, Normal, Response};
use crate::contact::{Bound, Contact, ContactPoint, GraphKind, NormalLaw, Status};
use crate::tensor::{Point, dot, length};
use crate::time::Rule;

/// Least stiffness of a point over ρ: a few iterations more, however unlike the parts are.
const LEAST_STIFF: f64 = 1024.0;

/// The multipliers of one point.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Multiplier {
    /// Pressure in Pa, and q in Pa along the tangents.
    pub p: f64,
    pub q: Tangential,
    /// True if the point stuck at the last iterate: the branch of a bound that drops when slip starts.
    pub sticks: bool,
}

/// Data of a point that are known before the laws are evaluated.
pub(super) struct Site<'a> {
    pub contact: &'a Contact,
    pub row: &'a Row,
    pub x: Point,
    /// The law of the pressure in this step, and the penetration at its start, m.
    pub normal: &'a dyn NormalLaw,
    pub start: f64,
    /// The rule in time.
    pub rule: Rule,
    pub response: Response,
    /// ρ of friction in Pa s/m, and how friction is taken.
    pub rho: f64,
    pub slip: Slip,
    /// Stiffness of a point that sticks, or lies on a rigid foundation, over ρ.
    pub stiff: f64,
    /// True if slip has two directions, and true if the foundation slides in a direction in which the body does not
    /// move.
    pub in_space: bool,
    pub slides_out: bool,
    /// Tangents along which there is no friction.
    pub held: [bool; 2],
    /// Opening of the gap per depth worn off.
    pub opening: f64,
    /// Slip velocity of the law over that of [`Kinematics`]: 1, or 1/ϑ if friction follows the end of the step.
    pub slip_share: f64,
}

/// Kinematics of a point at an iterate.
pub(super) struct Kinematics {
    /// r but for what wears off in the step, m, and its rate where the law presses, min(ṙ, r/γ) in m/s.
    pub penetration: f64,
    pub rate: f64,
    /// r at the start of the step, m.
    pub start: f64,
    /// w_τ − v_F − b in m/s.
    pub slip: Tangential,
    /// θ of the body in K.
    pub temperature: f64,
}

/// Wear in the step: the depth is k κ ‖w_τ‖ p₊, and the gap opens by a fraction c of it.
#[derive(Clone, Copy, Debug, Default)]
struct Wear {
    /// k κ; c k κ, and its derivative in the temperature.
    depth: f64,
    rate: f64,
    by_temperature: f64,
}

/// Slopes of the bound s and of the pressure beyond those of [`Normal`].
#[derive(Clone, Copy, Debug, Default)]
struct Slopes {
    /// Slopes of s in w_ν and in ‖w_τ‖, and the change of s with the pressure that the linearised graph has at δw = 0.
    bound_by_normal: f64,
    bound_by_speed: f64,
    bound_change: f64,
    /// Slope of the pressure in ‖w_τ‖, and the fraction of it that the bound follows.
    pressure_by_speed: f64,
    follows: f64,
    /// Slopes in the temperature: of s at fixed pressure, and of the pressure.
    bound_by_temperature: f64,
    pressure_by_temperature: f64,
}

/// The laws at a point and an iterate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Laws {
    pub normal: Normal,
    pub friction: Friction,
    /// r at the end of the step and at the time of its equations, with the wear of the step, m.
    pub penetration: f64,
    pub at_level: f64,
    /// Depth that wears off in the step, and by how much the gap opens by it, m.
    pub worn: f64,
    pub opened: f64,
    pub status: Status,
    /// True if the point is on the branch of sticking; without a bound, unchanged.
    pub sticks: bool,
    wear: Wear,
    slopes: Slopes,
    held: [bool; 2],
}

impl Site<'_> {
    /// True if there is no friction along any tangent in which the point can slip.
    fn is_smooth(&self) -> bool {
        self.held[0] && (self.held[1] || !self.in_space && !self.slides_out)
    }

    /// Treatment of friction at the point: if a component of the slip is prescribed, the slip is never zero and (2.9)
    /// is smooth.
    fn how(&self) -> Slip {
        match self.slip {
            Slip::Exact if self.slides_out => Slip::Smooth { speed: 0.0 },
            how => how,
        }
    }
}

impl Laws {
    /// The laws at a point.
    pub fn new(site: &Site, at: &Kinematics, multiplier: &Multiplier) -> Laws {
        let contact = site.contact;
        let speed = at.slip[0].hypot(at.slip[1]);
        let seen = ContactPoint {
            x: site.x,
            penetration: at.penetration,
            temperature: at.temperature,
            ..ContactPoint::default()
        };
        let wear = contact.wear.as_ref().map_or_else(Wear::default, |law| {
            let depth = site.rule.span * law.coefficient(&seen);
            let by_temperature = site.opening * site.rule.span * law.by_temperature(&seen);
            Wear { depth, rate: site.opening * depth, by_temperature }
        });
        let by_wear = wear.rate * speed;
        let approach = Approach {
            law: site.normal,
            x: &site.x,
            length: site.rule.span,
            response: site.response,
            penetration: at.penetration,
            rate: at.rate,
            by_wear,
            stiff: site.stiff,
        };
        let normal = Normal::new(&approach, multiplier.p);
        let (load, sign) = load(contact.normal.graph(), normal.pressed);
        let pressing = normal.pressure.max(0.0);
        let (worn, opened) = (wear.depth * speed * pressing, by_wear * pressing);
        let penetration = at.penetration - opened;
        let at_level = site.rule.between([site.start, penetration]);
        let seen = ContactPoint {
            penetration,
            pressure: load,
            slip_speed: if multiplier.sticks { 0.0 } else { site.slip_share * speed },
            ..seen
        };
        let s = if site.is_smooth() { Bound::default() } else { contact.friction.bound(&seen) };
        let [nu, t1, t2] = &site.row.basis;
        let shape = contact.friction.cone(&site.x, nu).map(|cone| Shape::new(&cone, [t1, t2]));
        let mut friction = Friction::new(multiplier.q, at.slip, site.rho, s.value, shape, site.how());
        friction.stiff = site.stiff;
        let status = match (s.value > 0.0, friction.sticks) {
            (true, true) => Status::Stick,
            (true, false) => Status::Slip,
            (false, _) if normal.pressed == 0.0 => Status::Open,
            (false, _) => Status::Slip,
        };
        // With p ∈ G(z − (λ + λ_w) p): ∂p/∂λ_w = −p ∂p/∂z. At a point that sticks the slip is round-off and has no
        // direction.
        let by_depth = if friction.sticks { 0.0 } else { -normal.pressed.max(0.0) * normal.by_depth / normal.yielding };
        // δp = s k δw_ν, or for a graph δp = (s k δw_ν + J − p)/(1 − λ s); the bound follows p + δp.
        let follows = sign * s.by_pressure;
        let slopes = Slopes {
            bound_by_normal: site.rule.span * s.by_penetration + follows * normal.stiffness(),
            bound_by_speed: site.slip_share * s.by_slip_speed,
            bound_change: follows * (normal.pressed - normal.pressure) * (normal.yielding.recip() - 1.0),
            pressure_by_speed: wear.rate * by_depth,
            follows,
            bound_by_temperature: s.by_temperature,
            pressure_by_temperature: wear.by_temperature * speed * by_depth,
        };
        let sticks = if s.value > 0.0 { friction.sticks } else { multiplier.sticks };
        Laws { normal, friction, penetration, at_level, worn, opened, status, sticks, wear, slopes, held: site.held }
    }

    /// Takes the point as sticking.
    pub fn hold(&mut self) {
        if self.friction.bound > 0.0 {
            (self.friction.sticks, self.sticks, self.status) = (true, true, Status::Stick);
        }
    }

    /// The force p ν + q on the foundation by its components.
    pub fn force(&self) -> Local {
        [self.normal.pressure, self.friction.q[0], self.friction.q[1]]
    }

    /// Force by the laws, which is the force at a solution: the pressure on the graph, and q + ρ w_τ projected onto the
    /// cone.
    pub fn projected(&self) -> Local {
        [self.normal.pressed, self.friction.projected[0], self.friction.projected[1]]
    }

    /// The force of the linearised laws at an unchanged velocity and its derivative in the velocity, d the dimension.
    pub fn linear(&self, dim: usize) -> (Local, LocalTangent) {
        let (mut force, mut tangent) = ([self.normal.linear(), 0.0, 0.0], [[0.0; 3]; 3]);
        tangent[0][0] = self.normal.stiffness();
        let along = self.friction.along();
        for b in 0..2 {
            tangent[0][b + 1] = self.slopes.pressure_by_speed * along[b];
        }
        if self.friction.bound > 0.0 {
            let (q, by_slip) = self.friction.linear(self.slopes.bound_change, dim > 2);
            let n = self.friction.direction();
            let in_speed = self.slopes.bound_by_speed + self.slopes.follows * self.slopes.pressure_by_speed;
            for a in 0..2 {
                force[a + 1] = q[a];
                tangent[a + 1][0] = n[a] * self.slopes.bound_by_normal;
                for b in 0..2 {
                    tangent[a + 1][b + 1] = by_slip[a][b] + n[a] * in_speed * along[b];
                }
            }
        }
        for a in (0..2).filter(|&a| self.held[a]).map(|a| a + 1) {
            force[a] = 0.0;
            for b in 0..3 {
                (tangent[a][b], tangent[b][a]) = (0.0, 0.0);
            }
        }
        (force, tangent)
    }

    /// The derivatives at a solution of the step.
    pub fn derivative(&self, row: &Row, dim: usize) -> PointDerivative {
        let (_, tangent) = self.linear(dim);
        let (n, slopes) = (self.friction.direction(), &self.slopes);
        let in_bound = slopes.bound_by_temperature + slopes.follows * slopes.pressure_by_temperature;
        let by_temperature = [slopes.pressure_by_temperature, in_bound * n[0], in_bound * n[1]];
        let speed = self.friction.speed();
        let (mut wear, mut wear_by_temperature) = ([0.0; 3], 0.0);
        if self.normal.pressure > 0.0 && self.status == Status::Slip && speed > 0.0 {
            // Derivative of c k κ ‖w_τ‖ p.
            let along = self.friction.along();
            let in_slip = [0.0, self.normal.pressure * along[0], self.normal.pressure * along[1]];
            wear = std::array::from_fn(|e| self.wear.rate * (in_slip[e] + speed * tangent[0][e]));
            wear_by_temperature = self.wear.by_temperature * speed * self.normal.pressure
                + self.wear.rate * speed * slopes.pressure_by_temperature;
        }
        PointDerivative {
            force: row.global_tangent(&tangent),
            force_by_temperature: row.global(&by_temperature),
            wear: row.global(&wear),
            wear_by_temperature,
        }
    }

    /// The state of the point.
    pub fn state(&self, row: &Row) -> PointState {
        PointState {
            normal: row.basis[0],
            penetration: self.penetration,
            at_level: self.at_level,
            pressure: self.normal.pressure,
            bound: self.friction.bound,
            q: row.tangential(&self.friction.q),
            slip: row.tangential(&self.friction.slip),
            wear: self.worn,
            opened: self.opened,
            status: self.status,
        }
    }
}

/// The pressure that friction sees and its sign. Friction does not know tension, but where contact is bilateral.
fn load(graph: GraphKind, pressed: f64) -> (f64, f64) {
    match graph {
        GraphKind::Bilateral => (pressed.abs(), pressed.signum()),
        _ if pressed > 0.0 => (pressed, 1.0),
        _ => (0.0, 0.0),
    }
}

/// Stiffness of a point that sticks over ρ where rigid motions of stiff parts are held by soft ones. The round-off of
/// stiff points is ε times their stiffness, and has to be as far below that of the soft parts as these are below their
/// own points: κ the ratio of the largest and the least ρ, that is 2/√(ε κ), 2²⁷ where all are alike.
pub(super) fn stiff_beside(rho: &[f64]) -> f64 {
    let some = || rho.iter().copied().filter(|rho| *rho > 0.0);
    let (least, most) = (some().fold(f64::INFINITY, f64::min), some().fold(0.0, f64::max));
    let ratio = if most > least { most / least } else { 1.0 };
    (2.0 / (f64::EPSILON * ratio).sqrt()).clamp(LEAST_STIFF, STIFF)
}

/// Least length of the vectors between two: where slip turns round it stops in between.
pub(super) fn slowest(from: &Point, to: &Point) -> f64 {
    let change: Point = std::array::from_fn(|c| to[c] - from[c]);
    let squared = dot(&change, &change);
    let part = if squared > 0.0 { (-dot(from, &change) / squared).clamp(0.0, 1.0) } else { 0.0 };
    length(&std::array::from_fn(|c| from[c] + part * change[c]))
}
