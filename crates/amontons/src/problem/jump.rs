//! Jumps of prescribed displacements where a dynamic phase begins.
//!
//! A step meets prescribed values at its end. A side that is elsewhere when the step begins gets the velocity Δ/k, with
//! an energy that depends on the length k of the step. A jump counts if it is larger than the way that the condition
//! itself goes in the step: a smaller one changes no velocity by more than itself.

use super::Problem;
use crate::space::Space;
use crate::tensor::{Point, length};

/// Distance that is round-off: over the largest position of a node, and over the largest displacement.
const ROUND_OFF: f64 = 1e-12;

/// The jump of a prescribed displacement.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PrescribedJump {
    /// Number of the entry.
    pub boundary: usize,
    /// Its size, m, and the way that the condition goes in a step.
    pub size: f64,
    pub way: f64,
    /// Position of the node, m.
    pub at: Point,
}

impl Problem {
    /// True if some material has inertia.
    #[must_use]
    pub fn has_mass(&self) -> bool {
        self.physics.has_mechanics() && self.values_of(|m| &m.density).iter().any(|sample| sample.value > 0.0)
    }

    /// The largest jump of each prescribed displacement, from the displacement `u` at t to the values that it has right
    /// after that time, where a step of length `k` begins. `only` sets to zero what is not to be judged.
    pub(crate) fn jumps_from(
        &self,
        space: &Space,
        u: &[f64],
        [t, k]: [f64; 2],
        only: impl Fn(&mut [f64]),
    ) -> Vec<PrescribedJump> {
        let n = self.mesh.dim;
        let [first, last] = [t.next_up(), t + k].map(|t| {
            let mut values = u.to_vec();
            space.prescribe(t, &mut values);
            values
        });
        let mut jump: Vec<f64> = first.iter().zip(u).map(|(first, u)| first - u).collect();
        only(&mut jump);
        let way: Vec<f64> = last.iter().zip(&first).map(|(last, first)| last - first).collect();
        let size = |all: &[f64], node: u32| -> f64 {
            let first = node as usize * n;
            length(&std::array::from_fn(|c| if c < n { all.get(first + c).copied().unwrap_or(0.0) } else { 0.0 }))
        };
        let far = self.mesh.points.iter().map(length).fold(0.0, f64::max);
        let least = ROUND_OFF * u.iter().fold(far, |most: f64, u| most.max(u.abs()));
        let mut all: Vec<PrescribedJump> = Vec::new();
        let mut number = 0;
        for (boundary, condition) in self.boundary.iter().enumerate() {
            let own = number..number + condition.prescriptions(&self.mesh).len();
            number = own.end;
            let nodes = own.flat_map(|number| space.nodes_of(number)).copied();
            let jumps = nodes.map(|node| PrescribedJump {
                boundary,
                size: size(&jump, node),
                way: size(&way, node),
                at: self.mesh.points.get(node as usize).copied().unwrap_or_default(),
            });
            let counts = |of: &PrescribedJump| of.size > least && of.size > of.way;
            all.extend(jumps.filter(counts).reduce(|a, b| if b.size > a.size { b } else { a }));
        }
        all
    }
}
