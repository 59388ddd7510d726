//! Conditions of phases and starts in equilibrium in the case file: one thing spoiled each, with the exact message.

use crate::common::{spoil, told};
use amontons::case::{self, Source};
use amontons::problem::Release;
use amontons::time::During;

const BAR: &str = r#"name = "bar"
[mesh]
kind = "interval"
size = 1.0
n = 2
[material]
density = 1.0
elasticity = { law = "isotropic", young = 1.0, poisson = 0.0 }
[[boundary]]
on = "left"
displacement = [0]
[[boundary]]
on = "right"
displacement = [0.1]
phases = ["press", "hold"]
[[boundary]]
on = "right"
traction = [1]
phases = ["spin"]
[[phase]]
name = "press"
end = 1.0
steps = 4
analysis = "quasistatic"
[[phase]]
name = "hold"
end = 2.0
steps = 4
[[phase]]
name = "spin"
end = 3.0
steps = 10
"#;

spoiled! { BAR
    a_phase_that_is_unknown: "[\"spin\"]" => "[\"spn\"]"
        "bar.toml:19:11: boundary[2].phases[0]: found \"spn\", expected one of the phases press, hold, spin; did you mean \"spin\"?";
    a_phase_that_is_far_from_all: "[\"press\", \"hold\"]" => "[\"press\", \"cooling\"]"
        "bar.toml:15:20: boundary[1].phases[1]: found \"cooling\", expected one of the phases press, hold, spin";
    a_phase_twice: "[\"press\", \"hold\"]" => "[\"press\", \"hold\", \"press\"]"
        "bar.toml:15:28: boundary[1].phases[2]: found \"press\" again, expected each phase once; remove it";
    no_phase: "[\"spin\"]" => "[]"
        "bar.toml:19:10: boundary[2].phases: found no phase, expected some of the phases press, hold, spin; name the phases, or remove `phases`: the entry then acts in all of them";
    phases_that_are_no_list: "[\"spin\"]" => "\"spin\""
        "bar.toml:19:10: boundary[2].phases: found \"spin\", expected an array, each a string (names of the phases in which the entry acts; without the key it acts in all of them)";
    two_entries_in_one_phase: "[\"spin\"]" => "[\"hold\", \"spin\"]"
        "bar.toml:17:6: boundary[2].on: found \"right\" again, expected each side in one [[boundary]] entry per phase: both act in \"hold\"; merge it with entry 2 of the file, which is on the same side";
    an_entry_of_all_phases_beside_one: "phases = [\"spin\"]\n" => ""
        "bar.toml:17:6: boundary[2].on: found \"right\" again, expected each side in one [[boundary]] entry per phase: both act in \"press\"; merge it with entry 2 of the file, which is on the same side";
    a_release_without_a_displacement: "phases = [\"spin\"]" => "phases = [\"spin\"]\nrelease = \"phase\""
        "bar.toml:20:11: boundary[2].release: found a release of a side without a displacement, expected a prescribed displacement beside it; remove it: loads, springs and temperatures end at once";
    a_release_that_never_comes: "on = \"left\"" => "on = \"left\"\nrelease = \"phase\""
        "bar.toml:11:11: boundary[0].release: found a release of a displacement that acts to the end of the run, expected a displacement that ends before; name in `phases` those in which it acts, without the last one, or remove `release`";
    a_release_that_is_unknown: "phases = [\"spin\"]" => "phases = [\"spin\"]\nrelease = \"at once\""
        "bar.toml:20:11: boundary[2].release: found \"at once\", expected \"at-once\" or \"phase\" (what becomes of the force that holds a prescribed displacement when it ends with a phase); did you mean \"at-once\"?";
    a_quasistatic_phase_that_nothing_holds: "on = \"left\"\ndisplacement = [0]" => "on = \"left\"\ndisplacement = [0]\nphases = [\"press\", \"hold\"]" set "phase.spin.analysis=quasistatic"
        "bar.toml:9:1: boundary: found no displacement prescribed and no inertia in the quasistatic phase \"spin\", expected a part Γ_D that holds the body; give `displacement` on a side, or `analysis = \"dynamic\"` for this phase";
    a_displacement_beside_an_equilibrium: "[material]" => "[initial]\nstate = \"equilibrium\"\ndisplacement = [0.1]\n[material]"
        "bar.toml:8:16: initial.displacement: found a displacement besides a start in equilibrium, expected one of the two; remove it, or remove initial.state";
    a_velocity_beside_an_equilibrium: "[material]" => "[initial]\nstate = \"equilibrium\"\nvelocity = [0.1]\n[material]"
        "bar.toml:8:12: initial.velocity: found a velocity besides a start in equilibrium, expected one of the two; remove it, or remove initial.state";
    a_start_that_is_unknown: "[material]" => "[initial]\nstate = \"equilibrum\"\n[material]"
        "bar.toml:7:9: initial.state: found \"equilibrum\", expected \"given\" or \"equilibrium\" (whether the run starts from these data or in equilibrium); did you mean \"equilibrium\"?";
}

#[test]
fn phases_beside_one_span_of_time_are_refused() {
    let (head, _) = BAR.split_once("[[phase]]").expect("phases");
    let text = format!("{head}[time]\nend = 1.0\nsteps = 2\n");
    let text = spoil(&text, "[[boundary]]\non = \"right\"\ntraction = [1]\nphases = [\"spin\"]\n", "");
    let expected = "bar.toml:15:10: boundary[1].phases: found [\"press\", \"hold\"] in a run without phases, expected no such key; give the run its [[phase]] entries, or remove `phases`";
    assert_eq!(told(&Source::new("bar.toml", text), &[]), expected);
}

#[test]
fn an_equilibrium_that_nothing_holds_is_refused() {
    let text = spoil(BAR, "[material]", "[initial]\nstate = \"equilibrium\"\n[material]");
    let text = spoil(&text, "on = \"left\"\ndisplacement = [0]", "on = \"left\"\ntraction = [0]");
    let text = spoil(&text, "phases = [\"press\", \"hold\"]", "phases = [\"hold\"]");
    let text = spoil(&text, "analysis = \"quasistatic\"\n", "");
    let expected = "bar.toml:11:1: boundary: found no displacement prescribed, at a start in equilibrium, expected a part Γ_D that holds the body; give `displacement` on a side, or remove initial.state";
    assert_eq!(told(&Source::new("bar.toml", text), &[]), expected);
}

#[test]
fn conditions_are_those_of_the_first_phase_and_of_the_phase_asked_for() {
    let problem = case::parse(&Source::new("bar.toml", BAR), &[]).expect("a case").problem;
    let acts = |phase: usize| {
        let problem = problem.in_phase(phase);
        problem.boundary.iter().map(|condition| !condition.is_empty()).collect::<Vec<_>>()
    };
    assert_eq!([0, 1, 2].map(acts), [vec![true, true, false], vec![true, true, false], vec![true, false, true]]);
    assert_eq!(problem.phase(), 0);
    let all = problem.in_phase(2).into_data().boundary;
    assert_eq!(all[1].during, During::phases(["press", "hold"]));
    assert_eq!(all[1].release, Release::AtOnce);
    assert!(all.iter().all(|condition| !condition.is_empty()));
}

/// Where supports of a later phase hold nodes of both sides of a pair, the pair has other contact points there.
#[test]
fn a_pair_has_the_same_points_in_all_phases() {
    let blocks = "[mesh]\nkind = \"blocks\"\n[[mesh.blocks]]\nname = \"lower\"\nsize = [1.0, 0.5]\nn = [4, 2]\n\
        [[mesh.blocks]]\nname = \"upper\"\nsize = [1.0, 0.5]\nn = [4, 2]\norigin = [0.0, 0.5]\n";
    let held = |on: &str, phases: &str| format!("[[boundary]]\non = \"{on}\"\ndisplacement = [0, 0]\n{phases}");
    let text = |left: &str| {
        format!(
            "name = \"pair\"\n{blocks}[material]\ndensity = 1.0\n\
            elasticity = {{ law = \"isotropic\", young = 1.0, poisson = 0.3, stress_state = \"plane-strain\" }}\n\
            [[phase]]\nname = \"press\"\nend = 1\nsteps = 2\n[[phase]]\nname = \"hold\"\nend = 2\nsteps = 2\n\
            [contact]\non = \"lower_top\"\nwith = \"upper_bottom\"\nnormal = {{ law = \"signorini\" }}\n{}{}{left}",
            held("lower_bottom", ""),
            held("upper_top", ""),
        )
    };
    let later = "phases = [\"hold\"]\n";
    let one = held("lower_left", later);
    assert!(case::parse(&Source::new("pair.toml", text(&one)), &[]).is_ok());
    let found = told(&Source::new("pair.toml", text(&(one + &held("upper_left", later)))), &[]);
    let expected = "contact: found 4 contact points in the phase \"hold\" and 5 in the phase \"press\", because supports hold nodes of both sides, expected the same contact points in all phases; hold the nodes of one side only, or both in all phases";
    assert!(found.ends_with(expected), "{found}");
}
