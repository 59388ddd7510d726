//! The fixed point of Theorem 3.1 within a step, and the monolithic step that is its limit.

use crate::common::{case, largest, paper};
use amontons::equation::StepError;
use amontons::output::Memory;
use amontons::problem::Problem;
use amontons::run::{self, RunError, Settings};
use amontons::state::State;

fn solve(problem: &Problem) -> (State, Memory) {
    let mut memory = Memory::new().states_every(1).reports();
    run::run(problem, &Settings::default(), &mut [&mut memory]).unwrap_or_else(|error| panic!("{error}"));
    let last = memory.states.last().expect("states").clone();
    (last, memory)
}

/// The paper's case, small, with other steps and another coupling.
fn coupled(coupling: &str, steps: usize, foundation: f64) -> (State, Memory) {
    let overrides = [
        format!("scheme.coupling=\"{coupling}\""),
        format!("time.steps={steps}"),
        format!("contact.heat.foundation_temperature={foundation}"),
        "mesh.n=16".to_owned(),
    ];
    solve(&paper(&overrides.each_ref().map(String::as_str)).problem)
}

/// Largest relative difference of the fields of two states.
fn distance(a: &State, b: &State) -> f64 {
    let relative =
        |a: &[f64], b: &[f64]| largest(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>()) / largest(b);
    relative(&a.u, &b.u).max(relative(&a.w, &b.w)).max(relative(&a.theta, &b.theta))
}

#[test]
fn the_limit_of_the_fixed_point_is_the_monolithic_step() {
    for foundation in [0.0, 10.0] {
        let (fixed, memory) = coupled("fixed-point", 32, foundation);
        let (monolithic, newton) = coupled("monolithic", 32, foundation);
        assert!(distance(&fixed, &monolithic) < 1e-9, "θ_F = {foundation}: {:e}", distance(&fixed, &monolithic));
        for report in &memory.reports {
            let coupling = report.coupling;
            assert!(coupling.passes > 2 && coupling.defect.is_some_and(|d| d <= 1e-10), "{coupling:?}");
            assert!(coupling.contraction.is_some_and(|c| c.mean > 0.0 && c.mean < 1.0), "{coupling:?}");
        }
        // Newton's method needs fewer passes.
        let passes = |memory: &Memory| memory.reports.iter().map(|r| r.coupling.passes).sum::<usize>();
        assert!(passes(&newton) < passes(&memory), "{} and {}", passes(&newton), passes(&memory));
        // Both keep the identities.
        for state in [&fixed, &monolithic] {
            assert!(
                state.ledger.relative_closing_error().abs() < 1e-12
                    && state.ledger.relative_heat_closing_error().abs() < 1e-12
            );
        }
    }
}

/// Where all of (4.1) and (4.2) is linear, the coupled step is one linear system, which can be written down: the forms
/// of the monolithic step are applied to its solution.
#[test]
fn the_coupled_step_satisfies_both_equations_with_their_own_arguments() {
    let (_, memory) = coupled("monolithic", 8, 10.0);
    let (_, staggered) = coupled("staggered", 8, 10.0);
    let discrete = amontons::discretization::Discretization::new(&paper(&["mesh.n=16", "time.steps=8"]).problem);
    let k = 1.0 / 8.0;
    let defect = |memory: &Memory| {
        let mut worst = 0.0f64;
        for n in 1..memory.states.len() {
            let (old, new) = (&memory.states[n - 1], &memory.states[n]);
            let minus = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f64>>();
            let rate: Vec<f64> = discrete.mass.apply(&minus(&new.theta, &old.theta)).iter().map(|v| v / k).collect();
            let (conduction, coupling, supply) =
                (discrete.d.apply(&new.theta), discrete.e.apply(&new.u), discrete.q_h.at(new.t));
            let on_contact: Vec<usize> = discrete.boundary.nodes.iter().map(|&n| n as usize).collect();
            // At free nodes off Γ_C nothing else acts.
            for i in (0..rate.len()).filter(|&i| discrete.q.free[i] && !on_contact.contains(&i)) {
                let scale = largest(&conduction).max(largest(&coupling));
                worst = worst.max((rate[i] + conduction[i] - coupling[i] - supply[i]).abs() / scale);
            }
        }
        worst
    };
    assert!(defect(&memory) < 1e-10, "{:e}", defect(&memory));
    assert!(defect(&staggered) > 1e-4, "the staggered step has u of the step before: {:e}", defect(&staggered));
}

/// The staggered steps lag the coupling by k, so they come to the others at first order in k.
#[test]
fn staggered_steps_converge_to_the_coupled_ones_at_first_order() {
    let gap = |steps| distance(&coupled("staggered", steps, 0.0).0, &coupled("monolithic", steps, 0.0).0);
    let gaps = [32, 64, 128, 256].map(gap);
    let orders: Vec<f64> = gaps.windows(2).map(|g| (g[0] / g[1]).log2()).collect();
    assert!(orders.iter().all(|order| (order - 1.0).abs() < 0.15), "{gaps:?}: {orders:?}");
}

/// Without heat capacity the rod that touches its cold foundation in the transition of the ramp has a map of slope −3.5
/// at its root: the fixed point runs away from it, Newton's method finds it.
#[test]
fn a_map_that_does_not_contract_is_named_and_newton_finds_its_root() {
    let rod = |coupling: &str| {
        let overrides =
            ["material.heat_capacity=0", "time.steps=1", "time.end=1", &format!("scheme.coupling=\"{coupling}\"")]
                .map(str::to_owned);
        case("crates/amontons/benchmarks/thermoelastic-rod-gap-45.toml", &overrides).problem
    };
    let (_, memory) = solve(&rod("monolithic"));
    let contact = &memory.reports.last().expect("a report").contact;
    // Closed form of the benchmark: s = 1.925739e-6 and θ_L = 0.838522 − 0.9.
    let penetration = contact.states.iter().map(|s| s.penetration).fold(0.0, f64::max);
    assert!((penetration / 1.925_738_742_485_3e-6 - 1.0).abs() < 1e-9, "{penetration:e}");
    assert!(
        contact.temperature.iter().all(|t| (t + 0.061_477_522_195_323_7).abs() < 1e-9),
        "{:?}",
        contact.temperature
    );

    let failed = run::run(&rod("fixed-point"), &Settings::default(), &mut [&mut Memory::default()]);
    let Err(RunError::Step { source, .. }) = failed else { panic!("the fixed point does not settle") };
    assert!(matches!(source, StepError::Coupling { contraction: Some(c), .. } if c.largest > 1.0), "{source}");
    assert!(source.to_string().contains("scheme.coupling = \"monolithic\""), "{source}");
}
