//! The bound of the discretization error of random bodies against much finer meshes.
//!
//! A few in each run of the tests, a thousand with
//! `cargo test --release --package amontons-core --test numerics -- --ignored scan_of_bounds --nocapture`.

use std::collections::BTreeMap;
use std::sync::Arc;

use amontons::contact::{Bilateral, Compliance, Contact, Power, Signorini, Tresca};
use amontons::discretization::Discretization;
use amontons::majorant::DiscretizationError;
use amontons::material::{Isotropic, Material, StressState};
use amontons::mesh::{Diagonal, Elements, Locator, Mesh};
use amontons::problem::{BoundaryCondition, Physics, Problem, ProblemData};

use super::common::{Random, changed, checked, solve};
use super::majorant::bound;

/// The mesh turned about an axis, or in the plane.
pub(super) fn turned(mut mesh: Mesh, angle: f64) -> Mesh {
    let (s, c) = angle.sin_cos();
    for p in &mut mesh.points {
        *p = turn(p, s, c);
    }
    mesh
}

pub(super) fn turn(p: &[f64; 3], s: f64, c: f64) -> [f64; 3] {
    [c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]]
}

/// ½‖u_fine − u_coarse‖² in the norm of the finer problem.
fn difference(coarse: (&Problem, &[f64]), fine: (&Problem, &[f64])) -> f64 {
    let (mesh, dim): (&Mesh, usize) = (&fine.0.mesh, fine.0.mesh.dim);
    let locator = Locator::new(&coarse.0.mesh);
    let mut e = fine.1.to_vec();
    for (node, p) in mesh.points.iter().enumerate() {
        let (nodes, values) = locator.locate(p).expect("a point of the coarse mesh");
        for (&own, value) in nodes.iter().zip(&values) {
            (0..dim).for_each(|c| e[node * dim + c] -= value * coarse.1[own as usize * dim + c]);
        }
    }
    let form = Discretization::new(fine.0).elastic_form();
    0.5 * form.apply(&e).iter().zip(&e).map(|(a, b)| a * b).sum::<f64>()
}

/// A body with random sizes, material, loads and laws, of which the last number says what elements it has.
fn random_body(random: &mut Random, elements: Elements, dim: usize) -> ProblemData {
    let mut between = |low: f64, high: f64| low + (high - low) * 0.5 * (1.0 + random.number());
    let one = |x: f64, n: usize| (x * n as f64) as usize % n;
    let sizes = [between(0.5, 2.0), between(0.5, 1.5), between(0.5, 1.5)];
    let n = [1 + one(between(0.0, 1.0), 3), 1 + one(between(0.0, 1.0), 2)];
    let diagonal = [Diagonal::Right, Diagonal::Left, Diagonal::Crossed][one(between(0.0, 1.0), 3)];
    let mesh = match dim {
        1 => Mesh::interval(sizes[0], n[0], elements),
        2 => Mesh::rectangle_of(elements, [sizes[0], sizes[1]], n, diagonal),
        _ => Mesh::box_(sizes, [n[0].min(2), 1, 1], elements),
    };
    let angle = if dim == 1 { 0.0 } else { between(-3.0, 3.0) };
    // In space the body is turned about another axis, too.
    let tilt = if dim == 3 { between(-3.0, 3.0) } else { 0.0 };
    let placed = |v: &[f64; 3]| {
        let (s, c) = angle.sin_cos();
        let [x, y, z] = turn(v, s, c);
        let (s, c) = tilt.sin_cos();
        [x, c * y - s * z, s * y + c * z]
    };
    let mut mesh = mesh.expect("a mesh");
    if dim == 3 && matches!(elements, Elements::Q1 | Elements::Q2) {
        // Cells that are no boxes.
        let [a, b, c] = [between(-0.5, 0.5), between(-0.5, 0.5), between(-0.5, 0.5)];
        mesh.points.iter_mut().for_each(|p| *p = [p[0] + a * p[1] + b * p[2], p[1] + c * p[2], p[2]]);
    }
    mesh.points.iter_mut().for_each(|p| *p = placed(p));
    let state = if between(0.0, 1.0) < 0.5 { StressState::PlaneStrain } else { StressState::PlaneStress };
    let nu = if dim == 1 { 0.0 } else { between(0.0, 0.45) };
    let material = Material::new(dim, Isotropic::elastic(dim, between(0.5, 5.0), nu, state));
    let mut data = ProblemData::new("body", mesh, material, 1.0, 1);
    data.system = amontons::units::UnitSystem::Dimensionless;
    data.physics = Physics::Mechanics;
    let vector = |v: [f64; 3]| if dim == 1 { [v[0], 0.0, 0.0] } else { placed(&v) };
    let force = vector([between(-0.2, 0.2), between(-0.4, 0.1), between(-0.1, 0.1)]);
    data.body_force = force[..dim].iter().map(|&f| f.into()).collect();
    let side = |names: [&'static str; 2]| names[usize::from(dim > 1)];
    let (held, faces) = (side(["right", "top"]), side(["left", "bottom"]));
    data.boundary = vec![BoundaryCondition::on(held).displacement(vec![0.0; dim])];
    if between(0.0, 1.0) < 0.5 {
        data.boundary = vec![BoundaryCondition::on(held).normal_displacement(between(-0.1, 0.0))];
        if dim > 1 {
            data.boundary.push(BoundaryCondition::on("left").normal_displacement(0.0));
            if dim == 3 {
                data.boundary.push(BoundaryCondition::on("back").normal_displacement(0.0));
            }
        }
    }
    if dim > 1 {
        let traction = vector([between(-0.1, 0.1), between(-0.2, 0.2), 0.0]);
        let mut loaded = BoundaryCondition::on("right").traction(traction[..dim].to_vec());
        if between(0.0, 1.0) < 0.3 {
            loaded = BoundaryCondition { pressure: Some(between(-0.1, 0.2).into()), ..BoundaryCondition::on("right") };
        }
        data.boundary.push(loaded);
    }
    data.contacts = vec![random_contact(random, faces, dim)];
    data
}

/// A contact with a random law.
fn random_contact(random: &mut Random, faces: &str, dim: usize) -> Contact {
    let mut between = |low: f64, high: f64| low + (high - low) * 0.5 * (1.0 + random.number());
    let one = |x: f64, n: usize| (x * n as f64) as usize % n;
    let gap = if between(0.0, 1.0) < 0.5 { 0.0 } else { between(0.0, 0.1) };
    let mut contact = match one(between(0.0, 1.0), 4) {
        0 => Contact::new(faces, Compliance { stiffness: 10f64.powf(between(-1.0, 3.0)) }),
        1 => Contact::new(faces, Power { stiffness: 10f64.powf(between(0.0, 3.0)), exponent: between(1.0, 2.5) }),
        2 => Contact::new(faces, Bilateral),
        _ => Contact::new(faces, Signorini),
    };
    let is_bilateral = contact.normal.graph() == amontons::contact::GraphKind::Bilateral;
    contact.gap = if is_bilateral { 0.0.into() } else { gap.into() };
    // In space, nodes of quadratic facets that have no contact point have no slip that the laws know.
    if dim > 1 && between(0.0, 1.0) < 0.5 {
        contact = contact.friction(Tresca { bound: between(0.0, 0.1) });
    }
    contact
}

/// The energy of the difference to a mesh with every edge halved `times` times, that of the bound, and its kind.
pub(super) fn compared(problem: &Problem, times: usize) -> (f64, DiscretizationError) {
    let memory = solve(problem);
    let found = bound(problem, &memory)
        .unwrap_or_else(|refused| panic!("{refused}: {:?} {:?}", problem.boundary, problem.contacts));
    let refined = |mesh: &Mesh| mesh.refined().expect("a finer mesh");
    let mesh = (0..times).fold(refined(&problem.mesh), |mesh, pass| if pass == 0 { mesh } else { refined(&mesh) });
    let fine = changed(problem, |data| data.mesh = Arc::new(mesh));
    let reference = solve(&fine);
    let [u, u_fine] = [&memory, &reference].map(|memory| &memory.states.last().expect("a state").u);
    (difference((problem, u), (&fine, u_fine)), found)
}

/// A family of random bodies: dimension, element and their number.
type Family = (usize, Elements, usize);

const FAMILIES: [Family; 10] = [
    (1, Elements::P1, 20),
    (1, Elements::P2, 10),
    (2, Elements::P1, 70),
    (2, Elements::P2, 40),
    (2, Elements::Q1, 40),
    (2, Elements::Q2, 20),
    (3, Elements::P1, 16),
    (3, Elements::P2, 6),
    (3, Elements::Q1, 12),
    (3, Elements::Q2, 6),
];

/// The name of the law of the contact of a body.
fn law(problem: &Problem) -> String {
    let contact = &problem.contacts[0];
    let friction = if contact.friction.is_frictionless() { "" } else { ", friction" };
    let normal = format!("{:?}", contact.normal);
    format!("{}{friction}", normal.split([' ', '{']).next().unwrap_or_default())
}

/// Compares the bounds of families of bodies with the differences to finer meshes, and prints their ratios by element
/// and law. Returns the numbers of bounds and of refusals.
fn scan(families: &[Family], seed: u64, halvings: impl Fn(usize, Elements) -> usize) -> (usize, usize) {
    let mut random = Random(seed);
    let (mut count, mut refused) = (0, 0);
    for &(dim, elements, number) in families {
        let mut ratios: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        for case in 0..number {
            let problem = checked(random_body(&mut random, elements, dim));
            if let Err(why) = bound(&problem, &solve(&problem)) {
                // A refusal is no wrong bound, but should be rare.
                println!("{dim} {elements:?} {case}: {why}");
                refused += 1;
                continue;
            }
            let (error, found) = compared(&problem, halvings(dim, elements));
            let scale = 1e-12 * (found.of_solution + error);
            let ratio = (found.energy / error).sqrt();
            assert!(found.is_guaranteed(), "{dim} {elements:?} {case}: {:?}", found.estimate);
            assert!(
                found.energy >= error * (1.0 - 1e-9) - scale,
                "{dim} {elements:?} {case}: bound {:e}, error {error:e}, ratio {ratio}, of {:e}\n{:?}",
                found.energy,
                found.of_solution,
                problem.contacts
            );
            if error > 1e-10 * found.of_solution {
                ratios.entry(law(&problem)).or_default().push(ratio);
                ratios.entry("all".to_owned()).or_default().push(ratio);
            }
            count += 1;
        }
        for (law, mut ratios) in ratios {
            ratios.sort_by(f64::total_cmp);
            let at = |share: f64| ratios[((ratios.len() - 1) as f64 * share) as usize];
            let (least, median, most) = (at(0.0), at(0.5), at(1.0));
            println!("| {dim} | {elements:?} | {law} | {} | {least:.2} | {median:.2} | {most:.2} |", ratios.len());
        }
    }
    (count, refused)
}

/// Bodies of all kinds: the bound is never below the difference to a mesh eight times as fine.
#[test]
fn the_bound_of_random_bodies_is_above_the_error() {
    let is_quadratic = |elements: Elements| matches!(elements, Elements::P2 | Elements::Q2);
    let halvings = |dim: usize, elements: Elements| if is_quadratic(elements) && dim == 3 { 2 } else { 3 };
    let (count, refused) = scan(&FAMILIES, 0x2545_f491_4f6c_dd1d, halvings);
    assert!(count > 200 && refused < 10, "{count} bounds, {refused} refused");
}

#[test]
#[ignore = "a thousand bodies take minutes: cargo test --release --test numerics -- --ignored scan_of_bounds"]
fn scan_of_bounds() {
    let families = [
        (1, Elements::P1, 40),
        (1, Elements::P2, 40),
        (2, Elements::P1, 300),
        (2, Elements::P2, 240),
        (2, Elements::Q1, 160),
        (2, Elements::Q2, 120),
        (3, Elements::P1, 100),
        (3, Elements::P2, 40),
        (3, Elements::Q1, 80),
        (3, Elements::Q2, 30),
    ];
    let (count, refused) = scan(&families, 0x9e37_79b9_7f4a_7c15, |_, _| 3);
    assert!(count >= 1000 && refused < 40, "{count} bounds, {refused} refused");
}
