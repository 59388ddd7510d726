//! The equations of the contact points of a solved step, with all that the iteration chose frozen.

use super::heat::HeatStep;
use super::interface::{Local, LocalTangent};
use super::mechanical::Mechanical;
use super::normal::Response;
use super::point::Multiplier;
use crate::arrays::per_point;
use crate::contact::arrays;
use crate::linalg::{Condensed, Tangent};
use crate::tensor::Point;

/// What the iteration on Γ_C chose at each point besides its unknowns: ρ in Pa s/m, and how the pressure is found. The
/// solution does not depend on it.
#[derive(Clone, Debug, Default)]
pub struct Chosen {
    rho: Vec<f64>,
    response: Vec<Response>,
}

/// What the equations of a contact point depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointInput {
    /// Jump of the velocities in the basis of the point, m/s.
    pub velocity: Local,
    /// (p, q) in the basis of the point, Pa.
    pub force: Local,
    /// ū_ν − g in m.
    pub opening: f64,
    /// Temperature of the body in K.
    pub temperature: f64,
    /// True if the point sticks at the solution, for bounds that drop when slip starts.
    pub sticks: bool,
}

/// The equations of a contact point and what else follows from their unknowns.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PointOutput {
    /// (p, q) minus its projection by the laws, Pa: zero at a solution.
    pub defect: Local,
    /// Penetration r in m.
    pub penetration: f64,
    /// r at the time of the equations, by which heat flows, m.
    pub at_level: f64,
    /// Slip velocity along the tangents, m/s.
    pub slip: [f64; 2],
    /// Depth that wears off in the step, m.
    pub worn: f64,
    /// Bound of friction, Pa.
    pub bound: f64,
    /// True if the point presses or pulls, and true if it sticks.
    pub branch: [bool; 2],
}

impl Chosen {
    /// ρ of each point, Pa s/m.
    #[must_use]
    pub fn rho(&self) -> &[f64] {
        &self.rho
    }
}

impl Mechanical<'_> {
    /// What was chosen in this term.
    #[must_use]
    pub fn chosen(&self) -> Chosen {
        Chosen { rho: self.rho.clone(), response: self.response.clone() }
    }

    /// This term with what was chosen in another one.
    #[must_use]
    pub fn frozen(mut self, chosen: &Chosen) -> Self {
        self.rho.clone_from(&chosen.rho);
        self.response.clone_from(&chosen.response);
        self
    }

    /// ν, t₁ and t₂ of a point.
    #[must_use]
    pub fn basis(&self, i: usize) -> [Point; 3] {
        self.interface.rows[i].basis
    }

    /// ū_ν − g at a point, m.
    #[must_use]
    pub fn distance(&self, i: usize) -> f64 {
        self.opening(i)
    }

    /// True if friction may act along each tangent of a point.
    #[must_use]
    pub fn rubs_along(&self, i: usize) -> [bool; 2] {
        let held = self.held(i);
        let moves = |a: usize| a + 1 < self.step.dim || self.slides_out(i);
        [0, 1].map(|a| !held[a] && moves(a))
    }

    /// True if no unknown moves a point whose pressure is a multiplier: it exerts no force.
    #[must_use]
    pub fn is_given(&self, i: usize) -> bool {
        self.response[i] == Response::Given
    }

    /// The equations of a point. Along tangents without friction q is zero, and where nothing is unknown the force is
    /// as it is.
    #[must_use]
    pub fn equations(&self, i: usize, at: &PointInput) -> PointOutput {
        let kinematics = self.kinematics_of(i, at.velocity, [at.opening, at.temperature]);
        let [p, q1, q2] = at.force;
        let multiplier = Multiplier { p, q: [q1, q2], sticks: at.sticks };
        let laws = self.laws_of(i, &kinematics, &multiplier, self.response[i]);
        // Where the foundation slides out of the plane, the law determines q without ρ.
        let is_free = self.rho[i] > 0.0 || self.slides_out(i);
        let (projected, rubs, is_given) = (laws.projected(), self.rubs_along(i), self.is_given(i));
        let along = |a: usize| at.force[a] - if is_free && rubs[a - 1] { projected[a] } else { 0.0 };
        PointOutput {
            defect: [if is_given { p } else { p - projected[0] }, along(1), along(2)],
            penetration: laws.penetration,
            at_level: laws.at_level,
            slip: laws.friction.slip,
            worn: laws.worn,
            bound: laws.friction.bound,
            branch: [laws.normal.pressed != 0.0, laws.friction.sticks],
        }
    }

    /// Σ ω Nᵀ T N of slopes T of the points, in the bases that the condensed system then has.
    pub fn sum_of_slopes(&self, condensed: &mut dyn Condensed, slopes: &[LocalTangent]) -> Tangent {
        condensed.turn(&self.interface.turns);
        let mut sum = self.interface.empty_tangent();
        for (i, slope) in slopes.iter().enumerate() {
            self.interface.add_tangent(i, slope, &mut sum);
        }
        sum
    }
}

impl HeatStep<'_> {
    /// Per point what leaves the side that bears it and what enters the other side of a pair, at nodal temperatures,
    /// W/m².
    #[must_use]
    pub fn sides_at(&self, theta: &[f64]) -> Vec<[f64; 2]> {
        let boundary = self.boundary;
        let at = |nodes: &[(usize, f64)]| -> f64 {
            nodes.iter().map(|&(node, value)| value * theta[boundary.nodes[node] as usize]).sum()
        };
        let of = |i: usize| {
            let (own, other) = boundary.points[i].nodes.split_at(boundary.points[i].own);
            let opposite = if other.is_empty() { self.foundation[i] } else { 0.0 - at(other) };
            let flux = self.flux(i, at(own), opposite).value;
            [flux, flux + self.rubbed(i)]
        };
        per_point(&arrays(self.contacts), boundary.points.len(), of)
    }
}
