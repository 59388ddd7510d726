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

/// A block that is pressed and pulled over a foundation with Tresca's friction.
pub(super) fn block(turn: f64, mirror: f64, stiffness: f64, origin: [f64; 2], elements: &str) -> String {
    let (s, c) = turn.sin_cos();
    let held = [0.03 * mirror, -0.1];
    let [dx, dy] = [c * held[0] - s * held[1], s * held[0] + c * held[1]];
    let bound = 0.02 * stiffness;
    format!(
        "name = \"block\"\nunits = \"dimensionless\"\n[mesh]\nkind = \"blocks\"\nblocks = [{{ name = \"body\", \
         size = [2.0, 1.0], n = [4, 2], elements = \"{elements}\", origin = {origin:?}, turn = {{ angle = {turn} }}, \
         DIAGONAL }}]\n[time]\nend = 1.0\nsteps = 2\n[material]\ndensity = 0.0\n\
         elasticity = {{ law = \"isotropic\", young = {stiffness}, poisson = 0.3, stress_state = \"plane-strain\" }}\n\
         [[boundary]]\non = \"body_top\"\ndisplacement = [\"{dx}*t\", \"{dy}*t\"]\n[contact]\non = \"body_bottom\"\n\
         gap = 0.01\nnormal = {{ law = \"signorini\" }}\nfriction = {{ law = \"tresca\", bound = {bound} }}\n"
    )
}

/// The errors of four meshes, each with the marks of the one before.
fn errors(text: &str) -> Vec<(usize, f64)> {
    let start = parsed(text, &[]);
    let mut bisection = Bisection::new(&start.mesh);
    let (mut problem, mut rows) = (start, Vec::new());
    for _ in 0..4 {
        let found = bound(&problem, &solve(&problem)).expect("a bound");
        rows.push((problem.mesh.cell_count(), found.relative()));
        bisection.refine(&found.marked()).expect("a finer mesh");
        let mesh = bisection.mesh();
        problem = changed(&problem, |data| data.mesh = Arc::new(mesh));
    }
    rows
}

/// Meshes and errors are those of the body, wherever it lies, whatever the axes and the units are.
#[test]
fn the_meshes_of_a_body_do_not_know_where_it_lies() {
    for elements in ["P1", "P2", "Q1"] {
        let diagonal = |text: &str, which: &str| {
            let with = if elements == "Q1" { String::new() } else { format!("diagonal = \"{which}\"") };
            text.replace(", DIAGONAL", &if with.is_empty() { with } else { format!(", {with}") })
        };
        let of = |turn: f64, mirror: f64, stiffness: f64, origin: [f64; 2]| {
            let which = if mirror > 0.0 { "right" } else { "left" };
            errors(&diagonal(&block(turn, mirror, stiffness, origin, elements), which))
        };
        let plain = of(0.0, 1.0, 1.0, [0.0; 2]);
        assert!(plain[3].1 < 0.6 * plain[0].1, "{elements}: {plain:?}");
        let others = [
            ("turned", of(0.7, 1.0, 1.0, [0.0; 2])),
            ("upside down", of(std::f64::consts::PI, 1.0, 1.0, [0.0; 2])),
            ("mirrored", of(0.0, -1.0, 1.0, [0.0; 2])),
            ("stiffer", of(0.0, 1.0, 2.1e11, [0.0; 2])),
            ("moved", of(0.0, 1.0, 1.0, [1e-9, 1e3])),
        ];
        for (name, other) in others {
            for (plain, other) in plain.iter().zip(&other) {
                let is_same = plain.0 == other.0 && (plain.1 - other.1).abs() < 1e-6 * plain.1;
                assert!(is_same, "{elements} {name}: {plain:?} {other:?}");
            }
        }
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
