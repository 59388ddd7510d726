//! Parts that nothing but contact holds: ties, stiff and soft parts, motions that nothing determines, and loads that
//! nothing bears.

use crate::common;
use amontons::case::{self, Source};
use amontons::output::Memory;
use amontons::problem::Problem;
use amontons::run::{self, Settings};

fn problem(text: &str) -> Problem {
    case::parse(&Source::new("loose.toml", text), &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).problem
}

/// A run, or the reason why it has no end.
fn tried(problem: &Problem) -> Result<Memory, String> {
    let mut memory = Memory::new().states_every(1).reports();
    let settings = Settings { certificate: false, ..Settings::default() };
    run::run(problem, &settings, &mut [&mut memory]).map(|_| memory).map_err(|error| error.to_string())
}

/// Newton iterations, the vertical force on a contact, and the motions that nothing determines in the last step.
fn last(memory: &Memory, problem: &Problem, side: usize) -> (usize, f64, Vec<String>) {
    let report = memory.reports.last().expect("a step");
    let boundary = problem.contact_boundary();
    let contact = &problem.contacts[side];
    let of =
        |((point, state), weight): ((&amontons::contact::PointOnBoundary, &amontons::inclusion::PointState), &f64)| {
            if point.contact == side {
                -contact.sign() * weight * (state.pressure * state.normal[1] + state.q[1])
            } else {
                0.0
            }
        };
    let force = boundary.points.iter().zip(&report.contact.states).zip(&report.contact.weights).map(of).sum();
    let iterations = memory.reports.iter().map(|report| report.newton_mechanics).sum();
    (iterations, force, report.loose.clone())
}

/// A rod without density that nothing but a wall holds, by one node, stands at the wall when it is pressed on it, with
/// the pressure of the load: the stiffness of that node, condensed, is round-off, and tells nothing of the size of the
/// gap.
#[test]
fn a_loose_rod_stands_at_the_wall_that_it_is_pressed_on() {
    for (young, force, length) in [(1e3, 1.0, 1.0), (2e11, 3e4, 0.07), (1e-4, 1e-9, 50.0)] {
        for n in [1, 2, 7, 40] {
            for side in ["left", "right"] {
                let other = if side == "left" { "right" } else { "left" };
                let sign = if side == "left" { -1.0 } else { 1.0 };
                let text = format!(
                    "name = \"rod\"\nmesh = {{ kind = \"interval\", size = {length:?}, n = {n} }}\n\
                     time = {{ end = 1.0, steps = 2 }}\n[material]\ndensity = 0\n\
                     elasticity = {{ law = \"isotropic\", young = {young:?}, poisson = 0.0 }}\n\
                     [[boundary]]\non = \"{other}\"\nforce = [{:?}]\n\
                     [contact]\non = \"{side}\"\nnormal = {{ law = \"signorini\" }}\n",
                    sign * force
                );
                let problem = problem(&text);
                let memory = tried(&problem).unwrap_or_else(|error| panic!("{error}\n{text}"));
                let (state, report) = (&memory.states[2], memory.reports.last().expect("a step"));
                let at = |end: &str| if end == "left" { state.u[0] } else { state.u[n] };
                let shortened = force * length / young;
                assert!(at(side).abs() <= 1e-9 * shortened, "{text}\n{:e} at the wall", at(side));
                assert!((at(other) - sign * shortened).abs() <= 1e-9 * shortened, "{text}\n{:e}", at(other));
                let p = report.contact.states[0].pressure;
                assert!((p - force).abs() <= 1e-9 * force, "{text}\np = {p:e}");
            }
        }
    }
}

/// A lining tied to its plate, pressed on a plane by 1 MPa: a tie is linear. Without friction the upper edge comes down
/// by p (1 − ν²) h/E in plane strain and by p h/E in space and revolution.
#[test]
fn a_tie_between_parts_that_contact_holds_is_solved() {
    for (dim, revolution) in [(2, false), (2, true), (3, false)] {
        for elements in ["P1", "Q1", "P2", "Q2"] {
            for (friction, solver) in [(false, "direct"), (true, "direct"), (false, "iterative"), (true, "iterative")] {
                if dim == 3 && elements.ends_with('2') && solver == "iterative" {
                    continue;
                }
                let problem = problem(&tied(dim, revolution, elements, friction, solver));
                let memory =
                    tried(&problem).unwrap_or_else(|why| panic!("{why}: {dim} {elements} {friction} {solver}"));
                let (iterations, force, loose) = last(&memory, &problem, 1);
                let area = match (dim, revolution) {
                    (_, true) => std::f64::consts::PI * 4e-4,
                    (3, _) => 4e-4,
                    _ => 0.02,
                };
                assert!(iterations <= 15 && loose.is_empty(), "{iterations} {loose:?}: {dim} {elements} {friction}");
                assert!((force - 1e6 * area).abs() < 1e-6 * 1e6 * area, "{force}");
                let u = &memory.states.last().expect("a state").u;
                let down = u.iter().skip(1).step_by(dim).fold(0.0, |least: f64, u| least.min(*u));
                let exact = if dim == 2 && !revolution { -1.82e-5 } else { -2e-5 };
                if !friction {
                    assert!((down - exact).abs() < 1e-9 * exact.abs(), "{down:e}: {dim} {elements} {solver}");
                }
            }
        }
    }
}

fn tied(dim: usize, revolution: bool, elements: &str, friction: bool, solver: &str) -> String {
    let (size, high, n) = if dim == 3 {
        ("[0.02, 0.01, 0.02]", "[0, 0.01, 0]", "[3, 2, 2]")
    } else {
        ("[0.02, 0.01]", "[0, 0.01]", "[4, 2]")
    };
    let state = if dim == 3 || revolution { "" } else { ", stress_state = \"plane-strain\"" };
    let sides: &[&str] = if dim == 3 { &["left", "back"] } else { &["left"] };
    let mut text = format!(
        "name = \"tied\"\n[mesh]\nkind = \"blocks\"\naxisymmetric = {revolution}\nblocks = [\n\
         {{ name = \"lower\", size = {size}, n = {n}, elements = \"{elements}\" }},\n\
         {{ name = \"upper\", size = {size}, origin = {high}, n = {n}, elements = \"{elements}\" }},\n]\n\
         [time]\nend = 1.0\nsteps = 1\n[material]\ndensity = 0\n\
         elasticity = {{ law = \"isotropic\", young = 1e9, poisson = 0.3{state} }}\n[solver]\nsolver = \"{solver}\"\n\
         [[boundary]]\non = \"upper_top\"\npressure = 1e6\n\
         [[contact]]\non = \"lower_top\"\nwith = \"upper_bottom\"\nnormal = {{ law = \"bilateral\" }}\n\
         friction = {{ law = \"stick\" }}\n[[contact]]\non = \"lower_bottom\"\nnormal = {{ law = \"signorini\" }}\n"
    );
    if friction {
        text += "friction = { law = \"coulomb\", coefficient = 0.3 }\n";
    }
    for side in sides {
        for body in ["lower", "upper"] {
            text += &format!("[[boundary]]\non = \"{body}_{side}\"\nnormal_displacement = 0\n");
        }
    }
    text
}

/// A soft layer below a plate that is up to 10⁸ times as stiff, pressed on a plane by 1 kN that friction does not see:
/// the foundation bears the load, in one body and in two.
#[test]
fn a_stiff_plate_on_a_soft_layer_is_pressed() {
    for (ratio, elements) in [(1e2, "Q1"), (2e5, "P1"), (1e8, "Q1"), (1e8, "P2")] {
        let young = format!("\"if(y > 5e-3, {:e}, 1e9)\"", 1e9 * ratio);
        let text = format!(
            "name = \"plate\"\n[mesh]\nkind = \"rectangle\"\naxisymmetric = true\nsize = [10e-3, 15e-3]\n\
             origin = [10e-3, 0]\nn = [10, 15]\nelements = \"{elements}\"\n[time]\nend = 1.0\nsteps = 1\n[material]\n\
             density = 0\nelasticity = {{ law = \"isotropic\", young = {young}, poisson = 0.0 }}\n\
             [[boundary]]\non = \"top\"\nforce = [0, -1000]\n[contact]\non = \"bottom\"\n\
             normal = {{ law = \"signorini\" }}\nfriction = {{ law = \"coulomb\", coefficient = 0.4 }}\n\
             foundation_velocity = [0, 0, \"100*x\"]\n"
        );
        let problem = problem(&text);
        let memory = tried(&problem).unwrap_or_else(|why| panic!("{why}: {ratio:e} {elements}"));
        let (iterations, force, _) = last(&memory, &problem, 0);
        assert!(iterations <= 30 && (force - 1000.0).abs() < 1e-4, "{iterations}, {force}: {ratio:e} {elements}");
    }
}

/// A shaft lies without friction in a bore: it may turn. No point moves further than the clearance and the compression,
/// 16 µm.
#[test]
fn a_shaft_in_a_bore_does_not_turn_by_chance() {
    for (n, elements) in [("[4, 64]", "Q2"), ("[6, 48]", "Q1"), ("[3, 40]", "Q2")] {
        let text = format!(
            "name = \"shaft\"\n[mesh]\nkind = \"blocks\"\nblocks = [\n\
             {{ name = \"shaft\", radii = [0, 19.99e-3], n = {n}, elements = \"{elements}\" }},\n\
             {{ name = \"ring\", radii = [20e-3, 40e-3], n = {n}, elements = \"{elements}\" }},\n]\n\
             [time]\nend = 1.0\nsteps = 1\n[material]\ndensity = 0\n\
             elasticity = {{ law = \"isotropic\", young = 210e9, poisson = 0.3, stress_state = \"plane-strain\" }}\n\
             [[boundary]]\non = \"ring_outer\"\ndisplacement = [0, 0]\n\
             [[boundary]]\nat = [0, 0]\ndisplacement = [0, \"free\"]\n\
             [load]\nbody_force = [0, \"if(x^2 + y^2 < 0.0004, -7.957747e8*t, 0)\"]\n\
             [contact]\non = \"shaft_outer\"\nwith = \"ring_inner\"\ngap = \"10 µm\"\nnormal = {{ law = \"signorini\" }}\n"
        );
        let problem = problem(&text);
        let memory = tried(&problem).unwrap_or_else(|why| panic!("{why}: {n} {elements}"));
        let (_, _, loose) = last(&memory, &problem, 0);
        assert_eq!(loose, ["body `shaft` turns about (0, 0)"], "{n} {elements}");
        let moved = common::largest(&memory.states.last().expect("a state").u);
        assert!(moved < 1.8e-5, "{moved:e}: {n} {elements}");
    }
}

/// Shaft and ring of a press fit may turn together about their axis; Lamé's pressure, 63 MPa.
#[test]
fn a_press_fit_turns_as_a_whole_or_not_at_all() {
    let text = "name = \"fit\"\n[mesh]\nkind = \"blocks\"\nblocks = [\n\
         { name = \"shaft\", radii = [0, 20e-3], height = 0.02, n = [4, 64, 2], elements = \"Q1\" },\n\
         { name = \"ring\", radii = [20e-3, 25e-3], height = 0.02, n = [3, 56, 2], elements = \"Q1\" },\n]\n\
         [time]\nend = 1.0\nsteps = 1\n[material]\ndensity = 0\n\
         elasticity = { law = \"isotropic\", young = 70e9, poisson = 0.33 }\n\
         [[boundary]]\non = \"shaft_bottom\"\nnormal_displacement = 0\n[[boundary]]\non = \"ring_bottom\"\n\
         normal_displacement = 0\n[[boundary]]\nat = [0, 0, 0]\ndisplacement = [0, 0, \"free\"]\n\
         [contact]\non = \"ring_inner\"\nwith = \"shaft_outer\"\ngap = -1e-4\nnormal = { law = \"signorini\" }\n\
         friction = { law = \"coulomb\", coefficient = 0.1 }\n";
    let problem = problem(text);
    let memory = tried(&problem).unwrap_or_else(|why| panic!("{why}"));
    let (iterations, _, loose) = last(&memory, &problem, 0);
    assert!(iterations <= 20 && loose.len() == 1 && loose[0].contains("`ring`"), "{iterations} {loose:?}");
    let report = memory.reports.last().expect("a step");
    let (force, area) = report
        .contact
        .states
        .iter()
        .zip(&report.contact.weights)
        .fold((0.0, 0.0), |sum, (state, w)| (sum.0 + w * state.pressure, sum.1 + w));
    assert!((force / area - 63e6).abs() < 0.04 * 63e6, "{:e}", force / area);
}

/// One block on a plane, in space and in the plane, of any size and stiffness, turned.
fn block(young: f64, size: f64, turn: f64, more: &str) -> Problem {
    let text = format!(
        "name = \"block\"\n[mesh]\nkind = \"rectangle\"\nsize = [{:?}, {:?}]\nn = [4, 2]\n[time]\nend = 1\nsteps = 2\n\
         [material]\ndensity = 0\nelasticity = {{ law = \"isotropic\", young = {young:?}, poisson = 0.3, \
         stress_state = \"plane-strain\" }}\n[contact]\non = \"bottom\"\nnormal = {{ law = \"signorini\" }}\n{more}\n",
        2.0 * size,
        size
    );
    let (sine, cosine) = turn.sin_cos();
    common::changed(&problem(&text), |data| {
        let mut mesh = (*data.mesh).clone();
        mesh.points.iter_mut().for_each(|p| *p = [cosine * p[0] - sine * p[1], sine * p[0] + cosine * p[1], 0.0]);
        data.mesh = std::sync::Arc::new(mesh);
    })
}

/// A block that a pressure presses on a plane is solved, whatever its size; a load that is zero at first, or at all,
/// moves nothing.
#[test]
fn a_body_on_a_foundation_is_held_by_contact() {
    let friction = "friction = { law = \"coulomb\", coefficient = 0.3 }\n";
    for (young, size, turn) in [(1e9, 0.01, 0.0), (1e3, 10.0, 0.0), (1e9, 0.01, 0.6), (1e12, 1e-5, -2.0)] {
        for (law, solver) in [(friction, "direct"), ("", "direct"), (friction, "iterative"), ("", "iterative")] {
            for load in ["0", "1", "if(t < 0.6, 0, 1)"] {
                let pressure = format!("\"{:e}*({load})\"", 1e-4 * young);
                let more = format!(
                    "{law}[[boundary]]\non = \"top\"\npressure = {pressure}\n[solver]\nsolver = \"{solver}\"\n"
                );
                let problem = block(young, size, turn, &more);
                let memory = tried(&problem).unwrap_or_else(|why| panic!("{why}\n{more}{young:e} {turn}"));
                let report = memory.reports.last().expect("a step");
                let force = report.contact.force.iter().map(|f| f * f).sum::<f64>().sqrt();
                let expected = if load == "0" { 0.0 } else { 2e-4 * young * size };
                assert!((force - expected).abs() <= 1e-7 * young * 1e-4 * size, "{force:e} {expected:e}\n{more}");
                if load != "0" {
                    assert_eq!(report.loose.len(), usize::from(law.is_empty()), "{:?}", report.loose);
                }
                let moved = common::largest(&memory.states.last().expect("a state").u);
                assert!(moved <= 2e-4 * size, "{moved:e} of {size:e}\n{more}");
            }
        }
    }
}

/// What drives a block and is not borne is said in words, after few iterations: to lift it, to slide it with and
/// without friction.
#[test]
fn a_load_that_nothing_bears_is_refused_in_words() {
    let friction = "friction = { law = \"coulomb\", coefficient = 0.3 }\n";
    let press = "[[boundary]]\non = \"top\"\npressure = 1e5\n";
    let side = |load: &str| format!("{press}[[boundary]]\non = \"left\"\ntraction = [{load}, 0]\n");
    let lift = "[[boundary]]\non = \"top\"\npressure = -1e5\n".to_owned();
    for (law, load, words) in [
        (friction, lift.clone(), "the body moves along (0, 1)"),
        ("", lift, "the body moves along (0, 1)"),
        ("", side("1e3"), "the body moves along (1, 0)"),
        (friction, side("1e5"), "the body moves along (1, 0)"),
    ] {
        for solver in ["direct", "iterative"] {
            let problem = block(1e9, 0.01, 0.0, &format!("{law}{load}[solver]\nsolver = \"{solver}\"\n"));
            let why = tried(&problem).map(|_| ()).expect_err("a refusal");
            assert!(why.contains(words) && why.contains("a load drives"), "{why}\n{load}");
        }
    }
    let borne = block(1e9, 0.01, 0.0, &format!("{friction}{}", side("1e4")));
    let memory = tried(&borne).unwrap_or_else(|why| panic!("{why}"));
    let force = memory.reports.last().expect("a step").contact.force;
    assert!((force[0] + 100.0).abs() < 1e-6 && (force[1] - 2000.0).abs() < 1e-6, "{force:?}");
}

/// A frictionless block that a foundation, or a plate, pushes through its clearance moves as far as it is pushed and
/// bears nothing: no load drives it along the planes, which is said.
#[test]
fn a_block_is_pushed_through_its_clearance() {
    let law = "normal = { law = \"signorini\" }\n";
    let material = "[material]\ndensity = 0\nelasticity = { law = \"isotropic\", young = 2e9, poisson = 0.3, \
                    stress_state = \"plane-strain\" }\n";
    let founded = |friction: &str| {
        format!(
            "name = \"pushed\"\n[mesh]\nkind = \"rectangle\"\nsize = [0.02, 0.02]\nn = [2, 2]\nelements = \"Q1\"\n\
             [time]\nend = 1\nsteps = 1\n{material}[[contact]]\non = \"top\"\ngap = \"1e-4 - 1.5e-4*t\"\n{law}\
             {friction}[[contact]]\non = \"bottom\"\ngap = 1e-4\n{law}"
        )
    };
    let between = |friction: &str| {
        format!(
            "name = \"pushed\"\n[mesh]\nkind = \"blocks\"\nblocks = [\n\
             {{ name = \"low\", size = [0.06, 0.01], n = [12, 2], origin = [-0.03, -0.0201], elements = \"Q1\" }},\n\
             {{ name = \"block\", size = [0.02, 0.02], n = [4, 4], origin = [-0.01, -0.01], elements = \"Q1\" }},\n\
             {{ name = \"high\", size = [0.06, 0.01], n = [13, 2], origin = [-0.03, 0.0101], elements = \"Q1\" }},\n]\n\
             [time]\nend = 1\nsteps = 1\n{material}[[boundary]]\non = \"low_bottom\"\ndisplacement = [0, 0]\n\
             [[boundary]]\non = \"high_top\"\ndisplacement = [0, -1.5e-4]\n\
             [[contact]]\non = \"low_top\"\nwith = \"block_bottom\"\n{law}{friction}\
             [[contact]]\non = \"high_bottom\"\nwith = \"block_top\"\n{law}{friction}"
        )
    };
    let friction = "friction = { law = \"coulomb\", coefficient = 0.3 }\n";
    for (text, rubs) in
        [(founded(""), false), (between(""), false), (founded(friction), true), (between(friction), true)]
    {
        for solver in ["direct", "iterative"] {
            let problem = problem(&format!("{text}[solver]\nsolver = \"{solver}\"\n"));
            let memory = tried(&problem).unwrap_or_else(|why| panic!("{why}\n{text}"));
            let (state, report) = (memory.states.last().expect("a state"), memory.reports.last().expect("a step"));
            let inside = |x: &[f64; 3]| !text.contains("block") || (x[0].abs() < 0.0101 && x[1].abs() < 0.01005);
            let nodes = problem.mesh.points.iter().enumerate().filter(|(_, x)| inside(x));
            for (i, _) in nodes {
                // Between plates a block may also tilt within the clearance that is left.
                let least = if text.contains("block") { -1e-4 } else { -5e-5 };
                let [x, y] = [state.u[2 * i], state.u[2 * i + 1]];
                assert!((least - 1e-12..=-5e-5 + 1e-12).contains(&y) && x.abs() < 1e-4, "{x:e} {y:e} {solver}\n{text}");
            }
            let force = report.contact.force.iter().map(|f| f.abs()).fold(0.0, f64::max);
            assert!(force < 1e-4, "{force:e} of 2e9 N/m {solver}\n{text}");
            if !rubs {
                assert!(!report.loose.is_empty(), "nothing holds the block along the planes\n{text}");
            }
        }
    }
}
