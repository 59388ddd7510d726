//! Studies, pictures and verification from the command line.
#![allow(clippy::too_many_lines, reason = "a test is one list of cases")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

pub fn amontons(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_amontons")).args(arguments).output().expect("the program starts")
}

pub fn paper() -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/paper.toml").display().to_string()
}

pub fn text(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn converge_writes_table_and_picture_and_reuses_finished_levels() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("study");
    let out_text = out.display().to_string();
    let case = paper();
    let arguments = ["converge", &case, "--levels", "4,8", "--reference", "16", "--out", &out_text, "--quiet"];
    let done = amontons(&arguments);
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    let first = text(&out.join("convergence.csv"));
    assert!(first.starts_with("level,h,k,error_w,error_u,error_theta,error,order\n4,"));
    for name in ["convergence.json", "convergence.svg", "convergence.png"] {
        assert!(out.join(name).exists(), "{name}");
    }
    // The numbers at the end, of both levels and of the reference, with order and limit or a reason.
    let values = text(&out.join("convergence-values.csv"));
    assert!(values.starts_with("quantity,level,h,k,value,order,limit,limit_error,remark\n"), "{values}");
    let elastic: Vec<&str> = values.lines().filter(|line| line.starts_with("elastic,")).collect();
    assert_eq!(elastic.len(), 3, "{values}");
    let last: Vec<&str> = elastic[2].split(',').collect();
    assert!(last[1] == "16" && last[4].parse::<f64>().is_ok_and(|value| value > 0.0), "{last:?}");
    assert_eq!(last[5].is_empty(), !last[8].is_empty(), "an order or a reason: {last:?}");
    // A finished study is not overwritten.
    assert_eq!(amontons(&arguments).status.code(), Some(2));
    // Without its table it is one that was interrupted: the levels are taken as they are, and the table is the same.
    fs::remove_file(out.join("convergence.csv")).expect("the table");
    let kept = fs::metadata(out.join("levels/8.bin")).and_then(|m| m.modified()).expect("a finished level");
    assert_eq!(amontons(&arguments).status.code(), Some(0));
    assert_eq!(text(&out.join("convergence.csv")), first);
    assert_eq!(text(&out.join("convergence-values.csv")), values);
    assert_eq!(
        fs::metadata(out.join("levels/8.bin")).and_then(|m| m.modified()).expect("a finished level"),
        kept,
        "the level was solved again"
    );
    // A damaged level is solved anew.
    fs::remove_file(out.join("convergence.csv")).expect("the table");
    fs::write(out.join("levels/8.bin"), b"spoiled").expect("a file");
    assert_eq!(amontons(&arguments).status.code(), Some(0));
    assert_eq!(text(&out.join("convergence.csv")), first);
}

/// The pad that is stopped: its data were made with 0.42, 0.15, 0.0015 and 900 W/(m² K), and noise.
#[test]
fn fit_finds_the_parameters_of_the_pad_that_is_stopped() {
    let folder = tempfile::tempdir().expect("a folder");
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases");
    let [case, data] = ["pad-stop.toml", "pad-stop.csv"].map(|name| cases.join(name).display().to_string());
    let out = folder.path().join("fit");
    let out_text = out.display().to_string();
    let keys = "constants.mu0,constants.exponent,constants.fade,contact.heat.conductance";
    let with =
        |rest: &[&str]| amontons(&[&["fit", &case, "--data", &data, "--out", &out_text, "--free"], rest].concat());
    // The state of another descent is kept.
    fs::create_dir(&out).expect("a folder");
    fs::write(out.join("descent.json"), "{}").expect("a file");
    let refused = with(&[keys]);
    assert_eq!(refused.status.code(), Some(2));
    let message = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(message.contains("holds an unfinished fit of another case, other data or other parameters"), "{message}");
    let done = with(&[keys, "--bounds", "constants.mu0=0,1", "--force"]);
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    let told = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(told.contains("pad-stop: 4 parameters from 200 values") && !told.contains("not determine"), "{told}");
    for name in ["fit.csv", "fit.json", "fit.svg", "fit.png", "residuals.csv", "case.toml"] {
        assert!(out.join(name).exists(), "{name}");
    }
    assert!(!out.join("descent.json").exists());
    let table = text(&out.join("fit.csv"));
    for (row, truth) in table.lines().skip(1).zip([0.42, 0.15, 1.5e-3, 900.0]) {
        let numbers: Vec<f64> = row.split(',').skip(2).take(5).map(|entry| entry.parse().expect("a number")).collect();
        let [_, value, deviation, low, high] = numbers[..] else { panic!("{row}") };
        assert!((value - truth).abs() < 3.0 * deviation && low < value && value < high, "{row}");
    }
    assert_eq!(text(&out.join("residuals.csv")).lines().count(), 201);
    // The case in the folder has the values found: it fits as well with nothing to change.
    let [mu0, value] = ["mu0 = ", "conductance = "].map(|key| {
        let case = text(&out.join("case.toml"));
        let line = case.lines().find_map(|line| Some(line.split_once(key)?.1.to_owned())).expect("a key");
        line.chars()
            .take_while(|c| c.is_ascii_digit() || *c == '.')
            .collect::<String>()
            .parse::<f64>()
            .expect("a number")
    });
    assert!((mu0 - 0.42).abs() < 0.02 && (value - 900.0).abs() < 30.0, "{mu0} {value}");
    // A finished fit is not overwritten.
    assert_eq!(with(&[keys]).status.code(), Some(2));
    for (rest, message) in [
        (
            &["constants.mu0", "--bounds", "constants.fade=0,1"][..],
            "found the key constants.fade, expected KEY=LOW,HIGH",
        ),
        (&["constants.mu0", "--bounds", "constants.mu0"][..], "found no `=`, expected KEY=LOW,HIGH"),
        (&["constants.mu0", "--bounds", "constants.mu0=0,one"][..], "found `one`, expected KEY=LOW,HIGH"),
        (&["constants.mu1"][..], "constants.mu1: found no value, expected a key with a number"),
        (&["mesh.n[0]", "--force"][..], "mesh.n[0]: found 30.0, expected an integer"),
        (&["time.steps", "--force"][..], "time.steps"),
    ] {
        let refused = with(rest);
        let told = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!(refused.status.code(), Some(2), "{rest:?}: {told}");
        assert!(told.contains(message), "{rest:?}: {told}");
    }
}

#[test]
fn gradient_writes_a_table_and_refuses_what_has_no_derivative() {
    let folder = tempfile::tempdir().expect("a folder");
    let (out, case) = (folder.path().join("gradient"), paper());
    let out_text = out.display().to_string();
    let with = |of: &str, with: &str| {
        let small = ["--set", "mesh.n=4", "--set", "time.steps=4", "--out", &out_text];
        amontons(&[&["gradient", &case, "--of", of, "--with", with], &small[..]].concat())
    };
    let key = "contact.friction.coefficient";
    let done = with("final.contact.force.0,energy.friction_dissipation", key);
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    let told = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(told.contains("final.contact.force.0") && told.contains("margin"), "{told}");
    let table = text(&out.join("gradient.csv"));
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows[0], "output,parameter,value,at,derivative,margin,beyond");
    assert!(rows.len() == 3 && rows[1].starts_with("final.contact.force.0,contact.friction.coefficient,"), "{table}");
    assert!(out.join("gradient.json").exists() && out.join("case.toml").exists());
    // Derivatives that are there are not overwritten.
    assert_eq!(with("final.contact.force.0", key).status.code(), Some(2));
    fs::remove_file(out.join("gradient.csv")).expect("the table");
    for (of, by, message) in [
        ("final.contact.force.7", key, "found no number with derivatives"),
        ("final.contact.force.0", "contact.friction.law", "expected a key with a number"),
        ("final.contact.force.0", "mesh.n", "expected"),
    ] {
        let done = with(of, by);
        let told = String::from_utf8_lossy(&done.stderr).into_owned();
        assert_eq!(done.status.code(), Some(2), "{told}");
        assert!(told.contains(message), "{told}");
    }
}

/// The coefficient of friction at which two modes of a block meet (squeal.json of the references), with its
/// derivatives. By dimensions it depends on the ratio of the stiffnesses of layer and block alone.
#[test]
fn modes_give_the_derivatives_of_a_critical_value() {
    let folder = tempfile::tempdir().expect("a folder");
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let case = root.join("crates/amontons/tests/reference/stability/block-a-compliance.toml").display().to_string();
    let out = folder.path().join("modes");
    let keys = "material.elasticity.young,contact.normal.stiffness,material.density";
    let critical = |young: f64, with: &[&str]| -> serde_json::Value {
        let (set, out) = (format!("material.elasticity.young={young:?}"), out.display().to_string());
        let search = ["time.analysis=\"steady\"", "time.steps=1", "stability.count=6"];
        let range = "contact.friction.coefficient=0.3,0.5";
        let mut all = vec!["modes", &case, "--set", &set, "--out", &out, "--force", "--format", "json"];
        all.extend(search.iter().flat_map(|set| ["--set", set]));
        all.extend(["--critical", range]);
        all.extend(with);
        let done = amontons(&all);
        assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
        serde_json::from_slice(&done.stdout).expect("a table")
    };
    let found = critical(1.0, &["--with", keys]);
    let number = |value: &serde_json::Value| value.as_f64().unwrap_or(f64::NAN);
    let value = number(&found["critical"]["value"]);
    assert!((value - 0.403_689_391_152_555).abs() < 1e-8, "{value}");
    let by = |key: &str| number(&found["critical"]["by"][key]["relative"]);
    let [young, layer, density] =
        [by("material.elasticity.young"), by("contact.normal.stiffness"), by("material.density")];
    assert!((young + layer).abs() < 1e-6 && young.abs() > 0.1 && density.abs() < 1e-6, "{young}, {layer}, {density}");
    let h = 0.01;
    let [low, high] = [1.0 - h, 1.0 + h].map(|young| number(&critical(young, &[])["critical"]["value"]));
    let slope = (high - low) / (2.0 * h) / value;
    assert!((slope - young).abs() < 1e-3 * young.abs(), "{slope} and {young}");
    // The table has the derivatives of each mode; where the key is no number, none.
    let table = text(&out.join("modes.csv"));
    assert!(!table.lines().next().unwrap_or_default().contains("_by_"), "{table}");
    let bad =
        ["modes", &case, "--with", "contact.friction.law", "--out", &folder.path().join("no").display().to_string()];
    let refused = amontons(&bad);
    assert!(String::from_utf8_lossy(&refused.stderr).contains("expected a key with a number"));
    assert_ne!(refused.status.code(), Some(0));
}

#[test]
fn levels_that_do_not_fit_are_bad_usage() {
    let case = paper();
    for (arguments, message) in [
        (vec!["--levels", "8,4"], "each finer than the one before"),
        (vec!["--levels", "8"], "at least one level besides the reference"),
        (vec!["--levels", "8,16", "--reference", "12"], "finer than the finest level"),
        (vec!["--levels", "6", "--reference", "16"], "no common times"),
        (vec!["--levels", "8,16", "--exact"], "closed form"),
        (vec!["--levels", "0,16"], "positive levels"),
        (vec!["--levels", "4", "--reference", "8", "--each", "contact.gap"], "KEY=VALUE"),
        (vec!["--levels", "4", "--reference", "8", "--set", "material.density=-1"], "density"),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        let out = folder.path().join("study").display().to_string();
        let mut all = vec!["converge", &case, "--out", &out];
        all.extend(&arguments);
        let done = amontons(&all);
        let said = String::from_utf8_lossy(&done.stderr).into_owned();
        assert_eq!(done.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(message), "{arguments:?}: {said}");
    }
}

#[test]
fn meshes_that_are_not_nested_are_compared_on_their_intersections() {
    let folder = tempfile::tempdir().expect("a folder");
    let case = paper();
    let error = |name: &str, reference: &str, diagonal: &str| {
        let out = folder.path().join(name).display().to_string();
        let done = amontons(&[
            "converge",
            &case,
            "--vary",
            "space",
            "--levels",
            "4",
            "--reference",
            reference,
            "--set",
            &format!("mesh.diagonal={diagonal}"),
            "--set",
            "time.steps=4",
            "--out",
            &out,
            "--quiet",
        ]);
        assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
        let table = text(&folder.path().join(name).join("convergence.csv"));
        let row: Vec<f64> = table.lines().nth(1).expect("a row").split(',').filter_map(|v| v.parse().ok()).collect();
        row[6]
    };
    // 12 = 3 · 4 is nested, 13 is not; the errors against nearly the same reference nearly agree.
    let (nested, not) = (error("nested", "12", "right"), error("not", "13", "right"));
    assert!((nested / not - 1.0).abs() < 0.05, "{nested} {not}");
}

#[test]
fn verify_exits_with_1_where_a_value_does_not_hold() {
    let done = amontons(&["verify", "manufactured-p", "--format", "json"]);
    assert_eq!(done.status.code(), Some(0));
    let said: serde_json::Value = serde_json::from_slice(&done.stdout).expect("JSON");
    assert_eq!(said["holds"], true);
    let refused = amontons(&["verify", "no-such-benchmark"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        String::from_utf8_lossy(&refused.stderr)
            .starts_with("Error: no-such-benchmark is no case file, no results folder and no benchmark")
    );

    // A results folder whose figures were changed.
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("run");
    let out_text = out.display().to_string();
    assert_eq!(
        amontons(&[
            "run",
            &paper(),
            "--set",
            "mesh.n=8",
            "--set",
            "time.steps=4",
            "--out",
            &out_text,
            "--quiet",
            "--plot"
        ])
        .status
        .code(),
        Some(0)
    );
    assert!(out.join("plots/temperature.svg").exists());
    assert_eq!(amontons(&["verify", &out_text, "--quiet"]).status.code(), Some(0));
    let summary = text(&out.join("summary.json"));
    let mut spoiled: serde_json::Value = serde_json::from_str(&summary).expect("JSON");
    spoiled["final"]["temperature_max"] = serde_json::json!(7.0);
    fs::write(out.join("summary.json"), spoiled.to_string()).expect("a file");
    assert_eq!(amontons(&["verify", &out_text, "--quiet"]).status.code(), Some(1));
    assert_eq!(amontons(&["plot", &folder.path().join("nothing").display().to_string()]).status.code(), Some(4));
}

/// u_x = x²/2 of a rod of uniaxial strain with E = 1, ν = 0 under the body force −1, fixed at 0 and with the traction 1
/// at its other end.
const ROD: &str = r#"
name = "rod"
mesh = { kind = "interval", size = 1, n = 4, elements = "P2" }
time = { end = 1, steps = 1 }
load = { body_force = [-1] }
boundary = [{ on = "left", displacement = [0], temperature = 0 }, { on = "right", traction = [1] }]

[material]
density = 0
heat_capacity = 0
expansion = 0
coupling = 0
conductivity = 1
elasticity = { law = "isotropic", young = 1, poisson = 0 }
viscosity = { law = "lame", first = 0, second = 0 }
"#;

const EXPECTED: &str = r#"
[expected.values]
"final.displacement_max" = [0.5]
"final.temperature_max" = 0
"#;

const VERIFY: &str = r#"
[verify]
title = "a rod under its weight"
source = "u = x²/2"
[[verify.check]]
kind = "probe"
field = "displacement_x"
at = [0.5]
time = 1
reference = 0.125
tolerance = 1e-12
[[verify.check]]
kind = "history"
column = "elastic"
reference = 0.16666666666666666
tolerance = 1e-12
"#;

#[test]
fn verify_evaluates_the_blocks_of_a_case_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("rod.toml");
    let path = file.display().to_string();
    let verify = |text: &str, more: &[&str]| {
        fs::write(&file, text).expect("a file");
        amontons(&[&["verify", &path], more].concat())
    };
    for (blocks, values) in [(EXPECTED.to_owned(), 2), (VERIFY.to_owned(), 2), (format!("{EXPECTED}{VERIFY}"), 4)] {
        let done = verify(&format!("{ROD}{blocks}"), &[]);
        let (said, told) =
            (String::from_utf8_lossy(&done.stdout).into_owned(), String::from_utf8_lossy(&done.stderr).into_owned());
        assert_eq!(done.status.code(), Some(0), "{said}{told}");
        assert!(said.ends_with(&format!("{values} of {values} values hold\n")), "{said}");
    }
    // With twice the stiffness half the displacement, and half the energy: three of four values do not hold.
    let done =
        verify(&format!("{ROD}{EXPECTED}{VERIFY}"), &["--set", "material.elasticity.young=2", "--format", "json"]);
    assert_eq!(done.status.code(), Some(1));
    let said: serde_json::Value = serde_json::from_slice(&done.stdout).expect("one document of JSON");
    let computed: Vec<f64> =
        said["verdicts"].as_array().expect("verdicts").iter().filter_map(|v| v["computed"].as_f64()).collect();
    for (computed, expected) in computed.iter().zip([0.25, 0.0, 0.0625, 1.0 / 12.0]) {
        assert!((computed - expected).abs() < 1e-12, "{computed}, expected {expected}");
    }
    let holds: Vec<bool> =
        said["verdicts"].as_array().expect("verdicts").iter().filter_map(|v| v["holds"].as_bool()).collect();
    assert_eq!(
        (holds, &said["holds"], &said["error"]["exit_code"]),
        (vec![false, true, false, false], &serde_json::json!(false), &serde_json::json!(1))
    );
}

#[test]
fn verify_refuses_what_it_cannot_compare() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("rod.toml");
    let path = file.display().to_string();
    let wrong = |from: &str, to: &str| format!("{ROD}{EXPECTED}{VERIFY}").replace(from, to);
    let cases = [
        (ROD.to_owned(), "has nothing to compare; add [expected] with values of summary.json, or [[verify.check]]"),
        (
            wrong("final.temperature_max", "final.temperature"),
            "summary.json has no such value there, expected 1 number",
        ),
        (wrong("[0.5]\n\"", "[0.5, 0]\n\""), "summary.json has 1 number there, expected 2 numbers"),
        (wrong("\"elastic\"", "\"elastik\""), "did you mean \"elastic\"?"),
        (wrong("time = 1\n", "time = 1.5\n"), "a time from 0 to time.end = 1"),
        (
            wrong("kind = \"history\"\ncolumn = \"elastic\"", "kind = \"error\"\nerror = \"error_u\""),
            "no [exact] to compare with",
        ),
    ];
    for (text, part) in cases {
        fs::write(&file, text).expect("a file");
        let refused = amontons(&["verify", &path]);
        let told = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!(refused.status.code(), Some(2), "{told}");
        assert!(told.contains(part), "{told}");
    }
}

#[test]
fn reproduce_makes_the_figures_and_a_report() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("figures");
    let out_text = out.display().to_string();
    let done = amontons(&[
        "reproduce",
        "--levels",
        "4,8",
        "--reference",
        "16",
        "--set",
        "mesh.n=16",
        "--set",
        "time.steps=16",
        "--out",
        &out_text,
        "--quiet",
    ]);
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    for reading in ["default", "identity", "literal"] {
        for figure in ["figure-2-deformed", "figure-3-temperature", "figure-4-von-mises", "figure-5-errors"] {
            for format in ["svg", "png"] {
                assert!(out.join(reading).join(format!("{figure}.{format}")).exists(), "{reading}: {figure}.{format}");
            }
        }
    }
    let report = text(&out.join("report.md"));
    // With 𝓜 the identity the deformation is smaller on the warm foundation, against the paper's statement.
    assert_eq!(report.matches("do **not** support statement 1").count(), 1);
    for (reading, figure) in [("default", "figure-2-deformed"), ("literal", "figure-5-errors")] {
        assert!(report.contains(&format!("]({reading}/{figure}.png)")), "{reading}: {figure} is not in the report");
    }
    // States that finished studies do not need are removed, and nothing is computed again.
    assert!(!out.join("default/study-0/levels").exists());
    let made = |name: &str| fs::metadata(out.join(name)).and_then(|meta| meta.modified()).expect("a file");
    let names = ["default/run-0/summary.json", "literal/run-10/history.csv", "identity/study-10/convergence.json"];
    let before = names.map(made);
    fs::remove_file(out.join("report.md")).expect("the report");
    fs::remove_file(out.join("identity/study-0/study.sha256")).expect("the mark of a finished study");
    let again = [
        "reproduce",
        "--levels",
        "4,8",
        "--reference",
        "16",
        "--set",
        "mesh.n=16",
        "--set",
        "time.steps=16",
        "--out",
        &out_text,
        "--progress",
        "json",
        "--quiet",
    ];
    let done = amontons(&again);
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    assert_eq!(names.map(made), before, "a finished part was computed again");
    assert_eq!(text(&out.join("report.md")), report);
    let said = String::from_utf8_lossy(&done.stderr).into_owned();
    assert!(
        said.contains("study 3 of 6 (identity, θ_F = 0)")
            && !said.contains("study 1 of 6")
            && !said.contains("run 1 of 6"),
        "{said}"
    );
    // A study with other levels is another one.
    fs::remove_file(out.join("report.md")).expect("the report");
    let other = amontons(&[
        "reproduce",
        "--levels",
        "2,4",
        "--reference",
        "8",
        "--set",
        "mesh.n=16",
        "--set",
        "time.steps=16",
        "--out",
        &out_text,
        "--quiet",
    ]);
    assert_eq!(other.status.code(), Some(0));
    assert!(names[..2].iter().zip(before).all(|(name, before)| made(name) == before) && made(names[2]) != before[2]);
}
