//! Jᵀ of the half-steps is the transposed of J.

use super::history::RunHistory;
use super::instance::{ProblemInstance, SolvedStep, data, global};
use super::points::{LinearPoint, linearised};
use super::transpose::{StepFactors, jump};
use crate::case::{self, Source};
use crate::equation::system::Step;
use crate::inclusion::Local;
use crate::linalg::dot;

/// Numbers in (−1, 1) that look random.
fn numbers(count: usize, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    (0..count).map(|_| next()).collect()
}

fn locals(count: usize, seed: u64) -> Vec<Local> {
    numbers(3 * count, seed).chunks_exact(3).map(|v| [v[0], v[1], v[2]]).collect()
}

/// J (v, f): K v + Σ ω Nᵀ f, and G_v N v + G_f f at each point.
fn forward(step: &Step, points: &[LinearPoint], v: &[f64], f: &[Local]) -> (Vec<f64>, Vec<Local>) {
    let mut rows = step.discrete.mechanical_matrix(step.rule).apply(v);
    let forces = points.iter().zip(f).map(|(point, f)| global(&point.basis, f));
    step.boundary.scatter(step.discrete.v.components, forces, &mut rows);
    let of = |(i, (point, f)): (usize, (&LinearPoint, &Local))| -> Local {
        let (seen, by_v, by_f) = (jump(step, i, point, v), point.by_velocity(), point.by_force());
        std::array::from_fn(|a| (0..3).map(|b| by_v[a][b] * seen[b] + by_f[a][b] * f[b]).sum())
    };
    (rows, points.iter().zip(f).enumerate().map(of).collect())
}

/// ⟨J v, y⟩ = ⟨v, Jᵀ y⟩ with points that are open, stick and slip.
#[test]
fn the_transposed_step_is_the_transposed_of_the_step() {
    let text = include_str!("../../tests/reference/gradients/block-stick-slip.toml");
    let case = case::parse(&Source::new("block", text), &[]).expect("a case");
    let base = ProblemInstance::new(&case.problem);
    let mut history = RunHistory::new(&base, usize::MAX, &|| true).expect("a run");
    for n in [3, 9, 13, 20] {
        let [old, new] = history.around(n).expect("a step");
        let mut factors = StepFactors::new(&base.problem, &base.discrete, base.rule(n)).expect("factors");
        let chosen = factors.chosen(&base, n, [&old.state, &new.state]);
        let unknown = factors.mechanics.on_contact.clone();
        let (old, states, new) = (&old.state, &new.states, &new.state);
        let solved = SolvedStep { n, old, new, states, chosen: &chosen, unknown: &unknown };
        let points = linearised(&base, &solved, None).expect("points");
        let (right, force) = (numbers(new.w.len(), 7 + n as u64), locals(points.len(), 11 + n as u64));
        let found = factors.mechanics(&base, &solved, &points, (&right, &force)).expect("a solution");
        let (mut v, f) = (numbers(new.w.len(), 13 + n as u64), locals(points.len(), 17 + n as u64));
        base.discrete.v.mask(&mut v);
        base.step(n, old, |step| {
            assert_eq!(data(step, new).frames.len(), points.len());
            let (rows, at_points) = forward(step, &points, &v, &f);
            let areas: Vec<f64> = step.boundary.points.iter().map(|point| point.weight).collect();
            let weighted = |a: &[Local], b: &[Local]| -> f64 {
                (0..areas.len()).map(|i| areas[i] * (0..3).map(|c| a[i][c] * b[i][c]).sum::<f64>()).sum()
            };
            let sizes = |values: &[f64]| values.iter().map(|value| value.abs()).sum::<f64>();
            let left = dot(&rows, &found.y) + weighted(&at_points, &found.points);
            let expected = dot(&v, &right) + weighted(&f, &force);
            let scale = sizes(&right) + weighted(&at_points, &found.points).abs() + dot(&rows, &found.y).abs();
            assert!((left - expected).abs() <= 1e-12 * scale, "step {n}: {left:e}, expected {expected:e}");
            assert!(found.y.iter().zip(&base.discrete.v.free).all(|(y, free)| *free || *y == 0.0));
        });
    }
}
