//! Running the program.
#![allow(dead_code, clippy::expect_used, clippy::panic, reason = "each test uses its part, and fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

/// The built program, without colours.
pub fn amontons(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_amontons"));
    command.args(arguments).env("NO_COLOR", "1");
    command
}

/// The paper's case.
pub fn paper() -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/paper.toml").display().to_string()
}

/// The paper's case, small, with further arguments.
pub fn run_paper(out: &Path, steps: usize, further: &[&str]) -> Output {
    let steps = format!("time.steps={steps}");
    let out = out.display().to_string();
    let paper = paper();
    let mut arguments = vec![
        "run",
        paper.as_str(),
        "--out",
        out.as_str(),
        "--set",
        "mesh.n=8",
        "--set",
        steps.as_str(),
        "--set",
        "output.every=3",
    ];
    arguments.extend(further);
    output(&mut amontons(&arguments))
}

/// What the program prints and its exit code.
pub fn output(command: &mut Command) -> Output {
    command.output().expect("the program starts")
}

/// The exit code, with what was printed in the message when it is another.
pub fn assert_code(output: &Output, code: i32) {
    assert_eq!(output.status.code(), Some(code), "stdout:\n{}\nstderr:\n{}", stdout(output), stderr(output));
}

pub fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Standard output as JSON.
pub fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}:\n{}", stdout(output)))
}

pub fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

pub fn summary(folder: &Path) -> Value {
    serde_json::from_str(&read(&folder.join("summary.json"))).expect("a summary")
}

/// A summary without what depends on the machine: times, memory, and the predictions that a solver was chosen by.
pub fn lasting(mut summary: Value) -> Value {
    summary["seconds"] = Value::Null;
    summary["peak_memory_bytes"] = Value::Null;
    summary["solver"]["backend_reason"] = Value::Null;
    summary
}

/// The files of a folder and of those below, by ascending name.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() { found.extend(files(&path)) } else { found.push(path) }
    }
    found.sort();
    found
}

/// Asserts that two folders hold the same results to the last bit.
pub fn assert_same_results(a: &Path, b: &Path) {
    let inside = |folder: &Path| -> Vec<PathBuf> {
        files(folder).iter().map(|p| p.strip_prefix(folder).expect("inside").to_owned()).collect()
    };
    assert_eq!(inside(a), inside(b));
    for name in inside(a) {
        // These tell of times and sessions.
        let of_sessions = ["summary.json", "manifest.json", "checkpoint/state.bin", "checkpoint/previous.bin"];
        if !of_sessions.contains(&name.display().to_string().as_str()) {
            assert!(
                fs::read(a.join(&name)).expect("a file") == fs::read(b.join(&name)).expect("a file"),
                "{} differs",
                name.display()
            );
        }
    }
    assert_eq!(lasting(summary(a)), lasting(summary(b)));
}
