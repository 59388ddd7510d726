//! Cost of a step, counted without a factorization or the pattern of a factor.

use serde::Serialize;

use crate::linalg::{Choice, Estimate, Graph, Layout};
use crate::problem::Problem;
use crate::space::Space;

/// Bytes of a number.
const NUMBER: f64 = 8.0;

/// Work and memory of a run. Numbers per step are for one iteration over both half-steps with a known contact pattern.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cost {
    /// Unknowns of displacement, of temperature, and of displacement on Γ_C.
    pub unknowns: [usize; 3],
    /// Entries of the factors of K_u and K_θ, even if they are not made.
    pub factors: [usize; 2],
    /// Operations of both factorizations, once per run for linear laws.
    pub factorization_flops: f64,
    /// Solver of the larger of the two systems, and the reason for it.
    pub solver: Choice,
    /// Operations of a step: two sweeps over each factor, or the products of an iterative solver, the products with the
    /// forms, and two solutions on Γ_C.
    pub step_flops: f64,
    /// Bytes read by a step, which bound its time.
    pub step_bytes: f64,
    /// Bytes held by factors or levels, forms and condensed operators.
    pub memory_bytes: f64,
}

impl Cost {
    /// Counts the work and memory of a problem.
    pub(super) fn new(problem: &Problem) -> Cost {
        let graph = Graph::of_mesh(&problem.mesh);
        let (v, q) = (problem.displacement_space(), problem.temperature_space());
        let (mechanics, heat) = rayon::join(|| of_system(problem, &graph, &v), || of_system(problem, &graph, &q));
        let (dim, pairs) = (problem.mesh.dim, graph.pairs() as f64);
        let relaxing = problem.relaxation_times().len() + problem.varying_branches();
        // a, b and the branches have d × d blocks; m and e d × 1; mass and d 1 × 1.
        let forms = ((2 + relaxing) * dim * dim + 2 * dim + 2) as f64 * pairs;
        // The mass acts on w and θ, each form once; every number is multiplied and added.
        let products = forms + dim as f64 * pairs;
        let both = [&mechanics, &heat];
        let steps = both.map(Counted::step);
        Cost {
            unknowns: [mechanics.estimate.unknowns, heat.estimate.unknowns, mechanics.estimate.contact],
            factors: both.map(|counted| counted.estimate.stored as usize),
            factorization_flops: both.map(|counted| counted.estimate.flops).iter().sum(),
            step_flops: steps[0][0] + steps[1][0] + 2.0 * products,
            step_bytes: steps[0][1] + steps[1][1] + NUMBER * forms,
            memory_bytes: mechanics.choice.demand().bytes + heat.choice.demand().bytes + NUMBER * forms,
            solver: if mechanics.estimate.unknowns > 0 { mechanics.choice } else { heat.choice },
        }
    }
}

struct Counted {
    estimate: Estimate,
    choice: Choice,
}

impl Counted {
    /// Operations of a step, and bytes that it reads.
    fn step(&self) -> [f64; 2] {
        if self.choice.is_direct() { self.estimate.direct_step() } else { self.estimate.iterative_step() }
    }
}

fn of_system(problem: &Problem, graph: &Graph, space: &Space) -> Counted {
    let boundary = problem.contact_boundary();
    let layout = Layout::of(&problem.mesh, space, &boundary.nodes);
    let graph = layout.graph(graph);
    let estimate = Estimate::of(&graph, layout.free, layout.components, &layout.ordering(&graph));
    Counted { estimate, choice: problem.backend.choice(&estimate) }
}
