//! Meshes that are refined where the bound of the error is large.

use std::sync::Arc;

use amontons::majorant::DiscretizationError;
use amontons::mesh::Bisection;

use super::common::{changed, solve};
use super::majorant::{ROD, bound, edge, edge_error, parsed};

/// Meshes that are refined where the bound is large have the best rate of their elements in the number of nodes, ½ and
/// 1 in the plane, whatever the singularity; uniform ones of quadratic elements have ¾. Each bound is above its error.
#[test]
fn meshes_refined_by_the_bound_have_the_best_rate() {
    for (elements, rate, most) in [("P1", 0.5, 4000), ("P2", 1.0, 3000)] {
        let start = parsed(&edge(), &[&format!("mesh.elements={elements}")]);
        let mut bisection = Bisection::new(&start.mesh);
        let (mut problem, mut rows) = (start, Vec::new());
        loop {
            let memory = solve(&problem);
            let found = bound(&problem, &memory).expect("a bound");
            let error = edge_error(&problem, &memory.states.last().expect("a state").u);
            let nodes = problem.mesh.points.len();
            println!(
                "{elements} {nodes}: error {:.4e} ratio {:.3}",
                (2.0 * error).sqrt(),
                (found.energy / error).sqrt()
            );
            assert!(found.is_guaranteed() && found.energy >= error, "{elements} {nodes}: {:e} {error:e}", found.energy);
            rows.push((nodes as f64, error.sqrt()));
            if nodes > most {
                break;
            }
            bisection.refine(&found.marked()).expect("a finer mesh");
            let mesh = bisection.mesh();
            problem = changed(&problem, |data| data.mesh = Arc::new(mesh));
        }
        let ((n, first), (m, last)) = (rows[0], rows[rows.len() - 1]);
        let seen = (first / last).ln() / (m / n).ln();
        assert!(rows.len() > 5 && seen > rate - 0.03, "{elements}: rate {seen}, {rows:?}");
    }
}

/// Of cells with equal errors all are marked or none, and they have half of the energy.
#[test]
fn marked_cells_are_few_and_symmetric() {
    let found = |cells: Vec<f64>| {
        let problem = parsed(ROD, &[]);
        DiscretizationError { cells, ..bound(&problem, &solve(&problem)).expect("a bound") }
    };
    assert_eq!(found(vec![1.0, 4.0, 0.5, 4.0 * (1.0 - 1e-9), 1.0]).marked(), [1, 3]);
    assert_eq!(found(vec![3.0, 2.0, 2.0, 1.0]).marked(), [0, 1, 2]);
    assert_eq!(found(vec![0.0; 3]).marked(), [0usize; 0]);
}
