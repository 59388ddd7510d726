//! Runs that are killed, and runs whose writes fail: each is resumed and must give the same bits as an undisturbed run.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use crate::random::Random;

/// What to do to runs.
#[derive(clap::Args)]
pub struct Arguments {
    /// Runs that are killed at random instants
    #[arg(long, default_value_t = 10)]
    kills: usize,
    /// Runs whose files may not grow beyond a random length
    #[arg(long, default_value_t = 10)]
    faults: usize,
    /// Seed of the instants and lengths
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Files that contain times and sessions.
const OF_SESSIONS: [&str; 4] = ["summary.json", "manifest.json", "checkpoint/state.bin", "checkpoint/previous.bin"];
/// Overrides of the case: small, and mostly busy with snapshots and checkpoints.
const SET: [&str; 4] = ["mesh.n=8", "time.steps=300", "output.every=20", "output.checkpoint={ steps = 7 }"];
/// The formats of the fields, used in turn.
const FORMATS: [&str; 2] = ["vtu", "vtkhdf"];

/// Kills and fails runs, and reports the result.
pub fn run(arguments: &Arguments) -> ExitCode {
    let folder = std::env::temp_dir().join(format!("amontons-endure-{}", std::process::id()));
    let done = endure(arguments, &folder);
    // Remaining files are in the folder for temporary files.
    let _ = fs::remove_dir_all(&folder);
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(what) => {
            eprintln!("{what}");
            ExitCode::FAILURE
        }
    }
}

fn endure(arguments: &Arguments, folder: &Path) -> Result<(), String> {
    let program = std::env::current_exe().map_err(|error| error.to_string())?.with_file_name("amontons");
    if !program.is_file() {
        return Err("the program is not built: cargo build --release --workspace --bins".to_owned());
    }
    let mut random = Random::new(arguments.seed);
    let mut length = Duration::ZERO;
    let whole = FORMATS.map(|format| folder.join(format!("whole-{format}")));
    for (whole, format) in whole.iter().zip(FORMATS) {
        let begin = Instant::now();
        let ended = start(&program, whole, format, None).wait().map_err(|error| error.to_string())?;
        length = length.max(begin.elapsed());
        if !ended.success() {
            return Err(format!("the whole run: {ended}"));
        }
    }
    let mut steps = BTreeMap::new();
    for i in 0..arguments.kills {
        let out = folder.join(format!("killed-{i}"));
        let instant = Duration::from_secs_f64(random.between(0.0, length.as_secs_f64()));
        let (whole, format) = (&whole[i % FORMATS.len()], FORMATS[i % FORMATS.len()]);
        let mut child = start(&program, &out, format, None);
        std::thread::sleep(instant);
        child.kill().and_then(|()| child.wait()).map_err(|error| error.to_string())?;
        *steps.entry(rows(&out).min(300) / 60 * 60).or_insert(0) += 1;
        go_on(&program, &out, (whole, format)).map_err(|what| format!("{format} killed after {instant:?}: {what}"))?;
        fs::remove_dir_all(&out).map_err(|error| error.to_string())?;
    }
    println!("{} runs killed, each resumed to the same bits; by steps made: {steps:?}", arguments.kills);
    let mut codes = BTreeMap::new();
    for i in 0..arguments.faults {
        let out = folder.join(format!("failed-{i}"));
        // The largest file has some 60 kB; that of all fields some 200 kB.
        let blocks = random.decades(1.0, if i % FORMATS.len() == 0 { 130.0 } else { 450.0 }) as usize;
        let (whole, format) = (&whole[i % FORMATS.len()], FORMATS[i % FORMATS.len()]);
        let ended = start(&program, &out, format, Some(blocks)).wait().map_err(|error| error.to_string())?;
        let code = ended.code().ok_or_else(|| format!("files of {blocks} blocks: {ended}"))?;
        if ![0, 4].contains(&code) {
            return Err(format!("files of {blocks} blocks: {ended}"));
        }
        *codes.entry(code).or_insert(0) += 1;
        go_on(&program, &out, (whole, format)).map_err(|what| format!("{format}, files of {blocks} blocks: {what}"))?;
        fs::remove_dir_all(&out).map_err(|error| error.to_string())?;
    }
    println!("{} runs with failing writes, each resumed to the same bits; exit codes: {codes:?}", arguments.faults);
    Ok(())
}

/// Starts the run, with files of at most `blocks` blocks of 512 bytes.
fn start(program: &Path, out: &Path, format: &str, blocks: Option<usize>) -> std::process::Child {
    let case = Path::new(env!("CARGO_MANIFEST_DIR")).join("../cases/paper.toml");
    let mut command = Command::new("sh");
    let limit = blocks.map_or_else(String::new, |blocks| format!("ulimit -f {blocks}; "));
    command.args(["-c", &format!("{limit}exec \"$0\" \"$@\"")]).arg(program).arg("run").arg(case);
    command.arg("--out").arg(out).args(["--quiet", "--no-certificate"]);
    command.args(SET.iter().flat_map(|set| ["--set", set])).args(["--set", &format!("output.format=\"{format}\"")]);
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().unwrap_or_else(|error| {
        eprintln!("sh: {error}");
        std::process::exit(1)
    })
}

/// Rows of the history: steps that were made.
fn rows(out: &Path) -> usize {
    fs::read_to_string(out.join("history.csv")).unwrap_or_default().lines().count().saturating_sub(1)
}

/// Resumes a run and compares its results with those of the undisturbed one. A run killed before it had made its folder
/// is started.
fn go_on(program: &Path, out: &Path, (whole, format): (&Path, &str)) -> Result<(), String> {
    let resumed = Command::new(program).arg("resume").arg(out).args(["--quiet"]).output();
    let resumed = resumed.map_err(|error| error.to_string())?;
    if !resumed.status.success() {
        let told = String::from_utf8_lossy(&resumed.stderr).into_owned();
        if out.join("checkpoint").exists() || out.join("history.csv").exists() {
            return Err(format!("resume: {}: {told}", resumed.status));
        }
        let ended = start(program, out, format, None).wait().map_err(|error| error.to_string())?;
        if !ended.success() {
            return Err(format!("run again: {ended}"));
        }
    }
    let inside = |folder: &Path| -> Vec<PathBuf> {
        let all = files(folder).into_iter();
        all.filter_map(|path| path.strip_prefix(folder).ok().map(Path::to_owned)).collect()
    };
    if inside(out) != inside(whole) {
        return Err(format!("the files are {:?}, expected {:?}", inside(out), inside(whole)));
    }
    for name in inside(whole).iter().filter(|name| OF_SESSIONS.iter().all(|other| name.as_path() != Path::new(other))) {
        if fs::read(out.join(name)).ok() != fs::read(whole.join(name)).ok() {
            return Err(format!("{} differs", name.display()));
        }
    }
    Ok(())
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() { found.extend(files(&path)) } else { found.push(path) }
    }
    found.sort();
    found
}
