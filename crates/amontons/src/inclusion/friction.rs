//! (2.9) at one contact point: q = Π(q + ρ w_τ) onto the friction cone, linearised, in d − 1 tangential components.

use super::STIFF;
use crate::contact::Cone;

/// A tangential vector by its components along t₁ and t₂.
pub(super) type Tangential = [f64; 2];

/// The factor D of a cone that is not round and its inverse, in the tangent basis: ‖D⁻¹ q‖ ≤ s. None for a round cone.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    factor: [Tangential; 2],
    inverse: [Tangential; 2],
}

impl Shape {
    /// The cone in the basis of a contact point.
    pub fn new(cone: &Cone, tangents: [&crate::tensor::Point; 2]) -> Shape {
        let of = |map: &dyn Fn(&crate::tensor::Point) -> crate::tensor::Point| {
            std::array::from_fn(|a| std::array::from_fn(|b| crate::tensor::dot(tangents[a], &map(tangents[b]))))
        };
        Shape { factor: of(&|v| cone.apply(v)), inverse: of(&|v| cone.inverse(v)) }
    }
}

fn map(matrix: &[Tangential; 2], v: &Tangential) -> Tangential {
    std::array::from_fn(|a| matrix[a][0] * v[0] + matrix[a][1] * v[1])
}

/// Treatment of friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Slip {
    /// As it is: q is a multiplier.
    Exact,
    /// q √(‖w_τ‖² + ε²) = s w_τ, which is smooth and, where the step has one solution, keeps it unique.
    Smooth {
        /// ε in m/s; 0 where the slip has a part that is prescribed and differs from 0.
        speed: f64,
    },
}

/// Friction at an iterate. In q̃ = D⁻¹ q and w̃ = D w_τ the cone is round; with a round cone these are q and w_τ.
#[derive(Clone, Copy, Debug)]
pub(super) struct Friction {
    /// q, the multiplier, Pa.
    pub q: Tangential,
    /// w_τ − v_F in m/s.
    pub slip: Tangential,
    /// Bound s in Pa.
    pub bound: f64,
    /// True if q̃ + ρ w̃ lies inside the cone.
    pub sticks: bool,
    /// Π(q + ρ w_τ), which is q at a solution.
    pub projected: Tangential,
    rho: f64,
    /// q̃ + ρ w̃ and its length; w̃ and √(‖w̃‖² + ε²) where friction is smooth.
    z: Tangential,
    z_length: f64,
    is_smooth: bool,
    shape: Option<Shape>,
    /// Stiffness of a point that sticks over ρ.
    pub stiff: f64,
}

impl Friction {
    /// Projects onto the cone with the bound s.
    pub fn new(q: Tangential, slip: Tangential, rho: f64, bound: f64, shape: Option<Shape>, how: Slip) -> Friction {
        if let Slip::Smooth { speed } = how {
            let z = shape.map_or(slip, |s| map(&s.factor, &slip));
            let z_length = z[0].hypot(z[1]).hypot(speed);
            let round = z.map(|c| c * (bound / z_length));
            let projected = shape.map_or(round, |s| map(&s.factor, &round));
            return Friction {
                q,
                slip,
                bound,
                sticks: false,
                projected,
                rho,
                z,
                z_length,
                is_smooth: true,
                shape,
                stiff: STIFF,
            };
        }
        let (round_q, round_slip) = shape.map_or((q, slip), |s| (map(&s.inverse, &q), map(&s.factor, &slip)));
        let z: Tangential = std::array::from_fn(|a| round_q[a] + rho * round_slip[a]);
        let z_length = z[0].hypot(z[1]);
        let sticks = z_length <= bound;
        let round = if sticks { z } else { z.map(|c| c * (bound / z_length)) };
        let projected = shape.map_or(round, |s| map(&s.factor, &round));
        Friction { q, slip, bound, sticks, projected, rho, z, z_length, is_smooth: false, shape, stiff: STIFF }
    }

    /// Slip speed ‖w_τ − v_F‖ in m/s.
    pub fn speed(&self) -> f64 {
        self.slip[0].hypot(self.slip[1])
    }

    /// ‖D⁻¹ q‖ in Pa, at most the bound.
    pub fn size(&self) -> f64 {
        let [a, b] = self.shape.map_or(self.q, |s| map(&s.inverse, &self.q));
        a.hypot(b)
    }

    /// The direction of slip; none at rest.
    pub fn along(&self) -> Tangential {
        let speed = self.speed();
        if speed > 0.0 { self.slip.map(|c| c / speed) } else { [0.0; 2] }
    }

    /// The direction in which the bound acts on q: D z/‖z‖ where the point slips.
    pub fn direction(&self) -> Tangential {
        if self.sticks || self.bound <= 0.0 {
            return [0.0; 2];
        }
        let n = self.z.map(|c| c / self.z_length);
        self.shape.map_or(n, |s| map(&s.factor, &n))
    }

    /// q of the linearised law at an unchanged velocity, and its derivative in the slip at a fixed bound. `change` is
    /// what the linearised normal law adds to the bound, `in_space` says that slip has more than one direction.
    ///
    /// A point that sticks is held by the stiffness 2²⁷ ρ that starts from the multiplier of the last iterate, exact in
    /// the limit. Across the direction n of slip the projection turns: δq = s/‖z‖ (δq + ρ δw) is solved for δq.
    pub fn linear(&self, change: f64, in_space: bool) -> (Tangential, [Tangential; 2]) {
        let (q, slip) =
            self.shape.map_or((self.q, self.slip), |s| (map(&s.inverse, &self.q), map(&s.factor, &self.slip)));
        let (mut force, mut tangent) = ([0.0; 2], [[0.0; 2]; 2]);
        if self.is_smooth {
            // Derivative of q √(‖w̃‖² + ε²) = s w̃ in q and w̃ (Chan, Golub and Mulet, SIAM J. Sci. Comput. 20 (1999)
            // 1964), symmetric and with ‖q‖ ≤ s. The derivative of q = s w̃/√(…) in w̃ alone does not contain q, and
            // Newton's method cycles with it.
            let n = self.z.map(|c| c / self.z_length);
            let within = q[0].hypot(q[1]).max(self.bound);
            let dual = q.map(|q| q / within);
            for a in 0..2 {
                force[a] = (self.bound + change) * n[a];
                for b in 0..2 {
                    let turn = 0.5 * (dual[a] * n[b] + n[a] * dual[b]);
                    tangent[a][b] = self.bound / self.z_length * (f64::from(u8::from(a == b)) - turn);
                }
            }
        } else if self.sticks {
            let stiffness = self.stiff * self.rho;
            for a in 0..2 {
                force[a] = q[a] + stiffness * slip[a];
                tangent[a][a] = stiffness;
            }
        } else {
            // Across n, with Π = s n: q = s/(‖z‖ − s) (ρ δw − q). A point that hardly slips turns as stiffly as one
            // that sticks is held. Along n nothing is added: the round-off of q would be s/(‖z‖ − s) times as large
            // there.
            let n = self.z.map(|c| c / self.z_length);
            let m = [-n[1], n[0]];
            let turn = (self.bound / (self.z_length - self.bound)).min(self.stiff);
            let across = q[0] * m[0] + q[1] * m[1];
            for a in 0..2 {
                force[a] = (self.bound + change) * n[a];
                if in_space {
                    force[a] -= turn * across * m[a];
                    for b in 0..2 {
                        tangent[a][b] = turn * self.rho * m[a] * m[b];
                    }
                }
            }
        }
        let Some(shape) = &self.shape else { return (force, tangent) };
        // D T D: rows, then columns; D is symmetric.
        let columns: [Tangential; 2] = tangent.map(|row| map(&shape.factor, &row));
        let rows: [Tangential; 2] = std::array::from_fn(|a| {
            std::array::from_fn(|b| shape.factor[a][0] * columns[0][b] + shape.factor[a][1] * columns[1][b])
        });
        (map(&shape.factor, &force), rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// However slowly a point slips, and in whatever direction, the linearised law keeps q at the bound along the slip
    /// to the last bits, and a consistent state in its place.
    #[test]
    fn a_point_that_hardly_slips_keeps_the_bound() {
        let (bound, rho) = (5.9e6, 2.6e12);
        for k in 0..200 {
            let (angle, beyond) = (0.1 + 0.37 * f64::from(k), bound * 10f64.powf(-f64::from(k % 40) / 3.0));
            let direction = [angle.cos(), angle.sin()];
            let (q, slip) = (direction.map(|c| bound * c), direction.map(|c| beyond / rho * c));
            let friction = Friction::new(q, slip, rho, bound, None, Slip::Exact);
            let (force, tangent) = friction.linear(0.0, true);
            let n = friction.direction();
            if friction.sticks {
                continue;
            }
            let along = force[0] * n[0] + force[1] * n[1];
            assert!((along - bound).abs() <= 4.0 * f64::EPSILON * bound, "{along:e} for {bound:e}, {beyond:e} beyond");
            // The remaining component across is cancelled by a rotation within the round-off of the bound.
            let across = force[1] * n[0] - force[0] * n[1];
            let stiffness = tangent[0][0] + tangent[1][1];
            assert!(across.abs() <= 4.0 * f64::EPSILON * stiffness / rho * bound, "{across:e}, {beyond:e} beyond");
        }
    }
}
