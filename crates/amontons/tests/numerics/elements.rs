//! Every element on distorted meshes: patch tests, interpolation, and orders of problems solved with the library's
//! factor.
#![allow(clippy::float_cmp, reason = "counts are exact")]

use std::sync::Arc;

use crate::bodies::{cells, component, distorted, errors, on_boundary, unit};
use amontons::element::{self, Element, ShapeTable};
use amontons::expression::Expression;
use amontons::field::Field;
use amontons::forms::{self, Dilatation};
use amontons::linalg::{Backend, BlockMatrix, Graph, Layout, Supernodal, System};
use amontons::material::{Isotropic, StressState, TensorLaw};
use amontons::mesh::{Diagonal, Elements, FacetMap, Mesh};
use amontons::tensor::{Point, Sym, dot};

/// Solves K x = r with x prescribed where it is not free.
fn solve(mesh: &Mesh, matrix: &BlockMatrix, load: &[f64], prescribed: &[f64], free: &[bool]) -> Vec<f64> {
    let components = matrix.block_shape().0;
    let mut x: Vec<f64> = prescribed.iter().zip(free).map(|(v, &free)| if free { 0.0 } else { *v }).collect();
    let backend: Arc<dyn Backend> = Arc::new(Supernodal);
    let layout = Layout { points: &mesh.points, components, free, frames: &[], links: &[], rigid: &[], contact: &[] };
    let mut system = System::new(&backend, &Arc::new(matrix.clone()), &layout).expect("a positive definite matrix");
    // Once more for the rest: the solution is then that of the matrix to round-off.
    for _ in 0..2 {
        let applied = matrix.apply(&x);
        let rest: Vec<f64> = load.iter().zip(applied).map(|(r, a)| r - a).collect();
        let mut y = system.unknowns().gather(&rest);
        system.solve(&mut y).expect("a solution");
        system.unknowns().add(&y, &mut x);
    }
    x
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |m, v| m.max(v.abs()))
}

/// A linear displacement on the boundary gives that displacement inside, its constant stress, and no force at inner
/// nodes.
fn assert_patch(what: &str, mesh: &Mesh, volume: f64) {
    let gradient = [[0.3, -0.2, 0.15], [0.1, 0.5, -0.05], [-0.25, 0.2, -0.4]];
    let (dim, graph) = (mesh.dim, Arc::new(Graph::of_mesh(mesh)));
    let u: Vec<f64> =
        mesh.points.iter().flat_map(|p| (0..dim).map(|c| 0.7 + dot(&gradient[c], p)).collect::<Vec<_>>()).collect();
    let law = Isotropic::elastic(dim, 2.0, 0.3, StressState::PlaneStrain);
    let a = forms::a(mesh, &graph, &[&law.clone().into()]);
    let (boundary, force) = (on_boundary(mesh), a.apply(&u));
    let inside = || (0..u.len()).filter(|i| !boundary[i / dim]);
    assert!(largest(inside().map(|i| force[i])) < 1e-13, "{what}: forces at inner nodes");
    // Virtual work of the constant stress: ∫ σ:ε = |Ω| σ:ε.
    let strain = Sym::from_fn(dim, |i, j| 0.5 * (gradient[i][j] + gradient[j][i]));
    let work: f64 = u.iter().zip(&force).map(|(u, f)| u * f).sum();
    assert!((work - volume * law.map_dot(&strain)).abs() < 1e-13, "{what}: work {work}");

    let free: Vec<bool> = (0..u.len()).map(|i| !boundary[i / dim]).collect();
    let found = solve(mesh, &a, &vec![0.0; u.len()], &u, &free);
    assert!(largest((0..u.len()).map(|i| found[i] - u[i])) < 1e-13, "{what}: the displacement is not reproduced");

    // Heat: the same with a constant flux.
    let theta: Vec<f64> = mesh.points.iter().map(|p| 1.0 + 2.0 * p[0] - 3.0 * p[1] + 0.5 * p[2]).collect();
    let d = forms::d(mesh, &graph, &[&Sym::identity(dim)]);
    let free: Vec<bool> = boundary.iter().map(|b| !b).collect();
    let found = solve(mesh, &d, &vec![0.0; theta.len()], &theta, &free);
    assert!(
        largest((0..theta.len()).map(|i| found[i] - theta[i])) < 1e-13,
        "{what}: the temperature is not reproduced"
    );
}

#[test]
fn patch_tests() {
    for element in cells() {
        assert_patch(element.name, &distorted(element, 3, 0.2), 1.0);
    }
    assert_patch("mixed cells", &mixed(), MIXED);
}

/// Volume of the mixed mesh, a box.
const MIXED: f64 = 1.0 * 0.8 * 1.1;

/// Hexahedra below and tetrahedra above with pyramids between them, with straight edges.
fn mixed() -> Mesh {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes/blocks_pyramids.msh");
    let mut mesh = amontons::mesh::read(&path).expect("a mesh");
    assert_eq!(mesh.blocks.iter().filter(|block| block.element.name == "P2 pyramid").count(), 1);
    let curved = mesh.points.clone();
    for block in &mesh.blocks {
        let linear = Element::find(block.element.shape, 1).expect("a linear element");
        let table = ShapeTable::at(linear, block.element.nodes);
        for cell in block.cells() {
            for (q, &node) in cell.iter().enumerate() {
                let shares = || cell.iter().zip(table.values(q));
                mesh.points[node as usize] =
                    std::array::from_fn(|d| shares().map(|(&n, v)| curved[n as usize][d] * v).sum());
            }
        }
    }
    mesh.check().expect("positive cells");
    mesh
}

/// Quadratic functions are among those of quadratic cells with straight edges, which have the volume of the body.
#[test]
fn quadratic_functions_are_reproduced() {
    let f = |[x, y, z]: &Point| {
        let value = 1.0 + x * x - 2.0 * y * y + 0.5 * z * z + x * y - 3.0 * y * z + 2.0 * z * x - x + y;
        (value, [2.0 * x + y + 2.0 * z - 1.0, -4.0 * y + x - 3.0 * z + 1.0, z - 3.0 * y + 2.0 * x])
    };
    for (mesh, volume) in [(distorted(&element::P2_PYRAMID, 3, 0.2), 1.0), (mixed(), MIXED)] {
        let values: Vec<f64> = mesh.points.iter().map(|p| f(p).0).collect();
        let [l2, h1] = errors(&mesh, &values, f);
        assert!(l2 < 1e-14 && h1 < 1e-13, "{l2:e} {h1:e}");
        let [size, _] = errors(&mesh, &vec![0.0; values.len()], |_| (1.0, [0.0; 3]));
        assert!((size * size - volume).abs() < 1e-13, "{}", size * size);
    }
}

/// Pyramids that are refined, into pyramids and tetrahedra, converge as other quadratic cells do.
#[test]
fn orders_on_refined_pyramids() {
    for mesh in [unit(&element::P2_PYRAMID, 1), mixed()] {
        let coarse = mesh.refined().expect("a mesh");
        let fine = coarse.refined().expect("a mesh");
        let [coarse, fine] = [&coarse, &fine].map(heat_error);
        assert_orders("refined pyramids", 2, coarse, fine);
    }
}

trait Work {
    /// σ:ε of the strain, the component 33 of plane strain left out.
    fn map_dot(&self, strain: &Sym) -> f64;
}

impl Work for Isotropic {
    fn map_dot(&self, strain: &Sym) -> f64 {
        self.value(&[0.0; 3], strain).dot(strain)
    }
}

/// The direction of the waves; unequal components, so that no symmetry of the mesh helps.
const WAVE: Point = [1.3, 0.9, 1.1];

fn wave(dim: usize) -> Point {
    std::array::from_fn(|d| if d < dim { WAVE[d] } else { 0.0 })
}

/// sin(k·x + 1/2) with its gradient.
fn sine(dim: usize) -> impl Fn(&Point) -> (f64, Point) {
    let k = wave(dim);
    move |x| {
        let phase = dot(&k, x) + 0.5;
        (phase.sin(), k.map(|k| k * phase.cos()))
    }
}

fn slopes(coarse: [f64; 2], fine: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|i| (coarse[i] / fine[i]).log2())
}

#[track_caller]
fn assert_orders(what: &str, degree: usize, coarse: [f64; 2], fine: [f64; 2]) {
    let [l2, h1] = slopes(coarse, fine);
    let p = degree as f64;
    assert!(
        (l2 - p - 1.0).abs() < 0.15 && (h1 - p).abs() < 0.15,
        "{what}: orders {l2:.3} in L², {h1:.3} in H¹, expected {} and {p}",
        p + 1.0
    );
}

/// Interpolation has the orders p + 1 in L² and p in H¹.
#[test]
fn interpolation_orders() {
    for element in cells() {
        let f = sine(element.dim());
        let [coarse, fine] = [4, 8].map(|n| {
            let mesh = unit(element, n);
            let values: Vec<f64> = mesh.points.iter().map(|p| f(p).0).collect();
            errors(&mesh, &values, &f)
        });
        assert_orders(element.name, element.degree, coarse, fine);
    }
}

/// The field factor · sin(k·x + 1/2).
fn field(dim: usize, factor: f64) -> Field {
    let k = wave(dim);
    Field::Expression(
        Expression::parse(&format!("{factor:?}*sin({:?}*x + {:?}*y + {:?}*z + 0.5)", k[0], k[1], k[2]))
            .expect("an expression"),
    )
}

/// Lamé's constants of the elastic problems.
const LAME: [f64; 2] = [1.5, 1.0];

/// Error of u = a sin(k·x + 1/2) with −Div σ = ((λ + μ)(a·k)k + μ|k|²a) sin(k·x + 1/2), in L² and H¹.
fn elastic_error(mesh: &Mesh) -> [f64; 2] {
    let ([lambda, mu], amplitude) = (LAME, [1.0, -0.6, 0.4]);
    let (dim, k) = (mesh.dim, wave(mesh.dim));
    let graph = Arc::new(Graph::of_mesh(mesh));
    let law = Isotropic::lame(dim, lambda, 2.0 * mu, StressState::PlaneStrain);
    let matrix = forms::a(mesh, &graph, &[&law.clone().into()]);
    let force: Vec<Field> = (0..dim)
        .map(|c| field(dim, (lambda + mu) * dot(&amplitude, &k) * k[c] + mu * dot(&k, &k) * amplitude[c]))
        .collect();
    let load = forms::f(mesh, &force, &[]).at(0.0);
    let (exact, boundary) = (sine(dim), on_boundary(mesh));
    let u: Vec<f64> =
        mesh.points.iter().flat_map(|p| amplitude[..dim].iter().map(|a| a * exact(p).0).collect::<Vec<_>>()).collect();
    let free: Vec<bool> = (0..u.len()).map(|i| !boundary[i / dim]).collect();
    let found = solve(mesh, &matrix, &load, &u, &free);
    let mut sums = [0.0; 2];
    for c in 0..dim {
        let scaled = |x: &Point| {
            let (value, gradient) = exact(x);
            (amplitude[c] * value, gradient.map(|g| amplitude[c] * g))
        };
        let error = errors(mesh, &component(&found, dim, c), scaled);
        (0..2).for_each(|i| sums[i] += error[i] * error[i]);
    }
    sums.map(f64::sqrt)
}

fn heat_error(mesh: &Mesh) -> [f64; 2] {
    let (dim, k) = (mesh.dim, wave(mesh.dim));
    let graph = Arc::new(Graph::of_mesh(mesh));
    // 𝓚 = κ with κk·k: an anisotropic tensor.
    let kappa = Sym::from_fn(dim, |i, j| if i == j { 1.0 + 0.5 * i as f64 } else { 0.2 });
    let matrix = forms::d(mesh, &graph, &[&kappa]);
    let load = forms::q(mesh, &field(dim, dot(&kappa.apply(&k), &k)), &[]).at(0.0);
    let exact = sine(dim);
    let theta: Vec<f64> = mesh.points.iter().map(|p| exact(p).0).collect();
    let free: Vec<bool> = on_boundary(mesh).into_iter().map(|b| !b).collect();
    errors(mesh, &solve(mesh, &matrix, &load, &theta, &free), exact)
}

/// Meshes of the solved problems: an element with the numbers of cells a side.
fn solved() -> [(&'static Element, [usize; 2]); 9] {
    [
        (&element::P2_SEGMENT, [8, 16]),
        (&element::P1_TRIANGLE, [16, 32]),
        (&element::P2_TRIANGLE, [8, 16]),
        (&element::Q1_QUADRILATERAL, [8, 16]),
        (&element::Q2_QUADRILATERAL, [8, 16]),
        (&element::P1_TETRAHEDRON, [8, 16]),
        (&element::P2_TETRAHEDRON, [3, 6]),
        (&element::Q1_HEXAHEDRON, [6, 12]),
        (&element::P2_PYRAMID, [3, 6]),
    ]
}

#[test]
fn orders_of_an_elastic_problem() {
    for (element, n) in solved() {
        let [coarse, fine] = n.map(|n| elastic_error(&unit(element, n)));
        assert_orders(element.name, element.degree, coarse, fine);
    }
}

#[test]
fn orders_of_a_heat_problem() {
    for (element, n) in solved() {
        let [coarse, fine] = n.map(|n| heat_error(&unit(element, n)));
        assert_orders(element.name, element.degree, coarse, fine);
    }
}

/// Error in L² of pure bending in plane strain, u = (x y, −(x² + ν/(1−ν) y²)/2), of a cantilever (0, 4) × (−½, ½):
/// exact at its left end, the traction σ_xx = E/(1−ν²) y at its right. In three dimensions it is held between planes.
fn bending_error(element: &'static Element, n: usize, nu: f64, dilatation: Dilatation) -> f64 {
    let mesh = if element.dim() == 2 {
        Mesh::rectangle_of(Elements::Q1, [4.0, 1.0], [4 * n, n], Diagonal::Right)
    } else {
        Mesh::box_([4.0, 1.0, 0.5], [4 * n, n, 1], Elements::Q1)
    };
    let (mesh, transverse) = (mesh.expect("a beam"), nu / (1.0 - nu));
    let (dim, graph) = (mesh.dim, Arc::new(Graph::of_mesh(&mesh)));
    let matrix = forms::tensor_form(
        &mesh,
        &graph,
        &[&Isotropic::elastic(dim, 1.0, nu, StressState::PlaneStrain).into()],
        &[dilatation],
    );
    // The load by hand: the traction at the nodes of the right end is linear on the height, as its functions are.
    let mut load = vec![0.0; dim * mesh.points.len()];
    let set = &mesh.facets["right"];
    for block in &set.blocks {
        let table = ShapeTable::new(block.element, 3);
        let mut map = FacetMap::new(&mesh, &table);
        for facet in block.nodes.chunks_exact(block.element.nodes.len()) {
            for (q, weight) in table.weights.iter().enumerate() {
                map.at(facet, q);
                let traction = (map.position[1] - 0.5) / (1.0 - nu * nu);
                facet
                    .iter()
                    .zip(map.values())
                    .for_each(|(&node, v)| load[dim * node as usize] += weight * map.area * v * traction);
            }
        }
    }
    let exact = |x: &Point| {
        let (x, y) = (x[0], x[1] - 0.5);
        [(x * y, [y, x, 0.0]), (-0.5 * (x * x + transverse * y * y), [-x, -transverse * y, 0.0]), (0.0, [0.0; 3])]
    };
    let u: Vec<f64> =
        mesh.points.iter().flat_map(|p| exact(p)[..dim].iter().map(|u| u.0).collect::<Vec<_>>()).collect();
    let free: Vec<bool> = mesh.points.iter().flat_map(|p| (0..dim).map(move |c| p[0] > 0.0 && c != 2)).collect();
    let found = solve(&mesh, &matrix, &load, &u, &free);
    (0..dim).map(|c| errors(&mesh, &component(&found, dim, c), |x| exact(x)[c])[0].powi(2)).sum::<f64>().sqrt()
}

/// A nearly incompressible cantilever, ν = 0.4999: bilinear and trilinear elements lock, and their error stays near
/// that of no deflection at all; with the mean dilatation it falls at second order.
#[test]
fn the_mean_dilatation_does_not_lock() {
    for element in [&element::Q1_QUADRILATERAL, &element::Q1_HEXAHEDRON] {
        let at = |n: usize, dilatation| bending_error(element, n, 0.4999, dilatation);
        let (full, mean) = ([8, 16].map(|n| at(n, Dilatation::Full)), [8, 16].map(|n| at(n, Dilatation::Mean)));
        let order = (mean[0] / mean[1]).log2();
        assert!((order - 2.0).abs() < 0.15, "{}: order {order} with the mean dilatation", element.name);
        assert!(
            full[1] > 10.0 * mean[1],
            "{}: error {:e} with the full dilatation, {:e} with its mean",
            element.name,
            full[1],
            mean[1]
        );
    }
}

/// Where the strain is constant the mean of its trace is the trace: the patch test holds with the mean dilatation.
#[test]
fn patch_test_with_the_mean_dilatation() {
    for element in cells() {
        let mesh = distorted(element, 3, 0.2);
        let (dim, graph) = (mesh.dim, Arc::new(Graph::of_mesh(&mesh)));
        let law = Isotropic::lame(dim, 5.0, 2.0, StressState::PlaneStrain);
        let [full, mean] = [Dilatation::Full, Dilatation::Mean]
            .map(|dilatation| forms::tensor_form(&mesh, &graph, &[&law.clone().into()], &[dilatation]));
        let u: Vec<f64> = mesh
            .points
            .iter()
            .flat_map(|p| (0..dim).map(|c| 0.3 * p[c] - 0.2 * p[(c + 1) % 3]).collect::<Vec<_>>())
            .collect();
        let (a, b, boundary) = (full.apply(&u), mean.apply(&u), on_boundary(&mesh));
        assert!(largest((0..u.len()).filter(|i| !boundary[i / dim]).map(|i| b[i])) < 1e-13, "{}", element.name);
        let work = |force: &[f64]| u.iter().zip(force).map(|(u, f)| u * f).sum::<f64>();
        assert!((work(&a) - work(&b)).abs() < 1e-13, "{}", element.name);
        assert!(mean.asymmetry(&mean) < 1e-14);
    }
}
