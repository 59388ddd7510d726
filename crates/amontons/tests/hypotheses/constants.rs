//! Constants of (2.12)–(2.15) against numbers of another program and closed forms.
#![allow(clippy::float_cmp, reason = "counts are exact")]

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::Arc;

use crate::common::{self, Random, changed, paper};
use amontons::convergence::{ConstantsTable, limit};
use amontons::forms;
use amontons::hypotheses::{Constant, DomainConstants, domain_constants};
use amontons::linalg::{Backend, BlockMatrix, Eigenpair, Graph, Layout, Quotient, Supernodal, System, largest};
use amontons::material::{Isotropic, StressState};
use amontons::mesh::{Block, Diagonal, Mesh};
use amontons::problem::{Problem, ProblemData};
use amontons::run::with_threads;
use amontons::tensor::Sym;
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

fn identity(dim: usize) -> Sym {
    Sym::from_fn(dim, |i, j| if i == j { 1.0 } else { 0.0 })
}

/// sup B/K over the functions that vanish where `free` says so.
fn supremum(mesh: &Mesh, b: &BlockMatrix, k: &BlockMatrix, free: &[bool]) -> Eigenpair {
    let layout = Layout {
        points: &mesh.points,
        components: k.block_shape().0,
        free,
        frames: &[],
        links: &[],
        rigid: &[],
        contact: &[],
    };
    let backend: Arc<dyn Backend> = Arc::new(Supernodal);
    let mut system = System::new(&backend, &Arc::new(k.clone()), &layout).expect("a positive definite form");
    largest(&mut Quotient { numerator: b, denominator: k, system: &mut system }).expect("a solution")
}

fn held(mesh: &Mesh, components: usize, sides: &[&str]) -> Vec<bool> {
    let mut free = vec![true; mesh.points.len() * components];
    for side in sides {
        for node in mesh.facets[*side].node_list() {
            free[node as usize * components..][..components].fill(false);
        }
    }
    free
}

/// The gradient of every component: (∇v, ∇v).
fn gradients(mesh: &Mesh, graph: &Arc<Graph>, components: usize) -> BlockMatrix {
    let mut matrix = BlockMatrix::zero(graph, components, components);
    matrix.add_scaled(1.0, &forms::d(mesh, graph, &[&identity(mesh.dim)]));
    matrix
}

fn strains(mesh: &Mesh, graph: &Arc<Graph>) -> BlockMatrix {
    forms::a(mesh, graph, &[&Isotropic::lame(mesh.dim, 0.0, 1.0, StressState::PlaneStress).into()])
}

/// The columns of `constants.csv` that are no constants of a problem: other norms, and the all-ones 𝓚.
fn other_columns(mesh: &Mesh) -> BTreeMap<&'static str, f64> {
    let graph = Arc::new(Graph::of_mesh(mesh));
    let (v, q) = (held(mesh, 2, &["top"]), held(mesh, 1, &["top", "left", "right"]));
    let mass = forms::inner_h(mesh, &graph);
    let (strain, gradient) = (strains(mesh, &graph), gradients(mesh, &graph, 2));
    let mut h1 = gradient.clone();
    h1.add_scaled(1.0, &mass);
    let (laplace, ones) =
        (forms::d(mesh, &graph, &[&identity(2)]), forms::d(mesh, &graph, &[&Sym::from_fn(2, |_, _| 1.0)]));
    [
        ("lam_eps_over_L2", supremum(mesh, &mass, &strain, &v)),
        ("lam_eps_over_grad", supremum(mesh, &gradient, &strain, &v)),
        ("lam_eps_over_H1", supremum(mesh, &h1, &strain, &v)),
        ("lam_FP", supremum(mesh, &mass, &laplace, &q)),
        ("lam_FP_K_ones", supremum(mesh, &mass, &ones, &q)),
        ("min_K_ones_over_grad", supremum(mesh, &laplace, &ones, &q)),
    ]
    .into_iter()
    .map(|(name, pair)| {
        assert!(pair.error <= 1e-9 * pair.value, "{name}: {:e} ± {:e}", pair.value, pair.error);
        (name, 1.0 / pair.value)
    })
    .collect()
}

fn values(constants: &DomainConstants) -> BTreeMap<&'static str, f64> {
    let of = |constant: Option<Constant>| {
        let Constant { value, error } = constant.expect("the paper's example has every constant");
        assert!(error <= 1e-10 * value, "{value:e} ± {error:e}");
        value
    };
    let square = |constant| of(constant).powi(2);
    BTreeMap::from([
        ("c_k(paper norm)", of(constants.c_k)),
        ("c_f(H1 norm)", of(constants.c_f)),
        ("s1^2", square(constants.s1)),
        ("s1n^2", square(constants.s1_normal)),
        ("s1t^2", square(constants.s1_tangential)),
        ("s2^2", square(constants.s2)),
    ])
}

fn problem(n: usize, diagonal: &str) -> Problem {
    paper(&[&format!("mesh.n={n}"), &format!("mesh.diagonal=\"{diagonal}\"")]).problem
}

/// Rows of `constants.csv` with the name of the diagonal in front.
fn reference() -> Vec<(String, BTreeMap<String, f64>)> {
    let text = std::fs::read_to_string(common::file("crates/amontons/tests/reference/constants.csv"))
        .expect("the reference numbers");
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().expect("a header").split(',').skip(1).collect();
    lines
        .map(|line| {
            let (diagonal, rest) = line.split_once(',').expect("a diagonal");
            let row = header
                .iter()
                .zip(rest.split(','))
                .map(|(name, value)| ((*name).to_owned(), value.parse().expect("a number")))
                .collect();
            (if diagonal == "/" { "right" } else { "left" }.to_owned(), row)
        })
        .collect()
}

#[test]
fn every_number_of_the_reference() {
    let rows = reference();
    assert_eq!(rows.len(), 10);
    for (diagonal, row) in rows {
        let problem = problem(row["n"] as usize, &diagonal);
        let mut computed = other_columns(&problem.mesh);
        computed.extend(values(&domain_constants(&problem).expect("regular forms")));
        assert_eq!(computed.len() + 1, row.len(), "every column is compared");
        for (name, value) in computed {
            assert!(
                (value / row[name] - 1.0).abs() < 1e-6,
                "{name}, {diagonal}, n = {}: {value:e}, expected {:e}",
                row["n"],
                row[name]
            );
        }
    }
}

/// On the paper's square θ is free on the bottom only: s₂² = tanh(π)/π by sin(πx) sinh(π(1 − y)), and
/// λ = π² + (π/2)² by sin(πx) cos(πy/2). Both constants come from one side, at second order.
#[test]
fn constants_of_the_temperature_tend_to_closed_forms_at_second_order() {
    let lambda = 1.25 * PI * PI;
    let (c_f, s2) = ((lambda / (1.0 + lambda)).sqrt(), (PI.tanh() / PI).sqrt());
    let levels: Vec<_> = [8, 16, 32, 64]
        .into_iter()
        .map(|n| {
            let problem = problem(n, "right");
            (n, problem.mesh.spacing(), domain_constants(&problem).expect("regular forms"))
        })
        .collect();
    for pair in levels.windows(2) {
        let error =
            |constants: &DomainConstants| [constants.c_f.unwrap().value - c_f, s2 - constants.s2.unwrap().value];
        for (coarse, fine) in error(&pair[0].2).into_iter().zip(error(&pair[1].2)) {
            assert!(fine > 0.0, "the bound comes from the wrong side");
            let order = (coarse / fine).log2();
            assert!((order - 2.0).abs() < 0.05, "order {order}");
        }
    }
    let table = ConstantsTable::new(&levels);
    for (i, exact) in [(0, None), (1, Some(c_f)), (3, Some(1.0)), (5, Some(s2))] {
        let found = table.limits[i].expect("a limit");
        if let Some(exact) = exact {
            // The limit is much nearer than the finest mesh, and the estimate of its error is no less than the error.
            let (off, finest) = ((found.value - exact).abs(), (levels[3].2.named()[i].1.unwrap().value - exact).abs());
            assert!(
                off <= found.error && (i == 3 || (off < 0.1 * finest && found.error < finest)),
                "{found:?}, expected {exact}"
            );
        }
        assert!(i == 3 || (found.order.expect("an order") - table.rows[3].orders[i].expect("an order")).abs() == 0.0);
    }
    // ‖v_ν‖ ≤ ‖∂_y v_y‖ with equality for v = (0, 1 − y), which is in V^h: the constant is 1 on every mesh.
    assert!(table.limits[3].expect("a limit").order.is_none());
    assert!(table.rows[0].orders[1].is_none() && table.rows[1].orders[1].is_none());
    let two: Vec<_> = levels[..2].iter().map(|(_, h, constants)| (*h, constants.c_f.unwrap())).collect();
    assert!(limit(&two).is_none());
}

/// A rectangle held on all sides: λ = π²(1/a² + 1/b²), from above at second order.
#[test]
fn the_laplacian_of_a_rectangle() {
    let (a, b) = (2.0, 0.7);
    let exact = PI * PI * (1.0 / (a * a) + 1.0 / (b * b));
    for diagonal in [Diagonal::Right, Diagonal::Crossed] {
        let error = |n: usize| {
            let mesh = Mesh::rectangle([a, b], [2 * n, n], diagonal).unwrap();
            let graph = Arc::new(Graph::of_mesh(&mesh));
            let (mass, laplace) = (forms::inner_h(&mesh, &graph), forms::d(&mesh, &graph, &[&identity(2)]));
            1.0 / supremum(&mesh, &mass, &laplace, &held(&mesh, 1, &["left", "right", "bottom", "top"])).value - exact
        };
        let errors = [8, 16, 32].map(error);
        for pair in errors.windows(2) {
            assert!(pair[1] > 0.0 && ((pair[0] / pair[1]).log2() - 2.0).abs() < 0.05, "{errors:?}");
        }
    }
}

/// A problem on a distorted mesh whose contact side is curved.
fn curved() -> Problem {
    let problem = problem(6, "right");
    let mut mesh = Mesh::rectangle([1.5, 1.0], [6, 4], Diagonal::Crossed).unwrap();
    let mut random = Random(7);
    for p in &mut mesh.points {
        p[1] += 0.2 * (p[0] - 0.4).powi(2) * (1.0 - p[1]);
        if p[1] < 0.9 && p[0] > 0.0 && p[0] < 1.5 {
            p[0] += 0.03 * random.number();
        }
    }
    mesh.check().expect("the distortion keeps the cells positive");
    changed(&problem, |data| data.mesh = Arc::new(mesh))
}

/// The largest eigenvalue of B x = μ K x by dense algebra: of L⁻¹BL⁻ᵀ, K = LLᵀ.
fn dense_supremum(free: &[bool], b: impl Fn(usize, usize) -> f64, k: impl Fn(usize, usize) -> f64) -> f64 {
    let dofs: Vec<usize> = (0..free.len()).filter(|&i| free[i]).collect();
    let matrix = |of: &dyn Fn(usize, usize) -> f64| Mat::from_fn(dofs.len(), dofs.len(), |i, j| of(dofs[i], dofs[j]));
    let (b, k) = (matrix(&b), matrix(&k));
    // K⁻¹B is similar to L⁻¹BL⁻ᵀ; its eigenvalues are real.
    let product = k.llt(Side::Lower).expect("positive definite").solve(&b);
    product.eigenvalues().expect("eigenvalues").iter().map(|e| e.re).fold(0.0, f64::max)
}

/// Entries of ∫ over segments, ℓ/6 (1 + δ_ij), for the components (r, c) weighed by `weight(ν)`.
fn segments(mesh: &Mesh, side: &str, components: usize, weight: impl Fn([f64; 2], usize, usize) -> f64) -> Mat<f64> {
    let mut matrix = Mat::zeros(mesh.points.len() * components, mesh.points.len() * components);
    for (_, facet) in mesh.facets[side].facets() {
        let [p, q] = [facet[0], facet[1]].map(|n| mesh.points[n as usize]);
        let (dx, dy) = (q[0] - p[0], q[1] - p[1]);
        let length = dx.hypot(dy);
        for (a, &i) in facet.iter().enumerate() {
            for (b, &j) in facet.iter().enumerate() {
                for r in 0..components {
                    for c in 0..components {
                        matrix[(i as usize * components + r, j as usize * components + c)] +=
                            length / 6.0 * (if a == b { 2.0 } else { 1.0 }) * weight([dy / length, -dx / length], r, c);
                    }
                }
            }
        }
    }
    matrix
}

#[test]
fn every_constant_agrees_with_dense_algebra_on_a_curved_body() {
    let problem = curved();
    let mesh = &problem.mesh;
    let graph = Arc::new(Graph::of_mesh(mesh));
    let (v, q) = (held(mesh, 2, &["top"]), held(mesh, 1, &["top", "left", "right"]));
    let (mass, strain, laplace) =
        (forms::inner_h(mesh, &graph), strains(mesh, &graph), forms::d(mesh, &graph, &[&identity(2)]));
    let vector = |i: usize, j: usize| if i % 2 == j % 2 { mass.get(i / 2, 0, j / 2, 0) } else { 0.0 };
    let energy = |i: usize, j: usize| strain.get(i / 2, i % 2, j / 2, j % 2);
    let heat = |i: usize, j: usize| laplace.get(i, 0, j, 0);
    let same = |r: usize, c: usize| if r == c { 1.0 } else { 0.0 };
    let on_contact = |weight: &dyn Fn([f64; 2], usize, usize) -> f64| {
        let matrix = segments(mesh, "bottom", 2, weight);
        dense_supremum(&v, |i, j| matrix[(i, j)], energy).sqrt()
    };
    let scalar = segments(mesh, "bottom", 1, |_, _, _| 1.0);
    let expected = [
        1.0 / (1.0 + dense_supremum(&v, vector, energy)).sqrt(),
        1.0 / (1.0 + dense_supremum(&q, |i, j| mass.get(i, 0, j, 0), heat)).sqrt(),
        on_contact(&|_, r, c| same(r, c)),
        on_contact(&|nu, r, c| nu[r] * nu[c]),
        on_contact(&|nu, r, c| same(r, c) - nu[r] * nu[c]),
        dense_supremum(&q, |i, j| scalar[(i, j)], heat).sqrt(),
    ];
    let computed = domain_constants(&problem).expect("regular forms");
    for ((name, constant), expected) in computed.named().into_iter().zip(expected) {
        let Constant { value, error } = constant.expect("a constant");
        assert!(
            (value - expected).abs() < 1e-11 * expected && error < 1e-11 * expected,
            "{name}: {value:e} ± {error:e}, expected {expected:e}"
        );
    }
    assert!(expected[3] < expected[2] && expected[4] < expected[2], "the parts are less than the whole");
}

fn scaled(problem: &Problem, factor: f64) -> DomainConstants {
    let mut mesh = (*problem.mesh).clone();
    for p in &mut mesh.points {
        *p = p.map(|x| factor * x);
    }
    domain_constants(&changed(problem, |data| data.mesh = Arc::new(mesh))).expect("regular forms")
}

/// s ~ √L and 1/c² − 1 ~ L² for a body of size L; in a unit that is a power of four the bits are the same.
#[test]
fn constants_follow_the_unit_of_length() {
    let problem = curved();
    let unit = domain_constants(&problem).expect("regular forms");
    let micro = scaled(&problem, 0.25f64.powi(10));
    for i in 2..6 {
        let (a, b) = (unit.named()[i].1.unwrap(), micro.named()[i].1.unwrap());
        assert_eq!(a.value, b.value * 1024.0, "{}", unit.named()[i].0);
    }
    let milli = scaled(&problem, 1e3);
    for i in 0..2 {
        let mu = |c: Option<Constant>| 1.0 / c.unwrap().value.powi(2) - 1.0;
        assert!((mu(milli.named()[i].1) / mu(unit.named()[i].1) / 1e6 - 1.0).abs() < 1e-10);
    }
}

#[test]
fn bits_do_not_depend_on_the_number_of_threads() {
    let problem = problem(48, "crossed");
    let [one, two] = [1, 2].map(|threads| {
        with_threads(Some(threads), || domain_constants(&problem)).expect("threads").expect("regular forms")
    });
    assert_eq!(one, two);
}

#[test]
fn constants_are_there_where_their_inequalities_are() {
    let all = |problem: &Problem| {
        domain_constants(problem).expect("regular forms").named().map(|(_, constant)| constant.is_some())
    };
    let full = problem(4, "right");
    assert_eq!(all(&full), [true; 6]);
    let without = changed(&full, |data| data.contacts.clear());
    assert_eq!(all(&without), [true, true, false, false, false, false]);
    let free = changed(&full, |data| data.boundary.iter_mut().for_each(|b| b.displacement = None));
    assert_eq!(all(&free), [false, true, false, false, false, true]);
    let insulated = changed(&full, |data| data.boundary.iter_mut().for_each(|b| b.temperature = None));
    assert_eq!(all(&insulated), [true, false, true, true, true, false]);

    // A second body that no side holds.
    let mut mesh = (*full.mesh).clone();
    let first = mesh.points.len() as u32;
    mesh.points.extend([[3.0, 0.0, 0.0], [4.0, 0.0, 0.0], [3.0, 1.0, 0.0]]);
    mesh.blocks.push(Block { element: mesh.blocks[0].element, region: 0, nodes: vec![first, first + 1, first + 2] });
    assert_eq!(all(&changed(&full, |data| data.mesh = Arc::new(mesh))), [false; 6]);

    // One cell: every temperature is prescribed, and 0 is the only function of Q^h. Quadrature of the laws is no
    // matter.
    let least = domain_constants(&problem(1, "right")).expect("regular forms");
    assert_eq!((least.c_f.unwrap().value, least.s2.unwrap().value, least.s2.unwrap().error), (1.0, 0.0, 0.0));
    let gauss = paper(&["mesh.n=4", "contact.quadrature=\"gauss\""]).problem;
    assert_eq!(domain_constants(&gauss), domain_constants(&full));
}

/// Where the sides that hold the body take in all nodes of Γ_C the traces vanish.
#[test]
fn prescribed_contact_nodes_bear_no_trace() {
    let hold = |data: &mut ProblemData| {
        for side in &mut data.boundary {
            (side.displacement, side.traction) = (Some(vec![Some(amontons::field::Field::default()); 2]), None);
        }
    };
    let held = changed(&problem(1, "right"), hold);
    let constants = domain_constants(&held).expect("nothing to factorize");
    assert_eq!(
        (constants.c_k.unwrap().value, constants.s1.unwrap().value, constants.s1_tangential.unwrap().value),
        (1.0, 0.0, 0.0)
    );
    // With more cells the corners of Γ_C alone are prescribed: smaller spaces, larger c and smaller s.
    let (held, free) =
        (changed(&problem(6, "right"), hold), domain_constants(&problem(6, "right")).expect("regular forms"));
    let less = domain_constants(&held).expect("regular forms");
    assert!(less.c_k.unwrap().value > free.c_k.unwrap().value);
    assert!(less.s1.unwrap().value < free.s1.unwrap().value && less.s1.unwrap().value > 0.0);
}
