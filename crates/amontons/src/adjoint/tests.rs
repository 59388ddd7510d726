//! Jᵀ of the half-steps is the transposed of J.

use super::at_solution;
use super::bordered::jump;
use super::driven::{DrivenStep, Shifted};
use super::factors::StepFactors;
use super::history::{RunHistory, started};
use super::instance::{PhasedInstance, SolvedStep, at_level, data, global};
use super::points::{LinearPoint, linearised};
use super::sweep::{Around, LinearStep};
use super::tangent::ResidualSlope;
use super::transpose::Transposed;
use super::vector::StateVector;
use crate::case::{self, Source};
use crate::equation::system::Step;
use crate::inclusion::Local;
use crate::linalg::dot;
use crate::state::State;

/// Numbers in (−1, 1) that look random.
fn numbers(count: usize, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    (0..count).map(|_| next()).collect()
}

fn locals(count: usize, seed: u64) -> Vec<Local> {
    numbers(3 * count, seed).chunks_exact(3).map(|v| [v[0], v[1], v[2]]).collect()
}

/// J (v, f): K v + Σ ω Nᵀ f, and G_v N v + G_f f at each point.
fn forward(step: &Step, points: &[LinearPoint], v: &[f64], f: &[Local]) -> (Vec<f64>, Vec<Local>) {
    let mut rows = step.discrete.mechanical_matrix(step.rule).apply(v);
    let forces = points.iter().zip(f).map(|(point, f)| global(&point.basis, f));
    step.boundary.scatter(step.discrete.v.components, forces, &mut rows);
    let of = |(i, (point, f)): (usize, (&LinearPoint, &Local))| -> Local {
        let (seen, by_v, by_f) = (jump(step, i, point, v), point.by_velocity(), point.by_force());
        std::array::from_fn(|a| (0..3).map(|b| by_v[a][b] * seen[b] + by_f[a][b] * f[b]).sum())
    };
    (rows, points.iter().zip(f).enumerate().map(of).collect())
}

/// ⟨J v, y⟩ = ⟨v, Jᵀ y⟩ with points that are open, stick and slip.
#[test]
fn the_transposed_step_is_the_transposed_of_the_step() {
    let text = include_str!("../../tests/reference/gradients/block-stick-slip.toml");
    let case = case::parse(&Source::new("block", text), &[]).expect("a case");
    let phased = PhasedInstance::new(&case.problem);
    let mut history = RunHistory::new(&phased, usize::MAX, &|| true).expect("a run");
    let base = &phased.first;
    for n in [3, 9, 13, 20] {
        let [old, new] = history.around(n).expect("a step");
        let mut factors = StepFactors::new(base, (n, &old.state, &new.state)).expect("factors");
        let (chosen, unknown) = (factors.chosen(base, n, [&old.state, &new.state]), factors.on_contact());
        let (old, states, flux, new) = (&old.state, &new.states, &new.flux, &new.state);
        let solved = SolvedStep { n, old, new, at: new, states, flux, chosen: &chosen, unknown: &unknown };
        let points = linearised(base, &solved, None).expect("points");
        let (right, force) = (numbers(new.w.len(), 7 + n as u64), locals(points.len(), 11 + n as u64));
        let found = factors.mechanics(base, &solved, &points, (&right, &force)).expect("a solution");
        let (mut v, f) = (numbers(new.w.len(), 13 + n as u64), locals(points.len(), 17 + n as u64));
        base.discrete.v.mask(&mut v);
        base.step(n, old, |step| {
            assert_eq!(data(step, new).frames.len(), points.len());
            let (rows, at_points) = forward(step, &points, &v, &f);
            let areas: Vec<f64> = step.boundary.points.iter().map(|point| point.weight).collect();
            let weighted = |a: &[Local], b: &[Local]| -> f64 {
                (0..areas.len()).map(|i| areas[i] * (0..3).map(|c| a[i][c] * b[i][c]).sum::<f64>()).sum()
            };
            let sizes = |values: &[f64]| values.iter().map(|value| value.abs()).sum::<f64>();
            let left = dot(&rows, &found.y) + weighted(&at_points, &found.points);
            let expected = dot(&v, &right) + weighted(&f, &force);
            let scale = sizes(&right) + weighted(&at_points, &found.points).abs() + dot(&rows, &found.y).abs();
            assert!((left - expected).abs() <= 1e-12 * scale, "step {n}: {left:e}, expected {expected:e}");
            assert!(found.y.iter().zip(&base.discrete.v.free).all(|(y, free)| *free || *y == 0.0));
        });
    }
}

/// A state's vector that looks random.
fn random_vector(like: &State, seed: u64) -> StateVector {
    StateVector {
        u: numbers(like.u.len(), seed),
        w: numbers(like.w.len(), seed + 1),
        theta: numbers(like.theta.len(), seed + 2),
        theta_rate: numbers(like.theta_rate.len(), seed + 99),
        branches: like.branches.iter().zip(3..).map(|(branch, i)| numbers(branch.len(), seed + i)).collect(),
        wear: numbers(like.surface.wear.len(), seed + 100),
        work: numbers(like.surface.friction_work.len(), seed + 101),
        advance: numbers(like.surface.advance.len(), seed + 102),
        advance_rate: numbers(like.surface.advance_rate.len(), seed + 103),
        depths: like.surface.worn.depths.iter().zip(300..).map(|(of, i)| numbers(of.len(), seed + i)).collect(),
        foundation: like
            .surface
            .foundation
            .iter()
            .zip(numbers(99, seed + 104))
            .map(|(f, n)| f.map_or(0.0, |_| n))
            .collect(),
    }
}

/// The products of two vectors: their sum, and that of their absolute values.
fn products(a: &StateVector, b: &StateVector) -> [f64; 2] {
    let all = |v: &StateVector| -> Vec<f64> { v.lists().flatten().copied().collect() };
    let (a, b) = (all(a), all(b));
    [dot(&a, &b), a.iter().zip(&b).map(|(a, b)| (a * b).abs()).sum()]
}

/// Numbers that depend on the temperature.
const TABLES: [(&str, &str); 4] = [
    ("heat_capacity = 2.0", "heat_capacity = { temperature = [-10.0, 20.0], value = [1.0, 4.0] }"),
    ("expansion = 0.4", "expansion = { temperature = [-10.0, 20.0], value = [0.2, 0.8] }"),
    ("conductivity = 0.8", "conductivity = { temperature = [-10.0, 20.0], value = [0.3, 1.8] }"),
    ("prony = [{ ratio = 0.3, time = 0.4 }]\n", ""),
];

const SIGNORINI: &str = "{ law = \"signorini\" }";
const LAYER: &str = "{ law = \"compliance\", stiffness = 900.0 }";

/// Cases with foundations that warm, obstacles under a load, tightened sections and wear of pairs, made from a warm
/// block on a foundation, one that is pressed on an obstacle, and warm pairs.
fn of_contact([warm, block, pair, tables]: [&str; 4]) -> Vec<(&'static str, String)> {
    let contact = |text: &str, more: &str| text.replacen("[contact]\n", &format!("[contact]\n{more}\n"), 1);
    let warming = contact(warm, "foundation = { heat_capacity = 0.2, exchange = 0.3, surroundings = 2.0 }");
    let obstacle = "obstacle = { shape = \"sphere\", center = [1.1, -4.0], radius = 4.0, load = { force = 0.3, \
                    direction = [0.2, 1], mass = 2.0 } }";
    let pressed = contact(block, obstacle);
    let light = contact(&warming.replace("gap = -0.002\n", ""), &obstacle.replace(", mass = 2.0", ""));
    let worn = |text: &str| contact(text, "wear = { law = \"archard\", coefficient = 0.02, fraction = 0.3 }");
    let tightened = pair.replace(SIGNORINI, "{ law = \"bilateral\" }");
    let friction = "{ law = \"coulomb\", coefficient = 0.3 }";
    let tightened =
        contact(&tightened.replace(friction, "{ law = \"stick\" }"), "preload = { force = 0.4, until = 0.6 }");
    vec![
        ("warming", warming.clone()),
        ("warming at once", at_once(&warming)),
        ("warming theta", with(&warming, "\"theta\"\ntheta = 0.6")),
        ("warming bdf2", with(&warming, "\"bdf2\"")),
        ("pressed", pressed.clone()),
        ("pressed on a layer", pressed.replace(SIGNORINI, LAYER)),
        ("pressed at once", at_once(&light)),
        ("tightened", tightened),
        ("worn", worn(pair)),
        ("worn at once", at_once(&worn(tables))),
    ]
}

/// A text with a scheme in time.
fn with(text: &str, scheme: &str) -> String {
    text.replace("[time]", &format!("[time]\nscheme = {scheme}"))
}

/// A text whose half-steps hold at once.
fn at_once(text: &str) -> String {
    format!("{text}\n[scheme]\ncoupling = \"monolithic\"\n")
}

/// Cases with heat, wear, stress relaxation and both sides of a pair, in all schemes.
fn cases() -> Vec<(&'static str, String)> {
    let pair = include_str!("../../tests/reference/gradients/pair.toml");
    let warm = include_str!("../../tests/reference/gradients/thermal-pressure.toml");
    let wear = include_str!("../../tests/reference/gradients/wear.toml");
    let block = include_str!("../../tests/reference/gradients/block-stick-slip.toml");
    let warm_pair = pair
        .replace(
            "density = 1.0",
            "density = 1.0\nheat_capacity = 2.0\nexpansion = 0.4\ncoupling = 0.3\nconductivity = 0.8",
        )
        .replace(
            "gap = 0.0007",
            "gap = 0.0007\nfrictional_heat = 0.6\nheat = { law = \"pressure\", coefficient = 0.6 }",
        )
        .replace("viscosity = {", "prony = [{ ratio = 0.3, time = 0.4 }]\nviscosity = {")
        .replace("displacement = [0, 0]", "displacement = [0, 0]\ntemperature = 1.0");
    let tables = TABLES.iter().fold(warm_pair.clone(), |text, (from, to)| text.replace(from, to));
    let theta = "\"theta\"\ntheta = 0.6";
    let mut cases = of_contact([warm, block, &warm_pair, &tables]);
    cases.extend([
        ("heat", warm.to_owned()),
        ("wear", wear.to_owned()),
        ("theta", with(warm, theta)),
        ("bdf2", with(&warm_pair, "\"bdf2\"")),
        ("coupled", at_once(&tables)),
        ("ahead", with(&tables, theta) + "\n[scheme]\ncoupling = \"extrapolated\"\n"),
        ("warm theta", at_once(&with(&tables, theta))),
        ("warm bdf2", with(&tables, "\"bdf2\"")),
        ("pair", warm_pair),
    ]);
    cases
}

/// ⟨L v, w⟩ = ⟨v, Lᵀ w⟩ with L the derivative of the state at the end of a step by that at its start, with heat, wear,
/// stress relaxation and both sides of a pair.
#[test]
fn a_step_backward_is_the_transposed_of_a_step_forward() {
    for (name, text) in cases() {
        let case = case::parse(&Source::new(name, &*text), &[]).unwrap_or_else(|error| panic!("{error}"));
        let phased = PhasedInstance::new(&case.problem);
        let base = &phased.first;
        let mut history = RunHistory::new(&phased, usize::MAX, &|| true).expect("a run");
        for n in [2, history.steps / 2, history.steps] {
            let [old, new] = history.around(n).expect("a step");
            let (start, states, flux, new) = (old.state.clone(), &new.states, &new.flux, &new.state);
            let old = &*started(&start, new, phased.start(n));
            let at = &*at_level(&base.rule(n, old), old, new);
            let mut factors = StepFactors::new(base, (n, old, at)).expect("factors");
            let (chosen, unknown) = (factors.chosen(base, n, [old, at]), factors.on_contact());
            let solved = SolvedStep { n, old, new, at, states, flux, chosen: &chosen, unknown: &unknown };
            let (points, forces, here) = at_solution(base, &solved, None).expect("points");
            let around = Around { h: 1.0, all: [&here; 5] };
            let (slope, kink) = ResidualSlope::of(&around, &base.discrete, &points).expect("one branch");
            assert!(kink.is_none() && !forces.is_empty());
            let forth = &DrivenStep::<Shifted>::forth(&mut factors, base, &solved, &points).expect("solutions");
            let back = &DrivenStep::<Transposed>::back(&mut factors, base, &solved, &points).expect("solutions");
            let step = LinearStep { base, solved, points: &points, driven: forth };
            let backward = LinearStep { base, solved, points: &points, driven: back };
            let [v, before] = [7, 507].map(|seed| random_vector(old, seed + n as u64));
            let weights = random_vector(new, 1007 + n as u64);
            let moved = step.forward(&mut factors, (&v, Some(&before)), &slope).expect("a solution").0;
            let (mut back, mut earlier) = (weights.clone(), None);
            backward.back(&mut factors, (&mut back, &mut earlier), None).expect("a solution");
            let ([left, size], [right, other]) = (products(&moved, &weights), products(&v, &back));
            let [more, added] = earlier.map_or([0.0; 2], |earlier| products(&before, &earlier));
            let (right, size) = (right + more, size.max(other).max(added));
            println!("{name}, step {n}: {left:e} {right:e}, {:.1e}", (left - right).abs() / size);
            assert!((left - right).abs() <= 1e-12 * size, "{name}, step {n}: {left:e} {right:e}");
            assert!(!name.contains("bdf2") || added > 0.0);
        }
    }
}
