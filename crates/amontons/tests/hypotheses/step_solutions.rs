//! The condition of a step against all solutions of small steps, enumerated, and against dense matrices. Every matrix
//! is assembled in this file, from the vertices of the triangles.
#![allow(clippy::indexing_slicing, reason = "a test fails by panicking")]

use crate::common::{Random, paper};
use amontons::hypotheses::{Finding, full, monotonicity_loss};
use amontons::problem::Problem;
use amontons::step::{March, Scheme};

type Matrix = Vec<Vec<f64>>;

pub(super) fn find(problem: &Problem, id: &str) -> Finding {
    full(problem).findings.into_iter().find(|f| f.id.as_str() == id).unwrap_or_else(|| panic!("no finding {id}"))
}

/// Solves A x = b by elimination with pivots; none for a singular matrix.
fn solve(mut a: Matrix, mut b: Vec<f64>) -> Option<Vec<f64>> {
    let n = b.len();
    for i in 0..n {
        let pivot = (i..n).max_by(|&p, &q| a[p][i].abs().total_cmp(&a[q][i].abs()))?;
        a.swap(i, pivot);
        b.swap(i, pivot);
        if a[i][i] == 0.0 {
            return None;
        }
        for row in i + 1..n {
            let factor = a[row][i] / a[i][i];
            for column in i..n {
                a[row][column] -= factor * a[i][column];
            }
            b[row] -= factor * b[i];
        }
    }
    for i in (0..n).rev() {
        let sum: f64 = (i + 1..n).map(|j| a[i][j] * b[j]).sum();
        b[i] = (b[i] - sum) / a[i][i];
    }
    Some(b)
}

/// A contact point of a step in the plane with linear compliance and Coulomb's law.
#[derive(Clone, Copy)]
struct Point {
    /// Degree of freedom along ν with the sign of ν, and along τ.
    normal: (usize, f64),
    tangent: usize,
    weight: f64,
    stiffness: f64,
    mu: f64,
    /// r⁰ of r = r⁰ + k w_ν.
    start: f64,
}

/// All solutions of S w + Σ ω Nᵀ(p ν + q) = r̂, found pattern by pattern: open, stick, slip to either side.
fn solutions(s: &Matrix, points: &[Point], k: f64, right: &[f64]) -> Vec<Vec<f64>> {
    let (n, mut found): (usize, Vec<Vec<f64>>) = (right.len(), Vec::new());
    for pattern in 0..4usize.pow(points.len() as u32) {
        let states: Vec<usize> = (0..points.len()).map(|i| pattern / 4usize.pow(i as u32) % 4).collect();
        let size = n + points.len();
        let (mut a, mut b) = (vec![vec![0.0; size]; size], vec![0.0; size]);
        for i in 0..n {
            a[i][..n].copy_from_slice(&s[i]);
            b[i] = right[i];
        }
        for (i, (point, &state)) in points.iter().zip(&states).enumerate() {
            let (dof, sign) = point.normal;
            let (row, force) = (n + i, point.weight * point.stiffness);
            // The friction traction is the unknown of this row.
            a[point.tangent][row] = point.weight;
            match state {
                0 => a[row][row] = 1.0,
                1 => a[row][point.tangent] = 1.0,
                _ => {
                    let along = if state == 2 { point.mu } else { -point.mu };
                    a[row][row] = 1.0;
                    a[row][dof] = -along * point.stiffness * k * sign;
                    b[row] = along * point.stiffness * point.start;
                }
            }
            if state > 0 {
                a[dof][dof] += force * k;
                b[dof] -= force * point.start * sign;
            }
        }
        let Some(x) = solve(a, b) else { continue };
        let fits = points.iter().zip(&states).enumerate().all(|(i, (point, &state))| {
            let r = point.start + k * point.normal.1 * x[point.normal.0];
            let (slip, q) = (x[point.tangent], x[n + i]);
            match state {
                0 => r <= 0.0,
                1 => r >= 0.0 && q.abs() <= point.mu * point.stiffness * r,
                2 => r >= 0.0 && slip > 0.0,
                _ => r >= 0.0 && slip < 0.0,
            }
        });
        let size: f64 = x[..n].iter().fold(1e-300, |m, v| m.max(v.abs()));
        let known = |other: &Vec<f64>| (0..n).all(|i| (other[i] - x[i]).abs() < 1e-9 * size);
        if fits && !found.iter().any(known) {
            found.push(x[..n].to_vec());
        }
    }
    found
}

/// The least eigenvalue of a symmetric matrix.
fn least_eigenvalue(matrix: &Matrix) -> f64 {
    let n = matrix.len();
    let mat = faer::Mat::from_fn(n, n, |i, j| matrix[i][j]);
    mat.self_adjoint_eigenvalues(faer::Side::Lower).expect("eigenvalues")[0]
}

/// λ_min(S, W) of diagonal weights that may be zero: the inverse of the largest eigenvalue of √W S⁻¹ √W.
fn least(s: &Matrix, w: &[f64]) -> f64 {
    let unit = |i: usize| (0..w.len()).map(|j| f64::from(u8::from(i == j))).collect::<Vec<f64>>();
    let inverse: Matrix = (0..w.len())
        .map(|i| if w[i] > 0.0 { solve(s.clone(), unit(i)).expect("a regular matrix") } else { vec![0.0; w.len()] })
        .collect();
    let scaled: Matrix =
        (0..w.len()).map(|i| (0..w.len()).map(|j| -inverse[i][j] * (w[i] * w[j]).sqrt()).collect()).collect();
    -1.0 / least_eigenvalue(&scaled)
}

fn c_star(stiffness: f64, mu: f64) -> f64 {
    stiffness * ((1.0 + mu * mu).sqrt() - 1.0) / 2.0
}

/// Theorem 2 on random S with one and two points, two laws and two weights: a step has a solution, and one only where
/// S − k Σ c*_i W_i > 0.
#[test]
fn random_steps_have_one_solution_where_the_condition_holds() {
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    for points in [1usize, 2] {
        let (mut several, mut held, mut nearest) = (0, 0, 0.0f64);
        for _ in 0..if points == 1 { 60_000 } else { 12_000 } {
            let n = 2 * points;
            let root: Matrix = (0..n).map(|_| (0..n).map(|_| random.number()).collect()).collect();
            let s: Matrix =
                (0..n).map(|i| (0..n).map(|j| (0..n).map(|l| root[i][l] * root[j][l]).sum()).collect()).collect();
            let k = 10f64.powf(random.number());
            let at: Vec<Point> = (0..points)
                .map(|i| Point {
                    normal: (2 * i, 1.0),
                    tangent: 2 * i + 1,
                    weight: 0.6 + 0.4 * random.number(),
                    stiffness: 10f64.powf(2.0 * random.number()),
                    mu: 10f64.powf(random.number()),
                    start: random.number(),
                })
                .collect();
            let right: Vec<f64> = (0..n).map(|_| 3.0 * random.number()).collect();
            let taken: Vec<f64> = at.iter().flat_map(|p| [p.weight * c_star(p.stiffness, p.mu); 2]).collect();
            // S − k Σ c* W > 0, that is, λ_min(S, Σ c* W) > k.
            let margin = least(&s, &taken) / k;
            let found = solutions(&s, &at, k, &right).len();
            assert!(found > 0, "a step without a solution");
            assert!(found == 1 || margin <= 1.0, "{found} solutions at λ_min/(c* k) = {margin}");
            held += usize::from(margin > 1.0);
            if found > 1 {
                several += 1;
                nearest = nearest.max(margin);
            }
            let declared = monotonicity_loss(at[0].stiffness, at[0].mu * at[0].stiffness, 0.0);
            assert!((declared - c_star(at[0].stiffness, at[0].mu)).abs() <= 1e-8 * declared);
        }
        println!(
            "{points} points: {several} steps with several solutions, {held} where the condition holds, nearest at {nearest:.3}"
        );
        assert!(several > 20 && held > 20, "{points} points: {several}, {held}");
    }
}

/// c* is sharp: S with λ_min(S, W) just below c* k and a load with three solutions, for any μ.
#[test]
fn just_below_the_condition_a_step_has_three_solutions() {
    for mu in [0.2, 0.5, 1.0, 3.0] {
        let (loss, gamma, epsilon) = (c_star(1.0, mu), 1e6, 1e-6 * c_star(1.0, mu));
        // The unit eigenvector of (C + Cᵀ)/2, C = [[1, 0], [μ, 0]], to −c*.
        let direction = [0.5 * mu, -loss - 1.0];
        let length = direction[0].hypot(direction[1]);
        let x = direction.map(|c| c / length);
        let across = [-x[1], x[0]];
        let y = [-x[0], -mu * x[0]];
        let (along, beside) = (x[0] * y[0] + x[1] * y[1], across[0] * y[0] + across[1] * y[1]);
        let entry = |i: usize, j: usize| {
            (along - epsilon) * x[i] * x[j]
                + beside * (x[i] * across[j] + across[i] * x[j])
                + gamma * across[i] * across[j]
        };
        let s: Matrix = (0..2).map(|i| (0..2).map(|j| entry(i, j)).collect()).collect();
        let lambda = least_eigenvalue(&s);
        assert!(lambda < loss && lambda > (1.0 - 1e-5) * loss, "μ = {mu}: λ_min = {lambda}, c* = {loss}");
        let point = [Point { normal: (0, 1.0), tangent: 1, weight: 1.0, stiffness: 1.0, mu, start: 0.0 }];
        let most = (1..200_000).map(|i| {
            // Loads of slip states in all directions near the one that S + C almost annuls.
            let angle = std::f64::consts::FRAC_PI_2 * f64::from(i) / 200_000.0;
            let w = [angle.cos(), angle.sin()];
            let right = [(s[0][0] + 1.0) * w[0] + s[0][1] * w[1], (s[1][0] + mu) * w[0] + s[1][1] * w[1]];
            solutions(&s, &point, 1.0, &right).len()
        });
        assert_eq!(most.max(), Some(3), "μ = {mu}");
    }
}

/// The counterexample to uniqueness on the way between two states: open, slip and stick, in this order of r and of
/// slip.
#[test]
fn a_step_may_have_a_solution_between_two_others() {
    let point = [Point { normal: (0, 1.0), tangent: 1, weight: 1.0, stiffness: 1.0, mu: 3.0, start: 0.0 }];
    let mut found = solutions(&vec![vec![1.0, 0.9], vec![0.9, 1.0]], &point, 1.0, &[1.0, 1.25]);
    found.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let expected = [[-0.657_894_736_8, 1.842_105_263_2], [0.082_781_457_0, 0.927_152_317_9], [0.5, 0.0]];
    assert_eq!(found.len(), 3);
    for (found, expected) in found.iter().zip(expected) {
        assert!((found[0] - expected[0]).abs() < 1e-9 && (found[1] - expected[1]).abs() < 1e-9, "{found:?}");
    }
}

/// A law σ = first tr ε I + second ε in the plane, on (ε₁₁, ε₂₂, γ₁₂).
fn plane(first: f64, second: f64) -> [[f64; 3]; 3] {
    [[first + second, first, 0.0], [first, first + second, 0.0], [0.0, 0.0, 0.5 * second]]
}

/// Plane strain with Poisson's ratio 0.3.
fn plane_strain(young: f64) -> [[f64; 3]; 3] {
    plane(young * 0.3 / (1.3 * 0.4), young / 1.3)
}

/// ∫ Dε(u):ε(v) and ∫ u·v on linear triangles over all degrees of freedom.
fn assemble(problem: &Problem, law: [[f64; 3]; 3]) -> (Matrix, Matrix) {
    let (points, n) = (&problem.mesh.points, 2 * problem.mesh.points.len());
    let (mut stiffness, mut mass) = (vec![vec![0.0; n]; n], vec![vec![0.0; n]; n]);
    for cell in problem.mesh.blocks.iter().flat_map(amontons::mesh::Block::cells) {
        let x: Vec<[f64; 3]> = cell.iter().map(|&node| points[node as usize]).collect();
        let double = (x[1][0] - x[0][0]) * (x[2][1] - x[0][1]) - (x[2][0] - x[0][0]) * (x[1][1] - x[0][1]);
        let strain = |a: usize| {
            let (b, c) = ((a + 1) % 3, (a + 2) % 3);
            let (gx, gy) = ((x[b][1] - x[c][1]) / double, (x[c][0] - x[b][0]) / double);
            [[gx, 0.0, gy], [0.0, gy, gx]]
        };
        for a in 0..3 {
            for b in 0..3 {
                let (rows, columns) = (strain(a), strain(b));
                for (r, row) in rows.iter().enumerate() {
                    for (c, column) in columns.iter().enumerate() {
                        let work: f64 =
                            (0..3).map(|i| (0..3).map(|j| row[i] * law[i][j] * column[j]).sum::<f64>()).sum();
                        stiffness[2 * cell[a] as usize + r][2 * cell[b] as usize + c] += 0.5 * double * work;
                    }
                }
                for c in 0..2 {
                    mass[2 * cell[a] as usize + c][2 * cell[b] as usize + c] +=
                        double / if a == b { 12.0 } else { 24.0 };
                }
            }
        }
    }
    (stiffness, mass)
}

/// Pairs of neighbours on a side of the rectangle, by the coordinate that is constant there.
fn edges(problem: &Problem, on: &str) -> Vec<([usize; 2], f64)> {
    let axis = usize::from(on == "left" || on == "right");
    let mut nodes: Vec<usize> = problem.mesh.facets[on].node_list().into_iter().map(|n| n as usize).collect();
    let x = |n: usize| problem.mesh.points[n][axis];
    nodes.sort_by(|&a, &b| x(a).total_cmp(&x(b)));
    nodes.windows(2).map(|pair| ([pair[0], pair[1]], x(pair[1]) - x(pair[0]))).collect()
}

fn add(sum: &mut Matrix, factor: f64, term: &Matrix) {
    for (sum, term) in sum.iter_mut().flatten().zip(term.iter().flatten()) {
        *sum += factor * term;
    }
}

/// ∫ κ_i u_i v_i over a side, added to a matrix.
fn support(matrix: &mut Matrix, problem: &Problem, on: &str, factor: f64, kappa: [f64; 2]) {
    for (nodes, length) in edges(problem, on) {
        for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            for c in 0..2 {
                matrix[2 * nodes[a] + c][2 * nodes[b] + c] +=
                    factor * kappa[c] * length / if a == b { 3.0 } else { 6.0 };
            }
        }
    }
}

fn select(matrix: &Matrix, free: &[usize]) -> Matrix {
    free.iter().map(|&i| free.iter().map(|&j| matrix[i][j]).collect()).collect()
}

/// Random data of a step on squares: springs and dashpots, branches, one and two sides, over decades.
struct Data {
    n: usize,
    steps: f64,
    density: f64,
    young: f64,
    viscosity: [f64; 2],
    branch: [f64; 2],
    spring: Option<[f64; 2]>,
    dashpot: [f64; 2],
    /// c_ν and μ of each side.
    sides: Vec<[f64; 2]>,
}

const SIDES: [&str; 2] = ["bottom", "right"];

impl Data {
    fn new(random: &mut Random, sample: usize) -> Data {
        let mut size = |decades: f64| 10f64.powf(decades * random.number());
        Data {
            n: 2 + sample % 4,
            steps: (8.0 * size(1.0)).ceil(),
            density: if sample.is_multiple_of(3) { 0.0 } else { size(2.0) },
            young: size(3.0),
            viscosity: [size(2.0), size(2.0)],
            branch: [size(0.5), size(1.0)],
            spring: (sample % 5 < 2).then(|| [size(3.0), size(3.0)]),
            dashpot: [size(2.0), size(2.0)],
            sides: (0..=sample % 2).map(|_| [size(3.0), size(0.7)]).collect(),
        }
    }

    fn problem(&self) -> Problem {
        let top =
            self.spring.map_or_else(|| "displacement=[0, 0]".to_owned(), |[x, y]| format!("spring=[{x:?}, {y:?}]"));
        let contact = |(on, [stiffness, mu]): (&&str, &[f64; 2])| {
            format!(
                "{{on='{on}', normal={{law='compliance', stiffness={stiffness:?}}}, friction={{law='coulomb', coefficient={mu:?}}}, heat={{law='none'}}}}"
            )
        };
        let contacts: Vec<String> = SIDES.iter().zip(&self.sides).map(contact).collect();
        let overrides = [
            format!("mesh.n={}", self.n),
            format!("time.steps={}", self.steps),
            format!("material.density={:?}", self.density),
            format!(
                "material.elasticity={{law='isotropic', young={:?}, poisson=0.3, stress_state='plane-strain'}}",
                self.young
            ),
            format!("material.viscosity={{law='lame', first={:?}, second={:?}}}", self.viscosity[0], self.viscosity[1]),
            format!("material.prony=[{{ratio={:?}, time={:?}}}]", self.branch[0], self.branch[1]),
            format!(
                "boundary=[{{on='top', {top}, temperature=0}}, {{on='left', dashpot=[{:?}, {:?}]}}]",
                self.dashpot[0], self.dashpot[1]
            ),
            format!("contact=[{}]", contacts.join(", ")),
        ];
        paper(&overrides.iter().map(String::as_str).collect::<Vec<_>>()).problem
    }

    /// K_u on the degrees of freedom that are free, and there the diagonal of Σ c*_i W_i / max c*; with max c*.
    fn dense(&self, problem: &Problem) -> (Matrix, Vec<f64>, f64) {
        let (k, [ratio, time]) = (problem.timeline.longest(), self.branch);
        let (elastic, mass) = assemble(problem, plane_strain(self.young));
        let (mut matrix, _) = assemble(problem, plane(self.viscosity[0], self.viscosity[1]));
        add(&mut matrix, k * (1.0 + ratio / (1.0 + k / time)), &elastic);
        add(&mut matrix, self.density / k, &mass);
        support(&mut matrix, problem, "left", 1.0, self.dashpot);
        if let Some(spring) = self.spring {
            support(&mut matrix, problem, "top", k, spring);
        }
        let losses: Vec<f64> = self.sides.iter().map(|[stiffness, mu]| c_star(*stiffness, *mu)).collect();
        let most = losses.iter().copied().fold(0.0, f64::max);
        let mut weights = vec![0.0; matrix.len()];
        for (loss, on) in losses.iter().zip(SIDES) {
            for (nodes, length) in edges(problem, on) {
                nodes
                    .into_iter()
                    .flat_map(|node| [2 * node, 2 * node + 1])
                    .for_each(|dof| weights[dof] += 0.5 * length * loss / most);
            }
        }
        let top: Vec<u32> = problem.mesh.facets["top"].node_list();
        let free: Vec<usize> =
            (0..matrix.len()).filter(|dof| self.spring.is_some() || !top.contains(&(*dof as u32 / 2))).collect();
        (select(&matrix, &free), free.iter().map(|&i| weights[i]).collect(), most)
    }
}

/// λ_min of the certificate against dense matrices.
#[test]
fn the_eigenvalue_of_a_step_is_that_of_dense_matrices() {
    let mut random = Random(0xD1B5_4A32_D192_ED03);
    let (mut held, mut failed) = (0, 0);
    for sample in 0..60 {
        let data = Data::new(&mut random, sample);
        let problem = data.problem();
        let (matrix, weights, loss) = data.dense(&problem);
        let (expected, needed) = (least(&matrix, &weights), loss * problem.timeline.longest());
        let finding = find(&problem, "step-unique");
        let value = finding.value.expect("a value");
        assert!((value - expected).abs() < 1e-7 * expected, "sample {sample}: {value:e}, expected {expected:e}");
        assert!((finding.needed.expect("a value") - needed).abs() < 1e-8 * needed);
        assert_eq!(
            finding.status.as_str(),
            if expected > needed { "holds" } else { "fails" },
            "sample {sample}: {}",
            finding.message
        );
        held += usize::from(finding.holds());
        failed += usize::from(finding.fails());
    }
    println!("{held} hold, {failed} fail");
    assert!(held > 10 && failed > 10, "{held} hold, {failed} fail");
}

/// One step of a square of two triangles that is held at its top, and for one contact point at its left, from a random
/// state.
struct Small {
    one: bool,
    k: f64,
    density: f64,
    young: f64,
    eta: f64,
    stiffness: f64,
    mu: f64,
    gap: f64,
    force: [f64; 2],
    start: [[f64; 2]; 2],
}

impl Small {
    fn new(random: &mut Random, sample: usize) -> Small {
        let mut size = |decades: f64| 10f64.powf(decades * random.number());
        let [young, eta, density, k] = [size(1.0), 1e-2 * size(1.5), 1e-2 * size(1.0), size(1.0)];
        let (stiffness, mu) = (10.0 * size(1.5), 3.0 * size(0.5));
        let mut pair = |factor: f64| [factor * random.number(), factor * random.number()];
        let (force, start) = (pair(10.0), [pair(1.0), pair(1.0)]);
        Small {
            one: sample.is_multiple_of(2),
            k,
            density,
            young,
            eta,
            stiffness,
            mu,
            gap: 0.3 * random.number().abs(),
            force,
            start,
        }
    }

    fn problem(&self) -> Problem {
        let (shape, left) = if self.one { ("(1-y)*x", ", {on='left', displacement=[0, 0]}") } else { ("(1-y)", "") };
        let field = |[x, y]: [f64; 2]| format!("['{x:?}*{shape}', '{y:?}*{shape}']");
        let (gap, stiffness, mu) = (self.gap, self.stiffness, self.mu);
        paper(&[
            "mesh.n=1",
            &format!("time.end={:?}", self.k),
            "time.steps=1",
            &format!("material.density={:?}", self.density),
            "material.expansion=0",
            "material.coupling=0",
            &format!("material.elasticity={{law='isotropic', young={:?}, poisson=0.3, stress_state='plane-strain'}}", self.young),
            &format!("material.viscosity={{law='lame', first=0, second={:?}}}", self.eta),
            &format!("load.body_force={:?}", self.force),
            &format!("boundary=[{{on='top', displacement=[0, 0], temperature=0}}{left}]"),
            &format!("initial.displacement={}", field(self.start[0])),
            &format!("initial.velocity={}", field(self.start[1])),
            &format!(
                "contact={{on='bottom', gap={gap:?}, normal={{law='compliance', stiffness={stiffness:?}}}, friction={{law='coulomb', coefficient={mu:?}}}, heat={{law='none'}}}}"
            ),
        ])
        .problem
    }

    /// The degrees of freedom that are free, λ_min(S, W), and all solutions of the step.
    fn solved(&self, problem: &Problem) -> (Vec<usize>, f64, Vec<Vec<f64>>) {
        let bottom = problem.mesh.facets["bottom"].node_list();
        let touching: Vec<usize> =
            bottom.iter().map(|&n| n as usize).filter(|&n| !self.one || problem.mesh.points[n][0] > 0.5).collect();
        let free: Vec<usize> = touching.iter().flat_map(|&n| [2 * n, 2 * n + 1]).collect();
        let (elastic, mass) = assemble(problem, plane_strain(self.young));
        let (mut matrix, _) = assemble(problem, plane(0.0, self.eta));
        add(&mut matrix, self.k, &elastic);
        add(&mut matrix, self.density / self.k, &mass);
        let field = |values: [f64; 2]| -> Vec<f64> {
            let value = |x: &[f64; 3]| if self.one { (1.0 - x[1]) * x[0] } else { 1.0 - x[1] };
            problem.mesh.points.iter().flat_map(|x| values.map(|v| v * value(x))).collect()
        };
        let [u, w] = self.start.map(field);
        let right: Vec<f64> = free
            .iter()
            .map(|&dof| {
                let row = |m: &Matrix, v: &[f64]| m[dof].iter().zip(v).map(|(m, v)| m * v).sum::<f64>();
                // ∫ N is the sum of the row of the mass matrix over one component.
                let load: f64 =
                    (0..mass.len()).filter(|other| other % 2 == dof % 2).map(|other| mass[dof][other]).sum();
                self.density / self.k * row(&mass, &w) - row(&elastic, &u) + load * self.force[dof % 2]
            })
            .collect();
        let (s, stiffness, mu) = (select(&matrix, &free), self.stiffness, self.mu);
        let point = |i: usize| Point {
            normal: (2 * i + 1, -1.0),
            tangent: 2 * i,
            weight: 0.5,
            stiffness,
            mu,
            start: -u[2 * touching[i] + 1] - self.gap,
        };
        let points: Vec<Point> = (0..touching.len()).map(point).collect();
        let lambda = least(&s, &vec![0.5; free.len()]);
        (free, lambda, solutions(&s, &points, self.k, &right))
    }
}

/// Steps of one and two contact points of the program itself: its solution is one of all there are, and the only one
/// where the verdict holds.
#[test]
fn steps_of_the_program_against_all_their_solutions() {
    let mut random = Random(0x94D0_49BB_1331_11EB);
    let (mut held, mut several) = (0, 0);
    for sample in 0..240 {
        let small = Small::new(&mut random, sample);
        let problem = small.problem();
        let (free, lambda, all) = small.solved(&problem);
        let unique = find(&problem, "step-unique");
        assert!(
            (unique.value.expect("a value") / lambda - 1.0).abs() < 1e-9,
            "sample {sample}: {unique:?}, expected {lambda:e}"
        );
        assert_eq!(unique.holds(), lambda > c_star(small.stiffness, small.mu) * small.k, "sample {sample}");
        assert!(
            !all.is_empty() && (all.len() == 1 || !unique.holds()),
            "sample {sample}: {} solutions, {unique:?}",
            all.len()
        );
        held += usize::from(unique.holds());
        several += usize::from(all.len() > 1);
        let mut scheme = March::new(&problem).expect("a regular system");
        let start = scheme.initial().expect("finite initial data");
        let Ok((state, report)) = scheme.step(&start) else {
            assert!(!unique.holds(), "sample {sample}: a step with one solution is not solved");
            continue;
        };
        if report.parts == 1 {
            let near = |solution: &Vec<f64>| {
                free.iter().zip(solution).all(|(&dof, w)| (state.w[dof] - w).abs() <= 1e-8 * (1.0 + w.abs()))
            };
            assert!(all.iter().any(near), "sample {sample}: the result is no solution");
        }
    }
    println!("{held} of 240 steps hold, {several} have several solutions");
    assert!(held > 20 && several > 0, "{held}, {several}");
}
