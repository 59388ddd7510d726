//! Steps with several solutions: which one is followed, when it is left, and what is said about it, against closed
//! forms.
#![allow(clippy::float_cmp, reason = "counts are exact")]

use crate::column::column;
use crate::common::{changed, paper};
use amontons::case::{self, Source};
use amontons::contact::{Compliance, Status};
use amontons::hypotheses::{self, Finding};
use amontons::problem::Problem;
use amontons::state::{State, StepReport};
use amontons::step::{March, Scheme};
use amontons::tensor::length;

/// A rod of length and section 1 whose left end moves by U(t) = t towards a layer at its right end.
const ROD: &str = body!(
    r#"kind = "interval", size = 1, n = 1"#,
    "end = 1, steps = 100",
    0,
    "young = 1, poisson = 0",
    r#"
viscosity = { law = "lame", first = 0, second = 0 }
heat_capacity = 1
conductivity = 1
[[boundary]]
on = "left"
displacement = ["t"]
[contact]
on = "right"
normal = { law = "softening", stiffness = 3, peak = 1, softening = 2, residual = 0.25 }
"#
);

/// The layer: c, peak P, s, residual R.
const LAYER: [f64; 4] = [3.0, 1.0, 2.0, 0.25];

pub fn rod(overrides: &[&str]) -> Problem {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    case::parse(&Source::new("rod", ROD), &overrides).unwrap_or_else(|error| panic!("{error}")).problem
}

pub fn scheme(problem: &Problem) -> (March, State) {
    let scheme = March::new(problem).expect("a regular system");
    let start = scheme.initial().expect("finite initial data");
    (scheme, start)
}

/// All states and reports of a run.
pub fn run(problem: &Problem) -> (Vec<State>, Vec<StepReport>) {
    let (mut scheme, start) = scheme(problem);
    let (mut states, mut reports) = (vec![start], Vec::new());
    for _ in 0..problem.timeline.steps() {
        let (state, report) = scheme.step(states.last().unwrap()).unwrap_or_else(|error| panic!("{error}"));
        states.push(state);
        reports.push(report);
    }
    (states, reports)
}

pub fn near(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found - expected).abs() <= tolerance, "{what}: found {found}, expected {expected}");
}

fn finding(findings: &[Finding], id: &str) -> Option<Finding> {
    findings.iter().find(|f| f.id.as_str() == id).cloned()
}

/// With E/L < s the branch on which the pressure rises ends at its peak, at U = P/c + P L/E, where the end of the rod
/// jumps to U − R L/E.
#[test]
fn a_soft_rod_follows_the_branch_to_its_limit_and_snaps() {
    let young = 1.0;
    let [c, peak, s, residual] = LAYER;
    assert!(young < s);
    // Both branches exist from U = top + (P − R)/s + R L/E on, where the residual pressure is reached, to the limit.
    let (first, limit) = (peak / c + (peak - residual) / s + residual / young, peak / c + peak / young);
    assert!(first < limit);
    for steps in [100, 101, 1000] {
        let problem = rod(&["time.end=2", &format!("time.steps={steps}")]);
        let (states, reports) = run(&problem);
        let mut between = 0;
        for (n, report) in reports.iter().enumerate() {
            let t = problem.timeline.time(n + 1);
            let follows = t <= limit;
            let r = if follows { young * t / (young + c) } else { t - residual / young };
            // Steps are refined down to a residual of 1e-11.
            near(report.contact.states[0].penetration, r, 1e-11, &format!("{steps} steps, t = {t}"));
            between += usize::from(t > first && follows);
            // The step over the limit is told, and no other; of its shortest parts one is ambiguous, beside it the
            // halves of 5 halvings.
            let snaps = !follows && problem.timeline.time(n) <= limit;
            assert_eq!(
                (report.is_ambiguous, report.parts),
                if snaps { (true, 6) } else { (false, 1) },
                "{steps} steps, t = {t}"
            );
        }
        println!("{steps} steps: {between} on the upper of two branches");
        let counts = &states.last().unwrap().counts;
        assert!(between > steps / 20);
        assert_eq!((counts.ambiguous_steps, counts.halved_steps), (1, 1));
    }
}

/// With E/L > s there is one path: through the falling branch, no step halved.
#[test]
fn a_stiff_rod_has_one_path() {
    let [c, peak, s, residual] = LAYER;
    let young = 1.1 * s;
    let problem = rod(&["time.end=2", "time.steps=1000", &format!("material.elasticity.young={young:?}")]);
    let (states, reports) = run(&problem);
    let (top, end) = (peak / c, peak / c + (peak - residual) / s);
    let mut falling = 0;
    for (n, report) in reports.iter().enumerate() {
        let u = problem.timeline.time(n + 1);
        let [rises, falls, stays] =
            [young * u / (young + c), (young * u - peak - s * top) / (young - s), u - residual / young];
        let r = if rises <= top {
            rises
        } else if falls <= end {
            falls
        } else {
            stays
        };
        falling += usize::from(r > top && r < end);
        near(report.contact.states[0].penetration, r, 1e-11, &format!("U = {u}"));
        assert!(!report.is_ambiguous && report.parts == 1);
    }
    let counts = &states.last().unwrap().counts;
    assert_eq!((counts.ambiguous_steps, counts.halved_steps), (0, 0));
    // The falling branch is passed while U moves by (P − R)(1/s − L/E) only.
    let width = (peak - residual) * (1.0 / s - 1.0 / young);
    assert!(
        falling.abs_diff((width / problem.timeline.longest()) as usize) <= 1,
        "{falling} steps on the falling branch of {width}"
    );
    let unique = finding(&hypotheses::full(&problem).findings, "step-unique").unwrap();
    assert!(unique.holds());
    let k = problem.timeline.longest();
    near(unique.value.unwrap(), young * k, 1e-12, "λ_min(S, W) = kE/L");
    near(unique.needed.unwrap(), s * k, 1e-12, "s k");
}

/// With the viscosity η the step is unique if (η + kE)/L > k s, that is for k below k* = η/(L s − E), and a part 2^−j
/// of it from there on.
#[test]
fn viscosity_resolves_the_snap_in_steps_below_the_threshold() {
    let (young, eta) = (1.0, 0.05);
    let [_, _, s, _] = LAYER;
    let threshold = eta / (s - young);
    // The steps that pass the falling branch, in parts of k/2^j < k*.
    for (ratio, parts, ambiguous) in
        [(0.99, 1, 0), (1.01, 2, 0), (1.99, 2, 0), (2.01, 3, 0), (31.0, 6, 0), (31.9, 6, 0), (32.1, 6, 1)]
    {
        let k = ratio * threshold;
        let end = 4.0;
        // A whole number of steps of length k.
        let steps = f64::ceil(end / k);
        let problem = rod(&[
            &format!("time.end={:?}", steps * k),
            &format!("time.steps={steps}"),
            &format!("material.viscosity.second={eta:?}"),
        ]);
        let (states, reports) = run(&problem);
        let counts = &states.last().unwrap().counts;
        let most = reports.iter().map(|r| r.parts).max().unwrap();
        println!(
            "k = {ratio} k*: {} halved, {} ambiguous, {most} parts at the most",
            counts.halved_steps, counts.ambiguous_steps
        );
        assert_eq!(counts.ambiguous_steps > 0, ambiguous > 0, "k = {ratio} k*");
        assert!(if parts == 1 { most == 1 } else { most >= parts }, "k = {ratio} k*: {most} parts");
        // The certificate has the same threshold.
        let findings = hypotheses::full(&problem).findings;
        assert_eq!(finding(&findings, "step-unique").unwrap().holds(), ratio < 1.0, "k = {ratio} k*");
        let needed = finding(&findings, "time-step").unwrap().needed.unwrap() / steps;
        assert_eq!(needed, f64::from(1u32 << parts_to_halvings(ratio)), "k = {ratio} k*");
    }
}

/// Least j with ratio/2^j < 1.
fn parts_to_halvings(ratio: f64) -> u32 {
    (0..32).find(|&j| ratio / f64::from(1u32 << j) < 1.0).unwrap()
}

/// A bond without a release length holds up to its strength σ, at U = −(σ/c + σ L/E), and is gone at once: no step is
/// short enough.
#[test]
fn a_bond_lets_go_at_its_strength() {
    let (young, c, strength) = (1.0, 4.0, 0.5);
    for viscosity in [0.0, 0.2] {
        let problem = rod(&[
            "boundary[0].displacement=['-t']",
            "contact.normal={law='adhesion', stiffness=4, strength=0.5}",
            &format!("material.viscosity.second={viscosity:?}"),
        ]);
        let (states, reports) = run(&problem);
        let limit = strength / c + strength / young;
        let let_go: Vec<usize> = (0..reports.len()).filter(|&n| reports[n].is_ambiguous).collect();
        assert_eq!(let_go.len(), 1, "viscosity {viscosity}");
        for (n, report) in reports.iter().enumerate() {
            let (p, r) = (report.contact.states[0].pressure, report.contact.states[0].penetration);
            if n < let_go[0] {
                near(p, c * r, 1e-13, "the bond");
                assert!(p >= -strength && report.parts == 1);
            } else {
                assert_eq!(p, 0.0, "after the bond");
            }
            if viscosity == 0.0 {
                assert_eq!(
                    n >= let_go[0],
                    problem.timeline.time(n + 1) > limit,
                    "t = {}",
                    problem.timeline.time(n + 1)
                );
                near(
                    r,
                    if n < let_go[0] {
                        -young * problem.timeline.time(n + 1) / (young + c)
                    } else {
                        -problem.timeline.time(n + 1)
                    },
                    1e-13,
                    "r",
                );
            }
        }
        assert_eq!(states.last().unwrap().counts.ambiguous_steps, 1);
        assert!(!finding(&hypotheses::findings(&problem), "softening").unwrap().holds());
    }
}

/// Friction that falls by f = 0.3 per unit of slip speed up to 1: with S = ρ/(3k) + kG < f p a step at the load 0.21 …
/// 0.4 has the solutions w = 0, w = (r̂ − 0.1)/S and one in between. The point stays on the one that it was on.
#[test]
fn a_point_stays_stuck_or_fast_where_both_are_solutions() {
    let (k, shear) = (10.0, 1e-3);
    let s = 1.0 / k + k * shear;
    assert!(s < 0.3);
    let block = |force: f64, velocity: f64| {
        column(&[
            "time.end=50",
            "time.steps=5",
            "material.viscosity.second=0",
            "material.elasticity.young=2e-3",
            "contact.friction={law='slip-rate', speed=[0, 1], coefficient=[0.4, 0.1]}",
            "contact.frictional_heat=0",
            &format!("load.body_force=[{:?}, 0]", 2.0 * force),
            &format!("initial.velocity=['{velocity:?}*(1 - y)', 0]"),
        ])
    };
    let both = |load: f64| load > s + 0.1 && load < 0.4;
    for (force, velocity) in [(0.3, 0.0), (0.15, 2.0)] {
        let problem = block(force, velocity);
        let (states, reports) = run(&problem);
        let (mut u, mut w) = (0.0, velocity);
        for (state, report) in states[1..].iter().zip(&reports) {
            let load = w / k - shear * u + force;
            assert!(both(load), "load {load}");
            w = if w == 0.0 { 0.0 } else { (load - 0.1) / s };
            u += k * w;
            near(state.w[0], w, 1e-9, &format!("load {load}"));
            near(state.w[2], w, 1e-9, &format!("load {load}"));
            assert!(!report.is_ambiguous && report.parts == 1);
        }
    }
}

/// A point that slip starts at passes the falling part of the table. Both nodes have one solution for λ_min(S, W) > f
/// p = 0.3, where the least eigenvalue, that of nodes that move against each other, is a third of m/k: ∫N_iN_j has the
/// eigenvalues 1/2 and 1/6, the weights are 1/2. Shorter steps by halving; where 1/32 of the step is not
/// short enough either, parts decide nothing and few are made.
#[test]
fn slip_starts_without_ambiguity_in_parts_below_the_threshold() {
    let threshold = 1.0 / (3.0 * 0.3);
    for (ratio, parts, ambiguous) in [(0.99, 1, false), (1.01, 2, false), (31.9, 6, false), (32.1, 2, true)] {
        let k = ratio * threshold;
        let problem = column(&[
            &format!("time.end={k:?}"),
            "material.viscosity.second=0",
            "material.elasticity.young=2e-12",
            "contact.friction={law='slip-rate', speed=[0, 1], coefficient=[0.4, 0.1]}",
            "contact.frictional_heat=0",
            "load.body_force=[0.9, 0]",
        ]);
        let (states, reports) = run(&problem);
        println!("k = {ratio} m/(3 p f): {} parts, ambiguous {}", reports[0].parts, reports[0].is_ambiguous);
        assert!(states[1].w[0] > 0.0, "the load 0.45 is above 0.4");
        assert_eq!(reports[0].is_ambiguous, ambiguous, "k = {ratio} m/(p f)");
        let made = reports[0].parts;
        let expected = match (parts, ambiguous) {
            (1, _) => made == 1,
            (_, false) => made >= parts,
            (_, true) => (parts..6).contains(&made),
        };
        assert!(expected, "k = {ratio} m/(p f): {made} parts");
        // The certificate names the pressure up to which such a step has one solution, λ_min/f: of a contact without a
        // stiffness, which has c* = 0.
        let tied = changed(&problem, |data| data.contacts[0].normal = Compliance { stiffness: 0.0 }.into());
        let unique = finding(&hypotheses::full(&tied).findings, "step-unique").unwrap();
        near(unique.value.unwrap() * ratio, 0.3, 1e-6, "λ_min(S, W)");
        assert_eq!(unique.status.as_str(), "not-covered");
        let most = format!("below {:.6e} Pa", unique.value.unwrap() / 0.3);
        assert!(unique.message.contains(&most), "{}, expected {most}", unique.message);
    }
}

/// Slip that turns round within a step passes the falling part of the table twice, though it is beyond it before and
/// after.
#[test]
fn slip_that_turns_round_is_followed_through_rest() {
    let problem = column(&[
        "time.end=10",
        "material.viscosity.second=0",
        "material.elasticity.young=2e-12",
        "contact.friction={law='slip-rate', speed=[0, 0.5, 1], coefficient=[0.4, 0.1, 0.1]}",
        "contact.frictional_heat=0",
        "load.body_force=[-1.24, 0]",
        "initial.velocity=['1.2*(1 - y)', 0]",
    ]);
    let (states, reports) = run(&problem);
    // In one step: w/k = 1.2/k − 0.62 + 0.1, from 1.2 to −4.
    assert!(reports[0].parts > 1 && states[1].w[0] < -1.0, "{} parts, w = {}", reports[0].parts, states[1].w[0]);
}

/// Under a load that grows by 4e-10 per step a point sticks up to μ_s p to round-off, and slips at once under μ_k p.
#[test]
fn a_stuck_point_slips_at_static_friction_and_not_before() {
    let problem = column(&[
        "time.end=14",
        "time.steps=14",
        "contact.friction={law='static-kinetic', static=0.4, kinetic=0.3}",
        "contact.frictional_heat=0",
        "load.body_force=['0.8*(1 + 1e-9*(t - 10.5))', 0]",
    ]);
    let (states, reports) = run(&problem);
    // S = ρ/(3k) + b + kG.
    let s = 3.0;
    let (mut u, mut w) = (0.0, 0.0);
    for n in 1..=14 {
        let force = 0.4 * (1.0 + 1e-9 * (n as f64 - 10.5));
        let load = force + w - u;
        let (q, slip) = if n <= 10 { (load, 0.0) } else { (0.3, (load - 0.3) / s) };
        (u, w) = (u + slip, slip);
        for state in &reports[n - 1].contact.states {
            near(state.q[0], q, 1e-13, &format!("q in step {n}"));
        }
        near(states[n].w[0], slip, 1e-13, &format!("w in step {n}"));
        assert!(!reports[n - 1].is_ambiguous && reports[n - 1].parts == 1);
    }
    let findings = hypotheses::full(&problem).findings;
    let unique = finding(&findings, "step-unique").unwrap();
    assert!(unique.status.as_str() == "not-covered" && unique.message.contains("two solutions"), "{}", unique.message);
}

/// A belt with v_F = 0.05 t² carries a body of mass 1 along up to the static friction:
/// (v_F(t_n) − v_F(t_{n−1}))/k = 0.1 t_n − 0.05 k ≤ μ_s holds up to t = 2. From there the body has the acceleration
/// μ_k.
#[test]
fn a_belt_that_speeds_up_carries_a_body_along_up_to_static_friction() {
    for friction in ["static=0.2, kinetic=0.1", "static=0.2, kinetic=0.1, cap=100"] {
        let problem = column(&[
            "time.end=4",
            "time.steps=400",
            "material.viscosity.second=0",
            "material.elasticity.young=2e-12",
            &format!("contact.friction={{law='static-kinetic', {friction}}}"),
            "contact.frictional_heat=0",
            "contact.foundation_velocity=['0.05*t^2', 0]",
        ]);
        let (states, reports) = run(&problem);
        for n in 1..=400 {
            let t = 0.01 * n as f64;
            let w = if n <= 200 { 0.05 * t * t } else { 0.2 + 0.1 * (t - 2.0) };
            near(states[n].w[0], w, 1e-10, &format!("w at t = {t}, {friction}"));
            assert!(reports[n - 1].parts == 1, "{} parts at t = {t}", reports[n - 1].parts);
        }
    }
}

/// `softening` is there where a law falls, and only there.
#[test]
fn laws_that_fall_are_told() {
    let told = |law: &str| finding(&hypotheses::findings(&paper(&["mesh.n=4", law]).problem), "softening");
    for law in [
        "contact.normal={law='softening', stiffness=1e4, peak=1, softening=5e3, residual=0.5}",
        "contact.normal={law='adhesion', stiffness=1e4, strength=1, release=1e-4}",
        "contact.normal={law='adhesion', stiffness=1e4, strength=1}",
        "contact.friction={law='static-kinetic', static=0.3, kinetic=0.2}",
        "contact.friction={law='static-kinetic', static=0.3, kinetic=0.2, decay_speed=0.1}",
        "contact.friction={law='slip-rate', speed=[0, 0.1, 1], coefficient=[0.3, 0.2, 0.3]}",
    ] {
        let finding = told(law).unwrap_or_else(|| panic!("{law}"));
        assert!(
            finding.status.as_str() == "not-covered" && finding.message.contains("several solutions"),
            "{law}: {}",
            finding.message
        );
        let numbers = [5e3, 1e4, 0.1, 1.0];
        if let Some(value) = finding.value {
            assert!(numbers.iter().any(|n| (value / n - 1.0).abs() < 1e-9), "{law}: {value}");
        }
    }
    for law in [
        "contact.normal={law='compliance', stiffness=1e4}",
        "contact.normal={law='power', stiffness=1e6, exponent=1.5}",
        "contact.normal={law='table', penetration=[0, 1e-4, 1e-3], pressure=[0, 1, 20]}",
        "contact.normal={law='stop', stiffness=1e4, depth=1e-3}",
        "contact.normal={law='signorini'}",
        "contact.normal={law='bilateral'}",
        "contact.normal={law='damped', stiffness=1e4, damping=10}",
        "contact.normal={law='hunt-crossley', stiffness=1e4, damping=0.1}",
        "contact.friction={law='none'}",
        "contact.friction={law='tresca', bound=0.3}",
        "contact.friction={law='static-kinetic', static=0.3, kinetic=0.3}",
        "contact.friction={law='slip-rate', speed=[0, 1], coefficient=[0.2, 0.3]}",
        "contact.friction={law='pressure', pressure=[0, 1, 10], coefficient=[0.3, 0.3, 0.1]}",
        "contact.friction={law='temperature', temperature=[0, 10], coefficient=[0.3, 0.1]}",
        "contact.friction={law='orthotropic', coefficients=[0.3, 0.1], direction=[1, 0]}",
    ] {
        assert!(told(law).is_none(), "{law}");
    }
}

/// A point that sticks holds up to the static bound, one that slips has the kinetic one: in every step of a block on a
/// belt.
#[test]
fn static_and_kinetic_bounds() {
    let law = "contact.friction={law='static-kinetic', static=0.3, kinetic=0.1}";
    let (_, reports) =
        run(&paper(&["mesh.n=16", "time.steps=64", law, "contact.foundation_velocity=['0.02', 0]"]).problem);
    let mut held = 0;
    for s in reports.iter().flat_map(|r| &r.contact.states).filter(|s| s.pressure > 0.0) {
        let q = length(&s.q);
        match s.status {
            Status::Stick => {
                assert!(q <= 0.3 * s.pressure * (1.0 + 1e-9));
                held += usize::from(q > 0.1 * s.pressure * (1.0 + 1e-6));
            }
            _ => assert!((q - 0.1 * s.pressure).abs() <= 1e-8 * s.pressure, "{q:e} at {:e}", s.pressure),
        }
    }
    assert!(held > 0, "no point is held by more than the kinetic bound");
}
