//! Patch tests, rigid motion and symmetry of the forms, against formulas.
#![allow(clippy::float_cmp, reason = "counts are exact")]

use std::sync::Arc;

use amontons::element::P1_TRIANGLE;
use amontons::expression::Expression;
use amontons::field::{Field, Law};
use amontons::forms::{self, Dilatation};
use amontons::linalg::{BlockMatrix, Graph};
use amontons::material::{Carreau, Hencky, Isotropic, StressState, TensorLaw};
use amontons::mesh::{Block, Diagonal, Elements, Mesh};
use amontons::tensor::Sym;

/// Of a body in two regions, one of which takes the mean dilatation, the form is the sum of those of both parts, each
/// with its own strain and with nothing in the other region.
#[test]
fn each_region_has_its_own_dilatation() {
    for (dim, elements) in [(2, Elements::Q1), (2, Elements::P2), (3, Elements::Q1)] {
        let mut mesh = if dim == 2 {
            Mesh::rectangle_of(elements, [2.0, 1.0], [4, 3], Diagonal::Right)
        } else {
            Mesh::box_([2.0, 1.0, 1.5], [2, 2, 2], elements)
        }
        .expect("a mesh");
        // Cells that are no parallelograms, half of them in a second region.
        for (i, x) in mesh.points.iter_mut().enumerate() {
            x[0] += 0.05 * (i as f64 * 1.7).sin();
            x[1] += 0.05 * (i as f64 * 2.3).cos();
        }
        let (mut stiff, n) = (mesh.blocks[0].clone(), mesh.blocks[0].element.nodes.len());
        let half = mesh.blocks[0].len() / 2 * n;
        stiff.nodes = mesh.blocks[0].nodes.split_off(half);
        stiff.region = 1;
        mesh.blocks.push(stiff);
        mesh.regions = vec!["soft".to_owned(), "stiff".to_owned()];
        let graph = Arc::new(Graph::of_mesh(&mesh));
        let law = |young: f64, nu: f64| Isotropic::elastic(dim, young, nu, StressState::PlaneStrain);
        let [soft, stiff, none] = [law(1.0, 0.499), law(40.0, 0.3), law(0.0, 0.0)].map(Law::from);
        let [mean, full] = [[Dilatation::Mean], [Dilatation::Full]];
        let u: Vec<f64> = (0..graph.len() * dim).map(|i| (i as f64 * 0.9).sin()).collect();
        let of = |laws: &[&Law<dyn TensorLaw>], which: &[Dilatation]| {
            forms::tensor_form(&mesh, &graph, laws, which).apply(&u)
        };
        let mixed = of(&[&soft, &stiff], &[Dilatation::Mean, Dilatation::Full]);
        let parts = [of(&[&soft, &none], &mean), of(&[&none, &stiff], &full)];
        let largest = mixed.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        for (i, mixed) in mixed.iter().enumerate() {
            assert!((mixed - parts[0][i] - parts[1][i]).abs() < 1e-13 * largest, "{dim} {elements:?}");
        }
        let both = of(&[&soft, &stiff], &mean);
        assert!(mixed.iter().zip(&both).any(|(a, b)| (a - b).abs() > 1e-3 * largest), "the choice acts");
        let residual = forms::residual(&mesh, &[&soft, &stiff], &[Dilatation::Mean, Dilatation::Full], &u, &[]);
        assert!(mixed.iter().zip(&residual).all(|(a, b)| (a - b).abs() < 1e-12 * largest));
    }
}

/// A rectangle whose inner nodes are moved off the grid.
fn distorted(diagonal: Diagonal) -> (Mesh, Arc<Graph>) {
    let mut mesh = Mesh::rectangle([2.0, 1.0], [7, 5], diagonal).expect("a mesh of 7 × 5 squares");
    for (i, p) in mesh.points.iter_mut().enumerate() {
        if p[0] > 0.0 && p[0] < 2.0 && p[1] > 0.0 && p[1] < 1.0 {
            p[0] += 0.05 * (13.0 * i as f64).sin();
            p[1] += 0.04 * (7.0 * i as f64).cos();
        }
    }
    mesh.check().expect("the distortion keeps the cells positive");
    let graph = Arc::new(Graph::of_mesh(&mesh));
    (mesh, graph)
}

const DIAGONALS: [Diagonal; 3] = [Diagonal::Right, Diagonal::Left, Diagonal::Crossed];

fn vector(mesh: &Mesh, f: impl Fn(f64, f64) -> [f64; 2]) -> Vec<f64> {
    mesh.points.iter().flat_map(|p| f(p[0], p[1])).collect()
}

fn on_boundary(mesh: &Mesh, node: usize) -> bool {
    let p = mesh.points[node];
    p[0] == 0.0 || p[0] == 2.0 || p[1] == 0.0 || p[1] == 1.0
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |m, v| m.max(v.abs()))
}

/// A linear displacement has constant stress: forces vanish at inner nodes, and the energy is ½|Ω| 𝓔ε:ε.
#[test]
fn constant_strain() {
    let strain = Sym::from_fn(2, |i, j| [[0.3, -0.2], [-0.2, 0.5]][i][j]);
    for diagonal in DIAGONALS {
        let (mesh, graph) = distorted(diagonal);
        for law in [
            Isotropic::elastic(2, 2.0, 0.1, StressState::PlaneStress),
            Isotropic::elastic(2, 3.0, 0.4, StressState::PlaneStrain),
        ] {
            let a = forms::a(&mesh, &graph, &[&law.clone().into()]);
            let u = vector(&mesh, |x, y| [0.3 * x - 0.2 * y + 1.0, -0.2 * x + 0.5 * y - 2.0]);
            let force = a.apply(&u);
            assert!(
                largest(
                    (0..mesh.points.len())
                        .filter(|&n| !on_boundary(&mesh, n))
                        .flat_map(|n| [force[2 * n], force[2 * n + 1]])
                ) < 1e-13
            );
            let energy: f64 = u.iter().zip(&force).map(|(u, f)| u * f).sum();
            let mut stress = law.value(&[0.0; 3], &strain);
            stress.0[3] = 0.0;
            assert!((energy - 2.0 * stress.dot(&strain)).abs() < 1e-12);
        }
    }
}

/// A linear temperature has constant flux.
#[test]
fn constant_flux() {
    let conductivity = Sym::from_fn(2, |i, j| [[1.0, 0.2], [0.2, 0.7]][i][j]);
    for diagonal in DIAGONALS {
        let (mesh, graph) = distorted(diagonal);
        let d = forms::d(&mesh, &graph, &[&conductivity]);
        let theta: Vec<f64> = mesh.points.iter().map(|p| 4.0 + 2.0 * p[0] - 3.0 * p[1]).collect();
        let heat = d.apply(&theta);
        assert!(largest((0..mesh.points.len()).filter(|&n| !on_boundary(&mesh, n)).map(|n| heat[n])) < 1e-13);
        // ∫ 𝓚∇θ·∇θ = |Ω| (4·1 − 12·0.2 + 9·0.7).
        let energy: f64 = theta.iter().zip(&heat).map(|(t, h)| t * h).sum();
        assert!((energy - 2.0 * (4.0 - 2.4 + 6.3)).abs() < 1e-12);
    }
}

/// Translations and the linearised rotation have no strain: no force, no heat.
#[test]
fn rigid_motion() {
    for diagonal in DIAGONALS {
        let (mesh, graph) = distorted(diagonal);
        let a = forms::a(&mesh, &graph, &[&Isotropic::elastic(2, 2.0, 0.3, StressState::PlaneStrain).into()]);
        let e = forms::e(&mesh, &graph, &[&Sym::from_fn(2, |_, _| 1.0)], &[Dilatation::Full]);
        for motion in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
            let u = vector(&mesh, |x, y| [motion[0] - motion[2] * y, motion[1] + motion[2] * x]);
            assert!(largest(a.apply(&u).into_iter()) < 1e-13, "force of the rigid motion {motion:?}");
            assert!(largest(e.apply(&u).into_iter()) < 1e-14, "heat of the rigid motion {motion:?}");
            // The product by entries, not by differences, agrees.
            for i in 0..graph.len() {
                let sum: f64 = a.row(i).map(|(j, block)| block[0] * u[2 * j] + block[1] * u[2 * j + 1]).sum();
                assert!(sum.abs() < 1e-12);
            }
        }
    }
}

/// a, b, d and the inner product are symmetric; m is the transpose of e for 𝓜 = 𝓡.
#[test]
fn symmetry() {
    for diagonal in DIAGONALS {
        let (mesh, graph) = distorted(diagonal);
        let tensor = Sym::from_fn(2, |i, j| [[0.9, -0.4], [-0.4, 1.1]][i][j]);
        let symmetric: [BlockMatrix; 4] = [
            forms::a(&mesh, &graph, &[&Isotropic::elastic(2, 2.0, 0.3, StressState::PlaneStrain).into()]),
            forms::b(&mesh, &graph, &[&Isotropic::lame(2, 10.0, 10.0, StressState::PlaneStress).into()]),
            forms::d(&mesh, &graph, &[&tensor]),
            forms::inner_h(&mesh, &graph),
        ];
        for matrix in &symmetric {
            assert!(matrix.asymmetry(matrix) < 1e-15);
        }
        assert!(
            forms::m(&mesh, &graph, &[&tensor], &[Dilatation::Full]).asymmetry(&forms::e(
                &mesh,
                &graph,
                &[&tensor],
                &[Dilatation::Full]
            )) < 1e-15
        );
    }
}

/// ∫ 1 = |Ω| and ∫ x y over the rectangle (0,2)×(0,1) = 1, by the mass matrix.
#[test]
fn inner_product_integrates() {
    for diagonal in DIAGONALS {
        let (mesh, graph) = distorted(diagonal);
        let mass = forms::inner_h(&mesh, &graph);
        let [one, x, y]: [Vec<f64>; 3] =
            [|_: f64, _: f64| 1.0, |x, _| x, |_, y| y].map(|f| mesh.points.iter().map(|p| f(p[0], p[1])).collect());
        let form = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(mass.apply(b)).map(|(a, b)| a * b).sum() };
        assert!((form(&one, &one) - 2.0).abs() < 1e-14);
        assert!((form(&x, &y) - 1.0).abs() < 1e-14);
        assert!((form(&x, &x) - 8.0 / 3.0).abs() < 1e-13);
    }
}

/// A wavy displacement of a body in three dimensions, small against the strain at which the law softens and beyond it.
fn wavy(mesh: &Mesh, size: f64, phase: f64) -> Vec<f64> {
    mesh.points
        .iter()
        .flat_map(|p| [0.0, 1.0, 2.0].map(|c| size * (2.0 * p[0] - p[1] + 0.7 * p[2] * (c + 1.0) + phase + c).sin()))
        .collect()
}

/// Of a linear law the residual is the form, and the tangent too, in every choice of the strain.
#[test]
fn the_tangent_of_a_linear_law_is_its_form() {
    let mesh = Mesh::box_([1.0, 0.8, 1.2], [3, 2, 3], Elements::Q1).expect("a box");
    let graph = Arc::new(Graph::of_mesh(&mesh));
    let law = Isotropic::elastic(3, 2.0, 0.3, StressState::PlaneStrain).into();
    let u = wavy(&mesh, 0.1, 0.3);
    for dilatation in [Dilatation::Full, Dilatation::Mean] {
        let form = forms::tensor_form(&mesh, &graph, &[&law], &[dilatation]);
        let residual = forms::residual(&mesh, &[&law], &[dilatation], &u, &[]);
        assert!(largest(form.apply(&u).iter().zip(&residual).map(|(a, b)| a - b)) < 1e-14);
        assert!(forms::tangent(&mesh, &graph, &[&law], &[dilatation], &u, &[]).asymmetry(&form) < 1e-14);
    }
}

/// The tangent is the derivative of the residual: the error of its central difference falls with the square of the
/// step.
#[test]
fn the_tangent_is_the_derivative_of_the_residual() {
    let law = Hencky::new(3.0, Carreau::new(1.0, 0.2, 5.0, 0.3).expect("a law")).expect("a law").into();
    for elements in [Elements::P1, Elements::P2, Elements::Q1] {
        let mesh = Mesh::box_([1.0, 0.8, 1.2], [2, 2, 2], elements).expect("a box");
        let graph = Arc::new(Graph::of_mesh(&mesh));
        let (u, w) = (wavy(&mesh, 0.2, 0.3), wavy(&mesh, 0.2, 1.9));
        for dilatation in [Dilatation::Full, Dilatation::Mean] {
            let exact = forms::tangent(&mesh, &graph, &[&law], &[dilatation], &u, &[]).apply(&w);
            let error = |h: f64| {
                let at = |s: f64| {
                    forms::residual(
                        &mesh,
                        &[&law],
                        &[dilatation],
                        &u.iter().zip(&w).map(|(u, w)| u + s * w).collect::<Vec<_>>(),
                        &[],
                    )
                };
                let (plus, minus) = (at(h), at(-h));
                largest(exact.iter().enumerate().map(|(i, e)| (plus[i] - minus[i]) / (2.0 * h) - e))
            };
            let (coarse, fine) = (error(4e-2), error(2e-2));
            assert!(
                ((coarse / fine).log2() - 2.0).abs() < 0.1,
                "{elements:?} {dilatation:?}: errors {coarse:e}, {fine:e}"
            );
        }
    }
}

/// Laws, tensors and factors by region: each region has its own, and the last one serves the rest.
#[test]
fn regions_have_their_own_laws() {
    let mut mesh = Mesh::rectangle([2.0, 1.0], [4, 4], Diagonal::Right).expect("a rectangle");
    let cells: Vec<Vec<u32>> = mesh.blocks[0].cells().map(<[u32]>::to_vec).collect();
    let right = |cell: &[u32]| cell.iter().map(|&n| mesh.points[n as usize][0]).sum::<f64>() > 3.0;
    let part = |side: bool| cells.iter().filter(|c| right(c) == side).flatten().copied().collect::<Vec<u32>>();
    let (left, right) = (part(false), part(true));
    mesh.blocks =
        [(0, left), (1, right)].map(|(region, nodes)| Block { element: &P1_TRIANGLE, region, nodes }).to_vec();
    mesh.regions = vec!["soft".into(), "hard".into()];
    let graph = Arc::new(Graph::of_mesh(&mesh));
    let [soft, hard] = [1.0, 10.0].map(|e| Isotropic::elastic(2, e, 0.25, StressState::PlaneStress).into());
    let u = vector(&mesh, |x, y| [0.1 * x, -0.025 * y]);
    let work = |laws: &[&Law<dyn TensorLaw>]| -> f64 {
        u.iter().zip(forms::a(&mesh, &graph, laws).apply(&u)).map(|(u, f)| u * f).sum()
    };
    // Uniaxial stress E ε on unit areas: E ε² a region.
    assert!((work(&[&soft, &hard]) - 0.01 * 11.0).abs() < 1e-14 && (work(&[&soft]) - 0.01 * 2.0).abs() < 1e-14);
    let ones = vec![1.0; mesh.points.len()];
    let mass: f64 = forms::weighted_inner_h(&mesh, &graph, &[3.0, 5.0]).apply(&ones).iter().sum();
    assert!((mass - 8.0).abs() < 1e-13);
    let theta: Vec<f64> = mesh.points.iter().map(|p| p[0]).collect();
    let [one, seven] = [1.0, 7.0].map(|k| Sym::from_fn(2, |i, j| if i == j { k } else { 0.0 }));
    let heat: f64 = theta.iter().zip(forms::d(&mesh, &graph, &[&one, &seven]).apply(&theta)).map(|(t, q)| t * q).sum();
    assert!((heat - 8.0).abs() < 1e-13);
}

/// A load that does not vary with time is added piece by piece, one that does is kept whole: they are the same to the
/// bit, and their sum is ∫ (1 + x y) over the unit square.
#[test]
fn a_load_of_many_cells_is_the_sum_of_its_pieces() {
    let n = 40;
    let mut mesh = Mesh::rectangle([1.0, 1.0], [n, n], Diagonal::Left).expect("a mesh");
    for (i, x) in mesh.points.iter_mut().enumerate().filter(|(_, x)| (0..2).all(|d| x[d] > 0.0 && x[d] < 1.0)) {
        x[0] += 0.2 / n as f64 * (i as f64 * 1.7).sin();
        x[1] += 0.2 / n as f64 * (i as f64 * 2.3).cos();
    }
    let load = |source: &str| {
        let source = Field::Expression(Expression::parse(source).expect("an expression"));
        forms::q(&mesh, &source, &[]).at(0.0)
    };
    let (fixed, varying) = (load("1 + x*y"), load("1 + x*y + 0*t"));
    let others = fixed.iter().zip(varying.iter()).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
    assert_eq!((fixed.len(), others), (41 * 41, 0));
    let sum: f64 = fixed.iter().sum();
    assert!((sum - 1.25).abs() < 1e-13, "{sum}");
}
