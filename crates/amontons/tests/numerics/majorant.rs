//! The bound of the discretization error: equalities, a singular solution, and bodies that are hard for it.

use std::sync::Arc;

use amontons::case::{self, Source};
use amontons::contact::{Compliance, Contact, Signorini, Tresca};
use amontons::discretization::Discretization;
use amontons::majorant::{DiscretizationError, Majorant, Refused};
use amontons::material::{Isotropic, Material, StressState};
use amontons::mesh::{Diagonal, Elements, Mesh};
use amontons::output::Memory;
use amontons::problem::{BoundaryCondition, Physics, Problem, ProblemData};

use super::common::{changed, checked, solve};
use super::majorant_random::{compared, turn, turned};

/// A case from its text, and overrides.
pub fn parsed(text: &str, overrides: &[&str]) -> Problem {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    case::parse(&Source::new("case.toml", text), &overrides).unwrap_or_else(|error| panic!("{error}\n{text}")).problem
}

/// The bound of the last step of a run.
pub fn bound(problem: &Problem, memory: &Memory) -> Result<DiscretizationError, Refused> {
    let discrete = Discretization::new(problem);
    let last = (memory.states.last().expect("a state"), memory.reports.last().expect("a report"));
    Majorant::new(problem, &discrete)?.at(problem, &discrete, last)
}

pub(super) const ROD: &str = r#"
name = "rod"
units = "dimensionless"
[mesh]
kind = "interval"
size = 1.0
n = 4
[time]
end = 1.0
steps = 1
[material]
density = 0.0
elasticity = { law = "isotropic", young = 1.0, poisson = 0.0 }
[load]
body_force = [1.0]
[[boundary]]
on = "left"
displacement = [0.0]
[contact]
on = "right"
normal = { law = "compliance", stiffness = 1.0 }
"#;

/// A rod on a spring layer under its weight: nodes are exact, and with the exact stress, which is linear in a cell, the
/// bound is the error f²h²/12, whatever the stiffness of the layer.
#[test]
fn the_bound_of_a_rod_is_its_error() {
    for c in [1.0f64, 10.0, 1e4] {
        for (n, squared) in
            [(4, 5.208_333_333_333_333e-3), (8, 1.302_083_333_333_333e-3), (16, 3.255_208_333_333_333e-4)]
        {
            let problem = parsed(ROD, &[&format!("mesh.n={n}"), &format!("contact.normal.stiffness={c:e}")]);
            let memory = solve(&problem);
            let pressure = memory.reports.last().expect("a report").contact.states[0].pressure;
            assert!((pressure - c / (2.0 * (1.0 + c))).abs() < 1e-11);
            let found = bound(&problem, &memory).expect("a bound");
            assert!(found.is_guaranteed(), "{:?}", found.estimate);
            assert!((2.0 * found.energy / squared - 1.0).abs() < 1e-9, "{c} {n}: {:e}", 2.0 * found.energy);
        }
    }
}

/// Cells of a rod that are all of another length: each has its own energy of the error, f²h³/(24 E).
#[test]
fn the_bound_of_an_uneven_rod_is_its_error() {
    let even = parsed(ROD, &["mesh.n=12"]);
    let problem = changed(&even, |data| {
        let mut mesh = (*data.mesh).clone();
        mesh.points.iter_mut().for_each(|x| x[0] = 0.3 * x[0] + 0.7 * x[0].powf(2.5));
        data.mesh = Arc::new(mesh);
    });
    let found = bounded(&problem);
    let lengths: Vec<f64> = problem.mesh.blocks[0]
        .cells()
        .map(|cell| (problem.mesh.points[cell[1] as usize][0] - problem.mesh.points[cell[0] as usize][0]).abs())
        .collect();
    assert_eq!(lengths.len(), found.cells.len());
    for (length, energy) in lengths.iter().zip(&found.cells) {
        assert!((24.0 * energy / length.powi(3) - 1.0).abs() < 1e-8, "{length}: {energy:e}");
    }
}

const EDGE_X: &str = "(-0.4*(2/3)*(x*sqrt(max(0,(sqrt(x^2+y^2)+x)/2))-y*sqrt(max(0,(sqrt(x^2+y^2)-x)/2)))\
    +y*sqrt(max(0,(sqrt(x^2+y^2)-x)/2)))*1.3";
const EDGE_Y: &str = "(-1.4*(2/3)*(x*sqrt(max(0,(sqrt(x^2+y^2)-x)/2))+y*sqrt(max(0,(sqrt(x^2+y^2)+x)/2)))\
    +y*sqrt(max(0,(sqrt(x^2+y^2)+x)/2)))*1.3";

/// The case of a body whose contact ends inside its side, with the singularity of Signorini's problem.
pub(super) fn edge() -> String {
    let sides: String = ["left", "right", "top"]
        .iter()
        .map(|side| format!("[[boundary]]\non = \"{side}\"\ndisplacement = [\"{EDGE_X}\", \"{EDGE_Y}\"]\n"))
        .collect();
    format!(
        "name = \"edge\"\nunits = \"dimensionless\"\n[mesh]\nkind = \"rectangle\"\nsize = [2.0, 1.0]\n\
         origin = [-1.0, 0.0]\nn = [10, 5]\n[time]\nend = 1.0\nsteps = 1\n[material]\ndensity = 0.0\n\
         elasticity = {{ law = \"isotropic\", young = 1.0, poisson = 0.3, stress_state = \"plane-strain\" }}\n{sides}\
         [contact]\non = \"bottom\"\nnormal = {{ law = \"signorini\" }}\n"
    )
}

/// ε(u) of the exact solution, components 11, 22, 12.
pub(super) fn edge_strain(x: f64, y: f64) -> [f64; 3] {
    // Z = −z^½, Z' = −½ z^−½; σ_yy = Re Z + y Im Z', σ_xx = Re Z − y Im Z', τ = −y Re Z'.
    let r = x.hypot(y);
    let (a, b) = (f64::midpoint(r, x).max(0.0).sqrt(), f64::midpoint(r, 0.0 - x).max(0.0).sqrt());
    let (re, slope) = (-a, [-0.5 * a / r, 0.5 * b / r]);
    let (yy, xx, xy) = (re + y * slope[1], re - y * slope[1], -y * slope[0]);
    let (e, nu) = (1.0, 0.3);
    let g = e / (2.0 * (1.0 + nu));
    let zz = nu * (xx + yy);
    let mean = nu * (xx + yy + zz) / e;
    [(1.0 + nu) * xx / e - mean, (1.0 + nu) * yy / e - mean, 0.5 * xy / g]
}

/// ½‖ε(u) − ε(u_h)‖² in the norm of the energy, the singular cells with many points.
pub(super) fn edge_error(problem: &Problem, u: &[f64]) -> f64 {
    use amontons::element::ShapeTable;
    use amontons::mesh::CellMap;
    let mesh: &Mesh = &problem.mesh;
    let mut sum = 0.0;
    for block in &mesh.blocks {
        let table = ShapeTable::new(block.element, 16);
        let mut map = CellMap::new(mesh, &table);
        for nodes in block.cells() {
            for q in 0..table.len() {
                map.at(nodes, q);
                let mut gradient = [[0.0; 2]; 2];
                for (g, &node) in map.gradients.iter().zip(nodes) {
                    for i in 0..2 {
                        (0..2).for_each(|j| gradient[i][j] += u[2 * node as usize + i] * g[j]);
                    }
                }
                let exact = edge_strain(map.position[0], map.position[1]);
                let e = [
                    gradient[0][0] - exact[0],
                    gradient[1][1] - exact[1],
                    0.5 * (gradient[0][1] + gradient[1][0]) - exact[2],
                ];
                let (lambda, mu) = (0.3 / (1.3 * 0.4), 0.5 / 1.3);
                let density =
                    0.5 * lambda * (e[0] + e[1]).powi(2) + mu * (e[0] * e[0] + e[1] * e[1] + 2.0 * e[2] * e[2]);
                sum += table.weights[q] * map.measure * density;
            }
        }
    }
    sum
}

/// The bound is above the error and at most three times as large from the third level on.
#[test]
fn the_bound_at_a_contact_edge_is_above_the_error() {
    for elements in ["P1", "P2", "Q1", "Q2"] {
        for (level, n) in [5, 10, 20].into_iter().enumerate() {
            let problem = parsed(&edge(), &[&format!("mesh.n=[{}, {n}]", 2 * n), &format!("mesh.elements={elements}")]);
            let memory = solve(&problem);
            let found = bound(&problem, &memory).expect("a bound");
            let error = edge_error(&problem, &memory.states.last().expect("a state").u);
            let ratio = (found.energy / error).sqrt();
            println!(
                "{elements} {n}: error {:.4e} ratio {ratio:.3} mesh {:.3e} contact {:.3e} repair {:.3e}",
                (2.0 * error).sqrt(),
                found.mesh,
                found.contact,
                found.repair,
            );
            assert!(found.is_guaranteed(), "{:?}", found.estimate);
            assert!(ratio >= 1.0, "{elements} {n}: {ratio}");
            assert!(level < 2 || ratio <= 3.0, "{elements} {n}: {ratio}");
        }
    }
}

/// A body that its foundation keeps from moving: the discrete state is exact, and its openings are round-off.
#[test]
fn a_body_at_rest_under_tractions_has_no_error() {
    let text = "name = \"rest\"\nunits = \"dimensionless\"\n[mesh]\nkind = \"rectangle\"\nsize = [1.0, 1.0]\nn = 2\n\
        [time]\nend = 1.0\nsteps = 1\n[material]\ndensity = 0.0\n\
        elasticity = { law = \"isotropic\", young = 1e5, poisson = 0.0, stress_state = \"plane-stress\" }\n\
        [[boundary]]\non = \"left\"\ndisplacement = [0, 0]\n[[boundary]]\non = \"right\"\ntraction = [100, 0]\n\
        [contact]\non = \"right\"\nnormal = { law = \"signorini\" }\n";
    for elements in ["P1", "P2", "Q1"] {
        let problem = parsed(text, &[&format!("mesh.elements={elements}")]);
        let found = bound(&problem, &solve(&problem)).expect("a bound");
        // The energy that the traction alone would cause is 0.05.
        assert!(found.energy < 1e-15 && found.relative() == 0.0, "{elements}: {found:?}");
    }
}

/// Friction at nodes that a support holds along the slip: the support takes the discrete force, whatever it is, and
/// that along the slip adds nothing to the bound.
#[test]
fn friction_that_a_support_takes_adds_nothing() {
    let text = "name = \"rubbed\"\nunits = \"dimensionless\"\n[mesh]\nkind = \"rectangle\"\nsize = [1.0, 1.0]\nn = [4, 1]\n\
        [time]\nend = 1.0\nsteps = 1\n[material]\ndensity = 0.0\n\
        elasticity = { law = \"isotropic\", young = 2.0, poisson = 0.0, stress_state = \"plane-stress\" }\n\
        [[boundary]]\non = \"left\"\ndisplacement = [0, 0]\n[[boundary]]\non = \"top\"\ndisplacement = [\"free\", 0]\n\
        [[boundary]]\non = \"bottom\"\ndisplacement = [\"free\", 0]\n[contact]\non = \"right\"\ngap = -0.1\n\
        foundation_velocity = [0, 9]\nnormal = { law = \"signorini\" }\nfriction = { law = \"tresca\", bound = 0.5 }\n";
    let (error, found) = compared(&parsed(text, &[]), 3);
    assert!(
        found.is_guaranteed() && found.contact < 1e-12 * found.energy && found.energy >= error,
        "{error:e} {found:?}"
    );
}

/// Quadrilaterals that are no parallelograms, as those of a disc: the integrals are no sums at points.
#[test]
fn distorted_quadrilaterals_have_an_estimate() {
    let mesh = Mesh::rectangle_of(Elements::Q1, [1.0, 1.0], [2, 2], Diagonal::Right).expect("a mesh");
    let moved = |by: f64| {
        let mut mesh = mesh.clone();
        // The node in the middle.
        mesh.points[4][0] += by;
        let mut data = plane(Elements::Q1);
        data.mesh = Arc::new(mesh);
        bounded(&checked(data))
    };
    assert!(moved(0.0).is_guaranteed() && moved(1e-13).is_guaranteed());
    assert_eq!(moved(0.05).estimate, ["quadrilaterals are no parallelograms: integrals are taken by quadrature"]);
}

/// Gravity is a load that is constant in a cell where its density is; where it is not, the bound is no proof.
#[test]
fn gravity_on_a_density_that_varies_has_an_estimate() {
    let text = |density: &str| {
        format!(
            "name = \"heavy\"\nunits = \"dimensionless\"\n[mesh]\nkind = \"rectangle\"\nsize = [1.0, 1.0]\nn = 3\n\
             [time]\nend = 1.0\nsteps = 1\nanalysis = \"quasistatic\"\n[material]\ndensity = {density}\n\
             elasticity = {{ law = \"isotropic\", young = 1.0, poisson = 0.2, stress_state = \"plane-strain\" }}\n\
             [[boundary]]\non = \"left\"\ndisplacement = [0, 0]\n[[load]]\ngravity = [0, -0.1]\n"
        )
    };
    for (density, is_proven) in [("2.0", true), ("\"2 + 0*x\"", false), ("\"1 + 3*y^2\"", false)] {
        let problem = parsed(&text(density), &[]);
        let (error, found) = compared(&problem, 3);
        assert!(found.is_guaranteed() == is_proven, "{density}: {:?}", found.estimate);
        assert!(found.estimate.iter().all(|why| why.starts_with("gravity or the density varies")));
        assert!(found.energy >= error, "{density}: {error:e} {:e}", found.energy);
    }
}

/// A plane body in contact with everything that its cells feel: loads, a layer with friction, and a held side.
pub(super) fn plane(elements: Elements) -> ProblemData {
    let mesh = Mesh::rectangle_of(elements, [1.2, 0.8], [5, 3], Diagonal::Right).expect("a mesh");
    let material = Material::new(2, Isotropic::elastic(2, 2.0, 0.3, StressState::PlaneStrain));
    let mut data = ProblemData::new("plane", mesh, material, 1.0, 1);
    data.system = amontons::units::UnitSystem::Dimensionless;
    data.physics = Physics::Mechanics;
    data.body_force = vec![0.1.into(), (-0.3).into()];
    data.boundary = vec![
        BoundaryCondition::on("top").normal_displacement(-0.02),
        BoundaryCondition::on("left").normal_displacement(0.0),
        BoundaryCondition { pressure: Some(0.2.into()), ..BoundaryCondition::on("right") },
    ];
    data.contacts = vec![Contact::new("bottom", Compliance { stiffness: 30.0 }).friction(Tresca { bound: 0.01 })];
    data
}

pub(super) fn bounded(problem: &Problem) -> DiscretizationError {
    bound(problem, &solve(problem)).unwrap_or_else(|refused| panic!("{refused}"))
}

pub(super) fn near(found: &DiscretizationError, expected: &DiscretizationError, scale: f64, tolerance: f64) {
    let off = |a: f64, b: f64| (a - scale * b).abs() > tolerance * scale * expected.energy;
    assert!(!off(found.energy, expected.energy), "{:e} {:e}", found.energy, expected.energy);
    assert_eq!(found.cells.len(), expected.cells.len());
    for (cell, (a, b)) in found.cells.iter().zip(&expected.cells).enumerate() {
        assert!(!off(*a, *b), "cell {cell}: {a:e} {b:e}");
    }
}

/// The energy of each cell does not depend on the axes, on the numbers of the nodes, or on the handedness.
#[test]
fn the_error_of_a_cell_does_not_depend_on_the_description() {
    let data = plane(Elements::P1);
    let expected = bounded(&checked(data.clone()));
    let mut other = data.clone();
    let (s, c) = 0.7f64.sin_cos();
    other.mesh = Arc::new(turned((*data.mesh).clone(), 0.7));
    let force = turn(&[0.1, -0.3, 0.0], s, c);
    other.body_force = vec![force[0].into(), force[1].into()];
    near(&bounded(&checked(other)), &expected, 1.0, 1e-8);

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
    let mut other = data.clone();
    other.mesh = Arc::new(mesh);
    near(&bounded(&checked(other)), &expected, 1.0, 1e-8);

    let mut mesh = (*data.mesh).clone();
    mesh.points.iter_mut().for_each(|p| p[0] = -p[0]);
    mesh.blocks.iter_mut().flat_map(|block| block.nodes.chunks_exact_mut(3)).for_each(|cell| cell.swap(1, 2));
    let sets = mesh.facets.values_mut().flat_map(|set| &mut set.blocks);
    sets.flat_map(|block| block.nodes.chunks_exact_mut(2)).for_each(|facet| facet.swap(0, 1));
    let mut other = data;
    other.mesh = Arc::new(mesh);
    other.body_force = vec![(-0.1).into(), (-0.3).into()];
    near(&bounded(&checked(other)), &expected, 1.0, 1e-8);
}

/// Lengths in millimetres and moduli in other units: energies per thickness scale with modulus times length squared.
#[test]
fn the_bound_scales_with_the_units() {
    for elements in [Elements::P1, Elements::P2, Elements::Q1, Elements::Q2] {
        let data = plane(elements);
        let expected = bounded(&checked(data.clone()));
        let (length, modulus) = (1e-3, 7e10);
        let mut other = data.clone();
        other.mesh = Arc::new((*data.mesh).clone().scaled(length));
        other.materials = vec![Material::new(2, Isotropic::elastic(2, 2.0 * modulus, 0.3, StressState::PlaneStrain))];
        other.body_force = vec![(0.1 * modulus / length).into(), (-0.3 * modulus / length).into()];
        other.boundary[0] = BoundaryCondition::on("top").normal_displacement(-0.02 * length);
        other.boundary[2].pressure = Some((0.2 * modulus).into());
        let normal = Compliance { stiffness: 30.0 * modulus / length };
        other.contacts = vec![Contact::new("bottom", normal).friction(Tresca { bound: 0.01 * modulus })];
        near(&bounded(&checked(other)), &expected, modulus * length * length, 1e-7);
    }
}

/// Bodies that are hard for stresses in balance: the bound stays above the difference to a finer mesh.
#[test]
fn the_bound_of_hard_bodies_is_above_the_error() {
    let mut all: Vec<(&str, ProblemData)> = Vec::new();
    for elements in [Elements::P1, Elements::P2, Elements::Q1, Elements::Q2] {
        let mut data = plane(elements);
        data.materials = vec![Material::new(2, Isotropic::elastic(2, 2.0, 0.4999, StressState::PlaneStrain))];
        all.push(("nearly incompressible", data));
        let mut data = plane(elements);
        data.mesh = Arc::new(Mesh::rectangle_of(elements, [1.2, 0.8], [1, 1], Diagonal::Left).expect("a mesh"));
        all.push(("one cell", data));
        let mut data = plane(elements);
        data.boundary.push(BoundaryCondition::on("bottom").traction([0.05, 0.1]));
        all.push(("a load on the side of contact", data));
        let mut data = plane(elements);
        data.boundary.remove(1);
        data.boundary[0] = BoundaryCondition::on("top").displacement([0.0, -0.02]);
        data.contacts = vec![Contact::new("bottom", Signorini), Contact::new("left", Signorini)];
        all.push(("two sides at a corner", data));
        let mut data = plane(elements);
        data.contacts = vec![Contact::new("bottom", Signorini).friction(Tresca { bound: 0.1 })];
        all.push(("a held corner on a rigid foundation", data));
        let mut data = plane(elements);
        data.physics = Physics::Warmed;
        data.materials[0].expansion = amontons::tensor::Sym::from_fn(2, |i, j| [[0.1, 0.03], [0.03, 0.2]][i][j]).into();
        let field = amontons::field::Field::of_space(|x| 0.5 - x[0]);
        data.temperature = vec![amontons::problem::GivenTemperature { region: None, field, key: String::new() }];
        all.push(("thermal stress", data));
        let mut data = plane(elements);
        let mut mesh = (*data.mesh).clone();
        let block = mesh.blocks.remove(0);
        let n = block.element.nodes.len();
        for region in 0..2 {
            let is_in = |cell: &&[u32]| {
                let height: f64 = cell.iter().map(|&node| mesh.points[node as usize][1]).sum::<f64>() / n as f64;
                usize::from(height > 0.5) == region
            };
            let nodes = block.nodes.chunks_exact(n).filter(is_in).flatten().copied().collect();
            mesh.blocks.push(amontons::mesh::Block { element: block.element, region, nodes });
        }
        mesh.regions = vec!["lower".to_owned(), "upper".to_owned()];
        data.mesh = Arc::new(mesh);
        let of = |young: f64| Material::new(2, Isotropic::elastic(2, young, 0.3, StressState::PlaneStrain));
        data.materials = vec![of(2.0), of(2e4)];
        all.push(("layers", data));
    }
    for (what, data) in all {
        let problem = checked(data);
        let (error, found) = compared(&problem, 2);
        let ratio = (found.energy / error).sqrt();
        println!("{what}, {}: {ratio:.3}, relative {:.3e}", problem.mesh.blocks[0].element.name, found.relative());
        assert!(found.is_guaranteed(), "{what}: {:?}", found.estimate);
        assert!(ratio >= 1.0 - 1e-9, "{what}: bound {:e}, error {error:e}", found.energy);
    }
}

/// A step of a viscous body: with 𝓥 = 𝓔/2 and a step of length 1 its energy is 3/2 of the elastic one.
#[test]
fn the_bound_of_a_viscous_step_is_above_the_error() {
    let mut data = plane(Elements::P1);
    let law = |scale: f64| Isotropic::lame(2, 1.1 * scale, 1.5 * scale, StressState::PlaneStrain);
    data.materials = vec![Material::new(2, law(1.0)).viscosity(law(0.5))];
    let (elastic, found) = compared(&checked(data), 3);
    let error = 1.5 * elastic;
    assert!(found.is_guaranteed() && found.energy >= error, "{:e} {error:e}", found.energy);
    assert!(found.energy < 2.0 * error, "{:e} {error:e}", found.energy);
}

/// What the proof does not cover is refused by name, or is said to be an estimate.
#[test]
fn what_has_no_bound_is_refused() {
    let reason = |change: &dyn Fn(&mut ProblemData)| {
        let mut data = plane(Elements::P1);
        change(&mut data);
        let problem = checked(data);
        bound(&problem, &solve(&problem)).expect_err("no bound").reason().to_owned()
    };
    assert_eq!(reason(&|data| data.materials[0].density = 1.0.into()), "inertia");
    let spring = amontons::problem::Support::Normal(1.0.into());
    let sprung = |data: &mut ProblemData| data.boundary[2].spring = Some(spring.clone());
    assert_eq!(reason(&sprung), "springs or dashpots at the boundary");
    let mut data = plane(Elements::P1);
    data.contacts = vec![Contact::new("bottom", Signorini).friction(amontons::contact::Coulomb { coefficient: 0.3 })];
    let found = bounded(&checked(data));
    assert!(!found.is_guaranteed() && found.estimate[0].contains("friction bound"), "{:?}", found.estimate);
    let mut data = plane(Elements::P1);
    data.contacts[0].gap = amontons::field::Field::of_space(|x| 0.01 * x[0] * x[0]);
    let found = bounded(&checked(data));
    assert!(found.is_guaranteed() && found.notes[0].contains("gap"), "{:?}", found.notes);
}

/// A results folder has the table, the field of the cells, and the bound in its summary.
#[test]
fn a_results_folder_has_the_bounds() {
    use amontons::output::{Folder, FolderOptions, Summary};
    let source = Source::new("rod.toml", ROD);
    let case = case::parse(&source, &["output.error=true".to_owned()]).unwrap_or_else(|error| panic!("{error}"));
    let dir = std::env::temp_dir().join(format!("amontons-error-{}", std::process::id()));
    let options = FolderOptions { force: true, ..case.folder_options() };
    let mut folder = Folder::create(&dir, options).expect("a folder");
    let settings = amontons::run::Settings { certificate: false, ..amontons::run::Settings::default() };
    amontons::run::run(&case.problem, &settings, &mut [&mut folder]).expect("a run");
    drop(folder);
    let table = std::fs::read_to_string(dir.join("error.csv")).expect("the table");
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows.len(), 2, "{table}");
    let energy: f64 = rows[1].split(',').nth(2).expect("a column").parse().expect("a number");
    assert!((2.0 * energy / 5.208_333_333_333_333e-3 - 1.0).abs() < 1e-9 && rows[1].ends_with(",1"), "{table}");
    let summary = std::fs::read_to_string(dir.join("summary.json")).expect("the summary");
    let summary: Summary = serde_json::from_str(&summary).expect("a summary");
    let error = summary.discretization_error.clone().expect("the bound");
    assert!(error.guaranteed && error.energy == Some(energy));
    assert!(summary.rows().iter().any(|(name, line)| name == "discretization error" && line.starts_with("at most")));
    let fields = std::fs::read_to_string(dir.join("fields/step_0000001.vtu"));
    let bytes = std::fs::read(dir.join("fields/step_0000001.vtu")).expect("the fields");
    let text = fields.unwrap_or_else(|_| String::from_utf8_lossy(&bytes).into_owned());
    assert!(text.contains("Name=\"error\""), "no field");
    std::fs::remove_dir_all(&dir).expect("removed");
}
