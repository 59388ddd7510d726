//! Parts of the bound of the discretization error: thermal stress, what is repaired between nodes, and bodies of
//! revolution.

use std::sync::Arc;

use amontons::contact::{Compliance, Contact, Signorini, Tresca};
use amontons::discretization::Discretization;
use amontons::element::ShapeTable;
use amontons::majorant::{DiscretizationError, Majorant};
use amontons::material::{Isotropic, Material, Prony, StressState};
use amontons::mesh::{CellMap, Diagonal, Elements, Mesh};
use amontons::problem::{BoundaryCondition, Physics, Problem};

use super::common::{changed, checked, solve};
use super::majorant::{ROD, bound, bounded, parsed, plane};
use super::majorant_random::compared;

/// The same rod, warmed: E u'' = M θ' − f, and the bound is the error (M θ' − f)²h²/12.
#[test]
fn the_bound_of_a_warm_rod_is_its_error() {
    for n in [4, 8] {
        let problem = changed(&parsed(ROD, &[&format!("mesh.n={n}")]), |data| {
            data.physics = Physics::Warmed;
            data.materials[0].expansion = amontons::tensor::Sym::from_fn(1, |_, _| 0.3).into();
            let field = amontons::field::Field::of_space(|x| 1.0 + 2.0 * x[0]);
            data.temperature = vec![amontons::problem::GivenTemperature { region: None, field, key: String::new() }];
        });
        let found = bounded(&problem);
        let squared = (0.3f64 * 2.0 - 1.0).powi(2) / (12.0 * f64::from(n).powi(2));
        assert!(found.is_guaranteed(), "{:?}", found.estimate);
        assert!((2.0 * found.energy / squared - 1.0).abs() < 1e-9, "{n}: {:e} {squared:e}", 2.0 * found.energy);
    }
}

/// A quadratic side that touches at the middle of its only facet and is open at the ends penetrates between them: that
/// is taken away, and its energy is in the bound.
#[test]
fn a_side_that_penetrates_between_its_nodes_is_repaired() {
    let mut data = plane(Elements::P2);
    data.mesh = Arc::new(Mesh::rectangle_of(Elements::P2, [1.0, 1.0], [1, 1], Diagonal::Right).expect("a mesh"));
    let bent = amontons::field::Field::of_space(|x| 0.4 * (x[0] - 0.5).powi(2) - 0.03);
    data.boundary = vec![BoundaryCondition::on("top").displacement([0.0.into(), bent])];
    data.body_force = Vec::new();
    data.contacts = vec![Contact::new("bottom", Signorini)];
    let (error, found) = compared(&checked(data), 3);
    assert!(found.repair > 1e-3 * found.energy && found.energy >= error, "{found:?} {error:e}");
    let sum = ((found.mesh + found.contact).sqrt() + found.repair.sqrt()).powi(2);
    assert!((found.energy - sum).abs() <= 1e-12 * sum, "{found:?}");
}

/// A ring that is shrunk onto a rigid shaft by δ, between rigid walls: u_r = A r + B/r.
const RING: &str = r#"
name = "ring"
units = "dimensionless"
[mesh]
kind = "rectangle"
axisymmetric = true
origin = [1.0, 0.0]
size = [1.0, 0.5]
n = [4, 2]
[time]
end = 1.0
steps = 1
[material]
density = 0.0
elasticity = { law = "isotropic", young = 1.0, poisson = 0.25 }
[[boundary]]
on = "top"
displacement = ["free", 0]
[[boundary]]
on = "bottom"
displacement = ["free", 0]
[contact]
on = "left"
gap = -0.01
normal = { law = "signorini" }
"#;

/// ½‖u_h − u‖² of the ring: λ = μ = 0.4, and σ_r = 2(λ + μ)A − 2μB/r² vanishes at r = 2.
fn ring_error(problem: &Problem, u: &[f64]) -> f64 {
    let (lambda, mu) = (0.4, 0.4);
    // A = μB/(4(λ + μ)), A + B = 0.01.
    let b = 0.01 / (1.0 + mu / (4.0 * (lambda + mu)));
    let a = 0.01 - b;
    let mut sum = 0.0;
    for block in &problem.mesh.blocks {
        let table = ShapeTable::new(block.element, 12);
        let mut map = CellMap::new(&problem.mesh, &table);
        for nodes in block.cells() {
            for q in 0..table.len() {
                map.at(nodes, q);
                let r = map.position[0];
                let mut e = [0.0 - (a - b / (r * r)), 0.0, 0.0, 0.0 - (a + b / (r * r))];
                for ((g, value), &node) in map.gradients.iter().zip(map.values()).zip(nodes) {
                    let [x, y] = [u[2 * node as usize], u[2 * node as usize + 1]];
                    e[0] += g[0] * x;
                    e[1] += g[1] * y;
                    e[2] += 0.5 * (g[1] * x + g[0] * y);
                    e[3] += value * x / r;
                }
                let squares = e[0] * e[0] + e[1] * e[1] + 2.0 * e[2] * e[2] + e[3] * e[3];
                let density = 0.5 * lambda * (e[0] + e[1] + e[3]).powi(2) + mu * squares;
                sum += table.weights[q] * map.measure * density;
            }
        }
    }
    sum
}

/// The bound of a ring is above its error, and does not leave it on finer meshes with linear elements. The hoop stress
/// in balance is constant in a third of a cell, to which quadratic elements are superior.
#[test]
fn the_bound_of_a_ring_is_above_its_error() {
    for elements in ["P1", "P2"] {
        let mut ratios = Vec::new();
        for n in [2, 4, 8, 16] {
            let problem = parsed(RING, &[&format!("mesh.n=[{}, {n}]", 2 * n), &format!("mesh.elements={elements}")]);
            let memory = solve(&problem);
            let found = bound(&problem, &memory).expect("a bound");
            let error = ring_error(&problem, &memory.states.last().expect("a state").u);
            ratios.push((found.energy / error).sqrt());
            assert!(found.is_guaranteed(), "{:?}", found.estimate);
        }
        println!("ring {elements}: {ratios:.3?}");
        assert!(ratios.iter().all(|ratio| *ratio >= 1.0), "{elements}: {ratios:?}");
        assert!(elements == "P2" || ratios[3] <= ratios[0] && ratios[3] < 2.0, "{elements}: {ratios:?}");
    }
}

/// Rings under all that a section feels: the bound is above the difference to a mesh eight times as fine, and near it
/// also where the body force along the radius is what the hoop stress bears, as far from the axis.
#[test]
fn the_bound_of_loaded_rings_is_above_the_error() {
    for elements in [Elements::P1, Elements::P2] {
        for at in [0.05, 0.5, 5.0] {
            for contact in [
                Contact::new("left", Signorini),
                Contact::new("left", Compliance { stiffness: 3.0 }).friction(Tresca { bound: 0.02 }),
                Contact::new("bottom", Compliance { stiffness: 3.0 }).friction(Tresca { bound: 0.02 }),
            ] {
                let mut data = plane(elements);
                let mut mesh = Mesh::rectangle_of(elements, [1.2, 0.8], [3, 2], Diagonal::Right).expect("a mesh");
                mesh.points.iter_mut().for_each(|x| x[0] += at);
                mesh.axisymmetric = true;
                data.mesh = Arc::new(mesh);
                data.materials = vec![Material::new(3, Isotropic::elastic(3, 2.0, 0.3, StressState::PlaneStrain))];
                data.body_force = vec![(-0.1).into(), 0.0.into()];
                data.boundary = vec![
                    BoundaryCondition::on("top").displacement([0.0, -0.02]),
                    BoundaryCondition { pressure: Some(0.2.into()), ..BoundaryCondition::on("right") },
                ];
                data.contacts = vec![contact];
                let (error, found) = compared(&checked(data), 3);
                let ratio = (found.energy / error).sqrt();
                println!("{elements:?} {at}: {ratio:.3}, contact {:.1e} of {:.1e}", found.contact, found.energy);
                assert!(found.is_guaranteed() && ratio >= 1.0, "{elements:?} {at}: {error:e} {found:?}");
                assert!(ratio < if elements == Elements::P1 { 1.7 } else { 2.5 }, "{elements:?} {at}: {ratio}");
            }
        }
    }
}

/// What a body of revolution has no bound for, or an estimate.
#[test]
fn bodies_of_revolution_on_their_axis_are_refused() {
    let solid = parsed(RING, &["mesh.origin=[0, 0]", "contact.on=right", "contact.gap=-0.01"]);
    let why = bound(&solid, &solve(&solid)).expect_err("no bound");
    assert_eq!(why.reason(), "a body of revolution that reaches its axis");
    let squares = parsed(RING, &["mesh.elements=Q1"]);
    let why = bound(&squares, &solve(&squares)).expect_err("no bound");
    assert_eq!(why.reason(), "quadrilaterals of a body of revolution");
    let heavy = parsed(RING, &["load.body_force=[0, -0.001]"]);
    let found = bound(&heavy, &solve(&heavy)).expect("a bound");
    assert!(!found.is_guaranteed() && found.estimate[0].contains("along the axis"), "{:?}", found.estimate);
}

/// A rod whose stress relaxes: with the stiffness C = E + Σ G/(1 + k/τ) of a step the bound is its error f²h²/(12 C),
/// in the first step and, with the strain of the springs, in later ones.
#[test]
fn the_bound_of_a_relaxing_rod_is_its_error() {
    for (end, steps) in [(0.5, 1), (1.5, 3)] {
        for n in [4, 8] {
            let law = "elasticity = { law = \"isotropic\", young = 1.0, poisson = 0.0 }";
            let prony = "prony = [{ ratio = 0.6, time = 0.25 }, { ratio = 0.3, time = 2.0 }]";
            let text = ROD.replace(law, &format!("{law}\n{prony}"));
            let problem =
                parsed(&text, &[&format!("mesh.n={n}"), &format!("time.end={end}"), &format!("time.steps={steps}")]);
            let found = bounded(&problem);
            // k = 0.5.
            let stiffness = 1.0 + 0.6 / 3.0 + 0.3 / 1.25;
            let squared = 1.0 / (12.0 * f64::from(n).powi(2) * stiffness);
            assert!(found.is_guaranteed(), "{:?}", found.estimate);
            assert!((2.0 * found.energy / squared - 1.0).abs() < 1e-9, "{n}: {:e} {squared:e}", 2.0 * found.energy);
        }
    }
}

/// A block whose stress relaxes: its energy in the step is 1 + ½/(1 + 1) times that of 𝓔.
#[test]
fn the_bound_of_a_relaxing_block_is_above_its_error() {
    let mut data = plane(Elements::P1);
    let law = Isotropic::elastic(2, 2.0, 0.3, StressState::PlaneStrain);
    let spring = Isotropic::elastic(2, 1.0, 0.3, StressState::PlaneStrain);
    let prony = Prony::new(&[(&spring.into(), 1.0)]).expect("a branch");
    data.materials = vec![Material::new(2, law)];
    data.materials[0].prony = Some(prony);
    let (elastic, found) = compared(&checked(data), 3);
    let error = 1.25 * elastic;
    assert!(found.is_guaranteed() && found.energy >= error, "{:e} {error:e}", found.energy);
    assert!(found.energy < 2.0 * error, "{:e} {error:e}", found.energy);
}

/// A bound has the same bits on one thread and on many, and with what an earlier one has made.
#[test]
fn a_bound_does_not_depend_on_threads_or_earlier_bounds() {
    let mut solid = plane(Elements::P1);
    solid.mesh = Arc::new(Mesh::box_([1.0, 0.8, 0.6], [3, 2, 2], Elements::P1).expect("a mesh"));
    solid.materials = vec![Material::new(3, Isotropic::elastic(3, 2.0, 0.3, StressState::PlaneStrain))];
    solid.body_force = vec![0.1.into(), (-0.3).into(), 0.05.into()];
    solid.boundary.push(BoundaryCondition::on("back").normal_displacement(0.0));
    let mut hexahedra = solid.clone();
    hexahedra.mesh = Arc::new(Mesh::box_([1.0, 0.8, 0.6], [2, 2, 2], Elements::Q1).expect("a mesh"));
    for data in [plane(Elements::P1), plane(Elements::P2), plane(Elements::Q2), solid, hexahedra] {
        let problem = checked(data);
        let memory = solve(&problem);
        let discrete = Discretization::new(&problem);
        let last = (memory.states.last().expect("a state"), memory.reports.last().expect("a report"));
        let bits = |found: &DiscretizationError| -> Vec<u64> { found.cells.iter().map(|x| x.to_bits()).collect() };
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| {
                let mut majorant = Majorant::new(&problem, &discrete).expect("bounds");
                let first = majorant.at(&problem, &discrete, last).expect("a bound");
                let second = majorant.at(&problem, &discrete, last).expect("a bound");
                assert_eq!(bits(&first), bits(&second));
                bits(&first)
            })
        };
        assert_eq!(on(1), on(3));
    }
}
