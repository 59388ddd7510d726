//! The fields of a run in one file, `fields.vtkhdf`: what a folder with it has, and that it survives what others do.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::common::{
    self, amontons, assert_code, assert_same_results, files, output, paper, read, run_paper, stderr, summary,
};
use amontons::case;
use amontons::output::{Folder, OutputError, Sink, Snapshot};
use amontons::run::{self, RunError, Settings};
use tempfile::tempdir;

const STEPS: usize = 10;
const PACKED: &[&str] = &["--set", "output.format=\"vtkhdf\""];
const BOTH: &[&str] = &["--set", "output.format=\"both\""];
/// The snapshots of a run of ten steps, of which every third is due.
const SNAPSHOTS: [usize; 5] = [0, 3, 6, 9, 10];

fn on(command: &str, folder: &Path, further: &[&str]) -> Output {
    let folder = folder.display().to_string();
    output(&mut amontons(&[&[command, folder.as_str()][..], further].concat()))
}

fn bytes(folder: &Path, name: &str) -> Vec<u8> {
    fs::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn names(folder: &Path) -> Vec<String> {
    files(folder).iter().map(|path| path.strip_prefix(folder).expect("inside").display().to_string()).collect()
}

fn copy(from: &Path, to: &Path) {
    for name in names(from) {
        fs::create_dir_all(to.join(&name).parent().expect("a folder")).expect("a folder");
        fs::copy(from.join(&name), to.join(&name)).expect("a file");
    }
}

/// A sink that asks the run to stop at a step.
struct Stop(usize, Arc<AtomicBool>);

impl Sink for Stop {
    fn step(&mut self, now: &Snapshot) -> Result<(), OutputError> {
        self.1.store(now.state.step == self.0, Ordering::Relaxed);
        Ok(())
    }
}

/// A run that is interrupted after a step.
fn interrupted(path: &Path, step: usize) {
    let overrides = ["mesh.n=8", "time.steps=10", "output.every=3", PACKED[1]].map(str::to_owned);
    let case = case::read(paper().as_ref(), &overrides).unwrap_or_else(|error| panic!("{error}"));
    let flag = Arc::new(AtomicBool::new(false));
    let settings = Settings { interrupt: Some(Arc::clone(&flag)), ..Settings::default() };
    let mut folder = Folder::create(path, case.folder_options()).expect("a folder");
    let ended = run::run(&case.problem, &settings, &mut [&mut folder, &mut Stop(step, flag)]);
    assert!(matches!(ended, Err(RunError::Interrupted(_))));
}

/// The folder has the file in the place of those of the snapshots; it is listed, verified and drawn.
#[test]
fn a_folder_has_one_file_of_fields() {
    let folder = tempdir().expect("a folder");
    let [own, packed, both] = ["own", "packed", "both"].map(|name| folder.path().join(name));
    assert_code(&run_paper(&own, STEPS, &[]), 0);
    assert_code(&run_paper(&packed, STEPS, PACKED), 0);
    assert_code(&run_paper(&both, STEPS, BOTH), 0);
    let is_field = |name: &String| name.starts_with("fields");
    let others = |folder: &Path| names(folder).into_iter().filter(|name| !is_field(name)).collect::<Vec<_>>();
    assert_eq!(others(&packed), others(&own));
    assert_eq!(names(&packed).into_iter().filter(is_field).collect::<Vec<_>>(), ["fields.vtkhdf"]);
    assert!(!packed.join("fields").exists());
    assert_eq!(bytes(&packed, "fields.vtkhdf"), bytes(&both, "fields.vtkhdf"));
    for name in names(&own).iter().filter(|name| is_field(name)) {
        assert!(bytes(&both, name) == bytes(&own, name), "{name}");
    }
    let manifest: serde_json::Value = serde_json::from_str(&read(&packed.join("manifest.json"))).expect("a manifest");
    assert_eq!(manifest["outputs"]["fields.vtkhdf"]["bytes"], bytes(&packed, "fields.vtkhdf").len());
    assert!(!manifest["outputs"].as_object().expect("names").keys().any(|name| name.starts_with("fields/")));
    for run in [&packed, &both] {
        let verified = on("verify", run, &[]);
        assert_code(&verified, 0);
        assert!(
            common::stdout(&verified).contains("von_mises of the cells against the nodes"),
            "{}",
            common::stdout(&verified)
        );
    }
    for run in [&own, &packed] {
        assert_code(&on("plot", run, &["--time", "0.3,0.6,1"]), 0);
        assert_code(&on("report", run, &[]), 0);
    }
    let pictures: Vec<String> = names(&own).into_iter().filter(|name| name.starts_with("plots/")).collect();
    assert!(pictures.len() >= 6, "{pictures:?}");
    assert!(pictures.iter().all(|name| bytes(&own, name) == bytes(&packed, name)));
    assert!(packed.join("report.html").is_file());
}

/// The bytes do not depend on the number of threads.
#[test]
fn threads_do_not_change_the_file() {
    let folder = tempdir().expect("a folder");
    let all = ["1", "2"].map(|threads| {
        let out = folder.path().join(threads);
        assert_code(&run_paper(&out, STEPS, &[PACKED, &["--threads", threads]].concat()), 0);
        bytes(&out, "fields.vtkhdf")
    });
    assert!(all[0] == all[1]);
}

/// An interrupted run leaves its snapshots as files, and goes on to the same file.
#[test]
fn an_interrupted_run_goes_on_to_the_same_file() {
    let folder = tempdir().expect("a folder");
    let whole = folder.path().join("whole");
    assert_code(&run_paper(&whole, STEPS, PACKED), 0);
    for step in [1, 3, 5] {
        let broken = folder.path().join(format!("broken-{step}"));
        interrupted(&broken, step);
        assert!(!broken.join("fields.vtkhdf").exists());
        assert!(read(&broken.join("fields.pvd")).contains(&format!("fields/step_{step:07}.vtu")));
        assert_code(&on("resume", &broken, &[]), 0);
        assert_same_results(&whole, &broken);
        // A run that is done stays as it is.
        assert_code(&on("resume", &broken, &[]), 0);
        assert_same_results(&whole, &broken);
    }
}

/// A run that has ended goes on for longer, in either format, to what a run of that length writes.
#[test]
fn a_finished_run_goes_on_for_longer() {
    let folder = tempdir().expect("a folder");
    let longer = ["--set", "time.end=2.0", "--set", "time.steps=20"];
    for (format, name) in [(PACKED, "packed"), (&["--set", "output.format=\"vtu\""][..], "own")] {
        let [short, long, copied] =
            ["short", "long", "copied"].map(|kind| folder.path().join(format!("{name}-{kind}")));
        let further = [&longer[..], format].concat();
        assert_code(&run_paper(&short, STEPS, PACKED), 0);
        assert_code(&run_paper(&long, 20, &further[..2].iter().chain(format).copied().collect::<Vec<_>>()), 0);
        let out = copied.display().to_string();
        assert_code(&on("resume", &short, &[&further[..], &["--out", &out]].concat()), 0);
        assert_code(&on("resume", &short, &further), 0);
        for run in [&short, &copied] {
            let fields = names(&long).into_iter().filter(|name| name.starts_with("fields")).collect::<Vec<_>>();
            assert_eq!(names(run).into_iter().filter(|name| name.starts_with("fields")).collect::<Vec<_>>(), fields);
            assert!(fields.iter().all(|name| bytes(run, name) == bytes(&long, name)), "{fields:?}");
            let verified = on("verify", run, &[]);
            assert_code(&verified, 0);
        }
    }
}

/// Wherever a run was killed while it packed or unpacked, all snapshots are there, and it goes on to the same file.
#[test]
fn a_run_that_is_killed_while_it_packs_loses_nothing() {
    let folder = tempdir().expect("a folder");
    let [packed, both] = ["packed", "both"].map(|name| folder.path().join(name));
    assert_code(&run_paper(&packed, STEPS, PACKED), 0);
    assert_code(&run_paper(&both, STEPS, BOTH), 0);
    // What the manifest says before the end.
    let mut running: serde_json::Value =
        serde_json::from_str(&read(&packed.join("manifest.json"))).expect("a manifest");
    (running["end"], running["passing"]) = (serde_json::Value::Null, serde_json::Value::Null);
    running["sessions"][0]["to_step"] = serde_json::Value::Null;
    running["outputs"]["fields.vtkhdf"] = serde_json::Value::Null;
    running["outputs"]["fields.pvd"] = serde_json::Value::Null;
    running["outputs"].as_object_mut().expect("names").retain(|name, _| !name.starts_with("contact/"));
    let killed = |name: &str, is_running: bool, there: &[usize], has_list: bool| {
        let path: PathBuf = folder.path().join(name);
        copy(&packed, &path);
        if is_running {
            fs::write(path.join("manifest.json"), running.to_string()).expect("a file");
        }
        fs::create_dir_all(path.join("fields")).expect("a folder");
        for step in there {
            let name = format!("fields/step_{step:07}.vtu");
            fs::copy(both.join(&name), path.join(&name)).expect("a file");
        }
        if has_list {
            let is_there = |line: &&str| {
                !line.contains("step_") || there.iter().any(|step| line.contains(&format!("step_{step:07}")))
            };
            let list: Vec<String> =
                read(&both.join("fields.pvd")).lines().filter(is_there).map(|line| format!("{line}\n")).collect();
            fs::write(path.join("fields.pvd"), list.concat()).expect("a file");
        }
        assert_code(&on("plot", &path, &[]), 0);
        fs::remove_dir_all(path.join("plots")).expect("a folder");
        assert_code(&on("resume", &path, &[]), 0);
        assert_same_results(&packed, &path);
    };
    killed("renamed", true, &SNAPSHOTS, true);
    killed("list removed", true, &SNAPSHOTS, false);
    killed("some removed", true, &SNAPSHOTS[2..], false);
    killed("all removed", true, &[], false);
    killed("some unpacked", false, &SNAPSHOTS[..2], false);
    killed("all unpacked", false, &SNAPSHOTS[..4], true);
    // A temporary file of one that was killed while it wrote goes.
    let path = folder.path().join("part");
    copy(&packed, &path);
    fs::write(path.join(".fields.vtkhdf.0123456789abcdef.part"), "x").expect("a file");
    assert_code(&on("resume", &path, &[]), 0);
    assert_same_results(&packed, &path);
}

/// The file is one of the run: `--force` removes it, and a file of somebody else with its name is refused.
#[test]
fn the_file_is_removed_with_its_run_and_only_with_it() {
    let folder = tempdir().expect("a folder");
    let out = folder.path().join("results");
    assert_code(&run_paper(&out, STEPS, PACKED), 0);
    assert_code(&run_paper(&out, STEPS, &["--force"]), 0);
    assert!(!out.join("fields.vtkhdf").exists() && out.join("fields.pvd").is_file());
    assert_code(&run_paper(&out, STEPS, &[PACKED, &["--force"]].concat()), 0);
    assert!(out.join("fields.vtkhdf").exists() && !out.join("fields").exists());
    let other = folder.path().join("other");
    fs::create_dir(&other).expect("a folder");
    fs::write(other.join("fields.vtkhdf"), "mine").expect("a file");
    let refused = run_paper(&other, STEPS, &["--force"]);
    assert_code(&refused, 2);
    assert!(stderr(&refused).contains("fields.vtkhdf was not written by a run"), "{}", stderr(&refused));
    assert_eq!(read(&other.join("fields.vtkhdf")), "mine");
    // Files of others in the folder of the snapshots stay.
    let mine = folder.path().join("mine");
    assert_code(&run_paper(&mine, STEPS, &[]), 0);
    fs::write(mine.join("fields/mine.vtu"), "mine").expect("a file");
    assert_code(&run_paper(&mine, STEPS, &[PACKED, &["--force"]].concat()), 0);
    assert_eq!(names(&mine.join("fields")), ["mine.vtu"]);
}

/// A file that is damaged is told by every command, and kept.
#[test]
fn a_damaged_file_is_told_and_kept() {
    let folder = tempdir().expect("a folder");
    let whole = folder.path().join("whole");
    assert_code(&run_paper(&whole, STEPS, PACKED), 0);
    let good = bytes(&whole, "fields.vtkhdf");
    for (name, bad) in [("short", good[..good.len() / 2].to_vec()), ("empty", Vec::new()), ("other", b"x".to_vec())] {
        let path = folder.path().join(name);
        copy(&whole, &path);
        fs::write(path.join("fields.vtkhdf"), &bad).expect("a file");
        let verified = on("verify", &path, &[]);
        assert_code(&verified, 1);
        let told = stderr(&verified);
        assert!(told.contains("fields.vtkhdf has") && told.contains("fields.vtkhdf: "), "{name}: {told}");
        let refused = on("resume", &path, &[]);
        assert_code(&refused, 4);
        let advice = "expected the fields of the run; move the file away to go on without them";
        assert!(stderr(&refused).contains(advice), "{name}: {}", stderr(&refused));
        assert!(bytes(&path, "fields.vtkhdf") == bad);
        let drawn = on("plot", &path, &[]);
        assert_code(&drawn, 4);
        assert!(stderr(&drawn).contains("fields.vtkhdf"), "{}", stderr(&drawn));
    }
}

/// Snapshots with different arrays do not make one series: they stay files of their own, and the run says so.
#[test]
fn snapshots_with_other_fields_stay_files() {
    let folder = tempdir().expect("a folder");
    let out = folder.path().join("results");
    assert_code(&run_paper(&out, STEPS, PACKED), 0);
    let further = ["--set", "time.end=2.0", "--set", "time.steps=20", "--set", "output.fields=[\"strain\"]"];
    let resumed = on("resume", &out, &further);
    assert_code(&resumed, 0);
    let note = "fields.vtkhdf is not written: step 12: no array stress with the components that it has at first; the fields are in fields.pvd";
    assert!(stderr(&resumed).contains(note), "{}", stderr(&resumed));
    assert!(!out.join("fields.vtkhdf").exists());
    assert_eq!(read(&out.join("fields.pvd")).matches("<DataSet").count(), 8);
    assert_eq!(summary(&out)["steps"], 20);
    assert_code(&on("verify", &out, &[]), 0);
}
