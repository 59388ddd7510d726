//! The condensed solution against a plain one: full sparse Newton, factorized anew in every iteration,
//! written for the flat bottom of the paper's square and sharing nothing with the engine but the matrices.
#![allow(clippy::float_cmp, reason = "counts are exact")]

use crate::common::paper;
use amontons::linalg::BlockMatrix;
use amontons::state::State;
use amontons::step::{March, Scheme};
use amontons::time::Rule;
use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};

fn triplets(matrix: &BlockMatrix, free: &[bool]) -> Vec<Triplet<usize, usize, f64>> {
    let (components, _) = matrix.block_shape();
    let mut out = Vec::new();
    for i in 0..matrix.graph().len() {
        for (j, block) in matrix.row(i) {
            for r in 0..components {
                for c in 0..components {
                    let (row, col) = (i * components + r, j * components + c);
                    if free[row] && free[col] {
                        out.push(Triplet::new(row, col, block[r * components + c]));
                    }
                }
            }
        }
    }
    out.extend((0..free.len()).filter(|&i| !free[i]).map(|i| Triplet::new(i, i, 1.0)));
    out
}

fn solve(size: usize, entries: &[Triplet<usize, usize, f64>], right: &[f64]) -> Vec<f64> {
    let matrix = SparseColMat::try_new_from_triplets(size, size, entries).expect("a sparse matrix");
    let lu = matrix.sp_lu().expect("a regular matrix");
    let b = faer::Mat::from_fn(size, 1, |i, _| right[i]);
    let x = lu.solve(&b);
    (0..size).map(|i| x[(i, 0)]).collect()
}

/// One step of Problem 4.1 in the paper's data: c_ν = 1e4, μ = 0.2, ramp 1 over 1e-5, ν = (0, −1).
///
/// The plain iteration has no globalisation: it cycles for some ρ, so several are tried.
fn plain_step(
    scheme: &March,
    old: &State,
    multiplier: &mut Vec<f64>,
    k: f64,
    n: usize,
    foundation: f64,
) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let (w, found) = [1.0, 10.0, 100.0, 1e3, 1e4, 1e5]
        .into_iter()
        .find_map(|rho| plain_mechanics(scheme, old, multiplier, k, n, rho))
        .expect("the plain Newton iteration did not end for any of the ρ tried");
    *multiplier = found;
    plain_heat(scheme, old, w, k, n, foundation)
}

fn plain_mechanics(
    scheme: &March,
    old: &State,
    multiplier: &[f64],
    k: f64,
    n: usize,
    rho: f64,
) -> Option<(Vec<f64>, Vec<f64>)> {
    let discrete = scheme.discretization();
    let (c_nu, mu) = (1e4, 0.2);
    let t = old.t + k;
    let size = old.w.len();
    let weight = |i: usize| if i == 0 || i == n { 0.5 / n as f64 } else { 1.0 / n as f64 };
    let base = triplets(&discrete.mechanical_matrix(Rule::backward_euler(k)), &discrete.v.free);
    let (load, mass_w, a_u, thermal) =
        (discrete.f.at(t), discrete.mass.apply(&old.w), discrete.a.apply(&old.u), discrete.m.apply(&old.theta));
    let mut right: Vec<f64> = (0..size).map(|i| load[i] + mass_w[i] / k - a_u[i] + thermal[i]).collect();
    discrete.v.mask(&mut right);
    let mut w = old.w.clone();
    let mut multiplier = multiplier.to_vec();
    let mut previous = Vec::new();
    for _ in 0..60 {
        let mut pattern = Vec::new();
        let (mut entries, mut b) = (base.clone(), right.clone());
        for i in 0..=n {
            let (x, y) = (2 * i, 2 * i + 1);
            let r = -old.u[y] - k * w[y];
            if r <= 0.0 {
                pattern.push(0);
                continue;
            }
            // p = c (−u_y − k w_y) acts upwards on the body, friction against the slip.
            let z = multiplier[i] + rho * w[x];
            entries.push(Triplet::new(y, y, weight(i) * c_nu * k));
            b[y] += weight(i) * c_nu * -old.u[y];
            if z.abs() <= mu * c_nu * r {
                pattern.push(1);
                // w_x = 0, imposed by a row of its own.
                entries.retain(|t| t.row != x);
                entries.push(Triplet::new(x, x, 1.0));
                b[x] = 0.0;
            } else {
                let direction = z.signum();
                pattern.push(if direction > 0.0 { 2 } else { 3 });
                entries.push(Triplet::new(x, y, -direction * mu * weight(i) * c_nu * k));
                b[x] -= direction * mu * weight(i) * c_nu * -old.u[y];
            }
        }
        w = solve(size, &entries, &b);
        let full = {
            let (m, bb, a) = (discrete.mass.apply(&w), discrete.b.apply(&w), discrete.a.apply(&w));
            (0..size).map(|i| m[i] / k + bb[i] + k * a[i] - right[i]).collect::<Vec<f64>>()
        };
        for i in 0..=n {
            multiplier[i] = if pattern[i] == 0 { 0.0 } else { -full[2 * i] / weight(i) };
        }
        if pattern == previous {
            return Some((w, multiplier));
        }
        previous = pattern;
    }
    None
}

fn plain_heat(
    scheme: &March,
    old: &State,
    w: Vec<f64>,
    k: f64,
    n: usize,
    foundation: f64,
) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let discrete = scheme.discretization();
    let (t, size) = (old.t + k, old.w.len());
    let weight = |i: usize| if i == 0 || i == n { 0.5 / n as f64 } else { 1.0 / n as f64 };
    let u: Vec<f64> = (0..size).map(|i| old.u[i] + k * w[i]).collect();
    let mut entries = triplets(&discrete.thermal_matrix(Rule::backward_euler(k)), &discrete.q.free);
    let (supply, mass_theta, coupling) =
        (discrete.q_h.at(t), discrete.mass.apply(&old.theta), discrete.e.apply(&old.u));
    let mut right: Vec<f64> = (0..supply.len()).map(|i| supply[i] + mass_theta[i] / k + coupling[i]).collect();
    discrete.q.mask(&mut right);
    for i in (0..=n).filter(|&i| discrete.q.free[i]) {
        let conductance = (-u[2 * i + 1] / 1e-5).clamp(0.0, 1.0);
        entries.push(Triplet::new(i, i, weight(i) * conductance));
        right[i] += weight(i) * conductance * foundation;
    }
    (u, w, solve(supply.len(), &entries, &right))
}

#[test]
fn condensed_and_plain_solutions_agree_to_1e_9() {
    for (n, foundation) in [(16, 0.0), (16, 10.0), (24, 10.0)] {
        let case = paper(&[
            &format!("mesh.n={n}"),
            &format!("time.steps={n}"),
            &format!("contact.heat.foundation_temperature={foundation:?}"),
        ]);
        let problem = case.problem;
        let mut scheme = March::new(&problem).expect("a regular system");
        let mut state = scheme.initial().expect("finite initial data");
        let mut plain = state.clone();
        let mut multiplier = vec![0.0; n + 1];
        for step in 1..=problem.timeline.steps() {
            let (u, w, theta) = plain_step(&scheme, &plain, &mut multiplier, problem.timeline.longest(), n, foundation);
            plain = State { step, t: problem.timeline.time(step), u, w, theta, ..plain };
            state = scheme.step(&state).expect("a step").0;
            for (name, a, b) in
                [("u", &state.u, &plain.u), ("w", &state.w, &plain.w), ("theta", &state.theta, &plain.theta)]
            {
                let scale = b.iter().fold(0.0f64, |m, v| m.max(v.abs()));
                let difference = a.iter().zip(b).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
                assert!(
                    difference <= 1e-9 * scale,
                    "n = {n}, θ_F = {foundation}, step {step}: {name} differs by {:.2e} relative",
                    difference / scale
                );
            }
        }
    }
}
