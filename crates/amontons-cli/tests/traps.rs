//! Warnings and the size of a model as the program prints them.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod common;

use common::{amontons, assert_code, json, output, paper, run_paper, stderr, stdout, summary};
use tempfile::tempdir;

/// A rigid foundation, Coulomb's friction, a conductance of the pressure, no viscosity; stiff enough for small strains.
const STANDARD: [&str; 12] = [
    "--set",
    "contact.normal={ law = \"signorini\" }",
    "--set",
    "contact.heat={ law = \"pressure\", coefficient = 1.0, foundation_temperature = 1.0 }",
    "--set",
    "material.viscosity={ law = \"lame\", first = 0.0, second = 0.0 }",
    "--set",
    "material.elasticity.young=2e3",
    "--set",
    "mesh.n=16",
    "--set",
    "scheme.coupling=\"staggered\"",
];

#[test]
fn a_standard_case_ends_without_the_word_fails() {
    let folder = tempdir().expect("a folder");
    let out = folder.path().join("standard").display().to_string();
    let case = paper();
    let arguments = [&["run", case.as_str(), "--out", out.as_str(), "--set", "time.steps=8"], &STANDARD[..]].concat();
    let printed = output(&mut amontons(&arguments));
    assert_code(&printed, 0);
    let text = stdout(&printed);
    assert!(!text.contains("fails") && !text.contains("Warning"), "{text}");
    let line = text.lines().last().expect("a line");
    assert!(
        line.starts_with("Not covered by the theory: H1")
            && line.contains(", H8")
            && line.ends_with("; see `amontons check`"),
        "{line}"
    );

    // The certificate says all of it, and so does the summary.
    let printed = output(&mut amontons(&[&["check", case.as_str()], &STANDARD[..]].concat()));
    assert!(stdout(&printed).contains("(H8)") && stdout(&printed).contains("not-covered"), "{}", stdout(&printed));
    let kept = summary(out.as_ref());
    let h8 = kept["findings"].as_array().and_then(|all| all.iter().find(|f| f["id"] == "H8")).expect("a finding");
    assert_eq!((&h8["status"], &h8["kind"]), (&"not-covered".into(), &"theory".into()));
    assert_eq!(kept["warnings"], serde_json::json!([]));
}

/// The strain of the paper's own data is not small.
#[test]
fn a_warning_has_place_and_repair() {
    let folder = tempdir().expect("a folder");
    let out = folder.path().join("paper");
    let printed = run_paper(&out, 8, &[]);
    assert_code(&printed, 0);
    let text = stdout(&printed);
    assert!(
        text.contains("Warning (strain): the largest principal strain is")
            && text.contains("(material.elasticity)\n  to repair it: "),
        "{text}"
    );
    let kept = summary(&out);
    let warning = &kept["warnings"][0];
    assert_eq!(
        (&warning["id"], &warning["kind"], &warning["value"]),
        (&"strain".into(), &"warning".into(), &kept["final"]["strain_max"])
    );
    assert!(
        kept["final"]["undershoot"].is_number()
            && kept["final"]["penetration_per_cell"].as_f64().is_some_and(|ratio| ratio < 0.1)
    );
}

#[test]
fn check_gives_the_size_of_the_model() {
    let case = paper();
    let arguments = ["check", case.as_str(), "--set", "mesh.n=16", "--set", "material.density=3.0"];
    let printed = output(&mut amontons(&arguments));
    assert_code(&printed, 0);
    for part in [
        "bounding box      0.00000e0 … 1.00000e0 × 0.00000e0 … 1.00000e0\n",
        "volume 1.00000e0, mass 3.00000e0\n",
        "side \"bottom\"     area 1.00000e0, 17 contact points",
        "first period",
        "heat time",
        "√(k K/c) = 0.125 in a step, 1 in the run, cell 0.0625 high on \"bottom\"",
        "What you can act on:",
        "What the theory covers:",
    ] {
        assert!(stdout(&printed).contains(part), "{part} is not in\n{}", stdout(&printed));
    }
    // The same numbers in SI units, per metre of thickness.
    let printed = output(&mut amontons(&[&arguments[..], &["--set", "units=\"SI\""]].concat()));
    for part in [
        "… 1.00000e0 m\n",
        "volume 1.00000e0 m³/m, mass 3.00000e0 kg/m\n",
        "area 1.00000e0 m²/m, 17",
        "√(k K/c) = 125 mm in a step, 1 m in",
    ] {
        assert!(stdout(&printed).contains(part), "{part} is not in\n{}", stdout(&printed));
    }
    let printed = output(&mut amontons(&[&arguments[..], &["--format", "json"]].concat()));
    let told = json(&printed);
    let model = &told["model"];
    assert!(model["mass"].as_f64().is_some_and(|mass| (mass / 3.0 - 1.0).abs() < 1e-12), "{}", model["mass"]);
    assert_eq!((&model["contact_points"]["bottom"], &model["parts"]), (&17.into(), &1.into()));
    assert_eq!(model["box"], serde_json::json!([[0.0, 0.0], [1.0, 1.0]]));
    for key in ["first_period", "heat"] {
        assert!(model["times"][key].as_f64().is_some_and(|time| time > 0.0), "{key}");
    }
    assert!(
        model["cost"]["memory_bytes"].as_f64().is_some_and(|bytes| bytes > 0.0)
            && told["findings"].is_array()
            && told["constants"].is_object()
    );
}

#[test]
fn a_datum_that_is_not_finite_ends_the_run_with_its_key() {
    let folder = tempdir().expect("a folder");
    let printed = run_paper(&folder.path().join("datum"), 4, &["--set", "load.heat_source=\"1/(t - 0.5)\""]);
    assert_code(&printed, 3);
    let text = stderr(&printed);
    assert!(
        text.contains("step 2 (t = 5.000000e-1): load.heat_source is inf at (0, 0, 0), t = 0.5:")
            && text.contains("correct load.heat_source"),
        "{text}"
    );
}
