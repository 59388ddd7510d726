//! Displacements prescribed along the normals of planes of any direction: planes of symmetry, rollers, corners of
//! oblique planes.

use std::sync::Arc;

use crate::at_rest::{parse, settings};
use crate::common::{Random, changed};
use amontons::case::{self, Case, Source};
use amontons::element::POINT_LEFT;
use amontons::field::Field;
use amontons::forms;
use amontons::hypotheses::full;
use amontons::linalg::{Backend, Graph, Layout, Multigrid, Supernodal};
use amontons::material::{Isotropic, StressState};
use amontons::mesh::{Diagonal, Elements, FacetSet, Mesh};
use amontons::output::{Memory, OutputError, ProbeSet, Sink, Snapshot};
use amontons::problem::{BoundaryCondition, Problem};
use amontons::run::{Settings, run};
use amontons::space::{Prescription, Space};
use amontons::tensor::{Point, dot, length};

const MATERIAL: &str = "density = 0\nelasticity = { law = \"isotropic\", young = 2.0, poisson = 0.3, stress_state = \"plane-strain\" }\n\
                        viscosity = { law = \"lame\", first = 0, second = 0 }\n";

/// A tenth of a thick-walled tube, a = 1 and b = 2, under the pressure 1 between its planes of symmetry.
fn tenth(elements: &str, n: usize, more: &str) -> Case {
    parse(&format!(
        "name = \"tenth\"\n[mesh]\nkind = \"ring\"\nradii = [1.0, 2.0]\nangle = 0.6283185307179586\nn = [{n}, {n}]\nelements = \"{elements}\"\n\
         [time]\nend = 1.0\nsteps = 1\n[material]\n{MATERIAL}[[boundary]]\non = \"inner\"\npressure = 1\n\
         [[boundary]]\non = \"start\"\nnormal_displacement = 0\n[[boundary]]\non = \"end\"\nnormal_displacement = 0\n{more}"
    ))
}

fn solved(problem: &Problem) -> Vec<f64> {
    let mut memory = Memory::new().states_every(1);
    run(problem, &settings(), &mut [&mut memory]).unwrap_or_else(|error| panic!("{error}"));
    memory.states.last().unwrap().u.clone()
}

/// The root of the mean square of the error of u at the nodes, against Lamé's formula in plane strain.
fn error(elements: &str, n: usize) -> f64 {
    let case = tenth(elements, n, "");
    let u = solved(&case.problem);
    let mut sum = 0.0;
    for (x, u) in case.problem.mesh.points.iter().zip(u.chunks_exact(2)) {
        let r = x[0].hypot(x[1]);
        let radial = 1.3 / 2.0 / 3.0 * (0.4 * r + 4.0 / r);
        sum += (u[0] - radial * x[0] / r).powi(2) + (u[1] - radial * x[1] / r).powi(2);
    }
    (sum / case.problem.mesh.points.len() as f64).sqrt()
}

/// A square held at one corner is rigid when the next corner cannot turn about it, and only then: each backend sees the
/// direction in which that one is held, steep or along the side that joins both.
#[test]
fn every_backend_sees_oblique_directions() {
    let mut mesh = Mesh::rectangle([1.0, 1.0], [4, 4], Diagonal::Right).unwrap();
    for (name, x) in [("corner", [0.0; 3]), ("next", [1.0, 0.0, 0.0])] {
        let set = FacetSet::of(&POINT_LEFT, mesh.nodes_at(&x));
        mesh.edges.insert(name.to_owned(), set);
    }
    let graph = Arc::new(Graph::of_mesh(&mesh));
    let law = Isotropic::elastic(2, 2.0, 0.3, StressState::PlaneStrain);
    // Less a little of the mass: what moves without strain has a negative energy then, and nothing else has.
    let mut matrix = forms::a(&mesh, &graph, &[&law.clone().into()]);
    matrix.add_scaled(-1e-6, &forms::inner_h(&mesh, &graph));
    let matrix = Arc::new(matrix);
    let backends: [Arc<dyn Backend>; 2] = [Arc::new(Supernodal), Arc::new(Multigrid::default())];
    for angle in [5.0f64, 40.0, 80.0] {
        let (s, c) = angle.to_radians().sin_cos();
        for (direction, is_rigid) in [([c, s, 0.0], true), ([s, c, 0.0], true), ([1.0, 0.0, 0.0], false)] {
            let held = [("corner", [1.0, 0.0, 0.0]), ("corner", [0.0, 1.0, 0.0]), ("next", direction)];
            let given = held.map(|(on, direction)| Prescription { on, direction, field: &Field::ZERO });
            let space = Space::new(&mesh, 2, given);
            for backend in &backends {
                let found = backend.is_positive_definite(&matrix, &Layout::of(&mesh, &space, &[]));
                assert_eq!(found.unwrap_or(false), is_rigid, "{backend:?}, {direction:?}");
            }
        }
    }
}

/// Lamé's tube between planes that are not at right angles: the displacement converges at the order of the elements
/// at least.
#[test]
fn a_tenth_of_a_tube_is_the_tube() {
    for (elements, order, small) in [("P1", 2.0, 5e-4), ("Q1", 2.0, 2e-4), ("P2", 3.0, 2e-7), ("Q2", 3.0, 2e-8)] {
        let [coarse, fine] = [16, 32].map(|n| error(elements, n));
        let found = (coarse / fine).log2();
        assert!(fine < small && found > order - 0.2, "{elements}: {coarse:.2e} and {fine:.2e}, order {found:.2}");
    }
}

/// What holds a plane of symmetry of the tube pulls along its normal with p a: half of what bursts the tube. With
/// straight cells this holds to round-off, whatever the mesh.
#[test]
fn the_planes_bear_half_of_what_bursts_the_tube() {
    struct Last(ProbeSet, Vec<f64>);
    impl Sink for Last {
        fn step(&mut self, now: &Snapshot) -> Result<(), OutputError> {
            self.1 = self.0.values(now);
            Ok(())
        }
    }
    let probes: String = ["start", "end"]
        .iter()
        .map(|on| format!("[[probe]]\nname = \"{on}\"\nquantity = \"reaction\"\non = \"{on}\"\ntake = \"integral\"\n"))
        .collect();
    for elements in ["P1", "Q1"] {
        for solver in ["direct", "iterative"] {
            let case = tenth(elements, 5, &format!("{probes}[solver]\nsolver = \"{solver}\"\n"));
            let mut last = Last(ProbeSet::new(&case.problem, &case.probes).unwrap(), Vec::new());
            run(&case.problem, &settings(), &mut [&mut last]).unwrap();
            let (s, c) = 0.628_318_530_717_958_6f64.sin_cos();
            for (found, expected) in last.1.iter().zip([0.0, -1.0, -s, c]) {
                assert!((found - expected).abs() < 1e-11, "{elements}, {solver}: {:?}", last.1);
            }
            assert_eq!(last.1.len(), 4);
        }
    }
}

/// A body whose sides all move along their normals by ε ν·x, at the time 1.
fn blown(case: &Case, mesh: Mesh, sides: &[&str], strain: f64) -> Problem {
    let boundary = sides.iter().map(|side| {
        let map = mesh.facets[*side].blocks[0].clone();
        let corners: Vec<Point> = map.nodes[..mesh.dim].iter().map(|&node| mesh.points[node as usize]).collect();
        let centre: Point = {
            let n = mesh.points.len() as f64;
            std::array::from_fn(|d| mesh.points.iter().map(|x| x[d]).sum::<f64>() / n)
        };
        let edge = |i: usize| -> Point { std::array::from_fn(|d| corners[i][d] - corners[0][d]) };
        let across = if mesh.dim == 2 {
            let [x, y, _] = edge(1);
            [y, -x, 0.0]
        } else {
            let ([a, b, c], [d, e, f]) = (edge(1), edge(2));
            [b * f - c * e, c * d - a * f, a * e - b * d]
        };
        let size = length(&across);
        let outward: Point = std::array::from_fn(|d| corners[0][d] - centre[d]);
        let sign = dot(&across, &outward).signum();
        // ν·x is the same at all points of a plane.
        let far = dot(&across, &corners[0]) * sign / size;
        BoundaryCondition::on(*side).normal_displacement(strain * far)
    });
    let boundary = boundary.collect();
    changed(&case.problem, |data| (data.mesh, data.boundary) = (Arc::new(mesh), boundary))
}

fn assert_blown(problem: &Problem, strain: f64, what: &str) {
    let (u, dim) = (solved(problem), problem.mesh.dim);
    let size = u.iter().fold(0.0f64, |size, u| size.max(u.abs()));
    assert!(size > strain * 0.1);
    for (x, u) in problem.mesh.points.iter().zip(u.chunks_exact(dim)) {
        for d in 0..dim {
            assert!((u[d] - strain * x[d]).abs() < 1e-12 * size.max(1e-3), "{what}: {u:?} at {x:?}");
        }
    }
}

/// A box with random oblique planes, all of which move along their normals as in u = ε x: there is no shear on any
/// plane then, so that this is the solution, with corners at which two and three oblique directions are prescribed.
#[test]
fn oblique_planes_move_apart() {
    let mut random = Random(2026);
    let strain = 0.01;
    for (dim, elements) in [
        (2, Elements::P1),
        (2, Elements::Q2),
        (3, Elements::P1),
        (3, Elements::P2),
        (3, Elements::Q1),
        (3, Elements::Q2),
    ] {
        for solver in ["direct", "iterative"] {
            let mesh = if dim == 2 {
                Mesh::rectangle_of(elements, [1.0, 0.8], [4, 3], Diagonal::Right).unwrap()
            } else {
                Mesh::box_([1.0, 0.8, 0.6], [3, 2, 2], elements).unwrap()
            };
            let skew: [Point; 3] =
                std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j)) + 0.3 * random.number()));
            let points = mesh.points.iter().map(|x| {
                let y: Point = std::array::from_fn(|i| (0..dim).map(|j| skew[i][j] * x[j]).sum());
                if dim == 2 { [y[0], y[1], 0.0] } else { y }
            });
            let mesh = Mesh { points: points.collect(), ..mesh };
            let sides: &[&str] = if dim == 2 {
                &["left", "right", "bottom", "top"]
            } else {
                &["left", "right", "bottom", "top", "back", "front"]
            };
            let text = format!(
                "name = \"box\"\n[mesh]\nkind = \"{}\"\nsize = {}\nn = {}\n[time]\nend = 1.0\nsteps = 1\n[material]\n{}\
                 [[boundary]]\non = \"left\"\nnormal_displacement = 0\n[solver]\nsolver = \"{solver}\"\n",
                if dim == 2 { "rectangle" } else { "box" },
                if dim == 2 { "[1, 1]" } else { "[1, 1, 1]" },
                if dim == 2 { "[1, 1]" } else { "[1, 1, 1]" },
                if dim == 2 { MATERIAL.to_owned() } else { MATERIAL.replace(", stress_state = \"plane-strain\"", "") },
            );
            let case = parse(&text);
            let problem = blown(&case, mesh, sides, strain);
            assert_blown(&problem, strain, &format!("{elements:?} in {dim}d, {solver}"));
        }
    }
}

/// A plane that is only one to the digits of a mesh file is one; a bent side is none, and the message says where.
#[test]
fn a_bent_side_is_refused() {
    let text = "name = \"ring\"\n[mesh]\nkind = \"ring\"\nradii = [1.0, 2.0]\nangle = 0.5\nn = [2, 2]\n[time]\nend = 1.0\nsteps = 1\n\
                [material]\ndensity = 0\nelasticity = { law = \"isotropic\", young = 2.0, poisson = 0.3, stress_state = \"plane-stress\" }\n\
                viscosity = { law = \"lame\", first = 0, second = 0 }\n[[boundary]]\non = \"inner\"\nnormal_displacement = 0\n";
    let refusal = case::parse(&Source::new("ring.toml", text), &[]).unwrap_err().to_string();
    assert_eq!(
        refusal,
        "ring.toml:16:23: boundary[0].normal_displacement: found facet 1 of \"inner\" with the normal (-0.930508, -0.366273), expected a side \
         in one plane; give each plane part of the side a name and an entry of its own, or hold the side by a `spring`"
    );
    let case = tenth("Q1", 4, "");
    let mut mesh = (*case.problem.mesh).clone();
    let exact = solved(&case.problem);
    // Coordinates with eight digits after the point.
    mesh.points.iter_mut().for_each(|x| x.iter_mut().for_each(|c| *c = (*c * 1e8).round() / 1e8));
    let rounded = changed(&case.problem, |data| data.mesh = Arc::new(mesh));
    for (a, b) in exact.iter().zip(solved(&rounded)) {
        assert!((a - b).abs() < 1e-6, "{a} and {b}");
    }
}

/// The certificate of a body with sliding sides, and its audits, are those of the body turned.
#[test]
fn the_certificate_does_not_turn() {
    for solver in ["direct", "iterative"] {
        let text = format!(
            "name = \"box\"\n[mesh]\nkind = \"box\"\nsize = [1, 0.8, 0.6]\nn = [4, 3, 3]\n[time]\nend = 0.5\nsteps = 4\n[material]\ndensity = 1\nheat_capacity = 1\n\
             conductivity = 1\nexpansion = 0.3\ncoupling = 0.2\nelasticity = {{ law = \"isotropic\", young = 20.0, poisson = 0.3 }}\n\
             viscosity = {{ law = \"lame\", first = 0.3, second = 0.5 }}\n[[boundary]]\non = \"left\"\nnormal_displacement = 0\ntemperature = 0\n\
             [[boundary]]\non = \"back\"\nnormal_displacement = \"0.01*t\"\n[[boundary]]\non = \"top\"\nnormal_displacement = \"-0.01*t\"\n\
             [contact]\non = \"bottom\"\nnormal = {{ law = \"compliance\", stiffness = 100.0 }}\nfriction = {{ law = \"coulomb\", coefficient = 0.2 }}\n\
             heat = {{ law = \"constant\", conductance = 1.0, foundation_temperature = 1.0 }}\n[solver]\nsolver = \"{solver}\"\n"
        );
        let case = parse(&text);
        let mesh = &case.problem.mesh;
        let ((s, c), (sp, cp)) = (0.7f64.sin_cos(), (-0.4f64).sin_cos());
        let q: [Point; 3] = [[c, -s * cp, s * sp], [s, c * cp, -c * sp], [0.0, sp, cp]];
        let points = mesh.points.iter().map(|x| q.map(|row| dot(&row, x))).collect();
        let turned = changed(&case.problem, |data| data.mesh = Arc::new(Mesh { points, ..(**mesh).clone() }));
        let [here, there] = [&case.problem, &turned].map(|problem| {
            let summary = run(problem, &Settings::default(), &mut []).unwrap_or_else(|error| panic!("{error}"));
            (full(problem), summary)
        });
        assert_eq!(here.0.findings.len(), there.0.findings.len());
        for (a, b) in here.0.findings.iter().zip(&there.0.findings) {
            assert_eq!((a.id, &a.status), (b.id, &b.status), "{solver}: {} {}", a.message, b.message);
            if let (Some(one), Some(other)) = (a.value, b.value) {
                assert!((one - other).abs() <= 1e-6 * one.abs().max(1e-9), "{solver}, {:?}: {one} {other}", a.id);
            }
        }
        for summary in [&here.1, &there.1] {
            assert!(summary.energy.closing_error < 1e-12, "{solver}: {:e}", summary.energy.closing_error);
            assert!(summary.energy.heat_closing_error < 1e-12, "{solver}: {:e}", summary.energy.heat_closing_error);
        }
    }
}
