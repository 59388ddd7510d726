//! `run --each`: runs for all combinations of values, their table and picture.

use std::fs;
use std::path::Path;

use crate::common::{self, amontons, assert_code, lasting, output, paper, read, stderr, stdout, summary};
use tempfile::tempdir;

const EACH: [&str; 2] = ["contact.friction.coefficient=0.1,0.3", "contact.heat.foundation_temperature=0,10,20"];

fn sweep(out: &Path, more: &[&str]) -> std::process::Output {
    let paper = paper();
    let mut arguments = vec!["run", &paper, "--set", "mesh.n=4", "--set", "time.steps=4", "--no-certificate"];
    let out = out.to_str().expect("text");
    arguments.extend(["--out", out, "--each", EACH[0], "--each", EACH[1]]);
    arguments.extend(more);
    output(&mut amontons(&arguments))
}

/// Rows of a table without quotes, by its columns.
fn rows(text: &str) -> Vec<Vec<String>> {
    text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

#[test]
fn a_sweep_makes_a_run_for_each_combination() {
    let folder = tempdir().expect("a folder");
    let out = folder.path().join("sweep");
    let printed = sweep(&out, &["--jobs", "2"]);
    assert_code(&printed, 0);
    assert!(stdout(&printed).contains("paper: 6 runs") && stdout(&printed).contains("largest temperature"));
    let text = read(&out.join("sweep.csv"));
    // The name of a folder has a comma and is in quotes.
    let table = rows(
        &text
            .replace("\"coefficient=0.3,foundation", "coefficient=0.3 foundation")
            .replace("\"coefficient=0.1,foundation", "coefficient=0.1 foundation")
            .replace('"', ""),
    );
    assert_eq!(table.len(), 7);
    let column = |name: &str| table[0].iter().position(|title| title == name).unwrap_or_else(|| panic!("{name}"));
    let set = [column("contact.friction.coefficient"), column("contact.heat.foundation_temperature")];
    let combinations: Vec<[&str; 2]> = table[1..].iter().map(|row| set.map(|c| row[c].as_str())).collect();
    assert_eq!(combinations, [["0.1", "0"], ["0.1", "10"], ["0.1", "20"], ["0.3", "0"], ["0.3", "10"], ["0.3", "20"]]);
    // Each row is the run that one would make alone.
    let alone = folder.path().join("alone");
    let paper = paper();
    let alone_out = alone.to_str().expect("text");
    let single = output(&mut amontons(&[
        "run",
        &paper,
        "--set",
        "mesh.n=4",
        "--set",
        "time.steps=4",
        "--set",
        "contact.friction.coefficient=0.3",
        "--set",
        "contact.heat.foundation_temperature=10",
        "--no-certificate",
        "--out",
        alone_out,
    ]));
    assert_code(&single, 0);
    let of_sweep = out.join("coefficient=0.3,foundation_temperature=10");
    assert_eq!(lasting(summary(&of_sweep)), lasting(summary(&alone)));
    let temperature = summary(&alone)["final"]["temperature_max"].as_f64().expect("a number");
    assert_eq!(table[5][column("final.temperature_max")], format!("{temperature:?}"));
    let svg = read(&out.join("sweep.svg"));
    assert!(svg.contains("foundation") && svg.contains("0.3") && out.join("sweep.png").exists());
    // What is done is not done again: its seconds stay, and only the run that is gone is made.
    fs::remove_dir_all(&of_sweep).expect("removed");
    let before = fs::metadata(out.join("coefficient=0.1,foundation_temperature=0/summary.json")).expect("a file");
    assert_code(&sweep(&out, &["--quiet"]), 0);
    let after = fs::metadata(out.join("coefficient=0.1,foundation_temperature=0/summary.json")).expect("a file");
    assert_eq!(before.modified().expect("a time"), after.modified().expect("a time"));
    assert_eq!(lasting(summary(&of_sweep)), lasting(summary(&alone)));
}

#[test]
fn faults_of_a_sweep_are_told_before_it_begins() {
    let folder = tempdir().expect("a folder");
    let out = folder.path().join("sweep");
    let paper = paper();
    let run = |more: &[&str]| {
        let mut arguments = vec!["run", &paper, "--out", out.to_str().expect("text")];
        arguments.extend(more);
        output(&mut amontons(&arguments))
    };
    let printed = run(&["--each", "material.density=1,-1"]);
    assert_code(&printed, 2);
    assert!(stderr(&printed).contains("material.density") && stderr(&printed).contains("-1"), "{}", stderr(&printed));
    assert_code(&run(&["--each", "material.density"]), 2);
    assert_code(&run(&["--jobs", "2"]), 2);
    assert!(!out.exists());
}

/// A run that fails is a row of the table, and the others are made.
#[test]
fn a_run_that_fails_does_not_end_the_sweep() {
    let folder = tempdir().expect("a folder");
    let out = folder.path().join("sweep");
    let paper = paper();
    let printed = output(&mut amontons(&[
        "run",
        &paper,
        "--set",
        "mesh.n=4",
        "--set",
        "time.steps=4",
        "--no-certificate",
        "--format",
        "json",
        "--out",
        out.to_str().expect("text"),
        "--each",
        "load.heat_source=1,\"1/(0.5 - t)\",2",
    ]));
    assert_code(&printed, 3);
    let text = read(&out.join("sweep.csv"));
    let outcomes: Vec<bool> = text.lines().skip(1).map(|line| line.contains(",done,")).collect();
    assert_eq!(outcomes, [true, false, true], "{text}");
    let first = json_of_first_line(&stdout(&printed));
    assert_eq!(first["runs"].as_array().map(Vec::len), Some(3));
}

/// The first of the JSON values that are printed.
fn json_of_first_line(text: &str) -> serde_json::Value {
    serde_json::Deserializer::from_str(text).into_iter().next().expect("a value").expect("JSON")
}

/// Interrupted in the middle, the same command goes on, and its table and runs are those of a sweep without a break.
#[test]
#[cfg(unix)]
fn an_interrupted_sweep_goes_on() {
    let folder = tempdir().expect("a folder");
    let [whole, broken] = ["whole", "broken"].map(|name| folder.path().join(name));
    let paper = paper();
    let command = |out: &Path| {
        amontons(&[
            "run",
            &paper,
            "--set",
            "mesh.n=8",
            "--set",
            "time.steps=6000",
            "--no-certificate",
            "--quiet",
            "--out",
            out.to_str().expect("text"),
            "--each",
            "contact.friction.coefficient=0.1,0.2,0.3",
            "--jobs",
            "2",
        ])
    };
    let mut running = command(&broken).spawn().expect("a program");
    // The first runs have begun and none is done.
    let first = broken.join("coefficient=0.1/checkpoint/state.bin");
    while !first.is_file() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let told = std::process::Command::new("kill").args(["-INT", &running.id().to_string()]).status();
    assert!(told.expect("kill").success());
    assert_eq!(running.wait().expect("an end").code(), Some(130));
    assert!(read(&broken.join("sweep.csv")).contains(",interrupted,"));
    assert_code(&output(&mut command(&broken)), 0);
    assert_code(&output(&mut command(&whole)), 0);
    for run in ["coefficient=0.1", "coefficient=0.2", "coefficient=0.3"] {
        common::assert_same_results(&whole.join(run), &broken.join(run));
    }
    assert_eq!(read(&whole.join("sweep.svg")), read(&broken.join("sweep.svg")));
}

/// The printed table has the probes and units, and no number without one that has a unit.
#[test]
fn the_table_has_probes_and_units() {
    let folder = tempdir().expect("a folder");
    let probe = "probe=[{ name = \"top\", quantity = \"displacement_y\", on = \"top\", take = \"mean\" }, { name = \"mid\", quantity = \"stress_yy\", at = [0.5, 0.5] }]";
    let printed = stdout(&sweep(&folder.path().join("sweep"), &["--set", probe, "--set", "units=\"SI\""]));
    let lines: Vec<&str> = printed.lines().collect();
    let header = lines.iter().find(|line| line.contains("outcome")).expect("a header");
    assert!(header.contains("mid") && header.contains("largest pressure"), "{printed}");
    let rows: Vec<&&str> = lines.iter().filter(|line| line.contains(" done ")).collect();
    assert_eq!(rows.len(), 6, "{printed}");
    assert!(rows.iter().all(|row| row.contains("Pa") && row.contains('K')), "{printed}");
    let svg = read(&folder.path().join("sweep/sweep.svg"));
    assert!(svg.contains("in Pa"), "the picture has units");
}

/// Results of earlier runs stay, and the next free folder is taken.
#[test]
fn a_run_is_made_again() {
    let folder = tempdir().expect("a folder");
    let out = folder.path().join("paper").display().to_string();
    let run = |more: &[&str]| {
        let paper = paper();
        let mut arguments = vec![
            "run",
            &paper,
            "--set",
            "mesh.n=4",
            "--set",
            "time.steps=2",
            "--no-certificate",
            "--quiet",
            "--out",
            &out,
        ];
        arguments.extend(more);
        output(&mut amontons(&arguments))
    };
    assert_code(&run(&["--again"]), 0);
    let first = fs::metadata(Path::new(&out).join("summary.json")).expect("a file").modified().expect("a time");
    let refused = run(&[]);
    assert_code(&refused, 2);
    assert!(stderr(&refused).contains("--again"), "{}", stderr(&refused));
    for number in 2..4 {
        assert_code(&run(&["--again"]), 0);
        assert!(Path::new(&format!("{out}-{number}")).join("summary.json").is_file());
    }
    let now = fs::metadata(Path::new(&out).join("summary.json")).expect("a file").modified().expect("a time");
    assert_eq!(first, now);
    assert_code(&run(&["--again", "--force"]), 2);
    common::assert_same_results(Path::new(&out), Path::new(&format!("{out}-3")));
}
