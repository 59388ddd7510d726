//! Contacts and loads of phases in the case file: one thing spoiled each, with the exact message.

use crate::common::{spoil, told};
use amontons::case::{self, Source};
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

/// A test each: `name: "old" => "new" set "KEY=VALUE" "line of the message"… ;`
macro_rules! spoiled {
    ($($name:ident: $old:literal => $new:literal $(set $set:literal)* $($line:literal)+;)*) => {
        $(#[test]
        fn $name() {
            let found = told(&Source::new("bar.toml", spoil(BAR, $old, $new)), &[$($set),*]);
            assert_eq!(found, [$($line),+].join("\n"));
        })*
    };
}

spoiled! {
    nothing: "\"press\"" => "\"press\""
        "no fault";
    a_phase_of_a_contact_that_is_unknown: "phases = [\"press\"]" => "phases = [\"pres\"]"
        "";
    a_phase_of_a_contact_twice: "[\"hold\", \"spin\"]" => "[\"hold\", \"hold\"]"
        "";
    a_contact_of_no_phase: "phases = [\"press\"]" => "phases = []"
        "";
    phases_of_a_contact_that_are_no_list: "phases = [\"press\"]" => "phases = \"press\""
        "";
    two_contacts_in_one_phase: "[\"hold\", \"spin\"]" => "[\"press\", \"spin\"]"
        "";
    a_contact_of_all_phases_beside_one: "phases = [\"press\"]\n" => ""
        "";
    a_name_of_contacts_twice: "on = \"right\"\ngap" => "on = \"right\"\nname = \"stop\"\ngap"
        "";
    a_phase_of_a_load_that_is_unknown: "phases = [\"hold\"]" => "phases = [\"holding\"]"
        "";
    a_phase_of_a_load_twice: "phases = [\"hold\"]" => "phases = [\"hold\", \"hold\"]"
        "";
    a_load_of_no_phase: "phases = [\"hold\"]" => "phases = []"
        "";
    a_load_of_an_unknown_region: "gravity = [1.0]" => "gravity = [1.0]\non = \"bdy\""
        "";
    a_load_that_is_zero: "body_force = [1.0]\n" => ""
        "";
    a_load_of_two_components: "body_force = [1.0]" => "body_force = [1.0, 2.0]"
        "";
    a_gravity_of_two_components: "gravity = [1.0]" => "gravity = [1.0, 2.0]"
        "";
    an_unknown_key_of_a_load: "body_force = [1.0]" => "body_forces = [1.0]"
        "";
    a_given_temperature_of_a_phase: "body_force = [1.0]" => "temperature = 1.0"
        "";
    a_phase_of_a_rigid_part_that_is_unknown: "force = [1.0]\nphases = [\"spin\"]" => "force = [1.0]\nphases = [\"spn\"]"
        "";
    phases_of_a_part_without_a_load: "\nforce = [1.0]\nphases = [\"spin\"]" => "\nphases = [\"spin\"]"
        "";
    a_body_that_a_contact_alone_holds: "on = \"left\"\ndisplacement = [0]" => "on = \"left\"\ntraction = [0]" set "phase.press.analysis=dynamic" set "phase.spin.analysis=quasistatic" set "contact[1].phases=[\"hold\"]"
        "";
    a_displacement_where_a_contact_acts: "on = \"left\"\ndisplacement = [0]" => "on = \"left\"\ndisplacement = [0]\n[[boundary]]\non = \"right\"\ndisplacement = [0]\nphases = [\"press\", \"hold\"]"
        "";
    a_load_that_is_set: "gravity = [1.0]" => "gravity = [1.0]" set "load[2].gravity=[1.0]"
        "";
}

#[test]
fn phases_beside_one_span_of_time_are_refused() {
    let (head, _) = BAR.split_once("[[phase]]").expect("phases");
    let text = format!("{head}[time]\nend = 1.0\nsteps = 2\n");
    let found = told(&Source::new("bar.toml", text), &[]);
    assert_eq!(found, "");
}

#[test]
fn contacts_and_loads_are_those_of_the_phase_asked_for() {
    let problem = case::parse(&Source::new("bar.toml", BAR), &[]).expect("a case").problem;
    let acts = |phase: usize| {
        let problem = problem.in_phase(phase);
        let loads = problem.region_loads.iter().map(|load| !load.body_force.is_empty() || load.gravity.is_some());
        let rigid = problem.rigid.iter().map(|part| !part.force.is_empty());
        let contacts = problem.contacts.iter().map(|contact| contact.acts());
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
