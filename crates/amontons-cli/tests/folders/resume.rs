//! Checkpoints: a run that was broken off goes on to the bits of one that was not.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::common::{
    self, amontons, assert_code, assert_same_results, files, json, output, paper, read, run_paper, stderr, summary,
};
use amontons::case::{self, Case};
use amontons::output::{Checkpoint, CheckpointInterval, Folder, FolderOptions, OutputError, Sink, Snapshot};
use amontons::run::{self, RunError, Settings};
use tempfile::{TempDir, tempdir};

const STEPS: usize = 10;

/// A sink that does something at a step.
struct At<F: FnMut() -> Result<(), OutputError>>(usize, F);

impl<F: FnMut() -> Result<(), OutputError>> Sink for At<F> {
    fn step(&mut self, now: &Snapshot) -> Result<(), OutputError> {
        if now.state.step == self.0 { (self.1)() } else { Ok(()) }
    }
}

fn small_case() -> Case {
    small_case_with(&[])
}

fn small_case_with(further: &[&str]) -> Case {
    let steps = format!("time.steps={STEPS}");
    let overrides: Vec<String> =
        ["mesh.n=8", &steps, "output.every=3"].iter().chain(further).map(|&o| o.to_owned()).collect();
    case::read(paper().as_ref(), &overrides).unwrap_or_else(|error| panic!("{error}"))
}

pub fn folder_of(case: &Case, path: &Path, time: Duration) -> Folder {
    let checkpoint = CheckpointInterval { time: Some(time), steps: None };
    let options = FolderOptions { checkpoint, ..case.folder_options() };
    Folder::create(path, options).expect("a folder")
}

/// A run that is asked to stop at a step.
pub fn interrupted(case: &Case, path: &Path, step: usize) {
    let flag = Arc::new(AtomicBool::new(false));
    let settings = Settings { interrupt: Some(Arc::clone(&flag)), ..Settings::default() };
    let mut folder = folder_of(case, path, Duration::from_mins(1));
    let mut stop = At(step, || {
        flag.store(true, Ordering::Relaxed);
        Ok(())
    });
    let ended = run::run(&case.problem, &settings, &mut [&mut folder, &mut stop]);
    assert!(matches!(ended, Err(RunError::Interrupted(summary)) if summary.steps == step));
}

/// A folder with a whole run and one that was broken off after `step` steps.
fn whole_and_broken(step: usize) -> (TempDir, PathBuf, PathBuf) {
    let folder = tempdir().expect("a folder");
    let (whole, broken) = (folder.path().join("whole"), folder.path().join("broken"));
    assert_code(&run_paper(&whole, STEPS, &[]), 0);
    interrupted(&small_case(), &broken, step);
    (folder, whole, broken)
}

pub fn resume(path: &Path, further: &[&str]) -> std::process::Output {
    let path = path.display().to_string();
    output(&mut amontons(&[&["resume", path.as_str()][..], further].concat()))
}

#[test]
fn an_interrupted_run_goes_on_to_the_same_bits() {
    // Before the first snapshot, on one, between two, before the end.
    for step in [1, 3, 5, STEPS - 1] {
        let (_folder, whole, broken) = whole_and_broken(step);
        assert_eq!(summary(&broken)["outcome"], "interrupted");
        assert!(broken.join(format!("fields/step_{step:07}.vtu")).is_file());
        assert_code(&resume(&broken, &[]), 0);
        assert_same_results(&whole, &broken);
        let manifest: serde_json::Value =
            serde_json::from_str(&read(&broken.join("manifest.json"))).expect("a manifest");
        assert_eq!(manifest["sessions"][0]["to_step"], step);
        assert_eq!(manifest["sessions"][1]["from_step"], step);
        // A run that is done stays as it is.
        assert_code(&resume(&broken, &[]), 0);
        assert_same_results(&whole, &broken);
    }
}

/// So does one with halved steps, which are told at the end.
#[test]
fn halved_steps_go_on_to_the_same_bits() {
    let layer = "contact.normal={law='softening', stiffness=1e4, peak=1, softening=5e3, residual=0.5}";
    let folder = tempdir().expect("a folder");
    let whole = folder.path().join("whole");
    let ended = run_paper(&whole, STEPS, &["--set", layer]);
    assert_code(&ended, 0);
    let solver = summary(&whole)["solver"].clone();
    let halved = solver["halved_steps"].as_u64().expect("a count");
    assert!(halved > 0 && solver["ambiguous_steps"].is_u64(), "{solver}");
    let told = format!("halved steps      {halved} steps");
    assert!(common::stdout(&ended).contains(&told), "{}", common::stdout(&ended));
    for step in [1, 2, STEPS / 2, STEPS - 1] {
        let broken = folder.path().join(format!("broken-{step}"));
        interrupted(&small_case_with(&[layer]), &broken, step);
        assert_code(&resume(&broken, &[]), 0);
        assert_same_results(&whole, &broken);
    }
}

/// So does one whose matrices depend on the temperature: each system is that of the temperature at which it was
/// factorized before.
#[test]
fn tables_over_the_temperature_go_on_to_the_same_bits() {
    let tables = [
        "material.conductivity={ temperature = [-20, 20], value = [0.5, 2] }",
        "material.heat_capacity={ temperature = [-20, 20], value = [2, 0.5] }",
        "material.elasticity.young={ temperature = [-20, 20], value = [3, 0.5] }",
        "material.viscosity.second={ temperature = [-20, 20], value = [15, 4] }",
        "contact.heat.foundation_temperature=10",
    ];
    let solver = goes_on(&tables);
    assert!(solver["factorizations"].as_u64().expect("a count") > 2);
}

/// So does one with the strains of springs at the points of the cells, beside a spring of the nodes.
#[test]
fn branches_of_both_kinds_go_on_to_the_same_bits() {
    goes_on(&["material.prony=[{ ratio = 1, time = '0.1 + x' }, { ratio = 0.5, time = 0.2 }]"]);
}

/// So does a run of a formula of two states that is broken off in the step in which points hit a rigid foundation, with
/// two steps from one state to come, and a foundation that warms up.
#[test]
fn steps_of_two_states_go_on_to_the_same_bits() {
    let hits = ["contact.normal={ law = 'signorini' }", "contact.gap=0.005"];
    goes_on(&[&hits[..], &["time.scheme=bdf2", "contact.foundation={ heat_capacity = 0.5 }"]].concat());
    goes_on(&[&hits[..], &["time.scheme=theta", "time.mass=redistributed"]].concat());
}

/// A run with these settings that was broken off goes on to the bits of one that was not; the counts of its solver.
fn goes_on(overrides: &[&str]) -> serde_json::Value {
    let set: Vec<&str> = overrides.iter().flat_map(|&value| ["--set", value]).collect();
    let folder = tempdir().expect("a folder");
    let whole = folder.path().join("whole");
    assert_code(&run_paper(&whole, STEPS, &set), 0);
    for step in [1, STEPS / 2, STEPS - 1] {
        let broken = folder.path().join(format!("broken-{step}"));
        interrupted(&small_case_with(overrides), &broken, step);
        assert_code(&resume(&broken, &[]), 0);
        assert_same_results(&whole, &broken);
    }
    summary(&whole)["solver"].clone()
}

#[test]
fn a_run_that_died_goes_on_from_its_newest_checkpoint() {
    let (_folder, whole, _) = whole_and_broken(1);
    let died = whole.with_file_name("died");
    let case = small_case();
    let mut folder = folder_of(&case, &died, Duration::ZERO);
    let mut die = At(7, || {
        Err(OutputError::Io { doing: "write", path: PathBuf::new(), source: std::io::Error::other("the disk is gone") })
    });
    let ended = run::run(&case.problem, &Settings::default(), &mut [&mut folder, &mut die]);
    assert!(matches!(ended, Err(RunError::Output(_))));
    drop(folder);
    // What a crash may leave: rows behind the checkpoint, a row in part, a file in part.
    let mut history = fs::OpenOptions::new().append(true).open(died.join("history.csv")).expect("the history");
    history.write_all(b"8,0.8,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1\n9,0.9,1.0").expect("rows");
    fs::write(died.join("fields/.step_0000008.vtu.0123456789abcdef.part"), "x").expect("a file");
    assert_code(&resume(&died, &[]), 0);
    assert_same_results(&whole, &died);
}

#[test]
fn the_checkpoint_before_takes_the_place_of_a_damaged_one() {
    let (_folder, whole, broken) = whole_and_broken(4);
    let [newest, before] = ["state.bin", "previous.bin"].map(|name| broken.join("checkpoint").join(name));
    let good = [&newest, &before].map(|file| fs::read(file).expect("a checkpoint"));
    let mut flipped = good[0].clone();
    flipped[good[0].len() / 2] ^= 4;
    for bad in [&flipped[..], &good[0][..80], &[]] {
        let copy = broken.with_file_name(format!("copy-{}", bad.len()));
        fs::write(&newest, bad).expect("a file");
        let printed = resume(&broken, &["--out", &copy.display().to_string()]);
        assert_code(&printed, 0);
        let told = stderr(&printed);
        assert!(told.contains("state.bin is damaged") && told.contains("of step 1"), "{told}");
        assert_same_results(&whole, &copy);
    }
    fs::remove_file(&newest).expect("a file");
    // With the one before spoiled, too, there is nothing to go on from.
    fs::write(&before, &good[1][..100]).expect("a file");
    assert_code(&resume(&broken, &[]), 4);
    fs::remove_file(&before).expect("a file");
    let printed = resume(&broken, &[]);
    assert_code(&printed, 4);
    assert!(stderr(&printed).contains("has no checkpoint but results of steps"), "{}", stderr(&printed));
    fs::write(&newest, &good[0]).expect("a file");
    assert_code(&resume(&broken, &[]), 0);
    assert_same_results(&whole, &broken);
}

#[test]
fn a_damaged_checkpoint_is_told() {
    let (_folder, _, broken) = whole_and_broken(4);
    let file = broken.join("checkpoint/state.bin");
    fs::remove_file(broken.join("checkpoint/previous.bin")).expect("a file");
    let good = fs::read(&file).expect("a checkpoint");
    let spoil = |bytes: &[u8], told: &str| {
        fs::write(&file, bytes).expect("a file");
        let printed = resume(&broken, &[]);
        assert_code(&printed, 4);
        assert!(stderr(&printed).contains("state.bin") && stderr(&printed).contains(told), "{}", stderr(&printed));
        assert_eq!(json(&resume(&broken, &["--format", "json"]))["error"]["kind"], "file");
    };
    for length in [0, 10, 30, 80, good.len() / 2, good.len() - 1] {
        spoil(&good[..length], "damaged");
    }
    for at in [3, 70, good.len() / 2, good.len() - 1] {
        let mut bytes = good.clone();
        bytes[at] ^= 4;
        spoil(&bytes, "damaged");
    }
    let mut other = good.clone();
    other[16] += 1;
    spoil(&other, &format!("format {}", other[16]));
    fs::write(&file, &good).expect("a file");
    assert_code(&resume(&broken, &[]), 0);
}

/// A run that was killed before its first checkpoint starts with `resume`, which needs no more than the case.
#[test]
fn a_run_goes_on_from_wherever_it_was_killed() {
    let (_folder, whole, broken) = whole_and_broken(4);
    for name in files(&broken).iter().filter(|path| !path.ends_with("case.toml")) {
        let text = fs::read_to_string(name).unwrap_or_default();
        if name.ends_with("manifest.json") {
            // As it is before the start.
            let mut manifest: serde_json::Value = serde_json::from_str(&text).expect("a manifest");
            manifest["sessions"] = serde_json::json!([]);
            fs::write(name, manifest.to_string()).expect("a file");
        } else {
            fs::remove_file(name).expect("a file");
        }
    }
    // Its first checkpoint was being written.
    fs::write(broken.join("checkpoint/.newer.bin.510222c1f10240b4.part"), "x").expect("a file");
    assert_code(&resume(&broken, &[]), 0);
    assert_same_results(&whole, &broken);
}

#[test]
fn a_run_goes_on_with_its_own_case_only() {
    let (_folder, _, broken) = whole_and_broken(4);
    let refused = |set: &str, told: &[&str]| {
        let printed = resume(&broken, &["--set", set]);
        assert_code(&printed, 2);
        assert!(told.iter().all(|told| stderr(&printed).contains(told)), "{}", stderr(&printed));
    };
    refused("load.heat_source=2", &["of another case", "load.heat_source was 1.0 and is 2.0"]);
    refused("contact.gap=0.1", &["contact.gap was 0.0 and is 0.1"]);
    refused("time.steps=20", &["time steps of 0.1 s", "steps of 0.05 s"]);
    assert_code(&resume(&broken.join("none"), &[]), 4);
    // By hand, too.
    let case = broken.join("case.toml");
    fs::write(&case, read(&case).replace("density = 1.0", "density = 1.5")).expect("a file");
    let printed = resume(&broken, &[]);
    assert_code(&printed, 2);
    assert!(stderr(&printed).contains("material.density was 1.0 and is 1.5"), "{}", stderr(&printed));
}

/// With a longer time and other output a run goes on to the bits of one that was asked for that at once.
#[test]
fn a_finished_run_is_continued_for_longer() {
    let folder = tempdir().expect("a folder");
    let [short, long] = ["short", "long"].map(|name| folder.path().join(name));
    let longer = ["--set", "time.end=2.0", "--set", "time.steps=20", "--set", "output.every=5"];
    assert_code(&run_paper(&short, STEPS, &["--set", "output.every=5"]), 0);
    // A comment changes nothing but the hash of the case.
    let case = short.join("case.toml");
    let text = read(&case);
    fs::write(&case, format!("# a comment\n{text}")).expect("a file");
    assert_code(&resume(&short, &[]), 0);
    fs::write(&case, text).expect("a file");
    assert_code(&resume(&short, &longer), 0);
    assert_code(&run_paper(&long, STEPS, &longer), 0);
    assert_eq!(summary(&short)["steps"], 20);
    // The findings on the longer run are of its own certificate.
    assert_same_results(&long, &short);
    // A snapshot that has gone is told.
    fs::remove_file(short.join("fields/step_0000005.vtu")).expect("a file");
    let printed = resume(&short, &[]);
    assert_code(&printed, 0);
    assert!(stderr(&printed).contains("fields/step_0000005.vtu of the run before is gone"), "{}", stderr(&printed));
}

/// Checkpoints are written at the start, after the first step, and as often as the case asks for.
#[test]
fn checkpoints_are_written_when_the_case_asks_for_them() {
    let folder = tempdir().expect("a folder");
    for (asked, expected) in [("steps = 3", 7), ("steps = 2", 7), ("seconds = 3600", 1), ("seconds = 0", 7)] {
        let path = folder.path().join(asked);
        let case = small_case_with(&[&format!("output.checkpoint={{ {asked} }}")]);
        let mut results = Folder::create(&path, case.folder_options()).expect("a folder");
        let mut die = At(7, || {
            Err(OutputError::Io { doing: "write", path: PathBuf::new(), source: std::io::Error::other("gone") })
        });
        let ended = run::run(&case.problem, &Settings::default(), &mut [&mut results, &mut die]);
        assert!(matches!(ended, Err(RunError::Output(_))));
        drop(results);
        let checkpoint = Checkpoint::read(&path, &case.identity()).expect("a checkpoint").expect("one");
        assert_eq!(checkpoint.state.step, expected, "{asked}");
    }
}

/// A run without a certificate goes on without one.
#[test]
fn no_certificate_is_made_of_a_run_that_had_none() {
    let folder = tempdir().expect("a folder");
    let out = folder.path().join("run");
    assert_code(&run_paper(&out, STEPS, &["--no-certificate"]), 0);
    assert_code(&resume(&out, &["--plot"]), 0);
    assert!(!out.join("certificate.json").exists() && files(&out).iter().any(|path| path.ends_with("history.png")));
}

/// Results keep copies of the tables that a case refers to: a run goes on, and is drawn and verified, without the
/// originals.
#[test]
fn a_run_goes_on_without_the_files_of_its_case() {
    let folder = tempdir().expect("a folder");
    let (data, cases) = (folder.path().join("data"), folder.path().join("cases"));
    for made in [&data, &cases] {
        fs::create_dir(made).expect("a folder");
    }
    fs::write(data.join("heat.csv"), "t,source\n0,1\n0.4,3\n1,2\n").expect("a file");
    let file = cases.join("oven.toml");
    let text = read(paper().as_ref())
        .replace("heat_source = 1.0 ", "heat_source = { table = \"../data/heat.csv\", factor = \"1 + x\" } ");
    fs::write(&file, &text).expect("a file");
    let set = ["mesh.n=8", "time.steps=10", "output.every=3"];
    let case = case::read(&file, &set.map(str::to_owned)).unwrap_or_else(|error| panic!("{error}"));
    let (whole, broken) = (folder.path().join("whole"), folder.path().join("broken"));
    let mut arguments =
        vec!["run".to_owned(), file.display().to_string(), "--out".to_owned(), whole.display().to_string()];
    arguments.extend(set.into_iter().flat_map(|set| ["--set".to_owned(), set.to_owned()]));
    assert_code(&output(&mut amontons(&arguments.iter().map(String::as_str).collect::<Vec<_>>())), 0);
    interrupted(&case, &broken, 4);
    fs::remove_dir_all(&data).expect("a folder");
    fs::remove_dir_all(&cases).expect("a folder");
    assert!(
        read(&broken.join("case.toml")).contains("heat_source = { table = \"inputs/heat.csv\", factor = \"1 + x\" } ")
    );

    assert_code(&resume(&broken, &[]), 0);
    assert_same_results(&whole, &broken);
    for command in ["plot", "verify"] {
        assert_code(&output(&mut amontons(&[command, &broken.display().to_string()])), 0);
    }
    let copy = broken.join("inputs/heat.csv");
    fs::write(&copy, read(&copy).replace("1,2\n", "1,5\n")).expect("a file");
    let printed = resume(&broken, &[]);
    assert_code(&printed, 2);
    assert!(stderr(&printed).contains("another case"), "{}", stderr(&printed));
}

/// Two bodies of two files, one of which includes its nodes, with a contact between sides that the case names by their
/// place: a run that was interrupted goes on to the same bits without these files.
#[test]
fn a_run_of_several_files_goes_on_without_them() {
    let folder = tempdir().expect("a folder");
    let cases = folder.path().join("cases");
    fs::create_dir_all(cases.join("parts")).expect("a folder");
    let nodes = |top: f64| format!("*NODE\n1,0,0\n2,2,0\n3,2,{top}\n4,0,{top}\n");
    let cell = "*ELEMENT,TYPE=CPE4,ELSET=ALL\n1,1,2,3,4\n*SURFACE,NAME=TOP\n1,S3\n*SURFACE,NAME=FOOT\n1,S1\n";
    let case = "name = \"stack\"\nunits = \"dimensionless\"\n[mesh]\nkind = \"blocks\"\nblocks = [\n\
                { name = \"low\", file = \"low.inp\" },\n\
                { name = \"high\", file = \"high.inp\", scale = 0.5, turn = { angle = 3.141592653589793 }, origin = [1.5, 1.5] },\n]\n\
                [[side]]\nname = \"seat\"\nregion = \"low\"\non = { plane = { point = [0, 1], normal = [0, 1] } }\n\
                [[side]]\nname = \"face\"\nregion = \"high\"\non = { normal = { direction = [0, -1] } }\n\
                [time]\nend = 1\nsteps = 10\n[material]\ndensity = 0\n\
                elasticity = { law = \"isotropic\", young = 10, poisson = 0.3 }\n\
                viscosity = { law = \"lame\", first = 0.5, second = 1 }\n\
                [[boundary]]\non = \"low_FOOT\"\ndisplacement = [0, 0]\n\
                [[boundary]]\non = \"high_FOOT\"\ndisplacement = [\"0.02*t\", \"-0.1*t\"]\n\
                [contact]\non = \"seat\"\nwith = \"face\"\nnormal = { law = \"signorini\" }\n\
                friction = { law = \"coulomb\", coefficient = 0.1 }\nwear = { law = \"archard\", coefficient = 1e-3 }\n";
    for (name, text) in [
        ("parts/low.nam", nodes(1.0)),
        ("low.inp", format!("*INCLUDE, INPUT=parts/low.nam\n{cell}")),
        ("high.inp", nodes(1.0) + cell),
        ("stack.toml", case.to_owned()),
    ] {
        fs::write(cases.join(name), text).expect("a file");
    }
    let file = cases.join("stack.toml");
    let (whole, broken) = (folder.path().join("whole"), folder.path().join("broken"));
    let places = [&file, &whole].map(|path| path.display().to_string());
    assert_code(&output(&mut amontons(&["run", &places[0], "--out", &places[1]])), 0);
    let force = summary(&whole)["final"]["contact"]["force"][1].as_f64().expect("a force").abs();
    assert!(force > 0.1, "the bodies press: {force}");
    interrupted(&case::read(&file, &[]).unwrap_or_else(|error| panic!("{error}")), &broken, 4);
    fs::remove_dir_all(&cases).expect("a folder");
    assert_code(&resume(&broken, &[]), 0);
    assert_same_results(&whole, &broken);
    // The copy holds what the file included: a change of that is one of the case.
    let copy = broken.join("inputs/low.inp");
    fs::write(&copy, read(&copy).replace("2,2,0", "2,2.1,0")).expect("a file");
    let printed = resume(&broken, &[]);
    assert_code(&printed, 2);
    assert!(stderr(&printed).contains("another case"), "{}", stderr(&printed));
}

#[test]
fn a_history_that_lacks_rows_is_told() {
    let (_folder, _, broken) = whole_and_broken(4);
    let text = read(&broken.join("history.csv"));
    let (short, _) = text.trim_end().rsplit_once('\n').expect("rows");
    fs::write(broken.join("history.csv"), short).expect("a file");
    let printed = resume(&broken, &[]);
    assert_code(&printed, 4);
    assert!(stderr(&printed).contains("history.csv"), "{}", stderr(&printed));
}

#[test]
fn a_run_goes_on_in_another_folder() {
    let (folder, whole, broken) = whole_and_broken(4);
    let other = folder.path().join("other");
    let out = other.display().to_string();
    assert_code(&resume(&broken, &["--out", &out]), 0);
    assert_same_results(&whole, &other);
    assert_eq!(summary(&broken)["steps"], 4);
    assert_code(&resume(&broken, &["--out", &out]), 2);
    assert_code(&resume(&broken, &["--out", &out, "--force"]), 0);
    assert_same_results(&whole, &other);
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_a_checkpoint() {
    const LONG: usize = 20_000;
    let folder = tempdir().expect("a folder");
    let (whole, broken) = (folder.path().join("whole"), folder.path().join("broken"));
    let arguments = |out: &Path| {
        let set = [format!("time.steps={LONG}"), "mesh.n=4".to_owned(), "output.every=7000".to_owned()];
        let mut arguments = vec!["run".to_owned(), paper(), "--out".to_owned(), out.display().to_string()];
        arguments.extend(set.into_iter().flat_map(|set| ["--set".to_owned(), set]));
        arguments
    };
    let start = |out: &Path| {
        let arguments = arguments(out);
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let mut command = amontons(&arguments);
        command
            .stdout(std::process::Stdio::piped())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .expect("the program starts")
    };
    let child = start(&broken);
    let begin = Instant::now();
    while fs::metadata(broken.join("history.csv")).map_or(0, |meta| meta.len()) < 50_000 {
        assert!(begin.elapsed() < Duration::from_mins(1), "the run does not start");
        std::thread::sleep(Duration::from_millis(2));
    }
    let killed = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
    assert!(killed.success());
    let ended = child.wait_with_output().expect("the end");
    assert_code(&ended, 130);
    assert!(stderr(&ended).contains("amontons resume"), "{}", stderr(&ended));
    let said = stderr(&ended);
    assert!(
        said.contains("Ctrl-C: the run ends in or after step ")
            && said.contains("a checkpoint is written; a second Ctrl-C stops at once"),
        "{said}"
    );
    let steps = summary(&broken)["steps"].as_u64().expect("steps") as usize;
    assert!(steps > 0 && steps < LONG);

    assert_code(&resume(&broken, &["--quiet"]), 0);
    assert_code(&start(&whole).wait_with_output().expect("the end"), 0);
    assert_same_results(&whole, &broken);
}

/// A body that slides into a corner: a ball and a ramp that move below, wear, foundations that warm up, three contacts
/// with laws of their own.
const CORNER: &str = r#"
name = "corner"
[mesh]
kind = "rectangle"
size = [1.0, 0.8]
n = [5, 4]
[time]
end = 0.5
steps = 12
[material]
density = 1
heat_capacity = 1
expansion = 0.1
coupling = 0.1
conductivity = 0.5
elasticity = { law = "isotropic", young = 20.0, poisson = 0.2, stress_state = "plane-stress" }
viscosity = { law = "lame", first = 1, second = 1 }
[load]
body_force = [4, -6]
[[contact]]
on = "bottom"
obstacle = { shape = "sphere", center = ["0.5 - 0.5*t", "-4 + 0.05*t"], radius = 4, geometry = "updated" }
normal = { law = "signorini" }
friction = { law = "coulomb", coefficient = 0.3 }
wear = { law = "archard", coefficient = 0.02 }
heat = { law = "pressure", coefficient = 0.1, foundation_temperature = 5 }
frictional_heat = 0.4
foundation = { heat_capacity = 0.3, exchange = 0.2, surroundings = "3*t" }
[[contact]]
on = "right"
quadrature = "gauss"
gap = -0.01
normal = { law = "compliance", stiffness = 500.0 }
friction = { law = "coulomb", coefficient = 0.1 }
wear = { law = "archard-temperature", temperature = [0, 2], coefficient = [0.02, 0.06] }
foundation = { heat_capacity = 0.5 }
frictional_heat = 0.7
[[contact]]
on = "bottom"
name = "ramp"
obstacle = { shape = "plane", point = [1, "-0.02 + 0.02*t"], normal = [-0.1, 1] }
normal = { law = "compliance", stiffness = 300.0 }
friction = { law = "coulomb", coefficient = 0.2 }
wear = { law = "archard", coefficient = 0.03 }
"#;

#[test]
fn wear_and_warm_foundations_go_on_to_the_same_bits() {
    let case = case::parse(&case::Source::new("corner.toml", CORNER), &[]).unwrap_or_else(|error| panic!("{error}"));
    for step in [1, 6] {
        let folder = tempdir().expect("a folder");
        let (whole, broken) = (folder.path().join("whole"), folder.path().join("broken"));
        let mut sink = folder_of(&case, &whole, Duration::from_mins(1));
        run::run(&case.problem, &Settings::default(), &mut [&mut sink]).expect("a run");
        drop(sink);
        interrupted(&case, &broken, step);
        assert_code(&resume(&broken, &[]), 0);
        assert_same_results(&whole, &broken);
        // There is something to keep: depths, and two temperatures that have left those of the start.
        let contact = &summary(&broken)["final"]["contact"];
        assert!(contact["wear_max"].as_f64().expect("a depth") > 1e-4);
        for (side, start) in [("bottom", 5.0), ("right", 0.0)] {
            let temperature = contact["sides"][side]["foundation_temperature"].as_f64().expect("a temperature");
            assert!((temperature - start).abs() > 1e-3, "{side}: {temperature}");
        }
    }
}
