//! Bodies that move without strain, or far beside it: what is left of the equations is then the round-off of large
//! terms.

use amontons::case::{self, Source};
use amontons::problem::Problem;
use amontons::state::State;
use amontons::step::{March, Scheme};
use amontons::verify::BENCHMARKS;

fn problem(text: &str, overrides: &[&str]) -> Problem {
    let overrides: Vec<String> = overrides.iter().map(|&set| set.to_owned()).collect();
    case::parse(&Source::new("body.toml", text), &overrides).unwrap_or_else(|error| panic!("{error}")).problem
}

fn end(problem: &Problem) -> State {
    let mut scheme = March::new(problem).unwrap();
    let mut state = scheme.initial().unwrap();
    for _ in 0..problem.timeline.steps() {
        state = scheme.step(&state).unwrap_or_else(|error| panic!("{error}")).0;
    }
    let (energy, heat) = (state.ledger.relative_closing_error(), state.ledger.relative_heat_closing_error());
    // Above 1e-11 the ledger looks at the round-off of the terms that cancel.
    assert!(energy.abs() < 1e-11 && heat.abs() < 1e-11, "energy closes to {energy:e}, heat to {heat:e}");
    state
}

const ROD: &str = body!(
    r#"kind = "interval", size = 1.0, n = 3"#,
    "end = 2.0, steps = 200",
    0,
    "young = 400.0, poisson = 0.0",
    r#"
heat_capacity = 1
conductivity = 1
[[boundary]]
on = "left"
displacement = ["-0.01*t"]
[contact]
on = "right"
normal = { law = "signorini" }
"#
);

/// A body that is bent and comes back: at the end nothing acts, and its residual is the round-off of nothing. It is
/// told as round-off.
#[test]
fn a_residual_where_nothing_acts_is_round_off() {
    let text = "name = \"back\"\nunits = \"dimensionless\"\n[mesh]\nkind = \"rectangle\"\nsize = [1.0, 1.0]\nn = 4\n\
                [time]\nend = 1.0\nsteps = 4\n[material]\ndensity = 0\n\
                elasticity = { law = \"isotropic\", young = 10.0, poisson = 0.3, stress_state = \"plane-strain\" }\n\
                [[boundary]]\non = \"bottom\"\ndisplacement = [0, 0]\n\
                [[boundary]]\non = \"top\"\ndisplacement = [\"0.1*sin(4*atan(1)*t)\", \"0.1*(0.3 + t*(1 - t) - 0.3)\"]\n";
    let state = end(&problem(text, &[]));
    assert!(
        state.u.iter().fold(0.0f64, |m, u| m.max(u.abs())) < 1e-15,
        "{:e}",
        state.u.iter().fold(0.0f64, |m, u| m.max(u.abs()))
    );
    assert!(state.counts.residual_max < 1e-12, "{:e}", state.counts.residual_max);
}

/// A rod that is drawn away from the foundation, and one that is brought back to where it was: free of stress in every
/// step.
#[test]
fn a_free_rod_moves_without_stress() {
    for (moved, expected) in [("-0.01*t", -0.02), ("-0.01*t*(2 - t)", 0.0), ("-1e6*t*(2 - t)", 0.0)] {
        let state = end(&problem(ROD, &[&format!("boundary[0].displacement=['{moved}']")]));
        let size = if moved.contains("1e6") { 1e6 } else { 0.01 };
        assert!(state.u.iter().all(|u| (u - expected).abs() <= 1e-14 * size), "{:?} after {moved}", state.u);
        assert!(state.ledger.elastic <= 1e-25 * 400.0 * size * size, "{:e}", state.ledger.elastic);
    }
}

/// Uniform temperatures that nothing changes, far from zero, in a body without heat capacity.
#[test]
fn a_uniform_temperature_stays() {
    let sets = ["material.heat_capacity=0", "boundary[0].temperature=1e5", "initial.temperature=1e5"];
    let state = end(&problem(ROD, &sets));
    assert!(state.theta.iter().all(|theta| (theta - 1e5).abs() <= 1e-9), "{:?}", state.theta);
}

/// The block of `sliding-block-signorini` of steel and of diamond: as stiff as a body is, it slides as far, v₀²/(2μg)
/// but for v₀ k/2.
#[test]
fn stiff_blocks_slide_as_far() {
    let (_, text) = BENCHMARKS.iter().find(|(name, _)| *name == "sliding-block-signorini").unwrap();
    for young in ["1e7", "2.1e11", "1.1e12"] {
        let problem = problem(text, &[&format!("material.elasticity.young={young}")]);
        let state = end(&problem);
        let slid = state.u.iter().step_by(2).sum::<f64>() / (state.u.len() / 2) as f64;
        assert!((slid - 0.25).abs() < 0.6 * problem.timeline.longest(), "E = {young}: {slid}");
    }
}

/// A block that stands on a rigid or soft foundation and is held sideways only: K is singular, the step is not.
#[test]
fn contact_alone_holds_a_block_upright() {
    const BLOCK: &str = body!(
        r#"kind = "rectangle", size = [2.0, 1.0], n = [4, 2]"#,
        "end = 1.0, steps = 4",
        0,
        r#"young = 2.0, poisson = 0.25, stress_state = "plane-stress""#,
        r#"
[[boundary]]
on = "left"
displacement = [0, "free"]
[[boundary]]
on = "top"
traction = [0, "-0.1*t"]
[contact]
on = "bottom"
normal = { law = "signorini" }
"#
    );
    // σ_yy = −p and σ_xx = 0 but for the side that is held, which is free to slip: ε_yy = −p/E, and a layer c_ν gives
    // way by p/c_ν.
    for (normal, sinks) in [("{law='signorini'}", 0.0), ("{law='compliance', stiffness=10}", 0.01)] {
        for n in ["[4, 2]", "[5, 3]", "[16, 8]", "[33, 17]"] {
            let problem = problem(BLOCK, &[&format!("contact.normal={normal}"), &format!("mesh.n={n}")]);
            let state = end(&problem);
            let top =
                problem.mesh.points.iter().zip(state.u.chunks_exact(2)).filter(|(x, _)| (x[1] - 1.0).abs() < 1e-12);
            for (x, u) in top {
                assert!((u[1] + 0.05 + sinks).abs() < 1e-11, "{normal}, n = {n}: u_y = {} at {x:?}", u[1]);
            }
        }
    }
}
