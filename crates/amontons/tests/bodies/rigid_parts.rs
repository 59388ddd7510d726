//! Sides and regions that move as rigid bodies under a given force and moment: closed forms, turned at random, in the
//! plane and in space, by a factor and by an iteration.

use std::sync::Arc;

use amontons::case::{self, Source};
use amontons::expression::Expression;
use amontons::field::Field;
use amontons::linalg::{Backend, Multigrid, Supernodal};
use amontons::output::Memory;
use amontons::problem::{BoundaryCondition, Problem, RigidPart};
use amontons::state::State;
use amontons::step::{March, Scheme};
use amontons::tensor::{Point, Rotation, Sym, dot, length};

use crate::common::{Random, changed, solve, told};

fn problem(text: &str) -> Problem {
    case::parse(&Source::new("rigid.toml", text), &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).problem
}

fn backends() -> [(&'static str, Arc<dyn Backend>); 2] {
    [("factor", Arc::new(Supernodal)), ("iteration", Arc::new(Multigrid::default()))]
}

/// A rotation of the space of a body, its inverse, and a shift.
type Place = ([Rotation; 2], Point);

fn place(random: &mut Random, dim: usize) -> Place {
    let angle = 3.0 * random.number();
    let axis = if dim == 3 { [random.number(), random.number(), 1.0] } else { [0.0, 0.0, 1.0] };
    let shift = std::array::from_fn(|c| if c < dim { 5.0 * random.number() } else { 0.0 });
    ([Rotation::about(&axis, angle), Rotation::about(&axis, -angle)], shift)
}

/// The problem with its mesh, its body forces and what acts on its rigid parts turned and moved.
fn elsewhere(problem: &Problem, ([rotation, _], shift): &Place, backend: Arc<dyn Backend>) -> Problem {
    let dim = problem.mesh.dim;
    let turned = |fields: &[Field]| -> Vec<Field> {
        let v: Point = std::array::from_fn(|c| fields.get(c).map_or(0.0, |field| field.value(&[0.0; 3], 0.0)));
        let v = rotation.vector(&v);
        fields.iter().enumerate().map(|(c, _)| v[c].into()).collect()
    };
    let moved = |x: &Point| -> Point {
        let x = rotation.vector(x);
        std::array::from_fn(|c| x[c] + shift[c])
    };
    changed(problem, |data| {
        for x in &mut Arc::make_mut(&mut data.mesh).points {
            *x = moved(x);
        }
        for part in &mut data.rigid {
            part.force = turned(&part.force);
            if dim == 3 {
                part.moment = turned(&part.moment);
            }
            part.at = part.at.as_ref().map(&moved);
        }
        data.body_force = turned(&data.body_force);
        data.backend = backend;
    })
}

fn at(state: &State, dim: usize, node: usize) -> Point {
    std::array::from_fn(|c| if c < dim { state.u[node * dim + c] } else { 0.0 })
}

fn cross(a: &Point, b: &Point) -> Point {
    std::array::from_fn(|c| a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3])
}

fn last(memory: &Memory) -> &State {
    memory.states.last().expect("a state")
}

/// A step without inertia of an elastic body; `flat` is the stress state of a plane one.
fn statics(young: f64, poisson: f64, flat: &str) -> String {
    format!(
        "[time]\nend = 1.0\nsteps = 1\n[material]\ndensity = 0\nelasticity = {{ law = \"isotropic\", young = {young:?}, poisson = {poisson:?}{flat} }}"
    )
}

/// A cantilever of length 2 and height 1 (and depth 1), E = 1000, ν = 0, held at its left end. The right end is rigid.
fn cantilever(dim: usize, rigid: &str) -> String {
    let (mesh, flat, held) = if dim == 3 {
        ("kind = \"box\"\nsize = [2.0, 1.0, 1.0]\nn = [3, 2, 2]\nelements = \"Q2\"", "", "[0, 0, 0]")
    } else {
        (
            "kind = \"rectangle\"\nsize = [2.0, 1.0]\nn = [4, 2]\nelements = \"Q2\"",
            ", stress_state = \"plane-stress\"",
            "[0, 0]",
        )
    };
    format!(
        r#"name = "cantilever"
units = "dimensionless"
[mesh]
{mesh}
{}
[[boundary]]
on = "left"
displacement = {held}
[[rigid]]
on = "right"
{rigid}
"#,
        statics(1000.0, 0.0, flat)
    )
}

/// Pure bending and tension are exact with Q2 and ν = 0: the end turns by M L/(E I) and moves by F L/(E A), whatever
/// the direction, the place at which the force acts adding its moment.
#[test]
fn an_end_is_bent_and_pulled() {
    let mut random = Random(5);
    let (young, l) = (1000.0, 2.0);
    for dim in [2, 3] {
        let (rigid, force, moment): (&str, Point, Point) = if dim == 3 {
            // F at (2, 0.7, 0.4): the moment r × F about the centre of the side (2, 0.5, 0.5) comes to that given.
            ("force = [3, 0, 0]\nmoment = [0, 0.5, -0.25]\nat = [2, 0.7, 0.4]", [3.0, 0.0, 0.0], [0.0, 0.2, -0.85])
        } else {
            ("force = [3, 0]\nmoment = [0.5]\nat = [2, 0.7]", [3.0, 0.0, 0.0], [0.0, 0.0, -0.1])
        };
        let problem = problem(&cantilever(dim, rigid));
        for (name, backend) in backends() {
            let place = place(&mut random, dim);
            let turned = elsewhere(&problem, &place, backend);
            let memory = solve(&turned);
            let ([rotation, _], _) = &place;
            // u(x) on the end: F L/(EA) along the axis, and of each moment rotation M L/(EI) about the centre line with
            // the deflection of the end M L²/(2EI).
            let centre = [2.0, 0.5, if dim == 3 { 0.5 } else { 0.0 }];
            let inertia = 1.0 / 12.0;
            let omega: Point = moment.map(|m| m * l / (young * inertia));
            let shift = cross(&omega, &[l / 2.0, 0.0, 0.0]);
            for node in problem.mesh.facets["right"].node_list() {
                let x = problem.mesh.points[node as usize];
                let arm: Point = std::array::from_fn(|c| x[c] - centre[c]);
                let turn = cross(&omega, &arm);
                let u: Point = std::array::from_fn(|c| force[c] * l / young + shift[c] + turn[c]);
                let (found, u) = (at(last(&memory), dim, node as usize), rotation.vector(&u));
                let off: Point = std::array::from_fn(|c| found[c] - u[c]);
                assert!(length(&off) < 1e-9 * length(&u), "{dim} {name}: {found:?} {u:?}");
            }
            // Its work is that of the loads, and the balance closes.
            let ledger = &last(&memory).ledger;
            assert!(ledger.closing_error.abs() < 1e-11 * ledger.turned_over, "{dim} {name}");
            let omega_work = dot(&moment, &omega);
            let centre_work = force[0] * force[0] * l / young;
            assert!((ledger.load_work - omega_work - centre_work).abs() < 1e-9 * ledger.load_work, "{dim} {name}");
        }
    }
}

/// The half of a symmetric body has what the whole has: its rigid side ends in the plane of symmetry, and is guided.
#[test]
fn a_plane_of_symmetry_holds_a_rigid_side() {
    let text = |width: f64, n: usize, origin: f64, force: f64, left: &str| {
        format!(
            r#"name = "half"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [{width}, 1.0]
origin = [{origin}, 0]
n = [{n}, 6]
elements = "P2"
diagonal = "crossed"
[time]
end = 1.0
steps = 1
[material]
density = 0
elasticity = {{ law = "isotropic", young = 10, poisson = 0.3, stress_state = "plane-strain" }}
[[boundary]]
on = "bottom"
displacement = [0, 0]
{left}
[[rigid]]
on = "top"
force = [0, {force}]
guided = true
"#
        )
    };
    let half = problem(&text(1.0, 6, 0.0, -1.0, "[[boundary]]\non = \"left\"\nnormal_displacement = 0"));
    let whole = problem(&text(2.0, 12, -1.0, -2.0, ""));
    let (a, b) = (solve(&half), solve(&whole));
    for (i, x) in half.mesh.points.iter().enumerate() {
        let other = whole.mesh.points.iter().position(|y| length(&std::array::from_fn(|c| x[c] - y[c])) < 1e-12);
        let [u, v] = [at(last(&a), 2, i), at(last(&b), 2, other.expect("the node"))];
        assert!(length(&std::array::from_fn(|c| u[c] - v[c])) < 1e-11, "{x:?} {u:?} {v:?}");
    }
    // The top is flat.
    let top: Vec<f64> =
        half.mesh.facets["top"].node_list().iter().map(|&node| at(last(&a), 2, node as usize)[1]).collect();
    assert!(top.iter().all(|u| (u - top[0]).abs() < 1e-14) && top[0] < -0.01, "{top:?}");
}

/// A rigid block on a layer of springs: p(x) = F/A + F e x/I, linear, and where the force acts outside the core the
/// block lifts off, with the resultant of what presses below the force.
fn block(dim: usize, eccentricity: f64, more: &str) -> String {
    let (mesh, flat, at, force) = if dim == 3 {
        (
            "blocks = [{ name = \"block\", size = [1.0, 0.5, 1.0], n = [8, 2, 8], origin = [-0.5, 0, -0.5], elements = \"Q1\" }]",
            "",
            format!("[{eccentricity}, 0.3, {}]", -0.5 * eccentricity),
            "[0, -2, 0]",
        )
    } else {
        (
            "blocks = [{ name = \"block\", size = [1.0, 0.5], n = [64, 4], origin = [-0.5, 0] }]",
            ", stress_state = \"plane-strain\"",
            format!("[{eccentricity}, 0.3]"),
            "[0, -2]",
        )
    };
    format!(
        r#"name = "block"
units = "dimensionless"
[mesh]
kind = "blocks"
{mesh}
{}
[[rigid]]
on = "block"
force = {force}
at = {at}
[contact]
on = "block_bottom"
{more}
"#,
        statics(1000.0, 0.3, flat)
    )
}

#[test]
fn a_rigid_block_on_springs_leans() {
    let mut random = Random(3);
    let springs = "normal = { law = \"compliance\", stiffness = 50 }";
    for (dim, e) in [(2, 0.1), (2, -0.16), (3, 0.1), (3, -0.1)] {
        let problem = problem(&block(dim, e, springs));
        for (name, backend) in backends() {
            let place = place(&mut random, dim);
            let turned = elsewhere(&problem, &place, backend);
            let memory = solve(&turned);
            let report = &memory.reports.last().expect("a report").contact;
            let points = &problem.contact_boundary().points;
            let weights: Vec<f64> = points.iter().map(|point| point.weight).collect();
            let second = |c: usize| {
                points.iter().zip(&weights).map(|(point, weight)| weight * point.x[c] * point.x[c]).sum::<f64>()
            };
            let inertia = if dim == 3 { [second(0), second(2)] } else { [second(0), f64::INFINITY] };
            for (point, state) in points.iter().zip(report.states.iter()) {
                let p = 2.0 * (1.0 + e * point.x[0] / inertia[0] - 0.5 * e * point.x[2] / inertia[1]);
                assert!((state.pressure - p).abs() < 1e-9, "{dim} {e} {name}: {} {p}", state.pressure);
            }
        }
    }
}

/// Outside the core of the section three times the distance of the force from the edge presses, with twice the mean
/// pressure at the edge: of first order in the mesh.
#[test]
fn a_rigid_block_lifts_off() {
    let e = 0.3;
    let springs =
        "normal = { law = \"compliance\", stiffness = 50 }\nfriction = { law = \"coulomb\", coefficient = 0.5 }";
    let error = |n: usize| {
        let text = block(2, e, springs).replace("n = [64, 4]", &format!("n = [{n}, 4]"));
        let memory = solve(&problem(&text));
        let report = &memory.reports.last().expect("a report").contact;
        let most = report.states.iter().map(|state| state.pressure).fold(0.0, f64::max);
        let sum: f64 = report.states.iter().zip(&report.weights).map(|(s, w)| s.pressure * w).sum();
        assert!((sum - 2.0).abs() < 1e-10, "{sum}");
        (most - 2.0 * 2.0 / (3.0 * (0.5 - e))).abs()
    };
    let errors = [32, 64, 128].map(error);
    assert!(errors[2] < 0.02 && errors[0] > 2.5 * errors[2], "{errors:?}");
}

/// A block that a point holds as a hinge: the springs below bear the moment about it, and the hinge the rest.
#[test]
fn a_point_is_a_hinge() {
    let more = r#"normal = { law = "bilateral-springs" }"#;
    let springs = r#"normal = { law = "compliance", stiffness = 50 }"#;
    let text = block(2, 0.2, more).replace(more, springs).replace("force = [0, -2]", "force = [0, -2]\nmoment = [0.3]");
    let text = text
        + "[[boundary]]\nat = [-0.5, 0]\ndisplacement = [0, 0]\n[[probe]]\nname = \"hinge\"\nquantity = \"reaction_y\"\nat = [-0.5, 0]\n";
    let problem = problem(&text);
    let memory = solve(&problem);
    let report = &memory.reports.last().expect("a report").contact;
    // θ = M/(c Σ ω x²), x from the hinge, M = −2·0.7 + 0.3.
    let points = &problem.contact_boundary().points;
    let second: f64 = points.iter().map(|point| point.weight * (point.x[0] + 0.5) * (point.x[0] + 0.5)).sum();
    let theta = (-2.0 * 0.7 + 0.3) / (50.0 * second);
    for (point, state) in points.iter().zip(report.states.iter()) {
        assert!((state.pressure + 50.0 * theta * (point.x[0] + 0.5)).abs() < 1e-10, "{}", state.pressure);
    }
    let pressed: f64 = points.iter().zip(report.states.iter()).map(|(point, s)| point.weight * s.pressure).sum();
    let reaction: f64 = held_force(&memory, &problem);
    assert!((reaction + pressed - 2.0).abs() < 1e-10, "{reaction} {pressed}");
}

/// The resultant along y of what holds the first rigid body, by the motions that are prescribed.
fn held_force(memory: &Memory, problem: &Problem) -> f64 {
    let space = problem.displacement_space();
    let body = &space.rigid[0];
    let force = &memory.reports.last().expect("a report").reactions.force;
    let along = |j: usize| (0..body.nodes.len()).map(|i| body.at(i).nth(j).expect("a motion")[1]).sum::<f64>();
    (0..body.held).map(|j| force[j] * along(j)).sum()
}

fn punch(dim: usize, bearing: &str) -> String {
    let (blocks, flat, held, force, moment) = if dim == 3 {
        (
            "{ name = \"base\", size = [1.0, 0.5, 1.0], n = [6, 3, 6], origin = [-0.5, -0.5, -0.5] },\n{ name = \"punch\", size = [0.5, 0.25, 0.5], n = [4, 2, 4], origin = [-0.25, 0, -0.25] }",
            "",
            "[0, 0, 0]",
            "[0.02, -1, 0.01]",
            "[0.03, 0.01, 0.02]",
        )
    } else {
        (
            "{ name = \"base\", size = [1.0, 0.5], n = [12, 6], origin = [-0.5, -0.5] },\n{ name = \"punch\", size = [0.5, 0.25], n = [7, 3], origin = [-0.25, 0] }",
            ", stress_state = \"plane-strain\"",
            "[0, 0]",
            "[0.1, -1]",
            "[0.03]",
        )
    };
    format!(
        r#"name = "punch"
units = "dimensionless"
[mesh]
kind = "blocks"
blocks = [
{blocks}
]
{}
[[boundary]]
on = "base_bottom"
displacement = {held}
[[rigid]]
on = "punch"
force = {force}
moment = {moment}
[contact]
on = "punch_bottom"
with = "base_top"
nonmortar = "{bearing}"
normal = {{ law = "signorini" }}
friction = {{ law = "coulomb", coefficient = 0.4 }}
"#,
        statics(20.0, 0.3, flat)
    )
}

/// A punch that is a rigid region, pressed on a block by a force and a moment: it moves as a rigid body, what presses
/// is in balance with what is given, and the solution is the same in every direction and by both solvers, whichever
/// side of the pair bears the points.
#[test]
fn a_punch_is_pressed_by_a_force() {
    let mut random = Random(17);
    for dim in [2, 3] {
        for bearing in ["punch_bottom", "base_top"] {
            let problem = problem(&punch(dim, bearing));
            let mut first: Option<Vec<f64>> = None;
            for (name, backend) in backends() {
                let place = place(&mut random, dim);
                let turned = elsewhere(&problem, &place, backend);
                let memory = solve(&turned);
                let (state, what) = (last(&memory), format!("{dim} {bearing} {name}"));
                let most = state.u.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
                assert_moves_rigidly(&turned, state, most);
                let force = memory.reports.last().expect("a report").contact.force;
                let given = |c: usize| turned.rigid[0].force.get(c).map_or(0.0, |f| f.value(&[0.0; 3], 0.0));
                assert!((0..3).all(|c| (force[c] + given(c)).abs() < 1e-8), "{what}: {force:?}");
                let back = |node: usize| place.0[1].vector(&at(state, dim, node)).into_iter().take(dim);
                let local: Vec<f64> = (0..problem.mesh.points.len()).flat_map(back).collect();
                let first = first.get_or_insert_with(|| local.clone());
                let off = local.iter().zip(&*first).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(off < 1e-7 * most, "{what}: {off} of {most}");
            }
            if dim == 2 {
                assert_moved_bears(&problem);
            }
        }
    }
}

/// All nodes of the rigid part have the displacement of a rigid body.
fn assert_moves_rigidly(problem: &Problem, state: &State, most: f64) {
    let body = &problem.displacement_space().rigid[0];
    let mut projected = state.u.clone();
    body.enter(&mut projected);
    body.leave(&mut projected);
    assert!(projected.iter().zip(state.u.iter()).all(|(a, b)| (a - b).abs() < 1e-12 * most));
    // It has no strain, not even that of the round-off of its displacements.
    let values = amontons::output::cell_values(problem, state);
    let cells = problem.mesh.blocks.iter().flat_map(|block| std::iter::repeat_n(block.region, block.len()));
    let rigid = values.iter().zip(cells).filter(|(_, region)| problem.mesh.regions[*region] == "punch");
    let strains: Vec<Sym> = rigid.map(|(value, _)| value.strain).collect();
    assert!(!strains.is_empty() && strains.iter().all(|strain| *strain == Sym::ZERO), "{strains:?}");
}

/// The punch moved by what it moves under its force bears the same tractions.
fn assert_moved_bears(problem: &Problem) {
    let memory = solve(problem);
    let state = last(&memory);
    let body = &problem.displacement_space().rigid[0];
    let mut q = state.u.clone();
    body.enter(&mut q);
    // u = Σ q_j m_j as expressions in x and y.
    let sum = |of: &dyn Fn(&Point) -> f64| -> f64 {
        body.motions.iter().enumerate().map(|(j, m)| q[body.dof(j)] * of(&m.at(&[0.0; 3]))).sum()
    };
    let turn: f64 = body.motions.iter().enumerate().map(|(j, m)| q[body.dof(j)] * m.turn[2]).sum();
    let [x, y] = [sum(&|m| m[0]), sum(&|m| m[1])];
    let field = |text: String| -> Field { Expression::parse(&text).expect("an expression").into() };
    let moved = changed(problem, |data| {
        data.rigid = vec![RigidPart::on("punch")];
        let on = |side: &str| {
            let mut condition = BoundaryCondition::on(side);
            condition.displacement =
                Some(vec![Some(field(format!("{x} - {turn}*y"))), Some(field(format!("{y} + {turn}*x")))]);
            condition
        };
        data.boundary.push(on("punch_top"));
    });
    let memory = solve(&moved);
    let force = memory.reports.last().expect("a report").contact.force;
    for (c, given) in [0.1, -1.0].into_iter().enumerate() {
        assert!((force[c] + given).abs() < 1e-7, "{force:?}");
    }
}

/// A rigid region falls and turns with the mass and the moment of inertia of its material: v_n = n k F/m of backward
/// Euler, and so the rotation.
#[test]
fn a_region_has_its_mass() {
    let text = r#"name = "free"
units = "dimensionless"
[mesh]
kind = "blocks"
blocks = [{ name = "body", size = [2.0, 1.0], n = [4, 2], elements = "Q2", origin = [-1, -0.5] }]
[time]
end = 1.0
steps = 10
[material]
density = 3
elasticity = { law = "isotropic", young = 1000, poisson = 0.3, stress_state = "plane-strain" }
[[rigid]]
on = "body"
force = [1.2, -0.6]
moment = [0.25]
"#;
    let problem = problem(text);
    let memory = solve(&problem);
    let (m, j) = (6.0, 6.0 * 5.0 / 12.0);
    for (n, state) in memory.states.iter().enumerate() {
        let t = 0.1 * n as f64;
        for (i, x) in problem.mesh.points.iter().enumerate() {
            let w = [1.2 / m * t - 0.25 / j * t * x[1], -0.6 / m * t + 0.25 / j * t * x[0]];
            assert!((0..2).all(|c| (state.w[2 * i + c] - w[c]).abs() < 1e-12), "{n}");
        }
    }
}

/// A run that goes on from a state has the same bits.
#[test]
fn a_resumed_run_is_the_same() {
    let springs = "normal = { law = \"signorini\" }\nfriction = { law = \"coulomb\", coefficient = 0.3 }";
    let text = block(2, 0.3, springs)
        .replace("end = 1.0\nsteps = 1", "end = 1.0\nsteps = 8")
        .replace("density = 0", "density = 1e-3")
        .replace("force = [0, -2]", "force = [\"0.4*sin(6*t)\", -2]");
    let problem = problem(&text);
    let mut scheme = March::new(&problem).expect("a scheme");
    let mut state = scheme.initial().expect("a state");
    for _ in 0..4 {
        state = scheme.step(&state).expect("a step").0;
    }
    let mut other = March::new(&problem).expect("a scheme");
    other.recall(&scheme.kept()).expect("what is kept");
    let mut again = state.clone();
    for _ in 0..4 {
        state = scheme.step(&state).expect("a step").0;
        again = other.step(&again).expect("a step").0;
        assert!(state.u.iter().zip(again.u.iter()).all(|(a, b)| a.to_bits() == b.to_bits()));
    }
}

/// Of a rigid part on a rigid foundation only the resultant is determined, and that is said.
#[test]
fn a_rigid_part_on_a_rigid_foundation_is_told_of() {
    let told = |law: &str| {
        let problem = problem(&block(
            2,
            0.1,
            &format!("normal = {{ law = \"{law}\"{} }}", if law == "compliance" { ", stiffness = 50" } else { "" }),
        ));
        let findings = amontons::hypotheses::findings(&problem);
        findings.into_iter().find(|finding| finding.id.as_str() == "rigid-on-rigid").map(|finding| finding.message)
    };
    let message = told("signorini").expect("a warning");
    assert!(message.contains("at 65 points only the resultant"), "{message}");
    assert_eq!(told("compliance"), None);
}

/// What is wrong with a rigid part is named.
#[test]
fn faults_are_named() {
    let text = cantilever(2, "force = [1, 0]");
    let said = |old: &str, new: &str| told(&Source::new("case.toml", text.replace(old, new)), &[]);
    for (old, new, expected) in [
        (
            "on = \"right\"",
            "on = \"rigt\"",
            "rigid[0].on: found \"rigt\", expected one of the sides and regions bottom, left, right, top, body",
        ),
        ("force = [1, 0]", "force = [1, 0, 0]", "rigid[0].force: found 3 components, expected 2 components"),
        ("force = [1, 0]", "moment = [1, 0]", "rigid[0].moment: found 2 components, expected 1 component"),
        (
            "force = [1, 0]",
            "force = [\"x\", 0]",
            "rigid[0].force: found an expression in x, y or z, expected a number or an expression in t: the force of the whole body",
        ),
        ("force = [1, 0]", "at = [1, 0, 0]", "rigid[0].at: found 3 coordinates, expected 2 coordinates"),
        (
            "force = [1, 0]",
            "force = [1, 0]\n[[rigid]]\non = \"top\"",
            "rigid[1].on: found \"top\", which has nodes of rigid[0], expected nodes of no other rigid part",
        ),
        (
            "force = [1, 0]",
            "[[boundary]]\non = \"right\"\ndisplacement = [\"y*y\", 0]",
            "boundary[1]: found a displacement of",
        ),
        (
            "force = [1, 0]",
            "mass = 3",
            "rigid[0].mass: found an unknown key, expected one of at, force, guided, moment, on",
        ),
    ] {
        let text = said(old, new);
        assert!(text.contains(expected) && text.lines().count() == 1, "{text}");
    }
}
