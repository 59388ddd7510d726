//! Rigid parts with what they meet: revolution, heat, wear, a law that falls in halved steps, interruptions, sectors.

use amontons::case::{self, Source};
use amontons::problem::Problem;
use amontons::state::{State, StepReport};
use amontons::step::{March, Scheme};

use crate::common::{changed, interrupts, solve, told};

fn problem(text: &str) -> Problem {
    case::parse(&Source::new("rigid.toml", text), &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).problem
}

/// A rectangle from (1, 0) on, 1 wide and 1.5 high, of E = 1000 and ν = 0, held along y below, with these lines
/// besides.
fn column(mesh: &str, flat: &str, more: &str) -> String {
    format!(
        r#"name = "column"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [1.0, 1.5]
origin = [1.0, 0]
n = [4, 6]
elements = "Q2"
{mesh}
[time]
end = 1.0
steps = 2
[material]
density = 0
elasticity = {{ law = "isotropic", young = 1000, poisson = 0{flat} }}
{more}
"#
    )
}

const HELD: &str = "[[boundary]]\non = \"bottom\"\ndisplacement = [\"free\", 0]\n";

/// A ring with ν = 0 under a force along its axis: u = F H/(E A), A = 3π. A force across the axis moves nothing.
#[test]
fn a_ring_moves_along_its_axis_alone() {
    let text =
        |force: &str| column("axisymmetric = true", "", &format!("{HELD}[[rigid]]\non = \"top\"\nforce = {force}"));
    let problem = problem(&text("[0, -7]"));
    let memory = solve(&problem);
    let state = memory.states.last().expect("a state");
    for node in problem.mesh.facets["top"].node_list() {
        let u = &state.u[2 * node as usize..][..2];
        let expected = -7.0 * 1.5 / (1000.0 * 3.0 * std::f64::consts::PI);
        assert!(u[0].abs() < 1e-16 && (u[1] - expected).abs() < 1e-12 * expected.abs(), "{u:?} {expected}");
    }
    let said = told(&Source::new("case.toml", text("[1, -7]")), &[]);
    let expected = "rigid[0].force: found a force on \"top\" in a direction in which it does not move, expected a force that moves the part; a rigid part of a body of revolution moves along the axis alone";
    assert!(said.ends_with(expected) && said.lines().count() == 1, "{said}");
    let said = told(&Source::new("case.toml", text("[0, -7]\nmoment = [1]")), &[]);
    assert!(said.contains("rigid[0].moment: found 1 components, expected no moment"), "{said}");
}

/// A column that grows along y alone, 𝓜 = E α e₂ ⊗ e₂, lifts its rigid top by α θ H without stress.
#[test]
fn a_warm_column_lifts_its_rigid_top() {
    let heat = "expansion = [[0, 0], [0, 2]]\ncoupling = 0\nheat_capacity = 1\nconductivity = 1\n[initial]\ntemperature = 10\n[scheme]\ncoupling = \"monolithic\"\n";
    let more = format!("{heat}{HELD}[[boundary]]\nat = [1.0, 0]\ndisplacement = [0, 0]\n[[rigid]]\non = \"top\"\n");
    let problem = problem(&column("", ", stress_state = \"plane-stress\"", &more));
    let memory = solve(&problem);
    let state = memory.states.last().expect("a state");
    for node in problem.mesh.facets["top"].node_list() {
        let u = &state.u[2 * node as usize..][..2];
        assert!(u[0].abs() < 1e-13 && (u[1] - 0.03).abs() < 1e-13, "{u:?}");
    }
    // Nothing is turned over but what the load of the heat does and the body stores.
    assert!(state.ledger.closing_error.abs() < 1e-13 * state.ledger.turned_over.max(1.0));
}

/// A rigid body of mass 1 and width 1, guided, on a layer; `law` and the number of steps to t = 0.8.
fn block(law: &str, steps: usize, more: &str) -> String {
    format!(
        r#"name = "block"
units = "dimensionless"
[mesh]
kind = "blocks"
blocks = [{{ name = "block", size = [1.0, 0.5], n = [6, 3], elements = "Q1" }}]
[time]
end = 0.8
steps = {steps}
[material]
density = 2
elasticity = {{ law = "isotropic", young = 1000, poisson = 0.3, stress_state = "plane-strain" }}
[[rigid]]
on = "block"
force = [0, -0.8]
guided = true
[[boundary]]
at = [0, 0.5]
displacement = [0, "free"]
[contact]
on = "block_bottom"
normal = {law}
{more}
"#
    )
}

/// A rigid pad wears by κ p v t everywhere, and sinks by the wear and by p/c: without inertia, in every step.
#[test]
fn a_rigid_pad_wears_evenly() {
    let more = "foundation_velocity = [3, 0]\nwear = { law = \"archard\", coefficient = 0.02 }\nfriction = { law = \"coulomb\", coefficient = 0.4 }\nfrictional_heat = 0";
    let text = block("{ law = \"compliance\", stiffness = 50 }", 8, more).replace("density = 2", "density = 0");
    let problem = problem(&text);
    let memory = solve(&problem);
    let (p, rate) = (0.8, 0.02 * 0.8 * 3.0);
    for state in memory.states.iter().skip(1) {
        let depth = rate * state.t;
        assert!(state.surface.wear.iter().all(|wear| (wear - depth).abs() < 1e-13), "{:?}", state.surface.wear);
        let sunk = depth + p / 50.0;
        assert!(state.u.iter().skip(1).step_by(2).all(|u| (u + sunk).abs() < 1e-12), "{}", state.t);
    }
    let report = memory.reports.last().expect("a report");
    assert!((report.contact.force[0].abs() - 0.4 * p).abs() < 1e-12, "{:?}", report.contact.force);
}

const FALLS: &str = "{ law = \"softening\", stiffness = 100, peak = 1, softening = 25, residual = 0.2 }";

/// The mass that is pressed through a layer which gives way (benchmark `snap-through-softening-layer`), as a rigid
/// body: the closed form at t = 0.8, with the order of the scheme.
#[test]
fn a_rigid_mass_snaps_through() {
    let (t1, t2) = ((-0.25f64).acos() / 10.0, 0.567_597_9);
    let s = 0.8 - t2;
    let exact = 0.042 + 0.137_113_1 * s + 0.3 * s * s;
    assert!((t1 - 0.182_347_7).abs() < 1e-7);
    let error = |steps: usize| {
        let memory = solve(&problem(&block(FALLS, steps, "")));
        (memory.states.last().expect("a state").u[1] + exact).abs()
    };
    let [coarse, fine] = [2000, 4000].map(error);
    assert!(fine < 2e-3 * exact && (0.8..1.2).contains(&(coarse / fine).log2()), "{coarse} {fine}");
}

fn steps(problem: &Problem) -> (Vec<State>, Vec<StepReport>) {
    let memory = solve(problem);
    (memory.states, memory.reports)
}

/// In long steps the layer has several solutions: they are halved, have the same bits from a state on, and one that is
/// interrupted in halves is not made.
#[test]
fn halved_steps_of_a_rigid_mass_are_whole_or_none() {
    let problem = problem(&block(FALLS, 3, ""));
    let (states, reports) = steps(&problem);
    let halved = reports.iter().position(|report| report.parts > 1).expect("a halved step");
    let step = |problem: &Problem| March::new(problem).expect("a scheme").step(&states[halved]);
    assert!(step(&problem).expect("a step").0 == states[halved + 1], "another step from the same state");
    let (mut interrupted, mut made) = (0, 0);
    for left in (1..3000).step_by(7) {
        match step(&interrupts::interrupted(&problem, left)) {
            Err(error) => {
                assert!(error.is_interruption(), "{error}");
                interrupted += 1;
            }
            Ok((state, _)) => {
                assert!(state == states[halved + 1], "interrupted at evaluation {left}: another state");
                made += 1;
            }
        }
    }
    assert!(interrupted > 10 && made > 10, "{interrupted} interruptions, {made} steps");
}

/// A sector of a ring, or a whole one without a line for its angle, held outside, and what is said of it.
fn ring(angle: &str, around: usize, more: &str) -> String {
    format!(
        r#"name = "ring"
units = "dimensionless"
[mesh]
kind = "ring"
radii = [1, 2]
{angle}
n = [4, {around}]
elements = "Q1"
[time]
end = 1.0
steps = 1
[material]
density = 0
elasticity = {{ law = "isotropic", young = 10, poisson = 0.3, stress_state = "plane-strain" }}
[[boundary]]
on = "outer"
displacement = [0, 0]
{more}
"#
    )
}

/// A rigid piece of the inner side in the middle of each of two quarters of a half ring; or of the first of them, whose
/// cuts meet each other turned by a quarter. A force along the side and a moment act on each.
fn pieces(quarters: usize) -> String {
    let of = |quarter: usize| {
        let (sin, cos) = (std::f64::consts::FRAC_PI_4 + quarter as f64 * std::f64::consts::FRAC_PI_2).sin_cos();
        format!(
            "[[side]]\nname = \"piece{quarter}\"\nof = [\"inner\"]\non = {{ near = {{ point = [{cos:?}, {sin:?}], distance = 0.45 }} }}\n\
             [[rigid]]\non = \"piece{quarter}\"\nforce = [{:?}, {:?}]\nmoment = [0.05]\n",
            -0.2 * sin + 0.1 * cos,
            0.2 * cos + 0.1 * sin
        )
    };
    (0..quarters).map(of).collect()
}

/// One quarter of a ring whose cuts are joined has what each quarter of the whole ring has, with a rigid piece in each;
/// a rigid part that touches the cuts is refused.
#[test]
fn a_sector_has_rigid_parts_away_from_its_cuts() {
    let quarter = format!("angle = {:?}", std::f64::consts::FRAC_PI_2);
    let joined = "[[cyclic]]\nsides = [\"start\", \"end\"]\n";
    let sector = problem(&ring(&quarter, 8, &(joined.to_owned() + &pieces(1))));
    let whole = problem(&ring("", 32, &pieces(4)));
    let [one, all] = [&sector, &whole].map(|problem| solve(problem).states.pop().expect("a state"));
    let most = one.u.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
    assert!(most > 1e-3, "{most}");
    for (i, x) in sector.mesh.points.iter().enumerate() {
        let near = |y: &&[f64; 3]| (0..2).all(|c| (x[c] - y[c]).abs() < 1e-9);
        let other = whole.mesh.points.iter().position(|y| near(&y)).expect("the same node");
        let off = (0..2).map(|c| (one.u[2 * i + c] - all.u[2 * other + c]).abs()).fold(0.0, f64::max);
        assert!(off < 1e-11 * most.max(1.0), "{x:?}: {off}");
    }
    let text = ring(&quarter, 8, &format!("{joined}[[rigid]]\non = \"inner\"\nforce = [1, 0]"));
    let said = told(&Source::new("case.toml", text), &[]);
    let expected = "rigid[0].on: found \"inner\", which has nodes of a cut of a sector, expected nodes away from the cuts of cyclic sectors";
    assert!(said.contains(expected) && said.lines().count() == 1, "{said}");
}

/// A mesh with a node that it lacks is refused, and ends no program.
#[test]
fn a_faulty_mesh_is_refused() {
    let sound = problem(&block("{ law = \"compliance\", stiffness = 50 }", 1, ""));
    let mut data = changed(&sound, |_| {}).into_data();
    std::sync::Arc::make_mut(&mut data.mesh).blocks[0].nodes[0] = 1_000_000;
    let faults = data.check().expect_err("a faulty mesh");
    assert!(faults.to_string().contains("mesh"), "{faults}");
}

/// A foot under a guided side, which friction alone holds sideways: the guide bears the moment, so that the contact has
/// the resultant of the load, and the foot leans the way it is pushed.
#[test]
fn friction_alone_holds_a_guided_side() {
    let coulomb = "{ law = \"coulomb\", coefficient = 0.3 }";
    for (normal, friction) in [
        ("{ law = \"signorini\" }", coulomb),
        ("{ law = \"compliance\", stiffness = 1e13 }", coulomb),
        ("{ law = \"signorini\" }", "{ law = \"stick\" }"),
        ("{ law = \"bilateral\" }", "{ law = \"tresca\", bound = 1e6 }"),
    ] {
        for (turn, push) in [(0.0_f64, 1e4), (0.7, 1e4), (-2.1, 1e-3), (1.3, 0.0)] {
            let (s, c) = turn.sin_cos();
            let turned = |x: f64, y: f64| [c * x - s * y, s * x + c * y];
            let [fx, fy] = turned(push, -2e5);
            let text = format!(
                "name = \"foot\"\n[mesh]\nkind = \"rectangle\"\nsize = [0.04, 0.02]\nn = [3, 2]\nelements = \"Q1\"\n\
                 [time]\nend = 1\nsteps = 1\n[material]\ndensity = 0\nelasticity = {{ law = \"isotropic\", young = 20e9, \
                 poisson = 0.25, stress_state = \"plane-stress\" }}\n[[rigid]]\non = \"top\"\nforce = [{fx:?}, {fy:?}]\n\
                 guided = true\n[contact]\non = \"bottom\"\nnormal = {normal}\nfriction = {friction}\n"
            );
            let problem = changed(&problem(&text), |data| {
                let mut mesh = (*data.mesh).clone();
                mesh.points.iter_mut().for_each(|p| {
                    let [x, y] = turned(p[0], p[1]);
                    *p = [x, y, 0.0];
                });
                data.mesh = std::sync::Arc::new(mesh);
            });
            let memory = solve(&problem);
            let force = memory.reports.last().expect("a step").contact.force;
            let off = (force[0] + fx).abs().max((force[1] + fy).abs());
            assert!(off < 1e-9 * 2e5, "{force:?} {fx:e} {fy:e} {normal} {friction} {turn}");
            // All of the top moves alike, and with the push.
            let state = memory.states.last().expect("a state");
            let top = problem.mesh.facets["top"].node_list();
            let of = |node: u32| [state.u[2 * node as usize], state.u[2 * node as usize + 1]];
            let [ux, uy] = of(top[0]);
            assert!(top.iter().all(|&node| {
                let [x, y] = of(node);
                (x - ux).abs().max((y - uy).abs()) < 1e-12 * ux.hypot(uy)
            }));
            let along = c * ux + s * uy;
            let (down, round_off) = (c * uy - s * ux, 1e-9 * ux.hypot(uy));
            assert!(down < 0.0 && if push > 0.0 { along > round_off } else { along.abs() <= round_off }, "{along:e}");
        }
    }
}
