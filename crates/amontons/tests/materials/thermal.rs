//! Coefficients that depend on the temperature: against numbers, regions, an independent rod, differences and
//! identities.

use std::sync::Arc;

use crate::common::{Random, case as shipped, changed, largest, paper};
use amontons::case::{self, Source};
use amontons::contract;
use amontons::equation::StepError;
use amontons::field::{Coefficient, Law, TemperatureTable};
use amontons::hypotheses::{FindingId, FindingStatus, certificate};
use amontons::linalg::BlockMatrix;
use amontons::material::{Isotropic, StressState, TensorLaw};
use amontons::mesh::{Block, Mesh};
use amontons::output::{Memory, cell_values};
use amontons::problem::Problem;
use amontons::run::{self, Settings};
use amontons::state::State;
use amontons::step::{March, Scheme};
use amontons::tensor::{Point, Sym};
use amontons::time::Rule;

const THERMAL: &str = "crates/amontons/benchmarks/manufactured-thermal.toml";
const COUPLINGS: [&str; 3] = ["staggered", "fixed-point", "monolithic"];

fn solve(problem: &Problem) -> (State, Memory) {
    let mut memory = Memory::new().states_every(1).reports();
    run::run(problem, &Settings::default(), &mut [&mut memory]).unwrap_or_else(|error| panic!("{error}"));
    (memory.states.last().expect("states").clone(), memory)
}

/// The manufactured case, coarse.
fn manufactured(coupling: &str) -> Problem {
    let overrides = ["mesh.n=6".to_owned(), "time.steps=8".to_owned(), format!("scheme.coupling=\"{coupling}\"")];
    shipped(THERMAL, &overrides).problem
}

/// Largest relative difference of the fields of two states.
fn distance(a: &State, b: &State) -> f64 {
    let relative =
        |a: &[f64], b: &[f64]| largest(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>()) / largest(b);
    relative(&a.u, &b.u).max(relative(&a.w, &b.w)).max(relative(&a.theta, &b.theta))
}

/// A free plate, block or cylinder of nearly incompressible material whose temperature is linear in space is free of
/// stress (in its plane in plane strain) and grows by α θ at each place, by (1 + ν) α θ in plane strain: thermal stress
/// works on the mean dilatation as elastic stress does. Not so, a plate grew 700 times as much.
#[test]
fn a_hot_plate_of_mean_dilatation_is_free_of_stress() {
    let table = "{ temperature = [-9, 9], value = [1e-3, 1e-3] }";
    for (shape, growth, most) in [("plate", 1.4999, 0.01), ("cylinder", 1.0, 0.01), ("block", 1.0, 0.02)] {
        for elements in ["Q1", "Q2"] {
            for (expansion, coupling) in [("1e-3", "monolithic"), (table, "monolithic"), ("1e-3", "fixed-point")] {
                let problem = case::parse(&Source::new("hot.toml", hot(shape, elements, expansion, coupling)), &[]);
                let problem = problem.unwrap_or_else(|error| panic!("{error}")).problem;
                let (state, _) = solve(&problem);
                let (mesh, name) = (&problem.mesh, format!("{shape} {elements} {expansion} {coupling}"));
                let u = |x: [f64; 3]| {
                    let is_at = |p: &Point| (0..3).all(|c| (p[c] - x[c]).abs() < 1e-9);
                    let node = mesh.points.iter().position(is_at).expect("a node");
                    let at = mesh.dim * node;
                    [state.u[at], state.u[at + 1]]
                };
                // Across the hot side, along which the temperature is the same.
                let grown = match shape {
                    "cylinder" => u([1.0, 1.0, 0.0])[0],
                    _ => u([1.0, 1.0, 0.0])[1] - u([1.0, 0.0, 0.0])[1],
                };
                assert!((grown / (growth * 1e-3) - 1.0).abs() < most, "{name}: {grown:e}");
                let values = cell_values(&problem, &state);
                let largest = values.iter().map(|cell| {
                    let [xx, yy] = [cell.stress.get(0, 0), cell.stress.get(1, 1)];
                    xx.abs().max(yy.abs())
                });
                // E α.
                let largest = largest.fold(0.0, f64::max);
                assert!(largest < 0.03e-3, "{name}: {largest:e}");
            }
        }
    }
}

fn hot(shape: &str, elements: &str, expansion: &str, coupling: &str) -> String {
    let (mesh, sides, held) = match shape {
        "plate" => (
            "kind = \"rectangle\"\nsize = [1.0, 1.0]\nn = [8, 8]",
            ["left", "right"],
            "[[boundary]]\nat = [0, 0]\ndisplacement = [0, 0]\n[[boundary]]\nat = [1, 0]\ndisplacement = [\"free\", 0]\n",
        ),
        "cylinder" => (
            "kind = \"rectangle\"\naxisymmetric = true\nsize = [1.0, 1.0]\nn = [8, 8]",
            ["bottom", "top"],
            "[[boundary]]\nat = [0, 0]\ndisplacement = [0, 0]\n",
        ),
        _ => (
            "kind = \"box\"\nsize = [1.0, 1.0, 1.0]\nn = [4, 4, 4]",
            ["left", "right"],
            "[[boundary]]\nat = [0, 0, 0]\ndisplacement = [0, 0, 0]\n[[boundary]]\nat = [1, 0, 0]\n\
             displacement = [\"free\", 0, 0]\n[[boundary]]\nat = [0, 1, 0]\ndisplacement = [\"free\", \"free\", 0]\n",
        ),
    };
    let state = if shape == "plate" { ", stress_state = \"plane-strain\"" } else { "" };
    format!(
        "name = \"hot\"\nunits = \"dimensionless\"\n[mesh]\n{mesh}\nelements = \"{elements}\"\n\
         [time]\nend = 1.0\nsteps = 1\n[scheme]\ncoupling = \"{coupling}\"\n[material]\ndensity = 0\n\
         elasticity = {{ law = \"isotropic\", young = 1.0, poisson = 0.4999{state} }}\ndilatation = \"mean\"\n\
         expansion_coefficient = {expansion}\nheat_capacity = 0\nconductivity = 1.0\n\
         [[boundary]]\non = \"{}\"\ntemperature = 0\n[[boundary]]\non = \"{}\"\ntemperature = 1\n{held}",
        sides[0], sides[1]
    )
}

/// Tables whose values are the same at all temperatures are numbers, in all couplings.
#[test]
fn flat_tables_are_numbers() {
    for coupling in COUPLINGS {
        let coupling = format!("scheme.coupling=\"{coupling}\"");
        let set: Vec<&str> = vec!["mesh.n=6", "time.steps=6", "contact.heat.foundation_temperature=10", &coupling];
        let numbers = paper(&set).problem;
        let table = |value: &str| format!("{{ temperature = [-100, 7, 100], value = [{value}, {value}, {value}] }}");
        let one = table("1.0");
        let tables = [
            format!("material.heat_capacity={one}"),
            format!("material.conductivity={one}"),
            format!("material.expansion=[[{one}, {one}], [{one}, {one}]]"),
            format!("material.elasticity.young={}", table("2.0")),
            format!("material.viscosity.second={}", table("10.0")),
        ];
        let all: Vec<&str> = set.into_iter().chain(tables.iter().map(String::as_str)).collect();
        let (found, expected) = (solve(&paper(&all).problem).0, solve(&numbers).0);
        assert!(distance(&found, &expected) < 1e-10, "{coupling}: {:e}", distance(&found, &expected));
        let (found, expected) = (found.ledger, expected.ledger);
        assert!((found.heat_content / expected.heat_content - 1.0).abs() < 1e-10);
        assert!((found.elastic / expected.elastic - 1.0).abs() < 1e-9 && found.modulus_work.abs() < 1e-12);
    }
}

/// All coefficients of the body, contact, friction and heat: both identities close to round-off, moduli do work, and
/// the energy of each row is that of the fields at its time.
#[test]
fn identities_close_in_all_couplings() {
    for coupling in COUPLINGS {
        let problem = manufactured(coupling);
        let (_, memory) = solve(&problem);
        let scheme = March::new(&problem).expect("a system");
        for state in &memory.states[1..] {
            let (energy, heat) = (state.ledger.relative_closing_error(), state.ledger.relative_heat_closing_error());
            assert!(energy.abs() < 1e-12 && heat.abs() < 1e-12, "{coupling}: {energy:e} {heat:e}");
            let stored = scheme.discretization().stored_energy(&state.u, &state.theta).expect("a potential");
            assert!((stored - state.ledger.elastic).abs() <= 1e-13 * state.ledger.turned_over, "{coupling}");
        }
        let last = &memory.states.last().expect("states").ledger;
        assert!(last.modulus_work.abs() > 1e-4 * last.turned_over, "{coupling}: {:e}", last.modulus_work);
    }
}

/// The limit of the fixed point is the monolithic step, which needs fewer passes: its tangent is exact.
#[test]
fn the_monolithic_step_is_the_limit_of_the_fixed_point() {
    let (fixed, by_passes) = solve(&manufactured("fixed-point"));
    let (monolithic, by_newton) = solve(&manufactured("monolithic"));
    assert!(distance(&fixed, &monolithic) < 1e-9, "{:e}", distance(&fixed, &monolithic));
    let most = |memory: &Memory| memory.reports.iter().map(|report| report.coupling.passes).max().expect("reports");
    assert!(most(&by_newton) < most(&by_passes), "{} and {}", most(&by_newton), most(&by_passes));
}

/// The difference quotients of the forms against their derivatives, at random fields.
#[test]
fn derivatives_are_those_of_the_forms() {
    let problem = manufactured("staggered");
    let scheme = March::new(&problem).expect("a system");
    let discrete = scheme.discretization();
    let mut random = Random(0x1234_5678_9abc_def1);
    let mut field = |size: usize| (0..size).map(|_| 0.5 * random.number()).collect::<Vec<f64>>();
    let nodes = problem.mesh.points.len();
    let (u, w, theta, change) = (field(2 * nodes), field(2 * nodes), field(nodes), field(nodes));
    let at = |h: f64| theta.iter().zip(&change).map(|(theta, change)| theta + h * change).collect::<Vec<f64>>();
    let difference = |form: &dyn Fn(&[f64]) -> Vec<f64>| -> Vec<f64> {
        let h = 1e-5;
        form(&at(h)).iter().zip(form(&at(-h))).map(|(plus, minus)| (plus - minus) / (2.0 * h)).collect()
    };
    let close = |found: &[f64], expected: &[f64], what: &str| {
        let error = largest(&found.iter().zip(expected).map(|(a, b)| a - b).collect::<Vec<_>>()) / largest(expected);
        assert!(error < 1e-8, "{what}: {error:e}");
    };
    let rule = Rule::backward_euler(0.1);
    let heat = |theta: &[f64]| -> Vec<f64> {
        discrete.stored_heat(theta).iter().zip(discrete.apply_d(theta)).map(|(h, d)| h / rule.delta + d).collect()
    };
    let mut tangent: BlockMatrix = discrete.thermal_tangent(rule, &theta);
    tangent.add_scaled(1.0, &discrete.thermal_slope(&theta).expect("a slope"));
    close(&tangent.apply(&change), &difference(&heat), "heat");
    let force = |theta: &[f64]| -> Vec<f64> {
        let [a, b] = [discrete.apply_a(&u, theta), discrete.apply_b(&w, theta)];
        discrete.thermal_force(theta).iter().zip(a).zip(b).map(|((m, a), b)| m - a - b).collect()
    };
    let slope = discrete.mechanical_slope(&u, &w, &theta).expect("a slope");
    close(&slope.apply(&change), &difference(&force), "mechanics");
}

const ROD: &str = r#"
name = "rod"
[mesh]
kind = "interval"
size = 1.0
n = 5
[time]
end = 0.3
steps = 3
[material]
heat_capacity = { temperature = [-1, 4], value = [0.5, 3] }
conductivity = { temperature = [-1, 4], value = [0.2, 5.2] }
[load]
heat_source = 2.0
[[boundary]]
on = "left"
temperature = "5*t"
[initial]
temperature = "x"
"#;

/// A rod with c = 1 + θ/2 and k = 1.2 + θ by a dense Newton iteration with difference quotients, written here: H(θ) = θ
/// + θ²/4 by Simpson's rule, which is exact, and k at the middles of the cells, as linear elements have it.
#[test]
fn a_rod_is_that_of_an_independent_program() {
    let problem = case::parse(&Source::new("rod.toml", ROD), &[]).expect("a case").problem;
    let (last, _) = solve(&problem);
    let (n, h, k) = (5, 0.2, 0.1);
    let residual = |new: &[f64], old: &[f64]| -> Vec<f64> {
        let mut r = vec![0.0; n + 1];
        for cell in 0..n {
            let heat = |theta: &[f64], share: f64| {
                let at = (1.0 - share) * theta[cell] + share * theta[cell + 1];
                at + 0.25 * at * at
            };
            let rate = |share: f64| (heat(new, share) - heat(old, share)) / k - 2.0;
            let flux = (1.2 + 0.5 * (new[cell] + new[cell + 1])) * (new[cell + 1] - new[cell]) / h;
            r[cell] += h / 6.0 * (rate(0.0) + 2.0 * rate(0.5)) - flux;
            r[cell + 1] += h / 6.0 * (2.0 * rate(0.5) + rate(1.0)) + flux;
        }
        r
    };
    let mut old: Vec<f64> = (0..=n).map(|i| h * i as f64).collect();
    for step in 1..=3 {
        let mut new = old.clone();
        new[0] = 0.5 * f64::from(step);
        for _ in 0..20 {
            let r = residual(&new, &old);
            let mut matrix: Vec<Vec<f64>> = vec![vec![0.0; n + 1]; n];
            for column in 1..=n {
                let mut moved = new.clone();
                moved[column] += 1e-6;
                let plus = residual(&moved, &old);
                moved[column] -= 2e-6;
                let minus = residual(&moved, &old);
                (1..=n).for_each(|row| matrix[row - 1][column - 1] = (plus[row] - minus[row]) / 2e-6);
            }
            (1..=n).for_each(|row| matrix[row - 1][n] = -r[row]);
            for (i, change) in eliminated(matrix).into_iter().enumerate() {
                new[i + 1] += change;
            }
        }
        old = new;
    }
    let error = largest(&last.theta.iter().zip(&old).map(|(a, b)| a - b).collect::<Vec<_>>());
    assert!(error < 1e-11, "{error:e}: {:?} {old:?}", last.theta);
}

/// Gauss's elimination of a small system, the right-hand side in the last column.
fn eliminated(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
    let n = rows.len();
    for i in 0..n {
        let pivot = rows[i].clone();
        for (j, row) in rows.iter_mut().enumerate() {
            if j != i {
                let factor = row[i] / pivot[i];
                row.iter_mut().zip(&pivot).for_each(|(entry, p)| *entry -= factor * p);
            }
        }
    }
    (0..n).map(|i| rows[i][n] / rows[i][i]).collect()
}

/// Two regions with tables of their own, and one material with the same tables as closures of the position.
#[test]
fn regions_are_what_closures_are() {
    let halves = |mesh: &Mesh| {
        let mut blocks: Vec<Block> = Vec::new();
        for block in &mesh.blocks {
            for (region, is_left) in [(0, true), (1, false)] {
                let left = |cell: &[u32]| cell.iter().all(|&node| mesh.points[node as usize][0] < 0.5 + 1e-12);
                let nodes = block.cells().filter(|cell| left(cell) == is_left).flatten().copied().collect();
                blocks.push(Block { region, nodes, ..block.clone() });
            }
        }
        Mesh { blocks, regions: vec!["left".to_owned(), "right".to_owned()], ..mesh.clone() }
    };
    let problem = paper(&["mesh.n=4", "time.steps=4", "contact.heat.foundation_temperature=10"]).problem;
    let mesh = Arc::new(halves(&problem.mesh));
    let knots = [-20.0, 40.0];
    let soft = |theta: f64, factor: f64| factor * (2.0 - 0.03 * theta);
    let young = move |theta: f64, factor: f64| -> Arc<dyn TensorLaw> {
        Arc::new(Isotropic::elastic(2, soft(theta, factor), 0.1, StressState::PlaneStress))
    };
    let identity = move |theta: f64, factor: f64| soft(theta, factor) * Sym::identity(2);
    let points = mesh.sites(None);
    let of = |factor: fn(&Point) -> f64| {
        let mut material = problem.materials[0].clone();
        let law = Law::varying(&points, &[0.0], &knots, move |x, _, theta| young(theta, factor(x)));
        contract::assert_tensor_law(law.as_ref(), 2, 1.0);
        material.elasticity = law;
        material.expansion = Coefficient::of_temperature(&knots, move |x, theta| identity(theta, factor(x)));
        material.conductivity = Coefficient::of_temperature(&knots, move |x, theta| identity(theta, factor(x)));
        material.heat_capacity = Coefficient::of_temperature(&knots, move |x, theta| soft(theta, factor(x)));
        material
    };
    let regions = changed(&problem, |data| {
        (data.mesh, data.materials) = (Arc::clone(&mesh), vec![of(|_| 1.0), of(|_| 1.7)]);
    });
    let whole = changed(&problem, |data| {
        (data.mesh, data.materials) = (Arc::clone(&mesh), vec![of(|x| if x[0] > 0.5 { 1.7 } else { 1.0 })]);
    });
    let (found, expected) = (solve(&whole).0, solve(&regions).0);
    assert!(distance(&found, &expected) < 1e-10, "{:e}", distance(&found, &expected));
}

/// The enthalpy of a closure is its integral: Gauss's rule is exact for polynomials, a table's trapezia likewise.
#[test]
fn enthalpies_are_integrals() {
    let cubic = Coefficient::of_temperature(&[-1.0, 0.5, 2.0], |_, theta| 1.0 + theta.powi(3));
    for theta in [-0.7f64, 0.0, 0.3, 1.9] {
        let expected = theta + theta.powi(4) / 4.0;
        assert!((cubic.integral(&[0.0; 3], theta) - expected).abs() < 1e-14, "{theta}");
    }
    // Beyond its temperatures it keeps its value: ∫₀² and 9 more per kelvin.
    assert!((cubic.integral(&[0.0; 3], 3.0) - (2.0 + 4.0 + 9.0)).abs() < 1e-13);
    let table = TemperatureTable::new(vec![0.0, 2.0], vec![1.0, 5.0]).expect("a table");
    assert!((table.integral(&[0.0; 3], 1.0) - 2.0).abs() < 1e-15);
}

/// The step at which a body leaves its table is named, with the temperature and the place; nothing is extrapolated.
#[test]
fn a_table_that_does_not_cover_a_step_ends_the_run() {
    let case = ROD.replace("n = 5", "n = 1").replace("[[boundary]]\non = \"left\"\ntemperature = \"5*t\"\n", "");
    let case = case.replace("temperature = \"x\"", "temperature = 3.5").replace("end = 0.3", "end = 6.0");
    let problem = case::parse(&Source::new("rod.toml", &case), &[]).expect("a case").problem;
    let mut scheme = March::new(&problem).expect("a system");
    let state = scheme.initial().expect("a state");
    // θ + θ²/4 grows by 4 per step, from 6.5625 to 10.5625. It is 8 at the end of the table, where c = 3.
    match scheme.step(&state) {
        Err(StepError::Uncovered { step: 1, found, .. }) => {
            assert_eq!((found.key.as_str(), found.range), ("material.conductivity", [-1.0, 4.0]));
            assert!((found.theta - (4.0 + 2.5625 / 3.0)).abs() < 1e-10, "{found:?}");
        }
        other => panic!("{other:?}"),
    }
}

/// The certificate says of which data the hypotheses do not speak, with bounds over the table.
#[test]
fn the_certificate_has_bounds_over_the_temperatures() {
    let table = |value: &str| format!("{{ temperature = [0, 50], value = [{value}] }}");
    let set = [
        "mesh.n=4".to_owned(),
        format!("material.elasticity.young={}", table("2.0, 0.5")),
        format!("material.conductivity={}", table("1.0, 3.0")),
    ];
    let certificate = certificate(&paper(&set.each_ref().map(String::as_str)).problem).expect("a certificate");
    let find = |id: FindingId| certificate.findings.iter().find(|finding| finding.id == id).expect("a finding");
    // m_a = E/(1 + ν) in plane stress; the least is that of θ = 50.
    assert!((certificate.constants.m_a - 0.5 / 1.1).abs() < 1e-14);
    assert!((certificate.constants.m_d - 1.0).abs() < 1e-14 && (certificate.constants.bound_d - 3.0).abs() < 1e-14);
    for id in [FindingId::H2, FindingId::H3, FindingId::Needed] {
        assert_eq!(find(id).status, FindingStatus::NotCovered, "{}", find(id).message);
    }
    assert_eq!([FindingId::H1, FindingId::H4].map(|id| find(id).status), [FindingStatus::Holds; 2]);
    assert!(
        find(FindingId::H2).message.ends_with(
            "it depends on the temperature, which (H2) does not admit: these are bounds for θ from 0.0 to 50.0"
        ),
        "{}",
        find(FindingId::H2).message
    );
}
