//! The bound of the discretization error of hexahedra: exact solutions, orders, and what all shapes have.

use std::sync::Arc;

use amontons::contact::{Compliance, Contact, Signorini, Tresca};
use amontons::discretization::Discretization;
use amontons::element::ShapeTable;
use amontons::field::Field;
use amontons::material::{Isotropic, Material, Prony, StressState};
use amontons::mesh::{CellMap, Elements, Mesh};
use amontons::problem::{BoundaryCondition, GivenTemperature, Physics, Problem, ProblemData};

use super::common::{checked, solve};
use super::majorant::{bound, bounded, edge_strain, near};
use super::majorant_random::{compared, turn};

type Tensor = [[f64; 3]; 3];

const SIDES: [&str; 6] = ["left", "right", "bottom", "top", "back", "front"];
const YOUNG: f64 = 2.0;
const POISSON: f64 = 0.3;

/// A box of hexahedra with its edges along other directions, at other angles, if `skew` is not zero.
fn parallelepiped(elements: Elements, size: [f64; 3], cells: [usize; 3], skew: f64) -> Mesh {
    let mut mesh = Mesh::box_(size, cells, elements).expect("a mesh");
    for p in &mut mesh.points {
        let sheared = [p[0] + 0.4 * skew * p[1] - 0.2 * skew * p[2], p[1] + 0.3 * skew * p[2], p[2]];
        let (s, c) = (0.7 * skew).sin_cos();
        let [x, y, z] = turn(&sheared, s, c);
        let (s, c) = (1.9 * skew).sin_cos();
        *p = [x, c * y - s * z, s * y + c * z];
    }
    mesh
}

fn space(mesh: Mesh) -> ProblemData {
    let material = Material::new(3, Isotropic::elastic(3, YOUNG, POISSON, StressState::PlaneStrain));
    let mut data = ProblemData::new("space", mesh, material, 1.0, 1);
    data.system = amontons::units::UnitSystem::Dimensionless;
    data.physics = Physics::Mechanics;
    data
}

/// A condition with the displacement of a field on a side.
fn moved(side: &str, u: &'static (impl Fn(&[f64; 3]) -> [f64; 3] + Sync)) -> BoundaryCondition {
    BoundaryCondition::on(side).displacement([0, 1, 2].map(|c| Field::of_space(move |x| u(x)[c])))
}

/// The outward normal of a plane side.
fn normal(mesh: &Mesh, side: &str) -> [f64; 3] {
    let (element, nodes) = mesh.facets[side].facets().next().expect("a facet");
    let table = ShapeTable::new(element, 1);
    let mut map = amontons::mesh::FacetMap::new(mesh, &table);
    map.at(nodes, 0);
    map.normal
}

/// A solution in the discrete space has the bound zero: a uniform pressure of a foundation on a turned, skew block.
#[test]
fn a_block_under_uniform_pressure_has_no_error() {
    let pressure = 0.1;
    for (elements, skew, layer) in
        [(Elements::Q1, 0.0, false), (Elements::Q1, 1.0, false), (Elements::Q1, 1.0, true), (Elements::Q2, 1.0, true)]
    {
        let mesh = parallelepiped(elements, [1.0, 0.7, 1.3], [2, 2, 3], skew);
        let n = normal(&mesh, "bottom");
        let at = |x: &[f64; 3]| -> f64 { x.iter().zip(&n).map(|(x, n)| x * n).sum() };
        // u·ν is zero on the foundation, which goes through the origin.
        let along = |c: usize| {
            Field::of_space(move |x: &[f64; 3]| {
                let height: f64 = x.iter().zip(&n).map(|(x, n)| x * n).sum();
                pressure / YOUNG * (POISSON * x[c] - (1.0 + POISSON) * height * n[c])
            })
        };
        assert!(mesh.points.iter().all(|x| at(x) < 1e-12));
        let mut data = space(mesh);
        data.boundary = vec![BoundaryCondition::on("top").displacement([along(0), along(1), along(2)])];
        for side in ["left", "right", "back", "front"] {
            let m = normal(&data.mesh, side);
            let size: f64 = m.iter().zip(&n).map(|(a, b)| a * b).sum();
            data.boundary.push(BoundaryCondition::on(side).traction(n.map(|n| 0.0 - pressure * size * n)));
        }
        let contact = Contact::new("bottom", Compliance { stiffness: 3.0 });
        data.contacts = vec![if layer { contact } else { Contact::new("bottom", Signorini) }];
        if layer {
            data.contacts[0].gap = (-pressure / 3.0).into();
        }
        let found = bounded(&checked(data));
        assert!(found.is_guaranteed(), "{:?}", found.estimate);
        println!("{elements:?} {skew} {layer}: {:e} of {:e}", found.energy, found.of_solution);
        assert!(found.mesh < 1e-28 * found.of_solution, "{elements:?} {skew} {layer}: {found:?}");
        // Round-off of the penetration has no factor that makes it small.
        assert!(found.energy < 1e-15 * found.of_solution, "{elements:?} {skew} {layer}: {found:?}");
    }
}

/// Quadratic solutions are exact with quadratic hexahedra, whose stress is linear: bending, and a load.
#[test]
fn quadratic_solutions_have_no_error_with_quadratic_hexahedra() {
    static BENT: fn(&[f64; 3]) -> [f64; 3] = |x| {
        let k = 0.1 / YOUNG;
        let across = x[0] * x[0] + POISSON * (x[1] * x[1] - x[2] * x[2]);
        [k * x[0] * x[1], -0.5 * k * across, -POISSON * k * x[1] * x[2]]
    };
    static PULLED: fn(&[f64; 3]) -> [f64; 3] = |x| [-0.05 * x[0] * x[0], 0.0, 0.0];
    let stiffness = YOUNG * (1.0 - POISSON) / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON));
    for (u, force) in [(&BENT, 0.0), (&PULLED, 0.1 * stiffness)] {
        for skew in [0.0, 1.0] {
            let mut data = space(parallelepiped(Elements::Q2, [1.0, 0.7, 0.8], [2, 1, 2], skew));
            data.body_force = vec![force.into(), 0.0.into(), 0.0.into()];
            data.boundary = SIDES.iter().map(|side| moved(side, u)).collect();
            let found = bounded(&checked(data));
            println!("{force} {skew}: {:e} of {:e}", found.energy, found.of_solution);
            assert!(found.energy < 1e-27 * found.of_solution, "{force} {skew}: {found:?}");
        }
    }
}

/// ½‖u_h − u‖² with the strain of u.
fn error_of(problem: &Problem, (young, poisson): (f64, f64), strain: &dyn Fn(&[f64; 3]) -> Tensor) -> f64 {
    let memory = solve(problem);
    let (mesh, u): (&Mesh, _) = (&problem.mesh, &memory.states.last().expect("a state").u);
    let (lambda, mu) = (young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), 0.5 * young / (1.0 + poisson));
    let mut sum = 0.0;
    for block in &mesh.blocks {
        let table = ShapeTable::new(block.element, 12);
        let mut map = CellMap::new(mesh, &table);
        for nodes in block.cells() {
            for q in 0..table.len() {
                map.at(nodes, q);
                let mut e = strain(&map.position).map(|row| row.map(|x| 0.0 - x));
                for (g, &node) in map.gradients.iter().zip(nodes) {
                    let own = &u[3 * node as usize..][..3];
                    for i in 0..3 {
                        (0..3).for_each(|j| e[i][j] += 0.5 * (own[i] * g[j] + own[j] * g[i]));
                    }
                }
                let trace = e[0][0] + e[1][1] + e[2][2];
                let squares: f64 = e.iter().flatten().map(|x| x * x).sum();
                sum += table.weights[q] * map.measure * (0.5 * lambda * trace * trace + mu * squares);
            }
        }
    }
    sum
}

/// The axes of a turned cube, rows.
fn axes(angle: f64) -> Tensor {
    let ((s, c), (t, d)) = (angle.sin_cos(), (1.9 * angle).sin_cos());
    [[c, s, 0.0], [-s * d, c * d, t], [s * t, -c * t, d]]
}

/// Smooth solutions without interpolated data, in a turned cube that slides on its sides: the bound falls with the
/// order of the error, and is near it. Q1: under a load, u_i' = a_i (½ − x_i)/(λ + 2μ); Q2: with the thermal stress
/// m Σ x_i², u_i' = m (x_i² − ⅓)/(λ + 2μ).
#[test]
fn the_bound_of_hexahedra_has_the_order_of_the_error() {
    let modulus = YOUNG * (1.0 - POISSON) / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON));
    let load = [0.3, -0.2, 0.1];
    for (elements, order, levels) in [(Elements::Q1, 1.0, [2, 4, 8]), (Elements::Q2, 2.0, [1, 2, 4])] {
        for angle in [0.0, 1.0] {
            let axes = axes(angle);
            let local = move |x: &[f64; 3]| axes.map(|axis| axis.iter().zip(x).map(|(a, x)| a * x).sum::<f64>());
            let global = |v: &[f64; 3]| [0, 1, 2].map(|c| (0..3).map(|k| axes[k][c] * v[k]).sum::<f64>());
            let mut energies: Vec<[f64; 2]> = Vec::new();
            for n in levels {
                let mut mesh = Mesh::box_([1.0; 3], [n; 3], elements).expect("a mesh");
                mesh.points.iter_mut().for_each(|x| *x = global(x));
                let mut data = space(mesh);
                data.boundary = SIDES.map(|side| BoundaryCondition::on(side).normal_displacement(0.0)).to_vec();
                if elements == Elements::Q1 {
                    data.body_force = global(&load).map(Field::from).to_vec();
                } else {
                    data.physics = Physics::Warmed;
                    data.materials[0].expansion = (0.4 * amontons::tensor::Sym::identity(3)).into();
                    let field = Field::of_space(move |x| local(x).iter().map(|x| x * x).sum());
                    data.temperature = vec![GivenTemperature { region: None, field, key: String::new() }];
                }
                let strain = |x: &[f64; 3]| -> Tensor {
                    let (own, is_loaded) = (local(x), elements == Elements::Q1);
                    let of = |k: usize| {
                        if is_loaded { load[k] * (0.5 - own[k]) } else { 0.4 * (own[k] * own[k] - 1.0 / 3.0) }
                    };
                    let e = [0, 1, 2].map(|k| of(k) / modulus);
                    [0, 1, 2].map(|i| [0, 1, 2].map(|j| (0..3).map(|k| axes[k][i] * e[k] * axes[k][j]).sum()))
                };
                let problem = checked(data);
                let found = bounded(&problem);
                assert!(found.is_guaranteed(), "{:?}", found.estimate);
                energies.push([found.energy, error_of(&problem, (YOUNG, POISSON), &strain)]);
                let [energy, error] = energies[energies.len() - 1];
                println!("{elements:?} {angle} {n}: error {:.3e}, ratio {:.4}", error.sqrt(), (energy / error).sqrt());
                assert!(energy >= error * (1.0 - 1e-9), "{elements:?} {angle} {n}: {energy:e} {error:e}");
            }
            let orders = [0, 1].map(|which| 0.5 * (energies[1][which] / energies[2][which]).log2());
            println!("{elements:?} {angle}: orders {orders:.3?}");
            assert!(orders.iter().all(|own| (own - order).abs() < 0.2), "{elements:?} {angle}: {orders:?}");
            assert!(energies[2][0] < 9.0 * energies[2][1], "{elements:?} {angle}: {energies:?}");
        }
    }
}

fn at_edge(x: &[f64; 3]) -> [f64; 3] {
    let r = x[0].hypot(x[1]);
    let (a, b) = (f64::midpoint(r, x[0]).max(0.0).sqrt(), f64::midpoint(r, -x[0]).max(0.0).sqrt());
    let along = -0.4 * (2.0 / 3.0) * (x[0] * a - x[1] * b) + x[1] * b;
    let across = -1.4 * (2.0 / 3.0) * (x[0] * b + x[1] * a) + x[1] * a;
    [1.3 * along, 1.3 * across, 0.0]
}

/// The plane solution whose contact ends inside a side, in a slice between walls: the bound is above the error, and at
/// most three times as large from the third level on.
#[test]
fn the_bound_of_hexahedra_at_a_contact_edge_is_above_the_error() {
    static EDGE: fn(&[f64; 3]) -> [f64; 3] = at_edge;
    for elements in [Elements::Q1, Elements::Q2] {
        for (level, n) in [5, 10, 20].into_iter().enumerate() {
            let mut mesh = Mesh::box_([2.0, 1.0, 1.0 / n as f64], [2 * n, n, 1], elements).expect("a mesh");
            mesh.points.iter_mut().for_each(|x| x[0] -= 1.0);
            let mut data = space(mesh);
            data.materials = vec![Material::new(3, Isotropic::elastic(3, 1.0, 0.3, StressState::PlaneStrain))];
            data.boundary = ["left", "right", "top"].iter().map(|side| moved(side, &EDGE)).collect();
            data.boundary.extend(["back", "front"].map(|side| BoundaryCondition::on(side).normal_displacement(0.0)));
            data.contacts = vec![Contact::new("bottom", Signorini)];
            let problem = checked(data);
            let found = bounded(&problem);
            let strain = |x: &[f64; 3]| {
                let [xx, yy, xy] = edge_strain(x[0], x[1]);
                [[xx, xy, 0.0], [xy, yy, 0.0], [0.0; 3]]
            };
            let error = error_of(&problem, (1.0, 0.3), &strain);
            let ratio = (found.energy / error).sqrt();
            println!("{elements:?} {n}: error {:.3e}, ratio {ratio:.3}, repair {:.1e}", error.sqrt(), found.repair);
            assert!(found.is_guaranteed(), "{:?}", found.estimate);
            assert!(ratio >= 1.0, "{elements:?} {n}: {ratio}");
            assert!(level < 2 || ratio <= 3.0, "{elements:?} {n}: {ratio}");
        }
    }
}

/// A skew block in contact with everything that its cells feel.
fn solid(elements: Elements) -> ProblemData {
    let mut data = space(parallelepiped(elements, [1.2, 0.8, 0.6], [3, 2, 2], 0.5));
    data.body_force = vec![0.1.into(), (-0.3).into(), 0.05.into()];
    data.boundary = vec![
        BoundaryCondition::on("top").displacement([0.0, -0.02, 0.01]),
        BoundaryCondition { pressure: Some(0.2.into()), ..BoundaryCondition::on("right") },
    ];
    data.contacts = vec![Contact::new("bottom", Compliance { stiffness: 30.0 }).friction(Tresca { bound: 0.01 })];
    data
}

/// The energy of each hexahedron does not depend on the axes, on the numbers of the nodes, or on the handedness.
#[test]
fn the_error_of_a_hexahedron_does_not_depend_on_the_description() {
    let data = solid(Elements::Q1);
    let expected = bounded(&checked(data.clone()));
    let changed = |vector: &dyn Fn(&[f64; 3]) -> [f64; 3]| {
        let mut other = data.clone();
        let mut mesh = (*data.mesh).clone();
        mesh.points.iter_mut().for_each(|p| *p = vector(p));
        other.mesh = Arc::new(mesh);
        other.body_force = vector(&[0.1, -0.3, 0.05]).map(Field::from).to_vec();
        other.boundary[0] = BoundaryCondition::on("top").displacement(vector(&[0.0, -0.02, 0.01]));
        other
    };
    let (s, c) = 1.1f64.sin_cos();
    near(&bounded(&checked(changed(&|p| turn(p, s, c)))), &expected, 1.0, 1e-8);
    // Another axis, so that all components change.
    let tilted = |p: &[f64; 3]| {
        let [x, y, z] = turn(p, s, c);
        [0.6 * x + 0.8 * z, y, 0.6 * z - 0.8 * x]
    };
    near(&bounded(&checked(changed(&tilted))), &expected, 1.0, 1e-8);

    let n = data.mesh.points.len() as u32;
    let number = |node: u32| (node * 7 + 3) % n;
    assert!(!n.is_multiple_of(7));
    let mut mesh = (*data.mesh).clone();
    for (node, p) in data.mesh.points.iter().enumerate() {
        mesh.points[number(node as u32) as usize] = *p;
    }
    mesh.blocks.iter_mut().flat_map(|block| &mut block.nodes).for_each(|node| *node = number(*node));
    let sets = mesh.facets.values_mut().flat_map(|set| &mut set.blocks);
    sets.flat_map(|block| &mut block.nodes).for_each(|node| *node = number(*node));
    // The cells begin with another vertex, too: a quarter turn about their first axis.
    for cell in mesh.blocks.iter_mut().flat_map(|block| block.nodes.chunks_exact_mut(8)) {
        let old = cell.to_vec();
        cell.iter_mut().zip([3, 2, 6, 7, 0, 1, 5, 4]).for_each(|(node, from)| *node = old[from]);
    }
    let mut other = data.clone();
    other.mesh = Arc::new(mesh);
    near(&bounded(&checked(other)), &expected, 1.0, 1e-8);

    let mut other = changed(&|p| [-p[0], p[1], p[2]]);
    let mesh = Arc::make_mut(&mut other.mesh);
    for cell in mesh.blocks.iter_mut().flat_map(|block| block.nodes.chunks_exact_mut(8)) {
        for (a, b) in [(0, 1), (3, 2), (4, 5), (7, 6)] {
            cell.swap(a, b);
        }
    }
    let sets = mesh.facets.values_mut().flat_map(|set| &mut set.blocks);
    sets.flat_map(|block| block.nodes.chunks_exact_mut(4)).for_each(|facet| facet.swap(1, 3));
    near(&bounded(&checked(other)), &expected, 1.0, 1e-8);
}

/// Solids that are hard for stresses in balance, and what materials may do.
#[test]
fn the_bound_of_hard_solids_is_above_the_error() {
    let law = |young: f64, poisson: f64| Isotropic::elastic(3, young, poisson, StressState::PlaneStrain);
    for elements in [Elements::Q1, Elements::Q2] {
        // What the energy of a step is, over that of the elastic law.
        let mut all: Vec<(&str, f64, ProblemData)> = vec![("a solid", 1.0, solid(elements))];
        let mut data = solid(elements);
        data.materials = vec![Material::new(3, law(2.0, 0.4999))];
        all.push(("nearly incompressible", 1.0, data));
        let mut data = solid(elements);
        data.mesh = Arc::new(parallelepiped(elements, [1.2, 0.03, 0.8], [2, 1, 2], 0.3));
        all.push(("thin cells", 1.0, data));
        let mut data = solid(elements);
        data.physics = Physics::Warmed;
        let expansion = [[0.1, 0.03, 0.0], [0.03, 0.2, -0.02], [0.0, -0.02, 0.15]];
        data.materials[0].expansion = amontons::tensor::Sym::from_fn(3, |i, j| expansion[i][j]).into();
        let field = Field::of_space(|x| 0.5 - x[0] + 0.3 * x[2]);
        data.temperature = vec![GivenTemperature { region: None, field, key: String::new() }];
        all.push(("thermal stress", 1.0, data));
        let mut data = solid(elements);
        let mut mesh = (*data.mesh).clone();
        let block = mesh.blocks.remove(0);
        let n = block.element.nodes.len();
        let (upper, lower): (Vec<_>, Vec<_>) =
            block.nodes.chunks_exact(n).enumerate().partition(|(cell, _)| cell / 3 % 2 == 1);
        for (region, cells) in [lower, upper].into_iter().enumerate() {
            let nodes = cells.into_iter().flat_map(|(_, nodes)| nodes.iter().copied()).collect();
            mesh.blocks.push(amontons::mesh::Block { element: block.element, region, nodes });
        }
        mesh.regions = vec!["lower".to_owned(), "upper".to_owned()];
        data.mesh = Arc::new(mesh);
        data.materials = vec![Material::new(3, law(2.0, 0.3)), Material::new(3, law(2e3, 0.3))];
        all.push(("layers", 1.0, data));
        let mut data = solid(elements);
        data.materials = vec![Material::new(3, law(2.0, 0.3)).viscosity(law(1.0, 0.3))];
        all.push(("a viscous step", 1.5, data));
        let mut data = solid(elements);
        data.materials[0].prony = Some(Prony::new(&[(&law(1.0, 0.3).into(), 1.0)]).expect("a branch"));
        all.push(("a relaxing step", 1.25, data));
        for (what, scale, data) in all {
            let problem = checked(data);
            let (elastic, found) = compared(&problem, if elements == Elements::Q1 { 2 } else { 1 });
            let (error, ratio) = (scale * elastic, (found.energy / (scale * elastic)).sqrt());
            println!("{what}, {elements:?}: {ratio:.3}, relative {:.3e}", found.relative());
            assert!(found.is_guaranteed(), "{what}: {:?}", found.estimate);
            assert!(ratio >= 1.0, "{what}, {elements:?}: bound {:e}, error {error:e}", found.energy);
        }
    }
}

/// A biquadratic side that touches between its nodes is repaired, and the energy of that is in the bound.
#[test]
fn a_quadratic_hexahedron_that_penetrates_between_its_nodes_is_repaired() {
    let mut data = space(Mesh::box_([1.0, 0.3, 1.0], [1, 1, 1], Elements::Q2).expect("a mesh"));
    let bent = Field::of_space(|x| 0.4 * ((x[0] - 0.5).powi(2) + (x[2] - 0.5).powi(2)) - 0.06);
    data.boundary = vec![BoundaryCondition::on("top").displacement([0.0.into(), bent, 0.0.into()])];
    data.contacts = vec![Contact::new("bottom", Signorini)];
    let problem = checked(data);
    let (error, found) = compared(&problem, 2);
    println!("repair {:e} of {:e}, error {error:e}", found.repair, found.energy);
    assert!(found.repair > 1e-4 * found.energy && found.energy >= error, "{found:?} {error:e}");
    // What the coefficients of r = −u_y of Bernstein's polynomials ask for: of the edges, and then of the middle.
    let memory = solve(&problem);
    let u = &memory.states.last().expect("a state").u;
    let node = |x: f64, z: f64| {
        let is_at = |p: &[f64; 3]| (p[0] - x).abs() + p[1].abs() + (p[2] - z).abs() < 1e-12;
        problem.mesh.points.iter().position(is_at).expect("a node")
    };
    let vertices = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let r = |(x, z): (f64, f64)| 0.0 - u[3 * node(x, z) + 1];
    let (mut change, mut middles) = (vec![0.0; u.len()], 0.0);
    for i in 0..4 {
        let (a, b) = (vertices[i], vertices[(i + 1) % 4]);
        let middle = (f64::midpoint(a.0, b.0), f64::midpoint(a.1, b.1));
        let lowered = r(middle).min(0.25 * (r(a) + r(b)));
        change[3 * node(middle.0, middle.1) + 1] = r(middle) - lowered;
        middles += lowered;
    }
    let at_vertices: f64 = vertices.into_iter().map(r).sum();
    change[3 * node(0.5, 0.5) + 1] = (r((0.5, 0.5)) - 0.25 * middles + 0.0625 * at_vertices).max(0.0);
    let form = Discretization::new(&problem).elastic_form();
    let expected = 0.5 * form.apply(&change).iter().zip(&change).map(|(a, b)| a * b).sum::<f64>();
    assert!((found.repair / expected - 1.0).abs() < 1e-9, "{:e} {expected:e}", found.repair);
}

/// Hexahedra whose facets are no parallelograms have no bound.
#[test]
fn hexahedra_that_are_no_parallelepipeds_are_refused() {
    let with = |change: &dyn Fn(&mut Mesh)| {
        let mut data = solid(Elements::Q1);
        change(Arc::make_mut(&mut data.mesh));
        let problem = checked(data);
        bound(&problem, &solve(&problem)).map(|found| found.is_guaranteed())
    };
    assert_eq!(with(&|_| ()), Ok(true));
    assert_eq!(with(&|mesh| mesh.points[5][0] += 1e-13), Ok(true));
    let why = with(&|mesh| mesh.points[5][0] += 1e-3).expect_err("no bound");
    assert_eq!(why.reason(), "hexahedra whose facets are no parallelograms");
}
