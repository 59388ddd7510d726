//! What a step costs, counted without a factorization.

use std::sync::Arc;

use serde::Serialize;

use crate::linalg::{BlockMatrix, Fill, Graph, Layout, Unknowns, fill};
use crate::problem::Problem;
use crate::space::Space;

/// Bytes of a number.
const NUMBER: f64 = 8.0;

/// Work and memory of a run. Those of a step are of one pass over both half-steps with a contact pattern that is known.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cost {
    /// Unknowns of displacement, of temperature, and of displacement on Γ_C.
    pub unknowns: [usize; 3],
    /// Numbers that the factors of K_u and K_θ store.
    pub factors: [usize; 2],
    /// Operations of both factorizations, once per run of linear laws.
    pub factorization_flops: f64,
    /// Operations of a step: two sweeps over each factor, the products with the forms, two solutions on Γ_C.
    pub step_flops: f64,
    /// Bytes that a step reads: the bound on its time.
    pub step_bytes: f64,
    /// Bytes that factors, forms and condensed operators hold.
    pub memory_bytes: f64,
}

impl Cost {
    /// Counts the work and memory of a problem; none if the pattern of a factor does not fit into memory.
    pub(super) fn new(problem: &Problem) -> Option<Cost> {
        let graph = Arc::new(Graph::of_mesh(&problem.mesh));
        let (v, q) = (problem.displacement_space(), problem.temperature_space());
        let (mechanics, heat) = rayon::join(|| of_system(problem, &graph, &v), || of_system(problem, &graph, &q));
        let ([mechanics, heat], pairs) = ([mechanics?, heat?], pairs(&graph));
        let dim = problem.mesh.dim;
        let relaxing = problem.relaxation_times().len();
        // a, b and the branches of d × d blocks; m and e of d × 1; mass and d of 1 × 1.
        let forms = ((2 + relaxing) * dim * dim + 2 * dim + 2) as f64 * pairs as f64;
        let stored = (mechanics.fill.stored + heat.fill.stored) as f64;
        let condensed = [mechanics.contact, heat.contact].map(|n| (n * n) as f64).iter().sum::<f64>();
        // The mass acts on w and θ, each form once; every number is multiplied and added.
        let products = forms + dim as f64 * pairs as f64;
        Some(Cost {
            unknowns: [mechanics.fill.size, heat.fill.size, mechanics.contact],
            factors: [mechanics.fill.stored, heat.fill.stored],
            factorization_flops: mechanics.fill.flops + heat.fill.flops,
            step_flops: 4.0 * stored + 2.0 * products + 4.0 * condensed,
            step_bytes: NUMBER * (2.0 * stored + forms + 2.0 * condensed),
            // The condensed operator and its factor.
            memory_bytes: NUMBER * (stored + forms + 2.0 * condensed),
        })
    }
}

struct Counted {
    fill: Fill,
    /// Unknowns on Γ_C.
    contact: usize,
}

fn of_system(problem: &Problem, graph: &Arc<Graph>, space: &Space) -> Option<Counted> {
    let matrix = BlockMatrix::zero(graph, space.components, space.components);
    let boundary = problem.contact_boundary();
    let unknowns = Unknowns::new(&matrix, &Layout::of(&problem.mesh, space, &boundary.nodes));
    Some(Counted { fill: fill(&matrix, &unknowns).ok()?, contact: unknowns.kept().len() })
}

/// Pairs of nodes that share a cell, each node with itself included.
fn pairs(graph: &Graph) -> usize {
    (0..graph.len()).map(|i| graph.row(i).len()).sum()
}
