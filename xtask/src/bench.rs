//! Times of the paper's square, of the cube in space and of other programs on the same problem, in one run.
//!
//! `bench --peer getfem` needs Debian's `python3-getfem` (`apt-get install python3-getfem`), `bench --peer pyamg` a
//! Python with that package (`pip install pyamg`); the programs for both are in `xtask/peers`.

mod chart;
mod system;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

use serde_json::Value;

/// The cube in space.
const CUBE: &str = include_str!("../peers/cube.toml");

/// What to measure.
#[derive(clap::Args)]
pub struct Arguments {
    /// Cells per edge of the paper's square; as many steps are made.
    #[arg(long, value_delimiter = ',', default_value = "64,128,256")]
    plane: Vec<usize>,
    /// Cells per edge of the cube; four steps are made.
    #[arg(long, value_delimiter = ',', default_value = "16,24,32")]
    cube: Vec<usize>,
    /// Cells per edge of the cube of which one linear system is solved to 1e-10.
    #[arg(long, value_delimiter = ',', default_value = "16,32")]
    system: Vec<usize>,
    /// Programs to compare with: getfem on the square, pyamg on the linear system.
    #[arg(long)]
    peer: Vec<String>,
    /// Steps that the plain script of another program makes; its time is that of a step times the number of steps.
    #[arg(long, default_value_t = 4)]
    plain_steps: usize,
    /// The Python that has pyamg.
    #[arg(long, default_value = "python3")]
    python: String,
    /// Folder for the table and its picture.
    #[arg(long, default_value = "bench")]
    out: PathBuf,
}

/// A line of the table.
pub struct Row {
    /// One of `square`, `cube`, and `cube system`, in which a step is one linear system.
    pub case: &'static str,
    pub program: String,
    pub unknowns: usize,
    pub steps: usize,
    pub setup: f64,
    pub per_step: f64,
    /// Time of a step divided by the time to read the numbers it needs from memory.
    pub over_bound: Option<f64>,
    pub krylov: usize,
    pub memory: f64,
    /// Largest temperature.
    pub result: f64,
}

impl Row {
    fn total(&self) -> f64 {
        self.setup + self.per_step * self.steps as f64
    }
}

/// Measures, prints and writes the table.
pub fn run(arguments: &Arguments) -> ExitCode {
    match measure(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("Error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn measure(arguments: &Arguments) -> Result<(), Box<dyn std::error::Error>> {
    fs::create_dir_all(&arguments.out)?;
    let bandwidth = bandwidth();
    let mut text = machine(bandwidth);
    let mut rows = Vec::new();
    for &n in &arguments.plane {
        let own = amontons("square", Path::new("cases/paper.toml"), n, Some(n), bandwidth)?;
        if arguments.peer.iter().any(|peer| peer == "getfem") {
            for (script, most) in [("getfem_expert", n), ("getfem_plain", arguments.plain_steps.min(n))] {
                rows.push(getfem(script, n, most, own.unknowns)?);
            }
        }
        rows.push(own);
    }
    let cube = arguments.out.join("cube.toml");
    fs::write(&cube, CUBE)?;
    for &n in &arguments.cube {
        rows.push(amontons("cube", &cube, n, None, bandwidth)?);
    }
    let with_pyamg = arguments.peer.iter().any(|peer| peer == "pyamg");
    for &n in &arguments.system {
        rows.extend(system::measure(n, with_pyamg.then_some(arguments.python.as_str()))?);
    }
    text += "case,program,unknowns,steps,setup_s,step_s,total_s,times_the_bound,krylov,memory_MB,largest_temperature\n";
    for row in &rows {
        let over = row.over_bound.map_or_else(String::new, |ratio| format!("{ratio:.2}"));
        text += &format!(
            "{},{},{},{},{:.3},{:.5},{:.2},{over},{},{:.0},{:.12}\n",
            row.case,
            row.program,
            row.unknowns,
            row.steps,
            row.setup,
            row.per_step,
            row.total(),
            row.krylov,
            1e-6 * row.memory,
            row.result
        );
    }
    for (case, program, exponent) in exponents(&rows) {
        text += &format!("# {case}, {program}: time per step grows with unknowns^{exponent:.2}\n");
    }
    print!("{text}");
    fs::write(arguments.out.join("bench.csv"), text)?;
    fs::write(arguments.out.join("bench.svg"), chart::chart(&rows))?;
    Ok(())
}

/// The machine, its load and the versions, as comments of the table.
fn machine(bandwidth: f64) -> String {
    let line = |path: &str, key: &str| {
        let text = fs::read_to_string(path).unwrap_or_default();
        let found = text.lines().find(|line| line.starts_with(key)).unwrap_or_default();
        found.split_once(':').map_or(found, |(_, value)| value).trim().to_owned()
    };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let (cpu, memory) = (line("/proc/cpuinfo", "model name"), line("/proc/meminfo", "MemTotal"));
    let load = fs::read_to_string("/proc/loadavg").unwrap_or_default();
    format!(
        "# {cpu}, {cores} cores, {memory}, one core reads {:.1} GB/s; load before: {}\n# amontons {}\n",
        1e-9 * bandwidth,
        load.trim(),
        env!("CARGO_PKG_VERSION")
    )
}

/// Bytes per second that one thread reads from an array larger than any cache, the best of five.
fn bandwidth() -> f64 {
    let data = vec![1.5f64; 1 << 25];
    let once = || {
        let begin = Instant::now();
        let mut lanes = [0.0; 8];
        for chunk in std::hint::black_box(&data).as_chunks::<8>().0 {
            for (lane, value) in lanes.iter_mut().zip(chunk) {
                *lane += value;
            }
        }
        std::hint::black_box(lanes);
        8.0 * data.len() as f64 / begin.elapsed().as_secs_f64()
    };
    (0..5).map(|_| once()).fold(0.0, f64::max)
}

/// A run of this program.
fn amontons(
    case: &'static str,
    path: &Path,
    n: usize,
    steps: Option<usize>,
    bandwidth: f64,
) -> Result<Row, Box<dyn std::error::Error>> {
    let program = std::env::current_exe()?.with_file_name("amontons");
    let folder = std::env::temp_dir().join(format!("amontons-bench-{}-{case}-{n}", std::process::id()));
    let mut sets = vec![format!("mesh.n={n}"), "output.every=0".to_owned()];
    sets.extend(steps.map(|steps| format!("time.steps={steps}")));
    let with_sets = |command: &mut Command| {
        for set in &sets {
            command.args(["--set", set]);
        }
    };
    let mut check = Command::new(&program);
    check.arg("check").arg(path).args(["--format", "json"]);
    with_sets(&mut check);
    let checked: Value = serde_json::from_slice(&check.output()?.stdout).unwrap_or(Value::Null);
    let mut command = Command::new(&program);
    command.arg("run").arg(path).args(["--quiet", "--no-certificate", "--out"]).arg(&folder);
    with_sets(&mut command);
    let output = command.output()?;
    if !output.status.success() {
        return Err(format!("{}: {}", path.display(), String::from_utf8_lossy(&output.stderr)).into());
    }
    let summary: Value = serde_json::from_slice(&fs::read(folder.join("summary.json"))?)?;
    fs::remove_dir_all(&folder)?;
    let number = |path: &str| summary.pointer(path).and_then(Value::as_f64).unwrap_or(f64::NAN);
    let steps = number("/steps");
    let per_step = number("/seconds/steps") / steps;
    let read = checked.pointer("/model/cost/step_bytes").and_then(Value::as_f64);
    let backend = summary.pointer("/solver/backend").and_then(Value::as_str).unwrap_or_default();
    Ok(Row {
        case,
        program: format!("amontons {backend}"),
        unknowns: (number("/unknowns/displacement") + number("/unknowns/temperature")) as usize,
        steps: steps as usize,
        setup: number("/seconds/total") - number("/seconds/steps"),
        per_step,
        over_bound: read.map(|bytes| per_step * bandwidth / bytes),
        krylov: number("/solver/krylov_iterations") as usize,
        memory: number("/peak_memory_bytes"),
        result: number("/final/temperature_max"),
    })
}

/// A run of a program in `xtask/peers` that makes some of the steps.
fn getfem(script: &str, n: usize, measured: usize, unknowns: usize) -> Result<Row, Box<dyn std::error::Error>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers").join(script).with_extension("py");
    let numbers = [n, n, measured].map(|number| number.to_string());
    let output = Command::new("/usr/bin/python3").arg(path).args(numbers).output()?;
    let text = String::from_utf8_lossy(&output.stdout);
    let Some(found) = text.lines().last().and_then(|line| serde_json::from_str::<Value>(line).ok()) else {
        return Err(format!("{script}: {}", String::from_utf8_lossy(&output.stderr)).into());
    };
    let number = |key: &str| found.get(key).and_then(Value::as_f64).unwrap_or(f64::NAN);
    Ok(Row {
        case: "square",
        program: script.replace('_', " "),
        unknowns,
        steps: n,
        setup: number("setup"),
        per_step: number("per_step"),
        over_bound: None,
        krylov: 0,
        memory: number("peak_memory_bytes"),
        result: if measured == n { number("theta_max") } else { f64::NAN },
    })
}

/// Growth exponents of the time per step over the unknowns, between the smallest and the largest of a series.
fn exponents(rows: &[Row]) -> Vec<(&'static str, String, f64)> {
    let mut found: Vec<(&'static str, String, f64)> = Vec::new();
    for row in rows {
        let series = || rows.iter().filter(|r| r.case == row.case && r.program == row.program);
        let (Some(first), Some(last)) = (series().min_by_key(|r| r.unknowns), series().max_by_key(|r| r.unknowns))
        else {
            continue;
        };
        if first.unknowns < last.unknowns && !found.iter().any(|(c, p, _)| *c == row.case && *p == row.program) {
            let exponent = (last.per_step / first.per_step).ln() / (last.unknowns as f64 / first.unknowns as f64).ln();
            found.push((row.case, row.program.clone(), exponent));
        }
    }
    found
}
