//! Redistributed mass: the matrix, the bar on a wall by an independent program and in the table, identities of random
//! motions, restarts, orders in time, and what is refused.

use amontons::case::{self, Source};
use amontons::contact::{Contact, Signorini};
use amontons::discretization::Discretization;
use amontons::linalg::BlockMatrix;
use amontons::mass::MassMatrix;
use amontons::material::{Isotropic, Material, StressState};
use amontons::mesh::Mesh;
use amontons::output::Memory;
use amontons::problem::{Physics, Problem, ProblemData};
use amontons::run::with_threads;
use amontons::step::{March, Scheme};
use amontons::tensor::Rotation;

use crate::bodies::{cells, distorted};
use crate::common::{self, Random, solve};

const BAR: &str = "name = \"bar\"\nunits = \"dimensionless\"\n[mesh]\nkind = \"interval\"\nsize = 10.0\nn = 100\n\
    [time]\nend = 1.5\nsteps = 300\nscheme = \"theta\"\nmass = \"redistributed\"\n[material]\ndensity = 1.0\n\
    elasticity = { law = \"isotropic\", young = 900.0, poisson = 0.0 }\n\
    [initial]\nvelocity = [-10.0]\n[contact]\non = \"left\"\ngap = 5.0\nnormal = { law = \"signorini\" }\n";
const BLOCK: &str = "crates/amontons/tests/reference/time/block-stabilised.toml";
const RODS: &str = "crates/amontons/tests/reference/time/two-rods-stabilised.toml";
const REDISTRIBUTED: [&str; 2] = ["time.scheme=theta", "time.mass=redistributed"];

fn with(keys: &[&str]) -> Vec<String> {
    keys.iter().map(|key| (*key).to_owned()).collect()
}

fn problem(file: &str, keys: &[String]) -> Problem {
    let keys = [with(&REDISTRIBUTED), keys.to_vec()].concat();
    case::read(&common::file(file), &keys).unwrap_or_else(|error| panic!("{error}")).problem
}

fn parsed(text: &str, keys: &[&str]) -> Problem {
    case::parse(&Source::new("case.toml", text), &with(keys)).unwrap_or_else(|error| panic!("{error}")).problem
}

/// The value at x of the function 1 (0), or of a coordinate (1 …).
fn affine(x: &[f64; 3], c: usize) -> f64 {
    if c == 0 { 1.0 } else { x[c - 1] }
}

/// aᵀ M b of the affine functions a and b.
fn products(mesh: &Mesh, form: &BlockMatrix) -> Vec<f64> {
    let of = |c: usize| mesh.points.iter().map(|x| affine(x, c)).collect::<Vec<f64>>();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    (0..=mesh.dim).flat_map(|a| (0..=a).map(move |b| (a, b))).map(|(a, b)| dot(&of(a), &form.apply(&of(b)))).collect()
}

/// The matrix of a form on scalars.
fn dense(form: &BlockMatrix) -> Vec<Vec<f64>> {
    let mut all = vec![vec![0.0; form.graph().len()]; form.graph().len()];
    for (i, row) in all.iter_mut().enumerate() {
        form.row(i).for_each(|(j, value)| row[j] = value[0]);
    }
    all
}

/// A body with some of its sides in contact.
fn discretized(mesh: &Mesh, sides: &[&str], mass: MassMatrix) -> Discretization {
    let law = Isotropic::elastic(mesh.tensor_dim(), 9.0, 0.1, StressState::PlaneStrain);
    let mut data = ProblemData::new("body", mesh.clone(), Material::new(mesh.tensor_dim(), law), 1.0, 4);
    data.physics = Physics::Mechanics;
    data.materials.iter_mut().for_each(|material| material.density = 1.0.into());
    data.contacts = sides.iter().map(|side| Contact::new(*side, Signorini)).collect();
    data.mass = mass;
    Discretization::new(&common::checked(data))
}

/// Asserts that a symmetric matrix without some rows is positive definite, by its Cholesky factor.
fn is_positive(name: &str, mut matrix: Vec<Vec<f64>>, without: &[u32]) {
    let rows: Vec<usize> = (0..matrix.len()).filter(|i| !without.contains(&(*i as u32))).collect();
    for (at, &k) in rows.iter().enumerate() {
        let (pivot, above) = (matrix[k][k], matrix[k].clone());
        assert!(pivot > 1e-9, "{name}: pivot {pivot:e} of node {k}");
        for &i in &rows[at + 1..] {
            let factor = matrix[i][k] / pivot;
            rows[at + 1..].iter().for_each(|&j| matrix[i][j] -= factor * above[j]);
        }
    }
}

/// On distorted meshes of all cells: rows of the contact nodes vanish, the matrix is symmetric and otherwise
/// positive, and affine velocities, hence rigid motions, have the products of the consistent mass.
#[test]
fn mass_centre_and_inertia_stay() {
    for (element, number) in cells().zip(0..) {
        let mesh = distorted(element, 5, 0.2);
        let all: &[&str] = if mesh.dim == 1 { &["left"] } else { &["bottom", "right"] };
        let sides = &all[..=(number % all.len())];
        let [moved, own] =
            [MassMatrix::Redistributed, MassMatrix::Consistent].map(|mass| discretized(&mesh, sides, mass));
        let (form, before) = (moved.inertia().1, own.inertia().1);
        for (found, expected) in products(&mesh, form).iter().zip(products(&mesh, before)) {
            assert!((found - expected).abs() < 1e-14, "{}: {found}, expected {expected}", element.name);
        }
        let (massless, matrix) = (moved.massless(), dense(form));
        assert!(own.massless().is_empty() && massless.len() >= mesh.named(sides[0]).expect("a side").node_list().len());
        for (i, row) in matrix.iter().enumerate() {
            let is_massless = massless.contains(&(i as u32));
            assert!(!is_massless || row.iter().all(|value| *value == 0.0), "{}: row {i}", element.name);
            for (j, value) in row.iter().enumerate() {
                assert!((value - matrix[j][i]).abs() < 1e-16, "{}: ({i}, {j}) is not symmetric", element.name);
            }
        }
        is_positive(element.name, matrix, massless);
    }
}

/// A body that is turned, mirrored, scaled and numbered otherwise has the same matrix.
#[test]
fn the_matrix_is_that_of_the_body() {
    let mesh = distorted(cells().find(|cell| cell.name.ends_with("triangle")).expect("triangles"), 6, 0.2);
    let n = mesh.points.len();
    let of = |mesh: &Mesh| dense(discretized(mesh, &["bottom", "right"], MassMatrix::Redistributed).inertia().1);
    let own = of(&mesh);
    let turned = Rotation::in_plane(0.7);
    let mut other = mesh.clone();
    other.points.iter_mut().for_each(|x| *x = turned.vector(x).map(|c| 3.0 * c));
    let found = of(&other);
    // A mirrored mesh has its cells the other way round; nodes are numbered backwards.
    let mut mirrored = mesh.clone();
    mirrored.points = mesh.points.iter().rev().map(|[x, y, z]| [-x, *y, *z]).collect();
    let back = |node: &mut u32| *node = n as u32 - 1 - *node;
    for block in &mut mirrored.blocks {
        block.nodes.iter_mut().for_each(back);
        block.nodes.chunks_exact_mut(3).for_each(|cell| cell.swap(0, 1));
    }
    for block in mirrored.facets.values_mut().flat_map(|set| &mut set.blocks) {
        block.nodes.iter_mut().for_each(back);
        block.nodes.chunks_exact_mut(2).for_each(|facet| facet.swap(0, 1));
    }
    let seen = of(&mirrored);
    for i in 0..n {
        for j in 0..n {
            assert!((found[i][j] - 9.0 * own[i][j]).abs() < 1e-15, "({i}, {j}) turned");
            assert!((seen[n - 1 - i][n - 1 - j] - own[i][j]).abs() < 1e-16, "({i}, {j}) mirrored");
        }
    }
}

/// Energy over that at the start, rms of the error of the pressure, displacements and velocities of both ends.
fn bar(memory: &Memory) -> [f64; 6] {
    let (state, k) = (&memory.states[memory.states.len() - 1], memory.states[1].t);
    let mut errors: Vec<f64> = Vec::new();
    for (n, report) in memory.reports.iter().enumerate() {
        let t = (n + 1) as f64 * k;
        if t > 0.55 && t < 1.1 {
            errors.push(((report.contact.states[0].pressure - 300.0) / 300.0).powi(2));
        }
    }
    let energy = (state.ledger.kinetic + state.ledger.elastic) / 500.0;
    let rms = (errors.iter().sum::<f64>() / errors.len() as f64).sqrt();
    let last = state.u.len() - 1;
    [energy, rms, state.u[0], state.u[last], state.w[0], state.w[last]]
}

/// Cells and steps of the bar, and its numbers by `oracle/redistributed.py`.
const BY_ANOTHER: [(usize, usize, [f64; 6]); 4] = [
    (
        100,
        300,
        [
            1.000_286_026_624_25,
            0.000_434_375_221_504_54,
            -1.724_371_991_521_28,
            -1.737_074_114_589_56,
            10.500_824_111_349_4,
            5.317_540_482_330_76,
        ],
    ),
    (
        400,
        1200,
        [
            1.000_028_124_155_99,
            1.857_179_239_565_51e-05,
            -1.691_309_178_118_35,
            -1.695_133_644_884_39,
            9.961_663_366_970_01,
            5.364_167_328_068_03,
        ],
    ),
    (
        200,
        150,
        [
            1.000_391_906_117_25,
            0.034_101_457_153_935,
            -1.760_114_501_582_16,
            -1.785_097_106_734_67,
            11.029_007_662_124_4,
            6.275_943_924_064_72,
        ],
    ),
    (
        200,
        2400,
        [
            1.000_013_246_915_89,
            0.010_225_748_237_228,
            -1.684_895_626_707_9,
            -1.679_693_055_650_28,
            10.000_616_190_021_4,
            5.892_715_977_834_72,
        ],
    ),
];

/// The bar of Doyen, Ern and Piperno by an independent program, and beside the table of another one in which the mass
/// of the contact node is lumped and moved to its neighbour.
#[test]
fn the_bar_hits_the_wall_as_in_an_independent_program() {
    let table = std::fs::read_to_string(common::file("crates/amontons/tests/reference/time/bar.csv"));
    let table = table.expect("the reference numbers");
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    for (n, steps, expected) in BY_ANOTHER {
        let memory = solve(&parsed(BAR, &[&format!("mesh.n={n}"), &format!("time.steps={steps}")]));
        let found = bar(&memory);
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "n = {n}: {found}, expected {expected}");
        }
        let ledger = &memory.states[steps].ledger;
        assert!(ledger.closing_error.abs() <= 1e-12 * ledger.turned_over, "n = {n}: {:e}", ledger.closing_error);
        let number = |row: &[&str], i: usize| row[i].parse::<f64>().expect("a number");
        let is_row = |row: &&Vec<&str>| {
            row[0] == "redistributed" && row[4] == n.to_string() && (1.5 / number(row, 5)).round() as usize == steps
        };
        let row = rows.iter().find(is_row).expect("a row of the table");
        let [energy, rms, ..] = found;
        assert!((energy - number(row, 6)).abs() < 2e-4, "n = {n}: {energy}");
        // With half a cell a step the consistent mass of the other cells shows its dispersion.
        assert!(rms < if steps == 2400 { 0.011 } else { number(row, 7) }, "n = {n}: {rms}");
    }
}

/// Asserts that the identity closes and that no point is inside its rigid foundation or pressed apart from it.
fn holds(name: &str, memory: &Memory) {
    for (state, report) in memory.states.iter().skip(1).zip(&memory.reports) {
        let (step, open, size) = (state.step, state.ledger.closing_error.abs(), state.ledger.turned_over);
        assert!(open <= 1e-12 * size, "{name}, step {step}: energy closes to {open:e} of {size:e}");
        for state in &report.contact.states {
            assert!(state.penetration <= 1e-11, "{name}, step {step}: inside by {:e}", state.penetration);
            assert!(state.pressure == 0.0 || state.penetration >= -1e-11, "{name}, step {step}: pressed apart");
        }
    }
    let pressed = memory.reports.iter().flat_map(|report| &report.contact.states).filter(|s| s.pressure > 0.0);
    assert!(pressed.count() > 5, "{name} hits");
}

/// The block thrown on a plane with random velocities, loads, gaps, friction and viscosity, with and without wear and
/// with a side whose contact nodes are held.
#[test]
fn identities_close_in_random_motions() {
    let mut random = Random(53);
    for number in 0..12 {
        let mut within = |from: f64, to: f64| from + (to - from) * 0.5 * (random.number() + 1.0);
        let mut keys = vec![
            "mesh.n=[8, 6]".to_owned(),
            format!("time.theta={}", if number % 2 == 0 { 0.5 } else { within(0.5, 0.9) }),
            format!(
                "initial.velocity=[\"{} + {}*y\", \"{} + {}*x\"]",
                within(-1.0, 1.0),
                within(-1.0, 1.0),
                within(-1.5, -0.2),
                within(-1.0, 1.0)
            ),
            format!("load.body_force=[\"{}*sin(20*t)\", {}]", within(-9.0, 9.0), within(-5.0, 0.0)),
            format!("contact.gap=\"{} + {}*x\"", within(0.0, 0.02), within(0.0, 0.01)),
            format!("contact.friction.coefficient={}", within(0.0, 0.8)),
            format!("contact.foundation_velocity=[{}, 0]", within(-1.0, 1.0)),
            format!("material.viscosity.second={}", within(0.0, 0.1)),
            format!("material.elasticity.young={}", within(20.0, 500.0)),
        ];
        match number % 4 {
            2 => keys.push("contact.wear={ law = \"archard\", coefficient = 0.002 }".to_owned()),
            3 => keys.push("boundary=[{ on = \"right\", displacement = [\"0.1*t\", \"free\"] }]".to_owned()),
            _ => {}
        }
        holds(&format!("throw {number}"), &solve(&problem(BLOCK, &keys)));
    }
}

/// A layer at ϑ = ½ keeps its energy to second order, and friction heats the block: both balances close.
#[test]
fn layers_heat_and_branches_close() {
    for coupling in ["staggered", "extrapolated", "monolithic"] {
        let keys = with(&[
            "mesh.n=[8, 6]",
            "contact.normal={ law = \"compliance\", stiffness = 2000 }",
            "contact.heat={ law = \"ramp\", conductance = 1, width = 1e-3, foundation_temperature = 0.0 }",
            "material.heat_capacity=1.0",
            "material.conductivity=0.1",
            "material.expansion=0.3",
            "material.coupling=0.3",
            "material.prony=[{ ratio = 0.3, time = 0.05 }]",
            "material.viscosity={ law = \"lame\", first = 0.0, second = 0.01 }",
            "initial.temperature=0.01",
            &format!("scheme.coupling={coupling}"),
        ]);
        let memory = solve(&problem(BLOCK, &keys));
        for state in &memory.states {
            let ledger = &state.ledger;
            assert!(ledger.closing_error.abs() <= 1e-12 * ledger.turned_over, "{coupling}, step {}", state.step);
            assert!(ledger.heat_closing_error.abs() <= 1e-12 * ledger.heat_turned_over, "{coupling}: heat");
        }
        let end = &memory.states[memory.states.len() - 1].ledger;
        assert!(end.contact_energy > 0.0 || end.friction_dissipation > 0.0, "{coupling}: it hits");
    }
}

/// Two rods of one length change their velocities: the left one rests, the right one has all momentum.
#[test]
fn rods_collide() {
    let blocks = "mesh.blocks=[{ name = \"lower\", size = [1.0], n = [50] }, { name = \"upper\", size = [1.0], n = [50], origin = [1.0102] }]";
    let keys = with(&[blocks, "time.end=0.35", "time.steps=700"]);
    let problem = problem(RODS, &keys);
    let memory = solve(&problem);
    holds("two rods", &memory);
    let state = &memory.states[memory.states.len() - 1];
    let discrete = Discretization::new(&problem);
    let momentum = |from: usize| discrete.inertia().1.apply(&state.w)[from..from + 51].iter().sum::<f64>();
    let (left, right) = (momentum(0), momentum(51));
    assert!((left + right - 1.0).abs() < 1e-11, "momentum {left} + {right}");
    assert!((right - 1.0).abs() < 0.02, "the right rod has {right}");
    let energy = (state.ledger.kinetic + state.ledger.elastic) / 0.5;
    assert!((energy - 1.0).abs() < 2e-3, "energy {energy}");
}

/// From every state a run goes on with the same bits, on one thread and on several, through phases and impacts.
#[test]
fn a_run_goes_on_with_the_same_bits() {
    let phases = "phase=[{ name = \"press\", end = 0.04, steps = 2, analysis = \"quasistatic\" }, { name = \"throw\", end = 0.1, steps = 12 }, { name = \"let\", end = 0.2, steps = 25 }]";
    let keys = [
        phases,
        "boundary=[{ on = \"top\", displacement = [\"0.1*t\", \"-0.06*sin(20*t)\"], phases = [\"press\", \"throw\"] }]",
        "initial.velocity=[0, 0]",
        "mesh.n=[8, 6]",
        REDISTRIBUTED[0],
        REDISTRIBUTED[1],
    ];
    let text = std::fs::read_to_string(common::file(BLOCK)).expect("the case");
    let text = common::spoil(&text, "end = 0.2\nsteps = 40\n", "");
    let text = common::spoil(&text, "[[boundary]]\non = \"top\"\ntraction = [0, 0]\n", "");
    let problem = parsed(&text, &keys);
    let run = |threads: usize| {
        with_threads(Some(threads), || {
            let mut scheme = March::new(&problem).expect("regular systems");
            let mut states = vec![(scheme.initial().expect("finite data"), scheme.kept())];
            while states.len() <= problem.timeline.steps() {
                let next = scheme.step(&states[states.len() - 1].0).unwrap_or_else(|error| panic!("{error}"));
                states.push((next.0, scheme.kept()));
            }
            states
        })
        .unwrap_or_else(|error| panic!("{error}"))
    };
    let (one, several) = (run(1), run(3));
    assert!(one == several, "the number of threads changes bits");
    for pair in one.windows(2) {
        let mut again = March::new(&problem).expect("regular systems");
        again.recall(&pair[0].1).expect("regular systems");
        let found = again.step(&pair[0].0).unwrap_or_else(|error| panic!("{error}")).0;
        assert!(found == pair[1].0 && again.kept() == pair[1].1, "step {}", found.step);
        let ledger = &found.ledger;
        assert!(ledger.closing_error.abs() <= 1e-12 * ledger.turned_over, "step {} closes", found.step);
    }
}

/// A rod of 8 cells that opens and closes on a rigid wall, on a fixed mesh: displacement and velocity off the wall
/// converge with order 2 at ϑ = ½, where impacts have about 1; backward Euler tends to the same motion.
#[test]
fn the_order_is_that_of_a_smooth_motion() {
    let end = |steps: usize, scheme: &str| {
        let keys = ["mesh.n=8", "contact.gap=0.3", &format!("time.steps={steps}"), &format!("time.scheme={scheme}")];
        let mut states = solve(&parsed(BAR, &keys)).states;
        let state = states.pop().expect("a state");
        [state.u, state.w[1..].to_vec()]
    };
    let apart = |a: &[f64], b: &[f64]| {
        let difference: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
        common::largest(&difference) / common::largest(b)
    };
    let exact = end(24000, "theta");
    for (scheme, least) in [("theta", [1.8, 1.8]), ("euler", [0.8, 0.4])] {
        let found = [400, 1600].map(|steps| end(steps, scheme));
        for part in [0, 1] {
            let errors = [0, 1].map(|i| apart(&found[i][part], &exact[part]));
            let order = (errors[0] / errors[1]).log2() / 2.0;
            println!("{scheme} {part}: {errors:?} {order}");
            assert!(order > least[part], "{scheme}, part {part}: order {order}, {errors:?}");
        }
    }
}

#[test]
fn data_that_it_does_not_take_are_refused() {
    for (keys, expected) in [
        (
            &["time.restitution=0.5"][..],
            "time.restitution: found a coefficient of restitution with mass = \"redistributed\", expected none",
        ),
        (&["time.restitution=0.0"], "time.restitution: found 0.0 with mass = \"redistributed\""),
        (&["time.friction=end"], "time.friction: found \"end\" with mass = \"redistributed\""),
        (
            &["time.scheme=contact-stabilised"],
            "time.mass: found \"redistributed\" with time.scheme = \"contact-stabilised\"",
        ),
        (&["rigid=[{ on = \"body\" }]"], "time.mass: found \"redistributed\" with a rigid part in contact"),
        (&["mesh.n=[8, 1]"], "time.mass: found \"redistributed\" with a body with too few layers of nodes off contact"),
        (
            &["mesh.n=[1, 1]", "contact.on=\"boundary\"", "side=[{ name = \"boundary\", where = \"x > -1\" }]"],
            "time.mass: found \"redistributed\" with a body all of whose nodes are in contact",
        ),
    ] {
        let keys = [with(&REDISTRIBUTED), with(keys)].concat();
        let refused = case::read(&common::file(BLOCK), &keys).err().map(|error| error.to_string());
        let told = refused.unwrap_or_default();
        assert!(told.contains(expected), "{keys:?}: {told}");
    }
}

/// The steel bar of the benchmark with 100 steps a contact: the velocity of the rebound over that of the impact, with
/// impacts and without, on cells that a step resolves and on finer ones.
#[test]
fn a_steel_bar_rebounds_with_its_velocity() {
    let rebound = |name: &str, cells: &str| {
        let file = common::file(&format!("crates/amontons/benchmarks/bar-impact-{name}.toml"));
        let keys = with(&["time.steps=150", cells]);
        let problem = case::read(&file, &keys).unwrap_or_else(|error| panic!("{error}")).problem;
        let memory = solve(&problem);
        let state = &memory.states[memory.states.len() - 1];
        let discrete = Discretization::new(&problem);
        let along = |v: &[f64]| v.iter().step_by(2).sum::<f64>();
        let form = discrete.inertia().1;
        let energy = (state.ledger.kinetic + state.ledger.elastic) / memory.states[0].ledger.kinetic;
        (along(&form.apply(&state.w)) / along(&form.apply(&memory.states[0].w)), energy)
    };
    for (cells, with_impacts, without) in
        [("mesh.n=[25, 1]", 0.965..0.98, 0.99..1.001), ("mesh.n=[100, 1]", 0.97..0.976, 0.976..0.98)]
    {
        let [(lossy, before), (own, energy)] = ["rigid", "redistributed"].map(|name| rebound(name, cells));
        assert!(with_impacts.contains(&-lossy) && before < 0.992, "{cells}: {lossy}, {before}");
        assert!(without.contains(&-own) && (energy - 1.0).abs() < 2.5e-3, "{cells}: {own}, {energy}");
    }
}
