//! One problem in one, two and three dimensions: between planes of symmetry the larger body does what the smaller one
//! does.

use std::sync::Arc;

use crate::common::{Random, checked, largest, paper};
use amontons::contact::Coulomb;
use amontons::field::Field;
use amontons::material::{Isotropic, StressState};
use amontons::mesh::{Diagonal, Elements, Mesh};
use amontons::output::Memory;
use amontons::problem::{BoundaryCondition, ProblemData};
use amontons::run::{self, Settings};
use amontons::state::State;
use amontons::step::{March, Scheme};
use amontons::tensor::{Sym, length};

fn solve(data: &ProblemData) -> Memory {
    let mut memory = Memory::new().states_every(1).reports();
    let problem = checked(data.clone());
    let settings = Settings { certificate: false, ..Settings::default() };
    run::run(&problem, &settings, &mut [&mut memory]).unwrap_or_else(|error| panic!("{error}"));
    memory
}

/// The laws of the paper's material in `dim` dimensions, all strains across zero.
fn in_strain(problem: &mut ProblemData, dim: usize, direct: f64) {
    problem.materials[0].elasticity = Isotropic::elastic(dim, 2.0, 0.1, StressState::PlaneStrain).into();
    problem.materials[0].viscosity = Isotropic::lame(dim, 10.0, 10.0, StressState::PlaneStrain).into();
    // 𝓜 and 𝓡 are all ones in the plane, and couple what is across to nothing.
    let ones = Sym::from_fn(dim, |i, j| if i.max(j) < 2 { direct } else { 0.0 });
    (problem.materials[0].expansion, problem.materials[0].coupling) = (ones.into(), ones.into());
    problem.materials[0].conductivity = Sym::identity(dim).into();
}

fn symmetry(on: &str) -> BoundaryCondition {
    BoundaryCondition::on(on).normal_displacement(0.0)
}

/// The body swept along z, between planes of symmetry.
fn swept(plane: &ProblemData, height: f64, layers: usize) -> ProblemData {
    let mut body = plane.clone();
    body.mesh = Arc::new(plane.mesh.extruded(height, layers, ["back", "front"]).expect("a mesh"));
    in_strain(&mut body, 3, 1.0);
    let deeper = |fields: &mut Vec<Field>| {
        if !fields.is_empty() {
            fields.push(Field::ZERO);
        }
    };
    deeper(&mut body.body_force);
    deeper(&mut body.initial.displacement);
    deeper(&mut body.initial.velocity);
    for condition in &mut body.boundary {
        condition.traction.iter_mut().for_each(deeper);
        if let Some(displacement) = &mut condition.displacement {
            displacement.push(Some(Field::ZERO));
        }
    }
    body.boundary.extend([symmetry("back"), symmetry("front")]);
    body
}

/// Largest difference of the fields at the nodes of one layer and those of the smaller body, relative.
fn difference(small: &State, large: &State, [d, e]: [usize; 2], nodes: &[usize]) -> f64 {
    let vector = |small: &[f64], large: &[f64]| {
        let of = |node: usize, c: usize| large[nodes[node] * e + c] - if c < d { small[node * d + c] } else { 0.0 };
        let all: Vec<f64> =
            (0..nodes.len()).flat_map(|node| (0..e).map(move |c| (node, c))).map(|(node, c)| of(node, c)).collect();
        largest(&all) / largest(small)
    };
    let heat: Vec<f64> = nodes.iter().zip(&small.theta).map(|(&node, theta)| large.theta[node] - theta).collect();
    vector(&small.u, &large.u).max(vector(&small.w, &large.w)).max(largest(&heat) / largest(&small.theta))
}

/// The paper's problem in plane strain, contact, friction and heat included, swept into prisms and into hexahedra.
#[test]
fn the_paper_s_problem_between_planes_of_symmetry() {
    let height = 0.3;
    for elements in [Elements::P1, Elements::Q1] {
        let mut plane = paper(&["time.steps=16", "contact.heat.foundation_temperature=10"]).problem.into_data();
        plane.mesh = Arc::new(Mesh::rectangle_of(elements, [1.0, 1.0], [8, 8], Diagonal::Right).expect("a mesh"));
        in_strain(&mut plane, 2, 1.0);
        let body = swept(&plane, height, 2);
        let (small, large) = (solve(&plane), solve(&body));
        let size = plane.mesh.points.len();
        for (a, b) in small.states.iter().zip(&large.states).skip(1) {
            for layer in 0..3 {
                let nodes: Vec<usize> = (layer * size..(layer + 1) * size).collect();
                let found = difference(a, b, [2, 3], &nodes);
                assert!(found < 1e-10, "{elements:?}, step {}, layer {layer}: {found:e}", a.step);
            }
            assert!((b.ledger.kinetic / (height * a.ledger.kinetic) - 1.0).abs() < 1e-10);
            assert!(
                (b.ledger.friction_dissipation - height * a.ledger.friction_dissipation).abs()
                    < 1e-10 * b.ledger.turned_over
            );
            assert!(
                b.ledger.relative_closing_error().abs() < 1e-12 && b.ledger.relative_heat_closing_error().abs() < 1e-12
            );
        }
        let (a, b) = (small.reports.last().unwrap(), large.reports.last().unwrap());
        for c in 0..2 {
            assert!((b.contact.force[c] - height * a.contact.force[c]).abs() < 1e-10 * largest(&b.contact.force));
        }
        assert!(b.contact.states.iter().any(|s| s.bound > 0.0), "there is friction to compare");
    }
}

/// A strip between planes of symmetry is a rod of uniaxial strain: pressed against a warm foundation, at any angle of
/// the friction.
#[test]
fn a_rod_is_a_strip_between_planes_of_symmetry() {
    let height = 0.5;
    let mut strip = paper(&["time.steps=16", "contact.heat.foundation_temperature=10"]).problem.into_data();
    strip.mesh = Arc::new(Mesh::rectangle_of(Elements::Q1, [1.0, height], [16, 1], Diagonal::Right).expect("a mesh"));
    in_strain(&mut strip, 2, 1.0);
    // Shear of 𝓜 and 𝓡 would couple to nothing in the rod.
    let diagonal = Sym::from_fn(2, |i, j| if i == j { 1.0 } else { 0.0 });
    (strip.materials[0].expansion, strip.materials[0].coupling) = (diagonal.into(), diagonal.into());
    strip.body_force = vec![1.0.into(), Field::ZERO];
    let held = BoundaryCondition::on("left").displacement([0.0; 2]).temperature(0.0);
    strip.boundary = vec![held, symmetry("bottom"), symmetry("top")];
    let contact = &mut strip.contacts[0];
    contact.on = "right".to_owned();
    contact.friction = Coulomb { coefficient: 0.2 }.into();

    let mut rod = strip.clone();
    rod.mesh = Arc::new(Mesh::interval(1.0, 16, Elements::P1).expect("a mesh"));
    in_strain(&mut rod, 1, 1.0);
    rod.body_force.truncate(1);
    rod.initial.displacement.truncate(1);
    rod.initial.velocity.truncate(1);
    rod.boundary = vec![BoundaryCondition::on("left").displacement([0.0]).temperature(0.0)];

    let (small, large) = (solve(&rod), solve(&strip));
    let at = |x: f64, y: f64| {
        strip.mesh.points.iter().position(|p| (p[0] - x).abs() + (p[1] - y).abs() < 1e-12).expect("a node")
    };
    for (a, b) in small.states.iter().zip(&large.states).skip(1) {
        for y in [0.0, height] {
            let nodes: Vec<usize> = rod.mesh.points.iter().map(|p| at(p[0], y)).collect();
            let found = difference(a, b, [1, 2], &nodes);
            assert!(found < 1e-10, "step {}, y = {y}: {found:e}", a.step);
        }
        assert!((b.ledger.kinetic / (height * a.ledger.kinetic) - 1.0).abs() < 1e-10);
        assert!(a.ledger.relative_closing_error().abs() < 1e-12);
    }
    assert!(small.reports.last().unwrap().contact.states[0].pressure > 0.1, "the rod is pressed on the foundation");
}

/// A block on its foundation in space, pushed along both tangents while it is pressed and turned: at every point the
/// laws hold, the friction traction is against the slip in the tangent plane, and the directions of slip differ from
/// point to point. From random velocities, too.
#[test]
fn friction_in_the_tangent_plane() {
    let mu = 0.4;
    for (elements, quadrature) in [("Q1", "nodal"), ("P1", "nodal"), ("P1", "gauss"), ("P2", "nodal")] {
        let overrides = [
            format!("mesh={{kind=\"box\", size=[1.0, 0.5, 1.0], n=[4, 2, 4], elements=\"{elements}\"}}"),
            "material.elasticity={law=\"isotropic\", young=2.0, poisson=0.1}".to_owned(),
            "material.expansion=0.1".to_owned(),
            "material.coupling=0".to_owned(),
            "material.conductivity=1".to_owned(),
            "load.body_force=[0, -1, 0]".to_owned(),
            "boundary=[{on=\"top\", traction=[\"3*sin(6*t) + 4*(z - 0.5)\", -6, \"2*cos(9*t) - 4*(x - 0.5)\"], temperature=0}]".to_owned(),
            "initial={}".to_owned(),
            "time.steps=24".to_owned(),
            format!("contact.quadrature=\"{quadrature}\""),
            format!("contact.friction={{law=\"coulomb\", coefficient={mu}}}"),
        ];
        let problem = paper(&overrides.each_ref().map(String::as_str)).problem;
        let memory = solve(&problem);
        let (mut slipping, mut sticking) = (Vec::new(), 0);
        for report in &memory.reports {
            assert!(report.residual <= 1e-10, "{elements}: {:e}", report.residual);
            for state in &report.contact.states {
                let (q, slip) = (length(&state.q), length(&state.slip));
                assert!((state.pressure - 1e4 * state.penetration.max(0.0)).abs() <= 1e-9 * (1.0 + state.pressure));
                assert!(
                    (state.bound - mu * state.pressure).abs() <= 1e-12 * (1.0 + state.bound)
                        && q <= state.bound * (1.0 + 1e-9) + 1e-12
                );
                assert!(
                    state.q[1].abs() <= 1e-12 * (1.0 + q) && state.slip[1].abs() <= 1e-12 * (1.0 + slip),
                    "both lie in the tangent plane"
                );
                if state.bound > 1e-6 && slip > 1e-6 {
                    // q = s w_τ/‖w_τ‖.
                    assert!(
                        (0..3).all(|c| (state.q[c] - state.bound * state.slip[c] / slip).abs() <= 1e-7 * state.bound),
                        "{elements}: {state:?}"
                    );
                    slipping.push(state.slip[2].atan2(state.slip[0]));
                } else if state.bound > 1e-6 {
                    sticking += 1;
                }
            }
        }
        let spread = slipping.iter().fold(f64::NEG_INFINITY, |m, a| m.max(*a))
            - slipping.iter().fold(f64::INFINITY, |m, a| m.min(*a));
        assert!(
            spread > 2.0 && sticking > 0,
            "{elements}: {} slipping with directions {spread} apart, {sticking} sticking",
            slipping.len()
        );
        assert!(memory.states.last().unwrap().ledger.relative_closing_error().abs() < 1e-12);

        let mut scheme = March::new(&problem).expect("a regular system");
        let mut random = Random(7);
        for round in 0..20 {
            let mut state = memory.states[round].clone();
            let size = 10f64.powi(round as i32 % 5 - 2);
            state.w.iter_mut().for_each(|w| *w += size * random.number());
            let (_, report) = scheme.step(&state).unwrap_or_else(|error| panic!("{elements}, round {round}: {error}"));
            assert!(report.residual <= 1e-10);
        }
    }
}

/// A problem on a mesh built by hand that names a node that there is not is a fault, not a panic.
#[test]
fn a_mesh_with_an_unknown_node_is_a_fault() {
    let mut problem = paper(&["mesh.n=2"]).problem.into_data();
    let mut mesh = Mesh::clone(&problem.mesh);
    mesh.blocks[0].nodes[0] = 1000;
    problem.mesh = Arc::new(mesh);
    let faults = problem.check().expect_err("a fault").to_string();
    assert_eq!(
        faults,
        "mesh: found a cell names node 1000, expected one below 9, the number of nodes, expected cells and facets whose nodes exist"
    );
}
