//! Contacts and loads of phases in the case file: one thing spoiled each, with the exact message.

use crate::common::told;
use amontons::case::{self, Source};
use amontons::contact::Contact;
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
[[contact]]
on = "right"
gap = -0.1
normal = { law = "signorini" }
phases = ["press"]
[[contact]]
on = "right"
name = "stop"
gap = 0.1
normal = { law = "signorini" }
phases = ["hold", "spin"]
[[load]]
body_force = [1.0]
phases = ["hold"]
[[load]]
gravity = [1.0]
[[rigid]]
on = "right"
force = [1.0]
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
    a_phase_of_a_contact_that_is_unknown: "phases = [\"press\"]" => "phases = [\"pres\"]"
        "bar.toml:16:11: contact[0].phases[0]: found \"pres\", expected one of the phases press, hold, spin; did you mean \"press\"?";
    a_phase_of_a_contact_twice: "[\"hold\", \"spin\"]" => "[\"hold\", \"hold\"]"
        "bar.toml:22:19: contact[1].phases[1]: found \"hold\" again, expected each phase once; remove it";
    a_contact_of_no_phase: "phases = [\"press\"]" => "phases = []"
        "bar.toml:16:10: contact[0].phases: found no phase, expected some of the phases press, hold, spin; name the phases, or remove `phases`: the entry then acts in all of them";
    phases_of_a_contact_that_are_no_list: "phases = [\"press\"]" => "phases = \"press\""
        "bar.toml:16:10: contact[0].phases: found \"press\", expected an array, each a string (names of the phases in which the contact acts; without the key it acts in all of them)";
    two_contacts_in_one_phase: "[\"hold\", \"spin\"]" => "[\"press\", \"spin\"]"
        "bar.toml:18:6: contact[1].on: found \"right\" again, expected one [[contact]] entry without `obstacle` per side and phase: both act in \"press\"; name different phases in both, merge it with entry 1 of the file, which is on the same side, or give one of them an `obstacle`";
    a_contact_of_all_phases_beside_one: "phases = [\"press\"]\n" => ""
        "bar.toml:17:6: contact[1].on: found \"right\" again, expected one [[contact]] entry without `obstacle` per side and phase: both act in \"hold\"; name different phases in both, merge it with entry 1 of the file, which is on the same side, or give one of them an `obstacle`";
    a_name_of_contacts_twice: "on = \"right\"\ngap" => "on = \"right\"\nname = \"stop\"\ngap"
        "bar.toml:20:8: contact[1].name: found \"stop\" again, expected a name of its own for each contact; entry 1 of the file goes by this name";
    a_phase_of_a_load_that_is_unknown: "phases = [\"hold\"]" => "phases = [\"holding\"]"
        "bar.toml:25:11: load[0].phases[0]: found \"holding\", expected one of the phases press, hold, spin";
    a_phase_of_a_load_twice: "phases = [\"hold\"]" => "phases = [\"hold\", \"hold\"]"
        "bar.toml:25:19: load[0].phases[1]: found \"hold\" again, expected each phase once; remove it";
    a_load_of_no_phase: "phases = [\"hold\"]" => "phases = []"
        "bar.toml:25:10: load[0].phases: found no phase, expected some of the phases press, hold, spin; name the phases, or remove `phases`: the entry then acts in all of them";
    a_load_of_an_unknown_region: "gravity = [1.0]" => "gravity = [1.0]\non = \"bdy\""
        "bar.toml:28:6: load[1].on: found \"bdy\", expected one of the regions body; did you mean \"body\"?";
    a_load_that_is_zero: "body_force = [1.0]\n" => ""
        "bar.toml:23:1: load[0]: found a load that is zero, expected `body_force`, `gravity` or `heat_source`; add one of them, or remove the entry";
    a_load_of_two_components: "body_force = [1.0]" => "body_force = [1.0, 2.0]"
        "bar.toml:24:14: load[0].body_force: found 2 components, expected 1 components";
    a_gravity_of_two_components: "gravity = [1.0]" => "gravity = [1.0, 2.0]"
        "bar.toml:27:11: load[1].gravity: found 2 components, expected 1 components";
    an_unknown_key_of_a_load: "body_force = [1.0]" => "body_forces = [1.0]"
        "bar.toml:24:1: load[0].body_forces: found an unknown key, expected one of body_force, gravity, heat_source, on, phases, temperature; did you mean `body_force`?";
    a_given_temperature_of_a_phase: "body_force = [1.0]" => "temperature = 1.0"
        "bar.toml:24:15: load[0].temperature: found a given temperature beside `phases`, expected one of all of the body at all times; give the temperature of a region in [[region]], and one that changes as an expression in t";
    a_phase_of_a_rigid_part_that_is_unknown: "force = [1.0]\nphases = [\"spin\"]" => "force = [1.0]\nphases = [\"spn\"]"
        "bar.toml:31:11: rigid[0].phases[0]: found \"spn\", expected one of the phases press, hold, spin; did you mean \"spin\"?";
    phases_of_a_part_without_a_load: "\nforce = [1.0]\nphases = [\"spin\"]" => "\nphases = [\"spin\"]"
        "bar.toml:30:10: rigid[0].phases: found phases of a part without a force and a moment, expected `force` or `moment` beside it; remove it: a rigid part is rigid in all phases";
    a_body_that_a_contact_alone_holds: "on = \"left\"\ndisplacement = [0]" => "on = \"left\"\ntraction = [0]" set "phase.press.analysis=dynamic" set "phase.spin.analysis=quasistatic" set "contact[1].phases=[\"hold\"]"
        "bar.toml:9:1: boundary: found no displacement prescribed and no inertia in the quasistatic phase \"spin\", expected a part Γ_D that holds the body; give `displacement` on a side, or `analysis = \"dynamic\"` for this phase";
    a_displacement_where_a_contact_acts: "on = \"left\"\ndisplacement = [0]" => "on = \"left\"\ndisplacement = [0]\n[[boundary]]\non = \"right\"\ndisplacement = [0]\nphases = [\"press\", \"hold\"]"
        "bar.toml:14:16: boundary[1].displacement: found a displacement on \"right\", expected Γ_D apart from Γ_C; [contact] is on the same side; a side that bears contact takes loads, springs and heat flows only";
    a_load_that_is_set: "gravity = [1.0]" => "gravity = [1.0]" set "load[2].gravity=[1.0]"
        "--set load[2].gravity=[1.0]: load[2].gravity: found index 2, expected an index from 0 to 1";
}

#[test]
fn phases_beside_one_span_of_time_are_refused() {
    let (head, _) = BAR.split_once("[[phase]]").expect("phases");
    let text = format!("{head}[time]\nend = 1.0\nsteps = 2\n");
    let found = told(&Source::new("bar.toml", text), &[]);
    let expected = [
        "bar.toml:16:10: contact[0].phases: found [\"press\"] in a run without phases, expected no such key; give the run its [[phase]] entries, or remove `phases`",
        "bar.toml:22:10: contact[1].phases: found [\"hold\", \"spin\"] in a run without phases, expected no such key; give the run its [[phase]] entries, or remove `phases`",
        "bar.toml:25:10: load[0].phases: found [\"hold\"] in a run without phases, expected no such key; give the run its [[phase]] entries, or remove `phases`",
        "bar.toml:31:10: rigid[0].phases: found [\"spin\"] in a run without phases, expected no such key; give the run its [[phase]] entries, or remove `phases`",
    ];
    assert_eq!(found, expected.join("\n"));
}

#[test]
fn what_is_not_spoiled_has_no_fault() {
    assert_eq!(told(&Source::new("bar.toml", BAR), &[]), "no fault");
    // A side may be held while no contact acts on it.
    let held = BAR.replacen(
        "[[contact]]",
        "[[boundary]]\non = \"right\"\ndisplacement = [0]\nphases = [\"press\"]\n[[contact]]",
        1,
    );
    let held = held.replace(
        "phases = [\"press\"]\n[[contact]]\non = \"right\"\nname",
        "phases = [\"spin\"]\n[[contact]]\non = \"right\"\nname",
    );
    assert_eq!(told(&Source::new("bar.toml", held.replace("[\"hold\", \"spin\"]", "[\"hold\"]")), &[]), "no fault");
}

#[test]
fn contacts_and_loads_are_those_of_the_phase_asked_for() {
    let problem = case::parse(&Source::new("bar.toml", BAR), &[]).expect("a case").problem;
    let acts = |phase: usize| {
        let problem = problem.in_phase(phase);
        let loads = problem.region_loads.iter().map(|load| !load.body_force.is_empty() || load.gravity.is_some());
        let rigid = problem.rigid.iter().map(|part| !part.force.is_empty());
        let contacts = problem.contacts.iter().map(Contact::acts);
        contacts.chain(loads).chain(rigid).collect::<Vec<_>>()
    };
    let expected = [
        vec![true, false, false, true, false],
        vec![false, true, true, true, false],
        vec![false, true, false, true, true],
    ];
    assert_eq!([0, 1, 2].map(acts), expected);
    let all = problem.in_phase(2).into_data();
    assert_eq!(all.contacts[1].during, During::phases(["hold", "spin"]));
    assert_eq!(all.region_loads[0].during, During::phases(["hold"]));
    assert_eq!(all.rigid[0].force.len(), 1);
}
