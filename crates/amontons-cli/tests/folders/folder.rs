//! The results folder.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::common::{self, assert_code, assert_same_results, files, read, run_paper, stderr, summary};
use tempfile::tempdir;

/// Columns of a file by name.
fn columns(path: &Path) -> BTreeMap<String, Vec<String>> {
    let text = read(path);
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let mut columns: BTreeMap<String, Vec<String>> = names.iter().map(|&name| (name.to_owned(), Vec::new())).collect();
    for line in lines {
        let values: Vec<&str> = line.split(',').collect();
        assert_eq!(values.len(), names.len(), "{line}");
        for (name, value) in names.iter().zip(values) {
            columns.get_mut(*name).expect("a column").push(value.to_owned());
        }
    }
    columns
}

fn numbers(columns: &BTreeMap<String, Vec<String>>, name: &str) -> Vec<f64> {
    columns[name].iter().map(|value| value.parse().unwrap_or_else(|_| panic!("{name}: {value}"))).collect()
}

#[test]
fn a_folder_holds_what_the_contract_says() {
    let folder = tempdir().expect("a folder");
    let out = folder.path().join("a/b");
    assert_code(&run_paper(&out, 8, &[]), 0);
    let names: Vec<String> =
        files(&out).iter().map(|p| p.strip_prefix(&out).expect("inside").display().to_string()).collect();
    let expected = [
        "case.toml",
        "certificate.json",
        "checkpoint/previous.bin",
        "checkpoint/state.bin",
        "contact/step_0000003.csv",
        "contact/step_0000003.vtu",
        "contact/step_0000006.csv",
        "contact/step_0000006.vtu",
        "contact/step_0000008.csv",
        "contact/step_0000008.vtu",
        "contact.csv",
        "contact.pvd",
        "fields/step_0000000.vtu",
        "fields/step_0000003.vtu",
        "fields/step_0000006.vtu",
        "fields/step_0000008.vtu",
        "fields.pvd",
        "history.csv",
        "manifest.json",
        "summary.json",
    ];
    assert_eq!(names, expected);
    assert!(read(&out.join("case.toml")).contains("steps = 8"), "overrides are applied");

    let history = columns(&out.join("history.csv"));
    assert_eq!(numbers(&history, "step"), (1..=8).map(f64::from).collect::<Vec<_>>());
    let summary = summary(&out);
    for name in
        ["kinetic", "elastic", "viscous_dissipation", "contact_energy", "load_work", "heat_content", "heat_contact"]
    {
        let last = numbers(&history, name)[7];
        assert_eq!(summary["energy"][name].as_f64().map(f64::to_bits), Some(last.to_bits()), "{name}");
    }
    let turned_over = summary["energy"]["turned_over"].as_f64().expect("a number");
    let closing = summary["energy"]["closing_error"].as_f64().expect("a number");
    assert!((numbers(&history, "closing_error")[7] - closing * turned_over).abs() < 1e-20);

    let contact = columns(&out.join("contact.csv"));
    let last = &summary["final"]["contact"];
    assert_eq!(contact["node"].len(), 9);
    for status in ["open", "stick", "slip"] {
        let count = contact["status"].iter().filter(|s| *s == status).count() as u64;
        assert_eq!(last[status].as_u64(), Some(count));
    }
    // The resultant of σν by the weights of the nodes: p on the side below pushes up, friction pulls along σ_τ.
    let weight = |x: f64| if x <= 0.0 || x >= 1.0 { 1.0 / 16.0 } else { 1.0 / 8.0 };
    let x = numbers(&contact, "x");
    let resultant =
        |name: &str| -> f64 { numbers(&contact, name).iter().zip(&x).map(|(value, &x)| weight(x) * value).sum() };
    assert!((resultant("pressure") - last["force"][1].as_f64().expect("a force")).abs() < 1e-12);
    assert!((resultant("traction_x") - last["force"][0].as_f64().expect("a force")).abs() < 1e-12);
    assert!((resultant("heat_flux") - last["heat_flow"].as_f64().expect("a flow")).abs() < 1e-12);
    // Friction opposes slip.
    let (traction, slip) = (numbers(&contact, "traction_x"), numbers(&contact, "slip_velocity_x"));
    assert!(traction.iter().zip(slip).all(|(traction, slip)| traction * slip <= 0.0));
}

#[test]
fn gauss_points_have_a_row_each() {
    let folder = tempdir().expect("a folder");
    let out = folder.path().join("gauss");
    assert_code(&run_paper(&out, 4, &["--set", "contact.quadrature=\"gauss\""]), 0);
    assert_eq!(numbers(&columns(&out.join("contact.csv")), "node"), (0..16).map(f64::from).collect::<Vec<_>>());
}

#[test]
fn a_case_without_contact_has_results_too() {
    let folder = tempdir().expect("a folder");
    let (case, out) = (folder.path().join("free.toml"), folder.path().join("free"));
    let text = read(common::paper().as_ref());
    let (before, rest) = text.split_once("[contact]").expect("a contact");
    let (_, after) = rest.split_once("[initial]").expect("initial data");
    fs::write(&case, format!("{before}[initial]{after}")).expect("a file");
    let arguments = [
        "run",
        &case.display().to_string(),
        "--out",
        &out.display().to_string(),
        "--set",
        "mesh.n=4",
        "--set",
        "time.steps=4",
    ];
    assert_code(&common::output(&mut common::amontons(&arguments)), 0);
    assert_eq!(summary(&out)["unknowns"]["contact"], 0);
    assert_eq!(read(&out.join("contact.csv")).lines().count(), 1);
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let folder = tempdir().expect("a folder");
    let [one, two] = ["1", "2"].map(|threads| {
        let out = folder.path().join(threads);
        assert_code(&run_paper(&out, 6, &["--threads", threads, "--set", "mesh.n=64"]), 0);
        out
    });
    assert_same_results(&one, &two);
}

#[test]
fn results_are_replaced_only_by_force_and_by_a_run_that_has_started_well() {
    let folder = tempdir().expect("a folder");
    let out = folder.path().join("results");
    assert_code(&run_paper(&out, 4, &[]), 0);
    fs::write(out.join("notes.txt"), "mine").expect("a file");
    let (before, count) = (read(&out.join("summary.json")), files(&out).len());

    let refused = run_paper(&out, 5, &[]);
    assert_code(&refused, 2);
    assert!(stderr(&refused).contains("--force"), "{}", stderr(&refused));
    assert_eq!(read(&out.join("summary.json")), before);

    // The load of its first step is infinite.
    let failed = run_paper(&out, 5, &["--force", "--set", "load.body_force=[\"exp(8000*t*(1-t))\", 0]"]);
    assert_code(&failed, 3);
    assert!(stderr(&failed).contains("still holds the results of an earlier run"), "{}", stderr(&failed));
    assert_eq!(read(&out.join("summary.json")), before);
    assert_eq!(files(&out).len(), count, "nothing is left of the run that failed");

    assert_code(&run_paper(&out, 5, &["--force"]), 0);
    assert_eq!(summary(&out)["steps"], 5);
    assert!(!out.join("fields/step_0000004.vtu").exists());
    assert_eq!(read(&out.join("notes.txt")), "mine");
    let anew = folder.path().join("anew");
    assert_code(&run_paper(&anew, 5, &[]), 0);
    fs::remove_file(out.join("notes.txt")).expect("a file");
    assert_same_results(&out, &anew);
}

/// A run that writes its first snapshot at its end finds the folder for it, whatever was in the place before.
#[test]
fn a_run_without_early_snapshots_replaces_another() {
    let folder = tempdir().expect("a folder");
    let out = folder.path().join("results");
    for every in ["output.every=1", "output.every=0", "output.every=0"] {
        assert_code(&run_paper(&out, 5, &["--force", "--set", every]), 0);
        assert!(out.join("fields/step_0000005.vtu").is_file(), "{every}");
    }
    assert_eq!(fs::read_dir(out.join("fields")).expect("a folder").count(), 1);
}

/// Nothing is removed or replaced that is not of a run.
#[test]
fn files_of_others_are_neither_removed_nor_replaced() {
    let folder = tempdir().expect("a folder");
    let out = folder.path().join("results");
    assert_code(&run_paper(&out, 4, &[]), 0);
    let mine = ["inputs/mine.csv", "plots/mine.svg", "fields/mine.vtu", "notes.txt"];
    for name in mine {
        fs::create_dir_all(out.join(name).parent().expect("a folder")).expect("a folder");
        fs::write(out.join(name), "mine").expect("a file");
    }
    assert_code(&run_paper(&out, 5, &["--force"]), 0);
    assert!(mine.iter().all(|name| read(&out.join(name)) == "mine"));
    assert!(!out.join("fields/step_0000004.vtu").exists());

    // A case that lies in the folder is not a result.
    let work = folder.path().join("work");
    fs::create_dir(&work).expect("a folder");
    fs::copy(common::paper(), work.join("case.toml")).expect("a file");
    for further in [&[][..], &["--force"]] {
        let refused = run_paper(&work, 4, further);
        assert_code(&refused, 2);
        assert!(stderr(&refused).contains("case.toml was not written by a run"), "{}", stderr(&refused));
    }
    assert_eq!(files(&work).len(), 1);
    // A manifest that lists what lies outside removes nothing there.
    let manifest = out.join("manifest.json");
    let mut value: serde_json::Value = serde_json::from_str(&read(&manifest)).expect("a manifest");
    value["outputs"]["../work/case.toml"] = serde_json::Value::Null;
    value["outputs"][work.join("case.toml").display().to_string()] = serde_json::Value::Null;
    fs::write(&manifest, value.to_string()).expect("a file");
    assert_code(&run_paper(&out, 5, &["--force"]), 0);
    assert!(work.join("case.toml").is_file());
}

#[test]
fn a_folder_with_a_run_says_what_it_holds() {
    let folder = tempdir().expect("a folder");
    let out = folder.path().join("results");
    assert_code(&run_paper(&out, 4, &[]), 0);
    let told = stderr(&run_paper(&out, 4, &[]));
    assert!(told.contains("a finished run of \"paper\": 4 steps are made") && !told.contains("resume"), "{told}");
    // As a kill leaves it.
    fs::remove_file(out.join("summary.json")).expect("a file");
    let manifest = out.join("manifest.json");
    let mut value: serde_json::Value = serde_json::from_str(&read(&manifest)).expect("a manifest");
    value["end"] = serde_json::Value::Null;
    fs::write(&manifest, value.to_string()).expect("a file");
    let told = stderr(&run_paper(&out, 4, &[]));
    let expected = format!("go on with: amontons resume {}", out.display());
    assert!(told.contains("a run that was broken off of \"paper\": 4 steps") && told.contains(&expected), "{told}");
}

/// Of several writers of a folder one works, and the others are told.
#[test]
fn one_writer_at_a_time() {
    let folder = tempdir().expect("a folder");
    let out = folder.path().join("results");
    let start = |command: &str, further: &[&str]| {
        let (paper, out) = (common::paper(), out.display().to_string());
        let mut arguments: Vec<&str> = vec![command];
        arguments.extend(if command == "run" { vec![paper.as_str(), "--out", &out] } else { vec![out.as_str()] });
        arguments.extend(further);
        let mut command = common::amontons(&arguments);
        command.stdout(std::process::Stdio::piped()).stderr(std::process::Stdio::piped());
        command.spawn().expect("the program starts")
    };
    let long = ["--set", "mesh.n=4", "--set", "time.steps=4000", "--no-certificate"];
    let first = start("run", &long);
    let begin = std::time::Instant::now();
    while fs::metadata(out.join("history.csv")).map_or(0, |meta| meta.len()) < 20_000 {
        assert!(begin.elapsed() < std::time::Duration::from_mins(1), "the run does not start");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    for (command, further) in [("resume", &[][..]), ("run", &["--force"]), ("run", &[])] {
        let told = start(command, further).wait_with_output().expect("the end");
        assert_code(&told, 4);
        let said = stderr(&told);
        assert!(said.contains("is in use by process") && said.contains(&first.id().to_string()), "{said}");
    }
    assert_code(&first.wait_with_output().expect("the end"), 0);
    assert_eq!(read(&out.join("history.csv")).lines().count(), 4001);
    assert!(files(&out).iter().all(|path| !path.ends_with(".amontons.lock")));
}
