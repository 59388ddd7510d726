//! Phases in the case file: one thing spoiled each, with the exact message; overrides by name.

use crate::common::{spoil, told};
use amontons::case::{self, Source};
use amontons::time::{Analysis, TimePhase, Timeline};

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
[[phase]]
name = "press"
end = 1.0
steps = 4
analysis = "quasistatic"
[[phase]]
name = "spin"
end = 3.0
steps = 10
"#;

spoiled! { BAR
    a_time_beside_phases: "[material]" => "[time]\nend = 3.0\nsteps = 12\n[material]"
        "bar.toml:7:7: time.end: found 3.0 beside phases, expected no such key; remove it: each [[phase]] has its `end`"
        "bar.toml:8:9: time.steps: found 12 beside phases, expected no such key; remove it: each [[phase]] has its `steps`";
    an_end_before_the_start: "end = 3.0" => "end = 0.5"
        "bar.toml:19:7: phase[1].end: found 0.5, expected more than 1.0, the end of the phase before; `end` is a time, not a duration; phases stand in their order";
    an_end_that_is_the_start: "end = 3.0" => "end = 1.0"
        "bar.toml:19:7: phase[1].end: found 1.0, expected more than 1.0, the end of the phase before; `end` is a time, not a duration; phases stand in their order";
    a_name_twice: "\"spin\"" => "\"press\""
        "bar.toml:18:8: phase[1].name: found \"press\" again, expected a name of its own for each phase";
    a_name_with_a_comma: "\"spin\"" => "\"spin, fast\""
        "bar.toml:18:8: phase[1].name: found \"spin, fast\", expected a letter, then letters, digits, `-` and `_`, at most 40; the name is used in files and in --set";
    a_name_that_is_a_number: "\"spin\"" => "\"1\""
        "bar.toml:18:8: phase[1].name: found \"1\", expected a letter, then letters, digits, `-` and `_`, at most 40; the name is used in files and in --set";
    no_steps: "steps = 10" => "steps = 0"
        "bar.toml:20:9: phase[1].steps: found 0, expected an integer ≥ 1 and ≤ 1000000000 (number of equal time steps of the phase, or \"auto\" for steps that follow from the accuracy)";
    steps_missing: "steps = 10\n" => ""
        "bar.toml:17:1: phase[1].steps: found no such key, expected an integer ≥ 1 and ≤ 1000000000, or \"auto\" (number of equal time steps of the phase, or \"auto\" for steps that follow from the accuracy)";
    steps_too_short: "end = 1.0" => "end = 1e-320"
        "bar.toml:14:7: phase[0].end: found steps of 2.5e-321 s, expected a step length that is a normal number";
    steps_of_another_word: "steps = 10" => "steps = \"automatic\""
        "bar.toml:20:9: phase[1].steps: found \"automatic\", expected \"auto\" (number of equal time steps of the phase, or \"auto\" for steps that follow from the accuracy)";
    auto_without_accuracy: "steps = 10" => "steps = \"auto\""
        "bar.toml:20:9: phase[1].steps: found \"auto\" without an accuracy, expected `accuracy` beside it, above 0 and at most 0.1; add `accuracy = 1e-3` to phase[1], or give a number of equal steps";
    accuracy_of_equal_steps: "steps = 10" => "steps = 10\naccuracy = 1e-3"
        "bar.toml:21:12: phase[1].accuracy: found 0.001 beside equal steps, expected no such key; remove it, or write steps = \"auto\": equal steps have no accuracy to keep";
    accuracy_of_no_phase: "[material]" => "[time]\naccuracy = 1e-3\n[material]"
        "bar.toml:7:12: time.accuracy: found 0.001 beside no phase with steps = \"auto\", expected no such key; remove it, or write steps = \"auto\": equal steps have no accuracy to keep";
    accuracy_of_nothing: "steps = 10" => "steps = \"auto\"\naccuracy = 0"
        "bar.toml:21:12: phase[1].accuracy: found 0, expected a number > 0 and ≤ 0.1 (accuracy of steps that are \"auto\", if it is another than that of `[time]`)";
    accuracy_too_coarse: "steps = 10" => "steps = \"auto\"\naccuracy = 0.2"
        "bar.toml:21:12: phase[1].accuracy: found 0.2, expected a number > 0 and ≤ 0.1 (accuracy of steps that are \"auto\", if it is another than that of `[time]`)";
    an_analysis_that_is_unknown: "\"quasistatic\"" => "\"quasi-static\""
        "bar.toml:16:12: phase[0].analysis: found \"quasi-static\", expected \"dynamic\", \"quasistatic\" or \"steady\" (what of the equations acts in the phase); did you mean \"quasistatic\"?";
    inertia_left_out_twice: "[material]" => "[time]\ninertia = false\n[material]"
        "bar.toml:18:12: phase[0].analysis: found \"quasistatic\" with time.inertia = false, expected one of both; remove time.inertia, and say of each phase what acts";
    a_free_body: "displacement = [0]" => "traction = [1]"
        "bar.toml:9:1: boundary: found no displacement prescribed and no inertia in the quasistatic phase \"press\", expected a part Γ_D that holds the body; give `displacement` on a side, or `analysis = \"dynamic\"` for this phase";
    no_phase_of_this_name: "n = 2" => "n = 2" set "phase.brake.steps=3"
        "--set phase.brake.steps=3: phase.brake.steps: found the key `brake` in an array, expected an index from 0 to 1, or a name: `press`, `spin`";
    no_time_and_no_phase: "[[phase]]\nname = \"press\"\nend = 1.0\nsteps = 4\nanalysis = \"quasistatic\"\n[[phase]]\nname = \"spin\"\nend = 3.0\nsteps = 10\n" => ""
        "bar.toml: time: found no such key, expected a table (the time interval (0, end) and its steps)";
}

#[test]
fn steps_and_accuracy_are_set() {
    let timeline = |overrides: &[&str]| {
        let overrides: Vec<String> = overrides.iter().map(|set| (*set).to_owned()).collect();
        let case = case::parse(&Source::new("bar.toml", BAR), &overrides).unwrap_or_else(|error| panic!("{error}"));
        case.problem.timeline.clone()
    };
    let set = timeline(&[
        "time.accuracy=1e-4",
        "phase.press.steps=auto",
        "phase.spin.steps=auto",
        "phase.spin.accuracy=0.01",
    ]);
    let press = TimePhase::quasistatic("press", 1.0, 1).automatic(1e-4);
    assert_eq!(set, Timeline::in_phases(vec![press, TimePhase::dynamic("spin", 3.0, 1).automatic(0.01)]));
}

#[test]
fn phases_are_read_and_set_by_name() {
    let timeline = |overrides: &[&str]| {
        let overrides: Vec<String> = overrides.iter().map(|set| (*set).to_owned()).collect();
        let case = case::parse(&Source::new("bar.toml", BAR), &overrides).unwrap_or_else(|error| panic!("{error}"));
        case.problem.timeline.clone()
    };
    let expected = [TimePhase::quasistatic("press", 1.0, 4), TimePhase::dynamic("spin", 3.0, 10)];
    assert_eq!(timeline(&[]), Timeline::in_phases(expected.to_vec()));
    let set = timeline(&["phase.press.steps=20", "phase[1].end=5", "phase.press.analysis=dynamic"]);
    let expected = [TimePhase::dynamic("press", 1.0, 20), TimePhase::dynamic("spin", 5.0, 10)];
    assert_eq!(set, Timeline::in_phases(expected.to_vec()));
    assert_eq!(set.instant(1).analysis, Analysis::Dynamic);
}

/// A pad on a belt in a steady phase, held and cooled.
const PAD: &str = r#"name = "pad"
[mesh]
kind = "rectangle"
size = [1.0, 1.0]
n = 2
[material]
elasticity = { law = "isotropic", young = 1.0, poisson = 0.0, stress_state = "plane-strain" }
conductivity = 1.0
[[boundary]]
on = "top"
displacement = [0, -1e-3]
temperature = 0
[contact]
on = "bottom"
foundation_velocity = [1, 0]
normal = { law = "signorini" }
friction = { law = "coulomb", coefficient = 0.1 }
frictional_heat = 1
[time]
end = 1.0
analysis = "steady"
"#;

/// What is said of the pad with one thing spoiled.
fn of_pad(old: &str, new: &str) -> String {
    told(&Source::new("pad.toml", spoil(PAD, old, new)), &[])
}

#[test]
fn a_steady_run_needs_neither_steps_nor_density_nor_heat_capacity() {
    let read = |text: &str| case::parse(&Source::new("pad.toml", text), &[]).unwrap_or_else(|error| panic!("{error}"));
    let timeline = read(PAD).problem.timeline.clone();
    assert_eq!(timeline, Timeline::equal(1.0, 1).with_analysis(Analysis::Steady));
    let phase = spoil(PAD, "[time]\n", "[[phase]]\nname = \"in-service\"\n");
    let expected = Timeline::in_phases(vec![TimePhase::steady("in-service", 1.0, 1)]);
    assert_eq!(read(&phase).problem.timeline, expected);
    assert_eq!(of_pad("end = 1.0\n", "end = 1.0\nsteps = 3\n"), "no fault");
}

#[test]
fn what_has_no_steady_state_is_named_with_its_place() {
    let all = [
        (
            ("temperature = 0\n", ""),
            "pad.toml:9:1: boundary: found no temperature prescribed in a steady run, in which no heat is stored, expected a side whose temperature is known; give `temperature` or `convection` on a side, or a foundation with a conductance, so that heat can leave",
        ),
        (
            ("friction =", "wear = { law = \"archard\", coefficient = 1e-9 }\nfriction ="),
            "pad.toml:17:8: contact.wear: found wear, which never ends, with time.analysis = \"steady\", expected none; use analysis = \"quasistatic\", with steps in time",
        ),
        (
            ("frictional_heat = 1\n", "frictional_heat = 0.5\nfoundation = { heat_capacity = 1.0 }\n"),
            "pad.toml:13:1: contact.heat: found a foundation that keeps all its heat, with time.analysis = \"steady\", expected one that gives heat to its surroundings; use analysis = \"quasistatic\", with steps in time",
        ),
        (("displacement = [0, -1e-3]", "traction = [0, -1]"), "no fault"),
        (
            ("\"steady\"\n", "\"steady\"\ninertia = false\n"),
            "pad.toml:21:12: time.analysis: found \"steady\" with time.inertia = false, expected one of both; remove time.inertia",
        ),
        (
            ("\"steady\"\n", "\"quasistatic\"\n"),
            "pad.toml:6:1: material.heat_capacity: found no such key, expected a number ≥ 0, an expression in x, y, z, data of a mesh file or a table over the temperature (heat capacity per volume, the factor of θ̇ in (2.4), in J/(m³ K); 0: steady heat)\npad.toml:19:1: time.steps: found no such key, expected an integer ≥ 1 and ≤ 1000000000, or \"auto\" (number of equal time steps, or \"auto\" for steps that follow from `accuracy`)",
        ),
        (
            ("[time]\n", "[[phase]]\nname = \"one\"\nend = 0.5\nanalysis = \"steady\"\n[time]\n"),
            "pad.toml:24:7: time.end: found 1.0 beside phases, expected no such key; remove it: each [[phase]] has its `end`\npad.toml:25:12: time.analysis: found \"steady\" beside phases, expected no such key; remove it: each [[phase]] has its `analysis`",
        ),
    ];
    let found = all.map(|((old, new), _)| of_pad(old, new));
    assert_eq!(found, all.map(|(_, expected)| expected));
}
