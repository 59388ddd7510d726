//! Manufactured solutions: the body force and the heat source of a given field, derived by hand, and the orders of the
//! errors. Linear isotropic bodies are in `elements.rs`, tubes in `revolution.rs`; here is what is beyond them.

use std::sync::Arc;

use crate::common::{changed, paper};
use amontons::convergence::{ErrorRow, Exact, Reference, Study, StudyLevel, StudySettings, Vary, slope};
use amontons::expression::Expression;
use amontons::field::{Field, Law};
use amontons::material::{
    Carreau, Hencky, Isotropic, Linear, Material, ShearLaw, StressState, TensorLaw, VonMisesProjection, reduced,
};
use amontons::mesh::{Block, Diagonal, Elements, Mesh};
use amontons::problem::{BoundaryCondition, Initial, Problem};
use amontons::tensor::{Rotation, Sym};
use amontons::time::Timeline;

type Matrix = [[f64; 3]; 3];
const PLANE: [(Elements, [usize; 2]); 4] =
    [(Elements::P1, [16, 32]), (Elements::P2, [8, 16]), (Elements::Q1, [16, 32]), (Elements::Q2, [8, 16])];
const SPACE: [(Elements, [usize; 2]); 2] = [(Elements::P1, [6, 12]), (Elements::Q1, [4, 8])];
const NAMES: [&str; 3] = ["x", "y", "z"];

fn field(text: &str) -> Field {
    Field::Expression(Expression::parse(text).unwrap_or_else(|error| panic!("{text}: {error}")))
}

fn square(elements: Elements, n: usize) -> Mesh {
    Mesh::rectangle_of(elements, [1.0, 1.0], [n, n], Diagonal::Right).expect("a square")
}

fn cube(elements: Elements, n: usize) -> Mesh {
    Mesh::box_([1.0; 3], [n; 3], elements).expect("a cube")
}

fn material(elasticity: Law<dyn TensorLaw>, viscosity: Law<dyn TensorLaw>, conductivity: Sym) -> Material {
    let mut material = Material::new(3, Isotropic::lame(3, 0.0, 0.0, StressState::PlaneStrain));
    (material.elasticity, material.viscosity, material.conductivity) = (elasticity, viscosity, conductivity.into());
    material
}

fn none(dim: usize) -> Law<dyn TensorLaw> {
    Isotropic::lame(dim, 0.0, 0.0, StressState::PlaneStrain).into()
}

/// What holds inside: f₀ and q₀, and the field that they make.
struct Data {
    body_force: Vec<Field>,
    heat_source: Field,
    exact: Exact,
}

/// The problem of `data` at rest, the exact values on the whole boundary, reached in one step from zero.
fn problem(mesh: Mesh, materials: Vec<Material>, data: &Data) -> Problem {
    let held = |on: &String| BoundaryCondition {
        on: on.clone(),
        displacement: Some(data.exact.displacement.iter().cloned().map(Some).collect()),
        temperature: Some(data.exact.temperature.clone()),
        ..BoundaryCondition::default()
    };
    let boundary = mesh.facets.keys().map(held).collect();
    let (body_force, heat_source) = (data.body_force.clone(), data.heat_source.clone());
    changed(&paper(&[]).problem, |of| {
        (of.mesh, of.timeline, of.materials) = (Arc::new(mesh), Timeline::equal(1.0, 1), materials);
        (of.body_force, of.heat_source, of.boundary) = (body_force, heat_source, boundary);
        (of.contacts, of.initial) = (Vec::new(), Initial::default());
    })
}

/// An error of a study with the order that it must have.
type Order = (&'static str, fn(&ErrorRow) -> f64, f64);

/// Asserts the orders of errors over two meshes.
fn assert_orders(what: &str, meshes: [usize; 2], problem: impl Fn(usize) -> Problem, data: &Data, orders: &[Order]) {
    let levels =
        meshes.map(|n| StudyLevel { level: n, problem: problem(n), text: String::new(), measured: None }).to_vec();
    let study = Study { vary: Vary::Space, levels, reference: Reference::Exact(data.exact.clone()) };
    let table = study.run(&StudySettings::default()).unwrap_or_else(|error| panic!("{what}: {error}"));
    for (name, error, order) in orders {
        let found = slope(&table.rows.iter().map(|row| (row.h, error(row))).collect::<Vec<_>>());
        assert!(
            (found - order).abs() < 0.15,
            "{what}: order {found:.3} of {name}, expected {order}; errors {:?}",
            table.rows.iter().map(error).collect::<Vec<_>>()
        );
    }
}

fn of_displacement(elements: Elements) -> Vec<Order> {
    let p = elements.degree() as f64;
    vec![("‖u − u^h‖", |row| row.error_u_h, p + 1.0), ("‖ε(u − u^h)‖", |row| row.error_u, p)]
}

fn of_both(elements: Elements) -> Vec<Order> {
    let mut orders = of_displacement(elements);
    orders.push(("‖θ − θ^h‖", |row| row.error_theta, elements.degree() as f64 + 1.0));
    orders
}

fn dot(a: &Matrix, b: &Matrix) -> f64 {
    (0..9).map(|i| a[i / 3][i % 3] * b[i / 3][i % 3]).sum()
}

fn apply(a: &Matrix, k: &[f64; 3]) -> [f64; 3] {
    a.map(|row| (0..3).map(|j| row[j] * k[j]).sum())
}

/// u = E₀x + a sin φ, φ = k·x, whose strain is E₀ + S cos φ with S the symmetric part of a ⊗ k.
///
/// The stress is a function of φ alone, so that Div σ = (dσ/dφ) k.
struct Wave {
    dim: usize,
    linear: Matrix,
    amplitude: [f64; 3],
    k: [f64; 3],
}

impl Wave {
    /// A wave whose strain has a deviator of norm 0.055 to 0.12 everywhere.
    fn new(dim: usize) -> Wave {
        let (linear, amplitude, k) =
            ([[0.06, 0.02, 0.01], [0.02, -0.03, -0.01], [0.01, -0.01, 0.02]], [0.01, -0.006, 0.005], [2.0, 1.5, -1.0]);
        let inside = |i: usize, j: usize| if i.max(j) < dim { 1.0 } else { 0.0 };
        Wave {
            dim,
            linear: std::array::from_fn(|i| std::array::from_fn(|j| linear[i][j] * inside(i, j))),
            amplitude: std::array::from_fn(|i| amplitude[i] * inside(i, 0)),
            k: std::array::from_fn(|i| k[i] * inside(i, 0)),
        }
    }

    fn phase(&self) -> String {
        (0..self.dim).map(|c| format!("({:?})*{}", self.k[c], NAMES[c])).collect::<Vec<_>>().join(" + ")
    }

    fn displacement(&self) -> Vec<Field> {
        let linear = |i: usize| {
            (0..self.dim).map(|j| format!("({:?})*{}", self.linear[i][j], NAMES[j])).collect::<Vec<_>>().join(" + ")
        };
        (0..self.dim)
            .map(|i| field(&format!("{} + ({:?})*sin({})", linear(i), self.amplitude[i], self.phase())))
            .collect()
    }

    fn shape(&self) -> Matrix {
        std::array::from_fn(|i| {
            std::array::from_fn(|j| 0.5 * (self.amplitude[i] * self.k[j] + self.amplitude[j] * self.k[i]))
        })
    }

    /// f₀ = −Div σ of σ = κ tr(ε) I + c(s) e, e = ε^D, s = ‖e‖, for c and dc/d(s²) given in terms of `q` = s².
    ///
    /// With e = e₀ + e₁ cos φ: −dσ/dφ = sin φ (κ tr(S) I + c e₁ + dc/dq (2 e₀:e₁ + 2 ‖e₁‖² cos φ)(e₀ + e₁ cos φ)).
    fn body_force(&self, bulk: f64, c: &str, dc: &str) -> Vec<Field> {
        let trace = |a: &Matrix| a[0][0] + a[1][1] + a[2][2];
        let deviator = |a: &Matrix| -> Matrix {
            std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] - if i == j { trace(a) / 3.0 } else { 0.0 }))
        };
        let (s, phase) = (self.shape(), self.phase());
        let (e0, e1) = (deviator(&self.linear), deviator(&s));
        let (mixed, square) = (2.0 * dot(&e0, &e1), dot(&e1, &e1));
        let q = format!("({:?} + ({mixed:?})*cos({phase}) + {square:?}*cos({phase})^2)", dot(&e0, &e0));
        let [c, dc] = [c, dc].map(|text| text.replace('q', &q));
        let (along0, along1) = (apply(&e0, &self.k), apply(&e1, &self.k));
        let component = |i: usize| {
            let secant = format!("{:?} + ({c})*({:?})", bulk * trace(&s) * self.k[i], along1[i]);
            let change = format!(
                "({dc})*({mixed:?} + {:?}*cos({phase}))*({:?} + ({:?})*cos({phase}))",
                2.0 * square,
                along0[i],
                along1[i]
            );
            field(&format!("sin({phase})*({secant} + {change})"))
        };
        (0..self.dim).map(component).collect()
    }

    fn data(&self, body_force: Vec<Field>) -> Data {
        Data {
            body_force,
            heat_source: Field::ZERO,
            exact: Exact { displacement: self.displacement(), temperature: Field::ZERO },
        }
    }

    fn norms(&self) -> [f64; 2] {
        let s = self.shape();
        let deviator = |cos: f64| {
            let e: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| self.linear[i][j] + s[i][j] * cos));
            let trace = e[0][0] + e[1][1] + e[2][2];
            (dot(&e, &e) - trace * trace / 3.0).sqrt()
        };
        let all: Vec<f64> = (0..=200).map(|i| deviator(f64::from(i) / 100.0 - 1.0)).collect();
        [all.iter().copied().fold(f64::INFINITY, f64::min), all.iter().copied().fold(0.0, f64::max)]
    }
}

/// A law of Hencky's form, with c and dc/d(s²) of its shear function by hand.
struct Sheared {
    name: &'static str,
    bulk: f64,
    shear: Arc<dyn Fn(usize) -> Law<dyn TensorLaw>>,
    c: String,
    dc: String,
}

fn sheared(name: &'static str, bulk: f64, shear: impl ShearLaw + Clone + 'static, c: String, dc: String) -> Sheared {
    let of_dim =
        move |dim| reduced(Hencky::new(bulk, shear.clone()).expect("constants"), dim, StressState::PlaneStrain).into();
    Sheared { name, bulk, shear: Arc::new(of_dim), c, dc }
}

/// The two kinds of shear functions.
fn shear_laws() -> [Sheared; 2] {
    // c = 2μ + β (1 − κ/s), dc/dq = β κ/(2 s³): beyond the von Mises convex everywhere.
    let (shear, excess, radius) = (1.0, -1.4, 0.02);
    let projection = sheared(
        "the projection on the von Mises convex",
        1.7,
        VonMisesProjection::new(shear, excess, radius).expect("constants"),
        format!("{:?} + ({excess:?})*(1 - {radius:?}*q^(-0.5))", 2.0 * shear),
        format!("({:?})*q^(-1.5)", 0.5 * excess * radius),
    );
    // c = 2η_∞ + 2(η₀ − η_∞)(1 + λ²q)^p, p = (n − 1)/2.
    let (zero, infinite, time, n) = (1.0, 0.2, 20.0, 0.3);
    let (p, square, twice) = (0.5 * (n - 1.0), time * time, 2.0 * (zero - infinite));
    let carreau = sheared(
        "Carreau's shear function",
        0.9,
        Carreau::new(zero, infinite, time, n).expect("constants"),
        format!("{:?} + {twice:?}*(1 + {square:?}*q)^({p:?})", 2.0 * infinite),
        format!("({:?})*(1 + {square:?}*q)^({:?})", twice * p * square, p - 1.0),
    );
    [projection, carreau]
}

fn assert_nonlinear(dim: usize, elements: Elements, meshes: [usize; 2], mesh: fn(Elements, usize) -> Mesh) {
    let wave = Wave::new(dim);
    assert!(wave.norms()[0] > 0.025, "the strain stays beyond the convex: {:?}", wave.norms());
    for Sheared { name, bulk, shear: law, c, dc } in shear_laws() {
        let data = wave.data(wave.body_force(bulk, &c, &dc));
        // As 𝓔; and as 𝓥, w = u after a step of length 1.
        let elastic =
            |n: usize| problem(mesh(elements, n), vec![material(law(dim), none(dim), Sym::identity(dim))], &data);
        assert_orders(&format!("{elements:?}, {name}"), meshes, elastic, &data, &of_displacement(elements));
        let viscous =
            |n: usize| problem(mesh(elements, n), vec![material(none(dim), law(dim), Sym::identity(dim))], &data);
        assert_orders(&format!("{elements:?}, {name} of the rate"), meshes, viscous, &data, &of_displacement(elements));
    }
}

/// Laws of Hencky's form that are not linear, as elasticity and as viscosity, in the plane.
#[test]
fn nonlinear_laws_in_the_plane() {
    for (elements, meshes) in PLANE {
        assert_nonlinear(2, elements, meshes, square);
    }
}

/// The same in three dimensions.
#[test]
fn nonlinear_laws_in_space() {
    assert_nonlinear(3, Elements::P1, [6, 12], cube);
}

/// A stiffness without any symmetry of the material, in the order 11 22 33 23 13 12.
const VOIGT: [[f64; 6]; 6] = [
    [5.0, 1.2, 0.9, 0.3, -0.4, 0.7],
    [1.2, 3.0, 0.8, -0.2, 0.5, 0.6],
    [0.9, 0.8, 4.0, 0.4, 0.2, -0.3],
    [0.3, -0.2, 0.4, 1.1, 0.1, 0.2],
    [-0.4, 0.5, 0.2, 0.1, 1.5, -0.1],
    [0.7, 0.6, -0.3, 0.2, -0.1, 0.9],
];
const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];
const CONDUCTIVITY: Matrix = [[2.0, 0.6, -0.3], [0.6, 1.0, 0.2], [-0.3, 0.2, 0.7]];

/// 𝓔 of the least symmetry and 𝓚 with all entries: −Div 𝓔ε(a sin φ) = sin φ (𝓔S) k and −div 𝓚∇ sin φ = sin φ 𝓚k·k.
fn assert_anisotropic(dim: usize, elements: Elements, meshes: [usize; 2], mesh: fn(Elements, usize) -> Mesh) {
    let wave = Wave::new(dim);
    let s = wave.shape();
    let mut stress: Matrix = [[0.0; 3]; 3];
    for (row, &(i, j)) in VOIGT.iter().zip(&PAIRS) {
        let value: f64 =
            row.iter().zip(&PAIRS).map(|(c, &(k, l))| c * if k == l { s[k][l] } else { 2.0 * s[k][l] }).sum();
        (stress[i][j], stress[j][i]) = (value, value);
    }
    let (force, phase) = (apply(&stress, &wave.k), wave.phase());
    let heat: f64 = apply(&CONDUCTIVITY, &wave.k).iter().zip(&wave.k).map(|(q, k)| q * k).sum();
    let data = Data {
        heat_source: field(&format!("{heat:?}*sin({phase})")),
        exact: Exact { displacement: wave.displacement(), temperature: field(&format!("sin({phase}) - 0.4*x + 2*y")) },
        ..wave.data((0..dim).map(|i| field(&format!("({:?})*sin({phase})", force[i]))).collect())
    };
    let at = |n: usize| {
        let law = Linear::new(&VOIGT, &Rotation::in_plane(0.0), dim, StressState::PlaneStrain).expect("a stiffness");
        problem(
            mesh(elements, n),
            vec![material(law.into(), none(dim), Sym::from_fn(dim, |i, j| CONDUCTIVITY[i][j]))],
            &data,
        )
    };
    let what = format!("{elements:?} in {dim} dimensions, an anisotropic body");
    assert_orders(&what, meshes, at, &data, &of_both(elements));
}

#[test]
fn anisotropic_bodies() {
    for (elements, meshes) in PLANE {
        assert_anisotropic(2, elements, meshes, square);
    }
    for (elements, meshes) in SPACE {
        assert_anisotropic(3, elements, meshes, cube);
    }
}

/// A solid body of revolution with its axis: u_r = a r² sin z, u_z = b r² cos z and θ = r² sin z, with λ, μ and a 𝓚
/// that has K_rz.
///
/// σ_rr = λ tr + 4μ a r sin z, σ_θθ = λ tr + 2μ a r sin z, σ_zz = λ tr − 2μ b r² sin z, σ_rz = μ (a r² + 2 b r) cos z
/// with tr = (3 a r − b r²) sin z, and f_r = −(σ_rr,r + σ_rz,z + (σ_rr − σ_θθ)/r) = −sin z (λ(3a − 2 b r) + 6μ a − μ(a
/// r² + 2 b r)) f_z = −(σ_rz,r + σ_rz/r + σ_zz,z) = −cos z (μ(3 a r + 4 b) + λ(3 a r − b r²) − 2μ b r²) q₀ = −((r K_rr
/// θ_r + r K_rz θ_z),r/r + (K_rz θ_r + K_zz θ_z),z) = −(4 K_rr sin z + 5 K_rz r cos z − K_zz r² sin z)
#[test]
fn bodies_of_revolution() {
    let (a, b, young, nu) = (0.3, -0.4, 2.0, 0.3);
    let (lambda, mu) = (young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), young / (2.0 * (1.0 + nu)));
    let [krr, krz, kzz] = [1.5, 0.4, 0.8];
    let text = |pattern: &str| {
        let constants = [("A", a), ("B", b), ("L", lambda), ("M", mu), ("KRR", krr), ("KRZ", krz), ("KZZ", kzz)];
        // The longer names first: none of them is part of a shorter one.
        field(
            &constants
                .iter()
                .rev()
                .fold(pattern.to_owned(), |text, (name, value)| text.replace(name, &format!("({value:?})"))),
        )
    };
    let data = Data {
        body_force: vec![
            text("-sin(y)*(L*(3*A - 2*B*x) + 6*M*A - M*(A*x^2 + 2*B*x))"),
            text("-cos(y)*(M*(3*A*x + 4*B) + L*(3*A*x - B*x^2) - 2*M*B*x^2)"),
        ],
        heat_source: text("-(4*KRR*sin(y) + 5*KRZ*x*cos(y) - KZZ*x^2*sin(y))"),
        exact: Exact {
            displacement: vec![text("A*x^2*sin(y)"), text("B*x^2*cos(y)")],
            temperature: text("x^2*sin(y)"),
        },
    };
    let conductivity = Sym::from_fn(3, |i, j| [[krr, krz, 0.0], [krz, kzz, 0.0], [0.0, 0.0, 1.0]][i][j]);
    for (elements, meshes) in PLANE {
        let at = |n: usize| {
            let law = Isotropic::elastic(3, young, nu, StressState::PlaneStrain).into();
            let mesh = Mesh { axisymmetric: true, ..square(elements, n) };
            let found = problem(mesh, vec![material(law, none(3), conductivity)], &data);
            // Nothing is prescribed on the axis but u_r = 0, which is the exact value.
            changed(&found, |data| data.boundary.retain(|condition| condition.on != "left"))
        };
        assert_orders(&format!("{elements:?}, a body of revolution"), meshes, at, &data, &of_both(elements));
    }
}

/// The square in two regions, x < 1/2 and x > 1/2.
fn halves(elements: Elements, n: usize) -> Mesh {
    let mesh = square(elements, n);
    let mut blocks = Vec::new();
    for block in &mesh.blocks {
        let right = |cell: &[u32]| {
            cell.iter().map(|&node| mesh.points[node as usize][0]).sum::<f64>() > 0.5 * cell.len() as f64
        };
        for region in 0..2 {
            let nodes = block.cells().filter(|cell| usize::from(right(cell)) == region).flatten().copied().collect();
            blocks.push(Block { element: block.element, region, nodes });
        }
    }
    Mesh { blocks, regions: vec!["left half".to_owned(), "right half".to_owned()], ..mesh }
}

/// Two materials: with α = (x − ½)/c + (x − ½)² the product c α′ is continuous across x = ½, where α = 0. So with c the
/// modulus λ + 2μ of each side u = (α cos y, 0) has a continuous traction, f₀ = (−2c + μα, (λ + μ) α′) · (cos y, sin
/// y), and with c = K the temperature θ = α cos y a continuous flux, q₀ = K (α − 2) cos y. Gradients jump by the
/// factors of the data, 10 and more.
#[test]
fn two_materials() {
    let nu = 0.3;
    let lame = |young: f64| (young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), young / (2.0 * (1.0 + nu)));
    let (young, heat) = ([1.0, 12.0], [5.0, 0.5]);
    let alpha = |c: f64| format!("((x - 0.5)/{c:?} + (x - 0.5)^2)");
    let sides = |text: &dyn Fn(usize) -> String| field(&format!("if(x < 0.5, {}, {})", text(0), text(1)));
    let modulus = |i: usize| lame(young[i]).0 + 2.0 * lame(young[i]).1;
    let data = Data {
        body_force: vec![
            sides(&|i| format!("({:?} + {:?}*{})*cos(y)", -2.0 * modulus(i), lame(young[i]).1, alpha(modulus(i)))),
            sides(&|i| {
                format!("{:?}*({:?} + 2*(x - 0.5))*sin(y)", lame(young[i]).0 + lame(young[i]).1, 1.0 / modulus(i))
            }),
        ],
        heat_source: sides(&|i| format!("{:?}*({} - 2)*cos(y)", heat[i], alpha(heat[i]))),
        exact: Exact {
            displacement: vec![sides(&|i| format!("{}*cos(y)", alpha(modulus(i)))), Field::ZERO],
            temperature: sides(&|i| format!("{}*cos(y)", alpha(heat[i]))),
        },
    };
    for (elements, meshes) in PLANE {
        let at = |n: usize| {
            let of = |i: usize| {
                material(
                    Isotropic::elastic(2, young[i], nu, StressState::PlaneStrain).into(),
                    none(2),
                    heat[i] * Sym::identity(2),
                )
            };
            problem(halves(elements, n), vec![of(0), of(1)], &data)
        };
        assert_orders(&format!("{elements:?}, two materials"), meshes, at, &data, &of_both(elements));
    }
}
