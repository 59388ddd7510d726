//! Loads and forms over sides against formulas, and runs with the conditions on sides against closed forms.

use std::sync::Arc;

use crate::common::largest;
use amontons::case::{self, Source};
use amontons::expression::Expression;
use amontons::field::{Field, TimeTable};
use amontons::forms;
use amontons::linalg::{Graph, dot};
use amontons::mesh::{Diagonal, Mesh};
use amontons::output::Memory;
use amontons::problem::{BoundaryCondition, Convection, Support};
use amontons::run::{Settings, run};
use amontons::state::State;

fn expression(text: &str) -> Field {
    Field::Expression(Expression::parse(text).unwrap())
}

/// The rectangle (0, 2) × (0, 3).
fn rectangle(n: usize) -> Mesh {
    Mesh::rectangle([2.0, 3.0], [2 * n, 3 * n], Diagonal::Right).unwrap()
}

fn on(side: &str) -> BoundaryCondition {
    BoundaryCondition::on(side)
}

/// Resultant and moment about the origin of a load.
fn resultant(mesh: &Mesh, load: &[f64]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (p, f) in mesh.points.iter().zip(load.chunks_exact(2)) {
        let terms = [f[0], f[1], p[0] * f[1] - p[1] * f[0]];
        sum.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
    }
    sum
}

#[track_caller]
fn assert_near(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    let scale = largest(expected).max(f64::MIN_POSITIVE);
    let error = found.iter().zip(expected).fold(0.0, |e: f64, (f, x)| e.max((f - x).abs()));
    assert!(error <= tolerance * scale, "{found:?}, expected {expected:?}");
}

/// p = 1 + y² on x = 2: ∫p = 12, ∫ y p = 24.75.
#[test]
fn pressure_has_its_resultant_and_moment() {
    let mesh = rectangle(2);
    let load =
        forms::f(&mesh, &[], &[BoundaryCondition { pressure: Some(expression("1 + y^2")), ..on("right") }]).at(0.0);
    assert_near(&resultant(&mesh, &load), &[-12.0, 0.0, 24.75], 1e-14);
    // On y = 3 with p = x² the traction is (0, −x²): ∫ = 8/3, ∫ x · x² = 4.
    let load = forms::f(&mesh, &[], &[BoundaryCondition { pressure: Some(expression("x^2")), ..on("top") }]).at(0.0);
    assert_near(&resultant(&mesh, &load), &[0.0, -8.0 / 3.0, -4.0], 1e-14);
}

/// A uniform pressure on a closed surface is in equilibrium.
#[test]
fn pressure_all_around_is_in_equilibrium() {
    let mesh = rectangle(3);
    let sides = ["left", "right", "top", "bottom"]
        .map(|side| BoundaryCondition { pressure: Some(Field::Constant(7.0)), ..on(side) });
    let load = forms::f(&mesh, &[], &sides).at(0.0);
    assert!(largest(&load) > 1.0 && largest(&resultant(&mesh, &load)) < 1e-12);
}

/// Tables in time: 4t for t ≤ 1, then 4 + 2(t − 1), times y in space; ∫ y = 4.5 and ∫ y² = 9 on x = 0.
#[test]
fn a_table_is_a_load_that_varies_in_time() {
    let mesh = rectangle(2);
    let table =
        TimeTable::new(vec![0.0, 1.0, 2.0], vec![0.0, 4.0, 6.0]).unwrap().scaled(Expression::parse("y").unwrap());
    let load = forms::f(
        &mesh,
        &[],
        &[BoundaryCondition { traction: Some(vec![Field::Table(table), Field::ZERO]), ..on("left") }],
    );
    for (t, value) in [(0.0, 0.0), (0.25, 1.0), (1.0, 4.0), (1.5, 5.0), (2.0, 6.0)] {
        assert_near(&resultant(&mesh, &load.at(t)), &[4.5 * value, 0.0, -9.0 * value], 1e-14);
    }
    assert!(load.at(2.5).iter().any(|f| f.is_nan()), "beyond its times a table has no value");
}

/// Three Gauss points per facet are exact for degree 5, those of a triangle for degree 4, and what degree 5 leaves
/// cancels between the two triangles of a rectangle, since the rule is symmetric: the errors of integrals of smooth
/// data fall with h⁶.
#[test]
fn loads_are_integrated_to_their_order() {
    let error = |n: usize, body: bool| {
        let mesh = rectangle(n);
        let load = if body {
            forms::q(&mesh, &expression("exp(x)*cos(2*y)"), &[]).at(0.0)
        } else {
            forms::q(
                &mesh,
                &Field::ZERO,
                &[BoundaryCondition { heat_inflow: Some(expression("exp(2*y)")), ..on("right") }],
            )
            .at(0.0)
        };
        let exact = if body { (2f64.exp() - 1.0) * 6f64.sin() / 2.0 } else { (6f64.exp() - 1.0) / 2.0 };
        (load.iter().sum::<f64>() - exact).abs() / exact.abs()
    };
    for body in [false, true] {
        let slope = (error(2, body) / error(4, body)).log2();
        assert!((slope - 6.0).abs() < 0.1, "{slope}");
    }
}

/// On the side x = 2: k = 1 + y along the normal, entries by component, and κL/6 (2 1; 1 2) on a facet of constant κ.
#[test]
fn springs_are_their_formula() {
    let mesh = rectangle(2);
    let graph = Arc::new(Graph::of_mesh(&mesh));
    let form = |side: &str, support: Support| {
        forms::springs(&mesh, &graph, &[BoundaryCondition { spring: Some(support), ..on(side) }]).unwrap()
    };
    let field = |f: fn(&[f64; 3]) -> [f64; 2]| mesh.points.iter().flat_map(f).collect::<Vec<f64>>();
    let energy = |matrix: &amontons::linalg::BlockMatrix, u: &[f64]| dot(u, &matrix.apply(u));
    let normal = form("right", Support::Normal(expression("1 + y")));
    // ∫ (1 + y) y² = 9 + 81/4.
    assert_near(&[energy(&normal, &field(|p| [p[1], 100.0]))], &[29.25], 1e-14);
    let bottom = form("bottom", Support::Normal(Field::Constant(3.0)));
    assert_near(&[energy(&bottom, &field(|p| [100.0, p[0]]))], &[8.0], 1e-14);
    let both = form("bottom", Support::Components(vec![Field::Constant(2.0), expression("x")]));
    // ∫ 2·1² + x·x² over (0, 2).
    assert_near(&[energy(&both, &field(|p| [1.0, p[0]]))], &[4.0 + 4.0], 1e-14);
    let h = 0.5;
    let entries = [(0, 0), (0, 1), (1, 1), (0, 4)].map(|(i, j)| bottom.get(i, 1, j, 1));
    assert_near(&entries, &[3.0 * h / 3.0, 3.0 * h / 6.0, 2.0 * 3.0 * h / 3.0, 0.0], 1e-14);
    assert!(both.asymmetry(&both) < 1e-15);
    // A dashpot is the same form of the velocity.
    let dashpot = BoundaryCondition { dashpot: Some(Support::Normal(expression("1 + y"))), ..on("right") };
    let dashpot = forms::dashpots(&mesh, &graph, std::slice::from_ref(&dashpot)).unwrap();
    let u = field(|p| [p[1].sin(), p[0]]);
    assert_eq!(dashpot.apply(&u), normal.apply(&u));
    assert!(forms::springs(&mesh, &graph, &[on("left")]).is_none());
}

/// ∫ h θ η and ∫ h θ_a η: with h = 1 + y and θ = y on x = 2, ∫ h θ² = 29.25; with θ_a = 2, ∫ h θ_a = 15.
#[test]
fn convection_is_its_formula() {
    let mesh = rectangle(2);
    let graph = Arc::new(Graph::of_mesh(&mesh));
    let convection = Convection { coefficient: expression("1 + y"), ambient: Field::Constant(2.0) };
    let sides = [BoundaryCondition { convection: Some(convection), ..on("right") }];
    let matrix = forms::convection(&mesh, &graph, &sides).unwrap();
    let y: Vec<f64> = mesh.points.iter().map(|p| p[1]).collect();
    assert_near(&[dot(&y, &matrix.apply(&y))], &[29.25], 1e-14);
    let load = forms::q(&mesh, &Field::ZERO, &sides).at(0.0);
    // With θ = θ_a nothing flows.
    let two = vec![2.0; y.len()];
    assert_near(&[load.iter().sum()], &[15.0], 1e-14);
    assert!(matrix.apply(&two).iter().zip(load.iter()).all(|(a, b)| (a - b).abs() < 1e-13));
}

// Runs. E = 50, ν = 0.25, K = 3; the rectangle (0, 2) × (0, 1).

const BODY: &str = body!(
    r#"kind = "rectangle", size = [2.0, 1.0], n = [6, 3], diagonal = "crossed""#,
    "end = 2.0, steps = 4",
    0.0,
    r#"young = 50.0, poisson = 0.25, stress_state = "plane-stress""#,
    "heat_capacity = 0.0\nconductivity = 3.0\n"
);

/// Mesh and last state of a run.
fn solved(sides: &str, overrides: &[&str]) -> (Arc<Mesh>, State) {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    let case = case::parse(&Source::new("sides.toml", format!("{BODY}{sides}")), &overrides)
        .unwrap_or_else(|error| panic!("{error}"));
    let mut memory = Memory::default();
    run(&case.problem, &Settings::default(), &mut [&mut memory]).unwrap_or_else(|error| panic!("{error}"));
    let state = memory.states.pop().expect("states");
    assert!(
        state.ledger.relative_closing_error().abs() < 1e-12 && state.ledger.relative_heat_closing_error().abs() < 1e-12,
        "{:?}",
        state.ledger
    );
    (Arc::clone(&case.problem.mesh), state)
}

fn expected(mesh: &Mesh, f: impl Fn(f64, f64) -> [f64; 2]) -> Vec<f64> {
    mesh.points.iter().flat_map(|p| f(p[0], p[1])).collect()
}

const WARM: &str = "[[boundary]]\non = \"bottom\"\ntemperature = 0\n";

/// u = (Tx/E, −νTy/E) between two planes of symmetry.
#[test]
fn planes_of_symmetry_let_the_rest_free() {
    let sides = "[[boundary]]\non = \"left\"\nnormal_displacement = 0\ntemperature = 0\n[[boundary]]\non = \"bottom\"\nnormal_displacement = 0\n[[boundary]]\non = \"right\"\ntraction = [5, 0]\n";
    let (mesh, state) = solved(sides, &[]);
    assert_near(&state.u, &expected(&mesh, |x, y| [0.1 * x, -0.025 * y]), 1e-12);
    // The same by components; and pulled by a displacement along the outward normal, u_x(0) = −0.3.
    let by_components = sides.replacen("normal_displacement = 0\n", "displacement = [0, \"free\"]\n", 1).replacen(
        "normal_displacement = 0\n",
        "displacement = [\"free\", 0]\n",
        1,
    );
    assert_near(&solved(&by_components, &[]).1.u, &state.u, 1e-13);
    let pulled =
        sides.replacen("normal_displacement = 0", "normal_displacement = { times = [0, 2], values = [0, 0.3] }", 1);
    let (mesh, state) = solved(&pulled, &[]);
    assert_near(&state.u, &expected(&mesh, |x, y| [0.1 * x - 0.3, -0.025 * y]), 1e-12);
}

/// A pressure all around: ε = −p(1 − ν)/E in plane stress.
#[test]
fn pressure_all_around_shrinks_the_body() {
    let sides = "[[boundary]]\non = \"left\"\nnormal_displacement = 0\ntemperature = 0\n[[boundary]]\non = \"bottom\"\nnormal_displacement = 0\n[[boundary]]\non = \"right\"\npressure = 4\n[[boundary]]\non = \"top\"\npressure = 4\n";
    let (mesh, state) = solved(sides, &[]);
    assert_near(&state.u, &expected(&mesh, |x, y| [-0.06 * x, -0.06 * y]), 1e-12);
}

/// A bar on springs k = 20 pulled by T = 5: u = T/k + Tx/E, and the springs store T²/2k on their side of length 1.
#[test]
fn springs_hold_a_body() {
    let sides = format!(
        "[[boundary]]\non = \"left\"\nspring = [20, 20]\n[[boundary]]\non = \"right\"\ntraction = [5, 0]\n{WARM}"
    );
    let (mesh, state) = solved(&sides, &["material.elasticity.poisson=0"]);
    assert_near(&state.u, &expected(&mesh, |x, _| [0.25 + 0.1 * x, 0.0]), 1e-12);
    assert_near(&[state.ledger.elastic], &[0.5 * 5.0 * 0.1 * 2.0 + 0.5 * 5.0 * 0.25], 1e-12);
}

/// A bar on dashpots c = 2 pulled by T = 5 moves with T/c and is stretched by Tx/E; they dissipate T²/c a second.
#[test]
fn dashpots_let_a_body_move() {
    let sides = format!(
        "[[boundary]]\non = \"left\"\ndashpot = [2, 2]\nspring = [0, 1]\n[[boundary]]\non = \"right\"\ntraction = [5, 0]\n{WARM}"
    );
    let (mesh, state) = solved(&sides, &["material.elasticity.poisson=0"]);
    assert_near(&state.u, &expected(&mesh, |x, _| [2.5 * 2.0 + 0.1 * x, 0.0]), 1e-12);
    assert_near(&[state.ledger.viscous_dissipation], &[5.0 * 2.5 * 2.0], 1e-12);
}

/// Steady heat through a wall, θ(0) = 0, into surroundings at 8 with h = 6: θ = θ_a h x/(K + hL) = 3.2 x.
#[test]
fn convection_warms_a_wall() {
    let sides = "[[boundary]]\non = \"left\"\ntemperature = 0\ndisplacement = [0, 0]\n[[boundary]]\non = \"right\"\nconvection = { coefficient = 6, ambient = 8 }\n";
    let (mesh, state) = solved(sides, &[]);
    let theta: Vec<f64> = mesh.points.iter().map(|p| 3.2 * p[0]).collect();
    assert_near(&state.theta, &theta, 1e-12);
    // q = 6 (8 − 6.4) = 9.6 comes in at the right and leaves at the left.
    assert_near(&[state.ledger.heat_supplied, state.ledger.heat_prescribed], &[9.6 * 2.0, 9.6 * 2.0], 1e-12);
}

/// A body that conducts well and exchanges heat on two sides cools by backward Euler of cV θ̇ = −hA θ, up to its Biot
/// number hL/K.
#[test]
fn convection_cools_a_body() {
    let sides = "[initial]\ntemperature = 10\n[[boundary]]\non = \"left\"\ndisplacement = [0, 0]\nconvection = { coefficient = 1 }\n[[boundary]]\non = \"right\"\nconvection = { coefficient = 1 }\n";
    let (_, state) = solved(sides, &["material.conductivity=1e3", "material.heat_capacity=4"]);
    // cV = 8, hA = 2, k = 1/2: four factors 1/(1 + 1/8).
    let theta = 10.0 / 1.125f64.powi(4);
    let biot = 1.0 * 2.0 / 1e3;
    assert_near(&state.theta, &vec![theta; state.theta.len()], biot);
    assert_near(&[state.ledger.heat_supplied], &[8.0 * (theta - 10.0)], biot);
}
