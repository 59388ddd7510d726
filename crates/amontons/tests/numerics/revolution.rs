//! Bodies of revolution against closed forms, and against the same body in three dimensions.
#![allow(clippy::float_cmp, reason = "counts are exact")]

use std::f64::consts::TAU;
use std::sync::Arc;

use crate::bodies::{component, errors, on_boundary};
use amontons::contact::{ContactBoundary, Quadrature};
use amontons::forms::{self, Dilatation};
use amontons::linalg::{Backend, Graph, Layout, Supernodal, System};
use amontons::material::{Isotropic, StressState};
use amontons::mesh::{Diagonal, Elements, Mesh};
use amontons::output::strain_norm;
use amontons::tensor::Sym;

const EVERY: [Elements; 4] = [Elements::P1, Elements::P2, Elements::Q1, Elements::Q2];

/// The half section (from, from + 1) × (0, 1) of a tube, or of a solid cylinder from 0.
fn section(elements: Elements, from: f64, n: usize) -> Mesh {
    let mut mesh = Mesh::rectangle_of(elements, [1.0, 1.0], [n, n], Diagonal::Right).expect("a rectangle");
    mesh.points.iter_mut().for_each(|p| p[0] += from);
    Mesh { axisymmetric: true, ..mesh }
}

/// u = (αr, βz) has the constant strain α, β, α: no force at inner nodes, also on the axis along it, and the energy of
/// it.
#[test]
fn constant_strain() {
    let (alpha, beta) = (0.3, -0.5);
    for elements in EVERY {
        for from in [0.0, 1.0] {
            let mesh = section(elements, from, 4);
            let graph = Arc::new(Graph::of_mesh(&mesh));
            let law = Isotropic::elastic(3, 2.0, 0.3, StressState::PlaneStrain);
            let u: Vec<f64> = mesh.points.iter().flat_map(|p| [alpha * p[0], beta * p[1]]).collect();
            let volume = 0.5 * TAU * ((from + 1.0).powi(2) - from * from);
            // λ = Eν/((1+ν)(1−2ν)), 2μ = E/(1+ν).
            let energy = volume
                * (2.0 * 0.3 / (1.3 * 0.4) * (2.0 * alpha + beta).powi(2)
                    + 2.0 / 1.3 * (2.0 * alpha * alpha + beta * beta));
            for dilatation in [Dilatation::Full, Dilatation::Mean] {
                let force = forms::tensor_form(&mesh, &graph, &[&law.clone().into()], &[dilatation]).apply(&u);
                let boundary = on_boundary(&mesh);
                for (i, f) in force.iter().enumerate().filter(|(i, _)| {
                    !boundary[i / 2]
                        || (i % 2 == 1
                            && mesh.points[i / 2][0] == 0.0
                            && mesh.points[i / 2][1] > 0.0
                            && mesh.points[i / 2][1] < 1.0)
                }) {
                    assert!(f.abs() < 1e-13, "{elements:?} from {from}: force {f:e} at {:?}", mesh.points[i / 2]);
                }
                let found: f64 = u.iter().zip(&force).map(|(u, f)| u * f).sum();
                assert!(
                    (found - energy).abs() < 1e-12 * energy,
                    "{elements:?} from {from}: {found}, expected {energy}"
                );
            }
            assert!((strain_norm(&mesh, &u) - (volume * (2.0 * alpha * alpha + beta * beta)).sqrt()).abs() < 1e-13);
            // The thermal form on a unit temperature: ∫ 𝓜:ε(v) = |Ω| 𝓜:ε.
            let tensor = Sym::from_fn(3, |i, j| [[0.7, 0.1, 0.0], [0.1, 0.4, 0.0], [0.0, 0.0, 1.1]][i][j]);
            let (m, e) = (
                forms::m(&mesh, &graph, &[&tensor], &[Dilatation::Full]),
                forms::e(&mesh, &graph, &[&tensor], &[Dilatation::Full]),
            );
            let work: f64 = u.iter().zip(m.apply(&vec![1.0; mesh.points.len()])).map(|(u, f)| u * f).sum();
            assert!((work - volume * (0.7 * alpha + 0.4 * beta + 1.1 * alpha)).abs() < 1e-12, "{elements:?}: {work}");
            assert!(m.asymmetry(&e) < 1e-14);
        }
    }
}

/// A tube between two radii whose ends are held axially: u = A r + B/r (Lamé). The orders are p + 1 in L² and p in H¹.
#[test]
fn a_tube_has_the_displacement_of_lame() {
    let (a, b) = (0.4, 0.9);
    let exact = |r: f64| (a * r + b / r, a - b / (r * r));
    for (elements, n) in
        [(Elements::P1, [16, 32]), (Elements::P2, [4, 8]), (Elements::Q1, [16, 32]), (Elements::Q2, [4, 8])]
    {
        let [coarse, fine] = n.map(|n| {
            let mesh = section(elements, 1.0, n);
            let graph = Arc::new(Graph::of_mesh(&mesh));
            let matrix = forms::a(&mesh, &graph, &[&Isotropic::elastic(3, 2.0, 0.3, StressState::PlaneStrain).into()]);
            // u_r is given on the two cylinders, u_z = 0 on the ends; the rest of the tractions is zero.
            let free: Vec<bool> =
                mesh.points.iter().flat_map(|p| [p[0] != 1.0 && p[0] != 2.0, p[1] != 0.0 && p[1] != 1.0]).collect();
            let mut u: Vec<f64> = mesh.points.iter().flat_map(|p| [exact(p[0]).0, 0.0]).collect();
            u.iter_mut().zip(&free).for_each(|(u, &free)| {
                if free {
                    *u = 0.0;
                }
            });
            let rest: Vec<f64> = matrix.apply(&u).into_iter().map(|f| -f).collect();
            let backend: Arc<dyn Backend> = Arc::new(Supernodal);
            let layout = Layout {
                points: &mesh.points,
                components: 2,
                free: &free,
                frames: &[],
                links: &[],
                rigid: &[],
                contact: &[],
            };
            let mut system = System::new(&backend, &Arc::new(matrix), &layout).expect("a regular system");
            let mut x = system.unknowns().gather(&rest);
            system.solve(&mut x).expect("a solution");
            system.unknowns().add(&x, &mut u);
            errors(&mesh, &component(&u, 2, 0), |x| (exact(x[0]).0, [exact(x[0]).1, 0.0, 0.0]))
        });
        let (p, orders) = (elements.degree() as f64, [0, 1].map(|i| (coarse[i] / fine[i]).log2()));
        assert!((orders[0] - p - 1.0).abs() < 0.15 && (orders[1] - p).abs() < 0.15, "{elements:?}: orders {orders:?}");
    }
}

/// Weights of the contact points are positive and sum to the area of the ring swept by a side: 2π∫ r.
#[test]
fn contact_weights() {
    for elements in EVERY {
        for (from, side, area) in
            [(0.0, "bottom", 0.5 * TAU), (1.0, "bottom", 1.5 * TAU), (1.0, "left", TAU), (1.0, "right", 2.0 * TAU)]
        {
            let mesh = section(elements, from, 3);
            for quadrature in [Quadrature::Nodal, Quadrature::Gauss] {
                let boundary = ContactBoundary::new(&mesh, &mesh.facets[side], quadrature);
                let sum: f64 = boundary.points.iter().map(|p| p.weight).sum();
                assert!((sum - area).abs() < 1e-13, "{elements:?} {side} {quadrature:?}: {sum}, expected {area}");
                assert!(boundary.points.iter().all(|p| p.weight > 0.0), "{elements:?} {side} {quadrature:?}");
            }
        }
    }
}
