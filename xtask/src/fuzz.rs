//! Hostile inputs to every reader of the library, on stable Rust.
//!
//! Each target runs in its own process with a limited address space. Inputs are mutations of valid ones and contain
//! words of the schema of the case file. An input with a new kind of outcome joins the corpus. An input that ends the
//! process or takes too long is kept in `target/fuzz`.

mod mutate;
mod targets;

use std::collections::BTreeSet;
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::panic::{self, AssertUnwindSafe};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::random::Random;
use mutate::Mutator;
use targets::{Target, names};

/// Longest processor time of one input; the load of the machine does not count.
const PATIENCE: Duration = Duration::from_secs(1);
/// Longest wall-clock time, for an input that waits.
const WAITING: Duration = Duration::from_secs(20);
/// Number of remembered kinds of outcomes: some hundred, apart from messages that contain words of the input.
const KNOWN: usize = 1 << 20;
/// Time between two checks by the watchdog.
const GLANCE: Duration = Duration::from_millis(100);
/// Longest input; longer ones find nothing new.
const LONGEST: usize = 1 << 16;
/// Number of inputs kept in addition to the valid ones.
const KEPT: usize = 4000;
/// Exit code of a process that the watchdog has ended.
const TOO_LONG: i32 = 3;

/// What to feed.
#[derive(clap::Args)]
pub struct Arguments {
    /// The reader; all of them without one
    target: Option<String>,
    /// Seconds of processor time per reader
    #[arg(long, default_value_t = 10)]
    seconds: u64,
    /// Seed of the first mutation
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Limit of the address space, MB
    #[arg(long, default_value_t = 1024)]
    memory: u64,
    /// Feed in this process
    #[arg(long, hide = true)]
    worker: bool,
    /// Read this input alone
    #[arg(long)]
    input: Option<PathBuf>,
}

/// Feeds one target or all, and reports the result.
pub fn run(arguments: &Arguments) -> ExitCode {
    let chosen: Vec<&str> = match &arguments.target {
        None => names(),
        Some(name) => names().into_iter().filter(|known| known == name).collect(),
    };
    if chosen.is_empty() {
        eprintln!("there is no such reader; those there are: {}", names().join(", "));
        return ExitCode::from(2);
    }
    if arguments.worker {
        return chosen.first().map_or(ExitCode::FAILURE, |name| feed(name, arguments));
    }
    println!("{:<12} {:>10} {:>9} {:>11} {:>9}  outcome", "reader", "inputs", "outcomes", "longest ms", "peak MB");
    // Each has its own processor time, so that neighbours do not shorten it.
    let fed: Vec<(String, bool)> = chosen.par_iter().with_max_len(1).map(|name| fed(name, arguments)).collect();
    for (told, _) in &fed {
        print!("{told}");
    }
    if fed.iter().all(|(_, is_well)| *is_well) { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Feeds one target in a process of its own: what it tells, and whether all is well.
fn fed(name: &str, arguments: &Arguments) -> (String, bool) {
    let Ok(program) = std::env::current_exe() else { return (format!("{name:<12} has no program\n"), false) };
    let mut command = Command::new(program);
    command.args(["fuzz", name, "--worker", "--seconds", &arguments.seconds.to_string()]);
    command.args(["--seed", &arguments.seed.to_string(), "--memory", &arguments.memory.to_string()]);
    if let Some(input) = &arguments.input {
        command.arg("--input").arg(input);
    }
    match command.env("RUST_BACKTRACE", "0").output() {
        Ok(output) if output.status.success() => (String::from_utf8_lossy(&output.stdout).into_owned(), true),
        Ok(output) => {
            let why = String::from_utf8_lossy(&output.stderr);
            let mut told = format!("{name:<12} FAILS: {}; the input is {}\n", output.status, keep(name).display());
            why.lines().take(20).for_each(|line| told += &format!("    {line}\n"));
            (told, false)
        }
        Err(error) => (format!("{name:<12} cannot be started: {error}\n"), false),
    }
}

/// Path of the current input: in memory if the system has a folder for that.
fn current(name: &str) -> PathBuf {
    let memory = Path::new("/dev/shm");
    let folder = if memory.is_dir() { memory.to_owned() } else { std::env::temp_dir() };
    folder.join(format!("amontons-fuzz-{name}"))
}

/// Keeps the input that ended a process; returns its path.
fn keep(name: &str) -> PathBuf {
    let kept = Path::new("target/fuzz").join(name);
    let copied = fs::create_dir_all("target/fuzz").and_then(|()| fs::copy(current(name), &kept));
    if copied.is_ok() { kept } else { current(name) }
}

/// Limits the address space of this process.
fn limit(megabytes: u64) {
    #[cfg(unix)]
    {
        use rustix::process::{Resource, Rlimit, setrlimit};
        let bytes = Some(megabytes << 20);
        if let Err(error) = setrlimit(Resource::As, Rlimit { current: bytes, maximum: bytes }) {
            eprintln!("the address space cannot be limited: {error}");
        }
    }
    #[cfg(not(unix))]
    let _ = megabytes;
}

/// Number of inputs read, for the watchdog.
static READ: AtomicU64 = AtomicU64::new(0);

/// Processor time of this process.
#[cfg(unix)]
fn processor_time() -> Duration {
    let spent = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::new(spent.tv_sec.unsigned_abs(), spent.tv_nsec as u32)
}

/// Wall-clock time, on systems that do not report processor time.
#[cfg(not(unix))]
fn processor_time() -> Duration {
    static BEGIN: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    BEGIN.get_or_init(Instant::now).elapsed()
}

/// Ends the process if one input takes too long.
fn watch() {
    let watching = std::thread::Builder::new().spawn(move || {
        let (mut last, mut since) = (0, (Instant::now(), processor_time()));
        loop {
            std::thread::sleep(GLANCE);
            let now = READ.load(Ordering::Relaxed);
            if now != last {
                (last, since) = (now, (Instant::now(), processor_time()));
            } else if processor_time().saturating_sub(since.1) > PATIENCE {
                eprintln!("an input takes longer than {PATIENCE:?} of processor time");
                std::process::exit(TOO_LONG);
            } else if since.0.elapsed() > WAITING {
                // The process may also have been stopped, or the machine out of memory.
                eprintln!("an input takes longer than {WAITING:?} by the clock");
                std::process::exit(TOO_LONG);
            }
        }
    });
    if let Err(error) = watching {
        eprintln!("there is no watchdog: {error}");
    }
}

/// Feeds a target in this process.
fn feed(name: &str, arguments: &Arguments) -> ExitCode {
    let Some(mut target) = Target::new(name) else { return ExitCode::FAILURE };
    limit(arguments.memory);
    if let Some(input) = &arguments.input {
        return read_one(&mut target, input);
    }
    // Panics are reported once, with the input that caused them.
    let mut mutator = Mutator::new(Random::new(arguments.seed), target.words());
    let mut corpus = target.corpus();
    let (mut outcomes, mut longest, mut count) = (BTreeSet::new(), Duration::ZERO, 0u64);
    watch();
    let begin = processor_time();
    while processor_time().saturating_sub(begin) < Duration::from_secs(arguments.seconds) || count < corpus.len() as u64
    {
        // The valid inputs come first, unchanged.
        let input = match corpus.get(count as usize) {
            Some(sound) if count < target.sound() as u64 => sound.clone(),
            _ => mutator.mutate(&corpus, LONGEST),
        };
        if let Err(error) = fs::write(current(name), &input) {
            eprintln!("{}: {error}", current(name).display());
            return ExitCode::FAILURE;
        }
        let started = processor_time();
        let Ok(outcome) = panic::catch_unwind(AssertUnwindSafe(|| target.read(&input))) else {
            return ExitCode::FAILURE;
        };
        longest = longest.max(processor_time().saturating_sub(started));
        count += 1;
        READ.store(count, Ordering::Relaxed);
        let is_new = outcomes.len() < KNOWN && outcomes.insert(signature(&outcome));
        if is_new && corpus.len() < KEPT {
            corpus.push(input);
        }
    }
    let peak = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak =
        peak.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix("kB")?.trim().parse().ok());
    let megabytes = peak.map_or_else(|| "-".to_owned(), |kibibytes: f64| format!("{:.0}", kibibytes / 1024.0));
    let milliseconds = longest.as_secs_f64() * 1e3;
    println!("{name:<12} {count:>10} {:>9} {milliseconds:>11.1} {megabytes:>9}  holds", outcomes.len());
    ExitCode::SUCCESS
}

fn read_one(target: &mut Target, input: &Path) -> ExitCode {
    match fs::read(input) {
        Ok(bytes) => {
            println!("{}", target.read(&bytes));
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{}: {error}", input.display());
            ExitCode::FAILURE
        }
    }
}

/// Signature of a message without numbers and quoted names: a hash of its other letters.
fn signature(outcome: &str) -> u64 {
    let mut quoted = false;
    let letters = outcome.chars().filter(|c| {
        quoted ^= matches!(c, '"' | '`');
        !quoted && (c.is_alphabetic() || *c == ' ')
    });
    let mut hash = DefaultHasher::new();
    letters.take(200).for_each(|letter| letter.hash(&mut hash));
    hash.finish()
}
