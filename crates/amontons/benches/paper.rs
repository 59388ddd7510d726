//! The paper's finest run, n = 256 with 256 steps, against the bound that reading the factors sets.
//!
//! `cargo bench -p amontons-core --bench paper` prints setup, factor, time per step and total beside the read bandwidth
//! of the machine, measured in the same run. Arguments after `--`: n, steps, θ_F.
#![allow(clippy::expect_used, clippy::print_stdout, reason = "a program for developers")]

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use amontons::case;
use amontons::output::Memory;
use amontons::run::{Settings, run};
use amontons::step::March;

/// Bytes read a second, one thread, from an array as large as the factors: the best and the median of nine.
fn bandwidth(numbers: usize) -> (f64, f64) {
    let data = vec![1.5f64; numbers];
    let mut rates: Vec<f64> = (0..9)
        .map(|_| {
            let begin = Instant::now();
            let mut lanes = [0.0; 8];
            for chunk in black_box(&data).as_chunks::<8>().0 {
                for (lane, value) in lanes.iter_mut().zip(chunk) {
                    *lane += value;
                }
            }
            black_box(lanes);
            8.0 * numbers as f64 / begin.elapsed().as_secs_f64()
        })
        .collect();
    rates.sort_by(f64::total_cmp);
    (rates[8], rates[4])
}

fn main() {
    let mut numbers = std::env::args().skip(1).filter(|a| !a.starts_with('-'));
    let n = numbers.next().unwrap_or_else(|| "256".to_owned());
    let steps = numbers.next().unwrap_or_else(|| n.clone());
    let foundation = numbers.next().unwrap_or_else(|| "0".to_owned());
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/paper.toml");
    let overrides = [
        format!("mesh.n={n}"),
        format!("time.steps={steps}"),
        format!("contact.heat.foundation_temperature={foundation}"),
    ];
    let problem = case::read(&path, &overrides).expect("the paper's case").problem;
    let stored = March::new(&problem).expect("a regular system").stored();
    let before = bandwidth(stored);
    let summary = run(&problem, &Settings { certificate: false, ..Settings::default() }, &mut [&mut Memory::default()])
        .expect("a run that ends");
    let after = bandwidth(stored);
    let (best, median) = (before.0.max(after.0), f64::midpoint(before.1, after.1));
    let seconds = &summary.seconds;
    let per_step = seconds.steps / summary.steps as f64;
    let read = 2.0 * 8.0 * stored as f64;
    println!(
        "paper, n = {n}, {} steps, θ_F = {foundation}: {} displacement and {} temperature unknowns",
        summary.steps, summary.unknowns.displacement, summary.unknowns.temperature
    );
    println!("  factors           {:.1} MB, read twice per step", 8e-6 * stored as f64);
    println!(
        "  read bandwidth    {:.1} GB/s at best, {:.1} GB/s in the median, one thread",
        1e-9 * best,
        1e-9 * median
    );
    println!("  setup             {:.3} s", seconds.setup);
    println!("  factor            {:.3} s", seconds.factor);
    println!(
        "  a step            {:.2} ms; the bound is {:.2} ms (median bandwidth): {:.2} times",
        1e3 * per_step,
        1e3 * read / median,
        per_step * median / read
    );
    println!("  total             {:.2} s", seconds.setup + seconds.factor + seconds.steps);
    println!(
        "  Newton            {} iterations in mechanics, at most {} a step",
        summary.solver.newton_mechanics_total, summary.solver.newton_mechanics_max
    );
    if let Some(bytes) = summary.peak_memory_bytes {
        println!(
            "  peak memory       {:.0} MB, the array of the bandwidth test ({:.0} MB) included",
            1e-6 * bytes as f64,
            8e-6 * stored as f64
        );
    }
}
