//! Report of a step.

use std::sync::Arc;

use crate::contact::{ContactBoundary, Flux};
use crate::inclusion::PointState;
use crate::tensor::Point;

/// Report of one step.
#[derive(Clone, Debug)]
pub struct StepReport {
    /// Newton iterations on Γ_C, mechanics.
    pub newton_mechanics: usize,
    /// Newton iterations on Γ_C, heat.
    pub newton_heat: usize,
    /// Number of parts in which the step was made: more than one if it was halved.
    pub parts: usize,
    /// True if softening laws may have several solutions between the previous state and this one, however short the
    /// parts.
    pub is_ambiguous: bool,
    /// Residual of (4.1), (4.2), complementarity and cone, relative to the largest term.
    pub residual: f64,
    /// Coupling of the half-steps.
    pub coupling: CouplingReport,
    /// Undetermined rigid motions, in words. Their least value is computed.
    pub loose: Vec<String>,
    /// Reactions at the prescribed displacements and temperatures.
    pub reactions: Reactions,
    /// Nodal forces set from the outside and those that supports are giving up, N, one per degree of freedom of the
    /// displacement; empty if there are none or the step was made before a break.
    pub forces: Vec<f64>,
    /// The contact points.
    pub contact: ContactReport,
}

impl StepReport {
    /// The report of two consecutive parts of a step.
    pub(crate) fn after(self, first: &StepReport) -> StepReport {
        StepReport {
            newton_mechanics: first.newton_mechanics + self.newton_mechanics,
            newton_heat: first.newton_heat + self.newton_heat,
            parts: first.parts + self.parts,
            is_ambiguous: first.is_ambiguous || self.is_ambiguous,
            residual: first.residual.max(self.residual),
            coupling: CouplingReport {
                passes: first.coupling.passes + self.coupling.passes,
                contraction: [first.coupling.contraction, self.coupling.contraction]
                    .into_iter()
                    .flatten()
                    .reduce(Contraction::max),
                defect: [first.coupling.defect, self.coupling.defect].into_iter().flatten().reduce(f64::max),
            },
            loose: self.loose,
            reactions: self.reactions,
            forces: self.forces,
            contact: self.contact,
        }
    }
}

/// Reactions at prescribed values: remainders of (4.1) and (4.2) tested with the basis functions of the prescribed
/// degrees of freedom, in their order in the spaces V^h and Q^h. Empty for a physics that is not computed.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Reactions {
    /// Forces on the body, N per unit of thickness in two dimensions.
    pub force: Vec<f64>,
    /// Heat supplied to the body, W per unit of thickness in two dimensions.
    pub heat: Vec<f64>,
}

/// Report on the coupling of the half-steps of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CouplingReport {
    /// Passes over both half-steps.
    pub passes: usize,
    /// Observed contraction factors of Φ in fixed-point coupling, or `None` if one pass was enough.
    pub contraction: Option<Contraction>,
    /// Defect of (4.1) with θ_n in m and of (4.2) with u_n in e, relative to their largest terms, or `None` if the
    /// half-steps are staggered.
    pub defect: Option<f64>,
}

/// Contraction factors of the fixed-point coupling within a step: ratios of two consecutive defects.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Contraction {
    /// Geometric mean: the convergence rate of the coupling.
    pub mean: f64,
    /// Largest ratio; above 1 if the contact changes from pass to pass.
    pub largest: f64,
}

impl Contraction {
    /// The larger of both numbers.
    #[must_use]
    pub fn max(self, other: Contraction) -> Contraction {
        Contraction { mean: self.mean.max(other.mean), largest: self.largest.max(other.largest) }
    }
}

/// State of the contact points.
#[derive(Clone, Debug, Default)]
pub struct ContactReport {
    /// Γ_C of the step if pairs are updated, or `None` if it is Γ_C of the bodies at rest or the step was made before a
    /// break.
    pub boundary: Option<Arc<ContactBoundary>>,
    /// Weight ω of each contact point in the step, m^(d−1), which changes if pairs are updated.
    pub weights: Vec<f64>,
    /// Kinematics and tractions.
    pub states: Vec<PointState>,
    /// Temperature of the body at each point, K.
    pub temperature: Vec<f64>,
    /// Temperature opposite each point, K: of the foundation, or of the other body of a pair. Zero if a point of a pair
    /// faces nothing.
    pub opposite: Vec<f64>,
    /// Heat flux q·ν at each point, of the side that bears it.
    pub flux: Vec<Flux>,
    /// Power of friction that enters both bodies of a pair at each point, W/m²; zero at foundations.
    pub rubbed: Vec<f64>,
    /// Resultant of σν on Γ_C, N per unit of thickness in two dimensions.
    pub force: [f64; 3],
    /// Moment of the forces that each contact puts on both its bodies, N m: the defect of the angular momentum, as
    /// their resultant is zero. Zero at foundations.
    pub moments: Vec<Point>,
    /// ∫_{Γ_C} q·ν in W.
    pub heat_flow: f64,
}
