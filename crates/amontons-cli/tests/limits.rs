//! Limits of the system and hostile files: an exit code with a message, never a signal, a panic or a long wait.
#![cfg(unix)]
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod common;

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use common::{amontons, assert_code, output, paper, read, run_paper, stderr, summary};
use tempfile::tempdir;

/// Bytes that a pipe takes before it is full.
#[cfg(target_os = "linux")]
const PIPE: usize = 1 << 16;

/// The program under a limit of the shell.
fn limited(limit: &str, arguments: &[&str]) -> Output {
    let mut command = Command::new("sh");
    command.args(["-c", &format!("ulimit {limit}; exec \"$0\" \"$@\""), env!("CARGO_BIN_EXE_amontons")]);
    output(command.args(arguments).env("NO_COLOR", "1"))
}

/// Asserts one of some exit codes, and a message if it is none of success.
fn assert_told(printed: &Output, codes: &[i32], what: &str) {
    assert_eq!(printed.status.signal(), None, "{what}: {}", stderr(printed));
    let code = printed.status.code().expect("a code");
    assert!(codes.contains(&code), "{what}: {code}\n{}", stderr(printed));
    assert!(code == 0 || !stderr(printed).trim().is_empty(), "{what}: no message");
    assert!(!stderr(printed).contains("panicked"), "{what}: {}", stderr(printed));
}

/// From the least address space in which the program starts at all.
#[test]
fn little_memory_ends_with_a_message() {
    let folder = tempdir().expect("a folder");
    let case = paper();
    for (i, megabytes) in [40, 60, 80, 100, 130, 160, 200, 300, 500, 1000].into_iter().enumerate() {
        let out = folder.path().join(i.to_string()).display().to_string();
        let arguments = ["run", &case, "--out", &out, "--quiet", "--no-certificate", "--set", "time.steps=2"];
        let all = [&arguments[..], &["--set", "mesh.n=96"]].concat();
        let printed = limited(&format!("-v {}", megabytes * 1024), &all);
        assert_told(&printed, &[0, 2, 4], &format!("{megabytes} MB"));
    }
    // The limit is seen before the mesh is built.
    let printed = limited("-v 600000", &["check", &case, "--set", "mesh.n=4096"]);
    assert_code(&printed, 2);
    assert!(stderr(&printed).contains("`ulimit -v`"), "{}", stderr(&printed));
}

#[test]
fn a_file_that_may_not_grow_is_an_error_of_the_write() {
    let folder = tempdir().expect("a folder");
    let case = paper();
    for kilobytes in [1, 4, 10, 20] {
        let out = folder.path().join(kilobytes.to_string());
        let path = out.display().to_string();
        let arguments = ["run", &case, "--out", &path, "--quiet", "--set", "mesh.n=16", "--set", "time.steps=40"];
        // Blocks of 512 bytes.
        let printed = limited(&format!("-f {}", 2 * kilobytes), &arguments);
        assert_told(&printed, &[4], &format!("{kilobytes} kB"));
        assert!(stderr(&printed).contains("cannot write"), "{}", stderr(&printed));
        assert!(common::files(&out).iter().all(|path| path.extension().is_none_or(|ending| ending != "part")));
    }
}

#[test]
fn few_files_and_too_many_threads_are_told() {
    let folder = tempdir().expect("a folder");
    let (case, out) = (paper(), folder.path().join("run").display().to_string());
    let arguments = ["run", &case, "--out", &out, "--quiet", "--set", "mesh.n=8", "--set", "time.steps=4"];
    assert_told(&limited("-n 16", &arguments), &[0, 2, 4], "16 files");
    let printed = output(&mut amontons(&["check", &case, "--threads", "5000"]));
    assert_code(&printed, 2);
    assert!(stderr(&printed).contains("--threads 5000: expected at most"), "{}", stderr(&printed));
}

/// The signals of batch systems end a run in order, and so does a limit of the CPU time.
#[test]
fn signals_of_batch_systems_leave_a_checkpoint() {
    let folder = tempdir().expect("a folder");
    for signal in ["TERM", "HUP", "USR1", "USR2", "XCPU"] {
        let out = folder.path().join(signal);
        let (case, path) = (paper(), out.display().to_string());
        let arguments = ["run", &case, "--out", &path, "--no-certificate", "--set", "mesh.n=4"];
        let mut command = amontons(&[&arguments[..], &["--set", "time.steps=20000"]].concat());
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
        let begin = Instant::now();
        while fs::metadata(out.join("history.csv")).map_or(0, |meta| meta.len()) < 20_000 {
            assert!(begin.elapsed() < Duration::from_mins(1), "the run does not start");
            std::thread::sleep(Duration::from_millis(2));
        }
        let id = child.id().to_string();
        assert!(Command::new("kill").args([&format!("-{signal}"), &id]).status().expect("kill").success());
        let ended = child.wait_with_output().expect("the end");
        assert_code(&ended, 130);
        assert!(stderr(&ended).contains(signal) && stderr(&ended).contains("amontons resume"), "{}", stderr(&ended));
        assert_eq!(summary(&out)["outcome"], "interrupted");
        // A run that is interrupted is not one that holds.
        let verified = output(&mut amontons(&["verify", &path]));
        assert_code(&verified, 1);
        assert!(stderr(&verified).contains("the run is interrupted"), "{}", stderr(&verified));
    }
}

/// A row of points on a layer that softens, which snap through one after the other: the second step takes minutes.
#[cfg(target_os = "linux")]
const SNAPPING: &str = r#"name = "snapping"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [100, 1]
n = [400, 1]
elements = "Q1"
[time]
end = 4
steps = 4
inertia = false
[material]
elasticity = { law = "isotropic", young = 1, poisson = 0, stress_state = "plane-strain" }
[[boundary]]
on = "top"
displacement = [0, "0.5 - 0.3*t"]
[contact]
on = "bottom"
gap = "0.02*sin(7*x)"
normal = { law = "softening", stiffness = 3, peak = 0.1, softening = 5, residual = 0.01 }
[output]
checkpoint = { steps = 1 }
"#;

/// The second Ctrl-C ends the program at once, in the middle of a step, even where the first one cannot be told of: the
/// pipe that takes the messages is full. What was written before is sound, and a run goes on from it.
#[test]
#[cfg(target_os = "linux")]
fn a_second_interrupt_ends_the_program_within_a_step() {
    let folder = tempdir().expect("a folder");
    let (file, out) = (folder.path().join("snapping.toml"), folder.path().join("run"));
    fs::write(&file, SNAPPING).expect("a case");
    let (case, path) = (file.display().to_string(), out.display().to_string());
    let (unread, mut full) = std::io::pipe().expect("a pipe");
    full.write_all(&vec![b' '; PIPE]).expect("room in the pipe");
    let mut command = amontons(&["run", &case, "--out", &path, "--no-certificate"]);
    let mut child = command.stdout(Stdio::null()).stderr(full).spawn().expect("the program starts");
    let begin = Instant::now();
    while !out.join("checkpoint/state.bin").exists() {
        assert!(begin.elapsed() < Duration::from_mins(1), "the run does not start");
        std::thread::sleep(Duration::from_millis(2));
    }
    let id = child.id().to_string();
    let interrupt = || assert!(Command::new("kill").args(["-INT", &id]).status().expect("kill").success());
    interrupt();
    // It is being told of, and the step goes on.
    std::thread::sleep(Duration::from_millis(200));
    assert!(child.try_wait().expect("a state").is_none(), "the first Ctrl-C ends the program");
    interrupt();
    let begin = Instant::now();
    let ended = loop {
        if let Some(ended) = child.try_wait().expect("a state") {
            break ended;
        }
        if begin.elapsed() > Duration::from_mins(1) {
            child.kill().expect("the end");
            panic!("the second Ctrl-C does not end the program");
        }
        std::thread::sleep(Duration::from_millis(2));
    };
    drop(unread);
    assert_eq!((ended.code(), ended.signal()), (Some(130), None));
    // The second step was not made, and nothing tells of an end in order.
    let history = read(&out.join("history.csv"));
    assert!(history.lines().count() == 2 && history.ends_with('\n'), "{history}");
    assert!(!out.join("summary.json").exists());
    // The checkpoint is read, and the run goes on until it is interrupted in order.
    let command = ["resume", &path, "--progress", "json"];
    let mut child =
        amontons(&command).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program starts");
    let mut lines = BufReader::new(child.stderr.take().expect("standard error")).lines().map_while(Result::ok);
    assert!(lines.any(|line| line.contains("\"phase\":\"steps\"")), "the run goes on");
    assert!(Command::new("kill").args(["-TERM", &child.id().to_string()]).status().expect("kill").success());
    let rest: Vec<String> = lines.collect();
    assert_eq!(child.wait().expect("the end").code(), Some(130), "{rest:?}");
    assert_eq!((&summary(&out)["outcome"], summary(&out)["steps"].as_u64()), (&"interrupted".into(), Some(1)));
}

/// A large body that is interrupted leaves a checkpoint without the fields of the last step, which take longer than the
/// user is to wait; a run that goes on has them at its end.
#[test]
fn a_large_body_leaves_a_checkpoint_alone() {
    let folder = tempdir().expect("a folder");
    let (case, out) = (folder.path().join("rod.toml"), folder.path().join("run"));
    let text = "name = \"rod\"\nmesh = { kind = \"interval\", size = 1, n = 100000 }\ntime = { end = 1, steps = 400 }\n\
        material = \"glass-soda-lime\"\n[[boundary]]\non = \"left\"\ntemperature = \"sin(t)\"\n";
    fs::write(&case, text).expect("a case");
    let (case, path) = (case.display().to_string(), out.display().to_string());
    let arguments = ["run", &case, "--out", &path, "--no-certificate"];
    let child = amontons(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
    let begin = Instant::now();
    while fs::read_to_string(out.join("history.csv")).map_or(0, |text| text.lines().count()) < 4 {
        assert!(begin.elapsed() < Duration::from_mins(1), "the run does not start");
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(Command::new("kill").args(["-TERM", &child.id().to_string()]).status().expect("kill").success());
    let ended = child.wait_with_output().expect("the end");
    assert_code(&ended, 130);
    assert_eq!(summary(&out)["outcome"], "interrupted");
    let fields = || fs::read_dir(out.join("fields")).expect("a folder").count();
    assert!(fields() == 0 && out.join("checkpoint/state.bin").exists());
    let made = summary(&out)["steps"].as_u64().expect("a count");
    assert!(made < 399, "{made}");
    let rest = output(&mut amontons(&["resume", &path, "--quiet"]));
    assert_code(&rest, 0);
    assert_eq!((fields(), summary(&out)["steps"].as_u64()), (1, Some(400)));
    assert_code(&output(&mut amontons(&["verify", &path])), 0);
}

/// Before the first step there is nothing to finish, however long the set-up takes: the program ends at once, and the
/// same command begins again.
#[test]
fn a_signal_before_the_first_step_ends_the_program() {
    let folder = tempdir().expect("a folder");
    let (case, out) = (paper(), folder.path().join("run").display().to_string());
    let begin = ["run", &case, "--out", &out, "--set", "mesh.n=256", "--set", "time.steps=2", "--progress", "json"];
    let mut child = amontons(&begin).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
    let mut lines = BufReader::new(child.stderr.take().expect("standard error")).lines().map_while(Result::ok);
    assert!(lines.any(|line| line.contains("certificate")), "the phase is told");
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-TERM", &id]).status().expect("kill").success());
    assert!(lines.any(|line| line.contains("SIGTERM: the run ends before its first step")), "it says what it does");
    assert_eq!(child.wait().expect("the end").code(), Some(130));
    let again = output(&mut amontons(&["run", &case, "--out", &out, "--quiet", "--set", "mesh.n=4"]));
    assert_code(&again, 0);
}

/// A case that names a table.
fn with_table(folder: &Path, table: &str) -> String {
    let file = folder.join("table.toml");
    let text =
        read(paper().as_ref()).replace("heat_source = 1.0 ", &format!("heat_source = {{ table = \"{table}\" }} "));
    fs::write(&file, text).expect("a file");
    file.display().to_string()
}

#[test]
fn only_regular_files_are_read() {
    let folder = tempdir().expect("a folder");
    let pipe = folder.path().join("pipe.csv");
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo").success());
    for (table, why) in [
        ("pipe.csv", "cannot be read"),
        ("/dev/zero", "cannot be read"),
        ("/proc/kmsg", "cannot be read"),
        (".", "which is no file"),
    ] {
        let printed = output(&mut amontons(&["check", &with_table(folder.path(), table)]));
        assert_code(&printed, 2);
        assert!(stderr(&printed).contains(why), "{table}: {}", stderr(&printed));
    }
    let case = folder.path().join("pipe.toml").display().to_string();
    assert!(Command::new("mkfifo").arg(&case).status().expect("mkfifo").success());
    let printed = output(&mut amontons(&["check", &case]));
    assert_code(&printed, 4);
    assert!(stderr(&printed).contains("found a pipe or a device, expected a case file"), "{}", stderr(&printed));
}

#[test]
fn a_confined_case_reads_nothing_outside_its_folder() {
    let folder = tempdir().expect("a folder");
    let (inside, outside) = (folder.path().join("case"), folder.path().join("secret.csv"));
    fs::create_dir_all(inside.join("data")).expect("a folder");
    for path in [&outside, &inside.join("data/mine.csv")] {
        fs::write(path, "t,f\n0,1\n1,2\n").expect("a file");
    }
    std::os::unix::fs::symlink(&outside, inside.join("link.csv")).expect("a link");
    let absolute = outside.display().to_string();
    for (table, code) in [("data/mine.csv", 0), ("../secret.csv", 2), (absolute.as_str(), 2), ("link.csv", 2)] {
        let case = with_table(&inside, table);
        assert_code(&output(&mut amontons(&["check", &case, "--quiet"])), 0);
        let printed = output(&mut amontons(&["check", &case, "--quiet", "--confine"]));
        assert_code(&printed, code);
        assert!(code == 0 || stderr(&printed).contains("not in the folder of the case"), "{}", stderr(&printed));
    }
}

#[test]
fn at_most_fifty_faults_are_told() {
    let folder = tempdir().expect("a folder");
    let file = folder.path().join("faults.toml").display().to_string();
    let text = read(paper().as_ref());
    let unknown: String = (0..20_000).map(|i| format!("key_{i} = 1\n")).collect();
    let entries: String =
        (0..20_000).map(|i| format!("[[boundary]]\non = \"side {i}\"\ntraction = \"{i}\"\n")).collect();
    let lines: String = (0..20_000).map(|i| format!("line {i} is no TOML\n")).collect();
    for (faults, told) in [(unknown + &text, "20000 faults"), (text.clone() + &entries, "faults"), (lines, "faults")] {
        fs::write(&file, faults).expect("a file");
        let printed = output(&mut amontons(&["check", &file]));
        assert_code(&printed, 2);
        let said = stderr(&printed);
        assert!(said.contains(told) && said.contains("the first 50 of them are told"), "{}", said.len());
        assert!(said.len() < 100_000, "{} bytes", said.len());
    }
    // A case with faults does not build its mesh, whose cells would take the machine down.
    let printed =
        output(&mut amontons(&["check", &paper(), "--set", "mesh.n=3000", "--set", "density=1", "--format", "json"]));
    assert_code(&printed, 2);
}

/// Where the disk has no room for the results, that is told before the first step, and before the first further one of
/// a run that goes on. What there is of results stays.
#[test]
fn results_that_do_not_fit_on_the_disk_are_refused() {
    let folder = tempdir().expect("a folder");
    let out = folder.path().join("run");
    let refused = |printed: &Output| {
        assert_code(printed, 4);
        assert!(stderr(printed).contains("are free on its disk"), "{}", stderr(printed));
    };
    refused(&run_paper(&out, 1_000_000_000, &["--no-certificate", "--set", "output.every=1"]));
    assert_code(&run_paper(&out, 4, &["--no-certificate", "--set", "output.every=1", "--force"]), 0);
    let history = read(&out.join("history.csv"));
    let resume = |steps: &str, end: &str| {
        let sets = [format!("time.steps={steps}"), format!("time.end={end}")];
        let place = out.display().to_string();
        output(&mut amontons(&["resume", &place, "--no-certificate", "--set", &sets[0], "--set", &sets[1]]))
    };
    refused(&resume("1_000_000_000", "250_000_000.0"));
    assert_eq!(read(&out.join("history.csv")), history);
    // With as many steps as there is room for it goes on.
    assert_code(&resume("6", "1.5"), 0);
    assert_eq!(summary(&out)["steps"], 6);
}
