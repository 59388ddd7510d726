//! How many iterations a preconditioned system takes: whatever the body, the contact and the mesh, a few dozen, with
//! the results of a factor.

use std::sync::Arc;

use super::backends::{BODY, DRAGGED, state};
use amontons::case::{self, Source};
use amontons::discretization::Discretization;
use amontons::linalg::{Backend, EXACT, Layout, Multigrid, Supernodal, System, Tangent};
use amontons::material::{Isotropic, Material, StressState};
use amontons::mesh::Block;
use amontons::problem::Problem;
use amontons::time::Rule;

/// Bodies that are hard for an iteration, as words of a case: quadratic and hexahedral cells, flat and long cells,
/// materials 10⁴ apart, a nearly incompressible one, a body that nothing but contact holds. With the most iterations
/// that they take.
const BODIES: [(&str, usize, &[&str]); 19] = [
    ("P1", 32, &[]),
    ("Q1", 30, &["mesh.elements=\"Q1\""]),
    ("P2", 65, &["mesh.elements=\"P2\"", "mesh.n=[5, 5, 5]"]),
    ("Q2", 58, &["mesh.elements=\"Q2\"", "mesh.n=[5, 5, 5]"]),
    ("thin", 50, &["mesh.size=[1, 1, 0.02]"]),
    ("flat 200", 30, &["mesh.size=[200, 1, 200]"]),
    ("flat 200, held at an edge", 60, &["mesh.size=[200, 200, 1]"]),
    ("upright 50", 45, &["mesh.size=[1, 50, 50]"]),
    ("long 50", 35, &["mesh.size=[1, 50, 1]"]),
    ("oblong", 45, &["mesh.size=[400, 20, 1]"]),
    ("flat 200, Q1", 80, &["mesh.size=[200, 1, 200]", "mesh.elements=\"Q1\""]),
    ("flat 20, Q1, held at an edge", 80, &["mesh.size=[20, 20, 1]", "mesh.elements=\"Q1\""]),
    ("flat 200, P2", 100, &["mesh.size=[200, 1, 200]", "mesh.elements=\"P2\"", "mesh.n=[5, 5, 5]"]),
    ("flat 10, P2, held at an edge", 115, &["mesh.size=[10, 10, 1]", "mesh.elements=\"P2\"", "mesh.n=[5, 5, 5]"]),
    ("flat 200, Q2", 115, &["mesh.size=[200, 1, 200]", "mesh.elements=\"Q2\"", "mesh.n=[5, 5, 5]"]),
    ("flat 10, Q2, held at an edge", 100, &["mesh.size=[10, 10, 1]", "mesh.elements=\"Q2\"", "mesh.n=[5, 5, 5]"]),
    (
        "incompressible",
        360,
        &["mesh.elements=\"Q1\"", "material.dilatation=\"mean\"", "material.elasticity.poisson=0.499"],
    ),
    ("loose", 34, &["boundary=[]", "material.density=1e-9"]),
    ("two materials", 35, &[]),
];

/// Contact points that stick, press and slide in turn, with friction's nonsymmetric entries, as stiff as those of a
/// step.
fn contact(system: &System, nodes: &[u32], size: usize) -> Tangent {
    let position = system.unknowns().positions(size);
    let stiff = |unknown: u32| 2f64.powi(27) * system.condensed().scale()[unknown as usize];
    let mut tangent = Tangent::new();
    for (i, &node) in nodes.iter().enumerate() {
        let [x, y, z] = [0, 1, 2].map(|c| position[3 * node as usize + c]);
        let (Some(x), Some(y), Some(z)) = (x, y, z) else { continue };
        let soft = 0.01 * system.condensed().scale()[0];
        let slope = match i % 3 {
            0 => [[stiff(x), 0.0, 0.0], [0.0, stiff(y), 0.0], [0.0, 0.0, stiff(z)]],
            1 => [[0.0, 0.0, 0.5 * stiff(z)], [0.0, soft, 0.0], [0.0, 0.0, stiff(z)]],
            _ => continue,
        };
        tangent.add(1.0, &[(x, [1.0, 0.0, 0.0]), (y, [0.0, 1.0, 0.0]), (z, [0.0, 0.0, 1.0])], &slope);
    }
    tangent
}

/// The body with its lower half 10⁴ times stiffer.
fn halved(problem: &Problem) -> Problem {
    let with_two = problem.with(|data| {
        let mut mesh = (*data.mesh).clone();
        let whole = mesh.blocks.remove(0);
        let n = whole.element.nodes.len();
        mesh.regions = ["lower", "upper"].map(str::to_owned).to_vec();
        for (region, is_lower) in [(0, true), (1, false)] {
            let height = |cell: &[u32]| cell.iter().map(|&i| mesh.points[i as usize][2]).sum::<f64>() / n as f64;
            let cells = whole.nodes.chunks_exact(n).filter(|cell| (height(cell) < 0.5) == is_lower);
            let nodes: Vec<u32> = cells.flatten().copied().collect();
            mesh.blocks.push(Block { region, nodes, ..whole.clone() });
        }
        data.mesh = Arc::new(mesh);
        let stiff = Material::new(3, Isotropic::elastic(3, 1e4, 0.3, StressState::PlaneStrain));
        data.materials.insert(0, stiff);
    });
    with_two.expect("valid data")
}

/// A preconditioned iteration takes a few dozen products whatever the body, and leaves what double precision leaves.
#[test]
fn hard_bodies_take_few_iterations() {
    let mut wrong = Vec::new();
    for (name, most, overrides) in BODIES {
        let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
        let case = case::parse(&Source::new("body.toml", BODY), &overrides).unwrap_or_else(|f| panic!("{name}: {f}"));
        let problem = case.problem;
        let problem = if name == "two materials" { halved(&problem) } else { problem };
        let discrete = Discretization::new(&problem);
        let matrix = Arc::new(discrete.mechanical_matrix(Rule::backward_euler(problem.timeline.longest())));
        let layout = Layout::of(&problem.mesh, &discrete.v, &discrete.boundary.nodes);
        let backend: Arc<dyn Backend> = Arc::new(Multigrid::default());
        let mut system = System::new(&backend, &matrix, &layout).expect("a system");
        let tangent = contact(&system, &discrete.boundary.nodes, discrete.v.free.len());
        let b: Vec<f64> = (0..system.condensed().len()).map(|i| (i as f64 * 0.7).sin()).collect();
        let mut x = b.clone();
        system.condensed_mut().solve(&tangent, &mut x, EXACT).expect("a solution");
        let mut sum = system.condensed().apply(&x).expect("a product");
        tangent.add_product(1.0, &x, &mut sum);
        let norm = |v: &mut dyn Iterator<Item = f64>| v.map(|v| v * v).sum::<f64>().sqrt();
        let left = norm(&mut sum.iter().zip(&b).map(|(s, b)| s - b)) / norm(&mut b.iter().copied());
        println!("{name}: {} unknowns, {} iterations, {left:.1e}", b.len(), system.iterations());
        assert!(left <= 1e-11, "{name}: {left:.1e} after {} iterations", system.iterations());
        if system.iterations() > most {
            wrong.push(format!("{name}: {} iterations", system.iterations()));
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// A body pressed onto a curved foundation and dragged over it, with friction at Gauss points, more of which act than
/// the side has nodes.
const AT_GAUSS_POINTS: &str = r#"
name = "gauss"
[mesh]
kind = "box"
size = [1.0, 1.0, 1.0]
n = 8
[time]
end = 0.25
steps = 4
[material]
density = 1.0
elasticity = { law = "isotropic", young = 2.0, poisson = 0.3 }
[load]
body_force = [0.3, -1.0, 0.0]
[[boundary]]
on = "top"
displacement = ["0.02*t*x", "-0.05*t", 0]
[contact]
on = "bottom"
gap = "0.01*x*x"
quadrature = "gauss"
normal = { law = "compliance", stiffness = 1e4 }
friction = { law = "coulomb", coefficient = 0.2 }
"#;

/// Contact that couples nodes takes as few iterations as contact at nodes, four or five a linear system and not
/// hundreds, as where each node is solved by itself. Results are those of a factor.
#[test]
fn contact_at_gauss_points_takes_few_iterations() {
    for stiffness in ["1e4", "1e7"] {
        let set = [format!("contact.normal.stiffness={stiffness}")];
        let problem = case::parse(&Source::new("gauss.toml", AT_GAUSS_POINTS), &set).expect("a valid case").problem;
        let (direct, iterative) =
            (state(&problem, Arc::new(Supernodal)), state(&problem, Arc::new(Multigrid::default())));
        let scale = direct.u.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let difference = direct.u.iter().zip(&iterative.u).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
        println!(
            "{stiffness}: {} iterations, u differs by {:.1e}",
            iterative.counts.krylov_iterations,
            difference / scale
        );
        assert!(difference <= 1e-8 * scale, "{stiffness}: {:.1e}", difference / scale);
        let [newton, krylov] = [iterative.counts.newton_mechanics_total, iterative.counts.krylov_iterations];
        assert!(krylov <= 6 * newton, "{krylov} iterations in {newton} systems");
    }
}

/// Two blocks of different meshes, the upper one pressed onto the lower and dragged: a part of it sticks. Their sides
/// are not along the axes.
const PAIR: &str = r#"
name = "pair"
[mesh]
kind = "blocks"
blocks = [
    { name = "lower", size = [1.0, 0.5, 1.0], n = [6, 3, 6], elements = "P1" },
    { name = "upper", origin = [0.1, 0.5, 0.1], size = [0.8, 0.4, 0.8], n = [7, 3, 7], elements = "Q1" },
]
[time]
end = 1.0
steps = 4
[material]
density = 0.1
heat_capacity = 1
conductivity = 1
elasticity = { law = "isotropic", young = 2000.0, poisson = 0.3 }
[[region]]
on = "lower"
[region.material]
density = 0.1
heat_capacity = 1
conductivity = 1
elasticity = { law = "isotropic", young = 2000.0, poisson = 0.3 }
[[boundary]]
on = "lower_bottom"
displacement = [0, 0, 0]
temperature = 0
[[boundary]]
on = "upper_top"
pressure = "20 * t"
traction = ["3*t", 0, "2*t"]
[contact]
on = "upper_bottom"
with = "lower_top"
normal = { law = "signorini" }
friction = { law = "coulomb", coefficient = 0.3 }
heat = { law = "constant", conductance = 5 }
frictional_heat = 0.5
"#;

/// What makes pairs hard for an iteration, as words of a case, with the most iterations per linear system.
const PAIRS: [(&str, usize, &[&str]); 8] = [
    ("as it is", 8, &[]),
    ("compliance", 8, &["contact.normal={law=\"compliance\", stiffness=1e6}"]),
    ("finer below", 12, &["mesh.blocks[0].n=[14, 3, 14]"]),
    ("finer above", 11, &["mesh.blocks[1].n=[15, 3, 15]"]),
    ("P2 on Q2", 16, &["mesh.blocks[0].elements=\"P2\"", "mesh.blocks[1].elements=\"Q2\""]),
    ("stiff on soft", 13, &["material.elasticity.young=2e7"]),
    ("soft on stiff", 8, &["region[0].material.elasticity.young=2e7"]),
    ("held by friction alone", 8, &["material.density=0", "region[0].material.density=0"]),
];

/// The same problem with no side along the axes.
fn turned(problem: &Problem) -> Problem {
    let turned = problem.with(|data| {
        let mut mesh = (*data.mesh).clone();
        for [x, y, z] in &mut mesh.points {
            (*x, *y) = (0.8 * *x - 0.6 * *y, 0.6 * *x + 0.8 * *y);
            (*y, *z) = (0.28 * *y - 0.96 * *z, 0.96 * *y + 0.28 * *z);
        }
        data.mesh = Arc::new(mesh);
    });
    turned.expect("valid data")
}

/// A pair takes about as many iterations for a linear system as a body on a foundation, whichever side is finer or
/// stiffer, and its results are those of a factor. Where the levels took each side for held to the ground, it took
/// hundreds.
#[test]
fn a_pair_takes_few_iterations() {
    for (name, most, overrides) in PAIRS {
        let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
        let case = case::parse(&Source::new("pair.toml", PAIR), &overrides).unwrap_or_else(|f| panic!("{name}: {f}"));
        let problem = turned(&case.problem);
        let (direct, iterative) =
            (state(&problem, Arc::new(Supernodal)), state(&problem, Arc::new(Multigrid::default())));
        let counts = &iterative.counts;
        let systems = counts.newton_mechanics_total + counts.newton_heat_total;
        println!(
            "{name}: {} iterations of {systems} systems, {} with a factor",
            counts.krylov_iterations,
            direct.counts.newton_mechanics_total + direct.counts.newton_heat_total
        );
        for (of, a, b) in [("u", &direct.u, &iterative.u), ("θ", &direct.theta, &iterative.theta)] {
            let scale = a.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            let difference = a.iter().zip(b).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
            assert!(difference <= 1e-8 * scale, "{name}: {of} differs by {:.1e}", difference / scale);
        }
        assert!(counts.krylov_iterations <= most * systems, "{name}: {} in {systems}", counts.krylov_iterations);
        let newton = direct.counts.newton_mechanics_total;
        assert!(counts.newton_mechanics_total <= newton + newton / 4 + 2, "{name}: {newton} steps with a factor");
    }
}

/// Newton's method takes as many steps with systems that an iteration solves as with a factor: where contact holds a
/// point, residuals are 2²⁷ times those of the body, and count as the displacements that they mean. With residuals as
/// they are it took five times as many steps here, and fifty on meshes three times as fine.
#[test]
fn newton_takes_the_steps_that_it_takes_with_a_factor() {
    let problem = case::parse(&Source::new("dragged.toml", DRAGGED), &[]).expect("a valid case").problem;
    let (direct, iterative) = (state(&problem, Arc::new(Supernodal)), state(&problem, Arc::new(Multigrid::default())));
    let [most, newton] = [&direct, &iterative].map(|state| state.counts.newton_mechanics_total);
    assert!(newton <= most + most / 10, "{newton} steps, {most} with a factor");
    assert!(iterative.counts.krylov_iterations <= 17 * newton, "{} iterations", iterative.counts.krylov_iterations);
}

/// Two thin plates that lap, pressed together where they do; the upper one is pulled along the first axis of the turned
/// mesh.
const LAP: &str = r#"
name = "lap"
[time]
end = 0.1
steps = 1
inertia = false
[mesh]
kind = "blocks"
[[mesh.blocks]]
name = "lower"
elements = "P1"
size = [1.2, 0.3, 0.04]
n = [38, 10, 2]
[[mesh.blocks]]
name = "upper"
elements = "P1"
size = [1.2, 0.3, 0.04]
n = [32, 8, 2]
origin = [0.6, 0.0, 0.04]
[material]
density = 0.0
elasticity = { law = "isotropic", young = 5e4, poisson = 0.3 }
[[boundary]]
on = "lower_left"
displacement = [0, 0, 0]
[[boundary]]
on = "upper_right"
displacement = ["0.003*0.8*t", "0.003*0.168*t", "0.003*0.576*t"]
[[boundary]]
on = "lower_back"
normal_displacement = 0
[[side]]
name = "press"
of = ["upper_front"]
on = { box = { from = [0.6, -1, -1], to = [1.2, 1, 1] } }
[[boundary]]
on = "press"
pressure = 50
[[contact]]
on = "upper_back"
with = "lower_front"
normal = { law = "signorini" }
friction = { law = "coulomb", coefficient = 0.2 }
"#;

/// In the first step of a lap joint much closes and sticks at once. From where Newton's method begins it does not end
/// soon if systems are solved by an iteration; from the step without friction it does, and not after a path of smooth
/// steps that takes twice as many.
#[test]
fn a_lap_joint_begins_from_the_step_without_friction() {
    let problem = turned(&case::parse(&Source::new("lap.toml", LAP), &[]).expect("a valid case").problem);
    let (direct, iterative) = (state(&problem, Arc::new(Supernodal)), state(&problem, Arc::new(Multigrid::default())));
    let [least, newton] = [&direct, &iterative].map(|state| state.counts.newton_mechanics_total);
    println!("{newton} steps, {least} with a factor, {} iterations", iterative.counts.krylov_iterations);
    let scale = direct.u.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let difference = direct.u.iter().zip(&iterative.u).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
    assert!(difference <= 1e-8 * scale, "{:.1e}", difference / scale);
    assert!(newton <= 30, "{newton} steps, {least} with a factor");
}
