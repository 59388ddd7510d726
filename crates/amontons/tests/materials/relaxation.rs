//! Branches that relax: against their closed forms, with times that are numbers and times that vary over the body.

use std::sync::Arc;

use crate::common::{case, changed, checked, largest, paper, rod, solve, told};
use amontons::case::{self as cases, Source};
use amontons::field::{Coefficient, Law};
use amontons::material::{Dilatation, Isotropic, Prony, StressState, TensorLaw};
use amontons::mesh::{Diagonal, Elements, Mesh};
use amontons::output::{cell_values, nodal_stress};
use amontons::problem::{BoundaryCondition, Problem};
use amontons::state::State;
use amontons::tensor::{Point, Sym};

fn last(problem: &Problem) -> State {
    solve(problem).states.pop().expect("a state")
}

/// A rod with Maxwell branches held at a strain ε from t = 0⁺: the branch strains are ε (1 + k/τ)^(−n), so the reaction
/// is known to round-off; as the steps are refined it comes to E ε (1 + Σ g exp(−t/τ)) at first order.
#[test]
fn stress_relaxes_by_the_prony_series() {
    let pairs = [(0.5, 0.2), (2.0, 1.5)];
    let (young, strain) = (2.0, 0.01);
    let end = |steps: usize| {
        let mut problem = rod(steps, 0.0);
        problem.boundary[2].traction = None;
        problem.boundary[2].displacement = Some(vec![Some(strain.into()), None]);
        problem.materials[0].viscosity = Isotropic::lame(2, 0.0, 0.0, StressState::PlaneStress).into();
        problem.materials[0].prony = Some(Prony::ratios(&problem.materials[0].elasticity, &pairs).expect("branches"));
        let problem = checked(problem);
        let memory = solve(&problem);
        let k = problem.timeline.longest();
        for states in memory.states.windows(2) {
            let [old, new] = [&states[0], &states[1]];
            // The springs of all branches have the strain ε(z), z = u (1 + k/τ)^(−n).
            for (z, (_, time)) in new.branches.iter().zip(pairs) {
                let left = (1.0 + k / time).powi(-(new.step as i32));
                assert!(z.iter().zip(&new.u).all(|(z, u)| (z - left * u).abs() < 1e-12 * strain));
            }
            let stored: f64 = pairs.iter().map(|(g, time)| g * (1.0 + k / time).powi(-2 * new.step as i32)).sum();
            let energy = 0.25 * 0.5 * young * strain * strain * (1.0 + stored);
            assert!((new.ledger.elastic / energy - 1.0).abs() < 1e-9, "{:e}, expected {energy:e}", new.ledger.elastic);
            assert!(new.ledger.viscous_dissipation >= old.ledger.viscous_dissipation);
            assert!(new.ledger.relative_closing_error().abs() < 1e-12);
        }
        let last = memory.states.last().expect("a state");
        // The dissipated energy of the limit: Σ g E ε²/2 (1 − exp(−2t/τ)) of the volume, without that of the sudden
        // load.
        last.ledger.viscous_dissipation
    };
    let exact: f64 =
        pairs.iter().map(|(g, time)| 0.25 * 0.5 * g * young * strain * strain * (1.0 - f64::exp(-2.0 / time))).sum();
    let errors = [64, 128, 256].map(|steps| (end(steps) - exact).abs());
    for pair in errors.windows(2) {
        assert!(((pair[0] / pair[1]).log2() - 1.0).abs() < 0.1, "{errors:?}");
    }
}

/// The branches couple with contact: the paper's problem with a branch as stiff as the body keeps both identities.
#[test]
fn branches_and_contact_keep_the_identities() {
    let mut problem = paper(&["mesh.n=8", "time.steps=32"]).problem.into_data();
    problem.materials[0].prony =
        Some(Prony::ratios(&problem.materials[0].elasticity, &[(3.0, 0.1), (1.0, 10.0)]).expect("branches"));
    let memory = solve(&checked(problem));
    for state in &memory.states {
        assert!(
            state.ledger.relative_closing_error().abs() < 1e-12
                && state.ledger.relative_heat_closing_error().abs() < 1e-12
        );
    }
    assert!(memory.reports.iter().all(|report| report.residual < 1e-10));
}

const RATIO: f64 = 1.5;

/// τ(x) = 0.4/(1 + x).
fn time_at(x: &Point) -> f64 {
    0.4 / (1.0 + x[0])
}

/// The rod of `creep-graded-time` on a mesh of its own, without lateral contraction.
fn creep(mesh: Mesh, steps: usize) -> Problem {
    let problem = case("crates/amontons/benchmarks/creep-graded-time.toml", &[format!("time.steps={steps}")]).problem;
    changed(&problem, |data| {
        let law: Law<dyn TensorLaw> = Isotropic::elastic(mesh.dim, 2.0, 0.0, StressState::PlaneStrain).into();
        let pairs = [(RATIO.into(), Coefficient::varying(time_at))];
        let material = &mut data.materials[0];
        material.prony =
            Some(Prony::varying(&pairs.map(|(ratio, time)| (law.clone(), ratio, time)), &mesh.sites(None)).unwrap());
        material.viscosity = Isotropic::lame(mesh.dim, 0.0, 0.0, StressState::PlaneStrain).into();
        material.elasticity = law;
        for condition in &mut data.boundary {
            if condition.displacement.is_some() {
                condition.displacement = Some((0..mesh.dim).map(|c| (c == 0).then(|| 0.0.into())).collect());
            }
            if condition.traction.is_some() {
                condition.traction = Some((0..mesh.dim).map(|c| if c == 0 { 0.1 } else { 0.0 }.into()).collect());
            }
        }
        if mesh.dim == 2 {
            let displacement = Some(vec![None, Some(0.0.into())]);
            data.boundary.push(BoundaryCondition { displacement, ..BoundaryCondition::on("bottom") });
        }
        data.mesh = Arc::new(mesh);
    })
}

/// The strain of backward Euler under σ = 0.1 at a point: e' (1 + k/τ) = e + ε' − ε, σ = E ε' + g E e'.
fn strain(tau: f64, k: f64, steps: usize) -> f64 {
    let (young, stress) = (2.0, 0.1);
    let (mut strain, mut spring, left) = (0.0, 0.0, 1.0 / (1.0 + k / tau));
    for _ in 0..steps {
        let next = (stress / young - RATIO * left * (spring - strain)) / (1.0 + RATIO * left);
        spring = left * (spring + next - strain);
        strain = next;
    }
    strain
}

/// On linear elements the spring of a cell has one strain: the end of the rod moves by the sum of the recursions at the
/// middles of the cells. The stress is that of the load, at the cells and recovered at the nodes.
#[test]
fn a_rod_whose_time_varies_creeps_as_its_points_do() {
    let (n, steps) = (10, 50);
    let problem = creep(Mesh::interval(1.0, n, Elements::P1).unwrap(), steps);
    let memory = solve(&problem);
    let state = memory.states.last().unwrap();
    let cells = n as f64;
    let expected: f64 = (0..n)
        .map(|i| strain(time_at(&[(i as f64 + 0.5) / cells, 0.0, 0.0]), problem.timeline.longest(), steps) / cells)
        .sum();
    let found = largest(&state.u);
    assert!((found / expected - 1.0).abs() < 1e-12, "{found:e}, expected {expected:e}");
    for values in cell_values(&problem, state) {
        assert!((values.stress.get(0, 0) - 0.1).abs() < 1e-12, "{}", values.stress.get(0, 0));
    }
    for (_, stress) in nodal_stress(&problem, state).regions.concat() {
        assert!((stress.get(0, 0) - 0.1).abs() < 1e-12);
    }
    for state in &memory.states {
        assert!(state.ledger.relative_closing_error().abs() < 1e-12);
    }
    // Dissipated in the dashpots and not by the scheme alone.
    assert!(state.ledger.viscous_dissipation > 0.1 * state.ledger.elastic);
}

/// Quadratic and bilinear elements keep several strains a cell: displacement and stress converge with the orders of the
/// element to backward Euler at every point.
#[test]
fn orders_of_a_time_that_varies() {
    let steps = 20;
    for (elements, orders) in [(Elements::P2, [3.0, 2.0]), (Elements::Q2, [3.0, 2.0]), (Elements::Q1, [2.0, 2.0])] {
        let errors = [8, 16, 32].map(|n| {
            let problem = creep(Mesh::rectangle_of(elements, [1.0, 0.25], [n, n / 4], Diagonal::Right).unwrap(), steps);
            let state = last(&problem);
            // Simpson's rule of many points stands for the integral of the strain.
            let at = |i: usize| strain(time_at(&[i as f64 / 400.0, 0.0, 0.0]), problem.timeline.longest(), steps);
            let simpson = |i: usize| at(2 * i) + 4.0 * at(2 * i + 1) + at(2 * i + 2);
            let exact = (0..200).map(simpson).sum::<f64>() / 1200.0;
            let stresses = cell_values(&problem, &state);
            let stress = stresses.iter().map(|v| (v.stress.get(0, 0) - 0.1).abs()).fold(0.0, f64::max);
            [(largest(&state.u) / exact - 1.0).abs(), stress]
        });
        for (pair, which) in errors.windows(2).flat_map(|pair| [(pair, 0), (pair, 1)]) {
            let order = (pair[0][which] / pair[1][which]).log2();
            // The mean stress of Q1 is exact here.
            assert!(
                order > orders[which] - 0.25 || pair[1][which] < 1e-13,
                "{elements:?}: order {order} of {which}, {errors:?}"
            );
        }
    }
}

fn assert_same(found: &[f64], expected: &[f64], what: &str) {
    let scale = largest(expected);
    assert!(scale > 0.0, "{what}");
    let worst = found.iter().zip(expected).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
    assert!(worst <= 1e-10 * scale, "{what} differs by {:e} of itself", worst / scale);
}

/// A function that is the same everywhere is its number, beside a branch with a number, with contact, friction and
/// heat: the state, the energies, and the stress of cells and nodes.
#[test]
fn a_function_of_one_value_is_that_value() {
    let square = |elements| Mesh::rectangle_of(elements, [1.0, 1.0], [6, 6], Diagonal::Right).unwrap();
    let revolution = |elements| {
        let mut mesh = square(elements);
        mesh.points.iter_mut().for_each(|x| x[0] += 0.5);
        Mesh { axisymmetric: true, ..mesh }
    };
    let bodies = [
        (square(Elements::P1), Dilatation::Full),
        (square(Elements::Q1), Dilatation::Mean),
        (square(Elements::P2), Dilatation::Full),
        (square(Elements::P2), Dilatation::Mean),
        (revolution(Elements::P1), Dilatation::Full),
    ];
    for (number, (mesh, dilatation)) in bodies.into_iter().enumerate() {
        let with = |time: Coefficient<f64>| {
            changed(&paper(&["mesh.n=6", "time.steps=8", "time.end=0.5"]).problem, |data| {
                data.mesh = Arc::new(mesh.clone());
                let dim = data.mesh.tensor_dim();
                let law: Law<dyn TensorLaw> = Isotropic::elastic(dim, 2.0, 0.3, StressState::PlaneStrain).into();
                let pairs = [(1.5.into(), time), (0.5.into(), 0.2.into())];
                let material = &mut data.materials[0];
                material.dilatation = dilatation;
                material.prony = Some(
                    Prony::varying(&pairs.map(|(ratio, time)| (law.clone(), ratio, time)), &data.mesh.sites(None))
                        .unwrap(),
                );
                material.viscosity = Isotropic::lame(dim, 0.3, 0.5, StressState::PlaneStrain).into();
                material.elasticity = law;
                for tensor in [&mut material.expansion, &mut material.coupling, &mut material.conductivity] {
                    *tensor = Sym::identity(dim).into();
                }
            })
        };
        let (value, function) = (with(0.3.into()), with(Coefficient::varying(|_| 0.3)));
        assert!(value.relaxation_times().len() == 2 && function.varying_branches() == 1);
        let (expected, found) = (last(&value), last(&function));
        let what = |name: &str| format!("body {number}: {name}");
        assert_same(&found.u, &expected.u, &what("u"));
        assert_same(&found.w, &expected.w, &what("w"));
        assert_same(&found.theta, &expected.theta, &what("θ"));
        let energies = |state: &State| {
            [state.ledger.elastic, state.ledger.viscous_dissipation, state.ledger.scheme_dissipation].to_vec()
        };
        assert_same(&energies(&found), &energies(&expected), &what("energies"));
        assert!(found.ledger.relative_closing_error().abs() < 1e-12, "{}", what("identity"));
        let cells = |problem: &Problem, state: &State| -> Vec<f64> {
            cell_values(problem, state).iter().flat_map(|v| v.stress.0).collect()
        };
        if mesh.axisymmetric {
            // u_r/r is no polynomial: what is fitted to it is another strain.
            continue;
        }
        assert_same(&cells(&function, &found), &cells(&value, &expected), &what("σ of the cells"));
        let nodes = |problem: &Problem, state: &State| -> Vec<f64> {
            nodal_stress(problem, state).regions.concat().iter().flat_map(|(_, stress)| stress.0).collect()
        };
        assert_same(&nodes(&function, &found), &nodes(&value, &expected), &what("σ of the nodes"));
    }
}

/// What is not a time somewhere is refused.
#[test]
fn a_time_that_is_not_positive_somewhere_is_refused() {
    let law: Law<dyn TensorLaw> = Isotropic::elastic(2, 2.0, 0.3, StressState::PlaneStrain).into();
    let points = [[0.0; 3], [0.5, 0.0, 0.0], [1.0, 0.0, 0.0]];
    let with =
        |time: fn(&Point) -> f64| Prony::varying(&[(law.clone(), 1.0.into(), Coefficient::varying(time))], &points);
    assert!(with(|x| x[0] - 0.5).is_err() && with(|x| x[0] / x[0]).is_err());
    let prony = with(|x| 1.0 + x[0]).unwrap();
    assert_eq!((prony.branches()[0].times(), prony.at(&points[1]).branches()[0].time), ([1.0, 2.0], 1.5));
}

/// A body of K = 4 and a shear modulus of 0.5, with a branch of 1.5 that relaxes in 0.4 s, under these tractions.
fn block(mesh: &str, held: &[&str], loads: &str, steps: usize) -> String {
    // E = 9 K G/(3 K + G), ν = (3 K − 2 G)/(6 K + 2 G).
    let (bulk, shear) = (4.0, 0.5);
    let (young, poisson) =
        (9.0 * bulk * shear / (3.0 * bulk + shear), (3.0 * bulk - 2.0 * shear) / (6.0 * bulk + 2.0 * shear));
    let flat = if mesh.contains("rectangle") && !mesh.contains("axisymmetric") {
        ", stress_state = \"plane-strain\""
    } else {
        ""
    };
    let held: String =
        held.iter().map(|on| format!("[[boundary]]\non = \"{on}\"\nnormal_displacement = 0\n")).collect();
    format!(
        "name = \"creep\"\nunits = \"dimensionless\"\n[mesh]\n{mesh}\n[time]\nend = 1.0\nsteps = {steps}\n[material]\ndensity = 0\n\
         elasticity = {{ law = \"isotropic\", young = {young:?}, poisson = {poisson:?}{flat} }}\n\
         prony = [{{ ratio = 3, time = 0.4, deviatoric = true }}]\n{held}{loads}"
    )
}

fn parsed(text: &str) -> Problem {
    cases::parse(&Source::new("creep.toml", text), &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).problem
}

const BOX: (&str, [&str; 3]) =
    ("kind = \"box\"\nsize = [1.0, 2.0, 1.5]\nn = [1, 2, 1]\nelements = \"Q1\"", ["left", "bottom", "back"]);
const DISC: (&str, [&str; 1]) =
    ("kind = \"rectangle\"\naxisymmetric = true\nsize = [1.0, 2.0]\nn = [2, 2]\nelements = \"Q1\"", ["bottom"]);
const STRIP: (&str, [&str; 2]) =
    ("kind = \"rectangle\"\nsize = [1.0, 2.0]\nn = [2, 2]\nelements = \"Q1\"", ["left", "bottom"]);

/// A deviatoric branch creeps in shear and not in volume: under a tension σ the strain along it is σ/(9K) + σ J(t)/3,
/// J = 1/G∞ − (1/G∞ − 1/G₀) exp(−t G∞/(τ G₀)), of first order in k; in plane strain with σ/(9K)·… of ε₃₃ = 0.
#[test]
fn a_deviatoric_branch_creeps_in_shear() {
    let (bulk, long, short, time, sigma) = (4.0, 0.5, 2.0, 0.4, 0.2);
    let creep = 1.0 / long - (1.0 / long - 1.0 / short) * f64::exp(-long / (time * short));
    let exact = 2.0 * sigma * (1.0 / (9.0 * bulk) + creep / 3.0);
    let loads = format!("[[boundary]]\non = \"top\"\npressure = {:?}\n", -sigma);
    for (mesh, held) in [(BOX.0, &BOX.1[..]), (DISC.0, &DISC.1)] {
        let errors = [32, 64, 128].map(|steps| {
            let problem = parsed(&block(mesh, held, &loads, steps));
            let state = last(&problem);
            assert!(state.ledger.relative_closing_error().abs() < 1e-11);
            let node = problem.mesh.facets["top"].node_list()[0] as usize;
            (state.u[node * problem.mesh.dim + 1] - exact).abs()
        });
        for pair in errors.windows(2) {
            assert!(((pair[0] / pair[1]).log2() - 1.0).abs() < 0.1, "{errors:?}");
        }
        assert!(errors[2] < 5e-3 * exact, "{errors:?}");
    }
}

/// Under the same pressure on all sides nothing creeps: ε = −p/(3K) at once and for ever. In plane strain a tension
/// strains as the instantaneous and the long-term moduli say at the start and the end.
#[test]
fn a_deviatoric_branch_bears_pressure_without_creep() {
    let all = |sides: &[&str]| -> String {
        sides.iter().map(|on| format!("[[boundary]]\non = \"{on}\"\npressure = 0.3\n")).collect()
    };
    for (mesh, held, loads) in
        [(BOX.0, &BOX.1[..], all(&["right", "top", "front"])), (DISC.0, &DISC.1, all(&["right", "top"]))]
    {
        let problem = parsed(&block(mesh, held, &loads, 6));
        let memory = solve(&problem);
        let node = problem.mesh.facets["top"].node_list()[0] as usize;
        for state in memory.states.iter().skip(1) {
            let u = state.u[node * problem.mesh.dim + 1];
            assert!((u + 2.0 * 0.3 / 12.0).abs() < 1e-13, "{u}");
        }
    }
    // Plane strain: u_y of a tension by E/(1 − ν²) of K and G at once and in the end.
    let strained = |shear: f64| {
        let (young, poisson) = (36.0 * shear / (12.0 + shear), (12.0 - 2.0 * shear) / (24.0 + 2.0 * shear));
        2.0 * 0.2 * (1.0 - poisson * poisson) / young
    };
    let loads = "[[boundary]]\non = \"top\"\npressure = -0.2\n";
    let text = block(STRIP.0, &STRIP.1, loads, 1);
    for (end, shear) in [("1e-9", 2.0), ("1e9", 0.5)] {
        let problem = parsed(&text.replace("end = 1.0", &format!("end = {end}")));
        let node = problem.mesh.facets["top"].node_list()[0] as usize;
        let u = last(&problem).u[node * 2 + 1];
        assert!((u / strained(shear) - 1.0).abs() < 1e-7, "{u}, expected {}", strained(shear));
    }
}

/// Where a branch cannot act on deviators alone, that is said.
#[test]
fn faults_of_deviatoric_branches_are_named() {
    let text = block(STRIP.0, &STRIP.1, "", 1);
    for (old, new, expected) in [
        ("plane-strain", "plane-stress", "material.prony[0].deviatoric: found a deviatoric branch in plane stress"),
        ("deviatoric = true", "deviatoric = 1", "material.prony[0].deviatoric: found 1, expected true or false"),
        (
            "kind = \"rectangle\"\nsize = [1.0, 2.0]\nn = [2, 2]\nelements = \"Q1\"",
            "kind = \"interval\"\nsize = 1.0\nn = 2",
            "material.prony[0].deviatoric: found a deviatoric branch on a line",
        ),
    ] {
        let said = told(&Source::new("case.toml", text.replace(old, new)), &[]);
        assert!(said.contains(expected), "{said}");
    }
}
