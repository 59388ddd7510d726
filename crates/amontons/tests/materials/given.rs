//! Mechanics at a temperature that is given: closed forms of free, held and bent bodies, and the heat equation where
//! its solution is that temperature.

use std::fmt::Write as _;
use std::sync::Arc;

use amontons::case::{self, Case, Source};
use amontons::equation::StepError;
use amontons::hypotheses::{FindingId, findings};
use amontons::mesh::Mesh;
use amontons::output::{Memory, Probe, ProbePlace, ProbeSet, Quantity, Take, cell_values};
use amontons::problem::{Physics, Problem};
use amontons::run::{self, Settings};
use amontons::state::State;
use amontons::step::{March, Scheme};
use amontons::tensor::{Point, Rotation};

use crate::common::{Random, changed, told};

const YOUNG: f64 = 1000.0;
const POISSON: f64 = 0.3;
const ALPHA: f64 = 1e-4;

fn parse(text: &str) -> Case {
    case::parse(&Source::new("given.toml", text), &[]).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn solve(problem: &Problem) -> Memory {
    let mut memory = Memory::new().states_every(1).reports();
    run::run(problem, &Settings::default(), &mut [&mut memory]).unwrap_or_else(|error| panic!("{error}"));
    for state in &memory.states {
        let ledger = &state.ledger;
        assert!(ledger.closing_error.abs() <= 1e-11 * ledger.turned_over, "{ledger:?}");
        assert!(ledger.heat_content == 0.0 && ledger.heat_closing_error == 0.0, "no heat is balanced: {ledger:?}");
    }
    memory
}

fn last(memory: &Memory) -> &State {
    memory.states.last().expect("a state")
}

/// A bar of length 2 in a state: `plane-stress`, `plane-strain` or `space`.
fn bar(state: &str, rest: &str) -> String {
    let (mesh, stress_state, back) = match state {
        "space" => (
            "kind = \"box\"\nsize = [2.0, 1.0, 0.5]\nn = [4, 2, 1]\nelements = \"Q2\"".to_owned(),
            String::new(),
            "[[boundary]]\non = \"back\"\nnormal_displacement = 0\n",
        ),
        _ => (
            "kind = \"rectangle\"\nsize = [2.0, 1.0]\nn = [4, 2]\nelements = \"Q2\"".to_owned(),
            format!(", stress_state = \"{state}\""),
            "",
        ),
    };
    format!(
        "name = \"bar\"\nunits = \"dimensionless\"\n[mesh]\n{mesh}\n[time]\nend = 1.0\nsteps = 2\ninertia = false\n[material]\nexpansion_coefficient = {ALPHA:?}\nelasticity = {{ law = \"isotropic\", young = {YOUNG:?}, poisson = {POISSON:?}{stress_state} }}\n[[boundary]]\non = \"left\"\nnormal_displacement = 0\n[[boundary]]\non = \"bottom\"\nnormal_displacement = 0\n{back}{rest}"
    )
}

/// The problem with its mesh turned and moved.
fn elsewhere(problem: &Problem, random: &mut Random) -> (Problem, Rotation) {
    let axis = if problem.mesh.dim == 3 { [random.number(), random.number(), 1.0] } else { [0.0, 0.0, 1.0] };
    let rotation = Rotation::about(&axis, 3.0 * random.number());
    let shift = [random.number(), random.number(), 0.0];
    let turned = changed(problem, |data| {
        for x in &mut Arc::make_mut(&mut data.mesh).points {
            let y = rotation.vector(x);
            *x = std::array::from_fn(|c| y[c] + shift[c]);
        }
    });
    (turned, rotation)
}

fn at(state: &State, dim: usize, node: usize) -> Point {
    std::array::from_fn(|c| if c < dim { state.u[node * dim + c] } else { 0.0 })
}

/// A bar that may expand grows by α θ in each direction, by (1 + ν) α θ in plane strain, where it bears −E α θ along
/// the third direction alone; in every direction of space.
#[test]
fn a_free_bar_grows() {
    let mut random = Random(9);
    for state in ["plane-stress", "plane-strain", "space"] {
        let case = parse(&bar(state, "[load]\ntemperature = \"80*t\"\n"));
        assert_eq!(case.problem.physics, Physics::Warmed);
        let (turned, rotation) = elsewhere(&case.problem, &mut random);
        let memory = solve(&turned);
        let (end, dim) = (last(&memory), turned.mesh.dim);
        assert!(end.theta.iter().all(|theta| (theta - 80.0).abs() < 1e-12));
        let growth = ALPHA * 80.0 * if state == "plane-strain" { 1.0 + POISSON } else { 1.0 };
        for (node, x) in case.problem.mesh.points.iter().enumerate() {
            let (u, expected) = (at(end, dim, node), rotation.vector(&x.map(|x| growth * x)));
            let off = (0..3).map(|c| (u[c] - expected[c]).abs()).fold(0.0, f64::max);
            assert!(off < 1e-12 * 80.0 * ALPHA * 10.0, "{state}: {u:?} instead of {expected:?}");
        }
        let out = if state == "plane-strain" { -YOUNG * ALPHA * 80.0 } else { 0.0 };
        for cell in cell_values(&turned, end) {
            let axes = cell.stress.principal_axes();
            let expected = [0.0, 0.0, out];
            let off = (0..3).map(|c| (axes[c].0 - expected[c]).abs()).fold(0.0, f64::max);
            assert!(off < 1e-10 * YOUNG * ALPHA * 80.0, "{state}: {axes:?}");
        }
    }
}

/// A bar between two walls bears −E α θ along it; in plane strain −E α θ/(1 − ν), and ν of that more on top of −E α θ
/// across: σ_z = ν σ_x − E α θ.
#[test]
fn a_held_bar_is_pressed() {
    let mut random = Random(4);
    for state in ["plane-stress", "plane-strain", "space"] {
        let held = "[[boundary]]\non = \"right\"\nnormal_displacement = 0\n[load]\ntemperature = 40\n";
        let (turned, _) = elsewhere(&parse(&bar(state, held)).problem, &mut random);
        let memory = solve(&turned);
        let free = -YOUNG * ALPHA * 40.0;
        let (along, across) = match state {
            "plane-strain" => (free / (1.0 - POISSON), free + POISSON * free / (1.0 - POISSON)),
            _ => (free, 0.0),
        };
        let mut expected = [0.0, along, across];
        expected.sort_by(|a, b| b.total_cmp(a));
        for cell in cell_values(&turned, last(&memory)) {
            let axes = cell.stress.principal_axes();
            let off = (0..3).map(|c| (axes[c].0 - expected[c]).abs()).fold(0.0, f64::max);
            assert!(off < 1e-10 * free.abs(), "{state}: {axes:?} instead of {expected:?}");
        }
    }
}

/// A temperature g y bends a beam to the curvature α g without stress: u = α g (x y, (y² − x²)/2), which Q2 has.
#[test]
fn a_linear_temperature_bends_without_stress() {
    let case = parse(
        &bar(
            "plane-stress",
            "[[boundary]]\nat = [0, 0]\ndisplacement = [\"free\", 0]\n[load]\ntemperature = \"50*y\"\n",
        )
        .replace("[[boundary]]\non = \"bottom\"\nnormal_displacement = 0\n", ""),
    );
    let memory = solve(&case.problem);
    let bend = ALPHA * 50.0;
    for (node, x) in case.problem.mesh.points.iter().enumerate() {
        let u = at(last(&memory), 2, node);
        let expected = [bend * x[0] * x[1], 0.5 * bend * (x[1] * x[1] - x[0] * x[0])];
        assert!((0..2).all(|c| (u[c] - expected[c]).abs() < 1e-11 * bend), "{x:?}: {u:?} instead of {expected:?}");
    }
    let most = cell_values(&case.problem, last(&memory)).iter().map(|cell| cell.stress.norm()).fold(0.0, f64::max);
    assert!(most < 1e-10 * YOUNG * bend, "{most:e}");
}

/// Timoshenko's strip of two metals (1925): κ = 6 (α₂ − α₁) θ (1 + m)²/(h (3 (1 + m)² + (1 + m n)(m² + 1/(m n)))) with
/// m the ratio of the thicknesses and n that of the moduli, below over above. Away from its ends that is exact, and Q2
/// has it: what is left dies out from the ends as exp(−4.2 x/h), to 1e-9 at a quarter of the length.
#[test]
fn a_strip_of_two_metals_bends_as_timoshenko_says() {
    let (below, above, theta) = ((0.4, 3000.0, 1e-5), (0.6, 1000.0, 3e-5), 70.0);
    let text = format!(
        r#"name = "strip"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [20.0, 1.0]
n = [100, 10]
elements = "Q2"
[time]
end = 1.0
steps = 1
inertia = false
[material]
expansion_coefficient = "if(y < {h}, {}, {})"
elasticity = {{ law = "isotropic", young = "if(y < {h}, {}, {})", poisson = 0.3, stress_state = "plane-stress" }}
[load]
temperature = {theta}
[[boundary]]
at = [0, 0]
displacement = [0, 0]
[[boundary]]
at = [20, 0]
displacement = ["free", 0]
"#,
        below.2,
        above.2,
        below.1,
        above.1,
        h = below.0
    );
    let case = parse(&text);
    let memory = solve(&case.problem);
    let height = |x: f64| {
        let is_at = |p: &Point| (p[0] - x).abs() < 1e-9 && p[1].abs() < 1e-9;
        let node = case.problem.mesh.points.iter().position(is_at).expect("a node");
        at(last(&memory), 2, node)[1]
    };
    let found = -(height(5.0) - 2.0 * height(10.0) + height(15.0)) / 25.0;
    let (m, n) = (below.0 / above.0, below.1 / above.1);
    let expected = 6.0 * (below.2 - above.2) * theta * (1.0 + m) * (1.0 + m)
        / (3.0 * (1.0 + m) * (1.0 + m) + (1.0 + m * n) * (m * m + 1.0 / (m * n)));
    assert!((found + expected).abs() < 1e-6 * expected.abs(), "{found:e} and {expected:e}");
}

/// A block that heat presses onto a foundation with friction, by the heat equation or by its solution θ = 10 t +
/// 60 t x. Its modulus and its friction depend on the temperature.
fn pressed(given: bool) -> Problem {
    let warm = if given {
        "[load]\ntemperature = \"10*t + 60*t*x\"\n"
    } else {
        "[[boundary]]\non = \"left\"\ntemperature = \"10*t\"\n[[boundary]]\non = \"right\"\ntemperature = \"70*t\"\n[scheme]\ncoupling = \"monolithic\"\n"
    };
    let heat = if given { "" } else { "heat_capacity = 0\nconductivity = 2\n" };
    parse(&format!(
        r#"name = "pressed"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [1.0, 1.0]
n = [6, 6]
[time]
end = 1.0
steps = 5
[material]
density = 1
expansion_coefficient = {{ temperature = [0, 100], value = [1e-3, 2e-3] }}
{heat}elasticity = {{ law = "isotropic", young = {{ temperature = [0, 100], value = [100, 60] }}, poisson = 0.3, stress_state = "plane-strain" }}
viscosity = {{ law = "lame", first = 1, second = 1 }}
[[boundary]]
on = "top"
displacement = ["0.01*t", 0]
[contact]
on = "bottom"
gap = 0.01
normal = {{ law = "compliance", stiffness = 500 }}
friction = {{ law = "temperature", temperature = [0, 100], coefficient = [0.2, 0.4] }}
{warm}"#
    ))
    .problem
}

/// Where the heat equation has the temperature that is given as its solution, both are the same: displacements,
/// velocities and contact in all steps.
#[test]
fn it_is_the_heat_equation_with_its_solution() {
    let given = solve(&pressed(true));
    let mut solved = Memory::new().states_every(1).reports();
    run::run(&pressed(false), &Settings::default(), &mut [&mut solved]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((given.states.len(), solved.states.len()), (6, 6));
    for (a, b) in given.states.iter().zip(&solved.states).skip(1) {
        for (name, a, b) in [("u", &a.u, &b.u), ("w", &a.w, &b.w), ("θ", &a.theta, &b.theta)] {
            let most = b.iter().fold(0.0f64, |most, value| most.max(value.abs()));
            let off = a.iter().zip(b.iter()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-10 * most, "{name}: {off:e} of {most:e}");
        }
    }
    let [a, b] = [&given, &solved].map(|memory| memory.reports.last().expect("a report").contact.force);
    assert!((0..2).all(|c| (a[c] - b[c]).abs() < 1e-9 * b[1].abs()) && b[1] > 1.0 && b[0].abs() > 0.1, "{a:?} {b:?}");
    // The laws of contact see the temperature of the side.
    let found = &given.reports.last().expect("a report").contact.temperature;
    let points = &pressed(true).contact_boundary().points;
    assert!(found.iter().zip(points).all(|(theta, point)| (theta - 10.0 - 60.0 * point.x[0]).abs() < 1e-12));
}

/// A bar that grows beyond a gap g presses with p = c (α θ L − g)/(1 + c L/E).
#[test]
fn a_bar_that_grows_presses() {
    let (gap, stiffness) = (0.004, 700.0);
    let contact = format!(
        "[load]\ntemperature = \"60*t\"\n[contact]\non = \"right\"\ngap = {gap}\nnormal = {{ law = \"compliance\", stiffness = {stiffness} }}\n"
    );
    for state in ["plane-stress", "space"] {
        let memory = solve(&parse(&bar(state, &contact)).problem);
        let expected = [30.0, 60.0].map(|theta| {
            let free: f64 = ALPHA * theta * 2.0 - gap;
            stiffness * free.max(0.0) / (1.0 + stiffness * 2.0 / YOUNG)
        });
        for (report, p) in memory.reports.iter().zip(expected) {
            for point in &report.contact.states {
                assert!((point.pressure - p).abs() < 1e-10 * stiffness * gap, "{state}: {} {p}", point.pressure);
            }
        }
        assert!(expected[0] > 0.0 && expected[1] > expected[0]);
    }
}

/// A scheme that goes on from a state of another one has its bits.
#[test]
fn a_run_goes_on_to_the_bit() {
    let problem = pressed(true);
    let mut scheme = March::new(&problem).expect("a scheme");
    let mut state = scheme.initial().expect("a state");
    for _ in 0..2 {
        state = scheme.step(&state).expect("a step").0;
    }
    let mut other = March::new(&problem).expect("a scheme");
    other.recall(&scheme.kept()).expect("what is kept");
    let mut again = state.clone();
    for _ in 0..3 {
        state = scheme.step(&state).expect("a step").0;
        again = other.step(&again).expect("a step").0;
    }
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    let of = |state: &State| [bits(&state.u), bits(&state.w), bits(&state.theta)];
    assert_eq!(of(&state), of(&again));
}

/// The square with its right half as a second region.
fn halves(mesh: &Mesh) -> Mesh {
    let mut mesh = mesh.clone();
    let mut right = mesh.blocks[0].clone();
    let is_right = |cell: &[u32]| {
        let n = cell.len() as f64;
        cell.iter().map(|&node| mesh.points[node as usize][0]).sum::<f64>() / n > 0.5
    };
    let (of_right, of_left): (Vec<&[u32]>, Vec<&[u32]>) = mesh.blocks[0].cells().partition(|cell| is_right(cell));
    let (of_right, of_left) = (of_right.concat(), of_left.concat());
    (right.nodes, right.region) = (of_right, 1);
    mesh.blocks[0].nodes = of_left;
    mesh.blocks.push(right);
    mesh.regions = vec!["left".to_owned(), "right".to_owned()];
    mesh
}

/// A region has its own temperature; of a node of two such regions that of the first entry holds, as the results show.
#[test]
fn regions_have_temperatures_of_their_own() {
    let two = "kind = \"blocks\"\nblocks = [\n{ name = \"a\", size = [1.0, 1.0], n = [4, 4] },\n{ name = \"b\", size = [1.0, 1.0], n = [4, 4], origin = [2, 0] },\n]";
    let text = bar("plane-stress", "[[region]]\non = \"b\"\ntemperature = \"100*t\"\n[load]\ntemperature = { times = [0, 1], values = [20, 40] }\n")
        .replace("kind = \"rectangle\"\nsize = [2.0, 1.0]\nn = [4, 2]\nelements = \"Q2\"", two)
        .replace("\"left\"", "\"a_left\"")
        .replace("\"bottom\"", "\"a_bottom\"");
    let text = text
        + "[[boundary]]\non = \"b_left\"\nnormal_displacement = 0\n[[boundary]]\non = \"b_bottom\"\nnormal_displacement = 0\n";
    let case = parse(&text);
    let memory = solve(&case.problem);
    for (state, [a, b]) in memory.states.iter().zip([[20.0, 0.0], [30.0, 50.0], [40.0, 100.0]]) {
        for (x, theta) in case.problem.mesh.points.iter().zip(state.theta.iter()) {
            let expected = if x[0] < 1.5 { a } else { b };
            assert!((theta - expected).abs() < 1e-12, "{x:?}: {theta}");
        }
    }
    let probe = |name: &str, region: &str| Probe {
        name: name.to_owned(),
        quantity: Quantity::parse(name).expect("a quantity"),
        place: ProbePlace::Region(region.to_owned(), Take::Max),
        about: None,
    };
    assert!(ProbeSet::new(&case.problem, &[probe("temperature", "b")]).is_ok());
    assert!(ProbeSet::new(&case.problem, &[probe("heat_flux", "b")]).is_err());
    let summary = run::run(&case.problem, &Settings::default(), &mut []).expect("a run");
    assert_eq!([summary.last.temperature_min, summary.last.temperature_max], [Some(40.0), Some(100.0)]);
    // Regions that share nodes.
    let shared = changed(&case.problem, |data| {
        data.mesh = Arc::new(halves(
            &parse(&bar("plane-stress", "[load]\ntemperature = 1\n").replace("[2.0, 1.0]", "[1.0, 1.0]")).problem.mesh,
        ));
        data.boundary.clear();
        data.boundary.push(amontons::problem::BoundaryCondition::on("left").displacement([0.0, 0.0]));
        for (entry, (region, value)) in data.temperature.iter_mut().zip([(Some(1), 7.0), (Some(0), 3.0)]) {
            (entry.region, entry.field) = (region, value.into());
        }
    });
    for (x, theta) in shared.mesh.points.iter().zip(shared.given_temperature(0.0)) {
        assert!((theta - if x[0] > 0.5 - 1e-9 { 7.0 } else { 3.0 }).abs() < 1e-12, "{x:?}: {theta}");
    }
}

/// A temperature that changes nothing is told, one beyond a table ends the run with the place, and a step in which it
/// has no value names its key.
#[test]
fn temperatures_that_do_nothing_or_too_much_are_told() {
    let told = |text: &str| {
        let found = findings(&parse(text).problem);
        found.into_iter().find(|finding| finding.id == FindingId::NoEffect)
    };
    let text = bar("plane-stress", "[load]\ntemperature = \"80*t\"\n");
    assert!(told(&text).is_none());
    let mut without = String::new();
    text.lines().filter(|line| !line.starts_with("expansion")).for_each(|line| {
        let _ = writeln!(without, "{line}");
    });
    let finding = told(&without).expect("a finding");
    assert_eq!(finding.place, "load.temperature");
    let table = text.replace(
        "expansion_coefficient = 0.0001",
        "expansion_coefficient = { temperature = [0, 60], value = [1e-4, 1e-4] }",
    );
    let error = |text: &str| {
        let mut scheme = March::new(&parse(text).problem).expect("a scheme");
        let mut state = scheme.initial().expect("a state");
        loop {
            match scheme.step(&state) {
                Ok((next, _)) => state = next,
                Err(error) => return error,
            }
        }
    };
    let found = error(&table);
    assert!(matches!(found, StepError::Uncovered { step: 2, .. }), "{found}");
    let found = error(&text.replace("\"80*t\"", "\"1/((x - 0.5)^2 + (t - 0.5)^2)\""));
    assert!(matches!(&found, StepError::Data { key, step: 1, .. } if key == "load.temperature"), "{found}");
}

/// One message for each key that does not go with a temperature that is given.
#[test]
fn faults_of_a_temperature_that_is_given() {
    let fault = |rest: &str, says: &str| {
        let text = bar("plane-stress", rest);
        let found = told(&Source::new("given.toml", text), &[]);
        let place = found.splitn(4, ':').nth(3).map_or(found.as_str(), str::trim);
        assert_eq!(place, says, "{found}");
    };
    let beside = "expected no key of the heat equation: the temperature is known at all places and times; remove it, or remove the temperature, for which heat is then solved";
    let load = "[load]\ntemperature = 20\n";
    let right = "[[boundary]]\non = \"right\"\n";
    for (rest, says) in [
        (format!("{load}heat_source = 1\n"), "load.heat_source: found a heat source"),
        (format!("{load}{right}temperature = 0\n"), "boundary[2].temperature: found a temperature"),
        (format!("{load}{right}heat_inflow = 1\n"), "boundary[2].heat_inflow: found a heat inflow"),
        (
            format!("{load}{right}convection = {{ coefficient = 1, ambient = 0 }}\n"),
            "boundary[2].convection: found convection",
        ),
        (format!("{load}[initial]\ntemperature = 5\n"), "initial.temperature: found an initial temperature"),
        (
            format!(
                "{load}[contact]\non = \"right\"\nnormal = {{ law = \"signorini\" }}\nfriction = {{ law = \"coulomb\", coefficient = 0.3 }}\nfrictional_heat = 0.5\n"
            ),
            "contact.frictional_heat: found heat of friction",
        ),
        (
            format!(
                "{load}[contact]\non = \"right\"\nnormal = {{ law = \"signorini\" }}\nheat = {{ law = \"constant\", conductance = 1, foundation_temperature = 0 }}\n"
            ),
            "contact.heat: found heat exchange",
        ),
    ] {
        fault(&rest, &format!("{says} beside a temperature that is given, {beside}"));
    }
    fault(
        "[load]\ntemperature = \"z\"\n",
        "load.temperature: found `z` in an expression, expected an expression in x, y, t: the body is plane",
    );
    fault(
        "[load]\ntemperature = { times = [0, 0.5], values = [0, 1] }\n",
        "load.temperature: found a table that ends at t = 0.5, expected values to the end of the run, t = 1.0; give more rows, or `extend = \"hold\"` to keep the value at the end",
    );
    let keys = bar("plane-stress", load).replace("[material]\n", "[material]\nconductivity = 2\n");
    let found = told(&Source::new("given.toml", keys), &[]);
    assert!(
        found.contains(&format!(
            "material.conductivity: found a conductivity beside a temperature that is given, {beside}"
        )),
        "{found}"
    );
    let heat = "name = \"h\"\n[mesh]\nkind = \"rectangle\"\nsize = [1, 1]\nn = 2\n[time]\nend = 1\nsteps = 1\n[material]\nheat_capacity = 1\nconductivity = 1\n[load]\ntemperature = 5\n";
    assert_eq!(
        told(&Source::new("given.toml", heat), &[]),
        "given.toml:13:15: load.temperature: found a temperature that is given in a case without mechanics, expected keys of heat only: no material has any of mechanics; remove it, or give material.density and material.elasticity"
    );
}

/// A material of the library expands by its own coefficient, and needs no key of heat; temperatures may be in °C.
#[test]
fn a_named_material_expands() {
    let case = parse(
        r#"name = "named"
material = "steel-s235"
[mesh]
kind = "box"
size = [2.0, 1.0, 1.0]
n = 1
[time]
end = 1.0
steps = 1
inertia = false
[load]
temperature = "50 °C"
[[boundary]]
on = "left"
normal_displacement = 0
[[boundary]]
on = "bottom"
normal_displacement = 0
[[boundary]]
on = "back"
normal_displacement = 0
"#,
    );
    let memory = solve(&case.problem);
    let node = case.problem.mesh.points.iter().position(|x| x.iter().sum::<f64>() > 3.999).expect("a node");
    let alpha = case::materials()["steel-s235"].expansion_coefficient;
    let u = at(last(&memory), 3, node);
    assert!((u[0] - 2.0 * 50.0 * alpha).abs() < 1e-12 && (u[1] - 50.0 * alpha).abs() < 1e-12, "{u:?}");
}

/// A temperature is the same along both cuts of a sector that is repeated about an axis.
#[test]
fn sectors_have_a_temperature_that_turns_with_them() {
    let told = |temperature: &str| {
        let text = format!(
            r#"name = "ring"
[mesh]
kind = "ring"
radii = [1.0, 2.0]
angle = 1.5707963267948966
n = [2, 4]
[time]
end = 1.0
steps = 1
inertia = false
[material]
expansion_coefficient = 1e-5
elasticity = {{ law = "isotropic", young = 1e9, poisson = 0.3, stress_state = "plane-stress" }}
[[cyclic]]
sides = ["start", "end"]
[[boundary]]
on = "inner"
spring = 1e6
[load]
temperature = "{temperature}"
"#
        );
        told(&Source::new("ring.toml", text), &[])
    };
    assert_eq!(told("10*t*(x^2 + y^2)"), "no fault");
    assert_eq!(
        told("10*t*(x^2 + 2*y^2)"),
        "ring.toml:20:15: load.temperature: found a value at x = 0.0, y = 1.0 that is not the one at x = 1.0, y = 0.0, turned, expected the same on both sides of the sector; the body is repeated about its axis: what is given in one sector is given in every other, turned"
    );
}
