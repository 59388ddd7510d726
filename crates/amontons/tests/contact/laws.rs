//! The laws of contact in steps of the scheme: exactness of multivalued laws, limits, other programs, and convergence
//! without tuning.
#![allow(clippy::too_many_lines, clippy::too_many_arguments, reason = "a test is one list of cases")]

use std::sync::Arc;

use crate::common::{Random, checked, disturb, largest, paper};
use amontons::contact::{Bound, Cone, ContactPoint, FrictionLaw, Signorini, Status, Tresca};
use amontons::field::{Coefficient, Field};
use amontons::material::{Isotropic, StressState};
use amontons::mesh::{Elements, Mesh};
use amontons::problem::{BoundaryCondition, Initial, Problem};
use amontons::state::{State, StepReport};
use amontons::step::{March, Scheme};
use amontons::tensor::{Point, Rotation, Sym, dot, length};
use amontons::time::Rule;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};

fn scheme(overrides: &[&str]) -> (Problem, March) {
    let problem = paper(overrides).problem;
    let scheme = March::new(&problem).expect("a regular system");
    (problem, scheme)
}

/// The last state and all reports of a run.
fn run(problem: &Problem) -> (State, Vec<StepReport>) {
    let mut scheme = March::new(problem).expect("a regular system");
    let mut state = scheme.initial().expect("finite initial data");
    let mut reports = Vec::new();
    for _ in 0..problem.timeline.steps() {
        let (next, report) = scheme.step(&state).unwrap_or_else(|error| panic!("{error}"));
        (state, reports) = (next, {
            reports.push(report);
            reports
        });
    }
    (state, reports)
}

fn assert_identities(state: &State, what: &str) {
    let (energy, heat) = (state.ledger.relative_closing_error(), state.ledger.relative_heat_closing_error());
    assert!(energy.abs() < 1e-12 && heat.abs() < 1e-12, "{what}: energy {energy:e}, heat {heat:e}");
}

/// r ≤ 0, p ≥ 0, p r = 0 and the friction cone, to round-off.
fn assert_unilateral(report: &StepReport, mu: f64, displacement: f64) {
    let states = &report.contact.states;
    let highest = states.iter().fold(0.0f64, |m, s| m.max(s.pressure));
    let fastest = states.iter().fold(0.0f64, |m, s| m.max(length(&s.slip)));
    for s in states {
        assert!(s.pressure >= 0.0);
        let touching = s.penetration.abs() <= 1e-14 * displacement;
        assert!(
            touching || (s.penetration < 0.0 && s.pressure == 0.0),
            "penetration {:e} at the pressure {:e} of {highest:e}",
            s.penetration,
            s.pressure
        );
        assert!(length(&s.q) <= mu * s.pressure + 1e-10 * highest, "outside the cone");
        let speed = length(&s.slip);
        if speed > 1e-9 * fastest {
            assert!(
                (dot(&s.q, &s.slip) - mu * s.pressure * speed).abs() <= 1e-8 * highest * speed,
                "not against the slip"
            );
        }
        if s.status == Status::Stick {
            assert!(speed <= 1e-9 * fastest, "a stuck point moves at {speed:e} of {fastest:e}");
        }
    }
}

#[test]
fn signorini_is_exact_in_every_step() {
    for foundation in ["0", "10"] {
        let foundation = format!("contact.heat.foundation_temperature={foundation}");
        let (state, reports) =
            run(&paper(&["mesh.n=16", "time.steps=32", "contact.normal={law='signorini'}", &foundation]).problem);
        for report in &reports {
            assert_unilateral(report, 0.2, largest(&state.u));
        }
        let open = |r: &StepReport| r.contact.states.iter().filter(|s| s.pressure == 0.0).count();
        assert!(open(&reports[31]) > 0 && reports[31].contact.states.iter().any(|s| s.pressure > 0.0));
        assert_identities(&state, &foundation);
        assert!(state.ledger.contact_energy == 0.0);
    }
}

/// From random states, smooth and rough, steps with every law end.
#[test]
fn steps_with_every_law_converge_from_any_state() {
    let laws = [
        "contact.normal={law='signorini'}",
        "contact.normal={law='bilateral'}",
        "contact.normal={law='stop', stiffness=1e4, depth=1e-3}",
        "contact.normal={law='power', stiffness=1e6, exponent=1.5}",
        "contact.normal={law='damped', stiffness=1e4, damping=10}",
        "contact.normal={law='hunt-crossley', stiffness=1e4, damping=0.1}",
        "contact.normal={law='table', penetration=[0, 1e-4, 1e-3], pressure=[0, 1, 20]}",
        "contact.friction={law='tresca', bound=0.3}",
        "contact.friction={law='static-kinetic', static=0.3, kinetic=0.2}",
        "contact.friction={law='slip-rate', speed=[0, 0.1, 1], coefficient=[0.3, 0.2, 0.3]}",
        "contact.friction={law='pressure', pressure=[0, 1, 10], coefficient=[0.3, 0.3, 0.1]}",
        "contact.friction={law='temperature', temperature=[0, 10], coefficient=[0.3, 0.1]}",
        "contact.friction={law='coulomb', coefficient=0.2, cap=0.5}",
        "contact.friction={law='orthotropic', coefficients=[0.3, 0.1], direction=[1, 0]}",
    ];
    let mut random = Random(88_172_645_463_325_252);
    for law in laws {
        let (mut hardest, mut failed, mut made) = (0, 0, 0);
        let rigid = ["signorini", "bilateral", "stop"].iter().any(|name| law.contains(name));
        for quadrature in if rigid { &["nodal"][..] } else { &["nodal", "gauss"] } {
            for steps in [8, 64, 1024] {
                let (problem, mut scheme) = scheme(&[
                    "mesh.n=8",
                    &format!("time.steps={steps}"),
                    &format!("contact.quadrature={quadrature}"),
                    law,
                    "contact.heat.foundation_temperature=10",
                ]);
                let start = scheme.initial().expect("finite initial data");
                for trial in 0..10 {
                    let mut state = start.clone();
                    disturb(&mut state, &problem, &scheme, &mut random, trial % 2 == 0);
                    for _ in 0..2 {
                        made += 1;
                        let Ok((next, report)) = scheme
                            .step(&state)
                            .inspect_err(|e| println!("{law}, {quadrature}, N = {steps}, trial {trial}: {e}"))
                        else {
                            failed += 1;
                            break;
                        };
                        assert!(report.residual <= 1e-10);
                        if law.contains("signorini") {
                            assert_unilateral(&report, 0.2, largest(&next.u));
                        }
                        hardest = hardest.max(report.newton_mechanics);
                        state = State { step: 0, ..next };
                    }
                }
            }
        }
        println!("{law}: {made} steps, {hardest} iterations at the most, {failed} failed");
        assert_eq!(failed, 0, "{law}");
    }
}

/// Laws of which the iterations are counted: the name, the normal law and the friction law, for a stiffness and the
/// units of stress, length and time.
type Counted = (&'static str, fn(f64, [f64; 3]) -> String);
const COUNTED: [Counted; 5] = [
    ("coulomb", |c, _| {
        format!("normal={{law='compliance', stiffness={c:?}}}, friction={{law='coulomb', coefficient=0.2}}")
    }),
    ("static-kinetic", |c, _| {
        format!(
            "normal={{law='compliance', stiffness={c:?}}}, friction={{law='static-kinetic', static=0.3, kinetic=0.2}}"
        )
    }),
    ("decaying", |c, [_, length, time]| {
        let decay = 0.02 * length / time;
        format!(
            "normal={{law='compliance', stiffness={c:?}}}, friction={{law='static-kinetic', static=0.3, kinetic=0.2, decay_speed={decay:?}}}"
        )
    }),
    ("stop", |c, [_, length, _]| {
        format!(
            "normal={{law='stop', stiffness={c:?}, depth={:?}}}, friction={{law='coulomb', coefficient=0.2}}",
            1e-4 * length
        )
    }),
    ("signorini", |_, _| "normal={law='signorini'}, friction={law='coulomb', coefficient=0.2}".to_owned()),
];
const STEPS: usize = 16;

/// The same problem with compliances over twelve decades around E/L, and with five pairs of laws: no more iterations.
/// Without heat through the contact, which depends on the penetration, the stiffness is all that changes.
///
/// The bounds: an iteration that is not the last changes the state of a point or bends with a law that is not piecewise
/// linear. The first step decides on nine points: two decisions each (open or closed, slip or not) and two more are 20.
/// Later steps start from the pattern of the one before: one iteration finds the new pattern, one confirms it, and a
/// curved law takes two more, 4 per step. From 1e6 E/L on the foundation is rigid to five digits, and nothing changes
/// but for one iteration per step; what is found is Signorini's contact, at its price up to the same.
#[test]
fn table_of_iterations_over_stiffness() {
    let stress = 2.0; // E of the paper; L = 1.
    println!(
        "\niterations in {STEPS} steps (most in one)\n\nc_ν L/E  {}",
        COUNTED.map(|(name, _)| format!("{name:>16}")).concat()
    );
    let mut rows = Vec::new();
    for decade in -3..=9 {
        let c = stress * 10f64.powi(decade);
        let counts = COUNTED.map(|(name, law)| {
            let (state, _) = run(&with_law("[1.0, 1.0]", &law(c, [1.0; 3]), &["contact.heat={law='none'}".to_owned()]));
            assert_identities(&state, &format!("{name}, c_ν = {c:e}"));
            (state.counts.newton_mechanics_total, state.counts.newton_mechanics_max)
        });
        println!(
            "1e{decade:<+5}   {}",
            counts.map(|(total, most)| format!("{:>16}", format!("{total} ({most})"))).concat()
        );
        rows.push((decade, counts));
    }
    let rigid = rows[9].1;
    for (decade, counts) in &rows {
        for (((total, most), (at_1e6, _)), (name, _)) in counts.iter().zip(rigid).zip(COUNTED) {
            assert!(*total <= 4 * STEPS && *most <= 20, "{name} at 1e{decade}: {total}, {most} in one step");
            assert!(*decade < 6 || total.abs_diff(at_1e6) <= STEPS, "{name} at 1e{decade}: {total}, {at_1e6} at 1e6");
        }
        let [compliance, .., signorini] = counts.map(|(total, _)| total);
        assert!(
            *decade < 6 || compliance.abs_diff(signorini) <= STEPS,
            "1e{decade}: {compliance}, Signorini {signorini}"
        );
    }
}

/// The same problem in five systems of units and in five that nobody uses, over twelve decades of lengths, times and
/// masses: the same result to 1e-9, and the same iterations but for decisions within round-off, one in four steps.
#[test]
fn table_of_iterations_over_units() {
    let systems = [
        ("m, kg, s", [1.0, 1.0, 1.0]),
        ("mm, t, s", [1e3, 1.0, 1e-3]),
        ("µm, kg, s", [1e6, 1.0, 1.0]),
        ("km, kg, s", [1e-3, 1.0, 1.0]),
        ("cm, g, s", [1e2, 1.0, 1e3]),
        ("µm, g, ms", [1e6, 1e3, 1e3]),
        ("km, mg, Ms", [1e-3, 1e-6, 1e6]),
        ("µm, t, µs", [1e6, 1e6, 1e-3]),
        ("µm, kt, s", [1e6, 1.0, 1e-6]),
        ("Mm, kg, µs", [1e-6, 1e6, 1.0]),
    ];
    println!(
        "\niterations in {STEPS} steps (most in one), largest difference of u, w, θ\n\nunits       {}",
        COUNTED.map(|(name, _)| format!("{name:>24}")).concat()
    );
    let plain = COUNTED.map(|(_, law)| run(&with_law("[1.0, 1.0]", &law(1e4, [1.0; 3]), &[])).0);
    for (name, [length, time, mass]) in systems {
        let mut line = format!("{name:<12}");
        for ((what, law), one) in COUNTED.iter().zip(&plain) {
            let stress = mass / (length * time * time);
            let (scaled, _) = run(&in_units(&law(1e4 * stress / length, [stress, length, time]), length, time, mass));
            let error = |a: &[f64], b: &[f64], unit: f64| {
                largest(&a.iter().zip(b).map(|(a, b)| a / unit - b).collect::<Vec<_>>()) / largest(b)
            };
            let difference = largest(&[
                error(&scaled.u, &one.u, length),
                error(&scaled.w, &one.w, length / time),
                error(&scaled.theta, &one.theta, 1.0),
            ]);
            let (total, most) = (scaled.counts.newton_mechanics_total, scaled.counts.newton_mechanics_max);
            line += &format!("{:>24}", format!("{total} ({most}), {difference:.0e}"));
            assert!(difference < 1e-9, "{what} in {name}: {difference:e}");
            assert!(total.abs_diff(one.counts.newton_mechanics_total) <= STEPS / 4, "{what} in {name}: {total}");
        }
        println!("{line}");
    }
}

/// The paper's case with normal and friction law, on a small mesh.
fn with_law(size: &str, law: &str, more: &[String]) -> Problem {
    let (normal, friction) = law.split_once(", friction=").unwrap();
    let mut all = vec![
        "mesh.n=8".to_owned(),
        format!("time.steps={STEPS}"),
        format!("mesh.size={size}"),
        format!("contact.{normal}"),
        format!("contact.friction={friction}"),
        "contact.heat.foundation_temperature=10".to_owned(),
    ];
    all.extend_from_slice(more);
    paper(&all.iter().map(String::as_str).collect::<Vec<_>>()).problem
}

/// The problem with lengths, times and masses in other units, so many of which are the old one. Per unit of thickness a
/// stress is M/(L T²).
fn in_units(law: &str, length: f64, time: f64, mass: f64) -> Problem {
    let stress = mass / (length * time * time);
    let heat = stress; // ρ c θ is energy by volume; c = 1 has the unit of stress over temperature.
    let units = [
        format!("time.end={time:?}"),
        format!("material.density={:?}", mass / length.powi(3)),
        format!("material.heat_capacity={heat:?}"),
        format!("material.expansion=[[{stress:?}, {stress:?}], [{stress:?}, {stress:?}]]"),
        format!("material.coupling=[[{0:?}, {0:?}], [{0:?}, {0:?}]]", heat / time),
        format!("material.conductivity={:?}", heat * length * length / time),
        format!("material.elasticity.young={:?}", 2.0 * stress),
        format!("material.viscosity.first={:?}", 10.0 * stress * time),
        format!("material.viscosity.second={:?}", 10.0 * stress * time),
        format!("load.body_force=[0, {:?}]", -stress / length),
        format!("load.heat_source={:?}", heat / time),
        format!("boundary[1].traction=[{:?}, {:?}]", 1.4 * stress, 0.4 * stress),
        format!("boundary[2].traction=[{:?}, {:?}]", -0.8 * stress, 0.4 * stress),
        format!("contact.heat.conductance={:?}", heat * length / time),
        format!("contact.heat.width={:?}", 1e-5 * length),
    ];
    with_law(&format!("[{length:?}, {length:?}]"), law, &units)
}

/// The same problem turned by an angle: body, loads, and tensors.
fn turned(problem: Problem, angle: f64) -> Problem {
    let mut problem = problem.into_data();
    let turn = Rotation::in_plane(angle);
    let (sin, cos) = angle.sin_cos();
    let vector = |[a, b]: [f64; 2]| [cos * a - sin * b, sin * a + cos * b];
    let mut mesh = (*problem.mesh).clone();
    for x in &mut mesh.points {
        let [a, b] = vector([x[0], x[1]]);
        (x[0], x[1]) = (a, b);
    }
    problem.mesh = Arc::new(mesh);
    let fields = |v: &[Field]| -> Vec<Field> {
        let at = |c: usize| v[c].value(&[0.0; 3], 0.0);
        vector([at(0), at(1)]).map(Field::from).to_vec()
    };
    problem.body_force = fields(&problem.body_force);
    for side in &mut problem.boundary {
        side.traction = side.traction.as_ref().map(|traction| fields(traction));
    }
    for material in &mut problem.materials {
        let turned = |tensor: &Coefficient<Sym>| turn.tensor(&tensor.at(&[0.0; 3])).into();
        (material.expansion, material.coupling) = (turned(&material.expansion), turned(&material.coupling));
    }
    checked(problem)
}

/// The last displacement, velocity and temperature turned back.
fn turned_back(state: &State, angle: f64) -> [Vec<f64>; 3] {
    let (sin, cos) = angle.sin_cos();
    let back = |v: &[f64]| v.chunks_exact(2).flat_map(|v| [cos * v[0] + sin * v[1], cos * v[1] - sin * v[0]]).collect();
    [back(&state.u), back(&state.w), state.theta.clone()]
}

/// No direction is preferred: turned by large and by tiny angles, the problem with every pair of laws and a foundation
/// of any stiffness takes the same iterations, but for decisions within round-off, and finds the same, turned.
#[test]
fn table_of_iterations_over_angles() {
    println!(
        "\niterations in {STEPS} steps (most in one), largest difference of u, w, θ\n\nangle  c_ν L/E  {}",
        COUNTED.map(|(name, _)| format!("{name:>24}")).concat()
    );
    for decade in [1, 4, 9, 17] {
        let c = 2.0 * 10f64.powi(decade);
        let straight = COUNTED.map(|(_, law)| run(&with_law("[1.0, 1.0]", &law(c, [1.0; 3]), &[])).0);
        for degrees in [30.0, 1.0, 1e-6, 213.7] {
            let mut line = format!("{degrees:<6} 1e{decade:<7}");
            for ((what, law), one) in COUNTED.iter().zip(&straight) {
                let angle = f64::to_radians(degrees);
                let (state, _) = run(&turned(with_law("[1.0, 1.0]", &law(c, [1.0; 3]), &[]), angle));
                assert_identities(&state, &format!("{what}, c_ν = {c:e}, {degrees} degrees"));
                let error = |a: &[f64], b: &[f64]| {
                    largest(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>()) / largest(b)
                };
                let [u, w, theta] = turned_back(&state, angle);
                let difference = largest(&[error(&u, &one.u), error(&w, &one.w), error(&theta, &one.theta)]);
                let (total, expected) = (state.counts.newton_mechanics_total, one.counts.newton_mechanics_total);
                line +=
                    &format!("{:>24}", format!("{total} ({}), {difference:.0e}", state.counts.newton_mechanics_max));
                assert!(difference < 1e-10, "{what}, c_ν = {c:e}, turned by {degrees} degrees: {difference:e}");
                assert!(
                    10 * total.abs_diff(expected) <= expected,
                    "{what}, c_ν = {c:e}, turned by {degrees} degrees: {total} iterations for {expected}"
                );
            }
            println!("{line}");
        }
    }
}

/// Tresca's bound inside an ellipse of which the second axis is half of the first.
#[derive(Debug)]
struct Elliptic(f64);
const CONE: [f64; 2] = [1.0, 0.5];
impl FrictionLaw for Elliptic {
    fn bound(&self, at: &ContactPoint) -> Bound {
        Tresca { bound: self.0 }.bound(at)
    }
    fn lipschitz(&self, _l_nu: Option<f64>) -> Option<f64> {
        None
    }
    fn cone(&self, _x: &Point, nu: &Point) -> Option<Cone> {
        Some(Cone::new(nu, &[1.0, 0.0, 1.0], CONE))
    }
}

/// A block on a rigid foundation with given friction, from a state with random velocities.
fn block(dim: usize, friction: Arc<dyn FrictionLaw>) -> (Problem, March, State) {
    let mut problem = paper(&["time.steps=10", "mesh.n=5"]).problem.into_data();
    if dim == 3 {
        problem.mesh = Arc::new(Mesh::box_([1.0; 3], [3, 2, 3], Elements::P1).unwrap());
        problem.body_force = vec![0.0.into(), (-1.0).into(), 0.2.into()];
        let material = &mut problem.materials[0];
        material.elasticity = Isotropic::elastic(3, 2.0, 0.3, StressState::PlaneStrain).into();
        material.viscosity = Isotropic::lame(3, 0.1, 0.1, StressState::PlaneStrain).into();
        [material.expansion, material.coupling] = [Sym::ZERO; 2].map(Coefficient::from);
        material.conductivity = Sym([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]).into();
        let held = BoundaryCondition::on("top").displacement([0.0; 3]).temperature(0.0);
        problem.boundary = vec![held, BoundaryCondition::on("left").traction([1.4, 0.4, -0.7])];
        problem.initial =
            Initial { displacement: vec![0.0.into(); 3], velocity: vec![0.0.into(); 3], ..Initial::default() };
    }
    let contact = &mut problem.contacts[0];
    (contact.normal, contact.friction) = (Signorini.into(), friction.into());
    let problem = checked(problem);
    let scheme = March::new(&problem).expect("a regular system");
    let mut state = scheme.initial().unwrap();
    let mut random = Random(1234 + dim as u64);
    for (i, w) in state.w.iter_mut().enumerate() {
        *w = if scheme.discretization().v.free[i] { 0.3 * random.number() } else { 0.0 };
    }
    (problem, scheme, state)
}

/// A step with given friction is the minimum of ½ w·K w − r·w + Σ ω s ‖D w_τ‖ under r ≤ 0, which an interior-point
/// method for cone programs finds over all degrees of freedom: its minimum is not below that of the step by 1e-12 of
/// it. On a cone that is not round D is that of the law.
#[test]
fn given_friction_agrees_with_a_cone_program() {
    let mut seen = [0; 3];
    for (dim, elliptic, bound) in [(2, false, 0.1), (2, false, 1.0), (3, false, 0.1), (3, false, 1.0), (3, true, 0.3)] {
        let friction: Arc<dyn FrictionLaw> =
            if elliptic { Arc::new(Elliptic(bound)) } else { Arc::new(Tresca { bound }) };
        let (problem, mut scheme, state) = block(dim, Arc::clone(&friction));
        let (next, report) = scheme.step(&state).unwrap();
        let expected = minimum(&problem, &scheme, &state, &friction, bound, (&next.w, &report));
        let states = &report.contact.states;
        let count = |status| states.iter().filter(|s| s.status == status).count();
        let (stick, slip, open) =
            (count(Status::Stick), count(Status::Slip), states.iter().filter(|s| s.pressure == 0.0).count());
        let error = largest(&next.w.iter().zip(&expected).map(|(a, b)| a - b).collect::<Vec<_>>()) / largest(&expected);
        println!(
            "d = {dim}, elliptic: {elliptic}, s = {bound}: {stick} stick, {slip} slip, {open} open; difference {error:e}"
        );
        assert!(error < 1e-8, "d = {dim}: {error:e}");
        seen = [seen[0] + stick, seen[1] + slip, seen[2] + open];
    }
    assert!(seen.iter().all(|&n| n > 0), "the steps have to show sticking, slipping and open points: {seen:?}");
}

fn minimum(
    problem: &Problem,
    scheme: &March,
    state: &State,
    friction: &Arc<dyn FrictionLaw>,
    bound: f64,
    made: (&[f64], &StepReport),
) -> Vec<f64> {
    let (discrete, k, dim) = (scheme.discretization(), problem.timeline.longest(), scheme.discretization().mesh.dim);
    let w_of_step = made.0;
    let scaled = |slip: &Point, p: &amontons::contact::PointOnBoundary| {
        friction.cone(&p.x, &p.normal).map_or(*slip, |_| by_ellipse(slip))
    };
    let slips: Vec<f64> =
        made.1.contact.states.iter().zip(&discrete.boundary.points).map(|(s, p)| length(&scaled(&s.slip, p))).collect();
    let rho = problem.materials[0].density.at(&[0.0; 3]);
    let matrix = discrete.mechanical_matrix(Rule::backward_euler(k));
    let unknowns: Vec<usize> = (0..state.w.len()).filter(|&i| discrete.v.free[i]).collect();
    let of = |dof: usize| unknowns.binary_search(&dof).ok();
    let (mass_w, a_u) = (discrete.mass.apply(&state.w), discrete.apply_a(&state.u, &state.theta));
    let (load, thermal) = (discrete.f.at(k), discrete.m.apply(&state.theta));
    let right: Vec<f64> = unknowns.iter().map(|&i| load[i] + thermal[i] + rho / k * mass_w[i] - a_u[i]).collect();
    let points = &discrete.boundary.points;
    let (n, m) = (unknowns.len(), points.len());
    let size = n + m;
    let mut dense = vec![vec![0.0; size]; size];
    for (j, &dof) in unknowns.iter().enumerate() {
        let mut unit = vec![0.0; state.w.len()];
        unit[dof] = 1.0;
        let column = matrix.apply(&unit);
        for (i, &row) in unknowns.iter().enumerate().take(j + 1) {
            dense[i][j] = column[row];
        }
    }
    let mut q: Vec<f64> = right.iter().map(|r| -r).collect();
    q.extend(points.iter().map(|p| bound * p.weight));
    // Rows of A, with A x + slack = b: the slack is −r/k, then (τ, D w_τ) of each point.
    let (mut rows, mut b, mut cones) = (Vec::new(), Vec::new(), vec![SupportedConeT::NonnegativeConeT(m)]);
    let node = |p: &amontons::contact::PointOnBoundary| discrete.boundary.nodes[p.nodes[0].0] as usize;
    for p in points {
        let mut row = vec![0.0; size];
        let mut u_nu = 0.0;
        for c in 0..dim {
            u_nu += state.u[node(p) * dim + c] * p.normal[c];
            if let Some(i) = of(node(p) * dim + c) {
                row[i] = p.normal[c];
            }
        }
        rows.push(row);
        b.push(-u_nu / k);
    }
    for (i, p) in points.iter().enumerate() {
        cones.push(SupportedConeT::SecondOrderConeT(dim + 1));
        let mut first = vec![0.0; size];
        first[n + i] = -1.0;
        rows.push(first);
        for c in 0..dim {
            let mut row = vec![0.0; size];
            for e in 0..dim {
                let mut unit = [0.0; 3];
                unit[e] = 1.0;
                let tangential: Point = std::array::from_fn(|c| unit[c] - p.normal[e] * p.normal[c]);
                let scaled = friction.cone(&p.x, &p.normal).map_or(tangential, |_| by_ellipse(&tangential));
                if let Some(j) = of(node(p) * dim + e) {
                    row[j] = -scaled[c];
                }
            }
            rows.push(row);
        }
        b.extend(vec![0.0; dim + 1]);
    }
    // Steps of 0.99 of the way to the boundary leave the central path of cones that are not polyhedra: scalings get
    // bad, and the feasibility stalls at 1e-10 while the gap is 1e-15. Steps of 0.9 stay near it. Tolerances out of
    // reach let the iteration go on as far as round-off does.
    let (gap, feasible) = (1e-20, 1e-16);
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .max_step_fraction(0.9)
        .tol_gap_abs(gap)
        .tol_gap_rel(gap)
        .tol_feas(feasible)
        .build()
        .unwrap();
    let mut solver =
        DefaultSolver::new(&CscMatrix::from(&dense), &q, &CscMatrix::from(&rows), &b, &cones, settings).unwrap();
    solver.solve();
    let status = solver.solution.status;
    assert!(
        matches!(status, SolverStatus::Solved | SolverStatus::AlmostSolved | SolverStatus::InsufficientProgress),
        "{status:?}"
    );
    let (primal, dual) = (solver.solution.r_prim, solver.solution.r_dual);
    assert!(primal.max(dual) < 1e-10, "residuals of the cone program: {primal:e}, {dual:e}");
    let x = solver.solution.x;
    let objective = |x: &[f64]| {
        let product = |i: usize| (0..size).map(|j| dense[i.min(j)][i.max(j)] * x[j]).sum::<f64>();
        (0..size).map(|i| (0.5 * product(i) + q[i]) * x[i]).sum::<f64>()
    };
    let mut own: Vec<f64> = unknowns.iter().map(|&dof| w_of_step[dof]).collect();
    own.extend(slips);
    let [ours, theirs] = [objective(&own), objective(&x)];
    assert!(ours - theirs <= 1e-12 * theirs.abs(), "the minimum is {theirs:e}, and the step has {ours:e}");
    let mut w = vec![0.0; state.w.len()];
    for (x, &dof) in x.iter().zip(&unknowns) {
        w[dof] = *x;
    }
    w
}

/// D of [`Elliptic`] on the bottom, whose axes are (1, 0, 1)/√2 and (1, 0, −1)/√2.
fn by_ellipse(v: &Point) -> Point {
    let [a, b] = [CONE[0] * (v[0] + v[2]) / 2.0, CONE[1] * (v[0] - v[2]) / 2.0];
    [a + b, 0.0, a - b]
}

/// Over a foundation that moves both ways, with damping, tension and heat of friction: every term is in the audit, and
/// the share of the friction power that enters the body is the heat that does.
#[test]
fn the_audit_closes_over_a_moving_foundation() {
    for normal in [
        "{law='signorini'}",
        "{law='bilateral'}",
        "{law='stop', stiffness=1e3, depth=2e-4}",
        "{law='damped', stiffness=1e4, damping=50}",
        "{law='hunt-crossley', stiffness=1e4, damping=3}",
        "{law='softening', stiffness=1e4, peak=0.4, softening=100, residual=0.2}",
        "{law='adhesion', stiffness=1e3, strength=0.3, release=1e-3}",
    ] {
        let (state, reports) = run(&paper(&[
            "mesh.n=8",
            "time.steps=32",
            "contact.gap='0.002*sin(9*t)'",
            "contact.foundation_velocity=['0.05*cos(5*t)', 0]",
            "contact.frictional_heat=0.4",
            "contact.heat={law='none'}",
            &format!("contact.normal={normal}"),
        ])
        .problem);
        assert_identities(&state, normal);
        let ledger = &state.ledger;
        let slipped = reports.iter().flat_map(|r| &r.contact.states).filter(|s| s.status == Status::Slip).count();
        assert!(ledger.friction_dissipation > 0.0 && slipped > 0, "{normal}");
        assert!(
            (ledger.heat_contact + 0.4 * ledger.friction_dissipation).abs() <= 1e-12 * ledger.friction_dissipation,
            "{normal}"
        );
    }
}
