//! Warnings about displacements and contacts that begin with a phase where the body is not.

use amontons::hypotheses::{self, Finding, FindingId};
use amontons::problem::Problem;
use amontons::run::{self, Settings};
use amontons::time::TimeScheme;

use crate::acting::{ROD, closes, read, run};
use crate::common::changed;

fn found(findings: &[Finding], id: FindingId) -> Vec<&Finding> {
    findings.iter().filter(|finding| finding.id == id).collect()
}

/// The findings at the end of a run.
fn warned(problem: &Problem) -> Vec<Finding> {
    run::run(problem, &Settings::default(), &mut []).expect("a run").findings
}

#[test]
fn a_displacement_that_begins_elsewhere_in_a_dynamic_phase_is_told() {
    let begins =
        "[[boundary]]\non = \"right\"\ndisplacement = [0.03]\nphases = [\"free\"]\n[[phase]]\nname = \"press\"";
    let text = ROD.replace("[[phase]]\nname = \"press\"", begins);
    let dynamic = text.replace("end = 2.0\nsteps = 4\nanalysis = \"quasistatic\"", "end = 2.0\nsteps = 40");
    assert!(found(&warned(&read(&text)), FindingId::PhaseJump).is_empty());
    let warnings = warned(&read(&dynamic));
    let [jump] = found(&warnings, FindingId::PhaseJump)[..] else { panic!("{warnings:?}") };
    assert_eq!(
        jump.message,
        "at t = 1, where the phase \"free\" begins, the displacement that is prescribed on \"right\" is 0.13 away from where the side is then, at x = 1.0: the first step brings it there, with a velocity that is the larger the shorter the step, and waves by it"
    );
    // It begins where the side is, and goes on from there.
    let ramp = dynamic.replace("displacement = [0.03]", "displacement = [\"0.1*(t - 2)\"]");
    assert!(found(&warned(&read(&ramp)), FindingId::PhaseJump).is_empty());
    // A contact that ends in it is physics.
    let plain = ROD.replace("end = 2.0\nsteps = 4\nanalysis = \"quasistatic\"", "end = 2.0\nsteps = 40");
    assert!(found(&warned(&read(&plain)), FindingId::PhaseJump).is_empty());
}

#[test]
fn jumps_that_the_data_tell_are_told_before_the_run() {
    let of = |first: &str, second: &str, analysis: &str| {
        let text = ROD.replace(
            "[[contact]]\non = \"right\"\ngap = \"-0.1*t\"\nnormal = { law = \"signorini\" }\n",
            &format!("[[boundary]]\non = \"right\"\ndisplacement = [{first}]\n"),
        );
        let second = format!(
            "[[boundary]]\non = \"right\"\ndisplacement = [{second}]\nphases = [\"free\"]\n[[phase]]\nname = \"press\""
        );
        let text = text.replace("[[phase]]\nname = \"press\"", &second);
        let text =
            text.replace("steps = 4\nanalysis = \"quasistatic\"", &format!("steps = 4\nanalysis = \"{analysis}\""));
        let findings = hypotheses::findings(&read(&text));
        found(&findings, FindingId::PhaseJump)
            .iter()
            .map(|f| (f.place.clone(), f.value.unwrap_or(0.0)))
            .collect::<Vec<_>>()
    };
    assert!(of("\"0.1*t\"", "0.2", "quasistatic").is_empty());
    let one = of("\"0.1*t\"", "0.2", "dynamic");
    assert!(one.len() == 1 && one[0].0 == "boundary[2].displacement" && (one[0].1 - 0.1).abs() < 1e-15, "{one:?}");
    assert!(of("\"0.1*t\"", "\"0.1*t\"", "dynamic").is_empty());
    let both = of("0.1", "0.1", "dynamic");
    assert!(both.len() == 1 && both[0].0 == "boundary[1].displacement", "{both:?}");
    assert_eq!(of("\"if(t > 0, 0.1, 0)\"", "0.1", "dynamic").len(), 1);
}

#[test]
fn a_side_that_is_inside_where_a_contact_begins_is_told() {
    let text = ROD.replace("phases = [\"press\"]", "phases = [\"free\"]").replace("gap = \"-0.1*t\"", "gap = 0.0");
    let pulled = "[[boundary]]\non = \"right\"\ntraction = [0.4]\n[[contact]]";
    let text = text.replace("[[contact]]", pulled);
    let warnings = warned(&read(&text));
    let [inside] = found(&warnings, FindingId::StartInside)[..] else { panic!("{warnings:?}") };
    assert_eq!(
        inside.message,
        "at t = 1, where the phase \"free\" begins and with it the contact, \"right\" is inside its foundation by up to 0.1, at x = 1.0: the first step pushes it out"
    );
    let dynamic = text.replace("end = 2.0\nsteps = 4\nanalysis = \"quasistatic\"", "end = 2.0\nsteps = 40");
    let problem = changed(&read(&dynamic), |data| data.scheme = TimeScheme::theta(0.5));
    let warnings = warned(&problem);
    assert!(found(&warnings, FindingId::StartKept)[0].message.ends_with("so that this distance stays"));
    closes(&run(&problem).states);
    // An interference that the gap gives is meant.
    let meant = text.replace("traction = [0.4]", "traction = [0]").replace("gap = 0.0", "gap = -0.1");
    assert!(found(&warned(&read(&meant)), FindingId::StartInside).is_empty());
}
