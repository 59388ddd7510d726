//! A random search for steps that are hard for Newton's method on Γ_C: bodies of every cell type in the plane and in
//! space, rotated by random angles, with every law of pressure and friction, on random obstacles, over decades of
//! stiffness and of the step length.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::process::ExitCode;
use std::sync::Arc;

use amontons::case::{self, Source};
use amontons::hypotheses::{self, FindingId};
use amontons::mesh::Mesh;
use amontons::problem::Problem;
use amontons::step::{March, Scheme};

use crate::random::Random;

/// Largest number of iterations of a step that has one solution by the certificate.
const MOST: usize = 60;

/// What to search.
#[derive(clap::Args)]
pub struct Arguments {
    /// Seed of the first case; the case of the next seed follows.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Number of steps to make, in cases of 10 steps each.
    #[arg(long, default_value_t = 1000)]
    steps: usize,
    /// Run the case of the seed alone and print its text and steps.
    #[arg(long)]
    only: bool,
    /// Only cases in which a step has one solution by the certificate.
    #[arg(long)]
    certified: bool,
    /// Cases with this text only, as in `law = "static-kinetic"`.
    #[arg(long)]
    with: Option<String>,
}

/// A case of the search.
struct Sample {
    text: String,
    problem: Problem,
    class: String,
}

/// Results of the steps of one class.
#[derive(Default)]
struct Class {
    cases: usize,
    steps: usize,
    failed: usize,
    halved: usize,
    iterations: usize,
    most: usize,
    worst: u64,
}

/// Runs the search; fails if a step that has one solution by the certificate fails or takes more than [`MOST`]
/// iterations.
pub fn run(arguments: &Arguments) -> ExitCode {
    let (classes, last) = search(arguments);
    println!(
        "{:<36} {:>6} {:>6} {:>7} {:>7} {:>6} {:>6}  seed",
        "class", "cases", "steps", "failed", "halved", "mean", "most"
    );
    for (name, class) in &classes {
        let mean = class.iterations as f64 / class.steps.max(1) as f64;
        println!(
            "{name:<36} {:>6} {:>6} {:>7} {:>7} {mean:>6.1} {:>6}  {}",
            class.cases, class.steps, class.failed, class.halved, class.most, class.worst
        );
    }
    let sum = |is_unique: bool| {
        let own = classes.iter().filter(|(name, _)| name.starts_with(UNIQUE) == is_unique);
        own.fold([0; 2], |[steps, failed], (_, class)| [steps + class.steps, failed + class.failed])
    };
    let ([unique, unique_failed], [other, other_failed]) = (sum(true), sum(false));
    println!(
        "seeds {} to {last}: {unique} steps with one solution by the certificate, {unique_failed} failed; {other} others, {other_failed} failed",
        arguments.seed
    );
    ExitCode::from(u8::from(!holds(&classes)))
}

/// First word of the classes whose steps have one solution by the certificate.
const UNIQUE: &str = "unique";

/// True if every step that has one solution was made within [`MOST`] iterations.
fn holds(classes: &BTreeMap<String, Class>) -> bool {
    classes.iter().all(|(name, class)| !name.starts_with(UNIQUE) || (class.failed == 0 && class.most <= MOST))
}

/// The classes of the cases, starting at a seed, until the number of steps is reached, and the last seed.
fn search(arguments: &Arguments) -> (BTreeMap<String, Class>, u64) {
    let mut classes: BTreeMap<String, Class> = BTreeMap::new();
    let (mut made, mut seed) = (0, arguments.seed);
    loop {
        let sample = sample(seed);
        if arguments.with.as_ref().is_none_or(|with| sample.text.contains(with)) {
            let is_unique = is_unique(&sample.problem);
            if arguments.only {
                println!("{}\nstep-unique: {is_unique}", sample.text);
            }
            if arguments.certified && !is_unique {
                seed += 1;
                continue;
            }
            let class =
                classes.entry(format!("{:<6} {}", if is_unique { UNIQUE } else { "-" }, sample.class)).or_default();
            class.cases += 1;
            made += steps(&sample.problem, class, seed, arguments.only);
        }
        if arguments.only || made >= arguments.steps {
            return (classes, seed);
        }
        seed += 1;
    }
}

/// Makes the steps of a case. Returns the number of attempted steps.
fn steps(problem: &Problem, class: &mut Class, seed: u64, talk: bool) -> usize {
    let mut scheme = match March::new(problem) {
        Ok(scheme) => scheme,
        Err(error) => {
            println!("seed {seed}: {error}");
            return 1;
        }
    };
    let mut state = match scheme.initial() {
        Ok(state) => state,
        Err(error) => {
            println!("seed {seed}: {error}");
            return 1;
        }
    };
    for n in 0..problem.timeline.steps() {
        class.steps += 1;
        match scheme.step(&state) {
            Ok((next, report)) => {
                if talk {
                    println!(
                        "step {}: {} iterations in {} parts, residual {:.1e}",
                        n + 1,
                        report.newton_mechanics,
                        report.parts,
                        report.residual
                    );
                }
                class.iterations += report.newton_mechanics;
                class.halved += usize::from(report.parts > 1);
                if report.newton_mechanics > class.most {
                    (class.most, class.worst) = (report.newton_mechanics, seed);
                }
                state = next;
            }
            Err(error) => {
                println!("seed {seed}: {error}");
                (class.failed, class.worst) = (class.failed + 1, seed);
                return n + 1;
            }
        }
    }
    problem.timeline.steps()
}

/// True if a step has one solution by the certificate.
fn is_unique(problem: &Problem) -> bool {
    hypotheses::certificate_or_findings(problem)
        .findings
        .iter()
        .any(|finding| finding.id == FindingId::StepUnique && finding.holds())
}

/// The case with this seed.
fn sample(seed: u64) -> Sample {
    let mut random = Random::new(seed);
    let space = random.chance(0.3);
    let elements = random.of(&["P1", "Q1", "P2", "Q2"]);
    let (normal, normal_name) = normal_law(&mut random);
    let (friction, friction_name) = friction_law(&mut random, space);
    let turn = turn(&mut random, space);
    let text = text(&mut random, space, elements, [&normal, &friction], &turn);
    let problem = match case::parse(&Source::new("random.toml", text.clone()), &[]) {
        Ok(case) => case.problem,
        Err(error) => {
            println!("seed {seed}: {error}\n{text}");
            std::process::exit(2);
        }
    };
    let mesh = Arc::new(distorted(&problem.mesh, &mut random, &turn));
    let problem = match problem.with(|data| data.mesh = mesh) {
        Ok(problem) => problem,
        Err(faults) => {
            println!("seed {seed}: {faults}\n{text}");
            std::process::exit(2);
        }
    };
    let points = if text.contains("\"gauss\"") { "gauss" } else { "nodal" };
    Sample { text, problem, class: format!("{points} {normal_name:<10} {friction_name}") }
}

/// An orthogonal matrix.
type Turn = [[f64; 3]; 3];

/// A random rotation: in the plane, or in space about three axes in turn.
fn turn(random: &mut Random, space: bool) -> Turn {
    let about = |axis: usize, angle: f64| -> Turn {
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut turn: Turn = std::array::from_fn(|c| std::array::from_fn(|e| f64::from(u8::from(c == e))));
        (turn[a][a], turn[a][b], turn[b][a], turn[b][b]) = (angle.cos(), -angle.sin(), angle.sin(), angle.cos());
        turn
    };
    let after = |s: &Turn, t: &Turn| -> Turn {
        std::array::from_fn(|c| std::array::from_fn(|e| (0..3).map(|f| s[c][f] * t[f][e]).sum()))
    };
    let [a, b, c] = [0; 3].map(|_: i32| random.between(0.0, 6.3));
    if space { after(&about(0, b), &after(&about(1, c), &about(2, a))) } else { about(2, a) }
}

/// The body with curved sides and cells, rotated.
fn distorted(mesh: &Mesh, random: &mut Random, turn: &Turn) -> Mesh {
    let amplitude = random.between(0.0, 0.01);
    let phase = random.between(0.0, 6.3);
    let mut mesh = mesh.clone();
    for x in &mut mesh.points {
        let [a, b, c] = *x;
        x[0] = a + amplitude * (5.0 * b + phase).sin();
        x[1] = b + amplitude * (4.0 * a + 3.0 * c + phase).sin();
        *x = turned(turn, x);
    }
    mesh
}

fn turned(turn: &Turn, v: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|c| (0..3).map(|e| turn[c][e] * v[e]).sum())
}

/// A rotated vector of expressions, in the notation of the case file.
fn expressions(turn: &Turn, components: &[String]) -> String {
    let of = |c: usize| {
        components
            .iter()
            .enumerate()
            .map(|(e, f)| format!("({:.17e})*({f})", turn[c][e]))
            .collect::<Vec<_>>()
            .join(" + ")
    };
    (0..components.len()).map(|c| format!("\"{}\"", of(c))).collect::<Vec<_>>().join(", ")
}

/// A rotated vector of numbers.
fn numbers(turn: &Turn, v: [f64; 3], space: bool) -> String {
    turned(turn, &v).iter().take(if space { 3 } else { 2 }).map(|c| format!("{c:.17e}")).collect::<Vec<_>>().join(", ")
}

fn normal_law(random: &mut Random) -> (String, &'static str) {
    let c = random.decades(1e2, 1e14);
    match random.of(&[0, 0, 0, 1, 1, 2, 3, 4, 5]) {
        0 => (format!("{{ law = \"compliance\", stiffness = {c:e} }}"), "compliance"),
        1 => ("{ law = \"signorini\" }".into(), "signorini"),
        2 => (format!("{{ law = \"stop\", stiffness = {c:e}, depth = {:e} }}", random.decades(1e-5, 1e-2)), "stop"),
        3 => (format!("{{ law = \"power\", stiffness = {c:e}, exponent = {} }}", random.between(1.0, 3.0)), "power"),
        4 => (
            format!("{{ law = \"damped\", stiffness = {c:e}, damping = {:e} }}", c * random.decades(1e-6, 1e-1)),
            "damped",
        ),
        _ => (
            format!(
                "{{ law = \"table\", penetration = [0, 1e-4, 1e-3], pressure = [0, {:e}, {:e}] }}",
                1e-4 * c,
                1e-2 * c
            ),
            "table",
        ),
    }
}

fn friction_law(random: &mut Random, space: bool) -> (String, &'static str) {
    let mu = random.decades(0.1, 2.0);
    match random.of(&[0, 0, 0, 0, 1, 2, 3, 4, 5, 6]) {
        0 => (format!("{{ law = \"coulomb\", coefficient = {mu} }}"), "coulomb"),
        1 => (format!("{{ law = \"tresca\", bound = {:e} }}", random.decades(1e-2, 1e2)), "tresca"),
        2 => (
            format!("{{ law = \"static-kinetic\", static = {mu}, kinetic = {} }}", mu * random.between(0.5, 0.95)),
            "static-kinetic",
        ),
        3 => {
            let (kinetic, decay) = (mu * random.between(0.5, 0.95), random.decades(1e-2, 1.0));
            (
                format!("{{ law = \"static-kinetic\", static = {mu}, kinetic = {kinetic}, decay_speed = {decay} }}"),
                "decaying",
            )
        }
        4 => (format!("{{ law = \"coulomb\", coefficient = {mu}, cap = {:e} }}", random.decades(1e-2, 1e2)), "capped"),
        5 if space => (
            format!(
                "{{ law = \"orthotropic\", coefficients = [{mu}, {}], direction = [1, 0.3, 0.5] }}",
                mu * random.between(0.3, 1.0)
            ),
            "orthotropic",
        ),
        5 => (
            format!(
                "{{ law = \"slip-rate\", speed = [0, 0.1, 1], coefficient = [{mu}, {}, {mu}] }}",
                mu * random.between(0.6, 1.0)
            ),
            "slip-rate",
        ),
        _ => ("{ law = \"coulomb\", coefficient = 0.0 }".into(), "none"),
    }
}

/// The text of a case: a block on a foundation, pressed and moved by its top.
fn text(random: &mut Random, space: bool, elements: &str, [normal, friction]: [&str; 2], turn: &Turn) -> String {
    let (kind, size, n) = match (space, elements) {
        (false, "P2" | "Q2") => ("rectangle", "[1.0, 0.5]", "[6, 3]"),
        (false, _) => ("rectangle", "[1.0, 0.5]", "[12, 6]"),
        (true, "P2" | "Q2") => ("box", "[1.0, 0.5, 1.0]", "[2, 1, 2]"),
        (true, _) => ("box", "[1.0, 0.5, 1.0]", "[4, 2, 4]"),
    };
    let k = random.decades(1e-6, 1.0);
    let end = 10.0 * k;
    let density = random.of(&[0.0, 1.0]);
    let [first, second] = random.of(&[[0.0, 0.0], [0.3, 0.8], [3.0, 8.0]]);
    let press = random.decades(1e-3, 3e-2);
    let [shake, turns] = [random.decades(1e-3, 3e-2), random.between(0.2, 2.0)];
    let mut motion =
        vec![format!("{shake:e}*sin({:e}*t)", 6.3 * turns / end), format!("-{press:e}*min(1, t/{:e})", 0.4 * end)];
    if space {
        motion.push(format!("{:e}*(1 - cos({:e}*t))", 0.7 * shake, 4.1 * turns / end));
    }
    let velocity = press / end * random.decades(1e-2, 10.0);
    let v = numbers(turn, [velocity, 0.0, if space { -0.4 * velocity } else { 0.0 }], space);
    let mut text = format!(
        "name = \"random\"\n[mesh]\nkind = \"{kind}\"\nsize = {size}\nn = {n}\nelements = \"{elements}\"\n[time]\nend = {end:e}\nsteps = 10\n[material]\ndensity = {density:?}\n\
         heat_capacity = 1.0\nexpansion = 0\ncoupling = 0\nconductivity = 1\nviscosity = {{ law = \"lame\", first = {:e}, second = {:e} }}\n\
         elasticity = {{ law = \"isotropic\", young = 200.0, poisson = {}{} }}\n[[boundary]]\non = \"top\"\ndisplacement = [{}]\n\
         [contact]\non = \"bottom\"\nquadrature = \"{}\"\nnormal = {normal}\nfriction = {friction}\n",
        first * 1e2 * k,
        second * 1e2 * k,
        random.of(&[0.0, 0.3, 0.45]),
        if space { "" } else { ", stress_state = \"plane-strain\"" },
        expressions(turn, &motion),
        if random.chance(0.25) && !(normal.contains("signorini") || normal.contains("stop")) {
            "gauss"
        } else {
            "nodal"
        },
    );
    if random.chance(0.6) {
        let _ = writeln!(text, "foundation_velocity = [{v}]");
    }
    text + &obstacle(random, space, turn)
}

fn obstacle(random: &mut Random, space: bool, turn: &Turn) -> String {
    let z = if space { random.between(0.3, 0.7) } else { 0.0 };
    let tilt = [random.between(-0.1, 0.1), 1.0, if space { 0.03 } else { 0.0 }];
    match random.of(&[0, 0, 1, 2, 2]) {
        0 => String::new(),
        1 => {
            let (point, normal) = (numbers(turn, [0.5, -0.002, z], space), numbers(turn, tilt, space));
            format!("[contact.obstacle]\nshape = \"plane\"\npoint = [{point}]\nnormal = [{normal}]\n")
        }
        _ => {
            let radius = random.decades(0.5, 20.0);
            let center = numbers(turn, [random.between(0.2, 0.8), -0.002 - radius, z], space);
            format!("[contact.obstacle]\nshape = \"sphere\"\ncenter = [{center}]\nradius = {radius:.17e}\n")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A small part of the search.
    #[test]
    fn steps_with_one_solution_are_easy() {
        let (classes, _) = search(&Arguments { seed: 1, steps: 600, only: false, certified: false, with: None });
        assert!(classes.keys().filter(|name| name.starts_with(UNIQUE)).count() > 3, "too few cases are certified");
        assert!(holds(&classes));
    }

    /// Gauss points hold a body more often than it has unknowns, so that multipliers are not unique: soft and stiff
    /// layers in the plane and in space, with dashpots, with Coulomb's friction and with a cap, with and without
    /// uniqueness by the certificate.
    #[test]
    fn gauss_points_that_hold_a_body_too_often_are_easy() {
        for seed in [51, 239, 326, 2641, 3727, 3875, 4467, 5642, 5968, 20228, 20269] {
            let (classes, _) = search(&Arguments { seed, steps: 1, only: false, certified: false, with: None });
            for (name, class) in classes {
                let most = if name.starts_with(UNIQUE) { MOST } else { 2 * MOST };
                assert!(
                    name.contains("gauss") && class.failed == 0 && class.most <= most,
                    "seed {seed}: {} failed, {} iterations",
                    class.failed,
                    class.most
                );
            }
        }
    }

    /// Friction that softens with the slip speed, on bodies for which smaller parts of a step do not help: few parts
    /// are made.
    #[test]
    fn weakening_friction_takes_few_parts() {
        for seed in [20011, 20169, 20200] {
            let (classes, _) = search(&Arguments { seed, steps: 1, only: false, certified: false, with: None });
            for (name, class) in classes {
                assert!(name.contains("slip-rate") && class.halved > 0, "seed {seed}: {name}");
                assert!(class.failed == 0 && class.most <= 2 * MOST, "seed {seed}: {} iterations", class.most);
            }
        }
    }
}
